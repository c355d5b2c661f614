//! The window driven headlessly: no display, no graphics card, but real keys, clicks and drags.

#[path = "window/camera.rs"]
mod camera;
#[path = "window/chooser.rs"]
mod chooser;
#[path = "window/compare.rs"]
mod compare;
#[path = "window/every.rs"]
mod every;
#[path = "window/files.rs"]
mod files;
#[path = "window/find.rs"]
mod find;
#[path = "window/keyboard.rs"]
mod keyboard;
#[path = "window/keys.rs"]
mod keys;
#[path = "window/landscape.rs"]
mod landscape;
#[path = "window/language.rs"]
mod language;
#[path = "window/layout.rs"]
mod layout;
#[path = "window/lessons.rs"]
mod lessons;
#[path = "window/levels.rs"]
mod levels;
#[path = "window/links.rs"]
mod links;
#[path = "window/lockstep.rs"]
mod lockstep;
#[path = "window/look.rs"]
mod look;
#[path = "window/motion.rs"]
mod motion;
#[path = "window/objects.rs"]
mod objects;
#[path = "window/paper.rs"]
mod paper;
#[path = "window/parameters.rs"]
mod parameters;
#[path = "window/pixels.rs"]
mod pixels;
#[path = "window/placing.rs"]
mod placing;
#[path = "window/predict.rs"]
mod predict;
#[path = "window/present.rs"]
mod present;
#[path = "window/stages.rs"]
mod stages;
#[path = "window/start.rs"]
mod start;
#[path = "window/summary.rs"]
mod summary;
#[path = "window/timeline.rs"]
mod timeline;

use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, Rect, TouchPhase, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use motionscope::experiment::source::Source;
use motionscope::media::Open;
use motionscope::paint::{ColorMap, Lengthen, LevelShown, Theme, View};
use motionscope::results::EXPORTS;
use motionscope::session::Session;
use motionscope::ui::app::{App, Region};
use motionscope::ui::charts::heat_map;
use motionscope::ui::commands::{Command, Granularities, Menu, Order, OutputKind, Owner};
use motionscope::ui::model::snapshot::{Near, Place, Snapshot};
use motionscope::ui::{self, Start};
use motionscope::view::look::Look;
use motionscope::view::motion::Reverse;
use motionscope::view::panes::Selection;
use motionscope::view::rendering::Format;
use motionscope::view::steps::Range;
use motionscope_core::params::Value;
use motionscope_core::products::metrics;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Focus, Readout};

/// The window, and the waiting that a person does not notice.
struct Window {
    harness: Harness<'static, App>,
    /// Its size in points at an interface scale of 1.
    size: Vec2,
}

impl Window {
    /// A window of this size that shows its first sample.
    fn new(size: Vec2) -> Self {
        Self::with(size, Start::default())
    }

    fn with(size: Vec2, start: Start) -> Self {
        let is_sample = start.open.is_none();
        let mut window = Self::remembering(size, start, None);
        if is_sample {
            window.look_in();
        }
        window
    }

    /// Goes from the start of the bundled sample into the middle of a search, where there is something to see.
    fn look_in(&mut self) {
        let (width, height) = self.shown().pictures.pair[0].size();
        let near = Near::Pixel(Focus::current([width as f32 * 0.19, height as f32 * 0.57]));
        let cursor = Cursor { unit: 0, event: 640 };
        self.harness.state_mut().walk_from(Place { cursor, near, ..Place::default() });
        self.settle();
    }

    /// A window that has passed the start page.
    fn remembering(size: Vec2, start: Start, memory: Option<Memory>) -> Self {
        let mut window = Self::begun(size, start, memory);
        if window.app().is_at_start() {
            window.harness.state_mut().leave_start();
            window.settle();
        }
        window
    }

