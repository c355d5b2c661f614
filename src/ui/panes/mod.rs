//! What lies in the panes, and how their tabs look.

pub mod clip_card;
pub mod explanation;
pub mod glossary;
pub mod granularities;
pub mod layout;
pub mod parameters;
pub mod status;
pub mod timeline;
pub mod topbar;
pub mod transport;

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Button, Color32, Frame, Id, Margin, Rect, Response, RichText, Sense, Stroke, TextStyle, Ui, Visuals,
    WidgetInfo, WidgetText, vec2,
};
use eframe::egui_wgpu::RenderState;
use egui_tiles::{Behavior, SimplificationOptions, TabState, TileId, Tiles, UiResponse};
use lucide_icons::Icon;
use motionscope_core::scene::{Chart, Readout};
use motionscope_core::{AnyEstimator, Clip, Cursor, Error, Info, Step, Value};
use serde::{Deserialize, Serialize};

use super::model::document::{Document, Owner};
use super::model::loader::Loading;
use super::model::snapshot::Snapshot;
use super::model::walker::View;
use super::parts::widgets;
use crate::paint::LevelShown;
use crate::ui::app::action::{Action, Actions, Side};
use crate::ui::app::commands::Command;
use crate::ui::charts::{distribution, heat_map, histogram, matrices, plane, plots, stack3d, surface3d, tiles};
use crate::ui::drawing::chart::Subject;
use crate::ui::drawing::style;
use crate::ui::panes::layout::Pane;
use crate::ui::stage;
use crate::view::look::Look;
use crate::view::panes::{self, Angles, PANES};

/// What the panes remember between frames, and of it from one day to the next how they are looked at.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct States {
    /// The stage.
    #[serde(skip)]
    pub stage: stage::State,
    /// Which of several estimators is explained.
    #[serde(skip)]
    pub explained: usize,
    /// The explanation.
    #[serde(skip)]
    pub why: explanation::State,
    /// The cost surface as a heat map.
    #[serde(skip)]
    pub heat_map: heat_map::State,
    /// The cost surface in three dimensions.
    pub surface3d: surface3d::State,
    /// The levels of a pyramid in three dimensions.
    pub stack3d: stack3d::State,
    /// Whether these stand in the place of the cost surface, where there are some.
    pub is_stack: bool,
    /// The plane of displacements.
    #[serde(skip)]
    pub plane: plane::State,
    /// Quantities over steps.
    #[serde(skip)]
    pub plots: plots::State,
    /// How often each displacement was found.
    #[serde(skip)]
    pub histogram: histogram::State,
    /// How often errors have each size.
    #[serde(skip)]
    pub errors: distribution::State,
    /// Matrices with their numbers.
    #[serde(skip)]
    pub matrices: matrices::State,
    /// Whether errors stand in the place of the displacements found, where both are there to be counted.
    pub is_errors: bool,
    /// Small pictures with their numbers.
    #[serde(skip)]
    pub tiles: tiles::State,
}

impl States {
    /// From where the things in space are looked at that `step` tells of.
    pub fn angles(&self, step: &Step) -> Angles {
        let plane = step.readouts.iter().find_map(|r| if let Readout::Plane(plane) = r { Some(plane) } else { None });
        let plane = plane.and_then(|plane| self.plane.window(plane));
        Angles { surface: self.surface3d.orbit, pyramid: self.stack3d.orbit, plane }
    }
}

/// What the panes show.
pub struct Panes<'a> {
    /// What is open.
    pub document: &'a Document,
    /// What the walker shows and does.
    pub view: &'a View,
    /// The clip that is being opened.
    pub loading: Option<&'a Loading>,
    /// What went wrong and was not read yet.
    pub error: Option<&'a Error>,
    /// What the panes remember.
    pub states: &'a mut States,
    /// The tile that holds nothing but the stage.
    pub stage_alone: Option<TileId>,
    /// Panes that share their tabs with no other.
    pub alone: Vec<TileId>,
    /// Whether a step may move.
    pub animate: bool,
    /// Whether particles may.
    pub flows: bool,
    /// Whether the line at the bottom is folded away.
    pub lecture: bool,
    /// The window's graphics card, if it has one.
    pub gpu: Option<&'a RenderState>,
    /// How pictures look.
    pub look: &'a mut Look,
    /// What is asked for.
    pub actions: &'a mut Actions,
}

