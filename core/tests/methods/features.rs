//! Corners and the tracker of features against plain references and against places that are known exactly.

use crate::common::{set, waves};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Border, Gray, Grid};
use motionscope_core::products::{DenseField, Feature, PointField, Status};
use motionscope_core::run::{Cursor, Direction, Move};
use motionscope_core::scene::{self, Focus};

fn clip(frames: [Gray; 2]) -> Clip {
    Clip::from_frames("made", frames.into_iter().map(Frame::gray).collect()).expect("frames of one size")
}

fn points(id: &str, settings: &[(&str, &str)], clip: &Clip) -> Vec<Feature> {
    let output = set(id, settings).run(clip, 0, &Threads::single()).expect("a run");
    output.get::<PointField>().expect("features").points.clone()
}

const SIZE: (usize, usize) = (96, 80);

fn moving(motion: [f64; 2]) -> Clip {
    let frame = |t: f64| {
        Grid::from_fn(SIZE.0, SIZE.1, |x, y| (waves(x as f64 - motion[0] * t, y as f64 - motion[1] * t) + 0.5) as u8)
    };
    clip([frame(0.0), frame(1.0)])
}

/// Gradients as plainly as can be: Sobel's, the picture going on along a straight line beyond its edge.
fn sobel(picture: &Gray, x: isize, y: isize) -> [f64; 2] {
    let inside = |i: isize, j: isize| f64::from(picture.at(i, j, Border::Replicate));
    let in_row = |i: isize, j: isize| {
        let edge = i.clamp(0, picture.width() as isize - 1);
        if i == edge { inside(i, j) } else { 2.0 * inside(edge, j) - inside(2 * edge - i, j) }
    };
    let at = |i: isize, j: isize| {
        let (i, j) = (x + i, y + j);
        let edge = j.clamp(0, picture.height() as isize - 1);
        if j == edge { in_row(i, j) } else { 2.0 * in_row(i, edge) - in_row(i, 2 * edge - j) }
    };
    let across = |j: isize| (at(1, j) - at(-1, j)) / 2.0;
    let down = |i: isize| (at(i, 1) - at(i, -1)) / 2.0;
    [(across(-1) + 2.0 * across(0) + across(1)) / 4.0, (down(-1) + 2.0 * down(0) + down(1)) / 4.0]
}

/// The means of I_x², I_x I_y and I_y² under as much of a window as lies in the picture.
fn plain_tensor(picture: &Gray, (x, y): (usize, usize), weights: &[f64]) -> [f64; 3] {
    let (mut sums, mut total) = ([0.0; 3], 0.0);
    let reach = weights.len() as isize / 2;
    for (i, j) in (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j))) {
        let (Some(px), Some(py)) = (x.checked_add_signed(i), y.checked_add_signed(j)) else { continue };
        if px < picture.width() && py < picture.height() {
            let [a, b] = sobel(picture, px as isize, py as isize);
            let weight = weights[(i + reach) as usize] * weights[(j + reach) as usize];
            sums.iter_mut().zip([a * a, a * b, b * b]).for_each(|(sum, product)| *sum += weight * product);
            total += weight;
        }
    }
    sums.map(|sum| sum / total)
}

fn harris([xx, xy, yy]: [f64; 3]) -> f64 {
    xx * yy - xy * xy - 0.04 * (xx + yy).powi(2)
}

fn smaller_eigenvalue([xx, xy, yy]: [f64; 3]) -> f64 {
    (xx + yy) / 2.0 - (((xx - yy) / 2.0).powi(2) + xy * xy).sqrt()
}

