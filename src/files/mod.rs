//! The one door to files: those on the disk, and those held in memory.
//!
//! A page of a browser has no disk. Files given to the page are held in memory ([`given`]), and files that it saves go through memory
//! to the browser ([`download`]). The functions here mirror `std::fs`, and the path decides: in a page every path is in memory; on a
//! desktop only those below `/given`, `/saved` and `/decoded`, and only while something is held there. All other code names files by path and is the same for both.

pub mod decoded;
mod disk;
pub mod download;
pub mod given;
mod memory;
#[cfg(target_arch = "wasm32")]
pub mod page;
pub mod temporary;
mod zip;

use std::fs;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

pub use disk::draft;
pub use memory::{Bytes, MOST_BYTES};

/// Whether the program runs in a page of a browser, without a disk, other programs and devices. Commands that need them are not offered.
pub const IN_PAGE: bool = cfg!(target_arch = "wasm32");

/// Whether the file or folder at `path` is, or would be, held in memory.
pub fn is_in_memory(path: &Path) -> bool {
    let is_below = |folder| path.starts_with(folder);
    IN_PAGE || [memory::GIVEN, memory::SAVED, memory::DECODED].iter().any(is_below) && !memory::lock().is_empty()
}

/// Opens the browser's dialog for files, or for a folder; the chosen files arrive later ([`given::arrivals`]).
pub fn ask(is_folder: bool) {
    #[cfg(target_arch = "wasm32")]
    page::choose(is_folder);
    #[cfg(not(target_arch = "wasm32"))]
    let _ = is_folder;
}

/// The name of `path` in messages: of a file in memory, the name under which it was given or is saved.
pub fn label(path: &Path) -> std::path::Display<'_> {
    if !is_in_memory(path) {
        return path.display();
    }
    let mut given = path.strip_prefix(memory::GIVEN).unwrap_or(path).components();
    let inner = match path.strip_prefix(memory::SAVED) {
        Ok(saved) => saved,
        // Behind the number of the folder.
        Err(_) if given.next().is_some() && path.starts_with(memory::GIVEN) => given.as_path(),
        Err(_) => path,
    };
    inner.display()
}

/// A file that is open for reading.
#[derive(Debug)]
pub struct File(Opened);

#[derive(Debug)]
enum Opened {
    Disk(fs::File),
    Memory(Cursor<Bytes>),
}

impl File {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// If there is none, or it cannot be read.
    pub fn open(path: &Path) -> io::Result<Self> {
        if is_in_memory(path) {
            return Ok(Self(Opened::Memory(Cursor::new(memory::lock().file(path)?))));
        }
        fs::File::open(path).map(|file| Self(Opened::Disk(file)))
    }

    /// How many bytes it has.
    ///
    /// # Errors
    /// If the system does not say.
    pub fn size(&self) -> io::Result<u64> {
        match &self.0 {
            Opened::Disk(file) => file.metadata().map(|facts| facts.len()),
            Opened::Memory(bytes) => Ok(bytes.get_ref().as_ref().len() as u64),
        }
    }
}

impl Read for File {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match &mut self.0 {
            Opened::Disk(file) => file.read(buffer),
            Opened::Memory(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.0 {
            Opened::Disk(file) => file.seek(to),
            Opened::Memory(bytes) => bytes.seek(to),
        }
    }
}

/// The kind of object at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A named pipe.
    Pipe,
    /// A socket.
    Socket,
    /// A device, or another thing that is neither file nor folder.
    Device,
}

/// Facts about a file, read without opening it.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Its kind.
    pub kind: Kind,
    /// How many bytes it has.
    pub size: u64,
    /// Device and inode, where it has them: the same for all names of one file.
    pub node: Option<(u64, u64)>,
}

/// The facts about the file at `path`; links are followed.
///
/// # Errors
/// If nothing is there.
pub fn facts(path: &Path) -> io::Result<Facts> {
    if is_in_memory(path) { memory::lock().facts(path) } else { fs::metadata(path).map(|facts| disk::facts(&facts)) }
}

/// Whether something is at `path`.
pub fn exists(path: &Path) -> bool {
    facts(path).is_ok()
}

/// Whether a regular file is at `path`.
pub fn is_file(path: &Path) -> bool {
    facts(path).is_ok_and(|facts| facts.kind == Kind::File)
}

/// Whether a folder is at `path`.
pub fn is_dir(path: &Path) -> bool {
    facts(path).is_ok_and(|facts| facts.kind == Kind::Folder)
}

/// Whether the name is taken, even if only by a link that leads nowhere.
pub fn is_taken(path: &Path) -> bool {
    if is_in_memory(path) { exists(path) } else { fs::symlink_metadata(path).is_ok() }
}

/// When the file at `path` was written last. A file in memory does not change.
///
/// # Errors
/// If nothing is there, or the system does not say.
pub fn modified(path: &Path) -> io::Result<SystemTime> {
    if is_in_memory(path) { Err(io::ErrorKind::Unsupported.into()) } else { fs::metadata(path)?.modified() }
}

/// The bytes of the file at `path`.
///
/// # Errors
/// If it cannot be read.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    if is_in_memory(path) { memory::lock().file(path).map(Bytes::into_vec) } else { fs::read(path) }
}

