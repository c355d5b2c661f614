//! The histogram of displacements against the field that a run leaves.

use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame, Histogram};
use motionscope_core::geometry::Grid;
use motionscope_core::products::{BlockField, Coding};
use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::Readout;

fn clip() -> Clip {
    let texture = |x: usize, y: usize| ((x * x * 3 + y * 37 + x * y * 5) % 251) as u8;
    // The left half moves by (2, 1), the right half stays.
    let next =
        Grid::from_fn(
            80,
            64,
            |x, y| if (2..40).contains(&x) && y >= 1 { texture(x - 2, y - 1) } else { texture(x, y) },
        );
    let frames = vec![Frame::gray(Grid::from_fn(80, 64, texture)), Frame::gray(next)];
    Clip::from_frames("halves", frames).expect("two frames of one size")
}

fn walk(id: &str, set: &[(&str, &str)]) -> Box<dyn Walk> {
    let mut search = estimator(id).expect("it is registered");
    for (name, value) in [("block-size", "8"), ("search-range", "4")].iter().chain(set) {
        search.set(name, value).expect("it has the parameter");
    }
    search.walk(&clip(), 0).expect("the clip suits the search")
}

fn histogram(walk: &dyn Walk) -> Option<Histogram> {
    walk.step(None).readouts.into_iter().find_map(|readout| match readout {
        Readout::Histogram(histogram) => Some(histogram),
        _ => None,
    })
}

#[test]
fn the_counts_sum_to_the_blocks_done() {
    let mut walk = walk("full-search", &[]);
    walk.jump(Move::To(Cursor { unit: 0, event: 5 }));
    assert_eq!(histogram(&*walk), None, "nothing is found in the middle of the first block");
    for unit in [0, 1, 7, 40] {
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        let done = histogram(&*walk).expect("a block is done");
        assert_eq!((done.total() as usize, done.newest.is_some()), (unit + 1, true));
        walk.jump(Move::Granularity(2, Direction::Forward));
        let next = histogram(&*walk).expect("blocks were done");
        assert_eq!((next.total() as usize, next.newest), (unit + 1, None), "the next block is not found yet");
    }
}

#[test]
fn each_bin_leads_to_its_first_block_and_the_bits_are_those_of_the_coding() {
    for set in [&[][..], &[("subpixel", "quarter")], &[("subpixel", "parabola")]] {
        let mut walk = walk("full-search", set);
        walk.jump(Move::End);
        let histogram = histogram(&*walk).expect("the run is over");
        let output = walk.output();
        let field = output.get::<BlockField>().expect("a block search has blocks");
        let per_px = histogram.bins_per_px as f32;
        let bin = |uv: [f32; 2]| uv.map(|c| (c * per_px).round() / per_px);
        let bins: Vec<_> = field.vectors.iter().map(|v| bin(v.expect("all are found").displacement)).collect();
        for (at, count) in histogram.fullest() {
            let same = |bin: &&[f32; 2]| **bin == histogram.displacement(at);
            assert_eq!(bins.iter().filter(same).count(), count as usize);
            let cell = histogram.cell(at).expect("it is shown");
            assert_eq!(histogram.units[cell], bins.iter().position(|bin| same(&bin)));
        }
        let frames = clip().pair(0).expect("a pair");
        let prediction = output.prediction(frames[1].luma());
        let vectors: Vec<_> = field.vectors.iter().flatten().map(|vector| vector.displacement).collect();
        let prediction = prediction.expect("every block is known");
        let coding = Coding::of(Some(&vectors), frames[0].luma(), &prediction).expect("one size");
        assert!(
            (histogram.bits.expect("of blocks") * bins.len() as f64 - coding.vector_bits.expect("of blocks")).abs()
                < 1e-6
        );
    }
}

#[test]
fn a_level_of_a_pyramid_counts_its_own_blocks_and_knows_their_units() {
    let mut walk = walk("hierarchical", &[("levels", "2")]);
    let coarse = 20;
    walk.jump(Move::To(Cursor { unit: coarse + 3, event: usize::MAX }));
    let level = histogram(&*walk).expect("blocks of the picture were done");
    assert_eq!((level.total(), level.level), (4, Some(0)));
    for unit in level.units.cells().iter().flatten() {
        assert!((coarse..coarse + 4).contains(unit), "{unit}");
    }
}
