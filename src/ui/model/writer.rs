//! Writes pictures, vectors and sessions as a task, with progress and cancel.

use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::Duration;

use motionscope_core::base::Error;
use motionscope_core::products::Output;

use super::background::Background;
use super::snapshot::Snapshot;
use crate::experiment::Prepared;
use crate::experiment::pixel::Chosen;
use crate::experiment::source::Source;
use crate::files;
use crate::media::Progress;
use crate::media::export::{self, Inputs};
use crate::paint::Freehand;
use crate::results::Export;
use crate::ui::commands::{ClipFormat, Order, OutputKind};
use crate::view::rendering::{Format, Rendering};
use crate::view::steps::{Medium, Steps};
use crate::work;

/// How often writing that waits for the run asks whether it was cancelled.
const POLL: Duration = Duration::from_millis(50);

/// Refuses to write over `inputs`, or among the frames of the clip. The session that was opened is there to be saved again.
///
/// # Errors
/// One sentence that names the file.
pub fn refuse_losses(order: &Order, inputs: &Inputs) -> Result<(), Error> {
    let inputs =
        if order.what == OutputKind::Session { &inputs.clone().without(export::InputKind::Session) } else { inputs };
    let target = order.what.target(&order.path);
    export::check(inputs, &[target]).map_err(|conflict| {
        let name = order.path.file_name().unwrap_or(order.path.as_os_str()).to_string_lossy();
        Error::new(format!("{name} {}; choose {}", conflict.why, target.other()))
    })
}

/// What writes an order, and says what it wrote.
pub type Work = Box<dyn for<'a> FnOnce(&'a Order, &'a dyn Progress) -> WriteFuture<'a> + Send>;

/// The work of writing, which ends with the sentence to show.
pub type WriteFuture<'a> = Pin<Box<dyn Future<Output = Result<String, Error>> + 'a>>;

/// Something that is being written.
pub struct Writing {
    /// The folder that it is written into.
    pub folder: Option<PathBuf>,
    /// The work; it says what it wrote.
    pub work: Background<String>,
}

impl Writing {
    /// Has `write` write and say what it wrote.
    pub fn new(
        folder: Option<PathBuf>,
        changed: impl Fn() + Send + Sync + 'static,
        write: impl AsyncFnOnce(&dyn Progress) -> Result<String, Error> + Send + 'static,
    ) -> Self {
        Self { folder, work: Background::new("write", changed, async move |control| write(&**control).await) }
    }
}

/// Writes the picture of a step; says what was written.
///
/// # Errors
/// If the ending is none of `.png`, `.svg` and `.pdf`, the picture is too large, or the file cannot be written.
pub fn picture(order: &Order, shown: &Snapshot) -> Result<String, Error> {
    let format = Format::of(&order.path)?;
    let estimator = &*shown.subject.experiment.estimator;
    let rendering = Rendering { moment: &shown.moment, estimator, look: &order.look, panes: &order.panes };
    export::save_result(&order.path, &rendering.encode(format, order.scale)?)?;
    Ok(format!("Saved {}.", files::label(&order.path)))
}

/// Writes several steps, as pictures or as an animation, with what was drawn by hand in the run; says what was written.
///
/// # Errors
/// As [`Steps::write`].
pub async fn steps(
    order: &Order,
    (shown, freehand): (&Snapshot, Freehand),
    progress: &dyn Progress,
) -> Result<String, Error> {
    let path = &*order.path;
    let (range, medium) = match order.what {
        OutputKind::Steps(range, format) => (range, Medium::Pictures(path, format)),
        OutputKind::Animation(range, timing) => (range, Medium::Animation(path, timing)),
        _ => return picture(order, shown),
    };
    let pixel = shown.held().map(Chosen::Held);
    let panes = order.panes.clone();
    let (scale, look) = (order.scale, order.look);
    let steps = Steps { range, scale, look, panes, pixel, must_have_layer: false, freehand, turntable: 1 };
    let written = steps.write(&shown.subject, medium, Some(progress), None).await?;
    Ok(match medium {
        Medium::Pictures(..) => {
            format!("Saved {} into {}{}.", written.pictures(), files::label(path), written.without())
        }
        Medium::Animation(..) => {
            format!("Saved {} as {}{}.", written.pictures(), files::label(path), written.without())
        }
    })
}

/// Writes the frames of the clip; says what was written.
///
/// # Errors
/// If a frame cannot be read, a file cannot be written, or the work was cancelled.
pub async fn clip(order: &Order, shown: &Snapshot, progress: &dyn Progress) -> Result<String, Error> {
    let Prepared { clip, experiment, .. } = &*shown.subject;
    let path = &*order.path;
    if clip.is_blank() {
        return Err(Error::new(format!("{} has detections but no frames", clip.info().name)));
    }
    match (order.what, &experiment.source) {
        (OutputKind::Clip(ClipFormat::Copy), Source::File(from)) => export::copy(from, path).await?,
        (OutputKind::Clip(ClipFormat::Video), _) => export::video(clip, path, Some(progress)).await?,
        _ => export::clip(clip, path, Some(progress)).await?,
    }
    let padded = match order.what {
        OutputKind::Clip(ClipFormat::Video) => padded(clip.size()),
        _ => String::new(),
    };
    Ok(format!("Saved {}.{padded}", files::label(path)))
}

/// Says that a video has sides of another length than its clip, if it has.
fn padded((width, height): (usize, usize)) -> String {
    let [even_width, even_height] = [width, height].map(|side| side.next_multiple_of(2));
    if (even_width, even_height) == (width, height) {
        return String::new();
    }
    format!(" A video has even sides, so it has a black edge: {even_width}×{even_height} px.")
}

/// Writes a result as soon as it comes, in the format that the ending of `path` asks for; says what was written.
///
/// # Errors
/// If none comes, there is no such format, a file cannot be written, or the work was cancelled.
pub async fn result(
    path: &Path,
    export: &Export,
    output: &Receiver<Output>,
    progress: &dyn Progress,
) -> Result<String, Error> {
    let output = come(output, progress).await?;
    let made = (export.format(path)?.encode)(&output)?;
    let written = export.save(path, &made)?;
    let lost = made.lost.map_or_else(String::new, |lost| format!(" {lost}."));
    Ok(format!("Saved {written}.{lost}"))
}

async fn come(output: &Receiver<Output>, progress: &dyn Progress) -> Result<Output, Error> {
    loop {
        if progress.cancelled() {
            return Err(Error::new("saving was cancelled"));
        }
        match output.try_recv() {
            Ok(output) => return Ok(output),
            Err(TryRecvError::Empty) => work::sleep(POLL).await,
            Err(TryRecvError::Disconnected) => {
                return Err(Error::new("the run has moved on since; pause it and save again"));
            }
        }
    }
}
