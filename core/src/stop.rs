//! Tells work on another thread that nobody wants it any more.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::Error;

/// A flag that is set on one thread and looked at on others; its clones are one flag.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks the work to stop, or lets it go on.
    pub fn set(&self, stop: bool) {
        self.0.store(stop, Ordering::Relaxed);
    }

    /// Whether the work should stop.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Ends the work with `?`.
    ///
    /// # Errors
    /// If it should stop.
    pub fn check(&self) -> Result<(), Error> {
        if self.is_set() { Err(Self::given_up()) } else { Ok(()) }
    }

    /// What is said of work that was stopped.
    pub(crate) fn given_up() -> Error {
        Error::new("it was given up, because nobody wants it any more")
    }
}
