//! A basketball is thrown across the gym.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::Shape,
    texture::{Rgb, Spot, mix, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "fast-ball",
    title: "Fast ball: motion beyond the search range",
    teaches: "The ball moves 24 px or more per frame, beyond a search range of 16 px. A range of 32 px reaches it, and so does \
              a pyramid with blocks of 8 px; larger blocks lose the ball on coarse levels. Judge by the ball and the PSNR: \
              the wall is static, so the mean endpoint error stays small even where the ball is missed.",
    tune: |d| d.frames = 16,
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let ball = Motion { velocity: [24.0, 0.0], bounce: 96.0, period: 13.0, spin: 0.03, ..Motion::still([8.0, 176.0]) };
    vec![
        Layer::new(Shape::disc(23.0), ball, rgb(0xe07a2f), move |spot| basketball(seed, spot)).object(1).round(setting),
        Layer::new(Shape::below([178.0; 2], |_| 178.0), Motion::still([0.0; 2]), rgb(0xc99a66), move |spot| {
            floorboards(seed + 100, spot)
        }),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), rgb(0x5f7f8c), move |spot| wall(seed + 200, spot)),
    ]
}

fn basketball(seed: u32, spot: Spot) -> Rgb {
    let radius = (spot.x * spot.x + spot.y * spot.y).sqrt();
    let arc = |side: f64| {
        let dx = spot.x - side * 30.0;
        ((dx * dx + spot.y * spot.y).sqrt() - 21.0).abs()
    };
    let seam = spot.x.abs().min(spot.y.abs()).min(arc(1.0)).min(arc(-1.0));
    let leather = spot.fractal(seed + 20, 6.0, 2);
    let color = shade(rgb(0xe8802f), 1.05 - 0.35 * smooth((radius / 23.0) as f32 * 1.3 - 0.4) + 0.13 * leather);
    mix(rgb(0x2c1a14), color, spot.cover(seam - 0.9))
}

fn floorboards(seed: u32, spot: Spot) -> Rgb {
    let row = floor(spot.y / 13.0);
    let shifted = spot.x + 57.0 * f64::from(row & 7);
    let board = lattice(seed, floor(shifted / 96.0), row);
    let grain = spot.relative([part(board, 0) * 300.0, 0.0], 1.0).streaks(seed + 10, 7.0, 6.0, 3);
    let end = shifted / 96.0 - f64::from(floor(shifted / 96.0));
    let gap = (spot.y / 13.0 - f64::from(row)).min(f64::from(row) + 1.0 - spot.y / 13.0) * 13.0;
    let gap = gap.min(end.min(1.0 - end) * 96.0);
    let wood = ramp(&[rgb(0xa8713f), rgb(0xd2a36b), rgb(0xe9c795)], 0.35 + 0.3 * part(board, 1) as f32 + 0.4 * grain);
    mix(shade(wood, 0.62), wood, spot.cover(gap - 0.6))
}

fn wall(seed: u32, spot: Spot) -> Rgb {
    let row = floor(spot.y / 16.0);
    let shifted = spot.x + 18.0 * f64::from(row & 1);
    let brick = lattice(seed, floor(shifted / 36.0), row);
    let (along, up) = (shifted / 36.0 - f64::from(floor(shifted / 36.0)), spot.y / 16.0 - f64::from(row));
    let gap = (along.min(1.0 - along) * 36.0).min(up.min(1.0 - up) * 16.0);
    let rough = spot.fractal(seed + 10, 14.0, 4);
    let upper = ramp(&[rgb(0x86a8b0), rgb(0xa5c2c4)], part(brick, 0) as f32);
    let lower = ramp(&[rgb(0x2f5d6e), rgb(0x44788a)], part(brick, 0) as f32);
    let color = shade(mix(upper, lower, spot.cover(spot.y - 96.0)), 1.0 + 0.16 * rough);
    let stripe = mix(color, rgb(0xf0e6cf), spot.cover(4.0 - (spot.y - 96.0).abs()));
    mix(shade(stripe, 0.8), stripe, spot.cover(gap - 0.8))
}
