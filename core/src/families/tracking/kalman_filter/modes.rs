//! The steps of sigma points and of interacting modes in words, formulas, matrices and marks.

use super::{FrameRecord, Gated};
use crate::base::words::{counted, fixed, place};
use crate::geometry::Grid;
use crate::methods::kalman::{Filter, Sigma, ellipse};
use crate::methods::numbers::{RATIO_DECIMALS, px, ratio};
use crate::scene::{Arrow, Fact, Math, Matrix, Picture, Role, Scene, Sentence, Shape};

/// The modes in sentences, in the order of their filters.
const NAMES: [&str; 2] = ["constant velocity", "the coordinated turn"];
/// Their roles in plots and on the picture.
const ROLES: [Role; 2] = [Role::Reference, Role::Candidate];
/// The probability inside the drawn ellipse of a mode.
const CONFIDENCE: f64 = 0.95;

fn point(place: [f64; 2]) -> [f32; 2] {
    place.map(|c| c as f32)
}

fn text(text: impl Into<String>) -> Math {
    Math::text(text)
}

/// The distance of the mean of the moved sigma points from the moved mean, in px.
fn curvature(sigma: &Sigma) -> f64 {
    let center = sigma.moved.first().copied().unwrap_or(sigma.mean);
    (center[0] - sigma.mean[0]).hypot(center[1] - sigma.mean[1])
}

/// The mixing of the modes.
pub(super) fn mixed(before: &Filter) -> Sentence {
    let said = Sentence::default();
    let (Some(mixing), Some(transitions)) = (before.mixing(), before.transitions()) else { return said };
    let [[kept, to_turn], [to_velocity, kept_turn]] = mixing.weights.map(|row| row.map(ratio));
    let [velocity, turn] = mixing.modes.probabilities.map(ratio);
    said.text("Mixing: ")
        .ink(ROLES[0], NAMES[0])
        .text(format!(" begins the frame with {kept} of its own estimate and {to_velocity} of that of the turn, "))
        .ink(ROLES[1], NAMES[1])
        .text(format!(" with {kept_turn} of its own and {to_turn} of the other. "))
        .text(format!(
            "A switch has a probability of {}, so the predicted mode probabilities are {velocity} and {turn}. Without mixing, the mode that \
             did not fit would keep the errors of its past.",
            ratio(transitions[0][1])
        ))
}

/// The sigma points that are drawn.
pub(super) fn drawn(before: &Filter) -> Sentence {
    let said = Sentence::default();
    let Some(sigma) = before.sigma() else {
        return said
            .text("P is not positive definite, so sigma points cannot be drawn: the Jacobian predicts this frame.");
    };
    let far =
        sigma.drawn.iter().map(|at| (at[0] - sigma.drawn[0][0]).hypot(at[1] - sigma.drawn[0][1])).fold(0.0, f64::max);
    said.ink(Role::Candidate, format!("{} sigma points", sigma.drawn.len())).text(format!(
        " have the mean x and the covariance P: x itself, and a pair about it for each column of the Cholesky factor of P, in position up \
         to {} px away. Each will be moved by the turn itself, so no derivative is needed.",
        px(far)
    ))
}

/// What the prediction by sigma points has that one by the Jacobian has not.
pub(super) fn bent(before: &Filter) -> String {
    before.sigma().map_or_else(String::new, |sigma| {
        format!(
            " The mean of the moved sigma points lies {} px from f(x): the curvature of the turn, which a Jacobian omits.",
            px(curvature(&sigma))
        )
    })
}

/// The update of each mode.
pub(super) fn updated(gated: &Gated, after: &Filter) -> Option<Sentence> {
    let (before, after) = (gated.expected.modes()?, after.modes()?);
    let said = Sentence::default().text("Each mode is updated by its own gain: ");
    let gain = |mode: &Filter| mode.update_numbers(gated.measurement()).map_or(0.0, |numbers| numbers.gain[(0, 0)]);
    let part = |said: Sentence, i: usize| {
        said.ink(ROLES[i], NAMES[i]).text(format!(
            " with {} along x to {} px",
            ratio(gain(&before[i])),
            place(point(after[i].place()))
        ))
    };
    let said = part(part(said, 0).text(", "), 1);
    Some(said.text(". The gain is larger where the model is less certain of its prediction."))
}

/// The probabilities of the modes after a measurement.
pub(super) fn weighed(gated: &Gated, after: &Filter) -> Sentence {
    let said = Sentence::default();
    let logs = gated.expected.log_likelihoods(gated.measurement());
    let (Some(logs), Some(before), Some(now)) = (logs, gated.expected.probabilities(), after.probabilities()) else {
        return said;
    };
    let said = said
        .text(format!("Log-likelihood of the measurement: {} for ", fixed(logs[0], 2)))
        .ink(ROLES[0], NAMES[0])
        .text(format!(" and {} for ", fixed(logs[1], 2)))
        .ink(ROLES[1], NAMES[1]);
    compared(said, logs, [before, now])
        .text(". The estimate is the mean of both modes with these weights, ")
        .ink(Role::Estimate, format!("{} px", place(point(after.place()))))
        .text(".")
}

