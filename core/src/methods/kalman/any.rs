//! The Kalman filter with a motion model chosen at run time, and the matrices of its steps.

use nalgebra::{Cholesky, SMatrix, SVector};

use super::interacting::{Interacting, Mixing, Modes, ModesUpdate};
use super::unscented::{SigmaPoints, Weights};
use super::{Acceleration, Estimate, Motion, Nonlinear, Sensor, Turn, Velocity, smoothed};
use crate::base::words::rounded;
use crate::choices;
use crate::geometry::Grid;
use crate::methods::numbers::{LENGTH_DECIMALS, digits};

/// A state estimate and its motion model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant velocity.
    Velocity(Velocity, Estimate<4>),
    /// Constant acceleration.
    Acceleration(Acceleration, Estimate<6>),
    /// Coordinated turn.
    Turn(Turn, Estimate<5>),
    /// Constant velocity and coordinated turn as interacting modes.
    Interacting(Interacting, Modes),
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
    /// Constant velocity and coordinated turn as interacting modes.
    Interacting(Interacting),
}

/// The standard deviations of the process noise, and the probability of a switch of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noises {
    /// Of the acceleration in px/frame², or of its change per frame where it is part of the state.
    pub acceleration: f32,
    /// Of the change of the turn rate in degrees/frame².
    pub turn_deg: f32,
    /// Probability that the object changes its mode from one frame to the next.
    pub switch: f32,
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
        /// Coordinated turn with sigma points instead of the Jacobian: an unscented Kalman filter. It keeps the curvature of a fast turn.
        Unscented = "unscented-turn" "Coordinated turn (unscented)",
        /// Interacting multiple model: constant velocity and coordinated turn side by side, mixed by the probabilities of these modes, for
        /// objects that turn at times.
        Interacting = "imm" "Interacting: velocity and turn",
    }
}

impl MotionModel {
    /// Whether a coordinated turn is a part of it.
    pub fn turns(self) -> bool {
        matches!(self, Self::Turn | Self::Unscented | Self::Interacting)
    }

