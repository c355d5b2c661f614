//! Clips of a street as a cheap camera sees it, with true masks: shake, noise, flicker, cast shadows and a tree in the wind.

use motionscope_core::data::{Clip, Frame, Mask};
use motionscope_core::geometry::{Bounds, Grid};

/// The difficulties of a rough clip.
#[derive(Clone, Copy, Debug)]
pub struct Rough {
    pub size: (usize, usize),
    pub frames: usize,
    pub seed: u64,
    /// Standard deviation of the camera's position in px.
    pub shake: f64,
    /// Drift of the camera in px/frame.
    pub drift: [f64; 2],
    /// Standard deviation of the noise in gray levels.
    pub noise: f64,
    /// Share of the pixels with five times as much noise.
    pub speckle: f64,
    /// Standard deviation of the brightness, as a share.
    pub flicker: f64,
    /// Brightness of a cast shadow, as a share of the lit surface; 1 for none.
    pub shadow: f64,
}

impl Default for Rough {
    fn default() -> Self {
        let drift = [0.0; 2];
        Self {
            size: (320, 240),
            frames: 100,
            seed: 1,
            shake: 0.3,
            drift,
            noise: 3.0,
            speckle: 0.0,
            flicker: 0.01,
            shadow: 0.6,
        }
    }
}

