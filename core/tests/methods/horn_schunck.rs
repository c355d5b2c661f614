//! Horn and Schunck's method against a plain one, and what all methods on levels and warps tell.

use crate::common::{central, equation, explained_at, fact, flow, linear_motion, numbers, plane, plotted, point, set};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Flow, Frame};
use motionscope_core::products::DenseField;
use motionscope_core::run::{Cursor, Direction, Move};
use motionscope_core::scene::{Focus, Quantity, Step};
use motionscope_core::synth;

/// Horn and Schunck's method as plainly as can be: one level, central differences, Jacobi iterations, all in f64.
fn plain_horn_schunck(clip: &Clip, alpha: f64, iterations: usize) -> Vec<[f64; 2]> {
    let [a, b] = clip.pair(0).expect("a pair");
    let (width, height) = clip.size();
    let inside =
        |x: isize, y: isize| (x.clamp(0, width as isize - 1) as usize, y.clamp(0, height as isize - 1) as usize);
    let value = |frame: &Frame, x: isize, y: isize| f64::from(frame.luma()[inside(x, y)]);
    let mean = |x: isize, y: isize| (value(&a, x, y) + value(&b, x, y)) / 2.0;
    let mut field = vec![[0.0f64; 2]; width * height];
    for _ in 0..iterations {
        let before = field.clone();
        for y in 0..height as isize {
            for x in 0..width as isize {
                let at = |i: isize, j: isize, part: usize| {
                    let (x, y) = inside(x + i, y + j);
                    before[y * width + x][part]
                };
                let average = [0, 1].map(|p| {
                    (at(1, 0, p) + at(-1, 0, p) + at(0, 1, p) + at(0, -1, p)) / 6.0
                        + (at(1, 1, p) + at(-1, 1, p) + at(1, -1, p) + at(-1, -1, p)) / 12.0
                });
                let ix = central(|x| mean(x, y), x, width);
                let iy = central(|y| mean(x, y), y, height);
                let it = value(&b, x, y) - value(&a, x, y);
                let off = (ix * average[0] + iy * average[1] + it) / (alpha * alpha + ix * ix + iy * iy);
                field[y as usize * width + x as usize] = [average[0] - ix * off, average[1] - iy * off];
            }
        }
    }
    field
}

const PAPER: [(&str, &str); 6] = [
    ("levels", "1"),
    ("warps", "1"),
    ("sigma", "0"),
    ("derivatives", "central"),
    ("alpha", "10"),
    ("solver", "jacobi"),
];

#[test]
fn horn_schunck_agrees_with_a_plain_one() {
    let (clip, _) = linear_motion([[0.0, -0.01], [0.01, 0.0]], [0.3, -0.2]);
    // More than are done at once while the rows are in the cache, and not a multiple of it.
    let found = flow("horn-schunck", &[&PAPER[..], &[("iterations", "41")]].concat(), &clip);
    let plain = plain_horn_schunck(&clip, 10.0, 41);
    for (found, plain) in found.0.cells().iter().zip(plain) {
        assert!((0..2).all(|i| (f64::from(found[i]) - plain[i]).abs() < 1e-4), "{found:?}, plainly {plain:?}");
    }
}

