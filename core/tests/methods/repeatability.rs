//! Repeatability of the detectors on a scene with known rotation, scale, blur, noise, gain and offset.

use crate::common::set;
use motionscope_core::base::Threads;
use motionscope_core::course::{detection, estimator};
use motionscope_core::data::Clip;
use motionscope_core::params::Params;
use motionscope_core::products::Reference;
use motionscope_core::synth;

/// The scene with some of its sliders moved.
fn scene(sliders: &[(&str, &str)]) -> Clip {
    let scene = synth::scene("pillar").expect("a scene");
    let mut difficulty = scene.difficulty();
    for (name, value) in [("width", "320"), ("height", "240"), ("frames", "2")].iter().chain(sliders) {
        difficulty.set(name, value).expect("in range");
    }
    synth::make(scene.id, &difficulty).expect("a clip")
}

/// The 200 strongest of a detector.
fn measured(id: &str, clip: &Clip) -> (f64, f64) {
    let detector = match id {
        "fast" => set(id, &[("max-points", "200"), ("min-distance", "0")]),
        _ => set(id, &[("max-points", "200")]),
    };
    let output = detector.run(clip, 0, &Threads::single()).expect("a run");
    let reference = Reference { clip, frame: 0 };
    let found = detection::repeatability(&*detector, &output, &reference, &Threads::single()).expect("a second run");
    let value = |key: &str| {
        let score = found.scores.iter().find(|score| score.measure.key == key);
        score.and_then(|score| score.value.real()).expect("the flow is known")
    };
    let (share, visible) = (value("repeatability"), value("visible_in_both"));
    assert!((value("repeated") - share * visible).abs() < 1e-6, "{id}: the share is that of both counts");
    (share, visible)
}

const CASES: [(&str, &[(&str, &str)]); 7] = [
    ("nothing", &[("speed", "0")]),
    ("rotation", &[("rotation", "10")]),
    ("scale", &[("scale-change", "5")]),
    ("blur", &[("motion-blur", "100")]),
    ("noise", &[("noise", "5")]),
    ("gain", &[("gain", "10")]),
    ("offset", &[("offset", "-10")]),
];

#[test]
fn the_stated_repeatability_is_reached() {
    let mut told = String::new();
    for id in DETECTORS {
        for (case, sliders) in CASES {
            let (share, of) = measured(id, &scene(sliders));
            told += &format!("{id} {case} {share:.3} {of}\n");
        }
    }
    println!("{told}");
    assert_eq!(STATED.len(), DETECTORS.len() * CASES.len(), "every figure is stated");
    for (line, (id, case, stated)) in told.lines().zip(STATED) {
        let [own_id, own_case, share, _] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        assert_eq!((own_id, own_case), (id, case));
        let share: f64 = share.parse().expect("a number");
        assert!((share - stated).abs() < 0.02, "{id}, {case}: {share} instead of {stated}");
    }
}

#[test]
fn only_detectors_have_a_repeatability_and_only_where_the_flow_is_known() {
    let clip = scene(&[]);
    for (id, is_one) in [("fast", true), ("harris", true), ("feature-matching", false), ("full-search", false)] {
        let detector = estimator(id).expect("it is there");
        assert_eq!(detection::is_detector(&*detector), is_one, "{id}");
        let output = detector.run(&clip, 0, &Threads::single()).expect("a run");
        let reference = Reference { clip: &clip, frame: 0 };
        let found =
            detection::repeatability(&*detector, &output, &reference, &Threads::single()).expect("a second run");
        assert_eq!(!found.scores.is_empty(), is_one, "{id}");
        assert_eq!(found.conclusion.starts_with("Repeatability "), is_one, "{id}: {}", found.conclusion);
        // The last frame is followed by none.
        let reference = Reference { clip: &clip, frame: 1 };
        let last =
            detection::repeatability(&*detector, &output, &reference, &Threads::single()).expect("no second run");
        assert!(last.scores.is_empty(), "{id}");
    }
    let frame = |t| (*clip.frame(t).expect("a frame")).clone();
    let unknown = Clip::from_frames("unknown", vec![frame(0), frame(1)]).expect("frames");
    let detector = estimator("fast").expect("it is there");
    let output = detector.run(&unknown, 0, &Threads::single()).expect("a run");
    let reference = Reference { clip: &unknown, frame: 0 };
    let found = detection::repeatability(&*detector, &output, &reference, &Threads::single()).expect("nothing to do");
    assert!(found.scores.is_empty() && found.facts.is_empty());
}

const DETECTORS: [&str; 6] = ["fast", "sift", "surf", "orb", "harris", "shi-tomasi"];

/// Detector, slider and repeatability.
const STATED: [(&str, &str, f64); 42] = [
    ("fast", "nothing", 1.000),
    ("fast", "rotation", 0.620),
    ("fast", "scale", 0.712),
    ("fast", "blur", 0.758),
    ("fast", "noise", 0.492),
    ("fast", "gain", 0.758),
    ("fast", "offset", 0.782),
    ("sift", "nothing", 1.000),
    ("sift", "rotation", 0.625),
    ("sift", "scale", 0.589),
    ("sift", "blur", 0.805),
    ("sift", "noise", 0.503),
    ("sift", "gain", 0.760),
    ("sift", "offset", 0.759),
    ("surf", "nothing", 1.000),
    ("surf", "rotation", 0.531),
    ("surf", "scale", 0.711),
    ("surf", "blur", 0.750),
    ("surf", "noise", 0.639),
    ("surf", "gain", 0.740),
    ("surf", "offset", 0.732),
    ("orb", "nothing", 1.000),
    ("orb", "rotation", 0.775),
    ("orb", "scale", 0.730),
    ("orb", "blur", 0.866),
    ("orb", "noise", 0.804),
    ("orb", "gain", 0.831),
    ("orb", "offset", 0.865),
    ("harris", "nothing", 1.000),
    ("harris", "rotation", 0.812),
    ("harris", "scale", 0.781),
    ("harris", "blur", 0.897),
    ("harris", "noise", 0.727),
    ("harris", "gain", 0.857),
    ("harris", "offset", 0.833),
    ("shi-tomasi", "nothing", 1.000),
    ("shi-tomasi", "rotation", 0.773),
    ("shi-tomasi", "scale", 0.713),
    ("shi-tomasi", "blur", 0.897),
    ("shi-tomasi", "noise", 0.364),
    ("shi-tomasi", "gain", 0.854),
    ("shi-tomasi", "offset", 0.881),
];
