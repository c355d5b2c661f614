//! The page in a real browser: Chromium without a window, driven as a person would drive it.
//!
//! `cargo xtask web` builds the page, `cargo test --manifest-path xtask/Cargo.toml --test browser` tests it. With
//! `SCREENSHOTS=folder` pictures of the page are written there.

mod chromium;
mod tab;

use std::time::Duration;

use chromium::Browser;
use serde_json::json;
use tab::Tab;
use xtask::Server;

/// The page, served below a path.
fn serve(base: &str) -> Server {
    Server::start(xtask::default_folder(), base, 0).expect("the page is served")
}

/// Opens the page, followed by a link to what it is to show.
fn open(browser: &mut Browser, server: &Server, link: &str) -> Tab {
    let mut tab = Tab::new(browser);
    tab.open(&format!("{}{link}", server.address()));
    tab
}

#[test]
fn the_start_page_appears() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.wait("the start page", |shown| shown.is_start() && !shown.is_busy());
    assert_eq!(tab.evaluate("document.getElementById('loading').hidden"), json!(true));
    let began = "const at = (name) => performance.getEntriesByName(name)[0].startTime; at('shown') - at('downloaded')";
    let began = tab.evaluate(&format!("{{ {began} }}")).as_f64().expect("a time");
    println!("start page {began:.0} ms after the download");
    tab.screenshot("start");
    assert!(began < 10_000.0, "{began} ms");
}

#[test]
fn a_clip_opens_by_keyboard_and_its_estimator_steps() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.wait("the start page", |shown| shown.is_start() && !shown.is_busy());
    tab.press("Enter");
    let first = tab.wait("a step", |shown| !shown.text("step").is_empty() && !shown.is_busy());
    println!("opened: {first:?}");
    tab.screenshot("opened");
    let began = std::time::Instant::now();
    for _ in 0..10 {
        let before = tab.settle().text("step").to_owned();
        tab.press("ArrowRight");
        tab.wait("the next step", |shown| shown.text("step") != before && !shown.is_busy());
    }
    println!("ten steps took {:?}", began.elapsed());
    tab.screenshot("stepped");
}

#[test]
fn a_lesson_opens_by_link_and_steps_by_keyboard() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#lesson:kalman-filter/3");
    tab.wait("the page of the lesson", |shown| shown.text("lesson") == "kalman-filter/3" && !shown.is_busy());
    tab.screenshot("lesson");
    let mut steps = Vec::new();
    for _ in 0..10 {
        let before = tab.settle().text("step").to_owned();
        tab.press("ArrowRight");
        tab.wait("the next step", |shown| shown.text("step") != before && !shown.is_busy());
        steps.push(before);
    }
    for step in steps.iter().rev() {
        tab.press("ArrowLeft");
        tab.wait("the step before", |shown| shown.text("step") == step && !shown.is_busy());
    }
}

#[test]
fn a_link_opens_a_clip_with_an_estimator_and_is_heard() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    let shown = tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    assert_eq!(tab.evaluate("document.getElementById('sentence').textContent"), json!(shown.text("sentence")));
    tab.screenshot("diamond");
}

#[test]
fn it_works_below_a_path_and_without_the_server() {
    let (server, mut browser) = (serve("/courses/vision/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.evaluate("navigator.serviceWorker.ready.then(() => true)");
    server.stop();
    tab.reload();
    tab.wait("the start page", |shown| shown.is_start());
    tab.screenshot("offline");
}

#[test]
fn a_phone_shows_a_lesson_and_steps_by_touch() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = Tab::new(&mut browser);
    tab.resize([390, 844], 2.0, true);
    tab.open(&format!("{}#lesson:kalman-filter/3", server.address()));
    tab.wait("the page of the lesson", |shown| shown.text("lesson") == "kalman-filter/3" && !shown.is_busy());
    tab.tap([195.0, 300.0]);
    tab.settle();
    tab.screenshot("phone");
    let scrolls =
        "document.scrollingElement.scrollWidth > innerWidth || document.scrollingElement.scrollHeight > innerHeight";
    assert_eq!(tab.evaluate(scrolls), json!(false));
}

#[test]
fn memory_does_not_grow_with_the_steps() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    let mut walk = |tab: &mut Tab, count| {
        for _ in 0..count {
            let before = tab.settle().text("step").to_owned();
            tab.press("ArrowRight");
            tab.wait("the next step", |shown| shown.text("step") != before);
        }
        tab.memory()
    };
    let (program, page) = walk(&mut tab, 20);
    let (program_after, page_after) = walk(&mut tab, 200);
    println!("memory after 20 steps {program} and {page} bytes, after 220 {program_after} and {page_after}");
    assert!(program_after < program + (32 << 20), "the program grew from {program} to {program_after} bytes");
    assert!(page_after < page + (8 << 20), "the page grew from {page} to {page_after} bytes");
}

#[test]
fn a_stopped_program_leaves_a_sentence() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.evaluate("document.getElementById('motionscope').dataset.panic = 'index out of bounds'");
    std::thread::sleep(Duration::from_millis(100));
    assert!(tab.is_stopped());
    let words = tab.evaluate("document.getElementById('stopped').innerText");
    assert!(words.as_str().is_some_and(|words| words.contains("Reload") && words.contains("index out of bounds")));
    tab.screenshot("stopped");
}

#[test]
fn a_lost_graphics_card_leaves_a_sentence() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.evaluate(
        "document.getElementById('motionscope').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()",
    );
    std::thread::sleep(Duration::from_millis(300));
    assert!(tab.is_stopped());
    tab.take_faults();
}
