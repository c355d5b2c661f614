//! Full search against a plain reference, and against what the issue of ties and borders demands.

use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::BlockField;
use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::Readout;
use motionscope_core::synth;
use proptest::prelude::*;

/// What a search is asked for.
#[derive(Clone, Copy, Debug)]
struct Question {
    block: usize,
    range: i64,
    squared: bool,
    border: &'static str,
}

/// Full search as simple as possible: displacement and cost of the block at `(x, y)`.
fn reference(current: &Gray, next: &Gray, (x0, y0): (usize, usize), question: Question) -> ([f32; 2], f64) {
    let (width, height) = (current.width() as i64, current.height() as i64);
    let (x1, y1) = ((x0 + question.block).min(current.width()), (y0 + question.block).min(current.height()));
    let fold = |i: i64, n: i64| match question.border {
        "mirror" if n == 1 => 0,
        "mirror" => {
            let mut i = i;
            while i < 0 || i >= n {
                i = if i < 0 { -i } else { 2 * (n - 1) - i };
            }
            i
        }
        _ => i.clamp(0, n - 1),
    };
    let mut tested = Vec::new();
    for v in -question.range..=question.range {
        for u in -question.range..=question.range {
            let inside = x0 as i64 + u >= 0 && y0 as i64 + v >= 0 && x1 as i64 + u <= width && y1 as i64 + v <= height;
            if question.border == "inside" && !inside {
                continue;
            }
            let mut cost = 0i64;
            for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                let other = next[(fold(x as i64 + u, width) as usize, fold(y as i64 + v, height) as usize)];
                let difference = (i64::from(current[(x, y)]) - i64::from(other)).abs();
                cost += if question.squared { difference * difference } else { difference };
            }
            tested.push((cost, u * u + v * v, v, u));
        }
    }
    let (cost, _, v, u) = tested.into_iter().min().expect("the zero displacement is always there");
    ([u as f32, v as f32], cost as f64)
}

