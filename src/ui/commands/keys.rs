//! The keys of commands: which one calls what, and their names.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::Command;
use crate::files::IN_PAGE;

/// The key that goes from pane to pane. In a browser F6 goes to its address.
pub const PANE_KEY: Key = if IN_PAGE { Key::F8 } else { Key::F6 };

impl Command {
    /// The command that a key calls.
    pub fn of_key(key: Key, modifiers: Modifiers, repeat: bool) -> Option<Command> {
        let called = |command: &Command| command.entry().keys.iter().any(|shortcut| presses(*shortcut, key, modifiers));
        Self::ALL.iter().copied().find(called).filter(|command| !repeat || command.entry().repeats)
    }
}

/// Whether `key` with `modifiers` is `shortcut`. Signs may need Shift on some keyboards, so it is ignored for them.
fn presses(shortcut: KeyboardShortcut, key: Key, mut modifiers: Modifiers) -> bool {
    if matches!(key, Key::Plus | Key::Equals | Key::Minus | Key::Questionmark | Key::OpenBracket | Key::CloseBracket) {
        modifiers.shift = false;
    }
    shortcut.logical_key == key && modifiers.matches_exact(shortcut.modifiers)
}

/// A shortcut in words: `Ctrl+Shift+Z`, `→`.
pub fn key_text(shortcut: KeyboardShortcut) -> String {
    let KeyboardShortcut { modifiers, logical_key } = shortcut;
    let mut text = String::new();
    let command = if cfg!(target_os = "macos") { "⌘" } else { "Ctrl+" };
    for (held, name) in [(modifiers.command, command), (modifiers.alt, "Alt+"), (modifiers.shift, "Shift+")] {
        if held {
            text += name;
        }
    }
    text + match logical_key {
        Key::ArrowLeft => "←",
        Key::ArrowRight => "→",
        Key::PageDown => "PgDn",
        Key::PageUp => "PgUp",
        Key::Escape => "Esc",
        Key::Comma => ",",
        Key::Period => ".",
        Key::Plus => "+",
        Key::Equals => "=",
        Key::Minus => "−",
        Key::Questionmark => "?",
        Key::OpenBracket => "[",
        Key::CloseBracket => "]",
        other => other.name(),
    }
}

/// Whether a browser has this shortcut for itself: tabs, windows and history, its address and search, zoom, printing, its tools and its
/// menus. Saving, opening and undoing are what a page does with these keys as well.
pub fn is_of_browser(shortcut: KeyboardShortcut) -> bool {
    use Key as K;
    let KeyboardShortcut { modifiers, logical_key: key } = shortcut;
    const DIGITS: [Key; 10] =
        [K::Num0, K::Num1, K::Num2, K::Num3, K::Num4, K::Num5, K::Num6, K::Num7, K::Num8, K::Num9];
    match (modifiers.command, modifiers.alt, modifiers.shift) {
        (false, false, _) => matches!(key, K::F3 | K::F5 | K::F6 | K::F7 | K::F10 | K::F11 | K::F12),
        (true, false, false) => {
            let is_tab = matches!(key, K::T | K::N | K::W | K::Q | K::Tab | K::PageUp | K::PageDown | K::F4);
            let is_page = matches!(key, K::R | K::F5 | K::L | K::P | K::F | K::G | K::U | K::D | K::H | K::J);
            is_tab || is_page || DIGITS.contains(&key) || matches!(key, K::Plus | K::Equals | K::Minus)
        }
        (true, false, true) => {
            let is_tab = matches!(key, K::T | K::N | K::W | K::Q | K::A | K::Tab | K::PageUp | K::PageDown);
            let is_tool = matches!(key, K::I | K::J | K::C | K::K | K::M | K::B | K::D | K::O | K::H | K::Y);
            is_tab || is_tool || matches!(key, K::R | K::P | K::G | K::Delete | K::Plus | K::Equals)
        }
        (false, true, _) => {
            let is_menu = matches!(key, K::F | K::E | K::V | K::S | K::B | K::T | K::H | K::D | K::F4 | K::Space);
            is_menu || DIGITS.contains(&key) || matches!(key, K::ArrowLeft | K::ArrowRight | K::Home)
        }
        (true, true, _) => false,
    }
}
