//! Moves to the steps that the timeline marks.

use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::Role;
use web_time::Instant;

use super::{SLOW_AFTER, Worker};

/// The marks of the timeline that a move stops at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marks {
    /// All of them.
    All,
    /// Those of the same kind as the step at hand; all of them where it has no mark.
    Alike,
}

impl Marks {
    /// The only kind that a move from where `walk` stands stops at.
    fn kind_at(self, walk: &dyn Walk) -> Option<Role> {
        let here = walk.cursor().event;
        let of_step = || walk.landmarks().into_iter().find(|(event, _)| *event == here).map(|(_, role)| role);
        (self == Self::Alike).then(of_step).flatten()
    }
}

impl Worker<'_> {
    /// Goes to the next step in the direction `way` with one of the marks sought; where none is, to that end of the run.
    pub(super) async fn go_to_mark(&mut self, way: Direction, sought: Marks) {
        let kind = self.run.as_ref().and_then(|run| sought.kind_at(&*run.walk));
        let events = |walk: &dyn Walk| -> Vec<usize> {
            let marks = walk.landmarks().into_iter();
            marks.filter(|(_, role)| kind.is_none_or(|kind| *role == kind)).map(|(event, _)| event).collect()
        };
        let begun = Instant::now();
        loop {
            if begun.elapsed() > SLOW_AFTER && self.shared.superseded.is_set() {
                return;
            }
            let Some(run) = &self.run else { return };
            let (walk, here) = (&*run.walk, run.walk.cursor());
            let events_here = events(walk);
            let next = match way {
                Direction::Forward => events_here.iter().find(|event| **event > here.event),
                Direction::Back => events_here.iter().rev().find(|event| **event < here.event),
            };
            if let Some(event) = next {
                return self.go(Move::To(Cursor { unit: here.unit, event: *event })).await;
            }
            // A unit is entered at the side that it is searched from.
            let to = match way {
                Direction::Forward if walk.at_end() => return self.publish(),
                Direction::Forward => Cursor { unit: here.unit + 1, event: 1 },
                Direction::Back if here.unit == 0 => return self.go(Move::To(Cursor::default())).await,
                Direction::Back => Cursor { unit: here.unit - 1, event: usize::MAX },
            };
            if !self.travel(Move::To(to)).await {
                return;
            }
            let Some(run) = &self.run else { return };
            let now = run.walk.cursor();
            let is_marked = events(&*run.walk).contains(&now.event);
            if is_marked || now.unit == here.unit {
                return self.go(if is_marked { Move::To(now) } else { Move::End }).await;
            }
        }
    }
}
