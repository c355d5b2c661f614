//! The Kalman filter on one object, as it runs through clips.

use crate::common::{self, set};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Detection, Frame};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::methods::kalman::chi_square;
use motionscope_core::products::objects::score::scores;
use motionscope_core::products::{ObjectField, TrackStatus};
use motionscope_core::run::{AnyEstimator, Move, Walk};
use motionscope_core::scene::{Matrix, Readout, Role, Series, Shape};
use motionscope_core::synth;

fn run(estimator: &dyn AnyEstimator, clip: &Clip) -> ObjectField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<ObjectField>().expect("objects").clone()
}

fn scene(id: &str) -> Clip {
    synth::make(id, &synth::scene(id).expect("it is bundled").difficulty()).expect("a clip")
}

fn found(center: [f32; 2], size: [f32; 2], score: f32) -> Detection {
    Detection { bounds: Bounds::around(center, size), center, score, blob: None, deviation_px: None }
}

fn rows(frames: Vec<Vec<Detection>>) -> Clip {
    Clip::blank("rows", (640, 480), frames.len()).with_detections(frames)
}

/// Where the true object `id` is in frame `t`.
fn truth(clip: &Clip, t: usize, id: u32) -> [f64; 2] {
    let objects = clip.truth().expect("exact").objects(t).expect("readable").expect("objects");
    let object = objects.iter().find(|object| object.id == id).expect("it is there");
    [object.x + object.width / 2.0, object.y + object.height / 2.0].map(f64::from)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// What the steps of a run show, from the first to the last.
fn steps(estimator: &dyn AnyEstimator, clip: &Clip, mut look: impl FnMut(&dyn Walk)) {
    let mut walk = estimator.walk(clip, 0).expect("a run");
    let step = walk.info().granularities.len() - 1;
    while !walk.at_end() {
        walk.jump(Move::Granularity(step, motionscope_core::run::Direction::Forward));
        look(&*walk);
    }
}

fn matrices(walk: &dyn Walk) -> Vec<Matrix> {
    let all = walk.step(None).readouts.into_iter();
    all.filter_map(|readout| if let Readout::Matrices(all) = readout { Some(all) } else { None }).flatten().collect()
}

fn series(estimator: &dyn AnyEstimator, clip: &Clip, title: &str) -> Series {
    let mut walk = estimator.walk(clip, 0).expect("a run");
    walk.jump(Move::End);
    let all = walk.step(None).readouts.into_iter();
    let mut all = all.filter_map(|readout| if let Readout::Series(series) = readout { Some(series) } else { None });
    all.find(|series| series.title == title).expect("it is plotted")
}

#[test]
fn detections_are_ranked_by_score_whatever_their_boxes_are() {
    // Not numbers, and infinite: a sort by them has no order.
    let wild = |i: usize| match i % 3 {
        0 => found([f32::NAN; 2], [f32::INFINITY; 2], f32::NAN),
        1 => found([50.0, 50.0], [f32::NAN, 5.0], 0.9),
        _ => found([60.0 + i as f32, 50.0], [1.0 + i as f32, 5.0], 0.5 + (i % 5) as f32),
    };
    let clip = rows(vec![(0..90).map(wild).collect(); 3]);
    run(&*set("kalman-filter", &[]), &clip);
    let order = |object: &str| {
        let frame = vec![
            found([100.0, 100.0], [10.0; 2], 0.5),
            found([200.0, 100.0], [99.0; 2], 0.5),
            found([300.0, 100.0], [10.0; 2], 0.9),
        ];
        run(&*set("kalman-filter", &[("object", object)]), &rows(vec![frame; 2])).frames[0].objects[0].position[0]
    };
    assert_eq!(["1", "2", "3"].map(order), [300.0, 100.0, 200.0], "of one score they keep their order");
    let mut told = String::new();
    let few = rows(vec![vec![found([100.0; 2], [10.0; 2], 1.0)]; 2]);
    steps(&*set("kalman-filter", &[("object", "7")]), &few, |walk| told += &walk.step(None).sentence.plain());
    assert!(told.contains("Object 7 was chosen, but only one was detected"), "{told}");
}

#[test]
fn the_noise_does_not_change_who_is_followed() {
    for (id, object, wanted) in [("traffic", "1", 1), ("traffic", "2", 2), ("crossing-stars", "1", 1)] {
        let clip = scene(id);
        for seed in 1..=20 {
            let settings = [("object", object), ("seed", &*seed.to_string()), ("added-noise", "1")];
            let field = run(&*set("kalman-filter", &settings), &clip);
            let first = field.frames.iter().position(|frame| !frame.objects.is_empty()).expect("it begins");
            let off = distance(field.frames[first].objects[0].position, truth(&clip, first, wanted));
            assert!(off < 5.0, "{id}, object {object}, noise {seed}: {off} px off");
        }
    }
}

#[test]
fn the_box_follows_what_is_measured() {
    let side = |t: usize| 20.0 + 6.0 * t as f32;
    let clip = rows((0..20).map(|t| vec![found([300.0, 240.0], [side(t); 2], 0.9)]).collect());
    for frame in run(&*set("kalman-filter", &[("smooth", "on")]), &clip).frames.iter().zip(0..20) {
        let (frame, t) = frame;
        let iou = frame.objects[0].bounds.iou(&Bounds::around([300.0, 240.0], [side(t); 2]));
        assert!(iou > 0.6, "frame {t}: {iou}");
        assert_eq!(frame.objects[0].detection, Some(0));
    }
}

#[test]
fn a_box_stays_where_it_is_around_a_centroid() {
    for id in ["kalman-filter", "kalman-tracker"] {
        let at = |t: usize| {
            let bounds = Bounds::around([100.0 + 4.0 * t as f32, 200.0], [30.0, 60.0]);
            Detection {
                bounds,
                center: [bounds.min[0] + 5.0, bounds.max[1] - 8.0],
                score: 1.0,
                blob: None,
                deviation_px: None,
            }
        };
        let field = run(&*set(id, &[]), &rows((0..20).map(|t| vec![at(t)]).collect()));
        let iou = field.frames[19].objects[0].bounds.iou(&at(19).bounds);
        assert!(iou > 0.9, "{id}: {iou}");
    }
}

#[test]
fn one_is_scored_against_the_one_that_it_follows() {
    let clip = scene("traffic");
    let exact = set("kalman-filter", &[("added-noise", "0"), ("measurement-noise", "0.5")]);
    let found = scores(&run(&*exact, &clip), &**clip.truth().expect("exact")).expect("readable").expect("objects");
    assert!(found.mota > 0.6 && found.recall > 0.7, "the others are not missed: {found:?}");
}

#[test]
fn an_inconsistent_filter_shows_in_the_plot() {
    // A thrown ball is not of constant velocity: what is measured falls out of the gate, and counts all the same.
    let settings = [("process-noise", "0.1"), ("smooth", "off"), ("restart", "off")];
    let (clip, filter) = (scene("fast-ball"), set("kalman-filter", &settings));
    let Series { lines, bands, thresholds, .. } = series(&*filter, &clip, "NIS");
    let named = |name: &str| lines.iter().find(|(other, ..)| *other == name).map(|(.., points)| points.clone());
    let (all, refused) = (named("NIS").expect("a line"), named("rejected").expect("marked"));
    let limit = chi_square::quantile(0.99, 2) as f32;
    assert!(!refused.is_empty() && refused.iter().all(|point| point[1] > limit && all.contains(point)), "{refused:?}");
    let band = [0.025, 0.975].map(|p| chi_square::quantile(p, 2) as f32);
    assert_eq!(bands.iter().map(|band| band.values).collect::<Vec<_>>(), [band]);
    assert!(thresholds.len() == 1 && (thresholds[0].1 - limit).abs() < 1e-3, "{thresholds:?}");
    let nees = series(&*filter, &clip, "NEES");
    assert_eq!(nees.bands.iter().map(|band| band.values).collect::<Vec<_>>(), [band]);
}

#[test]
fn each_sensor_has_its_own_plot() {
    let clip = scene("crossing-stars");
    let filter = set("kalman-filter", &[("sensors", "position-and-velocity"), ("smooth", "off")]);
    for (title, dof) in [("NIS of the first sensor", 2), ("NIS of the second sensor", 4)] {
        let Series { lines, bands, .. } = series(&*filter, &clip, title);
        let upper = bands.last().expect("a bound").values[1];
        assert_eq!(upper, chi_square::quantile(0.975, dof) as f32, "{title}");
        assert!(lines[0].2.len() > 15, "{title}");
    }
}

/// Mean over 100 seeds of the squared error of the estimate in each frame, from frame 2 on while the object is in the picture.
fn mean_nees(clip: &Clip, settings: &[(&str, &str)]) -> Vec<f64> {
    let mut sums: Vec<f64> = Vec::new();
    let objects = |t| clip.truth().expect("exact").objects(t).expect("readable").unwrap_or_default();
    let is_there = |t: &usize| objects(*t).iter().any(|object| object.id == 1);
    let frames = (0..clip.info().frames.expect("known")).take_while(is_there).count();
    for seed in 1..=100 {
        let mut filter = set("kalman-filter", settings);
        filter.set("seed", &seed.to_string()).expect("in range");
        let field = run(&*filter, clip);
        sums.resize(frames, 0.0);
        for (t, sum) in sums.iter_mut().enumerate() {
            let object = &field.frames[t].objects[0];
            let [[xx, xy], [yx, yy]] = object.covariance.expect("it is known");
            let [x, y] = object.position;
            let true_place = truth(clip, t, 1);
            let (dx, dy) = (true_place[0] - x, true_place[1] - y);
            *sum += (yy * dx * dx - (xy + yx) * dx * dy + xx * dy * dy) / (xx * yy - xy * yx) / 100.0;
        }
    }
    sums.split_off(2)
}

#[test]
fn the_estimator_is_consistent_on_clips_over_a_hundred_seeds() {
    let [low, high] = [0.025, 0.975].map(|p| chi_square::quantile(p, 200) / 100.0);
    let common = [("source", "truth"), ("smooth", "off"), ("gate", "0.9999"), ("restart", "off")];
    // Stars turn a little on their way; a ball falls.
    for (id, model) in [
        ("crossing-stars", [("motion", "velocity"), ("process-noise", "0.4")]),
        ("fast-ball", [("motion", "acceleration"), ("process-noise", "0.3")]),
    ] {
        let means = mean_nees(&scene(id), &[&common[..], &model[..]].concat());
        let inside = means.iter().filter(|mean| (low..high).contains(*mean)).count();
        // Nineteen of twenty are expected of independent frames; these follow from each other, so one mishap lasts for some.
        assert!(5 * inside >= 4 * means.len(), "{id}: {inside} of {} in {low}..{high}: {means:?}", means.len());
    }
    let wrong = mean_nees(&scene("fast-ball"), &[&common[..], &[("process-noise", "0.05")]].concat());
    assert!(wrong.iter().any(|mean| *mean > 10.0 * high), "a wrong model shows: {wrong:?}");
}

#[test]
fn a_second_sensor_continues_through_an_occlusion_of_the_first() {
    let clip = scene("crossing-stars");
    let hidden = [("occlusion-start", "8"), ("occlusion-frames", "6"), ("smooth", "off")];
    let of = |sensors| run(&*set("kalman-filter", &[&hidden[..], &[("sensors", sensors)]].concat()), &clip);
    let (one, two) = (of("one"), of("two-positions"));
    for t in 8..14 {
        assert_eq!(
            [&one, &two].map(|field| field.frames[t].objects[0].status),
            [TrackStatus::Coasting, TrackStatus::Confirmed]
        );
    }
    let deviation = |field: &ObjectField| field.frames[13].objects[0].covariance.expect("it is known")[0][0].sqrt();
    assert!(deviation(&two) < 0.6 * deviation(&one), "{} and {} px", deviation(&two), deviation(&one));
}

#[test]
fn what_has_left_the_picture_is_given_up() {
    let at = |t: usize| found([100.0 * t as f32, 240.0], [400.0; 2], 1.0);
    let clip = rows((0..40).map(|t| if t < 6 { vec![at(t)] } else { vec![] }).collect());
    for (id, settings) in [
        ("kalman-filter", vec![("initial-speed", "200"), ("max-age", "200")]),
        ("kalman-tracker", vec![("max-age", "200")]),
    ] {
        let field = run(&*set(id, &settings), &clip);
        let last = field.frames.iter().rposition(|frame| !frame.objects.is_empty()).expect("it is followed");
        assert!((7..25).contains(&last), "{id} gives it up after frame {last}");
        assert!(field.frames[last].objects.iter().all(|object| object.position[0] < 2.0 * 640.0));
    }
}

#[test]
fn what_is_reported_is_true_of_the_step() {
    let mut frames = vec![vec![found([100.0, 100.0], [10.0; 2], 1.0)]; 3];
    frames.push(vec![found([400.0, 300.0], [10.0; 2], 1.0)]);
    frames.extend([vec![], vec![]]);
    let (mut told, mut legends) = (Vec::new(), Vec::new());
    steps(&*set("kalman-filter", &[("max-age", "1"), ("gate", "0.9999")]), &rows(frames), |walk| {
        told.push(walk.step(None).sentence.plain());
        let scene = walk.scene(None);
        let meaning = |role| scene.legend.iter().find(|(other, _)| *other == role).map(|(_, meaning)| *meaning);
        legends.push((meaning(Role::Best), meaning(Role::Estimate)));
    });
    let all = told.join("\n");
    assert!(all.contains("99.99 % gate"), "{all}");
    assert!(all.contains("The measurement is rejected, so the track coasts"), "{all}");
    assert!(all.contains("(1 missed frame)") || all.contains(" 1 missed frame "), "{all}");
    assert!(!all.contains("1 missed frame in a row"), "{all}");
    assert!(all.contains("No track after the deletion, and no measurement in frame 5"), "{all}");
    assert!(!all.contains("No measurement up to frame"), "{all}");
    assert!(legends.iter().any(|(arrow, _)| arrow.is_some_and(|text| text.contains("innovation"))));
    assert!(legends.iter().any(|(_, estimate)| *estimate == Some("filtered estimate")), "{legends:?}");
}

#[test]
fn three_rejections_in_a_row_suggest_a_remedy_and_a_run_ends_with_a_conclusion() {
    let mut frames = vec![vec![found([100.0, 100.0], [10.0; 2], 1.0)]; 4];
    frames.extend(vec![vec![found([400.0, 300.0], [10.0; 2], 1.0)]; 4]);
    let mut told = Vec::new();
    steps(&*set("kalman-filter", &[]), &rows(frames), |walk| told.push(walk.step(None).sentence.plain()));
    let advised = |count: &str| told.iter().any(|said| said.contains(&format!("{count} rejections in a row")));
    assert_eq!(["2", "3", "4"].map(advised), [false, true, true], "{}", told.join("\n"));
    let mut told = Vec::new();
    steps(&*set("kalman-filter", &[("source", "truth")]), &scene("crossing-stars"), |walk| {
        told.push(walk.step(None).sentence.plain());
    });
    let concluded = |said: &&String| said.contains("Mean NIS");
    let last = told.last().expect("steps");
    assert!(concluded(&last) && told.iter().filter(concluded).count() == 1, "{last}");
}

#[test]
fn rejected_detections_of_other_objects_are_not_blamed_on_the_motion_model() {
    // A bridge hides the tracked car while others are detected.
    let mut told = Vec::new();
    steps(&*set("kalman-filter", &[("source", "truth")]), &scene("traffic"), |walk| {
        told.push(walk.step(None).sentence.plain());
    });
    assert!(told.iter().any(|said| said.contains("; the tracked object is ")), "another object is measured");
    let first = told.iter().find(|said| said.contains("3 rejections in a row")).expect("three in a row");
    assert!(first.contains("all of other objects") && !first.contains("does not fit"), "{first}");
}

#[test]
fn the_plot_contains_the_frame_at_hand_from_its_gate_on_and_follows_smoothing_back() {
    let clip = astray(8, &[5]);
    let (mut gates, mut last) = (Vec::new(), None);
    steps(&*set("kalman-filter", &[]), &clip, |walk| {
        let step = walk.step(None);
        let plots = step.readouts.iter().filter_map(|readout| match readout {
            Readout::Series(series) => Some(series),
            _ => None,
        });
        let Some(nis) = plots.into_iter().find(|series| series.title == "NIS") else { return };
        let said = step.sentence.plain();
        if let Some((_, rest)) = said.split_once("d² = ") {
            let plotted = nis.lines[0].2.last().expect("the frame at hand")[1];
            let said = rest.split(". ").next().unwrap_or(rest);
            gates.push((common::numbers(said)[0], f64::from(plotted)));
        }
        last = nis.now();
    });
    assert!(gates.len() >= 5, "{gates:?}");
    // The sentence has two decimals.
    assert!(gates.iter().all(|(said, plotted)| (said - plotted).abs() < 0.006), "{gates:?}");
    assert_eq!(last, Some(0.0), "smoothing ends in frame 0");
}

#[test]
fn the_numbers_of_a_prediction_with_acceleration_add_up() {
    let center = |t: usize| [50.0 + 8.0 * t as f32 - 0.3 * (t * t) as f32, 100.0];
    let clip = rows((0..12).map(|t| vec![found(center(t), [10.0; 2], 1.0)]).collect());
    let mut sums = Vec::new();
    steps(&*set("kalman-filter", &[("motion", "acceleration"), ("smooth", "off")]), &clip, |walk| {
        let step = walk.step(None);
        let said = step.sentence.plain();
        if !said.starts_with("Prediction for frame") {
            return;
        }
        assert!(said.contains("the uncertain velocity and acceleration"), "{said}");
        let lines =
            step.readouts.iter().find_map(|r| if let Readout::Equation(lines) = r { Some(lines) } else { None });
        let told = lines.and_then(|lines| lines.last()).expect("numbers").plain();
        let (_, told) = told.split_once(" = ").expect("a sum");
        let (terms, predicted) = told.rsplit_once(" = ").expect("its value");
        let (rest, half) = terms.split_once("½ · ").expect("the acceleration");
        let signs: Vec<f64> =
            rest.chars().filter_map(|c| [('+', 1.0), ('−', -1.0)].iter().find(|s| s.0 == c).map(|s| s.1)).collect();
        let values = common::numbers(&rest.replace(['+', '−'], " "));
        let sum = values[0] + signs[0] * values[1] + signs[1] * 0.5 * common::numbers(half)[0];
        sums.push((sum, common::numbers(predicted)[0], common::numbers(half)[0]));
    });
    assert!(sums.len() > 8 && sums.iter().any(|(_, _, half)| half.abs() > 0.1), "{sums:?}");
    assert!(sums.iter().all(|(sum, predicted, _)| (sum - predicted).abs() < 0.0051), "{sums:?}");
}

#[test]
fn the_numbers_of_a_gate_give_its_squared_distance() {
    let mut gates = 0;
    for motion in ["velocity", "acceleration", "turn", "imm"] {
        steps(&*set("kalman-filter", &[("motion", motion), ("source", "truth")]), &scene("crossing-stars"), |walk| {
            let formulas = walk.step(None).formulas().iter().map(|line| line.plain()).collect::<Vec<_>>();
            assert!(formulas.iter().all(|line| !line.contains(['\\', '{'])), "{formulas:?}");
            let Some(line) = formulas.iter().find(|line| line.starts_with("d^2 = ν^T")) else { return };
            let [.., terms, distance] = line.split(" = ").collect::<Vec<_>>()[..] else { panic!("{line}") };
            let numbers = common::numbers(terms);
            let [x, y, xx, xy, yx, yy, _, ..] = numbers[..] else { panic!("{line}") };
            let squared = (yy * x * x - (xy + yx) * x * y + xx * y * y) / (xx * yy - xy * yx);
            assert!((squared - common::numbers(distance)[0]).abs() < 0.0051, "{squared}: {line}");
            gates += 1;
        });
    }
    assert!(gates > 60, "{gates}");
}

#[test]
fn the_path_ends_at_the_estimate_of_the_step() {
    let mut seen = 0;
    steps(&*set("kalman-filter", &[("smooth", "off")]), &astray(8, &[]), |walk| {
        if !walk.step(None).sentence.plain().starts_with("Update with") {
            return;
        }
        let of = |is: fn(&Shape) -> Option<[f32; 2]>| {
            let scene = walk.scene(None);
            scene.marks.iter().rev().filter(|mark| mark.role == Role::Estimate).find_map(|mark| is(&mark.shape))
        };
        let path = of(|shape| if let Shape::Path { points, .. } = shape { points.last().copied() } else { None });
        let estimate = of(|shape| if let Shape::Points(points) = shape { points.last().copied() } else { None });
        assert!(estimate.is_some() && path == estimate, "{path:?} and {estimate:?}");
        seen += 1;
    });
    assert!(seen > 5, "{seen}");
}

/// An object at 5 px/frame; in the frames `astray` something else is detected, far outside the gate.
fn astray(frames: usize, astray: &[usize]) -> Clip {
    let center = |t: usize| if astray.contains(&t) { [600.0, 400.0] } else { [100.0 + 5.0 * t as f32, 100.0] };
    rows((0..frames).map(|t| vec![found(center(t), [10.0; 2], 1.0)]).collect())
}

/// The sentence at the end of a run, and its d² of the accepted measurements.
fn verdict(clip: &Clip) -> (String, Vec<f64>) {
    let estimator = set("kalman-filter", &[]);
    let mut walk = estimator.walk(clip, 0).expect("a run");
    walk.jump(Move::End);
    let plot = series(&*estimator, clip, "NIS");
    let points = |name: &str| plot.lines.iter().filter(|line| line.0 == name).flat_map(|line| line.2.clone()).collect();
    let (all, refused): (Vec<[f32; 2]>, Vec<[f32; 2]>) = (points("NIS"), points("rejected"));
    let is_accepted = |point: &&[f32; 2]| point[1].is_finite() && refused.iter().all(|other| other[0] != point[0]);
    let accepted = all.iter().filter(is_accepted).map(|point| f64::from(point[1])).collect();
    (walk.step(None).sentence.plain(), accepted)
}

#[test]
fn rejected_measurements_have_no_part_in_the_verdict() {
    // The first measurement starts the track: the gate tests all others.
    let (said, accepted) = verdict(&astray(20, &[8, 14]));
    assert!(said.contains("The gate rejected 2 of 19 measurements."), "{said}");
    assert_eq!(accepted.len(), 17);
    let (_, told) = said.split_once("Mean NIS ").expect("the mean of the others");
    let mean = accepted.iter().sum::<f64>() / 17.0;
    assert!((common::numbers(told)[0] - mean).abs() < 0.006, "{mean}: {said}");
}

#[test]
fn a_filter_that_rejects_much_is_not_called_consistent() {
    let (said, accepted) = verdict(&astray(20, &[4, 6, 8, 10, 12, 14, 16, 18]));
    assert_eq!(accepted.len(), 11);
    assert!(said.contains("The gate rejected 8 of 19 measurements."), "{said}");
    assert!(said.contains("With 42 % rejected, the NIS of the rest does not test the filter."), "{said}");
    assert!(!said.contains("Mean NIS") && !said.contains("is consistent"), "{said}");
    let (said, accepted) = verdict(&astray(5, &[1, 2, 3, 4]));
    assert!(accepted.is_empty() && said.contains("The gate rejected 4 of 4 measurements."), "{said}");
    assert!(said.contains("No measurement was accepted") && !said.contains("is consistent"), "{said}");
}

#[test]
fn all_matrices_that_change_are_lit() {
    let clip = scene("crossing-stars");
    let mut lit: Vec<(&str, usize)> = Vec::new();
    steps(&*set("kalman-filter", &[("motion", "turn"), ("smooth", "off")]), &clip, |walk| {
        for matrix in matrices(walk) {
            let count = matrix.changed.map_or(0, |changed| changed.cells().iter().filter(|lit| **lit).count());
            lit.push((matrix.symbol, count));
        }
    });
    let most = |symbol| lit.iter().filter(|(other, _)| *other == symbol).map(|(_, count)| *count).max();
    for symbol in ["x", "P", "F", "ν", "S", "K"] {
        assert!(most(symbol) > Some(0), "{symbol}");
    }
    for symbol in ["H", "R", "Q"] {
        assert_eq!(most(symbol), Some(0), "{symbol} never changes");
    }
}

#[test]
fn a_click_chooses_the_object_that_another_source_detects() {
    let clip = scene("traffic");
    let truth = clip.truth().expect("exact");
    let cars = truth.objects(3).expect("readable").expect("objects");
    for car in cars.iter().filter(|car| car.visibility > 0.9) {
        let [x, y] = [car.x + car.width / 2.0, car.y + car.height / 2.0];
        let click = format!("3:{x},{y}");
        let settings = [("source", "truth"), ("added-noise", "0"), ("clicks", &*click), ("smooth", "off")];
        let field = run(&*set("kalman-filter", &settings), &clip);
        assert!(field.frames[..3].iter().all(|frame| frame.objects.is_empty()), "it begins where it was clicked");
        let [u, v] = field.frames[3].objects[0].position;
        assert!((u - f64::from(x)).hypot(v - f64::from(y)) < 1e-3, "{u}, {v} where {click} was clicked");
    }
    let nothing = [("source", "truth"), ("clicks", "3:-900,-900"), ("smooth", "off")];
    let field = run(&*set("kalman-filter", &nothing), &clip);
    assert!(field.frames.iter().all(|frame| frame.objects.is_empty()), "nobody is there");
}

/// A bright ball that is thrown before a dark wall, passing a bright ruler that flickers, with the arm that throws it; true places
/// from frame 6 on.
fn thrown_ball() -> (Clip, Vec<[f64; 2]>) {
    let place = |t: usize| {
        let t = t as f64 - 6.0;
        [90.0 + 11.0 * t, 120.0 - 15.0 * t + 1.1 * t * t]
    };
    let frame = |t: usize| {
        Frame::gray(Grid::from_fn(320, 240, |x, y| {
            let [bx, by] = place(t);
            let (dx, dy) = (x as f64 - bx, y as f64 - by);
            let noise = (x * 31 + y * 17 + t * 53) % 5;
            let is_ruler = (190..196).contains(&x) && y % 24 > 2;
            // Every piece of the ruler flickers for itself.
            let flicker = 40 * ((y / 24 * 7 + t * 5) % 3);
            let reach = 60 + 2 * t.min(8);
            let is_arm = t > 1 && (118..138).contains(&y) && x < reach;
            let level = match () {
                () if t >= 6 && dx.hypot(dy) <= 5.0 => 230,
                () if is_ruler => 120 + flicker,
                () if is_arm => 140,
                () => 25,
            };
            (level + noise) as u8
        }))
    };
    let clip = Clip::from_frames("ball", (0..26).map(frame).collect()).expect("frames of one size");
    (clip, (6..26).map(place).collect())
}

#[test]
fn a_click_where_nothing_is_detected_begins_the_track() {
    let place = |t: usize| [60.0 + 6.0 * t as f32, 200.0 - 3.0 * t as f32];
    let found = |center: [f32; 2]| Detection {
        bounds: Bounds::around(center, [10.0, 10.0]),
        center,
        score: 0.9,
        blob: None,
        deviation_px: None,
    };
    // Something else stands still; the object is missed in frame 3.
    let frame = |t: usize| [vec![found([400.0, 80.0])], if t == 3 { vec![] } else { vec![found(place(t))] }].concat();
    let clip = Clip::blank("missed", (640, 480), 14).with_detections((0..14).map(frame).collect());
    let [x, y] = place(3);
    let field = run(&*set("kalman-filter", &[("clicks", &format!("3:{x},{y}"))]), &clip);
    assert!(field.frames[..3].iter().all(|frame| frame.objects.is_empty()), "it starts in the frame of the click");
    for t in 4..14 {
        let object = field.frames[t].objects.first().expect("it is followed");
        let off = distance(object.position, place(t).map(f64::from));
        assert!(off < 1.0, "frame {t}: {off:.2} px");
    }
}

#[test]
fn one_click_or_none_follows_a_thrown_ball() {
    let (clip, places) = thrown_ball();
    let is_in = |place: &[f64; 2]| (5.0..315.0).contains(&place[0]) && (5.0..235.0).contains(&place[1]);
    let error = |settings: &[(&str, &str)], from: usize| {
        let field = run(&*set("kalman-filter", settings), &clip);
        let off = (from..26).filter(|t| is_in(&places[t - 6])).map(|t| {
            let object = field.frames[t].objects.first();
            object.map_or(f64::INFINITY, |object| distance(object.position, places[t - 6]))
        });
        let off: Vec<f64> = off.collect();
        off.iter().sum::<f64>() / off.len() as f64
    };
    for t in [7, 9, 12, 15] {
        let [x, y] = places[t - 6];
        let click = format!("{t}:{x},{y}");
        let found = error(&[("clicks", &click)], t);
        println!("click in frame {t}: {found:.2} px");
        assert!(found <= 3.0, "a click in frame {t}: {found:.2} px off on average");
    }
    let found = error(&[], 10);
    println!("no click: {found:.2} px");
    assert!(found <= 3.0, "without a click: {found:.2} px off on average");
}

#[test]
fn clicks_are_not_scored_as_boxes() {
    let clip = scene("traffic");
    let clicks = "0:30,144 1:37,144 2:44,144 3:51,144 4:58,144 5:65,144";
    let truth = clip.truth().expect("exact");
    for id in ["kalman-filter", "kalman-tracker"] {
        let field = run(&*set(id, &[("clicks", clicks), ("frames", "6")]), &clip);
        assert!(field.frames.iter().any(|frame| !frame.objects.is_empty()), "{id} follows what was clicked");
        assert_eq!(scores(&field, &**truth).expect("readable").map(|scores| scores.mota), None, "{id}");
    }
}

#[test]
fn clicks_on_a_thrown_ball_show_that_constant_velocity_is_biased() {
    // 4 px/frame² of gravity: with the wide gate of the first frames among them, the mean NIS is that of a consistent filter.
    let clicks: Vec<String> = (0..12).map(|t| format!("{t}:{},{}", 60 + 11 * t, 300 - 24 * t + 2 * t * t)).collect();
    // Something else stands still.
    let clip = rows(vec![vec![found([600.0, 40.0], [10.0; 2], 1.0)]; 12]);
    let mut walk = set("kalman-filter", &[("clicks", &clicks.join(" "))]).walk(&clip, 0).expect("a run");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("The innovations are biased by") && said.contains("constant acceleration"), "{said}");
    assert!(!said.contains("the filter is consistent"), "{said}");
}

