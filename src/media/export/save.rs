//! Atomic saving of files.
//!
//! A large file (a video, a copied recording) is made in a temporary folder beside its place and renamed. Results are saved
//! with `save_result` and marked (`mark.rs`), and the search for ground truth skips marked files; only ground truth and
//! sessions are saved with `save`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;

use crate::files::{self, IN_PAGE, temporary};

/// The sentence for a full disk or memory.
const DISK_IS_FULL: &str = if IN_PAGE {
    "it does not fit into the memory of this page; save less, or use the desktop edition"
} else {
    "the disk is full; make room or choose another one"
};

/// Copies the file `from` to `to` atomically.
///
/// # Errors
/// If it cannot be read, and as [`save`].
pub async fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    let unread = |error: io::Error| Error::new(format!("{} cannot be read ({error})", files::label(from)));
    let mut source = files::File::open(from).map_err(unread)?;
    let write = async |file: &Path| files::write_from(file, &mut source).map_err(|error| cannot_write(to, &error));
    save_file(to, write).await
}

/// Saves the file that `make` writes under the name that it is given, atomically and without a copy of it in memory.
///
/// # Errors
/// As [`save`], and those of `make`.
pub(super) async fn save_file(path: &Path, make: impl AsyncFnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    let cannot = |error: io::Error| cannot_write(path, &error);
    let unfinished = files::Unfinished::new(path).map_err(cannot)?;
    make(unfinished.path()).await?;
    unfinished.settle().map_err(cannot)
}

/// Saves `bytes` to `path` atomically; `-` is standard output.
///
/// # Errors
/// If the folder does not exist or cannot be written to, the disk is full, or the reader of a pipe is gone. A file
/// that was there before is then as it was.
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let written = if path == Path::new("-") { pour(&mut io::stdout().lock(), bytes) } else { files::save(path, bytes) };
    written.map_err(|e| cannot_write(path, &e))
}

/// Why nothing can be written to `path`; what lies in a temporary folder is called as it is to be called in the end.
pub(in crate::media) fn cannot_write(path: &Path, error: &io::Error) -> Error {
    let path = temporary::destination(path);
    Error::new(format!("{} cannot be written: {}", files::label(&path), reason(&path, error)))
}

/// Makes a folder, and those that it lies in, if there is none.
///
/// # Errors
/// If it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    files::create_dir_all(folder).map_err(|e| not_made(folder, &e))
}

/// Makes `folder` as [`make_folder`] does and fills it; where that fails, those folders that were made and are empty go again.
///
/// # Errors
/// If it cannot be made, and those of `fill`.
pub fn fill_folder<T>(folder: &Path, fill: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    let made = NewFolder::make(folder)?;
    let filled = fill()?;
    made.keep();
    Ok(filled)
}

/// A folder that goes again when it is dropped, with those that were made for it, if they are empty.
pub(super) struct NewFolder<'a>(Vec<&'a Path>);

impl<'a> NewFolder<'a> {
    /// Makes a folder as [`make_folder`] does.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn make(folder: &'a Path) -> Result<Self, Error> {
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !files::exists(folder);
        let made = Self(folder.ancestors().take_while(is_missing).collect());
        make_folder(folder).map(|()| made)
    }

    /// Keeps it.
    pub fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for NewFolder<'_> {
    fn drop(&mut self) {
        // From the innermost outwards, up to the first that has something in it.
        let _ = self.0.drain(..).try_for_each(files::remove_dir);
    }
}

/// Why a folder cannot be made.
pub(super) fn not_made(folder: &Path, error: &io::Error) -> Error {
    let folder = temporary::destination(folder);
    let why = match error.kind() {
        io::ErrorKind::StorageFull => DISK_IS_FULL.to_owned(),
        _ => format!("{}; choose another one", cause(error)),
    };
    Error::new(format!("the folder {} cannot be made: {why}", folder.display()))
}

fn pour(to: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    to.write_all(bytes)?;
    to.flush()
}

fn folder(path: &Path) -> PathBuf {
    path.parent().filter(|p| !p.as_os_str().is_empty()).map_or_else(|| PathBuf::from("."), Path::to_path_buf)
}

