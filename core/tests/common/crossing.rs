//! Objects that cross in clutter, as detections, and the errors of trackers on them.
#![allow(dead_code, reason = "each program uses its part of it")]

use std::sync::Arc;

use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Detection, ObjectBox};
use motionscope_core::geometry::Bounds;
use motionscope_core::products::ObjectField;
use motionscope_core::products::objects::score::{Scores, scores};
use motionscope_core::run::AnyEstimator;

use super::common::{Objects, set};

/// Numbers of 0 to 1, and normal ones.
pub struct Dice(pub u64);

impl Dice {
    /// A number of 0 to 1.
    pub fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
        let mixed = (self.0 ^ (self.0 >> 33)).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
        ((mixed ^ (mixed >> 29)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number of the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.roll()).ln()).sqrt() * (std::f64::consts::TAU * self.roll()).cos()
    }
}

/// Width and height of the picture in px.
pub const PICTURE: (usize, usize) = (320, 240);
/// Width and height of the boxes in px.
pub const HEIGHT: f32 = 20.0;

/// A detection at a place.
pub fn found(center: [f64; 2]) -> Detection {
    let center = center.map(|c| c as f32);
    Detection { bounds: Bounds::around(center, [HEIGHT; 2]), center, score: 0.9, blob: None, deviation_px: None }
}

/// A clip of detections.
pub fn rows(frames: Vec<Vec<Detection>>) -> Clip {
    Clip::blank("rows", PICTURE, frames.len()).with_detections(frames)
}

/// The tracks of a clip.
pub fn run(estimator: &dyn AnyEstimator, clip: &Clip) -> ObjectField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<ObjectField>().expect("objects").clone()
}

/// The scores of tracks.
pub fn scored(field: &ObjectField, clip: &Clip) -> Scores {
    scores(field, &**clip.truth().expect("exact")).expect("readable").expect("objects")
}

/// Two objects that cross at a small angle, each detected in 9 of 10 frames, with false alarms around them.
pub fn crossing(seed: u64) -> Clip {
    const FRAMES: usize = 40;
    let mut dice = Dice(seed);
    let place = |id: u32, t: usize| {
        let x = 40.0 + 6.0 * t as f64;
        if id == 1 { [x, 90.0 + 1.5 * t as f64] } else { [x, 150.0 - 1.5 * t as f64] }
    };
    let object = |id: u32, t: usize| {
        let [x, y] = place(id, t).map(|c| c as f32 - HEIGHT / 2.0);
        ObjectBox { id, x, y, width: HEIGHT, height: HEIGHT, visibility: 1.0 }
    };
    let mut frame = |t: usize| {
        let mut all = Vec::new();
        for id in [1, 2] {
            if dice.roll() < 0.9 {
                all.push(found(place(id, t).map(|c| c + 2.0 * dice.normal())));
            }
        }
        for _ in 0..3 {
            // In the strip of the objects, where they are in the way.
            all.push(found([320.0 * dice.roll(), 80.0 + 80.0 * dice.roll()]));
        }
        all
    };
    let detections = (0..FRAMES).map(&mut frame).collect();
    let truth = (0..FRAMES).map(|t| vec![object(1, t), object(2, t)]).collect();
    rows(detections).with_truth(Arc::new(Objects(truth)))
}

/// Parameters that describe those detections, for all trackers alike.
pub const OF_CROSSING: [(&str, &str); 4] =
    [("source", "detections"), ("measurement-noise", "0.1"), ("process-noise", "0.02"), ("max-age", "6")];

/// The sums of identity switches and of IDF1 over clips.
fn sums(fields: impl Iterator<Item = Scores>) -> (usize, f64) {
    fields.fold((0, 0.0), |(switches, idf1), scores| (switches + scores.switches, idf1 + scores.idf1))
}

/// The number of clips with a crossing.
pub const SEEDS: u64 = 100;

/// The sums of identity switches and of IDF1 over `seeds` clips with a crossing.
pub fn crossings(id: &str, settings: &[(&str, &str)], seeds: u64) -> (usize, f64) {
    let tracker = set(id, &[&OF_CROSSING[..], settings].concat());
    sums((1..=seeds).map(|seed| {
        let clip = crossing(seed);
        scored(&run(&*tracker, &clip), &clip)
    }))
}
