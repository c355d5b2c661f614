//! Whether matches determine a fundamental matrix, or lie on a plane: then a homography is the better model by the geometric robust information
//! criterion (P. Torr, Geometric motion segmentation and model selection, Philosophical Transactions of the Royal Society A 356, 1998), and no
//! matches off the plane support the two degrees of freedom of F that the plane leaves open (O. Chum, T. Werner and J. Matas, Two-view geometry
//! estimation unaffected by a dominant plane, CVPR 2005).

use super::Correspondence;
use super::epipolar::sampson_all;
use super::fit::fit;
use super::ransac::{chosen, sample};
use super::refine::least_squares;
use super::robust::Doubt;
use crate::products::model::{HORIZON, Matrix3, Model};

/// Samples of the homography.
const SAMPLES: usize = 60;
/// Rounds of fitting the best homography to the matches that agree with it.
const ROUNDS: usize = 5;
/// Coordinates of a match.
const COORDINATES: f64 = 4.0;
/// Weight λ₃: from λ₃ (r − d) σ² on a squared distance counts as that of an outlier.
const OUTLIER: f64 = 2.0;
/// Smallest standard deviation of a coordinate in px: keypoints are hardly more accurate.
const LEAST_SIGMA_PX: f64 = 0.1;
/// A match is off the plane from this many inlier thresholds and standard deviations, beyond the errors of positions.
const OFF_THRESHOLDS: f64 = 2.0;
const OFF_SIGMAS: f64 = 6.0;
/// A single homography explains the scene if this share of the inliers follows it, and a smaller share of all matches is clearly off it.
const ONE_PLANE: f64 = 0.75;
const FEW_OFF: f64 = 0.1;
/// Matches off the plane that determine F.
const OFF_SAMPLE: usize = 2;

/// A model in the criterion: the dimension of the set of matches that satisfy it, and its number of parameters.
#[derive(Clone, Copy)]
struct Order {
    dimension: f64,
    parameters: f64,
}

const FUNDAMENTAL: Order = Order { dimension: 3.0, parameters: 7.0 };
const HOMOGRAPHY: Order = Order { dimension: 2.0, parameters: 8.0 };

impl Order {
    /// The squared distance in units of σ² at which the robust norm ends.
    fn most(self) -> f64 {
        OUTLIER * (COORDINATES - self.dimension)
    }

    /// Σ min(e²/σ², λ₃ (r − d)) of squared distances.
    fn robust(self, errors: &[f64], sigma_px: f64) -> f64 {
        errors.iter().map(|error| (error / (sigma_px * sigma_px)).min(self.most())).sum()
    }

    /// Σ min(e²/σ², λ₃ (r − d)) + n d ln r + k ln(r n).
    fn criterion(self, errors: &[f64], sigma_px: f64) -> f64 {
        let count = errors.len() as f64;
        let structure = count * self.dimension * COORDINATES.ln();
        self.robust(errors, sigma_px) + structure + self.parameters * (COORDINATES * count).ln()
    }
}

/// A homography and a fundamental matrix compared on the same matches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planarity {
    /// The criterion of the fundamental matrix.
    pub of_fundamental: f64,
    /// The criterion of the homography; the smaller one is the better model.
    pub of_homography: f64,
    /// Share of the inliers of the fundamental matrix that are no outliers of the homography.
    pub share: f64,
    /// Standard deviation of a coordinate in px, from the median distance from the fundamental matrix.
    pub sigma_px: f64,
    /// Number of inliers of the fundamental matrix.
    pub inliers: usize,
    /// Number of those that are no outliers of the homography.
    pub explained: usize,
    /// Number of all matches.
    pub matches: usize,
    /// Number of inliers clearly off the plane, and of all matches clearly off it.
    pub off: [usize; 2],
    /// Whether as many would agree with some fundamental matrix by chance.
    pub is_chance: bool,
}

impl Planarity {
    /// Compares `matrix` with the best of some homographies on its inliers among `matches`, those within the threshold; `None` if they are
    /// fewer than twice the sample of a homography.
    pub fn of(matrix: &Matrix3, matches: &[Correspondence], threshold_px: f64, seed: u64) -> Option<Self> {
        let mut distances = vec![0.0; matches.len()];
        sampson_all(matrix, matches, &mut distances);
        let limit = threshold_px * threshold_px;
        let near: Vec<_> = matches.iter().zip(&distances).filter(|(_, error)| **error <= limit).collect();
        let (inliers, of_matrix): (Vec<Correspondence>, Vec<f64>) = near.into_iter().map(|(m, e)| (*m, *e)).unzip();
        if inliers.len() < 2 * Model::Homography.sample_size() {
            return None;
        }
        let sigma_px = sigma_px(&of_matrix);
        let (plane, errors) = homography(&inliers, sigma_px, seed)?;
        let most = HOMOGRAPHY.most() * sigma_px * sigma_px;
        let on = errors.iter().filter(|error| **error < most).count();
        let off_px = (OFF_THRESHOLDS * threshold_px).max(OFF_SIGMAS * sigma_px);
        let off = |m: &Correspondence| Some(squared_distance(&plane, m).sqrt()).filter(|distance| *distance > off_px);
        let all: Vec<f64> = matches.iter().filter_map(off).collect();
        let agreeing = inliers.iter().filter_map(off).count();
        // A match at this distance from its place on the plane, in any direction, is within the threshold of the line
        // with this probability.
        let chance = |distance: &f64| (threshold_px / distance).min(1.0).asin() * std::f64::consts::FRAC_2_PI;
        let share = all.iter().map(chance).sum::<f64>() / all.len().max(1) as f64;
        Some(Self {
            of_fundamental: FUNDAMENTAL.criterion(&of_matrix, sigma_px),
            of_homography: HOMOGRAPHY.criterion(&errors, sigma_px),
            share: on as f64 / inliers.len() as f64,
            inliers: inliers.len(),
            explained: on,
            matches: matches.len(),
            sigma_px,
            off: [agreeing, all.len()],
            is_chance: Doubt::by_chance(OFF_SAMPLE, [agreeing, all.len()], share).is_some(),
        })
    }

