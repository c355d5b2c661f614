//! Orientation and descriptor of SURF from Haar wavelets on the integral image.

use std::f32::consts::{PI, TAU};
use std::sync::LazyLock;

use super::integral::Integral;
use crate::base::wide::wide;

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
    #[inline(always)]
    fn corner(&self, [i, j]: [f32; 2]) -> [i32; 2] {
        [self.at[0] + i, self.at[1] + j].map(|c| (c + 0.5).round() as i32)
    }
}

/// The responses of the Haar wavelets along x and y at a corner of pixels, of side 2 `half`: the mean of one half less that of the other, in gray
/// levels.
#[inline(always)]
pub fn haar(integral: &Integral, at: [i32; 2], half: i32) -> [f32; 2] {
    let corners = integral.around(at, half);
    let sum = |[left, top]: [usize; 2], [right, bottom]: [usize; 2]| {
        let [above, below] = [corners[top], corners[bottom]];
        below[right].wrapping_sub(above[right]).wrapping_sub(below[left]).wrapping_add(above[left])
    };
    let area = (2 * half * half) as f32;
    // A half has less than 2²⁴ gray levels, so the difference is exact.
    let difference = |one: u32, other: u32| one.wrapping_sub(other) as i32 as f32 / area;
    [difference(sum([1, 0], [2, 2]), sum([0, 0], [1, 2])), difference(sum([0, 1], [2, 2]), sum([0, 0], [2, 1]))]
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

/// The offsets in scales of the wavelets that decide the orientation, and their weights.
static WHEEL: LazyLock<Vec<([f32; 2], f32)>> = LazyLock::new(|| {
    let places = (-WHEEL_REACH..=WHEEL_REACH).flat_map(|j| (-WHEEL_REACH..=WHEEL_REACH).map(move |i| (i, j)));
    let inside = places.filter(|(i, j)| i * i + j * j < WHEEL_REACH * WHEEL_REACH);
    inside.map(|(i, j)| ([i as f32, j as f32], (-((i * i + j * j) as f32) / 8.0).exp())).collect()
});

/// The wavelet responses within 6 s, of wavelets of side 4 s, weighted with a Gaussian of 2 s.
pub fn wheel(integral: &Integral, blob: Blob) -> Vec<Spoke> {
    wide! {
        fn measure(spokes: &mut Vec<Spoke>, integral: &Integral, blob: Blob) = measure_spokes
    }
    let mut spokes = Vec::with_capacity(WHEEL.len());
    measure(&mut spokes, integral, blob);
    spokes
}

#[inline(always)]
fn measure_spokes(spokes: &mut Vec<Spoke>, integral: &Integral, blob: Blob) {
    let half = half_side(blob.scale, 4.0);
    for (offset, weight) in WHEEL.iter() {
        let offset = offset.map(|c| c * blob.scale);
        let response = haar(integral, blob.corner(offset), half).map(|response| weight * response);
        let angle = response[1].atan2(response[0]);
        spokes.push(Spoke { response, angle_rad: if angle < 0.0 { angle + TAU } else { angle } });
    }
}

/// The first direction of sector `k`.
pub fn sector_start(k: usize) -> f32 {
    k as f32 * TAU / SECTORS as f32
}

/// The angle from `start_rad` to `angle_rad`, both from 0 to 2π, in the same range.
#[inline(always)]
fn beyond_start(angle_rad: f32, start_rad: f32) -> f32 {
    let turned = angle_rad - start_rad;
    if turned < 0.0 {
        turned + TAU
    } else if turned >= TAU {
        turned - TAU
    } else {
        turned
    }
}

/// The sum of the responses in each position of the sector; `tell` is called with each.
pub fn sector_sums(spokes: &[Spoke], mut tell: impl FnMut([f32; 2])) -> Vec<[f32; 2]> {
    let mut sums = [[0.0; SECTORS]; 2];
    add_spokes(spokes, &mut sums);
    let [x, y] = sums;
    let sums: Vec<_> = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    sums.iter().for_each(|sum| tell(*sum));
    sums
}

wide!(fn add_spokes(spokes: &[Spoke], sums: &mut [[f32; SECTORS]; 2]) = add_spokes_body);

/// Sectors that are compared at once.
const GROUP: usize = 8;
/// Groups among which the sectors of a direction lie: 60° are 12 sectors, with one more at each end for rounding.
const GROUPS: usize = 3;

/// Adds each response to the sectors in which its direction lies.
#[inline(always)]
fn add_spokes_body(spokes: &[Spoke], [x, y]: &mut [[f32; SECTORS]; 2]) {
    let mut starts = [0.0; SECTORS];
    starts.iter_mut().enumerate().for_each(|(k, start)| *start = sector_start(k));
    let (starts, _) = starts.as_chunks::<GROUP>();
    let [x, y] = [x, y].map(|sums| sums.as_chunks_mut::<GROUP>().0);
    for Spoke { response, angle_rad } in spokes {
        let last = (angle_rad * (SECTORS as f32 / TAU)) as usize + 1;
        // The first of 14 sectors, and its group.
        let first = (last + SECTORS - 13) % SECTORS / GROUP;
        for group in first..first + GROUPS {
            let group = if group < starts.len() { group } else { group - starts.len() };
            let (starts, x, y) = (&starts[group], &mut x[group], &mut y[group]);
            for k in 0..GROUP {
                let is_inside = beyond_start(*angle_rad, starts[k]) < SECTOR_RAD;
                x[k] += if is_inside { response[0] } else { 0.0 };
                y[k] += if is_inside { response[1] } else { 0.0 };
            }
        }
    }
}

/// The orientation of a keypoint in radians, and its descriptor of unit length.
pub fn described(integral: &Integral, blob: Blob, angle_rad: Option<f32>) -> (f32, Vec<f32>) {
    let angle_rad = angle_rad.unwrap_or_else(|| dominant(&sector_sums(&wheel(integral, blob), |_| {})).1);
    let sums: Vec<f32> = (0..SIDE * SIDE).flat_map(|k| subregion(integral, blob, angle_rad, k)).collect();
    (angle_rad, normalized(&sums).0)
}

/// The sector with the longest sum, the first of equal ones, and the direction of that sum.
pub fn dominant(sums: &[[f32; 2]]) -> (usize, f32) {
    let squared = |[x, y]: [f32; 2]| x * x + y * y;
    let longest = (0..sums.len()).reduce(|best, k| if squared(sums[k]) > squared(sums[best]) { k } else { best });
    let best = longest.unwrap_or_default();
    let [x, y] = sums.get(best).copied().unwrap_or_default();
    (best, y.atan2(x))
}

/// The offsets of the samples of all subregions in scales, and their weights, subregion by subregion.
static SUBREGIONS: LazyLock<Vec<([f32; 2], f32)>> = LazyLock::new(|| {
    let sample = |k: usize, n: usize| {
        let [i, j] = [k % SIDE * SAMPLES + n % SAMPLES, k / SIDE * SAMPLES + n / SAMPLES];
        let middle = (SIDE * SAMPLES - 1) as f32 / 2.0;
        let [u, v] = [i, j].map(|index| index as f32 - middle);
        ([u, v], (-(u * u + v * v) / (2.0 * 3.3 * 3.3)).exp())
    };
    (0..SIDE * SIDE).flat_map(|k| (0..SAMPLES * SAMPLES).map(move |n| sample(k, n))).collect()
});

/// The sums Σ d_x, Σ d_y, Σ |d_x|, Σ |d_y| of subregion `k` of the square of 20 s, of wavelets of side 2 s turned by the orientation
/// and weighted with a Gaussian of 3.3 s.
pub fn subregion(integral: &Integral, blob: Blob, angle_rad: f32, k: usize) -> [f32; 4] {
    wide! {
        fn sums(integral: &Integral, blob: Blob, angle_rad: f32, k: usize) -> [f32; 4] = subregion_sums
    }
    sums(integral, blob, angle_rad, k)
}

#[inline(always)]
fn subregion_sums(integral: &Integral, blob: Blob, angle_rad: f32, k: usize) -> [f32; 4] {
    let (sin, cos) = angle_rad.sin_cos();
    let half = half_side(blob.scale, 2.0);
    let mut sums = [0.0; 4];
    for &([u, v], weight) in &SUBREGIONS[k * SAMPLES * SAMPLES..][..SAMPLES * SAMPLES] {
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
    use crate::methods::features::integral::PixelBox;

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

    fn noise() -> Integral {
        Integral::of(&Grid::from_fn(50, 40, |x, y| ((x * 37 + y * 101 + x * y * 13) % 256) as u8))
    }

    #[test]
    fn wavelets_are_differences_of_the_sums_of_their_halves() {
        let integral = noise();
        for ([x, y], half) in [([20, 20], 4), ([1, 3], 3), ([49, 39], 6), ([-2, 20], 1), ([30, 45], 9)] {
            let sum = |min, size| integral.sum(PixelBox::new(min, size)) as f32;
            let area = (2 * half * half) as f32;
            let across = sum([x, y - half], [half, 2 * half]) - sum([x - half, y - half], [half, 2 * half]);
            let down = sum([x - half, y], [2 * half, half]) - sum([x - half, y - half], [2 * half, half]);
            assert_eq!(haar(&integral, [x, y], half), [across / area, down / area], "({x}, {y}), {half}");
        }
    }

    #[test]
    fn the_sum_of_a_sector_is_that_of_the_responses_within_60_degrees() {
        let mut spokes = wheel(&noise(), Blob { at: [22.3, 17.8], scale: 1.6 });
        spokes.extend([0.0, TAU, PI / 3.0].map(|angle_rad| Spoke { response: [1.0, 2.0], angle_rad }));
        let mut told = Vec::new();
        let sums = sector_sums(&spokes, |sum| told.push(sum));
        assert_eq!(sums, told);
        for (k, sum) in sums.iter().enumerate() {
            let is_inside = |spoke: &&Spoke| (spoke.angle_rad - sector_start(k)).rem_euclid(TAU) < SECTOR_RAD;
            let inside = spokes.iter().filter(is_inside);
            let plain = inside.fold([0.0; 2], |sum, spoke| [0, 1].map(|i| sum[i] + spoke.response[i]));
            assert_eq!(*sum, plain, "sector {k}");
        }
    }

    #[test]
    fn a_flat_neighbourhood_has_no_length() {
        assert_eq!(normalized(&[0.0; 4]), (vec![0.0; 4], 0.0));
        assert_eq!(normalized(&[3.0, 0.0, 4.0]), (vec![0.6, 0.0, 0.8], 5.0));
    }
}
