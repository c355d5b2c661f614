//! Estimators in lockstep from stop to stop of a granularity: a frame, an iteration, a level, or the whole run.
//!
//! Where a stop is a unit of every run, its events are stepped as well: those of a named stage side by side, others one by one.
//!
//! ```text
//! running average   compare  decide           open  close  label ...
//! mixture           compare  decide  shadows  open  close  label ...      the first waits while the second removes shadows
//! ```

use super::{Pace, Stride, goal, in_frame_t, names, of_member};
use crate::base::Error;
use crate::data::Clip;
use crate::products::Output;
use crate::run::{AnyEstimator, Beside, Cursor, Direction, Explained, Granularity, Info, Move, Walk};
use crate::scene::{Focus, Name, Picture, Readout, Role, Scene, Step};

struct Member {
    walk: Box<dyn Walk>,
    names: [String; 2],
    stride: Stride,
    /// The stops that are known so far, where they are ends of groups.
    ends: Vec<Cursor>,
    /// Whether these are all.
    is_explored: bool,
    /// Its event at each event of the current stop, if events are stepped; none if its run ended before.
    events: Vec<usize>,
}

impl Member {
    /// The stop that it has reached.
    fn stop(&self) -> usize {
        match self.stride {
            Stride::Unit => self.walk.cursor().unit,
            Stride::Group(_) => self.ends.partition_point(|end| *end < self.walk.cursor()),
            Stride::Run => 0,
        }
    }

    /// The number of stops, if known.
    fn stops(&self) -> Option<usize> {
        match self.stride {
            Stride::Unit => self.walk.units(),
            Stride::Group(_) => self.is_explored.then_some(self.ends.len()),
            Stride::Run => Some(1),
        }
    }

    /// The next move towards the end of a stop, or of the run if that ends before; `None` once it is there.
    fn towards(&self, stop: usize) -> Option<Move> {
        let cursor = self.walk.cursor();
        let to = |goal: Cursor| (cursor != goal).then_some(Move::To(goal));
        match self.stride {
            Stride::Run => (!self.walk.at_end()).then_some(Move::End),
            Stride::Unit if self.walk.at_end() && cursor.unit <= stop => None,
            Stride::Unit if cursor.unit == stop && cursor.event == self.walk.events() => None,
            Stride::Unit if stop == usize::MAX => Some(Move::End),
            Stride::Unit => Some(Move::To(Cursor { unit: stop, event: usize::MAX })),
            Stride::Group(granularity) => match (self.ends.get(stop), self.ends.last()) {
                (Some(end), _) => to(*end),
                (None, Some(last)) if self.is_explored => to(*last),
                (None, last) => Some(
                    to(last.copied().unwrap_or_default()).unwrap_or(Move::Granularity(granularity, Direction::Forward)),
                ),
            },
        }
    }

    /// Notes where a move has led.
    fn note(&mut self, made: Move) {
        if let (Stride::Group(_), Move::Granularity(..)) = (self.stride, made) {
            let cursor = self.walk.cursor();
            if self.ends.last() != Some(&cursor) {
                self.ends.push(cursor);
            }
            self.is_explored = self.walk.at_end();
        }
    }

    /// The move from the end of a stop to event `event` of it; `None` if it stands there.
    fn within(&self, event: usize) -> Option<Move> {
        let event = *self.events.get(event.checked_sub(1)?)?;
        let goal = Cursor { event, ..self.walk.cursor() };
        (goal != self.walk.cursor()).then_some(Move::To(goal))
    }
}

/// The parts of a move.
#[derive(Clone, Copy, PartialEq)]
enum Phase {
    /// Every member goes to the end of the stop.
    Reach,
    /// Every member goes to its event.
    Within,
}

/// An unfinished move.
struct PendingMove {
    goal: Cursor,
    phase: Phase,
    /// The member that moves.
    member: usize,
    /// The move that it makes, and from where.
    asked: Option<(Move, Cursor)>,
}

