//! Each slider does what it says, and refuses what it cannot.

use proptest::prelude::*;

use super::*;
use crate::data::Frame;
use crate::geometry::Gray;
use crate::params::{Kind, Spec, Value};

fn frame(d: &Difficulty, t: usize) -> Arc<Frame> {
    make("translation", d).unwrap().frame(t).unwrap()
}

/// One color, so that light and noise can be measured.
fn plain() -> Difficulty {
    Difficulty { low_texture: 100.0, ..Difficulty::default() }
}

fn mean(gray: &Gray) -> f64 {
    gray.cells().iter().map(|&g| f64::from(g)).sum::<f64>() / gray.cells().len() as f64
}

fn deviation(gray: &Gray) -> f64 {
    let mean = mean(gray);
    let squares = gray.cells().iter().map(|&g| (f64::from(g) - mean).powi(2)).sum::<f64>();
    (squares / gray.cells().len() as f64).sqrt()
}

#[test]
fn without_texture_a_surface_is_plain() {
    let (full, half) =
        (frame(&Difficulty::default(), 0), frame(&Difficulty { low_texture: 50.0, ..Difficulty::default() }, 0));
    let ratio = deviation(half.luma()) / deviation(full.luma());
    assert!((ratio - 0.5).abs() < 0.01, "{ratio}");
    assert_eq!(deviation(frame(&plain(), 0).luma()), 0.0);
}

#[test]
fn noise_has_its_mean_and_deviation() {
    let clear = mean(frame(&plain(), 3).luma());
    for sigma in [2.0, 10.0, 25.0] {
        let noisy = frame(&Difficulty { noise: sigma, ..plain() }, 3);
        assert!((mean(noisy.luma()) - clear).abs() < 0.3, "{sigma}");
        assert!((deviation(noisy.luma()) / f64::from(sigma) - 1.0).abs() < 0.03, "{sigma}");
        let other = frame(&Difficulty { noise: sigma, ..plain() }, 4);
        assert_ne!(noisy, other, "noise must not stand still");
    }
}

#[test]
fn salt_and_pepper_hit_their_share() {
    let picture = frame(&Difficulty { salt_and_pepper: 8.0, ..plain() }, 0);
    let share = |level| picture.luma().cells().iter().filter(|&&g| g == level).count() as f64 / (320.0 * 240.0);
    assert!((share(0) - 0.04).abs() < 0.004 && (share(255) - 0.04).abs() < 0.004);
}

#[test]
fn clutter_covers_its_share_of_the_background_alone() {
    let balloon = scene("balloon").unwrap();
    let clean = clean(balloon);
    let [clear, cluttered] = [0.0, 30.0].map(|clutter| balloon.clip(&Difficulty { clutter, ..clean.clone() }).unwrap());
    let objects = clear.truth().unwrap().foreground(3).unwrap().unwrap();
    let [before, after] = [&clear, &cluttered].map(|clip| clip.frame(3).unwrap());
    let (mut changed, mut all) = (0, 0);
    for place in (0..240).flat_map(|y| (0..320).map(move |x| (x, y))) {
        let change = before.luma()[place].abs_diff(after.luma()[place]);
        if objects.0[place] == crate::data::PixelClass::Background {
            all += 1;
            changed += usize::from(change > 20);
        }
    }
    let share = changed as f64 / f64::from(all);
    assert!((share - 0.3).abs() < 0.06, "{share}");
    let inside = cluttered.frame(3).unwrap().color().unwrap()[(72, 126)];
    assert_eq!(inside, clear.frame(3).unwrap().color().unwrap()[(72, 126)], "the object stays");
    // A scene without objects stays as it is.
    let wallpaper = scene("wallpaper").unwrap();
    let [plain, same] = [0.0, 60.0]
        .map(|clutter| wallpaper.clip(&Difficulty { clutter, ..small(wallpaper) }).unwrap().frame(2).unwrap());
    assert_eq!(plain, same);
}

#[test]
fn light_swells_and_fades() {
    let level = |d: &Difficulty, t| mean(frame(d, t).luma());
    let clear = level(&plain(), 0);
    let gain = Difficulty { gain: 5.0, ..plain() };
    assert!((level(&gain, 0) - clear).abs() < 1.0 && (level(&gain, 2) / clear - 1.1025).abs() < 0.01);
    assert!(level(&gain, 4) > level(&gain, 5) && level(&gain, 8) == level(&gain, 0));
    let offset = Difficulty { offset: -3.0, ..plain() };
    assert!((level(&offset, 4) - clear + 12.0).abs() < 0.6 && level(&offset, 8) == level(&offset, 0));
    let flicker = Difficulty { flicker: 20.0, ..plain() };
    let ratios: Vec<f64> = (0..24).map(|t| level(&flicker, t) / clear).collect();
    assert!(ratios.iter().all(|r| (0.79..1.21).contains(r)), "{ratios:?}");
    assert!(ratios.iter().any(|r| *r > 1.05) && ratios.iter().any(|r| *r < 0.95), "{ratios:?}");
}

