//! The explanation and the drawing of an iteration of Farnebäck's method at one pixel.

use super::shift::in_effect;
use super::vocabulary::{case, value};
use super::{DisplacementEquation, ExpansionPair, Polynomial, WindowSolver};
use crate::geometry::Grid;
use crate::methods::differential::explain::{self, View, value as differential};
use crate::methods::differential::{Field, Multiscale, Tensor, unit_of};
use crate::scene::{Constraint, Picture, Plane, Readout, Role, Scene, Shape, Step, Tile, Value, Variable};

/// The steps of an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Polynomial expansion of both frames, before the first iteration of a level.
    Expanded,
    /// Each pixel is paired with the polynomial of frame t + 1 at its prior displacement.
    Paired,
    /// The displacement equation of each pixel.
    Compared,
    /// The windowed means of the normal equations.
    Averaged,
    /// The solution of each window.
    Solved,
}

impl Part {
    /// Returns the steps of an iteration; the first of a level begins with the expansion.
    pub fn of_iteration(is_first: bool) -> &'static [Self] {
        const ALL: [Part; 5] = [Part::Expanded, Part::Paired, Part::Compared, Part::Averaged, Part::Solved];
        if is_first { &ALL } else { &ALL[1..] }
    }
}

/// An iteration at one pixel of a level.
pub struct Probe<'a> {
    /// The current step.
    pub part: Part,
    frames: &'a Multiscale,
    /// The level.
    pub level: usize,
    expansions: ExpansionPair<'a>,
    /// The displacements after the iteration.
    to: &'a Field,
    /// The pixel.
    place: (usize, usize),
    solver: WindowSolver,
    /// The radius of the neighbourhoods, in px.
    reach: usize,
    /// The displacement equation and the partner pixel in frame t + 1; `None` outside.
    shift: Option<(DisplacementEquation, (usize, usize))>,
    /// The normal equations of the window.
    tensor: Tensor,
}

/// The inspected part of an iteration.
pub struct Inspected<'a> {
    /// The polynomial expansions and the prior displacements.
    pub expansions: ExpansionPair<'a>,
    /// The displacements after the iteration.
    pub to: &'a Field,
    /// The pixel.
    pub place: (usize, usize),
}

impl<'a> Probe<'a> {
    /// Inspects a pixel in an iteration on a level of `frames`, with neighbourhoods of radius `reach` px.
    pub fn new(
        part: Part,
        (frames, level): (&'a Multiscale, usize),
        Inspected { expansions, to, place }: Inspected<'a>,
        solver: WindowSolver,
        reach: usize,
    ) -> Self {
        let (shift, tensor) = (expansions.shift(place), expansions.tensor(place, &solver.window));
        Self { part, frames, level, expansions, to, place, solver, reach, shift, tensor }
    }

    /// Returns the prior displacement, in px of the level.
    fn from(&self) -> [f32; 2] {
        self.expansions.from.at(self.place.0, self.place.1)
    }

    /// Returns the displacement after the iteration, in px of the level.
    fn to(&self) -> [f32; 2] {
        self.to.at(self.place.0, self.place.1)
    }

    /// Returns the polynomial of frame t.
    fn first(&self) -> Polynomial {
        self.expansions.pair[0][self.place].into()
    }

    /// Returns the pixel of frame t + 1 at the prior displacement, with its polynomial.
    fn second(&self) -> Option<((usize, usize), Polynomial)> {
        self.shift.map(|(_, to)| (to, self.expansions.pair[1][to].into()))
    }
}

impl Probe<'_> {
    /// Draws the pixel, its neighbourhood in both frames, and the window.
    pub fn draw(&self, scene: &mut Scene) {
        let mut square = |on, role, (x, y): (usize, usize), reach: usize, meaning| {
            let reach = reach as f32;
            let [min, max] = [[x as f32 - reach, y as f32 - reach], [x as f32 + reach + 1.0, y as f32 + reach + 1.0]];
            let [min, max] = self.frames.on_picture(self.level, min, max);
            scene.draw(on, (role, meaning), Shape::Rect { min, max });
        };
        if self.part >= Part::Averaged {
            square(Picture::CURRENT, Role::Window, self.place, self.solver.window.reach(), "window");
        } else {
            square(Picture::CURRENT, Role::Best, self.place, self.reach, "neighbourhood of the expansion");
            if let Some((_, to)) = self.shift {
                square(Picture::NEXT, Role::Candidate, to, self.reach, "neighbourhood at the prior displacement");
            }
        }
        square(Picture::CURRENT, Role::Reference, self.place, 0, "inspected pixel");
    }

    /// Returns the value of a displacement in px of the level.
    fn px(&self, of: &'static Variable, uv: [f32; 2]) -> Value {
        of.is(uv).in_unit(unit_of(self.level))
    }

