//! Fractions of a pixel and the price of a displacement, against plain references and exact truth.

use motionscope_core::base::Threads;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::BlockField;
use motionscope_core::run::{AnyEstimator, Cursor, Move};
use motionscope_core::scene::{Math, Readout};

/// Waves by their angular frequency along x and y in rad/px, and their phase.
type Waves = [(f64, f64, f64); 4];
/// To all sides.
const WAVES: Waves = [(0.31, 0.12, 1.0), (-0.17, 0.41, 2.0), (0.55, -0.33, 0.3), (0.09, 0.63, 4.0)];
/// Along the axes, so that the valley of the squared differences lies along them too.
const UPRIGHT: Waves = [(0.31, 0.0, 1.0), (0.0, 0.41, 2.0), (0.55, 0.0, 0.3), (0.0, 0.63, 4.0)];

/// A smooth texture that moves by `[u, v]` px from the first frame to the second.
fn moving(waves: Waves, [u, v]: [f64; 2]) -> Clip {
    let texture =
        |x: f64, y: f64| 127.5 + waves.map(|(p, q, phase)| 28.0 * (p * x + q * y + phase).sin()).iter().sum::<f64>();
    let frame = |dx: f64, dy: f64| {
        Frame::gray(Grid::from_fn(96, 80, |x, y| texture(x as f64 - dx, y as f64 - dy).round() as u8))
    };
    Clip::from_frames("waves", vec![frame(0.0, 0.0), frame(u, v)]).expect("a clip")
}

fn searches() -> impl Iterator<Item = Box<dyn AnyEstimator>> {
    estimators().into_iter().filter(|estimator| estimator.info().family == "Block matching")
}

fn field(search: &dyn AnyEstimator, clip: &Clip, settings: &[(&str, &str)]) -> BlockField {
    let mut search = search.boxed_clone();
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("it has it"));
    let Some(field) = search.run(clip, 0, &Threads::single()).expect("a run").get::<BlockField>().cloned() else {
        panic!("no blocks")
    };
    field
}

fn vectors(field: &BlockField) -> Vec<([f32; 2], f64)> {
    field.vectors.iter().map(|vector| vector.map(|v| (v.displacement, v.cost)).expect("searched")).collect()
}

/// The value at quarters of a pixel, written out as the standard has it (ITU-T H.264, 8.4.2.2.1), or bilinear.
fn plain_value(picture: &Gray, filter: &str, qx: i64, qy: i64) -> i64 {
    let last = (picture.width() as i64 - 1, picture.height() as i64 - 1);
    let p = |x: i64, y: i64| i64::from(picture[(x.clamp(0, last.0) as usize, y.clamp(0, last.1) as usize)]);
    let (x, y, fx, fy) = (qx.div_euclid(4), qy.div_euclid(4), qx.rem_euclid(4), qy.rem_euclid(4));
    if filter == "bilinear" {
        let sum = (4 - fx) * (4 - fy) * p(x, y)
            + fx * (4 - fy) * p(x + 1, y)
            + (4 - fx) * fy * p(x, y + 1)
            + fx * fy * p(x + 1, y + 1);
        return (sum + 8) / 16;
    }
    let six = |f: &dyn Fn(i64) -> i64| f(-2) - 5 * f(-1) + 20 * f(0) + 20 * f(1) - 5 * f(2) + f(3);
    let clip = |v: i64| v.clamp(0, 255);
    let b = |x: i64, y: i64| clip((six(&|i| p(x + i, y)) + 16) >> 5);
    let h = |x: i64, y: i64| clip((six(&|j| p(x, y + j)) + 16) >> 5);
    let j = clip((six(&|j| six(&|i| p(x + i, y + j))) + 512) >> 10);
    let mean = |a: i64, b: i64| (a + b + 1) >> 1;
    match (fx, fy) {
        (0, 0) => p(x, y),
        (1, 0) => mean(p(x, y), b(x, y)),
        (2, 0) => b(x, y),
        (3, 0) => mean(b(x, y), p(x + 1, y)),
        (0, 1) => mean(p(x, y), h(x, y)),
        (0, 2) => h(x, y),
        (0, 3) => mean(h(x, y), p(x, y + 1)),
        (1, 1) => mean(b(x, y), h(x, y)),
        (2, 1) => mean(b(x, y), j),
        (3, 1) => mean(b(x, y), h(x + 1, y)),
        (1, 2) => mean(h(x, y), j),
        (2, 2) => j,
        (3, 2) => mean(j, h(x + 1, y)),
        (1, 3) => mean(h(x, y), b(x, y + 1)),
        (2, 3) => mean(j, b(x, y + 1)),
        _ => mean(h(x + 1, y), b(x, y + 1)),
    }
}

