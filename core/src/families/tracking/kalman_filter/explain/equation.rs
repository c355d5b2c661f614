//! The formulas of the Kalman filter with their numbers.

use crate::base::words::{further_digits, rounded, summands};
use crate::families::tracking::kalman_filter::{Event, Gated, KalmanFilter, modes};
use crate::methods::kalman::{Filter, MotionModel};
use crate::methods::numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, fixed, px, squared};
use crate::scene::{Math, Readout, Role};

impl KalmanFilter {
    /// The formula of the step, with the numbers along x.
    pub(super) fn equation(&self, event: Option<&Event>) -> Option<Readout> {
        let lines = match event? {
            Event::Mixed(before) => modes::mixing_formula(before)?,
            Event::Drawn(_) => modes::points_formula(),
            Event::Weighed(update) => modes::weights_formula(&update.0, &update.1)?,
            Event::Updated(update) if update.1.modes().is_some() => return None,
            Event::Predicted(both) if both[1].modes().is_some() => modes::prediction_formula(&both[1])?,
            Event::Predicted(both) => {
                let first = match self.motion {
                    MotionModel::Unscented => modes::moments_formula(),
                    motion => prediction(motion),
                };
                vec![first, prediction_along_x(&both[0], &both[1])]
            }
            Event::Gated(gated) => gate(gated)?,
            Event::Updated(update) => self::update(&update.0, &update.1)?,
            _ => return None,
        };
        Some(Readout::Equation(lines))
    }
}

fn text(text: &str) -> Math {
    Math::text(text)
}

/// A symbol of a vector or a matrix.
fn bold(symbol: &'static str) -> Math {
    Math::Bold(symbol)
}

fn transposed(matrix: Math) -> Math {
    Math::power(matrix, text("T"))
}

/// State and covariance of the prediction. A turn is no linear function of the state: the extended filter applies f, and its
/// Jacobian F to P.
fn prediction(motion: MotionModel) -> Math {
    let transition = match motion {
        MotionModel::Turn => vec![Math::Var("f"), text("("), bold("x"), text(")")],
        _ => vec![bold("F"), bold("x")],
    };
    let covariance = vec![bold("P⁻"), text(" = "), bold("F"), bold("P"), transposed(bold("F")), text(" + "), bold("Q")];
    let state = vec![bold("x⁻"), text(" = "), Math::Row(transition), text(",  ")];
    Math::Row([state, covariance].concat())
}

/// The symbols of state and covariance before an update: those of the prediction, unless another sensor has updated them already.
fn before_update(gated: &Gated) -> [Math; 2] {
    if gated.is_updated { ["x", "P"].map(bold) } else { ["x⁻", "P⁻"].map(bold) }
}

/// Innovation, its covariance, and d² with the gate.
fn gate(gated: &Gated) -> Option<Vec<Math>> {
    let numbers = gated.expected.update_numbers(gated.measurement())?;
    let [x, p] = before_update(gated);
    let innovation = [bold("ν"), text(" = "), bold("z"), text(" − "), bold("H"), x, text(",  ")];
    let covariance = [bold("S"), text(" = "), bold("H"), p, transposed(bold("H")), text(" + "), bold("R")];
    let sign = if gated.is_beyond() { ">" } else { "≤" };
    let decision = format!(" = {} {sign} {}", squared(numbers.squared_distance), squared(gated.limit));
    let distance = [
        Math::squared(Math::Var("d")),
        text(" = "),
        transposed(bold("ν")),
        Math::power(bold("S"), text("−1")),
        bold("ν"),
        text(&decision),
    ];
    Some(vec![Math::Row(innovation.into_iter().chain(covariance).collect()), Math::Row(distance.into())])
}

/// Gain, updated state and covariance, and the update of x with its numbers.
fn update(gated: &Gated, after: &Filter) -> Option<Vec<Math>> {
    let numbers = gated.expected.update_numbers(gated.measurement())?;
    let (gain, residual) = (numbers.gain[(0, 0)], numbers.residual[0]);
    let [x, p] = before_update(gated);
    // Of a second sensor, the same symbols stand before and after the update.
    let becomes = || text(if gated.is_updated { " ← " } else { " = " });
    let state = [
        bold("K"),
        text(" = "),
        p.clone(),
        transposed(bold("H")),
        Math::power(bold("S"), text("−1")),
        text(",  "),
        bold("x"),
        becomes(),
        x,
        text(" + "),
        bold("K"),
        bold("ν"),
    ];
    let kept = || Math::Row(vec![text("("), bold("I"), text(" − "), bold("K"), bold("H"), text(")")]);
    let covariance =
        [bold("P"), becomes(), kept(), p, transposed(kept()), text(" + "), bold("K"), bold("R"), transposed(bold("K"))];
    let has_others = (1..numbers.residual.len()).any(|i| numbers.gain[(0, i)] * numbers.residual[i] != 0.0);
    let (open, close) = if residual < 0.0 { ("(", ")") } else { ("", "") };
    let (before, after) = (gated.expected.place()[0], px(after.place()[0]));
    let [length, share] = [LENGTH_DECIMALS, RATIO_DECIMALS];
    let further = further_digits(|further| {
        let [before, residual] = [before, residual].map(|of| rounded(of, length + further));
        has_others || px(before + rounded(gain, share + further) * residual) == after
    });
    let along_x = [
        Math::Var("x"),
        text(" = "),
        Math::ink(Role::Predicted, fixed(before, length + further)),
        text(&format!(" + {} · {open}", fixed(gain, share + further))),
        // As the arrow of the innovation on the stage.
        Math::ink(Role::Best, fixed(residual, length + further)),
        text(&format!("{close}{} = ", if has_others { " + …" } else { "" })),
        Math::ink(Role::Estimate, after),
    ];
    Some([state.into(), covariance.into(), along_x.into()].map(Math::Row).into())
}

/// The predicted x with its numbers: of a linear motion model as the sum that it is.
fn prediction_along_x(before: &Filter, after: &Filter) -> Math {
    let text = |text: String| Math::text(text);
    let [x, u] = [before.place()[0], before.velocity()[0]];
    let to = px(after.place()[0]);
    let predicted = Math::ink(Role::Predicted, to.clone());
    let sum = || vec![Math::Var("x"), text(" + ".into()), Math::Var("u")];
    Math::Row(match before {
        Filter::Velocity(..) => {
            let terms = summands([x, u], LENGTH_DECIMALS).concat();
            [sum(), vec![text(format!(" = {terms} = ")), predicted, text(" px".into())]].concat()
        }
        Filter::Acceleration(_, estimate) => {
            let a = estimate.state[4];
            let further = further_digits(|further| {
                let [x, u, a] = [x, u, a].map(|of| rounded(of, LENGTH_DECIMALS + further));
                px(x + u + a / 2.0) == to
            });
            let number = |of: f64| fixed(of.abs(), LENGTH_DECIMALS + further);
            let sign = |of: f64| if of < 0.0 { "−" } else { "+" };
            let minus = if x < 0.0 { "−" } else { "" };
            let acceleration = Math::indexed(Math::Var("a"), Math::Var("x"));
            let numbers = format!(" = {minus}{} {} {} {} ½ · {} = ", number(x), sign(u), number(u), sign(a), number(a));
            [sum(), vec![text(" + ½ ".into()), acceleration, text(numbers), predicted, text(" px".into())]].concat()
        }
        Filter::Turn(..) | Filter::Interacting(..) => vec![
            Math::Var("x"),
            text(format!(" = {}, u = {} px/frame; predicted ", px(x), px(u))),
            Math::Var("x"),
            text(" = ".into()),
            predicted,
        ],
    })
}
