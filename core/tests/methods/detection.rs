//! Models of the background against plain ones written from the papers' formulas, and against exact truth.

use std::sync::Arc;

use crate::common::{Objects, set, waves};
use motionscope_core::base::{Error, Stop, Threads};
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, ClipInfo, Frame, FrameSource, Mask, ObjectBox};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::products::ObjectField;
use motionscope_core::run::{AnyEstimator, Cursor, Guarantee, Move};
use motionscope_core::scene::{Focus, Shape};
use motionscope_core::synth;

/// A number that tells a place and a frame from all others.
fn hash(x: usize, y: usize, t: usize) -> u64 {
    let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (t as u64 * 0xC2B2_AE35);
    mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33
}

/// Noise, about normal with a standard deviation of 2.
fn noise(x: usize, y: usize, t: usize) -> f64 {
    (0..6).map(|k| (hash(x, y, 7 * t + k) % 1000) as f64 / 1000.0 - 0.5).sum::<f64>() * 2.0 * 2f64.sqrt()
}

/// A colour before which a disc moves and a lamp blinks, with noise.
fn color(x: usize, y: usize, t: usize) -> [u8; 3] {
    let (dx, dy) = (x as f64 - 8.0 - 1.5 * t as f64, y as f64 - 11.0);
    let base = [60.0 + x as f64, 90.0 + 2.0 * y as f64, 120.0 - x as f64];
    let pixel = if dx.hypot(dy) < 6.0 {
        [200.0, 60.0 + 5.0 * dy, 40.0]
    } else if (dx + 9.0).abs() < 4.0 && dy.abs() < 6.0 {
        // A shadow follows it.
        base.map(|c| 0.7 * c)
    } else if y < 4 && x > 50 && (t / 3) % 2 == 1 {
        [220.0, 220.0, 120.0]
    } else {
        base
    };
    [0, 1, 2].map(|c| (pixel[c] + noise(x, y, 3 * t + c)).round().clamp(0.0, 255.0) as u8)
}

const SIZE: (usize, usize) = (75, 23);

fn colorful(frames: usize) -> Clip {
    let frame = |t| Frame::rgb(Grid::from_fn(SIZE.0, SIZE.1, |x, y| color(x, y, t)));
    Clip::from_frames("colourful", (0..frames).map(frame).collect()).expect("frames of one size")
}

fn in_gray(clip: &Clip, frames: usize) -> Clip {
    let frame = |t| Frame::gray(clip.frame(t).expect("a frame").luma().clone());
    Clip::from_frames("gray", (0..frames).map(frame).collect()).expect("frames of one size")
}

/// The estimator with what it decides left as it is.
fn raw(id: &str, settings: &[(&str, &str)]) -> Box<dyn AnyEstimator> {
    let mut estimator = set(id, &[("opening", "0"), ("closing", "0"), ("min-area", "1")]);
    for (name, text) in [("camera", "still"), ("shake", "0"), ("initial", "first-frame"), ("area-opening", "0")] {
        if estimator.get(name).is_ok() {
            estimator.set(name, text).expect("in range");
        }
    }
    settings.iter().for_each(|(name, text)| estimator.set(name, text).expect("in range"));
    estimator
}

fn objects(estimator: &dyn AnyEstimator, clip: &Clip) -> ObjectField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<ObjectField>().expect("objects").clone()
}

/// The masks of all frames but the first.
fn masks(estimator: &dyn AnyEstimator, clip: &Clip) -> Vec<Mask> {
    objects(estimator, clip)
        .frames
        .iter()
        .skip(1)
        .map(|frame| frame.mask.as_ref().expect("a mask").unpacked())
        .collect()
}

/// The masks that a plain model of a pixel gives, which is made of its values in the first frame.
fn plain<S>(
    clip: &Clip,
    frames: usize,
    begin: impl Fn(&[f64]) -> S,
    mut is_foreground: impl FnMut(&mut S, &[f64]) -> bool,
) -> Vec<Mask> {
    let values = |frame: &Frame, place: (usize, usize)| match frame.color() {
        Some(color) => color[place].map(f64::from).to_vec(),
        None => vec![f64::from(frame.luma()[place])],
    };
    let first = clip.frame(0).expect("a frame");
    let mut model = Grid::from_fn(SIZE.0, SIZE.1, |x, y| begin(&values(&first, (x, y))));
    (1..frames)
        .map(|t| {
            let frame = clip.frame(t).expect("a frame");
            Mask::from_fn(SIZE.0, SIZE.1, |x, y| is_foreground(&mut model[(x, y)], &values(&frame, (x, y))))
        })
        .collect()
}

/// How many pixels differ, and how many are set in the second.
fn differing(found: &[Mask], expected: &[Mask]) -> (usize, usize) {
    assert_eq!(found.len(), expected.len());
    let off = found.iter().zip(expected).map(|(a, b)| a.without(b).count() + b.without(a).count()).sum();
    (off, expected.iter().map(Mask::count).sum())
}

