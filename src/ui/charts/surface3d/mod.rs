//! A cost over displacements, as a surface that can be turned.
//!
//! The graphics card renders the surface; the ground, the axes and the words are egui's. Without a card the same
//! triangles are painted from back to front.

mod gpu;
mod orbit;
mod relief;

use std::cell::RefCell;
use std::hash::{DefaultHasher, Hash, Hasher};

use eframe::egui::{self, Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};
use eframe::egui_wgpu::RenderState;
use glam::Vec3;
use motionscope_core::scene::Surface;
use serde::{Deserialize, Serialize};

pub use orbit::{Orbit, Room, Screen};

use crate::paint::{ColorMap, Face, Theme, number};
use crate::ui::charts::axis::Axis;
use crate::ui::charts::heat_map;
use crate::ui::drawing::ink;
use gpu::Gpu;
use relief::{Bench, Relief};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The costs.
    pub surface: &'a Surface,
    /// Colours for small and large costs.
    pub colors: ColorMap,
    /// The look.
    pub theme: Theme,
    /// The window's graphics card, if it has one.
    pub gpu: Option<&'a RenderState>,
}

/// From where one looks; and what was made for it, as long as it stays the same.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// From where one looks.
    pub orbit: Orbit,
    #[serde(skip)]
    relief: Option<(u64, Relief)>,
    #[serde(skip)]
    gpu: Option<Gpu>,
}

/// Shows the surface in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let size = ui.available_size().max(vec2(80.0, 80.0));
    let (rect, sensed) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let name = format!("{} in three dimensions. Drag to turn, wheel to come nearer.", heat_map::summary(input.surface));
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name.clone()));
    turn(ui, &sensed, &mut state.orbit, Orbit::default());
    if !ui.is_rect_visible(rect) {
        return;
    }
    let screen = Screen::new(rect, &state.orbit, Room::SURFACE, vec2(4.5, 1.8) * input.theme.sizes().small);
    let painter = ui.painter_at(rect);
    let bench = Bench::new(input.surface);
    let (eye, theme, taken) = (state.orbit.eye(), input.theme, RefCell::default());
    let stand = Stand { painter: &painter, screen, bench, eye, theme, taken };
    stand.ground();
    stand.costs(input.surface);
    paint_surface(&painter, &screen, input, state);
    stand.pins(input.surface);
    if input.surface.range().is_none() {
        let font = ink::font(Face::Sans, input.theme.sizes().body);
        let dim = ink::color(input.theme.chrome().dim);
        let at = rect.center_top() + vec2(0.0, 2.0 * font.size);
        painter.text(at, Align2::CENTER_CENTER, "No candidate is tested yet: step on.", font, dim);
    }
}

/// Has the person turn what was `sensed`, and come nearer; a double click goes back to what is `usual`.
pub fn turn(ui: &Ui, sensed: &egui::Response, orbit: &mut Orbit, usual: Orbit) {
    if sensed.double_clicked() {
        *orbit = usual;
    }
    if sensed.dragged() {
        *orbit = orbit.turned(sensed.drag_delta());
    }
    if sensed.hovered() {
        let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        *orbit = orbit.nearer(pinch * (wheel / 400.0).exp());
    }
}

fn paint_surface(painter: &Painter, screen: &Screen, input: Input<'_>, state: &mut State) {
    let mut hasher = DefaultHasher::new();
    (heat_map::fingerprint(input.surface), input.colors.name(), input.theme).hash(&mut hasher);
    let key = hasher.finish();
    if state.relief.as_ref().is_none_or(|(known, _)| *known != key) {
        state.relief = Some((key, relief::relief(input.surface, input.colors, input.theme)));
    }
    let Some((_, relief)) = &state.relief else { return };
    let scale = painter.pixels_per_point();
    let Some(card) = input.gpu else {
        painter.add(Shape::mesh(flat(relief, screen, state.orbit.eye())));
        return;
    };
    let pixels = [screen.rect.width(), screen.rect.height()].map(|c| (c * scale).round() as u32);
    let job = gpu::Job { relief: (relief, key), view: view(screen, &state.orbit, input.theme, scale), size: pixels };
    if let Some(id) = state.gpu.get_or_insert_with(|| Gpu::new(card)).render(&job) {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.add(Shape::image(id, screen.rect, whole, Color32::WHITE));
    }
}

fn light() -> Vec3 {
    Vec3::new(-0.45, 0.8, 0.35).normalize()
}

