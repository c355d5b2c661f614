//! The formulas of the Kalman tracker with their numbers.

use super::KalmanTracker;
use super::association::Costs;
use super::vocabulary::value;
use crate::base::words::rounded;
use crate::geometry::Grid;
use crate::methods::kalman::UpdateNumbers;
use crate::methods::numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, digits, finer};
use crate::scene::Step;

impl KalmanTracker {
    /// Writes d² of a pair with the numbers of its innovation.
    pub(super) fn distance_formula(&self, step: Step, costs: &Costs, [row, column]: [usize; 2]) -> Step {
        let measured = self.measurement(costs, row, column);
        let Some(numbers) = costs.tracks[row].filter.update_numbers(&measured) else { return step };
        let innovation = Grid::from_fn(1, numbers.residual.len(), |_, y| numbers.residual[y]);
        let further = numbers.digits_of_distance();
        let step = step.put_value(finer(value::INNOVATION, innovation, further));
        let step = step.put_value(finer(value::INNOVATION_COVARIANCE, numbers.covariance, further));
        let step = step.put(value::D_SQUARED, numbers.squared_distance);
        step.formula(
            r"d^2 = \mathbf{\nu}^\top \mathbf{S}^{-1} \mathbf{\nu} = {innovation}^\top {innovation_covariance}^{-1} {innovation} = {d_squared}",
        )
    }
}

/// Writes the update of the state, and that of x with its numbers.
pub(super) fn update_formula(step: Step, numbers: &UpdateNumbers, [predicted, detected, updated]: [f64; 3]) -> Step {
    let (gain, has_others) = (numbers.gain[(0, 0)], numbers.is_coupled());
    let further = digits(updated, |decimals| match has_others {
        true => updated,
        false => {
            let [from, to] = [predicted, detected].map(|x| rounded(x, decimals));
            from + rounded(gain, decimals + RATIO_DECIMALS - LENGTH_DECIMALS) * (to - from)
        }
    });
    let step = step.put_value(finer(value::GAIN, gain, further)).put(value::X_UPDATED, updated);
    let step = step.put_value(finer(value::X_PREDICTED, predicted, further));
    let step = step.put_value(finer(value::X_DETECTED, detected, further));
    let step = step.formula(r"\mathbf{x} = \mathbf{x}^- + \mathbf{K} (\mathbf{z} - \mathbf{H} \mathbf{x}^-)");
    let others = if has_others { r" + \ldots" } else { "" };
    step.formula(format!(
        r"x = {{x_predicted}} + {{gain}} \cdot ({{x_detected}} - {{x_predicted}}){others} = {{x_updated}}"
    ))
}
