//! Every estimator ends, at every corner of its parameters, within a bound on work that is counted.

use std::sync::Arc;

use crate::common::{Objects, waves};
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Detection, Frame, ObjectBox};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::params::{Kind, Value};
use motionscope_core::run::{AnyEstimator, Move, Walk};

const SIZE: (usize, usize) = (64, 48);
const FRAMES: usize = 4;

/// Waves that move, with some boxes that move with them, and noise.
fn clip() -> Clip {
    let noise = |x: usize, y: usize, t: usize| {
        let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (t as u64 * 0xC2B2_AE35);
        (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 58) as f64 - 32.0
    };
    let value = |x: usize, y: usize, t: usize| {
        (waves(x as f64 - 0.7 * t as f64, y as f64 + 0.4 * t as f64) + 0.3 * noise(x, y, t)).clamp(0.0, 255.0) as u8
    };
    let frame = |t| Frame::rgb(Grid::from_fn(SIZE.0, SIZE.1, |x, y| [value(x, y, t), value(y, x, t), 128]));
    let object = |id: u32, t: usize| ObjectBox {
        id,
        x: 7.0 * (id % 8) as f32 + 0.7 * t as f32,
        y: 12.0 * (id / 8) as f32 - 0.4 * t as f32,
        width: 9.0,
        height: 11.0,
        visibility: 1.0,
    };
    let objects: Vec<Vec<ObjectBox>> = (0..FRAMES).map(|t| (1..25).map(|id| object(id, t)).collect()).collect();
    let found = |object: &ObjectBox| {
        let bounds = Bounds::from(object);
        Detection { bounds, center: bounds.center(), score: 0.7, blob: None, deviation_px: None }
    };
    let detections = objects.iter().map(|objects| objects.iter().map(found).collect()).collect();
    let clip = Clip::from_frames("waves", (0..FRAMES).map(frame).collect()).expect("frames of one size");
    clip.with_detections(detections).with_truth(Arc::new(Objects(objects)))
}

/// The least and the largest value of a parameter, or all that it may be.
fn corners(kind: &Kind) -> Vec<Value> {
    match kind {
        Kind::Int { min, max } => vec![Value::Int(*min), Value::Int(*max)],
        Kind::Real { min, max } => vec![Value::Real(*min), Value::Real(*max)],
        Kind::Switch => vec![Value::Switch(false), Value::Switch(true)],
        Kind::Choice(all) => all.iter().map(|choice| Value::Choice(choice.name)).collect(),
        Kind::Stage(kind) => {
            kind.ids().into_iter().map(|id| Value::Stage(kind.parse(id).expect("one of its own"))).collect()
        }
        Kind::Placed(figure) => vec![Value::Placed(figure.none()), Value::Placed(figure.spanned([8.0; 2], [40.0; 2]))],
        Kind::Optional { of, word } => [corners(of), vec![Value::Choice(word)]].concat(),
    }
}

/// Values of parameters, by their index.
type Setting = Vec<(usize, Value)>;

/// So many pairs of corners are tried of each estimator, and as many where every parameter is at a corner.
const SAMPLES: usize = 7;

/// The defaults, each corner by itself, pairs of corners, and corners of all parameters at once: the first ones, the last ones, and
/// some by chance.
fn settings(estimator: &dyn AnyEstimator) -> Vec<Setting> {
    let all: Vec<Vec<Value>> = estimator.specs().iter().map(|spec| corners(&spec.kind)).collect();
    let mut settings: Vec<Setting> = vec![Vec::new()];
    for (i, values) in all.iter().enumerate() {
        settings.extend(values.iter().map(|value| vec![(i, value.clone())]));
    }
    let mut state = 20_240_607_u64;
    let mut dice = |count: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    for _ in 0..SAMPLES {
        let mut pick = |i: usize| (i, all[i][dice(all[i].len())].clone());
        let whole: Setting = (0..all.len()).map(&mut pick).collect();
        let (a, b) = (dice(all.len()), dice(all.len()));
        settings.push(whole.iter().filter(|(i, _)| *i == a || *i == b).cloned().collect());
        settings.push(whole);
    }
    let at = |pick: fn(&Vec<Value>) -> Option<&Value>| -> Setting {
        all.iter().enumerate().filter_map(|(i, values)| Some((i, pick(values)?.clone()))).collect()
    };
    settings.extend([at(|values| values.first()), at(|values| values.last())]);
    settings
}

