//! The parameters that all block searches have, declared once.

use super::vocabulary::value;
use crate::data::Interpolation;
use crate::geometry::Border;
use crate::methods::cost::{self, Cut, Sum, whole, windows::Windows};
use crate::products::{Block, BlockField, BlockGrid, BlockVector};
use crate::scene::{Step, Unit, Value, Variable};
use crate::{choices, params};

choices! {
    /// Matching cost: the dissimilarity of two blocks.
    pub enum Cost {
        /// Sum of absolute differences, Σ |I_t − I_t+1|. Cheap, and robust against single large differences.
        Sad = "sad" "SAD",
        /// Sum of squared differences, Σ (I_t − I_t+1)². Large differences weigh more than in SAD.
        Ssd = "ssd" "SSD",
        /// Mean squared error: SSD / N for N pixels of the block. With λ = 0 it gives the same motion vectors as SSD.
        Mse = "mse" "MSE",
        /// Zero-mean SAD: the mean of each block is subtracted first, so the cost is invariant to a brightness offset.
        Zsad = "zsad" "ZSAD",
        /// Sum of absolute transformed differences: half the sum of the absolute coefficients of the 4×4 Hadamard transform of
        /// the differences. It approximates the bits of the residual better than SAD.
        Satd = "satd" "SATD",
        /// One minus the zero-mean normalised cross-correlation: invariant to gain and offset of brightness. 0 is a perfect
        /// match, 1 no correlation.
        Ncc = "ncc" "1 − NCC",
    }
}

impl Cost {
    /// The term summed over the pixels, for the costs that are such a sum.
    #[inline(always)]
    pub(crate) fn sum(self) -> Option<Sum> {
        match self {
            Cost::Sad => Some(Sum::Absolute),
            Cost::Ssd | Cost::Mse => Some(Sum::Squared),
            Cost::Zsad | Cost::Satd | Cost::Ncc => None,
        }
    }

    /// The cost for a sum over `block`.
    #[inline(always)]
    pub(crate) fn of(self, sum: u32, block: Block) -> f64 {
        match self {
            Cost::Mse => f64::from(sum) / (block.width * block.height) as f64,
            _ => sum.into(),
        }
    }

