//! The Kalman tracker on detections made for one question each.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::{self, Objects, set};
use motionscope_core::base::{Stop, Threads};
use motionscope_core::data::{Clip, Detection, ObjectBox};
use motionscope_core::geometry::Bounds;
use motionscope_core::products::objects::score::{scores, scores_on};
use motionscope_core::products::{ObjectField, TrackStatus};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move, Walk};
use motionscope_core::scene::{Focus, Matrix, Readout, Role, Scene, Shape};
use motionscope_core::synth;

fn run(settings: &[(&str, &str)], clip: &Clip) -> ObjectField {
    let output = set("kalman-tracker", settings).run(clip, 0, &Threads::single()).expect("a run");
    output.get::<ObjectField>().expect("objects").clone()
}

fn found(center: [f32; 2], size: [f32; 2], score: f32) -> Detection {
    Detection { bounds: Bounds::around(center, size), center, score, blob: None, deviation_px: None }
}

fn rows(frames: Vec<Vec<Detection>>) -> Clip {
    Clip::blank("rows", (640, 480), frames.len()).with_detections(frames)
}

/// The identities in a frame that are seen there.
fn seen(field: &ObjectField, t: usize) -> Vec<u32> {
    let objects = field.frames[t].objects.iter().filter(|object| object.status == TrackStatus::Confirmed);
    objects.map(|object| object.id).collect()
}

/// The marks of a role at a step.
fn rects(scene: &Scene, role: Role) -> Vec<[f32; 2]> {
    let of = scene.marks.iter().filter(|mark| mark.role == role);
    of.filter_map(|mark| if let Shape::Rect { min, .. } = &mark.shape { Some(*min) } else { None }).collect()
}

#[test]
fn pairs_inside_the_gate_are_lit_before_the_assignment_and_the_assigned_ones_after_it() {
    let two = |t: usize| [40.0, 52.0].map(|x| found([x + 2.0 * t as f32, 60.0], [30.0, 30.0], 0.9)).to_vec();
    let mut walk = set("kalman-tracker", &[]).walk(&rows((0..6).map(two).collect()), 0).expect("a run");
    let mut lit = Vec::new();
    for event in 1..12 {
        walk.jump(Move::To(Cursor { unit: 4, event }));
        let readouts = walk.step(None).readouts;
        let all = readouts.iter().find_map(|readout| match readout {
            Readout::Matrices(all) => all.iter().find(|matrix| matrix.symbol == "C"),
            _ => None,
        });
        let Some(Matrix { entries, changed: Some(changed), .. }) = all else { continue };
        let finite = entries.cells().iter().filter(|cost| cost.is_finite()).count();
        lit.push((changed.cells().iter().filter(|lit| **lit).count(), finite));
    }
    assert_eq!((lit.first(), lit.last()), (Some(&(4, 4)), Some(&(2, 4))), "{lit:?}");
    assert!(lit.contains(&(1, 4)), "one pair at a time is assigned: {lit:?}");
}

#[test]
fn the_end_of_a_frame_shows_the_truth_and_the_errors() {
    let clip = synth::make("traffic", &synth::scene("traffic").expect("a scene").difficulty()).expect("a clip");
    let settings = [("source", "truth"), ("added-noise", "0"), ("frames", "6"), ("backdate", "off")];
    let mut walk = set("kalman-tracker", &settings).walk(&clip, 0).expect("a run");
    let field = run(&settings, &clip);
    for t in [1, 5] {
        walk.jump(Move::To(Cursor { unit: t, event: usize::MAX }));
        let truth = clip.truth().and_then(|truth| truth.objects(t).expect("truth")).expect("objects");
        let (scene, confirmed) = (walk.scene(None), seen(&field, t).len());
        let [matched, missed, alarms] =
            [Role::Truth, Role::Error, Role::Rejected].map(|role| rects(&scene, role).len());
        assert_eq!((matched, missed, alarms), (confirmed, truth.len() - confirmed, 0), "frame {t}");
    }
    // Before the end of a frame a tracker knows no truth.
    walk.jump(Move::To(Cursor { unit: 5, event: 1 }));
    assert!(rects(&walk.scene(None), Role::Truth).is_empty());
}

