//! The parameters that all block searches have, declared once.

use super::Subpixel;
use crate::data::Interpolation;
use crate::geometry::Border;
use crate::methods::cost::{self, Cut, Sum, whole};
use crate::products::{Block, BlockField, BlockGrid, BlockVector};
use crate::{choices, params};

choices! {
    /// How unlike two blocks are.
    pub enum Cost {
        /// Sum of absolute differences, Σ |I_t − I_t+1|.
        Sad = "sad" "SAD",
        /// Sum of squared differences, Σ (I_t − I_t+1)²; large differences weigh more.
        Ssd = "ssd" "SSD",
        /// Mean squared error: SSD divided by the number of pixels N of the block, so without lambda it chooses the same vectors.
        Mse = "mse" "MSE",
        /// Zero-mean SAD: each block's mean is taken off first, so that an offset of the light changes nothing.
        Zsad = "zsad" "ZSAD",
        /// Half the sum of the absolute coefficients of the differences' 4×4 Hadamard transform, near what coding them takes.
        Satd = "satd" "SATD",
        /// One less the normalised correlation of the blocks, each less its mean: neither gain nor offset of the light
        /// changes it. 0 fits perfectly, 1 not at all.
        Ncc = "ncc" "1 − NCC",
    }
}

impl Cost {
    /// What is summed over the pixels, if it is such a sum.
    #[inline(always)]
    pub(crate) fn sum(self) -> Option<Sum> {
        match self {
            Cost::Sad => Some(Sum::Absolute),
            Cost::Ssd | Cost::Mse => Some(Sum::Squared),
            Cost::Zsad | Cost::Satd | Cost::Ncc => None,
        }
    }

    /// The cost that a sum over `block` amounts to.
    #[inline(always)]
    pub(crate) fn of(self, sum: u32, block: Block) -> f64 {
        match self {
            Cost::Mse => f64::from(sum) / (block.width * block.height) as f64,
            _ => sum.into(),
        }
    }

    /// The largest sum over `block` that amounts to no more than `cost`.
    pub(crate) fn sum_within(self, cost: f64, block: Block) -> u32 {
        match self {
            Cost::Mse => (cost * (block.width * block.height) as f64) as u32,
            _ => cost as u32,
        }
    }

    /// The cost of `block`, whose pixels are `cut`, against the candidate whose first pixel is the first of `pixels`, in
    /// rows of `stride` pixels.
    #[inline]
    pub(crate) fn between(self, block: Block, cut: &Cut, pixels: &[u8], stride: usize) -> f64 {
        match self {
            Cost::Sad => self.of(cost::candidate(Sum::Absolute, cut, pixels, stride), block),
            Cost::Ssd | Cost::Mse => self.of(cost::candidate(Sum::Squared, cut, pixels, stride), block),
            Cost::Zsad => whole::zero_mean(cut, pixels, stride),
            Cost::Satd => whole::hadamard(cut, pixels, stride),
            Cost::Ncc => whole::correlation(cut, pixels, stride),
        }
    }

    /// The cost of a block whose pixels differ by `levels` gray levels on average (for squares: in the root mean square).
    /// Correlation knows no gray levels: there only a perfect fit will do.
    pub(crate) fn of_levels(self, levels: f64, block: Block) -> f64 {
        let pixels = (block.width * block.height) as f64;
        match self {
            Cost::Sad | Cost::Zsad | Cost::Satd => levels * pixels,
            Cost::Ncc => 0.0,
            Cost::Ssd => levels * levels * pixels,
            Cost::Mse => levels * levels,
        }
    }

    /// The cost as a person reads it.
    fn show(self, cost: f64) -> String {
        match self {
            Cost::Sad | Cost::Ssd | Cost::Satd => cost.to_string(),
            Cost::Mse | Cost::Zsad => format!("{cost:.2}"),
            Cost::Ncc => format!("{cost:.4}"),
        }
    }

    /// Its label where the price of the displacement is added.
    fn priced_label(self) -> &'static str {
        match self {
            Cost::Sad => "SAD + λR",
            Cost::Ssd => "SSD + λR",
            Cost::Mse => "MSE + λR",
            Cost::Zsad => "ZSAD + λR",
            Cost::Satd => "SATD + λR",
            Cost::Ncc => "1 − NCC + λR",
        }
    }
}

choices! {
    /// What happens where the window leaves the picture.
    pub enum BorderRule {
        /// Only candidates that lie wholly inside the picture are tested: the window is cut.
        Inside = "inside" "Stay inside",
        /// The edge pixel is repeated outwards, as video coders do.
        Replicate = "replicate" "Repeat the edge",
        /// The picture is mirrored at its edge.
        Mirror = "mirror" "Mirror",
    }
}

