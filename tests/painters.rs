//! Golden pictures pin the PNG and SVG painters. `UPDATE_GOLDEN=1 cargo test --test painters` makes them anew.

use std::path::PathBuf;
use std::sync::Arc;

use motionscope::paint::{
    ArrowStyle, Caption, ColorMap, Face, Figure, FigureOptions, FlowLayer, LayerStyle, Lengthen, Pictures, Primitive,
    Scalars, Style, SvgText, Theme, Tint, View, export_png, export_svg, primitive,
};
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Flow, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::Streaks;
use motionscope_core::run::{Cursor, Move};
use motionscope_core::scene::{Arrow, Picture, Role, Scene, Sentence, Shape};
use resvg::{tiny_skia, usvg};

/// Floating-point units differ in the last bit, so a channel may differ by this much.
const TOLERANCE: u8 = 2;

/// In the middle of a block's candidates.
const MIDDLE: Cursor = Cursor { unit: 15, event: 150 };

fn golden(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "tests", "golden", name].iter().collect()
}

/// The file that is right, after it was made anew if that was asked for.
fn expected(name: &str, found: &[u8]) -> Vec<u8> {
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(golden(name), found).expect("tests/golden can be written");
    }
    let missing = |e| panic!("{name}: {e}; make it with UPDATE_GOLDEN=1 cargo test --test painters, and look at it");
    std::fs::read(golden(name)).unwrap_or_else(missing)
}

struct Rgb {
    size: (u32, u32),
    samples: Vec<u8>,
}

fn decode(png: &[u8]) -> Rgb {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG file");
    let mut samples = vec![0; reader.output_buffer_size().expect("a picture of sane size")];
    let info = reader.next_frame(&mut samples).expect("a whole picture");
    assert_eq!(info.color_type, png::ColorType::Rgb);
    Rgb { size: (info.width, info.height), samples }
}

/// The same picture in fewer bytes than exporting takes time for.
fn small(picture: &Rgb) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.size.0, picture.size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&picture.samples).expect("a whole picture");
    writer.finish().expect("an end");
    bytes
}

fn check_png(name: &str, figure: &Figure, scale: u32) {
    let found = export_png(figure, scale).expect("a PNG picture");
    let found = decode(&found);
    let expected = decode(&expected(name, &small(&found)));
    assert_eq!(found.size, expected.size, "{name}");
    let worst = found.samples.iter().zip(&expected.samples).enumerate().max_by_key(|(_, (a, b))| a.abs_diff(**b));
    let (at, (a, b)) = worst.expect("a picture has pixels");
    let pixel = at as u32 / 3;
    let place = (pixel % found.size.0, pixel / found.size.0);
    assert!(a.abs_diff(*b) <= TOLERANCE, "{name} at {place:?}: {a}, not {b}");
}

fn check_svg(name: &str, figure: &Figure) {
    let found = export_svg(figure, SvgText::Live).expect("an SVG picture");
    let expected = expected(name, found.as_bytes());
    let lines = found.lines().zip(std::str::from_utf8(&expected).expect("SVG is text").lines()).enumerate();
    for (i, (found, expected)) in lines {
        assert_eq!(found, expected, "{name}, line {}", i + 1);
    }
    assert_eq!(found.as_bytes(), expected);
}

/// Every shape in every role: roles from left to right, shapes from top to bottom, over black to white.
fn specimen() -> ([Arc<Frame>; 2], Scene) {
    const CELL: f32 = 12.0;
    let frame = Arc::new(Frame::gray(Grid::from_fn(132, 84, |x, _| (x / 6 * 12) as u8)));
    let mut scene = Scene::default();
    for (column, role) in Role::ALL.into_iter().enumerate() {
        let x = column as f32 * CELL + 5.5;
        let mut mark = |row: usize, shape: fn(f32, f32) -> Shape| {
            scene.mark(Picture::CURRENT, role, shape(x, row as f32 * CELL + 5.5));
        };
        mark(0, |x, y| Shape::Rect { min: [x - 4.0, y - 4.0], max: [x + 4.0, y + 4.0] });
        mark(1, |x, y| {
            let arrow = |dx: f32, dy: f32, x: f32| Arrow { from: [x, y + 3.0], to: [x + dx, y + 3.0 + dy] };
            Shape::Arrows(vec![arrow(3.0, -5.0, x - 4.0), arrow(1.0, 0.0, x), arrow(0.0, 0.0, x + 4.0)])
        });
        mark(2, |x, y| Shape::Ellipse { center: [x, y], radii: [4.5, 2.5], angle_rad: 0.5 });
        mark(3, |x, y| Shape::Path {
            points: vec![[x - 4.0, y + 3.0], [x, y - 3.0], [x + 4.0, y + 3.0]],
            closed: false,
        });
        mark(4, |x, y| Shape::Points(vec![[x - 2.5, y - 1.5], [x + 2.5, y + 1.5]]));
        mark(5, |x, y| Shape::Text { at: [x - 4.0, y + 2.0], text: "−3.2".into() });
        scene.legend(role, role_name(role));
    }
    let values = Grid::from_fn(120, 6, |x, y| if (x + y) % 9 == 0 { f32::NAN } else { x as f32 * 8.5 });
    scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [6.0, 75.0], values });
    ([frame.clone(), frame], scene)
}