#[test]
fn a_box_that_is_pointed_at_explains_its_track() {
    for id in ["kalman-tracker", "blob-tracker"] {
        let clip = walker(20, 8..12);
        let mut walk = set(id, &[]).walk(&clip, 0).expect("a run");
        walk.jump(Move::To(Cursor { unit: 15, event: usize::MAX }));
        let there = Focus::current([100.0 + 4.0 * 15.0, 200.0]);
        assert!(walk.explained(there).is_some() && walk.explained(Focus::current([500.0, 20.0])).is_none(), "{id}");
        let step = walk.step(Some(there));
        let told = step.sentence.plain();
        assert!(
            told.starts_with(
                "Selected: track 1 is confirmed. Since frame 0 it was matched in 12 frames and coasted in 4."
            ),
            "{told}"
        );
        assert!(told.contains("4 px/frame") || told.contains("px long"), "{told}");
        let facts = step.readouts.iter().find_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None });
        assert!(facts.expect("facts").iter().any(|fact| fact.label == "Selected track" && fact.value == "1"), "{id}");
        // What is not about one track goes on as it is.
        assert!(!walk.step(None).sentence.plain().contains("Selected"), "{id}");
    }
}

/// The matrices of a step.
fn matrices(walk: &dyn Walk, there: Option<Focus>) -> Vec<Matrix> {
    let all = walk.step(there).readouts.into_iter();
    all.filter_map(|readout| if let Readout::Matrices(all) = readout { Some(all) } else { None }).flatten().collect()
}

#[test]
fn the_matrices_of_a_selected_track_are_those_of_its_frame() {
    let clip = walker(20, 8..12);
    let mut walk = set("kalman-tracker", &[]).walk(&clip, 0).expect("a run");
    let there = |t: usize| Some(Focus::current([100.0 + 4.0 * t as f32, 200.0]));
    // Updated: the prediction, and the update that its step showed.
    let of_update = (1..8).find_map(|event| {
        walk.jump(Move::To(Cursor { unit: 5, event }));
        let is_update = walk.step(None).sentence.plain().starts_with("Track 1: the update");
        is_update.then(|| matrices(&*walk, None))
    });
    let of_update = of_update.expect("an update");
    assert_eq!(of_update.iter().map(|matrix| matrix.symbol).collect::<Vec<_>>(), ["x⁻", "x", "P⁻", "P"]);
    walk.jump(Move::To(Cursor { unit: 5, event: usize::MAX }));
    assert_eq!(matrices(&*walk, there(5)), of_update);
    // Coasting: the prediction alone, one velocity further than before, and no update.
    walk.jump(Move::To(Cursor { unit: 8, event: usize::MAX }));
    let first = matrices(&*walk, there(8));
    walk.jump(Move::To(Cursor { unit: 9, event: usize::MAX }));
    let second = matrices(&*walk, there(9));
    assert_eq!(second.iter().map(|matrix| matrix.symbol).collect::<Vec<_>>(), ["x⁻", "P⁻"]);
    let [before, after] = [&first[0], &second[0]].map(|state| state.entries.cells().to_vec());
    assert!((after[0] - before[0] - before[2]).abs() < 1e-9, "{before:?}, {after:?}");
}

const BOX: [f32; 2] = [40.0, 80.0];

/// An object that goes 4 px/frame to the right, not found in the frames `hidden`.
fn walker(frames: usize, hidden: std::ops::Range<usize>) -> Clip {
    let at = |t: usize| found([100.0 + 4.0 * t as f32, 200.0], BOX, 0.9);
    rows((0..frames).map(|t| if hidden.contains(&t) { vec![] } else { vec![at(t)] }).collect())
}

fn sentences(estimator: &dyn AnyEstimator, clip: &Clip) -> String {
    let (mut walk, mut told): (Box<dyn Walk>, _) = (estimator.walk(clip, 0).expect("a run"), String::new());
    while !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        told += &format!("{}\n", walk.step(None).sentence.plain());
    }
    told
}

