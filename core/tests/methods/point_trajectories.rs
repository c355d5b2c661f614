//! Points that are carried along by dense flow, against exact motions and exact truth.

use crate::common::{set, waves};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::{Status, Track, TrackField};
use motionscope_core::run::Move;
use motionscope_core::scene::{Focus, Readout};
use motionscope_core::synth;

fn run(settings: &[(&str, &str)], clip: &Clip) -> TrackField {
    let output = set("point-trajectories", settings).run(clip, 0, &Threads::single()).expect("a run");
    output.get::<TrackField>().expect("tracks").clone()
}

/// Frames of waves; `source` says where a place of frame t was in the first frame.
fn moving_waves(frames: usize, source: impl Fn(usize, [f64; 2]) -> [f64; 2]) -> Clip {
    let frame = |t: usize| {
        Frame::gray(Grid::from_fn(128, 112, |x, y| {
            let [x, y] = source(t, [x as f64, y as f64]);
            (waves(x, y) + 0.5) as u8
        }))
    };
    Clip::from_frames("waves", (0..frames).map(frame).collect()).expect("frames of one size")
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Of the tracks that begin in the first frame and reach the last: mean and largest distance from `truth` there, and how
/// many there are.
fn errors(field: &TrackField, truth: impl Fn([f32; 2]) -> [f32; 2]) -> (f32, f32, usize) {
    let whole = field.tracks.iter().filter(|track| track.first == 0 && track.at(field.last).is_some());
    let ends = whole.map(|track: &std::sync::Arc<Track>| (track.points[0].at, track.points[field.last].at));
    let off: Vec<f32> = ends.map(|(start, end)| distance(end, truth(start))).collect();
    (off.iter().sum::<f32>() / off.len() as f32, off.iter().copied().fold(0.0, f32::max), off.len())
}

#[test]
fn a_drift_that_is_known_is_gone_along() {
    const FRAMES: usize = 13;
    let (u, v) = (0.7, -0.4);
    let clip = moving_waves(FRAMES, |t, [x, y]| [x - u * t as f64, y - v * t as f64]);
    let way = [u, v].map(|c| c as f32 * (FRAMES - 1) as f32);
    for (method, mean_px) in [("farneback", 0.1), ("horn-schunck", 0.1), ("tv-l1", 0.1)] {
        let field = run(&[("method", method)], &clip);
        let (mean, largest, count) = errors(&field, |[x, y]| [x + way[0], y + way[1]]);
        assert!(count > 90, "{method}: only {count} points");
        assert!(mean < mean_px && largest < 1.0, "{method}: {mean} px off on average, at most {largest}");
    }
}

#[test]
fn a_turn_that_is_known_is_gone_along() {
    const FRAMES: usize = 16;
    let turned = |[x, y]: [f64; 2], degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (x, y) = (x - 63.5, y - 55.5);
        [cos * x - sin * y + 63.5, sin * x + cos * y + 55.5]
    };
    let clip = moving_waves(FRAMES, |t, place| turned(place, -2.0 * t as f64));
    let truth = |at: [f32; 2]| turned(at.map(f64::from), 2.0 * (FRAMES - 1) as f64).map(|c| c as f32);
    // To Farnebäck's method a neighbourhood that turns looks like one that is shifted as well.
    for (method, mean_px) in [("farneback", 2.0), ("horn-schunck", 0.15), ("tv-l1", 0.6)] {
        let field = run(&[("method", method)], &clip);
        let (mean, largest, count) = errors(&field, truth);
        assert!(count > 60, "{method}: only {count} points");
        assert!(mean < mean_px && largest < 4.0, "{method}: {mean} px off on average, at most {largest}");
    }
}

#[test]
fn points_that_get_hidden_are_lost_and_new_ones_begin_behind() {
    const FRAMES: usize = 12;
    let left = |t: usize| 20.0 + 4.0 * t as f64;
    let is_in = |t: usize, [x, y]: [f64; 2]| (left(t)..left(t) + 36.0).contains(&x) && (30.0..80.0).contains(&y);
    let frame = |t: usize| {
        Frame::gray(Grid::from_fn(128, 112, |x, y| {
            let [x, y] = [x as f64, y as f64];
            let value =
                if is_in(t, [x, y]) { 0.4 * waves(x - left(t) + 300.0, y + 200.0) + 120.0 } else { waves(x, y) };
            value as u8
        }))
    };
    let clip = Clip::from_frames("hidden", (0..FRAMES).map(frame).collect()).expect("frames of one size");
    let field = run(&[("spacing", "5")], &clip);
    let place = |at: [f32; 2]| at.map(f64::from);
    // Well inside the way of the square, and hidden long before the end.
    let hidden = |track: &&std::sync::Arc<Track>| {
        let [x, y] = place(track.points[0].at);
        track.first == 0 && (65.0..85.0).contains(&x) && (38.0..72.0).contains(&y)
    };
    let (mut all, mut kept) = (0, 0);
    for track in field.tracks.iter().filter(hidden) {
        all += 1;
        kept += usize::from(track.points.len() == FRAMES && track.points[FRAMES - 1].status == Status::Found);
    }
    assert!(all > 20 && 10 * kept <= all, "{kept} of {all} hidden points are still there");
    // What comes out behind the square gets points of its own.
    let uncovered = field.tracks.iter().filter(|track| {
        let [x, y] = place(track.points[0].at);
        track.first > 4 && (22.0..40.0).contains(&x) && (38.0..72.0).contains(&y)
    });
    assert!(uncovered.count() > 8);
    // Of those on the square most go with it.
    let on_square = field.tracks.iter().filter(|track| {
        let [x, y] = place(track.points[0].at);
        track.first == 0 && (28.0..48.0).contains(&x) && (38.0..72.0).contains(&y)
    });
    let (mut all, mut with_it) = (0, 0);
    for track in on_square {
        all += 1;
        let [x, y] = track.points[0].at;
        let there = [x + 4.0 * (FRAMES - 1) as f32, y];
        with_it += usize::from(track.at(FRAMES - 1).is_some_and(|point| distance(point.at, there) < 1.0));
    }
    assert!(all > 20 && 10 * with_it >= 8 * all, "{with_it} of {all} go with the square");
}

