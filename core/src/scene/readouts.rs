//! The contents beside the stage: equations, tables and charts, as data.
//!
//! A chart shows what is minimised or decided. A [`Plane`] of displacements may have the cost under its lines and points
//! ([`PlaneCost::sampled`], computed when a step is explained); [`Regions`] are the classes of a decision in the plane of its
//! two quantities, such as the eigenvalues of a structure tensor. A [`Surface`] keeps tested costs apart from those that a
//! search skipped (`Surface::untested`), and may stand on a picture ([`Footing`]): window and figures then show it as a
//! landscape, and a click on it finds the step of a candidate. `Estimator::CHARTS` declares the charts of an estimator, and a
//! law checks them.

use super::value::{Decimals, Value};
use super::{Cloud, Diagram, Math, Picture, Role, Stack};
use crate::data::Histogram;
use crate::geometry::Grid;

/// A content of the explanation panel, the plots and the 3-D views. One generic view draws each kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Readout {
    /// Labelled numbers of this step.
    Facts(Vec<Fact>),
    /// A formula, and with the numbers of this step, line by line.
    Equation(Vec<Math>),
    /// Small pictures with their numbers, side by side: the block, the candidate, their difference.
    Tiles(Vec<Tile>),
    /// A quantity over steps.
    Series(Series),
    /// A cost surface over displacements, as a heat map and in 3-D.
    Surface(Surface),
    /// Lines and points in the plane of displacements.
    Plane(Plane),
    /// The regions of a decision in the plane of two quantities.
    Regions(Regions),
    /// A drawing of lines and nodes, such as a tree.
    Diagram(Diagram),
    /// The histogram of displacements.
    Histogram(Histogram),
    /// The distribution of a quantity.
    Distribution(Distribution),
    /// A pyramid with the current block or window on each level.
    Stack(Stack),
    /// Matrices with the numbers of this step.
    Matrices(Vec<Matrix>),
    /// Points in space.
    Cloud(Cloud),
    /// A surface without a chart: it is shown rising out of the picture.
    Landscape(Surface),
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
    /// [`Readout::Regions`].
    Regions,
    /// [`Readout::Diagram`].
    Diagram,
    /// [`Readout::Histogram`].
    Histogram,
    /// [`Readout::Stack`].
    Stack,
    /// [`Readout::Matrices`].
    Matrices,
    /// [`Readout::Cloud`].
    Cloud,
}

impl Chart {
    /// Every chart.
    pub const ALL: &'static [Chart] = &[
        Chart::Tiles,
        Chart::Series,
        Chart::Surface,
        Chart::Plane,
        Chart::Regions,
        Chart::Diagram,
        Chart::Histogram,
        Chart::Stack,
        Chart::Matrices,
        Chart::Cloud,
    ];
}

impl Readout {
    /// The chart that it is of, if it stands in one that an estimator declares.
    pub fn chart(&self) -> Option<Chart> {
        match self {
            Readout::Facts(_) | Readout::Equation(_) | Readout::Distribution(_) | Readout::Landscape(_) => None,
            Readout::Tiles(_) => Some(Chart::Tiles),
            Readout::Series(_) => Some(Chart::Series),
            Readout::Surface(_) => Some(Chart::Surface),
            Readout::Plane(_) => Some(Chart::Plane),
            Readout::Regions(_) => Some(Chart::Regions),
            Readout::Diagram(_) => Some(Chart::Diagram),
            Readout::Histogram(_) => Some(Chart::Histogram),
            Readout::Stack(_) => Some(Chart::Stack),
            Readout::Matrices(_) => Some(Chart::Matrices),
            Readout::Cloud(_) => Some(Chart::Cloud),
        }
    }

    /// Where it stands on a picture, if it can rise out of one.
    pub fn footing(&self) -> Option<&Footing> {
        match self {
            Readout::Surface(surface) | Readout::Landscape(surface) => surface.footing.as_ref(),
            Readout::Plane(plane) => plane.cost.as_ref()?.footing.as_ref(),
            _ => None,
        }
    }

    /// The surface that rises out of a picture, with all that is known of it.
    pub fn landscape(&self) -> Option<Surface> {
        match self {
            Readout::Surface(surface) | Readout::Landscape(surface) => {
                surface.footing.is_some().then(|| surface.landscape())
            }
            Readout::Plane(plane) => plane.landscape(),
            _ => None,
        }
    }
}

/// One labelled number.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// Its name: `Best so far`.
    pub label: &'static str,
    /// Its value as text: `812 at (−3, 2)`.
    pub value: String,
    /// Its role, if it has one.
    pub role: Option<Role>,
    /// The identity of the object that it belongs to, if objects are distinguished: its sign has the colour of that object's marks.
    pub of: Option<u32>,
}

impl Fact {
    /// A number with its label, and its role if it has one.
    pub fn new(label: &'static str, value: impl Into<String>, role: Option<Role>) -> Self {
        Self { label, value: value.into(), role, of: None }
    }

    /// A value with the label of its variable; of a count, the number alone.
    pub fn of_value(value: &Value) -> Self {
        let text = if value.unit.decimals == Decimals::Count { value.bare() } else { value.text() };
        Self::new(value.of.label, text, value.role)
    }

    /// The same number of an object that is distinguished from others.
    #[must_use]
    pub fn of(self, identity: u32) -> Self {
        Self { of: Some(identity), ..self }
    }
}

