//! Where results go, checked before anything runs.

use std::path::Path;

use motionscope_core::Error;

use crate::media::export::{Inputs, Target, check};

/// Something that is written: the flag that asks for it, without dashes, and where to.
pub type Place<'a> = (&'static str, Target<'a>);

/// Refuses places where results would be lost to each other, or, unless `force` says that it is meant, destroy something of
/// `inputs`.
///
/// # Errors
/// One sentence that names the flag and the file.
pub fn refuse_losses(inputs: &Inputs, places: &[Place<'_>], force: bool) -> Result<(), Error> {
    let targets: Vec<_> = places.iter().map(|(_, target)| *target).collect();
    let inputs = if force { &Inputs::default() } else { inputs };
    check(inputs, &targets).map_err(|clash| {
        let (flag, target) = places[clash.at];
        let (path, why, other) = (target.path().display(), clash.why, target.other());
        Error::new(match clash.also {
            Some(also) => format!("--{} and --{flag} {why}, {path}; give each its own name", places[also].0),
            None => format!("--{flag} {path} {why}; choose {other}, or add --force if that is meant"),
        })
    })
}

/// Refuses a file in a folder that does not exist.
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
