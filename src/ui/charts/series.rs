//! A quantity over steps: what is pointed at and clicked on its plot.

use eframe::egui::{self, Sense, Stroke, Ui, vec2};
use motionscope_core::scene::Series;

use crate::paint::charts::series::{Plot, Plotted, draw, event, head, nearest, summary};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_from, rect_of};
use crate::ui::drawing::ink;

/// What is plotted.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The lines.
    pub series: &'a Series,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
    /// Whether ten times as much is as far up everywhere, as long as all is more than nothing.
    pub logarithmic: bool,
}

/// The plot as it is shown.
pub type State = Chart<Plot, bool>;

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// The event of the step that was clicked.
    pub clicked: Option<usize>,
}

/// Shows the lines in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { series, subject, logarithmic } = input;
    let (area, _) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    let painter = ui.painter_at(area);
    let data = Plotted { series, whose: subject.whose, logarithmic };
    let plot = state.lay_out(&painter, (subject, series), (area, logarithmic), |area, style| draw(data, area, style));
    let rect = rect_from(plot.rect);
    let sensed = ui.interact(rect, ui.scope_id().with("series"), Sense::click());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(series)));
    state.body(&painter);
    let hovered = sensed.hover_pos().map(|at| plot.x.value(at.x));
    let step = hovered.and_then(|x| nearest(series, x));
    match step {
        Some(x) => {
            let stroke = Stroke::new(1.0, ink::color(subject.theme.chrome().dim));
            painter.vline(plot.x.place(x), rect.y_range(), stroke);
            over(&painter, &head(data, &plot, rect_of(area), hovered, subject.style(&painter)));
        }
        None => state.head(&painter),
    }
    Response { clicked: step.filter(|_| sensed.clicked()).and_then(|x| event(series, x)) }
}
