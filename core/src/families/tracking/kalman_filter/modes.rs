//! The steps of sigma points and of interacting modes: cases, formulas, matrices and marks.

use super::explain::{case, value};
use super::{FrameRecord, Gated};
use crate::base::words::rounded;
use crate::geometry::Grid;
use crate::methods::kalman::{Filter, Sigma, ellipse, unscented};
use crate::methods::numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, SQUARED_DECIMALS, digits, finer};
use crate::scene::{Arrow, Matrix, Picture, Role, Scene, Shape, Step};

/// The roles of the modes in plots and on the picture.
pub(super) const ROLES: [Role; 2] = [Role::Reference, Role::Candidate];
/// The probability inside the drawn ellipse of a mode.
const CONFIDENCE: f64 = 0.95;

pub(super) fn point(place: [f64; 2]) -> [f32; 2] {
    place.map(|c| c as f32)
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The distance of the mean of the moved sigma points from the moved mean, in px.
fn curvature(sigma: &Sigma) -> f64 {
    apart(sigma.moved.first().copied().unwrap_or(sigma.mean), sigma.mean)
}

pub(super) fn tell_mixing(step: Step, before: &Filter) -> Step {
    let (Some(mixing), Some(transitions)) = (before.mixing(), before.transitions()) else { return step };
    let [[kept, to_turn], [to_velocity, kept_turn]] = mixing.weights;
    let step = step.put(value::VELOCITY_KEPT, kept).put(value::VELOCITY_MIXED, to_velocity);
    let step = step.put(value::TURN_KEPT, kept_turn).put(value::TURN_MIXED, to_turn);
    let step = put_predicted_probabilities(step.put(value::SWITCH, transitions[0][1]), mixing.modes.probabilities);
    step.say(case::MIXED)
        .formula(r"\mu_{i \text{|} j} = \frac{p_{ij} \mu_i}{\sum_i p_{ij} \mu_i}")
        .formula(r"\mu_{1 \text{|} 2} = \frac{{switch} \cdot {velocity_probability}}{{predicted_turn}} = {turn_mixed}")
}

fn put_predicted_probabilities(step: Step, [velocity, turn]: [f64; 2]) -> Step {
    step.put(value::PREDICTED_VELOCITY, velocity).put(value::PREDICTED_TURN, turn)
}

/// Tells the sigma points that are drawn, and their weights.
pub(super) fn tell_sigma_points(step: Step, before: &Filter) -> Step {
    let Some(sigma) = before.sigma() else { return step.say(case::NOT_DEFINITE) };
    let reach = sigma.drawn.iter().map(|at| apart(*at, sigma.drawn[0])).fold(0.0, f64::max);
    let step = step.put(value::SIGMA_POINTS, sigma.drawn.len()).put(value::REACH, reach);
    let step = weights(step, &sigma).say(case::SIGMA_POINTS);
    let points =
        r"\chi_0 = \mathbf{x},\; \chi_i = \mathbf{x} \pm c \, \mathbf{L}_i,\; \mathbf{P} = \mathbf{L} \mathbf{L}^\top";
    let step = step
        .formula(points)
        .formula(r"w_0 = 1 - \frac{n}{c^2} = 1 - \frac{{state_dimension}}{{squared_scale}} = {center_weight}");
    step.formula(r"w_0^{(c)} = w_0 + \beta = {center_weight} + {beta} = {center_spread}")
        .formula(r"w_i = w_i^{(c)} = \frac{1}{2 c^2} = {pair_weight}")
}

fn weights(step: Step, sigma: &Sigma) -> Step {
    let unscented::Weights { center, center_spread, pair } = sigma.weights;
    let step = step.put(value::STATE_DIMENSION, sigma.drawn.len() / 2);
    let step = step.put(value::SQUARED_SCALE, unscented::SQUARED_DISTANCE).fact(value::BETA, unscented::BETA);
    let step = step.fact(value::CENTER_WEIGHT, center).fact(value::CENTER_SPREAD, center_spread);
    step.fact(value::PAIR_WEIGHT, pair)
}

/// Tells the prediction by sigma points, and its difference from one by the Jacobian.
pub(super) fn tell_moved_points(step: Step, sigma: &Sigma) -> Step {
    let step = weights(step.put(value::CURVATURE, curvature(sigma)), sigma).say(case::BENT);
    step.formula(r"\mathbf{x}^- = \sum_i w_i f(\chi_i),\; w_0 = {center_weight},\; w_i = {pair_weight}")
        .formula(
            r"\mathbf{P}^- = \sum_i w_i^{(c)} (f(\chi_i) - \mathbf{x}^-)(f(\chi_i) - \mathbf{x}^-)^\top + \mathbf{Q},\; w_0^{(c)} = w_0 + \beta = {center_spread}",
        )
        .formula(r"\mathbf{A} = \sum_i w_i (f(\chi_i) - \mathbf{x}^-)(\chi_i - \mathbf{x})^\top \mathbf{P}^{-1}")
}

pub(super) fn tell_update(step: Step, gated: &Gated, after: &[Filter; 2]) -> Step {
    let Some(before) = gated.expected.modes() else { return step };
    let of = [(value::VELOCITY_GAIN, value::VELOCITY_POSITION), (value::TURN_GAIN, value::TURN_POSITION)];
    let step = of.into_iter().zip(before.iter().zip(after)).fold(step, |step, ((gain, position), (before, after))| {
        let step = step.fact(position, after.place());
        match before.update_numbers(gated.measurement()) {
            Some(numbers) => step.put(gain, numbers.gain[(0, 0)]),
            None => step,
        }
    });
    step.say(case::MODES_UPDATED)
}

/// Tells the probabilities of the modes after a measurement.
pub(super) fn tell_weights(step: Step, gated: &Gated, after: &Filter) -> Step {
    let logs = gated.expected.log_likelihoods(gated.measurement());
    let (Some(logs), Some(before), Some(now)) = (logs, gated.expected.probabilities(), after.probabilities()) else {
        return step;
    };
    let step = tell_change(put_predicted_probabilities(step, before), logs, [before, now]).say(case::WEIGHED);
    step.put(value::LIKELIHOOD_RATIO, logs[1] - logs[0])
        .formula(r"\mu_j \gets \frac{\mu_j \Lambda_j}{\sum_j \mu_j \Lambda_j},\; \Lambda_j = N(\nu_j; 0, \mathbf{S}_j)")
        .formula(
            r"\mu_2 = {predicted_turn} \text{ before; } \ln \Lambda_2 - \ln \Lambda_1 = {likelihood_ratio};\; \mu_2 = {turn_probability}",
        )
}

/// Tells the change of the probabilities of the modes, before and after the log-likelihoods, to the decimals that are shown.
fn tell_change(step: Step, logs: [f64; 2], [before, now]: [[f64; 2]; 2]) -> Step {
    let better = usize::from(logs[1] > logs[0]);
    let step = step.put(value::VELOCITY_LIKELIHOOD, logs[0]).put(value::TURN_LIKELIHOOD, logs[1]);
    let step = step.put(value::BETTER_BEFORE, before[better]);
    let step = step.put_value(value::BETTER.is(now[better]).inked(ROLES[better])).say(case::LIKELIHOODS);
    let is_same = |a: f64, b: f64, decimals| rounded(a, decimals) == rounded(b, decimals);
    let stays = is_same(before[better], now[better], RATIO_DECIMALS);
    if stays && is_same(logs[0], logs[1], SQUARED_DECIMALS) {
        return step.say(case::EQUALLY_LIKELY);
    }
    let step = step.say(if better == 0 { case::VELOCITY_LIKELIER } else { case::TURN_LIKELIER });
    step.say(if stays { case::STAYS } else { case::RISES })
}

/// Adds the predicted x as the mean of the predictions of both modes.
pub(super) fn tell_prediction(step: Step, after: &Filter) -> Step {
    let (Some(modes), Some(weights)) = (after.modes(), after.probabilities()) else { return step };
    let all = [0, 1].map(|i| modes[i].place()[0]);
    let share = |i: usize, decimals: usize| rounded(weights[i], decimals + RATIO_DECIMALS - LENGTH_DECIMALS);
    let term = |i, decimals| share(i, decimals) * rounded(all[i], decimals);
    let further = digits(after.place()[0], |decimals| term(0, decimals) + term(1, decimals));
    let step = step.put_value(finer(value::VELOCITY_X, all[0], further));
    let step = step.put_value(finer(value::TURN_X, all[1], further));
    let step = step.put_value(finer(value::VELOCITY_PROBABILITY, weights[0], further));
    let step = step.put_value(finer(value::TURN_PROBABILITY, weights[1], further));
    step.formula(r"\mathbf{x}_j^- = f_j(\mathbf{x}_{0j}),\; \mathbf{x}^- = \sum_j \mu_j \mathbf{x}_j^-")
        .formula(r"x^- = {velocity_probability} \cdot {velocity_x} + {turn_probability} \cdot {turn_x} = {x}")
}

pub(super) fn probable(step: Step, filter: &Filter) -> Step {
    let Some([velocity, turn]) = filter.probabilities() else { return step };
    step.fact(value::VELOCITY_PROBABILITY, velocity).fact(value::TURN_PROBABILITY, turn)
}

/// Tells which mode was active, or how much the sigma points changed, at the end of a run.
pub(super) fn conclude<'a>(step: Step, records: impl Iterator<Item = &'a FrameRecord>, noise_px: f64) -> Step {
    let filters: Vec<Filter> = records.filter_map(|record| record.filtered).collect();
    let probabilities: Vec<[f64; 2]> = filters.iter().filter_map(Filter::probabilities).collect();
    if !probabilities.is_empty() {
        let turning = probabilities.iter().filter(|[velocity, turn]| turn > velocity).count();
        return step.put(value::TURNING, turning).put(value::FRAMES, filters.len()).say(case::TURNS);
    }
    let most = filters.iter().filter_map(Filter::sigma).map(|sigma| curvature(&sigma)).reduce(f64::max);
    let Some(most) = most else { return step };
    let is_little = most < 0.1 * noise_px;
    let step = step.put(value::CURVATURE, most).say(case::BENDS);
    step.say(if is_little { case::BENDS_LITTLE } else { case::BENDS_MUCH })
}

