//! The classification of a pixel by its modes.

use super::model::{Matched, Verdict};
use super::{MAX_SIGMAS, Mixture, MixtureOfGaussians, Mode};
use crate::geometry::Grid;
use crate::methods::subtraction::{self, Cases, Explanation, Probe, class, put_pixel, tuple};
use crate::scene::{Case, Decimals, Matrix, Number, Readout, Role, Step, Unit, Value, Variable};

/// The unit of a distance in standard deviations.
const SIGMAS: Unit = Unit::new("σ", 2);
/// The unit of a share that was set.
const SHARE: Unit = Unit { name: "%", decimals: Decimals::AtMost(4) };

crate::variables! {
    /// The modes of the pixel.
    MODES: "Modes", "K", Unit::count("mode");
    /// The heaviest modes of the pixel, which are the background.
    BACKGROUND_MODES: "Background modes", "", Unit::count("mode"), Role::Predicted;
    /// The number of the heaviest mode within the threshold.
    MATCHED_MODE: "Matched mode", "", Unit::WHOLE;
    /// The distance of the pixel from the matched mode.
    DISTANCE: "Distance", r"|I - \mu| / \sigma", SIGMAS;
    /// The distance of the pixel from the nearest mode.
    NEAREST: "", "", SIGMAS;
    /// The share of the weight that is background.
    BACKGROUND_RATIO: "", "", SHARE;
    /// The weight of the matched mode.
    WEIGHT: "", "w", Unit::RATIO, Role::Predicted;
    /// The mean of the matched mode.
    MEAN: "", r"\mu", Unit::FINE, Role::Predicted;
    /// The standard deviation of the matched mode.
    SIGMA: "", r"\sigma", Unit::FINE, Role::Predicted;
    /// The weight of the mode after the update.
    NEW_WEIGHT: "", "w", Unit::RATIO, Role::Estimate;
    /// The mean of the mode after the update.
    NEW_MEAN: "", r"\mu", Unit::FINE, Role::Estimate;
    /// The standard deviation of the mode after the update.
    NEW_SIGMA: "", r"\sigma", Unit::FINE, Role::Estimate;
    /// The standard deviation that the update gives without its limits.
    FREE_SIGMA: "", r"\sigma", Unit::FINE, Role::Rejected;
    /// The maximum standard deviation of a mode as a multiple of that of a new one.
    MOST_SIGMAS: "", "", Unit::SET;
    /// The background mode that the pixel is a shadow on.
    SHADOW_MODE: "", "", Unit::WHOLE;
    /// The brightness of the pixel as a share of that of the mode.
    BRIGHTNESS: "", "a", Unit::PERCENT;
    /// The minimum brightness of a shadow.
    SHADOW_THRESHOLD: "", r"\tau", SHARE;
}

crate::cases! { over value, subtraction::value;
    RULE: "no background mode lies within {threshold}. The heaviest modes, together {background_ratio} of the weight, are the \
           background.",
    NO_MATCH: "matches no mode: the nearest is {nearest} away, the threshold {threshold}. {result|Foreground}.",
    WITHIN: "matches {predicted|mode} {matched_mode} of weight {weight}, within the {background_ratio} of the background: \
             {rejected|background}.",
    OUTSIDE: "matches {predicted|mode} {matched_mode} of weight {weight}, outside the {background_ratio} of the background: \
              {result|foreground}.",
    SHADOW: "It has the colour of background mode {shadow_mode} at {brightness} of its brightness, above the shadow threshold \
             {shadow_threshold}.",
    NEW_MODE: "no mode matches. {estimate|A new mode} starts with μ = {new_mean}, σ = {new_sigma} and weight {new_weight}.",
    NO_NEW_MODE: "no mode matches, and a learning rate of 0 adds none.",
    MATCHED: "mode {matched_mode} is matched. With α = {learning_rate},",
    WEIGHT_GOES: "its weight goes from {weight} to {new_weight},",
    WEIGHT_STAYS: "its weight stays {new_weight},",
    MEAN_GOES: "μ goes from {mean} to {new_mean}",
    MEAN_STAYS: "μ stays {new_mean}",
    SIGMA_GOES: "and σ goes from {sigma} to {new_sigma}",
    SIGMA_STAYS: "and σ stays {new_sigma}",
    CLAMPED_ABOVE: ": the rule gives {free_sigma}, but the maximum is {new_sigma}, {most_sigmas} times that of a new mode.",
    CLAMPED_BELOW: ": the rule gives {free_sigma}, but the minimum is {new_sigma}.",
}

impl MixtureOfGaussians {
    fn limit(&self) -> Value {
        subtraction::value::THRESHOLD.is(self.threshold).in_unit(SIGMAS)
    }

    /// Puts the threshold and the share of the background; returns with them the rule.
    pub(super) fn put_rule(&self, step: Step) -> (Step, Cases) {
        (step.put_value(self.limit()).put(value::BACKGROUND_RATIO, 100.0 * self.background_ratio), vec![case::RULE])
    }