/// A small picture with readable pixel values.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// What it is.
    pub label: &'static str,
    /// Its role, if it has one.
    pub role: Option<Role>,
    /// The values; NaN where unknown.
    pub values: Grid<f32>,
    /// The values shown black and white.
    pub range: [f32; 2],
    /// Pixels framed in the colour of a role, as they are on the stage.
    pub framed: Vec<Framed>,
}

impl Tile {
    /// A tile without role and frames.
    pub fn new(label: &'static str, values: Grid<f32>, range: [f32; 2]) -> Self {
        Self { label, role: None, values, range, framed: Vec::new() }
    }

    /// A tile of gray levels, 0 to 255.
    pub fn gray(label: &'static str, values: Grid<f32>) -> Self {
        Self::new(label, values, [0.0, 255.0])
    }

    /// A tile of values from 0 to the largest one, which counts as at least 1.
    pub fn positive(label: &'static str, values: Grid<f32>) -> Self {
        let most = values.cells().iter().filter(|v| v.is_finite()).fold(1.0, |most, v| v.max(most));
        Self::new(label, values, [0.0, most])
    }

    /// A tile of values of both signs, up to the largest absolute value, which counts as at least 1.
    pub fn signed(label: &'static str, values: Grid<f32>) -> Self {
        let most = values.cells().iter().filter(|v| v.is_finite()).fold(1.0, |most, v| v.abs().max(most));
        Self::new(label, values, [-most, most])
    }

    /// Returns the tile with a role.
    #[must_use]
    pub fn with_role(self, role: Role) -> Self {
        Self { role: Some(role), ..self }
    }
}

/// Pixels of a [`Tile`] with a meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Framed {
    /// Their role.
    pub role: Role,
    /// The pixels from the upper left corner of the tile.
    pub pixels: Vec<[usize; 2]>,
    /// Whether the frame stands on the edges of a pixel, so that one of another meaning fits inside.
    pub is_outer: bool,
}

/// A matrix, or a vector as one of a single column.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Its symbol in formulas: `P`.
    pub symbol: &'static str,
    /// Its name: `covariance of the state`.
    pub name: &'static str,
    /// Its role, if it has one.
    pub role: Option<Role>,
    /// Its entries.
    pub entries: Grid<f64>,
    /// The labels of the rows, as `x` and `v_x`; empty if they are clear.
    pub rows: Vec<String>,
    /// The same for the columns.
    pub columns: Vec<String>,
    /// The entries that this step changes or uses.
    pub changed: Option<Grid<bool>>,
    /// The decimals of its quantity; `None` for as many as its smallest entry needs.
    pub decimals: Option<usize>,
}

impl Matrix {
    /// A matrix without role, labels and changes.
    pub fn new(symbol: &'static str, name: &'static str, entries: Grid<f64>) -> Self {
        let (rows, columns) = (Vec::new(), Vec::new());
        Self { symbol, name, role: None, entries, rows, columns, changed: None, decimals: None }
    }

    /// A matrix with these rows of entries.
    pub fn of_rows<const WIDTH: usize>(symbol: &'static str, name: &'static str, rows: &[[f64; WIDTH]]) -> Self {
        Self::new(symbol, name, Grid::from_fn(WIDTH, rows.len(), |x, y| rows[y][x]))
    }

    /// A column vector.
    pub fn column(symbol: &'static str, name: &'static str, entries: &[f64]) -> Self {
        Self::new(symbol, name, Grid::from_fn(1, entries.len(), |_, y| entries[y]))
    }

    /// Returns the matrix with a role.
    #[must_use]
    pub fn with_role(self, role: Role) -> Self {
        Self { role: Some(role), ..self }
    }

    /// Returns the matrix with labels of its rows.
    #[must_use]
    pub fn with_rows(self, labels: impl IntoIterator<Item: Into<String>>) -> Self {
        Self { rows: labels.into_iter().map(Into::into).collect(), ..self }
    }

    /// Returns the matrix with labels of its columns.
    #[must_use]
    pub fn with_columns(self, labels: impl IntoIterator<Item: Into<String>>) -> Self {
        Self { columns: labels.into_iter().map(Into::into).collect(), ..self }
    }

    /// Returns the matrix with entries of that many decimals.
    #[must_use]
    pub fn with_decimals(self, decimals: usize) -> Self {
        Self { decimals: Some(decimals), ..self }
    }
}

/// A quantity over steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Title: the quantity plotted.
    pub title: &'static str,
    /// Label of the x axis.
    pub x_label: &'static str,
    /// Label of the y axis, with the unit.
    pub y_label: &'static str,
    /// Final number of steps, so that the axis does not jump.
    pub x_max: usize,
    /// Where ticks of x stand, where x counts things that are numbered; else they are round numbers.
    pub x_ticks: Vec<f32>,
    /// The event of each step from x = 1 on, counted from 1: the target of a click.
    pub events: Vec<usize>,
    /// Sections in the order of x; values of different sections are not comparable.
    pub sections: Vec<Section>,
    /// Number of columns in which the sections stand as plots of their own, row by row; `None` where they follow each other along x.
    pub columns: Option<usize>,
    /// The lines: name, role, and `(x, y)` points. A line is broken where y is NaN (unknown).
    pub lines: Vec<(&'static str, Role, Vec<[f32; 2]>)>,
    /// Ranges in which values are expected.
    pub bands: Vec<Band>,
    /// Limits with their names: `99 % gate`.
    pub thresholds: Vec<(String, f32)>,
    /// Whether the quantity goes over powers of ten, as what becomes small in an iteration does.
    pub is_logarithmic: bool,
    /// Whether the y axis covers the values alone, where 0 is a value like others.
    pub fits_values: bool,
    /// Whether x is a value that was varied, and no step: then only `chosen` is at hand.
    pub is_sweep: bool,
    /// The value of x that is set, of those that were varied; lines have a point there.
    pub chosen: Option<f32>,
    /// Decimals of the values in text; `None` for as many as a value needs.
    pub decimals: Option<usize>,
    /// The step at hand where it is not the last one with a value, as in a pass backward.
    pub present: Option<f32>,
    /// Whether x goes over powers, as a parameter does that is multiplied from value to value.
    pub has_logarithmic_x: bool,
}

