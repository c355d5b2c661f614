//! Detectors of interest points against plain references, against OpenCV's figures, and under rotation and gain.

use crate::common::{self, set};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::{Descriptor, Keypoint, PointField, repeatability};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move};
use motionscope_core::scene::{Focus, Readout, Role, Shape, Tile};

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
    // Its legend tells the circle in every stage, also where corners were suppressed or rejected.
    for to in [Move::To(Cursor { unit: 20, event: 1 }), Move::To(Cursor { unit: 54, event: 3 }), Move::End] {
        walk.jump(to);
        let legend = walk.scene(Some(Focus::current([20.0, 18.0]))).legend;
        for meaning in ["similar to p", "brighter than the centre p by more than t", "longest run, an arc"] {
            assert!(legend.iter().any(|(_, told)| *told == meaning), "{meaning} is missing in {legend:?}");
        }
    }
    let border = walk.step(Some(Focus::current([1.0, 10.0]))).sentence.plain();
    assert!(border.contains("its circle does not fit"), "{border}");
}

#[test]
fn a_tested_pixel_is_the_work_and_its_tile_has_the_circle() {
    let picture = Grid::from_fn(40, 36, |x, y| match (x, y) {
        (20, 18) => 40,
        (20.., 18..) => 50,
        _ => 170,
    });
    let mut walk = set("fast", &ALL).walk(&clip_of(picture), 0).expect("a walk");
    let (mut corners, mut all) = (0, Vec::new());
    while !walk.at_end() {
        walk.jump(Move::Granularity(3, Direction::Forward));
        let (step, work) = (walk.step(None), walk.scene(None).work);
        let told = step.sentence.plain().replace('\u{a0}', " ");
        let is_compared = told.starts_with("Corner (") && !told.contains("minimum distance");
        let is_of_pixel = told.starts_with("Pixel (") || is_compared;
        assert_eq!(work.is_some(), is_of_pixel, "{told}");
        let framed = step.readouts.iter().find_map(|readout| match readout {
            Readout::Tiles(tiles) => Some(tiles[0].framed.clone()),
            _ => None,
        });
        all.push(told.clone());
        if !told.starts_with("Pixel (20, 18)") {
            continue;
        }
        corners += 1;
        assert_eq!(work, Some([[16.5, 14.5], [23.5, 21.5]]), "the circle and nothing else");
        let framed = framed.expect("a tile");
        let pixels = |role: Role| {
            let of_role = framed.iter().filter(|framed| framed.role == role);
            of_role.flat_map(|framed| framed.pixels.clone()).collect::<Vec<_>>()
        };
        // Pixels 5 to 9 lie on the square; the run goes from 10 over 16 to 4.
        assert_eq!(pixels(Role::Estimate), [[6, 3], [6, 4], [5, 5], [4, 6], [3, 6]]);
        assert_eq!(pixels(Role::Measured).len(), 11);
        let run = pixels(Role::Result);
        assert_eq!((run[0], run[10], run.len()), ([2, 6], [6, 2], 11));
    }
    assert_eq!(corners, 1, "{all:?}");
    let hovered = walk.scene(Some(Focus::current([10.0, 10.0])));
    assert_eq!(hovered.work, None, "the view does not follow the pointer");
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
    for id in ["fast", "orb", "surf"] {
        let tracker = set("pyramidal-lucas-kanade", &[("points", "detect"), ("detector", id)]);
        let output = tracker.run(&clip, 0, &Threads::single()).expect("a run");
        let points = &output.get::<PointField>().expect("points").points;
        let is_right = |[u, v]: [f32; 2]| (u + 3.0).hypot(v + 2.0) < 0.2;
        let right = points.iter().filter(|point| point.displacement.is_some_and(is_right)).count();
        assert!(points.len() > 20 && 10 * right > 7 * points.len(), "{id}: {right} of {}", points.len());
    }
}

/// Descriptors, angles and places, in order of the places.
fn described(field: &PointField) -> Vec<([f32; 2], f32, Descriptor)> {
    let one = |(i, keypoint): (usize, &Keypoint)| {
        let descriptor = keypoint.descriptor.clone().expect("it is described");
        (field.points[i].at, keypoint.angle_rad.expect("it is oriented"), descriptor)
    };
    let mut all: Vec<_> = field.keypoints.iter().enumerate().map(one).collect();
    all.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]).then(a.0[0].total_cmp(&b.0[0])));
    all
}

