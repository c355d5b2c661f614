//! How trackers of many objects are told and drawn, as far as they share it.

use super::course::Course;
use super::{Bounds, Detection, Life, ObjectFrame};
use crate::scene::{Matrix, Picture, Readout, Series, Shape};
use crate::words::heading;
pub(crate) use crate::words::{counted as count, number_64 as short};
use crate::{Grid, Role, Scene};

/// So many frames back a trail reaches.
const TRAIL_FRAMES: usize = 40;
/// So many rows and columns of a table are shown.
const SHOWN: usize = 12;

/// A velocity in words.
pub(crate) fn speed([u, v]: [f64; 2]) -> String {
    format!("{} px/frame towards {}", short(u.hypot(v)), heading([u, v]))
}

/// A table of objects, a row each, beside detections; `None` where one of both is missing.
pub(crate) fn table(
    (symbol, name): (&'static str, &'static str),
    entries: &Grid<f64>,
    is_lit: impl Fn(usize, usize) -> bool,
) -> Option<Matrix> {
    let (width, height) = (entries.width().min(SHOWN), entries.height().min(SHOWN));
    (width > 0 && height > 0).then(|| Matrix {
        symbol,
        name,
        role: None,
        entries: Grid::from_fn(width, height, |x, y| entries[(x, y)]),
        rows: Vec::new(),
        columns: Vec::new(),
        changed: Some(Grid::from_fn(width, height, is_lit)),
    })
}

pub(crate) fn rect(scene: &mut Scene, role: Role, Bounds { min, max }: Bounds) {
    scene.mark(Picture::Current, role, Shape::Rect { min, max });
}

/// What was detected.
pub(crate) fn draw_detections<'a>(scene: &mut Scene, all: impl IntoIterator<Item = &'a Detection>) {
    all.into_iter().for_each(|found| rect(scene, Role::Measured, found.bounds));
    scene.legend(Role::Measured, "detected");
}

/// What an object is called, above its box.
pub(crate) fn label(scene: &mut Scene, role: Role, at: [f32; 2], text: String) {
    let text = Shape::Text { at, text };
    if text.is_finite() {
        scene.mark(Picture::Current, role, text);
    }
}

/// The role of an object, and what that means.
pub(crate) fn role(life: Life) -> (Role, &'static str) {
    match life {
        Life::Tentative => (Role::Candidate, "tentative"),
        Life::Confirmed => (Role::Estimate, "tracked"),
        Life::Coasting => (Role::Predicted, "predicted"),
    }
}

/// Where an object was in the frames before, up to where it is now.
pub(crate) fn trail(scene: &mut Scene, course: &Course, role: Role, (id, now): (u32, [f64; 2])) {
    let recent = course.frames().len().saturating_sub(TRAIL_FRAMES);
    let places = course.frames()[recent..].iter().filter_map(|frame| {
        frame.objects.iter().find(|object| object.id == id).map(|object| object.position.map(|c| c as f32))
    });
    let points: Vec<[f32; 2]> = places.chain([now.map(|c| c as f32)]).collect();
    if points.len() > 1 {
        scene.mark_of(id, Picture::Current, role, Shape::Path { points, closed: false });
    }
}

/// How many objects there are from frame to frame.
pub(crate) fn series(course: &Course) -> Option<Readout> {
    let frames = course.frames();
    let line = |of: &dyn Fn(&ObjectFrame) -> usize| -> Vec<[f32; 2]> {
        frames.iter().enumerate().map(|(i, frame)| [(course.span.first + i) as f32, of(frame) as f32]).collect()
    };
    let with = |life: Life| line(&move |frame| of_life(frame, life));
    let lines = vec![
        ("detected", Role::Measured, line(&|frame| frame.detections.len())),
        ("tracked", Role::Estimate, with(Life::Confirmed)),
        ("coasting", Role::Predicted, with(Life::Coasting)),
    ];
    let x_max = course.span.first + course.span.frames().map_or(frames.len(), |frames| frames - 1);
    let series = Series {
        title: "Objects",
        x_label: "frame",
        y_label: "objects",
        x_max,
        events: Vec::new(),
        sections: Vec::new(),
        lines,
    };
    (frames.len() > 1).then_some(Readout::Series(series))
}

fn of_life(frame: &ObjectFrame, life: Life) -> usize {
    frame.objects.iter().filter(|object| object.life == life).count()
}

/// What a frame came to, in words.
pub(crate) fn done(number: usize, frame: &ObjectFrame) -> String {
    let of = |life| of_life(frame, life);
    let [seen, coasting, tentative] = [Life::Confirmed, Life::Coasting, Life::Tentative].map(of);
    format!("Frame {number} is over: {seen} seen, {coasting} coasting, {tentative} tentative.")
}
