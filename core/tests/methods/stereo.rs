//! Stereo against its definitions, written down plainly, against exact truth, and where it fails.

use std::sync::Arc;

use crate::common::{self, set};
use motionscope_core::base::Threads;
use motionscope_core::course::estimators;
use motionscope_core::data::{Calibration, Clip, Disparity, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::disparity::disparity_error;
use motionscope_core::products::{DisparityField, Reference};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Guarantee, Move};
use motionscope_core::scene::{Focus, Picture, Readout};
use motionscope_core::synth;

/// Texture without repetition, smoothed over 2×2 px.
fn texture(x: i64, y: i64) -> u8 {
    let hash = |x: i64, y: i64| {
        let h = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D);
        (h >> 40) & 0xff
    };
    ((hash(x, y) + hash(x + 1, y) + hash(x, y + 1) + hash(x + 1, y + 1)) / 4) as u8
}

/// Two views as a clip of one frame.
fn pair(left: Gray, right: Gray) -> Clip {
    let clip = |gray| Clip::from_frames("view", vec![Frame::gray(gray)]).expect("a frame");
    clip(left).with_right(clip(right)).expect("views of one size")
}

/// Views of a slanted floor with a nearer strip, of different brightness in some columns, with a corner without texture.
fn scene((width, height): (usize, usize)) -> Clip {
    let disparity = |x: usize, y: usize| if (14..22).contains(&x) { 7 } else { 1 + y as i64 / 6 };
    let right = Grid::from_fn(width, height, |x, y| if y < 5 && x < 9 { 90 } else { texture(x as i64, y as i64) });
    let left = Grid::from_fn(width, height, |x, y| {
        let from = x as i64 - disparity(x, y);
        let level = if from >= 0 && !(y < 5 && from < 9) { texture(from, y as i64) } else { 90 };
        level.saturating_add((x % 5) as u8)
    });
    pair(left, right)
}

fn found(estimator: &dyn AnyEstimator, clip: &Clip) -> Disparity {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<DisparityField>().expect("disparities").map.clone()
}

/// The tests of a match, as they are defined.
#[derive(Clone, Copy)]
struct Tests {
    disparities: usize,
    uniqueness: i64,
    max_difference: usize,
    subpixel: bool,
}

/// For each pixel its disparity, or the reason why it has none; and the disparities from the right view.
fn decided(
    (width, height): (usize, usize),
    tests: Tests,
    cost: impl Fn(usize, usize, usize) -> i64,
) -> (Grid<Result<f32, &'static str>>, Grid<usize>) {
    let candidates = |x: usize| 0..=x.min(tests.disparities - 1);
    let first_least = |all: Vec<(i64, usize)>| all.into_iter().min().expect("d = 0 is always a candidate").1;
    let right = Grid::from_fn(width, height, |x, y| {
        first_least((0..tests.disparities).filter(|d| x + d < width).map(|d| (cost(x + d, y, d), d)).collect())
    });
    let left = Grid::from_fn(width, height, |x, y| {
        let best = first_least(candidates(x).map(|d| (cost(x, y, d), d)).collect());
        let least = cost(x, y, best);
        let rival = candidates(x).filter(|d| d.abs_diff(best) > 1).map(|d| cost(x, y, d)).min();
        if tests.uniqueness > 0 && rival.is_some_and(|rival| 100 * rival <= least * (100 + tests.uniqueness)) {
            return Err("ambiguous");
        }
        if right[(x - best, y)].abs_diff(best) > tests.max_difference {
            return Err("inconsistent");
        }
        let is_inside = best > 0 && best < x.min(tests.disparities - 1);
        if !tests.subpixel || !is_inside {
            return Ok(best as f32);
        }
        let [before, after] = [best - 1, best + 1].map(|d| cost(x, y, d) as f64);
        let bend = before - 2.0 * least as f64 + after;
        Ok(best as f32 + if bend > 0.0 { ((before - after) / (2.0 * bend)) as f32 } else { 0.0 })
    });
    (left, right)
}

