//! The Kalman filter with a motion model chosen at run time, and the matrices of its steps.

use nalgebra::{SMatrix, SVector};

use super::{Acceleration, Estimate, Motion, Sensor, Turn, Velocity, smoothed};
use crate::choices;
use crate::geometry::Grid;

/// A state estimate and its motion model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant velocity.
    Velocity(Velocity, Estimate<4>),
    /// Constant acceleration.
    Acceleration(Acceleration, Estimate<6>),
    /// Coordinated turn.
    Turn(Turn, Estimate<5>),
}

/// A motion model with its parameters.
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
    /// The motion model.
    pub enum MotionModel {
        /// Constant velocity: motion on a straight line; state (x, y, u, v).
        Velocity = "velocity" "Constant velocity",
        /// Constant acceleration, e.g. a thrown ball; the acceleration is part of the state.
        Acceleration = "acceleration" "Constant acceleration",
        /// Coordinated turn: constant speed and turn rate; nonlinear, so an extended Kalman filter.
        Turn = "turn" "Coordinated turn",
    }
}

impl MotionModel {
    /// Returns the model with these standard deviations: of the acceleration in px/frame², or of its change per frame where it is
    /// part of the state, and of the change of the turn rate in degrees/frame².
    pub fn model(self, deviation: f32, turn_deg: f32) -> Model {
        let deviation = f64::from(deviation);
        match self {
            Self::Velocity => Model::Velocity(Velocity { acceleration: deviation }),
            Self::Acceleration => Model::Acceleration(Acceleration { change: deviation }),
            Self::Turn => Model::Turn(Turn { acceleration: deviation, rate_change: f64::from(turn_deg).to_radians() }),
        }
    }
}

/// A measurement of position and perhaps velocity, in px and px/frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The position.
    pub place: [f64; 2],
    /// Its standard deviation along each axis.
    pub place_deviation: f64,
    /// The velocity and its standard deviation, if measured.
    pub velocity: Option<([f64; 2], f64)>,
}

/// The matrices of a prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictionNumbers {
    /// F.
    pub transition: Grid<f64>,
    /// Q.
    pub noise: Grid<f64>,
}

/// The matrices of an update.
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

/// The matrices of an update by several measurements with their probabilities.
#[derive(Clone, Debug, PartialEq)]
pub struct AssociationNumbers {
    /// Combined innovation ν = Σ β_j ν_j.
    pub innovation: Vec<f64>,
    /// S.
    pub covariance: Grid<f64>,
    /// Σ β_j ν_j ν_jᵀ − ν νᵀ.
    pub spread: Grid<f64>,
    /// K.
    pub gain: Grid<f64>,
}

/// Evaluates `$body` with the motion and the estimate of a filter of any size.
macro_rules! with {
    ($filter:expr, |$motion:ident, $estimate:ident| $body:expr) => {
        match $filter {
            Filter::Velocity($motion, $estimate) => $body,
            Filter::Acceleration($motion, $estimate) => $body,
            Filter::Turn($motion, $estimate) => $body,
        }
    };
}

/// Returns the filter with the estimate `$body`, made of its motion and estimate.
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
    /// Returns its dimension: 2, or 4 with velocity.
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
    let mut deviations = motion.initial_deviations(speed);
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

fn associated<const N: usize>(
    estimate: &Estimate<N>,
    deviation: f64,
    measured: &[([f64; 2], f64)],
) -> Option<super::Association<N, 2>> {
    let measured: Vec<_> = measured.iter().map(|(at, probability)| (SVector::from(*at), *probability)).collect();
    estimate.associated(&Sensor::first([deviation; 2]), &measured)
}

fn names_of<const N: usize, T: Motion<N>>(_: &T) -> &'static [&'static str] {
    &T::NAMES
}

fn grid<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Grid<f64> {
    Grid::from_fn(C, R, |x, y| matrix[(y, x)])
}

impl Filter {
    /// Initialises the estimate with a first position. The velocity is 0 with a standard deviation of `speed` px/frame.
    pub fn begun(model: Model, first: &Measurement, speed: f64) -> Self {
        match model {
            Model::Velocity(motion) => Self::Velocity(motion, begun(&motion, first, speed)),
            Model::Acceleration(motion) => Self::Acceleration(motion, begun(&motion, first, speed)),
            Model::Turn(motion) => Self::Turn(motion, begun(&motion, first, speed)),
        }
    }

    /// Returns the same estimate with another motion model of the same kind.
    #[must_use]
    pub fn with_model(&self, model: Model) -> Self {
        match (*self, model) {
            (Self::Velocity(_, estimate), Model::Velocity(motion)) => Self::Velocity(motion, estimate),
            (Self::Acceleration(_, estimate), Model::Acceleration(motion)) => Self::Acceleration(motion, estimate),
            (Self::Turn(_, estimate), Model::Turn(motion)) => Self::Turn(motion, estimate),
            (same, _) => same,
        }
    }