    /// Whether the homography is the better model of the inliers.
    pub fn is_homography_better(&self) -> bool {
        self.of_homography < self.of_fundamental
    }

    /// Whether nearly all matches follow the homography, so that the scene is one plane or the camera only rotated.
    pub fn is_one_plane(&self) -> bool {
        self.share >= ONE_PLANE && (self.off[1] as f64) < FEW_OFF * self.matches as f64
    }

    /// Whether the fundamental matrix is not determined: the homography is the better model, and matches off the plane agree by chance alone.
    pub fn is_plane(&self) -> bool {
        self.is_homography_better() && self.is_chance
    }
}

/// The standard deviation of a coordinate from squared Sampson distances, which have one degree of freedom, by their median.
fn sigma_px(squared: &[f64]) -> f64 {
    /// The inverse of the 75 % quantile of the normal distribution.
    const OF_MEDIAN: f64 = 1.4826;
    let mut squares = squared.to_vec();
    let (_, median, _) = squares.select_nth_unstable_by(squared.len() / 2, f64::total_cmp);
    let freedom = FUNDAMENTAL.parameters;
    let few = 1.0 + 5.0 / (squared.len() as f64 - freedom).max(1.0);
    (OF_MEDIAN * few * median.sqrt()).max(LEAST_SIGMA_PX)
}

/// The homography of least robust sum, and the squared distances of the matches from it.
fn homography(matches: &[Correspondence], sigma_px: f64, seed: u64) -> Option<(Matrix3, Vec<f64>)> {
    let judged = |matrix: Matrix3| -> (f64, Matrix3, Vec<f64>) {
        let errors: Vec<f64> = matches.iter().map(|m| squared_distance(&matrix, m)).collect();
        (HOMOGRAPHY.robust(&errors, sigma_px), matrix, errors)
    };
    let through =
        |iteration: usize| fit(Model::Homography, &chosen(matches, &sample(4, matches.len(), seed, iteration)));
    let all = (0..SAMPLES).filter_map(through).map(judged);
    let (mut least, mut best, mut errors) = all.reduce(|best, other| if other.0 < best.0 { other } else { best })?;
    let limit = HOMOGRAPHY.most() * sigma_px * sigma_px;
    for _ in 0..ROUNDS {
        // Fitted to all that agree, noise of the four points of a sample averages out.
        let near = matches.iter().zip(&errors).filter(|(_, error)| **error < limit);
        let near: Vec<_> = near.map(|(m, _)| *m).collect();
        let Some(next) = least_squares(Model::Homography, &near).map(judged) else { break };
        if next.0 >= least {
            break;
        }
        (least, best, errors) = next;
    }
    Some((best, errors))
}

