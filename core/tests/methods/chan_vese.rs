//! The active contour without edges, held to its scheme in plain loops, and beside snakes on scenes that only one of them solves.

use crate::common::{set, tile};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::{MaskField, RegionField};
use motionscope_core::run::{AnyEstimator, Direction, Move};
use motionscope_core::scene::{Readout, Step};
use motionscope_core::synth;

type Point = [f64; 2];

/// A number of 0 to 255 that belongs to a pixel.
fn noise(x: usize, y: usize, seed: u64) -> u8 {
    let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (seed * 0xC2B2_AE35);
    (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as u8
}

fn clip(frames: Vec<Frame>) -> Clip {
    Clip::from_frames("frames", frames).expect("frames of one size")
}

fn distance((x, y): (usize, usize), center: Point) -> f64 {
    (x as f64 - center[0]).hypot(y as f64 - center[1])
}

/// A frame of 96×72 px by the gray level of each pixel, without noise and with it, up to half of `range` either way.
fn frame(range: f64, seed: u64, level: impl Fn((usize, usize)) -> f64) -> Frame {
    Frame::gray(Grid::from_fn(96, 72, |x, y| {
        let off = range * (f64::from(noise(x, y, seed)) / 255.0 - 0.5);
        (level((x, y)) + off).clamp(0.0, 255.0) as u8
    }))
}

/// A circle as the value of the parameter `contour`.
fn circle(center: Point, radius: f64) -> String {
    let corner = |i: usize| {
        let (sin, cos) = (i as f64 * std::f64::consts::TAU / 40.0).sin_cos();
        format!("{:.2},{:.2}", center[0] + radius * cos, center[1] + radius * sin)
    };
    (0..40).map(corner).collect::<Vec<_>>().join(" ")
}

/// The steps of the first frame whose sentences have a phrase, in their order.
fn steps(estimator: &dyn AnyEstimator, clip: &Clip, phrase: &str) -> Vec<Step> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let mut found = Vec::new();
    while walk.cursor().unit == 0 && !walk.at_end() {
        let step = walk.step(None);
        if step.sentence.plain().contains(phrase) {
            found.push(step);
        }
        walk.jump(Move::Granularity(2, Direction::Forward));
    }
    found
}

/// Intersection over union of the masks with a disc, by frame; 0 where there is no mask.
fn overlaps(
    estimator: &dyn AnyEstimator,
    clip: &Clip,
    disc: impl Fn(usize) -> (Point, f64),
    frames: usize,
) -> Vec<f64> {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    let mut all = vec![0.0; frames];
    for (t, mask) in output.get::<MaskField>().expect("masks").masks().filter(|(t, _)| *t < frames) {
        let (mask, (center, radius)) = (mask.unpacked(), disc(t));
        let (mut both, mut either) = (0u32, 0u32);
        for at in (0..mask.height()).flat_map(|y| (0..mask.width()).map(move |x| (x, y))) {
            let (inside, found) = (distance(at, center) < radius, mask.get(at.0, at.1));
            both += u32::from(inside && found);
            either += u32::from(inside || found);
        }
        all[t] = f64::from(both) / f64::from(either.max(1));
    }
    all
}

/// φ on a window by rows, with what the scheme needs of it.
struct Level {
    size: (usize, usize),
    phi: Vec<f64>,
}

impl Level {
    /// φ at a pixel; beyond the border of the window its edge is repeated.
    fn at(&self, x: isize, y: isize) -> f64 {
        let [x, y] = [x.clamp(0, self.size.0 as isize - 1), y.clamp(0, self.size.1 as isize - 1)];
        self.phi[y as usize * self.size.0 + x as usize]
    }

    /// The signed distance to the border between pixels inside and outside, over all pairs.
    fn distance_to(size: (usize, usize), inside: impl Fn(usize, usize) -> bool) -> Self {
        let places = || (0..size.1).flat_map(move |y| (0..size.0).map(move |x| (x, y)));
        let phi = places().map(|(x, y)| {
            let others = places().filter(|(u, v)| inside(*u, *v) != inside(x, y));
            let least = others.map(|at| distance(at, [x as f64, y as f64])).fold(f64::INFINITY, f64::min);
            if inside(x, y) { least - 0.5 } else { 0.5 - least }
        });
        Self { size, phi: phi.collect() }
    }