/// The best of the half pixels around `start`, then of the quarters around that, none outside the window.
fn plain_refinement(clip: &Clip, block: usize, grid: &BlockField, start: [f32; 2], filter: &str) -> ([f32; 2], f64) {
    let [current, next] = clip.pair(0).expect("a pair");
    let (at, (width, height)) = (grid.blocks.block(block), current.size());
    let cost = |[u, v]: [i64; 2]| -> i64 {
        let pixels = (0..at.height).flat_map(|y| (0..at.width).map(move |x| ((at.x + x) as i64, (at.y + y) as i64)));
        let difference = |(x, y): (i64, i64)| {
            let there = plain_value(next.luma(), filter, 4 * x + u, 4 * y + v);
            (i64::from(current.luma()[(x as usize, y as usize)]) - there).abs()
        };
        pixels.map(difference).sum()
    };
    // ±7 px, inside the picture.
    let reach = |start: usize, length: usize, extent: usize| {
        (-4 * 7.min(start as i64), 4 * 7.min((extent - start - length) as i64))
    };
    let (across, down) = (reach(at.x, at.width, width), reach(at.y, at.height, height));
    let allowed = |[u, v]: [i64; 2]| (across.0..=across.1).contains(&u) && (down.0..=down.1).contains(&v);
    let mut best = start.map(|c| (4.0 * c) as i64);
    for step in [2, 1] {
        let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| [i * step, j * step]));
        let points = around.map(|[i, j]| [best[0] + i, best[1] + j]).filter(|&point| allowed(point));
        best = points.min_by_key(|&[u, v]| (cost([u, v]), u * u + v * v, v, u)).expect("the centre");
    }
    (best.map(|c| c as f32 / 4.0), cost(best) as f64)
}

/// The numbers in a text, in order.
fn numbers(text: &str) -> Vec<f64> {
    let text = text.replace('−', "-").replace('\u{202f}', "");
    let parts = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    parts.filter_map(|part| part.trim_end_matches('.').parse().ok()).collect()
}

/// What is told at an event: the lines of its formula, and its facts.
type Explained = (Vec<String>, Vec<(&'static str, String)>);

/// What is told at each event of block 7 of `id`.
fn explained(id: &str, settings: &[(&str, &str)]) -> Vec<Explained> {
    let mut search = estimator(id).expect("it");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("it has it"));
    let mut walk = search.walk(&moving(WAVES, [2.25, -1.5]), 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit: 7, event: usize::MAX }));
    let events = walk.events();
    let mut told = Vec::new();
    for event in 1..=events {
        walk.jump(Move::To(Cursor { unit: 7, event }));
        let (mut lines, mut facts) = (Vec::new(), Vec::new());
        for readout in walk.step(None).readouts {
            match readout {
                Readout::Equation(math) => lines.extend(math.iter().map(Math::plain)),
                Readout::Facts(all) => facts.extend(all.into_iter().map(|fact| (fact.label, fact.value))),
                _ => {}
            }
        }
        told.push((lines, facts));
    }
    told
}

#[test]
fn the_price_of_a_displacement_is_reported_with_its_numbers() {
    let mut priced = 0;
    for (lines, facts) in
        explained("diamond", &[("subpixel", "quarter"), ("lambda", "2.5"), ("interpolation", "six-tap")])
    {
        let Some(line) = lines.iter().find(|line| line.starts_with("SAD + λR")) else { continue };
        let [distortion, lambda, bits, cost] = numbers(line)[..] else { panic!("four numbers: {line}") };
        assert_eq!((lambda, cost), (2.5, distortion + lambda * bits), "{line}");
        let candidate = facts.iter().find(|(label, _)| ["Candidate", "Displacement", "Best so far"].contains(label));
        assert_eq!(numbers(&candidate.expect("it is told").1).last(), Some(&cost), "{facts:?}");
        priced += 1;
    }
    assert!(priced > 25, "{priced} candidates and their ends were told");
}

