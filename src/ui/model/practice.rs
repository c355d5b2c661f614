//! What a new user has tried of stepping, so that the hint beside the steps goes away by itself.

use motionscope_core::run::Direction;
use serde::{Deserialize, Serialize};

/// Steps after which nothing needs to be said, whichever way they went.
const MOST: u8 = 12;

/// The steps that were taken so far, as far as they count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Practice {
    forward: bool,
    back: bool,
    steps: u8,
}

impl Practice {
    /// Notes a step that way.
    pub fn note(&mut self, way: Direction) {
        if self.is_over() {
            return;
        }
        match way {
            Direction::Forward => self.forward = true,
            Direction::Back => self.back = true,
        }
        self.steps += 1;
    }

    /// Whether the way forward and back is known.
    pub fn is_over(&self) -> bool {
        self.forward && self.back || self.steps >= MOST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_there_and_one_back_are_enough_and_so_are_many() {
        let mut practice = Practice::default();
        [Direction::Forward; 2].into_iter().for_each(|way| practice.note(way));
        assert!(!practice.is_over());
        let mut forward = practice;
        practice.note(Direction::Back);
        assert!(practice.is_over());
        (0..300).for_each(|_| forward.note(Direction::Forward));
        assert!(forward.is_over());
    }
}
