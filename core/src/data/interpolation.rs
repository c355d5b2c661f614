//! Interpolation of gray values at sub-pixel positions.

use crate::choices;
use crate::geometry::{Border, Gray};

choices! {
    /// Interpolation of gray values at sub-pixel positions.
    pub enum Interpolation {
        /// Weighted mean of the four nearest pixels.
        Bilinear = "bilinear" "Bilinear",
        /// Interpolation of H.264: half pixels with the six-tap filter (1, −5, 20, 20, −5, 1) / 32, quarters as the mean of two
        /// neighbours.
        SixTap = "six-tap" "H.264 six-tap",
    }
}

/// The weights of the six pixels around a half pixel, in 32nds (ITU-T H.264, 8.4.2.2.1).
const TAPS: [i32; 6] = [1, -5, 20, 20, -5, 1];
/// How many pixels the filter reaches beyond the one before and the one after it.
const REACH: usize = 2;

impl Interpolation {
    /// The gray value at `(x, y)` quarters of a pixel.
    ///
    /// # Panics
    /// If the picture is empty.
    pub fn at(self, picture: &Gray, [x, y]: [i32; 2], border: Border) -> u8 {
        let pixel = |x: i32, y: i32| i32::from(picture.at(x as isize, y as isize, border));
        let ([x, y], [fx, fy]) = ([x >> 2, y >> 2], [x & 3, y & 3]);
        match self {
            Interpolation::Bilinear => {
                let row = |y| (4 - fx) * pixel(x, y) + fx * pixel(x + 1, y);
                (((4 - fy) * row(y) + fy * row(y + 1) + 8) >> 4) as u8
            }
            Interpolation::SixTap => {
                let [a, b] = quarter([fx, fy]).map(|[i, j]| half(pixel, [2 * x + i, 2 * y + j]));
                ((i32::from(a) + i32::from(b) + 1) >> 1) as u8
            }
        }
    }

    /// The gray value at `(x, y)` px; the six-tap filter knows it at the nearest quarter of a pixel.
    ///
    /// # Panics
    /// If the picture is empty.
    pub fn sample(self, picture: &Gray, [x, y]: [f32; 2], border: Border) -> u8 {
        if self == Interpolation::SixTap {
            return self.at(picture, [x, y].map(|c| (4.0 * c).round() as i32), border);
        }
        let (column, row) = (x.floor(), y.floor());
        let pixel = |i: isize, j: isize| f32::from(picture.at(column as isize + i, row as isize + j, border));
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let line = |j| mix(pixel(0, j), pixel(1, j), x - column);
        (mix(line(0), line(1), y - row) + 0.5) as u8
    }
}

/// The two points, in half pixels, whose mean is the value `[x, y]` quarters after a pixel; twice the same where that
/// is one of them.
fn quarter([x, y]: [i32; 2]) -> [[i32; 2]; 2] {
    match [x & 1, y & 1] {
        // Between the half pixels on the horizontal and on the vertical side next to it.
        [1, 1] => [[1, y / 2 * 2], [x / 2 * 2, 1]],
        _ => [[x / 2, y / 2], [(x + 1) / 2, (y + 1) / 2]],
    }
}

/// The gray value at `[x, y]` half pixels.
fn half(pixel: impl Fn(i32, i32) -> i32, [x, y]: [i32; 2]) -> u8 {
    let across = |x: i32, y: i32| filter(|i| pixel((x >> 1) + i, y));
    let (sum, shift) = match [x & 1, y & 1] {
        [0, 0] => (pixel(x >> 1, y >> 1), 0),
        [1, 0] => (across(x, y >> 1), 5),
        [0, 1] => (filter(|j| pixel(x >> 1, (y >> 1) + j)), 5),
        _ => (filter(|j| across(x, (y >> 1) + j)), 10),
    };
    rounded(sum, shift)
}

/// The weighted sum of the values at −2 to 3.
#[inline(always)]
fn filter(value: impl Fn(i32) -> i32) -> i32 {
    TAPS.iter().zip(-(REACH as i32)..).map(|(tap, i)| tap * value(i)).sum()
}

#[inline(always)]
fn rounded(sum: i32, shift: u32) -> u8 {
    ((sum + ((1 << shift) >> 1)) >> shift).clamp(0, 255) as u8
}

