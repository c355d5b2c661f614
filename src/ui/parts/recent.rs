//! Clips that were open lately, as buttons below each other.

use std::path::PathBuf;

use eframe::egui::{self, Ui};
use lucide_icons::Icon;

use super::widgets;
use crate::ui::commands::{Action, Actions};

/// Shows a button for each clip that was open lately.
pub fn recents(ui: &mut Ui, recent: &[PathBuf], actions: &mut Actions) {
    let chosen = chosen_of(ui, recent);
    chosen.iter().for_each(|path| actions.ask(Action::Open(path.into())));
}

/// Shows a button for each clip; returns the clicked one.
pub fn chosen_of(ui: &mut Ui, recent: &[PathBuf]) -> Option<PathBuf> {
    let row = |ui: &mut Ui, path: &PathBuf| {
        let text = widgets::elide(&path.display().to_string(), 64);
        ui.add(egui::Button::new((widgets::icon(ui, Icon::History), text)).frame_when_inactive(false)).clicked()
    };
    recent.iter().take(8).filter(|path| row(ui, path)).last().cloned()
}
