//! Single pixels that are pointed at, and held.

use super::files::{command_line, paint, write_to};
use super::*;
use motionscope::ui::model::snapshot::Pointed;
use motionscope::view::panes::Selection;
use motionscope::view::steps::Range;

/// A window on an estimator at a step, with further lines of its session.
fn window(estimator: &str, step: &str, clip: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let lines = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"{estimator}\"\nstep = \"{step}\"\n");
    fs::write(&path, lines).expect("it is written");
    Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) })
}

fn pointed(window: &Window) -> Option<Pointed> {
    window.shown().pointed
}

/// The place of the stage's first picture at these shares of its size.
fn on_stage(window: &Window, share: [f32; 2]) -> Pos2 {
    on_picture(window, "Frame t =", share)
}

/// The place of the stage's picture whose title begins so, at these shares of its size.
pub fn on_picture(window: &Window, title: &str, [x, y]: [f32; 2]) -> Pos2 {
    let rect = pane_of(window, title);
    // Beside the picture there may be more room, and above it is its title.
    let (width, height) = window.shown().pictures.pair[0].size();
    let size = vec2(width as f32, height as f32);
    let size = size * (rect.size() / size).min_elem();
    rect.center() + size * (vec2(x, y) - Vec2::splat(0.5))
}

/// Where the stage's picture lies whose title begins so.
pub fn pane_of(window: &Window, title: &str) -> Rect {
    let begins = |label: String| label.starts_with(&format!("Stage: {title}"));
    let mut pictures = window.harness.get_all_by_role(Role::Image);
    let stage = pictures.find(|node| node.accesskit_node().label().is_some_and(begins));
    stage.unwrap_or_else(|| panic!("{title} is not shown")).rect()
}

#[test]
fn a_click_on_the_other_frame_is_none_on_frame_t() {
    let mut window = window("normal-flow", "150.20", "synth:pillar");
    let before = window.sentence();
    window.key(Key::V);
    let next = on_picture(&window, "Frame t+1", [0.5, 0.3]);
    window.harness.hover_at(next);
    window.settle();
    assert!(window.sentence() == before, "the pixel of frame t at the same place is not explained");
    window.click_at(next);
    assert_eq!(pointed(&window), None);
    let message = window.app().message().unwrap_or_default();
    assert!(message.starts_with("Frame t+1 has no pixels") && message.ends_with("click on frame t."), "{message}");
}

#[test]
fn what_a_frame_is_compared_with_stands_beside_it() {
    for (estimator, title) in [("frame-difference", "Frame t−1 = 1"), ("running-average", "Background")] {
        let mut window = objects::window(estimator, "3.2");
        window.key(Key::Num1);
        let other = on_picture(&window, title, [0.5, 0.5]);
        assert!(on_stage(&window, [0.5, 0.5]).x != other.x, "{estimator}: both are seen");
        let folder = tempfile::tempdir().expect("a folder");
        let [mine, line, session] = ["mine.png", "line.png", "one.motionscope"].map(|name| folder.path().join(name));
        window.command(Command::ExportPicture);
        window.click_role(Role::Button, "Theme: dark");
        window.click_role(Role::Button, "1×");
        write_to(&mut window, &mine);
        window.command(Command::SaveSession);
        write_to(&mut window, &session);
        paint(&session, 1, &line);
        assert!(fs::read(&mine).expect("a picture") == fs::read(&line).expect("a picture"), "{estimator}");
    }
}

