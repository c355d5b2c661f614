//! The picture leaned back, and what rises from it.

use super::files::{paint, write_to};
use super::layout::{close_messages, words};
use super::pixels::pane_of;
use super::*;
use eframe::egui::TextureId;
use motionscope::paint::Placement;
use motionscope::paint::charts::Orbit;
use motionscope::paint::charts::relief::{Landscape, Lean, standing};
use motionscope::paint::primitive;
use motionscope::view::tile::Tile;
use motionscope_core::scene::Surface;

/// A window in the midst of a block of a search.
fn window() -> Window {
    at_step("synth:pillar", "diamond", "100.9")
}

fn at_step(clip: &str, estimator: &str, step: &str) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let lines = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"{estimator}\"\nstep = \"{step}\"\n");
    fs::write(&path, lines).expect("it is written");
    Window::with(vec2(1280.0, 720.0), Start { open: Some(path.into()) })
}

/// A picture in perspective has more corners, a flat one has four.
const LEAST_CORNERS: usize = 8;

/// Whether a picture is drawn in perspective: in many triangles.
pub fn leans(window: &Window) -> bool {
    let meshes = window.harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        eframe::egui::Shape::Mesh(mesh) if mesh.texture_id != TextureId::default() => Some(mesh.vertices.len()),
        _ => None,
    });
    meshes.max().unwrap_or(0) > LEAST_CORNERS
}

/// The surface that rises from the picture.
fn risen(window: &Window) -> Surface {
    let readout = standing(&window.shown().step).expect("something rises");
    readout.landscape().expect("a surface")
}

/// Where a displacement is seen once the picture is leaned back.
fn seen(window: &Window, displacement: [i32; 2]) -> Pos2 {
    let pane = pane_of(window, "Frame t+1");
    let pane = primitive::Rect { min: pane.min.into(), max: pane.max.into() };
    let surface = risen(window);
    let footing = surface.footing.as_ref().expect("it stands on a picture");
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
    let surface = risen(&window);
    let first = surface.path()[0];
    let event = motionscope::paint::charts::heat_map::event(&surface, first).expect("tested");
    let before = window.cursor();
    assert_ne!(before.event, event);
    let place = seen(&window, first);
    window.click_at(place);
    assert_eq!(window.cursor(), Cursor { event, ..before });
}

#[test]
fn a_click_on_what_no_event_has_worked_out_stays_where_it_is() {
    let mut window = at_step("synth:fast-ball", "kalman-filter", "4.3");
    window.key(Key::P);
    assert!(leans(&window), "{}", window.sentence());
    let before = window.cursor();
    let pane = pane_of(&window, "Frame t");
    window.click_at(pane.center());
    assert_eq!(window.cursor(), before);
}

#[test]
fn every_cost_of_the_window_is_known_to_the_landscape_and_the_tested_ones_are_the_run_s() {
    let window = window();
    let surface = risen(&window);
    let whole = surface.footing.as_ref().and_then(|footing| footing.whole.as_ref());
    let (whole, known) = (whole.expect("a block search knows all"), &surface.values);
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

#[test]
fn untested_candidates_are_hidden_while_questions_are_asked() {
    let mut window = window();
    window.key(Key::P);
    let painted = |window: &Window| window.harness.output().shapes.len();
    let whole = painted(&window);
    window.command(Command::Predict);
    assert!(window.app().predict().is_on() && window.app().predict().open().is_none());
    assert!(leans(&window), "what was tested still rises");
    assert!(painted(&window) + 100 < whole, "{} of {whole} shapes", painted(&window));
    window.command(Command::Predict);
    // A message says that the questions are off.
    close_messages(&mut window);
    assert_eq!(painted(&window), whole);
}

#[test]
fn searches_side_by_side_stand_on_each_others_terrain() {
    let mut window = window();
    window.command(Command::Lockstep);
    for _ in 0..6 {
        window.key(Key::ArrowRight);
    }
    let names: Vec<_> = window.shown().tiles.iter().map(|tile| tile.info.name).collect();
    assert!(names.len() > 1);
    let written = |window: &Window, name: &str| {
        words(&window.harness.output().shapes).iter().filter(|word| word.text == name).count()
    };
    let flat: Vec<_> = names.iter().map(|name| written(&window, name)).collect();
    window.key(Key::P);
    assert!(leans(&window));
    let best = |tile: &Tile| Some((tile.info.name, standing(&tile.step)?.landscape()?.best));
    let best: Vec<_> = window.shown().tiles.iter().map(best).collect();
    for (name, flat) in names.iter().zip(flat) {
        let on_others = written(&window, name) - flat;
        assert_eq!(on_others, names.len() - 1, "{name} stands on the terrain of the others: {best:?}");
    }
}
