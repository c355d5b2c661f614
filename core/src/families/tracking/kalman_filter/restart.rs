//! The restart of a diverged track: its detections are filtered again with the other motion models.

use std::sync::Arc;

use super::{FrameRecord, Gated, KalmanFilter, Sensors, State};
use crate::base::Error;
use crate::data::Clip;
use crate::methods::{
    kalman::{Filter, MotionModel},
    multi_object::gating::ln_likelihood,
};

/// The number of latest gated measurements of which more than half are rejected by a diverged filter.
const WINDOW: usize = 6;
/// The least number of rejections that show a divergence.
pub(super) const LEAST_REJECTED: usize = 3;
/// The motion models that are tried.
const MODELS: [MotionModel; 3] = [MotionModel::Velocity, MotionModel::Acceleration, MotionModel::Turn];

/// A motion model on the detections of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    pub motion: MotionModel,
    /// The number of measurements inside the gate.
    pub accepted: usize,
    /// The number of gated measurements.
    pub measured: usize,
}

impl Trial {
    fn of(motion: MotionModel, records: &[Arc<FrameRecord>], last: Option<&FrameRecord>) -> Self {
        let records = records.iter().map(|record| &**record).chain(last);
        let gated: Vec<bool> = records.filter_map(|record| Some(record.of_sensor(0)?.is_inside())).collect();
        Self { motion, accepted: gated.iter().filter(|inside| **inside).count(), measured: gated.len() }
    }

    fn rejected(&self) -> usize {
        self.measured - self.accepted
    }
}

/// A diverged filter, and its detections filtered again.
#[derive(Clone, Debug)]
pub struct Retry {
    /// The frame in which the divergence shows, and the first one of the track.
    pub frame: usize,
    pub first: usize,
    /// The motion model that diverged.
    pub diverged: Trial,
    /// The other motion models.
    pub others: Vec<Trial>,
    /// The restart, if one of them explains the detections.
    pub restart: Option<Restart>,
}

/// A restarted track.
#[derive(Clone, Debug)]
pub struct Restart {
    pub trial: Trial,
    /// Its first frame: that of the diverged track, or a later one if that started with something else.
    pub first: usize,
    /// The estimate in the current frame.
    pub filter: Filter,
    /// The positions from the first frame of the track on.
    pub path: Vec<[f64; 2]>,
}

/// An attempt to restart a track, and if it succeeds the state and the result of this frame.
type Retried = (Retry, Option<(State, FrameRecord)>);

/// A track that another motion model follows.
struct Followed {
    trial: Trial,
    state: State,
    record: FrameRecord,
    log_likelihood: f64,
}

impl KalmanFilter {
    /// Filters the detections of a diverged track again with the other motion models. Returns the outcome, and the state and the result
    /// of this frame after a restart; `None` if the filter has not diverged.
    ///
    /// A model explains the detections if it accepts the ones that were rejected lately and rejects less than half as many in all. A model
    /// that would follow another object behind an occlusion meets the gate in the same frames. Where no model explains them and the gate has
    /// rejected most of the track, it started with something else: a track starts anew at the first rejected detection.
    pub(super) fn retried(&self, clip: &Clip, state: &State, record: &FrameRecord) -> Result<Option<Retried>, Error> {
        let Some(start) = state.records.iter().rposition(|record| record.begins).filter(|_| self.restarts()) else {
            return Ok(None);
        };
        let rejected = rejected_lately(&state.records[start..], record);
        let diverged = Trial::of(state.motion, &state.records[start..], Some(record));
        // Twice as many rejections as at the last attempt: long tracks are not filtered again in each frame.
        let is_due = diverged.rejected() >= 2 * state.retry.as_ref().map_or(0, |retry| retry.rejected_in(start, state));
        if rejected.is_empty() || !is_due {
            return Ok(None);
        }
        let mut retry = Retry {
            frame: state.span.first + state.records.len(),
            first: state.span.first + start,
            diverged,
            others: Vec::new(),
            restart: None,
        };
        let mut best: Option<Followed> = None;
        for motion in MODELS.into_iter().filter(|motion| !is_same(*motion, state.motion)) {
            let Some(again) = self.filtered_again((clip, state), (motion, start), state.begun - 1)? else { continue };
            retry.others.push(again.trial);
            let records = &again.state.records[start..];
            let is_explained = |i: &usize| {
                let record = records.get(*i).map_or(&again.record, |record| record);
                record.of_sensor(0).is_some_and(Gated::is_inside)
            };
            let is_better = best.as_ref().is_none_or(|best| {
                (best.trial.accepted, best.log_likelihood) < (again.trial.accepted, again.log_likelihood)
            });
            if is_better && rejected.iter().all(is_explained) && 2 * again.trial.rejected() < diverged.rejected() {
                best = Some(again);
            }
        }
        let mut start = start;
        if best.is_none() && self.is_started_with_something_else(state, &diverged) {
            start += rejected[0];
            best = self.begun_anew((clip, state), start)?;
        }
        let restarted = best.map(|mut best| {
            let estimates = best.state.records[start..].iter().map(|record| &**record).chain([&best.record]);
            let path = estimates.filter_map(|record| Some(record.filtered?.place())).collect();
            // The most consistent motion may begin later.
            let begun = best.state.records.iter().rposition(|record| record.begins).unwrap_or(start);
            let first = state.span.first + begun;
            retry.restart = best.state.filter.map(|filter| Restart { trial: best.trial, first, filter, path });
            best.state.fresh = best.state.records.len() - start + 1;
            (best.state, best.record)
        });
        Ok(Some((retry, restarted)))
    }

