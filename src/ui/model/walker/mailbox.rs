//! What the window and the worker tell each other.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::Flow;
use motionscope_core::run::{Direction, Move, Walk};
use motionscope_core::scene::Focus;
use web_time::{Duration, Instant};

use super::Marks;
use crate::experiment::Prepared;
use crate::ui::commands::Side;
use crate::ui::model::preview::stopped;
use crate::ui::model::snapshot::{Job, Snapshot};
use crate::view::look::Look;
use crate::work::Signal;

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
    /// Frames read, and frames needed to decode the requested one.
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

pub(super) type Visit = Box<dyn FnOnce(&Arc<Prepared>, &dyn Walk) + Send>;

pub(super) enum Request {
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
pub(super) struct Mailbox {
    pub(super) job: Option<Job>,
    /// The run at the time when its work was left behind, to be resumed where it was.
    pub(super) dormant: Option<Job>,
    /// What is run, or about to be.
    pub(super) subject: Option<Arc<Prepared>>,
    /// When the work at hand was to stop, or another job was laid on the mailbox.
    pub(super) unwanted: Option<Instant>,
    /// A job is on the mailbox or in hand: small moves wait until it stands at its place.
    pub(super) starting: bool,
    pub(super) requests: VecDeque<Request>,
    pub(super) focus: Option<Focus>,
    pub(super) look: Look,
    /// Another pixel is to be explained.
    pub(super) focus_moved: bool,
    /// Something else of the step is to be seen.
    pub(super) look_changed: bool,
    /// The flow of the reverse pair of a run, when it has come.
    pub(super) backward: Option<(Arc<Prepared>, Result<Flow, Error>)>,
    /// Ends the run of the reverse pair at its next chance.
    pub(super) stop_check: Stop,
    pub(super) since: Option<Instant>,
    pub(super) quit: bool,
    pub(super) view: View,
}

pub(super) struct Shared {
    pub(super) mailbox: Mutex<Mailbox>,
    pub(super) wake: Signal,
    pub(super) idle: Condvar,
    /// The move at work is to be given up.
    pub(super) superseded: Stop,
    /// Cancels decoding: the run that reads these frames is cancelled.
    pub(super) stop: Stop,
    pub(super) changed: Changed,
}

pub(super) type Changed = Arc<dyn Fn() + Send + Sync>;

impl Shared {
    pub(super) fn new(changed: Changed) -> Self {
        Self {
            mailbox: Mutex::default(),
            wake: Signal::default(),
            idle: Condvar::new(),
            superseded: Stop::default(),
            stop: Stop::default(),
            changed,
        }
    }

    pub(super) fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Mailbox {
    /// Resumes the run that was left behind.
    pub(super) fn take_up(&mut self) {
        if let Some(job) = self.dormant.take() {
            (self.job, self.starting) = (Some(job), true);
        }
    }

    /// What is to be seen of the run at hand, if it is left behind now: how far it has come, or what was known before.
    pub(super) fn stopped(&mut self) -> Option<Arc<Snapshot>> {
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
