//! What is drawn and told: marks in image pixels, each with an ink role, and words with roles.
//!
//! A scene is data. Painters (window, PNG, SVG) choose colours, dashes and halos by [`Role`].

use std::sync::Arc;

use crate::pseudocode::Name;
pub use crate::role::Role;
use crate::{Grid, Histogram, Levels, Mask, Stack};

/// Which picture of the pair a mark lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    /// Frame t.
    Current,
    /// Frame t + 1.
    Next,
}

/// A mark's geometry in image pixels: x right, y down, pixel centres at integers.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// An axis-parallel rectangle by its outer edges.
    Rect {
        /// Left and top edge.
        min: [f32; 2],
        /// Right and bottom edge.
        max: [f32; 2],
    },
    /// Displacements; painters may lengthen them all by one factor, told in the legend.
    Arrows(Vec<Arrow>),
    /// An ellipse; `angle_rad` turns the first axis from x towards y.
    Ellipse {
        /// Centre.
        center: [f32; 2],
        /// Half axes.
        radii: [f32; 2],
        /// Angle of the first axis in radians.
        angle_rad: f32,
    },
    /// A polyline, or a polygon if closed.
    Path {
        /// Corners.
        points: Vec<[f32; 2]>,
        /// Whether the last corner joins the first.
        closed: bool,
    },
    /// Small crosses or dots.
    Points(Vec<[f32; 2]>),
    /// A short label with its lower left corner at a place.
    Text {
        /// Lower left corner.
        at: [f32; 2],
        /// The label.
        text: String,
    },
    /// A grid of values, one per pixel, painted half-transparent in the colour map; NaN stays clear.
    Heat {
        /// Pixel of the grid's first cell.
        origin: [f32; 2],
        /// The values.
        values: Grid<f32>,
    },
    /// A displacement `[u, v]` in px for every pixel, NaN where it is not known: painters draw arrows at as many of them
    /// as there is room for, and lay colours over the picture that tell of all.
    Flow {
        /// Pixel of the grid's first cell.
        origin: [f32; 2],
        /// The displacements.
        values: Grid<[f32; 2]>,
    },
    /// Pixels that belong to something, painted half-transparent in the colour of the role.
    Mask(Arc<Mask>),
    /// Which region each pixel belongs to, painted half-transparent in a colour for each; 0 stays clear.
    Labels(Arc<Grid<u32>>),
}

impl Shape {
    /// The rectangle around `width × height` whole pixels whose first is `(x, y)`.
    pub fn pixels(x: i32, y: i32, width: usize, height: usize) -> Self {
        let min = [x as f32 - 0.5, y as f32 - 0.5];
        Shape::Rect { min, max: [min[0] + width as f32, min[1] + height as f32] }
    }