    /// A step of the scheme (Chan and Vese 2001, section III; Getreuer 2012, equation 22) from the neighbours of the step before.
    fn evolved(&self, u: &[f64], (mu, nu, lambda, step): (f64, f64, [f64; 2], f64)) -> Self {
        let mean = |is_in: bool| {
            let own = || self.phi.iter().zip(u).filter(move |(phi, _)| (**phi >= 0.0) == is_in);
            own().map(|(_, u)| u).sum::<f64>() / own().count() as f64
        };
        let [c1, c2] = [mean(true), mean(false)];
        let across = |x: isize, y: isize| {
            let (forward, central) = (self.at(x + 1, y) - self.at(x, y), (self.at(x, y + 1) - self.at(x, y - 1)) / 2.0);
            mu / (1e-8 + forward * forward + central * central).sqrt()
        };
        let down = |x: isize, y: isize| {
            let (forward, central) = (self.at(x, y + 1) - self.at(x, y), (self.at(x + 1, y) - self.at(x - 1, y)) / 2.0);
            mu / (1e-8 + forward * forward + central * central).sqrt()
        };
        let (width, height) = (self.size.0 as isize, self.size.1 as isize);
        let next = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| {
            let here = self.at(x, y);
            let around = [
                (across(x, y), self.at(x + 1, y)),
                (if x > 0 { across(x - 1, y) } else { 0.0 }, self.at(x - 1, y)),
                (down(x, y), self.at(x, y + 1)),
                (if y > 0 { down(x, y - 1) } else { 0.0 }, self.at(x, y - 1)),
            ];
            let level = u[(y * width + x) as usize];
            let force = -nu - lambda[0] * (level - c1).powi(2) + lambda[1] * (level - c2).powi(2);
            let rate = step / (std::f64::consts::PI * (1.0 + here * here));
            let (flow, weight) = around.iter().fold((0.0, 0.0), |(sum, all), (a, phi)| (sum + a * phi, all + a));
            (here + rate * (flow + force)) / (1.0 + rate * weight)
        });
        Self { size: self.size, phi: next.collect() }
    }
}

#[test]
fn iterations_are_those_of_the_scheme() {
    let picture = frame(50.0, 1, |at| if distance(at, [44.0, 37.0]) < 13.0 { 150.0 } else { 80.0 });
    let clip = clip(vec![picture.clone(); 2]);
    for (mu, nu, lambda, step) in [(0.2f32, 0.0f32, [1.0f32, 1.0f32], 50.0f32), (0.6, 0.05, [0.8, 1.5], 4.0)] {
        let texts = [mu, nu, lambda[0], lambda[1], step].map(|value| value.to_string());
        let settings = [
            ("contour", "36,30 60,30 60,52 36,52"),
            ("mu", &texts[0]),
            ("nu", &texts[1]),
            ("lambda-inside", &texts[2]),
            ("lambda-outside", &texts[3]),
            ("time-step", &texts[4]),
            ("iterations", "8"),
        ];
        let found = steps(&*set("chan-vese", &settings), &clip, "Iteration ");
        assert_eq!(found.len(), 8);
        // The box of the contour and 16 px more.
        let (left, top, size) = (20, 14, (57, 55));
        let luma = picture.luma();
        let window: Vec<u8> = (0..size.1)
            .flat_map(|y| (0..size.0).map(move |x| (x, y)))
            .map(|(x, y)| luma[(left + x, top + y)])
            .collect();
        let [low, high] = [window.iter().min(), window.iter().max()].map(|v| f64::from(*v.expect("pixels")));
        let u: Vec<f64> = window.iter().map(|v| (f64::from(*v) - low) / (high - low)).collect();
        let inside = |x: usize, y: usize| (36..60).contains(&(left + x)) && (30..52).contains(&(top + y));
        let mut level = Level::distance_to(size, inside);
        let start = tile(&steps(&*set("chan-vese", &settings), &clip, "signed distance")[0], "level set φ");
        assert!(start.cells().iter().zip(&level.phi).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-4), "the start");
        for (i, step_found) in found.iter().enumerate() {
            level = level.evolved(&u, (mu.into(), nu.into(), lambda.map(f64::from), step.into()));
            let phi = tile(step_found, "level set φ");
            let off = phi.cells().iter().zip(&level.phi).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
            assert!(off < 5e-3 * (i + 1) as f64, "μ = {mu}: φ is {off:.5} off after iteration {}", i + 1);
        }
    }
}

/// The last mean overlap of the frames of an estimator that starts from a circle around the disc.
fn last(id: &str, own: &[(&str, &str)], clip: &Clip, place: impl Fn(usize) -> Point) -> f64 {
    let start = circle(place(0), 15.0);
    let found =
        overlaps(&*set(id, &[&[("contour", start.as_str())], own].concat()), clip, |t| (place(t), 14.0), FRAMES);
    found[FRAMES - 4..].iter().sum::<f64>() / 4.0
}

