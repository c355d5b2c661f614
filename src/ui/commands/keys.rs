//! The keys of commands: which one calls what, and their names.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::Command;

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
