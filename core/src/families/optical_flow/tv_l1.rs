//! TV-L1: a field that may jump, and constraints that may be broken here and there.

use crate::base::{Threads, words};
use crate::methods::{
    differential::{Linear, explain},
    variational::{Dual, Looked, Model, Settings, Told, Warp, primal_dual},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Fact, Math, Name, Role, Sentence};
use crate::{params, pseudocode};

params! {
    /// TV-L1. The energy ∫∫ λ |I_x u + I_y v + I_t| + |∇u| + |∇v| is made as small as can be. Nothing is squared, so a constraint
    /// that is far off and a border at which motion jumps cost no more than in proportion.
    pub struct TvL1 {
        /// Weight λ of the constraints: the smaller, the smoother the field. For gray levels 0 to 255; where they are 0 to 1, as in the paper, it is 255 times as large.
        lambda: f32 = 0.2, 0.001..=10.0;
        /// How tightly, by θ, the field is tied to the one that fits the constraints: the smaller, the tighter, and the slower.
        theta: f32 = 0.3, 0.01..=2.0;
        /// Step size τ of the dual variables; up to 0.25 the iterations converge.
        tau: f32 = 0.25, 0.01..=0.25;
        /// What all variational methods have.
        settings: Settings = Settings { iterations: 40, levels: 5, warps: 5, smoothing: 0.0, ..Settings::default() };
    }
    advanced { "tau" }
}

/// The steps in which an iteration is told.
const FITTED: usize = 0;
const SMOOTHED: usize = 1;

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ λ |ρ| + |∇u| + |∇v|, where ρ = I_x u + I_y v + I_t",
    EACH_LEVEL: "(u, v) ← 0; for each level, from the coarsest to the picture itself; p ← 0",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← medians of 3×3 px of (u, v), but for the first warp of all",
    WARP: "    bring frame t+1 back along (u₀, v₀), take I_x, I_y, I_t; c ← I_t − I_x u₀ − I_y v₀",
    EACH_ITERATION: "    for each iteration",
    FIT_DATA: "      (u_f, v_f) ← (u, v) − ∇I · (ρ / |∇I|², but at most λ θ either way), ρ = I_x u + I_y v + c",
    SMOOTH: "      (u, v) ← (u_f, v_f) + θ (div p_u, div p_v)",
    UPDATE_DUAL: "      p ← (p + τ/θ ∇) / (1 + τ/θ |∇|), with ∇u for p_u and ∇v for p_v",
}

impl Model for TvL1 {
    const INFO: Info = Info {
        id: "tv-l1",
        name: "TV-L1",
        family: "Optical flow",
        summary: "Finds a field that may jump at borders, from constraints of which some may be far off.",
        source: "C. Zach, T. Pock and H. Bischof, A duality based approach for realtime TV-L1 optical flow, DAGM 2007; \
                 J. Sánchez, E. Meinhardt-Llopis and G. Facciolo, TV-L1 optical flow estimation, Image Processing On Line 3, \
                 2013; medians: D. Sun, S. Roth and M. J. Black, Secrets of optical flow estimation and their principles, \
                 CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const STEPS: &'static [Name] = &[line::FIT_DATA, line::SMOOTH, line::UPDATE_DUAL];
    const ENERGY_UNIT: &'static str = "px";
    const OPENING: &'static str = "The energy to be made small has two parts: λ times how far the gradient constraints are \
                                   off, and how much the field varies (total variation). Neither is squared: a border at \
                                   which motion jumps costs no more than a slow change from one side to the other.";
    const SYSTEM_PARTS: usize = 0;
    const NEED: [f64; 2] = [122.0, 275.0];
    type System = ();
    type Unknowns = Dual;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn system(&self, _: &Linear, _: &Threads) {}

    fn iterate(&self, warp: &Warp<Self>, from: &Dual, count: usize, threads: &Threads) -> Dual {
        let mut unknowns = from.clone();
        (0..count).for_each(|_| unknowns.iterate(&warp.linear, self.weights(), threads));
        unknowns
    }

    fn energy(&self, warp: &Warp<Self>, at: &Dual) -> [f64; 2] {
        primal_dual::energy(&warp.linear, self.lambda, &at.field)
    }

    fn told(&self, step: usize, looked: &Looked<Self>) -> Told {
        let pixel = Pixel::of(self, looked);
        let mut points = vec![("fits", Role::Predicted, pixel.fitted), ("after", Role::Result, looked.to())];
        if step == FITTED {
            points.pop();
        }
        Told {
            sentence: pixel.sentence(self, step, looked),
            facts: pixel.facts(step),
            equation: pixel.equation(self, step, looked),
            points,
            lines: explain::line(looked.factors(), 1.0, Role::Candidate).into_iter().collect(),
        }
    }
}

impl TvL1 {
    fn weights(&self) -> primal_dual::Weights {
        primal_dual::Weights { most: self.lambda * self.theta, theta: self.theta, rate: self.tau / self.theta }
    }
}

/// An iteration at a pixel in numbers.
struct Pixel {
    /// ρ, how far the constraint is off at first.
    off: f32,
    /// ρ / |∇I|²: how many times its gradient the pixel would have to go to fulfil it.
    whole: f32,
    /// Whether there is no gradient to go along.
    is_flat: bool,
    /// How many times it goes.
    step: f32,
    fitted: [f32; 2],
    /// div p of both parts.
    divergence: [f32; 2],
    /// The gradients of u and of v after the step.
    gradients: [[f32; 2]; 2],
    /// p of both parts before and after.
    p: [[[f32; 2]; 2]; 2],
}

impl Pixel {
    fn of(model: &TvL1, looked: &Looked<TvL1>) -> Self {
        let ([a, b, c], [u, v]) = (looked.factors(), looked.from());
        let (from, to, place) = (&looked.iteration.from, &looked.iteration.to, looked.place);
        let off = a * u + b * v + c;
        let step = primal_dual::step(off, a * a + b * b, model.weights().most);
        Self {
            off,
            is_flat: a == 0.0 && b == 0.0,
            whole: primal_dual::step(off, a * a + b * b, f32::INFINITY),
            step,
            fitted: [u - step * a, v - step * b],
            divergence: from.divergence(place),
            gradients: to.gradients(place),
            p: [from.p(place), to.p(place)],
        }
    }

