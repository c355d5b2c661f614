//! Predict, then reveal: results are held back until they are asked for.

use std::sync::Arc;

use motionscope::session::lesson::all;
use motionscope::ui::model::predict::Score;
use motionscope_core::course::estimators;
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

/// The panes that would suggest an answer.
fn told(window: &Window) -> usize {
    let of = [Region::Explanation, Region::Strip, Region::Chart];
    window.app().regions().iter().filter(|(region, _)| of.contains(region)).count()
}

#[test]
fn a_question_names_the_unit_that_it_is_about() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    for _ in 0..20 {
        if question(&window).is_none() {
            window.key(Key::ArrowRight);
        }
    }
    let text = question(&window).expect("one is open").text;
    assert!(window.harness.query_by_label(&format!("Block 27: {text}")).is_some(), "{text}");
}

#[test]
fn a_question_about_the_gate_tells_what_it_is_decided_from() {
    let mut window = asking("kalman-filter", "9.0", "synth:traffic");
    let is_about_gate = |window: &Window| question(window).is_some_and(|question| !question.given.is_empty());
    for _ in 0..40 {
        if !is_about_gate(&window) {
            window.key(Key::ArrowRight);
        }
    }
    assert!(is_about_gate(&window), "the filter asks about its gate");
    let given = window.app().predict().open().expect("one is open").given();
    assert_eq!(given.len(), 3, "innovation, its covariance and the gate");
    for fact in given {
        let told = format!("{}: {}", fact.label, fact.value);
        assert!(window.harness.query_by_label_contains(&told).is_some(), "{told}");
    }
    assert_eq!(told(&window), 0, "everything else is hidden");
}

#[test]
fn a_question_of_a_frame_names_its_number_in_the_clip() {
    let mut window = asking("kalman-filter", "9.0", "synth:traffic");
    for _ in 0..20 {
        if question(&window).is_none() {
            window.key(Key::ArrowRight);
        }
    }
    let asked = window.app().predict().open().expect("one is open");
    let (frame, text) = (asked.asked_of().frame, asked.question.text);
    assert!(window.harness.query_by_label(&format!("Pass 1, frame {frame}: {text}")).is_some(), "{frame}: {text}");
}

#[test]
fn eight_directions_and_the_same_place_lie_as_on_a_number_pad() {
    let mut window = asking("full-search", "28.0", "synth:pillar");
    window.press(Modifiers::SHIFT, Key::ArrowRight);
    assert!(matches!(question(&window), Some(Question { asked: Asked::Place { .. }, .. })));
    let at = |name: &str| window.harness.get_by_label(&format!("{name}: 0")).rect().center();
    let rows = [
        ["Upper left", "Above", "Upper right"],
        ["Left", "Same place", "Right"],
        ["Lower left", "Below", "Lower right"],
    ];
    let places = rows.map(|row| row.map(at));
    for row in &places {
        assert!(row.windows(2).all(|pair| pair[0].x < pair[1].x && (pair[0].y - pair[1].y).abs() < 1.0));
    }
    let is_over = |(above, below): (&Pos2, &Pos2)| above.y < below.y && (above.x - below.x).abs() < 1.0;
    assert!(places.windows(2).all(|rows| rows[0].iter().zip(&rows[1]).all(is_over)));
    assert!(layout::words(&window.harness.output().shapes).iter().any(|word| word.text.ends_with("Same place")));
    window.click("Same place: 0");
    let hands = window.app().predict().open().map(|open| open.guesses.hands[4]);
    assert_eq!(hands, Some(1));
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
            assert_eq!(told(&window), 0, "explanation and chart are hidden");
            window.key(Key::ArrowRight);
        }
        assert!(question(&window).is_none() && told(&window) > 1);
        assert_eq!((window.cursor(), said(&window)), (plain.cursor(), said(&plain)));
    }
    assert!(asked >= 3, "asked {asked} times");
}

#[test]
fn the_picture_is_in_sight_during_a_question_although_a_chart_is_enlarged() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    window.command(Command::EnlargeChart);
    assert!(!window.has(Region::Stage));
    for _ in 0..20 {
        if question(&window).is_none() {
            window.key(Key::ArrowRight);
        }
    }
    assert!(question(&window).is_some() && window.has(Region::Stage), "what is asked about can be clicked");
    window.key(Key::ArrowRight);
    assert!(!window.has(Region::Stage), "the chart is enlarged again");
}

