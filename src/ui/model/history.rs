//! Undo and redo of one value; changes of one gesture count as one.

/// A value with its past and its future.
pub struct History<T> {
    now: T,
    past: Vec<T>,
    future: Vec<T>,
    /// What the gesture at work changes; the same key again does not make another entry.
    gesture: Option<String>,
}

/// Changes that are remembered.
const DEPTH: usize = 200;

impl<T: Clone + PartialEq> History<T> {
    /// A value without a past.
    pub fn new(now: T) -> Self {
        Self { now, past: Vec::new(), future: Vec::new(), gesture: None }
    }

    /// The value.
    pub fn now(&self) -> &T {
        &self.now
    }

    /// The value, to be changed in a way that is no change to take back.
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

    /// The gesture is over: the next change is another one.
    pub fn settle(&mut self) {
        self.gesture = None;
    }

    /// Takes the last change back; gives whether there was one.
    pub fn undo(&mut self) -> bool {
        self.settle();
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.now, before));
        true
    }

    /// Makes the change again that was taken back; gives whether there was one.
    pub fn redo(&mut self) -> bool {
        self.settle();
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.now, after));
        true
    }

    /// Whether there is a change to take back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a change to make again.
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
