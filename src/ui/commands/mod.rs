//! The commands of the window, declared once in a table, and the actions that panes and dialogs request.
//!
//! Menus, toolbar, tooltips, the palette, the shortcut sheet and the keyboard all read [`Command::entry`].

mod action;
mod granularities;
mod keys;
mod menu;
mod order;
mod situation;
mod table;

use eframe::egui::KeyboardShortcut;
use lucide_icons::Icon;
use motionscope_core::params::Params;
use motionscope_core::run::Direction;

pub use action::{Action, Actions, Browse, Owner, PenWish, Side};
pub use granularities::Granularities;
pub use keys::{PANE_KEY, is_of_browser, key_text};
pub use menu::{Menu, Submenu};
pub use order::{CLIP_FRAME, ClipFormat, Order, OutputKind};
pub use situation::Situation;
pub use table::Command;

use crate::files::IN_PAGE;

/// How a command is shown, called and found, and when it can be executed.
#[derive(Clone, Copy)]
pub struct Entry {
    /// The menu that it lies in.
    pub menu: Menu,
    /// The menu within its menu that it lies in.
    pub submenu: Option<Submenu>,
    /// The section of its menu: commands of the same number stand together, between two lines.
    pub section: u8,
    /// Its icon, where it has a button or a line in a menu.
    pub icon: Icon,
    /// Its name; `{into}`, `{over}` and `{out}` stand for the estimator's granularities.
    pub text: &'static str,
    /// What it does, in one sentence.
    pub tip: &'static str,
    /// Words that people look for and that no name has.
    pub tags: &'static str,
    /// The keys that call it, the one to show first.
    pub keys: &'static [KeyboardShortcut],
    /// The keys that call it in a page of a browser, where the others are the browser's.
    pub in_page: Option<&'static [KeyboardShortcut]>,
    /// Whether holding its key down repeats it.
    pub repeats: bool,
    /// The way in which it steps through the run.
    pub way: Option<Direction>,
    /// The entry of the look that it sets, by its name, and the value that it gives to it.
    pub sets: Option<(&'static str, &'static str)>,
    /// Whether what it toggles is on.
    pub is_on: Option<fn(&Situation) -> bool>,
    /// Whether it makes sense just now; of a layer, [`Command::enabled`] asks more.
    pub enabled: fn(&Situation) -> bool,
    /// What is said when its key is pressed while it is not enabled, where nothing on the screen says why.
    pub why_not: fn(&Situation) -> Option<&'static str>,
}

impl Entry {
    /// An entry of `menu` that is always enabled.
    const fn of(menu: Menu) -> Self {
        Self {
            menu,
            submenu: None,
            section: 0,
            icon: Icon::Dot,
            text: "",
            tip: "",
            tags: "",
            keys: &[],
            in_page: None,
            repeats: false,
            way: None,
            sets: None,
            is_on: None,
            enabled: |_| true,
            why_not: |_| None,
        }
    }

    /// The keys that call it in a page of a browser.
    pub fn keys_in_page(&self) -> &'static [KeyboardShortcut] {
        self.in_page.unwrap_or(self.keys)
    }

    /// The entry with the keys of this edition of the program.
    fn here(self) -> Self {
        let keys = if IN_PAGE { self.keys_in_page() } else { self.keys };
        Self { keys, ..self }
    }
}

impl Command {
    /// Its name, with the estimator's own names for the granularities of the ladder.
    pub fn text(self, granularities: &Granularities) -> String {
        granularities.fill(self.entry().text)
    }

    /// What it does, with the estimator's own names for the granularities of the ladder.
    pub fn tip(self, granularities: &Granularities) -> String {
        granularities.fill(self.entry().tip)
    }

    /// The key that calls it, in words; nothing if there is none.
    pub fn key(self) -> String {
        self.entry().keys.first().map_or_else(String::new, |key| key_text(*key))
    }

    /// `tip` with the key that calls the command below it.
    pub fn with_key(self, tip: &str) -> String {
        match self.key() {
            key if key.is_empty() => tip.to_owned(),
            key => format!("{tip}\n{key}"),
        }
    }

    /// Every key that does the same, the one to show first.
    pub fn keys(self, granularities: &Granularities) -> Vec<KeyboardShortcut> {
        let twin = match self {
            Command::Start => Command::OutBack,
            Command::End => Command::Out,
            _ => self,
        };
        let others = if twin.is_listed(granularities) { &[] } else { twin.entry().keys };
        [self.entry().keys, others].concat()
    }

    /// Whether this edition has it: a page has no paths, and its tab is closed by the browser.
    pub fn is_offered(self) -> bool {
        !(IN_PAGE && matches!(self, Command::PastePath | Command::Quit))
    }

    /// Whether it is shown beside the others: out of the outermost granularity is the end of the run, which is there already.
    pub fn is_listed(self, granularities: &Granularities) -> bool {
        self.is_offered() && !(matches!(self, Command::Out | Command::OutBack) && granularities.group() == 0)
    }