    fn begun(size: Vec2, start: Start, memory: Option<Memory>) -> Self {
        let build = move |cc: &mut eframe::CreationContext<'static>| {
            let storage = memory.as_ref().map(|memory| memory as &dyn eframe::Storage);
            let mut app = App::new(&cc.egui_ctx, storage).expect("a thread");
            ui::begin(&mut app, start);
            app
        };
        let builder = Harness::builder().with_size(size).with_step_dt(1.0 / 60.0).with_max_steps(80);
        let mut window = Self { harness: builder.build_eframe(build), size };
        window.settle();
        window
    }

    fn usual() -> Self {
        Self::new(vec2(1440.0, 900.0))
    }

    /// Draws until nothing changes any more.
    fn settle(&mut self) {
        for _ in 0..3 {
            self.harness.state_mut().wait();
            self.step();
            self.step();
        }
        self.rest();
    }

    /// Draws until the window comes to rest: a spinner may turn until a thread is done.
    fn rest(&mut self) {
        let begun = Instant::now();
        while let Err(restless) = self.harness.try_run() {
            assert!(begun.elapsed() < Duration::from_secs(60), "{restless}");
        }
    }

    /// Draws once. A window has more points where its interface is smaller, as a system's window does.
    fn step(&mut self) {
        let size = self.size / self.harness.ctx.zoom_factor();
        self.harness.set_size(size);
        self.harness.run_steps(1);
    }

    /// Draws until a comparison is there: a spinner turns all the while, so the window does not come to rest at once.
    fn compared(&mut self) {
        self.harness.run_steps(2);
        let begun = Instant::now();
        while !self.app().is_settled() {
            self.harness.run_steps(1);
            assert!(begun.elapsed() < Duration::from_secs(60), "the comparison does not end");
        }
        self.rest();
    }

    fn has(&self, region: Region) -> bool {
        self.app().regions().iter().any(|(other, _)| *other == region)
    }

    fn region(&self, region: Region) -> Rect {
        self.app().regions().iter().find(|(other, _)| *other == region).expect("it is there").1
    }

    fn app(&self) -> &App {
        self.harness.state()
    }

    fn shown(&self) -> &Snapshot {
        self.app().view().shown.as_deref().expect("a run is shown")
    }

    fn cursor(&self) -> Cursor {
        self.shown().cursor
    }

    /// Everything that the cursor tells and shows. Costs that are not known are NaN, so it is compared as text.
    fn sentence(&self) -> String {
        let shown = self.shown();
        format!("{} {:?} {:?}", shown.cursor, shown.step, shown.scene)
    }

    fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.settle();
    }

    fn key(&mut self, key: Key) {
        self.press(Modifiers::NONE, key);
    }

    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.settle();
    }

    fn click_role(&mut self, role: Role, label: &str) {
        self.harness.get_by_role_and_label(role, label).click();
        self.settle();
    }

    /// Shows a chart, by its tab or in the list of those that there is no room for beside each other.
    fn chart(&mut self, title: &str) {
        if self.harness.query_by_role_and_label(Role::Tab, title).is_none() {
            self.click_role(Role::ComboBox, "Chart");
            return self.click(title);
        }
        self.click_role(Role::Tab, title);
    }

    /// The charts that can be chosen.
    fn charts(&mut self) -> Vec<String> {
        let named = |window: &Self, role| {
            let all = window.harness.query_all_by_role(role).filter_map(|node| node.accesskit_node().label());
            all.collect::<Vec<_>>()
        };
        if self.harness.query_by_role_and_label(Role::ComboBox, "Chart").is_none() {
            return named(self, Role::Tab);
        }
        let before = named(self, Role::Button);
        self.click_role(Role::ComboBox, "Chart");
        let all = named(self, Role::Button).into_iter().filter(|name| !before.contains(name)).collect();
        self.key(Key::Escape);
        all
    }

    /// Unfolds the estimator's advanced parameters, or folds them.
    fn unfold(&mut self) {
        self.harness.query_all_by_label_contains("Advanced").next().expect("a fold").click();
        self.settle();
    }

    fn command(&mut self, command: Command) {
        self.harness.state_mut().command(command);
        self.settle();
    }

    /// Everything that can be clicked can be reached: it lies in the window, unless it is scrolled out of sight.
    fn lies_inside(&self, size: Vec2, what: &str) {
        let size = size / self.harness.ctx.zoom_factor();
        let window = Rect::from_min_size(Pos2::ZERO, size).expand(1.0);
        let mut count = 0;
        for node in self.harness.query_all_by_role(Role::Button).filter(|node| !node.accesskit_node().is_hidden()) {
            let rect = node.rect();
            let beside = rect.max.x < 0.0 || rect.min.x > size.x;
            assert!(!beside && rect.width() > 4.0, "{what}: {:?} at {rect}", node.accesskit_node().label());
            count += usize::from(window.contains_rect(rect));
        }
        assert!(count >= 4, "{what}: {count} buttons in sight");
    }

    fn value(&self, name: &str) -> Value {
        self.app().document().estimator().get(name).expect("the parameter exists")
    }

    fn click_at(&mut self, place: Pos2) {
        self.harness.hover_at(place);
        self.harness.drag_at(place);
        self.harness.step();
        self.harness.drop_at(place);
        self.settle();
    }

    fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.drag_at(from);
        self.harness.run_steps(1);
        for i in 1..=5 {
            self.harness.hover_at(from + (to - from) * (i as f32 / 5.0));
            self.harness.run_steps(1);
        }
        self.harness.drop_at(to);
        self.settle();
    }
}

#[test]
fn the_first_screen_shows_a_search_at_work() {
    let window = Window::usual();
    let shown = window.shown();
    assert!(shown.cursor.event > 1 && shown.cursor.event < shown.events, "{}", shown.cursor);
    assert!(shown.step.readouts.len() > 3);
    assert!(window.harness.query_by_label_contains("% done").is_some(), "the status line tells how far it is");
}

#[test]
fn a_step_there_and_back_shows_the_same() {
    let mut window = Window::usual();
    let before = window.sentence();
    for (there, back) in [
        ((Modifiers::NONE, Key::ArrowRight), (Modifiers::NONE, Key::ArrowLeft)),
        ((Modifiers::NONE, Key::ArrowLeft), (Modifiers::NONE, Key::ArrowRight)),
    ] {
        window.press(there.0, there.1);
        assert_ne!(window.sentence(), before);
        window.press(back.0, back.1);
        assert!(window.sentence() == before, "{there:?} and back");
    }
    window.press(Modifiers::SHIFT, Key::ArrowRight);
    let end = window.cursor();
    assert_eq!(end.event, window.shown().events, "over goes to the end of the block");
    window.key(Key::PageDown);
    assert_eq!(window.cursor().unit, end.unit + 1);
    window.key(Key::PageUp);
    assert_eq!(window.cursor(), end);
    window.key(Key::End);
    assert!(window.shown().at_end);
    window.key(Key::Home);
    assert_eq!(window.cursor(), Cursor::default());
    window.key(Key::U);
    assert!(window.shown().at_end, "out of the only frame is the end of the run");
    window.press(Modifiers::SHIFT, Key::U);
    assert_eq!(window.cursor(), Cursor::default());
}