/// The difference of two angles, −π to π.
fn angle_between(a: f32, b: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    (a - b + PI).rem_euclid(TAU) - PI
}

/// A picture of waves, whose blobs and corners have many sizes.
fn wavy(width: usize, height: usize, of: impl Fn(f64) -> f64) -> Gray {
    let value = |x: f64, y: f64| {
        let long = common::waves(0.45 * x + 7.0, 0.4 * y) - 128.0;
        128.0 + 0.6 * (common::waves(x, y) - 128.0) + 0.7 * long
    };
    Grid::from_fn(width, height, |x, y| of(value(x as f64, y as f64)).clamp(0.0, 255.0) as u8)
}

#[test]
fn orb_ranks_by_the_harris_response_and_points_to_the_intensity_centroid() {
    let picture = blocks(90, 74);
    let level = |x: i32, y: i32| f64::from(picture[(x as usize, y as usize)]);
    let field = found(&*set("orb", &[("levels", "1"), ("max-points", "40")]), &picture);
    assert!(field.points.len() == 40 && field.keypoints.is_sorted_by(|a, b| a.response >= b.response));
    for (point, keypoint) in field.points.iter().zip(&field.keypoints) {
        let [x, y] = point.at.map(|c| c as i32);
        let (mut tensor, mut moments) = ([0.0; 3], [0.0; 2]);
        for (i, j) in (-3..=3).flat_map(|j| (-3..=3).map(move |i| (x + i, y + j))) {
            let across = level(i + 1, j - 1) + 2.0 * level(i + 1, j) + level(i + 1, j + 1)
                - level(i - 1, j - 1)
                - 2.0 * level(i - 1, j)
                - level(i - 1, j + 1);
            let down = level(i - 1, j + 1) + 2.0 * level(i, j + 1) + level(i + 1, j + 1)
                - level(i - 1, j - 1)
                - 2.0 * level(i, j - 1)
                - level(i + 1, j - 1);
            let [a, b] = [across / 8.0, down / 8.0];
            tensor.iter_mut().zip([a * a, a * b, b * b]).for_each(|(sum, product)| *sum += product / 49.0);
        }
        let [xx, xy, yy] = tensor;
        let plain = xx * yy - xy * xy - 0.04 * (xx + yy).powi(2);
        assert!((f64::from(keypoint.response) - plain).abs() < 1e-3 * plain.abs(), "{} not {plain}", keypoint.response);
        for (i, j) in (-15..=15).flat_map(|j| (-15..=15).map(move |i| (i, j))).filter(|(i, j)| i * i + j * j <= 225) {
            moments[0] += f64::from(i) * level(x + i, y + j);
            moments[1] += f64::from(j) * level(x + i, y + j);
        }
        let plain = moments[1].atan2(moments[0]) as f32;
        assert!(angle_between(keypoint.angle_rad.expect("oriented"), plain).abs() < 1e-4);
    }
}

#[test]
fn orb_tells_the_windows_of_each_bit_as_they_are() {
    let picture = blocks(90, 74);
    let estimator = set("orb", &[("levels", "1"), ("max-points", "3")]);
    let field = found(&*estimator, &picture);
    let Some(Descriptor::Bits(bits)) = &field.keypoints[0].descriptor else { panic!("a binary descriptor") };
    let mut walk = estimator.walk(&clip_of(picture.clone()), 0).expect("a walk");
    let mean = |x: f64, y: f64| {
        let window = (-2..=2).flat_map(|j| (-2..=2).map(move |i| (x as i32 + i, y as i32 + j)));
        window.map(|(i, j)| f64::from(picture[(i as usize, j as usize)])).sum::<f64>() / 25.0
    };
    for k in 0..256 {
        walk.jump(Move::To(Cursor { unit: 1, event: k + 2 }));
        let said = walk.step(None).sentence.plain();
        let told = common::numbers(&said.replace("5×5", "").replace("of level 0", ""));
        // Pair, of 256, angle, x, y, mean, mean, x, y, bit.
        let [pair, _, _, x, y, a, b, u, v, bit] = told[..] else { panic!("{said}: {told:?}") };
        assert_eq!(pair as usize, k + 1);
        assert!((mean(x, y) - a).abs() < 0.006 && (mean(u, v) - b).abs() < 0.006, "{said}");
        assert_eq!((bit == 1.0, bits[k / 64] >> (k % 64) & 1 == 1), (mean(x, y) < mean(u, v), bit == 1.0), "{said}");
    }
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("End of the run: 3 keypoints on 1 level (3, from level 0 on)"), "{said}");
}

