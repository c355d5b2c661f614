//! What is seen of motion in the window: layers of colours, streaklines, and the charts that go with them.

use super::*;
use motionscope::paint::{FlowLayer, Tint, TintKey};
use motionscope_core::scene::{Quantity, Shape};

/// A window on a session with these lines.
fn window(lines: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    fs::write(&path, format!("motionscope = 1\n{lines}")).expect("it is written");
    Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) })
}

/// A small clip whose object hides the ground behind it.
const CLIP: &str = "clip = \"synth:parallax,width=96,height=72\"\n";

fn dense() -> Window {
    window(&format!("{CLIP}estimator = \"horn-schunck\"\nstep = \"2.1\"\n[set]\niterations = 12\n"))
}

fn tint(window: &Window) -> Option<&Tint> {
    window.shown().pictures.layer.as_deref()
}

fn kind(window: &Window) -> FlowLayer {
    tint(window).map_or(FlowLayer::None, |tint| tint.kind)
}

/// The layer of which the legend says that it comes with the end of the run.
fn awaited(window: &Window) -> Option<&'static str> {
    let said = |name: &&str| {
        let told = format!("{name}: at the end of the run");
        window.harness.query_by_label_contains(&told).is_some()
    };
    ["error", "confidence", "consistency"].into_iter().find(said)
}

#[test]
fn a_key_goes_through_the_layers_that_there_are() {
    let mut window = dense();
    assert_eq!(kind(&window), FlowLayer::Wheel, "a dense field has its colours by itself");
    let (none, wheel, length) = (FlowLayer::None, FlowLayer::Wheel, FlowLayer::Magnitude);
    let share = FlowLayer::Model(Quantity::SmoothnessShare);
    let awaited_at_the_end = [(wheel, Some("error")), (wheel, Some("consistency"))];
    for seen in
        [(length, None)].into_iter().chain(awaited_at_the_end).chain([(share, None), (none, None), (wheel, None)])
    {
        window.key(Key::M);
        assert_eq!((kind(&window), awaited(&window)), seen);
    }
    window.command(Command::Layer(FlowLayer::Confidence));
    assert_eq!(kind(&window), wheel, "a command that makes no sense does nothing");
    window.command(Command::Layer(FlowLayer::Error));
    assert_eq!((kind(&window), awaited(&window)), (wheel, Some("error")));
    window.command(Command::End);
    assert_eq!((kind(&window), awaited(&window)), (FlowLayer::Error, None));
    assert!(window.harness.query_by_label_contains("colours for endpoint error 0 to").is_some());
    window.command(Command::IntoBack);
    assert_eq!((kind(&window), awaited(&window)), (wheel, Some("error")), "what is not there gives way");
    window.command(Command::End);
    assert_eq!(kind(&window), FlowLayer::Error, "and comes back");
    window.command(Command::IntoBack);
    window.key(Key::M);
    assert_eq!((kind(&window), awaited(&window)), (wheel, Some("consistency")), "the key goes on from what is chosen");
}

#[test]
fn a_locked_scale_is_that_of_every_step_until_it_is_released() {
    let mut window = dense();
    let end = |window: &Window| tint(window).expect("colours").end();
    let here = end(&window);
    window.command(Command::End);
    let usual = end(&window);
    assert!(here > 0.0 && (usual - here).abs() > 0.05 * here, "an unlocked scale adapts to the step: {here}, {usual}");
    window.command(Command::LockScale);
    assert_eq!(window.app().settings().look.color_scale, Some(usual));
    window.command(Command::Start);
    window.key(Key::PageDown);
    assert_eq!(end(&window), usual);
    window.command(Command::LockScale);
    assert_eq!(window.app().settings().look.color_scale, None);
    assert_ne!(end(&window), usual);
}

#[test]
fn the_reverse_pair_is_checked_in_the_background() {
    let mut window = dense();
    window.command(Command::End);
    window.command(Command::Layer(FlowLayer::Consistency));
    assert!(matches!(tint(&window).map(|tint| &tint.key), Some(TintKey::Scale { has_marks: true, .. })));
    assert!(!window.app().view().checking);
    assert!(window.harness.query_by_label_contains("Inconsistent: ").is_some());
    let criterion = "Criterion: |w + w′|² ≥ 0.01 (|w|² + |w′|²) + 0.5 px²";
    assert!(window.harness.query_by_label_contains(criterion).is_some());
    assert!(window.harness.query_by_label_contains("Occlusion: precision ").is_some());
    let shown = window.shown().pictures.layer.clone().expect("a layer");
    // Pointing at a pixel explains it; the colours stay the very same.
    window.harness.get_by_label("Stage: Frame t = 0").hover();
    window.settle();
    let now = window.shown().pictures.layer.clone().expect("a layer");
    assert!(std::sync::Arc::ptr_eq(&shown.pixels, &now.pixels));
}

