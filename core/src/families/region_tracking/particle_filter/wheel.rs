//! The wheel of a resampling: an arc for each particle, as long as its weight, and the pointers that select the copies.

use super::{Resampled, Resampling};
use crate::base::words::{counted, grouped};
use crate::methods::numbers::ratio;
use crate::scene::{Diagram, DiagramLine, Role, Words};

/// Radii of the ring, and of both ends of the pointers.
const RING: f32 = 1.0;
const POINTERS: [f32; 2] = [1.1, 1.24];
/// Room around the middle.
const HALF: [f32; 2] = [1.75, 1.45];
/// Neighbouring arcs below this share of the ring are drawn as one.
const LEAST_SHARE: f32 = 0.004;
/// The share of the ring between two arcs.
const GAP: f32 = 0.0012;
/// The longest chord of an arc as a share of the ring.
const CHORD: f32 = 0.01;
/// The most pointers that are drawn.
const MOST_POINTERS: usize = 1000;
/// The number of arcs with their copies in words.
const LABELED: usize = 8;

/// An arc: one particle, or light ones that are neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slice {
    from: f32,
    to: f32,
    particles: usize,
    copies: u32,
}

/// The place at a share of the ring from its top, clockwise.
fn at(share: f32, radius: f32) -> [f32; 2] {
    let (sin, cos) = (std::f32::consts::TAU * share).sin_cos();
    [HALF[0] + radius * sin, HALF[1] - radius * cos]
}

/// The arcs of the particles in their order; together they fill the ring.
fn arcs(resampled: &Resampled) -> Vec<Slice> {
    let sum: f64 = resampled.before.iter().map(|particle| f64::from(particle.weight)).sum();
    let (mut all, mut end) = (Vec::<Slice>::new(), 0.0f64);
    for (particle, copies) in resampled.before.iter().zip(&resampled.copies) {
        let from = end as f32;
        end += f64::from(particle.weight) / sum;
        let arc = Slice { from, to: end as f32, particles: 1, copies: *copies };
        let is_light = |arc: &Slice| arc.to - arc.from < LEAST_SHARE;
        match all.last_mut() {
            Some(last) if is_light(&arc) && (is_light(last) || last.particles > 1) => {
                *last =
                    Slice { from: last.from, to: arc.to, particles: last.particles + 1, copies: last.copies + *copies };
            }
            _ => all.push(arc),
        }
    }
    all
}

/// The wheel of a resampling.
pub fn wheel(resampled: &Resampled, resampling: Resampling) -> Diagram {
    let all = arcs(resampled);
    let arc_lines = all.iter().filter(|arc| arc.to > arc.from).map(|arc| {
        let gap = GAP.min((arc.to - arc.from) / 3.0);
        let (from, to) = (arc.from + gap / 2.0, arc.to - gap / 2.0);
        let chords = ((to - from) / CHORD).ceil().max(1.0);
        let points = (0..=chords as usize).map(|i| at(from + (to - from) * i as f32 / chords, RING)).collect();
        let (role, is_faded) = match (arc.particles, arc.copies) {
            (_, 0) => (Role::Rejected, true),
            (1, _) => (Role::Best, false),
            _ => (Role::Candidate, false),
        };
        DiagramLine { role, width: 14.0, is_faded, points }
    });
    let count = resampled.pointers.len();
    let every = count.div_ceil(MOST_POINTERS).max(1);
    let pointers = resampled.pointers.iter().step_by(every).map(|share| DiagramLine {
        role: Role::Measured,
        width: if count > 200 { 0.7 } else { 1.5 },
        is_faded: false,
        points: POINTERS.map(|radius| at(*share, radius)).to_vec(),
    });
    let lines = arc_lines.chain(pointers).collect();
    let words = labels(&all).into_iter().chain(middle(resampled, resampling, every)).collect();
    let summary = summary(resampled, &all);
    let size = HALF.map(|half| 2.0 * half);
    Diagram { title: "Resampling wheel", size, is_isotropic: true, lines, nodes: Vec::new(), words, summary }
}

/// The copies of the longest arcs.
fn labels(all: &[Slice]) -> Vec<Words> {
    let mut order: Vec<&Slice> = all.iter().filter(|arc| arc.particles == 1 && arc.copies > 1).collect();
    order.sort_by(|a, b| (b.to - b.from).total_cmp(&(a.to - a.from)).then(a.from.total_cmp(&b.from)));
    let label = |arc: &&Slice| {
        let middle = (arc.from + arc.to) / 2.0;
        Words {
            text: format!("×{}", arc.copies),
            role: Some(Role::Best),
            at: at(middle, POINTERS[1] + 0.08),
            side: if middle < 0.5 { 1 } else { -1 },
        }
    };
    order.iter().take(LABELED).map(label).collect()
}

