//! Wallpaper with a leaf pattern that is the same every 24 px.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::{cos, floor},
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, mix, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "wallpaper",
    title: "Wallpaper: ambiguous matches",
    teaches: "The texture repeats every 24 px: a search range of 32 px has several equally deep minima, and only one is the motion.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

/// Distance between two equal leaves.
const PERIOD: f64 = 24.0;

fn layers(_: &Setting) -> Vec<Layer> {
    vec![Layer::new(Shape::Everywhere, Motion::drift([5.0, 2.0]), rgb(0x3f7272), leaves)]
}

fn leaves(spot: Spot) -> Rgb {
    let within = |v: f64| v - f64::from(floor(v / PERIOD)) * PERIOD - PERIOD / 2.0;
    let (x, y) = (within(spot.x), within(spot.y));
    // A leaf is where two circles meet; it leans over, and its twin leans the other way.
    let leaf = |x: f64, y: f64, lean: f64| {
        let (u, v) = (0.8 * x + 0.6 * lean * y, 0.8 * y - 0.6 * lean * x);
        let side = |s: f64| 10.5 - ((u - s * 7.0) * (u - s * 7.0) + v * v).sqrt();
        (side(1.0).min(side(-1.0)), u)
    };
    let (right, right_rib) = leaf(x - 4.6, y - 1.0, -1.0);
    let (left, left_rib) = leaf(x + 4.6, y - 1.0, 1.0);
    let berry = 2.1 - (x * x + (y + 8.2) * (y + 8.2)).sqrt();
    let weave = 0.5 + 0.5 * cos(spot.x / PERIOD * 3.0) * cos(spot.y / PERIOD * 3.0);
    let ground = mix(rgb(0x1f4f55), rgb(0x2c646a), weave as f32);
    let blade = |color, inside: f64, rib: f64, lit| {
        mix(color, mix(rgb(0x50756a), lit, spot.cover(rib.abs() - 0.5)), spot.cover(inside))
    };
    let color = blade(ground, right, right_rib, rgb(0xd9c98a));
    let color = blade(color, left, left_rib, rgb(0x9fbf93));
    mix(color, rgb(0xd97757), spot.cover(berry))
}
