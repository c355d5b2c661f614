//! Background models with their defaults on clips of a street as a cheap camera sees it, whose seeds and difficulties nothing was chosen for.

use std::collections::BTreeSet;

use crate::common::set;
use crate::rough::{Rough, scored};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame, Mask, PixelClass};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::products::{MaskField, ObjectField, Reference, TrackStatus};
use motionscope_core::run::{AnyEstimator, Cursor, Move, Walk};
use motionscope_core::scene::{Focus, Quantity, Readout, Series, Shape};
use motionscope_core::synth;

/// The frames that a model may learn in.
const LEARNING: usize = 20;

/// Precision, recall and F₁ of the pixels.
fn score(estimator: &dyn AnyEstimator, (clip, truth): &(Clip, Vec<Mask>)) -> [f64; 3] {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    let field = output.get::<ObjectField>().expect("masks");
    let masks: Vec<Mask> = field.frames.iter().map(|f| f.mask.as_ref().expect("a mask").unpacked()).collect();
    scored(masks.iter().zip(truth).skip(LEARNING))
}

/// Held-out clips by name.
fn clips() -> Vec<(&'static str, (Clip, Vec<Mask>))> {
    let usual = Rough { size: (240, 180), frames: 80, ..Rough::default() };
    vec![
        ("steady", Rough { seed: 101, shake: 0.0, flicker: 0.0, shadow: 1.0, ..usual }.clip()),
        ("shaking", Rough { seed: 202, shadow: 0.55, ..usual }.clip()),
        ("noisy", Rough { seed: 303, noise: 5.0, flicker: 0.015, ..usual }.clip()),
    ]
}

#[test]
fn defaults_separate_cars_from_a_street() {
    // The least F of each model, and the best of all; models without shadow detection cannot tell a shadow from a dark car.
    let models = [
        ("running-average", 0.8),
        ("median-background", 0.8),
        ("single-gaussian", 0.8),
        ("mixture-of-gaussians", 0.93),
        ("knn-background", 0.93),
    ];
    for (name, clip) in clips() {
        let mut best = 0.0;
        for (id, least) in models {
            let [precision, recall, f] = score(&*set(id, &[]), &clip);
            println!("{name}: {id}: precision {precision:.3}, recall {recall:.3}, F {f:.3}");
            assert!(f >= least, "{name}: {id}: precision {precision:.3}, recall {recall:.3}, F {f:.3}");
            best = f.max(best);
        }
        assert!(best >= 0.95, "{name}: {best}");
    }
}

#[test]
fn single_pixels_of_noise_do_not_flood_a_difference_of_frames() {
    let usual = Rough { size: (240, 180), frames: 40, shadow: 1.0, shake: 0.0, ..Rough::default() };
    for (name, clip) in [
        ("usual", Rough { seed: 11, ..usual }),
        ("speckled", Rough { seed: 12, speckle: 0.05, ..usual }),
        ("speckled and flickering", Rough { seed: 13, speckle: 0.05, flicker: 0.015, ..usual }),
    ] {
        let clip = clip.clip();
        let [default, unfiltered] =
            [&[][..], &[("area-opening", "0")]].map(|settings| score(&*set("frame-difference", settings), &clip));
        println!("{name}: default {default:.3?}, without area opening {unfiltered:.3?}");
        assert!(default[2] > 0.5, "{name}: precision, recall and F {default:.3?}");
        assert!(name == "usual" || default[2] > 2.0 * unfiltered[2], "{name}: {unfiltered:.3?} becomes {default:.3?}");
    }
}

#[test]
fn a_drifting_camera_is_followed() {
    let clip = Rough { size: (240, 180), frames: 60, seed: 404, drift: [0.4, 0.25], ..Rough::default() }.clip();
    for id in ["mixture-of-gaussians", "knn-background"] {
        let [_, _, followed] = score(&*set(id, &[]), &clip);
        let [_, _, still] = score(&*set(id, &[("camera", "still")]), &clip);
        println!("{id}: F {followed:.3} followed, {still:.3} at rest");
        assert!(followed > 0.7 && followed > still + 0.1, "{id}: {followed:.3} followed, {still:.3} at rest");
    }
}

