//! A file, or standard input, that can be read at any place and never beyond what it holds.

use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use motionscope_core::base::Error;

use super::cannot_read;
use super::names::file_name;
use crate::files::{self, File, Kind};

/// Largest clip that is read from a pipe, in bytes.
const MAX_PIPE_BYTES: u64 = 1 << 30;
/// Largest text that is read, in bytes.
const MAX_TEXT_BYTES: u64 = 16 << 20;

/// The kind of readable object at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Node {
    /// A file with a length and a way back.
    File,
    /// A folder.
    Folder,
    /// A named pipe, or what a shell makes of `<( )`: it can be read once.
    Stream,
}

impl Node {
    /// Returns the kind of `path` without opening it, which could block.
    ///
    /// # Errors
    /// A sentence, without the path, if nothing is there, or if it is a device, a socket, or a virtual file as in `/proc`.
    pub(crate) fn of(path: &Path) -> Result<Self, Error> {
        match files::facts(path).map_err(|error| cannot_read(&error))?.kind {
            Kind::Folder => Ok(Self::Folder),
            Kind::File if is_virtual(path) => Err(refused("a virtual file of the operating system")),
            Kind::File => Ok(Self::File),
            Kind::Pipe => Ok(Self::Stream),
            Kind::Socket => Err(refused("a socket")),
            Kind::Device => Err(refused("a device")),
        }
    }
}

fn refused(what: &str) -> Error {
    Error::new(format!("it is {what}, not a regular file; give a file"))
}

/// Whether the file at `path` is part of Linux's view of itself: such files claim to be empty, or never end.
fn is_virtual(path: &Path) -> bool {
    let is_within = |whole: &Path| ["/proc", "/sys"].iter().any(|root| whole.starts_with(root));
    cfg!(target_os = "linux") && files::canonicalize(path).is_ok_and(|whole| is_within(&whole))
}

/// The text in the file at `path`, or what a pipe there delivers, without a byte-order mark.
///
/// # Errors
/// A sentence, without the path, if it cannot be read, is no text, or too large for one.
pub(crate) fn text(path: &Path) -> Result<String, Error> {
    text_within(path, MAX_TEXT_BYTES)
}

/// The same of at most `most_bytes` bytes.
///
/// # Errors
/// As [`text`].
pub(crate) fn text_within(path: &Path, most_bytes: u64) -> Result<String, Error> {
    Node::of(path)?;
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| cannot_read(&error))?;
    file.take(most_bytes).read_to_end(&mut bytes).map_err(|error| cannot_read(&error))?;
    if bytes.len() as u64 == most_bytes {
        return Err(Error::new(format!("it is larger than {} MiB; give another file", most_bytes >> 20)));
    }
    text_of(bytes)
}

/// Bytes as text. Windows puts a mark of the encoding in front, which is dropped.
pub(crate) fn text_of(bytes: Vec<u8>) -> Result<String, Error> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err(Error::new("it is text in UTF-16; save it as UTF-8"));
    }
    let text = String::from_utf8(bytes).map_err(|_| Error::new("it is not text in UTF-8"))?;
    Ok(text.strip_prefix(MARK).map(str::to_owned).unwrap_or(text))
}

/// The byte-order mark.
pub(crate) const MARK: char = '\u{FEFF}';

trait Bytes: Read + Seek + Send {}
impl<T: Read + Seek + Send> Bytes for T {}

/// Bytes that can be read at any place.
pub(crate) struct Input {
    name: String,
    len: u64,
    position: u64,
    bytes: BufReader<Box<dyn Bytes>>,
}

