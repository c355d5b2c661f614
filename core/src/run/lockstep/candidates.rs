//! Block searches in lockstep, candidate by candidate.
//!
//! ```text
//! step of the block   1   2   3   4   5   6   7      Pace::Block: candidate k of each, and at last what each found
//! full search         ●   ●   ●   ●   ●   ●   found
//! diamond             ●   ●   ●   ●   found           one that is done waits
//! ```

use super::{Pace, goal, in_frame_t, names, of_member};
use crate::base::{Error, Threads};
use crate::data::Clip;
use crate::products::{BlockField, BlockGrid, Output};
use crate::run::{AnyEstimator, Beside, CandidateCount, Cursor, Granularity, Info, Move, Walk};
use crate::scene::{Focus, Picture, Readout, Role, Scene, Step};

/// The events of one unit of a member at which candidates were tested.
#[derive(Clone, Default)]
struct Trail {
    unit: usize,
    /// Number of events seen by then, for each candidate.
    evaluations: Vec<usize>,
    events: usize,
}

struct Member {
    walk: Box<dyn Walk>,
    names: [String; 2],
    /// For a budget: candidates tested before each unit, and in all.
    spent: Vec<u64>,
    /// The units that lead to the result shown.
    trails: Vec<Trail>,
    /// Number of their candidates tested so far; one more once the result is shown.
    seen: usize,
}

impl Member {
    fn candidates(&self) -> usize {
        self.trails.iter().map(|trail| trail.evaluations.len()).sum()
    }

    /// Number of the unit that the member is at, of those that lead to the result shown, from 1, and their total.
    fn leg(&self) -> (usize, usize) {
        let unit = self.walk.cursor().unit;
        let at = self.trails.iter().position(|trail| trail.unit == unit).unwrap_or(0);
        (at + 1, self.trails.len())
    }

    /// The number of the candidate that was tested at `event` of the current unit, among all those of its trails.
    fn number(&self, event: usize) -> usize {
        let unit = self.walk.cursor().unit;
        let before = self.trails.iter().take_while(|trail| trail.unit != unit).map(|trail| trail.evaluations.len());
        let here = self.trails.iter().find(|trail| trail.unit == unit);
        before.sum::<usize>() + here.map_or(0, |trail| trail.evaluations.partition_point(|&e| e <= event))
    }

    /// The cursor of the member after candidate `seen` of its trails, with a new best seen; beyond the last one, at their end.
    fn stand(&self, mut seen: usize) -> Cursor {
        if seen == 0 {
            return Cursor::default();
        }
        for trail in &self.trails {
            if let Some(last) = seen.checked_sub(1).filter(|last| *last < trail.evaluations.len()) {
                // The next candidate, or the end of the unit, is not seen yet.
                let next = trail.evaluations.get(last + 1).copied().unwrap_or(trail.events);
                return Cursor { unit: trail.unit, event: trail.evaluations[last].max(next - 1) };
            }
            seen -= trail.evaluations.len();
        }
        Cursor { unit: self.trails.last().map_or(0, |trail| trail.unit), event: usize::MAX }
    }
}

/// An unfinished move: the members visit their units one after the other, then go to their positions.
struct PendingMove {
    goal: Cursor,
    /// For each member the units that lead to the goal, and the candidate of them at which it is to stand.
    ways: Vec<(Vec<usize>, usize)>,
    /// The member at work.
    member: usize,
    /// Its trails that are known; `None` once they all are and members are on their way to where they stand.
    trails: Option<Vec<Trail>>,
    /// Whether the member was told where to go.
    asked: bool,
}

/// A run of several estimators at once, which is walked through like that of one.
///
/// A unit is a block of frame t, in [`Pace::Budget`] a unit of the first estimator, which leads. Event k is candidate k
/// of each; the last event tells what was found. An estimator that comes to a block over several levels tests the
/// candidates of all units that lead to it, from the coarsest on; those of a coarse level are tested again for each
/// block that inherits from there. A move that is given up leaves the members on their way until the next one.
pub(super) struct Candidates {
    members: Vec<Member>,
    /// Whether the candidates of the whole picture count, and not those of a block.
    is_budget: bool,
    blocks: BlockGrid,
    units: usize,
    cursor: Cursor,
    /// Events of the current unit.
    events: usize,
    pending: Option<PendingMove>,
}

