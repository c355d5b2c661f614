//! What trajectories tell, on objects whose ways are known.

use std::collections::BTreeMap;
use std::sync::Arc;

use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Detection};
use motionscope_core::geometry::Bounds;
use motionscope_core::products::objects::trajectory::Trajectory;
use motionscope_core::products::{ObjectField, Reference};
use motionscope_core::run::{AnyEstimator, Cursor, Move};
use motionscope_core::scene::{Readout, Scene};
use motionscope_core::synth;

const SIZE: [f32; 2] = [20.0, 14.0];

/// A clip of objects that begin in a frame at a place, and go on at a velocity for so many frames.
fn clip(objects: &[(usize, [f32; 2], [f32; 2], usize)], frames: usize) -> Clip {
    let mut found = vec![Vec::new(); frames];
    for &(begin, place, velocity, count) in objects {
        for (i, frame) in found[begin..(begin + count).min(frames)].iter_mut().enumerate() {
            let center = [0, 1].map(|axis| place[axis] + velocity[axis] * i as f32);
            frame.push(Detection {
                bounds: Bounds::around(center, SIZE),
                center,
                score: 1.0,
                blob: None,
                deviation_px: None,
            });
        }
    }
    Clip::blank("objects", (320, 240), frames).with_detections(found)
}

fn analysis(settings: &[(&str, &str)]) -> Box<dyn AnyEstimator> {
    let mut analysis = estimator("trajectory-analysis").expect("it is there");
    settings.iter().for_each(|(name, value)| analysis.set(name, value).expect("it is allowed"));
    analysis
}

fn run(analysis: &dyn AnyEstimator, clip: &Clip) -> ObjectField {
    let output = analysis.run(clip, 0, &Threads::single()).expect("it runs");
    output.get::<ObjectField>().expect("objects").clone()
}

fn crossings(all: &[Arc<Trajectory>]) -> [usize; 2] {
    [true, false].map(|way| all.iter().flat_map(|of| &of.crossings).filter(|c| c.is_forward == way).count())
}

#[test]
fn speed_heading_counts_and_stays_are_those_of_the_objects() {
    let right = |begin, y| (begin, [20.0, y], [4.0, 0.0], 60);
    let objects = [right(0, 60.0), right(3, 120.0), (5, [300.0, 180.0], [-3.0, 1.0], 60)];
    let settings = [("lines", "160,239,160,0"), ("zones", "80,40,120,140")];
    let field = run(&*analysis(&settings), &clip(&objects, 70));
    let all = &field.trajectories;
    assert_eq!((all.len(), crossings(all)), (3, [2, 1]));
    for (of, (begin, place, velocity, count)) in all.iter().zip(objects) {
        assert_eq!((of.sightings.len(), of.sightings[0].frame), (count, begin));
        let last = of.sightings.last().and_then(|seen| seen.velocity).expect("it moves");
        assert!((0..2).all(|i| (last[i] - f64::from(velocity[i])).abs() < 0.02), "{last:?} is not {velocity:?}");
        let straightness = of.straightness().expect("it moves");
        assert!(straightness > 0.999, "{straightness}");
        let crossing = of.crossings[0];
        let expected = begin as f32 + (160.0 - place[0]) / velocity[0];
        assert!((crossing.frame as f32 - expected).abs() <= 1.0, "{crossing:?} where {expected} is expected");
        assert!((crossing.at[0] - 160.0).abs() < 1e-9);
    }
    // 40 px at 4 px/frame.
    for of in &all[..2] {
        assert!((10..=11).contains(&of.dwell_frames()) && of.dwells.len() == 1, "{:?}", of.dwells);
    }
    assert_eq!(all[2].dwells, []);
}

#[test]
fn where_no_line_and_no_zone_is_set_nothing_is_counted() {
    let clip = clip(&[(0, [20.0, 60.0], [4.0, 0.0], 60)], 70);
    let scored = |settings: &[(&str, &str)], name: &str| {
        let output = analysis(settings).run(&clip, 0, &Threads::single()).expect("it runs");
        let assessed = output.assess(&Reference { clip: &clip, frame: 0 }).expect("an assessment");
        let score = assessed.scores.iter().find(|score| score.measure.key == name).expect("a score");
        score.value.real()
    };
    for (parameter, value, name) in [("lines", "300,20,310,20", "crossed_right"), ("zones", "300,10,310,20", "in_zone")]
    {
        assert_eq!(scored(&[], name), None, "{name}");
        assert_eq!(scored(&[(parameter, value)], name), Some(0.0), "{name}");
    }
}

