//! The pictures of a pyramid's levels against the pyramid itself, and against the marks that lie on them.

use std::sync::Arc;

use crate::common::halved;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::{Floor, Levels, Picture, Readout, Role, Scene, Shape, Stack};

fn texture(x: usize, y: usize) -> u8 {
    ((x * x * 3 + y * 37 + x * y * 5) % 251) as u8
}

fn clip() -> Clip {
    let frame = |t: usize| Frame::gray(Grid::from_fn(70, 51, |x, y| texture(x + 2 * t, y)));
    Clip::from_frames("shift", vec![frame(0), frame(1)]).expect("two frames of one size")
}

fn walk() -> Box<dyn Walk> {
    let mut search = estimator("hierarchical").expect("it is registered");
    for (name, value) in [("block-size", "8"), ("search-range", "8"), ("levels", "3")] {
        search.set(name, value).expect("it has the parameter");
    }
    search.walk(&clip(), 0).expect("the clip suits the search")
}

fn levels(scene: &Scene) -> &Levels {
    scene.levels.as_ref().expect("it works on a pyramid")
}

#[test]
fn the_levels_are_those_of_the_pyramid_and_every_step_shares_them() {
    let mut walk = walk();
    let first = walk.scene(None);
    let all = &levels(&first).all;
    assert_eq!((all.len(), levels(&first).at_work), (3, 0), "nothing is at work yet");
    for (i, frame) in [0, 1].into_iter().zip(clip().pair(0).expect("a pair")) {
        let mut expected: Gray = frame.luma().clone();
        for level in all.iter() {
            assert_eq!(*level.pair[i].luma(), expected);
            expected = halved(&expected);
        }
    }
    loop {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let scene = walk.scene(None);
        assert!(Arc::ptr_eq(&levels(&scene).all, all), "nothing is copied");
        let granularity = walk.place()[1];
        let counted = granularity.of.expect("levels are known") - 1 - granularity.index;
        assert_eq!(levels(&scene).at_work, counted, "{}", walk.cursor());
        if walk.at_end() {
            break;
        }
    }
    assert_eq!(levels(&walk.scene(None)).at_work, 0);
}

#[test]
fn what_a_mark_encloses_is_what_the_search_compares() {
    let mut walk = walk();
    for (unit, level) in [(0, 2), (3, 2), (6, 1), (12, 1), (40, 0)] {
        walk.jump(Move::To(Cursor { unit, event: 1 }));
        let scene = walk.scene(None);
        let levels = levels(&scene);
        assert_eq!(levels.at_work, level, "unit {unit}");
        let block = scene.marks.iter().find_map(|mark| match mark.shape {
            Shape::Rect { min, max } if (mark.on, mark.role) == (Picture::CURRENT, Role::Reference) => Some([min, max]),
            _ => None,
        });
        let [min, max] = block.expect("the block is marked");
        let scale = 1usize << level;
        let (small, [enlarged, _]) = (levels.all[level].pair[0].luma(), levels.pair(level));
        assert_eq!(enlarged.size(), (70, 51), "as large as the picture");
        let mut inside = 0;
        for (x, y) in (0..small.height()).flat_map(|y| (0..small.width()).map(move |x| (x, y))) {
            let at = [x * scale, y * scale];
            if (0..2).all(|i| min[i] < at[i] as f32 && (at[i] as f32) < max[i]) {
                inside += 1;
                let seen = enlarged.luma()[(at[0], at[1])];
                assert_eq!(seen, small[(x, y)], "the middle of a pixel stays in its place");
            }
        }
        let size = [0, 1].map(|i| (max[i] - min[i]) as usize / scale);
        assert_eq!(inside, size[0] * size[1], "unit {unit}: all pixels of the block, and no others");
    }
}

/// The pyramid as it is told where `walk` stands.
fn stack(walk: &dyn Walk) -> Stack {
    let stacks = walk.step(None).readouts.into_iter().filter_map(|readout| match readout {
        Readout::Stack(stack) => Some(stack),
        _ => None,
    });
    stacks.last().expect("it works on a pyramid")
}

#[test]
fn a_stack_has_what_each_level_found_where_the_block_lies() {
    let mut walk = walk();
    assert!(stack(&*walk).floors.iter().all(|floor| *floor == Floor::default()), "no block is at hand yet");
    // What was found, by level and by the middle of the block.
    let mut found: Vec<(usize, [f32; 2], [f32; 2])> = Vec::new();
    loop {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let Stack { levels, floors } = stack(&*walk);
        let level = levels.at_work;
        let middles: Vec<_> = floors.iter().map(|floor| floor.middle().expect("a block is at hand")).collect();
        for (other, middle) in middles.iter().enumerate() {
            // Within one block of each level's own size: blocks are of one size everywhere.
            let scale = 2f32.powi(level as i32 - other as i32);
            let off = [0, 1].map(|i| (middle[i] - middles[level][i] * scale).abs());
            assert!(off.iter().all(|c| *c <= 8.0), "{} level {other}: {off:?}", walk.cursor());
            match floors[other].vector {
                None => assert!(other < level),
                Some((vector, role)) => {
                    assert_eq!(role, Role::Result, "each block is over here");
                    match other == level {
                        true => found.push((level, *middle, vector)),
                        false => assert!(found.contains(&(other, *middle, vector)), "{} level {other}", walk.cursor()),
                    }
                }
            }
        }
        if walk.at_end() {
            break;
        }
    }
    assert_eq!(found.len(), walk.units().expect("they are known"));
    walk.jump(Move::To(Cursor { unit: 12, event: 4 }));
    assert_eq!(stack(&*walk).floors[1].vector.map(|(_, role)| role), Some(Role::Best), "it is not over yet");
}
