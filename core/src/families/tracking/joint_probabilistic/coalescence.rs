//! The end of a run: whether the tracks of neighbours were nearer to each other than the objects.

use super::vocabulary::{case, value};
use crate::data::{Clip, ObjectBox};
use crate::geometry::Bounds;
use crate::methods::multi_object::tracker_run::TrackerRun;
use crate::products::{Object, ObjectFrame, TrackStatus};
use crate::scene::Step;

/// Tracks this much nearer to each other than the objects have coalesced.
const COALESCED: f64 = 0.75;
/// Frames with more objects are not compared pair by pair.
const MOST_OBJECTS: usize = 100;

/// The distances of the nearest objects and of their tracks, over the frames in which objects were neighbours: nearer to each
/// other than the longest of their sides. Frames in which one of the two has no confirmed track do not count.
pub(super) struct Neighbors {
    frames: usize,
    /// Mean distance of the objects in px.
    truth_px: f64,
    /// Mean distance of the tracks in px.
    tracks_px: f64,
}

impl Neighbors {
    /// Returns the distances of a run; `None` without the truth, or without neighbours.
    pub(super) fn of(run: &TrackerRun, clip: &Clip) -> Option<Self> {
        let truth = clip.truth()?;
        let each = run.frames().iter().enumerate().filter_map(|(i, frame)| {
            let known = truth.objects(run.span.first + i).ok()??;
            let (objects, distance) = neighbors(&known)?;
            Some([distance, apart(&frame_tracks(frame), &objects)?])
        });
        let all: Vec<[f64; 2]> = each.collect();
        let mean = |i: usize| all.iter().map(|pair| pair[i]).sum::<f64>() / all.len() as f64;
        (!all.is_empty()).then(|| Self { frames: all.len(), truth_px: mean(0), tracks_px: mean(1) })
    }

    /// Says whether the tracks were nearer to each other than the objects, and why.
    pub(super) fn tell(step: Step, of: Self) -> Step {
        let step = step.put(value::NEIGHBOUR_FRAMES, of.frames).put(value::TRUE_DISTANCE, of.truth_px);
        let has_coalesced = of.tracks_px < COALESCED * of.truth_px;
        let step = step.put(value::TRACK_DISTANCE, of.tracks_px);
        step.say(if has_coalesced { case::COALESCENCE } else { case::NO_COALESCENCE })
    }
}

fn frame_tracks(frame: &ObjectFrame) -> Vec<&Object> {
    frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed).collect()
}

/// The boxes of the two nearest true objects and their distance in px, if they are neighbours.
fn neighbors(known: &[ObjectBox]) -> Option<([Bounds; 2], f64)> {
    let boxes: Vec<Bounds> = known.iter().filter(|object| object.visibility > 0.0).map(Bounds::from).collect();
    if boxes.len() > MOST_OBJECTS {
        return None;
    }
    let center = |bounds: &Bounds| bounds.center().map(f64::from);
    let pairs = boxes.iter().enumerate().flat_map(|(i, a)| boxes[..i].iter().map(move |b| [*a, *b]));
    let nearest = pairs.map(|pair| (pair, distance(pair.each_ref().map(center)))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let longest = nearest.0.iter().flat_map(Bounds::size).fold(0.0, f32::max);
    Some(nearest).filter(|(_, distance)| *distance < f64::from(longest))
}

/// The distance in px of the two tracks that overlap two objects most, together; none where one object has no track of its own.
fn apart(tracks: &[&Object], objects: &[Bounds; 2]) -> Option<f64> {
    let overlap = |track: &Object, object: &Bounds| Some(track.bounds.iou(object)).filter(|iou| *iou > 0.0);
    let pairs = tracks.iter().flat_map(|a| tracks.iter().map(move |b| [*a, *b])).filter(|[a, b]| a.id != b.id);
    let rated = pairs.filter_map(|pair| {
        let [first, second] = [overlap(pair[0], &objects[0])?, overlap(pair[1], &objects[1])?];
        Some((first + second, pair))
    });
    let (_, pair) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(distance(pair.map(|track| track.position)))
}

fn distance([a, b]: [[f64; 2]; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
