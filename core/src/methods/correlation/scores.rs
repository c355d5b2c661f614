//! The scores of template matching, from sums of whole numbers.

use super::fourier;
use crate::base::wide::widest;
use crate::choices;
use crate::geometry::{Border, Gray, Grid};
use crate::methods::cost::{self, Cut, products::Products, windows};

choices! {
    /// Score of a template at a place.
    pub enum Score {
        /// Sum of squared differences, Σ (T − I)². The minimum is the match. It changes with brightness and contrast.
        Ssd = "ssd" "SSD",
        /// Sum of absolute differences, Σ |T − I|. Single large differences weigh less than in SSD.
        Sad = "sad" "SAD",
        /// Normalised cross-correlation, Σ T I / √(Σ T² Σ I²). The maximum is the match. Contrast does not matter, brightness does.
        Ncc = "ncc" "NCC",
        /// Zero-mean normalised cross-correlation: the mean of each window is subtracted first. Neither brightness nor contrast matters.
        Zncc = "zncc" "ZNCC",
    }
}

/// Computation of the sums over all places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// The sum over the template at each place: effort grows with the area of the template.
    Direct,
    /// Products of spectra: effort grows with the height of the template only.
    Fourier,
}

/// The largest side of a template in px: sums of squares over it fit into 32 bits.
pub const MOST_PX: usize = 256;

impl Score {
    /// Whether larger is better.
    pub fn is_similarity(self) -> bool {
        matches!(self, Self::Ncc | Self::Zncc)
    }

    /// The name of the cost that is minimised.
    pub fn cost_name(self) -> &'static str {
        match self {
            Self::Ssd => "SSD",
            Self::Sad => "SAD",
            Self::Ncc => "1 − NCC",
            Self::Zncc => "1 − ZNCC",
        }
    }

    /// The score whose cost is `cost`.
    pub fn of_cost(self, cost: f64) -> f64 {
        if self.is_similarity() { 1.0 - cost } else { cost }
    }
}

/// Sums over a template and over the pixels under it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of pixels.
    pub count: f64,
    /// Σ a and Σ b.
    pub sums: [f64; 2],
    /// Σ a² and Σ b².
    pub squares: [f64; 2],
    /// Σ a·b.
    pub product: f64,
}

impl Moments {
    /// The sums over two pictures of one size.
    pub fn of(a: &Gray, b: &Gray) -> Self {
        let pairs = a.cells().iter().zip(b.cells()).map(|(&a, &b)| [u64::from(a), u64::from(b)]);
        let add = |sums: [u64; 5], [a, b]: [u64; 2]| {
            let terms = [a, b, a * a, b * b, a * b];
            [0, 1, 2, 3, 4].map(|i| sums[i] + terms[i])
        };
        let [a_sum, b_sum, aa, bb, ab] = pairs.fold([0; 5], add).map(|sum| sum as f64);
        Self { count: a.cells().len() as f64, sums: [a_sum, b_sum], squares: [aa, bb], product: ab }
    }

    /// The means of both.
    pub fn means(&self) -> [f64; 2] {
        self.sums.map(|sum| sum / self.count)
    }

    /// N² · the variance of each.
    #[inline(always)]
    fn variances(&self) -> [f64; 2] {
        [0, 1].map(|i| self.count * self.squares[i] - self.sums[i] * self.sums[i])
    }

    /// The standard deviations of both.
    pub fn deviations(&self) -> [f64; 2] {
        self.variances().map(|variance| variance.sqrt() / self.count)
    }

    /// The covariance.
    pub fn covariance(&self) -> f64 {
        (self.count * self.product - self.sums[0] * self.sums[1]) / (self.count * self.count)
    }

    /// One minus the zero-mean normalised cross-correlation; 1 where a window has no texture.
    #[inline(always)]
    pub fn zero_mean_cost(&self) -> f64 {
        let both = self.count * self.product - self.sums[0] * self.sums[1];
        one_minus(both, self.variances())
    }

    /// One minus the normalised cross-correlation; 1 where a window is black.
    #[inline(always)]
    pub fn cost(&self) -> f64 {
        one_minus(self.product, self.squares)
    }

    /// The sum of squared differences.
    #[inline(always)]
    pub fn squared_differences(&self) -> f64 {
        self.squares[0] + self.squares[1] - 2.0 * self.product
    }
}

#[inline(always)]
fn one_minus(both: f64, [a, b]: [f64; 2]) -> f64 {
    if a > 0.0 && b > 0.0 { 1.0 - both / (a * b).sqrt() } else { 1.0 }
}

/// The faster way for a template of this size at this many columns and rows of places.
pub fn faster(score: Score, (width, height): (usize, usize), (columns, rows): (usize, usize)) -> Evaluation {
    let [width, height, columns, rows] = [width, height, columns, rows].map(|c| c as f64);
    let (reach, down) = (columns + width, rows + height);
    // Measured throughput of both ways: pixels compared in a nanosecond, and pixels of spectra.
    let direct = columns * rows * width * height / 60.0;
    let spectra = reach * (0.02 * rows * height + 3.0 * (down + rows + height));
    if score == Score::Sad || direct <= spectra { Evaluation::Direct } else { Evaluation::Fourier }
}

