//! The sensors of the tracked object.

use std::sync::Arc;

use super::{KalmanFilter, State};
use crate::base::Error;
use crate::choices;
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::methods::{
    kalman::{Filter, Measurement, chi_square},
    multi_object::{Extent, source::truth_of},
};

choices! {
    /// The sensors of the object.
    pub enum Sensors {
        /// One sensor: position.
        One = "one" "One position",
        /// Two sensors: positions with different noise.
        Two = "two-positions" "Two positions",
        /// Two sensors: position, and position with velocity.
        WithVelocity = "position-and-velocity" "Position, and position with velocity",
    }
}

/// The measurement of one sensor.
#[derive(Clone, Copy, Debug)]
pub struct SensorReading {
    /// The index of the sensor, 0 or 1.
    pub sensor: usize,
    pub measurement: Measurement,
    /// The detection that the measurement is made of, if any.
    pub detection: Option<usize>,
    /// The true object that is measured, where the source of the detections knows it.
    pub object: Option<u32>,
    /// The true object of the track.
    pub tracked: Option<u32>,
    /// Whether a person has clicked it: the gate does not reject it.
    pub is_clicked: bool,
}

impl SensorReading {
    /// Returns whether it measures another object than the tracked one, where that is known.
    pub fn is_of_another(&self) -> Option<bool> {
        Some(self.object? != self.tracked?)
    }
}

/// The detections, measurements and truth of a frame.
#[derive(Clone, Debug)]
pub struct Observations {
    pub detections: Arc<Vec<Detection>>,
    /// The measurements of the object, by sensor.
    pub measured: Vec<SensorReading>,
    /// The true position in px.
    pub truth: Option<[f64; 2]>,
    /// Whether the first sensor is occluded by the simulated occlusion.
    pub is_hidden: bool,
}

impl KalmanFilter {
    /// Returns the measurements of frame `t`: those of the predicted object, or those that a track may start with.
    pub(super) fn observe(
        &self,
        (clip, t): (&Clip, usize),
        state: &State,
        expected: Option<&Filter>,
    ) -> Result<Observations, Error> {
        let truth = state.truth_id.map(|id| truth_of(clip, t, id)).transpose()?.flatten();
        let index = t - state.span.first;
        let is_hidden = index.checked_sub(self.occlusion_start).is_some_and(|index| index < self.occlusion_frames);
        let detections = Arc::new(if is_hidden { Vec::new() } else { state.detector.look(clip, t)? });
        let chosen = match expected {
            Some(expected) => self.nearest((expected, state.extent), &detections),
            None => self.begin_with((clip, t), state, &detections)?,
        };
        let object = chosen.map(|i| state.detector.object_of(clip, t, i)).transpose()?.flatten();
        let detected = chosen.map(|i| SensorReading {
            sensor: 0,
            measurement: self.first(&detections[i]),
            detection: Some(i),
            object,
            tracked: state.truth_id,
            is_clicked: state.detector.is_clicked(),
        });
        let clicked = || self.clicked_alone(state, t).filter(|_| expected.is_none() && !is_hidden);
        let first = detected.or_else(clicked);
        // Before a track starts its true object is unknown.
        let second = expected.map(|_| self.second(clip, state, t)).transpose()?.flatten();
        let second = second.map(|measurement| SensorReading {
            sensor: 1,
            measurement,
            detection: None,
            object: state.truth_id,
            tracked: state.truth_id,
            is_clicked: false,
        });
        Ok(Observations { detections, measured: first.into_iter().chain(second).collect(), truth, is_hidden })
    }

    /// Returns the position of a click that chooses the object, where no detection is near: the object is there all the same.
    fn clicked_alone(&self, state: &State, t: usize) -> Option<SensorReading> {
        let place = self.clicks.of_frame(t).next().filter(|_| !state.detector.is_clicked())?.map(f64::from);
        let measurement = Measurement { place, place_deviation: f64::from(self.measurement_noise), velocity: None };
        let (object, tracked) = (None, state.truth_id);
        Some(SensorReading { sensor: 0, measurement, detection: None, object, tracked, is_clicked: true })
    }

