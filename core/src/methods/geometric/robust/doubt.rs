//! Whether the inliers of a model support it: they must not lie on a line, nor agree by chance.

use std::collections::BTreeSet;

use crate::methods::geometric::Correspondence;

/// Smallest rms distance of inliers from the line that fits them best, in px: about the error of a position.
pub const LEAST_SPREAD_PX: f64 = 1.0;

/// A reason for which a model is not kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// The inliers lie on a line in one of the frames.
    OnLine {
        /// Number of inliers.
        inliers: usize,
        /// Their rms distance from the line in px.
        spread_px: f64,
    },
    /// This many random matches also agree with one of the possible models.
    ByChance {
        /// Number of inliers at distinct positions: several of one point are no further evidence.
        inliers: usize,
        /// The number of them from which on chance is excluded.
        needed: usize,
    },
}

impl Doubt {
    /// Whether inliers lie on a line.
    pub fn on_line(inliers: &[Correspondence]) -> Option<Self> {
        let sides = [spread_px(inliers, |m| m.from), spread_px(inliers, |m| m.to)];
        let spread_px = sides[0].min(sides[1]);
        (spread_px < LEAST_SPREAD_PX).then_some(Self::OnLine { inliers: inliers.len(), spread_px })
    }

    /// Whether this many of all matches agree by chance: the expected number of models through `size` random matches
    /// with as many inliers, the number of false alarms (Moisan and Stival 2004), is 1 or more. A random match is an
    /// inlier with the probability `share`.
    pub fn by_chance(size: usize, [inliers, all]: [usize; 2], share: f64) -> Option<Self> {
        if false_alarms_log(size, [inliers, all], share) < 0.0 {
            return None;
        }
        let needed = (inliers + 1..=all).find(|more| false_alarms_log(size, [*more, all], share) < 0.0);
        Some(Self::ByChance { inliers, needed: needed.unwrap_or(all + 1) })
    }
}

/// The natural logarithm of (N − n) · C(N, k) · C(k, n) · αᵏ⁻ⁿ for k of N matches, samples of n and the probability α.
fn false_alarms_log(n: usize, [k, all]: [usize; 2], share: f64) -> f64 {
    let choose = |of: usize, size: usize| (0..size).map(|i| ((of - i) as f64 / (i + 1) as f64).ln()).sum::<f64>();
    if k < n || k > all {
        return f64::INFINITY;
    }
    // Without another match there is nothing to disagree.
    let tests = ((all - n).max(1) as f64).ln();
    tests + choose(all, k) + choose(k, n) + (k - n) as f64 * share.clamp(1e-12, 1.0).ln()
}

/// The most matches with no position in common: the smaller one of the numbers of positions in both frames. A detector may give a point several
/// keypoints, such as one for each orientation, and their matches determine no more than one of them.
pub fn distinct(points: &[Correspondence]) -> usize {
    let places = |of: fn(&Correspondence) -> [f64; 2]| {
        points.iter().map(|m| of(m).map(f64::to_bits)).collect::<BTreeSet<_>>().len()
    };
    places(|m| m.from).min(places(|m| m.to))
}

/// Width and height of the rectangle around the positions in frame t + 1 in px, each at least 1.
pub fn sides_px(points: &[Correspondence]) -> [f64; 2] {
    [0, 1].map(|i| {
        let along = points.iter().map(|m| m.to[i]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
        (high - low).max(1.0)
    })
}

/// The rms distance of positions from the line that fits them best in px: the root of the smaller eigenvalue of their covariance.
fn spread_px(points: &[Correspondence], of: fn(&Correspondence) -> [f64; 2]) -> f64 {
    let count = points.len().max(1) as f64;
    let mean = [0, 1].map(|i| points.iter().map(|m| of(m)[i]).sum::<f64>() / count);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for m in points {
        let [x, y] = [0, 1].map(|i| of(m)[i] - mean[i]);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let (half, off) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    ((half - off).max(0.0) / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_beside_a_line_have_their_distance_as_spread() {
        let point = |i: usize| {
            let side = if i.is_multiple_of(2) { 0.3 } else { -0.3 };
            // Along (4, 3), to both sides of it.
            let at = [40.0 * i as f64 - 0.6 * side, 30.0 * i as f64 + 0.8 * side];
            Correspondence { from: at, to: [at[0] + 5.0, at[1]] }
        };
        let all: Vec<_> = (0..40).map(point).collect();
        let Some(Doubt::OnLine { inliers: 40, spread_px }) = Doubt::on_line(&all) else { panic!("on a line") };
        assert!((spread_px - 0.3).abs() < 0.01, "{spread_px}");
        let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]].map(|at| Correspondence { from: at, to: at });
        assert_eq!(Doubt::on_line(&square), None);
    }

    #[test]
    fn matches_of_one_point_count_once() {
        let point = |x: f64, y: f64| Correspondence { from: [x, y], to: [x + 2.0, y] };
        let twice = [point(1.0, 2.0), point(1.0, 2.0), point(7.5, 2.0), point(1.0, 3.0)];
        assert_eq!((distinct(&twice), distinct(&twice[1..]), distinct(&[])), (3, 3, 0));
        // Two points of frame t that match one of frame t + 1.
        let joined = [point(1.0, 2.0), Correspondence { from: [9.0, 9.0], ..point(1.0, 2.0) }];
        assert_eq!(distinct(&joined), 1);
    }

    #[test]
    fn few_of_many_agree_by_chance_and_many_do_not() {
        // Within 3 px of a position in 320 × 240 px.
        let share = std::f64::consts::PI * 9.0 / 76_800.0;
        assert_eq!(Doubt::by_chance(4, [60, 80], share), None);
        assert_eq!(Doubt::by_chance(4, [8, 10], share), None);
        let Some(Doubt::ByChance { inliers: 5, needed }) = Doubt::by_chance(4, [5, 40], share) else {
            panic!("5 of 40 may be chance")
        };
        assert!((7..12).contains(&needed), "{needed}");
        // Four matches that the model passes through by construction are no evidence.
        assert!(Doubt::by_chance(4, [4, 4], share).is_some());
        assert_eq!(Doubt::by_chance(1, [2, 2], share), None);
    }
}
