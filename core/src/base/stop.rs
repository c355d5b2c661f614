//! Cancellation and progress of work on another thread.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::Error;

/// A flag that is set on one thread and looked at on others; its clones are one flag.
///
/// The work may also report its progress, which the waiting thread shows.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<Shared>);

#[derive(Default)]
struct Shared {
    stop: AtomicBool,
    /// A condition that sets it as well, for work without other threads.
    is_over: Option<Box<dyn Fn() -> bool + Send + Sync>>,
    /// Parts that are done, and above them in 32 bits all parts that there are; 0 where none are reported.
    done: AtomicU64,
}

impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Shared").field("stop", &self.stop).field("done", &self.done).finish_non_exhaustive()
    }
}

impl Stop {
    /// A flag that is also set while `is_over` says so, which is asked whenever the work looks.
    pub fn when(is_over: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(Shared { is_over: Some(Box::new(is_over)), ..Shared::default() }))
    }

    /// Asks the work to stop, or lets it go on.
    pub fn set(&self, stop: bool) {
        self.0.stop.store(stop, Ordering::Relaxed);
    }

    /// Whether the work should stop.
    pub fn is_set(&self) -> bool {
        self.0.stop.load(Ordering::Relaxed) || self.0.is_over.as_ref().is_some_and(|is_over| is_over())
    }

    /// Ends the work with `?`.
    ///
    /// # Errors
    /// If it should stop.
    pub fn check(&self) -> Result<(), Error> {
        if self.is_set() { Err(Self::cancelled()) } else { Ok(()) }
    }

    /// The error of cancelled work.
    pub(crate) fn cancelled() -> Error {
        Error::new("it was cancelled")
    }

    /// Reports that `done` of `of` parts of the work are done; ignored if `of` is 0.
    pub fn report(&self, done: usize, of: usize) {
        let [done, of] = [done, of].map(|parts| u32::try_from(parts).unwrap_or(u32::MAX));
        self.0.done.store(u64::from(of) << 32 | u64::from(done.min(of)), Ordering::Relaxed);
    }

    /// Parts done and total parts, if reported.
    pub fn progress(&self) -> Option<(usize, usize)> {
        let progress = self.0.done.load(Ordering::Relaxed);
        let (of, done) = (progress >> 32, progress & u64::from(u32::MAX));
        (of > 0).then_some((done as usize, of as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_sets_it() {
        let (cause, stop) = (Stop::default(), Stop::default());
        let also = {
            let cause = cause.clone();
            Stop::when(move || cause.is_set())
        };
        assert!(also.check().is_ok());
        cause.set(true);
        assert!(also.clone().is_set() && !stop.is_set());
    }

    #[test]
    fn clones_are_one() {
        let (ours, theirs) = (Stop::default(), Stop::default());
        let worker = ours.clone();
        assert!(worker.check().is_ok() && worker.progress().is_none());
        ours.set(true);
        assert!(worker.check().is_err() && theirs.check().is_ok());
        worker.report(3, 7);
        assert_eq!((ours.progress(), theirs.progress()), (Some((3, 7)), None));
        worker.report(usize::MAX, usize::MAX);
        assert_eq!(ours.progress(), Some((u32::MAX as usize, u32::MAX as usize)));
        worker.report(9, 0);
        assert_eq!(ours.progress(), None);
    }
}
