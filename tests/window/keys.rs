//! Keys, dialogs and what is typed into them.

use super::*;

/// Text as a keyboard sends it: the key, then the letter.
fn typed(window: &mut Window, text: &str) {
    for letter in text.chars() {
        if let Some(key) = Key::from_name(&letter.to_uppercase().to_string()) {
            window.harness.event(Event::Key {
                key,
                physical_key: Some(key),
                pressed: true,
                repeat: false,
                modifiers: Modifiers::NONE,
            });
        }
        window.harness.event(Event::Text(letter.to_string()));
    }
}

/// What stands in the field called `name`.
fn field(window: &Window, name: &str) -> Option<String> {
    window.harness.query_by_label(name).and_then(|node| node.accesskit_node().value())
}

/// A folder with a clip of five frames, and the true flow of its fourth pair.
fn frames(folder: &Path) {
    for index in 0..5u8 {
        let picture =
            image::GrayImage::from_fn(64, 48, |x, y| image::Luma([((x * 3 + y * 5) as u8).wrapping_add(index)]));
        picture.save(folder.join(format!("frame{index:02}.png"))).expect("a picture");
    }
}

#[test]
fn text_typed_straight_after_the_key_of_the_palette_is_never_lost() {
    // All in one frame, in the next, and some frames later.
    for wait in [0, 1, 2, 3] {
        let mut window = Window::usual();
        window.harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
        window.harness.run_steps(wait);
        typed(&mut window, "dia");
        window.harness.run_steps(1);
        typed(&mut window, "mond");
        window.settle();
        assert_eq!(field(&window, "What to find").as_deref(), Some("diamond"), "after {wait} frames");
        window.key(Key::Enter);
        assert_eq!(window.app().document().estimator().info().id, "diamond", "after {wait} frames");
    }
}

#[test]
fn a_command_is_called_by_its_menu_and_its_name() {
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::K);
    typed(&mut window, "export picture");
    window.settle();
    let first = window.harness.query_all_by_role(Role::ListBoxOption).next();
    assert_eq!(first.and_then(|node| node.accesskit_node().label()).as_deref(), Some("Picture of this step…"));
    window.key(Key::Enter);
    assert!(field(&window, "Output path").is_some_and(|path| path.ends_with(".png")));
}

#[test]
fn text_typed_straight_after_the_key_of_the_open_dialog_is_never_lost() {
    let mut window = Window::usual();
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    typed(&mut window, "synth");
    window.harness.run_steps(1);
    window.harness.event(Event::Text(":pillar".into()));
    window.settle();
    assert_eq!(field(&window, "Path of the clip").as_deref(), Some("synth:pillar"));
}

#[test]
fn an_open_that_fails_keeps_its_dialog_its_text_and_the_keyboard() {
    let folder = tempfile::tempdir().expect("a folder");
    frames(folder.path());
    let mut window = Window::usual();
    window.command(Command::Open);
    let wrong = folder.path().join("no such folder").join("clip ü.mp4");
    for path in [wrong.display().to_string(), "~nobody/clip.mp4".into(), " ' ".into()] {
        window.harness.get_by_label("Path of the clip").set_text_value_accesskit(&path);
        window.settle();
        window.harness.get_by_label("Path of the clip").focus();
        window.settle();
        window.key(Key::Enter);
        assert_eq!(field(&window, "Path of the clip"), Some(path), "the text stays");
    }
    assert!(window.app().error().is_none(), "it is told in the dialog");
    window.harness.get_by_label("Path of the clip").set_text_value_accesskit(&wrong.display().to_string());
    window.settle();
    window.click_role(Role::Button, "Open");
    assert!(window.harness.query_by_label_contains("clip ü.mp4").is_some(), "the error is in the dialog");
    assert!(window.harness.get_by_label("Path of the clip").is_focused(), "the keyboard stays");
    window.harness.get_by_label("Path of the clip").set_text_value_accesskit(&folder.path().display().to_string());
    window.settle();
    window.click_role(Role::Button, "Open");
    assert!(field(&window, "Path of the clip").is_none(), "what opens closes the dialog");
    assert_eq!(window.app().document().clip().expect("a clip").info().frames, Some(5));
}

#[test]
fn tab_completes_a_path() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["lecture one.gif", "lecture two.gif", "other"] {
        fs::write(folder.path().join(name), []).expect("a file");
    }
    let mut window = Window::usual();
    window.command(Command::Open);
    let at = |name: &str| Some(format!("{}/{name}", folder.path().display()));
    window.harness.get_by_label("Path of the clip").set_text_value_accesskit(&at("le").unwrap());
    window.settle();
    for name in ["lecture ", "lecture one.gif", "lecture two.gif", "lecture one.gif"] {
        window.harness.key_press(Key::Tab);
        for _ in 0..50 {
            window.harness.run_steps(1);
            std::thread::sleep(Duration::from_millis(2));
        }
        window.settle();
        assert_eq!(field(&window, "Path of the clip"), at(name));
    }
    window.harness.key_press_modifiers(Modifiers::SHIFT, Key::Tab);
    window.settle();
    assert_eq!(field(&window, "Path of the clip"), at("lecture two.gif"));
    typed(&mut window, "x");
    window.settle();
    assert_eq!(field(&window, "Path of the clip"), at("lecture two.gifx"), "the cursor stands at the end");
}

#[test]
fn escape_closes_the_dialog_before_anything_else() {
    let mut window = Window::usual();
    window.command(Command::Lecture);
    window.command(Command::Palette);
    window.key(Key::Escape);
    assert!(field(&window, "What to find").is_none() && window.app().settings().lecture);
    window.key(Key::Escape);
    assert!(!window.app().settings().lecture);
}

