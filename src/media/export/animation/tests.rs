use image::codecs::gif::GifDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, Frame, Rgb, RgbImage};

use super::*;
use crate::media::export::{Pixels, png};
use crate::work;

const RED: Rgb<u8> = Rgb([200, 30, 20]);
const SKY: Rgb<u8> = Rgb([120, 180, 240]);

/// A red square that moves over the sky, in pictures of growing height.
fn moving(between: u32) -> (Reel, Vec<RgbImage>) {
    let mut reel = Reel::new(Timing { rate_hz: 10.0, between }, [9, 9, 9]);
    let mut wanted = Vec::new();
    for step in 0..4_u32 {
        let height = 20 + step % 2;
        let mut picture = RgbImage::from_pixel(31, height, SKY);
        for (dx, dy) in (0..5).flat_map(|y| (0..5).map(move |x| (x, y))) {
            picture.put_pixel(3 + 5 * step + dx, 7 + dy, RED);
        }
        let file = png(31, height as usize, Pixels::Rgb(picture.as_raw())).expect("a small picture");
        reel.push(file).expect("a PNG file");
        let mut whole = RgbImage::from_pixel(31, 21, Rgb([9, 9, 9]));
        image::imageops::replace(&mut whole, &picture, 0, 0);
        wanted.push(whole);
    }
    (reel, wanted)
}

fn decoded(format: AnimationFormat, bytes: &[u8]) -> Vec<Frame> {
    let bytes = Cursor::new(bytes);
    let frames = match format {
        AnimationFormat::Gif => GifDecoder::new(bytes).expect("a GIF").into_frames(),
        AnimationFormat::Apng => PngDecoder::new(bytes).expect("a PNG").apng().expect("an animation").into_frames(),
        AnimationFormat::WebP => WebPDecoder::new(bytes).expect("a WebP").into_frames(),
        AnimationFormat::Mp4 => panic!("decoded by ffmpeg alone"),
    };
    frames.collect_frames().expect("frames")
}

const OWN: [AnimationFormat; 3] = [AnimationFormat::Gif, AnimationFormat::Apng, AnimationFormat::WebP];

#[test]
fn decoders_find_the_pictures_and_their_times() {
    let (reel, wanted) = moving(0);
    for format in OWN {
        let frames = decoded(format, &work::finish(reel.encode(format, None)).expect("it is encoded"));
        assert_eq!(frames.len(), wanted.len(), "{format:?}");
        for (i, (frame, wanted)) in frames.iter().zip(&wanted).enumerate() {
            let seen = image::DynamicImage::ImageRgba8(frame.buffer().clone()).into_rgb8();
            assert_eq!(&seen, wanted, "{format:?}, picture {i}: few colours are kept exactly");
            let (n, d) = frame.delay().numer_denom_ms();
            assert_eq!(n / d, if i == 3 { (1000.0 * LAST_S) as u32 } else { 100 }, "{format:?}, picture {i}");
        }
    }
}

#[test]
fn rounding_errors_of_times_do_not_add_up() {
    for rate_hz in [3.0, 7.0, 12.0, 15.0, 24.0, 29.97, 30.0, 40.0, 50.0] {
        let mut reel = Reel::new(Timing { rate_hz, between: 0 }, [0; 3]);
        for level in 0..31_u8 {
            reel.push(png(4, 4, Pixels::Gray(&[8 * level; 16])).expect("a picture")).expect("a PNG file");
        }
        for format in OWN {
            let frames = decoded(format, &work::finish(reel.encode(format, None)).expect("it is encoded"));
            let ms = |frame: &image::Frame| {
                f64::from(frame.delay().numer_denom_ms().0) / f64::from(frame.delay().numer_denom_ms().1)
            };
            let all: f64 = frames[..30].iter().map(ms).sum();
            let wanted = 30_000.0 / f64::from(rate_hz);
            assert!((all - wanted).abs() <= 5.0, "{format:?} at {rate_hz} Hz: 30 steps take {all} ms, not {wanted}");
        }
    }
}

#[test]
fn a_gif_plays_at_the_rate_that_is_told() {
    for (rate_hz, between) in [(60.0, 0), (50.0, 0), (8.0, 4), (25.0, 4), (30.0, 1), (2.0, 8)] {
        let timing = Timing { rate_hz, between }.played(AnimationFormat::Gif);
        let mut reel = Reel::new(timing, [0; 3]);
        for level in 0..31_u8 {
            reel.push(png(4, 4, Pixels::Gray(&[8 * level; 16])).expect("a picture")).expect("a PNG file");
        }
        let frames = decoded(
            AnimationFormat::Gif,
            &work::finish(reel.encode(AnimationFormat::Gif, None)).expect("it is encoded"),
        );
        let ms: Vec<u32> = frames.iter().map(|frame| frame.delay().numer_denom_ms()).map(|(n, d)| n / d).collect();
        assert!(ms.iter().all(|ms| *ms >= 20), "viewers play no faster: {ms:?}");
        let all: u32 = ms[..30 * (1 + between as usize)].iter().sum();
        let wanted = 30_000.0 / timing.rate_hz;
        assert!((all as f32 - wanted).abs() <= 10.0, "{rate_hz} Hz, {between}: {all} ms, not {wanted}");
    }
    assert_eq!(Timing { rate_hz: 60.0, between: 0 }.played(AnimationFormat::Gif).rate_hz, 50.0);
    assert_eq!(Timing { rate_hz: 25.0, between: 4 }.played(AnimationFormat::Gif).rate_hz, 10.0);
    assert_eq!(Timing { rate_hz: 60.0, between: 4 }.played(AnimationFormat::Mp4).rate_hz, 60.0);
}

