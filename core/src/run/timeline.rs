//! Walks of any estimator, forwards and backwards: checkpoints, and replay of one unit for everything in between.
//!
//! Stepping back is recomputation. A [`Timeline`] keeps checkpoints of the state within a memory budget, drops every other one
//! when the budget is used up, and replays from the nearest one. The unit at the cursor is run once with its events stored, so
//! stepping inside it is immediate. `go` requests a move and `work` executes it in slices. `Estimator::at_rest` drops from a
//! checkpoint everything that can be recomputed from the frames. A law counts the work in pixels (`base/effort.rs`): showing
//! the last step takes at most twice the work of a run.

use std::collections::BTreeMap;

use web_time::{Duration, Instant};

use super::{Cursor, Direction, Estimator, Explained, Granularity, Info, Move, Progress, Seen, Walk};
use crate::base::{Error, Stop};
use crate::data::Clip;
use crate::products::Output;
use crate::scene::{Focus, Name, Picture, Role, Scene, Step};

/// A unit that was run with its events observed.
struct Unit<E: Estimator> {
    index: usize,
    before: E::State,
    after: E::State,
    events: Vec<E::Event>,
    /// The work from a checkpoint to the state before and after it.
    work: [Duration; 2],
}

impl<E: Estimator> Unit<E> {
    /// Runs the unit that starts at `start`, observed.
    fn observe(estimator: &E, clip: &Clip, start: UnitStart<E>) -> Result<(Self, Progress), Error> {
        let UnitStart { index, state: before, work } = start;
        let (begun, mut after) = (Instant::now(), before.clone());
        let mut events = Vec::new();
        let progress = estimator.advance(clip, &mut after, &mut events)?;
        Ok((Self { index, before, after, events, work: [work, work + begun.elapsed()] }, progress))
    }
}

/// The start of a unit: its index, the state before it, and the work from a checkpoint to there.
struct UnitStart<E: Estimator> {
    index: usize,
    state: E::State,
    work: Duration,
}

/// A move that is not finished: its goal, and the state before unit `index` on the way to it.
struct PendingMove<E: Estimator> {
    goal: Goal,
    origin: usize,
    index: usize,
    state: E::State,
    /// The work from a checkpoint to the state.
    work: Duration,
}

/// The goal of a move.
#[derive(Clone, Copy)]
enum Goal {
    /// A cursor.
    Cursor(Cursor),
    /// The last unit of the group to which unit `from` belongs on a granularity.
    GroupEnd { granularity: usize, from: usize },
}

impl Goal {
    fn end_of(unit: usize) -> Self {
        Goal::Cursor(Cursor { unit, event: usize::MAX })
    }

    /// The first unit that a move there must not run past unobserved.
    fn unit(self) -> usize {
        match self {
            Goal::Cursor(cursor) => cursor.unit,
            Goal::GroupEnd { from, .. } => from,
        }
    }
}

/// A checkpoint is kept if it saves at least this multiple of the time that keeping it takes; otherwise a walk would
/// spend its time on copies. The choice does not affect the results.
const SAVED: u32 = 8;
/// A state of at most this size is always kept.
const SMALL_BYTES: usize = 4 << 10;

/// Checkpoints of states before units, within a budget of memory.
struct Checkpoints<S> {
    states: BTreeMap<usize, (S, usize)>,
    /// The smallest distance of two, in units.
    stride: usize,
    bytes: usize,
    budget_bytes: usize,
    /// The time that the last one took.
    cost: Duration,
}

impl<S> Checkpoints<S> {
    /// Whether a state is kept that takes `work` to reach from the checkpoint before it.
    fn wants(&self, index: usize, bytes: usize, work: Duration) -> bool {
        let is_worth_it = bytes <= SMALL_BYTES || work >= SAVED * self.cost;
        self.nearest(index).is_none_or(|(before, _)| index - before >= self.stride && is_worth_it)
    }

