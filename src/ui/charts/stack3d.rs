//! A pyramid as a stack of pictures that can be turned, with the block at hand and its vector on every level.
//!
//! Pictures and marks are egui's own meshes, so that they look the same with and without a graphics card.

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, CursorIcon, Mesh, Painter, Pos2, Rect, Sense, Shape, Stroke, TextureHandle, TextureOptions,
    Ui, pos2, vec2,
};
use glam::Vec3;
use motionscope_core::{Floor, Frame, Role, Stack};
use serde::{Deserialize, Serialize};

use crate::paint::{Face, Theme, number};
use crate::ui::charts::surface3d::{Orbit, Room, Screen, turn};
use crate::ui::drawing::ink;
use crate::ui::stage;

/// How much narrower each level is than the one below: half would be true, but nothing could be seen at the top.
const TAPER: f32 = 0.84;
/// Between two levels, where the longer side of the lowest is 2.
const GAP: f32 = 0.5;
/// The highest stack.
const HIGHEST: f32 = 1.6;
/// From where one looks at first: flatter than at a surface, so that many levels have room above each other.
const USUAL: Orbit = Orbit { yaw_rad: -0.5, pitch_rad: 0.5, zoom: 1.0 };
/// Quads along each side of a plane: a texture bends along triangles, which must be small.
const QUADS: usize = 12;
/// Pictures larger than this are reduced; a plane is small on the screen.
const LONGEST_PX: usize = 1024;

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The pyramid.
    pub stack: &'a Stack,
    /// The level whose picture stands on the stage.
    pub on_stage: usize,
    /// The look.
    pub theme: Theme,
}

/// From where one looks, and the pictures as textures.
#[derive(Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// From where one looks.
    pub orbit: Orbit,
    #[serde(skip)]
    textures: Vec<(Arc<Frame>, TextureHandle)>,
}

impl Default for State {
    fn default() -> Self {
        Self { orbit: USUAL, textures: Vec::new() }
    }
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The level that was clicked.
    pub clicked: Option<usize>,
}

/// What the stack shows, in words.
pub fn summary(stack: &Stack) -> String {
    let level = |(level, floor): (usize, &Floor)| match floor.vector {
        Some((vector, Role::Result)) => format!("{}: found {}", heading(stack, level), told(vector)),
        Some((vector, _)) => format!("{}: best so far {}", heading(stack, level), told(vector)),
        None => heading(stack, level),
    };
    let levels: Vec<_> = stack.floors.iter().enumerate().rev().map(level).collect();
    format!("Pyramid. {}", levels.join("; "))
}

fn heading(stack: &Stack, level: usize) -> String {
    let (width, height) = stack.levels.size(level);
    format!("Level {level}, {width}×{height} px")
}

fn told([u, v]: [f32; 2]) -> String {
    format!("({}, {}) px", number(u), number(v))
}

/// Shows the stack in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { stack, theme, .. } = input;
    let (area, sensed) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::click_and_drag());
    let name = || format!("{}. Drag to turn, wheel to come nearer, click a level to see it.", summary(stack));
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name()));
    turn(ui, &sensed, &mut state.orbit, USUAL);
    let bench = Bench::new(stack);
    let small = theme.sizes().small;
    // The words stand to the right of the planes; where these are close to each other there are but few.
    let is_low = area.height() < 4.0 * small * stack.floors.len() as f32;
    let words = (if is_low { 8.5 } else { 11.5 } * small).min(0.4 * area.width());
    let part = Rect::from_min_max(area.min, pos2(area.max.x - words, area.max.y));
    let screen = Screen::new(part, &state.orbit, bench.room(), vec2(0.8, 0.8) * small);
    let view = View { painter: ui.painter_at(area), screen, bench, input };
    let order = view.bench.far_to_near(state.orbit.eye());
    let pointed = sensed.hover_pos().and_then(|at| order.iter().rev().copied().find(|&level| view.contains(level, at)));
    let textures = textures(ui, stack, &mut state.textures);
    for &level in &order {
        view.plane(level, &textures[level], pointed == Some(level));
    }
    view.links();
    let longer = lengthening(stack);
    for (level, floor) in stack.floors.iter().enumerate() {
        view.marks(level, floor, longer);
    }
    view.words(longer, area, part.max.x);
    if pointed.is_some() && !sensed.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    }
    Response { clicked: pointed.filter(|_| sensed.clicked()) }
}

