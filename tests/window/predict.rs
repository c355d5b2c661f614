//! Predict, then reveal: results are held back until they are asked for.

use motionscope::ui::model::predict::Score;
use motionscope_core::estimators;
use motionscope_core::scene::{Asked, Question};

use super::*;

/// A window on an estimator at a step of a clip, which asks from now on.
fn asking(estimator: &str, step: &str, clip: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let lines = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"{estimator}\"\nstep = \"{step}\"\n");
    fs::write(&path, lines).expect("it is written");
    let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some(path.into()) });
    window.key(Key::Q);
    assert!(window.app().predict().is_on());
    window
}

fn question(window: &Window) -> Option<&'static Question> {
    window.app().predict().open().map(|open| open.question)
}

/// The sentence of the step that is shown.
fn said(window: &Window) -> String {
    window.shown().step.sentence.plain()
}

#[test]
fn a_result_is_hidden_until_it_is_revealed() {
    let mut plain = Window::usual();
    plain.command(Command::Start);
    let mut window = Window::usual();
    window.command(Command::Start);
    window.key(Key::Q);
    let mut asked = 0;
    for _ in 0..8 {
        plain.key(Key::ArrowRight);
        let before = (window.cursor(), said(&window));
        window.key(Key::ArrowRight);
        if question(&window).is_some() {
            asked += 1;
            assert_eq!((window.cursor(), said(&window)), before, "nothing of the next step is told");
            window.key(Key::ArrowRight);
        }
        assert_eq!(question(&window), None);
        assert_eq!((window.cursor(), said(&window)), (plain.cursor(), said(&plain)));
    }
    assert!(asked >= 3, "asked {asked} times");
}

#[test]
fn number_keys_count_hands_and_the_result_scores_them() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    while question(&window).is_none() {
        window.key(Key::ArrowRight);
    }
    let view = window.app().settings().look.view;
    [Key::Num1, Key::Num2, Key::Num2].into_iter().for_each(|key| window.key(key));
    window.press(Modifiers::SHIFT, Key::Num1);
    assert_eq!(window.app().settings().look.view, view, "they choose no view while a question is open");
    let hands = window.app().predict().open().map(|open| open.guesses.hands.clone());
    assert_eq!(hands.as_deref(), Some(&[0, 2, 0][..]));
    window.key(Key::Enter);
    let answered = window.app().predict().last().and_then(|open| open.verdict()).expect("it is revealed");
    assert_eq!(answered.hands[1], 2);
    let scores = window.app().predict().scores();
    assert_eq!(scores.len(), 1);
    let told = said(&window);
    assert_eq!(scores[0].is_right(), Some(told.contains("exceeds")), "{told}");
    assert_eq!(Score::csv(scores).lines().count(), 2);
}

#[test]
fn a_click_is_a_guess_of_the_place() {
    let mut window = asking("full-search", "28.0", "synth:pillar");
    window.press(Modifiers::SHIFT, Key::ArrowRight);
    let asked = question(&window).expect("the match of the next block is asked for");
    assert!(matches!(asked.asked, Asked::Place { .. }), "{asked:?}");
    let cursor = window.cursor();
    for share in [[0.5, 0.5], [0.25, 0.4]] {
        window.click_at(pixels::on_picture(&window, "Frame t+1", share));
    }
    assert_eq!(window.cursor(), cursor, "a click goes nowhere");
    let places = window.app().predict().open().map(|open| open.guesses.places.len());
    assert_eq!(places, Some(2));
    window.press(Modifiers::SHIFT, Key::ArrowRight);
    let verdict = window.app().predict().last().and_then(|open| open.verdict()).expect("it is revealed");
    assert!(verdict.nearest.is_some_and(|(_, off)| off > 0.0) && verdict.unit == "px", "{verdict:?}");
    assert!(window.cursor() > cursor);
}

#[test]
fn a_step_back_takes_the_question_back() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    while question(&window).is_none() {
        window.key(Key::ArrowRight);
    }
    let before = (window.cursor(), said(&window));
    window.key(Key::ArrowLeft);
    assert_eq!(question(&window), None);
    assert_eq!((window.cursor(), said(&window)), before);
    assert!(window.app().predict().scores().is_empty());
    window.key(Key::ArrowRight);
    assert!(question(&window).is_some(), "it is asked again");
    window.key(Key::Q);
    assert!(!window.app().predict().is_on() && question(&window).is_none());
}

#[test]
fn two_steps_at_once_pass_over_no_question() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    let before = window.cursor();
    for _ in 0..3 {
        window.harness.state_mut().command(Command::Into);
    }
    window.settle();
    assert!(question(&window).is_some(), "the step after {before} is asked about");
    assert_eq!(window.cursor(), before);
    window.key(Key::Enter);
    assert_eq!(window.cursor(), Cursor { event: before.event + 1, ..before });
}