    /// The largest sum over `block` whose cost does not exceed `cost`.
    pub(crate) fn sum_within(self, cost: f64, block: Block) -> u32 {
        /// Larger than the rounding error of a mean, and smaller than one.
        const ROUNDING: f64 = 1e-6;
        match self {
            Cost::Mse => (cost * (block.width * block.height) as f64 + ROUNDING) as u32,
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

    /// The costs of a whole search window of `size` for the costs that are no [`sum`](Self::sum): those of
    /// [`between`](Self::between) for each candidate.
    pub(crate) fn window(
        self,
        cut: &Cut,
        area: &Cut,
        size: (usize, usize),
        (windows, costs): (&mut Windows, &mut Vec<f64>),
    ) {
        match self {
            Cost::Zsad => windows.zero_mean(cut, area, size, costs),
            Cost::Satd => windows.hadamard(cut, area, size, costs),
            Cost::Ncc => windows.correlation(cut, area, size, costs),
            Cost::Sad | Cost::Ssd | Cost::Mse => {}
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

    /// The mean absolute difference per pixel of a block with this cost, for squares the root mean square, in gray levels;
    /// `None` for transforms and correlation.
    pub(super) fn levels_of(self, cost: f64, block: Block) -> Option<f64> {
        let pixels = (block.width * block.height) as f64;
        match self {
            Cost::Sad | Cost::Zsad => Some(cost / pixels),
            Cost::Ssd => Some((cost / pixels).sqrt()),
            Cost::Mse => Some(cost.sqrt()),
            Cost::Satd | Cost::Ncc => None,
        }
    }

    /// Whether it does not grow with the number of pixels.
    pub(super) fn is_mean(self) -> bool {
        matches!(self, Cost::Mse | Cost::Ncc)
    }

    /// Whether differences are squared.
    pub(super) fn is_squared(self) -> bool {
        matches!(self, Cost::Ssd | Cost::Mse)
    }

    /// The decimals of the cost: none for sums of whole numbers.
    fn decimals(self) -> u8 {
        match self {
            Cost::Sad | Cost::Ssd | Cost::Satd => 0,
            Cost::Mse | Cost::Zsad => 2,
            Cost::Ncc => 4,
        }
    }

    /// Its label with the rate term λR added.
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
    /// Treatment of candidates that reach beyond the picture.
    pub enum BorderRule {
        /// Only candidates inside the picture are tested: the search window is cut at the border.
        Inside = "inside" "Inside only",
        /// Pixels of the border are replicated outwards, as in video coding (unrestricted motion vectors).
        Replicate = "replicate" "Replicate",
        /// The picture is reflected at its border.
        Mirror = "mirror" "Mirror",
    }
}

impl BorderRule {
    /// The extrapolation beyond the border.
    pub fn border(self) -> Border {
        match self {
            BorderRule::Inside | BorderRule::Replicate => Border::Replicate,
            BorderRule::Mirror => Border::Mirror,
        }
    }
}

params! {
    /// Blocks, window and cost: the first parameters of every block search.
    #[derive(Copy, PartialEq)]
    pub struct Matching {
        /// Side of the square blocks. Small blocks follow fine motion but match ambiguously; large ones average over several
        /// motions.
        block_size: usize = 16, 4..=64, "px";
        /// Largest displacement p that is tested in each direction; the search window holds (2p + 1)² candidates.
        search_range: usize = 16, 1..=64, "px";
        /// Matching cost between the block and a candidate. SSD and MSE differ by the factor N only: with λ = 0 they give
        /// the same motion vectors.
        cost: Cost = Cost::Sad;
    }
}

choices! {
    /// Sub-pixel refinement of the best whole-pixel displacement.
    pub enum Subpixel {
        /// No refinement: displacements in whole px.
        None = "none" "Whole px",
        /// Tests the 8 half-pixel positions around the best match on the interpolated frame t+1.
        Half = "half" "Half px",
        /// Tests the 8 half-pixel positions, then the 8 quarter-pixel positions around the best of them.
        Quarter = "quarter" "Quarter px",
        /// Fits a parabola through the costs at the best match and its two neighbours, along u and along v separately, and takes
        /// its minimum. SSD is near a parabola on smooth texture; SAD has a sharper minimum. A diagonal valley is located
        /// only roughly.
        Parabola = "parabola" "Parabola",
    }
}

impl Subpixel {
    /// The number of tested positions per px.
    pub(super) fn steps_per_px(self) -> i32 {
        match self {
            Subpixel::None | Subpixel::Parabola => 1,
            Subpixel::Half => 2,
            Subpixel::Quarter => 4,
        }
    }
}

params! {
    /// Sub-pixel refinement, rate term and block grid: the last parameters of every block search.
    #[derive(Copy, PartialEq)]
    pub struct Refinement {
        /// Sub-pixel refinement of the best whole-pixel displacement.
        subpixel: Subpixel = Subpixel::None;
        /// Interpolation of gray values between pixels, for the refinement and for the motion-compensated prediction.
        interpolation: Interpolation = Interpolation::Bilinear;
        /// Lagrange multiplier λ of the rate term: cost per bit of the difference between the motion vector and the median of
        /// its neighbours. 0 ignores the rate; higher values smooth the field.
        lambda: f32 = 0.0, 0.0..=100.0, "per bit";
        /// Distance between neighbouring blocks. 0 puts them edge to edge; less than the block size makes them overlap.
        spacing: usize = 0, 0..=64, "px";
        /// Treatment of candidates that reach beyond the picture.
        border: BorderRule = BorderRule::Inside;
    }
    advanced { "interpolation", "lambda", "spacing", "border" }
    when {
        "interpolation": |p| p.subpixel != Subpixel::None,
            "Interpolation has no effect on displacements of whole pixels.";
    }
}

/// The values of the parameters that all block searches have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Blocks, window and cost.
    pub matching: Matching,
    /// Sub-pixel refinement, rate term and block grid.
    pub refinement: Refinement,
}

impl Settings {
    pub(crate) fn grid(&self, picture: (usize, usize)) -> BlockGrid {
        super::grid(picture, self.matching.block_size, self.refinement.spacing)
    }

    /// The result of a search: `vectors` for `blocks`.
    pub(crate) fn field(&self, blocks: BlockGrid, vectors: Vec<Option<BlockVector>>) -> BlockField {
        BlockField {
            blocks,
            vectors,
            cost: self.label(),
            border: self.refinement.border.border(),
            filter: self.refinement.interpolation,
        }
    }

    /// The name of the cost as it stands before a number: `SAD`, `1 − NCC =`.
    pub(crate) fn measure(&self) -> String {
        format!("{}{}", self.label(), if self.label().contains(' ') { " =" } else { "" })
    }

    /// Puts a cost without the rate term, with its name, and the threshold that it is compared with.
    pub(crate) fn tell_comparison(&self, step: Step, distortion: f64, threshold: f64) -> Step {
        let plain = self.without_rate();
        step.put(value::MEASURE, plain.measure())
            .put_value(plain.cost(value::DISTORTION, distortion))
            .put_value(plain.cost(value::THRESHOLD, threshold))
    }

    /// The same without the rate term: costs are distortions.
    #[must_use]
    pub(crate) fn without_rate(self) -> Self {
        Self { refinement: Refinement { lambda: 0.0, ..self.refinement }, ..self }
    }

    /// A cost as the value of `of`, with the decimals of its kind.
    pub(crate) fn cost(&self, of: &'static Variable, cost: f64) -> Value {
        let decimals = self.matching.cost.decimals();
        let is_whole = self.refinement.lambda.fract() == 0.0;
        of.is(cost).in_unit(Unit::new("", if is_whole { decimals } else { decimals.max(2) }))
    }

    /// The name of the cost.
    pub(crate) fn label(&self) -> &'static str {
        if self.refinement.lambda == 0.0 { self.matching.cost.label() } else { self.matching.cost.priced_label() }
    }
}

/// A struct with the parameters of a block search: those declared by [`block_search_params!`].
pub trait HasSettings {
    /// Their values.
    fn settings(&self) -> Settings;
}

/// Declares the parameters of a block search: its own between the shared ones.
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
                /// Blocks, window and cost.
                matching: $crate::methods::block_search::Matching = $crate::methods::block_search::Matching::default();
                $($own)*
                /// Sub-pixel refinement, rate term and block grid.
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
