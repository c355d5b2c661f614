//! TV-L1: an L1 data term, robust to outliers, with total variation, which allows flow discontinuities.

use crate::base::Threads;
use crate::methods::{
    differential::{Advice, Linear, explain, numbers},
    variational::{Dual, Explanation, Model, Probe, Settings, Warp, primal_dual},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Fact, Math, Name, Question, Reply, Role, Sentence};
use crate::{cases, params, pseudocode};

params! {
    /// TV-L1, which minimises the energy ∫∫ λ |I_x u + I_y v + I_t| + |∇u| + |∇v|. Neither term is squared, so outliers of the
    /// gradient constraint and flow discontinuities are penalised only linearly.
    pub struct TvL1 {
        /// Weight λ of the data term (attachment). Smaller values give smoother flow. For gray levels 0 to 255; the paper's values for 0 to 1 are 255 times as large.
        lambda: f32 = 0.2, 0.001..=10.0;
        /// Coupling θ (tightness) between the flow and the auxiliary flow of the data term. Smaller values couple them more tightly but converge more slowly.
        theta: f32 = 0.3, 0.01..=2.0;
        /// Step size τ of the dual update. Convergence is proven up to 0.125; in practice 0.25 converges too, and faster.
        tau: f32 = 0.25, 0.01..=0.25;
        /// Parameters that all variational methods share.
        settings: Settings = Settings { iterations: 40, levels: 5, warps: 5, sigma: 0.0, ..Settings::default() };
    }
    renamed { "smoothing" => "sigma" }
    advanced { "tau" }
}

/// The steps of an iteration: thresholding of the data term, then the update of the flow.
const THRESHOLDED: usize = 0;
const UPDATED: usize = 1;

cases! {
    ADVISE_TEXTURE: "A smaller λ and more iterations carry flow in from textured neighbours.",
    ADVISE_BOUNDARY: "More warps and iterations sharpen the boundary. Occluded pixels have no match; the forward–backward check shows them.",
    ADVISE_MOTION: "More pyramid levels and warps would reach this motion.",
}

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ λ |ρ| + |∇u| + |∇v|, where ρ = I_x u + I_y v + I_t",
    EACH_LEVEL: "(u, v) ← 0; for each pyramid level, from the coarsest to full resolution; p ← 0",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← 3×3 median filter of (u, v); not before the very first warp",
    WARP: "    warp frame t+1 toward frame t by (u₀, v₀); I_x, I_y, I_t ← derivatives; c ← I_t − I_x u₀ − I_y v₀",
    EACH_ITERATION: "    for each iteration",
    FIT_DATA: "      f = (u_f, v_f) ← (u, v) − s ∇I, s = ρ / |∇I|² clipped to ±λ θ, ρ = I_x u + I_y v + c",
    SMOOTH: "      (u, v) ← (u_f, v_f) + θ (div p_u, div p_v)",
    UPDATE_DUAL: "      p_u ← (p_u + τ/θ ∇u) / (1 + τ/θ |∇u|), p_v ← (p_v + τ/θ ∇v) / (1 + τ/θ |∇v|)",
}

