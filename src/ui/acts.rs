//! What the window does when it is told to.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{TryRecvError, channel};
use std::time::Instant;

use eframe::egui::{self, ViewportCommand};
use motionscope_core::synth::Sample;
use motionscope_core::{Clip, Cursor, Error, Move, Way, estimator};

use super::action::Action;
use super::app::{App, Overlay, title};
use super::commands::Command;
use super::document::{Origin, Owner};
use super::layout;
use super::loader::Loading;
use super::style::ZOOM;
use super::{open_dialog, palette};
use crate::paint::View as Pictures;

impl App {
    /// Takes in what other threads have done.
    pub(super) fn receive(&mut self) {
        self.view = self.walker.view();
        if let Some(loading) = &self.loading
            && let Some(outcome) = loading.take()
        {
            let path = loading.path.clone();
            self.loading = None;
            match outcome {
                Ok(clip) => self.opened(clip, path),
                Err(error) => self.not_opened(&path, error),
            }
        }
        let browsed = self.browsing.as_ref().map(|browsing| browsing.try_recv());
        match browsed {
            Some(Ok(path)) => {
                self.browsing = None;
                if let Some(path) = path {
                    self.open(path);
                }
            }
            Some(Err(TryRecvError::Disconnected)) => {
                self.browsing = None;
                self.toasts.fail("The system offers no file dialog. Type or paste the path instead.");
                self.overlay = Overlay::Open(open_dialog::State::default());
            }
            Some(Err(TryRecvError::Empty)) | None => {}
        }
    }

