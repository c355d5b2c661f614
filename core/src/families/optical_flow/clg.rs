//! The combined local-global method: the smoothest field that the constraints around every pixel allow together.

use std::sync::OnceLock;

use crate::base::{Threads, words};
use crate::geometry::filter;
use crate::methods::{
    differential::{Field, Linear, explain, relax},
    variational::{Local, Looked, Model, MotionTensor, Settings, Solver, Told, Warp},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Constraint, Fact, Math, Name, Role, Sentence};
use crate::{params, pseudocode};

params! {
    /// The combined local-global method. The energy ∫∫ (w, 1) · T (w, 1) + α² (|∇u|² + |∇v|²), w = (u, v), is made as small as can
    /// be, where T is the motion tensor over a window: Lucas and Kanade's where α is 0, Horn and Schunck's where ρ is 0.
    pub struct Clg {
        /// Weight α of smoothness: the larger, the smoother the field; about the gradient, in gray levels per px, that counts as much.
        alpha: f32 = 8.0, 0.1..=1000.0;
        /// Standard deviation ρ of the Gaussian window over which constraints are taken together; 0 leaves each pixel to itself.
        rho: f32 = 1.0, 0.0..=10.0, "px";
        /// How the equations are solved.
        solver: Solver = Solver::Jacobi;
        /// How far SOR goes beyond Gauss and Seidel: 1 is theirs, from 2 on nothing converges.
        relaxation: f32 = 1.9, 1.0..=1.99;
        /// What all variational methods have.
        settings: Settings = Settings { iterations: 100, levels: 4, warps: 3, smoothing: 0.5, ..Settings::default() };
    }
}

/// The step of an iteration that is told first.
const AVERAGED: usize = 0;

/// What the iterations of a warp need.
pub struct System {
    solutions: Local,
    /// The tensors, for whoever looks.
    tensor: OnceLock<MotionTensor>,
}

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ (w, 1) · T (w, 1) + α² (|∇u|² + |∇v|²), where w = (u, v)",
    EACH_LEVEL: "(u, v) ← 0; for each level, from the coarsest to the picture itself",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← medians of 3×3 px of (u, v), but for the first warp of all",
    WARP: "    bring frame t+1 back along (u₀, v₀), take I_x, I_y, I_t; T ← Gaussian of ρ px over their products",
    EACH_ITERATION: "    for each iteration",
    AVERAGE: "      (u_m, v_m) ← mean of the neighbours, for each pixel",
    SOLVE: "      (u, v) ← solution of (T + α²) (u, v) = α² (u_m, v_m) + T (u₀, v₀) − (T_xt, T_yt)",
}