#[test]
fn a_lesson_ends_after_an_answer_on_its_last_step() {
    let index = all().iter().position(|lesson| lesson.pages.last().is_some_and(|page| page.until.is_some()));
    let index = index.expect("a lesson whose last page has steps");
    let (lesson, next) = (&all()[index], &all()[index + 1]);
    let name = format!("lesson:{}/{}", lesson.slug, lesson.pages.len());
    let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some(name.into()) });
    window.key(Key::Q);
    let offers = |window: &Window| window.harness.query_all_by_label_contains("again: ").next().is_some();
    for _ in 0..20 {
        if !offers(&window) {
            window.key(Key::ArrowRight);
        }
    }
    let is_answered = window.app().predict().last().is_some_and(|open| open.verdict().is_some());
    assert!(offers(&window) && is_answered, "the last step was asked about");
    window.key(Key::ArrowRight);
    let is_open = window.harness.query_all_by_label_contains(&next.title).next().is_some() && !offers(&window);
    assert!(is_open, "{} opens", next.title);
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
fn another_class_begins_a_new_tally() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    let answer = |window: &mut Window| {
        while question(window).is_none() {
            window.key(Key::ArrowRight);
        }
        window.key(Key::Num2);
        window.key(Key::Enter);
    };
    answer(&mut window);
    answer(&mut window);
    assert_eq!(window.app().predict().scores().len(), 2);
    window.command(Command::ClearScores);
    assert!(window.app().predict().scores().is_empty());
    answer(&mut window);
    let scores = window.app().predict().scores();
    assert_eq!(Score::csv(scores).lines().count(), 2, "the head and the answer of the new class");
}

#[test]
fn a_page_that_predicts_asks_before_it_is_turned() {
    let mut pages = 0;
    for lesson in all() {
        for number in (1..=lesson.pages.len()).filter(|number| lesson.pages[number - 1].predicts) {
            let name = format!("lesson:{}/{number}", lesson.slug);
            let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some(name.clone().into()) });
            let until = lesson.pages[number - 1].until.unwrap_or_else(|| panic!("{name} has no steps to ask about"));
            let mut presses = 0;
            while question(&window).is_none() {
                assert!(window.cursor() < until && presses < 60, "{name}: no question is asked up to {until}");
                window.key(Key::ArrowRight);
                presses += 1;
            }
            let asked = window.app().predict().open().map(|open| open.cursor());
            assert!(asked.is_some_and(|asked| asked <= until), "{name}: {asked:?} lies behind the page");
            pages += 1;
        }
    }
    assert!(pages > 4, "{pages} pages predict");
}

#[test]
fn a_page_that_is_left_gives_no_answer() {
    let mut left = 0;
    for lesson in all() {
        let numbers = (1..lesson.pages.len()).filter(|number| lesson.pages[number - 1].predicts);
        for number in numbers {
            let name = format!("lesson:{}/{number}", lesson.slug);
            let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some(name.clone().into()) });
            for _ in 0..12 {
                if question(&window).is_none() {
                    window.key(Key::ArrowRight);
                }
            }
            let Some(hidden) = window.app().predict().open().map(|open| open.cursor()) else { continue };
            let next = lesson.pages[number].session.as_ref().ok().and_then(|session| session.position.cursor);
            assert!(next.is_some_and(|next| next != hidden), "{name}: the next page shows something else");
            let run = Arc::clone(&window.shown().subject);
            window.harness.state_mut().command(Command::NextPage);
            left += 1;
            for _ in 0..60 {
                window.step();
                let shown = window.shown();
                let is_seen = Arc::ptr_eq(&shown.subject, &run) && shown.cursor == hidden;
                assert!(!is_seen, "{name}: step {hidden} is shown before the next page");
            }
        }
    }
    assert!(left > 2, "{left} pages were left");
}

#[test]
fn what_lies_ahead_is_hidden_while_results_are_asked_about() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    let rail = |window: &Window| window.harness.get_by_label("Timeline, steps").rect();
    let end = |window: &Window| {
        let track = window.harness.get_by_label("Timeline, steps");
        track.accesskit_node().max_numeric_value().expect("it has an end")
    };
    let events = window.shown().events as f64;
    let (asked, place) = (end(&window), rail(&window));
    assert!(asked < events, "{asked} of {events}");
    window.key(Key::ArrowRight);
    window.key(Key::ArrowRight);
    assert_eq!(end(&window), asked, "the track is as long whatever is ahead");
    window.key(Key::Q);
    assert_eq!((end(&window), rail(&window)), (events, place), "nothing moves");
}

#[test]
fn the_track_of_steps_leads_past_no_question() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    let here = window.cursor();
    let rail = window.harness.get_by_label("Timeline, steps").rect();
    let at = |share: f32| Pos2::new(rail.min.x + share * rail.width(), rail.center().y);
    window.click_at(at(0.9));
    assert_eq!((window.cursor(), question(&window)), (here, None), "a click ahead");
    window.drag(at(0.5), at(1.0));
    assert_eq!((window.cursor(), question(&window)), (here, None), "a drag ahead");
    window.click_at(at(1.0 / 16.0));
    assert_eq!(window.cursor(), Cursor { event: 1, ..here }, "what was seen is seen again");
}

