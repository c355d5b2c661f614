//! Formulas, facts and image patches that explain derivatives and gradient constraints.

use super::numbers::PX_DECIMALS;
use super::{Derivatives, Linear};
use crate::base::words;
use crate::geometry::{Grid, Sampling};
use crate::scene::{Constraint, Role, Section, Step, Tile, Unit};
use crate::{cases, variables};

/// The unit of an image gradient.
pub const GRADIENT_UNIT: Unit = Unit::new("gray levels per px", 2);

variables! { pub mod value;
    /// The inspected pixel.
    PIXEL: "Pixel", r"\mathbf{x}", Unit::WHOLE, Role::Reference;
    /// The derivatives of the brightness along x, y and t at the pixel.
    DERIVATIVES: "I_x, I_y, I_t", r"(I_x, I_y, I_t)", Unit::new("", 2);
    /// The derivative of the brightness along x at the pixel.
    I_X: "", "I_x", GRADIENT_UNIT, Role::Reference;
    /// The derivative of the brightness along y at the pixel.
    I_Y: "", "I_y", GRADIENT_UNIT, Role::Reference;
    /// The derivative of the brightness along t at the pixel: its change from frame to frame.
    I_T: "", "I_t", Unit::new("gray levels per frame", 2), Role::Reference;
    /// The magnitude of the image gradient at the pixel.
    GRADIENT: "Gradient |∇I|", r"|\nabla I|", GRADIENT_UNIT;
    /// The larger eigenvalue of the structure tensor of the window, in (gray levels per px)².
    LAMBDA_1: "Eigenvalues λ₁, λ₂", r"\lambda_1", Unit::FINE;
    /// The smaller eigenvalue of the structure tensor of the window, in (gray levels per px)².
    LAMBDA_2: "Smaller eigenvalue λ₂", r"\lambda_2", Unit::FINE;
    /// The smallest accepted eigenvalue λ₂ of the structure tensor.
    MIN_EIGENVALUE: "", r"\lambda_{\min}", Unit::FINE;
    /// The true flow at the pixel.
    TRUE_FLOW: "True flow", "", Unit::SUBPIXEL, Role::Truth;
    /// The flow at which the gradient constraint is linearised.
    START: "Linearised at", "(u_0, v_0)", Unit::SUBPIXEL;
    /// The constant term of the linearised gradient constraint.
    CONSTANT_TERM: "", "c", I_T.unit, Role::Reference;
    /// The level of the pyramid; 0 is full resolution.
    LEVEL: "Level", "", Unit::WHOLE;
    /// The coarsest level of the pyramid.
    COARSEST_LEVEL: "", "", Unit::WHOLE;
    /// The width of the level in its pixels.
    WIDTH: "", "", Unit::new("px", 0);
    /// The height of the level in its pixels.
    HEIGHT: "", "", Unit::new("px", 0);
    /// The number of the iteration.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The largest number of iterations.
    ITERATIONS: "", "", Unit::WHOLE;
    /// The mean change of the flow in the iteration.
    MEAN_CHANGE: "Mean change", "", Unit::SUBPIXEL;
    /// The mean endpoint error of the flow after the iteration, in px of level 0.
    ITERATION_ERROR: "Mean endpoint error", "", Unit::SUBPIXEL, Role::Error;
}

cases! { pub over value;
    LEVEL: "{level} ({coarsest_level} is the coarsest), {width:bare}×{height}",
    ITERATION: "{iteration} of {iterations}",
    MEAN_CHANGE: "Mean change of the iteration: {mean_change}.",
}

/// Adds the gradient constraint of a step with derivatives, in symbols and with their numbers.
pub fn constraint(step: Step) -> Step {
    step.formula("I_x u + I_y v + I_t = 0").formula("{i_x} u {i_y:signed} v {i_t:signed} = 0")
}

/// The decimals of derivatives in a formula: one more where any is below 1, so that the shown numbers give the shown result.
fn decimals(derivatives: [f32; 3]) -> usize {
    if derivatives.iter().any(|d| d.abs() < 1.0) { 3 } else { 2 }
}