#[test]
fn corners_are_those_of_a_plain_detector_in_its_order() {
    let clip = moving([0.0; 2]);
    let picture = clip.frame(0).expect("a frame").luma().clone();
    let gaussian: Vec<f64> = (-2i32..=2).map(|i| (-0.5 * f64::from(i * i)).exp()).collect();
    type Response = fn([f64; 3]) -> f64;
    for (id, weights, response) in
        [("harris", &gaussian[..], harris as Response), ("shi-tomasi", &[1.0; 7][..], smaller_eigenvalue)]
    {
        let map = Grid::from_fn(SIZE.0, SIZE.1, |x, y| response(plain_tensor(&picture, (x, y), weights)));
        let largest = map.cells().iter().copied().fold(0.0, f64::max);
        let inner = (1..SIZE.1 - 1).flat_map(|y| (1..SIZE.0 - 1).map(move |x| (x, y)));
        let is_peak = |&(x, y): &(usize, usize)| {
            let around = (y - 1..=y + 1).flat_map(|j| (x - 1..=x + 1).map(move |i| (i, j)));
            map[(x, y)] >= 0.1 * largest && around.into_iter().all(|place| map[place] <= map[(x, y)])
        };
        let mut peaks: Vec<_> = inner.filter(is_peak).collect();
        peaks.sort_by(|a, b| map[*b].total_cmp(&map[*a]));
        let mut kept: Vec<(usize, usize)> = Vec::new();
        for (x, y) in peaks {
            let is_far = |&(a, b): &(usize, usize)| a.abs_diff(x).pow(2) + b.abs_diff(y).pow(2) >= 81;
            if kept.iter().all(is_far) && kept.len() < 25 {
                kept.push((x, y));
            }
        }
        let window = weights.len().to_string();
        let kind = if weights[0] == 1.0 { "box" } else { "gaussian" };
        let settings =
            [("threshold", "0.1"), ("min-distance", "9"), ("max-points", "25"), ("window", &window), ("weights", kind)];
        let found: Vec<_> = points(id, &settings, &clip).iter().map(|p| (p.at[0] as usize, p.at[1] as usize)).collect();
        assert!(kept.len() > 15, "{id}: {} corners", kept.len());
        assert_eq!(found, kept, "{id}");
    }
}

/// A checkerboard with squares of 12 px whose corners lie on pixels, the first at (6, 6): lines between squares are gray.
/// Each row of corners has less contrast than the one above it.
fn checkerboard() -> Gray {
    let sign = |c: usize| match (c + 6) % 24 {
        0 | 12 => 0,
        1..12 => 1,
        _ => -1,
    };
    Grid::from_fn(72, 60, |x, y| (128 + (100 - 10 * (y as i32 / 12)) * sign(x) * sign(y)) as u8)
}

#[test]
fn corners_of_a_checkerboard_are_at_their_exact_places_and_in_order() {
    let board = checkerboard();
    let clip = clip([board.clone(), board]);
    let places: Vec<(usize, usize)> =
        [6, 18, 30, 42, 54].iter().flat_map(|y| [6, 18, 30, 42, 54, 66].map(|x| (x, *y))).collect();
    for id in ["harris", "shi-tomasi"] {
        let found: Vec<_> = points(id, &[("threshold", "0.05")], &clip);
        let mut at: Vec<_> = found.iter().map(|point| (point.at[0] as usize, point.at[1] as usize)).collect();
        let rows: Vec<_> = at.iter().map(|place| place.1).collect();
        assert!(rows.is_sorted(), "{id}: the more contrast, the sooner: {rows:?}");
        assert!(found.iter().all(|point| point.status == Status::Found && point.displacement.is_none()));
        at.sort_by_key(|(x, y)| (*y, *x));
        assert_eq!(at, places, "{id}");
    }
}

