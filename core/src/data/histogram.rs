//! The 2-D histogram of displacements.

use super::Flow;
use crate::base::entropy;
use crate::geometry::Grid;

/// Smallest range to either side of (0, 0) in px, so that the histogram does not grow at each step.
const LEAST: i32 = 2;

/// The blocks that a histogram counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Unit of the first block.
    pub first_unit: usize,
    /// Level of the pyramid, if there are several.
    pub level: Option<usize>,
}

/// Largest displacement component of pixels in px: outliers are counted at the edge.
const FARTHEST: f32 = 64.0;

/// Bins per px that are tried: the first of which all displacements of blocks are multiples.
const BINS_PER_PX: [i32; 3] = [1, 2, 4];

/// Counts of displacements in bins of 1×1 px, or of ½ or ¼ px where all displacements of blocks are multiples of these.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// The element that has a displacement: `block`.
    pub of: &'static str,
    /// Level of the pyramid, if there are several.
    pub level: Option<usize>,
    /// Bins per px along each axis.
    pub bins_per_px: i32,
    /// Column and row of the first bin, counted from the bin of displacement (0, 0).
    pub origin: [i32; 2],
    /// Count of each bin.
    pub counts: Grid<u32>,
    /// The unit of the first displacement in each bin: the target of a click.
    pub units: Grid<Option<usize>>,
    /// The bin of the latest result, if any.
    pub newest: Option<[i32; 2]>,
    /// Zero-order entropy in bits per vector, vectors being quantised to 0.01 px; `None` for pixels, whose vectors are not
    /// coded one by one.
    pub bits: Option<f64>,
    /// Whether some displacements lie beside the centres of their bins.
    pub is_rounded: bool,
}

impl Histogram {
    /// The histogram of `vectors`, the displacements of blocks in px; the last is the latest result if `has_newest`. `None`
    /// without vectors.
    pub fn of(counted: Counted, vectors: &[[f32; 2]], has_newest: bool) -> Option<Self> {
        let is_multiple = |per_px: &i32| vectors.iter().flatten().all(|c| (c * *per_px as f32).fract() == 0.0);
        let exact = BINS_PER_PX.into_iter().find(is_multiple);
        let whole = Self::in_bins(counted, vectors, exact.unwrap_or(1))?;
        Some(Self { newest: whole.newest.filter(|_| has_newest), is_rounded: exact.is_none(), ..whole })
    }

    /// The same with so many bins per px.
    fn in_bins(counted: Counted, vectors: &[[f32; 2]], bins_per_px: i32) -> Option<Self> {
        let last = vectors.last()?;
        let bin = |vector: &[f32; 2]| vector.map(|c| (c * bins_per_px as f32).round() as i32);
        let (mut low, mut high) = ([-LEAST * bins_per_px; 2], [LEAST * bins_per_px; 2]);
        for at in vectors.iter().map(bin) {
            low = [0, 1].map(|i| low[i].min(at[i]));
            high = [0, 1].map(|i| high[i].max(at[i]));
        }
        let [width, height] = [0, 1].map(|i| (high[i] - low[i]) as usize + 1);
        let (mut counts, mut units) = (Grid::new(width, height, 0), Grid::new(width, height, None));
        for (i, vector) in vectors.iter().enumerate() {
            let at = bin(vector);
            let cell = ((at[0] - low[0]) as usize, (at[1] - low[1]) as usize);
            counts[cell] += 1;
            units[cell].get_or_insert(counted.first_unit + i);
        }
        Some(Self {
            of: "block",
            level: counted.level,
            bins_per_px,
            origin: low,
            counts,
            units,
            newest: Some(bin(last)),
            bits: Some(entropy::vector_bits(vectors.iter().copied()) / vectors.len() as f64),
            is_rounded: vectors.iter().flatten().any(|c| (c * bins_per_px as f32).fract() != 0.0),
        })
    }

    /// The histogram of the known displacements of a field's pixels.
    pub fn of_pixels(flow: &Flow) -> Option<Self> {
        let known = flow.0.cells().iter().filter(|vector| vector[0].is_finite());
        let vectors: Vec<[f32; 2]> = known.map(|vector| vector.map(|c| c.clamp(-FARTHEST, FARTHEST))).collect();
        let counted = Self::in_bins(Counted::default(), &vectors, 1)?;
        Some(Self { of: "pixel", units: counted.units.map(|_| None), newest: None, bits: None, ..counted })
    }

    /// Displacement at the centre of a bin in px.
    pub fn displacement(&self, bin: [i32; 2]) -> [f32; 2] {
        bin.map(|c| c as f32 / self.bins_per_px as f32)
    }

