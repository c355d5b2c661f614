//! What painters paint: a handful of shapes in points, back to front.

use std::sync::Arc;

use motionscope_core::geometry::Grid;
use motionscope_core::scene;

use super::Color;
use super::fonts::{self, Face};

/// A place in points: x right, y down.
pub type Point = [f32; 2];

/// An axis-parallel rectangle in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Upper left corner.
    pub min: Point,
    /// Lower right corner.
    pub max: Point,
}

impl Rect {
    /// The rectangle of `size` whose upper left corner is `min`.
    pub fn new(min: Point, size: [f32; 2]) -> Self {
        Self { min, max: [min[0] + size[0], min[1] + size[1]] }
    }

    /// The rectangle with these two corners, upper left and lower right.
    pub fn between(min: Point, max: Point) -> Self {
        Self { min, max }
    }

    /// The rectangle of `size` around `center`.
    pub fn centered(center: Point, size: [f32; 2]) -> Self {
        Self { min: [0, 1].map(|i| center[i] - size[i] / 2.0), max: [0, 1].map(|i| center[i] + size[i] / 2.0) }
    }

    /// The same rectangle elsewhere.
    #[must_use]
    pub fn moved(&self, by: Point) -> Self {
        Self { min: [0, 1].map(|i| self.min[i] + by[i]), max: [0, 1].map(|i| self.max[i] + by[i]) }
    }

    /// Width and height.
    pub fn size(&self) -> [f32; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    /// The rectangle whose edges lie `by` further out.
    #[must_use]
    pub fn grown(&self, by: f32) -> Self {
        Self { min: self.min.map(|c| c - by), max: self.max.map(|c| c + by) }
    }

    /// The four corners, clockwise from the upper left.
    pub fn corners(&self) -> Vec<Point> {
        let ([x0, y0], [x1, y1]) = (self.min, self.max);
        vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    }

    /// Its middle.
    pub fn center(&self) -> [f32; 2] {
        [0, 1].map(|i| (self.min[i] + self.max[i]) / 2.0)
    }

    /// Whether `point` lies in it.
    pub fn contains(&self, point: [f32; 2]) -> bool {
        (0..2).all(|i| (self.min[i]..=self.max[i]).contains(&point[i]))
    }

    /// Whether the two have an inner point in common.
    pub fn meets(&self, other: &Rect) -> bool {
        (0..2).all(|i| self.min[i] < other.max[i] && other.min[i] < self.max[i])
    }
}

/// How a line is drawn: flat ends, mitred corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Width.
    pub width: f32,
    /// Colour.
    pub color: Color,
    /// Lengths of dashes and gaps in turn; empty for a solid line.
    pub dash: &'static [f32],
}

/// Words in one colour and face.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The words.
    pub text: String,
    /// Their colour.
    pub color: Color,
    /// Their face.
    pub face: Face,
    /// Color of a line below them, if there is one.
    pub underline: Option<Color>,
}

impl Run {
    /// Words in Inter.
    pub fn new(text: impl Into<String>, color: Color) -> Self {
        Self { text: text.into(), color, face: Face::Sans, underline: None }
    }

    /// The same words in `face`.
    #[must_use]
    pub fn face(mut self, face: Face) -> Self {
        self.face = face;
        self
    }

    /// The same words over a line.
    #[must_use]
    pub fn underlined(mut self, color: Color) -> Self {
        self.underline = Some(color);
        self
    }
}

/// Thickness of the line below words.
const UNDERLINE_PT: f32 = 2.0;

/// Which part of a line of text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// One line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// A point of its baseline.
    pub at: Point,
    /// Which point that is.
    pub anchor: Anchor,
    /// Size of the type.
    pub size: f32,
    /// The words, one run after the other.
    pub runs: Vec<Run>,
    /// Colour of a thin rim around the letters, over footage.
    pub halo: Option<Color>,
}

impl Line {
    /// Width in the program's own type.
    pub fn width(&self) -> f32 {
        self.runs.iter().map(|run| fonts::width(&run.text, run.face, self.size)).sum()
    }