/// A block that is moved by quarters of a pixel, less than one px each way, without filtering anew each time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Between {
    filter: Option<Interpolation>,
    size: (usize, usize),
    /// Whole pixels, those half a pixel to the right, below, and both, from one pixel before the block to one after it.
    halves: [Vec<u8>; 4],
    /// The pixels under all taps, and their sums along the rows.
    pixels: Vec<u8>,
    sums: Vec<i32>,
    /// Their sums down the columns of one row.
    sums_down: Vec<i32>,
    moved: Vec<u8>,
}

impl Between {
    /// Takes the block of `size` px whose first pixel is `(x, y)` of `picture`.
    pub fn take(
        &mut self,
        (picture, border): (&Gray, Border),
        (x, y): (isize, isize),
        size: (usize, usize),
        filter: Interpolation,
    ) {
        (self.filter, self.size) = (Some(filter), size);
        let (width, height) = (size.0 + 2 + 2 * REACH + 1, size.1 + 2 + 2 * REACH + 1);
        let start = (x - 1 - REACH as isize, y - 1 - REACH as isize);
        self.pixels.clear();
        for row in 0..height {
            let source = picture.row(border.index(start.1 + row as isize, picture.height()));
            let columns = (0..width).map(|column| border.index(start.0 + column as isize, source.len()));
            self.pixels.extend(columns.map(|column| source[column]));
        }
        self.interpolate(width);
    }

    /// Fills the planes from the pixels, in rows of `width`.
    fn interpolate(&mut self, width: usize) {
        let Self { pixels, sums, sums_down, halves: [whole, right, below, both], size, filter, .. } = self;
        let (columns, rows) = (size.0 + 2, size.1 + 2);
        let line = |y: usize, x: usize| &pixels[y * width + x..][..columns];
        for plane in [&mut *whole, right, below, both] {
            plane.clear();
        }
        (0..rows).for_each(|y| whole.extend_from_slice(line(y + REACH, REACH)));
        if *filter != Some(Interpolation::SixTap) {
            return;
        }
        sums.clear();
        for y in 0..rows + TAPS.len() - 1 {
            weigh([0, 1, 2, 3, 4, 5].map(|i| line(y, i)), sums);
        }
        let sum_line = |y: usize| &sums[y * columns..][..columns];
        for y in 0..rows {
            right.extend(sum_line(y + REACH).iter().map(|&sum| rounded(sum, 5)));
            sums_down.clear();
            weigh([0, 1, 2, 3, 4, 5].map(|j| line(y + j, REACH)), sums_down);
            below.extend(sums_down.iter().map(|&sum| rounded(sum, 5)));
            sums_down.clear();
            weigh([0, 1, 2, 3, 4, 5].map(|j| sum_line(y + j)), sums_down);
            both.extend(sums_down.iter().map(|&sum| rounded(sum, 10)));
        }
    }

    /// The block moved by `[x, y]` quarters of a pixel, −3 to 3 each: its pixels, and the distance between their rows.
    pub fn moved(&mut self, [x, y]: [i32; 2]) -> (&[u8], usize) {
        debug_assert!(x.abs() < 4 && y.abs() < 4);
        // The planes begin one pixel before the block and end one after it.
        let ((width, height), stride) = (self.size, self.size.0 + 2);
        let (column, row) = ((1 + (x >> 2)) as usize, (1 + (y >> 2)) as usize);
        let fraction = [x & 3, y & 3];
        let Self { halves, moved, filter, .. } = self;
        moved.clear();
        for row in row..row + height {
            if *filter == Some(Interpolation::SixTap) {
                let [a, b] = quarter(fraction).map(|[i, j]| {
                    let plane = &halves[(i & 1 | (j & 1) << 1) as usize];
                    &plane[(row + (j >> 1) as usize) * stride + column + (i >> 1) as usize..][..width]
                });
                moved.extend(a.iter().zip(b).map(|(&a, &b)| ((u16::from(a) + u16::from(b) + 1) >> 1) as u8));
            } else {
                let [fx, fy] = fraction.map(|f| f as u16);
                let at = |i: u16, j: u16| {
                    // Where a neighbour weighs nothing, it need not be there.
                    let (i, j) = (usize::from(i.min(fx)), usize::from(j.min(fy)));
                    &halves[0][(row + j) * stride + column + i..][..width]
                };
                let (a, b, c, d) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
                let weights = [(4 - fx) * (4 - fy), fx * (4 - fy), (4 - fx) * fy, fx * fy];
                let term = |i: usize, value: u8| weights[i] * u16::from(value);
                let sum = |x: usize| term(0, a[x]) + term(1, b[x]) + term(2, c[x]) + term(3, d[x]);
                moved.extend((0..width).map(|x| ((sum(x) + 8) >> 4) as u8));
            }
        }
        (moved, width)
    }
}