#[test]
fn known_fractions_of_a_pixel_are_tracked() {
    for motion in [[0.3, -0.45], [1.7, 2.2], [-6.5, 4.25]] {
        let clip = moving(motion);
        for kind in ["detect", "grid"] {
            let found = points("pyramidal-lucas-kanade", &[("points", kind), ("max-points", "60")], &clip);
            // Of windows near the border only what is still there counts, so that they are as exact.
            let stays = |p: &&Feature| {
                let inside = |c: f32, by: f64, extent: usize| {
                    let reach = 3.0..extent as f64 - 4.0;
                    reach.contains(&f64::from(c)) && reach.contains(&(f64::from(c) + by))
                };
                inside(p.at[0], motion[0], SIZE.0) && inside(p.at[1], motion[1], SIZE.1)
            };
            let stay: Vec<_> = found.iter().filter(stays).collect();
            assert!(stay.len() > 30, "{} points", stay.len());
            for point in stay {
                let [u, v] = point.displacement.unwrap_or([f32::NAN; 2]).map(f64::from);
                let off = (u - motion[0]).hypot(v - motion[1]);
                assert!(off < 0.06, "({u}, {v}) at {:?}, not {motion:?}", point.at);
                assert!(point.status == Status::Tracked && point.residual < Some(2.0));
            }
        }
    }
}

/// Bouguet's iterations on one level as plainly as can be, in f64, over the pixels that have gradients and are in both
/// frames.
fn plain_track(clip: &Clip, at: [f64; 2], reach: i32, iterations: usize) -> [f64; 2] {
    let [a, b] = clip.pair(0).expect("a pair");
    let sample = |picture: &Gray, x: f64, y: f64| {
        let pixel = |x: f64, y: f64| f64::from(picture.at(x as isize, y as isize, Border::Replicate));
        let (x0, y0) = (x.floor(), y.floor());
        let line = |y| pixel(x0, y) * (1.0 - (x - x0)) + pixel(x0 + 1.0, y) * (x - x0);
        line(y0) * (1.0 - (y - y0)) + line(y0 + 1.0) * (y - y0)
    };
    let window: Vec<_> =
        (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (f64::from(i), f64::from(j)))).collect();
    let gradient = |x: f64, y: f64| {
        let value = |x, y| sample(a.luma(), x, y);
        [(value(x + 1.0, y) - value(x - 1.0, y)) / 2.0, (value(x, y + 1.0) - value(x, y - 1.0)) / 2.0]
    };
    let mut d = [0.0; 2];
    for _ in 0..iterations {
        let mut sums = [0.0; 5];
        for (i, j) in &window {
            let (x, y) = (at[0] + i, at[1] + j);
            let inside = |c: f64, extent: usize, margin: f64| c >= margin && c <= (extent - 1) as f64 - margin;
            let has_gradient = inside(x, SIZE.0, 1.0) && inside(y, SIZE.1, 1.0);
            if !has_gradient || !inside(x + d[0], SIZE.0, 0.0) || !inside(y + d[1], SIZE.1, 0.0) {
                continue;
            }
            let [gx, gy] = gradient(x, y);
            let off = sample(a.luma(), x, y) - sample(b.luma(), x + d[0], y + d[1]);
            let products = [gx * gx, gx * gy, gy * gy, off * gx, off * gy];
            sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
        let [xx, xy, yy, bx, by] = sums;
        let det = xx * yy - xy * xy;
        d = [d[0] + (yy * bx - xy * by) / det, d[1] + (xx * by - xy * bx) / det];
    }
    d
}

#[test]
fn the_tracker_agrees_with_a_plain_one() {
    let clip = moving([0.8, -0.6]);
    for (window, reach, iterations) in [("5", 2, 1), ("14", 7, 3), ("21", 10, 8)] {
        let count = iterations.to_string();
        let settings = [
            ("points", "grid"),
            ("max-points", "80"),
            ("window", window),
            ("levels", "1"),
            ("iterations", &count),
            ("epsilon", "0"),
            ("min-eigenvalue", "0"),
            ("max-residual", "255"),
        ];
        let found = points("pyramidal-lucas-kanade", &settings, &clip);
        let mut compared = 0;
        for point in &found {
            let plain = plain_track(&clip, point.at.map(f64::from), reach, iterations);
            let Some(found) = point.displacement else { continue };
            let off = (f64::from(found[0]) - plain[0]).hypot(f64::from(found[1]) - plain[1]);
            assert!(off < 2e-3, "{found:?} at {:?}, plainly {plain:?}", point.at);
            compared += 1;
        }
        assert!(compared > 70, "{compared} points of {}", found.len());
    }
}

