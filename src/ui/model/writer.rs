//! Writes pictures, vectors and sessions on a thread of its own, with progress and cancel.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use motionscope_core::{Cursor, Error, Output};

use super::background::Background;
use super::snapshot::{Snapshot, Subject};
use crate::media::Progress;
use crate::media::export::{self, FlowFormat, TrackFormat};
use crate::pixel::Chosen;
use crate::shot::{Format, Look, Moment, Steps};

/// How often writing that waits for the run asks whether it was cancelled.
const POLL: Duration = Duration::from_millis(50);

/// What to write.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// The step that is shown.
    Picture,
    /// Steps from one cursor to another, at the stops of a rung.
    Steps {
        /// The first.
        from: Cursor,
        /// The last.
        to: Cursor,
        /// The rung.
        rung: usize,
        /// What they are written as.
        format: Format,
    },
    /// The vectors or objects found so far.
    Vectors,
    /// The mask of each frame so far.
    Masks,
    /// Everything that reopens the window as it is.
    Session,
}

/// What to write, where, and how it looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// What.
    pub what: What,
    /// The file, or the folder for several.
    pub path: PathBuf,
    /// Pixels for each pixel of the clip.
    pub scale: u32,
    /// How it looks.
    pub look: Look,
}

/// Something that is being written.
pub struct Writing {
    /// The folder that it is written into.
    pub folder: Option<PathBuf>,
    /// The work; it says what it wrote.
    pub work: Background<String>,
}

impl Writing {
    /// Has `write` write on a thread of its own and say what it wrote.
    pub fn new(
        folder: Option<PathBuf>,
        changed: impl Fn() + Send + Sync + 'static,
        write: impl FnOnce(&dyn Progress) -> Result<String, Error> + Send + 'static,
    ) -> Self {
        Self { folder, work: Background::new("write", changed, move |desk| write(&**desk)) }
    }
}

/// Writes the picture of a step; says what was written.
///
/// # Errors
/// If the ending is neither `.png` nor `.svg`, the picture is too large, or the file cannot be written.
pub fn picture(order: &Order, shown: &Snapshot) -> Result<String, Error> {
    let format = Format::of(&order.path)?;
    let moment = Moment {
        estimator: shown.subject.estimator.as_ref(),
        frame: shown.frame,
        cursor: shown.cursor,
        at_end: shown.at_end,
        step: &shown.step,
        scene: &shown.scene,
        pictures: &shown.pictures,
        tiles: &shown.tiles,
    };
    export::save(&order.path, &moment.encode(&order.look, format, order.scale)?)?;
    Ok(format!("Wrote {}.", order.path.display()))
}

/// Writes the pictures of several steps; says what was written.
///
/// # Errors
/// As [`Steps::write`].
pub fn steps(order: &Order, shown: &Snapshot, progress: &dyn Progress) -> Result<String, Error> {
    let What::Steps { from, to, rung, format } = order.what else { return picture(order, shown) };
    let pixel = shown.held().map(Chosen::Held);
    let steps = Steps { from, to, rung, format, scale: order.scale, look: order.look, pixel };
    let Subject { clip, estimator, company, frame, .. } = &*shown.subject;
    let count = steps.write((estimator.as_ref(), company), clip, *frame, &order.path, Some(progress))?;
    let plural = if count == 1 { "" } else { "s" };
    Ok(format!("Wrote {count} picture{plural} into {}.", order.path.display()))
}

/// Writes vectors or objects in the format that the file's ending asks for, as soon as they come; says what was written.
///
/// # Errors
/// If none come, there is no such format, the file cannot be written, or the work was cancelled.
pub fn vectors(path: &Path, output: &Receiver<Output>, progress: &dyn Progress) -> Result<String, Error> {
    let output = come(output, progress)?;
    let is_table = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    let (bytes, lost) = match &output {
        _ if is_table => (export::csv(&output).into_bytes(), None),
        Output::Objects(field) => (TrackFormat::of(path)?.encode(field)?, None),
        _ => FlowFormat::of(path)?.encode(&export::flow(&output)?)?,
    };
    export::save(path, &bytes)?;
    let lost = lost.map_or_else(String::new, |lost| format!(" {lost}."));
    Ok(format!("Wrote {}.{lost}", path.display()))
}

/// Writes the mask of each frame into a folder as soon as they come; says what was written.
///
/// # Errors
/// If there are none, one cannot be written, or the work was cancelled.
pub fn masks(folder: &Path, output: &Receiver<Output>, progress: &dyn Progress) -> Result<String, Error> {
    let output = come(output, progress)?;
    let field =
        output.objects().ok_or_else(|| Error::new("this estimator makes no masks; choose a background model"))?;
    let count = export::write_masks(folder, &export::masks(field)?)?;
    Ok(format!("Wrote {count} into {}.", folder.display()))
}

fn come(output: &Receiver<Output>, progress: &dyn Progress) -> Result<Output, Error> {
    loop {
        if progress.cancelled() {
            return Err(Error::new("writing was cancelled"));
        }
        match output.recv_timeout(POLL) {
            Ok(output) => return Ok(output),
            Err(RecvTimeoutError::Timeout) => {}
            Err(_) => return Err(Error::new("the run went on meanwhile; stop it and write again")),
        }
    }
}