#[test]
fn several_lines_and_zones_have_counts_of_their_own() {
    let objects = [(0, [20.0, 60.0], [4.0, 0.0], 60), (0, [300.0, 180.0], [-4.0, 0.0], 30)];
    let settings = [("lines", "100,239,100,0 200,239,200,0"), ("zones", "80,40,120,100 90,40,240,100")];
    let clip = clip(&objects, 60);
    let field = run(&*analysis(&settings), &clip);
    let of_line = |line: usize| {
        let all = field.trajectories.iter().flat_map(|of| &of.crossings).filter(move |c| c.line == line);
        let right = all.clone().filter(|crossing| crossing.is_forward).count();
        [right, all.count() - right]
    };
    // The second object ends at x = 184, between the lines.
    assert_eq!([of_line(0), of_line(1)], [[1, 0], [1, 1]]);
    let dwells = [0, 1].map(|zone| field.trajectories[0].dwell_frames_in(zone));
    assert!((10..=11).contains(&dwells[0]) && (37..=38).contains(&dwells[1]), "{dwells:?}");
    let mut walk = analysis(&settings).walk(&clip, 0).expect("it starts");
    walk.jump(Move::End);
    let step = walk.step(None);
    let facts = |label: &str| -> Vec<&str> {
        step.facts().iter().filter(|fact| fact.label == label).map(|fact| &*fact.value).collect()
    };
    let counts = ["line 1: 1 to the right, 0 to the left", "line 2: 1 to the right, 1 to the left"];
    assert_eq!((facts("Crossings"), facts("Tracks inside")), (counts.into(), vec!["0 in zone 1", "0 in zone 2"]));
    let sentence = step.sentence.plain();
    assert!(
        sentence.contains("1 crossing of line 2 to the right and 1 to the left") && sentence.contains("1 in zones"),
        "{sentence}"
    );
}

#[test]
fn objects_against_the_main_direction_are_reported_and_no_others() {
    let stream = (0..6).map(|i| (10 * i, [20.0, 100.0], [5.0, 0.0], 50));
    let against: Vec<_> = stream.chain([(70, [310.0, 118.0], [-5.0, 0.0], 40)]).collect();
    let field = run(&*analysis(&[]), &clip(&against, 115));
    let unusual: Vec<_> =
        field.trajectories.iter().filter(|of| of.sightings.iter().any(|s| s.anomaly.is_some())).collect();
    assert_eq!(unusual.len(), 1);
    assert_eq!(unusual[0].sightings[0].frame, 70);
    let angles = unusual[0].sightings.iter().filter_map(|seen| Some(seen.anomaly?.angle_deg));
    assert!(
        angles.clone().count() > 25 && angles.clone().all(|angle| angle > 170.0),
        "{:?}",
        angles.collect::<Vec<_>>()
    );
}

#[test]
fn the_truth_of_a_clip_is_counted_as_it_is() {
    let scene = synth::scene("traffic").expect("a scene");
    let clip = synth::make(scene.id, &scene.difficulty()).expect("a clip");
    let (width, height) = clip.size();
    let middle = width as f32 / 2.0;
    let line = format!("{middle},{height},{middle},0");
    let found = run(&*analysis(&[("lines", &line), ("tracker.source", "truth"), ("tracker.added-noise", "0")]), &clip);
    // Where the true centres change sides, by plain comparison.
    let truth = clip.truth().expect("it has truth");
    let (mut before, mut expected) = (BTreeMap::new(), [0, 0]);
    for t in 0..clip.info().frames.expect("counted") {
        for object in truth.objects(t).expect("it is read").expect("it is there") {
            let x = object.x + object.width / 2.0;
            match before.insert(object.id, x) {
                Some(was) if was < middle && x >= middle => expected[0] += 1,
                Some(was) if was >= middle && x < middle => expected[1] += 1,
                _ => {}
            }
        }
    }
    assert!(expected[0] > 0, "someone goes over the line");
    assert_eq!(crossings(&found.trajectories), expected);
}

#[test]
fn a_step_never_knows_what_comes_later() {
    let objects = [(0, [20.0, 60.0], [4.0, 0.0], 40), (3, [250.0, 90.0], [-4.0, 0.0], 40)];
    let (analysis, clip) = (analysis(&[("lines", "160,239,160,0")]), clip(&objects, 45));
    let mut walk = analysis.walk(&clip, 0).expect("it starts");
    let unit = walk.info().granularities.len() - 2;
    let mut counted = Vec::new();
    while !walk.at_end() {
        walk.jump(Move::Granularity(unit, motionscope_core::run::Direction::Forward));
        let step = walk.step(None);
        let facts = step.readouts.iter().find_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None });
        let fact = facts.and_then(|facts| facts.iter().find(|fact| fact.label == "Crossings")).expect("it counts");
        counted.push(fact.value.clone());
        let Scene { marks, .. } = walk.scene(None);
        assert!(marks.iter().all(|mark| mark.shape.is_finite()));
    }
    assert_eq!(counted.first().map(String::as_str), Some("0 to the right, 0 to the left"));
    assert_eq!(counted.last().map(String::as_str), Some("1 to the right, 1 to the left"));
    let changes = counted.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert_eq!(changes, 2, "each in its frame");
    walk.jump(Move::To(Cursor { unit: 10, event: usize::MAX }));
    let told = format!("{:?}", walk.step(None));
    assert!(told.contains(&counted[10]), "going back tells what was told before");
}

