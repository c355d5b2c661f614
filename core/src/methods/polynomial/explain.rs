//! How an iteration of Farnebäck's method is told and drawn at one pixel.

use super::shift::in_effect;
use super::{Agreement, Moved, Polynomial, Shift};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::differential::{Field, Multiscale, Tensor, explain};
use crate::scene::{Constraint, Math, Picture, Plane, Readout, Role, Scene, Sentence, Shape, Tile};

/// The parts of an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// All neighbourhoods of both frames have become polynomials: before the first iteration of a level.
    Expanded,
    /// Each pixel has the polynomial of frame t + 1 to which its displacement leads.
    Paired,
    /// Each pixel says what its two polynomials make of its displacement.
    Compared,
    /// The pixels of each window are put together.
    Averaged,
    /// Each pixel has the displacement on which its window agrees.
    Moved,
}

/// An iteration at one pixel of a level.
pub struct Looked<'a> {
    /// What of it has happened.
    pub part: Part,
    frames: &'a Multiscale,
    /// The level.
    pub level: usize,
    moved: Moved<'a>,
    /// The displacements after it.
    to: &'a Field,
    /// The pixel.
    pub place: (usize, usize),
    agreement: Agreement,
    /// How far neighbourhoods reach, in px.
    reach: usize,
    /// What the pixel says, and to which of frame t + 1 it goes; `None` where that is outside.
    shift: Option<(Shift, (usize, usize))>,
    /// What the window says.
    tensor: Tensor,
}

impl<'a> Looked<'a> {
    /// The iteration on a level of `frames` that found the displacements `to`, at `place`, with neighbourhoods that reach
    /// `reach` px.
    pub fn new(
        part: Part,
        (frames, level): (&'a Multiscale, usize),
        (moved, to, place): (Moved<'a>, &'a Field, (usize, usize)),
        agreement: Agreement,
        reach: usize,
    ) -> Self {
        let (shift, tensor) = (moved.shift(place), moved.tensor(place, &agreement.window));
        Self { part, frames, level, moved, to, place, agreement, reach, shift, tensor }
    }

    /// The displacement before, in px of the level.
    pub fn from(&self) -> [f32; 2] {
        self.moved.from.at(self.place.0, self.place.1)
    }

    /// The displacement after it, in px of the level.
    pub fn to(&self) -> [f32; 2] {
        self.to.at(self.place.0, self.place.1)
    }

    fn pixel(&self) -> String {
        format!("pixel ({}, {})", self.place.0, self.place.1)
    }

    /// The displacement in whole px, as far as the polynomials compared are apart.
    fn whole(&self) -> Option<[f32; 2]> {
        let (_, to) = self.shift?;
        Some([to.0 as f32 - self.place.0 as f32, to.1 as f32 - self.place.1 as f32])
    }

    /// The polynomials of frame t, and of frame t + 1 where the pixel goes.
    fn polynomials(&self) -> (Polynomial, Option<Polynomial>) {
        let [first, second] = self.moved.pair;
        (first[self.place].into(), self.shift.map(|(_, to)| second[to].into()))
    }
}

impl Looked<'_> {
    /// The pixel, its neighbourhood in both frames, and the window.
    pub fn draw(&self, scene: &mut Scene) {
        let mut square = |on, role, (x, y): (usize, usize), reach: usize, meaning| {
            let reach = reach as f32;
            let [min, max] = [[x as f32 - reach, y as f32 - reach], [x as f32 + reach + 1.0, y as f32 + reach + 1.0]];
            let [min, max] = self.frames.on_picture(self.level, min, max);
            scene.mark(on, role, Shape::Rect { min, max });
            scene.legend(role, meaning);
        };
        if self.part >= Part::Averaged {
            square(Picture::CURRENT, Role::Window, self.place, self.agreement.window.reach(), "window");
        } else {
            square(Picture::CURRENT, Role::Best, self.place, self.reach, "neighbourhood");
            if let Some((_, to)) = self.shift {
                square(Picture::NEXT, Role::Candidate, to, self.reach, "the one it is compared with");
            }
        }
        square(Picture::CURRENT, Role::Reference, self.place, 0, "pixel that is explained");
    }

