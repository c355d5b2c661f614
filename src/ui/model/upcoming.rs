//! The moment after the present one: worked out on a run of its own, so that the one that is shown does not move.
//!
//! There is such a run only as long as an [`Upcoming`] exists: nothing is worked out that is not looked at.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use motionscope_core::base::{Error, Stop};
use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::{Focus, Sentence, Step};

use super::snapshot::Snapshot;
use crate::experiment::Prepared;
use crate::experiment::pixel::is_explained;
use crate::experiment::travel::travel;
use crate::work::{self, Signal};

/// The step after one that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Next {
    /// Its place in the run.
    pub cursor: Cursor,
    /// What it explains.
    pub step: Arc<Step>,
}

impl Next {
    /// Returns the sentence of the step.
    pub fn sentence(&self) -> &Sentence {
        &self.step.sentence
    }
}

/// The step whose next one is wanted.
#[derive(Clone)]
struct Wanted {
    subject: Arc<Prepared>,
    cursor: Cursor,
    /// The pixel that is held.
    focus: Option<Focus>,
    /// The innermost granularity.
    granularity: usize,
}

impl Wanted {
    fn of(shown: &Snapshot) -> Self {
        let focus = shown.pointed.filter(|pointed| pointed.is_held).map(|pointed| pointed.at);
        let granularity = shown.info.granularities.len() - 1;
        Self { subject: Arc::clone(&shown.subject), cursor: shown.cursor, focus, granularity }
    }

    fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.subject, &other.subject) && self.cursor == other.cursor && self.focus == other.focus
    }
}

#[derive(Default)]
struct Mailbox {
    /// What is wanted and not yet in hand.
    wanted: Option<Wanted>,
    /// What is in hand.
    working: Option<Wanted>,
    /// What was found last, and after which step; no step where the run ends.
    found: Option<(Wanted, Result<Option<Next>, Error>)>,
    quit: bool,
}

impl Mailbox {
    fn is_asked(&self, wanted: &Wanted) -> bool {
        let newest = self.wanted.as_ref().or(self.working.as_ref());
        newest.or(self.found.as_ref().map(|(of, _)| of)).is_some_and(|known| known.is_same(wanted))
    }
}

struct Shared {
    mailbox: Mutex<Mailbox>,
    wake: Signal,
    /// The work in hand is not wanted any more.
    superseded: Stop,
    /// No frames need to be decoded any more.
    stop: Stop,
    changed: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A task that knows the step after the one that is shown.
pub struct Upcoming(Arc<Shared>);

impl Upcoming {
    /// Starts the task; `changed` is called by it whenever a step was found.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(changed: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            mailbox: Mutex::default(),
            wake: Signal::default(),
            superseded: Stop::default(),
            stop: Stop::default(),
            changed: Box::new(changed),
        });
        let worker = Arc::clone(&shared);
        work::spawn("upcoming", async move || Worker::default().run(&worker).await)?;
        Ok(Self(shared))
    }

    /// Has the step after `shown` worked out, in place of any other.
    pub fn ask(&self, shown: &Snapshot) {
        let wanted = Wanted::of(shown);
        let mut mailbox = self.0.mailbox();
        if !mailbox.is_asked(&wanted) {
            mailbox.wanted = Some(wanted);
            self.0.superseded.set(true);
            drop(mailbox);
            self.0.wake.notify();
        }
    }

    /// Returns the step after `shown` once it is known; no step at the end of the run.
    pub fn after(&self, shown: &Snapshot) -> Option<Result<Option<Next>, Error>> {
        let mailbox = self.0.mailbox();
        let (of, next) = mailbox.found.as_ref()?;
        of.is_same(&Wanted::of(shown)).then(|| next.clone())
    }

    /// Waits until nothing is left to do, for tests.
    pub fn wait(&self) {
        let is_busy = |mailbox: MutexGuard<'_, Mailbox>| mailbox.wanted.is_some() || mailbox.working.is_some();
        while is_busy(self.0.mailbox()) {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }
}

impl Drop for Upcoming {
    fn drop(&mut self) {
        self.0.mailbox().quit = true;
        self.0.superseded.set(true);
        self.0.stop.set(true);
        self.0.wake.notify();
    }
}

/// The run that is one step ahead.
#[derive(Default)]
struct Worker {
    run: Option<(Arc<Prepared>, Box<dyn Walk>)>,
}

impl Worker {
    async fn run(mut self, shared: &Shared) {
        while let Some(wanted) = shared.wake.until(|| next_task(shared)).await {
            let found = work::caught(self.find(&wanted, shared)).await;
            let failed = || Error::new("the computation broke off; close the presenter's window and open it again");
            let found = found.unwrap_or_else(|_| {
                self.run = None;
                Some(Err(failed()))
            });
            let mut mailbox = shared.mailbox();
            mailbox.working = None;
            if let Some(found) = found {
                mailbox.found = Some((wanted, found));
                drop(mailbox);
                (shared.changed)();
            }
        }
    }