fn picture(width: usize, height: usize, seed: u32, levels: u32) -> Gray {
    Grid::from_fn(width, height, |x, y| {
        let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
        ((h.wrapping_mul(0xC2B2_AE35) >> 16) % levels * (255 / levels)) as u8
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn agrees_with_the_plain_reference(
        (block, range) in (4usize..20, 1i64..7),
        (width, height) in (20usize..50, 20usize..50),
        (squared, border) in (any::<bool>(), prop::sample::select(vec!["inside", "replicate", "mirror"])),
        (order, early) in (prop::sample::select(vec!["raster", "spiral"]), any::<bool>()),
        // Few levels make many ties.
        (seed, levels) in (any::<u32>(), prop::sample::select(vec![2u32, 3, 255])),
        spacing in 0usize..9,
    ) {
        let question = Question { block, range, squared, border };
        let (current, next) = (picture(width, height, seed, levels), picture(width, height, seed ^ 0xABCD, levels));
        let clip = Clip::from_frames("pair", vec![Frame::gray(current.clone()), Frame::gray(next.clone())]).unwrap();
        let mut search = estimator("full-search").unwrap();
        for (name, value) in [
            ("block-size", block.to_string()),
            ("search-range", range.to_string()),
            ("spacing", spacing.to_string()),
            ("cost", if squared { "ssd" } else { "sad" }.into()),
            ("border", border.into()),
            ("order", order.into()),
            ("early-exit", if early { "on" } else { "off" }.into()),
        ] {
            search.set(name, &value).unwrap();
        }
        let Some(field) = search.run(&clip, 0, &Threads::single()).unwrap().get::<BlockField>().cloned() else { panic!("no blocks") };
        for (i, found) in field.vectors.iter().enumerate() {
            let at = field.blocks.block(i);
            let found = found.expect("every block is searched");
            prop_assert_eq!((found.displacement, found.cost), reference(&current, &next, (at.x, at.y), question));
        }
    }
}

fn field(id: &str, settings: &[(&str, String)], clip: &Clip) -> BlockField {
    let mut search = estimator(id).expect("it is registered");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("it is in range"));
    let Some(field) = search.run(clip, 0, &Threads::single()).expect("it can be run").get::<BlockField>().cloned()
    else {
        panic!("no blocks")
    };
    field
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]

    #[test]
    fn successive_elimination_finds_what_full_search_finds(
        (block, range) in (4usize..34, 1i64..20),
        (width, height) in (34usize..90, 34usize..70),
        cost in prop::sample::select(vec!["sad", "ssd", "mse", "zsad", "satd", "ncc"]),
        (border, subpixel) in (
            prop::sample::select(vec!["inside", "replicate", "mirror"]),
            prop::sample::select(vec!["none", "half", "quarter", "parabola"]),
        ),
        (levels, lambda) in (1usize..=5, prop::sample::select(vec!["0", "0.3", "4", "60"])),
        // Few gray levels make many ties, and a moved picture a low minimum.
        (seed, grays) in (any::<u32>(), prop::sample::select(vec![2u32, 3, 255])),
        (moved, spacing) in ((0usize..6, 0usize..6), 0usize..40),
    ) {
        let all = picture(width + 6, height + 6, seed, grays);
        let noise = picture(width, height, seed ^ 0xABCD, 9);
        let cut = |(dx, dy): (usize, usize)| Grid::from_fn(width, height, |x, y| all[(x + dx, y + dy)].saturating_add(noise[(x, y)] / 32));
        let clip = Clip::from_frames("pair", vec![Frame::gray(cut((0, 0))), Frame::gray(cut(moved))]).unwrap();
        let shared: Vec<(&str, String)> = [("cost", cost), ("border", border), ("subpixel", subpixel), ("lambda", lambda)]
            .map(|(name, value)| (name, value.to_owned()))
            .into_iter()
            .chain([("block-size", block), ("search-range", range as usize), ("spacing", spacing)].map(|(name, value)| (name, value.to_string())))
            .collect();
        let full = field("full-search", &shared, &clip);
        let own = [shared, vec![("bound-levels", levels.to_string())]].concat();
        let fast = field("successive-elimination", &own, &clip);
        for (i, (full, fast)) in full.vectors.iter().zip(&fast.vectors).enumerate() {
            let (full, fast) = (full.unwrap(), fast.unwrap());
            prop_assert_eq!((fast.displacement, fast.cost), (full.displacement, full.cost), "block {}", i);
            prop_assert!(fast.candidates <= full.candidates + 24);
        }
    }
}

/// The share of the candidates that successive elimination skips on frame 0 of a scene.
fn skipped(scene: &str, levels: &str) -> f64 {
    let scene = synth::scene(scene).expect("it can be run");
    let clip = scene.clip(&scene.difficulty()).expect("it can be run");
    let all = field("full-search", &[], &clip).candidates();
    let tested = field("successive-elimination", &[("bound-levels", levels.to_owned())], &clip).candidates();
    1.0 - tested as f64 / all as f64
}

#[test]
fn elimination_skips_texture_and_fails_under_noise() {
    let [works, fails] = ["translation", "flat-wall"].map(|scene| skipped(scene, "3"));
    println!("skipped: translation {works:.3}, flat wall {fails:.3}");
    assert!(works > 0.9, "{works}");
    assert!(fails < 0.3, "{fails}");
    // Each level skips more.
    let levels = ["1", "2", "3"].map(|levels| skipped("pillar", levels));
    assert!(levels.is_sorted(), "{levels:?}");
}

