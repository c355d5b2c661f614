//! A filter whose motion is chosen while the program runs, and its numbers for people.

use nalgebra::{SMatrix, SVector};

use super::{Acceleration, Estimate, Motion, Sensor, Turn, Velocity, smoothed};
use crate::choices;
use crate::geometry::Grid;

/// A state estimate, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant velocity.
    Velocity(Velocity, Estimate<4>),
    /// Constant acceleration.
    Acceleration(Acceleration, Estimate<6>),
    /// Coordinated turn.
    Turn(Turn, Estimate<5>),
}

/// A model of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// Constant velocity.
    Velocity(Velocity),
    /// Constant acceleration.
    Acceleration(Acceleration),
    /// Coordinated turn.
    Turn(Turn),
}

choices! {
    /// How objects are thought to move.
    pub enum MotionModel {
        /// Straight on, with their velocity.
        Velocity = "velocity" "Constant velocity",
        /// With their velocity and their acceleration, as what is thrown.
        Acceleration = "acceleration" "Constant acceleration",
        /// With their speed along an arc: an extended filter.
        Turn = "turn" "Coordinated turn",
    }
}

impl MotionModel {
    /// The model with these standard deviations: of the acceleration in px/frame², or of its change in a frame where it is
    /// part of the state, and of the change of the rate of a turn in degrees/frame².
    pub fn model(self, deviation: f32, turn_deg: f32) -> Model {
        let deviation = f64::from(deviation);
        match self {
            Self::Velocity => Model::Velocity(Velocity { acceleration: deviation }),
            Self::Acceleration => Model::Acceleration(Acceleration { change: deviation }),
            Self::Turn => Model::Turn(Turn { acceleration: deviation, rate_change: f64::from(turn_deg).to_radians() }),
        }
    }
}

/// What a sensor tells of an object, in px and px/frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Where it is.
    pub place: [f64; 2],
    /// Standard deviation of that along each axis.
    pub place_deviation: f64,
    /// How it moves and the standard deviation of that, if the sensor tells.
    pub velocity: Option<([f64; 2], f64)>,
}

/// The numbers of a step of time: F and Q.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictionNumbers {
    /// F.
    pub transition: Grid<f64>,
    /// Q.
    pub noise: Grid<f64>,
}

/// The numbers of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct UpdateNumbers {
    /// H.
    pub observation: Grid<f64>,
    /// R.
    pub noise: Grid<f64>,
    /// ν.
    pub residual: Vec<f64>,
    /// S.
    pub covariance: Grid<f64>,
    /// νᵀ S⁻¹ ν.
    pub squared_distance: f64,
    /// K.
    pub gain: Grid<f64>,
}

/// Does `$body` with the motion and the estimate of a filter, whatever its size.
macro_rules! with {
    ($filter:expr, |$motion:ident, $estimate:ident| $body:expr) => {
        match $filter {
            Filter::Velocity($motion, $estimate) => $body,
            Filter::Acceleration($motion, $estimate) => $body,
            Filter::Turn($motion, $estimate) => $body,
        }
    };
}

/// The same filter with `$body`, the estimate that it makes of its motion and estimate.
macro_rules! map {
    ($filter:expr, |$motion:ident, $estimate:ident| $body:expr) => {
        match $filter {
            Filter::Velocity($motion, $estimate) => Filter::Velocity(*$motion, $body),
            Filter::Acceleration($motion, $estimate) => Filter::Acceleration(*$motion, $body),
            Filter::Turn($motion, $estimate) => Filter::Turn(*$motion, $body),
        }
    };
}

impl Measurement {
    /// How many numbers it has.
    pub fn numbers(&self) -> usize {
        if self.velocity.is_some() { 4 } else { 2 }
    }

    fn of_place<const N: usize>(&self) -> (Sensor<N, 2>, SVector<f64, 2>) {
        (Sensor::first([self.place_deviation; 2]), self.place.into())
    }

    fn of_both<const N: usize>(&self, ([u, v], deviation): ([f64; 2], f64)) -> (Sensor<N, 4>, SVector<f64, 4>) {
        let [x, y] = self.place;
        (Sensor::first([self.place_deviation, self.place_deviation, deviation, deviation]), [x, y, u, v].into())
    }
}

