//! The explanation and the drawing of the particle filter.

use super::charts::{CIRCLES, by_weight, cumulative, density, weights};
use super::cloud::{Estimate, Particle, parts};
use super::vocabulary::{case, value};
use super::wheel::wheel;
use super::{Event, ParticleFilter, Resampled, Resampling, Weighed};
use crate::methods::kalman;
use crate::methods::region::vocabulary::case as shared;
use crate::methods::region::{At, Ending, Explained, Outcome, plots};
use crate::products::Region;
use crate::scene::{Arrow, Picture, Readout, Role, Scene, Shape, Step};

/// The radius of a particle of mean weight in px, and the smallest and largest of all.
const RADIUS_PX: [f32; 3] = [1.5, 0.4, 8.0];
/// The share of the particles inside the drawn ellipse, if they are normally distributed.
const CONFIDENCE: f64 = 0.95;

/// A cloud is impoverished if fewer than one in this many of its particles are distinct.
const POOR: usize = 10;

impl Explained for ParticleFilter {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let step = self.tell_event(at, step);
        let density = particles(at.event).map(|particles| Readout::Landscape(density(particles)));
        step.show_all(self.sizes(at)).show_all(density)
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        match at.event {
            Event::Modelled(_) => plots::ellipse(scene, (Role::Candidate, "ellipse of the histogram"), at.region),
            Event::Scattered(particles) => dots(scene, (Role::Predicted, "particles"), particles),
            Event::Predicted(particles) => {
                dots(scene, (Role::Predicted, "predicted particles"), particles);
                moves(scene, at, particles);
            }
            Event::Weighed(weighed) => circles(scene, &weighed.particles),
            Event::Counted(particles, _) => circles(scene, particles),
            Event::Estimated(particles, estimate) => {
                circles(scene, particles);
                let center = estimate.at.map(f64::from);
                if let Some(shape) = kalman::ellipse(center, estimate.covariance, CONFIDENCE) {
                    scene.draw(Picture::CURRENT, (Role::Estimate, "estimate with 95 % ellipse"), shape);
                }
                let size = at.model.map_or(at.region.size, |model| model.size).map(|side| side * estimate.scale);
                let Region { angle_rad, .. } = at.region;
                let bounds = Region { center: estimate.at, size, angle_rad }.bounds();
                scene.mark(Picture::CURRENT, Role::Estimate, Shape::Rect { min: bounds.min, max: bounds.max });
            }
            Event::Resampled(resampled) => dots(scene, (Role::Best, "particles drawn"), &resampled.after),
        }
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        step.say_if(are_outside(at), case::WEIGHTLESS)
    }

    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step {
        step.say(match ending.outcome {
            _ if are_outside(at) => case::ALL_OUTSIDE,
            Outcome::Followed if ending.hidden > 0 => case::FOLLOWED_HIDDEN,
            Outcome::Followed => case::FOLLOWED,
            Outcome::Regained => case::REGAINED,
            Outcome::Grown | Outcome::Shrunk => case::RESIZED,
            Outcome::Beside | Outcome::Unknown => case::BESIDE,
            Outcome::Lost => case::LOST,
        })
    }
}

impl ParticleFilter {
    fn tell_event(&self, at: &At<'_, Self>, step: Step) -> Step {
        match at.event {
            Event::Modelled(histogram) => {
                let step = plots::put_bins(step, histogram).say(case::MODELLED);
                let bins = histogram.largest(plots::BARS);
                let line = plots::bars(bins.iter().map(|bin| histogram.shares[*bin]));
                let axes = ["largest bins of the model", "share"];
                let chart = plots::histograms("Colour histogram", axes, vec![("model q", Role::Reference, line)]);
                step.say_if(histogram.is_flat(), shared::FLAT).show(Readout::Series(chart))
            }
            Event::Scattered(particles) => put_spread(step, particles).say(case::SCATTERED),
            Event::Predicted(particles) => {
                let step =
                    put_spread(step, particles).put(value::PROCESS_NOISE, self.process_noise).say(case::PREDICTED);
                step.formula(r"\mathbf{x} \gets \mathbf{x} + \mathbf{v} + \frac{1}{2} \mathbf{a}, \; \mathbf{v} \gets \mathbf{v} + \mathbf{a}")
            }
            Event::Weighed(weighed) => {
                let step = self
                    .tell_weights(step, weighed)
                    .formula(r"w \gets w \cdot e^{-\lambda (1 - \rho)} = w \cdot e^{-{lambda} (1 - \rho)}");
                step.show(Readout::Series(weights(&weighed.particles, None)))
            }
            Event::Estimated(particles, estimate) => {
                let step = step.fact(value::ESTIMATE, estimate.at).fact(value::VELOCITY, estimate.velocity);
                let step = step.fact(value::SCALE, estimate.scale).fact(value::DEVIATIONS, deviations(estimate));
                let step = step.put(value::CONFIDENCE, 100.0 * CONFIDENCE).say(case::ESTIMATED);
                let step = two_parts(at, step, particles).formula(r"\text{estimate} = \sum_i w_i \mathbf{x}_i");
                step.show(Readout::Series(weights(particles, None)))
            }
            Event::Counted(particles, effective) => {
                let limit = self.least_effective(particles);
                let step = step.fact(value::EFFECTIVE, *effective).fact(value::PARTICLES, particles.len());
                let step = step.put(value::LIMIT, limit).say(case::COUNTED);
                let step = step.say(if *effective < limit { case::DEGENERATE } else { case::KEPT });
                let step = step.formula(r"N_{\text{eff}} = \frac{1}{\sum_i w_i^2} = {effective}");
                step.show(Readout::Series(weights(particles, None)))
            }
            Event::Resampled(resampled) => self.tell_resampling(step, resampled),
        }
    }

