//! Opening of clips and sessions as a task, with progress and cancellation.

use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::data::Clip;

use super::background::Background;
use crate::experiment;
use crate::experiment::source::Source;
use crate::media::export::{InputKind, Inputs};
use crate::media::{self, Given, Open, OpenedClip, Progress, RightView};
use crate::session::{Named, Session};

/// An opened clip.
pub struct Opened {
    /// The clip.
    pub clip: Clip,
    /// The source of the clip.
    pub source: Source,
    /// Files given explicitly.
    pub given: Given,
    /// The session, if it was opened from one.
    pub session: Option<Session>,
    /// All input files.
    pub inputs: Inputs,
    /// The first pair of frames whose true flow is known, if that of the first pair is not.
    pub first_known: Option<usize>,
}

/// The clip that is open while another one is being opened.
pub struct Beside {
    /// The source of the clip.
    pub source: Source,
    /// Files given explicitly.
    pub given: Given,
}

/// A clip being opened.
pub struct Loading {
    /// The requested file, folder, session or `synth:` scene.
    pub name: OsString,
    /// What is said once it is open.
    pub description: Option<String>,
    /// The background task.
    pub work: Background<Opened>,
}

impl Loading {
    /// Starts opening `name`: a clip, a session, or ground truth or detections for the open clip `beside`, which is reopened with it. `changed` is
    /// called by the task on progress.
    pub fn new(name: OsString, beside: Option<Beside>, changed: impl Fn() + Send + Sync + 'static) -> Self {
        let wanted = name.clone();
        let work = Background::new("open the clip", changed, async move |control| {
            open(&wanted, beside, Arc::clone(control) as Arc<dyn Progress>).await
        });
        Self { name, description: None, work }
    }
}

impl Loading {
    /// Starts opening the right view at `path` of the open clip `beside`, which is reopened with it.
    pub fn right_view(path: OsString, beside: Beside, changed: impl Fn() + Send + Sync + 'static) -> Self {
        let Beside { source, given } = beside;
        let given = Given { right: Some(RightView::of(Path::new(&path))), ..given };
        let work = Background::new("open the clip", changed, async move |control| {
            opened(Named::clip(source, given), None, Arc::clone(control) as Arc<dyn Progress>).await
        });
        Self { name: path, description: None, work }
    }
}

async fn open(name: &OsStr, beside: Option<Beside>, progress: Arc<dyn Progress>) -> Result<Opened, Error> {
    let path = Path::new(name);
    let named = match beside {
        Some(Beside { source, given }) if media::is_truth(path) => {
            Named::clip(source, Given { truth: Some(name.into()), ..given })
        }
        Some(Beside { source, given }) if has_frames(&source) && media::is_detections(path) => {
            Named::clip(source, Given { detections: Some(name.into()), ..given })
        }
        _ => Named::find(name, Given::default())?,
    };
    let session = named.session.is_some().then(|| Path::new(name));
    opened(named, session, progress).await
}

/// Whether the clip was opened from pictures or a video, to which detections can belong.
fn has_frames(source: &Source) -> bool {
    match source {
        Source::File(path) => !media::is_detections(path),
        Source::Pair(_) => true,
        Source::Synth { .. } => false,
    }
}

/// Opens a clip that is `named`, in the file `written` if it is a session.
async fn opened(named: Named, written: Option<&Path>, progress: Arc<dyn Progress>) -> Result<Opened, Error> {
    let Named { source, given, session, .. } = named;
    let control = Arc::clone(&progress);
    let options = Open { progress: Some(progress), ..Open::from(given.clone()) };
    media::decode_ahead(&source.paths(), &options).await?;
    let OpenedClip { clip, mut inputs } = source.open(&options)?;
    if let Some(file) = written {
        inputs.add(InputKind::Session, file);
    }
    let first_known = experiment::first_known_pair(&clip, || !control.cancelled());
    Ok(Opened { clip, source, given, session, inputs, first_known })
}

#[cfg(test)]
mod tests {
    use web_time::{Duration, Instant};

    use super::*;

    fn outcome(name: OsString) -> Result<Opened, Error> {
        let loading = Loading::new(name, None, || {});
        let begun = Instant::now();
        loop {
            match loading.work.take() {
                Some(outcome) => return outcome,
                None => assert!(begun.elapsed() < Duration::from_secs(20)),
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_file_that_is_not_there_is_reported() {
        assert!(outcome("no/such/clip.png".into()).is_err_and(|error| error.to_string().contains("clip.png")));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_name_that_is_no_unicode_is_opened() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(OsStr::from_bytes(b"caf\xE9.y4m"));
        std::fs::write(&path, b"YUV4MPEG2 W1 H1 Cmono\nFRAME\n\x10").unwrap();
        assert!(outcome(path.into()).is_ok_and(|opened| opened.clip.info().frames == Some(1)));
    }
}
