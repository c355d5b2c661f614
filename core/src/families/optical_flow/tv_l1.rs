//! TV-L1: an L1 data term, robust to outliers, with total variation, which allows flow discontinuities.

use crate::base::Threads;
use crate::methods::{
    differential::{Advice, Linear, explain},
    variational::{Dual, Explanation, Model, Probe, Settings, Warp, primal_dual, value as variational},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Case, Name, Question, Reply, Role, Step, Unit};
use crate::{cases, params, pseudocode, variables};

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

/// A multiple of the image gradient.
const MULTIPLE: Unit = Unit::new("px² per gray level", 4);

variables! {
    /// The residual of the gradient constraint before the iteration.
    RESIDUAL: "Residual ρ", r"\rho", Unit::GRAY;
    /// The step to the constraint line, in multiples of the image gradient.
    WHOLE_STEP: "", r"|\rho| / |\nabla I|^2", MULTIPLE;
    /// The largest step.
    THRESHOLD: "", r"\lambda \theta", MULTIPLE;
    /// The clipped step, in multiples of the image gradient.
    STEP: "", "s", MULTIPLE;
    /// The auxiliary flow of the data term.
    AUXILIARY_FLOW: "", "f", Unit::SUBPIXEL, Role::Predicted;
    /// The coupling between the flow and the auxiliary flow.
    THETA: "", r"\theta", Unit::FINE;
    /// The divergences of p_u and p_v.
    DIVERGENCE: "", r"(\text{div }p_u, \text{div }p_v)", Unit::RATIO;
    /// The step size of the dual update.
    RATE: "", r"\tau / \theta", Unit::RATIO;
    /// The dual variable of u.
    P_U: "p_u, p_v", "p_u", Unit::RATIO;
    /// The dual variable of v.
    P_V: "", "p_v", Unit::RATIO;
    /// The dual variable of u before the iteration.
    P_U_BEFORE: "", "", Unit::RATIO;
    /// The dual variable of v before the iteration.
    P_V_BEFORE: "", "", Unit::RATIO;
    /// The gradient of u after the update of the flow.
    GRADIENT_U: "", r"\nabla u", Unit::RATIO;
    /// The gradient of v after the update of the flow.
    GRADIENT_V: "", r"\nabla v", Unit::RATIO;
    /// The magnitude of the gradient of u.
    SLOPE_U: "", r"|\nabla u|", Unit::SUBPIXEL;
    /// The magnitude of the gradient of v.
    SLOPE_V: "", r"|\nabla v|", Unit::SUBPIXEL;
    /// The length of p_u.
    LENGTH_U: "", "|p_u|", Unit::RATIO;
    /// The length of p_v.
    LENGTH_V: "", "|p_v|", Unit::RATIO;
}

