//! Lines drawn with the mouse: where the pen is put down, where it goes, and the line that it leaves.

use eframe::egui::{Event, Painter, PointerButton, Pos2, Response, Stroke, Ui};

use super::style;
use crate::paint::{FreehandLine, PenColor, Theme, pen_width};

/// Distance in points from which the pen has moved.
const STEP_PT: f32 = 3.0;

/// Where the pen is put down, if it is. On a slow screen a click begins and ends within a frame. A line whose ground has gone gives
/// way to the next one.
pub fn begun(sensed: &Response, has_line: bool) -> Option<Pos2> {
    let (is_down, is_pressed, from) =
        sensed.ctx.input(|i| (i.pointer.primary_down(), i.pointer.primary_pressed(), i.pointer.press_origin()));
    let begins = is_pressed || is_down && !has_line;
    let from = from.or(sensed.interact_pointer_pos());
    from.filter(|_| begins && (sensed.is_pointer_button_down_on() || sensed.clicked()))
}

/// Extends a line to where the mouse has been; its points are mapped to the screen and back.
pub fn extend(
    ui: &Ui,
    line: &mut FreehandLine,
    to_screen: impl Fn([f32; 2]) -> Pos2,
    from_screen: impl Fn(Pos2) -> [f32; 2],
) {
    for at in path(ui) {
        let has_moved = |last: &[f32; 2]| to_screen(*last).distance(at) >= STEP_PT;
        if line.points.last().is_some_and(has_moved) {
            line.points.push(from_screen(at));
        }
    }
}

/// The line that was being drawn, without the tremor of the hand.
pub fn ended(ui: &Ui, line: &mut Option<FreehandLine>) -> Option<FreehandLine> {
    ui.ctx().request_repaint();
    line.take().map(FreehandLine::steadied).map(rounded)
}

/// Draws the tip of the pen at the pointer.
pub fn dot(sensed: &Response, painter: &Painter, (theme, color): (Theme, PenColor)) {
    if let Some(at) = sensed.hover_pos().or(sensed.interact_pointer_pos()) {
        let (inked, radius) = (theme.ink(color.role()), 0.5 * pen_width(theme));
        let rim = Stroke::new(inked.halo_width, style::color(inked.halo));
        painter.circle(at, radius + 1.0, style::color(inked.color), rim);
    }
}

/// Where the mouse has been with the button down since the last frame: on a slow screen at many places.
fn path(ui: &Ui) -> Vec<Pos2> {
    let mut path = Vec::new();
    ui.input(|input| {
        for event in &input.events {
            match event {
                Event::PointerButton { button: PointerButton::Primary, pressed: true, .. } => path.clear(),
                Event::PointerButton { button: PointerButton::Primary, pressed: false, .. } => return,
                Event::PointerMoved(at) => path.push(*at),
                _ => {}
            }
        }
    });
    path
}

/// Points to a hundredth of a pixel, as they are written.
fn rounded(mut line: FreehandLine) -> FreehandLine {
    line.points.iter_mut().flatten().for_each(|c| *c = (*c * 100.0).round() / 100.0);
    line
}
