//! A field for a path: Tab completes it from the folder, `~` stands for the home folder.

use std::path::{MAIN_SEPARATOR, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{self, FocusDirection, Id, Key, Modifiers, RichText, TextEdit, Ui};

use crate::files;
use crate::ui::parts::widgets;
use crate::work;

/// Entries of a folder that are looked at.
const MOST_ENTRIES: usize = 20_000;
/// Names that are told below the field.
const MOST_LISTED: usize = 6;

/// A field for a path while its dialog is open.
#[derive(Default)]
pub struct PathField {
    /// The path as it was typed.
    pub text: String,
    is_focused: bool,
    completion: Completion,
}

/// What Tab has found.
#[derive(Default)]
struct Completion {
    /// The folder that is being read, on a thread of its own, and the text that is to be completed.
    coming: Option<(Receiver<Vec<String>>, Typed)>,
    /// What stands before the names.
    base: String,
    /// The names that fit.
    names: Vec<String>,
    /// Which of them stands in the field.
    chosen: Option<usize>,
    /// The text as Tab has left it.
    offered: String,
    /// What is told below the field.
    listed: String,
}

/// A path as far as it was typed: the folder as text, up to its last separator, and the beginning of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Typed {
    base: String,
    start: String,
}

impl Typed {
    fn of(text: &str) -> Self {
        let text = expanded(text);
        let end = text.rfind(std::path::is_separator).map_or(0, |at| at + 1);
        Self { base: text[..end].to_owned(), start: text[end..].to_owned() }
    }

    fn folder(&self) -> PathBuf {
        if self.base.is_empty() { ".".into() } else { self.base.clone().into() }
    }

    fn text(&self) -> String {
        format!("{}{}", self.base, self.start)
    }
}

/// `text` with a leading `~` as the home folder.
fn expanded(text: &str) -> String {
    let home = || files::home().and_then(|home| home.into_os_string().into_string().ok());
    match text.strip_prefix('~') {
        Some(rest) if rest.is_empty() || rest.starts_with(std::path::is_separator) => match home() {
            Some(home) => {
                let rest = rest.trim_start_matches(std::path::is_separator);
                format!("{}{MAIN_SEPARATOR}{rest}", home.trim_end_matches(std::path::is_separator))
            }
            None => text.to_owned(),
        },
        _ => text.to_owned(),
    }
}

/// The names in a folder that begin with what was typed, folders with a separator behind them. Names that are no Unicode cannot
/// stand in a field and are left out, and so are hidden ones unless a point was typed.
fn names(typed: &Typed) -> Vec<String> {
    let entries = files::entries(&typed.folder()).take(MOST_ENTRIES);
    let named = entries.filter_map(|entry| {
        let name = entry.file_name()?.to_str()?.to_owned();
        let is_shown = name.starts_with(&typed.start) && (typed.start.starts_with('.') || !name.starts_with('.'));
        is_shown.then(|| if files::is_dir(&entry) { format!("{name}{MAIN_SEPARATOR}") } else { name })
    });
    let mut names: Vec<String> = named.collect();
    names.sort_unstable();
    names
}

/// The longest beginning that all of `names` share.
fn common(names: &[String]) -> String {
    let Some((first, rest)) = names.split_first() else { return String::new() };
    let shared = |name: &String| first.chars().zip(name.chars()).take_while(|(a, b)| a == b).count();
    let length = rest.iter().map(shared).min().unwrap_or(first.chars().count());
    first.chars().take(length).collect()
}

