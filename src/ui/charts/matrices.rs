//! Matrices with the numbers of a step, to be scrolled where they do not fit.

use eframe::egui::{self, Pos2, Rect, Response, Sense, Ui, WidgetInfo, style::ScrollStyle, vec2};
use motionscope_core::scene::{Math, Matrix};

use crate::paint::charts::matrices::{draw_to_scroll, plain};
use crate::ui::drawing::chart::{Chart, Subject, rect_from};

/// How far a letter at the left may lean out of its matrix, in points.
const LEANING_PT: f32 = 4.0;

/// The matrices as they are shown.
#[derive(Default)]
pub struct State {
    chart: Chart<Vec<crate::paint::primitive::Rect>>,
    /// How far they are scrolled to the right and down, in whole points.
    pub scrolled: [f32; 2],
}

/// Shows all matrices, as many beside each other as fit; where not all are seen at once, those of the `formula` come first. Gives the one
/// that is pointed at, by its place among them.
pub fn show(
    ui: &mut Ui,
    (matrices, formula): (&[Matrix], &[Math]),
    subject: Subject<'_>,
    state: &mut State,
) -> Option<(usize, Response)> {
    let room = ui.available_size();
    let painter = ui.painter().clone();
    // They are laid out from the origin on, and shown wherever they are scrolled to.
    let area = Rect::from_min_size(Pos2::ZERO, room);
    let draw = |area, style| draw_to_scroll((matrices, formula), area, style);
    let places = state.chart.lay_out(&painter, (subject, matrices), (area, ()), draw);
    let places: Vec<Rect> = places.into_iter().map(rect_from).collect();
    let whole = places.iter().fold(Rect::from_min_size(Pos2::ZERO, vec2(0.0, 0.0)), |all, rect| all.union(*rect));
    // Bars that stay tell that there is more, in a colour that is seen from the last row.
    let is_cut = whole.width() > room.x || whole.height() > room.y;
    if is_cut {
        ui.spacing_mut().scroll = ScrollStyle { foreground_color: true, ..ScrollStyle::solid() };
    }
    let [_, scrolled] = state.scrolled;
    let is_at_end = scrolled + room.y >= whole.height() - 1.0;
    let end = if is_at_end { room.y } else { end_of_view(&places, scrolled, room.y) };
    let scroll = egui::ScrollArea::both().id_salt("matrices").auto_shrink(false);
    let shown = scroll.show(ui, |ui| {
        let (rect, _) = ui.allocate_exact_size(whole.size(), Sense::hover());
        let clip = ui.clip_rect();
        let bottom = clip.max.y.min(rect.min.y + scrolled + end);
        ui.set_clip_rect(clip.with_min_x(clip.min.x - LEANING_PT).with_max_y(bottom));
        let by = rect.min.to_vec2();
        let mut pointed = None;
        for (i, (matrix, place)) in matrices.iter().zip(&places).enumerate() {
            let sensed = ui.interact(place.translate(by), ui.scope_id().with(("matrix", i)), Sense::hover());
            sensed.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, plain(matrix)));
            if sensed.hovered() {
                pointed = Some((i, sensed));
            }
        }
        state.chart.moved(ui.painter(), by);
        pointed
    });
    state.scrolled = shown.state.clamped_offset().round().into();
    shown.inner
}

/// How far down a view of this height shows matrices at `places`, once they are scrolled: none begins that does not end in it, unless it
/// is the first.
fn end_of_view(places: &[Rect], scrolled: f32, height: f32) -> f32 {
    let is_cut = |place: &&Rect| place.min.y > scrolled + 1.0 && place.max.y > scrolled + height;
    places.iter().filter(is_cut).map(|place| place.min.y - scrolled).fold(height, f32::min)
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    #[test]
    fn no_matrix_is_seen_in_part_unless_there_is_room_for_none() {
        let place = |from: f32, to: f32| Rect::from_min_max(pos2(0.0, from), pos2(50.0, to));
        let places = [place(0.0, 40.0), place(50.0, 90.0), place(100.0, 180.0)];
        assert_eq!(
            [200.0, 120.0, 60.0, 30.0].map(|height| end_of_view(&places, 0.0, height)),
            [200.0, 100.0, 50.0, 30.0]
        );
        assert_eq!(end_of_view(&places, 50.0, 60.0), 50.0, "scrolled to the second");
    }
}
