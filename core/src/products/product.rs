//! What every product is: its kind, and what can be asked of it.

use std::any::Any;
use std::fmt::Debug;

use super::{Assessment, Measure, Reference, Table};
use crate::base::Error;
use crate::data::{Flow, Histogram};
use crate::geometry::{Gray, Grid};

/// What there is to say about a kind of product before there is one.
#[derive(Debug)]
pub struct ProductKind {
    /// Kebab-case id: `dense-flow`.
    pub id: &'static str,
    /// Its name in the window: `Dense flow`.
    pub name: &'static str,
    /// What it is, in one sentence.
    pub summary: &'static str,
    /// Where it tells of motion.
    pub motion: Motion,
    /// Whether it is about each frame by itself, so that this frame alone is shown unless told otherwise.
    pub is_of_single_frames: bool,
    /// The figures by which it is assessed, in groups.
    pub measures: &'static [&'static [Measure]],
}

/// Two are the same kind where they have the same id.
impl PartialEq for ProductKind {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for ProductKind {}

/// Where a product tells of motion: nowhere first, everywhere last.
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

/// How far displacements are to be trusted.
#[derive(Clone, Debug, PartialEq)]
pub struct Confidence {
    /// What is measured, in lower case and without spaces, with its unit: a column of a table.
    pub name: &'static str,
    /// Its value at each pixel.
    pub values: Grid<f32>,
}

/// What a part of a product was chosen by among its candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tested {
    /// What the one that was chosen costs.
    pub cost: f64,
    /// How many were tested.
    pub candidates: u32,
}

/// Something that a run makes.
pub trait Product: Clone + Debug + PartialEq + Send + Sync + 'static {
    /// What there is to say about its kind.
    const KIND: &'static ProductKind;

    /// What it holds, row by row; `None` where that is no table.
    fn table(&self) -> Option<Table>;

    /// How good it is, by itself and beside the truth where that is known.
    ///
    /// # Errors
    /// If a frame cannot be read. A truth that cannot be read is told in [`Assessment::truth_error`].
    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error>;

    /// The displacement of every pixel, of the last pair where there are several: unknown wherever nothing is said of one.
    fn flow(&self) -> Option<Flow> {
        None
    }

    /// How far each displacement of [`Product::flow`] is trusted, larger is better.
    fn confidence(&self) -> Option<&Confidence> {
        None
    }

    /// The motion-compensated prediction of frame t from `next`, frame t + 1.
    fn prediction(&self, _next: &Gray) -> Option<Gray> {
        None
    }

    /// The displacements of its parts in an order that another run on pictures of the same size shares, where there is one.
    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        None
    }

    /// What each of its parts was chosen by, in the order of [`Product::displacements`], where candidates were tested.
    fn tested(&self) -> Option<Vec<Option<Tested>>> {
        None
    }

    /// How often each displacement was found, where units do not tell that already.
    fn histogram(&self) -> Option<Histogram> {
        None
    }

    /// The last frame that it tells of, where that is not the second of a pair.
    fn last_frame(&self) -> Option<usize> {
        None
    }
}

/// A product of which only the kind matters.
pub trait AnyProduct: Debug + Send + Sync {
    /// What there is to say about its kind.
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
