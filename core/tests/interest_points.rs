//! Detectors of interest points against plain references, against OpenCV's figures, and under rotation and gain.

mod common;

use common::set;
use motionscope_core::{
    AnyEstimator, Clip, Cursor, Descriptor, Direction, Frame, Gray, Grid, Keypoint, Move, PointField, Threads,
    scene::{Focus, Readout},
};

/// A texture of small blocks, each of one gray level, smoothed over 2×2 px.
fn blocks(width: usize, height: usize) -> Gray {
    let hash = |x: usize, y: usize| {
        let mixed = ((x as u64 / 5) * 0x9E37_79B9) ^ ((y as u64 / 4) * 0x85EB_CA6B);
        (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) & 255
    };
    Grid::from_fn(width, height, |x, y| ((hash(x, y) + hash(x + 1, y) + hash(x, y + 1) + hash(x + 1, y + 1)) / 4) as u8)
}

fn clip_of(picture: Gray) -> Clip {
    Clip::from_frames("made", vec![Frame::gray(picture)]).expect("a frame")
}

fn found(estimator: &dyn AnyEstimator, picture: &Gray) -> PointField {
    let output = estimator.run(&clip_of(picture.clone()), 0, &Threads::single()).expect("a run");
    output.get::<PointField>().expect("keypoints").clone()
}

/// Everything that the detector finds: no limit of distance or number.
const ALL: [(&str, &str); 2] = [("min-distance", "0"), ("max-points", "100000")];

fn fast(threshold: usize, arc: usize, picture: &Gray) -> Vec<(usize, usize, u8)> {
    let (threshold, arc) = (threshold.to_string(), arc.to_string());
    let estimator = set("fast", &[&ALL[..], &[("threshold", &threshold), ("arc", &arc)]].concat());
    let PointField { points, keypoints, .. } = found(&*estimator, picture);
    let place = |(i, keypoint): (usize, &Keypoint)| {
        let [x, y] = points[i].at.map(|c| c as usize);
        (x, y, keypoint.response as u8)
    };
    keypoints.iter().enumerate().map(place).collect()
}

/// FNV-1a over x, y and score of corners in raster order.
fn checksum(corners: &[(usize, usize, u8)]) -> u64 {
    let mut sorted: Vec<_> = corners.iter().map(|(x, y, score)| (*y, *x, *score)).collect();
    sorted.sort_unstable();
    sorted
        .iter()
        .flat_map(|(y, x, score)| [*x as u64, *y as u64, u64::from(*score)])
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, value| (hash ^ value).wrapping_mul(0x100_0000_01b3))
}

/// Recorded with OpenCV 5.0.0: `FastFeatureDetector_create(threshold, True, FAST_FEATURE_DETECTOR_TYPE_9_16)` on [`blocks`] of
/// 320×240 px; the number of corners, and the checksum of their places and responses.
const OPENCV: [(usize, usize, u64); 5] = [
    (1, 2558, 0x593f_26c9_f25f_ea28),
    (10, 2461, 0x35df_90af_1a4a_2b1b),
    (20, 2335, 0x5331_16ec_28f6_f2bc),
    (40, 2025, 0x2cb5_3d84_af47_d753),
    (80, 1236, 0xad2d_4024_f886_9c5e),
];

#[test]
fn fast_corners_and_their_scores_are_those_of_opencv() {
    let picture = blocks(320, 240);
    assert_eq!(
        picture.cells().iter().map(|level| u64::from(*level)).sum::<u64>(),
        9_847_868,
        "the picture is the same"
    );
    for (threshold, count, sum) in OPENCV {
        let corners = fast(threshold, 9, &picture);
        assert_eq!((corners.len(), checksum(&corners)), (count, sum), "threshold {threshold}");
    }
}

/// The circle of the paper, written down once more.
const RING: [(i32, i32); 16] = [
    (0, 3),
    (1, 3),
    (2, 2),
    (3, 1),
    (3, 0),
    (3, -1),
    (2, -2),
    (1, -3),
    (0, -3),
    (-1, -3),
    (-2, -2),
    (-3, -1),
    (-3, 0),
    (-3, 1),
    (-2, 2),
    (-1, 3),
];

/// Whether a pixel is a corner at a threshold, by the definition of the paper.
fn is_corner(picture: &Gray, (x, y): (usize, usize), threshold: i32, arc: usize) -> bool {
    let level = |(i, j): (i32, i32)| i32::from(picture[((x as i32 + i) as usize, (y as i32 + j) as usize)]);
    let center = level((0, 0));
    let all = |is: &dyn Fn(i32) -> bool| (0..16).any(|start| (0..arc).all(|k| is(level(RING[(start + k) % 16]))));
    all(&|other| other > center + threshold) || all(&|other| other < center - threshold)
}

#[test]
fn fast_corners_are_those_of_the_definition_for_every_arc() {
    let picture = blocks(61, 47);
    for (arc, threshold) in [(9, 12), (10, 20), (11, 20), (12, 5)] {
        let score = |place: (usize, usize)| {
            let is_inside = place.0 >= 3 && place.1 >= 3 && place.0 + 3 < 61 && place.1 + 3 < 47;
            let last =
                if is_inside { (threshold..255).rev().find(|t| is_corner(&picture, place, *t, arc)) } else { None };
            last.unwrap_or(0)
        };
        let scores = Grid::from_fn(61, 47, |x, y| score((x, y)));
        let mut plain = Vec::new();
        for (x, y) in (3..44).flat_map(|y| (3..58).map(move |x| (x, y))) {
            let mut around = (y - 1..=y + 1).flat_map(|j| (x - 1..=x + 1).map(move |i| (i, j)));
            if scores[(x, y)] > 0 && around.all(|place| place == (x, y) || scores[place] < scores[(x, y)]) {
                plain.push((x, y, scores[(x, y)] as u8));
            }
        }
        assert!(plain.len() > 20, "{} corners with an arc of {arc}", plain.len());
        // Found in order of decreasing score, equal ones in raster order.
        plain.sort_by_key(|(x, y, score)| (std::cmp::Reverse(*score), *y, *x));
        assert_eq!(fast(threshold as usize, arc, &picture), plain, "arc {arc}");
    }
}