    /// Whether it can be drawn: every number of its geometry is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            // There may be many, and they are asked often.
            Shape::Arrows(arrows) => {
                arrows.iter().all(|arrow| arrow.from.iter().chain(&arrow.to).all(|c| c.is_finite()))
            }
            other => other.coordinates().iter().all(|c| c.is_finite()),
        }
    }

    /// Whether it is a layer of colours, one for each pixel, below all lines.
    pub fn is_layer(&self) -> bool {
        matches!(self, Shape::Heat { .. } | Shape::Mask(_) | Shape::Labels(_))
    }

    /// As [`Scene::same`].
    fn same(&self, other: &Shape) -> bool {
        let bits =
            |a: &[f32], b: &[f32]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        match (self, other) {
            (Shape::Heat { origin, values }, Shape::Heat { origin: place, values: others }) => {
                origin == place && values.size() == others.size() && bits(values.cells(), others.cells())
            }
            (Shape::Flow { origin, values }, Shape::Flow { origin: place, values: others }) => {
                let [cells, others_cells] = [values, others].map(|grid| grid.cells().as_flattened());
                origin == place && values.size() == others.size() && bits(cells, others_cells)
            }
            _ => self == other,
        }
    }

    /// The same on a picture `factor` times as wide and high. A pixel becomes `factor` × `factor` of them.
    #[must_use]
    pub fn enlarged(self, factor: usize) -> Self {
        let times = |c: f32| c * factor as f32;
        let place = |point: [f32; 2]| point.map(times);
        // The outer edge of the first pixel is enlarged, not its middle.
        let first = |origin: [f32; 2]| origin.map(|c| times(c - 0.5) + 0.5);
        match self {
            Shape::Rect { min, max } => Shape::Rect { min: place(min), max: place(max) },
            Shape::Arrows(arrows) => {
                Shape::Arrows(arrows.into_iter().map(|a| Arrow { from: place(a.from), to: place(a.to) }).collect())
            }
            Shape::Ellipse { center, radii, angle_rad } => {
                Shape::Ellipse { center: place(center), radii: place(radii), angle_rad }
            }
            Shape::Path { points, closed } => Shape::Path { points: points.into_iter().map(place).collect(), closed },
            Shape::Points(points) => Shape::Points(points.into_iter().map(place).collect()),
            Shape::Text { at, text } => Shape::Text { at: place(at), text },
            Shape::Heat { origin, values } => {
                let (width, height) = values.size();
                let values = Grid::from_fn(width * factor, height * factor, |x, y| values[(x / factor, y / factor)]);
                Shape::Heat { origin: first(origin), values }
            }
            Shape::Flow { origin, values } => {
                let (width, height) = values.size();
                let values =
                    Grid::from_fn(width * factor, height * factor, |x, y| values[(x / factor, y / factor)].map(times));
                Shape::Flow { origin: first(origin), values }
            }
            Shape::Mask(mask) => {
                let (width, height) = mask.size();
                let is_set = |x: usize, y: usize| mask.get(x / factor, y / factor);
                Shape::Mask(Arc::new(Mask::from_fn(width * factor, height * factor, is_set)))
            }
            Shape::Labels(labels) => {
                let (width, height) = labels.size();
                let label = |x: usize, y: usize| labels[(x / factor, y / factor)];
                Shape::Labels(Arc::new(Grid::from_fn(width * factor, height * factor, label)))
            }
        }
    }

    /// Every number of the shape that must be finite for it to be drawn.
    pub fn coordinates(&self) -> Vec<f32> {
        match self {
            Shape::Rect { min, max } => [*min, *max].concat(),
            Shape::Arrows(arrows) => arrows.iter().flat_map(|a| [a.from[0], a.from[1], a.to[0], a.to[1]]).collect(),
            Shape::Ellipse { center, radii, angle_rad } => {
                center.iter().chain(radii).copied().chain([*angle_rad]).collect()
            }
            Shape::Path { points, .. } | Shape::Points(points) => points.concat(),
            Shape::Text { at, .. } => at.to_vec(),
            Shape::Heat { origin, .. } | Shape::Flow { origin, .. } => origin.to_vec(),
            Shape::Mask(_) | Shape::Labels(_) => Vec::new(),
        }
    }
}

/// A displacement: where it starts and where it ends, in image pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where it starts; painters put a dot there.
    pub from: [f32; 2],
    /// Where it ends.
    pub to: [f32; 2],
}

/// About how many arrows stand along the longer side of a picture, unless someone wants more or fewer.
const ARROWS: usize = 36;

/// From one arrow of a dense field to the next on a picture of this size, in px, unless it is chosen.
pub fn arrow_spacing((width, height): (usize, usize)) -> usize {
    (width.max(height) / ARROWS).max(5)
}

/// One mark of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The picture that it lies on.
    pub on: Picture,
    /// What it stands for.
    pub role: Role,
    /// The object that it belongs to where several are told apart: each has a colour of its own in the place of the role's.
    pub of: Option<u32>,
    /// Where it is.
    pub shape: Shape,
}

