//! What is run: a clip by its name, the estimators, a pixel to be explained, and estimators compared on one pair.

pub mod claims;
pub mod company;
pub mod comparison;
pub mod first;
pub mod pixel;
pub mod source;
pub mod sweeps;
