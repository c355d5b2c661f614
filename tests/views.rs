//! The views driven headlessly: what they show has a name, and what a person does comes back.

use std::cell::Cell;
use std::sync::Arc;

use eframe::egui::accesskit::Role as Node;
use eframe::egui::epaint::ColorMode;
use eframe::egui::{
    Color32, Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, Rect, Shape, TouchPhase, Ui, UiBuilder,
    Vec2, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use motionscope::paint::charts;
use motionscope::paint::charts::Orbit;
use motionscope::paint::{ColorMap, Layer, Pictures, Theme, View};
use motionscope::ui::charts::{heat_map, series, surface3d, tiles};
use motionscope::ui::drawing::chart::{Subject, rect_of};
use motionscope::ui::drawing::primitives::shapes;
use motionscope::ui::drawing::style;
use motionscope::ui::layout::Panes;
use motionscope::ui::panes::explanation;
use motionscope::ui::panes::glossary::Beside;
use motionscope::ui::stage::{self, Zoom};
use motionscope::view::look::{Look, RunState};
use motionscope::view::motion::AvailableLayers;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::families::block_matching::FullSearch;
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::run::{AnyEstimator, Cursor, Move, Walk};
use motionscope_core::scene::{Focus, Picture, Readout, Role, Scene, Step, Surface, Tile};

/// A walk through a pair that moves by (2, 1), some way into a block.
struct Fixture {
    walk: Box<dyn Walk>,
    pictures: Pictures,
    scene: Arc<Scene>,
    step: Arc<Step>,
    available: AvailableLayers,
}

fn fixture(cursor: Cursor) -> Fixture {
    let texture = |x: usize, y: usize| (x * 37 + y * 101 + x * y * 7) as u8;
    let frame = |dx, dy| Frame::gray(Grid::from_fn(64, 48, |x, y| texture(x + 9 - dx, y + 9 - dy)));
    let clip = Clip::from_frames("moving", vec![frame(0, 0), frame(2, 1)]).expect("two frames of one size");
    let mut search = FullSearch::default();
    search.set("search-range", "4").expect("in range");
    let mut walk = AnyEstimator::walk(&search, &clip, 0).expect("the clip suits the search");
    walk.jump(Move::To(cursor));
    let (scene, step) = (Arc::new(walk.scene(None)), Arc::new(walk.step(None)));
    let pictures = Pictures::of(clip.pair(0).expect("a pair"));
    Fixture { walk, pictures, scene, step, available: AvailableLayers::default() }
}

/// A cursor in the middle of the second block.
const MIDDLE: Cursor = Cursor { unit: 1, event: 30 };

fn harness<'a>(size: Vec2, theme: Theme, show: impl FnMut(&mut Ui) + 'a) -> Harness<'a> {
    Harness::builder()
        .with_size(size)
        .with_step_dt(1.0 / 60.0)
        .with_max_steps(60)
        .with_context_setup(move |ctx| {
            style::install_fonts(ctx);
            style::apply(ctx, style::Interface { theme, zoom: 1.0, reduced_motion: true });
        })
        .build_ui(show)
}

impl Fixture {
    /// Shows the explanation of the step.
    fn explain(&self, ui: &mut Ui, theme: Theme, state: &mut explanation::State) {
        let beside = Beside::new(&self.scene, self.walk.info().family, theme);
        let (info, step) = (self.walk.info(), &self.step);
        let input = explanation::Input { info, step, before: None, beside: &beside, at_end: false, theme };
        explanation::show(ui, (input, false), state);
    }