    /// The lines below words, where there are some.
    pub fn underlines(&self) -> impl Iterator<Item = Primitive> + '_ {
        let ([mut x, y], down) = (self.start(), 0.16 * self.size);
        self.runs.iter().filter_map(move |run| {
            let from = x;
            x += fonts::width(&run.text, run.face, self.size);
            let spaces = fonts::width(&run.text[run.text.trim_end().len()..], run.face, self.size);
            let stroke = Stroke { width: UNDERLINE_PT, color: run.underline?, dash: &[] };
            let points = vec![[from, y + down], [x - spaces, y + down]];
            Some(Primitive::Polyline { points, closed: false, stroke })
        })
    }

    /// Left end of the baseline.
    pub fn start(&self) -> Point {
        let share = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        [self.at[0] - share * self.width(), self.at[1]]
    }
}

/// The form of every arrow, whoever draws it; the window's shader is told the same numbers.
pub mod form {
    /// Radius of the dot at the origin, in widths.
    pub const DOT: f32 = 0.9;
    /// Least length of what points anywhere, in widths; less is nearly nothing, and a dot.
    pub const REACH: f32 = 1.6;
    /// Length of the head, in widths.
    pub const HEAD: f32 = 4.0;
    /// Most of an arrow's length that is head.
    pub const HEAD_SHARE: f32 = 0.45;
    /// Half the width of the head, as a share of its length.
    pub const BARB: f32 = 0.4;
    /// Half the width of the shaft where it meets the head, in widths.
    pub const SHAFT: f32 = 0.5;
    /// Most of half the head's width that is shaft.
    pub const SHAFT_SHARE: f32 = 0.6;
    /// Width of the shaft at its origin, as a share of that at the head.
    pub const TAPER: f32 = 0.5;
    /// How far the rim reaches beyond the tip, in rims: its point is cut short of the full mitre.
    pub const TIP: f32 = 1.6;
}

/// What arrows are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Width of the shaft where it meets the head.
    pub width: f32,
    /// Colour.
    pub color: Color,
    /// Colour of the rim.
    pub halo: Color,
    /// Width of the rim.
    pub halo_width: f32,
}

/// Thin tapered arrows with a dot at their origin, one over the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrows {
    /// Where each starts and ends, in image pixels: these stay the same however close one looks.
    pub ends: Arc<[scene::Arrow]>,
    /// Where the centre of the first image pixel lies.
    pub origin: Point,
    /// Points per image pixel.
    pub zoom: f32,
    /// How many times their length displacements are drawn.
    pub lengthen: f32,
    /// What they are drawn with.
    pub pen: Pen,
}

impl Arrows {
    /// One arrow in points.
    pub fn one(from: Point, to: Point, pen: Pen) -> Self {
        Self::of(Arc::new([scene::Arrow { from, to }]), pen)
    }

    /// Arrows in points.
    pub fn of(ends: Arc<[scene::Arrow]>, pen: Pen) -> Self {
        Self { ends, origin: [0.0; 2], zoom: 1.0, lengthen: 1.0, pen }
    }

    /// The arrows in points, back to front.
    pub fn iter(&self) -> impl Iterator<Item = Arrow> + '_ {
        self.ends.iter().map(|ends| {
            let from = [0, 1].map(|i| self.origin[i] + ends.from[i] * self.zoom);
            let way = [0, 1].map(|i| (ends.to[i] - ends.from[i]) * self.lengthen * self.zoom);
            let length = way[0].hypot(way[1]);
            let is_any = length >= form::REACH * self.pen.width;
            Arrow { from, to: [0, 1].map(|i| if is_any { from[i] + way[i] } else { from[i] }), pen: self.pen }
        })
    }
}

/// Lines that fade towards their start.
#[derive(Clone, Debug, PartialEq)]
pub struct Trails {
    /// The places of each, and how strong it is drawn, 0 to 1.
    pub lines: Vec<(Vec<Point>, f32)>,
    /// What they are drawn with where they are strongest.
    pub pen: Pen,
}

impl Trails {
    /// Every line as pieces that grow towards its head, and a dot there, back to front: all rims, then all lines.
    pub fn primitives(&self) -> impl Iterator<Item = Primitive> + '_ {
        let Pen { width, color, halo, halo_width } = self.pen;
        [(halo, halo_width), (color, 0.0)].into_iter().flat_map(move |(color, grow)| {
            self.lines.iter().flat_map(move |(points, strength)| {
                let count = points.len().saturating_sub(1).max(1) as f32;
                let at =
                    move |share: f32| (width * (0.25 + 0.75 * share), color.alpha((255.0 * strength * share) as u8));
                let pieces = points.windows(2).enumerate().map(move |(i, ends)| {
                    let (width, color) = at((i + 1) as f32 / count);
                    let stroke = Stroke { width: width + 2.0 * grow, color, dash: &[] };
                    Primitive::Polyline { points: ends.to_vec(), closed: false, stroke }
                });
                let (width, color) = at(1.0);
                let head = points.last().map(|&center| Primitive::Disc { center, radius: 0.8 * width + grow, color });
                pieces.chain(head)
            })
        })
    }
}

