//! The density of a track as a hill on the picture.

use crate::methods::kalman::{Filter, Measurement, Surroundings};
use crate::scene::{Readout, Role};

/// The estimates of a track at a step, with its measurements.
pub(crate) struct TrackDensity<'a> {
    /// The prediction.
    pub predicted: &'a Filter,
    /// The estimate after the measurements.
    pub updated: Option<&'a Filter>,
    /// Its measurements, or before the update those that are compared with it, the nearest first.
    pub measured: Vec<Measurement>,
    /// The gating threshold of d², if there is a gate.
    pub limit: Option<f64>,
}

impl<'a> TrackDensity<'a> {
    /// Of a prediction alone.
    pub fn predicted(filter: &'a Filter) -> Self {
        Self { predicted: filter, updated: None, measured: Vec::new(), limit: None }
    }

    /// Of an estimate alone.
    pub fn estimated(filter: &'a Filter) -> Self {
        Self { updated: Some(filter), ..Self::predicted(filter) }
    }

    /// The density of the predicted measurement with its gate, where measurements are compared; else that of the position.
    pub fn landscape(&self) -> Option<Readout> {
        let Self { predicted, updated, measured, limit } = self;
        let deviation = measured.first().map_or(0.0, |nearest| nearest.place_deviation);
        let places = measured.iter().map(|measured| measured.place);
        let surroundings = places.fold(Surroundings::of(predicted, deviation), Surroundings::around);
        let prediction = ("prediction", Role::Predicted);
        let surface = match updated {
            Some(filter) => surroundings.position(("estimate", Role::Estimate), filter, measured),
            None if measured.is_empty() => surroundings.position(prediction, predicted, &[]),
            None => surroundings.measurement(prediction, predicted, (measured, *limit)),
        };
        surface.map(Readout::Landscape)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::kalman::{MotionModel, Noises, chi_square};

    #[test]
    fn a_gate_is_shown_where_measurements_are_compared() {
        let noises = Noises { acceleration: 0.5, turn_deg: 2.0, switch: 0.05 };
        let at = |place| Measurement { place, place_deviation: 1.5, velocity: None };
        let predicted = Filter::begun(MotionModel::Velocity.model(noises), &at([40.0, 30.0]), 3.0).predicted();
        let (near, far) = (at([42.0, 31.0]), at([36.0, 33.0]));
        let limit = chi_square::quantile(0.99, 2);
        let alone = TrackDensity::predicted(&predicted);
        let compared =
            TrackDensity { measured: vec![near, far], limit: Some(limit), ..TrackDensity::predicted(&predicted) };
        let updated = predicted.updated(&near).expect("definite").0;
        let updated =
            TrackDensity { updated: Some(&updated), measured: vec![near], ..TrackDensity::predicted(&predicted) };
        let [alone, compared, updated] = [alone, compared, updated]
            .map(|density| density.landscape().and_then(|readout| readout.landscape()).expect("definite"));
        assert_eq!((alone.contour, updated.contour), (None, None), "these are densities of the position");
        let contour = f64::from(compared.contour.expect("a gate"));
        let peak = f64::from(compared.range().expect("known")[1]);
        assert!((contour / peak - (-limit / 2.0).exp()).abs() < 1e-5, "{contour} of {peak}");
        assert_eq!([alone.named.len(), compared.named.len(), updated.named.len()], [1, 3, 2]);
        assert_eq!(compared.footing, updated.footing, "the same part of the picture");
    }
}
