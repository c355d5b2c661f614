//! Optical flow: displacements of pixels or of features, from derivatives. One file per estimator; the shared parts are in
//! `differential`, `variational` and `polynomial`.

mod clg;
mod farneback;
mod horn_schunck;
mod klt;
mod lucas_kanade;
mod normal_flow;
mod point_trajectories;
mod pyramidal_lucas_kanade;
mod tv_l1;

pub use crate::methods::differential::{Scheme, Weights};
pub use crate::methods::variational::{Settings, Solver, Variational};
pub use clg::Clg;
pub use farneback::Farneback;
pub use horn_schunck::HornSchunck;
pub use klt::Klt;
pub use lucas_kanade::LucasKanade;
pub use normal_flow::NormalFlow;
pub use point_trajectories::PointTrajectories;
pub use pyramidal_lucas_kanade::{Points, PyramidalLucasKanade};
pub use tv_l1::TvL1;