/// The pictures of frame t, from level 0 on; each is uploaded once.
fn textures(ui: &Ui, stack: &Stack, kept: &mut Vec<(Arc<Frame>, TextureHandle)>) -> Vec<TextureHandle> {
    let frames: Vec<_> = stack.levels.all.iter().map(|level| &level.pair[0]).collect();
    kept.retain(|(frame, _)| frames.iter().any(|other| Arc::ptr_eq(frame, other)));
    let mut texture = |frame: &Arc<Frame>| {
        if let Some((_, texture)) = kept.iter().find(|(other, _)| Arc::ptr_eq(frame, other)) {
            return texture.clone();
        }
        let options = TextureOptions { magnification: egui::TextureFilter::Nearest, ..TextureOptions::LINEAR };
        let texture = ui.ctx().load_texture("level", stage::image_of(frame, LONGEST_PX), options);
        kept.push((frame.clone(), texture.clone()));
        texture
    };
    frames.into_iter().map(&mut texture).collect()
}

/// How many times longer vectors are drawn, so that the longest is seen.
fn lengthening(stack: &Stack) -> f32 {
    let share = |(level, floor): (usize, &Floor)| {
        let ([u, v], _) = floor.vector?;
        Some(u.hypot(v) / stack.levels.size(level).0 as f32)
    };
    let longest = stack.floors.iter().enumerate().filter_map(share).fold(0.0, f32::max);
    let is_enough = |times: &f32| longest == 0.0 || longest * times >= 0.08;
    [1.0, 2.0, 4.0].into_iter().find(is_enough).unwrap_or(8.0)
}

/// Where the levels are in the world.
struct Bench {
    /// Half the extent of the lowest, along x and y of the picture.
    half: [f32; 2],
    /// From one to the next.
    gap: f32,
    /// Width and height of each in px.
    sizes: Vec<[f32; 2]>,
}

impl Bench {
    fn new(stack: &Stack) -> Self {
        let size = |level| <[usize; 2]>::from(stack.levels.size(level)).map(|c| c as f32);
        let sizes: Vec<_> = (0..stack.levels.all.len()).map(size).collect();
        let [width, height] = sizes.first().copied().unwrap_or([1.0; 2]);
        let longer = width.max(height);
        let gap = GAP.min(HIGHEST / sizes.len().saturating_sub(1).max(1) as f32);
        Self { half: [width / longer, height / longer], gap, sizes }
    }

    fn room(&self) -> Room {
        let (above, radius) = (self.sizes.len().saturating_sub(1), self.half[0].hypot(self.half[1]));
        Room { ground: radius, top: [(self.gap * above as f32).max(0.1), radius * TAPER.powi(above as i32)] }
    }

    /// The place of a share of a level, from 0 to 1 along x and y.
    fn at(&self, level: usize, share: [f32; 2]) -> Vec3 {
        let taper = TAPER.powi(level as i32);
        let [x, z] = [0, 1].map(|i| (2.0 * share[i] - 1.0) * self.half[i] * taper);
        Vec3::new(x, level as f32 * self.gap, z)
    }

    /// The levels in the order in which they hide each other.
    fn far_to_near(&self, eye: Vec3) -> Vec<usize> {
        let mut order: Vec<_> = (0..self.sizes.len()).collect();
        let distance = |level: usize| (level as f32 * self.gap - eye.y).abs();
        order.sort_by(|a, b| distance(*b).total_cmp(&distance(*a)));
        order
    }

    /// The place of a point of a level in its px.
    fn place(&self, level: usize, point: [f32; 2]) -> Vec3 {
        self.at(level, [0, 1].map(|i| (point[i] + 0.5) / self.sizes[level][i]))
    }
}

struct View<'a> {
    painter: Painter,
    screen: Screen,
    bench: Bench,
    input: Input<'a>,
}