impl BorderRule {
    /// How pixels outside are read.
    pub fn border(self) -> Border {
        match self {
            BorderRule::Inside | BorderRule::Replicate => Border::Replicate,
            BorderRule::Mirror => Border::Mirror,
        }
    }
}

params! {
    /// What is compared, and how: the first parameters that all block searches have.
    #[derive(Copy, PartialEq)]
    pub struct Matching {
        /// Side of the square blocks.
        block: usize = 16, 4..=64, "px";
        /// Largest displacement to the left, right, up and down that is tested.
        range: usize = 16, 1..=64, "px";
        /// How unlike two blocks are. SSD and MSE are one divided by the other: without lambda they choose the
        /// same vectors.
        cost: Cost = Cost::Sad;
    }
}

params! {
    /// How closely, at what price and where: the last parameters that all block searches have.
    #[derive(Copy, PartialEq)]
    pub struct Refinement {
        /// How closely a displacement is found: the best in whole px is refined.
        subpixel: Subpixel = Subpixel::None;
        /// How gray values between pixels are interpolated, for the refinement and for the prediction.
        filter: Interpolation = Interpolation::Bilinear;
        /// Cost of each bit that the displacement takes when it is sent as its difference from the median of the
        /// neighbours' displacements, in units of the cost; 0 leaves the bits out.
        lambda: f32 = 0.0, 0.0..=100.0, "per bit";
        /// Distance from one block to the next; 0 sets them edge to edge, less than the block lets them overlap.
        spacing: usize = 0, 0..=64, "px";
        /// What happens where the window leaves the picture.
        border: BorderRule = BorderRule::Inside;
    }
    advanced { "filter", "lambda", "spacing", "border" }
    when {
        "filter": |p| p.subpixel != Subpixel::None, "Interpolation has no effect on displacements of whole pixels.";
    }
}

/// The values of the parameters that all block searches have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What is compared, and how.
    pub matching: Matching,
    /// How closely, at what price and where.
    pub refinement: Refinement,
}

impl Settings {
    /// Where the blocks of a picture lie.
    pub(crate) fn grid(&self, picture: (usize, usize)) -> BlockGrid {
        super::grid(picture, self.matching.block, self.refinement.spacing)
    }

    /// The result of a search: `vectors` for `blocks`.
    pub(crate) fn field(&self, blocks: BlockGrid, vectors: Vec<Option<BlockVector>>) -> BlockField {
        BlockField {
            blocks,
            vectors,
            cost: self.label(),
            border: self.refinement.border.border(),
            filter: self.refinement.filter,
        }
    }

    /// A cost as a person reads it, with its name: `SAD 120`.
    pub(crate) fn show(&self, cost: f64) -> String {
        format!("{} {}", self.label(), self.number(cost))
    }

    /// The same without the price of a displacement, to show how badly something fits.
    #[must_use]
    pub(crate) fn free(self) -> Self {
        Self { refinement: Refinement { lambda: 0.0, ..self.refinement }, ..self }
    }

    /// A cost as a person reads it.
    pub(super) fn number(&self, cost: f64) -> String {
        if self.refinement.lambda == 0.0 {
            return self.matching.cost.show(cost);
        }
        let digits = if self.matching.cost == Cost::Ncc { 4 } else { 2 };
        let shown = format!("{cost:.digits$}");
        shown.trim_end_matches('0').trim_end_matches('.').into()
    }

    /// What the cost is called.
    pub(crate) fn label(&self) -> &'static str {
        if self.refinement.lambda == 0.0 { self.matching.cost.label() } else { self.matching.cost.priced_label() }
    }
}

/// What has the parameters of a block search: every struct that [`block_search_params!`] declares.
pub trait HasSettings {
    /// Their values.
    fn settings(&self) -> Settings;
}

/// Declares the parameters of a block search: its own between those that all have.
macro_rules! block_search_params {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($own:tt)*
        }
    ) => {
        $crate::params! {
            $(#[$meta])*
            pub struct $name {
                /// What is compared, and how.
                matching: $crate::methods::block_search::Matching = $crate::methods::block_search::Matching::default();
                $($own)*
                /// How closely, at what price and where.
                refinement: $crate::methods::block_search::Refinement =
                    $crate::methods::block_search::Refinement::default();
            }
        }

        impl $crate::methods::block_search::HasSettings for $name {
            fn settings(&self) -> $crate::methods::block_search::Settings {
                let Self { matching, refinement, .. } = *self;
                $crate::methods::block_search::Settings { matching, refinement }
            }
        }
    };
}
pub(crate) use block_search_params;