    /// Keeps a state and its bytes; thins out when the budget is used up.
    fn keep(&mut self, index: usize, rest: impl FnOnce() -> (S, usize)) {
        let begun = Instant::now();
        let (state, bytes) = rest();
        self.cost = begun.elapsed();
        self.states.insert(index, (state, bytes));
        self.bytes += bytes;
        while self.bytes > self.budget_bytes && self.states.len() > 1 {
            self.stride *= 2;
            let mut is_kept = false;
            self.states.retain(|_, _| {
                is_kept = !is_kept;
                is_kept
            });
            self.bytes = self.states.values().map(|(_, bytes)| bytes).sum();
        }
    }

    fn nearest(&self, index: usize) -> Option<(usize, &S)> {
        self.states.range(..=index).next_back().map(|(&index, (state, _))| (index, state))
    }
}

/// The first units of the groups of each granularity, of the part of the run computed so far.
struct Groups {
    starts: Vec<Vec<usize>>,
    place: Vec<usize>,
    explored: usize,
}

impl Groups {
    fn note(&mut self, index: usize, place: &[Granularity]) {
        if index < self.explored {
            return;
        }
        self.explored = index + 1;
        // A group begins where its own index, or that of a granularity further out, changes.
        let mut changed = self.place.is_empty();
        for (granularity, starts) in self.starts.iter_mut().enumerate() {
            changed |= self.place.get(granularity) != place.get(granularity).map(|r| &r.index);
            if changed {
                starts.push(index);
            }
        }
        self.place = place.iter().map(|granularity| granularity.index).collect();
    }

    fn is_start(&self, granularity: usize, index: usize) -> bool {
        self.starts[granularity].binary_search(&index).is_ok()
    }

    /// First unit of the group to which unit `index` belongs.
    fn start_of(&self, granularity: usize, index: usize) -> usize {
        let after = self.starts[granularity].partition_point(|&start| start <= index);
        self.starts[granularity][..after].last().copied().unwrap_or(0)
    }
}

/// A run of one estimator with checkpoints, for random access to its steps.
pub struct Timeline<E: Estimator> {
    estimator: E,
    clip: Clip,
    frame: usize,
    unit: Unit<E>,
    /// Events of the unit that were seen.
    seen: usize,
    /// Number of units, once it is known.
    units: Option<usize>,
    failure: Option<Error>,
    pending: Option<PendingMove<E>>,
    checkpoints: Checkpoints<E::State>,
    groups: Groups,
    /// Units performed so far, including repeated ones.
    advanced: usize,
}

impl<E: Estimator> Timeline<E> {
    /// Default memory of checkpoints.
    pub const BUDGET_BYTES: usize = 384 << 20;

    /// The run of `estimator` on `frame`, at its start.
    ///
    /// # Errors
    /// If the clip, the frame or the parameters do not allow a run.
    pub fn new(estimator: E, clip: Clip, frame: usize) -> Result<Self, Error> {
        let start = estimator.start(&clip, frame)?;
        let (unit, progress) =
            Unit::observe(&estimator, &clip, UnitStart { index: 0, state: start, work: Duration::ZERO })?;
        let units = if progress == Progress::Done { Some(1) } else { estimator.units(&unit.before) };
        let mut timeline = Self {
            checkpoints: Checkpoints {
                states: BTreeMap::new(),
                stride: 1,
                bytes: 0,
                budget_bytes: Self::BUDGET_BYTES,
                cost: Duration::ZERO,
            },
            groups: Groups {
                // A unit and an event need none.
                starts: vec![Vec::new(); E::INFO.granularities.len() - 2],
                place: Vec::new(),
                explored: 0,
            },
            estimator,
            clip,
            frame,
            seen: 0,
            units,
            failure: None,
            pending: None,
            unit,
            advanced: 1,
        };
        let start = timeline.unit.before.clone();
        timeline.come_by(0, &start, Duration::ZERO);
        Ok(timeline)
    }

    /// The same run with another budget for its checkpoints.
    #[must_use]
    pub fn with_budget(mut self, bytes: usize) -> Self {
        self.checkpoints.budget_bytes = bytes;
        self
    }

    /// The state that is seen at the cursor: that of the finished unit at its end, else that before it.
    fn state_seen(&self) -> &E::State {
        if self.unit_is_over() { &self.unit.after } else { &self.unit.before }
    }

