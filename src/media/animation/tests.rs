use std::fs;
use std::io::Cursor;
use std::sync::LazyLock;

use image::AnimationDecoder;
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, ExtendedColorType};
use motionscope_core::data::Clip;
use proptest::prelude::*;

use super::*;
use crate::media;

const FRAMES: usize = 5;
const EXTENSIONS: [&str; 3] = ["gif", "png", "webp"];

/// Frame `t`: a bright column at `t` on a ground of one colour, exact in every format.
fn canvas(t: usize) -> RgbaImage {
    RgbaImage::from_fn(8, 6, |x, _| if x as usize == t { [250, 200, 10, 255].into() } else { [0, 0, 80, 255].into() })
}

fn gif(delays_ms: &[u32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new(&mut bytes);
    encoder.set_repeat(Repeat::Infinite).unwrap();
    for (t, &ms) in delays_ms.iter().enumerate() {
        let delay = Delay::from_numer_denom_ms(ms, 1);
        encoder.encode_frame(image::Frame::from_parts(canvas(t), 0, 0, delay)).unwrap();
    }
    drop(encoder);
    bytes
}

/// Only the columns that change are coded after the first picture.
fn apng() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 8, 6);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_animated(FRAMES as u32, 0).unwrap();
    encoder.set_frame_delay(1, 25).unwrap();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(canvas(0).as_raw()).unwrap();
    for t in 1..FRAMES {
        let change = image::imageops::crop_imm(&canvas(t), t as u32 - 1, 0, 2, 6).to_image();
        writer.set_frame_position(0, 0).unwrap();
        writer.set_frame_dimension(2, 6).unwrap();
        writer.set_frame_position(t as u32 - 1, 0).unwrap();
        writer.write_image_data(change.as_raw()).unwrap();
    }
    writer.finish().unwrap();
    bytes
}

fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut bytes = name.to_vec();
    bytes.extend_from_slice(&(content.len() as u32).to_le_bytes());
    bytes.extend_from_slice(content);
    bytes.resize(bytes.len().next_multiple_of(2), 0);
    bytes
}

fn webp() -> Vec<u8> {
    let size = [7, 0, 0, 5, 0, 0];
    let mut content = b"WEBP".to_vec();
    content.extend(chunk(b"VP8X", &[&[0b10, 0, 0, 0][..], &size].concat()));
    content.extend(chunk(b"ANIM", &[0; 6]));
    for t in 0..FRAMES {
        let mut still = Cursor::new(Vec::new());
        let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut still);
        let rgb = image::DynamicImage::from(canvas(t)).into_rgb8();
        encoder.encode(rgb.as_raw(), 8, 6, ExtendedColorType::Rgb8).unwrap();
        let place = [&[0; 6][..], &size, &[40, 0, 0, 0b10]].concat();
        // After the RIFF header comes the picture's own chunk.
        content.extend(chunk(b"ANMF", &[&place, &still.into_inner()[12..]].concat()));
    }
    chunk(b"RIFF", &content)
}

static FIXTURES: LazyLock<[Vec<u8>; 3]> = LazyLock::new(|| [gif(&[40; FRAMES]), apng(), webp()]);

fn write(bytes: &[u8], extension: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("moves.{extension}"));
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn open(path: &Path, cache_bytes: usize) -> Result<Clip, Error> {
    media::open(path, &Open { cache_bytes, ..Open::default() }).map(|opened| opened.clip)
}

fn shows(frame: &Frame, t: usize) -> bool {
    let wanted = canvas(t);
    let cells = frame.color().unwrap().cells();
    cells.iter().zip(wanted.pixels()).all(|(cell, pixel)| cell[..] == pixel.0[..3])
}

#[test]
fn every_format_is_composed_and_can_be_sought() {
    for (bytes, extension) in FIXTURES.iter().zip(EXTENSIONS) {
        let (_folder, path) = write(bytes, extension);
        // The second cache holds a single frame, so that going back decodes again.
        for cache_bytes in [1 << 20, 0] {
            let clip = open(&path, cache_bytes).unwrap();
            let info = clip.info();
            assert_eq!((clip.size(), info.frames, info.fps), ((8, 6), Some(FRAMES), Some(25.0)), "{extension}");
            assert_eq!(info.warnings, [""; 0], "{extension}");
            for t in [0, 3, 1, 4, 2, 2, 0] {
                assert!(shows(&clip.frame(t).unwrap(), t), "{extension} frame {t}");
            }
            assert!(clip.frame(FRAMES).is_err());
        }
    }
}