#[test]
fn the_ladder_has_buttons_with_the_estimators_names() {
    let mut window = Window::usual();
    let before = window.cursor();
    let event = window.shown().info.granularities[2];
    window.click(&format!("Next {event}"));
    assert_eq!(window.cursor(), Cursor { event: before.event + 1, ..before });
    window.click(&format!("Previous {event}"));
    assert_eq!(window.cursor(), before);
    window.click("Finish this block");
    assert_eq!((window.cursor().unit, window.cursor().event), (before.unit, window.shown().events));
}

#[test]
fn a_click_on_the_stage_goes_to_the_block() {
    let mut window = Window::usual();
    window.command(Command::FocusNever);
    window.key(Key::Num2);
    let stage = window.harness.get_by_label_contains("Stage: ").rect();
    let (width, height) = window.shown().pictures.pair[0].size();
    // The whole picture lies in the middle of the stage; blocks are 16 px wide, 20 in a row.
    let scale = (stage.width() / width as f32).min(stage.height() / height as f32);
    for [x, y] in [[200.0, 60.0], [7.0, 233.0], [313.0, 5.0]] {
        let at = stage.center() + scale * (vec2(x, y) + vec2(0.5, 0.5) - vec2(width as f32, height as f32) / 2.0);
        window.click_at(at);
        let unit = (y / 16.0) as usize * 20 + (x / 16.0) as usize;
        assert_eq!((window.cursor().unit, window.cursor().event), (unit, window.shown().events), "at {x}, {y}");
    }
}

#[test]
fn another_pair_of_frames_is_run_on() {
    let mut window = Window::usual();
    let (unit, before) = (window.cursor().unit, window.sentence());
    window.key(Key::Period);
    assert_eq!((window.shown().subject.experiment.frame, window.cursor().unit), (1, unit));
    let sample = Source::synth("pillar").and_then(|source| source.open(&Open::default())).expect("the sample").clip;
    for (t, frame) in [1, 2].into_iter().zip(&window.shown().pictures.pair) {
        assert!(frame.luma() == sample.frame(t).expect("a frame").luma(), "frame {t} is run on");
    }
    assert!(window.sentence() != before, "another pair has other costs");
    window.key(Key::Comma);
    assert_eq!(window.shown().subject.experiment.frame, 0);
    assert!(window.sentence() == before, "and back is as before");
}

#[test]
fn a_lecture_folds_nothing_away_unseen() {
    let mut window = Window::usual();
    let before = window.app().folded();
    window.key(Key::L);
    for key in [Key::Num1, Key::Num2, Key::Num3] {
        window.press(Modifiers::COMMAND, key);
    }
    window.key(Key::L);
    assert_eq!(window.app().folded(), before);
}

/// What the system remembers of the window, in memory.
#[derive(Default)]
struct Memory(std::collections::BTreeMap<String, String>);

impl eframe::Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn the_next_start_looks_like_the_last() {
    let size = vec2(1280.0, 720.0);
    let mut window = Window::new(size);
    for command in [Command::LightTheme, Command::TurboColors, Command::FourfoldArrows, Command::Difference] {
        window.command(command);
    }
    if window.harness.query_by_label("Legend").is_none() {
        window.click("More of the stage");
    }
    window.click("Legend");
    window.key(Key::Escape);
    // The edge between stage and explanation is dragged.
    let place = |window: &Window| window.region(Region::Explanation).min.x;
    let edge = window.region(Region::Explanation).left_center();
    window.drag(edge, edge - vec2(120.0, 0.0));
    let moved = place(&window);
    assert!((moved - edge.x + 120.0).abs() < 20.0, "{moved} {}", edge.x);
    let mut memory = Memory::default();
    eframe::App::save(window.harness.state_mut(), &mut memory);

    let again = Window::remembering(size, Start::default(), Some(memory));
    assert!((place(&again) - moved).abs() < 2.0, "{} {moved}", place(&again));
    assert_eq!(again.app().settings().look.theme, Theme::Light);
    assert_eq!(again.app().settings().look.colors, ColorMap::Turbo);
    assert_eq!(again.app().settings().look.arrow_scale, Lengthen::Times(4.0));
    assert!(again.harness.query_by_label_contains("Legend: ").is_none());
    let title = |window: &Window| window.harness.get_by_label_contains("Stage: ").accesskit_node().label();
    assert!(title(&window).is_some_and(|title| title.contains('|')), "the difference is shown");
    assert_eq!(title(&again), title(&window));
}

#[test]
fn colours_and_arrows_are_chosen_in_the_view_menu() {
    let mut window = Window::usual();
    for (submenu, text) in [("Colours", "Turbo colours"), ("Arrow length", "Arrows at 2×")] {
        window.click("View");
        window.harness.get_by_label_contains(submenu).click();
        window.settle();
        window.click_role(Role::MenuItem, text);
    }
    let settings = window.app().settings();
    assert_eq!((settings.look.colors, settings.look.arrow_scale), (ColorMap::Turbo, Lengthen::Times(2.0)));
}

