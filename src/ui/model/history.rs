//! Undo and redo of a value; the changes of one gesture are one entry.

/// A value with its undo and redo stacks.
pub struct History<T> {
    now: T,
    past: Vec<T>,
    future: Vec<T>,
    /// The key of the current gesture; changes with the same key do not add an entry.
    gesture: Option<String>,
}

/// Largest number of undo entries.
const DEPTH: usize = 200;

impl<T: Clone + PartialEq> History<T> {
    /// Returns a value without history.
    pub fn new(now: T) -> Self {
        Self { now, past: Vec::new(), future: Vec::new(), gesture: None }
    }

    /// Returns the value.
    pub fn now(&self) -> &T {
        &self.now
    }

    /// Returns the value for a change that is not undoable.
    pub fn now_mut(&mut self) -> &mut T {
        &mut self.now
    }

    /// Changes the value; changes with the same `key` are one until [`History::settle`].
    pub fn change(&mut self, key: &str, next: T) {
        if next == self.now {
            return;
        }
        let before = std::mem::replace(&mut self.now, next);
        self.future.clear();
        if self.gesture.as_deref() != Some(key) {
            self.past.push(before);
            self.gesture = Some(key.to_owned());
        }
        if self.past.len() > DEPTH {
            self.past.remove(0);
        }
    }

    /// Ends the gesture: the next change is a new entry.
    pub fn settle(&mut self) {
        self.gesture = None;
    }

    /// Undoes the last change; returns whether there was one.
    pub fn undo(&mut self) -> bool {
        self.settle();
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.now, before));
        true
    }

    /// Redoes the change undone last; returns whether there was one.
    pub fn redo(&mut self) -> bool {
        self.settle();
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.now, after));
        true
    }

    /// Whether there is a change to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a change to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_is_one_change() {
        let mut history = History::new(16);
        for value in [17, 18, 19] {
            history.change("block", value);
        }
        history.settle();
        history.change("block", 20);
        assert!(history.undo() && *history.now() == 19);
        assert!(history.undo() && *history.now() == 16);
        assert!(!history.undo() && history.can_redo());
        assert!(history.redo() && history.redo() && *history.now() == 20);
        assert!(!history.redo());
    }

    #[test]
    fn a_new_change_forgets_the_future() {
        let mut history = History::new(1);
        history.change("a", 2);
        history.undo();
        history.change("a", 1);
        assert!(history.can_redo(), "no change is no change");
        history.change("a", 3);
        assert!(!history.can_redo() && history.can_undo());
    }
}
