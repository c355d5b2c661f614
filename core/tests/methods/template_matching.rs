//! Template matching against plain sums over every window, on known motion, and on input that does not suit it.

use crate::common::{fact, moving, set, waves};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::{Status, Track, TrackField};
use motionscope_core::run::{AnyEstimator, Cursor, Move};
use motionscope_core::scene::Readout;
use motionscope_core::synth;

fn track(estimator: &dyn AnyEstimator, clip: &Clip) -> Track {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    (*output.get::<TrackField>().expect("a track").tracks[0]).clone()
}

/// Frames of waves that move by `(u, v)` px/frame.
fn drifting((u, v): (f64, f64), frames: usize) -> Clip {
    let value = |t: usize, x: usize, y: usize| waves(x as f64 - u * t as f64, y as f64 - v * t as f64) + 0.5;
    let frame = |t| Frame::gray(Grid::from_fn(96, 80, |x, y| value(t, x, y) as u8));
    Clip::from_frames("waves", (0..frames).map(frame).collect()).expect("frames of one size")
}

/// The cost of every displacement, as in a textbook: `None` where the window leaves the picture.
fn plain(score: &str, [a, b]: [&Grid<u8>; 2], (x, y, side): (usize, usize, usize), [u, v]: [i32; 2]) -> Option<f64> {
    let (mut templates, mut windows) = (Vec::new(), Vec::new());
    for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
        let [s, t] = [(x + i) as i32 + u, (y + j) as i32 + v];
        templates.push(f64::from(a[(x + i, y + j)]));
        windows.push(f64::from(*b.get(usize::try_from(s).ok()?, usize::try_from(t).ok()?)?));
    }
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let off_mean = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| value - mean).collect()
    };
    let correlation = |a: &[f64], b: &[f64]| 1.0 - product(a, b) / (product(a, a) * product(b, b)).sqrt();
    Some(match score {
        "ssd" => templates.iter().zip(&windows).map(|(a, b)| (a - b).powi(2)).sum(),
        "sad" => templates.iter().zip(&windows).map(|(a, b)| (a - b).abs()).sum(),
        "ncc" => correlation(&templates, &windows),
        _ => correlation(&off_mean(&templates), &off_mean(&windows)),
    })
}

#[test]
fn every_score_is_that_of_the_textbook_whatever_computes_it() {
    let clip = moving(|[x, y]| [x - 3.0, y + 2.0]);
    let pair = clip.pair(0).expect("a pair");
    for score in ["ssd", "sad", "ncc", "zncc"] {
        for method in ["direct", "fft", "auto"] {
            let settings =
                [("score", score), ("method", method), ("template", "30,25,45.5,40.5"), ("search-range", "40")];
            let matching = set("template-matching", &settings);
            let mut walk = matching.walk(&clip, 0).expect("a walk");
            walk.jump(Move::To(Cursor { unit: 66, event: 1 }));
            let surface = walk.step(None).readouts.into_iter().find_map(|readout| match readout {
                Readout::Surface(surface) => Some(surface),
                _ => None,
            });
            let surface = surface.expect("a surface");
            assert_eq!((surface.origin, surface.values.size()), ([-30, -25], (71, 65)), "{score}");
            for (x, y) in (0..65).flat_map(|y| (0..71).map(move |x| (x, y))) {
                let at = [surface.origin[0] + x as i32, surface.origin[1] + y as i32];
                let expected = plain(score, [pair[0].luma(), pair[1].luma()], (30, 25, 16), at).expect("inside");
                let off = (f64::from(surface.values[(x, y)]) - expected).abs();
                assert!(off <= 1e-6 * (1.0 + expected), "{score} by {method} at {at:?}: off by {off}");
            }
            assert_eq!(surface.best, Some([3, -2]), "{score} by {method}");
        }
    }
}

#[test]
fn both_ways_give_the_same_track() {
    let clip = drifting((1.3, -0.6), 5);
    for score in ["ssd", "ncc", "zncc"] {
        let of = |method| track(&*set("template-matching", &[("score", score), ("method", method)]), &clip);
        assert_eq!(of("direct"), of("fft"), "{score}");
    }
}