/// The constraint line of a pixel in the (u, v) plane; `None` without gradient, which allows any flow.
pub fn line(factors: [f32; 3], weight: f32, role: Role) -> Option<Constraint> {
    let is_line = factors.iter().all(|f| f.is_finite()) && factors[0].hypot(factors[1]) > 1e-3;
    is_line.then_some(Constraint { factors, weight, role })
}

/// Name and unit of the mean squared difference of a window.
pub const SQUARED_DIFFERENCE: (&str, &str) = ("mean squared difference", "gray levels²");

/// Half the side of the (u, v) plane that shows `points` with some margin.
pub fn reach(points: impl IntoIterator<Item = [f32; 2]>) -> f32 {
    let most = points.into_iter().flatten().filter(|c| c.is_finite()).fold(0.0f32, |most, c| most.max(c.abs()));
    // Powers of two keep it constant from step to step.
    let mut reach = 1.0;
    while reach < 1.25 * most && reach < 1024.0 {
        reach *= 2.0;
    }
    reach
}

/// The part of the (u, v) plane around some displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The displacement in the middle.
    pub center: [f32; 2],
    /// How far it reaches from there on both axes, in px.
    pub reach: f32,
}

impl View {
    /// The reach of a plane at least, in px.
    const LEAST_PX: f32 = 0.1;
    /// The share of the reach that the displacements take up at most, and the steps of the middle in it.
    const FILLED: f32 = 0.75;
    const STEP: f32 = 0.25;
    /// Lines are included as long as the plane is at most this many times as wide as its displacements need.
    const FOR_LINE: f32 = 4.0;
    /// Up to this many lines are considered one by one.
    const FEW: usize = 2;

    /// The part that shows `points` with some margin, and of few `lines` each that does not lie much farther away.
    pub fn around(points: &[[f32; 2]], lines: &[Constraint]) -> Self {
        let alone = Self::of(points);
        let feet = lines.iter().filter(|_| lines.len() <= Self::FEW).map(|line| foot(line, alone.center));
        let all: Vec<_> = points.iter().copied().chain(feet).collect();
        let with_lines = Self::of(&all);
        if with_lines.reach <= Self::FOR_LINE * alone.reach { with_lines } else { alone }
    }

    fn of(points: &[[f32; 2]]) -> Self {
        let range = |i: usize| {
            let along = points.iter().map(|point| point[i]).filter(|c| c.is_finite());
            along.fold(None, |range, c| Some(range.map_or([c; 2], |[low, high]: [f32; 2]| [low.min(c), high.max(c)])))
        };
        let ranges = [0, 1].map(|i| range(i).unwrap_or([0.0; 2]));
        let half = ranges.iter().map(|[low, high]| (high - low) / 2.0).fold(0.0f32, f32::max);
        // 1, 2, 5, 10 and so on, and a middle in steps: they seldom change from step to step.
        let reaches = std::iter::successors(Some(Self::LEAST_PX), |first| Some(10.0 * first));
        let mut reaches = reaches.flat_map(|first| [first, 2.0 * first, 5.0 * first]);
        let reach = reaches.find(|reach| half <= Self::FILLED * reach || *reach > 1024.0).unwrap_or(Self::LEAST_PX);
        let step = Self::STEP * reach;
        Self { center: ranges.map(|[low, high]| ((low + high) / 2.0 / step).round() * step), reach }
    }
}

/// The displacement on a constraint line that is nearest to `from`.
pub fn foot(line: &Constraint, from: [f32; 2]) -> [f32; 2] {
    let [a, b, c] = line.factors;
    let off = (a * from[0] + b * from[1] + c) / (a * a + b * b);
    [from[0] - a * off, from[1] - b * off]
}

/// The sections of a plot over iterations: one for each level and each warp. `places` gives the iterations plotted, numbered from
/// 1, with level and warp of each, from 0; the first of every section is among them. A single level or warp has no section.
pub fn sections(
    places: impl Iterator<Item = (usize, (usize, usize))>,
    (levels, warps): (usize, usize),
) -> impl Iterator<Item = Section> {
    let begins = move |before: &mut Option<(usize, usize)>, (number, place): (usize, (usize, usize))| {
        let (level, warp) = place;
        let is_level = levels > 1 && before.is_none_or(|(before, _)| before != level);
        let is_warp = warps > 1 && *before != Some(place);
        *before = Some(place);
        Some((is_level || is_warp).then(|| {
            let label = if is_level { format!("level {level}") } else { format!("warp {}", warp + 1) };
            Section { from: number as f32 - 0.5, label, is_part: !is_level && levels > 1 }
        }))
    };
    places.scan(None, begins).flatten()
}

