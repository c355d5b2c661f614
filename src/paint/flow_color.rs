//! Colours for displacements: the wheel of the Middlebury benchmark.

use super::Color;

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
    let strength = u.hypot(v) / longest.max(f32::MIN_POSITIVE);
    let turn = ((-v).atan2(-u) / std::f32::consts::PI + 1.0) / 2.0 * (HUES - 1) as f32;
    let (low, share) = (turn as usize, turn.fract());
    let (a, b) = (hue(low), hue(low + 1));
    let channel = |i: usize| {
        let full = a[i] + (b[i] - a[i]) * share;
        let shade = if strength <= 1.0 { 1.0 - strength * (1.0 - full) } else { 0.75 * full };
        (255.0 * shade) as u8
    };
    Color([channel(0), channel(1), channel(2), 255])
}

/// Hue `index` of the wheel, red, green and blue from 0 to 1.
fn hue(index: usize) -> [f32; 3] {
    let mut index = index % HUES;
    for (sector, count) in SECTORS.into_iter().enumerate() {
        if index < count {
            let share = index as f32 / count as f32;
            return std::array::from_fn(|i| CORNERS[sector][i] + (CORNERS[sector + 1][i] - CORNERS[sector][i]) * share);
        }
        index -= count;
    }
    CORNERS[0]
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
    fn none_is_white_far_is_dark_and_unknown_is_clear() {
        assert_eq!(flow_color([0.0, 0.0], 2.0), Color::WHITE);
        assert_eq!(flow_color([0.0, 0.0], 0.0), Color::WHITE);
        assert_eq!(flow_color([f32::NAN, 0.0], 2.0).0[3], 0);
        assert!(flow_color([9.0, 1.0], 2.0).luminance() < flow_color([1.98, 0.22], 2.0).luminance());
    }
}
