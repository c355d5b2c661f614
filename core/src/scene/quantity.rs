//! Quantities that a model has for every pixel, as layers over frame t.

use std::fmt;
use std::sync::Arc;

use crate::geometry::Grid;

/// A quantity that a model has for every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// The standard deviation of the background, in gray levels.
    Deviation,
    /// The weight of the heaviest mode, 0 to 1.
    Weight,
    /// The number of modes.
    Modes,
}

impl Quantity {
    /// Every quantity.
    pub const ALL: [Self; 3] = [Self::Deviation, Self::Weight, Self::Modes];

    /// Its name in a legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deviation => "standard deviation of the background",
            Self::Weight => "weight of the heaviest mode",
            Self::Modes => "number of modes",
        }
    }

    /// Its unit; nothing for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Deviation => "gray levels",
            Self::Weight | Self::Modes => "",
        }
    }
}

/// The values of a quantity at every pixel of frame t, worked out when they are looked at.
#[derive(Clone)]
pub struct Layer {
    /// The quantity.
    pub quantity: Quantity,
    values: Arc<dyn Fn() -> Grid<f32> + Send + Sync>,
}

impl Layer {
    /// A layer whose values are computed by `values` when it is shown.
    pub fn new(quantity: Quantity, values: impl Fn() -> Grid<f32> + Send + Sync + 'static) -> Self {
        Self { quantity, values: Arc::new(values) }
    }

    /// The values at every pixel; NaN where there is none.
    pub fn values(&self) -> Grid<f32> {
        (self.values)()
    }
}

impl PartialEq for Layer {
    /// Whether both have the same quantity: layers computed from the same state have the same values.
    fn eq(&self, other: &Self) -> bool {
        self.quantity == other.quantity
    }
}

impl fmt::Debug for Layer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Layer").field("quantity", &self.quantity).finish_non_exhaustive()
    }
}