#[test]
fn a_repeating_texture_repeats() {
    for period in [8, 24] {
        let d = Difficulty { repeating_texture: 100.0, period, ..Difficulty::default() };
        let picture = frame(&d, 0);
        assert!(deviation(picture.luma()) > 10.0);
        let step = period as usize;
        for (x, y) in (0..240 - step).flat_map(|y| (0..320 - step).map(move |x| (x, y))) {
            let here = picture.luma()[(x, y)];
            assert!(here.abs_diff(picture.luma()[(x + step, y)]) <= 1);
            assert!(here.abs_diff(picture.luma()[(x, y + step)]) <= 1);
        }
    }
}

#[test]
fn blur_smears_what_moves_and_only_that() {
    let ball = scene("fast-ball").unwrap();
    let [sharp, blurred] = [0.0, 100.0]
        .map(|motion_blur| ball.clip(&Difficulty { motion_blur, ..clean(ball) }).unwrap().frame(3).unwrap());
    let reach = |t| {
        let clip = ball.clip(&clean(ball)).unwrap();
        let b = clip.truth().unwrap().objects(t).unwrap().unwrap()[0];
        (b.x as usize, (b.x + b.width) as usize)
    };
    let (left, right) = (reach(3).0 - 14, reach(3).1 + 14);
    for (x, y) in (0..240).flat_map(|y| (0..320).map(move |x| (x, y))) {
        let moved = (left..=right).contains(&x);
        let change = sharp.luma()[(x, y)].abs_diff(blurred.luma()[(x, y)]);
        assert!(moved || change <= 1, "({x}, {y}) changed by {change}");
    }
    let changed = sharp.luma().cells().iter().zip(blurred.luma().cells()).filter(|(a, b)| a.abs_diff(**b) > 10).count();
    assert!(changed > 600, "{changed}");
}

#[test]
fn compression_makes_blocks() {
    let pebbles = |compression| {
        let d = Difficulty { compression, ..Difficulty::default() };
        make("sub-pixel", &d).unwrap().frame(0).unwrap()
    };
    let clear = pebbles(0);
    let error = |compression| {
        let pairs = clear.luma().cells().iter().zip(pebbles(compression).luma().cells().to_vec());
        pairs.map(|(&a, b)| f64::from(a.abs_diff(b))).sum::<f64>() / (320.0 * 240.0)
    };
    let errors = [10, 50, 80, 95].map(error);
    assert!(errors[0] > 0.1 && errors.is_sorted_by(|a, b| a < b), "{errors:?}");
}

#[test]
fn looks_never_change_the_truth() {
    for scene in SCENES {
        let quiet = scene.clip(&small(scene)).unwrap();
        let loud = Difficulty {
            low_texture: 40.0,
            repeating_texture: 30.0,
            clutter: 20.0,
            gain: 3.0,
            offset: -2.0,
            flicker: 10.0,
            motion_blur: 80.0,
            noise: 9.0,
            salt_and_pepper: 4.0,
            compression: 60,
            ..small(scene)
        };
        let loud = scene.clip(&loud).unwrap();
        assert_ne!(quiet.frame(2).unwrap(), loud.frame(2).unwrap());
        assert_eq!((flow(&quiet, 2), hidden(&quiet, 2)), (flow(&loud, 2), hidden(&loud, 2)), "{}", scene.id);
        let objects = |clip: &Clip| clip.truth().unwrap().objects(2).unwrap();
        assert_eq!(objects(&quiet), objects(&loud));
    }
}

