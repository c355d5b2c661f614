//! The estimators: a folder for each family, a file for each of its estimators.
//!
//! The fields of a struct here are its parameters. Many structs are estimators themselves; others are models that a wrapper makes one:
//! `Variational(HornSchunck { alpha: 4.0, ..HornSchunck::default() })`. Any parameter can also be set by its name, with
//! [`Params::set`](crate::params::Params::set).

pub mod block_matching;
pub mod correspondence;
pub mod interest_points;
pub mod motion_segmentation;
pub mod moving_objects;
pub mod optical_flow;
pub mod region_tracking;
pub mod stereo;
pub mod tracking;