#[test]
fn orb_descriptors_turn_with_the_picture_and_ignore_brightness() {
    let picture = blocks(91, 91).map(|level| level / 2);
    let estimator = set("orb", &[("levels", "1"), ("threshold", "10")]);
    let here = found(&*estimator, &picture);
    let there = found(&*estimator, &rotated(&picture));
    assert!(here.points.len() > 60 && here.points.len() == there.points.len());
    for (at, angle, descriptor) in described(&here) {
        let turned = [90.0 - at[1], at[0]];
        let all = described(&there);
        let again = all.iter().find(|(at, ..)| *at == turned).expect("it is found again");
        assert!((angle_between(again.1, angle) - std::f32::consts::FRAC_PI_2).abs() < 1e-4);
        assert_eq!(again.2.distance(&descriptor), Some(0.0), "the pattern turns exactly");
    }
    let brighter = found(&*estimator, &picture.map(|level| level + 100));
    assert_eq!(described(&brighter), described(&here));
}

#[test]
fn orb_finds_corners_again_at_other_sizes() {
    let large = wavy(240, 200, |value| value);
    let small = Grid::from_fn(200, 167, |x, y| large.sample(x as f32 * 1.2 + 0.1, y as f32 * 1.2 + 0.1).round() as u8);
    let estimator = set("orb", &[("max-points", "200"), ("threshold", "10")]);
    let fields = [found(&*estimator, &large), found(&*estimator, &small)];
    let shrink = [[1.0 / 1.2, 0.0, -0.1], [0.0, 1.0 / 1.2, -0.1], [0.0, 0.0, 1.0]];
    let found = repeatability(fields.each_ref(), shrink, 1.5).expect("an inverse");
    let share = found.share().expect("keypoints");
    assert!(share > 0.7, "{share} of {found:?}");
}

/// D_xx, D_yy and D_xy as the plainest sums over the pixels of a filter of this size.
fn plain_hessian(picture: &Gray, (x, y): (usize, usize), size: i32) -> [f64; 3] {
    let (lobe, half) = (size / 3, size / 2);
    let mut sums = [0.0; 3];
    for (i, j) in (-half..=half).flat_map(|j| (-half..=half).map(move |i| (i, j))) {
        let level = f64::from(picture[((x as i32 + i) as usize, (y as i32 + j) as usize)]);
        let along = |c: i32| if c.abs() <= lobe / 2 { -2.0 } else { 1.0 };
        if j.abs() < lobe {
            sums[0] += along(i) * level;
        }
        if i.abs() < lobe {
            sums[1] += along(j) * level;
        }
        if i != 0 && j != 0 && i.abs() <= lobe && j.abs() <= lobe {
            sums[2] += f64::from(i.signum() * j.signum()) * level;
        }
    }
    sums.map(|sum| sum / f64::from(size * size))
}

#[test]
fn surf_keypoints_are_maxima_of_the_plain_determinant() {
    let (width, height) = (84usize, 70usize);
    let picture = wavy(width, height, |value| value);
    let layer = |size: usize| {
        Grid::from_fn(width, height, |x, y| {
            let half = size / 2;
            let fits = x >= half && y >= half && x + half < width && y + half < height;
            let [xx, yy, xy] = if fits { plain_hessian(&picture, (x, y), size as i32) } else { [0.0; 3] };
            xx * yy - 0.81 * xy * xy
        })
    };
    let layers = [9, 15, 21, 27].map(layer);
    let mut plain = Vec::new();
    for k in 1..3 {
        let margin = [21, 27][k - 1] / 2;
        for (x, y) in (margin..height - margin).flat_map(|y| (margin..width - margin).map(move |x| (x, y))) {
            let here = layers[k][(x, y)];
            let around = (k - 1..=k + 1)
                .flat_map(|k| (y - 1..=y + 1).flat_map(move |j| (x - 1..=x + 1).map(move |i| (k, i, j))));
            let mut others = around.filter(|other| *other != (k, x, y));
            if here > 25.0 && others.all(|(k, i, j)| layers[k][(i, j)] < here) {
                plain.push(([x as f32, y as f32], here));
            }
        }
    }
    let field = found(&*set("surf", &[("octaves", "1")]), &picture);
    assert!(plain.len() > 5 && !field.points.is_empty(), "{} maxima", plain.len());
    for (point, keypoint) in field.points.iter().zip(&field.keypoints) {
        let is_here = |(at, _): &&([f32; 2], f64)| (0..2).all(|i| (at[i] - point.at[i]).abs() <= 1.0);
        let (at, response) = plain.iter().find(is_here).expect("a plain maximum");
        let ratio = f64::from(keypoint.response) / response;
        assert!((0.98..1.6).contains(&ratio), "{} at {at:?}, plainly {response}", keypoint.response);
    }
    assert!(10 * field.points.len() >= 7 * plain.len(), "{} of {} are refined", field.points.len(), plain.len());
}