#[test]
fn models_of_levels_decide_as_their_papers_say() {
    const FRAMES: usize = 30;
    let colored = colorful(FRAMES);
    for (name, clip) in [("gray", &in_gray(&colored, FRAMES)), ("colour", &colored)] {
        let same = |id: &str, settings: &[(&str, &str)], expected: Vec<Mask>| {
            let mut estimator = raw(id, settings);
            if estimator.get("detect-shadows").is_ok() {
                estimator.set("detect-shadows", "off").expect("a switch");
            }
            let (off, set) = differing(&masks(&*estimator, clip), &expected);
            assert!(off == 0 && set > 500, "{id} {settings:?} in {name}: {off} of {set} pixels differ");
        };
        let differs = |b: &[f64], i: &[f64], limit: f64| b.iter().zip(i).any(|(b, i)| (b - i).abs() > limit);
        let begin = |i: &[f64]| i.to_vec();
        let two = plain(clip, FRAMES, begin, |b, i| differs(&std::mem::replace(b, i.to_vec()), i, 12.0));
        same("frame-difference", &[("threshold", "12")], two);
        let three = plain(
            clip,
            FRAMES,
            |i| [i.to_vec(), i.to_vec()],
            |b, i| {
                let is_foreground = b.iter().all(|b| differs(b, i, 12.0));
                b.swap(0, 1);
                b[0] = i.to_vec();
                is_foreground
            },
        );
        same("frame-difference", &[("threshold", "12"), ("differencing", "3")], three);
        for (selective, name) in [(false, "off"), (true, "on")] {
            let average = plain(clip, FRAMES, begin, |b, i| {
                let is_foreground = differs(b, i, 20.3);
                if !(selective && is_foreground) {
                    b.iter_mut().zip(i).for_each(|(b, i)| *b = 0.95 * *b + 0.05 * i);
                }
                is_foreground
            });
            let settings = [("threshold", "20.3"), ("learning-rate", "0.05"), ("selective", name)];
            same("running-average", &settings, average);
            let gaussian = plain(
                clip,
                FRAMES,
                |i| i.iter().map(|i| (*i, 25.0f64)).collect::<Vec<_>>(),
                |model, i| {
                    let is_off = |((mean, variance), i): (&(f64, f64), &f64)| (i - mean).abs() / variance.sqrt() > 3.3;
                    let is_foreground = model.iter().zip(i).any(is_off);
                    if !(selective && is_foreground) {
                        for ((mean, variance), i) in model.iter_mut().zip(i) {
                            let deviation = i - *mean;
                            *mean = 0.95 * *mean + 0.05 * i;
                            *variance = (0.95 * *variance + 0.05 * deviation * deviation).max(2.25);
                        }
                    }
                    is_foreground
                },
            );
            let settings =
                [("threshold", "3.3"), ("learning-rate", "0.05"), ("initial-sigma", "5"), ("min-sigma", "1.5")];
            same("single-gaussian", &[&settings[..], &[("selective", name)]].concat(), gaussian);
        }
        for step in [1, 4] {
            let median = plain(clip, FRAMES, begin, |b, i| {
                let (is_foreground, step) = (differs(b, i, 20.0), f64::from(step));
                b.iter_mut().zip(i).for_each(|(b, i)| *b += (i - *b).clamp(-step, step));
                is_foreground
            });
            same("median-background", &[("threshold", "20"), ("step", &step.to_string())], median);
        }
    }
}

#[test]
fn gray_models_miss_an_object_as_bright_as_the_background_and_models_of_channels_do_not() {
    let frame = |t: usize| {
        let is_object = |x: usize, y: usize| (10..40).contains(&y) && (4 * t..4 * t + 24).contains(&x);
        // Both have the gray level 100.
        Frame::rgb(Grid::from_fn(96, 64, |x, y| if is_object(x, y) { [40, 113, 195] } else { [100, 100, 100] }))
    };
    let clip = Clip::from_frames("blue", (0..12).map(frame).collect()).expect("frames of one size");
    let luma = clip.frame(5).expect("a frame").luma().clone();
    assert!(luma.cells().iter().all(|level| level.abs_diff(100) <= 1), "the object cannot be seen in gray");
    for id in ["running-average", "median-background", "single-gaussian", "frame-difference"] {
        let found = |channels: &str| {
            let field = objects(&*set(id, &[("channels", channels), ("shake", "0")]), &clip);
            field.frames[8].mask.as_ref().expect("a mask").unpacked().count()
        };
        let (gray, rgb) = (found("gray"), found("rgb"));
        println!("{id}: {gray} px in gray, {rgb} px in colour");
        assert!(gray == 0 && rgb >= 240, "{id}: {gray} px in gray, {rgb} px in colour");
    }
    // The explanation names the channel that decides.
    let mut walk = set("running-average", &[("shake", "0")]).walk(&clip, 0).expect("a run");
    walk.jump(Move::To("9.2".parse().expect("a cursor")));
    let told = walk.step(Some(Focus::current([40.0, 20.0]))).sentence.plain();
    assert!(told.contains("in blue exceeds the threshold") && told.contains("(40,"), "{told}");
}