impl Series {
    /// Lines over x, from 0 or 1 to `x_max`, under the labels of the x and of the y axis.
    pub fn new(
        title: &'static str,
        [x_label, y_label]: [&'static str; 2],
        x_max: usize,
        lines: Vec<(&'static str, Role, Vec<[f32; 2]>)>,
    ) -> Self {
        Self { title, x_label, y_label, x_max, lines, ..Self::default() }
    }

    /// The points of a line that shows values at x = 1, 2, … as bars from 0: it is broken between them.
    pub fn bars(values: impl Iterator<Item = f32>) -> Vec<[f32; 2]> {
        let bar = |(i, value): (usize, f32)| [f32::NAN, 0.0, value].map(|y| [(i + 1) as f32, y]);
        values.enumerate().flat_map(bar).collect()
    }

    /// The sections of a plot of the entries of a descriptor, `each` for every cell of a square of `side` × `side`, with the numbers of the
    /// cells.
    pub fn cells(side: usize, each: usize) -> Vec<Section> {
        let section = |cell: usize| Section {
            from: (cell * each) as f32 + 0.5,
            label: (cell + 1).to_string(),
            is_part: !cell.is_multiple_of(side),
        };
        (0..side * side).map(section).collect()
    }

    /// The step at hand: `present`, the last one with a value on a line, or the value that is set.
    pub fn now(&self) -> Option<f32> {
        if self.is_sweep {
            return self.chosen;
        }
        if self.present.is_some() {
            return self.present;
        }
        let points = self.lines.iter().flat_map(|(.., points)| points).filter(|point| !point[1].is_nan());
        points.map(|point| point[0]).reduce(f32::max)
    }
}

/// A range in which the values of a [`Series`] are expected.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// What it is: `95 % band`.
    pub name: String,
    /// Its ends.
    pub values: [f32; 2],
    /// The x at which it holds; `None` where it holds for all.
    pub at: Option<f32>,
}

/// A section of a [`Series`].
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Its first x.
    pub from: f32,
    /// Its name: `level 2`.
    pub label: String,
    /// Whether it is part of a longer one.
    pub is_part: bool,
}

/// The distribution of a quantity, from 0 up.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    /// The quantity: `Endpoint error`.
    pub title: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Upper end of the last bin.
    pub top: f32,
    /// Counts of the bins, all of one width.
    pub counts: Vec<u32>,
    /// Count beyond the last bin.
    pub beyond: u32,
    /// Statistics with their names: `mean`.
    pub figures: Vec<(&'static str, f32)>,
    /// Thresholds with the share, 0 to 1, that exceeds them.
    pub shares: Vec<(f32, f32)>,
}

/// A cost surface over displacements, or one of a similarity.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name of the cost: `SAD`.
    pub title: &'static str,
    /// Its unit: `gray levels`; nothing for a pure number.
    pub unit: &'static str,
    /// Whether the values are a similarity, whose maximum is sought, in place of a cost.
    pub is_similarity: bool,
    /// The costs at the ends of the scale of colors, where it stays the same for all of a block; else it goes with what is
    /// known.
    pub scale: Option<[f32; 2]>,
    /// Displacement of the first cell, in px.
    pub origin: [i32; 2],
    /// The costs; NaN where not tested.
    pub values: Grid<f32>,
    /// The event that tested each displacement, counted from 1: the target of a click.
    pub events: Grid<Option<usize>>,
    /// The displacement under test, if any.
    pub probe: Option<[i32; 2]>,
    /// The displacement of minimum cost, or of maximum similarity, so far, if any.
    pub best: Option<[i32; 2]>,
    /// The costs that the search did not work out, once it is over and others know better; NaN where it did.
    pub untested: Option<Grid<f32>>,
    /// The costs that a search has yet to work out, where the whole landscape is shown; NaN elsewhere. None of them is missed.
    pub ahead: Option<Grid<f32>>,
    /// The displacements between pixels that were tested.
    pub between: Vec<BetweenPixels>,
    /// The true displacement in px, once the search is over, where it is known.
    pub truth: Option<[f32; 2]>,
    /// Where it stands on a picture, if it belongs to a place of one.
    pub footing: Option<Footing>,
    /// The quantities along its axes.
    pub axes: Axes,
    /// Places with their names.
    pub named: Vec<(&'static str, Role, [f32; 2])>,
    /// The value at which it has a contour, if one matters.
    pub contour: Option<f32>,
    /// The path of an iteration over it, from place to place.
    pub trail: Vec<[f32; 2]>,
}

/// The quantities along the axes of a [`Surface`], whose cells need not be displacements of whole pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// The two quantities with their units: `u, px`.
    pub names: [&'static str; 2],
    /// Their values at displacement (0, 0).
    pub zero: [f32; 2],
    /// Their step from cell to cell.
    pub step: f32,
}

impl Axes {
    /// Displacements of whole pixels.
    pub const DISPLACEMENTS: Self = Self { names: ["u, px", "v, px"], zero: [0.0; 2], step: 1.0 };