#[test]
fn speed_scale_and_rotation_change_it_as_stated() {
    let at = |d: Difficulty, t| flow(&make("translation", &d).unwrap(), t);
    let base = Difficulty::default;
    assert!(at(Difficulty { speed: 2.5, ..base() }, 0).0.cells().iter().all(|&uv| uv == [7.5, -5.0]));
    let still = || Difficulty { speed: 0.0, ..base() };
    let grow = at(Difficulty { scale_change: 2.0, ..still() }, 5);
    let turn = at(Difficulty { rotation: 4.0, ..still() }, 5);
    let (sin, cos) = 4.0_f64.to_radians().sin_cos();
    for (x, y) in [(0, 0), (200, 40), (319, 239), (17, 180)] {
        let [cx, cy] = [x as f64 - 159.5, y as f64 - 119.5];
        let near = |uv: [f32; 2], expected: [f64; 2]| (0..2).all(|i| (f64::from(uv[i]) - expected[i]).abs() < 1e-4);
        assert!(near(grow.0[(x, y)], [0.02 * cx, 0.02 * cy]));
        assert!(near(turn.0[(x, y)], [cos * cx - sin * cy - cx, sin * cx + cos * cy - cy]));
    }
}

/// The smallest and largest value of a slider, and the next beyond each.
fn limits(spec: &Spec) -> Option<([Value; 2], [Value; 2])> {
    match spec.kind {
        Kind::Int { min, max } => Some(([min, max].map(Value::Int), [min - 1, max + 1].map(Value::Int))),
        Kind::Real { min, max } => Some(([min, max].map(Value::Real), [min - 0.01, max + 0.01].map(Value::Real))),
        _ => None,
    }
}

#[test]
fn every_slider_refuses_what_is_out_of_range() {
    let mut d = Difficulty::default();
    for (i, spec) in Difficulty::default().specs().iter().enumerate() {
        let (within, beyond) = limits(spec).expect("every difficulty is a number");
        for value in beyond {
            let refusal = d.set_value(i, value).unwrap_err().to_string();
            assert!(refusal.contains(&spec.name) && refusal.contains(&spec.allowed()), "{refusal}");
        }
        assert!(within.iter().all(|value| d.set_value(i, value.clone()).is_ok()), "{}", spec.name);
    }
    let base = Difficulty::default;
    for wrong in [
        Difficulty { width: 0, ..base() },
        Difficulty { height: 1_000_000, ..base() },
        Difficulty { frames: 1, ..base() },
        Difficulty { noise: f32::NAN, ..base() },
        Difficulty { speed: f32::INFINITY, ..base() },
        Difficulty { compression: 100, ..base() },
    ] {
        assert!(make("translation", &wrong).unwrap_err().to_string().contains(" must be "));
    }
}

#[test]
fn all_are_off_unless_a_scene_needs_one() {
    let changed = |scene: &Sample| {
        scene.difficulty() != Difficulty { frames: scene.difficulty().frames, ..Difficulty::default() }
    };
    let tuned: Vec<_> = SCENES.iter().filter(|scene| changed(scene)).map(|scene| scene.id).collect();
    assert_eq!(tuned, ["flat-wall", "flicker", "leaves", "blurred-swing"]);
}

/// Any slider anywhere in its range, in a picture small enough to try many.
fn any_difficulty() -> impl Strategy<Value = Difficulty> {
    let shares = proptest::collection::vec(0.0..=1.0f64, 18);
    shares.prop_map(|shares| {
        let mut d = Difficulty::default();
        for (i, (spec, share)) in Difficulty::default().specs().iter().zip(shares).enumerate() {
            let value = match (&spec.kind, spec.name.as_str()) {
                (_, "width" | "height") => Value::Int(32 + (share * 40.0) as i64),
                (Kind::Int { min, max }, _) => Value::Int(min + (share * (max - min) as f64) as i64),
                (Kind::Real { min, max }, _) => Value::Real((min + share * (max - min)).clamp(*min, *max)),
                _ => continue,
            };
            d.set_value(i, value).unwrap();
        }
        d
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_sliders_make_a_clip_of_finite_truth(d in any_difficulty(), which in 0..SCENES.len(), share in 0.0..1.0f64) {
        let clip = SCENES[which].clip(&d).unwrap();
        let t = (share * (d.frames - 1) as f64) as usize;
        prop_assert_eq!(clip.frame(t).unwrap().size(), (d.width, d.height));
        prop_assert!(flow(&clip, t).0.cells().as_flattened().iter().all(|c| c.is_finite()));
        prop_assert_eq!(hidden(&clip, t).size(), (d.width, d.height));
        for o in clip.truth().unwrap().objects(t).unwrap().unwrap_or_default() {
            prop_assert!([o.x, o.y, o.width, o.height].iter().all(|c| c.is_finite()));
            prop_assert!(o.width > 0.0 && o.height > 0.0 && (0.0..=1.0).contains(&o.visibility));
        }
    }
}
