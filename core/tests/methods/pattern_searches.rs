//! Searches that test some of the candidates: against plain references, and against their papers' counts.

use std::collections::BTreeMap;

use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::BlockField;
use motionscope_core::run::{Cursor, Move};
use motionscope_core::scene::Readout;
use proptest::prelude::*;

type Vector = (i64, i64);

/// One block, and what was tested for it.
struct Plain<'a> {
    current: &'a Gray,
    next: &'a Gray,
    corner: (i64, i64),
    block: i64,
    range: i64,
    border: &'a str,
    squared: bool,
    nearby: Nearby,
    costs: BTreeMap<Vector, i64>,
}

/// What was found for the blocks to the left, above and above right, with its cost, and for this one in the two pairs before.
#[derive(Clone, Copy, Debug, Default)]
struct Nearby {
    left: Option<(Vector, i64)>,
    above: Option<(Vector, i64)>,
    above_right: Option<(Vector, i64)>,
    before: Option<Vector>,
    earlier: Option<Vector>,
}

impl Plain<'_> {
    /// The block's first column and row, and those after its last.
    fn extent(&self) -> [(i64, i64); 2] {
        let cut = |start: i64, length: usize| (start, (start + self.block).min(length as i64));
        [cut(self.corner.0, self.next.width()), cut(self.corner.1, self.next.height())]
    }

    fn is_allowed(&self, (u, v): Vector) -> bool {
        let [(x0, x1), (y0, y1)] = self.extent();
        let inside = x0 + u >= 0 && y0 + v >= 0;
        let inside = inside && x1 + u <= self.next.width() as i64 && y1 + v <= self.next.height() as i64;
        u.abs() <= self.range && v.abs() <= self.range && (self.border != "inside" || inside)
    }

    fn cost(&self, (u, v): Vector) -> i64 {
        let fold = |i: i64, n: usize| match (i, n as i64 - 1) {
            (_, 0) => 0,
            (i, last) if self.border == "mirror" => last - ((i.rem_euclid(2 * last)) - last).abs(),
            (i, last) => i.clamp(0, last),
        };
        let [(x0, x1), (y0, y1)] = self.extent();
        let mut sum = 0;
        for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
            let there = (fold(x + u, self.next.width()) as usize, fold(y + v, self.next.height()) as usize);
            let difference = i64::from(self.current[(x as usize, y as usize)]) - i64::from(self.next[there]);
            sum += if self.squared { difference * difference } else { difference.abs() };
        }
        sum
    }

    fn test(&mut self, offsets: &[Vector], scale: i64, around: Vector) {
        for (u, v) in offsets.iter().map(|(u, v)| (around.0 + scale * u, around.1 + scale * v)) {
            if self.is_allowed((u, v)) && !self.costs.contains_key(&(u, v)) {
                self.costs.insert((u, v), self.cost((u, v)));
            }
        }
    }

    /// The smallest cost; of several, that of the shortest displacement, then of the first in raster order.
    fn best(&self) -> Vector {
        let (&best, _) = self.costs.iter().min_by_key(|((u, v), cost)| (**cost, u * u + v * v, *v, *u)).expect("sound");
        best
    }

    fn best_cost(&self) -> f64 {
        self.costs[&self.best()] as f64
    }

    /// The cost of this block if every pixel is off by `levels` gray levels.
    fn cost_of(&self, levels: f64) -> f64 {
        let [(x0, x1), (y0, y1)] = self.extent();
        ((x1 - x0) * (y1 - y0)) as f64 * if self.squared { levels * levels } else { levels }
    }

    fn walk(&mut self, pattern: &[Vector]) {
        let mut centre = None;
        while centre != Some(self.best()) {
            centre = Some(self.best());
            self.test(pattern, 1, self.best());
        }
    }

    fn at_edge(&self, (u, v): Vector) -> bool {
        [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(a, b)| !self.is_allowed((u + a, v + b)))
    }
}