/// A run of several estimators at once, which is walked through like that of one. A unit is a stop that all have in common; a
/// member whose run is over waits.
pub(super) struct Stops {
    members: Vec<Member>,
    pace: Pace,
    cursor: Cursor,
    /// Events of the current stop.
    events: usize,
    pending: Option<PendingMove>,
}

impl Stops {
    /// The runs of `estimators` on `frame`, at their start.
    ///
    /// # Errors
    /// If one of them cannot run there.
    pub(super) fn new(
        estimators: &[&dyn AnyEstimator],
        pace: Pace,
        (clip, frame): (&Clip, usize),
    ) -> Result<Self, Error> {
        let member = |(estimator, names): (&&dyn AnyEstimator, [String; 2])| {
            let walk = estimator.walk(clip, frame).map_err(|error| of_member(*estimator, &error))?;
            let stride = pace.stride(*estimator).unwrap_or(Stride::Run);
            Ok(Member { walk, names, stride, ends: Vec::new(), is_explored: false, events: Vec::new() })
        };
        let members = estimators.iter().zip(names(estimators)).map(member).collect::<Result<Vec<_>, Error>>()?;
        let mut stops = Self { members, pace, cursor: Cursor::default(), events: 1, pending: None };
        stops.align(0);
        Ok(stops)
    }

    /// Whether the events of a stop are stepped.
    fn has_events(&self) -> bool {
        self.members.iter().all(|member| member.stride == Stride::Unit)
    }

    fn align(&mut self, stop: usize) {
        self.members.iter_mut().for_each(|member| member.events.clear());
        self.events = 1;
        if !self.has_events() {
            return;
        }
        let mut here: Vec<_> = self.members.iter_mut().filter(|member| member.walk.cursor().unit == stop).collect();
        let stages: Vec<_> = here.iter().map(|member| member.walk.stages()).collect();
        let counts: Vec<_> = here.iter().map(|member| member.walk.events()).collect();
        let are_named = stages.iter().zip(&counts).all(|(stages, count)| stages.len() == *count);
        let all = if are_named { merged(&stages) } else { numbered(&counts) };
        self.events = all.first().map_or(1, Vec::len);
        here.iter_mut().zip(all).for_each(|(member, events)| member.events = events);
    }

    /// Does the next part of a move; returns it if it is unfinished, as an error if it only waits.
    fn proceed(
        &mut self,
        mut pending: PendingMove,
        more: &mut dyn FnMut() -> bool,
    ) -> Result<Option<PendingMove>, PendingMove> {
        let Some(member) = self.members.get_mut(pending.member) else {
            return Ok(match pending.phase {
                Phase::Reach => {
                    let reached = self.members.iter().map(Member::stop).max().unwrap_or(0);
                    self.cursor.unit = reached.min(pending.goal.unit);
                    self.align(self.cursor.unit);
                    // A run that ends before the goal is followed to its end.
                    let event = if reached < pending.goal.unit { usize::MAX } else { pending.goal.event };
                    let goal = Cursor { unit: self.cursor.unit, event: event.min(self.events) };
                    Some(PendingMove { goal, phase: Phase::Within, member: 0, asked: None })
                }
                Phase::Within => {
                    self.cursor = pending.goal;
                    None
                }
            });
        };
        if pending.asked.is_none() {
            let is_start = pending.goal == Cursor::default();
            let next = match pending.phase {
                _ if is_start => (member.walk.cursor() != pending.goal).then_some(Move::To(pending.goal)),
                Phase::Reach => member.towards(pending.goal.unit),
                Phase::Within => member.within(pending.goal.event),
            };
            let Some(next) = next else {
                pending.member += 1;
                return Ok(Some(pending));
            };
            pending.asked = Some((next, member.walk.cursor()));
            member.walk.go(next);
        }
        if !member.walk.work(more) {
            return Err(pending);
        }
        if let Some((made, from)) = pending.asked.take() {
            member.note(made);
            // A move that was cancelled leads nowhere.
            pending.member += usize::from(member.walk.cursor() == from);
        }
        Ok(Some(pending))
    }

