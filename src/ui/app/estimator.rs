//! Choosing the estimator and its parameters, and walking through its stages.

use motionscope_core::base::words::capital;
use motionscope_core::course::compare::changed_alike;
use motionscope_core::course::estimator;
use motionscope_core::run::Cursor;

use super::App;
use crate::experiment::{told_of_unplaced, unplaced};
use crate::paint::View;
use crate::ui::model::document::Document;
use crate::ui::model::snapshot::Place;

impl App {
    /// Begins to place a parameter on the picture, or ends it.
    pub(super) fn place(&mut self, index: Option<usize>) {
        self.panes.states.stage.placing = index;
        if index.is_some() {
            self.presentation.pen.is_on = false;
            self.settings.fold_parameters();
        }
    }

    /// Undoes or redoes a change, or sets the parameters back.
    pub(super) fn edit(&mut self, change: impl FnOnce(&mut Document)) {
        let (before, depth) = (self.run.document.estimator().info().id, self.run.document.parents().len());
        let (was_single, was_by_frame) = (self.run.shows_frame_alone(), self.run.document.estimator().is_by_frame());
        change(&mut self.run.document);
        let is_another = self.run.document.estimator().info().id != before;
        if is_another {
            self.panes.states.stage.placing = None;
        }
        self.suit_view(was_single);
        match is_another && was_by_frame && self.run.document.parents().len() == depth {
            true => self.restart_from(was_by_frame),
            false => self.restart(),
        }
    }

    pub(super) fn choose(&mut self, id: &str) {
        match estimator(id) {
            Ok(chosen) => {
                let was_single = self.run.shows_frame_alone();
                let was_by_frame = self.run.document.estimator().is_by_frame();
                self.panes.states.stage.placing = None;
                self.panes.states.stage.forget_large();
                self.panes.states.stage.follow_again();
                if self.run.document.parents().len() > 0 {
                    self.toasts
                        .hint(format!("{} runs on the clip itself, so the stage was closed.", chosen.info().name));
                }
                // Colours that tell of one family's results would cover the pictures of another.
                if self.run.document.estimator().info().family != chosen.info().family {
                    self.settings.look.layer = None;
                }
                self.run.document.choose(changed_alike(self.run.document.estimator(), chosen));
                self.suit_view(was_single);
                self.restart_from(was_by_frame);
                self.ask_for_region();
            }
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Asks for the region of an object where a tracker has taken one in the middle of the frame, and takes up the placing tool.
    pub(super) fn ask_for_region(&mut self) {
        let (document, frame) = (&self.run.document, self.run.document.frame());
        let opened = document.source().zip(document.clip());
        let Some(spec) = opened.and_then(|opened| unplaced(document.estimator(), opened, frame)) else { return };
        let index = document.estimator().specs().iter().position(|other| other.name == spec.name);
        self.toasts.hint(format!("{}: drag one on the first frame of the run.", capital(&told_of_unplaced(spec))));
        self.settings.charts.is_enlarged = false;
        self.place(index);
    }

    /// Switches the estimator and keeps the position if both have the same units; for units that are frames, the shown frame.
    fn restart_from(&mut self, was_by_frame: bool) {
        let before = self.run.document.frame();
        let place = match (was_by_frame, self.run.document.estimator().is_by_frame(), &self.run.view.shown) {
            (false, false, _) => return self.restart(),
            (true, true, shown) => self.run.document.begin_near(self.run.document.place(shown.as_deref())),
            (false, true, Some(shown)) => {
                let unit = shown.frame.saturating_sub(self.run.document.frame());
                let place = Place { cursor: Cursor { unit, event: usize::MAX }, ..Place::default() };
                self.run.document.begin_near(place)
            }
            _ => Place::OPENING,
        };
        if self.run.document.frame() > before {
            let (name, frame) = (self.run.document.estimator().info().name, self.run.document.frame());
            self.toasts
                .hint(format!("{name} depends on few frames: its run begins at frame {frame}, near the one shown."));
        }
        let job = self.run.document.job_at(place);
        self.start(job);
    }

    /// Opens a stage of the estimator at the current position.
    pub(super) fn enter(&mut self, index: usize) {
        let Some(shown) = self.run.view.shown.clone().filter(|_| self.run.document.side_by_side().is_empty()) else {
            return;
        };
        let was_single = self.run.shows_frame_alone();
        match self.run.document.enter(index, &shown) {
            Ok(place) => self.change_stage(place, was_single),
            Err(error) => self.toasts.fail(format!("The stage cannot be opened: {error}.")),
        }
    }

    /// Closes the stage and returns to its parent.
    pub(super) fn leave(&mut self) {
        let was_single = self.run.shows_frame_alone();
        let place = self.run.document.leave();
        self.change_stage(place, was_single);
    }

    fn change_stage(&mut self, place: Option<Place>, was_single: bool) {
        let Some(place) = place else { return };
        self.run.player.pause();
        self.panes.states.stage.placing = None;
        self.panes.states.explained = 0;
        self.suit_view(was_single);
        let job = self.run.document.job_at(place);
        self.start(job);
    }

    /// Adapts the view after a change between estimators of single frames, which show frame t, and of pairs, which show both.
    pub(super) fn suit_view(&mut self, was_single: bool) {
        let is_single = self.run.shows_frame_alone();
        let view = &mut self.settings.look.view;
        match (was_single, is_single, *view) {
            (false, true, Some(View::SideBySide)) => *view = Some(View::Current),
            (true, false, Some(View::Current)) => *view = Some(View::SideBySide),
            _ => {}
        }
    }

    pub(super) fn go_to_frame(&mut self, frame: usize) {
        if self.run.document.go_to_frame(frame) {
            self.restart();
        }
    }

    /// Restarts the run with the current settings at the shown position.
    pub(super) fn restart(&mut self) {
        let job = self.run.document.job(self.run.view.shown.as_deref());
        self.start(job);
    }
}