/// The costs of `template` at all places at which it lies inside `area`.
pub fn map(score: Score, way: Evaluation, template: &Gray, area: &Gray) -> Grid<f64> {
    let size = (area.width() + 1 - template.width(), area.height() + 1 - template.height());
    let [block, under] = [template, area].map(|picture| {
        let mut cut = Cut::default();
        cut.take(picture, (0, 0), picture.size(), Border::Replicate);
        cut
    });
    if score == Score::Sad {
        let mut costs = Vec::new();
        cost::window(&block, &under, size, &mut costs);
        let mut costs = costs.into_iter().map(f64::from);
        return Grid::from_fn(size.0, size.1, |_, _| costs.next().unwrap_or(f64::INFINITY));
    }
    let mut products = match way {
        Evaluation::Fourier => Sums::Fourier(fourier::Products::of(template, area), vec![0; size.0]),
        Evaluation::Direct => {
            let mut products = Products::default();
            products.compute(&block, &under, size);
            Sums::Direct(products)
        }
    };
    let boxes = windows::Boxes { block: template.size(), size };
    let mut all_squares = windows::Sliding::<true>::new(&under, boxes, Vec::new());
    let mut all_sums = (score == Score::Zncc).then(|| windows::Sliding::<false>::new(&under, boxes, Vec::new()));
    let own = Moments::of(template, template);
    let [mut sums, mut squares] = [(); 2].map(|()| vec![0; size.0]);
    let mut costs = Grid::new(size.0, size.1, 0.0);
    for j in 0..size.1 {
        squares.fill(0);
        all_squares.add_row(&mut squares);
        if let Some(all_sums) = &mut all_sums {
            sums.fill(0);
            all_sums.add_row(&mut sums);
        }
        let row = Row { own, sums: &sums, squares: &squares, products: products.row(j) };
        match score {
            Score::Ssd => squared_differences(&row, costs.row_mut(j)),
            Score::Ncc => correlations(&row, costs.row_mut(j)),
            _ => zero_mean_correlations(&row, costs.row_mut(j)),
        }
    }
    costs
}

/// Σ a·b of all places, row by row.
enum Sums {
    Direct(Products),
    /// With room for a row.
    Fourier(fourier::Products, Vec<u32>),
}

impl Sums {
    fn row(&mut self, j: usize) -> &[u32] {
        match self {
            Self::Direct(products) => products.row(j),
            Self::Fourier(products, row) => {
                products.take_row(j, row);
                row
            }
        }
    }
}

/// The sums of a row of places.
struct Row<'a> {
    /// The moments of the template alone.
    own: Moments,
    /// By place: Σ b (which only the zero-mean score needs), Σ b² and Σ a·b.
    sums: &'a [u32],
    squares: &'a [u32],
    products: &'a [u32],
}

widest!(fn squared_differences(row: &Row<'_>, costs: &mut [f64]) = squared_differences_of);
widest!(fn correlations(row: &Row<'_>, costs: &mut [f64]) = correlations_of);
widest!(fn zero_mean_correlations(row: &Row<'_>, costs: &mut [f64]) = zero_mean_correlations_of);

#[inline(always)]
fn squared_differences_of(row: &Row<'_>, costs: &mut [f64]) {
    each(row, costs, |moments| moments.squared_differences());
}

#[inline(always)]
fn correlations_of(row: &Row<'_>, costs: &mut [f64]) {
    each(row, costs, |moments| moments.cost());
}

#[inline(always)]
fn zero_mean_correlations_of(row: &Row<'_>, costs: &mut [f64]) {
    each(row, costs, |moments| moments.zero_mean_cost());
}

#[inline(always)]
fn each(row: &Row<'_>, costs: &mut [f64], cost: impl Fn(Moments) -> f64) {
    let Moments { count, sums: [a, _], squares: [aa, _], .. } = row.own;
    for (((value, &sum), &squares), &product) in costs.iter_mut().zip(row.sums).zip(row.squares).zip(row.products) {
        let [b, bb, product] = [sum, squares, product].map(f64::from);
        *value = cost(Moments { count, sums: [a, b], squares: [aa, bb], product });
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn both_ways_agree_bit_by_bit(
            (width, height) in (1usize..70, 1usize..40), (columns, rows) in (1usize..60, 1usize..30), seed in any::<u32>(),
        ) {
            let noise = |x: usize, y: usize| {
                let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
                (h.wrapping_mul(0xC2B2_AE35) >> 24) as u8
            };
            let area = Grid::from_fn(width + columns - 1, height + rows - 1, noise);
            let template = Grid::from_fn(width, height, |x, y| noise(x + 90, y));
            for score in [Score::Ssd, Score::Sad, Score::Ncc, Score::Zncc] {
                let [direct, spectra] = [Evaluation::Direct, Evaluation::Fourier].map(|way| map(score, way, &template, &area));
                prop_assert_eq!(direct, spectra);
            }
        }
    }

    #[test]
    fn the_largest_sums_are_exact() {
        let (template, area) = (Grid::new(MOST_PX, MOST_PX, 255), Grid::new(MOST_PX + 3, MOST_PX + 2, 255));
        for way in [Evaluation::Direct, Evaluation::Fourier] {
            assert_eq!(map(Score::Ssd, way, &template, &area), Grid::new(4, 3, 0.0));
            assert_eq!(map(Score::Ncc, way, &template, &area), Grid::new(4, 3, 0.0));
            assert_eq!(map(Score::Zncc, way, &template, &area), Grid::new(4, 3, 1.0), "without texture");
        }
    }
}
