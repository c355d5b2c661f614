//! A run on its own thread: moves go in, immutable pictures of the run come out.
//!
//! Nothing here knows the window. A request never waits for an earlier one that takes long: it replaces it. What cannot be
//! interrupted is left behind: another thread takes over, with what was shown last, and the old one ends when it can.

mod long_move;
mod marks;

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use long_move::LongMove;
pub use marks::Marks;
use motionscope_core::scene::{Focus, Picture};
use motionscope_core::{Clip, Cursor, Direction, Error, Explained, Flow, Move, Output, Stop, Walk};

use super::preview::{preview, stopped};
use super::snapshot::{Hold, Job, Place, Pointed, Snapshot, event_of};
use crate::experiment::pixel::{Held, is_explained, place_of, walks_pixels};
use crate::experiment::{Experiment, Prepared};
use crate::paint::{FlowLayer, Pictures};
use crate::ui::app::action::Side;
use crate::view::look::Look;
use crate::view::moment::{End, LastPair, Moment, RunView};
use crate::view::motion::{AvailableLayers, Motion, Site, backward};
use crate::view::named::LastNamed;

/// A move that works longer than this gives way to the next request; less, and a drag would never arrive anywhere.
const SLOW_AFTER: Duration = Duration::from_millis(60);
/// How often a long move tells how far it is.
const NEWS: Duration = Duration::from_millis(30);
/// How long work may go on after it was stopped before it is left behind.
const GRACE: Duration = Duration::from_millis(250);
/// So many threads that were left behind may be at work when another run is started.
const LEFT: usize = 2;
/// Small moves that may wait: more would make a held key run on after it is let go.
const QUEUE: usize = 4;

/// What the walker shows and does just now.
#[derive(Clone, Default)]
pub struct View {
    /// The newest picture of the run; it stays when a new run is refused.
    pub shown: Option<Arc<Snapshot>>,
    /// Why the newest run could not be started.
    pub refused: Option<Error>,
    /// Whether something is being worked on.
    pub busy: bool,
    /// Units done of those that a long move needs.
    pub progress: Option<(usize, usize)>,
    /// Whether the reverse pair is being run.
    pub checking: bool,
    /// What is being done.
    pub phase: Phase,
    /// Whether it is to stop.
    pub stopping: bool,
    /// For how long it has been.
    pub busy_for: Option<Duration>,
    /// Frames read of those that the frame which is wanted needs.
    pub reading: Option<(usize, usize)>,
    /// What is known of a run that has nothing to show yet.
    pub coming: Option<Arc<Snapshot>>,
}

/// What is being done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// A run is begun.
    #[default]
    Starting,
    /// A run is on its way.
    Running,
    /// What it has come to is worked out.
    Measuring,
}

type Visit = Box<dyn FnOnce(&Arc<Prepared>, &dyn Walk) + Send>;

enum Request {
    Go(Move),
    /// To the end or the start of the unit whose result lies at a pixel, or to that pixel itself.
    GoAt(Focus, Side),
    /// To the event of the unit at hand that tests a displacement, or to the end of the unit.
    GoToCandidate([i32; 2]),
    /// To the next step in this direction that is marked on the timeline, or to the end of the run on that side.
    GoToMark(Direction, Marks),
    /// No pixel is held any longer.
    Release,
    /// To where the run stands, whatever it was on its way to.
    Stay,
    Visit(Visit),
}

/// The mailbox between the window and the worker.
#[derive(Default)]
struct Mailbox {
    job: Option<Job>,
    /// What was run when the work was left behind: it is taken up where it was when somebody wants to go on.
    dormant: Option<Job>,
    /// What is run, or about to be.
    subject: Option<Arc<Prepared>>,
    /// When the work at hand was to stop, or another job was laid on the mailbox.
    unwanted: Option<Instant>,
    /// A job is on the mailbox or in hand: small moves wait until it stands at its place.
    starting: bool,
    requests: VecDeque<Request>,
    focus: Option<Focus>,
    look: Look,
    /// Another pixel is to be explained.
    focus_moved: bool,
    /// Something else of the step is to be seen.
    look_changed: bool,
    /// The flow of the reverse pair of a run, when it has come.
    backward: Option<(Arc<Prepared>, Result<Flow, Error>)>,
    /// Ends the run of the reverse pair at its next chance.
    stop_check: Stop,
    since: Option<Instant>,
    quit: bool,
    view: View,
}