#[test]
fn a_pixel_of_the_background_is_explained_as_that_of_the_frame() {
    for (estimator, title) in [("frame-difference", "Frame t−1 = 1"), ("running-average", "Background")] {
        let mut window = objects::window(estimator, "3.2");
        window.key(Key::Num1);
        let [here, there] = ["Frame t =", title].map(|title| on_picture(&window, title, [0.5, 0.5]));
        let before = window.sentence();
        window.harness.hover_at(here);
        window.settle();
        let (told, at) = (window.sentence(), pointed(&window).expect("it is explained").at);
        window.harness.hover_at(there);
        window.settle();
        let same = pointed(&window).expect("it is explained there as well").at;
        assert!(told != before && window.sentence() == told, "{estimator}: the same pixel is told of");
        assert!(same.at == at.at && same.on != at.on, "{estimator}: {same:?} and not {at:?}");
        // A click on a small picture brings it forward.
        for _ in 0..2 {
            if pointed(&window).is_none_or(|pointed| !pointed.is_held) {
                window.click_at(on_picture(&window, title, [0.5, 0.5]));
            }
        }
        assert_eq!(pointed(&window).map(|pointed| (pointed.at, pointed.is_held)), Some((same, true)), "{estimator}");
        let folder = tempfile::tempdir().expect("a folder");
        let [mine, line, session] = ["mine.png", "line.png", "one.motionscope"].map(|name| folder.path().join(name));
        window.command(Command::ExportPicture);
        window.click_role(Role::Button, "Theme: dark");
        window.click_role(Role::Button, "1×");
        write_to(&mut window, &mine);
        window.command(Command::SaveSession);
        write_to(&mut window, &session);
        paint(&session, 1, &line);
        assert!(fs::read(&mine).expect("a picture") == fs::read(&line).expect("a picture"), "{estimator}");
    }
}

fn status(window: &Window) -> String {
    let line = window.harness.query_all_by_role(Role::Label).filter_map(|node| node.accesskit_node().value());
    line.into_iter().find(|line| line.contains(" % done")).expect("the status line")
}

#[test]
fn a_pixel_that_is_clicked_stays_explained() {
    let mut window = window("normal-flow", "150.20", "synth:pillar");
    let (cursor, high) = (window.cursor(), on_stage(&window, [0.5, 0.3]));
    window.harness.hover_at(high);
    window.settle();
    let hovered = pointed(&window).expect("it is explained while the pointer is on it");
    assert!(!hovered.is_held && status(&window).contains("click to pin it"));
    window.click_at(high);
    let held = pointed(&window).expect("it is held");
    assert!(held.is_held && held.at == hovered.at, "{held:?}");
    assert_eq!(window.cursor(), cursor, "the run stays where it was");
    let told = window.sentence();
    window.harness.hover_at(Pos2::new(700.0, 880.0));
    window.settle();
    assert!(window.sentence() == told, "it stays explained when the pointer goes elsewhere");
    assert!(status(&window).contains("Esc unpins it") && status(&window).contains("150 of 240 rows"));
    window.key(Key::Escape);
    assert_eq!(pointed(&window), None);
    assert!(window.sentence() != told && window.cursor() == cursor);
    window.click_at(high);
    window.harness.hover_at(Pos2::new(700.0, 880.0));
    window.key(Key::ArrowRight);
    assert_eq!(pointed(&window), None, "who steps hears of the next pixel");
}

#[test]
fn a_pixel_whose_turn_has_not_come_is_reported_when_it_is_clicked_only() {
    let mut window = window("lucas-kanade", "3.5", "synth:pillar");
    let before = window.sentence();
    let low = on_stage(&window, [0.5, 0.7]);
    window.harness.hover_at(low);
    window.settle();
    assert_eq!(pointed(&window), None);
    assert!(window.sentence() == before, "nothing of what comes is told");
    window.click_at(low);
    let at = pointed(&window).expect("the run has gone there").at.at;
    let Cursor { unit, event } = window.cursor();
    assert_eq!([(event - 1) as f32, unit as f32], at);
}

#[test]
fn an_iteration_goes_on_about_the_pixel_that_is_held() {
    let mut window = window("horn-schunck", "2.1", "synth:pillar,frames=2");
    let place = on_stage(&window, [0.4, 0.4]);
    window.click_at(place);
    let held = pointed(&window).expect("it is held");
    window.harness.hover_at(Pos2::new(700.0, 880.0));
    window.key(Key::ArrowRight);
    assert_eq!(pointed(&window), Some(held), "all pixels change at every step");
}

