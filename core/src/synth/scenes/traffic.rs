//! A crossing from above: cars on a road, and a bridge over it with a car of its own.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    shape::{Point, Shape},
    texture::{Rgb, Spot, mix, over, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "traffic",
    title: "Traffic: five cars and a bridge",
    teaches: "Several objects, some of them occluded by a bridge for a while: a tracker must keep their identities.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

pub(super) fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let drive = |from: Point, velocity: Point, turned: f64| Motion { velocity, turned, ..Motion::still(from) };
    let car = |id, motion, color| car(setting, id, motion, color).round(setting);
    vec![
        tree(seed + 60, [44.0, 62.0], 30.0),
        tree(seed + 70, [300.0, 196.0], 34.0),
        car(5, drive([212.0, 226.0], [0.0, -6.0], 0.75), 0xf2c230),
        Layer::new(
            Shape::Rectangle { half: [34.0, 900.0], corner: 0.0 },
            Motion::still([200.0, 120.0]),
            rgb(0x8a8780),
            move |spot| bridge(seed + 80, spot),
        ),
        car(1, drive([30.0, 144.0], [7.0, 0.0], 0.0), 0xc8322b),
        car(2, drive([112.0, 144.0], [7.0, 0.0], 0.0), 0x2f6db3),
        car(3, drive([292.0, 100.0], [-5.0, 0.0], 0.5), 0xeeeae0),
        car(4, drive([206.0, 100.0], [-5.0, 0.0], 0.5), 0x3d8f6b),
        Layer::new(Shape::Everywhere, Motion::still([0.0, 122.0]), rgb(0x6d7d5e), move |spot| ground(seed + 90, spot)),
    ]
}

/// A car that drives towards x unless it is turned, and leaves the picture for good.
pub(super) fn car(setting: &Setting, id: u32, motion: Motion, color: u32) -> Layer {
    let seed = setting.seed;
    Layer::new(Shape::Rectangle { half: [22.0, 11.0], corner: 6.0 }, motion, rgb(color), move |spot| {
        bodywork(seed + id, spot, rgb(color))
    })
    .object(id)
}

fn bodywork(seed: u32, spot: Spot, color: Rgb) -> Rgb {
    let pane = |from: f64, to: f64, half: f64| (spot.x - from).min(to - spot.x).min(half - spot.y.abs());
    let glass = pane(4.0, 10.0, 8.2)
        .max(pane(-16.0, -11.0, 7.6))
        .max((spot.x + 9.0).min(2.5 - spot.x).min(spot.y.abs() - 8.0).min(9.6 - spot.y.abs()));
    let lamp = 2.0 - ((spot.x - 20.0) * (spot.x - 20.0) * 0.6 + (spot.y.abs() - 7.0) * (spot.y.abs() - 7.0)).sqrt();
    let tail = 1.8 - ((spot.x + 21.0) * (spot.x + 21.0) * 0.6 + (spot.y.abs() - 7.0) * (spot.y.abs() - 7.0)).sqrt();
    let round = 1.08 - 0.35 * smooth((spot.y / 12.0).abs() as f32) + 0.05 * spot.fractal(seed, 14.0, 3);
    let roof = shade(color, 1.08 - 0.1 * smooth((spot.y / 9.0 + 0.5) as f32));
    let paint = mix(shade(color, round), roof, spot.cover(pane(-11.0, 4.0, 8.0)));
    let color = mix(paint, shade(rgb(0x22303c), 1.0 + 0.3 * (spot.y / 9.0) as f32), spot.cover(glass));
    mix(mix(color, rgb(0xfff4c9), spot.cover(lamp)), rgb(0xa51c14), spot.cover(tail))
}

/// Grass with a road of two lanes along y = 0.
pub(super) fn ground(seed: u32, spot: Spot) -> Rgb {
    let lawn = |spot: Spot| {
        let grass = spot.warped(seed, 30.0, 6.0).fractal(seed + 10, 26.0, 5);
        ramp(&[rgb(0x4a6b3c), rgb(0x7a9a58), rgb(0xb0bd7a)], 0.5 + 0.55 * grass)
    };
    let kerb = over(rgb(0xbdb6a6), spot.cover(spot.y.abs() - 52.0), || lawn(spot));
    over(kerb, spot.cover(46.0 - spot.y.abs()), || road(seed + 20, [spot.x, spot.y], spot))
}

fn bridge(seed: u32, spot: Spot) -> Rgb {
    let rail = shade(rgb(0xcfc8b8), 1.0 + 0.12 * spot.fractal(seed, 9.0, 3));
    let edge = mix(shade(rail, 0.5), rail, spot.cover(33.0 - spot.x.abs()));
    over(edge, spot.cover(27.0 - spot.x.abs()), || road(seed + 5, [spot.y, spot.x], spot))
}

/// Asphalt with dashes along the middle; the first coordinate runs along the road.
fn road(seed: u32, [along, across]: Point, spot: Spot) -> Rgb {
    let grit = spot.fractal(seed, 18.0, 5);
    let asphalt = shade(rgb(0x5a5c60), 1.0 + 0.2 * grit);
    let step = along / 40.0 - f64::from(floor(along / 40.0));
    let dash = (1.5 - across.abs()).min((0.25 - (step - 0.5).abs()) * 40.0);
    mix(asphalt, shade(rgb(0xf0ece0), 1.0 + 0.1 * grit), spot.cover(dash))
}

fn tree(seed: u32, at: Point, size: f64) -> Layer {
    Layer::new(Shape::star(11, size, size * 0.84), Motion::still(at), rgb(0x3a6a3c), move |spot| {
        let leaves = spot.warped(seed, 14.0, 5.0).fractal(seed + 3, 15.0, 4);
        let lit = 0.55 - 0.3 * ((spot.x + spot.y) / size) as f32 + 0.6 * leaves;
        ramp(&[rgb(0x17351f), rgb(0x346a37), rgb(0x86a650)], lit)
    })
}
