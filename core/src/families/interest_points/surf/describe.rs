//! Orientation and descriptor of SURF from Haar wavelets on the integral image.

use std::f32::consts::{PI, TAU};

use crate::methods::features::integral::{Integral, PixelBox};

/// Samples within this many scales of the middle decide the orientation.
pub const WHEEL_REACH: i32 = 6;
/// Positions of the sliding sector.
pub const SECTORS: usize = 72;
/// The angle of the sector.
pub const SECTOR_RAD: f32 = PI / 3.0;
/// Subregions of the descriptor along an axis.
pub const SIDE: usize = 4;
/// Samples of a subregion along an axis.
const SAMPLES: usize = 5;
/// Values of the descriptor.
pub const VALUES: usize = 4 * SIDE * SIDE;

/// Place and scale of a keypoint, in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// Position.
    pub at: [f32; 2],
    /// Scale s.
    pub scale: f32,
}

impl Blob {
    /// The corner of pixels nearest to an offset in px: the wavelets have even sides, so that their middles are corners. A corner
    /// is called like the pixel below to its right.
    fn corner(&self, [i, j]: [f32; 2]) -> [i32; 2] {
        [self.at[0] + i, self.at[1] + j].map(|c| (c + 0.5).round() as i32)
    }
}

/// The responses of the Haar wavelets along x and y at a corner of pixels, of side 2 `half`: the mean of one half less that of the other, in gray
/// levels.
pub fn haar(integral: &Integral, [x, y]: [i32; 2], half: i32) -> [f32; 2] {
    let sum = |min: [i32; 2], size: [i32; 2]| integral.sum(PixelBox::new(min, size)) as f32;
    let area = (2 * half * half) as f32;
    let across = sum([x, y - half], [half, 2 * half]) - sum([x - half, y - half], [half, 2 * half]);
    let down = sum([x - half, y], [2 * half, half]) - sum([x - half, y - half], [2 * half, half]);
    [across / area, down / area]
}

/// Half the side of a wavelet of `sides` scales, at least 1 px.
fn half_side(scale: f32, sides: f32) -> i32 {
    ((sides * scale / 2.0).round() as i32).max(1)
}

/// A wavelet response around a keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spoke {
    /// The weighted responses along x and y.
    pub response: [f32; 2],
    /// Their direction in radians, 0 to 2π.
    pub angle_rad: f32,
}

/// The wavelet responses within 6 s, of wavelets of side 4 s, weighted with a Gaussian of 2 s.
pub fn wheel(integral: &Integral, blob: Blob) -> Vec<Spoke> {
    let half = half_side(blob.scale, 4.0);
    let places = (-WHEEL_REACH..=WHEEL_REACH).flat_map(|j| (-WHEEL_REACH..=WHEEL_REACH).map(move |i| (i, j)));
    let inside = places.filter(|(i, j)| i * i + j * j < WHEEL_REACH * WHEEL_REACH);
    let spoke = |(i, j): (i32, i32)| {
        let offset = [i, j].map(|c| c as f32 * blob.scale);
        let weight = (-((i * i + j * j) as f32) / 8.0).exp();
        let response = haar(integral, blob.corner(offset), half).map(|response| weight * response);
        Spoke { response, angle_rad: response[1].atan2(response[0]).rem_euclid(TAU) }
    };
    inside.map(spoke).collect()
}

/// The first direction of sector `k`.
pub fn sector_start(k: usize) -> f32 {
    k as f32 * TAU / SECTORS as f32
}

/// Whether a direction lies in a sector.
pub fn is_in_sector(angle_rad: f32, k: usize) -> bool {
    (angle_rad - sector_start(k)).rem_euclid(TAU) < SECTOR_RAD
}

/// The sum of the responses in each position of the sector; `tell` is called with each.
pub fn sector_sums(spokes: &[Spoke], mut tell: impl FnMut([f32; 2])) -> Vec<[f32; 2]> {
    let sum = |k: usize| {
        let inside = spokes.iter().filter(|spoke| is_in_sector(spoke.angle_rad, k));
        let sum = inside.fold([0.0; 2], |sum, spoke| [0, 1].map(|i| sum[i] + spoke.response[i]));
        tell(sum);
        sum
    };
    (0..SECTORS).map(sum).collect()
}