    /// What displacements are told in.
    pub fn unit(&self) -> String {
        if self.level == 0 { "px".into() } else { format!("px of level {}", self.level) }
    }

    /// What has happened, in words.
    pub fn sentence(&self) -> Sentence {
        let (said, pixel) = (Sentence::default(), self.pixel());
        let px = |uv: [f32; 2]| format!("{} {}", words::vector(uv), self.unit());
        match self.part {
            Part::Expanded => {
                let (width, height) = self.frames.size(self.level);
                let (polynomial, _) = self.polynomials();
                said.text(format!(
                    "Level {} of the pyramid is {width}×{height} px large. All neighbourhoods of both frames become \
                     polynomials. That of ",
                    self.level
                ))
                .ink(Role::Reference, pixel)
                .text(format!(" has the gradient b₁ = {}.", words::vector(polynomial.b)))
            }
            Part::Paired => {
                let said = said
                    .text("By now ")
                    .ink(Role::Reference, pixel)
                    .text(" moves by ")
                    .ink(Role::Best, px(self.from()));
                said.text(match self.whole() {
                    Some(whole) => {
                        format!(", so it is compared with the polynomial {} whole px away.", words::vector(whole))
                    }
                    None => ". That leads out of the picture: there is no polynomial to compare it with.".into(),
                })
            }
            Part::Compared => match self.shift {
                Some((shift, _)) => said
                    .text("What b has changed by from one polynomial of ")
                    .ink(Role::Reference, pixel)
                    .text(format!(" to the other, and the way between them, say A d = {}.", words::vector(shift.b))),
                None => said
                    .text("There is no second polynomial for ")
                    .ink(Role::Reference, pixel)
                    .text(", so it says nothing."),
            },
            Part::Averaged => {
                let [large, small] = self.tensor.eigenvalues().map(words::number);
                let damping = words::number(self.agreement.damping);
                said.text("One pixel says too little where the picture bends one way only. Over the window around ")
                    .ink(Role::Reference, pixel)
                    .text(format!(" the eigenvalues of the mean of A A are {large} and {small}, beside λ = {damping}."))
            }
            Part::Moved => said
                .text("The window around ")
                .ink(Role::Reference, pixel)
                .text(" agrees best on ")
                .ink(Role::Result, px(self.to()))
                .text(format!(": {} from before.", px([0, 1].map(|i| self.to()[i] - self.from()[i])))),
        }
    }

    /// What has happened, in symbols and with the pixel's numbers.
    pub fn readouts(&self) -> Vec<Readout> {
        let (equation, picture) = match self.part {
            Part::Expanded | Part::Paired => (expansion_equation(self), Readout::Tiles(self.tiles())),
            Part::Compared => (shift_equation(self), Readout::Plane(self.plane())),
            Part::Averaged | Part::Moved => (self.mean_equation(), Readout::Plane(self.plane())),
        };
        vec![Readout::Equation(equation), picture]
    }

    /// How much the constraints of the window are off at the displacement found, in gray levels per px: the root mean square.
    pub fn off(&self) -> f32 {
        (self.tensor.residual(self.to()) / self.tensor.pixels.max(f32::MIN_POSITIVE)).sqrt()
    }

    /// The true displacement, in px of the level, if it is known.
    pub fn truth(&self) -> Option<[f32; 2]> {
        self.frames.truth(self.level, self.place)
    }

    /// The neighbourhood in both frames, its polynomial, and what that leaves.
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
            Tile { label, role, values, range: if label == "Residual" { [-most, most] } else { [0.0, 255.0] } }
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

    /// The lines of the pixel, or of the window, and where they lead.
    fn plane(&self) -> Plane {
        let mut points = vec![("before", Role::Best, self.from())];
        if self.part == Part::Moved {
            points.push(("displacement", Role::Result, self.to()));
        }
        let truth = self.truth();
        points.extend(truth.map(|truth| ("truth", Role::Truth, truth)));
        let of_pixel = || {
            let lines = self.shift.into_iter().flat_map(|(shift, _)| shift.lines());
            lines.filter_map(|line| explain::line(line, 1.0, Role::Candidate)).collect()
        };
        let is_pixel = self.part == Part::Compared;
        Plane {
            title: if is_pixel { "What the pixel says: A d = Δb" } else { "What the window says: A d = Δb" },
            unit: self.unit(),
            reach: explain::reach(points.iter().map(|(.., point)| *point)),
            lines: if is_pixel { of_pixel() } else { self.window_lines() },
            points,
            ellipse: None,
        }
    }