fn hash(seed: u64, x: i64, y: i64) -> u64 {
    let mut h = seed ^ (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
    h ^= h >> 29;
    h = h.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    h ^= h >> 32;
    h.wrapping_mul(0x94D0_49BB_1331_11EB) >> 11
}

fn unit(seed: u64, x: i64, y: i64) -> f64 {
    hash(seed, x, y) as f64 / (1u64 << 53) as f64
}

/// About normal with a standard deviation of 1.
fn normal(seed: u64, x: i64, y: i64) -> f64 {
    let sum: f64 = (0..4).map(|k| unit(seed.wrapping_add(k * 7919), x, y)).sum();
    (sum - 2.0) * 3f64.sqrt()
}

/// Smooth noise of −1 to 1 at any place.
fn texture(seed: u64, x: f64, y: f64, period: f64) -> f64 {
    let (u, v) = (x / period, y / period);
    let (i, j) = (u.floor(), v.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (a, b) = (ease(u - i), ease(v - j));
    let at = |di: i64, dj: i64| unit(seed, i as i64 + di, j as i64 + dj) * 2.0 - 1.0;
    let row = |dj: i64| at(0, dj) + a * (at(1, dj) - at(0, dj));
    row(0) + b * (row(1) - row(0))
}

struct Car {
    color: [f64; 3],
    half: [f64; 2],
    at: [f64; 2],
}

impl Rough {
    fn cars(&self, t: f64) -> Vec<Car> {
        let (width, height) = (self.size.0 as f64, self.size.1 as f64);
        (0..4)
            .map(|i| {
                let chance = |k: i64| unit(self.seed + 50, i, k);
                let speed = (1.5 + 2.0 * chance(0)) * if i % 2 == 0 { 1.0 } else { -1.0 };
                let span = width + 120.0;
                let x = (chance(1) * span + speed * t).rem_euclid(span) - 60.0;
                let y = height * (0.36 + 0.16 * i as f64) + 6.0 * chance(2);
                let tint = |k: i64| 190.0 * chance(k) + 40.0;
                let mut color = [tint(3), tint(4), tint(5)];
                // A car is brighter or darker than the road.
                let luma = |of: [f64; 3]| 0.299 * of[0] + 0.587 * of[1] + 0.114 * of[2];
                if (luma(color) - 108.0).abs() < 35.0 {
                    let by = if chance(8) < 0.5 { 60.0 } else { -60.0 };
                    color = color.map(|c| (c + by).clamp(15.0, 240.0));
                }
                Car { color, half: [16.0 + 10.0 * chance(6), 9.0 + 4.0 * chance(7)], at: [x, y] }
            })
            .collect()
    }

    fn ground(&self, [x, y]: [f64; 2], t: f64) -> [f64; 3] {
        let height = self.size.1 as f64;
        let seed = self.seed;
        let fine = 9.0 * texture(seed + 1, x, y, 3.0) + 8.0 * texture(seed + 2, x, y, 17.0);
        if y < height * 0.2 {
            // Leaves in the wind.
            let sway = 0.8 * (0.9 * t + 0.05 * x).sin();
            let leaf = 38.0 * texture(seed + 3, x + sway, y + 0.4 * sway, 5.0);
            return [70.0 + leaf, 105.0 + leaf, 55.0 + leaf];
        }
        let is_line = (y - height * 0.52).abs() < 1.5 && x.rem_euclid(40.0) < 20.0 || (y - height * 0.93).abs() < 2.0;
        let base = if is_line { 205.0 } else { 108.0 };
        [base + fine, base + fine, 1.03 * (base + fine)]
    }

    /// The color of a place of the scene, and whether it is an object.
    fn look(&self, place: [f64; 2], cars: &[Car], t: f64) -> ([f64; 3], bool) {
        let inside = |car: &Car, by: [f64; 2]| (0..2).all(|i| (place[i] - car.at[i] - by[i]).abs() <= car.half[i]);
        if let Some(car) = cars.iter().find(|car| inside(car, [0.0; 2])) {
            let [u, v] = [0, 1].map(|i| place[i] - car.at[i]);
            let paint = 12.0 * texture(self.seed + 9, u, v, 6.0);
            let is_glass = (u.abs() - 6.0).abs() < 2.5 && v.abs() < car.half[1] - 2.0;
            let color = if is_glass { [45.0, 55.0, 70.0] } else { car.color };
            return (color.map(|c| c + paint), true);
        }
        let ground = self.ground(place, t);
        let is_dark = cars.iter().any(|car| inside(car, [5.0, 7.0]));
        (if is_dark { ground.map(|c| self.shadow * c) } else { ground }, false)
    }

    /// The displacement of the camera in px.
    fn camera(&self, t: usize) -> [f64; 2] {
        let jitter = |k: u64| self.shake * normal(self.seed + 20 + k, t as i64, 0);
        [0, 1].map(|i| jitter(i as u64) + self.drift[i] * t as f64)
    }

    /// The boxes of the cars in a frame, in or beside the picture, each at its own place of the list.
    pub fn boxes(&self, t: usize) -> Vec<Bounds> {
        let camera = self.camera(t);
        let of = |car: Car| {
            let center = [0, 1].map(|i| (car.at[i] - camera[i]) as f32);
            Bounds::around(center, car.half.map(|half| 2.0 * half as f32))
        };
        self.cars(t as f64).into_iter().map(of).collect()
    }

    fn frame(&self, t: usize) -> (Frame, Mask) {
        let (width, height) = self.size;
        let camera = self.camera(t);
        let gain = 1.0 + self.flicker * normal(self.seed + 30, t as i64, 1);
        let cars = self.cars(t as f64);
        let mut picture = Grid::new(width, height, [0u8; 3]);
        let mask = Mask::from_fn(width, height, |x, y| {
            let (color, is_object) = self.look([x as f64 + camera[0], y as f64 + camera[1]], &cars, t as f64);
            let pixel = (y * width + x) as i64;
            let is_speckled = self.speckle > 0.0 && unit(self.seed + 60, t as i64, pixel) < self.speckle;
            let noise = if is_speckled { 5.0 * self.noise } else { self.noise };
            let noisy = |c: usize| gain * color[c] + noise * normal(self.seed + 40 + c as u64, t as i64, pixel);
            picture[(x, y)] = [0, 1, 2].map(|c| noisy(c).round().clamp(0.0, 255.0) as u8);
            is_object
        });
        (Frame::rgb(picture), mask)
    }

    /// The clip and its true masks.
    pub fn clip(&self) -> (Clip, Vec<Mask>) {
        let (frames, masks) = (0..self.frames).map(|t| self.frame(t)).unzip();
        (Clip::from_frames("rough", frames).expect("frames of one size"), masks)
    }
}

/// Precision, recall and F₁ of masks.
pub fn scored<'a>(pairs: impl Iterator<Item = (&'a Mask, &'a Mask)>) -> [f64; 3] {
    let (mut hits, mut found, mut all) = (0, 0, 0);
    for (mask, truth) in pairs {
        hits += mask.count() - mask.without(truth).count();
        found += mask.count();
        all += truth.count();
    }
    let [precision, recall] = [found, all].map(|count| hits as f64 / count.max(1) as f64);
    [precision, recall, 2.0 * precision * recall / (precision + recall).max(1e-9)]
}