#[test]
fn lost_points_are_reported_why() {
    let status = |clip: &Clip, settings: &[(&str, &str)]| -> Vec<Status> {
        let settings = [&[("points", "grid"), ("max-points", "40")], settings].concat();
        points("pyramidal-lucas-kanade", &settings, clip).iter().map(|point| point.status).collect()
    };
    let flat = Grid::new(SIZE.0, SIZE.1, 90);
    assert!(status(&clip([flat.clone(), flat.clone()]), &[]).iter().all(|status| *status == Status::Flat));
    let stripes = Grid::from_fn(SIZE.0, SIZE.1, |x, _| (128.0 + 60.0 * (x as f64 / 4.0).sin()) as u8);
    assert!(status(&clip([stripes.clone(), stripes]), &[]).iter().all(|status| *status == Status::Flat));
    // All moves to the right by 12 px, with waves that do not look alike so near: what was near the right edge is gone.
    let long = |t: usize| {
        Grid::from_fn(SIZE.0, SIZE.1, |x, y| waves((x as f64 - 12.0 * t as f64) / 3.0, y as f64 / 3.0) as u8)
    };
    let moved = clip([long(0), long(1)]);
    let found = points("pyramidal-lucas-kanade", &[("points", "grid"), ("max-points", "200")], &moved);
    let gone = |point: &&Feature| point.at[0] > 88.0;
    assert!(found.iter().filter(gone).all(|point| point.status != Status::Tracked));
    assert!(found.iter().any(|point| point.status == Status::Outside));
    // Another picture altogether.
    let other = Grid::from_fn(SIZE.0, SIZE.1, |x, y| waves(y as f64 * 1.7 + 400.0, x as f64 * 1.3) as u8);
    let [first, _] = moving([0.0; 2]).pair(0).expect("a pair");
    let unlike = clip([first.luma().clone(), other]);
    assert!(status(&unlike, &[("max-residual", "5")]).iter().all(|status| *status != Status::Tracked));
    let told = status(&unlike, &[("max-residual", "5")]);
    assert!(told.contains(&Status::Unlike), "{told:?}");
}

#[test]
fn pictures_too_small_for_a_corner_have_none_and_run_all_the_same() {
    for size in [(1, 1), (1, 40), (40, 1), (2, 2), (3, 3)] {
        let frame = || Grid::from_fn(size.0, size.1, |x, y| (x * 80 + y * 50) as u8);
        for id in ["harris", "shi-tomasi", "pyramidal-lucas-kanade"] {
            let found = points(id, &[], &clip([frame(), frame()]));
            assert!(found.is_empty() || size == (3, 3), "{id}: {found:?} in {size:?}");
        }
        let found = points("pyramidal-lucas-kanade", &[("points", "grid")], &clip([frame(), frame()]));
        assert_eq!(found.len(), size.0 * size.1, "a small picture has a point at each pixel");
    }
}

#[test]
fn an_iteration_is_reported_with_its_numbers_and_its_trail() {
    let clip = moving([1.2, -0.7]);
    let estimator = set("pyramidal-lucas-kanade", &[("levels", "2"), ("max-points", "5")]);
    let mut walk = estimator.walk(&clip, 0).expect("a walk");
    assert_eq!(walk.units(), Some(10));
    // The second iteration of the first point on the picture itself.
    walk.jump(Move::To(Cursor { unit: 1, event: 3 }));
    let step = walk.step(None);
    assert!(step.sentence.plain().contains("gives the increment"), "{}", step.sentence.plain());
    assert!(step.readouts.iter().any(|readout| matches!(readout, scene::Readout::Equation(lines) if lines.len() == 3)));
    let drawn = walk.scene(None);
    let trail = drawn.marks.iter().find_map(|mark| match &mark.shape {
        scene::Shape::Path { points, .. } => Some(points.len()),
        _ => None,
    });
    assert_eq!(trail, Some(3), "where it began and two iterations");
    walk.jump(Move::End);
    assert_eq!(walk.output().get::<PointField>().expect("features").points.len(), 5);
    assert_eq!(
        walk.unit_at(Focus::current(walk.output().get::<PointField>().expect("features").points[3].at)),
        Some(7)
    );
}

