//! The decision on a pixel: minimum, uniqueness, left–right check and parabola.

use super::Settings;

/// The outcome of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// It has a disparity.
    #[default]
    Accepted,
    /// Another disparity costs hardly more.
    Ambiguous,
    /// The right view prefers another disparity at the matched pixel.
    Inconsistent,
}

/// The result at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept {
    /// Disparity in px; NaN where it was rejected.
    pub disparity: f32,
    /// The outcome.
    pub verdict: Verdict,
}

/// The minimum of the costs along an epipolar line, and its strongest rival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Minimum {
    /// Its disparity.
    pub at: usize,
    /// Its cost.
    pub cost: u32,
    /// The disparity and the cost of the lowest of all others but its neighbours, if there are any.
    pub rival: Option<(usize, u32)>,
}

/// The minimum of costs; of several the first.
pub(crate) fn smallest(costs: &[u32]) -> Minimum {
    let least = |range: std::ops::Range<usize>| range.map(|d| (costs[d], d)).min();
    let (cost, at) = least(0..costs.len()).unwrap_or_default();
    let below = least(0..at.saturating_sub(1));
    let above = least((at + 2).min(costs.len())..costs.len());
    let rival = below.into_iter().chain(above).min().map(|(cost, d)| (d, cost));
    Minimum { at, cost, rival }
}

/// The outcome for a minimum cost, the cost of its rival, and the difference of its disparity from that of the right view.
#[inline(always)]
pub(crate) fn accept(settings: &Settings, cost: u32, rival: Option<u32>, difference: usize) -> Verdict {
    let limit = u64::from(cost) * (100 + settings.uniqueness as u64);
    match rival {
        Some(rival) if settings.uniqueness > 0 && 100 * u64::from(rival) <= limit => Verdict::Ambiguous,
        _ if difference > settings.max_difference => Verdict::Inconsistent,
        _ => Verdict::Accepted,
    }
}

/// The vertex of the parabola through three costs relative to the middle one, the lowest, in px: −0.5 to 0.5.
#[inline(always)]
pub(crate) fn vertex([before, at, after]: [u32; 3]) -> f32 {
    let [before, at, after] = [before, at, after].map(f64::from);
    let bend = before - 2.0 * at + after;
    if bend > 0.0 { ((before - after) / (2.0 * bend)) as f32 } else { 0.0 }
}

/// The minima of a row of pixels of both views, from the costs of the left one.
#[derive(Debug, Default)]
pub(crate) struct Winners {
    /// For each pixel of the left view, the disparity of lowest cost.
    pub left: Vec<u16>,
    /// The same for the right view: the lowest cost of the pixels of the left view that it may correspond to.
    pub right: Vec<u16>,
}

impl Winners {
    /// Difference of the disparities of pixel `x` of the left view and of its match.
    #[inline(always)]
    pub fn difference(&self, x: usize) -> usize {
        let found = self.left[x];
        usize::from(found.abs_diff(self.right[x - usize::from(found)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_the_minimum_are_no_rivals() {
        let minimum = smallest(&[9, 5, 3, 4, 8, 3, 7]);
        assert_eq!(minimum, Minimum { at: 2, cost: 3, rival: Some((5, 3)) });
        assert_eq!(smallest(&[4, 3]).rival, None);
        assert_eq!(smallest(&[5, 2, 2, 9]).rival, Some((3, 9)));
    }

    #[test]
    fn a_match_is_unique_and_agrees_with_the_right_view() {
        let settings = Settings { uniqueness: 10, max_difference: 1, ..Settings::default() };
        assert_eq!(accept(&settings, 100, Some(111), 1), Verdict::Accepted);
        assert_eq!(accept(&settings, 100, Some(110), 0), Verdict::Ambiguous);
        assert_eq!(accept(&settings, 100, None, 2), Verdict::Inconsistent);
        assert_eq!(accept(&settings, 0, Some(0), 0), Verdict::Ambiguous, "without texture all costs are equal");
        assert_eq!(accept(&Settings { uniqueness: 0, ..settings }, 0, Some(0), 0), Verdict::Accepted);
    }

    #[test]
    fn the_vertex_is_that_of_the_parabola() {
        // 10 (d − 0.25)² + 3, times 16.
        let cost = |d: f64| (16.0 * (10.0 * (d - 0.25) * (d - 0.25) + 3.0)) as u32;
        assert_eq!(vertex([-1.0, 0.0, 1.0].map(cost)), 0.25);
        assert_eq!([vertex([5, 5, 5]), vertex([5, 5, 9]), vertex([9, 5, 5])], [0.0, -0.5, 0.5]);
    }
}