#[test]
fn all_solvers_come_to_the_same_field_and_the_faster_ones_sooner() {
    let (clip, _) = linear_motion([[0.02, 0.0], [0.0, 0.02]], [0.3, 0.0]);
    let solve = |solver, iterations| {
        let more = [("solver", solver), ("iterations", iterations), ("relaxation", "1.7")];
        flow("horn-schunck", &[&PAPER[..], &more].concat(), &clip)
    };
    let end = solve("jacobi", "1000");
    let off = |other: &Flow| -> f32 {
        let pairs = other.0.cells().iter().flatten().zip(end.0.cells().iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    assert!(off(&solve("gauss-seidel", "600")) < 1e-3 && off(&solve("sor", "300")) < 1e-3);
    let [jacobi, gauss_seidel, sor] = ["jacobi", "gauss-seidel", "sor"].map(|solver| off(&solve(solver, "20")));
    assert!(sor < gauss_seidel && gauss_seidel < jacobi, "{sor} {gauss_seidel} {jacobi}");
}

#[test]
fn energy_never_rises_and_the_error_falls() {
    let scene = synth::scene("sub-pixel").unwrap();
    let clip = scene.clip(&scene.difficulty()).unwrap();
    for solver in ["jacobi", "gauss-seidel", "sor"] {
        let settings = [("levels", "1"), ("warps", "1"), ("iterations", "60"), ("solver", solver)];
        let estimator = set("horn-schunck", &settings);
        let energy = plotted(&*estimator, &clip, "Energy per pixel", "energy");
        assert_eq!(energy.len(), 60);
        assert!(energy.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{solver}: {energy:?}");
        let error = plotted(&*estimator, &clip, "Mean endpoint error", "mean endpoint error");
        assert!(error[59] < 0.5 * error[0], "{solver}: {} px, then {}", error[0], error[59]);
    }
}

#[test]
fn the_default_solver_is_no_less_exact_than_a_hundred_jacobi_iterations() {
    for scene in ["pillar", "flat-wall", "spin-zoom", "sub-pixel", "translation"] {
        let scene = synth::scene(scene).unwrap();
        let clip = scene.clip(&scene.difficulty()).unwrap();
        let truth = clip.truth().and_then(|truth| truth.flow(0).ok().flatten()).unwrap();
        let error = |id, settings: &[(&str, &str)]| {
            let found = flow(id, settings, &clip);
            let off = |(a, b): (&[f32; 2], &[f32; 2])| f64::from((a[0] - b[0]).hypot(a[1] - b[1]));
            let off: Vec<_> = found.0.cells().iter().zip(truth.0.cells()).map(off).filter(|e| e.is_finite()).collect();
            off.iter().sum::<f64>() / off.len() as f64
        };
        for id in ["horn-schunck", "clg"] {
            let [sor, jacobi] = [error(id, &[]), error(id, &[("solver", "jacobi"), ("iterations", "100")])];
            assert!(sor < 1.02 * jacobi, "{id} on {}: {sor} px, {jacobi} px", scene.id);
        }
    }
}

#[test]
fn horn_schunck_stops_when_little_changes() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.3, 0.1]);
    let estimator = set("horn-schunck", &[&PAPER[..], &[("tolerance", "0.002"), ("iterations", "500")]].concat());
    let mut walk = estimator.walk(&clip, 0).unwrap();
    assert_eq!(walk.units(), None, "nobody knows before");
    walk.jump(Move::End);
    let units = walk.units().expect("the end is reached");
    assert!((5..400).contains(&units), "{units} iterations");
    assert_eq!(walk.output(), estimator.run(&clip, 0, &Threads::new(2).unwrap()).unwrap());
    let change = plotted(&*estimator, &clip, "Mean change", "mean change");
    // The criterion is tested every 8 iterations.
    assert!(units % 8 == 0 && change[units - 1] < 0.002 && change[units - 9] >= 0.002);
}

#[test]
fn the_update_that_is_reported_is_the_one_that_is_done() {
    let (clip, _) = linear_motion([[0.01, 0.0], [0.0, 0.01]], [0.2, 0.4]);
    for (solver, relaxation) in [("jacobi", 1.0), ("gauss-seidel", 1.0), ("sor", 1.9f32)] {
        let estimator = set("horn-schunck", &[&PAPER[..], &[("solver", solver), ("relaxation", "1.9")]].concat());
        let mut walk = estimator.walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor { unit: 6, event: usize::MAX }));
        let focus = [40.0, 30.0];
        let Some(field) = walk.output().get::<DenseField>().cloned() else { panic!("a dense field") };
        let last = walk.step(Some(Focus::current(focus)));
        let after = field.flow.at(40, 30).unwrap();
        the_last_numbers_are(&last, after);
        let mut name = "after";
        let mut step = last.clone();
        if solver == "sor" {
            let said = last.sentence.plain();
            assert!(said.starts_with("SOR extrapolates the Gauss–Seidel update by ω = 1.90"), "{said}");
            assert_eq!(point(&last, "after"), after);
            walk.jump(Move::Granularity(4, Direction::Back));
            (name, step) = ("Gauss–Seidel", walk.step(Some(Focus::current(focus))));
            assert_eq!(point(&step, name), point(&last, name));
        }
        let [before, mean, told] = ["before", "mean", name].map(|name| point(&step, name));
        the_last_numbers_are(&step, told);
        let [a, b, c] = plane(&step).lines[0].factors;
        let off = (a * mean[0] + b * mean[1] + c) / (100.0 + a * a + b * b);
        let update = [mean[0] - a * off, mean[1] - b * off];
        assert!((0..2).all(|i| (update[i] - told[i]).abs() < 1e-4), "{solver}: {update:?}, told {told:?}");
        let computed = [0, 1].map(|i| before[i] + relaxation * (update[i] - before[i]));
        assert!((0..2).all(|i| (computed[i] - after[i]).abs() < 1e-4), "{solver}: {computed:?}, done {after:?}");
        walk.jump(Move::Granularity(4, Direction::Back));
        let step = walk.step(Some(Focus::current(focus)));
        assert!(step.sentence.plain().contains("pixel (40, 30)"));
        the_mean_alone_is_told(&step, mean);
    }
}

