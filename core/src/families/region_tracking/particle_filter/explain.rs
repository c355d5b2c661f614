//! The explanation and the drawing of the particle filter.

use super::cloud::{Estimate, Particle, effective, parts};
use super::wheel::wheel;
use super::{Event, ParticleFilter, Resampled, Resampling, Weighed};
use crate::base::words::{counted, fixed, grouped, place};
use crate::geometry::Grid;
use crate::methods::kalman;
use crate::methods::numbers::{px, ratio};
use crate::methods::region::{At, Ending, Explained, Outcome, plots};
use crate::products::Region;
use crate::scene::{Arrow, BetweenPixels, Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Surface};

/// The most particles that are drawn with their weights.
const CIRCLES: usize = 400;
/// The radius of a particle of mean weight in px, and the smallest and largest of all.
const RADIUS_PX: [f32; 3] = [1.5, 0.4, 8.0];
/// The share of the particles inside the drawn ellipse, if they are normally distributed.
const CONFIDENCE: f64 = 0.95;

/// A cloud is impoverished if fewer than one in so many of its particles are distinct.
const POOR: usize = 10;

/// The exponential of a number as text: a whole number, or a power of ten where it is large.
fn factor(ln: f64) -> String {
    let exponent = (ln / std::f64::consts::LN_10).floor();
    if exponent < 6.0 {
        return grouped(ln.exp().round() as usize);
    }
    let mantissa = (ln - exponent * std::f64::consts::LN_10).exp();
    let digit = |d: char| d.to_digit(10).and_then(|d| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(d as usize)).unwrap_or(d);
    format!("{}·10{}", fixed(mantissa, 1), fixed(exponent, 0).chars().map(digit).collect::<String>())
}

/// Where a cloud has two parts, farther apart than half the object.
fn two_parts(at: &At<'_, ParticleFilter>, particles: &[Particle]) -> String {
    let size = at.model.map_or(at.region.size, |model| model.size);
    let Some(parts) = parts(particles, f64::from(size[0].min(size[1])) / 2.0) else { return String::new() };
    let [heavy, light] = parts.map(|part| part.weight);
    let [first, second] = parts.map(|part| place(part.at.map(|c| c as f32)));
    format!(
        " The cloud has two parts, of the weights {} around {first} px and {} around {second} px; the mean lies between them.",
        ratio(heavy),
        ratio(light)
    )
}

/// The standard deviations along x and y as text.
fn deviations(covariance: [[f64; 2]; 2]) -> String {
    let [x, y] = [0, 1].map(|i| px(covariance[i][i].max(0.0).sqrt()));
    format!("({x},\u{a0}{y}) px")
}

/// The standard deviations of the positions of particles of equal weight.
fn spread(particles: &[Particle]) -> String {
    deviations(Estimate::of(particles, &[]).covariance)
}

