//! Copies of files in another form that a page has made and holds in memory, such as the frames of a video that the browser has decoded.
//! A copy is forgotten with its original.

use std::io;
use std::path::{Path, PathBuf};

use super::memory::{self, Bytes, DECODED};

/// The path of the copy `name` of the file at `path`.
pub fn copy_of(path: &Path, name: &str) -> PathBuf {
    let original = memory::plain(path);
    Path::new(DECODED).join(original.strip_prefix("/").unwrap_or(&original)).join(name)
}

/// Puts `bytes` at `copy`, a path of [`copy_of`].
///
/// # Errors
/// If there is no room for them.
pub fn keep(copy: &Path, bytes: Vec<u8>) -> io::Result<()> {
    let mut memory = memory::lock();
    copy.parent().map_or(Ok(()), |folder| memory.make_folders(folder))?;
    memory.insert(copy, Bytes::from(bytes))
}

/// Bytes that can still be kept.
pub fn room() -> u64 {
    memory::lock().room()
}

#[cfg(test)]
mod tests {
    use super::super::given::{self, GivenFile};
    use super::*;

    #[test]
    fn a_copy_is_forgotten_with_its_original() {
        let file = GivenFile { name: "a.webm".into(), bytes: vec![1].into() };
        let folder = given::take(vec![file]).unwrap();
        let copy = copy_of(&folder.join("a.webm"), "frames");
        keep(&copy, vec![2, 3]).unwrap();
        assert_eq!(super::super::read(&copy).unwrap(), [2, 3]);
        assert_eq!(given::folder_of(&copy), None, "it was not given");
        given::forget(&folder);
        assert!(!super::super::exists(&copy) && !super::super::exists(&folder));
    }
}
