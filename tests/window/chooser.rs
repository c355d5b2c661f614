//! The chooser of estimators.

use eframe::egui::accesskit::Toggled;
use motionscope_core::course::estimators;
use motionscope_core::run::Guarantee;

use super::*;

fn on(clip: &str, size: Vec2) -> Window {
    Window::with(size, Start { open: Some(clip.into()) })
}

fn id(window: &Window) -> &'static str {
    window.app().document().estimator().info().id
}

fn is_open(window: &Window) -> bool {
    window.harness.query_by_label("Which estimator").is_some()
}

fn types(window: &mut Window, text: &str) {
    window.harness.event(Event::Text(text.into()));
    window.settle();
}

/// The names of the cards that are said to suit the clip.
fn suited(window: &Window) -> Vec<String> {
    let buttons = window.harness.query_all_by_role(Role::Button).filter_map(|node| node.accesskit_node().label());
    buttons.filter_map(|label| Some(label.split_once(": ")?.0.to_owned())).collect()
}

/// Moves the light with the arrow keys onto every card that they lead to; gives the estimators that Enter would take.
fn reached(window: &mut Window) -> Vec<String> {
    let lit = |window: &Window| {
        let is_lit = |node: &egui_kittest::Node<'_>| node.accesskit_node().toggled() == Some(Toggled::True);
        let lit = window.harness.query_all_by_role(Role::Button).find(is_lit).expect("a card is lit");
        lit.accesskit_node().label().expect("a name")
    };
    let mut names = vec![lit(window)];
    let mut walk = |window: &mut Window, key: Key| {
        let before = lit(window);
        window.harness.key_press(key);
        window.harness.run_steps(1);
        let after = lit(window);
        if !names.contains(&after) {
            names.push(after.clone());
        }
        after != before
    };
    while walk(window, Key::ArrowLeft) {}
    loop {
        while walk(window, Key::ArrowUp) {}
        while walk(window, Key::ArrowDown) {}
        if !walk(window, Key::ArrowRight) {
            return names;
        }
    }
}

#[test]
fn arrows_lead_to_every_estimator_in_a_lecture_hall() {
    let size = vec2(1280.0, 720.0);
    let mut window = Window::new(size);
    window.command(Command::ProjectorTheme);
    window.key(Key::A);
    window.lies_inside(size, "the chooser");
    let names = reached(&mut window);
    for estimator in estimators() {
        let name = estimator.info().name;
        assert!(names.iter().any(|other| other == name), "{name} of {names:?}");
    }
}

#[test]
fn the_last_estimator_is_taken_in_every_size_and_theme() {
    let sizes = [(vec2(1920.0, 1080.0), Command::LightTheme), (vec2(844.0, 390.0), Command::DarkTheme)];
    for (size, theme) in sizes {
        let mut window = on("synth:drive", size);
        window.command(theme);
        window.key(Key::A);
        window.lies_inside(size, "the chooser");
        types(&mut window, "scene flow");
        let card = window.harness.get_by_role_and_label(Role::Button, "Scene flow").rect();
        window.click_at(card.center());
        assert_eq!((id(&window), is_open(&window)), ("scene-flow", false), "{size:?}");
    }
}

#[test]
fn all_estimators_are_in_sight_on_a_large_screen() {
    let size = vec2(1600.0, 1000.0);
    let mut window = Window::new(size);
    window.click("Estimator: Full search");
    for estimator in estimators() {
        let named = window.harness.query_all_by_role_and_label(Role::Button, estimator.info().name);
        let card = named.map(|node| node.rect()).max_by(|a, b| a.height().total_cmp(&b.height())).expect("a card");
        assert!(card.min.y > 0.0 && card.max.y < size.y - 80.0, "{} is out of sight", estimator.info().name);
    }
}

#[test]
fn a_name_is_typed_and_taken_with_the_keyboard_alone() {
    let mut window = Window::usual();
    window.key(Key::A);
    assert!(is_open(&window));
    types(&mut window, "kalman");
    let names = ["Kalman filter", "Kalman tracker"];
    for estimator in estimators() {
        let info = estimator.info();
        let is_listed = window.harness.query_by_role_and_label(Role::Button, info.name).is_some();
        let is_chosen = id(&window) == info.id;
        assert_eq!(is_listed, names.contains(&info.name) || is_chosen, "{}", info.name);
    }
    window.key(Key::ArrowDown);
    window.key(Key::Enter);
    assert_eq!((id(&window), is_open(&window)), ("kalman-tracker", false));
    assert_eq!(window.shown().info.id, "kalman-tracker", "it is run");
    window.key(Key::A);
    types(&mut window, "diamond");
    window.key(Key::Escape);
    assert_eq!((id(&window), is_open(&window)), ("kalman-tracker", false), "Escape changes nothing");
}