    /// Memory of the checkpoints in bytes.
    pub fn checkpoint_bytes(&self) -> usize {
        self.checkpoints.bytes
    }

    fn seen_so_far(&self, focus: Option<Focus>) -> Seen<'_, E> {
        self.seen_up_to(self.seen, focus)
    }

    /// The unit up to its event number `seen`.
    fn seen_up_to(&self, seen: usize, focus: Option<Focus>) -> Seen<'_, E> {
        let (cursor, is_over) =
            (Cursor { unit: self.unit.index, event: seen }, seen > 0 && seen == self.unit.events.len());
        Seen {
            clip: &self.clip,
            before: &self.unit.before,
            after: is_over.then_some(&self.unit.after),
            events: &self.unit.events[..seen],
            // A pixel is not explained before its turn.
            focus: focus.filter(|focus| {
                self.takes(focus.on) && self.explained(*focus).is_none_or(|explained| explained.at(cursor))
            }),
        }
    }

    fn unit_is_over(&self) -> bool {
        self.seen > 0 && self.seen == self.unit.events.len()
    }

    /// Records `state`, before unit `index`, which takes `work` to reach from a checkpoint; returns the work to reach it from now on.
    fn come_by(&mut self, index: usize, state: &E::State, work: Duration) -> Duration {
        self.groups.note(index, &self.estimator.place(state));
        let estimator = &self.estimator;
        if !self.checkpoints.wants(index, estimator.state_bytes(state), work) {
            return work;
        }
        self.checkpoints.keep(index, || {
            let state = estimator.at_rest(state);
            let bytes = estimator.state_bytes(&state);
            (state, bytes)
        });
        Duration::ZERO
    }

    /// The goal of a move, or `None` if it lies in the current unit; then the cursor is there.
    fn goal(&mut self, to: Move) -> Option<Goal> {
        let all = self.unit.events.len();
        let unit = self.unit.index;
        let innermost = E::INFO.granularities.len() - 1;
        match to {
            Move::To(Cursor { unit, event: 0 }) if unit > 0 => Some(Goal::end_of(unit - 1)),
            Move::To(cursor) => Some(Goal::Cursor(cursor)),
            Move::End => Some(Goal::end_of(usize::MAX)),
            Move::Granularity(granularity, Direction::Forward) if self.seen < all && granularity + 1 >= innermost => {
                self.seen = if granularity == innermost { self.seen + 1 } else { all };
                None
            }
            Move::Granularity(_, Direction::Forward) if self.at_end() => None,
            // The group of the outermost granularity is the whole run, whose length may be known.
            Move::Granularity(0, Direction::Forward) => Some(Goal::end_of(usize::MAX)),
            Move::Granularity(granularity, Direction::Forward) if granularity == innermost => {
                Some(Goal::Cursor(Cursor { unit: unit + 1, event: 1 }))
            }
            Move::Granularity(granularity, Direction::Forward) if granularity + 1 == innermost => {
                Some(Goal::end_of(unit + 1))
            }
            Move::Granularity(granularity, Direction::Forward) => {
                let from = if self.seen == all { unit + 1 } else { unit };
                Some(Goal::GroupEnd { granularity, from })
            }
            Move::Granularity(granularity, Direction::Back) if granularity == innermost && self.seen > 1 => {
                self.seen -= 1;
                None
            }
            Move::Granularity(granularity, Direction::Back) => {
                let start = if granularity + 1 >= innermost { unit } else { self.groups.start_of(granularity, unit) };
                match start.checked_sub(1) {
                    Some(previous) => Some(Goal::end_of(previous)),
                    None => Some(Goal::Cursor(Cursor::default())),
                }
            }
        }
    }

    /// Starts a move to `goal` from the nearest checkpoint.
    fn begin_move(&self, goal: Goal) -> PendingMove<E> {
        let goal = match (goal, self.units) {
            (Goal::Cursor(cursor), Some(units)) if cursor.unit >= units => Goal::end_of(units - 1),
            _ => goal,
        };
        let here = &self.unit;
        let [before, after] = here.work;
        let after = (Some(here.index + 1) != self.units).then_some((here.index + 1, &here.after, after));
        let kept = self.checkpoints.nearest(goal.unit()).map(|(index, state)| (index, state, Duration::ZERO));
        let at_hand = [kept, Some((here.index, &here.before, before)), after];
        let nearest = at_hand.into_iter().flatten().filter(|(index, ..)| *index <= goal.unit());
        let nearest = nearest.max_by_key(|(index, ..)| *index);
        let (index, state, work) = nearest.unwrap_or((here.index, &here.before, before));
        PendingMove { goal, origin: index, index, state: state.clone(), work }
    }

    /// Runs some units of a pending move unobserved; returns the move if it is unfinished.
    fn proceed(&mut self, mut pending: PendingMove<E>) -> Option<PendingMove<E>> {
        let most = match pending.goal {
            Goal::Cursor(cursor) => cursor.unit - pending.index,
            Goal::GroupEnd { .. } => usize::MAX,
        };
        let begun = Instant::now();
        let done = self.estimator.advance_many(&self.clip, &mut pending.state, most);
        pending.work += begun.elapsed();
        self.advanced += done.as_ref().map_or(1, |(units, _)| *units);
        match done {
            Ok((units, Progress::More)) => {
                pending.index += units;
                pending.work = self.come_by(pending.index, &pending.state, pending.work);
                Some(match pending.goal {
                    Goal::GroupEnd { granularity, from }
                        if pending.index > from && self.groups.is_start(granularity, pending.index) =>
                    {
                        self.begin_move(Goal::end_of(pending.index - 1))
                    }
                    _ => pending,
                })
            }
            Ok((units, Progress::Done)) => {
                self.units = Some(pending.index + units);
                Some(self.begin_move(Goal::end_of(pending.index + units - 1)))
            }
            Err(error) => self.end(pending.index, error),
        }
    }

    /// Runs the unit of the goal, observed.
    fn complete_move(&mut self, pending: PendingMove<E>, cursor: Cursor) -> Option<PendingMove<E>> {
        let work = self.come_by(pending.index, &pending.state, pending.work);
        self.advanced += 1;
        match Unit::observe(&self.estimator, &self.clip, UnitStart { index: pending.index, state: pending.state, work })
        {
            Ok((unit, progress)) => {
                if progress == Progress::Done {
                    self.units = Some(unit.index + 1);
                }
                self.seen = cursor.event.min(unit.events.len());
                self.unit = unit;
                None
            }
            Err(error) => self.end(pending.index, error),
        }
    }

    /// Ends the run before unit `index`, which failed. The first unit has run once, so it stays. If it was cancelled,
    /// so is the move, and the run stays where it is.
    fn end(&mut self, index: usize, error: Error) -> Option<PendingMove<E>> {
        if error == Stop::cancelled() || self.clip.wanted().is_err() {
            return None;
        }
        self.failure = Some(error);
        self.units = Some(index.max(1));
        index.checked_sub(1).map(|last| self.begin_move(Goal::end_of(last)))
    }
}