impl Model for TvL1 {
    const INFO: Info = Info {
        id: "tv-l1",
        name: "TV-L1",
        family: "Optical flow",
        summary: "Dense optical flow with an L1 data term, robust to occlusions, and total variation, which keeps motion boundaries sharp.",
        source: "C. Zach, T. Pock and H. Bischof, A duality based approach for realtime TV-L1 optical flow, DAGM 2007; \
                 J. Sánchez, E. Meinhardt-Llopis and G. Facciolo, TV-L1 optical flow estimation, Image Processing On Line 3, \
                 2013; medians: D. Sun, S. Roth and M. J. Black, Secrets of optical flow estimation and their principles, \
                 CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "thresholding",
        "How far toward the constraint line does thresholding move the auxiliary flow?",
        &[
            Reply::says(line::FIT_DATA, "all the way", "All the way"),
            Reply::says(line::FIT_DATA, "is clipped", "Part of the way: the step is clipped"),
            Reply::says(line::FIT_DATA, "there is no constraint", "Not at all: there is no constraint"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "px";
    const OPENING: &'static str = "The energy sums λ times the absolute residual of the gradient constraint (L1 data term) and \
                                   the total variation of u and v. Neither is squared, so outliers such as occlusions lose \
                                   influence, and a sharp motion boundary costs no more than a gradual one.";
    const ADVICE: Advice =
        Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };
    const SYSTEM_PARTS: usize = 0;
    const NEED: [f64; 2] = [122.0, 275.0];
    type System = ();
    type Unknowns = Dual;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steps(&self) -> &'static [Name] {
        &[line::FIT_DATA, line::SMOOTH, line::UPDATE_DUAL]
    }

    fn system(&self, _: &Linear, _: &Threads) {}

    fn iterate(&self, warp: &Warp<Self>, from: &Dual, count: usize, threads: &Threads) -> Dual {
        let mut unknowns = from.clone();
        unknowns.iterate(&warp.linear, self.weights(), count, threads);
        unknowns
    }

    fn energy(&self, warp: &Warp<Self>, at: &Dual) -> [f64; 2] {
        primal_dual::energy(&warp.linear, self.lambda, &at.field)
    }

    fn explanation(&self, step: usize, probe: &Probe<Self>) -> Explanation {
        let pixel = Pixel::of(self, probe);
        let mut points = vec![("auxiliary flow f", Role::Predicted, pixel.fitted), ("after", Role::Result, probe.to())];
        if step == THRESHOLDED {
            points.pop();
        }
        Explanation {
            sentence: pixel.sentence(self, step, probe),
            facts: pixel.facts(step),
            equation: pixel.equation(self, step, probe),
            points,
            lines: explain::line(probe.factors(), 1.0, Role::Candidate).into_iter().collect(),
            energy: pixel.energy(self, step, probe),
        }
    }
}

impl TvL1 {
    fn weights(&self) -> primal_dual::Weights {
        primal_dual::Weights { most: self.lambda * self.theta, theta: self.theta, rate: self.tau / self.theta }
    }
}

/// |p| from which a dual variable counts as saturated.
const DISCONTINUITY: f32 = 0.95;

/// A multiple of the gradient, in px² per gray level.
fn multiple(value: f32) -> String {
    numbers::fixed(value, 4)
}

/// An iteration at a pixel, in numbers.
struct Pixel {
    /// The residual ρ of the gradient constraint before the iteration.
    off: f32,
    /// ρ / |∇I|²: the step onto the constraint line, in multiples of the gradient.
    whole: f32,
    /// Whether the gradient is 0.
    is_flat: bool,
    /// The step s, clipped to ±λ θ.
    step: f32,
    fitted: [f32; 2],
    /// div p_u and div p_v.
    divergence: [f32; 2],
    /// ∇u and ∇v after the step.
    gradients: [[f32; 2]; 2],
    /// p_u and p_v before and after.
    p: [[[f32; 2]; 2]; 2],
}

impl Pixel {
    fn of(model: &TvL1, probe: &Probe<TvL1>) -> Self {
        let ([a, b, c], [u, v]) = (probe.factors(), probe.from());
        let (from, to, place) = (&probe.iteration.from, &probe.iteration.to, probe.place);
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

    fn sentence(&self, model: &TvL1, step: usize, probe: &Probe<TvL1>) -> Sentence {
        let said = Sentence::default();
        let off = numbers::gray(self.off);
        match step {
            THRESHOLDED => {
                let (most, whole) = (multiple(model.weights().most), multiple(self.whole.abs()));
                let said = said.text("Thresholding at ").ink(Role::Reference, probe.pixel());
                let why = if !probe.is_known() {
                    ": (u₀, v₀) leads out of frame t+1, so there is no constraint and the auxiliary flow stays at f = "
                        .to_owned()
                } else if self.is_flat {
                    ": without gradient the constraint allows any flow, so the auxiliary flow stays at f = ".to_owned()
                } else if self.off == 0.0 {
                    ": the flow satisfies the constraint exactly, so the auxiliary flow stays at f = ".to_owned()
                } else if self.step == self.whole {
                    format!(
                        ": ρ = {off} gray levels. |ρ| / |∇I|² = {whole} is within λ θ = {most}, so the auxiliary flow moves all \
                         the way to the constraint line: f = "
                    )
                } else {
                    format!(
                        ": ρ = {off} gray levels. |ρ| / |∇I|² = {whole} exceeds λ θ = {most}, so the step is clipped there, as \
                         for an outlier of the L1 data term: f = "
                    )
                };
                said.text(why).ink(Role::Predicted, probe.px(self.fitted)).text(".")
            }
            UPDATED => said
                .text("Update of ")
                .ink(Role::Reference, probe.pixel())
                .text(format!(
                    ": (u, v) = f + θ (div p_u, div p_v), with divergences {}, gives ",
                    numbers::vector(self.divergence)
                ))
                .ink(Role::Result, probe.px(probe.to()))
                .text(
                    ". This step smooths the flow; |p| ≤ 1 limits the smoothing, however large the jump of the flow.",
                ),
            _ => {
                let [u, v] = self.gradients.map(|g| numbers::px(g[0].hypot(g[1])));
                let lengths = self.p[1].map(|p| p[0].hypot(p[1]));
                let [long_u, long_v] = lengths.map(numbers::px);
                let meaning = match lengths.iter().any(|length| *length >= DISCONTINUITY) {
                    true => "close to 1, where total variation accepts a flow discontinuity",
                    false => {
                        "inside the unit ball, so total variation still smooths here; |p| = 1 marks a flow discontinuity"
                    }
                };
                said.text("Dual update at ").ink(Role::Reference, probe.pixel()).text(format!(
                    ": p_u follows ∇u, p_v follows ∇v; |∇u| = {u} and |∇v| = {v} {}. |p_u| = {long_u} and |p_v| = {long_v}: {meaning}.",
                    probe.unit()
                ))
            }
        }
    }

    /// The energy that a step minimises over the auxiliary flow, or over the flow; none of the dual update, which leaves both.
    fn energy(&self, model: &TvL1, step: usize, probe: &Probe<TvL1>) -> Option<Box<dyn Fn([f32; 2]) -> f32>> {
        let theta = model.theta;
        match step {
            THRESHOLDED => Some(Box::new(data_energy((model.lambda, theta), probe.factors(), probe.from()))),
            UPDATED => Some(Box::new(smoothing_energy(theta, self.fitted, self.divergence))),
            _ => None,
        }
    }

    fn facts(&self, step: usize) -> Vec<Fact> {
        let fact = |label, value: String, role| Fact::new(label, value, role);
        let case = match self.step {
            _ if self.is_flat => "no constraint",
            step if step == self.whole => "step to the constraint line",
            step if step > 0.0 => "step clipped at λ θ",
            _ => "step clipped at −λ θ",
        };
        let [u, v] = self.p[usize::from(step > UPDATED)].map(numbers::vector);
        vec![
            fact("Residual ρ", format!("{} gray levels, {case}", numbers::gray(self.off)), None),
            fact("p_u, p_v", format!("{u}, {v}"), None),
        ]
    }

    fn equation(&self, model: &TvL1, step: usize, probe: &Probe<TvL1>) -> Vec<Math> {
        let to = probe.to();
        match step {
            THRESHOLDED => self.fitting(model, probe),
            UPDATED => [("u", 0), ("v", 1)]
                .into_iter()
                .flat_map(|(name, i)| {
                    smoothing(
                        model,
                        name,
                        Smoothing { fitted: self.fitted[i], divergence: self.divergence[i], to: to[i] },
                    )
                })
                .collect(),
            _ => [("u", 0), ("v", 1)]
                .into_iter()
                .flat_map(|(name, i)| {
                    dual_update(
                        model,
                        name,
                        DualUpdate { from: self.p[0][i], gradient: self.gradients[i], to: self.p[1][i] },
                    )
                })
                .collect(),
        }
    }

    /// Returns (u_f, v_f) = (u, v) − s ∇I, in symbols and numbers.
    fn fitting(&self, model: &TvL1, probe: &Probe<TvL1>) -> Vec<Math> {
        let ([a, b, _], [u, v]) = (probe.factors(), probe.from());
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
            probe.rest(),
            Math::text(format!(" = {}", numbers::gray(self.off))),
        ]);
        let step = Math::Row(vec![
            Math::Var("s"),
            Math::text(" = "),
            share,
            Math::text(format!(" clipped to ±{} = ", multiple(model.weights().most))),
            Math::text(multiple(self.step)),
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
                Math::ink(Role::Best, numbers::px(from)),
                Math::text(format!(" − {} · ", numbers::factor(multiple(self.step)))),
                Math::ink(Role::Reference, numbers::factor(numbers::gray(gradient))),
                Math::text(" = "),
                Math::ink(Role::Predicted, numbers::px(to)),
            ])
        };
        let lines = [line("u", u, "x", a, self.fitted[0]), line("v", v, "y", b, self.fitted[1])];
        probe.definition().into_iter().chain([off, step]).chain(lines).collect()
    }
}