impl Candidates {
    /// The runs of `estimators` on `frame`, at their start. For a budget, each is run once on `threads`.
    ///
    /// # Errors
    /// If they do not have the same blocks, or one cannot run.
    pub(super) fn new(
        estimators: &[&dyn AnyEstimator],
        pace: Pace,
        (clip, frame): (&Clip, usize),
        threads: &Threads,
    ) -> Result<Self, Error> {
        let is_budget = pace == Pace::Budget;
        let member = |(estimator, names): (&&dyn AnyEstimator, [String; 2])| {
            let refused = |error: Error| of_member(*estimator, &error);
            let mut spent = Vec::new();
            if is_budget {
                let evaluations = estimator.evaluations(clip, frame, threads).map_err(refused)?;
                spent.push(0);
                spent.extend(evaluations.iter().scan(0, |sum, count| {
                    *sum += u64::from(*count);
                    Some(*sum)
                }));
            }
            let walk = estimator.walk(clip, frame).map_err(refused)?;
            Ok(Member { walk, names, spent, trails: Vec::new(), seen: 0 })
        };
        let members = estimators.iter().zip(names(estimators)).map(member).collect::<Result<Vec<_>, Error>>()?;
        let blocks = members.iter().map(|member| {
            let grid = member.walk.output().get::<BlockField>().map(|field| field.blocks);
            let id = member.walk.info().id;
            grid.ok_or_else(|| {
                Error::new(format!("{id} has no blocks to step through in lockstep; choose block searches"))
            })
        });
        let blocks = blocks.collect::<Result<Vec<BlockGrid>, Error>>()?;
        if let Some(other) = blocks.iter().position(|grid| *grid != blocks[0]) {
            let [first, other] = [0, other].map(|index| estimators[index].info().id);
            return Err(Error::new(format!(
                "{first} and {other} have different block grids; give them the same block size and spacing"
            )));
        }
        let units = if is_budget { members[0].spent.len() - 1 } else { blocks[0].len() };
        let mut lockstep =
            Self { members, is_budget, blocks: blocks[0], units, cursor: Cursor::default(), events: 0, pending: None };
        lockstep.jump(Move::To(Cursor::default()));
        Ok(lockstep)
    }

    /// The units that lead to `goal`, and the candidate of them at which to stand, for each member.
    fn ways(&self, goal: Cursor) -> Vec<(Vec<usize>, usize)> {
        if self.is_budget {
            self.members.iter().map(|m| budgeted(&m.spent, &self.members[0].spent, goal)).collect()
        } else {
            self.members.iter().map(|m| (m.walk.way_to(goal.unit), goal.event)).collect()
        }
    }

    /// Does the next part of a move; returns it if it is unfinished, and whether it only waits.
    fn proceed(
        &mut self,
        mut pending: PendingMove,
        more: &mut dyn FnMut() -> bool,
    ) -> Result<Option<PendingMove>, PendingMove> {
        let Some(member) = self.members.get_mut(pending.member) else {
            let Some(_) = pending.trails.take() else {
                self.complete_move(pending.goal);
                return Ok(None);
            };
            // All candidates are known: every member moves to its position.
            (pending.member, pending.asked) = (0, false);
            return Ok(Some(pending));
        };
        let (way, seen) = &pending.ways[pending.member];
        let cursor = match &pending.trails {
            Some(trails) => match way.get(trails.len()) {
                Some(&unit) => Cursor { unit, event: usize::MAX },
                None => {
                    member.trails = trails.clone();
                    pending.trails = Some(Vec::new());
                    pending.member += 1;
                    return Ok(Some(pending));
                }
            },
            None => {
                member.seen = (*seen).min(member.candidates() + 1);
                member.stand(*seen)
            }
        };
        if !std::mem::replace(&mut pending.asked, true) {
            if let Some(trails) =
                pending.trails.as_mut().filter(|_| way.iter().eq(member.trails.iter().map(|t| &t.unit)))
            {
                // The same units as before, whose candidates are already known.
                (*trails, pending.asked) = (member.trails.clone(), false);
                return Ok(Some(pending));
            }
            member.walk.go(Move::To(cursor));
        }
        if !member.walk.work(more) {
            return Err(pending);
        }
        pending.asked = false;
        match &mut pending.trails {
            Some(trails) => trails.push(Trail {
                unit: cursor.unit,
                evaluations: member.walk.evaluations(),
                events: member.walk.events(),
            }),
            None => pending.member += 1,
        }
        Ok(Some(pending))
    }