/// Adds to `sums` those of six lines of equal length, each weighted as its tap: plain loops, which become vector
/// instructions.
#[inline(always)]
fn weigh<T: Copy + Into<i32>>(lines: [&[T]; 6], sums: &mut Vec<i32>) {
    let length = lines[0].len();
    let [a, b, c, d, e, f] = lines.map(|line| &line[..length]);
    let both = |a: T, b: T| a.into() + b.into();
    sums.extend((0..length).map(|x| both(a[x], f[x]) - 5 * both(b[x], e[x]) + 20 * both(c[x], d[x])));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    const BOTH: [Interpolation; 2] = [Interpolation::Bilinear, Interpolation::SixTap];

    fn texture() -> Gray {
        Grid::from_fn(23, 17, |x, y| ((x * x * 7 + y * y * 13 + x * y * 5) % 256) as u8)
    }

    #[test]
    fn half_pixels_have_the_standards_weights() {
        // A bright column on black: what each tap sees of it.
        let column = Grid::from_fn(12, 3, |x, _| if x == 5 { 64 } else { 0 });
        let at = |x| Interpolation::SixTap.at(&column, [x, 4], Border::Replicate);
        let expected = TAPS.map(|tap| ((tap * 64 + 16) >> 5).clamp(0, 255) as u8);
        assert_eq!([30, 26, 22, 18, 14, 10].map(at), expected);
        assert_eq!(at(20), 64);
        // A quarter: the mean of the pixel and the half pixel beside it, rounded up.
        assert_eq!(at(21), (64 + expected[3]).div_ceil(2));
    }

    #[test]
    fn diagonal_quarters_are_the_mean_of_the_nearest_half_pixels_on_the_sides() {
        let picture = texture();
        let half = |x, y| u16::from(Interpolation::SixTap.at(&picture, [x, y], Border::Replicate));
        for (dx, dy, a, b) in
            [(1, 1, (2, 0), (0, 2)), (3, 1, (2, 0), (4, 2)), (1, 3, (0, 2), (2, 4)), (3, 3, (4, 2), (2, 4))]
        {
            let (x, y) = (4 * 9, 4 * 7);
            let mean = (half(x + a.0, y + a.1) + half(x + b.0, y + b.1)).div_ceil(2);
            assert_eq!(half(x + dx, y + dy), mean, "{dx} {dy}");
        }
    }

    #[test]
    fn samples_at_quarters_are_those_of_whole_numbers() {
        let picture = texture();
        for (filter, x, y) in BOTH.into_iter().flat_map(|f| (-9..90).map(move |x| (f, x, 3 * x / 4 - 5))) {
            let at = [x as f32 / 4.0, y as f32 / 4.0];
            let [sampled, exact] =
                [filter.sample(&picture, at, Border::Mirror), filter.at(&picture, [x, y], Border::Mirror)];
            assert_eq!(sampled, exact, "{filter:?} {at:?}");
        }
    }

    #[test]
    fn flat_stays_flat_and_whole_pixels_stay_what_they_are() {
        let picture = texture();
        for filter in BOTH {
            assert_eq!(filter.at(&Grid::new(5, 5, 255), [7, 9], Border::Replicate), 255);
            assert_eq!(filter.at(&picture, [4 * 8, 4 * 3], Border::Mirror), picture[(8, 3)]);
        }
    }

    #[test]
    fn a_moved_block_is_what_its_pixels_are_one_by_one() {
        let picture = texture();
        let mut between = Between::default();
        for (filter, border) in BOTH.into_iter().flat_map(|f| [(f, Border::Replicate), (f, Border::Mirror)]) {
            for (corner, size) in [((4, 3), (8, 8)), ((-5, 14), (7, 5)), ((22, -2), (1, 3))] {
                between.take((&picture, border), corner, size, filter);
                for (x, y) in (-3..=3).flat_map(|y| (-3..=3).map(move |x| (x, y))) {
                    let (pixels, stride) = between.moved([x, y]);
                    for (i, j) in (0..size.1).flat_map(|j| (0..size.0).map(move |i| (i, j))) {
                        let place = [4 * (corner.0 as i32 + i as i32) + x, 4 * (corner.1 as i32 + j as i32) + y];
                        assert_eq!(pixels[j * stride + i], filter.at(&picture, place, border), "{filter:?} {x} {y}");
                    }
                }
            }
        }
    }
}
