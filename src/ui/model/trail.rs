//! The pages that links led away from, and the way back to them.

use motionscope_core::Cursor;

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
    /// Notes a page that is left; one that is left twice in a row is there once.
    pub fn leave(&mut self, left: Left) {
        self.0.retain(|other| other.address != left.address);
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
        (0..100).for_each(|page| trail.leave(left(page)));
        assert_eq!(std::iter::from_fn(|| trail.back()).count(), MOST);
    }
}
