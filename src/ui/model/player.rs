//! Playback of a run: the number of steps due, and the cursor they lead to.

use motionscope_core::run::{Cursor, Direction, Move};

/// The unit of playback speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Events: every candidate is shown.
    Events,
    /// Units: every block is shown when it is finished.
    Units,
    /// This many granularities coarser than a unit, such as warps and levels: each is shown once it is finished.
    Outer(usize),
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
pub const SPEEDS: [Speed; 16] = [
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
    speed(Pace::Outer(1), 1),
    speed(Pace::Outer(1), 3),
    speed(Pace::Outer(2), 1),
    speed(Pace::Outer(2), 3),
];

impl Speed {
    /// Whether an estimator with `granularities` has the stops of this speed: its outermost granularity is the whole run.
    pub fn is_of(self, granularities: usize) -> bool {
        self.index(granularities) > 0 || !matches!(self.pace, Pace::Outer(_))
    }

    /// Index of its granularity among so many.
    fn index(self, granularities: usize) -> usize {
        let outward = match self.pace {
            Pace::Events => 0,
            Pace::Units => 1,
            Pace::Outer(further) => 1 + further,
        };
        granularities.saturating_sub(1 + outward)
    }

    /// Returns the speed with the estimator's name of its granularity: `10 candidates/s`.
    pub fn text(self, granularities: &[&str]) -> String {
        let name = granularities.get(self.index(granularities.len())).copied().unwrap_or_default();
        let plural = if self.per_second == 1 { "" } else { "s" };
        format!("{} {name}{plural}/s", self.per_second)
    }
}

/// Plays a run.
#[derive(Clone, Copy, Debug)]
pub struct Player {
    /// Index into [`SPEEDS`].
    pub speed: usize,
    /// Which way it plays, if it does.
    playing: Option<Direction>,
    /// Steps due, with a fraction.
    due: f64,
}

impl Default for Player {
    fn default() -> Self {
        Self { speed: 3, playing: None, due: 0.0 }
    }
}

impl Player {
    /// Returns a paused player with speed number `speed`.
    pub fn at_speed(speed: usize) -> Self {
        Self { speed: speed.min(SPEEDS.len() - 1), ..Self::default() }
    }

    /// Whether it plays.
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }

    /// Whether it plays in the direction `way`.
    pub fn plays(&self, way: Direction) -> bool {
        self.playing == Some(way)
    }

    /// Starts playback in the direction `way`, with the first step at once.
    pub fn play(&mut self, way: Direction) {
        (self.playing, self.due) = (Some(way), 1.0);
    }

    /// Pauses playback.
    pub fn pause(&mut self) {
        self.playing = None;
    }

    /// Returns the speed for an estimator with `granularities`: by units where it has no stops of the chosen one.
    pub fn speed(&self, granularities: usize) -> Speed {
        let Speed { pace, per_second } = self.chosen();
        if self.chosen().is_of(granularities) { speed(pace, per_second) } else { speed(Pace::Units, per_second) }
    }

    fn chosen(&self) -> Speed {
        SPEEDS[self.speed.min(SPEEDS.len() - 1)]
    }

    /// Changes the speed by one level of those that an estimator with `granularities` has.
    pub fn shift(&mut self, up: bool, granularities: usize) {
        let has = |index: &usize| SPEEDS[*index].is_of(granularities);
        let now = SPEEDS.iter().position(|one| *one == self.speed(granularities)).unwrap_or(0);
        let next = if up { (now + 1..SPEEDS.len()).find(has) } else { (0..now).rev().find(has) };
        self.speed = next.unwrap_or(now);
    }

    /// Advances the clock by `seconds`.
    pub fn pass(&mut self, seconds: f64) {
        if self.is_playing() {
            let rate = f64::from(self.chosen().per_second);
            // What a slow machine cannot do in time is left out, not caught up with.
            self.due = (self.due + seconds * rate).min(rate.max(1.0) / 4.0 + 1.0);
        }
    }

    /// Returns the move that is due at `cursor` in a unit of `events` events of an estimator with `granularities`.
    pub fn due(&mut self, (cursor, events): (Cursor, usize), granularities: usize) -> Option<Move> {
        let way = self.playing?;
        let steps = self.due as usize;
        self.due -= steps as f64;
        let speed = self.speed(granularities);
        (steps > 0).then(|| match (speed.pace, way) {
            (Pace::Outer(_), way) => Move::Granularity(speed.index(granularities), way),
            (_, Direction::Forward) => Move::To(ahead(speed.pace == Pace::Events, (cursor, events), steps)),
            (_, Direction::Back) => Move::To(behind(speed.pace == Pace::Events, cursor, steps)),
        })
    }

    /// Returns the seconds until the next step is due.
    pub fn wait_secs(&self) -> f64 {
        ((1.0 - self.due) / f64::from(self.chosen().per_second)).max(0.0)
    }
}

