//! Every reader of bytes on damaged files: none panics, none goes on for ever, and whatever is wrong is told in a sentence.
//!
//! The damage is the same at every run. `MOTIONSCOPE_DAMAGE=20` makes twenty times as many files, others than those of the
//! usual run, for whoever has changed a reader.

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use common::{Random, check_sentence, damaged, in_time, mistaken};
use image::{DynamicImage, ExtendedColorType, ImageFormat, RgbaImage};
use motionscope::media::{self, Given, Open, export};
use motionscope::session::Session;
use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Disparity, Flow, Frame};
use motionscope_core::geometry::Grid;

/// Files of each kind.
const CASES: u64 = 120;
/// Frames of each that are decoded.
const FRAMES: usize = 12;

fn cases() -> u64 {
    let times = std::env::var("MOTIONSCOPE_DAMAGE").ok().and_then(|times| times.parse().ok());
    CASES * times.unwrap_or(1)
}

/// What reading comes to.
#[derive(Default)]
struct Found {
    /// Whether something is read.
    is_read: bool,
    /// What is told of it.
    told: Vec<String>,
}

impl Found {
    /// What is told where nothing is wrong unless there is an error.
    fn of<'a>(errors: impl IntoIterator<Item = &'a Error>) -> Self {
        let told: Vec<_> = errors.into_iter().map(Error::to_string).collect();
        Self { is_read: told.is_empty(), told }
    }
}

/// Has `read` read damaged files.
fn survive(
    name: &str,
    damage: impl Fn(&mut Random) -> Vec<u8>,
    read: impl Fn(&Path) -> Found + Send + Sync + Copy + 'static,
) {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut read_cases, mut all_told) = (0, BTreeSet::new());
    for case in 0..cases() {
        // Each kind has its own damage.
        let seed = name.bytes().fold(case, |seed, byte| seed.wrapping_mul(31).wrapping_add(byte.into()));
        let bytes = damage(&mut Random::new(seed));
        let path = folder.path().join(name);
        fs::write(&path, &bytes).expect("it is written");
        let Found { is_read, told } = in_time(&format!("case {case} of {name}"), move || read(&path));
        read_cases += usize::from(is_read);
        told.iter().for_each(|told| check_sentence(told));
        all_told.extend(told);
    }
    if std::env::var_os("MOTIONSCOPE_TOLD").is_some() {
        all_told.iter().for_each(|told| println!("{told}"));
    }
    assert!(!all_told.is_empty(), "{name}: no damage is told");
    assert!(read_cases > 0, "{name}: nothing is read any more");
}

/// By our own decoders alone, so that every computer gives the same answers.
fn ours() -> Open {
    Open { ffmpeg: false, cache_bytes: 1 << 20, ..Open::default() }
}

/// Opens a clip and asks for its frames, there and back.
fn clip(path: &Path) -> Found {
    let clip = match media::open(path, &ours()) {
        Ok(opened) => opened.clip,
        Err(error) => return Found::of([&error]),
    };
    let frames = clip.info().frames.unwrap_or(FRAMES).min(FRAMES);
    let mut found = Found { is_read: false, told: clip.info().warnings.clone() };
    for t in (0..frames).chain((0..frames).rev().step_by(3)) {
        match clip.frame(t) {
            Ok(frame) => found.is_read |= frame.size() == clip.size(),
            Err(error) => found.told.push(error.to_string()),
        }
    }
    found
}

fn fixture(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)).expect("the fixture")
}

/// Damages a file of each name as a whole.
fn survive_all(names: &[&str]) {
    for name in names {
        let whole = fixture(name);
        survive(name, |random| damaged(&whole, random), clip);
    }
}

#[test]
fn mp4_with_h264() {
    survive_all(&["h264_bframes.mp4", "h264_fragmented.mp4", "h264_edited.mp4", "h264_rotated.mov", "h264_10bit.mp4"]);
}

#[test]
fn matroska() {
    survive_all(&["h264.mkv", "vp9.webm"]);
}

#[test]
fn vp9() {
    survive_all(&["vp9.mp4", "vp9_alt_ref.webm", "vp9_10bit.webm"]);
}

#[test]
fn avi_with_mjpeg() {
    survive_all(&["mjpeg.avi", "mjpeg_422.avi"]);
}

#[test]
fn y4m() {
    let frame: Vec<u8> = (0..16 * 16 * 3 / 2).map(|i| (i * 7) as u8).collect();
    let frames = [b"FRAME Ip\n".as_slice(), &frame].concat().repeat(3);
    let whole = [b"YUV4MPEG2 W16 H16 F25:1 Ip A1:1 C420jpeg XCOLORRANGE=FULL\n".as_slice(), &frames].concat();
    survive("small.y4m", |random| damaged(&whole, random), clip);
}

