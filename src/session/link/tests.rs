//! Links as they are written and read.

use motionscope_core::course::{estimator, estimators, examples};
use motionscope_core::run::{Cursor, Pace};

use super::super::tests::{session, vary};
use super::*;
use crate::experiment::Position;
use crate::experiment::side_by_side::SideBySide;
use crate::paint::Freehand;
use crate::session::lesson;

fn opened(fragment: &str) -> Session {
    let (link, faults) = Link::parse(fragment);
    assert!(faults.is_empty(), "{fragment}: {faults:?}");
    link.session.unwrap_or_else(|| panic!("{fragment} opens no run"))
}

/// Whether both are the same but for ink, theme and folders.
fn are_alike(a: &Session, b: &Session) -> bool {
    let look = |session: &Session| session.look.clone().without("theme").over(Look::of_window());
    let rest = |session: &Session| {
        without_folders(Session { look: Changes::default(), freehand: Freehand::default(), ..session.clone() })
    };
    look(a) == look(b) && rest(a) == rest(b)
}

fn round_trip(session: &Session, page: Option<&Address>) -> String {
    let fragment = Link::of(session, page).unwrap_or_else(|why| panic!("{why}"));
    let is_plain = |letter: char| letter.is_ascii_graphic() && !"<>\"'`{}|\\^()".contains(letter);
    assert!(fragment.chars().all(is_plain), "{fragment}");
    assert!(are_alike(session, &opened(&fragment)), "{fragment}");
    let (link, _) = Link::parse(&fragment);
    assert_eq!(link.page.as_ref(), page, "{fragment}");
    fragment
}

fn at(session: &Session, cursor: Cursor) -> Session {
    let position = Position { cursor: Some(cursor), ..session.position };
    let usual = Look::opening(session.experiment.estimator.shows_frame_alone());
    Session { position, look: Changes::from(usual).then(&session.look), ..session.clone() }
}

#[test]
fn every_page_and_every_example_comes_back_at_any_step() {
    for lesson in lesson::all() {
        for (index, page) in lesson.pages.iter().enumerate() {
            let address = Address { page: index, ..Address::from(lesson) };
            let session = page.session.as_ref().unwrap_or_else(|why| panic!("{why}"));
            let name = address.name().to_string_lossy().into_owned();
            let first = session.position.cursor.unwrap_or_default();
            assert_eq!(round_trip(&at(session, first), Some(&address)), name);
            let link = round_trip(&at(session, Cursor { unit: 35, event: 412 }), Some(&address));
            assert_eq!(link, format!("{name}&step=36.412"));
        }
    }
    for estimator in estimators() {
        let id = estimator.info().id;
        for one in examples::of(id) {
            let session = super::super::example::session(id, one).unwrap_or_else(|why| panic!("{why}"));
            let link = round_trip(&at(&session, Cursor { unit: 0, event: 7 }), None);
            assert!(link.starts_with("example:") && link.len() < 100, "{link}");
            assert_eq!(Link::parse(&link).0.description, Some(super::super::example::description(one)));
        }
    }
}

#[test]
fn every_estimator_with_any_parameters_comes_back() {
    for dice in 0..6 {
        for mut estimator in estimators() {
            vary(&mut *estimator, dice);
            let mut look = Look::default();
            vary(&mut look, dice);
            let experiment = Experiment {
                frame: dice as usize,
                ..Experiment::new(Source::parse("synth:pillar,noise=5").unwrap(), estimator)
            };
            let session = Session { experiment, look: look.into(), ..session(Source::synth("pillar").unwrap()) };
            round_trip(&session, None);
        }
    }
}

#[test]
fn lockstep_and_files_come_back_without_folders() {
    for source in ["clips/ball & net=2.mp4", "pair:clips/a.png|b.png", "C:\\clips\\Bäume.avi"] {
        let mut saved = session(Source::parse(source).unwrap());
        saved.experiment.given.truth = Some("/home/me/truth.flo".into());
        let link = round_trip(&saved, None);
        assert!(!link.contains("clips") && !link.contains("home") && !link.contains("ink"), "{link}");
        assert!(link.contains("&beside=diamond,hierarchical") && link.contains("&set.3.levels=4"), "{link}");
        assert!(Link::parse(&link).0.own_files().is_some());
    }
    for leader in estimators() {
        for other in estimators() {
            let Ok(mut side_by_side) = SideBySide::of(&*leader, &[other.info().id], Pace::Block) else { continue };
            let mut varied = other.boxed_clone();
            vary(&mut *varied, 3);
            for index in 0..varied.specs().len() {
                side_by_side.beside[0].set_value(index, varied.value(index)).unwrap();
            }
            let source = Source::synth("pillar").unwrap();
            let experiment = Experiment { side_by_side, ..Experiment::new(source.clone(), leader.boxed_clone()) };
            round_trip(&Session { experiment, ..session(source) }, None);
        }
    }
}

#[test]
fn what_a_page_sets_can_be_taken_back() {
    let address = Address::parse(OsStr::new("lesson:kalman-filter/3")).unwrap();
    let page = address.load().unwrap().page(2).unwrap().session.clone().unwrap();
    let plain =
        Experiment::new(page.experiment.source.clone(), estimator(page.experiment.estimator.info().id).unwrap());
    let other = Experiment::new(Source::synth("pillar").unwrap(), estimator("diamond").unwrap());
    for experiment in [plain, other] {
        round_trip(&at(&Session { experiment, ..page.clone() }, Cursor::default()), Some(&address));
    }
}

