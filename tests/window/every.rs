//! Every registered estimator in the window: opened, stepped both ways, run to the end and exported.
//!
//! `UPDATE_GOLDEN=1 cargo test --workspace --test window every` makes the pictures in `tests/golden/estimators` anew.

use std::path::PathBuf;

use motionscope_core::course::estimators;

use super::*;
use files::write_to;
use landscape::leans;
use motionscope::paint::charts::relief::standing;
use objects::window;

/// The estimators are shared out among so many tests, which run beside each other.
const PARTS: usize = 4;
/// The steps in sight when a picture is compared: in the middle of the second unit, and the end of the run.
const NAMES: [&str; 2] = ["", "-end"];
/// Floating-point units differ in the last bit, so a channel may differ by this much.
const TOLERANCE: u8 = 2;

fn golden(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "tests", "golden", "estimators", name].iter().collect()
}

/// Compares the picture that the window writes with the golden one.
fn check_picture(window: &mut Window, name: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    window.command(Command::ExportPicture);
    window.click_role(Role::Button, "Theme: dark");
    window.click_role(Role::Button, "1×");
    write_to(window, &path);
    let found = image::open(&path).unwrap_or_else(|e| panic!("{name}: {e}, {:?}", window.app().message())).to_rgb8();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::copy(&path, golden(name)).expect("the golden pictures can be written");
    }
    let expected = image::open(golden(name)).unwrap_or_else(|e| panic!("{name}: {e}; make it with UPDATE_GOLDEN=1"));
    let expected = expected.to_rgb8();
    assert_eq!(found.dimensions(), expected.dimensions(), "{name}");
    let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > TOLERANCE;
    let worse = found.iter().zip(expected.iter()).filter(|pair| differs(*pair)).count();
    assert_eq!(worse, 0, "{name}: so many channels differ by more than {TOLERANCE}");
}

/// Opens the estimator, steps into, over and back, goes to the end, and compares two pictures on the way.
fn walk_through(id: &str) {
    let mut window = window(id, "0.0");
    assert_eq!(window.shown().info.id, id);
    assert!(!window.shown().step.sentence.plain().is_empty(), "{id} says nothing at its start");
    let start = window.sentence();
    let mut told = vec![start.clone()];
    for key in [Key::ArrowRight, Key::ArrowRight, Key::PageDown] {
        window.key(key);
        assert!(window.app().view().refused.is_none(), "{id}: {:?}", window.app().view().refused);
        assert!(window.shown().failure.is_none(), "{id}: {:?}", window.shown().failure);
        told.push(window.sentence());
    }
    assert!(window.cursor() > Cursor::default(), "{id} does not move");
    // The same steps back show the same.
    window.key(Key::PageUp);
    window.key(Key::Home);
    assert_eq!(window.sentence(), start, "{id}: the start is another one after going back to it");
    for there in &told[1..3] {
        window.key(Key::ArrowRight);
        assert_eq!(window.sentence(), *there, "{id}");
    }
    window.key(Key::ArrowLeft);
    assert_eq!(window.sentence(), told[1], "{id}: one step back");

    window.key(Key::PageDown);
    window.press(Modifiers::SHIFT, Key::ArrowRight);
    let (granularities, events) = (window.shown().info.granularities, window.shown().events);
    let granularity = granularities.last().expect("a granularity");
    let middle = (events / 2).max(1);
    window.harness.get_by_label(&format!("Timeline, {granularity}s")).set_value_accesskit(middle as f64);
    window.settle();
    assert_eq!(window.cursor().event, middle, "{id}");
    check_picture(&mut window, &format!("{id}{}.png", NAMES[0]));
    lean(&mut window, id);
    window.key(Key::End);
    assert!(window.shown().at_end && window.shown().failure.is_none(), "{id}: {:?}", window.shown().failure);
    check_picture(&mut window, &format!("{id}{}.png", NAMES[1]));
    let before = window.sentence();
    window.key(Key::ArrowLeft);
    assert!(!window.shown().at_end, "{id}: a step back from the end");
    window.key(Key::End);
    assert_eq!(window.sentence(), before, "{id}: the end is another one");
}

/// Leans the picture back and folds it flat again, where something rises from it.
fn lean(window: &mut Window, id: &str) {
    let rises = standing(&window.shown().step).is_some();
    assert!(!leans(window), "{id}");
    window.key(Key::P);
    assert_eq!(leans(window), rises, "{id}: what rises stands on a picture in sight");
    window.key(Key::P);
    assert!(!leans(window), "{id}");
}

fn walk_part(part: usize) {
    let all = estimators();
    let mut walked = 0;
    for estimator in all.iter().skip(part).step_by(PARTS) {
        walk_through(estimator.info().id);
        walked += 1;
    }
    assert!(walked >= all.len() / PARTS, "{walked} of {} estimators", all.len());
}

#[test]
fn a_first_part_of_all_estimators_is_walked_through() {
    walk_part(0);
}

#[test]
fn a_second_part_of_all_estimators_is_walked_through() {
    walk_part(1);
}

#[test]
fn a_third_part_of_all_estimators_is_walked_through() {
    walk_part(2);
}

#[test]
fn the_last_part_of_all_estimators_is_walked_through() {
    walk_part(3);
}

#[test]
fn no_golden_picture_is_of_an_estimator_that_is_gone() {
    let mut wanted: Vec<_> =
        estimators().iter().flat_map(|e| NAMES.map(|name| format!("{}{name}.png", e.info().id))).collect();
    let files = fs::read_dir(golden("")).expect("the folder of golden pictures");
    let mut found: Vec<_> =
        files.map(|file| file.expect("a file").file_name().into_string().expect("a name")).collect();
    wanted.sort();
    found.sort();
    assert_eq!(found, wanted);
}