/// The last numbers of the formula and of the sentence are `to`.
fn the_last_numbers_are(step: &Step, to: [f32; 2]) {
    let last = equation(step).pop().expect("a formula");
    assert!((numbers(&last).pop().expect("a number") - f64::from(to[1])).abs() < 2e-3, "{last}");
    let said = step.sentence.plain();
    let [.., u, v] = numbers(&said)[..] else { panic!("two numbers: {said}") };
    assert!((u - f64::from(to[0])).abs() < 2e-3 && (v - f64::from(to[1])).abs() < 2e-3, "{said}");
}

/// The step before the update knows nothing of its result: neither the formula nor the plane has it.
fn the_mean_alone_is_told(step: &Step, mean: [f32; 2]) {
    let lines = equation(step);
    assert_eq!(lines.len(), 2, "{lines:?}");
    for (line, mean) in lines.iter().zip(mean) {
        assert!((numbers(line).pop().expect("a number") - f64::from(mean)).abs() < 6e-4, "{line}");
    }
    assert!(plane(step).points.iter().all(|(name, ..)| *name != "after"));
}

#[test]
fn the_step_of_the_mean_does_not_tell_the_result_of_the_update() {
    let (clip, _) = linear_motion([[0.01, 0.0], [0.0, 0.01]], [0.2, 0.4]);
    for id in ["horn-schunck", "clg"] {
        let estimator = set(id, &[("levels", "1"), ("warps", "1"), ("iterations", "8"), ("sigma", "0")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let mut at = |event| {
            walk.jump(Move::To(Cursor { unit: 6, event }));
            walk.step(Some(Focus::current([40.0, 30.0])))
        };
        // The mean, the update and its extrapolation are the last events of an iteration.
        let (mean, update) = (at(1), at(2));
        the_mean_alone_is_told(&mean, point(&mean, "mean"));
        let after = point(&update, "Gauss–Seidel");
        assert!(
            equation(&update).iter().flat_map(|line| numbers(line)).any(|n| (n - f64::from(after[0])).abs() < 6e-4)
        );
    }
}

#[test]
fn what_a_later_warp_tells_of_a_pixel_can_be_recomputed() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, -0.6]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "1"), ("warps", "2"), ("iterations", "30"), ("sigma", "0")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        // An iteration in the middle of the second warp: the update of Horn–Schunck comes after the mean.
        let event = if id == "horn-schunck" { 2 } else { 1 };
        walk.jump(Move::To(Cursor { unit: 40, event }));
        let step = walk.step(Some(Focus::current([40.0, 30.0])));
        let [x, y, t] = numbers(&fact(&step, "I_x, I_y, I_t").unwrap())[..] else { panic!("three") };
        let [u, v] = numbers(&fact(&step, "Linearised at").unwrap())[..] else { panic!("two") };
        assert!(t.abs() < 2.0 && (u - 1.3).abs() < 0.2 && (v + 0.6).abs() < 0.2, "{id}: little is left to find");
        if id == "horn-schunck" {
            let (lines, [mean_u, mean_v]) = (equation(&step), point(&step, "mean"));
            let off = x * (f64::from(mean_u) - u) + y * (f64::from(mean_v) - v) + t;
            assert!((numbers(&lines[1])[2] - off).abs() < 0.02 * (1.0 + off.abs()), "{off}: {lines:?}");
            assert!(lines[0].contains("u_0"), "{lines:?}");
        }
        if id == "tv-l1" {
            let lines = equation(&step);
            let c = numbers(&lines[1]).pop().unwrap();
            assert!((c - (t - x * u - y * v)).abs() < 0.02 * (1.0 + c.abs()), "{id}: {lines:?}");
            assert!(lines[2].contains(" + c"), "{id}: {lines:?}");
        }
    }
}

#[test]
fn displacements_on_a_level_are_reported_in_its_px_and_as_on_the_picture() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [2.4, -1.2]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "2"), ("warps", "1"), ("iterations", "20")]);
        let coarse = explained_at(&*estimator, &clip, 19, [40.0, 30.0]);
        assert!(fact(&coarse, "Flow before").is_some_and(|value| value.ends_with("px of level 1")), "{id}");
        let (on_level, on_picture) = (point(&coarse, "after"), numbers(&fact(&coarse, "At full resolution").unwrap()));
        for i in 0..2 {
            assert!((2.0 * f64::from(on_level[i]) - on_picture[i]).abs() < 0.01, "{id}: {on_level:?}, {on_picture:?}");
        }
        let fine = explained_at(&*estimator, &clip, 39, [40.0, 30.0]);
        assert!(
            fact(&fine, "Flow before").is_some_and(|value| value.ends_with(" px"))
                && fact(&fine, "At full resolution").is_none()
        );
    }
}

