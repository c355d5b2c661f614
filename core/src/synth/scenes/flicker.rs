//! A bookshelf under a lamp that flickers.

use crate::synth::{
    Sample, Scenery, Setting,
    layer::Layer,
    maths::floor,
    motion::Motion,
    path::Path,
    random::{lattice, part},
    shape::Shape,
    texture::{Rgb, Spot, mix, over, ramp, rgb, shade, smooth},
};

pub const SAMPLE: Sample = Sample {
    id: "flicker",
    title: "Library: brightness changes",
    teaches: "Flicker violates brightness constancy, the assumption of nearly every estimator.",
    tune: |d| d.flicker = 20.0,
    scenery: Scenery::Flat(layers),
    path: Path::REST,
};

fn layers(setting: &Setting) -> Vec<Layer> {
    let seed = setting.seed;
    let velocity = [-2.0 / setting.scale, 0.0];
    vec![Layer::new(Shape::Everywhere, Motion::drift(velocity), rgb(0x6e5446), move |spot| shelf(seed, spot))]
}

const SHELF: f64 = 78.0;
const BOOK: f64 = 15.0;

fn shelf(seed: u32, spot: Spot) -> Rgb {
    let row = floor(spot.y / SHELF);
    let y = spot.y - f64::from(row) * SHELF;
    let edge = |i: i32| (f64::from(i) + 0.55 * part(lattice(seed, i, row), 0)) * BOOK;
    let near = floor(spot.x / BOOK);
    let book = if spot.x < edge(near) { near - 1 } else { near };
    let (left, right) = (edge(book), edge(book.saturating_add(1)));
    let h = lattice(seed + 7, book, row);
    let top = 6.0 + 20.0 * part(h, 0);
    let x = (spot.x - left) / (right - left);
    let inside = (y - top).min((spot.x - left).min(right - spot.x) - 0.3);
    let behind = shade(rgb(0x2a1d18), 0.7 + 0.5 * smooth((y / SHELF) as f32));
    let books = over(behind, spot.cover(inside), || spine(seed, spot, h, [x, (y - top) / (SHELF - 10.0 - top)]));
    over(books, spot.cover(y - (SHELF - 10.0)).max(spot.cover(-y)), || board(seed + 90, spot, y))
}

fn spine(seed: u32, spot: Spot, book: u32, [x, y]: [f64; 2]) -> Rgb {
    const CLOTHS: [Rgb; 8] = [
        rgb(0x7a2e2e),
        rgb(0xb5523b),
        rgb(0xd9a05b),
        rgb(0xe6d5b0),
        rgb(0x5f7d5a),
        rgb(0x2f5d62),
        rgb(0x2d4470),
        rgb(0x5c3a58),
    ];
    let cloth = CLOTHS[(book >> 8) as usize & 7];
    let round = 1.12 - 0.5 * smooth((x * 2.0 - 0.8).abs() as f32);
    let worn = spot.fractal(seed + (book & 31), 11.0, 3);
    let gold = mix(rgb(0xe8c66a), rgb(0xf3e6c4), part(book, 2) as f32);
    let band = |at: f64, half: f64| spot.cover((half - (y - at).abs()) * 50.0);
    let title = band(0.2 + 0.25 * part(book, 3), 0.05 + 0.08 * part(book, 0));
    let bands = title.max(band(0.88, 0.02)).max(band(0.08, 0.015));
    shade(mix(cloth, gold, bands * 0.85), round + 0.2 * worn)
}

fn board(seed: u32, spot: Spot, y: f64) -> Rgb {
    let grain = spot.streaks(seed, 8.0, 6.0, 3);
    let wood = ramp(&[rgb(0x5a3820), rgb(0x8a5a33), rgb(0xb98450)], 0.5 + 0.5 * grain);
    shade(wood, if y > SHELF - 4.0 { 0.7 } else { 1.0 })
}