#[test]
fn a_skipped_candidate_says_by_which_bound() {
    let frames = vec![Frame::gray(Grid::from_fn(24, 24, |x, _| 10 * x as u8)); 2];
    let clip = Clip::from_frames("ramp", frames).unwrap();
    let told = |levels: &str| {
        let settings = [("block-size", "8"), ("search-range", "2"), ("border", "replicate"), ("bound-levels", levels)];
        sentences_of("successive-elimination", &clip, &settings, 4, "")
    };
    let has = |told: &[String], sentence: &str| assert!(told.iter().any(|told| told == sentence), "{told:#?}");
    has(
        &told("1"),
        "Candidate (−1, −2): SAD cannot be below 640, by the sums of both blocks. The minimum so far is 0 at (0, 0): skipped.",
    );
    has(&told("1"), "Skipped without computing their cost: 20 of 25 candidates, 80.0 %.");
    let end = told("3").pop().unwrap();
    assert!(end.contains("Skipped by lower bounds: 20 of 25 candidates, 80.0 %."), "{end}");
    let settings = [("block-size", "8"), ("search-range", "2"), ("cost", "ncc")];
    let told = sentences_of("successive-elimination", &clip, &settings, 4, "Successive elimination has no");
    assert!(told[0].starts_with("Successive elimination has no lower bound for 1 − NCC here"), "{told:?}");
}

#[test]
fn mse_is_ssd_divided_and_chooses_the_same() {
    let clip =
        Clip::from_frames("pair", vec![Frame::gray(picture(40, 40, 1, 255)), Frame::gray(picture(40, 40, 2, 255))])
            .unwrap();
    let run = |cost: &str| {
        let mut search = estimator("full-search").unwrap();
        search.set("cost", cost).unwrap();
        let Some(field) = search.run(&clip, 0, &Threads::single()).unwrap().get::<BlockField>().cloned() else {
            panic!("no blocks")
        };
        field
    };
    let (ssd, mse) = (run("ssd"), run("mse"));
    for (i, (a, b)) in ssd.vectors.iter().zip(&mse.vectors).enumerate() {
        let (a, b, block) = (a.unwrap(), b.unwrap(), ssd.blocks.block(i));
        assert_eq!(a.displacement, b.displacement);
        assert_eq!(b.cost, a.cost / (block.width * block.height) as f64);
    }
}

#[test]
fn a_flat_picture_does_not_move() {
    let clip = Clip::from_frames("flat", vec![Frame::gray(Grid::new(64, 64, 9)); 2]).unwrap();
    for order in ["raster", "spiral"] {
        let mut search = estimator("full-search").unwrap();
        search.set("order", order).unwrap();
        let Some(field) = search.run(&clip, 0, &Threads::single()).unwrap().get::<BlockField>().cloned() else {
            panic!("no blocks")
        };
        assert!(field.vectors.iter().all(|v| v.is_some_and(|v| v.displacement == [0.0, 0.0])));
    }
}

#[test]
fn refuses_a_block_larger_than_the_picture_in_words() {
    let clip = Clip::from_frames("tiny", vec![Frame::gray(Grid::new(10, 10, 0)); 2]).unwrap();
    let error = estimator("full-search").unwrap().walk(&clip, 0).err().unwrap().to_string();
    assert_eq!(error, "a block of 16×16 px does not fit into a picture of 10×10 px; choose a smaller block size");
}

/// All sentences of block `unit`, from 0, that begin with `start`.
fn sentences(clip: &Clip, settings: &[(&str, &str)], unit: usize, start: &str) -> Vec<String> {
    sentences_of("full-search", clip, settings, unit, start)
}

/// The same of another search.
fn sentences_of(id: &str, clip: &Clip, settings: &[(&str, &str)], unit: usize, start: &str) -> Vec<String> {
    let mut search = estimator(id).expect("it is there");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("in range"));
    let mut walk = search.walk(clip, 0).expect("a walk");
    let mut found = Vec::new();
    walk.jump(Move::To(Cursor { unit, event: 0 }));
    while walk.cursor().unit <= unit && !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let told = walk.step(None).sentence.plain();
        if walk.cursor().unit == unit && told.starts_with(start) {
            found.push(told);
        }
    }
    found
}