#[test]
fn a_parabola_is_reported_with_the_costs_it_goes_through() {
    let told = explained("full-search", &[("subpixel", "parabola"), ("cost", "ssd"), ("search-range", "4")]);
    let mut lines = told.iter().flat_map(|(lines, _)| lines).filter(|line| line.starts_with(['u', 'v']));
    for name in ["u", "v"] {
        let line = lines.next().expect("one along u and one along v");
        let [whole, before, after, _, again, _, at, last, found] = numbers(line)[..] else { panic!("numbers: {line}") };
        assert!(line.starts_with(name) && (before, after) == (again, last), "{line}");
        let expected = whole + (before - after) / (2.0 * (before - 2.0 * at + after));
        assert!((found - expected).abs() < 0.006, "{line}: {expected}");
    }
}

#[test]
fn thresholds_in_gray_levels_leave_the_price_out() {
    // Everything fits within 16 gray levels, so one candidate is enough, however dear its bits.
    let clip = moving(WAVES, [0.1, 0.0]);
    let predictive = estimator("predictive").expect("it");
    let found = field(&*predictive, &clip, &[("termination-threshold", "16"), ("lambda", "100")]);
    assert_eq!(found.candidates() as usize, found.vectors.len());
}

#[test]
fn every_search_is_refined_as_a_plain_reference_refines_it() {
    let clip = moving(WAVES, [2.25, -1.5]);
    for search in searches() {
        for filter in ["bilinear", "six-tap"] {
            let common = [("block-size", "16"), ("search-range", "7"), ("interpolation", filter)];
            let whole = field(&*search, &clip, &common);
            let refined = field(&*search, &clip, &[&common[..], &[("subpixel", "quarter")]].concat());
            for (i, (start, found)) in vectors(&whole).into_iter().zip(vectors(&refined)).enumerate() {
                let expected = plain_refinement(&clip, i, &whole, start.0, filter);
                assert_eq!(found, expected, "{} {filter} block {i}", search.info().id);
            }
        }
    }
}

/// Mean and largest distance of the displacements from `truth`, over the blocks that move inside the picture.
fn errors(field: &BlockField, truth: [f64; 2]) -> (f64, f64) {
    let (columns, rows) = field.blocks.counts();
    let inner = |i: &usize| (1..columns - 1).contains(&(i % columns)) && (1..rows - 1).contains(&(i / columns));
    let vectors = vectors(field);
    let off = (0..vectors.len()).filter(inner).map(|i| {
        let [u, v] = vectors[i].0;
        (f64::from(u) - truth[0]).hypot(f64::from(v) - truth[1])
    });
    let off: Vec<_> = off.collect();
    (off.iter().sum::<f64>() / off.len() as f64, off.into_iter().fold(0.0, f64::max))
}

#[test]
fn fractions_of_a_pixel_are_found() {
    let full = estimator("full-search").expect("it");
    for truth in [[1.25, -2.75], [0.5, 0.5], [-3.0, 1.75], [0.25, 0.0]] {
        let clip = moving(WAVES, truth);
        let found = |settings: &[(&str, &str)]| errors(&field(&*full, &clip, settings), truth);
        for filter in ["bilinear", "six-tap"] {
            assert_eq!(found(&[("subpixel", "quarter"), ("interpolation", filter)]), (0.0, 0.0), "{truth:?} {filter}");
        }
        let half = found(&[("subpixel", "half"), ("cost", "ssd")]).1;
        assert!(half <= 0.25f64.hypot(0.25) + 1e-6, "{truth:?}: {half}");
        let upright = moving(UPRIGHT, truth);
        let (_, most) = errors(&field(&*full, &upright, &[("subpixel", "parabola"), ("cost", "ssd")]), truth);
        assert!(most < 0.1, "{truth:?}: {most}");
    }
}

