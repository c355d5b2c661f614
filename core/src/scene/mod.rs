//! Scenes and explanations: marks in image pixels, sentences and charts, each with roles.
//!
//! A scene is data. Painters (window, PNG, SVG) choose colours, dashes and halos by [`Role`].
//!
//! Marks have image coordinates: x right, y down, pixel centres at integers. `Scene::work` gives the pixels of a step where its
//! marks do not tell them. A [`Readout`] is a further part of the explanation: an equation with numbers, pixel tiles, a series,
//! a surface, matrices.

mod case;
mod cloud;
mod diagram;
pub mod latex;
mod levels;
mod marks;
mod math;
mod picture;
pub mod pseudocode;
mod quantity;
mod question;
mod readouts;
mod role;
mod sentence;
mod step;
mod value;

pub use case::Case;
#[doc(hidden)]
pub use case::{check as check_template, no_values};
pub use cloud::{Cloud, CloudCamera, CloudData, CloudLine, CloudPoint};
pub use diagram::{Diagram, DiagramLine, Node, Words};
pub use levels::{Floor, Level, Levels, Stack};
pub use marks::{Arrow, Link, Mark, Scene, Shape, arrow_spacing};
pub use math::Math;
pub use picture::{Canvas, Focus, Measured, Picture, PictureRole, Pixels, Viewpoint};
pub use pseudocode::{Line, Name};
pub use quantity::{Layer, Quantity};
pub use question::{Answer, Asked, Question, Reply, Shown, asked};
pub use readouts::{
    Axes, Band, BetweenPixels, Chart, Constraint, Distribution, Fact, Footing, Framed, Matrix, Plane, PlaneCost,
    Readout, Regions, Section, Series, Spread, Surface, Tile,
};
pub use role::Role;
pub use sentence::Sentence;
pub use step::Step;
pub use value::{Decimals, Number, Unit, Value, ValueStyle, Variable};