    /// Predicts the next frame.
    #[must_use]
    pub fn predicted(&self) -> Self {
        map!(self, |motion, estimate| estimate.predicted(motion).estimate)
    }

    /// Updates the estimate with a measurement and returns its squared Mahalanobis distance too; `None` where the innovation
    /// covariance is not positive definite.
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

    /// Updates the estimate with several positions of one standard deviation, each with the probability of being the one of the
    /// object (see [`Estimate::associated`]).
    pub fn associated(&self, deviation: f64, measured: &[([f64; 2], f64)]) -> Option<Self> {
        Some(match self {
            Self::Velocity(motion, estimate) => {
                Self::Velocity(*motion, associated(estimate, deviation, measured)?.estimate)
            }
            Self::Acceleration(motion, estimate) => {
                Self::Acceleration(*motion, associated(estimate, deviation, measured)?.estimate)
            }
            Self::Turn(motion, estimate) => Self::Turn(*motion, associated(estimate, deviation, measured)?.estimate),
        })
    }

    /// Returns the matrices of [`Filter::associated`].
    pub fn association_numbers(&self, deviation: f64, measured: &[([f64; 2], f64)]) -> Option<AssociationNumbers> {
        with!(self, |_motion, estimate| {
            let all = associated(estimate, deviation, measured)?;
            Some(AssociationNumbers {
                innovation: all.innovation.iter().copied().collect(),
                covariance: grid(&all.covariance),
                spread: grid(&all.spread),
                gain: grid(&all.gain),
            })
        })
    }

    /// Returns the squared Mahalanobis distance of a measurement; `None` where [`Filter::updated`] is.
    pub fn squared_distance(&self, measurement: &Measurement) -> Option<f64> {
        with!(self, |_motion, estimate| match measurement.velocity {
            None => distance(estimate, measurement.of_place()),
            Some(velocity) => distance(estimate, measurement.of_both(velocity)),
        })
    }

    /// Smooths the estimate with the smoothed one of the next frame (RTS).
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

    /// Returns the estimated position in px.
    pub fn place(&self) -> [f64; 2] {
        with!(self, |_motion, estimate| [estimate.state[0], estimate.state[1]])
    }

    /// Returns the estimated velocity in px/frame.
    pub fn velocity(&self) -> [f64; 2] {
        with!(self, |_motion, estimate| [estimate.state[2], estimate.state[3]])
    }

    /// Returns the covariance of the position in px².
    pub fn place_covariance(&self) -> [[f64; 2]; 2] {
        with!(self, |_motion, estimate| [0, 1].map(|i| [0, 1].map(|j| estimate.covariance[(i, j)])))
    }

    /// Returns the NEES of the position; `None` where the covariance is not positive definite.
    pub fn squared_error(&self, truth: [f64; 2]) -> Option<f64> {
        let ([x, y], [[xx, xy], [yx, yy]]) = (self.place(), self.place_covariance());
        let place = Estimate::<2> { state: [x, y].into(), covariance: SMatrix::from([[xx, yx], [xy, yy]]) };
        place.squared_error(&truth.into())
    }

    /// Returns the smoother gain C of [`smoothed`]; `None` where the predicted covariance is not positive definite.
    pub fn smoothing_gain(&self) -> Option<Grid<f64>> {
        with!(self, |motion, estimate| {
            let prediction = estimate.predicted(motion);
            smoothed(estimate, &prediction, &prediction.estimate).map(|smoothed| grid(&smoothed.gain))
        })
    }

    /// Returns the names of the state's components.
    pub fn names(&self) -> &'static [&'static str] {
        with!(self, |motion, _estimate| names_of(motion))
    }

    /// Returns the state x.
    pub fn state(&self) -> Vec<f64> {
        with!(self, |_motion, estimate| estimate.state.iter().copied().collect())
    }

    /// Returns the covariance P.
    pub fn covariance(&self) -> Grid<f64> {
        with!(self, |_motion, estimate| grid(&estimate.covariance))
    }

    /// Returns the matrices of [`Filter::predicted`].
    pub fn prediction_numbers(&self) -> PredictionNumbers {
        with!(self, |motion, estimate| {
            let prediction = estimate.predicted(motion);
            PredictionNumbers { transition: grid(&prediction.transition), noise: grid(&prediction.noise) }
        })
    }

    /// Returns the matrices of [`Filter::updated`].
    pub fn update_numbers(&self, measurement: &Measurement) -> Option<UpdateNumbers> {
        with!(self, |_motion, estimate| match measurement.velocity {
            None => numbers_of(estimate, measurement.of_place()),
            Some(velocity) => numbers_of(estimate, measurement.of_both(velocity)),
        })
    }
}
