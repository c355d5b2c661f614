//! Marks of tracks and detections.

use std::collections::BTreeMap;

use super::lifecycle::TrackAge;
use super::tracker_run::TrackerRun;
use crate::data::Detection;
use crate::geometry::Bounds;
use crate::methods::kalman::{Filter, ellipse};
use crate::products::{ObjectFrame, TrackStatus};
use crate::scene::{Arrow, Picture, Readout, Role, Scene, Series, Shape};

/// The length of a drawn trail in frames.
const TRAIL_FRAMES: usize = 40;

/// A track with a filter, as steps show it.
#[derive(Clone, Copy)]
pub(crate) struct ShownTrack<'a> {
    pub id: u32,
    pub filter: &'a Filter,
    pub bounds: Bounds,
    pub age: TrackAge,
}

impl ShownTrack<'_> {
    /// Draws the box, the 95 % ellipse and the number.
    pub fn draw(&self, scene: &mut Scene, (role, meaning): (Role, &'static str)) {
        rect(scene, role, self.bounds);
        if let Some(shape) = ellipse(self.filter.place(), self.filter.place_covariance(), 0.95) {
            scene.mark(Picture::CURRENT, role, shape);
        }
        label(scene, role, self.bounds.min, self.id.to_string());
        scene.legend(role, meaning);
    }

    /// Draws it with its trajectory, by its status.
    pub fn draw_with_trail(&self, scene: &mut Scene, run: &TrackerRun) {
        let role = role(self.age.status);
        trail(scene, run, role.0, (self.id, self.filter.place()));
        self.draw(scene, role);
    }
}

/// Draws the tracks within a frame: as changed by `done`, without those deleted by it, or else as predicted.
pub(crate) fn draw_progress<'a>(
    scene: &mut Scene,
    run: &TrackerRun,
    predicted: impl Iterator<Item = ShownTrack<'a>>,
    done: impl Iterator<Item = (u32, Option<ShownTrack<'a>>)>,
) {
    let mut now: BTreeMap<u32, (ShownTrack, bool)> = predicted.map(|track| (track.id, (track, false))).collect();
    for (id, track) in done {
        match track {
            Some(track) => _ = now.insert(id, (track, true)),
            None => _ = now.remove(&id),
        }
    }
    for (track, is_done) in now.into_values() {
        match is_done {
            true => track.draw_with_trail(scene, run),
            false => track.draw(scene, (Role::Predicted, "prediction")),
        }
    }
}

pub(crate) fn rect(scene: &mut Scene, role: Role, Bounds { min, max }: Bounds) {
    scene.mark(Picture::CURRENT, role, Shape::Rect { min, max });
}

/// Draws the arrows from tracks to detections of several roles.
pub(crate) fn draw_arrows<const N: usize>(scene: &mut Scene, all: [(Role, &'static str, Vec<Arrow>); N]) {
    for (role, meaning, arrows) in all.into_iter().filter(|(.., arrows)| !arrows.is_empty()) {
        scene.draw(Picture::CURRENT, (role, meaning), Shape::Arrows(arrows));
    }
}

/// Room around the objects of a step, in sizes of the largest box, so that their surroundings are visible.
const AROUND: f32 = 2.5;

/// Makes the surroundings of an object the work area of the step, so that the stage shows the subject of the sentence.
pub(crate) fn work_at(scene: &mut Scene, bounds: Bounds) {
    work_on(scene, [bounds]);
}

/// The same of several objects, such as the tracks and the detections of a cluster.
pub(crate) fn work_on(scene: &mut Scene, all: impl IntoIterator<Item = Bounds>) {
    let side = |bounds: &Bounds| bounds.size().into_iter().fold(0.0, f32::max);
    let around = |(one, largest): (Bounds, f32), (other, side): (Bounds, f32)| {
        let min = [0, 1].map(|i| one.min[i].min(other.min[i]));
        let max = [0, 1].map(|i| one.max[i].max(other.max[i]));
        (Bounds { min, max }, largest.max(side))
    };
    let hull = all.into_iter().map(|bounds| (bounds, side(&bounds))).reduce(around);
    let room = |(Bounds { min, max }, largest): (Bounds, f32)| {
        let room = AROUND * largest;
        [min.map(|c| c - room), max.map(|c| c + room)]
    };
    scene.work = hull.map(room);
}

pub(crate) fn draw_detections<'a>(scene: &mut Scene, all: impl IntoIterator<Item = &'a Detection>) {
    all.into_iter().for_each(|found| rect(scene, Role::Measured, found.bounds));
    scene.legend(Role::Measured, "detection");
}

/// Writes the numbers of detections below their boxes.
pub(crate) fn number_detections<'a>(scene: &mut Scene, all: impl IntoIterator<Item = &'a Detection>) {
    for (i, Detection { bounds: Bounds { min, max }, .. }) in all.into_iter().enumerate() {
        label(scene, Role::Measured, [min[0], max[1]], format!("d{}", i + 1));
    }
}

/// Writes the name of a track above its box.
pub(crate) fn label(scene: &mut Scene, role: Role, at: [f32; 2], text: String) {
    let text = Shape::Text { at, text };
    if text.is_finite() {
        scene.mark(Picture::CURRENT, role, text);
    }
}

/// The role of a track in the picture, and its meaning in the legend.
pub(crate) fn role(status: TrackStatus) -> (Role, &'static str) {
    match status {
        TrackStatus::Tentative => (Role::Candidate, "tentative track"),
        TrackStatus::Confirmed => (Role::Estimate, "confirmed track"),
        TrackStatus::Coasting => (Role::Predicted, "coasting track"),
    }
}

/// Draws the recent trajectory of a track.
pub(crate) fn trail(scene: &mut Scene, run: &TrackerRun, role: Role, (id, now): (u32, [f64; 2])) {
    let recent = run.frames().len().saturating_sub(TRAIL_FRAMES);
    let places = run.frames()[recent..]
        .iter()
        .filter_map(|frame| frame.object(id).map(|object| object.position.map(|c| c as f32)));
    let points: Vec<[f32; 2]> = places.chain([now.map(|c| c as f32)]).collect();
    if points.len() > 1 {
        scene.mark_of(id, Picture::CURRENT, role, Shape::line(points));
    }
}

/// The plot of detections and tracks of each frame.
pub(crate) fn series(run: &TrackerRun) -> Option<Readout> {
    let frames = run.frames();
    let line = |of: &dyn Fn(&ObjectFrame) -> usize| -> Vec<[f32; 2]> {
        frames.iter().enumerate().map(|(i, frame)| [(run.span.first + i) as f32, of(frame) as f32]).collect()
    };
    let with = |status: TrackStatus| line(&move |frame| of_status(frame, status));
    let lines = vec![
        ("detections", Role::Measured, line(&|frame| frame.detections.len())),
        ("confirmed tracks", Role::Estimate, with(TrackStatus::Confirmed)),
        ("coasting tracks", Role::Predicted, with(TrackStatus::Coasting)),
    ];
    let x_max = run.span.first + run.span.frames().map_or(frames.len(), |frames| frames - 1);
    let series = Series {
        decimals: Some(0),
        ..Series::new("Detections and tracks of finished frames", ["frame", "number per frame"], x_max, lines)
    };
    (frames.len() > 1).then_some(Readout::Series(series))
}

pub(super) fn of_status(frame: &ObjectFrame, status: TrackStatus) -> usize {
    frame.objects.iter().filter(|object| object.status == status).count()
}
