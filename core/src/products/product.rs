//! The trait of all products, and their kinds.

use std::any::Any;
use std::fmt::Debug;

use super::{Assessment, Measure, Reference, Table};
use crate::base::Error;
use crate::data::{Flow, Histogram};
use crate::geometry::{Gray, Grid};

/// The declaration of a kind of product.
#[derive(Debug)]
pub struct ProductKind {
    /// Kebab-case id: `dense-flow`.
    pub id: &'static str,
    /// Its name in the window: `Dense flow`.
    pub name: &'static str,
    /// Its definition in one sentence.
    pub summary: &'static str,
    /// Where it has motion.
    pub motion: Motion,
    /// Whether it belongs to single frames, so that one frame is shown by default.
    pub is_of_single_frames: bool,
    /// Whether the run makes pictures that belong beside frame t, such as a mosaic.
    pub has_pictures: bool,
    /// Its quality measures, in groups.
    pub measures: &'static [&'static [Measure]],
}

/// Kinds are equal if their ids are.
impl PartialEq for ProductKind {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for ProductKind {}

/// The density of a product's motion, in ascending order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Motion {
    /// Nowhere.
    #[default]
    Nowhere,
    /// At single points.
    Points,
    /// For every block.
    Blocks,
    /// At every pixel.
    Pixels,
}

impl Motion {
    /// Whether there is a displacement for every pixel.
    pub fn is_field(self) -> bool {
        self >= Self::Blocks
    }
}

/// Confidence of displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct Confidence {
    /// Its name in lower case without spaces, with the unit: a column of a table.
    pub name: &'static str,
    /// Its value at each pixel.
    pub values: Grid<f32>,
}

/// The search behind a part of a product: cost and number of candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tested {
    /// Cost of the best match.
    pub cost: f64,
    /// Number of candidates tested.
    pub candidates: u32,
}

/// A result of a run.
pub trait Product: Clone + Debug + PartialEq + Send + Sync + 'static {
    /// The declaration of its kind.
    const KIND: &'static ProductKind;

    /// Its data as a table; `None` if it has none.
    fn table(&self) -> Option<Table>;

    /// Its quality, by itself and against ground truth if there is any.
    ///
    /// # Errors
    /// If a frame cannot be read. Unreadable ground truth is reported in [`Assessment::truth_error`].
    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error>;

    /// The displacement of every pixel, of the last pair if there are several; unknown where there is no estimate.
    fn flow(&self) -> Option<Flow> {
        None
    }

    /// Confidence of each displacement of [`Product::flow`], larger is better.
    fn confidence(&self) -> Option<&Confidence> {
        None
    }

    /// The motion-compensated prediction of frame t from `next`, frame t + 1.
    fn prediction(&self, _next: &Gray) -> Option<Gray> {
        None
    }

    /// The displacements of its parts, in an order shared by all runs on pictures of the same size.
    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        None
    }

    /// Cost and candidates of each part, in the order of [`Product::displacements`], for block searches.
    fn tested(&self) -> Option<Vec<Option<Tested>>> {
        None
    }

    /// The histogram of displacements, if units do not provide it.
    fn histogram(&self) -> Option<Histogram> {
        None
    }

    /// Its last frame, if that is not the second of a pair.
    fn last_frame(&self) -> Option<usize> {
        None
    }
}

/// A product of any kind.
pub trait AnyProduct: Debug + Send + Sync {
    /// The declaration of its kind.
    fn kind(&self) -> &'static ProductKind;

    /// The product itself, for [`Output::get`](super::Output::get).
    fn as_any(&self) -> &dyn Any;

    /// Whether `other` is an equal product of the same kind.
    fn is_equal(&self, other: &dyn AnyProduct) -> bool;

    /// As [`Product::table`].
    fn table(&self) -> Option<Table>;

    /// As [`Product::assess`].
    ///
    /// # Errors
    /// As [`Product::assess`].
    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error>;

    /// As [`Product::flow`].
    fn flow(&self) -> Option<Flow>;

    /// As [`Product::confidence`].
    fn confidence(&self) -> Option<&Confidence>;

    /// As [`Product::prediction`].
    fn prediction(&self, next: &Gray) -> Option<Gray>;

    /// As [`Product::displacements`].
    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>>;

    /// As [`Product::tested`].
    fn tested(&self) -> Option<Vec<Option<Tested>>>;

    /// As [`Product::histogram`].
    fn histogram(&self) -> Option<Histogram>;

    /// As [`Product::last_frame`].
    fn last_frame(&self) -> Option<usize>;
}

impl<P: Product> AnyProduct for P {
    fn kind(&self) -> &'static ProductKind {
        P::KIND
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn is_equal(&self, other: &dyn AnyProduct) -> bool {
        other.as_any().downcast_ref::<P>().is_some_and(|other| self == other)
    }

    fn table(&self) -> Option<Table> {
        Product::table(self)
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        Product::assess(self, reference)
    }

    fn flow(&self) -> Option<Flow> {
        Product::flow(self)
    }

    fn confidence(&self) -> Option<&Confidence> {
        Product::confidence(self)
    }

    fn prediction(&self, next: &Gray) -> Option<Gray> {
        Product::prediction(self, next)
    }

    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        Product::displacements(self)
    }

    fn tested(&self) -> Option<Vec<Option<Tested>>> {
        Product::tested(self)
    }

    fn histogram(&self) -> Option<Histogram> {
        Product::histogram(self)
    }

    fn last_frame(&self) -> Option<usize> {
        Product::last_frame(self)
    }
}
