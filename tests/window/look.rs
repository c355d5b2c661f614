//! How pictures look: the same by flag, by session and in the window, for every entry of a look.

use std::ffi::OsStr;

use motionscope::experiment::{Experiment, Position};
use motionscope::paint::FlowLayer;
use motionscope::session::Session;
use motionscope::view::look::Changes;
use motionscope_core::course::estimator;
use motionscope_core::params::{Kind, Params, Spec};
use motionscope_core::scene::Quantity;

use super::files::command_line;
use super::*;

/// A clip with true motion and things that hide others, small enough to be run often.
const CLIP: &str = "synth:parallax,width=96,height=72,frames=2";

/// Values of an entry: the least, one between and the largest, or all that there are.
fn tried(kind: &Kind) -> Vec<Value> {
    match kind {
        Kind::Int { min, max } => vec![Value::Int(*min), Value::Int((min + max) / 16), Value::Int(*max)],
        Kind::Real { min, max } => [*min, 0.75 * min + 0.25 * max, *max].map(Value::Real).into(),
        Kind::Switch => vec![Value::Switch(true), Value::Switch(false)],
        Kind::Choice(all) => all.iter().map(|choice| Value::Choice(choice.name)).collect(),
        Kind::Optional { of, word } => [tried(of), vec![Value::Choice(word)]].concat(),
        Kind::Placed(_) | Kind::Stage(_) => Vec::new(),
    }
}

/// What an entry of a look is seen on, and where.
fn seen_on(entry: &Spec) -> (Experiment, Look, Option<Cursor>) {
    let with = |id: &str, set: &[(&str, &str)]| {
        let mut estimator = estimator(id).expect("it exists");
        set.iter().for_each(|(name, value)| estimator.set(name, value).expect("it has such a parameter"));
        Experiment::new(Source::parse(CLIP).expect("a scene"), estimator)
    };
    // Another value than any by default, so that each must be set to be seen.
    let look = Look { view: Some(View::Current), legend: true, ..Look::default() };
    match entry.name.as_str() {
        "level" => {
            let step = Cursor { unit: 1, event: 4 };
            (with("hierarchical", &[("block-size", "8"), ("levels", "3")]), look, Some(step))
        }
        "focus" => {
            let step = Cursor { unit: 5, event: 4 };
            (with("full-search", &[("search-range", "4")]), look, Some(step))
        }
        "landscape" => {
            let step = Cursor { unit: 5, event: 4 };
            (with("full-search", &[("search-range", "4")]), Look { view: Some(View::Next), ..look }, Some(step))
        }
        "colors" => (with("lucas-kanade", &[]), Look { layer: Some(FlowLayer::Magnitude), ..look }, None),
        "blend" => (with("full-search", &[("search-range", "4")]), Look { view: Some(View::Blend), ..look }, None),
        _ => (with("lucas-kanade", &[]), look, None),
    }
}

