//! Files on the disk: atomic writing, and what `std::fs` says about them.

use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Facts, Kind, parent, temporary};

/// The facts in `metadata`.
pub(super) fn facts(metadata: &Metadata) -> Facts {
    let kind = match metadata.file_type() {
        kind if kind.is_dir() => Kind::Folder,
        kind if kind.is_file() => Kind::File,
        kind => special(kind),
    };
    Facts { kind, size: metadata.len(), node: node(metadata) }
}

#[cfg(unix)]
fn special(kind: fs::FileType) -> Kind {
    use std::os::unix::fs::FileTypeExt;
    match kind {
        kind if kind.is_fifo() => Kind::Pipe,
        kind if kind.is_socket() => Kind::Socket,
        _ => Kind::Device,
    }
}

#[cfg(not(unix))]
fn special(_kind: fs::FileType) -> Kind {
    Kind::Device
}

#[cfg(unix)]
fn node(metadata: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn node(_metadata: &Metadata) -> Option<(u64, u64)> {
    None
}

/// Adds `line` to the end of the file at `path`.
pub(super) fn append(path: &Path, line: &[u8]) -> io::Result<()> {
    OpenOptions::new().append(true).create(true).open(path)?.write_all(line)
}

/// Writes `bytes` to `path` atomically.
pub(super) fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match fs::canonicalize(path) {
        // A link keeps pointing where it points, and `/dev/null` stays what it is.
        Ok(target) if target.is_file() => replace(&target, bytes),
        Ok(target) => OpenOptions::new().write(true).open(target).and_then(|mut file| file.write_all(bytes)),
        Err(_) => replace(path, bytes),
    }
}

/// Writes beside `path`, then renames.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let _at_work = temporary::at_work();
    let mut file = draft(path)?;
    file.write_all(bytes)?;
    file.flush()?;
    file.persist(path)?;
    Ok(())
}

/// A temporary file beside `path` that can take its place.
///
/// # Errors
/// If it cannot be made.
pub fn draft(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let prefix = temporary::prefix(parent(path));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    if let Some(permissions) = permissions(path) {
        builder.permissions(permissions);
    }
    builder.tempfile_in(parent(path))
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

/// The path that stands for standard output.
pub(super) const STANDARD_OUTPUT: &str = "-";

/// Whether `target` cannot be replaced by a file: standard output or a device.
fn is_stream(target: &Path) -> bool {
    target == Path::new(STANDARD_OUTPUT) || (target.exists() && !target.is_file())
}

/// Where a file is made that is to take the place of `target`.
pub(super) fn place_beside(target: &Path) -> PathBuf {
    if super::is_in_memory(target) || !is_stream(target) { parent(target).into() } else { temporary::place() }
}

/// Replaces `target` by `file`, or writes the bytes of `file` to it.
pub(super) fn settle(file: &Path, target: &Path) -> io::Result<()> {
    if is_stream(target) {
        return stream(file, target);
    }
    let _at_work = temporary::at_work();
    if let Ok(old) = fs::metadata(target) {
        fs::set_permissions(file, old.permissions())?;
    }
    fs::rename(file, target)
}

/// Writes the bytes of a file to what no file can take the place of.
fn stream(file: &Path, to: &Path) -> io::Result<()> {
    let mut file = File::open(file)?;
    let copied = match to == Path::new(STANDARD_OUTPUT) {
        true => io::copy(&mut file, &mut io::stdout().lock()),
        false => OpenOptions::new().write(true).open(to).and_then(|mut to| io::copy(&mut file, &mut to)),
    };
    copied.map(drop)
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::super::{Unfinished, save, write_from};
    use super::*;

    #[test]
    fn permissions_and_links_are_kept() {
        let copy = |from: &Path, to: &Path| {
            let unfinished = Unfinished::new(to).unwrap();
            write_from(unfinished.path(), &mut File::open(from).unwrap()).unwrap();
            unfinished.settle().unwrap();
        };
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
        copy(&fresh, &link);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        copy(&path, &folder.path().join("c.csv"));
        assert_eq!(fs::metadata(folder.path().join("c.csv")).unwrap().permissions().mode(), usual, "as a new file");
    }
}