impl Panes<'_> {
    fn stage(&mut self, ui: &mut Ui) {
        self.banners(ui);
        let Some(shown) = &self.view.shown else {
            self.nothing_yet(ui);
            return;
        };
        let heat = self.told(shown).1.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface.title),
            _ => None,
        });
        let placing = self.placing(shown);
        if placing.is_none() {
            self.states.stage.placing = None;
        }
        let input = stage::Input {
            pictures: &shown.pictures,
            frame: shown.frame,
            scene: &shown.scene,
            lockstep: self.lockstep(shown),
            stands: shown.stands(shown.subject.experiment.estimator.is_of_single_frames()),
            look: *self.look,
            heat: heat.or(shown.scene.heat).unwrap_or_default(),
            placing: placing.as_ref(),
            gpu: self.gpu,
            available: &shown.available,
            checking: self.view.checking,
            animate: self.animate,
            flows: self.flows,
        };
        let response = stage::show(ui, input, &mut self.states.stage);
        self.actions.ask(Action::Focus(response.hovered));
        if let Some(explained) = response.explained {
            self.states.explained = explained;
        }
        if let Some(pace) = response.paced {
            self.actions.ask(Action::Pace(pace));
        }
        *self.look = response.look;
        self.place(placing.as_ref(), (&response, shown));
        if response.left {
            self.actions.command(Command::Lockstep);
        }
        if let Some(point) = response.clicked {
            let side = if ui.input(|i| i.modifiers.shift) { Side::Start } else { Side::End };
            self.actions.ask(Action::SeekAt(point, side));
        }
    }

    /// The parameter that is being placed on the picture, if one is.
    fn placing(&self, shown: &Snapshot) -> Option<stage::Placing> {
        let (index, estimator) = (self.states.stage.placing?, self.document.estimator());
        let spec = estimator.specs().get(index)?;
        match estimator.value(index) {
            Value::Placed(now) => {
                let is_by_frame = estimator.is_by_frame();
                Some(stage::Placing { index, spec, now, frame: shown.frame, is_by_frame })
            }
            _ => None,
        }
    }

    /// Sets what was placed on the picture.
    fn place(&mut self, placing: Option<&stage::Placing>, (response, shown): (&stage::Response, &Snapshot)) {
        let Some(placing) = placing else { return };
        if let Some(placed) = response.placed.clone().map(Value::Placed) {
            // What is still too small to be a line is no mistake.
            if placing.spec.check(placed.clone()).is_ok() {
                self.actions.ask(Action::Set(Owner::Estimator, placing.index, placed));
            }
        }
        match response.placing {
            stage::Gesture::None => {}
            stage::Gesture::Settled => self.actions.ask(Action::Settle),
            // The next place is one in the next frame.
            stage::Gesture::SettledFrame => {
                self.actions.ask(Action::Settle);
                let next = placing.frame + 1;
                let last = shown.subject.clip.info().frames.map_or(next, |frames| frames - 1);
                let unit = next.min(last).saturating_sub(shown.subject.experiment.frame);
                self.actions.ask(Action::Seek(Cursor { unit, event: usize::MAX }));
            }
            stage::Gesture::Done => self.actions.ask(Action::Place(None)),
        }
    }

    /// The estimators in lockstep, if there are several.
    fn lockstep<'a>(&self, shown: &'a Snapshot) -> Option<stage::Lockstep<'a>> {
        let tiles = &shown.tiles[..];
        let explained = self.states.explained.min(tiles.len().checked_sub(1)?);
        Some(stage::Lockstep { tiles, explained, pace: shown.subject.experiment.side_by_side.pace })
    }

    /// The estimator that is explained, and what it tells.
    fn told<'a>(&self, shown: &'a Snapshot) -> (&'static Info, &'a Arc<Step>) {
        match self.lockstep(shown) {
            Some(all) => (all.tiles[all.explained].info, &all.tiles[all.explained].step),
            None => (shown.info, &shown.step),
        }
    }

    /// What is going on and what went wrong, where the person is looking.
    fn banners(&mut self, ui: &mut Ui) {
        if let Some(loading) = self.loading {
            self.opening(ui, loading);
        }
        if let Some(work) = status::work(self.view).filter(|_| self.lecture && self.view.shown.is_some()) {
            ui.horizontal(|ui| status::progress(ui, &work, self.actions));
        }
        // What is still shown of another clip is no news of this one.
        let shown = self.view.shown.as_ref().filter(|shown| self.document.is_of_clip(shown));
        let failure = shown.and_then(|shown| shown.failure.as_ref());
        let error = self.error.or(self.view.refused.as_ref()).or(self.document.refused()).or(failure);
        let Some(error) = error else { return };
        let told = sentence(error, self.document.clip());
        let chrome = self.look.theme.chrome();
        let fill = style::color(chrome.panel.mix(chrome.error, 0.14));
        let edge = Stroke::new(1.0, style::color(chrome.error));
        let frame = Frame::new().fill(fill).stroke(edge).corner_radius(6).inner_margin(Margin::symmetric(12, 8));
        let dismissable = self.error.is_some();
        // A run that is refused is one that was asked for by a parameter, as a rule: then the way back is there.
        let is_refused = self.error.is_none() && (self.view.refused.is_some() || self.document.refused().is_some());
        let (way_out, command) = match is_refused && self.document.can_undo() {
            true => ("Undo", Command::Undo),
            false => ("Open another…", Command::Open),
        };
        frame.show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(widgets::icon(ui, Icon::TriangleAlert).color(style::color(chrome.error)));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if dismissable && widgets::cross(ui, "Dismiss error").clicked() {
                        self.actions.ask(Action::Dismiss);
                    }
                    if ui.button(way_out).clicked() {
                        self.actions.command(command);
                    }
                    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                        let label = ui.add(egui::Label::new(&told).wrap().selectable(true));
                        label.widget_info(|| WidgetInfo::labeled(egui::Role::Alert, true, &told));
                    });
                });
            });
        });
        ui.add_space(8.0);
    }

    fn opening(&mut self, ui: &mut Ui, loading: &Loading) {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("Opening {}…", widgets::elide(&loading.name.to_string_lossy(), 64)));
            let done = loading.work.fraction();
            if done > 0.0 {
                ui.add(egui::ProgressBar::new(done).desired_width(160.0).show_percentage());
            }
            if ui.button("Cancel").clicked() {
                self.actions.ask(Action::CancelOpening);
            }
        });
    }

    /// The stage before anything is open says what to do.
    fn nothing_yet(&mut self, ui: &mut Ui) {
        if let Some(work) = status::work(self.view) {
            ui.vertical_centered(|ui| {
                ui.add_space((ui.available_height() * 0.4).max(16.0));
                status::progress(ui, &work, self.actions);
            });
        }
        if self.view.busy || self.loading.is_some() {
            return;
        }
        if self.document.clip().is_some() {
            return empty(ui, "Nothing runs on this clip as it is set. Another estimator may, or other parameters.");
        }
        let size = TextStyle::Body.resolve(ui.style()).size;
        let dim = ui.visuals().weak_text_color();
        ui.vertical_centered(|ui| {
            ui.add_space((ui.available_height() * 0.3).max(16.0));
            ui.label(widgets::icon(ui, Icon::ScanEye).size(3.2 * size).color(dim));
            ui.add_space(8.0);
            ui.label(RichText::new("Open a clip to begin").family(style::bold()).size(1.5 * size));
            ui.label(RichText::new("Drop a video or a folder of pictures here, or choose one.").color(dim));
            ui.add_space(16.0);
            ui.horizontal(|ui| {
                ui.add_space((ui.available_width() - 17.0 * size).max(0.0) / 2.0);
                for command in [Command::Open, Command::Samples] {
                    let face = command.info();
                    let button = Button::new((widgets::icon(ui, face.icon), face.text));
                    if ui.add(button.min_size(vec2(8.0 * size, 2.4 * size))).clicked() {
                        self.actions.command(command);
                    }
                }
            });
        });
    }

    fn why(&mut self, ui: &mut Ui) {
        match &self.view.shown {
            Some(shown) => {
                let (info, step) = self.told(shown);
                let input = explanation::Input { info, step, at_end: shown.at_end, theme: self.look.theme };
                explanation::show(ui, input, &mut self.states.why);
            }
            None => empty(ui, &self.before("No step is explained")),
        }
    }

    /// Whether what is shown is not what is set, and it takes a while to get there.
    fn is_stale(&self) -> bool {
        let (shown, set) =
            (self.view.shown.as_deref().map(|shown| &shown.subject.experiment.estimator), self.document.estimator());
        let differs = |shown: &dyn AnyEstimator| shown.info().id != set.info().id || shown.values() != set.values();
        self.view.progress.is_some() && shown.is_some_and(|shown| differs(&**shown))
    }

    /// What a pane says until there is a run.
    fn before(&self, what: &str) -> String {
        let until = if self.document.clip().is_some() { "something runs on the clip" } else { "a clip is open" };
        format!("{what} until {until}.")
    }

    /// What stands over a pane: some are called after what they show just now.
    fn title(&self, pane: Pane) -> &'static str {
        let step = self.view.shown.as_deref().map(|shown| &**self.told(shown).1);
        let charts = self.document.estimator().charts();
        match pane {
            Pane::Surface if step.is_some_and(has_plane) || !charts.contains(&Chart::Surface) => "Displacements",
            pane => pane.title(),
        }
    }

    fn chart(&mut self, ui: &mut Ui, pane: Pane) {
        let Some(shown) = self.view.shown.as_deref() else {
            return empty(ui, &self.before("There is nothing to show"));
        };
        let (theme, colors) = (self.look.theme, self.look.colors);
        let (info, step) = self.told(shown);
        let subject = Subject { step: Some(step), whose: info.name, theme, colors };
        let has_costs = shown.subject.experiment.estimator.charts().contains(&Chart::Surface);
        if pane == Pane::Surface3d && pyramid(ui, step, has_costs, (subject, self.look), self.states) {
            return;
        }
        if pane == Pane::Histogram && errors(ui, step, subject, self.states) {
            return;
        }
        let states = &mut *self.states;
        let mut clicked = None;
        for readout in &step.readouts {
            match (pane, readout) {
                (Pane::Surface, Readout::Surface(surface)) => {
                    let input = heat_map::Input { surface, subject };
                    clicked = heat_map::show(ui, input, &mut states.heat_map).clicked;
                }
                (Pane::Surface, Readout::Plane(plane)) => {
                    plane::show(ui, plane::Input { plane, subject }, &mut states.plane);
                }
                (Pane::Surface3d, Readout::Surface(surface)) => {
                    let input = surface3d::Input { surface, subject, gpu: self.gpu };
                    surface3d::show(ui, input, &mut states.surface3d);
                }
                (Pane::Plot, Readout::Series(_)) => {
                    clicked = plots::show(ui, &step.readouts, subject, &mut states.plots);
                }
                (Pane::Numbers, Readout::Tiles(tiles)) => {
                    let is_centered = !shown.subject.experiment.estimator.tests_candidates();
                    tiles::show(ui, tiles::Input { tiles, is_centered, subject }, &mut states.tiles);
                }
                (Pane::Numbers, Readout::Matrices(all)) => {
                    matrices::show(ui, all, subject, &mut states.matrices);
                }
                (Pane::Histogram, Readout::Histogram(counts)) => {
                    // The units of several in lockstep are their own, and not those of this estimator.
                    let input = histogram::Input { histogram: counts, leads: shown.tiles.is_empty(), subject };
                    if let Some(unit) = histogram::show(ui, input, &mut states.histogram).clicked {
                        self.actions.ask(Action::Seek(Cursor { unit, event: usize::MAX }));
                    }
                }
                _ => continue,
            }
            if let Some(event) = clicked {
                self.actions.ask(Action::Seek(Cursor { event, ..shown.cursor }));
            }
            return;
        }
        empty(ui, &absent(pane, shown.subject.experiment.estimator.charts()));
    }
}