fn view(screen: &Screen, orbit: &Orbit, theme: Theme, pixels_per_point: f32) -> gpu::View {
    let four = |v: Vec3| [v.x, v.y, v.z, 0.0];
    let width = if theme == Theme::Projector { 1.6 } else { 1.0 };
    gpu::View {
        clip_from_world: screen.clip_from_world.to_cols_array(),
        light: four(light()),
        eye: four(orbit.eye()),
        line: [0.0, 0.0, 0.0, 0.42],
        line_width: [width * pixels_per_point.max(1.0), 0.0, 0.0, 0.0],
    }
}

/// The triangles as they are seen, from back to front: for windows without a graphics card.
fn flat(relief: &Relief, screen: &Screen, eye: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let seen: Vec<(Pos2, f32)> = relief.vertices.iter().map(|vertex| screen.project(vertex.place.into())).collect();
    for (vertex, (at, _)) in relief.vertices.iter().zip(&seen) {
        let normal = Vec3::from(vertex.normal);
        let facing = normal.dot(eye - Vec3::from(vertex.place)).signum();
        let shade = 0.58 + 0.46 * (normal * facing).dot(light()).max(0.0);
        let [r, g, b, _] = vertex.color.map(|c| (f32::from(c) * shade).min(255.0) as u8);
        mesh.colored_vertex(*at, Color32::from_rgb(r, g, b));
    }
    let mut triangles: Vec<[u32; 3]> = relief.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let depth = |triangle: &[u32; 3]| triangle.iter().map(|&i| seen[i as usize].1).sum::<f32>();
    triangles.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
    mesh.indices = triangles.concat();
    mesh
}

/// The ground, the axes and the words around the surface.
struct Stand<'a> {
    painter: &'a Painter,
    screen: Screen,
    bench: Bench,
    eye: Vec3,
    theme: Theme,
    /// Where numbers stand: where two axes meet, the second would lie on the first.
    taken: RefCell<Vec<Rect>>,
}