#[test]
fn nothing_is_proposed_into_the_folder_of_the_clips_own_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("frames");
    fs::create_dir(&own).expect("a folder");
    frames(&own);
    for opened in [own.clone(), own.join("frame00.png")] {
        let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(opened.into_os_string()) });
        window.key(Key::End);
        for command in [Command::ExportPicture, Command::ExportSteps, Command::ExportResult] {
            window.command(command);
            let proposed = field(&window, "Output path").expect("a path");
            assert_ne!(Path::new(&proposed).parent(), Some(own.as_path()), "{command:?}");
            assert!(!proposed.contains("frames/"), "{command:?}: {proposed}");
            window.key(Key::Escape);
        }
    }
}

#[test]
fn a_range_says_how_many_files_it_makes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.command(Command::ExportSteps);
    let count = |window: &mut Window, from: &str, to: &str| {
        window.harness.get_by_label("First step").set_text_value_accesskit(from);
        window.harness.get_by_label("Last step").set_text_value_accesskit(to);
        window.harness.run_steps(2);
        let begun = Instant::now();
        while !window.app().is_settled() {
            window.harness.run_steps(1);
            std::thread::sleep(Duration::from_millis(2));
            assert!(begun.elapsed() < Duration::from_secs(30), "the counting does not end");
        }
        window.settle();
        let told = window.harness.query_by_label_contains("Saves ").and_then(|node| node.accesskit_node().value());
        told.unwrap_or_default()
    };
    assert_eq!(count(&mut window, "3.1", "3.9"), "Saves 9 files.");
    window.click_role(Role::Button, "block");
    assert_eq!(count(&mut window, "3", "5"), "Saves 3 files.");
    files::write_to(&mut window, &folder.path().join("steps"));
    assert_eq!(fs::read_dir(folder.path().join("steps")).expect("a folder").count(), 3);
}

#[test]
fn a_clip_begins_at_step_0_and_goes_on_where_it_was_left() {
    let size = vec2(1440.0, 900.0);
    let mut window = Window::remembering(size, Start::default(), None);
    let begun = window.cursor();
    assert!(
        begun.unit > 0 && begun.event == window.shown().events,
        "the bundled one opens at a block that moves: {begun}"
    );
    window.key(Key::Period);
    window.press(Modifiers::SHIFT, Key::ArrowRight);
    window.key(Key::ArrowRight);
    let left = (window.cursor(), window.shown().subject.experiment.frame);
    assert_eq!(left, (Cursor { unit: begun.unit + 2, event: 1 }, 1));
    window.harness.state_mut().open("synth:translation,frames=4");
    window.settle();
    assert_eq!(window.cursor().event, window.shown().events);
    let mut memory = Memory::default();
    window.harness.state_mut().open_sample(&motionscope_core::synth::SCENES[0]);
    window.settle();
    eframe::App::save(window.harness.state_mut(), &mut memory);
    let again = Window::remembering(size, Start::default(), Some(memory));
    assert_eq!((again.cursor(), again.shown().subject.experiment.frame), left, "after the next start");
}

#[test]
fn a_folder_with_truth_for_one_pair_opens_at_that_pair_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    frames(folder.path());
    let head = [64u32.to_le_bytes(), 48u32.to_le_bytes()].concat();
    let flow = [b"PIEH".to_vec(), head, vec![0; 64 * 48 * 8]].concat();
    fs::write(folder.path().join("flow03.flo"), flow).expect("the truth");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(folder.path().into()) });
    assert_eq!(window.app().document().frame(), 3);
    assert!(window.app().message().is_some_and(|message| message.contains("3 → 4")), "{:?}", window.app().message());
    window.key(Key::Comma);
    assert_eq!(window.app().document().frame(), 2, "another can be chosen");
}

#[test]
fn the_end_of_a_run_shows_the_scores_of_the_command_line() {
    for (estimator, clip) in [("kalman-tracker", "synth:traffic,frames=12"), ("full-search", "synth:pillar,frames=3")] {
        let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(clip.into()) });
        let wanted = motionscope_core::course::estimator(estimator).expect("it is there");
        window.command(Command::Palette);
        typed(&mut window, estimator);
        window.settle();
        window.key(Key::Enter);
        assert_eq!(window.app().document().estimator().info().id, wanted.info().id);
        window.key(Key::End);
        let shown = window.shown();
        let facts =
            shown.step.readouts.iter().find_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None });
        let facts: Vec<(String, String)> =
            facts.expect("facts").iter().map(|fact| (fact.label.to_string(), fact.value.clone())).collect();
        let experiment = &shown.subject.experiment;
        let threads = motionscope_core::base::Threads::single();
        let ran = experiment.estimator.run_counted(&shown.subject.clip, experiment.frame, &threads).expect("a run");
        let reference = motionscope_core::products::Reference { clip: &shown.subject.clip, frame: experiment.frame };
        for fact in ran.output.assess(&reference).expect("scores").facts {
            assert!(facts.contains(&(fact.label.to_string(), fact.value.clone())), "{estimator}: {}", fact.label);
        }
        let causal = experiment.causal(&shown.subject.clip, ran.causal).expect("scores");
        assert_eq!(
            causal.is_some(),
            facts.iter().any(|(label, _)| label == "Without hindsight"),
            "{estimator}: {facts:?}"
        );
        if let Some(causal) = causal {
            assert!(facts.contains(&("Without hindsight".into(), causal.headline)), "{facts:?}");
        }
    }
}
