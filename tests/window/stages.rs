//! Stages: chosen, set, walked by themselves, and left again.

use super::*;

fn tracker() -> Window {
    let start = Start { open: Some("synth:traffic,width=160,height=120,frames=6".into()) };
    let mut window = Window::with(vec2(1440.0, 900.0), start);
    let now = window.app().document().estimator().info().name;
    window.click(&format!("Estimator: {now}"));
    window.click("Kalman tracker");
    window
}

#[test]
fn a_stage_is_walked_by_itself_on_the_same_frame_and_left_again() {
    let mut window = tracker();
    window.key(Key::PageDown);
    window.key(Key::PageDown);
    let before = window.cursor();
    assert!(before.unit > 0, "it has gone on");
    window.command(Command::IntoStage);
    let document = window.app().document();
    assert_eq!(document.estimator().info().id, "mixture-of-gaussians");
    assert_eq!(document.parents().map(|info| info.id).collect::<Vec<_>>(), ["kalman-tracker"]);
    assert_eq!(window.cursor().unit, before.unit, "it stands at the frame that its parent is at");
    assert!(window.harness.query_by_label("Kalman tracker ›").is_some(), "the way back is shown");
    window.key(Key::Home);
    assert_eq!(window.cursor(), Cursor::default());
    window.press(Modifiers::SHIFT, Key::I);
    assert_eq!((window.app().document().estimator().info().id, window.cursor()), ("kalman-tracker", before));
    assert!(!window.app().document().is_tuned(Owner::Estimator), "nothing was changed by looking");
}

#[test]
fn another_clip_is_opened_outside_of_the_stage_and_says_so() {
    let mut window = tracker();
    window.command(Command::IntoStage);
    window.harness.get_by_role_and_label(Role::Slider, "Min area").set_value_accesskit(77.0);
    window.settle();
    window.harness.state_mut().open("synth:traffic,width=96,height=72,frames=4");
    window.settle();
    let document = window.app().document();
    assert_eq!((document.estimator().info().id, document.parents().len()), ("kalman-tracker", 0));
    assert_eq!(document.estimator().get("detector.min-area"), Ok(Value::Int(77)), "what was set in the stage is kept");
    let message = window.app().message().unwrap_or_default();
    assert!(message.contains("the stage was closed") && message.contains("Kalman tracker"), "{message}");
    assert_eq!(window.shown().pictures.pair[0].size(), (96, 72));
}

#[test]
fn a_slider_of_the_clip_that_moves_in_a_stage_counts_for_its_parent() {
    let mut window = tracker();
    window.command(Command::IntoStage);
    window.harness.get_by_role_and_label(Role::Slider, "Noise").set_value_accesskit(3.0);
    window.settle();
    window.command(Command::OutOfStage);
    let source = window.app().document().source().map(ToString::to_string).unwrap_or_default();
    assert!(source.contains("noise=3,"), "{source}");
    assert_eq!(window.shown().subject.experiment.source.to_string(), source);
}

#[test]
fn what_is_changed_in_a_stage_is_its_parents() {
    let mut window = tracker();
    window.command(Command::IntoStage);
    window.harness.get_by_role_and_label(Role::Slider, "Min area").set_value_accesskit(77.0);
    window.settle();
    window.command(Command::OutOfStage);
    let parent = |window: &Window| window.app().document().estimator().get("detector.min-area");
    assert_eq!(parent(&window), Ok(Value::Int(77)));
    // Undo takes the ways in and out back as well.
    window.command(Command::Undo);
    assert_eq!(window.app().document().estimator().info().id, "mixture-of-gaussians");
    window.command(Command::OutOfStage);
    assert_eq!(parent(&window), Ok(Value::Int(77)));
}

/// The estimator at work, and those whose stage it is.
fn way(window: &Window) -> Vec<&'static str> {
    let document = window.app().document();
    document.parents().map(|info| info.id).chain([document.estimator().info().id]).collect()
}