impl Explained for ParticleFilter {
    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Modelled(histogram) => {
                let said = said.text("The ").ink(Role::Reference, "model q").text(format!(
                " is the {} histogram of the ellipse, weighted by the Epanechnikov kernel: {} of {} bins are filled.",
                histogram.binning.name(),
                grouped(histogram.support.len()),
                grouped(histogram.binning.count())
            ));
                plots::warned(said, histogram)
            }
            Event::Scattered(particles) => said
                .ink(Role::Predicted, format!("{} particles", grouped(particles.len())))
                .text(format!(
                    " around the centre of the region, standard deviations {}. Each is a hypothesis of position, velocity and scale.",
                    spread(particles)
                )),
            Event::Predicted(particles) => said
                .text("Prediction: each particle moves with its velocity and a random acceleration of standard deviation ")
                .text(format!("{} px/frame². ", px(self.process_noise.into())))
                .ink(Role::Predicted, format!("The standard deviations of the cloud are now {}", spread(particles)))
                .text("."),
            Event::Weighed(weighed) => self.weighed(weighed, said),
            Event::Estimated(particles, estimate) => said
                .text("The weighted mean of the particles is ")
                .ink(Role::Estimate, format!("{} px", place(estimate.at)))
                .text(format!(
                    ", standard deviations {}; velocity {} px/frame, scale {}. The ellipse holds {} % if the particles are normally \
                     distributed.",
                    deviations(estimate.covariance),
                    place(estimate.velocity),
                    ratio(estimate.scale.into()),
                    fixed(100.0 * CONFIDENCE, 0)
                ))
                .text(two_parts(at, particles)),
            Event::Counted(particles, effective) => self.counted(particles, *effective, said),
            Event::Resampled(resampled) => self.resampled(resampled, said),
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Weighed(weighed) => {
                vec![Fact::new("Particles outside the picture", grouped(weighed.outside), None)]
            }
            Event::Estimated(_, estimate) => vec![
                Fact::new("Estimate", format!("{} px", place(estimate.at)), Some(Role::Estimate)),
                Fact::new("Velocity", format!("{} px/frame", place(estimate.velocity)), None),
                Fact::new("Scale", ratio(estimate.scale.into()), None),
                Fact::new("Standard deviations", deviations(estimate.covariance), None),
            ],
            Event::Counted(particles, effective) => vec![
                Fact::new("Effective sample size", fixed((*effective).into(), 1), Some(Role::Measured)),
                Fact::new("Particles", grouped(particles.len()), None),
            ],
            Event::Resampled(resampled) => {
                let survivors = resampled.copies.iter().filter(|copies| **copies > 0).count();
                vec![Fact::new("Distinct particles", grouped(survivors), Some(Role::Best))]
            }
            Event::Modelled(_) | Event::Scattered(_) | Event::Predicted(_) => Vec::new(),
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        let var = Math::Var;
        let w = || var("w");
        let mut readouts = match at.event {
            Event::Modelled(histogram) => {
                let bins = histogram.largest(plots::BARS);
                let line = plots::bars(bins.iter().map(|bin| histogram.shares[*bin]));
                let axes = ["largest bins of the model", "share"];
                return vec![Readout::Series(plots::histograms(
                    "Colour histogram",
                    axes,
                    vec![("model q", Role::Reference, line)],
                ))];
            }
            Event::Scattered(_) => Vec::new(),
            Event::Predicted(_) => vec![equation(vec![
                Math::Bold("x"),
                Math::text(" ← "),
                Math::Bold("x"),
                Math::text(" + "),
                Math::Bold("v"),
                Math::text(" + ½ "),
                Math::Bold("a"),
                Math::text(",  "),
                Math::Bold("v"),
                Math::text(" ← "),
                Math::Bold("v"),
                Math::text(" + "),
                Math::Bold("a"),
            ])],
            Event::Weighed(weighed) => {
                let exponent = Math::text(format!("−{} (1 − ρ)", fixed(self.lambda.into(), 1)));
                vec![
                    equation(vec![
                        w(),
                        Math::text(" ← "),
                        w(),
                        Math::text(" · "),
                        Math::power(Math::text("e"), exponent),
                    ]),
                    Readout::Series(weights(&weighed.particles, None)),
                ]
            }
            Event::Estimated(particles, _) => vec![
                equation(vec![
                    Math::text("estimate = "),
                    Math::Sum(Box::new(var("i"))),
                    Math::indexed(w(), var("i")),
                    Math::indexed(Math::Bold("x"), var("i")),
                ]),
                Readout::Series(weights(particles, None)),
            ],
            Event::Counted(particles, effective) => {
                let sum = Math::Row(vec![Math::Sum(Box::new(var("i"))), Math::squared(Math::indexed(w(), var("i")))]);
                vec![
                    equation(vec![
                        Math::indexed(var("N"), Math::text("eff")),
                        Math::text(" = "),
                        Math::over(Math::text("1"), sum),
                        Math::text(" = "),
                        Math::ink(Role::Measured, fixed((*effective).into(), 1)),
                    ]),
                    Readout::Series(weights(particles, None)),
                ]
            }
            Event::Resampled(resampled) => {
                vec![
                    Readout::Diagram(wheel(resampled, self.resampling)),
                    Readout::Series(cumulative(resampled)),
                    Readout::Series(weights(&resampled.before, Some(&resampled.copies))),
                ]
            }
        };
        readouts.extend(self.sizes(at));
        readouts.extend(particles(at.event).map(|particles| Readout::Landscape(density(particles))));
        readouts
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
                    scene.mark(Picture::CURRENT, Role::Estimate, shape);
                    scene.legend(Role::Estimate, "estimate with 95 % ellipse");
                }
                let size = at.model.map_or(at.region.size, |model| model.size).map(|side| side * estimate.scale);
                let Region { angle_rad, .. } = at.region;
                let bounds = Region { center: estimate.at, size, angle_rad }.bounds();
                scene.mark(Picture::CURRENT, Role::Estimate, Shape::Rect { min: bounds.min, max: bounds.max });
            }
            Event::Resampled(resampled) => dots(scene, (Role::Best, "particles drawn"), &resampled.after),
        }
    }

    fn loss(&self, at: &At<'_, Self>) -> Option<String> {
        are_outside(at).then(|| "no particle has a weight above 0".into())
    }

    fn advice(&self, ending: Ending, at: &At<'_, Self>) -> String {
        if are_outside(at) {
            return "All particles lie outside the picture, where none has a weight, and nothing brings them back. Only a new start finds an \
                    object that enters again."
                .into();
        }
        match ending.outcome {
            Outcome::Followed if ending.hidden > 0 => {
                return format!(
                    "The object was hidden in {}: the velocity carried the particles on, and those on other places survived until it could be \
                     seen again. More particles make that likelier.",
                    counted(ending.hidden, "frame")
                );
            }
            Outcome::Followed => {
                "Resampling multiplied the particles on the object, and the process noise spread them enough to follow it. More particles or \
                 less process noise make the estimate steadier."
            }
            Outcome::Regained => {
                "The estimate left the object, and particles that were near it won later: other hypotheses had survived. A Kalman filter keeps \
                 one only."
            }
            Outcome::Grown | Outcome::Shrunk => {
                "The scale of the particles drifted from that of the object, because the histogram changes little with the size. A smaller \
                 scale noise keeps it nearer."
            }
            Outcome::Beside | Outcome::Unknown => {
                "The mean of the cloud lies beside the object, because other places have colours of the model too, or none has them while \
                 the object is hidden. A larger λ lets fewer particles on other places survive."
            }
            Outcome::Lost => {
                "No particle was near the object any more, or others had larger weights. More process noise spreads the particles farther between frames, which \
                 fast motion needs; with it more particles are needed, too."
            }
        }
        .into()
    }
}

