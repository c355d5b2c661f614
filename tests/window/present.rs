//! Presenting to a class: the pointer, the pen, full screen, and the presenter's window.

use eframe::egui::Shape;
use motionscope::paint::{Color, Freehand, Ground, PenColor};
use motionscope::view::panes::charts;
use motionscope_core::scene::Picture;

use super::files::command_line;
use super::*;

/// A window that shows frame t alone, whole, in the middle of a search.
fn at_frame_t() -> Window {
    let mut window = Window::usual();
    window.command(Command::FocusNever);
    window.key(Key::Num2);
    window
}

/// Where pixel `at` of the only picture lies in the window.
fn on_screen(window: &Window, at: [f32; 2]) -> Pos2 {
    let stage = window.harness.get_by_label_contains("Stage: ").rect();
    let (width, height) = window.shown().pictures.pair[0].size();
    let size = vec2(width as f32, height as f32);
    // A picture that fits is as large as its pane.
    let scale = (stage.size() / size).min_elem();
    stage.center() + scale * (vec2(at[0], at[1]) + vec2(0.5, 0.5) - size / 2.0)
}

fn draw(window: &mut Window, from: [f32; 2], to: [f32; 2]) {
    let (from, to) = (on_screen(window, from), on_screen(window, to));
    window.harness.hover_at(from);
    window.harness.run_steps(1);
    window.drag(from, to);
}

/// Saves what the window shows, and returns it.
fn save(window: &mut Window, what: OutputKind, path: &Path) -> Vec<u8> {
    let look = window.app().settings().look;
    let order = Order { what, path: path.to_owned(), scale: 1, look, panes: Selection::default() };
    window.harness.state_mut().write(order);
    window.harness.state_mut().wait();
    fs::read(path).unwrap_or_default()
}

#[test]
fn ink_is_drawn_on_the_picture_that_it_lies_on() {
    let mut window = at_frame_t();
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    let ink = window.app().ink();
    assert_eq!(ink.len(), 1, "a line, and the picture is not moved");
    let line = &ink[0];
    assert_eq!(
        (line.on, line.member, line.color, line.step),
        (Ground::Picture(Picture::CURRENT), 0, PenColor::Vermilion, window.cursor())
    );
    let ends = [line.points[0], *line.points.last().expect("an end")];
    for (end, wanted) in ends.into_iter().zip([[60.0, 80.0], [140.0, 120.0]]) {
        assert!((0..2).all(|i| (end[i] - wanted[i]).abs() < 2.0), "{end:?} for {wanted:?}");
    }
    // Zoom and another layout leave it where it lies on the picture.
    let before = window.app().ink().to_vec();
    window.key(Key::Plus);
    window.key(Key::L);
    assert_eq!(window.app().ink(), before);
}

#[test]
fn ink_goes_and_comes_with_its_step() {
    let mut window = at_frame_t();
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    let here = window.cursor();
    window.key(Key::ArrowRight);
    assert!(window.app().ink().is_empty() && window.cursor() != here);
    window.key(Key::ArrowLeft);
    assert_eq!((window.app().ink().len(), window.cursor()), (1, here));
}

#[test]
fn the_pen_has_its_own_undo_its_colours_and_a_way_out() {
    let mut window = at_frame_t();
    let block = window.value("block-size");
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    window.key(Key::K);
    draw(&mut window, [60.0, 120.0], [140.0, 80.0]);
    let colors = |window: &Window| window.app().ink().iter().map(|line| line.color).collect::<Vec<_>>();
    assert_eq!(colors(&window), [PenColor::Vermilion, PenColor::Yellow]);
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(colors(&window), [PenColor::Vermilion]);
    window.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(colors(&window).len(), 2);
    window.press(Modifiers::SHIFT, Key::W);
    assert!(colors(&window).is_empty());
    window.click_role(Role::Button, "Undo ink");
    assert_eq!(colors(&window).len(), 2, "clearing is undone as well");
    window.click("Pen colour: blue");
    window.click_at(on_screen(&window, [100.0, 60.0]));
    let ink = window.app().ink();
    assert_eq!(ink.last().map(|dot| (dot.color, dot.points.len())), Some((PenColor::Blue, 1)), "a click is a dot");
    assert_eq!(window.value("block-size"), block, "no parameter was undone");
    let cursor = window.cursor();
    window.key(Key::Escape);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    assert_eq!((window.app().ink().len(), window.cursor()), (3, cursor), "the mouse moves the picture again");
}

