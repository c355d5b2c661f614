//! Streaklines: particles released on a grid again and again, and advected by a flow.

use std::f32::consts::TAU;

use crate::data::Flow;

/// Steps of a particle's life.
const STEPS: usize = 48;
/// Number of its last positions drawn as a tail.
const TAIL: usize = 18;
/// Typical tail length in units of the release spacing.
const REACH: f32 = 1.6;
/// Shortest and longest life in frames.
const LIFE_FRAMES: std::ops::RangeInclusive<f32> = 8.0..=256.0;

/// The tail of a particle in image pixels, oldest position first, with its opacity, 0 to 1: it fades in and out.
#[derive(Clone, Debug, PartialEq)]
pub struct Streak {
    /// Positions, a fraction of a frame apart; at least two.
    pub points: Vec<[f32; 2]>,
    /// Opacity.
    pub strength: f32,
}

/// The paths of all particles through a steady flow.
///
/// They are integrated once; [`Streaks::at`] gives the tails at any phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Streaks {
    life_frames: f32,
    /// The path of each particle, and its phase offset as a share of a life.
    ways: Vec<(Vec<[f32; 2]>, f32)>,
}

impl Streaks {
    /// Releases particles every `spacing_px` in x and y, each with its own phase.
    pub fn new(flow: &Flow, spacing_px: usize) -> Self {
        let spacing = spacing_px.max(1);
        let (width, height) = flow.0.size();
        let along = |extent: usize| (spacing / 2..extent).step_by(spacing);
        let places = along(height).flat_map(|y| along(width).map(move |x| [x, y]));
        let lengths = places.clone().filter_map(|[x, y]| flow.at(x, y)).map(|[u, v]| u.hypot(v));
        let usual = median(lengths.filter(|length| *length > 0.0).collect());
        let life = REACH * spacing as f32 / usual * STEPS as f32 / TAIL as f32;
        // A power of two, so that it is the same at every step of an estimator.
        let life_frames = life.log2().round().exp2().clamp(*LIFE_FRAMES.start(), *LIFE_FRAMES.end());
        let way = |[x, y]: [usize; 2]| {
            let points = carried(flow, [x as f32, y as f32], life_frames / STEPS as f32);
            (points.len() > 1).then(|| (points, offset([x, y])))
        };
        Self { life_frames, ways: places.filter_map(way).collect() }
    }

    /// Frames in a particle's life.
    pub fn life_frames(&self) -> u16 {
        self.life_frames as u16
    }

    /// Whether nothing moves at all.
    pub fn is_empty(&self) -> bool {
        self.ways.is_empty()
    }

    /// The tails at `phase`, a share of a particle's life; periodic with period 1.
    pub fn at(&self, phase: f32) -> Vec<Streak> {
        let streak = |(way, ahead): &(Vec<[f32; 2]>, f32)| {
            let age = (phase + ahead).rem_euclid(1.0);
            let head = age * STEPS as f32;
            let last = (way.len() - 1) as f32;
            // A particle that has left the picture or reached unknown flow draws in its tail.
            let from = (head - TAIL as f32).max(0.0);
            if from >= last {
                return None;
            }
            let at = |t: f32| {
                let t = t.min(last);
                let (i, share) = ((t as usize).min(way.len() - 2), t - (t as usize).min(way.len() - 2) as f32);
                [0, 1].map(|c| way[i][c] + (way[i + 1][c] - way[i][c]) * share)
            };
            let to = head.min(last);
            let between = (from.floor() as usize + 1..).take_while(|i| (*i as f32) < to).map(|i| way[i]);
            let points: Vec<_> = std::iter::once(at(from)).chain(between).chain([at(to)]).collect();
            let strength = (age * TAU / 2.0).sin().sqrt();
            (strength > 0.05 && points[0] != points[points.len() - 1]).then_some(Streak { points, strength })
        };
        self.ways.iter().filter_map(streak).collect()
    }
}

