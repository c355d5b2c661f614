//! Objects that are followed: identities, scores, and a thrown ball.

mod common;

use common::set;
use motionscope_core::objects::score::{Scores, scores};
use motionscope_core::{AnyEstimator, Bounds, Clip, Detection, Life, ObjectField, Output, Threads, synth};

fn run(estimator: &dyn AnyEstimator, clip: &Clip) -> ObjectField {
    match estimator.run(clip, 0, &Threads::single()).expect("a run") {
        Output::Objects(field) => field,
        other => panic!("{other:?} are no objects"),
    }
}

fn scene(id: &str) -> Clip {
    synth::make(id, &synth::scene(id).expect("it is bundled").difficulty()).expect("a clip")
}

#[test]
fn hidden_and_crossing_objects_keep_their_identities() {
    for id in ["traffic", "crossing-stars"] {
        let clip = scene(id);
        for seed in ["1", "2", "3", "4", "5"] {
            let tracker = set("kalman-tracker", &[("seed", seed)]);
            let field = run(&*tracker, &clip);
            let found = scores(&field, &**clip.truth().expect("exact")).expect("readable").expect("objects");
            let Scores { switches, idf1, precision, .. } = found;
            assert_eq!(switches, 0, "{id}, noise {seed}: {found:?}");
            assert!(idf1 > 0.85 && precision > 0.95, "{id}, noise {seed}: {found:?}");
        }
    }
}

/// A thrown ball in every frame but some, beside something that stands still and is found there.
fn thrown(missing: std::ops::Range<usize>) -> (Clip, Vec<[f32; 2]>) {
    let place = |t: usize| {
        let t = t as f32;
        [40.0 + 22.0 * t, 300.0 - 34.0 * t + 2.1 * t * t]
    };
    let detection = |center: [f32; 2], score: f32| Detection {
        bounds: Bounds::around(center, [14.0; 2]),
        center,
        score,
        blob: None,
    };
    let frame = |t: usize| {
        let jitter = [0.6, -0.4, 0.1, -0.7, 0.4][t % 5];
        let [x, y] = place(t);
        let ball = (!missing.contains(&t)).then(|| detection([x + jitter, y - jitter], 0.9));
        [Some(detection([300.0, 420.0], 0.5)), ball].into_iter().flatten().collect()
    };
    let clip = Clip::blank("thrown", (640, 480), 22).with_detections((0..22).map(frame).collect());
    (clip, (0..22).map(place).collect())
}

#[test]
fn a_thrown_ball_is_followed_through_its_arc_and_behind_what_hides_it() {
    let (clip, places) = thrown(9..13);
    let filter = set("kalman-filter", &[("motion", "acceleration"), ("measurement-noise", "1"), ("smooth", "off")]);
    let field = run(&*filter, &clip);
    for (t, place) in places.iter().enumerate().skip(4) {
        let object = field.frames[t].objects[0];
        let off = (object.position[0] as f32 - place[0]).hypot(object.position[1] as f32 - place[1]);
        let is_hidden = (9..13).contains(&t);
        assert_eq!(object.life == Life::Coasting, is_hidden, "frame {t}");
        assert!(off < if is_hidden { 12.0 } else { 2.0 }, "frame {t}: {off} px off");
        assert_eq!(object.id, 1, "it is the same all the way");
    }
    let area = |t: usize| {
        let [[a, b], [c, d]] = field.frames[t].objects[0].covariance.expect("it is known");
        a * d - b * c
    };
    assert!(area(12) > 20.0 * area(8) && area(14) < area(12) / 4.0, "the ellipse grows, and shrinks when it is back");
    let [u, v] = field.frames[20].objects[0].velocity.expect("it is known");
    assert!((u - 22.0).abs() < 1.0 && (v - (-34.0 + 4.2 * 20.0)).abs() < 2.0, "{u}, {v} px/frame");
}