fn role_name(role: Role) -> &'static str {
    match role {
        Role::Reference => "reference",
        Role::Window => "window",
        Role::Candidate => "candidate",
        Role::Rejected => "rejected",
        Role::Best => "best",
        Role::Result => "result",
        Role::Predicted => "predicted",
        Role::Measured => "measured",
        Role::Estimate => "estimate",
        Role::Truth => "truth",
        Role::Error => "error",
    }
}

fn specimen_plate(theme: Theme) -> Figure {
    let (frames, scene) = specimen();
    let sentence = Sentence::default()
        .text("Every shape in every role: ")
        .ink(Role::Candidate, "candidate (−3, 2)")
        .text(" costs 812, less than ")
        .ink(Role::Best, "903 at (0, 1)")
        .text(", so Σ |I₁ − I₂| ≤ √2 → AV.");
    let caption = Caption {
        title: "Specimen".into(),
        details: "block 16 px · range ±16 px · cost SAD".into(),
        place: "step 35.412".into(),
        sentence,
        formula: Vec::new(),
    };
    let options = FigureOptions {
        view: View::Current,
        style: Style {
            theme,
            arrows: ArrowStyle { lengthen: Lengthen::Times(1.5), ..ArrowStyle::default() },
            ..Style::default()
        },
        zoom: 4.0,
        legend: true,
        heat: "SAD".into(),
        caption: Some(caption),
        ..FigureOptions::default()
    };
    Figure::new(&Pictures::of(frames.clone()), &scene, &options)
}

/// A textured picture that moves by (5, −3), on which full search is seen at `step`.
fn search(step: Cursor) -> ([Arc<Frame>; 2], Scene) {
    let texture = |x: i32, y: i32| {
        let wave = |a: f32, b: f32| ((x as f32 * a + y as f32 * b).sin() * 40.0) as i32;
        ((128 + wave(0.35, 0.12) + wave(-0.11, 0.41) + wave(0.05, 0.03)).clamp(0, 255) / 24 * 24) as u8
    };
    let frame = |dx, dy| {
        Frame::rgb(Grid::from_fn(112, 80, |x, y| {
            let v = texture(x as i32 - dx, y as i32 - dy);
            [v, v / 2 + 50, 190 - v / 2]
        }))
    };
    let clip = Clip::from_frames("waves", vec![frame(0, 0), frame(5, -3)]).expect("two frames");
    let mut full_search = estimator("full-search").expect("full search is registered");
    full_search.set("search-range", "8").expect("range is a parameter");
    let mut walk = full_search.walk(&clip, 0).expect("the clip can be searched");
    walk.jump(Move::To(step));
    (clip.pair(0).expect("two frames"), walk.scene(None))
}

#[test]
fn every_shape_in_every_role_looks_as_it_did() {
    for theme in Theme::ALL {
        let figure = specimen_plate(theme);
        check_png(&format!("specimen-{}.png", theme.name().to_lowercase()), &figure, 1);
    }
    check_svg("specimen.svg", &specimen_plate(Theme::Light));
}

#[test]
fn full_search_in_the_middle_of_a_block_looks_as_it_did() {
    let (frames, scene) = search(MIDDLE);
    let framed = FigureOptions {
        zoom: 3.0,
        frame: Some(12),
        legend: true,
        heat: "SAD".into(),
        caption: Some(Caption { title: "Full search".into(), ..Caption::default() }),
        ..FigureOptions::default()
    };
    check_png("full-search.png", &Figure::new(&Pictures::of(frames.clone()), &scene, &framed), 1);
    check_svg("full-search.svg", &Figure::new(&Pictures::of(frames.clone()), &scene, &framed));
    let bare = FigureOptions {
        view: View::Blend,
        style: Style { colors: ColorMap::Turbo, ..Style::default() },
        ..FigureOptions::default()
    };
    check_png("full-search-bare.png", &Figure::new(&Pictures::of(frames.clone()), &scene, &bare), 4);
}

