//! What a new user has tried of stepping, so that the hint beside the steps goes away by itself.

use motionscope_core::run::Direction;
use serde::{Deserialize, Serialize};

use crate::ui::app::commands::Command;

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
    /// Notes that `command` was executed.
    pub fn note(&mut self, command: Command) {
        let Some(way) = way(command).filter(|_| !self.is_over()) else { return };
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

/// The way in which a command steps.
fn way(command: Command) -> Option<Direction> {
    use Command as C;
    match command {
        C::Into | C::Over | C::Out | C::NextUnit => Some(Direction::Forward),
        C::IntoBack | C::OverBack | C::OutBack | C::PreviousUnit => Some(Direction::Back),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_there_and_one_back_are_enough_and_so_are_many() {
        let mut practice = Practice::default();
        [Command::Into, Command::Play, Command::Into].into_iter().for_each(|command| practice.note(command));
        assert!(!practice.is_over());
        let mut forward = practice;
        practice.note(Command::IntoBack);
        assert!(practice.is_over());
        (0..300).for_each(|_| forward.note(Command::NextUnit));
        assert!(forward.is_over());
    }
}