#[test]
fn a_fitted_parabola_finds_what_no_quarter_can() {
    let (full, truth) = (estimator("full-search").expect("it"), [1.4, -0.85]);
    let clip = moving(UPRIGHT, truth);
    let of = |subpixel| errors(&field(&*full, &clip, &[("subpixel", subpixel), ("cost", "ssd")]), truth).0;
    let [none, half, quarter, parabola] = ["none", "half", "quarter", "parabola"].map(of);
    assert!(none > half && half > quarter && quarter > parabola, "{none} {half} {quarter} {parabola}");
}

/// Bits of a number in the signed Exp-Golomb code, by writing the code words down: 1, 010, 011, 00100, …
fn plain_bits(v: i64) -> i64 {
    let number = if v > 0 { 2 * v } else { 1 - 2 * v };
    let digits = format!("{number:b}").len() as i64;
    2 * digits - 1
}

#[test]
fn full_search_with_lambda_finds_the_cheapest_displacement_to_send() {
    let texture = |x: usize, y: usize| ((x * x * 7 + y * y * 3 + x * y * 5) / 16 % 97) as u8;
    let frames = [Grid::from_fn(40, 40, texture), Grid::from_fn(40, 40, |x, y| texture(x + 2, y + 1) / 8 * 8)];
    let clip = Clip::from_frames("texture", frames.iter().cloned().map(Frame::gray).collect()).expect("a clip");
    let full = estimator("full-search").expect("it");
    for (lambda, early_exit) in [(3.5, "off"), (40.0, "off"), (3.5, "on")] {
        let settings =
            [("block-size", "8"), ("search-range", "5"), ("lambda", &lambda.to_string()), ("early-exit", early_exit)];
        let found = field(&*full, &clip, &settings);
        let columns = found.blocks.counts().0;
        let mut sent: Vec<[i64; 2]> = Vec::new();
        for (i, (displacement, cost)) in vectors(&found).into_iter().enumerate() {
            let of = |place: Option<usize>| place.map_or([0, 0], |place| sent[place]);
            let left = of((i % columns > 0).then(|| i - 1));
            let above = of(i.checked_sub(columns));
            let right = of(i.checked_sub(columns).filter(|_| (i + 1) % columns > 0).map(|above| above + 1));
            let predicted = [0, 1].map(|c| {
                let mut sorted = [left[c], above[c], right[c]];
                sorted.sort_unstable();
                if i < columns { left[c] } else { sorted[1] }
            });
            let at = found.blocks.block(i);
            let price = |[u, v]: [i64; 2]| {
                let mut sad = 0;
                for (x, y) in (0..at.height).flat_map(|y| (0..at.width).map(move |x| (at.x + x, at.y + y))) {
                    let there = ((x as i64 + u) as usize, (y as i64 + v) as usize);
                    sad += (i64::from(frames[0][(x, y)]) - i64::from(frames[1][there])).abs();
                }
                sad as f64 + lambda * (plain_bits(u - predicted[0]) + plain_bits(v - predicted[1])) as f64
            };
            let span = |start: usize, length: usize| -5.min(start as i64)..=5.min((40 - start - length) as i64);
            let all = span(at.y, at.height).flat_map(|v| span(at.x, at.width).map(move |u| [u, v]));
            let key = |d: &[i64; 2]| (price(*d), d[0] * d[0] + d[1] * d[1], d[1], d[0]);
            let best = all.min_by(|a, b| key(a).partial_cmp(&key(b)).expect("finite")).expect("a window");
            assert_eq!((displacement, cost), (best.map(|c| c as f32), price(best)), "λ {lambda} block {i}");
            sent.push(best);
        }
    }
}

#[test]
fn a_dearer_bit_makes_neighbours_agree() {
    let (clip, full) = (moving(WAVES, [1.25, -0.5]), estimator("full-search").expect("it"));
    for subpixel in ["none", "half", "quarter"] {
        let differing = |lambda: &str| {
            let found =
                vectors(&field(&*full, &clip, &[("lambda", lambda), ("subpixel", subpixel), ("block-size", "8")]));
            found.windows(2).filter(|pair| pair[0].0 != pair[1].0).count()
        };
        let (free, dear) = (differing("0"), differing("100"));
        assert!(dear < free, "{subpixel}: {free} {dear}");
    }
}