/// A field that turns about the middle of a picture and is not known in a corner, and how far off it is.
fn turning() -> (Arc<Frame>, Scene, Arc<Flow>, Scalars) {
    let frame = Arc::new(Frame::gray(Grid::from_fn(160, 120, |x, y| (90 + x / 10 % 2 * 30 + y / 10 % 2 * 30) as u8)));
    let at = |x: usize, y: usize| [(y as f32 - 59.5) / 20.0, (79.5 - x as f32) / 20.0];
    let values = Grid::from_fn(160, 120, |x, y| if x + y < 40 { Flow::UNKNOWN } else { at(x, y) });
    let mut scene = Scene::default();
    scene.mark(Picture::CURRENT, Role::Result, Shape::Flow { origin: [0.0; 2], values: values.clone() });
    scene.legend(Role::Result, "displacements found");
    let off = values.map(|[u, v]| u.hypot(*v) / 4.0);
    let marks = Grid::from_fn(160, 120, |x, y| (100..130).contains(&x) && (20..60).contains(&y));
    let scalars = Scalars {
        kind: FlowLayer::Consistency,
        label: "there and back, off by".into(),
        unit: "px",
        values: vec![off],
        marks: Some(marks),
    };
    (frame, scene, Arc::new(Flow(values)), scalars)
}

#[test]
fn layers_of_motion_look_as_they_did() {
    let (frame, scene, flow, scalars) = turning();
    let framed = FigureOptions { view: View::Current, zoom: 2.0, legend: true, ..FigureOptions::default() };
    let pictures = Pictures::of([frame.clone(), frame]);
    let wheel = Tint::wheel(std::slice::from_ref(&flow), LayerStyle::default()).pop().map(Arc::new);
    let figure = Figure::new(&Pictures { layer: wheel, ..pictures.clone() }, &scene, &framed);
    check_png("flow-wheel.png", &figure, 1);
    check_svg("flow-wheel.svg", &figure);
    let layer = Tint::scale(scalars, ColorMap::Viridis, LayerStyle::default()).pop().map(Arc::new);
    let light = FigureOptions {
        style: Style {
            theme: Theme::Light,
            arrows: ArrowStyle { spacing_px: Some(20), ..ArrowStyle::default() },
            ..Style::default()
        },
        ..framed.clone()
    };
    check_png("flow-consistency.png", &Figure::new(&Pictures { layer, ..pictures.clone() }, &scene, &light), 1);
    let streaks = Some(Arc::new(Streaks::new(&flow, 6)));
    let arrows = ArrowStyle { streak_frames: Some(32), ..ArrowStyle::default() };
    let moving = FigureOptions { style: Style { arrows, ..Style::default() }, phase: 0.5, ..framed };
    check_png("flow-streaks.png", &Figure::new(&Pictures { streaks, ..pictures }, &scene, &moving), 1);
}

#[test]
fn a_larger_picture_has_room_for_more_displacements() {
    let frame = Arc::new(Frame::gray(Grid::new(64, 48, 90)));
    let starts = (0..12).flat_map(|y| (0..16).map(move |x| [1.5 + 4.0 * x as f32, 1.5 + 4.0 * y as f32]));
    let arrows = starts.map(|from| Arrow { from, to: [from[0] + 2.0, from[1]] }).collect();
    let mut scene = Scene::default();
    scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(arrows));
    scene.legend(Role::Result, "displacement found");
    let pictures = Pictures::of([frame.clone(), frame]);
    let drawn = |scale| {
        let options = FigureOptions { view: View::Current, legend: true, scale, ..FigureOptions::default() };
        let figure = Figure::new(&pictures, &scene, &options);
        let all = || figure.layers.iter().flat_map(|layer| &layer.primitives);
        let in_the_picture = |primitive: &Primitive| match primitive {
            Primitive::Arrows(arrows) => arrows.iter().filter(|arrow| arrow.from[1] < 92.0).count(),
            _ => 0,
        };
        let says_so = |primitive: &Primitive| matches!(primitive, Primitive::Text(line) if line.runs.iter().any(|run| run.text.contains("not all drawn")));
        (all().map(in_the_picture).sum::<usize>(), all().any(says_so))
    };
    assert_eq!(drawn(1), (6 * 8, true), "4 pixels are too near to each other");
    assert_eq!([drawn(2), drawn(8)], [(12 * 16, false); 2]);
}

