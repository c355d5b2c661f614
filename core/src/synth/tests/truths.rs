//! The truth is what happens to the pixels.

use super::super::layer::{self, Layer};
use super::super::motion::Motion;
use super::super::shape::Shape;
use super::super::stage::{Moment, Stage};
use super::super::texture::rgb;
use super::super::truth::ExactTruth;
use super::*;
use crate::data::Truth;

/// Brings frame t + 1 back by the truth and compares it with frame t: mean error, and share of pixels off by more than
/// 32 gray levels.
fn warp_error(clip: &Clip, t: usize) -> (f32, f32) {
    let [now, next] = clip.pair(t).unwrap();
    let (flow, hidden) = (flow(clip, t), hidden(clip, t));
    let (width, height) = clip.size();
    let (mut sum, mut far, mut count) = (0.0, 0.0, 0.0);
    for (x, y) in pixels(clip).filter(|&at| !hidden[at]) {
        let [u, v] = flow.at(x, y).unwrap();
        let to = [x as f32 + u, y as f32 + v];
        if to[0] < 0.0 || to[1] < 0.0 || to[0] > (width - 1) as f32 || to[1] > (height - 1) as f32 {
            continue;
        }
        let error = (next.luma().sample(to[0], to[1]) - f32::from(now.luma()[(x, y)])).abs();
        sum += error;
        far += f32::from(error > 32.0);
        count += 1.0;
    }
    assert!(count > 0.4 * (width * height) as f32);
    (sum / count, far / count)
}

#[test]
fn the_next_frame_warped_back_is_this_frame() {
    for scene in SCENES {
        let clip = scene.clip(&clean(scene)).unwrap();
        for t in [0, 7] {
            let (mean, far) = warp_error(&clip, t);
            assert!(mean < 3.5 && far < 0.006, "{} frame {t}: {mean} levels, {far} far off", scene.id);
        }
    }
}

#[test]
fn it_is_so_too_when_everything_moves_more() {
    for scene in SCENES {
        let d = Difficulty { speed: 1.7, scale_change: 2.0, rotation: -3.0, width: 240, height: 200, ..clean(scene) };
        let clip = scene.clip(&d).unwrap();
        let (mean, far) = warp_error(&clip, 5);
        assert!(mean < 4.0 && far < 0.01, "{}: {mean} levels, {far} far off", scene.id);
    }
}

#[test]
fn a_wrong_truth_would_be_noticed() {
    for scene in SCENES.iter().filter(|scene| scene.id != "flat-wall") {
        let clip = scene.clip(&clean(scene)).unwrap();
        let faster = scene.clip(&Difficulty { speed: 1.5, ..clean(scene) }).unwrap();
        let mixed = clip.clone().with_truth(Arc::clone(faster.truth().unwrap()));
        let (right, wrong) = (warp_error(&clip, 0).0, warp_error(&mixed, 0).0);
        assert!(wrong > 1.25 * right, "{}: {right} {wrong}", scene.id);
    }
}

#[test]
fn colors_travel_with_the_motion() {
    for scene in SCENES {
        let d = clean(scene);
        let stage = scene.stage(&d);
        let (now, next) = (stage.at(3.0), stage.at(4.0));
        let clip = scene.clip(&d).unwrap();
        let hidden = hidden(&clip, 3);
        // Away from outlines, where one layer's edge mixes with what is behind it.
        let deep = |p: [f64; 2], moment: &Moment, layer| {
            let mut around = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| [f64::from(dx), f64::from(dy)]));
            around.all(|[dx, dy]| moment.foremost([p[0] + dx, p[1] + dy]) == Some(layer))
        };
        // A pixel of a scene that grows or turns sees a little less of everything fine.
        let slack = match scene.id {
            "spin-zoom" | "leaves" | "still-life" | "stereo-traps" | "turning-box" => 4.0,
            // What comes nearer by a tenth shows a good deal more of it.
            "drive" => 24.0,
            _ => 0.01,
        };
        let (mut checked, mut off) = (0.0, 0.0);
        for (x, y) in pixels(&clip).step_by(7).filter(|&at| !hidden[at]) {
            let p = [x as f64, y as f64];
            let layer = now.foremost(p).unwrap();
            let (to, _) = now.follow(layer, p, &next).unwrap();
            if deep(p, &now, layer) && deep(to, &next, layer) {
                let (a, b) = (now.color(p), next.color(to));
                checked += 1.0;
                off += f64::from(u8::from((0..3).any(|c| (a[c] - b[c]).abs() > slack)));
            }
        }
        // Between two boughs of a fir, an outline may be nearer than the pixels tell.
        assert!(checked > 3000.0 && off < 0.001 * checked, "{}: {off} of {checked}", scene.id);
    }
}

