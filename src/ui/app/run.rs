//! The run that is open, and how one is started.

use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::run::{Cursor, Direction, Move};

use super::App;
use crate::experiment::side_by_side::SideBySide;
use crate::experiment::suitability::{Flaw, Suitability};
use crate::experiment::{Experiment, Position, first, is_of_pair, told_of_pair};
use crate::paint::charts::heat_map;
use crate::paint::{self, number};
use crate::session::Session;
use crate::ui::commands::Granularities;
use crate::ui::model::document::Document;
use crate::ui::model::player::Player;
use crate::ui::model::predict::Predict;
use crate::ui::model::snapshot::{Hold, Job, Place, Snapshot, surface};
use crate::ui::model::walker::{Marks, View, Walker};
use crate::ui::panes::status;
use crate::view::look::Look;

/// The run that is open: what is run, the thread that works on it, what is shown of it, and how it is played and asked about.
pub(super) struct Run {
    /// What is open and how it is set.
    pub document: Document,
    pub walker: Walker,
    /// What the walker shows and does.
    pub view: View,
    pub player: Player,
    /// The questions about the next result.
    pub predict: Predict,
    /// The estimators that were last in lockstep.
    pub last_lockstep: SideBySide,
    /// When the run was played on last.
    pub played: f64,
    /// The last step of a page that playback may pass with the step that it is taking.
    pub approached: Option<Cursor>,
    /// The step that a session or a link names, until the run has arrived there.
    pub named: Option<Cursor>,
}

impl Run {
    /// Nothing yet, played at the speed of this index; `repaint` is called when the walker has something to show.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(repaint: impl Fn() + Send + Sync + 'static, speed: usize) -> std::io::Result<Self> {
        Ok(Self {
            document: Document::default(),
            walker: Walker::new(repaint)?,
            view: View::default(),
            player: Player::at_speed(speed),
            predict: Predict::default(),
            last_lockstep: SideBySide::default(),
            played: 0.0,
            approached: None,
            named: None,
        })
    }

    /// The names of the ladder's granularities.
    pub fn granularities(&self) -> Granularities {
        Granularities::new(self.document.side_by_side().info(self.document.estimator()).granularities)
    }

    /// Why there is no run of what is set now, if there is none.
    pub fn refused(&self) -> Option<&Error> {
        self.view.refused.as_ref().or(self.document.refused())
    }

    /// Whether frame t alone shows the estimator.
    pub fn shows_frame_alone(&self) -> bool {
        self.document.estimator().shows_frame_alone()
    }

    /// The view with which a run begins: frame t for an estimator of single frames, both frames for one of pairs.
    pub fn own_view(&self) -> Option<paint::View> {
        Look::opening(self.shows_frame_alone()).view
    }

    /// Notes that the next step may be asked about: that of the run, not that of a pixel that is pointed at.
    pub fn expect_question(&mut self) {
        self.predict.expect();
        if self.predict.is_due() {
            self.walker.focus(None);
        }
    }

    /// Goes back to the last step of a page where playback has passed it by a level or a warp; returns whether it does.
    pub fn returns_to_page(&mut self) -> bool {
        if self.player.is_playing() && self.view.busy {
            return false;
        }
        let end = self.approached.take().filter(|_| self.player.is_playing());
        let at = self.view.shown.as_deref().map(|shown| shown.cursor);
        let Some(end) = end.filter(|end| at.is_some_and(|at| order(at) > order(*end))) else { return false };
        self.player.pause();
        self.walker.go(Move::To(end));
        true
    }

    /// Moves, and plays no longer.
    pub fn go(&mut self, to: Move) {
        self.player.pause();
        self.named = None;
        self.walker.go(to);
    }

    /// Goes to the next of these marks on the timeline that way.
    pub fn go_to_mark(&mut self, way: Direction, marks: Marks) {
        self.player.pause();
        self.walker.go_to_mark(way, marks);
    }

    /// Holds back what is shown where a question about it is open; gives whether one has just opened.
    pub fn hold_back(&mut self, is_loading: bool) -> bool {
        let is_new = self.predict.pass(&mut self.view, is_loading);
        if is_new {
            self.player.pause();
            self.walker.focus(None);
        }
        is_new
    }

    /// Receives the latest snapshot of the walker.
    pub fn receive(&mut self) {
        self.walker.tend();
        self.view = self.walker.view();
        // While a run takes long to start, its frames are shown instead of those of another clip or estimator.
        let is_late = self.view.busy_for.is_some_and(|time| time > status::LATE);
        let id = self.document.estimator().info().id;
        let is_ours = |shown: &Snapshot| self.document.is_of_clip(shown) && shown.info.id == id;
        if let Some(coming) = self.view.coming.take().filter(|_| is_late)
            && !self.view.shown.as_deref().is_some_and(is_ours)
        {
            self.view.shown = Some(coming);
        }
    }

    /// Whether nothing is worked on.
    pub fn is_settled(&self) -> bool {
        !self.view.busy && !self.view.checking
    }
}

