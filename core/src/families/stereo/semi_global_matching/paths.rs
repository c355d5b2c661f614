//! Path costs of a row of pixels: the recursion of Hirschmüller (2008), equation 13, in bytes.
//!
//! A Hamming distance has at most 62 bits, and P2 is at most [`MOST_PENALTY`], so a path cost fits into a byte: the least one of a pixel
//! is at most 62, and all others exceed their own Hamming distance by at most P2. Sums that do not fit saturate and never are the minimum.

use crate::base::wide::wide;

/// The largest penalty.
pub const MOST_PENALTY: usize = 192;
/// The cost of a disparity that is none: beyond the range, or with its match beside the right view.
pub const NONE: u8 = u8::MAX;
/// Disparities that are worked on at once; a pixel has a multiple of them.
pub const LANES: usize = 32;
/// Bytes before and after the path costs of a pixel, so that each disparity has neighbours.
const MARGIN: usize = 16;

/// The path costs of a row of pixels along a direction, with one pixel outside the picture on either side, where all are 0.
#[derive(Clone)]
pub struct Line {
    cells: Vec<u8>,
    /// The least path cost of each pixel.
    least: Vec<u8>,
    /// Bytes of a pixel.
    block: usize,
}

impl Line {
    /// A row outside the picture, where paths begin: all costs are 0.
    pub fn outside(width: usize, depth: usize) -> Self {
        let block = depth + 2 * MARGIN;
        let mut cells = vec![NONE; (width + 2) * block];
        cells.chunks_exact_mut(block).for_each(|pixel| pixel[MARGIN..MARGIN + depth].fill(0));
        Self { cells, least: vec![0; width + 2], block }
    }

    /// The path costs of pixel `x`.
    pub fn at(&self, x: usize) -> &[u8] {
        let pixel = &self.cells[(x + 1) * self.block..(x + 2) * self.block];
        &pixel[MARGIN..self.block - MARGIN]
    }
}

/// A row of pixels along a direction.
pub struct Job<'a> {
    /// The step from a pixel to the next one on a path, along x.
    pub dx: isize,
    /// The path costs of the row before; `None` where paths run within the row.
    pub before: Option<&'a Line>,
    /// The path costs of the row, to be written.
    pub line: &'a mut Line,
    /// The matching costs of the row.
    pub costs: &'a [u8],
    /// The sums of path costs over directions, added to.
    pub sums: &'a mut [u16],
    /// P1 and P2.
    pub penalties: [u8; 2],
}

wide! {
    /// Writes the path costs of a row, and adds them to the sums.
    pub fn follow(job: Job<'_>) = follow_row
}

#[inline(always)]
fn follow_row(job: Job<'_>) {
    let Job { dx, before, line, costs, sums, penalties } = job;
    let (block, width) = (line.block, line.least.len() - 2);
    let depth = block - 2 * MARGIN;
    for i in 0..width {
        // Within a row, the pixel before comes first.
        let x = if before.is_none() && dx < 0 { width - 1 - i } else { i };
        let (here, from) = (x + 1, (x + 1).wrapping_add_signed(-dx));
        let (costs, sums) = (&costs[x * depth..(x + 1) * depth], &mut sums[x * depth..(x + 1) * depth]);
        line.least[here] = match before {
            Some(before) => {
                let last = &before.cells[from * block..(from + 1) * block];
                let cells = &mut line.cells[here * block..(here + 1) * block];
                step(costs, (last, before.least[from]), cells, sums, penalties)
            }
            None => {
                let (first, second) = line.cells.split_at_mut(here.max(from) * block);
                let (lower, upper) = (&mut first[here.min(from) * block..], &mut second[..block]);
                let (last, cells) = if from < here { (lower, upper) } else { (upper, lower) };
                step(costs, (last, line.least[from]), cells, sums, penalties)
            }
        };
    }
}

/// Writes the path costs of a pixel from those of the one before and their minimum, and adds them to the sums; returns their minimum.
#[inline(always)]
fn step(costs: &[u8], (last, least): (&[u8], u8), cells: &mut [u8], sums: &mut [u16], [p1, p2]: [u8; 2]) -> u8 {
    debug_assert!(costs.len().is_multiple_of(LANES) && sums.len() == costs.len(), "whole lanes of costs and sums");
    debug_assert!([last.len(), cells.len()].map(|len| len - 2 * MARGIN) == [costs.len(); 2], "path costs with margins");
    let jump = least.saturating_add(p2);
    let mut lowest = [NONE; LANES];
    // Whole arrays, without sums that could overflow: the compiler keeps them in registers in every profile.
    let (costs, sums) = (costs.as_chunks::<LANES>().0, sums.as_chunks_mut::<LANES>().0);
    for ((costs, sums), from) in costs.iter().zip(sums).zip((MARGIN..).step_by(LANES)) {
        let around = [from - 1, from, from + 1].map(|from| last.get(from..).and_then(<[u8]>::first_chunk::<LANES>));
        let cells = cells.get_mut(from..).and_then(<[u8]>::first_chunk_mut::<LANES>);
        let ([Some(below), Some(same), Some(above)], Some(cells)) = (around, cells) else { break };
        let best: [u8; LANES] =
            std::array::from_fn(|i| same[i].min(jump).min(below[i].min(above[i]).saturating_add(p1)));
        *cells = std::array::from_fn(|i| costs[i].saturating_add(best[i].saturating_sub(least)));
        lowest = std::array::from_fn(|i| lowest[i].min(cells[i]));
        *sums = std::array::from_fn(|i| sums[i].wrapping_add(u16::from(cells[i])));
    }
    lowest.iter().copied().fold(NONE, u8::min)
}

wide! {
    /// The Hamming distances of the census strings of a row and those of their matches; `reversed` is the row of the right view from right to
    /// left.
    pub fn hamming(costs: &mut [u8], left: &[u64], reversed: &[u64], disparities: usize) = hamming_row
}

#[inline(always)]
fn hamming_row(costs: &mut [u8], left: &[u64], reversed: &[u64], disparities: usize) {
    let width = left.len();
    let depth = costs.len() / width;
    for ((x, left), costs) in left.iter().enumerate().zip(costs.chunks_exact_mut(depth)) {
        let (found, none) = costs.split_at_mut(disparities.min(x + 1));
        for (cost, right) in found.iter_mut().zip(&reversed[width - 1 - x..]) {
            *cost = (left ^ right).count_ones() as u8;
        }
        none.fill(NONE);
    }
}