/// What the log-likelihoods do to the probabilities of the modes, before and after them, to the decimals that are shown.
fn compared(said: Sentence, logs: [f64; 2], [before, now]: [[f64; 2]; 2]) -> Sentence {
    let better = usize::from(logs[1] > logs[0]);
    let [was, is] = [before[better], now[better]].map(ratio);
    if fixed(logs[0], 2) == fixed(logs[1], 2) && was == is {
        return said.text(format!(
            ". It is equally likely under both, so the mode probabilities stay at {} and {}",
            ratio(now[0]),
            ratio(now[1])
        ));
    }
    let said = said.text(format!(". It is more likely under {}, so that probability ", NAMES[better]));
    match was == is {
        true => said.text("stays at ").ink(ROLES[better], is),
        false => said.text("rises: ").ink(ROLES[better], format!("{was} → {is}")),
    }
}

/// The predicted x as the mean of the predictions of both modes.
pub(super) fn prediction_formula(after: &Filter) -> Option<Vec<Math>> {
    let (modes, probabilities) = (after.modes()?, after.probabilities()?);
    let hat = |index: &'static str| Math::indexed(Math::Bold("x"), text(index));
    let general = Math::Row(vec![
        hat("j"),
        text(" ← "),
        Math::indexed(Math::Var("f"), Math::Var("j")),
        text("("),
        hat("0j"),
        text("),  "),
        Math::Bold("x"),
        text(" = "),
        Math::Sum(Box::new(Math::Var("j"))),
        of("μ", "j"),
        text(" "),
        hat("j"),
    ]);
    let part = |i: usize| Math::ink(ROLES[i], format!("{} · {}", fixed(probabilities[i], 3), px(modes[i].place()[0])));
    let numbers = Math::Row(vec![
        text("predicted "),
        Math::Var("x"),
        text(" = "),
        part(0),
        text(" + "),
        part(1),
        text(" = "),
        Math::ink(Role::Predicted, px(after.place()[0])),
    ]);
    Some(vec![general, numbers])
}

/// The probabilities of the modes of a filter.
pub(super) fn facts(filter: &Filter) -> Option<Fact> {
    let [velocity, turn] = filter.probabilities()?.map(ratio);
    Some(Fact::new("Mode probabilities", format!("velocity {velocity}, turn {turn}"), None))
}

/// At the end of a run: which mode was active, or what the sigma points were good for.
pub(super) fn concluded<'a>(records: impl Iterator<Item = &'a FrameRecord>, noise_px: f64) -> String {
    let filters: Vec<Filter> = records.filter_map(|record| record.filtered).collect();
    let turning = filters.iter().filter_map(Filter::probabilities).filter(|[velocity, turn]| turn > velocity).count();
    if filters.iter().any(|filter| filter.probabilities().is_some()) {
        return format!(
            " The coordinated turn was the more probable mode in {turning} of {}. Whether two modes were worth it, the RMS error of one \
             motion model alone shows.",
            counted(filters.len(), "frame")
        );
    }
    let bends: Vec<f64> = filters.iter().filter_map(Filter::sigma).map(|sigma| curvature(&sigma)).collect();
    let Some(most) = bends.iter().copied().reduce(f64::max) else { return String::new() };
    let said = format!(" The sigma points moved the predicted mean by up to {} px, ", px(most));
    said + match most < 0.1 * noise_px {
        true => "little beside the measurement noise: an extended filter does as well here.",
        false => "which is not little beside the measurement noise: an extended filter is biased by it.",
    }
}

/// x(j), μ(i|j) and so on.
fn of(name: &'static str, index: &'static str) -> Math {
    Math::indexed(Math::Var(name), text(index))
}

/// The formula of the mixing, with the numbers of the turn.
pub(super) fn mixing_formula(before: &Filter) -> Option<Vec<Math>> {
    let (mixing, transitions, [velocity, _]) = (before.mixing()?, before.transitions()?, before.probabilities()?);
    let general = Math::Row(vec![
        of("μ", "i|j"),
        text(" = "),
        Math::over(
            Math::Row(vec![of("p", "ij"), text(" "), of("μ", "i")]),
            Math::Row(vec![Math::Sum(Box::new(Math::Var("i"))), of("p", "ij"), text(" "), of("μ", "i")]),
        ),
    ]);
    let numbers = Math::Row(vec![
        of("μ", "1|2"),
        text(" = "),
        Math::over(
            text(format!("{} · {}", ratio(transitions[0][1]), ratio(velocity))),
            text(ratio(mixing.modes.probabilities[1])),
        ),
        text(" = "),
        Math::ink(ROLES[1], ratio(mixing.weights[0][1])),
    ]);
    Some(vec![general, numbers])
}

/// The formula of the sigma points.
pub(super) fn points_formula() -> Vec<Math> {
    let column = || Math::Row(vec![text("c "), Math::indexed(Math::Bold("L"), Math::Var("i"))]);
    vec![Math::Row(vec![
        Math::Var("χ"),
        text(" = "),
        Math::Bold("x"),
        text(",  "),
        Math::Bold("x"),
        text(" ± "),
        column(),
        text(",  "),
        Math::Bold("P"),
        text(" = "),
        Math::Bold("L"),
        Math::power(Math::Bold("L"), text("T")),
    ])]
}