#[test]
fn bridging_and_backdating_look_back_and_nothing_else_does() {
    // The object comes in frame 4: what is there in the first frames counts at once.
    let place = |t: usize| found([100.0 + 4.0 * t as f32, 200.0], BOX, 0.9);
    let clip = rows((0..20).map(|t| if t < 4 || (8..12).contains(&t) { vec![] } else { vec![place(t)] }).collect());
    let causal = [("interpolate", "off"), ("backdate", "off")];
    let of = |settings: &[(&str, &str)]| {
        let field = run(settings, &clip);
        (0..20).map(|t| !seen(&field, t).is_empty()).collect::<Vec<_>>()
    };
    let at = |frames: &dyn Fn(usize) -> bool| (0..20).map(frames).collect::<Vec<_>>();
    assert_eq!(of(&causal), at(&|t| (6..8).contains(&t) || t >= 12));
    assert_eq!(of(&[("interpolate", "off")]), at(&|t| (4..8).contains(&t) || t >= 12));
    assert_eq!(of(&[("backdate", "off")]), at(&|t| t >= 6));
    assert_eq!(of(&[]), at(&|t| t >= 4));
    // What is put in between is a place, and nothing is known of how the object moved there.
    let interpolated = run(&[], &clip);
    let object = &interpolated.frames[10].objects[0];
    assert!((object.position[0] - 140.0).abs() < 3.0, "{:?}", object.position);
    assert_eq!((object.velocity, object.covariance, object.detection), (None, None, None));
    // A run that ends earlier says the same of its frames.
    let (whole, part) = (run(&causal, &clip), run(&[&causal[..], &[("frames", "14")]].concat(), &clip));
    assert_eq!(whole.frames[..14], part.frames[..]);
}

#[test]
fn in_real_time_the_tracks_of_the_first_frames_count_at_once() {
    // One object from the first frame on, one from frame 10 on, and a false detection in frame 1.
    let frame = |t: usize| {
        let walking = |y: f32| found([100.0 + 4.0 * t as f32, y], BOX, 0.9);
        let later = (t >= 10).then(|| walking(400.0));
        let wrong = (t == 1).then(|| found([500.0, 100.0], BOX, 0.9));
        [Some(walking(200.0)), later, wrong].into_iter().flatten().collect()
    };
    let clip = rows((0..20).map(frame).collect());
    let of = |settings: &[(&str, &str)]| {
        let field = run(settings, &clip);
        (0..20).map(|t| seen(&field, t).len()).collect::<Vec<_>>()
    };
    let at = |frames: &dyn Fn(usize) -> usize| (0..20).map(frames).collect::<Vec<_>>();
    // As SORT does: the first three frames show all tracks.
    assert_eq!(of(&[("backdate", "off")]), at(&|t| 1 + usize::from(t == 1) + usize::from(t >= 12)));
    // With hindsight the false one is known to be false.
    assert_eq!(of(&[]), at(&|t| 1 + usize::from(t >= 10)));
    let causal = set("kalman-tracker", &[]).walk(&clip, 0).map(|mut walk| {
        walk.jump(Move::End);
        walk.causal().and_then(|output| output.get::<ObjectField>().cloned())
    });
    let causal = causal.expect("a run").expect("it looks back");
    assert_eq!((0..20).map(|t| seen(&causal, t).len()).collect::<Vec<_>>(), of(&[("backdate", "off")]));
}

#[test]
fn max_age_is_the_most_frames_that_may_be_missed() {
    for (max_age, hidden, same) in [("4", 8..12, true), ("3", 8..12, false), ("0", 8..9, false)] {
        let field = run(&[("max-age", max_age)], &walker(20, hidden.clone()));
        assert_eq!(seen(&field, 19) == seen(&field, 7), same, "{max_age} frames for {hidden:?}");
    }
}

