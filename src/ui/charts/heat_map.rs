//! A cost over displacements: what is pointed at and clicked on its map.

use eframe::egui::{self, Sense, Stroke, StrokeKind, Ui, vec2};
use motionscope_core::scene::Surface;

use crate::paint::charts::Map;
pub use crate::paint::charts::heat_map::summary;
use crate::paint::charts::heat_map::{HeatMap, draw, event, head};
use crate::ui::drawing::chart::{Chart, Subject, over, rect_from, rect_of};
use crate::ui::drawing::style;

/// What is mapped.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The costs.
    pub surface: &'a Surface,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
}

/// The map as it is shown.
pub type State = Chart<Map>;

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// What was clicked.
    pub clicked: Option<Clicked>,
    /// The displacement under the pointer, in px.
    pub hovered: Option<[i32; 2]>,
}

/// A displacement that was clicked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clicked {
    /// It was tested by this event.
    Tested(usize),
    /// It was not tested up to this step; in px.
    Untested([i32; 2]),
}

/// Shows the map as large as it fits.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { surface, subject } = input;
    let (area, _) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::hover());
    let painter = ui.painter_at(area);
    let data = HeatMap { surface, whose: subject.whose };
    let map = state.lay_out(&painter, (subject, surface), (area, ()), |area, style| draw(data, area, style));
    let sensed = ui.interact(rect_from(map.rect), ui.scope_id().with("heat map"), Sense::click());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(surface)));
    let hovered = sensed.hover_pos().and_then(|at| map.displacement(at.into()));
    state.body(&painter);
    match hovered {
        Some(at) => {
            let stroke = Stroke::new(1.5, style::color(subject.theme.chrome().text));
            painter.rect_stroke(rect_from(map.cell_rect(at)).expand(1.0), 0.0, stroke, StrokeKind::Outside);
            over(&painter, &head(data, &map, rect_of(area), Some(at), subject.style(&painter)));
        }
        None => state.head(&painter),
    }
    let clicked = hovered.filter(|_| sensed.clicked());
    let clicked = clicked.map(|at| event(surface, at).map_or(Clicked::Untested(at), Clicked::Tested));
    Response { clicked, hovered }
}
