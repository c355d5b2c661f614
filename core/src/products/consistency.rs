//! The forward–backward check: the forward flow followed by the backward flow should return to the start. A pixel that fails
//! is occluded in the other frame, or its displacement is wrong.

use crate::base::Error;
use crate::data::Flow;
use crate::geometry::Grid;

/// The forward–backward consistency of two flows.
#[derive(Clone, Debug)]
pub struct Consistency {
    /// Forward–backward error |w + w'| of each pixel in px; NaN where a flow is unknown, or leaves the picture.
    pub distance_px: Grid<f32>,
    /// Pixels that fail the check or leave the picture: occluded, or wrongly estimated.
    pub inconsistent: Grid<bool>,
}

/// Precision and recall of the check as an occlusion detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Share of the failing pixels that are occluded; `None` if none fails.
    pub precision: Option<f64>,
    /// Share of the occluded pixels that fail; `None` if none is occluded.
    pub recall: Option<f64>,
}

/// The squared forward–backward error |w + w'|² in px², and its threshold: `share` of the squares of both displacements plus
/// `more_px2`.
pub(crate) fn returned(there: [f32; 2], back: [f32; 2], (share, more_px2): (f32, f32)) -> [f32; 2] {
    let square = |[u, v]: [f32; 2]| u * u + v * v;
    [square([there[0] + back[0], there[1] + back[1]]), share * (square(there) + square(back)) + more_px2]
}

/// Relative part of the threshold: share of the squares of both displacements.
const SHARE: f32 = 0.01;
/// Absolute part of the threshold in px².
const MORE_PX2: f32 = 0.5;

impl Consistency {
    /// The criterion of failure as text; w is the forward displacement, w' the backward one at its end.
    pub fn criterion() -> String {
        format!("|w + w′|² ≥ {SHARE} (|w|² + |w′|²) + {MORE_PX2} px²")
    }

    /// Checks `forward` against `backward`, the flow of the same pair in reverse order.
    ///
    /// A pixel fails where |w + w'|² ≥ 0.01 (|w|² + |w'|²) + 0.5, w' being taken where w leads, between pixels
    /// bilinearly (N. Sundaram, T. Brox, K. Keutzer, Dense point trajectories by GPU-accelerated large displacement
    /// optical flow, ECCV 2010, eq. 5).
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn of(forward: &Flow, backward: &Flow) -> Result<Self, Error> {
        let (width, height) = forward.0.size();
        if backward.0.size() != (width, height) {
            return Err(Error::new("forward and backward flow must have one size"));
        }
        let mut inconsistent = Grid::new(width, height, false);
        let distance_px = Grid::from_fn(width, height, |x, y| {
            let Some([u, v]) = forward.at(x, y) else { return f32::NAN };
            let to = [x as f32 + u, y as f32 + v];
            if !forward.holds(to) {
                inconsistent[(x, y)] = true;
                return f32::NAN;
            }
            let Some(back) = backward.sample(to) else { return f32::NAN };
            let [off, limit] = returned([u, v], back, (SHARE, MORE_PX2));
            inconsistent[(x, y)] = off >= limit;
            off.sqrt()
        });
        Ok(Self { distance_px, inconsistent })
    }

    /// Number of pixels that fail the check.
    pub fn count(&self) -> usize {
        self.inconsistent.cells().iter().filter(|fails| **fails).count()
    }

    /// Compares the failing pixels with the occluded ones of `truth`, over the pixels of known flow.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn against(&self, truth: &Grid<bool>) -> Result<Agreement, Error> {
        if truth.size() != self.inconsistent.size() {
            return Err(Error::new("the occlusion mask must have the size of the flow"));
        }
        let (mut found, mut hidden, mut both) = (0usize, 0usize, 0usize);
        let cells = self.inconsistent.cells().iter().zip(self.distance_px.cells()).zip(truth.cells());
        for ((&is_found, distance), &is_hidden) in cells {
            if !is_found && distance.is_nan() {
                continue;
            }
            found += usize::from(is_found);
            hidden += usize::from(is_hidden);
            both += usize::from(is_found && is_hidden);
        }
        let share = |of: usize| (of > 0).then(|| both as f64 / of as f64);
        Ok(Agreement { precision: share(found), recall: share(hidden) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(f: impl Fn(usize, usize) -> [f32; 2]) -> Flow {
        Flow(Grid::from_fn(12, 6, f))
    }

    #[test]
    fn a_flow_and_its_reverse_agree_and_what_leaves_is_hidden() {
        let check = Consistency::of(&flow(|_, _| [2.5, 0.0]), &flow(|_, _| [-2.5, 0.0])).unwrap();
        for (x, y) in (0..6).flat_map(|y| (0..12).map(move |x| (x, y))) {
            let leaves = x as f32 + 2.5 > 11.5;
            assert_eq!(check.inconsistent[(x, y)], leaves, "{x}, {y}");
            assert!(leaves == check.distance_px[(x, y)].is_nan() && (leaves || check.distance_px[(x, y)] == 0.0));
        }
    }

    #[test]
    fn the_criterion_is_that_of_the_paper() {
        // |w + w'|² = 0.49 and 0.51 for small displacements: the limit is 0.5 and one hundredth of both squares.
        for (off, fails) in [(0.7f32, false), (0.72, true)] {
            let check = Consistency::of(&flow(|_, _| [0.0, 0.0]), &flow(|_, _| [off, 0.0])).unwrap();
            assert!(check.inconsistent.cells().iter().all(|found| *found == fails), "{off}");
        }
        let check = Consistency::of(&flow(|_, _| [4.0, 0.0]), &flow(|_, _| [-3.1, 0.0])).unwrap();
        // 0.81 against 0.01 (16 + 9.61) + 0.5 = 0.756.
        assert!(check.inconsistent[(2, 2)] && (check.distance_px[(2, 2)] - 0.9).abs() < 1e-5);
        assert!(Consistency::of(&flow(|_, _| [0.0; 2]), &Flow(Grid::new(2, 2, [0.0; 2]))).is_err());
    }

    #[test]
    fn what_is_unknown_is_neither_found_nor_counted() {
        let forward = flow(|x, _| if x < 6 { Flow::UNKNOWN } else { [0.0; 2] });
        let backward = flow(|x, _| if x < 9 { [3.0, 0.0] } else { [0.0; 2] });
        let check = Consistency::of(&forward, &backward).unwrap();
        assert_eq!(check.count(), 3 * 6);
        let agreement = |truth: &dyn Fn(usize) -> bool| check.against(&Grid::from_fn(12, 6, |x, _| truth(x))).unwrap();
        assert_eq!(agreement(&|x| x < 8), Agreement { precision: Some(2.0 / 3.0), recall: Some(1.0) });
        assert_eq!(agreement(&|x| x > 7), Agreement { precision: Some(1.0 / 3.0), recall: Some(0.25) });
        assert_eq!(agreement(&|_| false), Agreement { precision: Some(0.0), recall: None });
    }
}