/// The gray level at a place, with the edge repeated.
fn level(picture: &Gray, x: i64, y: i64) -> i64 {
    let (width, height) = picture.size();
    i64::from(picture[(x.clamp(0, width as i64 - 1) as usize, y.clamp(0, height as i64 - 1) as usize)])
}

/// Whether each neighbour in 9×7 px is darker than the centre.
fn census(picture: &Gray) -> Grid<Vec<bool>> {
    Grid::from_fn(picture.width(), picture.height(), |x, y| {
        let (x, y) = (x as i64, y as i64);
        let around = (-3..=3).flat_map(|dy| (-4..=4).map(move |dx| (dx, dy)));
        around.map(|(dx, dy)| level(picture, x + dx, y + dy) < level(picture, x, y)).collect()
    })
}

fn hamming(a: &[bool], b: &[bool]) -> i64 {
    a.iter().zip(b).filter(|(a, b)| a != b).count() as i64
}

fn views(clip: &Clip) -> [Gray; 2] {
    [clip.frame(0), clip.right().expect("a right view").frame(0)].map(|frame| frame.expect("a frame").luma().clone())
}

fn assert_same(found: &Disparity, expected: &Grid<f32>, what: &str) {
    let (width, _) = expected.size();
    for (i, (a, b)) in found.0.cells().iter().zip(expected.cells()).enumerate() {
        let same = a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        assert!(same, "{what}: {a} at ({}, {}), not {b}", i % width, i / width);
    }
}

#[test]
fn block_stereo_is_what_it_is_defined_as() {
    let clip = scene((41, 23));
    let [left, right] = views(&clip);
    let strings = [census(&left), census(&right)];
    let mut rejected = std::collections::BTreeSet::new();
    for (name, window, disparities, uniqueness, max_difference, subpixel) in [
        ("sad", 2, 16, 10, 1, true),
        ("sad", 0, 2, 0, 255, true),
        ("sad", 4, 64, 5, 0, false),
        ("census", 1, 9, 10, 1, true),
        ("census", 3, 33, 0, 2, true),
    ] {
        let cost = |x: usize, y: usize, d: usize| -> i64 {
            let reach = window as i64;
            let offsets = (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j)));
            let (x, y, d) = (x as i64, y as i64, d as i64);
            let inside = |c: i64, extent: usize| c.clamp(0, extent as i64 - 1) as usize;
            offsets
                .map(|(i, j)| match name {
                    "sad" => (level(&left, x + i, y + j) - level(&right, x + i - d, y + j)).abs(),
                    _ => {
                        let at = |x: i64| (inside(x, left.width()), inside(y + j, left.height()));
                        hamming(&strings[0][at(x + i)], &strings[1][at(x + i - d)])
                    }
                })
                .sum()
        };
        let tests = Tests { disparities, uniqueness, max_difference, subpixel };
        let (expected, _) = decided(left.size(), tests, cost);
        rejected.extend(expected.cells().iter().filter_map(|cell| cell.err()));
        let estimator = set(
            "block-stereo",
            &[
                ("cost", name),
                ("window", &window.to_string()),
                ("disparities", &disparities.to_string()),
                ("uniqueness", &uniqueness.to_string()),
                ("max-difference", &max_difference.to_string()),
                ("subpixel", if subpixel { "on" } else { "off" }),
            ],
        );
        assert_same(&found(&*estimator, &clip), &expected.map(|cell| cell.unwrap_or(f32::NAN)), name);
    }
    assert_eq!(rejected.len(), 2, "both tests reject some: {rejected:?}");
}

