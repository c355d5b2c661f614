//! The products of a template with all places of an area by Fourier transforms along the rows.
//!
//! A correlation along x is a product of spectra. Those of the rows of the template and of the rows under it are multiplied and added, so
//! that one inverse transform gives a whole row of places. In double precision the sums are off by far less than a half, and rounding
//! makes them equal to those of the direct way.

use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex, num_complex::Complex};

use crate::base::wide::widest;
use crate::geometry::Gray;

/// Frequencies side by side: as many as registers hold at once.
const LANES: usize = 8;
/// The real and the imaginary parts of as many frequencies.
type Lanes = [[f64; LANES]; 2];
/// Rows of places that share the rows that are read.
const BELOW: usize = 4;

/// The transforms of rows of one length.
struct Plan {
    length: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Plan {
    fn new(least: usize) -> Self {
        let length = fast_length(least);
        let mut planner = RealFftPlanner::new();
        Self { length, forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
    }

    /// Groups of frequencies of a row.
    fn groups(&self) -> usize {
        (self.length / 2 + 1).div_ceil(LANES)
    }

    /// The spectra of the rows of a picture, group by group, with rows of zeros before and after them.
    fn spectra(&self, picture: &Gray, [before, after]: [usize; 2]) -> Spectra {
        let rows = before + picture.height() + after;
        let mut lanes = vec![[[0.0; LANES]; 2]; self.groups() * rows];
        let (mut row, mut spectrum) = (self.forward.make_input_vec(), self.forward.make_output_vec());
        let mut scratch = self.forward.make_scratch_vec();
        for y in 0..picture.height() {
            let (pixels, rest) = row.split_at_mut(picture.width());
            pixels.iter_mut().zip(picture.row(y)).for_each(|(value, &pixel)| *value = pixel.into());
            // The transform leaves its own numbers there.
            rest.fill(0.0);
            // Lengths are those of the plan.
            self.forward.process_with_scratch(&mut row, &mut spectrum, &mut scratch).ok();
            for (group, values) in spectrum.chunks(LANES).enumerate() {
                let [re, im] = &mut lanes[group * rows + before + y];
                for ((re, im), value) in re.iter_mut().zip(im).zip(values) {
                    (*re, *im) = (value.re, value.im);
                }
            }
        }
        Spectra { rows, lanes }
    }
}

/// The spectra of rows: by group of frequencies, then by row.
struct Spectra {
    rows: usize,
    lanes: Vec<Lanes>,
}

impl Spectra {
    /// A group of frequencies of all rows.
    fn group(&self, group: usize) -> &[Lanes] {
        &self.lanes[group * self.rows..][..self.rows]
    }
}

/// Σ a·b of a template with the pixels under it, row by row, for all places at which it lies inside an area.
pub struct Products {
    plan: Plan,
    template: Spectra,
    area: Spectra,
    /// Rows of the template, and rows before and after it.
    reach: usize,
    /// The spectra of the current rows of places.
    spectra: [Vec<Complex<f64>>; BELOW],
    row: Vec<f64>,
    scratch: Vec<Complex<f64>>,
}

impl Products {
    /// Transforms the rows of a template and of an area.
    pub fn of(template: &Gray, area: &Gray) -> Self {
        let (plan, margin) = (Plan::new(area.width()), BELOW - 1);
        Self {
            template: plan.spectra(template, [margin; 2]),
            area: plan.spectra(area, [0, margin]),
            reach: template.height() + margin,
            spectra: [(); BELOW].map(|()| vec![Complex::default(); plan.groups() * LANES]),
            row: plan.inverse.make_output_vec(),
            scratch: plan.inverse.make_scratch_vec(),
            plan,
        }
    }

    /// Sets `sums` to those of row `j` of places; the rows are asked for in their order.
    pub fn take_row(&mut self, j: usize, sums: &mut [u32]) {
        if j.is_multiple_of(BELOW) {
            self.multiply_from(j);
        }
        let Self { plan, spectra, row, scratch, .. } = self;
        let spectrum = &mut spectra[j % BELOW][..plan.length / 2 + 1];
        // Real in theory; the transform would reject imaginary parts left by rounding.
        spectrum[0].im = 0.0;
        spectrum[plan.length / 2].im = 0.0;
        plan.inverse.process_with_scratch(spectrum, row, scratch).ok();
        let scale = 1.0 / plan.length as f64;
        sums.iter_mut().zip(row).for_each(|(sum, value)| *sum = (*value * scale + 0.5) as u32);
    }

    /// Computes the spectra of the rows of places from row `j` on.
    fn multiply_from(&mut self, j: usize) {
        for group in 0..self.plan.groups() {
            let under = &self.area.group(group)[j..][..self.reach];
            let mut totals = [[[0.0; LANES]; 2]; BELOW];
            multiply(self.template.group(group), under, &mut totals);
            for (spectrum, [re, im]) in self.spectra.iter_mut().zip(&totals) {
                for (k, value) in spectrum[group * LANES..][..LANES].iter_mut().enumerate() {
                    *value = Complex { re: re[k], im: im[k] };
                }
            }
        }
    }
}

widest!(fn multiply(template: &[Lanes], area: &[Lanes], totals: &mut [Lanes; BELOW]) = multiply_rows);

/// Adds the products of the rows of an area with the conjugates of those of the template, for places below each other.
#[inline(always)]
fn multiply_rows(template: &[Lanes], area: &[Lanes], totals: &mut [Lanes; BELOW]) {
    let mut sums = *totals;
    for (of_template, [re, im]) in template.array_windows::<BELOW>().zip(area) {
        for (sums, [a, b]) in sums.iter_mut().zip(of_template.iter().rev()) {
            for k in 0..LANES {
                sums[0][k] += re[k] * a[k] + im[k] * b[k];
                sums[1][k] += im[k] * a[k] - re[k] * b[k];
            }
        }
    }
    *totals = sums;
}

/// The smallest even length of at least `least` that is a product of small primes, for which transforms are fast.
fn fast_length(least: usize) -> usize {
    let is_smooth = |mut length: usize| {
        for prime in [2, 3, 5] {
            while length.is_multiple_of(prime) {
                length /= prime;
            }
        }
        length == 1
    };
    (least.max(2)..).find(|length| length.is_multiple_of(2) && is_smooth(*length)).unwrap_or(least)
}

/// Memory of the spectra for areas of this size, in bytes.
pub fn bytes((width, height): (usize, usize)) -> usize {
    size_of::<Lanes>() / LANES * (fast_length(width) / 2 + LANES) * (2 * height + 4 * BELOW)
}