#[test]
fn what_is_pointed_at_is_not_asked_about() {
    let mut window = asking("horn-schunck", "2.4", "synth:pillar");
    window.harness.hover_at(pixels::on_picture(&window, "Frame t", [0.3, 0.3]));
    window.settle();
    assert!(window.shown().pointed.is_some(), "a pixel is explained");
    for _ in 0..6 {
        window.key(Key::ArrowRight);
        if let Some(open) = window.app().predict().open() {
            let asked = open.question.id;
            window.key(Key::Enter);
            let told = said(&window);
            let verdict = window.app().predict().last().and_then(|open| open.verdict()).expect("it is revealed");
            assert!(asked != "share" || told.contains(&verdict.answer), "{verdict:?}: {told}");
        }
    }
    assert!(window.cursor() > Cursor { unit: 1, event: 4 });
}

#[test]
fn the_keys_of_hands_are_those_of_their_place() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    while question(&window).is_none() {
        window.key(Key::ArrowRight);
    }
    // As keyboards send it: with Shift the key has another name.
    let digit =
        |key, modifiers, repeat| Event::Key { key, physical_key: Some(Key::Num1), pressed: true, repeat, modifiers };
    let release = |key| Event::Key {
        key,
        physical_key: Some(Key::Num1),
        pressed: false,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    let hands = |window: &Window| window.app().predict().open().map_or(0, |open| open.guesses.hands[0]);
    for event in [digit(Key::Num1, Modifiers::NONE, false), digit(Key::Num1, Modifiers::NONE, true), release(Key::Num1)]
    {
        window.harness.event(event);
        window.settle();
    }
    assert_eq!(hands(&window), 1, "a key that is held counts once");
    window.harness.event(digit(Key::Exclamationmark, Modifiers::SHIFT, false));
    window.settle();
    assert_eq!(hands(&window), 0);
}

#[test]
fn answers_stay_inside_the_window() {
    for (theme, size) in [(Theme::Projector, vec2(1280.0, 720.0)), (Theme::Light, vec2(900.0, 600.0))] {
        for estimator in estimators() {
            let Some(choice) = estimator.questions().iter().find(|question| question.choices().len() > 2) else {
                continue;
            };
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("one.motionscope");
            let (id, theme) = (estimator.info().id, theme.id());
            let clip = if estimator.needs_pictures() { "synth:pillar" } else { "synth:traffic" };
            let lines =
                format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"{id}\"\n[picture]\ntheme = \"{theme}\"\n");
            fs::write(&path, lines).expect("it is written");
            if !["diamond", "blob-tracker", "klt", "harris"].contains(&id) {
                continue;
            }
            let mut window = Window::with(size, Start { open: Some(path.into()) });
            window.key(Key::Q);
            let mut presses = 0;
            while question(&window).is_none_or(|question| question.id != choice.id) && presses < 120 {
                window.key(Key::ArrowRight);
                presses += 1;
            }
            assert!(question(&window).is_some(), "{id} asks");
            window.lies_inside(size, &format!("{id}, {theme}"));
            let bar = window.region(Region::Question);
            assert!(bar.height() < 0.3 * bar.width().min(size.y), "{id}, {theme}: {bar:?}");
        }
    }
}

#[test]
fn playing_stops_at_a_question() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    window.key(Key::Space);
    for _ in 0..200 {
        if question(&window).is_some() {
            break;
        }
        window.step();
    }
    assert!(question(&window).is_some());
    let cursor = window.cursor();
    (0..20).for_each(|_| window.step());
    assert_eq!(window.cursor(), cursor, "it waits for the class");
}

#[test]
fn a_number_is_typed() {
    let id = "global-motion";
    let mut window = asking(id, "0.0", "synth:hand-held");
    let mut presses = 0;
    while !question(&window).is_some_and(|question| matches!(question.asked, Asked::Number(_))) {
        window.key(Key::ArrowRight);
        presses += 1;
        assert!(presses < 400, "no number is asked for");
    }
    window.harness.get_by_label("A guess").focus();
    window.settle();
    window.harness.event(Event::Text("40".into()));
    window.settle();
    window.click("Add guess");
    let numbers = window.app().predict().open().map(|open| open.guesses.numbers.clone());
    assert_eq!(numbers.as_deref(), Some(&[40.0][..]));
    window.click("Reveal");
    let verdict = window.app().predict().last().and_then(|open| open.verdict()).expect("it is revealed");
    assert_eq!(verdict.guesses, 1);
}