/// A mode of the plain mixture.
#[derive(Clone)]
struct Mode {
    weight: f64,
    mean: Vec<f64>,
    variance: f64,
}

/// The parameters of the plain mixture.
struct Plain {
    rate: f64,
    prune: f64,
    threshold: f64,
    background: f64,
    most: usize,
    darkest: Option<f64>,
}

impl Plain {
    /// Zivkovic 2004, (4) to (9), with the modes in order of weight; a new mode takes `rate` of the weight.
    fn is_foreground(&self, modes: &mut Vec<Mode>, pixel: &[f64]) -> bool {
        let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let limit = |mode: &Mode| self.threshold * self.threshold * mode.variance;
        let mut sum = 0.0;
        let background = modes.iter().take_while(|mode| {
            let is_one = sum < self.background;
            sum += mode.weight;
            is_one
        });
        let background = background.count();
        let fits = modes.iter().position(|mode| square(pixel, &mode.mean) <= limit(mode));
        let is_foreground = fits.is_none_or(|fits| fits >= background);
        let is_shadow = self.darkest.is_some_and(|darkest| {
            modes[..background].iter().any(|mode| {
                let light = pixel.iter().zip(&mode.mean).map(|(a, b)| a * b).sum::<f64>()
                    / mode.mean.iter().map(|b| b * b).sum::<f64>();
                let darker: Vec<_> = mode.mean.iter().map(|mean| light * mean).collect();
                let bright: f64 = pixel.iter().map(|c| c * c).sum();
                (darkest..=1.0).contains(&light) && square(pixel, &darker) <= limit(mode) + 0.03 * 0.03 * bright
            })
        });
        for (index, mode) in modes.iter_mut().enumerate() {
            let ownership = if fits == Some(index) { 1.0 } else { 0.0 };
            mode.weight += self.rate * (ownership - mode.weight) - self.rate * self.prune;
            if fits == Some(index) {
                let (step, off) = (self.rate / mode.weight, square(pixel, &mode.mean));
                mode.mean.iter_mut().zip(pixel).for_each(|(mean, pixel)| *mean += step * (pixel - *mean));
                mode.variance = (mode.variance + step * (off - mode.variance)).clamp(4.0, 81.0);
            }
        }
        modes.retain(|mode| mode.weight > 0.0);
        if fits.is_none() {
            modes.truncate(self.most - 1);
        }
        let total: f64 = modes.iter().map(|mode| mode.weight).sum();
        let left = if fits.is_none() { 1.0 - self.rate } else { 1.0 };
        modes.iter_mut().for_each(|mode| mode.weight *= left / total);
        if fits.is_none() {
            let weight = if modes.is_empty() { 1.0 } else { self.rate };
            modes.push(Mode { weight, mean: pixel.to_vec(), variance: 16.0 });
        }
        modes.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        is_foreground && !is_shadow
    }
}

/// The objects with the shadows that they enclose: from a shadow, straight ways over foreground lead to objects in opposite directions.
fn with_enclosed(all: &Mask, objects: &Mask) -> Mask {
    let (width, height) = all.size();
    // Part of a square of 3×3 px, so that single pixels do not count.
    let is_solid = |x: usize, y: usize| {
        let has_square = |left: usize, top: usize| (left..left + 3).all(|u| (top..top + 3).all(|v| objects.get(u, v)));
        (x.saturating_sub(2)..=x).any(|left| (y.saturating_sub(2)..=y).any(|top| has_square(left, top)))
    };
    let leads = |(x, y): (usize, usize), by: [isize; 2]| {
        let steps =
            (1isize..).map_while(|k| Some((x.checked_add_signed(k * by[0])?, y.checked_add_signed(k * by[1])?)));
        steps.take_while(|(x, y)| all.get(*x, *y)).any(|(x, y)| is_solid(x, y))
    };
    Mask::from_fn(width, height, |x, y| {
        let lies_between = |by: [isize; 2]| leads((x, y), by) && leads((x, y), by.map(|c| -c));
        objects.get(x, y) || all.get(x, y) && (lies_between([1, 0]) || lies_between([0, 1]))
    })
}

#[test]
fn the_mixture_decides_as_its_papers_say() {
    const FRAMES: usize = 60;
    let clip = colorful(FRAMES);
    for (clip, is_color) in [(&clip, true), (&in_gray(&clip, FRAMES), false)] {
        for (most, prune, shadows) in [(5, 0.05, true), (3, 0.0, false), (2, 0.01, true), (1, 0.05, false)] {
            let darkest = (shadows && is_color).then_some(0.5);
            let plain_one = Plain { rate: 0.02, prune, threshold: 3.1, background: 0.7, most, darkest };
            let begin = |i: &[f64]| vec![Mode { weight: 1.0, mean: i.to_vec(), variance: 16.0 }];
            let objects = plain(clip, FRAMES, begin, |modes, i| plain_one.is_foreground(modes, i));
            let with_shadows = Plain { darkest: None, ..plain_one };
            let all = plain(clip, FRAMES, begin, |modes, i| with_shadows.is_foreground(modes, i));
            let expected: Vec<_> = all.iter().zip(&objects).map(|(all, objects)| with_enclosed(all, objects)).collect();
            let settings = [
                ("learning-rate", "0.02"),
                ("complexity-reduction", &prune.to_string()),
                ("threshold", "3.1"),
                ("background-ratio", "0.7"),
                ("modes", &most.to_string()),
                ("detect-shadows", if shadows { "on" } else { "off" }),
            ];
            let found = masks(&*raw("mixture-of-gaussians", &settings), clip);
            let (off, set) = differing(&found, &expected);
            // In single precision a few of these 100,000 may fall on the other side.
            assert!(off <= 10 && set > 500, "{most} modes, colour: {is_color}: {off} of {set} pixels differ");
        }
    }
}