impl Input {
    /// The file at `path`; all of standard input if that is `-`.
    ///
    /// # Errors
    /// A sentence, without the file's name.
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        if path == Path::new("-") {
            return Self::pipe("standard input".into(), std::io::stdin().lock());
        }
        let node = Node::of(path)?;
        let file = File::open(path).map_err(|error| cannot_read(&error))?;
        if node == Node::Stream {
            return Self::pipe(file_name(path), file);
        }
        let size = file.size().map_err(|error| cannot_read(&error))?;
        Ok(Self::new(file_name(path), size, Box::new(file)))
    }

    fn pipe(name: String, reader: impl Read) -> Result<Self, Error> {
        let mut bytes = Vec::new();
        reader.take(MAX_PIPE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| cannot_read(&error))?;
        if bytes.len() as u64 > MAX_PIPE_BYTES {
            return Err(Error::new(format!(
                "the pipe holds more than {} MiB; save it to a file and open that",
                MAX_PIPE_BYTES >> 20
            )));
        }
        Ok(Self::memory(name, bytes))
    }

    /// Bytes in memory, called `name`.
    pub(crate) fn memory(name: String, bytes: Vec<u8>) -> Self {
        Self::new(name, bytes.len() as u64, Box::new(Cursor::new(bytes)))
    }

    fn new(name: String, len: u64, bytes: Box<dyn Bytes>) -> Self {
        Self { name, len, position: 0, bytes: BufReader::with_capacity(64 << 10, bytes) }
    }

    /// Name to show.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// How many bytes there are.
    pub(crate) fn len(&self) -> u64 {
        self.len
    }

    /// Fills `buffer` with the bytes from `offset` on.
    ///
    /// # Errors
    /// If there are not as many, or they cannot be read.
    pub(crate) fn read_into(&mut self, offset: u64, buffer: &mut [u8]) -> Result<(), Error> {
        self.check(offset, buffer.len() as u64)?;
        self.go_to(offset).and_then(|()| self.bytes.read_exact(buffer)).map_err(|error| cannot_read(&error))?;
        self.position = offset + buffer.len() as u64;
        Ok(())
    }

    /// The `count` bytes from `offset` on; nothing is allocated if there are not as many.
    ///
    /// # Errors
    /// If there are not as many, or they cannot be read.
    pub(crate) fn read(&mut self, offset: u64, count: u64) -> Result<Vec<u8>, Error> {
        self.check(offset, count)?;
        let count = usize::try_from(count).map_err(|_| Error::new("it is too large for this computer's memory"))?;
        let mut bytes = vec![0; count];
        self.read_into(offset, &mut bytes)?;
        Ok(bytes)
    }

    /// Up to `count` bytes from `offset` on: fewer where the end comes first.
    ///
    /// # Errors
    /// If they cannot be read.
    pub(crate) fn read_up_to(&mut self, offset: u64, count: u64) -> Result<Vec<u8>, Error> {
        self.read(offset.min(self.len), count.min(self.len.saturating_sub(offset)))
    }

    fn check(&self, offset: u64, count: u64) -> Result<(), Error> {
        if offset.checked_add(count).is_none_or(|end| end > self.len) {
            return Err(Error::new("the file is cut off; copy it again from its source, or record it completely"));
        }
        Ok(())
    }

    /// Moves within the buffer where possible.
    fn go_to(&mut self, offset: u64) -> std::io::Result<()> {
        let from = std::mem::replace(&mut self.position, offset);
        match i64::try_from(i128::from(offset) - i128::from(from)) {
            Ok(0) => Ok(()),
            Ok(ahead) if ahead.unsigned_abs() < (64 << 10) => self.bytes.seek_relative(ahead),
            _ => self.bytes.seek(SeekFrom::Start(offset)).map(|_| ()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_anywhere_and_never_beyond() {
        let bytes: Vec<u8> = (0..200_000_u32).map(|i| i as u8).collect();
        let mut input = Input::pipe("bytes".into(), bytes.as_slice()).unwrap();
        for offset in [0, 3, 199_990, 5, 70_000, 69_990, 1] {
            assert_eq!(input.read(offset, 7).unwrap(), bytes[offset as usize..][..7]);
        }
        assert!(input.read(199_999, 2).is_err());
        assert!(input.read(u64::MAX, 2).is_err());
        assert!(input.read(0, u64::MAX / 2).is_err());
        assert_eq!(input.read_up_to(199_999, 9).unwrap(), [bytes[199_999]]);
        assert!(input.read_up_to(u64::MAX, 9).unwrap().is_empty());
    }
}