struct Shared {
    mailbox: Mutex<Mailbox>,
    wake: Condvar,
    idle: Condvar,
    /// The move at work is to be given up.
    superseded: Stop,
    /// Frames need not be decoded any further: the run that wants them is not wanted itself.
    stop: Stop,
    changed: Changed,
}

type Changed = Arc<dyn Fn() + Send + Sync>;

impl Shared {
    fn new(changed: Changed) -> Self {
        Self {
            mailbox: Mutex::default(),
            wake: Condvar::new(),
            idle: Condvar::new(),
            superseded: Stop::default(),
            stop: Stop::default(),
            changed,
        }
    }

    fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A run that is walked on a thread of its own.
pub struct Walker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// Threads whose work was left behind.
    left: Vec<JoinHandle<()>>,
}

impl Walker {
    /// A walker without a run; `changed` is called from its thread whenever [`Walker::view`] has news.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(changed: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::new(Arc::new(changed)));
        let thread = spawn(&shared)?;
        Ok(Self { shared, thread: Some(thread), left: Vec::new() })
    }

    /// Starts another run; the picture of the old one stays until the new one has something to show.
    pub fn start(&self, job: Job) {
        self.ask(true, |mailbox| {
            self.shared.stop.set(true);
            mailbox.stop_check.set(true);
            mailbox.requests.clear();
            mailbox.starting = true;
            mailbox.dormant = None;
            mailbox.unwanted = mailbox.unwanted.or(mailbox.since.map(|_| Instant::now()));
            let is_other = |subject: &Arc<Prepared>| !std::ptr::eq(subject.clip.info(), job.subject.clip.info());
            if mailbox.subject.as_ref().is_none_or(is_other) {
                // What was wrong with another clip is no news of this one.
                (mailbox.view.refused, mailbox.view.coming) = (None, None);
            }
            mailbox.subject = Some(Arc::clone(&job.subject));
            mailbox.job = Some(job);
        });
    }

    /// Leaves work behind that goes on although it was stopped, or stands in the way of another run. To be called now and
    /// then as long as the walker is busy.
    pub fn tend(&mut self) {
        self.left.retain(|thread| !thread.is_finished());
        let is_stuck = {
            let mailbox = self.shared.mailbox();
            let is_late = mailbox.unwanted.is_some_and(|since| since.elapsed() > GRACE);
            is_late && mailbox.since.is_some() && (mailbox.job.is_none() || self.left.len() < LEFT)
        };
        if is_stuck {
            self.leave();
        }
    }

    /// Another thread takes over, which knows what was shown last.
    fn leave(&mut self) {
        let shared = Arc::new(Shared::new(Arc::clone(&self.shared.changed)));
        let Ok(thread) = spawn(&shared) else { return };
        let old = std::mem::replace(&mut self.shared, Arc::clone(&shared));
        self.left.extend(self.thread.replace(thread));
        let mut old_mailbox = old.mailbox();
        old.stop.set(true);
        old.superseded.set(true);
        old_mailbox.stop_check.set(true);
        old_mailbox.quit = true;
        let mut mailbox = shared.mailbox();
        let shown = old_mailbox.stopped();
        let subject = old_mailbox.subject.take();
        (mailbox.job, mailbox.starting) = (old_mailbox.job.take(), old_mailbox.starting);
        if mailbox.job.is_none() {
            let place = |shown: &Snapshot| Place { hold: Hold::Set(shown.held()), ..Place::at(shown.cursor) };
            let job = |subject| Job { place: shown.as_deref().map_or(Place::default(), place), subject };
            (mailbox.dormant, mailbox.starting) = (subject.clone().map(job), false);
        }
        (mailbox.focus, mailbox.look, mailbox.subject) = (old_mailbox.focus, old_mailbox.look, subject);
        let refused = (shown.is_none() && mailbox.job.is_none()).then(|| {
            Error::new(
                "the run was cancelled before its frames were decoded; change a parameter or the frame to restart it",
            )
        });
        mailbox.view = View { shown, refused, busy: mailbox.job.is_some(), ..View::default() };
        drop(old_mailbox);
        drop(mailbox);
        shared.wake.notify_one();
        (shared.changed)();
    }

    /// Asks for a move. One to a place replaces all others; small moves queue up unless one takes long. A run that
    /// starts comes to its place before a small move goes on from there.
    pub fn go(&self, to: Move) {
        let mut mailbox = self.shared.mailbox();
        mailbox.take_up();
        let slow = !mailbox.starting && mailbox.since.is_some_and(|since| since.elapsed() > SLOW_AFTER);
        let replaces = slow || !matches!(to, Move::Granularity(..));
        if !replaces && mailbox.requests.len() >= QUEUE {
            return;
        }
        if replaces {
            mailbox.requests.retain(|request| matches!(request, Request::Visit(_)));
        }
        mailbox.requests.push_back(Request::Go(to));
        self.wake(mailbox, replaces);
    }

    /// Goes to the end or the start of the unit whose result lies at pixel `point` of frame t. Where single pixels are
    /// explained, that one is from now on, until the run moves on to others; if its turn has not come, the run goes there.
    pub fn go_at(&self, focus: Focus, side: Side) {
        self.ask(true, |mailbox| {
            mailbox.take_up();
            mailbox.requests.push_back(Request::GoAt(focus, side));
        });
    }

    /// Goes to the event of the unit at hand that tests the displacement `candidate`, in px; if none does, to the end of the unit.
    pub fn go_to_candidate(&self, candidate: [i32; 2]) {
        self.ask(true, |mailbox| {
            mailbox.take_up();
            mailbox.requests.push_back(Request::GoToCandidate(candidate));
        });
    }

    /// Goes to the next step in the direction `way` that is marked on the timeline, of these marks; where none is, to that end of the run.
    pub fn go_to_mark(&self, way: Direction, marks: Marks) {
        self.ask(true, |mailbox| {
            mailbox.take_up();
            mailbox.requests.push_back(Request::GoToMark(way, marks));
        });
    }

    /// Gives up the move at work, and the check with the reverse pair; the run stays where it stands, a new one at its start.
    pub fn stop(&self) {
        self.ask(true, |mailbox| {
            mailbox.stop_check.set(true);
            mailbox.requests.retain(|request| matches!(request, Request::Visit(_)));
            mailbox.requests.push_front(Request::Stay);
            mailbox.unwanted = mailbox.unwanted.or(mailbox.since.map(|_| Instant::now()));
            if let Some(job) = &mut mailbox.job {
                job.place = Place { hold: job.place.hold, ..Place::default() };
            }
        });
    }

    /// Explains the pixel `focus` from now on.
    pub fn focus(&self, focus: Option<Focus>) {
        if self.shared.mailbox().focus != focus {
            self.ask(false, |mailbox| {
                mailbox.focus = focus;
                mailbox.focus_moved = true;
            });
        }
    }

    /// Explains the pixel at work again, or the one pointed at.
    pub fn release(&self) {
        self.ask(false, |mailbox| mailbox.requests.push_back(Request::Release));
    }

    /// Shows what `look` does from now on, as far as that is worked out before it is drawn.
    pub fn look(&self, look: &Look) {
        if !self.shared.mailbox().look.shows_same_step(look) {
            self.ask(false, |mailbox| {
                mailbox.look = *look;
                mailbox.look_changed = true;
            });
        }
    }

    /// Has `visit` look at the run, on the walker's thread, after what was asked for before.
    pub fn visit(&self, visit: impl FnOnce(&Arc<Prepared>, &dyn Walk) + Send + 'static) {
        self.ask(false, |mailbox| {
            mailbox.take_up();
            mailbox.requests.push_back(Request::Visit(Box::new(visit)));
        });
    }

    /// What the run amounts to where `shown` shows it; nothing comes if it has moved on or was replaced.
    pub fn output(&self, shown: &Snapshot) -> Receiver<Output> {
        let (sender, receiver) = channel();
        let (wanted, cursor) = (Arc::clone(&shown.subject), shown.cursor);
        self.visit(move |subject, walk| {
            if Arc::ptr_eq(subject, &wanted) && walk.cursor() == cursor {
                // Whoever asked may have gone.
                sender.send(walk.output()).ok();
            }
        });
        receiver
    }

    /// What there is to show just now.
    pub fn view(&self) -> View {
        let mailbox = self.shared.mailbox();
        let busy_for = mailbox.since.filter(|_| mailbox.view.busy).map(|since| since.elapsed());
        let stopping = mailbox.unwanted.is_some() && mailbox.job.is_none();
        View {
            busy_for,
            stopping,
            reading: self.shared.stop.progress().filter(|_| mailbox.view.busy),
            ..mailbox.view.clone()
        }
    }

    /// Waits until nothing is left to do.
    pub fn wait(&self) {
        while !self.wait_for(Duration::MAX) {}
    }

    /// Waits until nothing is left to do, but no longer than that; gives whether nothing is.
    pub fn wait_for(&self, longest: Duration) -> bool {
        let is_busy = |mailbox: &mut Mailbox| mailbox.view.busy || mailbox.view.checking;
        let waited = self.shared.idle.wait_timeout_while(self.shared.mailbox(), longest, is_busy);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    fn ask(&self, replaces: bool, put: impl FnOnce(&mut Mailbox)) {
        let mut mailbox = self.shared.mailbox();
        put(&mut mailbox);
        self.wake(mailbox, replaces);
    }

    fn wake(&self, mut mailbox: MutexGuard<'_, Mailbox>, replaces: bool) {
        mailbox.view.busy = true;
        if replaces {
            self.shared.superseded.set(true);
        }
        self.shared.wake.notify_one();
    }
}