fn begun<const N: usize>(motion: &impl Motion<N>, first: &Measurement, speed: f64) -> Estimate<N> {
    let mut deviations = motion.doubts(speed);
    deviations[..2].fill(first.place_deviation);
    let mut state = SVector::zeros();
    (state[0], state[1]) = first.place.into();
    let covariance = SMatrix::from_diagonal(&SVector::from(deviations).map(|deviation| deviation * deviation));
    Estimate { state, covariance }
}

fn updated<const N: usize, const M: usize>(
    estimate: &Estimate<N>,
    (sensor, measured): (Sensor<N, M>, SVector<f64, M>),
) -> Option<(Estimate<N>, f64)> {
    let innovation = estimate.innovation(&sensor, &measured)?;
    Some((estimate.updated(&sensor, &innovation).estimate, innovation.squared_distance))
}

fn update_of<const N: usize>(estimate: &Estimate<N>, measurement: &Measurement) -> Option<(Estimate<N>, f64)> {
    match measurement.velocity {
        None => updated(estimate, measurement.of_place()),
        Some(velocity) => updated(estimate, measurement.of_both(velocity)),
    }
}

fn distance<const N: usize, const M: usize>(
    estimate: &Estimate<N>,
    (sensor, measured): (Sensor<N, M>, SVector<f64, M>),
) -> Option<f64> {
    estimate.innovation(&sensor, &measured).map(|innovation| innovation.squared_distance)
}

fn numbers_of<const N: usize, const M: usize>(
    estimate: &Estimate<N>,
    (sensor, measured): (Sensor<N, M>, SVector<f64, M>),
) -> Option<UpdateNumbers> {
    let innovation = estimate.innovation(&sensor, &measured)?;
    Some(UpdateNumbers {
        observation: grid(&sensor.observation),
        noise: grid(&sensor.noise),
        residual: innovation.residual.iter().copied().collect(),
        covariance: grid(&innovation.covariance),
        squared_distance: innovation.squared_distance,
        gain: grid(&estimate.updated(&sensor, &innovation).gain),
    })
}

fn names_of<const N: usize, T: Motion<N>>(_: &T) -> &'static [&'static str] {
    &T::NAMES
}

fn grid<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Grid<f64> {
    Grid::from_fn(C, R, |x, y| matrix[(y, x)])
}

impl Filter {
    /// The state estimate after a first measurement of something whose speed may be about `speed` px/frame; how it moves is not
    /// taken from the measurement.
    pub fn begun(model: Model, first: &Measurement, speed: f64) -> Self {
        match model {
            Model::Velocity(motion) => Self::Velocity(motion, begun(&motion, first, speed)),
            Model::Acceleration(motion) => Self::Acceleration(motion, begun(&motion, first, speed)),
            Model::Turn(motion) => Self::Turn(motion, begun(&motion, first, speed)),
        }
    }

    /// The same belief of something that goes on by another model of the same kind.
    #[must_use]
    pub fn going_by(&self, model: Model) -> Self {
        match (*self, model) {
            (Self::Velocity(_, estimate), Model::Velocity(motion)) => Self::Velocity(motion, estimate),
            (Self::Acceleration(_, estimate), Model::Acceleration(motion)) => Self::Acceleration(motion, estimate),
            (Self::Turn(_, estimate), Model::Turn(motion)) => Self::Turn(motion, estimate),
            (same, _) => same,
        }
    }

    /// A frame later.
    #[must_use]
    pub fn predicted(&self) -> Self {
        map!(self, |motion, estimate| estimate.predicted(motion).estimate)
    }

    /// The state estimate after a measurement, and its squared Mahalanobis distance; `None` where the covariance of the innovation
    /// is not positive definite.
    pub fn updated(&self, measurement: &Measurement) -> Option<(Self, f64)> {
        Some(match self {
            Self::Velocity(motion, estimate) => {
                let (estimate, squared) = update_of(estimate, measurement)?;
                (Self::Velocity(*motion, estimate), squared)
            }
            Self::Acceleration(motion, estimate) => {
                let (estimate, squared) = update_of(estimate, measurement)?;
                (Self::Acceleration(*motion, estimate), squared)
            }
            Self::Turn(motion, estimate) => {
                let (estimate, squared) = update_of(estimate, measurement)?;
                (Self::Turn(*motion, estimate), squared)
            }
        })
    }

