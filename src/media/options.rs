//! The options for opening a clip, and the progress of it.

use std::sync::Arc;

use motionscope_core::base::Error;

use super::given::Given;

/// The progress of a long computation, and its cancellation.
pub trait Progress: Send + Sync {
    /// Reports the fraction done, from 0 to 1.
    fn report(&self, fraction: f32);

    /// Whether the computation was cancelled.
    fn cancelled(&self) -> bool;
}

/// Options for opening a clip.
#[derive(Clone)]
pub struct Open {
    /// Limit of the frame cache in bytes, shared by both views; the frame requested last of each is always kept.
    pub cache_bytes: usize,
    /// Whether to decode the whole file to count its frames where the container does not say.
    pub count: bool,
    /// Whether formats without a built-in decoder may be decoded by an installed ffmpeg.
    pub ffmpeg: bool,
    /// Files given explicitly.
    pub given: Given,
    /// Receives the progress.
    pub progress: Option<Arc<dyn Progress>>,
}

impl Default for Open {
    fn default() -> Self {
        Self { cache_bytes: 512 << 20, count: false, ffmpeg: true, given: Given::default(), progress: None }
    }
}

impl From<Given> for Open {
    fn from(given: Given) -> Self {
        Self { given, ..Self::default() }
    }
}

impl Open {
    /// Reports the progress.
    ///
    /// # Errors
    /// If the operation was cancelled.
    pub(crate) fn report(&self, fraction: f32) -> Result<(), Error> {
        match &self.progress {
            Some(progress) if progress.cancelled() => Err(Error::new("opening was cancelled")),
            Some(progress) => {
                progress.report(fraction);
                Ok(())
            }
            None => Ok(()),
        }
    }
}