/// The median; 1 without values.
fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() { 1.0 } else { *values.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

/// The places of a particle released at `from`, `step` frames apart, until it leaves the picture or the known flow (midpoint rule).
fn carried(flow: &Flow, from: [f32; 2], step: f32) -> Vec<[f32; 2]> {
    let next = |at: &[f32; 2]| {
        let toward = |way: [f32; 2], share: f32| [0, 1].map(|i| at[i] + way[i] * step * share);
        let middle = toward(flow.sample(*at)?, 0.5);
        Some(toward(flow.sample(middle)?, 1.0))
    };
    let way: Vec<_> = std::iter::successors(Some(from), next).take(STEPS + 1).collect();
    // A particle at rest leaves no streak.
    let goes = way.last().is_some_and(|last| (last[0] - from[0]).hypot(last[1] - from[1]) > 0.5);
    if goes { way } else { Vec::new() }
}

/// A pseudo-random share of a life, the same for a place every time.
fn offset([x, y]: [usize; 2]) -> f32 {
    let mut z = (x as u64) << 32 | y as u64;
    // SplitMix64 (Steele, Lea and Flood 2014).
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 40) as f32 / (1u64 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn in_an_even_flow_streaks_are_straight_and_as_long_as_the_way() {
        let streaks = Streaks::new(&Flow(Grid::new(200, 100, [1.0, 0.5])), 20);
        // A tail of about 1.6 · 20 px at 1.1 px/frame, which is 18 of 48 steps.
        assert_eq!(streaks.life_frames(), 64);
        for phase in [0.0, 0.3, 0.77] {
            let all = streaks.at(phase);
            assert!(all.len() > 20);
            for Streak { points, strength } in all {
                let ([x0, y0], [x1, y1]) = (points[0], points[points.len() - 1]);
                assert!(
                    (y1 - y0 - 0.5 * (x1 - x0)).abs() < 1e-2 && x1 - x0 <= 64.0 * (TAIL as f32 / STEPS as f32) + 1e-2
                );
                assert!((0.0..=1.0).contains(&strength));
            }
        }
        // It goes round; 1.25 is known a little less finely than 0.25.
        let (now, then) = (streaks.at(0.25), streaks.at(1.25));
        let end = |streak: &Streak| streak.points[streak.points.len() - 1];
        assert_eq!(now.len(), then.len());
        assert!(now.iter().zip(&then).all(|(a, b)| (end(a)[0] - end(b)[0]).abs() < 1e-2));
        assert_ne!(streaks.at(0.25), streaks.at(0.26), "it moves");
    }

    #[test]
    fn in_a_turning_flow_particles_stay_on_their_circle() {
        let turn = Flow(Grid::from_fn(121, 121, |x, y| [-0.05 * (y as f32 - 60.0), 0.05 * (x as f32 - 60.0)]));
        let way = carried(&turn, [90.0, 60.0], 0.5);
        assert_eq!(way.len(), STEPS + 1);
        let off = way.iter().map(|[x, y]| ((x - 60.0).hypot(y - 60.0) - 30.0).abs()).fold(0.0, f32::max);
        assert!(off < 0.01, "{off} px off the circle");
    }

    #[test]
    fn nothing_is_drawn_where_nothing_moves_or_is_known() {
        assert!(Streaks::new(&Flow(Grid::new(64, 48, [0.0; 2])), 8).is_empty());
        assert!(Streaks::new(&Flow(Grid::new(64, 48, Flow::UNKNOWN)), 8).is_empty());
        let half = Flow(Grid::from_fn(64, 48, |x, _| if x < 32 { [2.0, 0.0] } else { Flow::UNKNOWN }));
        let all: Vec<_> = (0..20).flat_map(|i| Streaks::new(&half, 8).at(i as f32 / 20.0)).collect();
        assert!(!all.is_empty() && all.iter().flat_map(|streak| &streak.points).all(|[x, _]| *x < 34.0));
    }
}