#[test]
fn scores_count_where_a_detector_tells_them() {
    let frame = |score: f32| vec![found([100.0, 200.0], BOX, 0.9), found([400.0, 200.0], BOX, score)];
    let count = |score: f32| seen(&run(&[], &rows(vec![frame(score); 8])), 7).len();
    assert_eq!([0.2, 0.5, 0.7].map(count), [1, 1, 2], "left out, not sure enough to begin, and sure");
    // What was seen surely goes on where it is seen less surely, but not after it was lost from sight.
    let fading = |gap: usize| {
        let of = |t: usize| match t {
            0..5 => vec![found([400.0, 200.0], BOX, 0.9)],
            _ if t < 5 + gap => vec![],
            _ => vec![found([400.0, 200.0], BOX, 0.4)],
        };
        seen(&run(&[("interpolate", "off")], &rows((0..12).map(of).collect())), 11)
    };
    assert_eq!((fading(0), fading(2)), (vec![1], vec![]));
    let told = sentences(&*set("kalman-tracker", &[]), &rows(vec![frame(0.2); 4]));
    assert!(
        told.contains("1 detection in frame 1; 1 more discarded with a score below the minimum of 0.30."),
        "{told}"
    );
    // The visibility of a true object is no score.
    let clip = synth::make("traffic", &synth::scene("traffic").expect("bundled").difficulty()).expect("a clip");
    assert_eq!(run(&[("min-score", "900"), ("source", "truth")], &clip), run(&[("source", "truth")], &clip));
}

#[test]
fn confirmed_tracks_choose_first() {
    // A false alarm of two frames is nearer to where the walker is found next than the walker's own prediction.
    let mut frames: Vec<Vec<Detection>> = (0..8).map(|_| vec![found([100.0, 200.0], BOX, 0.9)]).collect();
    frames[6] = vec![found([100.0, 200.0], BOX, 0.9), found([122.0, 200.0], BOX, 0.9)];
    frames[7] = vec![found([113.0, 200.0], BOX, 0.9)];
    let of = |cascade: &str| seen(&run(&[("cascade", cascade)], &rows(frames.clone())), 7);
    assert_eq!((of("on"), of("off")), (vec![1], vec![]));
}

#[test]
fn who_has_stopped_while_hidden_is_found_by_its_last_box() {
    // It walks 12 px a frame, and stands still for the ten frames in which it is hidden.
    let frames = (0..24).map(|t| match t {
        0..10 => vec![found([100.0 + 12.0 * t as f32, 200.0], BOX, 0.9)],
        10..20 => vec![],
        _ => vec![found([214.0, 200.0], BOX, 0.9)],
    });
    let clip = rows(frames.collect());
    let of = |recover: &str| seen(&run(&[("recover", recover)], &clip), 23);
    assert_eq!((of("on"), of("off")), (vec![1], vec![2]));
    assert!(sentences(&*set("kalman-tracker", &[]), &clip).contains("IoU with the last box"));
}

#[test]
fn all_at_once_pairs_more_than_nearest_first() {
    // Two walkers in a row, found a bit ahead: the nearest pair is the wrong one.
    let at = |t: usize, ahead: f32| {
        let x = 100.0 + 2.0 * t as f32 + ahead;
        vec![found([x, 200.0], BOX, 0.9), found([x + 24.0, 200.0], BOX, 0.9)]
    };
    let mut frames: Vec<Vec<Detection>> = (0..8).map(|t| at(t, 0.0)).collect();
    frames.push(at(8, 14.0));
    let clip = rows(frames);
    let of = |association: &str| {
        let field = run(&[("association", association), ("recover", "off"), ("gate", "0.9999")], &clip);
        (0..2).map(|i| field.frames[8].objects[i].detection).collect::<Vec<_>>()
    };
    assert_eq!(of("assignment"), [Some(0), Some(1)]);
    assert_eq!(of("nearest")[1], Some(0), "the first detection is nearest to the second walker");
}

#[test]
fn each_cost_has_its_own_gate() {
    // It jumps by 30 px: the boxes have 1/7 in common, and for a filter so unsure that is not far.
    let mut frames: Vec<Vec<Detection>> = (0..6).map(|_| vec![found([100.0, 200.0], BOX, 0.9)]).collect();
    frames.push(vec![found([130.0, 200.0], BOX, 0.9)]);
    let clip = rows(frames);
    let of = |cost: &str, least: &str| {
        let settings = [("cost", cost), ("iou-threshold", least), ("measurement-noise", "0.3"), ("recover", "off")];
        seen(&run(&settings, &clip), 6) == [1]
    };
    assert_eq!([of("mahalanobis", "0.5"), of("overlap", "0.2"), of("both", "0.2")], [true, false, false]);
    assert_eq!([of("overlap", "0.1"), of("both", "0.1"), of("both", "0")], [true; 3]);
    let told = sentences(&*set("kalman-tracker", &[("iou-threshold", "0")]), &clip);
    assert!(told.contains("boxes have to overlap") && !told.contains("IoU threshold is 0.00"), "{told}");
}

