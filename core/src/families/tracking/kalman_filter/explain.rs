//! The steps of the Kalman filter in words, matrices, plots and marks.

mod equation;
mod marks;
mod plots;

use super::matrices::matrices;
use super::restart::{LEAST_REJECTED, Restart, Retry, Trial};
use super::sensors::{Observations, SensorReading, Sensors};
use super::{Event, FrameRecord, Gated, KalmanFilter, Loss, State, line, modes};
use crate::base::words::{self, counted as count, percent};
use crate::methods::kalman::{ConsistencyTest, Filter, Measurement, MotionModel, Surroundings};
use crate::methods::multi_object::explain::missed_in_a_row;
use crate::methods::numbers::{px, ratio, squared};
use crate::run::Seen;
use crate::scene::{Fact, Readout, Role, Sentence, Step, Surface};

/// The mean innovation in standard deviations above which the filter is biased, and the least number of innovations that tell it.
const BIAS_SIGMAS: f64 = 2.5;
const LEAST_INNOVATIONS: usize = 6;
/// The share of rejected measurements above which the others are no fair sample of the innovations.
const MOST_REJECTED: f64 = 0.25;

/// A line of a plot: its name, its role and its points.
type Line = (&'static str, Role, Vec<[f32; 2]>);

/// A position as text.
fn place(place: [f64; 2]) -> String {
    words::place(point(place))
}

fn point(place: [f64; 2]) -> [f32; 2] {
    place.map(|c| c as f32)
}

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
    /// Returns the current estimate and its role.
    fn current(&self) -> Option<(&Filter, Role)> {
        let predicted = || self.predicted.as_ref().or(self.before.as_ref()).map(|filter| (filter, Role::Predicted));
        self.after.as_ref().map(|filter| (filter, self.role)).or_else(predicted)
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

    pub(super) fn explained_step(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Mixed(_)) => line::MIX,
            Some(Event::Drawn(_)) => line::DRAW,
            Some(Event::Predicted(_)) => line::PREDICT,
            Some(Event::Observed(_)) => line::MEASURE,
            Some(Event::Begun(..) | Event::Missed(None)) => line::BEGIN_OBJECT,
            Some(Event::Gated(_)) => line::GATE,
            Some(Event::Updated(_)) => line::UPDATE,
            Some(Event::Weighed(_)) => line::WEIGH_MODES,
            Some(Event::Retried(_)) => line::RESTART,
            Some(Event::Missed(Some(_)) | Event::Lost(..)) => line::COAST_OR_END,
            Some(Event::Smoothed(_)) => line::SMOOTH,
            Some(Event::Kept(_)) => line::EACH_FRAME_BACK,
        };
        let now = self.now(seen);
        Step { values: Vec::new(), line, sentence: self.sentence(seen, &now), readouts: self.readouts(seen, &now) }
    }

    fn sentence(&self, seen: &Seen<Self>, now: &StepEstimates) -> Sentence {
        let said = Sentence::default();
        let StepEstimates { frame, .. } = now;
        let Some(event) = seen.events.last() else {
            return said
                .text("The Kalman filter estimates the state x (position, velocity) and its covariance P. In each frame it ")
                .ink(Role::Predicted, "predicts")
                .text(" both, gates the ")
                .ink(Role::Measured, "measurement")
                .text(" and ")
                .ink(Role::Estimate, "updates")
                .text(" both by a measurement within the gate.");
        };
        let said = match event {
            Event::Mixed(before) => modes::mixed(before),
            Event::Drawn(before) => modes::drawn(before),
            Event::Predicted(both) => {
                let [before, after] = both.each_ref().map(deviation);
                said.text(format!("Prediction for frame {frame}: "))
                    .ink(Role::Predicted, format!("{} px", place(both[1].place())))
                    .text(format!(
                        ". {} increase the standard deviation of the position from {} to {} px.",
                        self.sources(),
                        px(before),
                        px(after)
                    ))
                    .text(modes::bent(&both[0]))
            }
            Event::Observed(observed) => {
                let unmatched = match (&seen.before.filter, self.clicks.all().is_empty()) {
                    (Some(_), _) => ", none of them of the tracked object.",
                    (None, false) => ", none of them at a clicked position. The track starts at the clicked object.",
                    (None, true) => ". The track starts in a later frame, with the object that moves most consistently.",
                };
                measurements((*frame, unmatched), observed, seen.before.detector.measurement())
            },
            Event::Gated(gated) => self.gating(gated).text(self.misfit(seen, gated)),
            Event::Updated(update) => {
                modes::updated(&update.0, &update.1).unwrap_or_else(|| updated(&update.0, &update.1))
            }
            Event::Weighed(update) => modes::weighed(&update.0, &update.1),
            Event::Begun(filter, there) => said
                .text("The first measurement starts a track at ")
                .ink(Role::Estimate, format!("{} px", place(filter.place())))
                .text(format!(
                    ". Its velocity is unknown, so it starts at 0 with a standard deviation of {} px/frame (parameter Initial speed).",
                    px(f64::from(self.initial_speed))
                ))
                .text(if *there > 0 && self.object > *there {
                    format!(" Object {} was chosen, but {} detected; the last one is tracked.", self.object, are(*there))
                } else {
                    String::new()
                }),
            Event::Retried(retry) => retried(retry),
            Event::Missed(None) => said.text(match seen.before.begun {
                0 => self.waiting(seen, *frame),
                _ => format!("No track after the deletion, and no measurement in frame {frame} to start one."),
            }),
            Event::Missed(Some(filter)) => self.coasting(seen, now, filter),
            Event::Lost(filter, loss) => said
                .text(match loss {
                    Loss::Missed => {
                        format!("No accepted measurement for more than {} (the maximum age):", count(self.max_age, "frame"))
                    }
                    Loss::Outside => {
                        format!("The prediction {} px is far outside the picture:", place(filter.place()))
                    }
                })
                .text(" the track is deleted. The next measurement starts another."),
            Event::Smoothed(all) => {
                let far = distance(all[0].place(), all[1].place());
                said.text(format!("Smoothing frame {frame} with the later measurements moves the estimate by {} px to ", px(far)))
                    .ink(Role::Result, format!("{} px", place(all[1].place())))
                    .text(format!(
                        ". The standard deviation of the position changes from {} to {} px.",
                        px(deviation(&all[0])),
                        px(deviation(&all[1]))
                    ))
            }
            Event::Kept(Some(_)) => said.text(format!(
                "Frame {frame} is the last of its track: without later measurements, the smoothed estimate is the filtered one."
            )),
            Event::Kept(None) => said.text(format!("Frame {frame} has no estimate to smooth.")),
        };
        let conclusion = self.conclusion(seen);
        match event {
            _ if conclusion.is_empty() => said,
            // The run is about its result, not about a frame before the track.
            Event::Kept(None) => Sentence::default().text(conclusion.trim_start()),
            _ => Sentence::default().text(format!("{} ", conclusion.trim_start())).then(said),
        }
    }

    /// What increases the covariance in a prediction.
    fn sources(&self) -> &'static str {
        match self.motion {
            MotionModel::Velocity => "Process noise Q and the uncertain velocity",
            MotionModel::Acceleration => "Process noise Q and the uncertain velocity and acceleration",
            MotionModel::Turn | MotionModel::Unscented | MotionModel::Interacting => {
                "Process noise Q and the uncertain velocity and turn rate"
            }
        }
    }

    /// Why no track has started yet.
    fn waiting(&self, seen: &Seen<Self>, frame: usize) -> String {
        let detections = seen.events.iter().find_map(|event| match event {
            Event::Observed(observed) => Some(observed.detections.len()),
            _ => None,
        });
        match detections.filter(|count| *count > 0) {
            Some(detections) if seen.before.detector.is_moving() => {
                let none = match detections {
                    1 => "the only detection does not belong".to_owned(),
                    _ => format!("none of the {} belongs", count(detections, "detection")),
                };
                format!(
                    "No track yet: {none} to the object that moves most consistently. To track another object, choose \
                     Place beside the parameter Clicks and click on the object."
                )
            }
            Some(detections) => {
                format!(
                    "No track has started yet: none of {} in frame {frame} was chosen.",
                    count(detections, "detection")
                )
            }
            None => format!("No measurement up to frame {frame}: no track has started yet."),
        }
    }

    /// The comparison of d² with the gate.
    fn gating(&self, gated: &Gated) -> Sentence {
        let dof = gated.measurement().numbers();
        let limit = format!("{} gate {} (χ², {dof} dof)", percent(self.gate), squared(gated.limit));
        let said = Sentence::default()
            .text(format!("Squared Mahalanobis distance of the {}innovation: ", sensor(gated)))
            .ink(Role::Measured, format!("d² = {}", squared(gated.squared_distance)));
        if gated.is_inside() && gated.is_beyond() {
            said.text(format!(". It exceeds the {limit}, but a clicked position is accepted without the gate."))
        } else if gated.is_inside() {
            said.text(format!(". It is within the {limit}: accepted."))
        } else {
            said.text(". ").ink(Role::Error, format!("It exceeds the {limit}: rejected."))
        }
    }

    /// A frame without an accepted measurement, and after three rejections in a row a remedy.
    fn coasting(&self, seen: &Seen<Self>, now: &StepEstimates, filter: &Filter) -> Sentence {
        let missed = missed_in_a_row(seen.before.missed + 1);
        let said = Sentence::default()
            .text(match now.gated.len() {
                0 => "No measurement: the track coasts at the prediction ",
                1 => "The measurement is rejected, so the track coasts at the prediction ",
                _ => "All measurements are rejected, so the track coasts at the prediction ",
            })
            .ink(Role::Estimate, format!("{} px", place(filter.place())))
            .text(format!(". {missed} (maximum age {}).", self.max_age));
        let earlier = seen.before.records.iter().rev();
        let is_rejected = |gated: &[Gated]| !gated.is_empty() && !gated.iter().any(Gated::is_inside);
        let earlier = earlier.take_while(|record| is_rejected(&record.gated)).filter_map(|record| record.gated.first());
        let rejected: Vec<&Gated> = earlier.chain(now.gated.first().copied()).collect();
        match rejected.len() {
            LEAST_REJECTED.. if !now.gated.is_empty() => said.text(format!(
                " {} rejections in a row{}",
                rejected.len(),
                match of_another(&rejected) {
                    Some(true) => ", all of other objects: the tracked object is not detected (occluded or out of the picture), and the \
                                   gate is right."
                        .to_owned(),
                    Some(false) => format!(", all of the object: the motion model does not fit. {}", self.remedy(&rejected, self.failed(seen))),
                    None => format!(
                        ". The object may be occluded and the nearest detection another object's; then the gate is right to reject it. \
                         If the rejected measurements are of the object, the motion model does not fit. {}",
                        self.remedy(&rejected, self.failed(seen))
                    ),
                }
            )),
            _ => said,
        }
    }

    /// After three clicked positions in a row outside the gate: what to change.
    fn misfit(&self, seen: &Seen<Self>, gated: &Gated) -> String {
        if !gated.reading.is_clicked || !gated.is_beyond() {
            return String::new();
        }
        let earlier = seen.before.records.iter().rev();
        let earlier = earlier.map_while(|record| record.of_sensor(0).filter(|gated| gated.is_beyond()));
        let beyond: Vec<&Gated> = earlier.chain([gated]).collect();
        match beyond.len() {
            count @ 3.. => {
                format!(
                    " {count} in a row lie outside it: the motion model does not fit. {}",
                    self.remedy(&beyond, None)
                )
            }
            _ => String::new(),
        }
    }

    /// The parameters to change where the motion model does not fit these measurements.
    fn remedy(&self, gated: &[&Gated], failed: Option<&Retry>) -> String {
        if let Some(retry) = failed {
            return format!(
                "Filtered again from frame {}, {}, so no other motion model explains them: raise the process noise, or choose another detector.",
                retry.first,
                trials(&retry.others)
            );
        }
        let remedy = match self.motion {
            MotionModel::Velocity if is_sideways(gated) => {
                "The measurements lie beside the predicted path: choose the coordinated turn, or constant acceleration for a thrown object."
            }
            MotionModel::Velocity => {
                "The measurements lie along the predicted path: choose the motion model of constant acceleration, or raise the process noise."
            }
            MotionModel::Interacting => {
                "Neither mode does: raise the process noise or the turn noise, or choose another motion model."
            }
            _ => "Raise the process noise, or choose another motion model.",
        };
        remedy.into()
    }

    /// The last attempt to restart the present track, if it failed.
    fn failed<'a>(&self, seen: &Seen<'a, Self>) -> Option<&'a Retry> {
        let of_step = seen.events.iter().find_map(|event| match event {
            Event::Retried(retry) => Some(&**retry),
            _ => None,
        });
        let start = seen.before.records.iter().rposition(|record| record.begins)? + seen.before.span.first;
        of_step.or(seen.before.retry.as_deref()).filter(|retry| retry.first == start && retry.restart.is_none())
    }

    /// The mean innovation where it is not zero, and the remedy. Each innovation is divided by its standard deviation from S: the first ones
    /// are so uncertain that they would hide the others. (Y. Bar-Shalom, X.-R. Li and T. Kirubarajan, Estimation with applications to
    /// tracking and navigation, 2001, section 5.4.)
    fn bias(&self, accepted: &[&Gated]) -> String {
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
        if accepted.len() < LEAST_INNOVATIONS || !is_biased {
            return String::new();
        }
        let mean = sum.map(|sum| sum / accepted.len() as f64);
        format!(
            " The innovations are biased by {} px: the motion model does not fit. {}",
            place(mean),
            self.remedy(accepted, None)
        )
    }

    /// The state at the end of a run.
    fn ended<'a>(&self, seen: &Seen<'a, Self>) -> Option<&'a State> {
        let state = seen.after?;
        let frames = state.records.len();
        let is_over = match state.back {
            Some(done) => done == frames,
            None => !self.smooths() && state.span.frames() == Some(frames),
        };
        is_over.then_some(state)
    }

    /// The figures of a run: errors beside the truth, rejections, and the mean NIS with its band.
    fn run_facts(&self, state: &State) -> Vec<Fact> {
        let mut facts = Vec::new();
        let rmse = |of: &dyn Fn(&FrameRecord) -> Option<[f64; 2]>| {
            root_mean_square(state.records.iter().filter_map(|record| Some(distance(of(record)?, record.truth?))))
        };
        let mut error = |label, value: Option<f64>| {
            facts.extend(value.map(|value| Fact::new(label, format!("{} px", px(value)), None)));
        };
        error("RMS error, filtered", rmse(&|record| Some(record.filtered?.place())));
        if self.smooths() {
            error("RMS error, smoothed", rmse(&|record| Some(record.smoothed?.place())));
        }
        // Only frames with an accepted measurement compare the filter with its sensor: a rejected one may be that of another object.
        fn accepted_in(record: &FrameRecord) -> Option<&Gated> {
            record.of_sensor(0).filter(|gated| gated.is_inside())
        }
        error("RMS error, accepted measurements", rmse(&|record| Some(accepted_in(record)?.measurement().place)));
        error(
            "RMS error, filtered in these frames",
            rmse(&|record| accepted_in(record).and(Some(record.filtered?.place()))),
        );
        if let Some(ConsistencyTest { mean, band: [low, high], .. }) = consistency(&accepted(state)) {
            let value = format!("{}, 95 % band {}–{}", squared(mean), squared(low), squared(high));
            facts.push(Fact::new("Mean NIS (accepted)", value, None));
        }
        facts
    }

    /// At the end of a run: rejections, bias, consistency by the mean NIS, and the remedy.
    fn conclusion(&self, seen: &Seen<Self>) -> String {
        let Some(state) = self.ended(seen) else { return String::new() };
        let noise = f64::from(self.measurement_noise);
        let restarted = state.retry.as_deref().map(restarted).unwrap_or_default();
        let mut said = restarted + &modes::concluded(state.records.iter().map(|record| &**record), noise);
        let gated: Vec<&Gated> = state.records.iter().filter_map(|record| record.of_sensor(0)).collect();
        let nis = accepted(state);
        let rejected = gated.len() - nis.len();
        if rejected > 0 {
            said += &format!(" The gate rejected {rejected} of {}.", count(gated.len(), "measurement"));
        }
        let Some(test) = consistency(&nis) else {
            return said
                + " No measurement was accepted, so the innovations do not show whether the covariance is right.";
        };
        let bias = self.bias(&nis);
        said += &bias;
        // The gate cuts off the large values: their mean would look consistent whatever the filter does.
        if rejected as f64 > MOST_REJECTED * gated.len() as f64 {
            let refused: Vec<&Gated> = gated.iter().copied().filter(|gated| !gated.is_inside()).collect();
            return said + &self.untested(&refused, gated.len(), self.failed(seen));
        }
        said + &test.verdict(!bias.is_empty())
    }

    /// Why the mean NIS tests nothing where many of `all` measurements were refused, and the remedy.
    fn untested(&self, refused: &[&Gated], all: usize, failed: Option<&Retry>) -> String {
        let share = (100.0 * refused.len() as f64 / all as f64).round();
        let said = format!(" With {share} % rejected, the NIS of the rest does not test the filter.");
        let diverged = "so the filter has diverged: the motion model does not fit.";
        match of_another(refused) {
            Some(true) => said + " All rejected measurements are of other objects: the gate was right.",
            Some(false) => format!("{said} They are of the object, {diverged} {}", self.remedy(refused, failed)),
            None => format!(
                "{said} If the rejected measurements are of the object, the filter has diverged: the motion model does not fit. {}",
                self.remedy(refused, failed)
            ),
        }
    }

    fn readouts(&self, seen: &Seen<Self>, now: &StepEstimates) -> Vec<Readout> {
        let mut readouts = vec![Readout::Facts(self.facts(seen, now))];
        readouts.extend(self.equation(seen.events.last()));
        let records = seen.before.records.iter().map(|record| &**record);
        let matrices = matrices(seen.events.last(), now.current(), records);
        if !matrices.is_empty() {
            readouts.push(Readout::Matrices(matrices));
        }
        readouts.extend(self.series(seen));
        readouts.extend(self.hill(seen.events.last(), now).map(Readout::Landscape));
        readouts
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

    fn facts(&self, seen: &Seen<Self>, now: &StepEstimates) -> Vec<Fact> {
        let mut facts = vec![Fact::new("Frame", now.frame.to_string(), None)];
        facts.extend(self.ended(seen).into_iter().flat_map(|state| self.run_facts(state)));
        let current = now.current();
        if let Some((filter, role)) = current {
            let ([u, v], [[xx, _], [_, yy]]) = (filter.velocity(), filter.place_covariance());
            facts.push(Fact::new("Position", format!("{} px", place(filter.place())), Some(role)));
            facts.push(Fact::new("Velocity", format!("{} px/frame", place([u, v])), None));
            facts.push(Fact::new("Speed", format!("{} px/frame", px(u.hypot(v))), None));
            facts.push(Fact::new(
                "Standard deviations σ",
                format!("({},\u{a0}{}) px", px(xx.sqrt()), px(yy.sqrt())),
                None,
            ));
            facts.extend(modes::facts(filter));
        }
        if let Some(gated) = now.gated.last() {
            facts.push(Fact::new(
                "Measurement",
                format!("{} px", place(gated.measurement().place)),
                Some(Role::Measured),
            ));
            facts.push(Fact::new(
                "NIS",
                format!("{}, gate {}", squared(gated.squared_distance), squared(gated.limit)),
                None,
            ));
        }
        if let (Some(truth), Some((filter, _))) = (truth(seen), current) {
            facts.push(Fact::new("Truth", format!("{} px", place(truth)), Some(Role::Truth)));
            facts.push(Fact::new("Error", format!("{} px", px(distance(truth, filter.place()))), Some(Role::Error)));
            facts.extend(filter.squared_error(truth).map(|nees| Fact::new("NEES", squared(nees), None)));
        }
        facts
    }
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

/// The measurements of a frame in words.
fn measurements((frame, unmatched): (usize, &str), observed: &Observations, kind: &str) -> Sentence {
    let said = Sentence::default();
    let [first, second] = [0, 1].map(|sensor| observed.measured.iter().find(|reading| reading.sensor == sensor));
    let numbers = |reading: &SensorReading| {
        let Measurement { place: at, place_deviation, .. } = reading.measurement;
        (format!("{} px", place(at)), format!(", measurement noise σ = {} px", px(place_deviation)))
    };
    let said = match first.map(numbers) {
        Some((at, noise)) => {
            let object = first.map(measured_object).unwrap_or_default();
            said.ink(Role::Measured, format!("Measurement: {at}")).text(format!(" ({kind}{object}){noise}."))
        }
        None if observed.is_hidden && second.is_some() => {
            said.text(format!("Frame {frame} is in the simulated occlusion of the first sensor."))
        }
        None if observed.is_hidden => {
            said.text(format!("Frame {frame} is in the simulated occlusion: no measurement."))
        }
        None if !observed.detections.is_empty() => said
            .ink(Role::Measured, format!("{} in frame {frame}", count(observed.detections.len(), "detection")))
            .text(unmatched),
        None => said.text(format!("No detections in frame {frame}.")),
    };
    match second.map(numbers) {
        Some((at, noise)) => said.ink(Role::Measured, format!(" Second sensor: {at}")).text(format!("{noise}.")),
        None => said,
    }
}

/// The measured object, where the source knows it.
fn measured_object(reading: &SensorReading) -> String {
    match (reading.object, reading.tracked.filter(|_| reading.is_of_another() == Some(true))) {
        (Some(object), Some(tracked)) => format!(", of object {object}; the tracked object is {tracked}"),
        (Some(object), None) => format!(", of object {object}"),
        (None, _) => String::new(),
    }
}

/// The update of state and covariance by an accepted measurement.
fn updated(gated: &Gated, after: &Filter) -> Sentence {
    let from = &gated.expected;
    let gain = from.update_numbers(gated.measurement()).map_or(0.0, |numbers| numbers.gain[(0, 0)]);
    let speed = |filter: &Filter| place(filter.velocity());
    Sentence::default()
        .text(format!("Update with Kalman gain {} along x: position ", ratio(gain)))
        .ink(Role::Estimate, format!("{} → {} px", place(from.place()), place(after.place())))
        .text(format!(
            ", velocity {} → {} px/frame. The standard deviation of the position falls from {} to {} px.",
            speed(from),
            speed(after),
            px(deviation(from)),
            px(deviation(after))
        ))
}

/// Whether all measurements are of other objects than the tracked one, or none is; `None` where they differ or it is unknown.
fn of_another(measurements: &[&Gated]) -> Option<bool> {
    let first = measurements.first()?.reading.is_of_another()?;
    measurements.iter().all(|gated| gated.reading.is_of_another() == Some(first)).then_some(first)
}

fn root_mean_square(errors: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut number) = (0.0, 0);
    for error in errors {
        (sum, number) = (sum + error * error, number + 1);
    }
    (number > 0).then(|| (sum / f64::from(number)).sqrt())
}