#[test]
fn a_faint_corner_is_no_less_one_and_ties_are_reported_as_such() {
    // A checkerboard of contrast 2, whose corners are all alike.
    let board = Grid::from_fn(72, 60, |x, y| 128 + 2 * ((x / 12 + y / 12) % 2) as u8);
    let clip = clip([board.clone(), board]);
    let mut walk = set("shi-tomasi", &[("min-distance", "20")]).walk(&clip, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit: 11, event: 12 }));
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("eigenvalues λ₁") && !said.contains("flat"), "{said}");
    let mut told = Vec::new();
    walk.jump(Move::To(Cursor { unit: 120, event: 1 }));
    while !walk.at_end() {
        walk.jump(Move::Granularity(3, Direction::Forward));
        told.push(walk.step(None).sentence.plain());
    }
    assert!(told[0].contains("kept as corner 1"), "{}", told[0]);
    assert!(told.iter().any(|said| said.contains("which has an equal response and comes first: rejected")), "{told:?}");
}

#[test]
fn what_is_found_from_cubes_lies_half_a_pixel_further() {
    // Squares of 12 px whose corners lie between pixels, the first at (5.5, 5.5).
    let sign = |c: usize| if ((c + 6) / 12).is_multiple_of(2) { 1 } else { -1 };
    let board = Grid::from_fn(72, 60, |x, y| (128 + 100 * sign(x) * sign(y)) as u8);
    let clip = clip([board.clone(), board]);
    for id in ["harris", "shi-tomasi"] {
        let found = points(id, &[("derivatives", "cube"), ("threshold", "0.05")], &clip);
        let mut at: Vec<_> = found.iter().map(|point| point.at.map(|c| c + 0.5)).collect();
        at.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
        let places: Vec<_> = [5.5, 17.5, 29.5, 41.5, 53.5]
            .iter()
            .flat_map(|y| [5.5, 17.5, 29.5, 41.5, 53.5, 65.5].map(|x| [x, *y]))
            .collect();
        assert_eq!(at, places, "{id}");
    }
}

/// A dense run with few iterations, so that it can be walked.
const DENSE: [(&str, &str); 4] = [("points", "dense"), ("levels", "2"), ("window", "11"), ("iterations", "5")];

#[test]
fn every_pixel_is_tracked_as_a_single_point_is() {
    let clip = moving([1.3, -0.8]);
    let output = set("pyramidal-lucas-kanade", &DENSE).run(&clip, 0, &Threads::single()).expect("a run");
    let Some(field) = &output.get::<DenseField>().cloned() else { panic!("a dense field") };
    let settings = [&DENSE[..], &[("points", "grid"), ("max-points", "400")]].concat();
    for point in points("pyramidal-lucas-kanade", &settings, &clip) {
        let (x, y) = (point.at[0] as usize, point.at[1] as usize);
        assert_eq!(field.flow.at(x, y), point.displacement, "({x}, {y})");
    }
    let confidence = field.confidence.as_ref().expect("how certain each is");
    let inner = (16..64).flat_map(|y| (16..80).map(move |x| (x, y)));
    let (mut sum, mut known) = (0.0, 0);
    for (x, y) in inner {
        let Some([u, v]) = field.flow.at(x, y) else { continue };
        assert!(confidence.values[(x, y)] >= 0.5, "a pixel that is not lost has gradients");
        (sum, known) = (sum + (u - 1.3).hypot(v + 0.8), known + 1);
    }
    assert!(known > 2000 && sum / (known as f32) < 0.03, "{known} pixels, {} px off", sum / known as f32);
}

