//! The steps of the Kalman filter as data, with matrices, plots and marks.

mod conclusion;
mod equation;
mod marks;
mod plots;
mod vocabulary;

use super::matrices::matrices;
use super::restart::{LEAST_REJECTED, Restart, Retry, Trial};
use super::sensors::{Observations, Sensors};
use super::{Event, Gated, KalmanFilter, Loss, State, line, modes};
use crate::methods::kalman::vocabulary::value as shared;
use crate::methods::kalman::{Filter, Surroundings};
use crate::run::Seen;
use crate::scene::{Readout, Role, Step, Surface};
pub(super) use vocabulary::{case, value};

/// A line of a plot: its name, its role and its points.
type Line = (&'static str, Role, Vec<[f32; 2]>);

/// The estimates of a frame up to a step.
struct StepEstimates<'a> {
    frame: usize,
    before: Option<Filter>,
    predicted: Option<Filter>,
    gated: Vec<&'a Gated>,
    after: Option<Filter>,
    /// The role of the estimate after the step: filtered, or smoothed.
    role: Role,
}

impl StepEstimates<'_> {
    fn current(&self) -> Option<(&Filter, Role)> {
        let before = || self.before.as_ref().map(|filter| (filter, Role::Estimate));
        let predicted = || self.predicted.as_ref().map(|filter| (filter, Role::Predicted));
        self.after.as_ref().map(|filter| (filter, self.role)).or_else(predicted).or_else(before)
    }
}