cases! { over value, explain::value, variational;
    OPENING: "The energy sums λ times the absolute residual of the gradient constraint (L1 data term) and the total \
              variation of u and v. Neither is squared, so outliers such as occlusions lose influence, and a sharp motion \
              boundary costs no more than a gradual one.",
    NO_STEP: "{residual}, no constraint",
    WHOLE_STEP: "{residual}, step to the constraint line",
    CLIPPED_ABOVE: "{residual}, step clipped at λ θ",
    CLIPPED_BELOW: "{residual}, step clipped at −λ θ",
    DUAL_VARIABLES: "{p_u}, {p_v}",
    THRESHOLDING: "Thresholding at {reference|pixel} {pixel}:",
    UNKNOWN: "(u₀, v₀) leads out of frame t+1, so there is no constraint and the auxiliary flow stays at f = {auxiliary_flow}.",
    NO_GRADIENT: "without gradient the constraint allows any flow, so the auxiliary flow stays at f = {auxiliary_flow}.",
    SATISFIED: "the flow satisfies the constraint exactly, so the auxiliary flow stays at f = {auxiliary_flow}.",
    RESIDUAL: "ρ = {residual}. |ρ| / |∇I|² = {whole_step:bare}",
    MOVES: "is within λ θ = {threshold:bare}, so the auxiliary flow moves all the way to the constraint line: f = {auxiliary_flow}.",
    CLIPPED: "exceeds λ θ = {threshold:bare}, so the step is clipped there, as for an outlier of the L1 data term: f = {auxiliary_flow}.",
    UPDATED: "Update of {reference|pixel} {pixel}: (u, v) = f + θ (div p_u, div p_v), with divergences {divergence}, gives {flow_after}. \
              This step smooths the flow; |p| ≤ 1 limits the smoothing, however large the jump of the flow.",
    DUAL_UPDATE: "Dual update at {reference|pixel} {pixel}: p_u follows ∇u, p_v follows ∇v; |∇u| = {slope_u:bare} and |∇v| = {slope_v}. \
                  |p_u| = {length_u} and |p_v| = {length_v}:",
    SATURATED: "close to 1, where total variation accepts a flow discontinuity.",
    INSIDE: "inside the unit ball, so total variation still smooths here; |p| = 1 marks a flow discontinuity.",
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
            Reply::told(line::FIT_DATA, case::MOVES, "All the way"),
            Reply::told(line::FIT_DATA, case::CLIPPED, "Part of the way: the step is clipped"),
            Reply::told(line::FIT_DATA, case::UNKNOWN, "Not at all: there is no constraint"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "px";
    const OPENING: &'static Case = case::OPENING;
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

    fn explanation(&self, index: usize, probe: &Probe<Self>, step: Step) -> Explanation {
        let pixel = Pixel::of(self, probe);
        let mut points = vec![("auxiliary flow f", Role::Predicted, pixel.fitted), ("after", Role::Result, probe.to())];
        if index == THRESHOLDED {
            points.pop();
        }
        Explanation {
            step: pixel.tell(self, index, probe, step),
            points,
            lines: explain::line(probe.factors(), 1.0, Role::Candidate).into_iter().collect(),
            energy: pixel.energy(self, index, probe),
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

    /// Explains the step `index` of the iteration.
    fn tell(&self, model: &TvL1, index: usize, probe: &Probe<TvL1>, step: Step) -> Step {
        let kind = match self.step {
            _ if self.is_flat => case::NO_STEP,
            step if step == self.whole => case::WHOLE_STEP,
            step if step > 0.0 => case::CLIPPED_ABOVE,
            _ => case::CLIPPED_BELOW,
        };
        let ([before, after], weights) = (self.p, model.weights());
        let [p_u, p_v] = if index > UPDATED { after } else { before };
        let step = match probe.is_known() {
            true => step.fact_as(value::RESIDUAL.is(self.off), kind),
            false => step,
        };
        let step = step.put(value::P_V, p_v).fact_as(value::P_U.is(p_u), case::DUAL_VARIABLES);
        let step = step.put_value(probe.px(value::AUXILIARY_FLOW, self.fitted));
        match index {
            THRESHOLDED => {
                let step = step.put(value::THRESHOLD, weights.most).put(value::STEP, self.step);
                self.thresholded(probe, step.put(value::WHOLE_STEP, self.whole.abs()).say(case::THRESHOLDING))
            }
            UPDATED => step
                .put(value::THETA, model.theta)
                .put(value::DIVERGENCE, self.divergence)
                .put_value(probe.px(variational::FLOW_AFTER, probe.to()))
                .say(case::UPDATED)
                .formula(r"u = u_f + \theta \text{ div }p_u = {auxiliary_flow:1} + {theta} \cdot {divergence:1} = {flow_after:1}")
                .formula(r"v = v_f + \theta \text{ div }p_v = {auxiliary_flow:2} + {theta} \cdot {divergence:2} = {flow_after:2}"),
            _ => {
                let [slope_u, slope_v] = self.gradients.map(|[x, y]| x.hypot(y));
                let [length_u, length_v] = after.map(|[x, y]| x.hypot(y));
                let is_saturated = length_u.max(length_v) >= DISCONTINUITY;
                let step = step.put(value::RATE, weights.rate).put(value::P_U_BEFORE, before[0]);
                let step = step.put(value::P_V_BEFORE, before[1]).put(value::GRADIENT_U, self.gradients[0]);
                let step = step.put(value::GRADIENT_V, self.gradients[1]).put(value::SLOPE_U, slope_u);
                let step = step.put_value(value::SLOPE_V.is(slope_v).in_unit(probe.unit()));
                let step = step.put(value::LENGTH_U, length_u).put(value::LENGTH_V, length_v);
                step.say(case::DUAL_UPDATE)
                    .say(if is_saturated { case::SATURATED } else { case::INSIDE })
                    .formula(r"p_u \gets \frac{p_u + \frac{\tau}{\theta} \nabla u}{1 + \frac{\tau}{\theta} |\nabla u|}")
                    .formula(r"= \frac{{p_u_before} + {rate} \cdot {gradient_u}}{1 + {rate} \cdot {slope_u}} = {p_u}")
                    .formula(r"p_v \gets \frac{p_v + \frac{\tau}{\theta} \nabla v}{1 + \frac{\tau}{\theta} |\nabla v|}")
                    .formula(r"= \frac{{p_v_before} + {rate} \cdot {gradient_v}}{1 + {rate} \cdot {slope_v}} = {p_v}")
            }
        }
    }

    /// Tells how far thresholding moves the auxiliary flow, and writes its step.
    fn thresholded(&self, probe: &Probe<TvL1>, step: Step) -> Step {
        let step = match () {
            () if !probe.is_known() => step.say(case::UNKNOWN),
            () if self.is_flat => step.say(case::NO_GRADIENT),
            () if self.off == 0.0 => step.say(case::SATISFIED),
            () if self.step == self.whole => step.say(case::RESIDUAL).say(case::MOVES),
            () => step.say(case::RESIDUAL).say(case::CLIPPED),
        };
        let (step, constant) = match probe.start() {
            Some(_) => (probe.iteration.warp.linear.define(step, probe.place, probe.unit()), "c"),
            None => (step, "I_t"),
        };
        if !probe.is_known() {
            return step.formula("f = (u, v) = {auxiliary_flow}");
        }
        step.formula(format!(r"\rho = I_x u + I_y v + {constant} = {{residual}}"))
            .formula(r"s = \frac{\rho}{|\nabla I|^2} \text{ clipped to ±}{threshold} = {step}")
            .formula(r"u_f = u - s I_x = {flow_before:1} - {step} \cdot {i_x} = {auxiliary_flow:1}")
            .formula(r"v_f = v - s I_y = {flow_before:2} - {step} \cdot {i_y} = {auxiliary_flow:2}")
    }

    /// The energy that a step minimises over the auxiliary flow, or over the flow; none of the dual update, which leaves both.
    fn energy(&self, model: &TvL1, index: usize, probe: &Probe<TvL1>) -> Option<Box<dyn Fn([f32; 2]) -> f32>> {
        let TvL1 { lambda, theta, .. } = *model;
        match index {
            THRESHOLDED => Some(Box::new(data_energy((lambda, theta), probe.factors(), probe.from()))),
            UPDATED => Some(Box::new(smoothing_energy(theta, self.fitted, self.divergence))),
            _ => None,
        }
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
