//! The particles: scattering, prediction, weights, estimate and resampling.

use super::Resampling;
use crate::geometry::Bounds;
use crate::products::Region;
use crate::synth::random::{hash, unit};

/// One hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// The position in px.
    pub at: [f32; 2],
    /// The velocity in px/frame.
    pub velocity: [f32; 2],
    /// The size relative to that in the first frame.
    pub scale: f32,
    /// The weight; the sum of all is 1.
    pub weight: f32,
}

/// The smallest and the largest scale.
const SCALES: [f32; 2] = [0.2, 5.0];

/// The random numbers of a step of the filter.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// The random seed.
    pub seed: u64,
    /// The number of the step.
    pub step: u64,
}

impl Draw {
    fn hash(self, particle: usize, index: u64) -> u64 {
        hash(self.seed, self.step, ((particle as u64) << 4) | index)
    }

    /// A normally distributed number of a particle, by the central limit theorem: the sum of 16 uniform bytes, with an excess
    /// kurtosis of −0.075.
    fn normal(self, particle: usize, index: u64) -> f32 {
        /// The mean and the standard deviation of the sum.
        const SUM: [f32; 2] = [2040.0, 295.601_76];
        let bytes = |h: u64| {
            let pairs = (h & 0x00ff_00ff_00ff_00ff) + ((h >> 8) & 0x00ff_00ff_00ff_00ff);
            (pairs.wrapping_mul(0x0001_0001_0001_0001) >> 48) as u32
        };
        let sum = bytes(self.hash(particle, 2 * index)) + bytes(self.hash(particle, 2 * index + 1));
        (sum as f32 - SUM[0]) / SUM[1]
    }

    /// A uniform number of 0 to 1.
    fn uniform(self, particle: usize) -> f64 {
        unit(self.hash(particle, 15))
    }
}

/// Standard deviations of the motion model.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Of the acceleration in px/frame².
    pub acceleration: f32,
    /// Of the relative change of scale.
    pub scale: f32,
}

/// The first particles: around the centre of a region, at rest.
pub fn scatter(draw: Draw, count: usize, region: Region, spread: f32) -> Vec<Particle> {
    let particle = |i: usize| Particle {
        at: [0, 1].map(|axis| region.center[axis] + spread * region.size[axis] * draw.normal(i, axis as u64)),
        velocity: [0.0; 2],
        scale: 1.0,
        weight: 1.0 / count as f32,
    };
    (0..count).map(particle).collect()
}

/// Moves each particle with its velocity and a random acceleration.
pub fn predict(draw: Draw, noise: Noise, particles: &mut [Particle]) {
    for (i, particle) in particles.iter_mut().enumerate() {
        for axis in 0..2 {
            let acceleration = noise.acceleration * draw.normal(i, axis as u64);
            particle.at[axis] += particle.velocity[axis] + 0.5 * acceleration;
            particle.velocity[axis] += acceleration;
        }
        let growth = 1.0 + noise.scale * draw.normal(i, 2);
        particle.scale = (particle.scale * growth).clamp(SCALES[0], SCALES[1]);
    }
}

/// Divides the weights by their sum; where that is 0 or not finite, all become equal. Returns whether it was sound.
pub fn normalize(particles: &mut [Particle]) -> bool {
    let sum: f32 = particles.iter().map(|particle| particle.weight).sum();
    let count = particles.len() as f32;
    let is_sound = sum > 0.0 && sum.is_finite();
    for particle in particles {
        particle.weight = if is_sound { particle.weight / sum } else { 1.0 / count };
    }
    is_sound
}

/// The effective sample size 1 / Σ w².
pub fn effective(particles: &[Particle]) -> f32 {
    let squares: f32 = particles.iter().map(|particle| particle.weight * particle.weight).sum();
    // Rounding may lead beyond N.
    (1.0 / squares.max(f32::MIN_POSITIVE)).min(particles.len() as f32)
}

/// The box around boxes; none without any.
pub fn bounds(all: impl Iterator<Item = Bounds>) -> Option<Bounds> {
    all.reduce(|a, b| Bounds {
        min: [0, 1].map(|i| a.min[i].min(b.min[i])),
        max: [0, 1].map(|i| a.max[i].max(b.max[i])),
    })
}

/// The weighted mean of the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The position in px.
    pub at: [f32; 2],
    /// The velocity in px/frame.
    pub velocity: [f32; 2],
    /// The scale.
    pub scale: f32,
    /// The Bhattacharyya coefficient of those in the picture.
    pub coefficient: f32,
    /// The covariance of the position in px², by rows.
    pub covariance: [[f64; 2]; 2],
}

