//! The charts of a step: which are seen, the tabs above them, and what a click in one asks for.

use eframe::egui::{self, Align, Button, Layout, Rect, RichText, TextStyle, Ui, WidgetInfo};
use lucide_icons::Icon;
use motionscope_core::base::words::capital;
use motionscope_core::run::Cursor;
use motionscope_core::scene::Readout;

use super::Panes;
use super::glossary::{self, Beside};
use crate::paint::charts::Orbit;
use crate::paint::charts::cloud::Viewpoint;
use crate::paint::charts::plane::Window;
use crate::paint::{FreehandLine, Ground};
use crate::ui::charts::heat_map::Clicked;
use crate::ui::charts::{
    cloud3d, diagram, distribution, handwriting, heat_map, histogram, matrices, plane, plots, regions, stack3d,
    surface3d, tiles,
};
use crate::ui::commands::{Action, Command, Side};
use crate::ui::drawing::chart::Subject;
use crate::ui::layout::Arrangement;
use crate::ui::parts::widgets;
use crate::ui::stage::Hand;
use crate::view::panes::{self, Angles, Pane};

/// The contents of the line of tabs.
#[derive(Clone, Copy)]
struct Tabs<'a> {
    /// Which of the places of charts it belongs to.
    place: usize,
    /// The charts of the step.
    all: &'a [&'static Pane],
    /// Those that are seen; none where the formula has their place.
    seen: &'a [&'static Pane],
    /// Whether the formula can have the place of the chart.
    has_formula: bool,
}