    /// The step after `wanted`; nothing where another one is wanted more.
    async fn find(&mut self, wanted: &Wanted, shared: &Shared) -> Option<Result<Option<Next>, Error>> {
        if self.run.as_ref().is_none_or(|(subject, _)| !Arc::ptr_eq(subject, &wanted.subject)) {
            // The memory of the old run is given back before a new one takes its own.
            self.run = None;
            let clip = wanted.subject.clip.clone().until(shared.stop.clone());
            match wanted.subject.experiment.walk(&clip) {
                Ok(walk) => self.run = Some((Arc::clone(&wanted.subject), walk)),
                Err(why) => return Some(Err(why)),
            }
        }
        let (_, walk) = self.run.as_mut()?;
        step_after(&mut **walk, wanted, &shared.superseded).await
    }
}

/// Goes to the step after `wanted`, as a key press does, which passes over steps at which nothing happens.
async fn step_after(walk: &mut dyn Walk, wanted: &Wanted, superseded: &Stop) -> Option<Result<Option<Next>, Error>> {
    let is_wanted = || !superseded.is_set();
    if walk.cursor() != wanted.cursor && !travel(walk, Move::To(wanted.cursor), &is_wanted).await {
        return None;
    }
    if walk.at_end() {
        return Some(Ok(None));
    }
    let on = Move::Granularity(wanted.granularity, Direction::Forward);
    loop {
        let before = walk.cursor();
        if !travel(walk, on, &is_wanted).await {
            return None;
        }
        if !walk.is_idle() || walk.at_end() || walk.cursor() == before {
            break;
        }
    }
    if let Some(failure) = walk.failure() {
        return Some(Err(failure.clone()));
    }
    let focus = wanted.focus.filter(|at| is_explained(walk, *at));
    Some(Ok(Some(Next { cursor: walk.cursor(), step: Arc::new(walk.step(focus)) })))
}

/// The next thing to do, if there is one; `Some(None)` at the end.
fn next_task(shared: &Shared) -> Option<Option<Wanted>> {
    let mut mailbox = shared.mailbox();
    if mailbox.quit {
        return Some(None);
    }
    let wanted = mailbox.wanted.take()?;
    mailbox.working = Some(wanted.clone());
    shared.superseded.set(false);
    Some(Some(wanted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::experiment::source::Source;
    use crate::media::Open;
    use crate::ui::model::snapshot::{Job, Place};
    use crate::ui::model::walker::Walker;

    fn walker() -> Walker {
        let source = Source::parse("synth:pillar,width=64,height=48,frames=3").unwrap_or_else(|why| panic!("{why}"));
        let prepared = Prepared::open(Experiment::first(source), Open::default());
        let subject = Arc::new(prepared.unwrap_or_else(|why| panic!("{why}")));
        let walker = Walker::new(|| {}).expect("a thread");
        walker.start(Job { subject, place: Place::default() });
        walker.wait();
        walker
    }

    fn shown(walker: &Walker) -> Arc<Snapshot> {
        walker.wait();
        walker.view().shown.expect("a run is shown")
    }

    #[test]
    fn the_next_step_is_the_one_that_comes() {
        let (walker, upcoming) = (walker(), Upcoming::new(|| {}).expect("a thread"));
        for _ in 0..6 {
            let before = shown(&walker);
            upcoming.ask(&before);
            upcoming.wait();
            let next = upcoming.after(&before).and_then(Result::ok).flatten().expect("there is one");
            assert_eq!(shown(&walker).cursor, before.cursor, "what is shown has not moved");
            walker.go(Move::Granularity(before.info.granularities.len() - 1, Direction::Forward));
            let now = shown(&walker);
            assert_eq!((next.cursor, next.sentence().plain()), (now.cursor, now.step.sentence.plain()));
        }
        walker.go(Move::End);
        let end = shown(&walker);
        assert!(upcoming.after(&end).is_none(), "it was not asked for");
        upcoming.ask(&end);
        upcoming.wait();
        assert_eq!(upcoming.after(&end), Some(Ok(None)));
    }

    #[test]
    fn the_newest_request_is_served() {
        let (walker, upcoming) = (walker(), Upcoming::new(|| {}).expect("a thread"));
        let first = shown(&walker);
        walker.go(Move::To(Cursor { unit: 3, event: 2 }));
        let second = shown(&walker);
        for _ in 0..3 {
            upcoming.ask(&first);
            upcoming.ask(&second);
        }
        upcoming.wait();
        assert!(upcoming.after(&first).is_none() && upcoming.after(&second).is_some());
    }
}