    pub(super) fn explanation(&self, step: Step, probe: &Probe<Mixture>) -> Explanation {
        let &Probe { before, after, frame, place } = probe;
        let pixel = before.pixel(frame, place);
        let verdict = before.verdict(self, &pixel, place);
        let (modes, matched) = (&verdict.modes, verdict.matched.as_ref());
        let (role, _) = class(verdict.is_foreground);
        let number: Number = matched.map_or("none".into(), |matched| (matched.mode + 1).into());
        let (step, level) = put_pixel(step, &pixel);
        let mut step = step
            .fact(value::MODES, modes.len())
            .fact(value::BACKGROUND_MODES, before.background_modes(self, place))
            .fact_of(value::MATCHED_MODE.is(number).inked(role));
        if let Some(matched) = matched {
            step = step.fact_of(value::DISTANCE.is(modes[matched.mode].distance(&pixel)).inked(role));
        }
        let (step, _) = self.put_rule(step.fact_of(self.limit()));
        let step = self.put_formulas(step, &verdict, &pixel);
        let tables = matrices(modes, &pixel, after.map(|after| after.modes(place)));
        let (step, class) = self.put_verdict(step.show(Readout::Matrices(tables)), &verdict, &pixel);
        let verdict_cases = std::iter::once(level).chain(class).collect();
        let Some(after) = after else { return Explanation { step, verdict: verdict_cases, update: Vec::new() } };
        let (step, update) = self.put_update(step, matched, &pixel, after, place);
        Explanation { step, verdict: verdict_cases, update }
    }

    /// Puts the distance of the pixel from the matched mode, or from the heaviest.
    fn put_formulas(&self, step: Step, verdict: &Verdict, pixel: &[f32]) -> Step {
        let number = verdict.matched.as_ref().map_or(0, |matched| matched.mode);
        let Some(mode) = verdict.modes.get(number) else { return step };
        let (n, (role, sign)) = (number + 1, class(verdict.matched.is_none()));
        put_mode(step, mode, [value::WEIGHT, value::MEAN, value::SIGMA])
            .put(subtraction::value::LEVEL, tuple(pixel))
            .put_value(value::DISTANCE.is(mode.distance(pixel)).inked(role))
            .formula(format!(r"\frac{{|I - \mu_{n}|}}{{\sigma_{n}}} \le T"))
            .formula(format!(r"\frac{{|{{level}} - {{mean}}|}}{{{{sigma}}}} = {{distance}} {sign} {{threshold}}"))
    }

    /// Puts the values of the verdict; returns with them the cases that tell it.
    fn put_verdict(&self, step: Step, verdict: &Verdict, pixel: &[f32]) -> (Step, Cases) {
        let nearest = verdict.modes.iter().map(|mode| mode.distance(pixel)).fold(f32::INFINITY, f32::min);
        let step = step.put(value::NEAREST, nearest);
        let class = match (&verdict.matched, verdict.is_foreground) {
            (None, _) => case::NO_MATCH,
            (Some(_), false) => case::WITHIN,
            (Some(_), true) => case::OUTSIDE,
        };
        let Some((mode, light)) = verdict.shadow else { return (step, vec![class]) };
        let step = step.put(value::SHADOW_MODE, mode + 1).put(value::BRIGHTNESS, 100.0 * light);
        (step.put(value::SHADOW_THRESHOLD, 100.0 * self.shadow.shadow_threshold), vec![class, case::SHADOW])
    }

    /// Puts the matched mode after the update, or the new mode; returns with it the cases that tell it.
    fn put_update(
        &self,
        step: Step,
        matched: Option<&Matched>,
        pixel: &[f32],
        after: &Mixture,
        place: (usize, usize),
    ) -> (Step, Cases) {
        let new = [value::NEW_WEIGHT, value::NEW_MEAN, value::NEW_SIGMA];
        let Some(matched) = matched else {
            // Only a new mode begins at the pixel's level: an older one would match.
            let Some(mode) = after.modes(place).into_iter().find(|mode| mode.mean == pixel) else {
                return (step, vec![case::NO_NEW_MODE]);
            };
            let step = put_mode(step, &mode, new);
            return (step.put_value(value::NEW_MEAN.is(tuple(pixel)).in_unit(Unit::WHOLE)), vec![case::NEW_MODE]);
        };
        let mode = after.mode_in(matched.slot, place);
        let step = put_mode(step.put(subtraction::value::LEARNING_RATE, self.learning_rate), &mode, new)
            .put(value::FREE_SIGMA, matched.free_variance.max(0.0).sqrt())
            .put(value::MOST_SIGMAS, MAX_SIGMAS);
        let end = match is_same(&step, [value::FREE_SIGMA, value::NEW_SIGMA]) {
            true => subtraction::case::END,
            false if matched.free_variance > mode.variance => case::CLAMPED_ABOVE,
            false => case::CLAMPED_BELOW,
        };
        let changes = CHANGES.map(|(of, [stays, goes])| if is_same(&step, of) { stays } else { goes });
        (step, [&[case::MATCHED][..], &changes, &[end]].concat())
    }
}

