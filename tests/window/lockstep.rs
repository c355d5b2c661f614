//! Estimators in lockstep in the window.

use super::*;
use motionscope::view::moment::Viewer;
use motionscope::view::panes::Selection;
use motionscope::view::rendering::Rendering;
use motionscope_core::run::Pace;

fn names(window: &Window) -> Vec<&'static str> {
    window.shown().tiles.iter().map(|tile| tile.info.name).collect()
}

/// Everything that the tiles tell and show.
fn tiles(window: &Window) -> String {
    window.shown().tiles.iter().map(|tile| format!("{:?} {:?} {:?}\n", tile.step, tile.scene, tile.words)).collect()
}

/// The heading of an estimator's tile: what can be clicked to have it explained.
fn heading(window: &Window, name: &str) -> Rect {
    let all = window.harness.query_all_by_role(Role::Button);
    let is_it = |node: &egui_kittest::Node<'_>| {
        node.accesskit_node().label().is_some_and(|label| label.starts_with(&format!("{name}: ")))
    };
    all.into_iter().find(is_it).expect("the heading is there").rect()
}

/// Has four estimators go in lockstep, chosen where they are compared.
fn four(window: &mut Window) {
    window.harness.key_press(Key::C);
    window.compared();
    window.harness.get_by_label("Change…").click();
    window.compared();
    window.harness.get_by_label("Predictive search").click();
    window.compared();
    window.click("Estimators in lockstep");
}

#[test]
fn a_key_has_them_search_the_same_block_and_another_goes_on_alone() {
    let mut window = Window::usual();
    let before = (window.cursor(), window.sentence());
    window.key(Key::B);
    assert_eq!(names(&window), ["Full search", "Three-step search", "Diamond search"]);
    assert_eq!(window.cursor().unit, before.0.unit, "the same block");
    assert!(window.cursor().event < before.0.event, "candidates are counted, not events");
    let (here, told) = (window.cursor(), tiles(&window));
    window.key(Key::ArrowRight);
    assert_eq!(window.cursor(), Cursor { event: here.event + 1, ..here });
    assert_ne!(tiles(&window), told);
    window.key(Key::ArrowLeft);
    assert!(tiles(&window) == told, "back is what was there");
    window.key(Key::Escape);
    let slack = window.cursor().event.abs_diff(before.0.event);
    assert!(window.shown().tiles.is_empty() && window.cursor().unit == before.0.unit && slack <= 2, "{slack}");
    window.key(Key::B);
    window.key(Key::B);
    assert!(window.shown().tiles.is_empty());
    window.command(Command::Undo);
    assert_eq!(names(&window).len(), 3, "undo brings them back");
}

#[test]
fn a_click_has_another_explained_and_only_the_next_goes_to_a_block() {
    let mut window = Window::usual();
    window.key(Key::B);
    let here = window.cursor();
    assert!(window.harness.query_all_by_label_contains("current line").next().is_some());
    let told = |window: &Window| window.harness.query_by_label_contains("large diamond").is_some();
    assert!(!told(&window), "full search has no diamond");
    let place = heading(&window, "Diamond search");
    window.click_at(place.center());
    assert!(told(&window), "the pseudocode is that of the diamond search");
    assert_eq!(window.cursor(), here);
    let three = heading(&window, "Three-step search");
    let in_picture = three.center_bottom() + vec2(0.0, 20.0);
    window.click_at(in_picture);
    assert_eq!(window.cursor(), here, "the first click on a picture explains it");
    assert!(!told(&window));
    window.click_at(in_picture);
    assert_ne!(window.cursor().unit, here.unit, "the second goes to the block");
    assert_eq!(window.cursor().event, window.shown().events);
}

#[test]
fn the_budget_is_shared_and_parameters_are() {
    let mut window = Window::usual();
    window.key(Key::B);
    window.harness.get_by_role_and_label(Role::Slider, "Search range").set_value_accesskit(4.0);
    window.settle();
    let all = |window: &Window, name: &str| -> Vec<Value> {
        window
            .app()
            .document()
            .side_by_side()
            .beside
            .iter()
            .map(|one| one.estimator.get(name).expect("they have it"))
            .collect()
    };
    assert_eq!(all(&window, "search-range"), [Value::Int(4), Value::Int(4)]);
    window.click_role(Role::ComboBox, "In lockstep by");
    window.click("same budget");
    assert_eq!(window.app().document().side_by_side().pace, Pace::Budget);
    window.key(Key::End);
    let shown = window.shown();
    assert!(shown.at_end && shown.tiles.iter().all(|tile| !tile.is_done), "nobody waits at the end");
    assert!(shown.tiles.iter().all(|tile| tile.prediction.is_some()));
    let psnr = |i: usize| shown.tiles[i].words[0].plain();
    assert!((0..3).all(|i| psnr(i).contains("dB PSNR")), "{}", psnr(0));
    window.click("Leave lockstep");
    assert!(window.shown().at_end && window.shown().tiles.is_empty());
}

#[test]
fn a_comparison_leads_to_its_estimators_step_by_step() {
    let mut window = Window::usual();
    four(&mut window);
    assert_eq!(names(&window), ["Full search", "Three-step search", "Diamond search", "Predictive search"]);
    assert!(window.harness.query_by_label("Compare estimators").is_none(), "the dialog is gone");
}

