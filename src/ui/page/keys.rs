//! The keys that call commands do nothing else in the browser. Its own keys are not among them, which a test of the table holds.

use eframe::egui::{Key, Modifiers};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;

use crate::ui::commands::{Command, PANE_KEY};

/// Keeps the browser from doing what it does by default with the keys of commands, for as long as the page is open.
pub(super) fn take(window: &web_sys::Window) {
    let pressed = Closure::<dyn FnMut(web_sys::KeyboardEvent)>::new(|event: web_sys::KeyboardEvent| {
        if is_taken(&event) {
            event.prevent_default();
        }
    });
    let listener = pressed.as_ref().unchecked_ref();
    // Before the canvas, which keeps its events to itself.
    if window.add_event_listener_with_callback_and_bool("keydown", listener, true).is_ok() {
        pressed.forget();
    }
}

/// Whether a command is called by this key and not typed: with Ctrl, ⌘ or Alt, or by a key without a letter.
fn is_taken(event: &web_sys::KeyboardEvent) -> bool {
    let command = event.ctrl_key() || event.meta_key();
    let modifiers = Modifiers {
        alt: event.alt_key(),
        ctrl: event.ctrl_key(),
        shift: event.shift_key(),
        mac_cmd: event.meta_key(),
        command,
    };
    let named = [event.key(), event.code()].into_iter().find_map(|name| Key::from_name(name.trim_start_matches("Key")));
    let is_typed = event.key().chars().count() == 1 && !command && !event.alt_key();
    let is_called = |key| key == PANE_KEY || Command::of_key(key, modifiers, false).is_some();
    // Space, arrows and the like are taken from the page by the canvas.
    !is_typed && named.is_some_and(is_called)
}