    fn sentence(&self, model: &TvL1, step: usize, looked: &Looked<TvL1>) -> Sentence {
        let said = Sentence::default();
        let off = words::number(self.off);
        match step {
            FITTED => {
                let most = words::number(model.weights().most);
                let said = said.text("At ").ink(Role::Reference, looked.pixel());
                let why = if !looked.is_known() {
                    " nothing is known: it has left the picture. The pixel stays at ".to_owned()
                } else if self.is_flat || self.off == 0.0 {
                    " the constraint asks for nothing: it holds, or there is no gradient. The pixel stays at ".to_owned()
                } else if self.step == self.whole {
                    format!(
                        " the constraint is off by {off} gray levels. {} times the gradient makes it hold, and that is no \
                         more than λ θ = {most}: the pixel goes all the way to the line, to ",
                        words::number(self.step.abs())
                    )
                } else {
                    format!(
                        " the constraint is off by {off} gray levels, {}. {} times the gradient would make it hold, but \
                         the pixel goes only λ θ = {most} times: what is far off has no more say. It goes to ",
                        if self.off > 0.0 { "too bright" } else { "too dark" },
                        words::number(self.whole.abs())
                    )
                };
                said.text(why).ink(Role::Predicted, looked.px(self.fitted)).text(".")
            }
            SMOOTHED => said
                .text("From there ")
                .ink(Role::Reference, looked.pixel())
                .text(format!(
                    " is pulled towards its neighbours by θ times the divergence {} of p, to ",
                    words::vector(self.divergence)
                ))
                .ink(Role::Result, looked.px(looked.to()))
                .text(": p points to where the field grows, and is never longer than 1, so that no jump pulls harder than another."),
            _ => {
                let [u, v] = self.gradients.map(|g| words::number(g[0].hypot(g[1])));
                let [long_u, long_v] = self.p[1].map(|p| words::number(p[0].hypot(p[1])));
                said.text("Now the field differs at ").ink(Role::Reference, looked.pixel()).text(format!(
                    " by {u} (u) and {v} (v) {} from its neighbours to the right and below. p turns towards that, and is \
                     {long_u} and {long_v} long: near 1 there is a jump, or a slope that stays.",
                    looked.unit()
                ))
            }
        }
    }

    fn facts(&self, step: usize) -> Vec<Fact> {
        let fact = |label, value, role| Fact { label, value, role };
        let case = match self.step {
            _ if self.is_flat => "no gradient, or left the picture: stays",
            step if step == self.whole => "near: to the line",
            step if step > 0.0 => "too bright: as far as λ θ allows",
            _ => "too dark: as far as λ θ allows",
        };
        let [u, v] = self.p[usize::from(step > SMOOTHED)].map(words::vector);
        vec![
            fact("ρ", format!("{} gray levels; {case}", words::number(self.off)), None),
            fact("p of u, of v", format!("{u}, {v}"), None),
        ]
    }

