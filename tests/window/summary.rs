//! The summary of the window for the page around it.

use super::*;

#[test]
fn a_page_of_a_lesson_is_summarised_with_its_step() {
    let window = Window::with(vec2(1280.0, 720.0), Start { open: Some("lesson:kalman-filter/3".into()) });
    let shown = window.app().summary();
    assert_eq!(shown.lesson.as_deref(), Some("kalman-filter/3"));
    assert_eq!(shown.estimator, Some("kalman-filter"));
    assert_eq!(shown.step, Some(window.cursor().to_string()));
    assert_eq!(shown.sentence, Some(window.shown().step.sentence.plain()));
    assert!(!shown.start && !shown.busy && shown.error.is_none());
}

#[test]
fn the_start_page_hides_the_run_below_it() {
    let window = Window::begun(vec2(1280.0, 720.0), Start::default(), None);
    let shown = window.app().summary();
    assert!(shown.start);
    assert_eq!((shown.clip, shown.estimator, shown.step, shown.sentence), (None, None, None, None));
}

#[test]
fn an_error_is_in_the_summary() {
    let window = Window::with(vec2(1280.0, 720.0), Start { open: Some("lesson:kalman-filter/99".into()) });
    assert!(window.app().summary().error.is_some_and(|error| error.contains("9 pages")));
}
