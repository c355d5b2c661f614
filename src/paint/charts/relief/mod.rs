//! A cost over displacements, as a surface in space.
//!
//! The window's graphics card draws the triangles of [`mesh`]; everywhere else the same surface is painted from back to
//! front. Both have one projection ([`Screen`]), one light and one grid of lines.

mod landscape;
pub mod mesh;
mod sheet;

use glam::Vec3;
use motionscope_core::scene::{Axes, Role, Surface};

use super::super::primitive::{Anchor, Line, Point, Primitive, Rect};
use super::super::{Face, Layer, Theme, labels, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, covered, shortened, solid};
use super::{ChartStyle, Drawing, Orbit, Room, Screen, heat_map, titled};
pub use landscape::{Corner, Landscape, Lean, risen, standing};
use mesh::{Bench, Pin};
pub use sheet::polygons;

/// How strong the lines along columns and rows are.
pub const LINES: f32 = 0.42;

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Relief<'a> {
    /// The costs.
    pub surface: &'a Surface,
    /// The estimator whose they are.
    pub whose: &'a str,
    /// From where one looks.
    pub orbit: Orbit,
}

/// Towards the light.
pub fn light() -> Vec3 {
    Vec3::new(-0.45, 0.8, 0.35).normalize()
}

/// Width of the lines along columns and rows, in points.
pub fn line_width(theme: Theme) -> f32 {
    if theme == Theme::Projector { 1.6 } else { 1.0 }
}

/// What stands around the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Around {
    /// The camera.
    pub screen: Screen,
    /// Ground and axes, behind the surface.
    pub below: Vec<Primitive>,
    /// The costs at the pins, before it.
    pub above: Vec<Primitive>,
    /// What is shown.
    pub head: Vec<Primitive>,
}

/// Lays everything but the surface itself out in `area`.
pub fn around(data: Relief<'_>, area: Rect, style: ChartStyle) -> Around {
    let Relief { surface, whose, orbit } = data;
    let (theme, small) = (style.theme, style.small());
    let rect = Rect { min: [area.min[0], area.min[1] + 1.4 * small], max: area.max };
    let is_tight = super::is_tight(area, small);
    let margin = if is_tight { [3.0, 0.8] } else { [4.5, 1.8] };
    let screen = Screen::new(rect, &orbit, Room::SURFACE, margin.map(|letters| letters * small));
    let [below, mut above] = stand(surface, (screen, orbit.eye()), is_tight, theme);
    let mut head = Canvas::default();
    let text = Type::text(theme);
    if surface.range().is_none() {
        let words = "No candidate is tested yet: step on.";
        let at = [(rect.min[0] + rect.max[0]) / 2.0, rect.min[1] + 2.0 * text.size];
        above.text(at, (Anchor::Middle, Level::Middle), words, Type::dim(theme));
    }
    let words = titled(whose, &format!("{} by displacement", surface.title), (small, area.size()[0]));
    let at = [area.min[0], area.min[1] + 0.8 * small];
    let words = shortened(&words, text, area.size()[0]);
    let title = head.text(at, (Anchor::Start, Level::Middle), &words, text);
    let (dim, room) = (Type::dim(theme), area.max[0] - title.max[0] - 1.4 * small);
    if let Some(least) = heat_map::optimum_words(surface).filter(|least| dim.width(least) <= room) {
        head.text([area.max[0], at[1]], (Anchor::End, Level::Middle), &least, dim);
    }
    let [below, above, head] = [below, above, head].map(Canvas::into_primitives);
    Around { screen, below, above, head }
}

/// What stands behind `surface` as the eye sees it, ground and axes, and before it, the costs at its pins.
fn stand(surface: &Surface, (screen, eye): (Screen, Vec3), is_tight: bool, theme: Theme) -> [Canvas; 2] {
    let (bench, axes) = (Bench::new(surface), surface.axes);
    let mut stand = Stand { screen, bench, axes, eye, theme, is_tight, taken: Vec::new() };
    let (mut below, mut above) = (Canvas::default(), Canvas::default());
    stand.ground(&mut below);
    stand.costs((&mut below, &mut above), surface);
    stand.level(&mut above, surface);
    stand.trail(&mut above, surface);
    stand.pins(&mut above, surface);
    [below, above]
}

/// Lays the surface out in the whole of `area`.
pub fn draw(data: Relief<'_>, area: Rect, style: ChartStyle) -> Drawing<Screen> {
    let Around { screen, below, above, head } = around(data, area, style);
    let surface = polygons(data.surface, (&screen, data.orbit.eye()), style);
    let layer = |primitives| Layer { clip: Some(area), primitives };
    Drawing { place: screen, body: vec![layer(below), layer(surface), layer(above)], head }
}

