//! The charts of the particle filter.

use super::cloud::{Estimate, Particle, effective};
use super::{Event, ParticleFilter, Resampled};
use crate::geometry::Grid;
use crate::methods::region::{At, plots};
use crate::scene::{BetweenPixels, Picture, Readout, Role, Series, Surface};

/// The most particles that are drawn with their weights.
pub(super) const CIRCLES: usize = 400;

impl ParticleFilter {
    /// The effective sample size over the frames.
    pub(super) fn sizes(&self, at: &At<'_, Self>) -> Option<Readout> {
        let past = at.model.map(|model| &model.effective)?;
        let now = at.events.iter().find_map(|event| match event {
            Event::Counted(_, effective) => Some(*effective),
            _ => None,
        });
        let values: Vec<_> = past.iter().copied().chain(now).enumerate().map(|(i, v)| [(i + 1) as f32, v]).collect();
        (values.len() > 1).then(|| {
            Readout::Series(Series {
                thresholds: vec![("resampling".into(), self.resample_below * self.particles as f32)],
                ..Series::new(
                    "Effective sample size",
                    ["frames since the start", "particles"],
                    values.len(),
                    vec![("effective sample size", Role::Measured, values)],
                )
            })
        })
    }
}

/// The weights of the particles, the heaviest first, as multiples of 1/N: the expected numbers of copies; and the numbers drawn.
pub(super) fn weights(particles: &[Particle], copies: Option<&[u32]>) -> Series {
    let count = particles.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| particles[*b].weight.total_cmp(&particles[*a].weight).then(a.cmp(b)));
    // Only ranks whose expected number can be seen.
    let seen = order.iter().take_while(|i| particles[**i].weight * count as f32 > 0.01).count().clamp(1, count);
    let order = &order[..seen];
    let expected = plots::bars(order.iter().map(|i| particles[*i].weight * count as f32));
    let mut lines = vec![("N w, expected copies", Role::Candidate, expected)];
    if let Some(copies) = copies {
        lines.push(("copies", Role::Best, plots::bars(order.iter().map(|i| copies[*i] as f32))));
    }
    let title = if copies.is_some() { "Copies of each particle" } else { "Weights of the particles" };
    plots::histograms(title, ["particle, by weight", "N w"], lines)
}

/// The cumulative weights of the particles, the heaviest first, and the cumulative shares of their copies: the pointers that fall on a
/// step become the copies of its particle.
pub(super) fn cumulative(resampled: &Resampled) -> Series {
    let count = resampled.before.len();
    let mut order: Vec<usize> = (0..count).collect();
    let weight = |i: usize| resampled.before[i].weight;
    order.sort_by(|a, b| weight(*b).total_cmp(&weight(*a)).then(a.cmp(b)));
    let steps = |share: &dyn Fn(usize) -> f32| {
        let sums = order.iter().scan(0.0, |sum, i| {
            *sum += share(*i);
            Some(*sum)
        });
        plots::bars(sums)
    };
    let copies = |i: usize| resampled.copies[i] as f32 / count as f32;
    let lines = vec![
        ("cumulative weight", Role::Candidate, steps(&weight)),
        ("cumulative copies / N", Role::Best, steps(&copies)),
    ];
    plots::histograms("Cumulative weights", ["particle, by weight", "sum of w"], lines)
}

/// The density that the particles stand for, by normal kernels of the bandwidths of D. W. Scott, Multivariate Density Estimation (1992),
/// for the effective sample size: σ n^(−1/6) along x and along y.
pub(super) fn density(particles: &[Particle]) -> Surface {
    /// Cells along a side.
    const SIDE: usize = 41;
    /// How far the surface reaches, in standard deviations.
    const REACH: f32 = 3.5;
    let Estimate { at: center, covariance, .. } = Estimate::of(particles, &[]);
    let sigma = [0, 1].map(|i| covariance[i][i].max(0.0).sqrt() as f32);
    let reach = REACH * sigma[0].max(sigma[1]).max(1.0);
    let step = 2.0 * reach / SIDE as f32;
    // No narrower than a cell, or it would fall between them.
    let bandwidth = sigma.map(|sigma| (sigma * effective(particles).powf(-1.0 / 6.0)).max(step));
    let normal = |from: f32, i: usize| {
        let share = from / bandwidth[i];
        (-0.5 * share * share).exp() / (bandwidth[i] * std::f32::consts::TAU.sqrt())
    };
    let mut values = Grid::new(SIDE, SIDE, 0.0f32);
    for particle in particles {
        let along = |i: usize| -> [f32; SIDE] {
            std::array::from_fn(|cell| {
                let place = center[i] + step * (cell as f32 - (SIDE / 2) as f32);
                normal(place - particle.at[i], i)
            })
        };
        let (columns, rows) = (along(0), along(1));
        for (cells, down) in values.cells_mut().chunks_exact_mut(SIDE).zip(rows) {
            cells.iter_mut().zip(columns).for_each(|(cell, across)| *cell += particle.weight * down * across);
        }
    }
    let surface = Surface::over_picture(("density", "px⁻²"), (Picture::CURRENT, center, step), values);
    let on_it = |particle: &&Particle| {
        let at = surface.axes.displacement(particle.at);
        surface.interpolated(at).map(|value| BetweenPixels { at, value })
    };
    let between = by_weight(particles).iter().take(CIRCLES).filter_map(on_it).collect();
    Surface { is_similarity: true, between, ..surface }
}

/// The particles, the heaviest first.
pub(super) fn by_weight(particles: &[Particle]) -> Vec<&Particle> {
    let mut order: Vec<&Particle> = particles.iter().collect();
    order.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_sums_to_one_and_is_highest_where_the_particles_are() {
        let particle = |i: usize| {
            let (x, y) = ((i % 20) as f32, (i / 20) as f32);
            // Twice as many at the left.
            Particle {
                at: [40.0 + if i.is_multiple_of(3) { 9.0 } else { 0.0 } + 0.1 * x, 30.0 + 0.2 * y],
                weight: 1.0 / 400.0,
                velocity: [0.0; 2],
                scale: 1.0,
            }
        };
        let particles: Vec<_> = (0..400).map(particle).collect();
        let surface = density(&particles);
        let cell = surface.axes.step * surface.axes.step;
        let sum: f32 = surface.values.cells().iter().map(|value| value * cell).sum();
        assert!((sum - 1.0).abs() < 0.02, "{sum}");
        let (_, at) = surface.optimum().expect("it is known");
        let [x, _] = surface.axes.at(at[0].map(|c| c as f32));
        assert!((40.0..43.0).contains(&x), "{x}");
    }
}