    fn stage(&self) -> stage::Input<'_> {
        stage::Input {
            pictures: &self.pictures,
            frame: 12,
            cursor: Cursor::default(),
            scene: &self.scene,
            step: None,
            hides_untested: false,
            lockstep: None,
            stands: RunState::default(),
            look: Look::of_window(),
            orbit: Orbit::default(),
            heat: "SAD",
            gpu: None,
            placing: None,
            available: &self.available,
            checking: false,
            animate: false,
            flows: false,
            presenting: stage::Presenting::default(),
            panes: &NOWHERE,
            is_search: false,
        }
    }

    /// What each view is called at this step, and how many there are of it.
    fn names(&self) -> Vec<(String, usize)> {
        let pictures = ["Stage: Frame t = 12", "Stage: Frame t+1 = 13"].map(|name| (name.to_owned(), 1));
        let charts = self.step.readouts.iter().flat_map(|readout| match readout {
            // Flat and in three dimensions.
            Readout::Surface(surface) => vec![(heat_map::summary(surface), 2)],
            Readout::Series(series) => vec![(format!("{}, {}", series.title, series.y_label), 1)],
            _ => Vec::new(),
        });
        let told = (self.step.sentence.plain(), 1);
        pictures.into_iter().chain(charts).chain([told]).collect()
    }

    /// What its charts show.
    fn subject(&self, theme: Theme) -> Subject<'_> {
        Subject { step: Some(&self.step), whose: self.walk.info().name, theme, ..fresh() }
    }

    fn surface(&self) -> &Surface {
        let surface = self.step.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface),
            _ => None,
        });
        surface.expect("full search has a surface")
    }
}

/// Before the stage is laid out.
static NOWHERE: Panes = Panes::Alike(Vec::new());

/// Shows the stage in the whole of `ui`.
fn show_stage(ui: &mut Ui, input: stage::Input<'_>, state: &mut stage::State) -> stage::Response {
    let stage::Input { pictures, look, stands, .. } = input;
    let line = stage::line_height(look.theme, Some(ui.spacing().interact_size.y));
    let pictures = stage::pictures(stage::OnStage { pictures, look, stands, tiles: 0 }, look.theme, line);
    let panes = Panes::Alike(pictures.split(ui.max_rect()));
    stage::show(ui, stage::Input { panes: &panes, ..input }, state)
}

/// What is laid out anew in each frame.
fn fresh() -> Subject<'static> {
    Subject { step: None, whose: "Full search", theme: Theme::Dark, colors: ColorMap::Viridis }
}

#[test]
fn the_explanation_tells_why_in_words_symbols_and_numbers() {
    let fixture = fixture(MIDDLE);
    let mut state = explanation::State::default();
    let harness = harness(vec2(360.0, 900.0), Theme::Light, |ui| fixture.explain(ui, Theme::Light, &mut state));
    let sentence = fixture.step.sentence.plain();
    assert!(harness.query_by_label(&sentence).is_some(), "{sentence}");
    assert!(harness.query_by_label_contains("Tested: ").is_some());
    assert!(harness.query_by_label_contains("current line: ").is_some());
    let equations = fixture.step.readouts.iter().find_map(|readout| match readout {
        Readout::Equation(lines) => Some(lines),
        _ => None,
    });
    for line in equations.expect("full search has an equation") {
        assert!(harness.query_by_label(&line.plain()).is_some(), "{}", line.plain());
    }
    assert!(harness.query_by_label_contains("Jain").is_some(), "the source is cited");
}

#[test]
fn the_explanation_does_not_jump_from_step_to_step() {
    let (long, short) = (fixture(MIDDLE), fixture(Cursor { unit: 1, event: 1 }));
    let which = Cell::new(&long);
    let mut state = explanation::State::default();
    let mut harness = harness(vec2(320.0, 1200.0), Theme::Dark, |ui| {
        let shown = which.get();
        shown.explain(ui, Theme::Dark, &mut state);
    });
    // Once each kind of step was seen, there is room for all of them.
    let citations = [&short, &long, &short, &long].map(|shown| {
        which.set(shown);
        harness.run();
        let has_candidate = harness.query_by_label_contains("Candidate: ").is_some();
        assert_eq!(has_candidate, std::ptr::eq(shown, &long));
        harness.get_by_label_contains("Jain").rect().min.y
    });
    assert_eq!(citations[2..], [citations[1]; 2]);
}

/// What a projector's small picture leaves for the explanation.
const SMALL_PANE: Vec2 = vec2(440.0, 490.0);