/// λ |ρ(f)| + |f − w|² / 2θ over the auxiliary flow f, for the flow w: thresholding minimises it.
fn data_energy((lambda, theta): (f32, f32), [a, b, c]: [f32; 3], from: [f32; 2]) -> impl Fn([f32; 2]) -> f32 {
    move |[u, v]| lambda * (a * u + b * v + c).abs() + ((u - from[0]).powi(2) + (v - from[1]).powi(2)) / (2.0 * theta)
}

/// |w − f|² / 2θ − u div p_u − v div p_v over the flow w: the total variation as p has it, which the update minimises.
fn smoothing_energy(theta: f32, fitted: [f32; 2], divergence: [f32; 2]) -> impl Fn([f32; 2]) -> f32 {
    move |[u, v]| {
        let apart = (u - fitted[0]).powi(2) + (v - fitted[1]).powi(2);
        apart / (2.0 * theta) - u * divergence[0] - v * divergence[1]
    }
}

/// The dual variable p_u or p_v.
fn dual(name: &'static str) -> Math {
    Math::indexed(Math::Var("p"), Math::Var(name))
}

/// One component of the flow after the data term was fitted, the divergence of its dual variable, and their sum.
struct Smoothing {
    fitted: f32,
    divergence: f32,
    to: f32,
}