    /// The values at a displacement.
    pub fn at(&self, displacement: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|i| self.zero[i] + self.step * displacement[i])
    }

    /// The displacement with these values.
    pub fn displacement(&self, at: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|i| (at[i] - self.zero[i]) / self.step)
    }
}

/// Where a surface stands on a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Footing {
    /// The picture.
    pub on: Picture,
    /// The point of the picture at displacement (0, 0), in px of the picture.
    pub at: [f32; 2],
    /// How many px of the picture one px of displacement is: 2^level on a level of a pyramid.
    pub px: f32,
    /// The values at all displacements, tested or not, where more is known than the run has worked out.
    pub whole: Option<Grid<f32>>,
}

impl Footing {
    /// A surface that stands at the point `at` of a picture, in its px, with all its values.
    pub fn new(on: Picture, at: [f32; 2]) -> Self {
        Self { on, at, px: 1.0, whole: None }
    }

    /// On a level of a pyramid that was enlarged by `factor` to the size of the picture.
    #[must_use]
    pub fn enlarged(self, factor: f32) -> Self {
        Self { at: self.at.map(|c| (c + 0.5) * factor - 0.5), px: self.px * factor, ..self }
    }
}

/// A displacement between whole pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenPixels {
    /// The displacement in px.
    pub at: [f32; 2],
    /// Its cost or similarity; NaN where it was fitted and not worked out.
    pub value: f32,
}

impl BetweenPixels {
    /// A displacement without a value.
    pub fn of_unknown(at: [f32; 2]) -> Self {
        Self { at, value: f32::NAN }
    }
}

impl Surface {
    /// A surface of these costs, tested by these events, with nothing marked on it.
    pub fn new(title: &'static str, origin: [i32; 2], values: Grid<f32>, events: Grid<Option<usize>>) -> Self {
        Self {
            title,
            unit: "",
            is_similarity: false,
            scale: None,
            origin,
            values,
            events,
            probe: None,
            best: None,
            untested: None,
            ahead: None,
            between: Vec::new(),
            truth: None,
            footing: None,
            axes: Axes::DISPLACEMENTS,
            named: Vec::new(),
            contour: None,
            trail: Vec::new(),
        }
    }

    /// A quantity over a part of a picture, in cells of `step` px around the point `center`; NaN where it is not known.
    pub fn over_picture(
        (title, unit): (&'static str, &'static str),
        (on, center, step): (Picture, [f32; 2], f32),
        values: Grid<f32>,
    ) -> Self {
        let (width, height) = values.size();
        let origin = [width, height].map(|side| -(side as i32 / 2));
        Self {
            unit,
            footing: Some(Footing { px: step, ..Footing::new(on, center) }),
            axes: Axes { names: ["x, px", "y, px"], zero: center, step },
            ..Self::new(title, origin, values, Grid::new(width, height, None))
        }
    }

    /// A quantity over the square of a picture up to `reach` px from `center`, sampled in the middles of `side` × `side` cells.
    pub fn sampled_over_picture(
        names: (&'static str, &'static str),
        (on, center, reach): (Picture, [f32; 2], f32),
        side: usize,
        mut value: impl FnMut([f32; 2]) -> f32,
    ) -> Self {
        let step = 2.0 * reach / side as f32;
        let along = |i: usize, cell: usize| center[i] + step * (cell as f32 - (side / 2) as f32);
        let values = Grid::from_fn(side, side, |x, y| value([along(0, x), along(1, y)]));
        Self::over_picture(names, (on, center, step), values)
    }

    /// The values of pixels of a picture from `origin` on; of many along a side every second, every third, and so on.
    pub fn over_pixels(
        names: (&'static str, &'static str),
        (on, origin): (Picture, [usize; 2]),
        pixels: &Grid<f32>,
    ) -> Self {
        /// Most cells along a side.
        const MOST: usize = 48;
        let (width, height) = pixels.size();
        let step = width.max(height).div_ceil(MOST).max(1);
        let values = Grid::from_fn(width.div_ceil(step), height.div_ceil(step), |x, y| pixels[(x * step, y * step)]);
        let middle = [values.width(), values.height()].map(|side| side / 2 * step);
        let center = [0, 1].map(|i| (origin[i] + middle[i]) as f32);
        Self::over_picture(names, (on, center, step as f32), values)
    }

    /// The same surface with the path of an iteration, given in the quantities along its axes.
    #[must_use]
    pub fn with_trail(self, places: impl IntoIterator<Item = [f32; 2]>) -> Self {
        let trail = places.into_iter().map(|place| self.axes.displacement(place)).collect();
        Self { trail, ..self }
    }