#[test]
fn a_small_pane_shows_words_numbers_symbols_and_the_line_at_work() {
    let fixture = fixture(MIDDLE);
    let mut state = explanation::State::default();
    let mut harness = harness(SMALL_PANE, Theme::Projector, |ui| fixture.explain(ui, Theme::Projector, &mut state));
    harness.run();
    let equation = fixture.step.readouts.iter().find_map(|readout| match readout {
        Readout::Equation(lines) => lines.last().map(|line| line.plain()),
        _ => None,
    });
    let (sentence, equation) = (fixture.step.sentence.plain(), equation.expect("full search has an equation"));
    let info = fixture.walk.info();
    let line = info.pseudocode[info.line(fixture.step.line).expect("it is declared")].text.trim();
    let at_work = format!("current line: {line}");
    let pinned = harness.query_all_by_label(&at_work).map(|node| node.rect()).next_back().expect("the line at work");
    assert!(pinned.max.y <= SMALL_PANE.y + 1.0, "{pinned}");
    for label in [&sentence, "Best so far: ", &equation] {
        let rect = harness.query_by_label_contains(label).expect(label).rect();
        assert!(rect.max.y <= pinned.min.y + 1.0, "{label} is hidden: {rect} above {pinned}");
    }
}

#[test]
fn the_explanation_stays_where_it_was_scrolled() {
    let (first, second) = (fixture(MIDDLE), fixture(Cursor { unit: 1, event: 1 }));
    assert_ne!(first.step.line, second.step.line);
    let which = Cell::new(&first);
    let mut state = explanation::State::default();
    let mut harness = harness(SMALL_PANE, Theme::Projector, |ui| {
        let shown = which.get();
        shown.explain(ui, Theme::Projector, &mut state);
    });
    // Once each kind of step was seen, there is room for both.
    for shown in [&second, &first] {
        which.set(shown);
        harness.run();
    }
    let line = |harness: &Harness<'_>| harness.get_by_label_contains("for each candidate").rect().min.y;
    let before = line(&harness);
    harness.hover_at(Pos2::new(200.0, 300.0));
    harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, -90.0),
        source: MouseWheelSource::Unknown,
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    harness.run();
    let scrolled = line(&harness);
    assert!((before - scrolled - 90.0).abs() < 2.0, "{before} {scrolled}");
    for shown in [&second, &first, &second] {
        which.set(shown);
        harness.run();
        assert_eq!(line(&harness), scrolled);
    }
}

#[test]
fn a_click_on_the_stage_tells_the_pixel_and_pointing_reads_it() {
    let fixture = fixture(MIDDLE);
    let mut state = stage::State::default();
    let (clicked, hovered) = (Cell::new(None), Cell::new(None));
    let mut harness = harness(vec2(900.0, 500.0), Theme::Dark, |ui| {
        let response = show_stage(ui, fixture.stage(), &mut state);
        clicked.set(response.clicked.or(clicked.get()));
        hovered.set(response.hovered);
    });
    let left = harness.get_by_label("Stage: Frame t = 12");
    let right = harness.get_by_label("Stage: Frame t+1 = 13");
    assert!(left.rect().max.x < right.rect().min.x);
    let center = right.rect().center();
    right.click();
    harness.run();
    // The middle of 64×48 pixels lies between pixels 31 and 32, 23 and 24.
    let Focus { on, at: [x, y], .. } = clicked.get().expect("a click on the picture is told");
    assert_eq!(on, Picture::NEXT);
    assert!((31.0..=32.0).contains(&x) && (23.0..=24.0).contains(&y), "{x} {y}");
    harness.hover_at(center + vec2(1.0, 1.0));
    harness.run();
    assert_eq!(hovered.get(), Some(Focus::on(Picture::NEXT, [32.0, 24.0])));
    let [a, b] = [0, 1].map(|i: usize| fixture.pictures.pair[i].luma()[(32, 24)]);
    let told = format!("x 32, y 24, t {a}, t+1 {b}");
    assert!(harness.query_by_label_contains(&told).is_some(), "{told}");
    harness.remove_cursor();
    harness.run();
    assert_eq!(hovered.get(), None);
}

