//! The preview of a run before its first step is computed: its frames and detections.

use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::data::Clip;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Picture, Role, Scene, Sentence, Shape, Step};

use super::snapshot::Snapshot;
use crate::experiment::Prepared;
use crate::view::moment::{self, Moment};
use crate::view::motion::AvailableLayers;

/// Returns the preview of the run of `subject` on its `clip`.
///
/// # Errors
/// If its frames cannot be read.
pub fn preview(subject: &Arc<Prepared>, clip: &Clip) -> Result<Snapshot, Error> {
    let experiment = &subject.experiment;
    let moment = Moment {
        clip: clip.info().name.as_str().into(),
        frame: experiment.frame,
        cursor: Cursor::default(),
        at_end: false,
        step: Arc::new(step(subject, "Computing the first step.")),
        before: None,
        scene: Arc::new(detected(subject)),
        pictures: moment::pair(clip, experiment.frame)?,
        tiles: Vec::new(),
        available: AvailableLayers::default(),
        missing: None,
        freehand: Arc::default(),
    };
    Ok(Snapshot {
        info: experiment.info(),
        moment,
        events: 0,
        units: None,
        place: Vec::new(),
        landmarks: Vec::new(),
        faults: Arc::default(),
        failure: None,
        pointed: None,
        clickable: Vec::new(),
        tested: 0,
        bound_for: None,
        subject: Arc::clone(subject),
    })
}

/// Returns the preview of a run that was cancelled before its first step.
pub fn stopped(preview: &Snapshot) -> Snapshot {
    let step = step(&preview.subject, "The run was cancelled before its first step. Step forward to restart it.");
    let moment = Moment { step: Arc::new(step), ..preview.moment.clone() };
    Snapshot { moment, ..preview.clone() }
}

/// Returns the step before the first.
fn step(subject: &Prepared, sentence: &str) -> Step {
    let line = subject.experiment.estimator.info().pseudocode[0].name;
    Step { values: Vec::new(), line, sentence: Sentence::default().text(sentence), readouts: Vec::new() }
}

/// Returns the boxes of the clip's detections.
fn detected(subject: &Prepared) -> Scene {
    let mut scene = Scene::default();
    let found = subject.clip.detections(subject.experiment.frame).unwrap_or_default();
    for bounds in found.iter().map(|found| found.bounds) {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Rect { min: bounds.min, max: bounds.max });
    }
    if !found.is_empty() {
        scene.legend(Role::Measured, "detected");
    }
    scene
}
