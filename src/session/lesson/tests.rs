//! Lessons as they are written and read.

use super::*;

const TEXT: &str = r#"# Two searches

What is learned.

+++
title = "First"
clip = "synth:pillar"
estimator = "full-search"
frame = 3
step = "2.1"
until = "2.4"
set = { block-size = 8 }
+++
Words of the **first** page.

+++
title = "Second"
notes = "Ask."
step = "7.0"
+++
Words of the second, with $u$.

+++
title = "Third"
estimator = "three-step"
+++
Third.

+++
title = "Fourth"
example = "horn-schunck/filling-in"
step = "1.0"
+++
Fourth.
"#;

fn lesson(text: &str) -> Lesson {
    Lesson::parse("two-searches", text, Path::new(".")).unwrap_or_else(|why| panic!("{why}"))
}

fn session(lesson: &Lesson, page: usize) -> &Session {
    lesson.pages[page].session.as_ref().unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn a_page_takes_from_the_page_before_what_it_does_not_name() {
    let lesson = lesson(TEXT);
    assert_eq!((lesson.title.as_str(), lesson.summary.as_str()), ("Two searches", "What is learned."));
    let titles: Vec<_> = lesson.pages.iter().map(|page| page.title.as_str()).collect();
    assert_eq!(titles, ["First", "Second", "Third", "Fourth"]);
    let [first, second, third, fourth] = [0, 1, 2, 3].map(|page| session(&lesson, page));
    assert!(second.experiment == first.experiment, "the same run");
    assert_eq!(second.position.cursor, Some(Cursor { unit: 6, event: 0 }));
    assert_eq!(lesson.pages[0].until, Some(Cursor { unit: 1, event: 4 }));
    assert_eq!(lesson.pages[1].notes, "Ask.");
    assert_eq!(third.experiment.estimator.info().id, "three-step");
    assert_eq!((third.experiment.frame, third.position.cursor), (3, None), "the clip stays, its run begins");
    assert_eq!(fourth.experiment.estimator.info().id, "horn-schunck");
    assert!(lesson.faults().next().is_none());
}

#[test]
fn a_page_that_is_wrong_says_its_line_and_the_others_open() {
    for (right, wrong, line) in [
        ("estimator = \"three-step\"", "estimator = \"no-step\"", "line 25, estimator"),
        ("step = \"7.0\"", "stop = \"7.0\"", "line 19: there is no key stop"),
        ("synth:pillar", "synth:pile", "line 7, clip"),
        ("block-size", "block-sise", "line 12, set.block-sise"),
        ("$u$", "$\\wrong$", "line 21: the formula"),
    ] {
        let lesson = lesson(&TEXT.replace(right, wrong));
        let faults: Vec<_> = lesson.faults().map(|(page, why)| format!("{page}: {why}")).collect();
        assert!(faults[0].contains(line), "{wrong}: {faults:?}");
        assert!(lesson.pages[3].session.is_ok(), "{wrong}");
    }
    let why = |text: &str| Lesson::parse("x", text, Path::new(".")).err().map(|why| why.to_string());
    assert!(why("no title").is_some_and(|why| why.contains("# and a title")));
    assert!(why("# Title\nWords.").is_some_and(|why| why.contains("no page")));
    assert!(why("# Title\n+++\ntitle = \"x\"").is_some_and(|why| why.starts_with("line 2: ")));
}

#[test]
fn what_is_shown_becomes_a_page() {
    let lesson = lesson(TEXT);
    let session = session(&lesson, 0);
    let page = page_text(session, Path::new(".")).unwrap_or_else(|why| panic!("{why}"));
    let text = format!("# Copied\n\n{page}Words.\n").replace("title = \"\"", "title = \"Copied\"");
    let copied = Lesson::parse("copied", &text, Path::new(".")).unwrap_or_else(|why| panic!("{why}"));
    assert!(copied.pages[0].session.as_ref().is_ok_and(|copy| copy == session), "{page}");
    assert!(page.contains("block-size = 8") && !page.contains("search-range"), "defaults are left out: {page}");
}

#[test]
fn pages_have_names() {
    let parse = |name: &str| Address::parse(OsStr::new(name));
    let of = |lesson: &str, page| Some(Address { lesson: lesson.into(), page });
    assert_eq!(parse("lesson:kalman-filter"), of("lesson:kalman-filter", 0));
    assert_eq!(parse("lesson:kalman-filter/3"), of("lesson:kalman-filter", 2));
    assert_eq!(parse("notes/week 3.md#12"), of("notes/week 3.md", 11));
    assert_eq!(parse("notes/week 3.md"), of("notes/week 3.md", 0));
    assert_eq!((parse("clip.mp4"), parse("example:klt/x"), parse("clip#2.mp4")), (None, None, None));
    for name in ["lesson:kalman-filter/3", "week.md#2"] {
        assert_eq!(parse(name).map(|address| address.name()), Some(name.into()));
    }
    assert!(named(OsStr::new("lesson:none")).is_some_and(|session| session.is_err()));
}

#[test]
fn a_lesson_cut_anywhere_is_read_or_refused() {
    let ends = TEXT.char_indices().map(|(at, _)| at);
    let read = ends.filter(|end| Lesson::parse("x", &TEXT[..*end], Path::new(".")).is_ok()).count();
    assert!(read > 80, "{read}: all but those that end in a header");
}