#[test]
fn without_words_the_picture_is_the_frame() {
    let (frames, _) = search(Cursor::default());
    let options = FigureOptions { view: View::Next, ..FigureOptions::default() };
    let figure = Figure::new(&Pictures::of(frames.clone()), &Scene::default(), &options);
    for scale in [1, 2, 8] {
        let picture = decode(&export_png(&figure, scale).expect("a PNG picture"));
        assert_eq!(picture.size, (112 * scale, 80 * scale));
        let color = frames[1].color().expect("colours");
        for (i, pixel) in picture.samples.chunks(3).enumerate() {
            let (x, y) = (i as u32 % picture.size.0 / scale, i as u32 / picture.size.0 / scale);
            assert_eq!(pixel, color[(x as usize, y as usize)], "pixel ({x}, {y}) at {scale}×");
        }
    }
}

#[test]
fn the_same_plate_gives_the_same_bytes() {
    let figure = specimen_plate(Theme::Dark);
    assert_eq!(export_png(&figure, 3), export_png(&figure, 3));
    for words in [SvgText::Outlines, SvgText::Live] {
        assert_eq!(export_svg(&figure, words), export_svg(&figure, words));
    }
}

#[test]
fn larger_is_sharper_and_not_another_picture() {
    let figure = specimen_plate(Theme::Dark);
    let (small, large) = [1, 4].map(|scale| decode(&export_png(&figure, scale).expect("a PNG picture"))).into();
    let mean = |x: u32, y: u32, channel: usize| {
        let at = |i: u32, j: u32| (((y * 4 + j) * large.size.0 + x * 4 + i) * 3) as usize + channel;
        (0..16).map(|k| f64::from(large.samples[at(k % 4, k / 4)])).sum::<f64>() / 16.0
    };
    let (width, height) = small.size;
    let mut off = 0.0;
    for (i, &sample) in small.samples.iter().enumerate() {
        let pixel = i as u32 / 3;
        off += (f64::from(sample) - mean(pixel % width, pixel / width, i % 3)).abs();
    }
    let off = off / f64::from(width * height * 3);
    assert!(off < 1.0, "the mean difference is {off} of 255");
}

/// Another program's idea of our SVG, which has our type at hand for live text alone.
fn rendered(svg: &str, words: SvgText) -> Rgb {
    let mut options = usvg::Options::default();
    for face in Face::ALL.into_iter().filter(|_| words == SvgText::Live) {
        options.fontdb_mut().load_font_data(face.bytes().to_vec());
    }
    let tree = usvg::Tree::from_str(svg, &options).expect("well-formed SVG");
    let size = (tree.size().width() as u32, tree.size().height() as u32);
    let mut pixmap = tiny_skia::Pixmap::new(size.0, size.1).expect("a picture of sane size");
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixmap.as_mut());
    Rgb { size, samples: pixmap.data().chunks(4).flat_map(|p| [p[0], p[1], p[2]]).collect() }
}

#[test]
fn the_svg_shows_what_the_png_shows() {
    let (frames, scene) = search(MIDDLE);
    let side_by_side = FigureOptions { zoom: 2.0, legend: true, ..FigureOptions::default() };
    let figures = Theme::ALL.map(specimen_plate).into_iter().chain([Figure::new(
        &Pictures::of(frames.clone()),
        &scene,
        &side_by_side,
    )]);
    for (i, figure) in figures.enumerate() {
        let png = decode(&export_png(&figure, 1).expect("a PNG picture"));
        for words in [SvgText::Outlines, SvgText::Live] {
            let svg = rendered(&export_svg(&figure, words).expect("an SVG picture"), words);
            assert_eq!(png.size, svg.size);
            let off: u64 = png.samples.iter().zip(&svg.samples).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            let off = off as f64 / png.samples.len() as f64;
            assert!(off < 0.1, "figure {i}, {words:?}: the mean difference is {off} of 255");
        }
    }
}

#[test]
fn words_stay_on_the_plate() {
    for theme in Theme::ALL {
        let figure = specimen_plate(theme);
        for layer in figure.layers.iter().filter(|layer| layer.clip.is_none()) {
            for primitive in &layer.primitives {
                if let Primitive::Text(line) = primitive {
                    let [x, y] = line.start();
                    let inside = x >= 16.0 && x + line.width() <= figure.size[0] - 16.0 + 0.5;
                    assert!(inside && y < figure.size[1], "{theme:?}: {line:?}");
                }
            }
        }
        assert!(figure.size.iter().all(|side| side % 4.0 == 0.0), "{theme:?}: {:?} is off the grid", figure.size);
        let whole = primitive::Rect::new([0.0; 2], figure.size);
        assert!(figure.layers.iter().filter_map(|layer| layer.clip).all(|clip| clip.meets(&whole)));
    }
}