#[test]
fn the_noise_of_the_motion_grows_with_the_object() {
    let of = |height: &dyn Fn(usize) -> f32| {
        let at = |t: usize| found([300.0, 240.0], [height(t) / 2.0, height(t)], 0.9);
        let clip = rows((0..34).map(|t| if t < 30 { vec![at(t)] } else { vec![] }).collect());
        let field = run(&[("cost", "mahalanobis"), ("gate", "0.9999")], &clip);
        field.frames[33].objects[0].covariance.expect("it coasts")[0][0].sqrt()
    };
    let (grown, large) = (of(&|t| if t < 10 { 20.0 } else { 100.0 }), of(&|_| 100.0));
    assert!((grown / large - 1.0).abs() < 0.1, "{grown} and {large} px");
}

#[test]
fn a_pair_is_shown_in_a_table_with_names() {
    let crowd = |t: usize| (0..20).map(|i| found([20.0 + 30.0 * i as f32 + t as f32, 200.0], [20.0; 2], 0.9)).collect();
    let mut walk = set("kalman-tracker", &[]).walk(&rows((0..3).map(crowd).collect()), 0).expect("a run");
    let mut about = 0;
    while !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let step = walk.step(None);
        let Some(pair) = step.sentence.plain().strip_prefix("Track 19 is assigned to ").map(String::from) else {
            continue;
        };
        let tables = step.readouts.iter().find_map(|r| if let Readout::Matrices(all) = r { Some(all) } else { None });
        let table = &tables.expect("tables")[0];
        let row = table.rows.iter().position(|name| name == "19").expect("the object has a row");
        let column =
            table.columns.iter().position(|name| pair.starts_with(&format!("detection {name},"))).expect("found");
        assert!(table.changed.as_ref().expect("lit")[(column, row)], "{pair}");
        about += 1;
    }
    assert_eq!(about, 2, "two frames have pairs");
}

/// A clip of so many objects, each where `place` has it in a frame.
fn crowd(count: usize, frames: usize, place: impl Fn(usize, usize) -> [f32; 2]) -> Clip {
    let size = |i: usize| [10.0 + (i % 13) as f32, 20.0 + (i % 7) as f32];
    let frame = |t: usize| (0..count).map(move |i| (i, t));
    let found = |(i, t): (usize, usize)| found(place(i, t), size(i), 0.9);
    let truth = |(i, t): (usize, usize)| {
        let Bounds { min: [x, y], .. } = Bounds::around(place(i, t), size(i));
        let [width, height] = size(i);
        ObjectBox { id: i as u32 + 1, x, y, width, height, visibility: 1.0 }
    };
    let truths = (0..frames).map(|t| frame(t).map(truth).collect()).collect();
    let clip = Clip::blank("a crowd", (1920, 1080), frames);
    clip.with_detections((0..frames).map(|t| frame(t).map(found).collect()).collect())
        .with_truth(Arc::new(Objects(truths)))
}