    /// What is said when it is called by its key and is not enabled, where nothing on the screen says why.
    pub fn why_disabled(self, now: &Situation) -> Option<&'static str> {
        (self.entry().why_not)(now)
    }

    /// Whether it makes sense just now.
    pub fn enabled(self, now: &Situation) -> bool {
        let is_there = match self {
            Command::Layer(layer) => now.available.why_never(layer).is_none(),
            _ => true,
        };
        is_there && self.is_offered() && (self.entry().enabled)(now)
    }

    /// Whether what it toggles or sets is so already; `None` if it does neither.
    pub fn is_on(self, now: &Situation) -> Option<bool> {
        if let Command::Layer(layer) = self {
            return Some(layer == now.available.chosen(now.look.layer));
        }
        let Entry { is_on, sets, .. } = self.entry();
        let is_set = || sets.and_then(|(name, value)| Some(now.look.get(name).ok()?.to_string() == value));
        is_on.map(|is_on| is_on(now)).or_else(is_set)
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers};

    use super::*;
    use crate::view::look::Look;

    #[test]
    fn no_two_commands_share_a_key() {
        let keys = |c: &Command| c.entry().keys.iter().map(|k| (*k, *c)).collect::<Vec<_>>();
        let all: Vec<_> = Command::ALL.iter().flat_map(keys).collect();
        for (shortcut, command) in &all {
            assert_eq!(Command::of_key(shortcut.logical_key, shortcut.modifiers, false), Some(*command));
        }
    }

    #[test]
    fn the_keys_of_a_page_are_not_those_of_the_browser() {
        let keys =
            |command: &Command| command.entry().keys_in_page().iter().map(|key| (*key, *command)).collect::<Vec<_>>();
        let all: Vec<_> = Command::ALL.iter().flat_map(keys).collect();
        for (index, (shortcut, command)) in all.iter().enumerate() {
            assert!(!is_of_browser(*shortcut), "{command:?}: {}", key_text(*shortcut));
            let twin = all[..index].iter().find(|(other, _)| other == shortcut);
            assert!(twin.is_none(), "{command:?} and {twin:?}: {}", key_text(*shortcut));
        }
        let moved: Vec<_> = Command::ALL.iter().filter(|command| command.entry().in_page.is_some()).collect();
        let is_needless = |command: &&&Command| !command.entry().keys.iter().any(|key| is_of_browser(*key));
        assert_eq!(moved.iter().find(is_needless), None, "its own key is free in a page");
    }

    #[test]
    fn every_command_is_named_and_explained() {
        let granularities = Granularities::new(&["frame", "block", "probe"]);
        let mut names: Vec<_> = Command::ALL.iter().map(|c| c.text(&granularities)).collect();
        assert!(names.iter().all(|name| !name.contains('{')) && names.contains(&"Next probe".to_owned()));
        names.sort();
        names.dedup();
        assert_eq!(names.len(), Command::ALL.len());
        assert!(Command::ALL.iter().all(|c| c.tip(&granularities).ends_with('.')));
        let is_blank = |entry: &Entry| entry.text.is_empty() || matches!(entry.icon, Icon::Dot);
        let blank: Vec<_> = Command::ALL.iter().filter(|command| is_blank(&command.entry())).collect();
        assert!(blank.is_empty(), "an entry of the table without text or icon: {blank:?}");
    }

    #[test]
    fn what_a_command_sets_is_an_entry_of_the_look() {
        let sets: Vec<_> = Command::ALL.iter().filter_map(|command| command.entry().sets).collect();
        for (name, value) in &sets {
            let mut look = Look::default();
            look.set(name, value).unwrap();
            assert_eq!(look.get(name).unwrap().to_string(), *value);
        }
        assert!(sets.len() > 20, "{}", sets.len());
    }

    #[test]
    fn a_short_ladder_lists_the_end_of_the_run_once() {
        let (long, short) = (
            Granularities::new(&["frame", "level", "block", "probe"]),
            Granularities::new(&["frame", "block", "probe"]),
        );
        assert!(Command::Out.is_listed(&long) && !Command::Out.is_listed(&short));
        let keys = |granularities| Command::End.keys(granularities).into_iter().map(key_text).collect::<Vec<_>>();
        assert_eq!((keys(&long), keys(&short)), (vec!["End".to_owned()], vec!["End".to_owned(), "U".to_owned()]));
    }

    #[test]
    fn a_held_key_steps_on_but_does_not_toggle() {
        assert_eq!(Command::of_key(Key::ArrowRight, Modifiers::NONE, true), Some(Command::Into));
        assert_eq!(Command::of_key(Key::Space, Modifiers::NONE, true), None);
        assert_eq!(Command::of_key(Key::Questionmark, Modifiers::SHIFT, false), Some(Command::Shortcuts));
    }
}