    /// The step of member `index`. A click on its plots leads to an event of the current stop if its events are stepped.
    fn explain_member(&self, index: usize, focus: Option<Focus>) -> Step {
        let member = &self.members[index];
        let mut step = member.walk.step(in_frame_t(focus));
        for readout in &mut step.readouts {
            match readout {
                Readout::Series(series) => {
                    let stepped = |event: &usize| member.events.iter().position(|own| own >= event).map(|at| at + 1);
                    let all: Option<Vec<_>> = series.events.iter().map(stepped).collect();
                    series.events = all.unwrap_or_default();
                }
                Readout::Surface(surface) => surface.events.cells_mut().fill(None),
                _ => {}
            }
        }
        step
    }

    /// Whether a member waits for others.
    fn is_done(&self, member: &Member) -> bool {
        if self.cursor == Cursor::default() {
            return false;
        }
        match member.events.last() {
            Some(_) => member.walk.cursor().event == member.walk.events(),
            None => member.walk.at_end(),
        }
    }
}

/// Events of members with these numbers of them, one by one.
fn numbered(counts: &[usize]) -> Vec<Vec<usize>> {
    let most = counts.iter().copied().max().unwrap_or(0);
    counts.iter().map(|count| (1..=most).map(|event| event.min(*count)).collect()).collect()
}

/// Events of members whose stages have these names, so that those of one name stand side by side: a member without a stage
/// waits at the one before it, or at its first.
fn merged(stages: &[Vec<Name>]) -> Vec<Vec<usize>> {
    let mut done = vec![0; stages.len()];
    let mut events = vec![Vec::new(); stages.len()];
    loop {
        let heads = stages.iter().zip(&done).filter_map(|(stages, done)| stages.get(*done));
        // A stage that another member reaches later has to wait.
        let waits = |name: &&Name| {
            let behind = |(stages, done): (&Vec<Name>, &usize)| {
                stages.get(*done).is_some_and(|head| head != *name)
                    && stages.get(done + 1..).is_some_and(|rest| rest.contains(*name))
            };
            stages.iter().zip(&done).any(behind)
        };
        let Some(next) = heads.clone().find(|name| !waits(name)).or(heads.clone().next()).copied() else {
            return events;
        };
        for ((stages, done), events) in stages.iter().zip(&mut done).zip(&mut events) {
            *done += usize::from(stages.get(*done) == Some(&next));
            events.push((*done).max(1));
        }
    }
}

