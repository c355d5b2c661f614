//! Pixels of a mask as a contour with sparse hatching, through which the picture is seen.

use motionscope_core::data::Mask;
use motionscope_core::geometry::Grid;
use motionscope_core::scene::Role;

use super::Ink;

/// Opacity of heat over footage.
pub(super) const HEAT_ALPHA: u8 = 0xb8;
/// From one stripe of a mask to the next, in points.
pub(super) const HATCH_PT: f32 = 7.0;
/// Most parts of pixels that a mask is drawn in.
const MOST_PARTS: usize = 6_000_000;
/// Most parts along a side of a pixel.
const FINEST: usize = 6;
/// Width of the contour in points.
const CONTOUR_PT: f32 = 1.5;
/// How strong the rim around the contour is.
const RIM_ALPHA: u8 = 0xa0;

/// How many parts a pixel has along a side where it is `zoom` points large: about one for a point.
pub(super) fn scale((width, height): (usize, usize), zoom: f32) -> usize {
    let most = (MOST_PARTS as f32 / (width * height).max(1) as f32).sqrt() as usize;
    (zoom.round() as usize).min(most).clamp(1, FINEST)
}

/// The mask with `scale` parts along a side of a pixel that is `zoom` points large: a contour inside its border, a rim outside, and stripes
/// whose direction depends on the role.
pub(super) fn outlined(mask: &Mask, (role, ink): (Role, &Ink), (scale, zoom): (usize, f32)) -> Grid<[u8; 4]> {
    let (width, height) = mask.size();
    let parts_per_pt = scale as f32 / zoom.max(1e-3);
    let parts = |points: f32| (points * parts_per_pt).round().max(1.0) as usize;
    let contour = parts(CONTOUR_PT * ink.width / 2.0);
    // Where a pixel is a single part, a rim would hide its neighbours.
    let rim = if scale > 1 { parts(ink.halo_width).min(scale - 1) } else { 0 };
    let period = parts(HATCH_PT).max(3);
    let is_set = |x: usize, y: usize| x < width && y < height && mask.get(x, y);
    let color = ink.color.alpha(255).0;
    let (line, around) = (ink.color.alpha(HEAT_ALPHA).0, ink.halo.alpha(RIM_ALPHA).0);
    let mut pixels = Grid::new(width * scale, height * scale, [0; 4]);
    for y in 0..height {
        for x in 0..width {
            let is_inside = is_set(x, y);
            let differs = |dx: isize, dy: isize| match (x.checked_add_signed(dx), y.checked_add_signed(dy)) {
                (Some(x), Some(y)) => is_set(x, y) != is_inside,
                _ => is_inside,
            };
            let edges = [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(dx, dy)| differs(dx, dy));
            if !is_inside && !edges.contains(&true) {
                continue;
            }
            let deep = if is_inside { contour } else { rim };
            for part_y in 0..scale {
                for part_x in 0..scale {
                    let far = [part_x, scale - 1 - part_x, part_y, scale - 1 - part_y];
                    let is_at_edge = edges.iter().zip(far).any(|(is_edge, far)| *is_edge && far < deep);
                    let at = (x * scale + part_x, y * scale + part_y);
                    pixels[at] = match (is_at_edge, is_inside) {
                        (true, true) => color,
                        (true, false) => around,
                        (false, true) if is_striped(role, at, period) => line,
                        (false, _) => continue,
                    };
                }
            }
        }
    }
    pixels
}

/// Whether a stripe passes: upwards, but downwards for errors and level for the truth, so that masks are told apart without their colours.
fn is_striped(role: Role, (x, y): (usize, usize), period: usize) -> bool {
    let along = match role {
        Role::Error => x + period * y - y,
        Role::Truth => y,
        _ => x + y,
    };
    along % period == 0
}

#[cfg(test)]
mod tests {
    use super::super::Theme;
    use super::*;

    fn drawn(role: Role, scale: usize) -> Grid<[u8; 4]> {
        let mask = Mask::from_fn(40, 30, |x, y| (10..30).contains(&x) && (5..25).contains(&y));
        outlined(&mask, (role, &Theme::Light.ink(role)), (scale, scale as f32))
    }

    #[test]
    fn a_mask_is_a_contour_and_leaves_most_of_its_inside_in_sight() {
        let ink = Theme::Light.ink(Role::Best);
        let pixels = drawn(Role::Best, 4);
        let inside = |(x, y): (usize, usize)| pixels[(x, y)][3] > 0;
        let places = (48..112).flat_map(|x| (28..92).map(move |y| (x, y)));
        let covered = places.clone().filter(|at| inside(*at)).count() as f32 / places.count() as f32;
        assert!((0.05..0.3).contains(&covered), "{covered}");
        for y in 20..100 {
            assert_eq!(pixels[(40, y)], ink.color.0, "its border has no gap");
            assert_eq!(pixels[(39, y)][..3], ink.halo.0[..3], "and a rim around it");
        }
        assert_eq!(pixels[(20, 50)], [0; 4]);
    }

    #[test]
    fn masks_of_errors_and_of_the_truth_have_stripes_of_their_own() {
        let striped = |role| {
            let pixels = drawn(role, 4);
            (60..75).flat_map(|x| (40..55).map(move |y| (x, y))).map(|at| pixels[at][3] > 0).collect::<Vec<_>>()
        };
        let all = [Role::Estimate, Role::Error, Role::Truth].map(striped);
        assert!(all[0] != all[1] && all[1] != all[2] && all[0] != all[2]);
    }

    #[test]
    fn a_single_pixel_is_seen_and_a_large_picture_stays_small() {
        let mask = Mask::from_fn(9, 9, |x, y| (x, y) == (4, 4));
        let pixels = outlined(&mask, (Role::Best, &Theme::Dark.ink(Role::Best)), (1, 1.0));
        assert_eq!(pixels[(4, 4)], Theme::Dark.ink(Role::Best).color.0);
        assert_eq!([scale((320, 240), 2.6), scale((320, 240), 0.4), scale((320, 240), 40.0)], [3, 1, FINEST]);
        let (width, height) = (3840, 2160);
        assert!(width * height * scale((width, height), 8.0).pow(2) <= 2 * MOST_PARTS);
    }
}