    /// The same surface with pins at places, given in the quantities along its axes.
    #[must_use]
    pub fn with_named(self, places: impl IntoIterator<Item = (&'static str, Role, [f32; 2])>) -> Self {
        let on_it = |(name, role, place)| (name, role, self.axes.displacement(place));
        let named = places.into_iter().map(on_it).collect();
        Self { named, ..self }
    }

    /// The surface with all values that are known, whether or not the search has worked them out yet.
    #[must_use]
    pub fn landscape(&self) -> Self {
        let whole = self.footing.as_ref().and_then(|footing| footing.whole.as_ref());
        let ahead = whole.filter(|_| self.untested.is_none()).map(|whole| {
            let (width, height) = whole.size();
            let left = |x, y| if self.values[(x, y)].is_finite() { f32::NAN } else { whole[(x, y)] };
            Grid::from_fn(width, height, left)
        });
        Self { ahead, ..self.clone() }
    }

    /// The cost of a cell, tested or not; `None` where it is not known.
    pub fn cost(&self, x: usize, y: usize) -> Option<f32> {
        let tested = self.values.get(x, y).filter(|cost| cost.is_finite());
        let others = || self.faint().find_map(|costs| costs.get(x, y));
        tested.or_else(others).copied().filter(|cost| cost.is_finite())
    }

    /// The cost at a place between cells, interpolated; `None` where a neighbour is not known.
    pub fn interpolated(&self, at: [f32; 2]) -> Option<f32> {
        let from = [0, 1].map(|i| at[i] - self.origin[i] as f32);
        let [s, t] = from.map(|c| c - c.floor());
        let cost = |right: bool, down: bool| {
            // A neighbour without weight need not be there.
            let weight = (if right { s } else { 1.0 - s }) * (if down { t } else { 1.0 - t });
            let cell = |c: f32, is_next: bool| (c >= 0.0).then_some(c.floor() as usize + usize::from(is_next));
            if weight == 0.0 {
                Some(0.0)
            } else {
                Some(weight * self.cost(cell(from[0], right)?, cell(from[1], down)?)?)
            }
        };
        Some(cost(false, false)? + cost(true, false)? + cost(false, true)? + cost(true, true)?)
    }

    /// The lines along which the surface has the value `level`, as straight pieces across its cells.
    pub fn contour_lines(&self, level: f32) -> Vec<[[f32; 2]; 2]> {
        let (width, height) = self.values.size();
        let (columns, rows) = (width.saturating_sub(1), height.saturating_sub(1));
        let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        cells.flat_map(|(x, y)| self.contour_in(x, y, level)).collect()
    }

    /// The pieces in the cell between four values: two crossed sides are joined, and of four each with the next one.
    fn contour_in(&self, x: usize, y: usize, level: f32) -> Vec<[[f32; 2]; 2]> {
        let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        let Some(values) = corners.iter().map(|at| self.cost(at.0, at.1)).collect::<Option<Vec<_>>>() else {
            return Vec::new();
        };
        let place = |at: (usize, usize)| [self.origin[0] as f32 + at.0 as f32, self.origin[1] as f32 + at.1 as f32];
        let crossed = (0..4).filter_map(|i| {
            let (a, b) = (values[i], values[(i + 1) % 4]);
            let (from, to) = (place(corners[i]), place(corners[(i + 1) % 4]));
            let share = (level - a) / (b - a);
            ((a < level) != (b < level)).then(|| [0, 1].map(|k| from[k] + share * (to[k] - from[k])))
        });
        crossed.collect::<Vec<_>>().chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect()
    }

    /// The costs of candidates that were not tested, where they are known.
    pub fn faint(&self) -> impl Iterator<Item = &Grid<f32>> {
        self.untested.iter().chain(&self.ahead)
    }

    /// The displacement of minimum cost, or of maximum similarity, that the search has missed, and that value.
    pub fn missed(&self) -> Option<([i32; 2], f32)> {
        let untested = self.untested.as_ref()?;
        let (width, height) = untested.size();
        let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|place| (place, untested[place]));
        let least = all
            .filter(|(_, value)| value.is_finite())
            .min_by(|a, b| self.cost_of(a.1).total_cmp(&self.cost_of(b.1)))?;
        let ((x, y), value) = least;
        let found = self.optimum().map_or(f32::INFINITY, |(found, _)| self.cost_of(found));
        (self.cost_of(value) < found).then_some(([self.origin[0] + x as i32, self.origin[1] + y as i32], value))
    }

    /// A value as a cost: the smaller, the better.
    fn cost_of(&self, value: f32) -> f32 {
        if self.is_similarity { -value } else { value }
    }

    /// The tested displacements in the order of their tests.
    pub fn path(&self) -> Vec<[i32; 2]> {
        let (width, height) = self.events.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let mut tested: Vec<_> = places.filter_map(|place| Some((self.events[place]?, place))).collect();
        tested.sort_unstable();
        tested.into_iter().map(|(_, (x, y))| [self.origin[0] + x as i32, self.origin[1] + y as i32]).collect()
    }

    /// The smallest and largest cost so far, or `None` before the first.
    pub fn range(&self) -> Option<[f32; 2]> {
        let known = self.values.cells().iter().filter(|v| v.is_finite());
        known.fold(None, |range, &v| match range {
            None => Some([v, v]),
            Some([low, high]) => Some([v.min(low), v.max(high)]),
        })
    }

    /// The costs at the ends of the scale of colors, or `None` before the first cost.
    pub fn shades(&self) -> Option<[f32; 2]> {
        self.range().map(|known| self.scale.unwrap_or(known))
    }

    /// The smallest cost, or the largest similarity, so far and the displacements that have it, in the order of rows; several are a
    /// tie.
    pub fn optimum(&self) -> Option<(f32, Vec<[i32; 2]>)> {
        let [low, high] = self.range()?;
        let best = if self.is_similarity { high } else { low };
        let (width, height) = self.values.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let at = places.filter(|place| self.values[*place] == best);
        Some((best, at.map(|(x, y)| [self.origin[0] + x as i32, self.origin[1] + y as i32]).collect()))
    }

    /// The best displacement between pixels, if it is better than all whole ones.
    pub fn optimum_between(&self) -> Option<BetweenPixels> {
        let known = self.between.iter().filter(|between| between.value.is_finite());
        let best = known.min_by(|a, b| self.cost_of(a.value).total_cmp(&self.cost_of(b.value)))?;
        let whole = self.optimum().map_or(f32::INFINITY, |(value, _)| self.cost_of(value));
        (self.cost_of(best.value) < whole).then_some(*best)
    }