/// The words inside the ring.
fn middle(resampled: &Resampled, resampling: Resampling, every: usize) -> Vec<Words> {
    let count = grouped(resampled.pointers.len());
    let spacing = match resampling {
        Resampling::Systematic => "equally spaced",
        Resampling::Multinomial => "random",
    };
    let drawn = if every > 1 { format!("{spacing}, 1 in {every} drawn") } else { spacing.to_owned() };
    let survivors = resampled.copies.iter().filter(|copies| **copies > 0).count();
    let lines = [
        (format!("{count} pointers"), Some(Role::Measured)),
        (drawn, Some(Role::Measured)),
        (format!("{} chosen", counted(survivors, "particle")), Some(Role::Best)),
        (format!("{} not chosen", grouped(resampled.copies.len() - survivors)), Some(Role::Rejected)),
    ];
    let line = |(i, (text, role)): (usize, (String, Option<Role>))| Words {
        text,
        role,
        at: [HALF[0], HALF[1] + 0.17 * (i as f32 - 1.5)],
        side: 0,
    };
    lines.into_iter().enumerate().map(line).collect()
}

fn summary(resampled: &Resampled, all: &[Slice]) -> String {
    let heaviest = resampled.before.iter().zip(&resampled.copies).max_by(|a, b| a.0.weight.total_cmp(&b.0.weight));
    let (weight, copies) = heaviest.map_or((0.0, 0), |(particle, copies)| (particle.weight, *copies));
    let merged: usize = all.iter().filter(|arc| arc.particles > 1).map(|arc| arc.particles).sum();
    format!(
        "Resampling wheel of {} particles: the heaviest has a weight of {} and {copies} copies; {} light ones share arcs",
        grouped(resampled.before.len()),
        ratio(weight.into()),
        grouped(merged)
    )
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::cloud::{Draw, Particle, copied, copies, pointers};
    use super::*;

    fn resampled(weights: &[f32], resampling: Resampling) -> Resampled {
        let sum: f32 = weights.iter().sum();
        let particle = |weight: &f32| Particle { at: [0.0; 2], velocity: [0.0; 2], scale: 1.0, weight: weight / sum };
        let before: Vec<Particle> = weights.iter().map(particle).collect();
        let draw = Draw { seed: 3, step: 5 };
        let copies = copies(draw, resampling, &before);
        let pointers = pointers(draw, resampling, before.len()).map(|share| share as f32).collect();
        Resampled { after: Arc::new(copied(&before, &copies)), before: Arc::new(before), copies, pointers }
    }

    #[test]
    fn arcs_fill_the_ring_and_hold_the_pointers_that_chose_them() {
        let weights: Vec<f32> = (0..1000).map(|i| if i % 100 == 7 { 90.0 } else { (i % 5) as f32 * 0.1 }).collect();
        for resampling in [Resampling::Systematic, Resampling::Multinomial] {
            let resampled = resampled(&weights, resampling);
            let all = arcs(&resampled);
            assert_eq!(all.iter().map(|arc| arc.particles).sum::<usize>(), 1000);
            assert_eq!(all.iter().filter(|arc| arc.particles == 1).count(), 10, "the heavy ones stand alone");
            assert!(all[0].from == 0.0 && (all[all.len() - 1].to - 1.0).abs() < 1e-5);
            for (i, arc) in all.iter().enumerate() {
                assert!(i == 0 || arc.from == all[i - 1].to, "arcs leave no gap");
                let inside = resampled.pointers.iter().filter(|share| (arc.from..arc.to).contains(*share)).count();
                // A pointer at an end may fall to either side by rounding.
                assert!(inside.abs_diff(arc.copies as usize) <= 1, "{arc:?}: {inside}");
            }
        }
        let wheel = wheel(&resampled(&weights, Resampling::Systematic), Resampling::Systematic);
        assert!(wheel.lines.len() >= 1000 + 20 && wheel.words.iter().any(|words| words.text == "1000 pointers"));
        let is_inside = |at: &[f32; 2]| (0..2).all(|i| (0.0..=wheel.size[i]).contains(&at[i]));
        assert!(wheel.lines.iter().flat_map(|line| &line.points).all(is_inside));
    }

    #[test]
    fn light_particles_are_merged_with_their_whole_weight() {
        let mut weights = vec![0.001f32; 500];
        weights.push(0.5);
        let all = arcs(&resampled(&weights, Resampling::Systematic));
        assert_eq!(all.len(), 2);
        assert!((all[0].to - 0.5).abs() < 1e-4 && all[0].particles == 500, "{all:?}");
    }
}