/// Everything drawn over a pair of pictures, back to front, and the legend that explains it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Marks, back to front.
    pub marks: Vec<Mark>,
    /// What each role means in this scene.
    pub legend: Vec<(Role, &'static str)>,
    /// The pyramid on which the step works, where there is one: its pictures can stand below the marks.
    pub levels: Option<Levels>,
    /// What the values of a heat are called, where no surface says so: `λ`.
    pub heat: Option<&'static str>,
}

impl Scene {
    /// Whether both look the same. Values that are not known yet are NaN, and the same as such.
    pub fn same(&self, other: &Scene) -> bool {
        let same = |(a, b): (&Mark, &Mark)| a.on == b.on && a.role == b.role && a.of == b.of && a.shape.same(&b.shape);
        self.legend == other.legend
            && self.levels == other.levels
            && self.heat == other.heat
            && self.marks.len() == other.marks.len()
            && self.marks.iter().zip(&other.marks).all(same)
    }

    /// Adds a mark on top of the others.
    pub fn mark(&mut self, on: Picture, role: Role, shape: Shape) {
        self.marks.push(Mark { on, role, of: None, shape });
    }

    /// Adds a mark that belongs to object `id`, which has a colour of its own, on top of the others.
    pub fn mark_of(&mut self, id: u32, on: Picture, role: Role, shape: Shape) {
        self.marks.push(Mark { on, role, of: Some(id), shape });
    }

    /// Adds the marks of `other`, a scene on a picture `factor` times smaller, and what their roles mean.
    pub fn add_enlarged(&mut self, other: Scene, factor: usize) {
        let Scene { marks, legend, .. } = other;
        self.marks.extend(marks.into_iter().map(|mark| Mark { shape: mark.shape.enlarged(factor), ..mark }));
        legend.into_iter().for_each(|(role, meaning)| self.legend(role, meaning));
    }

    /// Says what `role` means here, once.
    pub fn legend(&mut self, role: Role, meaning: &'static str) {
        if !self.legend.iter().any(|(r, _)| *r == role) {
            self.legend.push((role, meaning));
        }
    }
}

/// A sentence in which some words carry a role's colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sentence(pub Vec<(String, Option<Role>)>);

impl Sentence {
    /// Adds plain words.
    #[must_use]
    pub fn text(mut self, words: impl Into<String>) -> Self {
        self.0.push((words.into(), None));
        self
    }

    /// Adds words that carry a role's colour.
    #[must_use]
    pub fn ink(mut self, role: Role, words: impl Into<String>) -> Self {
        self.0.push((words.into(), Some(role)));
        self
    }

    /// The sentence without colours, and with nothing but plain spaces.
    pub fn plain(&self) -> String {
        self.0.iter().map(|(words, _)| words.replace('\u{a0}', " ")).collect()
    }
}

/// A typeset formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Math {
    /// Upright numbers and operators, in a role's colour if it has one.
    Text(String, Option<Role>),
    /// An italic variable.
    Var(&'static str),
    /// One after the other.
    Row(Vec<Math>),
    /// A base with an index below right.
    Sub(Box<Math>, Box<Math>),
    /// A base with an exponent above right.
    Sup(Box<Math>, Box<Math>),
    /// A fraction.
    Frac(Box<Math>, Box<Math>),
    /// A sum sign with its running index below.
    Sum(Box<Math>),
    /// Between vertical bars.
    Abs(Box<Math>),
}

impl Math {
    /// Upright text.
    pub fn text(text: impl Into<String>) -> Self {
        Math::Text(text.into(), None)
    }

    /// Upright text in a role's colour.
    pub fn ink(role: Role, text: impl Into<String>) -> Self {
        Math::Text(text.into(), Some(role))
    }

    /// `base` with `index` below right.
    pub fn indexed(base: Math, index: Math) -> Self {
        Math::Sub(Box::new(base), Box::new(index))
    }

    /// `base` with `exponent` above right.
    pub fn power(base: Math, exponent: Math) -> Self {
        Math::Sup(Box::new(base), Box::new(exponent))
    }

