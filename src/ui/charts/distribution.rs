//! How often a quantity has each value: what is pointed at among its bars.

use eframe::egui::{self, Sense, Stroke, StrokeKind, Ui, vec2};
use motionscope_core::scene::Distribution;

use crate::paint::charts::distribution::{Bars, Counted, draw, head, summary};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_from, rect_of};
use crate::ui::drawing::style;

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The counts.
    pub distribution: &'a Distribution,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
}

/// The bars as they are shown.
pub type State = Chart<Bars>;

/// Shows the distribution in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let Input { distribution, subject } = input;
    let (area, response) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(distribution)));
    let painter = ui.painter_at(area);
    let data = Counted { distribution, whose: subject.whose };
    let bars = state.lay_out(&painter, (subject, distribution), (area, ()), |area, style| draw(data, area, style));
    state.body(&painter);
    match response.hover_pos().and_then(|at| bars.at(at.into())) {
        Some(i) => {
            let stroke = Stroke::new(1.5, style::color(subject.theme.chrome().text));
            let bar = rect_from(bars.bar(i, distribution.counts[i]));
            painter.rect_stroke(bar, 0.0, stroke, StrokeKind::Outside);
            over(&painter, &head(data, &bars, rect_of(area), Some(i), subject.style(&painter)));
        }
        None => state.head(&painter),
    }
}
