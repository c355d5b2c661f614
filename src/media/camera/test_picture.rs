//! A moving pattern instead of a camera: textured discs before a textured background.

use std::f64::consts::TAU;
use std::future::ready;

use motionscope_core::base::{Error, Stop};
use web_time::{Duration, Instant};

use super::{CameraFeed, Format, Size};
use crate::media::numbers::whole;
use crate::work::{self, Boxed};

/// Frames per second.
const RATE: f64 = 30.0;
/// Times around its path that a disc goes in a second, its radius and the extent of its path in shares of the height, and its
/// colour (U, V).
const DISCS: [Disc; 3] = [
    Disc { turns_hz: [0.11, 0.07], radius: 0.16, path: [0.50, 0.28], color: [90, 190] },
    Disc { turns_hz: [-0.08, 0.13], radius: 0.12, path: [0.42, 0.32], color: [180, 100] },
    Disc { turns_hz: [0.05, -0.17], radius: 0.09, path: [0.55, 0.36], color: [70, 70] },
];

/// A disc that moves along a closed curve.
struct Disc {
    turns_hz: [f64; 2],
    radius: f64,
    path: [f64; 2],
    color: [u8; 2],
}

/// Frames of the pattern, 30 each second.
pub struct TestPicture {
    size: [usize; 2],
    background: Vec<u8>,
    begun: Instant,
    next: u64,
}

impl TestPicture {
    /// The pattern in frames of a size.
    pub fn new(size: Size) -> Self {
        let [width, height] = [size.width, size.height].map(|side| side.max(2));
        let luma = (0..width * height).map(|i| texture([i % width, i / width], 1, 150));
        let mut background: Vec<u8> = luma.collect();
        background.resize(width * height + 2 * width.div_ceil(2) * height.div_ceil(2), 128);
        Self { size: [width, height], background, begun: Instant::now(), next: 0 }
    }

    /// The samples of frame `index`: luma, then both planes of chroma.
    fn samples(&self, index: u64) -> Vec<u8> {
        let mut samples = self.background.clone();
        let (luma, chroma) = samples.split_at_mut(self.size[0] * self.size[1]);
        let (u, v) = chroma.split_at_mut(chroma.len() / 2);
        for (seed, disc) in (2..).zip(&DISCS) {
            self.draw(disc, (index, seed), [&mut *luma, &mut *u, &mut *v]);
        }
        samples
    }

    /// Draws a disc in frame `index`, with the texture of a seed.
    fn draw(&self, disc: &Disc, (index, seed): (u64, u32), [luma, u, v]: [&mut [u8]; 3]) {
        let [width, height] = self.size;
        let seconds = index as f64 / RATE;
        let turn = [0, 1].map(|i| (TAU * disc.turns_hz[i] * seconds + f64::from(seed)).sin());
        let center = [0, 1].map(|i| self.size[i] as f64 / 2.0 + disc.path[i] * height as f64 * turn[i]);
        // Whole pixels, so that the texture moves with the disc.
        let [x0, y0] = center.map(|c| whole(c.round()).unwrap_or(0_i64));
        let radius = whole((disc.radius * height as f64).round()).unwrap_or(0_i64);
        for dy in -radius..=radius {
            let reach = whole(((radius * radius - dy * dy) as f64).sqrt()).unwrap_or(0_i64);
            let Some(y) = usize::try_from(y0 + dy).ok().filter(|y| *y < height) else { continue };
            for dx in -reach..=reach {
                let Some(x) = usize::try_from(x0 + dx).ok().filter(|x| *x < width) else { continue };
                luma[y * width + x] = texture([dx, dy].map(|c| usize::try_from(c + radius).unwrap_or(0)), seed, 90);
                let at = y / 2 * width.div_ceil(2) + x / 2;
                [u[at], v[at]] = disc.color;
            }
        }
    }
}

impl CameraFeed for TestPicture {
    fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
        self.begun = Instant::now();
        let [width, height] = self.size;
        let format = Format::parse(format!("YUV4MPEG2 W{width} H{height} F30:1 Ip A1:1 C420jpeg").as_bytes());
        Box::pin(ready(format))
    }

    fn next<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
        Box::pin(async {
            stop.check()?;
            // As with a camera, frames that were not taken in time are dropped.
            let now = whole(self.begun.elapsed().as_secs_f64() * RATE).unwrap_or(self.next);
            let index = self.next.max(now);
            let due = Duration::from_secs_f64(index as f64 / RATE);
            work::sleep(due.saturating_sub(self.begun.elapsed())).await;
            self.next = index + 1;
            Ok(Some(self.samples(index)))
        })
    }
}

/// The gray level of a smooth random texture at a place: cells of 24 and 6 px around a mean.
fn texture([x, y]: [usize; 2], seed: u32, mean: u8) -> u8 {
    let noise = |cell: usize| {
        let [(i, fx), (j, fy)] = [x, y].map(|c| (c / cell, (c % cell) as f32 / cell as f32));
        let at = |di: usize, dj: usize| random([i + di, j + dj, cell], seed);
        let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
        mix(mix(at(0, 0), at(1, 0), fx), mix(at(0, 1), at(1, 1), fx), fy)
    };
    whole((f32::from(mean) + 60.0 * noise(24) + 40.0 * noise(6)).into()).unwrap_or(mean)
}

/// A random number from −0.5 to 0.5 for numbers and a seed.
fn random(numbers: [usize; 3], seed: u32) -> f32 {
    let mixed = numbers.iter().fold(seed, |hash, &number| {
        let hash = (hash ^ u32::try_from(number).unwrap_or(u32::MAX)).wrapping_mul(0x9E37_79B1);
        hash ^ hash >> 15
    });
    mixed as f32 / u32::MAX as f32 - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_keeps_its_texture_as_it_moves() {
        let mut pattern = TestPicture::new(Size::new(159, 121));
        let format = work::finish(pattern.begin(&Stop::default())).unwrap();
        assert_eq!(format.size(), (159, 121), "odd sides stay");
        assert_eq!(pattern.samples(0).len(), format.frame_bytes());
        let [first, later] = [0, 3].map(|index| format.frame(pattern.samples(index)).unwrap());
        let (a, b) = (first.luma(), later.luma());
        assert_eq!(pattern.samples(3), pattern.samples(3), "a frame is the same whenever it is made");
        let changed = a.cells().iter().zip(b.cells()).filter(|(a, b)| a != b).count();
        assert!((200..8000).contains(&changed), "{changed} px of {}", a.cells().len());
        assert!(first.color().is_some());
    }

    #[test]
    fn thirty_frames_come_each_second() {
        let (mut pattern, stop) = (TestPicture::new(Size::new(32, 32)), Stop::default());
        work::finish(pattern.begin(&stop)).unwrap();
        let begun = Instant::now();
        for _ in 0..7 {
            assert!(work::finish(pattern.next(&stop)).unwrap().is_some());
        }
        assert!(begun.elapsed() >= Duration::from_millis(190), "{:?}", begun.elapsed());
        stop.set(true);
        assert!(work::finish(pattern.next(&stop)).is_err());
    }
}
