//! A pyramid as a stack of pictures: turning it, and clicking a level.

use eframe::egui::{self, CursorIcon, Sense, Shape, Stroke, Ui, vec2};
use motionscope_core::scene::Stack;
use serde::{Deserialize, Serialize};

use crate::paint::charts::Orbit;
use crate::paint::charts::stack::{Planes, Pyramid, Seen, USUAL, draw, summary};
use crate::ui::charts::surface3d::turn;
use crate::ui::drawing::chart::{Chart, Subject};
use crate::ui::drawing::style;

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The pyramid.
    pub stack: &'a Stack,
    /// The level whose picture stands on the stage.
    pub on_stage: usize,
    /// Whose pyramid it is, and how it looks.
    pub subject: Subject<'a>,
}

/// From where one looks, and the stack as it is shown.
#[derive(Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// From where one looks.
    pub orbit: Orbit,
    #[serde(skip)]
    chart: Chart<Planes, (Orbit, usize)>,
    #[serde(skip)]
    seen: Seen,
}

impl Default for State {
    fn default() -> Self {
        Self { orbit: USUAL, chart: Chart::default(), seen: Seen::default() }
    }
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The level that was clicked.
    pub clicked: Option<usize>,
}

/// Shows the stack in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { stack, on_stage, subject } = input;
    let (area, sensed) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::click_and_drag());
    let name = || format!("{}. Drag to rotate, scroll to zoom, click a level to show it.", summary(stack));
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name()));
    turn(ui, &sensed, &mut state.orbit, USUAL);
    let painter = ui.painter_at(area);
    let State { orbit, chart, seen } = state;
    let data = Pyramid { stack, whose: subject.whose, on_stage, orbit: *orbit };
    let planes = chart
        .lay_out(&painter, (subject, stack), (area, (*orbit, on_stage)), |area, style| draw(data, area, style, seen));
    chart.body(&painter);
    chart.head(&painter);
    let pointed = sensed.hover_pos().and_then(|at| planes.level(at.into()));
    if let Some(level) = pointed {
        let corners = planes.corners[level].map(egui::Pos2::from).to_vec();
        painter.add(Shape::closed_line(corners, Stroke::new(2.0, style::color(subject.theme.chrome().text))));
        if !sensed.dragged() {
            ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
        }
    }
    Response { clicked: pointed.filter(|_| sensed.clicked()) }
}
