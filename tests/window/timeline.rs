//! Playing, and the timeline, in the window.

use super::*;

#[test]
fn it_plays_and_pauses() {
    let mut window = Window::usual();
    let before = window.cursor();
    window.harness.key_press(Key::Space);
    let begun = Instant::now();
    while window.cursor() < (Cursor { event: before.event + 5, ..before }) {
        window.harness.step();
        assert!(begun.elapsed() < Duration::from_secs(20), "it does not play");
    }
    window.click("Pause");
    let paused = window.cursor();
    window.harness.run_steps(30);
    assert_eq!(window.cursor(), paused);
}

#[test]
fn it_plays_backwards_to_the_start() {
    let mut window = Window::usual();
    let before = window.cursor();
    window.harness.key_press_modifiers(Modifiers::SHIFT, Key::Space);
    let begun = Instant::now();
    while window.cursor().event + 5 > before.event {
        window.harness.step();
        assert!(begun.elapsed() < Duration::from_secs(20), "it does not play");
    }
    assert_eq!(window.cursor().unit, before.unit);
    window.click("Pause");
    let paused = window.cursor();
    window.harness.run_steps(30);
    assert_eq!(window.cursor(), paused);
    window.harness.state_mut().walk_from(Place::at(Cursor { unit: 0, event: 2 }));
    window.settle();
    window.harness.get_by_label("Play backwards").click();
    while window.cursor() != Cursor::default() {
        window.harness.step();
        assert!(begun.elapsed() < Duration::from_secs(40), "it does not come to the start");
    }
    window.settle();
    assert!(window.harness.query_by_label("Pause").is_none(), "it stops there");
}

#[test]
fn marked_steps_are_jumped_to_and_empty_rows_pass_in_one_step() {
    let clip = "synth:traffic,width=160,height=120,frames=8";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let lines = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"connected-components\"\nstep = \"1.1\"\n");
    fs::write(&path, lines).expect("it is written");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) });
    let marked = |window: &Window| {
        let shown = window.shown();
        shown.landmarks.iter().any(|(event, _)| *event == shown.cursor.event)
    };
    window.key(Key::ArrowRight);
    let first = window.cursor();
    assert!(first.unit > 1, "the first rows are empty: {first}");
    assert!(window.shown().step.sentence.plain().contains("foreground pixel"));
    window.key(Key::J);
    let one = window.cursor();
    assert!(marked(&window) && one > first, "{one}");
    window.key(Key::J);
    let two = window.cursor();
    assert!(marked(&window) && two > one, "{two}");
    window.press(Modifiers::SHIFT, Key::J);
    assert_eq!(window.cursor(), one);
}

#[test]
fn marks_of_one_kind_are_jumped_to() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let clip = "synth:spin-zoom,width=96,height=72,frames=2";
    let lines = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"sift\"\nstep = \"0.0\"\n");
    fs::write(&path, lines).expect("it is written");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) });
    let said = |window: &Window| window.shown().step.sentence.plain();
    // From octave to octave.
    for octave in 1..=3 {
        window.press(Modifiers::COMMAND, Key::J);
        assert!(said(&window).starts_with(&format!("Octave {octave}")), "{}", said(&window));
    }
    // From one rejected extremum to the next and back: those are tested in the third stage.
    window.key(Key::U);
    window.key(Key::U);
    let is_rejected = |window: &Window| said(window).to_lowercase().contains("rejected");
    for _ in 0..100 {
        window.key(Key::J);
        if is_rejected(&window) {
            break;
        }
    }
    let first = window.cursor();
    window.press(Modifiers::COMMAND, Key::J);
    assert!(window.cursor() > first && is_rejected(&window), "{}", said(&window));
    window.press(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::J);
    assert_eq!(window.cursor(), first);
}

