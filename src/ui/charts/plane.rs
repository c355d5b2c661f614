//! The plane of displacements: coming nearer, going along and pointing at a displacement.

use eframe::egui::{self, Sense, Ui, vec2};
use motionscope_core::scene::Plane;

use crate::paint::charts::plane::{Shown, Square, Window, draw, head, summary};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_of};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The lines and points.
    pub plane: &'a Plane,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
}

/// The plane as it is shown, and which part of it.
#[derive(Default)]
pub struct State {
    chart: Chart<Square, Option<Window>>,
    /// The part that one has come near to, of a plane of this title and unit.
    near: Option<(&'static str, String, Window)>,
}

impl State {
    /// The part of `plane` that is seen, unless it is all of it.
    pub fn window(&self, plane: &Plane) -> Option<Window> {
        let (title, unit, window) = self.near.as_ref()?;
        (*title == plane.title && *unit == plane.unit).then_some(*window)
    }
}

/// Shows the plane as large as it fits.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let Input { plane, subject } = input;
    let size = ui.available_size().max(vec2(80.0, 80.0));
    let (area, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let name = || format!("{}. Scroll to zoom, drag to pan, double-click to reset.", summary(plane));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name()));
    let painter = ui.painter_at(area);
    let lay_out = |state: &mut State| {
        let window = state.window(plane);
        let data = Shown { plane, whose: subject.whose, window, has_names_beside: false };
        let draw = |area, style| draw(data, area, style);
        (data, state.chart.lay_out(&painter, (subject, plane), (area, window), draw))
    };
    let (_, square) = lay_out(state);
    travel(ui, &response, (plane, &square), state);
    let (data, square) = lay_out(state);
    state.chart.body(&painter);
    let pointed = response.hover_pos().and_then(|at| square.displacement(at.into()));
    match pointed {
        Some(at) => over(&painter, &head(data, &square, rect_of(area), Some(at), subject.style(&painter))),
        None => state.chart.head(&painter),
    }
}

/// Comes nearer and goes along as the person wants; a double click shows all again.
fn travel(ui: &Ui, sensed: &egui::Response, (plane, square): (&Plane, &Square), state: &mut State) {
    if sensed.double_clicked() {
        state.near = None;
        return;
    }
    let now = state.window(plane);
    let mut window = now.unwrap_or(Window::whole(plane));
    if let Some(at) = sensed.hover_pos().and_then(|at| square.displacement(at.into())) {
        let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = pinch * (wheel / 200.0).exp();
        if factor != 1.0 {
            window = window.nearer(at, factor, plane);
        }
    }
    if sensed.dragged() {
        let by = -sensed.drag_delta() * square.per_point();
        window = window.moved(by.into(), plane);
    }
    if window != now.unwrap_or(Window::whole(plane)) {
        state.near = Some((plane.title, plane.unit.clone(), window));
    }
}