#[test]
fn the_wheel_zooms_about_the_pointer_and_a_double_click_keeps_the_place() {
    let fixture = fixture(MIDDLE);
    let mut state = stage::State::default();
    let (zoom, hovered) = (Cell::new(Zoom::Fit), Cell::new(None));
    let mut harness = harness(vec2(900.0, 500.0), Theme::Dark, |ui| {
        hovered.set(show_stage(ui, fixture.stage(), &mut state).hovered);
        zoom.set(state.zoom);
    });
    let at = harness.get_by_label("Stage: Frame t = 12").rect().center() + vec2(57.0, -31.0);
    harness.hover_at(at);
    harness.run();
    let before = hovered.get().expect("the pointer is on the picture");
    for _ in 0..3 {
        harness.event(Event::MouseWheel {
            source: MouseWheelSource::Unknown,
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, 4.0),
            phase: TouchPhase::Move,
            modifiers: Modifiers::NONE,
        });
        // The zoom eases to its end.
        harness.run_steps(60);
    }
    assert!(matches!(zoom.get(), Zoom::At { .. }), "{:?}", zoom.get());
    assert_eq!(hovered.get(), Some(before), "the pixel under the pointer stays there");
    let close = zoom.get();
    for _ in 0..2 {
        harness.drag_at(at);
        harness.drop_at(at);
    }
    harness.run();
    assert_eq!(zoom.get(), close, "whoever clicks twice in a hurry still looks there");
}

#[test]
fn every_view_of_the_pair_is_in_the_list() {
    let fixture = fixture(MIDDLE);
    let mut state = stage::State::default();
    let look = Cell::new(Look::of_window());
    let view = || look.get().view.unwrap_or_default();
    let mut harness = harness(vec2(1000.0, 500.0), Theme::Dark, |ui| {
        let response = show_stage(ui, stage::Input { look: look.get(), ..fixture.stage() }, &mut state);
        look.set(response.look);
    });
    for wanted in View::ALL {
        let before = view();
        harness.get_by_role_and_label(Node::ComboBox, "Pictures").click();
        harness.run_steps(3);
        harness.get_by_role_and_label(Node::Button, wanted.name()).click();
        // A blinking stage is never at rest.
        harness.run_steps(3);
        // There is no prediction in the middle of a run.
        assert_eq!(view(), if wanted.is_of_the_end() { before } else { wanted });
        let blend = harness.query_by_role_and_label(Node::Slider, "Share of frame t+1 in the blend");
        assert_eq!(blend.is_some(), wanted == View::Blend);
    }
}

#[test]
fn an_idle_stage_asks_for_no_repaint() {
    let fixture = fixture(MIDDLE);
    let mut state = stage::State::default();
    let mut harness = harness(vec2(900.0, 500.0), Theme::Dark, |ui| {
        show_stage(ui, stage::Input { animate: true, ..fixture.stage() }, &mut state);
    });
    assert!(harness.try_run().is_ok(), "it comes to rest");
    harness.step();
    let delays = harness.output().viewport_output.values().map(|viewport| viewport.repaint_delay);
    assert!(delays.min().is_some_and(|delay| delay.as_secs() > 3600));
}

#[test]
fn a_click_on_the_cost_map_tells_the_event_that_tested_it() {
    let fixture = fixture(MIDDLE);
    let surface = fixture.surface();
    let mut state = heat_map::State::default();
    let told = Cell::new(heat_map::Response::default());
    let mut harness = harness(vec2(460.0, 360.0), Theme::Dark, |ui| {
        let input = heat_map::Input { surface, subject: fixture.subject(Theme::Dark) };
        let response = heat_map::show(ui, input, &mut state);
        if response.clicked.is_some() {
            told.set(response);
        }
    });
    let map = harness.get_by_role_and_label(Node::Image, &heat_map::summary(surface)).rect();
    let cell = map.width() / surface.values.width() as f32;
    let place = map.min + vec2(2.5 * cell, 1.5 * cell);
    harness.hover_at(place);
    harness.drag_at(place);
    harness.step();
    harness.drop_at(place);
    harness.run();
    assert_eq!(told.get().clicked, surface.events[(2, 1)].map(heat_map::Clicked::Tested));
    assert!(told.get().clicked.is_some());
}

