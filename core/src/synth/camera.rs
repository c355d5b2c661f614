//! Effects of light and camera on a picture; none changes the motion.

use rayon::prelude::*;

use super::compression;
use super::difficulty::Difficulty;
use super::maths::there_and_back;
use super::random::{gaussian, hash, unit};
use super::stage::{Moment, Stage};
use super::texture::Rgb;
use crate::data::{Frame, Viewpoint};
use crate::geometry::Grid;

/// A stream of random numbers for each use, so that one slider does not change what another does.
const FLICKER: u64 = 1 << 32;
const GAUSSIAN: u64 = 2 << 32;
const SALT_AND_PEPPER: u64 = 3 << 32;

/// Added to the number of a frame of the right view, so that its noise is another.
const RIGHT: u64 = 1 << 16;

/// Frame `t` as the camera at a viewpoint takes it.
pub fn take((stage, viewpoint): (&Stage, Viewpoint), d: &Difficulty, t: usize) -> Frame {
    let moments = exposure((stage, viewpoint), d, t);
    let share = 1.0 / moments.len() as f32;
    let camera = Camera::new(viewpoint, d, t);
    let mut picture = Grid::new(d.width, d.height, [0u8; 3]);
    picture.cells_mut().par_chunks_mut(d.width).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let p = [x as f64, y as f64];
            let sum = moments.iter().map(|moment| moment.color(p)).fold([0.0; 3], add);
            *pixel = camera.record(sum.map(|c| c * share), (y * d.width + x) as u64);
        }
    });
    if d.compression > 0 {
        compression::compress(&mut picture, 100 - d.compression);
    }
    Frame::rgb(picture)
}

fn add(a: Rgb, b: Rgb) -> Rgb {
    std::array::from_fn(|c| a[c] + b[c])
}

/// The moments while the shutter is open, about frame `t`: enough of them that nothing moves on by more than a pixel
/// from one to the next, within reason (beyond 16 px, steps get longer).
fn exposure<'a>((stage, viewpoint): (&'a Stage, Viewpoint), d: &Difficulty, t: usize) -> Vec<Moment<'a>> {
    const MOST: usize = 17;
    let at = |time| stage.seen_from(viewpoint, time);
    let now = at(t as f64);
    if d.motion_blur == 0.0 {
        return vec![now];
    }
    let open = f64::from(d.motion_blur) / 100.0;
    let smear = open * fastest(&now, &at(t as f64 + 1.0), d);
    let count = (smear.ceil() as usize + 1).clamp(2, MOST);
    (0..count).map(|i| at(t as f64 + open * ((i as f64 + 0.5) / count as f64 - 0.5))).collect()
}

/// The greatest motion in px/frame, looked for on a lattice of 16 px.
fn fastest(now: &Moment, next: &Moment, d: &Difficulty) -> f64 {
    let lattice = (0..d.height).step_by(16).flat_map(|y| (0..d.width).step_by(16).map(move |x| [x as f64, y as f64]));
    lattice
        .filter_map(|p| {
            let ([x, y], _) = now.follow(now.foremost(p)?, p, next)?;
            Some((x - p[0]).abs().max((y - p[1]).abs()))
        })
        .fold(0.0, f64::max)
}

/// Light and sensor at one frame.
struct Camera<'a> {
    difficulty: &'a Difficulty,
    frame: u64,
    gain: f32,
    offset: f32,
}

impl<'a> Camera<'a> {
    fn new(viewpoint: Viewpoint, d: &'a Difficulty, t: usize) -> Self {
        /// Frames after which the light goes back; more would leave nothing but white or black.
        const TURN: f64 = 4.0;
        let steps = there_and_back(t as f64, TURN);
        let swell = (0..steps as usize).fold(1.0, |gain, _| gain * (1.0 + d.gain / 100.0));
        let chance = unit(hash(u64::from(d.seed), FLICKER, t as u64)) as f32 * 2.0 - 1.0;
        let flicker = 1.0 + chance * d.flicker / 100.0;
        let frame = t as u64 + if viewpoint == Viewpoint::Right { RIGHT } else { 0 };
        Self { difficulty: d, frame, gain: swell * flicker, offset: d.offset * steps as f32 }
    }

    fn record(&self, color: Rgb, pixel: u64) -> [u8; 3] {
        let d = self.difficulty;
        let random = |stream| hash(u64::from(d.seed), stream | self.frame, pixel);
        if d.salt_and_pepper > 0.0 {
            let h = random(SALT_AND_PEPPER);
            if unit(h) * 100.0 < f64::from(d.salt_and_pepper) {
                return [if h & 1 == 0 { 0 } else { 255 }; 3];
            }
        }
        let mut shift = self.offset;
        if d.noise > 0.0 {
            shift += d.noise * gaussian(random(GAUSSIAN)) as f32;
        }
        color.map(|c| (c * self.gain + shift + 0.5) as u8)
    }
}
