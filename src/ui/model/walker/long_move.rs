//! The way of a move, which is gone in parts if it is long, so that what was found so far can be seen.

use motionscope_core::run::{Cursor, Direction, Move};
use web_time::{Duration, Instant};

use super::run::Run;

/// How often a long move shows how far it has come: at least ten times a second where showing takes at most half of that.
const SIGHT: Duration = Duration::from_millis(90);

/// How many times longer a part of a move may be than the part before.
const MOST_LONGER: f64 = 4.0;

/// A move on its way.
pub(super) struct LongMove {
    to: Move,
    /// When it was asked for.
    pub begun: Instant,
    /// Where the part at work leads.
    pub next: Move,
    /// Where the move leads, if it goes forward over several units.
    pub goal: Option<Cursor>,
    /// The unit where it began, and the last one of the way if that is known.
    from: usize,
    last: Option<usize>,
    /// Where the last part ended, and when, and how many units that took.
    at: Cursor,
    pace: Option<(usize, Duration)>,
    /// Whether it is gone in parts.
    is_long: bool,
}

impl LongMove {
    /// The way of `run` when it is asked to go `to` somewhere.
    pub fn new(run: &Run, to: Move) -> Self {
        let (at, units) = (run.walk.cursor(), run.walk.units());
        let end = Cursor { unit: usize::MAX, event: usize::MAX };
        let goal = match to {
            Move::To(cursor) => Some(cursor),
            Move::End | Move::Granularity(0, Direction::Forward) => Some(end),
            Move::Granularity(..) => None,
        };
        // Several in lockstep count their work otherwise.
        let goal = goal.filter(|goal| goal.unit > at.unit && run.subject.experiment.side_by_side.is_empty());
        let last = goal.and_then(|goal| units.map(|units| goal.unit.min(units.saturating_sub(1))));
        let last = last.or(goal.map(|goal| goal.unit).filter(|unit| *unit < usize::MAX));
        Self { to, begun: Instant::now(), next: to, goal, from: at.unit, last, at, pace: None, is_long: false }
    }

    /// Whether the whole way is gone where a part of it ended after `took`.
    pub fn comes_to(&mut self, at: Cursor, at_end: bool, took: Duration) -> bool {
        let is_part = self.next != self.to;
        self.pace = Some((at.unit.saturating_sub(self.at.unit), took));
        self.at = at;
        !is_part || at_end
    }

    /// Units done of those that the whole way takes, where that can be told.
    pub fn progress(&self, part: Option<(usize, usize)>) -> Option<(usize, usize)> {
        let (Some(last), Some(_)) = (self.last, self.goal) else { return part };
        // Whatever a part leaves out is done already.
        let to = match self.next {
            Move::To(cursor) => cursor.unit.min(last),
            _ => last,
        };
        let (done, of) = part.unwrap_or((0, to.saturating_sub(self.at.unit)));
        let reached = to.saturating_sub(of) + done;
        (last > self.from).then(|| (reached.saturating_sub(self.from), last - self.from))
    }

    /// Units done of those that the whole way takes when a part has ended, where that can be told.
    pub fn reached(&self) -> Option<(usize, usize)> {
        let last = self.last.filter(|last| self.goal.is_some() && *last > self.from)?;
        Some((self.at.unit.min(last).saturating_sub(self.from), last - self.from))
    }

    /// Where the first part of a way that turns out to be long ends: at the unit that is reached.
    pub fn breaks_off(&mut self, took: Duration, part: Option<(usize, usize)>) -> Option<Move> {
        if self.is_long || self.goal.is_none() || took < SIGHT {
            return None;
        }
        let done = match self.progress(part) {
            Some((done, of)) => (1..of).contains(&done).then_some(done)?,
            // Neither the length of the run nor its position is known: the first unit tells how fast it goes.
            None => 1,
        };
        self.is_long = true;
        self.next = Move::To(Cursor { unit: self.from + done, event: usize::MAX });
        Some(self.next)
    }

    /// The part after one that was shown within `took`: as far as can be gone until it is time to show something again.
    pub fn go_on(&mut self, took: Duration) {
        let (units, spent) = self.pace.unwrap_or_default();
        let work = SIGHT.saturating_sub(took).max(took);
        // A part whose units were at hand tells little about those that follow.
        let share = (work.as_secs_f64() / spent.as_secs_f64().max(1e-3)).min(MOST_LONGER);
        let unit = self.at.unit + ((units as f64 * share) as usize).max(1);
        let is_last = self.last.is_some_and(|last| unit >= last);
        self.next = if is_last { self.to } else { Move::To(Cursor { unit, event: usize::MAX }) };
    }
}
