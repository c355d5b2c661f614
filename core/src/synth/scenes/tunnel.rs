//! A red ball rolls across a lawn and through a tunnel that hides the whole of it.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::Shape,
    texture::{Rgb, Spot, mix, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "tunnel",
    title: "Tunnel: an object hidden for some frames",
    teaches: "The tunnel hides the whole ball for 7 frames. A tracker that searches around the last position loses it at the entrance; one that \
              predicts a velocity, as the particle filter does, finds the ball at the exit.",
    tune: |d| d.frames = 40,
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

/// The radius of the ball.
pub(super) const RADIUS: f64 = 16.0;

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let ball = Motion { velocity: [5.5, 0.0], spin: 0.04, ..Motion::still([42.0, 128.0]) };
    vec![
        Layer::new(
            Shape::Rectangle { half: [34.0, 44.0], corner: 4.0 },
            Motion::still([160.0, 124.0]),
            rgb(0x9a9a94),
            move |spot| masonry(seed, spot),
        ),
        Layer::new(Shape::disc(RADIUS), ball, rgb(0xc4302b), move |spot| ball_with_bands(seed + 40, spot))
            .object(1)
            .round(setting),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), rgb(0x6f8f5a), move |spot| lawn(seed + 90, spot)),
    ]
}

/// A red ball with two light bands and a dark seam.
pub(super) fn ball_with_bands(seed: u32, spot: Spot) -> Rgb {
    let radius = ((spot.x * spot.x + spot.y * spot.y).sqrt() / RADIUS) as f32;
    let leather = 1.08 - 0.4 * smooth(1.2 * radius - 0.25) + 0.1 * spot.fractal(seed, 7.0, 2);
    let band = 1.8 - (spot.y.abs() - 6.5).abs();
    let seam = 0.8 - spot.x.abs();
    let color = mix(rgb(0xc4302b), rgb(0xf3e3c6), spot.cover(band));
    shade(mix(color, rgb(0x3a1512), spot.cover(seam)), leather)
}

fn masonry(seed: u32, spot: Spot) -> Rgb {
    let row = floor(spot.y / 11.0);
    let shifted = spot.x + 9.0 * f64::from(row & 1);
    let block = lattice(seed, floor(shifted / 18.0), row);
    let (along, up) = (shifted / 18.0 - f64::from(floor(shifted / 18.0)), spot.y / 11.0 - f64::from(row));
    let gap = (along.min(1.0 - along) * 18.0).min(up.min(1.0 - up) * 11.0);
    let color = ramp(&[rgb(0x7d7f80), rgb(0xa9a79e), rgb(0xc3c0b4)], 0.2 + 0.6 * part(block, 0) as f32);
    let rough = shade(color, 1.0 + 0.12 * spot.fractal(seed + 10, 8.0, 3));
    mix(shade(rough, 0.55), rough, spot.cover(gap - 0.7))
}

pub(super) fn lawn(seed: u32, spot: Spot) -> Rgb {
    let grass = spot.warped(seed, 26.0, 6.0).fractal(seed + 10, 22.0, 5);
    ramp(&[rgb(0x3f6238), rgb(0x6f9455), rgb(0xa5b776)], 0.5 + 0.55 * grass)
}
