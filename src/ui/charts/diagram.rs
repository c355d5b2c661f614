//! A drawing of lines and nodes, such as a tree of hypotheses.

use eframe::egui::{self, Sense, Ui, vec2};
use motionscope_core::scene::Diagram;

use crate::paint::charts::diagram::{Sheet, Shown, draw};
use crate::ui::drawing::chart::{Chart, Subject};

/// The drawing as it is shown.
pub type State = Chart<Sheet>;

/// Shows the drawing in the whole of `ui`.
pub fn show(ui: &mut Ui, (diagram, subject): (&Diagram, Subject<'_>), state: &mut State) {
    let (area, response) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &diagram.summary));
    let painter = ui.painter_at(area);
    let data = Shown { diagram, whose: subject.whose };
    state.lay_out(&painter, (subject, diagram), (area, ()), |area, style| draw(data, area, style));
    state.body(&painter);
    state.head(&painter);
}