    /// Returns the model with its process noise.
    pub fn model(self, noises: Noises) -> Model {
        let acceleration = f64::from(noises.acceleration);
        let rate_change = f64::from(noises.turn_deg).to_radians();
        let turn = |prediction| Turn { acceleration, rate_change, prediction };
        match self {
            Self::Velocity => Model::Velocity(Velocity { acceleration }),
            Self::Acceleration => Model::Acceleration(Acceleration { change: acceleration }),
            Self::Turn => Model::Turn(turn(Nonlinear::Extended)),
            Self::Unscented => Model::Turn(turn(Nonlinear::Unscented)),
            Self::Interacting => Model::Interacting(Interacting {
                velocity: Velocity { acceleration },
                turn: turn(Nonlinear::Extended),
                switch: f64::from(noises.switch),
            }),
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

impl UpdateNumbers {
    /// Whether x is updated by other components of ν than that along x.
    pub fn is_coupled(&self) -> bool {
        (1..self.residual.len()).any(|i| self.gain[(i, 0)] * self.residual[i] != 0.0)
    }

    /// Returns the further digits of ν and S with which they give d² as it is written.
    pub fn digits_of_distance(&self) -> usize {
        digits(self.squared_distance, |decimals| self.squared_distance_to(decimals).unwrap_or(f64::NAN))
    }

    /// Returns d² computed from ν and S as they are written with this many decimals; `None` if S is not positive definite then.
    fn squared_distance_to(&self, decimals: usize) -> Option<f64> {
        match self.residual.len() {
            2 => self.distance_to::<2>(decimals),
            _ => self.distance_to::<4>(decimals),
        }
    }

    fn distance_to<const M: usize>(&self, decimals: usize) -> Option<f64> {
        let residual = SVector::<f64, M>::from_fn(|i, _| rounded(self.residual[i], decimals));
        let covariance = SMatrix::<f64, M, M>::from_fn(|y, x| rounded(self.covariance[(x, y)], decimals));
        Some(Cholesky::new(covariance)?.solve(&residual).dot(&residual))
    }
}

/// The sigma points of a prediction as positions in px: drawn and moved, the mean first, then the pairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Sigma {
    /// The points of the estimate.
    pub drawn: Vec<[f64; 2]>,
    /// The points moved by the motion model.
    pub moved: Vec<[f64; 2]>,
    /// Their mean.
    pub mean: [f64; 2],
    /// Their weights.
    pub weights: Weights,
}

/// The initial probability of each mode.
const INITIAL_PROBABILITY: f64 = 0.5;

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

/// Evaluates `$body` with the motion and the estimate of a filter of any size; of interacting modes with the combined estimate.
macro_rules! with {
    ($filter:expr, |$motion:ident, $estimate:ident| $body:expr) => {
        match $filter {
            Filter::Velocity($motion, $estimate) => $body,
            Filter::Acceleration($motion, $estimate) => $body,
            Filter::Turn($motion, $estimate) => $body,
            Filter::Interacting(interacting, modes) => {
                let ($motion, $estimate) = (&interacting.velocity, &modes.combined());
                $body
            }
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

fn modes_of(modes: &Modes, measurement: &Measurement) -> Option<ModesUpdate> {
    match measurement.velocity {
        None => {
            let ((straight, measured), (turning, _)) = (measurement.of_place(), measurement.of_place());
            modes.updated((&straight, &turning), &measured)
        }
        Some(velocity) => {
            let ((straight, measured), (turning, _)) = (measurement.of_both(velocity), measurement.of_both(velocity));
            modes.updated((&straight, &turning), &measured)
        }
    }
}

fn distance<const N: usize, const M: usize>(
    estimate: &Estimate<N>,
    (sensor, measured): (Sensor<N, M>, SVector<f64, M>),
) -> Option<f64> {
    estimate.innovation(&sensor, &measured).map(|innovation| innovation.squared_distance)
}

fn log_density<const N: usize, const M: usize>(
    estimate: &Estimate<N>,
    (sensor, measured): (Sensor<N, M>, SVector<f64, M>),
) -> Option<f64> {
    estimate.innovation(&sensor, &measured).map(|innovation| innovation.log_likelihood())
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

/// Updates each mode with several measurements and their probabilities β_j, as in one PDA for each mode. The posterior of mode m is
/// μ_m (β₀ + Σ β_j Λ_j^m / Λ̄_j), with its likelihood Λ_j^m of measurement j and the mean Λ̄_j of the likelihoods over the modes; within
/// the mode, measurement j then has the share of its term in that sum.
fn associated_modes(modes: &Modes, deviation: f64, measured: &[([f64; 2], f64)]) -> Option<Modes> {
    let missed = (1.0 - measured.iter().map(|&(_, beta)| beta).sum::<f64>()).max(0.0);
    let (mut likelihoods, mut own) = ([missed; 2], [Vec::new(), Vec::new()]);
    for &(place, beta) in measured {
        let one = Measurement { place, place_deviation: deviation, velocity: None };
        let logs = modes_of(modes, &one)?.log_likelihoods;
        let highest = logs[0].max(logs[1]);
        let relative = logs.map(|log| (log - highest).exp());
        let mixture = modes.probabilities[0] * relative[0] + modes.probabilities[1] * relative[1];
        for m in 0..2 {
            let share = beta * if mixture > 0.0 { relative[m] / mixture } else { 1.0 };
            likelihoods[m] += share;
            own[m].push((place, share));
        }
    }
    for (own, all) in own.iter_mut().zip(likelihoods) {
        // A mode that explains nothing keeps its prediction.
        own.iter_mut().for_each(|(_, share)| *share = if all > 0.0 { *share / all } else { 0.0 });
    }
    let weights = [0, 1].map(|m| modes.probabilities[m] * likelihoods[m]);
    let sum = weights[0] + weights[1];
    Some(Modes {
        velocity: associated(&modes.velocity, deviation, &own[0])?.estimate,
        turn: associated(&modes.turn, deviation, &own[1])?.estimate,
        probabilities: if sum > 0.0 { weights.map(|weight| weight / sum) } else { modes.probabilities },
    })
}

impl Filter {
    /// Initialises the estimate with a first position. The velocity is 0 with a standard deviation of `speed` px/frame.
    pub fn begun(model: Model, first: &Measurement, speed: f64) -> Self {
        match model {
            Model::Velocity(motion) => Self::Velocity(motion, begun(&motion, first, speed)),
            Model::Acceleration(motion) => Self::Acceleration(motion, begun(&motion, first, speed)),
            Model::Turn(motion) => Self::Turn(motion, begun(&motion, first, speed)),
            Model::Interacting(motion) => {
                let (velocity, turn) = (begun(&motion.velocity, first, speed), begun(&motion.turn, first, speed));
                Self::Interacting(motion, Modes { velocity, turn, probabilities: [INITIAL_PROBABILITY; 2] })
            }
        }
    }

    /// Returns the same estimate with another motion model of the same kind.
    #[must_use]
    pub fn with_model(&self, model: Model) -> Self {
        match (*self, model) {
            (Self::Velocity(_, estimate), Model::Velocity(motion)) => Self::Velocity(motion, estimate),
            (Self::Acceleration(_, estimate), Model::Acceleration(motion)) => Self::Acceleration(motion, estimate),
            (Self::Turn(_, estimate), Model::Turn(motion)) => Self::Turn(motion, estimate),
            (Self::Interacting(_, modes), Model::Interacting(motion)) => Self::Interacting(motion, modes),
            (same, _) => same,
        }
    }

    /// Predicts the next frame; interacting modes are mixed before.
    #[must_use]
    pub fn predicted(&self) -> Self {
        match self {
            Self::Velocity(motion, estimate) => Self::Velocity(*motion, estimate.predicted(motion).estimate),
            Self::Acceleration(motion, estimate) => Self::Acceleration(*motion, estimate.predicted(motion).estimate),
            Self::Turn(motion, estimate) => Self::Turn(*motion, estimate.predicted(motion).estimate),
            Self::Interacting(motion, modes) => Self::Interacting(*motion, modes.mixed(motion).modes.predicted(motion)),
        }
    }

    /// Returns the mixing before a prediction, of interacting modes.
    pub fn mixing(&self) -> Option<Mixing> {
        match self {
            Self::Interacting(motion, modes) => Some(modes.mixed(motion)),
            _ => None,
        }
    }

    /// Returns the transition probabilities of interacting modes.
    pub fn transitions(&self) -> Option<[[f64; 2]; 2]> {
        match self {
            Self::Interacting(motion, _) => Some(motion.transitions()),
            _ => None,
        }
    }

    /// Returns the probabilities of interacting modes: of constant velocity and of the turn.
    pub fn probabilities(&self) -> Option<[f64; 2]> {
        match self {
            Self::Interacting(_, modes) => Some(modes.probabilities),
            _ => None,
        }
    }

    /// Returns the filters of interacting modes: constant velocity and turn.
    pub fn modes(&self) -> Option<[Self; 2]> {
        match *self {
            Self::Interacting(motion, modes) => {
                Some([Self::Velocity(motion.velocity, modes.velocity), Self::Turn(motion.turn, modes.turn)])
            }
            _ => None,
        }
    }

    /// Returns the sigma points of a prediction; `None` where it does not use them.
    pub fn sigma(&self) -> Option<Sigma> {
        let Self::Turn(motion, estimate) = self else { return None };
        let drawn = motion.is_unscented().then(|| SigmaPoints::of(estimate)).flatten()?;
        let moved = drawn.moved(motion);
        let places = |of: &SigmaPoints<5>| {
            std::iter::once(&of.center).chain(of.pairs.iter().flatten()).map(|point| [point[0], point[1]]).collect()
        };
        let mean = moved.moments().state;
        Some(Sigma { drawn: places(&drawn), moved: places(&moved), mean: [mean[0], mean[1]], weights: Weights::of(5) })
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
            Self::Interacting(motion, modes) => {
                let squared = self.squared_distance(measurement)?;
                (Self::Interacting(*motion, modes_of(modes, measurement)?.modes), squared)
            }
        })
    }

    /// Returns the natural logarithms of the likelihoods of a measurement in interacting modes.
    pub fn log_likelihoods(&self, measurement: &Measurement) -> Option<[f64; 2]> {
        match self {
            Self::Interacting(_, modes) => Some(modes_of(modes, measurement)?.log_likelihoods),
            _ => None,
        }
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
            Self::Interacting(motion, modes) => {
                Self::Interacting(*motion, associated_modes(modes, deviation, measured)?)
            }
        })
    }

    /// Returns the matrices of [`Filter::associated`]; `None` for interacting modes, each of which has its own.
    pub fn association_numbers(&self, deviation: f64, measured: &[([f64; 2], f64)]) -> Option<AssociationNumbers> {
        if matches!(self, Self::Interacting(..)) {
            return None;
        }
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

    /// Returns ln N(ν; 0, S) of a measurement; of interacting modes, the normal distribution with their moments. `None` where
    /// [`Filter::updated`] is.
    pub fn log_density(&self, measurement: &Measurement) -> Option<f64> {
        with!(self, |_motion, estimate| match measurement.velocity {
            None => log_density(estimate, measurement.of_place()),
            Some(velocity) => log_density(estimate, measurement.of_both(velocity)),
        })
    }

    /// Smooths the estimate with the smoothed one of the next frame (RTS); `None` for interacting modes, which this smoother is not for.
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

    /// Returns the smoother gain C of [`smoothed`]; `None` where the predicted covariance is not positive definite, and for interacting modes,
    /// which are not smoothed.
    pub fn smoothing_gain(&self) -> Option<Grid<f64>> {
        if matches!(self, Self::Interacting(..)) {
            return None;
        }
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

    /// Returns the turn rate in radians/frame; `None` where it is no part of the state.
    pub fn turn_rate(&self) -> Option<f64> {
        let component = self.names().iter().position(|name| *name == "ω")?;
        self.state().get(component).copied()
    }

    /// Returns the decimals of the state as shown: two for px, four where a turn rate in rad/frame is part of it.
    pub fn decimals(&self) -> usize {
        if self.turn_rate().is_some() { 4 } else { LENGTH_DECIMALS }
    }

    /// Returns the covariance P.
    pub fn covariance(&self) -> Grid<f64> {
        with!(self, |_motion, estimate| grid(&estimate.covariance))
    }

    /// Returns the matrices of [`Filter::predicted`]; of interacting modes those of constant velocity.
    pub fn prediction_numbers(&self) -> PredictionNumbers {
        with!(self, |motion, estimate| {
            let prediction = estimate.predicted(motion);
            PredictionNumbers { transition: grid(&prediction.transition), noise: grid(&prediction.noise) }
        })
    }

    /// Returns the matrices of [`Filter::updated`]; of interacting modes, each of which has a gain of its own, those of the combined estimate.
    pub fn update_numbers(&self, measurement: &Measurement) -> Option<UpdateNumbers> {
        with!(self, |_motion, estimate| match measurement.velocity {
            None => numbers_of(estimate, measurement.of_place()),
            Some(velocity) => numbers_of(estimate, measurement.of_both(velocity)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interacting() -> (Filter, Measurement) {
        let noises = Noises { acceleration: 0.5, turn_deg: 2.0, switch: 0.05 };
        let at = |place| Measurement { place, place_deviation: 2.0, velocity: None };
        let begun = Filter::begun(MotionModel::Interacting.model(noises), &at([10.0, 20.0]), 5.0);
        (begun.predicted().updated(&at([14.0, 21.0])).expect("definite").0.predicted(), at([19.0, 25.0]))
    }

    #[test]
    fn modes_are_updated_by_a_certain_measurement_as_by_that_alone_and_by_none_not_at_all() {
        let (before, measured) = interacting();
        let state = |filter: &Filter| (filter.state(), filter.probabilities().expect("modes"));
        let close = |a: &Filter, b: &Filter| {
            let ((a, p), (b, q)) = (state(a), state(b));
            let all = a.iter().zip(&b).chain(p.iter().zip(&q));
            all.into_iter().all(|(a, b)| (a - b).abs() < 1e-9)
        };
        let alone = before.updated(&measured).expect("definite").0;
        let certain = before.associated(measured.place_deviation, &[(measured.place, 1.0)]).expect("definite");
        assert!(close(&alone, &certain) && !close(&before, &certain), "{:?} {:?}", state(&alone), state(&certain));
        let missed = before.associated(measured.place_deviation, &[(measured.place, 0.0)]).expect("definite");
        assert!(close(&before, &missed), "{:?} {:?}", state(&before), state(&missed));
    }
}
