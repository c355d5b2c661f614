//! The explanation and the drawing of an iteration of Farnebäck's method at one pixel.

use super::shift::in_effect;
use super::{DisplacementEquation, ExpansionPair, Polynomial, WindowSolver};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::differential::explain::{self, View};
use crate::methods::differential::{Field, Multiscale, Tensor, numbers};
use crate::scene::{Constraint, Math, Picture, Plane, Readout, Role, Scene, Sentence, Shape, Tile};

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
    pub place: (usize, usize),
    solver: WindowSolver,
    /// The radius of the neighbourhoods, in px.
    reach: usize,
    /// The displacement equation and the partner pixel in frame t + 1; `None` outside.
    shift: Option<(DisplacementEquation, (usize, usize))>,
    /// The normal equations of the window.
    tensor: Tensor,
}

/// What is inspected of an iteration.
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
    pub fn from(&self) -> [f32; 2] {
        self.expansions.from.at(self.place.0, self.place.1)
    }

    /// Returns the displacement after the iteration, in px of the level.
    pub fn to(&self) -> [f32; 2] {
        self.to.at(self.place.0, self.place.1)
    }

    fn pixel(&self) -> String {
        format!("pixel {}", words::pixel(self.place))
    }

    /// Returns the prior displacement, rounded to whole px.
    fn whole(&self) -> Option<[f32; 2]> {
        let (_, to) = self.shift?;
        Some([to.0 as f32 - self.place.0 as f32, to.1 as f32 - self.place.1 as f32])
    }

    /// Returns the polynomials of frame t and of frame t + 1 at the prior displacement.
    fn polynomials(&self) -> (Polynomial, Option<Polynomial>) {
        let [first, second] = self.expansions.pair;
        (first[self.place].into(), self.shift.map(|(_, to)| second[to].into()))
    }
}