#[test]
fn blocks_have_colours_where_they_are_wanted() {
    let mut window = window(&format!("{CLIP}estimator = \"full-search\"\n[set]\nblock-size = 8\nsearch-range = 4\n"));
    window.command(Command::End);
    assert_eq!((kind(&window), window.shown().at_end), (FlowLayer::None, true));
    window.command(Command::Layer(FlowLayer::Magnitude));
    assert_eq!(kind(&window), FlowLayer::Magnitude);
    window.key(Key::B);
    assert!(window.shown().tiles.iter().all(|tile| tile.layer.is_some()), "each of several has its own");
    let keys: Vec<_> = window.shown().tiles.iter().filter_map(|tile| tile.layer.as_ref()).map(|t| &t.key).collect();
    assert!(keys.windows(2).all(|pair| pair[0] == pair[1]), "on one scale");
    assert!(!Command::Layer(FlowLayer::Consistency).enabled(&motionscope::ui::commands::Situation {
        has_run: true,
        available: window.shown().available,
        ..Default::default()
    }));
}

#[test]
fn streaklines_move_while_they_are_seen_and_only_then() {
    let mut window = dense();
    window.command(Command::End);
    assert!(window.shown().pictures.streaks.is_none());
    window.harness.key_press(Key::S);
    window.harness.run_steps(2);
    window.harness.state_mut().wait();
    window.harness.run_steps(3);
    assert!(window.shown().pictures.streaks.as_ref().is_some_and(|streaks| !streaks.at(0.5).is_empty()));
    assert!(window.harness.query_by_label_contains("where particles would go in ").is_some());
    // With motion reduced they stand still: the window comes to rest.
    window.harness.state_mut().command(Command::ReducedMotion);
    window.settle();
    window.key(Key::S);
    assert!(window.shown().pictures.streaks.is_none());
    assert!(window.harness.query_by_label_contains("estimated flow").is_some());
}

#[test]
fn what_is_chosen_is_kept_in_a_session() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = dense();
    window.command(Command::End);
    window.command(Command::Layer(FlowLayer::Magnitude));
    let path = folder.path().join("two.motionscope");
    let look = Look::default();
    window.harness.state_mut().write(Order {
        what: OutputKind::Session,
        path: path.clone(),
        scale: 1,
        look,
        panes: Selection::default(),
    });
    window.settle();
    let session = Session::load(&path).unwrap();
    let look = session.look.over(Look::default());
    assert_eq!((look.layer, look.arrow_spacing), (Some(FlowLayer::Magnitude), None));
    let again = Window::with(vec2(1440.0, 900.0), Start { open: Some(path.clone().into()) });
    assert_eq!(kind(&again), FlowLayer::Magnitude);
    // Colours are as opaque as a session says.
    let alpha = |window: &Window| tint(window).map(|tint| tint.pixels[(30, 30)][3]);
    assert!(alpha(&again).is_some_and(|alpha| alpha < 255), "the picture is seen through the colours");
    let text = std::fs::read_to_string(&path).unwrap().replace("layer-opacity = \"auto\"", "layer-opacity = 1.0");
    std::fs::write(&path, text).unwrap();
    let opaque = Window::with(vec2(1440.0, 900.0), Start { open: Some(path.into()) });
    assert_eq!((kind(&opaque), alpha(&opaque)), (FlowLayer::Magnitude, Some(255)));
}

#[test]
fn only_charts_with_something_to_show_are_there() {
    let mut window = dense();
    window.command(Command::Start);
    assert!(!window.has(Region::Chart));
    window.command(Command::End);
    assert!(window.charts().contains(&"Errors".to_owned()), "{:?}", window.charts());
    window.chart("Errors");
    assert!(window.harness.query_by_label_contains("Endpoint error: mean ").is_some());
    let mut window = self::window(&format!("{CLIP}estimator = \"full-search\"\nstep = \"1.1\"\n"));
    let all = window.charts();
    assert_eq!(all[0], "Cost surface", "what matters most comes first: {all:?}");
    window.key(Key::N);
    window.press(Modifiers::SHIFT, Key::N);
    assert_eq!(window.charts(), all);
    assert!(window.shown().scene.marks.iter().all(|mark| !matches!(mark.shape, Shape::Flow { .. })));
}

