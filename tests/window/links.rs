//! Links: copied, opened, in the address of a page, and in a frame of another one.

use std::cell::RefCell;
use std::fs;
use std::rc::Rc;

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, OutputCommand, OutputCommand::CopyText, vec2};
use egui_kittest::kittest::Queryable as _;
use motionscope::paint::View;
use motionscope::session::link::PUBLISHED;
use motionscope::ui::Start;
use motionscope::ui::app::Region;
use motionscope::ui::commands::Command;
use motionscope::ui::model::address::{AddressBar, Entry};
use motionscope_core::run::Cursor;

use super::Window;

fn opened(name: &str) -> Window {
    Window::with(vec2(1440.0, 900.0), Start { open: Some(name.into()) })
}

/// The texts and addresses that are copied and opened by the next frame.
fn commands_of(window: &mut Window, act: impl FnOnce(&mut Window)) -> Vec<OutputCommand> {
    act(window);
    window.harness.step();
    let commands = window.harness.output().platform_output.commands.clone();
    window.settle();
    commands
}

fn copied(window: &mut Window) -> String {
    let key = |pressed| {
        let modifiers = Modifiers::SHIFT;
        Event::Key { key: Key::K, physical_key: None, pressed, repeat: false, modifiers }
    };
    // Each event has a frame of its own: that of the key alone has the text.
    let text =
        commands_of(window, |window| window.harness.event(key(true))).into_iter().find_map(|command| match command {
            CopyText(text) => Some(text),
            _ => None,
        });
    window.harness.event(key(false));
    window.settle();
    text.expect("a link is copied")
}

#[test]
fn a_copied_link_opens_the_same_step() {
    let mut window = Window::usual();
    window.click("Order: Spiral");
    window.harness.get_by_role_and_label(Role::Slider, "Noise").set_value_accesskit(5.0);
    window.settle();
    window.key(Key::ArrowRight);
    window.key(Key::Num5);
    window.command(Command::TurboColors);
    let link = copied(&mut window);
    assert!(link.starts_with(&format!("{PUBLISHED}#synth:pillar,noise=5&estimator=full-search&step=")), "{link}");
    assert!(window.app().message().is_some_and(|said| said.starts_with("Link copied")), "{:?}", window.app().message());
    let again = opened(&link);
    assert!(again.sentence() == window.sentence(), "{link}");
    assert_eq!(again.app().settings().look, window.app().settings().look);
    assert!(again.app().settings().recent.is_empty());
    let mut other = opened("synth:flag");
    other.harness.state_mut().open(link);
    other.settle();
    assert!(other.sentence() == window.sentence());
}

#[test]
fn the_link_of_a_page_opens_its_words_and_the_step() {
    let mut window = opened("lesson:kalman-filter/3");
    let before = window.cursor();
    // The words of the page may be read to their end first.
    for _ in 0..6 {
        if window.cursor() == before {
            window.key(Key::ArrowRight);
        }
    }
    window.harness.state_mut().lead_links_to("http://localhost/course/".into());
    let link = copied(&mut window);
    assert!(link.starts_with("http://localhost/course/#lesson:kalman-filter/3&step="), "{link}");
    let mut again = opened(&link);
    assert!(again.has(Region::Lesson) && again.sentence() == window.sentence(), "{link}");
    let first = opened("#lesson:kalman-filter/3");
    assert!(first.has(Region::Lesson) && first.sentence() != window.sentence());
    again.harness.state_mut().open("#lesson:kalman-filter/3");
    again.settle();
    assert!(again.sentence() == first.sentence(), "the page that is open goes to another step");
    again.harness.state_mut().open("#synth:pillar&estimator=diamond&step=2.3");
    again.settle();
    assert!(!again.has(Region::Lesson) && again.cursor() == Cursor { unit: 1, event: 3 });
}