/// The numbers of accepted measurements of motion models in words.
fn trials(trials: &[Trial]) -> String {
    if trials.is_empty() {
        return "no other motion model keeps the track".into();
    }
    let all: Vec<String> = trials.iter().map(accepts).collect();
    all.join(", ")
}

fn accepts(trial: &Trial) -> String {
    let Trial { motion, accepted, measured } = trial;
    format!("{} accepts {accepted} of {}", motion_name(*motion), count(*measured, "measurement"))
}

fn motion_name(motion: MotionModel) -> String {
    motion.label().to_lowercase()
}

/// The detections of a diverged track, filtered again.
fn retried(retry: &Retry) -> Sentence {
    let said = Sentence::default().ink(Role::Error, "The filter has diverged").text(format!(
        ": since frame {}, {}. Filtered again, {}. ",
        retry.first,
        accepts(&retry.diverged),
        trials(&retry.others)
    ));
    match &retry.restart {
        Some(restart) => said
            .text(if restart.first == retry.first {
                "The track is restarted with ".to_owned()
            } else {
                format!(
                    "It started with something else: from frame {} the most consistent motion is tracked with ",
                    restart.first
                )
            })
            .ink(Role::Result, motion_name(restart.trial.motion))
            .text(format!(
                ", which accepts {} of {}: {} px.",
                restart.trial.accepted,
                restart.trial.measured,
                place(restart.filter.place())
            )),
        None => said.text("No model accepts the rejected ones, so the track goes on as it is."),
    }
}

