//! A pyramid as a stack of pictures in space, with the block at hand and its vector on every level.

use std::sync::Arc;

use glam::{Mat3, Vec3};
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Floor, Role, Stack};

use super::super::primitive::{Anchor, Point, Primitive, Rect, Stroke};
use super::super::{Panel, Pictures, Share, Theme, number, reduced};
use super::canvas::{Canvas, Level, Type, solid};
use super::{ChartStyle, Drawing, Orbit, Room, Screen};

/// How much narrower a level with fewer pixels is than the one below: half would be true, but nothing could be seen at the top.
const TAPER: f32 = 0.84;
/// Between two levels, where the longer side of the lowest is 2.
const GAP: f32 = 0.5;
/// The highest stack.
const HIGHEST: f32 = 1.6;
/// From where one looks at first: flatter than at a surface, so that many levels have room above each other.
pub const USUAL: Orbit = Orbit { yaw_rad: -0.5, pitch_rad: 0.5, zoom: 1.0 };
/// Opacity of a level, so that what stands behind it is felt.
const ALPHA: u8 = 235;

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Pyramid<'a> {
    /// The pyramid.
    pub stack: &'a Stack,
    /// The estimator that works on it.
    pub whose: &'a str,
    /// The level whose picture stands on the stage.
    pub on_stage: usize,
    /// From where one looks.
    pub orbit: Orbit,
}

/// The pictures of levels as they were seen last, to be used again as long as nothing turns.
#[derive(Clone, Debug, Default)]
pub struct Seen(Vec<(Arc<Frame>, [Point; 4], Primitive)>);

/// Where the levels lie.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// The corners of each, from level 0 on.
    pub corners: Vec<[Point; 4]>,
    /// The levels in the order in which they hide each other.
    far_to_near: Vec<usize>,
}

impl Planes {
    /// The level that is seen at a place.
    pub fn level(&self, at: Point) -> Option<usize> {
        self.far_to_near.iter().rev().copied().find(|&level| contains(&self.corners[level], at))
    }
}

/// Lays the stack out in the whole of `area`.
pub fn draw(data: Pyramid<'_>, area: Rect, style: ChartStyle, seen: &mut Seen) -> Drawing<Planes> {
    let Pyramid { stack, whose, orbit, .. } = data;
    let small = style.small();
    let bench = Bench::new(stack);
    let rect = Rect { min: [area.min[0], area.min[1] + 1.4 * small], max: area.max };
    // The words stand to the right of the planes; where these are close to each other there are but few.
    let is_low = rect.size()[1] < 4.0 * small * stack.floors.len() as f32;
    let words = (if is_low { 8.5 } else { 11.5 } * small).min(0.4 * area.size()[0]);
    let part = Rect { min: rect.min, max: [rect.max[0] - words, rect.max[1]] };
    let screen = Screen::new(part, &orbit, bench.room(), [0.8 * small; 2]);
    let far_to_near = bench.far_to_near(orbit.eye());
    let view = View { screen, bench, data, theme: style.theme };
    let mut canvas = Canvas::default();
    let before = std::mem::take(&mut seen.0);
    for &level in &far_to_near {
        let frame = &stack.levels.all[level].pair[0];
        let corners = view.corners(level);
        let known = before.iter().find(|(other, places, _)| Arc::ptr_eq(other, frame) && *places == corners);
        let picture = known.map_or_else(|| view.picture(level, style.density), |(.., picture)| picture.clone());
        seen.0.push((frame.clone(), corners, picture.clone()));
        canvas.add(picture);
        view.rim(&mut canvas, level);
    }
    view.links(&mut canvas);
    let longer = lengthening(stack);
    for (level, floor) in stack.floors.iter().enumerate() {
        view.marks(&mut canvas, (level, floor), longer);
    }
    view.words(&mut canvas, longer, (area, part.max[0]));
    let primitives = canvas.into_primitives();
    let mut head = Canvas::default();
    let levels = match stack.floors.len() {
        count if stack.levels.all.iter().any(|level| level.name.is_some()) => counted("picture", count),
        count => format!("pyramid of {}", counted("level", count)),
    };
    let words = super::titled(whose, &levels, (small, area.size()[0]));
    let at = [area.min[0], area.min[1] + 0.8 * small];
    head.text(at, (Anchor::Start, Level::Middle), &words, Type::text(style.theme));
    let corners = (0..stack.floors.len()).map(|level| view.corners(level)).collect();
    Drawing {
        place: Planes { corners, far_to_near },
        body: vec![super::Layer { clip: Some(area), primitives }],
        head: head.into_primitives(),
    }
}

