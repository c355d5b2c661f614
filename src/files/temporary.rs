//! Temporary files and folders, from which results are moved into place.
//!
//! Their names begin with `.motionscope-`. On a disk the id of the process and `-` follow, by which `run` removes what a process has left.

#[cfg(not(target_arch = "wasm32"))]
mod run;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{PoisonError, RwLock, RwLockReadGuard};

#[cfg(not(target_arch = "wasm32"))]
pub use run::{Cleanup, begin};

use super::{IN_PAGE, is_in_memory, memory};

/// The prefix of temporary files.
const PREFIX: &str = ".motionscope-";

/// Read by whoever is writing, and written by a signal that ends this run: from then on nothing is written.
static AT_WORK: RwLock<()> = RwLock::new(());

/// Whether `path` lies in a temporary folder or is a temporary file.
pub fn is_temporary(path: &Path) -> bool {
    path.components().any(|part| part.as_os_str().to_str().is_some_and(|part| part.starts_with(PREFIX)))
}

/// Where `path` is to lie once it is finished: outside of every temporary folder.
pub fn destination(path: &Path) -> PathBuf {
    path.components().filter(|part| !is_temporary(Path::new(part.as_os_str()))).collect()
}

/// The beginning of the names of temporary files in `folder`.
pub fn prefix(folder: &Path) -> String {
    #[cfg(not(target_arch = "wasm32"))]
    if let Some(prefix) = run::noted(folder) {
        return prefix;
    }
    #[cfg(target_arch = "wasm32")]
    let _ = folder;
    PREFIX.into()
}

/// The system's folder for temporary files.
pub fn place() -> PathBuf {
    if IN_PAGE { memory::SAVED.into() } else { std::env::temp_dir() }
}

/// A temporary folder. Dropping it removes it with everything in it.
#[derive(Debug)]
pub struct Folder(Place);

#[derive(Debug)]
enum Place {
    Disk(tempfile::TempDir),
    Memory(PathBuf),
}

impl Folder {
    /// Its path.
    pub fn path(&self) -> &Path {
        match &self.0 {
            Place::Disk(folder) => folder.path(),
            Place::Memory(path) => path,
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if let Place::Memory(path) = &self.0 {
            memory::lock().remove_all(path);
        }
    }
}

/// Makes a temporary folder in `place`.
///
/// # Errors
/// If `place` is no folder, or cannot be written to.
pub fn folder(place: &Path) -> io::Result<Folder> {
    /// Tells those in memory apart.
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    if is_in_memory(place) {
        let path = place.join(format!("{PREFIX}{}", COUNT.fetch_add(1, Ordering::Relaxed)));
        let mut memory = memory::lock();
        memory.names(place)?;
        memory.make_folders(&path)?;
        return Ok(Folder(Place::Memory(path)));
    }
    let _at_work = at_work();
    let made = tempfile::Builder::new().prefix(&prefix(place)).tempdir_in(place)?;
    Ok(Folder(Place::Disk(made)))
}

/// Keeps signals from ending this run until it is dropped, as long as that does not take long: so a file is written, and several
/// are moved into place, whole or not at all. Where a signal was faster, it waits for the end.
pub fn at_work() -> RwLockReadGuard<'static, ()> {
    AT_WORK.read().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_temporary_folder_says_so_by_its_name() {
        let place = tempfile::tempdir().unwrap();
        let made = folder(place.path()).unwrap();
        assert!(made.path().is_dir() && made.path().starts_with(place.path()) && is_temporary(made.path()));
        drop(made);
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
        assert!(folder(&place.path().join("gone")).is_err());
    }
}