    /// The formula on one line, for a screen reader or the clipboard.
    pub fn plain(&self) -> String {
        match self {
            Math::Text(text, _) => text.clone(),
            Math::Var(name) => (*name).into(),
            Math::Row(parts) => parts.iter().map(Math::plain).collect(),
            Math::Sub(base, index) => format!("{}_{}", base.plain(), index.plain()),
            Math::Sup(base, exponent) => format!("{}^{}", base.plain(), exponent.plain()),
            Math::Frac(top, bottom) => format!("({})/({})", top.plain(), bottom.plain()),
            Math::Sum(index) => format!("Σ_{} ", index.plain()),
            Math::Abs(inner) => format!("|{}|", inner.plain()),
        }
    }
}

/// Something that the explanation panel, the plots and the 3-D views show. One generic view draws each kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Readout {
    /// Labelled numbers of this step.
    Facts(Vec<Fact>),
    /// A formula with this step's numbers put in, line by line.
    Equation(Vec<Math>),
    /// Small pictures with their numbers, side by side: the block, the candidate, their difference.
    Tiles(Vec<Tile>),
    /// A quantity over steps.
    Series(Series),
    /// A cost over displacements, as a heat map and as a 3-D surface.
    Surface(Surface),
    /// Lines and points in the plane of displacements.
    Plane(Plane),
    /// How often each displacement was found.
    Histogram(Histogram),
    /// How often a quantity has each value.
    Distribution(Distribution),
    /// A pyramid with what is at hand on each of its levels.
    Stack(Stack),
    /// Matrices with the numbers of this step.
    Matrices(Vec<Matrix>),
}

/// The kinds of [`Readout`] that a chart shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Chart {
    /// [`Readout::Tiles`].
    Tiles,
    /// [`Readout::Series`].
    Series,
    /// [`Readout::Surface`].
    Surface,
    /// [`Readout::Plane`].
    Plane,
    /// [`Readout::Histogram`].
    Histogram,
    /// [`Readout::Stack`].
    Stack,
    /// [`Readout::Matrices`].
    Matrices,
}

impl Chart {
    /// Every chart.
    pub const ALL: &'static [Chart] =
        &[Chart::Tiles, Chart::Series, Chart::Surface, Chart::Plane, Chart::Histogram, Chart::Stack, Chart::Matrices];
}

impl Readout {
    /// The chart that it is of, if it stands in one that an estimator declares.
    pub fn chart(&self) -> Option<Chart> {
        match self {
            Readout::Facts(_) | Readout::Equation(_) | Readout::Distribution(_) => None,
            Readout::Tiles(_) => Some(Chart::Tiles),
            Readout::Series(_) => Some(Chart::Series),
            Readout::Surface(_) => Some(Chart::Surface),
            Readout::Plane(_) => Some(Chart::Plane),
            Readout::Histogram(_) => Some(Chart::Histogram),
            Readout::Stack(_) => Some(Chart::Stack),
            Readout::Matrices(_) => Some(Chart::Matrices),
        }
    }
}

/// One labelled number.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// What it is: `Best so far`.
    pub label: &'static str,
    /// Its value as shown: `812 at (−3, 2)`.
    pub value: String,
    /// Its role, if it has one.
    pub role: Option<Role>,
}

impl Fact {
    /// A number with its label, and its role if it has one.
    pub fn new(label: &'static str, value: impl Into<String>, role: Option<Role>) -> Self {
        Self { label, value: value.into(), role }
    }
}

/// A small picture whose pixels are numbers worth reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// What it is.
    pub label: &'static str,
    /// Its role, if it has one.
    pub role: Option<Role>,
    /// The numbers; NaN where there is none yet.
    pub values: Grid<f32>,
    /// The number shown black and the one shown white.
    pub range: [f32; 2],
}

/// A matrix, or a vector as one of a single column.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// What it is called in formulas: `P`.
    pub symbol: &'static str,
    /// What it is: `covariance of the state`.
    pub name: &'static str,
    /// Its role, if it has one.
    pub role: Option<Role>,
    /// Its entries.
    pub entries: Grid<f64>,
    /// What stands for each row, as `x` and `v_x`; nothing where that is clear.
    pub rows: Vec<String>,
    /// The same for the columns.
    pub columns: Vec<String>,
    /// The entries that this step has changed, or is about.
    pub changed: Option<Grid<bool>>,
}

