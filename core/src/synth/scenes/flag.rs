//! A flag in the wind.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::{Motion, Wave},
    path::Path,
    shape::{Shape, length},
    texture::{Rgb, Spot, mix, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "flag",
    title: "Flag in the wind: non-rigid motion",
    teaches: "Motion varies smoothly from point to point. Dense flow can represent it; one vector per block cannot.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let emblem = Shape::star(8, 30.0, 17.0);
    let wave = Wave { height: 16.0, wavelength: 130.0, period: 16.0, reach: 210.0 };
    let cloth = Motion { wave: Some(wave), ..Motion::still([62.0, 110.0]) };
    vec![
        Layer::new(
            Shape::Rectangle { half: [6.0, 400.0], corner: 5.0 },
            Motion::still([56.0, 426.0]),
            rgb(0xd8d3c8),
            |spot| shade(rgb(0xe6e0d2), 1.05 - 0.55 * smooth(((spot.x + 2.0) / 8.0).abs() as f32)),
        ),
        Layer::new(
            // The cloth is held at x = 0, so its shape is drawn from there.
            Shape::Polygon(vec![[0.0, -68.0], [212.0, -68.0], [212.0, 68.0], [0.0, 68.0]]),
            cloth,
            rgb(0xcf9a6a),
            move |spot| weave(seed, spot, &emblem),
        )
        .object(1),
        Layer::new(Shape::Everywhere, Motion::drift([1.0, 0.0]), rgb(0x9cc3dd), move |spot| sky(seed + 100, spot)),
    ]
}

/// Three bands with a star.
fn weave(seed: u32, spot: Spot, emblem: &Shape) -> Rgb {
    let bands = mix(rgb(0x1f6f78), rgb(0xf4ecd8), spot.cover(spot.y + 23.0));
    let bands = mix(bands, rgb(0xd9603b), spot.cover(spot.y - 23.0));
    let from_star = [spot.x - 74.0, spot.y];
    let star = if length(from_star) < 34.0 { spot.cover(emblem.inside(from_star)) } else { 0.0 };
    let color = mix(bands, rgb(0xe9ae3f), star);
    let threads =
        spot.streaks(seed, 5.0, 3.0, 2) + 0.6 * Spot { x: spot.y, y: spot.x, ..spot }.streaks(seed + 10, 5.0, 3.0, 2);
    let hem = 3.0 - (212.0 - spot.x).min(68.0 - spot.y.abs());
    shade(mix(color, shade(color, 0.8), spot.cover(hem)), 0.98 + 0.13 * threads)
}

fn sky(seed: u32, spot: Spot) -> Rgb {
    let clouds = smooth(0.1 + 1.25 * spot.warped(seed, 80.0, 16.0).streaks(seed + 10, 56.0, 1.8, 4));
    let air = mix(rgb(0x5d9ecb), rgb(0xb5d8e8), smooth((spot.y / 240.0) as f32));
    mix(air, rgb(0xf8fafa), 0.85 * clouds)
}