/// What is painted of `primitives` in a window.
fn painted(ui: &Ui, primitives: Vec<Layer>) -> Vec<Shape> {
    let primitives: Vec<_> = primitives.into_iter().flat_map(|layer| layer.primitives).collect();
    shapes(ui.painter(), &primitives)
}

#[test]
fn the_explanation_is_painted_wherever_its_pane_lies() {
    let fixture = fixture(MIDDLE);
    let mut state = explanation::State::default();
    let pane = Rect::from_min_size(Pos2::new(900.0, 60.0), vec2(300.0, 600.0));
    let mut harness = harness(vec2(1280.0, 720.0), Theme::Dark, |ui| {
        ui.scope_builder(UiBuilder::new().max_rect(pane), |ui| {
            ui.set_clip_rect(pane);
            fixture.explain(ui, Theme::Dark, &mut state);
        });
    });
    harness.run();
    let words = harness.output().shapes.iter().filter_map(|painted| match &painted.shape {
        Shape::Text(text) if pane.contains(text.pos) => Some(text.galley.text().to_owned()),
        _ => None,
    });
    let words: String = words.collect();
    for wanted in ["Tested", "Best so far", "for each block B of frame t"] {
        assert!(words.contains(wanted), "{wanted} is missing in {words}");
    }
}

#[test]
fn the_window_shows_the_primitives_that_are_exported() {
    let fixture = fixture(MIDDLE);
    let surface = fixture.surface();
    let series =
        fixture.step.readouts.iter().find_map(|r| if let Readout::Series(series) = r { Some(series) } else { None });
    let series = series.expect("full search has a plot");
    for theme in Theme::ALL {
        let subject = fixture.subject(theme);
        let (mut map, mut plot, mut solid) =
            (heat_map::State::default(), series::State::default(), surface3d::State::default());
        for chart in 0..3 {
            let wanted = Cell::new(Vec::new());
            let mut harness = harness(vec2(460.0, 360.0), theme, |ui| {
                let area = rect_of(Rect::from_min_size(ui.cursor().min, ui.available_size()));
                let style = subject.style(ui.painter());
                let whose = subject.whose;
                let layers = match chart {
                    0 => {
                        heat_map::show(ui, heat_map::Input { surface, subject }, &mut map);
                        charts::heat_map::draw(charts::heat_map::HeatMap { surface, whose }, area, style).into_layers()
                    }
                    1 => {
                        let logarithmic = false;
                        series::show(ui, series::Input { series, subject, logarithmic }, &mut plot);
                        let data = charts::series::Plotted { series, whose, logarithmic, window: None };
                        charts::series::draw(data, area, style).into_layers()
                    }
                    _ => {
                        surface3d::show(ui, surface3d::Input { surface, subject, gpu: None }, &mut solid);
                        let data = charts::relief::Relief { surface, whose, orbit: solid.orbit };
                        charts::relief::draw(data, area, style).into_layers()
                    }
                };
                wanted.set(painted(ui, layers));
            });
            harness.run();
            let shown = &harness.output().shapes;
            let wanted = wanted.take();
            assert!(wanted.len() > 20);
            for shape in wanted {
                assert!(
                    shown.iter().any(|painted| painted.shape == shape),
                    "chart {chart} in {theme:?} lacks {shape:?}"
                );
            }
        }
    }
}

#[test]
fn tiles_light_the_same_pixel_and_tell_its_numbers() {
    let fixture = fixture(MIDDLE);
    let shown = fixture.step.readouts.iter().find_map(|readout| match readout {
        Readout::Tiles(tiles) => Some(tiles.as_slice()),
        _ => None,
    });
    let shown = shown.expect("full search has tiles");
    let mut state = tiles::State::default();
    let hovered = Cell::new(None);
    let mut harness = harness(vec2(1400.0, 420.0), Theme::Projector, |ui| {
        let input = tiles::Input { tiles: shown, is_centered: false, subject: fixture.subject(Theme::Projector) };
        hovered.set(tiles::show(ui, input, &mut state).hovered);
    });
    let tile = harness.get_by_role_and_label(Node::Image, "candidate").rect();
    let cell = tile.width() / shown[1].values.width() as f32;
    harness.hover_at(tile.min + vec2(4.5 * cell, 9.5 * cell));
    harness.run();
    assert_eq!(hovered.get(), Some([4, 9]));
    let told = format!("block {}, candidate {}", shown[0].values[(4, 9)], shown[1].values[(4, 9)]);
    assert!(harness.query_by_label_contains(&told).is_some(), "{told}");
}

