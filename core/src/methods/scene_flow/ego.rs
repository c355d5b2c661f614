//! The motion of the cameras: the rigid motion of the scene in their coordinates, by random sample consensus over points in space.
//!
//! A hypothesis minimises the reprojection error of three points by Gauss–Newton steps from rest (Geiger, Ziegler and Stiller, StereoScan,
//! IEEE Intelligent Vehicles Symposium 2011): pixel and disparity in frame t + 1 against those of R P + t.

use nalgebra::{Matrix6, Vector6};

use crate::base::Error;
use crate::data::{Calibration, Measured, Pose};
use crate::methods::geometric::ransac::{Score, Scoring, sample, samples_needed};
use crate::params;

params! {
    /// Estimation of the motion of the cameras.
    pub struct EgoSettings {
        /// Distance of the pixels on which the motion of the cameras is estimated, along rows and columns.
        spacing: usize = 8, 1..=64, "px";
        /// Largest reprojection error of an inlier: of pixel and disparity in frame t + 1 together.
        threshold: f32 = 1.0, 0.05..=20.0, "px";
        /// Largest number of random samples of three points.
        iterations: usize = 200, 1..=5000;
        /// Random seed of the samples, and of noise that is added to true measurements.
        seed: usize = 1, 0..=9999;
    }
}

/// Number of points that determine a rigid motion.
pub const FEWEST: usize = 3;
/// Probability with which a sample without outliers shall have been drawn.
const CONFIDENCE: f64 = 0.999;
/// Gauss–Newton steps of a hypothesis.
const STEPS: usize = 6;
/// Rounds of the final fit.
const ROUNDS: usize = 4;

/// A rigid motion with its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The motion of the scene in the coordinates of the left camera.
    pub pose: Pose,
    /// Its inliers and errors.
    pub score: Score,
}

impl Fit {
    /// Root mean square reprojection error of the inliers in px.
    pub fn rms_px(&self) -> f64 {
        (self.score.squared / self.score.inliers.max(1) as f64).sqrt()
    }
}

/// A step of the estimation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Indices of the points of the sample; `None` for a round of the final fit.
    pub sample: Option<[u32; FEWEST]>,
    /// The fit; `None` if the points determine none.
    pub fit: Option<Fit>,
    /// The best fit so far.
    pub best: Option<Fit>,
    /// Number of samples drawn so far.
    pub drawn: usize,
    /// Number of samples that are needed with the best fit so far.
    pub needed: usize,
}

/// The points on which the motion of the cameras is estimated.
#[derive(Clone, Debug)]
pub struct Ego<'a> {
    rig: &'a Calibration,
    points: &'a [Measured],
    settings: &'a EgoSettings,
    /// The position of each point in frame t in m, if it is finite.
    positions: Vec<Option<[f64; 3]>>,
}

/// The result of the estimation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Consensus {
    /// The final fit, if there is one.
    pub fit: Option<Fit>,
    /// Number of samples drawn.
    pub drawn: usize,
    /// Number of points.
    pub points: usize,
    /// The 6×6 covariance of rotation in rad and translation in m, row by row, for errors as large as those of the inliers.
    pub covariance: Option<[[f64; 6]; 6]>,
}

/// The Gauss–Newton system of a set of points.
struct System {
    normal: Matrix6<f64>,
    right: Vector6<f64>,
}

impl<'a> Ego<'a> {
    /// Prepares the estimation from measured `points`.
    pub fn new(rig: &'a Calibration, points: &'a [Measured], settings: &'a EgoSettings) -> Self {
        let positions = points.iter().map(|point| rig.point_m(point.pixel, point.disparity)).collect();
        Self { rig, points, settings, positions }
    }