/// A number of 0 to 1 that tells an object and a frame from all others.
fn chance(i: usize, t: usize) -> f32 {
    let mixed = (i as u64 * 0x9E37_79B9) ^ (t as u64 * 0x85EB_CA6B);
    (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as f32 / (1u32 << 24) as f32
}

const TRACKERS: [&str; 3] = ["kalman-tracker", "blob-tracker", "trajectory-analysis"];

#[test]
fn thousands_of_objects_are_followed_scored_and_walked_through_in_seconds() {
    let smooth = crowd(5000, 4, |i, t| {
        [26.0 * (i % 73) as f32 + 1.5 * t as f32, 15.0 * (i / 73) as f32 + (i % 3) as f32 * t as f32]
    });
    let scattered = crowd(5000, 4, |i, t| [1920.0 * chance(i, 2 * t), 1080.0 * chance(i, 2 * t + 1)]);
    for (clip, is_smooth) in [(&smooth, true), (&scattered, false)] {
        for id in TRACKERS {
            let begun = Instant::now();
            let tracker = set(id, &[]);
            let output = tracker.run(clip, 0, &Threads::single()).expect("a run");
            let field = output.get::<ObjectField>().expect("objects");
            let scored = scores(field, &**clip.truth().expect("exact")).expect("readable").expect("objects");
            assert_eq!(scored.truths, 4 * 5000);
            if is_smooth && id == "kalman-tracker" {
                assert_eq!((scored.matches, scored.switches, scored.greedy), (4 * 5000, 0, 0), "{scored:?}");
            }
            let mut walk = tracker.walk(clip, 0).expect("a run");
            walk.jump(Move::To(Cursor { unit: 2, event: 3 }));
            let events = walk.events();
            for event in [3, 4, events / 2, events] {
                walk.jump(Move::To(Cursor { unit: 2, event }));
                assert!(!walk.step(None).sentence.plain().is_empty() && !walk.scene(None).marks.is_empty());
            }
            // It took minutes when every object was compared with every detection.
            assert!(begun.elapsed() < Duration::from_secs(30), "{id} takes {:?}", begun.elapsed());
        }
    }
}

#[test]
fn where_everything_lies_on_everything_work_has_an_end_and_stops_when_asked() {
    let clip = crowd(800, 3, |i, t| [900.0 + 3.0 * chance(i, 2 * t), 500.0 + 3.0 * chance(i, 2 * t + 1)]);
    for (id, cost) in [("kalman-tracker", "both"), ("kalman-tracker", "mahalanobis"), ("blob-tracker", "")] {
        let settings = if cost.is_empty() { vec![] } else { vec![("cost", cost)] };
        let begun = Instant::now();
        let told = sentences_until(&*set(id, &settings), &clip, 8);
        assert!(told.contains("only the 500 nearest"), "{told}");
        assert!(begun.elapsed() < Duration::from_secs(30), "{id} takes {:?}", begun.elapsed());
        let stop = Stop::default();
        let (wanted, late) = (clip.clone().until(stop.clone()), stop.clone());
        let stopper = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(100));
            late.set(true);
            Instant::now()
        });
        let run = set(id, &settings).run(&wanted, 0, &Threads::single());
        let (ended, asked) = (Instant::now(), stopper.join().expect("it only waits"));
        assert!(run.is_err() || ended < asked, "{id} goes on");
        assert!(ended.saturating_duration_since(asked) < Duration::from_secs(3), "{id}: {:?}", ended - asked);
    }
    // Scores are given up as well.
    let field = run(&[("association", "nearest")], &clip);
    let stop = Stop::default();
    stop.set(true);
    assert!(scores_on(&clip.clone().until(stop), &field).is_err());
    assert!(scores_on(&Clip::blank("no truth", (9, 9), 2), &field).expect("readable").is_none());
}

/// What the first so many events of the last unit tell.
fn sentences_until(estimator: &dyn AnyEstimator, clip: &Clip, events: usize) -> String {
    let mut walk = estimator.walk(clip, 0).expect("a run");
    let last = walk.units().expect("known") - 1;
    (1..=events)
        .map(|event| {
            walk.jump(Move::To(Cursor { unit: last, event }));
            format!("{}\n", walk.step(None).sentence.plain())
        })
        .collect()
}

#[test]
fn the_formula_of_a_pair_has_the_limits_that_it_meets() {
    // Track 1 stands still, track 2 turns back while it is not seen: only its last box still overlaps.
    let at = |x: f32, y: f32| found([x, y], [60.0, 60.0], 1.0);
    let moving = (0..8).map(|t| vec![at(100.0, 100.0), at(200.0 + 25.0 * t as f32, 300.0)]);
    let hidden = (0..4).map(|_| vec![at(100.0, 100.0)]);
    let clip = rows(moving.chain(hidden).chain([vec![at(100.0, 100.0), at(380.0, 300.0)]]).collect());
    let formulas = |settings: &[(&str, &str)]| {
        let settings = [&[("source", "detections"), ("score-threshold", "0.5"), ("max-age", "20")], settings].concat();
        let mut walk = set("kalman-tracker", &settings).walk(&clip, 0).expect("a run");
        let mut all = Vec::new();
        while !walk.at_end() {
            walk.jump(Move::Granularity(2, Direction::Forward));
            let step = walk.step(None);
            if step.sentence.plain().contains("is assigned to") {
                all.push((step.sentence.plain(), common::equation(&step)));
            }
        }
        all
    };
    for (settings, condition) in [
        (&[("cost", "both"), ("iou-threshold", "0.25")][..], "(0.00)/(13.82) + (1 − 1.000)/(1 − 0.250)"),
        (&[("cost", "overlap"), ("iou-threshold", "0")], "with IoU = 1.000 > 0"),
        (&[("cost", "mahalanobis")], "≤ gate 13.82"),
    ] {
        let all = formulas(settings);
        let (sentence, lines) = all.iter().find(|(sentence, _)| sentence.contains("detection 1")).expect("a pair");
        assert!(lines[0].starts_with("C = ") && lines.last().expect("a line").contains(condition), "{lines:?}");
        assert!(!sentence.contains("≥ 0.00"), "{sentence}");
    }
    let all = formulas(&[("cost", "both"), ("iou-threshold", "0.25")]);
    let (sentence, lines) = all.last().expect("a pair");
    assert!(sentence.contains("IoU with the last box"), "{sentence}");
    assert!(lines[0] == "C = 1 − IoU of the last box" && lines[2].ends_with("≥ 0.250"), "{lines:?}");
}

