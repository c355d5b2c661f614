//! Every estimator on small clips, with one parameter after the other changed, and each of its steps looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, LazyLock};

use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Detection, Frame, ObjectBox};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::params::{Kind, Params, Placed, Spec, Spot, Value};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Guarantee, Info, Move, Walk};
use motionscope_core::scene::pseudocode::{Line, Name, is_heading};
use motionscope_core::scene::{Asked, Focus, Question, Role, Shown, Step, asked};
use motionscope_core::synth;
use rayon::prelude::*;

use super::texts::{Texts, stripped};
use crate::common::{Objects, waves};

/// The size of a picture of which each part does something else.
pub const PARTS: (usize, usize) = (48, 36);
/// The size of a picture with objects.
pub const SIZE: (usize, usize) = (64, 48);

/// Frames in which each part of the picture does something else: from the upper left, one rests, one moves a little, one far
/// and against the others, one has edges in a single direction, one has no texture, and one becomes another picture.
pub fn parts(frames: usize) -> Clip {
    let (width, height) = (PARTS.0 / 3, PARTS.1 / 2);
    let value = |t: usize, x: usize, y: usize| {
        let (s, u, v) = (t as f64, x as f64, y as f64);
        match (x / width, y / height) {
            (0, 0) => waves(u, v),
            (1, 0) => waves(u - 1.0 * s, v - 0.4 * s),
            (2.., 0) => waves(u - 4.0 * s, v + 3.0 * s),
            (0, _) => 128.0 + 90.0 * ((u - 0.7 * s) / 3.0).sin(),
            (1, _) => 90.0,
            _ => waves(u + 311.0 * s, v - 97.0 * s),
        }
    };
    let frame = |t| Frame::gray(Grid::from_fn(PARTS.0, PARTS.1, |x, y| value(t, x, y).clamp(0.0, 255.0) as u8));
    Clip::from_frames("parts", (0..frames).map(frame).collect()).expect("frames of one size")
}

/// Boxes that move over a wall: a pair that meets and parts, one that hides for some frames, one that stops, one that is seen
/// once and one that comes from elsewhere after all others have gone by.
pub fn boxes(t: usize) -> Vec<ObjectBox> {
    let t = t as f32;
    let all = [
        (1, [2.0 + 2.0 * t, 6.0], [10.0, 8.0], 0.0..99.0),
        (2, [52.0 - 2.0 * t, 8.0], [8.0, 9.0], 0.0..99.0),
        (3, [4.0 + 3.0 * t, 24.0], [9.0, 9.0], 0.0..8.0),
        (3, [4.0 + 3.0 * t, 24.0], [9.0, 9.0], 12.0..18.0),
        (4, [40.0 - 3.0 * t.min(6.0), 36.0], [9.0, 9.0], 0.0..99.0),
        (5, [28.0, 20.0], [8.0, 8.0], 10.0..11.0),
        (6, [54.0, 2.0 + 4.0 * (t - 20.0)], [8.0, 8.0], 20.0..99.0),
    ];
    let there = all.into_iter().filter(|(.., when)| when.contains(&t));
    let boxed = there.map(|(id, [x, y], [width, height], _)| ObjectBox { id, x, y, width, height, visibility: 1.0 });
    boxed.collect()
}

/// Those boxes in front of a wall, with their shadows, what a detector makes of them, and the truth.
pub fn objects(frames: usize) -> Clip {
    let frame = |t: usize| {
        let (all, noise) = (boxes(t), |x: usize, y: usize| ((x * 7 + y * 13 + t * 5) % 5) as f64);
        Frame::rgb(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (u, v) = (x as f32, y as f32);
            let inside = |b: &&ObjectBox| (b.x..b.x + b.width).contains(&u) && (b.y..b.y + b.height).contains(&v);
            let shaded =
                |b: &ObjectBox| (b.x..b.x + b.width).contains(&u) && (0.0..4.0).contains(&(v - b.y - b.height));
            // A speck that opening takes off.
            if (x, y, t % 3) == (62, 46, 1) {
                return [250; 3];
            }
            if is_black((x, y)) {
                return [0; 3];
            }
            match all.iter().find(inside) {
                Some(found) => [220 - 20 * found.id as u8, 200, 60 + 10 * found.id as u8],
                None => {
                    let wall = 60.0 + 0.5 * waves(u.into(), v.into()) + noise(x, y);
                    let shade = if all.iter().any(shaded) { 0.65 } else { 1.0 };
                    [1.0, 0.9, 0.8].map(|tint| (wall * tint * shade) as u8)
                }
            }
        }))
    };
    let clip = Clip::from_frames("boxes", (0..frames).map(frame).collect()).expect("frames of one size");
    let truth = (0..frames).map(boxes).collect::<Vec<_>>();
    let detections = truth.iter().enumerate().map(|(t, all)| detected(t, all)).collect();
    clip.with_detections(detections).with_truth(Arc::new(Objects(truth)))
}

