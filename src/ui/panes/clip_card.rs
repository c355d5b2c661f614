//! What the clip is, at the top of the parameters: name, size, truth, warnings, and the frame to run on.

use std::sync::Arc;

use eframe::egui::{Align, DragValue, Id, Layout, RichText, Ui};
use lucide_icons::Icon;

use crate::experiment::{is_of_pair, is_repeated, repeated_note};
use crate::paint::grouped;
use crate::ui::commands::{Action, Actions, Command};
use crate::ui::drawing::style;
use crate::ui::model::document::Document;
use crate::ui::parts::widgets;

/// Draws the card.
pub fn show(ui: &mut Ui, document: &Document, actions: &mut Actions) {
    ui.horizontal(|ui| {
        widgets::heading(ui, "Clip");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            for command in [Command::Open, Command::Samples, Command::Lessons] {
                let face = command.entry();
                if widgets::icon_button(ui, face.icon, face.text, false).on_hover_text(face.tip).clicked() {
                    actions.command(command);
                }
            }
        });
    });
    let Some(clip) = document.clip() else {
        ui.label(widgets::dim(ui, "No clip is open."));
        return;
    };
    let info = clip.info();
    ui.label(RichText::new(&info.name).family(style::bold())).on_hover_text(&info.name);
    if let Some(sample) = document.sample() {
        ui.label(widgets::dim(ui, sample.teaches).small());
    }
    ui.label(widgets::dim(ui, facts(document)).small());
    frame(ui, document, actions);
    let repeated = is_repeated_pair(ui, document).then(|| repeated_note(document.frame()));
    for warning in info.warnings.iter().chain(&repeated) {
        ui.horizontal_wrapped(|ui| {
            ui.label(widgets::icon(ui, Icon::TriangleAlert).color(ui.visuals().warn_fg_color));
            ui.label(RichText::new(warning).small());
        });
    }
}

/// Whether the run is on one pair of frames that are identical. They are compared once.
fn is_repeated_pair(ui: &Ui, document: &Document) -> bool {
    let t = document.frame();
    let Some(clip) = document.clip().filter(|_| is_of_pair(document.estimator())) else { return false };
    let Some((first, second)) = clip.cached(t).zip(clip.cached(t + 1)) else { return false };
    let id = Id::unique(("is_repeated_pair", Arc::as_ptr(&first), Arc::as_ptr(&second)));
    ui.data_mut(|data| *data.get_temp_mut_or_insert_with(id, || is_repeated(clip, t) == Some(true)))
}

/// Size, length, format and truth in one line: `320×240 px · 24 frames at 25/s · h264 in mp4 · truth: flow`.
pub fn facts(document: &Document) -> String {
    let Some(clip) = document.clip() else { return String::new() };
    let info = clip.info();
    let mut facts = vec![format!("{}×{} px", info.width, info.height)];
    let rate = info.fps.map_or_else(String::new, |fps| format!(" at {}/s", (fps * 100.0).round() / 100.0));
    match info.frames {
        Some(1) => facts.push(format!("1 frame{rate}")),
        Some(frames) => facts.push(format!("{} frames{rate}", grouped(frames))),
        None if !rate.is_empty() => facts.push(format!("frames{rate}")),
        None => {}
    }
    facts.push(match info.container.as_str() {
        "synthetic" => "synthetic".to_owned(),
        _ if clip.is_blank() => "detections without images".to_owned(),
        container if container == info.codec => container.to_owned(),
        container => format!("{} in {container}", info.codec),
    });
    if let Some(right) = clip.right().filter(|_| info.container != "synthetic") {
        let cameras = if clip.calibration().is_some() { "calibrated" } else { "not calibrated" };
        facts.push(format!("right view {}, {cameras}", right.info().name));
    }
    if let Some(truth) = clip.truth() {
        let names = truth.names();
        let from = if names.is_empty() { String::new() } else { format!(" from {}", names.join(", ")) };
        facts.push(format!("true {} known{from}", truth.kinds().join(", ")));
    }
    if clip.detections(0).is_some() {
        facts.push("objects detected".into());
    }
    facts.join(" · ")
}

/// A small button to another pair of frames.
fn to_frame(ui: &mut Ui, glyph: Icon, command: Command, actions: &mut Actions) {
    let face = command.entry();
    if widgets::icon_button(ui, glyph, face.text, false).on_hover_text(command.with_key(face.tip)).clicked() {
        actions.command(command);
    }
}

fn frame(ui: &mut Ui, document: &Document, actions: &mut Actions) {
    let now = document.frame();
    let last = document.last_frame().unwrap_or(usize::MAX >> 12);
    let is_first = document.estimator().is_by_frame();
    let (name, tip) = match is_first {
        true => ("First frame", "The frame at which the run begins; it goes on through the clip."),
        false => ("Frame", "Frame t, the first of the pair; frame t + 1 is the second."),
    };
    // A narrow pane has the name on a line of its own.
    let narrow = ui.available_width() < 7.5 * ui.spacing().interact_size.y;
    let above = narrow.then(|| ui.label(name).on_hover_text(tip));
    ui.horizontal(|ui| {
        let label = above.unwrap_or_else(|| ui.label(name).on_hover_text(tip));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            ui.add_enabled_ui(now < last, |ui| {
                to_frame(ui, Icon::ChevronRight, Command::NextFrame, actions);
            });
            let mut wanted = now;
            let shown = move |v: f64| if is_first { v.to_string() } else { format!("{v} → {}", v + 1.0) };
            let field = DragValue::new(&mut wanted).range(0..=last).custom_formatter(move |v, _| shown(v));
            let field = field.custom_parser(|text| text.split('→').next().and_then(|t| t.trim().parse().ok()));
            let size = eframe::egui::vec2(ui.spacing().interact_size.y * 3.0, ui.spacing().interact_size.y);
            let typed = ui.add_sized(size, field).labelled_by(label.id);
            typed.on_hover_text(format!("{tip} Drag or type."));
            ui.add_enabled_ui(now > 0, |ui| {
                to_frame(ui, Icon::ChevronLeft, Command::PreviousFrame, actions);
            });
            if wanted != now {
                actions.ask(Action::Frame(wanted));
            }
        });
    });
}
