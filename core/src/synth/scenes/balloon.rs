//! A plain balloon drifts through a hazy sky: its outline is the strongest edge.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "balloon",
    title: "Balloon: an object with a clear outline",
    teaches: "A plain balloon has its strongest edges at its outline, so an active contour holds on to it. With the ball of the tunnel, which has \
              bands, the contour slips onto the edges inside.",
    tune: |d| d.frames = 40,
    path: Path::REST,
    scenery: Scenery::Flat(layers),
};

/// The radii of the balloon.
const RADII: [f64; 2] = [26.0, 31.0];

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let drift = Motion { velocity: [2.5, -0.5], ..Motion::still([64.0, 128.0]) };
    vec![
        Layer::new(Shape::Ellipse { radii: RADII }, drift, rgb(0xb23a2e), balloon).object(1).round(setting),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), rgb(0xbfd4e2), move |spot| sky(seed, spot)),
    ]
}

/// One colour, a little darker at the border.
fn balloon(spot: Spot) -> Rgb {
    let [x, y] = [spot.x / RADII[0], spot.y / RADII[1]];
    let radius = (x * x + y * y).sqrt() as f32;
    shade(rgb(0xb23a2e), 1.06 - 0.16 * smooth(1.2 * radius - 0.2))
}

fn sky(seed: u32, spot: Spot) -> Rgb {
    let haze = spot.warped(seed, 80.0, 20.0).fractal(seed + 10, 48.0, 4);
    let depth = (spot.y / 240.0) as f32;
    ramp(&[rgb(0x9fc0da), rgb(0xc6dae6), rgb(0xe6ebe6)], 0.3 + 0.5 * depth + 0.25 * haze)
}