const FRAMES: usize = 16;

/// Snakes with the force of their edges.
const SNAKES: [(&str, &[(&str, &str)]); 3] =
    [("active-contour", &[]), ("active-contour", &[("force", "gradient-vector-flow")]), ("greedy-contour", &[])];

#[test]
fn a_blurred_object_in_noise_has_no_edges_but_means() {
    let place = |t: usize| [34.0 + 1.5 * t as f64, 36.0];
    let blurred = |t: usize| {
        frame(160.0, t as u64, move |at| 70.0 + 90.0 / (1.0 + ((distance(at, place(t)) - 14.0) / 2.5).exp()))
    };
    let clip = clip((0..FRAMES).map(blurred).collect());
    let regions = last("chan-vese", &[], &clip, place);
    assert!(regions > 0.8, "{regions:.3}");
    for (id, own) in SNAKES {
        let edges = last(id, own, &clip, place);
        assert!(edges < regions - 0.15, "{id} {own:?}: {edges:.3}, without edges {regions:.3}");
    }
}

#[test]
fn a_plain_ball_in_noise_is_followed_to_the_tunnel() {
    let mut difficulty = synth::scene("tunnel").expect("it is bundled").difficulty();
    [("low-texture", "100"), ("noise", "20")]
        .iter()
        .for_each(|(name, value)| difficulty.set(name, value).expect("in range"));
    let clip = synth::make("tunnel", &difficulty).expect("a clip");
    // Just before the ball reaches the entrance.
    let overlap = |id: &str| {
        let output = set(id, &[]).run(&clip, 0, &Threads::single()).expect("a run");
        let errors = output.get::<RegionField>().expect("a region").errors(&clip).expect("readable");
        errors[8..11].iter().map(|error| error.overlap).sum::<f64>() / 3.0
    };
    let [regions, snake, greedy] = ["chan-vese", "active-contour", "greedy-contour"].map(overlap);
    assert!(
        regions > 0.9 && snake < 0.7 && greedy < 0.2,
        "without edges {regions:.3}, with {snake:.3} and {greedy:.3}"
    );
}

#[test]
fn uneven_light_separates_no_means_but_leaves_edges() {
    let place = |t: usize| [34.0 + 1.5 * t as f64, 36.0];
    let shaded = |t: usize| {
        frame(4.0, t as u64, move |at| {
            20.0 + 2.0 * at.0 as f64 + if distance(at, place(t)) < 14.0 { 40.0 } else { 0.0 }
        })
    };
    let clip = clip((0..FRAMES).map(shaded).collect());
    let regions = last("chan-vese", &[], &clip, place);
    let edges = last("active-contour", &[], &clip, place);
    assert!(edges > 0.8 && regions < 0.5, "with edges {edges:.3}, without {regions:.3}");
}

#[test]
fn what_is_as_bright_and_touches_the_object_becomes_a_part_of_it() {
    let place = |t: usize| [24.0 + 1.5 * t as f64, 36.0];
    let with = |bar: f64| {
        let level = move |t: usize| {
            frame(10.0, t as u64, move |at| {
                if distance(at, place(t)) < 14.0 {
                    150.0
                } else if (54..66).contains(&at.0) {
                    bar
                } else {
                    70.0
                }
            })
        };
        let clip = clip((0..FRAMES).map(level).collect());
        last("chan-vese", &[], &clip, place)
    };
    let [clear, touched] = [70.0, 150.0].map(with);
    assert!(clear > 0.9 && touched < 0.6, "alone {clear:.3}, with a bar {touched:.3}");
}

#[test]
fn a_smaller_margin_keeps_clutter_out_of_the_window() {
    // A wall brighter than both the object and its ground.
    let place = |t: usize| [34.0, 22.0 + 2.0 * t as f64];
    let level = |t: usize| {
        frame(10.0, t as u64, move |at| match (distance(at, place(t)) < 14.0, at.0 >= 58) {
            (true, _) => 105.0,
            (_, true) => 255.0,
            _ => 70.0,
        })
    };
    let clip = clip((0..FRAMES).map(level).collect());
    let [small, large] = ["4", "16"].map(|margin| last("chan-vese", &[("margin", margin)], &clip, place));
    assert!(small > 0.9 && large < 0.4, "margin of 4 px {small:.3}, of 16 px {large:.3}");
}

