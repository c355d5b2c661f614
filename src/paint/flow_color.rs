//! Colours for displacements: the wheel of the Middlebury benchmark.

use std::f32::consts::TAU;

use motionscope_core::scene::Role;

use super::{Color, Theme};

/// How many hues lie between red and yellow, yellow and green, and so on round the wheel, so that steps look alike
/// (S. Baker et al., A database and evaluation methodology for optical flow, IJCV 92(1), 2011).
const SECTORS: [usize; 6] = [15, 6, 4, 11, 13, 6];
/// Red, yellow, green, cyan, blue, magenta, and red again.
const CORNERS: [[f32; 3]; 7] = [
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, 0.0],
];
/// Hues in all.
const HUES: usize = 55;

/// The colour of a displacement, full where its length is `longest`: white for none, darker beyond, clear where unknown.
pub fn flow_color([u, v]: [f32; 2], longest: f32) -> Color {
    if !(u.is_finite() && v.is_finite()) {
        return Color::BLACK.alpha(0);
    }
    let strength = (u * u + v * v).sqrt() / longest.max(f32::MIN_POSITIVE);
    let place = turn(-v, -u) * (HUES - 1) as f32;
    let (low, share) = ((place as usize).min(HUES - 1), place.fract());
    let (a, b) = (WHEEL[low], WHEEL[low + 1]);
    let channel = |i: usize| {
        let full = a[i] + (b[i] - a[i]) * share;
        let shade = if strength <= 1.0 { 1.0 - strength * (1.0 - full) } else { 0.75 * full };
        (255.0 * shade) as u8
    };
    Color([channel(0), channel(1), channel(2), 255])
}

/// The angle of (x, y) as a share of a full turn, 0 to 1 from −π to π. A picture has millions of pixels: this polynomial is
/// several times as fast as `atan2`, and within 2·10⁻⁶ of it (C. Hastings, Approximations for digital computers, 1955).
fn turn(y: f32, x: f32) -> f32 {
    const TERMS: [f32; 6] = [0.999_977_26, -0.332_623_47, 0.193_543_46, -0.116_432_87, 0.052_653_32, -0.011_721_2];
    let (long, short) = (x.abs().max(y.abs()), x.abs().min(y.abs()));
    let z = short / long.max(f32::MIN_POSITIVE);
    let within_octant = z * TERMS.iter().rev().fold(0.0, |sum, term| sum * (z * z) + term) / TAU;
    let within_quarter = if y.abs() > x.abs() { 0.25 - within_octant } else { within_octant };
    let within_half = if x < 0.0 { 0.5 - within_quarter } else { within_quarter };
    0.5 + within_half.copysign(y)
}

/// Red, green and blue, from 0 to 1, of every hue of the wheel, and the first once more.
const WHEEL: [[f32; 3]; HUES + 1] = {
    let mut wheel = [CORNERS[0]; HUES + 1];
    let (mut at, mut sector) = (0, 0);
    while sector < SECTORS.len() {
        let mut index = 0;
        while index < SECTORS[sector] {
            let (share, mut i) = (index as f32 / SECTORS[sector] as f32, 0);
            while i < 3 {
                wheel[at][i] = CORNERS[sector][i] + (CORNERS[sector + 1][i] - CORNERS[sector][i]) * share;
                i += 1;
            }
            (at, index) = (at + 1, index + 1);
        }
        sector += 1;
    }
    wheel
};

/// Up to this share of the scale colours fade, so that what does not move is no veil over the picture.
const FADED: f32 = 0.2;

/// How much of its opacity a motion of this share of the scale has: none where nothing moves.
pub(super) fn veil(share: f32) -> f32 {
    (share / FADED).clamp(0.0, 1.0)
}

/// The two colours of pixels that failed a check, in stripes.
pub(super) fn hatch() -> [Color; 2] {
    let color = Theme::Dark.ink(Role::Error).color;
    [color, color.mix(Color::BLACK, 0.72)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wheel_is_that_of_the_benchmark() {
        // As the published code paints them: to the right, down, to the left, and up.
        let known = [
            ([1.0, 0.0], [255, 0, 0]),
            ([0.0, 1.0], [255, 230, 0]),
            ([-1.0, 0.0], [0, 208, 255]),
            ([0.0, -1.0], [88, 0, 255]),
        ];
        for (uv, color) in known {
            let Color([r, g, b, _]) = flow_color(uv, 1.0);
            let off = [r, g, b].into_iter().zip(color).map(|(a, b): (u8, u8)| a.abs_diff(b)).max();
            assert!(off <= Some(10), "{uv:?} is {r}, {g}, {b}, not {color:?}");
        }
    }

    #[test]
    fn turns_are_those_of_the_arc_tangent() {
        for i in -1000..=1000 {
            let (y, x) = (i as f32 / 1000.0 * TAU / 2.0).sin_cos();
            let off = turn(y, x) - (y.atan2(x) / TAU + 0.5);
            // A full turn is none.
            assert!(off.abs().min(1.0 - off.abs()) < 3e-6, "{x}, {y}: {off}");
        }
    }

    #[test]
    fn none_is_white_far_is_dark_and_unknown_is_clear() {
        assert_eq!(flow_color([0.0, 0.0], 2.0), Color::WHITE);
        assert_eq!(flow_color([0.0, 0.0], 0.0), Color::WHITE);
        assert_eq!(flow_color([f32::NAN, 0.0], 2.0).0[3], 0);
        assert!(flow_color([9.0, 1.0], 2.0).luminance() < flow_color([1.98, 0.22], 2.0).luminance());
    }
}
