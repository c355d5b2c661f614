//! Files held in memory: a tree of folders by path, with the errors that a disk would give.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io;
use std::ops::Bound;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Facts, Kind};

/// The most that all files may hold together, in bytes.
pub const MOST_BYTES: u64 = 1 << 30;

/// The folder of everything that was given to a page.
pub(super) const GIVEN: &str = "/given";
/// The folder in which a page writes what it saves.
pub(super) const SAVED: &str = "/saved";
/// The folder of copies in another form, at the paths of their originals.
pub(super) const DECODED: &str = "/decoded";

static TREE: Mutex<Tree> = Mutex::new(Tree::new(MOST_BYTES));

/// The files of the program.
pub(super) fn lock() -> MutexGuard<'static, Tree> {
    TREE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The content of a file, shared by all that read it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bytes(Arc<Vec<u8>>);

impl Bytes {
    pub(super) fn into_vec(self) -> Vec<u8> {
        Arc::unwrap_or_clone(self.0)
    }

    fn size(&self) -> u64 {
        self.0.len() as u64
    }
}

impl From<Vec<u8>> for Bytes {
    fn from(bytes: Vec<u8>) -> Self {
        Self(Arc::new(bytes))
    }
}

impl AsRef<[u8]> for Bytes {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

/// The absolute path without `.` and `..`.
pub(super) fn plain(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::from("/"), |mut plain, part| {
        match part {
            Component::ParentDir => drop(plain.pop()),
            Component::Normal(name) => plain.push(name),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
        plain
    })
}

#[derive(Debug)]
enum Node {
    Folder,
    File(Bytes),
}

/// Folders and files by their plain paths. The root is always there.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: BTreeMap<PathBuf, Node>,
    bytes: u64,
    most_bytes: u64,
}