impl KalmanFilter {
    fn now<'a>(&self, seen: &Seen<'a, Self>) -> StepEstimates<'a> {
        let state = seen.before;
        let mut now = StepEstimates {
            frame: frame_of(state),
            before: state.filter,
            predicted: None,
            gated: Vec::new(),
            after: None,
            role: if state.back.is_some() { Role::Result } else { Role::Estimate },
        };
        for event in seen.events {
            match event {
                Event::Predicted(both) => now.predicted = Some(both[1]),
                Event::Gated(gated) => now.gated.push(gated),
                // Interacting modes are combined after their probabilities are updated.
                Event::Updated(update) if update.1.modes().is_some() => {}
                Event::Updated(update) | Event::Weighed(update) => now.after = Some(update.1),
                Event::Begun(filter, _) => now.after = Some(**filter),
                Event::Retried(retry) => now.after = retry.restart.as_ref().map(|restart| restart.filter),
                Event::Missed(filter) => now.after = filter.as_deref().copied(),
                Event::Lost(filter, _) => now.after = Some(**filter),
                Event::Smoothed(all) => (now.before, now.after) = (Some(all[0]), Some(all[1])),
                Event::Kept(filter) => {
                    (now.before, now.after) = (filter.as_deref().copied(), filter.as_deref().copied())
                }
                Event::Observed(_) | Event::Mixed(_) | Event::Drawn(_) => {}
            }
        }
        now
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let now = self.now(seen);
        let Some(event) = seen.events.last() else {
            return self.add_charts(self.facts(Step::at(line::EACH_FRAME), seen, &now).say(case::OPENING), seen, &now);
        };
        let at = |line| self.conclude(self.facts(Step::at(line), seen, &now), seen);
        let step = match event {
            Event::Mixed(before) => modes::tell_mixing(at(line::MIX), before),
            Event::Drawn(before) => modes::tell_sigma_points(at(line::DRAW), before),
            Event::Predicted(both) => tell_prediction(at(line::PREDICT), both),
            Event::Observed(observed) => self.tell_observations(at(line::MEASURE), seen, observed),
            Event::Gated(gated) => self.tell_gate(at(line::GATE), seen, gated),
            Event::Updated(update) => match update.1.modes() {
                Some(after) => modes::tell_update(at(line::UPDATE), &update.0, &after),
                None => tell_update(at(line::UPDATE), &update.0, &update.1),
            },
            Event::Weighed(update) => modes::tell_weights(at(line::WEIGH_MODES), &update.0, &update.1),
            Event::Begun(_, there) => {
                let step = at(line::BEGIN_OBJECT).put(value::INITIAL_SPEED, self.initial_speed).say(case::BEGUN);
                let step = step.put(value::OBJECT, self.object).put(value::DETECTIONS, *there);
                let is_missing = *there > 0 && self.object > *there;
                step.say_if(is_missing, if *there == 1 { case::ONLY_ONE } else { case::ONLY_SOME })
            }
            Event::Retried(retry) => tell_retry(at(line::RESTART), retry),
            Event::Missed(None) => waiting(at(line::BEGIN_OBJECT), seen),
            Event::Missed(Some(_)) => self.coasting(at(line::COAST_OR_END), seen, &now),
            Event::Lost(_, loss) => {
                let why = if *loss == Loss::Missed { case::TOO_OLD } else { case::OUTSIDE };
                at(line::COAST_OR_END).put(value::MAX_AGE, self.max_age).say(why).say(case::DELETED)
            }
            Event::Smoothed(both) => {
                let step = at(line::SMOOTH).put(value::SHIFT, distance(both[0].place(), both[1].place()));
                tell_spread(step, both).say(case::SMOOTHED)
            }
            Event::Kept(Some(_)) => at(line::EACH_FRAME_BACK).say(case::KEPT),
            // The end of a run is about its result, not about a frame before the track.
            Event::Kept(None) => at(line::EACH_FRAME_BACK).say_if(self.ended(seen).is_none(), case::NOTHING_TO_SMOOTH),
        };
        self.add_charts(step, seen, &now)
    }

    /// Adds the numbers of the run at its end, and those of the current estimate, measurement and truth.
    fn facts(&self, step: Step, seen: &Seen<Self>, now: &StepEstimates) -> Step {
        let step = self.errors(step.fact(shared::FRAME, now.frame), seen);
        let Some((filter, role)) = now.current() else { return put_measurement(step, now) };
        let ([u, v], [[xx, _], [_, yy]]) = (filter.velocity(), filter.place_covariance());
        let step = step.fact_of(shared::POSITION.is(filter.place()).inked(role)).fact(shared::VELOCITY, [u, v]);
        let step =
            step.fact(shared::SPEED, u.hypot(v)).fact_if(shared::TURN_RATE, filter.turn_rate().map(f64::to_degrees));
        let step = step.fact(shared::DEVIATIONS, [xx.sqrt(), yy.sqrt()]);
        let step = put_measurement(modes::probable(step, filter), now);
        let Some(truth) = truth(seen) else { return step };
        let step = step.fact(shared::TRUTH, truth).fact(shared::ERROR, distance(truth, filter.place()));
        step.fact_if(shared::NEES, filter.squared_error(truth))
    }

    fn tell_observations(&self, step: Step, seen: &Seen<Self>, observed: &Observations) -> Step {
        let [first, second] = [0, 1].map(|sensor| observed.measured.iter().find(|reading| reading.sensor == sensor));
        let step = match first {
            Some(reading) => {
                let step = step.put(shared::MEASUREMENT, reading.measurement.place);
                let step = step.put(shared::MEASUREMENT_NOISE, reading.measurement.place_deviation);
                let step = step.put(value::ORIGIN, seen.before.detector.measurement());
                match (reading.object, reading.tracked.filter(|_| reading.is_of_another() == Some(true))) {
                    (Some(object), Some(tracked)) => {
                        let step = step.put(value::MEASURED_OBJECT, object).put(value::TRACKED_OBJECT, tracked);
                        step.say(case::MEASURED_OTHER)
                    }
                    (Some(object), None) => step.put(value::MEASURED_OBJECT, object).say(case::MEASURED_OBJECT),
                    (None, _) => step.say(case::MEASURED),
                }
                .say(case::NOISE)
            }
            None if observed.is_hidden => step.say(if second.is_some() { case::FIRST_HIDDEN } else { case::HIDDEN }),
            None if observed.detections.is_empty() => step.say(case::NO_DETECTIONS),
            None => {
                let step = step.put(value::DETECTIONS, observed.detections.len()).say(case::DETECTED);
                step.say(match (&seen.before.filter, self.clicks.all().is_empty()) {
                    (Some(_), _) => case::NONE_TRACKED,
                    (None, false) => case::NONE_CLICKED,
                    (None, true) => case::NONE_CHOSEN,
                })
            }
        };
        let Some(reading) = second else { return step };
        let step = step.put(shared::MEASUREMENT, reading.measurement.place);
        let step = step.put(shared::MEASUREMENT_NOISE, reading.measurement.place_deviation);
        step.say(case::SECOND).say(case::NOISE)
    }

    /// Compares d² with the gate; after three clicked positions in a row outside it, tells the remedy.
    fn tell_gate(&self, step: Step, seen: &Seen<Self>, gated: &Gated) -> Step {
        let step = step.put(shared::GATE_PROBABILITY, 100.0 * f64::from(self.gate));
        let step = step.put(shared::DIMENSION, gated.measurement().numbers());
        let step = step.say(if gated.reading.sensor == 0 { case::DISTANCE } else { case::SECOND_DISTANCE });
        let step = equation::gate(step, gated);
        if !gated.is_inside() || !gated.is_beyond() {
            return step.say(if gated.is_inside() { case::ACCEPTED } else { case::REJECTED });
        }
        let earlier = seen.before.records.iter().rev();
        let earlier = earlier.map_while(|record| record.of_sensor(0).filter(|gated| gated.is_beyond()));
        let beyond: Vec<&Gated> = earlier.chain([gated]).collect();
        let step = step.put(value::REJECTIONS, beyond.len()).say(case::CLICKED);
        if beyond.len() < LEAST_REJECTED { step } else { self.remedy(step.say(case::CLICKS_OUTSIDE), &beyond, None) }
    }

    /// Tells a frame without an accepted measurement, and after three rejections in a row a remedy.
    fn coasting(&self, step: Step, seen: &Seen<Self>, now: &StepEstimates) -> Step {
        let missed = seen.before.missed + 1;
        let step = step.put(value::MISSED, missed).put(value::MAX_AGE, self.max_age).say(match now.gated.len() {
            0 => case::UNMEASURED,
            1 => case::ONE_REJECTED,
            _ => case::ALL_REJECTED,
        });
        let step = step.say(if missed == 1 { case::ONE_MISSED } else { case::MISSED });
        let earlier = seen.before.records.iter().rev();
        let is_rejected = |gated: &[Gated]| !gated.is_empty() && !gated.iter().any(Gated::is_inside);
        let earlier = earlier.take_while(|record| is_rejected(&record.gated)).filter_map(|record| record.gated.first());
        let rejected: Vec<&Gated> = earlier.chain(now.gated.first().copied()).collect();
        if rejected.len() < LEAST_REJECTED || now.gated.is_empty() {
            return step;
        }
        let step = step.put(value::REJECTIONS, rejected.len()).say(case::REJECTIONS);
        match of_another(&rejected) {
            Some(true) => step.say(case::OF_OTHERS),
            Some(false) => self.remedy(step.say(case::OF_IT), &rejected, self.failed(seen)),
            None => self.remedy(step.say(case::OF_UNKNOWN), &rejected, self.failed(seen)),
        }
    }

    fn add_charts(&self, step: Step, seen: &Seen<Self>, now: &StepEstimates) -> Step {
        let records = seen.before.records.iter().map(|record| &**record);
        let matrices = matrices(seen.events.last(), now.current(), records);
        let step = if matrices.is_empty() { step } else { step.show(Readout::Matrices(matrices)) };
        step.show_all(self.series(seen)).show_all(self.hill(seen.events.last(), now).map(Readout::Landscape))
    }

    /// The density of the position; where a measurement is tested, that of the predicted measurement with its gate.
    fn hill(&self, event: Option<&Event>, now: &StepEstimates) -> Option<Surface> {
        let (filter, role) = now.current()?;
        let name = match role {
            Role::Predicted => "prediction",
            Role::Result => "smoothed",
            _ => "estimate",
        };
        let second = if self.sensors == Sensors::One { 0.0 } else { self.second_noise };
        let deviation = f64::from(self.measurement_noise.max(second));
        let surroundings = Surroundings::of(now.predicted.as_ref().unwrap_or(filter), deviation);
        let accepted = now.gated.iter().filter(|gated| gated.is_inside()).map(|gated| gated.measurement().place);
        let surroundings = accepted.fold(surroundings, Surroundings::around);
        match event {
            Some(Event::Gated(gated)) => {
                let tested = [*gated.measurement()];
                surroundings.measurement((name, role), &gated.expected, (&tested, Some(gated.limit)))
            }
            _ => {
                let measured: Vec<_> = now.gated.iter().map(|gated| *gated.measurement()).collect();
                surroundings.position((name, role), filter, &measured)
            }
        }
    }
}

