//! Motion of layers: exact forwards and backwards, at any real time.

use super::maths::{cos, exp, ln, sin, sin_cos, there_and_back};
use super::shape::Point;

/// A linear map and a shift of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Rows of the linear part.
    pub linear: [Point; 2],
    /// What is added.
    pub shift: Point,
}

impl Affine {
    /// Turns by `turns` (clockwise on the screen) and scales about the origin, then shifts.
    pub fn similarity(turns: f64, scale: f64, shift: Point) -> Self {
        let (sin, cos) = sin_cos(turns);
        Self { linear: [[cos * scale, -sin * scale], [sin * scale, cos * scale]], shift }
    }

    /// The image of `p`.
    pub fn apply(&self, p: Point) -> Point {
        std::array::from_fn(|i| self.linear[i][0] * p[0] + self.linear[i][1] * p[1] + self.shift[i])
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Self) -> Self {
        let column = |j: usize| next.linear.map(|row| row[0] * self.linear[0][j] + row[1] * self.linear[1][j]);
        let (a, b) = (column(0), column(1));
        Self { linear: [[a[0], b[0]], [a[1], b[1]]], shift: next.apply(self.shift) }
    }

    /// The way back. The linear part must not be singular.
    pub fn inverse(&self) -> Self {
        let [[a, b], [c, d]] = self.linear;
        let det = self.area();
        let linear = [[d / det, -b / det], [-c / det, a / det]];
        let back = Self { linear, shift: [0.0; 2] }.apply(self.shift);
        Self { linear, shift: back.map(|s| -s) }
    }

    /// The determinant: growth of areas.
    pub fn area(&self) -> f64 {
        let [[a, b], [c, d]] = self.linear;
        a * d - b * c
    }
}

/// The motion of a layer. Lengths are in the scene's units, times in frames.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Position of the layer's origin at time 0.
    pub from: Point,
    /// Velocity per frame.
    pub velocity: Point,
    /// From which to which distance from `from` it goes round and round, if it does: at the end it is back at the start.
    pub lap: Option<[f64; 2]>,
    /// Amplitude of an oscillation about its path.
    pub sway: Point,
    /// Height of its bounces.
    pub bounce: f64,
    /// Period of oscillation or bounce in frames.
    pub period: f64,
    /// Clockwise rotation at time 0, in turns.
    pub turned: f64,
    /// Rotation per frame, in turns.
    pub spin: f64,
    /// Growth per frame as a share; after doubling or halving it reverses.
    pub growth: f64,
    /// Its wave, if it bends.
    pub wave: Option<Wave>,
}

impl Motion {
    /// Stays at `from`.
    pub fn still(from: Point) -> Self {
        Self {
            from,
            velocity: [0.0; 2],
            lap: None,
            sway: [0.0; 2],
            bounce: 0.0,
            period: 24.0,
            turned: 0.0,
            spin: 0.0,
            growth: 0.0,
            wave: None,
        }
    }

    /// Goes straight on from the origin.
    pub fn drift(velocity: Point) -> Self {
        Self { velocity, ..Self::still([0.0; 2]) }
    }

    /// The lap whose ends are both farther than `reach` from `middle`, and at least `frames` frames of motion beyond.
    pub fn lap_around(&self, middle: Point, reach: f64, frames: f64) -> [f64; 2] {
        let speed = super::shape::length(self.velocity);
        let away = [middle[0] - self.from[0], middle[1] - self.from[1]];
        let nearest = (away[0] * self.velocity[0] + away[1] * self.velocity[1]) / speed;
        let aside = (away[0] * self.velocity[1] - away[1] * self.velocity[0]) / speed;
        let swing = super::shape::length(self.sway) + self.bounce;
        let half = ((reach + swing) * (reach + swing) - aside * aside).max(0.0).sqrt() + speed * frames;
        [nearest - half, nearest + half]
    }

    /// The map from the layer at rest, before it bends, to the scene at time `t`.
    pub fn pose(&self, t: f64) -> Affine {
        let swing = sin(t / self.period);
        let hop = (t / self.period).rem_euclid(1.0);
        let distance = super::shape::length(self.velocity) * t;
        let laps = self.lap.map_or(0.0, |[start, end]| ((distance - start) / (end - start)).floor() * (end - start));
        let travelled = if distance == 0.0 { 0.0 } else { t * (1.0 - laps / distance) };
        let path: Point = std::array::from_fn(|i| self.from[i] + self.velocity[i] * travelled + self.sway[i] * swing);
        let lifted = [path[0], path[1] - 4.0 * self.bounce * hop * (1.0 - hop)];
        Affine::similarity(self.turned + self.spin * t, grown(self.growth, t), lifted)
    }
}

/// The size at time `t` of what grows by the share `growth` in each frame until it has doubled (or halved), and
/// then goes back as fast, for ever. It turns round at a whole frame, so that every frame changes by exactly `growth`.
pub fn grown(growth: f64, t: f64) -> f64 {
    let rate = ln(1.0 + growth);
    if rate == 0.0 {
        return 1.0;
    }
    let frames = (std::f64::consts::LN_2 / rate.abs()).floor().max(1.0);
    exp(rate * there_and_back(t, frames))
}

/// A wave that runs along x through a cloth that is held at x = 0, stronger the farther out.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    /// How far the cloth's end goes up and down.
    pub height: f64,
    /// From crest to crest.
    pub wavelength: f64,
    /// Frames from one crest to the next.
    pub period: f64,
    /// How long the cloth is.
    pub reach: f64,
}

