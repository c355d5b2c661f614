//! The checks of output paths before anything runs.

use std::path::Path;

use motionscope_core::base::Error;

use crate::media::export::{Inputs, Target, check};

/// An output: its flag without dashes, and its target.
pub type Place<'a> = (&'static str, Target<'a>);

/// Refuses outputs that would overwrite each other or, without `force`, a file of `inputs`.
///
/// # Errors
/// One sentence that names the flag and the file.
pub fn refuse_losses(inputs: &Inputs, places: &[Place<'_>], force: bool) -> Result<(), Error> {
    let targets: Vec<_> = places.iter().map(|(_, target)| *target).collect();
    let inputs = if force { &Inputs::default() } else { inputs };
    check(inputs, &targets).map_err(|conflict| {
        let (flag, target) = places[conflict.at];
        let (path, why, other) = (target.path().display(), conflict.why, target.other());
        Error::new(match conflict.also {
            Some(also) => format!("--{} and --{flag} {why}, {path}; give each its own name", places[also].0),
            None => format!("--{flag} {path} {why}; choose {other}, or add --force to overwrite"),
        })
    })
}

/// Refuses an output file in a folder that does not exist.
///
/// # Errors
/// One sentence.
pub fn check_folder(path: &Path) -> Result<(), Error> {
    match path.parent() {
        Some(folder) if folder != Path::new("") && !folder.is_dir() => {
            Err(Error::new(format!("{} cannot be written: there is no such folder", path.display())))
        }
        _ => Ok(()),
    }
}