#[test]
fn windows_are_seen_whole_and_read_at_a_click() {
    let tile = |label| Tile {
        label,
        role: None,
        values: Grid::from_fn(15, 15, |x, y| (x * y) as f32),
        range: [0.0, 255.0],
        framed: Vec::new(),
    };
    let (shown, size) = ([tile("Window"), tile("Its place"), tile("δI")], vec2(440.0, 240.0));
    let mut state = tiles::State::default();
    let mut harness = harness(size, Theme::Dark, |ui| {
        tiles::show(ui, tiles::Input { tiles: &shown, is_centered: true, subject: fresh() }, &mut state);
    });
    let rect = |harness: &Harness<'_>, label| harness.get_by_role_and_label(Node::Image, label).rect();
    for label in ["Window", "Its place", "δI"] {
        let rect = rect(&harness, label);
        assert!(rect.min.x >= 0.0 && rect.max.x <= size.x && rect.max.y <= size.y, "{label} sticks out: {rect}");
    }
    let (whole, place) = (rect(&harness, "Window").width(), rect(&harness, "Its place"));
    // The pixel that is clicked comes into sight.
    let cell = place.width() / 15.0;
    let pixel = |place: Rect, cell: f32| place.min + vec2(12.5, 2.5) * cell;
    harness.hover_at(pixel(place, cell));
    harness.run();
    harness.drag_at(pixel(place, cell));
    harness.run();
    harness.drop_at(pixel(place, cell));
    harness.run();
    let place = rect(&harness, "Its place");
    assert!(place.width() > 2.0 * whole);
    let seen = pixel(place, place.width() / 15.0);
    assert!((0.0..size.x).contains(&seen.x) && (0.0..size.y).contains(&seen.y), "{seen} is out of sight");
}

#[test]
fn the_surface_turns_without_a_graphics_card() {
    let fixture = fixture(MIDDLE);
    let mut state = surface3d::State::default();
    let orbit = Cell::new(surface3d::Orbit::default());
    let mut harness = harness(vec2(500.0, 400.0), Theme::Dark, |ui| {
        let input = surface3d::Input { surface: fixture.surface(), subject: fixture.subject(Theme::Dark), gpu: None };
        surface3d::show(ui, input, &mut state);
        orbit.set(state.orbit);
    });
    let middle = harness.get_by_label_contains("three dimensions").rect().center();
    harness.hover_at(middle);
    harness.drag_at(middle);
    harness.step();
    harness.hover_at(middle + vec2(60.0, 20.0));
    harness.step();
    harness.drop_at(middle + vec2(60.0, 20.0));
    harness.run();
    let (start, turned) = (surface3d::Orbit::default(), orbit.get());
    assert!(turned.yaw_rad != start.yaw_rad && turned.pitch_rad > start.pitch_rad, "{turned:?}");
}

#[test]
fn every_view_stands_any_size_theme_and_step() {
    let cursors = [Cursor::default(), Cursor { unit: 0, event: 1 }, MIDDLE, Cursor { unit: 11, event: usize::MAX }];
    for theme in Theme::ALL {
        for cursor in cursors {
            let fixture = fixture(cursor);
            for size in [vec2(60.0, 40.0), vec2(260.0, 900.0), vec2(1600.0, 300.0)] {
                let mut all = All::default();
                let mut harness = harness(size, theme, |ui| all.show(ui, &fixture, theme));
                harness.hover_at(Pos2::ZERO + size * 0.4);
                harness.run_steps(2);
                harness.key_press(Key::A);
                harness.run_steps(1);
                for (name, count) in fixture.names() {
                    let found = harness.query_all_by_label_contains(&name).count();
                    assert_eq!(found, count, "{name} in {theme:?} at {cursor:?} on {size:?}");
                }
                for painted in &harness.output().shapes {
                    let bounds = painted.shape.visual_bounding_rect();
                    assert!(!bounds.any_nan(), "{theme:?} at {cursor:?} on {size:?}: {:?}", painted.shape);
                }
            }
        }
    }
}