/// The text in the file at `path`.
///
/// # Errors
/// If it cannot be read, or is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// The entries of a folder.
pub type Entries = Box<dyn Iterator<Item = io::Result<PathBuf>>>;

/// The paths of all entries of the folder at `path`, in any order.
///
/// # Errors
/// If it is no folder, or cannot be read.
pub fn read_dir(path: &Path) -> io::Result<Entries> {
    if is_in_memory(path) {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let names = memory::lock().names(path)?;
        let path = path.to_owned();
        return Ok(Box::new(names.into_iter().map(move |name| Ok(path.join(name)))));
    }
    fs::read_dir(path).map(|entries| Box::new(entries.map(|entry| entry.map(|entry| entry.path()))) as Entries)
}

/// The paths of all entries of the folder at `path`; none if it cannot be read.
pub fn entries(path: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    read_dir(path).into_iter().flatten().flatten()
}

/// The absolute path of what exists at `path`, without links, `.` and `..`.
///
/// # Errors
/// If nothing is there.
pub fn canonicalize(path: &Path) -> io::Result<PathBuf> {
    if is_in_memory(path) { memory::lock().canonicalize(path) } else { fs::canonicalize(path) }
}

/// The absolute path of `path`, which need not exist.
pub fn absolute(path: &Path) -> PathBuf {
    if is_in_memory(path) {
        return memory::plain(path);
    }
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// The current folder.
pub fn current_dir() -> PathBuf {
    if IN_PAGE { memory::SAVED.into() } else { std::env::current_dir().unwrap_or_default() }
}

/// The user's own folder.
pub fn home() -> Option<PathBuf> {
    std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE")).map(PathBuf::from)
}

/// Makes the folder at `path`, and those that it lies in, if there is none.
///
/// # Errors
/// If it cannot be made.
pub fn create_dir_all(path: &Path) -> io::Result<()> {
    if is_in_memory(path) { memory::lock().make_folders(path) } else { fs::create_dir_all(path) }
}

/// Removes the file at `path`.
///
/// # Errors
/// If there is none, or it cannot be removed.
pub fn remove_file(path: &Path) -> io::Result<()> {
    if is_in_memory(path) { memory::lock().remove_file(path) } else { fs::remove_file(path) }
}

/// Removes the empty folder at `path`.
///
/// # Errors
/// If it is not empty, or cannot be removed.
pub fn remove_dir(path: &Path) -> io::Result<()> {
    if is_in_memory(path) { memory::lock().remove_folder(path) } else { fs::remove_dir(path) }
}

/// Moves a file to the place of another one.
///
/// # Errors
/// If it cannot be moved.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    if is_in_memory(to) { memory::lock().rename(from, to) } else { fs::rename(from, to) }
}

/// Adds `line` to the end of the file at `path`, in one go, so that several programs may do it at a time.
///
/// # Errors
/// If it cannot be written.
pub fn append(path: &Path, line: &[u8]) -> io::Result<()> {
    if is_in_memory(path) {
        let mut bytes = read(path).unwrap_or_default();
        bytes.extend_from_slice(line);
        return memory::lock().insert(path, bytes.into());
    }
    disk::append(path, line)
}

/// Writes `bytes` to `path`, whole or not at all. Links and permissions are kept; a device gets the bytes.
///
/// # Errors
/// If the folder is not there or cannot be written to, or there is no room.
pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if is_in_memory(path) { memory::lock().insert(path, bytes.to_vec().into()) } else { disk::save(path, bytes) }
}

/// Writes everything that `reader` delivers to the new file at `path`.
///
/// # Errors
/// If reading or writing fails.
pub fn write_from(path: &Path, reader: &mut dyn Read) -> io::Result<()> {
    if is_in_memory(path) {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes)?;
        return memory::lock().insert(path, bytes.into());
    }
    io::copy(reader, &mut fs::File::create(path)?).map(drop)
}

/// A file that is being made, and takes its place once it is whole; until then it is a temporary file.
pub struct Unfinished {
    // Removed when it is dropped.
    _folder: temporary::Folder,
    file: PathBuf,
    target: PathBuf,
}

impl Unfinished {
    /// Prepares the file `target`; `-` is standard output.
    ///
    /// # Errors
    /// If no temporary folder can be made beside it.
    pub fn new(target: &Path) -> io::Result<Self> {
        // A link keeps pointing where it points.
        let target = match target == Path::new(disk::STANDARD_OUTPUT) {
            true => target.to_owned(),
            false => canonicalize(target).unwrap_or_else(|_| target.to_owned()),
        };
        let folder = temporary::folder(&disk::place_beside(&target))?;
        let file = folder.path().join("unfinished");
        Ok(Self { _folder: folder, file, target })
    }

    /// Where it is to be written.
    pub fn path(&self) -> &Path {
        &self.file
    }

    /// Puts it in its place.
    ///
    /// # Errors
    /// If it cannot be moved there, or a device does not take it.
    pub fn settle(self) -> io::Result<()> {
        if is_in_memory(&self.target) {
            rename(&self.file, &self.target)
        } else {
            disk::settle(&self.file, &self.target)
        }
    }
}

/// The folder that holds `path`, never empty.
fn parent(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
