//! A box that turns before a wall: a rigid object with a known model and pose.

use super::still_life::mottled;
use crate::data::Pose;
use crate::synth::{
    Sample, Scenery, Setting,
    maths::{sin, sin_cos},
    path::Path,
    space::{Body, Form, Rig, Vector},
    texture::{Rgb, rgb},
};

pub const SAMPLE: Sample = Sample {
    id: "turning-box",
    title: "Turning box: a rigid model in space",
    teaches: "A box of 0.48×0.32×0.36 m turns and moves in depth before a wall. Its edges alone determine its pose, 3 angles and 3 coordinates, \
              when its model and the focal length are known.",
    tune: |d| d.frames = 48,
    scenery: Scenery::Deep(bodies, Rig::REST),
    path: Path::REST,
};

/// Half the sides of the box in m.
const HALF: Vector = [0.24, 0.16, 0.18];

/// The pose at a time in frames: turned by 30° and tilted by 20° at the start.
fn pose(t: f64) -> Pose {
    let turn = sin_cos(30.0 / 360.0 + 0.055 * sin(t / 40.0));
    let tilt = sin_cos(20.0 / 360.0 + 0.02 * sin(t / 30.0));
    Pose::tilted(turn, tilt, [0.16 * sin(t / 44.0), 0.05 * sin(t / 26.0), 1.6 + 0.2 * sin(t / 52.0)])
}

fn bodies(setting: &Setting) -> Vec<Body> {
    let seed = setting.seed;
    let wall = Form::upright([0.0, 0.0, 3.2], 0.0, [f64::INFINITY; 2]);
    let inks = [rgb(0x27333d), rgb(0x2f3d48), rgb(0x374753), rgb(0x40525f)];
    let mut all = vec![Body::new(wall, inks[1], move |spot| mottled(seed + 100, 40.0, inks, spot))];
    // An axis and its direction for each face, with the light from above and the left.
    let faces: [(usize, f64, [u32; 2]); 6] = [
        (0, -1.0, [0xc8bfae, 0xd4ccbc]),
        (0, 1.0, [0x7d7566, 0x887f70]),
        (1, -1.0, [0xf0eadc, 0xf8f4ea]),
        (1, 1.0, [0x4f4a42, 0x58534a]),
        (2, -1.0, [0xb3a893, 0xbeb4a0]),
        (2, 1.0, [0x8f8676, 0x9a9181]),
    ];
    for (number, (axis, sign, ink)) in faces.into_iter().enumerate() {
        let [dark, light] = ink.map(rgb);
        let offset = seed + 200 + 100 * number as u32;
        let paint = move |spot| mottled(offset, 24.0, [dark, dark, light, light] as [Rgb; 4], spot);
        all.push(Body::new(face(HALF, axis, sign), dark, paint).face_of(1, pose));
    }
    all
}

/// The face of a box across an axis, with directions whose product points outwards; `half` are half its sides in m.
pub fn face(half: Vector, axis: usize, sign: f64) -> Form {
    let unit = |i: usize, length: f64| -> Vector { std::array::from_fn(|k| if k == i { length } else { 0.0 }) };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    // Unit vectors u, v and the axis are right-handed.
    Form::Plane { at: unit(axis, sign * half[axis]), along: [unit(u, sign), unit(v, 1.0)], half: [half[u], half[v]] }
}