/// One arrow in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Centre of the dot.
    pub from: Point,
    /// Tip; equal to `from` for no displacement, which is drawn as the dot alone.
    pub to: Point,
    /// What it is drawn with.
    pub pen: Pen,
}

impl Arrow {
    /// Radius of the dot at the origin.
    pub fn dot(&self) -> f32 {
        self.pen.width * form::DOT
    }

    /// A rectangle that holds everything that is painted.
    pub fn bounds(&self) -> Rect {
        around(&[self.from, self.to]).grown(self.pen.width * 2.0 + self.pen.halo_width * 3.0 + 1.0)
    }

    fn length(&self) -> f32 {
        (self.to[0] - self.from[0]).hypot(self.to[1] - self.from[1])
    }

    /// Shaft and head as one outline, `grow` further out all round (0 for the arrow, its `halo_width` for the rim).
    /// `None` for no displacement.
    ///
    /// It is star-shaped about [`Arrow::hub`]: triangles from there to each side fill it.
    pub fn outline(&self, grow: f32) -> Option<[Point; 7]> {
        let length = self.length();
        if length < 1e-3 {
            return None;
        }
        let (head, half) = self.head();
        let along = [(self.to[0] - self.from[0]) / length, (self.to[1] - self.from[1]) / length];
        let slope = half / head;
        // The rim runs parallel to the head's sides.
        let barb = half + grow * slope + grow * slope.hypot(1.0);
        let tip = length + grow * form::TIP;
        let neck = length - head - grow;
        let thick = (self.pen.width * form::SHAFT).min(half * form::SHAFT_SHARE);
        let (thin, thick) = (thick * form::TAPER + grow, thick + grow);
        let tail = neck.min(0.0);
        let at = |s: f32, side: f32| {
            [self.from[0] + along[0] * s - along[1] * side, self.from[1] + along[1] * s + along[0] * side]
        };
        Some([
            at(tail, -thin),
            at(neck, -thick),
            at(neck, -barb),
            at(tip, 0.0),
            at(neck, barb),
            at(neck, thick),
            at(tail, thin),
        ])
    }

    /// Where shaft and head meet.
    pub fn hub(&self) -> Point {
        let t = 1.0 - self.head().0 / self.length().max(1e-3);
        std::array::from_fn(|i| self.from[i] + (self.to[i] - self.from[i]) * t)
    }

    /// Length and half the width of the head; a short arrow has a small head.
    fn head(&self) -> (f32, f32) {
        let head = (self.pen.width * form::HEAD).min(self.length() * form::HEAD_SHARE);
        (head, head * form::BARB)
    }
}

/// One thing to paint.
#[derive(Clone, Debug, PartialEq)]
pub enum Primitive {
    /// A filled convex polygon.
    Polygon {
        /// Corners.
        points: Vec<Point>,
        /// Colour.
        color: Color,
    },
    /// A line along points.
    Polyline {
        /// Corners.
        points: Vec<Point>,
        /// Whether the last corner joins the first.
        closed: bool,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// A filled disc.
    Disc {
        /// Centre.
        center: Point,
        /// Radius.
        radius: f32,
        /// Colour.
        color: Color,
    },
    /// Arrows in one ink.
    Arrows(Arrows),
    /// Lines that fade.
    Trails(Trails),
    /// A line of text.
    Text(Line),
    /// A picture whose pixels are shown as squares, never blurred.
    Image {
        /// Red, green, blue and straight alpha.
        pixels: Arc<Grid<[u8; 4]>>,
        /// Where its outer edges lie.
        rect: Rect,
    },
}

impl Primitive {
    /// The same elsewhere.
    #[must_use]
    pub fn moved(self, by: Point) -> Self {
        let to = |point: Point| [point[0] + by[0], point[1] + by[1]];
        match self {
            Primitive::Polygon { points, color } => {
                Primitive::Polygon { points: points.into_iter().map(to).collect(), color }
            }
            Primitive::Polyline { points, closed, stroke } => {
                Primitive::Polyline { points: points.into_iter().map(to).collect(), closed, stroke }
            }
            Primitive::Disc { center, radius, color } => Primitive::Disc { center: to(center), radius, color },
            Primitive::Arrows(arrows) => Primitive::Arrows(Arrows { origin: to(arrows.origin), ..arrows }),
            Primitive::Trails(Trails { lines, pen }) => {
                let line = |(points, strength): (Vec<Point>, f32)| (points.into_iter().map(to).collect(), strength);
                Primitive::Trails(Trails { lines: lines.into_iter().map(line).collect(), pen })
            }
            Primitive::Text(line) => Primitive::Text(Line { at: to(line.at), ..line }),
            Primitive::Image { pixels, rect } => Primitive::Image { pixels, rect: rect.moved(by) },
        }
    }