/// Whether a step shows lines in the plane of displacements, where others show a cost.
fn has_plane(step: &Step) -> bool {
    step.readouts.iter().any(|readout| matches!(readout, Readout::Plane(_)))
}

/// Where the step works on a pyramid: the choice between it and the cost surface, and the pyramid if it is chosen. Gives
/// whether it is.
fn pyramid(
    ui: &mut Ui,
    step: &Step,
    has_costs: bool,
    (subject, look): (Subject<'_>, &mut Look),
    states: &mut States,
) -> bool {
    let stack = step.readouts.iter().find_map(|r| if let Readout::Stack(stack) = r { Some(stack) } else { None });
    let Some(stack) = stack else { return false };
    if has_costs {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (is_stack, text, tip) in [
                (false, "Surface", "The cost of every displacement tested."),
                (true, "Pyramid", "The levels of the pyramid, with the block and what was found for it on each."),
            ] {
                let chosen = ui.selectable_value(&mut states.is_stack, is_stack, text).on_hover_text(tip);
                if chosen.changed() {
                    ui.ctx().request_repaint();
                }
            }
        });
        if !states.is_stack {
            return false;
        }
    }
    let input = stack3d::Input { stack, on_stage: look.level.of(&stack.levels), subject };
    if let Some(level) = stack3d::show(ui, input, &mut states.stack3d).clicked {
        // The stage may be drawn already.
        look.level = LevelShown::Number(level);
        ui.ctx().request_repaint();
    }
    true
}