#[test]
fn links_are_read_as_on_the_command_line() {
    let link =
        "https://example.org/page/#synth:pillar,noise=5&estimator=diamond&step=164.14&set.search-range=8&view=embed";
    let (link, faults) = Link::parse(link);
    assert!(faults.is_empty() && link.parts == Parts::Embedded, "{faults:?}");
    let session = link.session.expect("a run");
    assert_eq!(session.experiment.source.to_string(), "synth:pillar,noise=5");
    assert_eq!(session.experiment.estimator.get("search-range").unwrap().to_string(), "8");
    assert_eq!(session.position.cursor, Some(Cursor { unit: 163, event: 14 }));
    let written = Link::of(&session, None).unwrap();
    assert_eq!(written, "synth:pillar,noise=5&estimator=diamond&step=164.14&set.search-range=8");
    assert!(Link::parse("").0.session.is_none() && Link::parse("#").1.is_empty());
    assert_eq!(Link::parse("view=present").0.parts, Parts::Presented);
    assert_eq!(opened("estimator=diamond").experiment.source.to_string(), "synth:pillar");
    assert_eq!(opened("synth:pillar&pixel=30,20").position.cursor, Some(Cursor::default()), "wherever it was left");
    assert_eq!(opened("%73ynth%3Apillar").experiment.estimator.info().id, first::EXAMPLE);
    assert!(Link::is_one(OsStr::new("#lesson:x")) && Link::is_one(OsStr::new("http://a/#b")));
    assert!(!Link::is_one(OsStr::new("week 4.md#2")) && !Link::is_one(OsStr::new("synth:pillar")));
    assert!(Link::of(&Session { experiment: Experiment::first(Source::File("-".into())), ..session }, None).is_err());
}

#[test]
fn what_is_wrong_is_said_and_the_rest_is_opened() {
    for (wrong, said, rest) in [
        ("synth:pillar&estimator=dimond&frame=2", "the nearest is diamond", "synth:pillar&frame=2"),
        ("synth:pilar&estimator=diamond", "the nearest is pillar", "synth:pillar&estimator=diamond"),
        (
            "synth:pillar,nois=5,speed=2&estimator=diamond",
            "the nearest is noise",
            "synth:pillar,speed=2&estimator=diamond",
        ),
        (
            "synth:pillar&estimator=diamond&set.serch-range=8&frame=1",
            "the nearest is search-range",
            "synth:pillar&estimator=diamond&frame=1",
        ),
        ("synth:pillar&estimator=diamond&set.search-range=x", "set.search-range", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&frmae=1", "the nearest is frame", "synth:pillar&estimator=diamond"),
        (
            "synth:pillar&estimator=diamond&frame=-1",
            "frame: a whole number from 0 on",
            "synth:pillar&estimator=diamond",
        ),
        ("synth:pillar&estimator=diamond&step=x", "step", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&picture.legend=perhaps", "true or false", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&sight.zoom=2", "sight has no key center", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&sight.center=nan,2&sight.zoom=2", "no part", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&what", "what is not written as KEY=VALUE", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&view=embd", "the nearest is embed", "synth:pillar&estimator=diamond"),
        ("synth:pillar&estimator=diamond&beside=dimond", "the nearest is diamond", "synth:pillar&estimator=diamond"),
        ("lesson:kalman-filter/99", "pages", "lesson:kalman-filter/1"),
    ] {
        let (link, faults) = Link::parse(wrong);
        let all = faults.iter().map(ToString::to_string).collect::<Vec<_>>();
        assert!(all.len() == 1 && all[0].contains(said) && !all[0].contains("line "), "{wrong}: {all:?}");
        assert!(link.session.as_ref().is_some_and(|session| are_alike(session, &opened(rest))), "{wrong}");
    }
    for wrong in ["lesson:kalman", "example:horn-schunck/fill", "example:x", &"a".repeat(9000)] {
        let (link, faults) = Link::parse(wrong);
        assert!(link.session.is_none() && faults.len() == 1, "{wrong}: {faults:?}");
    }
}

/// Letters of links and others, put together by chance.
#[test]
fn no_text_is_more_than_a_link_can_bear() {
    let parts = [
        "synth:",
        "pillar",
        "&",
        "=",
        "%",
        "set.",
        "estimator",
        "diamond",
        "beside",
        ",",
        "2.",
        "\"",
        "\n",
        "ü",
        "sight.zoom",
        "..",
        "/",
        "lesson:",
        "#",
        "frame",
        "step",
        "9",
        "[",
        "\\",
        "ink",
        "object",
        "pixel",
    ];
    let mut dice = 1_u64;
    for _ in 0..3000 {
        let mut text = String::new();
        for _ in 0..12 {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text += parts[(dice >> 33) as usize % parts.len()];
        }
        let (link, _) = Link::parse(&text);
        link.session.iter().for_each(|session| drop(Link::of(session, link.page.as_ref())));
    }
}
