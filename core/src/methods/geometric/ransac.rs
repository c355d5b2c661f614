//! Random sample consensus (Fischler and Bolles 1981): hypotheses from minimal samples, scored by the correspondences that agree.

use super::Correspondence;
use crate::base::wide::wide;
use crate::choices;
use crate::synth::random::hash;

choices! {
    /// Score of a hypothesis.
    pub enum Scoring {
        /// RANSAC: the number of inliers.
        Ransac = "ransac" "RANSAC",
        /// MSAC (Torr and Zisserman 2000): the sum of squared errors, each at most the squared threshold, so that better inliers count more.
        Msac = "msac" "MSAC",
        /// LO-RANSAC (Chum, Matas and Kittler 2003): each new best hypothesis is refitted to its inliers before the next sample, and the last one to random samples of them. Scored as MSAC (Lebeda, Matas and Chum 2012).
        LoRansac = "lo-ransac" "LO-RANSAC",
    }
}

/// The inliers of a hypothesis and its score, smaller being better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Number of correspondences within the threshold.
    pub inliers: usize,
    /// The score by which hypotheses are compared: minus the number of inliers, or a sum of limited squared errors in px².
    pub cost: f64,
    /// Sum of the squared errors of the inliers in px².
    pub squared: f64,
}

impl Score {
    /// Scores the squared errors of all correspondences.
    pub fn of(errors: &[f64], threshold_px: f64, scoring: Scoring) -> Self {
        let limit = threshold_px * threshold_px;
        let [inliers, squared] = sums(errors, limit);
        let inliers = inliers as usize;
        let limited = squared + limit * (errors.len() - inliers) as f64;
        let cost = if scoring == Scoring::Ransac { -(inliers as f64) } else { limited };
        Self { inliers, cost, squared }
    }

    /// The sum of the squared errors of all `count` correspondences, each at most `limit`, in px².
    pub fn limited(&self, limit: f64, count: usize) -> f64 {
        self.squared + limit * (count - self.inliers) as f64
    }

    /// Whether it is better than another; of equal ones, the one with the smaller errors.
    pub fn is_better(&self, than: &Self) -> bool {
        self.cost < than.cost || (self.cost == than.cost && self.squared < than.squared)
    }
}

wide! {
    /// The number of errors up to a limit, and their sum.
    fn sums(errors: &[f64], limit: f64) -> [f64; 2] = sums_body
}

#[inline(always)]
fn sums_body(errors: &[f64], limit: f64) -> [f64; 2] {
    const LANES: usize = 16;
    let mut lanes = [[0.0; LANES]; 2];
    let (chunks, rest) = errors.as_chunks::<LANES>();
    let mut last = [f64::INFINITY; LANES];
    last[..rest.len()].copy_from_slice(rest);
    for errors in chunks.iter().chain([&last]) {
        for i in 0..LANES {
            let is_inlier = errors[i] <= limit;
            lanes[0][i] += if is_inlier { 1.0 } else { 0.0 };
            lanes[1][i] += if is_inlier { errors[i] } else { 0.0 };
        }
    }
    lanes.map(|lanes| lanes.iter().sum())
}

/// A number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// The number.
    pub count: usize,
    /// Whether it is the maximum, and more would be needed.
    pub is_limited: bool,
}

/// Number of samples after which one without outliers was drawn with probability `confidence`, for a share of inliers: log(1 − p) / log(1 −
/// wⁿ). At most `most`.
pub fn samples_needed(share: f64, sample_size: usize, confidence: f64, most: usize) -> Samples {
    let all_inliers = share.powi(sample_size as i32);
    if all_inliers >= 1.0 {
        return Samples { count: 1, is_limited: false };
    }
    let count = (1.0 - confidence).ln() / (1.0 - all_inliers).ln();
    let is_limited = !(count.is_finite() && count <= most as f64);
    Samples { count: if is_limited { most } else { (count.ceil() as usize).max(1) }, is_limited }
}

/// The sample of an iteration: `size` different indices below `count`, drawn from a hash of the seed and the iteration.
pub fn sample(size: usize, count: usize, seed: u64, iteration: usize) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(size);
    let mut attempt = 0u64;
    while drawn.len() < size.min(count) {
        let index = (hash(seed, iteration as u64, attempt) % count as u64) as usize;
        attempt += 1;
        if !drawn.contains(&index) {
            drawn.push(index);
        }
    }
    drawn
}

/// The correspondences of these indices.
pub fn chosen(matches: &[Correspondence], indices: &[usize]) -> Vec<Correspondence> {
    indices.iter().map(|index| matches[*index]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_samples_is_that_of_the_book() {
        // Hartley and Zisserman 2004, table 4.3, p = 0.99.
        for (size, share, expected) in [(2, 0.5, 17), (4, 0.5, 72), (4, 0.7, 17), (7, 0.6, 163), (8, 0.5, 1177)] {
            assert_eq!(samples_needed(share, size, 0.99, 100_000).count, expected, "{size}, {share}");
        }
        assert_eq!(samples_needed(1.0, 4, 0.99, 500), Samples { count: 1, is_limited: false });
        assert_eq!(samples_needed(0.0, 4, 0.99, 500), Samples { count: 500, is_limited: true });
    }

    #[test]
    fn samples_have_no_index_twice_and_repeat_with_the_seed() {
        for iteration in 0..200 {
            let drawn = sample(4, 6, 7, iteration);
            let mut sorted = drawn.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert!(sorted.len() == 4 && sorted.iter().all(|index| *index < 6));
            assert_eq!(drawn, sample(4, 6, 7, iteration));
        }
        assert_ne!(sample(4, 600, 7, 0), sample(4, 600, 8, 0));
        assert_eq!(sample(4, 3, 7, 0).len(), 3);
    }

    #[test]
    fn msac_prefers_the_better_inliers() {
        let [near, far] = [[0.1, 0.2, 50.0], [3.0, 3.5, 50.0]];
        let score = |errors: [f64; 3], scoring| Score::of(&errors, 2.0, scoring);
        for scoring in [Scoring::Ransac, Scoring::Msac, Scoring::LoRansac] {
            assert!(score(near, scoring).is_better(&score(far, scoring)));
            assert_eq!(score(near, scoring).inliers, 2);
        }
        // Three mediocre inliers beat two good ones only by their number.
        let many = [3.9, 3.9, 3.9];
        assert!(score(many, Scoring::Ransac).is_better(&score(near, Scoring::Ransac)));
        assert!(score(near, Scoring::Msac).is_better(&score(many, Scoring::Msac)));
    }
}
