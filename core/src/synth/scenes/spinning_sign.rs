//! A round sign spins as it flies past a wall: an object that turns far between two frames.

use super::still_life::mottled;
use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, mix, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "spinning-sign",
    title: "Spinning sign: rotation between frames",
    teaches: "The sign turns by 90° from frame to frame. A template that is aligned from the last warp does not converge over such a rotation; a \
              colour histogram stays the same when its object turns, so mean shift follows.",
    tune: |d| d.frames = 40,
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

/// The radius of the sign.
const RADIUS: f64 = 24.0;

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let motion = Motion { velocity: [5.5, 0.5], spin: 90.0 / 360.0, ..Motion::still([60.0, 108.0]) };
    let wall = [rgb(0x53606a), rgb(0x74838c), rgb(0x98a4a8), rgb(0xb7c0bf)];
    vec![
        Layer::new(Shape::disc(RADIUS), motion, rgb(0xd8a021), sign).object(1).round(setting),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), wall[1], move |spot| mottled(seed, 30.0, wall, spot)),
    ]
}

/// A yellow field with a red half and a dark bar, which no rotation but the whole turn repeats.
pub(super) fn sign(spot: Spot) -> Rgb {
    let half = mix(rgb(0xd8a021), rgb(0xb3261e), spot.cover(spot.y - 4.0));
    let shaft = 4.0 - (spot.x + 6.0).abs();
    let dark = mix(half, rgb(0x1d1a22), spot.cover(shaft.min(15.0 - spot.y.abs())));
    let radius = (spot.x * spot.x + spot.y * spot.y).sqrt();
    mix(dark, rgb(0xf2ead2), spot.cover(radius - RADIUS + 3.0))
}