/// What the stack shows, in words.
pub fn summary(stack: &Stack) -> String {
    let level = |(level, floor): (usize, &Floor)| match floor.vector {
        Some((vector, Role::Result)) => format!("{}: found {}", heading(stack, level), description(vector)),
        Some((vector, _)) => format!("{}: best so far {}", heading(stack, level), description(vector)),
        None => heading(stack, level),
    };
    let levels: Vec<_> = stack.floors.iter().enumerate().rev().map(level).collect();
    format!("Pyramid. {}", levels.join("; "))
}

fn counted(what: &str, count: usize) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

fn heading(stack: &Stack, level: usize) -> String {
    if let Some(name) = &stack.levels.all[level].name {
        return name.clone();
    }
    let (width, height) = stack.levels.size(level);
    format!("Level {level}, {width}×{height} px")
}

fn description([u, v]: [f32; 2]) -> String {
    format!("({}, {}) px", number(u), number(v))
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

fn contains(corners: &[Point; 4], at: Point) -> bool {
    let side = |i: usize| {
        let (from, to) = (corners[i], corners[(i + 1) % 4]);
        (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
    };
    let sides = [0, 1, 2, 3].map(side);
    sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
}

/// Where the levels are in the world.
struct Bench {
    /// Half the extent of the lowest, along x and y of the picture.
    half: [f32; 2],
    /// From one to the next.
    gap: f32,
    /// Width and height of each in px.
    sizes: Vec<[f32; 2]>,
    /// Its extent in those of the lowest.
    scales: Vec<f32>,
}

impl Bench {
    fn new(stack: &Stack) -> Self {
        let size = |level| <[usize; 2]>::from(stack.levels.size(level)).map(|c| c as f32);
        let sizes: Vec<_> = (0..stack.levels.all.len()).map(size).collect();
        let [width, height] = sizes.first().copied().unwrap_or([1.0; 2]);
        let longer = width.max(height);
        let is_smaller = |level: usize| level > 0 && sizes[level] != sizes[level - 1];
        let narrowed = |narrowed: &mut i32, level: usize| {
            *narrowed += i32::from(is_smaller(level));
            Some(TAPER.powi(*narrowed))
        };
        let scales = (0..sizes.len()).scan(0, narrowed).collect();
        let gap = GAP.min(HIGHEST / sizes.len().saturating_sub(1).max(1) as f32);
        Self { half: [width / longer, height / longer], gap, sizes, scales }
    }

    fn room(&self) -> Room {
        let (above, radius) = (self.sizes.len().saturating_sub(1), self.half[0].hypot(self.half[1]));
        let narrowest = self.scales.last().copied().unwrap_or(1.0);
        Room { ground: radius, top: [(self.gap * above as f32).max(0.1), radius * narrowest] }
    }

    /// How high a level lies.
    fn height(&self, level: usize) -> f32 {
        level as f32 * self.gap
    }

    /// Half the extent of a level.
    fn half(&self, level: usize) -> [f32; 2] {
        self.half.map(|half| half * self.scales[level])
    }

    /// The place of a share of a level, from 0 to 1 along x and y.
    fn at(&self, level: usize, share: [f32; 2]) -> Vec3 {
        let half = self.half(level);
        let [x, z] = [0, 1].map(|i| (2.0 * share[i] - 1.0) * half[i]);
        Vec3::new(x, self.height(level), z)
    }

    /// The levels in the order in which they hide each other.
    fn far_to_near(&self, eye: Vec3) -> Vec<usize> {
        let mut order: Vec<_> = (0..self.sizes.len()).collect();
        let distance = |level: usize| (self.height(level) - eye.y).abs();
        order.sort_by(|a, b| distance(*b).total_cmp(&distance(*a)));
        order
    }

    /// The place of a point of a level in its px.
    fn place(&self, level: usize, point: [f32; 2]) -> Vec3 {
        self.at(level, [0, 1].map(|i| (point[i] + 0.5) / self.sizes[level][i]))
    }
}

struct View<'a> {
    screen: Screen,
    bench: Bench,
    data: Pyramid<'a>,
    theme: Theme,
}

impl View<'_> {
    fn seen(&self, place: Vec3) -> Point {
        self.screen.project(place).0
    }

    fn corners(&self, level: usize) -> [Point; 4] {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|share| self.seen(self.bench.at(level, share)))
    }

    /// The picture of frame t on a level as it is seen, clear around it.
    fn picture(&self, level: usize, density: f32) -> Primitive {
        let corners = self.corners(level);
        let extreme =
            |pick: fn(f32, f32) -> f32, i: usize| corners.iter().map(|c| c[i]).reduce(pick).unwrap_or_default();
        let min = [0, 1].map(|i| extreme(f32::min, i).floor());
        let max = [0, 1].map(|i| extreme(f32::max, i).ceil());
        let count = |i: usize| ((max[i] - min[i]) * density).round().max(1.0) as usize;
        let frame = &self.data.stack.levels.all[level].pair[0];
        let pixels = Panel::CURRENT.pixels(&Pictures::of([frame.clone(), frame.clone()]), Share::default()).0;
        let longest = (0..4).map(|i| distance(corners[i], corners[(i + 1) % 4])).fold(1.0, f32::max) * density;
        let picture =
            reduced(&pixels, (pixels.width().max(pixels.height()) as f32 / longest).floor().max(1.0) as usize);
        let share_of = self.share_of(level);
        let pixels = Grid::from_fn(count(0), count(1), |x, y| {
            let at = [min[0] + (x as f32 + 0.5) / density, min[1] + (y as f32 + 0.5) / density];
            let [s, t] = share_of(at);
            let inside = (0.0..1.0).contains(&s) && (0.0..1.0).contains(&t);
            let (width, height) = picture.size();
            let [column, row] = [(s * width as f32) as usize, (t * height as f32) as usize];
            let pixel = picture.get(column, row).filter(|_| inside);
            pixel.map_or([0; 4], |&[r, g, b, _]| [r, g, b, ALPHA])
        });
        Primitive::Image { pixels: Arc::new(pixels), rect: Rect { min, max } }
    }

    /// Which share of a level is seen at a place of the sheet.
    fn share_of(&self, level: usize) -> impl Fn(Point) -> [f32; 2] {
        let (matrix, y) = (self.screen.clip_from_world, self.bench.height(level));
        let [x_axis, y_axis, z_axis, w_axis] = [0, 1, 2, 3].map(|i| matrix.col(i));
        // Of a plane at one height: from x, z and 1 to clip space without its depth.
        let column = |v: glam::Vec4| Vec3::new(v.x, v.y, v.w);
        let plane_from_clip = Mat3::from_cols(column(x_axis), column(z_axis), column(y_axis * y + w_axis)).inverse();
        let (rect, half) = (self.screen.rect, self.bench.half(level));
        move |at: Point| {
            let share = |i: usize| (at[i] - rect.min[i]) / rect.size()[i] * 2.0 - 1.0;
            let place = plane_from_clip * Vec3::new(share(0), -share(1), 1.0);
            [place.x / place.z / half[0], place.y / place.z / half[1]].map(|c| (c + 1.0) / 2.0)
        }
    }

    fn rim(&self, canvas: &mut Canvas, level: usize) {
        let chrome = self.theme.chrome();
        let (width, color) = if self.data.on_stage == level { (2.0, chrome.accent) } else { (1.0, chrome.dim) };
        canvas.line(self.corners(level).to_vec(), true, solid(width, color));
    }

    /// Lines that join what is at hand through the levels.
    fn links(&self, canvas: &mut Canvas) {
        let floors = &self.data.stack.floors;
        let middle = |level: usize| Some(self.seen(self.bench.place(level, floors[level].middle()?)));
        let ink = self.theme.ink(Role::Reference);
        for ends in (1..floors.len()).filter_map(|level| Some([middle(level - 1)?, middle(level)?])) {
            for (width, color) in [(ink.width + 1.5, ink.halo), (ink.width.min(1.5), ink.color)] {
                canvas.line(ends.to_vec(), false, Stroke { width, color, dash: &[5.0, 4.0] });
            }
        }
    }

    /// What is at hand on a level, and its displacement.
    fn marks(&self, canvas: &mut Canvas, (level, floor): (usize, &Floor), longer: f32) {
        let seen = |point: [f32; 2]| self.seen(self.bench.place(level, point));
        if let Some([min, max]) = floor.at_hand {
            let corners = [min, [max[0], min[1]], max, [min[0], max[1]]].map(seen);
            // Of a small block the frame leaves something to be seen.
            let side = distance(corners[0], corners[1]).min(distance(corners[1], corners[2]));
            self.line(canvas, corners.to_vec(), true, (Role::Reference, (0.1 * side).max(1.0)));
        }
        if let (Some(from), Some((vector, role))) = (floor.middle(), floor.vector) {
            let to = [0, 1].map(|i| from[i] + vector[i] * longer);
            self.arrow(canvas, [seen(from), seen(to)], role);
        }
    }

    /// A line in the ink of a role, `most` points wide.
    fn line(&self, canvas: &mut Canvas, points: Vec<Point>, closed: bool, (role, most): (Role, f32)) {
        let ink = self.theme.ink(role);
        let width = ink.width.min(most);
        canvas.line(points.clone(), closed, solid(width + 2.0 * ink.halo_width.min(most), ink.halo));
        canvas.line(points, closed, solid(width, ink.color));
    }

    fn arrow(&self, canvas: &mut Canvas, [from, to]: [Point; 2], role: Role) {
        let ink = self.theme.ink(role);
        let length = distance(from, to);
        if length > 2.0 {
            self.line(canvas, vec![from, to], false, (role, f32::INFINITY));
            let head = (3.0 + 2.0 * ink.width).min(length) / length;
            let [x, y] = [0, 1].map(|i| (to[i] - from[i]) * head);
            let barb = |side: f32| [to[0] - x - 0.6 * side * y, to[1] - y + 0.6 * side * x];
            self.line(canvas, vec![barb(1.0), to, barb(-1.0)], false, (role, f32::INFINITY));
        }
        canvas.disc(from, 1.0 + ink.width + ink.halo_width / 2.0, ink.halo);
        canvas.disc(from, 1.0 + ink.width - ink.halo_width / 2.0, ink.color);
    }

    /// What each level is, and what was found there.
    fn words(&self, canvas: &mut Canvas, longer: f32, (area, rightmost_x): (Rect, f32)) {
        let (text, dim, stack) = (Type::text(self.theme), Type::dim(self.theme), self.data.stack);
        let small = text.size;
        let line = 1.3 * small;
        let rightmost = |level: usize| {
            let corners = self.corners(level);
            corners.into_iter().fold(corners[0], |a, b| if b[0] > a[0] { b } else { a })
        };
        let near = (1..stack.floors.len()).map(|level| (rightmost(level)[1] - rightmost(level - 1)[1]).abs());
        let is_crowded = near.fold(f32::MAX, f32::min) < 2.2 * line;
        for (level, floor) in stack.floors.iter().enumerate() {
            let corner = rightmost(level);
            let left = (corner[0] + 0.7 * small).min(rightmost_x + 0.5 * small);
            let style = if level == stack.levels.at_work { text } else { dim };
            let (shown, role) =
                floor.vector.map_or((String::new(), Role::Reference), |(v, role)| (description(v), role));
            let found = text.color(self.theme.word(role));
            let place = (Anchor::Start, Level::Middle);
            if is_crowded {
                let short = stack.levels.all[level].name.clone().unwrap_or_else(|| level.to_string());
                let end = canvas.text([left, corner[1]], place, &short, style).max[0];
                canvas.text([end + 0.8 * small, corner[1]], place, &shown, found);
            } else {
                canvas.text([left, corner[1] - 0.5 * line], place, &heading(stack, level), style);
                canvas.text([left, corner[1] + 0.5 * line], place, &shown, found);
            }
        }
        if longer > 1.0 && stack.floors.iter().any(|floor| floor.vector.is_some()) {
            let words = format!("vectors drawn ×{longer}");
            canvas.text([area.min[0], area.max[1]], (Anchor::Start, Level::Bottom), &words, dim);
        }
    }
}