/// Adds the last measurement and its gate.
fn put_measurement(step: Step, now: &StepEstimates) -> Step {
    let Some(gated) = now.gated.last() else { return step };
    let step = step.fact(shared::MEASUREMENT, gated.measurement().place).put(shared::GATE, gated.limit);
    step.fact_as(shared::SQUARED_DISTANCE.is(gated.squared_distance), case::NIS_AND_GATE)
}

/// Puts the standard deviation of the position before and after a step.
fn tell_spread(step: Step, [before, after]: &[Filter; 2]) -> Step {
    step.put(shared::DEVIATION_BEFORE, deviation(before)).put(shared::DEVIATION, deviation(after))
}

/// Tells the prediction, and the cause of its larger covariance.
fn tell_prediction(step: Step, both: &[Filter; 2]) -> Step {
    let step = tell_spread(step, both).say(case::PREDICTED).say(match both[1] {
        Filter::Velocity(..) => case::BY_VELOCITY,
        Filter::Acceleration(..) => case::BY_ACCELERATION,
        Filter::Turn(..) | Filter::Interacting(..) => case::BY_TURN,
    });
    equation::prediction(step.say(case::SPREAD), both)
}

fn tell_update(step: Step, gated: &Gated, after: &Filter) -> Step {
    let from = &gated.expected;
    let Some(numbers) = from.update_numbers(gated.measurement()) else { return step };
    let step = tell_spread(step, &[*from, *after]).put(shared::POSITION_BEFORE, from.place());
    let step = step.put(shared::VELOCITY_BEFORE, from.velocity()).put(shared::GAIN, numbers.gain[(0, 0)]);
    let turns = after.turn_rate().is_some();
    equation::update(step.say(case::UPDATED).say_if(turns, case::TURN_RATE), (gated, &numbers), after)
}