#[test]
fn surf_descriptors_turn_with_the_picture_and_ignore_contrast_and_brightness() {
    let picture = wavy(121, 121, |value| value / 2.0);
    let estimator = set("surf", &[("octaves", "2"), ("threshold", "5")]);
    let here = described(&found(&*estimator, &picture));
    let compare = |other: &Gray, place: &dyn Fn([f32; 2]) -> [f32; 2], turn: f32| {
        let there = described(&found(&*estimator, other));
        let mut distances = Vec::new();
        for (at, angle, descriptor) in &here {
            let [x, y] = place(*at);
            let again = there.iter().filter(|(other, ..)| (other[0] - x).hypot(other[1] - y) < 0.5);
            let best = again.filter(|(_, other, _)| (angle_between(*other, *angle) - turn).abs() < 0.15);
            distances.extend(best.filter_map(|(.., other)| other.distance(descriptor)).reduce(f32::min));
        }
        distances.sort_by(f32::total_cmp);
        (distances.len(), distances.get(distances.len() / 2).copied().unwrap_or(f32::INFINITY))
    };
    assert!(here.len() > 15, "{} keypoints", here.len());
    for (.., descriptor) in &here {
        let Descriptor::Reals(values) = descriptor else { panic!("64 values") };
        assert!(values.len() == 64 && (values.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-4);
    }
    let (count, median) = compare(&rotated(&picture), &|[x, y]| [120.0 - y, x], std::f32::consts::FRAC_PI_2);
    // Where two sectors have sums of nearly one length, rounding decides between them.
    assert!(10 * count >= 6 * here.len() && median < 0.15, "{count} of {}, median distance {median}", here.len());
    let (count, median) = compare(&picture.map(|level| level + 90), &|at| at, 0.0);
    // Beyond the border a sum is 0, which is not as bright as the rest.
    assert!(10 * count >= 9 * here.len() && median < 0.005, "{count} of {}, {median}", here.len());
    let (count, median) = compare(&picture.map(|level| level * 2), &|at| at, 0.0);
    assert!(10 * count >= 9 * here.len() && median < 0.01, "{count} of {}, {median}", here.len());
}

#[test]
fn surf_finds_a_blob_with_its_size() {
    for sigma in [3.0f32, 6.0] {
        let value = |x: usize, y: usize| {
            let squared = (x as f32 - 60.0).powi(2) + (y as f32 - 50.0).powi(2);
            (40.0 + 180.0 * (-squared / (2.0 * sigma * sigma)).exp()).round() as u8
        };
        let field = found(&*set("surf", &[]), &Grid::from_fn(120, 100, value));
        let (point, keypoint) = (field.points.first().expect("a blob"), &field.keypoints[0]);
        let scale = keypoint.scale_px.expect("a scale");
        assert!((point.at[0] - 60.0).hypot(point.at[1] - 50.0) < 0.5, "{:?}", point.at);
        assert!((scale / sigma - 1.0).abs() < 0.35, "scale {scale} of a blob of {sigma}");
    }
}

#[test]
fn the_scale_of_orb_is_that_of_its_patch_in_the_frame() {
    let field = found(&*set("orb", &[("patch", "31"), ("scale-factor", "1.5")]), &wavy(200, 160, |value| value));
    // A twelfth of the side, times a power of the scale factor.
    let level = |keypoint: &Keypoint| (keypoint.scale_px.expect("a scale") * 12.0 / 31.0).log(1.5);
    let levels: Vec<f32> = field.keypoints.iter().map(level).collect();
    assert!(levels.iter().all(|level| (level - level.round()).abs() < 0.02 && *level > -0.02), "{levels:?}");
    assert!(levels.iter().any(|level| level.abs() < 0.02) && levels.iter().any(|level| *level > 0.9), "{levels:?}");
}

#[test]
fn flat_and_tiny_pictures_have_no_keypoints_and_say_so() {
    for id in ["orb", "surf"] {
        for size in [(1, 1), (1, 40), (9, 9), (48, 40)] {
            let clip = clip_of(Grid::new(size.0, size.1, 90));
            let mut walk = set(id, &[]).walk(&clip, 0).expect("a walk");
            walk.jump(Move::End);
            let said = walk.step(None).sentence.plain();
            assert!(said.contains("no keypoint"), "{id} in {size:?}: {said}");
            assert!(walk.output().get::<PointField>().expect("keypoints").points.is_empty());
        }
    }
}

/// The 64 values of SURF from the pixels themselves: sums over both halves of each Haar wavelet, without an integral image.
fn plain_surf(picture: &Gray, [x, y]: [f64; 2], scale: f64, angle: f64) -> Vec<f64> {
    let level = |i: i64, j: i64| {
        let (i, j) = (usize::try_from(i).unwrap_or(usize::MAX), usize::try_from(j).unwrap_or(usize::MAX));
        picture.get(i, j).map_or(0.0, |level| f64::from(*level))
    };
    let half = (scale.round() as i64).max(1);
    let (sin, cos) = angle.sin_cos();
    let mut values = vec![0.0; 64];
    for (i, j) in (0..20).flat_map(|j| (0..20).map(move |i| (i, j))) {
        let [u, v] = [i, j].map(|k: usize| k as f64 - 9.5);
        let place = [x + scale * (cos * u - sin * v), y + scale * (sin * u + cos * v)];
        // The wavelet has an even side, so that its middle is a corner of pixels.
        let [a, b] = place.map(|c| (c + 0.5).round() as i64);
        let mut wavelet = [0.0; 2];
        for (p, q) in (-half..half).flat_map(|q| (-half..half).map(move |p| (p, q))) {
            let value = level(a + p, b + q) / (2 * half * half) as f64;
            wavelet[0] += if p < 0 { -value } else { value };
            wavelet[1] += if q < 0 { -value } else { value };
        }
        let weight = (-(u * u + v * v) / (2.0 * 3.3 * 3.3)).exp();
        let along = weight * (cos * wavelet[0] + sin * wavelet[1]);
        let across = weight * (cos * wavelet[1] - sin * wavelet[0]);
        let first = 4 * (j / 5 * 4 + i / 5);
        for (value, part) in values[first..first + 4].iter_mut().zip([along, across, along.abs(), across.abs()]) {
            *value += part;
        }
    }
    let length = values.iter().map(|v| v * v).sum::<f64>().sqrt();
    values.into_iter().map(|v| v / length).collect()
}

#[test]
fn surf_descriptors_are_those_of_the_pixels() {
    let picture = wavy(140, 120, |value| value);
    let field = found(&*set("surf", &[("threshold", "5")]), &picture);
    assert!(field.points.len() > 20, "{} keypoints", field.points.len());
    let mut differing = 0;
    for (point, keypoint) in field.points.iter().zip(&field.keypoints) {
        let Some(Descriptor::Reals(values)) = &keypoint.descriptor else { panic!("64 values") };
        let (scale, angle) = (keypoint.scale_px.expect("a scale"), keypoint.angle_rad.expect("oriented"));
        let plain = plain_surf(&picture, point.at.map(f64::from), scale.into(), angle.into());
        let off = values.iter().zip(&plain).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
        // A sample between two corners is rounded to one or the other.
        differing += usize::from(off > 1e-4);
        assert!(off < 0.05, "{:?}: {off}", point.at);
    }
    assert!(10 * differing < field.points.len(), "{differing} of {}", field.points.len());
}

#[test]
fn the_end_of_a_run_shows_all_keypoints() {
    for id in ["sift", "surf", "orb"] {
        let mut walk = set(id, &[]).walk(&clip_of(blocks(160, 120)), 0).expect("a walk");
        walk.jump(Move::End);
        let marks = walk.scene(None).marks;
        let circles = marks.iter().filter(|mark| matches!(mark.shape, Shape::Ellipse { .. })).count();
        let found = walk.output().get::<PointField>().expect("keypoints").points.len();
        assert!(found > 3 && circles == found, "{id}: {circles} circles of {found}");
    }
}

#[test]
fn fast_numbers_of_the_circle_stay_inside_the_picture() {
    let picture = blocks(40, 40);
    let mut walk = set("fast", &[]).walk(&clip_of(picture), 0).expect("a walk");
    // The first row with circles: that of 3 px from the border.
    walk.jump(Move::To(Cursor { unit: 3, event: usize::MAX }));
    let focus = Focus::current([3.0, 3.0]);
    let marks = walk.scene(Some(focus)).marks;
    let texts: Vec<[f32; 2]> = marks
        .iter()
        .filter_map(|mark| if let Shape::Text { at, .. } = &mark.shape { Some(*at) } else { None })
        .collect();
    assert_eq!(texts.len(), 4);
    assert!(texts.iter().flatten().all(|c| *c >= 0.0), "{texts:?}");
}

#[test]
fn the_images_of_an_octave_grow_blurrier_in_the_same_place() {
    let mut walk = set("sift", &[]).walk(&clip_of(blocks(120, 90)), 0).expect("a walk");
    let mut before: Vec<Tile> = Vec::new();
    let mut last = f32::NAN;
    // The six Gaussian images of the first octave, and the first of the second.
    for unit in 1..=7 {
        walk.jump(Move::To(Cursor { unit: unit - 1, event: 1 }));
        let scene = walk.scene(None);
        let names: Vec<String> = scene.pictures.iter().map(|canvas| canvas.picture.to_string()).collect();
        let is_first = unit == 1 || unit == 7;
        assert_eq!(names, if is_first { &["smoothed"][..] } else { &["smoothed", "response"] }, "{unit}");
        // The values of the pictures are those of the images, not their grays.
        let measured: Vec<_> = scene.pictures.iter().filter_map(|canvas| canvas.measured.as_ref()).collect();
        let value = measured[0].at([61, 47]);
        if let Some(difference) = measured.get(1) {
            assert!((difference.at([61, 47]) - (value - last)).abs() < 1e-3, "{unit}: {}", difference.title);
            assert!(difference.title.starts_with(&format!("{} = ", difference.symbol)), "{}", difference.title);
        }
        last = value;
        let readouts = walk.step(None).readouts;
        let tiles =
            readouts.iter().find_map(|r| if let Readout::Tiles(tiles) = r { Some(tiles.clone()) } else { None });
        let tiles = tiles.expect("a part of all images");
        let pictures =
            readouts.iter().find_map(|r| if let Readout::Stack(s) = r { Some(s.levels.all.len()) } else { None });
        let in_octave = if unit == 7 { 1 } else { unit };
        assert_eq!((tiles.len(), pictures), (2 * in_octave - 1, Some(in_octave)), "{unit}");
        if is_first {
            before = tiles;
            continue;
        }
        let of = |tiles: &[Tile], label: &str| tiles.iter().find(|tile| tile.label == label).cloned();
        assert_eq!(of(&tiles, "G₁").map(|tile| tile.values), of(&before, "G₁").map(|tile| tile.values), "{unit}");
        let roughness = |tile: &Tile| {
            let cells = tile.values.cells();
            cells.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f32>()
        };
        let gaussians: Vec<f32> = tiles[..in_octave].iter().map(roughness).collect();
        assert!(gaussians.is_sorted_by(|a, b| a > b), "{unit}: {gaussians:?}");
        // D is the difference of both images, to the tenth that is shown.
        let [from, to, difference] =
            [&tiles[unit - 2], &tiles[unit - 1], &tiles[2 * unit - 2]].map(|t| t.values.cells());
        let off = difference.iter().zip(to.iter().zip(from)).map(|(d, (to, from))| (d - (to - from)).abs());
        assert!(off.fold(0.0, f32::max) < 0.16, "{unit}");
        before = tiles;
    }
}