const CENTRE: &[Vector] = &[(0, 0)];
const CROSS: &[Vector] = &[(0, -1), (-1, 0), (1, 0), (0, 1)];
const NEIGHBOURS: &[Vector] = &[(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
const DIAMOND: &[Vector] = &[(0, -2), (-1, -1), (1, -1), (-2, 0), (2, 0), (-1, 1), (1, 1), (0, 2)];
const HEXAGON: &[Vector] = &[(-1, -2), (1, -2), (-2, 0), (2, 0), (-1, 2), (1, 2)];

/// Steps that halve what is left of `range`, rounded up: 4, 2, 1 for 7.
fn steps(range: i64) -> Vec<i64> {
    let mut steps = Vec::new();
    while steps.iter().sum::<i64>() < range {
        steps.push((range - steps.iter().sum::<i64>() + 1) / 2);
    }
    steps
}

/// The searches, as simple as possible.
fn search(id: &str, plain: &mut Plain) {
    if id == "predictive" {
        return predictive(plain);
    }
    plain.test(CENTRE, 1, (0, 0));
    match id {
        "adaptive-rood" => {
            if plain.best_cost() > plain.cost_of(2.0) {
                let arm = plain.nearby.left.map_or(2, |((u, v), _)| u.abs().max(v.abs()));
                plain.test(CROSS, arm, (0, 0));
                plain.test(&plain.nearby.left.iter().map(|(at, _)| *at).collect::<Vec<_>>(), 1, (0, 0));
                plain.walk(CROSS);
            }
        }
        "three-step" => {
            for step in steps(plain.range) {
                plain.test(NEIGHBOURS, step, plain.best());
            }
        }
        "new-three-step" => {
            let steps = steps(plain.range);
            plain.test(NEIGHBOURS, 1, (0, 0));
            plain.test(NEIGHBOURS, steps[0], (0, 0));
            match plain.best() {
                (0, 0) => {}
                (u, v) if u.abs().max(v.abs()) == 1 => plain.test(NEIGHBOURS, 1, (u, v)),
                _ => steps[1..].iter().for_each(|&step| plain.test(NEIGHBOURS, step, plain.best())),
            }
        }
        "four-step" => {
            for _ in 0..(plain.range / 2).max(1) {
                let centre = plain.best();
                plain.test(NEIGHBOURS, 2, centre);
                if plain.best() == centre {
                    break;
                }
            }
            plain.test(NEIGHBOURS, 1, plain.best());
        }
        "diamond" | "hexagon" => {
            plain.walk(if id == "diamond" { DIAMOND } else { HEXAGON });
            plain.test(CROSS, 1, plain.best());
        }
        "log-search" => {
            let mut step = 2;
            while step * 4 <= plain.range {
                step *= 2;
            }
            while step > 1 {
                let centre = plain.best();
                plain.test(CROSS, step, centre);
                if plain.best() == centre || plain.at_edge(plain.best()) {
                    step /= 2;
                }
            }
            plain.test(NEIGHBOURS, 1, plain.best());
        }
        "quadrant-search" => {
            let (mut columns, mut rows) = ((-plain.range, plain.range), (-plain.range, plain.range));
            let middle = |(low, high): (i64, i64)| (low + high).div_euclid(2);
            let halves = |part: (i64, i64)| [(part.0, middle(part)), (middle(part), part.1)];
            loop {
                let quadrants = halves(rows).map(|r| halves(columns).map(|c| (c, r))).concat();
                for (c, r) in &quadrants {
                    plain.test(&[(c.0, r.0), (c.0, r.1), (c.1, r.0), (c.1, r.1), (middle(*c), middle(*r))], 1, (0, 0));
                }
                let (u, v) = plain.best();
                let holding =
                    quadrants.into_iter().filter(|(c, r)| (c.0..=c.1).contains(&u) && (r.0..=r.1).contains(&v));
                let cost = |q: &((i64, i64), (i64, i64))| plain.costs.get(&(middle(q.0), middle(q.1))).copied();
                (columns, rows) = holding.min_by_key(|q| cost(q).unwrap_or(i64::MAX)).expect("sound");
                if (columns.1 - columns.0).max(rows.1 - rows.0) < 2 {
                    break;
                }
            }
        }
        _ => unreachable!("{id}"),
    }
}

/// The predictive search with its thresholds of 0.5 and 2.5 gray levels and its three squares of fixed predictors, 4 px apart.
fn predictive(plain: &mut Plain) {
    let Nearby { left, above, above_right, before, earlier } = plain.nearby;
    let middle = |part: fn(Vector) -> i64| {
        let mut parts = [left, above, above_right].map(|found| found.map_or(0, |(at, _)| part(at)));
        parts.sort();
        parts[1]
    };
    let left_alone = left.map_or((0, 0), |(at, _)| at);
    let median = if above.is_none() { left_alone } else { (middle(|(u, _)| u), middle(|(_, v)| v)) };
    plain.test(CENTRE, 1, median);
    if !plain.costs.is_empty() && plain.best_cost() <= plain.cost_of(0.5) {
        return;
    }
    let spatial: Vec<(Vector, i64)> = [left, above, above_right].into_iter().flatten().collect();
    let accelerated = before.zip(earlier).map(|(b, e)| (2 * b.0 - e.0, 2 * b.1 - e.1));
    plain.test(CENTRE, 1, (0, 0));
    plain.test(&spatial.iter().map(|(at, _)| *at).chain(before).chain(accelerated).collect::<Vec<_>>(), 1, (0, 0));
    // A block that is cut at the border counts by its pixels.
    let share = plain.cost_of(1.0) / (plain.block * plain.block) as f64;
    let least = spatial.iter().map(|(_, cost)| *cost as f64 * share).fold(f64::INFINITY, f64::min);
    let threshold =
        if least.is_finite() { least.min(plain.cost_of(2.5)).max(plain.cost_of(0.5)) } else { plain.cost_of(0.5) };
    if plain.best_cost() <= threshold {
        return;
    }
    plain.walk(CROSS);
    let twice = if least.is_finite() { 2.0 * least } else { 0.0 };
    if plain.best_cost() > plain.cost_of(2.5).max(twice) {
        let range = plain.range;
        for square in [4, 8, 12].into_iter().filter(|square| *square <= range) {
            plain.test(NEIGHBOURS, square, (0, 0));
        }
        plain.walk(DIAMOND);
        plain.test(CROSS, 1, plain.best());
    }
}

const IDS: [&str; 9] = [
    "quadrant-search",
    "log-search",
    "three-step",
    "new-three-step",
    "four-step",
    "diamond",
    "hexagon",
    "adaptive-rood",
    "predictive",
];

fn picture(width: usize, height: usize, seed: u32, levels: u32) -> Gray {
    Grid::from_fn(width, height, |x, y| {
        let hash = |x: usize, y: usize| {
            let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
            h.wrapping_mul(0xC2B2_AE35) >> 16
        };
        // Coarse and fine together, so that searches walk some way before they stop.
        ((hash(x / 5, y / 5) % levels * 3 + hash(x, y) % levels) * (255 / levels) / 4) as u8
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn searches_agree_with_their_plain_references(
        (block, range) in (4usize..20, 1i64..18),
        (width, height) in (20usize..60, 20usize..60),
        (squared, border) in (any::<bool>(), prop::sample::select(vec!["inside", "replicate", "mirror"])),
        // Few levels make many ties.
        (seed, levels) in (any::<u32>(), prop::sample::select(vec![2u32, 3, 64])),
        (dx, dy) in (0usize..6, 0usize..6),
    ) {
        let all = picture(width + 6, height + 6, seed, levels);
        let cut = |dx, dy| Grid::from_fn(width, height, |x, y| all[(x + dx, y + dy)]);
        let frames = [cut(dx, dy), cut(0, 3), cut(dy, 1), cut(dx, dx)];
        let clip = Clip::from_frames("four", frames.iter().cloned().map(Frame::gray).collect()).expect("sound");
        for id in IDS {
            let mut estimator = estimator(id).expect("sound");
            for (name, value) in [
                ("block-size", block.to_string()),
                ("search-range", range.to_string()),
                ("cost", if squared { "ssd" } else { "sad" }.into()),
                ("border", border.into()),
            ] {
                estimator.set(name, &value).expect("sound");
            }
            let looks_back = estimator.set("temporal-predictor", "on").is_ok();
            let mut before: [Option<Vec<Vector>>; 2] = [None, None];
            for t in 0..3 {
                let Some(field) = estimator.run(&clip, t, &Threads::single()).expect("sound").get::<BlockField>().cloned() else { panic!("no blocks") };
                let (mut candidates, columns, mut all_found) = (0, field.blocks.counts().0, Vec::<(Vector, i64)>::new());
                for (i, found) in field.vectors.iter().enumerate() {
                    let at = field.blocks.block(i);
                    let above = |shift: usize| i.checked_sub(columns).map(|above| all_found[above + shift]);
                    let nearby = Nearby {
                        left: (i % columns > 0).then(|| all_found[i - 1]),
                        above: above(0),
                        above_right: if (i + 1).is_multiple_of(columns) { None } else { above(1) },
                        before: before[0].as_ref().map(|before| before[i]),
                        earlier: before[1].as_ref().map(|earlier| earlier[i]),
                    };
                    let mut plain = Plain {
                        current: &frames[t],
                        next: &frames[t + 1],
                        corner: (at.x as i64, at.y as i64),
                        block: block as i64,
                        range,
                        border,
                        squared,
                        nearby,
                        costs: BTreeMap::new(),
                    };
                    search(id, &mut plain);
                    candidates += plain.costs.len() as u64;
                    let (u, v) = plain.best();
                    let found = found.expect("every block is searched");
                    prop_assert_eq!(
                        (found.displacement, found.cost),
                        ([u as f32, v as f32], plain.costs[&(u, v)] as f64),
                        "{} block {}", id, i
                    );
                    all_found.push(((u, v), plain.costs[&(u, v)]));
                }
                prop_assert_eq!(field.candidates(), candidates, "{}", id);
                // What the searches of the two pairs before found.
                let found = all_found.into_iter().map(|(at, _)| at).collect();
                before = if looks_back { [Some(found), before[0].take()] } else { [None, None] };
            }
        }
    }
}

/// A black picture, and then a pit: its darkest place is where the middle of block `unit` of 5×5 goes if it moves by
/// `valley`. The cost of that block grows to all sides from there.
fn pit(unit: usize, valley: Vector) -> Clip {
    let middle = |block: usize| 32 * block as i64 + 15;
    let distance = |p: usize, middle: i64, shift: i64| (2 * p as i64 - middle - 2 * shift).unsigned_abs();
    let (x0, y0) = (middle(unit % 5), middle(unit / 5));
    let pit = Grid::from_fn(80, 80, |x, y| (distance(x, x0, valley.0) + distance(y, y0, valley.1)).min(255) as u8);
    Clip::from_frames("pit", vec![Frame::gray(Grid::new(80, 80, 0)), Frame::gray(pit)]).expect("sound")
}

/// How many candidates `id` tests for block `unit` of a pit in that block, and whether it finds the pit.
fn candidates(id: &str, settings: &[(&str, &str)], unit: usize, valley: Vector) -> (usize, bool) {
    let mut search = estimator(id).expect("sound");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("sound"));
    let mut walk = search.walk(&pit(unit, valley), 0).expect("sound");
    walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
    let Some(field) = walk.output().get::<BlockField>().cloned() else { panic!("no blocks") };
    let found = field.vectors[unit].expect("sound").displacement == [valley.0 as f32, valley.1 as f32];
    let readouts = walk.step(None).readouts;
    let Some(Readout::Facts(facts)) = readouts.first() else { panic!("facts come first") };
    let tested = &facts.iter().find(|fact| fact.label == "Tested").expect("sound").value;
    let (tested, _) = tested.split_once(' ').expect("sound");
    (tested.parse().expect("sound"), found)
}

#[test]
fn counts_are_those_of_the_papers() {
    for (id, range, valley, count) in [
        // Koga et al. 1981: 25 for ±6, and for ±7 as everyone uses it since.
        ("three-step", 7, (0, 0), 25),
        ("three-step", 7, (7, -7), 25),
        ("three-step", 7, (-3, 5), 25),
        ("three-step", 6, (0, 0), 25),
        // Li, Zeng and Liou 1994, section III, ±7: 17 at the centre, 20 or 22 next to it, 33 elsewhere.
        ("new-three-step", 7, (0, 0), 17),
        ("new-three-step", 7, (1, 0), 20),
        ("new-three-step", 7, (-1, 1), 22),
        ("new-three-step", 7, (5, 6), 33),
        // Po and Ma 1996, section II, ±7: from 17 to 27.
        ("four-step", 7, (0, 0), 17),
        ("four-step", 7, (2, 0), 20),
        ("four-step", 7, (7, 7), 27),
        // Zhu and Ma 2000, section III: 13 at the centre; a move adds 3 along a side, 5 along a corner.
        ("diamond", 7, (0, 0), 13),
        ("diamond", 7, (1, 1), 16),
        ("diamond", 7, (2, 0), 18),
        // Zhu, Lin and Chau 2002, section II: 7 + 3 n + 4 after n moves.
        ("hexagon", 7, (0, 0), 11),
        ("hexagon", 7, (2, 0), 14),
        ("hexagon", 7, (4, 0), 17),
        // Jain and Jain 1981, section III, ±5: a cross of 5, and 8 at the end; 3 more for each move.
        ("log-search", 5, (0, 0), 13),
        ("log-search", 5, (2, 0), 16),
        // The course: quarters of ±8 px, 13 points and then 8 new ones a round, 4 in the last.
        ("quadrant-search", 8, (5, -6), 33),
    ] {
        let found = candidates(id, &[("search-range", &range.to_string())], 12, valley);
        assert_eq!(found, (count, true), "{id} ±{range} at {valley:?}");
    }
}

#[test]
fn searches_that_predict_test_as_few_as_their_papers_say() {
    // The first block has no neighbours. Nie and Ma 2002, section III: 1 if the block counts as still, else arms of
    // 2 px and then a small diamond: 5 + 4.
    let outside = ("border", "replicate");
    assert_eq!(candidates("adaptive-rood", &[outside, ("zero-motion-threshold", "16")], 0, (0, 0)), (1, true));
    assert_eq!(candidates("adaptive-rood", &[outside, ("zero-motion-threshold", "0")], 0, (0, 0)), (9, true));
    // Tourapis 2002: 1 if the median is good enough; else a small diamond, as no predictor is new.
    assert_eq!(candidates("predictive", &[outside, ("termination-threshold", "16")], 0, (0, 0)), (1, true));
    assert_eq!(candidates("predictive", &[outside, ("fixed-threshold", "16")], 0, (0, 0)), (5, true));
    // If that is poor, squares of 8 fixed predictors and a large diamond of 8; the small one is known.
    let poor = [outside, ("search-range", "16"), ("fixed-threshold", "0"), ("fixed-squares", "2")];
    assert_eq!(candidates("predictive", &poor, 0, (0, 0)), (5 + 16 + 8, true));
}

#[test]
fn candidates_grow_with_the_logarithm_of_the_window() {
    for id in ["quadrant-search", "log-search", "three-step"] {
        let counts = ["8", "16"].map(|range| candidates(id, &[("search-range", range)], 12, (3, -2)).0);
        assert!(counts[1] - counts[0] <= 9, "{id}: twice the window adds a round, not {counts:?}");
    }
}

/// All that is told about block `unit`.
fn explained(id: &str, settings: &[(&str, &str)], clip: &Clip, unit: usize) -> Vec<String> {
    let mut search = estimator(id).expect("sound");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("sound"));
    let mut walk = search.walk(clip, 0).expect("sound");
    walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
    let events = walk.events();
    let sentence = |event| {
        walk.jump(Move::To(Cursor { unit, event }));
        walk.step(None).sentence.plain()
    };
    (1..=events).map(sentence).collect()
}

#[test]
fn every_decision_says_why() {
    let clip = pit(12, (2, 0));
    let range = [("search-range", "7")];
    let has = |id: &str, settings: &[(&str, &str)], sentence: &str| {
        let told = explained(id, settings, &clip, 12);
        assert!(told.iter().any(|told| told == sentence), "{id}: {told:#?}");
    };
    has("three-step", &range, "The step is half of the 3 px that remain of the search range, rounded up: 2 px.");
    has(
        "three-step",
        &range,
        "Square of 9 candidates with a step of 2 px around (0, 0). \
         8 of these 9 are tested now; the cost of the other is known already, or it lies outside the search window.",
    );
    has(
        "three-step",
        &range,
        "Block 13: motion vector (2, 0) px. SAD 4096 is the minimum of 25 tested candidates (full search: 225). \
         Mean absolute difference: 16.00 gray levels, a poor match. Possible causes: occlusion, a change of brightness, \
         or motion other than translation.",
    );
    has(
        "diamond",
        &range,
        "The minimum of the large diamond is (2, 0), not its centre (0, 0): the pattern moves there.",
    );
    has(
        "diamond",
        &range,
        "The large diamond of 9 candidates moves to (2, 0). \
         5 of these 9 are tested now; the costs of the others are known already, or they lie outside the search window.",
    );
    has("diamond", &range, "The minimum of the large diamond is its centre (2, 0): a local minimum is reached.");
    has(
        "diamond",
        &range,
        "Small diamond: the centre (2, 0) and its 4 neighbours refine the match to 1 px. \
         4 of these 5 are tested now; the cost of the other is known already, or it lies outside the search window.",
    );
    has("log-search", &range, "The minimum (2, 0) is the centre: the step is halved to 1 px.");
    has("quadrant-search", &range, "The minimum (0, 0) lies in the quadrant around (3, 3): this quadrant is kept.");
    let still = explained("adaptive-rood", &[("zero-motion-threshold", "16")], &pit(12, (0, 0)), 12);
    assert!(
        still.contains(
            &"SAD 4096 at (0, 0) does not exceed the zero-motion threshold 4096: static block, the search stops."
                .into()
        ),
        "{still:#?}"
    );
    has("adaptive-rood", &range, "The left block predicts (7, 0): arm length max(|u|, |v|) = 7 px.");
    has(
        "adaptive-rood",
        &range,
        "Rood pattern: the centre (0, 0), the 4 arm ends and the predictor (7, 0). \
         4 of these 6 are tested now; the costs of the others are known already, or they lie outside the search window.",
    );
    has(
        "predictive",
        &range,
        "Neighbours: left (7, 0), above (2, 7) and above right (−7, 7). The median predictor is (2, 7).",
    );
    let fixed = explained("predictive", &range, &pit(0, (2, 0)), 0);
    let expected = "SAD 4096 exceeds 640, a poor match: no predictor is near the motion, which differs from that of the neighbours or \
                    is too large. Squares with a spacing of 4 px around (0, 0) are tested. \
                    3 of these 8 are tested now; the costs of the others are known already, or they lie outside the search window.";
    assert!(fixed.iter().any(|told| told == expected), "{fixed:#?}");
    has(
        "predictive",
        &range,
        "The lowest cost of a neighbour is 6656, and texture and noise are similar here: the termination threshold is raised from \
         128 to 640.",
    );
    let enough = [("termination-threshold", "16")];
    let rest = explained("predictive", &enough, &pit(0, (0, 0)), 0);
    assert!(rest[1].starts_with("No neighbour is searched yet"), "{rest:#?}");
    assert!(rest.iter().any(|told| told.ends_with(": early termination.")), "{rest:#?}");
    let early = [("search-range", "8"), ("min-decrease", "50")];
    has("quadrant-search", &early, "The minimum decreased by 0.0 %, less than 50 %: the search stops.");
}

#[test]
fn the_smallest_window_of_a_search_by_quadrants_ends_it() {
    let clip =
        Clip::from_frames("pair", vec![Frame::gray(picture(80, 80, 1, 64)), Frame::gray(picture(80, 80, 2, 64))])
            .expect("sound");
    let rounds = |smallest: &str| {
        let told = explained("quadrant-search", &[("search-range", "8"), ("min-window", smallest)], &clip, 12);
        told.iter().filter(|told| told.contains("is divided into quadrants")).count()
    };
    assert_eq!([rounds("1"), rounds("2"), rounds("3"), rounds("5"), rounds("9"), rounds("17")], [4, 4, 3, 2, 1, 1]);
}