#[test]
fn the_timeline_is_scrubbed() {
    let mut window = Window::usual();
    let unit = window.cursor().unit;
    let rail = window.harness.get_by_label("Timeline, blocks").rect();
    let at = |rail: Rect, share: f32| Pos2::new(rail.left() + share * rail.width(), rail.center().y);
    window.drag(at(rail, 0.1), at(rail, 0.9));
    let there = window.cursor();
    assert!(there.unit > unit && there.event == window.shown().events, "{there}");
    let event = window.shown().info.granularities[2];
    let rail = window.harness.get_by_label(&format!("Timeline, {event}s")).rect();
    window.drag(at(rail, 0.9), at(rail, 0.5));
    let half = window.shown().events / 2;
    assert_eq!(window.cursor().unit, there.unit);
    assert!(window.cursor().event.abs_diff(half) <= half / 20 + 2, "{}", window.cursor());
}

/// The number that the tip under the pointer gives to a `granularity`.
fn tip(window: &Window, granularity: &str) -> Option<usize> {
    let words = window.harness.query_all_by_label_contains(granularity);
    let texts = words.filter_map(|node| node.accesskit_node().value().or(node.accesskit_node().label()));
    let numbers = texts.filter_map(|text| text.strip_prefix(granularity)?.trim().replace('\u{202f}', "").parse().ok());
    numbers.collect::<Vec<_>>().pop()
}

#[test]
fn a_place_on_the_timeline_is_called_what_a_click_goes_to() {
    let mut window = Window::usual();
    window.key(Key::Home);
    window.key(Key::ArrowRight);
    for name in ["block", window.shown().info.granularities[2]] {
        let rail = window.harness.get_by_label(&format!("Timeline, {name}s")).rect();
        for share in [0.213, 0.487, 0.756] {
            let place = Pos2::new(rail.left() + share * rail.width(), rail.center().y);
            window.harness.hover_at(place);
            window.harness.run_steps(60);
            let told = tip(&window, name).expect("a tip says what lies there");
            window.click_at(place);
            let Cursor { unit, event } = window.cursor();
            assert_eq!(if name == "block" { unit + 1 } else { event }, told, "{name} at {share}");
        }
    }
}

#[test]
fn holding_the_timeline_still_asks_once() {
    let mut window = Window::usual();
    let rail = window.harness.get_by_label("Timeline, blocks").rect();
    let place = Pos2::new(rail.left() + 0.4 * rail.width(), rail.center().y);
    window.harness.drag_at(place);
    window.harness.run_steps(2);
    window.settle();
    assert_eq!(window.cursor().event, window.shown().events);
    let first = std::sync::Arc::clone(window.app().view().shown.as_ref().expect("a run is shown"));
    for _ in 0..5 {
        window.harness.run_steps(2);
        window.harness.state_mut().wait();
    }
    let now = window.app().view().shown.as_ref().expect("a run is shown");
    assert!(std::sync::Arc::ptr_eq(&first, now), "the same place was gone to again");
    window.harness.drop_at(place);
    window.settle();
}

#[test]
fn the_timeline_is_moved_by_keys_and_screen_readers() {
    let mut window = Window::usual();
    let (before, event) = (window.cursor(), window.shown().info.granularities[2]);
    let track = format!("Timeline, {event}s");
    window.harness.get_by_label(&track).focus();
    window.settle();
    window.key(Key::ArrowUp);
    assert_eq!(window.cursor(), Cursor { event: before.event + 1, ..before });
    window.key(Key::ArrowDown);
    assert_eq!(window.cursor(), before);
    window.key(Key::ArrowRight);
    assert_eq!(window.cursor(), Cursor { event: before.event + 1, ..before }, "the ladder keeps its keys");
    window.harness.get_by_label(&track).set_value_accesskit(12.0);
    window.settle();
    assert_eq!(window.cursor(), Cursor { event: 12, ..before });
    window.harness.get_by_label("Timeline, blocks").set_value_accesskit(3.0);
    window.settle();
    assert_eq!((window.cursor().unit, window.cursor().event), (2, window.shown().events));
}
