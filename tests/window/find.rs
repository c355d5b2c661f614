//! The search over all texts, from the keyboard to what is opened.

use super::*;

/// A window in which `words` were typed into the search.
fn searched(words: &str) -> Window {
    let mut window = Window::new(vec2(1280.0, 720.0));
    window.press(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::F);
    window.harness.get_by_label("Words to find").type_text(words);
    window.settle();
    window
}

fn hits(window: &Window) -> Vec<String> {
    let all = window.harness.query_all_by_role(Role::ListBoxOption);
    all.filter_map(|node| node.accesskit_node().label()).collect()
}

#[test]
fn a_word_of_a_lesson_leads_to_its_page_and_back() {
    let mut window = searched("misprint");
    let all = hits(&window);
    assert!(all.iter().all(|hit| hit.to_lowercase().contains("misprint")) && all.len() > 1, "{all:?}");
    window.key(Key::ArrowDown);
    window.key(Key::Enter);
    assert!(window.has(Region::Lesson));
    let place = all[1].split(", ").nth(1).expect("the lesson").to_owned();
    assert!(window.harness.query_all_by_label_contains(&place).next().is_some(), "{place}");
    let left = (lessons::page(&window), window.sentence());
    window.command(Command::SearchText);
    window.harness.get_by_label("Words to find").type_text("misprint");
    window.settle();
    window.key(Key::Enter);
    assert!((lessons::page(&window), window.sentence()) != left, "another page");
    window.press(Modifiers::ALT, Key::ArrowLeft);
    assert!((lessons::page(&window), window.sentence()) == left, "back at the page and its step");
    window.command(Command::SearchText);
    window.harness.get_by_label("Words to find").type_text("kalman gain");
    window.settle();
    window.key(Key::Enter);
    assert!(window.harness.query_by_label("Find a term").is_some(), "a term opens the glossary");
}

#[test]
fn estimators_parameters_and_examples_are_opened() {
    let mut window = searched("farneback");
    window.key(Key::Enter);
    assert_eq!(window.shown().info.id, "farneback");
    let mut window = searched("search range");
    // The term of that name stands before it.
    let is_parameter = |hit: &String| hit.starts_with("Search range, ") && hit.contains(" more. ");
    let at = hits(&window).iter().position(is_parameter).expect("the parameter");
    (0..at).for_each(|_| window.key(Key::ArrowDown));
    window.key(Key::Enter);
    assert!(!window.app().folded().parameters, "the parameters are shown");
    assert_eq!(window.shown().info.id, "full-search", "an estimator that has it stays");
}

#[test]
fn a_parameter_of_the_same_name_with_another_meaning_is_shown_at_its_own_estimator() {
    let mut window = searched("distance of an edge from its control point");
    // Full search has a search range, too: that of its displacements.
    let is_sought = |hit: &String| hit.starts_with("Search range, ");
    let at = hits(&window).iter().position(is_sought).expect("the parameter");
    (0..at).for_each(|_| window.key(Key::ArrowDown));
    window.key(Key::Enter);
    assert_eq!(window.app().document().estimator().info().id, "rapid");
    // From the start page an estimator that has it is not replaced either.
    let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some("example:diamond/works".into()) });
    let id = window.shown().info.id;
    assert_ne!(id, "full-search");
    window.command(Command::StartPage);
    window.command(Command::SearchText);
    window.harness.get_by_label("Words to find").type_text("search range");
    window.settle();
    let is_shared = |hit: &String| hit.starts_with("Search range, ") && hit.contains(" more. ");
    let at = hits(&window).iter().position(is_shared).expect("the parameter");
    (0..at).for_each(|_| window.key(Key::ArrowDown));
    window.key(Key::Enter);
    assert!(!window.app().is_at_start() && !window.app().folded().parameters);
    assert_eq!(window.shown().info.id, id);
}

#[test]
fn a_chart_is_shown_or_it_says_when_there_is_one() {
    let mut window = searched("point cloud");
    let at = hits(&window).iter().position(|hit| hit.contains(", Chart. ")).expect("the chart");
    (0..at).for_each(|_| window.key(Key::ArrowDown));
    window.key(Key::Enter);
    assert!(
        window.app().message().is_some_and(|text| text.starts_with("Point cloud shows")),
        "{:?}",
        window.app().message()
    );
    // By the palette as well.
    let mut window = Window::new(vec2(1280.0, 720.0));
    let surface = |window: &Window| window.harness.query_all_by_label_contains("in three dimensions").next().is_some();
    assert!(!surface(&window));
    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("chart 3-d");
    window.settle();
    window.key(Key::Enter);
    assert!(surface(&window), "{:?}", window.app().message());
}

#[test]
fn a_misspelling_is_answered_with_what_was_probably_meant() {
    let mut window = searched("kalmann gain");
    assert_eq!(hits(&window), ["Did you mean Kalman gain?"]);
    assert!(window.harness.query_by_label("Nothing has all of these words.").is_some());
    window.key(Key::Enter);
    assert!(hits(&window)[0].starts_with("Kalman gain, "), "{:?}", hits(&window));
    window.key(Key::Enter);
    assert!(window.harness.query_by_label("Find a term").is_some(), "a term opens the glossary");
    // The word with which there are hits for all words.
    for (typed, meant) in
        [("blok matching", "block matching"), ("exhaustiv serach", "exhaustive search"), ("blok", "block")]
    {
        let suggested = hits(&searched(typed));
        let wanted = format!("Did you mean {meant}?");
        assert!(suggested.len() == 1 && suggested[0].eq_ignore_ascii_case(&wanted), "{typed}: {suggested:?}");
    }
    // By a click; what is typed then stands behind the words.
    let mut window = searched("optcal flow");
    let suggested = hits(&window);
    assert!(suggested.len() == 1 && suggested[0].eq_ignore_ascii_case("Did you mean optical flow?"), "{suggested:?}");
    window.click_role(Role::ListBoxOption, &suggested[0]);
    let found = hits(&window).len();
    assert!(found > 1);
    window.harness.get_by_label("Words to find").type_text("s");
    window.settle();
    assert_eq!(hits(&window).len(), found, "the plural finds the same");
}

#[test]
fn formulas_around_a_match_mark_transposed_matrices() {
    let window = searched("innovation covariance");
    assert!(hits(&window)[0].contains("S = H P⁻ Hᵀ + R"), "{:?}", hits(&window)[0]);
    assert!(hits(&window).iter().all(|hit| !hit.contains("^T")));
}

#[test]
fn what_no_command_is_called_is_searched_in_the_texts() {
    let mut window = Window::new(vec2(1280.0, 720.0));
    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("misprint zzz");
    window.settle();
    window.key(Key::Enter);
    assert!(window.harness.query_by_label("Words to find").is_some());
    assert!(window.harness.query_by_label_contains("Nothing has all of these words").is_some());
    window.key(Key::Escape);
    assert!(window.harness.query_by_label("Words to find").is_none());
}