#[test]
fn every_menu_can_be_reached_on_a_projector() {
    let size = vec2(1280.0, 720.0);
    let mut window = Window::new(size);
    window.command(Command::ProjectorTheme);
    for menu in Menu::ALL {
        window.harness.get_by_label_contains("Menu").click();
        window.settle();
        window.harness.get_by_role_and_label(Role::Button, menu.name()).click();
        window.settle();
        let items = |window: &Window| -> Vec<_> {
            window.harness.query_all_by_role(Role::MenuItem).map(|node| node.rect()).collect()
        };
        let sight = Rect::from_min_size(Pos2::ZERO, size);
        let first = items(&window)[0];
        assert!(sight.contains_rect(first), "{}: {first}", menu.name());
        window.harness.hover_at(first.center());
        window.harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: vec2(0.0, -1500.0),
            source: MouseWheelSource::Unknown,
            phase: TouchPhase::Move,
            modifiers: Modifiers::NONE,
        });
        window.settle();
        let last = *items(&window).last().expect("an item");
        assert!(sight.contains_rect(last), "{}: {last}", menu.name());
        window.key(Key::Escape);
        window.key(Key::Escape);
    }
}

#[test]
fn what_cannot_be_done_is_announced_so() {
    let mut window = Window::usual();
    window.key(Key::Home);
    window.click("Walk");
    let state = |label: &str| {
        let item = window.harness.get_by_role_and_label(Role::MenuItem, label);
        item.accesskit_node().is_disabled()
    };
    assert!(state("Result of the previous block") && !state("Result of the next block"));
    assert!(window.harness.query_all_by_label("Finish the run").next().is_none(), "the end is listed once");
}

#[test]
fn keys_are_letters_while_one_types() {
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::O);
    let before = window.sentence();
    window.harness.get_by_label("Path of the clip").type_text("l");
    window.settle();
    window.key(Key::L);
    window.key(Key::ArrowRight);
    assert!(!window.app().settings().lecture && window.sentence() == before);
    window.key(Key::Escape);
    window.key(Key::L);
    assert!(window.app().settings().lecture);
}

#[test]
fn the_palette_runs_a_command() {
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("lectur");
    window.settle();
    window.key(Key::Enter);
    assert!(window.app().settings().lecture);
    assert!(window.harness.query_by_label("What to find").is_none(), "the palette is closed");
    window.key(Key::Escape);
    assert!(!window.app().settings().lecture);

    // A command is found by its menu as well.
    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("export");
    window.settle();
    assert!(window.harness.get_all_by_role(Role::ListBoxOption).count() > 3);
    window.key(Key::Escape);

    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("barber");
    window.settle();
    window.key(Key::Enter);
    let name = window.app().document().clip().map(|clip| clip.info().name.clone()).unwrap_or_default();
    assert!(name.contains("Barber"), "{name}");
}

#[test]
fn the_shortcut_sheet_lists_every_command_with_a_key() {
    let mut window = Window::new(vec2(1600.0, 2400.0));
    window.key(Key::F1);
    let granularities = Granularities::new(window.shown().info.granularities);
    let listed = |command: &&Command| command.is_listed(&granularities) && !command.entry().keys.is_empty();
    for command in Command::ALL.iter().filter(listed) {
        let text = command.text(&granularities);
        assert!(window.harness.query_all_by_label(&text).next().is_some(), "{text} is not on the sheet");
    }
}

#[test]
fn the_samples_are_shown_and_opened() {
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::N);
    let first = &motionscope_core::synth::SCENES[0];
    window.click_role(Role::Button, first.title);
    assert_eq!(window.app().document().sample().map(|sample| sample.id), Some(first.id));
    assert_eq!(window.cursor().event, window.shown().events, "it opens with a whole block");
}

#[test]
fn every_theme_draws_at_every_size() {
    for size in [vec2(720.0, 480.0), vec2(1280.0, 720.0), vec2(1920.0, 1080.0)] {
        let mut window = Window::new(size);
        for _ in 0..Theme::ALL.len() {
            window.key(Key::T);
            let theme = window.app().settings().look.theme;
            window.lies_inside(size, &format!("{theme:?}"));
            for command in [Command::Samples, Command::Shortcuts, Command::Open, Command::ExportSteps, Command::About] {
                window.command(command);
                window.lies_inside(size, &format!("{command:?} in {theme:?}"));
                window.key(Key::Escape);
            }
        }
        let titles = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5].map(|key| {
            window.key(key);
            window
                .harness
                .query_all_by_label_contains("Stage: ")
                .filter_map(|node| node.accesskit_node().label())
                .collect::<Vec<_>>()
        });
        let different: std::collections::BTreeSet<_> = titles.iter().collect();
        assert!(different.len() == 5 && titles[0].len() == 2, "{titles:?}");
    }
}

#[test]
fn panes_fold_away_and_come_back() {
    let mut window = Window::usual();
    use Region::{Chart, Explanation, Parameters};
    assert!(window.has(Parameters) && window.has(Explanation) && window.has(Chart));
    window.press(Modifiers::COMMAND, Key::Num1);
    window.press(Modifiers::COMMAND, Key::Num2);
    assert!(!window.has(Parameters) && window.has(Explanation) && !window.has(Chart));
    window.command(Command::ResetLayout);
    assert!(window.has(Parameters) && window.has(Chart));
    window.chart("Plot");
    assert!(window.harness.query_all_by_label_contains("Cost by candidate").next().is_some());
}