#[test]
fn filters_that_assume_too_little_noise_show_in_the_mean_nis_of_detections_from_a_file() {
    // Three objects 60 px high whose positions have a standard deviation of 6 px, 0.1 of the height; a file tells no noise.
    let noise = |seed: usize| {
        let uniform = |i: usize| {
            let mixed = ((seed * 12 + i + 1) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            ((mixed ^ (mixed >> 27)) >> 40) as f32 / (1u64 << 24) as f32
        };
        6.0 * ((0..12).map(uniform).sum::<f32>() - 6.0)
    };
    let object = |t: usize, id: usize| {
        let [dx, dy] = [0, 1].map(|axis| noise(2 * (3 * t + id) + axis));
        found([80.0 + 3.0 * t as f32 + dx, 100.0 + 130.0 * id as f32 + dy], [40.0, 60.0], 0.9)
    };
    let clip = rows((0..60).map(|t| (0..3).map(|id| object(t, id)).collect()).collect());
    for id in ["kalman-tracker", "joint-probabilistic", "multiple-hypothesis"] {
        let conclusion = |measurement_noise: &str| {
            let mut walk = set(id, &[("measurement-noise", measurement_noise)]).walk(&clip, 0).expect("a run");
            walk.jump(Move::End);
            walk.step(None).sentence.plain()
        };
        let [small, right] = ["0.05", "0.1"].map(conclusion);
        assert!(small.contains("above the 95 % band") && small.contains("measurement noise R"), "{id}: {small}");
        assert!(!right.contains("Mean NIS"), "{id}: {right}");
    }
}

#[test]
fn scores_with_hindsight_have_those_in_real_time_beside_them() {
    let sample = synth::scene("traffic").expect("it is bundled");
    let clip = sample.clip(&sample.difficulty()).expect("a clip");
    for id in ["kalman-tracker", "joint-probabilistic", "multiple-hypothesis"] {
        let end = |settings: &[(&str, &str)]| {
            let estimator = set(id, settings);
            let mut walk = estimator.walk(&clip, 0).expect("a run");
            walk.jump(Move::End);
            let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
            let field = output.get::<ObjectField>().expect("objects");
            (walk.step(None).sentence.plain(), scores_on(&clip, field).expect("readable").expect("scores"))
        };
        let (later, backward) = end(&[("interpolate", "on"), ("backdate", "on")]);
        assert!(later.contains(&format!("Run with hindsight: MOTA {:.3}", backward.mota)), "{id}: {later}");
        assert!(later.contains("In real time, without hindsight: MOTA "), "{id}: {later}");
        assert!(!later.contains("coasting tracks do not count"), "{id}: {later}");
        if id != "multiple-hypothesis" {
            let (causal, forward) = end(&[("interpolate", "off"), ("backdate", "off")]);
            let live = format!(" Run: MOTA {:.3}", forward.mota);
            assert!(causal.contains(&live) && !causal.contains("hindsight"), "{id}: {causal}");
            let same = format!("without hindsight: MOTA {:.3}", forward.mota);
            assert!(later.contains(&same), "{id}: {later}");
        }
    }
}
