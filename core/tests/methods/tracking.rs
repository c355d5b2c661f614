//! Objects that are followed: identities, scores, and a thrown ball.

use std::collections::BTreeSet;

use crate::common::set;
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Detection, Frame};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::products::objects::score::{Scores, scores};
use motionscope_core::products::{ObjectField, TrackStatus};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move};
use motionscope_core::synth;

fn run(estimator: &dyn AnyEstimator, clip: &Clip) -> ObjectField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<ObjectField>().expect("objects").clone()
}

fn scene(id: &str) -> Clip {
    synth::make(id, &synth::scene(id).expect("it is bundled").difficulty()).expect("a clip")
}

fn scored(tracker: &dyn AnyEstimator, clip: &Clip) -> Scores {
    let truth = clip.truth().expect("exact");
    scores(&run(tracker, clip), &**truth).expect("readable").expect("objects")
}

#[test]
fn hidden_and_crossing_objects_keep_their_identities() {
    for id in ["traffic", "crossing-stars"] {
        let clip = scene(id);
        for seed in ["1", "2", "3", "4", "5"] {
            let tracker = set("kalman-tracker", &[("seed", seed)]);
            let found = scored(&*tracker, &clip);
            let Scores { switches, idf1, precision, .. } = found;
            assert_eq!(switches, 0, "{id}, noise {seed}: {found:?}");
            assert!(idf1 > 0.85 && precision > 0.95, "{id}, noise {seed}: {found:?}");
        }
    }
}

