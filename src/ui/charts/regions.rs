//! The regions of a decision in the plane of two quantities: the values that are pointed at.

use eframe::egui::{self, Sense, Ui, vec2};
use motionscope_core::scene::Regions;

use crate::paint::charts::regions::{Shown, Square, draw, head, summary};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_of};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The regions.
    pub regions: &'a Regions,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
}

/// The plane as it is shown.
pub type State = Chart<Square>;

/// Shows the plane in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let Input { regions, subject } = input;
    let (area, response) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(regions)));
    let painter = ui.painter_at(area);
    let data = Shown { regions, whose: subject.whose };
    let square = state.lay_out(&painter, (subject, regions), (area, ()), |area, style| draw(data, area, style));
    state.body(&painter);
    match response.hover_pos().and_then(|at| square.values(at.into())) {
        Some(values) => over(&painter, &head(data, rect_of(area), Some(values), subject.style(&painter))),
        None => state.head(&painter),
    }
}