impl Tree {
    const fn new(most_bytes: u64) -> Self {
        Self { nodes: BTreeMap::new(), bytes: 0, most_bytes }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// How many more bytes there is room for.
    pub(super) fn room(&self) -> u64 {
        self.most_bytes.saturating_sub(self.bytes)
    }

    fn node(&self, path: &Path) -> io::Result<&Node> {
        match self.nodes.get(path) {
            Some(node) => Ok(node),
            None if path == Path::new("/") => Ok(&Node::Folder),
            None if path.ancestors().any(|above| matches!(self.nodes.get(above), Some(Node::File(_)))) => {
                Err(io::ErrorKind::NotADirectory.into())
            }
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }

    fn check_folder(&self, path: &Path) -> io::Result<()> {
        match self.node(path)? {
            Node::Folder => Ok(()),
            Node::File(_) => Err(io::ErrorKind::NotADirectory.into()),
        }
    }

    pub(super) fn canonicalize(&self, path: &Path) -> io::Result<PathBuf> {
        let path = plain(path);
        self.node(&path).map(|_| ())?;
        Ok(path)
    }

    pub(super) fn facts(&self, path: &Path) -> io::Result<Facts> {
        let (kind, size) = match self.node(&plain(path))? {
            Node::Folder => (Kind::Folder, 0),
            Node::File(bytes) => (Kind::File, bytes.size()),
        };
        Ok(Facts { kind, size, node: None })
    }

    pub(super) fn file(&self, path: &Path) -> io::Result<Bytes> {
        match self.node(&plain(path))? {
            Node::File(bytes) => Ok(bytes.clone()),
            Node::Folder => Err(io::ErrorKind::IsADirectory.into()),
        }
    }

    /// The plain paths of everything below the folder at `path`.
    pub(super) fn below(&self, path: &Path) -> impl Iterator<Item = &Path> {
        let folder = plain(path);
        let behind = (Bound::Excluded(folder.clone()), Bound::Unbounded);
        self.nodes.range(behind).map(|(path, _)| &**path).take_while(move |path| path.starts_with(&folder))
    }

    /// The names in the folder at `path`, in order.
    pub(super) fn names(&self, path: &Path) -> io::Result<Vec<OsString>> {
        let folder = plain(path);
        self.check_folder(&folder)?;
        let children = self.below(&folder).filter(|path| path.parent() == Some(&*folder));
        Ok(children.filter_map(|path| path.file_name().map(OsString::from)).collect())
    }

    /// Puts a file at `path`, and replaces an existing one.
    pub(super) fn insert(&mut self, path: &Path, bytes: Bytes) -> io::Result<()> {
        let path = plain(path);
        path.parent().map_or(Ok(()), |folder| self.check_folder(folder))?;
        let replaced = match self.node(&path) {
            Ok(Node::Folder) => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(Node::File(old)) => old.size(),
            Err(_) => 0,
        };
        if bytes.size() > self.room() + replaced {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.bytes = self.bytes - replaced + bytes.size();
        self.nodes.insert(path, Node::File(bytes));
        Ok(())
    }

    pub(super) fn make_folders(&mut self, path: &Path) -> io::Result<()> {
        let path = plain(path);
        let mut folders: Vec<&Path> = path.ancestors().filter(|folder| *folder != Path::new("/")).collect();
        while let Some(folder) = folders.pop() {
            match self.node(folder) {
                Ok(_) => self.check_folder(folder)?,
                Err(_) => drop(self.nodes.insert(folder.to_owned(), Node::Folder)),
            }
        }
        Ok(())
    }

    pub(super) fn remove_file(&mut self, path: &Path) -> io::Result<()> {
        self.file(path).map(drop)?;
        self.remove_all(path);
        Ok(())
    }

    pub(super) fn remove_folder(&mut self, path: &Path) -> io::Result<()> {
        if !self.names(path)?.is_empty() {
            return Err(io::ErrorKind::DirectoryNotEmpty.into());
        }
        self.remove_all(path);
        Ok(())
    }

    /// Removes what is at `path`, with everything in it.
    pub(super) fn remove_all(&mut self, path: &Path) {
        let path = plain(path);
        let mut removed: Vec<PathBuf> = self.below(&path).map(Path::to_owned).collect();
        removed.push(path);
        for path in removed {
            if let Some(Node::File(bytes)) = self.nodes.remove(&path) {
                self.bytes -= bytes.size();
            }
        }
    }

    pub(super) fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
        let bytes = self.file(from)?;
        let (from, to) = (plain(from), plain(to));
        if from == to {
            return Ok(());
        }
        to.parent().map_or(Ok(()), |folder| self.check_folder(folder))?;
        if matches!(self.node(&to), Ok(Node::Folder)) {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        self.remove_all(&from);
        self.insert(&to, bytes)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// The outcome in words that are the same for a tree and a disk.
    fn words<T: std::fmt::Debug>(outcome: io::Result<T>) -> String {
        outcome.map_or_else(|error| error.kind().to_string(), |value| format!("{value:?}"))
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_tree_does_what_a_disk_does() {
        let root = tempfile::tempdir().unwrap();
        let mut tree = Tree::new(99);
        tree.make_folders(root.path()).unwrap();
        let at = |name: &str| root.path().join(name);
        let sorted = |path: PathBuf| {
            fs::read_dir(path).map(|entries| {
                let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
                names.sort();
                names
            })
        };
        for name in ["a", "a/b", "a/b/c", "gone/b", "f", ".", "./a.b", "f/../f/h", "f/g/.."] {
            let path = at(name);
            assert_eq!(words(tree.insert(&path, vec![7; 3].into())), words(fs::write(&path, [7; 3])), "write {name}");
            assert_eq!(words(tree.make_folders(&at("f/g"))), words(fs::create_dir_all(at("f/g"))));
            assert_eq!(words(tree.file(&path).map(Bytes::into_vec)), words(fs::read(&path)), "read {name}");
            assert_eq!(words(tree.names(&path)), words(sorted(path.clone())), "list {name}");
            assert_eq!(tree.facts(&path).is_ok(), path.exists(), "{name}");
        }
        for name in ["f", "a", "f/g", "gone", "a.b"] {
            assert_eq!(words(tree.remove_file(&at(name))), words(fs::remove_file(at(name))), "remove {name}");
            assert_eq!(words(tree.remove_folder(&at(name))), words(fs::remove_dir(at(name))), "remove folder {name}");
        }
        assert_eq!(words(tree.names(root.path())), words(sorted(root.path().into())));
        tree.remove_all(root.path());
        assert_eq!((tree.bytes, tree.room()), (0, 99));
    }

    #[test]
    fn what_would_not_fit_is_refused_and_changes_nothing() {
        let mut tree = Tree::new(10);
        let at = Path::new("/a");
        tree.insert(at, vec![1; 8].into()).unwrap();
        assert_eq!(tree.insert(Path::new("/b"), vec![2; 3].into()).unwrap_err().kind(), io::ErrorKind::StorageFull);
        tree.insert(at, vec![3; 10].into()).unwrap();
        assert_eq!((tree.room(), tree.file(at).unwrap().as_ref()), (0, &[3; 10][..]));
        tree.rename(at, Path::new("/c")).unwrap();
        assert_eq!((tree.room(), tree.file(at).is_err()), (0, true));
        tree.remove_all(Path::new("/"));
        assert!(tree.is_empty() && tree.room() == 10);
    }
}