impl Estimate {
    /// The estimate from particles, with the coefficient of each.
    pub fn of(particles: &[Particle], coefficients: &[f32]) -> Self {
        let mean = |of: &dyn Fn(&Particle) -> f32| -> f64 {
            particles.iter().map(|particle| f64::from(particle.weight) * f64::from(of(particle))).sum()
        };
        let at = [0, 1].map(|i| mean(&|particle| particle.at[i]));
        let second = |i: usize, j: usize| {
            let off = |particle: &Particle, k: usize| f64::from(particle.at[k]) - at[k];
            particles.iter().map(|particle| f64::from(particle.weight) * off(particle, i) * off(particle, j)).sum()
        };
        let pairs = particles.iter().zip(coefficients).filter(|(_, coefficient)| coefficient.is_finite());
        let coefficient = pairs.map(|(particle, coefficient)| particle.weight * coefficient).sum();
        Self {
            at: at.map(|c| c as f32),
            velocity: [0, 1].map(|i| mean(&|particle| particle.velocity[i]) as f32),
            scale: mean(&|particle| particle.scale) as f32,
            coefficient,
            covariance: [[second(0, 0), second(0, 1)], [second(1, 0), second(1, 1)]],
        }
    }
}

/// A part of a cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its share of the weight.
    pub weight: f64,
    /// Its weighted mean in px.
    pub at: [f64; 2],
}

/// A cloud has two parts if this share of the variance along its main axis lies between them. A normal distribution has 0.64, a uniform
/// one 0.75.
const BETWEEN: f64 = 0.85;
/// The least weight of a part.
const LEAST_PART: f64 = 0.1;

/// The two parts of a cloud farther apart than `least_px`, the heavier first; none where it is one. It is split across its main axis, where
/// the variance between the parts is largest (Otsu 1979).
pub fn parts(particles: &[Particle], least_px: f64) -> Option<[Part; 2]> {
    let Estimate { at: mean, covariance: [[xx, xy], [_, yy]], .. } = Estimate::of(particles, &[]);
    let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    let along =
        |particle: &Particle| f64::from(particle.at[0] - mean[0]) * cos + f64::from(particle.at[1] - mean[1]) * sin;
    let mut order: Vec<&Particle> = particles.iter().collect();
    order.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let variance: f64 = order.iter().map(|particle| f64::from(particle.weight) * along(particle).powi(2)).sum();
    let (mut weight, mut sum, mut best) = (0.0, 0.0, (0.0, 0));
    for (i, particle) in order.iter().enumerate() {
        weight += f64::from(particle.weight);
        sum += f64::from(particle.weight) * along(particle);
        // The mean of all is 0, so that of the rest follows.
        let between = sum * sum / (weight * (1.0 - weight)).max(f64::MIN_POSITIVE);
        if (LEAST_PART..=1.0 - LEAST_PART).contains(&weight) && between > best.0 {
            best = (between, i + 1);
        }
    }
    if best.0 < BETWEEN * variance || best.1 == 0 {
        return None;
    }
    let part = |of: &[&Particle]| {
        let weight: f64 = of.iter().map(|particle| f64::from(particle.weight)).sum();
        let mean = |k: usize| of.iter().map(|p| f64::from(p.weight) * f64::from(p.at[k])).sum::<f64>() / weight;
        Part { weight, at: [mean(0), mean(1)] }
    };
    let (near, far) = order.split_at(best.1);
    let [a, b] = [part(near), part(far)];
    let is_apart = (a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]) > least_px;
    is_apart.then_some(if a.weight >= b.weight { [a, b] } else { [b, a] })
}

/// The pointers of a resampling, in order of their numbers: shares of the sum of all weights, as many as particles.
pub fn pointers(draw: Draw, resampling: Resampling, count: usize) -> impl Iterator<Item = f64> {
    let start = draw.uniform(0);
    (0..count).map(move |i| match resampling {
        Resampling::Systematic => (i as f64 + start) / count as f64,
        Resampling::Multinomial => draw.uniform(i),
    })
}

/// The number of copies of each particle: as many in all as there are particles.
pub fn copies(draw: Draw, resampling: Resampling, particles: &[Particle]) -> Vec<u32> {
    let count = particles.len();
    let mut sum = 0.0;
    let ends: Vec<f64> = particles
        .iter()
        .map(|particle| {
            sum += f64::from(particle.weight);
            sum
        })
        .collect();
    let mut copies = vec![0; count];
    // The sum is 1 but for rounding.
    for share in pointers(draw, resampling, count) {
        copies[ends.partition_point(|end| *end <= share * sum).min(count - 1)] += 1;
    }
    copies
}