#[test]
fn ink_is_the_same_by_session_on_the_command_line_and_in_the_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let mut window = at_frame_t();
    let plain = save(&mut window, OutputKind::Picture, &path("plain.png"));
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    let inked = save(&mut window, OutputKind::Picture, &path("window.png"));
    assert!(!plain.is_empty() && plain != inked, "the ink is in the picture");
    save(&mut window, OutputKind::Session, &path("kept.motionscope"));
    let kept = Session::load(&path("kept.motionscope")).expect("a session");
    assert_eq!(kept.freehand, Freehand { lines: window.app().ink().to_vec() });
    let [session, picture] = ["kept.motionscope", "line.png"].map(|name| path(name).into_os_string());
    command_line(&["motionscope".as_ref(), "run".as_ref(), &session, "--overlay".as_ref(), &picture]);
    assert!(fs::read(path("line.png")).expect("a picture") == inked, "another picture on the command line");
    let mut again = Window::with(vec2(1440.0, 900.0), Start { open: Some(session) });
    assert_eq!(again.app().ink(), window.app().ink(), "the session brings it back");
    assert!(save(&mut again, OutputKind::Picture, &path("again.png")) == inked);
    for (name, text) in [("a.svg", "#d55e00"), ("a.pdf", "%PDF")] {
        let bytes = save(&mut window, OutputKind::Picture, &path(name));
        assert!(String::from_utf8_lossy(&bytes).to_lowercase().contains(&text.to_lowercase()), "{name}");
    }
}

#[test]
fn the_chart_of_the_full_screen_is_drawn_on_and_keeps_its_ink() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("chart.motionscope");
    let mut window = Window::usual();
    window.key(Key::W);
    let chart = |window: &Window| window.region(Region::Chart);
    let across = |window: &mut Window| {
        let middle = chart(window).center();
        window.harness.hover_at(middle);
        window.harness.run_steps(1);
        window.drag(middle, middle + vec2(40.0, 20.0));
    };
    across(&mut window);
    assert!(window.app().ink().is_empty(), "beside the menus a chart is worked with");
    window.command(Command::Present);
    let here = window.cursor();
    across(&mut window);
    let ink = window.app().ink().to_vec();
    assert_eq!((ink.len(), window.cursor()), (1, here), "a line, and no click on the chart");
    let Ground::Chart { size: [width, height], .. } = ink[0].on else { panic!("{:?}", ink[0].on) };
    let area = chart(&window);
    assert!(width <= area.width() && height <= area.height() && width > 0.8 * area.width(), "{area} {width}×{height}");
    let ends = [ink[0].points[0], *ink[0].points.last().expect("an end")];
    assert!((ends[1][0] - ends[0][0] - 40.0).abs() < 4.0 && (ends[1][1] - ends[0][1] - 20.0).abs() < 4.0, "{ends:?}");
    window.key(Key::ArrowRight);
    assert!(window.app().ink().is_empty(), "another step");
    window.key(Key::ArrowLeft);
    assert_eq!(window.app().ink(), ink);
    save(&mut window, OutputKind::Session, &file);
    assert_eq!(Session::load(&file).expect("a session").freehand, Freehand { lines: ink });
    window.press(Modifiers::SHIFT, Key::W);
    assert!(window.app().ink().is_empty(), "it is cleared with the step");
}

#[test]
fn a_session_without_ink_leaves_what_was_drawn_on_its_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let bare = folder.path().join("bare.motionscope");
    let mut window = at_frame_t();
    save(&mut window, OutputKind::Session, &bare);
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    let ink = window.app().ink().to_vec();
    window.harness.state_mut().open(bare.as_os_str());
    window.settle();
    assert_eq!((ink.len(), window.app().ink()), (1, &ink[..]));
}

