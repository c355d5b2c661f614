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
    let inside = BORDER..width - BORDER;
    let mut marks = vec![0; inside.len()];
    mark_extrema(&images[1].row(y)[inside], &columns, least, &mut marks);
    marks.iter().enumerate().filter(|(_, mark)| **mark != 0).for_each(|(i, _)| tell(BORDER + i));
}

widest! {
    fn mark_extrema(row: &[f32], columns: &Columns, least: f32, marks: &mut [u32]) = mark_extrema_body
}

/// Marks by 1 the pixels of a row from column [`BORDER`] on that no neighbour exceeds; without a branch, for all pixels alike.
#[inline(always)]
fn mark_extrema_body(row: &[f32], Columns { high, low }: &Columns, least: f32, marks: &mut [u32]) {
    let count = marks.len();
    let row = &row[..count];
    let [[a, b, c], [d, e, f]] = [high, low].map(|ends| [0, 1, 2].map(|i| &ends[BORDER - 1 + i..][..count]));
    for i in 0..count {
        let value = row[i];
        let is_highest = (value >= a[i]) & (value >= b[i]) & (value >= c[i]);
        let is_lowest = (value <= d[i]) & (value <= e[i]) & (value <= f[i]);
        let is_extremum = ((value > 0.0) & is_highest) | ((value <= 0.0) & is_lowest);
        marks[i] = u32::from((value.abs() > least) & is_extremum);
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
