//! A summary of the window for the page around it: for screen readers, and for tests in a browser.

use motionscope_core::run::Info;
use serde::Serialize;

use super::App;
use crate::ui::model::live::LiveView;

/// A summary of the window.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Whether this is the start page; then there is no clip, estimator or step.
    pub start: bool,
    /// The page of a lesson, such as `kalman-filter/3`.
    pub lesson: Option<String>,
    /// Name of the clip.
    pub clip: Option<String>,
    /// Id of the estimator.
    pub estimator: Option<&'static str>,
    /// The step, such as `35.12`.
    pub step: Option<String>,
    /// The sentence of the step.
    pub sentence: Option<String>,
    /// The error that is shown: a clip could not be opened, or an estimator not be run.
    pub error: Option<String>,
    /// The newest message.
    pub message: Option<String>,
    /// The live picture of the camera.
    pub live: Option<LiveSummary>,
    /// Whether a task is at work.
    pub busy: bool,
}

/// A summary of the live picture of a camera.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LiveSummary {
    /// The number of the frame.
    pub frame: Option<usize>,
    /// Id of the estimator that has run on it.
    pub estimator: Option<&'static str>,
    /// Number of estimators that keep up with the camera, of those measured so far.
    pub offered: usize,
    /// Why the estimator does not run.
    pub error: Option<String>,
}

impl LiveSummary {
    fn of(live: &LiveView) -> Self {
        let seen = live.seen.as_deref();
        Self {
            frame: seen.map(|seen| seen.frame),
            estimator: seen.and_then(|seen| seen.estimator).map(|info| info.id),
            offered: live.offered.len(),
            error: live.error.as_ref().map(ToString::to_string),
        }
    }
}

impl App {
    /// Returns a summary of the window.
    pub fn summary(&self) -> Summary {
        let error = self.error().or(self.run.refused()).map(ToString::to_string);
        let general = Summary {
            start: self.dialogs.start.is_some(),
            error,
            message: self.message().map(str::to_owned),
            live: self.live().as_ref().map(LiveSummary::of),
            busy: !self.is_settled(),
            ..Summary::default()
        };
        if general.start {
            return general;
        }
        let lesson = self.course.lesson.as_ref().map(|open| open.address().name().to_string_lossy().into_owned());
        let step = self.run.view.shown.as_deref();
        Summary {
            lesson: lesson.map(|name| name.trim_start_matches("lesson:").to_owned()),
            clip: self.document().clip().map(|clip| clip.info().name.to_string()),
            estimator: step.map(|step| step.info).map(|Info { id, .. }| *id),
            step: step.map(|step| step.cursor.to_string()),
            sentence: step.map(|step| step.step.sentence.plain()),
            ..general
        }
    }
}
