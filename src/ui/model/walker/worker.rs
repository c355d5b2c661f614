//! The worker: serves requests one after the other, gives up a move for a newer request, and shows the run.

use std::cell::{Cell, OnceCell, RefCell};
use std::sync::Arc;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{Clip, Flow};
use motionscope_core::run::{Cursor, Explained, Move};
use motionscope_core::scene::Focus;
use web_time::Instant;

use super::SLOW_AFTER;
use super::long_move::LongMove;
use super::mailbox::{Phase, Request, Shared};
use super::run::Run;
use crate::experiment::interest::{first_step, opening};
use crate::experiment::pixel::{Held, is_explained, place_of, walks_pixels};
use crate::experiment::{Experiment, Prepared};
use crate::paint::FlowLayer;
use crate::ui::commands::Side;
use crate::ui::model::preview::preview;
use crate::ui::model::snapshot::{Hold, Job, Near, Place, Pointed, Snapshot, event_of};
use crate::view::look::Look;
use crate::view::moment::{LastPair, Moment};
use crate::view::motion::{AvailableLayers, backward};
use crate::view::named::LastNamed;
use crate::work;

enum Task {
    Start(Job),
    Request(Request),
    Look,
    Focus,
    Backward(Arc<Prepared>, Result<Flow, Error>),
}

