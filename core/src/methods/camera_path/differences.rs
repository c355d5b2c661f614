//! The differences of two frames that a motion registers.

use crate::geometry::Gray;
use crate::products::model::Matrix3;
use crate::products::registration::{gray_at, inside};

/// Absolute differences of two frames in gray levels.
#[derive(Clone, Copy, Debug)]
pub struct Differences {
    /// Their mean.
    pub mean: f64,
    /// Their median.
    pub median: f64,
}

impl Differences {
    fn of(mut all: Vec<f64>) -> Option<Self> {
        let (mean, half) = (all.iter().sum::<f64>() / all.len() as f64, all.len() / 2);
        (!all.is_empty()).then(|| Self { mean, median: *all.select_nth_unstable_by(half, f64::total_cmp).1 })
    }
}

/// The differences of two frames, registered by a motion and as they are, on a lattice of the pixels that both show.
pub fn differences(motion: &Matrix3, [current, next]: [&Gray; 2]) -> Option<[Differences; 2]> {
    /// Distance of the pixels of the lattice.
    const STEP: usize = 3;
    let (width, height) = current.size();
    let lattice = (0..height).step_by(STEP).flat_map(|y| (0..width).step_by(STEP).map(move |x| (x, y)));
    let both = lattice.filter_map(|(x, y)| {
        let to = inside(motion, [x as f64, y as f64], next.size())?;
        let level = f64::from(current[(x, y)]);
        Some(((f64::from(gray_at(next, to)) - level).abs(), (f64::from(next[(x, y)]) - level).abs()))
    });
    let (registered, at_rest): (Vec<_>, Vec<_>) = both.unzip();
    Some([Differences::of(registered)?, Differences::of(at_rest)?])
}