#[test]
fn the_length_of_the_contour_ignores_noise() {
    let picture = frame(140.0, 3, |at| if distance(at, [46.0, 36.0]) < 14.0 { 150.0 } else { 80.0 });
    let clip = clip(vec![picture; 2]);
    let start = circle([46.0, 36.0], 12.0);
    let wrong = |mu: &str| {
        let settings = [("contour", start.as_str()), ("mu", mu)];
        let judged = &steps(&*set("chan-vese", &settings), &clip, "The largest connected part")[0];
        let phi = tile(judged, "level set φ");
        // The box of the circle and 16 px more: its first pixel is (18, 8).
        let places = (0..phi.height()).flat_map(|y| (0..phi.width()).map(move |x| (x, y)));
        let is_wrong =
            |(x, y): &(usize, usize)| (phi[(*x, *y)] >= 0.0) != (distance((18 + x, 8 + y), [46.0, 36.0]) < 14.0);
        places.filter(is_wrong).count()
    };
    let [none, usual] = ["0", "0.3"].map(wrong);
    assert!(4 * usual < none, "{none} pixels on the wrong side without a length, {usual} with one");
    // Of what noise leaves inside, the largest part alone is the object.
    let of =
        |mu| steps(&*set("chan-vese", &[("contour", &start), ("mu", mu)]), &clip, "in other parts are left out").len();
    assert_eq!([of("0"), of("0.3")], [1, 0]);
}

#[test]
fn the_energy_falls_to_the_end() {
    let picture = frame(60.0, 3, |at| if distance(at, [46.0, 36.0]) < 14.0 { 150.0 } else { 80.0 });
    let clip = clip(vec![picture; 2]);
    let start = circle([50.0, 39.0], 12.0);
    for step in ["1", "50", "1000"] {
        let settings = [("contour", start.as_str()), ("time-step", step), ("iterations", "300")];
        let judged = &steps(&*set("chan-vese", &settings), &clip, "The largest connected part")[0];
        let series = judged.readouts.iter().find_map(|readout| match readout {
            Readout::Series(series) if series.title == "Energy of the partition" => Some(series),
            _ => None,
        });
        let total = &series.expect("a plot").lines[0].2;
        let (first, last) = (total[0][1], total[total.len() - 1][1]);
        let least = total.iter().map(|point| point[1]).fold(f32::INFINITY, f32::min);
        assert!(last < 0.8 * first && last < 1.02 * least, "Δt = {step}: {first} to {last}, at least {least}");
    }
}

#[test]
fn lost_objects_and_windows_without_two_regions_are_said() {
    // The disc fades into its surroundings.
    let place = [46.0, 36.0];
    let fading = |t: usize| {
        frame(6.0, t as u64, move |at| 80.0 + if distance(at, place) < 14.0 { 70.0 - 7.0 * t as f64 } else { 0.0 })
    };
    let faded = clip((0..12).map(fading).collect());
    let start = circle(place, 15.0);
    let tracker = set("chan-vese", &[("contour", &start)]);
    let field =
        tracker.run(&faded, 0, &Threads::single()).expect("a run").get::<RegionField>().expect("a region").clone();
    assert!(!field.frames[7].is_lost && field.frames[11].is_lost, "{field:?}");
    assert_eq!(field.frames[11].region, field.frames[10].region, "it stays");
    let mut walk = tracker.walk(&faded, 0).expect("a walk");
    walk.jump(Move::End);
    assert!(
        walk.step(None).sentence.plain().contains("In the last frame it is lost"),
        "{}",
        walk.step(None).sentence.plain()
    );

    let flat = clip(vec![frame(0.0, 0, |_| 90.0); 2]);
    let mut walk = set("chan-vese", &[]).walk(&flat, 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("no two regions with different means"), "{said}");
    for (contour, said) in [
        ("10,10 40,40 40,10 10,40", "crosses itself: its edges 1 and 3 meet"),
        ("10,10 40,10 40,40 120,40", "lies outside the picture of 96×72 px"),
    ] {
        let refusal =
            set("chan-vese", &[("contour", contour)]).walk(&flat, 0).map(|_| ()).expect_err(contour).to_string();
        assert!(refusal.replace('\u{a0}', " ").contains(said), "{refusal}");
    }
}

#[test]
fn the_end_says_what_the_contour_took_in() {
    let scene = synth::scene("leaves").expect("a scene");
    let clip = scene.clip(&scene.difficulty()).expect("a clip");
    let end = |id: &str| {
        let mut walk = set(id, &[]).walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    // Counted from the true labels: 315 of 591 px are grass, and 276 of the 917 px of the ball are inside.
    let said = end("chan-vese");
    assert!(said.contains("left the object in frame 8: 53.3 % of its inside is not the object"), "{said}");
    assert!(said.contains("69.9 % of the object lies outside"), "{said}");
    assert!(!end("correlation-filter").contains("The contour left"), "it has none");
}