impl Drop for Walker {
    fn drop(&mut self) {
        self.ask(true, |mailbox| {
            self.shared.stop.set(true);
            mailbox.stop_check.set(true);
            mailbox.quit = true;
        });
        // Whatever cannot be interrupted ends with the program.
        let asked = Instant::now();
        if let Some(thread) = self.thread.take() {
            while !thread.is_finished() && asked.elapsed() < GRACE {
                std::thread::sleep(Duration::from_millis(1));
            }
            if thread.is_finished() {
                // A worker that panicked has nothing left to tell.
                let _ = thread.join();
            }
        }
    }
}

fn spawn(shared: &Arc<Shared>) -> std::io::Result<JoinHandle<()>> {
    let shared = Arc::clone(shared);
    std::thread::Builder::new().name("walker".into()).spawn(move || Worker::new(&shared).run())
}

impl Mailbox {
    /// Somebody wants to go on: what was left behind is run again.
    fn take_up(&mut self) {
        if let Some(job) = self.dormant.take() {
            (self.job, self.starting) = (Some(job), true);
        }
    }

    /// What is to be seen of the run at hand, if it is left behind now: how far it has come, or what was known before.
    fn stopped(&mut self) -> Option<Arc<Snapshot>> {
        let is_ours =
            |shown: &Arc<Snapshot>| self.subject.as_ref().is_some_and(|ours| Arc::ptr_eq(ours, &shown.subject));
        let (shown, coming) = (self.view.shown.take(), self.view.coming.take());
        match (shown, coming.filter(is_ours)) {
            // Another run is about to begin; until then the old picture stays.
            (shown, _) if self.job.is_some() => shown,
            (Some(shown), _) if is_ours(&shown) => {
                Some(Arc::new(Snapshot { bound_for: None, ..Snapshot::clone(&shown) }))
            }
            (_, Some(coming)) => Some(Arc::new(stopped(&coming))),
            (shown, None) => shown,
        }
    }
}