/// The ground, the axes and the words around the surface.
struct Stand {
    screen: Screen,
    bench: Bench,
    axes: Axes,
    eye: Vec3,
    theme: Theme,
    /// Whether there is room for few words only.
    is_tight: bool,
    /// Where numbers stand: where two axes meet, the second would lie on the first.
    taken: Vec<Rect>,
}

impl Stand {
    fn at(&self, place: Vec3) -> Point {
        self.screen.project(place).0
    }

    fn line(&self, canvas: &mut Canvas, ends: [Vec3; 2], strong: bool) {
        let chrome = self.theme.chrome();
        let color = if strong { chrome.dim } else { chrome.line };
        canvas.line(ends.map(|end| self.at(end)).to_vec(), false, solid(1.0, color));
    }

    /// A word `lines` of type further out than `place`, as seen from the middle of the ground.
    fn word(&mut self, canvas: &mut Canvas, (place, lines): (Vec3, f32), text: &str, face: Face) {
        let style = if face == Face::Sans { Type::dim(self.theme) } else { Type::text(self.theme).face(face) };
        let (at, from) = (self.at(place), self.at(Vec3::ZERO));
        let way = [0, 1].map(|i| at[i] - from[i]);
        let length = way[0].hypot(way[1]).max(1e-3);
        // Words are wider than high: they need more room sideways.
        let out = [1.5, 1.0].map(|share| share * lines * style.size / length);
        let at = [0, 1].map(|i| at[i] + way[i] * out[i]);
        self.write(canvas, style.line(at, (Anchor::Middle, Level::Middle), text));
    }

    /// Writes a word unless it would lie on another, moved so that no edge of the pane cuts it.
    fn write(&mut self, canvas: &mut Canvas, mut line: Line) {
        let (rect, pane) = (covered(&line), self.screen.rect);
        for i in 0..2 {
            line.at[i] += (pane.min[i] + 2.0 - rect.min[i]).max(0.0) - (rect.max[i] + 2.0 - pane.max[i]).max(0.0);
        }
        let rect = covered(&line);
        if !self.taken.iter().any(|other| other.meets(&rect)) {
            self.taken.push(rect);
            canvas.add(Primitive::Text(line));
        }
    }

    /// The values along u or v as an axis of the world.
    fn axis(&self, which: usize) -> Axis {
        let half = self.bench.half()[which];
        let last = self.bench.size.map(|side| side.saturating_sub(1));
        let ends = [[0; 2], last].map(|cell| self.axes.at(self.bench.displacement(cell))[which]);
        Axis::new(ends, [-half, half])
    }

    /// A grid on the ground, numbered along the two sides towards the eye.
    fn ground(&mut self, canvas: &mut Canvas) {
        let [half_u, half_v] = self.bench.half();
        let near_u = half_u.copysign(self.eye.x);
        let near_v = half_v.copysign(self.eye.z);
        let small = self.theme.sizes().small;
        // Their names come before the numbers, which give way.
        let out = if self.is_tight { 0.9 } else { 2.3 };
        let [along_u, along_v] = self.axes.names;
        self.word(canvas, (Vec3::new(0.0, 0.0, near_v), out), along_u, Face::Italic);
        self.word(canvas, (Vec3::new(near_u, 0.0, 0.0), out), along_v, Face::Italic);
        for which in 0..2 {
            let axis = self.axis(which);
            let (along, across) = if which == 0 { (half_u, half_v) } else { (half_v, half_u) };
            let point = |a: f32, b: f32| if which == 0 { Vec3::new(a, 0.0, b) } else { Vec3::new(b, 0.0, a) };
            let near = if which == 0 { near_v } else { near_u };
            let [from, to] = [-along, along].map(|a| self.at(point(a, near)));
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            // Ticks as far apart as their numbers need.
            let on_sheet = Axis { places: [0.0, length], ..axis };
            let ticks = match self.axes == Axes::DISPLACEMENTS {
                true => on_sheet.displacement_ticks(3.0 * small),
                false => two_at_least(&on_sheet, 3.0 * small),
            };
            for tick in ticks {
                let a = axis.place(tick);
                self.line(canvas, [point(a, -across), point(a, across)], false);
                self.word(canvas, (point(a, near), 0.9), &number(tick), Face::Sans);
            }
            for side in [-across, across] {
                self.line(canvas, [point(-along, side), point(along, side)], side == near);
            }
        }
    }

