//! Points in space: turning them, and picking one.

use eframe::egui::{self, CursorIcon, Sense, Ui, vec2};
use motionscope_core::scene::Cloud;
use serde::{Deserialize, Serialize};

use crate::paint::charts::Orbit;
use crate::paint::charts::cloud::{Shown, USUAL, World, draw, summary};
use crate::ui::charts::surface3d::turn;
use crate::ui::drawing::chart::{Chart, Subject};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The cloud.
    pub cloud: &'a Cloud,
    /// Whose cloud it is, and how it looks.
    pub subject: Subject<'a>,
}

/// From where one looks, and the cloud as it is shown.
#[derive(Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// From where one looks.
    pub orbit: Orbit,
    #[serde(skip)]
    chart: Chart<Option<World>, Orbit>,
}

impl Default for State {
    fn default() -> Self {
        Self { orbit: USUAL, chart: Chart::default() }
    }
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The pixel of the point that was clicked.
    pub picked: Option<[u16; 2]>,
}

/// Shows the cloud in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { cloud, subject } = input;
    let (area, sensed) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::click_and_drag());
    let name = || format!("{}. Drag to rotate, scroll to zoom, click a point to explain its pixel.", summary(cloud));
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name()));
    turn(ui, &sensed, &mut state.orbit, USUAL);
    let painter = ui.painter_at(area);
    let State { orbit, chart } = state;
    let shown = Shown { cloud, whose: subject.whose, orbit: *orbit };
    let world = chart.lay_out(&painter, (subject, cloud), (area, *orbit), |area, style| draw(shown, area, style));
    chart.body(&painter);
    chart.head(&painter);
    let at = sensed.hover_pos().filter(|_| sensed.clicked());
    let picked = at.and_then(|at| world?.pick(cloud.data(), at.into()));
    if sensed.hovered() && !sensed.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    Response { picked }
}