    fn first(&self, detection: &Detection) -> Measurement {
        let place = detection.center.map(f64::from);
        Measurement { place, place_deviation: f64::from(self.measurement_noise), velocity: None }
    }

    /// Returns the second sensor's measurement: the truth with independent noise.
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

    /// Returns the detection of the least Mahalanobis distance from the prediction. Of a blob, width and height count as well, as
    /// attributes of the object (S. Blackman and R. Popoli, Design and analysis of modern tracking systems, 1999): a blob that differs
    /// too much in size is another one.
    fn nearest(&self, (expected, extent): (&Filter, Option<Extent>), detections: &[Detection]) -> Option<usize> {
        let limit = chi_square::quantile(SIZE_GATE, 2);
        let off = |found: &Detection| {
            let extent = extent.filter(|_| found.blob.is_some());
            extent.map_or(0.0, |extent| extent.size_distance(found, SIZE_DEVIATION))
        };
        let far = |i: &usize| {
            let found = &detections[*i];
            expected.squared_distance(&self.first(found)).unwrap_or(f64::INFINITY) + off(found)
        };
        (0..detections.len()).filter(|i| off(&detections[*i]) <= limit).min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// Returns the detection that a track starts with: in the order of the source, by score where there are scores.
    ///
    /// A click on an object chooses it and its first frame, unless clicks are the measurements. Of blobs, the one that moves most
    /// consistently is chosen, and the track starts where its motion does.
    fn begin_with(
        &self,
        (clip, t): (&Clip, usize),
        state: &State,
        detections: &[Detection],
    ) -> Result<Option<usize>, Error> {
        if !self.clicks.all().is_empty() && !state.detector.is_clicked() {
            return Ok(self.clicks.of_frame(t).find_map(|click| nearest_to(click, detections)));
        }
        if self.object == 1
            && state.detector.is_moving()
            && !detections.is_empty()
            && let Some(blob) = self.most_consistent((clip, t), state)?
        {
            return Ok((blob.frame == 0).then_some(blob.index));
        }
        let mut ranked: Vec<usize> = (0..detections.len()).collect();
        if state.detector.has_scores() {
            // The sort is stable: equal scores keep their order.
            ranked.sort_by(|a, b| detections[*b].score.total_cmp(&detections[*a].score));
        }
        Ok(ranked.get(self.object - 1).or(ranked.last()).copied())
    }
}

/// The standard deviation of the logarithm of a blob's width and height between frames.
const SIZE_DEVIATION: f64 = 0.35;
/// The share of the blobs of an object that lie within the gate of its size.
const SIZE_GATE: f64 = 0.99;

/// Returns the detection whose box is nearest to a click, if it is near enough.
fn nearest_to(click: [f32; 2], detections: &[Detection]) -> Option<usize> {
    let far = |i: &usize| {
        let Bounds { min, max } = detections[*i].bounds;
        let off = [0, 1].map(|axis| (min[axis] - click[axis]).max(click[axis] - max[axis]).max(0.0));
        // Among boxes that contain the click, the nearest centre decides.
        let middle = [0, 1].map(|axis| detections[*i].center[axis] - click[axis]);
        (off[0].hypot(off[1]), middle[0].hypot(middle[1]))
    };
    let order = |a: &usize, b: &usize| far(a).0.total_cmp(&far(b).0).then(far(a).1.total_cmp(&far(b).1));
    (0..detections.len()).min_by(order).filter(|i| far(i).0 <= CLICK_REACH_PX)
}

/// The maximum distance of a click from the box that it chooses in px.
const CLICK_REACH_PX: f32 = 24.0;

/// Returns the velocity in px/frame by the positions in the previous, the current and the next frame: the central difference
/// where both neighbours are known, which is exact under constant acceleration.
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
    fn the_central_difference_is_exact_under_constant_acceleration() {
        let at = |t: f64| Some([3.0 * t + 2.0 * t * t, -t]);
        assert_eq!(true_velocity([at(4.0), at(5.0), at(6.0)]), Some([23.0, -1.0]));
        assert_eq!(true_velocity([at(4.0), at(5.0), None]), Some([21.0, -1.0]));
        assert_eq!(true_velocity([None, at(5.0), None]), None);
    }
}
