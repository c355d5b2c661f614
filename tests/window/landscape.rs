//! The picture leaned back, and what rises from it.

use super::files::{paint, write_to};
use super::pixels::pane_of;
use super::*;
use motionscope::paint::Placement;
use motionscope::paint::charts::Orbit;
use motionscope::paint::charts::relief::{Landscape, Lean, standing};
use motionscope::paint::primitive;

/// A window in the midst of a block of a search.
fn window() -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let lines = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"diamond\"\nstep = \"100.9\"\n";
    fs::write(&path, lines).expect("it is written");
    Window::with(vec2(1280.0, 720.0), Start { open: Some(path.into()) })
}

/// Whether the picture of frame t + 1 is drawn in perspective: in many triangles.
fn leans(window: &Window) -> bool {
    let pane = pane_of(window, "Frame t+1");
    let meshes = window.harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        eframe::egui::Shape::Mesh(mesh) if clipped.clip_rect == pane => Some(mesh.vertices.len()),
        _ => None,
    });
    meshes.max().unwrap_or(0) > 300
}

/// Where a displacement is seen once the picture is leaned back.
fn seen(window: &Window, displacement: [i32; 2]) -> Pos2 {
    let pane = pane_of(window, "Frame t+1");
    let pane = primitive::Rect { min: pane.min.into(), max: pane.max.into() };
    let (surface, footing) = standing(&window.shown().step).expect("a surface");
    let surface = surface.landscape();
    let lean = Lean { amount: 1.0, orbit: Orbit::default() };
    let landscape = Landscape::new((&surface, footing), (Placement::new([0.0; 2], 1.0), pane), lean);
    landscape.seen(displacement).expect("it is seen").into()
}

#[test]
fn a_picture_leans_back_and_folds_flat_again() {
    let mut window = window();
    assert!(!leans(&window));
    window.key(Key::P);
    assert!(window.app().settings().look.landscape && leans(&window));
    window.key(Key::P);
    assert!(!leans(&window));
    // Where nothing rises from a picture, it stays flat.
    window.key(Key::P);
    window.command(Command::Start);
    assert!(!leans(&window));
    window.command(Command::Into);
    assert!(leans(&window), "it leans again with the first candidates");
}

#[test]
fn a_click_on_a_candidate_goes_to_its_step() {
    let mut window = window();
    window.key(Key::P);
    let tested = standing(&window.shown().step).expect("a surface").0.path();
    let first = tested[0];
    let (surface, _) = standing(&window.shown().step).expect("a surface");
    let event = motionscope::paint::charts::heat_map::event(surface, first).expect("tested");
    let before = window.cursor();
    assert_ne!(before.event, event);
    let place = seen(&window, first);
    window.click_at(place);
    assert_eq!(window.cursor(), Cursor { event, ..before });
}

#[test]
fn every_cost_of_the_window_is_known_to_the_landscape_and_the_tested_ones_are_the_run_s() {
    let window = window();
    let (surface, footing) = standing(&window.shown().step).expect("a surface");
    let (whole, known) = (footing.whole.as_ref().expect("a block search knows all"), &surface.values);
    assert!(whole.cells().iter().filter(|cost| cost.is_finite()).count() > 5 * surface.path().len());
    for (tested, cost) in known.cells().iter().zip(whole.cells()).filter(|(tested, _)| tested.is_finite()) {
        assert_eq!(tested, cost);
    }
}

#[test]
fn a_saved_session_leans_as_the_window_did() {
    let folder = tempfile::tempdir().expect("a folder");
    let [flat, leaned] = ["flat", "leaned"].map(|name| folder.path().join(name).with_extension("motionscope"));
    let mut window = window();
    let save = |window: &mut Window, path: &Path| {
        window.command(Command::SaveSession);
        write_to(window, path);
    };
    save(&mut window, &flat);
    window.key(Key::P);
    save(&mut window, &leaned);
    let [flat, leaned] = [flat, leaned].map(|session| {
        let file = session.with_extension("png");
        paint(&session, 1, &file);
        image::open(file).expect("a picture").to_rgb8()
    });
    assert_eq!(flat.dimensions(), leaned.dimensions());
    let differ = flat.pixels().zip(leaned.pixels()).filter(|(a, b)| a != b).count();
    assert!(differ > flat.pixels().len() / 4, "{differ} pixels differ");
}

#[test]
fn a_question_is_not_answered_by_the_landscape() {
    let mut window = window();
    window.key(Key::P);
    assert!(leans(&window));
    window.command(Command::Predict);
    for _ in 0..20 {
        if window.app().predict().open().is_some() {
            break;
        }
        window.key(Key::ArrowRight);
    }
    assert!(window.app().predict().open().is_some(), "a search asks");
    assert!(!leans(&window));
}
