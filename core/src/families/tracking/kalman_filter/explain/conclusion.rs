//! The end of a run: its errors, rejections, bias and consistency, and the remedy.

use super::{case, distance, of_another, put_restart, shared, tell_trial, trials, value};
use crate::families::tracking::kalman_filter::{Event, FrameRecord, Gated, KalmanFilter, State, modes, restart::Retry};
use crate::methods::kalman::{ConsistencyTest, MotionModel};
use crate::run::Seen;
use crate::scene::Step;

/// The mean innovation in standard deviations above which the filter is biased, and the least number of innovations that tell it.
const BIAS_SIGMAS: f64 = 2.5;
const LEAST_INNOVATIONS: usize = 6;
/// The share of rejected measurements above which the others are no fair sample of the innovations.
const MOST_REJECTED: f64 = 0.25;
/// Factor by which one component of the innovations must exceed the other to tell the direction.
const CLEARLY: f64 = 1.5;

impl KalmanFilter {
    /// Tells the parameters to change where the motion model does not fit these measurements.
    pub(super) fn remedy(&self, step: Step, gated: &[&Gated], failed: Option<&Retry>) -> Step {
        if let Some(retry) = failed {
            let step = step.put(value::FIRST_FRAME, retry.first).say(case::FILTERED_AGAIN);
            return trials(step, &retry.others).say(case::UNEXPLAINED);
        }
        step.say(match self.motion {
            MotionModel::Velocity => match direction(gated) {
                Some(Direction::Beside) => case::BESIDE_PATH,
                Some(Direction::Along) => case::ALONG_PATH,
                None => case::ALONG_AND_BESIDE,
            },
            MotionModel::Interacting => case::NEITHER_MODE,
            _ => case::ANOTHER_MODEL,
        })
    }

