//! The descriptor of a keypoint: 4 × 4 histograms of 8 gradient directions each, relative to its orientation.

use std::f32::consts::TAU;

use super::angle;
use crate::base::LANES;
use crate::base::wide::widest;
use crate::geometry::Grid;

/// Cells along a side of the descriptor's window.
pub const SIDE: usize = 4;
/// Number of cells.
pub const CELLS: usize = SIDE * SIDE;
/// Directions of the histogram of each cell.
pub const BINS: usize = 8;
/// Largest entry of a normalised descriptor, before it is normalised again.
pub const CLAMP: f32 = 0.2;

/// Side of a cell in standard deviations of the keypoint.
const CELL_SIGMAS: f32 = 3.0;

/// Position, scale and orientation of a keypoint in a Gaussian image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position in px of the octave.
    pub at: [f32; 2],
    /// Standard deviation in px of the octave.
    pub sigma_px: f32,
    /// Orientation in radians from x towards y.
    pub angle_rad: f32,
}

impl Place {
    /// Side of a cell in px.
    pub fn cell_px(&self) -> f32 {
        CELL_SIGMAS * self.sigma_px
    }

    /// The position of a point of the window given in cells from its centre.
    pub fn at_cells(&self, [c, r]: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = self.angle_rad.sin_cos();
        let cell = self.cell_px();
        [self.at[0] + cell * (c * cos - r * sin), self.at[1] + cell * (c * sin + r * cos)]
    }
}

/// The histograms of all cells, cell by cell in rows, before normalisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptor(pub [f32; CELLS * BINS]);

/// Cells with one more on each side, into which samples at the border are interpolated.
const PADDED: usize = SIDE + 2;
/// Entries of a padded cell, as wide as a register: the directions, and two more, which are the first two again.
const WRAPPED: usize = 16;
/// The histograms of the padded cells.
type Sums = [[f32; WRAPPED]; PADDED * PADDED];

impl Descriptor {
    /// The histograms around a keypoint in a Gaussian image. Each sample is distributed over the two nearest cells in both
    /// directions and the two nearest bins.
    pub fn around(image: &Grid<f32>, place: &Place) -> Self {
        let mut sums = [[0.0; WRAPPED]; PADDED * PADDED];
        accumulate(image, place, &mut sums);
        let mut cells = [0.0; CELLS * BINS];
        for (i, bins) in cells.chunks_exact_mut(BINS).enumerate() {
            let padded = &sums[(i / SIDE + 1) * PADDED + i % SIDE + 1];
            bins.copy_from_slice(&padded[..BINS]);
            bins.iter_mut().zip(&padded[BINS..BINS + 2]).for_each(|(bin, again)| *bin += again);
        }
        Self(cells)
    }

    /// The same with length 1; zero if it is zero.
    #[must_use]
    pub fn normalised(&self) -> Self {
        let length = self.0.iter().map(|v| v * v).sum::<f32>().sqrt();
        let factor = if length > 0.0 { 1.0 / length } else { 0.0 };
        Self(self.0.map(|v| v * factor))
    }

    /// A normalised descriptor with all entries limited to [`CLAMP`].
    #[must_use]
    pub fn clamped(&self) -> Self {
        Self(self.0.map(|v| v.min(CLAMP)))
    }

    /// The final descriptor: normalised, clamped, and normalised again.
    #[must_use]
    pub fn finished(&self) -> Self {
        self.normalised().clamped().normalised()
    }
}

widest! {
    fn accumulate(image: &Grid<f32>, place: &Place, sums: &mut Sums) = accumulate_body
}