impl Derivatives {
    /// Returns I_x, I_y and I_t of a pixel.
    pub fn at(&self, place: (usize, usize)) -> [f32; 3] {
        [self.x[place], self.y[place], self.t[place]]
    }

    /// Puts the derivatives of a pixel.
    pub fn put(&self, step: Step, place: (usize, usize)) -> Step {
        put_derivatives(step, place, self.at(place))
    }

    /// Returns patches of both frames and their derivatives within `radius` px of a pixel.
    pub fn tiles(&self, pictures: [&Grid<f32>; 2], place: (usize, usize), radius: usize) -> Vec<Tile> {
        let [current, next] = pictures.map(|picture| around(picture, place, radius));
        let parts = [&self.x, &self.y, &self.t].map(|part| around(part, place, radius));
        derivative_tiles([("Frame t", current), ("Frame t+1", next)], parts)
    }
}

impl Linear {
    /// Puts the derivatives of a pixel.
    pub fn put(&self, step: Step, place: (usize, usize)) -> Step {
        put_derivatives(step, place, self.derivatives(place))
    }

    /// Returns patches of frame t, the warped frame t + 1 and their derivatives within `radius` px of a pixel.
    pub fn tiles(&self, [current, next]: [&Grid<f32>; 2], place: (usize, usize), radius: usize) -> Vec<Tile> {
        let back = |(x, y): (usize, usize)| {
            let [u, v] = self.start.at(x, y);
            Sampling::Bicubic.sample_inside(next, x as f32 + u, y as f32 + v)
        };
        let part = |i: usize| around_with(next.size(), place, radius, |place| self.derivatives(place)[i]);
        let label = if self.start.is_zero() { "Frame t+1" } else { "Warped t+1" };
        let pictures =
            [("Frame t", around(current, place, radius)), (label, around_with(next.size(), place, radius, back))];
        derivative_tiles(pictures, [0, 1, 2].map(part))
    }

    /// Writes c, which replaces I_t after warping, in symbols and with the numbers of a pixel; displacements have `unit`.
    pub fn define(&self, step: Step, place: (usize, usize), unit: Unit) -> Step {
        let (all, start) = (self.derivatives(place), self.start.at(place.0, place.1));
        let (step, few) = (step.formula("c = I_t - I_x u_0 - I_y v_0"), decimals(all));
        if !self.factors.is_known(place) {
            return step.formula(r"\text{unknown: (u₀, v₀) leads out of frame t+1}");
        }
        let constant = |c: f64| value::CONSTANT_TERM.is(c).in_unit(Unit::new(value::I_T.unit.name, few as u8));
        let written = |further: usize| {
            let [x, y, t] = all.map(|of| words::rounded(of.into(), few + further));
            let [u, v] = start.map(|of| words::rounded(of.into(), PX_DECIMALS + further));
            constant(t - x * u - y * v).bare()
        };
        let c = constant(self.factors.at(place)[2].into());
        let further = words::further_digits(|further| written(*further) == c.bare());
        let step = put_parts(step, all, few + further).put_value(c);
        let step = step.put_value(value::START.is(start).in_unit(unit.finer(further as u8)));
        step.formula(r"= {i_t} - {i_x} \cdot {start:1} - {i_y} \cdot {start:2} = {constant_term}")
    }
}

/// Puts pixel and derivatives, which are NaN where they are unknown.
fn put_derivatives(step: Step, place: (usize, usize), all: [f32; 3]) -> Step {
    let step = step.fact(value::PIXEL, place);
    if all.iter().any(|d| !d.is_finite()) {
        return step.fact(value::DERIVATIVES, "unknown: the flow leads out of frame t+1");
    }
    put_parts(step.fact(value::DERIVATIVES, all), all, decimals(all))
}

/// Puts I_x, I_y and I_t one by one.
fn put_parts(step: Step, all: [f32; 3], decimals: usize) -> Step {
    [value::I_X, value::I_Y, value::I_T].into_iter().zip(all).fold(step, |step, (of, derivative)| {
        step.put_value(of.is(derivative).in_unit(Unit::new(of.unit.name, decimals as u8)))
    })
}