    /// The last attempt to restart the present track, if it failed.
    pub(super) fn failed<'a>(&self, seen: &Seen<'a, Self>) -> Option<&'a Retry> {
        let of_step = seen.events.iter().find_map(|event| match event {
            Event::Retried(retry) => Some(&**retry),
            _ => None,
        });
        let start = seen.before.records.iter().rposition(|record| record.begins)? + seen.before.span.first;
        of_step.or(seen.before.retry.as_deref()).filter(|retry| retry.first == start && retry.restart.is_none())
    }

    pub(super) fn ended<'a>(&self, seen: &Seen<'a, Self>) -> Option<&'a State> {
        let state = seen.after?;
        let frames = state.records.len();
        let is_over = match state.back {
            Some(done) => done == frames,
            None => !self.smooths() && state.span.frames() == Some(frames),
        };
        is_over.then_some(state)
    }

    /// Adds the errors beside the truth and the mean NIS with its band at the end of a run.
    pub(super) fn errors(&self, step: Step, seen: &Seen<Self>) -> Step {
        let Some(state) = self.ended(seen) else { return step };
        // Only frames with an accepted measurement compare the filter with its sensor: a rejected one may belong to another object.
        let accepted_in = |record: &FrameRecord| record.of_sensor(0).filter(|gated| gated.is_inside()).copied();
        let rmse = |of: &dyn Fn(&FrameRecord) -> Option<[f64; 2]>| {
            let errors = state.records.iter().filter_map(|record| Some(distance(of(record)?, record.truth?)));
            let squares: Vec<f64> = errors.map(|error| error * error).collect();
            (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        let step = step.fact_if(value::RMSE_FILTERED, rmse(&|record| Some(record.filtered?.place())));
        let step = step.fact_if(value::RMSE_SMOOTHED, rmse(&|record| Some(record.smoothed?.place())));
        let measured = rmse(&|record| Some(accepted_in(record)?.measurement().place));
        let there = rmse(&|record| accepted_in(record).and(Some(record.filtered?.place())));
        let step = step.fact_if(value::RMSE_MEASURED, measured).fact_if(value::RMSE_THERE, there);
        let Some(test) = consistency(&accepted(state)) else { return step };
        let step = step.put(shared::BAND_LOW, test.band[0]).put(shared::BAND_HIGH, test.band[1]);
        step.fact_as(shared::MEAN_NIS.is(test.mean), case::MEAN_AND_BAND)
    }

    /// Tells rejections, bias, consistency by the mean NIS, and the remedy at the end of a run.
    pub(super) fn conclude(&self, step: Step, seen: &Seen<Self>) -> Step {
        let Some(state) = self.ended(seen) else { return step };
        let step = tell_restart(step, state);
        let step =
            modes::conclude(step, state.records.iter().map(|record| &**record), f64::from(self.measurement_noise));
        let gated: Vec<&Gated> = state.records.iter().filter_map(|record| record.of_sensor(0)).collect();
        let nis = accepted(state);
        let rejected = gated.len() - nis.len();
        let step = step.put(value::REJECTED, rejected).put(value::TESTED, gated.len());
        let step = step.say_if(rejected > 0, case::GATE_REJECTED);
        let Some(test) = consistency(&nis) else { return step.say(case::UNTESTED) };
        let bias = bias(&nis);
        let tell_bias = |step: Step| match bias {
            Some(bias) => self.remedy(step.put(value::BIAS, bias).say(case::BIASED), &nis, None),
            None => step,
        };
        let share = rejected as f64 / gated.len() as f64;
        // The gate cuts off large values, so that their means would look right whatever the filter does.
        if share <= MOST_REJECTED {
            return test.tell(tell_bias(step), bias.is_some());
        }
        let refused: Vec<&Gated> = gated.into_iter().filter(|gated| !gated.is_inside()).collect();
        let step = step.put(value::SHARE_REJECTED, 100.0 * share).say(case::MANY_REJECTED);
        match of_another(&refused) {
            Some(true) => tell_bias(step.say(case::GATE_IS_RIGHT)),
            Some(false) => self.remedy(step.say(case::HAS_DIVERGED), &refused, self.failed(seen)),
            None => self.remedy(step.say(case::MAY_HAVE_DIVERGED), &refused, self.failed(seen)),
        }
    }
}

fn tell_restart(step: Step, state: &State) -> Step {
    let Some(retry) = &state.retry else { return step };
    let Some(restart) = &retry.restart else { return step };
    let step = tell_trial(step.put(value::DIVERGED_FRAME, retry.frame), &retry.diverged).say(case::HAD_DIVERGED);
    put_restart(step, restart).say(case::WAS_RESTARTED)
}

/// The accepted measurements of a run: rejected ones are of something else, and say nothing about the filter's covariance.
fn accepted(state: &State) -> Vec<&Gated> {
    let gated = state.records.iter().filter_map(|record| record.of_sensor(0));
    gated.filter(|gated| gated.is_inside()).collect()
}

/// The test of the mean NIS of these measurements; `None` without any.
fn consistency(accepted: &[&Gated]) -> Option<ConsistencyTest> {
    let nis: Vec<f64> = accepted.iter().map(|gated| gated.squared_distance).collect();
    ConsistencyTest::of(&nis, accepted.first()?.measurement().numbers())
}

/// The mean innovation where it is not zero. Each innovation is divided by its standard deviation from S: the first ones are so uncertain
/// that they would hide the others. (Y. Bar-Shalom, X.-R. Li and T. Kirubarajan, Estimation with applications to tracking and navigation,
/// 2001, section 5.4.)
fn bias(accepted: &[&Gated]) -> Option<[f64; 2]> {
    let (mut sum, mut normalized) = ([0.0; 2], [0.0; 2]);
    for gated in accepted {
        let (measured, expected) = (gated.measurement(), &gated.expected);
        let (at, covariance) = (expected.place(), expected.place_covariance());
        for axis in 0..2 {
            let innovation = measured.place[axis] - at[axis];
            let variance = covariance[axis][axis] + measured.place_deviation * measured.place_deviation;
            sum[axis] += innovation;
            normalized[axis] += innovation / variance.sqrt();
        }
    }
    let is_biased = normalized.iter().any(|sum| sum.abs() > BIAS_SIGMAS * (accepted.len() as f64).sqrt());
    (accepted.len() >= LEAST_INNOVATIONS && is_biased).then(|| sum.map(|sum| sum / accepted.len() as f64))
}

/// The side of their predictions on which measurements lie.
enum Direction {
    /// Along the predicted path, as those of an object that brakes.
    Along,
    /// Beside it, as those of a turn.
    Beside,
}

/// The direction of most of the innovations; `None` where neither is clear.
fn direction(gated: &[&Gated]) -> Option<Direction> {
    let [along, beside] = gated.iter().fold([0.0; 2], |sums, gated| {
        let (from, to) = (gated.expected.place(), gated.measurement().place);
        let ([u, v], [x, y]) = (gated.expected.velocity(), [0, 1].map(|k| to[k] - from[k]));
        let speed = u.hypot(v).max(f64::MIN_POSITIVE);
        [sums[0] + (u * x + v * y) / speed, sums[1] + (u * y - v * x) / speed]
    });
    let [along, beside] = [along, beside].map(f64::abs);
    match () {
        () if along > CLEARLY * beside => Some(Direction::Along),
        () if beside > CLEARLY * along => Some(Direction::Beside),
        () => None,
    }
}
