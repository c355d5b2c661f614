//! Motion models. Time is in frames, positions are in px.

use nalgebra::{Matrix4, Matrix5, SMatrix, SVector, Vector5};

/// A motion model with a state of dimension `N`: position, velocity, and further components.
pub trait Motion<const N: usize> {
    /// The names of the state's components.
    const NAMES: [&'static str; N];

    /// Returns the state one frame later, f(x).
    fn moved(&self, state: &SVector<f64, N>) -> SVector<f64, N>;

    /// Returns the state transition F, the Jacobian of f.
    fn transition(&self, state: &SVector<f64, N>) -> SMatrix<f64, N, N>;

    /// Returns the process noise covariance Q.
    fn noise(&self) -> SMatrix<f64, N, N>;

    /// Returns whether the prediction uses sigma points instead of the Jacobian.
    fn is_unscented(&self) -> bool {
        false
    }

    /// Returns the initial standard deviations of the components that a position does not measure.
    fn initial_deviations(&self, speed: f64) -> [f64; N];
}

/// Constant velocity with white acceleration noise, constant over each frame (Bar-Shalom, section 6.3.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// Standard deviation of the acceleration in px/frame².
    pub acceleration: f64,
}

/// Constant acceleration with white noise added to it in each frame (Bar-Shalom, section 6.3.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acceleration {
    /// Standard deviation of the change per frame in px/frame².
    pub change: f64,
}

/// Coordinated turn: constant speed and turn rate with noise on both (Bar-Shalom, section 11.7.1). Nonlinear: the filter is an
/// extended or an unscented Kalman filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Standard deviation of the acceleration in px/frame².
    pub acceleration: f64,
    /// Standard deviation of the change of the turn rate in radians/frame².
    pub rate_change: f64,
    /// The prediction through the nonlinear motion.
    pub prediction: Nonlinear,
}

/// The prediction of mean and covariance through a nonlinear motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nonlinear {
    /// By the Jacobian at the mean: the extended Kalman filter.
    Extended,
    /// By sigma points: the unscented Kalman filter.
    Unscented,
}

/// Returns Q = G Gᵀ σ² of noise σ that enters position, velocity and so on by `gains` = G, alike in x and y.
fn process_noise<const N: usize>(gains: &[f64], deviation: f64) -> SMatrix<f64, N, N> {
    let variance = deviation * deviation;
    SMatrix::from_fn(|i, j| match (gains.get(i / 2), gains.get(j / 2)) {
        (Some(a), Some(b)) if i % 2 == j % 2 => a * b * variance,
        _ => 0.0,
    })
}