#[test]
fn every_entry_is_the_same_by_flag_by_session_and_in_the_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let [base, set, kept] = ["base", "set", "kept"].map(|name| path(&format!("{name}.motionscope")));
    let read = |name: &str| fs::read(path(name)).expect("a picture");
    let mut count = 0;
    for (index, spec) in Look::entries().iter().enumerate() {
        let (experiment, usual, cursor) = seen_on(spec);
        let position = Position { cursor, held: None };
        let session = |look: Look| Session {
            experiment: experiment.clone(),
            position,
            look: look.into(),
            sight: None,
            freehand: Default::default(),
        };
        session(usual).save(&base).expect("it is written");
        let mut window = Window::with(vec2(1200.0, 800.0), Start { open: Some(base.clone().into()) });
        if cursor.is_none() {
            // The command line paints the end of a run.
            window.command(Command::End);
        }
        let mut seen = Vec::new();
        // How words are written is seen in SVG alone.
        let extension = if &*spec.name == "svg-text" { "svg" } else { "png" };
        let [flag_file, session_file, window_file] =
            ["flag", "session", "window"].map(|name| format!("{name}.{extension}"));
        // The coarsest level of three is level 2; a difference of flows needs two estimators, and
        // Lucas–Kanade has no model.
        let fits = |value: &Value| match (&*spec.name, value) {
            ("level", Value::Int(level)) => *level <= 2,
            ("layer", Value::Choice(id)) => *id != "difference" && Quantity::ALL.iter().all(|one| one.id() != *id),
            _ => true,
        };
        for value in tried(&spec.kind).into_iter().filter(fits) {
            let (told, what) = (value.to_string(), format!("{} {value}", spec.name));
            let mut look = usual;
            look.set_value(index, value).expect("it may be that");
            let paint = |session: &Path, rest: &[&str], to: &str| {
                let to = path(to);
                let words = [OsStr::new("motionscope"), OsStr::new("run"), session.as_os_str()];
                let rest: Vec<_> = rest.iter().map(OsStr::new).collect();
                command_line(&[&words[..], &rest, &[OsStr::new("--overlay"), to.as_os_str()]].concat());
            };
            let flag = format!("--{}={told}", spec.name);
            paint(&base, &[&flag], &flag_file);
            session(look).save(&set).expect("it is written");
            assert_eq!(Session::load(&set).expect("a session").look.over(Look::default()), look, "{what}");
            paint(&set, &[], &session_file);
            window.harness.state_mut().set_look(&spec.name, &told).expect("it may be that");
            for _ in 0..4 {
                window.harness.run_steps(2);
                window.harness.state_mut().wait();
            }
            assert_eq!(window.app().settings().look, look, "{what}");
            for (file, wanted) in [(path(&window_file), OutputKind::Picture), (kept.clone(), OutputKind::Session)] {
                window.harness.state_mut().write(Order {
                    what: wanted,
                    path: file,
                    scale: 1,
                    look,
                    panes: Selection::default(),
                });
                window.harness.state_mut().wait();
            }
            assert_eq!(Session::load(&kept).expect("a session").look, Changes::from(look), "{what}");
            assert!(read(&flag_file) == read(&session_file), "{what}: another picture by session than by flag");
            assert!(read(&flag_file) == read(&window_file), "{what}: another picture in the window than by flag");
            seen.push(read(&flag_file));
            count += 1;
        }
        seen.sort();
        seen.dedup();
        assert!(seen.len() > 1, "{}: all of its values look the same", spec.name);
    }
    assert!(count > 40, "{count}");
}

#[test]
fn a_streakline_keeps_its_moment_through_the_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let [first, second] = ["first.motionscope", "second.motionscope"].map(|name| folder.path().join(name));
    let text = format!(
        "motionscope = 1\nclip = \"{CLIP}\"\nestimator = \"lucas-kanade\"\nstep = \"0\"\n[picture]\nstreaks = 0.25\n"
    );
    fs::write(&first, text).expect("the session");
    let mut window = Window::with(vec2(1200.0, 800.0), Start { open: Some(first.into()) });
    let look = window.app().settings().look;
    window.harness.state_mut().write(Order {
        what: OutputKind::Session,
        path: second.clone(),
        scale: 1,
        look,
        panes: Selection::default(),
    });
    window.settle();
    let kept = Session::load(&second).expect("a session").look.over(Look::default());
    assert_eq!(kept.streaks.map(|phase| phase.get()), Some(0.25));
}

#[test]
fn the_sliders_of_motion_set_entries_of_the_look_and_leave_them_open_again() {
    let mut window = Window::with(vec2(1200.0, 800.0), Start { open: Some(CLIP.into()) });
    window.command(Command::Layer(FlowLayer::Wheel));
    window.click("Motion");
    let look = |window: &Window| window.app().settings().look;
    let before = look(&window);
    for (slider, value, entry, told) in [
        ("Opacity of the colours in %", 40.0, "layer-opacity", "0.4"),
        ("Spacing in px", 24.0, "arrow-spacing", "24"),
        ("Length of arrows", 4.0, "arrow-scale", "4"),
    ] {
        window.harness.get_by_role_and_label(Role::Slider, slider).set_value_accesskit(value);
        window.settle();
        assert_eq!(look(&window).get(entry).map(|value| value.to_string()), Ok(told.to_owned()));
    }
    for name in ["Opacity auto", "Spacing auto", "Length of arrows auto"] {
        window.click(name);
    }
    assert_eq!(look(&window), before);
    window.click("Streaklines");
    assert!(look(&window).streaks.is_some());
    window.click("Arrows");
    assert_eq!(look(&window), before);
}