impl<E: Estimator> Walk for Timeline<E> {
    fn info(&self) -> &'static Info {
        const { &E::INFO }
    }

    fn tells_confidence(&self) -> bool {
        E::TELLS_CONFIDENCE
    }

    fn frame(&self) -> usize {
        self.frame
    }

    fn at_frame(&self) -> usize {
        self.estimator.at_frame(&self.unit.before).unwrap_or(self.frame)
    }

    fn cursor(&self) -> Cursor {
        Cursor { unit: self.unit.index, event: self.seen }
    }

    fn events(&self) -> usize {
        self.unit.events.len()
    }

    fn units(&self) -> Option<usize> {
        self.units
    }

    fn advanced(&self) -> usize {
        self.advanced
    }

    fn at_end(&self) -> bool {
        self.unit_is_over() && self.units == Some(self.unit.index + 1)
    }

    fn place(&self) -> Vec<Granularity> {
        self.estimator.place(&self.unit.before)
    }

    fn go(&mut self, to: Move) {
        self.pending = None;
        if let Some(goal) = self.goal(to) {
            self.pending = Some(self.begin_move(goal));
        }
    }

    fn work(&mut self, more: &mut dyn FnMut() -> bool) -> bool {
        while let Some(pending) = self.pending.take() {
            self.pending = match pending.goal {
                Goal::Cursor(cursor) if cursor.unit == pending.index => self.complete_move(pending, cursor),
                _ => self.proceed(pending),
            };
            if self.pending.is_some() && !more() {
                return false;
            }
        }
        true
    }

    fn progress(&self) -> Option<(usize, usize)> {
        let pending = self.pending.as_ref()?;
        match pending.goal {
            Goal::Cursor(Cursor { unit, .. }) if unit < usize::MAX => {
                Some((pending.index - pending.origin, unit - pending.origin))
            }
            _ => None,
        }
    }

    fn failure(&self) -> Option<&Error> {
        self.failure.as_ref()
    }

    fn landmarks(&self) -> Vec<(usize, Role)> {
        let roles = self.unit.events.iter().map(|event| self.estimator.landmark(event));
        roles.enumerate().filter_map(|(i, role)| role.map(|role| (i + 1, role))).collect()
    }

    fn is_idle(&self) -> bool {
        let event = self.cursor().event.checked_sub(1).and_then(|last| self.unit.events.get(last));
        event.is_some_and(|event| self.estimator.is_idle(event))
    }

    fn takes(&self, picture: Picture) -> bool {
        self.estimator.pointed().map_or(picture == Picture::CURRENT, |pointed| pointed.takes(picture))
    }

    fn unit_at(&self, focus: Focus) -> Option<usize> {
        let pointed = self.estimator.pointed().filter(|pointed| pointed.takes(focus.on))?;
        pointed.unit_at(&self.unit.before, focus)
    }

    fn explained(&self, focus: Focus) -> Option<Explained> {
        let pointed = self.estimator.pointed().filter(|pointed| pointed.takes(focus.on))?;
        pointed.explained(&self.unit.before, focus)
    }

    fn object_at(&self, focus: Focus) -> Option<u32> {
        let pointed = self.estimator.pointed().filter(|pointed| pointed.takes(focus.on))?;
        pointed.object_at(self.state_seen(), focus)
    }

    fn place_of(&self, object: u32) -> Option<[f32; 2]> {
        self.estimator.pointed()?.place_of(self.state_seen(), object)
    }

    fn stages(&self) -> Vec<Name> {
        self.unit.events.iter().filter_map(|event| self.estimator.stage(event)).collect()
    }

    fn step(&self, focus: Option<Focus>) -> Step {
        self.estimator.step(&self.seen_so_far(focus))
    }

    fn step_before(&self, focus: Option<Focus>) -> Option<Step> {
        // The start of a later unit is no step of its own: it is the end of the unit before.
        let before = self.seen.checked_sub(1).filter(|before| *before > 0 || self.unit.index == 0)?;
        Some(self.estimator.step(&self.seen_up_to(before, focus)))
    }

    fn scene(&self, focus: Option<Focus>) -> Scene {
        let mut scene = Scene::default();
        self.estimator.draw(&self.seen_so_far(focus), &mut scene);
        scene
    }

    fn output(&self) -> Output {
        self.estimator.output(self.state_seen())
    }

    fn causal(&self) -> Option<Output> {
        self.estimator.causal(self.state_seen())
    }

    fn evaluations(&self) -> Vec<usize> {
        let Some(tests) = self.estimator.tests() else { return Vec::new() };
        let events = self.unit.events.iter().enumerate();
        events.filter_map(|(i, event)| tests.is_evaluation(event).then_some(i + 1)).collect()
    }

    fn evaluated(&self) -> u64 {
        let Some(tests) = self.estimator.tests() else { return 0 };
        let before: u64 = tests.evaluations(&self.unit.before).into_iter().map(u64::from).sum();
        let seen = self.unit.events[..self.seen].iter().filter(|event| tests.is_evaluation(event));
        before + seen.count() as u64
    }

    fn way_to(&self, block: usize) -> Vec<usize> {
        self.estimator.tests().map_or_else(|| vec![block], |tests| tests.way_to(&self.unit.before, block))
    }
}