/// Holds a pixel of `estimator` at `step` in a picture with a caption, and saves that; gives the window and the file.
fn held(folder: &Path, estimator: &str, step: &str) -> (Window, std::path::PathBuf) {
    let file = folder.join("lesson.motionscope");
    let lines = format!(
        "motionscope = 1\nclip = \"synth:pillar,frames=2\"\nestimator = \"{estimator}\"\nstep = \"{step}\"\n\
         [picture]\ncaption = true\n"
    );
    fs::write(&file, lines).expect("it is written");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(file.clone().into()) });
    let place = on_stage(&window, [0.4, 0.3]);
    window.click_at(place);
    window.harness.hover_at(Pos2::new(700.0, 880.0));
    window.command(Command::SaveSession);
    write_to(&mut window, &file);
    (window, file)
}

#[test]
fn a_pixel_that_is_held_stays_held_in_a_session() {
    for (estimator, step) in [("horn-schunck", "2.1"), ("normal-flow", "150.20")] {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut window, file) = held(folder.path(), estimator, step);
        let pixel = pointed(&window).filter(|pixel| pixel.is_held).expect("it is held");
        let [mine, line, other] = ["window.png", "line.png", "other.png"].map(|name| folder.path().join(name));
        window.command(Command::ExportPicture);
        window.click_role(Role::Button, "Theme: dark");
        window.click_role(Role::Button, "1×");
        write_to(&mut window, &mine);

        let mut again = Window::with(vec2(1440.0, 900.0), Start { open: Some(file.clone().into()) });
        assert_eq!(pointed(&again), Some(pixel), "{estimator}");
        assert!(again.sentence() == window.sentence(), "{estimator}: another step is told");
        assert!(status(&again).contains("Esc unpins it"));
        paint(&file, 1, &line);
        assert!(fs::read(&mine).expect("a picture") == fs::read(&line).expect("a picture"), "the pictures differ");

        // The same session with none.
        let free = folder.path().join("free.motionscope");
        let mut session = Session::load(&file).expect("a session");
        session.position.held = None;
        session.save(&free).expect("it is written");
        paint(&free, 1, &other);
        assert!(fs::read(&mine).expect("a picture") != fs::read(&other).expect("a picture"), "the pixel is not seen");
        again.harness.state_mut().open(&free);
        again.settle();
        assert_eq!(pointed(&again), None, "what another session held is let go");
        assert!(again.sentence() != window.sentence());
    }
}

#[test]
fn steps_are_written_about_the_pixel_that_is_held() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut window, file) = held(folder.path(), "horn-schunck", "2.1");
    let [mine, lines] = ["mine", "lines"].map(|name| folder.path().join(name));
    let look = Session::load(&file).expect("a session").look.over(Look::default());
    let (from, to) = (Cursor { unit: 1, event: 1 }, Cursor { unit: 3, event: 1 });
    let granularity = window.shown().info.granularities.len() - 1;
    let what = OutputKind::Steps(Range { from, to, granularity }, Format::Png);
    window.harness.state_mut().write(Order { what, path: mine.clone(), scale: 1, look, panes: Selection::default() });
    window.settle();
    let words = ["motionscope", "export", "LESSON", "--steps", "2.1..4.1", "--out", "LINES"].map(|word| match word {
        "LESSON" => file.as_os_str(),
        "LINES" => lines.as_os_str(),
        word => word.as_ref(),
    });
    command_line(&words);
    let line = folder.path().join("line.png");
    paint(&file, 1, &line);
    let read = |file: &Path| fs::read(file).expect("a picture");
    assert!(read(&mine.join("step_00000.png")) == read(&line), "the first is that of the session");
    let count = fs::read_dir(&mine).expect("the folder").count();
    assert!(count > 2 && fs::read_dir(&lines).expect("the folder").count() == count);
    for index in 0..count {
        let name = format!("step_{index:05}.png");
        assert!(read(&mine.join(&name)) == read(&lines.join(&name)), "{name}: the pictures differ");
    }
    // The last is about the same pixel as well.
    let Pointed { at, .. } = pointed(&window).expect("it is held");
    window.harness.state_mut().open(&file);
    window.settle();
    window.command(Command::Over);
    window.command(Command::Over);
    assert_eq!(pointed(&window).map(|pointed| pointed.at), Some(at));
}