impl Walk for Stops {
    fn info(&self) -> &'static Info {
        self.pace.info()
    }

    fn frame(&self) -> usize {
        self.members[0].walk.frame()
    }

    fn at_frame(&self) -> usize {
        let ahead = self.members.iter().find(|member| member.stop() == self.cursor.unit);
        ahead.unwrap_or(&self.members[0]).walk.at_frame()
    }

    fn cursor(&self) -> Cursor {
        self.cursor
    }

    fn events(&self) -> usize {
        self.events
    }

    fn units(&self) -> Option<usize> {
        self.members.iter().map(Member::stops).try_fold(0, |most, stops| Some(most.max(stops?)))
    }

    fn advanced(&self) -> usize {
        self.members.iter().map(|member| member.walk.advanced()).sum()
    }

    fn at_end(&self) -> bool {
        self.cursor.event == self.events && self.members.iter().all(|member| member.walk.at_end())
    }

    fn place(&self) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: self.cursor.unit, of: self.units() }]
    }

    fn go(&mut self, to: Move) {
        let goal = goal(to, self);
        self.pending = Some(PendingMove { goal, phase: Phase::Reach, member: 0, asked: None });
    }

    fn work(&mut self, more: &mut dyn FnMut() -> bool) -> bool {
        while let Some(pending) = self.pending.take() {
            match self.proceed(pending, more) {
                Ok(pending) => self.pending = pending,
                Err(pending) => {
                    self.pending = Some(pending);
                    return false;
                }
            }
        }
        true
    }

    fn progress(&self) -> Option<(usize, usize)> {
        let member = self.members.get(self.pending.as_ref()?.member)?;
        member.walk.progress()
    }

    fn failure(&self) -> Option<&Error> {
        self.members.iter().find_map(|member| member.walk.failure())
    }

    /// The last event of each member that waits for others.
    fn landmarks(&self) -> Vec<(usize, Role)> {
        let last = |member: &Member| {
            let last = *member.events.last()?;
            member.events.iter().position(|event| *event == last).map(|at| at + 1)
        };
        let all = self.members.iter().filter_map(last).filter(|event| *event < self.events);
        all.map(|event| (event, Role::Result)).collect()
    }

    /// Each member has one picture: a place on frame t + 1 stands for that of frame t.
    fn takes(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::NEXT].contains(&picture) && self.members[0].walk.takes(Picture::CURRENT)
    }

    fn unit_at(&self, focus: Focus) -> Option<usize> {
        self.has_events().then(|| self.members[0].walk.unit_at(Focus::current(focus.at))).flatten()
    }

    fn explained(&self, focus: Focus) -> Option<Explained> {
        let leader = &self.members[0].walk;
        leader.explained(Focus::current(focus.at)).filter(|when| when.at(leader.cursor())).map(|_| Explained::Always)
    }

    fn step(&self, focus: Option<Focus>) -> Step {
        self.explain_member(0, focus)
    }

    fn scene(&self, focus: Option<Focus>) -> Scene {
        self.members[0].walk.scene(in_frame_t(focus))
    }

    fn output(&self) -> Output {
        self.members[0].walk.output()
    }

    fn evaluations(&self) -> Vec<usize> {
        Vec::new()
    }

    fn evaluated(&self) -> u64 {
        0
    }

    fn way_to(&self, block: usize) -> Vec<usize> {
        vec![block]
    }

    fn beside(&self, focus: Option<Focus>) -> Vec<Beside> {
        let of = |(index, member): (usize, &Member)| Beside {
            info: member.walk.info(),
            names: member.names.clone(),
            cursor: member.walk.cursor(),
            step: self.explain_member(index, focus),
            scene: member.walk.scene(in_frame_t(focus)),
            output: member.walk.output(),
            candidates: None,
            is_done: self.is_done(member),
        };
        self.members.iter().enumerate().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_of_one_name_stand_side_by_side() {
        let names = |all: &str| -> Vec<Name> { all.split(' ').map(named).collect() };
        let both = merged(&[names("compare decide open update"), names("compare decide shadows open close update")]);
        assert_eq!(both, [[1, 2, 2, 3, 3, 4], [1, 2, 3, 4, 5, 6]]);
        let late = merged(&[names("follow compare update"), names("compare update")]);
        assert_eq!(late, [[1, 2, 3], [1, 1, 2]], "the second stands at its first stage");
        let crossed = merged(&[names("open close"), names("close open")]);
        assert!(crossed.iter().all(|events| events.is_sorted() && events.last() == Some(&2)), "{crossed:?}");
        assert_eq!(merged(&[names("a b a b"), names("a b")]), [[1, 2, 3, 4], [1, 2, 2, 2]]);
    }

    #[test]
    fn events_without_names_go_one_by_one() {
        assert_eq!(numbered(&[3, 1]), [[1, 2, 3], [1, 1, 1]]);
    }

    fn named(name: &str) -> Name {
        let names = ["compare", "decide", "shadows", "open", "close", "follow", "update", "a", "b"];
        Name::new(names.into_iter().find(|other| *other == name).expect("a name").as_bytes())
    }
}