/// The mixer of SplitMix64 (Steele, Lea and Flood 2014), which draws the samples that are replaced.
fn draw(seed: u64, a: u64, b: u64) -> u64 {
    let mix = |x: u64| {
        let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    };
    mix(mix(mix(seed).wrapping_add(a)).wrapping_add(b))
}

/// The samples of a pixel: recent, earlier and old values, each with its class.
struct PlainSamples {
    sets: [Vec<(Vec<f64>, bool)>; 3],
    pixel: u64,
    frame: u64,
}

#[test]
fn neighbors_decide_as_their_paper_says() {
    const FRAMES: usize = 60;
    const COUNT: usize = 5;
    let (rate, reach, least) = (0.05f64, 18.0, 2);
    let clip = colorful(FRAMES);
    for clip in [&clip, &in_gray(&clip, FRAMES)] {
        let mut pixels = 0;
        let begin = |i: &[f64]| {
            let sets = [0, 1, 2].map(|_| vec![(i.to_vec(), true); COUNT]);
            // `Grid::from_fn` goes through the picture row by row.
            pixels += 1;
            PlainSamples { sets, pixel: pixels - 1, frame: 0 }
        };
        let begun = std::cell::RefCell::new(begin);
        let expected = plain(
            clip,
            FRAMES,
            |i| (begun.borrow_mut())(i),
            |model, i| {
                let off = |s: &[f64]| s.iter().zip(i).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
                let near = |is_one: &dyn Fn(bool) -> bool| {
                    let all = model.sets.iter().flatten();
                    all.filter(|(value, class)| off(value) <= reach && is_one(*class)).count()
                };
                let (is_foreground, class) = (near(&|class| class) < least, near(&|_| true) >= least);
                model.frame += 1;
                let ends = [0.7f64, 0.4, 0.1].map(|left| (left.ln() / (1.0 - rate).ln()).ceil());
                let lengths = [ends[0], ends[1] - ends[0], ends[2] - ends[1]];
                let [when, which] = [0, 1].map(|stream| draw(model.pixel, model.frame, stream));
                let slot = |part: usize| (which >> (8 * part)) as usize % 256 % COUNT;
                for set in [2, 1, 0] {
                    let period = ((lengths[set] / COUNT as f64).ceil() as u64).max(1);
                    if (when >> (20 * set)) % (1 << 20) % period == 0 {
                        let next =
                            if set == 0 { (i.to_vec(), class) } else { model.sets[set - 1][slot(2 * set)].clone() };
                        model.sets[set][slot(2 * set + 1)] = next;
                    }
                }
                is_foreground
            },
        );
        let settings = [("samples", "5"), ("k", "2"), ("threshold", "18"), ("learning-rate", "0.05")];
        let settings = [&settings[..], &[("detect-shadows", "off")]].concat();
        let (off, set) = differing(&masks(&*raw("knn-background", &settings), clip), &expected);
        assert!(off == 0 && set > 500, "{off} of {set} pixels differ");
    }
}

/// All that find objects by a model of the background.
fn subtractions() -> Vec<Box<dyn AnyEstimator>> {
    let all = estimators().into_iter().filter(|e| e.guarantee() == Guarantee::Objects && e.get("opening").is_ok());
    all.filter(|estimator| estimator.info().granularities.last() == Some(&"stage")).collect()
}

#[test]
fn what_is_reported_a_pixel_is_what_was_decided() {
    const FRAMES: usize = 20;
    let colorful = colorful(FRAMES);
    for clip in [in_gray(&colorful, FRAMES), colorful] {
        for estimator in subtractions() {
            let id = estimator.info().id;
            let shadows = if estimator.get("detect-shadows").is_ok() { &[("detect-shadows", "off")][..] } else { &[] };
            let estimator = raw(id, shadows);
            let mask = masks(&*estimator, &clip).pop().expect("a mask");
            let mut walk = estimator.walk(&clip, 0).expect("a run");
            // Behind the registration, if there is one, and the comparison.
            let event =
                2 + usize::from(estimator.info().pseudocode.iter().any(|line| line.name.to_string() == "register"));
            walk.jump(Move::To(Cursor { unit: FRAMES - 1, event }));
            let mut told = [0, 0];
            for (x, y) in (0..SIZE.1).step_by(2).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
                let sentence = walk.step(Some(Focus::current([x as f32, y as f32]))).sentence.plain();
                let [is_front, is_back] =
                    ["foreground", "background."].map(|word| sentence.to_lowercase().contains(word));
                assert!(mask.get(x, y) == is_front && is_front != is_back, "{id} at {x}, {y}: {sentence}");
                told[usize::from(is_front)] += 1;
            }
            assert!(told.iter().all(|count| *count > 10), "{id}: {told:?}");
        }
    }
}

