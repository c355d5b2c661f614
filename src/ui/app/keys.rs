//! The keyboard, the clipboard and dropped files: what they ask for.

use std::collections::BTreeSet;

use eframe::egui::{self, Event, FocusDirection, Id, Key, Modifiers, Popup};

use super::given;
use crate::files::IN_PAGE;
use crate::ui::commands::{Action, Actions, Command, Situation};
use crate::ui::dialogs::typed;

/// The keys that are down, by where they lie on the keyboard.
///
/// A key may be released under another name than it was pressed under: `?` becomes `/` once Shift is up. By name, `?`
/// would count as held, and the next press as a repetition.
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

    /// Whether a key that was pressed was down already; `repeats` says so where its place is not known.
    fn press(&mut self, place: Option<Key>, repeats: bool) -> bool {
        place.map_or(repeats, |key| !self.0.insert(key))
    }
}

/// What Escape does, one thing at a press. What lies nearest to the person goes first: an open menu or tooltip, then a dialog,
/// neither of which gets here, then these in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Escape {
    /// Leaves the start page.
    StartPage,
    /// Cancels a long move or check.
    Stop,
    /// Cancels an export.
    Writing,
    /// No longer places anything on the picture.
    Placing,
    /// Lays the pen down.
    Pen,
    /// Takes the large pointer away.
    Pointer,
    /// Takes the magnifying glass away.
    Loupe,
    /// Closes the parameters where they take the room of other panes.
    Parameters,
    /// Gives the stage its place back.
    Chart,
    /// Lets the held pixel go.
    Pixel,
    /// Leaves the full screen for the class.
    Present,
    /// Leaves the lecture.
    Lecture,
    /// Goes on with one estimator alone.
    Lockstep,
}

impl Escape {
    const ORDER: [Escape; 13] = [
        Escape::StartPage,
        Escape::Stop,
        Escape::Writing,
        Escape::Placing,
        Escape::Pen,
        Escape::Pointer,
        Escape::Loupe,
        Escape::Parameters,
        Escape::Chart,
        Escape::Pixel,
        Escape::Present,
        Escape::Lecture,
        Escape::Lockstep,
    ];

    /// What it does just now, if anything.
    fn now(now: &Situation) -> Option<Self> {
        Self::ORDER.into_iter().find(|meaning| meaning.applies(now))
    }

    fn applies(self, now: &Situation) -> bool {
        match self {
            Self::StartPage => now.at_start_page,
            Self::Stop => Command::Stop.enabled(now),
            Self::Writing => now.is_writing,
            Self::Placing => now.is_placing,
            Self::Pen => now.is_drawing,
            Self::Loupe => now.has_loupe,
            Self::Pointer => now.is_pointing,
            Self::Present => now.is_presenting,
            Self::Pixel => now.holds_pixel,
            Self::Parameters => now.has_open_parameters,
            Self::Chart => now.has_enlarged,
            Self::Lecture => now.lecture,
            Self::Lockstep => now.in_lockstep,
        }
    }

    fn action(self) -> Action {
        match self {
            Self::StartPage => Action::Command(Command::StartPage),
            Self::Stop => Action::Command(Command::Stop),
            Self::Writing => Action::CancelWriting,
            Self::Placing => Action::Place(None),
            Self::Pen => Action::Command(Command::Pen),
            Self::Loupe => Action::Command(Command::Loupe),
            Self::Pointer => Action::Command(Command::Pointer),
            Self::Present => Action::Command(Command::Present),
            Self::Pixel => Action::Release,
            Self::Parameters => Action::Command(Command::ShowParameters),
            Self::Chart => Action::Command(Command::EnlargeChart),
            Self::Lecture => Action::Command(Command::Lecture),
            Self::Lockstep => Action::Command(Command::Lockstep),
        }
    }
}

/// What is typed behind the key that opens a field, before that is there.
struct TypeAhead {
    command: Command,
    /// The letter of that key, until it is typed: it is no part of the text.
    own: &'static str,
    typed: String,
    /// Whether Enter came behind it.
    is_entered: bool,
}

impl TypeAhead {
    /// The field that `command` opens, called by `key`, if it opens one that waits for text.
    fn of(command: Command, key: Key) -> Option<Self> {
        matches!(command, Command::Palette | Command::SearchText | Command::Estimators | Command::Open).then(|| Self {
            command,
            own: key.name(),
            typed: String::new(),
            is_entered: false,
        })
    }

    /// Takes out of `events` a key that opens a field, and what is typed behind it, where Escape came before it in the same frame:
    /// that closes what lies over the panes, which would not know the key.
    fn behind_escape(events: &mut Vec<Event>) -> Option<Self> {
        let (mut opening, mut escaped) = (None::<Self>, false);
        events.retain(|event| {
            if let Some(opening) = &mut opening {
                return opening.take(event);
            }
            let Event::Key { key, modifiers, pressed: true, .. } = event else { return true };
            if escaped {
                opening = Command::of_key(*key, *modifiers, false).and_then(|command| Self::of(command, *key));
            }
            escaped |= *key == Key::Escape;
            opening.is_none()
        });
        opening
    }

