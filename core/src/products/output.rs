//! The result of a run: its products.

use std::sync::Arc;

use super::Tested;
use super::{AnyProduct, Assessment, Confidence, Motion, Product, ProductKind, Reference, Table};
use crate::base::Error;
use crate::data::{Flow, Histogram};
use crate::geometry::Gray;

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

    /// The same result with a further product.
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

    /// As [`Product::tested`].
    pub fn tested(&self) -> Option<Vec<Option<Tested>>> {
        self.products().find_map(AnyProduct::tested)
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

    /// The densest motion among its products.
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
