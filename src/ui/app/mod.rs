//! The application: what it holds, what its commands and actions do, and the frame that is drawn.

mod actions;
mod arrangement;
mod camera;
mod commands;
mod dialogs;
mod estimator;
mod exports;
mod find;
mod finger;
mod focus;
mod frame;
mod given;
mod keys;
mod lessons;
mod links;
mod lockstep;
mod look;
mod opening;
mod places;
mod playback;
mod predict;
mod present;
mod run;
mod situation;
mod start;
mod summary;

use eframe::egui;
use motionscope_core::base::Error;
use motionscope_core::scene::Role;

use crate::ui::drawing::style;
use crate::ui::layout::Folded;
use crate::ui::model::document::Document;
use crate::ui::model::predict::Predict;
use crate::ui::model::settings::Settings;
use crate::ui::model::walker::View;
use crate::ui::parts::toasts::Toasts;
use arrangement::PaneMemory;
use camera::Recorder;
use dialogs::Dialogs;
use exports::Exports;
use finger::Finger;
use frame::STATES;
use lessons::Course;
use links::Links;
use opening::Opening;
use present::Presentation;
use run::Run;
pub use summary::Summary;

/// A part of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// The start page, instead of all panes.
    Start,
    /// The line at the top.
    Header,
    /// The pictures with what stands around them.
    Stage,
    /// A picture.
    Pictures,
    /// A chart.
    Chart,
    /// The whole explanation.
    Explanation,
    /// Sentence and formula.
    Strip,
    /// The page of a lesson.
    Lesson,
    /// The parameters.
    Parameters,
    /// Steps, play and timeline.
    Transport,
    /// The question about the next result.
    Question,
    /// The line at the bottom.
    Status,
}

/// The window.
pub struct App {
    settings: Settings,
    run: Run,
    opening: Opening,
    exports: Exports,
    course: Course,
    links: Links,
    panes: PaneMemory,
    dialogs: Dialogs,
    presentation: Presentation,
    recorder: Recorder,
    toasts: Toasts,
    finger: Finger,
    /// Whether the keys that a new user has tried can be stored: otherwise a hint would return at each start.
    can_remember: bool,
    /// The interface that egui was told last.
    styled: Option<style::Interface>,
    ctx: egui::Context,
}

impl App {
    /// A window in `ctx` with what was remembered.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(ctx: &egui::Context, storage: Option<&dyn eframe::Storage>) -> std::io::Result<Self> {
        let mut settings = Settings::load(storage);
        settings.leave_end();
        style::install_fonts(ctx);
        let interface = settings.interface(ctx.content_rect().size() * ctx.zoom_factor());
        style::apply(ctx, interface);
        let repaint = ctx.clone();
        let states = storage.and_then(|storage| eframe::get_value(storage, STATES)).unwrap_or_default();
        Ok(Self {
            run: Run::new(move || repaint.request_repaint(), settings.speed)?,
            opening: Opening::default(),
            exports: Exports::default(),
            course: Course::default(),
            links: Links::default(),
            panes: PaneMemory { states, ..PaneMemory::default() },
            dialogs: Dialogs::default(),
            presentation: Presentation::default(),
            recorder: Recorder::default(),
            toasts: Toasts::default(),
            finger: Finger::default(),
            can_remember: storage.is_some(),
            styled: Some(interface),
            ctx: ctx.clone(),
            settings,
        })
    }

    /// Receives the results of other threads, and a request to quit.
    fn receive(&mut self) {
        self.hold_quit();
        self.receive_opened();
        self.receive_run();
        self.receive_written();
        self.browsed();
        self.receive_given();
    }

    /// What is open and how it is set.
    pub fn document(&self) -> &Document {
        &self.run.document
    }

    /// What the run is presented with.
    pub fn presentation(&self) -> &Presentation {
        &self.presentation
    }

    /// What the walker shows and does.
    pub fn view(&self) -> &View {
        &self.run.view
    }

    /// What the window remembers.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The role whose marks alone are shown on the stage.
    pub fn lit(&self) -> Option<Role> {
        self.panes.states.stage.lit()
    }

    /// Share of what is being written that is done, from 0 to 1.
    pub fn written(&self) -> Option<f32> {
        self.exports.fraction()
    }

    /// The questions about the next result.
    pub fn predict(&self) -> &Predict {
        &self.run.predict
    }

    /// The newest message, if one is shown.
    pub fn message(&self) -> Option<&str> {
        self.toasts.last()
    }

    /// What went wrong and was not read yet.
    pub fn error(&self) -> Option<&Error> {
        self.opening.error.as_ref()
    }

    /// Waits until nothing is worked on any more, for tests; what was found is shown in the next frame.
    pub fn wait(&mut self) {
        while self.opening.loading.is_some() || self.exports.writing.is_some() {
            std::thread::sleep(std::time::Duration::from_millis(2));
            self.receive();
        }
        while !self.run.walker.wait_for(std::time::Duration::from_millis(20)) {
            self.run.walker.tend();
        }
        self.receive();
    }

    /// Whether everything that was asked for is there and shown.
    pub fn is_settled(&self) -> bool {
        let is_idle = self.opening.loading.is_none() && self.exports.writing.is_none();
        is_idle && self.dialogs.is_settled() && self.run.is_settled()
    }

    /// Whether there is a picture of a step of the estimator `id`.
    pub fn has_picture_of(&self, id: &str) -> bool {
        self.dialogs.previews.steps.has(id)
    }

    /// Where everything lay in the last frame, in points.
    pub fn regions(&self) -> &[(Region, egui::Rect)] {
        &self.panes.regions
    }

    /// Size of the window in points at an interface scale of 1.
    fn size(&self) -> egui::Vec2 {
        self.ctx.content_rect().size() * self.ctx.zoom_factor()
    }

    /// What is folded away just now.
    pub fn folded(&self) -> Folded {
        self.settings.folded()
    }
}