#[test]
fn what_is_wrong_with_a_link_is_said_and_the_rest_opens() {
    let window = opened("#synth:pillar&estimator=diamond&set.serch-range=8&step=2.3");
    assert_eq!(window.cursor(), Cursor { unit: 1, event: 3 });
    let message = window.app().message().unwrap_or_default();
    assert!(message.contains("the nearest is search-range"), "{message}");
    let window = Window::begun(vec2(1440.0, 900.0), Start { open: Some("#lesson:kalmanfilter".into()) }, None);
    assert!(window.app().is_at_start());
    let said = window.app().error().map(ToString::to_string).unwrap_or_default();
    assert!(said.contains("no lesson kalmanfilter; the nearest is kalman-filter"), "{said}");
}

#[test]
fn a_step_that_a_run_does_not_have_is_said() {
    for (step, is_there) in [("300", true), ("35.4", true), ("9999.1", false), ("35.9999", false)] {
        let mut window = opened(&format!("#synth:pillar&estimator=diamond&step={step}"));
        let message = window.app().message().unwrap_or_default().to_owned();
        assert_eq!(!message.contains(&format!("no step {step}")), is_there, "{step}: {message}");
        // It is said of what was opened, not of where the run is led afterwards.
        window.key(Key::Home);
        window.settle();
        assert_eq!(window.app().message().unwrap_or_default(), message);
    }
}

#[test]
fn an_own_clip_is_asked_for_and_gets_what_the_link_says() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, shift) in [("ball_0.png", 0), ("ball_1.png", 2), ("other.png", 1)] {
        let picture = image::GrayImage::from_fn(64, 48, |x, y| image::Luma([((x + shift) * 7 + y * 5) as u8]));
        picture.save(folder.path().join(name)).expect("a picture");
    }
    let [first, second] = ["ball_0.png", "ball_1.png"].map(|name| folder.path().join(name).display().to_string());
    let pair = format!("pair:{first}|{second}");
    let mut window = opened(&pair);
    window.harness.state_mut().open("#pair:ball_0.png%7Cball_1.png&estimator=diamond&step=2.3&set.search-range=4");
    window.settle();
    assert_eq!(window.shown().info.id, "diamond", "the clip is open");
    let link = copied(&mut window);
    assert!(link.contains("#pair:ball_0.png%7Cball_1.png&estimator=diamond&step=2.3&set.search-range=4"), "{link}");
    assert!(!link.contains(&*folder.path().to_string_lossy()));

    let mut again = Window::begun(vec2(1440.0, 900.0), Start { open: Some(link.into()) }, None);
    assert!(again.app().is_at_start());
    let said = again.app().error().map(ToString::to_string).unwrap_or_default();
    assert!(said.contains("drop ball_0.png and ball_1.png here"), "{said}");
    again.harness.state_mut().open(folder.path().join("other.png"));
    again.settle();
    assert_ne!(again.app().document().estimator().info().id, "diamond", "this is another clip");
    again.harness.state_mut().open(pair);
    again.settle();
    assert_eq!((again.shown().info.id, again.cursor()), ("diamond", Cursor { unit: 1, event: 3 }));
    fs::remove_dir_all(folder.path()).expect("removed");
}

#[test]
fn a_frame_has_stage_chart_sentence_and_transport_alone() {
    for size in [vec2(800.0, 450.0), vec2(1280.0, 720.0), vec2(480.0, 600.0)] {
        for link in ["#lesson:horn-schunck/2&view=embed", "#synth:pillar&estimator=diamond&step=2.3&view=embed"] {
            let mut window = Window::with(size, Start { open: Some(link.into()) });
            let none = [Region::Header, Region::Status, Region::Lesson, Region::Parameters, Region::Explanation];
            let wrong: Vec<_> = none.into_iter().filter(|region| window.has(*region)).collect();
            assert!(wrong.is_empty(), "{link} {size}: {wrong:?}");
            let all = [Region::Stage, Region::Strip, Region::Transport];
            let missing: Vec<_> = all.into_iter().filter(|region| !window.has(*region)).collect();
            assert!(missing.is_empty(), "{link} {size}: {missing:?}");
            let before = window.cursor();
            window.key(Key::ArrowRight);
            assert!(window.cursor() != before, "{link} {size}: it steps");
            let click = |window: &mut Window| window.harness.get_by_label("Open in Motionscope").click();
            let urls = commands_of(&mut window, click).into_iter().find_map(|command| match command {
                OutputCommand::OpenUrl(url) => Some(url),
                _ => None,
            });
            let url = urls.expect("the whole window opens");
            let whole = link.trim_end_matches("&view=embed").trim_end_matches("&step=2.3");
            assert!(url.new_tab && url.url.starts_with(&format!("{PUBLISHED}{whole}")), "{}", url.url);
            assert!(url.url.contains("&step=") && !url.url.contains("view="), "{}", url.url);
        }
    }
    let window = opened("#synth:pillar&estimator=diamond&view=present");
    assert!(window.app().presentation().is_on && !window.has(Region::Header));
}