#[test]
fn fractions_of_a_pixel_are_found_and_add_up_only_with_updates() {
    let clip = drifting((1.3, -0.6), 8);
    for update in ["fixed", "every-frame"] {
        for score in ["ssd", "sad", "ncc", "zncc"] {
            let track =
                track(&*set("template-matching", &[("score", score), ("update", update), ("size", "24")]), &clip);
            assert_eq!(track.points.len(), 8, "{score}, {update}");
            let (first, last) = (track.points[0].at, track.points[7].at);
            let off = (last[0] - first[0] - 7.0 * 1.3).hypot(last[1] - first[1] + 7.0 * 0.6);
            let most = if update == "fixed" { 0.12 } else { 1.0 };
            assert!(off < most, "{score}, {update}: {off} px off");
        }
    }
}

#[test]
fn the_truth_of_bundled_clips_is_met() {
    for (scene, most) in [("translation", 0.15), ("sub-pixel", 0.15)] {
        let scene = synth::scene(scene).expect("a scene");
        let mut difficulty = scene.difficulty();
        difficulty.set("frames", "3").expect("all have it");
        let clip = synth::make(scene.id, &difficulty).expect("a clip");
        let track = track(&*estimator("template-matching").expect("it is there"), &clip);
        let point = track.points[0];
        let truth = clip.truth().expect("a truth").flow(0).expect("readable").expect("known").sample(point.at);
        let ([u, v], truth) = (point.displacement.expect("tracked"), truth.expect("known"));
        let off = (u - truth[0]).hypot(v - truth[1]);
        assert!(off < most, "{}: {off} px off", scene.id);
    }
}

#[test]
fn peaks_of_texture_that_repeats_are_ambiguous() {
    let periodic = |x: usize, y: usize| {
        (128.0
            + 50.0 * ((x as f64 * std::f64::consts::FRAC_PI_4).sin() + (y as f64 * std::f64::consts::FRAC_PI_4).cos()))
            as u8
    };
    let clip = Clip::from_frames("wallpaper", vec![Frame::gray(Grid::from_fn(96, 80, periodic)); 2]).expect("frames");
    let told = |clip: &Clip| {
        let mut walk = set("template-matching", &[("size", "16")]).walk(clip, 0).expect("a walk");
        let rows = walk.place()[2].of.expect("it is known");
        walk.jump(Move::To(Cursor { unit: rows - 1, event: 3 }));
        let step = walk.step(None);
        (step.sentence.plain(), fact(&step, "Peak ratio"))
    };
    let (sentence, ratio) = told(&clip);
    assert!(sentence.contains("ambiguous") && ratio.as_deref() == Some("1.00"), "{sentence} {ratio:?}");
    let (sentence, _) = told(&moving(|[x, y]| [x - 3.0, y + 2.0]));
    assert!(sentence.contains("distinct"), "{sentence}");
}

#[test]
fn without_texture_the_run_ends_and_says_why() {
    let clip = Clip::from_frames("flat", vec![Frame::gray(Grid::new(60, 40, 77)); 3]).expect("frames");
    let matching = estimator("template-matching").expect("it is there");
    let mut walk = matching.walk(&clip, 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("0.00 gray levels is below 1.00"), "{said}");
    assert!(said.contains("no texture near its middle") && !said.contains("in all directions"), "{said}");
    assert_eq!(track(&*matching, &clip).points[0].status, Status::Flat);
}

#[test]
fn a_template_that_reaches_outside_the_picture_is_said_to_be_clipped() {
    let clip = drifting((-1.0, 0.0), 3);
    let said = |zone: &'static str| {
        let mut walk = set("template-matching", &[("template", zone)]).walk(&clip, 0).expect("a walk");
        let first = walk.step(None).sentence.plain();
        walk.jump(Move::End);
        [first, walk.step(None).sentence.plain()]
    };
    let clipped = "The rectangle of 40×20 px reaches outside the picture, so the template is clipped to 26×20 px.";
    assert!(said("70,30,110,50").iter().all(|said| said.contains(clipped)), "{:?}", said("70,30,110,50"));
    assert!(said("30,30,60,50").iter().all(|said| !said.contains("clipped")));
}

