//! A process that takes our data and must not keep us waiting.

use std::io;
use std::process::{Child, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crate::media::helper::{POLL, Running};

/// How often a thread looks whether a process is late.
const WATCH: Duration = Duration::from_millis(100);

/// A process that takes our data. It is ended where it takes nothing for too long, so that writing to it has an end.
pub struct Watched {
    watch: Arc<Watch>,
    patience: Duration,
}

struct Watch {
    child: Mutex<Running>,
    /// When the present wait began, if there is one.
    waits_since: Mutex<Option<Instant>>,
    is_ended: AtomicBool,
    is_late: AtomicBool,
}

/// A wait for the process, until it is dropped.
pub struct Waiting<'a>(&'a Watch);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        *locked(&self.0.waits_since) = None;
    }
}

impl Watched {
    /// Watches `child`, which is ended where a wait takes longer than `patience`.
    pub fn new(child: Child, patience: Duration) -> Self {
        let watch = Arc::new(Watch {
            child: Mutex::new(Running(child)),
            waits_since: Mutex::default(),
            is_ended: AtomicBool::new(false),
            is_late: AtomicBool::new(false),
        });
        let weak = Arc::downgrade(&watch);
        thread::spawn(move || {
            // It ends with the owner.
            while let Some(watch) = weak.upgrade() {
                if locked(&watch.waits_since).is_some_and(|since| since.elapsed() > patience) {
                    watch.is_late.store(true, Ordering::Relaxed);
                    watch.end();
                    break;
                }
                drop(watch);
                thread::sleep(WATCH);
            }
        });
        Self { watch, patience }
    }

    /// Begins a wait for the process.
    pub fn expect_progress(&self) -> Waiting<'_> {
        *locked(&self.watch.waits_since) = Some(Instant::now());
        Waiting(&self.watch)
    }

    /// Ends the process.
    pub fn end(&self) {
        self.watch.end();
    }

    /// Whether it was ended from here.
    pub fn is_ended(&self) -> bool {
        self.watch.is_ended.load(Ordering::Relaxed)
    }

    /// Whether it was ended because a wait took too long.
    pub fn is_late(&self) -> bool {
        self.watch.is_late.load(Ordering::Relaxed)
    }

    /// Waits until the process ends; it is ended when `is_cancelled`, or when it takes too long.
    ///
    /// # Errors
    /// If the system does not say how it ended.
    pub fn wait(&self, is_cancelled: &dyn Fn() -> bool) -> io::Result<ExitStatus> {
        let begun = Instant::now();
        loop {
            if let Some(status) = locked(&self.watch.child).0.try_wait()? {
                return Ok(status);
            }
            if !self.is_ended() && begun.elapsed() > self.patience {
                self.watch.is_late.store(true, Ordering::Relaxed);
                self.end();
            } else if !self.is_ended() && is_cancelled() {
                self.end();
            }
            thread::sleep(POLL);
        }
    }
}

impl Watch {
    fn end(&self) {
        self.is_ended.store(true, Ordering::Relaxed);
        // It may have ended by itself.
        let _ = locked(&self.child).0.kill();
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::Write as _;
    use std::process::Stdio;

    use super::*;
    use crate::media::helper::program;

    #[test]
    fn a_program_that_takes_nothing_does_not_keep_its_writer() {
        let mut command = program("sleep");
        let mut child = command.arg("600").stdin(Stdio::piped()).spawn().unwrap();
        let mut input = child.stdin.take().unwrap();
        let watched = Watched::new(child, Duration::from_millis(200));
        let written = {
            let _writing = watched.expect_progress();
            input.write_all(&vec![0; 4 << 20])
        };
        assert!(written.is_err() && watched.is_late());
        assert!(!watched.wait(&|| false).unwrap().success());
        let silent = Watched::new(program("sleep").arg("600").spawn().unwrap(), Duration::from_secs(60));
        assert!(!silent.wait(&|| true).unwrap().success() && silent.is_ended() && !silent.is_late());
    }
}