/// A hand that rests, and a ball that it has thrown: 12 px/frame² down.
fn thrown(frames: usize) -> (Clip, Vec<[f64; 2]>) {
    let ball = |t: usize| [100.0 + 20.0 * t as f32, 400.0 - 84.0 * t as f32 + 6.0 * (t * t) as f32];
    let rows_of = |t: usize| vec![found(ball(t), [12.0; 2], 0.9), found([20.0, 480.0], [40.0; 2], 0.8)];
    (rows((0..frames).map(rows_of).collect()), (0..frames).map(|t| ball(t).map(f64::from)).collect())
}

/// The largest error of the estimates in px; infinite where there is none.
fn largest_error(field: &ObjectField, truth: &[[f64; 2]]) -> f64 {
    let error = |(frame, at): (&std::sync::Arc<motionscope_core::products::ObjectFrame>, &[f64; 2])| {
        frame.objects.first().map_or(f64::INFINITY, |object| distance(object.position, *at))
    };
    field.frames.iter().zip(truth).map(error).fold(0.0, f64::max)
}

#[test]
fn a_diverged_filter_restarts_with_the_model_that_explains_its_detections() {
    let (clip, ball) = thrown(16);
    let circle = |t: usize| {
        let angle = 0.35 * t as f64;
        [300.0 + 80.0 * angle.cos(), 240.0 + 80.0 * angle.sin()]
    };
    let turning: Vec<[f64; 2]> = (0..24).map(circle).collect();
    let turns = rows(turning.iter().map(|at| vec![found(at.map(|c| c as f32), [12.0; 2], 0.9)]).collect());
    for (clip, truth) in [(&clip, &ball), (&turns, &turning)] {
        for smooth in ["on", "off"] {
            let of = |on| run(&*set("kalman-filter", &[("restart", on), ("smooth", smooth)]), clip);
            let [kept, restarted] = ["off", "on"].map(|on| largest_error(&of(on), truth));
            assert!(kept > 40.0 && restarted < 5.0, "{kept} px without a restart, {restarted} px with one");
        }
    }
    let mut told = Vec::new();
    steps(&*set("kalman-filter", &[]), &clip, |walk| {
        let step = walk.step(None);
        told.push((step.line.as_str(), step.sentence.plain()));
    });
    let restarts: Vec<&String> = told.iter().filter(|(line, _)| *line == "restart").map(|(_, said)| said).collect();
    let [said] = restarts[..] else { panic!("{} restarts", restarts.len()) };
    // Both models with the detections that they accept.
    assert!(said.contains("restarted with constant acceleration"), "{said}");
    assert!(
        said.contains("constant velocity accepts 2 of 5") && said.contains("acceleration accepts 5 of 5"),
        "{said}"
    );
    let end = &told.last().expect("steps").1;
    assert!(end.contains("from frame 0 with constant acceleration") && !end.contains("rejected"), "{end}");
}