/// No run on so small a picture has more units.
const MOST_UNITS: usize = 50_000;
/// Nor more events in all: a full search of ±64 px tests 16 641 candidates for each of 192 blocks.
const MOST_EVENTS: u64 = 5_000_000;
/// Of longer runs only the units are counted: each tells the few steps of one iteration.
const COUNTED_UNITS: usize = 5000;

/// How many corners there were.
#[derive(Debug, Default)]
struct Tried {
    /// That ran to their end, of so many with all their events counted.
    ran: usize,
    counted: usize,
    /// That were refused in a sentence: a block is larger than the picture, a pyramid has too many levels.
    refused: usize,
}

/// The units up to the end, or as many as there may be.
fn counted(walk: &mut dyn Walk) -> usize {
    let mut units = 1;
    walk.go(Move::End);
    walk.work(&mut || {
        units += 1;
        units < MOST_UNITS
    });
    units
}

/// Runs the estimators of a family at their corners.
fn tried(is_one: impl Fn(&str) -> bool) -> Tried {
    let (clip, mut tried) = (clip(), Tried::default());
    for estimator in estimators().into_iter().filter(|estimator| is_one(estimator.info().family)) {
        let id = estimator.info().id;
        for setting in settings(&*estimator) {
            let mut estimator = estimator.boxed_clone();
            for (i, value) in &setting {
                estimator.set_value(*i, value.clone()).expect("a corner is allowed");
            }
            let told = || -> Vec<String> {
                setting.iter().map(|(i, value)| format!("{}={value}", estimator.specs()[*i].name)).collect()
            };
            let mut walk = match estimator.walk(&clip, 0) {
                Ok(walk) => walk,
                Err(error) => {
                    assert!(error.to_string().len() > 20, "{id} {:?}: {error}", told());
                    tried.refused += 1;
                    continue;
                }
            };
            // How many units there are may be known; else one after the other is counted.
            let units = walk.units().filter(|units| *units <= COUNTED_UNITS).unwrap_or_else(|| counted(&mut *walk));
            assert!(units < MOST_UNITS && walk.failure().is_none(), "{id} {:?}: {units} units and no end", told());
            if units <= COUNTED_UNITS {
                let extent = estimator.extent(&clip, 0).expect("it ran before");
                assert!(extent.units <= MOST_UNITS, "{id} {:?}: {} units", told(), extent.units);
                assert!(extent.events <= MOST_EVENTS, "{id} {:?}: {} events", told(), extent.events);
                tried.counted += 1;
            }
            tried.ran += 1;
        }
    }
    println!("{tried:?}");
    tried
}

#[test]
fn every_corner_of_a_block_search_ends() {
    let Tried { ran, counted, refused } = tried(|family| family == "Block matching");
    assert!(ran > 300 && counted == ran && refused < ran / 3, "{ran} ran, {refused} were refused");
}

#[test]
fn every_corner_of_optical_flow_ends() {
    let Tried { ran, counted, refused } = tried(|family| family == "Optical flow");
    assert!(ran > 300 && counted > ran - 30 && refused == 0, "{ran} ran, {counted} counted, {refused} were refused");
}

#[test]
fn every_corner_of_all_others_ends() {
    let Tried { ran, counted, refused } = tried(|family| family != "Block matching" && family != "Optical flow");
    assert!(ran > 400 && counted == ran && refused < 30, "{ran} ran, {counted} counted, {refused} were refused");
}
