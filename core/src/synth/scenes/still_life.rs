//! A table with three balls before a wall, seen by two cameras.

use crate::synth::{
    Sample, Scenery, Setting,
    maths::sin,
    path::Path,
    space::{Body, Form, Rig},
    texture::{Rgb, Spot, ramp, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "still-life",
    title: "Still life: planes and spheres in stereo",
    teaches: "Two cameras 12 cm apart see a table, a wall and three balls, all with texture: the disparity is f B / Z, so near things have \
              a large one. Two of the balls move in depth.",
    tune: |_| {},
    scenery: Scenery::Deep(bodies, Rig::REST),
    path: Path::REST,
};

fn bodies(setting: &Setting) -> Vec<Body> {
    let seed = setting.seed;
    let wall = Form::upright([0.0, 0.0, 3.6], 0.06, [f64::INFINITY; 2]);
    // Where the view is so wide that it passes the wall.
    let far = Form::upright([0.0, 0.0, 12.0], 0.0, [f64::INFINITY; 2]);
    // A table that recedes: its second direction leads away from the cameras, and a little up.
    let table =
        Form::Plane { at: [0.0, 0.55, 2.0], along: [[1.0, 0.0, 0.0], [0.0, -0.28, 0.96]], half: [f64::INFINITY, 1.2] };
    let ball = |at, radius| Form::Sphere { at, radius };
    let paint =
        |offset: u32, wavelength: f64, inks: [Rgb; 4]| move |spot: Spot| mottled(seed + offset, wavelength, inks, spot);
    let plain = rgb(0x808080);
    vec![
        Body::new(far, plain, paint(600, 60.0, [rgb(0x5d6b75), rgb(0x8fa0a8), rgb(0xc2cdd0), rgb(0xeef2f2)])),
        Body::new(wall, plain, paint(100, 26.0, [rgb(0x1f3d4a), rgb(0x3f7f83), rgb(0xb9cfae), rgb(0xf0e6c8)])),
        Body::new(table, plain, paint(200, 18.0, [rgb(0x2b1a12), rgb(0x6e4426), rgb(0xb98550), rgb(0xe9d3a6)])),
        Body::new(
            ball([-0.42, 0.14, 1.9], 0.26),
            plain,
            paint(300, 15.0, [rgb(0x3d0f14), rgb(0xa32c2c), rgb(0xe58a5a), rgb(0xfbe7c6)]),
        )
        .moving(|t| [0.0, 0.0, -0.25 * sin(t / 48.0)]),
        Body::new(
            ball([0.12, 0.22, 1.45], 0.2),
            plain,
            paint(400, 12.0, [rgb(0x102a43), rgb(0x2f6690), rgb(0x81b1d5), rgb(0xf4f7fb)]),
        ),
        Body::new(
            ball([0.62, -0.1, 2.4], 0.34),
            plain,
            paint(500, 16.0, [rgb(0x1b3a1a), rgb(0x4f8a3c), rgb(0xb7cf5a), rgb(0xf7f3c9)]),
        )
        .moving(|t| [-0.2 * sin(t / 40.0), 0.0, 0.3 * sin(t / 40.0)]),
    ]
}

/// Mottled paint with detail at every size, which no place shares with another.
pub fn mottled(seed: u32, wavelength: f64, inks: [Rgb; 4], spot: Spot) -> Rgb {
    let pattern = spot.warped(seed, 2.0 * wavelength, 0.4 * wavelength).fractal(seed + 10, wavelength, 4);
    ramp(&inks, 0.5 + 0.75 * pattern)
}
