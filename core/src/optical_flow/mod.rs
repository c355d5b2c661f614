//! Optical flow: a displacement for every pixel, from derivatives. One file per estimator; the shared parts are in
//! `differential`.

mod horn_schunck;
mod lucas_kanade;
mod normal_flow;

pub use horn_schunck::{HornSchunck, Solver};
pub use lucas_kanade::{LucasKanade, Weights};
pub use normal_flow::NormalFlow;
