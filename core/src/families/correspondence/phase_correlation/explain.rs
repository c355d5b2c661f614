//! The explanation of phase correlation.

use super::doubt::Doubt;
use super::vocabulary::{case, value};
use super::{Event, PhaseCorrelation, STAGES, Stage, State, Subpixel, larger_side, line, unexplained};
use crate::products::metrics;
use crate::run::Seen;
use crate::scene::{Name, Role, Step};

/// A peak this many times as high as the second is distinct.
const DISTINCT: f64 = 2.0;
/// If a larger share of the picture than the first moves differently, one translation explains only a part; up to the
/// second it explains all.
const PART: f64 = 0.1;
const LITTLE: f64 = 0.01;
/// A peak of this height has most phases in common.
const AGREEMENT: f64 = 0.5;

impl PhaseCorrelation {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(Event { stage, state }) = seen.events.last() else {
            return Step::at(line::WINDOW).say(case::OPENING);
        };
        let at = |line: Name| self.put_peak(Step::at(line), *stage, state);
        let of_frame = |line: Name, i: usize| at(line).put(value::PICTURE, ["frame t", "frame t+1"][i]);
        let step = match *stage {
            Stage::Window(i) => of_frame(line::WINDOW, i)
                .put(value::MEAN, state.fixed.means[i])
                .say(case::CENTRED)
                .say(if self.hann { case::WINDOWED } else { case::NOT_WINDOWED })
                .formula(r"w(i) = \frac{1}{2} - \frac{1}{2} \cos(2 \pi (i + \frac{1}{2}) / n)")
                .formula(r"g(x, y) = (I(x, y) - \bar{I}) \cdot w(x) \cdot w(y)"),
            Stage::Rows(i) => of_frame(line::TRANSFORM_ROWS, i).say(case::ROWS),
            Stage::Columns(i) => at(line::TRANSFORM_COLUMNS).put(value::SPECTRUM, ["G₁", "G₂"][i]).say(case::COLUMNS),
            Stage::Cross => at(line::MULTIPLY)
                .say(case::CROSS)
                .formula(r"C = G_2 \cdot \bar{G_1} = |C| \cdot \exp(-2 \pi i (f d_x + g d_y))"),
            Stage::Normalize => at(line::NORMALISE).say(case::NORMALISED).formula(r"R = \frac{C}{|C|}"),
            Stage::InverseColumns => at(line::INVERT_COLUMNS).say(case::INVERSE_COLUMNS),
            Stage::InverseRows => at(line::INVERT_ROWS).say(case::INVERSE_ROWS),
            Stage::Peak if state.peak.is_none() => at(line::TAKE_PEAK).say(case::NO_PEAK),
            Stage::Peak => at(line::TAKE_PEAK).say(case::PEAK).say(match state.is_significant() {
                true => case::ACCEPTED,
                false => case::REJECTED,
            }),
            Stage::Second => tell_truth(at(line::COMPARE_SECOND), state),
            Stage::Subpixel(axis) => {
                self.tell_refinement(at(if axis == 0 { line::REFINE_X } else { line::REFINE_Y }), state, axis)
            }
            Stage::Result => conclude(at(line::TAKE_RESULT), state),
        };
        self.add_charts(step, *stage, state)
    }

    /// Puts the frequencies, the peaks and the displacement so far.
    fn put_peak(&self, step: Step, stage: Stage, state: &State) -> Step {
        let (width, height) = state.size();
        let step = step.put(value::WIDTH, width).put(value::HEIGHT, height).put(value::MIN_SNR, self.min_snr);
        let mut step = step.fact_as(value::FREQUENCIES.is(width * height), case::SIZE);
        if STAGES[..state.done].contains(&Stage::Normalize) {
            step = step.fact(value::KEPT, state.kept).put(value::HIGHEST_SNR, state.highest_snr);
            step = step.put(value::SIGMA, state.sigma()).put(value::LEAST_SIGMAS, state.least_sigmas);
        }
        if let Some(at) = state.peak.map(|peak| state.wrapped(peak)) {
            step = step.put(value::PEAK_HEIGHT, state.height_at(at)).fact_as(value::PEAK.is(at), case::PEAK_AT);
        }
        if let Some(sigmas) = state.sigmas() {
            let role = if state.is_accepted() { Role::Best } else { Role::Rejected };
            step = step.fact_as(value::SIGMAS.is(sigmas).inked(role), case::SIGMAS_OF);
        }
        if let Some(at) = state.second.map(|second| state.wrapped(second)) {
            step = step.put(value::SECOND_HEIGHT, state.height_at(at)).fact_as(value::SECOND.is(at), case::SECOND_AT);
        }
        let is_refined = matches!(stage, Stage::Subpixel(_) | Stage::Result) && state.is_accepted();
        let step = step.fact_if(value::RATIO, ratio(state));
        let step = step.fact_if(value::DISPLACEMENT, is_refined.then(|| state.translation()));
        let truth = state.fixed.truth.as_ref().filter(|_| stage == Stage::Result);
        step.fact_if(value::TRUE_DISPLACEMENT, truth.and_then(|truth| truth.at(width / 2, height / 2)))
    }

    fn tell_refinement(&self, step: Step, state: &State, axis: usize) -> Step {
        let step = step.put(value::AXIS, ["x", "y"][axis]);
        let Some([before, at, behind]) = Self::around(state, axis) else { return step.say(case::NO_NEIGHBOURS) };
        let (side, sign) = larger_side([before, behind]);
        let step = step.put(value::HEIGHT_BEFORE, before).put(value::HEIGHT_AT, at).put(value::HEIGHT_BEHIND, behind);
        let step = step.put(value::SIDE, side).put(value::OFFSET, state.fraction[axis]).say(case::NEIGHBOURS);
        match self.subpixel {
            Subpixel::None => step.say(case::WHOLE),
            Subpixel::Ratio if sign > 0.0 => {
                step.say(case::BY_RATIO).formula(r"\delta = \frac{{side}}{{side} + {height_at}} = {offset:unit}")
            }
            Subpixel::Ratio => {
                step.say(case::BY_RATIO).formula(r"\delta = -\frac{{side}}{{side} + {height_at}} = {offset:unit}")
            }
            Subpixel::Parabola => step.say(case::BY_PARABOLA).formula(
                r"\delta = \frac{{height_before} - {height_behind}}{2 \cdot ({height_before} - 2 \cdot {height_at} + {height_behind})} = {offset:unit}",
            ),
        }
    }
}

