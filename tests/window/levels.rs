//! The levels of a pyramid in the window.

use super::*;
use motionscope::view::moment::Viewer;
use motionscope::view::panes::Selection;
use motionscope::view::rendering::Rendering;
use motionscope_core::scene::Levels;

/// A window on a hierarchical search, on its first candidates.
fn window(lines: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let start = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"hierarchical\"\nstep = \"7.9\"\n";
    fs::write(&path, format!("{start}{lines}")).expect("it is written");
    Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) })
}

/// Puts a level on the stage.
fn choose(window: &mut Window, level: &str) {
    window.click_role(Role::ComboBox, "Level");
    let is_item = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == Role::Button;
    let mut items: Vec<_> = window.harness.query_all_by_label_contains(level).filter(is_item).collect();
    items.pop().expect("the level is in the list").click();
    drop(items);
    window.settle();
}

fn levels(window: &Window) -> &Levels {
    window.shown().scene.levels.as_ref().expect("it works on a pyramid")
}

/// Whether a picture on the stage is called so.
fn stage(window: &Window, title: &str) -> bool {
    window.harness.query_by_role_and_label(Role::Image, &format!("Stage: {title}")).is_some()
}

#[test]
fn the_stage_follows_the_level_at_work_or_stays_on_one() {
    let mut window = window("");
    assert_eq!(levels(&window).at_work, 2);
    assert!(stage(&window, "Frame t = 0 · level 2, 80×60 px") && stage(&window, "Frame t+1 = 1 · level 2, 80×60 px"));
    choose(&mut window, "Level 0");
    assert!(stage(&window, "Frame t = 0"), "the picture itself");
    choose(&mut window, "Level 1");
    assert!(stage(&window, "Frame t = 0 · level 1, 160×120 px"));
    window.command(Command::End);
    assert!(stage(&window, "Frame t = 0 · level 1, 160×120 px"), "it stays");
    window.key(Key::Num7);
    assert!(stage(&window, "Prediction of frame t = 0"), "there is none of a level");
    window.key(Key::Num1);
    choose(&mut window, "Level at work");
    assert!(stage(&window, "Frame t = 0"), "the run ends on the picture");
    window.command(Command::Start);
    assert!(stage(&window, "Frame t = 0"), "nothing is at work yet");
    window.command(Command::Into);
    assert!(stage(&window, "Frame t = 0 · level 2, 80×60 px"));
}

#[test]
fn only_what_works_on_a_pyramid_offers_its_levels() {
    let mut window = Window::usual();
    assert!(window.harness.query_by_role_and_label(Role::ComboBox, "Level").is_none());
    window.key(Key::B);
    assert!(window.harness.query_by_role_and_label(Role::ComboBox, "Level").is_none());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.motionscope");
    let text = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"diamond\"\nstep = \"7.3\"\n[[beside]]\n\
                estimator = \"hierarchical\"\n";
    fs::write(&path, text).unwrap();
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) });
    choose(&mut window, "Level 2");
    assert!(window.shown().tiles[1].scene.levels.is_some() && window.shown().scene.levels.is_none());
    let titles = |start: &str| {
        let all = window.harness.query_all_by_role(Role::Image);
        all.filter(|node| node.accesskit_node().label().is_some_and(|label| label.starts_with(start))).count()
    };
    assert_eq!(titles("Stage: Frame t+1 = 1 · level 2"), 1, "only that of the hierarchical search");
}

#[test]
fn a_session_keeps_the_level_and_a_picture_is_what_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window("[picture]\nlevel = 1\nview = \"next\"\n");
    assert!(stage(&window, "Frame t+1 = 1 · level 1, 160×120 px"));
    let look = Look { level: LevelShown::Number(1), view: Some(View::Next), ..Look::default() };
    for (name, what) in [("one.motionscope", OutputKind::Session), ("one.png", OutputKind::Picture)] {
        let path = folder.path().join(name);
        window.harness.state_mut().write(Order { what, path, scale: 1, look, panes: Selection::default() });
        window.settle();
    }
    let shown = window.shown();
    let (clip, estimator) = (&shown.subject.clip, &*shown.subject.experiment.estimator);
    let reverse = Reverse::new(estimator, clip, 0);
    let mut viewer = Viewer::new(&shown.subject.experiment, clip, &look, &reverse).unwrap();
    viewer.walk.jump(motionscope_core::run::Move::To(window.cursor()));
    let moment = viewer.moment(None).unwrap();
    let drawn = Rendering { moment: &moment, estimator, look: &look, panes: &Selection::default() }
        .encode(Format::Png, 1)
        .unwrap();
    assert!(fs::read(folder.path().join("one.png")).unwrap() == drawn, "the same pixels without the window");
    let session = Session::load(&folder.path().join("one.motionscope")).unwrap();
    assert_eq!(session.look.over(Look::default()).level, LevelShown::Number(1));
    let at_work = Look { level: LevelShown::AtWork, ..look };
    let at_work = Rendering { moment: &moment, estimator, look: &at_work, panes: &Selection::default() }
        .encode(Format::Png, 1)
        .unwrap();
    assert!(at_work != drawn, "level 2 is at work");
}

/// The picture of the pyramid, and what it is called.
fn pyramid(window: &Window) -> Option<(Rect, String)> {
    let all = window.harness.query_all_by_role(Role::Image);
    all.into_iter().find_map(|node| {
        let label = node.accesskit_node().label().filter(|label| label.starts_with("Pyramid. "))?;
        Some((node.rect(), label))
    })
}

#[test]
fn the_pyramid_stands_in_three_dimensions_and_a_click_puts_a_level_on_the_stage() {
    let mut window = window("");
    assert!(pyramid(&window).is_none());
    window.chart("Pyramid");
    let (rect, told) = pyramid(&window).expect("it is chosen");
    assert!(told.contains("Level 2, 80×60 px: best so far") && told.contains("Level 0, 320×240 px. Drag"), "{told}");
    // The highest plane is the coarsest level: the first one below the upper edge.
    let middle = rect.center().x - 0.15 * rect.width();
    choose(&mut window, "Level 0");
    let titles = ["Frame t = 0", "Frame t = 0 · level 1, 160×120 px", "Frame t = 0 · level 2, 80×60 px"];
    let mut seen = vec![0];
    for i in 1..14 {
        window.click_at(Pos2::new(middle, rect.min.y + rect.height() * i as f32 / 14.0));
        let level = titles.iter().position(|title| stage(&window, title)).expect("one of them is on the stage");
        seen.extend(Some(level).filter(|level| seen.last() != Some(level)));
    }
    assert_eq!(seen, [0, 2, 1, 0], "from the top down");
    choose(&mut window, "Level at work");
    window.command(Command::End);
    let (_, told) = pyramid(&window).expect("it stays");
    assert!(["Level 2, 80×60 px: found", "Level 1, 160×120 px: found"].iter().all(|part| told.contains(part)));
    window.drag(rect.center(), rect.center() + vec2(60.0, 20.0));
    assert!(stage(&window, "Frame t = 0"), "turning chooses nothing");
    window.chart("Cost surface");
    assert!(pyramid(&window).is_none());
}
