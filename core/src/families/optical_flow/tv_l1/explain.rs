//! The explanation of TV-L1.

use super::TvL1;
use crate::methods::{
    differential::explain,
    variational::{Explanation, Probe, primal_dual, value as variational},
};
use crate::scene::{Role, Step, Unit};
use crate::{cases, variables};

/// The steps of an iteration: thresholding of the data term, then the update of the flow.
const THRESHOLDED: usize = 0;
const UPDATED: usize = 1;

/// A multiple of the image gradient.
const MULTIPLE: Unit = Unit::new("px² per gray level", 4);

variables! { pub(super) mod value;
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

cases! { pub(super) over value, explain::value, variational;
    OPENING: "The energy sums λ times the absolute residual of the gradient constraint (L1 data term) and the total \
              variation of u and v. Neither is squared, so outliers such as occlusions lose influence, and a sharp motion \
              boundary costs no more than a gradual one.",
    NO_STEP: "{residual}, no constraint",
    WHOLE_STEP: "{residual}, step to the constraint line",
    ON_LINE: "{residual}, on the constraint line",
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

/// Explains the step `index` of an iteration at a pixel.
pub(super) fn explanation(model: &TvL1, index: usize, probe: &Probe<TvL1>, step: Step) -> Explanation {
    let pixel = Pixel::of(model, probe);
    let mut points = vec![("auxiliary flow f", Role::Predicted, pixel.fitted), ("after", Role::Result, probe.to())];
    if index == THRESHOLDED {
        points.pop();
    }
    Explanation {
        step: pixel.tell(model, index, probe, step),
        points,
        lines: explain::line(probe.factors(), 1.0, Role::Candidate).into_iter().collect(),
        energy: pixel.energy(model, index, probe),
    }
}

/// |p| from which a dual variable counts as saturated.
const DISCONTINUITY: f32 = 0.95;

/// The extent to which thresholding moves the auxiliary flow of a pixel.
#[derive(Clone, Copy)]
enum Thresholding {
    /// Nowhere: the constraint is unknown.
    Unknown,
    /// Nowhere: without gradient the constraint allows any flow.
    NoGradient,
    /// Nowhere: the flow satisfies the constraint.
    Satisfied,
    /// To the constraint line.
    Whole,
    /// Part of the way to it.
    Clipped,
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

    /// Explains the step `index` of the iteration.
    fn tell(&self, model: &TvL1, index: usize, probe: &Probe<TvL1>, step: Step) -> Step {
        let thresholding = self.thresholding(probe.is_known());
        let kind = match thresholding {
            Thresholding::Unknown => None,
            Thresholding::NoGradient => Some(case::NO_STEP),
            Thresholding::Satisfied => Some(case::ON_LINE),
            Thresholding::Whole => Some(case::WHOLE_STEP),
            Thresholding::Clipped if self.step > 0.0 => Some(case::CLIPPED_ABOVE),
            Thresholding::Clipped => Some(case::CLIPPED_BELOW),
        };
        let ([before, after], weights) = (self.p, model.weights());
        let [p_u, p_v] = if index > UPDATED { after } else { before };
        let step = match kind {
            Some(kind) => step.fact_as(value::RESIDUAL.is(self.off), kind),
            None => step,
        };
        let step = step.put(value::P_V, p_v).fact_as(value::P_U.is(p_u), case::DUAL_VARIABLES);
        let step = step.put_value(probe.px(value::AUXILIARY_FLOW, self.fitted));
        match index {
            THRESHOLDED => {
                let step = step.put(value::THRESHOLD, weights.most).put(value::STEP, self.step);
                let step = step.put(value::WHOLE_STEP, self.whole.abs()).say(case::THRESHOLDING);
                tell_thresholding(thresholding, probe, step)
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
                let step = step.put(value::GRADIENT_V, self.gradients[1]);
                let step = step.put_value(value::SLOPE_U.is(slope_u).in_unit(probe.unit()));
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

    /// The extent to which thresholding moves the auxiliary flow, if the constraint is known.
    fn thresholding(&self, is_known: bool) -> Thresholding {
        match () {
            () if !is_known => Thresholding::Unknown,
            () if self.is_flat => Thresholding::NoGradient,
            () if self.off == 0.0 => Thresholding::Satisfied,
            () if self.step == self.whole => Thresholding::Whole,
            () => Thresholding::Clipped,
        }
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

/// Tells the extent to which thresholding moves the auxiliary flow, and writes its step.
fn tell_thresholding(thresholding: Thresholding, probe: &Probe<TvL1>, step: Step) -> Step {
    let step = match thresholding {
        Thresholding::Unknown => step.say(case::UNKNOWN),
        Thresholding::NoGradient => step.say(case::NO_GRADIENT),
        Thresholding::Satisfied => step.say(case::SATISFIED),
        Thresholding::Whole => step.say(case::RESIDUAL).say(case::MOVES),
        Thresholding::Clipped => step.say(case::RESIDUAL).say(case::CLIPPED),
    };
    let (step, constant) = match probe.start() {
        Some(_) => (probe.iteration.warp.linear.define(step, probe.place, probe.unit()), "c"),
        None => (step, "I_t"),
    };
    if matches!(thresholding, Thresholding::Unknown) {
        return step.formula("f = (u, v) = {auxiliary_flow}");
    }
    step.formula(format!(r"\rho = I_x u + I_y v + {constant} = {{residual}}"))
        .formula(r"s = \frac{\rho}{|\nabla I|^2} \text{ clipped to ±}{threshold} = {step}")
        .formula(r"u_f = u - s I_x = {flow_before:1} - {step} \cdot {i_x} = {auxiliary_flow:1}")
        .formula(r"v_f = v - s I_y = {flow_before:2} - {step} \cdot {i_y} = {auxiliary_flow:2}")
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

    /// Asserts that `energy` is smallest at `to`.
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