    /// Explains the step.
    pub fn tell(&self, step: Step) -> Step {
        let (from, to) = (self.from(), self.to());
        let step = self.put(step.fact(differential::PIXEL, self.place).fact_of(self.px(value::PRIOR, from)));
        let step = match self.part {
            Part::Expanded => self.fits(step.say(case::EXPANDED)),
            Part::Paired => {
                let step = step.say(case::PRIOR).say(if self.shift.is_some() { case::PAIRED } else { case::OUTSIDE });
                self.fits(step)
            }
            Part::Compared => self.tell_equations(step),
            Part::Averaged => {
                let [large, small] = self.tensor.eigenvalues();
                let step = step.put(value::LAMBDA_1, large).put(value::LAMBDA_2, small);
                let step = step.put(value::DAMPING, self.solver.damping).say(case::AVERAGED);
                let is_determined = small > self.solver.damping;
                self.normal_equations(step.say(if is_determined { case::DETERMINED } else { case::DAMPED }))
            }
            Part::Solved => {
                let step = step.fact_of(self.px(value::DISPLACEMENT, to)).fact(value::RESIDUAL, self.off());
                let step = step.put_value(self.px(value::INCREMENT, [0, 1].map(|i| to[i] - from[i]))).say(case::SOLVED);
                self.normal_equations(step).formula(r"\mathbf{d} = {displacement}")
            }
        };
        let step = match self.truth() {
            Some(truth) => step.fact_of(self.px(value::TRUE_DISPLACEMENT, truth)),
            None => step,
        };
        let is_expansion = self.part < Part::Compared;
        step.show(if is_expansion { Readout::Tiles(self.tiles()) } else { Readout::Plane(self.plane()) })
    }

    /// Puts the polynomials of both frames.
    fn put(&self, step: Step) -> Step {
        let all = |Polynomial { c, b: [x, y], a: [xx, xy, yy] }| [c, x, y, xx, 2.0 * xy, yy];
        let step = step.put(value::B_1, self.first().b).put(value::FIT_1, all(self.first()));
        let Some(((x, y), second)) = self.second() else { return step };
        let whole = [x as f32 - self.place.0 as f32, y as f32 - self.place.1 as f32];
        step.put(value::ROUNDED_PRIOR, whole).put(value::B_2, second.b).put(value::FIT_2, all(second))
    }

    /// Writes the polynomials in symbols and numbers.
    fn fits(&self, step: Step) -> Step {
        let step = step.formula("c + b_x x + b_y y + a_{xx} x^2 + 2 a_{xy} x y + a_{yy} y^2");
        FITS.iter().take(if self.shift.is_some() { 2 } else { 1 }).fold(step, Step::formula)
    }

    /// Explains the displacement equations of the pixel.
    fn tell_equations(&self, step: Step) -> Step {
        let step = step.formula(
            r"\mathbf{A} \mathbf{d} = \Delta \mathbf{b} = \mathbf{A} (m, n) - \text{½ }(\mathbf{b}_2 - \mathbf{b}_1)",
        );
        let Some((DisplacementEquation { a, b }, _)) = self.shift else { return step.say(case::NO_EQUATION) };
        step.put(value::A, a)
            .put(value::DELTA_B, b)
            .say(case::COMPARED)
            .formula(r"\Delta \mathbf{b} = \mathbf{A} {rounded_prior} - \text{½ }({b_2} - {b_1}) = {delta_b}")
            .formula("{a:1} u {a:2:signed} v = {delta_b:1}")
            .formula("{a:2} u {a:3:signed} v = {delta_b:2}")
    }

    /// Returns the RMS residual of the window's displacement equations, in gray levels per px.
    fn off(&self) -> f32 {
        (self.tensor.residual(self.to()) / self.tensor.pixels.max(f32::MIN_POSITIVE)).sqrt()
    }

    /// Returns the true displacement, in px of the level, if it is known.
    fn truth(&self) -> Option<[f32; 2]> {
        self.frames.truth(self.level, self.place)
    }