#[test]
fn a_filter_that_has_not_diverged_is_not_restarted() {
    // Single outliers, a jump that no model explains, an occlusion with other objects in view, and a good track.
    let mut jump = vec![vec![found([100.0, 100.0], [10.0; 2], 1.0)]; 4];
    jump.extend(vec![vec![found([400.0, 300.0], [10.0; 2], 1.0)]; 8]);
    let clips = [astray(20, &[8, 14]), rows(jump), scene("traffic"), scene("crossing-stars")];
    for clip in &clips {
        for motion in ["velocity", "acceleration", "turn"] {
            let of = |on| run(&*set("kalman-filter", &[("restart", on), ("motion", motion)]), clip);
            let places = |field: &ObjectField| -> Vec<Option<[f64; 2]>> {
                field.frames.iter().map(|frame| frame.objects.first().map(|object| object.position)).collect()
            };
            assert_eq!(places(&of("on")), places(&of("off")), "{} with {motion}", clip.info().name);
        }
    }
    let mut told = String::new();
    steps(&*set("kalman-filter", &[]), &clips[1], |walk| told += &walk.step(None).sentence.plain());
    assert!(told.contains("No model accepts the rejected ones") && !told.contains("is restarted"), "{told}");
}

#[test]
fn a_walk_restarts_as_a_run_does_and_goes_back() {
    let (clip, ball) = thrown(16);
    let filter = set("kalman-filter", &[]);
    let mut walk = filter.walk(&clip, 0).expect("a run");
    walk.jump(Move::End);
    let whole = walk.output().get::<ObjectField>().expect("objects").clone();
    assert!(largest_error(&whole, &ball) < 5.0);
    // Before the divergence shows, the track is that of the chosen model.
    walk.jump(Move::To(motionscope_core::run::Cursor { unit: 4, event: 0 }));
    let early = walk.output().get::<ObjectField>().expect("objects").clone();
    assert!(early.frames.len() <= 5, "{} frames", early.frames.len());
    walk.jump(Move::End);
    assert_eq!(walk.output().get::<ObjectField>().expect("objects").frames.len(), whole.frames.len());
}