/// The sums of path costs over directions, each by its recursion, in whole numbers.
fn sums(clip: &Clip, disparities: usize, [p1, p2]: [i64; 2], directions: &[(i64, i64)]) -> Grid<Vec<i64>> {
    let [left, right] = views(clip).map(|view| census(&view));
    let (width, height) = left.size();
    let cost = |x: usize, y: usize, d: usize| (d <= x).then(|| hamming(&left[(x, y)], &right[(x - d, y)]));
    let mut sums = Grid::new(width, height, vec![0; disparities]);
    for &(dx, dy) in directions {
        let mut paths: Grid<Option<Vec<Option<i64>>>> = Grid::new(width, height, None);
        // In an order in which the pixel before comes first.
        let order = |extent: usize, step: i64| -> Vec<usize> {
            if step < 0 { (0..extent).rev().collect() } else { (0..extent).collect() }
        };
        for (x, y) in order(height, dy).into_iter().flat_map(|y| order(width, dx).into_iter().map(move |x| (x, y))) {
            let from = (x as i64 - dx, y as i64 - dy);
            let before = (from.0 >= 0 && from.1 >= 0)
                .then(|| paths.get(from.0 as usize, from.1 as usize).cloned().flatten())
                .flatten();
            let along = (0..disparities).map(|d| {
                let own = cost(x, y, d)?;
                let Some(before) = &before else { return Some(own) };
                let at = |d: Option<usize>| d.and_then(|d| before.get(d).copied().flatten());
                let least = before.iter().flatten().min().copied().expect("d = 0 is always a candidate");
                let beside = [at(d.checked_sub(1)), at(Some(d + 1))].into_iter().flatten().map(|cost| cost + p1);
                let best = at(Some(d)).into_iter().chain(beside).chain([least + p2]).min().expect("a term");
                Some(own + best - least)
            });
            let along: Vec<_> = along.collect();
            for (sum, cost) in sums[(x, y)].iter_mut().zip(&along) {
                *sum += cost.unwrap_or_default();
            }
            paths[(x, y)] = Some(along);
        }
    }
    sums
}

/// A gap filled as the paper says: the second lowest of the nearest disparities in eight directions, or their median.
fn filled(decided: &Grid<Result<f32, &'static str>>, right: &Grid<usize>, disparities: usize) -> Grid<f32> {
    let (width, height) = decided.size();
    Grid::from_fn(width, height, |x, y| {
        if let Ok(disparity) = decided[(x, y)] {
            return disparity;
        }
        let steps = (-1i64..=1).flat_map(|dy| (-1i64..=1).map(move |dx| (dx, dy))).filter(|step| *step != (0, 0));
        let nearest = |(dx, dy): (i64, i64)| {
            let on_way = (1i64..).map(|k| (x as i64 + k * dx, y as i64 + k * dy));
            let inside = on_way.take_while(|(x, y)| (0..width as i64).contains(x) && (0..height as i64).contains(y));
            inside.map(|(x, y)| decided[(x as usize, y as usize)]).find_map(|cell| cell.ok())
        };
        let mut around: Vec<f32> = steps.filter_map(nearest).collect();
        around.sort_by(f32::total_cmp);
        let is_met = (0..disparities.min(x + 1)).any(|d| right[(x - d, y)] == d);
        let last = around.len().saturating_sub(1);
        around.get(if is_met { last / 2 } else { last.min(1) }).copied().unwrap_or(f32::NAN)
    })
}

#[test]
fn semi_global_matching_is_what_it_is_defined_as() {
    let clip = scene((43, 26));
    let all = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)];
    for (paths, disparities, [p1, p2], fill, uniqueness) in [
        (8, 16, [10, 120], true, 5),
        (4, 33, [3, 40], false, 10),
        (8, 64, [192, 192], true, 0),
        (4, 2, [0, 0], false, 20),
        // P2 is at least P1.
        (8, 31, [50, 7], true, 5),
    ] {
        let sums = sums(&clip, disparities, [p1, p2.max(p1)], &all[..paths]);
        let tests = Tests { disparities, uniqueness, max_difference: 1, subpixel: true };
        let (expected, right) = decided(sums.size(), tests, |x, y, d| sums[(x, y)][d]);
        let expected =
            if fill { filled(&expected, &right, disparities) } else { expected.map(|cell| cell.unwrap_or(f32::NAN)) };
        let estimator = set(
            "semi-global-matching",
            &[
                ("paths", &paths.to_string()),
                ("disparities", &disparities.to_string()),
                ("p1", &p1.to_string()),
                ("p2", &p2.to_string()),
                ("fill", if fill { "on" } else { "off" }),
                ("uniqueness", &uniqueness.to_string()),
            ],
        );
        let what = format!("{paths} paths, {disparities} disparities, P1 {p1}, P2 {p2}");
        assert_same(&found(&*estimator, &clip), &expected, &what);
    }
}