#[test]
fn whole_pixels_are_moved_bit_for_bit() {
    for (width, height) in [(320, 240), (640, 480)] {
        let clip = make("translation", &Difficulty { width, height, ..Difficulty::default() }).unwrap();
        for t in [0, 11] {
            let [now, next] = clip.pair(t).unwrap();
            let (now, next) = (now.color().unwrap(), next.color().unwrap());
            for y in 2..height {
                assert_eq!(now.row(y)[..width - 3], next.row(y - 2)[3..], "row {y}");
            }
            assert!(flow(&clip, t).0.cells().iter().all(|&uv| uv == [3.0, -2.0]));
        }
    }
}

#[test]
fn the_truth_ends_one_frame_early() {
    let clip = make("pillar", &small(&SCENES[0])).unwrap();
    let truth = clip.truth().unwrap();
    assert!(truth.flow(22).unwrap().is_some() && truth.flow(23).unwrap().is_none());
    assert!(truth.occlusion(23).unwrap().is_none() && truth.occlusion(usize::MAX).unwrap().is_none());
    assert!(truth.objects(23).unwrap().is_some() && truth.objects(24).unwrap().is_none());
}

/// A disc of radius 20 that moves by (6, 0) from (40, 60), behind a pillar at x = 70 to 90; the picture is 320×240.
fn disc_behind_a_pillar() -> (Arc<Stage>, Difficulty) {
    let gray = rgb(0x808080);
    let still = Motion::still([80.0, 120.0]);
    let disc = Motion { velocity: [6.0, 0.0], ..Motion::still([40.0, 60.0]) };
    let layers = vec![
        Layer::new(Shape::Rectangle { half: [10.0, 500.0], corner: 0.0 }, still, gray, move |_| gray),
        Layer::new(Shape::disc(20.0), disc, gray, move |_| gray).object(7),
        Layer::new(Shape::Everywhere, Motion::still([0.0; 2]), gray, move |_| gray),
    ];
    (Arc::new(Stage::Flat(layer::Stage::new(layers, Difficulty::default()))), Difficulty::default())
}

#[test]
fn occlusion_is_what_the_geometry_says() {
    let (stage, d) = disc_behind_a_pillar();
    let truth = ExactTruth::new(stage, d);
    for t in 0..12 {
        let (hidden, flow) = (truth.occlusion(t).unwrap().unwrap(), truth.flow(t).unwrap().unwrap());
        let in_disc = |x: i32, y: i32, t: usize| (x - 40 - 6 * t as i32).pow(2) + (y - 60).pow(2) <= 400;
        let in_pillar = |x: i32| (70..=90).contains(&x);
        for (x, y) in (0..240).flat_map(|y| (0..320).map(move |x| (x, y))) {
            let at = (x as usize, y as usize);
            let (expected, motion) = match (in_pillar(x), in_disc(x, y, t)) {
                (true, _) => (false, [0.0, 0.0]),
                (false, true) => (in_pillar(x + 6) || x + 6 >= 320, [6.0, 0.0]),
                (false, false) => (in_disc(x, y, t + 1), [0.0, 0.0]),
            };
            // On the rim itself, the last bit of a root decides.
            let rim = |t: usize| (x - 40 - 6 * t as i32).pow(2) + (y - 60).pow(2) == 400;
            if !rim(t) && !rim(t + 1) {
                assert_eq!((hidden[at], flow.0[at]), (expected, motion), "({x}, {y}) in frame {t}");
            }
        }
    }
}

