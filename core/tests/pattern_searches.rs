//! Searches that test some of the candidates: against plain references, and against their papers' counts.

use std::collections::BTreeMap;

use motionscope_core::scene::Readout;
use motionscope_core::{Clip, Cursor, Frame, Gray, Grid, Move, Output, Threads, estimator};
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
    costs: BTreeMap<Vector, i64>,
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
    plain.test(CENTRE, 1, (0, 0));
    match id {
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
            let mut centre = None;
            while centre != Some(plain.best()) {
                centre = Some(plain.best());
                plain.test(if id == "diamond" { DIAMOND } else { HEXAGON }, 1, plain.best());
            }
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

const IDS: [&str; 7] =
    ["quadrant-search", "log-search", "three-step", "new-three-step", "four-step", "diamond", "hexagon"];

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
        let (current, next) = (cut(dx, dy), cut(0, 3));
        let clip = Clip::from_frames("pair", vec![Frame::gray(current.clone()), Frame::gray(next.clone())]).expect("sound");
        for id in IDS {
            let mut estimator = estimator(id).expect("sound");
            for (name, value) in [
                ("block", block.to_string()),
                ("range", range.to_string()),
                ("cost", if squared { "ssd" } else { "sad" }.into()),
                ("border", border.into()),
            ] {
                estimator.set(name, &value).expect("sound");
            }
            let Output::Blocks(field) = estimator.run(&clip, 0, &Threads::single()).expect("sound");
            let mut candidates = 0;
            for (i, found) in field.vectors.iter().enumerate() {
                let at = field.blocks.block(i);
                let (corner, block) = ((at.x as i64, at.y as i64), block as i64);
                let costs = BTreeMap::new();
                let mut plain = Plain { current: &current, next: &next, corner, block, range, border, squared, costs };
                search(id, &mut plain);
                candidates += plain.costs.len() as u64;
                let (u, v) = plain.best();
                let found = found.expect("every block is searched");
                prop_assert_eq!(
                    (found.displacement, found.cost),
                    ([u as f32, v as f32], plain.costs[&(u, v)] as f64),
                    "{} block {}", id, i
                );
            }
            prop_assert_eq!(field.candidates(), candidates, "{}", id);
        }
    }
}

/// How many candidates `id` tests within `range` for a 16×16 block in the middle of the picture, on a surface of costs
/// that falls from all sides towards `valley`, and whether it finds it.
fn candidates(id: &str, range: usize, valley: Vector) -> (usize, bool) {
    let black = Grid::new(80, 80, 0);
    // The block's middle lies between its pixels 39 and 40.
    let distance = |p: usize, shift: i64| (2 * p as i64 - 79 - 2 * shift).unsigned_abs();
    let pit = Grid::from_fn(80, 80, |x, y| (distance(x, valley.0) + distance(y, valley.1)) as u8);
    let clip = Clip::from_frames("pit", vec![Frame::gray(black), Frame::gray(pit)]).expect("sound");
    let mut search = estimator(id).expect("sound");
    search.set("range", &range.to_string()).expect("sound");
    let mut walk = search.walk(&clip, 0).expect("sound");
    walk.jump(Move::To(Cursor { unit: 12, event: usize::MAX }));
    let Output::Blocks(field) = walk.output();
    let found = field.vectors[12].expect("sound").displacement == [valley.0 as f32, valley.1 as f32];
    let readouts = walk.step(None).readouts;
    let Some(Readout::Facts(facts)) = readouts.first() else { panic!("facts come first") };
    let tested =
        facts.iter().find(|fact| fact.label == "Tested").expect("sound").value.split(' ').next().expect("sound");
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
        assert_eq!(candidates(id, range, valley), (count, true), "{id} ±{range} at {valley:?}");
    }
}

#[test]
fn candidates_grow_with_the_logarithm_of_the_window() {
    for id in ["quadrant-search", "log-search", "three-step"] {
        let counts = [8, 16].map(|range| candidates(id, range, (3, -2)).0);
        assert!(counts[1] - counts[0] <= 9, "{id}: twice the window adds a round, not {counts:?}");
    }
}

/// All that is told about block `unit`.
fn told(id: &str, settings: &[(&str, &str)], clip: &Clip, unit: usize) -> Vec<String> {
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
    // A pit at (2, 0), as in `candidates`.
    let distance = |p: usize, shift: i64| (2 * p as i64 - 79 - 2 * shift).unsigned_abs();
    let pit = Grid::from_fn(80, 80, |x, y| (distance(x, 2) + distance(y, 0)) as u8);
    let clip = Clip::from_frames("pit", vec![Frame::gray(Grid::new(80, 80, 0)), Frame::gray(pit)]).expect("sound");
    let range = [("range", "7")];
    let has = |id: &str, settings: &[(&str, &str)], sentence: &str| {
        let told = told(id, settings, &clip, 12);
        assert!(told.iter().any(|told| told == sentence), "{id}: {told:#?}");
    };
    has(
        "three-step",
        &range,
        "The search can still go 3 px, so it takes half: 9 points in steps of 2 px around (0, 0). \
         Of these 9, 8 lie in the window and were not tested before.",
    );
    has(
        "three-step",
        &range,
        "Block 13 moves by (2, 0) px: SAD 4096 is the smallest of 25 tested; full search would test 225.",
    );
    has(
        "diamond",
        &range,
        "(2, 0) is better than the centre (0, 0): the large diamond moves there and looks further that way. \
         Of these 9, 5 lie in the window and were not tested before.",
    );
    has(
        "diamond",
        &range,
        "Nothing on the large diamond beats its centre (2, 0): the small one looks closer. \
         Of these 5, 4 lie in the window and were not tested before.",
    );
    has("log-search", &range, "(2, 0) is still the best, so the step is halved to 1 px.");
    has(
        "quadrant-search",
        &range,
        "The best, (0, 0), lies in the quadrant around (3, 3): the search goes on in there.",
    );
    let early = [("range", "8"), ("least-gain", "50")];
    has("quadrant-search", &early, "The best cost fell by 0.0 %, less than 50 %: the search ends.");
}

#[test]
fn the_smallest_window_of_a_search_by_quadrants_ends_it() {
    let clip =
        Clip::from_frames("pair", vec![Frame::gray(picture(80, 80, 1, 64)), Frame::gray(picture(80, 80, 2, 64))])
            .expect("sound");
    let rounds = |smallest: &str| {
        let told = told("quadrant-search", &[("range", "8"), ("smallest", smallest)], &clip, 12);
        told.iter().filter(|told| told.contains("is cut into quadrants")).count()
    };
    assert_eq!([rounds("1"), rounds("2"), rounds("3"), rounds("5"), rounds("9"), rounds("17")], [4, 4, 3, 2, 1, 1]);
}