#[test]
fn pictures_of_a_folder_are_called_by_their_files() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["wave_07.png", "wave_08.png"] {
        image::GrayImage::new(64, 48).save(folder.path().join(name)).expect("a picture");
    }
    let open = Some(folder.path().into());
    let window = Window::with(vec2(1440.0, 900.0), Start { open });
    for title in ["Stage: Frame t = 0 · wave_07.png", "Stage: Frame t+1 = 1 · wave_08.png"] {
        assert!(window.harness.query_by_label(title).is_some(), "{title}");
    }
}

#[test]
fn the_end_stays_the_end_while_parameters_change() {
    let mut window = Window::usual();
    window.command(Command::End);
    for block in [64.0, 48.0, 20.0, 4.0, 16.0] {
        window.harness.get_by_role_and_label(Role::Slider, "Block size").set_value_accesskit(block);
        // Without waiting for the run: the next change comes while it is on its way.
        window.harness.run_steps(2);
    }
    window.settle();
    assert!(window.shown().at_end && window.value("block-size") == Value::Int(16));
}

#[test]
fn a_clip_without_a_pair_takes_nothing_from_the_one_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("only.png");
    image::GrayImage::new(64, 48).save(&picture).expect("a picture");
    let mut window = Window::usual();
    window.harness.state_mut().open(&picture);
    window.settle();
    for _ in 0..2 {
        assert!(window.harness.query_by_role(Role::Alert).is_some(), "why is still told");
        assert!(window.app().view().shown.is_none(), "the clip before is gone");
        window.harness.hover_at(Pos2::new(600.0, 300.0));
        window.key(Key::ArrowRight);
    }
    window.press(Modifiers::COMMAND, Key::S);
    assert!(window.harness.query_by_label_contains("Save session").is_none(), "there is nothing to save");
}

#[test]
fn what_is_still_being_written_is_not_cut_short_by_the_next() {
    let folder = tempfile::tempdir().expect("a folder");
    let order = |what, name: &str| {
        let path = folder.path().join(name);
        Order { what, path, scale: 2, look: Look::default(), panes: Selection::default() }
    };
    let mut window = Window::usual();
    let (from, to) = (Cursor { unit: 0, event: 1 }, Cursor { unit: 0, event: 12 });
    let steps = OutputKind::Steps(Range { from, to, granularity: 2 }, Format::Png);
    window.harness.state_mut().write(order(steps, "steps"));
    window.harness.state_mut().write(order(OutputKind::Picture, "one.png"));
    assert!(window.app().message().is_some_and(|text| text.contains("still being saved")));
    let begun = Instant::now();
    while window.app().written().expect("it is being written") < 1.0 {
        std::thread::sleep(Duration::from_millis(1));
        assert!(begun.elapsed() < Duration::from_secs(60), "the last picture is never told of");
    }
    window.settle();
    assert_eq!(fs::read_dir(folder.path().join("steps")).expect("the folder").count(), 12);
    assert!(!folder.path().join("one.png").exists());
}

#[test]
fn the_end_of_a_run_has_a_prediction_and_a_residual() {
    let mut window = Window::usual();
    let seen = |window: &Window, label: &str| window.harness.query_all_by_label_contains(label).next().is_some();
    window.key(Key::Num7);
    assert!(!seen(&window, "Prediction of frame t"), "there is none in the middle");
    window.command(Command::End);
    window.key(Key::Num7);
    assert!(seen(&window, "Stage: Prediction of frame t = 0"));
    let pictures = window.shown().pictures.clone();
    let made = pictures.prediction.expect("the end has a prediction");
    let psnr = metrics::psnr_db(made.luma(), pictures.pair[0].luma()).expect("one size");
    assert!(seen(&window, &format!("{psnr:.2} dB")), "the quality told is that of the picture shown");
    window.key(Key::Num8);
    assert!(seen(&window, "Stage: |frame 0 − its prediction|"));
    window.key(Key::ArrowLeft);
    assert!(seen(&window, "Stage: Frame t = 0"), "before the end there is only the frame");
}

#[test]
fn a_click_on_a_chart_goes_to_the_candidate() {
    let mut window = Window::usual();
    let surface = window.shown().step.readouts.iter().find_map(|readout| match readout {
        Readout::Surface(surface) => Some(surface.clone()),
        _ => None,
    });
    let surface = surface.expect("a block is being searched");
    let map = window.harness.get_by_role_and_label(Role::Image, &heat_map::summary(&surface)).rect();
    let cell = map.width() / surface.values.width() as f32;
    window.click_at(map.min + vec2(4.5 * cell, 2.5 * cell));
    assert_eq!(Some(window.cursor().event), surface.events[(4, 2)]);

    let (unit, events) = (window.cursor().unit, window.shown().events);
    window.key(Key::U);
    window.chart("Plot");
    let plot = window
        .harness
        .query_all_by_role(Role::Image)
        .find(|node| node.accesskit_node().label().is_some_and(|label| label.starts_with("Cost by candidate")));
    let plot = plot.expect("the plot is shown").rect();
    window.click_at(plot.center());
    let cursor = window.cursor();
    assert!(cursor.unit >= unit && cursor.event > 2 && cursor.event < events.max(window.shown().events), "{cursor}");
}