/// The errors against the truth where they are known, with the choice between them and the displacements where there
/// are both; gives whether they are shown.
fn errors(ui: &mut Ui, step: &Step, subject: Subject<'_>, states: &mut States) -> bool {
    let found = step.readouts.iter().find_map(|r| if let Readout::Distribution(all) = r { Some(all) } else { None });
    let Some(distribution) = found else { return false };
    if step.readouts.iter().any(|readout| matches!(readout, Readout::Histogram(_))) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (is_errors, text, tip) in [
                (false, "Displacements", "How often each displacement was found."),
                (true, "Errors", "How far displacements are from the true ones."),
            ] {
                if ui.selectable_value(&mut states.is_errors, is_errors, text).on_hover_text(tip).changed() {
                    ui.ctx().request_repaint();
                }
            }
        });
        if !states.is_errors {
            return false;
        }
    }
    distribution::show(ui, distribution::Input { distribution, subject }, &mut states.errors);
    true
}

/// What a chart shows that this step has nothing for, and when it does: as the panes of a sheet have it.
fn absent(pane: Pane, charts: &[Chart]) -> String {
    let is_had = |of: &&panes::Pane| of.chart.is_none_or(|chart| charts.contains(&chart));
    let is_here = |of: &&panes::Pane| of.chart.is_some_and(|chart| pane.charts().contains(&chart));
    let own = PANES.into_iter().filter(is_had).find(|of| of.title == pane.title());
    let shown = own.or_else(|| PANES.into_iter().filter(is_had).find(is_here));
    let what = shown.map_or_else(|| "Nothing is shown here".into(), |of| format!("Shows {}, {}", of.doc, of.when));
    format!("{what}. Step on ({}), or to the end of the run ({}).", Command::Into.key(), Command::End.key())
}

