//! A bus that fills most of the picture of a shaking camera.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, mix, rgb, shade},
};

pub const SAMPLE: Sample = Sample {
    id: "passing-bus",
    title: "Passing bus: the dominant motion",
    teaches: "A bus fills most of the picture, so most matches lie on it: the dominant motion is not that of the camera.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path { pan: [0.5, 0.0], shake: [2.0, 2.0], roll: 0.001 },
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let motion = Motion { velocity: [-4.0, 0.0], ..Motion::still([205.0, 124.0]) };
    vec![
        Layer::new(Shape::Rectangle { half: [150.0, 88.0], corner: 12.0 }, motion, rgb(0xd8a23a), move |spot| {
            side(seed, spot)
        })
        .object(1),
        Layer::new(Shape::Everywhere, Motion::still([0.0, 122.0]), rgb(0x6d7d5e), move |spot| {
            super::traffic::ground(seed + 90, spot)
        }),
    ]
}

/// The side of the bus: windows above, an advertisement below.
fn side(seed: u32, spot: Spot) -> Rgb {
    let paint = shade(rgb(0xd8a23a), 1.0 + 0.12 * spot.fractal(seed, 12.0, 4));
    let along = spot.x / 42.0 - f64::from(floor(spot.x / 42.0)) - 0.5;
    let pane = ((0.42 - along.abs()) * 42.0).min(20.0 - (spot.y + 46.0).abs());
    let glass = shade(rgb(0x2b4152), 1.0 + 0.5 * spot.fractal(seed + 7, 30.0, 4));
    let poster = (110.0 - spot.x.abs()).min(26.0 - (spot.y - 26.0).abs());
    let print = spot.warped(seed + 20, 14.0, 5.0).fractal(seed + 30, 10.0, 4);
    let shown = mix(rgb(0x7a1f3d), rgb(0xf3e9d2), 0.5 + 0.9 * print);
    mix(mix(paint, glass, spot.cover(pane)), shown, spot.cover(poster))
}
