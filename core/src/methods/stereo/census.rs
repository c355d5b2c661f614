//! The census transform (Zabih and Woodfill 1994): the order of gray levels around a pixel, which neither brightness nor contrast changes.

use crate::base::Threads;
use crate::base::wide::wide;
use crate::geometry::{Gray, Grid};

/// Half the width and half the height of the window: 9×7 px.
const REACH: [usize; 2] = [4, 3];

/// Number of bits of a census string: one for each pixel of the window but its centre.
pub(crate) const BITS: u32 = 62;

/// For each pixel, a bit for each other pixel of the 9×7 window around it, row by row from the most significant one: 1 where it is darker.
/// Beyond the border the edge is repeated.
pub(crate) fn census(picture: &Gray, threads: &Threads) -> Grid<u64> {
    let (width, height) = picture.size();
    let [reach_x, reach_y] = REACH;
    let padded =
        Grid::from_fn(width + 2 * reach_x, height, |x, y| picture.row(y)[x.saturating_sub(reach_x).min(width - 1)]);
    let mut strings = Grid::new(width, height, 0);
    threads.rows(&mut strings, |y, row| {
        let centre = picture.row(y);
        for dy in 0..2 * reach_y + 1 {
            let around = padded.row((y + dy).saturating_sub(reach_y).min(height - 1));
            for dx in (0..2 * reach_x + 1).filter(|dx| (*dx, dy) != (reach_x, reach_y)) {
                compare(row, centre, &around[dx..]);
            }
        }
    });
    strings
}

wide! {
    /// Appends a bit to each string: whether the neighbour is darker than the centre.
    fn compare(strings: &mut [u64], centres: &[u8], neighbours: &[u8]) = compare_each
}

#[inline(always)]
fn compare_each(strings: &mut [u64], centres: &[u8], neighbours: &[u8]) {
    for ((string, centre), neighbour) in strings.iter_mut().zip(centres).zip(neighbours) {
        *string = (*string << 1) | u64::from(neighbour < centre);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_the_order_around_a_pixel_whatever_the_light() {
        let value = |x: usize, y: usize| ((x * 37 + y * 101 + x * y * 13) % 120) as u8;
        let picture = Grid::from_fn(21, 12, value);
        let strings = census(&picture, &Threads::single());
        for (x, y) in (0..12).flat_map(|y| (0..21).map(move |x| (x, y))) {
            let mut expected = String::new();
            for (dx, dy) in (-3..=3).flat_map(|dy| (-4..=4).map(move |dx| (dx, dy))).filter(|at| *at != (0, 0)) {
                let at = ((x as i32 + dx).clamp(0, 20) as usize, (y as i32 + dy).clamp(0, 11) as usize);
                expected.push(if picture[at] < picture[(x, y)] { '1' } else { '0' });
            }
            assert_eq!(format!("{:062b}", strings[(x, y)]), expected, "({x}, {y})");
        }
        assert_eq!(census(&picture.map(|v| 2 * v + 10), &Threads::single()), strings);
        assert_eq!(census(&picture, &Threads::new(2).unwrap()), strings);
    }
}
