use std::collections::BTreeMap;
use std::io::Read;

use super::super::primitive::{Anchor, Line, Primitive, Run};
use super::super::{Color, Face, Layer};
use super::*;

/// The unpacked streams of a PDF.
fn streams(pdf: &[u8]) -> Vec<Vec<u8>> {
    let find = |from: usize, what: &[u8]| pdf[from..].windows(what.len()).position(|w| w == what).map(|at| from + at);
    let (mut all, mut at) = (Vec::new(), 0);
    while let Some(begin) = find(at, b"stream\n") {
        let end = find(begin, b"\nendstream").expect("every stream ends");
        let mut bytes = Vec::new();
        let packed = &pdf[begin + b"stream\n".len()..end];
        if flate2::read::ZlibDecoder::new(packed).read_to_end(&mut bytes).is_ok() {
            all.push(bytes);
        }
        at = end + b"\nendstream".len();
    }
    all
}

/// The characters by the numbers of letters, of every face on the page.
fn characters(pdf: &[u8]) -> Vec<BTreeMap<u16, char>> {
    let maps = streams(pdf).into_iter().filter_map(|stream| String::from_utf8(stream).ok());
    let pairs = |map: String| {
        let lines = map.lines().filter_map(|line| {
            line.strip_prefix('<')?
                .strip_suffix('>')?
                .split_once("> <")
                .map(|(id, character)| (id.to_owned(), character.to_owned()))
        });
        lines
            .filter_map(|(id, character)| {
                let units: Vec<u16> = (0..character.len() / 4)
                    .filter_map(|i| u16::from_str_radix(&character[4 * i..4 * i + 4], 16).ok())
                    .collect();
                let id = u16::from_str_radix(&id, 16).ok().filter(|_| id.len() == 4)?;
                Some((id, char::decode_utf16(units).next()?.ok()?))
            })
            .collect::<BTreeMap<u16, char>>()
    };
    maps.filter(|map| map.contains("beginbfchar")).map(pairs).collect()
}

fn figure() -> Figure {
    let runs = vec![Run::new("SAD (−3, 2) is ", Color::BLACK), Run::new("812", Color::hex(0x00_9e73)).face(Face::Bold)];
    let line = Line { at: [20.0, 40.0], anchor: Anchor::Start, size: 14.0, runs, halo: Some(Color::WHITE) };
    let pixels = Arc::new(Grid::from_fn(3, 2, |x, y| [x as u8, y as u8, 7, if x == 0 { 0 } else { 255 }]));
    let image = Primitive::Image { pixels, rect: super::super::primitive::Rect::new([5.0, 50.0], [30.0, 20.0]) };
    let layers = vec![Layer { clip: None, primitives: vec![Primitive::Text(line), image] }];
    let description = "A line and a picture".into();
    Figure { size: [200.0, 100.0], background: Color::WHITE, layers, panels: Vec::new(), description }
}

#[test]
fn words_stay_words_and_the_same_plate_gives_the_same_bytes() {
    let pdf = export_pdf(&figure()).expect("a small figure");
    assert!(pdf.starts_with(b"%PDF-"));
    assert_eq!(pdf, export_pdf(&figure()).expect("a small figure"));
    let mut all: Vec<char> = characters(&pdf).into_iter().flat_map(BTreeMap::into_values).collect();
    all.sort_unstable();
    let mut wanted: Vec<char> = "SAD (−3, 2) is ".chars().collect();
    wanted.sort_unstable();
    wanted.dedup();
    for character in wanted.into_iter().chain("812".chars()) {
        assert!(all.contains(&character), "{character:?} is missing in {all:?}");
    }
    let content = streams(&pdf).into_iter().rev().find_map(|stream| {
        String::from_utf8_lossy(&stream).contains("Tf").then(|| String::from_utf8_lossy(&stream).into_owned())
    });
    let content = content.expect("operators");
    assert!(content.contains("/F0 14 Tf") && content.contains("/F1 14 Tf"), "{content}");
    assert!(content.contains("/I0 Do"), "{content}");
}

/// The operators of the page.
fn operators(pdf: &[u8]) -> String {
    let all = streams(pdf).into_iter().map(|stream| String::from_utf8_lossy(&stream).into_owned());
    all.rev().find(|stream| stream.contains(" Do")).expect("operators")
}

#[test]
fn a_picture_is_opaque_whatever_was_painted_before() {
    let mut figure = figure();
    let points = vec![[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]];
    figure.layers[0].primitives.insert(1, Primitive::Polygon { points, color: Color::BLACK.alpha(40) });
    let all = operators(&export_pdf(&figure).expect("a small figure"));
    let before = all.split("/I0 Do").next().expect("the operators before the picture");
    let last = before.lines().rev().find(|line| line.ends_with(" gs"));
    assert!(before.contains("/A40 gs") && last == Some("/A255 gs"), "{before}");
}

#[test]
fn a_picture_with_clear_pixels_has_a_mask() {
    let pdf = export_pdf(&figure()).expect("a small figure");
    let text = String::from_utf8_lossy(&pdf);
    assert!(text.contains("/SMask") && text.contains("/MediaBox [0 0 200 100]"));
    let [colors, alpha] = [[0, 0, 7, 1, 0, 7].as_slice(), &[0, 255, 255, 0, 255, 255]];
    let all = streams(&pdf);
    assert!(all.iter().any(|stream| stream.starts_with(colors)) && all.iter().any(|stream| stream == alpha));
}