#[test]
fn walking_along_every_pixel_comes_to_what_a_run_comes_to() {
    let frame = |t: f64| Grid::from_fn(40, 34, |x, y| (waves(x as f64 - 0.7 * t, y as f64 + 0.4 * t) + 0.5) as u8);
    let clip = clip([frame(0.0), frame(1.0)]);
    let estimator = set("pyramidal-lucas-kanade", &DENSE);
    let mut walk = estimator.walk(&clip, 0).expect("a walk");
    assert_eq!(walk.units(), Some(2 * 34), "a row on a level each");
    while !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
    }
    for threads in 1..4 {
        let run = estimator.run(&clip, 0, &Threads::new(threads).expect("threads")).expect("a run");
        assert_eq!(run, walk.output(), "{threads} threads");
    }
    assert_eq!(walk.unit_at(Focus::current([20.0, 7.0])), Some(2 * 8 - 1));
    // Row 10 on the picture, up to its pixel 4: any pixel above can be explained, none below.
    walk.jump(Move::To(Cursor { unit: 21, event: 5 }));
    let told = |at| walk.step(Some(Focus::current(at))).sentence.plain();
    assert!(told([33.0, 9.0]).starts_with("Pixel (33, 9)"), "{}", told([33.0, 9.0]));
    assert!(told([2.0, 10.0]).starts_with("Pixel (2, 10)"));
    assert!(told([5.0, 10.0]).starts_with("Pixel (4, 10)") && told([5.0, 30.0]).starts_with("Pixel (4, 10)"));
}

#[test]
fn a_feature_that_is_pointed_at_is_explained_with_its_way_through_the_levels() {
    let clip = moving([1.2, -0.7]);
    let estimator = set("pyramidal-lucas-kanade", &[("levels", "2"), ("max-points", "5")]);
    let mut walk = estimator.walk(&clip, 0).expect("a walk");
    walk.jump(Move::End);
    let output = walk.output();
    let found = &output.get::<PointField>().expect("features").points;
    // In the middle of the last one's way, on its coarse level.
    walk.jump(Move::To(Cursor { unit: 8, event: 2 }));
    let stack = |step: scene::Step| {
        let readouts = step.readouts.into_iter();
        readouts
            .filter_map(|r| if let scene::Readout::Stack(stack) = r { Some(stack) } else { None })
            .next()
            .expect("a stack")
    };
    let (first, last) = (walk.step(Some(Focus::current(found[0].at))), walk.step(None));
    assert!(first.sentence.plain().starts_with("Point 1: displacement"), "{}", first.sentence.plain());
    assert_eq!(stack(first).floors[0].vector.map(|(vector, _)| Some(vector)), Some(found[0].displacement));
    let stack = stack(last);
    assert_eq!((stack.levels.at_work, stack.floors[0].vector, stack.floors.len()), (1, None, 2));
    let floors: Vec<_> = stack.floors.iter().map(|floor| floor.middle().expect("a window")).collect();
    assert!((0..2).all(|i| (floors[1][i] * 2.0 - floors[0][i]).abs() < 1e-4), "a place of the picture on each level");
    assert_eq!(walk.scene(None).levels.expect("a pyramid").at_work, 1);
}

#[test]
fn points_that_were_clicked_are_tracked_where_they_lie_in_the_picture() {
    let clip = moving([1.25, -0.5]);
    let clicks = "0:40.5,30 0:60,50.25 0:-40,5 0:60,900 1:20,20";
    let found = points("pyramidal-lucas-kanade", &[("points", "clicks"), ("clicks", clicks)], &clip);
    assert_eq!(found.iter().map(|point| point.at).collect::<Vec<_>>(), [[40.5, 30.0], [60.0, 50.25]]);
    for point in &found {
        let [u, v] = point.displacement.expect("it is tracked");
        assert!((u - 1.25).hypot(v + 0.5) < 0.05, "({u}, {v})");
    }
    assert_eq!(points("pyramidal-lucas-kanade", &[("points", "clicks")], &clip), []);
}
