//! Matrices with the numbers of a step, to be scrolled where they do not fit.

use eframe::egui::{self, Pos2, Rect, Sense, Ui, WidgetInfo, style::ScrollStyle, vec2};
use motionscope_core::scene::Matrix;

use crate::paint::charts::matrices::{draw, plain};
use crate::ui::drawing::chart::{Chart, Subject, rect_from};

/// The matrices as they are shown.
pub type State = Chart<Vec<crate::paint::primitive::Rect>>;

/// Shows all matrices, as many beside each other as fit.
pub fn show(ui: &mut Ui, matrices: &[Matrix], subject: Subject<'_>, state: &mut State) {
    let room = ui.available_size();
    let painter = ui.painter().clone();
    // They are laid out from the origin on, and shown wherever they are scrolled to.
    let area = Rect::from_min_size(Pos2::ZERO, room);
    let places = state.lay_out(&painter, (subject, matrices), (area, ()), |area, style| draw(matrices, area, style));
    let places: Vec<Rect> = places.into_iter().map(rect_from).collect();
    let whole = places.iter().fold(Rect::from_min_size(Pos2::ZERO, vec2(0.0, 0.0)), |all, rect| all.union(*rect));
    // Bars that stay tell that there is more.
    let is_cut = whole.width() > room.x || whole.height() > room.y;
    if is_cut {
        ui.spacing_mut().scroll = ScrollStyle::solid();
    }
    egui::ScrollArea::both().id_salt("matrices").auto_shrink(false).show(ui, |ui| {
        let (rect, _) = ui.allocate_exact_size(whole.size(), Sense::hover());
        let by = rect.min.to_vec2();
        for (i, (matrix, place)) in matrices.iter().zip(&places).enumerate() {
            let sensed = ui.interact(place.translate(by), ui.scope_id().with(("matrix", i)), Sense::hover());
            sensed.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, plain(matrix)));
        }
        state.moved(ui.painter(), by);
    });
}
