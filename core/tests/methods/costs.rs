//! What the costs make of changes of light, and what is told about them.

use motionscope_core::base::Threads;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::BlockField;
use motionscope_core::run::{Cursor, Move};
use motionscope_core::scene::Readout;

const COSTS: [&str; 6] = ["sad", "ssd", "mse", "zsad", "satd", "ncc"];

fn texture(x: i64, y: i64) -> f64 {
    let hash = |x: i64, y: i64| {
        let h = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D);
        ((h >> 40) & 0xff) as f64
    };
    40.0 + 0.4 * (hash(x, y) + hash(x + 1, y)) / 2.0
}

/// A texture that moves by (2, −1) while the light changes by a gain and an offset.
fn lit(gain: f64, offset: f64) -> Clip {
    let frame = |shift: (i64, i64), gain: f64, offset: f64| {
        Frame::gray(Grid::from_fn(64, 48, |x, y| {
            (gain * texture(x as i64 - shift.0, y as i64 - shift.1) + offset).round().clamp(0.0, 255.0) as u8
        }))
    };
    Clip::from_frames("lit", vec![frame((0, 0), 1.0, 0.0), frame((2, -1), gain, offset)]).expect("sound")
}

/// Share of the inner blocks whose motion full search finds with `cost`.
fn found(cost: &str, clip: &Clip) -> f64 {
    let mut search = estimator("full-search").expect("sound");
    for (name, value) in [("cost", cost), ("block-size", "8"), ("search-range", "4")] {
        search.set(name, value).expect("sound");
    }
    let Some(field) = search.run(clip, 0, &Threads::single()).expect("sound").get::<BlockField>().cloned() else {
        panic!("no blocks")
    };
    let inner = (0..field.vectors.len()).filter(|&i| {
        let block = field.blocks.block(i);
        block.x >= 8 && block.y >= 8 && block.x < 56 && block.y < 40
    });
    let inner: Vec<_> = inner.map(|i| field.vectors[i].expect("searched").displacement == [2.0, -1.0]).collect();
    inner.iter().filter(|right| **right).count() as f64 / inner.len() as f64
}

#[test]
fn zero_mean_costs_see_through_changes_of_light() {
    for cost in COSTS {
        assert_eq!(found(cost, &lit(1.0, 0.0)), 1.0, "{cost} in steady light");
    }
    for cost in ["sad", "ssd", "mse"] {
        let found = [found(cost, &lit(1.0, 60.0)), found(cost, &lit(1.5, 20.0))];
        assert!(found.iter().all(|&share| share < 0.9), "{cost} under an offset and a gain: {found:?}");
    }
    assert_eq!([found("zsad", &lit(1.0, 60.0)), found("ncc", &lit(1.0, 60.0))], [1.0, 1.0]);
    assert_eq!(found("ncc", &lit(1.5, 20.0)), 1.0);
}

#[test]
fn every_search_means_the_same_by_a_cost() {
    let clip = lit(1.1, 8.0);
    for cost in COSTS {
        let fields: Vec<_> = estimators()
            .into_iter()
            .filter(|search| search.info().family == "Block matching")
            .map(|mut search| {
                for (name, value) in [("cost", cost), ("block-size", "8"), ("search-range", "3"), ("levels", "2")] {
                    let known = search.get(name).is_ok();
                    assert!(known || name == "levels");
                    if known {
                        search.set(name, value).expect("sound");
                    }
                }
                let Some(field) = search.run(&clip, 0, &Threads::single()).expect("sound").get::<BlockField>().cloned()
                else {
                    panic!("no blocks")
                };
                (search, field)
            })
            .collect();
        let (_, full) = &fields[0];
        for (search, field) in &fields {
            let id = search.info().id;
            for (i, (found, best)) in field.vectors.iter().zip(&full.vectors).enumerate() {
                let (found, best) = (found.expect("searched"), best.expect("searched"));
                assert!(
                    found.cost >= best.cost,
                    "{id}: {cost} {} of block {i}, but the least is {}",
                    found.cost,
                    best.cost
                );
                if found.displacement == best.displacement {
                    assert_eq!(found.cost, best.cost, "{id}: {cost} of block {i}");
                }
            }
        }
    }
}

/// The formula and the last tile shown for the first candidate of a block of 4×4 px, `a` against `b`.
fn shown(cost: &str, a: fn(usize, usize) -> u8, b: fn(usize, usize) -> u8) -> (Vec<String>, Gray) {
    let frames = vec![Frame::gray(Grid::from_fn(4, 4, a)), Frame::gray(Grid::from_fn(4, 4, b))];
    let clip = Clip::from_frames("small", frames).expect("sound");
    let mut search = estimator("full-search").expect("sound");
    for (name, value) in [("cost", cost), ("block-size", "4")] {
        search.set(name, value).expect("sound");
    }
    let mut walk = search.walk(&clip, 0).expect("sound");
    walk.jump(Move::To(Cursor { unit: 0, event: 2 }));
    let (mut lines, mut tile) = (Vec::new(), None);
    for readout in walk.step(None).readouts {
        match readout {
            Readout::Equation(math) => lines = math.iter().map(|line| line.plain()).collect(),
            Readout::Tiles(mut tiles) => tile = tiles.pop(),
            _ => {}
        }
    }
    (lines, tile.expect("tiles").values.map(|v| v.round() as u8))
}

#[test]
fn formulas_have_the_numbers_of_the_block() {
    let (lines, tile) = shown("zsad", |x, _| 10 * x as u8, |x, _| 10 * x as u8 + 5);
    assert_eq!(lines[0], "ZSAD(0, 0) = Σ_x, y |(I_t(x, y) − I\u{304}_t) − (I_t+1(x, y) − I\u{304}_t+1)|");
    assert_eq!(lines[1], "= |(0 − 15.00) − (5 − 20.00)| + … + |(30 − 15.00) − (35 − 20.00)|");
    assert_eq!((lines[2].as_str(), tile), ("= 0.00", Grid::new(4, 4, 0)));
    // A constant difference has one coefficient, 16 times as large.
    let (lines, tile) = shown("satd", |_, _| 7, |_, _| 5);
    assert_eq!(lines[1..], ["= (1)/(2) · (32 + 0 + 0 + 0 + …)", "= 16"]);
    assert_eq!(tile.cells().iter().map(|&v| u32::from(v)).sum::<u32>(), 16);
    let (lines, _) = shown("ncc", |x, _| 10 * x as u8, |x, _| 20 * x as u8 + 9);
    assert_eq!(lines[1..], ["= 1 − (4000)/(√(2000 · 8000))", "= 0.0000"]);
}
