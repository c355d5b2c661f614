//! Files given to a page by hand: dropped, chosen or pasted. Those given together lie in a folder of their own.

use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use motionscope_core::base::Error;

use super::memory::{self, Bytes, GIVEN, MOST_BYTES};
use super::{decoded, entries, exists, is_dir, is_in_memory};

/// A file as it was given.
#[derive(Clone, Debug)]
pub struct GivenFile {
    /// Its name, with the folders that were given with it: `frames/0001.png`.
    pub name: String,
    /// Its content.
    pub bytes: Bytes,
}

/// Files that were given together, or why they could not be taken.
#[derive(Debug)]
pub struct Arrival {
    /// The files.
    pub files: Result<Vec<GivenFile>, Error>,
    /// Whether the program had asked for them, by the browser's dialog.
    pub is_chosen: bool,
}

static ARRIVALS: Mutex<Vec<Arrival>> = Mutex::new(Vec::new());

/// Leaves files for the window.
pub fn arrive(arrival: Arrival) {
    ARRIVALS.lock().unwrap_or_else(PoisonError::into_inner).push(arrival);
}

/// Takes the files that have arrived since the last call.
pub fn arrivals() -> Vec<Arrival> {
    std::mem::take(&mut ARRIVALS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Refuses files of `bytes` bytes together if there is no room for them.
///
/// # Errors
/// One sentence with what fits.
pub fn check_room(bytes: u64) -> Result<(), Error> {
    if bytes <= memory::lock().room() {
        return Ok(());
    }
    let most = MOST_BYTES >> 20;
    Err(Error::new(format!(
        "the files have {} MiB, and a page holds at most {most} MiB at a time; give a shorter or smaller clip, or open it in the \
         desktop edition",
        bytes.div_ceil(1 << 20)
    )))
}

/// Takes `files` into a new folder, and returns it.
///
/// # Errors
/// If there are none, or there is no room for them; nothing is taken then.
pub fn take(files: Vec<GivenFile>) -> Result<PathBuf, Error> {
    static COUNT: AtomicUsize = AtomicUsize::new(1);
    let folder = Path::new(GIVEN).join(COUNT.fetch_add(1, Ordering::Relaxed).to_string());
    add(files, &folder).inspect_err(|_| memory::lock().remove_all(&folder))?;
    Ok(folder)
}

/// Takes `files` into the `folder` of earlier ones.
///
/// # Errors
/// If there are none, or there is no room for them.
pub fn add(files: Vec<GivenFile>, folder: &Path) -> Result<(), Error> {
    if files.is_empty() {
        return Err(Error::new("the folder has no files; give another one"));
    }
    check_room(files.iter().map(|file| file.bytes.as_ref().len() as u64).sum())?;
    let mut memory = memory::lock();
    for GivenFile { name, bytes } in files {
        let path = folder.join(inner_path(&name));
        let cannot = |error| Error::new(format!("{name} cannot be taken: {error}"));
        path.parent().map_or(Ok(()), |folder| memory.make_folders(folder)).map_err(cannot)?;
        memory.insert(&path, bytes).map_err(cannot)?;
    }
    Ok(())
}

/// The path of a given file within its folder.
fn inner_path(name: &str) -> PathBuf {
    let parts = Path::new(name).components().filter(|part| matches!(part, Component::Normal(_)));
    let path: PathBuf = parts.collect();
    if path.as_os_str().is_empty() { "file".into() } else { path }
}

/// The folder of the files that were given together with the one at `path`.
pub fn folder_of(path: &Path) -> Option<PathBuf> {
    if !is_in_memory(path) {
        return None;
    }
    let path = memory::plain(path);
    let number = path.strip_prefix(GIVEN).ok()?.components().next()?;
    Some(Path::new(GIVEN).join(number))
}

/// The name of the file at `path` as it was given, if it was.
pub fn name_of(path: &Path) -> Option<PathBuf> {
    memory::plain(path)
        .strip_prefix(folder_of(path)?)
        .ok()
        .map(Path::to_owned)
        .filter(|name| !name.as_os_str().is_empty())
}

/// The place of a file that another one of the same folder names by `path`. If it was given without the folders around it, or with
/// others, its name decides; of several the one with most of its folders.
pub fn find(path: PathBuf, beside: &Path) -> PathBuf {
    let is_there = is_in_memory(&path) && exists(&path);
    let Some(folder) = folder_of(beside).filter(|_| !is_there) else { return path };
    let wanted: Vec<Component<'_>> = path.components().rev().collect();
    let memory = memory::lock();
    let alike = |found: &Path| found.components().rev().zip(&wanted).take_while(|(a, b)| a == *b).count();
    let best = memory.below(&folder).map(|found| (alike(found), found)).filter(|(alike, _)| *alike > 0);
    // The first of equals.
    let best = best.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map_or(path, |(_, found)| found.to_owned())
}

/// Forgets all files except those that were given together with one of `paths`.
pub fn keep_only<'a>(paths: impl IntoIterator<Item = &'a Path>) {
    let kept: Vec<PathBuf> = paths.into_iter().filter_map(folder_of).collect();
    let all: Vec<PathBuf> = if exists(Path::new(GIVEN)) { entries(Path::new(GIVEN)).collect() } else { Vec::new() };
    let forgotten = all.into_iter().filter(|folder| is_dir(folder) && !kept.contains(folder));
    forgotten.for_each(|folder| forget(&folder));
}

/// Forgets the files in a `folder` of given ones, and their copies in another form.
pub(super) fn forget(folder: &Path) {
    let mut memory = memory::lock();
    memory.remove_all(folder);
    memory.remove_all(&decoded::copy_of(folder, ""));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(names: &[&str]) -> Vec<GivenFile> {
        names.iter().map(|name| GivenFile { name: (*name).into(), bytes: name.as_bytes().to_vec().into() }).collect()
    }

    #[test]
    fn names_lead_nowhere_else() {
        let folder = take(files(&["../a.png", "/b/c.png", "..", "./d.png"])).unwrap();
        for (name, inner) in [("../a.png", "a.png"), ("/b/c.png", "b/c.png"), ("..", "file"), ("./d.png", "d.png")] {
            let path = folder.join(inner);
            assert_eq!(super::super::read(&path).unwrap(), name.as_bytes());
            assert_eq!((folder_of(&path), name_of(&path)), (Some(folder.clone()), Some(inner.into())));
        }
        assert_eq!((folder_of(Path::new("/tmp/a.png")), name_of(&folder)), (None, None));
        assert!(take(Vec::new()).is_err());
    }

    #[test]
    fn a_file_is_found_by_its_name_wherever_it_was_given() {
        let folder = take(files(&["x.motionscope", "a.mp4", "clips/b.mp4", "other/b.mp4"])).unwrap();
        let session = folder.join("x.motionscope");
        for (named, found) in [
            ("a.mp4", "a.mp4"),
            ("../clips/a.mp4", "a.mp4"),
            ("/home/me/clips/b.mp4", "clips/b.mp4"),
            ("other/b.mp4", "other/b.mp4"),
            ("b.mp4", "clips/b.mp4"),
        ] {
            assert_eq!(find(folder.join(named), &session), folder.join(found), "{named}");
        }
        assert_eq!(find(folder.join("c.mp4"), &session), folder.join("c.mp4"));
        assert_eq!(find("/tmp/c.mp4".into(), Path::new("/tmp/x.motionscope")), Path::new("/tmp/c.mp4"));
    }

    #[test]
    fn more_than_fits_is_refused_with_a_way_out() {
        check_room(1000).unwrap();
        let why = check_room(3 << 30).unwrap_err().to_string();
        assert!(why.contains("3072 MiB") && why.contains("1024 MiB") && why.contains("desktop"), "{why}");
    }
}