impl ParticleFilter {
    fn weighed(&self, weighed: &Weighed, said: Sentence) -> Sentence {
        let Weighed { particles, coefficients, outside, is_weighted } = weighed;
        let count = particles.len();
        if !is_weighted {
            return said.text(format!(
                "{} of {} particles lie outside the picture, and none inside has a weight above 0. The weights are set to 1/N = {}, and \
                 the estimate is not used: the object is lost.",
                grouped(*outside),
                grouped(count),
                fixed(1.0 / count as f64, 4)
            ));
        }
        let best = coefficients.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let worst = coefficients.iter().copied().filter(|c| c.is_finite()).fold(f32::INFINITY, f32::min);
        let said = said
            .text("Each weight is multiplied by the likelihood exp(−λ (1 − ρ)): ρ is ")
            .ink(Role::Best, ratio(best.into()))
            .text(format!(" for the best and {} for the worst particle", ratio(worst.into())));
        let said = if *outside > 0 {
            said.text(format!(", and {} outside the picture have weight 0", grouped(*outside)))
        } else {
            said
        };
        said.text(format!(
            ". With λ = {} the best counts {} times as much as the worst.",
            fixed(self.lambda.into(), 1),
            factor((self.lambda * (best - worst)).into())
        ))
    }

    fn counted(&self, particles: &[Particle], effective: f32, said: Sentence) -> Sentence {
        let count = particles.len();
        let limit = self.resample_below * count as f32;
        let said = said
            .text("The weights are worth ")
            .ink(Role::Measured, format!("{} particles of equal weight", fixed(effective.into(), 1)))
            .text(format!(", the effective sample size, of {}: ", grouped(count)));
        if effective < limit {
            said.text(format!("below {}, so the particles are drawn anew (degeneracy).", fixed(limit.into(), 1)))
        } else {
            said.text(format!("not below {}, so the particles and their weights are kept.", fixed(limit.into(), 1)))
        }
    }

    fn resampled(&self, resampled: &Resampled, said: Sentence) -> Sentence {
        let survivors = resampled.copies.iter().filter(|copies| **copies > 0).count();
        let most = resampled.copies.iter().max().copied().unwrap_or(0);
        let count = resampled.copies.len();
        let (name, pointers) = match self.resampling {
            Resampling::Systematic => ("Systematic", "equally spaced"),
            Resampling::Multinomial => ("Multinomial", "random"),
        };
        let said = said.text(format!(
            "{name} resampling: an arc of the wheel is as long as the weight of its particle (light neighbours share one), and each {pointers} pointer \
             copies the particle on its arc. "
        ));
        let said = said
            .ink(Role::Best, format!("{} distinct particles of {} survive", grouped(survivors), grouped(count)))
            .text(format!(", the heaviest with {most} copies. "));
        said.text(if POOR * survivors < count {
            "So few distinct ones are an impoverishment of the cloud; the process noise has to spread it again."
        } else {
            "All have equal weights now."
        })
    }

