//! Scene flow: the motion of the cameras, estimated from points in space.

mod ego;

pub use ego::{Consensus, Draw, Ego, EgoSettings, FEWEST, Fit};
