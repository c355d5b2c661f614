//! A rose window that turns and comes nearer.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::{Point, Shape},
    texture::{Rgb, Spot, mix, ramp, rgb, shade},
};

pub const SAMPLE: Sample = Sample {
    id: "spin-zoom",
    title: "Rose window: rotation and zoom",
    teaches: "Rotation and scaling violate the translation model of block matching: errors grow with the distance from the centre.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let motion = Motion { spin: 2.5 / 360.0, growth: 0.015, ..Motion::still([159.5, 119.5]) };
    vec![Layer::new(Shape::Everywhere, motion, rgb(0x6b6f86), move |spot| glass(seed, spot))]
}

/// Up to here there are half as many petals.
const INNER: f64 = 69.0;

/// Rings of panes between bars of lead; twelve petals in the inner rings, twenty-four in the outer ones.
fn glass(seed: u32, spot: Spot) -> Rgb {
    const PANES: [Rgb; 7] =
        [rgb(0x1d4e89), rgb(0xd1495b), rgb(0xedae49), rgb(0x00798c), rgb(0x7d4f8c), rgb(0x9cc5a1), rgb(0xc0392b)];
    let radius = (spot.x * spot.x + spot.y * spot.y).sqrt().max(1e-9);
    let direction = [spot.x / radius, spot.y / radius];
    let (petals, [along, across]) = petals(direction, radius);
    let ring_place = (radius + 5.0 * along * along) / 22.0;
    let ring = floor(ring_place);
    let ring_edge = (ring_place - f64::from(ring)).min(f64::from(ring) + 1.0 - ring_place) * 22.0;
    let petal_edge = along.abs().min(across.abs()) * radius / petals;
    let edge = if ring == 0 { ring_edge } else { ring_edge.min(petal_edge).min((radius - INNER).abs()) };
    let which = i32::from(along > 0.0) + 2 * i32::from(along * across > 0.0);
    let pane = lattice(seed, ring, if ring == 0 { 0 } else { which });
    let color = ramp(&PANES, part(pane, 1) as f32);
    let bubbles = spot.warped(seed + 40, 25.0, 7.0).fractal(seed + 50, 16.0, 4);
    let lit = shade(color, 0.92 + 0.12 * part(pane, 2) as f32 + 0.34 * bubbles);
    mix(rgb(0x17161c), lit, spot.cover(edge - 1.4))
}

/// How many petals there are, with the cosine and sine of so many times the angle of `direction`.
fn petals(direction: Point, radius: f64) -> (f64, Point) {
    // Multiplying directions as complex numbers adds their angles.
    let times = |a: Point, b: Point| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
    let third = times(times(direction, direction), direction);
    let sixth = times(third, third);
    if radius < INNER { (6.0, sixth) } else { (12.0, times(sixth, sixth)) }
}