    /// The squared Mahalanobis distance of a measurement; `None` as above.
    pub fn squared_distance(&self, measurement: &Measurement) -> Option<f64> {
        with!(self, |_motion, estimate| match measurement.velocity {
            None => distance(estimate, measurement.of_place()),
            Some(velocity) => distance(estimate, measurement.of_both(velocity)),
        })
    }

    /// The state estimate of this frame, with what is known of the next one by now.
    pub fn smoothed(&self, next: &Filter) -> Option<Self> {
        match (self, next) {
            (Self::Velocity(motion, estimate), Self::Velocity(_, next)) => {
                Some(Self::Velocity(*motion, smoothed(estimate, &estimate.predicted(motion), next)?.estimate))
            }
            (Self::Acceleration(motion, estimate), Self::Acceleration(_, next)) => {
                Some(Self::Acceleration(*motion, smoothed(estimate, &estimate.predicted(motion), next)?.estimate))
            }
            (Self::Turn(motion, estimate), Self::Turn(_, next)) => {
                Some(Self::Turn(*motion, smoothed(estimate, &estimate.predicted(motion), next)?.estimate))
            }
            _ => None,
        }
    }

    /// The estimated place, in px.
    pub fn place(&self) -> [f64; 2] {
        with!(self, |_motion, estimate| [estimate.state[0], estimate.state[1]])
    }

    /// The estimated velocity, in px/frame.
    pub fn velocity(&self) -> [f64; 2] {
        with!(self, |_motion, estimate| [estimate.state[2], estimate.state[3]])
    }

    /// The covariance of the place in px².
    pub fn place_covariance(&self) -> [[f64; 2]; 2] {
        with!(self, |_motion, estimate| [0, 1].map(|i| [0, 1].map(|j| estimate.covariance[(i, j)])))
    }

    /// The squared Mahalanobis distance of the true place; `None` where the covariance is not positive definite.
    pub fn squared_error(&self, truth: [f64; 2]) -> Option<f64> {
        let ([x, y], [[xx, xy], [yx, yy]]) = (self.place(), self.place_covariance());
        let place = Estimate::<2> { state: [x, y].into(), covariance: SMatrix::from([[xx, yx], [xy, yy]]) };
        place.squared_error(&truth.into())
    }

    /// How far what is known of the next frame reaches back, C of [`smoothed`]; `None` where the covariance of the prediction is
    /// not positive definite.
    pub fn smoothing_gain(&self) -> Option<Grid<f64>> {
        with!(self, |motion, estimate| {
            let prediction = estimate.predicted(motion);
            smoothed(estimate, &prediction, &prediction.estimate).map(|smoothed| grid(&smoothed.gain))
        })
    }

    /// What the numbers of the state are.
    pub fn names(&self) -> &'static [&'static str] {
        with!(self, |motion, _estimate| names_of(motion))
    }

    /// The state x.
    pub fn state(&self) -> Vec<f64> {
        with!(self, |_motion, estimate| estimate.state.iter().copied().collect())
    }

    /// Its covariance P.
    pub fn covariance(&self) -> Grid<f64> {
        with!(self, |_motion, estimate| grid(&estimate.covariance))
    }

    /// What [`Filter::predicted`] works with.
    pub fn prediction_numbers(&self) -> PredictionNumbers {
        with!(self, |motion, estimate| {
            let prediction = estimate.predicted(motion);
            PredictionNumbers { transition: grid(&prediction.transition), noise: grid(&prediction.noise) }
        })
    }

    /// What [`Filter::updated`] works with.
    pub fn update_numbers(&self, measurement: &Measurement) -> Option<UpdateNumbers> {
        with!(self, |_motion, estimate| match measurement.velocity {
            None => numbers_of(estimate, measurement.of_place()),
            Some(velocity) => numbers_of(estimate, measurement.of_both(velocity)),
        })
    }
}