    fn complete_move(&mut self, goal: Cursor) {
        let candidates = self.members.iter().map(Member::candidates);
        let most = if self.is_budget { candidates.take(1).next() } else { candidates.max() };
        self.events = most.unwrap_or(0) + 1;
        self.cursor = Cursor { event: goal.event.min(self.events), ..goal };
    }

    /// The step of member `index`. A click on its readouts leads to a candidate of the current block; with a budget,
    /// only the leader has one.
    fn explain_member(&self, index: usize, focus: Option<Focus>) -> Step {
        let member = &self.members[index];
        let mut step = member.walk.step(in_frame_t(focus));
        let leads = !self.is_budget || index == 0;
        let number = |event: usize| leads.then(|| member.number(event));
        for readout in &mut step.readouts {
            match readout {
                Readout::Series(series) => {
                    series.events = series.events.iter().filter_map(|event| number(*event)).collect();
                }
                Readout::Surface(surface) => {
                    surface.events.cells_mut().iter_mut().for_each(|event| *event = event.and_then(number));
                }
                _ => {}
            }
        }
        step
    }

    fn is_done(&self, member: &Member) -> bool {
        if self.is_budget { member.walk.at_end() } else { member.seen > member.candidates() }
    }
}

/// The unit of a member, and the candidate of it, at which the leader has spent as much at `goal`.
fn budgeted(spent: &[u64], leader: &[u64], goal: Cursor) -> (Vec<usize>, usize) {
    let [before, after] = [leader[goal.unit], leader[goal.unit + 1]];
    let budget = after.min(before.saturating_add(goal.event as u64));
    let is_told = goal.event as u64 > after - before;
    // The first unit at whose end the budget is used up, or more.
    let unit = spent[1..].partition_point(|&sum| sum < budget).min(spent.len() - 2);
    let left = (budget - spent[unit].min(budget)) as usize;
    let of_unit = (spent[unit + 1] - spent[unit]) as usize;
    (vec![unit], left.min(of_unit + 1) + usize::from(is_told && left == of_unit))
}

impl Walk for Candidates {
    fn info(&self) -> &'static Info {
        Pace::Block.info()
    }

    fn frame(&self) -> usize {
        self.members[0].walk.frame()
    }

    fn cursor(&self) -> Cursor {
        self.cursor
    }

    fn events(&self) -> usize {
        self.events
    }

    fn units(&self) -> Option<usize> {
        Some(self.units)
    }

    fn advanced(&self) -> usize {
        self.members.iter().map(|member| member.walk.advanced()).sum()
    }

    fn at_end(&self) -> bool {
        self.cursor == Cursor { unit: self.units - 1, event: self.events }
    }

    fn place(&self) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: self.cursor.unit, of: Some(self.units) }]
    }

    fn go(&mut self, to: Move) {
        let goal = goal(to, self);
        let goal = if goal.unit < self.units { goal } else { Cursor { unit: self.units - 1, event: usize::MAX } };
        let ways = self.ways(goal);
        self.pending = Some(PendingMove { goal, ways, member: 0, trails: Some(Vec::new()), asked: false });
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

    /// The end of each member.
    fn landmarks(&self) -> Vec<(usize, Role)> {
        let members = self.members.iter().filter(|_| !self.is_budget);
        members.map(|member| (member.candidates() + 1, Role::Result)).collect()
    }

    /// Each member has one picture: a place on frame t + 1 stands for that of frame t.
    fn takes(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::NEXT].contains(&picture)
    }

    fn unit_at(&self, focus: Focus) -> Option<usize> {
        if self.is_budget { self.members[0].walk.unit_at(Focus::current(focus.at)) } else { self.blocks.at(focus.at) }
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
        (1..self.events).collect()
    }

    fn evaluated(&self) -> u64 {
        self.members[0].walk.evaluated()
    }

    fn way_to(&self, block: usize) -> Vec<usize> {
        if self.is_budget { self.members[0].walk.way_to(block) } else { vec![block] }
    }

    fn beside(&self, focus: Option<Focus>) -> Vec<Beside> {
        let of = |(index, member): (usize, &Member)| Beside {
            info: member.walk.info(),
            names: member.names.clone(),
            cursor: member.walk.cursor(),
            step: self.explain_member(index, focus),
            scene: member.walk.scene(in_frame_t(focus)),
            output: member.walk.output(),
            candidates: Some(CandidateCount {
                here: member.seen.min(member.candidates()),
                leg: member.leg(),
                in_all: member.walk.evaluated(),
            }),
            is_done: self.is_done(member),
        };
        self.members.iter().enumerate().map(of).collect()
    }
}
