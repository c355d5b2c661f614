//! The tracker from frame to frame, against exact truth.

use std::sync::Arc;

use motionscope_core::base::{Error, Stop, Threads};
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, ClipInfo, Frame, FrameSource};
use motionscope_core::geometry::Grid;
use motionscope_core::products::{Status, TrackField};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move};
use motionscope_core::scene::{self, Role};

const SIZE: (usize, usize) = (120, 90);

/// Waves in all directions that do not repeat nearby.
fn waves(x: f64, y: f64) -> f64 {
    let wave = |k: f64| {
        let (period, angle) = (9.0 + 1.3 * k, k * std::f64::consts::PI / 8.0);
        ((x * angle.cos() + y * angle.sin()) * std::f64::consts::TAU / period + k * k).sin()
    };
    128.0 + 15.0 * (0..8).map(|k| wave(f64::from(k))).sum::<f64>()
}

/// Frames in which the waves are seen through `back`: where pixel (x, y) of frame t was in frame 0.
fn clip(frames: usize, back: impl Fn(f64, [f64; 2]) -> [f64; 2]) -> Clip {
    let frame = |t: usize| {
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let [x, y] = back(t as f64, [x as f64, y as f64]);
            (waves(x, y) + 0.5) as u8
        }))
    };
    Clip::from_frames("waves", (0..frames).map(frame).collect()).expect("frames of one size")
}

fn klt(settings: &[(&str, &str)]) -> Box<dyn AnyEstimator> {
    let mut klt = estimator("klt").expect("it is there");
    settings.iter().for_each(|(name, value)| klt.set(name, value).expect("in range"));
    klt
}

fn tracks(settings: &[(&str, &str)], clip: &Clip) -> TrackField {
    let output = klt(settings).run(clip, 0, &Threads::single()).expect("a run");
    output.get::<TrackField>().expect("tracks").clone()
}

#[test]
fn features_stay_on_what_moves_turns_and_grows() {
    let (cx, cy) = (60.0, 45.0);
    let spin = |t: f64, [x, y]: [f64; 2]| {
        // Each frame turned by 1.5° and larger by 1 % than the one before, and moved.
        let (angle, size) = (-0.026 * t, 1.01f64.powf(-t));
        let [i, j] = [x - cx - 0.8 * t, y - cy + 0.5 * t];
        [cx + size * (angle.cos() * i - angle.sin() * j), cy + size * (angle.sin() * i + angle.cos() * j)]
    };
    let field = tracks(&[("frames", "12"), ("max-points", "60")], &clip(12, spin));
    assert_eq!(field.frames(), 0..11);
    let (mut whole, mut sum) = (0, 0.0);
    for track in field.tracks.iter().filter(|track| track.first == 0 && track.is_alive()) {
        assert_eq!(track.points.len(), 12);
        let was = spin(0.0, track.points[0].at.map(f64::from));
        let last = spin(11.0, track.points[11].at.map(f64::from));
        let off = (last[0] - was[0]).hypot(last[1] - was[1]);
        // A window that turns and grows has no single displacement: its pixels differ by up to 0.2 px a frame from its middle.
        assert!(off < 11.0 * 0.2, "{off} px astray after 11 frames, from {:?}", track.points[0].at);
        sum += off;
        whole += 1;
    }
    assert!(whole > 20, "only {whole} features were seen in all frames");
    assert!(sum / f64::from(whole) < 1.0, "{} px astray on average", sum / f64::from(whole));
}