#[test]
fn what_was_given_up_can_be_asked_for_again() {
    // A GIF that builds on what comes before, as the others are taken to do.
    let changes = (0..FRAMES).map(|t| Patch {
        place: [0, 0, 8, 6],
        clear: Some(0),
        dispose: ::gif::DisposalMethod::Keep,
        codes: (0..48).map(|i| u8::from(i % 8 == t) * 2).collect(),
        own_colors: false,
    });
    let gif = patched(&changes.collect::<Vec<_>>());
    let wanted = |extension: &str, frame: &Frame| match extension {
        "gif" => *frame == composed(&gif)[2],
        _ => shows(frame, 2),
    };
    for (bytes, extension) in [&gif, &FIXTURES[1], &FIXTURES[2]].into_iter().zip(EXTENSIONS) {
        let (_folder, path) = write(bytes, extension);
        let format = Format::of(&path).unwrap();
        let scan = scan::scan(&path, format, &Open::default()).unwrap();
        let (mut animation, _) = decoder(&path, format, scan).unwrap();
        let stop = Stop::default();
        let mut met = vec![];
        let given_up = animation.decode(4, &stop, &mut |number, _| {
            met.push(number);
            stop.set(number == 1);
        });
        assert!(given_up.is_err() && met == [0, 1], "{extension}: {met:?}");
        stop.set(false);
        let mut last = None;
        animation.decode(2, &stop, &mut |number, frame| last = Some((number, frame))).unwrap();
        assert!(last.is_some_and(|(number, frame)| number == 2 && wanted(extension, &frame)), "{extension}");
    }
}

#[test]
fn the_rate_is_the_mean_and_hurried_pictures_are_slowed() {
    let (_folder, path) = write(&gif(&[0, 50, 150]), "gif");
    let clip = open(&path, 0).unwrap();
    assert_eq!(clip.info().fps, Some(10.0));
    assert_eq!(clip.info().warnings, ["the pictures are shown for 50 to 150 ms; the rate is their mean"]);
    let (_folder, path) = write(&gif(&[50]), "gif");
    assert_eq!((open(&path, 0).unwrap().info().frames, open(&path, 0).unwrap().info().fps), (Some(1), None));
}

#[test]
fn what_is_before_the_cut_can_be_used() {
    for (bytes, extension) in FIXTURES.iter().zip(EXTENSIONS) {
        let (_folder, path) = write(&bytes[..bytes.len() * 3 / 4], extension);
        let clip = open(&path, 0).unwrap();
        let frames = clip.info().frames.unwrap();
        assert!((1..FRAMES).contains(&frames), "{extension}: {frames}");
        assert!(clip.info().warnings.iter().any(|message| message.contains("is lost")), "{extension}");
        assert!((0..frames).all(|t| shows(&clip.frame(t).unwrap(), t)), "{extension}");
    }
}

#[test]
fn transparency_is_reported() {
    let (_folder, path) = write(&gif(&[40]), "gif");
    assert!(open(&path, 0).unwrap().info().warnings.is_empty());
    let clear = image::Frame::new(RgbaImage::from_pixel(4, 4, [9, 9, 9, 0].into()));
    let mut bytes = Vec::new();
    GifEncoder::new(&mut bytes).encode_frame(clear).unwrap();
    let (_folder, path) = write(&bytes, "gif");
    let clip = open(&path, 0).unwrap();
    assert_eq!(clip.info().warnings, ["transparent pixels are shown on black"]);
    assert_eq!(clip.frame(0).unwrap().luma()[(0, 0)], 0);
}

#[test]
fn hostile_sizes_are_refused() {
    let mut hostile = gif(&[40]);
    hostile[6..10].copy_from_slice(&[0xff; 4]);
    let (_folder, path) = write(&hostile, "gif");
    assert!(open(&path, 0).unwrap_err().to_string().contains("65535×65535"));
    hostile[6..10].copy_from_slice(&[0; 4]);
    fs::write(&path, &hostile).unwrap();
    assert!(open(&path, 0).unwrap_err().to_string().contains("0×0"));
}

/// A picture of a GIF: where it lies, which of its codes is clear, and what becomes of its place.
#[derive(Clone, Debug)]
struct Patch {
    place: [u16; 4],
    clear: Option<u8>,
    dispose: ::gif::DisposalMethod,
    codes: Vec<u8>,
    own_colors: bool,
}

/// Four colours; codes reach one further.
const COLORS: [u8; 12] = [0, 0, 0, 250, 10, 10, 10, 250, 10, 10, 10, 250];

fn patched(patches: &[Patch]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = ::gif::Encoder::new(&mut bytes, 8, 6, &COLORS).unwrap();
    for Patch { place: [left, top, width, height], clear, dispose, codes, own_colors } in patches {
        let mut frame = ::gif::Frame::from_indexed_pixels(*width, *height, codes.as_slice(), *clear);
        (frame.left, frame.top, frame.dispose) = (*left, *top, *dispose);
        frame.palette = own_colors.then(|| COLORS.iter().rev().copied().collect());
        encoder.write_frame(&frame).unwrap();
    }
    drop(encoder);
    bytes
}