    /// Estimates the motion, and reports each sample and each round of the final fit to `tell`.
    ///
    /// # Errors
    /// The error of `wanted`, which is called before each of them.
    pub fn estimate(
        &self,
        wanted: impl Fn() -> Result<(), Error>,
        mut tell: impl FnMut(Draw),
    ) -> Result<Consensus, Error> {
        let count = self.points.len();
        let mut found = Consensus { points: count, ..Consensus::default() };
        if count < FEWEST {
            return Ok(found);
        }
        let (mut best, mut needed) = (None::<Fit>, self.settings.iterations);
        while found.drawn < needed.min(self.settings.iterations) {
            wanted()?;
            let drawn = sample(FEWEST, count, self.settings.seed as u64, found.drawn);
            found.drawn += 1;
            let fit = self.fitted(&drawn, Pose::IDENTITY);
            if let Some(fit) = fit.filter(|fit| best.is_none_or(|best| fit.score.is_better(&best.score))) {
                best = Some(fit);
                let share = fit.score.inliers as f64 / count as f64;
                needed = samples_needed(share, FEWEST, CONFIDENCE, self.settings.iterations).count;
            }
            let sample = Some([0, 1, 2].map(|i| drawn[i] as u32));
            tell(Draw { sample, fit, best, drawn: found.drawn, needed });
        }
        for _ in 0..ROUNDS {
            wanted()?;
            let Some(before) = best else { break };
            let inliers = self.inliers(&before.pose);
            let fit = self.fitted(&inliers, before.pose);
            let is_better = fit.is_some_and(|fit| fit.score.is_better(&before.score));
            if is_better {
                best = fit;
            }
            tell(Draw { sample: None, fit, best, drawn: found.drawn, needed });
            if !is_better {
                break;
            }
        }
        found.fit = best.filter(|best| best.score.inliers >= FEWEST);
        found.covariance = found.fit.and_then(|fit| self.covariance(&fit));
        Ok(found)
    }

    /// The indices of the points whose reprojection error is at most the threshold.
    pub fn inliers(&self, pose: &Pose) -> Vec<usize> {
        let limit = f64::from(self.settings.threshold).powi(2);
        (0..self.points.len()).filter(|i| self.squared_error(pose, *i) <= limit).collect()
    }

    /// Minimises the reprojection error of the points of these indices, from `start`; scored by all points.
    fn fitted(&self, indices: &[usize], start: Pose) -> Option<Fit> {
        let mut pose = start;
        for _ in 0..STEPS {
            let System { normal, right } = self.system(&pose, indices)?;
            let step = normal.cholesky()?.solve(&right);
            let vector = |from: usize| [0, 1, 2].map(|i| step[from + i]);
            pose = pose.after([vector(0), vector(3)]);
            if step.norm() < 1e-9 {
                break;
            }
        }
        let is_finite = pose.translation.iter().chain(pose.rotation.as_flattened()).all(|c| c.is_finite());
        let score = || {
            let errors: Vec<f64> = (0..self.points.len()).map(|i| self.squared_error(&pose, i)).collect();
            Score::of(&errors, f64::from(self.settings.threshold), Scoring::Msac)
        };
        is_finite.then(|| Fit { pose, score: score() })
    }

    /// The difference of what is measured in frame t + 1 from the point moved by `pose`, in px: pixel and disparity.
    fn residual(&self, pose: &Pose, index: usize) -> Option<([f64; 3], [f64; 3])> {
        let measured = &self.points[index];
        let moved = pose.moved(self.positions[index]?);
        let ([x, y], disparity) = self.rig.project(moved)?;
        let [to_x, to_y] = measured.next_pixel();
        Some(([to_x - x, to_y - y, measured.next_disparity - disparity], moved))
    }

    fn squared_error(&self, pose: &Pose, index: usize) -> f64 {
        self.residual(pose, index).map_or(f64::INFINITY, |(error, _)| error.iter().map(|e| e * e).sum())
    }

