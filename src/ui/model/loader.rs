//! Opens a clip or a session on a thread of its own, with progress and cancel.

use std::ffi::{OsStr, OsString};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use motionscope_core::{Clip, Error};

use crate::media::{Open, Progress};
use crate::session::{Named, Session};
use crate::source::Source;

/// A clip that was opened.
pub struct Opened {
    /// The clip.
    pub clip: Clip,
    /// Where it comes from.
    pub source: Source,
    /// The session that named it, if one did.
    pub session: Option<Session>,
}

/// A clip that is being opened.
pub struct Loading {
    /// What was asked for: a file, a folder, a session, or `synth:` and a scene.
    pub name: OsString,
    shared: Arc<Shared>,
}

type Changed = Box<dyn Fn() + Send + Sync>;

struct Shared {
    /// Share of the work that is done, from 0 to 1, as the bits of an `f32`.
    fraction: AtomicU32,
    cancelled: AtomicBool,
    outcome: Mutex<Option<Result<Opened, Error>>>,
    changed: Changed,
}

impl Progress for Shared {
    fn report(&self, fraction: f32) {
        let before = f32::from_bits(self.fraction.swap(fraction.to_bits(), Ordering::Relaxed));
        if (fraction - before).abs() > 0.01 {
            (self.changed)();
        }
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Loading {
    /// Begins to open `name`; `changed` is called from another thread whenever there is news.
    pub fn new(name: OsString, changed: impl Fn() + Send + Sync + 'static) -> Self {
        let shared = Arc::new(Shared {
            fraction: AtomicU32::new(0),
            cancelled: AtomicBool::new(false),
            outcome: Mutex::default(),
            changed: Box::new(changed),
        });
        let (worker, wanted) = (Arc::clone(&shared), name.clone());
        let work = move || worker.deliver(open(&wanted, Arc::clone(&worker) as Arc<dyn Progress>));
        if let Err(error) = std::thread::Builder::new().name("loader".into()).spawn(work) {
            shared.deliver(Err(Error::new(format!("no thread could be started to open the clip: {error}"))));
        }
        Self { name, shared }
    }

    /// The clip or why there is none, once.
    pub fn take(&self) -> Option<Result<Opened, Error>> {
        self.shared.outcome.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Share of the work that is done, from 0 to 1.
    pub fn fraction(&self) -> f32 {
        f32::from_bits(self.shared.fraction.load(Ordering::Relaxed))
    }
}

impl Drop for Loading {
    fn drop(&mut self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
    }
}

impl Shared {
    fn deliver(&self, outcome: Result<Opened, Error>) {
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
        (self.changed)();
    }
}

fn open(name: &OsStr, progress: Arc<dyn Progress>) -> Result<Opened, Error> {
    let Named { source, truth, session } = Named::find(name, None)?;
    let clip = source.open(&Open { progress: Some(progress), truth, ..Open::default() })?;
    Ok(Opened { clip, source, session })
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn outcome(name: OsString) -> Result<Opened, Error> {
        let loading = Loading::new(name, || {});
        let begun = Instant::now();
        loop {
            match loading.take() {
                Some(outcome) => return outcome,
                None => assert!(begun.elapsed() < Duration::from_secs(20)),
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_file_that_is_not_there_is_told() {
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
