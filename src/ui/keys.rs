//! The keyboard, the clipboard and dropped files: what they ask for.

use eframe::egui::{self, Event, FocusDirection, Key, Popup};

use super::action::{Action, Actions};
use super::commands::{Command, Now};
use super::dialogs::open as open_dialog;

/// Takes what the window understands out of the input, before any widget sees it.
///
/// Keys win over the widget in focus unless text is being typed or something lies over the panes.
pub fn take(ctx: &egui::Context, overlaid: bool, lecture: bool, now: &Now, actions: &mut Actions) {
    let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|file| file.path().to_owned()));
    if let Some(path) = dropped {
        actions.ask(Action::Open(path.into()));
    }
    if overlaid || ctx.text_edit_focused() {
        return;
    }
    let popup = Popup::is_any_open(ctx);
    let mut moved = false;
    ctx.input_mut(|input| {
        input.events.retain(|event| match event {
            // An open menu closes first.
            Event::Key { key: Key::Escape, pressed: true, .. } if popup => true,
            Event::Key { key: Key::Escape, pressed: true, .. } if lecture && !Command::Stop.enabled(now) => {
                actions.command(Command::Lecture);
                false
            }
            Event::Key { key, pressed: true, repeat, modifiers, .. } => {
                let Some(command) = Command::of_key(*key, *modifiers, *repeat) else {
                    // A key that would have called a command if it were not held is not the widget's either.
                    return !(*repeat && Command::of_key(*key, *modifiers, false).is_some());
                };
                moved |= matches!(key, Key::ArrowLeft | Key::ArrowRight);
                if command.enabled(now) {
                    actions.command(command);
                }
                false
            }
            Event::Paste(text) => {
                if let Some(path) = open_dialog::parse(text) {
                    actions.ask(Action::Open(path));
                }
                false
            }
            _ => true,
        });
    });
    if moved {
        // egui has taken the arrow for a wish to move the focus.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
}