#[test]
fn a_click_on_a_block_goes_to_the_block() {
    let mut window = window("full-search", "3.5", "synth:pillar");
    window.command(Command::FocusNever);
    // Frame t is the small one of a search: the first click brings it forward.
    for _ in 0..2 {
        window.click_at(on_stage(&window, [0.5, 0.5]));
    }
    assert!(window.cursor().unit > 100 && pointed(&window).is_none());
}

#[test]
fn another_estimator_keeps_its_own_defaults() {
    let mut window = window("lucas-kanade", "3.5", "synth:pillar,frames=2");
    let iterations = |window: &Window| window.value("iterations");
    assert_eq!(iterations(&window), Value::Int(2));
    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("horn");
    window.settle();
    window.key(Key::Enter);
    assert_eq!(window.app().document().estimator().info().id, "horn-schunck");
    assert_eq!(iterations(&window), Value::Int(20));
}

#[test]
fn a_clip_on_which_nothing_runs_is_open_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    for t in 0..2 {
        image::RgbImage::new(1, 1).save(folder.path().join(format!("{t}.png"))).expect("it is written");
    }
    let window = Window::with(vec2(1440.0, 900.0), Start { open: Some(folder.path().into()) });
    assert!(window.app().view().shown.is_none() && window.app().view().refused.is_some());
    assert!(window.harness.query_by_label_contains("Open a clip to begin").is_none());
    assert!(window.harness.query_by_label_contains("No clip is open").is_none());
    assert!(window.harness.query_by_label_contains("choose another estimator").is_some());
}

#[test]
fn plots_are_seen_one_at_a_time_where_there_is_little_room() {
    let mut window = window("horn-schunck", "3.2", "synth:pillar,frames=2");
    window.click_role(Role::Tab, "Plot");
    window.click("Mean change");
    assert!(window.harness.query_by_label_contains("Mean change, px, mean change").is_some(), "its plot is shown");
    assert!(window.harness.query_by_label_contains("Mean endpoint error, px, error").is_none(), "and no other");
}

#[test]
fn the_displacements_of_a_field_are_counted_at_the_end() {
    let mut window = window("normal-flow", "3.2", "synth:pillar,frames=2");
    window.command(Command::End);
    window.click_role(Role::Tab, "Histogram");
    assert!(window.harness.query_all_by_label_contains(" pixels, ").next().is_some(), "the counts tell themselves");
}

#[test]
fn what_only_an_end_shows_is_not_looked_at_in_another_clip() {
    let mut window = window("normal-flow", "3.2", "synth:pillar,frames=2");
    window.command(Command::End);
    window.command(Command::Residual);
    let shows =
        |window: &Window, what: &str| window.harness.query_by_label_contains(&format!("Stage: {what}")).is_some();
    assert!(shows(&window, "|frame 0 − its prediction|"));
    window.harness.state_mut().open("synth:flag,frames=2");
    window.settle();
    window.command(Command::End);
    assert!(!shows(&window, "|frame 0 − its prediction|"));
}

#[test]
fn a_flow_is_compared_with_its_kin_and_copied_for_a_spreadsheet() {
    let mut window = window("lucas-kanade", "3.2", "synth:pillar,frames=2");
    window.harness.key_press(Key::C);
    window.compared();
    assert!(window.harness.query_by_label("969.2").is_none(), "no block search is proposed");
    window.harness.get_by_label("Copy as CSV").click();
    window.harness.step();
    let copied = window.harness.output().platform_output.commands.iter().find_map(|command| match command {
        eframe::egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.expect("it is in the clipboard");
    assert!(
        copied.starts_with("estimator,")
            && copied.contains(",known,")
            && copied.lines().any(|line| line.starts_with("lucas-kanade,")),
        "{copied}"
    );
}
