//! The formulas of the Kalman filter with their numbers.

use super::{shared, value};
use crate::base::words::rounded;
use crate::families::tracking::kalman_filter::{Gated, modes};
use crate::geometry::Grid;
use crate::methods::kalman::{Filter, UpdateNumbers};
use crate::methods::numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, digits, finer};
use crate::scene::{Role, Step};

/// Adds the prediction of state and covariance, and that of x with its numbers. A turn is no linear function of the state: the extended
/// filter applies f, and its Jacobian F to P.
pub(super) fn prediction(step: Step, [before, after]: &[Filter; 2]) -> Step {
    let ([x, u], to) = ([before.place()[0], before.velocity()[0]], after.place()[0]);
    let step = step.put_value(value::X.is(to).inked(Role::Predicted));
    let sum = |step: Step, further| {
        let step = step.put_value(finer(value::X_BEFORE, x, further)).put_value(finer(value::U, u, further));
        step.formula(r"\mathbf{x}^- = \mathbf{F} \mathbf{x},\; \mathbf{P}^- = \mathbf{F} \mathbf{P} \mathbf{F}^\top + \mathbf{Q}")
    };
    match before {
        Filter::Velocity(..) => {
            let further = digits(to, |decimals| rounded(x, decimals) + rounded(u, decimals));
            sum(step, further).formula("x + u = {x_before} {u:signed} = {x:unit}")
        }
        Filter::Acceleration(_, estimate) => {
            let a = estimate.state[4];
            let further = digits(to, |decimals| {
                let [x, u, a] = [x, u, a].map(|of| rounded(of, decimals));
                x + u + a / 2.0
            });
            let step = sum(step, further).put_value(finer(value::A_X, a, further));
            step.formula(r"x + u + \text{½} a_x = {x_before} {u:signed} + \text{½} \cdot {a_x} = {x:unit}")
        }
        Filter::Turn(..) => {
            let step = match before.sigma() {
                Some(sigma) => modes::tell_moved_points(step, &sigma),
                None => step.formula(
                    r"\mathbf{x}^- = f(\mathbf{x}),\; \mathbf{P}^- = \mathbf{F} \mathbf{P} \mathbf{F}^\top + \mathbf{Q}",
                ),
            };
            let step = step.put(value::X_BEFORE, x).put(value::U, u);
            step.formula(r"x = {x_before},\; u = {u:unit};\; x^- = {x}")
        }
        Filter::Interacting(..) => modes::tell_prediction(step, after),
    }
}

/// Adds innovation, its covariance, and d² with its numbers beside the gate.
pub(super) fn gate(step: Step, gated: &Gated) -> Step {
    let Some(numbers) = gated.expected.update_numbers(gated.measurement()) else { return step };
    let further = numbers.digits_of_distance();
    let step = step.put_value(finer(
        shared::INNOVATION,
        Grid::from_fn(1, numbers.residual.len(), |_, y| numbers.residual[y]),
        further,
    ));
    let step = step.put_value(finer(shared::INNOVATION_COVARIANCE, numbers.covariance, further));
    let step = step.formula(of_sensor(
        gated,
        r"\mathbf{\nu} = \mathbf{z} - \mathbf{H} \mathbf{x}^-,\; \mathbf{S} = \mathbf{H} \mathbf{P}^- \mathbf{H}^\top + \mathbf{R}",
    ));
    let sides = r"d^2 = \mathbf{\nu}^\top \mathbf{S}^{-1} \mathbf{\nu} = {innovation}^\top {innovation_covariance}^{-1} {innovation}";
    let sign = if gated.is_beyond() { ">" } else { r"\le" };
    step.formula(format!("{sides} = {{squared_distance}} {sign} {{gate}}"))
}

/// Adds gain, updated state and covariance, and the update of x with its numbers.
pub(super) fn update(step: Step, (gated, numbers): (&Gated, &UpdateNumbers), after: &Filter) -> Step {
    let (gain, residual) = (numbers.gain[(0, 0)], numbers.residual[0]);
    let has_others = numbers.is_coupled();
    let (before, after) = (gated.expected.place()[0], after.place()[0]);
    let further = digits(after, |decimals| match has_others {
        true => after,
        false => {
            let gain = rounded(gain, decimals + RATIO_DECIMALS - LENGTH_DECIMALS);
            rounded(before, decimals) + gain * rounded(residual, decimals)
        }
    });
    let step = step.put_value(finer(value::X_BEFORE, before, further).inked(Role::Predicted)).put(value::X, after);
    let step = step.put_value(finer(shared::GAIN, gain, further)).put_value(finer(value::NU_X, residual, further));
    let state = r"\mathbf{K} = \mathbf{P}^- \mathbf{H}^\top \mathbf{S}^{-1},\; \mathbf{x} = \mathbf{x}^- + \mathbf{K} \mathbf{\nu}";
    let covariance = r"\mathbf{P} = (\mathbf{I} - \mathbf{K} \mathbf{H}) \mathbf{P}^- (\mathbf{I} - \mathbf{K} \mathbf{H})^\top + \mathbf{K} \mathbf{R} \mathbf{K}^\top";
    let step = step.formula(of_sensor(gated, state)).formula(of_sensor(gated, covariance));
    let others = if has_others { r" + \ldots" } else { "" };
    step.formula(format!(r"x = {{x_before}} + {{gain}} \cdot {{nu_x}}{others} = {{x}}"))
}

/// A formula with the symbols of an update by this sensor: those of the prediction, unless another sensor has updated them already.
fn of_sensor(gated: &Gated, formula: &str) -> String {
    if !gated.is_updated {
        return formula.into();
    }
    let same = formula.replace("^-", "");
    ["x", "P"].iter().fold(same, |formula, name| {
        let symbol = format!(r"\mathbf{{{name}}}");
        formula.replace(&format!("{symbol} ="), &format!(r"{symbol} \gets"))
    })
}
