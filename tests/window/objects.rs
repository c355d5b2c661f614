//! Estimators of single frames: what moves, and objects that are followed.

use motionscope::experiment::pixel::Held;
use motionscope::ui::model::snapshot::Hold;
use motionscope_core::run::Guarantee;
use motionscope_core::scene::Shape;

use super::*;

/// A window on an estimator at a step of a small clip with cars, seen by two cameras where it needs them.
pub fn window(estimator: &str, step: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let scene = match motionscope_core::course::estimator(estimator).expect("an estimator").guarantee() {
        Guarantee::SceneFlow => "drive",
        _ => "traffic",
    };
    let clip = format!("synth:{scene},width=160,height=120,frames=8");
    let lines = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"{estimator}\"\nstep = \"{step}\"\n");
    fs::write(&path, lines).expect("it is written");
    Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) })
}

/// How many pictures stand on the stage.
fn pictures(window: &Window) -> usize {
    let images = window.harness.query_all_by_role(Role::Image);
    let is_picture = |label: String| label.starts_with("Stage: Frame t");
    images.filter(|node| node.accesskit_node().label().is_some_and(is_picture)).count()
}

fn choose(window: &mut Window, name: &str) {
    let now = window.app().document().estimator().info().name;
    window.click(&format!("Estimator: {now}"));
    window.click(name);
}

#[test]
fn what_looks_at_single_frames_is_seen_by_itself() {
    let mut window = window("full-search", "3.2");
    assert_eq!(pictures(&window), 2);
    choose(&mut window, "Mixture of Gaussians");
    assert_eq!(pictures(&window), 1, "a frame by itself");
    choose(&mut window, "Diamond search");
    assert_eq!(pictures(&window), 2, "a pair again");
    assert_eq!(pictures(&self::window("harris", "3.2")), 1, "as a session opens it");
}

#[test]
fn the_last_frame_of_a_clip_is_reached_and_shown() {
    let mut window = window("kalman-tracker", "2.1");
    window.key(Key::End);
    assert!(window.shown().at_end);
    assert_eq!(window.shown().frame, 7);
    assert!(window.harness.query_by_label("frame 7").is_some(), "the header names one frame");
}

#[test]
fn errors_of_tracks_are_marked_on_the_timeline() {
    let mut window = window("kalman-tracker", "2.1");
    assert!(window.shown().faults.is_empty(), "the run is not known yet");
    window.key(Key::End);
    let faults = window.shown().faults.clone();
    assert!(!faults.is_empty(), "tentative tracks are misses");
    window.key(Key::Home);
    assert_eq!(window.shown().faults, faults, "they stay");
    // A click on a mark goes to the frame.
    let (unit, fault) = faults[0];
    let rail = window.harness.get_by_label("Timeline, frames").rect();
    let share = (unit as f32 + 0.5) / window.shown().units.expect("the run is known") as f32;
    let at = Pos2::new(rail.left() + share * rail.width(), rail.center().y);
    window.harness.hover_at(at);
    window.harness.run_steps(60);
    assert!(window.harness.query_all_by_label_contains(fault.name()).next().is_some(), "its tip names it");
    window.click_at(at);
    assert_eq!(window.cursor().unit, unit);
}

#[test]
fn a_click_on_a_box_explains_its_track() {
    let mut window = window("kalman-tracker", "6");
    let objects = |window: &Window| {
        let texts = window.shown().scene.marks.iter().filter_map(|mark| match &mark.shape {
            Shape::Text { at, text } => Some((*at, text.clone())),
            _ => None,
        });
        texts.collect::<Vec<_>>()
    };
    let (corner, id) = objects(&window).into_iter().next().expect("a track with its number");
    let focus = Focus::current([corner[0] + 3.0, corner[1] + 3.0]);
    let place = Place { hold: Hold::Set(Some(Held::of(focus))), ..Place::at(window.cursor()) };
    window.harness.state_mut().walk_from(place);
    window.settle();
    let told = window.shown().step.sentence.plain();
    assert!(told.starts_with(&format!("Selected: track {id} ")), "{told}");
    assert!(window.harness.query_all_by_label_contains("Selected track").next().is_some(), "with its numbers");
}

#[test]
fn a_selected_track_stays_selected_wherever_it_goes() {
    let mut window = window("kalman-tracker", "0.0");
    window.command(Command::FocusNever);
    window.key(Key::End);
    let texts = window.shown().scene.marks.iter().filter_map(|mark| match &mark.shape {
        Shape::Text { at, text } => Some((*at, text.clone())),
        _ => None,
    });
    let (corner, id) = texts.into_iter().next().expect("a track with its number");
    let stage = window.harness.get_by_label_contains("Stage: ").rect();
    let (width, height) = window.shown().pictures.pair[0].size();
    let scale = (stage.width() / width as f32).min(stage.height() / height as f32);
    let off = vec2(corner[0] + 4.5, corner[1] + 4.5) - vec2(width as f32, height as f32) / 2.0;
    window.click_at(stage.center() + scale * off);
    // Away from the picture, where nothing is pointed at.
    window.harness.hover_at(Pos2::new(2.0, 2.0));
    window.settle();
    let selected = |window: &Window| {
        let told = window.shown().step.sentence.plain();
        let of = told.strip_prefix("Selected: track ").and_then(|rest| rest.split_whitespace().next());
        of.map(str::to_owned)
    };
    assert_eq!(selected(&window).as_deref(), Some(id.trim()), "as it was clicked");
    for _ in 0..4 {
        window.key(Key::PageUp);
        assert!(selected(&window).is_none_or(|now| now == id.trim()), "{:?}", selected(&window));
    }
    assert_eq!(selected(&window).as_deref(), Some(id.trim()), "four frames before");
    // Reopened, it is the track that is selected and not the pixel where it was.
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("selected.motionscope");
    window.press(Modifiers::COMMAND, Key::S);
    super::files::write_to(&mut window, &file);
    let mut again = Window::with(vec2(1440.0, 900.0), Start { open: Some(file.into()) });
    assert_eq!(selected(&again), selected(&window), "as it was saved");
    again.key(Key::End);
    assert_eq!(selected(&again).as_deref(), Some(id.trim()), "elsewhere");
    window.key(Key::Escape);
    assert_eq!(selected(&window), None);
}

#[test]
fn the_matrices_of_a_filter_stand_in_numbers() {
    // Predicted, looked, gated, updated.
    let window = window("kalman-filter", "3.4");
    for part in ["state covariance: ", "gain: ", "innovation: "] {
        assert!(window.harness.query_all_by_label_contains(part).next().is_some(), "{part} is not there");
    }
    assert!(window.harness.query_by_label("Histogram").is_none(), "no displacements are counted");
}
