//! What several tests share.
#![allow(dead_code, reason = "each test uses its part of it")]

use std::sync::Arc;

use motionscope_core::base::{Error, Threads};
use motionscope_core::course::estimator;
use motionscope_core::course::examples::Example;
use motionscope_core::data::{Clip, Flow, Frame, ObjectBox, Truth};
use motionscope_core::geometry::{Border, Gray, Grid};
use motionscope_core::params::Params as _;
use motionscope_core::products::metrics;
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Info, Move, Walk};
use motionscope_core::scene::pseudocode::Line;
use motionscope_core::scene::{self, Focus, Step};
use motionscope_core::synth;

/// A truth that knows objects alone, by frame.
pub struct Objects(pub Vec<Vec<ObjectBox>>);

impl Truth for Objects {
    fn flow(&self, _t: usize) -> Result<Option<Arc<Flow>>, Error> {
        Ok(None)
    }

    fn objects(&self, t: usize) -> Result<Option<Vec<ObjectBox>>, Error> {
        Ok(self.0.get(t).cloned())
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["objects"]
    }
}

/// The steps of a run whose sentences have a phrase, in their order.
pub fn steps(estimator: &dyn AnyEstimator, clip: &Clip, phrase: &str) -> Vec<Step> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let mut found = Vec::new();
    loop {
        let step = walk.step(None);
        if step.sentence.plain().contains(phrase) {
            found.push(step);
        }
        if walk.at_end() {
            return found;
        }
        walk.jump(Move::Granularity(2, Direction::Forward));
    }
}

/// The estimator `id` with these parameters.
pub fn set(id: &str, settings: &[(&str, &str)]) -> Box<dyn AnyEstimator> {
    let mut estimator = estimator(id).expect("it is there");
    settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("in range"));
    estimator
}

/// The clip of an example.
pub fn clip_of(example: &Example) -> Clip {
    let mut parts = example.clip.split(',');
    let scene = synth::scene(parts.next().expect("a scene")).expect("a scene of the generator");
    let mut difficulty = scene.difficulty();
    for part in parts {
        let (name, value) = part.split_once('=').expect("NAME=VALUE");
        difficulty.set(name, value).expect("a slider in range");
    }
    scene.clip(&difficulty).expect("a clip")
}

/// The declaration of an estimator with this pseudocode, which is not registered.
pub fn toy(pseudocode: &'static [Line]) -> Info {
    Info { id: "toy", name: "Toy", family: "Toys", summary: "", source: "", pseudocode, granularities: &[], frames: 1 }
}

/// Waves in all directions, so long that over a block the difference grows with the distance from the match.
pub fn waves(x: f64, y: f64) -> f64 {
    let wave = |k: f64| {
        let (period, angle) = (13.0 + 0.7 * k, k * std::f64::consts::PI / 8.0);
        ((x * angle.cos() + y * angle.sin()) * std::f64::consts::TAU / period + k * k).sin()
    };
    128.0 + 15.0 * (0..8).map(|k| wave(f64::from(k))).sum::<f64>()
}

/// Every second pixel, as the mean of 5×5 px with the weights of Burt and Adelson.
pub fn halved(picture: &Gray) -> Gray {
    let weights = [1u32, 4, 6, 4, 1];
    Grid::from_fn(picture.width().div_ceil(2), picture.height().div_ceil(2), |x, y| {
        let window = (0..5).flat_map(|j| (0..5).map(move |i| (i, j)));
        let sum: u32 = window
            .map(|(i, j)| {
                let at = picture.at((2 * x + i) as isize - 2, (2 * y + j) as isize - 2, Border::Mirror);
                weights[i] * weights[j] * u32::from(at)
            })
            .sum();
        ((sum + 128) / 256) as u8
    })
}

/// The central difference of `at` at `i` of `extent` values; at either end the difference to one side.
pub fn central(at: impl Fn(isize) -> f64, i: isize, extent: usize) -> f64 {
    let (low, high) = ((i - 1).max(0), (i + 1).min(extent as isize - 1));
    if low == high { 0.0 } else { (at(high) - at(low)) / (high - low) as f64 }
}

/// What the estimator `id` finds with these parameters between the first two frames.
pub fn flow(id: &str, settings: &[(&str, &str)], clip: &Clip) -> Flow {
    set(id, settings).run(clip, 0, &Threads::single()).expect("a run").flow().expect("a flow")
}

/// The size of pictures that are made here.
pub const SIZE: (usize, usize) = (96, 80);

/// Two frames of waves; what frame t + 1 shows at a place lay at `before` in frame t.
pub fn moving(before: impl Fn([f64; 2]) -> [f64; 2]) -> Clip {
    let frame = |place: &dyn Fn([f64; 2]) -> [f64; 2]| {
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let [x, y] = place([x as f64, y as f64]);
            (waves(x, y) + 0.5) as u8
        }))
    };
    Clip::from_frames("waves", vec![frame(&|place| place), frame(&before)]).expect("frames of one size")
}