fn modes_matrix(symbol: &'static str, name: &'static str, entries: Grid<f64>) -> Matrix {
    const NAMES: [&str; 2] = ["velocity", "turn"];
    let columns = if entries.width() == 2 { &NAMES[..] } else { &[] };
    let matrix = Matrix::new(symbol, name, entries).with_decimals(RATIO_DECIMALS);
    matrix.with_rows(NAMES).with_columns(columns.iter().copied())
}

/// The probabilities of the modes as a column, with those that differ from `before` lit.
pub(super) fn probabilities(filter: &Filter, before: Option<&Filter>) -> Option<Matrix> {
    let column = |of: [f64; 2]| Grid::from_fn(1, 2, |_, y| of[y]);
    let now = filter.probabilities()?;
    let before = before.and_then(Filter::probabilities);
    let changed = before.map(|before| Grid::from_fn(1, 2, |_, y| (now[y] - before[y]).abs() > 1e-12));
    Some(Matrix { changed, ..modes_matrix("μ", "mode probabilities", column(now)) })
}

pub(super) fn mixing_matrices(before: &Filter) -> Vec<Matrix> {
    let (Some(mixing), Some(transitions)) = (before.mixing(), before.transitions()) else { return Vec::new() };
    let square = |of: [[f64; 2]; 2]| Grid::from_fn(2, 2, |x, y| of[y][x]);
    let weights = modes_matrix("M", "mixing weights μ(i|j)", square(mixing.weights));
    let transitions = modes_matrix("Π", "mode transition probabilities", square(transitions));
    probabilities(before, None).into_iter().chain([transitions, weights]).collect()
}