#[test]
fn threads_change_nothing() {
    let clip = colorful(25);
    for estimator in estimators().into_iter().filter(|e| e.guarantee() == Guarantee::Objects) {
        let alone = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        for threads in [2, 3] {
            let together = estimator.run(&clip, 0, &Threads::new(threads).expect("threads")).expect("a run");
            assert!(alone == together, "{} on {threads} threads", estimator.info().id);
        }
    }
}

#[test]
fn a_shadow_is_taken_off_and_a_dark_object_is_not() {
    let frame = |t: usize| {
        Frame::rgb(Grid::from_fn(80, 60, |x, y| {
            let base = [120.0 + x as f64, 160.0, 90.0 + y as f64];
            let pixel = match (t > 3, (x, y)) {
                (true, (10..30, 20..40)) => base.map(|c| 0.65 * c),
                (true, (45..65, 20..40)) => [30.0, 40.0, 140.0],
                _ => base,
            };
            [0, 1, 2].map(|c| (pixel[c] + noise(x, y, 3 * t + c) / 2.0).round() as u8)
        }))
    };
    let clip = Clip::from_frames("shadow", (0..6).map(frame).collect()).expect("frames of one size");
    let boxes = |shadows| {
        let field = objects(&*set("mixture-of-gaussians", &[("detect-shadows", shadows)]), &clip);
        field.frames.last().expect("a frame").detections.iter().map(|found| found.bounds).collect::<Vec<_>>()
    };
    let square = |x: f32| Bounds { min: [x - 0.5, 19.5], max: [x + 19.5, 39.5] };
    assert_eq!((boxes("on"), boxes("off")), (vec![square(45.0)], vec![square(10.0), square(45.0)]));
    // Gray values do not tell a shadow from something dark.
    let gray = in_gray(&clip, 6);
    let field = objects(&*set("mixture-of-gaussians", &[]), &gray);
    assert_eq!(field.frames.last().expect("a frame").detections.len(), 2);
}

#[test]
fn gray_clothes_on_a_gray_floor_belong_to_the_person() {
    // Dark hair and shoes, and a coat of the colour of a shadow; a true shadow falls to the right.
    let frame = |t: usize| {
        Frame::rgb(Grid::from_fn(80, 60, |x, y| {
            let base = [180.0; 3];
            let pixel = match (t > 3, (x, y)) {
                (true, (30..42, 10..16 | 34..46)) => [40.0; 3],
                (true, (30..42, 16..34)) => [120.0; 3],
                (true, (42..60, 38..46)) => [125.0; 3],
                _ => base,
            };
            [0, 1, 2].map(|c| (pixel[c] + noise(x, y, 3 * t + c) / 2.0).round() as u8)
        }))
    };
    let clip = Clip::from_frames("coat", (0..6).map(frame).collect()).expect("frames of one size");
    for id in ["mixture-of-gaussians", "knn-background"] {
        let field = objects(&*set(id, &[("exposure", "ignored")]), &clip);
        let found: Vec<_> = field.frames.last().expect("a frame").detections.iter().map(|found| found.bounds).collect();
        assert_eq!(found, [Bounds { min: [29.5, 9.5], max: [41.5, 45.5] }], "{id}");
    }
}

#[test]
fn cars_are_found_where_they_are() {
    let scene = synth::scene("traffic").expect("a scene");
    let clip = scene.clip(&scene.difficulty()).expect("a clip");
    let cars = |t| clip.truth().expect("truth").objects(t).expect("readable").expect("known");
    let apart = |a: &Bounds, b: &Bounds| (0..2).any(|i| a.max[i] + 6.0 < b.min[i] || b.max[i] + 6.0 < a.min[i]);
    for mut estimator in subtractions() {
        // There is no noise, and a blue car is hardly brighter than the road.
        match estimator.info().id {
            "running-average" | "median-background" => estimator.set("threshold", "10").expect("in range"),
            "single-gaussian" => estimator.set("initial-sigma", "2.5").expect("in range"),
            _ => {}
        }
        let field = objects(&*estimator, &clip);
        let (mut found, mut all) = (0, 0);
        for (t, frame) in field.frames.iter().enumerate().skip(5) {
            let truth = cars(t);
            let places: Vec<_> = truth.iter().map(Bounds::from).collect();
            // Where a car stood in the first frame, its ghost is left.
            let ghosts: Vec<_> = cars(0).iter().map(Bounds::from).collect();
            for (i, place) in places.iter().enumerate().filter(|(i, _)| truth[*i].visibility > 0.95) {
                let mut others = places.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, other)| other);
                if others.any(|other| !apart(place, other)) || ghosts.iter().any(|ghost| !apart(place, ghost)) {
                    continue;
                }
                let best = frame.detections.iter().map(|d| d.bounds.iou(place)).fold(0.0, f32::max);
                found += usize::from(best >= 0.5);
                all += 1;
            }
        }
        assert!(all > 10 && 10 * found >= 9 * all, "{}: {found} of {all} cars", estimator.info().id);
    }
}