/// Tells why no track has started.
fn waiting(step: Step, seen: &Seen<KalmanFilter>) -> Step {
    let detections = seen.events.iter().find_map(|event| match event {
        Event::Observed(observed) => Some(observed.detections.len()),
        _ => None,
    });
    let detections = detections.unwrap_or(0);
    let step = step.put(value::DETECTIONS, detections);
    match detections {
        _ if seen.before.begun > 0 => step.say(case::NO_TRACK),
        0 => step.say(case::NO_MEASUREMENT_YET),
        1 if seen.before.detector.is_moving() => step.say(case::NOT_THE_ONE).say(case::CLICK_IT),
        _ if seen.before.detector.is_moving() => step.say(case::NOT_ONE).say(case::CLICK_IT),
        _ => step.say(case::NOT_STARTED),
    }
}

/// Tells the detections of a diverged track that are filtered again.
fn tell_retry(step: Step, retry: &Retry) -> Step {
    let step = tell_trial(step.put(value::FIRST_FRAME, retry.first), &retry.diverged).say(case::DIVERGED);
    let step = trials(step, &retry.others);
    let Some(restart) = &retry.restart else { return step.say(case::NOT_RESTARTED) };
    put_restart(step, restart).say(if restart.first == retry.first { case::RESTARTED } else { case::STARTED_ANEW })
}

/// Puts the first frame of a restarted track, and its motion model with the number of measurements that it accepts.
fn put_restart(step: Step, Restart { trial, first, .. }: &Restart) -> Step {
    let step = step.put(value::RESTART_FRAME, *first).put(value::RESTART_MODEL, trial.motion.label().to_lowercase());
    step.put(value::RESTART_ACCEPTED, trial.accepted).put(value::RESTART_GATED, trial.measured)
}

/// Puts a motion model with the number of measurements that it accepts.
fn tell_trial(step: Step, trial: &Trial) -> Step {
    let step = step.put(value::MODEL, trial.motion.label().to_lowercase());
    step.put(value::ACCEPTED, trial.accepted).put(value::GATED, trial.measured)
}

/// Tells the numbers of accepted measurements of motion models.
fn trials(step: Step, trials: &[Trial]) -> Step {
    let step = step.say_if(trials.is_empty(), case::NO_TRIAL);
    trials.iter().fold(step, |step, trial| tell_trial(step, trial).say(case::TRIAL))
}

/// Whether all measurements are of other objects than the tracked one, or none is; `None` where they differ or it is unknown.
fn of_another(measurements: &[&Gated]) -> Option<bool> {
    let first = measurements.first()?.reading.is_of_another()?;
    measurements.iter().all(|gated| gated.reading.is_of_another() == Some(first)).then_some(first)
}

fn frame_of(state: &State) -> usize {
    let count = state.records.len();
    state.span.first + state.back.map_or(count, |done| count.saturating_sub(done + 1))
}

/// The true position in the current frame.
fn truth(seen: &Seen<KalmanFilter>) -> Option<[f64; 2]> {
    let observed = seen.events.iter().find_map(|event| match event {
        Event::Observed(observed) => observed.truth,
        _ => None,
    });
    let index = frame_of(seen.before) - seen.before.span.first;
    observed.or_else(|| seen.before.records.get(index)?.truth)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The standard deviation of the position, the root of the mean variance of both axes.
fn deviation(filter: &Filter) -> f64 {
    let [[xx, _], [_, yy]] = filter.place_covariance();
    ((xx + yy) / 2.0).sqrt()
}