fn distance(a: Point, b: Point) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Levels;

    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    fn stack() -> Stack {
        let frame = |side: usize| Arc::new(Frame::gray(Grid::new(2 * side, side, 200)));
        let level = |side| motionscope_core::scene::Level::new([frame(side), frame(side)]);
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

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn a_stack_tells_itself_in_words_from_the_top() {
        let description = "Pyramid. Level 2, 20×10 px: found (1.50, 0) px; Level 1, 40×20 px: best so far (2, −1) px; Level 0, 80×40 px";
        assert_eq!(summary(&stack()), description);
    }

    #[test]
    fn pictures_of_one_size_stand_above_each_other_under_their_names() {
        let mut stack = stack();
        let frame = Arc::clone(&stack.levels.all[0].pair[0]);
        let level =
            |name: &str| motionscope_core::scene::Level::new([frame.clone(), frame.clone()]).named(name.to_owned());
        stack.levels.all = ["G₁", "G₂", "G₃"].map(level).into();
        let bench = Bench::new(&stack);
        assert_eq!((bench.half(0), bench.half(0)), (bench.half(1), bench.half(2)));
        let data = Pyramid { stack: &stack, whose: "SIFT", on_stage: 0, orbit: USUAL };
        let drawing = draw(data, Rect::new([0.0; 2], [500.0, 360.0]), style(), &mut Seen::default());
        let words = texts(&flat(drawing));
        assert!(
            ["SIFT · 3 pictures", "G₁", "G₃"].iter().all(|name| words.iter().any(|word| word == name)),
            "{words:?}"
        );
    }

    #[test]
    fn every_plane_is_in_the_picture_and_what_is_nearer_hides_what_is_farther() {
        let stack = stack();
        let bench = Bench::new(&stack);
        let rect = Rect::new([0.0; 2], [420.0, 300.0]);
        for i in 0..24 {
            let orbit = Orbit { yaw_rad: i as f32 * 0.26, pitch_rad: 0.1 + 0.06 * i as f32, ..Orbit::default() };
            let screen = Screen::new(rect, &orbit, bench.room(), [0.0; 2]);
            for (level, share) in
                (0..3).flat_map(|level| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(|share| (level, share)))
            {
                let (at, depth) = screen.project(bench.at(level, share));
                let inside = (0..2).all(|i| (-1.0..=rect.max[i] + 1.0).contains(&at[i]));
                assert!(inside && (0.0..1.0).contains(&depth), "{orbit:?} {level}: {at:?}");
            }
            let order = bench.far_to_near(orbit.eye());
            for pair in order.windows(2) {
                // Of two planes on the same side of the eye the one further away comes first.
                let [far, near] = [pair[0], pair[1]].map(|level| bench.height(level) - orbit.eye().y);
                assert!(far * near < 0.0 || far.abs() > near.abs(), "{orbit:?}: {order:?}");
            }
        }
    }

    #[test]
    fn a_picture_fills_its_plane_and_nothing_else() {
        let stack = stack();
        let data = Pyramid { stack: &stack, whose: "Hierarchical search", on_stage: 0, orbit: USUAL };
        let mut seen = Seen::default();
        let drawing = draw(data, Rect::new([0.0; 2], [500.0, 360.0]), style(), &mut seen);
        let planes = drawing.place.clone();
        let primitives = flat(drawing);
        let images = primitives.iter().filter_map(|primitive| match primitive {
            Primitive::Image { pixels, rect } => Some((pixels, rect)),
            _ => None,
        });
        let images: Vec<_> = images.collect();
        assert_eq!(images.len(), 3);
        for ((pixels, rect), &level) in images.iter().zip(&planes.far_to_near) {
            for (x, y) in [(3, 3), (pixels.width() / 2, pixels.height() / 2), (pixels.width() - 2, 1)] {
                let at = [rect.min[0] + x as f32 + 0.5, rect.min[1] + y as f32 + 0.5];
                let shown = pixels[(x, y)][3] > 0;
                assert_eq!(shown, contains(&planes.corners[level], at), "level {level} at {at:?}");
            }
        }
        let words = texts(&primitives);
        for label in ["Hierarchical search · pyramid of 3 levels", "Level 2, 20×10 px", "(1.50, 0) px"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
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
