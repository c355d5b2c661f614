//! Hierarchical search: against a plain reference, on far motion, and what it says about its levels.

use std::collections::BTreeSet;

use crate::common::{halved, numbers, set};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Border, Gray, Grid};
use motionscope_core::products::{BlockField, BlockGrid};
use motionscope_core::run::{Cursor, Direction, Move};
use motionscope_core::scene::{Focus, Readout};
use motionscope_core::synth;
use proptest::prelude::*;

type Vector = (i64, i64);

/// One level of both frames.
struct Level {
    current: Gray,
    next: Gray,
    blocks: BlockGrid,
    range: i64,
}

impl Level {
    /// The best of `tested` for block `index`: that with the least SAD, then the shortest, then the first row by row.
    fn best(&self, index: usize, tested: &BTreeSet<Vector>) -> Vector {
        let at = self.blocks.block(index);
        let cost = |(u, v): Vector| {
            let mut sum = 0;
            for (x, y) in (at.y..at.y + at.height).flat_map(|y| (at.x..at.x + at.width).map(move |x| (x, y))) {
                let there = self.next[((x as i64 + u) as usize, (y as i64 + v) as usize)];
                sum += u32::from(self.current[(x, y)].abs_diff(there));
            }
            sum
        };
        *tested.iter().min_by_key(|&&(u, v)| (cost((u, v)), u * u + v * v, v, u)).expect("(0, 0) is tested")
    }

    /// Those of `asked` that lie in the window and leave the candidate inside the picture.
    fn allowed(&self, index: usize, asked: impl IntoIterator<Item = Vector>) -> BTreeSet<Vector> {
        let (at, (width, height)) = (self.blocks.block(index), self.blocks.picture);
        let inside = |start: usize, by: i64, length: usize, extent: usize| {
            by.abs() <= self.range && start as i64 + by >= 0 && start as i64 + by + length as i64 <= extent as i64
        };
        let is_allowed = |&(u, v): &Vector| inside(at.x, u, at.width, width) && inside(at.y, v, at.height, height);
        asked.into_iter().filter(is_allowed).collect()
    }
}

fn square(reach: i64, (u, v): Vector) -> impl Iterator<Item = Vector> {
    (-reach..=reach).flat_map(move |j| (-reach..=reach).map(move |i| (u + i, v + j)))
}

/// Hierarchical search as simple as possible: full search at the coarsest level. Gives the displacements of the picture's
/// blocks, and how many candidates were tested on all levels.
fn reference(levels: &[Level], refine: i64) -> (Vec<Vector>, usize) {
    let (mut coarser, mut candidates) = (Vec::<Vector>::new(), 0);
    for (number, level) in levels.iter().enumerate().rev() {
        let mut found = Vec::new();
        for index in 0..level.blocks.len() {
            let mut tested = if number + 1 == levels.len() {
                level.allowed(index, square(level.range, (0, 0)))
            } else {
                let above = &levels[number + 1].blocks;
                let [x, y] = level.blocks.block(index).center().map(|c| (c / 2.0) as usize);
                let (column, row) = above.nearest(x.min(above.picture.0 - 1), y.min(above.picture.1 - 1));
                let near = |i: usize| {
                    let (c, r) = (i % above.counts().0, i / above.counts().0);
                    c.abs_diff(column) + r.abs_diff(row) <= 1
                };
                let doubled = (0..above.len()).filter(|&i| near(i)).map(|i| (2 * coarser[i].0, 2 * coarser[i].1));
                level.allowed(index, doubled.chain([(0, 0)]))
            };
            if number + 1 < levels.len() {
                tested.extend(level.allowed(index, square(refine, level.best(index, &tested))));
            }
            candidates += tested.len();
            found.push(level.best(index, &tested));
        }
        coarser = found;
    }
    (coarser, candidates)
}