/// The quantities of a mode before and after the update, with the cases that tell what does not change in its decimals, and what does.
const CHANGES: [([&Variable; 2], [&Case; 2]); 3] = [
    ([value::WEIGHT, value::NEW_WEIGHT], [case::WEIGHT_STAYS, case::WEIGHT_GOES]),
    ([value::MEAN, value::NEW_MEAN], [case::MEAN_STAYS, case::MEAN_GOES]),
    ([value::SIGMA, value::NEW_SIGMA], [case::SIGMA_STAYS, case::SIGMA_GOES]),
];

/// Whether two values of a step are written the same way.
fn is_same(step: &Step, of: [&Variable; 2]) -> bool {
    let [a, b] = of.map(|of| step.value(of).map(Value::bare));
    a == b
}

/// Puts weight, mean and standard deviation of a mode.
fn put_mode(step: Step, mode: &Mode, [weight, mean, sigma]: [&'static Variable; 3]) -> Step {
    step.put(weight, mode.weight).put(mean, tuple(&mode.mean)).put(sigma, mode.variance.sqrt())
}

/// The modes of a pixel before the update, and after it once that is done.
fn matrices(modes: &[Mode], pixel: &[f32], after: Option<Vec<Mode>>) -> Vec<Matrix> {
    let before = table("M", "modes before the update", modes, pixel);
    let after = after.map(|after| {
        let table = table("M′", "modes after the update", &after, pixel);
        let same = |(x, y): (usize, usize)| before.entries.get(x, y) == Some(&table.entries[(x, y)]);
        let changed = Grid::from_fn(table.entries.width(), table.entries.height(), |x, y| !same((x, y)));
        Matrix { role: Some(Role::Estimate), changed: Some(changed), ..table }
    });
    [before].into_iter().chain(after).collect()
}

fn table(symbol: &'static str, name: &'static str, modes: &[Mode], pixel: &[f32]) -> Matrix {
    let columns = match pixel {
        [_] => vec!["w", "μ", "σ", "|I − μ| / σ"],
        _ => vec!["w", "R", "G", "B", "σ", "|I − μ| / σ"],
    };
    let entries = Grid::from_fn(columns.len(), modes.len(), |x, y| {
        let mode = &modes[y];
        f64::from(match x.checked_sub(1) {
            None => mode.weight,
            Some(channel) if channel < pixel.len() => mode.mean[channel],
            Some(channel) if channel == pixel.len() => mode.variance.sqrt(),
            Some(_) => mode.distance(pixel),
        })
    });
    let rows = (1..=modes.len()).map(|number| number.to_string());
    Matrix::new(symbol, name, entries).with_role(Role::Predicted).with_rows(rows).with_columns(columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Threads;
    use crate::data::Frame;

    crate::line_names!(UPDATE_MODEL);

    #[test]
    fn a_clamped_deviation_is_told_beside_that_of_the_rule() {
        let told = |learning_rate: f32, level: u8| {
            let of = MixtureOfGaussians { learning_rate, ..MixtureOfGaussians::default() };
            let frames = [100, level].map(|level| Frame::gray(Grid::new(4, 4, level)));
            let before = Mixture::new(&of, &frames[0]);
            let mut after = before.clone();
            after.subtract(&of, &frames[1], &Threads::single());
            let probe = Probe { before: &before, after: Some(&after), frame: &frames[1], place: (1, 1) };
            let Explanation { step, update, .. } = of.explanation(Step::at(UPDATE_MODEL), &probe);
            update.iter().fold(step, |step, case| step.say(case)).sentence.plain()
        };
        for (rate, level, end) in [
            (0.5, 114, "9.00: the rule gives 10.41, but the maximum is 9.00, 2.25 times that of a new mode."),
            (0.9, 100, "2.00: the rule gives 0.96, but the minimum is 2.00."),
            (0.5, 100, "2.79."),
        ] {
            let (told, end) = (told(rate, level), format!("and σ goes from 4.00 to {end}"));
            assert!(told.ends_with(&end), "{told}");
        }
    }

    #[test]
    fn what_does_not_change_stays() {
        let is_same = |pair: [f32; 2]| {
            let step = Step::at(UPDATE_MODEL).put(value::SIGMA, pair[0]).put(value::NEW_SIGMA, pair[1]);
            is_same(&step, [value::SIGMA, value::NEW_SIGMA])
        };
        assert_eq!([is_same([2.0, 2.004]), is_same([2.0, 2.006])], [true, false]);
    }
}
