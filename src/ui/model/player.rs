//! Playback of a run: the number of steps due, and the cursor they lead to.

use motionscope_core::{Cursor, Move};

/// The unit of playback speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Events: every candidate is shown.
    Events,
    /// Units: every block is shown when it is finished.
    Units,
}

/// A playback speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// The unit.
    pub pace: Pace,
    /// Steps per second.
    pub per_second: u32,
}

const fn speed(pace: Pace, per_second: u32) -> Speed {
    Speed { pace, per_second }
}

/// All speeds, from slow to fast.
pub const SPEEDS: [Speed; 12] = [
    speed(Pace::Events, 1),
    speed(Pace::Events, 3),
    speed(Pace::Events, 10),
    speed(Pace::Events, 30),
    speed(Pace::Events, 100),
    speed(Pace::Events, 300),
    speed(Pace::Events, 1000),
    speed(Pace::Units, 1),
    speed(Pace::Units, 3),
    speed(Pace::Units, 10),
    speed(Pace::Units, 30),
    speed(Pace::Units, 100),
];

impl Speed {
    /// Returns the speed with the estimator's names of event and unit: `10 candidates/s`.
    pub fn text(self, event: &str, unit: &str) -> String {
        let name = match self.pace {
            Pace::Events => event,
            Pace::Units => unit,
        };
        let plural = if self.per_second == 1 { "" } else { "s" };
        format!("{} {name}{plural}/s", self.per_second)
    }
}

/// Plays a run.
#[derive(Clone, Copy, Debug)]
pub struct Player {
    /// Index into [`SPEEDS`].
    pub speed: usize,
    playing: bool,
    /// Steps due, with a fraction.
    due: f64,
}

impl Default for Player {
    fn default() -> Self {
        Self { speed: 3, playing: false, due: 0.0 }
    }
}

impl Player {
    /// Returns a paused player with speed number `speed`.
    pub fn at_speed(speed: usize) -> Self {
        Self { speed: speed.min(SPEEDS.len() - 1), ..Self::default() }
    }

    /// Whether it plays.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Starts playback, with the first step at once.
    pub fn play(&mut self) {
        (self.playing, self.due) = (true, 1.0);
    }

    /// Pauses playback.
    pub fn pause(&mut self) {
        self.playing = false;
    }

    /// Returns the speed.
    pub fn speed(&self) -> Speed {
        SPEEDS[self.speed.min(SPEEDS.len() - 1)]
    }

    /// Changes the speed by one level.
    pub fn shift(&mut self, up: bool) {
        let next = if up { self.speed.saturating_add(1) } else { self.speed.saturating_sub(1) };
        self.speed = next.min(SPEEDS.len() - 1);
    }

    /// Advances the clock by `seconds`.
    pub fn pass(&mut self, seconds: f64) {
        if self.playing {
            let rate = f64::from(self.speed().per_second);
            // What a slow machine cannot do in time is left out, not caught up with.
            self.due = (self.due + seconds * rate).min(rate.max(1.0) / 4.0 + 1.0);
        }
    }

    /// Returns the move that is due at `cursor` in a unit of `events` events.
    pub fn due(&mut self, cursor: Cursor, events: usize) -> Option<Move> {
        if !self.playing {
            return None;
        }
        let steps = self.due as usize;
        self.due -= steps as f64;
        (steps > 0).then(|| Move::To(ahead(self.speed().pace, cursor, events, steps)))
    }

    /// Returns the seconds until the next step is due.
    pub fn wait_secs(&self) -> f64 {
        ((1.0 - self.due) / f64::from(self.speed().per_second)).max(0.0)
    }
}

/// Returns the cursor `steps` further on, stopping at the end of every unit.
fn ahead(pace: Pace, cursor: Cursor, events: usize, steps: usize) -> Cursor {
    let Cursor { unit, event } = cursor;
    let left = events.saturating_sub(event);
    match pace {
        Pace::Events if steps <= left => Cursor { unit, event: event + steps },
        Pace::Events if left > 0 => Cursor { unit, event: events },
        Pace::Events => Cursor { unit: unit + 1, event: steps },
        Pace::Units if left > 0 => Cursor { unit: unit + steps - 1, event: usize::MAX },
        Pace::Units => Cursor { unit: unit + steps, event: usize::MAX },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_seen_one_after_the_other() {
        let mut player = Player { speed: 2, ..Player::default() };
        let at = |unit, event| Cursor { unit, event };
        let pass = |player: &mut Player, seconds, cursor, events| {
            player.pass(seconds);
            player.due(cursor, events)
        };
        assert_eq!(pass(&mut player, 1.0, at(0, 0), 50), None);
        player.play();
        assert_eq!(pass(&mut player, 0.0, at(0, 0), 50), Some(Move::To(at(0, 1))));
        assert_eq!(pass(&mut player, 0.05, at(0, 1), 50), None);
        assert!((player.wait_secs() - 0.05).abs() < 1e-9);
        assert_eq!(pass(&mut player, 0.05, at(0, 1), 50), Some(Move::To(at(0, 2))));
        assert_eq!(pass(&mut player, 0.2, at(0, 49), 50), Some(Move::To(at(0, 50))), "the end of a unit is seen");
        assert_eq!(pass(&mut player, 0.1, at(0, 50), 50), Some(Move::To(at(1, 1))));
        player.pause();
        assert_eq!(pass(&mut player, 9.0, at(0, 50), 50), None);
    }

    #[test]
    fn units_are_counted_by_their_ends() {
        let at = |unit, event| Cursor { unit, event };
        assert_eq!(ahead(Pace::Units, at(3, 2), 9, 1), at(3, usize::MAX));
        assert_eq!(ahead(Pace::Units, at(3, 9), 9, 2), at(5, usize::MAX));
    }

    #[test]
    fn time_lost_is_not_caught_up_with() {
        let mut player = Player { speed: 6, ..Player::default() };
        player.play();
        player.pass(60.0);
        let Some(Move::To(cursor)) = player.due(Cursor::default(), 100_000) else { panic!("nothing is due") };
        assert!(cursor.event <= 252, "{cursor}");
    }

    #[test]
    fn speeds_are_named_after_the_granularities() {
        assert_eq!(SPEEDS[0].text("probe", "block"), "1 probe/s");
        assert_eq!(SPEEDS[9].text("probe", "block"), "10 blocks/s");
        let mut player = Player::default();
        (0..99).for_each(|_| player.shift(true));
        assert_eq!(player.speed(), SPEEDS[11]);
    }
}
