//! The interacting multiple model (IMM): a filter for each of two motion models, mixed by the probabilities of the modes.
//!
//! H. A. P. Blom and Y. Bar-Shalom, The interacting multiple model algorithm for systems with Markovian switching coefficients, IEEE
//! Transactions on Automatic Control 33, 1988. The turn rate, which constant velocity has not, is mixed without bias after T. Yuan and
//! others, A multiple IMM estimation approach with unbiased mixing for thrusting projectiles, IEEE Transactions on Aerospace and
//! Electronic Systems 48, 2012: constant velocity takes part with the turn rate of the turn.

use nalgebra::{SMatrix, SVector};

use super::estimate::symmetric;
use super::{Estimate, Sensor, Turn, Velocity};

/// The models of the modes, and the probability of a switch between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interacting {
    /// Constant velocity.
    pub velocity: Velocity,
    /// Coordinated turn.
    pub turn: Turn,
    /// Probability that the object changes its mode from one frame to the next, alike in both directions.
    pub switch: f64,
}

impl Interacting {
    /// Returns the transition probabilities of the modes: entry `[i][j]` from mode i to mode j.
    pub fn transitions(&self) -> [[f64; 2]; 2] {
        [[1.0 - self.switch, self.switch], [self.switch, 1.0 - self.switch]]
    }
}

/// The estimates of the modes and their probabilities μ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modes {
    /// The estimate of constant velocity.
    pub velocity: Estimate<4>,
    /// The estimate of the coordinated turn.
    pub turn: Estimate<5>,
    /// The probabilities of constant velocity and of the turn.
    pub probabilities: [f64; 2],
}

/// The mixing at the start of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixing {
    /// Weights μ(i|j): entry `[i][j]` is the probability that mode i was active, given mode j now.
    pub weights: [[f64; 2]; 2],
    /// The mixed estimates, and the predicted probabilities c.
    pub modes: Modes,
}

/// The update of the modes by a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModesUpdate {
    /// Natural logarithms of the likelihoods Λ of the modes: of N(ν; 0, S).
    pub log_likelihoods: [f64; 2],
    /// The updated estimates and probabilities.
    pub modes: Modes,
}

/// Returns the moments of a mixture of two normal distributions.
fn mixture<const N: usize>(parts: [(f64, Estimate<N>); 2]) -> Estimate<N> {
    let state: SVector<f64, N> = parts.iter().map(|(weight, of)| of.state * *weight).sum();
    let spread = |of: &Estimate<N>| of.covariance + (of.state - state) * (of.state - state).transpose();
    let covariance: SMatrix<f64, N, N> = parts.iter().map(|(weight, of)| spread(of) * *weight).sum();
    Estimate { state, covariance: symmetric(covariance) }
}

impl Modes {
    /// The turn without its turn rate.
    fn straight(&self) -> Estimate<4> {
        let Estimate { state, covariance } = &self.turn;
        Estimate { state: state.fixed_rows::<4>(0).into(), covariance: covariance.fixed_view::<4, 4>(0, 0).into() }
    }

    /// Constant velocity with the turn rate of the turn.
    fn turning(&self) -> Estimate<5> {
        let mut of = Estimate { state: self.turn.state, covariance: SMatrix::zeros() };
        of.state.fixed_rows_mut::<4>(0).copy_from(&self.velocity.state);
        of.covariance.fixed_view_mut::<4, 4>(0, 0).copy_from(&self.velocity.covariance);
        of.covariance[(4, 4)] = self.turn.covariance[(4, 4)];
        of
    }

    /// Mixes the estimates: each mode begins the frame with the moments of all modes from which the object may have switched to it.
    pub fn mixed(&self, model: &Interacting) -> Mixing {
        let joint = [0, 1].map(|i| model.transitions()[i].map(|transition| transition * self.probabilities[i]));
        let predicted = [0, 1].map(|j| joint[0][j] + joint[1][j]);
        // A mode that cannot be reached keeps its estimate.
        let weight = |i: usize, j: usize| match predicted[j] > 0.0 {
            true => joint[i][j] / predicted[j],
            false => f64::from(u8::from(i == j)),
        };
        let weights = [0, 1].map(|i| [0, 1].map(|j| weight(i, j)));
        let velocity = mixture([(weights[0][0], self.velocity), (weights[1][0], self.straight())]);
        let turn = mixture([(weights[0][1], self.turning()), (weights[1][1], self.turn)]);
        Mixing { weights, modes: Self { velocity, turn, probabilities: predicted } }
    }

    /// Predicts each mode by its model.
    #[must_use]
    pub fn predicted(&self, model: &Interacting) -> Self {
        let velocity = self.velocity.predicted(&model.velocity).estimate;
        Self { velocity, turn: self.turn.predicted(&model.turn).estimate, probabilities: self.probabilities }
    }

    /// Updates each mode, and the probabilities by the likelihoods; `None` where an innovation covariance is not positive definite.
    pub fn updated<const M: usize>(
        &self,
        (straight, turning): (&Sensor<4, M>, &Sensor<5, M>),
        measured: &SVector<f64, M>,
    ) -> Option<ModesUpdate> {
        let innovations = (self.velocity.innovation(straight, measured)?, self.turn.innovation(turning, measured)?);
        let log_likelihoods = [innovations.0.log_likelihood(), innovations.1.log_likelihood()];
        // Relative to the larger one: far from both predictions the likelihoods themselves underflow.
        let most = log_likelihoods[0].max(log_likelihoods[1]);
        let joint = [0, 1].map(|j| self.probabilities[j] * (log_likelihoods[j] - most).exp());
        let sum = joint[0] + joint[1];
        let probabilities = if sum > 0.0 { joint.map(|part| part / sum) } else { self.probabilities };
        let velocity = self.velocity.updated(straight, &innovations.0).estimate;
        let turn = self.turn.updated(turning, &innovations.1).estimate;
        Some(ModesUpdate { log_likelihoods, modes: Self { velocity, turn, probabilities } })
    }

    /// Combines the modes: the moments of their mixture, of position and velocity.
    pub fn combined(&self) -> Estimate<4> {
        let [velocity, turn] = self.probabilities;
        mixture([(velocity, self.velocity), (turn, self.straight())])
    }
}