#[test]
fn the_canyon_of_a_row_is_cut_through_the_costs_at_hand() {
    let (clip, disparities, (x, y)) = (scene((43, 26)), 16, (30, 12));
    let settings = [("paths", "4"), ("disparities", "16"), ("p1", "10"), ("p2", "120")];
    let mut walk = set("semi-global-matching", &settings).walk(&clip, 0).expect("a run");
    let [left, right] = views(&clip).map(|view| census(&view));
    for done in 0..=4 {
        walk.jump(Move::To(Cursor { unit: done, event: usize::MAX }));
        let sums = sums(&clip, disparities, [10, 120], &[(1, 0), (-1, 0), (0, 1), (0, -1)][..done]);
        let cost = |x: usize, d: usize| match done {
            0 => hamming(&left[(x, y)], &right[(x - d, y)]),
            _ => sums[(x, y)][d],
        };
        let step = walk.step(Some(Focus::current([x as f32, y as f32])));
        let surface = step.readouts.iter().find_map(|r| if let Readout::Landscape(of) = r { Some(of) } else { None });
        let surface = surface.expect("a canyon");
        // 24 px to the left, and to the right up to the border.
        assert_eq!(surface.values.size(), (37, disparities));
        for (d, column) in (0..disparities).flat_map(|d| (0..37).map(move |column| (d, column))) {
            let at = column + 6;
            let expected = if d <= at { cost(at, d) as f32 } else { f32::NAN };
            let value = surface.values[(column, d)];
            assert!(
                value == expected || value.is_nan() && expected.is_nan(),
                "{value} at x = {at}, d = {d} after {done}"
            );
        }
        let bed = surface.trail.iter().map(|at| surface.axes.at(*at));
        for (at, [x, d]) in (6..).zip(bed) {
            let least = (0..disparities.min(at + 1)).min_by_key(|d| cost(at, *d)).expect("a disparity");
            assert_eq!([x, d], [at as f32, least as f32], "the first of equal costs, after {done}");
        }
    }
}

/// All estimators of disparity.
fn all() -> Vec<Box<dyn AnyEstimator>> {
    let all: Vec<_> = estimators().into_iter().filter(|e| e.guarantee() == Guarantee::Disparity).collect();
    assert_eq!(all.len(), 2);
    all
}

#[test]
fn a_known_shift_is_recovered_and_steps_equal_runs() {
    for estimator in all() {
        for shift in [0i64, 3, 17] {
            let view = |by: i64| Grid::from_fn(96, 40, |x, y| texture(x as i64 + by, y as i64));
            let clip = pair(view(0), view(shift));
            let map = found(&*estimator, &clip);
            let id = estimator.info().id;
            let (mut sum, mut count) = (0.0, 0.0);
            for (x, y) in (6..34).flat_map(|y| (26..90).map(move |x| (x, y))) {
                let d = map.at(x, y).unwrap_or_else(|| panic!("{id}: nothing at ({x}, {y})"));
                assert_eq!(d.round(), shift as f32, "{id}: {d} px at ({x}, {y})");
                (sum, count) = (sum + (d - shift as f32).abs(), count + 1.0);
            }
            // A parabola through costs of whole bits is off by a fraction of a pixel here and there.
            assert!(sum / count < 0.1, "{id}: mean error {} px", sum / count);
            let mut walk = estimator.walk(&clip, 0).expect("a single frame with a right view is enough");
            let unit = walk.info().granularities.len() - 2;
            while !walk.at_end() {
                walk.jump(Move::Granularity(unit, Direction::Forward));
            }
            let three = estimator.run(&clip, 0, &Threads::new(3).expect("threads")).expect("a run");
            assert_eq!(walk.output(), three, "{id}");
        }
    }
}

