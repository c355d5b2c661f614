//! The choice of the estimators that are compared.

use crate::ui::commands::Actions;
use eframe::egui::{Button, RichText, TextEdit, TextStyle, Ui, vec2};
use motionscope_core::course::estimators;
use motionscope_core::run::Info;

use super::{MOST, State, step_by_step};

/// Chooses the estimators; returns whether they are to go in lockstep.
pub fn choice(ui: &mut Ui, state: &mut State, actions: &mut Actions) -> bool {
    let all: Vec<&'static Info> = estimators().iter().map(|estimator| estimator.info()).collect();
    let is_full = state.chosen.len() >= MOST;
    let count = RichText::new(format!("{} of {MOST}", state.chosen.len())).small().weak();
    let mut taken = false;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        let infos = state.chosen.iter().filter_map(|id| all.iter().find(|info| info.id == *id));
        let clicked: Vec<_> = infos
            .filter(|info| {
                let button = ui.add(Button::selectable(true, info.name));
                button.on_hover_text(format!("{} Click to remove it.", info.summary)).clicked()
            })
            .map(|info| info.id)
            .collect();
        state.chosen.retain(|id| !clicked.contains(id));
        ui.label(count);
        if ui.button("Done").on_hover_text("Give the results the room.").clicked() {
            state.is_choosing = false;
        }
        taken = step_by_step(ui, state, actions);
    });
    families(ui, state, &all);
    let wanted = state.wanted.to_lowercase();
    let is_offered = |info: &&&'static Info| {
        let is_found = info.name.to_lowercase().contains(&wanted) || info.id.contains(&wanted);
        !state.chosen.contains(&info.id) && if wanted.is_empty() { info.family == state.family } else { is_found }
    };
    let offered: Vec<_> = all.iter().filter(is_offered).collect();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        if offered.is_empty() {
            ui.label(RichText::new("No other estimator here.").weak());
        }
        for info in offered {
            let button = ui.add_enabled(!is_full, Button::selectable(false, info.name));
            let full = format!("At most {MOST} estimators can be compared; remove one first.");
            if button.on_hover_text(info.summary).on_disabled_hover_text(full).clicked() {
                state.chosen.push(info.id);
            }
        }
    });
    taken
}

/// Chooses the family that is offered, or searches in all of them.
fn families(ui: &mut Ui, state: &mut State, all: &[&'static Info]) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        let search = TextEdit::singleline(&mut state.wanted).hint_text("Find an estimator").desired_width(11.0 * size);
        ui.add(search).accessible_name("Find an estimator");
        for family in all.chunk_by(|a, b| a.family == b.family).map(|of_family| of_family[0].family) {
            let is_now = state.family == family && state.wanted.is_empty();
            let tab = ui.add(Button::selectable(is_now, RichText::new(family).small()));
            if tab.clicked() {
                (state.family, state.wanted) = (family, String::new());
            }
        }
    });
}
