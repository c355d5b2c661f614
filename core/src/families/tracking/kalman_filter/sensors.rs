//! What measures the object that the filter follows, each sensor by itself.

use std::sync::Arc;

use super::{KalmanFilter, State};
use crate::base::Error;
use crate::choices;
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::methods::{
    kalman::{Filter, Measurement},
    multi_object::source::truth_of,
};

choices! {
    /// What measures the object.
    pub enum Sensors {
        /// One that tells where it is.
        One = "one" "One position",
        /// Two that tell where it is, each with its own noise.
        Two = "two-positions" "Two positions",
        /// One that tells where it is, and one that tells where it is and how it moves.
        WithVelocity = "position-and-velocity" "Position, and position with velocity",
    }
}

/// What one sensor measures of the object.
#[derive(Clone, Copy, Debug)]
pub struct SensorReading {
    /// 0 or 1.
    pub sensor: usize,
    pub measurement: Measurement,
    /// The detection that it is made of, if it is made of one.
    pub detection: Option<usize>,
}

/// What there is to see of a frame.
#[derive(Clone, Debug)]
pub struct Observations {
    pub detections: Arc<Vec<Detection>>,
    /// What is measured of the object, by sensor.
    pub measured: Vec<SensorReading>,
    /// Where it truly is.
    pub truth: Option<[f64; 2]>,
    /// Whether the frame is one of those in which the first sensor sees nothing.
    pub is_hidden: bool,
}

impl KalmanFilter {
    /// What all sensors see of frame `t` if an object is expected there; what it may begin with if there is none.
    pub(super) fn observe(
        &self,
        (clip, t): (&Clip, usize),
        state: &State,
        expected: Option<&Filter>,
    ) -> Result<Observations, Error> {
        let truth = state.truth_id.map(|id| truth_of(clip, t, id)).transpose()?.flatten();
        let index = t - state.span.first;
        let is_hidden = index.checked_sub(self.drop_from).is_some_and(|index| index < self.drop_frames);
        let detections = Arc::new(if is_hidden { Vec::new() } else { state.detector.look(clip, t)? });
        let chosen = match expected {
            Some(expected) => self.nearest(expected, &detections),
            None => self.begin_with((state, t), &detections),
        };
        let first = chosen.map(|i| SensorReading { sensor: 0, measurement: self.first(&detections[i]), detection: Some(i) });
        // An object that has not begun has no truth that could be measured.
        let second = expected.map(|_| self.second(clip, state, t)).transpose()?.flatten();
        let second = second.map(|measurement| SensorReading { sensor: 1, measurement, detection: None });
        Ok(Observations { detections, measured: first.into_iter().chain(second).collect(), truth, is_hidden })
    }

    /// What the first sensor says of a detection.
    fn first(&self, detection: &Detection) -> Measurement {
        let place = detection.center.map(f64::from);
        Measurement { place, place_deviation: f64::from(self.measurement_noise), velocity: None }
    }

    /// What the second sensor says, of a true place: it has a noise of its own.
    fn second(&self, clip: &Clip, state: &State, t: usize) -> Result<Option<Measurement>, Error> {
        let (Some(id), false) = (state.truth_id, self.sensors == Sensors::One) else { return Ok(None) };
        let at = |t: Option<usize>| t.map_or(Ok(None), |t| truth_of(clip, t, id));
        let Some(now) = at(Some(t))? else { return Ok(None) };
        let [x, y, u, v] = state.detector.chances(id, t);
        let deviation = f64::from(self.second_noise);
        let place = [now[0] + deviation * x, now[1] + deviation * y];
        let velocity = if self.sensors == Sensors::WithVelocity {
            let next = if state.span.frames().is_some_and(|frames| t + 1 < state.span.first + frames) {
                at(Some(t + 1))?
            } else {
                None
            };
            true_velocity([at(t.checked_sub(1))?, Some(now), next])
        } else {
            None
        };
        let deviation_v = f64::from(self.velocity_noise);
        let velocity = velocity.map(|[tu, tv]| ([tu + deviation_v * u, tv + deviation_v * v], deviation_v));
        Ok(Some(Measurement { place, place_deviation: deviation, velocity }))
    }

    /// The detection that is nearest to what is expected.
    fn nearest(&self, expected: &Filter, detections: &[Detection]) -> Option<usize> {
        let far = |i: &usize| expected.squared_distance(&self.first(&detections[*i])).unwrap_or(f64::INFINITY);
        (0..detections.len()).min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// The detection that the object begins with: in the order of the source, the surest first where it tells how sure it is.
    ///
    /// Whoever clicked on an object has chosen it, unless clicks are what is measured: it begins in that frame.
    fn begin_with(&self, (state, t): (&State, usize), detections: &[Detection]) -> Option<usize> {
        if !self.clicks.all().is_empty() && !state.detector.takes_clicks() {
            return self.clicks.of_frame(t).find_map(|click| nearest_to(click, detections));
        }
        let mut ranked: Vec<usize> = (0..detections.len()).collect();
        if state.detector.tells_scores() {
            // Of a stable order: those of one score keep theirs.
            ranked.sort_by(|a, b| detections[*b].score.total_cmp(&detections[*a].score));
        }
        ranked.get(self.object - 1).or(ranked.last()).copied()
    }
}

/// The detection that someone means who clicked at a place: the one whose box reaches nearest to it, if one does.
fn nearest_to(click: [f32; 2], detections: &[Detection]) -> Option<usize> {
    let far = |i: &usize| {
        let Bounds { min, max } = detections[*i].bounds;
        let off = [0, 1].map(|axis| (min[axis] - click[axis]).max(click[axis] - max[axis]).max(0.0));
        // Of boxes that hold the place the one whose middle is nearest.
        let middle = [0, 1].map(|axis| detections[*i].center[axis] - click[axis]);
        (off[0].hypot(off[1]), middle[0].hypot(middle[1]))
    };
    let order = |a: &usize, b: &usize| far(a).0.total_cmp(&far(b).0).then(far(a).1.total_cmp(&far(b).1));
    (0..detections.len()).min_by(order).filter(|i| far(i).0 <= CLICK_REACH_PX)
}

/// A click means a box that is at most so far away.
const CLICK_REACH_PX: f32 = 24.0;

/// The velocity in px/frame by the places in the frame before, in this one and in the next: from the one to the other where both
/// are known, so that a steady acceleration does not change it.
fn true_velocity(places: [Option<[f64; 2]>; 3]) -> Option<[f64; 2]> {
    let [before, now, after] = places;
    let apart = |from: [f64; 2], to: [f64; 2], frames: f64| [0, 1].map(|i| (to[i] - from[i]) / frames);
    match (before, now, after) {
        (Some(before), _, Some(after)) => Some(apart(before, after, 2.0)),
        (Some(before), Some(now), None) => Some(apart(before, now, 1.0)),
        (None, Some(now), Some(after)) => Some(apart(now, after, 1.0)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_acceleration_does_not_change_the_velocity_measured() {
        let at = |t: f64| Some([3.0 * t + 2.0 * t * t, -t]);
        assert_eq!(true_velocity([at(4.0), at(5.0), at(6.0)]), Some([23.0, -1.0]));
        assert_eq!(true_velocity([at(4.0), at(5.0), None]), Some([21.0, -1.0]));
        assert_eq!(true_velocity([None, at(5.0), None]), None);
    }
}