impl PathField {
    /// The field with this text in it.
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }

    /// The field with a path that does not take the keyboard when it appears.
    pub fn waiting(text: impl Into<String>) -> Self {
        Self { is_focused: true, ..Self::new(text) }
    }

    /// Gives it the keyboard once more.
    pub fn focus(&mut self) {
        self.is_focused = false;
    }

    /// Shows the field, `width` wide; gives whether Enter was pressed in it.
    pub fn show(&mut self, ui: &mut Ui, name: &str, width: f32) -> bool {
        let id = Id::unique(("path", name));
        let had_focus = ui.memory(|memory| memory.has_focus(id));
        if !self.is_focused && !had_focus {
            widgets::catch_text(ui.ctx(), id, &mut self.text);
        }
        // A page has no folders in which paths could be looked up.
        let completes = !files::IN_PAGE && had_focus && !self.text.is_empty();
        if completes {
            self.take_tab(ui, id);
        }
        if self.receive(ui.ctx()) {
            to_end(ui.ctx(), id, &self.text);
        }
        let field = TextEdit::singleline(&mut self.text)
            .id(id)
            .hint_text(if files::IN_PAGE { "Type a name" } else { "Type or paste a path" })
            .desired_width(width);
        // Tab is the field's own while there is something to complete.
        let response = ui.add(field.lock_focus(completes)).accessible_name(name);
        // A click elsewhere takes it until the end of the frame.
        let has_kept_focus = had_focus && response.has_focus();
        if !self.is_focused {
            // After the field: in the dialog's first pass it cannot have focus.
            response.request_focus();
        }
        self.is_focused |= has_kept_focus;
        if self.text != self.completion.offered {
            self.completion.listed.clear();
        }
        response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter))
    }

    /// What Tab has found; empty where that is nothing.
    pub fn found(&self) -> &str {
        &self.completion.listed
    }

    /// What Tab has found, in a line below the field.
    pub fn show_found(&self, ui: &mut Ui) {
        if !self.completion.listed.is_empty() {
            ui.add(egui::Label::new(RichText::new(&self.completion.listed).small().weak()).wrap());
        }
    }

    /// Completes the path, takes the next name that fits, or leaves the field where nothing does.
    fn take_tab(&mut self, ui: &Ui, id: Id) {
        let (forward, back) = ui.input_mut(|input| {
            (input.consume_key(Modifiers::NONE, Key::Tab), input.consume_key(Modifiers::SHIFT, Key::Tab))
        });
        if !forward && !back {
            return;
        }
        let Completion { base, names, chosen, offered, listed, .. } = &mut self.completion;
        if self.text == *offered && names.len() > 1 {
            let next = match *chosen {
                None => 0,
                Some(now) if forward => (now + 1) % names.len(),
                Some(now) => (now + names.len() - 1) % names.len(),
            };
            *chosen = Some(next);
            self.text = format!("{base}{}", names[next]);
            offered.clone_from(&self.text);
            return to_end(ui.ctx(), id, &self.text);
        }
        let is_complete = names.len() == 1 && !offered.ends_with(std::path::is_separator);
        if self.text == *offered && (names.is_empty() && !listed.is_empty() || is_complete) {
            let way = if forward { FocusDirection::Next } else { FocusDirection::Previous };
            return ui.memory_mut(|memory| memory.move_focus(way));
        }
        self.look_up(ui.ctx().clone());
    }

    /// Has a task read the folder.
    fn look_up(&mut self, ctx: egui::Context) {
        let typed = Typed::of(&self.text);
        self.text = typed.text();
        let (sender, receiver) = channel();
        let wanted = typed.clone();
        let look = async move || {
            // The dialog may be closed by now.
            sender.send(names(&wanted)).ok();
            ctx.request_repaint();
        };
        // Without a task nothing is completed.
        if work::spawn("complete a path", look).is_ok() {
            self.completion = Completion { coming: Some((receiver, typed)), ..Completion::default() };
        }
    }

    /// Takes in the names that were found; gives whether they have changed the text.
    fn receive(&mut self, ctx: &egui::Context) -> bool {
        let Some((coming, typed)) = &self.completion.coming else { return false };
        let names = match coming.try_recv() {
            Ok(names) => names,
            Err(TryRecvError::Empty) => {
                ctx.request_repaint_after_secs(0.02);
                return false;
            }
            Err(TryRecvError::Disconnected) => Vec::new(),
        };
        let typed = typed.clone();
        self.completion.coming = None;
        if self.text != typed.text() {
            return false;
        }
        self.complete(&typed, names);
        true
    }

    /// Completes what was `typed` as far as all `names` that fit go, or by the first of them.
    fn complete(&mut self, typed: &Typed, names: Vec<String>) {
        let shared = common(&names);
        let (mut chosen, mut text) = (None, typed.text());
        if shared.len() > typed.start.len() {
            text = format!("{}{shared}", typed.base);
        } else if names.len() > 1 {
            (chosen, text) = (Some(0), format!("{}{}", typed.base, names[0]));
        }
        let listed = match names.as_slice() {
            [] if !files::is_dir(&typed.folder()) => format!("There is no folder {}.", widgets::elide(&typed.base, 60)),
            [] => format!("Nothing in this folder begins with {}.", widgets::elide(&typed.start, 40)),
            [_] => String::new(),
            all => {
                let more = if all.len() > MOST_LISTED {
                    format!(" and {} more", all.len() - MOST_LISTED)
                } else {
                    String::new()
                };
                let first: Vec<String> = all.iter().take(MOST_LISTED).map(|name| widgets::elide(name, 32)).collect();
                format!("{}{more}. Tab takes the next.", first.join(", "))
            }
        };
        self.text.clone_from(&text);
        self.completion = Completion { coming: None, base: typed.base.clone(), names, chosen, offered: text, listed };
    }
}