    fn equation(&self, model: &TvL1, step: usize, looked: &Looked<TvL1>) -> Vec<Math> {
        let to = looked.to();
        match step {
            FITTED => self.fitting(model, looked),
            SMOOTHED => [("u", 0), ("v", 1)]
                .into_iter()
                .flat_map(|(name, i)| smoothing(model, name, (self.fitted[i], self.divergence[i], to[i])))
                .collect(),
            _ => [("u", 0), ("v", 1)]
                .into_iter()
                .flat_map(|(name, i)| turning(model, name, (self.p[0][i], self.gradients[i], self.p[1][i])))
                .collect(),
        }
    }

    /// (u_f, v_f) = (u, v) − s ∇I, in symbols and numbers.
    fn fitting(&self, model: &TvL1, looked: &Looked<TvL1>) -> Vec<Math> {
        let ([a, b, _], [u, v]) = (looked.factors(), looked.from());
        let fitted = |name| Math::indexed(Math::Var(name), Math::Var("f"));
        let gradient = || Math::Row(vec![Math::text("∇"), Math::Var("I")]);
        let share = Math::Frac(
            Box::new(Math::Var("ρ")),
            Box::new(Math::power(Math::Abs(Box::new(gradient())), Math::text("2"))),
        );
        let off = Math::Row(vec![
            Math::Var("ρ"),
            Math::text(" = "),
            explain::derivative("x"),
            Math::text(" "),
            Math::Var("u"),
            Math::text(" + "),
            explain::derivative("y"),
            Math::text(" "),
            Math::Var("v"),
            Math::text(" + "),
            looked.rest(),
            Math::text(format!(" = {}", words::number(self.off))),
        ]);
        let step = Math::Row(vec![
            Math::Var("s"),
            Math::text(" = "),
            share,
            Math::text(format!(" within ±{} = ", words::number(model.weights().most))),
            Math::text(words::number(self.step)),
        ]);
        let line = |name: &'static str, from: f32, along: &'static str, gradient: f32, to: f32| {
            Math::Row(vec![
                fitted(name),
                Math::text(" = "),
                Math::Var(name),
                Math::text(" − "),
                Math::Var("s"),
                Math::text(" "),
                explain::derivative(along),
                Math::text(" = "),
                Math::ink(Role::Best, words::number(from)),
                Math::text(format!(" − {} · ", words::factor(self.step))),
                Math::ink(Role::Reference, words::number(gradient)),
                Math::text(" = "),
                Math::ink(Role::Predicted, words::number(to)),
            ])
        };
        let lines = [line("u", u, "x", a, self.fitted[0]), line("v", v, "y", b, self.fitted[1])];
        looked.definition().into_iter().chain([off, step]).chain(lines).collect()
    }
}

/// The dual variable of u or v.
fn dual(name: &'static str) -> Math {
    Math::indexed(Math::Var("p"), Math::Var(name))
}

/// u = u_f + θ div p, in symbols and numbers.
fn smoothing(model: &TvL1, name: &'static str, (fitted, div, to): (f32, f32, f32)) -> [Math; 1] {
    [Math::Row(vec![
        Math::Var(name),
        Math::text(" = "),
        Math::indexed(Math::Var(name), Math::Var("f")),
        Math::text(" + "),
        Math::Var("θ"),
        Math::text(" div "),
        dual(name),
        Math::text(" = "),
        Math::ink(Role::Predicted, words::number(fitted)),
        Math::text(format!(" + {} · {} = ", words::number(model.theta), words::factor(div))),
        Math::ink(Role::Result, words::number(to)),
    ])]
}

/// The new p of one part of the field, in symbols and numbers.
fn turning(model: &TvL1, name: &'static str, (from, gradient, to): ([f32; 2], [f32; 2], [f32; 2])) -> [Math; 2] {
    let rate = || Math::Frac(Box::new(Math::Var("τ")), Box::new(Math::Var("θ")));
    let gradient_of = || Math::Row(vec![Math::text("∇"), Math::Var(name)]);
    let top = vec![dual(name), Math::text(" + "), rate(), Math::text(" "), gradient_of()];
    let bottom = vec![Math::text("1 + "), rate(), Math::text(" "), Math::Abs(Box::new(gradient_of()))];
    let times = words::number(model.tau / model.theta);
    let top_numbers = format!("{} + {times} · {}", words::vector(from), words::vector(gradient));
    let bottom_numbers = format!("1 + {times} · {}", words::number(gradient[0].hypot(gradient[1])));
    [
        Math::Row(vec![
            dual(name),
            Math::text(" ← "),
            Math::Frac(Box::new(Math::Row(top)), Box::new(Math::Row(bottom))),
        ]),
        Math::Row(vec![
            Math::text("= "),
            Math::Frac(Box::new(Math::text(top_numbers)), Box::new(Math::text(bottom_numbers))),
            Math::text(" = "),
            Math::text(words::vector(to)),
        ]),
    ]
}
