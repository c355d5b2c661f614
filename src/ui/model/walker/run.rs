//! A run at work, and its snapshots.

use std::cell::{Cell, OnceCell, RefCell};
use std::convert::Infallible;
use std::sync::Arc;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{Clip, Flow};
use motionscope_core::run::{Cursor, Walk};
use motionscope_core::scene::{Focus, Picture};

use crate::experiment::Prepared;
use crate::paint::{FlowLayer, Pictures};
use crate::ui::model::snapshot::Snapshot;
use crate::view::look::Look;
use crate::view::moment::{Before, End, LastPair, Moment, RunView};
use crate::view::motion::{Motion, Site};
use crate::view::named::LastNamed;

/// The motion shown last, and the state on which it depends.
pub(super) struct SeenMotion {
    cursor: Cursor,
    look: Look,
    /// Whether the reverse pair is known.
    is_checked: bool,
    motion: Motion,
}

/// A run at work.
pub(super) struct Run {
    pub(super) subject: Arc<Prepared>,
    pub(super) walk: Box<dyn Walk>,
    pub(super) clip: Clip,
    pub(super) pairs: LastPair,
    pub(super) pair: Pictures,
    /// What the whole run amounts to, once its end was reached.
    pub(super) end: OnceCell<Option<End>>,
    /// Set while another request waits.
    pub(super) superseded: Stop,
    /// The flow of the reverse pair, once it was asked for.
    pub(super) backward: Option<Result<Flow, Error>>,
    /// The motion shown last.
    pub(super) motion: RefCell<Option<SeenMotion>>,
    /// What takes long to work out at the end is not shown yet.
    pub(super) is_brief: Cell<bool>,
    /// The pictures of the step that was shown last.
    pub(super) named: LastNamed,
    /// The pixel that was asked for when it was shown.
    pub(super) focus: Cell<Option<Focus>>,
}

impl Run {
    /// Takes the frames of the place where it stands now.
    pub(super) fn turn(&mut self) -> Result<(), Error> {
        self.pair = self.pairs.of(&*self.walk, &self.clip)?.clone();
        Ok(())
    }

    /// The snapshot of the run at its cursor; `last` is the one shown before.
    pub(super) fn snapshot(&self, focus: Option<Focus>, look: &Look, last: Option<&Snapshot>) -> Snapshot {
        let is_same_focus = self.focus.replace(focus) == focus;
        let (walk, clip) = (&*self.walk, &self.clip);
        let last = last.filter(|last| is_same_focus && self.is_next_to(last));
        let before = last.map_or(Before::Unknown, |last| Before::Known(&last.step));
        let beside = look.shows_beside(self.subject.experiment.estimator.shows_frame_alone());
        let standing =
            RunView { walk, clip, pair: &self.pair, focus, end: self.end(), beside, named: &self.named, before };
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

    /// Whether the run stands one event of the same unit after `last`.
    fn is_next_to(&self, last: &Snapshot) -> bool {
        let Cursor { unit, event } = self.walk.cursor();
        let is_alone = self.subject.experiment.side_by_side.is_empty();
        is_alone
            && Arc::ptr_eq(&last.subject, &self.subject)
            && last.cursor == Cursor { unit, event: event.wrapping_sub(1) }
    }

    /// The motion as `look` shows it, whichever pixel is explained.
    pub(super) fn motion(&self, site: Site<'_>, look: &Look) -> Motion {
        let (cursor, is_checked) = (self.walk.cursor(), self.backward.is_some());
        if let Some(seen) = &*self.motion.borrow()
            && (seen.cursor, seen.is_checked) == (cursor, is_checked)
            && seen.look.shows_same_motion(look)
        {
            return seen.motion.clone();
        }
        let backward = || Ok(self.backward.as_ref().and_then(|flow| flow.as_ref().ok()));
        // The error of an unreadable truth is listed with the other figures; then there are no colours.
        let none = || Motion::of(site, &Look { layer: Some(FlowLayer::None), ..*look }, backward).unwrap_or_default();
        let mut motion = Motion::of(site, look, backward).unwrap_or_else(|_| none());
        motion.unchecked = self.backward.as_ref().and_then(|flow| flow.as_ref().err().cloned());
        *self.motion.borrow_mut() = Some(SeenMotion { cursor, look: *look, is_checked, motion: motion.clone() });
        motion
    }

    /// Whether another step is explained with the pixel `focus` than the one that was shown last.
    pub(super) fn has_another_explanation(&self, focus: Option<Focus>) -> bool {
        let walk = &*self.walk;
        let explains = |focus: &Focus| {
            walk.takes(focus.on) && walk.explained(*focus).is_none_or(|explained| explained.at(walk.cursor()))
        };
        self.focus.get().filter(explains) != focus.filter(explains)
    }

    /// The figures of the end, if the run is at its end.
    pub(super) fn end(&self) -> Option<&End> {
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
