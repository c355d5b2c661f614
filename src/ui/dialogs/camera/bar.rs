//! The line below the picture of the camera: its state, and the buttons that make recordings.

use eframe::egui::{Align, Button, Label, Layout, RichText, Ui};
use lucide_icons::Icon;
use motionscope_core::base::words::capital;
use motionscope_core::course::estimator;
use web_time::Instant;

use super::{Keys, State, countdown};
use crate::media::camera::Size;
use crate::ui::commands::{Action, Actions};
use crate::ui::parts::widgets;

/// The state of the camera, and the buttons that make recordings; returns whether the last recording is opened.
pub(super) fn show(ui: &mut Ui, state: &mut State, keys: &mut Keys, actions: &mut Actions) -> bool {
    let mut reopens = false;
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let seconds = state.choices.seconds;
            let (text, tip) = if state.countdown.is_some() {
                ("Cancel".to_owned(), "Cancel the countdown.\nEscape")
            } else if state.recorded().is_some() {
                ("Stop recording".to_owned(), "Stop recording and open the frames so far; Escape discards them.\nR")
            } else {
                (format!("Record {seconds} s"), "Record the next seconds, and open them as a clip.\nR")
            };
            let fill = if state.can_cancel() { ui.visuals().error_fg_color } else { ui.visuals().hyperlink_color };
            let button = Button::new(RichText::new(text).color(ui.visuals().panel_fill)).fill(fill);
            keys.records |= ui.add_enabled(state.can_record(), button).on_hover_text(tip).clicked();
            timer(ui, state);
            let text = format!("Freeze the last {seconds} s");
            let tip = "Open the last seconds as a clip, with this estimator.\nSpace";
            let freeze = ui.add_enabled(state.can_freeze(), Button::new(text));
            keys.freezes |= freeze.on_hover_text(tip).clicked();
            if let Some(last) = &state.last
                && ui.button("Last recording").on_hover_text("Open the last recording again.").clicked()
            {
                actions.ask(Action::Open(last.into()));
                reopens = true;
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                if state.keeping.is_some() {
                    ui.spinner();
                }
                ui.add(Label::new(RichText::new(told(state)).weak()).truncate());
            });
        });
    });
    reopens
}

/// The switch of the countdown.
fn timer(ui: &mut Ui, state: &mut State) {
    let (is_busy, is_on) = (state.is_busy(), state.choices.has_countdown);
    let name = format!("Countdown of {} s", countdown::SECONDS);
    let tip = format!("Count down {} s before a recording, to step before the camera.", countdown::SECONDS);
    let button = |ui: &mut Ui| widgets::icon_button(ui, Icon::Timer, &name, is_on);
    if ui.add_enabled_ui(!is_busy, button).inner.on_hover_text(tip).clicked() {
        state.choices.has_countdown = !is_on;
    }
}

/// The state of the camera and the estimator, in numbers.
fn told(state: &State) -> String {
    let (Some(live), Some(view)) = (state.live(), state.view()) else { return String::new() };
    if state.keeping.is_some() {
        return "Opening the recording…".into();
    }
    if let Some(number) = state.countdown.as_ref().and_then(|countdown| countdown.number(Instant::now())) {
        return format!("Recording begins in {number} s. Escape cancels it.");
    }
    if let Some(recorded) = state.recorded() {
        return format!("Recording: {:.1} s of {} s", recorded.as_secs_f64(), state.choices.seconds);
    }
    if let Some(error) = live.camera().ended().filter(|_| view.seen.is_some()) {
        return format!("{}. The last seconds can still be frozen.", capital(&error.to_string()));
    }
    if let Some(error) = view.error {
        return format!("{}.", capital(&error.to_string()));
    }
    let rate = |rate: Option<f64>| rate.map_or_else(String::new, |rate| format!("{rate:.0} frames/s"));
    let other = live.camera().format().and_then(|format| other_size(format.size(), state.choices.size));
    let parts = [rate(live.camera().rate()), other.unwrap_or_default()];
    let camera = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
    match state.estimator.and_then(|id| estimator(id).ok()) {
        Some(one) if view.rate.is_some() => {
            let (name, rate) = (one.info().name, rate(view.rate));
            format!("{name}: {rate}, {} frames dropped; camera: {camera}", view.dropped)
        }
        Some(one) => format!("Starting {}…", one.info().name),
        None => camera,
    }
}

/// Says that the camera sends frames of another size than the one `asked` for, if it does.
fn other_size((width, height): (usize, usize), asked: Size) -> Option<String> {
    let is_other = Size::new(width, height) != asked;
    is_other.then(|| format!("{width}×{height} px, asked for {}×{}", asked.width, asked.height))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_size_than_asked_for_is_reported() {
        let asked = Size::new(1280, 720);
        assert_eq!(other_size((640, 480), asked).as_deref(), Some("640×480 px, asked for 1280×720"));
        assert_eq!(other_size((1280, 720), asked), None);
    }
}
