//! The start page, and the hint for a new user.

use motionscope::session::lesson::{all, chapters};
use motionscope_core::course::estimators;
use motionscope_core::synth::SCENES;

use super::*;

const SIZE: Vec2 = vec2(1280.0, 720.0);

/// A new window at its start page.
fn fresh(memory: Option<Memory>) -> Window {
    let mut window = Window::begun(SIZE, Start::default(), memory);
    seen(&mut window);
    window
}

/// Draws until all pictures of the page are there.
fn seen(window: &mut Window) {
    let begun = Instant::now();
    while !window.app().is_settled() {
        window.harness.run_steps(1);
        assert!(begun.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn saved(window: &mut Window) -> Memory {
    let mut memory = Memory::default();
    eframe::App::save(window.harness.state_mut(), &mut memory);
    memory
}

#[test]
fn a_new_user_steps_through_a_search_there_and_back_with_a_few_keys() {
    let mut window = fresh(Some(Memory::default()));
    assert!(window.app().is_at_start() && window.app().document().clip().is_none(), "nothing is opened unseen");
    window.key(Key::ArrowRight);
    window.key(Key::Enter);
    assert!(!window.app().is_at_start());
    let name = &window.app().document().clip().expect("a clip").info().name;
    assert!(name.contains(SCENES[1].title.split(':').next().expect("a title")), "{name}");
    let (before, hint) = (window.cursor(), |window: &Window| window.harness.query_by_label("forward").is_some());
    assert!(hint(&window), "the hint tells of the keys");
    window.key(Key::ArrowRight);
    window.key(Key::ArrowRight);
    assert!(window.cursor() != before && hint(&window));
    window.key(Key::ArrowLeft);
    assert!(!hint(&window), "it goes by itself");
    let memory = saved(&mut window);
    let mut again = fresh(Some(memory));
    again.key(Key::Escape);
    assert!(!hint(&again), "and never comes back");
}

#[test]
fn escape_leads_to_the_bundled_clip_and_to_what_was_open() {
    let mut window = fresh(None);
    window.key(Key::Escape);
    assert!(!window.app().is_at_start());
    assert!(window.shown().subject.experiment.source.to_string().contains("pillar"));
    window.key(Key::ArrowRight);
    let before = window.sentence();
    window.command(Command::StartPage);
    assert!(window.app().is_at_start() && !window.has(Region::Transport));
    for key in [Key::End, Key::PageDown, Key::X, Key::Q, Key::F5] {
        window.key(key);
        assert!(window.app().is_at_start(), "{key:?}");
    }
    window.key(Key::Escape);
    assert!(window.sentence() == before, "nothing was done to the run below the page");
    assert!(window.has(Region::Header) && !window.has(Region::Question), "nor to how it is shown");
}

#[test]
fn space_opens_the_clip_that_has_the_keyboard() {
    let mut window = fresh(None);
    window.key(Key::Escape);
    window.command(Command::StartPage);
    window.key(Key::Space);
    assert!(!window.app().is_at_start());
    let name = &window.app().document().clip().expect("a clip").info().name;
    assert!(name.contains(SCENES[0].title.split(':').next().expect("a title")), "{name}");
}

#[test]
fn steps_that_are_not_taken_are_no_practice() {
    let mut window = fresh(Some(Memory::default()));
    window.key(Key::Escape);
    window.key(Key::Home);
    assert_eq!(window.cursor(), Cursor::default());
    (0..3).for_each(|_| window.command(Command::IntoBack));
    window.key(Key::ArrowRight);
    let has_hint = |window: &Window| window.harness.query_by_label("forward").is_some();
    assert!(has_hint(&window), "there was no step back");
    window.key(Key::ArrowLeft);
    assert!(!has_hint(&window));
}

#[test]
fn no_page_of_a_lesson_is_turned_below_the_start_page() {
    let mut window = Window::with(SIZE, Start { open: Some("lesson:sequential-search".into()) });
    let (page, before, is_asked) = (lessons::page(&window), window.sentence(), window.has(Region::Question));
    window.command(Command::StartPage);
    for command in [Command::NextUnit, Command::Into, Command::Present, Command::Predict] {
        // As by a button of the presenter's window.
        window.command(command);
        assert!(window.app().is_at_start(), "{command:?}");
    }
    window.key(Key::Escape);
    assert_eq!(lessons::page(&window), page);
    assert!(window.sentence() == before && window.has(Region::Header) && window.has(Region::Question) == is_asked);
}

#[test]
fn a_lesson_is_reached_with_arrows_and_opened_again_from_the_list() {
    let mut window = fresh(None);
    // Past the clips and two rows of families.
    for _ in 0..4 {
        window.key(Key::ArrowDown);
    }
    window.key(Key::Enter);
    assert!(!window.app().is_at_start() && window.has(Region::Lesson));
    window.press(Modifiers::COMMAND, Key::PageDown);
    let memory = saved(&mut window);
    let mut again = fresh(Some(memory));
    let label = |node: egui_kittest::Node<'_>| node.accesskit_node().label();
    let lesson =
        again.harness.query_all_by_label_contains("lesson, page 2").next().and_then(label).expect("it is listed");
    again.click(&lesson);
    assert!(again.has(Region::Lesson) && !again.app().is_at_start());
    assert_eq!(all().iter().filter(|one| lesson.starts_with(&one.title)).count(), 1, "{lesson}");
}

#[test]
fn the_page_is_turned_off_for_good() {
    let mut window = fresh(None);
    window.click("Show at start");
    let memory = saved(&mut window);
    let again = Window::begun(SIZE, Start::default(), Some(memory));
    assert!(!again.app().is_at_start() && again.app().document().clip().is_some());
    let named = Window::begun(SIZE, Start { open: Some("synth:parallax".into()) }, None);
    assert!(!named.app().is_at_start(), "the command line opens straight into the work");
}

#[test]
fn what_is_missing_says_so_and_what_cannot_be_opened_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let [kept, gone] = ["kept.png", "gone.png"].map(|name| folder.path().join(name));
    for path in [&kept, &gone] {
        image::GrayImage::new(64, 48).save(path).expect("a picture");
        image::GrayImage::new(64, 48).save(folder.path().join("next.png")).expect("a picture");
    }
    let mut window = fresh(None);
    for path in [&kept, &gone] {
        window.harness.state_mut().open(path);
        window.settle();
    }
    let memory = saved(&mut window);
    fs::remove_file(&gone).expect("it is removed");
    let mut again = fresh(Some(memory));
    let begun = Instant::now();
    while again.harness.query_by_label("gone.png, missing").is_none() {
        again.harness.run_steps(1);
        assert!(begun.elapsed() < Duration::from_secs(20));
    }
    assert!(again.harness.get_by_label("gone.png, missing").accesskit_node().is_disabled());
    again.harness.state_mut().open("no/such/clip.mp4");
    again.settle();
    assert!(again.app().is_at_start());
    let alert = again.harness.get_by_role(Role::Alert).accesskit_node().label().unwrap_or_default();
    assert!(alert.contains("clip.mp4"), "{alert}");
    again.harness.query_all_by_label_contains("kept.png").next().expect("it is listed").click();
    again.settle();
    assert!(!again.app().is_at_start() && again.app().document().clip().is_some());
}

#[test]
fn arrows_lead_to_everything_on_the_page() {
    let mut window = fresh(None);
    let focused = |window: &Window| {
        let node = window.harness.root().children_recursive().find(|node| node.is_focused()).expect("the keyboard");
        node.accesskit_node().id()
    };
    window.command(Command::ReducedMotion);
    window.key(Key::ArrowRight);
    let mut reached = vec![focused(&window)];
    let mut tried = 0;
    while tried < reached.len() {
        for key in [Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight] {
            let from = reached[tried];
            {
                let root = window.harness.root();
                let node = root.children_recursive().find(|node| node.accesskit_node().id() == from);
                node.expect("it is still there").focus();
            }
            window.harness.run();
            window.key(key);
            let to = focused(&window);
            if !reached.contains(&to) {
                reached.push(to);
            }
        }
        tried += 1;
    }
    let buttons = window.harness.query_all_by_role(Role::Button);
    let all = buttons.chain(window.harness.query_all_by_role(Role::CheckBox));
    let missed = all.filter(|node| !reached.contains(&node.accesskit_node().id()));
    let missed: Vec<_> = missed.filter_map(|node| node.accesskit_node().label()).collect();
    assert!(missed.is_empty() && reached.len() > 20, "{missed:?}");
}

#[test]
fn nothing_on_the_page_lies_over_another_in_any_theme_and_size() {
    for size in [vec2(1280.0, 720.0), vec2(1920.0, 1080.0), vec2(720.0, 480.0)] {
        let mut window = Window::begun(size, Start::default(), None);
        for _ in Theme::ALL {
            seen(&mut window);
            window.settle();
            let theme = window.app().settings().look.theme;
            window.lies_inside(size, &format!("{theme:?} {size:?}"));
            let nodes: Vec<_> = window.harness.query_all_by_role(Role::Button).collect();
            let rects: Vec<_> = nodes.iter().map(|node| (node.rect(), node.accesskit_node().label())).collect();
            for (i, (rect, name)) in rects.iter().enumerate() {
                for (other, that) in &rects[..i] {
                    assert!(
                        !rect.shrink(1.0).intersects(other.shrink(1.0)),
                        "{name:?} over {that:?} in {theme:?} {size:?}"
                    );
                }
            }
            window.command(Command::NextTheme);
        }
    }
    let mut window = fresh(None);
    window.command(Command::ProjectorTheme);
    window.settle();
    let first = chapters()[0].1[0];
    for name in [SCENES[0].title, estimators()[0].info().family, &first.title] {
        let rect = window.harness.get_by_role_and_label(Role::Button, name).rect();
        assert!(rect.max.y < 680.0, "clips, estimators and lessons are seen in a lecture hall: {name} at {rect}");
    }
}