    /// The lines of the window's pixels, of a large one only of every few; the more one counts, the stronger.
    fn window_lines(&self) -> Vec<Constraint> {
        let (window, size) = (&self.agreement.window, self.frames.size(self.level));
        let step = (2 * window.reach() + 1) / 7 + 1;
        let (left, across) = window.inside(self.place.0, size.0);
        let (top, down) = window.inside(self.place.1, size.1);
        let columns = (left..).zip(across).step_by(step);
        let pixels = (top..).zip(down).step_by(step).flat_map(|row| columns.clone().map(move |column| (column, row)));
        let lines = pixels.filter_map(|((x, across), (y, down))| {
            let (shift, _) = self.moved.shift((x, y))?;
            Some(shift.lines().map(|line| (line, across * down * line[0].hypot(line[1]))))
        });
        let lines: Vec<_> = lines.flatten().collect();
        let most = lines.iter().fold(f32::MIN_POSITIVE, |most, (_, weight)| most.max(*weight));
        lines.into_iter().filter_map(|(line, weight)| explain::line(line, weight / most, Role::Candidate)).collect()
    }

    /// (T + λ I) d = h + λ d₀ in symbols, and with the means over the window.
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
        let damping = in_effect(self.agreement.damping, [xx, yy]);
        let row = |[a, b]: [f32; 2], right: f32| {
            linear_row([a, b].map(words::number), Math::ink(Role::Candidate, words::number(right)))
        };
        let mut lines = vec![
            symbols,
            row([xx + damping, xy], damping * from[0] - xt),
            row([xy, yy + damping], damping * from[1] - yt),
        ];
        if self.part == Part::Moved {
            lines.push(Math::Row(vec![Math::Bold("d"), Math::text(" = "), Math::ink(Role::Result, words::vector(to))]));
        }
        lines
    }
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

/// The polynomial in symbols, and those of both frames in numbers.
fn expansion_equation(looked: &Looked) -> Vec<Math> {
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
        let ink = |v: f32| Math::ink(role, words::plus(v));
        let [xx, xy, yy] = a;
        let first = Math::ink(role, words::number(c));
        let row = polynomial(first, b.map(ink), [ink(xx), ink(2.0 * xy), ink(yy)], [" "; 5]);
        Math::Row(vec![Math::text(name), row])
    };
    let (first, second) = looked.polynomials();
    let mut lines = vec![symbols, numbers(first, Role::Reference, "t: ")];
    lines.extend(second.map(|second| numbers(second, Role::Candidate, "t+1: ")));
    lines
}

/// How Δb comes about, in symbols and in numbers, and the two equations that it gives.
fn shift_equation(looked: &Looked) -> Vec<Math> {
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
    let (Some((shift, _)), (first, Some(second)), Some(whole)) = (looked.shift, looked.polynomials(), looked.whole())
    else {
        return vec![symbols];
    };
    let Shift { a: [xx, xy, yy], b } = shift;
    let come_about = Math::Row(vec![
        Math::text("Δ"),
        Math::Bold("b"),
        Math::text(" = "),
        Math::Bold("A"),
        Math::text(format!(" {} − ½ (", words::vector(whole))),
        Math::ink(Role::Candidate, words::vector(second.b)),
        Math::text(" − "),
        Math::ink(Role::Reference, words::vector(first.b)),
        Math::text(format!(") = {}", words::vector(b))),
    ]);
    let row =
        |a: [f32; 2], right: f32| linear_row(a.map(words::number), Math::ink(Role::Candidate, words::number(right)));
    vec![symbols, come_about, row([xx, xy], b[0]), row([xy, yy], b[1])]
}