impl View<'_> {
    fn seen(&self, place: Vec3) -> Pos2 {
        self.screen.project(place).0
    }

    fn corners(&self, level: usize) -> [Pos2; 4] {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|share| self.seen(self.bench.at(level, share)))
    }

    fn contains(&self, level: usize, at: Pos2) -> bool {
        let corners = self.corners(level);
        let side = |i: usize| {
            let (from, to) = (corners[i], corners[(i + 1) % 4]);
            (to - from).x * (at - from).y - (to - from).y * (at - from).x
        };
        let sides = [0, 1, 2, 3].map(side);
        sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
    }

    fn plane(&self, level: usize, texture: &TextureHandle, is_pointed: bool) {
        let mut mesh = Mesh::with_texture(texture.id());
        let share = |i: usize| i as f32 / QUADS as f32;
        for (i, j) in (0..=QUADS).flat_map(|j| (0..=QUADS).map(move |i| (i, j))) {
            let share = [share(i), share(j)];
            let pos = self.seen(self.bench.at(level, share));
            let color = Color32::WHITE.gamma_multiply(0.92);
            mesh.vertices.push(egui::epaint::Vertex { pos, uv: share.into(), color });
        }
        let row = QUADS as u32 + 1;
        for first in (0..QUADS as u32).flat_map(|j| (0..QUADS as u32).map(move |i| j * row + i)) {
            mesh.indices.extend([0, 1, row, 1, row + 1, row].map(|i| first + i));
        }
        self.painter.add(Shape::mesh(mesh));
        let chrome = self.input.theme.chrome();
        let (width, color) = match (is_pointed, self.input.on_stage == level) {
            (true, _) => (2.0, chrome.text),
            (_, true) => (2.0, chrome.accent),
            _ => (1.0, chrome.dim),
        };
        self.painter.add(Shape::closed_line(self.corners(level).to_vec(), Stroke::new(width, ink::color(color))));
    }

    /// Lines that join what is at hand through the levels.
    fn links(&self) {
        let floors = &self.input.stack.floors;
        let middle = |level: usize| Some(self.seen(self.bench.place(level, floors[level].middle()?)));
        let inked = self.input.theme.ink(Role::Reference);
        for ends in (1..floors.len()).filter_map(|level| Some([middle(level - 1)?, middle(level)?])) {
            for (width, color) in [(inked.width + 1.5, inked.halo), (inked.width.min(1.5), inked.color)] {
                self.painter.extend(Shape::dashed_line(&ends, Stroke::new(width, ink::color(color)), 5.0, 4.0));
            }
        }
    }

    /// What is at hand on a level, and its displacement.
    fn marks(&self, level: usize, floor: &Floor, longer: f32) {
        let seen = |point: [f32; 2]| self.seen(self.bench.place(level, point));
        if let Some([min, max]) = floor.at_hand {
            let corners = [min, [max[0], min[1]], max, [min[0], max[1]]];
            let corners = corners.map(seen);
            // Of a small block the frame leaves something to be seen.
            let side = corners[0].distance(corners[1]).min(corners[1].distance(corners[2]));
            self.line(corners.to_vec(), true, (Role::Reference, (0.1 * side).max(1.0)));
        }
        if let (Some(from), Some((vector, role))) = (floor.middle(), floor.vector) {
            let to = [0, 1].map(|i| from[i] + vector[i] * longer);
            self.arrow(seen(from), seen(to), role);
        }
    }

    /// A line in the ink of a role, `most` points wide.
    fn line(&self, points: Vec<Pos2>, closed: bool, (role, most): (Role, f32)) {
        let inked = self.input.theme.ink(role);
        let width = inked.width.min(most);
        for (width, color) in [(width + 2.0 * inked.halo_width.min(most), inked.halo), (width, inked.color)] {
            let stroke = Stroke::new(width, ink::color(color));
            let line = if closed { Shape::closed_line } else { Shape::line };
            self.painter.add(line(points.clone(), stroke));
        }
    }

    fn arrow(&self, from: Pos2, to: Pos2, role: Role) {
        let inked = self.input.theme.ink(role);
        let along = to - from;
        if along.length() > 2.0 {
            self.line(vec![from, to], false, (role, f32::INFINITY));
            let head = along.normalized() * (3.0 + 2.0 * inked.width).min(along.length());
            let side = head.rot90() * 0.6;
            self.line(vec![to - head + side, to, to - head - side], false, (role, f32::INFINITY));
        }
        let halo = Stroke::new(inked.halo_width, ink::color(inked.halo));
        self.painter.circle(from, 1.0 + inked.width, ink::color(inked.color), halo);
    }

    /// What each level is, and what was found there.
    fn words(&self, longer: f32, area: Rect, rightmost_x: f32) {
        let (theme, stack) = (self.input.theme, self.input.stack);
        let (chrome, small) = (theme.chrome(), theme.sizes().small);
        let font = ink::font(Face::Sans, small);
        let line = 1.3 * small;
        let rightmost = |level: usize| {
            let corners = self.corners(level);
            corners.into_iter().fold(corners[0], |a, b| if b.x > a.x { b } else { a })
        };
        let near = (1..stack.floors.len()).map(|level| (rightmost(level).y - rightmost(level - 1).y).abs());
        let is_crowded = near.fold(f32::MAX, f32::min) < 2.2 * line;
        for (level, floor) in stack.floors.iter().enumerate() {
            let corner = rightmost(level);
            let left = (corner.x + 0.7 * small).min(rightmost_x + 0.5 * small);
            let ink = ink::color(if level == stack.levels.at_work { chrome.text } else { chrome.dim });
            let (shown, role) = floor.vector.map_or((String::new(), Role::Reference), |(v, role)| (told(v), role));
            let color = ink::color(theme.word(role));
            let at = |lines: f32| pos2(left, corner.y + lines * line);
            let write = |at: Pos2, text: &str, color| {
                self.painter.text(at, Align2::LEFT_CENTER, text, font.clone(), color).right()
            };
            if is_crowded {
                let right = write(at(0.0), &format!("{level}"), ink);
                write(pos2(right + 0.8 * small, corner.y), &shown, color);
            } else {
                write(at(-0.5), &heading(stack, level), ink);
                write(at(0.5), &shown, color);
            }
        }
        if longer > 1.0 && stack.floors.iter().any(|floor| floor.vector.is_some()) {
            let text = format!("vectors drawn ×{longer}");
            self.painter.text(area.left_bottom(), Align2::LEFT_BOTTOM, text, font, ink::color(chrome.dim));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Vec2;
    use motionscope_core::{Grid, Level, Levels};

    fn stack() -> Stack {
        let frame = |side: usize| Arc::new(Frame::gray(Grid::new(2 * side, side, 0)));
        let level = |side| Level::new([frame(side), frame(side)]);
        let floor = |edge: f32, vector| Floor { at_hand: Some([[edge; 2], [edge + 8.0; 2]]), vector };
        Stack {
            levels: Levels { all: [40, 20, 10].map(level).into(), at_work: 1 },
            floors: vec![
                floor(-0.5, None),
                floor(3.5, Some(([2.0, -1.0], Role::Best))),
                floor(1.5, Some(([1.5, 0.0], Role::Result))),
            ],
        }
    }

    #[test]
    fn a_stack_tells_itself_in_words_from_the_top() {
        let told = "Pyramid. Level 2, 20×10 px: found (1.50, 0) px; Level 1, 40×20 px: best so far (2, −1) px; Level 0, 80×40 px";
        assert_eq!(summary(&stack()), told);
    }

    #[test]
    fn every_plane_is_in_the_picture_and_what_is_nearer_hides_what_is_farther() {
        let stack = stack();
        let bench = Bench::new(&stack);
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(420.0, 300.0));
        for i in 0..24 {
            let orbit = Orbit { yaw_rad: i as f32 * 0.26, pitch_rad: 0.1 + 0.06 * i as f32, ..Orbit::default() };
            let screen = Screen::new(rect, &orbit, bench.room(), Vec2::ZERO);
            for (level, share) in
                (0..3).flat_map(|level| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(|share| (level, share)))
            {
                let (at, depth) = screen.project(bench.at(level, share));
                assert!(rect.expand(1.0).contains(at) && (0.0..1.0).contains(&depth), "{orbit:?} {level}: {at}");
            }
            let order = bench.far_to_near(orbit.eye());
            let height = |level: &usize| bench.at(*level, [0.5; 2]).y;
            for pair in order.windows(2) {
                // Of two planes on the same side of the eye the one further away comes first.
                let [far, near] = [height(&pair[0]) - orbit.eye().y, height(&pair[1]) - orbit.eye().y];
                assert!(far * near < 0.0 || far.abs() > near.abs(), "{orbit:?}: {order:?}");
            }
        }
    }

    #[test]
    fn vectors_are_lengthened_all_alike() {
        let mut stack = stack();
        assert_eq!(lengthening(&stack), 2.0, "1.5 of 20 px is nearly enough");
        stack.floors[1].vector = Some(([4.0, 0.0], Role::Best));
        assert_eq!(lengthening(&stack), 1.0);
        stack.floors.iter_mut().for_each(|floor| floor.vector = None);
        assert_eq!(lengthening(&stack), 1.0, "there is none");
    }
}