impl Probe<'_> {
    /// Draws the pixel, its neighbourhood in both frames, and the window.
    pub fn draw(&self, scene: &mut Scene) {
        let mut square = |on, role, (x, y): (usize, usize), reach: usize, meaning| {
            let reach = reach as f32;
            let [min, max] = [[x as f32 - reach, y as f32 - reach], [x as f32 + reach + 1.0, y as f32 + reach + 1.0]];
            let [min, max] = self.frames.on_picture(self.level, min, max);
            scene.mark(on, role, Shape::Rect { min, max });
            scene.legend(role, meaning);
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

    /// Returns the unit of displacements on the level.
    pub fn unit(&self) -> String {
        if self.level == 0 { "px".into() } else { format!("px of level {}", self.level) }
    }

    /// Explains the step in words.
    pub fn sentence(&self) -> Sentence {
        let (said, pixel) = (Sentence::default(), self.pixel());
        let px = |uv: [f32; 2]| format!("{} {}", numbers::vector(uv), self.unit());
        match self.part {
            Part::Expanded => {
                let (width, height) = self.frames.size(self.level);
                let (polynomial, _) = self.polynomials();
                said.text(format!(
                    "Level {} ({width}×{height} px): polynomial expansion fits x · A x + b · x + c to the Gaussian-weighted \
                     neighbourhood of every pixel in both frames. At ",
                    self.level
                ))
                .ink(Role::Reference, pixel)
                .text(format!(" the gradient is b₁ = {} gray levels per px.", gray_vector(polynomial.b)))
            }
            Part::Paired => {
                let said = said
                    .text("Prior displacement of ")
                    .ink(Role::Reference, pixel)
                    .text(": ")
                    .ink(Role::Best, px(self.from()));
                said.text(match self.whole() {
                    Some([m, n]) => format!(
                        ". Rounded to whole px, it selects the polynomial ({}, {}) px away in frame t+1.",
                        numbers::fixed(m, 0),
                        numbers::fixed(n, 0)
                    ),
                    None => ". It leads out of frame t+1, so there is no second polynomial.".into(),
                })
            }
            Part::Compared => match self.shift {
                Some((shift, _)) => said
                    .text("A shift by d changes the gradient from b₁ to b₂ = b₁ − 2 A d. At ")
                    .ink(Role::Reference, pixel)
                    .text(format!(" this gives the two equations A d = Δb = {}.", gray_vector(shift.b))),
                None => said
                    .text("Without a second polynomial, ")
                    .ink(Role::Reference, pixel)
                    .text(" has no displacement equation and does not enter any window."),
            },
            Part::Averaged => {
                let [large, small] = self.tensor.eigenvalues();
                let damping = self.solver.damping;
                let verdict = match small > damping {
                    true => "so the window determines both components",
                    false => "so the damping keeps the weakly determined component at its prior value",
                };
                said.text(
                    "Where the image curves in one direction only, A is singular. Mean of A^TA over the window of ",
                )
                .ink(Role::Reference, pixel)
                .text(format!(
                    ": eigenvalues {} and {} against the damping λ = {}, {verdict}.",
                    numbers::fixed(large, 4),
                    numbers::fixed(small, 4),
                    numbers::fixed(damping, 4)
                ))
            }
            Part::Solved => said
                .text("Damped least squares over the window of ")
                .ink(Role::Reference, pixel)
                .text(" gives (u, v) = ")
                .ink(Role::Result, px(self.to()))
                .text(format!(
                    ", an increment of {}. RMS residual of A d − Δb: {} gray levels per px.",
                    px([0, 1].map(|i| self.to()[i] - self.from()[i])),
                    numbers::gray(self.off())
                )),
        }
    }

    /// Explains the step by formulas and charts.
    pub fn readouts(&self) -> Vec<Readout> {
        let (equation, picture) = match self.part {
            Part::Expanded | Part::Paired => (expansion_equation(self), Readout::Tiles(self.tiles())),
            Part::Compared => (shift_equation(self), Readout::Plane(self.plane())),
            Part::Averaged | Part::Solved => (self.mean_equation(), Readout::Plane(self.plane())),
        };
        vec![Readout::Equation(equation), picture]
    }

    /// Returns the RMS residual of the window's displacement equations, in gray levels per px.
    pub fn off(&self) -> f32 {
        (self.tensor.residual(self.to()) / self.tensor.pixels.max(f32::MIN_POSITIVE)).sqrt()
    }

    /// Returns the true displacement, in px of the level, if it is known.
    pub fn truth(&self) -> Option<[f32; 2]> {
        self.frames.truth(self.level, self.place)
    }

    /// Returns the neighbourhood in both frames, its polynomial, and the residual.
    fn tiles(&self) -> Vec<Tile> {
        let reach = self.reach;
        let (first, second) = self.polynomials();
        let of = |picture: &Grid<f32>, place, polynomial: Polynomial| {
            let pixels = explain::around(picture, place, reach);
            let fitted = Grid::from_fn(pixels.width(), pixels.height(), |i, j| {
                let value = polynomial.at([i as f32 - reach as f32, j as f32 - reach as f32]);
                if pixels[(i, j)].is_finite() { (value * 10.0).round() / 10.0 } else { f32::NAN }
            });
            let left = Grid::from_fn(pixels.width(), pixels.height(), |i, j| pixels[(i, j)] - fitted[(i, j)]);
            [pixels, fitted, left]
        };
        let tile = |label, role, values: Grid<f32>| {
            let most = values.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
            Tile {
                label,
                role,
                values,
                range: if label == "Residual" { [-most, most] } else { [0.0, 255.0] },
                framed: Vec::new(),
            }
        };
        let row = |role, [pixels, fitted, left]: [Grid<f32>; 3], name| {
            [tile(name, Some(role), pixels), tile("Polynomial", Some(role), fitted), tile("Residual", None, left)]
        };
        let [current, next] = self.frames.pair(self.level);
        let mut tiles = row(Role::Reference, of(current, self.place, first), "Frame t").to_vec();
        if let (Some(polynomial), Some((_, to))) = (second, self.shift) {
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
            unit: self.unit(),
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

    /// Returns (T + λ I) d = h + λ d₀ in symbols, and with the means over the window.
    fn mean_equation(&self) -> Vec<Math> {
        let Tensor { xx, xy, yy, xt, yt, .. } = self.tensor;
        let (from, to) = (self.from(), self.to());
        let lambda = || Math::Var("λ");
        let transposed = |right: Math| {
            Math::Row(vec![
                Math::text("Σ "),
                Math::Var("w"),
                Math::text(" "),
                Math::power(Math::Bold("A"), Math::text("T")),
                right,
            ])
        };
        let delta_b = || Math::Row(vec![Math::text("Δ"), Math::Bold("b")]);
        let symbols = Math::Row(vec![
            Math::text("("),
            transposed(Math::Bold("A")),
            Math::text(" + "),
            lambda(),
            Math::Bold("I"),
            Math::text(") "),
            Math::Bold("d"),
            Math::text(" = "),
            transposed(delta_b()),
            Math::text(" + "),
            lambda(),
            Math::text(" "),
            Math::indexed(Math::Bold("d"), Math::text("0")),
        ]);
        let damping = in_effect(self.solver.damping, [xx, yy]);
        let row = |[a, b]: [f32; 2], right: f32| {
            linear_row([a, b].map(coefficient), Math::ink(Role::Candidate, coefficient(right)))
        };
        let mut lines = vec![
            symbols,
            row([xx + damping, xy], damping * from[0] - xt),
            row([xy, yy + damping], damping * from[1] - yt),
        ];
        if self.part == Part::Solved {
            lines.push(Math::Row(vec![
                Math::Bold("d"),
                Math::text(" = "),
                Math::ink(Role::Result, numbers::vector(to)),
            ]));
        }
        lines
    }
}

/// A coefficient of the normal equations.
fn coefficient(value: f32) -> String {
    numbers::fixed(value, 4)
}

/// A vector of gray levels per px.
fn gray_vector([x, y]: [f32; 2]) -> String {
    format!("({},\u{a0}{})", numbers::gray(x), numbers::gray(y))
}

/// `a u + b v = right`.
fn linear_row([a, b]: [String; 2], right: Math) -> Math {
    let b = b.strip_prefix('−').map_or_else(|| format!(" + {b}"), |size| format!(" − {size}"));
    Math::Row(vec![
        Math::ink(Role::Reference, a),
        Math::text(" "),
        Math::Var("u"),
        Math::ink(Role::Reference, b),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" = "),
        right,
    ])
}

/// The polynomial in symbols, and the polynomials of both frames in numbers.
fn expansion_equation(probe: &Probe) -> Vec<Math> {
    let index = |of: &'static str, by: &'static str| Math::indexed(Math::Var(of), Math::Var(by));
    let term = |before: &'static str, factor: Math, after: &[(&'static str, bool)]| {
        let mut row = vec![Math::text(before), factor];
        for (name, is_square) in after {
            row.push(Math::text(" "));
            row.push(if *is_square { Math::power(Math::Var(name), Math::text("2")) } else { Math::Var(name) });
        }
        Math::Row(row)
    };
    let polynomial = |c: Math, b: [Math; 2], a: [Math; 3], signs: [&'static str; 5]| {
        let ([bx, by], [xx, xy, yy]) = (b, a);
        Math::Row(vec![
            c,
            term(signs[0], bx, &[("x", false)]),
            term(signs[1], by, &[("y", false)]),
            term(signs[2], xx, &[("x", true)]),
            term(signs[3], xy, &[("x", false), ("y", false)]),
            term(signs[4], yy, &[("y", true)]),
        ])
    };
    let symbols = polynomial(
        Math::Var("c"),
        [index("b", "x"), index("b", "y")],
        [index("a", "xx"), index("a", "xy"), index("a", "yy")],
        [" + ", " + ", " + ", " + 2 ", " + "],
    );
    let numbers = |Polynomial { c, b, a }: Polynomial, role, name: &'static str| {
        let ink = |v: f32| Math::ink(role, numbers::summand(numbers::gray(v)));
        let [xx, xy, yy] = a;
        let first = Math::ink(role, numbers::gray(c));
        let row = polynomial(first, b.map(ink), [ink(xx), ink(2.0 * xy), ink(yy)], [" "; 5]);
        Math::Row(vec![Math::text(name), row])
    };
    let (first, second) = probe.polynomials();
    let mut lines = vec![symbols, numbers(first, Role::Reference, "t: ")];
    lines.extend(second.map(|second| numbers(second, Role::Candidate, "t+1: ")));
    lines
}