fn reason(path: &Path, error: &io::Error) -> String {
    let folder = folder(path);
    match error.kind() {
        io::ErrorKind::NotFound => format!("there is no folder {}; make it first", folder.display()),
        io::ErrorKind::PermissionDenied => {
            format!("no permission to write to {}; choose another folder", folder.display())
        }
        io::ErrorKind::BrokenPipe => "the reader of the pipe has closed it".into(),
        io::ErrorKind::StorageFull => DISK_IS_FULL.into(),
        io::ErrorKind::IsADirectory => "it is a folder; give a file name".into(),
        _ => format!("{}; choose another place", cause(error)),
    }
}

/// The error without the name of the temporary file or folder that it came with.
fn cause(error: &io::Error) -> String {
    // Only an error that was wrapped has more than what the system says.
    if error.get_ref().is_some() { error.kind().to_string() } else { error.to_string() }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::work;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.flo");
        save(&path, b"first").unwrap();
        save(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_error_names_the_place_and_never_a_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let unfinished = temporary::folder(folder.path()).unwrap();
        let inside = unfinished.path().join("flow").join("frame_0000.flo");
        for kind in [io::ErrorKind::StorageFull, io::ErrorKind::PermissionDenied, io::ErrorKind::Other] {
            let [file, place] = [cannot_write(&inside, &kind.into()), not_made(unfinished.path(), &kind.into())];
            assert!(
                file.to_string()
                    .starts_with(&format!("{} cannot", folder.path().join("flow/frame_0000.flo").display()))
            );
            for why in [file, place] {
                assert!(!why.to_string().contains(".motionscope-"), "{why}");
            }
        }
        // It names the file that it tried to make.
        let gone = temporary::folder(&folder.path().join("gone")).unwrap_err();
        assert!(gone.to_string().contains(".motionscope-"), "{gone}");
        assert!(!not_made(folder.path(), &gone).to_string().contains(".motionscope-"));
    }

    #[test]
    fn a_folder_that_was_not_filled_goes_again() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("a/b");
        let failed = || Err::<(), _>(Error::new("the disk is full"));
        assert!(fill_folder(&inner, failed).is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let half =
            || fs::write(inner.join("x"), "x").map_err(|error| Error::new(error.to_string())).and_then(|()| failed());
        assert!(fill_folder(&inner, half).is_err());
        assert!(inner.join("x").exists(), "a folder with something in it stays");
        fs::remove_file(inner.join("x")).unwrap();
        assert!(fill_folder(&inner, failed).is_err() && inner.exists(), "it was there before");
    }

    #[test]
    fn a_file_takes_its_place_once_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let (path, count) = (folder.path().join("a.mp4"), || fs::read_dir(folder.path()).unwrap().count());
        fs::write(&path, "old").unwrap();
        let cancelled = async |file: &Path| {
            fs::write(file, "half").unwrap();
            Err(Error::new("it was cancelled"))
        };
        assert!(work::finish(save_file(&path, cancelled)).is_err());
        assert_eq!((fs::read(&path).unwrap(), count()), (b"old".to_vec(), 1));
        let whole = async |file: &Path| {
            // On the same drive, and removed at the next start if this run is killed now.
            assert!(temporary::is_temporary(file) && file.starts_with(fs::canonicalize(folder.path()).unwrap()));
            assert_eq!((fs::read(&path).unwrap(), count()), (b"old".to_vec(), 2));
            fs::write(file, "new").map_err(|error| cannot_write(file, &error))
        };
        work::finish(save_file(&path, whole)).unwrap();
        assert_eq!((fs::read(&path).unwrap(), count()), (b"new".to_vec(), 1));
        let other = folder.path().join("b.mp4");
        work::finish(copy(&path, &other)).unwrap();
        assert_eq!((fs::read(&other).unwrap(), count()), (b"new".to_vec(), 2));
        let gone = work::finish(copy(&folder.path().join("gone.mp4"), &other)).unwrap_err().to_string();
        assert!(gone.contains("gone.mp4 cannot be read"), "{gone}");
        let nowhere = work::finish(copy(&path, &folder.path().join("no/c.mp4"))).unwrap_err().to_string();
        assert!(nowhere.contains("there is no folder"), "{nowhere}");
    }

    #[test]
    fn what_cannot_be_written_is_reported_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("gone").join("a.flo");
        assert!(save(&missing, b"x").unwrap_err().to_string().contains("there is no folder"));
        assert!(save(folder.path(), b"x").unwrap_err().to_string().contains("cannot be written"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
