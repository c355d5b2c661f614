//! Where clips were left, and going on from there.

use std::path::Path;

use motionscope_core::run::Cursor;

use super::App;
use crate::files;
use crate::ui::model::settings::LeftAt;
use crate::ui::model::snapshot::Place;

impl App {
    /// Notes where the clip is left that is open.
    pub(super) fn note_place(&mut self) {
        let Some(shown) = self.run.view.shown.as_deref().filter(|shown| self.run.document.is_of_clip(shown)) else {
            return;
        };
        let experiment = &shown.subject.experiment;
        // A stage has its own place, and several have one that none of them has; what is not saved is not found again.
        let has_place = self.run.document.parents().len() == 0 && experiment.side_by_side.is_empty();
        let is_given = experiment.source.paths().into_iter().any(files::is_in_memory);
        if !has_place || is_given || self.is_unsaved() {
            return;
        }
        let whole = |path: &Path| files::absolute(path);
        let (source, run) = (experiment.source.clone().map_path(whole), LeftAt::run_of(&*experiment.estimator));
        self.settings.leave(LeftAt {
            clip: source.to_string(),
            run,
            frame: experiment.frame,
            step: shown.cursor.to_string(),
        });
    }

    /// Goes on where the clip was left that is open now, or else begins at `start`; gives whether it was left anywhere.
    pub(super) fn go_on(&mut self, start: Place) -> bool {
        let frame = self.left_at().map(|left| left.frame);
        if let Some(frame) = frame {
            self.run.document.go_to_frame(frame);
        }
        self.walk_from(self.left_in_run().map_or(start, Place::at));
        frame.is_some()
    }

    /// Where the clip was left that is open now.
    fn left_at(&self) -> Option<&LeftAt> {
        let whole = |path: &Path| files::absolute(path);
        let clip = self.run.document.source()?.clone().map_path(whole).to_string();
        self.settings.left_at(&clip)
    }

    /// The step at which the present run of that clip was left: with other parameters, on another pair or in lockstep the same
    /// step is another one.
    pub(super) fn left_in_run(&self) -> Option<Cursor> {
        let is_alone = self.run.document.side_by_side().is_empty();
        let is_same = |left: &&LeftAt| {
            left.run == LeftAt::run_of(self.run.document.estimator()) && left.frame == self.run.document.frame()
        };
        self.left_at().filter(|left| is_alone && is_same(left))?.step.parse().ok()
    }
}