    /// Normal equations for a rotation and a translation after `pose`; `None` if a point is behind the cameras.
    fn system(&self, pose: &Pose, indices: &[usize]) -> Option<System> {
        let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
        let Calibration { focal_px: f, baseline_m: b, .. } = *self.rig;
        for &index in indices {
            let (error, [x, y, z]) = self.residual(pose, index)?;
            // Rows: the derivative of x, y and d with respect to the moved point.
            let by_point =
                [[f / z, 0.0, -f * x / (z * z)], [0.0, f / z, -f * y / (z * z)], [0.0, 0.0, -f * b / (z * z)]];
            let [tx, ty, tz] = pose.translation;
            let turned = [x - tx, y - ty, z - tz];
            for (row, error) in by_point.iter().zip(error) {
                // ω × q moves the point, so the derivative with respect to ω is q × row.
                let cross = |i: usize| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    turned[j] * row[k] - turned[k] * row[j]
                };
                let slope = Vector6::new(cross(0), cross(1), cross(2), row[0], row[1], row[2]);
                normal += slope * slope.transpose();
                right += slope * error;
            }
        }
        Some(System { normal, right })
    }

    /// The covariance of a fit: σ² (JᵀJ)⁻¹ with the variance of the residuals.
    fn covariance(&self, fit: &Fit) -> Option<[[f64; 6]; 6]> {
        let inliers = self.inliers(&fit.pose);
        let freedom = (3 * inliers.len()).checked_sub(6).filter(|freedom| *freedom > 0)?;
        let inverse = self.system(&fit.pose, &inliers)?.normal.try_inverse()?;
        let variance = fit.score.squared / freedom as f64;
        Some(std::array::from_fn(|i| std::array::from_fn(|j| variance * inverse[(i, j)])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::random::{hash, unit};

    fn rig() -> Calibration {
        Calibration::new(300.0, 0.5, [159.5, 119.5]).unwrap()
    }

    /// Points of a scene that moves rigidly, every `nth` of them by itself.
    fn points(ego: &Pose, nth: usize, noise_px: f64) -> Vec<Measured> {
        let random = |i: usize, k: u64| unit(hash(5, i as u64, k)) - 0.5;
        let one = |i: usize| {
            let at = [8.0 * random(i, 0), 3.0 * random(i, 1), 9.0 + 10.0 * random(i, 2)];
            let off = if i.is_multiple_of(nth) { 0.5 } else { 0.0 };
            let [x, y, z] = ego.moved(at);
            let [(pixel, d), (to, next)] = [at, [x + off, y, z + off]].map(|at| rig().project(at).unwrap());
            let noisy = |value: f64, k: u64| value + noise_px * random(i, k) * 12f64.sqrt();
            Measured {
                pixel,
                disparity: noisy(d, 3),
                flow: [noisy(to[0] - pixel[0], 4), noisy(to[1] - pixel[1], 5)],
                next_disparity: noisy(next, 6),
            }
        };
        (0..600).map(one).collect()
    }

    fn off(found: &Pose, ego: &Pose) -> [f64; 2] {
        let [rotation, translation] = ego.motion_to(found);
        [rotation, translation].map(|c| c.iter().map(|c| c * c).sum::<f64>().sqrt())
    }

    #[test]
    fn the_motion_is_exact_without_noise_and_within_its_covariance_with_it() {
        let ego = Pose::IDENTITY.after([[0.004, -0.02, 0.003], [0.06, -0.01, -0.35]]);
        let settings = EgoSettings::default();
        let rig = rig();
        let estimate = |points: &[Measured]| Ego::new(&rig, points, &settings).estimate(|| Ok(()), |_| {}).unwrap();
        let exact = estimate(&points(&ego, 4, 0.0));
        let fit = exact.fit.unwrap();
        assert!(off(&fit.pose, &ego).iter().all(|off| *off < 1e-9), "{:?}", off(&fit.pose, &ego));
        assert_eq!((fit.score.inliers, exact.points), (450, 600));
        let noisy = estimate(&points(&ego, 4, 0.2));
        let (fit, covariance) = (noisy.fit.unwrap(), noisy.covariance.unwrap());
        let [rotation, translation] = off(&fit.pose, &ego);
        let sigma = |from: usize| (0..3).map(|i| covariance[from + i][from + i]).sum::<f64>().sqrt();
        assert!(rotation < 3.0 * sigma(0) && translation < 3.0 * sigma(3), "{rotation} {translation}");
        assert!(translation < 0.02 && sigma(3) < 0.02);
    }

    #[test]
    fn too_few_points_give_no_motion() {
        let (all, rig) = (points(&Pose::IDENTITY, 7, 0.0), rig());
        let settings = EgoSettings::default();
        for count in 0..FEWEST {
            let mut told = 0;
            let found = Ego::new(&rig, &all[..count], &settings).estimate(|| Ok(()), |_| told += 1).unwrap();
            assert_eq!((found.fit, told, found.points), (None, 0, count));
        }
        // Three copies of a point determine none.
        let same = [all[1]; 3];
        assert_eq!(Ego::new(&rig, &same, &settings).estimate(|| Ok(()), |_| {}).unwrap().fit, None);
        let cancelled = || Err(Error::new("not wanted"));
        assert!(Ego::new(&rig, &all, &settings).estimate(cancelled, |_| {}).is_err());
    }
}