/// Returns the cursor `steps` events or units further on, stopping at the end of every unit.
fn ahead(by_event: bool, (cursor, events): (Cursor, usize), steps: usize) -> Cursor {
    let Cursor { unit, event } = cursor;
    let left = events.saturating_sub(event);
    match by_event {
        true if steps <= left => Cursor { unit, event: event + steps },
        true if left > 0 => Cursor { unit, event: events },
        true => Cursor { unit: unit + 1, event: steps },
        false if left > 0 => Cursor { unit: unit + steps - 1, event: usize::MAX },
        false => Cursor { unit: unit + steps, event: usize::MAX },
    }
}

/// Returns the cursor `steps` events or units back, stopping at the first event and at the end of every unit.
fn behind(by_event: bool, cursor: Cursor, steps: usize) -> Cursor {
    let Cursor { unit, event } = cursor;
    let end_of = |unit| Cursor { unit, event: usize::MAX };
    match by_event {
        true if event > 1 => Cursor { unit, event: event.saturating_sub(steps).max(1) },
        true => unit.checked_sub(1).map_or(Cursor::default(), end_of),
        false => unit.checked_sub(steps).map_or(Cursor::default(), end_of),
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
            player.due((cursor, events), 3)
        };
        assert_eq!(pass(&mut player, 1.0, at(0, 0), 50), None);
        player.play(Direction::Forward);
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
        assert_eq!(ahead(false, (at(3, 2), 9), 1), at(3, usize::MAX));
        assert_eq!(ahead(false, (at(3, 9), 9), 2), at(5, usize::MAX));
    }

    #[test]
    fn backwards_the_same_steps_are_seen() {
        let at = |unit, event| Cursor { unit, event };
        let back = |cursor, steps| behind(true, cursor, steps);
        assert_eq!(back(at(2, 9), 1), at(2, 8));
        assert_eq!(back(at(2, 3), 5), at(2, 1), "the first event is seen");
        assert_eq!(back(at(2, 1), 1), at(1, usize::MAX), "and the end of the unit before");
        assert_eq!(back(at(0, 1), 1), at(0, 0));
        assert_eq!(behind(false, at(5, 2), 2), at(3, usize::MAX));
        assert_eq!(behind(false, at(1, 2), 2), at(0, 0));
        let mut player = Player { speed: 2, ..Player::default() };
        player.play(Direction::Back);
        assert!(player.plays(Direction::Back) && !player.plays(Direction::Forward));
        assert_eq!(player.due((at(1, 7), 9), 3), Some(Move::To(at(1, 6))));
    }

    #[test]
    fn time_lost_is_not_caught_up_with() {
        let mut player = Player { speed: 6, ..Player::default() };
        player.play(Direction::Forward);
        player.pass(60.0);
        let Some(Move::To(cursor)) = player.due((Cursor::default(), 100_000), 3) else { panic!("nothing is due") };
        assert!(cursor.event <= 252, "{cursor}");
    }

    #[test]
    fn speeds_are_named_after_the_granularities() {
        let search = ["pair", "block", "probe"];
        assert_eq!([SPEEDS[0], SPEEDS[9]].map(|speed| speed.text(&search)), ["1 probe/s", "10 blocks/s"]);
        let mut player = Player::default();
        (0..99).for_each(|_| player.shift(true, search.len()));
        assert_eq!(player.speed(search.len()), SPEEDS[11]);
    }

    #[test]
    fn a_method_with_levels_and_warps_is_played_by_them() {
        let method = ["pair", "level", "warp", "iteration", "step"];
        let mut player = Player::default();
        (0..99).for_each(|_| player.shift(true, method.len()));
        let text = |player: &Player| player.speed(method.len()).text(&method);
        assert_eq!(text(&player), "3 levels/s");
        player.play(Direction::Back);
        assert_eq!(player.due((Cursor::default(), 2), method.len()), Some(Move::Granularity(1, Direction::Back)));
        assert_eq!(player.speed(3).pace, Pace::Units, "a search has neither");
        let mut slower = player;
        slower.shift(false, 3);
        assert_eq!(slower.speed(3), SPEEDS[7], "one slower than 3 units");
        (0..2).for_each(|_| player.shift(false, method.len()));
        assert_eq!(text(&player), "3 warps/s");
    }
}