#[inline(always)]
fn accumulate_body(image: &Grid<f32>, place: &Place, sums: &mut Sums) {
    let (width, height) = image.size();
    let (sin, cos) = place.angle_rad.sin_cos();
    let (scale, [x, y]) = (1.0 / place.cell_px(), place.at);
    // Up to half a cell beyond the window.
    let reach = (SIDE as f32 + 1.0) / 2.0;
    let radius = reach * place.cell_px() * std::f32::consts::SQRT_2;
    let inside = |c: f32, extent: usize| (c.max(1.0) as usize).min(extent.saturating_sub(1));
    let rows = inside((y - radius).ceil(), height)..inside((y + radius).floor() + 1.0, height);
    // The Gaussian has a standard deviation of half the window.
    let across = -0.5 * (scale * 2.0 / SIDE as f32).powi(2);
    let weight = |d: f32| (across * d * d).exp();
    let first = inside((x - radius).ceil(), width);
    let last = inside((x + radius).floor() + 1.0, width);
    // Zeros behind the last entry, because several samples are computed at once.
    let of_columns = (first..last).map(|i| weight(i as f32 - x)).chain([0.0; LANES]);
    let of_columns: Vec<f32> = of_columns.collect();
    for j in rows {
        let dy = j as f32 - y;
        // The part of the row inside the rotated window.
        let (mut from, mut to) = (x - radius, x + radius);
        for (along, offset) in [(cos * scale, sin * scale * dy), (-sin * scale, cos * scale * dy)] {
            if along.abs() > 1e-6 {
                let ends = [(-reach - offset) / along, (reach - offset) / along];
                from = from.max(x + ends[0].min(ends[1]));
                to = to.min(x + ends[0].max(ends[1]));
            } else if offset.abs() >= reach {
                to = from - 1.0;
            }
        }
        let (from, to) = (inside(from.floor() + 1.0, width), inside(to.ceil(), width));
        let (from, to) = (from.max(first), to.min(last));
        if from >= to {
            continue;
        }
        let stretch = Stretch { image, place, row: j, dy, of_row: weight(dy), scale, turn: [sin, cos] };
        for i in (from..to).step_by(LANES) {
            let count = LANES.min(to - i);
            if i + LANES < width {
                distribute(&stretch.samples::<LANES>(i, &of_columns[i - first..]), count, sums);
                continue;
            }
            for i in i..i + count {
                distribute(&stretch.samples::<1>(i, &of_columns[i - first..]), 1, sums);
            }
        }
    }
}

/// A row of the window.
struct Stretch<'a> {
    image: &'a Grid<f32>,
    place: &'a Place,
    row: usize,
    /// Distance of the row from the keypoint in px.
    dy: f32,
    /// The weight of the row.
    of_row: f32,
    /// Cells per px.
    scale: f32,
    /// Sine and cosine of the orientation.
    turn: [f32; 2],
}

/// Offsets of the four cells around a sample from the first of them.
const AROUND: [usize; 4] = [0, 1, PADDED, PADDED + 1];

/// The shares of neighbouring samples of a row in the cells around them.
struct Samples<const N: usize> {
    /// The first of the four cells, and the lower one of the two bins: whole numbers.
    cells: [f32; N],
    bins: [f32; N],
    /// By cell: what its lower and its upper bin get.
    lower: [[f32; N]; 4],
    upper: [[f32; N]; 4],
}

