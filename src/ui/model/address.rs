//! The address of the page and its history: which changes of what is shown are steps for the back button.

/// How what is shown is written into the history of the browser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// As a new entry, from which the back button leads to the one before.
    New,
    /// In place of the last one.
    Same,
}

/// The address of a page of a browser.
pub trait AddressBar {
    /// The address before the `#`.
    fn base(&self) -> String;
    /// The part behind the `#`; empty if there is none.
    fn fragment(&self) -> String;
    /// Writes the part behind the `#`; returns whether the browser takes it.
    fn write(&mut self, fragment: &str, entry: Entry) -> bool;
}

/// The time between two entries in seconds: browsers refuse more than 100 in half a minute.
const REST_SECS: f64 = 0.4;

/// The last entry that was written, and the page or clip that it is of.
#[derive(Debug)]
pub struct History {
    /// The part behind the `#` that was read or written last.
    fragment: String,
    /// The page or clip that was open then; none before the first time.
    place: Option<String>,
    /// Whether the next page or clip is opened because the address changed.
    is_led: bool,
    /// When it was last compared with what is shown.
    at: f64,
}

impl History {
    /// A page that was opened with this part behind the `#`.
    pub fn at(fragment: String) -> Self {
        Self { fragment, place: None, is_led: true, at: f64::NEG_INFINITY }
    }

    /// Notes the part behind the `#` as it is; gives whether the person, a link or the back button has changed it.
    pub fn is_changed(&mut self, fragment: &str) -> bool {
        let is_changed = self.fragment != fragment;
        if is_changed {
            (self.fragment, self.is_led) = (fragment.to_owned(), true);
        }
        is_changed
    }

    /// Notes that the browser has refused what was to be written: the address still has this part behind the `#`.
    pub fn stays_at(&mut self, fragment: String) {
        self.fragment = fragment;
    }

    /// The seconds until the next entry can be written, if it is too early at the time `now`.
    pub fn wait(&self, now: f64) -> Option<f32> {
        let wait = self.at + REST_SECS - now;
        (wait > 0.0).then_some(wait as f32)
    }

    /// Notes that `place` is open with this `fragment` at the time `now`; gives how that is written, unless it stands there already.
    pub fn note(&mut self, place: String, fragment: &str, now: f64) -> Option<Entry> {
        self.at = now;
        let is_led = std::mem::take(&mut self.is_led);
        let is_same = self.place.replace(place.clone()).is_none_or(|before| before == place);
        if self.fragment == fragment {
            return None;
        }
        fragment.clone_into(&mut self.fragment);
        Some(if is_led || is_same { Entry::Same } else { Entry::New })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_and_clips_are_entries_and_steps_are_not() {
        let mut history = History::at(String::new());
        let mut note = |place: &str, fragment: &str| history.note(place.into(), fragment, 0.0);
        assert_eq!(note("", ""), None, "the start page");
        assert_eq!(note("lesson 1", "lesson:x/1"), Some(Entry::New));
        assert_eq!(note("lesson 1", "lesson:x/1&step=1.2"), Some(Entry::Same));
        assert_eq!(note("lesson 1", "lesson:x/1&step=1.2"), None);
        assert_eq!(note("lesson 2", "lesson:x/2"), Some(Entry::New));
        assert!(history.is_changed("lesson:x/1&step=1.2"), "the back button");
        assert_eq!(history.note("lesson 1".into(), "lesson:x/1&step=1.2", 0.0), None);
        assert_eq!(history.note("lesson 2".into(), "lesson:x/2", 0.0), Some(Entry::New), "and on again");
        assert!(history.is_changed("lesson:x/1&set.alpha=0008"), "typed");
        assert_eq!(history.note("lesson 1".into(), "lesson:x/1&set.alpha=8", 0.0), Some(Entry::Same));
        assert!(!history.is_changed("lesson:x/1&set.alpha=8"));
    }

    #[test]
    fn entries_are_few() {
        let mut history = History::at(String::new());
        assert_eq!(history.wait(0.0), None);
        history.note("clip".into(), "a", 10.0);
        assert!(history.wait(10.1).is_some_and(|wait| wait > 0.2) && history.wait(10.5).is_none());
    }
}