#[test]
fn a_range_of_steps_has_the_ink_of_each() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = at_frame_t();
    let at = window.cursor();
    let range = Range { from: at, to: Cursor { event: at.event + 1, ..at }, granularity: 2 };
    let steps = OutputKind::Steps(range, Format::Png);
    let read = |folder: &Path| [0, 1].map(|i| fs::read(folder.join(format!("step_{i:05}.png"))).expect("a picture"));
    let [bare, inked] = ["bare", "inked"].map(|name| folder.path().join(name));
    save(&mut window, steps, &bare);
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
    save(&mut window, steps, &inked);
    let (bare, inked) = (read(&bare), read(&inked));
    assert!(bare[0] != inked[0] && bare[1] == inked[1], "only the step that was drawn on has ink");
}

#[test]
fn the_pointer_leaves_the_explanation_as_it_is() {
    let mut window = at_frame_t();
    let before = window.sentence();
    window.key(Key::O);
    window.harness.hover_at(on_screen(&window, [200.0, 60.0]));
    window.settle();
    assert_eq!(window.sentence(), before);
    let hidden =
        |window: &Window| window.harness.output().platform_output.cursor_icon == eframe::egui::CursorIcon::None;
    assert!(hidden(&window), "the dot stands for the arrow");
    let chart = window.region(Region::Chart).center();
    window.harness.hover_at(chart);
    window.settle();
    assert!(hidden(&window), "over a chart as well");
    window.key(Key::Escape);
    window.harness.hover_at(on_screen(&window, [200.0, 60.0]));
    window.settle();
    assert!(!hidden(&window));
}

#[test]
fn for_the_class_there_is_nothing_but_stage_chart_and_caption() {
    for size in [vec2(1280.0, 720.0), vec2(1920.0, 1080.0)] {
        for theme in [Command::ProjectorTheme, Command::DarkTheme, Command::LightTheme] {
            let mut window = Window::new(size);
            window.command(theme);
            let pictures = |window: &Window| {
                let all = window.app().regions().iter().filter(|(region, _)| *region == Region::Pictures);
                all.map(|(_, rect)| rect.area()).sum::<f32>() * window.harness.ctx.zoom_factor().powi(2)
            };
            let before = pictures(&window);
            window.key(Key::F5);
            let regions: Vec<_> = window.app().regions().iter().map(|(region, _)| *region).collect();
            let none = [Region::Header, Region::Transport, Region::Status, Region::Parameters];
            assert!(none.iter().all(|region| !regions.contains(region)), "{regions:?}");
            assert!([Region::Stage, Region::Strip].iter().all(|region| regions.contains(region)));
            assert!(pictures(&window) > before, "{theme:?} {size}: the pictures have not grown");
            for (key, chart) in [(Key::Num3, 2), (Key::Num1, 0)] {
                window.key(key);
                let shown = window.shown();
                let all = charts(&shown.step, shown.subject.experiment.estimator.charts());
                assert_eq!(window.app().settings().charts.seen(&all, 1), [all[chart]], "it is chosen by its number");
                assert!(window.has(Region::Chart), "and seen");
            }
            let before = window.cursor();
            window.key(Key::PageDown);
            assert!(window.cursor() > before, "the clicker steps");
            window.key(Key::Escape);
            assert!(window.has(Region::Header) && window.has(Region::Transport));
        }
    }
}

/// Everything that is painted.
fn painted_shapes(window: &Window) -> Vec<&Shape> {
    fn add<'a>(shape: &'a Shape, all: &mut Vec<&'a Shape>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, all)),
            shape => all.push(shape),
        }
    }
    let mut all = Vec::new();
    window.harness.output().shapes.iter().for_each(|clipped| add(&clipped.shape, &mut all));
    all
}

/// Width and height of every line that is painted.
fn painted_lines(window: &Window) -> Vec<Vec2> {
    let size = |shape: &Shape| match shape {
        Shape::Path(path) => Some(Rect::from_points(&path.points).size()),
        _ => None,
    };
    painted_shapes(window).into_iter().filter_map(size).collect()
}