    /// A rectangle that holds everything that is painted.
    pub fn bounds(&self) -> Rect {
        match self {
            Primitive::Polygon { points, .. } => around(points).grown(1.0),
            // A mitred corner reaches at most four half widths out.
            Primitive::Polyline { points, stroke, .. } => around(points).grown(stroke.width * 2.0 + 1.0),
            Primitive::Disc { center, radius, .. } => around(&[*center]).grown(radius + 1.0),
            Primitive::Arrows(arrows) => {
                let corners: Vec<Point> =
                    arrows.iter().map(|arrow| arrow.bounds()).flat_map(|r| [r.min, r.max]).collect();
                around(&corners)
            }
            Primitive::Trails(trails) => {
                let corners: Vec<Point> = trails.lines.iter().flat_map(|(points, _)| points).copied().collect();
                around(&corners).grown(trails.pen.width + trails.pen.halo_width + 1.0)
            }
            Primitive::Text(line) => {
                let [x, y] = line.start();
                Rect::new([x, y - line.size], [line.width(), line.size * 1.4]).grown(4.0)
            }
            Primitive::Image { rect, .. } => *rect,
        }
    }
}

fn around(points: &[Point]) -> Rect {
    let mut rect = Rect { min: [f32::MAX; 2], max: [f32::MIN; 2] };
    for point in points {
        rect.min = [rect.min[0].min(point[0]), rect.min[1].min(point[1])];
        rect.max = [rect.max[0].max(point[0]), rect.max[1].max(point[1])];
    }
    rect
}

/// Primitives that are seen only inside a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Nothing is painted outside, if there is one.
    pub clip: Option<Rect>,
    /// Back to front.
    pub primitives: Vec<Primitive>,
}

impl Layer {
    /// The same elsewhere.
    #[must_use]
    pub fn moved(self, by: Point) -> Self {
        let primitives = self.primitives.into_iter().map(|primitive| primitive.moved(by)).collect();
        Self { clip: self.clip.map(|clip| clip.moved(by)), primitives }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrow(to: Point) -> Arrow {
        let pen = Pen { width: 2.0, color: Color::WHITE, halo: Color::BLACK, halo_width: 1.0 };
        Arrow { from: [10.0, 10.0], to, pen }
    }

    #[test]
    fn an_arrow_is_star_shaped_about_its_hub_and_its_rim_holds_it() {
        for to in [[40.0, 10.0], [11.0, 10.5], [3.0, -17.0]] {
            let arrow = arrow(to);
            let (inner, outer) = (arrow.outline(0.0), arrow.outline(1.0));
            let (Some(inner), Some(outer)) = (inner, outer) else { panic!("an arrow without an outline") };
            let cross = |o: Point, a: Point, b: Point| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
            for outline in [inner, outer] {
                for i in 0..7 {
                    assert!(cross(arrow.hub(), outline[i], outline[(i + 1) % 7]) > -1e-2, "{arrow:?} side {i}");
                }
            }
            let inside = |p: Point| (0..7).all(|i| i == 1 || i == 4 || cross(outer[i], outer[(i + 1) % 7], p) > -1e-3);
            assert!(inside(inner[3]) && inside(inner[6]), "the tip or the tail sticks out of the rim");
        }
    }

    #[test]
    fn no_displacement_is_a_dot() {
        assert_eq!(arrow([10.0, 10.0]).outline(0.0), None);
    }
}