fn pair(current: impl FnMut(usize, usize) -> u8, next: impl FnMut(usize, usize) -> u8) -> Clip {
    let frames = vec![Frame::gray(Grid::from_fn(24, 24, current)), Frame::gray(Grid::from_fn(24, 24, next))];
    Clip::from_frames("pair", frames).expect("one size")
}

#[test]
fn every_event_says_why() {
    let settings = [("block-size", "8"), ("search-range", "1")];
    // One bright column that moves right by one: costs fall to zero at (1, 0).
    let clip = pair(|x, _| if x == 3 { 10 } else { 0 }, |x, _| if x == 4 { 10 } else { 0 });
    assert_eq!(
        sentences(&clip, &settings, 0, "Block"),
        [
            "Block 1: 8×8 px at (0, 0) in frame t. Its search window of ±1 px in frame t+1, cut at the picture border, \
             holds 2×2 = 4 candidates.",
            "Block 1: motion vector (1, 0) px. SAD 0 is the minimum of 4 tested candidates. The cost is the same at (1, 1): \
             repeating texture, an edge or a flat area makes the match ambiguous. A larger block may resolve it.",
        ]
    );
    assert_eq!(sentences(&clip, &settings, 0, "SAD 0 at"), ["SAD 0 at (1, 0) is below 160 at (0, 0): new minimum."]);
    assert_eq!(
        sentences(&clip, &settings, 0, "Candidate (1, 1)"),
        [
            "Candidate (1, 1): SAD 0 equals the minimum so far, 0 at (1, 0). The earlier displacement is shorter, so it is kept."
        ]
    );
    let whole = [("block-size", "8"), ("search-range", "1"), ("border", "replicate")];
    assert!(sentences(&clip, &whole, 0, "Block")[0].ends_with("holds 3×3 = 9 candidates."));
}

#[test]
fn ties_say_which_rule_decided() {
    let settings = [("block-size", "8"), ("search-range", "1"), ("border", "replicate")];
    let flat = pair(|_, _| 7, |_, _| 7);
    let preferred = sentences(&flat, &settings, 0, "SAD 0 at");
    assert_eq!(preferred[0], "SAD 0 at (−1, −1) is the minimum so far, as the first candidate of this block.");
    assert_eq!(
        preferred[1],
        "SAD 0 at (0, −1) equals the minimum so far at (−1, −1), and the displacement is shorter: new minimum."
    );
    let kept = sentences(&flat, &settings, 0, "Candidate (1, −1)");
    assert!(kept[0].ends_with("0 at (0, −1). The earlier displacement is shorter, so it is kept."), "{}", kept[0]);
    // Diagonal stripes one pixel off: (0, −1) and (1, 0) are equally short and match equally well.
    let spiral = [("block-size", "8"), ("search-range", "1"), ("border", "replicate"), ("order", "spiral")];
    let stripe = |k: usize| (k * 37 % 251) as u8;
    let stripes = pair(|x, y| stripe(x + 30 - y + 1), |x, y| stripe(x + 30 - y));
    let told = sentences(&stripes, &spiral, 4, "Candidate");
    assert!(told.iter().any(|told| told.contains("equally short and comes first in raster order")), "{told:?}");
}

