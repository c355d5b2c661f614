#![doc = include_str!("../README.md")]
//!
//! # Layers
//!
//! Each module uses only the ones before it: [`base`], [`geometry`], [`mod@params`], [`data`], [`synth`], [`scene`],
//! [`products`], [`run`], [`methods`], [`families`], [`course`]. The [`prelude`] has what most programs need.

pub mod base;
pub mod course;
pub mod data;
pub mod families;
pub mod geometry;
pub mod methods;
pub mod params;
pub mod products;
pub mod run;
pub mod scene;
pub mod synth;

/// The names that most programs need.
///
/// [`Estimator`](crate::run::Estimator) is not among them: it is for those who write an estimator, and its methods have the names of
/// [`AnyEstimator`](crate::run::AnyEstimator)'s, which every estimator has.
pub mod prelude {
    pub use crate::base::{Error, Stop, Threads};
    pub use crate::course::{estimator, estimators};
    pub use crate::data::{Clip, Flow, Frame};
    pub use crate::geometry::{Gray, Grid};
    pub use crate::params::Params;
    pub use crate::products::{
        BlockField, DenseField, MaskField, MatchField, ObjectField, Output, PointField, Product, TrackField,
    };
    pub use crate::run::{AnyEstimator, Cursor, Direction, Move, Walk};
    pub use crate::scene::{Role, Scene, Step};
}