#[test]
fn pictures_in_between_lead_to_the_next() {
    let (reel, wanted) = moving(3);
    let frames =
        decoded(AnimationFormat::Apng, &work::finish(reel.encode(AnimationFormat::Apng, None)).expect("it is encoded"));
    assert_eq!(frames.len(), 13);
    let delays: Vec<u32> = frames.iter().map(|frame| frame.delay().numer_denom_ms()).map(|(n, d)| n / d).collect();
    assert_eq!(delays[..5], [50, 17, 16, 17, 50], "a step takes 0.1 s with its way to the next");
    let at = |frame: usize| frames[frame].buffer().get_pixel(10, 8).0[0];
    let [sky, red] = [0, 1].map(|step| wanted[step].get_pixel(10, 8).0[0]);
    let way: Vec<u8> = (0..5).map(at).collect();
    assert_eq!([way[0], way[2], way[4]], [sky, sky / 2 + red / 2, red]);
    assert!(way[1] - way[0] < way[2] - way[1], "eased: {way:?}");
}

#[test]
fn of_many_colours_those_of_marks_stay_exact() {
    let gradient = |x: u32, y: u32| Rgb([(x * 2) as u8, (y * 2) as u8, (x + y) as u8]);
    let mut picture = RgbImage::from_fn(120, 100, gradient);
    for x in 0..120 {
        (0..3).for_each(|y| picture.put_pixel(x, 50 + y, RED));
    }
    let mut reel = Reel::new(Timing::default(), [0; 3]);
    for _ in 0..2 {
        reel.push(png(120, 100, Pixels::Rgb(picture.as_raw())).expect("a picture")).expect("a PNG file");
    }
    let frames =
        decoded(AnimationFormat::Gif, &work::finish(reel.encode(AnimationFormat::Gif, None)).expect("it is encoded"));
    let seen = image::DynamicImage::ImageRgba8(frames[1].buffer().clone()).into_rgb8();
    assert!((0..120).all(|x| *seen.get_pixel(x, 51) == RED));
    let worst = picture.iter().zip(seen.iter()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst < Some(24), "{worst:?} of 255");
    assert_eq!(
        work::finish(reel.encode(AnimationFormat::Gif, None)),
        work::finish(reel.encode(AnimationFormat::Gif, None)),
        "the same bytes"
    );
}

#[test]
fn changes_are_bounded_tightly() {
    let before = vec![0; 6 * 4];
    let mut now = before.clone();
    assert_eq!(Area::of_changes([&before, &now], 6, 1), Area { x: 0, y: 0, width: 1, height: 1 });
    (now[6 + 2], now[3 * 6 + 4]) = (1, 1);
    let area = Area::of_changes([&before, &now], 6, 1);
    assert_eq!(area, Area { x: 2, y: 1, width: 3, height: 3 });
    assert_eq!(area.cut(&now, 6, 1), [1, 0, 0, 0, 0, 0, 0, 0, 1]);
}

#[test]
fn what_cannot_be_animated_is_said() {
    let none =
        work::finish(Reel::new(Timing::default(), [0; 3]).encode(AnimationFormat::Gif, None)).expect_err("no step");
    assert_eq!(none.to_string(), "there is no step to animate");
    let named = AnimationFormat::of(Path::new("steps.avi")).expect_err("no such format").to_string();
    assert!(named.contains(".gif, .apng, .webp or .mp4"), "{named}");
    assert_eq!(AnimationFormat::of(Path::new("a/Steps.PNG")), Ok(AnimationFormat::Apng));
    struct Cancelled;
    impl Progress for Cancelled {
        fn report(&self, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    for format in OWN {
        assert_eq!(
            work::finish(moving(0).0.encode(format, Some(&Cancelled))).expect_err("cancelled").to_string(),
            "saving was cancelled"
        );
    }
    let wide = |format, side| {
        let mut reel = Reel::new(Timing::default(), [0; 3]);
        reel.push(png(side, 1, Pixels::Gray(&vec![0; side])).expect("a line")).expect("a PNG file");
        work::finish(reel.encode(format, None)).expect_err("too wide").to_string()
    };
    assert!(wide(AnimationFormat::Gif, 70_000).contains("65\u{2009}535"));
    assert!(wide(AnimationFormat::WebP, 17_000).contains("16\u{2009}384"));
}