#[test]
fn tracks_tell_extent_and_what_can_be_seen() {
    let (stage, d) = disc_behind_a_pillar();
    let truth = ExactTruth::new(stage, d);
    let first = truth.objects(0).unwrap().unwrap()[0];
    assert_eq!((first.id, first.visibility), (7, 1.0));
    assert!((first.x - 20.0).abs() < 1e-4 && (first.y - 40.0).abs() < 1e-4);
    assert!((first.width - 40.0).abs() < 1e-4 && (first.height - 40.0).abs() < 1e-4);
    // Centred behind the pillar at x = 82: the outer parts show.
    let middle = truth.objects(7).unwrap().unwrap()[0];
    let (mut all, mut seen) = (0.0, 0.0);
    for (x, y) in (30..=90).flat_map(|y| (50..=110).map(move |x| (x, y))) {
        if (x - 82_i32).pow(2) + (y - 60_i32).pow(2) <= 400 {
            all += 1.0;
            seen += f32::from(!(70..=90).contains(&x));
        }
    }
    assert!((middle.visibility - seen / all).abs() < 0.01, "{} {}", middle.visibility, seen / all);
}

#[test]
fn boxes_fit_the_masks() {
    for scene in SCENES {
        let d = clean(scene);
        let stage = scene.stage(&d);
        let moment = stage.at(2.0);
        let seen = moment.sightings();
        assert!(seen.is_sorted_by_key(|s| s.id));
        for sighting in seen.iter().filter(|s| s.visible == 1.0) {
            let [left, top, right, bottom] = sighting.bounds;
            let centre = [(left + right) / 2.0, (top + bottom) / 2.0];
            let layer = moment.foremost(centre);
            // An object in space has a surface for each of its faces; others are farther away from it.
            let is_near =
                |[x, y]: [f64; 2]| (left - 9.0..right + 9.0).contains(&x) && (top - 9.0..bottom + 9.0).contains(&y);
            let is_of_object = |p: [f64; 2]| {
                let found = moment.foremost(p);
                let is_face = matches!(moment, Moment::Deep(_)) && is_near(p);
                found == layer || is_face && found.is_some_and(|found| moment.is_object(found))
            };
            let mask: Vec<_> = (0..d.height)
                .flat_map(|y| (0..d.width).map(move |x| [x as f64, y as f64]))
                .filter(|&p| is_of_object(p))
                .collect();
            let extreme =
                |i: usize| mask.iter().map(|p| p[i]).fold((f64::MAX, f64::MIN), |(a, b), c| (a.min(c), b.max(c)));
            let [(x0, x1), (y0, y1)] = [extreme(0), extreme(1)];
            // A tip may lie between two rows of pixels; nothing lies outside the box, except for a pixel on the edge of a disc, whose box is that
            // of a polygon.
            let is_in_box = [left - x0, x1 - right, top - y0, y1 - bottom].iter().all(|beyond| *beyond < 0.01);
            assert!(is_in_box, "{} {}", scene.id, sighting.id);
            let slack = [x0 - left, right - x1, y0 - top, bottom - y1];
            assert!(slack.iter().all(|s| *s < 3.0), "{} {}: {slack:?}", scene.id, sighting.id);
        }
    }
}

#[test]
fn the_ball_disappears_and_comes_back() {
    let clip = scene("pillar").unwrap().clip(&scene("pillar").unwrap().difficulty()).unwrap();
    let seen: Vec<f32> = (0..24).map(|t| clip.truth().unwrap().objects(t).unwrap().unwrap()[0].visibility).collect();
    let least = (0..24).min_by(|&a, &b| seen[a].total_cmp(&seen[b])).unwrap();
    assert!((8..20).contains(&least) && seen[least] < 0.35, "{seen:?}");
    assert!(seen[0] > 0.7 && seen[23] > 0.7, "{seen:?}");
}

