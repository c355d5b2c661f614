//! A street, seen by two cameras on a car that drives along it.

use super::still_life::mottled;
use super::turning_box::face;
use crate::data::Pose;
use crate::synth::{
    Sample, Scenery, Setting,
    maths::{sin, sin_cos},
    path::Path,
    space::{Body, Form, Rig, Vector},
    texture::{Rgb, Spot, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "drive",
    title: "Drive: moving objects seen from a moving car",
    teaches: "Two cameras 50 cm apart drive along a street, 31 cm in each frame. A car ahead drives at 22 cm, and a pedestrian crosses. \
              In the picture all moves; in space only these two do.",
    tune: |d| d.frames = 24,
    scenery: Scenery::Deep(bodies, Rig { baseline_m: 0.5, view }),
    path: Path::REST,
};

/// Height of the cameras above the street in m.
const HEIGHT: f64 = 1.2;
/// Frames in which a drive would return to its start: its distance is a sine, so that nothing is ever reached.
const PERIOD: f64 = 160.0;

/// The distance in m after `t` frames at a first speed of `speed` m a frame.
fn driven(speed: f64, t: f64) -> f64 {
    speed * PERIOD / std::f64::consts::TAU * sin(t / PERIOD)
}

/// The cameras drive forwards and turn a little.
fn view(t: f64) -> Pose {
    let about = Pose::tilted(sin_cos(-0.006 * sin(t / 48.0)), (0.0, 1.0), [0.0; 3]);
    let place = [0.1 * sin(t / 60.0), 0.0, driven(0.314, t)];
    Pose { translation: about.turned(place.map(|c| -c)), ..about }
}

/// Half the sides of the car ahead in m.
const CAR: Vector = [0.85, 0.65, 1.7];
/// The same of the pedestrian.
const PEDESTRIAN: Vector = [0.25, 0.85, 0.2];

fn car(t: f64) -> Pose {
    Pose { translation: [0.5, HEIGHT - CAR[1], 10.5 + driven(0.22, t)], ..Pose::IDENTITY }
}

fn pedestrian(t: f64) -> Pose {
    Pose { translation: [-2.6 + driven(0.07, t), HEIGHT - PEDESTRIAN[1], 11.5], ..Pose::IDENTITY }
}

fn bodies(setting: &Setting) -> Vec<Body> {
    let seed = setting.seed;
    let mut all = street(seed);
    all.extend(cuboid(CAR, seed + 1000, [rgb(0x5a0f16), rgb(0xa3262b), rgb(0xd96a55), rgb(0xf3d0bd)], 1, car));
    let coat = [rgb(0x122a4f), rgb(0x2b5f9a), rgb(0x7fb2dd), rgb(0xf1f6fa)];
    all.extend(cuboid(PEDESTRIAN, seed + 2000, coat, 2, pedestrian));
    all
}

/// Street, house fronts, trees, and a parked car.
fn street(seed: u32) -> Vec<Body> {
    let paint =
        |offset: u32, wavelength: f64, inks: [Rgb; 4]| move |spot: Spot| mottled(seed + offset, wavelength, inks, spot);
    let asphalt = [rgb(0x3a3b3d), rgb(0x5c5d5f), rgb(0x7f8082), rgb(0xb5b6b7)];
    let [brick, plaster] = [
        [rgb(0x4a2118), rgb(0x8a4630), rgb(0xbf7d5c), rgb(0xead2bd)],
        [rgb(0x5b5340), rgb(0x9c8f6d), rgb(0xcfc29c), rgb(0xf4eeda)],
    ];
    let leaves = [rgb(0x14301a), rgb(0x33632f), rgb(0x7aa04a), rgb(0xdfe7a8)];
    let sky = [rgb(0x6f8fae), rgb(0x9db6cc), rgb(0xc9d8e4), rgb(0xf3f6f8)];
    let body = |form, offset, wavelength, inks: [Rgb; 4]| Body::new(form, inks[1], paint(offset, wavelength, inks));
    let front = |x: f64| Form::Plane {
        at: [x, -2.0, 30.0],
        along: [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        half: [f64::INFINITY, 2.0 + HEIGHT],
    };
    let ground =
        Form::Plane { at: [0.0, HEIGHT, 0.0], along: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], half: [f64::INFINITY; 2] };
    let tree = |x: f64, z: f64| Form::upright([x, -0.4, z], 0.0, [0.35, 1.6]);
    let mut all = vec![
        body(Form::upright([0.0, 0.0, 70.0], 0.0, [f64::INFINITY; 2]), 100, 900.0, sky),
        body(ground, 200, 70.0, asphalt),
        body(front(-4.6), 300, 110.0, brick),
        body(front(4.8), 400, 110.0, plaster),
        body(tree(-3.4, 13.0), 500, 60.0, leaves),
        body(tree(3.6, 15.0), 600, 60.0, leaves),
        body(tree(-3.7, 20.0), 700, 80.0, leaves),
    ];
    let parked = [rgb(0x1d2b22), rgb(0x3f6b52), rgb(0x8fb79c), rgb(0xe9f3ec)];
    let at = [3.1, HEIGHT - 0.65, 9.0];
    all.extend(faces([0.8, 0.65, 1.7]).map(|form| body(shifted(form, at), 800, 40.0, parked)));
    all
}

/// The faces of a box, which point outwards.
fn faces(half: Vector) -> impl Iterator<Item = Form> {
    (0..3).flat_map(move |axis| [-1.0, 1.0].map(|sign| face(half, axis, sign)))
}

/// A plane in another place.
fn shifted(form: Form, by: Vector) -> Form {
    match form {
        Form::Plane { at, along, half } => Form::Plane { at: std::array::from_fn(|i| at[i] + by[i]), along, half },
        sphere @ Form::Sphere { .. } => sphere,
    }
}

/// A box that moves as a whole: object `id`.
fn cuboid(half: Vector, seed: u32, inks: [Rgb; 4], id: u32, pose: fn(f64) -> Pose) -> Vec<Body> {
    let painted = |(number, form): (usize, Form)| {
        let offset = seed + 100 * number as u32;
        Body::new(form, inks[1], move |spot| mottled(offset, 30.0, inks, spot)).face_of(id, pose)
    };
    faces(half).enumerate().map(painted).collect()
}