fn sample(id: &str) -> Clip {
    let scene = synth::scene(id).expect("a scene");
    scene.clip(&scene.difficulty()).expect("sliders in range")
}

fn truth(clip: &Clip) -> Arc<Disparity> {
    clip.truth().expect("a truth").disparity(0).expect("disparities").expect("two views")
}

/// Share of the pixels for which `of` is true that are wrong by more than 3 px or have no disparity.
fn bad3(map: &Disparity, truth: &Disparity, of: impl Fn(usize, usize) -> bool) -> f64 {
    let (width, height) = truth.0.size();
    let part = Disparity(Grid::from_fn(width, height, |x, y| if of(x, y) { truth.0[(x, y)] } else { f32::NAN }));
    disparity_error(map, &part).expect("one size").map_or(1.0, |error| error.bad3)
}

#[test]
fn the_truth_of_a_scene_is_what_its_views_show() {
    for id in ["still-life", "stereo-traps"] {
        let clip = sample(id);
        let (truth, hidden) =
            (truth(&clip), clip.truth().expect("a truth").half_occlusion(0).expect("known").expect("two"));
        let [left, right] = views(&clip);
        let (mut sum, mut count, mut occluded) = (0.0, 0, 0);
        for (x, y) in (0..240).flat_map(|y| (0..320).map(move |x| (x, y))) {
            let d = truth.at(x, y).expect("every pixel shows something");
            assert!(d > 0.0 && d < 64.0, "{id}: {d} px");
            if hidden[(x, y)] {
                occluded += 1;
                continue;
            }
            sum += f64::from((right.sample(x as f32 - d, y as f32) - f32::from(left[(x, y)])).abs());
            count += 1;
        }
        assert!(sum / f64::from(count) < 5.0, "{id}: {} gray levels", sum / f64::from(count));
        assert!((3000..20_000).contains(&occluded), "{id}: {occluded} half-occluded pixels");
    }
}

#[test]
fn planes_and_spheres_with_texture_are_reconstructed() {
    let clip = sample("still-life");
    let (truth, hidden) =
        (truth(&clip), clip.truth().expect("a truth").half_occlusion(0).expect("known").expect("two"));
    for (id, most_bad, most_epe) in [("block-stereo", 0.12, 0.6), ("semi-global-matching", 0.04, 0.8)] {
        let output = set(id, &[]).run(&clip, 0, &Threads::single()).expect("a run");
        let field = output.get::<DisparityField>().expect("disparities");
        let bad = bad3(&field.map, &truth, |x, y| !hidden[(x, y)]);
        let error = disparity_error(&field.map, &truth).expect("one size").expect("compared");
        println!("{id}: {:.2} % bad where visible, {error:?}", 100.0 * bad);
        assert!(bad < most_bad, "{id}: {bad}");
        assert!(error.epe_px < most_epe, "{id}: {error:?}");
        let depths = field.depth_m().expect("a calibrated scene");
        // The middle of the near ball, whose centre is 1.45 m away and its radius 0.2 m.
        let near = depths[(184, 165)];
        assert!((1.2..1.3).contains(&near), "{id}: the near ball is about 1.25 m away, not {near}");
        let assessed = output.assess(&Reference { clip: &clip, frame: 0 }).expect("an assessment");
        let value = |key: &str| assessed.scores.iter().find(|s| s.measure.key == key).and_then(|s| s.value.real());
        assert_eq!(value("bad3_percent"), Some(100.0 * error.bad3));
        assert_eq!((value("bad1"), value("d1_percent")), (Some(error.bad1), Some(100.0 * error.d1)));
        assert_eq!(value("epe_px"), Some(error.epe_px));
        // The measured pixels alone: those that passed all tests, without the filled ones.
        let is_measured = |x: usize, y: usize| {
            field.map.0[(x, y)].is_finite() && field.filled.as_ref().is_none_or(|filled| !filled.get(x, y))
        };
        let places = (0..truth.0.height()).flat_map(|y| (0..truth.0.width()).map(move |x| (x, y)));
        let measured: Vec<_> = places.filter(|at| truth.0[*at].is_finite() && is_measured(at.0, at.1)).collect();
        let wrong = measured.iter().filter(|at| (field.map.0[**at] - truth.0[**at]).abs() > 3.0).count();
        let share = 100.0 * wrong as f64 / measured.len() as f64;
        let found = value("bad3_measured_percent").expect("measured pixels");
        assert!(
            (found - share).abs() < 1e-9 && share < 100.0 * error.bad3,
            "{id}: {found} % and {share} % of the measured"
        );
        let mut walk = set(id, &[]).walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        let said = walk.step(None).sentence.plain();
        assert!(said.contains(&format!("with a known truth, {share:.1} % are wrong")), "{id}: {said}");
    }
}