    /// The axis of costs, at the corner of the ground that is furthest left.
    fn costs(&mut self, (canvas, above): (&mut Canvas, &mut Canvas), surface: &Surface) {
        let [u, v] = self.bench.half();
        let corners = [[-u, -v], [u, -v], [u, v], [-u, v]].map(|[x, z]| Vec3::new(x, 0.0, z));
        let left = |a: &Vec3, b: &Vec3| self.at(*a)[0].total_cmp(&self.at(*b)[0]);
        let Some(foot) = corners.into_iter().min_by(left) else { return };
        let top = foot + Vec3::Y * self.bench.height(self.bench.top);
        self.line(canvas, [foot, top], true);
        let small = self.theme.sizes().small;
        let [low, high] = [foot, top].map(|end| self.at(end));
        let axis = Axis::new([self.bench.bottom, self.bench.top], [0.0, (low[0] - high[0]).hypot(low[1] - high[1])]);
        let dim = Type::dim(self.theme);
        if surface.range().is_some() {
            let ticks = two_at_least(&axis, 2.2 * small);
            for (tick, words) in ticks.iter().zip(labels(&ticks)) {
                let [x, y] = self.at(foot + Vec3::Y * self.bench.height(*tick));
                canvas.across([x - 4.0, x], y, dim.color);
                self.write(canvas, dim.line([x - 7.0, y], (Anchor::End, Level::Middle), &words));
            }
        }
        if self.is_tight {
            return;
        }
        // Left of the corner: the cost of a pin may stand above it.
        let style = Type::text(self.theme);
        let with_unit = format!("{}, {}", surface.title, surface.unit);
        let has_room = style.width(&with_unit) < self.screen.rect.size()[0] - 8.0;
        let words = if surface.unit.is_empty() || !has_room { surface.title } else { &with_unit };
        let right = (high[0] - 4.0).max(self.screen.rect.min[0] + style.width(words) + 4.0);
        let name = [right, high[1] - 0.9 * small];
        // The heading names the cost as well.
        if !self.has_pin_near(surface, name) {
            let mut line = style.line(name, (Anchor::End, Level::Bottom), words);
            line.halo = Some(self.theme.chrome().background);
            above.add(Primitive::Text(line));
        }
    }

    /// Whether the cost at the top of a pin would lie on a title that ends at `at`.
    fn has_pin_near(&self, surface: &Surface, at: Point) -> bool {
        let small = self.theme.sizes().small;
        let start = at[0] - 0.6 * small * surface.title.chars().count() as f32;
        mesh::pins(surface, &self.bench).into_iter().any(|pin| {
            let Pin { at: displacement, cost, top, .. } = pin;
            let [x, y] = self.at(Vec3 { y: top, ..self.bench.place(displacement, cost) });
            // The number may stand on either side of its pin.
            let width = 0.6 * small * pin.words().chars().count() as f32;
            let is_beside = x + width > start && x - width < at[0] - 0.5 * small;
            is_beside && (y - 3.0 - at[1]).abs() < 0.9 * small
        })
    }

    /// Where the surface has the value of its contour, if it has one.
    fn level(&self, canvas: &mut Canvas, surface: &Surface) {
        let Some(level) = surface.contour else { return };
        let (ink, color) = (self.theme.ink(Role::Best), self.theme.stroke(Role::Best));
        for ends in surface.contour_lines(level) {
            let points = ends.map(|at| self.at(self.bench.place(at, level))).to_vec();
            canvas.line(points.clone(), false, solid(2.0 * ink.halo_width + ink.width, ink.halo));
            canvas.line(points, false, solid(ink.width, color));
        }
    }

    /// The path of an iteration over the surface, and the candidates tested between its cells.
    fn trail(&self, canvas: &mut Canvas, surface: &Surface) {
        let at_cost = |at: [f32; 2], cost: f32| self.at(self.bench.place(at, cost));
        let seen = |at: [f32; 2]| Some(at_cost(at, surface.interpolated(at)?));
        let (ink, color) = (self.theme.ink(Role::Candidate), self.theme.stroke(Role::Candidate));
        let line = |ends: &[[f32; 2]]| line_over(ends[0], ends[1]).map_while(seen).collect::<Vec<_>>();
        for points in surface.trail.windows(2).map(line).filter(|points| points.len() > 1) {
            canvas.line(points.clone(), false, solid(2.0 * ink.halo_width + ink.width.min(2.0), ink.halo));
            canvas.line(points, false, solid(ink.width.min(2.0), color));
        }
        let known = surface.between.iter().filter(|between| between.value.is_finite());
        let between = known.map(|between| (at_cost(between.at, between.value), 1.5));
        let stops = surface.trail.iter().filter_map(|at| Some((seen(*at)?, 3.5)));
        for (at, radius) in between.chain(stops) {
            canvas.disc(at, radius + 1.0, ink.halo);
            canvas.disc(at, radius, color);
        }
    }