/// How many lines are painted that are as large as the one drawn last on a chart.
fn painted_ink(window: &Window) -> usize {
    let line = window.app().ink().last().expect("a line");
    let points: Vec<Pos2> = line.points.iter().map(|point| Pos2::from(*point)).collect();
    let size = Rect::from_points(&points).size();
    painted_lines(window).iter().filter(|painted| (**painted - size).abs().max_elem() < 1.0).count()
}

/// The view of the chart `pane`, on which the last line was drawn.
fn view_of_ink(window: &Window, wanted: &str) -> Option<[f32; Ground::VIEW]> {
    match window.app().ink().last().map(|line| line.on) {
        Some(Ground::Chart { pane, view, .. }) if pane == wanted => view,
        other => panic!("{other:?} is not on {wanted}"),
    }
}

fn drag_on_chart(window: &mut Window, by: Vec2) {
    if !window.has(Region::Chart) {
        window.key(Key::N);
    }
    layout::close_messages(window);
    let middle = window.region(Region::Chart).center();
    window.harness.hover_at(middle);
    window.harness.run_steps(1);
    window.drag(middle, middle + by);
}

#[test]
fn ink_on_a_chart_is_seen_from_where_it_was_drawn_alone() {
    let mut window = Window::usual();
    window.command(Command::Present);
    window.key(Key::Num2);
    let by = vec2(120.0, 60.0);
    window.key(Key::W);
    drag_on_chart(&mut window, by);
    assert_eq!(view_of_ink(&window, "surface-3d"), None);
    let drawn = painted_ink(&window);
    assert!(drawn > 0, "it is painted");
    window.key(Key::W);
    drag_on_chart(&mut window, by);
    assert_eq!((window.app().ink().len(), painted_ink(&window)), (1, 0), "the surface is turned");
    window.key(Key::W);
    drag_on_chart(&mut window, by);
    assert!(view_of_ink(&window, "surface-3d").is_some());
    assert_eq!((window.app().ink().len(), painted_ink(&window)), (2, drawn), "what was drawn from here alone");
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!((window.app().ink().len(), painted_ink(&window)), (1, 0));
    window.key(Key::W);
    let middle = window.region(Region::Chart).center();
    window.harness.hover_at(middle);
    for _ in 0..2 {
        window.harness.drag_at(middle);
        window.harness.drop_at(middle);
    }
    window.settle();
    assert_eq!((window.app().ink().len(), painted_ink(&window)), (1, drawn), "a double click turns it back");
}

#[test]
fn a_line_on_a_chart_that_is_left_halfway_is_none() {
    for leave in [Command::Present, Command::Into] {
        let mut window = Window::usual();
        window.command(Command::Present);
        window.key(Key::W);
        let here = window.cursor();
        let middle = window.region(Region::Chart).center();
        window.harness.hover_at(middle);
        window.harness.drag_at(middle);
        window.harness.hover_at(middle + vec2(30.0, 20.0));
        window.settle();
        window.command(leave);
        if leave == Command::Present {
            assert!(window.has(Region::Header), "the menus are there again");
            window.command(Command::Present);
        }
        window.harness.hover_at(middle + vec2(60.0, 20.0));
        window.harness.drop_at(middle + vec2(60.0, 20.0));
        window.settle();
        assert!(window.app().ink().is_empty(), "{leave:?}: half a line");
        if leave == Command::Into {
            window.key(Key::ArrowLeft);
        }
        assert_eq!((window.cursor(), window.app().ink().len()), (here, 0), "{leave:?}: half a line");
        drag_on_chart(&mut window, vec2(60.0, 20.0));
        assert_eq!(window.app().ink().len(), 1, "{leave:?}: the next line is whole");
    }
}