/// Δb in symbols and in numbers, and the two displacement equations.
fn shift_equation(probe: &Probe) -> Vec<Math> {
    let index = |of: &'static str, by: &'static str| Math::indexed(Math::Bold(of), Math::text(by));
    let symbols = Math::Row(vec![
        Math::Bold("A"),
        Math::text(" "),
        Math::Bold("d"),
        Math::text(" = Δ"),
        Math::Bold("b"),
        Math::text(" = "),
        Math::Bold("A"),
        Math::text(" ("),
        Math::Var("m"),
        Math::text(", "),
        Math::Var("n"),
        Math::text(") − ½ ("),
        index("b", "2"),
        Math::text(" − "),
        index("b", "1"),
        Math::text(")"),
    ]);
    let (Some((shift, _)), (first, Some(second)), Some(whole)) = (probe.shift, probe.polynomials(), probe.whole())
    else {
        return vec![symbols];
    };
    let DisplacementEquation { a: [xx, xy, yy], b } = shift;
    let come_about = Math::Row(vec![
        Math::text("Δ"),
        Math::Bold("b"),
        Math::text(" = "),
        Math::Bold("A"),
        Math::text(format!(" ({}, {}) − ½ (", numbers::fixed(whole[0], 0), numbers::fixed(whole[1], 0))),
        Math::ink(Role::Candidate, gray_vector(second.b)),
        Math::text(" − "),
        Math::ink(Role::Reference, gray_vector(first.b)),
        Math::text(format!(") = {}", gray_vector(b))),
    ]);
    let row =
        |a: [f32; 2], right: f32| linear_row(a.map(numbers::gray), Math::ink(Role::Candidate, numbers::gray(right)));
    vec![symbols, come_about, row([xx, xy], b[0]), row([xy, yy], b[1])]
}