/// The prediction by sigma points.
pub(super) fn moments_formula() -> Math {
    let moved = || Math::Row(vec![Math::Var("f"), text("("), Math::indexed(Math::Var("χ"), Math::Var("i")), text(")")]);
    let sum = || Math::Sum(Box::new(Math::Var("i")));
    let weight = || Math::indexed(Math::Var("w"), Math::Var("i"));
    let off = || Math::Row(vec![text("("), moved(), text(" − "), Math::Bold("x"), text(")")]);
    Math::Row(vec![
        Math::Bold("x"),
        text(" ← "),
        sum(),
        weight(),
        text(" "),
        moved(),
        text(",  "),
        Math::Bold("P"),
        text(" ← "),
        sum(),
        weight(),
        text(" "),
        off(),
        Math::power(off(), text("T")),
        text(" + "),
        Math::Bold("Q"),
    ])
}

/// The update of the probabilities, with the numbers of the turn.
pub(super) fn weights_formula(gated: &Gated, after: &Filter) -> Option<Vec<Math>> {
    let logs = gated.expected.log_likelihoods(gated.measurement())?;
    let (before, now) = (gated.expected.probabilities()?, after.probabilities()?);
    let general = Math::Row(vec![
        of("μ", "j"),
        text(" ← "),
        Math::over(
            Math::Row(vec![of("μ", "j"), text(" "), of("Λ", "j")]),
            Math::Row(vec![Math::Sum(Box::new(Math::Var("j"))), of("μ", "j"), text(" "), of("Λ", "j")]),
        ),
        text(",  "),
        of("Λ", "j"),
        text(" = N("),
        of("ν", "j"),
        text("; 0, "),
        of("S", "j"),
        text(")"),
    ]);
    let numbers = Math::Row(vec![
        of("μ", "2"),
        text(format!(" = {} before; ln ", ratio(before[1]))),
        of("Λ", "2"),
        text(" − ln "),
        of("Λ", "1"),
        text(format!(" = {}; ", fixed(logs[1] - logs[0], 2))),
        of("μ", "2"),
        text(" = "),
        Math::ink(ROLES[1], ratio(now[1])),
    ]);
    Some(vec![general, numbers])
}

fn modes_matrix(symbol: &'static str, name: &'static str, entries: Grid<f64>) -> Matrix {
    let names = vec!["velocity".to_owned(), "turn".to_owned()];
    let columns = if entries.width() == 2 { names.clone() } else { Vec::new() };
    Matrix { symbol, name, role: None, entries, rows: names, columns, changed: None, decimals: Some(RATIO_DECIMALS) }
}

/// The probabilities of the modes as a column, with those that differ from `before` lit.
pub(super) fn probabilities(filter: &Filter, before: Option<&Filter>) -> Option<Matrix> {
    let column = |of: [f64; 2]| Grid::from_fn(1, 2, |_, y| of[y]);
    let now = filter.probabilities()?;
    let before = before.and_then(Filter::probabilities);
    let changed = before.map(|before| Grid::from_fn(1, 2, |_, y| (now[y] - before[y]).abs() > 1e-12));
    Some(Matrix { changed, ..modes_matrix("μ", "mode probabilities", column(now)) })
}

/// The matrices of the mixing.
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
        scene.mark(Picture::CURRENT, role, Shape::Points(vec![point(mode.place())]));
        scene.legend(role, meaning);
    }
}

/// Draws the sigma points of a prediction: drawn, or moved too.
pub(super) fn draw_points(before: &Filter, are_moved: bool, scene: &mut Scene) {
    let Some(Sigma { drawn, moved, .. }) = before.sigma() else { return };
    scene.mark(Picture::CURRENT, Role::Candidate, Shape::Points(drawn.iter().copied().map(point).collect()));
    scene.legend(Role::Candidate, "sigma points");
    if !are_moved {
        return;
    }
    let arrow = |(from, to): (&[f64; 2], &[f64; 2])| Arrow { from: point(*from), to: point(*to) };
    scene.mark(Picture::CURRENT, Role::Window, Shape::Arrows(drawn.iter().zip(&moved).map(arrow).collect()));
    scene.mark(Picture::CURRENT, Role::Window, Shape::Points(moved.into_iter().map(point).collect()));
    scene.legend(Role::Window, "moved sigma points");
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
        let of = |logs, before, now| compared(Sentence::default(), logs, [before, now]).plain();
        let tie = of([-5.461, -5.4612], [0.5, 0.5], [0.50005, 0.49995]);
        assert!(tie.contains("equally likely under both") && !tie.contains("rises"), "{tie}");
        let win = of([-5.0, -4.0], [0.5, 0.5], [0.269, 0.731]);
        assert!(win.contains("more likely under the coordinated turn") && win.contains("0.500 → 0.731"), "{win}");
        let sure = of([-5.0, -4.0], [0.0, 1.0], [0.0, 1.0]);
        assert!(sure.contains("stays at 1.000"), "{sure}");
    }
}
