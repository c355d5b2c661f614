//! The way of one point through the levels, so that any point can be explained whenever somebody points at it.

use super::LevelTrace;
use super::follow::{Event, Follow, LevelResult};
use super::tracker::Level;
use crate::scene::{Floor, Role};

/// A point that is followed once more, from the coarsest level to where it is by now.
pub struct Trace<'a> {
    follow: Follow,
    pyramids: [&'a [Level]; 2],
    /// Its place in px of the picture.
    pub at: [f32; 2],
    /// The levels that it has seen, the coarsest first: with what each began, and what happened there.
    legs: Vec<([f32; 2], Vec<Event>)>,
}

impl<'a> Trace<'a> {
    /// The way of the point at `at` down to `level`, to the end of that.
    pub fn new(follow: Follow, pyramids: [&'a [Level]; 2], at: [f32; 2], level: usize) -> Self {
        let (mut legs, mut guess) = (Vec::new(), [0.0; 2]);
        for level in (level..pyramids[0].len()).rev() {
            let mut events = Vec::new();
            let followed = follow.on_level(pyramids, level, (at, guess), &mut events);
            legs.push((guess, events));
            if let LevelResult::Guess(finer) = followed {
                guess = finer;
            }
        }
        Self { follow, pyramids, at, legs }
    }

    /// The same as long as no more than `count` events of its last level have happened.
    #[must_use]
    pub fn until(mut self, count: usize) -> Self {
        if let Some((_, events)) = self.legs.last_mut() {
            events.truncate(count);
        }
        self
    }

    /// The level at hand.
    pub fn level(&self) -> usize {
        self.pyramids[0].len() - self.legs.len()
    }

    /// The last event.
    pub fn last(&self) -> Option<&Event> {
        self.legs.last()?.1.last()
    }

    /// What has happened on the level at hand; the point is called `name`.
    pub fn level_trace(&self, name: String) -> LevelTrace<'a> {
        self.level_trace_on(self.level(), name)
    }

    fn level_trace_on(&self, level: usize, name: String) -> LevelTrace<'a> {
        let leg = self.legs.get(self.pyramids[0].len() - 1 - level);
        let (guess, events) = leg.cloned().unwrap_or_default();
        let Self { follow, pyramids, at, .. } = *self;
        LevelTrace { follow, pyramids, level, at, guess, events, name }
    }

    /// Its window on every level, and where it has led there.
    pub fn floors(&self) -> Vec<Floor> {
        let floor = |level: usize| {
            let (at, reach) = (self.at.map(|c| c / (1u32 << level) as f32), self.follow.reach as f32 + 0.5);
            let vector = (level >= self.level()).then(|| {
                let level_trace = self.level_trace_on(level, String::new());
                let is_over = matches!(level_trace.events.last(), Some(Event::Handed(..) | Event::End(..)));
                (level_trace.displacement(), if is_over { Role::Result } else { Role::Best })
            });
            Floor { at_hand: Some([at.map(|c| c - reach), at.map(|c| c + reach)]), vector }
        };
        (0..self.pyramids[0].len()).map(floor).collect()
    }
}
