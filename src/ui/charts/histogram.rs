//! How many blocks have each displacement: what is pointed at and clicked on the map of counts.

use eframe::egui::{self, Sense, Stroke, StrokeKind, Ui, vec2};
use motionscope_core::data::Histogram;

use crate::paint::charts::Map;
pub use crate::paint::charts::histogram::name;
use crate::paint::charts::histogram::{Counts, description, draw, head, nearest, seen};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_from, rect_of};
use crate::ui::drawing::style;

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The counts.
    pub histogram: &'a Histogram,
    /// Whether a click on a bin leads to a block.
    pub leads: bool,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
}

/// The map as it is shown.
pub type State = Chart<Map>;

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The unit that found the first displacement of the bin that was clicked.
    pub clicked: Option<usize>,
}

/// Shows the histogram as large as it fits.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { histogram, leads, subject } = input;
    let (area, _) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::hover());
    let painter = ui.painter_at(area);
    let data = Counts { histogram, whose: subject.whose };
    let map = state.lay_out(&painter, (subject, histogram), (area, ()), |area, style| draw(data, area, style));
    let sensed = ui.interact(rect_from(map.rect), ui.scope_id().with("histogram"), Sense::click());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name(histogram)));
    let pointed = sensed.hover_pos().and_then(|at| nearest(histogram, &map, at.into()));
    state.body(&painter);
    match pointed {
        Some(at) => {
            let stroke = Stroke::new(1.5, style::color(subject.theme.chrome().text));
            painter.rect_stroke(rect_from(seen(&map, at)).expand(1.0), 0.0, stroke, StrokeKind::Outside);
            let description = Some(description(histogram, at, leads));
            over(&painter, &head(data, &map, rect_of(area), description, subject.style(&painter)));
        }
        None => state.head(&painter),
    }
    let unit = |at| histogram.units[histogram.cell(at)?];
    Response { clicked: pointed.filter(|_| leads && sensed.clicked()).and_then(unit) }
}