    /// Returns the neighbourhood in both frames, its polynomial, and the residual.
    fn tiles(&self) -> Vec<Tile> {
        let reach = self.reach;
        let of = |picture: &Grid<f32>, place, polynomial: Polynomial| {
            let pixels = explain::around(picture, place, reach);
            let fitted = Grid::from_fn(pixels.width(), pixels.height(), |i, j| {
                let value = polynomial.at([i as f32 - reach as f32, j as f32 - reach as f32]);
                if pixels[(i, j)].is_finite() { (value * 10.0).round() / 10.0 } else { f32::NAN }
            });
            let left = Grid::from_fn(pixels.width(), pixels.height(), |i, j| pixels[(i, j)] - fitted[(i, j)]);
            [pixels, fitted, left]
        };
        let row = |role, [pixels, fitted, left]: [Grid<f32>; 3], name| {
            let pictures = [(name, pixels), ("Polynomial", fitted)];
            let [picture, polynomial] = pictures.map(|(label, values)| Tile::gray(label, values).with_role(role));
            [picture, polynomial, Tile::signed("Residual", left)]
        };
        let [current, next] = self.frames.pair(self.level);
        let mut tiles = row(Role::Reference, of(current, self.place, self.first()), "Frame t").to_vec();
        if let Some((to, polynomial)) = self.second() {
            tiles.extend(row(Role::Candidate, of(next, to, polynomial), "Frame t+1"));
        }
        tiles
    }

    /// Returns the (u, v) plane with the equations of the pixel or of the window.
    fn plane(&self) -> Plane {
        let mut points = vec![("prior", Role::Best, self.from())];
        if self.part == Part::Solved {
            points.push(("displacement", Role::Result, self.to()));
        }
        let truth = self.truth();
        points.extend(truth.map(|truth| ("true flow", Role::Truth, truth)));
        let of_pixel = || {
            let lines = self.shift.into_iter().flat_map(|(shift, _)| shift.lines());
            lines.filter_map(|line| explain::line(line, 1.0, Role::Candidate)).collect()
        };
        let is_pixel = self.part == Part::Compared;
        let lines = if is_pixel { of_pixel() } else { self.window_lines() };
        let shown: Vec<_> = points.iter().map(|(.., point)| *point).collect();
        let View { center, reach } = View::around(&shown, &lines);
        Plane {
            title: if is_pixel {
                "Displacement equations of the pixel: A d = Δb"
            } else {
                "Displacement equations of the window: A d = Δb"
            },
            unit: unit_of(self.level).name.into(),
            reach,
            center,
            cost: None,
            path: Vec::new(),
            groups: Vec::new(),
            lines,
            points,
            ellipse: None,
        }
    }

    /// Returns the lines of the window's pixels by their weights; a subset for large windows.
    fn window_lines(&self) -> Vec<Constraint> {
        let (window, size) = (&self.solver.window, self.frames.size(self.level));
        let step = (2 * window.reach() + 1) / 7 + 1;
        let (left, across) = window.inside(self.place.0, size.0);
        let (top, down) = window.inside(self.place.1, size.1);
        let columns = (left..).zip(across).step_by(step);
        let pixels = (top..).zip(down).step_by(step).flat_map(|row| columns.clone().map(move |column| (column, row)));
        let lines = pixels.filter_map(|((x, across), (y, down))| {
            let (shift, _) = self.expansions.shift((x, y))?;
            Some(shift.lines().map(|line| (line, across * down * line[0].hypot(line[1]))))
        });
        let lines: Vec<_> = lines.flatten().collect();
        let most = lines.iter().fold(f32::MIN_POSITIVE, |most, (_, weight)| most.max(*weight));
        lines.into_iter().filter_map(|(line, weight)| explain::line(line, weight / most, Role::Candidate)).collect()
    }

    /// Writes (T + λ I) d = h + λ d₀ in symbols, and with the means over the window.
    fn normal_equations(&self, step: Step) -> Step {
        let Tensor { xx, xy, yy, xt, yt, .. } = self.tensor;
        let (damping, [u, v]) = (in_effect(self.solver.damping, [xx, yy]), self.from());
        step.put(value::NORMAL_MATRIX, [xx + damping, xy, yy + damping])
            .put(value::RIGHT_SIDE, [damping * u - xt, damping * v - yt])
            .formula(NORMAL_EQUATIONS)
            .formula("{normal_matrix:1} u {normal_matrix:2:signed} v = {right_side:1}")
            .formula("{normal_matrix:2} u {normal_matrix:3:signed} v = {right_side:2}")
    }
}

/// The polynomials of both frames in numbers.
const FITS: [&str; 2] = [
    r"\text{t: }{fit_1:1} {fit_1:2:signed} x {fit_1:3:signed} y {fit_1:4:signed} x^2 {fit_1:5:signed} x y {fit_1:6:signed} y^2",
    r"\text{t+1: }{fit_2:1} {fit_2:2:signed} x {fit_2:3:signed} y {fit_2:4:signed} x^2 {fit_2:5:signed} x y {fit_2:6:signed} y^2",
];

/// The normal equations of a window, with the damping.
const NORMAL_EQUATIONS: &str = r"(\sum w \mathbf{A}^\top \mathbf{A} + \lambda \mathbf{I}) \mathbf{d} = \sum w \mathbf{A}^\top \Delta \mathbf{b} + \lambda \mathbf{d}_0";
