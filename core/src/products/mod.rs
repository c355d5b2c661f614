//! What a run makes: products, each of one kind, and each kind a module of this folder.
//!
//! A product owns its data, its table, its comparison with truth, how it is looked at unless told otherwise, and what can
//! be coloured by it. [`KINDS`] is the one list of them: window, command line, comparison and export go through it.

mod assessment;
mod block_vectors;
mod dense_flow;
mod flow_error;
mod keypoints;
mod mask;
mod objects;
mod prediction;
mod tracks;

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

pub use assessment::{Assessment, Column, Figure, Measure, Reference, Score};
pub use block_vectors::{Block, BlockField, BlockGrid, BlockVector};
pub use dense_flow::{Confidence, DenseField};
pub use keypoints::{Feature, PointField, Status};
pub use mask::MaskField;
pub use prediction::{PSNR, predict};
pub use tracks::{Track, TrackField};

use crate::table::Table;
use crate::{Error, Flow, Gray, Histogram, ObjectField};

/// Every kind of product, in the order in which a person reads them.
pub const KINDS: &[&ProductKind] =
    &[BlockField::KIND, DenseField::KIND, PointField::KIND, TrackField::KIND, MaskField::KIND, ObjectField::KIND];

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

    /// The product itself, for [`Output::get`].
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

    fn histogram(&self) -> Option<Histogram> {
        Product::histogram(self)
    }

    fn last_frame(&self) -> Option<usize> {
        Product::last_frame(self)
    }
}

/// The result of a run, or of the part of it that was done: one product or several, the one that matters most first.
#[derive(Clone, Debug)]
pub struct Output(Vec<Arc<dyn AnyProduct>>);

/// Two are equal where all their products are.
impl PartialEq for Output {
    fn eq(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(|(a, b)| a.is_equal(&**b))
    }
}

impl Output {
    /// A result of one product.
    pub fn of(product: impl Product) -> Self {
        Self(vec![Arc::new(product)])
    }

    /// The same with one more.
    #[must_use]
    pub fn and(mut self, product: impl Product) -> Self {
        self.0.push(Arc::new(product));
        self
    }

    /// All products.
    pub fn products(&self) -> impl Iterator<Item = &dyn AnyProduct> {
        self.0.iter().map(|product| &**product)
    }

    /// The kinds of its products.
    pub fn kinds(&self) -> impl Iterator<Item = &'static ProductKind> {
        self.products().map(AnyProduct::kind)
    }

    /// The product of kind `P`, if there is one.
    pub fn get<P: Product>(&self) -> Option<&P> {
        self.products().find_map(|product| product.as_any().downcast_ref())
    }

    /// The same result with the product of kind `P` changed, where there is one.
    #[must_use]
    pub fn map<P: Product>(self, change: impl Fn(P) -> P) -> Self {
        let changed = |product: Arc<dyn AnyProduct>| match product.as_any().downcast_ref::<P>() {
            Some(known) => Arc::new(change(known.clone())) as Arc<dyn AnyProduct>,
            None => product,
        };
        Self(self.0.into_iter().map(changed).collect())
    }

    /// As [`Product::flow`], of the first product that has one.
    pub fn flow(&self) -> Option<Flow> {
        self.products().find_map(AnyProduct::flow)
    }

    /// As [`Product::confidence`].
    pub fn confidence(&self) -> Option<&Confidence> {
        self.products().find_map(AnyProduct::confidence)
    }

    /// As [`Product::prediction`].
    pub fn prediction(&self, next: &Gray) -> Option<Gray> {
        self.products().find_map(|product| product.prediction(next))
    }

    /// As [`Product::displacements`].
    pub fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        self.products().find_map(AnyProduct::displacements)
    }

    /// As [`Product::histogram`].
    pub fn histogram(&self) -> Option<Histogram> {
        self.products().find_map(AnyProduct::histogram)
    }

    /// As [`Product::table`].
    pub fn table(&self) -> Option<Table> {
        self.products().find_map(AnyProduct::table)
    }

    /// As [`Product::last_frame`].
    pub fn last_frame(&self) -> Option<usize> {
        self.products().find_map(AnyProduct::last_frame)
    }

    /// Where its products tell of motion at most.
    pub fn motion(&self) -> Motion {
        self.kinds().map(|kind| kind.motion).max().unwrap_or_default()
    }

    /// How good it is.
    ///
    /// # Errors
    /// If a frame cannot be read.
    pub fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let each = self.products().map(|product| product.assess(reference));
        each.collect::<Result<Vec<_>, _>>().map(|all| all.into_iter().fold(Assessment::default(), Assessment::and))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    #[test]
    fn kinds_have_names_of_their_own() {
        for (i, kind) in KINDS.iter().enumerate() {
            assert!(KINDS[..i].iter().all(|other| other.id != kind.id && other.name != kind.name), "{}", kind.id);
            assert!(kind.summary.ends_with('.') && !kind.summary.contains('\n'), "{}", kind.id);
        }
    }

    #[test]
    fn measures_have_keys_of_their_own() {
        for kind in KINDS {
            let keys: Vec<_> = kind.measures.iter().copied().flatten().map(|measure| measure.key).collect();
            assert!(keys.iter().enumerate().all(|(i, key)| !keys[..i].contains(key)), "{}: {keys:?}", kind.id);
        }
    }

    #[test]
    fn products_are_found_by_their_kind() {
        let flow = Flow(Grid::new(2, 2, [1.0, 0.0]));
        let dense = DenseField { flow: flow.clone(), confidence: None };
        let points = PointField { picture: (2, 2), points: Vec::new(), responses: Vec::new() };
        let output = Output::of(points.clone()).and(dense.clone());
        assert_eq!((output.get::<DenseField>(), output.get::<PointField>()), (Some(&dense), Some(&points)));
        assert_eq!((output.get::<BlockField>(), output.motion()), (None, Motion::Pixels));
        assert_ne!(output, Output::of(dense.clone()).and(points));
        let still =
            output.clone().map(|_: DenseField| DenseField { flow: Flow(flow.0.map(|_| [0.0; 2])), confidence: None });
        assert!(still != output && still.get::<PointField>() == output.get::<PointField>());
    }
}