/// How soon the window wants to be drawn again by itself.
fn next_frame(window: &mut Window) -> Duration {
    window.harness.step();
    let views = window.harness.output().viewport_output.values();
    views.map(|view| view.repaint_delay).min().unwrap_or(Duration::MAX)
}

#[test]
fn streaklines_move_where_there_are_some_and_cost_nothing_where_there_are_none() {
    let mut window = dense();
    window.key(Key::End);
    window.key(Key::S);
    assert!(window.shown().pictures.streaks.as_ref().is_some_and(|streaks| !streaks.is_empty()));
    assert!(next_frame(&mut window) < Duration::from_secs(1), "particles move");

    // Two frames alike: nothing moves at all.
    let folder = tempfile::tempdir().expect("a folder");
    for index in 0..2 {
        let picture = image::GrayImage::from_fn(64, 48, |x, y| image::Luma([(x * 3 + y * 5) as u8]));
        picture.save(folder.path().join(format!("frame_{index}.png"))).expect("a picture");
    }
    window.harness.state_mut().open(folder.path());
    window.settle();
    window.key(Key::End);
    assert!(window.shown().at_end);
    assert!(window.shown().pictures.streaks.as_ref().is_some_and(|streaks| streaks.is_empty()), "they are wanted");
    // What is new at the end is lit for less than a second.
    let rests = (0..100).any(|_| next_frame(&mut window) == Duration::MAX);
    assert!(rests, "nothing is to be drawn");
}

/// Opens something in a window.
type Opening = fn(&mut Window);

#[test]
fn the_window_rests_whatever_is_open() {
    const OPENED: [(&str, Opening); 10] = [
        ("the run", |_| ()),
        ("the export of a picture", |window| window.command(Command::ExportPicture)),
        ("the export of steps", |window| window.command(Command::ExportSteps)),
        ("the export of a result", |window| window.command(Command::ExportResult)),
        ("a session to be saved", |window| window.command(Command::SaveSession)),
        ("a clip to be opened", |window| window.command(Command::Open)),
        ("the palette", |window| window.command(Command::Palette)),
        ("the search", |window| window.command(Command::SearchText)),
        ("the glossary", |window| window.command(Command::Glossary)),
        ("a word in the search", |window| {
            window.command(Command::SearchText);
            window.harness.get_by_label("Words to find").type_text("flow");
        }),
    ];
    for (what, open) in OPENED {
        let mut window = Window::usual();
        open(&mut window);
        window.settle();
        rests(&mut window, Duration::MAX, what);
    }
    let mut window = Window::usual();
    window.press(Modifiers::SHIFT, Key::F);
    window.settle();
    window.app().wait_for_next();
    window.settle();
    rests(&mut window, Duration::from_secs(1), "the presenter's window, whose clock counts minutes");
}

#[test]
fn a_lesson_from_a_file_rests_until_it_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.md");
    let text =
        "# Mine\n+++\ntitle = \"One\"\nclip = \"synth:pillar\"\nestimator = \"diamond\"\nstep = \"3.1\"\n+++\nWords.\n";
    fs::write(&path, text).expect("a lesson");
    let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some(path.into()) });
    window.settle();
    rests(&mut window, Duration::MAX, "a lesson from a file");
}

/// Fails unless the window comes to rest, and then asks to be drawn again no sooner than after `least`.
fn rests(window: &mut Window, least: Duration, what: &str) {
    // Marks that are new are lit, and messages stay, for some seconds.
    let is_at_rest = (0..1000).any(|_| next_frame(window) >= least);
    assert!(is_at_rest, "{what}: the window is drawn again after {:?}", next_frame(window));
    // And stays there, but for the last moment before a minute ends.
    let stays = |window: &mut Window| (0..3).all(|_| next_frame(window) >= least);
    let is_steady = stays(window) || {
        std::thread::sleep(Duration::from_millis(1500));
        (0..90).for_each(|_| window.harness.step());
        stays(window)
    };
    assert!(is_steady, "{what}");
}
