//! Three things at which stereo fails, seen by two cameras: a repeating texture, none at all, and a narrow object before a far wall.

use crate::synth::{
    Sample, Scenery, Setting,
    maths::{cos, sin},
    path::Path,
    space::{Body, Form, Rig},
    texture::{Rgb, Spot, mix, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "stereo-traps",
    title: "Stereo traps: ambiguous, flat and hidden",
    teaches: "The left panel repeats every 6 cm, so several disparities fit equally well. The right panel has no texture, so all do. Beside \
              the near post the right camera sees other parts of the wall: half-occlusion.",
    tune: |_| {},
    scenery: Scenery::Deep(bodies, Rig::REST),
    path: Path::REST,
};

fn bodies(setting: &Setting) -> Vec<Body> {
    let seed = setting.seed;
    let wall = Form::upright([0.0, 0.0, 4.0], 0.0, [f64::INFINITY; 2]);
    let left = Form::upright([-0.62, 0.0, 2.0], 0.0, [0.34, 0.6]);
    let right = Form::upright([0.66, 0.0, 2.2], 0.0, [0.36, 0.6]);
    let post = Form::upright([0.02, 0.0, 1.2], 0.0, [0.05, 1.0]);
    let inks = [rgb(0x2d2a32), rgb(0x7a6f6b), rgb(0xc9bfae), rgb(0xf5efe2)];
    let bark = [rgb(0x24140b), rgb(0x6b4226), rgb(0xa97142), rgb(0xe0c090)];
    vec![
        Body::new(wall, rgb(0x8d8a86), move |spot| super::still_life::mottled(seed + 100, 22.0, inks, spot)),
        Body::new(left, rgb(0x4f7f8f), trellis),
        Body::new(right, rgb(0xd8d2c4), |_| rgb(0xd8d2c4)),
        // It sways, so that there is motion as well.
        Body::new(post, rgb(0x6b4226), move |spot| super::still_life::mottled(seed + 200, 9.0, bark, spot))
            .moving(|t| [0.08 * sin(t / 36.0), 0.0, 0.0]),
    ]
}

/// Length after which the trellis is the same again, in units of the texture: 6 cm.
const PERIOD: f64 = 9.0;

fn trellis(spot: Spot) -> Rgb {
    let wave = cos(spot.x / PERIOD) + cos(spot.y / PERIOD);
    mix(rgb(0x1f4e5f), rgb(0xe3e9dc), (0.5 + 0.25 * wave) as f32)
}