#[test]
fn marks_lie_in_their_picture_whatever_its_size() {
    let fixture = fixture(MIDDLE);
    for theme in Theme::ALL {
        for size in [vec2(500.0, 700.0), vec2(900.0, 500.0), vec2(1900.0, 1000.0)] {
            let mut state = stage::State::default();
            let harness = harness(size, theme, |ui| {
                show_stage(
                    ui,
                    stage::Input { look: Look { theme, ..Look::of_window() }, ..fixture.stage() },
                    &mut state,
                );
            });
            for (role, pane) in [(Role::Reference, "Stage: Frame t = 12"), (Role::Candidate, "Stage: Frame t+1 = 13")] {
                let pane = harness.get_by_label(pane).rect();
                let shapes = harness.output().shapes.iter().filter(|painted| painted.clip_rect.intersects(pane));
                let frames: Vec<Rect> = shapes.filter_map(|painted| frame_in(&painted.shape, role, theme)).collect();
                let [frame] = frames.as_slice() else { panic!("{role:?} in {theme:?} on {size:?}: {frames:?}") };
                // A block of 16 px of a picture of 64×48 that fits, and its line outside.
                let zoom = (pane.size() / vec2(64.0, 48.0)).min_elem();
                let side = frame.height() - theme.ink(role).width;
                assert!(
                    pane.expand(2.0).contains_rect(*frame) && (14.0..16.5).contains(&(side / zoom)),
                    "{frame:?} in {pane:?}"
                );
            }
        }
    }
}

/// Where a shape's corners lie, if it is a frame in the colour of `role`.
fn frame_in(shape: &Shape, role: Role, theme: Theme) -> Option<Rect> {
    let Shape::Path(path) = shape else { return None };
    let [r, g, b, _] = theme.ink(role).color.0;
    let inked = path.stroke.color == ColorMode::Solid(Color32::from_rgb(r, g, b));
    // The legend's swatches are small.
    let corners = Rect::from_points(&path.points);
    (inked && path.points.len() == 4 && corners.height() > 20.0).then_some(corners)
}

#[derive(Default)]
struct All {
    stage: stage::State,
    why: explanation::State,
    map: heat_map::State,
    plot: series::State,
    tiles: tiles::State,
    solid: surface3d::State,
}

impl All {
    fn show(&mut self, ui: &mut Ui, fixture: &Fixture, theme: Theme) {
        let cell = ui.available_size() / vec2(3.0, 2.0);
        let subject = Subject { colors: ColorMap::Turbo, ..fixture.subject(theme) };
        eframe::egui::Grid::new("all").show(ui, |ui| {
            let part = |ui: &mut Ui, add: &mut dyn FnMut(&mut Ui)| {
                ui.allocate_ui(cell, |ui| {
                    ui.set_max_size(cell);
                    add(ui);
                });
            };
            part(ui, &mut |ui| {
                show_stage(
                    ui,
                    stage::Input { look: Look { theme, ..Look::of_window() }, ..fixture.stage() },
                    &mut self.stage,
                );
            });
            part(ui, &mut |ui| {
                fixture.explain(ui, theme, &mut self.why);
            });
            for readout in &fixture.step.readouts {
                part(ui, &mut |ui| match readout {
                    Readout::Surface(surface) => {
                        heat_map::show(ui, heat_map::Input { surface, subject }, &mut self.map);
                        surface3d::show(ui, surface3d::Input { surface, subject, gpu: None }, &mut self.solid);
                    }
                    Readout::Series(lines) => {
                        series::show(ui, series::Input { series: lines, subject, logarithmic: false }, &mut self.plot);
                    }
                    Readout::Tiles(shown) => {
                        tiles::show(ui, tiles::Input { tiles: shown, is_centered: false, subject }, &mut self.tiles);
                    }
                    _ => {}
                });
            }
        });
    }
}
