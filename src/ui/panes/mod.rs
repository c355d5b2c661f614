//! What lies in the panes, and how they are laid out in the window.

pub mod charts;
pub mod clip_card;
pub mod explanation;
pub mod glossary;
pub mod lesson;
pub mod parameters;
pub mod presenter;
pub mod question;
pub mod start;
pub mod status;
pub mod timeline;
pub mod topbar;
pub mod transport;

use std::path::Path;
use std::sync::Arc;

use eframe::egui::{
    self, Button, CursorIcon, Frame, Margin, Pos2, Rect, RichText, Sense, Stroke, TextStyle, Ui, UiBuilder, WidgetInfo,
    vec2,
};
use eframe::egui_wgpu::RenderState;
use lucide_icons::Icon;
use motionscope_core::base::Error;
use motionscope_core::base::words::capital;
use motionscope_core::data::Clip;
use motionscope_core::params::Value;
use motionscope_core::run::{AnyEstimator, Cursor, Info};
use motionscope_core::scene::{Readout, Step};
use serde::{Deserialize, Serialize};

use super::model::document::Document;
use super::model::loader::Loading;
use super::model::pen::Pen;
use super::model::snapshot::Snapshot;
use super::model::walker::View;
use super::parts::widgets;
use crate::files;
use crate::paint::FreehandLine;
use crate::paint::charts::heat_map::event;
use crate::paint::charts::relief::standing;
use crate::ui::charts::{
    cloud3d, diagram, distribution, heat_map, histogram, matrices, plane, plots, regions, stack3d, surface3d, tiles,
};
use crate::ui::commands::{Action, Actions, Command, Owner, Side};
use crate::ui::drawing::style;
use crate::ui::layout::{self, Arrangement, Border, SHARES, Shares, StripRoom};
use crate::ui::model::chosen_charts::ChosenCharts;
use crate::ui::stage;
use crate::view::look::Look;
use crate::view::panes::{Angles, Pane};
use glossary::Beside;

/// What can be done on the stage, told once.
const HINT: &str =
    "Click a pixel to go to its result, Shift+click to go to its start. Turn the wheel to zoom, drag to move.";

/// What the panes remember between frames, and of it from one day to the next how they are looked at.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct States {
    /// Which parameters are unfolded.
    pub parameters: parameters::State,
    /// The stage.
    #[serde(skip)]
    pub stage: stage::State,
    /// Whether the pointer on the stage is meant to point.
    #[serde(skip)]
    pub pointing: Pointing,
    /// Whether it was told what can be done on the stage.
    pub has_hinted: bool,
    /// Which of several estimators is explained.
    #[serde(skip)]
    pub explained: usize,
    /// The unit and the displacement in px of a click on the cost surface, until the run is there.
    #[serde(skip)]
    pub sought: Option<(usize, [i32; 2])>,
    /// The explanation.
    #[serde(skip)]
    pub explanation: explanation::State,
    /// Sentence and formula.
    #[serde(skip)]
    pub strip: explanation::Strip,
    /// The cost surface as a heat map.
    #[serde(skip)]
    pub heat_map: heat_map::State,
    /// The cost surface in three dimensions.
    pub surface3d: surface3d::State,
    /// The levels of a pyramid in three dimensions.
    pub stack3d: stack3d::State,
    /// Points in space.
    pub cloud3d: cloud3d::State,
    /// The plane of displacements.
    #[serde(skip)]
    pub plane: plane::State,
    /// The regions of a decision.
    #[serde(skip)]
    pub regions: regions::State,
    /// A drawing of lines and nodes.
    #[serde(skip)]
    pub diagram: diagram::State,
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
    /// Small pictures with their numbers.
    #[serde(skip)]
    pub tiles: tiles::State,
    /// The line that is being drawn by hand on a chart.
    #[serde(skip)]
    pub handwriting: Option<FreehandLine>,
    /// The page of a lesson.
    #[serde(skip)]
    pub lesson: lesson::State,
}

impl States {
    /// Which of the estimators of `shown` is explained: undo may have left fewer than there were.
    pub fn explained_of(&self, shown: &Snapshot) -> usize {
        self.explained.min(shown.tiles.len().saturating_sub(1))
    }