#[test]
fn no_point_begins_where_there_is_no_structure() {
    let frame =
        |_| Frame::gray(Grid::from_fn(128, 112, |x, y| if x < 64 { 90 } else { waves(x as f64, y as f64) as u8 }));
    let clip = Clip::from_frames("half", (0..3).map(frame).collect()).expect("frames of one size");
    let field = run(&[], &clip);
    let starts: Vec<_> = field.tracks.iter().map(|track| track.points[0].at).collect();
    // A window reaches 7 px over the border.
    assert!(starts.iter().all(|[x, _]| *x >= 56.0) && starts.len() > 50, "{starts:?}");
}

/// The last values of the lines of a series.
fn ends(readouts: &[Readout], title: &str) -> Vec<(&'static str, f32)> {
    let series = readouts.iter().find_map(|readout| match readout {
        Readout::Series(series) if series.title == title => Some(series),
        _ => None,
    });
    let lines = &series.expect("it is plotted").lines;
    lines.iter().map(|(name, _, line)| (*name, line.last().expect("a value")[1])).collect()
}

#[test]
fn what_is_reported_the_errors_is_what_the_truth_says() {
    let scene = synth::scene("spin-zoom").expect("it is bundled");
    let clip = synth::make("spin-zoom", &scene.difficulty()).expect("a clip");
    let estimator = set("point-trajectories", &[("frames", "9"), ("replenish", "off"), ("spacing", "16")]);
    let mut walk = estimator.walk(&clip, 0).expect("a run");
    walk.jump(Move::End);
    let output = walk.output();
    let field = output.get::<TrackField>().expect("tracks");
    let truth = clip.truth().expect("exact");
    // Each point goes along the true flow, as long as it can be seen.
    let true_end = |start: [f32; 2]| {
        (0..field.last).try_fold(start, |at, t| {
            let [x, y] = at.map(|c| c.round() as usize);
            let is_hidden = truth.occlusion(t).expect("readable").is_some_and(|hidden| hidden.get(x, y) == Some(&true));
            let uv = truth.flow(t).expect("readable").filter(|_| !is_hidden)?.sample(at)?;
            Some([at[0] + uv[0], at[1] + uv[1]])
        })
    };
    let off =
        field.tracks.iter().filter_map(|track| Some(distance(track.at(field.last)?.at, true_end(track.points[0].at)?)));
    let off: Vec<f32> = off.collect();
    let mean = off.iter().sum::<f32>() / off.len() as f32;
    let told = ends(&walk.step(None).readouts, "Mean distance from the true position");
    assert!(off.len() > 100 && (told[0].1 - mean).abs() < 1e-3, "{told:?}, not {mean}");
    // Windows that turn and grow are followed by a shift alone: that drifts more.
    assert!(told[0].1 < 0.4 && told[1].1 > told[0].1, "{told:?}");
    let apart = ends(&walk.step(None).readouts, "Mean drift");
    assert!(apart[0].1 > 0.1 && apart[0].1 < told[0].1 + told[1].1 + 0.1, "{apart:?} apart, {told:?} off");
}

#[test]
fn the_point_that_is_pointed_at_is_reported() {
    let clip = moving_waves(3, |t, [x, y]| [x - t as f64, y]);
    let estimator = set("point-trajectories", &[]);
    let mut walk = estimator.walk(&clip, 0).expect("a run");
    walk.jump(Move::End);
    let output = walk.output();
    let nearest = output
        .get::<TrackField>()
        .expect("tracks")
        .tracks
        .iter()
        .position(|track| track.at(1).is_some_and(|point| distance(point.at, [66.0, 55.0]) < 0.2));
    let step = walk.step(Some(Focus::current([67.0, 54.0])));
    let sentence = step.sentence.plain();
    let name = format!("Point {} is advected to (6", nearest.expect("one on the grid") + 1);
    assert!(sentence.starts_with(&name) && sentence.contains("Drift between both"), "{sentence}, not {name}");
    let has_tiles = step.readouts.iter().any(|readout| matches!(readout, Readout::Tiles(tiles) if tiles.len() == 3));
    assert!(has_tiles && walk.scene(None).marks.iter().all(|mark| mark.shape.is_finite()));
}
