//! Textures that can be evaluated at any real coordinate, so that motion by a part of a pixel is exact.
//!
//! They know how large a pixel is and leave out what is finer, so that nothing flickers when a scene shrinks.

use super::maths::floor;
use super::random::{lattice, lattice_square};

/// A colour, 0 to 255 in each of red, green and blue.
pub type Rgb = [f32; 3];

/// A place on a layer, in the layer's own coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// To the right.
    pub x: f64,
    /// Down.
    pub y: f64,
    /// How wide a pixel of the picture is here, in the layer's coordinates.
    pub pixel: f64,
}

impl Spot {
    /// The same pixel moved and stretched: coordinates are shifted by `-(x, y)` and divided by `scale`.
    pub fn relative(self, [x, y]: [f64; 2], scale: f64) -> Self {
        Self { x: (self.x - x) / scale, y: (self.y - y) / scale, pixel: self.pixel / scale }
    }

    /// How much of this pixel is on the inner side of an edge that is `inside` away (negative outside).
    pub fn cover(self, inside: f64) -> f32 {
        smooth((inside / self.pixel * 0.6 + 0.5) as f32)
    }

    /// Fractal noise: `octaves` of gradient noise, each half as large and half as strong; about −1 to 1.
    pub fn fractal(self, seed: u32, wavelength: f64, octaves: u32) -> f32 {
        let (mut frequency, mut strength) = (1.0 / wavelength, 1.0);
        let mut pixels = (wavelength / self.pixel) as f32;
        let mut sum = 0.0;
        for octave in 0..octaves {
            let seen = smooth(pixels * 0.5 - 1.0);
            if seen <= 0.0 {
                break;
            }
            let noise = gradient_noise(seed.wrapping_add(octave), self.x * frequency, self.y * frequency);
            sum += seen * strength * noise;
            (frequency, strength, pixels) = (frequency * 2.0, strength * 0.5, pixels * 0.5);
        }
        sum
    }

    /// Fractal noise that is `stretch` times longer in x than in y.
    pub fn streaks(self, seed: u32, wavelength: f64, stretch: f64, octaves: u32) -> f32 {
        Spot { x: self.x / stretch, ..self }.fractal(seed, wavelength, octaves)
    }

    /// The same spot pushed about by noise, which turns even patterns into organic ones.
    pub fn warped(self, seed: u32, wavelength: f64, strength: f64) -> Self {
        let push = |seed| f64::from(self.fractal(seed, wavelength, 1)) * strength;
        Self { x: self.x + push(seed), y: self.y + push(seed.wrapping_add(77)), ..self }
    }
}

/// Smooth noise with a random slope at every whole coordinate and zero there; about −1 to 1 (Perlin 1985, 2002).
fn gradient_noise(seed: u32, x: f64, y: f64) -> f32 {
    let ((x0, fx), (y0, fy)) = (split(x), split(y));
    let [a, b, c, d] = lattice_square(seed, x0, y0);
    let slope =
        |h: u32, dx: f32, dy: f32| ((h & 0xffff) as i32 - 32_768) as f32 * dx + ((h >> 16) as i32 - 32_768) as f32 * dy;
    let fade = |f: f32| f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let (wx, wy) = (fade(fx), fade(fy));
    let (a, b) = (slope(a, fx, fy), slope(b, fx - 1.0, fy));
    let (c, d) = (slope(c, fx, fy - 1.0), slope(d, fx - 1.0, fy - 1.0));
    let (top, bottom) = (a + (b - a) * wx, c + (d - c) * wx);
    (top + (bottom - top) * wy) / 16_384.0
}

/// A whole number and what is beyond it, from 0 to 1; on a whole number it may be the one below, and 1.
/// Adding 1.5·2⁵² leaves no bits for a fraction, which is much faster than asking for the floor.
fn split(x: f64) -> (i32, f32) {
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    let shifted = (x - 0.5) + WHOLE;
    (shifted.to_bits() as i32, (x - (shifted - WHOLE)) as f32)
}

/// Where the nearest of randomly strewn points is, one in each unit cell (Worley 1996).
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// How far the border with the next cell is, in cells.
    pub border: f64,
    /// A random number of this cell.
    pub hash: u32,
    /// From the point to the spot, in cells.
    pub offset: [f64; 2],
}