#[test]
fn cars_behind_a_bridge_keep_their_boxes_where_blobs_are_what_is_seen() {
    let mota = |settings: &[(&str, &str)], clip: &Clip| {
        let settings = [&[("source", "moving")], settings].concat();
        scored(&*set("kalman-tracker", &settings), clip).mota
    };
    let clip = scene("traffic");
    let [partial, visible] = ["on", "off"].map(|partial| mota(&[("partial", partial)], &clip));
    assert!(partial >= 0.8 && partial > visible + 0.1, "MOTA {partial:.3}, without partial observation {visible:.3}");
    // With other noise and shake of the camera.
    let usual = synth::scene("traffic").expect("a scene");
    for seed in [11, 12, 13] {
        let difficulty = synth::Difficulty { noise: 3.0, seed, ..usual.difficulty() };
        let clip = usual.clip(&difficulty).expect("sound");
        let mota = mota(&[], &clip);
        assert!(mota >= 0.75, "seed {seed}: MOTA {mota:.3}");
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
        deviation_px: None,
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
        assert_eq!(object.status == TrackStatus::Coasting, is_hidden, "frame {t}");
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

#[test]
fn without_a_filter_identities_are_kept_as_far_as_places_and_looks_tell() {
    let seeds = ["1", "2", "3", "4", "5"];
    let clip = scene("traffic");
    for seed in seeds {
        let tracker = |predict| set("blob-tracker", &[("seed", seed), ("predict", predict)]);
        let found = scored(&*tracker("on"), &clip);
        assert!(found.switches == 0 && found.idf1 > 0.85 && found.precision > 0.95, "noise {seed}: {found:?}");
        // Under the bridge a car comes out far from where it went in.
        let still = scored(&*tracker("off"), &clip);
        assert!(still.idf1 < found.idf1 - 0.05, "noise {seed}: {still:?}");
    }
    // The stars look alike: only where they go tells them apart once they were one.
    let clip = scene("crossing-stars");
    let scores_by =
        |identity| seeds.map(|seed| scored(&*set("blob-tracker", &[("seed", seed), ("identity", identity)]), &clip));
    for found in scores_by("place") {
        assert!(found.switches == 0 && found.idf1 > 0.95, "{found:?}");
    }
    let switches = scores_by("appearance").map(|found| found.switches);
    assert!(switches.contains(&0) && switches.contains(&2), "both change places or none: {switches:?}");
}

/// Frames of squares that meet.
const MEETING: usize = 48;

/// A small dark square and a large bright one that meet, and go through each other or turn back; where they are in each frame.
fn meeting(turns_back: bool) -> (Clip, Vec<[Bounds; 2]>) {
    let places = |t: usize| {
        let t = t as f32;
        let dark = [20.0 + 3.0 * t, 40.0];
        let bright = [160.0 - 3.0 * t, 44.0];
        let turned = |x: f32, turn: f32| if turns_back && t > 23.0 { 2.0 * turn - x } else { x };
        let (dark, bright) = ([turned(dark[0], 20.0 + 69.0), dark[1]], [turned(bright[0], 160.0 - 69.0), bright[1]]);
        [Bounds::around(dark, [17.0; 2]), Bounds::around(bright, [25.0; 2])]
    };
    let frame = |t: usize| {
        let all = places(t);
        let value = |x: usize, y: usize| {
            let point = [x as f32, y as f32];
            let is_in = |b: &Bounds| (0..2).all(|i| (b.min[i]..b.max[i]).contains(&point[i]));
            if is_in(&all[0]) {
                40
            } else if is_in(&all[1]) {
                220
            } else {
                120 + ((x * 7 + y * 13) % 9) as u8
            }
        };
        Frame::gray(Grid::from_fn(180, 90, value))
    };
    let clip = Clip::from_frames("meeting", (0..MEETING).map(frame).collect()).expect("frames of one size");
    (clip, (0..MEETING).map(places).collect())
}

/// The identities of what stands where `places` are.
fn names_at(field: &ObjectField, t: usize, places: &[Bounds; 2]) -> [Option<u32>; 2] {
    let objects = &field.frames[t].objects;
    places.each_ref().map(|place| objects.iter().find(|object| object.bounds.iou(place) > 0.7).map(|object| object.id))
}

#[test]
fn blobs_that_merge_keep_their_names_inside_and_get_them_back() {
    // Appearance tells them apart whatever they do; where they would be only if they go on as before.
    for (turns_back, identity, keeps) in
        [(false, "appearance", true), (true, "appearance", true), (false, "place", true), (true, "place", false)]
    {
        let (clip, places) = meeting(turns_back);
        let tracker = set("blob-tracker", &[("source", "moving"), ("identity", identity)]);
        let field = run(&*tracker, &clip);
        let first = names_at(&field, 4, &places[4]);
        let end = MEETING - 4;
        let last = names_at(&field, end, &places[end]);
        assert_eq!(first.map(|id| id.is_some()), [true; 2], "both are followed before they meet");
        let expected = if keeps { first } else { [first[1], first[0]] };
        assert_eq!(last, expected, "turns back: {turns_back}, by {identity}");
        // In the middle there is one blob, and both are in it.
        let middle = &field.frames[23];
        assert_eq!((middle.detections.len(), middle.objects.len()), (1, 2));
        for object in &middle.objects {
            assert_eq!((object.detection, object.status), (Some(0), TrackStatus::Confirmed));
            assert!(object.bounds.shared(&middle.detections[0].bounds) > 0.99, "{object:?}");
        }
        let names: BTreeSet<u32> = field.frames.iter().flat_map(|frame| frame.objects.iter().map(|o| o.id)).collect();
        assert_eq!(names.len(), 2, "nobody else is taken for an object");
    }
}

#[test]
fn a_merge_and_a_split_are_reported_with_their_numbers() {
    let (clip, _) = meeting(false);
    let tracker = set("blob-tracker", &[("source", "moving")]);
    let mut walk = tracker.walk(&clip, 0).expect("a run");
    let mut told = Vec::new();
    while !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let step = walk.step(None);
        if ["merge", "split"].contains(&step.line.as_str()) {
            told.push((walk.cursor(), step.sentence.plain()));
        }
    }
    let [(merge, merged), (split, parted)] = &told[..] else { panic!("one merge and one split, not {told:?}") };
    assert!(merged.contains("Tracks 1 and 2") && merged.contains("group"), "{merged}");
    assert!(parted.contains("track 1 is blob") && parted.contains("(cost "), "{parted}");
    assert!(merge.unit < split.unit);
    // The table of the split has a row for each object and a column for each blob.
    walk.jump(Move::To(Cursor { unit: split.unit, event: split.event }));
    let step = walk.step(None);
    let tables = step.readouts.iter().find_map(|readout| match readout {
        motionscope_core::scene::Readout::Matrices(all) => Some(all),
        _ => None,
    });
    let table = &tables.expect("matrices")[0];
    let lit = table.changed.as_ref().expect("who is who");
    assert_eq!((table.entries.size(), lit.cells().iter().filter(|lit| **lit).count()), ((2, 2), 2));
    for y in 0..2 {
        let (own, other) = if lit[(0, y)] { (0, 1) } else { (1, 0) };
        assert!(table.entries[(own, y)] < 0.5 && table.entries[(other, y)] > 3.0, "{:?}", table.entries);
    }
}