/// The ratio of the highest peak to the second.
fn ratio(state: &State) -> Option<f64> {
    let [best, second] = [state.peak?, state.second?].map(|place| state.height_at(state.wrapped(place)));
    (second > 0.0).then(|| best / second)
}

/// Compares the highest peak with the second, and with the pictures.
fn tell_truth(step: Step, state: &State) -> Step {
    if state.peak.is_none() || state.second.is_none() {
        return step.say(case::NO_SECOND);
    }
    let step = step.put(value::DISTINCT, DISTINCT).say(case::SECOND);
    match (&state.doubt, ratio(state)) {
        (Some(doubt), _) => tell_doubt(step, doubt),
        (None, Some(ratio)) if ratio < DISTINCT => {
            step.say(case::RATIO_BELOW).say(case::AMBIGUOUS).say(case::POSSIBLE_CAUSES)
        }
        (None, Some(_)) => step.say(case::RATIO_ABOVE).say(case::IS_DISTINCT),
        (None, None) => step.say(case::NOT_POSITIVE).say(case::IS_DISTINCT),
    }
}

fn tell_doubt(step: Step, doubt: &Doubt) -> Step {
    match *doubt {
        Doubt::Contradicted { other, residuals: [own, least] } => {
            let step = step.put(value::OTHER, other).put(value::RESIDUAL, own).put(value::OTHER_RESIDUAL, least);
            step.say(case::CONTRADICTED)
        }
        Doubt::Aperture { across, period_px } => {
            let step = step.put(value::ACROSS, across).say(case::APERTURE);
            match period_px {
                Some(period) => step.put(value::PERIOD, period).say(case::PERIODIC),
                None => step,
            }
        }
        Doubt::Repeats { other } => {
            step.put(value::OTHER, other).say(case::REPEATS).say(case::AMBIGUOUS).say(case::END)
        }
    }
}

fn conclude(step: Step, state: &State) -> Step {
    if state.peak.is_none() {
        return step.say(case::UNKNOWN).say(case::WITHOUT_TEXTURE);
    }
    if let Some(doubt) = state.doubt.as_ref().filter(|doubt| doubt.is_refuting()) {
        return tell_doubt(step.say(case::UNKNOWN), doubt).say(match doubt {
            Doubt::Contradicted { .. } => case::ADVISE_OUTLIERS,
            Doubt::Repeats { .. } | Doubt::Aperture { .. } => case::ADVISE_TEXTURE,
        });
    }
    if !state.is_accepted() {
        return step.say(case::INSIGNIFICANT);
    }
    let (truth, found) = (state.fixed.truth.as_deref(), state.model().displacements_of_pixels());
    let error = truth.and_then(|truth| metrics::flow_error(&found, truth).ok().flatten());
    let step = step.say(case::TRANSLATION);
    let step = match &error {
        Some(error) => step.put(value::ENDPOINT_ERROR, error.epe_px).say(case::ERROR),
        None => step,
    };
    match (&state.doubt, ratio(state)) {
        (Some(doubt), _) => tell_doubt(step, doubt),
        (None, Some(ratio)) if ratio < DISTINCT => {
            let is_high = step.real(value::PEAK_HEIGHT) > AGREEMENT;
            step.say(if is_high { case::BROAD } else { case::LOW })
        }
        // A single peak may stand for most of the picture only.
        _ => tell_share(step.say(case::STANDS_OUT), state, error.map(|error| error.beyond[1])),
    }
}

/// Tells how much of the picture a translation with a distinct peak explains: by the ground truth, of which the share
/// `beyond` moves differently, without it by the pictures.
fn tell_share(step: Step, state: &State, beyond: Option<f64>) -> Step {
    let pair = state.fixed.pair.each_ref().map(|frame| frame.luma());
    let Some(share) = beyond.or_else(|| unexplained::share(pair, state.translation())) else {
        return step.say(case::TOO_LITTLE_IN_COMMON);
    };
    if share <= LITTLE {
        return step.say(case::EXPLAINS_ALL);
    }
    let step = step.put(value::UNEXPLAINED, 100.0 * share);
    let step = step.say(if share > PART { case::EXPLAINS_PART } else { case::EXPLAINS_MOST });
    step.say(if beyond.is_some() { case::BY_TRUTH } else { case::BY_PICTURES })
}