#[test]
fn a_track_goes_from_place_to_place() {
    let field = tracks(&[("frames", "6")], &clip(6, |t, [x, y]| [x - 1.3 * t, y + 0.7 * t]));
    for track in &field.tracks {
        let ([from, to], steps) =
            ([0, track.points.len() - 1].map(|i| track.points[i].at), track.points.len() as f32 - 1.0);
        let off = (to[0] - from[0] - 1.3 * steps).hypot(to[1] - from[1] + 0.7 * steps);
        assert!(off < 0.15, "{off} px astray after {steps} frames");
        for pair in track.points.windows(2) {
            let [u, v] = pair[0].displacement.expect("only the last may be lost");
            assert_eq!((pair[0].status, pair[1].at), (Status::Tracked, [pair[0].at[0] + u, pair[0].at[1] + v]));
        }
        let last = track.points.last().expect("at least one");
        assert!(last.displacement.is_none() && last.status != Status::Tracked);
        assert_eq!(track.is_alive(), track.first + track.points.len() == 6, "what is not lost comes to the end");
    }
    let at = field.at(2);
    assert_eq!(at.points.len(), field.tracks.iter().filter(|track| track.at(2).is_some()).count());
}

#[test]
fn what_is_lost_is_replaced_if_that_is_asked_for() {
    // All goes to the right by 9 px a frame: in five frames a third has left.
    let clip = clip(5, |t, [x, y]| [x - 9.0 * t, y]);
    let alive = |field: &TrackField| field.tracks.iter().filter(|track| track.is_alive()).count();
    let settings = [("max-points", "40"), ("max-dissimilarity", "0")];
    let [with, without] = ["on", "off"].map(|on| tracks(&[&settings[..], &[("replenish", on)]].concat(), &clip));
    assert!(without.tracks.iter().all(|track| track.first == 0) && without.tracks.len() == 40);
    assert!(alive(&without) < 38, "{} are left", alive(&without));
    assert!(with.tracks.iter().any(|track| track.first == 3) && with.tracks.len() > 40);
    for t in 0..4 {
        let points = with.at(t).points;
        assert!(points.len() <= 40);
        let began = with.tracks.iter().filter(|track| track.first == t).map(|track| track.points[0].at);
        for new in began {
            let near = |at: [f32; 2]| (at[0] - new[0]).hypot(at[1] - new[1]);
            let nearest = points.iter().map(|p| near(p.at)).filter(|far| *far > 0.0).fold(f32::MAX, f32::min);
            assert!(nearest > 6.0, "a new feature {nearest} px from another");
        }
    }
}

#[test]
fn what_looks_different_from_its_first_view_is_lost() {
    // The picture fades into another, so slowly that no two frames differ much.
    let frame = |t: usize| {
        let share = t as f64 / 12.0;
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (x, y) = (x as f64, y as f64);
            ((1.0 - share) * waves(x, y) + share * waves(y + 311.0, 200.0 - x)) as u8
        }))
    };
    let clip = Clip::from_frames("fade", (0..13).map(frame).collect()).expect("frames of one size");
    let statuses = |settings: &[(&str, &str)]| -> Vec<Status> {
        let field = tracks(&[settings, &[("replenish", "off"), ("frames", "13")]].concat(), &clip);
        field.tracks.iter().filter_map(|track| Some(track.points.last()?.status)).collect()
    };
    let changed = |statuses: &[Status]| statuses.iter().filter(|status| **status == Status::Changed).count();
    // A few windows of the other picture resemble the first view by chance.
    let checked = statuses(&[]);
    assert!(changed(&checked) * 10 > checked.len() * 6, "{} of {}: {checked:?}", changed(&checked), checked.len());
    let strict = statuses(&[("min-correlation", "1")]);
    assert!(changed(&strict) * 10 > strict.len() * 9, "{} of {}: {strict:?}", changed(&strict), strict.len());
    assert_eq!(changed(&statuses(&[("max-dissimilarity", "0")])), 0);
}

