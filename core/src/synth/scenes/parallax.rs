//! Seen from a train: pines rush by, mountains hardly move.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::{floor, sin, there_and_back},
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::Shape,
    texture::{Rgb, Spot, mix, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "parallax",
    title: "From the train: motion parallax",
    teaches: "Layers at different depths move at different speeds, so motion alone segments the pines from the hills.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    vec![
        Layer::new(pines(seed), Motion::drift([-7.0, 0.0]), rgb(0x1d3b33), move |spot| needles(seed + 100, spot)),
        Layer::new(ridge(176.0, 16.0, 210.0), Motion::drift([-3.0, 0.0]), rgb(0x5d8a5c), move |spot| {
            meadow(seed + 200, spot)
        }),
        Layer::new(ridge(136.0, 20.0, 260.0), Motion::drift([-1.5, 0.0]), rgb(0x6f9aa0), move |spot| {
            rock(seed + 300, spot, [rgb(0x3f6c78), rgb(0x6c9ba2), rgb(0xa3c3bf)])
        }),
        Layer::new(peaks(seed), Motion::drift([-0.75, 0.0]), rgb(0xa9bccb), move |spot| snow(seed + 400, spot)),
        Layer::new(Shape::Everywhere, Motion::drift([-0.25, 0.0]), rgb(0xf3d3ab), move |spot| {
            super::pillar::sky(seed + 500, spot)
        }),
    ]
}

fn ridge(level: f64, height: f64, wavelength: f64) -> Shape {
    Shape::below([level - 1.45 * height, level + 1.45 * height], move |x| {
        level
            - height * (sin(x / wavelength + 0.1) + 0.35 * sin(x * 2.7 / wavelength) + 0.1 * sin(x * 7.3 / wavelength))
    })
}

/// One mountain per 120 units, each of its own height, with a rugged edge.
fn peaks(seed: u32) -> Shape {
    Shape::below([47.0, 183.0], move |x| {
        let flank = |i: i32| {
            let h = lattice(seed + 41, i, 0);
            let top = (f64::from(i) + 0.3 + 0.4 * part(h, 0)) * 120.0;
            50.0 + 40.0 * part(h, 1) + (x - top).abs() * 0.75
        };
        let here = floor(x / 120.0);
        let edge = (here - 1..=here + 1).map(flank).fold(f64::MAX, f64::min);
        edge + 2.0 * sin(x / 17.0) + sin(x / 7.3)
    })
}

/// Firs of different heights in front of a low bank.
fn pines(seed: u32) -> Shape {
    Shape::below([90.0, 216.0], move |x| {
        let tree = |i: i32| {
            let h = lattice(seed, i, 0);
            let middle = (f64::from(i) + 0.25 + 0.5 * part(h, 0)) * 46.0;
            let top = 92.0 + 70.0 * part(h, 1);
            let out = (x - middle).abs();
            // The boughs stand out from a cone.
            top + 4.4 * out + 8.0 * (1.0 - there_and_back(out + 2.6, 2.6) / 2.6)
        };
        // A tree stands within its own 46 units, and only its nearer neighbour can reach over.
        let here = floor(x / 46.0 + 0.5);
        let trees = tree(here - 1).min(tree(here));
        trees.min(212.0 + 4.0 * sin(x / 90.0))
    })
}

fn needles(seed: u32, spot: Spot) -> Rgb {
    let boughs = spot.streaks(seed + 10, 7.0, 1.6, 3) + 0.5 * spot.fractal(seed + 20, 24.0, 1);
    ramp(&[rgb(0x0b1f1d), rgb(0x1b4238), rgb(0x3f7350)], 0.42 + 0.4 * boughs)
}

fn meadow(seed: u32, spot: Spot) -> Rgb {
    let fields = spot.streaks(seed, 36.0, 2.0, 4);
    let light = smooth(1.0 - ((spot.y - 150.0) / 90.0) as f32);
    ramp(&[rgb(0x2f5d4a), rgb(0x5f9158), rgb(0xb5bf6b)], 0.25 + 0.4 * light + 0.45 * fields)
}

fn rock(seed: u32, spot: Spot, colors: [Rgb; 3]) -> Rgb {
    let woods = spot.warped(seed, 40.0, 8.0).fractal(seed + 10, 30.0, 4);
    ramp(&colors, 0.5 + 0.6 * woods)
}

fn snow(seed: u32, spot: Spot) -> Rgb {
    let cliffs = spot.warped(seed, 50.0, 16.0).streaks(seed + 10, 34.0, 0.6, 4);
    let bare = smooth(((spot.y - 74.0) / 50.0) as f32 + 0.6 * cliffs);
    let white = shade(rgb(0xf4f7fa), 0.94 + 0.14 * cliffs);
    mix(white, ramp(&[rgb(0x55708c), rgb(0x8ea7bb), rgb(0xc3d2dc)], 0.5 + 0.7 * cliffs), bare)
}
