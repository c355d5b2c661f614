//! Opening a clip: a typed path, the system's dialog beside it, and what was open lately.

use std::path::PathBuf;

use eframe::egui::{self, RichText, TextEdit, TextStyle, Ui, vec2};
use lucide_icons::Icon;

use crate::ui::action::{Action, Actions, Browse};
use crate::ui::commands::Command;
use crate::ui::parts::widgets;

/// The dialog while it is open.
#[derive(Default)]
pub struct State {
    /// What was typed.
    pub path: String,
    focused: bool,
}

/// A path as typed or pasted: quotes, a leading `~` and `file://` are understood.
pub fn parse(text: &str) -> Option<String> {
    let text = text.trim().trim_matches(['"', '\'']);
    let text = text.strip_prefix("file://").unwrap_or(text);
    if text.is_empty() {
        return None;
    }
    let home = std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE"));
    match (text.strip_prefix("~/"), home) {
        (Some(rest), Some(home)) => Some(PathBuf::from(home).join(rest).display().to_string()),
        _ => Some(text.to_owned()),
    }
}

/// Shows the dialog; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, recent: &[PathBuf], actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let mut done = false;
    let modal = widgets::modal(ctx, "open", vec2(40.0 * size, 30.0 * size)).show(ctx, |ui| {
        ui.set_width((40.0 * size).min(ui.ctx().content_rect().width() - 48.0));
        ui.heading("Open");
        ui.label(
            RichText::new("A video, a picture of a numbered sequence, a folder of pictures, or a session.").weak(),
        );
        ui.add_space(8.0);
        done |= path_row(ui, state, actions);
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            for (glyph, text, wanted) in
                [(Icon::FileVideo, "Browse files…", Browse::File), (Icon::Folder, "Browse folders…", Browse::Folder)]
            {
                if ui.button((widgets::icon(ui, glyph), text)).clicked() {
                    actions.ask(Action::Browse(wanted));
                    done = true;
                }
            }
            if ui.button((widgets::icon(ui, Command::Samples.face().icon), "Samples…")).clicked() {
                actions.command(Command::Samples);
                done = true;
            }
        });
        if !recent.is_empty() {
            ui.add_space(12.0);
            widgets::heading(ui, "Recent");
            done |= recents(ui, recent, actions);
        }
    });
    !(modal.should_close() || done)
}

fn path_row(ui: &mut Ui, state: &mut State, actions: &mut Actions) -> bool {
    let mut done = false;
    ui.horizontal(|ui| {
        let button = ui.spacing().interact_size.x + 32.0;
        let field = TextEdit::singleline(&mut state.path)
            .hint_text("Type or paste a path")
            .desired_width(ui.available_width() - button - 8.0);
        let response = ui.add(field).accessible_name("Path of the clip");
        if !std::mem::replace(&mut state.focused, true) {
            response.request_focus();
        }
        let entered = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let wanted = parse(&state.path);
        let clicked = ui.add_enabled(wanted.is_some(), egui::Button::new("Open")).clicked();
        if let Some(path) = wanted.filter(|_| entered || clicked) {
            actions.ask(Action::Open(path.into()));
            done = true;
        }
    });
    done
}

/// Clips that were open lately; gives whether one was chosen.
pub fn recents(ui: &mut Ui, recent: &[PathBuf], actions: &mut Actions) -> bool {
    let mut done = false;
    for path in recent.iter().take(8) {
        let text = widgets::elide(&path.display().to_string(), 64);
        let row = ui.add(egui::Button::new((widgets::icon(ui, Icon::History), text)).frame_when_inactive(false));
        if row.clicked() {
            actions.ask(Action::Open(path.into()));
            done = true;
        }
    }
    done
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn pasted_paths_are_understood() {
        assert_eq!(parse("  \"/a b/c.mp4\" \n"), Some("/a b/c.mp4".into()));
        assert_eq!(parse("file:///a/b.mp4"), Some("/a/b.mp4".into()));
        assert_eq!(parse("  "), None);
        if let Some(home) = std::env::var_os("HOME") {
            assert_eq!(parse("~/x.gif"), Some(std::path::Path::new(&home).join("x.gif").display().to_string()));
        }
    }
}