#[test]
fn on_a_shaking_and_drifting_street_each_car_is_tracked_once() {
    for seed in [707, 708, 709] {
        let street = Rough { seed, frames: 90, drift: [0.1, 0.3], ..Rough::default() };
        let (clip, _) = street.clip();
        let output = set("kalman-tracker", &[]).run(&clip, 0, &Threads::single()).expect("a run");
        let field = output.get::<ObjectField>().expect("tracks");
        // The tracks that lie on each car, and all of them.
        let mut on_car = vec![BTreeSet::new(); street.boxes(0).len()];
        let mut all = BTreeSet::new();
        for (t, frame) in field.frames.iter().enumerate() {
            let confirmed = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed);
            for object in confirmed {
                all.insert(object.id);
                let cars = street.boxes(t);
                let found = (0..cars.len()).filter(|i| object.bounds.iou(&cars[*i]) >= 0.4);
                found.for_each(|i| _ = on_car[i].insert(object.id));
            }
        }
        let is_in_view = |bounds: &Bounds| bounds.min[0] > 0.0 && bounds.max[0] < 320.0;
        for (i, tracks) in on_car.iter().enumerate() {
            let views = (0..90).filter(|t| is_in_view(&street.boxes(*t)[i])).count();
            // A car that has left comes again from the other side.
            let is_back = street.boxes(0)[i].center()[0] > street.boxes(89)[i].center()[0] && i % 2 == 0
                || street.boxes(0)[i].center()[0] < street.boxes(89)[i].center()[0] && i % 2 == 1;
            let most = 1 + usize::from(is_back);
            println!("seed {seed}, car {i}: {} tracks, in view {views} frames", tracks.len());
            assert!(views < 30 || (1..=most).contains(&tracks.len()), "seed {seed}, car {i}: {tracks:?}");
        }
        let false_tracks = all.iter().filter(|id| on_car.iter().all(|tracks| !tracks.contains(*id))).count();
        println!("seed {seed}: {false_tracks} false tracks");
        assert!(false_tracks <= 2, "seed {seed}: {false_tracks} false tracks");
    }
}

#[test]
fn a_flooded_mask_names_its_cause_and_what_to_use_instead() {
    // The light jumps: everything differs.
    let frame = |t: usize| Frame::gray(Grid::from_fn(96, 72, |x, y| (40 + (7 * x + 3 * y) % 50 + 90 * (t / 3)) as u8));
    let clip = Clip::from_frames("light", (0..5).map(frame).collect()).expect("frames of one size");
    let mut walk =
        set("running-average", &[("initial", "first-frame"), ("exposure", "ignored")]).walk(&clip, 0).expect("a run");
    walk.jump(Move::To(Cursor { unit: 4, event: usize::MAX }));
    let told = walk.step(None).sentence.plain();
    assert!(told.contains("the camera moves, or the light has changed") && told.contains("optical flow"), "{told}");
}

#[test]
fn masks_are_scored_against_the_true_foreground() {
    let scene = synth::SCENES.iter().find(|scene| scene.id == "traffic").expect("a bundled scene");
    let clip =
        scene.clip(&synth::Difficulty { width: 160, height: 120, frames: 6, ..scene.difficulty() }).expect("sound");
    let output = set("mixture-of-gaussians", &[]).run(&clip, 0, &Threads::single()).expect("a run");
    let masks = output.get::<MaskField>().expect("masks");
    let truth = clip.truth().expect("a synthetic clip");
    let mut counts = [0.0; 3];
    for (t, mask) in masks.masks().skip(1) {
        let (mask, truth) = (mask.unpacked(), truth.foreground(t).expect("sound").expect("objects"));
        for y in 0..120 {
            for x in 0..160 {
                match (mask.get(x, y), truth.0[(x, y)] == PixelClass::Foreground) {
                    (true, true) => counts[0] += 1.0,
                    (true, false) => counts[1] += 1.0,
                    (false, true) => counts[2] += 1.0,
                    (false, false) => {}
                }
            }
        }
    }
    let [hits, alarms, misses] = counts;
    assert!(hits > 1000.0 && alarms + misses > 0.0, "{counts:?}");
    let assessment = output.assess(&Reference { clip: &clip, frame: 0 }).expect("frames");
    let wanted = [
        ("mask_precision", hits / (hits + alarms)),
        ("mask_recall", hits / (hits + misses)),
        ("mask_f1", 2.0 * hits / (2.0 * hits + alarms + misses)),
    ];
    for (key, wanted) in wanted {
        let score = assessment.scores.iter().find(|score| score.measure.key == key).expect("it is scored");
        assert_eq!(score.value.real(), Some(wanted), "{key}");
    }
    // The last step tells of the same figures.
    let mut walk = set("mixture-of-gaussians", &[]).walk(&clip, 0).expect("a run");
    walk.jump(Move::End);
    let told = walk.step(None).sentence.plain();
    assert!(told.contains(&format!("recall {:.2}", wanted[1].1)) && told.contains("true foreground"), "{told}");
}

#[test]
fn a_model_has_its_quantities_at_every_pixel() {
    let (clip, _) = Rough { size: (96, 72), frames: 12, seed: 505, ..Rough::default() }.clip();
    for (id, most) in [("single-gaussian", 1), ("mixture-of-gaussians", 3), ("median-background", 1)] {
        let mut walk = set(id, &[]).walk(&clip, 0).expect("a walk");
        walk.jump(Move::To(Cursor { unit: 9, event: 1 }));
        let before = walk.scene(None).layers;
        walk.jump(Move::To(Cursor { unit: 9, event: usize::MAX }));
        let after = walk.scene(None).layers;
        assert_eq!((before.len(), after.len()), (most, most), "{id}");
        for (before, after) in before.iter().zip(&after) {
            let [before_values, after_values] = [before, after].map(|layer| layer.values());
            assert_eq!(after_values.size(), (96, 72));
            let range = match after.quantity {
                Quantity::Deviation => 0.5..=80.0,
                Quantity::Weight => 0.0..=1.0,
                Quantity::Modes => 1.0..=8.0,
                Quantity::OffMedian => 0.0..=255.0,
                other => panic!("{id} has no {other:?}"),
            };
            let known = || after_values.cells().iter().filter(|value| value.is_finite());
            assert!(known().count() > 96 * 60, "{id}: {:?} is known", after.quantity);
            assert!(known().all(|value| range.contains(value)), "{id}: {:?}", after.quantity);
            assert!(before_values != after_values || after.quantity == Quantity::Modes, "the update changes them");
        }
    }
}

