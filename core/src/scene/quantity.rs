//! Quantities that a model has for every pixel, as layers over frame t.
//!
//! The values are computed when they are shown. A new [`Quantity`] has its name, unit and definition here; menus, palette and
//! flags follow.

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
    /// The difference of the background from the median of the frames so far, in gray levels.
    OffMedian,
    /// The share of the smoothness term in the update of a flow, 0 to 1.
    SmoothnessShare,
}

impl Quantity {
    /// Every quantity.
    pub const ALL: [Self; 5] = [Self::Deviation, Self::Weight, Self::Modes, Self::OffMedian, Self::SmoothnessShare];

    /// Stable name, for sessions and the command line.
    pub fn id(self) -> &'static str {
        match self {
            Self::Deviation => "deviation",
            Self::Weight => "weight",
            Self::Modes => "mode-count",
            Self::OffMedian => "median-difference",
            Self::SmoothnessShare => "smoothness-share",
        }
    }

    /// Its name in a list.
    pub fn title(self) -> &'static str {
        match self {
            Self::Deviation => "Standard deviation",
            Self::Weight => "Weight",
            Self::Modes => "Number of modes",
            Self::OffMedian => "Difference from the median",
            Self::SmoothnessShare => "Share of the smoothness term",
        }
    }

    /// What it shows, in one sentence.
    pub fn tip(self) -> &'static str {
        match self {
            Self::Deviation => "The standard deviation that the background model has for each pixel.",
            Self::Weight => "The weight of the heaviest mode of each pixel: how much of the past it explains.",
            Self::Modes => "The number of modes of each pixel: several where the background changes.",
            Self::OffMedian => {
                "How far the approximate median is from the true one, that of frames spread evenly up to this one."
            }
            Self::SmoothnessShare => {
                "How far the neighbours decide the flow of a pixel: α² / (α² + |∇I|²), 1 where there is no gradient."
            }
        }
    }

    /// Its name in a legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deviation => "standard deviation of the background",
            Self::Weight => "weight of the heaviest mode",
            Self::Modes => "number of modes",
            Self::OffMedian => "difference from the true median",
            Self::SmoothnessShare => "share of the smoothness term",
        }
    }

    /// Its unit; nothing for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Deviation | Self::OffMedian => "gray levels",
            Self::Weight | Self::Modes | Self::SmoothnessShare => "",
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