#[test]
fn a_click_on_what_was_not_tested_goes_where_it_is_reported() {
    let mut window = Window::usual();
    let surface = |window: &Window| {
        let step = &window.shown().step;
        step.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface.clone()),
            _ => None,
        })
    };
    let click = |window: &mut Window, cell: (usize, usize)| {
        let surface = surface(window).expect("a block is being searched");
        let map = window.harness.get_by_role_and_label(Role::Image, &heat_map::summary(&surface)).rect();
        let size = map.width() / surface.values.width() as f32;
        window.click_at(map.min + vec2(cell.0 as f32 + 0.5, cell.1 as f32 + 0.5) * size);
    };
    // A later step of the same block tests it.
    let unit = window.cursor().unit;
    let now = surface(&window).expect("a block is being searched");
    let last = (now.values.width() - 2, now.values.height() - 2);
    assert_eq!(now.events[last], None, "it is not its turn yet");
    click(&mut window, last);
    let there = surface(&window).expect("a block is being searched");
    assert_eq!((window.cursor().unit, Some(window.cursor().event)), (unit, there.events[last]));
    // No step tests it: the end of the block has its cost, and it is said why.
    window.click("Estimator: Full search");
    window.click("Diamond search");
    window.harness.state_mut().walk_from(Place::at(Cursor { unit, event: 3 }));
    window.settle();
    let corner = (1, 1);
    assert_eq!(surface(&window).expect("a block is being searched").events[corner], None);
    click(&mut window, corner);
    assert_eq!(window.cursor(), Cursor { unit, event: window.shown().events });
    let told = window.app().message().map(str::to_owned);
    assert!(told.as_ref().is_some_and(|told| told.contains("Diamond search does not test")), "{told:?}");
}

#[test]
fn keys_zoom_the_picture_and_not_the_interface() {
    let mut window = Window::usual();
    window.command(Command::FocusNever);
    let percent = |window: &Window| {
        let mut told = window.harness.query_all_by_label_contains(" %").filter_map(|node| {
            let node = node.accesskit_node();
            node.value().or(node.label())?.strip_suffix(" %")?.parse::<f32>().ok()
        });
        told.next_back().expect("the zoom is told")
    };
    let whole = percent(&window);
    window.key(Key::Plus);
    window.key(Key::Plus);
    assert!((percent(&window) / whole - 2.25).abs() < 0.05, "{} of {whole}", percent(&window));
    window.key(Key::Minus);
    assert!((percent(&window) / whole - 1.5).abs() < 0.05);
    window.key(Key::Num0);
    assert_eq!(percent(&window), whole);
    assert_eq!(window.app().settings().zoom(), 1.0);
}

#[test]
fn the_view_follows_the_work_until_another_is_chosen_by_hand() {
    let mut window = Window::usual();
    let percent = |window: &Window| {
        let mut told = window.harness.query_all_by_label_contains(" %").filter_map(|node| {
            let node = node.accesskit_node();
            node.value().or(node.label())?.strip_suffix(" %")?.parse::<f32>().ok()
        });
        told.next_back().expect("the zoom is told")
    };
    let close = percent(&window);
    window.key(Key::PageDown);
    window.key(Key::PageDown);
    assert_eq!(percent(&window), close, "from block to block it is magnified alike");
    window.key(Key::G);
    let whole = percent(&window);
    assert!(whole < 0.7 * close, "{whole} of {close}");
    window.key(Key::G);
    assert_eq!(percent(&window), close);
    window.key(Key::Plus);
    let chosen = percent(&window);
    window.key(Key::PageDown);
    assert!(chosen > close && percent(&window) == chosen, "what is chosen by hand is kept");
    window.key(Key::G);
    assert_eq!(percent(&window), close, "until the key is pressed");
    let map = window.harness.get_by_label("Map of the whole picture").rect();
    window.click_at(map.min + vec2(4.0, 4.0));
    window.key(Key::PageDown);
    assert_eq!(percent(&window), close, "the map moves what is seen, and magnifies nothing");
    window.key(Key::End);
    window.key(Key::G);
    assert!(percent(&window) < 0.7 * close, "the end is shown whole: {} of {close}", percent(&window));
}

#[test]
fn large_type_in_a_small_window_leaves_room_for_the_stage() {
    for size in [vec2(1280.0, 720.0), vec2(1440.0, 900.0)] {
        let mut window = Window::new(size);
        window.command(Command::ProjectorTheme);
        assert!(!window.has(Region::Parameters) && window.has(Region::Strip));
        window.command(Command::ShowParameters);
        assert!(window.has(Region::Parameters), "they come when asked for");
        window.command(Command::LightTheme);
        assert!(window.has(Region::Explanation) && !window.has(Region::Strip));
    }
}

#[test]
fn play_starts_anew_at_the_end() {
    let mut window = Window::usual();
    window.command(Command::End);
    assert!(window.shown().at_end);
    window.harness.state_mut().command(Command::Play);
    let begun = Instant::now();
    while window.harness.state().view().shown.as_deref().is_none_or(|shown| shown.at_end) {
        window.harness.step();
        assert!(begun.elapsed() < Duration::from_secs(20), "it stays at the end");
    }
    assert_eq!(window.cursor().unit, 0);
}

#[test]
fn the_interface_scales_within_bounds() {
    let mut window = Window::usual();
    (0..30).for_each(|_| window.press(Modifiers::COMMAND, Key::Plus));
    let largest = window.app().settings().zoom();
    assert!(largest > 1.5 && largest <= 1440.0 / 784.0, "{largest}: what has no room is not offered");
    window.press(Modifiers::COMMAND, Key::Num0);
    assert_eq!(window.app().settings().zoom(), 1.0);
}