/// The plots of the pixel that is pointed at: its gray levels over the frames, and their distribution where there is a density.
fn pixel_plots(walk: &dyn Walk, place: [f32; 2]) -> Vec<Series> {
    let readouts = walk.step(Some(Focus::current(place))).readouts;
    let series = readouts.into_iter().filter_map(|readout| match readout {
        Readout::Series(series) => Some(series),
        _ => None,
    });
    series.filter(|series| series.title.ends_with(" of the pixel") || series.title == DISTRIBUTION).collect()
}

/// The title of a distribution.
const DISTRIBUTION: &str = "Distribution of its levels";

/// The level of a pixel in the channel that a plot shows.
fn level_in(title: &str, frame: &Frame, place: (usize, usize)) -> f32 {
    let names = ["Red", "Green", "Blue"];
    let channel = names.iter().position(|name| title.starts_with(name));
    f32::from(channel.map_or(frame.luma()[place], |channel| frame.color().expect("colours")[place][channel]))
}

#[test]
fn the_history_of_a_pixel_stands_beside_what_is_background() {
    let (clip, _) = Rough { size: (96, 72), frames: 30, seed: 606, shake: 0.0, ..Rough::default() }.clip();
    let still = [("camera", "still"), ("exposure", "ignored"), ("shake", "0")];
    for (id, has_density) in [
        ("running-average", false),
        ("median-background", false),
        ("single-gaussian", true),
        ("mixture-of-gaussians", true),
    ] {
        let mut walk = set(id, &still).walk(&clip, 0).expect("a walk");
        for (frame, (x, y)) in [(12, (30, 40)), (25, (60, 35)), (25, (10, 60))] {
            // Right after the threshold.
            walk.jump(Move::To(Cursor { unit: frame, event: 2 }));
            let plots = pixel_plots(walk.as_ref(), [x as f32, y as f32]);
            assert_eq!(plots.len(), 1 + usize::from(has_density), "{id}");
            assert_eq!(plots[0].title == "Gray level of the pixel", id == "mixture-of-gaussians", "{id}");
            let level = |t: usize| level_in(plots[0].title, &clip.frame(t).expect("a frame"), (x, y));
            let wanted: Vec<_> = (0..=frame).map(|t| [t as f32, level(t)]).collect();
            assert_eq!(plots[0].lines[0].2, wanted, "{id}");
            // The model of an earlier frame was another one.
            assert!(plots[0].bands.iter().all(|band| band.at == Some(frame as f32)), "{id}: {:?}", plots[0].bands);
            let level = level(frame);
            let mask = walk.scene(None).marks.iter().find_map(|mark| match &mark.shape {
                Shape::Mask(mask) => Some(mask.get(x, y)),
                _ => None,
            });
            // The modes of a mixture are of colours; these clips are gray.
            let is_within = plots[0].bands.iter().any(|band| (band.values[0]..=band.values[1]).contains(&level));
            assert_eq!(Some(!is_within), mask, "{id}: level {level} at ({x}, {y}), bands {:?}", plots[0].bands);
            for distribution in &plots[1..] {
                let shares: f32 = distribution.lines[0].2.iter().map(|[_, share]| share).sum();
                assert!((shares - 1.0).abs() < 1e-4, "{id}: {shares}");
            }
        }
    }
}

#[test]
fn the_history_shows_the_corrected_level_that_is_compared() {
    let texture = |x: usize, y: usize| (60 + (7 * x + 13 * y) % 90) as u8;
    let frame = |gain: u8| Frame::gray(Grid::from_fn(64, 48, |x, y| texture(x, y) + gain));
    let clip = Clip::from_frames("brighter", vec![frame(0), frame(0), frame(0), frame(25)]).expect("a clip");
    let mut walk = set("running-average", &[("camera", "still"), ("shake", "0")]).walk(&clip, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit: 3, event: usize::MAX }));
    let (place, plots) = ((20, 30), pixel_plots(walk.as_ref(), [20.0, 30.0]));
    let level = f32::from(texture(place.0, place.1));
    let [(_, _, seen), (name, _, compared)] = &plots[0].lines[..] else { panic!("{:?}", plots[0].lines) };
    assert_eq!((seen.last(), *name), (Some(&[3.0, level + 25.0]), "corrected for the exposure"));
    let [[at, corrected]] = compared[..] else { panic!("{compared:?}") };
    assert!(at == 3.0 && (corrected - level).abs() <= 1.0, "{corrected} beside {level}");
}
