//! A road from above with a lane for each direction, and a car that drives against its lane.

use super::traffic::{car, ground};
use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::{Point, Shape},
    texture::rgb,
};

pub const SAMPLE: Sample = Sample {
    id: "wrong-way",
    title: "Wrong way: a car against its lane",
    teaches: "Three cars drive along each lane, and later one drives against them. Its trajectory crosses the counting line in the other \
              direction, and its heading differs from those of the other cars at the same place.",
    tune: |d| d.frames = 80,
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

/// The middles of the lanes to the left and to the right, in units of the scene.
const LEFT: f64 = 99.0;
const RIGHT: f64 = 145.0;

fn layers(setting: &Setting) -> Vec<Layer> {
    let drive = |from: Point, speed: f64| {
        let turned = if speed < 0.0 { 0.5 } else { 0.0 };
        Motion { velocity: [speed, 0.0], turned, ..Motion::still(from) }
    };
    let seed = setting.seed;
    let cars = [
        (1, drive([60.0, RIGHT], 10.0), 0xc8322b),
        (2, drive([140.0, RIGHT], 10.0), 0x2f6db3),
        (3, drive([220.0, RIGHT], 10.0), 0xeeeae0),
        (4, drive([250.0, LEFT], -6.0), 0x3d8f6b),
        (5, drive([370.0, LEFT], -6.0), 0x8a5aa8),
        (6, drive([490.0, LEFT], -6.0), 0x5c6f7a),
        // It enters in frame 50. The last car to the right left in frame 28, so no track coasts at the border any more.
        (7, drive([942.0, RIGHT], -12.0), 0xf2c230),
    ];
    let ground =
        Layer::new(Shape::Everywhere, Motion::still([0.0, 122.0]), rgb(0x6d7d5e), move |spot| ground(seed + 90, spot));
    cars.into_iter().map(|(id, motion, color)| car(setting, id, motion, color)).chain([ground]).collect()
}