    /// The effective sample size over the frames.
    fn sizes(&self, at: &At<'_, Self>) -> Option<Readout> {
        let past = at.model.map(|model| &model.effective)?;
        let now = at.events.iter().find_map(|event| match event {
            Event::Counted(_, effective) => Some(*effective),
            _ => None,
        });
        let values: Vec<_> = past.iter().copied().chain(now).enumerate().map(|(i, v)| [(i + 1) as f32, v]).collect();
        (values.len() > 1).then(|| {
            Readout::Series(Series {
                title: "Effective sample size",
                x_label: "frames since the start",
                y_label: "particles",
                x_max: values.len(),
                lines: vec![("effective sample size", Role::Measured, values)],
                thresholds: vec![("resampling".into(), self.resample_below * self.particles as f32)],
                ..Series::default()
            })
        })
    }
}

/// Whether no particle of the frame has a weight.
fn are_outside(at: &At<'_, ParticleFilter>) -> bool {
    at.events.iter().any(|event| matches!(event, Event::Weighed(weighed) if !weighed.is_weighted))
}

fn equation(parts: Vec<Math>) -> Readout {
    Readout::Equation(vec![Math::Row(parts)])
}

/// The weights of the particles, the heaviest first, as multiples of 1/N: the expected numbers of copies; and the numbers drawn.
fn weights(particles: &[Particle], copies: Option<&[u32]>) -> Series {
    let count = particles.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| particles[*b].weight.total_cmp(&particles[*a].weight).then(a.cmp(b)));
    // As many as have an expectation that can be seen.
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
fn cumulative(resampled: &Resampled) -> Series {
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

/// The density that the particles stand for, by normal kernels of the bandwidths of D. W. Scott, Multivariate Density Estimation (1992),
/// for the effective sample size: σ n^(−1/6) along x and along y.
fn density(particles: &[Particle]) -> Surface {
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
fn by_weight(particles: &[Particle]) -> Vec<&Particle> {
    let mut order: Vec<&Particle> = particles.iter().collect();
    order.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    order
}

/// Draws particles as points.
fn dots(scene: &mut Scene, (role, meaning): (Role, &'static str), particles: &[Particle]) {
    let places = particles.iter().map(|particle| particle.at).collect();
    scene.mark(Picture::CURRENT, role, Shape::Points(places));
    scene.legend(role, meaning);
}

/// Draws the mean displacement of the particles by the prediction.
fn moves(scene: &mut Scene, at: &At<'_, ParticleFilter>, particles: &[Particle]) {
    let Some(model) = at.model else { return };
    let mean = |all: &[Particle]| Estimate::of(all, &[]).at;
    let (from, to) = (mean(&model.particles), mean(particles));
    scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(vec![Arrow { from, to }]));
    scene.legend(Role::Result, "path of the region");
}

/// Draws particles as circles whose areas are their weights, the lightest of very many as points.
fn circles(scene: &mut Scene, particles: &[Particle]) {
    let order = by_weight(particles);
    let (heavy, light) = order.split_at(CIRCLES.min(order.len()));
    if !light.is_empty() {
        let places = light.iter().map(|particle| particle.at).collect();
        scene.mark(Picture::CURRENT, Role::Rejected, Shape::Points(places));
        scene.legend(Role::Rejected, "particles of the least weight");
    }
    let [mean, least, most] = RADIUS_PX;
    for particle in heavy.iter().rev() {
        let radius = (mean * (particle.weight * particles.len() as f32).sqrt()).clamp(least, most);
        let shape = Shape::Ellipse { center: particle.at, radii: [radius; 2], angle_rad: 0.0 };
        scene.mark(Picture::CURRENT, Role::Candidate, shape);
    }
    scene.legend(Role::Candidate, "particles, area by weight");
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

    #[test]
    fn large_factors_are_powers_of_ten() {
        let of = |factor: f64| super::factor(factor.ln());
        assert_eq!([of(1.0), of(12_345.0), of(1.2e7)], ["1", "12\u{202f}345", "1.2·10⁷"]);
        assert_eq!(factor(20.0 * 4.0), "5.5·10³⁴", "λ = 200 would overflow a count");
    }
}