impl Wave {
    /// Where the cloth at `p` has come from.
    pub fn back(&self, p: Point, t: f64) -> Point {
        let [dx, dy] = self.push(p, t);
        [p[0] - dx, p[1] - dy]
    }

    /// Where the cloth's `rest` goes: the place that [`Wave::back`] brings back to `rest`, by Newton's method.
    pub fn forward(&self, rest: Point, t: f64) -> Point {
        let mut p = rest;
        for _ in 0..20 {
            let ([dx, dy], [[a, b], [c, d]]) = (self.push(p, t), self.stretch(p, t));
            let miss = [p[0] - dx - rest[0], p[1] - dy - rest[1]];
            let (a, b, c, d) = (1.0 - a, -b, -c, 1.0 - d);
            let det = a * d - b * c;
            let step = [(d * miss[0] - b * miss[1]) / det, (a * miss[1] - c * miss[0]) / det];
            p = [p[0] - step[0], p[1] - step[1]];
            if step[0].abs() + step[1].abs() < 1e-10 {
                break;
            }
        }
        p
    }

    /// How far the wave has brought what is now at `p`.
    fn push(&self, p: Point, t: f64) -> Point {
        let height = self.height * (p[0] / self.reach).clamp(0.0, MOST);
        let [along, up] = self.phases(p, t);
        [ALONG * height * cos(along), height * sin(up)]
    }

    /// How that changes with `p`: rows for its two parts, columns for x and y.
    fn stretch(&self, p: Point, t: f64) -> [Point; 2] {
        let share = p[0] / self.reach;
        let growth = if (0.0..MOST).contains(&share) { self.height / self.reach } else { 0.0 };
        let turn = std::f64::consts::TAU / self.wavelength * self.height * share.clamp(0.0, MOST);
        let [(sin, cos), (up, slope)] = self.phases(p, t).map(sin_cos);
        [[ALONG * (growth * cos - turn * sin), 0.0], [growth * up + turn * slope, SLANT * turn * slope]]
    }

    fn phases(&self, p: Point, t: f64) -> Point {
        let phase = p[0] / self.wavelength - t / self.period;
        [phase, phase + p[1] / self.wavelength * SLANT]
    }
}

/// How far a wave also pulls the cloth along, as a share of its height.
const ALONG: f64 = 0.3;

/// How much later the lower edge of the cloth rises.
const SLANT: f64 = 0.3;

/// Beyond the cloth's end the wave grows up to this share of its height and no more.
const MOST: f64 = 1.25;

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Point, b: Point) -> bool {
        (a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9
    }

    #[test]
    fn affine_maps_chain_and_invert() {
        let (a, b) = (Affine::similarity(0.1, 1.3, [4.0, -2.0]), Affine::similarity(-0.3, 0.7, [1.0, 9.0]));
        let p = [12.5, -7.25];
        assert!(near(a.then(&b).apply(p), b.apply(a.apply(p))));
        assert!(near(a.inverse().apply(a.apply(p)), p));
        assert!((a.area() - 1.69).abs() < 1e-12);
    }

    #[test]
    fn whole_shifts_are_exact() {
        let pose = Motion::drift([3.0, -2.0]).pose(7.0);
        assert_eq!((pose.apply([10.0, 20.0]), pose.inverse().apply([31.0, 6.0])), ([31.0, 6.0], [10.0, 20.0]));
    }

    #[test]
    fn what_leaves_comes_round_again() {
        let motion = Motion { lap: Some([-20.0, 80.0]), ..Motion::drift([10.0, 0.0]) };
        let at = [-1.0, 3.0, 7.5, 8.0, 10.0, 23.0].map(|t| motion.pose(t).shift[0].round());
        assert_eq!(at, [-10.0, 30.0, 75.0, -20.0, 0.0, 30.0]);
    }

    #[test]
    fn a_lap_ends_out_of_sight_on_either_side() {
        let motion = Motion { velocity: [3.0, 4.0], ..Motion::still([1.0, -2.0]) };
        // Passes [4, 2] at 5, whose distance from the middle is 0; or 10 aside of it.
        assert_eq!(motion.lap_around([4.0, 2.0], 26.0, 2.0), [5.0 - 36.0, 5.0 + 36.0]);
        assert_eq!(motion.lap_around([12.0, -4.0], 26.0, 2.0), [5.0 - 34.0, 5.0 + 34.0]);
        assert_eq!(motion.lap_around([84.0, -58.0], 26.0, 2.0), [5.0 - 10.0, 5.0 + 10.0]);
    }

    #[test]
    fn growing_turns_round_at_a_whole_frame() {
        for growth in [0.05, -0.05, 0.013, -0.001] {
            for t in 0..200 {
                let ratio = grown(growth, f64::from(t + 1)) / grown(growth, f64::from(t));
                assert!((ratio - 1.0 - growth).abs() < 1e-12 || (1.0 / ratio - 1.0 - growth).abs() < 1e-12);
                assert!((0.49..2.01).contains(&grown(growth, f64::from(t))));
            }
        }
        assert_eq!(grown(0.0, 17.0), 1.0);
    }

    #[test]
    fn waves_run_both_ways() {
        let wave = Wave { height: 14.0, wavelength: 110.0, period: 12.0, reach: 170.0 };
        for i in 0..200 {
            let (rest, t) = ([f64::from(i), f64::from(i % 13) * 9.0], f64::from(i) * 0.37);
            assert!(near(wave.back(wave.forward(rest, t), t), rest));
        }
    }
}
