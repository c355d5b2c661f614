//! A quantity over steps: coming nearer, going along, pointing at a step and clicking it.

use eframe::egui::{self, Rect, RichText, Sense, Stroke, Ui, pos2, vec2};
use motionscope_core::scene::Series;

use crate::paint::charts::series::{Plot, Plotted, Window, draw, event, head, nearest, summary, values};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_from, rect_of};
use crate::ui::drawing::style;

/// What is plotted.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The lines.
    pub series: &'a Series,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
    /// Whether ten times as much is as far up everywhere, unless the person chose otherwise and as long as all is more than
    /// nothing.
    pub logarithmic: bool,
}

/// The plot as it is shown, and which part of it.
#[derive(Default)]
pub struct State {
    chart: Chart<Plot, (bool, Option<Window>)>,
    /// The part that was zoomed to, and what it is a part of.
    near: Option<(Zoomed, Window)>,
    /// The scale that the person chose for a quantity of this title.
    chosen: Option<(&'static str, bool)>,
}

impl State {
    /// The part of a plot that is seen, if it is not all.
    fn window(&self, input: Input<'_>) -> Option<Window> {
        let of = Zoomed::of(input, self.is_logarithmic(input));
        self.near.as_ref().filter(|(zoomed, _)| *zoomed == of).map(|(_, window)| *window)
    }

    fn is_logarithmic(&self, Input { series, logarithmic, .. }: Input<'_>) -> bool {
        self.chosen.filter(|(title, _)| *title == series.title).map_or(logarithmic, |(_, chosen)| chosen)
    }
}

/// What a zoom belongs to: another plot is seen whole.
#[derive(Clone, Debug, PartialEq)]
struct Zoomed {
    whose: String,
    title: &'static str,
    logarithmic: bool,
}

impl Zoomed {
    fn of(input: Input<'_>, logarithmic: bool) -> Self {
        Self { whose: input.subject.whose.to_owned(), title: input.series.title, logarithmic }
    }
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// The event of the step that was clicked.
    pub clicked: Option<usize>,
}

/// Shows the lines in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { series, subject, .. } = input;
    let (area, whole) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    let painter = ui.painter_at(area);
    let lay_out = |state: &mut State| {
        let (logarithmic, window) = (state.is_logarithmic(input), state.window(input));
        let data = Plotted { series, whose: subject.whose, logarithmic, window };
        let draw = |area, style| draw(data, area, style);
        (data, state.chart.lay_out(&painter, (subject, series), (area, (logarithmic, window)), draw))
    };
    let (_, before) = lay_out(state);
    let rect = rect_from(before.rect);
    let sensed = ui.interact(rect, ui.scope_id().with("series"), Sense::click_and_drag());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(series)));
    if before.is_divided {
        state.chart.body(&painter);
        state.chart.head(&painter);
        return Response::default();
    }
    travel(ui, &sensed, (input, &before), state);
    let (data, plot) = lay_out(state);
    state.chart.body(&painter);
    let hovered = sensed.hover_pos().map(|at| plot.x.value(at.x));
    let step = hovered.and_then(|x| nearest(series, x));
    match step {
        Some(x) => {
            let stroke = Stroke::new(1.0, style::color(subject.theme.chrome().dim));
            painter.vline(plot.x.place(x), rect.y_range(), stroke);
            for (role, y) in values(series, x) {
                let at = plot.at([x, y]).into();
                if rect.expand(1.0).contains(at) {
                    painter.circle_stroke(at, 5.0, Stroke::new(2.0, style::color(subject.theme.stroke(role))));
                }
            }
            over(&painter, &head(data, &plot, rect_of(area), hovered, subject.style(&painter)));
        }
        None => state.chart.head(&painter),
    }
    let is_pointed_at = ui.rect_contains_pointer(whole.rect);
    if is_pointed_at && has_scales(series) {
        scales(ui, rect, (input, plot.logarithmic), state);
    }
    Response { clicked: step.filter(|_| sensed.clicked()).and_then(|x| event(series, x)) }
}

/// Comes nearer with the wheel and goes along at a drag; a double click shows all again.
fn travel(ui: &Ui, sensed: &egui::Response, (input, plot): (Input<'_>, &Plot), state: &mut State) {
    if sensed.double_clicked() {
        state.near = None;
        return;
    }
    let now = state.window(input).unwrap_or(plot.whole);
    let mut window = now;
    if let Some(at) = sensed.hover_pos() {
        let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = pinch * (wheel / 200.0).exp();
        if factor != 1.0 {
            window = window.nearer([plot.x.value(at.x), plot.y.value(at.y)], factor, plot.whole);
        }
    }
    if sensed.dragged() {
        let by = sensed.drag_delta();
        let along = [plot.x.value(0.0) - plot.x.value(by.x), plot.y.value(0.0) - plot.y.value(by.y)];
        window = window.moved(along, plot.whole);
    }
    if window != now {
        state.near = (window != plot.whole).then(|| (Zoomed::of(input, plot.logarithmic), window));
    }
}

/// Whether there is a choice: nothing has no logarithm.
fn has_scales(series: &Series) -> bool {
    let mut all = series.lines.iter().flat_map(|(.., points)| points).map(|point| point[1]).filter(|y| !y.is_nan());
    all.next().is_some_and(|first| first > 0.0) && all.all(|y| y > 0.0)
}

/// A small button below the axis of values that changes the scale of the values.
fn scales(
    ui: &mut Ui,
    rect: Rect,
    (Input { series, subject, .. }, is_logarithmic): (Input<'_>, bool),
    state: &mut State,
) {
    let size = subject.theme.sizes().small;
    // Below the axis of values, where no data are.
    let place =
        Rect::from_min_size(pos2(rect.min.x - 4.4 * size, rect.max.y + 0.5 * size), vec2(3.2 * size, 1.5 * size));
    let button = egui::Button::new(RichText::new("log").size(size))
        .selected(is_logarithmic)
        .fill(if is_logarithmic { ui.visuals().selection.bg_fill } else { style::color(subject.theme.chrome().raised) })
        .stroke(Stroke::new(1.0, style::color(subject.theme.chrome().line)))
        .small();
    let tip =
        if is_logarithmic { "Show the values on a linear axis." } else { "Show the values on a logarithmic axis." };
    if ui.put(place, button).on_hover_text(tip).clicked() {
        state.chosen = Some((series.title, !is_logarithmic));
        state.near = None;
    }
}