#[test]
fn every_track_keeps_its_number() {
    let clip = scene("traffic").unwrap().clip(&scene("traffic").unwrap().difficulty()).unwrap();
    let ids = |t| clip.truth().unwrap().objects(t).unwrap().unwrap().iter().map(|o| o.id).collect::<Vec<_>>();
    assert_eq!(ids(0), [1, 2, 3, 4, 5]);
    assert!((0..24).all(|t| ids(t).len() >= 3 && ids(t).iter().all(|id| (1..=5).contains(id))));
}

/// The objects of a clip in frame `t`: number, and left, top, right and bottom edge.
fn boxes(clip: &Clip, t: usize) -> Vec<(u32, [f32; 4])> {
    let objects = clip.truth().unwrap().objects(t).unwrap().unwrap_or_default();
    objects.iter().map(|o| (o.id, [o.x, o.y, o.x + o.width, o.y + o.height])).collect()
}

/// How far apart two boxes' middles are in x or y.
fn shift(a: [f32; 4], b: [f32; 4]) -> f32 {
    (0..2).map(|i| ((a[i] + a[i + 2] - b[i] - b[i + 2]) / 2.0).abs()).fold(0.0, f32::max)
}

/// The farthest that an object's box gets in one of the first frames.
fn usual_shift(clip: &Clip) -> f32 {
    let moves = (0..8).flat_map(|t| {
        let next = boxes(clip, t + 1);
        boxes(clip, t).into_iter().filter_map(move |(id, a)| Some(shift(a, next.iter().find(|b| b.0 == id)?.1)))
    });
    moves.fold(0.0, f32::max)
}

/// How many objects of frame `from` are not in frame `to`; each must be within `step` of having left over an edge.
fn leaving(clip: &Clip, from: usize, to: usize, step: f32) -> usize {
    let (width, height) = clip.size();
    let there = boxes(clip, to);
    let gone: Vec<_> = boxes(clip, from).into_iter().filter(|(id, _)| there.iter().all(|b| b.0 != *id)).collect();
    for (id, [left, top, right, bottom]) in &gone {
        let inside = [*right, *bottom, width as f32 - left, height as f32 - top];
        assert!(inside.iter().any(|i| *i <= step), "{} frames {from}, {to}: {id}", clip.info().name);
    }
    gone.len()
}

#[test]
fn objects_leave_and_enter_over_the_edge() {
    for scene in SCENES {
        let usual = usual_shift(&scene.clip(&clean(scene)).unwrap());
        for (speed, scale_change, width, height) in
            [(1.0, 0.0, 320, 240), (4.0, 0.0, 320, 240), (4.0, 0.0, 640, 120), (4.0, -5.0, 320, 240)]
        {
            let d = Difficulty { speed, scale_change, width, height, frames: 250, ..clean(scene) };
            let clip = scene.clip(&d).unwrap();
            // What zooms also moves towards the middle.
            let step = 1.25 * usual * speed + 2.0 - 3.0 * scale_change;
            let (mut left, mut entered) = (0, 0);
            for t in 0..249 {
                left += leaving(&clip, t, t + 1, step);
                entered += leaving(&clip, t + 1, t, step);
                let next = boxes(&clip, t + 1);
                for (id, now) in boxes(&clip, t) {
                    let moved = next.iter().find(|b| b.0 == id).map_or(0.0, |b| shift(now, b.1));
                    assert!(moved <= step, "{} {d:?} frame {t}: {id} jumps by {moved}", scene.id);
                }
            }
            if ["pillar", "fast-ball", "crossing-stars", "traffic"].contains(&scene.id) {
                assert!(left > 0 && entered > 0, "{} {d:?}: {left} leave, {entered} enter", scene.id);
            }
        }
    }
}

#[test]
fn no_pixel_moves_half_a_picture() {
    for scene in SCENES.iter().filter(|scene| scene.id != "spin-zoom") {
        let clip = scene.clip(&Difficulty { speed: 4.0, frames: 60, ..small(scene) }).unwrap();
        for t in 0..59 {
            let most = flow(&clip, t).0.cells().iter().flatten().fold(0.0, |most: f32, c| most.max(c.abs()));
            assert!(most < 48.0, "{} frame {t}: {most}", scene.id);
        }
    }
}