#[test]
fn the_whole_picture_is_seen_while_a_place_on_it_is_asked_for() {
    let mut window = asking("feature-matching", "1.9", "synth:pillar");
    window.key(Key::ArrowRight);
    let asked = question(&window).expect("the nearest descriptor is asked for");
    assert!(matches!(asked.asked, Asked::Place { .. }), "{asked:?}");
    let (width, height) = window.shown().pictures.pair[0].size();
    let whole = [[-0.5, -0.5], [width as f32 - 0.5, height as f32 - 0.5]];
    assert_eq!(window.shown().scene.work, Some(whole));
}

#[test]
fn the_view_goes_back_to_the_whole_picture_even_under_the_pointer() {
    let mut window = asking("mean-shift", "3", "synth:traffic");
    let is_close = |window: &Window| window.harness.query_by_label("Map of the whole picture").is_some();
    window.harness.hover_at(pixels::on_picture(&window, "Frame t", [0.5, 0.5]));
    window.settle();
    assert!(is_close(&window), "the region is small");
    for _ in 0..8 {
        window.press(Modifiers::SHIFT, Key::ArrowRight);
        match question(&window).map(|question| question.asked) {
            Some(Asked::Place { .. }) => break,
            Some(_) => window.key(Key::Enter),
            None => {}
        }
    }
    assert!(matches!(question(&window), Some(Question { asked: Asked::Place { .. }, .. })));
    assert!(!is_close(&window), "the region may lie anywhere in the next frame");
    window.key(Key::Enter);
    assert!(is_close(&window));
}

#[test]
fn what_stays_the_same_is_asked_about_once() {
    let mut window = asking("horn-schunck", "1.2", "synth:pillar");
    let mut asked = Vec::new();
    for _ in 0..16 {
        window.key(Key::ArrowRight);
        if question(&window).is_some() {
            window.key(Key::Enter);
            asked.push(window.shown().reference().map(|pixel| pixel.at));
        }
    }
    assert!(window.cursor().unit > 2, "several iterations have passed");
    assert!(!asked.is_empty() && (1..asked.len()).all(|i| !asked[..i].contains(&asked[i])), "{asked:?}");
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
fn the_mode_is_turned_off_without_the_answer() {
    let mut window = asking("full-search", "27.3", "synth:pillar");
    let before = loop {
        let before = (window.cursor(), said(&window));
        window.key(Key::ArrowRight);
        if question(&window).is_some() {
            break before;
        }
    };
    let hidden = window.app().predict().open().map(|open| open.cursor()).expect("a question is open");
    assert_ne!(hidden, before.0);
    window.harness.key_press(Key::Q);
    for _ in 0..60 {
        window.step();
        assert_ne!(window.cursor(), hidden, "the answer is shown");
    }
    window.settle();
    assert!(!window.app().predict().is_on() && question(&window).is_none());
    assert_eq!((window.cursor(), said(&window)), before, "the question is taken back");
    assert!(window.app().predict().scores().is_empty());
    window.key(Key::ArrowRight);
    assert_eq!((window.cursor(), question(&window)), (hidden, None), "the run goes on from there");
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
fn the_next_step_is_asked_about_although_a_pixel_is_pointed_at() {
    let mut window = asking("horn-schunck", "1.2", "synth:pillar");
    window.harness.hover_at(pixels::on_picture(&window, "Frame t", [0.3, 0.3]));
    window.settle();
    assert!(window.shown().pointed.is_some(), "a pixel is explained");
    window.key(Key::ArrowRight);
    assert!(question(&window).is_some(), "the update is asked about");
    assert!(window.shown().pointed.is_none());
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
            let mut all = window.app().regions().iter().filter(|(region, _)| *region == Region::Pictures);
            assert!(all.all(|(_, picture)| !picture.shrink(1.0).intersects(bar)), "{id}, {theme}: {bar:?}");
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
    while !question(&window).is_some_and(|question| matches!(question.asked, Asked::Value { .. })) {
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

#[test]
fn undo_during_a_question_takes_only_the_question_back() {
    let mut window = Window::usual();
    window.command(Command::Lockstep);
    window.command(Command::Lockstep);
    assert!(window.app().document().side_by_side().is_empty(), "the lockstep was left");
    window.command(Command::Predict);
    for _ in 0..40 {
        if window.app().predict().open().is_some() {
            break;
        }
        window.key(Key::ArrowRight);
        window.key(Key::ArrowRight);
    }
    assert!(window.app().predict().open().is_some(), "a question is open");
    window.press(Modifiers::COMMAND, Key::Z);
    assert!(window.app().predict().open().is_none());
    assert!(window.app().document().side_by_side().is_empty(), "and stays left");
}

#[test]
fn digits_before_a_question_do_not_change_the_view() {
    let mut window = Window::usual();
    window.command(Command::Predict);
    let view = window.app().settings().look.view;
    for key in [Key::Num1, Key::Num2, Key::Num4] {
        window.key(key);
        assert_eq!(window.app().settings().look.view, view, "{key:?}");
    }
    window.command(Command::Predict);
    window.key(Key::Num2);
    assert_ne!(window.app().settings().look.view, view, "without questions they choose it");
}