/// The picture rotated by 90°: pixel (x, y) goes to (height − 1 − y, x).
fn rotated(picture: &Gray) -> Gray {
    let (width, height) = picture.size();
    Grid::from_fn(height, width, |x, y| picture[(y, height - 1 - x)])
}

#[test]
fn fast_corners_turn_with_the_picture_and_ignore_a_change_of_brightness() {
    let picture = blocks(80, 60).map(|level| level / 2);
    let corners = fast(15, 9, &picture);
    let mut turned: Vec<_> = corners.iter().map(|(x, y, score)| (59 - y, *x, *score)).collect();
    let mut found = fast(15, 9, &rotated(&picture));
    turned.sort_unstable();
    found.sort_unstable();
    assert!(found.len() > 50 && found == turned);
    assert_eq!(fast(15, 9, &picture.map(|level| level + 60)), corners, "only differences count");
    // With twice the contrast and twice the threshold the places stay the same.
    let places = |corners: Vec<(usize, usize, u8)>| corners.into_iter().map(|(x, y, _)| (x, y)).collect::<Vec<_>>();
    let doubled = fast(31, 9, &picture.map(|level| level * 2));
    assert_eq!(places(doubled), places(corners));
}

#[test]
fn fast_tells_the_run_that_decides_and_shows_the_circle() {
    // A dark square on a bright ground, darkest at its corner (20, 18): without that, equal scores suppress each other.
    let picture = Grid::from_fn(40, 36, |x, y| match (x, y) {
        (20, 18) => 40,
        (20.., 18..) => 50,
        _ => 170,
    });
    let estimator = set("fast", &ALL);
    let mut walk = estimator.walk(&clip_of(picture), 0).expect("a walk");
    let mut told = Vec::new();
    while !walk.at_end() {
        walk.jump(Move::Granularity(3, Direction::Forward));
        told.push(walk.step(None).sentence.plain());
    }
    let has = |part: &str| assert!(told.iter().any(|said| said.contains(part)), "no step says {part}: {told:#?}");
    has("11 contiguous pixels (10 to 4) are brighter than I_p + 20 = 60, at least 9: a corner. Its score is V = 129");
    has("Row 2: no pixel is 3 px away from the border");
    has("pixels pass the high-speed test, with 2 adjacent compass pixels");
    has("kept as number 1.");
    has("End of the run: 1 corner kept");
    // The pixel pointed at is explained at any step, with its circle and its chart.
    walk.jump(Move::To(Cursor { unit: 4, event: 1 }));
    let focus = Some(Focus::current([10.0, 10.0]));
    let step = walk.step(focus);
    assert!(step.sentence.plain().contains("rejected by the high-speed test"), "{}", step.sentence.plain());
    let series = step.readouts.iter().find_map(|readout| match readout {
        Readout::Series(series) => Some(series.lines[0].2.len()),
        _ => None,
    });
    assert_eq!(series, Some(16), "a difference for each pixel of the circle");
    let border = walk.step(Some(Focus::current([1.0, 10.0]))).sentence.plain();
    assert!(border.contains("its circle does not fit"), "{border}");
}

#[test]
fn a_picture_without_corners_says_so() {
    for (picture, part) in [
        (Grid::new(30, 20, 90), "No pixel has 9 contiguous circle pixels that differ by more than 20 gray levels"),
        (Grid::from_fn(30, 20, |x, _| (8 * x) as u8), "there are no corners"),
    ] {
        let mut walk = set("fast", &[]).walk(&clip_of(picture), 0).expect("a walk");
        walk.jump(Move::End);
        let said = walk.step(None).sentence.plain();
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn a_tracker_follows_what_a_detector_finds() {
    let frame = |t: usize| {
        let whole = blocks(140, 110);
        Frame::gray(Grid::from_fn(120, 96, |x, y| whole[(x + 3 * t, y + 2 * t)]))
    };
    let clip = Clip::from_frames("moved", vec![frame(0), frame(1)]).expect("frames");
    for id in ["fast"] {
        let tracker = set("pyramidal-lucas-kanade", &[("points", "detect"), ("detector", id)]);
        let output = tracker.run(&clip, 0, &Threads::single()).expect("a run");
        let points = &output.get::<PointField>().expect("points").points;
        let is_right = |[u, v]: [f32; 2]| (u + 3.0).hypot(v + 2.0) < 0.2;
        let right = points.iter().filter(|point| point.displacement.is_some_and(is_right)).count();
        assert!(points.len() > 20 && 10 * right > 7 * points.len(), "{id}: {right} of {}", points.len());
    }
}

#[expect(dead_code, reason = "for detectors with descriptors")]
fn descriptors(field: &PointField) -> Vec<Descriptor> {
    field.keypoints.iter().filter_map(|keypoint| keypoint.descriptor.clone()).collect()
}