impl Panes<'_> {
    /// Shows a chart in each of its places.
    pub(super) fn charts(&mut self, ui: &mut Ui, arranged: &Arrangement) {
        let places = &arranged.charts[..];
        let all = self.of_step.clone();
        let seen = self.charts.seen(&all, places.len());
        if !self.presented.is_bare || seen.is_empty() {
            let is_drawing = ui.input(|input| input.pointer.primary_down());
            self.states.handwriting = self.states.handwriting.take().filter(|_| is_drawing).map(FreehandLine::given_up);
        }
        for (place, (pane, rect)) in seen.iter().zip(places).enumerate() {
            self.within(
                ui,
                *rect,
                egui::Margin { left: 8, right: 8, top: 0, bottom: 6 },
                ("chart", place),
                |panes, ui| {
                    let has_formula = arranged.alternates && place == 0;
                    panes.tabs(ui, Tabs { place, all: &all, seen: &seen, has_formula });
                    if panes.is_stale() {
                        ui.multiply_opacity(0.4);
                    }
                    let area = ui.available_rect_before_wrap();
                    ui.push_id(pane.id, |ui| panes.chart(ui, pane));
                    panes.handwriting(ui, area, pane);
                },
            );
        }
    }

    /// The line below a formula that has the place of the charts: what could stand there.
    pub(super) fn tabs_of_formula(&mut self, ui: &mut Ui) {
        let all = self.of_step.clone();
        self.tabs(ui, Tabs { place: 0, all: &all, seen: &[], has_formula: true });
    }

    /// The line above a chart: what it is, what could stand there, and how to see it larger.
    fn tabs(&mut self, ui: &mut Ui, tabs: Tabs<'_>) {
        let Tabs { place, all, seen, has_formula } = tabs;
        let height = ui.spacing().interact_size.y;
        let row = Rect::from_min_size(ui.cursor().min, egui::vec2(ui.available_width(), height));
        let row_ui =
            &mut ui.new_child(egui::UiBuilder::new().max_rect(row).layout(Layout::right_to_left(Align::Center)));
        row_ui.spacing_mut().item_spacing.x = 1.0;
        row_ui.spacing_mut().button_padding.x *= 0.75;
        if place == 0 && !seen.is_empty() {
            let (glyph, name) = match self.charts.is_enlarged {
                true => (Icon::Minimize2, "Back to the stage"),
                false => (Icon::Maximize2, "Enlarge the chart"),
            };
            let tip = Command::EnlargeChart.with_key("Show the chart in the place of the stage, or the stage again.");
            if widgets::icon_button(row_ui, glyph, name, false).on_hover_text(tip).clicked() {
                self.actions.command(Command::EnlargeChart);
            }
        }
        let mut chosen = None;
        let id = self.view.shown.as_deref().map_or("", |shown| self.explained(shown).0.id);
        let widest = &mut self.charts.widest;
        let formula_tab = row_ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let now = seen.get(place).copied();
            let mut is_formula_chosen = false;
            let padding = 2.0 * ui.spacing().button_padding.x + 1.0;
            let font = TextStyle::Small.resolve(ui.style());
            let width = |pane: &&Pane| {
                let words = pane.title.to_owned();
                ui.painter().layout_no_wrap(words, font.clone(), egui::Color32::PLACEHOLDER).size().x + padding
            };
            let formula = "Formula";
            let of_formula =
                ui.painter().layout_no_wrap(formula.into(), font.clone(), egui::Color32::PLACEHOLDER).size().x;
            let needed: f32 = all.iter().map(width).sum::<f32>() + if has_formula { of_formula + padding } else { 0.0 };
            // Steps with fewer charts keep the form that the longest row has, so that it does not change to and fro.
            let known = widest.filter(|(of, size, _)| (*of, *size) == (id, font.size));
            let needed = known.map_or(needed, |(.., before)| before.max(needed));
            *widest = Some((id, font.size, needed));
            if needed <= ui.available_width() {
                if has_formula {
                    let tab = ui.add(Button::selectable(now.is_none(), RichText::new(formula).small()));
                    tab.widget_info(|| WidgetInfo::selected(egui::Role::Tab, true, now.is_none(), formula));
                    is_formula_chosen = tab.on_hover_text("The formula of the step, in numbers.").clicked();
                }
                for pane in all {
                    let is_now = Some(*pane) == now;
                    let tab = ui.add(Button::selectable(is_now, RichText::new(pane.title).small()));
                    tab.widget_info(|| WidgetInfo::selected(egui::Role::Tab, true, is_now, pane.title));
                    if tab.on_hover_text(sentence(pane.doc)).clicked() {
                        chosen = Some(*pane);
                    }
                }
                return is_formula_chosen;
            }
            let title = RichText::new(now.map_or(formula, |pane| pane.title)).small();
            let list = egui::ComboBox::from_id_salt(("charts", place)).selected_text(title);
            let list = list.show_ui(ui, |ui| {
                is_formula_chosen = has_formula && ui.selectable_label(now.is_none(), formula).clicked();
                for pane in all {
                    if ui.selectable_label(Some(*pane) == now, pane.title).on_hover_text(sentence(pane.doc)).clicked() {
                        chosen = Some(*pane);
                    }
                }
            });
            list.response.accessible_name("Chart");
            is_formula_chosen
        });
        let is_formula_chosen = formula_tab.inner;
        ui.advance_cursor_after_rect(row);
        if let Some(pane) = chosen {
            self.charts.choose(place, pane, seen);
        }
        if has_formula && (chosen.is_some() || is_formula_chosen) {
            self.charts.is_preferred = chosen.is_some();
        }
    }

    /// What is drawn by hand on a chart of the full screen, seen while the chart shows the same step from the same viewpoint.
    fn handwriting(&mut self, ui: &Ui, area: Rect, pane: &'static Pane) {
        let Some(shown) = self.view.shown.as_deref().filter(|_| self.presented.is_bare) else { return };
        let color = if let Hand::Draw(color) = self.presented.hand { Some(color) } else { None };
        let angles = self.states.angles(self.explained(shown).1);
        let input = handwriting::Input {
            pane: pane.id,
            view: view_of(pane, &angles, self.states.matrices.scrolled),
            member: self.states.explained_of(shown),
            step: shown.cursor,
            freehand: self.presented.pen.lines(&shown.subject, shown.cursor),
            color,
            theme: self.look.theme,
        };
        if let Some(line) = handwriting::show(ui, area, input, &mut self.states.handwriting) {
            self.actions.ask(Action::Draw(Box::new(line)));
        }
    }

    fn chart(&mut self, ui: &mut Ui, pane: &'static Pane) {
        let Some(shown) = self.view.shown.as_deref() else { return };
        let (info, step) = self.explained(shown);
        let subject = Subject { step: Some(step), whose: info.name, theme: self.look.theme, colors: self.look.colors };
        let estimator = &shown.subject.experiment.estimator;
        let mut event = None;
        if *pane == panes::SERIES {
            event = plots::show(ui, step, subject, &mut self.states.plots);
        }
        for readout in &step.readouts {
            match readout {
                Readout::Surface(surface) if *pane == panes::SURFACE => {
                    let input = heat_map::Input { surface, subject };
                    match heat_map::show(ui, input, &mut self.states.heat_map).clicked {
                        Some(Clicked::Tested(tester)) => event = Some(tester),
                        Some(Clicked::Untested(at)) => self.actions.ask(Action::SeekCandidate(at)),
                        None => {}
                    }
                }
                Readout::Surface(surface) if *pane == panes::SURFACE_3D => {
                    let input = surface3d::Input { surface, subject, gpu: self.gpu };
                    surface3d::show(ui, input, &mut self.states.surface3d);
                }
                Readout::Plane(plane) if *pane == panes::PLANE => {
                    plane::show(ui, plane::Input { plane, subject }, &mut self.states.plane);
                }
                Readout::Regions(regions) if *pane == panes::REGIONS => {
                    regions::show(ui, regions::Input { regions, subject }, &mut self.states.regions);
                }
                Readout::Diagram(drawing) if *pane == panes::DIAGRAM => {
                    diagram::show(ui, (drawing, subject), &mut self.states.diagram);
                }
                Readout::Tiles(tiles) if *pane == panes::TILES => {
                    let is_centered = !estimator.tests_candidates();
                    tiles::show(ui, tiles::Input { tiles, is_centered, subject }, &mut self.states.tiles);
                }
                Readout::Matrices(all) if *pane == panes::MATRICES => {
                    let pointed = matrices::show(ui, (all, step.formulas()), subject, &mut self.states.matrices);
                    if let Some((index, sensed)) = pointed {
                        let beside = Beside::new(&shown.scene, info.family, self.look.theme);
                        glossary::sense_symbol(&sensed, (all[index].symbol, all[index].role), &beside);
                        self.states.stage.point_out(beside.pointed());
                    }
                }
                Readout::Histogram(counts) if *pane == panes::HISTOGRAM => {
                    // The units of several in lockstep are their own, and not those of this estimator.
                    let input = histogram::Input { histogram: counts, leads: shown.tiles.is_empty(), subject };
                    if let Some(unit) = histogram::show(ui, input, &mut self.states.histogram).clicked {
                        self.actions.ask(Action::Seek(Cursor { unit, event: usize::MAX }));
                    }
                }
                Readout::Distribution(distribution) if *pane == panes::ERRORS => {
                    distribution::show(ui, distribution::Input { distribution, subject }, &mut self.states.errors);
                }
                Readout::Cloud(cloud) if *pane == panes::CLOUD => {
                    let picked =
                        cloud3d::show(ui, cloud3d::Input { cloud, subject, gpu: self.gpu }, &mut self.states.cloud3d)
                            .picked;
                    if let Some(pixel) = picked {
                        let at = motionscope_core::scene::Focus::current(pixel.map(f32::from));
                        self.actions.ask(Action::SeekAt(at, Side::End));
                    }
                }
                Readout::Stack(stack) if *pane == panes::PYRAMID => {
                    let input = stack3d::Input { stack, on_stage: self.look.level.of(&stack.levels), subject };
                    if let Some(level) = stack3d::show(ui, input, &mut self.states.stack3d).clicked {
                        self.look.level = crate::paint::LevelShown::Number(level);
                    }
                }
                _ => continue,
            }
            break;
        }
        if let Some(event) = event {
            self.actions.ask(Action::Seek(Cursor { event, ..shown.cursor }));
        }
    }
}