fn patch() -> impl Strategy<Value = Patch> {
    use ::gif::DisposalMethod::{Any, Background, Keep, Previous};
    let dispose = prop::sample::select(vec![Any, Keep, Background, Previous]);
    let whole = Just([0, 0, 8, 6]);
    let part = (0..9_u16, 0..7_u16, 1..9_u16, 1..7_u16).prop_map(|(x, y, w, h)| [x, y, w, h]);
    let codes = prop::collection::vec(0..5_u8, 64);
    (prop_oneof![whole, part], prop::option::of(0..4_u8), dispose, codes, any::<bool>()).prop_map(
        |(place, clear, dispose, mut codes, own_colors)| {
            codes.truncate(usize::from(place[2]) * usize::from(place[3]));
            Patch { place, clear, dispose, codes, own_colors }
        },
    )
}

/// The pictures as the library composes them, from the first on.
fn composed(bytes: &[u8]) -> Vec<Frame> {
    let frames = image::codecs::gif::GifDecoder::new(Cursor::new(bytes)).unwrap().into_frames();
    frames.map(|frame| picture::frame(frame.unwrap().into_buffer().into()).unwrap()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn a_gif_in_any_order_is_what_it_is_from_the_first_picture_on(
        patches in prop::collection::vec(patch(), 1..12),
        order in prop::collection::vec(any::<prop::sample::Index>(), 12),
        every in 1..4_usize,
    ) {
        let bytes = patched(&patches);
        let wanted = composed(&bytes);
        let (_folder, path) = write(&bytes, "gif");
        let scan = scan::scan(&path, Format::Gif, &Open::default()).unwrap();
        prop_assert_eq!((scan.whole, scan.pieces.len()), (true, patches.len()));
        let mut gif = gif::Gif::new(&path, scan);
        gif.keep_every(every);
        for index in order.into_iter().map(|index| index.index(patches.len())) {
            let mut last = None;
            gif.decode(index, &Stop::default(), &mut |number, frame| last = Some((number, frame))).unwrap();
            prop_assert!(last == Some((index, wanted[index].clone())), "picture {}", index);
        }
    }
}

#[test]
fn no_picture_is_far_once_all_were_met() {
    // Each changes a part of the one before; nothing begins afresh.
    let bytes = patched(&vec![
        Patch {
            place: [1, 1, 5, 4],
            clear: Some(0),
            dispose: ::gif::DisposalMethod::Keep,
            codes: (0..20).map(|i| i % 4).collect(),
            own_colors: false,
        };
        500
    ]);
    let (_folder, path) = write(&bytes, "gif");
    let scan = scan::scan(&path, Format::Gif, &Open::default()).unwrap();
    assert_eq!(scan.pieces.iter().filter(|piece| piece.is_fresh).count(), 1);
    let mut gif = gif::Gif::new(&path, scan);
    gif.keep_every(20);
    let (stop, mut message) = (Stop::default(), Vec::new());
    let mut way = |gif: &mut gif::Gif, index: usize| {
        stop.report(0, 0);
        gif.decode(index, &stop, &mut |_, _| message.push(stop.progress())).unwrap();
        stop.progress().map_or(0, |(_, of)| of)
    };
    assert_eq!(way(&mut gif, 499), 500, "the first way there is the longest");
    for index in [0, 480, 17, 250, 499, 1] {
        assert_eq!(way(&mut gif, index), 0, "picture {index} is near");
    }
    assert!(message.contains(&Some((499, 500))), "how far it is is told: {message:?}");
}

#[test]
fn canvases_are_kept_where_it_is_far_and_no_oftener() {
    let long = |is_fresh: fn(usize) -> bool| -> Vec<scan::Piece> {
        (0..20_000).map(|i| scan::Piece { start: 0, area_px: 640 * 480, is_fresh: is_fresh(i) }).collect()
    };
    let stops = gif::stops(&long(|i| i == 0));
    assert!((100..200).contains(&stops.len()), "{}", stops.len());
    assert!(stops.windows(2).all(|pair| pair[1] - pair[0] < 200));
    assert!(gif::stops(&long(|i| i % 100 == 0)).is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn damage_never_panics(which in 0..3_usize, at in any::<prop::sample::Index>(), flip in 1..=255_u8, cut: bool) {
        let mut bytes = FIXTURES[which].clone();
        let at = at.index(bytes.len());
        if cut { bytes.truncate(at) } else { bytes[at] ^= flip }
        let (_folder, path) = write(&bytes, EXTENSIONS[which]);
        match open(&path, 0) {
            Ok(clip) => for t in 0..clip.info().frames.unwrap_or(1).min(20) {
                if let Err(error) = clip.frame(t) {
                    prop_assert!(error.to_string().contains("moves."), "{error}");
                }
            }
            Err(error) => prop_assert!(error.to_string().contains("moves."), "{error}"),
        }
    }
}
