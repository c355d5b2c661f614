//! A cost over displacements, as a surface that can be turned.
//!
//! The graphics card renders the triangles of the surface between the primitives that stand around it. Without a card, the
//! surface is painted as primitives too, as it is exported.

mod gpu;

use eframe::egui::{self, Color32, Painter, Pos2, Rect, Sense, Shape, Ui, pos2, vec2};
use eframe::egui_wgpu::RenderState;
use glam::Vec3;
use motionscope_core::scene::Surface;
use serde::{Deserialize, Serialize};

pub use crate::paint::charts::Orbit;
use crate::paint::charts::heat_map;
use crate::paint::charts::relief::mesh::{self, Relief as Mesh};
use crate::paint::charts::relief::{self, Around, LINES, Relief};
use crate::paint::charts::{Drawing, Screen};
use crate::paint::{ColorMap, Layer, Theme, primitive};
use crate::ui::drawing::chart::{Chart, Subject};
use gpu::Gpu;

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The costs.
    pub surface: &'a Surface,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
    /// The window's graphics card, if it has one.
    pub gpu: Option<&'a RenderState>,
}

/// From where one looks; and what was made for it, as long as it stays the same.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// From where one looks.
    pub orbit: Orbit,
    /// What lies behind the surface of the graphics card, or all of it where there is none.
    #[serde(skip)]
    chart: Chart<Option<Screen>, (Orbit, bool)>,
    /// What lies before it.
    #[serde(skip)]
    front: Chart<(), Orbit>,
    #[serde(skip)]
    renderer: Renderer,
}

/// A surface as the graphics card renders it; what was made is kept as long as it stays the same.
#[derive(Default)]
pub struct Renderer {
    mesh: Option<(u64, Mesh)>,
    gpu: Option<Gpu>,
}

impl Clone for Renderer {
    /// What was made on the card belongs to one alone.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Shows the surface in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let Input { surface, subject, gpu } = input;
    let size = ui.available_size().max(vec2(80.0, 80.0));
    let (area, sensed) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let name = || format!("{} in three dimensions. Drag to rotate, scroll to zoom.", heat_map::summary(surface));
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name()));
    turn(ui, &sensed, &mut state.orbit, Orbit::default());
    if !ui.is_rect_visible(area) {
        return;
    }
    let (painter, orbit) = (ui.painter_at(area), state.orbit);
    let data = Relief { surface, whose: subject.whose, orbit };
    let key = (area, (orbit, gpu.is_some()));
    let screen = state.chart.lay_out(&painter, (subject, surface), key, |area, style| {
        let (place, body, head) = if gpu.is_some() {
            let Around { screen, below, head, .. } = relief::around(data, area, style);
            (screen, vec![Layer { clip: Some(area), primitives: below }], head)
        } else {
            let Drawing { place, body, head } = relief::draw(data, area, style);
            (place, body, head)
        };
        Drawing { place: Some(place), body, head }
    });
    state.chart.body(&painter);
    if let (Some(card), Some(screen)) = (gpu, screen) {
        let seen = Seen { screen: &screen, eye: orbit.eye(), opacity: 1.0 };
        state.renderer.paint(&painter, seen, surface, (subject.theme, subject.colors), card);
        state.front.lay_out(&painter, (subject, surface), (area, orbit), |area, style| {
            let layer = Layer { clip: Some(area), primitives: relief::around(data, area, style).above };
            Drawing { place: (), body: vec![layer], head: Vec::new() }
        });
        state.front.body(&painter);
    }
    state.chart.head(&painter);
}

/// Has the person turn what was `sensed`, and come nearer; a double click goes back to what is `usual`.
pub fn turn(ui: &Ui, sensed: &egui::Response, orbit: &mut Orbit, usual: Orbit) {
    if sensed.double_clicked() {
        *orbit = usual;
    }
    if sensed.dragged() {
        *orbit = orbit.turned(sensed.drag_delta().into());
    }
    if sensed.hovered() {
        let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        *orbit = orbit.nearer(pinch * (wheel / 400.0).exp());
    }
}