    /// From where the things in space are looked at that `step` tells of, and what is seen of planes and pictures.
    pub fn angles(&self, step: &Step) -> Angles {
        let plane = step.readouts.iter().find_map(|r| if let Readout::Plane(plane) = r { Some(plane) } else { None });
        let plane = plane.and_then(|plane| self.plane.window(plane));
        Angles {
            surface: self.surface3d.orbit,
            pyramid: self.stack3d.orbit,
            cloud: self.cloud3d.viewpoint,
            plane,
            section: self.stage.section(),
        }
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
    /// Whether the error asks to trust a session or lesson.
    pub asks_for_trust: bool,
    /// What the panes remember.
    pub states: &'a mut States,
    /// The charts of the step that is explained.
    pub of_step: Vec<&'static Pane>,
    /// Which charts are looked at.
    pub charts: &'a mut ChosenCharts,
    /// How the person has shared out the room.
    pub shares: &'a mut Shares,
    /// Whether a step may move.
    pub animate: bool,
    /// Whether a question is open, whose answer must not be seen.
    pub is_asked: bool,
    /// Whether questions are asked, so that untested candidates are hidden.
    pub asks: bool,
    /// Whether particles may.
    pub flows: bool,
    /// Whether the parameters take the room of other panes.
    pub can_be_closed: bool,
    /// Whether there is no line at the bottom, so that work is told of on the stage.
    pub has_no_status: bool,
    /// The window's graphics card, if it has one.
    pub gpu: Option<&'a RenderState>,
    /// How it is presented.
    pub presented: Presented<'a>,
    /// How pictures look.
    pub look: &'a mut Look,
    /// What is asked for.
    pub actions: &'a mut Actions,
}

/// How the stage is presented.
#[derive(Clone, Copy)]
pub struct Presented<'a> {
    /// The pen, and what was drawn with it.
    pub pen: &'a Pen,
    /// What the mouse does on the pictures.
    pub hand: stage::Hand,
    /// Whether a magnifying glass follows the pointer.
    pub has_loupe: bool,
    /// Whether the pictures stand alone, without tools.
    pub is_bare: bool,
}

/// Whether the pointer is meant to point: one that rests while steps are taken leaves the steps their own explanation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointing {
    cursor: Option<Cursor>,
    /// Where the pointer was when the step was reached.
    rest: Option<Pos2>,
}

impl Pointing {
    /// Whether the pointer has moved since the step at `cursor` was reached.
    fn is_meant(&mut self, ui: &Ui, cursor: Cursor) -> bool {
        let at = ui.input(|input| input.pointer.latest_pos());
        if self.cursor.replace(cursor) != Some(cursor) {
            self.rest = at;
        }
        at != self.rest
    }
}