/// Whether a pixel belongs to one of two black figures on the wall: a ring, and a U whose arms meet at its end.
pub fn is_black((x, y): (usize, usize)) -> bool {
    let is_in =
        |[left, right]: [usize; 2], [top, bottom]: [usize; 2]| (left..right).contains(&x) && (top..bottom).contains(&y);
    // Their insides are wider than what closing fills.
    let is_ring = is_in([1, 19], [28, 46]) && !is_in([4, 16], [31, 43]);
    is_ring || is_in([40, 58], [28, 46]) && !is_in([43, 55], [28, 43])
}

/// What a detector makes of boxes: those that overlap are one, one of them it is not sure of now and then.
pub fn detected(t: usize, all: &[ObjectBox]) -> Vec<Detection> {
    let mut found: Vec<(Bounds, f32)> = Vec::new();
    for object in all {
        let (bounds, score) = (Bounds::from(object), if object.id == 4 && t % 4 == 3 { 0.45 } else { 0.9 });
        match found.iter_mut().find(|(other, _)| other.shared(&bounds) > 0.0) {
            Some((other, _)) => {
                other.min = [0, 1].map(|i| other.min[i].min(bounds.min[i]));
                other.max = [0, 1].map(|i| other.max[i].max(bounds.max[i]));
            }
            None => found.push((bounds, score)),
        }
    }
    let detection = |(bounds, score): (Bounds, f32)| Detection {
        bounds,
        center: bounds.center(),
        score,
        blob: None,
        deviation_px: None,
    };
    found.into_iter().map(detection).collect()
}

/// What keeps whole runs small, where there is such a parameter.
pub const SMALL: [(&str, &str); 8] = [
    ("block-size", "8"),
    ("search-range", "5"),
    ("levels", "2"),
    ("warps", "2"),
    ("iterations", "2"),
    ("max-points", "12"),
    ("window", "7"),
    ("spacing", "12"),
];

/// The values that a parameter is tried with: each choice, a switch both ways, a number at its least and a little beyond, and
/// things placed on the picture.
pub fn tried(kind: &Kind) -> Vec<Value> {
    match kind {
        Kind::Int { min, max } => vec![Value::Int(*min), Value::Int((*max).min(min + 9))],
        Kind::Real { min, max } => vec![Value::Real(*min), Value::Real(*max)],
        Kind::Switch => vec![Value::Switch(false), Value::Switch(true)],
        Kind::Choice(all) => all.iter().map(|choice| Value::Choice(choice.name)).collect(),
        Kind::Stage(kind) => {
            kind.ids().into_iter().map(|id| Value::Stage(kind.parse(id).expect("one of its own"))).collect()
        }
        Kind::Placed(figure) => {
            let (width, height) = (SIZE.0 as f32, SIZE.1 as f32);
            let spanned = figure.spanned([width / 2.0, height], [width / 2.0 + 9.0, 0.0]);
            let spots = [(0, [6.0, 10.0]), (1, [8.0, 10.0]), (2, [10.0, 10.0])];
            let place = |placed: Placed, (frame, at)| placed.with(Spot { frame, at });
            vec![Value::Placed(figure.none()), Value::Placed(spots.into_iter().fold(spanned, place))]
        }
        Kind::Optional { of, word } => [tried(of), vec![Value::Choice(word)]].concat(),
    }
}

/// A stage with one choice after the other among its own parameters.
pub fn chosen_otherwise(stage: &Value) -> Vec<Value> {
    let Value::Stage(stage) = stage else { return Vec::new() };
    let specs = stage.part().specs().iter().enumerate();
    let choices = specs.filter(|(_, spec)| matches!(spec.kind, Kind::Choice(_)));
    let one = |(i, value): (usize, Value)| {
        let mut other = stage.clone();
        other.part_mut().set_value(i, value).expect("in range");
        Value::Stage(other)
    };
    choices.flat_map(|(i, spec)| tried(&spec.kind).into_iter().map(move |value| (i, value))).map(one).collect()
}

/// Settings tried together: a filter that expects neither a change of velocity nor much noise follows the box that stops, and
/// diverges.
const TOGETHER: [(&str, &str); 3] = [("object", "4"), ("process-noise", "0"), ("measurement-noise", "0.5")];

