//! The Kalman filter: R. E. Kalman, A new approach to linear filtering and prediction problems, 1960; motions, consistency and
//! smoothing after Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with applications to tracking and navigation, 2001.
//!
//! [`Filter`] is a filter whose motion model is chosen at run time (`any.rs`), over one of fixed dimension (`filter.rs`).

mod any;
pub mod chi_square;
mod consistency;
mod ellipse;
mod estimate;
mod filter;
mod hill;
pub(crate) mod interacting;
mod motion;
pub(crate) mod unscented;
pub(crate) mod vocabulary;

pub use any::{
    AssociationNumbers, Filter, Measurement, Model, MotionModel, Noises, PredictionNumbers, Sigma, UpdateNumbers,
};
pub use consistency::ConsistencyTest;
pub use ellipse::ellipse;
pub use estimate::{Estimate, Prediction};
pub use filter::{Association, Innovation, Sensor, Smoothed, Update, smoothed};
pub use hill::Surroundings;
pub use interacting::{Interacting, Mixing, Modes};
pub use motion::{Acceleration, Motion, Nonlinear, Turn, Velocity};
