//! The charts in the window, driven headlessly: what a search leaves behind, and what a click on it does.

use std::fs;

use eframe::egui::accesskit::Role;
use eframe::egui::vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use motionscope::ui::app::App;
use motionscope::ui::commands::Command;
use motionscope::ui::model::snapshot::Snapshot;
use motionscope::ui::{self, Start};
use motionscope_core::data::Histogram;
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
            if app.is_at_start() {
                app.leave_start();
            }
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

    /// Shows a chart, by its tab or in the list of those that there is no room for beside each other.
    fn chart(&mut self, name: &str) {
        if self.0.query_by_role_and_label(Role::Tab, name).is_none() {
            self.0.get_by_role_and_label(Role::ComboBox, "Chart").click();
            self.settle();
            self.0.get_by_label(name).click();
        } else {
            self.0.get_by_role_and_label(Role::Tab, name).click();
        }
        self.settle();
    }

    fn is_shown(&self, chart: &str) -> bool {
        self.0.query_all_by_label_contains(chart).next().is_some()
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
    window.command(Command::End);
    window.chart("Histogram");
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
fn the_histogram_comes_with_the_first_block() {
    let mut window = Window::new();
    window.command(Command::End);
    window.chart("Histogram");
    assert!(window.is_shown("Histogram: "));
    window.command(Command::Start);
    assert!(window.histogram().is_none() && !window.is_shown("Histogram: "));
}

#[test]
fn without_blocks_pixels_are_counted_at_the_end() {
    let mut window = Window::on("estimator = \"horn-schunck\"");
    window.command(Command::End);
    assert_eq!(window.histogram().map(|histogram| histogram.of), Some("pixel"));
    window.chart("Errors");
    assert!(window.is_shown("Endpoint error: mean "));
}

#[test]
fn of_features_errors_alone_are_counted() {
    let mut window = Window::on("estimator = \"pyramidal-lucas-kanade\"");
    window.command(Command::Start);
    assert!(!window.is_shown("Endpoint error: mean "));
    window.command(Command::End);
    window.chart("Errors");
    assert!(window.is_shown("Endpoint error: mean ") && window.histogram().is_none());
}

#[test]
fn blocks_count_displacements_and_at_the_end_errors_too() {
    let mut window = Window::on("estimator = \"full-search\"\nstep = \"3.4\"");
    window.command(Command::End);
    for (chart, told) in
        [("Histogram", "Histogram: "), ("Errors", "Endpoint error: mean "), ("Histogram", "Histogram: ")]
    {
        window.chart(chart);
        assert!(window.is_shown(told), "{chart}");
    }
}
