//! Lower bounds of a cost by sums of parts of a block, for successive elimination.
//!
//! Over any part, |Σ a − Σ b| ≤ Σ |a − b| (Li and Salari 1995), and (Σ a − Σ b)² ≤ n Σ (a − b)² for its n pixels. Bounds of several
//! parts add up, and smaller parts bound more tightly (Gao, Duanmu and Zou 2000). Pixels that no part covers add nothing.

use super::windows::{Boxes, box_sums};
use super::{Cut, Sum};
use crate::base::wide::wide;
use crate::geometry::{Border, Gray};

/// Candidates side by side whose bounds are computed at once.
pub const LANES: usize = 8;

/// Sums of gray levels over square parts, at every place of an area.
#[derive(Clone, Debug, Default)]
pub struct PartSums {
    levels: Vec<Level>,
}

/// The sums over parts of one size.
#[derive(Clone, Debug)]
struct Level {
    /// Side of a part in px.
    side: usize,
    /// The place of the first sum in the picture.
    first: (isize, isize),
    stride: usize,
    sums: Vec<u32>,
}

/// The parts of a block on one level.
#[derive(Clone, Debug)]
pub struct Parts {
    /// Side of a part in px.
    pub side: usize,
    /// Parts across and down.
    pub counts: (usize, usize),
    /// The sum of each part of the block, row by row.
    pub sums: Vec<u32>,
}

impl PartSums {
    /// Sums over parts with these `sides` of `picture`, continued by `margin` px to all sides.
    pub fn of_picture(picture: &Gray, margin: usize, border: Border, sides: &[usize]) -> Self {
        let (mut area, start) = (Cut::default(), -(margin as isize));
        let size = (picture.width() + 2 * margin, picture.height() + 2 * margin);
        area.take(picture, (start, start), size, border);
        Self::of_area(&area, (start, start), sides)
    }

    /// The same of an area whose first pixel lies at `first` of the picture.
    pub fn of_area(area: &Cut, first: (isize, isize), sides: &[usize]) -> Self {
        let mut columns = Vec::new();
        let fitting = sides.iter().copied().filter(|&side| side <= area.width && side <= area.height);
        let level = |side| {
            let size = (area.width - side + 1, area.height - side + 1);
            let mut sums = Vec::new();
            box_sums::<false>(&mut sums, area, Boxes { block: (side, side), size }, &mut columns);
            // The last places are read in whole registers.
            sums.resize(sums.len() + LANES, 0);
            Level { side, first, stride: size.0, sums }
        };
        Self { levels: fitting.map(level).collect() }
    }

    /// The parts of a block on each level.
    pub fn parts(&self, block: &Cut) -> Vec<Parts> {
        self.levels.iter().map(|level| Parts::of(block, level.side)).collect()
    }

    /// Lower bounds on `level` of the `sum` of a block with these `parts` for [`LANES`] candidates beside each other, of which the
    /// first has its first pixel at `(x, y)` of the picture. Those of candidates beyond the area mean nothing.
    pub fn bounds(&self, sum: Sum, level: usize, parts: &Parts, place: (isize, isize)) -> [u32; LANES] {
        let level = &self.levels[level];
        let start = level.start(place);
        match sum {
            Sum::Absolute => absolute(level, parts, start),
            Sum::Squared => squared(level, parts, start),
        }
    }

    /// Which of the first 64 runs of [`LANES`] candidates beside each other the sum of the whole block excludes, a bit for each: those
    /// whose bounds by the first level all exceed `limit`. The first of `count` candidates has its first pixel at `(x, y)` of the
    /// picture. Squared differences are left to [`PartSums::bounds`], and so is a block whose parts are smaller than itself.
    pub fn excluded(&self, sum: Sum, parts: &Parts, (place, count): ((isize, isize), usize), limit: u32) -> u64 {
        let (Some(level), [own], Sum::Absolute) = (self.levels.first(), &parts.sums[..], sum) else { return 0 };
        let row = level.sums.get(level.start(place)..).and_then(|row| row.get(..count));
        row.map_or(0, |row| excluded_runs(*own, row, limit))
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(&level.sums[..])).sum()
    }
}

impl Level {
    /// The index of the sum over the part whose first pixel lies at a place of the picture.
    fn start(&self, place: (isize, isize)) -> usize {
        let from = |place: isize, first: isize| usize::try_from(place - first).unwrap_or(0);
        from(place.1, self.first.1) * self.stride + from(place.0, self.first.0)
    }
}

impl Parts {
    /// The parts with this `side` that lie in `block`.
    pub fn of(block: &Cut, side: usize) -> Self {
        let counts = (block.width / side, block.height / side);
        let places = (0..counts.1).flat_map(|y| (0..counts.0).map(move |x| (x * side, y * side)));
        Self { side, counts, sums: places.map(|place| sum_of(block, place, side)).collect() }
    }
}

/// The sum of the `side × side` px of `cut` from `(x, y)` on.
fn sum_of(cut: &Cut, (x, y): (usize, usize), side: usize) -> u32 {
    let of_row = |y| cut.row(x, y)[..side].iter().map(|&pixel| u32::from(pixel)).sum::<u32>();
    (y..y + side).map(of_row).sum()
}