/// An estimator at its defaults, but small, and with one parameter after the other set to what it is tried with.
pub fn settings(estimator: &dyn AnyEstimator) -> Vec<Box<dyn AnyEstimator>> {
    let mut small = estimator.boxed_clone();
    for (name, value) in SMALL {
        if small.get(name).is_ok() {
            small.set(name, value).expect("in range");
        }
    }
    let one = |(i, value): (usize, Value)| {
        let mut other = small.boxed_clone();
        other.set_value(i, value).expect("in range");
        other
    };
    let of_one = |spec: &Spec| [tried(&spec.kind), chosen_otherwise(&spec.default)].concat();
    let values = small.specs().iter().enumerate().flat_map(|(i, spec)| of_one(spec).into_iter().map(move |v| (i, v)));
    let changed: Vec<_> = values.filter(|(i, value)| small.value(*i) != *value).map(one).collect();
    let mut together = small.boxed_clone();
    let has_all = TOGETHER.iter().all(|(name, value)| together.set(name, value).is_ok());
    [small].into_iter().chain(changed).chain(has_all.then_some(together)).collect()
}

/// What was seen of an estimator.
#[derive(Default)]
pub struct Seen {
    pub lit: BTreeSet<Name>,
    /// The lines of each sentence without its numbers, and one with them.
    pub sentences: BTreeMap<String, (BTreeSet<Name>, String)>,
    pub unknown: BTreeSet<Name>,
    pub runs: usize,
    pub refused: usize,
    /// Everything that its steps say.
    pub texts: Texts,
    /// The roles of the marks at the steps of each line.
    pub marked: BTreeSet<(Name, Role)>,
    /// The values that steps of each line show, by their names.
    pub values: BTreeSet<(Name, &'static str)>,
    /// The cases of questions that steps are: the id of the question and the index of its first case that holds.
    pub cases: BTreeSet<(&'static str, usize)>,
    /// The questions that are asked when it is walked event by event.
    pub asked: BTreeSet<&'static str>,
    turn: usize,
}

impl Seen {
    pub fn see(&mut self, info: &Info, step: &Step) {
        self.texts.add_step(step);
        if info.line(step.line).is_none() {
            self.unknown.insert(step.line);
        }
        self.lit.insert(step.line);
        let said = step.sentence.plain();
        self.sentences.entry(stripped(&said)).or_insert_with(|| (BTreeSet::new(), said)).0.insert(step.line);
    }

    /// Notes which case of each of the questions a step is.
    pub fn decide(&mut self, questions: &[Question], step: &Step) {
        for question in questions {
            let Asked::Choice(cases) = question.asked else { continue };
            let first = cases.iter().position(|case| case.holds(step));
            self.cases.extend(first.map(|case| (question.id, case)));
        }
    }

    /// Walks through a run, and looks at each step, and at some pixels that can be explained by then.
    fn walk(&mut self, walk: &mut dyn Walk, questions: &'static [Question]) {
        let (info, event) = (walk.info(), walk.info().granularities.len() - 1);
        self.runs += 1;
        let mut before = (walk.step(None), walk.scene(None));
        self.see(info, &before.0);
        self.decide(questions, &before.0);
        self.texts.add_scene(&before.1);
        while !walk.at_end() {
            walk.jump(Move::Granularity(event, Direction::Forward));
            assert!(walk.failure().is_none(), "{}: {:?}", info.id, walk.failure());
            let now = (walk.step(None), walk.scene(None));
            self.see(info, &now.0);
            self.decide(questions, &now.0);
            self.texts.add_scene(&now.1);
            self.values.extend(
                now.0
                    .values
                    .iter()
                    .filter(|value| value.rounded().is_some() && now.0.shows(value.of))
                    .map(|value| (now.0.line, value.of.name)),
            );
            self.marked.extend(now.1.marks.iter().map(|mark| (now.0.line, mark.role)));
            let [shown, next] = [&before, &now].map(|(step, scene)| Shown { step, scene });
            let turn = self.turn;
            self.turn += 1;
            self.asked.extend(asked(questions, shown, next, turn).map(|(question, _)| question.id));
            before = now;
            let Cursor { unit, event } = walk.cursor();
            let pixel = [(7 * unit + event) % SIZE.0, (11 * unit + 5 * event) % SIZE.1].map(|c| c as f32);
            let pixel = Focus::current(pixel);
            if event % 3 == 1 && walk.explained(pixel).is_some_and(|explained| explained.at(walk.cursor())) {
                let step = walk.step(Some(pixel));
                self.see(info, &step);
                self.decide(questions, &step);
            }
        }
    }

    /// The lines that no step was at. A heading is reached with its body: a run that is in there has passed it.
    pub fn unlit(&self, lines: &[Line]) -> Vec<Name> {
        let mut reached: Vec<bool> = lines.iter().map(|line| self.lit.contains(&line.name)).collect();
        for i in (0..lines.len()).rev().filter(|&i| is_heading(lines, i)) {
            let body = (i + 1..lines.len()).take_while(|&j| lines[j].depth() > lines[i].depth());
            reached[i] |= body.into_iter().any(|j| reached[j]);
        }
        lines.iter().zip(reached).filter(|(_, reached)| !reached).map(|(line, _)| line.name).collect()
    }
}

/// A wall past which the camera moves while its exposure grows.
fn panned(frames: usize) -> Clip {
    let value =
        |t: usize, x: usize, y: usize| waves(x as f64 - 1.2 * t as f64, y as f64 + 0.8 * t as f64) + 4.0 * t as f64;
    let frame = |t| Frame::gray(Grid::from_fn(96, 72, |x, y| value(t, x, y).clamp(0.0, 255.0) as u8));
    Clip::from_frames("panned", (0..frames).map(frame).collect()).expect("frames of one size")
}

/// Two frames that show different things.
fn unrelated() -> Clip {
    let frame = |t: usize| {
        let t = t as f64;
        Frame::gray(Grid::from_fn(PARTS.0, PARTS.1, |x, y| {
            waves(x as f64 + 311.0 * t, y as f64 * (1.0 + 0.7 * t)) as u8
        }))
    };
    Clip::from_frames("unrelated", (0..2).map(frame).collect()).expect("frames of one size")
}

/// A street past which two calibrated cameras drive, with moving objects.
fn street() -> Clip {
    let scene = synth::scene("drive").expect("a scene");
    let mut small = scene.difficulty();
    for (name, value) in [("width", "96"), ("height", "72"), ("frames", "3")] {
        small.set(name, value).expect("in range");
    }
    scene.clip(&small).expect("a clip")
}

/// Walks through all runs of an estimator.
fn seen(estimator: &dyn AnyEstimator, [parts, objects, street]: [&Clip; 3]) -> Seen {
    let mut seen = Seen::default();
    let clip = match estimator.guarantee() {
        Guarantee::Objects | Guarantee::Region => objects,
        Guarantee::SceneFlow => {
            // What is said without a right view.
            seen.walk(&mut *estimator.walk(parts, 0).expect("a run"), estimator.questions());
            street
        }
        _ => parts,
    };
    for setting in settings(estimator) {
        match setting.walk(clip, 0) {
            Ok(mut walk) => seen.walk(&mut *walk, estimator.questions()),
            Err(error) => {
                seen.refused += 1;
                seen.texts.add("refusal", &error.to_string());
            }
        }
    }
    // A camera that is followed has to move, and an exposure that is compensated to change.
    if estimator.get("camera").is_ok() {
        seen.walk(&mut *estimator.walk(&panned(5), 0).expect("a run"), estimator.questions());
    }
    // A model is kept where enough matches support it.
    if estimator.get("outliers").is_ok() {
        seen.walk(&mut *estimator.walk(&panned(2), 0).expect("a run"), estimator.questions());
        // And hypotheses are compared where not all are right.
        let mut spoiled = estimator.boxed_clone();
        spoiled.set("outliers", "0.4").expect("in range");
        seen.walk(&mut *spoiled.walk(&panned(2), 0).expect("a run"), estimator.questions());
    }
    // A peak is ambiguous between frames that have nothing in common.
    if estimator.get("min-snr").is_ok() {
        seen.walk(&mut *estimator.walk(&unrelated(), 0).expect("a run"), estimator.questions());
    }
    // Keypoints that reject each other need a picture with many of them.
    let is_detector = matches!(estimator.guarantee(), Guarantee::Places | Guarantee::SubPixelPlaces { .. });
    if is_detector && estimator.get("min-distance").is_ok() {
        let mut sparse = estimator.boxed_clone();
        for (name, value) in [("min-distance", "30"), ("max-points", "12")] {
            sparse.set(name, value).expect("in range");
        }
        seen.walk(&mut *sparse.walk(&panned(1), 0).expect("a run"), estimator.questions());
    }
    seen
}

/// The texts and lines of every estimator, collected once for all tests, on all cores, in the order of the course.
pub static ALL: LazyLock<Vec<(Box<dyn AnyEstimator>, Seen)>> = LazyLock::new(|| {
    let clips = [parts(3), objects(26), street()];
    let one = |estimator: Box<dyn AnyEstimator>| {
        let mut seen = seen(&*estimator, clips.each_ref());
        seen.texts.add_estimator(&*estimator);
        (estimator, seen)
    };
    estimators().into_par_iter().with_max_len(1).map(one).collect()
});