/// A square of waves that moves over waves at rest, with noise, and where it is in the last frame.
fn square_over_waves(frames: usize, step: f64) -> (Clip, Bounds) {
    let corner = |t: usize| [30.0 + step * t as f64, 24.0];
    let frame = |t: usize| {
        let [left, top] = corner(t);
        Frame::gray(Grid::from_fn(120, 80, |x, y| {
            let (u, v) = (x as f64 - left, y as f64 - top);
            let is_in = (0.0..30.0).contains(&u) && (0.0..24.0).contains(&v);
            let value = if is_in { waves(u + 500.0, v + 300.0) } else { waves(x as f64, y as f64) };
            (value + noise(x, y, t) / 2.0).round().clamp(0.0, 255.0) as u8
        }))
    };
    let clip = Clip::from_frames("square", (0..frames).map(frame).collect()).expect("frames of one size");
    let min = corner(frames - 1).map(|c| c.ceil() as f32 - 0.5);
    (clip, Bounds { min, max: [min[0] + 30.0, min[1] + 24.0] })
}

#[test]
fn flow_that_reaches_over_what_is_at_rest_is_no_motion() {
    let (clip, square) = square_over_waves(4, 3.0);
    for method in ["farneback", "horn-schunck", "tv-l1"] {
        let blobs = |clip: &Clip| {
            let field = objects(&*set("flow-magnitude", &[("method", method)]), clip);
            field.frames.last().expect("a frame").detections.iter().map(|found| found.bounds).collect::<Vec<_>>()
        };
        let found = blobs(&clip);
        let edges = |bounds: &Bounds| [bounds.min, bounds.max].concat();
        let [only] = &found[..] else { panic!("{method}: {found:?} where {square:?} is") };
        // Behind it, what comes out fits nowhere in the frame before; elsewhere the pixels around one reach over the edge.
        let limits = [3.0 + 3.0, 3.0, 3.0, 3.0];
        let is_near = edges(only).iter().zip(edges(&square)).zip(limits).all(|((a, b), limit)| (a - b).abs() <= limit);
        assert!(is_near, "{method}: {only:?} where {square:?} is");
        assert_eq!(blobs(&square_over_waves(4, 0.0).0), [], "{method}: nothing moves but noise");
    }
}

#[test]
fn what_a_stage_does_can_be_seen() {
    let clip = colorful(12);
    let estimator = set("mixture-of-gaussians", &[("min-area", "20")]);
    let mut walk = estimator.walk(&clip, 0).expect("a run");
    walk.jump(Move::To(Cursor { unit: 11, event: usize::MAX }));
    assert_eq!(walk.events(), 9);
    let lines: Vec<_> = (1..=9)
        .map(|event| {
            walk.jump(Move::To(Cursor { unit: 11, event }));
            walk.step(None).line.as_str()
        })
        .collect();
    let stages = [
        "compare",
        "decide",
        "remove-shadows",
        "suppress-shake",
        "open",
        "close",
        "label",
        "keep-blobs",
        "update-model",
    ];
    assert_eq!(lines, stages);
    assert_eq!(walk.at_frame(), 11);
}

/// A square that leaves its place in the first frame, with its truth.
fn leaving(frames: usize) -> Clip {
    let x = |t: usize| 6 + 6 * t;
    let frame = |t| {
        let is_in = |u: usize, v: usize| (x(t)..x(t) + 12).contains(&u) && (10..22).contains(&v);
        Frame::gray(Grid::from_fn(96, 40, |u, v| if is_in(u, v) { 200 } else { 60 }))
    };
    let truth = |t| vec![ObjectBox { id: 1, x: x(t) as f32, y: 10.0, width: 12.0, height: 12.0, visibility: 1.0 }];
    let clip = Clip::from_frames("leaving", (0..frames).map(frame).collect()).expect("frames of one size");
    clip.with_truth(Arc::new(Objects((0..frames).map(truth).collect())))
}

#[test]
fn an_update_tells_its_numbers_and_a_ghost_is_called_a_ghost() {
    let clip = leaving(8);
    let told = |initial: &str, unit: usize| {
        let mut walk = set("running-average", &[("initial", initial)]).walk(&clip, 0).expect("a run");
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        walk.step(None).sentence.plain()
    };
    let ghostly = told("first-frame", 5);
    assert!(ghostly.contains("B moves from") && ghostly.contains("α = 0.020"), "{ghostly}");
    assert!(ghostly.contains("1 ghost remains"), "{ghostly}");
    assert!(ghostly.contains("precision 0.50, recall 1.00, F₁ 0.67"), "{ghostly}");
    assert!(!told("median", 5).contains("ghost"), "{}", told("median", 5));
    assert!(told("median", 7).contains("Run against the ground truth"), "{}", told("median", 7));
}