/// The squared distance in px² from the nearest pair of positions that a homography maps to each other, to first order: eᵀ (I + A Aᵀ)⁻¹ e
/// for the transfer error e and the derivative A of the map. Infinite beyond the horizon.
fn squared_distance(matrix: &Matrix3, Correspondence { from: [x, y], to }: &Correspondence) -> f64 {
    let [a, b, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
    if w <= HORIZON {
        return f64::INFINITY;
    }
    let (u, v) = (a / w, b / w);
    let [p, q] = [0, 1].map(|i| [(matrix[0][i] - u * matrix[2][i]) / w, (matrix[1][i] - v * matrix[2][i]) / w]);
    let [xx, xy, yy] = [1.0 + p[0] * p[0] + q[0] * q[0], p[0] * p[1] + q[0] * q[1], 1.0 + p[1] * p[1] + q[1] * q[1]];
    let [off_x, off_y] = [to[0] - u, to[1] - v];
    (yy * off_x * off_x - 2.0 * xy * off_x * off_y + xx * off_y * off_y) / (xx * yy - xy * xy)
}

#[cfg(test)]
mod tests {
    use super::super::epipolar::least_sampson;
    use super::*;
    use crate::products::model::mapped;
    use crate::synth::random::{gaussian, hash, unit};

    const TILTED: Matrix3 = [[0.76, -0.3, 225.0], [0.33, 1.01, -77.0], [3.5e-4, -1.4e-5, 1.0]];

    /// Matches on a plane, a share of them moved along one direction by up to `parallax_px`; each tenth match has three times the noise.
    fn views(count: usize, (share, parallax_px): (f64, f64), sigma_px: f64) -> Vec<Correspondence> {
        let one = |i: usize| {
            let random = |k: u64| unit(hash(21, i as u64, k));
            let place = [640.0 * random(0), 480.0 * random(1)];
            let [u, v] = mapped(&TILTED, place).expect("before the horizon");
            let by = if (i as f64 + 0.5) < share * count as f64 { parallax_px * (0.2 + 0.8 * random(2)) } else { 0.0 };
            let sigma = if i % 10 == 3 { 3.0 * sigma_px } else { sigma_px };
            let off = |k: u64| sigma * gaussian(hash(22, i as u64, k));
            Correspondence {
                from: [place[0] + off(0), place[1] + off(1)],
                to: [u + by + off(2), v + 0.3 * by + off(3)],
            }
        };
        (0..count).map(one).collect()
    }

    fn compared(matches: &[Correspondence], threshold_px: f64) -> Planarity {
        let matrix = least_sampson(matches).expect("noise determines one");
        Planarity::of(&matrix, matches, threshold_px, 1).expect("enough matches")
    }

    #[test]
    fn a_plane_is_one_at_any_noise() {
        for sigma_px in [0.02, 0.3, 0.6, 1.2] {
            for count in [150, 300, 600] {
                let found = compared(&views(count, (0.0, 0.0), sigma_px), (3.0 * sigma_px).max(1.5));
                assert!(found.is_plane(), "σ {sigma_px} of {count}: {found:?}");
            }
        }
    }

    #[test]
    fn parallax_is_none_even_of_few_matches_before_a_plane() {
        for (share, parallax_px) in [(0.12, 30.0), (0.33, 12.0), (0.5, 12.0), (0.9, 12.0), (0.9, 60.0)] {
            for sigma_px in [0.05, 0.3, 0.5] {
                let found = compared(&views(300, (share, parallax_px), sigma_px), 1.5);
                assert!(!found.is_plane(), "{share} by {parallax_px} px, σ {sigma_px}: {found:?}");
            }
        }
    }

    #[test]
    fn wrong_matches_do_not_make_a_plane_anything_else() {
        let mut all = views(300, (0.0, 0.0), 0.3);
        let matrix = least_sampson(&all).expect("noise determines one");
        for (i, m) in all.iter_mut().enumerate().filter(|(i, _)| i % 4 == 0) {
            m.to = [2, 3].map(|k| 640.0 * unit(hash(23, i as u64, k)));
        }
        let found = Planarity::of(&matrix, &all, 1.5, 1).expect("enough matches");
        assert!(found.is_plane() && found.off[1] > 60 && found.off[0] < 8, "{found:?}");
    }

    #[test]
    fn the_noise_is_that_of_the_coordinates() {
        let found = compared(&views(600, (0.9, 60.0), 0.5), 3.0);
        assert!((0.45..0.65).contains(&found.sigma_px), "{found:?}");
        let exact = compared(&views(600, (0.9, 60.0), 0.0), 3.0);
        assert_eq!(exact.sigma_px, LEAST_SIGMA_PX);
    }

    #[test]
    fn the_distance_from_a_homography_is_that_of_the_nearest_exact_pair() {
        // For a pure translation, half of each coordinate's error belongs to either frame.
        let shift = [[1.0, 0.0, 7.0], [0.0, 1.0, -2.0], [0.0, 0.0, 1.0]];
        let off = Correspondence { from: [10.0, 20.0], to: [17.0 + 0.6, 18.0 - 0.8] };
        assert!((squared_distance(&shift, &off) - 0.5).abs() < 1e-12);
        // Elsewhere the least squared distance over the position in frame t, sampled finely.
        let [x, y] = [400.0, 100.0];
        let to = mapped(&TILTED, [x, y]).expect("before the horizon");
        let off = Correspondence { from: [x, y], to: [to[0] + 0.4, to[1] - 0.2] };
        let cost = |dx: f64, dy: f64| {
            let [u, v] = mapped(&TILTED, [x + dx, y + dy]).expect("before the horizon");
            dx * dx + dy * dy + (off.to[0] - u).powi(2) + (off.to[1] - v).powi(2)
        };
        let step = |i: i32| f64::from(i) * 0.005;
        let least =
            (-80..=80).flat_map(|j| (-80..=80).map(move |i| cost(step(i), step(j)))).fold(f64::INFINITY, f64::min);
        assert!((squared_distance(&TILTED, &off) - least).abs() < 1e-3, "{least}");
        assert_eq!(squared_distance(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 1.0]], &off), f64::INFINITY);
    }
}
