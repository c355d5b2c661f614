//! Which level of a pyramid stands on the stage.

use eframe::egui::{self, Ui, WidgetInfo};

use super::Input;
use crate::paint::LevelShown;
use crate::view::tile;

/// The levels in a list, where the step works on a pyramid.
pub fn choice(ui: &mut Ui, input: &Input<'_>, shown: &mut LevelShown) {
    let tiles = input.lockstep.map_or(&[][..], |all| all.tiles);
    let Some(levels) = tile::levels(input.scene, tiles) else { return };
    let number = |level: usize| {
        let (width, height) = levels.size(level);
        let of = if level == 0 { "the picture itself" } else { "of the pyramid" };
        (LevelShown::Number(level), format!("Level {level}"), format!("Level {level}, {of}, {width}×{height} px."))
    };
    let tip = "Show the pyramid level on which this step searches.";
    let at_work = (LevelShown::AtWork, format!("Level at work ({})", levels.at_work), tip.to_owned());
    let now = format!("Level {}", shown.of(levels));
    let list = egui::ComboBox::from_id_salt("pyramid level").selected_text(now).show_ui(ui, |ui| {
        for (choice, text, tip) in std::iter::once(at_work).chain((0..levels.all.len()).map(number)) {
            let is_chosen = *shown == choice;
            let response = ui.selectable_label(is_chosen, &text);
            response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_chosen, &text));
            if response.on_hover_text(tip).clicked() {
                *shown = choice;
                ui.ctx().request_repaint();
            }
        }
    });
    list.response.accessible_name("Level");
}