#[test]
fn stereo_fails_where_the_scene_of_traps_says() {
    let clip = sample("stereo-traps");
    let (truth, hidden) =
        (truth(&clip), clip.truth().expect("a truth").half_occlusion(0).expect("known").expect("two"));
    // By their depth: the trellis at 2 m, the panel without texture at 2.2 m; away from their edges.
    let is_deep = |x: usize, y: usize, d: f32| {
        (-12i64..=12).all(|dx| truth.0.get((x as i64 + dx) as usize, y).is_some_and(|other| (other - d).abs() < 0.01))
    };
    let trellis = |x: usize, y: usize| is_deep(x, y, 18.0) && !hidden[(x, y)];
    let blank = |x: usize, y: usize| is_deep(x, y, 36.0 / 2.2) && !hidden[(x, y)];
    let wall = |x: usize, y: usize| is_deep(x, y, 9.0) && !hidden[(x, y)];
    let map = found(&*set("block-stereo", &[]), &clip);
    let shares = [
        bad3(&map, &truth, trellis),
        bad3(&map, &truth, blank),
        bad3(&map, &truth, |x, y| hidden[(x, y)]),
        bad3(&map, &truth, wall),
    ];
    println!("block stereo: {shares:?}");
    let [trellis_bad, blank_bad, hidden_bad, wall_bad] = shares;
    assert!(trellis_bad > 0.9, "a texture that repeats is ambiguous: {trellis_bad}");
    assert!(blank_bad > 0.9, "no texture is ambiguous: {blank_bad}");
    assert!(hidden_bad > 0.5, "half-occluded pixels have no match: {hidden_bad}");
    assert!(wall_bad < 0.05, "the wall has texture: {wall_bad}");
    let map = found(&*set("semi-global-matching", &[]), &clip);
    println!(
        "semi-global matching: {:?}",
        [
            bad3(&map, &truth, trellis),
            bad3(&map, &truth, blank),
            bad3(&map, &truth, |x, y| hidden[(x, y)]),
            bad3(&map, &truth, wall)
        ]
    );
    assert!(bad3(&map, &truth, wall) < 0.02);
}

#[test]
fn smoothness_resolves_what_a_window_cannot() {
    let clip = sample("still-life");
    let truth = truth(&clip);
    let share = |estimator: &dyn AnyEstimator| bad3(&found(estimator, &clip), &truth, |_, _| true);
    let block = share(&*set("block-stereo", &[]));
    let [four, eight] = ["4", "8"].map(|paths| share(&*set("semi-global-matching", &[("paths", paths)])));
    let alone = share(&*set("semi-global-matching", &[("p1", "0"), ("p2", "0")]));
    println!("block {block}, without penalties {alone}, four {four}, eight {eight}");
    assert!(eight < block && four < block && eight < alone);
}