/// Puts the cursor behind the text of the field `id`.
pub(super) fn to_end(ctx: &egui::Context, id: Id, text: &str) {
    let mut state = egui::text_edit::TextEditState::load(ctx, id).unwrap_or_default();
    let end = CCursorRange::one(CCursor::new(text.chars().count()));
    state.cursor.set_char_range(Some(end));
    state.store(ctx, id);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_completed_as_far_as_all_names_go_and_then_by_each_in_turn() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["clip one.mp4", "clip two.mp4", ".clip", "other.gif"] {
            std::fs::write(folder.path().join(name), []).unwrap();
        }
        std::fs::create_dir(folder.path().join("frames")).unwrap();
        let base = format!("{}{MAIN_SEPARATOR}", folder.path().display());
        let mut field = PathField::default();
        let mut tab = |text: &str| {
            let typed = Typed::of(&format!("{base}{text}"));
            field.complete(&typed, names(&typed));
            (field.text.strip_prefix(&base).unwrap().to_owned(), field.completion.names.len())
        };
        assert_eq!(tab("cl"), ("clip ".into(), 2));
        assert_eq!(tab("clip "), ("clip one.mp4".into(), 2));
        assert_eq!(tab("fr"), (format!("frames{MAIN_SEPARATOR}"), 1));
        assert_eq!(tab("."), (".clip".into(), 1));
        assert_eq!(tab("nothing"), ("nothing".into(), 0));
        assert!(field.completion.listed.contains("begins with nothing"));
        let typed = Typed::of("/no/such/folder/x");
        field.complete(&typed, names(&typed));
        assert!(field.completion.listed.contains("no folder") && field.text == "/no/such/folder/x");
    }

    #[test]
    fn a_tilde_is_the_home_folder() {
        let Some(home) = files::home() else { return };
        let home = home.display().to_string();
        assert_eq!(Typed::of("~/cl").text(), format!("{}{MAIN_SEPARATOR}cl", home.trim_end_matches('/')));
        assert_eq!(Typed::of("a/~b").text(), "a/~b");
        assert_eq!(Typed::of("~name/b").text(), "~name/b");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn names_that_are_no_unicode_are_left_out() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(std::ffi::OsStr::from_bytes(b"caf\xE9.mp4")), []).unwrap();
        std::fs::write(folder.path().join("café.mp4"), []).unwrap();
        assert_eq!(names(&Typed::of(&format!("{}/caf", folder.path().display()))), ["café.mp4"]);
        assert_eq!(common(&["é1".into(), "éa".into()]), "é");
    }
}