/// Picture `t` of an animation.
fn canvas(t: usize) -> RgbaImage {
    RgbaImage::from_fn(12, 9, |x, y| {
        if (x as usize + t).is_multiple_of(4) { [250, 200, y as u8 * 9, 255].into() } else { [0, 0, 80, 255].into() }
    })
}

fn gif() -> Vec<u8> {
    use gif::{DisposalMethod, Encoder, Frame};
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 12, 9, &[0, 0, 0, 250, 9, 9, 9, 250, 9, 9, 9, 250]).expect("a GIF");
    let disposals = [DisposalMethod::Keep, DisposalMethod::Background, DisposalMethod::Previous];
    for t in 0..6_u16 {
        let codes: Vec<u8> = (0..60).map(|i| ((i + t) % 4) as u8).collect();
        let mut frame = Frame::from_indexed_pixels(10, 6, codes, Some(t as u8 % 4));
        (frame.left, frame.top, frame.dispose, frame.delay) = (t % 3, t % 4, disposals[usize::from(t) % 3], 4);
        encoder.write_frame(&frame).expect("a picture");
    }
    drop(encoder);
    bytes
}

fn apng() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 12, 9);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_animated(4, 0).expect("an animation");
    let mut writer = encoder.write_header().expect("a header");
    (0..4).for_each(|t| writer.write_image_data(canvas(t).as_raw()).expect("a picture"));
    writer.finish().expect("an end");
    bytes
}

fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut bytes = [name.as_slice(), &(content.len() as u32).to_le_bytes(), content].concat();
    bytes.resize(bytes.len().next_multiple_of(2), 0);
    bytes
}

fn webp() -> Vec<u8> {
    let size = [11, 0, 0, 8, 0, 0];
    let mut content = b"WEBP".to_vec();
    content.extend(chunk(b"VP8X", &[&[0b10, 0, 0, 0][..], &size].concat()));
    content.extend(chunk(b"ANIM", &[0; 6]));
    for t in 0..4 {
        let mut still = Cursor::new(Vec::new());
        let rgb = DynamicImage::from(canvas(t)).into_rgb8();
        let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut still);
        encoder.encode(rgb.as_raw(), 12, 9, ExtendedColorType::Rgb8).expect("a picture");
        let place = [&[0; 6][..], &size, &[40, 0, 0, 0b10]].concat();
        // After the RIFF header comes the picture's own chunk.
        content.extend(chunk(b"ANMF", &[&place, &still.into_inner()[12..]].concat()));
    }
    chunk(b"RIFF", &content)
}

#[test]
fn animations() {
    for (name, whole) in [("moves.gif", gif()), ("moves.png", apng()), ("moves.webp", webp())] {
        survive(name, |random| damaged(&whole, random), clip);
    }
}

#[test]
fn numbered_stills() {
    use ImageFormat::{Bmp, Jpeg, Png, Pnm, Tiff, WebP};
    let color = DynamicImage::from(canvas(1)).into_rgb8();
    let deep = DynamicImage::from(canvas(1)).into_rgb16();
    for (extension, format) in [("png", Png), ("jpg", Jpeg), ("tif", Tiff), ("bmp", Bmp), ("ppm", Pnm), ("webp", WebP)]
    {
        let mut whole = Cursor::new(Vec::new());
        color.write_to(&mut whole, format).expect("a picture");
        let whole = whole.into_inner();
        survive(
            &format!("f_1.{extension}"),
            |random| damaged(&whole, random),
            |path| {
                // One that is whole follows.
                let next = path.with_file_name("f_2").with_extension(path.extension().unwrap_or_default());
                if !next.exists() {
                    fs::copy(path, next).expect("a copy");
                }
                clip(path)
            },
        );
    }
    let mut whole = Cursor::new(Vec::new());
    deep.write_to(&mut whole, Tiff).expect("a picture");
    survive("deep.tiff", |random| damaged(whole.get_ref(), random), clip);
}

/// Reads the truth at `path` with a small clip.
fn truth(path: &Path) -> Found {
    let frames = (0..3).map(|_| Frame::gray(Grid::new(6, 5, 0))).collect();
    let clip = Clip::from_frames("clip", frames).expect("a clip");
    let clip = match media::open_scene(clip, &Open::from(Given { truth: Some(path.into()), ..Given::default() })) {
        Ok(opened) => opened.clip,
        Err(error) => return Found::of([&error]),
    };
    let Some(truth) = clip.truth() else { return Found::default() };
    let errors = [truth.flow(0).err(), truth.occlusion(0).err(), truth.objects(0).err(), truth.disparity(0).err()];
    Found::of(errors.iter().flatten())
}

