//! A run as a task: moves go in, immutable pictures of the run come out.
//!
//! Nothing here knows the window. A request never waits for an earlier one that takes long: it replaces it. What cannot be
//! interrupted is left behind: another task takes over, with what was shown last, and the old one ends when it can.
//!
//! A snapshot holds the experiment (`Prepared`) and the `Moment` shown; files are saved from it, never from settings changed
//! since. A long move runs in slices, each of which is shown (`long_move.rs`).

mod long_move;
mod mailbox;
mod marks;
mod run;
mod worker;

use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, MutexGuard, PoisonError};

use mailbox::{Mailbox, Request, Shared};
pub use mailbox::{Phase, View};
pub use marks::Marks;
use motionscope_core::base::Error;
use motionscope_core::products::Output;
use motionscope_core::run::{Direction, Move, Walk};
use motionscope_core::scene::Focus;
use web_time::{Duration, Instant};
use worker::Worker;

use super::snapshot::{Hold, Job, Place, Snapshot};
use crate::experiment::Prepared;
use crate::ui::commands::Side;
use crate::view::look::Look;
use crate::work::{self, Task};

/// A move that works longer than this gives way to the next request; less, and a drag would never arrive anywhere.
const SLOW_AFTER: Duration = Duration::from_millis(60);
/// How long work may go on after it was stopped before it is left behind.
const GRACE: Duration = Duration::from_millis(250);
/// Abandoned tasks that may still be running when another run starts.
const LEFT: usize = 2;
/// Small moves that may wait: more would make a held key run on after it is let go.
const QUEUE: usize = 4;
/// A run that is walked by a task of its own.
pub struct Walker {
    shared: Arc<Shared>,
    task: Task,
    /// Tasks whose work was left behind.
    left: Vec<Task>,
}

impl Walker {
    /// A walker without a run; `changed` is called by its task whenever [`Walker::view`] has news.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(changed: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::new(Arc::new(changed)));
        let task = spawn(&shared)?;
        Ok(Self { shared, task, left: Vec::new() })
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
        self.left.retain(|task| !task.is_finished());
        let is_stuck = {
            let mailbox = self.shared.mailbox();
            let is_late = mailbox.unwanted.is_some_and(|since| since.elapsed() > GRACE);
            is_late && mailbox.since.is_some() && (mailbox.job.is_none() || self.left.len() < LEFT)
        };
        if is_stuck {
            self.leave();
        }
    }

    /// Another task takes over, which knows what was shown last.
    fn leave(&mut self) {
        let shared = Arc::new(Shared::new(Arc::clone(&self.shared.changed)));
        let Ok(task) = spawn(&shared) else { return };
        let old = std::mem::replace(&mut self.shared, Arc::clone(&shared));
        self.left.push(std::mem::replace(&mut self.task, task));
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
        shared.wake.notify();
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

    /// Has `visit` look at the run, by the walker's task, after what was asked for before.
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
        drop(mailbox);
        self.shared.wake.notify();
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
        self.task.wait(GRACE);
    }
}

fn spawn(shared: &Arc<Shared>) -> std::io::Result<Task> {
    let shared = Arc::clone(shared);
    work::spawn("walker", async move || Worker::new(&shared).run().await)
}

#[cfg(test)]
mod tests;
