//! The magnifying glass: the part of a picture around the pointer, larger, with its marks and its ink.

use eframe::egui::{Pos2, Rect, Stroke, StrokeKind, Ui, Vec2};

use super::{Input, Lens, Spot, State};
use crate::ui::drawing::style;

/// How many times as large as around it the picture is under the glass.
const TIMES: f32 = 3.0;
/// Side of the glass as a share of the shorter side of its picture's pane, and at least in points.
const SHARE: f32 = 0.5;
const LEAST_PT: f32 = 160.0;

/// The glass at `at` over that of `spots` which lies there, within `area`.
fn glass<'a>(spots: &[Spot<'a>], at: Pos2, area: Rect) -> Option<Spot<'a>> {
    let under = spots.iter().find(|spot| spot.lens.pixel_at(at).is_some())?;
    let Spot { member, panel, lens, scene, ref pictures, share, is_small, .. } = *under;
    let lens = magnified(lens, at, area);
    Some(Spot { member, panel, lens, scene, pictures: pictures.clone(), has_map: false, share, is_small })
}

/// The picture of `lens` in a pane around `at` within `area`: the image point under the pointer stays under it.
fn magnified(lens: Lens, at: Pos2, area: Rect) -> Lens {
    let side = (SHARE * lens.pane.size().min_elem()).max(LEAST_PT).min(area.size().min_elem());
    // Its ends are in order also where the glass is as large as the area.
    let centers = Rect::from_center_size(area.center(), (area.size() - Vec2::splat(side)).max(Vec2::ZERO));
    let pane = Rect::from_center_size(centers.clamp(at), Vec2::splat(side));
    let held = Pos2::from(lens.to_image(at));
    let scale = lens.magnified(TIMES);
    Lens { pane, scale, center: held + (pane.center() - at) / scale, ..lens }
}

/// Shows the glass where the pointer is over a picture.
pub fn show(ui: &Ui, spots: &[Spot<'_>], area: Rect, (input, state): (&Input<'_>, &mut State)) {
    let at = ui.input(|i| i.pointer.hover_pos()).filter(|_| input.presenting.has_loupe);
    // Small pictures stand outside of it.
    let area = spots.iter().fold(area, |all, spot| all.union(spot.lens.pane));
    let Some(glass) = at.and_then(|at| glass(spots, at, area)) else { return };
    let chrome = input.theme().chrome();
    let pane = glass.lens.pane;
    ui.painter().rect_filled(pane, 0.0, style::color(chrome.background));
    // The shapes of the pictures around it are kept apart.
    state.loupe.lit = state.marks.lit;
    std::mem::swap(&mut state.marks, &mut state.loupe);
    super::paint_picture(ui, &glass, input, state);
    std::mem::swap(&mut state.marks, &mut state.loupe);
    ui.painter().rect_stroke(pane, 0.0, Stroke::new(4.0, style::color(chrome.background)), StrokeKind::Outside);
    ui.painter().rect_stroke(pane, 0.0, Stroke::new(2.0, style::color(chrome.accent)), StrokeKind::Outside);
}

#[cfg(test)]
mod tests {
    use eframe::egui::{pos2, vec2};

    use super::super::Zoom;
    use super::*;

    #[test]
    fn the_glass_holds_the_point_under_the_pointer_in_every_corner() {
        for size in [vec2(900.0, 600.0), vec2(170.3, 160.1), vec2(90.7, 31.3)] {
            let area = Rect::from_min_size(pos2(10.1, 20.3), size);
            for picture in [(584, 388), (1, 1)] {
                let lens = Lens::new(area, picture, Zoom::Fit);
                for share in [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [1.0, 1.0]] {
                    let at = area.lerp_inside(vec2(share[0], share[1]));
                    let glass = magnified(lens, at, area);
                    let place = format!("{size:?}, {picture:?}, {share:?}: {glass:?}");
                    assert!(area.expand(0.01).contains_rect(glass.pane), "it leaves the stage: {place}");
                    assert!(glass.pane.expand(0.01).contains(at), "the pointer is outside: {place}");
                    let (held, seen) = (lens.to_image(at), glass.to_image(at));
                    assert!((0..2).all(|i| (held[i] - seen[i]).abs() < 0.01), "another point: {place}");
                    let wanted = (TIMES * lens.scale).min(lens.magnified(f32::INFINITY));
                    assert!((glass.scale - wanted).abs() < 1e-3, "another magnification: {place}");
                }
            }
        }
    }
}
