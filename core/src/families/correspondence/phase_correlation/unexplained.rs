//! The part of the picture that a translation does not explain, judged from the pictures alone.

use crate::geometry::Gray;
use crate::products::model::{IDENTITY, Matrix3};
use crate::products::registration::{gray_at, inside};

/// Side of the blocks that are compared, in px.
const BLOCK: usize = 8;
/// A block whose residual exceeds the change of its gray levels over this many px, beside noise, moves differently or has changed.
const OFF_PX: f64 = 0.75;
const NOISE_LEVELS: f64 = 2.0;
/// The residual must also be this many times that of the blocks that fit well, which have the same noise and exposure.
const CLEARLY: f64 = 2.5;
/// The residual of the blocks that fit well is this quantile of all residuals.
const FITTING: f64 = 0.25;

/// The mean residual of a block and its mean change of gray levels per px.
struct Block {
    residual: f64,
    gradient: f64,
}

/// The share of the blocks that clearly differ from frame t+1 displaced by `by`, among those that lie in both frames; `None` without any.
///
/// Blocks without texture fit any displacement, so the share is a lower bound.
pub fn share([from, to]: [&Gray; 2], [u, v]: [f64; 2]) -> Option<f64> {
    let (width, height) = from.size();
    let mut there = IDENTITY;
    (there[0][2], there[1][2]) = (u, v);
    let corners = (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (BLOCK * x, BLOCK * y)));
    let blocks: Vec<Block> = corners.filter_map(|corner| block([from, to], &there, corner)).collect();
    let mut residuals: Vec<f64> = blocks.iter().map(|block| block.residual).collect();
    residuals.sort_unstable_by(f64::total_cmp);
    let fitting = residuals.get((FITTING * residuals.len() as f64) as usize)?;
    let is_off =
        |block: &&Block| block.residual > OFF_PX * block.gradient + NOISE_LEVELS && block.residual > CLEARLY * fitting;
    Some(blocks.iter().filter(is_off).count() as f64 / blocks.len() as f64)
}

/// The block with this corner, if the displacement keeps it inside the picture.
fn block([from, to]: [&Gray; 2], there: &Matrix3, (x0, y0): (usize, usize)) -> Option<Block> {
    let (width, height) = from.size();
    let (mut residual, mut gradient) = (0.0, 0.0);
    for (x, y) in (y0..y0 + BLOCK).flat_map(|y| (x0..x0 + BLOCK).map(move |x| (x, y))) {
        let level = f64::from(from[(x, y)]);
        let at = inside(there, [x as f64, y as f64], to.size())?;
        residual += (f64::from(gray_at(to, at)) - level).abs();
        let beside = [((x + 1).min(width - 1), y), (x, (y + 1).min(height - 1))];
        gradient += beside.map(|place| (f64::from(from[place]) - level).abs()).into_iter().fold(0.0, f64::max);
    }
    let count = (BLOCK * BLOCK) as f64;
    Some(Block { residual: residual / count, gradient: gradient / count })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    /// A texture of waves about 10 px long.
    fn level(x: f64, y: f64) -> u8 {
        (128.0 + 50.0 * (0.6 * x + 0.2 * y).sin() + 50.0 * (0.5 * y - 0.1 * x).sin()) as u8
    }

    #[test]
    fn only_blocks_that_move_otherwise_are_unexplained() {
        let from = Grid::from_fn(96, 64, |x, y| level(x as f64, y as f64));
        let moved = |by: f64| move |x: usize, y: usize| level(x as f64 - by, y as f64);
        let all = Grid::from_fn(96, 64, moved(2.5));
        assert_eq!(share([&from, &all], [2.5, 0.0]), Some(0.0));
        // The lower quarter rests.
        let part = Grid::from_fn(96, 64, |x, y| if y < 48 { moved(2.5)(x, y) } else { moved(0.0)(x, y) });
        let found = share([&from, &part], [2.5, 0.0]).expect("blocks");
        assert!((0.15..=0.25).contains(&found), "{found}");
        // A picture that is smaller than a block has none.
        let tiny = Grid::from_fn(5, 5, |_, _| 9);
        assert_eq!(share([&tiny, &tiny], [0.0, 0.0]), None);
    }
}
