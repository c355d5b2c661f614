//! Recordings of a camera: opening, keeping and saving them.
//!
//! A recording is a Y4M file in a temporary folder, opened like any other clip; nothing may refer to it before it is saved, and
//! a request to quit is held once until then.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::ViewportCommand;
use motionscope_core::base::Error;
use motionscope_core::course::estimator;

use super::App;
use super::dialogs::Overlay;
use crate::experiment::Prepared;
use crate::experiment::source::Source;
use crate::files;
use crate::media::camera::{Cameras, Closing, Kept, cameras, is_unsaved};
use crate::paint::Freehand;
use crate::ui::commands::{ClipFormat, Command};
use crate::ui::dialogs::camera::State;
use crate::ui::model::live::LiveView;
use crate::ui::model::settings::LeftAt;

/// The cameras, and the last recording.
pub(super) struct Recorder {
    cameras: Arc<dyn Cameras>,
    /// The cameras that have not ended, whichever dialog opened them.
    closing: Closing,
    /// The last recording that was opened, whose file lasts as long as it is not replaced.
    pub(super) last: Option<Arc<Kept>>,
    /// How the last recording was saved.
    saved: Saved,
    /// The recording that is being opened, and the estimator that it opens with.
    opening: Option<(Arc<Kept>, Option<&'static str>)>,
    /// Number of recordings.
    count: usize,
    /// The recording that is being saved.
    pub(super) saving: Option<Saving>,
    /// The file in which a recording was saved, and the ink of its run.
    ink: Option<(PathBuf, Freehand)>,
}

/// How a recording was saved, and the name of its file or folder.
#[derive(Default)]
enum Saved {
    /// Not yet.
    #[default]
    Nowhere,
    /// As compressed video only: its frames as they came are in its temporary file alone.
    WithLoss(String),
    /// With all frames as they came.
    Whole(String),
}

impl Saved {
    /// What is said beside the number of frames of a recording that is open.
    fn told(&self) -> String {
        let key = Command::SaveClip.key();
        match self {
            Self::Nowhere => format!("not saved yet: {key} saves the clip."),
            Self::WithLoss(name) => {
                format!("saved only with loss, as {name}: {key} saves the clip without loss, as Y4M or numbered PNG.")
            }
            Self::Whole(name) => format!("saved as {name}."),
        }
    }

    /// Why nothing can refer to the recording, and what to do.
    fn refusal(&self) -> String {
        let key = Command::SaveClip.key();
        match self {
            Self::Nowhere => format!(
                "This recording is not saved yet, so nothing can refer to it. Save the clip first ({key}), then try \
                 again."
            ),
            Self::WithLoss(name) => format!(
                "This recording is saved only with loss, as {name}, so nothing can refer to its frames. \
                 Save the clip without loss first ({key}), then try again."
            ),
            Self::Whole(name) => {
                format!("This file of the recording is temporary, so nothing can refer to it. Open {name} first.")
            }
        }
    }
}

/// A recording that is being saved.
pub(super) struct Saving {
    /// Its temporary file.
    from: PathBuf,
    /// The file or folder in which it is saved.
    to: PathBuf,
    /// Whether the frames are saved as they came.
    is_lossless: bool,
}

impl Saving {
    /// The saving of the clip of `subject` to `to` as `format`, if that is a recording that was not saved.
    pub(super) fn of(subject: &Prepared, to: &Path, format: ClipFormat) -> Option<Self> {
        let Source::File(from) = &subject.experiment.source else { return None };
        let is_lossless = format.is_lossless();
        is_unsaved(from).then(|| Self { from: from.clone(), to: to.to_owned(), is_lossless })
    }
}

impl Default for Recorder {
    fn default() -> Self {
        Self {
            cameras: cameras(),
            closing: Closing::default(),
            last: None,
            saved: Saved::default(),
            opening: None,
            count: 0,
            saving: None,
            ink: None,
        }
    }
}

impl App {
    /// Uses other cameras than those of this computer, for tests.
    pub fn use_cameras(&mut self, cameras: Arc<dyn Cameras>) {
        self.recorder.cameras = cameras;
    }

    /// The state of the camera, if it is open.
    pub fn live(&self) -> Option<LiveView> {
        match &self.dialogs.overlay {
            Overlay::Camera(state) => state.view(),
            _ => None,
        }
    }

    /// Shows the camera.
    pub(super) fn open_camera(&mut self) {
        self.run.player.pause();
        let name = format!("camera-{}", self.recorder.count + 1);
        let last = self.recorder.last.as_ref().map(|kept| kept.path().to_owned());
        let cameras = (Arc::clone(&self.recorder.cameras), self.recorder.closing.clone());
        let state = State::new(cameras, (name, last), self.settings.camera.clone(), &self.ctx);
        self.dialogs.overlay = Overlay::Camera(Box::new(state));
    }

    /// Opens a recording with the estimator `id`, or with the present one.
    pub(super) fn open_recording(&mut self, kept: Arc<Kept>, id: Option<&'static str>, ended: Option<Error>) {
        let rate = kept.rate().map_or_else(String::new, |rate| format!(" at {rate:.1} frames/s"));
        let early = ended.map_or_else(String::new, |error| format!(" The camera has ended: {error}."));
        // The last recording may be opened again after it was saved.
        let is_last = self.recorder.last.as_ref().is_some_and(|last| last.path() == kept.path());
        let told = if is_last { self.recorder.saved.told() } else { Saved::default().told() };
        let said = format!("{} frames{rate}, {told}{early}", kept.frames());
        self.load(kept.path().into());
        if let Some(loading) = &mut self.opening.loading {
            loading.description = Some(said);
        }
        self.recorder.count += 1;
        self.recorder.opening = Some((kept, id));
    }