/// u = u_f + θ div p, in symbols and numbers.
fn smoothing(model: &TvL1, name: &'static str, Smoothing { fitted, divergence, to }: Smoothing) -> [Math; 1] {
    [Math::Row(vec![
        Math::Var(name),
        Math::text(" = "),
        Math::indexed(Math::Var(name), Math::Var("f")),
        Math::text(" + "),
        Math::Var("θ"),
        Math::text(" div "),
        dual(name),
        Math::text(" = "),
        Math::ink(Role::Predicted, numbers::px(fitted)),
        Math::text(format!(" + {} · {} = ", numbers::gray(model.theta), numbers::factor(numbers::px(divergence)))),
        Math::ink(Role::Result, numbers::px(to)),
    ])]
}

/// The dual variable of one component of the flow before and after its update, and the gradient of the component.
struct DualUpdate {
    from: [f32; 2],
    gradient: [f32; 2],
    to: [f32; 2],
}

/// The dual update of one flow component, in symbols and numbers.
fn dual_update(model: &TvL1, name: &'static str, DualUpdate { from, gradient, to }: DualUpdate) -> [Math; 2] {
    let rate = || Math::Frac(Box::new(Math::Var("τ")), Box::new(Math::Var("θ")));
    let gradient_of = || Math::Row(vec![Math::text("∇"), Math::Var(name)]);
    let top = vec![dual(name), Math::text(" + "), rate(), Math::text(" "), gradient_of()];
    let bottom = vec![Math::text("1 + "), rate(), Math::text(" "), Math::Abs(Box::new(gradient_of()))];
    let times = numbers::px(model.tau / model.theta);
    let top_numbers = format!("{} + {times} · {}", numbers::vector(from), numbers::vector(gradient));
    let bottom_numbers = format!("1 + {times} · {}", numbers::px(gradient[0].hypot(gradient[1])));
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
            Math::text(numbers::vector(to)),
        ]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails unless `energy` is smallest at `to`.
    fn is_minimum(energy: impl Fn([f32; 2]) -> f32, to: [f32; 2]) {
        for [du, dv] in [[0.02, 0.0], [-0.02, 0.0], [0.0, 0.02], [0.0, -0.02], [0.015, 0.015], [-0.015, 0.015]] {
            assert!(energy(to) < energy([to[0] + du, to[1] + dv]), "{to:?}: ({du}, {dv})");
        }
    }

    #[test]
    fn thresholding_is_the_minimum_of_the_data_energy() {
        let ([lambda, theta], from) = ([0.15, 0.3], [0.6, -0.2]);
        // To the constraint line, clipped on both sides of it, and without a gradient.
        for factors in [[6.0, -3.0, -4.0], [1.0, 0.5, 9.0], [1.0, 0.5, -9.0], [0.0, 0.0, 5.0]] {
            let [a, b, c] = factors;
            let step = primal_dual::step(a * from[0] + b * from[1] + c, a * a + b * b, lambda * theta);
            is_minimum(data_energy((lambda, theta), factors, from), [from[0] - step * a, from[1] - step * b]);
        }
    }

    #[test]
    fn the_update_is_the_minimum_of_the_smoothing_energy() {
        let (theta, fitted, divergence) = (0.3, [0.4, -0.1], [0.8, -1.3]);
        let to = [0, 1].map(|i| fitted[i] + theta * divergence[i]);
        is_minimum(smoothing_energy(theta, fitted, divergence), to);
    }
}