#[test]
fn false_alarms_of_a_moving_camera_are_no_matter_of_a_threshold() {
    let end = |id: &str| {
        let sample = synth::scene(id).expect("it is bundled");
        let mut walk =
            set("frame-difference", &[]).walk(&sample.clip(&sample.difficulty()).expect("a clip"), 0).expect("a run");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    let moving = end("hand-held");
    assert!(moving.contains("the camera moves") && moving.contains("motion-compensated difference"), "{moving}");
    assert!(!moving.contains("a higher threshold"), "{moving}");
    let still = end("traffic");
    assert!(still.contains("a higher threshold") && !still.contains("the camera moves"), "{still}");
}

/// So many frames has [`Broken`].
const FRAMES: usize = 12;

/// A clip of which a frame is damaged, unless that is one that it has not got.
struct Broken(Clip, usize);

impl FrameSource for Broken {
    fn frame(&self, index: usize, _: &Stop) -> Result<Arc<Frame>, Error> {
        if index == self.1 { Err(Error::new("frame 7 is damaged")) } else { self.0.frame(index) }
    }

    fn has_frame(&self, index: usize, stop: &Stop) -> Result<bool, Error> {
        if index < FRAMES { self.frame(index, stop).map(|_| true) } else { Ok(false) }
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        self.0.cached(index).filter(|_| index != self.1)
    }
}

/// A textured scene that drifts by 2 px a frame behind a square at rest, each frame in gray or, where `in_color` says so, in the
/// same gray as a colour.
fn drifting(frames: usize, in_color: impl Fn(usize) -> bool) -> Clip {
    let gray = |t: usize, x: usize, y: usize| {
        let (u, v) = (x as f64 - 2.0 * t as f64, y as f64);
        let is_square = (60..75).contains(&x) && (40..55).contains(&y);
        let scene = 128.0 + 45.0 * (0.31 * u + 0.1 * v).sin() + 40.0 * (0.17 * u - 0.29 * v).cos();
        if is_square { (40 + 9 * t) as u8 } else { scene as u8 }
    };
    let frame = |t: usize| match in_color(t) {
        true => Frame::rgb(Grid::from_fn(160, 120, |x, y| [gray(t, x, y); 3])),
        false => Frame::gray(Grid::from_fn(160, 120, |x, y| gray(t, x, y))),
    };
    Clip::from_frames("drifting", (0..frames).map(frame).collect()).expect("frames of one size")
}

#[test]
fn a_model_keeps_its_channels_where_gray_and_colour_alternate_and_the_camera_drifts() {
    const FRAMES: usize = 8;
    let mut followed = 0;
    for mut estimator in subtractions() {
        let id = estimator.info().id;
        if estimator.set("camera", "followed").is_err() {
            continue;
        }
        if estimator.get("initial").is_ok() {
            estimator.set("initial", "first-frame").expect("it is a choice");
        }
        for begins_in_color in [false, true] {
            let mixed = drifting(FRAMES, |t| (t % 2 == 0) == begins_in_color);
            let alike = drifting(FRAMES, |_| begins_in_color);
            assert_eq!(masks(&*estimator, &mixed), masks(&*estimator, &alike), "{id}, colour first: {begins_in_color}");
        }
        followed += 1;
    }
    assert!(followed >= 6, "only {followed} models follow the camera");
}

#[test]
fn a_damaged_frame_ends_the_run_and_what_was_done_stays() {
    let clip = colorful(FRAMES);
    let info = clip.info().clone();
    let broken = Clip::new(info.clone(), Arc::new(Broken(clip.clone(), 7)));
    // Where nobody knows how many frames there are, damage is no end either; the clip ends where none comes.
    let unknown =
        |damaged| Clip::new(ClipInfo { frames: None, ..info.clone() }, Arc::new(Broken(clip.clone(), damaged)));
    let (endless, whole) = (unknown(7), unknown(FRAMES));
    for estimator in estimators().into_iter().filter(|e| e.guarantee() == Guarantee::Objects) {
        let id = estimator.info().id;
        let error = estimator.run(&broken, 0, &Threads::single()).expect_err("a damaged frame").to_string();
        assert!(error.contains("damaged"), "{id}: {error}");
        let mut walk = estimator.walk(&broken, 0).expect("a run");
        walk.jump(Move::End);
        assert!(walk.failure().is_some(), "{id}");
        assert_eq!(walk.output().get::<ObjectField>().expect("objects").frames.len(), 7, "{id}");
        let error = estimator.run(&endless, 0, &Threads::single()).expect_err("a damaged frame").to_string();
        assert!(error.contains("damaged"), "{id}: {error}");
        assert_eq!(objects(&*estimator, &whole).frames.len(), FRAMES, "{id}");
    }
}

#[test]
fn connected_components_label_what_is_bright() {
    let frame = |_| {
        Frame::gray(Grid::from_fn(40, 30, |x, y| match (x, y) {
            (3..9, 4..20) | (9..20, 16..20) | (30..36, 2..28) => 200,
            _ => 20,
        }))
    };
    let clip = Clip::from_frames("bright", (0..2).map(frame).collect()).expect("frames of one size");
    let settings = [("pixels", "bright"), ("threshold", "100"), ("closing", "0"), ("min-area", "30")];
    let field = objects(&*set("connected-components", &settings), &clip);
    let found: Vec<_> =
        field.frames[0].detections.iter().map(|d| (d.bounds, d.blob.expect("a shape").area_px)).collect();
    let bounds = |min: [f32; 2], max: [f32; 2]| Bounds { min: min.map(|c| c - 0.5), max: max.map(|c| c - 0.5) };
    let expected = [(bounds([30.0, 2.0], [36.0, 28.0]), 156), (bounds([3.0, 4.0], [20.0, 20.0]), 140)];
    assert_eq!(found, expected);
}

#[test]
fn a_union_is_marked_and_drawn_and_empty_rows_are_idle() {
    // Two bars that meet in row 12 below: one union.
    let frame = |_| {
        Frame::gray(Grid::from_fn(40, 30, |x, y| match (x, y) {
            (4..8, 6..12) | (20..24, 8..12) | (4..24, 12..16) => 200,
            _ => 20,
        }))
    };
    let clip = Clip::from_frames("bright", (0..2).map(frame).collect()).expect("frames of one size");
    let settings = [("pixels", "bright"), ("threshold", "100"), ("closing", "0"), ("min-area", "30")];
    let mut walk = set("connected-components", &settings).walk(&clip, 0).expect("a run");
    let (mut idle, mut marks) = (Vec::new(), Vec::new());
    for row in 0..30 {
        walk.jump(Move::To(Cursor { unit: row, event: usize::MAX }));
        idle.extend(walk.is_idle().then_some(row));
        marks.extend(walk.landmarks().into_iter().map(|(event, _)| (row, event)));
    }
    assert_eq!(idle, (0..6).chain(16..30).collect::<Vec<_>>());
    // The next step names the rows that were passed.
    for (unit, words) in [
        (6, "Rows 0 to 5 have no foreground pixels. Row 6 has 4 foreground pixels."),
        (7, "Row 7 has 4 foreground pixels."),
        (30, "Rows 16 to 29 have no foreground pixels. 2 provisional labels with 1 root."),
    ] {
        walk.jump(Move::To(Cursor { unit, event: 1 }));
        let sentence = walk.step(None).sentence.plain();
        assert!(sentence.starts_with(words), "{sentence}");
    }
    let &[(row, event)] = &marks[..] else { panic!("one union, not {marks:?}") };
    walk.jump(Move::To(Cursor { unit: row, event }));
    assert_eq!(row, 12);
    let arrows = walk.scene(None).marks.into_iter().find_map(|mark| match mark.shape {
        Shape::Arrows(arrows) => Some(arrows),
        _ => None,
    });
    // From the first run of label 2 to the first run of label 1.
    let arrows = arrows.expect("the forest is drawn");
    assert_eq!(arrows.iter().map(|arrow| (arrow.from, arrow.to)).collect::<Vec<_>>(), [([21.5, 8.0], [5.5, 6.0])]);
}

#[test]
fn masks_end_where_the_picture_does_at_any_width() {
    for width in [17, 33, 40, 47, 63, 64, 65, 129, 200, 854] {
        let value = |x: usize, y: usize, t: usize| (hash(x, y, t) % 200) as u8;
        for in_color in [false, true] {
            let frame = |t| match in_color {
                true => Frame::rgb(Grid::from_fn(width, 9, |x, y| [0, 1, 2].map(|c| value(x, y, 3 * t + c)))),
                false => Frame::gray(Grid::from_fn(width, 9, |x, y| value(x, y, t))),
            };
            let clip = Clip::from_frames("noise", (0..4).map(frame).collect()).expect("frames of one size");
            // Where nothing is background, everything is foreground, and no more than that.
            let all =
                objects(&*raw("mixture-of-gaussians", &[("background-ratio", "0"), ("detect-shadows", "off")]), &clip);
            assert_eq!(all.frames[3].mask.as_ref().map(|mask| mask.count()), Some(9 * width), "{width}");
            for mut estimator in estimators().into_iter().filter(|e| e.get("closing").is_ok()) {
                for (name, text) in [("opening", "0"), ("closing", "0"), ("min-area", "1")] {
                    estimator.set(name, text).expect("in range");
                }
                for threads in [1, 2] {
                    let output = estimator.run(&clip, 0, &Threads::new(threads).expect("threads")).expect("a run");
                    for frame in &output.get::<ObjectField>().expect("objects").frames {
                        let mask = frame.mask.as_ref().expect("a mask");
                        let inside =
                            |found: &motionscope_core::data::Detection| found.bounds.max[0] <= width as f32 - 0.5;
                        assert!(mask.count() <= 9 * width && frame.detections.iter().all(inside), "{width}");
                    }
                }
            }
        }
    }
}