pub(super) struct Worker<'a> {
    pub(super) shared: &'a Arc<Shared>,
    pub(super) run: Option<Run>,
    /// The pixel that was clicked.
    pub(super) held: Option<Focus>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(shared: &'a Arc<Shared>) -> Self {
        Self { shared, run: None, held: None }
    }

    pub(super) async fn run(mut self) {
        let shared = self.shared;
        loop {
            shared.mailbox().since = None;
            let Some(task) = shared.wake.until(|| self.next_task()).await else { return };
            if let Err(panic) = work::caught(self.serve(task)).await {
                self.run = None;
                self.refuse(panicked(panic.as_ref()));
            }
        }
    }

    /// The next thing to do, if there is one; `Some(None)` at the end of the session.
    fn next_task(&self) -> Option<Option<Task>> {
        let mut mailbox = self.shared.mailbox();
        if mailbox.quit {
            return Some(None);
        }
        let job = mailbox.job.take().map(Task::Start);
        self.shared.stop.set(false);
        if job.is_some() || !mailbox.requests.is_empty() {
            self.shared.superseded.set(false);
        }
        let task = job.or_else(|| mailbox.requests.pop_front().map(Task::Request));
        let task = task.or_else(|| {
            let (subject, flow) = mailbox.backward.take()?;
            (mailbox.view.checking, mailbox.view.busy) = (false, true);
            Some(Task::Backward(subject, flow))
        });
        let task = task.or_else(|| std::mem::take(&mut mailbox.look_changed).then_some(Task::Look));
        let task = task.or_else(|| std::mem::take(&mut mailbox.focus_moved).then_some(Task::Focus));
        if task.is_some() {
            (mailbox.since, mailbox.unwanted) = (Some(Instant::now()), None);
            return Some(task);
        }
        let was_busy = std::mem::replace(&mut mailbox.view.busy, false) | mailbox.view.progress.take().is_some();
        drop(mailbox);
        self.shared.idle.notify_all();
        if was_busy {
            (self.shared.changed)();
        }
        None
    }

    async fn serve(&mut self, task: Task) {
        match task {
            Task::Start(job) => {
                let opened = self.open(job).await;
                let mut mailbox = self.shared.mailbox();
                mailbox.starting = mailbox.job.is_some();
                drop(mailbox);
                match opened {
                    Ok(true) => self.publish(),
                    // It is on its way to another place, another job waits, or the end.
                    Ok(false) => {}
                    Err(_) if self.shared.stop.is_set() => {}
                    Err(error) => self.refuse(error),
                }
            }
            Task::Request(Request::Go(to)) => {
                let Some(run) = &self.run else { return };
                self.held = self.held.filter(|at| !walks_pixels(&*run.walk, *at));
                self.go(to).await;
            }
            Task::Request(Request::GoAt(focus, side)) => self.go_at(focus, side).await,
            Task::Request(Request::GoToCandidate(candidate)) => self.go_to_candidate(candidate).await,
            Task::Request(Request::GoToMark(way, marks)) => self.go_to_mark(way, marks).await,
            Task::Request(Request::Release) => {
                if self.held.take().is_some() {
                    self.publish();
                }
            }
            Task::Request(Request::Stay) => {
                // Figures of the end that were given up are not measured again.
                self.run.iter().for_each(|run| run.is_brief.set(true));
                if let Some(cursor) = self.run.as_ref().map(|run| run.walk.cursor()) {
                    self.go(Move::To(cursor)).await;
                }
                self.run.iter().for_each(|run| run.is_brief.set(false));
            }
            Task::Request(Request::Visit(visit)) => {
                if let Some(run) = &self.run {
                    visit(&run.subject, run.walk.as_ref());
                }
            }
            Task::Look => {
                self.forget_failed_check();
                self.publish();
            }
            // What is held stays, wherever the pointer goes.
            Task::Focus if self.held().is_some() => {}
            Task::Focus => {
                let focus = self.shared.mailbox().focus;
                if self.run.as_ref().is_some_and(|run| run.has_another_explanation(focus)) {
                    self.publish();
                }
            }
            Task::Backward(subject, flow) => {
                if let Some(run) = self.run.as_mut().filter(|run| Arc::ptr_eq(&run.subject, &subject)) {
                    run.backward = Some(flow);
                }
                self.publish();
            }
        }
    }

    /// Has the reverse pair of `run` run by a task of its own if `look` shows the check with it; one at a time.
    fn check(&self, run: &Run, look: &Look, available: &AvailableLayers) {
        let is_wanted = available.layer(look.layer) == FlowLayer::Consistency && run.backward.is_none();
        let stop = Stop::default();
        {
            let mut mailbox = self.shared.mailbox();
            if !is_wanted || std::mem::replace(&mut mailbox.view.checking, true) {
                return;
            }
            mailbox.stop_check = stop.clone();
        }
        let (subject, clip, shared) = (Arc::clone(&run.subject), run.clip.clone().until(stop), Arc::clone(self.shared));
        let check = async move || {
            let Experiment { estimator, frame, .. } = &subject.experiment;
            let flow = work::caught(backward(&**estimator, &clip, *frame)).await;
            let flow = flow.unwrap_or_else(|panic| Err(panicked(panic.as_ref())));
            shared.mailbox().backward = Some((subject, flow));
            shared.wake.notify();
        };
        if work::spawn("backward", check).is_err() {
            self.shared.mailbox().view.checking = false;
        }
    }

    /// Has a check that failed, or was given up, be tried anew when it is chosen the next time.
    fn forget_failed_check(&mut self) {
        let is_wanted = self.shared.mailbox().look.layer == Some(FlowLayer::Consistency);
        if let Some(run) = self.run.as_mut().filter(|run| !is_wanted && matches!(run.backward, Some(Err(_)))) {
            run.backward = None;
        }
    }

    /// Starts a run; gives whether it stands at its place. The old one is gone, whatever comes of the new one.
    async fn open(&mut self, Job { subject, place }: Job) -> Result<bool, Error> {
        // A pixel stays held when parameters change, but not in another clip.
        let other = self.run.take().is_some_and(|run| run.clip.info().name != subject.clip.info().name);
        self.held = match place.hold {
            // In another run an object has another identity.
            Hold::Kept => self.held.filter(|_| !other).map(|focus| Focus { object: None, ..focus }),
            Hold::Set(held) => held.map(Held::focus),
        };
        let clip = subject.clip.clone().until(self.shared.stop.clone());
        self.announce(&subject, &clip)?;
        let mut pairs = LastPair::default();
        let mut walk = subject.experiment.walk(&clip)?;
        let pair = pairs.of(&*walk, &clip)?.clone();
        let Place { mut cursor, near, .. } = place;
        match near {
            Near::Same => {}
            Near::Pixel(focus) if cursor.event == 0 => cursor = first_step(&*walk, focus).unwrap_or(cursor),
            Near::Pixel(focus) => cursor.unit = walk.unit_at(focus).unwrap_or(cursor.unit),
            Near::Interest => cursor = opening(&*walk, &clip, subject.experiment.frame).unwrap_or(cursor),
        }
        // The unit of a search is short. A candidate outside the new search window keeps the number of its event.
        if let Some(event) = place.candidate.and_then(|candidate| event_of(&mut *walk, cursor, candidate)) {
            cursor.event = event;
        }
        self.run = Some(Run {
            subject,
            walk,
            clip,
            pairs,
            pair,
            end: OnceCell::new(),
            superseded: self.shared.superseded.clone(),
            backward: None,
            motion: RefCell::default(),
            is_brief: Cell::new(false),
            named: LastNamed::default(),
            focus: Cell::new(None),
        });
        Ok(cursor == Cursor::default() || self.travel(Move::To(cursor)).await)
    }

    /// Has what is known of a run at hand before it has anything to show.
    fn announce(&self, subject: &Arc<Prepared>, clip: &Clip) -> Result<(), Error> {
        self.shared.mailbox().view.phase = Phase::Starting;
        let coming = Arc::new(preview(subject, clip)?);
        self.shared.mailbox().view.coming = Some(coming);
        Ok(())
    }

    pub(super) async fn go(&mut self, to: Move) {
        if self.travel(to).await && self.pass_idle(to).await {
            self.publish();
        }
    }

    /// Goes on with a small move as long as nothing happens where it leads; gives whether it is done.
    async fn pass_idle(&mut self, to: Move) -> bool {
        let is_idle = |worker: &Self| worker.run.as_ref().is_some_and(|run| run.walk.is_idle() && !run.walk.at_end());
        while matches!(to, Move::Granularity(..)) && is_idle(self) {
            let before = self.run.as_ref().map(|run| run.walk.cursor());
            if !self.travel(to).await {
                return false;
            }
            if before == self.run.as_ref().map(|run| run.walk.cursor()) {
                break;
            }
        }
        true
    }

    async fn go_at(&mut self, focus: Focus, side: Side) {
        let Some(run) = &self.run else { return };
        // Where nothing is found at that pixel, the move that this one replaced has ended where the run stands.
        let here = run.walk.cursor();
        let to = match (run.walk.explained(focus), run.walk.unit_at(focus)) {
            (Some(explained), _) => {
                self.held = Some(Focus { object: run.walk.object_at(focus), ..focus });
                if let Explained::From(turn) = explained { turn.max(here) } else { here }
            }
            (None, Some(unit)) if side == Side::Start => Cursor { unit, event: usize::from(unit > 0) },
            (None, Some(unit)) => Cursor { unit, event: usize::MAX },
            (None, None) => here,
        };
        self.go(Move::To(to)).await;
    }

    async fn go_to_candidate(&mut self, candidate: [i32; 2]) {
        let Some(run) = &mut self.run else { return };
        let Cursor { unit, .. } = run.walk.cursor();
        // In lockstep each search tests it, or not, at a step of its own.
        let is_alone = run.walk.beside(None).is_empty();
        let event = is_alone.then(|| event_of(&mut *run.walk, Cursor { unit, event: 0 }, candidate)).flatten();
        self.go(Move::To(Cursor { unit, event: event.unwrap_or(usize::MAX) })).await;
    }

    /// The pixel or the object that was clicked, where it can be explained.
    fn held(&self) -> Option<Focus> {
        let (held, run) = (self.held?, self.run.as_ref()?);
        // An object is selected wherever it goes, and not before it is there.
        place_of(&*run.walk, held).filter(|at| is_explained(&*run.walk, *at))
    }

    /// Works on a move until it is done or replaced by a newer request; returns whether it is done. A long move is shown on its way.
    pub(super) async fn travel(&mut self, to: Move) -> bool {
        self.shared.mailbox().view.phase = Phase::Running;
        let Some(mut long_move) = self.run.as_ref().map(|run| LongMove::new(run, to)) else { return false };
        loop {
            match self.leg(&mut long_move).await {
                Leg::NotWanted => return false,
                Leg::There => break,
                Leg::Part => {
                    let begun = Instant::now();
                    if !self.turn() {
                        return false;
                    }
                    self.show(long_move.goal);
                    work::breathe().await;
                    long_move.go_on(begun.elapsed());
                }
            }
        }
        if !self.turn() {
            return false;
        }
        // The end is seen before its figures, which may take as long as the run.
        if self.run.as_ref().is_some_and(|run| run.walk.at_end() && run.end.get().is_none()) {
            let is_brief = self.run.as_ref().is_some_and(|run| run.is_brief.replace(true));
            self.show(None);
            self.run.iter().for_each(|run| run.is_brief.set(is_brief));
        }
        true
    }

    /// Goes the next part of a way.
    async fn leg(&mut self, long_move: &mut LongMove) -> Leg {
        let Some(run) = &mut self.run else { return Leg::NotWanted };
        let shared = self.shared;
        let asked = long_move.begun;
        let wanted = || asked.elapsed() < SLOW_AFTER || !shared.superseded.is_set();
        let begun = Instant::now();
        run.walk.go(long_move.next);
        loop {
            let slice = Instant::now();
            if run.walk.work(&mut || slice.elapsed() < work::SLICE && wanted()) {
                let at = run.walk.cursor();
                if long_move.comes_to(at, run.walk.at_end(), begun.elapsed()) {
                    return Leg::There;
                }
                // A part of one unit has no slices in which it could be stopped.
                shared.mailbox().view.progress = long_move.reached();
                return if wanted() { Leg::Part } else { Leg::NotWanted };
            }
            if !wanted() {
                return Leg::NotWanted;
            }
            let progress = run.walk.progress();
            shared.mailbox().view.progress = long_move.progress(progress);
            (shared.changed)();
            if let Some(reached) = long_move.breaks_off(begun.elapsed(), progress) {
                run.walk.go(reached);
            }
            work::breathe().await;
        }
    }

    /// Takes the frames of the place where the run stands; gives whether they can be read.
    fn turn(&mut self) -> bool {
        let turned = self.run.as_mut().map_or(Ok(()), Run::turn);
        turned.map_err(|error| self.refuse(error)).is_ok()
    }

    pub(super) fn publish(&self) {
        if self.run.is_some() {
            self.show(None);
            let mut mailbox = self.shared.mailbox();
            mailbox.view.refused = None;
            mailbox.view.progress = None;
        }
    }

    /// Shows where the run stands, if it is on its way to `bound_for`.
    fn show(&self, bound_for: Option<Cursor>) {
        let Some(run) = &self.run else { return };
        let (focus, look) = {
            let mut mailbox = self.shared.mailbox();
            (mailbox.focus_moved, mailbox.look_changed) = (false, false);
            (mailbox.focus, mailbox.look)
        };
        let held = self.held();
        let pointed =
            held.or(focus.filter(|at| is_explained(&*run.walk, *at))).map(|at| Pointed { at, is_held: held.is_some() });
        if run.walk.at_end() {
            self.shared.mailbox().view.phase = Phase::Measuring;
        }
        let before = self.shared.mailbox().view.shown.clone();
        let mut shown = Snapshot { pointed, bound_for, ..run.snapshot(held.or(focus), &look, before.as_deref()) };
        // Equal scenes are shared, so that they are not painted again.
        if let Some(before) = before {
            let Moment { scene, tiles, .. } = &mut shown.moment;
            let tiles = tiles.iter_mut().zip(&before.tiles).map(|(now, then)| (&mut now.scene, &then.scene));
            for (now, then) in [(scene, &before.scene)].into_iter().chain(tiles) {
                if then.same(now) {
                    *now = Arc::clone(then);
                }
            }
        }
        self.check(run, &look, &shown.available);
        let mut mailbox = self.shared.mailbox();
        mailbox.view.shown = Some(Arc::new(shown));
        mailbox.view.coming = None;
        drop(mailbox);
        (self.shared.changed)();
    }

    fn refuse(&self, error: Error) {
        self.shared.mailbox().view.refused = Some(error);
        (self.shared.changed)();
    }
}

/// How far a part of a move has come.
enum Leg {
    /// To where the move leads.
    There,
    /// Some of the way.
    Part,
    /// To no end: a newer request has replaced the move.
    NotWanted,
}

fn panicked(panic: &(dyn std::any::Any + Send)) -> Error {
    let said = panic.downcast_ref::<String>().map(String::as_str);
    let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
    Error::new(format!(
        "the run failed ({said}); change a parameter or the clip to restart it, and please report this error"
    ))
}