/// An error as a sentence: a full stop, and a capital letter unless it begins with a name.
fn sentence(error: &Error, clip: Option<&Clip>) -> String {
    let text = error.to_string();
    let named = clip.is_some_and(|clip| text.starts_with(&clip.info().name));
    let is_word = text.split(' ').next().is_some_and(|word| word.chars().all(char::is_alphabetic));
    let mut letters = text.chars();
    let first = letters.next().filter(|_| is_word && !named).map(|first| first.to_uppercase().to_string());
    let text = first.map_or_else(|| text.clone(), |first| first + letters.as_str());
    let end = if text.ends_with(['.', '!', '?']) { "" } else { "." };
    text + end
}

/// A pane with nothing in it says why.
pub fn empty(ui: &mut Ui, text: &str) {
    let dim = ui.visuals().weak_text_color();
    ui.vertical_centered(|ui| {
        ui.add_space(ui.available_height() * 0.4);
        ui.label(RichText::new(text).color(dim));
    });
}

impl Behavior<Pane> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let margin = match pane {
            Pane::Stage => Margin { left: 8, right: 8, top: 6, bottom: 4 },
            Pane::Parameters => Margin { left: 16, right: 16, top: 4, bottom: 0 },
            Pane::Why => Margin { left: 16, right: 16, top: 8, bottom: 0 },
            _ => Margin::same(8),
        };
        let fill = ui.visuals().panel_fill;
        let rect = ui.max_rect();
        ui.painter().rect_filled(rect, 0.0, fill);
        Frame::new().inner_margin(margin).show(ui, |ui| {
            ui.set_clip_rect(ui.clip_rect().intersect(rect));
            if !matches!(pane, Pane::Stage | Pane::Parameters) && self.is_stale() {
                ui.multiply_opacity(0.4);
            }
            match pane {
                Pane::Stage => self.stage(ui),
                Pane::Parameters => {
                    let (document, theme) = (self.document, self.look.theme);
                    let placing = self.states.stage.placing;
                    parameters::show(ui, parameters::Input { document, placing, theme }, self.actions);
                }
                Pane::Why => self.why(ui),
                Pane::Surface | Pane::Surface3d | Pane::Plot | Pane::Numbers | Pane::Histogram => self.chart(ui, *pane),
            }
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        self.title(*pane).into()
    }

    fn tab_ui(&mut self, tiles: &mut Tiles<Pane>, ui: &mut Ui, id: Id, tile: TileId, state: &TabState) -> Response {
        let title = tiles.get_pane(&tile).map_or("Panes", |pane| self.title(*pane));
        let alone = self.alone.contains(&tile);
        let chrome = self.look.theme.chrome();
        let font = egui::FontId::new(TextStyle::Small.resolve(ui.style()).size, style::bold());
        let galley = ui.painter().layout_no_wrap(title.into(), font, Color32::PLACEHOLDER);
        let margin = if alone { 16.0 } else { 12.0 };
        let (_, rect) = ui.allocate_space(vec2(galley.size().x + 2.0 * margin, ui.available_height()));
        let response = ui.interact(rect, id, Sense::click_and_drag()).on_hover_cursor(egui::CursorIcon::Grab);
        response.widget_info(|| WidgetInfo::selected(egui::Role::Tab, true, state.active, title));
        if state.is_being_dragged {
            return response;
        }
        let lit = state.active && !alone;
        let ink = if lit || response.hovered() { chrome.text } else { chrome.dim };
        let at = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), rect).min;
        ui.painter().galley(at, galley, style::color(ink));
        if lit {
            let line = Rect::from_min_max(rect.left_bottom() - vec2(-12.0, 2.0), rect.right_bottom() - vec2(12.0, 0.0));
            ui.painter().rect_filled(line, 1.0, style::color(chrome.accent));
        }
        response
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<Pane>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &egui_tiles::Tabs,
        _scroll: &mut f32,
    ) {
        let pane = tabs.active.and_then(|tile| tiles.get_pane(&tile));
        let command = match pane {
            Some(Pane::Parameters) => Command::ShowParameters,
            Some(Pane::Why) => Command::ShowWhy,
            Some(Pane::Stage) | None => return,
            Some(_) => Command::ShowCharts,
        };
        ui.add_space(8.0);
        let name = format!("Fold away {}", command.info().text.to_lowercase());
        let button = widgets::cross(ui, &name);
        if button.on_hover_text(format!("{name}. The buttons at the top bring it back.")).clicked() {
            self.actions.command(command);
        }
    }

    fn is_tab_bar_visible(&self, tile: TileId, _tabs: &egui_tiles::Tabs) -> bool {
        self.stage_alone != Some(tile)
    }

    fn tab_bar_height(&self, style: &egui::Style) -> f32 {
        (style.spacing.interact_size.y * 1.25).round()
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        1.0
    }

    fn min_size(&self) -> f32 {
        120.0
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        visuals.panel_fill
    }

    fn tab_bar_hline_stroke(&self, _visuals: &Visuals) -> Stroke {
        Stroke::NONE
    }

    fn resize_stroke(&self, style: &egui::Style, state: egui_tiles::ResizeState) -> Stroke {
        match state {
            egui_tiles::ResizeState::Idle => style.visuals.widgets.noninteractive.bg_stroke,
            _ => Stroke::new(2.0, style::color(self.look.theme.chrome().accent)),
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn drag_preview_color(&self, _visuals: &Visuals) -> Color32 {
        style::color(self.look.theme.chrome().accent.alpha(60))
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::{Frame, Grid};

    use super::*;

    #[test]
    fn names_are_told_as_they_are_written() {
        let clip = Clip::from_frames("waves", vec![Frame::gray(Grid::new(4, 4, 0))]).unwrap();
        let told = |text: &str| sentence(&Error::new(text), Some(&clip));
        assert_eq!(told("only.png has a single frame"), "only.png has a single frame.");
        assert_eq!(told("waves has a single frame"), "waves has a single frame.");
        assert_eq!(told("cannot open a.mp4: it is empty"), "Cannot open a.mp4: it is empty.");
    }
}