impl Stretch<'_> {
    /// The samples from column `start` on; `weights` are those of their columns. Those outside of the window have no shares.
    #[inline(always)]
    fn samples<const N: usize>(&self, start: usize, weights: &[f32]) -> Samples<N> {
        let Self { image, place, row: j, dy, of_row, scale, turn: [sin, cos] } = *self;
        let (middle, edge) = ((SIDE as f32 + 1.0) / 2.0, SIDE as f32 + 1.0);
        let [above, below] = [j - 1, j + 1].map(|j| &image.row(j)[start..start + N]);
        let [left, right] = [start - 1, start + 1].map(|i| &image.row(j)[i..i + N]);
        let weights = &weights[..N];
        let [mut cells, mut bins] = [[0.0; N]; 2];
        let [mut lower, mut upper] = [[[0.0; N]; 4]; 2];
        for i in 0..N {
            let (gx, gy) = (right[i] - left[i], below[i] - above[i]);
            let magnitude = (gx * gx + gy * gy).sqrt() * of_row * weights[i];
            let turns = (angle(gx, gy) - place.angle_rad) / TAU;
            let b = (turns - turns.floor()) * BINS as f32;
            let dx = start as f32 + i as i32 as f32 - place.at[0];
            let c = (cos * dx + sin * dy) * scale + middle;
            let r = (cos * dy - sin * dx) * scale + middle;
            let is_inside = (c > 0.0) & (c < edge) & (r > 0.0) & (r < edge);
            let m = if is_inside { magnitude } else { 0.0 };
            let (c0, r0, b0) = (c.floor(), r.floor(), b.floor());
            let (c1, r1, b1) = (c - c0, r - r0, b - b0);
            let (down, up) = (m * r1, m - m * r1);
            let [p, q, s, t] = [up - up * c1, up * c1, down - down * c1, down * c1];
            (upper[0][i], upper[1][i], upper[2][i], upper[3][i]) = (p * b1, q * b1, s * b1, t * b1);
            (lower[0][i], lower[1][i]) = (p - p * b1, q - q * b1);
            (lower[2][i], lower[3][i]) = (s - s * b1, t - t * b1);
            cells[i] = if is_inside { r0 * PADDED as f32 + c0 } else { 0.0 };
            bins[i] = b0;
        }
        Samples { cells, bins, lower, upper }
    }
}

/// A single one: from the right place on, the entries of a cell of which one is counted.
const ONE: [f32; 2 * WRAPPED] = {
    let mut entries = [0.0; 2 * WRAPPED];
    entries[WRAPPED] = 1.0;
    entries
};