impl Panes<'_> {
    /// Shows everything where `all` says.
    pub fn show(&mut self, ui: &mut Ui, all: &Arrangement) {
        if let Some(rect) = all.stage {
            // Small pictures stand outside of it.
            let mut inside = ui.new_child(UiBuilder::new().id_salt("pictures").max_rect(rect));
            self.stage(&mut inside, &all.panes);
        }
        self.charts(ui, all);
        if let Some(rect) = all.told {
            self.told(ui, rect, all);
        }
        if let Some(rect) = all.parameters {
            self.parameters(ui, rect);
        }
        for border in &all.borders {
            self.border(ui, border);
        }
    }

    /// The explanation of the step: all of it, or the sentence and the formula.
    fn told(&mut self, ui: &mut Ui, rect: Rect, all: &Arrangement) {
        let room = all.strip;
        let margin = Margin { left: 12, right: 8, top: if room.is_some() { 6 } else { 8 }, bottom: 2 };
        self.within(ui, rect, margin, "told", |panes, ui| {
            if panes.is_stale() {
                ui.multiply_opacity(0.4);
            }
            let whole = ui.available_rect_before_wrap();
            let (above, row) = match all.has_tabs() {
                true => layout::with_row(whole, ui.spacing().interact_size.y),
                false => (whole, whole),
            };
            let mut inside = ui.new_child(UiBuilder::new().id_salt("above").max_rect(above));
            if all.has_tabs() {
                inside.set_clip_rect(inside.clip_rect().intersect(above.expand2(vec2(f32::from(margin.left), 0.0))));
            }
            match room {
                Some(room) => panes.strip(&mut inside, room),
                None => panes.explanation(&mut inside, all.is_told_wide),
            }
            if all.has_tabs() {
                panes.tabs_of_formula(&mut ui.new_child(UiBuilder::new().id_salt("tabs").max_rect(row)));
            }
        });
    }

    /// Shows `add` inside `rect`, from which nothing reaches out.
    fn within(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        margin: Margin,
        salt: impl std::hash::Hash + std::fmt::Debug,
        add: impl FnOnce(&mut Self, &mut Ui),
    ) {
        let inside = rect - margin;
        let mut ui = ui.new_child(UiBuilder::new().id_salt(salt).max_rect(inside));
        ui.set_clip_rect(ui.clip_rect().intersect(rect));
        add(self, &mut ui);
    }

    fn parameters(&mut self, ui: &mut Ui, rect: Rect) {
        let margin = Margin { left: 16, right: 10, top: 4, bottom: 0 };
        self.within(ui, rect, margin, "parameters", |panes, ui| {
            let (document, theme) = (panes.document, panes.look.theme);
            let placing = panes.states.stage.placing;
            let input = parameters::Input { document, placing, can_be_closed: panes.can_be_closed, theme };
            parameters::show(ui, input, &mut panes.states.parameters, panes.actions);
        });
    }

    /// A line between two panes that can be dragged.
    fn border(&mut self, ui: &mut Ui, border: &Border) {
        let is_upright = border.rect.height() > border.rect.width();
        // The mouse alone moves it, so Tab passes it by.
        let sense = Sense::CLICK | Sense::DRAG;
        let sensed = ui.interact(border.rect, ui.scope_id().with(("dragged", border.of)), sense);
        let sensed = sensed.on_hover_and_drag_cursor(if is_upright {
            CursorIcon::ResizeHorizontal
        } else {
            CursorIcon::ResizeVertical
        });
        let chrome = self.look.theme.chrome();
        let is_lit = sensed.hovered() || sensed.dragged();
        let (width, color) = if is_lit { (2.0, chrome.accent) } else { (1.0, chrome.line) };
        let (line, stroke) = (border.rect.center(), Stroke::new(width, style::color(color)));
        if is_upright {
            ui.painter().vline(line.x, border.rect.y_range(), stroke);
        } else {
            ui.painter().hline(border.rect.x_range(), line.y, stroke);
        }
        let share = self.shares.of(border.of);
        if sensed.double_clicked() {
            *share = 1.0;
        } else if sensed.dragged() {
            let by = sensed.drag_delta();
            *share = (*share + by.x * border.per_pt.x + by.y * border.per_pt.y).clamp(*SHARES.start(), *SHARES.end());
        }
    }

    fn stage(&mut self, ui: &mut Ui, panes: &layout::Panes) {
        let Some(shown) = &self.view.shown else {
            self.nothing_yet(ui);
            return;
        };
        let heat = self.explained(shown).1.readouts.iter().find_map(|readout| match readout {
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
            step: Some(&shown.step).filter(|_| !self.is_asked),
            hides_untested: self.asks,
            cursor: shown.cursor,
            lockstep: self.lockstep(shown),
            stands: shown.stands(shown.subject.experiment.estimator.shows_frame_alone()),
            look: *self.look,
            orbit: self.states.surface3d.orbit,
            heat: heat.or(shown.scene.heat).unwrap_or_default(),
            placing: placing.as_ref(),
            gpu: self.gpu,
            available: &shown.available,
            checking: self.view.checking,
            animate: self.animate,
            flows: self.flows,
            presenting: stage::Presenting {
                hand: self.presented.hand,
                freehand: self.presented.pen.lines(&shown.subject, shown.cursor),
                can_undo_ink: self.presented.pen.history(&shown.subject, shown.cursor)[0],
                has_loupe: self.presented.has_loupe,
                is_bare: self.presented.is_bare,
            },
            panes,
            // At the end of a run its field is looked at, which lies on frame t.
            is_search: shown.subject.experiment.estimator.tests_candidates() && !shown.at_end,
        };
        let response = stage::show(ui, input, &mut self.states.stage);
        let is_meant = self.states.pointing.is_meant(ui, shown.cursor);
        let hovered = response.hovered.filter(|_| is_meant);
        self.actions.ask(Action::Focus(hovered));
        // In front of a class nothing lies over the chart.
        if hovered.is_some() && !self.presented.is_bare && !std::mem::replace(&mut self.states.has_hinted, true) {
            self.actions.ask(Action::Hint(HINT));
        }
        if let Some(explained) = response.explained {
            self.states.explained = explained;
        }
        if let Some(pace) = response.paced {
            self.actions.ask(Action::Pace(pace));
        }
        *self.look = response.look;
        self.states.surface3d.orbit = response.orbit;
        self.place(placing.as_ref(), (&response, shown));
        if response.left {
            self.actions.command(Command::Lockstep);
        }
        if let Some(line) = response.drawn {
            self.actions.ask(Action::Draw(Box::new(line)));
        }
        if let Some(wish) = response.pen {
            self.actions.ask(Action::Pen(wish));
        }
        if let Some(at) = response.sought {
            let (_, step) = self.explained(shown);
            let tested = standing(step).and_then(|readout| event(&readout.landscape()?, at));
            let cursor = |event| Cursor { event, ..shown.cursor };
            self.actions.ask(tested.map_or(Action::SeekCandidate(at), |event| Action::Seek(cursor(event))));
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
        let explained = self.states.explained_of(shown);
        tiles.get(explained)?;
        Some(stage::Lockstep { tiles, explained, experiment: &shown.subject.experiment })
    }

    /// The explanation in the window, beside the stage that shows `shown`.
    fn explanation_input<'a>(&self, shown: &'a Snapshot, beside: &'a Beside<'a>) -> explanation::Input<'a> {
        let (info, step) = self.explained(shown);
        // One of several estimators has no step before.
        let before = shown.before.as_deref().filter(|_| Arc::ptr_eq(step, &shown.step));
        explanation::Input { info, step, before, beside, at_end: shown.at_end, theme: self.look.theme }
    }

    /// The estimator that is explained, and what it tells.
    fn explained<'a>(&self, shown: &'a Snapshot) -> (&'static Info, &'a Arc<Step>) {
        match self.lockstep(shown) {
            Some(all) => (all.tiles[all.explained].info, &all.tiles[all.explained].step),
            None => (shown.info, &shown.step),
        }
    }

    /// Shows progress and errors above the pictures.
    pub fn banners(&mut self, ui: &mut Ui) {
        if let Some(loading) = self.loading {
            self.opening(ui, loading);
        }
        if let Some(work) = status::work(self.view).filter(|_| self.has_no_status && self.view.shown.is_some()) {
            ui.horizontal(|ui| status::progress(ui, &work, self.actions));
        }
        // What is still shown of another clip is no news of this one.
        let shown = self.view.shown.as_ref().filter(|shown| self.document.is_of_clip(shown));
        let failure = shown.and_then(|shown| shown.failure.as_ref());
        let error = self.error.or(self.view.refused.as_ref()).or(self.document.refused()).or(failure);
        let Some(error) = error else { return };
        let text = sentence(error, self.document.clip());
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
                    if self.asks_for_trust {
                        if ui.button("Open these files").clicked() {
                            self.actions.ask(Action::Trust);
                        }
                    } else if ui.button(way_out).clicked() {
                        self.actions.command(command);
                    }
                    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                        let label = ui.add(egui::Label::new(&text).wrap().selectable(true));
                        label.widget_info(|| WidgetInfo::labeled(egui::Role::Alert, true, &text));
                    });
                });
            });
        });
        ui.add_space(8.0);
    }

    fn opening(&mut self, ui: &mut Ui, loading: &Loading) {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("Opening {}…", widgets::elide(&files::label(Path::new(&loading.name)).to_string(), 64)));
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
            return empty(ui, "No run: choose another estimator, or change its parameters.");
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
                ui.add_space((ui.available_width() - 26.0 * size).max(0.0) / 2.0);
                for command in [Command::Open, Command::Samples, Command::Lessons] {
                    let face = command.entry();
                    let button = Button::new((widgets::icon(ui, face.icon), face.text));
                    if ui.add(button.min_size(vec2(8.0 * size, 2.4 * size))).clicked() {
                        self.actions.command(command);
                    }
                }
            });
        });
    }

    fn explanation(&mut self, ui: &mut Ui, is_wide: bool) {
        match &self.view.shown {
            Some(shown) => {
                let beside = Beside::new(&shown.scene, self.explained(shown).0.family, self.look.theme);
                let input = self.explanation_input(shown, &beside);
                explanation::show(ui, (input, is_wide), &mut self.states.explanation);
                self.states.stage.point_out(beside.pointed());
            }
            None => empty(ui, &self.before("No step is explained")),
        }
    }

    /// Sentence and formula.
    fn strip(&mut self, ui: &mut Ui, room: StripRoom) {
        if let Some(shown) = &self.view.shown {
            let beside = Beside::new(&shown.scene, self.explained(shown).0.family, self.look.theme);
            let input = self.explanation_input(shown, &beside);
            explanation::strip(ui, (input, room), &mut self.states.strip);
            self.states.stage.point_out(beside.pointed());
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
}

/// An error as a sentence: a full stop, and a capital letter unless it begins with a name.
fn sentence(error: &Error, clip: Option<&Clip>) -> String {
    let text = error.to_string();
    let named = clip.is_some_and(|clip| text.starts_with(&clip.info().name));
    let is_word = text.split(' ').next().is_some_and(|word| word.chars().all(char::is_alphabetic));
    let text = if is_word && !named { capital(&text) } else { text };
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

#[cfg(test)]
mod tests {
    use motionscope_core::data::Frame;
    use motionscope_core::geometry::Grid;

    use super::*;

    #[test]
    fn names_are_reported_as_they_are_written() {
        let clip = Clip::from_frames("waves", vec![Frame::gray(Grid::new(4, 4, 0))]).unwrap();
        let explained = |text: &str| sentence(&Error::new(text), Some(&clip));
        assert_eq!(explained("only.png has a single frame"), "only.png has a single frame.");
        assert_eq!(explained("waves has a single frame"), "waves has a single frame.");
        assert_eq!(explained("cannot open a.mp4: it is empty"), "Cannot open a.mp4: it is empty.");
    }
}
