//! A red ball rolls from a lawn over fallen leaves of its own colour, while the light changes.

use super::tunnel::{RADIUS, ball_with_bands, lawn};
use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    random::part,
    shape::Shape,
    texture::{Rgb, Spot, cell, mix, ramp, rgb, shade},
};

pub const SAMPLE: Sample = Sample {
    id: "leaves",
    title: "Fallen leaves: clutter of like colour",
    teaches: "The leaves have the hue of the ball, which grows, and the light changes. A tracker that counts pixels by hue, as CamShift does, \
              spreads over the leaves; a correlation filter knows the pattern of the ball and stays on it. Mean shift in a loose region (18,114,66,162) needs \
              the background-weighted histogram.",
    tune: |d| (d.frames, d.gain) = (36, 2.0),
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let ball = Motion { velocity: [4.5, -0.5], spin: 0.006, growth: 0.008, ..Motion::still([42.0, 138.0]) };
    vec![
        Layer::new(Shape::disc(RADIUS), ball, rgb(0xc4302b), move |spot| ball_with_bands(seed + 40, spot)).object(1),
        Layer::new(Shape::Ellipse { radii: [86.0, 92.0] }, Motion::still([214.0, 124.0]), rgb(0xa63a28), move |spot| {
            heap(seed + 60, spot)
        }),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), rgb(0x6f8f5a), move |spot| lawn(seed + 90, spot)),
    ]
}

/// Leaves of reds and browns beside each other.
fn heap(seed: u32, spot: Spot) -> Rgb {
    let leaf = cell(seed, spot.warped(seed + 3, 12.0, 3.0), 9.0);
    let color = ramp(&[rgb(0x8e2a20), rgb(0xc2352a), rgb(0xcf4a2c), rgb(0x9c3a26)], part(leaf.hash, 1) as f32);
    let vein = 0.5 - (leaf.offset[0] - leaf.offset[1]).abs() * 9.0;
    let lit = shade(color, 0.92 + 0.3 * part(leaf.hash, 2) as f32 + 0.1 * spot.fractal(seed + 20, 6.0, 2));
    let veined = mix(lit, shade(lit, 0.7), spot.cover(vein));
    mix(rgb(0x4a2018), veined, spot.cover(leaf.border * 9.0 - 0.5))
}