/// What was seen of motion, and what that depends on.
struct SeenMotion {
    cursor: Cursor,
    look: Look,
    /// Whether the reverse pair is known.
    is_checked: bool,
    motion: Motion,
}

/// A run at work.
struct Run {
    subject: Arc<Prepared>,
    walk: Box<dyn Walk>,
    clip: Clip,
    pairs: LastPair,
    pair: Pictures,
    /// What the whole run amounts to, once its end was reached.
    end: OnceCell<Option<End>>,
    /// Set while another request waits.
    superseded: Stop,
    /// The flow of the reverse pair, once it was asked for.
    backward: Option<Result<Flow, Error>>,
    /// What was seen of motion last.
    motion: RefCell<Option<SeenMotion>>,
    /// What takes long to work out at the end is not shown yet.
    is_brief: Cell<bool>,
    /// The pictures of the step that was shown last.
    named: LastNamed,
    /// The pixel that was asked for when it was shown.
    focus: Cell<Option<Focus>>,
}

enum Task {
    Start(Job),
    Request(Request),
    Look,
    Focus,
    Backward(Arc<Prepared>, Result<Flow, Error>),
}

struct Worker<'a> {
    shared: &'a Arc<Shared>,
    run: Option<Run>,
    /// The pixel that was clicked.
    held: Option<Focus>,
}

