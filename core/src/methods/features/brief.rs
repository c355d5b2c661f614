//! Oriented binary descriptors: the intensity centroid of a disc, and comparisons of pairs of windows turned by its direction.

use super::integral::{Integral, PixelBox};
use crate::geometry::Gray;
use crate::synth::random::{gaussian, hash};

/// The number of comparisons.
pub const BITS: usize = 256;

/// The bits of a descriptor.
pub type Bits = [u64; BITS / 64];

/// Offsets of the two windows that a bit compares.
pub type Pair = [[i32; 2]; 2];

/// Reach of the 5×5 px windows beyond their middle.
pub const WINDOW_REACH: i32 = 2;

/// The seed of the pattern: every run has the same one.
const SEED: u64 = 2011;

/// The pattern of a patch of this radius: offsets from a Gaussian with a variance of 1/25 of the squared side, as in BRIEF, so near
/// that the windows stay in the disc whatever its orientation.
pub fn pattern(radius: usize) -> Vec<Pair> {
    let (side, reach) = ((2 * radius + 1) as f64, radius as i32 - WINDOW_REACH);
    let mut draws = 0;
    let mut offset = || loop {
        draws += 1;
        let [x, y] = [0, 1].map(|axis| (gaussian(hash(SEED, draws, axis)) * side / 5.0).round() as i32);
        if x * x + y * y <= reach * reach {
            return [x, y];
        }
    };
    let mut pair = || loop {
        let [a, b] = [offset(), offset()];
        if a != b {
            return [a, b];
        }
    };
    (0..BITS).map(|_| pair()).collect()
}

/// The moments of a disc of pixels, relative to its centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moments {
    /// Sum of the gray levels.
    pub m00: i32,
    /// Sum of x times gray level.
    pub m10: i32,
    /// Sum of y times gray level.
    pub m01: i32,
}

impl Moments {
    /// The moments of the disc of this radius around a pixel, which lies in the picture.
    pub fn of(picture: &Gray, (x, y): (usize, usize), radius: usize) -> Self {
        let mut moments = Self::default();
        for j in -(radius as i32)..=radius as i32 {
            let half = half_width(radius, j);
            let row = picture.row((y as i32 + j) as usize);
            let row = &row[x - half as usize..=x + half as usize];
            let (mut sum, mut first) = (0, 0);
            for (i, level) in (-half..).zip(row) {
                sum += i32::from(*level);
                first += i * i32::from(*level);
            }
            moments.m00 += sum;
            moments.m10 += first;
            moments.m01 += j * sum;
        }
        moments
    }

    /// The intensity centroid relative to the centre, in px.
    pub fn centroid(&self) -> [f32; 2] {
        [self.m10, self.m01].map(|moment| moment as f32 / self.m00.max(1) as f32)
    }

    /// The unit vector from the centre to the centroid; to the right if both coincide. It turns exactly with a picture that is
    /// turned by 90°.
    pub fn direction(&self) -> [f32; 2] {
        let [x, y] = [self.m10, self.m01].map(|moment| moment as f32);
        let length = (x * x + y * y).sqrt();
        if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] }
    }

    /// The orientation in radians, from x towards y.
    pub fn angle_rad(&self) -> f32 {
        (self.m01 as f32).atan2(self.m10 as f32)
    }
}

/// Half the width of row `j` of a disc.
fn half_width(radius: usize, j: i32) -> i32 {
    ((radius * radius) as f32 - (j * j) as f32).sqrt() as i32
}

/// A pair turned by a direction, to whole px.
#[inline(always)]
pub fn turned(pair: Pair, [c, s]: [f32; 2]) -> Pair {
    pair.map(|[x, y]| {
        let [x, y] = [x as f32, y as f32];
        [c * x - s * y, s * x + c * y].map(|offset| offset.round() as i32)
    })
}

/// The sum of the window at an offset from a pixel.
#[inline(always)]
pub fn window_sum(integral: &Integral, (x, y): (usize, usize), [i, j]: [i32; 2]) -> u32 {
    const SIDE: i32 = 2 * WINDOW_REACH + 1;
    let min = [x as i32 + i - WINDOW_REACH, y as i32 + j - WINDOW_REACH];
    integral.sum(PixelBox::new(min, [SIDE; 2]))
}

/// The descriptor of a pixel: a bit is 1 where the first window of its pair is darker. `tell` is called with each bit.
pub fn describe(
    integral: &Integral,
    place: (usize, usize),
    (pattern, direction): (&[Pair], [f32; 2]),
    mut tell: impl FnMut(usize, bool),
) -> Bits {
    let mut bits = Bits::default();
    for (k, pair) in pattern.iter().enumerate() {
        let [a, b] = turned(*pair, direction).map(|offset| window_sum(integral, place, offset));
        bits[k / 64] |= u64::from(a < b) << (k % 64);
        tell(k, a < b);
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn the_pattern_stays_in_the_disc_and_spreads_as_a_gaussian() {
        for radius in [7, 15, 31] {
            let pattern = pattern(radius);
            let reach = radius as i32 - WINDOW_REACH;
            assert_eq!(pattern.len(), BITS);
            assert!(pattern.iter().flatten().all(|[x, y]| x * x + y * y <= reach * reach));
            assert!(pattern.iter().all(|[a, b]| a != b));
            let mean = |of: &dyn Fn(&[i32; 2]) -> i32| {
                pattern.iter().flatten().map(|offset| f64::from(of(offset))).sum::<f64>() / (2 * BITS) as f64
            };
            assert!(mean(&|[x, _]| *x).abs() < 0.1 * radius as f64 && mean(&|[_, y]| *y).abs() < 0.1 * radius as f64);
        }
    }

    #[test]
    fn moments_are_those_of_the_disc() {
        let picture = Grid::from_fn(31, 31, |x, y| ((x * 37 + y * 101 + x * y * 13) % 256) as u8);
        let mut plain = Moments::default();
        for (i, j) in (-9i32..=9).flat_map(|j| (-9i32..=9).map(move |i| (i, j))).filter(|(i, j)| i * i + j * j <= 81) {
            let level = i32::from(picture[((15 + i) as usize, (15 + j) as usize)]);
            plain.m00 += level;
            plain.m10 += i * level;
            plain.m01 += j * level;
        }
        assert_eq!(Moments::of(&picture, (15, 15), 9), plain);
        assert_eq!(Moments::of(&Grid::new(31, 31, 0), (15, 15), 9).direction(), [1.0, 0.0]);
    }
}