fn picture(width: usize, height: usize, seed: u32) -> Gray {
    Grid::from_fn(width, height, |x, y| {
        let hash = |x: usize, y: usize| {
            let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
            (h.wrapping_mul(0xC2B2_AE35) >> 24) as usize
        };
        ((hash(x / 9, y / 9) * 2 + hash(x / 3, y / 3) + hash(x, y)) / 4) as u8
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn agrees_with_the_plain_reference(
        (block, range, count, refine) in (4usize..9, 1i64..20, 2usize..4, 1i64..4),
        (width, height) in (36usize..70, 36usize..70),
        (dx, dy) in (0usize..9, 0usize..9),
        seed in any::<u32>(),
    ) {
        let all = picture(width + 9, height + 9, seed);
        let cut = |dx, dy| Grid::from_fn(width, height, |x, y| all[(x + dx, y + dy)]);
        let mut pictures = vec![(cut(dx, dy), cut(3, 4))];
        while pictures.len() < count {
            let (current, next) = &pictures[pictures.len() - 1];
            pictures.push((halved(current), halved(next)));
        }
        let frames = [&pictures[0].0, &pictures[0].1].map(|picture| Frame::gray(picture.clone()));
        let clip = Clip::from_frames("pair", frames.into()).expect("sound");
        let level = |(number, (current, next)): (usize, (Gray, Gray))| {
            let blocks = BlockGrid { picture: current.size(), size: block, step: block };
            let parts = 1 << number;
            Level { current, next, blocks, range: (range + parts - 1) / parts }
        };
        let levels: Vec<_> = pictures.into_iter().enumerate().map(level).collect();
        let mut search = estimator("hierarchical").expect("sound");
        for (name, value) in [("block-size", block), ("search-range", range as usize), ("levels", count), ("refinement-range", refine as usize)] {
            search.set(name, &value.to_string()).expect("sound");
        }
        let Some(field) = search.run(&clip, 0, &Threads::new(2).expect("sound")).expect("sound").get::<BlockField>().cloned() else { panic!("no blocks") };
        let (expected, candidates) = reference(&levels, refine);
        for (i, (found, (u, v))) in field.vectors.iter().zip(expected).enumerate() {
            prop_assert_eq!(found.expect("searched").displacement, [u as f32, v as f32], "block {}", i);
        }
        prop_assert_eq!(field.candidates(), candidates as u64);
    }
}

/// Share of the pixels whose motion is found within 1 px, away from what moves in or out.
fn recovered(id: &str, settings: &[(&str, &str)], clip: &Clip, motion: Vector) -> f64 {
    let mut search = estimator(id).expect("sound");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("sound"));
    let flow = search.run(clip, 0, &Threads::single()).expect("sound").flow().expect("a flow");
    let (width, height) = flow.0.size();
    let inside = |p: usize, by: i64, extent: usize| p as i64 + by >= 16 && p as i64 + by < extent as i64 - 16;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let known: Vec<_> = pixels.filter(|&(x, y)| inside(x, motion.0, width) && inside(y, motion.1, height)).collect();
    let right = known.iter().filter(|&&(x, y)| {
        let [u, v] = flow.at(x, y).expect("known");
        (u - motion.0 as f32).abs().max((v - motion.1 as f32).abs()) <= 1.0
    });
    right.count() as f64 / known.len() as f64
}

#[test]
fn far_motion_is_recovered_that_a_plain_window_cannot_reach() {
    let all = picture(640, 480, 7);
    for motion in [(64, 0), (-64, 32), (40, -64), (-50, -37)] {
        let shifted = Grid::from_fn(640, 480, |x, y| {
            all.at(x as isize - motion.0 as isize, y as isize - motion.1 as isize, Border::Mirror)
        });
        let clip = Clip::from_frames("far", vec![Frame::gray(all.clone()), Frame::gray(shifted)]).expect("sound");
        let far = recovered("hierarchical", &[("search-range", "64"), ("levels", "3")], &clip, motion);
        let plain = recovered("full-search", &[("search-range", "16")], &clip, motion);
        assert!(far > 0.95, "{motion:?}: {far}");
        assert_eq!(plain, 0.0, "{motion:?}");
    }
}

#[test]
fn the_fast_ball_is_caught_unless_the_pyramid_makes_it_smaller_than_a_block() {
    let clip = synth::make("fast-ball", &synth::scene("fast-ball").expect("sound").difficulty()).expect("sound");
    let [current, _] = clip.pair(3).expect("sound");
    let truth = clip.truth().expect("sound").flow(3).expect("sound").expect("sound");
    let error = |id: &str, settings: &[(&str, &str)]| {
        let mut search = estimator(id).expect("sound");
        settings.iter().for_each(|(name, value)| search.set(name, value).expect("sound"));
        let flow = search.run(&clip, 3, &Threads::single()).expect("sound").flow().expect("a flow");
        let on_ball = (0..current.size().1).flat_map(|y| (0..current.size().0).map(move |x| (x, y)));
        let on_ball: Vec<_> =
            on_ball.filter(|&(x, y)| truth.at(x, y).is_some_and(|[u, v]| u.hypot(v) > 16.0)).collect();
        let off = |&(x, y): &(usize, usize)| {
            let ([u, v], [a, b]) = (flow.at(x, y).expect("known"), truth.at(x, y).expect("known"));
            f64::from((u - a).hypot(v - b))
        };
        on_ball.iter().map(off).sum::<f64>() / on_ball.len() as f64
    };
    let plain = error("full-search", &[("search-range", "16")]);
    let two = error("hierarchical", &[("search-range", "48"), ("levels", "2")]);
    assert!(two < plain / 4.0, "{two} px off, plain search {plain} px");
    // On level 2 the ball is 11 px across: blocks of 16 px there follow the wall behind it.
    let three = error("hierarchical", &[("search-range", "48"), ("levels", "3")]);
    assert!(three > 2.0 * two, "{three} px off");
    let small = error("hierarchical", &[("search-range", "48"), ("levels", "3"), ("block-size", "8")]);
    assert!(small < plain / 3.0, "{small} px off");
}

#[test]
fn too_many_levels_are_refused_with_the_limit() {
    let clip =
        |width, height| Clip::from_frames("flat", vec![Frame::gray(Grid::new(width, height, 0)); 2]).expect("sound");
    let mut search = estimator("hierarchical").expect("sound");
    search.set("levels", "6").expect("sound");
    let refused = |clip: &Clip| search.walk(clip, 0).err().expect("refused").to_string();
    assert_eq!(
        refused(&clip(320, 240)),
        "with 6 levels the coarsest is smaller than a block of 16 px, for a picture of 320×240 px; \
         choose 4 levels or fewer, or a smaller block size"
    );
    assert_eq!(
        refused(&clip(40, 20)),
        "with 6 levels the coarsest is smaller than a block of 16 px, for a picture of 40×20 px; \
         choose a smaller block size"
    );
    assert!(search.walk(&clip(512, 512), 0).is_ok());
}

#[test]
fn levels_are_granularities_and_say_where_they_are() {
    let clip = synth::make("translation", &synth::scene("translation").expect("sound").difficulty()).expect("sound");
    let search = estimator("hierarchical").expect("sound");
    let mut walk = search.walk(&clip, 0).expect("sound");
    assert_eq!(walk.units(), Some(300 + 80 + 20));
    walk.jump(Move::Granularity(3, Direction::Forward));
    let told = walk.step(None).sentence.plain();
    assert!(told.starts_with("Level 2 of the pyramid, 80×60 px. Block 1: 16×16 px at (0, 0)"), "{told}");
    // Level by level.
    for (units, level) in [(20, 0), (100, 1), (400, 2)] {
        assert_eq!(walk.place()[1].index, level);
        walk.jump(Move::Granularity(1, Direction::Forward));
        assert_eq!(walk.cursor().unit + 1, units);
        walk.jump(Move::Granularity(3, Direction::Forward));
    }
    walk.jump(Move::To(Cursor { unit: 19, event: usize::MAX }));
    let told = walk.step(None).sentence.plain();
    assert!(told.contains(" On level 0 this motion vector is ("), "{told}");
    // A block of 16 px on level 2 is drawn over 64 px of the picture, and a click there leads to it.
    let scene = walk.scene(None);
    let reference =
        scene.marks.iter().find(|mark| mark.role == motionscope_core::scene::Role::Reference).expect("the block");
    let corners = reference.shape.coordinates();
    assert_eq!((corners[0], corners[2] - corners[0]), (4.0 * (64.0 - 0.5), 64.0));
    assert_eq!(walk.unit_at(Focus::current([300.0, 230.0])), Some(19));
}

#[test]
fn the_finest_level_compares_its_vectors_with_the_truth() {
    let clip = synth::make("fast-ball", &synth::scene("fast-ball").expect("sound").difficulty()).expect("sound");
    let mut walk = estimator("hierarchical").expect("sound").walk(&clip, 0).expect("sound");
    let mut end_of = |unit| {
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        walk.step(None).sentence.plain()
    };
    // The first block of the coarsest level, whose blocks are not those of the clip, and block 82 of level 0.
    let (coarse, fine) = (end_of(0), end_of(181));
    assert!(!coarse.contains("True motion"), "{coarse}");
    assert!(fine.ends_with("True motion: (0, 0) px; endpoint error 0.00 px."), "{fine}");
}

#[test]
fn chart_and_sentence_name_the_same_missed_minimum() {
    let clip = synth::make("fast-ball", &synth::scene("fast-ball").expect("sound").difficulty()).expect("sound");
    let with_range = |id| set(id, &[("search-range", "32")]);
    let full = with_range("full-search").run(&clip, 3, &Threads::single()).expect("a run");
    let full = &full.get::<BlockField>().expect("blocks").vectors;
    let mut walk = with_range("hierarchical").walk(&clip, 3).expect("a walk");
    let first = walk.units().expect("counted") - full.len();
    let mut missed_count = 0;
    // Blocks on the ball, and beside it.
    for block in (120..132).chain(140..150) {
        walk.jump(Move::To(Cursor { unit: first + block, event: usize::MAX }));
        let step = walk.step(None);
        let surface = step.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface),
            _ => None,
        });
        let surface = surface.expect("a cost surface");
        let (found, _) = surface.optimum().expect("tested candidates");
        let global = full[block].expect("searched");
        let missed =
            (global.cost < f64::from(found)).then_some((global.displacement.map(|c| c as i32), global.cost as f32));
        assert_eq!(surface.missed(), missed, "block {}", block + 1);
        if let Some(([u, v], cost)) = missed {
            missed_count += 1;
            let named = numbers(&step.sentence.plain());
            let named = named.windows(3).any(|part| part == [f64::from(cost), f64::from(u), f64::from(v)]);
            assert!(named, "block {}: {:?} in {}", block + 1, missed, step.sentence.plain());
        }
    }
    assert!(missed_count >= 3, "{missed_count} blocks with a missed minimum");
}