/// Distributes each of the first samples over the two nearest cells in both directions and the two nearest bins.
///
/// All entries of a cell are added to at once, nearly all of them nothing, and stay in registers as long as neighbouring samples
/// lie in the same cells: entries in memory would wait for the sample before.
#[inline(always)]
fn distribute<const N: usize>(shares: &Samples<N>, count: usize, sums: &mut Sums) {
    /// The last cell that has others right of it and below it.
    const LAST: usize = PADDED * PADDED - PADDED - 2;
    let entries = |bin: usize| ONE.get(WRAPPED.wrapping_sub(bin)..)?.first_chunk::<WRAPPED>();
    let mut first = (shares.cells[0] as usize).min(LAST);
    let mut near = AROUND.map(|offset| sums[first + offset]);
    for i in 0..count.min(N) {
        let (cell, bin) = ((shares.cells[i] as usize).min(LAST), shares.bins[i] as usize);
        let (Some(at_lower), Some(at_upper)) = (entries(bin), entries(bin + 1)) else { continue };
        if cell != first {
            AROUND.iter().zip(&near).for_each(|(offset, near)| sums[first + offset] = *near);
            first = cell;
            near = AROUND.map(|offset| sums[first + offset]);
        }
        for (near, (lower, upper)) in near.iter_mut().zip(shares.lower.iter().zip(&shares.upper)) {
            let (lower, upper) = (lower[i], upper[i]);
            for (sum, (at_lower, at_upper)) in near.iter_mut().zip(at_lower.iter().zip(at_upper)) {
                *sum += at_lower * lower + at_upper * upper;
            }
        }
    }
    AROUND.iter().zip(&near).for_each(|(offset, near)| sums[first + offset] = *near);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(x: f32, y: f32) -> f32 {
        60.0 * ((x / 5.0).sin() + (y / 7.0 + x / 11.0).cos()) + 0.6 * x
    }

    /// The descriptor from its definition: every pixel of the picture, distributed over all cells and bins by the overlap.
    fn plain(image: &Grid<f32>, place: &Place) -> Vec<f64> {
        let mut cells = vec![0.0; CELLS * BINS];
        let (sin, cos) = f64::from(place.angle_rad).sin_cos();
        let cell = f64::from(place.cell_px());
        for (x, y) in (1..image.height() - 1).flat_map(|y| (1..image.width() - 1).map(move |x| (x, y))) {
            let [dx, dy] = [x as f64 - f64::from(place.at[0]), y as f64 - f64::from(place.at[1])];
            let (c, r) = ((cos * dx + sin * dy) / cell, (cos * dy - sin * dx) / cell);
            if c.abs() >= 2.5 || r.abs() >= 2.5 {
                continue;
            }
            let gx = f64::from(image[(x + 1, y)] - image[(x - 1, y)]);
            let gy = f64::from(image[(x, y + 1)] - image[(x, y - 1)]);
            let weight = gx.hypot(gy) * (-(c * c + r * r) / 8.0).exp();
            let direction = (gy.atan2(gx) - f64::from(place.angle_rad)).rem_euclid(std::f64::consts::TAU);
            let bin = direction / std::f64::consts::TAU * 8.0;
            for (i, entry) in cells.iter_mut().enumerate() {
                let middle = |k: usize| k as f64 - 1.5;
                let near = |distance: f64| (1.0 - distance.abs()).max(0.0);
                let turn = (bin - (i % 8) as f64 + 4.0).rem_euclid(8.0) - 4.0;
                *entry += weight * near(c - middle(i / 8 % 4)) * near(r - middle(i / 32)) * near(turn);
            }
        }
        cells
    }

    #[test]
    fn histograms_are_those_of_the_definition() {
        let image = Grid::from_fn(80, 70, |x, y| texture(x as f32, y as f32));
        for (at, sigma_px, angle_rad) in
            [([40.0, 35.0], 2.0, 0.0), ([41.3, 33.7], 2.4, 0.7), ([10.2, 12.9], 3.0, 2.9), ([70.0, 60.5], 1.8, 5.5)]
        {
            let place = Place { at, sigma_px, angle_rad };
            let (found, plain) = (Descriptor::around(&image, &place), plain(&image, &place));
            let most = plain.iter().copied().fold(0.0, f64::max);
            for (i, (found, plain)) in found.0.iter().zip(&plain).enumerate() {
                assert!((f64::from(*found) - plain).abs() < 1e-3 * most, "{place:?}, {i}: {found} instead of {plain}");
            }
        }
    }

    #[test]
    fn a_descriptor_turns_with_the_picture() {
        let image = Grid::from_fn(81, 81, |x, y| texture(x as f32, y as f32));
        // A quarter turn maps (x, y) to (80 − y, x).
        let turned = Grid::from_fn(81, 81, |x, y| image[(y, 80 - x)]);
        let place = Place { at: [38.0, 44.0], sigma_px: 2.2, angle_rad: 0.4 };
        let after = Place { at: [80.0 - 44.0, 38.0], angle_rad: 0.4 + std::f32::consts::FRAC_PI_2, ..place };
        let [a, b] = [Descriptor::around(&image, &place), Descriptor::around(&turned, &after)].map(|d| d.finished());
        let off = a.0.iter().zip(&b.0).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{off}");
    }

    #[test]
    fn contrast_does_not_change_a_descriptor_and_no_gradient_gives_zero() {
        let image = Grid::from_fn(60, 60, |x, y| texture(x as f32, y as f32));
        let place = Place { at: [30.0, 30.0], sigma_px: 2.0, angle_rad: 1.0 };
        let finished = Descriptor::around(&image, &place).finished();
        let brighter = Descriptor::around(&image.map(|v| 2.0 * v + 30.0), &place).finished();
        assert!(finished.0.iter().zip(&brighter.0).all(|(a, b)| (a - b).abs() < 1e-5));
        let length: f32 = finished.0.iter().map(|v| v * v).sum();
        assert!((length - 1.0).abs() < 1e-5, "{length}");
        assert_eq!(Descriptor::around(&Grid::new(60, 60, 7.0), &place).finished().0, [0.0; 128]);
    }
}
