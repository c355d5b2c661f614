//! What is seen from close up: the grid of pixels, their numbers, and the same pixel in every picture.

use eframe::egui::{Align2, Color32, Painter, Rect, Stroke, StrokeKind};
use motionscope_core::base::words::fixed;
use motionscope_core::data::Frame;
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::scene::{Mark, Shape};

use super::Lens;
use crate::paint::charts::on_gray;
use crate::paint::{Face, Look, Panel, Pictures, Shown, number};
use crate::ui::drawing::style;

/// Points per pixel from which the grid is drawn.
const GRID: f32 = 12.0;
/// Points per pixel from which numbers of three digits fit.
const NUMBERS: f32 = 22.0;
/// Smallest type of a number in a pixel, in points.
const LEAST_TYPE: f32 = 9.0;
/// Width of a digit, as a share of the size of the type.
const DIGIT: f32 = 0.6;
/// Share of a pixel that its number takes.
const FILLED: f32 = 0.92;
/// Characters of a quantity with its sign and a decimal: −123.4.
const FRACTION_DIGITS: f32 = 6.0;
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

/// Costs of displacements, each in the pixel where the middle of its block would lie.
struct Costs<'a> {
    origin: [f32; 2],
    values: &'a Grid<f32>,
}

impl<'a> Costs<'a> {
    /// Those of `mark`, if it has some and no map of the whole picture.
    fn of(mark: &'a Mark, lens: &Lens) -> Option<Self> {
        match &mark.shape {
            Shape::Heat { origin, values } if (values.width() as f32) < lens.picture.x => {
                Some(Self { origin: *origin, values })
            }
            _ => None,
        }
    }

    /// The size of type in which the longest of its numbers fits into a pixel, if that can be read.
    fn type_size(&self, lens: &Lens) -> Option<f32> {
        let finite = self.values.cells().iter().filter(|value| value.is_finite());
        let digits = finite.map(|value| number(*value).chars().count()).max()?;
        let size = (FILLED * lens.scale / (DIGIT * digits as f32)).min(0.36 * lens.scale).min(18.0);
        (size >= LEAST_TYPE).then_some(size.floor())
    }

    /// Whether a known cost lies over part of pixel `(x, y)`.
    fn covers(&self, x: usize, y: usize) -> bool {
        let near = |c: usize, origin: f32| [(c as f32 - origin).floor(), (c as f32 - origin).ceil()];
        let known = |x: f32, y: f32| {
            x >= 0.0 && y >= 0.0 && self.values.get(x as usize, y as usize).is_some_and(|value| value.is_finite())
        };
        near(y, self.origin[1]).into_iter().any(|y| near(x, self.origin[0]).into_iter().any(|x| known(x, y)))
    }
}

/// Whether the numbers of `mark` are costs that fit into their pixels: then its colours stay where numbers are written.
pub fn tells_costs(mark: &Mark, lens: &Lens) -> bool {
    Costs::of(mark, lens).is_some_and(|costs| costs.type_size(lens).is_some())
}

/// The cost in the pixel of each displacement that was tested, where there is room.
pub fn costs<'a>(painter: &Painter, marks: impl Iterator<Item = &'a Mark>, lens: &Lens, look: &Look) {
    let Some([low, high]) = look.heat else { return };
    for costs in marks.filter_map(|mark| Costs::of(mark, lens)) {
        let Some(size) = costs.type_size(lens) else { continue };
        let font = style::font(Face::Sans, size);
        for y in 0..costs.values.height() {
            for (x, value) in costs.values.row(y).iter().enumerate().filter(|(_, value)| value.is_finite()) {
                let at = lens.to_screen([costs.origin[0] + x as f32, costs.origin[1] + y as f32]);
                if !lens.pane.expand(lens.scale).contains(at) {
                    continue;
                }
                let color = look.colors.at((value - low) / (high - low).max(f32::MIN_POSITIVE));
                let color = on_gray((255.0 * color.luminance().sqrt()) as u8);
                painter.text(at, Align2::CENTER_CENTER, number(*value), font.clone(), style::color(color));
            }
        }
    }
}

/// The gray value or the quantity in each pixel, or its label where `marks` have one, where there is room and none of `marks` tells its cost.
pub fn numbers<'a>(
    painter: &Painter,
    shown: Shown,
    lens: &Lens,
    pictures: &Pictures,
    marks: impl Iterator<Item = &'a Mark>,
) {
    let Some([[left, right], [top, bottom]]) = lens.visible().filter(|_| has_numbers(lens)) else { return };
    let plain = (0.36 * lens.scale).clamp(LEAST_TYPE, 18.0);
    let fraction = (FILLED * lens.scale / (DIGIT * FRACTION_DIGITS)).min(plain);
    let measured = if let Panel::Of(picture) = shown.panel { pictures.measured(picture) } else { None };
    let has_fractions = measured.is_some() && fraction >= LEAST_TYPE;
    let font = style::font(Face::Sans, if has_fractions { fraction } else { plain }.floor());
    let marks: Vec<_> = marks.collect();
    let costs = marks.iter().filter(|mark| tells_costs(mark, lens)).filter_map(|mark| Costs::of(mark, lens));
    let costs: Vec<_> = costs.collect();
    let labels =
        marks.iter().find_map(|mark| if let Shape::Labels(labels) = &mark.shape { Some(labels) } else { None });
    for y in top..=bottom {
        for x in left..=right {
            if costs.iter().any(|costs| costs.covers(x, y)) {
                continue;
            }
            let Some((value, shade)) = value(shown, pictures, x, y) else { continue };
            let at = lens.to_screen([x as f32, y as f32]);
            // A labelled pixel tells its label.
            let label = labels.and_then(|labels| labels.get(x, y)).filter(|label| **label > 0);
            let text = match (label, measured) {
                (Some(label), _) => label.to_string(),
                (None, Some(measured)) => fixed(measured.at([x, y]).into(), usize::from(has_fractions)),
                (None, None) => value.to_string(),
            };
            painter.text(at, Align2::CENTER_CENTER, text, font.clone(), style::color(on_gray(shade)));
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
    fn costs_are_reported_where_all_their_digits_fit() {
        let at = |scale| {
            let pane = Rect::from_min_size(Pos2::ZERO, vec2(600.0, 400.0));
            Lens::new(pane, (320, 240), crate::ui::stage::Zoom::At { center: [99.0; 2], scale })
        };
        let mark = |cost: f32| {
            let mut scene = motionscope_core::scene::Scene::default();
            let values = Grid::from_fn(9, 9, |x, y| if x + y == 0 { cost } else { f32::NAN });
            let shape = Shape::Heat { origin: [90.5, 90.5], values };
            scene.mark(motionscope_core::scene::Picture::NEXT, motionscope_core::scene::Role::Candidate, shape);
            scene.marks.remove(0)
        };
        assert!(tells_costs(&mark(123.0), &at(26.0)) && !tells_costs(&mark(12_345.0), &at(26.0)));
        assert!(tells_costs(&mark(12_345.0), &at(40.0)) && !tells_costs(&mark(123.0), &at(12.0)));
        let known = mark(7.0);
        let costs = Costs::of(&known, &at(30.0)).expect("costs");
        assert!(costs.covers(90, 90) && costs.covers(91, 91) && !costs.covers(92, 90), "half a pixel off");
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
