//! The densities of a filter as hills on the picture: of its position, and of a predicted measurement with the gate.

use super::ellipse::{SIDE, density};
use super::{Filter, Measurement};
use crate::scene::{Picture, Role, Surface};

/// The part of a picture around a prediction: the same one before and after its measurements.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    middle: [f64; 2],
    /// How far they reach to each side, in px.
    reach: f64,
}

impl Surroundings {
    /// Surroundings of a predicted position that is measured with this standard deviation.
    pub fn of(predicted: &Filter, deviation: f64) -> Self {
        /// How far they reach, in standard deviations of a measured position: farther than any gate.
        const REACH: f64 = 4.8;
        let [[xx, _], [_, yy]] = predicted.place_covariance();
        let sigma = (xx.max(yy) + deviation * deviation).sqrt();
        Self { middle: predicted.place(), reach: (REACH * sigma).max(1.0) }
    }

    /// Widens them so that a place lies inside.
    #[must_use]
    pub fn around(self, place: [f64; 2]) -> Self {
        /// Between the place and the border, as a share of its distance.
        const ROOM: f64 = 0.2;
        let far = (place[0] - self.middle[0]).hypot(place[1] - self.middle[1]);
        Self { reach: self.reach.max((1.0 + ROOM) * far), ..self }
    }

    /// The density of a position, with pins at its mean, which has this name, and at measurements.
    pub fn position(&self, named: (&'static str, Role), filter: &Filter, all: &[Measurement]) -> Option<Surface> {
        let Self { middle, reach } = *self;
        let surface = density(filter.place(), filter.place_covariance(), Picture::CURRENT, middle, reach)?;
        Some(pinned(surface, named, filter, all))
    }

    /// The density N(z; H x, S) of a measurement like the first one at each position, with the gate d² = `limit` as its contour.
    /// A velocity that is measured too stays as it is.
    pub fn measurement(
        &self,
        named: (&'static str, Role),
        filter: &Filter,
        (all, limit): (&[Measurement], Option<f64>),
    ) -> Option<Surface> {
        let measured = all.first()?;
        let peak = filter.log_density(measured)? + filter.squared_distance(measured)? / 2.0;
        let value = |at: [f32; 2]| {
            let log = filter.log_density(&Measurement { place: at.map(f64::from), ..*measured });
            log.map_or(f32::NAN, |log| log.exp() as f32)
        };
        let square = (Picture::CURRENT, self.middle.map(|c| c as f32), self.reach as f32);
        let unit = if measured.velocity.is_some() { "px⁻⁴ frame²" } else { "px⁻²" };
        let surface = Surface::sampled_over_picture(("density", unit), square, SIDE, value);
        surface.range()?;
        let surface =
            Surface { is_similarity: true, contour: limit.map(|limit| (peak - limit / 2.0).exp() as f32), ..surface };
        Some(pinned(surface, named, filter, all))
    }
}

/// A surface with pins at the mean of a filter, which has this name, and at measurements.
fn pinned(surface: Surface, (name, role): (&'static str, Role), filter: &Filter, all: &[Measurement]) -> Surface {
    let measured = all.iter().map(|measured| ("measurement", Role::Measured, measured.place));
    let pins = [(name, role, filter.place())].into_iter().chain(measured);
    surface.with_named(pins.map(|(name, role, place)| (name, role, place.map(|c| c as f32))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::kalman::{MotionModel, Noises, chi_square};

    const PREDICTION: (&str, Role) = ("prediction", Role::Predicted);

    /// A prediction, and a measurement of it.
    fn predicted(motion: MotionModel) -> (Filter, Measurement) {
        let noises = Noises { acceleration: 0.5, turn_deg: 2.0, switch: 0.05 };
        let at = |place, place_deviation| Measurement { place, place_deviation, velocity: None };
        let begun = Filter::begun(motion.model(noises), &at([40.0, 30.0], 2.0), 3.0).predicted();
        let moved = begun.updated(&at([46.0, 31.0], 1.0)).expect("definite").0;
        (moved.predicted().predicted(), at([57.0, 34.0], 1.5))
    }

    #[test]
    fn the_contour_of_a_predicted_measurement_is_its_gate() {
        for motion in [MotionModel::Velocity, MotionModel::Interacting] {
            let (filter, measured) = predicted(motion);
            let limit = chi_square::quantile(0.99, 2);
            let surroundings = Surroundings::of(&filter, measured.place_deviation);
            let surface = surroundings.measurement(PREDICTION, &filter, (&[measured], Some(limit))).expect("definite");
            let lines = surface.contour_lines(surface.contour.expect("a gate"));
            assert!(lines.len() > 20, "{}", lines.len());
            for at in lines.iter().flatten() {
                let place = surface.axes.at(*at).map(f64::from);
                let squared = filter.squared_distance(&Measurement { place, ..measured }).expect("definite");
                assert!((squared - limit).abs() < 0.05 * limit, "{squared}, not {limit}");
            }
            let (peak, at) = surface.optimum().expect("known");
            assert_eq!(at, [[0; 2]], "the predicted measurement");
            let covariance = filter.update_numbers(&measured).expect("definite").covariance;
            let determinant = covariance[(0, 0)] * covariance[(1, 1)] - covariance[(1, 0)] * covariance[(0, 1)];
            assert!((f64::from(peak) * std::f64::consts::TAU * determinant.sqrt() - 1.0).abs() < 1e-6, "{peak}");
        }
    }

    #[test]
    fn a_gate_with_velocity_is_that_of_the_measured_one() {
        let (filter, place) = predicted(MotionModel::Velocity);
        let velocity = Some((filter.velocity(), 0.5));
        let measured = Measurement { velocity, ..place };
        let limit = chi_square::quantile(0.99, 4);
        let surroundings = Surroundings::of(&filter, measured.place_deviation);
        let surface = surroundings.measurement(PREDICTION, &filter, (&[measured], Some(limit))).expect("definite");
        for at in surface.contour_lines(surface.contour.expect("a gate")).iter().flatten() {
            let place = surface.axes.at(*at).map(f64::from);
            let squared = filter.squared_distance(&Measurement { place, ..measured }).expect("definite");
            assert!((squared - limit).abs() < 0.05 * limit, "{squared}, not {limit}");
        }
    }

    #[test]
    fn an_update_raises_the_density_in_the_same_surroundings() {
        let (filter, measured) = predicted(MotionModel::Velocity);
        let surroundings = Surroundings::of(&filter, measured.place_deviation);
        let updated = filter.updated(&measured).expect("definite").0;
        let [before, after] =
            [&filter, &updated].map(|filter| surroundings.position(PREDICTION, filter, &[measured]).expect("definite"));
        assert_eq!((before.axes, before.footing.clone()), (after.axes, after.footing.clone()));
        let [low, high] = [&before, &after].map(|surface| surface.range().expect("known")[1]);
        assert!(high > 1.5 * low, "{low} to {high}");
        for (surface, place) in [(&before, filter.place()), (&after, updated.place())] {
            let off = surface.axes.at(surface.named[0].2).into_iter().zip(place).map(|(a, b)| (f64::from(a) - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-4, "the pin stands at the mean");
        }
    }
}