#[test]
fn a_peak_at_the_limit_of_the_search_area_is_a_warning() {
    let clip = drifting((3.0, 0.0), 3);
    let said = |range: &'static str| {
        let settings = [("template", "30,30,50,50"), ("search-range", range), ("min-zncc", "0")];
        let mut walk = set("template-matching", &settings).walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    let warning = "the peak lies at the limit of the search area (±2 px)";
    assert!(said("2").contains(warning), "{}", said("2"));
    assert!(!said("8").contains("at the limit"), "{}", said("8"));
}

#[test]
fn a_template_that_does_not_fit_is_refused_with_its_size() {
    let clip = moving(|place| place);
    for (zone, size) in [("200,10,240,50", "0×40 px"), ("-30,-30,1,70", "1×70 px"), ("10,10,12.5,30", "3×20 px")] {
        let error = set("template-matching", &[("template", zone)]).walk(&clip, 0).err().expect("refused").to_string();
        assert!(error.contains(size) && error.contains("96×80 px") && error.contains("4 to 256 px"), "{error}");
    }
    let small = Clip::from_frames("small", vec![Frame::gray(Grid::new(7, 40, 77)); 2]).expect("frames");
    let error =
        estimator("template-matching").expect("it is there").walk(&small, 0).err().expect("refused").to_string();
    assert!(error.contains("7×40 px is too small"), "{error}");
}

#[test]
fn a_template_over_the_border_is_cut_and_says_so() {
    let clip = moving(|place| place);
    let told = |zone| {
        let mut walk = set("template-matching", &[("template", zone)]).walk(&clip, 0).expect("a walk");
        walk.jump(Move::To(Cursor { unit: 0, event: 1 }));
        walk.step(None).sentence.plain()
    };
    let said = told("-10,5,20,20");
    assert!(
        said.contains("rectangle of 30×15 px reaches outside the picture, so the template is clipped to 20×15 px"),
        "{said}"
    );
    let said = told("10,5,30,20");
    assert!(said.contains("first frame of the run") && !said.contains("clipped"), "{said}");
}

#[test]
fn another_picture_loses_the_template() {
    let noise = |x: usize, y: usize| {
        let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B);
        (h.wrapping_mul(0xC2B2_AE35) >> 24) as u8
    };
    let before = Frame::gray(Grid::from_fn(96, 80, |x, y| waves(x as f64, y as f64) as u8));
    let after = Frame::gray(Grid::from_fn(96, 80, noise));
    let clip = Clip::from_frames("cut", vec![before.clone(), before, after.clone(), after]).expect("frames");
    let track = track(&*estimator("template-matching").expect("it is there"), &clip);
    assert_eq!((track.points.len(), track.points[1].status), (2, Status::Unlike));
}

#[test]
fn a_drift_at_the_border_of_its_search_is_at_least_that() {
    let random = |k: u64, i: usize, j: usize| {
        let mixed = (k * 0x9E37_79B9) ^ (i as u64 * 0x85EB_CA6B) ^ (j as u64 * 0xC2B2_AE35);
        60.0 + f64::from((mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 57) as u8)
    };
    // The patch changes its appearance; its first one is beside it, beyond the reach of the tracker.
    let told = |beside: usize| {
        let frame = |t: usize| {
            Frame::gray(Grid::from_fn(96, 80, |x, y| {
                let share = 0.15 * t as f64;
                let (i, j) = (x.wrapping_sub(40), y.wrapping_sub(36));
                if j >= 8 {
                    return 120;
                }
                if i < 8 {
                    return ((1.0 - share) * random(1, i, j) + share * random(2, i, j)) as u8;
                }
                if t > 0 && (beside..beside + 8).contains(&i) { random(1, i - beside, j) as u8 } else { 120 }
            }))
        };
        let clip = Clip::from_frames("morph", (0..4).map(frame).collect()).expect("frames of one size");
        let settings = [("template", "40,36,48,44"), ("search-range", "4"), ("update", "every-frame")];
        let mut walk = set("template-matching", &settings).walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    let said = told(12);
    assert!(said.contains("The final drift from the first template is at least 12 px"), "{said}");
    let said = told(10);
    assert!(said.contains("The final drift from the first template is") && !said.contains("at least"), "{said}");
}
