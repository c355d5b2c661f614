//! Truth files: dense flow and object tracks.

use std::path::Path;
use std::sync::Arc;

use motionscope_core::{ClipInfo, Error, Truth};

/// Opens truth that was given by hand.
///
/// # Errors
/// One sentence that names the file.
pub(crate) fn open(path: &Path, _info: &ClipInfo) -> Result<Arc<dyn Truth>, Error> {
    Err(Error::new(format!("cannot open the truth {}: truth cannot be read yet", path.display())))
}

/// Looks for truth beside the clip at `path`.
///
/// # Errors
/// One sentence that names the file, if there is truth that cannot be read.
pub(crate) fn beside(_path: &Path, _info: &ClipInfo) -> Result<Option<Arc<dyn Truth>>, Error> {
    Ok(None)
}
