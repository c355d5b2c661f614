//! Points in space: turning them, flying through them, and picking one.
//!
//! The graphics card renders the points below the primitives that stand around them. Without a card they are painted as they are
//! exported.

mod gpu;

use std::sync::Arc;

use eframe::egui::{self, Color32, CursorIcon, Painter, PointerButton, Pos2, Rect, Sense, Shape, Ui, pos2, vec2};
use eframe::egui_wgpu::RenderState;
use motionscope_core::scene::{Cloud, Step};
use serde::{Deserialize, Serialize};

use crate::paint::charts::cloud::{Around, SIDES_PT, Shown, Viewpoint, World, around, color, draw, summary};
use crate::paint::charts::{Drawing, Screen};
use crate::paint::{Layer, Theme};
use crate::ui::drawing::chart::{Chart, Subject};
use gpu::{Gpu, Job, Point, View};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The cloud.
    pub cloud: &'a Cloud,
    /// Whose cloud it is, and how it looks.
    pub subject: Subject<'a>,
    /// The window's graphics card, if it has one.
    pub gpu: Option<&'a RenderState>,
}

/// From where one looks, and the cloud as it is shown.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// From where one looks.
    pub viewpoint: Viewpoint,
    #[serde(skip)]
    chart: Chart<Option<World>, (Viewpoint, bool)>,
    /// The points on the card, and the step and theme that they belong to.
    #[serde(skip)]
    points: Option<(Arc<Step>, Theme)>,
    #[serde(skip)]
    gpu: Option<Gpu>,
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The pixel of the point that was clicked.
    pub picked: Option<[u16; 2]>,
}

/// Shows the cloud in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { cloud, subject, gpu } = input;
    let (area, sensed) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::click_and_drag());
    let name = || {
        format!(
            "{}. Drag to rotate, scroll to fly nearer, Shift+drag to move along the ground, click a point to explain its pixel.",
            summary(cloud)
        )
    };
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name()));
    fly(ui, &sensed, &mut state.viewpoint);
    let (painter, viewpoint) = (ui.painter_at(area), state.viewpoint);
    let shown = Shown { cloud, whose: subject.whose, viewpoint };
    let key = (area, (viewpoint, gpu.is_some()));
    let world = state.chart.lay_out(&painter, (subject, cloud), key, |area, style| {
        if gpu.is_none() {
            return draw(shown, area, style);
        }
        let Around { world, above, head } = around(shown, area, style);
        let clip = Some(world.screen().rect);
        Drawing { place: Some(world), body: vec![Layer { clip, primitives: above }], head }
    });
    if let (Some(card), Some(world)) = (gpu, world) {
        render(&painter, &world, (input, card), state);
    }
    state.chart.body(&painter);
    state.chart.head(&painter);
    let at = sensed.hover_pos().filter(|_| sensed.clicked());
    let picked = at.and_then(|at| world?.pick(cloud.data(), at.into()));
    if sensed.hovered() && !sensed.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    Response { picked }
}

/// Has the person turn what was `sensed`, fly nearer, and move along the ground; a double click goes back to the usual view.
fn fly(ui: &Ui, sensed: &egui::Response, viewpoint: &mut Viewpoint) {
    if sensed.double_clicked() {
        *viewpoint = Viewpoint::default();
    }
    let moves = ui.input(|i| i.modifiers.shift) || sensed.dragged_by(PointerButton::Secondary);
    if sensed.dragged() {
        let delta = sensed.drag_delta().into();
        *viewpoint = if moves { viewpoint.moved(delta) } else { viewpoint.turned(delta) };
    }
    if sensed.hovered() {
        let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        *viewpoint = viewpoint.nearer(pinch * (wheel / 300.0).exp());
    }
}

/// The points as the graphics card shows them.
fn render(painter: &Painter, world: &World, (input, card): (Input<'_>, &RenderState), state: &mut State) {
    let Input { cloud, subject, .. } = input;
    let gpu = state.gpu.get_or_insert_with(|| Gpu::new(card));
    let is_known = state
        .points
        .as_ref()
        .is_some_and(|(step, theme)| subject.step.is_some_and(|now| Arc::ptr_eq(step, now)) && *theme == subject.theme);
    if !is_known {
        let point = |point: &motionscope_core::scene::CloudPoint| {
            let [r, g, b] = color(point, subject.theme);
            Point { place: world.place(point.at).into(), side: world.side(point.at[2]), color: [r, g, b, 255] }
        };
        gpu.set_points(&cloud.data().points.iter().map(point).collect::<Vec<_>>());
        state.points = subject.step.map(|step| (Arc::clone(step), subject.theme));
    }
    let Screen { rect, clip_from_world } = *world.screen();
    let scale = painter.pixels_per_point();
    let rect = Rect::from_min_max(rect.min.into(), rect.max.into());
    let size = [rect.width(), rect.height()].map(|c| (c * scale).round().max(1.0));
    let view = View {
        clip_from_world: clip_from_world.to_cols_array(),
        size,
        magnification: world.magnification() * scale,
        unused: 0.0,
        sides: SIDES_PT.map(|side| side * scale),
        padding: [0.0; 2],
    };
    if let Some(id) = gpu.render(&Job { view, size: size.map(|c| c as u32) }) {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.add(Shape::image(id, rect, whole, Color32::WHITE));
    }
}
