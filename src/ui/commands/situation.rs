//! The state of the window that decides which commands are enabled.

use crate::view::look::Look;
use crate::view::motion::AvailableLayers;

/// The state of the window that decides which commands are enabled.
#[derive(Clone, Copy, Debug, Default)]
pub struct Situation {
    /// A clip is open.
    pub has_clip: bool,
    /// It is of pictures or a video in files.
    pub has_pictures: bool,
    /// A run is shown.
    pub has_run: bool,
    /// It stands at its start.
    pub at_start: bool,
    /// It stands at its end.
    pub at_end: bool,
    /// A long move is at work.
    pub busy: bool,
    /// The reverse pair is being run.
    pub checking: bool,
    /// It is playing.
    pub playing: bool,
    /// The window is in the lecture layout because the person wants it.
    pub lecture: bool,
    /// The parameters are not folded away.
    pub shows_parameters: bool,
    /// The explanation is not folded away.
    pub shows_explanation: bool,
    /// The charts are not folded away.
    pub shows_charts: bool,
    /// The parameters take the room of other panes.
    pub has_open_parameters: bool,
    /// The step has charts.
    pub has_charts: bool,
    /// Whether one of several pictures is larger than the others.
    pub has_large_picture: bool,
    /// Whether something rises from a picture, or can.
    pub has_landscape: bool,
    /// A chart stands in the place of the stage.
    pub has_enlarged: bool,
    /// The interface can be larger in a window of this size.
    pub can_be_larger: bool,
    /// Several estimators go in lockstep.
    pub in_lockstep: bool,
    /// The estimator has a stage that can be walked by itself.
    pub has_stage: bool,
    /// It is itself the stage of another that waits.
    pub in_stage: bool,
    /// A pixel was clicked and stays explained.
    pub holds_pixel: bool,
    /// A file is being exported.
    pub is_writing: bool,
    /// A parameter is being placed on the picture.
    pub is_placing: bool,
    /// The mouse draws.
    pub is_drawing: bool,
    /// Something was drawn by hand on the step.
    pub has_ink: bool,
    /// A magnifying glass follows the mouse.
    pub has_loupe: bool,
    /// The mouse is a large pointer.
    pub is_pointing: bool,
    /// Stage, chart and caption are shown alone.
    pub is_presenting: bool,
    /// The screen of the class is black.
    pub is_blank: bool,
    /// Which layers tell of motion.
    pub available: AvailableLayers,
    /// How pictures look.
    pub look: Look,
    /// Things change at once, without animation.
    pub reduced_motion: bool,
    /// There is a change to take back.
    pub can_undo: bool,
    /// There is a change to make again.
    pub can_redo: bool,
    /// A parameter is not as declared.
    pub is_tuned: bool,
    /// Results are asked about.
    pub asks: bool,
    /// A question waits for its answer.
    pub is_asked: bool,
    /// The answer to a question is shown: late hands do nothing.
    pub is_answered: bool,
    /// Questions were answered.
    pub has_scores: bool,
    /// A lesson is open.
    pub in_lesson: bool,
    /// It is open at its first page.
    pub at_first_page: bool,
    /// It is open at its last page.
    pub at_last_page: bool,
    /// Whether → still has something to show in the lesson: a page, the next lesson, or that it ends.
    pub lesson_goes_on: bool,
    /// A link has led away from a page of a lesson.
    pub has_trail: bool,
    /// The start page is shown.
    pub at_start_page: bool,
    /// No earlier pair of frames.
    pub at_first_frame: bool,
    /// No later pair of frames.
    pub at_last_frame: bool,
}

impl Situation {
    /// Whether the run has a step after the one that is shown.
    pub fn can_go_on(&self) -> bool {
        self.has_run && !self.at_end
    }

    /// Whether → leads on: at the end of the last page of a lesson it offers the next one.
    pub fn can_step(&self) -> bool {
        self.lesson_goes_on || self.is_asked || self.can_go_on()
    }

    /// Whether ← leads back: in a lesson it turns the pages as well.
    pub fn can_step_back(&self) -> bool {
        self.in_lesson && !self.at_first_page || self.can_go_back()
    }

    /// Whether the run has a step before the one that is shown.
    pub fn can_go_back(&self) -> bool {
        self.has_run && !self.at_start
    }
}
