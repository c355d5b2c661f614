//! Works out the state of the window that decides which commands are enabled.

use motionscope_core::run::Direction;

use super::{App, Region};
use crate::experiment::source::Source;
use crate::paint::charts::relief::standing;
use crate::ui::commands::{Owner, Situation};
use crate::ui::drawing::style::ZOOM;
use crate::ui::layout;
use crate::ui::model::lesson::OpenLesson;

impl App {
    /// What is the case just now.
    pub(super) fn now(&self) -> Situation {
        if self.dialogs.start.is_some() {
            // What is below the page is not seen, so nothing is done to it.
            let (can_be_larger, has_trail) = (self.can_be_larger(), self.course.trail.last().is_some());
            return Situation { can_be_larger, has_trail, at_start_page: true, ..Situation::default() };
        }
        let shown = self.run.view.shown.as_deref();
        let (last, folded) = (self.run.document.last_frame(), self.folded());
        let [can_undo, can_redo] =
            self.ink_history().unwrap_or([self.run.document.can_undo(), self.run.document.can_redo()]);
        Situation {
            has_clip: self.run.document.clip().is_some(),
            has_pictures: self.run.document.clip().is_some_and(|clip| !clip.is_blank())
                && matches!(self.run.document.source(), Some(Source::File(_) | Source::Pair(_))),
            has_run: shown.is_some() && self.run.refused().is_none(),
            at_start: shown.is_none_or(|shown| shown.cursor == motionscope_core::run::Cursor::default()),
            at_end: shown.is_some_and(|shown| shown.at_end),
            busy: self.run.view.busy,
            checking: self.run.view.checking,
            playing: self.run.player.is_playing(),
            lecture: self.settings.lecture,
            shows_parameters: !folded.parameters,
            shows_explanation: !folded.explanation,
            shows_charts: !folded.charts,
            has_open_parameters: self.settings.is_narrow && !folded.parameters,
            has_charts: !folded.charts && !self.charts().is_empty(),
            has_landscape: self.settings.look.landscape || shown.is_some_and(|shown| standing(&shown.step).is_some()),
            has_large_picture: self.panes.arranged.stage.is_some() && self.panes.arranged.panes.has_large(),
            has_enlarged: self.settings.charts.is_enlarged
                && self.panes.regions.iter().all(|(region, _)| *region != Region::Stage),
            can_be_larger: self.can_be_larger(),
            in_lockstep: !self.run.document.side_by_side().is_empty(),
            has_stage: !motionscope_core::run::stage::stages(self.run.document.estimator()).is_empty(),
            in_stage: self.run.document.parents().len() > 0,
            is_writing: self.exports.writing.is_some(),
            is_placing: self.panes.states.stage.placing.is_some(),
            holds_pixel: shown.and_then(|shown| shown.pointed).is_some_and(|pointed| pointed.is_held),
            available: shown.map(|shown| shown.available).unwrap_or_default(),
            look: self.settings.look,
            reduced_motion: self.settings.reduced_motion,
            can_undo,
            can_redo,
            is_drawing: self.presentation.pen.is_on,
            has_ink: !self.ink().is_empty(),
            has_loupe: self.presentation.has_loupe,
            is_pointing: self.presentation.is_pointing,
            is_presenting: self.presentation.is_on,
            is_blank: self.presentation.is_blank,
            is_tuned: self.run.document.is_tuned(Owner::Estimator),
            asks: self.run.predict.is_on(),
            is_asked: self.run.predict.open().is_some(),
            is_answered: self.run.predict.last().is_some_and(|open| open.verdict().is_some()),
            has_scores: !self.run.predict.scores().is_empty(),
            in_lesson: self.course.lesson.is_some(),
            at_first_page: self.course.lesson.as_ref().is_some_and(|open| open.is_at(Direction::Back)),
            lesson_goes_on: self.course.lesson.as_ref().is_some_and(OpenLesson::goes_on),
            at_last_page: self.course.lesson.as_ref().is_some_and(|open| open.is_at(Direction::Forward)),
            has_trail: self.course.trail.last().is_some(),
            at_start_page: false,
            at_first_frame: self.run.document.frame() == 0,
            at_last_frame: last.is_some_and(|last| self.run.document.frame() >= last),
        }
    }

    /// Whether a larger interface fits into the window.
    fn can_be_larger(&self) -> bool {
        let larger = (self.settings.seen_zoom(self.ctx.zoom_factor()) + ZOOM.2) * self.mode().zoom();
        let type_pt = self.settings.look.theme.sizes().body;
        let fits = || layout::zoom_that_fits(larger, self.size(), type_pt, self.mode()) >= larger;
        self.settings.interface(self.size()).zoom < ZOOM.1 && fits()
    }
}