    /// Does what was asked for.
    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::Command(command) => self.command(command),
            Action::Open(path) => self.open(path),
            Action::OpenSample(sample) => self.open_sample(sample),
            Action::CancelOpening => self.loading = None,
            Action::Browse { folder } => self.browse(folder),
            Action::Choose(id) => self.choose(id),
            Action::Set(owner, index, value) => {
                if let Err(error) = self.document.set(owner, index, value) {
                    self.toasts.fail(error.to_string());
                }
                self.restart();
            }
            Action::Settle => self.document.settle(),
            Action::ResetAll(owner) => {
                self.document.reset(owner);
                self.restart();
            }
            Action::Seek(cursor) => {
                self.player.pause();
                self.walker.go(Move::To(cursor));
            }
            Action::SeekAt(point) => {
                self.player.pause();
                self.walker.go_at(point);
            }
            Action::Focus(point) => self.walker.focus(point),
            Action::Frame(frame) => self.go_to_frame(frame),
            Action::Speed(speed) => {
                self.player.speed = speed;
                self.settings.speed = speed;
            }
            Action::Theme(theme) => self.settings.set_theme(theme),
            Action::Dismiss => self.error = None,
        }
    }

    /// Does what a command says, if it makes sense just now.
    pub fn command(&mut self, command: Command) {
        use Command as C;
        if !command.enabled(&self.now()) {
            return;
        }
        match command {
            C::Open => self.overlay = Overlay::Open(open_dialog::State::default()),
            C::PastePath => self.ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            C::Samples => self.overlay = Overlay::Samples,
            C::Palette => self.overlay = Overlay::Palette(palette::State::default()),
            C::Shortcuts => self.overlay = Overlay::Shortcuts,
            C::About => self.overlay = Overlay::About,
            C::Quit => self.ctx.send_viewport_cmd(ViewportCommand::Close),
            C::SaveSession | C::ExportPicture | C::ExportSteps | C::ExportVectors => {}
            C::Undo | C::Redo | C::ResetParameters => self.edit(command),
            C::SideBySide | C::FrameT | C::FrameNext | C::Difference | C::Blend | C::Blink | C::Fit | C::ActualSize => {
                self.look_at(command);
            }
            C::NextTheme | C::LargerInterface | C::SmallerInterface | C::NormalInterface => self.restyle(command),
            C::ShowParameters | C::ShowWhy | C::ShowCharts | C::Lecture | C::ResetLayout => self.arrange(command),
            C::FullScreen => {
                let now = self.ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                self.ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!now));
            }
            C::ReducedMotion => self.settings.reduced_motion = !self.settings.reduced_motion,
            C::Play if self.player.is_playing() => self.player.pause(),
            C::Play => self.player.play(),
            C::Slower | C::Faster => {
                self.player.shift(command == C::Faster);
                self.settings.speed = self.player.speed;
            }
            C::NextFrame => self.go_to_frame(self.document.frame() + 1),
            C::PreviousFrame => self.go_to_frame(self.document.frame().saturating_sub(1)),
            C::Stop => {
                self.player.pause();
                self.walker.stop();
            }
            C::Into | C::IntoBack | C::Over | C::OverBack | C::Out | C::OutBack => self.step(command),
            C::NextUnit | C::PreviousUnit | C::Start | C::End => self.step(command),
        }
    }

    fn step(&mut self, command: Command) {
        use Command as C;
        self.player.pause();
        let rungs = self.rungs();
        let (rung, way) = match command {
            C::Into => (rungs.event(), Way::Forward),
            C::IntoBack => (rungs.event(), Way::Back),
            C::Over | C::NextUnit => (rungs.unit(), Way::Forward),
            C::OverBack | C::PreviousUnit => (rungs.unit(), Way::Back),
            C::Out => (rungs.group(), Way::Forward),
            C::OutBack => (rungs.group(), Way::Back),
            C::Start => return self.walker.go(Move::To(Cursor::default())),
            _ => return self.walker.go(Move::End),
        };
        self.walker.go(Move::Rung(rung, way));
    }

    fn edit(&mut self, command: Command) {
        match command {
            Command::Undo => drop(self.document.undo()),
            Command::Redo => drop(self.document.redo()),
            _ => self.document.reset(Owner::Estimator),
        }
        self.restart();
    }

    fn look_at(&mut self, command: Command) {
        let stage = &mut self.states.stage;
        match command {
            Command::FrameT => stage.view = Pictures::Current,
            Command::FrameNext => stage.view = Pictures::Next,
            Command::Difference => stage.view = Pictures::Difference,
            Command::Blend => stage.view = Pictures::Blend,
            Command::Blink => stage.view = Pictures::Blink,
            Command::Fit => stage.fit(),
            Command::ActualSize => stage.one_to_one(self.ctx.pixels_per_point()),
            _ => stage.view = Pictures::SideBySide,
        }
    }

    fn restyle(&mut self, command: Command) {
        let (_, _, step) = ZOOM;
        let zoom = self.settings.zoom();
        match command {
            Command::LargerInterface => self.settings.set_zoom(zoom + step),
            Command::SmallerInterface => self.settings.set_zoom(zoom - step),
            Command::NormalInterface => self.settings.set_zoom(1.0),
            _ => self.settings.set_theme(self.settings.next_theme()),
        }
    }

    fn arrange(&mut self, command: Command) {
        let folded = &mut self.settings.folded;
        let toggled = match command {
            Command::ShowParameters => &mut folded.parameters,
            Command::ShowWhy => &mut folded.why,
            Command::ShowCharts => &mut folded.charts,
            Command::Lecture => &mut folded.lecture,
            _ => {
                *folded = layout::Folded::default();
                self.settings.tree = layout::tree();
                return;
            }
        };
        *toggled = !*toggled;
    }

    fn choose(&mut self, id: &str) {
        match estimator(id) {
            Ok(chosen) => {
                self.document.choose(chosen);
                self.restart();
            }
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    fn go_to_frame(&mut self, frame: usize) {
        if self.document.go_to_frame(frame) {
            self.restart();
        }
    }

    /// Runs again with what is set now, at the place that is shown.
    fn restart(&mut self) {
        if let Some(job) = self.document.job(self.view.shown.as_deref()) {
            self.walker.start(job);
        }
    }

    /// Opens a file or folder on another thread.
    pub fn open(&mut self, path: PathBuf) {
        self.player.pause();
        self.error = None;
        let ctx = self.ctx.clone();
        self.loading = Some(Loading::new(&path, move || ctx.request_repaint()));
    }

    /// Opens a bundled sample in the middle of a search, so that there is something to see.
    pub fn open_sample(&mut self, sample: &'static Sample) {
        self.player.pause();
        self.loading = None;
        if let Err(error) = self.document.open_sample(sample) {
            self.error = Some(error);
            return;
        }
        self.begin();
        let Some(mut job) = self.document.job(None) else { return };
        let (width, height) = job.clip.size();
        job.cursor = Cursor { unit: 0, event: FIRST_LOOK };
        job.near = Some([width as f32 * 0.5, height as f32 * 0.5]);
        self.walker.start(job);
    }

    pub(super) fn opened(&mut self, clip: Clip, path: PathBuf) {
        self.settings.remember(&path);
        self.document.open(clip, Origin::File(path));
        self.begin();
        if let Some(job) = self.document.job(None) {
            self.walker.start(job);
        }
    }

    fn not_opened(&mut self, path: &Path, error: Error) {
        if !path.exists() {
            self.settings.forget(path);
        }
        self.error = Some(error);
    }

    /// Another clip is open.
    fn begin(&mut self) {
        self.error = None;
        self.states.stage.fit();
        self.ctx.send_viewport_cmd(ViewportCommand::Title(title(&self.document)));
    }

    /// Asks the system for a path, off the window's thread.
    fn browse(&mut self, folder: bool) {
        let (sender, receiver) = channel();
        let ctx: egui::Context = self.ctx.clone();
        let ask = move || {
            let begun = Instant::now();
            let dialog = rfd::FileDialog::new().set_title("Open a clip or a session");
            let path = if folder { dialog.pick_folder() } else { dialog.pick_file() };
            // Nobody cancels that fast: there was no dialog. Hanging up says so.
            if path.is_some() || begun.elapsed().as_millis() > 150 {
                // The window may have closed meanwhile.
                sender.send(path).ok();
            }
            drop(sender);
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("dialog".into()).spawn(ask) {
            Ok(_) => self.browsing = Some(receiver),
            Err(error) => self.toasts.fail(format!("The file dialog could not be started: {error}. Type the path.")),
        }
    }
}

/// Events that are seen of the first unit shown of a sample.
const FIRST_LOOK: usize = 640;
