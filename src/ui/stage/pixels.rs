//! What is seen from close up: the grid of pixels, their numbers, and the same pixel in every picture.

use eframe::egui::{Align2, Color32, Painter, Rect, Stroke, StrokeKind};
use motionscope_core::{Frame, Gray};

use super::Lens;
use crate::paint::charts::on_gray;
use crate::paint::{Face, Panel, Pictures, Shown};
use crate::ui::drawing::ink;

/// Points per pixel from which the grid is drawn.
const GRID: f32 = 12.0;
/// Points per pixel from which numbers fit.
const NUMBERS: f32 = 26.0;
/// More numbers than anyone can read are not written.
const MOST_NUMBERS: usize = 3000;

/// Thin lines between the pixels, fading in as they grow.
pub fn grid(painter: &Painter, lens: &Lens) {
    let Some([[left, right], [top, bottom]]) = lens.visible().filter(|_| lens.scale >= GRID) else { return };
    let strength = ((lens.scale - GRID) / GRID).clamp(0.0, 1.0);
    let stroke = Stroke::new(1.0 / painter.pixels_per_point(), Color32::from_gray(128).gamma_multiply(0.55 * strength));
    let seen = lens.picture_rect().intersect(lens.pane);
    for x in left..=right + 1 {
        let at = painter.round_to_pixel_center(lens.to_screen([x as f32 - 0.5, 0.0]).x);
        painter.vline(at, seen.y_range(), stroke);
    }
    for y in top..=bottom + 1 {
        let at = painter.round_to_pixel_center(lens.to_screen([0.0, y as f32 - 0.5]).y);
        painter.hline(seen.x_range(), at, stroke);
    }
}

/// Whether the pixels have room for their numbers, and these are few enough to be read. Heat would hide them.
pub fn has_numbers(lens: &Lens) -> bool {
    let few = |[[left, right], [top, bottom]]: [[usize; 2]; 2]| (right - left + 1) * (bottom - top + 1) <= MOST_NUMBERS;
    lens.scale >= NUMBERS && lens.visible().is_some_and(few)
}

/// The gray value in each pixel, where there is room.
pub fn numbers(painter: &Painter, shown: Shown, lens: &Lens, pictures: &Pictures) {
    let Some([[left, right], [top, bottom]]) = lens.visible().filter(|_| has_numbers(lens)) else { return };
    let font = ink::font(Face::Sans, (0.36 * lens.scale).clamp(9.0, 18.0));
    for y in top..=bottom {
        for x in left..=right {
            let Some((value, shade)) = value(shown, pictures, x, y) else { continue };
            let at = lens.to_screen([x as f32, y as f32]);
            painter.text(at, Align2::CENTER_CENTER, value.to_string(), font.clone(), ink::color(on_gray(shade)));
        }
    }
}

/// The number in a pixel, and how bright the pixel is.
fn value(Shown { panel, share, gain }: Shown, pictures: &Pictures, x: usize, y: usize) -> Option<(u8, u8)> {
    let frames = panel.frames(pictures);
    let gray = |i: usize| frames[i].luma().get(x, y).copied();
    match panel {
        Panel::Of(_) | Panel::Prediction => gray(0).map(|v| (v, v)),
        Panel::Difference | Panel::Residual => {
            let v = gray(0)?.abs_diff(gray(1)?);
            Some((v, (u16::from(v) * gain).min(255) as u8))
        }
        Panel::Blend => {
            let v = share.mix(gray(0)?, gray(1)?);
            Some((v, v))
        }
    }
}

/// Marks one pixel: arms that point at it, and its outline where that can be seen.
pub fn cross_hair(painter: &Painter, lens: &Lens, pixel: [usize; 2]) {
    let square = lens.pixel_rect(pixel);
    let gap = (lens.scale / 2.0).max(4.0) + 2.0;
    let arm = 14.0;
    let center = square.center();
    for (width, color) in [(3.0, Color32::from_black_alpha(140)), (1.0, Color32::WHITE)] {
        let stroke = Stroke::new(width, color);
        for side in [-1.0, 1.0] {
            let (near, far) = (side * gap, side * (gap + arm));
            painter.hline(center.x + near..=center.x + far, center.y, stroke);
            painter.vline(center.x, center.y + near..=center.y + far, stroke);
        }
        if lens.scale >= 6.0 {
            painter.rect_stroke(square, 0.0, stroke, StrokeKind::Outside);
        }
    }
}

/// A pixel's numbers for the line under the stage.
pub fn gray_at(gray: &Gray, [x, y]: [usize; 2]) -> String {
    gray.get(x, y).map_or_else(|| "–".into(), u8::to_string)
}

/// The colour of a pixel, if the frame has colours.
pub fn rgb_at(frame: &Frame, [x, y]: [usize; 2]) -> Option<[u8; 3]> {
    frame.color().and_then(|rgb| rgb.get(x, y).copied())
}

/// A small square in the colour of a pixel.
pub fn patch(painter: &Painter, rect: Rect, [r, g, b]: [u8; 3]) {
    painter.rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
    painter.rect_stroke(rect, 2.0, Stroke::new(1.0, Color32::from_gray(128)), StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Share;
    use eframe::egui::{Pos2, vec2};
    use motionscope_core::Grid;
    use std::sync::Arc;

    #[test]
    fn a_pixel_tells_the_number_that_it_shows() {
        let frame = |v| Arc::new(Frame::gray(Grid::new(3, 2, v)));
        let pair = Pictures::of([frame(10), frame(250)]);
        let shown = |panel| Shown { panel, share: Share::new(0.25).expect("a share"), gain: 1 };
        assert_eq!(value(shown(Panel::NEXT), &pair, 2, 1), Some((250, 250)));
        assert_eq!(value(shown(Panel::CURRENT), &pair, 3, 0), None);
        assert_eq!(value(shown(Panel::Blend), &pair, 0, 0), Some((70, 70)));
        let first = pair.pair[0].luma();
        assert_eq!((gray_at(first, [1, 1]), gray_at(first, [9, 9])), ("10".into(), "–".into()));
    }

    #[test]
    fn numbers_contrast_with_their_pixel() {
        assert!(on_gray(255).0[0] < 10 && on_gray(0).0[0] > 200);
        // A change of 20 is nearly black as it is, and light gray at 8 times its brightness.
        let frame = |v| Arc::new(Frame::gray(Grid::new(3, 2, v)));
        let pair = Pictures::of([frame(10), frame(30)]);
        for panel in [Panel::Difference, Panel::Residual] {
            let pair = Pictures { prediction: Some(frame(30)), ..pair.clone() };
            let shown = [1, 4, 8, 200].map(|gain| value(Shown { panel, share: Share::default(), gain }, &pair, 0, 0));
            assert_eq!(shown, [Some((20, 20)), Some((20, 80)), Some((20, 160)), Some((20, 255))]);
        }
    }

    #[test]
    fn heat_is_hidden_only_where_numbers_are_written() {
        let at = |scale, side| {
            let pane = Rect::from_min_size(Pos2::ZERO, vec2(side, side));
            has_numbers(&Lens::new(pane, (584, 388), crate::ui::stage::Zoom::At { center: [99.0; 2], scale }))
        };
        assert!(at(30.0, 600.0) && at(50.0, 2400.0), "up to 3000 numbers");
        assert!(!at(30.0, 2400.0), "6400 numbers are too many");
        assert!(!at(20.0, 600.0), "numbers do not fit");
    }
}
