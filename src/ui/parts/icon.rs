//! The window's icon: a block, where it went, and the arrow between.

use eframe::egui::IconData;
use motionscope_core::scene::Role;
use tiny_skia::{FillRule, LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

use crate::paint::{Color, Theme};

/// Side of the icon in pixels.
const SIDE: u32 = 128;

/// The icon, or egui's own if it cannot be drawn.
pub fn icon() -> IconData {
    let Some(mut pixmap) = Pixmap::new(SIDE, SIDE) else { return IconData::default() };
    let theme = Theme::Dark;
    let figure = rounded(4.0, 4.0, 120.0, 28.0);
    fill(&mut pixmap, figure, theme.chrome().raised);
    outline(&mut pixmap, rounded(22.0, 60.0, 44.0, 4.0), theme.ink(Role::Reference).color, 8.0);
    outline(&mut pixmap, rounded(62.0, 24.0, 44.0, 4.0), theme.ink(Role::Best).color, 8.0);
    let mut arrow = PathBuilder::new();
    arrow.move_to(44.0, 82.0);
    arrow.line_to(80.0, 50.0);
    outline(&mut pixmap, arrow.finish(), theme.ink(Role::Result).color, 9.0);
    let mut head = PathBuilder::new();
    head.move_to(92.0, 39.0);
    head.line_to(70.0, 45.0);
    head.line_to(85.0, 62.0);
    head.close();
    fill(&mut pixmap, head.finish(), theme.ink(Role::Result).color);
    let rgba =
        pixmap.pixels().iter().map(|pixel| pixel.demultiply()).flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()]);
    IconData { rgba: rgba.collect(), width: SIDE, height: SIDE }
}

type Path = Option<tiny_skia::Path>;

/// A square with round corners.
fn rounded(x: f32, y: f32, side: f32, radius: f32) -> Path {
    let (right, bottom) = (x + side, y + side);
    let mut path = PathBuilder::new();
    path.move_to(x + radius, y);
    path.line_to(right - radius, y);
    path.quad_to(right, y, right, y + radius);
    path.line_to(right, bottom - radius);
    path.quad_to(right, bottom, right - radius, bottom);
    path.line_to(x + radius, bottom);
    path.quad_to(x, bottom, x, bottom - radius);
    path.line_to(x, y + radius);
    path.quad_to(x, y, x + radius, y);
    path.close();
    path.finish()
}

fn paint(color: Color) -> Paint<'static> {
    let [r, g, b, a] = color.0;
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, a);
    paint
}

fn fill(pixmap: &mut Pixmap, path: Path, color: Color) {
    if let Some(path) = path {
        pixmap.fill_path(&path, &paint(color), FillRule::Winding, Transform::identity(), None);
    }
}

fn outline(pixmap: &mut Pixmap, path: Path, color: Color, width: f32) {
    if let Some(path) = path {
        let stroke = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
        pixmap.stroke_path(&path, &paint(color), &stroke, Transform::identity(), None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_is_a_picture_with_clear_corners() {
        let icon = icon();
        assert_eq!(icon.rgba.len(), (4 * SIDE * SIDE) as usize);
        assert_eq!(icon.rgba[3], 0);
        let middle = 4 * (SIDE / 2 * SIDE + SIDE / 2) as usize;
        assert_eq!(icon.rgba[middle + 3], 255);
    }

    #[test]
    fn the_icon_of_the_page_is_the_same() {
        let svg = include_str!("../../../web/icon.svg");
        let tree = resvg::usvg::Tree::from_str(svg, &resvg::usvg::Options::default()).expect("an SVG");
        let mut drawn = Pixmap::new(SIDE, SIDE).expect("a pixmap");
        resvg::render(&tree, Transform::identity(), &mut drawn.as_mut());
        let drawn = drawn.pixels().iter().map(|pixel| pixel.demultiply());
        let drawn: Vec<u8> = drawn.flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect();
        let differing = icon().rgba.iter().zip(&drawn).filter(|(a, b)| a.abs_diff(**b) > 8).count();
        assert!(differing < 40, "{differing} values differ");
    }
}
