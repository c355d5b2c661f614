//! Which level of a pyramid stands on the stage.

use eframe::egui::{self, Ui, WidgetInfo};

use super::Input;
use crate::paint::LevelShown;
use crate::view::tile;

/// The levels in a row, where the step works on a pyramid.
pub fn tools(ui: &mut Ui, input: &Input<'_>, shown: &mut LevelShown) {
    let tiles = input.lockstep.map_or(&[][..], |all| all.tiles);
    let Some(levels) = tile::levels(input.scene, tiles) else { return };
    let number = |level: usize| {
        let (width, height) = levels.size(level);
        let of = if level == 0 { "the picture itself" } else { "of the pyramid" };
        (LevelShown::Number(level), level.to_string(), format!("Level {level}, {of}, {width}×{height} px."))
    };
    let tip = "The level that the search works on: the pictures that it really sees.";
    let at_work = (LevelShown::AtWork, "at work".to_owned(), tip.to_owned());
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.weak("Level");
        ui.add_space(6.0);
        for (choice, text, tip) in std::iter::once(at_work).chain((0..levels.all.len()).map(number)) {
            let is_chosen = *shown == choice;
            let response = ui.selectable_label(is_chosen, &text);
            response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_chosen, format!("Level {text}")));
            if response.on_hover_text(tip).clicked() {
                *shown = choice;
                ui.ctx().request_repaint();
            }
        }
        let (seen, (width, height)) = (shown.of(levels), levels.size(shown.of(levels)));
        ui.add_space(8.0);
        ui.weak(format!("level {seen}: {width}×{height} px"));
    });
}