impl App {
    /// Receives the latest snapshot of the run, and holds it back while a question about it is open.
    pub(super) fn receive_run(&mut self) {
        self.run.receive();
        if self.run.hold_back(self.opening.loading.is_some()) {
            self.panes.states.stage.look_anew();
            // A click is a guess now.
            self.panes.states.stage.placing = None;
        }
        self.tell_of_untested();
        self.tell_of_step();
        // A clip that no run can be made of is not shown under another's name.
        let Run { view, document, .. } = &mut self.run;
        if view.refused.is_some() {
            view.shown = view.shown.take().filter(|shown| document.is_of_clip(shown));
        }
    }

    /// Says of a displacement that was clicked, and that no step of its unit tests, that it was not tested.
    fn tell_of_untested(&mut self) {
        let Some((unit, at)) = self.panes.states.sought.filter(|_| !self.run.view.busy) else { return };
        self.panes.states.sought = None;
        let Some(shown) = self.run.view.shown.as_deref().filter(|shown| shown.cursor.unit == unit) else { return };
        let Some(surface) = surface(&shown.step) else { return };
        if heat_map::event(surface, at).is_none() {
            let whose = shown.info.name;
            let cost = heat_map::any_cost(surface, at).map_or_else(String::new, |cost| {
                format!(" Its {} is {}, as the faint part of the surface shows.", surface.title, number(cost))
            });
            let at = heat_map::vector(at);
            self.toasts.tell(format!("{whose} does not test {at} for this block; its last step is shown.{cost}"));
        }
    }

    /// Runs what is set, from `place` on.
    pub fn walk_from(&mut self, place: Place) {
        let job = self.run.document.job_at(place);
        self.start(job);
    }

    /// Starts a run, if there is one to start: what an example says is not about another one.
    pub(super) fn start(&mut self, job: Option<Job>) {
        self.toasts.describe(None);
        if let Some(job) = job {
            self.take_ink(&job.subject);
            self.run.walker.start(job);
        }
    }

    /// Applies the settings of a session to the clip that is open.
    pub(super) fn take(&mut self, session: Session) {
        let Session { experiment, position, look, sight, freehand } = session;
        let frame = experiment.frame;
        self.run.document.restore(experiment);
        self.tell_of_frame(frame);
        self.look_as(&look, sight);
        let Position { cursor, held } = position;
        self.run.named = cursor.filter(|cursor| *cursor != Cursor::END);
        let cursor = cursor.or_else(|| self.left_in_run()).unwrap_or_default();
        let job = self.run.document.job_at(Place { hold: Hold::Set(held), ..Place::at(cursor) });
        job.iter().for_each(|job| self.restore_ink(&job.subject, freehand.clone()));
        self.start(job);
    }

    /// Reports if the run ends, or its unit, before the step that the session names.
    fn tell_of_step(&mut self) {
        let Some(named) = self.run.named.take_if(|_| !self.run.view.busy) else { return };
        let Run { view, document, .. } = &self.run;
        let shown = view.shown.as_deref().filter(|shown| view.refused.is_none() && document.is_of_clip(shown));
        // A run that was stopped before has not ended.
        let has_ended = |shown: &&Snapshot| shown.at_end || shown.cursor.unit == named.unit;
        let Some(shown) = shown.filter(has_ended).map(|shown| shown.cursor) else { return };
        // The end of a unit is named without an event.
        let is_missing = if named.event == usize::MAX { shown.unit < named.unit } else { order(shown) < order(named) };
        if is_missing {
            self.toasts.fail(format!("The run has no step {named}; step {shown} is shown instead."));
        }
    }

    /// Reports if the clip has no pair that starts at the session's `frame`.
    fn tell_of_frame(&mut self, frame: usize) {
        let (Some(clip), now) = (self.run.document.clip(), self.run.document.frame()) else { return };
        if now != frame {
            let name = &clip.info().name;
            self.toasts.fail(format!(
                "The session refers to frame {frame}, but the last pair of {name} starts at frame {now}, which is shown instead."
            ));
        }
    }

    /// Begins with the first pair whose true flow is known, and says so.
    pub(super) fn begin_where_known(&mut self, first: Option<usize>) {
        let Some(frame) = first.filter(|_| is_of_pair(self.run.document.estimator())) else { return };
        if self.run.document.go_to_frame(frame) {
            self.toasts.tell(format!("{} Choose another one under Clip.", told_of_pair(frame)));
            self.walk_from(Place::OPENING);
        }
    }

    /// Takes a tracker where there are no pictures to be looked at, and an estimator of disparities for two views of one moment.
    pub(super) fn choose_fitting(&mut self) {
        let (document, source) = (&self.run.document, &self.run.document.experiment().source);
        let Some(clip) = document.clip() else { return };
        let fitting = match Suitability::of(document.estimator(), source, clip) {
            Suitability::Unsuited(Flaw::Frames) => first::OF_DETECTIONS,
            Suitability::Unsuited(Flaw::NextFrame) if clip.right().is_some() => first::OF_VIEWS,
            _ => return,
        };
        let Ok(fitting) = estimator(fitting) else { return };
        let was_single = self.run.shows_frame_alone();
        let source = self.run.document.experiment().source.clone();
        self.run.document.restore(Experiment::new(source, fitting));
        self.suit_view(was_single);
    }
}

/// Which of two cursors of a run comes first.
pub(super) fn order(cursor: Cursor) -> (usize, usize) {
    (cursor.unit, cursor.event)
}