#[test]
fn what_is_typed_straight_after_the_key_is_found() {
    let mut window = Window::usual();
    window.harness.key_press(Key::A);
    window.harness.event(Event::Text("horn".into()));
    window.harness.key_press(Key::Enter);
    window.settle();
    assert_eq!((id(&window), is_open(&window)), ("horn-schunck", false));
}

#[test]
fn the_name_in_the_bar_opens_it() {
    let mut window = Window::usual();
    let header = window.region(Region::Header);
    let name = window.app().document().estimator().info().name;
    let named = window.harness.query_all_by_role_and_label(Role::Button, name);
    let inside = named.map(|node| node.rect()).find(|rect| header.contains_rect(*rect));
    window.click_at(inside.expect("the name is there").center());
    assert!(is_open(&window));
    window.click("Diamond search");
    assert_eq!((id(&window), is_open(&window)), ("diamond", false));
}

#[test]
fn stereo_suits_a_clip_with_a_right_view_and_another_one_lacks_it() {
    let needs_views = |guarantee| matches!(guarantee, Guarantee::Disparity | Guarantee::SceneFlow);
    let stereo: Vec<_> = estimators().into_iter().filter(|estimator| needs_views(estimator.guarantee())).collect();
    assert_eq!(stereo.len(), 3);
    for (clip, has_views) in [("synth:traffic", false), ("synth:drive", true)] {
        let mut window = on(clip, vec2(1440.0, 900.0));
        window.key(Key::A);
        let suited = suited(&window);
        assert!(!suited.is_empty(), "{clip}");
        for estimator in &stereo {
            let name = estimator.info().name;
            assert_eq!(suited.iter().any(|other| other == name), has_views, "{name} on {clip}: {suited:?}");
        }
        window.harness.get_by_role_and_label(Role::Button, "Block stereo").hover();
        window.settle();
        let said = window.harness.query_by_label_contains("Needs a right view.").is_some();
        assert_eq!(said, !has_views, "why is told on {clip}");
    }
}

#[test]
fn what_cannot_go_in_lockstep_says_why_and_is_not_taken() {
    let mut window = Window::usual();
    window.click("Add in lockstep");
    let button = |window: &Window, name: &str| {
        let node = window.harness.get_by_role_and_label(Role::Button, name);
        node.accesskit_node().is_disabled()
    };
    assert!(button(&window, "Kalman filter") && !button(&window, "Diamond search"));
    types(&mut window, "kalman filter");
    window.key(Key::Enter);
    assert!(is_open(&window) && window.app().document().side_by_side().is_empty());
    window.key(Key::Escape);
    window.click("Add in lockstep");
    types(&mut window, "diamond");
    window.key(Key::Enter);
    assert_eq!(window.app().document().side_by_side().beside.len(), 1);
}

#[test]
fn pictures_of_steps_are_made_while_the_chooser_is_open_and_no_longer() {
    let mut window = Window::usual();
    window.key(Key::A);
    types(&mut window, "harris");
    let begun = Instant::now();
    while !window.app().is_settled() {
        window.harness.run_steps(1);
        assert!(begun.elapsed() < Duration::from_secs(60), "the picture is never made");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(window.app().has_picture_of("harris"));
    assert!(!window.app().has_picture_of("scene-flow"), "what is not in sight is not made");
    window.key(Key::Escape);
    assert!(window.app().is_settled(), "nothing is made any more");
}

#[test]
fn at_the_start_page_a_choice_opens_the_example_that_its_picture_shows() {
    let mut window = Window::begun(vec2(1280.0, 720.0), Start::default(), None);
    let family = estimators()[0].info().family;
    window.click(family);
    assert!(is_open(&window));
    let listed = |name: &str| window.harness.query_by_role_and_label(Role::Button, name).is_some();
    assert!(listed("Diamond search") && !listed("Kalman filter"), "the family alone");
    window.click("Diamond search");
    assert!(!window.app().is_at_start());
    assert_eq!(id(&window), "diamond");
    assert!(window.shown().subject.experiment.source.to_string().contains("sub-pixel"), "its example of success");
}