#[test]
fn what_does_not_come_back_is_lost() {
    // The right half of the second frame is another picture.
    let frame = |t: usize| {
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let other = t == 1 && x > 60;
            (if other { waves(y as f64 + 311.0, 200.0 - x as f64) } else { waves(x as f64, y as f64) }) as u8
        }))
    };
    let clip = Clip::from_frames("halves", vec![frame(0), frame(1)]).expect("frames of one size");
    let settings = [("max-residual", "255"), ("max-dissimilarity", "0"), ("max-points", "80")];
    let [checked, not] = ["1", "0"].map(|most| tracks(&[&settings[..], &[("max-fb-error", most)]].concat(), &clip));
    let wrong = |field: &TrackField| {
        let of_right = field.tracks.iter().filter(|track| track.points[0].at[0] > 68.0);
        of_right.filter(|track| track.is_alive()).count()
    };
    let right = checked.tracks.iter().filter(|track| track.points[0].at[0] < 50.0);
    assert!(right.clone().count() > 15 && right.clone().all(|track| track.is_alive()));
    assert!(wrong(&checked) * 4 < wrong(&not), "{} of {}", wrong(&checked), wrong(&not));
    assert!(checked.tracks.iter().any(|track| track.points[0].status == Status::Astray));
}

#[test]
fn every_step_of_a_feature_is_reported() {
    let clip = clip(3, |t, [x, y]| [x - 1.3 * t, y + 0.7 * t]);
    let mut walk = klt(&[("max-points", "12"), ("levels", "2")]).walk(&clip, 0).expect("a walk");
    assert_eq!(walk.at_frame(), 0);
    let mut lines = Vec::new();
    while walk.cursor().unit < 2 {
        lines.push(walk.step(None).line.as_str());
        walk.jump(Move::Granularity(3, Direction::Forward));
    }
    let expected = ["detect", "take-strongest", "track", "track-back", "fit-first-view", "move"];
    for line in expected {
        assert!(lines.contains(&line), "line {line} is never lit: {lines:?}");
    }
    // The end of the first pair, and the next one after it.
    walk.jump(Move::Granularity(1, Direction::Forward));
    assert_eq!((walk.at_frame(), walk.cursor().unit), (0, 12));
    walk.jump(Move::Granularity(3, Direction::Forward));
    assert_eq!(walk.at_frame(), 1);
    walk.jump(Move::To(Cursor { unit: 15, event: usize::MAX }));
    let trails = walk.scene(None);
    let count = trails.marks.iter().filter(|mark| mark.role == Role::Estimate).count();
    assert!(count >= 10, "{count} trails");
    assert!(trails.marks.iter().any(|mark| matches!(mark.shape, scene::Shape::Arrows(_))));
    walk.jump(Move::End);
    assert_eq!(walk.at_frame(), 1);
}

#[test]
fn a_clip_without_features_is_gone_through() {
    let flat = || Frame::gray(Grid::new(40, 30, 90));
    let clip = Clip::from_frames("flat", vec![flat(), flat(), flat()]).expect("frames");
    assert!(tracks(&[], &clip).tracks.is_empty());
    let mut walk = klt(&[]).walk(&clip, 0).expect("a walk");
    walk.jump(Move::End);
    assert_eq!((walk.cursor().unit, walk.at_frame()), (1, 1), "one look at each pair");
}

/// Four frames of waves that move, of which nobody knows how many there are; the last may be damaged.
struct Stream {
    frames: Clip,
    is_damaged: bool,
}

impl FrameSource for Stream {
    fn frame(&self, index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        if self.is_damaged && index == 3 {
            return Err(Error::new("frame 3 of waves cannot be shown: its data are damaged"));
        }
        self.frames.frame(index)
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }

    fn has_frame(&self, index: usize, stop: &Stop) -> Result<bool, Error> {
        if index < 4 { self.frame(index, stop).map(|_| true) } else { Ok(false) }
    }
}