#[test]
fn without_a_pointer_one_pixel_is_explained_in_all_iterations() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, -0.6]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "2"), ("warps", "2"), ("iterations", "4")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let mut told = Vec::new();
        for unit in 0..16 {
            walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
            told.push(numbers(&fact(&walk.step(None), "Pixel").unwrap()));
        }
        // Level 1, then level 0: two warps of four iterations each, at one position of the picture.
        let (coarse, fine) = told.split_at(8);
        assert!(
            coarse.iter().all(|pixel| *pixel == coarse[0]) && fine.iter().all(|pixel| *pixel == fine[0]),
            "{id}: {told:?}"
        );
        let halved = fine[0].iter().map(|c| ((c + 0.5) / 2.0).floor()).collect::<Vec<_>>();
        assert_eq!(coarse[0], halved, "{id}");
        // A pointer leads elsewhere, and the pixel is back when it has gone.
        let pointed = fact(&walk.step(Some(Focus::current([40.0, 30.0]))), "Pixel").unwrap();
        assert_eq!(numbers(&pointed), [40.0, 30.0]);
        assert_eq!(numbers(&fact(&walk.step(None), "Pixel").unwrap()), fine[0]);
    }
}

#[test]
fn medians_are_reported_where_they_are_taken() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.4, 0.2]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "2"), ("warps", "2"), ("iterations", "3")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let mut at = |unit, event| {
            walk.jump(Move::To(Cursor { unit, event }));
            let step = walk.step(None);
            (step.line.as_str(), step.sentence.plain())
        };
        let first = at(0, 1);
        assert!(first.1.contains("the flow is still 0") && first.0 == "warp", "{id}: {first:?}");
        for (unit, is_enlarged) in [(3, false), (6, true), (9, false)] {
            let (line, said) = at(unit, 1);
            assert!(line == "take-medians" && said.contains("median"), "{id}: {line}: {said}");
            assert_eq!(said.contains("upsampled"), is_enlarged, "{id}: {said}");
            assert!(at(unit, 2).1.contains("warped toward frame t by the current flow"), "{id}");
        }
    }
}

#[test]
fn the_tolerance_is_in_px_of_the_picture_on_every_level() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, 0.8]);
    let settings = [("levels", "3"), ("warps", "2"), ("tolerance", "0.004"), ("iterations", "400")];
    let estimator = set("horn-schunck", &settings);
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    let change = plotted(&*estimator, &clip, "Mean change", "mean change");
    let mut ends = 0;
    for (unit, change) in change.iter().enumerate() {
        walk.jump(Move::To(Cursor { unit, event: 1 }));
        // The criterion is tested every 8 iterations.
        let is_tested = walk.place()[3].index % 8 == 7;
        walk.jump(Move::To(Cursor { unit: unit + 1, event: 1 }));
        let is_last = unit + 1 == walk.units().unwrap() || walk.place()[3].index == 0;
        assert_eq!(is_tested && *change < 0.004, is_last, "iteration {unit} changes by {change}");
        ends += usize::from(is_last);
    }
    assert_eq!(ends, 6, "two warps on three levels");
}

#[test]
fn the_share_of_the_smoothness_term_is_that_of_the_update() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.6, 0.3]);
    let mut walk =
        set("horn-schunck", &[("levels", "1"), ("warps", "1"), ("alpha", "4"), ("sigma", "0")]).walk(&clip, 0).unwrap();
    walk.jump(Move::To(Cursor { unit: 3, event: 2 }));
    let layers = walk.scene(None).layers;
    assert_eq!(layers.iter().map(|layer| layer.quantity).collect::<Vec<_>>(), [Quantity::SmoothnessShare]);
    let shares = layers[0].values();
    for (x, y) in [(20, 20), (48, 40), (70, 11)] {
        let step = walk.step(Some(Focus::current([x as f32, y as f32])));
        let sentence = step.sentence.plain();
        let (_, covered) = sentence.split_once("covers ").expect("the way to the constraint line");
        assert!(
            (100.0 * f64::from(shares[(x, y)]) + numbers(covered)[0] - 100.0).abs() < 0.51,
            "{sentence}: {}",
            shares[(x, y)]
        );
    }
}
