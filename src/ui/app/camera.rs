//! Recordings of a camera: opening, keeping and saving them.

use std::path::PathBuf;
use std::sync::Arc;

use motionscope_core::Error;

use crate::experiment::source::Source;
use crate::media::camera::{Cameras, Ffmpeg, Kept, is_unsaved};
use crate::ui::app::commands::Command;
use crate::ui::app::window::{App, Overlay};
use crate::ui::dialogs::camera::State;
use crate::ui::model::live::LiveView;
use crate::ui::model::settings::LeftAt;

/// The cameras, and what was recorded last.
pub(super) struct Recorder {
    cameras: Arc<dyn Cameras>,
    /// The last recording, whose file lasts as long as it is not replaced.
    last: Option<Arc<Kept>>,
    /// Number of recordings.
    count: usize,
    /// Where the recording that is open is being saved.
    pub(super) saved: Option<PathBuf>,
}

impl Default for Recorder {
    fn default() -> Self {
        Self { cameras: Arc::new(Ffmpeg::default()), last: None, count: 0, saved: None }
    }
}

impl App {
    /// Takes other cameras in the place of those of ffmpeg, for tests.
    pub fn use_cameras(&mut self, cameras: Arc<dyn Cameras>) {
        self.recorder.cameras = cameras;
    }

    /// What the camera shows, if it is open.
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
        if let Some(id) = id.filter(|id| *id != self.document.estimator().info().id) {
            self.choose(id);
        }
        let rate = kept.rate().map_or_else(String::new, |rate| format!(" at {rate:.1} frames/s"));
        let early = ended.map_or_else(String::new, |error| format!(" The camera has ended: {error}."));
        let (key, name) = (Command::SaveClip.key(), kept.path().to_owned());
        let said = format!("{} frames{rate}, not saved yet: {key} saves the clip.{early}", kept.frames());
        self.load(name.into());
        if let Some(loading) = &mut self.loading {
            loading.description = Some(said);
        }
        self.recorder.count += 1;
        self.recorder.last = Some(kept);
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

    /// Goes on with the file in which the recording was saved.
    pub(super) fn clip_saved(&mut self) {
        let Some(path) = self.recorder.saved.take() else { return };
        if let Some(shown) = self.view.shown.as_deref().filter(|_| self.is_unsaved()) {
            let clip = std::path::absolute(&path).unwrap_or_else(|_| path.clone());
            let (frame, step) = (shown.subject.experiment.frame, shown.cursor.to_string());
            let run = super::files::run_of(&*shown.subject.experiment.estimator);
            self.settings.leave(LeftAt { clip: clip.display().to_string(), run, frame, step });
            self.load(path.into());
        }
    }
}
