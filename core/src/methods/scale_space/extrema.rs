//! Extrema of differences of Gaussians among their 26 neighbours in position and scale.

use super::Octave;
use crate::base::LANES;
use crate::base::wide::{lane, widest};
use crate::geometry::Grid;

/// Pixels at the border of an octave in which no extremum is sought.
pub const BORDER: usize = 5;

/// A pixel of a difference of Gaussians that no neighbour in position or scale exceeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extremum {
    /// The octave.
    pub octave: usize,
    /// The difference of Gaussians, from 1 to the number of scales.
    pub level: usize,
    /// Column in px of the octave.
    pub x: usize,
    /// Row in px of the octave.
    pub y: usize,
}

/// The largest and the smallest value of each column of nine rows.
#[derive(Default)]
struct Columns {
    high: Vec<f32>,
    low: Vec<f32>,
}

/// Calls `tell` with each column of row `y` of difference `level` that holds an extremum with an absolute value above `least`.
pub fn extrema_of_row(octave: &Octave, (level, y): (usize, usize), least: f32, mut tell: impl FnMut(usize)) {
    let images = [level - 1, level, level + 1].map(|level| &*octave.differences[level]);
    let width = images[1].width();
    if width <= 2 * BORDER {
        return;
    }
    let rows: [&[f32]; 9] = std::array::from_fn(|i| images[i / 3].row(y + i % 3 - 1));
    let mut columns = Columns { high: vec![0.0; width], low: vec![0.0; width] };
    ends_of_columns(rows, &mut columns);
    let Columns { high, low } = columns;
    let row = images[1].row(y);
    for x in BORDER..width - BORDER {
        let value = row[x];
        if value.abs() <= least {
            continue;
        }
        let is_extremum = match value > 0.0 {
            true => value >= high[x - 1].max(high[x]).max(high[x + 1]),
            false => value <= low[x - 1].min(low[x]).min(low[x + 1]),
        };
        if is_extremum {
            tell(x);
        }
    }
}

widest! {
    fn ends_of_columns(rows: [&[f32]; 9], columns: &mut Columns) = ends_of_columns_body
}

#[inline(always)]
fn ends_of_columns_body(rows: [&[f32]; 9], Columns { high, low }: &mut Columns) {
    let (whole, rest) = high.as_chunks_mut::<LANES>();
    let (whole_low, rest_low) = low.as_chunks_mut::<LANES>();
    let start = LANES * whole.len();
    for (i, (high, low)) in whole.iter_mut().zip(whole_low).enumerate() {
        let Some(first) = lane(rows[0], LANES * i) else { continue };
        let (mut most, mut least) = (*first, *first);
        for row in rows[1..].iter().filter_map(|row| lane(row, LANES * i)) {
            for k in 0..LANES {
                most[k] = if row[k] > most[k] { row[k] } else { most[k] };
                least[k] = if row[k] < least[k] { row[k] } else { least[k] };
            }
        }
        (*high, *low) = (most, least);
    }
    for (x, (high, low)) in (start..).zip(rest.iter_mut().zip(rest_low)) {
        let (mut most, mut least) = (rows[0][x], rows[0][x]);
        for row in &rows[1..] {
            most = if row[x] > most { row[x] } else { most };
            least = if row[x] < least { row[x] } else { least };
        }
        (*high, *low) = (most, least);
    }
}

/// The neighbour of pixel `(x, y)` of difference `level` that exceeds it most in the direction of its sign, with its level and its
/// value; `None` if it is an extremum.
pub fn beats(differences: [&Grid<f32>; 3], (x, y): (usize, usize)) -> Option<(usize, (usize, usize), f32)> {
    let value = differences[1][(x, y)];
    let sign = if value > 0.0 { 1.0 } else { -1.0 };
    let around = (0..3).flat_map(|k| (y - 1..=y + 1).flat_map(move |j| (x - 1..=x + 1).map(move |i| (k, (i, j)))));
    let values = around.map(|(k, at)| (k, at, differences[k][at]));
    values.filter(|(.., other)| sign * other > sign * value).max_by(|a, b| (sign * a.2).total_cmp(&(sign * b.2)))
}