    /// Sum of all counts.
    pub fn total(&self) -> u32 {
        self.counts.cells().iter().sum()
    }

    /// Number of bins that are not empty.
    pub fn distinct(&self) -> usize {
        self.counts.cells().iter().filter(|&&count| count > 0).count()
    }

    /// The bins that are not empty with their counts, in descending order, ties in raster order.
    pub fn fullest(&self) -> Vec<([i32; 2], u32)> {
        let width = self.counts.width();
        let place = |i: usize| [self.origin[0] + (i % width) as i32, self.origin[1] + (i / width) as i32];
        let cells = self.counts.cells().iter().enumerate().filter(|(_, count)| **count > 0);
        let mut bins: Vec<_> = cells.map(|(i, &count)| (place(i), count)).collect();
        bins.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        bins
    }

    /// Column and row of a bin, if it lies within the histogram.
    pub fn cell(&self, at: [i32; 2]) -> Option<(usize, usize)> {
        let [x, y] = [0, 1].map(|i| usize::try_from(at[i] - self.origin[i]).ok());
        let cell = (x?, y?);
        self.counts.get(cell.0, cell.1).map(|_| cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_displacement_is_counted_once_in_its_bin() {
        let vectors = [[0.0, 0.0], [3.0, -1.0], [0.0, 0.0], [2.7, -1.25], [-5.0, 7.0]];
        let histogram =
            Histogram::of(Counted { first_unit: 10, level: None }, &vectors, true).expect("there are vectors");
        assert_eq!((histogram.origin, histogram.counts.size()), ([-5, -2], (9, 10)));
        assert_eq!(histogram.total(), 5);
        assert_eq!(histogram.fullest(), [([3, -1], 2), ([0, 0], 2), ([-5, 7], 1)]);
        assert_eq!((histogram.newest, histogram.is_rounded), (Some([-5, 7]), true));
        let unit = |at| histogram.units[histogram.cell(at).expect("a bin")];
        assert_eq!([unit([0, 0]), unit([3, -1]), unit([1, 1])], [Some(10), Some(11), None]);
        assert_eq!(histogram.cell([4, 0]), None);
        // Two of one kind and three of their own, the rounded ones apart: 2/5·log₂(5/2) + 3/5·log₂5.
        let bits = histogram.bits.expect("of blocks");
        assert!((bits - 1.921_928).abs() < 1e-5, "{bits}");
    }

    #[test]
    fn fractions_of_a_search_have_bins_of_their_own() {
        let bins = |vectors: &[[f32; 2]]| {
            let histogram = Histogram::of(Counted::default(), vectors, true).expect("there are vectors");
            let fullest: Vec<_> = histogram.fullest().into_iter().map(|(bin, _)| histogram.displacement(bin)).collect();
            (histogram.bins_per_px, fullest, histogram.is_rounded)
        };
        let quarters = [[0.5, 0.25], [0.5, 0.25], [1.0, 0.0]];
        assert_eq!(bins(&quarters), (4, vec![[0.5, 0.25], [1.0, 0.0]], false));
        assert_eq!(bins(&[[0.5, 0.0], [1.0, 0.0], [0.5, 0.0]]), (2, vec![[0.5, 0.0], [1.0, 0.0]], false));
        assert_eq!(bins(&[[0.3, 0.0]]), (1, vec![[0.0, 0.0]], true), "minima of parabolas lie anywhere");
    }

    #[test]
    fn pixels_are_counted_where_their_motion_is_known() {
        let flow = Flow(Grid::from_fn(4, 3, |x, y| match (x, y) {
            (0, 0) => Flow::UNKNOWN,
            (1, 0) => [900.0, 0.0],
            _ => [1.25, -0.5],
        }));
        let histogram = Histogram::of_pixels(&flow).expect("there are some");
        assert_eq!(histogram.fullest(), [([1, -1], 10), ([64, 0], 1)]);
        assert!(histogram.units.cells().iter().all(Option::is_none));
        assert_eq!(Histogram::of_pixels(&Flow(Grid::new(2, 2, Flow::UNKNOWN))), None);
    }

    #[test]
    fn there_is_none_of_nothing() {
        assert_eq!(Histogram::of(Counted::default(), &[], false), None);
        let one = Histogram::of(Counted::default(), &[[1.0, 0.0]], false).expect("there is one");
        assert_eq!((one.counts.size(), one.newest, one.bits, one.is_rounded), ((5, 5), None, Some(0.0), false));
    }
}
