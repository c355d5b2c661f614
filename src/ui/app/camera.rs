//! Recordings of a camera: opening, keeping and saving them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::{Error, estimator};

use crate::experiment::Prepared;
use crate::experiment::source::Source;
use crate::media::camera::{Cameras, Ffmpeg, Kept, is_unsaved};
use crate::paint::Freehand;
use crate::ui::app::commands::Command;
use crate::ui::app::window::{App, Overlay};
use crate::ui::dialogs::camera::State;
use crate::ui::model::live::LiveView;
use crate::ui::model::settings::LeftAt;

/// The cameras, and the last recording.
pub(super) struct Recorder {
    cameras: Arc<dyn Cameras>,
    /// The last recording that was opened, whose file lasts as long as it is not replaced.
    pub(super) last: Option<Arc<Kept>>,
    /// The recording that is being opened, and the estimator that it opens with.
    opening: Option<(Arc<Kept>, Option<&'static str>)>,
    /// Number of recordings.
    count: usize,
    /// The recording that is being saved.
    pub(super) saving: Option<Saving>,
    /// The file in which a recording was saved, and the ink of its run.
    ink: Option<(PathBuf, Freehand)>,
}

/// A recording that is being saved.
pub(super) struct Saving {
    /// Its temporary file.
    from: PathBuf,
    /// The file or folder in which it is saved.
    to: PathBuf,
}

impl Saving {
    /// The saving of the clip of `subject` to `to`, if that is a recording that was not saved.
    pub(super) fn of(subject: &Prepared, to: &Path) -> Option<Self> {
        match &subject.experiment.source {
            Source::File(from) if is_unsaved(from) => Some(Self { from: from.clone(), to: to.to_owned() }),
            _ => None,
        }
    }
}

impl Default for Recorder {
    fn default() -> Self {
        Self { cameras: Arc::new(Ffmpeg::default()), last: None, opening: None, count: 0, saving: None, ink: None }
    }
}

impl App {
    /// Uses other cameras than those of ffmpeg, for tests.
    pub fn use_cameras(&mut self, cameras: Arc<dyn Cameras>) {
        self.recorder.cameras = cameras;
    }

    /// The state of the camera, if it is open.
    pub fn live(&self) -> Option<LiveView> {
        match &self.overlay {
            Overlay::Camera(state) => state.view(),
            _ => None,
        }
    }

    /// Shows the camera.
    pub(super) fn open_camera(&mut self) {
        self.player.pause();
        let name = format!("camera-{}", self.recorder.count + 1);
        let last = self.recorder.last.as_ref().map(|kept| kept.path().to_owned());
        let state = State::new(Arc::clone(&self.recorder.cameras), name, last, &self.ctx);
        self.overlay = Overlay::Camera(Box::new(state));
    }

    /// Opens a recording with the estimator `id`, or with the present one.
    pub(super) fn open_recording(&mut self, kept: Arc<Kept>, id: Option<&'static str>, ended: Option<Error>) {
        let rate = kept.rate().map_or_else(String::new, |rate| format!(" at {rate:.1} frames/s"));
        let early = ended.map_or_else(String::new, |error| format!(" The camera has ended: {error}."));
        let (key, name) = (Command::SaveClip.key(), kept.path().to_owned());
        let said = format!("{} frames{rate}, not saved yet: {key} saves the clip.{early}", kept.frames());
        self.load(name.into());
        if let Some(loading) = &mut self.loading {
            loading.description = Some(said);
        }
        self.recorder.count += 1;
        self.recorder.opening = Some((kept, id));
    }

    /// Takes the estimator of the recording at `path`, which has been opened; no run has begun on it.
    pub(super) fn recording_opened(&mut self, path: &Path) {
        let is_it = |(kept, _): &mut (Arc<Kept>, Option<&'static str>)| kept.path() == path;
        let Some((kept, id)) = self.recorder.opening.take_if(is_it) else { return };
        self.recorder.last = Some(kept);
        let now = self.document.estimator().info();
        let Some(chosen) = id.filter(|id| *id != now.id).and_then(|id| estimator(id).ok()) else { return };
        let was_single = self.shows_frame_alone();
        // Layers belong to a family.
        if now.family != chosen.info().family {
            self.settings.look.layer = None;
        }
        self.document.choose(chosen);
        self.suit_view(was_single);
    }

    /// Whether the clip that is open is a recording that was not saved.
    pub(super) fn is_unsaved(&self) -> bool {
        matches!(self.document.source(), Some(Source::File(path)) if is_unsaved(path))
    }

    /// Says that nothing can refer to the recording yet.
    pub(super) fn refuse_unsaved(&mut self) {
        let key = Command::SaveClip.key();
        self.toasts.fail(format!(
            "This recording is not saved yet, so nothing can refer to it. Save the clip first ({key}), then try again."
        ));
    }

    /// Opens the file in which the recording was saved, if that recording is still open and no other clip is being opened.
    pub(super) fn clip_saved(&mut self) {
        let Some(Saving { from, to: path }) = self.recorder.saving.take() else { return };
        let is_open = matches!(self.document.source(), Some(Source::File(open)) if *open == from);
        if let Some(shown) = self.view.shown.as_deref().filter(|_| is_open && self.loading.is_none()) {
            self.recorder.ink = Some((path.clone(), self.presentation.pen.freehand(&shown.subject)));
            let clip = std::path::absolute(&path).unwrap_or_else(|_| path.clone());
            let (frame, step) = (shown.subject.experiment.frame, shown.cursor.to_string());
            let run = super::files::run_of(&*shown.subject.experiment.estimator);
            self.settings.leave(LeftAt { clip: clip.display().to_string(), run, frame, step });
            self.load(path.into());
        }
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