/// The sector with the longest sum, the first of equal ones, and the direction of that sum.
pub fn dominant(sums: &[[f32; 2]]) -> (usize, f32) {
    let squared = |[x, y]: [f32; 2]| x * x + y * y;
    let longest = (0..sums.len()).reduce(|best, k| if squared(sums[k]) > squared(sums[best]) { k } else { best });
    let best = longest.unwrap_or_default();
    let [x, y] = sums.get(best).copied().unwrap_or_default();
    (best, y.atan2(x))
}

/// The sums Σ d_x, Σ d_y, Σ |d_x|, Σ |d_y| of subregion `k` of the square of 20 s, of wavelets of side 2 s turned by the orientation
/// and weighted with a Gaussian of 3.3 s.
pub fn subregion(integral: &Integral, blob: Blob, angle_rad: f32, k: usize) -> [f32; 4] {
    let (sin, cos) = angle_rad.sin_cos();
    let half = half_side(blob.scale, 2.0);
    let [left, top] = [k % SIDE, k / SIDE].map(|index| index * SAMPLES);
    let mut sums = [0.0; 4];
    for (i, j) in (0..SAMPLES).flat_map(|j| (0..SAMPLES).map(move |i| (i, j))) {
        let middle = (SIDE * SAMPLES - 1) as f32 / 2.0;
        let [u, v] = [left + i, top + j].map(|index| index as f32 - middle);
        let weight = (-(u * u + v * v) / (2.0 * 3.3 * 3.3)).exp();
        let offset = [cos * u - sin * v, sin * u + cos * v].map(|c| c * blob.scale);
        let [x, y] = haar(integral, blob.corner(offset), half);
        let [along, across] = [cos * x + sin * y, cos * y - sin * x].map(|response| weight * response);
        for (sum, value) in sums.iter_mut().zip([along, across, along.abs(), across.abs()]) {
            *sum += value;
        }
    }
    sums
}

/// The corners of a subregion in the frame, in order around it.
pub fn subregion_corners(blob: Blob, angle_rad: f32, k: usize) -> Vec<[f32; 2]> {
    let (sin, cos) = angle_rad.sin_cos();
    let step = SAMPLES as f32;
    let [left, top] = [k % SIDE, k / SIDE].map(|index| (index as f32 - SIDE as f32 / 2.0) * step);
    let corners = [[0.0, 0.0], [step, 0.0], [step, step], [0.0, step]];
    let place = |[u, v]: [f32; 2]| {
        let [u, v] = [(left + u) * blob.scale, (top + v) * blob.scale];
        [blob.at[0] + cos * u - sin * v, blob.at[1] + sin * u + cos * v]
    };
    corners.map(place).to_vec()
}

/// The values scaled to unit length, and their length before; a flat neighbourhood stays 0.
pub fn normalized(values: &[f32]) -> (Vec<f32>, f32) {
    let length = values.iter().map(|value| value * value).sum::<f32>().sqrt();
    let factor = if length > 0.0 { 1.0 / length } else { 0.0 };
    (values.iter().map(|value| value * factor).collect(), length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn wavelets_see_a_slope_and_its_direction() {
        let integral = Integral::of(&Grid::from_fn(60, 60, |x, y| (x + 2 * y) as u8));
        assert_eq!(haar(&integral, [30, 30], 3), [3.0, 6.0], "the halves are 3 px apart");
        let blob = Blob { at: [30.0, 30.0], scale: 1.2 };
        let sums = sector_sums(&wheel(&integral, blob), |_| {});
        let (_, angle) = dominant(&sums);
        assert!((angle - 2f32.atan2(1.0)).abs() < 1e-3, "{angle}");
        // Along the gradient all subregions have the same sign, across it nothing.
        let values = subregion(&integral, blob, angle, 5);
        assert!(values[0] > 0.0 && values[1].abs() < 1e-3 * values[0] && (values[2] - values[0]).abs() < 1e-3);
    }

    #[test]
    fn a_flat_neighbourhood_has_no_length() {
        assert_eq!(normalized(&[0.0; 4]), (vec![0.0; 4], 0.0));
        assert_eq!(normalized(&[3.0, 0.0, 4.0]), (vec![0.6, 0.0, 0.8], 5.0));
    }
}
