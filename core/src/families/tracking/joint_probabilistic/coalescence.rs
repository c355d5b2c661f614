//! The end of a run: whether the tracks of neighbours were nearer to each other than the objects.

use crate::base::words::counted;
use crate::data::{Clip, ObjectBox};
use crate::geometry::Bounds;
use crate::methods::multi_object::tracker_run::TrackerRun;
use crate::methods::numbers::px;
use crate::products::{ObjectFrame, TrackStatus};

/// Tracks this much nearer to each other than the objects have coalesced.
const COALESCED: f64 = 0.75;
/// Frames with more objects are not compared pair by pair.
const MOST_OBJECTS: usize = 100;

/// The distances of the nearest objects and of the nearest tracks, over the frames in which objects were neighbours: nearer to each
/// other than their longer side.
pub(super) struct Neighbors {
    frames: usize,
    /// Mean distance of the objects in px.
    truth_px: f64,
    /// Mean distance of the tracks in px.
    tracks_px: f64,
}

impl Neighbors {
    /// Those of a run; none without the truth, or without neighbours.
    pub(super) fn of(run: &TrackerRun, clip: &Clip) -> Option<Self> {
        let truth = clip.truth()?;
        let each = run.frames().iter().enumerate().filter_map(|(i, frame)| {
            let known = truth.objects(run.span.first + i).ok()??;
            Some([neighbors(&known)?, nearest(&tracked(frame))?])
        });
        let all: Vec<[f64; 2]> = each.collect();
        let mean = |i: usize| all.iter().map(|pair| pair[i]).sum::<f64>() / all.len() as f64;
        (!all.is_empty()).then(|| Self { frames: all.len(), truth_px: mean(0), tracks_px: mean(1) })
    }

    /// What became of them, and why.
    pub(super) fn sentence(&self) -> String {
        let (name, why) = if self.tracks_px < COALESCED * self.truth_px {
            (
                "Coalescence",
                "Both tracks were updated with the same detections; multiple hypotheses assign each detection to one track.",
            )
        } else {
            ("No coalescence", "Soft association did not draw them together.")
        };
        format!(
            "{name}: neighbouring objects were {} px apart on average over {}, and their tracks {} px. {why} ",
            px(self.truth_px),
            counted(self.frames, "frame"),
            px(self.tracks_px)
        )
    }
}

/// The positions of the confirmed tracks of a frame.
fn tracked(frame: &ObjectFrame) -> Vec<[f64; 2]> {
    let confirmed = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed);
    confirmed.map(|object| object.position).collect()
}

/// The smallest distance of two true objects, if these are neighbours.
fn neighbors(known: &[ObjectBox]) -> Option<f64> {
    let boxes: Vec<Bounds> = known.iter().filter(|object| object.visibility > 0.0).map(Bounds::from).collect();
    let longer = boxes.iter().flat_map(Bounds::size).fold(0.0, f32::max);
    let centers: Vec<[f64; 2]> = boxes.iter().map(|bounds| bounds.center().map(f64::from)).collect();
    nearest(&centers).filter(|distance| *distance < f64::from(longer))
}

/// The smallest distance of two places; none without two.
fn nearest(places: &[[f64; 2]]) -> Option<f64> {
    if places.len() > MOST_OBJECTS {
        return None;
    }
    let pairs = places.iter().enumerate().flat_map(|(i, a)| places[..i].iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).reduce(f64::min)
}
