//! Parameters, their sliders and undo in the window.

use super::*;

#[test]
fn a_parameter_changes_the_run_and_undo_brings_it_back() {
    let mut window = Window::usual();
    let (before, place) = (window.sentence(), window.shown().reference().expect("a block").at);
    window.harness.get_by_role_and_label(Role::Slider, "Block size").set_value_accesskit(24.0);
    window.settle();
    assert_eq!(window.value("block-size"), Value::Int(24));
    let there = window.shown().reference().expect("a block").at;
    assert!((0..2).all(|i| (there[i] - place[i]).abs() <= 20.0), "it stays where it was: {place:?} {there:?}");
    window.click("Reset block size");
    assert_eq!(window.value("block-size"), Value::Int(16));
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.value("block-size"), Value::Int(24));
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.value("block-size"), Value::Int(16));
    assert!(window.sentence() == before, "undo shows what was there before");
    window.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(window.value("block-size"), Value::Int(24));
}

#[test]
fn dragging_a_slider_is_one_change() {
    let mut window = Window::usual();
    let rail = window.harness.get_by_role_and_label(Role::Slider, "Search range").rect();
    let at = |share: f32| Pos2::new(rail.left() + share * rail.width(), rail.center().y);
    window.drag(at(0.25), at(0.75));
    let Value::Int(range) = window.value("search-range") else { panic!("the range is a whole number") };
    assert!((44..=52).contains(&range), "{range}");
    window.command(Command::Undo);
    assert_eq!(window.value("search-range"), Value::Int(16));
    assert!(!window.app().document().can_undo());
}

#[test]
fn what_is_only_shown_does_not_change() {
    let name = "synth:pillar,speed=1.255,noise=7.25,frames=4";
    let mut window = Window::with(vec2(1440.0, 1400.0), Start { open: Some(name.into()) });
    assert!(window.harness.query_by_role_and_label(Role::Slider, "Noise").is_some(), "the sliders are drawn");
    // Going through the fields with the keyboard is no change either.
    for _ in 0..60 {
        window.harness.key_press(Key::Tab);
        window.harness.run_steps(2);
    }
    window.settle();
    assert_eq!(window.app().document().source().map(|source| source.to_string()).as_deref(), Some(name));
    assert!(!window.app().document().can_undo());
}

#[test]
fn each_gesture_on_a_slider_is_taken_back_by_itself() {
    let mut window = Window::usual();
    let rail = window.harness.get_by_role_and_label(Role::Slider, "Search range").rect();
    let at = |share: f32| Pos2::new(rail.left() + share * rail.width(), rail.center().y);
    let mut seen = vec![window.value("search-range")];
    for share in [0.3, 0.6] {
        window.click_at(at(share));
        seen.push(window.value("search-range"));
    }
    for (from, to) in [(0.6, 0.9), (0.9, 0.1)] {
        window.harness.drag_at(at(from));
        window.harness.run_steps(1);
        window.harness.hover_at(at((from + to) / 2.0));
        window.harness.run_steps(1);
        // A fast hand: the last move and the release come in one frame.
        window.harness.drop_at(at(to));
        window.settle();
        seen.push(window.value("search-range"));
    }
    for before in seen.iter().rev().skip(1) {
        window.command(Command::Undo);
        assert_eq!(window.value("search-range"), *before, "of {seen:?}");
    }
    assert!(!window.app().document().can_undo());
}

#[test]
fn choices_and_switches_are_clicked() {
    let mut window = Window::usual();
    window.click("Order: Spiral");
    assert_eq!(window.value("order"), Value::Choice("spiral"));
    // Too many to lie side by side: a list.
    window.click_role(Role::ComboBox, "Cost");
    window.click("SSD");
    assert_eq!(window.value("cost"), Value::Choice("ssd"));
    window.click_role(Role::CheckBox, "Early exit");
    assert_eq!(window.value("early-exit"), Value::Switch(true));
    window.click("Reset all: Estimator");
    assert!(!window.app().document().is_tuned(Owner::Estimator));
}

#[test]
fn the_difficulty_of_a_sample_makes_another_clip() {
    let mut window = Window::usual();
    let before = window.shown().pictures.pair[0].luma().clone();
    window.harness.get_by_role_and_label(Role::Slider, "Noise").set_value_accesskit(20.0);
    window.settle();
    assert_ne!(*window.shown().pictures.pair[0].luma(), before);
    window.command(Command::Undo);
    assert_eq!(*window.shown().pictures.pair[0].luma(), before);
}