/// A bar with its history, and the entry that is open.
#[derive(Default)]
struct Bar {
    entries: Vec<String>,
    at: usize,
}

impl Bar {
    /// The bar of a page that was opened without a link.
    fn new() -> Rc<RefCell<Self>> {
        Rc::new(RefCell::new(Self { entries: vec![String::new()], at: 0 }))
    }
}

struct SharedBar(Rc<RefCell<Bar>>);

impl AddressBar for SharedBar {
    fn base(&self) -> String {
        "https://example.org/".into()
    }

    fn fragment(&self) -> String {
        let bar = self.0.borrow();
        bar.entries[bar.at].clone()
    }

    fn write(&mut self, fragment: &str, entry: Entry) -> bool {
        let mut bar = self.0.borrow_mut();
        let at = bar.at;
        bar.entries.truncate(at + 1);
        match entry {
            Entry::Same => bar.entries[at] = fragment.to_owned(),
            Entry::New => {
                bar.entries.push(fragment.to_owned());
                bar.at += 1;
            }
        }
        true
    }
}

#[test]
fn the_back_button_goes_between_pages_and_clips_and_not_between_steps() {
    let bar = Bar::new();
    let mut window = Window::begun(vec2(1440.0, 900.0), Start::default(), None);
    window.harness.state_mut().follow_in(Box::new(SharedBar(Rc::clone(&bar))));
    let rest = |window: &mut Window| {
        for _ in 0..2 {
            window.harness.run_steps(30);
            window.settle();
        }
    };
    rest(&mut window);
    window.harness.state_mut().open("lesson:kalman-filter");
    rest(&mut window);
    window.command(Command::NextPage);
    rest(&mut window);
    let second = window.sentence();
    window.harness.state_mut().open("synth:flag");
    rest(&mut window);
    for _ in 0..2 {
        window.key(Key::ArrowRight);
        rest(&mut window);
    }
    let entries = bar.borrow().entries.clone();
    assert_eq!(entries.len(), 4, "{entries:?}");
    assert_eq!(entries[..3], ["", "lesson:kalman-filter/1", "lesson:kalman-filter/2"]);
    let last = window.sentence();

    bar.borrow_mut().at = 2;
    rest(&mut window);
    assert!(window.sentence() == second && window.has(Region::Lesson), "back to the page");
    bar.borrow_mut().at = 0;
    rest(&mut window);
    assert!(window.app().is_at_start(), "back to the start page");
    bar.borrow_mut().at = 3;
    rest(&mut window);
    assert!(window.sentence() == last, "forward to the clip, at the step where it was left");
    assert_eq!(bar.borrow().entries, entries, "going back and forward adds no entry");
    assert!(copied(&mut window).starts_with("https://example.org/#"), "the base is that of the page");

    window.harness.state_mut().set_look("view", "blend").expect("a view");
    rest(&mut window);
    assert_eq!(bar.borrow().entries.len(), 4);
    assert_eq!(window.app().settings().look.view, Some(View::Blend));
    assert!(bar.borrow().entries[3].contains("&picture.view=blend"), "{:?}", bar.borrow().entries);
}