#[test]
fn who_goes_down_and_who_goes_left_have_a_heading() {
    let down = (0, [100.0, 20.0], [0.0, 4.0], 30);
    let left = (0, [300.0, 120.0], [-4.0, 0.0], 30);
    let field = run(&*analysis(&[]), &clip(&[down, left], 32));
    let last = |i: usize| field.trajectories[i].sightings.last().and_then(|seen| seen.heading_deg()).expect("it moves");
    // From x towards y, as orientations of keypoints.
    assert!((last(0) - 90.0).abs() < 1.0, "{}", last(0));
    assert!(last(1) > 179.0 && last(1) <= 180.0, "{}", last(1));
}

#[test]
fn who_ends_in_the_zone_is_not_counted_there_for_ever() {
    let clip = clip(&[(0, [20.0, 60.0], [4.0, 0.0], 20), (0, [20.0, 160.0], [4.0, 0.0], 60)], 60);
    let analysis = analysis(&[("zones", "60,20,160,100")]);
    let mut walk = analysis.walk(&clip, 0).expect("it starts");
    let mut inside = |unit: usize| {
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        let readouts = walk.step(None).readouts;
        let facts =
            readouts.iter().find_map(|r| if let Readout::Facts(facts) = r { Some(facts.clone()) } else { None });
        let facts = facts.expect("facts");
        facts.iter().find(|fact| fact.label == "Tracks inside").expect("it counts").value.clone()
    };
    assert_eq!([inside(5), inside(18), inside(58)], ["0", "1", "0"]);
}

#[test]
fn a_car_against_its_lane_is_the_only_anomaly_and_counted_the_other_way() {
    const LINE_X: f64 = 160.0;
    let sample = synth::scene("wrong-way").expect("it is bundled");
    let clip = sample.clip(&sample.difficulty()).expect("a clip");
    let truth = clip.truth().expect("exact");
    let frames = clip.info().frames.expect("a synthetic clip has an end");
    let mut paths: BTreeMap<u32, Vec<[f64; 2]>> = BTreeMap::new();
    for t in 0..frames {
        for object in truth.objects(t).expect("readable").unwrap_or_default().iter().filter(|o| o.visibility > 0.3) {
            let center = [object.x + object.width / 2.0, object.y + object.height / 2.0].map(f64::from);
            paths.entry(object.id).or_default().push(center);
        }
    }
    // The lower lane leads to the right; its one car to the left is the wrong-way driver.
    let velocity = |path: &[[f64; 2]]| path[path.len() - 1][0] - path[0][0];
    let wrong: Vec<u32> =
        paths.iter().filter(|(_, path)| path[0][1] > 122.0 && velocity(path) < 0.0).map(|p| *p.0).collect();
    assert_eq!(wrong, [7]);
    let passes = |path: &[[f64; 2]]| {
        path[0][0].min(path[path.len() - 1][0]) < LINE_X && path[0][0].max(path[path.len() - 1][0]) > LINE_X
    };
    let ways = paths.values().filter(|path| passes(path)).map(|path| velocity(path) > 0.0);
    let (right, left): (Vec<bool>, Vec<bool>) = ways.partition(|way| *way);
    for seed in ["1", "2", "3", "4", "5"] {
        let settings = [("lines", "160,239,160,0"), ("zones", "96,122,224,168"), ("tracker.seed", seed)];
        let field = run(&*analysis(&settings), &clip);
        assert_eq!(crossings(&field.trajectories), [right.len(), left.len()], "noise {seed}");
        let unusual: Vec<_> =
            field.trajectories.iter().filter(|of| of.sightings.iter().any(|seen| seen.anomaly.is_some())).collect();
        let [of] = unusual[..] else { panic!("noise {seed}: {} anomalies", unusual.len()) };
        let last = of.sightings.last().expect("it is seen");
        let expected = paths[&wrong[0]].last().expect("it is there");
        assert!(
            (0..2).all(|i| (last.at[i] - expected[i]).abs() < 6.0),
            "noise {seed}: {last:?} is not at {expected:?}"
        );
        assert_eq!(of.dwells.len(), 1, "noise {seed}: it is in the zone once");
    }
}