/// Draws the estimates of the modes with their ellipses.
pub(super) fn draw(filter: &Filter, scene: &mut Scene) {
    let Some(modes) = filter.modes() else { return };
    for ((mode, role), meaning) in modes.iter().zip(ROLES).zip(["mode: constant velocity", "mode: coordinated turn"]) {
        let Some(shape) = ellipse(mode.place(), mode.place_covariance(), CONFIDENCE) else { continue };
        scene.mark(Picture::CURRENT, role, shape);
        scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(vec![point(mode.place())]));
    }
}

/// Draws the sigma points of a prediction: drawn, or moved too.
pub(super) fn draw_points(before: &Filter, are_moved: bool, scene: &mut Scene) {
    let Some(Sigma { drawn, moved, .. }) = before.sigma() else { return };
    scene.draw(
        Picture::CURRENT,
        (Role::Candidate, "sigma points"),
        Shape::Points(drawn.iter().copied().map(point).collect()),
    );
    if !are_moved {
        return;
    }
    let arrow = |(from, to): (&[f64; 2], &[f64; 2])| Arrow { from: point(*from), to: point(*to) };
    scene.mark(Picture::CURRENT, Role::Window, Shape::Arrows(drawn.iter().zip(&moved).map(arrow).collect()));
    scene.draw(
        Picture::CURRENT,
        (Role::Window, "moved sigma points"),
        Shape::Points(moved.into_iter().map(point).collect()),
    );
}

/// The probability of the turn in each frame, and of constant velocity.
pub(super) fn lines<'a>(
    records: impl Iterator<Item = (f32, &'a FrameRecord)>,
) -> Vec<(&'static str, Role, Vec<[f32; 2]>)> {
    let of: Vec<_> = records.filter_map(|(x, record)| Some((x, record.filtered.as_ref()?.probabilities()?))).collect();
    if of.is_empty() {
        return Vec::new();
    }
    let line = |i: usize| of.iter().map(|(x, probabilities)| [*x, probabilities[i] as f32]).collect();
    vec![("constant velocity", ROLES[0], line(0)), ("coordinated turn", ROLES[1], line(1))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tie_is_no_win() {
        let step = |[velocity, turn]: [f64; 2]| {
            let step = Step::at(super::super::line::WEIGH_MODES).put(value::VELOCITY_PROBABILITY, velocity);
            step.put(value::TURN_PROBABILITY, turn)
        };
        let of = |logs, before, now| tell_change(step(now), logs, [before, now]);
        let tie = of([-5.461, -5.4612], [0.5, 0.5], [0.50005, 0.49995]);
        assert!(tie.is(case::EQUALLY_LIKELY) && !tie.is(case::RISES), "{}", tie.sentence.plain());
        let win = of([-5.0, -4.0], [0.5, 0.5], [0.269, 0.731]);
        assert!(win.is(case::TURN_LIKELIER) && win.is(case::RISES), "{}", win.sentence.plain());
        assert!(win.sentence.plain().contains("0.500 → 0.731"), "{}", win.sentence.plain());
        let sure = of([-5.0, -4.0], [0.0, 1.0], [0.0, 1.0]);
        assert!(sure.is(case::STAYS) && sure.sentence.plain().contains("stays at 1.000"), "{}", sure.sentence.plain());
    }
}