/// The cell around `spot`, for cells of size `size`.
pub fn cell(seed: u32, spot: Spot, size: f64) -> Cell {
    let (x, y) = (spot.x / size, spot.y / size);
    let (x0, y0) = (floor(x), floor(y));
    let mut nearest = (f64::MAX, 0, [0.0; 2]);
    let mut second = f64::MAX;
    for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
        let (cx, cy) = (x0.wrapping_add(dx), y0.wrapping_add(dy));
        let h = lattice(seed, cx, cy);
        let jitter = |bits: u32| f64::from(bits & 0xffff) / 65_536.0 * 0.7 + 0.15;
        let offset = [x - f64::from(cx) - jitter(h), y - f64::from(cy) - jitter(h >> 16)];
        let distance = offset[0] * offset[0] + offset[1] * offset[1];
        if distance < nearest.0 {
            second = nearest.0;
            nearest = (distance, h, offset);
        } else if distance < second {
            second = distance;
        }
    }
    Cell { border: (second.sqrt() - nearest.0.sqrt()) * 0.5, hash: nearest.1, offset: nearest.2 }
}

/// 0 up to 0, 1 from 1 on, and smoothly between.
pub fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// The colour `0xRRGGBB`.
pub const fn rgb(hex: u32) -> Rgb {
    [((hex >> 16) & 255) as f32, ((hex >> 8) & 255) as f32, (hex & 255) as f32]
}

/// `a` at 0, `b` at 1.
pub fn mix(a: Rgb, b: Rgb, share: f32) -> Rgb {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * share)
}

/// `top`, which is asked for only where it is seen, over `base`.
pub fn over(base: Rgb, cover: f32, top: impl FnOnce() -> Rgb) -> Rgb {
    if cover > 0.0 { mix(base, top(), cover) } else { base }
}

/// A colour made lighter by `factor` (darker below 1).
pub fn shade(color: Rgb, factor: f32) -> Rgb {
    color.map(|c| c * factor)
}

/// The colour at `at` on a scale that runs smoothly through `colors`, from 0 to 1.
pub fn ramp(colors: &[Rgb], at: f32) -> Rgb {
    let last = colors.len().saturating_sub(1);
    let place = at.clamp(0.0, 1.0) * last as f32;
    let from = (place as usize).min(last);
    let to = (from + 1).min(last);
    colors.get(from).zip(colors.get(to)).map_or([0.0; 3], |(&a, &b)| mix(a, b, smooth(place - from as f32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spots() -> impl Iterator<Item = Spot> {
        (0..4000).map(|i| Spot { x: f64::from(i) * 0.731 - 900.0, y: f64::from(i) * 0.417 - 400.0, pixel: 1.0 })
    }

    #[test]
    fn splitting_finds_the_whole_and_the_rest() {
        for i in -4000..4000 {
            let x = f64::from(i) * 0.125;
            let (whole, rest) = split(x);
            assert_eq!(f64::from(whole) + f64::from(rest), x);
            assert!((0.0..=1.0).contains(&rest));
        }
        assert!(split(1e300).1.is_finite());
    }

    #[test]
    fn noise_is_centred_and_bounded() {
        let values: Vec<f32> = spots().map(|s| s.fractal(5, 20.0, 4)).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        assert!(mean.abs() < 0.1, "{mean}");
        assert!(values.iter().all(|v| v.abs() < 2.0));
        assert!(values.iter().any(|v| *v > 0.4) && values.iter().any(|v| *v < -0.4));
    }

    #[test]
    fn noise_has_no_jumps() {
        for spot in spots() {
            let next = Spot { x: spot.x + 1e-6, ..spot };
            assert!((spot.fractal(5, 16.0, 4) - next.fractal(5, 16.0, 4)).abs() < 1e-5);
        }
    }

    #[test]
    fn what_is_finer_than_a_pixel_is_left_out() {
        assert!(spots().all(|s| Spot { pixel: 10.0, ..s }.fractal(5, 20.0, 4) == 0.0));
    }

    #[test]
    fn cells_border_each_other_without_a_gap() {
        assert!(spots().all(|s| cell(9, s, 12.0).border >= 0.0));
        assert!(spots().any(|s| cell(9, s, 12.0).border < 0.02) && spots().any(|s| cell(9, s, 12.0).border > 0.25));
    }

    #[test]
    fn a_ramp_runs_from_first_to_last() {
        let colors = [rgb(0x000000), rgb(0x804020), rgb(0xffffff)];
        assert_eq!((ramp(&colors, -1.0), ramp(&colors, 0.5), ramp(&colors, 2.0)), (colors[0], colors[1], colors[2]));
        assert_eq!(ramp(&[], 0.5), [0.0; 3]);
    }
}