    /// Asks for what was typed, if anything was.
    fn ask(self, actions: &mut Actions) {
        if !self.typed.is_empty() {
            actions.ask(Action::Type(self.command, self.typed, self.is_entered));
        }
    }

    /// Takes what is typed; gives whether `event` is left to others.
    fn take(&mut self, event: &Event) -> bool {
        match event {
            Event::Text(text) if text.eq_ignore_ascii_case(std::mem::take(&mut self.own)) => {}
            Event::Text(text) => self.typed.push_str(text),
            Event::Paste(text) => self.typed.push_str(text.trim()),
            Event::Key { key: Key::Backspace, pressed: true, .. } => drop(self.typed.pop()),
            Event::Key { key: Key::Enter, pressed: true, .. } => self.is_entered = true,
            Event::Key { .. } => {}
            _ => return true,
        }
        false
    }
}

/// What a key does while a question is open: numbers count hands, with Shift they take them away, Enter reveals the result. The place
/// of the key counts: with Shift it has another name.
fn answer(key: Key, modifiers: Modifiers) -> Option<Action> {
    const DIGITS: [Key; 9] =
        [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];
    if modifiers.command || modifiers.alt {
        return None;
    }
    if key == Key::Enter {
        return Some(Action::Reveal);
    }
    DIGITS.iter().position(|digit| *digit == key).map(|index| Action::Vote(index, !modifiers.shift))
}