    /// Takes the estimator of the recording at `path`, which has been opened; no run has begun on it.
    pub(super) fn recording_opened(&mut self, path: &Path) {
        let is_it = |(kept, _): &mut (Arc<Kept>, Option<&'static str>)| kept.path() == path;
        let Some((kept, id)) = self.recorder.opening.take_if(is_it) else { return };
        if self.recorder.last.as_ref().is_none_or(|last| last.path() != kept.path()) {
            self.recorder.saved = Saved::default();
        }
        self.recorder.last = Some(kept);
        let now = self.run.document.estimator().info();
        let Some(chosen) = id.filter(|id| *id != now.id).and_then(|id| estimator(id).ok()) else { return };
        let was_single = self.run.shows_frame_alone();
        // Layers belong to a family.
        if now.family != chosen.info().family {
            self.settings.look.layer = None;
        }
        self.run.document.choose(chosen);
        self.suit_view(was_single);
    }

    /// Whether the clip that is open is a recording that was not saved.
    pub(super) fn is_unsaved(&self) -> bool {
        matches!(self.run.document.source(), Some(Source::File(path)) if is_unsaved(path))
    }

    /// Says that nothing can refer to the recording yet, until it is saved or another clip is open.
    pub(super) fn refuse_unsaved(&mut self) {
        let why = self.recorder.saved.refusal();
        self.toasts.describe(Some(why));
    }

    /// Notes how the recording was saved. A file with loss is a copy, and the recording stays open as it came; one without loss is
    /// opened in its place, if that recording is still open and no other clip is being opened.
    pub(super) fn clip_saved(&mut self) {
        let Some(Saving { from, to: path, is_lossless }) = self.recorder.saving.take() else { return };
        let is_open = matches!(self.run.document.source(), Some(Source::File(open)) if *open == from);
        // A page has handed the file over to the browser.
        let is_replaced = is_lossless && files::exists(&path);
        if let Some(frames) = self.recorder.last.as_ref().filter(|last| last.path() == from).map(|last| last.frames()) {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
            self.recorder.saved = match std::mem::take(&mut self.recorder.saved) {
                _ if is_lossless => Saved::Whole(name),
                Saved::Whole(whole) => Saved::Whole(whole),
                _ => Saved::WithLoss(name),
            };
            if is_open && !is_replaced {
                let told = format!("{frames} frames, {}", self.recorder.saved.told());
                self.toasts.describe(Some(told));
            }
        }
        if let Some(shown) =
            self.run.view.shown.as_deref().filter(|_| is_replaced && is_open && self.opening.loading.is_none())
        {
            self.recorder.ink = Some((path.clone(), self.presentation.pen.freehand(&shown.subject)));
            let clip = files::absolute(&path);
            let (frame, step) = (shown.subject.experiment.frame, shown.cursor.to_string());
            let run = LeftAt::run_of(&*shown.subject.experiment.estimator);
            self.settings.leave(LeftAt { clip: clip.display().to_string(), run, frame, step });
            self.load(path.into());
        }
    }

    /// Holds a request to quit as long as frames would be lost with it, and says so; the next request quits.
    pub(super) fn hold_quit(&mut self) {
        if !self.ctx.input(|input| input.viewport().close_requested()) {
            return;
        }
        let Some(said) = self.would_be_lost().filter(|said| self.toasts.last() != Some(said.as_str())) else { return };
        self.toasts.fail(said);
        self.ctx.send_viewport_cmd(ViewportCommand::CancelClose);
    }

    /// What would be lost by quitting now, and how it is kept; `None` if nothing would be.
    fn would_be_lost(&self) -> Option<String> {
        let last = self.recorder.last.as_ref()?;
        let name = last.path().file_stem().unwrap_or_default().to_string_lossy();
        let lost = match &self.recorder.saved {
            Saved::Nowhere => format!("The recording {name} is not saved: quitting deletes it."),
            Saved::WithLoss(copy) => format!(
                "The recording {name} is saved only with loss, as {copy}: quitting deletes its frames as they came."
            ),
            Saved::Whole(_) => return None,
        };
        let is_open = matches!(self.run.document.source(), Some(Source::File(open)) if open == last.path());
        let first = if is_open {
            String::new()
        } else {
            format!("open it by Last recording in the camera dialog ({}), then ", Command::Camera.key())
        };
        let key = Command::SaveClip.key();
        Some(format!("{lost} To keep them, {first}save the clip without loss ({key}). Quit again to discard them."))
    }

    /// Whether `path` is the file in which the recording was saved that is open, so that it goes on as it was.
    pub(super) fn is_saved_recording(&self, path: &Path) -> bool {
        self.recorder.ink.as_ref().is_some_and(|(saved, _)| saved == path)
    }

    /// Takes the ink of a recording over to the run of `subject`, if that is the clip in which it was saved.
    pub(super) fn take_ink(&mut self, subject: &Arc<Prepared>) {
        let source = &subject.experiment.source;
        let is_it = |(path, _): &mut (PathBuf, Freehand)| matches!(source, Source::File(open) if *open == *path);
        if let Some((_, freehand)) = self.recorder.ink.take_if(is_it) {
            self.restore_ink(subject, freehand);
        }
    }
}