wide!(fn excluded_runs(own: u32, row: &[u32], limit: u32) -> u64 = excluded_runs_of);

#[inline(always)]
fn excluded_runs_of(own: u32, row: &[u32], limit: u32) -> u64 {
    let mut excluded = 0;
    for (bit, run) in row.chunks(LANES).take(64).enumerate() {
        let least = match run.first_chunk::<LANES>() {
            Some(run) => {
                let mut bounds = [0u32; LANES];
                (0..LANES).for_each(|i| bounds[i] = own.abs_diff(run[i]));
                bounds.iter().fold(u32::MAX, |least, bound| least.min(*bound))
            }
            None => run.iter().fold(u32::MAX, |least, sum| least.min(own.abs_diff(*sum))),
        };
        excluded |= u64::from(least > limit) << bit;
    }
    excluded
}

wide!(fn absolute(level: &Level, parts: &Parts, start: usize) -> [u32; LANES] = absolute_of);

#[inline(always)]
fn absolute_of(level: &Level, parts: &Parts, start: usize) -> [u32; LANES] {
    let mut bounds = [0u32; LANES];
    each_part(level, parts, start, |own, sums| {
        for (bound, &sum) in bounds.iter_mut().zip(sums) {
            *bound = bound.wrapping_add(own.abs_diff(sum));
        }
    });
    bounds
}

wide!(fn squared(level: &Level, parts: &Parts, start: usize) -> [u32; LANES] = squared_of);

/// The squares are whole numbers below 2⁵³, so exact; rounded down to a whole number, the bound still holds.
#[inline(always)]
fn squared_of(level: &Level, parts: &Parts, start: usize) -> [u32; LANES] {
    let mut squares = [0f64; LANES];
    each_part(level, parts, start, |own, sums| {
        for (square, &sum) in squares.iter_mut().zip(sums) {
            let difference = f64::from(own as i32) - f64::from(sum as i32);
            *square += difference * difference;
        }
    });
    let pixels = (level.side * level.side) as f64;
    squares.map(|square| (square / pixels) as u32)
}

/// Calls `add` with the sum of each part of the block and those of the candidates.
#[inline(always)]
fn each_part(level: &Level, parts: &Parts, start: usize, mut add: impl FnMut(u32, &[u32; LANES])) {
    // A block that is clipped at the border may contain no part, and reach less far than one.
    let mut row = start;
    for own in parts.sums.chunks(parts.counts.0.max(1)) {
        let mut place = row;
        for &own in own {
            let Some(sums) = level.sums.get(place..).and_then(|sums| sums.first_chunk()) else { return };
            add(own, sums);
            place += level.side;
        }
        row += level.side * level.stride;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::until;
    use super::*;
    use crate::geometry::Grid;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn no_bound_exceeds_its_sum_and_each_is_that_of_its_formula(
            (width, height) in (1usize..=40, 1usize..=40), (x, y) in (0isize..20, 0isize..20), seed in any::<u32>(),
            (margin, levels) in (0usize..8, prop::sample::select(vec![2u32, 256])),
        ) {
            let noise = |x: usize, y: usize| {
                let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
                ((h.wrapping_mul(0xC2B2_AE35) >> 16) % levels * (255 / (levels - 1))) as u8
            };
            let picture = Grid::from_fn(80, 70, noise);
            let (mut block, mut area) = (Cut::default(), Cut::default());
            block.take(&picture, (20, 11), (width, height), Border::Replicate);
            let first = (x - margin as isize, y - margin as isize);
            area.take(&picture, first, (width + LANES - 1, height), Border::Mirror);
            let sides = [16, 8, 3];
            let sums = PartSums::of_picture(&picture, margin, Border::Mirror, &sides);
            for (level, parts) in sums.parts(&block).iter().enumerate() {
                let whole = sums.bounds(Sum::Absolute, level, parts, first);
                if level == 0 && parts.sums.len() == 1 {
                    for limit in [0, whole[0], whole[3], u32::MAX] {
                        let is_excluded = whole.iter().all(|bound| *bound > limit);
                        let found = sums.excluded(Sum::Absolute, parts, (first, LANES), limit);
                        prop_assert_eq!(found, u64::from(is_excluded));
                    }
                }
                for sum in [Sum::Absolute, Sum::Squared] {
                    let bounds = sums.bounds(sum, level, parts, first);
                    for (lane, &bound) in bounds.iter().enumerate() {
                        let mut candidate = Cut::default();
                        candidate.take(&picture, (first.0 + lane as isize, first.1), (width, height), Border::Mirror);
                        let others = Parts::of(&candidate, parts.side);
                        let pairs = || parts.sums.iter().zip(&others.sums).map(|(&a, &b)| u64::from(a.abs_diff(b)));
                        let expected = match sum {
                            Sum::Absolute => pairs().sum::<u64>(),
                            Sum::Squared => pairs().map(|d| d * d).sum::<u64>() / (parts.side * parts.side) as u64,
                        };
                        prop_assert_eq!(u64::from(bound), expected);
                        prop_assert!(bound <= until(sum, &block, &area, (lane, 0), u32::MAX).0);
                    }
                }
            }
        }
    }
}