/// A quantity over steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What is plotted.
    pub title: &'static str,
    /// What runs along x.
    pub x_label: &'static str,
    /// What runs along y, with its unit.
    pub y_label: &'static str,
    /// How many steps there will be, so that the axis does not jump.
    pub x_max: usize,
    /// The event at which each step came, from x = 1 on, counted from 1: where a click on it leads.
    pub events: Vec<usize>,
    /// Where something else is at hand from then on, in the order of x: what is on either side cannot be compared.
    pub sections: Vec<Section>,
    /// The lines: name, role, and `(x, y)` points. A line is broken where y is NaN: nothing is known there.
    pub lines: Vec<(&'static str, Role, Vec<[f32; 2]>)>,
}

/// A stretch of a [`Series`] that begins anew.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Where it begins along x.
    pub from: f32,
    /// What it is: `level 2`.
    pub label: String,
    /// Whether it is part of a longer one.
    pub is_part: bool,
}

/// How often a quantity has each value, from 0 up.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    /// What is counted: `Endpoint error`.
    pub title: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Where the last bar ends.
    pub top: f32,
    /// How many there are in each bar, all of one width.
    pub counts: Vec<u32>,
    /// How many lie beyond the last bar.
    pub beyond: u32,
    /// Values with a name: `mean`.
    pub figures: Vec<(&'static str, f32)>,
    /// Shares, 0 to 1, that exceed a limit.
    pub shares: Vec<(f32, f32)>,
}

/// A cost over displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// What is shown: `SAD`.
    pub title: &'static str,
    /// Displacement of the first cell, in px.
    pub origin: [i32; 2],
    /// The costs; NaN where nothing was tested yet.
    pub values: Grid<f32>,
    /// The event that tested each displacement, counted from 1: where a click on it leads.
    pub events: Grid<Option<usize>>,
    /// The displacement under test, if any.
    pub probe: Option<[i32; 2]>,
    /// The best displacement so far, if any.
    pub best: Option<[i32; 2]>,
}

impl Surface {
    /// The smallest and largest cost so far, or `None` before the first.
    pub fn range(&self) -> Option<[f32; 2]> {
        let known = self.values.cells().iter().filter(|v| v.is_finite());
        known.fold(None, |range, &v| match range {
            None => Some([v, v]),
            Some([low, high]) => Some([v.min(low), v.max(high)]),
        })
    }

    /// The part with all displacements that were tested and those up to `margin` px around them; all of it before the
    /// first.
    #[must_use]
    pub fn around_tested(&self, margin: usize) -> Self {
        let (width, height) = self.values.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let mut tested = places.filter(|place| self.events[*place].is_some()).peekable();
        let Some(&(x, y)) = tested.peek() else { return self.clone() };
        let around = |ends: [[usize; 2]; 2], (x, y): (usize, usize)| {
            [[ends[0][0].min(x), ends[0][1].min(y)], [ends[1][0].max(x), ends[1][1].max(y)]]
        };
        let [[left, top], [right, bottom]] = tested.fold([[x, y]; 2], around);
        let (left, top) = (left.saturating_sub(margin), top.saturating_sub(margin));
        let (right, bottom) = ((right + margin).min(width - 1), (bottom + margin).min(height - 1));
        let size = (right - left + 1, bottom - top + 1);
        Self {
            origin: [self.origin[0] + left as i32, self.origin[1] + top as i32],
            values: Grid::from_fn(size.0, size.1, |x, y| self.values[(left + x, top + y)]),
            events: Grid::from_fn(size.0, size.1, |x, y| self.events[(left + x, top + y)]),
            ..self.clone()
        }
    }
}