/// Takes what the window understands out of the input, before any widget sees it.
///
/// Keys win over the widget in focus unless text is being typed or something lies over the panes.
pub fn take(ctx: &egui::Context, overlaid: bool, now: &Situation, actions: &mut Actions) {
    let mut held: Held = ctx.data(|data| data.get_temp(Id::NULL)).unwrap_or_default();
    // Also while something lies over the panes: a key that opened it is let go there.
    held.follow(ctx);
    ctx.data_mut(|data| data.insert_temp(Id::NULL, held.clone()));
    if now.is_blank {
        let is_press = |event: &Event| {
            matches!(event, Event::Key { pressed: true, .. } | Event::PointerButton { pressed: true, .. })
        };
        // The key or click that shows the screen again does nothing else.
        let is_called = ctx.input_mut(|input| {
            let is_called = input.events.iter().any(is_press);
            input.events.clear();
            is_called
        });
        if is_called {
            actions.command(Command::Blank);
        }
        return;
    }
    let dropped = ctx.input(|i| i.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<_>>());
    if let Some(name) = given::clip_of(dropped) {
        actions.ask(Action::Open(name));
    }
    if overlaid || ctx.text_edit_focused() {
        let opening = ctx.input_mut(|input| TypeAhead::behind_escape(&mut input.events));
        if let Some(opening) = opening {
            actions.command(opening.command);
            opening.ask(actions);
        }
        return;
    }
    let popup = Popup::is_any_open(ctx);
    let (mut moved, mut opening, mut escaped) = (false, None::<TypeAhead>, false);
    ctx.input_mut(|input| {
        input.events.retain(|event| match event {
            _ if opening.is_some() => opening.as_mut().is_none_or(|opening| opening.take(event)),
            // An open menu closes first.
            Event::Key { key: Key::Escape, pressed: true, .. } if popup => true,
            Event::Key { key: Key::Escape, pressed: true, .. } => {
                // One press, or two in one slow frame, does one thing: what is next shows only in the next frame.
                if let Some(meaning) = Escape::now(now).filter(|_| !std::mem::replace(&mut escaped, true)) {
                    actions.ask(meaning.action());
                }
                false
            }
            Event::Key { key, physical_key, pressed: true, repeat, modifiers }
                if (now.is_asked || (now.is_answered || now.asks) && *key != Key::Enter)
                    && answer(physical_key.unwrap_or(*key), *modifiers).is_some() =>
            {
                let is_held = held.press(*physical_key, *repeat);
                let asked = answer(physical_key.unwrap_or(*key), *modifiers).filter(|_| !is_held);
                asked.into_iter().for_each(|action| actions.ask(action));
                false
            }
            Event::Key { key, physical_key, pressed: true, repeat, modifiers } => {
                let repeat = held.press(*physical_key, *repeat);
                if now.is_presenting && blanks(*key, *modifiers) {
                    if !repeat {
                        actions.command(Command::Blank);
                    }
                    return false;
                }
                if let Some(chart) = chart_of(*key, *modifiers, now) {
                    actions.ask(Action::Chart(chart));
                    return false;
                }
                let Some(command) = Command::of_key(*key, *modifiers, repeat) else {
                    // A key that would have called a command if it were not held is not the widget's either.
                    return !(repeat && Command::of_key(*key, *modifiers, false).is_some());
                };
                if now.at_start_page && !command.enabled(now) {
                    // Arrows and Space are the page's own.
                    return true;
                }
                moved |= matches!(key, Key::ArrowLeft | Key::ArrowRight);
                if command.enabled(now) {
                    opening = TypeAhead::of(command, *key);
                    actions.command(command);
                } else if command.why_disabled(now).is_some() {
                    actions.command(command);
                }
                false
            }
            Event::Paste(text) => {
                if let Some(path) = typed::parse(text).filter(|path| !IN_PAGE || typed::leads_somewhere(path)) {
                    actions.ask(Action::Open(path));
                }
                false
            }
            _ => true,
        });
    });
    if let Some(opening) = opening {
        opening.ask(actions);
    }
    ctx.data_mut(|data| data.insert_temp(Id::NULL, held));
    if moved {
        // egui has taken the arrow for a wish to move the focus.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
}

/// Whether a key blanks the full screen for the class: a presenter's clicker sends a full stop or B.
fn blanks(key: Key, modifiers: Modifiers) -> bool {
    matches!(key, Key::Period | Key::B) && modifiers.is_none()
}

/// The chart that a digit shows to the class, counted from 0: there are no views to choose there.
fn chart_of(key: Key, modifiers: Modifiers, now: &Situation) -> Option<usize> {
    const DIGITS: [Key; 5] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    let is_meant = now.is_presenting && now.has_charts && modifiers.is_none();
    DIGITS.iter().position(|digit| *digit == key).filter(|_| is_meant)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever is the case, one press undoes the first of it in this order, and nothing else.
    #[test]
    fn escape_has_one_meaning_at_a_time() {
        for bits in 0..1u32 << Escape::ORDER.len() {
            let is = |index: usize| bits >> index & 1 == 1;
            let mut now = Situation {
                at_start_page: is(0),
                playing: is(1),
                is_writing: is(2),
                is_placing: is(3),
                is_drawing: is(4),
                is_pointing: is(5),
                has_loupe: is(6),
                has_open_parameters: is(7),
                has_enlarged: is(8),
                holds_pixel: is(9),
                is_presenting: is(10),
                lecture: is(11),
                in_lockstep: is(12),
                ..Situation::default()
            };
            let expected: Vec<Escape> = Escape::ORDER
                .into_iter()
                .enumerate()
                .filter(|(index, _)| is(*index))
                .map(|(_, meaning)| meaning)
                .collect();
            let mut done = Vec::new();
            while let Some(meaning) = Escape::now(&now) {
                done.push(meaning);
                match meaning {
                    Escape::StartPage => now.at_start_page = false,
                    Escape::Stop => now.playing = false,
                    Escape::Writing => now.is_writing = false,
                    Escape::Placing => now.is_placing = false,
                    Escape::Pen => now.is_drawing = false,
                    Escape::Loupe => now.has_loupe = false,
                    Escape::Pointer => now.is_pointing = false,
                    Escape::Present => now.is_presenting = false,
                    Escape::Pixel => now.holds_pixel = false,
                    Escape::Parameters => now.has_open_parameters = false,
                    Escape::Chart => now.has_enlarged = false,
                    Escape::Lecture => now.lecture = false,
                    Escape::Lockstep => now.in_lockstep = false,
                }
            }
            assert_eq!(done, expected);
        }
    }

    #[test]
    fn a_key_behind_escape_opens_its_field_with_what_is_typed() {
        let key = |key, modifiers| Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
        let palette = key(Key::K, eframe::egui::Modifiers::COMMAND);
        let typed = || vec![palette.clone(), key(Key::M, Default::default()), Event::Text("m".into())];
        let mut events = [vec![key(Key::Escape, Default::default())], typed()].concat();
        let opening = TypeAhead::behind_escape(&mut events).expect("it opens");
        assert!(opening.command == Command::Palette && opening.typed == "m" && events.len() == 1);
        let mut events = typed();
        assert!(
            TypeAhead::behind_escape(&mut events).is_none() && events.len() == 3,
            "a field in focus keeps its keys"
        );
    }

    #[test]
    fn what_is_typed_behind_the_key_that_opens_a_field_goes_into_it() {
        let mut opening = TypeAhead::of(Command::Palette, Key::K).unwrap();
        let key = |key, pressed| Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Default::default(),
        };
        let events = [
            key(Key::P, true),
            Event::Text("p".into()),
            key(Key::P, false),
            Event::Text("yq".into()),
            key(Key::Backspace, true),
            key(Key::Enter, true),
        ];
        assert!(events.iter().all(|event| !opening.take(event)));
        assert!(opening.take(&Event::PointerGone));
        assert!(opening.typed == "py" && opening.is_entered);
        assert!(TypeAhead::of(Command::Play, Key::Space).is_none());
        let mut opening = TypeAhead::of(Command::Estimators, Key::A).expect("a field");
        for text in ["a", "a", "d"] {
            opening.take(&Event::Text(text.into()));
        }
        assert_eq!(opening.typed, "ad", "its own letter opens it");
    }
}
