//! The Kalman filters of tracks: motion model and noise, relative to the height of an object.

use super::Extent;
use crate::data::Detection;
use crate::methods::kalman::{Filter, Measurement, Model, MotionModel, Noises};
use crate::{choices, params};

/// Probability that an object changes its mode from one frame to the next, where the motion has modes.
const MODE_SWITCH: f32 = 0.05;

choices! {
    /// The origin of the measurement noise.
    pub enum NoiseFrom {
        /// The noise of the source where it is known, otherwise a share of the box height.
        Source = "source" "Source",
        /// A share of the box height.
        BoxHeight = "box-height" "Box height",
    }
}

/// The least standard deviation of a position in px: positions without noise still differ from the motion model by rounding.
const LEAST_DEVIATION_PX: f64 = 0.25;

params! {
    /// The parameters of the filters of all tracks.
    pub struct Dynamics {
        /// Motion model of the filters.
        motion: MotionModel = MotionModel::Velocity;
        /// Standard deviation of the acceleration, in px/frame² per px of box height; with the constant acceleration model, of its change
        /// per frame.
        process_noise: f32 = 0.02, 0.0..=2.0;
        /// Standard deviation of the change of the turn rate. Used where the motion is a coordinated turn or has one as a mode.
        turn_noise: f32 = 0.5, 0.0..=45.0, "°/frame²";
        /// The measurement noise that the filters assume.
        measurement_noise_from: NoiseFrom = NoiseFrom::Source;
        /// Standard deviation of a detected position along each axis, as a share of the box height. Used unless the source knows its own,
        /// as true boxes with noise do.
        measurement_noise: f32 = 0.1, 0.001..=2.0;
    }
    when {
        "turn-noise": |p| p.motion.turns(),
            "Turn noise has no effect unless the motion is a coordinated turn.";
    }
}

impl Dynamics {
    /// Returns the measurement of a detection.
    pub fn measurement(&self, detection: &Detection) -> Measurement {
        let height_px = f64::from(detection.bounds.size()[1]).max(1.0);
        let place_deviation = self.deviation_px(detection.deviation_px, height_px);
        Measurement { place: detection.center.map(f64::from), place_deviation, velocity: None }
    }

    /// Returns the standard deviation in px that is assumed of positions of an object of this height, `known` to the source or not.
    pub fn deviation_px(&self, known: Option<f32>, height_px: f64) -> f64 {
        match known.filter(|_| self.measurement_noise_from == NoiseFrom::Source) {
            Some(deviation_px) => f64::from(deviation_px).max(LEAST_DEVIATION_PX),
            None => f64::from(self.measurement_noise) * height_px,
        }
    }

    /// Returns the motion model of an object of this size.
    pub fn model(&self, extent: &Extent) -> Model {
        let acceleration = self.process_noise * extent.height_px() as f32;
        self.motion.model(Noises { acceleration, turn_deg: self.turn_noise, switch: MODE_SWITCH })
    }

    /// Returns the filter of a track that starts with a detection.
    pub fn begun(&self, detection: &Detection) -> Filter {
        let extent = Extent::of(detection);
        // Hardly any object moves farther than half its height per frame: two standard deviations.
        let speed = extent.height_px() / 4.0;
        Filter::begun(self.model(&extent), &self.measurement(detection), speed)
    }

    /// Returns the filter of an object of this size in the next frame.
    pub fn predicted(&self, filter: &Filter, extent: &Extent) -> Filter {
        filter.with_model(self.model(extent)).predicted()
    }
}