    fn tell_weights(&self, step: Step, weighed: &Weighed) -> Step {
        let Weighed { particles, coefficients, outside, is_weighted } = weighed;
        let step = step.fact(value::OUTSIDE, *outside).put(value::PARTICLES, particles.len());
        let step = step.put(value::LAMBDA, self.lambda);
        if !is_weighted {
            return step.put(value::EQUAL_WEIGHT, 1.0 / particles.len() as f64).say(case::NO_WEIGHT);
        }
        let best = coefficients.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let worst = coefficients.iter().copied().filter(|c| c.is_finite()).fold(f32::INFINITY, f32::min);
        let step = step.put(value::BEST, best).put(value::WORST, worst).say(case::WEIGHED);
        let ratio = f64::from(self.lambda * (best - worst)).exp();
        step.put(value::LIKELIHOOD_RATIO, ratio).say_if(*outside > 0, case::SOME_OUTSIDE).say(case::LIKELIHOOD_RATIO)
    }

    fn tell_resampling(&self, step: Step, resampled: &Resampled) -> Step {
        let Resampled { before, copies, .. } = resampled;
        let distinct = copies.iter().filter(|copies| **copies > 0).count();
        let step = step.fact(value::DISTINCT, distinct).put(value::PARTICLES, copies.len());
        let step = step.put(value::MOST_COPIES, copies.iter().max().copied().unwrap_or(0)).say(match self.resampling {
            Resampling::Systematic => case::SYSTEMATIC,
            Resampling::Multinomial => case::MULTINOMIAL,
        });
        let is_poor = POOR * distinct < copies.len();
        let step = step.say(case::SURVIVORS).say(if is_poor { case::IMPOVERISHED } else { case::EQUAL_WEIGHTS });
        let step = step.show(Readout::Diagram(wheel(resampled, self.resampling)));
        step.show(Readout::Series(cumulative(resampled))).show(Readout::Series(weights(before, Some(copies))))
    }
}

/// The standard deviations along x and y.
fn deviations(estimate: &Estimate) -> [f64; 2] {
    [0, 1].map(|i| estimate.covariance[i][i].max(0.0).sqrt())
}

/// Puts the number and the standard deviations of particles of equal weight.
fn put_spread(step: Step, particles: &[Particle]) -> Step {
    step.put(value::PARTICLES, particles.len()).put(value::DEVIATIONS, deviations(&Estimate::of(particles, &[])))
}

/// Tells of a cloud with two parts, farther apart than half the object.
fn two_parts(at: &At<'_, ParticleFilter>, step: Step, particles: &[Particle]) -> Step {
    let size = at.model.map_or(at.region.size, |model| model.size);
    let Some([heavy, light]) = parts(particles, f64::from(size[0].min(size[1])) / 2.0) else { return step };
    let step = step.put(value::HEAVY, heavy.weight).put(value::HEAVY_CENTER, heavy.at);
    step.put(value::LIGHT, light.weight).put(value::LIGHT_CENTER, light.at).say(case::TWO_PARTS)
}

/// Whether no particle of the frame has a weight.
fn are_outside(at: &At<'_, ParticleFilter>) -> bool {
    at.events.iter().any(|event| matches!(event, Event::Weighed(weighed) if !weighed.is_weighted))
}

/// The particles of an event, with their weights.
fn particles(event: &Event) -> Option<&[Particle]> {
    match event {
        Event::Modelled(_) => None,
        Event::Scattered(particles)
        | Event::Predicted(particles)
        | Event::Counted(particles, _)
        | Event::Estimated(particles, _) => Some(particles),
        Event::Weighed(weighed) => Some(&weighed.particles),
        Event::Resampled(resampled) => Some(&resampled.after),
    }
}

/// Draws particles as points.
fn dots(scene: &mut Scene, (role, meaning): (Role, &'static str), particles: &[Particle]) {
    let places = particles.iter().map(|particle| particle.at).collect();
    scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(places));
}

/// Draws the mean displacement of the particles by the prediction.
fn moves(scene: &mut Scene, at: &At<'_, ParticleFilter>, particles: &[Particle]) {
    let Some(model) = at.model else { return };
    let mean = |all: &[Particle]| Estimate::of(all, &[]).at;
    let (from, to) = (mean(&model.particles), mean(particles));
    scene.draw(Picture::CURRENT, (Role::Result, "path of the region"), Shape::Arrows(vec![Arrow { from, to }]));
}

/// Draws particles as circles whose areas are their weights, the lightest of very many as points.
fn circles(scene: &mut Scene, particles: &[Particle]) {
    let order = by_weight(particles);
    let (heavy, light) = order.split_at(CIRCLES.min(order.len()));
    if !light.is_empty() {
        let places = light.iter().map(|particle| particle.at).collect();
        scene.draw(Picture::CURRENT, (Role::Rejected, "particles of the least weight"), Shape::Points(places));
    }
    let [mean, least, most] = RADIUS_PX;
    for particle in heavy.iter().rev() {
        let radius = (mean * (particle.weight * particles.len() as f32).sqrt()).clamp(least, most);
        let shape = Shape::circle(particle.at, radius);
        scene.mark(Picture::CURRENT, Role::Candidate, shape);
    }
    scene.legend(Role::Candidate, "particles, area by weight");
}