#[test]
fn a_damaged_frame_is_reported_and_the_end_of_a_clip_is_none() {
    let stream = |is_damaged| {
        let frames = clip(4, |t, [x, y]| [x - 1.3 * t, y + 0.7 * t]);
        let info = ClipInfo { frames: None, ..frames.info().clone() };
        Clip::new(info, Arc::new(Stream { frames, is_damaged }))
    };
    let settings = [("max-points", "12"), ("levels", "2")];
    let [whole, damaged] = [false, true].map(|is_damaged| {
        let mut walk = klt(&settings).walk(&stream(is_damaged), 0).expect("a walk");
        walk.jump(Move::End);
        walk
    });
    assert_eq!((whole.failure(), whole.at_frame()), (None, 2));
    let told = damaged.failure().expect("the damage").to_string();
    assert!(told.contains("frame 3 of waves"), "{told}");
    // What was done stays: two pairs with all their features.
    let Some(field) = damaged.output().get::<TrackField>().cloned() else { panic!("tracks") };
    assert_eq!((damaged.at_frame(), field.last), (1, 2));
    assert!(field.tracks.iter().any(|track| track.points.len() == 3 && track.is_alive()));
    let run = |is_damaged| klt(&settings).run(&stream(is_damaged), 0, &Threads::single());
    assert!(run(false).is_ok() && run(true).is_err_and(|error| error.to_string().contains("frame 3")));
}

#[test]
fn features_are_kept_where_the_light_changes() {
    // What moves gets darker and paler from frame to frame, or does not.
    let moving = |fades: f64| {
        let frame = |t: usize| {
            let (gain, offset) = (1.0 - 0.05 * fades * t as f64, 4.0 * fades * t as f64);
            Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
                (gain * waves(x as f64 - 1.3 * t as f64, y as f64 + 0.7 * t as f64) + offset + 0.5) as u8
            }))
        };
        Clip::from_frames("dusk", (0..9).map(frame).collect()).expect("frames of one size")
    };
    let lost = |illumination: &str, fades: f64| {
        let settings = [("illumination", illumination), ("replenish", "off"), ("max-points", "60")];
        let field = tracks(&settings, &moving(fades));
        let last = field.tracks.iter().filter_map(|track| track.points.last());
        last.filter(|point| point.status == Status::Changed).count()
    };
    assert_eq!([lost("on", 0.0), lost("off", 0.0)], [0, 0], "nothing changes");
    let [with, without] = ["on", "off"].map(|illumination| lost(illumination, 1.0));
    // Tracking from frame to frame takes fading for motion: a few drift off, and are rightly lost.
    assert!(without > 30 && 10 * with < without, "{with} with any light, {without} without");
}

#[test]
fn what_deforms_is_kept_and_what_is_covered_is_lost() {
    // Cloth: the pattern sways by waves that no affine map of a window describes, and nothing comes into it.
    let cloth = clip(16, |t, [x, y]| {
        let sway = (t / 15.0) * 2.5;
        [x - 0.4 * t + sway * (0.55 * y).sin(), y + sway * (0.6 * x).sin()]
    });
    // A plate with a pattern of its own slides over the left half.
    let covered = |t: usize| {
        let edge = 4.0 * t as f64;
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (x, y) = (x as f64, y as f64);
            (if x < edge { waves(y + 311.0, 200.0 - x + edge) } else { waves(x, y) } + 0.5) as u8
        }))
    };
    let covered = Clip::from_frames("cover", (0..16).map(covered).collect()).expect("frames of one size");
    let field = |clip: &Clip, correlation: &str| {
        let settings = [("frames", "16"), ("replenish", "off"), ("min-correlation", correlation), ("max-points", "80")];
        tracks(&settings, clip)
    };
    let alive = |field: &TrackField| field.tracks.iter().filter(|track| track.is_alive()).count();
    let [strict, kept] = ["1", "0.5"].map(|correlation| field(&cloth, correlation));
    assert!(alive(&kept) >= 2 * alive(&strict) && alive(&kept) > 40, "{} kept, {}", alive(&kept), alive(&strict));
    // Covered in the last frame: left of 60 px, by a window and more.
    let field = field(&covered, "0.5");
    let hidden = field.tracks.iter().filter(|track| track.points[0].at[0] < 45.0);
    let (all, left) = (hidden.clone().count(), hidden.filter(|track| track.is_alive()).count());
    assert!(all > 15 && 10 * left <= all, "{left} of {all} covered features are left");
}
