//! A plain wall with one small picture on it, and a camera that pans.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, mix, over, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "flat-wall",
    title: "Flat wall: no texture",
    teaches: "The whole view moves by (2, 1) px per frame, but only the picture and the switch have texture. Elsewhere \
              noise determines the estimates.",
    tune: |d| d.noise = 2.0,
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let velocity = [2.0 / setting.scale, 1.0 / setting.scale];
    vec![Layer::new(Shape::Everywhere, Motion::drift(velocity), rgb(0xd8cfc0), move |spot| wall(seed, spot))]
}

fn wall(seed: u32, spot: Spot) -> Rgb {
    let plaster = shade(rgb(0xd8cfc0), 1.0 + 0.006 * spot.fractal(seed, 60.0, 3));
    let hung = spot.relative([70.0, 72.0], 1.0);
    let switch = spot.relative([226.0, 128.0], 1.0);
    let color = over(plaster, spot.cover(box_inside(hung, 44.0, 34.0)), || picture(seed + 100, hung));
    over(color, spot.cover(box_inside(switch, 11.0, 15.0)), || light_switch(switch))
}

fn picture(seed: u32, spot: Spot) -> Rgb {
    let oak = shade(rgb(0x6b4428), 1.0 + 0.25 * spot.fractal(seed, 9.0, 3));
    let mat = mix(oak, rgb(0xf4f0e6), spot.cover(box_inside(spot, 39.0, 29.0)));
    over(mat, spot.cover(box_inside(spot, 32.0, 22.0)), || {
        super::translation::marble(seed, spot.relative([0.0; 2], 0.6))
    })
}

fn light_switch(spot: Spot) -> Rgb {
    let figure = mix(rgb(0xa79f92), rgb(0xf6f3ec), spot.cover(box_inside(spot, 10.0, 14.0)));
    let key = shade(rgb(0xfbf9f4), 1.0 - 0.22 * smooth((spot.y / 16.0 + 0.5) as f32));
    mix(mix(figure, rgb(0x8f877b), spot.cover(box_inside(spot, 5.5, 8.5))), key, spot.cover(box_inside(spot, 4.7, 7.7)))
}

fn box_inside(spot: Spot, half_width: f64, half_height: f64) -> f64 {
    Shape::Rectangle { half: [half_width, half_height], corner: 1.0 }.inside([spot.x, spot.y])
}
