//! Marbled paper, drawn past at a whole number of pixels per frame.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, ramp, rgb, shade},
};

pub const SAMPLE: Sample = Sample {
    id: "translation",
    title: "Marble: uniform translation",
    teaches: "Every pixel moves by (3, −2) px per frame: global motion, which every estimator must find.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

/// Always whole pixels, however large the picture.
fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let velocity = [3.0 / setting.scale, -2.0 / setting.scale];
    vec![Layer::new(Shape::Everywhere, Motion::drift(velocity), rgb(0x7fa3a8), move |spot| marble(seed, spot))]
}

/// Inks that were stirred and lifted off: bands of a noise whose place is pushed about by another.
pub fn marble(seed: u32, spot: Spot) -> Rgb {
    const INKS: [Rgb; 7] =
        [rgb(0x17324d), rgb(0x2a6f97), rgb(0x61a5c2), rgb(0xf3ead7), rgb(0xe9b872), rgb(0xc8553d), rgb(0x4a2a3c)];
    let stirred = spot.warped(seed, 80.0, 36.0);
    let bands = stirred.streaks(seed + 10, 34.0, 1.6, 3);
    let paper = spot.fractal(seed + 20, 10.0, 2);
    shade(ramp(&INKS, 0.5 + 0.6 * bands), 0.97 + 0.08 * paper)
}
