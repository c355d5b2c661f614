//! The keyboard, the clipboard and dropped files: what they ask for.

use std::collections::BTreeSet;

use eframe::egui::{self, Event, FocusDirection, Id, Key, Popup};

use crate::ui::app::action::{Action, Actions};
use crate::ui::app::commands::{Command, Now};
use crate::ui::dialogs::open as open_dialog;

/// The keys that are down, by where they lie on the keyboard.
///
/// A key may be let go as another than it was pressed as: `?` becomes `/` once Shift is up. Who goes by its name
/// believes that `?` is still held, and takes the next one for a repetition.
#[derive(Clone, Default)]
struct Held(BTreeSet<Key>);

impl Held {
    /// Takes out the keys that were let go, and all where the window is left.
    fn follow(&mut self, ctx: &egui::Context) {
        ctx.input(|input| {
            for event in &input.events {
                match event {
                    Event::Key { physical_key: Some(key), pressed: false, .. } => drop(self.0.remove(key)),
                    Event::WindowFocused(false) => self.0.clear(),
                    _ => {}
                }
            }
        });
    }

    /// Whether a key that was pressed was down already; `told` says so where its place is not known.
    fn press(&mut self, place: Option<Key>, told: bool) -> bool {
        place.map_or(told, |key| !self.0.insert(key))
    }
}

/// Takes what the window understands out of the input, before any widget sees it.
///
/// Keys win over the widget in focus unless text is being typed or something lies over the panes.
pub fn take(ctx: &egui::Context, overlaid: bool, lecture: bool, now: &Now, actions: &mut Actions) {
    let mut held: Held = ctx.data(|data| data.get_temp(Id::NULL)).unwrap_or_default();
    // Also while something lies over the panes: a key that opened it is let go there.
    held.follow(ctx);
    ctx.data_mut(|data| data.insert_temp(Id::NULL, held.clone()));
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
            Event::Key { key: Key::Escape, pressed: true, .. } if now.is_placing && !Command::Stop.enabled(now) => {
                actions.ask(Action::Place(None));
                false
            }
            Event::Key { key: Key::Escape, pressed: true, .. } if now.holds_pixel && !Command::Stop.enabled(now) => {
                actions.ask(Action::Release);
                false
            }
            Event::Key { key: Key::Escape, pressed: true, .. } if now.has_enlarged && !Command::Stop.enabled(now) => {
                actions.command(Command::EnlargeChart);
                false
            }
            Event::Key { key: Key::Escape, pressed: true, .. } if lecture && !Command::Stop.enabled(now) => {
                actions.command(Command::Lecture);
                false
            }
            Event::Key { key: Key::Escape, pressed: true, .. } if now.in_lockstep && !Command::Stop.enabled(now) => {
                actions.command(Command::Lockstep);
                false
            }
            Event::Key { key, physical_key, pressed: true, repeat, modifiers } => {
                let repeat = held.press(*physical_key, *repeat);
                let Some(command) = Command::of_key(*key, *modifiers, repeat) else {
                    // A key that would have called a command if it were not held is not the widget's either.
                    return !(repeat && Command::of_key(*key, *modifiers, false).is_some());
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
    ctx.data_mut(|data| data.insert_temp(Id::NULL, held));
    if moved {
        // egui has taken the arrow for a wish to move the focus.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
}