impl Model for Clg {
    const INFO: Info = Info {
        id: "clg",
        name: "Combined local-global",
        family: "Optical flow",
        summary: "Finds the smoothest field that fits the gradient constraints of a window around every pixel.",
        source: "A. Bruhn, J. Weickert and C. Schnörr, Lucas/Kanade meets Horn/Schunck: combining local and global optic flow \
                 methods, International Journal of Computer Vision 61(3), 2005; medians: D. Sun, S. Roth and M. J. Black, \
                 Secrets of optical flow estimation and their principles, CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const STEPS: &'static [Name] = &[line::AVERAGE, line::SOLVE];
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static str = "The energy to be made small has two parts: how far the gradient constraints of a window \
                                   around each pixel are off, which makes the field proof against noise, and α² times how \
                                   unlike neighbours move, which fills in where a window says too little.";
    const SYSTEM_PARTS: usize = 5;
    const NEED: [f64; 2] = [112.0, 220.0];
    type System = System;
    type Unknowns = Field;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn system(&self, linear: &Linear, threads: &Threads) -> System {
        let tensor = MotionTensor::new(linear, self.rho, threads);
        System { solutions: Local::new(&tensor, self.alpha), tensor: OnceLock::new() }
    }

    fn iterate(&self, warp: &Warp<Self>, from: &Field, count: usize, threads: &Threads) -> Field {
        let Some(relaxation) = self.solver.relaxation(self.relaxation) else {
            return warp.system.solutions.jacobi(from, count, threads);
        };
        let mut field = from.clone();
        (0..count).for_each(|_| warp.system.solutions.sweep(&mut field, relaxation));
        field
    }

    fn energy(&self, warp: &Warp<Self>, at: &Field) -> [f64; 2] {
        let [_, smoothness] = relax::energy(&warp.linear, self.alpha, at);
        [self.tensor(warp).energy(at), smoothness]
    }

    fn told(&self, step: usize, looked: &Looked<Self>) -> Told {
        let mean = self.solver.mean_of(looked);
        let tensor = self.tensor(&looked.iteration.warp).at(looked.place);
        let mut points = vec![("average", Role::Predicted, mean), ("after", Role::Result, looked.to())];
        if step == AVERAGED {
            points.pop();
        }
        let update = solution(tensor, self.alpha * self.alpha, mean);
        let [xx, xy, yy, xt, yt] = about_zero(tensor, looked.start().unwrap_or_default()).map(words::number);
        Told {
            sentence: if step == AVERAGED { looked.averaged(mean) } else { self.updated(looked, update) },
            facts: vec![
                Fact { label: "T_xx, T_xy, T_yy", value: format!("{xx}, {xy}, {yy}"), role: None },
                Fact { label: "T_xt, T_yt", value: format!("{xt}, {yt}"), role: None },
            ],
            equation: self.equation(tensor, (mean, update), looked),
            points,
            lines: self.lines(looked),
        }
    }
}

impl Clg {
    fn tensor<'a>(&self, warp: &'a Warp<Self>) -> &'a MotionTensor {
        warp.system.tensor.get_or_init(|| MotionTensor::new(&warp.linear, self.rho, &Threads::single()))
    }

    fn updated(&self, looked: &Looked<Self>, update: [f32; 2]) -> Sentence {
        let window = if self.rho > 0.0 {
            format!("The constraints within about {} px of ", words::number(2.0 * self.rho))
        } else {
            "The constraint of ".into()
        };
        let beyond = self.solver.beyond(self.relaxation);
        let said = Sentence::default()
            .text(window)
            .ink(Role::Reference, looked.pixel())
            .text(" and the average of its neighbours are weighed against each other: it goes to ");
        match beyond {
            Some(_) => looked.goes(said, update, beyond).text("."),
            None => looked
                .goes(said, update, beyond)
                .text(", the nearer to where the lines of the window cross, the larger their gradients are beside α."),
        }
    }

    /// The two equations of the pixel in symbols, and with its numbers.
    fn equation(&self, tensor: [f32; 6], (mean, update): ([f32; 2], [f32; 2]), looked: &Looked<Self>) -> Vec<Math> {
        let (weight, [xx, xy, yy, xt, yt, _]) = (self.alpha * self.alpha, tensor);
        let beyond = self.solver.beyond(self.relaxation);
        let mut lines = looked.start().map(|start| definitions(tensor, start).to_vec()).unwrap_or_default();
        lines.extend(symbols(looked.start().is_some()));
        lines.push(numbers([xx + weight, xy], weight, mean[0], xt));
        lines.push(numbers([xy, yy + weight], weight, mean[1], yt));
        let named = if beyond.is_some() { "(u, v) of GS = " } else { "(u, v) = " };
        lines.push(Math::Row(vec![Math::text(named), Math::ink(Role::Result, words::vector(update))]));
        lines.extend(beyond.into_iter().flat_map(|relaxation| looked.relaxed(update, relaxation)));
        lines
    }

    /// What the pixels of the window say of this one, each as strongly as it counts; of a large window only some.
    fn lines(&self, looked: &Looked<Self>) -> Vec<Constraint> {
        let Linear { factors, start } = &looked.iteration.warp.linear;
        let (width, height) = start.u.size();
        let (x, y) = looked.place;
        let [u, v] = start.at(x, y);
        let weights = filter::gaussian(self.rho);
        let reach = weights.len() as isize / 2;
        let apart = (reach as usize / 4).max(1);
        let along = || (-(reach / apart as isize)..=reach / apart as isize).map(|i| i * apart as isize);
        let places = along().flat_map(|j| along().map(move |i| (i, j))).filter_map(|(i, j)| {
            let place = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
            let weight = |k: isize| weights[(k + reach) as usize] / weights[reach as usize];
            (place.0 < width && place.1 < height).then(|| (place, weight(i) * weight(j)))
        });
        let line = |(place, weight): ((usize, usize), f32)| {
            let ([a, b, c], [other_u, other_v]) = (factors.at(place), start.at(place.0, place.1));
            // What is left to find there, of the displacement here.
            explain::line([a, b, c + a * (other_u - u) + b * (other_v - v)], weight, Role::Candidate)
        };
        places.filter_map(line).collect()
    }
}

