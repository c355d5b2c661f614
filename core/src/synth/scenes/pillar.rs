//! A beach ball drifts over the waves and passes behind a stone pillar.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::{floor, sin},
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::Shape,
    texture::{Rgb, Spot, mix, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "pillar",
    title: "Waves behind a pillar",
    teaches: "Occlusion: points that pass behind the pillar have no match in the next frame. Compare the estimates there with the \
              mask of occluded pixels.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let ball =
        Motion { velocity: [8.0, 0.0], sway: [0.0, 4.0], period: 14.0, spin: 0.018, ..Motion::still([52.0, 136.0]) };
    vec![
        Layer::new(
            Shape::Rectangle { half: [26.0, 900.0], corner: 0.0 },
            Motion::still([178.0, 120.0]),
            rgb(0xb3a58c),
            move |spot| stone(seed, spot),
        ),
        Layer::new(swell(161.0, 5.0, 88.0), Motion::drift([-3.0, 0.0]), rgb(0x0f5c78), move |spot| {
            water(seed + 100, spot, 161.0, [rgb(0x083b57), rgb(0x0f6284), rgb(0x3fa3b5)])
        }),
        Layer::new(Shape::disc(34.0), ball, rgb(0xe9705a), beach_ball).object(1).round(setting),
        Layer::new(swell(122.0, 3.0, 61.0), Motion::drift([-1.5, 0.0]), rgb(0x3a93ad), move |spot| {
            water(seed + 200, spot, 122.0, [rgb(0x17698a), rgb(0x3a97b0), rgb(0x8fcfce)])
        }),
        Layer::new(Shape::Everywhere, Motion::drift([0.5, 0.0]), rgb(0xf3d3ab), move |spot| sky(seed + 300, spot)),
    ]
}

/// A sea whose surface is at `level`, with waves of `height`.
fn swell(level: f64, height: f64, wavelength: f64) -> Shape {
    let range = [level - 1.4 * height, level + 1.4 * height];
    Shape::below(range, move |x| level - height * (sin(x / wavelength) + 0.4 * sin(x * 2.3 / wavelength + 0.3)))
}

fn water(seed: u32, spot: Spot, level: f64, [deep, mid, crest]: [Rgb; 3]) -> Rgb {
    let ripples = spot.warped(seed, 60.0, 5.0).streaks(seed + 10, 17.0, 3.2, 4);
    let depth = ((spot.y - level) / 120.0) as f32;
    let color = ramp(&[crest, mid, deep], 0.25 + 0.5 * depth.clamp(0.0, 1.0) - 0.45 * ripples);
    let foam = smooth(1.0 - ((spot.y - level - 3.0) / 7.0).abs() as f32) * smooth(0.5 + 2.0 * ripples);
    mix(color, rgb(0xeaf6f2), 0.75 * foam)
}

fn beach_ball(spot: Spot) -> Rgb {
    const PANELS: [Rgb; 3] = [rgb(0xe4572e), rgb(0xf7f1e1), rgb(0xf2b134)];
    // Six panels, between lines through the middle at 0, 60 and 120 degrees.
    let lines = [[0.0, 1.0], [0.866_025_4, 0.5], [0.866_025_4, -0.5]];
    let sides = lines.map(|[nx, ny]| nx * spot.x + ny * spot.y);
    let panel = match sides.map(|s| s >= 0.0) {
        [true, true, true] | [false, false, false] => 0,
        [true, true, false] | [false, false, true] => 1,
        _ => 2,
    };
    let seam = sides.iter().fold(f64::MAX, |least, s| least.min(s.abs()));
    let radius = (spot.x * spot.x + spot.y * spot.y).sqrt();
    let color = mix(shade(PANELS[panel], 0.72), PANELS[panel], spot.cover(seam - 0.6));
    let color = mix(color, rgb(0xfdfaf2), spot.cover(7.0 - radius));
    shade(color, 1.02 - 0.3 * smooth((radius / 34.0) as f32 * 1.2 - 0.3))
}

fn stone(seed: u32, spot: Spot) -> Rgb {
    let block = floor((spot.y + 26.0) / 52.0);
    let joint = (spot.y + 26.0) / 52.0 - f64::from(block);
    let tone = part(lattice(seed, block, 0), 0) as f32 * 0.1;
    let chisel = spot.fractal(seed + 30, 22.0, 5);
    let round = 1.04 - 0.42 * smooth((spot.x / 26.0).abs() as f32 * 0.9) * if spot.x > 0.0 { 1.0 } else { 0.55 };
    let color = shade(ramp(&[rgb(0x8a7b66), rgb(0xbcae94), rgb(0xddd2bb)], 0.5 + 0.55 * chisel), round + tone);
    let gap = joint.min(1.0 - joint) * 52.0;
    mix(shade(color, 0.5), color, spot.cover(gap - 1.2))
}

/// Evening, with clouds.
pub fn sky(seed: u32, spot: Spot) -> Rgb {
    let height = (spot.y / 130.0) as f32;
    let air = ramp(&[rgb(0x6fa8c9), rgb(0xa9cbd3), rgb(0xf6dcb4), rgb(0xf3b98c)], height);
    let clouds = smooth(0.15 + 1.3 * spot.warped(seed, 80.0, 14.0).streaks(seed + 10, 42.0, 2.4, 4));
    mix(air, rgb(0xfdf3e3), 0.7 * clouds)
}