    /// The part around the displacements between pixels whose values are known, with a margin of `margin` px; `None` without any.
    #[must_use]
    pub fn around_between(&self, margin: usize) -> Option<Self> {
        let known = || self.between.iter().filter(|between| between.value.is_finite()).map(|between| between.at);
        let first = known().next()?;
        let ends = known().fold([first; 2], |[low, high], at| {
            [[0, 1].map(|i| low[i].min(at[i])), [0, 1].map(|i| high[i].max(at[i]))]
        });
        let (width, height) = self.values.size();
        let last = [width, height].map(|side| side as i32 - 1);
        let place = |c: f32, i: usize| (c as i32 - self.origin[i]).clamp(0, last[i]) as usize;
        let [low, high] =
            [0, 1].map(|end| [0, 1].map(|i| place(if end == 0 { ends[0][i].floor() } else { ends[1][i].ceil() }, i)));
        Some(self.cut([low, high], margin))
    }

    /// The part with all tested displacements, and the minimum that the search missed, with a margin of `margin` px; the whole
    /// surface before the first test.
    #[must_use]
    pub fn around_tested(&self, margin: usize) -> Self {
        let (width, height) = self.values.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let missed = self.missed().map(|(at, _)| [0, 1].map(|i| (at[i] - self.origin[i]) as usize));
        let is_shown = |&(x, y): &(usize, usize)| self.events[(x, y)].is_some() || missed == Some([x, y]);
        let mut tested = places.filter(is_shown).peekable();
        let Some(&(x, y)) = tested.peek() else { return self.clone() };
        let around = |ends: [[usize; 2]; 2], (x, y): (usize, usize)| {
            [[ends[0][0].min(x), ends[0][1].min(y)], [ends[1][0].max(x), ends[1][1].max(y)]]
        };
        self.cut(tested.fold([[x, y]; 2], around), margin)
    }

    /// The part between two cells, with a margin of `margin` px where the surface has it.
    fn cut(&self, [[left, top], [right, bottom]]: [[usize; 2]; 2], margin: usize) -> Self {
        let (width, height) = self.values.size();
        let (left, top) = (left.saturating_sub(margin), top.saturating_sub(margin));
        let (right, bottom) = ((right + margin).min(width - 1), (bottom + margin).min(height - 1));
        let size = (right - left + 1, bottom - top + 1);
        let origin = [self.origin[0] + left as i32, self.origin[1] + top as i32];
        let last = [origin[0] + size.0 as i32 - 1, origin[1] + size.1 as i32 - 1];
        let is_inside = |uv: &[f32; 2]| (0..2).all(|i| (origin[i] as f32..=last[i] as f32).contains(&uv[i].round()));
        let part = |of: &Grid<f32>| Grid::from_fn(size.0, size.1, |x, y| of[(left + x, top + y)]);
        let footing = |footing: &Footing| Footing { whole: footing.whole.as_ref().map(part), ..footing.clone() };
        Self {
            origin,
            truth: self.truth.filter(is_inside),
            values: part(&self.values),
            events: Grid::from_fn(size.0, size.1, |x, y| self.events[(left + x, top + y)]),
            untested: self.untested.as_ref().map(part),
            ahead: self.ahead.as_ref().map(part),
            footing: self.footing.as_ref().map(footing),
            ..self.clone()
        }
    }
}

/// The (u, v) plane of displacements with constraint lines and points, v downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Title: `Gradient constraint`.
    pub title: &'static str,
    /// Unit of displacements: `px`, or `px of level 2`.
    pub unit: String,
    /// The displacement in the middle.
    pub center: [f32; 2],
    /// Displacements up to `reach` px from the middle are shown on both axes.
    pub reach: f32,
    /// A cost of the displacements shown.
    pub cost: Option<PlaneCost>,
    /// Displacements of pixels, each with its group, which has a colour of its own; 0 is none. Several points of one role are the means
    /// of the groups in their order, from group 1 on.
    pub groups: Vec<(u32, [f32; 2])>,
    /// The constraint lines of the pixels.
    pub lines: Vec<Constraint>,
    /// The estimates of an iteration in their order, joined by arrows; fewer than two are no path.
    pub path: Vec<[f32; 2]>,
    /// Displacements with their names.
    pub points: Vec<(&'static str, Role, [f32; 2])>,
    /// Uncertainty of a displacement, if known: an ellipse of one standard deviation.
    pub ellipse: Option<Spread>,
}

/// A cost over the whole of a [`Plane`].
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneCost {
    /// Its name: `mean squared difference`.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The costs in the middles of equal square cells; NaN where it is not defined, since the window leaves the picture.
    pub values: Grid<f32>,
    /// Where displacement (0, 0) stands on a picture, and how many px of it one px of displacement is.
    pub footing: Option<Footing>,
}

impl PlaneCost {
    /// Cells along an axis.
    const MOST: usize = 33;

    /// Evaluates `cost` over the displacements up to `reach` from `center`. Each evaluation reads `each` samples, which decides how many
    /// cells there are.
    pub fn sampled(
        (name, unit): (&'static str, &'static str),
        (center, reach): ([f32; 2], f32),
        each: usize,
        cost: impl Fn([f32; 2]) -> f32,
    ) -> Self {
        let cells = Self::cells(each);
        let along = |i: usize, index: usize| center[i] + reach * ((2 * index + 1) as f32 / cells as f32 - 1.0);
        let values = Grid::from_fn(cells, cells, |x, y| cost([along(0, x), along(1, y)]));
        Self { name, unit, values, footing: None }
    }