/// A linear motion about the middle of the picture, x ← x + A (x − middle) + d, and frames that move so.
pub fn linear_motion(a: [[f64; 2]; 2], d: [f64; 2]) -> (Clip, Flow) {
    let middle = [(SIZE.0 as f64 - 1.0) / 2.0, (SIZE.1 as f64 - 1.0) / 2.0];
    let times = |m: [[f64; 2]; 2], p: [f64; 2]| [0, 1].map(|i| m[i][0] * p[0] + m[i][1] * p[1]);
    let forward = [[1.0 + a[0][0], a[0][1]], [a[1][0], 1.0 + a[1][1]]];
    let det = forward[0][0] * forward[1][1] - forward[0][1] * forward[1][0];
    let inverse = [[forward[1][1] / det, -forward[0][1] / det], [-forward[1][0] / det, forward[0][0] / det]];
    let clip = moving(|p| {
        let from_middle = [0, 1].map(|i| p[i] - middle[i] - d[i]);
        let back = times(inverse, from_middle);
        [0, 1].map(|i| middle[i] + back[i])
    });
    let truth = Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
        let moved = times(a, [x as f64 - middle[0], y as f64 - middle[1]]);
        [0, 1].map(|i| (moved[i] + d[i]) as f32)
    });
    (clip, Flow(truth))
}

/// Mean endpoint error in px, `margin` px away from the border.
pub fn error(found: &Flow, truth: &Flow, margin: usize) -> f64 {
    let inside = |x: usize, y: usize| (margin..SIZE.0 - margin).contains(&x) && (margin..SIZE.1 - margin).contains(&y);
    let truth = Flow(Grid::from_fn(SIZE.0, SIZE.1, |x, y| if inside(x, y) { truth.0[(x, y)] } else { Flow::UNKNOWN }));
    metrics::flow_error(found, &truth).expect("one size").expect("known pixels").epe_px
}

/// The step at the end of unit `unit` for the pixel at `place`.
pub fn explained_at(estimator: &dyn AnyEstimator, clip: &Clip, unit: usize, place: [f32; 2]) -> scene::Step {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
    walk.step(Some(Focus::current(place)))
}

/// A row of the table of facts of a step.
pub fn fact(step: &scene::Step, label: &str) -> Option<String> {
    step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Facts(facts) => facts.iter().find(|fact| fact.label == label).map(|fact| fact.value.clone()),
        _ => None,
    })
}

/// The numbers in a text, in their order.
pub fn numbers(text: &str) -> Vec<f64> {
    let plain = text.replace('−', "-").replace('\u{202f}', "");
    let parts = plain.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    parts.filter_map(|part| part.parse().ok()).collect()
}

/// A small picture that a step shows.
pub fn tile(step: &scene::Step, label: &str) -> Grid<f32> {
    let tiles = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Tiles(tiles) => Some(tiles),
        _ => None,
    });
    let tile = tiles.expect("tiles").iter().find(|tile| tile.label == label);
    tile.unwrap_or_else(|| panic!("no tile {label}")).values.clone()
}

/// The values of a line of a plot at the end of each unit: the last point is always that of the unit. At the end of the run, the plot
/// shows some of them.
pub fn plotted(estimator: &dyn AnyEstimator, clip: &Clip, title: &str, line: &str) -> Vec<f32> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let unit = walk.info().granularities.len() - 2;
    let mut values = Vec::new();
    while !walk.at_end() {
        walk.jump(Move::Granularity(unit, Direction::Forward));
        let points = points_of(&*walk, title, line);
        let [x, y] = *points.last().expect("a point");
        values.push(y);
        assert_eq!(x as usize, values.len(), "the unit at the cursor");
    }
    let points = points_of(&*walk, title, line);
    assert!(points.iter().all(|[x, y]| values[*x as usize - 1].to_bits() == y.to_bits()), "{points:?}");
    values
}

/// The points of a line of a plot.
fn points_of(walk: &dyn Walk, title: &str, line: &str) -> Vec<[f32; 2]> {
    let series = walk.step(None).readouts.into_iter().find_map(|readout| match readout {
        scene::Readout::Series(series) if series.title == title => Some(series),
        _ => None,
    });
    series.expect("a plot").lines.into_iter().find(|(name, ..)| *name == line).expect("a line").2
}

/// The plane of displacements that a step shows.
pub fn plane(step: &scene::Step) -> &scene::Plane {
    let plane = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Plane(plane) => Some(plane),
        _ => None,
    });
    plane.expect("a plane")
}

/// A point of the plane that a step shows.
pub fn point(step: &scene::Step, name: &str) -> [f32; 2] {
    plane(step).points.iter().find(|(known, ..)| *known == name).expect("a point").2
}

/// The lines of the equation that a step shows.
pub fn equation(step: &scene::Step) -> Vec<String> {
    let lines = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Equation(lines) => Some(lines.iter().map(scene::Math::plain).collect()),
        _ => None,
    });
    lines.expect("an equation")
}
