//! Two equal boats row side by side over a lake, seen from above.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, mix, ramp, rgb, shade},
};

pub const SAMPLE: Sample = Sample {
    id: "formation",
    title: "Formation: two objects side by side",
    teaches: "Two boats keep a distance of 10 px for the whole clip. Where the noise of the detections is large for this distance, each lies in \
              the gate of both tracks. Soft association then averages them and can draw the tracks together (coalescence); at the default noise \
              it keeps them apart. Hypotheses assign each detection to one track.",
    tune: |d| d.frames = 48,
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

/// The radii of a boat.
const RADII: [f64; 2] = [15.0, 4.0];
/// The distance of the boats from the middle between them.
const APART: f64 = 5.0;

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let boat = |id: u32, y: f64| {
        let motion = Motion { velocity: [5.0, 0.0], ..Motion::still([36.0, 120.0 + y]) };
        Layer::new(Shape::Ellipse { radii: RADII }, motion, rgb(0xd9a066), deck).object(id).round(setting)
    };
    vec![
        boat(1, -APART),
        boat(2, APART),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), rgb(0x2f6f86), move |spot| lake(seed, spot)),
    ]
}

/// Planks with two seats.
fn deck(spot: Spot) -> Rgb {
    let plank = shade(rgb(0xd9a066), 1.05 - 0.03 * (spot.y * spot.y) as f32 / 4.0);
    let seat = 1.2 - (spot.x.abs() - 5.0).abs();
    mix(plank, rgb(0x6b4226), spot.cover(seat))
}

fn lake(seed: u32, spot: Spot) -> Rgb {
    let waves = spot.warped(seed, 40.0, 10.0).fractal(seed + 10, 18.0, 4);
    ramp(&[rgb(0x1f5468), rgb(0x2f6f86), rgb(0x4f93a3)], 0.5 + 0.5 * waves)
}
