//! Saving pictures, results, clips and sessions.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::base::Error;

use super::App;
use super::camera::Saving;
use super::dialogs::Overlay;
use crate::experiment::Position;
use crate::experiment::source::Source;
use crate::files::{self, download};
use crate::media::camera::is_unsaved;
use crate::media::export;
use crate::session::{Session, VisiblePart};
use crate::ui::commands::{Order, OutputKind};
use crate::ui::dialogs::save::{self, Kind};
use crate::ui::model::paper;
use crate::ui::model::predict::Score;
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::writer::{self, Work, Writing};
use crate::ui::stage::{Lens, Zoom};

/// The running export, and the folder of the last one.
#[derive(Default)]
pub(super) struct Exports {
    /// The file that is being written on another thread.
    pub writing: Option<Writing>,
    /// Where was written last.
    pub folder: Option<PathBuf>,
}

impl Exports {
    /// Share of what is being written that is done, from 0 to 1.
    pub fn fraction(&self) -> Option<f32> {
        self.writing.as_ref().map(|writing| writing.work.fraction())
    }

    /// Cancels the export.
    pub fn cancel(&self) {
        self.writing.iter().for_each(|writing| writing.work.cancel());
    }

    /// The outcome of an export.
    fn written(&mut self) -> Option<Result<String, Error>> {
        let outcome = self.writing.as_ref()?.work.take()?;
        let folder = self.writing.take().and_then(|writing| writing.folder);
        if outcome.is_ok() {
            // Only where writing went well is the next file offered beside it.
            self.folder = folder;
        }
        Some(outcome)
    }
}

impl App {
    /// Reports the outcome of the export, once it is done.
    pub(super) fn receive_written(&mut self) {
        match self.exports.written() {
            None => {}
            Some(Ok(text)) => {
                self.clip_saved();
                self.toasts.tell(text);
            }
            Some(Err(error)) => self.toasts.fail(format!("Not saved: {error}.")),
        }
    }

    /// Opens the dialog that saves `kind`.
    pub(super) fn save_as(&mut self, kind: Kind) {
        // The file has the step that is shown, so the run waits while the dialog is open.
        self.run.player.pause();
        let Some(shown) = self.run.view.shown.as_deref() else { return };
        if kind == Kind::Session && self.run.document.has_own_clip() {
            let why = "This stage works on pictures that its parent computes, which a session cannot store.";
            self.toasts.fail(format!("{why} Close the stage (Shift+I), then save."));
            return;
        }
        if kind == Kind::Session && self.is_unsaved() {
            return self.refuse_unsaved();
        }
        let name = self.run.document.clip().map_or_else(String::new, |clip| clip.info().name.clone());
        let beside = match self.run.document.source() {
            Some(Source::File(path) | Source::Pair([path, _])) if !is_unsaved(path) => {
                path.parent().map(Path::to_owned)
            }
            _ => None,
        };
        let folder = self.exports.folder.clone().or(beside).unwrap_or_else(files::current_dir);
        // Results among the frames would become frames, or could not be told from them.
        let folder = shown.subject.inputs.outside(&folder);
        let seen = save::Seen { look: self.settings.look, angles: self.panes.states.angles(&shown.step) };
        // A handout is named after its lesson.
        let lesson = self.course.lesson.as_ref().filter(|_| kind == Kind::Handout);
        let name = lesson.map_or(name, |open| open.lesson().slug.clone());
        let state = save::State::new(kind, &folder, &save::stem(&name), shown, seen);
        self.dialogs.overlay = Overlay::Save(Box::new(state));
    }

    /// Has a task save and report the outcome.
    pub fn write(&mut self, order: Order) {
        let Some(shown) = self.inked() else { return };
        if self.exports.writing.is_some() {
            self.toasts.fail("Another file is still being saved. Wait or cancel it, then save again.");
            return;
        }
        let folder = order.path.parent().map(Path::to_owned);
        let ctx = self.ctx.clone();
        let changed = move || ctx.request_repaint();
        let inputs = Arc::clone(&shown.subject.inputs);
        self.recorder.saving = None;
        // Its file is not removed while it is read.
        let kept = self.recorder.last.clone();
        let work: Work = match order.what {
            OutputKind::Picture => Box::new(move |order, _| Box::pin(async move { writer::picture(order, &shown) })),
            OutputKind::Steps(..) | OutputKind::Animation(..) => {
                let freehand = self.presentation.pen.freehand(&shown.subject);
                Box::new(move |order, progress| {
                    Box::pin(async move { writer::steps(order, (&shown, freehand), progress).await })
                })
            }
            OutputKind::Clip(format) => {
                self.recorder.saving = Saving::of(&shown.subject, &order.path, format);
                Box::new(move |order, progress| Box::pin(async move { writer::clip(order, &shown, progress).await }))
            }
            OutputKind::Handout(_) => {
                let Some(lesson) = self.course.lesson.as_ref().map(|open| open.lesson().clone()) else { return };
                Box::new(move |order, progress| Box::pin(async move { paper::handout(order, &lesson, progress).await }))
            }
            OutputKind::Worksheet { .. } => {
                let page = self.course.printed_page(&shown);
                Box::new(move |order, progress| {
                    Box::pin(async move { paper::worksheet(order, &shown, page.as_ref(), progress).await })
                })
            }
            OutputKind::Session => {
                let session = self.session(&shown);
                Box::new(move |order, _| Box::pin(async move { save_session(&session, &order.path) }))
            }
            OutputKind::Scores => {
                let scores = Score::csv(self.run.predict.scores());
                Box::new(move |order, _| {
                    Box::pin(async move {
                        export::save_result(&order.path, scores.as_bytes())?;
                        Ok(format!("Saved {}.", files::label(&order.path)))
                    })
                })
            }
            OutputKind::Result(export) => {
                let output = self.run.walker.output(&shown);
                Box::new(move |order, progress| {
                    Box::pin(async move { writer::result(&order.path, export, &output, progress).await })
                })
            }
        };
        self.exports.writing = Some(Writing::new(folder, changed, async move |progress| {
            let _kept = kept;
            let saved = match writer::refuse_losses(&order, &inputs) {
                Ok(()) => work(&order, progress).await,
                Err(error) => Err(error),
            };
            download::hand_over(&order.path, saved)
        }));
    }

    pub(super) fn session(&self, shown: &Snapshot) -> Session {
        let stage = &self.panes.states.stage;
        let chosen = stage.chosen().filter(|_| stage.zoom != Zoom::Fit);
        let part = |lens: Lens| VisiblePart { center: lens.center.into(), zoom: lens.scale, size: Some(lens.extent()) };
        let sight = chosen.map(part);
        let whole = |path: &Path| files::absolute(path);
        let mut experiment = shown.subject.experiment.clone();
        experiment.source = experiment.source.map_path(whole);
        experiment.given = experiment.given.map_path(whole);
        let position = Position { cursor: Some(shown.cursor), held: shown.held() };
        let freehand = self.presentation.pen.freehand(&shown.subject);
        Session { experiment, position, look: self.settings.look.into(), sight, freehand }
    }
}

fn save_session(session: &Session, path: &Path) -> Result<String, Error> {
    let path = files::absolute(path);
    session.save(&path)?;
    Ok(format!("Saved {}.", files::label(&path)))
}
