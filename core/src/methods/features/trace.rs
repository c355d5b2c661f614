//! The tracking of one point through all levels, repeated to explain any point on demand.

use super::follow::{Event, Follow, LevelResult};
use super::level_trace::LevelTrace;
use super::tracker::Level;
use crate::scene::{Floor, Role};

/// The tracking of a point, repeated from the coarsest to the current level.
pub struct Trace<'a> {
    follow: Follow,
    pyramids: [&'a [Level]; 2],
    /// Its position in px of level 0.
    pub at: [f32; 2],
    /// Initial guess and events of the levels so far, the coarsest first.
    levels: Vec<([f32; 2], Vec<Event>)>,
}

impl<'a> Trace<'a> {
    /// Tracks the point at `at` down to the end of `level`.
    pub fn new(follow: Follow, pyramids: [&'a [Level]; 2], at: [f32; 2], level: usize) -> Self {
        let (mut levels, mut guess) = (Vec::new(), [0.0; 2]);
        for level in (level..pyramids[0].len()).rev() {
            let mut events = Vec::new();
            let followed = follow.on_level(pyramids, level, (at, guess), &mut events);
            levels.push((guess, events));
            if let LevelResult::Guess(finer) = followed {
                guess = finer;
            }
        }
        Self { follow, pyramids, at, levels }
    }

    /// Returns the trace with no more than `count` events on its last level.
    #[must_use]
    pub fn until(mut self, count: usize) -> Self {
        if let Some((_, events)) = self.levels.last_mut() {
            events.truncate(count);
        }
        self
    }

    /// Returns the current level.
    pub fn level(&self) -> usize {
        self.pyramids[0].len() - self.levels.len()
    }

    /// Returns the events of the current level.
    pub fn level_trace(&self) -> LevelTrace<'a> {
        self.level_trace_on(self.level())
    }

    fn level_trace_on(&self, level: usize) -> LevelTrace<'a> {
        let leg = self.levels.get(self.pyramids[0].len() - 1 - level);
        let (guess, events) = leg.cloned().unwrap_or_default();
        let Self { follow, pyramids, at, .. } = *self;
        LevelTrace { follow, pyramids, level, at, guess, events }
    }

    /// Returns window and displacement on every level.
    pub fn floors(&self) -> Vec<Floor> {
        let floor = |level: usize| {
            let (at, reach) = (self.at.map(|c| c / (1u32 << level) as f32), self.follow.reach as f32 + 0.5);
            let vector = (level >= self.level()).then(|| {
                let level_trace = self.level_trace_on(level);
                (level_trace.displacement(), if level_trace.is_done() { Role::Result } else { Role::Best })
            });
            Floor { at_hand: Some([at.map(|c| c - reach), at.map(|c| c + reach)]), vector }
        };
        (0..self.pyramids[0].len()).map(floor).collect()
    }
}