#[test]
fn the_pipeline_of_the_course_is_assembled_by_choosing_and_each_link_is_walked() {
    // Tall enough for all rows, so that none has to be scrolled to.
    let start = Start { open: Some("synth:traffic,width=160,height=120,frames=6".into()) };
    let mut window = Window::with(vec2(1440.0, 2400.0), start);
    let now = window.app().document().estimator().info().name;
    window.click(&format!("Estimator: {now}"));
    window.click("Trajectory analysis");
    // A tracker may be in detail already; its detector and that one's mask are chosen a fold deeper each.
    window.click("Kalman tracker in detail");
    window.click_role(Role::ComboBox, "Detector");
    window.click("Connected components");
    window.click("Connected components in detail");
    window.click_role(Role::ComboBox, "Mask");
    window.click("Mixture of Gaussians");
    assert_eq!(window.value("tracker.detector").to_string(), "connected-components");
    assert_eq!(window.value("tracker.detector.mask").to_string(), "mixture-of-gaussians");
    window.key(Key::PageDown);
    window.key(Key::PageDown);
    let before = window.cursor();
    let links = ["trajectory-analysis", "kalman-tracker", "connected-components", "mixture-of-gaussians"];
    for depth in 1..links.len() {
        window.command(Command::IntoStage);
        assert_eq!(way(&window), links[..=depth]);
        window.key(Key::ArrowLeft);
        assert!(window.shown().failure.is_none() && !window.shown().step.sentence.plain().is_empty());
    }
    for depth in (0..links.len() - 1).rev() {
        window.command(Command::OutOfStage);
        assert_eq!(way(&window), links[..=depth]);
    }
    assert_eq!(window.cursor(), before);
    window.key(Key::End);
    assert!(window.shown().at_end && window.shown().failure.is_none());
}

#[test]
fn a_session_is_not_saved_on_pictures_that_it_cannot_name() {
    let mut window = tracker();
    window.click("Estimator: Kalman tracker");
    window.click("Flow magnitude");
    window.key(Key::PageDown);
    window.key(Key::PageDown);
    window.command(Command::IntoStage);
    window.press(Modifiers::COMMAND, Key::S);
    let message = window.app().message().unwrap_or_default();
    assert!(message.contains("Close the stage (Shift+I)"), "{message}");
    window.command(Command::OutOfStage);
    window.press(Modifiers::COMMAND, Key::S);
    assert!(window.harness.query_by_label_contains("Save the session").is_some());
}

#[test]
fn an_estimator_that_depends_on_one_earlier_frame_begins_there_and_another_one_where_the_run_began() {
    let mut window = tracker();
    let choose = |window: &mut Window, name: &str| {
        let now = window.app().document().estimator().info().name;
        window.click(&format!("Estimator: {now}"));
        window.click(name);
    };
    choose(&mut window, "Mixture of Gaussians");
    for _ in 0..4 {
        window.key(Key::PageDown);
    }
    let at = |window: &Window| (window.app().document().frame(), window.cursor().unit, window.shown().frame);
    let (_, _, frame) = at(&window);
    assert!(frame > 2 && at(&window) == (0, frame, frame), "{:?}", at(&window));
    choose(&mut window, "Flow magnitude");
    assert_eq!(at(&window), (frame - 1, 1, frame), "only one flow is computed");
    let message = window.app().message().unwrap_or_default();
    assert!(message.contains(&format!("begins at frame {}", frame - 1)), "{message}");
    window.command(Command::Undo);
    assert_eq!(at(&window), (0, frame, frame), "the mixture has seen all frames again");
    window.command(Command::Redo);
    choose(&mut window, "Single Gaussian");
    assert_eq!(at(&window), (0, frame, frame));
}

#[test]
fn undo_goes_back_to_where_the_parent_stood() {
    let mut window = tracker();
    window.key(Key::PageDown);
    window.key(Key::PageDown);
    let before = window.cursor();
    window.command(Command::IntoStage);
    window.key(Key::End);
    let inside = window.cursor();
    assert_ne!(inside, before);
    window.command(Command::Undo);
    assert_eq!((way(&window), window.cursor()), (vec!["kalman-tracker"], before));
    window.command(Command::Redo);
    assert_eq!(way(&window), ["kalman-tracker", "mixture-of-gaussians"]);
    assert_eq!(window.cursor().unit, before.unit, "the stage stands at the frame that its parent is at");
}

#[test]
fn a_slider_of_the_clip_moves_the_pictures_of_a_stage_that_has_its_own() {
    let start = Start { open: Some("synth:traffic,width=160,height=120,frames=4".into()) };
    let mut window = Window::with(vec2(1440.0, 900.0), start);
    let now = window.app().document().estimator().info().name;
    window.click(&format!("Estimator: {now}"));
    window.click("Hierarchical search");
    window.command(Command::IntoStage);
    let pixels = |window: &Window| window.shown().pictures.pair[0].luma().cells().to_vec();
    let (size, before) = (window.shown().pictures.pair[0].size(), pixels(&window));
    assert!(size.0 < 160, "it works on the coarsest level: {size:?}");
    window.harness.get_by_role_and_label(Role::Slider, "Noise").set_value_accesskit(30.0);
    window.settle();
    let noisy = pixels(&window);
    assert!(window.shown().pictures.pair[0].size() == size && noisy != before, "the level has the noise");
    window.command(Command::Undo);
    assert!(pixels(&window) == before);
}
