//! Points as squares of pixels, the nearest to the eye in front.

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{CloudData, CloudPoint};

use super::super::super::Theme;
use super::super::ChartStyle;
use super::{Rect, World};

/// Side of a point as a share of its distance from the cameras: a pixel of a camera of usual focal length, a little enlarged.
pub(super) const SIDE: f32 = 0.0045;
/// Smallest and largest side of a square in points.
pub const SIDES_PT: [f32; 2] = [1.0, 14.0];

/// The points as pixels, clear where there are none.
pub fn render(data: &CloudData, world: &World, rect: Rect, style: ChartStyle) -> Grid<[u8; 4]> {
    let [width, height] = rect.size().map(|side| (side * style.density).round().max(1.0) as usize);
    let mut pixels = Grid::new(width, height, [0; 4]);
    let mut depths = Grid::new(width, height, f32::INFINITY);
    let magnification = world.magnification();
    for point in &data.points {
        let place = world.place(point.at);
        let clip = world.screen.clip_from_world * place.extend(1.0);
        if clip.w <= super::NEAR {
            continue;
        }
        let ([x, y], depth) = world.screen.project(place);
        let side = world.side(point.at[2]) * magnification / clip.w;
        let half = side.clamp(SIDES_PT[0], SIDES_PT[1]) * style.density / 2.0;
        let center = [x - rect.min[0], y - rect.min[1]].map(|c| c * style.density);
        let range = |c: f32, extent: usize| {
            let from = (c - half).round().clamp(0.0, extent as f32) as usize;
            from..(c + half).round().clamp(0.0, extent as f32) as usize
        };
        let [r, g, b] = color(point, style.theme);
        for y in range(center[1], height) {
            for x in range(center[0], width) {
                if depth < depths[(x, y)] {
                    (depths[(x, y)], pixels[(x, y)]) = (depth, [r, g, b, 255]);
                }
            }
        }
    }
    pixels
}

/// The colour of a point: its own, or that of its role over it.
pub fn color(point: &CloudPoint, theme: Theme) -> [u8; 3] {
    point.role.map_or(point.color, |role| mixed(point.color, theme.ink(role).color.0))
}

/// The colour of a role over that of a picture, which stays to be seen.
fn mixed(picture: [u8; 3], [r, g, b, _]: [u8; 4]) -> [u8; 3] {
    let gray = picture.iter().map(|c| u32::from(*c)).sum::<u32>() / 3;
    [r, g, b].map(|ink| ((3 * u32::from(ink) + gray) / 4) as u8)
}
