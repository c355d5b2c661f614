//! The magnifying glass: the part of a picture around the pointer, larger, with its marks and its ink.

use eframe::egui::{Pos2, Rect, Stroke, StrokeKind, Ui, Vec2};

use super::{Input, Lens, Spot, State};
use crate::ui::drawing::style;

/// How many times as large as around it the picture is under the glass.
const TIMES: f32 = 3.0;
/// Side of the glass as a share of the shorter side of its picture's pane, and at least in points.
const SHARE: f32 = 0.5;
const LEAST_PT: f32 = 160.0;

/// The glass at `at` over that of `spots` which lies there, within `area`: the pixel under the pointer stays under it.
fn glass<'a>(spots: &[Spot<'a>], at: Pos2, area: Rect) -> Option<Spot<'a>> {
    let under = spots.iter().find(|spot| spot.lens.pixel_at(at).is_some())?;
    let Spot { member, panel, lens, scene, ref pictures, .. } = *under;
    let side = (SHARE * lens.pane.size().min_elem()).max(LEAST_PT).min(area.size().min_elem());
    let pane = Rect::from_center_size(at, Vec2::splat(side));
    let inside = area.shrink(side / 2.0);
    let pane = pane.translate(inside.clamp(pane.center()) - pane.center());
    let held = Pos2::from(lens.to_image(at));
    let scale = lens.magnified(TIMES);
    let lens = Lens { pane, scale, center: held + (pane.center() - at) / scale, ..lens };
    Some(Spot { member, panel, lens, scene, pictures: pictures.clone(), has_map: false })
}

/// Shows the glass where the pointer is over a picture.
pub fn show(ui: &Ui, spots: &[Spot<'_>], area: Rect, (input, state): (&Input<'_>, &mut State)) {
    let at = ui.input(|i| i.pointer.hover_pos()).filter(|at| input.presenting.has_loupe && area.contains(*at));
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
