//! Random numbers by hashing a place instead of by walking a sequence: the noise of a pixel does not depend on which
//! frames or pixels were asked for before. SplitMix64's mixer (Steele, Lea and Flood 2014).

use super::maths::{cos, ln};

/// A random number for (`seed`, `a`, `b`), uniform over all 64-bit values.
pub fn hash(seed: u64, a: u64, b: u64) -> u64 {
    mix(mix(mix(seed).wrapping_add(a)).wrapping_add(b))
}

fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// A number from 0 to below 1 out of a hash's upper half.
pub fn unit(hash: u64) -> f64 {
    (hash >> 32) as f64 / 4_294_967_296.0
}

/// A normally distributed number of mean 0 and standard deviation 1 out of a hash (Box and Muller 1958).
pub fn gaussian(hash: u64) -> f64 {
    let positive = 1.0 - unit(hash);
    (-2.0 * ln(positive)).sqrt() * cos(unit(hash << 32))
}

const ACROSS: u32 = 0x9E37_79B1;
const DOWN: u32 = 0x85EB_CA77;
const SEED: u32 = 0xC2B2_AE3D;

/// A random number for a corner of a texture's lattice; faster than [`hash`], and good enough to look at.
pub fn lattice(seed: u32, x: i32, y: i32) -> u32 {
    scramble((x as u32).wrapping_mul(ACROSS) ^ (y as u32).wrapping_mul(DOWN) ^ seed.wrapping_mul(SEED))
}

/// [`lattice`] at (`x`, `y`), to its right, below it, and below to the right.
pub fn lattice_square(seed: u32, x: i32, y: i32) -> [u32; 4] {
    let (left, top) = ((x as u32).wrapping_mul(ACROSS), (y as u32).wrapping_mul(DOWN) ^ seed.wrapping_mul(SEED));
    let bottom = (y as u32).wrapping_add(1).wrapping_mul(DOWN) ^ seed.wrapping_mul(SEED);
    let right = left.wrapping_add(ACROSS);
    [left ^ top, right ^ top, left ^ bottom, right ^ bottom].map(scramble)
}

/// The finaliser "lowbias32" (Wellons 2018).
fn scramble(h: u32) -> u32 {
    let h = (h ^ (h >> 16)).wrapping_mul(0x7FEB_352D);
    let h = (h ^ (h >> 15)).wrapping_mul(0x846C_A68B);
    h ^ (h >> 16)
}

/// Part `index` of a lattice hash as a number from 0 to below 1.
pub fn part(lattice: u32, index: u32) -> f64 {
    f64::from((lattice >> (index * 8)) & 255) / 256.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_even_and_normal() {
        let n = 200_000;
        let moments = |f: fn(u64) -> f64| {
            let values: Vec<f64> = (0..n).map(|i| f(hash(7, 3, i))).collect();
            let mean = values.iter().sum::<f64>() / n as f64;
            (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64)
        };
        let (mean, variance) = moments(unit);
        assert!((mean - 0.5).abs() < 0.003 && (variance - 1.0 / 12.0).abs() < 0.001);
        let (mean, variance) = moments(gaussian);
        assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.015);
        let beyond_two = (0..n).filter(|&i| gaussian(hash(7, 3, i)).abs() > 1.959_964).count() as f64 / n as f64;
        assert!((beyond_two - 0.05).abs() < 0.003);
    }

    #[test]
    fn a_square_is_four_corners() {
        for (x, y) in [(0, 0), (-5, 7), (i32::MAX, i32::MIN)] {
            let (right, below) = (x.wrapping_add(1), y.wrapping_add(1));
            let corners = [(x, y), (right, y), (x, below), (right, below)].map(|(x, y)| lattice(3, x, y));
            assert_eq!(lattice_square(3, x, y), corners);
        }
    }

    #[test]
    fn the_mixer_is_splitmix64() {
        // First outputs of the reference generator from state 0 and state 1234567.
        assert_eq!(mix(0), 0xE220_A839_7B1D_CDAF);
        assert_eq!(mix(1_234_567), 6_457_827_717_110_365_317);
    }
}