/// What the layout of `pane` depends on beside its step and its area, as numbers; `None` if all of it is as at first.
fn view_of(pane: &Pane, angles: &Angles, scrolled: [f32; 2]) -> Option<[f32; Ground::VIEW]> {
    let orbit = |Orbit { yaw_rad, pitch_rad, zoom }: Orbit| [yaw_rad, pitch_rad, zoom, 0.0, 0.0, 0.0];
    let window = |Window { center: [u, v], reach }: Window| [u, v, reach, 0.0, 0.0, 0.0];
    let numbers = |angles: &Angles, [right, down]: [f32; 2]| match pane {
        pane if *pane == panes::SURFACE_3D => orbit(angles.surface),
        pane if *pane == panes::PYRAMID => orbit(angles.pyramid),
        pane if *pane == panes::PLANE => angles.plane.map_or([0.0; Ground::VIEW], window),
        pane if *pane == panes::MATRICES => [right, down, 0.0, 0.0, 0.0, 0.0],
        pane if *pane == panes::CLOUD => {
            let Viewpoint { yaw_rad, pitch_rad, distance, target: [x, y, z] } = angles.cloud;
            [yaw_rad, pitch_rad, distance, x, y, z]
        }
        _ => [0.0; Ground::VIEW],
    };
    let now = numbers(angles, scrolled);
    (now != numbers(&Angles::default(), [0.0; 2])).then_some(now)
}

/// A doc as a sentence.
fn sentence(doc: &str) -> String {
    capital(doc) + "."
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_has_a_view_of_its_own_once_it_is_turned_or_scrolled() {
        let usual = Angles::default();
        for pane in panes::PANES {
            assert_eq!(view_of(pane, &usual, [0.0; 2]), None, "{}", pane.id);
        }
        let surface = usual.surface.turned([30.0, 0.0]);
        let cloud = usual.cloud.moved([0.0, 20.0]);
        let plane = Some(Window { center: [1.0, -0.5], reach: 0.25 });
        let changed = Angles { surface, cloud, plane, ..usual };
        let views = |pane: &Pane, scrolled| view_of(pane, &changed, scrolled);
        for pane in panes::PANES {
            let is_turned = [panes::SURFACE_3D, panes::CLOUD, panes::PLANE].contains(pane);
            assert_eq!(views(pane, [0.0; 2]).is_some(), is_turned, "{}", pane.id);
        }
        assert_eq!(views(&panes::PLANE, [0.0; 2]), Some([1.0, -0.5, 0.25, 0.0, 0.0, 0.0]));
        assert_eq!(views(&panes::MATRICES, [0.0, 40.0]), Some([0.0, 40.0, 0.0, 0.0, 0.0, 0.0]));
        assert_eq!(views(&panes::SURFACE, [0.0, 40.0]), None, "others are not scrolled by that");
    }
}
