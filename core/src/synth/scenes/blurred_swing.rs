//! A lantern swings fast before a long exposure: sharp where it turns round, blurred in between.

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
    id: "blurred-swing",
    title: "Blurred swing: motion blur that changes",
    teaches: "With the shutter open all the time, the swinging lantern is sharp where it turns round and smeared over 20 px in between. A \
              correlation filter knows the sharp pattern of bars and panes and loses it; hue and saturation change less, so mean shift on them follows.",
    tune: |d| {
        d.frames = 40;
        d.motion_blur = 100.0;
    },
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let motion = Motion { sway: [62.0, 0.0], period: 19.0, ..Motion::still([160.0, 120.0]) };
    let night = [rgb(0x10192b), rgb(0x1b2a44), rgb(0x2c4163), rgb(0x3c577c)];
    let half = [20.0, 26.0];
    vec![
        Layer::new(Shape::Rectangle { half, corner: 8.0 }, motion, rgb(0xe08a2e), lantern).object(1),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), night[1], move |spot| mottled(seed, 30.0, night, spot)),
    ]
}

/// Bright panes between narrow dark bars.
fn lantern(spot: Spot) -> Rgb {
    let along = (spot.x / 8.0 - (spot.x / 8.0).floor() - 0.5).abs() * 8.0;
    let pane = mix(rgb(0xe08a2e), rgb(0xffe08a), spot.cover(10.0 - spot.y.abs()));
    mix(pane, rgb(0x3a2413), spot.cover(1.6 - along))
}
