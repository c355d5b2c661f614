//! Two equal stars fly towards each other at night, and pass.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::{Shape, length},
    texture::{Rgb, Spot, mix, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "crossing-stars",
    title: "Crossing stars: data association",
    teaches: "Two objects of equal appearance meet and part: only a motion model keeps their identities apart. With \
              a rotation of 6°/frame both fly in turns, which a coordinated turn predicts and constant velocity does not.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let fly = |from, velocity, spin| Motion { velocity, spin, ..Motion::still(from) };
    let star = || Shape::star(5, 30.0, 14.5);
    vec![
        Layer::new(star(), fly([48.0, 62.0], [9.5, 4.0], 0.01), rgb(0xf2c14e), move |spot| gold(seed, spot))
            .object(1)
            .round(setting),
        Layer::new(star(), fly([272.0, 66.0], [-9.5, 4.0], -0.01), rgb(0xf2c14e), move |spot| gold(seed, spot))
            .object(2)
            .round(setting),
        Layer::new(Shape::Everywhere, Motion::drift([0.5, 0.0]), rgb(0x1d2a4d), move |spot| night(seed + 100, spot)),
    ]
}

/// How bright the far star is that shines here, if one does: there is one in each square of 17 units.
fn far_star(seed: u32, spot: Spot) -> f32 {
    let square = [spot.x, spot.y].map(|c| floor(c / 17.0));
    let star = lattice(seed, square[0], square[1]);
    let from = |c: f64, square: i32, index| c - (f64::from(square) + 0.15 + 0.7 * part(star, index)) * 17.0;
    let distance = length([from(spot.x, square[0], 0), from(spot.y, square[1], 1)]);
    let bright = part(star, 2) as f32;
    smooth(1.4 - distance as f32 * 0.7) * bright * bright
}

fn gold(seed: u32, spot: Spot) -> Rgb {
    let radius = (length([spot.x, spot.y]) / 30.0) as f32;
    let hammered = spot.fractal(seed, 11.0, 3);
    let color = ramp(&[rgb(0xfff3c4), rgb(0xf6c445), rgb(0xd98324)], radius * 1.1 + 0.3 * hammered);
    shade(color, 1.0 + 0.1 * hammered)
}

fn night(seed: u32, spot: Spot) -> Rgb {
    let clouds = spot.warped(seed, 90.0, 26.0).fractal(seed + 10, 60.0, 4);
    let depth = (spot.y / 240.0) as f32;
    let air = ramp(&[rgb(0x0d1433), rgb(0x1d2a5c), rgb(0x4a3b72), rgb(0x8a5a7d)], 0.6 * depth + 0.35 * clouds + 0.15);
    mix(air, rgb(0xeef2ff), far_star(seed + 20, spot))
}