#[test]
fn estimators_are_compared_and_what_one_missed_is_visited() {
    let mut window = Window::new(vec2(1600.0, 1000.0));
    window.harness.key_press(Key::C);
    window.compared();
    assert!(window.harness.query_by_label("969.2").is_some(), "full search's candidates");
    let links = window.harness.query_all_by_role(Role::Link).count();
    assert_eq!(links, 2, "three-step and diamond search have missed something, full search has not");
    window.harness.query_all_by_role(Role::Link).last().expect("a link").click();
    window.settle();
    assert_eq!(window.app().document().estimator().info().id, "diamond");
    assert!(window.cursor().event > 1 && window.cursor().event == window.shown().events, "at the block's end");
    window.command(Command::Undo);
    assert_eq!(window.app().document().estimator().info().id, "full-search");
}

#[test]
fn an_entry_of_the_legend_shows_its_marks_alone_while_it_is_pointed_at() {
    let mut window = Window::usual();
    let legend = window.harness.get_by_label_contains("Legend: ").rect();
    let mut pictures = window.harness.query_all_by_label_contains("Stage: Frame t");
    let picture = pictures.next().expect("a picture").rect();
    drop(pictures);
    let lit = |window: &mut Window, at: Pos2| {
        window.harness.hover_at(at);
        window.settle();
        window.app().lit()
    };
    assert_eq!(window.app().lit(), None);
    let entry = legend.left_top() + vec2(10.0, 10.0);
    assert!(lit(&mut window, entry).is_some());
    assert_eq!(lit(&mut window, picture.center()), None, "on the picture all marks are back");
    assert!(lit(&mut window, entry).is_some());
    assert_eq!(lit(&mut window, Pos2::new(5.0, 5.0)), None, "and so they are elsewhere");
}

#[test]
fn a_word_in_the_colour_of_a_role_shows_its_marks_alone_while_it_is_pointed_at() {
    let mut window = Window::usual();
    window.harness.key_press(Key::ArrowRight);
    window.settle();
    let sentence = window.shown().step.sentence.clone();
    let roles: Vec<_> = sentence.words().filter_map(|(_, role)| role).collect();
    assert!(!roles.is_empty(), "{}", sentence.plain());
    let line = window.harness.query_all_by_label_contains(&sentence.plain()).next().expect("it is shown").rect();
    let mut found = std::collections::BTreeSet::new();
    let (width, height) = (line.width() as usize / 24, line.height() as usize / 8);
    for at in (0..height).flat_map(|y| (0..width).map(move |x| line.min + vec2(24.0 * x as f32, 8.0 * y as f32 + 4.0)))
    {
        window.harness.hover_at(at);
        window.settle();
        found.extend(window.app().lit());
    }
    let is_marked =
        |role: &&motionscope_core::scene::Role| window.shown().scene.marks.iter().any(|mark| mark.role == **role);
    let missing = roles.iter().filter(is_marked).find(|role| !found.contains(role));
    assert_eq!(missing, None, "not found in {}: {found:?}", sentence.plain());
    window.harness.hover_at(Pos2::new(5.0, 5.0));
    window.settle();
    assert_eq!(window.app().lit(), None, "elsewhere all marks are back");
}

#[test]
fn what_can_be_done_on_the_stage_is_told_once() {
    let mut window = Window::usual();
    let told = |window: &Window| {
        window.harness.query_all_by_label_contains("Click a pixel to go to its result").next().is_some()
    };
    let mut pictures = window.harness.query_all_by_label_contains("Stage: Frame t");
    let picture = pictures.next().expect("a picture").rect().center();
    drop(pictures);
    assert!(!told(&window), "not before one gets there");
    window.harness.hover_at(picture);
    window.settle();
    assert!(told(&window));
    window.harness.hover_at(Pos2::new(5.0, 5.0));
    // It goes by itself.
    window.harness.run_steps(600);
    assert!(!told(&window));
    window.harness.hover_at(picture);
    window.settle();
    assert!(!told(&window), "and does not come back");
}

#[test]
fn the_list_of_sweeps_opens_as_often_as_it_is_asked_for() {
    let mut window = Window::new(vec2(1600.0, 1000.0));
    window.harness.key_press(Key::C);
    window.compared();
    let has_list = |window: &Window| window.harness.query_by_label_contains("Search range: ").is_some();
    for away in ["Sweep", "Compare estimators", "Sweep", "Compare estimators"] {
        window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").click();
        window.compared();
        assert!(has_list(&window), "it is open");
        // It is closed by a click on itself, or elsewhere.
        match away {
            "Sweep" => window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").click(),
            elsewhere => window.harness.get_by_label(elsewhere).click(),
        }
        window.compared();
        assert!(!has_list(&window), "it is closed");
    }
    // It lies above the dialog, which was clicked: a click on an entry reaches it.
    window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").click();
    window.compared();
    window.harness.get_by_label_contains("Search range: ").click();
    window.compared();
    let chosen = window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").accesskit_node().value();
    assert!(chosen.as_ref().is_some_and(|chosen| chosen.starts_with("Search range: ")), "{chosen:?}");
}

