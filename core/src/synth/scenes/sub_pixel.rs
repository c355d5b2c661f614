//! A pebble beach under a slowly drifting camera.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    random::part,
    shape::Shape,
    texture::{Rgb, Spot, cell, mix, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "sub-pixel",
    title: "Pebbles: sub-pixel motion",
    teaches: "Every pixel moves by (0.5, 0.25) px per frame. Whole-pixel vectors cannot represent this; gradient \
              methods and sub-pixel refinement can.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let velocity = [0.5 / setting.scale, 0.25 / setting.scale];
    vec![Layer::new(Shape::Everywhere, Motion::drift(velocity), rgb(0x8d8a80), move |spot| pebbles(seed, spot))]
}

fn pebbles(seed: u32, spot: Spot) -> Rgb {
    const STONES: [Rgb; 6] = [rgb(0x5b6770), rgb(0x8e9aa0), rgb(0xc9bfae), rgb(0xe8e2d4), rgb(0xa8876a), rgb(0x6e5a50)];
    let pebble = cell(seed, spot.warped(seed + 5, 30.0, 4.0), 24.0);
    let stone = ramp(&STONES, part(pebble.hash, 2) as f32);
    let veins = spot.relative(pebble.offset, 1.0).fractal(seed + (pebble.hash & 63), 14.0, 2);
    let lit = 1.0 - 0.22 * (pebble.offset[0] + pebble.offset[1]) as f32 + 0.14 * veins;
    let dome = smooth((pebble.border / 0.16) as f32);
    mix(rgb(0x2b2a2b), shade(stone, lit), dome)
}