/// What solves (T + α²) (u, v) = α² (u_m, v_m) − (xt, yt).
fn solution([xx, xy, yy, xt, yt, _]: [f32; 6], weight: f32, mean: [f32; 2]) -> [f32; 2] {
    let (a, d, e, f) = (xx + weight, yy + weight, weight * mean[0] - xt, weight * mean[1] - yt);
    let det = a * d - xy * xy;
    [(e * d - xy * f) / det, (a * f - xy * e) / det]
}

/// T_xx, T_xy, T_yy, T_xt and T_yt as they are taken about a field that is `start` at the pixel; those of a [`MotionTensor`] are
/// about the whole displacement.
fn about_zero([xx, xy, yy, xt, yt, _]: [f32; 6], [u, v]: [f32; 2]) -> [f32; 5] {
    [xx, xy, yy, xt + xx * u + xy * v, yt + xy * u + yy * v]
}

fn part(along: &'static str) -> Math {
    Math::indexed(Math::Var("T"), Math::Var(along))
}

/// What stands for T_xt and T_yt where frame t + 1 was brought back by `start`, in symbols and numbers.
fn definitions(tensor: [f32; 6], start: [f32; 2]) -> [Math; 2] {
    let [xx, xy, yy, xt, yt] = about_zero(tensor, start);
    let [u, v] = start.map(words::factor);
    let zero = |name| Math::indexed(Math::Var(name), Math::text("0"));
    let line = |[to, t, first, second]: [&'static str; 4], [total, a, b, rest]: [f32; 4]| {
        Math::Row(vec![
            Math::indexed(Math::Var("c"), Math::Var(to)),
            Math::text(" = "),
            part(t),
            Math::text(" − "),
            part(first),
            Math::text(" "),
            zero("u"),
            Math::text(" − "),
            part(second),
            Math::text(" "),
            zero("v"),
            Math::text(format!(
                " = {} − {} · {u} − {} · {v} = ",
                words::number(total),
                words::factor(a),
                words::factor(b)
            )),
            Math::ink(Role::Reference, words::number(rest)),
        ])
    };
    [line(["x", "xt", "xx", "xy"], [xt, xx, xy, tensor[3]]), line(["y", "yt", "xy", "yy"], [yt, xy, yy, tensor[4]])]
}

/// The two equations of a pixel in symbols; where frame t + 1 was brought back (`is_about`), c stands for what T has of time.
fn symbols(is_about: bool) -> [Math; 2] {
    let squared = || Math::power(Math::Var("α"), Math::text("2"));
    let time = |t: &'static str, c: &'static str| {
        if is_about { Math::indexed(Math::Var("c"), Math::Var(c)) } else { part(t) }
    };
    let right = |name: &'static str, time: Math| {
        let mean = Math::mean(Math::Var(name));
        Math::Row(vec![Math::text(" = "), squared(), Math::text(" "), mean, Math::text(" − "), time])
    };
    let with_weight = |along: &'static str| {
        Math::Row(vec![Math::text("("), part(along), Math::text(" + "), squared(), Math::text(") ")])
    };
    let mixed = || Math::Row(vec![part("xy"), Math::text(" ")]);
    let row =
        |first, second, right| Math::Row(vec![first, Math::Var("u"), Math::text(" + "), second, Math::Var("v"), right]);
    [
        row(with_weight("xx"), mixed(), right("u", time("xt", "x"))),
        row(mixed(), with_weight("yy"), right("v", time("yt", "y"))),
    ]
}

/// One of them in numbers.
fn numbers([a, b]: [f32; 2], weight: f32, mean: f32, t: f32) -> Math {
    Math::Row(vec![
        Math::text(format!("{} ", words::number(a))),
        Math::Var("u"),
        Math::text(format!(" {} ", words::plus(b))),
        Math::Var("v"),
        Math::text(format!(" = {} · ", words::number(weight))),
        Math::ink(Role::Predicted, words::factor(mean)),
        Math::text(format!(" {}", words::plus(-t))),
    ])
}
