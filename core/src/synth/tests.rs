//! What holds for every scene.

mod difficulties;
mod goldens;
mod truths;

use super::*;
use crate::data::Flow;
use crate::geometry::Grid;
use crate::params::Params;

/// The scene with all that only changes its looks off.
fn clean(scene: &Sample) -> Difficulty {
    Difficulty { noise: 0.0, flicker: 0.0, gain: 0.0, ..scene.difficulty() }
}

/// Small, so that a test may look at many frames.
fn small(scene: &Sample) -> Difficulty {
    Difficulty { width: 96, height: 72, ..clean(scene) }
}

fn flow(clip: &Clip, t: usize) -> Arc<Flow> {
    clip.truth().unwrap().flow(t).unwrap().unwrap()
}

fn hidden(clip: &Clip, t: usize) -> Arc<Grid<bool>> {
    clip.truth().unwrap().occlusion(t).unwrap().unwrap()
}

fn pixels(clip: &Clip) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (width, height) = clip.size();
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

#[test]
fn scenes_introduce_themselves() {
    for (i, scene) in SCENES.iter().enumerate() {
        assert!(scene.id.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", scene.id);
        assert!(!scene.title.is_empty() && scene.teaches.ends_with('.'), "{}", scene.id);
        assert!(SCENES[..i].iter().all(|other| other.id != scene.id && other.title != scene.title));
        let clip = make(scene.id, &scene.difficulty()).unwrap();
        let info = clip.info();
        assert_eq!((info.name.as_str(), info.width, info.height), (scene.title, 320, 240));
        assert_eq!((info.frames, info.fps), (Some(scene.difficulty().frames), Some(25.0)));
        assert_eq!(clip.frame(0).unwrap().size(), (320, 240));
        assert!(clip.frame(0).unwrap().color().is_some());
        let truth = clip.truth().unwrap();
        assert_eq!(truth.kinds().contains(&"objects"), truth.objects(0).unwrap().is_some());
        assert!(truth.kinds().starts_with(&["flow", "occlusion"]));
    }
    assert!(scene("nowhere").unwrap_err().to_string().contains("translation"));
}

#[test]
fn frames_do_not_depend_on_the_order_in_which_they_are_asked_for() {
    for scene in SCENES {
        let d = Difficulty { noise: 4.0, motion_blur: 50.0, frames: 6, ..small(scene) };
        let (forwards, backwards) = (scene.clip(&d).unwrap(), scene.clip(&d).unwrap());
        let mut last: Vec<_> = (0..6).rev().map(|t| backwards.frame(t).unwrap()).collect();
        last.reverse();
        for (t, frame) in last.iter().enumerate() {
            assert_eq!(forwards.frame(t).unwrap(), *frame, "{} frame {t}", scene.id);
        }
    }
}

#[test]
fn only_frames_at_hand_are_at_hand() {
    let clip = make("translation", &small(&SCENES[0])).unwrap();
    assert!(clip.cached(5).is_none());
    let frame = clip.frame(5).unwrap();
    assert!(Arc::ptr_eq(&frame, &clip.cached(5).unwrap()));
    assert!(clip.cached(4).is_none() && clip.frame(24).is_err());
}

#[test]
fn another_seed_paints_another_picture() {
    for scene in SCENES.iter().filter(|scene| !["wallpaper"].contains(&scene.id)) {
        let [one, two] = [1, 2].map(|seed| scene.clip(&Difficulty { seed, ..small(scene) }).unwrap().frame(0).unwrap());
        assert_ne!(one, two, "{}", scene.id);
    }
}