impl Motion<4> for Velocity {
    const NAMES: [&'static str; 4] = ["x", "y", "u", "v"];

    fn moved(&self, state: &SVector<f64, 4>) -> SVector<f64, 4> {
        self.transition(state) * state
    }

    fn transition(&self, _: &SVector<f64, 4>) -> SMatrix<f64, 4, 4> {
        Matrix4::new(1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    }

    fn noise(&self) -> SMatrix<f64, 4, 4> {
        process_noise(&[0.5, 1.0], self.acceleration)
    }

    fn initial_deviations(&self, speed: f64) -> [f64; 4] {
        [0.0, 0.0, speed, speed]
    }
}

impl Motion<6> for Acceleration {
    const NAMES: [&'static str; 6] = ["x", "y", "u", "v", "a_x", "a_y"];

    fn moved(&self, state: &SVector<f64, 6>) -> SVector<f64, 6> {
        self.transition(state) * state
    }

    fn transition(&self, _: &SVector<f64, 6>) -> SMatrix<f64, 6, 6> {
        // In blocks of two: 1 on the diagonal, 1 for the next derivative, ½ for the one after it.
        SMatrix::from_fn(|i, j| match (i % 2 == j % 2, (j / 2).checked_sub(i / 2)) {
            (true, Some(0 | 1)) => 1.0,
            (true, Some(2)) => 0.5,
            _ => 0.0,
        })
    }

    fn noise(&self) -> SMatrix<f64, 6, 6> {
        process_noise(&[0.5, 1.0, 1.0], self.change)
    }

    fn initial_deviations(&self, speed: f64) -> [f64; 6] {
        // The change decays within a few frames.
        let change = speed / 5.0;
        [0.0, 0.0, speed, speed, change, change]
    }
}

/// The turn rate below which a turn is numerically a straight line, in radians/frame.
const STRAIGHT: f64 = 1e-6;

/// Returns sin ω / ω and (1 − cos ω) / ω, and their derivatives by ω.
fn arcs(rate: f64) -> ([f64; 2], [f64; 2]) {
    if rate.abs() < STRAIGHT {
        return ([1.0, rate / 2.0], [-rate / 3.0, 0.5]);
    }
    let (sin, cos) = rate.sin_cos();
    let along = sin / rate;
    // 1 − cos ω = 2 sin² (ω/2), without loss for small ω.
    let across = 2.0 * (rate / 2.0).sin().powi(2) / rate;
    ([along, across], [(cos - along) / rate, (sin - across) / rate])
}

impl Motion<5> for Turn {
    const NAMES: [&'static str; 5] = ["x", "y", "u", "v", "ω"];

    fn moved(&self, state: &SVector<f64, 5>) -> SVector<f64, 5> {
        let [x, y, u, v, rate] = state.data.0[0];
        let ([along, across], (sin, cos)) = (arcs(rate).0, rate.sin_cos());
        Vector5::new(x + along * u - across * v, y + across * u + along * v, cos * u - sin * v, sin * u + cos * v, rate)
    }

    fn transition(&self, state: &SVector<f64, 5>) -> SMatrix<f64, 5, 5> {
        let [_, _, u, v, rate] = state.data.0[0];
        let (([along, across], [d_along, d_across]), (sin, cos)) = (arcs(rate), rate.sin_cos());
        Matrix5::new(
            1.0,
            0.0,
            along,
            -across,
            d_along * u - d_across * v,
            0.0,
            1.0,
            across,
            along,
            d_across * u + d_along * v,
            0.0,
            0.0,
            cos,
            -sin,
            -sin * u - cos * v,
            0.0,
            0.0,
            sin,
            cos,
            cos * u - sin * v,
            0.0,
            0.0,
            0.0,
            0.0,
            1.0,
        )
    }

    fn noise(&self) -> SMatrix<f64, 5, 5> {
        let mut noise = process_noise(&[0.5, 1.0], self.acceleration);
        noise[(4, 4)] = self.rate_change * self.rate_change;
        noise
    }

    fn is_unscented(&self) -> bool {
        self.prediction == Nonlinear::Unscented
    }

    fn initial_deviations(&self, speed: f64) -> [f64; 5] {
        // A quarter of a turn in some ten frames.
        [0.0, 0.0, speed, speed, 0.15]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector4;

    use super::*;

    #[test]
    fn a_turn_keeps_its_speed_and_closes() {
        let turn = Turn { acceleration: 1.0, rate_change: 0.1, prediction: Nonlinear::Extended };
        let start = Vector5::new(3.0, -2.0, 4.0, 1.0, std::f64::consts::TAU / 40.0);
        let mut state = start;
        for _ in 0..40 {
            state = turn.moved(&state);
            assert!((state.fixed_rows::<2>(2).norm() - start.fixed_rows::<2>(2).norm()).abs() < 1e-12);
        }
        assert!((state - start).norm() < 1e-9, "a whole circle: {state}");
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let turn = Turn { acceleration: 1.0, rate_change: 0.1, prediction: Nonlinear::Extended };
        for rate in [-0.7, -1e-4, 0.0, 1e-7, 0.02, 1.3] {
            let state = Vector5::new(5.0, 7.0, -3.0, 2.0, rate);
            let jacobian = turn.transition(&state);
            for j in 0..5 {
                let mut step = SVector::<f64, 5>::zeros();
                step[j] = 1e-5;
                let slope = (turn.moved(&(state + step)) - turn.moved(&(state - step))) / 2e-5;
                assert!((slope - jacobian.column(j)).norm() < 1e-6, "ω = {rate}, column {j}: {slope}");
            }
        }
    }

    #[test]
    fn a_turn_of_none_is_constant_velocity() {
        let (turn, velocity) = (
            Turn { acceleration: 2.0, rate_change: 0.1, prediction: Nonlinear::Extended },
            Velocity { acceleration: 2.0 },
        );
        let moved = turn.moved(&Vector5::new(1.0, 2.0, 3.0, 4.0, 0.0));
        assert_eq!(moved.fixed_rows::<4>(0), velocity.moved(&Vector4::new(1.0, 2.0, 3.0, 4.0)));
        assert_eq!(turn.noise().fixed_view::<4, 4>(0, 0), velocity.noise());
    }
}
