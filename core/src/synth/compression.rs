//! The loss of JPEG compression, without the file: each block of 8×8 pixels is turned into frequencies (DCT), these are
//! rounded to the standard's tables (ITU-T T.81, Annex K, scaled as the Independent JPEG Group does), and turned back.

use rayon::prelude::*;

use super::maths::cos;
use super::texture::Rgb;
use crate::geometry::{Border, Grid};

const SIDE: usize = 8;

type Block = [[f32; SIDE]; SIDE];

const LUMA: [[u16; SIDE]; SIDE] = [
    [16, 11, 10, 16, 24, 40, 51, 61],
    [12, 12, 14, 19, 26, 58, 60, 55],
    [14, 13, 16, 24, 40, 57, 69, 56],
    [14, 17, 22, 29, 51, 87, 80, 62],
    [18, 22, 37, 56, 68, 109, 103, 77],
    [24, 35, 55, 64, 81, 104, 113, 92],
    [49, 64, 78, 87, 103, 121, 120, 101],
    [72, 92, 95, 98, 112, 100, 103, 99],
];

const CHROMA: [[u16; SIDE]; SIDE] = [
    [17, 18, 24, 47, 99, 99, 99, 99],
    [18, 21, 26, 66, 99, 99, 99, 99],
    [24, 26, 56, 99, 99, 99, 99, 99],
    [47, 66, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
    [99, 99, 99, 99, 99, 99, 99, 99],
];

/// Compresses `picture` at `quality` 1 (worst) to 100 (best) and decompresses it.
pub fn compress(picture: &mut Grid<[u8; 3]>, quality: u32) {
    let coder = Coder::new(quality);
    let before = picture.clone();
    let width = picture.width();
    picture.cells_mut().par_chunks_mut(width * SIDE).enumerate().for_each(|(row, band)| {
        for left in (0..width).step_by(SIDE) {
            let block = coder.block(&before, left, row * SIDE);
            for (y, line) in band.chunks_mut(width).enumerate() {
                for (x, pixel) in line.iter_mut().skip(left).take(SIDE).enumerate() {
                    *pixel = to_rgb([block[0][y][x], block[1][y][x], block[2][y][x]]);
                }
            }
        }
    });
}

struct Coder {
    /// Row u holds the basis function of frequency u.
    basis: Block,
    steps: [Block; 3],
}

impl Coder {
    fn new(quality: u32) -> Self {
        let percent = if quality < 50 { 5000 / quality.max(1) } else { 200 - 2 * quality.min(100) };
        let scaled = |table: &[[u16; SIDE]; SIDE]| {
            table.map(|row| row.map(|step| ((u32::from(step) * percent + 50) / 100).clamp(1, 255) as f32))
        };
        let height = |u: usize| if u == 0 { 0.125_f64.sqrt() } else { 0.5 };
        let wave = |u: usize, x: usize| height(u) * cos(((2 * x + 1) * u) as f64 / 32.0);
        let basis = std::array::from_fn(|u| std::array::from_fn(|x| wave(u, x) as f32));
        Self { basis, steps: [scaled(&LUMA), scaled(&CHROMA), scaled(&CHROMA)] }
    }

    /// The block whose first pixel is (`left`, `top`), as brightness and two colour differences, coded and decoded.
    fn block(&self, picture: &Grid<[u8; 3]>, left: usize, top: usize) -> [Block; 3] {
        let mut planes = [[[0.0; SIDE]; SIDE]; 3];
        for y in 0..SIDE {
            for x in 0..SIDE {
                let pixel = picture.at((left + x) as isize, (top + y) as isize, Border::Replicate);
                let parts = from_rgb(pixel.map(f32::from));
                for (plane, part) in planes.iter_mut().zip(parts) {
                    plane[y][x] = part;
                }
            }
        }
        for (plane, steps) in planes.iter_mut().zip(&self.steps) {
            *plane = self.round_trip(plane, steps);
        }
        planes
    }

    fn round_trip(&self, plane: &Block, steps: &Block) -> Block {
        let basis_t = transpose(&self.basis);
        let mut frequencies = product(&product(&self.basis, plane), &basis_t);
        for (value, step) in frequencies.as_flattened_mut().iter_mut().zip(steps.as_flattened()) {
            *value = (*value / step).round() * step;
        }
        product(&product(&basis_t, &frequencies), &self.basis)
    }
}

fn transpose(a: &Block) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn product(a: &Block, b: &Block) -> Block {
    let mut c = [[0.0; SIDE]; SIDE];
    for (c_row, a_row) in c.iter_mut().zip(a) {
        for (&factor, b_row) in a_row.iter().zip(b) {
            for (sum, value) in c_row.iter_mut().zip(b_row) {
                *sum += factor * value;
            }
        }
    }
    c
}

/// Y − 128, Cb, Cr of JFIF, about zero.
fn from_rgb([r, g, b]: Rgb) -> Rgb {
    [
        0.299 * r + 0.587 * g + 0.114 * b - 128.0,
        -0.168_736 * r - 0.331_264 * g + 0.5 * b,
        0.5 * r - 0.418_688 * g - 0.081_312 * b,
    ]
}

fn to_rgb([y, cb, cr]: Rgb) -> [u8; 3] {
    let color = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
    color.map(|c| (c + 128.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Grid<[u8; 3]> {
        let wave = |x: usize, y: usize, c: usize| 120.0 + 40.0 * cos(x as f64 / (50.0 + c as f64) + y as f64 / 90.0);
        Grid::from_fn(52, 37, |x, y| std::array::from_fn(|c| wave(x, y, c) as u8))
    }

    fn error(quality: u32) -> f64 {
        let (before, mut after) = (picture(), picture());
        compress(&mut after, quality);
        let pairs = before.cells().as_flattened().iter().zip(after.cells().as_flattened());
        let squares: f64 = pairs.map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
        (squares / (before.cells().len() * 3) as f64).sqrt()
    }

    #[test]
    fn lower_quality_loses_more() {
        let errors = [100, 80, 50, 20, 1].map(error);
        assert!(errors[0] < 1.0, "{errors:?}");
        assert!(errors.is_sorted_by(|a, b| a < b), "{errors:?}");
    }

    #[test]
    fn the_basis_is_orthonormal() {
        let basis = Coder::new(50).basis;
        let unit = product(&basis, &transpose(&basis));
        for (i, row) in unit.iter().enumerate() {
            assert!(row.iter().enumerate().all(|(j, v)| (v - f32::from(u8::from(i == j))).abs() < 1e-6));
        }
    }

    #[test]
    fn at_the_worst_quality_blocks_are_flat() {
        let mut picture = picture();
        compress(&mut picture, 1);
        let jumps = |x: usize| (0..36).map(|y| picture[(x, y)][1].abs_diff(picture[(x - 1, y)][1]) as u32).sum::<u32>();
        let at_borders: u32 = (8..52).step_by(8).map(jumps).sum();
        let inside: u32 = (9..52).filter(|x| x % 8 != 0).map(jumps).sum();
        assert!(at_borders > 2 * inside, "{at_borders} {inside}");
    }
}
