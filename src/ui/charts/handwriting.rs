//! What is drawn by hand on a chart that is presented.

use eframe::egui::{CursorIcon, Rect, Role, Sense, Ui, Vec2, WidgetInfo};
use motionscope_core::run::Cursor;

use crate::paint::{FreehandLine, Ground, PenColor, Theme, freehand_on_chart, primitive};
use crate::ui::drawing::{pen, primitives};

/// A chart that can be drawn on.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The id of its pane.
    pub pane: &'static str,
    /// Its viewpoint, section or scroll position, as a [`Ground`] has it.
    pub view: Option<[f32; Ground::VIEW]>,
    /// Which of several estimators has it.
    pub member: usize,
    /// The step that it shows.
    pub step: Cursor,
    /// What was drawn by hand on the step.
    pub freehand: &'a [FreehandLine],
    /// The colour of the pen, if the mouse draws.
    pub color: Option<PenColor>,
    /// Colours and sizes.
    pub theme: Theme,
}

/// Shows what was drawn on a chart over it in `area`, and takes what the mouse draws there as `line`; gives a line that is whole.
pub fn show(ui: &Ui, area: Rect, input: Input<'_>, line: &mut Option<FreehandLine>) -> Option<FreehandLine> {
    let Input { pane, view, member, step, freehand, color, theme } = input;
    let on = Ground::Chart { pane, size: area.size().into(), view };
    if let Some(gone) = line.as_mut().filter(|line| (line.step, line.member, line.on) != (step, member, on)) {
        // It stays without points until the mouse is let go, so that no other one begins in its place.
        gone.points.clear();
    }
    let painter = ui.painter_at(area);
    let place = primitive::Rect { min: area.min.into(), max: area.max.into() };
    let lines = freehand.iter().chain(line.as_ref());
    painter.extend(primitives::shapes(&painter, &freehand_on_chart(lines, theme, ((on, member), place))));
    let Some(color) = color else {
        *line = None;
        return None;
    };
    // Above the chart: what is drawn is no click on it.
    let sensed = ui.interact(area, ui.scope_id().with("handwriting"), Sense::click_and_drag());
    sensed.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Ink on the chart"));
    if let Some(from) = pen::begun(&sensed, line.is_some()).filter(|from| area.contains(*from)) {
        let points = vec![(from - area.min).into()];
        *line = Some(FreehandLine { step, member, on, color, points });
    }
    pen::dot(&sensed, &painter, (theme, color));
    if sensed.hovered() || sensed.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::None);
    }
    pen::extend(ui, line.as_mut()?, |at| area.min + Vec2::from(at), |at| (at - area.min).into());
    if ui.input(|i| i.pointer.primary_down()) {
        return None;
    }
    pen::ended(ui, line).filter(|line| !line.points.is_empty())
}
