//! A round sign flies past a wall, nearly by its radius from frame to frame: the reach of trackers without a prediction.

use super::{spinning_sign::sign, still_life::mottled};
use crate::synth::{Sample, Scenery, Setting, layer::Layer, motion::Motion, path::Path, shape::Shape, texture::rgb};

pub const SAMPLE: Sample = Sample {
    id: "fast-flight",
    title: "Fast flight: motion by the radius of the object",
    teaches: "The sign moves by 22 px per frame, and has a radius of 24 px. The iterations of a template do not converge from so far away; mean shift \
              still meets a part of the object in its ellipse and climbs to the whole.",
    tune: |d| d.frames = 12,
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let motion = Motion { velocity: [22.0, 0.0], ..Motion::still([30.0, 108.0]) };
    let wall = [rgb(0x53606a), rgb(0x74838c), rgb(0x98a4a8), rgb(0xb7c0bf)];
    vec![
        Layer::new(Shape::disc(24.0), motion, rgb(0xd8a021), sign).object(1).round(setting),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), wall[1], move |spot| mottled(seed, 30.0, wall, spot)),
    ]
}