#[test]
fn true_flow() {
    let flow = Flow(Grid::from_fn(6, 5, |x, y| [x as f32 / 4.0, -(y as f32)]));
    let whole = export::flo(&flow);
    survive("t.flo", |random| damaged(&whole, random), truth);
    let whole = export::kitti(&flow).expect("a flow").bytes;
    survive("t.png", |random| damaged(&whole, random), truth);
}

#[test]
fn true_disparity() {
    let map = Disparity(Grid::from_fn(6, 5, |x, y| if x == y { f32::NAN } else { 1.0 + x as f32 / 4.0 }));
    let whole = export::pfm(&map);
    survive("d.pfm", |random| damaged(&whole, random), truth);
    let whole = export::kitti_disparity(&map).expect("a disparity").bytes;
    survive("d.png", |random| damaged(&whole, random), truth);
}

#[test]
fn rows_of_objects() {
    let rows = |id: i32| (1..7).map(|t| format!("{t},{id},{}.5,20,30,40,0.9,-1,-1,-1\n", 10 + t)).collect::<String>();
    let (detections, tracks) = (rows(-1), rows(3));
    survive("det.txt", |random| mistaken(&detections, random), clip);
    survive("gt.txt", |random| mistaken(&tracks, random), truth);
    let regions = (1..7).map(|t| format!("{t}.5,20,30,40\n{t},2,9.5,3,12,14,4,15\n")).collect::<String>();
    survive("groundtruth.txt", |random| mistaken(&regions, random), truth);
    survive(
        "given.txt",
        |random| mistaken(&detections, random),
        |path| Found::of(media::check_detections(path).err().as_ref()),
    );
}

#[test]
fn sessions() {
    let whole = "motionscope = 1\nclip = \"synth:pillar,noise=5\"\nestimator = \"full-search\"\npace = \"block\"\nframe = 1\n\
                 step = \"35.412\"\npixel = \"30,20\"\n\n[set]\nblock-size = 8\nearly-exit = true\n\n[[beside]]\n\
                 estimator = \"hierarchical\"\nset = { levels = 4 }\n\n[picture]\nview = \"side-by-side\"\nlevel = 1\n\
                 blend = 0.5\nlayer = \"wheel\"\narrows = \"auto\"\nlegend = true\n\n[sight]\ncenter = [10.5, 3.0]\nzoom = 4\n";
    survive("a.motionscope", |random| mistaken(whole, random), |path| Found::of(Session::load(path).err().as_ref()));
}

#[test]
fn what_is_no_clip_at_all() {
    let heads: [&[u8]; 9] = [
        b"\x93NUMPY\x01\0v\0{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }\n",
        b"%PDF-1.4\n",
        b"PK\x03\x04\x14\0",
        b"\x7FELF\x02\x01",
        b"motionscope = 1\n",
        b"1,1,10,20,30,40,1,1,1\n",
        b"PIEH\x04\0\0\0\x04\0\0\0",
        b"YUV4MPEG2 ",
        b"\x1A\x45\xDF\xA3",
    ];
    for case in 0..cases() {
        let random = &mut Random::new(case);
        let noise: Vec<u8> = (0..random.below(400)).map(|_| random.next() as u8).collect();
        let bytes = damaged(&[*random.one(&heads), &noise].concat(), random);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("what.bin");
        fs::write(&path, bytes).expect("it is written");
        in_time(&format!("case {case}"), move || clip(&path)).told.iter().for_each(|told| check_sentence(told));
    }
}

/// Names that are hard to read in a sentence.
fn names() -> Vec<PathBuf> {
    let long = "a very long name with many words in it ".repeat(6);
    ["x".repeat(240), long, "red\u{1B}[31m\nnew line\ttab".into(), "\u{202E}4pm.exe".into(), "…".repeat(80)]
        .map(PathBuf::from)
        .to_vec()
}

#[cfg(unix)]
#[test]
fn names_that_are_long_or_odd_are_reported_in_a_sentence() {
    let cut = &fixture("h264_bframes.mp4")[..3000];
    for name in names() {
        let folder = tempfile::tempdir().expect("a folder");
        for ending in ["mp4", "png", "txt", "flo", "motionscope"] {
            let path = folder.path().join(format!("{}.{ending}", name.display()));
            for bytes in [cut, b"1,-1,2\n3,x", b"motionscope = 1\nclip = 3", b"\x89PNG\r\n\x1A\n"] {
                fs::write(&path, bytes).expect("it is written");
                clip(&path).told.iter().chain(&truth(&path).told).for_each(|told| check_sentence(told));
                check_sentence(&Session::load(&path).err().expect("it is none").to_string());
            }
            fs::remove_file(&path).expect("it is there");
            clip(&path).told.iter().for_each(|told| check_sentence(told));
        }
    }
}
