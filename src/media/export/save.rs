//! Atomic saving of files.
//!
//! A large file (a video, a copied recording) is made in a temporary folder beside its place and renamed. Results are saved
//! with `save_result` and marked (`mark.rs`), and the search for ground truth skips marked files; only ground truth and
//! sessions are saved with `save`.

use std::env;
use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;

use crate::media::temporary;

/// What is said where a disk has no room.
const DISK_IS_FULL: &str = "the disk is full; make room or choose another one";

/// Copies the file `from` to `to` atomically.
///
/// # Errors
/// If it cannot be read, and as [`save`].
pub fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    let unread = |error: io::Error| Error::new(format!("{} cannot be read ({error})", from.display()));
    let mut source = File::open(from).map_err(unread)?;
    save_file(to, |file| {
        let copied = File::create(file).and_then(|mut file| io::copy(&mut source, &mut file));
        copied.map(drop).map_err(|error| cannot_write(to, &error))
    })
}

/// Saves the file that `make` writes under the name that it is given, atomically and without a copy of it in memory.
///
/// # Errors
/// As [`save`], and those of `make`.
pub(super) fn save_file(path: &Path, make: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    let cannot = |error: io::Error| cannot_write(path, &error);
    // A link keeps pointing where it points.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let is_stream = path == Path::new("-") || (target.exists() && !target.is_file());
    let place = if is_stream { env::temp_dir() } else { folder(&target) };
    let made = temporary::folder(&place).map_err(cannot)?;
    let file = made.path().join("unfinished");
    make(&file)?;
    if is_stream {
        return stream(&file, path).map_err(cannot);
    }
    let _at_work = temporary::at_work();
    if let Ok(old) = fs::metadata(&target) {
        fs::set_permissions(&file, old.permissions()).map_err(cannot)?;
    }
    fs::rename(&file, &target).map_err(cannot)
}

/// Writes the bytes of a file to what no file can take the place of: a device, or standard output.
fn stream(file: &Path, to: &Path) -> io::Result<()> {
    let mut file = File::open(file)?;
    let copied = match to == Path::new("-") {
        true => io::copy(&mut file, &mut io::stdout().lock()),
        false => OpenOptions::new().write(true).open(to).and_then(|mut to| io::copy(&mut file, &mut to)),
    };
    copied.map(drop)
}

/// Saves `bytes` to `path` atomically; `-` is standard output.
///
/// # Errors
/// If the folder does not exist or cannot be written to, the disk is full, or the reader of a pipe is gone. A file
/// that was there before is then as it was.
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let written = if path == Path::new("-") {
        pour(&mut io::stdout().lock(), bytes)
    } else {
        match fs::canonicalize(path) {
            // A link keeps pointing where it points, and `/dev/null` stays what it is.
            Ok(target) if target.is_file() => replace(&target, bytes),
            Ok(target) => OpenOptions::new().write(true).open(target).and_then(|mut file| pour(&mut file, bytes)),
            Err(_) => replace(path, bytes),
        }
    };
    written.map_err(|e| cannot_write(path, &e))
}

/// Why nothing can be written to `path`; what lies in a temporary folder is called as it is to be called in the end.
pub(in crate::media) fn cannot_write(path: &Path, error: &io::Error) -> Error {
    let path = temporary::destination(path);
    Error::new(format!("{} cannot be written: {}", path.display(), reason(&path, error)))
}

/// Makes a folder, and those that it lies in, if there is none.
///
/// # Errors
/// If it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder).map_err(|e| not_made(folder, &e))
}

/// Makes `folder` as [`make_folder`] does and fills it; where that fails, those folders that were made and are empty go again.
///
/// # Errors
/// If it cannot be made, and those of `fill`.
pub fn fill_folder<T>(folder: &Path, fill: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    let made: Vec<&Path> =
        folder.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).collect();
    let filled = make_folder(folder).and_then(|()| fill());
    if filled.is_err() {
        // From the innermost outwards, up to the first that has something in it.
        let _ = made.into_iter().try_for_each(fs::remove_dir);
    }
    filled
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

/// Writes beside `path`, then renames.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let _at_work = temporary::at_work();
    let mut file = draft(path)?;
    pour(&mut file, bytes)?;
    file.persist(path)?;
    Ok(())
}

/// A temporary file beside `path` that can take its place.
pub(in crate::media) fn draft(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let prefix = temporary::prefix(&folder(path));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    if let Some(permissions) = permissions(path) {
        builder.permissions(permissions);
    }
    builder.tempfile_in(folder(path))
}

/// The permissions of the file that is replaced; for a new one those that any program would give it.
fn permissions(path: &Path) -> Option<Permissions> {
    fs::metadata(path).ok().map(|old| old.permissions()).or_else(default_permissions)
}

#[cfg(unix)]
fn default_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn default_permissions() -> Option<Permissions> {
    None
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
    use super::*;

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
        let cancelled = save_file(&path, |file| {
            fs::write(file, "half").unwrap();
            Err(Error::new("it was cancelled"))
        });
        assert!(cancelled.is_err());
        assert_eq!((fs::read(&path).unwrap(), count()), (b"old".to_vec(), 1));
        let whole = |file: &Path| {
            // On the same drive, and removed at the next start if this run is killed now.
            assert!(temporary::is_temporary(file) && file.starts_with(fs::canonicalize(folder.path()).unwrap()));
            assert_eq!((fs::read(&path).unwrap(), count()), (b"old".to_vec(), 2));
            fs::write(file, "new").map_err(|error| cannot_write(file, &error))
        };
        save_file(&path, whole).unwrap();
        assert_eq!((fs::read(&path).unwrap(), count()), (b"new".to_vec(), 1));
        let other = folder.path().join("b.mp4");
        copy(&path, &other).unwrap();
        assert_eq!((fs::read(&other).unwrap(), count()), (b"new".to_vec(), 2));
        let gone = copy(&folder.path().join("gone.mp4"), &other).unwrap_err().to_string();
        assert!(gone.contains("gone.mp4 cannot be read"), "{gone}");
        let nowhere = copy(&path, &folder.path().join("no/c.mp4")).unwrap_err().to_string();
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

    #[cfg(unix)]
    #[test]
    fn permissions_and_links_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.csv"), folder.path().join("link.csv"));
        fs::write(&path, b"old").unwrap();
        let usual = fs::metadata(&path).unwrap().permissions().mode();
        let fresh = folder.path().join("b.csv");
        save(&fresh, b"new").unwrap();
        assert_eq!(fs::metadata(&fresh).unwrap().permissions().mode(), usual);

        fs::set_permissions(&path, Permissions::from_mode(0o600)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        save(&link, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        copy(&fresh, &link).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        copy(&path, &folder.path().join("c.csv")).unwrap();
        assert_eq!(fs::metadata(folder.path().join("c.csv")).unwrap().permissions().mode(), usual, "as a new file");
    }
}
