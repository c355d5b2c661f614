//! Paper cut-outs slide over a table: three rigid motions, each a translation, and a table that drifts.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, ramp, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "rigid-layers",
    title: "Rigid layers: three motions",
    teaches: "A disc and a card move rigidly over a drifting table. In the plane of displacements, each layer is one point, so \
              clustering the true flow gives the true segments.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let slide = |from, velocity| Motion { velocity, ..Motion::still(from) };
    let paper = |seed: u32, colors: [Rgb; 3]| move |spot: Spot| speckled(seed, spot, colors);
    let disc = paper(seed, [rgb(0x8c2f1b), rgb(0xd9633b), rgb(0xf6c08a)]);
    let card = paper(seed + 100, [rgb(0x16405b), rgb(0x2f7fa8), rgb(0xa9dbe8)]);
    let table = paper(seed + 200, [rgb(0x4b3a2a), rgb(0x8c7355), rgb(0xd8c7a6)]);
    vec![
        Layer::new(Shape::disc(46.0), slide([86.0, 92.0], [2.0, 1.0]), rgb(0xd9633b), disc).object(1).round(setting),
        Layer::new(
            Shape::Rectangle { half: [52.0, 38.0], corner: 6.0 },
            slide([226.0, 150.0], [-2.0, 0.5]),
            rgb(0x2f7fa8),
            card,
        )
        .object(2)
        .round(setting),
        Layer::new(Shape::Everywhere, slide([0.0, 0.0], [0.5, -1.0]), rgb(0x8c7355), table),
    ]
}

/// Paper with coarse and fine speckles, so that every place has texture.
pub(super) fn speckled(seed: u32, spot: Spot, colors: [Rgb; 3]) -> Rgb {
    let grain = spot.warped(seed, 22.0, 5.0).fractal(seed + 10, 18.0, 3) + 0.4 * spot.fractal(seed + 20, 6.0, 2);
    ramp(&colors, 0.5 + 0.7 * grain)
}