    /// Cells along an axis, so that all of them together take a few milliseconds where each reads so many samples.
    pub fn cells(each: usize) -> usize {
        const SAMPLES: f32 = 150_000.0;
        let cells = (SAMPLES / each.max(1) as f32).sqrt() as usize;
        // An odd number, so that the middle is the middle of a cell.
        cells.clamp(9, Self::MOST) | 1
    }

    /// The same cost at a place of a picture.
    #[must_use]
    pub fn on(self, footing: Footing) -> Self {
        Self { footing: Some(footing), ..self }
    }

    /// The same cost, up to `reach` from `center`, as a surface where it stands on a picture.
    pub fn surface(&self, center: [f32; 2], reach: f32) -> Option<Surface> {
        let Self { name, unit, values, footing } = self;
        let footing = footing.as_ref()?;
        let (width, height) = values.size();
        let step = 2.0 * reach / width as f32;
        let at = [0, 1].map(|i| footing.at[i] + footing.px * center[i]);
        let origin = [width, height].map(|side| -(side as i32 / 2));
        Some(Surface {
            unit,
            footing: Some(Footing { at, px: footing.px * step, ..footing.clone() }),
            axes: Axes { zero: center, step, ..Axes::DISPLACEMENTS },
            ..Surface::new(name, origin, values.clone(), Grid::new(width, height, None))
        })
    }

    /// Whether the cost is defined at some of the displacements only.
    pub fn has_gaps(&self) -> bool {
        self.range().is_some() && !self.values.cells().iter().all(|cost| cost.is_finite())
    }

    /// The smallest and largest cost, where any is defined.
    pub fn range(&self) -> Option<[f32; 2]> {
        let known = self.values.cells().iter().copied().filter(|cost| cost.is_finite());
        known.fold(None, |range, cost| match range {
            None => Some([cost; 2]),
            Some([low, high]) => Some([low.min(cost), high.max(cost)]),
        })
    }
}

impl Plane {
    /// The cost of the cell of a displacement, where it is shown and defined.
    pub fn cost_at(&self, at: [f32; 2]) -> Option<f32> {
        let values = &self.cost.as_ref()?.values;
        let cell = |i: usize, cells: usize| {
            let index = ((at[i] - self.center[i]) / self.reach + 1.0) / 2.0 * cells as f32;
            (0.0..cells as f32).contains(&index).then_some(index as usize)
        };
        let cost = values[(cell(0, values.width())?, cell(1, values.height())?)];
        cost.is_finite().then_some(cost)
    }

    /// The cost as a surface on its picture, with the points and the path of the plane on it.
    fn landscape(&self) -> Option<Surface> {
        let surface = self.cost.as_ref()?.surface(self.center, self.reach)?;
        Some(surface.with_named(self.points.iter().copied()).with_trail(self.path.iter().copied()))
    }
}