    /// The cost at the top of each pin, or its name.
    fn pins(&self, canvas: &mut Canvas, surface: &Surface) {
        let all: Vec<_> = mesh::pins(surface, &self.bench)
            .into_iter()
            .map(|pin| {
                let (words, Pin { role, at, cost, top, .. }) = (pin.words(), pin);
                let foot = self.bench.place(at, cost);
                (role, words, [foot, Vec3 { y: top, ..foot }].map(|end| self.at(end)))
            })
            .collect();
        for &(role, _, [low, high]) in &all {
            // Seen faintly through what stands before it.
            let (ink, color) = (self.theme.ink(role), self.theme.stroke(role).alpha(140));
            canvas.line(vec![low, high], false, solid(ink.width.min(2.0), color));
            canvas.disc(low, 4.5, ink.halo.alpha(140));
            canvas.disc(low, 4.0, color);
        }
        let style = Type::text(self.theme).face(Face::Bold);
        let mut written: Vec<Rect> = Vec::new();
        let is_said_twice = |index: usize| {
            let (_, words, [foot, _]) = &all[index];
            all[index + 1..].iter().any(|(_, other, [there, _])| other == words && there == foot)
        };
        for (index, &(role, ref words, [_, head])) in all.iter().enumerate() {
            if is_said_twice(index) {
                continue;
            }
            // Of two numbers each stands on its own side.
            let anchor = match all.iter().find(|other| other.0 != role).map(|(.., ends)| head[0] < ends[1][0]) {
                None => Anchor::Middle,
                Some(true) => Anchor::End,
                Some(false) => Anchor::Start,
            };
            let at = [head[0], head[1] - 3.0];
            let mut line = style.color(self.theme.word(role)).line(at, (anchor, Level::Bottom), words);
            let (Rect { min: [left, _], max: [right, _] }, pane) = (covered(&line), self.screen.rect);
            line.at[0] += (pane.min[0] + 4.0 - left).max(0.0) - (right + 4.0 - pane.max[0]).max(0.0);
            // Where it would lie on others, it stands above them.
            written.sort_by(|a, b| b.max[1].total_cmp(&a.max[1]));
            for other in &written {
                let rect = covered(&line);
                if other.meets(&rect) {
                    line.at[1] += other.min[1] - 1.0 - rect.max[1];
                }
            }
            // None is cut at the top.
            line.at[1] += (self.screen.rect.min[1] + 2.0 - covered(&line).min[1]).max(0.0);
            let Rect { min, max } = covered(&line);
            let back = Rect { min: [min[0] - 4.0, min[1]], max: [max[0] + 4.0, max[1]] };
            written.push(back);
            canvas.fill(back, self.theme.chrome().panel.alpha(200));
            canvas.add(Primitive::Text(line));
        }
    }
}

/// Ticks `spacing` points apart, or closer where there would be one alone: it does not tell how much lies above it.
fn two_at_least(axis: &Axis, spacing: f32) -> Vec<f32> {
    let ticks = |share: f32| axis.ticks(share * spacing, 0.0);
    [1.0, 0.65].into_iter().map(ticks).find(|ticks| ticks.len() > 1).unwrap_or_else(|| ticks(0.4))
}

/// Places along a straight line, close enough to follow a surface.
fn line_over(from: [f32; 2], to: [f32; 2]) -> impl Iterator<Item = [f32; 2]> {
    const PARTS: usize = 16;
    (0..=PARTS).map(move |i| {
        let share = i as f32 / PARTS as f32;
        [0, 1].map(|k| from[k] + share * (to[k] - from[k]))
    })
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    #[test]
    fn the_surface_stands_between_its_ground_and_its_words() {
        let values = Grid::from_fn(9, 9, |x, y| (x * x + y) as f32);
        let events = values.map(|v| Some(*v as usize));
        let (probe, best) = (Some([2, 1]), Some([-4, -4]));
        let surface = Surface { probe, best, ..Surface::new("SAD", [-4, -4], values, events) };
        let style = ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 };
        let area = Rect::new([10.0, 20.0], [420.0, 300.0]);
        let data = Relief { surface: &surface, whose: "Full search", orbit: Orbit::default() };
        let primitives = flat(draw(data, area, style));
        let words = texts(&primitives);
        for label in ["Full search · SAD by displacement", "u, px", "v, px", "SAD", "0", "41"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
        let is_surface = |p: &Primitive| matches!(p, Primitive::Polygon { points, .. } if points.len() <= 4);
        assert!(primitives.iter().filter(|p| is_surface(p)).count() >= 64, "a quad for each cell");
        let inside = area.grown(2.0);
        for primitive in primitives.iter().filter(|p| is_surface(p)) {
            let Rect { min, max } = primitive.bounds().grown(-1.0);
            assert!((0..2).all(|i| inside.min[i] <= min[i] && max[i] <= inside.max[i]), "{primitive:?}");
        }
    }
}