#[test]
fn matrices_below_are_announced_by_a_bright_bar_and_ink_goes_with_those_above() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let lines = "motionscope = 1\nclip = \"synth:traffic\"\nestimator = \"kalman-filter\"\nstep = \"3.3\"\n\
                 [set]\nmotion = \"acceleration\"\n[picture]\ntheme = \"projector\"\n";
    fs::write(&path, lines).expect("it is written");
    let mut window = Window::with(vec2(900.0, 600.0), Start { open: Some(path.into()) });
    window.command(Command::Present);
    let chart = window.region(Region::Chart);
    let is_bar = |shape: &&Shape| match shape {
        Shape::Rect(bar) => {
            let is_narrow = bar.rect.width() < 10.0 && bar.rect.height() > 0.15 * chart.height();
            let color = Color(bar.fill.to_array());
            is_narrow && chart.contains_rect(bar.rect) && color.contrast(Theme::Projector.chrome().panel) > 4.5
        }
        _ => false,
    };
    assert_eq!(painted_shapes(&window).into_iter().filter(is_bar).count(), 1, "there is more below");
    window.key(Key::W);
    drag_on_chart(&mut window, vec2(60.0, 40.0));
    assert_eq!(view_of_ink(&window, "matrices"), None);
    let drawn = painted_ink(&window);
    assert!(drawn > 0, "it is painted");
    let mut scroll = |by: f32| {
        window.harness.hover_at(chart.center());
        window.harness.run_steps(1);
        window.harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            source: MouseWheelSource::Unknown,
            delta: vec2(0.0, by),
            phase: TouchPhase::Move,
            modifiers: Modifiers::NONE,
        });
        window.harness.run_steps(90);
        window.settle();
        painted_ink(&window)
    };
    assert_eq!(scroll(-300.0), 0, "what it was drawn on is scrolled away");
    assert_eq!(scroll(600.0), drawn);
}

#[test]
fn the_magnifying_glass_shows_ink_three_times_as_large() {
    let mut window = at_frame_t();
    window.key(Key::W);
    draw(&mut window, [60.0, 80.0], [140.0, 90.0]);
    window.key(Key::Escape);
    let points: Vec<Pos2> = window.app().ink()[0].points.iter().map(|point| Pos2::from(*point)).collect();
    let scale = on_screen(&window, [1.0, 0.0]).x - on_screen(&window, [0.0, 0.0]).x;
    let drawn = scale * Rect::from_points(&points).size();
    let count = |window: &mut Window, times: f32| {
        window.harness.hover_at(on_screen(window, [100.0, 85.0]));
        window.settle();
        let is_one = |size: &&Vec2| (**size - times * drawn).abs().max_elem() < 0.05 * times * drawn.x;
        painted_lines(window).iter().filter(is_one).count()
    };
    let before = [count(&mut window, 1.0), count(&mut window, 3.0)];
    window.key(Key::Z);
    let under = [count(&mut window, 1.0), count(&mut window, 3.0)];
    assert!(before[0] > 0 && under[0] >= before[0], "the line in the picture: {before:?}, {under:?}");
    assert!(under[1] > before[1], "the line under the glass: {before:?}, {under:?}");
}

#[test]
fn the_pen_draws_under_the_magnifying_glass() {
    let mut window = at_frame_t();
    let painted = |window: &mut Window| {
        window.harness.hover_at(on_screen(window, [100.0, 60.0]));
        window.settle();
        window.harness.output().shapes.len()
    };
    for present in [false, true] {
        if present {
            window.key(Key::F5);
        }
        let before = painted(&mut window);
        window.key(Key::Z);
        assert!(painted(&mut window) > before, "the glass is painted over the picture");
        window.key(Key::W);
        draw(&mut window, [60.0, 80.0], [140.0, 120.0]);
        assert_eq!(window.app().ink().len(), 1 + usize::from(present), "the pen draws under the glass");
        window.key(Key::Escape);
        window.key(Key::Escape);
    }
    window.key(Key::Escape);
    assert!(window.has(Region::Header), "pen, glass and full screen are left one by one");
}