/// The plane of two quantities that are not negative, divided into the regions of a decision.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// Title: `Eigenvalues of the structure tensor`.
    pub title: &'static str,
    /// The quantities along x and y.
    pub labels: [&'static str; 2],
    /// Values from 0 to this are shown on both axes.
    pub reach: f32,
    /// The boundaries with their names, as lines through pairs of values.
    pub boundaries: Vec<(&'static str, Role, Vec<[f32; 2]>)>,
    /// The names of the regions, and a pair of values in each.
    pub names: Vec<(&'static str, [f32; 2])>,
    /// Pairs of values with their names.
    pub points: Vec<(String, Role, [f32; 2])>,
}

/// A line a u + b v + c = 0 in the plane of displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// The factors a, b and c; a and b are not both 0.
    pub factors: [f32; 3],
    /// Its weight, 0 to 1.
    pub weight: f32,
    /// Its role.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contour_goes_round_where_the_value_is() {
        let cone = |[x, y]: [f32; 2]| 6.0 - (x - 20.0).hypot(y - 10.0);
        let square = (Picture::CURRENT, [20.0, 10.0], 10.0);
        let surface = Surface::sampled_over_picture(("φ", "px"), square, 41, cone);
        let lines = surface.contour_lines(0.0);
        let length: f32 = lines.iter().map(|[a, b]| surface.axes.step * (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert!((length - std::f32::consts::TAU * 6.0).abs() < 0.3, "{length}");
        for at in lines.iter().flatten() {
            assert!(cone(surface.axes.at(*at)).abs() < 0.05, "{at:?}");
        }
        assert!(surface.contour_lines(7.0).is_empty(), "above the peak");
    }

    #[test]
    fn a_cost_in_the_plane_rises_where_its_displacements_are_in_the_picture() {
        let (center, reach) = ([3.0, -1.0], 2.0);
        let bowl = |at: [f32; 2]| (at[0] - 3.5).powi(2) + 2.0 * at[1] * at[1];
        let cost = PlaneCost::sampled(("cost", ""), (center, reach), 200, bowl);
        assert!(cost.surface(center, reach).is_none(), "it stands nowhere");
        // Level 1 of a pyramid.
        let cost = cost.on(Footing { px: 2.0, ..Footing::new(Picture::CURRENT, [40.0, 30.0]) });
        let surface = cost.surface(center, reach).expect("it stands on a picture");
        let footing = surface.footing.as_ref().expect("a footing");
        for (displacement, at) in [([3.0, -1.0], [46.0, 28.0]), ([4.5, 0.25], [49.0, 30.5])] {
            let cell = surface.axes.displacement(displacement);
            let seen = [0, 1].map(|i| footing.at[i] + footing.px * cell[i]);
            assert!((0..2).all(|i| (seen[i] - at[i]).abs() < 1e-4), "{displacement:?}: {seen:?}, not {at:?}");
            let cost = surface.interpolated(cell).expect("it is inside");
            assert!((cost - bowl(displacement)).abs() < 0.1, "{displacement:?}: {cost}");
        }
        assert_eq!(surface.interpolated(surface.axes.displacement([5.5, 0.0])), None, "beyond the plane");
    }

    #[test]
    fn what_a_search_has_yet_to_test_is_not_missed() {
        let values = Grid::from_fn(3, 1, |x, _| if x == 0 { 7.0 } else { f32::NAN });
        let whole = Some(Grid::from_fn(3, 1, |x, _| 7.0 - x as f32));
        let footing = Some(Footing { whole, ..Footing::new(Picture::NEXT, [4.0; 2]) });
        let surface = Surface { footing, ..Surface::new("SAD", [0, 0], values, Grid::new(3, 1, None)) };
        let ahead = surface.landscape();
        assert_eq!((ahead.cost(2, 0), ahead.missed()), (Some(5.0), None));
        let untested = Some(Grid::from_fn(3, 1, |x, _| if x == 0 { f32::NAN } else { 7.0 - x as f32 }));
        let over = Surface { untested, ..surface }.landscape();
        assert_eq!((over.cost(2, 0), over.missed()), (Some(5.0), Some(([2, 0], 5.0))));
    }

    #[test]
    fn a_surface_is_cut_to_what_was_tested() {
        let tested = |x: usize, y: usize| (x == 10 && (4..7).contains(&y)).then_some(x + y);
        let events = Grid::from_fn(33, 33, tested);
        let values = events.map(|event| event.map_or(f32::NAN, |event| event as f32));
        let (title, best) = ("SAD", Some([-6, -11]));
        let whole = Surface { best, ..Surface::new(title, [-16; 2], values, events) };
        let part = whole.around_tested(2);
        assert_eq!((part.origin, part.values.size()), ([-8, -14], (5, 7)));
        assert_eq!((part.range(), part.events[(2, 3)]), (whole.range(), Some(15)));
        let nothing = Surface { events: Grid::new(33, 33, None), ..whole.clone() };
        assert_eq!(nothing.around_tested(2).values.size(), (33, 33));
        // The minimum of the whole window belongs to the part, although a strip around the tests holds a lower cost as well.
        let mut untested = Grid::new(33, 33, 100.0);
        untested[(11, 5)] = 3.0;
        untested[(30, 20)] = 1.0;
        let missed = Surface { untested: Some(untested), ..whole };
        assert_eq!(missed.missed(), Some(([14, 4], 1.0)));
        assert_eq!(missed.around_tested(2).missed(), missed.missed());
    }

    #[test]
    fn a_missed_minimum_lies_where_nothing_was_tested() {
        let tested = |x: usize, y: usize| x + y < 3;
        let cost = |x: usize, y: usize| 20.0 - (x + 2 * y) as f32;
        let values = Grid::from_fn(4, 3, |x, y| if tested(x, y) { cost(x, y) } else { f32::NAN });
        let events = Grid::from_fn(4, 3, |x, y| tested(x, y).then_some(20 - 3 * x - 5 * y));
        let over = Grid::from_fn(4, 3, |x, y| if tested(x, y) { f32::NAN } else { cost(x, y) });
        let surface = Surface::new("SAD", [-1, -1], values, events);
        assert_eq!((surface.missed(), surface.cost(3, 2)), (None, None));
        assert_eq!(surface.path()[..3], [[-1, 1], [0, 0], [1, -1]]);
        let surface = Surface { untested: Some(over), ..surface };
        assert_eq!((surface.missed(), surface.cost(3, 2)), (Some(([2, 1], 13.0)), Some(13.0)));
        assert_eq!(surface.cost(0, 0), Some(20.0));
        let lower = Surface { values: surface.values.map(|cost| cost / 2.0), ..surface };
        assert_eq!(lower.missed(), None, "what is found is lower than all that was left out");
        let similar = Surface { is_similarity: true, ..lower };
        assert_eq!(similar.missed(), Some(([2, -1], 17.0)), "the largest similarity that was left out");
    }

    #[test]
    fn ties_are_found_and_the_scale_stays() {
        let values = Grid::from_fn(3, 2, |x, y| if (x + y) % 2 == 0 { 7.0 } else { 9.0 + y as f32 });
        let events = Grid::new(3, 2, Some(1));
        let surface = Surface::new("SAD", [-1, 0], values, events);
        assert_eq!(surface.optimum(), Some((7.0, vec![[-1, 0], [1, 0], [0, 1]])));
        assert_eq!(surface.shades(), Some([7.0, 10.0]));
        let similar = Surface { is_similarity: true, ..surface.clone() };
        assert_eq!(similar.optimum(), Some((10.0, vec![[-1, 1], [1, 1]])), "the largest similarity");
        let fixed = Surface { scale: Some([0.0, 100.0]), ..surface.clone() };
        assert_eq!(fixed.shades(), Some([0.0, 100.0]));
        let empty = Surface { values: Grid::new(3, 2, f32::NAN), ..fixed };
        assert_eq!((empty.shades(), empty.optimum()), (None, None));
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