/// What pixels say about their displacement (u, v): lines and points in the plane of displacements, v downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// What is shown: `Gradient constraint`.
    pub title: &'static str,
    /// What displacements are measured in: `px`, or `px of level 2`.
    pub unit: String,
    /// Displacements from `-reach` to `reach` px are shown on both axes.
    pub reach: f32,
    /// The lines on which pixels allow the displacement to lie.
    pub lines: Vec<Constraint>,
    /// Displacements with their names.
    pub points: Vec<(&'static str, Role, [f32; 2])>,
    /// How certain a displacement is, where that is known: an ellipse of one standard deviation.
    pub ellipse: Option<Spread>,
}

/// A line a u + b v + c = 0 in the plane of displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// The factors a, b and c; a and b are not both 0.
    pub factors: [f32; 3],
    /// How much it counts, 0 to 1.
    pub weight: f32,
    /// What it stands for.
    pub role: Role,
}

impl Constraint {
    /// The ends of the part that lies within ±`reach`, if any does.
    pub fn within(&self, reach: f32) -> Option<[[f32; 2]; 2]> {
        let [a, b, c] = self.factors;
        let norm = a.hypot(b);
        // Along the line from its point nearest to zero, as far as each pair of edges allows.
        let (foot, way) = ([-a * c, -b * c].map(|p| p / (norm * norm)), [-b / norm, a / norm]);
        let mut span = [f32::NEG_INFINITY, f32::INFINITY];
        for i in 0..2 {
            if way[i].abs() < 1e-6 {
                if foot[i].abs() > reach {
                    return None;
                }
                continue;
            }
            let ends = [-reach, reach].map(|edge| (edge - foot[i]) / way[i]);
            span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
        }
        let at = |s: f32| [0, 1].map(|i| foot[i] + s * way[i]);
        (span[0] < span[1] && span.iter().all(|s| s.is_finite())).then(|| span.map(at))
    }
}

/// An ellipse in the plane of displacements, in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Its centre.
    pub center: [f32; 2],
    /// Half axes.
    pub radii: [f32; 2],
    /// Angle of the first axis, from u towards v, in radians.
    pub angle_rad: f32,
}

/// What a step tells: the line of the pseudocode, why, and the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The line of [`crate::Info::pseudocode`] that is at work.
    pub line: Name,
    /// What happened and why, in one or two sentences.
    pub sentence: Sentence,
    /// What the panels show.
    pub readouts: Vec<Readout>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_is_cut_to_what_was_tested() {
        let tested = |x: usize, y: usize| (x == 10 && (4..7).contains(&y)).then_some(x + y);
        let events = Grid::from_fn(33, 33, tested);
        let values = events.map(|event| event.map_or(f32::NAN, |event| event as f32));
        let whole = Surface { title: "SAD", origin: [-16; 2], values, events, probe: None, best: Some([-6, -11]) };
        let part = whole.around_tested(2);
        assert_eq!((part.origin, part.values.size()), ([-8, -14], (5, 7)));
        assert_eq!((part.range(), part.events[(2, 3)]), (whole.range(), Some(15)));
        let nothing = Surface { events: Grid::new(33, 33, None), ..whole };
        assert_eq!(nothing.around_tested(2).values.size(), (33, 33));
    }

    #[test]
    fn a_constraint_is_cut_where_the_plane_ends() {
        let line = |factors| Constraint { factors, weight: 1.0, role: Role::Candidate };
        for factors in [[1.0, 0.0, -2.0], [3.0, -4.0, 5.0], [-0.5, 0.25, 0.0], [1.0, 1.0, 7.9]] {
            let ends = line(factors).within(4.0).expect("it passes through");
            for [u, v] in ends {
                assert!((factors[0] * u + factors[1] * v + factors[2]).abs() < 1e-4, "{factors:?}");
                assert!((u.abs().max(v.abs()) - 4.0).abs() < 1e-4, "{factors:?} ends at {u}, {v}");
            }
        }
        assert_eq!(line([1.0, 0.0, 5.0]).within(4.0), None);
        assert_eq!(line([1.0, 1.0, 9.0]).within(4.0), None);
    }
}