#[test]
fn what_has_no_effect_is_disabled_and_advanced_ones_lie_in_a_fold_that_is_remembered() {
    let size = vec2(1440.0, 1400.0);
    let mut window = Window::with(size, Start { open: Some("synth:translation,width=64,height=48,frames=3".into()) });
    window.command(Command::Palette);
    window.harness.get_by_label("What to find").set_text_value_accesskit("horn-schunck");
    window.settle();
    window.key(Key::Enter);
    let has = |window: &Window, name: &str| window.harness.query_by_role_and_label(Role::Slider, name).is_some();
    let disabled = |window: &Window| {
        let slider = window.harness.get_by_role_and_label(Role::Slider, "Relaxation");
        slider.accesskit_node().is_disabled()
    };
    assert!(!disabled(&window), "relaxation has an effect with SOR");
    assert!(!has(&window, "Tolerance"), "it is folded away");
    window.click_role(Role::ComboBox, "Solver");
    window.click("Jacobi");
    assert!(disabled(&window), "it has none with Jacobi");
    window.unfold();
    assert!(has(&window, "Tolerance"), "it is unfolded");
    let mut memory = Memory::default();
    eframe::App::save(window.harness.state_mut(), &mut memory);
    let open = Start { open: Some("synth:translation,width=64,height=48,frames=3".into()) };
    let mut again = Window::remembering(size, open, Some(memory));
    again.command(Command::Palette);
    again.harness.get_by_label("What to find").set_text_value_accesskit("horn-schunck");
    again.settle();
    again.key(Key::Enter);
    assert!(has(&again, "Tolerance"), "after the next start");
}

/// A window too narrow for the parameters, which stand in its header instead.
fn narrow() -> Window {
    Window::with(vec2(1280.0, 720.0), Start::default())
}

#[test]
fn a_narrow_window_has_the_parameters_that_matter_most_in_its_header() {
    for theme in [Command::LightTheme, Command::ProjectorTheme] {
        let mut window = narrow();
        let pictures = |window: &Window| window.region(Region::Stage);
        window.command(theme);
        assert!(!window.has(Region::Parameters));
        let header = window.region(Region::Header);
        let field = |window: &Window, name: &str| {
            window.harness.query_by_role_and_label(Role::SpinButton, name).map(|node| node.rect())
        };
        for name in ["Block size", "Search range"] {
            let rect = field(&window, name).unwrap_or_else(|| panic!("{theme:?}: {name}"));
            assert!(header.contains_rect(rect), "{theme:?}: {name} at {rect:?}");
        }
        let before = pictures(&window);
        window.harness.get_by_role_and_label(Role::SpinButton, "Block size").set_value_accesskit(24.0);
        window.settle();
        assert_eq!(window.value("block-size"), Value::Int(24));
        window.command(Command::Undo);
        assert_eq!(window.value("block-size"), Value::Int(16), "one gesture is one change");
        assert_eq!(pictures(&window), before);
        window.command(Command::Present);
        assert!(field(&window, "Block size").is_none(), "nothing stands around the pictures in full screen");
        window.command(Command::Present);
        window.harness.state_mut().open("lesson:sequential-search/1");
        window.settle();
        assert!(window.has(Region::Lesson) && field(&window, "Block size").is_none(), "a lesson is read");
    }
}

#[test]
fn a_wide_window_has_its_parameters_in_a_pane_alone() {
    let window = Window::usual();
    assert!(window.has(Region::Parameters));
    let fields = window.harness.query_all_by_role_and_label(Role::SpinButton, "Block size").count();
    assert_eq!(fields, 1);
}

#[test]
fn escape_and_a_cross_give_the_words_their_place_back() {
    let mut window = narrow();
    for theme in [Command::DarkTheme, Command::ProjectorTheme] {
        window.command(theme);
        let told = |window: &Window| window.has(Region::Explanation) || window.has(Region::Strip);
        assert!(told(&window));
        window.command(Command::ShowParameters);
        assert!(window.has(Region::Parameters) && !told(&window), "{theme:?}");
        window.key(Key::Escape);
        assert!(!window.has(Region::Parameters) && told(&window), "{theme:?}");
        window.command(Command::ShowParameters);
        window.click("Close parameters");
        assert!(!window.has(Region::Parameters) && told(&window), "{theme:?}");
    }
}
