//! What is known of a run before its first step is there: its frames, and what someone detected in them.

use std::sync::Arc;

use motionscope_core::scene::{Picture, Sentence, Shape};
use motionscope_core::{Clip, Cursor, Error, Role, Scene, Step};

use super::snapshot::{Snapshot, Subject};
use crate::view::motion::Offer;
use crate::view::shot;

/// The run of `subject` before its first step, with frames of `clip`, which is that of the subject.
///
/// # Errors
/// If its frames cannot be read.
pub fn preview(subject: &Arc<Subject>, clip: &Clip) -> Result<Snapshot, Error> {
    let Subject { estimator, company, frame, .. } = &**subject;
    Ok(Snapshot {
        info: company.info(&**estimator),
        frame: *frame,
        pictures: shot::pair(clip, *frame)?,
        offer: Offer::default(),
        cursor: Cursor::default(),
        events: 0,
        units: None,
        at_end: false,
        place: Vec::new(),
        landmarks: Vec::new(),
        failure: None,
        step: Arc::new(step(subject, "The first step is still being worked out.")),
        scene: Arc::new(detected(subject)),
        pointed: None,
        clickable: Vec::new(),
        tested: 0,
        tiles: Vec::new(),
        bound_for: None,
        subject: Arc::clone(subject),
    })
}

/// The same, stopped there for good.
pub fn stopped(preview: &Snapshot) -> Snapshot {
    let step =
        step(&preview.subject, "The run was stopped before its first step was there. A step forward starts it again.");
    Snapshot { step: Arc::new(step), ..preview.clone() }
}

/// A step before the first: the algorithm is about to begin.
fn step(subject: &Subject, sentence: &str) -> Step {
    let line = subject.estimator.info().pseudocode[0].name;
    Step { line, sentence: Sentence::default().text(sentence), readouts: Vec::new() }
}

/// The boxes of the detections that come with the clip.
fn detected(subject: &Subject) -> Scene {
    let mut scene = Scene::default();
    let found = subject.clip.detections(subject.frame).unwrap_or_default();
    for bounds in found.iter().map(|found| found.bounds) {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Rect { min: bounds.min, max: bounds.max });
    }
    if !found.is_empty() {
        scene.legend(Role::Measured, "detected");
    }
    scene
}
