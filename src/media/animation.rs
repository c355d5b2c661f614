//! Animated GIF, APNG and WebP.

use std::path::Path;

use motionscope_core::Error;

use super::{Open, Source};

/// Opens the animation at `path`.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(_path: &Path, _options: &Open) -> Result<Source, Error> {
    Err(Error::new("animations cannot be opened yet"))
}