#[test]
fn an_early_exit_stops_at_the_first_row_that_is_too_much() {
    // Every row of a wrong candidate costs 80; the right one costs nothing.
    let clip = pair(|_, _| 0, |x, _| if x < 8 { 0 } else { 80 });
    let settings = [("block-size", "8"), ("search-range", "2"), ("early-exit", "on"), ("order", "spiral")];
    let given_up = sentences(&clip, &settings, 0, "Candidate (1, 0)");
    assert_eq!(
        given_up,
        ["Candidate (1, 0): SAD ≥ 80 after 1 of 8 rows exceeds the minimum so far, 0 at (0, 0). Early exit: rejected."]
    );
    let mut search = estimator("full-search").unwrap();
    settings.iter().for_each(|(name, value)| search.set(name, value).unwrap());
    let mut walk = search.walk(&clip, 0).unwrap();
    // A sum over some rows is told as a bound.
    let bounds = |walk: &dyn Walk| {
        let readouts = walk.step(None).readouts;
        let lines =
            readouts.into_iter().find_map(|r| if let Readout::Equation(lines) = r { Some(lines) } else { None });
        lines.is_some_and(|lines| lines.iter().any(|line| line.plain().starts_with('≥')))
    };
    let mut seen = [false; 2];
    while walk.cursor().event < walk.events() || walk.cursor() == Cursor::default() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let is_given_up = walk.step(None).sentence.plain().contains("Early exit: rejected");
        assert!(!is_given_up || bounds(&*walk), "{}", walk.cursor());
        seen[usize::from(is_given_up)] |= bounds(&*walk) == is_given_up;
    }
    assert_eq!(seen, [true; 2]);
    let readouts = walk.step(None).readouts;
    let surface = readouts.iter().find_map(|r| if let Readout::Surface(s) = r { Some(s) } else { None }).unwrap();
    let known = surface.values.cells().iter().filter(|v| v.is_finite()).count();
    assert_eq!(known, 3, "only (0, 0), (0, 1) and (0, 2) were summed to the end");
}

/// The end of a block of a bundled scene: its sentence, and the true motion on its cost surface.
fn end_of_block(id: &str, scene: &str, unit: usize) -> (String, Option<[f32; 2]>) {
    let scene = synth::scene(scene).expect("it is bundled");
    let clip = scene.clip(&scene.difficulty()).expect("a clip");
    let mut walk = estimator(id).expect("it is there").walk(&clip, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
    let step = walk.step(None);
    let truth = step.readouts.iter().find_map(|readout| match readout {
        Readout::Surface(surface) => Some(surface.truth),
        _ => None,
    });
    (step.sentence.plain(), truth.expect("a surface"))
}

#[test]
fn a_wrong_vector_is_explained_by_the_truth() {
    // The ball covers the block: the match lies at the limit of the range, which is not the cause.
    let (covered, truth) = end_of_block("full-search", "fast-ball", 181);
    assert!(
        covered.contains("True motion: (0, 0) px; endpoint error 16.12 px. The true displacement costs more, SAD "),
        "{covered}"
    );
    assert!(covered.ends_with("% of the block is occluded in frame t+1."), "{covered}");
    assert!(!covered.contains("larger range") && !covered.contains("Possible causes"), "{covered}");
    assert_eq!(truth, Some([0.0; 2]));
    // At the right border the true displacement is no candidate.
    let (leaving, truth) = end_of_block("full-search", "wallpaper", 79);
    assert!(leaving.ends_with("the block leaves the picture: it is no candidate."), "{leaving}");
    assert!(!leaving.contains("larger range") && truth.is_none(), "{leaving}");
}

#[test]
fn between_pixels_no_global_minimum_is_claimed() {
    let sample = synth::scene("sub-pixel").expect("it is bundled");
    let clip = sample.clip(&sample.difficulty()).expect("a clip");
    let ends = |subpixel: &str| -> Vec<String> {
        let settings = [("subpixel", subpixel)];
        (40..46)
            .flat_map(|unit| sentences(&clip, &settings, unit, "Block"))
            .filter(|told| told.contains("motion vector"))
            .collect()
    };
    let (whole, half) = (ends("none"), ends("half"));
    assert!(whole.iter().any(|told| told.contains("It is the global minimum of the search window.")), "{whole:#?}");
    assert!(
        half.iter().any(|told| told.contains("Between pixels only positions around that minimum were tested.")),
        "{half:#?}"
    );
    assert!(half.iter().all(|told| !told.contains("It is the global minimum")), "{half:#?}");
}