fn derivative_tiles(pictures: [(&'static str, Grid<f32>); 2], [x, y, t]: [Grid<f32>; 3]) -> Vec<Tile> {
    let [(first, current), (second, next)] = pictures;
    vec![
        Tile::gray(first, current).with_role(Role::Reference),
        Tile::gray(second, next).with_role(Role::Candidate),
        Tile::signed("I_x", x),
        Tile::signed("I_y", y),
        Tile::signed("I_t", t),
    ]
}

/// The values of `grid` around a place, rounded to a tenth; NaN outside the grid.
pub fn around<T: Copy + Into<f32>>(grid: &Grid<T>, place: (usize, usize), radius: usize) -> Grid<f32> {
    around_with(grid.size(), place, radius, |place| grid[place].into())
}

/// The values of `of` around a place of a grid of this size, rounded to a tenth; NaN outside the grid.
pub fn around_with(
    (width, height): (usize, usize),
    (x, y): (usize, usize),
    radius: usize,
    of: impl Fn((usize, usize)) -> f32,
) -> Grid<f32> {
    let side = 2 * radius + 1;
    let inside = |i: usize, k: usize, extent: usize| (i + k).checked_sub(radius).filter(|i| *i < extent);
    Grid::from_fn(side, side, |i, j| {
        let value = inside(x, i, width).zip(inside(y, j, height)).map_or(f32::NAN, &of);
        (value * 10.0).round() / 10.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_and_warps_begin_where_they_do() {
        let begins = |places: &[(usize, usize)], of| -> Vec<_> {
            sections((1..).zip(places.iter().copied()), of).map(|s| (s.from, s.label, s.is_part)).collect()
        };
        let run = [(1, 0), (1, 0), (1, 1), (0, 0), (0, 0), (0, 1)];
        let section = |from, label: &str, is_part| (from, label.to_owned(), is_part);
        let level = |from, label| section(from, label, false);
        let all =
            [level(0.5, "level 1"), section(2.5, "warp 2", true), level(3.5, "level 0"), section(5.5, "warp 2", true)];
        assert_eq!(begins(&run, (2, 2)), all);
        assert_eq!(begins(&run[..2], (2, 1)), [level(0.5, "level 1")]);
        assert_eq!(begins(&run[3..], (1, 2)), [level(0.5, "warp 1"), level(2.5, "warp 2")]);
        assert_eq!(begins(&run[3..5], (1, 1)), []);
    }

    #[test]
    fn the_plane_holds_its_points() {
        assert_eq!(reach([[0.1, -0.2]]), 1.0);
        assert_eq!(reach([[3.0, 0.0], [f32::NAN, 99.0]]), 128.0);
        assert!(reach([[1e9, 0.0]]).is_finite());
    }

    #[test]
    fn the_view_is_that_of_displacements_close_together_and_of_a_line_near_them() {
        let points = [[-1.524, -0.826], [-1.508, -0.875], [-1.519, f32::NAN]];
        let holds = |view: View, [u, v]: [f32; 2]| {
            (u - view.center[0]).abs() < view.reach && (v - view.center[1]).abs() < view.reach
        };
        let near = View::around(&points, &[]);
        assert_eq!(near.reach, 0.1);
        assert!(points[..2].iter().all(|point| holds(near, *point)), "{near:?}");
        let line_at = |u: f32| Constraint { factors: [2.0, 0.0, -2.0 * u], weight: 1.0, role: Role::Candidate };
        let with_line = View::around(&points, &[line_at(-1.3)]);
        assert!(holds(with_line, foot(&line_at(-1.3), with_line.center)) && with_line.reach <= 0.4, "{with_line:?}");
        assert_eq!(View::around(&points, &[line_at(8.0)]), near, "a line far away is left out");
        assert_eq!(foot(&line_at(8.0), [1.0, -3.0]), [8.0, -3.0]);
        assert!(View::around(&[[1e9, 0.0], [0.0; 2]], &[]).reach.is_finite());
        assert_eq!(View::around(&[], &[]), View { center: [0.0; 2], reach: 0.1 });
    }
}
