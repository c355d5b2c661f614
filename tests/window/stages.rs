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
