//! The Bhattacharyya coefficient of many ellipses, each from few of its pixels.

use crate::base::effort;
use crate::methods::region::color::{Bins, Histogram};
use crate::products::Region;

/// Places in the unit circle, along x and along y, as dense everywhere as the Epanechnikov kernel is high: a histogram of them counts each alike.
#[derive(Clone, Debug)]
pub struct Pattern([Vec<f32>; 2]);

impl Pattern {
    /// A pattern of `count` places on a spiral by the golden angle (Vogel 1979).
    pub fn new(count: usize) -> Self {
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let place = |i: usize| {
            // Inside r lies the share 2 r² − r⁴ of the kernel.
            let share = (i as f64 + 0.5) / count as f64;
            let radius = (1.0 - (1.0 - share).sqrt()).sqrt();
            let (sin, cos) = (i as f64 * golden).sin_cos();
            [(radius * cos) as f32, (radius * sin) as f32]
        };
        Self([0, 1].map(|axis| (0..count).map(|i| place(i)[axis]).collect()))
    }

    fn len(&self) -> usize {
        self.0[0].len()
    }
}

/// The comparison of ellipses with the histogram of an object.
#[derive(Clone, Debug)]
pub struct Likelihood {
    pattern: Pattern,
    /// √q of each bin.
    roots: Vec<f32>,
    /// √(c + 1) − √c for the number c of pixels in a bin, divided by the root of the number of all.
    steps: Vec<f32>,
}

impl Likelihood {
    /// Compares with `model` at the places of `pattern`.
    pub fn new(model: &Histogram, pattern: Pattern) -> Self {
        let count = pattern.len();
        let step = |c: usize| (((c + 1) as f64).sqrt() - (c as f64).sqrt()) / (count as f64).sqrt();
        let roots = model.shares.iter().map(|share| share.sqrt()).collect();
        Self { pattern, roots, steps: (0..count).map(|c| step(c) as f32).collect() }
    }

    /// Begins the comparison of ellipses in a frame, whose pixels are covered by `bins`.
    pub fn meter<'a>(&'a self, bins: &'a Bins<'a>) -> Meter<'a> {
        let count = self.pattern.len();
        let lane = || Lane {
            counts: vec![0; self.roots.len()],
            positions: vec![0; count],
            seen: vec![0; count],
            found: 0,
            sum: 0.0,
        };
        Meter { of: self, bins, lanes: [lane(), lane()] }
    }
}

/// The comparison in a frame, of two ellipses at once: each waits for its last count and sum, while the other goes on.
pub struct Meter<'a> {
    of: &'a Likelihood,
    bins: &'a Bins<'a>,
    lanes: [Lane; 2],
}

/// The count for one ellipse.
struct Lane {
    /// Number of pixels in each bin; 0 between ellipses.
    counts: Vec<u8>,
    /// The pixels of the current ellipse.
    positions: Vec<u32>,
    /// Their bins, as many as are found.
    seen: Vec<u16>,
    found: usize,
    /// The coefficient of those found.
    sum: f32,
}

impl Lane {
    /// Counts the next pixel; outside the picture it has no bin.
    #[inline(always)]
    fn count(&mut self, place: usize, cells: &[u16], Likelihood { roots, steps, .. }: &Likelihood) {
        let Some(&bin) = cells.get(self.positions[place] as usize) else { return };
        let pixels = &mut self.counts[usize::from(bin)];
        // Adding the difference from √c to √(c + 1) saves a pass over the bins.
        self.sum += roots[usize::from(bin)] * steps[usize::from(*pixels)];
        *pixels += 1;
        self.seen[self.found] = bin;
        self.found += 1;
    }

    /// Returns the coefficient of the finished ellipse.
    fn end(&mut self) -> f32 {
        let found = std::mem::take(&mut self.found);
        self.seen[..found].iter().for_each(|bin| self.counts[usize::from(*bin)] = 0);
        std::mem::take(&mut self.sum)
    }
}

impl Meter<'_> {
    /// The coefficients Σ √(p q) of two ellipses.
    pub fn coefficients(&mut self, regions: [Region; 2]) -> [f32; 2] {
        let (pattern, cells, places) = (&self.of.pattern, self.bins.cells(), self.of.pattern.len());
        effort::add(2 * places);
        let [first, second] = &mut self.lanes;
        for (lane, region) in [&mut *first, &mut *second].into_iter().zip(regions) {
            self.bins.find(region, pattern.0.each_ref().map(Vec::as_slice), &mut lane.positions);
        }
        for place in 0..places {
            first.count(place, cells, self.of);
            second.count(place, cells, self.of);
        }
        [first.end(), second.end()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Frame;
    use crate::geometry::Grid;
    use crate::methods::region::color::Binning;

    #[test]
    fn a_pattern_is_as_dense_as_the_kernel() {
        let pattern = Pattern::new(250);
        let [xs, ys] = &pattern.0;
        let mean = xs.iter().zip(ys).map(|(x, y)| f64::from(x * x + y * y)).sum::<f64>() / 250.0;
        // ∫ r² (1 − r²) r dr / ∫ (1 − r²) r dr = (1/12) / (1/4).
        assert!((mean - 1.0 / 3.0).abs() < 1e-3, "{mean}");
        let middle = [xs, ys].map(|along| along.iter().map(|c| f64::from(*c)).sum::<f64>() / 250.0);
        assert!(middle.iter().all(|c| c.abs() < 0.01), "{middle:?}");
    }

    #[test]
    fn a_coefficient_is_that_of_the_counted_histogram() {
        let frame = Frame::gray(Grid::from_fn(50, 40, |x, y| ((x * 5 + y * 3) % 256) as u8));
        let region = Region { center: [24.3, 18.6], size: [18.0, 14.0], angle_rad: 0.0 };
        let binning = Binning::Gray(16);
        let model = Histogram::of_ellipse(&frame, binning, region.at([20.0, 20.0]));
        let likelihood = Likelihood::new(&model, Pattern::new(64));
        let mut bins = Bins::new(&frame, binning);
        bins.cover(region.bounds());
        let mut meter = likelihood.meter(&bins);
        let mut counts = [0.0f64; 16];
        let [us, vs] = &likelihood.pattern.0;
        for (u, v) in us.iter().zip(vs) {
            let (x, y) = (24.3 + u * 9.0, 18.6 + v * 7.0);
            counts[usize::from(frame.luma()[(x.round() as usize, y.round() as usize)]) / 16] += 1.0 / 64.0;
        }
        let expected: f64 = counts.iter().zip(&model.shares).map(|(p, q)| (p * f64::from(*q)).sqrt()).sum();
        let other = region.at([20.0, 20.0]);
        let [_, alone] = meter.coefficients([other, other]);
        for (regions, lane) in [([region, other], 0), ([other, region], 1), ([region, region], 1)] {
            let found = meter.coefficients(regions);
            assert!((f64::from(found[lane]) - expected).abs() < 1e-5, "the counts are those of one ellipse: {found:?}");
            assert!(
                regions[1 - lane] == region || found[1 - lane] == alone,
                "bit for bit, whatever is beside it: {found:?}"
            );
        }
    }
}
