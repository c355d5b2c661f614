//! A record turns on its player, and a cover slides past: rigid motions that are no translations.

use super::rigid_layers::speckled;
use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "turntable",
    title: "Turntable: one rigid motion, many displacements",
    teaches: "A record turns, so each of its pixels has another displacement although they move together. Clustering displacements \
              cuts it into pieces; affine layers find it as one.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let paper = |seed: u32, colors: [Rgb; 3]| move |spot: Spot| speckled(seed, spot, colors);
    let record = Motion { spin: 3.0 / 360.0, ..Motion::still([124.0, 124.0]) };
    let cover = Motion { velocity: [-1.5, 1.0], ..Motion::still([270.0, 76.0]) };
    vec![
        Layer::new(
            Shape::Rectangle { half: [38.0, 38.0], corner: 3.0 },
            cover,
            rgb(0xc9a227),
            paper(seed, [rgb(0x7a5a10), rgb(0xc9a227), rgb(0xf5e6a8)]),
        )
        .object(1)
        .round(setting),
        Layer::new(
            Shape::disc(96.0),
            record,
            rgb(0x3b3b46),
            paper(seed + 100, [rgb(0x14141a), rgb(0x4a4a58), rgb(0xa8a8bc)]),
        )
        .object(2),
        Layer::new(
            Shape::Everywhere,
            Motion::still([0.0, 0.0]),
            rgb(0x6e5138),
            paper(seed + 200, [rgb(0x3c2a1b), rgb(0x7a5b40), rgb(0xc2a483)]),
        ),
    ]
}
