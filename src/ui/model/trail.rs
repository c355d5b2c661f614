//! The pages that links led away from, and the way back to them.

use motionscope_core::run::Cursor;

use crate::session::lesson::Address;

/// Pages that are remembered.
const MOST: usize = 32;

/// A page, and the step at which it was left.
#[derive(Clone, Debug, PartialEq)]
pub struct Left {
    /// The page.
    pub address: Address,
    /// The step, if it was one of the page.
    pub cursor: Option<Cursor>,
    /// The lesson and the page as they are shown: `Horn–Schunck, page 3`.
    pub title: String,
}

/// Pages in the order in which they were left.
#[derive(Clone, Debug, Default)]
pub struct Trail(Vec<Left>);

impl Trail {
    /// Notes a page that is left, as the last one. A page is there once: what was noted of it before is taken out, and its step is
    /// kept if it is left from another run this time.
    pub fn leave(&mut self, mut left: Left) {
        let before = self.0.iter().position(|other| other.address == left.address).map(|at| self.0.remove(at));
        left.cursor = left.cursor.or(before.and_then(|before| before.cursor));
        self.0.push(left);
        if self.0.len() > MOST {
            self.0.remove(0);
        }
    }

    /// The page that was left last.
    pub fn last(&self) -> Option<&Left> {
        self.0.last()
    }

    /// Takes the page that was left last.
    pub fn back(&mut self) -> Option<Left> {
        self.0.pop()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(page: usize) -> Left {
        Left { address: Address { lesson: "lesson:a".into(), page }, cursor: None, title: format!("A, page {page}") }
    }

    #[test]
    fn pages_come_back_in_the_order_in_which_they_were_left() {
        let mut trail = Trail::default();
        [1, 2, 3, 2].into_iter().for_each(|page| trail.leave(left(page)));
        assert_eq!(trail.last(), Some(&left(2)));
        let back: Vec<_> = std::iter::from_fn(|| trail.back()).map(|left| left.address.page).collect();
        assert_eq!(back, [2, 3, 1]);
        let cursor = Some(Cursor { unit: 3, event: 1 });
        trail.leave(Left { cursor, ..left(1) });
        trail.leave(left(1));
        assert_eq!((trail.back().and_then(|left| left.cursor), trail.last()), (cursor, None));
        (0..100).for_each(|page| trail.leave(left(page)));
        assert_eq!(std::iter::from_fn(|| trail.back()).count(), MOST);
    }
}
