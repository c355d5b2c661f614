//! The list of files in a folder that Motionscope wrote and that are unchanged since.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use motionscope_core::base::Error;

use super::save;
use crate::files;

/// The file with the list; hidden, so that it is not part of the clip.
const NAME: &str = ".motionscope-clip";

/// The files of a folder: relative paths with `/`, and a hash of their content.
#[derive(Debug, Default, PartialEq)]
pub(super) struct WrittenFiles(BTreeMap<String, u64>);

impl WrittenFiles {
    /// Reads the list in `folder`; empty if there is none.
    pub(super) fn read(folder: &Path) -> Self {
        let text = files::read_to_string(&folder.join(NAME)).unwrap_or_default();
        let entry = |line: &str| {
            let (hash, name) = line.split_once(' ')?;
            // A list from elsewhere must not lead out of the folder.
            let is_inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
            Some((name.to_owned(), u64::from_str_radix(hash, 16).ok().filter(|_| is_inside)?))
        };
        Self(text.lines().filter_map(entry).collect())
    }

    /// Writes the list into `folder`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn save(&self, folder: &Path) -> Result<(), Error> {
        let text: String = self.0.iter().map(|(name, hash)| format!("{hash:016x} {name}\n")).collect();
        save(&folder.join(NAME), text.as_bytes())
    }

    /// Notes that `bytes` are written as `name`.
    pub(super) fn note(&mut self, name: &str, bytes: &[u8]) {
        self.0.insert(name.into(), hash(bytes));
    }

    /// The names in order.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Whether there is a file called `name` in `folder` that somebody else wrote or changed.
    pub(super) fn is_foreign(&self, folder: &Path, name: &str) -> bool {
        let path = folder.join(name);
        let is_ours = |wanted: &u64| files::read(&path).is_ok_and(|bytes| hash(&bytes) == *wanted);
        files::is_taken(&path) && !self.0.get(name).is_some_and(is_ours)
    }

    /// Whether `name` was written.
    pub(super) fn contains(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }
}

/// FNV-1a with 64 bits (Fowler, Noll and Vo, 1991).
pub fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn what_was_changed_or_made_by_hand_is_foreign() {
        let folder = tempfile::tempdir().unwrap();
        let mut written = WrittenFiles::default();
        for name in ["gt.txt", "flow/a.flo", "b.png"] {
            fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
            fs::write(folder.path().join(name), name).unwrap();
            written.note(name, name.as_bytes());
        }
        fs::write(folder.path().join("other"), "x").unwrap();
        fs::write(folder.path().join("b.png"), "changed").unwrap();
        written.save(folder.path()).unwrap();
        let read = WrittenFiles::read(folder.path());
        assert_eq!(read, written);
        let foreign =
            ["gt.txt", "flow/a.flo", "b.png", "other", "flow", "gone"].map(|name| read.is_foreign(folder.path(), name));
        assert_eq!(foreign, [false, false, true, true, true, false]);
        fs::write(folder.path().join("flow").join(NAME), "0 ../gt.txt\n0 /gt.txt\nx gt.txt\ngt.txt\n").unwrap();
        assert_eq!(WrittenFiles::read(&folder.path().join("flow")), WrittenFiles::default());
        // The reference vector of FNV-1a.
        assert_eq!(hash(b"foobar"), 0x8594_4171_F739_67E8);
    }
}