impl<'a> Worker<'a> {
    fn new(shared: &'a Arc<Shared>) -> Self {
        Self { shared, run: None, held: None }
    }

    fn run(mut self) {
        while let Some(task) = self.next_task() {
            let outcome = catch_unwind(AssertUnwindSafe(|| self.serve(task)));
            if let Err(panic) = outcome {
                self.run = None;
                self.refuse(panicked(panic.as_ref()));
            }
        }
    }

    /// The next thing to do, or `None` at the end of the session.
    fn next_task(&self) -> Option<Task> {
        let mut mailbox = self.shared.mailbox();
        mailbox.since = None;
        loop {
            if mailbox.quit {
                return None;
            }
            let job = mailbox.job.take().map(Task::Start);
            self.shared.stop.set(false);
            if job.is_some() || !mailbox.requests.is_empty() {
                self.shared.superseded.set(false);
            }
            let task = job.or_else(|| mailbox.requests.pop_front().map(Task::Request));
            if task.is_some() {
                (mailbox.since, mailbox.unwanted) = (Some(Instant::now()), None);
                return task;
            }
            if let Some((subject, flow)) = mailbox.backward.take() {
                mailbox.view.checking = false;
                mailbox.view.busy = true;
                (mailbox.since, mailbox.unwanted) = (Some(Instant::now()), None);
                return Some(Task::Backward(subject, flow));
            }
            if std::mem::take(&mut mailbox.look_changed) {
                (mailbox.since, mailbox.unwanted) = (Some(Instant::now()), None);
                return Some(Task::Look);
            }
            if std::mem::take(&mut mailbox.focus_moved) {
                (mailbox.since, mailbox.unwanted) = (Some(Instant::now()), None);
                return Some(Task::Focus);
            }
            let was_busy = std::mem::replace(&mut mailbox.view.busy, false) | mailbox.view.progress.take().is_some();
            self.shared.idle.notify_all();
            if was_busy {
                (self.shared.changed)();
            }
            mailbox = self.shared.wake.wait(mailbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn serve(&mut self, task: Task) {
        match task {
            Task::Start(job) => {
                let opened = self.open(job);
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
                self.go(to);
            }
            Task::Request(Request::GoAt(focus, side)) => self.go_at(focus, side),
            Task::Request(Request::GoToCandidate(candidate)) => self.go_to_candidate(candidate),
            Task::Request(Request::GoToMark(way, marks)) => self.go_to_mark(way, marks),
            Task::Request(Request::Release) => {
                if self.held.take().is_some() {
                    self.publish();
                }
            }
            Task::Request(Request::Stay) => {
                // Figures of the end that were given up are not measured again.
                self.run.iter().for_each(|run| run.is_brief.set(true));
                if let Some(cursor) = self.run.as_ref().map(|run| run.walk.cursor()) {
                    self.go(Move::To(cursor));
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

    /// Has the reverse pair of `run` run on a thread of its own if `look` shows the check with it; one at a time.
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
        let work = move || {
            let Experiment { estimator, frame, .. } = &subject.experiment;
            let work = AssertUnwindSafe(|| backward(&**estimator, &clip, *frame));
            let flow = catch_unwind(work).unwrap_or_else(|panic| Err(panicked(panic.as_ref())));
            shared.mailbox().backward = Some((subject, flow));
            shared.wake.notify_one();
        };
        if std::thread::Builder::new().name("backward".into()).spawn(work).is_err() {
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
    fn open(&mut self, Job { subject, place }: Job) -> Result<bool, Error> {
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
        if let Some(unit) = near.and_then(|focus| walk.unit_at(focus)) {
            cursor.unit = unit;
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
        Ok(cursor == Cursor::default() || self.travel(Move::To(cursor)))
    }

    /// Has what is known of a run at hand before it has anything to show.
    fn announce(&self, subject: &Arc<Prepared>, clip: &Clip) -> Result<(), Error> {
        self.shared.mailbox().view.phase = Phase::Starting;
        let coming = Arc::new(preview(subject, clip)?);
        self.shared.mailbox().view.coming = Some(coming);
        Ok(())
    }

    fn go(&mut self, to: Move) {
        if self.travel(to) && self.pass_idle(to) {
            self.publish();
        }
    }

    /// Goes on with a small move as long as nothing happens where it leads; gives whether it is done.
    fn pass_idle(&mut self, to: Move) -> bool {
        let is_idle = |worker: &Self| worker.run.as_ref().is_some_and(|run| run.walk.is_idle() && !run.walk.at_end());
        while matches!(to, Move::Granularity(..)) && is_idle(self) {
            let before = self.run.as_ref().map(|run| run.walk.cursor());
            if !self.travel(to) {
                return false;
            }
            if before == self.run.as_ref().map(|run| run.walk.cursor()) {
                break;
            }
        }
        true
    }

    fn go_at(&mut self, focus: Focus, side: Side) {
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
        self.go(Move::To(to));
    }

    fn go_to_candidate(&mut self, candidate: [i32; 2]) {
        let Some(run) = &mut self.run else { return };
        let Cursor { unit, .. } = run.walk.cursor();
        // In lockstep each search tests it, or not, at a step of its own.
        let is_alone = run.walk.beside(None).is_empty();
        let event = is_alone.then(|| event_of(&mut *run.walk, Cursor { unit, event: 0 }, candidate)).flatten();
        self.go(Move::To(Cursor { unit, event: event.unwrap_or(usize::MAX) }));
    }

    /// The pixel or the object that was clicked, where it can be explained.
    fn held(&self) -> Option<Focus> {
        let (held, run) = (self.held?, self.run.as_ref()?);
        // An object is selected wherever it goes, and not before it is there.
        place_of(&*run.walk, held).filter(|at| is_explained(&*run.walk, *at))
    }

    /// Works on a move until it is done or another one is wanted more; gives whether it is done. A long one shows now and
    /// then how far it has come.
    fn travel(&mut self, to: Move) -> bool {
        self.shared.mailbox().view.phase = Phase::Running;
        let Some(mut long_move) = self.run.as_ref().map(|run| LongMove::new(run, to)) else { return false };
        loop {
            match self.leg(&mut long_move) {
                Leg::NotWanted => return false,
                Leg::There => break,
                Leg::Part => {
                    let begun = Instant::now();
                    if !self.turn() {
                        return false;
                    }
                    self.show(long_move.goal);
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
    fn leg(&mut self, long_move: &mut LongMove) -> Leg {
        let Some(run) = &mut self.run else { return Leg::NotWanted };
        let shared = self.shared;
        let asked = long_move.begun;
        let wanted = || asked.elapsed() < SLOW_AFTER || !shared.superseded.is_set();
        let begun = Instant::now();
        run.walk.go(long_move.next);
        loop {
            let slice = Instant::now();
            if run.walk.work(&mut || slice.elapsed() < NEWS && wanted()) {
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
        }
    }

    /// Takes the frames of the place where the run stands; gives whether they can be read.
    fn turn(&mut self) -> bool {
        let turned = self.run.as_mut().map_or(Ok(()), Run::turn);
        turned.map_err(|error| self.refuse(error)).is_ok()
    }

    fn publish(&self) {
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
        let mut shown = Snapshot { pointed, bound_for, ..run.snapshot(held.or(focus), &look) };
        let before = self.shared.mailbox().view.shown.clone();
        // What looks the same is the same, so that nobody paints it anew.
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

impl Run {
    /// Takes the frames of the place where it stands now.
    fn turn(&mut self) -> Result<(), Error> {
        self.pair = self.pairs.of(&*self.walk, &self.clip)?.clone();
        Ok(())
    }

    fn snapshot(&self, focus: Option<Focus>, look: &Look) -> Snapshot {
        self.focus.set(focus);
        let (walk, clip) = (&*self.walk, &self.clip);
        let beside = look.shows_beside(self.subject.experiment.estimator.shows_frame_alone());
        let standing = RunView { walk, clip, pair: &self.pair, focus, end: self.end(), beside, named: &self.named };
        let Ok(moment) = Moment::of(standing, |site| Ok::<_, Infallible>(self.motion(site, look)));
        let own = moment.scene.pictures.iter().map(|canvas| canvas.picture);
        let clickable = [Picture::CURRENT, Picture::NEXT].into_iter().chain(own).filter(|picture| walk.takes(*picture));
        let clickable = clickable.collect();
        Snapshot {
            subject: Arc::clone(&self.subject),
            info: walk.info(),
            moment,
            events: walk.events(),
            units: walk.units(),
            place: walk.place(),
            landmarks: walk.landmarks(),
            faults: self.end.get().and_then(|end| Some(Arc::clone(end.as_ref()?.faults()))).unwrap_or_default(),
            failure: walk.failure().cloned(),
            pointed: None,
            clickable,
            bound_for: None,
            tested: walk.evaluations().partition_point(|event| *event <= walk.cursor().event),
        }
    }

    /// What `look` shows of motion; the pixel that is explained makes no difference.
    fn motion(&self, site: Site<'_>, look: &Look) -> Motion {
        let (cursor, is_checked) = (self.walk.cursor(), self.backward.is_some());
        if let Some(seen) = &*self.motion.borrow()
            && (seen.cursor, seen.is_checked) == (cursor, is_checked)
            && seen.look.shows_same_motion(look)
        {
            return seen.motion.clone();
        }
        let backward = || Ok(self.backward.as_ref().and_then(|flow| flow.as_ref().ok()));
        // A truth that cannot be read is told beside the other figures; then there are no colours.
        let none = || Motion::of(site, &Look { layer: Some(FlowLayer::None), ..*look }, backward).unwrap_or_default();
        let mut motion = Motion::of(site, look, backward).unwrap_or_else(|_| none());
        motion.unchecked = self.backward.as_ref().and_then(|flow| flow.as_ref().err().cloned());
        *self.motion.borrow_mut() = Some(SeenMotion { cursor, look: *look, is_checked, motion: motion.clone() });
        motion
    }

    /// Whether another step is explained with the pixel `focus` than the one that was shown last.
    fn has_another_explanation(&self, focus: Option<Focus>) -> bool {
        let walk = &*self.walk;
        let explains = |focus: &Focus| {
            walk.takes(focus.on) && walk.explained(*focus).is_none_or(|explained| explained.at(walk.cursor()))
        };
        self.focus.get().filter(explains) != focus.filter(explains)
    }

    /// What the end of the run shows, if that is where it stands.
    fn end(&self) -> Option<&End> {
        if !self.walk.at_end() || self.is_brief.get() && self.end.get().is_none() {
            return None;
        }
        if self.end.get().is_none() {
            let clip = self.clip.clone().until(self.superseded.clone());
            let end = End::of(&*self.walk, &self.subject.experiment, &clip, &self.pair);
            // Figures that gave way to another request are not complete.
            if self.superseded.is_set() {
                return None;
            }
            self.end.get_or_init(|| end);
        }
        self.end.get().and_then(Option::as_ref)
    }
}

/// How far a part of a move has come.
enum Leg {
    /// To where the move leads.
    There,
    /// Some of the way.
    Part,
    /// Something else is wanted more.
    NotWanted,
}

fn panicked(panic: &(dyn std::any::Any + Send)) -> Error {
    let said = panic.downcast_ref::<String>().map(String::as_str);
    let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
    Error::new(format!(
        "the run failed ({said}); change a parameter or the clip to restart it, and please report this error"
    ))
}

#[cfg(test)]
mod tests;