#[test]
fn the_tip_of_the_full_screen_lies_on_no_picture() {
    let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some("lesson:kalman-filter/4".into()) });
    window.command(Command::ProjectorTheme);
    let middle = window.harness.get_by_label_contains("Stage: ").rect().center();
    window.harness.hover_at(middle);
    window.settle();
    window.command(Command::Present);
    let pictures = window.region(Region::Pictures);
    let crosses: Vec<Rect> = window.harness.query_all_by_label("Close message").map(|node| node.rect()).collect();
    assert_eq!(crosses.len(), 1, "what introduces the window goes");
    assert!(!pictures.intersects(crosses[0]), "{:?} on {pictures:?}", crosses[0]);
    layout::close_messages(&mut window);
    for _ in 0..2 {
        window.command(Command::Present);
    }
    assert_eq!(window.harness.query_all_by_label("Close message").count(), 0, "the hint is shown once");
}

/// A window at a page of a lesson that has notes.
fn at_page_with_notes() -> Window {
    let lesson = motionscope::session::lesson::all();
    let with_notes = |lesson: &&motionscope::session::lesson::Lesson| {
        lesson.pages.iter().take(3).position(|page| !page.notes.is_empty() && page.session.is_ok())
    };
    let found = lesson.iter().find_map(|lesson| Some((lesson, with_notes(&lesson)?)));
    let (lesson, page) = found.expect("a lesson has notes");
    let name = format!("lesson:{}/{}", lesson.slug, page + 1);
    Window::with(vec2(1440.0, 900.0), Start { open: Some(name.into()) })
}

#[test]
fn the_presenter_sees_the_notes_and_the_class_does_not() {
    let mut window = at_page_with_notes();
    window.click_role(Role::Button, "Notes");
    assert!(window.harness.query_by_label("Close presenter's window").is_none());
    window.press(Modifiers::SHIFT, Key::F);
    let notes = window.harness.query_all_by_label("Notes").count();
    assert_eq!(notes, 1, "the heading in the presenter's window alone");
    assert!(window.harness.query_by_label("Close presenter's window").is_some());
    window.click("Close presenter's window");
    assert!(window.harness.query_by_label("Close presenter's window").is_none());
    assert!(window.harness.query_by_role_and_label(Role::Button, "Notes").is_some(), "the class has them again");
}

#[test]
fn the_presenter_knows_the_next_step_before_the_class() {
    let mut window = Window::usual();
    window.press(Modifiers::SHIFT, Key::F);
    for _ in 0..3 {
        window.settle();
        window.app().wait_for_next();
        window.settle();
        let here = window.cursor();
        let next = window.harness.get_by_label_contains("Next · step").accesskit_node().value().expect("a heading");
        assert_eq!(window.cursor(), here, "the class stays where it is");
        window.click_role(Role::Button, "Next step");
        assert_eq!(next, format!("Next · step {}", window.cursor()));
        let said = window.shown().step.sentence.plain();
        assert!(window.harness.query_all_by_label(&said).next().is_some(), "{said}");
    }
    window.key(Key::End);
    assert!(window.harness.query_by_label("The run ends here.").is_some());
}

#[test]
fn the_presenters_window_rests_but_for_its_clock() {
    let mut window = Window::usual();
    window.press(Modifiers::SHIFT, Key::F);
    window.settle();
    window.app().wait_for_next();
    window.settle();
    // New marks are lit for a moment.
    window.harness.run_steps(90);
    let rest = window.harness.output().viewport_output.values().map(|viewport| viewport.repaint_delay).min();
    // Two frames of 60 in a second are nearer together.
    assert!(rest.is_some_and(|rest| rest >= Duration::from_millis(40)), "{rest:?}");
}

#[test]
fn a_clicker_blanks_the_full_screen_and_the_next_key_only_shows_it_again() {
    for key in [Key::Period, Key::B] {
        let mut window = Window::usual();
        window.command(Command::Present);
        let (frame, at) = (window.app().document().frame(), window.cursor());
        window.key(key);
        assert!(window.app().presentation().is_blank, "{key:?} blanks");
        assert!(window.app().document().side_by_side().is_empty(), "{key:?} starts no lockstep");
        window.key(Key::PageDown);
        assert!(!window.app().presentation().is_blank);
        assert_eq!((window.app().document().frame(), window.cursor()), (frame, at), "the key does nothing else");
        window.key(Key::PageDown);
        assert_ne!(window.cursor(), at);
    }
}
