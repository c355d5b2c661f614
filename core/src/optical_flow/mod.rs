//! Optical flow: a displacement for every pixel, from derivatives. One file per estimator; the shared parts are in
//! `differential`.

mod horn_schunck;
mod normal_flow;

pub use horn_schunck::{HornSchunck, Solver};
pub use normal_flow::NormalFlow;
