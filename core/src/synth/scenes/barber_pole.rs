//! A barber's pole: slanted stripes seen through a narrow opening.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    shape::Shape,
    texture::{Rgb, Spot, mix, over, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "barber-pole",
    title: "Barber's pole: the aperture problem",
    teaches: "The stripes move to the right but seem to climb: along an edge the brightness is constant, so only normal flow can \
              be measured.",
    tune: |_| {},
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let still = || Motion::still([159.5, 119.5]);
    let opening = Shape::Rectangle { half: [44.0, 78.0], corner: 2.0 };
    vec![
        Layer::new(Shape::Around(Box::new(opening)), still(), rgb(0x8b5e4b), move |spot| shop(seed, spot)),
        Layer::new(Shape::Everywhere, Motion { velocity: [2.0, 0.0], ..still() }, rgb(0xb9a0a6), stripes),
    ]
}

/// Four stripes in 72 units, at 45 degrees. No grain: there is nothing to hold on to along a stripe.
fn stripes(spot: Spot) -> Rgb {
    const COLORS: [Rgb; 4] = [rgb(0xf6efe2), rgb(0xc8362f), rgb(0xf6efe2), rgb(0x24518c)];
    let place = (spot.x + spot.y) / 18.0;
    let stripe = floor(place);
    let color = |i: i32| COLORS[i.rem_euclid(4) as usize];
    let from_edge = (place - f64::from(stripe)) * 18.0 * std::f64::consts::FRAC_1_SQRT_2;
    mix(color(stripe - 1), color(stripe), spot.cover(from_edge - 1.0))
}

fn shop(seed: u32, spot: Spot) -> Rgb {
    let (x, y) = (spot.x.abs(), spot.y.abs());
    let brass = |edge: f64| shade(rgb(0xd9b25f), 1.05 - 0.45 * smooth((edge / 6.0).abs() as f32));
    let caps = Shape::Rectangle { half: [54.0, 12.0], corner: 5.0 };
    let cap = caps.inside([x, y - 87.0]);
    let rim = Shape::Rectangle { half: [48.0, 82.0], corner: 3.0 }.inside([x, y]);
    let (row, plank) = (floor(spot.x / 32.0), spot.x / 32.0 - f64::from(floor(spot.x / 32.0)));
    let grain = spot.relative([f64::from(row) * 91.0, f64::from(row) * 37.0], 1.0).streaks(seed, 24.0, 0.22, 4);
    let wood = ramp(&[rgb(0x14403f), rgb(0x1f5b56), rgb(0x3c8278)], 0.5 + 0.55 * grain);
    let wood = mix(shade(wood, 0.6), wood, spot.cover(plank.min(1.0 - plank) * 32.0 - 1.0));
    let frame = over(wood, spot.cover(rim), || brass(rim - 2.0));
    over(frame, spot.cover(cap), || brass((y - 87.0) * 0.55 + 1.0))
}
