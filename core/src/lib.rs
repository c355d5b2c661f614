//! Motion estimators that can be walked through: 67 of them, from block matching to scene flow, without a screen, a file or a codec.
//!
//! Two arrays in, flow out:
//!
//! ```
//! use motionscope_core::prelude::*;
//!
//! // Row by row, one byte a pixel; the second picture is the first, moved by one pixel to the right.
//! let (width, height) = (64, 48);
//! let texture = |x: usize, y: usize| (128.0 + 60.0 * (x as f64 / 3.0).sin() + 60.0 * (y as f64 / 4.0).cos()) as u8;
//! let first: Vec<u8> = (0..width * height).map(|i| texture(i % width + 1, i / width)).collect();
//! let second: Vec<u8> = (0..width * height).map(|i| texture(i % width, i / width)).collect();
//!
//! let frame = |pixels| Ok::<_, Error>(Frame::gray(Grid::from_vec(width, height, pixels)?));
//! let clip = Clip::from_frames("two arrays", vec![frame(first)?, frame(second)?])?;
//! let output = estimator("lucas-kanade")?.run(&clip, 0, &Threads::all()?)?;
//! let flow = output.flow().expect("Lucas and Kanade's method makes a dense flow");
//! let [u, v] = flow.at(32, 24).expect("a window with texture has a flow");
//! assert!((u - 1.0).abs() < 0.1 && v.abs() < 0.1, "{u}, {v}");
//! # Ok::<(), Error>(())
//! ```
//!
//! Walk through it, in both directions, with a sentence for every step:
//!
//! ```
//! use motionscope_core::prelude::*;
//! use motionscope_core::synth;
//!
//! let sample = synth::scene("pillar")?;
//! let clip = synth::make(sample.id, &sample.difficulty())?;
//! let mut walk = estimator("diamond")?.walk(&clip, 0)?;
//! walk.jump(Move::To(Cursor { unit: 34, event: 2 }));
//! let step = walk.step(None);
//! println!("{}", step.sentence.plain());
//! let candidate = walk.info().granularities.len() - 1;
//! walk.jump(Move::Granularity(candidate, Direction::Forward));
//! walk.jump(Move::Granularity(candidate, Direction::Back));
//! assert_eq!(walk.step(None).sentence, step.sentence);
//! println!("{} marks to draw", walk.scene(None).marks.len());
//! # Ok::<(), Error>(())
//! ```
//!
//! # Parameters
//!
//! An estimator is a struct whose fields are its parameters. One that is chosen by its id has them by name, as text; the
//! range is checked in both cases before a run.
//!
//! ```
//! use motionscope_core::families::optical_flow::LucasKanade;
//! use motionscope_core::prelude::*;
//!
//! let typed = LucasKanade { window: 21, ..LucasKanade::default() };
//! let mut named = estimator("lucas-kanade")?;
//! named.set("window", "21")?;
//! assert_eq!(typed.all_values(), named.all_values());
//! assert!(named.set("window", "2100").is_err());
//! # Ok::<(), Error>(())
//! ```
//!
//! An estimator can be a stage of another, with parameters of its own:
//!
//! ```
//! use motionscope_core::prelude::*;
//!
//! let mut tracker = estimator("kalman-tracker")?;
//! tracker.set("detector", "mixture-of-gaussians")?;
//! tracker.set("detector.learning-rate", "0.01")?;
//! assert!(tracker.set("detector", "full-search").unwrap_err().to_string().contains("makes block vectors"));
//! # Ok::<(), Error>(())
//! ```
//!
//! # Layers
//!
//! Each module uses only the ones before it: [`base`], [`geometry`], [`params`], [`data`], [`synth`], [`scene`],
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
