//! The charts in the window, driven headlessly: what a search leaves behind, and what a click on it does.

use std::fs;

use eframe::egui::accesskit::Role;
use eframe::egui::vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use motionscope::ui::app::App;
use motionscope::ui::app::commands::Command;
use motionscope::ui::model::snapshot::Snapshot;
use motionscope::ui::{self, Start};
use motionscope_core::Histogram;
use motionscope_core::scene::Readout;

/// The window, and the waiting that a person does not notice.
struct Window(Harness<'static, App>);

impl Window {
    fn new() -> Self {
        Self::with(Start::default())
    }

    /// A window on the session with these lines beside its clip.
    fn on(lines: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("one.motionscope");
        fs::write(&path, format!("motionscope = 1\nclip = \"synth:pillar\"\n{lines}\n")).expect("it is written");
        Self::with(Start { open: Some(path.into()) })
    }

    fn with(start: Start) -> Self {
        let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_step_dt(1.0 / 60.0).with_max_steps(80);
        let mut window = Self(builder.build_eframe(move |cc| {
            let mut app = App::new(&cc.egui_ctx, None).expect("a thread");
            ui::begin(&mut app, start);
            app
        }));
        window.settle();
        window
    }

    fn settle(&mut self) {
        for _ in 0..3 {
            self.0.state_mut().wait();
            self.0.run_steps(2);
        }
        self.0.run();
    }

    fn command(&mut self, command: Command) {
        self.0.state_mut().command(command);
        self.settle();
    }

    fn tab(&mut self, name: &str) {
        self.0.get_by_role_and_label(Role::Tab, name).click();
        self.settle();
    }

    fn shown(&self) -> &Snapshot {
        self.0.state().view().shown.as_deref().expect("a run is shown")
    }

    fn histogram(&self) -> Option<Histogram> {
        self.shown().step.readouts.iter().find_map(|readout| match readout {
            Readout::Histogram(histogram) => Some(histogram.clone()),
            _ => None,
        })
    }
}

#[test]
fn a_click_on_a_bin_goes_to_the_first_block_with_that_displacement() {
    let mut window = Window::new();
    window.tab("Histogram");
    window.command(Command::End);
    let histogram = window.histogram().expect("the run is over");
    let (at, _) = histogram.fullest()[1];
    let cell = histogram.cell(at).expect("it is shown");
    let map = window.0.get_by_role_and_label(Role::Image, &ui::charts::histogram::name(&histogram)).rect();
    let side = map.width() / histogram.counts.width() as f32;
    let place = map.min + vec2(cell.0 as f32 + 0.5, cell.1 as f32 + 0.5) * side;
    window.0.hover_at(place);
    window.0.run_steps(2);
    window.0.drag_at(place);
    window.0.drop_at(place);
    window.settle();
    assert_eq!(Some(window.shown().cursor.unit), histogram.units[cell]);
    assert_eq!(window.shown().cursor.event, window.shown().events, "the block is done");
    assert_eq!(window.histogram().and_then(|histogram| histogram.newest), Some(at));
}

#[test]
fn before_the_first_block_is_done_the_histogram_says_what_to_do() {
    let mut window = Window::new();
    window.tab("Histogram");
    window.command(Command::Start);
    assert_eq!(window.histogram(), None);
    let told = window.0.query_all_by_label_contains("until the first block is done").count();
    assert_eq!(told, 1);
}

#[test]
fn without_blocks_pixels_are_counted_at_the_end() {
    let mut window = Window::on("estimator = \"horn-schunck\"");
    window.tab("Histogram");
    window.command(Command::Start);
    assert_eq!(window.0.query_all_by_label_contains("at the end of the run").count(), 1);
    window.command(Command::End);
    assert_eq!(window.histogram().map(|histogram| histogram.of), Some("pixel"));
    window.0.get_by_label("Errors").click();
    window.settle();
    assert_eq!(window.0.query_all_by_label_contains("Endpoint error: mean ").count(), 1);
}

#[test]
fn of_features_errors_alone_are_counted() {
    let mut window = Window::on("estimator = \"pyramidal-lucas-kanade\"");
    window.tab("Histogram");
    for (command, told) in [(Command::Start, "at the end of the run"), (Command::End, "Endpoint error: mean ")] {
        window.command(command);
        assert_eq!(window.0.query_all_by_label_contains(told).count(), 1, "{command:?}");
    }
}

#[test]
fn blocks_count_displacements_and_at_the_end_errors_too() {
    let mut window = Window::on("estimator = \"full-search\"\nstep = \"3.4\"");
    window.tab("Histogram");
    assert!(window.0.query_by_label("Displacements").is_none(), "errors are not known yet");
    window.command(Command::End);
    assert!(window.0.query_by_label_contains("Histogram: ").is_some());
    window.0.get_by_label("Errors").click();
    window.settle();
    assert!(window.0.query_by_label_contains("Endpoint error: mean ").is_some());
    window.0.get_by_label("Displacements").click();
    window.settle();
    assert!(window.0.query_by_label_contains("Histogram: ").is_some());
}