    /// Whether a diverged track is restarted: the gate rejects no clicks, and a second sensor holds the track.
    pub(super) fn restarts(&self) -> bool {
        self.restart && self.sensors == Sensors::One
    }

    /// Whether a track that is chosen by its motion has hardly any measurements of its own.
    fn is_started_with_something_else(&self, state: &State, diverged: &Trial) -> bool {
        let is_chosen_by_motion = state.detector.is_moving() && self.clicks.all().is_empty() && self.object == 1;
        is_chosen_by_motion && diverged.rejected() >= 2 * LEAST_REJECTED && 2 * diverged.rejected() > diverged.measured
    }

    /// Starts a track anew at a frame, with the motion model of the track or another one that accepts all its measurements.
    fn begun_anew(&self, (clip, state): (&Clip, &State), start: usize) -> Result<Option<Followed>, Error> {
        let others = MODELS.into_iter().filter(|motion| !is_same(*motion, state.motion));
        for motion in std::iter::once(state.motion).chain(others) {
            let again = self.filtered_again((clip, state), (motion, start), state.begun)?;
            let is_explained = |again: &Followed| again.trial.rejected() == 0 && again.trial.measured >= LEAST_REJECTED;
            if let Some(again) = again.filter(is_explained) {
                return Ok(Some(again));
            }
        }
        Ok(None)
    }

    /// Filters the frames of a track again, up to the current one; `None` if that track ends before.
    fn filtered_again(
        &self,
        (clip, state): (&Clip, &State),
        (motion, start): (MotionModel, usize),
        begun: u32,
    ) -> Result<Option<Followed>, Error> {
        let plain = Self { restart: false, ..self.clone() };
        let mut again = State {
            motion,
            records: state.records[..start].to_vec(),
            filter: None,
            missed: 0,
            begun,
            extent: None,
            truth_id: None,
            ..state.clone()
        };
        for _ in start..state.records.len() {
            let record = plain.filter_frame(clip, &mut again, &mut ())?;
            again.records.push(Arc::new(record));
        }
        let record = plain.filter_frame(clip, &mut again, &mut ())?;
        if again.filter.is_none() || again.begun != begun + 1 {
            return Ok(None);
        }
        let trial = Trial::of(motion, &again.records[start..], Some(&record));
        let gated = again.records[start..].iter().map(|record| &**record).chain([&record]);
        let accepted = gated.filter_map(|record| record.of_sensor(0)).filter(|gated| gated.is_inside());
        let log_likelihood =
            accepted.map(|gated| ln_likelihood(&gated.expected, gated.measurement(), gated.squared_distance)).sum();
        Ok(Some(Followed { trial, state: again, record, log_likelihood }))
    }
}

impl Retry {
    /// The number of rejections of the attempt, if it is one of the present track.
    fn rejected_in(&self, start: usize, state: &State) -> usize {
        let is_present = self.first == state.span.first + start && self.restart.is_none();
        if is_present { self.diverged.rejected() } else { 0 }
    }
}

/// Whether two motion models differ in the filter only.
fn is_same(a: MotionModel, b: MotionModel) -> bool {
    let plain = |motion| if motion == MotionModel::Unscented { MotionModel::Turn } else { motion };
    plain(a) == plain(b)
}

/// The rejected ones of the latest gated measurements of a track, as indices of its frames; empty unless they are the majority.
fn rejected_lately(records: &[Arc<FrameRecord>], last: &FrameRecord) -> Vec<usize> {
    let records = records.iter().map(|record| &**record).chain([last]).enumerate();
    let gated: Vec<(usize, bool)> =
        records.filter_map(|(i, record)| Some((i, record.of_sensor(0)?.is_inside()))).collect();
    let window = &gated[gated.len().saturating_sub(WINDOW)..];
    let rejected: Vec<usize> = window.iter().filter(|(_, is_inside)| !is_inside).map(|(i, _)| *i).collect();
    let is_diverged = rejected.len() >= LEAST_REJECTED && 2 * rejected.len() > window.len();
    if is_diverged { rejected } else { Vec::new() }
}
