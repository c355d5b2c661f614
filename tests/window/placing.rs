//! Parameters that are placed on the picture with the mouse.

use eframe::egui::PointerButton;
use motionscope_core::params::Placed;

use super::objects::window;
use super::*;

/// Where an image point lies on the screen.
fn on_stage(window: &Window, [x, y]: [f32; 2]) -> Pos2 {
    let pair = &window.shown().pictures.pair[0];
    let (width, height) = pair.size();
    let rect = window.harness.get_by_label_contains("Stage: Frame t").rect();
    let scale = (rect.size() / vec2(width as f32, height as f32)).min_elem();
    let middle = vec2((width as f32 - 1.0) / 2.0, (height as f32 - 1.0) / 2.0);
    rect.center() + (vec2(x, y) - middle) * scale
}

fn placed(window: &Window, name: &str) -> Placed {
    match window.value(name) {
        Value::Placed(placed) => placed,
        other => panic!("{other:?} is not placed"),
    }
}

#[test]
fn clicks_measure_an_object_frame_by_frame() {
    let mut window = window("kalman-filter", "0.0");
    window.click("Place clicks");
    let places = [[40.0, 60.0], [44.0, 61.0], [48.0, 62.0]];
    for (frame, at) in places.into_iter().enumerate() {
        assert_eq!(window.shown().frame, frame, "a click leads to the next frame");
        let at = on_stage(&window, at);
        window.click_at(at);
    }
    let Placed::Spots(spots) = placed(&window, "clicks") else { panic!("clicks are spots") };
    assert_eq!(spots.all().len(), 3);
    for (spot, (frame, at)) in spots.all().iter().zip(places.into_iter().enumerate()) {
        let off = (spot.at[0] - at[0]).hypot(spot.at[1] - at[1]);
        assert!(spot.frame == frame && off < 0.5, "{spot:?} where {at:?} was clicked");
    }
    window.command(Command::PreviousUnit);
    assert!(window.sentence().contains("Measured"), "what was clicked is measured");
    window.command(Command::Undo);
    assert_eq!(placed(&window, "clicks").words(), "2 points", "each click is taken back by itself");
    window.key(Key::Escape);
    assert!(window.harness.query_by_label_contains("Done placing").is_none(), "Esc ends it");
}

#[test]
fn a_tracker_asks_for_the_object_of_a_clip_of_ones_own() {
    let folder = tempfile::tempdir().expect("a folder");
    for t in 0..3u32 {
        let picture = image::GrayImage::from_fn(64, 48, |x, y| image::Luma([((x + t) * 7 % 60 + y * 3) as u8]));
        picture.save(folder.path().join(format!("wave_{t}.png"))).expect("a picture");
    }
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(folder.path().into()) });
    for (name, parameter) in [("Mean shift", "region"), ("Template matching", "template")] {
        let now = window.app().document().estimator().info().name;
        window.click(&format!("Estimator: {now}"));
        window.click(name);
        let message = window.app().message().unwrap_or_default().to_owned();
        assert!(message.starts_with(&format!("No {parameter}")), "{name}: {message}");
        assert!(placed(&window, parameter).is_none());
        let picture = window.harness.query_all_by_label_contains("Stage: Frame t").next().expect("a picture").rect();
        window.drag(picture.lerp_inside(vec2(0.4, 0.4)), picture.lerp_inside(vec2(0.6, 0.6)));
        let Placed::Zone(Some(zone)) = placed(&window, parameter) else { panic!("{name}: nothing was dragged") };
        assert!(zone.size().iter().all(|side| *side > 4.0), "{name}: {zone:?}");
        window.key(Key::Escape);
    }
}

#[test]
fn a_spot_is_dragged_and_taken_away() {
    let mut window = window("kalman-filter", "0.0");
    window.click("Place clicks");
    let (from, to) = ([40.0, 60.0], [70.0, 50.0]);
    let at = on_stage(&window, from);
    window.click_at(at);
    window.key(Key::PageUp);
    assert_eq!(window.shown().frame, 0);
    let (from, to) = (on_stage(&window, from), on_stage(&window, to));
    window.drag(from, to);
    let Placed::Spots(spots) = placed(&window, "clicks") else { panic!("clicks are spots") };
    assert!((spots.all()[0].at[0] - 70.0).abs() < 0.5 && spots.all().len() == 1, "{spots:?}");
    window.harness.hover_at(to);
    for pressed in [true, false] {
        let modifiers = Modifiers::NONE;
        window.harness.event(Event::PointerButton { pos: to, button: PointerButton::Secondary, pressed, modifiers });
        window.harness.step();
    }
    window.settle();
    assert!(placed(&window, "clicks").is_none(), "a right click takes it away");
}

#[test]
fn a_line_is_drawn_moved_and_taken_back() {
    let mut window = window("trajectory-analysis", "6.0");
    window.click("Place lines");
    let (from, to) = (on_stage(&window, [80.0, 100.0]), on_stage(&window, [80.0, 20.0]));
    window.drag(from, to);
    let lines = |window: &Window| {
        let Placed::Lines(lines) = placed(window, "lines") else { panic!("lines are placed") };
        lines.all().to_vec()
    };
    let line = lines(&window)[0];
    let near = |at: [f32; 2], expected: [f32; 2]| (0..2).all(|i| (at[i] - expected[i]).abs() < 0.5);
    assert!(near(line.from, [80.0, 100.0]) && near(line.to, [80.0, 20.0]), "{line:?}");
    let cursor = window.cursor();
    window.drag(to, on_stage(&window, [120.0, 30.0]));
    let moved = lines(&window)[0];
    assert!(near(moved.from, [80.0, 100.0]) && near(moved.to, [120.0, 30.0]), "{moved:?}");
    assert_eq!(window.cursor(), cursor, "the run stays where it was");
    window.command(Command::Undo);
    assert_eq!(lines(&window), [line], "a drag is one change");
    window.drag(on_stage(&window, [20.0, 90.0]), on_stage(&window, [60.0, 90.0]));
    assert!(lines(&window).len() == 2 && lines(&window)[0] == line, "another drag adds a line: {:?}", lines(&window));
    window.command(Command::Undo);
    assert_eq!(lines(&window), [line]);
    window.command(Command::Undo);
    assert!(placed(&window, "lines").is_none());
    window.click_at(on_stage(&window, [40.0, 40.0]));
    assert!(placed(&window, "lines").is_none() && window.cursor() == cursor, "a click draws nothing and leads nowhere");
}

#[test]
fn what_was_placed_is_kept_in_a_session() {
    let clip = "synth:traffic,width=160,height=120,frames=8";
    let set = "[set]\nlines = \"80,100,80,20\"\nzones = \"10,20,60,90\"\n\"tracker.clicks\" = \"0:5,6 2:7.5,8\"\n";
    let text =
        format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"trajectory-analysis\"\nstep = \"3.1\"\n{set}");
    let folder = Path::new(".");
    let again = Session::parse(&text, folder).and_then(|session| session.text(folder)).expect("it is a session");
    for line in ["lines = \"80,100,80,20\"", "zones = \"10,20,60,90\"", "tracker.clicks", "\"0:5,6 2:7.5,8\""] {
        assert!(again.contains(line), "{line} is not in {again}");
    }
}