/// The copies of the particles, all of the same weight.
pub fn copied(particles: &[Particle], copies: &[u32]) -> Vec<Particle> {
    let weight = 1.0 / particles.len() as f32;
    let all = particles.iter().zip(copies);
    all.flat_map(|(particle, copies)| std::iter::repeat_n(Particle { weight, ..*particle }, *copies as usize)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAW: Draw = Draw { seed: 3, step: 5 };

    fn weights(all: &[f32]) -> Vec<Particle> {
        all.iter().map(|weight| Particle { at: [0.0; 2], velocity: [0.0; 2], scale: 1.0, weight: *weight }).collect()
    }

    #[test]
    fn sums_of_bytes_are_nearly_normal() {
        let all: Vec<f64> = (0..50_000).map(|i| f64::from(DRAW.normal(i, 1))).collect();
        let moment = |power: i32| all.iter().map(|v| v.powi(power)).sum::<f64>() / all.len() as f64;
        assert!(moment(1).abs() < 0.02 && (moment(2) - 1.0).abs() < 0.02 && (moment(4) - 2.925).abs() < 0.1);
        let beyond = all.iter().filter(|v| v.abs() > 1.959_964).count() as f64 / all.len() as f64;
        assert!((beyond - 0.05).abs() < 0.004, "{beyond}");
    }

    #[test]
    fn systematic_copies_differ_from_their_expectation_by_less_than_one() {
        let mut particles = weights(&(1..=40).map(|i| (i * i % 17) as f32).collect::<Vec<_>>());
        normalize(&mut particles);
        for step in 0..50 {
            let copies = copies(Draw { step, ..DRAW }, Resampling::Systematic, &particles);
            assert_eq!(copies.iter().sum::<u32>(), 40);
            for (particle, copies) in particles.iter().zip(&copies) {
                assert!((f64::from(*copies) - 40.0 * f64::from(particle.weight)).abs() < 1.0 + 1e-5);
            }
        }
    }

    /// Copies by walking along the wheel from its start for every pointer (Arulampalam et al. 2002, algorithm 2).
    fn plain(weights: &[f64], pointers: impl Iterator<Item = f64>) -> Vec<u32> {
        let mut copies = vec![0; weights.len()];
        for pointer in pointers {
            let (mut particle, mut end) = (0, weights[0]);
            while pointer >= end && particle + 1 < weights.len() {
                particle += 1;
                end += weights[particle];
            }
            copies[particle] += 1;
        }
        copies
    }

    #[test]
    fn copies_are_those_of_a_walk_along_the_wheel() {
        let mut particles = weights(&(1..=60).map(|i| (i * i % 23) as f32).collect::<Vec<_>>());
        normalize(&mut particles);
        let sum: f64 = particles.iter().map(|particle| f64::from(particle.weight)).sum();
        let shares: Vec<f64> = particles.iter().map(|particle| f64::from(particle.weight) / sum).collect();
        for step in 0..50 {
            let draw = Draw { step, ..DRAW };
            let start = draw.uniform(0);
            let spaced = (0..60).map(|i| (f64::from(i) + start) / 60.0);
            assert_eq!(copies(draw, Resampling::Systematic, &particles), plain(&shares, spaced), "step {step}");
            let spins = (0..60).map(|i| draw.uniform(i));
            assert_eq!(copies(draw, Resampling::Multinomial, &particles), plain(&shares, spins), "step {step}");
        }
    }

    #[test]
    fn multinomial_copies_are_right_on_average_and_vary_more() {
        let mut particles = weights(&[1.0, 2.0, 3.0, 4.0]);
        normalize(&mut particles);
        let steps = 20_000;
        let (mut mean, mut square) = ([0.0; 4], 0.0);
        for step in 0..steps {
            let copies = copies(Draw { step, ..DRAW }, Resampling::Multinomial, &particles);
            copies.iter().enumerate().for_each(|(i, copies)| mean[i] += f64::from(*copies) / steps as f64);
            square += f64::from(copies[3]).powi(2) / steps as f64;
        }
        assert!(
            mean.iter().zip([0.4, 0.8, 1.2, 1.6]).all(|(found, expected)| (found - expected).abs() < 0.03),
            "{mean:?}"
        );
        // N w (1 − w) of a multinomial distribution.
        assert!((square - mean[3] * mean[3] - 0.96).abs() < 0.05);
    }

    #[test]
    fn a_cloud_of_two_modes_has_two_parts() {
        let cloud = |distance: f32| -> Vec<Particle> {
            let mut all = weights(&[1.0; 500]);
            for (i, particle) in all.iter_mut().enumerate() {
                let middle = if i % 5 < 2 { distance } else { 0.0 };
                particle.at = [30.0 + middle + 2.0 * DRAW.normal(i, 0), 40.0 + 2.0 * DRAW.normal(i, 1)];
            }
            normalize(&mut all);
            all
        };
        let [heavy, light] = parts(&cloud(24.0), 10.0).expect("two parts");
        assert!((heavy.weight - 0.6).abs() < 1e-3 && (light.weight - 0.4).abs() < 1e-3, "{heavy:?}, {light:?}");
        assert!((heavy.at[0] - 30.0).abs() < 0.5 && (light.at[0] - 54.0).abs() < 0.5, "{heavy:?}, {light:?}");
        assert_eq!(
            (parts(&cloud(0.0), 0.0), parts(&cloud(24.0), 30.0)),
            (None, None),
            "one part, and two that are near"
        );
    }

    #[test]
    fn weights_without_a_sum_become_equal() {
        let mut particles = weights(&[0.0; 5]);
        assert!(!normalize(&mut particles), "no weight is above 0");
        assert!(particles.iter().all(|particle| particle.weight == 0.2));
        assert!((effective(&particles) - 5.0).abs() < 1e-5);
        let mut one = weights(&[0.0, 7.0, 0.0]);
        assert!(normalize(&mut one));
        assert_eq!(effective(&one), 1.0);
    }
}