impl Stand<'_> {
    fn at(&self, place: Vec3) -> Pos2 {
        self.screen.project(place).0
    }

    fn line(&self, from: Vec3, to: Vec3, strong: bool) {
        let chrome = self.theme.chrome();
        let color = if strong { chrome.dim } else { chrome.line };
        self.painter.line_segment([self.at(from), self.at(to)], Stroke::new(1.0, ink::color(color)));
    }

    /// A word `lines` of type further out than `place`, as seen from the middle of the ground.
    fn word(&self, place: Vec3, lines: f32, text: &str, face: Face) {
        let chrome = self.theme.chrome();
        let color = ink::color(if face == Face::Sans { chrome.dim } else { chrome.text });
        let font = ink::font(face, self.theme.sizes().small);
        let at = self.at(place);
        // Words are wider than high: they need more room sideways.
        let out = (at - self.at(Vec3::ZERO)).normalized() * vec2(1.5, 1.0) * lines * font.size;
        self.write(at + out, Align2::CENTER_CENTER, text, (font, color));
    }

    /// Writes a word unless it would lie on another.
    fn write(&self, at: Pos2, align: Align2, text: &str, (font, color): (FontId, Color32)) {
        let galley = self.painter.layout_no_wrap(text.into(), font, color);
        let rect = align.anchor_size(at, galley.size());
        let mut taken = self.taken.borrow_mut();
        if !taken.iter().any(|other| other.intersects(rect)) {
            taken.push(rect);
            self.painter.galley(rect.min, galley, color);
        }
    }

    /// The values along u or v as an axis of the world.
    fn axis(&self, which: usize) -> Axis {
        let first = self.bench.origin[which] as f32;
        let half = self.bench.half()[which];
        let last = first + self.bench.size[which].saturating_sub(1) as f32;
        Axis { values: [first, last], places: [-half, half] }
    }

    /// A grid on the ground, numbered along the two sides towards the eye.
    fn ground(&self) {
        let [half_u, half_v] = self.bench.half();
        let near_u = half_u.copysign(self.eye.x);
        let near_v = half_v.copysign(self.eye.z);
        let small = self.theme.sizes().small;
        for which in 0..2 {
            let axis = self.axis(which);
            let (along, across) = if which == 0 { (half_u, half_v) } else { (half_v, half_u) };
            let point = |a: f32, b: f32| if which == 0 { Vec3::new(a, 0.0, b) } else { Vec3::new(b, 0.0, a) };
            let near = if which == 0 { near_v } else { near_u };
            let length = (self.at(point(-along, near)) - self.at(point(along, near))).length();
            // Ticks as far apart as their numbers need on the screen.
            let on_screen = Axis { places: [0.0, length], ..axis };
            for tick in on_screen.displacement_ticks(3.0 * small) {
                let a = axis.place(tick);
                self.line(point(a, -across), point(a, across), false);
                self.word(point(a, near), 0.9, &number(tick), Face::Sans);
            }
            for side in [-across, across] {
                self.line(point(-along, side), point(along, side), side == near);
            }
            let name = if which == 0 { "u, px" } else { "v, px" };
            self.word(point(0.0, near), 2.3, name, Face::Italic);
        }
    }

    /// The axis of costs, at the corner of the ground that is furthest left.
    fn costs(&self, surface: &Surface) {
        let [u, v] = self.bench.half();
        let corners = [[-u, -v], [u, -v], [u, v], [-u, v]].map(|[x, z]| Vec3::new(x, 0.0, z));
        let Some(foot) = corners.into_iter().min_by(|a, b| self.at(*a).x.total_cmp(&self.at(*b).x)) else { return };
        let top = foot + Vec3::Y * self.bench.height(self.bench.top);
        self.line(foot, top, true);
        let small = self.theme.sizes().small;
        let length = (self.at(foot) - self.at(top)).length();
        let axis = Axis { values: [0.0, self.bench.top], places: [0.0, length] };
        let font = ink::font(Face::Sans, small);
        let dim = ink::color(self.theme.chrome().dim);
        if surface.range().is_some() {
            for tick in axis.ticks(2.2 * small, 0.0) {
                let at = self.at(foot + Vec3::Y * self.bench.height(tick));
                self.painter.hline(at.x - 4.0..=at.x, at.y, Stroke::new(1.0, dim));
                let text = number(tick);
                self.write(at - vec2(7.0, 0.0), Align2::RIGHT_CENTER, &text, (font.clone(), dim));
            }
        }
        let name = self.at(top) - vec2(0.0, 0.9 * small);
        self.painter.text(name, Align2::CENTER_BOTTOM, surface.title, font, ink::color(self.theme.chrome().text));
    }

    /// The cost at the top of each pin.
    fn pins(&self, surface: &Surface) {
        let font = ink::font(Face::Bold, self.theme.sizes().small);
        let heads: Vec<_> = relief::pins(surface)
            .into_iter()
            .filter_map(|(role, at, top)| {
                let foot = self.bench.place(at.map(|c| c as f32), 0.0);
                Some((role, heat_map::cost(surface, at)?, self.at(Vec3 { y: top, ..foot })))
            })
            .collect();
        for (role, at, top) in relief::pins(surface) {
            let Some(cost) = heat_map::cost(surface, at) else { continue };
            let foot = self.bench.place(at.map(|c| c as f32), cost);
            let (low, high) = (self.at(foot), self.at(Vec3 { y: top, ..foot }));
            // Seen faintly through what stands before it.
            let inked = self.theme.ink(role);
            let color = ink::color(inked.color).gamma_multiply(0.55);
            self.painter.line_segment([low, high], Stroke::new(inked.width.min(2.0), color));
            self.painter.circle(low, 4.0, color, Stroke::new(1.0, ink::color(inked.halo).gamma_multiply(0.55)));
        }
        for &(role, cost, head) in &heads {
            // Of two numbers each stands on its own side.
            let align = match heads.iter().find(|other| other.0 != role).map(|other| head.x < other.2.x) {
                None => Align2::CENTER_BOTTOM,
                Some(true) => Align2::RIGHT_BOTTOM,
                Some(false) => Align2::LEFT_BOTTOM,
            };
            let color = ink::color(self.theme.word(role));
            let galley = self.painter.layout_no_wrap(number(cost), font.clone(), color);
            let rect = align.anchor_size(head - vec2(0.0, 3.0), galley.size());
            let back = ink::color(self.theme.chrome().panel.alpha(200));
            self.painter.rect_filled(rect.expand2(vec2(4.0, 0.0)), 3.0, back);
            self.painter.galley(rect.min, galley, color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Vec2;
    use motionscope_core::Grid;

    #[test]
    fn without_a_card_the_nearest_triangle_comes_last() {
        let values = Grid::from_fn(5, 5, |x, y| (x + y) as f32);
        let surface =
            Surface { title: "SAD", origin: [-2, -2], values, events: Grid::new(5, 5, None), probe: None, best: None };
        let relief = relief::relief(&surface, ColorMap::Viridis, Theme::Dark);
        let orbit = Orbit { yaw_rad: 0.0, ..Orbit::default() };
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0));
        let mesh = flat(&relief, &Screen::new(rect, &orbit, Room::SURFACE, Vec2::ZERO), orbit.eye());
        assert!(mesh.is_valid() && rect.contains_rect(mesh.calc_bounds()));
        let row = |index: u32| relief.vertices[index as usize].grid[1];
        let (first, last) = (row(mesh.indices[0]), row(mesh.indices[mesh.indices.len() - 1]));
        assert!(first < last, "rows further from the eye are painted first");
    }
}