/// The last restart of a run in words, or nothing.
fn restarted(retry: &Retry) -> String {
    let Some(Restart { trial, first, .. }) = &retry.restart else { return String::new() };
    format!(
        " The filter had diverged in frame {}: {}. The track was restarted from frame {first} with {} (parameter Motion), which \
         accepts {} of {}.",
        retry.frame,
        accepts(&retry.diverged),
        motion_name(trial.motion),
        trial.accepted,
        trial.measured
    )
}

fn are(there: usize) -> String {
    if there == 1 { "only one was".into() } else { format!("only {there} were") }
}

/// The current frame.
fn frame_of(state: &State) -> usize {
    let count = state.records.len();
    state.span.first + state.back.map_or(count, |done| count.saturating_sub(done + 1))
}

fn sensor(gated: &Gated) -> &'static str {
    if gated.reading.sensor == 0 { "" } else { "second sensor's " }
}

/// Whether measurements lie farther beside the predicted path than along it, as those of a turn do.
fn is_sideways(gated: &[&Gated]) -> bool {
    let [along, beside] = gated.iter().fold([0.0; 2], |sums, gated| {
        let (from, to) = (gated.expected.place(), gated.measurement().place);
        let ([u, v], [x, y]) = (gated.expected.velocity(), [0, 1].map(|k| to[k] - from[k]));
        let speed = u.hypot(v).max(f64::MIN_POSITIVE);
        [sums[0] + (u * x + v * y) / speed, sums[1] + (u * y - v * x) / speed]
    });
    beside.abs() > along.abs()
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