/// How a surface is seen.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// The camera.
    pub screen: &'a Screen,
    /// Where it stands.
    pub eye: Vec3,
    /// From 0 to 1.
    pub opacity: f32,
}

impl Renderer {
    /// Paints `surface` as the graphics card shows it.
    pub fn paint(
        &mut self,
        painter: &Painter,
        seen: Seen<'_>,
        surface: &Surface,
        (theme, colors): (Theme, ColorMap),
        card: &RenderState,
    ) {
        let key = fingerprint(surface, (theme, colors));
        if self.mesh.as_ref().is_none_or(|(known, _)| *known != key) {
            self.mesh = Some((key, mesh::relief(surface, colors, theme)));
        }
        let Some((_, mesh)) = &self.mesh else { return };
        let scale = painter.pixels_per_point();
        let Some((part, size)) = covered(mesh, seen.screen, scale) else { return };
        let rect = Rect::from_min_max(part.min.into(), part.max.into());
        let screen = &seen.screen.cut(part);
        let job = gpu::Job { relief: (mesh, key), view: view(Seen { screen, ..seen }, theme, scale), size };
        if let Some(id) = self.gpu.get_or_insert_with(|| Gpu::new(card)).render(&job) {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.add(Shape::image(id, rect, whole, Color32::WHITE.gamma_multiply(seen.opacity)));
        }
    }
}

/// The part of `screen` that a mesh covers, and its size in pixels: each costs time where the processor has to draw.
fn covered(mesh: &Mesh, screen: &Screen, scale: f32) -> Option<(primitive::Rect, [u32; 2])> {
    /// Sides grow by this many pixels at a time, so that no new picture is needed for each angle.
    const STEP: u32 = 64;
    let seen: Vec<_> = mesh.vertices.iter().map(|vertex| screen.project(vertex.place.into())).collect();
    let is_behind_the_eye = seen.iter().any(|(_, depth)| *depth > 1.0);
    let [across, down] = [0, 1].map(|i| {
        let [from, to] = [screen.rect.min[i], screen.rect.max[i]];
        let (least, most) = seen.iter().fold((to, from), |(least, most), (at, _)| (least.min(at[i]), most.max(at[i])));
        let (least, most) = if is_behind_the_eye { (from, to) } else { (least.max(from), most.min(to)) };
        let [first, end] = [((least - from) * scale).floor(), ((most - from) * scale).ceil()];
        (end > first).then(|| (from + first / scale, ((end - first) as u32).next_multiple_of(STEP)))
    });
    let ((left, width), (top, height)) = (across?, down?);
    let size = [width, height];
    Some((primitive::Rect::new([left, top], size.map(|side| side as f32 / scale)), size))
}

/// A number that changes when the triangles do.
fn fingerprint(surface: &Surface, (theme, colors): (Theme, ColorMap)) -> u64 {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    (surface.values.size(), surface.origin, surface.probe, surface.best, theme, colors.name()).hash(&mut hasher);
    for (_, role, at) in &surface.named {
        (role, at.map(f32::to_bits)).hash(&mut hasher);
    }
    for costs in std::iter::once(&surface.values).chain(surface.faint()) {
        bytemuck::cast_slice::<f32, u8>(costs.cells()).hash(&mut hasher);
    }
    hasher.finish()
}

fn view(Seen { screen, eye, .. }: Seen<'_>, theme: Theme, pixels_per_point: f32) -> gpu::View {
    let four = |v: Vec3| [v.x, v.y, v.z, 0.0];
    gpu::View {
        clip_from_world: screen.clip_from_world.to_cols_array(),
        light: four(relief::light()),
        eye: four(eye),
        line: [0.0, 0.0, 0.0, LINES],
        line_width: [relief::line_width(theme) * pixels_per_point.max(1.0), 0.0, 0.0, 0.0],
    }
}
