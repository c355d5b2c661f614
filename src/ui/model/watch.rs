//! Watching a file for changes while the window is at rest.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

use crate::files;
use crate::work;

/// How often the file is looked at.
const PERIOD: Duration = Duration::from_millis(500);

/// A task that looks at the time of a file, and wakes the window only when it has changed. It ends when this is dropped.
pub struct Watch {
    has_changed: Arc<AtomicBool>,
}

impl Watch {
    /// Starts to watch the file at `path`; `wake` is called after each change.
    ///
    /// # Errors
    /// If no task can be started.
    pub fn new(path: PathBuf, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let has_changed = Arc::new(AtomicBool::new(false));
        let watched = Arc::downgrade(&has_changed);
        let mut last = written(&path);
        work::spawn("watch", async move || {
            loop {
                work::sleep(PERIOD).await;
                let Some(has_changed) = watched.upgrade() else { return };
                let now = written(&path);
                if now.is_some() && now != last {
                    last = now;
                    has_changed.store(true, Ordering::Release);
                    wake();
                }
            }
        })?;
        Ok(Self { has_changed })
    }

    /// Whether the file has changed since the last call.
    pub fn take(&self) -> bool {
        self.has_changed.swap(false, Ordering::AcqRel)
    }
}

fn written(path: &Path) -> Option<SystemTime> {
    files::modified(path).ok()
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    #[test]
    fn it_wakes_after_a_change_and_only_then() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("watched");
        std::fs::write(&path, "a").expect("a file");
        let (wake, woken) = mpsc::channel();
        let watch = Watch::new(path.clone(), move || wake.send(()).unwrap_or_default()).expect("a thread");
        assert!(woken.recv_timeout(3 * PERIOD).is_err() && !watch.take(), "nothing has changed");
        let later = SystemTime::now() + Duration::from_secs(5);
        std::fs::File::options().write(true).open(&path).expect("a file").set_modified(later).expect("a time");
        woken.recv_timeout(20 * PERIOD).expect("woken");
        assert!(watch.take() && !watch.take());
    }
}