#[test]
fn census_withstands_a_change_of_brightness_that_sad_does_not() {
    let clip = sample("still-life");
    let truth = truth(&clip);
    let [left, right] = views(&clip);
    let darker = pair(left, right.map(|v| (f32::from(*v) * 0.7 + 5.0) as u8));
    let share = |cost| bad3(&found(&*set("block-stereo", &[("cost", cost)]), &darker), &truth, |_, _| true);
    let [sad, census] = ["sad", "census"].map(share);
    println!("sad {sad}, census {census}");
    assert!(census < 0.35 && sad > 1.5 * census, "SAD {sad}, census {census}");
}

#[test]
fn bad_input_is_refused_or_reported_with_the_reason() {
    let view = |width, by: i64| Grid::from_fn(width, 40, |x, y| texture(x as i64 + by, y as i64));
    let one = |gray| Clip::from_frames("view", vec![Frame::gray(gray)]).expect("a frame");
    let refused = one(view(96, 0)).with_right(one(view(90, 5))).expect_err("sizes differ").to_string();
    assert!(refused.contains("96×40 px") && refused.contains("90×40 px"), "{refused}");
    for estimator in all() {
        let id = estimator.info().id;
        assert!(estimator.walk(&one(view(96, 0)), 0).is_err(), "{id}: there is no second view");
        let clip = pair(view(96, 5), view(96, 0));
        let mut walk = estimator.walk(&clip, 0).expect("a walk");
        assert!(walk.step(None).sentence.plain().contains("swapped"), "{id}: swapped views are reported at the start");
        walk.jump(Move::End);
        assert!(walk.step(None).sentence.plain().contains("exchange left and right"), "{id}");
        let facts = walk.output().assess(&Reference { clip: &clip, frame: 0 }).expect("an assessment").facts;
        let value = |label: &str| facts.iter().find(|fact| fact.label == label).map(|fact| fact.value.clone());
        assert!(value("Views").is_some_and(|views| views.contains("swapped")), "{id}: {facts:?}");
        assert!(value("Range of depth").is_some_and(|depth| depth.contains("focal length")), "{id}: {facts:?}");
        let sound = pair(view(96, 0), view(96, 5));
        let said = estimator.walk(&sound, 0).expect("a walk").step(None).sentence.plain();
        assert!(!said.contains("swapped"), "{id}: {said}");
    }
}

#[test]
fn a_step_shows_both_views_and_the_epipolar_line_between_them() {
    let calibration = Calibration::new(300.0, 0.12, [47.5, 19.5]).expect("possible");
    let view = |by: i64| Grid::from_fn(96, 40, |x, y| texture(x as i64 + by, y as i64));
    let clip = pair(view(0), view(9)).with_calibration(calibration);
    for estimator in all() {
        let id = estimator.info().id;
        let mut walk = estimator.walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        let focus = Some(Focus::current([60.0, 20.0]));
        let scene = walk.scene(focus);
        let shown: Vec<_> = scene.pictures.iter().map(|canvas| canvas.picture).collect();
        assert!(shown.starts_with(&[Picture::CURRENT, Picture::RIGHT]), "{id}: {shown:?}");
        let [(from, [x, y]), (to, [match_x, match_y])] = scene.links.first().expect("the match").ends;
        assert_eq!((from, to, [x, y], match_y), (Picture::CURRENT, Picture::RIGHT, [60.0, 20.0], 20.0), "{id}");
        assert!((match_x - 51.0).abs() < 0.3, "{id}: {match_x}");
        let step = walk.step(focus);
        let depth = common::fact(&step, "Depth").expect("a calibrated pair");
        assert!(depth.starts_with("4.0") || depth.starts_with("3.9"), "{id}: {depth} is not about 4 m");
    }
}
