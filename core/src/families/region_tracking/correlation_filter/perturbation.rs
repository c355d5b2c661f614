//! Turned and scaled copies of the first window, from which the filter is learned.

use super::{CorrelationFilter, Model};
use crate::base::LANES;
use crate::base::wide::wide;
use crate::geometry::{Gray, Grid};
use crate::synth::random::{hash, unit};

/// The largest change of scale of a perturbation.
pub(super) const PERTURBED_SCALE: f64 = 0.1;

impl CorrelationFilter {
    /// The window of the first frame, turned and scaled at random about its middle. Each copy turns by an angle in a part of its own of the
    /// range, so that a few copies cover all of it.
    pub(super) fn perturbed(&self, model: &Model, luma: &Gray, center: [f32; 2], index: usize) -> Grid<f32> {
        let random = |i: u64| unit(hash(u64::from(self.seed), index as u64, i));
        let part = (index as f64 + random(0)) / self.perturbations as f64;
        let angle = f64::from(self.rotation).to_radians() * (2.0 * part - 1.0);
        let scale = 1.0 + PERTURBED_SCALE * (2.0 * random(1) - 1.0);
        let (width, height) = model.size();
        let middle = [(width / 2) as f64, (height / 2) as f64];
        let origin = model.origin(center);
        let about = [0, 1].map(|i| f64::from(origin[i]) + middle[i]);
        let turn = Turn { middle, about, sin: angle.sin() * scale, cos: angle.cos() * scale };
        let mut levels = Grid::new(width, height, 0);
        (0..height).for_each(|y| sample_row(luma, &turn, y, levels.row_mut(y)));
        model.prepared(&levels)
    }
}

/// A rotation with a change of scale.
struct Turn {
    /// The pixel of the window that stays, and its position in the frame.
    middle: [f64; 2],
    about: [f64; 2],
    sin: f64,
    cos: f64,
}

wide!(fn sample_row(luma: &Gray, turn: &Turn, y: usize, levels: &mut [u8]) = sample_row_of);

/// Interpolates the gray levels of a row of the turned window, as [`Grid::sample`] does and rounded. The positions of several pixels are
/// computed before any of them is read, so that the compiler makes vector instructions of it.
#[inline(always)]
fn sample_row_of(luma: &Gray, turn: &Turn, y: usize, levels: &mut [u8]) {
    let Turn { middle, about, sin, cos } = *turn;
    let dy = y as f64 - middle[1];
    let last = [luma.width() - 1, luma.height() - 1];
    let cells = luma.cells();
    for (group, levels) in levels.chunks_mut(LANES).enumerate() {
        let mut places = [[0i32; LANES]; 2];
        let mut fractions = [[0.0f32; LANES]; 2];
        for k in 0..LANES {
            let dx = (group * LANES) as f64 + k as i32 as f64 - middle[0];
            let (u, v) = (cos * dx - sin * dy, sin * dx + cos * dy);
            for (axis, offset) in [u, v].into_iter().enumerate() {
                let at = ((about[axis] + offset) as f32).clamp(0.0, last[axis] as f32);
                places[axis][k] = at as i32;
                fractions[axis][k] = at - places[axis][k] as f32;
            }
        }
        for (k, level) in levels.iter_mut().enumerate() {
            let [x, y] = [0, 1].map(|axis| places[axis][k] as usize);
            let right = usize::from(x < last[0]);
            let row = |y: usize| {
                let [a, b] = [x, x + right].map(|x| f32::from(cells[y * luma.width() + x]));
                a + (b - a) * fractions[0][k]
            };
            let (top, bottom) = (row(y), row(y + usize::from(y < last[1])));
            *level = (top + (bottom - top) * fractions[1][k] + 0.5) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_those_of_the_picture() {
        let luma = Grid::from_fn(50, 40, |x, y| ((x * x * 3 + y * 37 + x * y * 5) % 251) as u8);
        let turn = Turn { middle: [18.0, 20.0], about: [23.0, 12.0], sin: 0.6, cos: 0.9 };
        for y in 0..40 {
            let mut levels = vec![0; 37];
            sample_row(&luma, &turn, y, &mut levels);
            for (x, level) in levels.iter().enumerate() {
                let (dx, dy) = (x as f64 - 18.0, y as f64 - 20.0);
                let at = [23.0 + (0.9 * dx - 0.6 * dy), 12.0 + (0.6 * dx + 0.9 * dy)].map(|c| c as f32);
                assert_eq!(*level, (luma.sample(at[0], at[1]) + 0.5) as u8, "{x}, {y}");
            }
        }
    }
}