#[test]
fn nothing_of_it_is_cut_off_at_any_size() {
    for (size, theme) in [
        (vec2(1280.0, 720.0), Theme::Dark),
        (vec2(1280.0, 720.0), Theme::Projector),
        (vec2(1600.0, 1000.0), Theme::Light),
        (vec2(1920.0, 1080.0), Theme::Projector),
    ] {
        let mut window = Window::new(size);
        while window.app().settings().look.theme != theme {
            window.command(Command::NextTheme);
        }
        four(&mut window);
        let headings: Vec<_> = names(&window).into_iter().map(|name| heading(&window, name)).collect();
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        for (i, rect) in headings.iter().enumerate() {
            assert!(screen.contains_rect(*rect) && rect.width() > 100.0, "{size:?} {theme:?}: {rect}");
            assert!(headings[..i].iter().all(|other| !other.intersects(*rect)), "{size:?} {theme:?}");
        }
        window.lies_inside(size, "lockstep");
    }
}

#[test]
fn a_session_keeps_them_and_a_picture_is_what_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = Window::usual();
    window.key(Key::B);
    window.click_role(Role::ComboBox, "In lockstep by");
    window.click("same budget");
    let (here, told) = (window.cursor(), tiles(&window));
    let look = Look { view: None, ..Look::default() };
    for (name, what) in [("one.motionscope", OutputKind::Session), ("one.png", OutputKind::Picture)] {
        let path = folder.path().join(name);
        window.harness.state_mut().write(Order { what, path, scale: 1, look, panes: Selection::default() });
        window.settle();
    }
    let shown = window.shown();
    let (clip, estimator) = (&shown.subject.clip, &*shown.subject.experiment.estimator);
    let reverse = Reverse::new(estimator, clip, shown.subject.experiment.frame);
    let mut viewer = Viewer::new(&shown.subject.experiment, clip, &look, &reverse).unwrap();
    viewer.walk.jump(motionscope_core::run::Move::To(here));
    let moment = viewer.moment(None).unwrap();
    let drawn = Rendering { moment: &moment, estimator, look: &look, panes: &Selection::default() }
        .encode(Format::Png, 1)
        .unwrap();
    assert!(fs::read(folder.path().join("one.png")).unwrap() == drawn, "the same pixels without the window");
    let path: OsString = folder.path().join("one.motionscope").into();
    let again = Window::with(vec2(1440.0, 900.0), Start { open: Some(path) });
    assert_eq!(again.cursor(), here);
    assert!(tiles(&again) == told, "it opens as it was");
}

#[test]
fn nobody_is_moved_by_undo_or_by_a_parameter() {
    let mut window = Window::usual();
    let alone = window.cursor();
    window.key(Key::B);
    let together = window.cursor();
    window.command(Command::Undo);
    assert!(window.shown().tiles.is_empty());
    let slack = window.cursor().event.abs_diff(alone.event);
    assert!(window.cursor().unit == alone.unit && slack <= 2, "{} is not {alone}", window.cursor());
    window.command(Command::Redo);
    assert_eq!((window.shown().tiles.len(), window.cursor()), (3, together));
    // Where the budget counts, the others are at other blocks by now.
    window.click_role(Role::ComboBox, "In lockstep by");
    window.click("same budget");
    let leader = window.shown().leader().unit;
    window.unfold();
    window.harness.get_by_role_and_label(Role::Slider, "Lambda").set_value_accesskit(1.0);
    window.settle();
    assert_eq!(window.shown().leader().unit, leader);
    assert!(window.shown().tiles[2].cursor.unit > leader, "diamond search is far ahead with that many candidates");
}

/// A session of this estimator on the traffic scene, at a step.
fn of_traffic(estimator: &str, step: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lesson.motionscope");
    let text = format!("motionscope = 1\nclip = \"synth:traffic\"\nestimator = \"{estimator}\"\nstep = \"{step}\"\n");
    std::fs::write(&path, text).expect("a session");
    Window::with(vec2(1600.0, 1000.0), Start { open: Some(path.into()) })
}

#[test]
fn background_models_look_at_the_same_frame() {
    let mut window = of_traffic("mixture-of-gaussians", "5.2");
    window.click("Add in lockstep");
    let disabled = window.harness.get_by_role_and_label(Role::Button, "Diamond search");
    assert!(disabled.accesskit_node().is_disabled(), "a search of two frames does not go with it");
    window.harness.get_by_role_and_label(Role::Button, "Running average").click();
    window.settle();
    assert_eq!(names(&window), ["Mixture of Gaussians", "Running average"]);
    assert_eq!((window.cursor().unit, window.app().document().side_by_side().pace), (4, Pace::Frame));
    window.key(Key::Home);
    window.key(Key::PageDown);
    let shown = window.shown();
    assert!(shown.tiles.iter().all(|tile| tile.cursor.unit == shown.cursor.unit), "the same frame");
    window.click("Remove 2 Running average");
    assert!(window.shown().tiles.is_empty(), "alone again");
}

#[test]
fn one_of_two_filters_is_set_alone() {
    let mut window = of_traffic("kalman-filter", "9");
    window.key(Key::B);
    assert_eq!(names(&window), ["Kalman filter"; 2]);
    let told =
        |window: &Window| -> Vec<String> { window.shown().tiles.iter().map(|tile| tile.names[0].clone()).collect() };
    assert_eq!(told(&window), ["Kalman filter · Constant velocity", "Kalman filter · Constant acceleration"]);
    window.click("Reset all: 2 Kalman filter");
    assert_eq!(told(&window), ["Kalman filter"; 2], "it follows the first in everything");
    let before = tiles(&window);
    window.command(Command::Undo);
    assert!(tiles(&window) != before && told(&window)[1].ends_with("acceleration"));
}