#[test]
fn the_table_keeps_its_heading_and_names_what_is_the_same_in_all_rows() {
    let mut window = Window::new(vec2(1280.0, 720.0));
    window.harness.key_press(Key::C);
    window.compared();
    let below = window.harness.query_by_label_contains("The same in all rows").expect("a line below the table").rect();
    let same = window.harness.get_by_label_contains("frame without prediction kB").rect();
    assert!(same.min.y >= below.min.y, "it stands in the line below and not in the heading");
    window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").click();
    window.compared();
    window.harness.get_by_label_contains("Search range: ").click();
    window.compared();
    let heading = |window: &Window| window.harness.get_by_label("Estimator").rect();
    let row = |window: &Window| {
        let rows = window.harness.query_all_by_label("Full search").map(|node| node.rect().min.y);
        // The title bar names it too.
        rows.filter(|y| *y > 100.0).fold(f32::INFINITY, f32::min)
    };
    let before = (heading(&window), row(&window));
    window.harness.hover_at(before.0.center_bottom() + vec2(0.0, 20.0));
    window.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        source: MouseWheelSource::Unknown,
        delta: vec2(0.0, -60.0),
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    window.harness.run_steps(60);
    assert_eq!(heading(&window), before.0, "the heading stays");
    assert!(row(&window) < before.1 - 20.0, "{} after {}: the rows go up", row(&window), before.1);
}

#[test]
fn the_plot_of_a_sweep_and_the_table_are_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::new(vec2(1600.0, 1000.0));
    window.harness.key_press(Key::C);
    window.compared();
    let save = |window: &mut Window, name: &str| {
        let path = folder.path().join(name);
        let field = window.harness.get_by_label("File of the plot or the table");
        field.set_text_value_accesskit(&path.display().to_string());
        window.compared();
        window.harness.get_by_label("Save").click();
        let begun = Instant::now();
        while window.harness.query_by_label_contains(name).is_none() || !path.is_file() {
            window.harness.run_steps(2);
            if begun.elapsed() > Duration::from_secs(10) {
                break;
            }
        }
        fs::read_to_string(path).ok()
    };
    assert!(save(&mut window, "table.csv").is_some_and(|table| table.starts_with("estimator,candidates_mean")));
    assert_eq!(save(&mut window, "plot.svg"), None, "without a sweep there is no plot");
    window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").click();
    window.compared();
    window.harness.get_by_label_contains("Search range: ").click();
    window.compared();
    let plot = save(&mut window, "plot.svg").expect("a plot");
    assert!(plot.contains("Search range") && plot.contains("EPE px"), "the error over the parameter");
}

#[test]
fn the_courses_table_is_measured_in_the_window_too() {
    let mut window = Window::new(vec2(1600.0, 1000.0));
    window.harness.key_press(Key::C);
    window.compared();
    window.harness.get_by_label("The course's table").click();
    window.compared();
    assert!(window.harness.query_by_label("3.88").is_some(), "the window of full search grows");
    let count = |label: &str| window.harness.query_all_by_label(label).count();
    let [holds, in_part, fails, undecided] = ["holds", "holds in part", "does not hold", "undecided"].map(count);
    // Typical applications are a judgement; on this clip two searches are equally accurate.
    assert!(holds >= 4 && (1..=2).contains(&undecided), "{holds} hold, {undecided} are undecided");
    assert_eq!(holds + in_part + fails + undecided, 15);
    assert!(window.harness.query_all_by_label_contains("(line 631)").count() > 0, "statements have their lines");
    window.harness.get_by_label("Estimators").click();
    window.compared();
    assert!(window.harness.query_by_label("969.2").is_some(), "back at one's own choice");
}

#[test]
fn another_estimator_keeps_the_parameters_that_it_has_too() {
    let mut window = Window::usual();
    window.harness.get_by_role_and_label(Role::Slider, "Block size").set_value_accesskit(24.0);
    window.settle();
    window.press(Modifiers::COMMAND, Key::K);
    window.harness.get_by_label("What to find").type_text("hexagon");
    window.settle();
    window.key(Key::Enter);
    assert_eq!(window.app().document().estimator().info().id, "hexagon");
    assert_eq!(window.value("block-size"), Value::Int(24));
}

#[test]
fn a_key_that_is_let_go_as_another_can_be_pressed_again() {
    let mut window = Window::usual();
    let key = |key, pressed, modifiers| Event::Key {
        key,
        physical_key: Some(Key::Slash),
        pressed,
        // What egui makes of it goes by the name of the key.
        repeat: false,
        modifiers,
    };
    for _ in 0..3 {
        window.harness.event(key(Key::Questionmark, true, Modifiers::SHIFT));
        window.settle();
        assert!(window.harness.query_by_label_contains("Esc closes this page.").is_some());
        // Shift goes up first, and the key is a slash by then.
        window.harness.event(key(Key::Slash, false, Modifiers::NONE));
        window.key(Key::Escape);
        assert!(window.harness.query_by_label_contains("Esc closes this page.").is_none());
    }
}

#[test]
fn a_key_opens_the_examples_of_an_estimator_one_after_the_other() {
    let mut window = Window::usual();
    let examples: Vec<_> = motionscope_core::course::examples::of("full-search").collect();
    assert!(examples.len() > 2, "there are several");
    for example in examples.iter().chain(&examples[..1]) {
        window.key(Key::E);
        window.settle();
        let experiment = window.app().document().experiment();
        assert_eq!(experiment.source.to_string(), format!("synth:{}", example.clip));
        assert_eq!(experiment.estimator.info().id, "full-search");
        let verdict = if example.is_failure() { "Fails: " } else { "Works." };
        assert!(window.harness.query_by_label_contains(verdict).is_some(), "{} is said", example.id);
    }
}
