//! Sessions and lessons from elsewhere: files that they name outside of their folder, and those for which ffmpeg is started, are opened
//! only once the user agrees.
//!
//! A session or lesson is trusted if this program wrote it or the user agreed to it: for this run by its path, and for later ones by its
//! path and its content.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use motionscope_core::base::Error;

use super::{Session, folder_of};
use crate::files;
use crate::media::{self, export::hash};

static STATE: Mutex<State> =
    Mutex::new(State { all: false, files: BTreeSet::new(), refused: BTreeSet::new(), list: None });

/// What was agreed to.
struct State {
    /// Whether everything is trusted (`--trust`).
    all: bool,
    /// Sessions and lessons that are trusted in this run.
    files: BTreeSet<PathBuf>,
    /// Those that were refused when they were read last.
    refused: BTreeSet<PathBuf>,
    /// The list of those that are trusted in later runs too, if there is a place for it.
    list: Option<PathBuf>,
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps the list of what is trusted in later runs in `folder`.
pub fn keep_in(folder: Option<PathBuf>) {
    state().list = folder.map(|folder| folder.join("trusted"));
}

/// Trusts every session and lesson of this run.
pub fn trust_all() {
    state().all = true;
}

/// Trusts the session or lesson in `file`: in this run whatever becomes of it, and in later ones as long as it stays as it is.
pub fn trust(file: &Path) {
    let Ok(file) = files::canonicalize(file) else { return };
    let text = files::read(&file).unwrap_or_default();
    let mut state = state();
    if let Some(list) = &state.list {
        // Without the list it is asked again the next time.
        let _ = note(list, &line(&file, &text));
    }
    state.refused.remove(&file);
    state.files.insert(file);
}

fn note(list: &Path, line: &str) -> std::io::Result<()> {
    list.parent().map_or(Ok(()), files::create_dir_all)?;
    files::append(list, format!("{line}\n").as_bytes())
}

fn line(file: &Path, text: &[u8]) -> String {
    // A path may hold the end of a line.
    format!("{:016x} {:?}", hash(text), file)
}

fn is_trusted(file: &Path, text: &[u8]) -> bool {
    let Ok(file) = files::canonicalize(file) else { return false };
    let state = state();
    let is_listed = |list: &PathBuf| {
        let wanted = line(&file, text);
        files::read_to_string(list).is_ok_and(|list| list.lines().any(|line| line == wanted))
    };
    state.all || state.files.contains(&file) || state.list.as_ref().is_some_and(is_listed)
}

/// The files outside of the folder of `file` that `session`, which was read from it, names.
pub fn outside(session: &Session, file: &Path) -> Vec<PathBuf> {
    let folder = folder_of(file);
    session.paths().filter(|path| !is_inside(path, folder)).map(Path::to_path_buf).collect()
}

fn is_inside(path: &Path, folder: &Path) -> bool {
    // By the names first: a place on another computer is not even looked at.
    if !lexical(path).starts_with(lexical(folder)) {
        return false;
    }
    // A pattern of numbered pictures is no file itself, but its folder may be a link.
    let nearest = path.ancestors().find_map(|part| files::canonicalize(part).ok());
    match (nearest, files::canonicalize(folder)) {
        (Some(nearest), Ok(folder)) => nearest.starts_with(folder),
        // What is not there cannot be opened.
        _ => true,
    }
}

/// The absolute path without `.` and `..`.
fn lexical(path: &Path) -> PathBuf {
    let whole = files::absolute(path);
    whole.components().fold(PathBuf::new(), |mut path, part| {
        match part {
            Component::CurDir => {}
            Component::ParentDir => _ = path.pop(),
            part => path.push(part),
        }
        path
    })
}

/// Refuses the session or lesson in `file` with this `text` if it is not trusted and its `sessions` name files outside of its folder, or
/// videos that ffmpeg decodes.
///
/// # Errors
/// One sentence with the first of these files, or about one from which no clip can be read.
pub(super) fn check<'a>(file: &Path, text: &str, sessions: impl IntoIterator<Item = &'a Session>) -> Result<(), Error> {
    let sessions: Vec<&Session> = sessions.into_iter().collect();
    // In a page there are no files but those that were given by hand.
    let is_trusted = files::is_in_memory(file) || is_trusted(file, text.as_bytes());
    let refused = if is_trusted { None } else { refusal(file, &sessions) };
    if let Ok(file) = files::canonicalize(file) {
        let mut state = state();
        _ = if refused.is_some() { state.refused.insert(file) } else { state.refused.remove(&file) };
    }
    if let Some(what) = refused {
        let how = "if you trust it, agree to that (on the command line with --trust)";
        return Err(Error::new(format!("it {what}; {how}")));
    }
    sessions.iter().flat_map(|session| session.paths()).try_for_each(media::check_is_file)
}

/// Returns the action of an untrusted session or lesson that needs consent, as a predicate; `None` if there is none.
fn refusal(file: &Path, sessions: &[&Session]) -> Option<String> {
    let name = |path: &Path| Error::short_name(&path.display().to_string());
    let all: BTreeSet<PathBuf> = sessions.iter().flat_map(|session| outside(session, file)).collect();
    if let Some(first) = all.first() {
        let others = match all.len() - 1 {
            0 => String::new(),
            1 => " and 1 other file".into(),
            count => format!(" and {count} other files"),
        };
        return Some(format!("opens {}{others} outside of its own folder", name(first)));
    }
    // A file elsewhere is not touched before that is agreed to.
    let named: BTreeSet<&Path> = sessions.iter().flat_map(|session| session.paths()).collect();
    let video = named.into_iter().find(|path| media::needs_ffmpeg(path))?;
    Some(format!("has {} decoded by the ffmpeg of this computer", name(video)))
}

/// Whether the session or lesson in `file` was refused since it is not trusted.
pub fn is_asked(file: &Path) -> bool {
    files::canonicalize(file).is_ok_and(|file| state().refused.contains(&file))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn session(folder: &Path, keys: &str) -> PathBuf {
        let file = folder.join("a.motionscope");
        fs::write(&file, format!("motionscope = 1\n{keys}\nestimator = \"diamond\"\n")).unwrap();
        file
    }

    #[test]
    fn what_lies_outside_is_named_whatever_leads_there() {
        let place = tempfile::tempdir().unwrap();
        let [folder, other] = ["mine", "other"].map(|name| place.path().join(name));
        [&folder, &other].into_iter().for_each(|folder| fs::create_dir(folder).unwrap());
        fs::write(folder.join("in.y4m"), "").unwrap();
        fs::write(other.join("out.y4m"), "").unwrap();
        let whole = other.join("out.y4m");
        for (keys, is_outside) in [
            ("clip = \"in.y4m\"".to_owned(), false),
            ("clip = \"sub/../in.y4m\"".into(), false),
            ("clip = \"gone.y4m\"".into(), false),
            ("clip = \"synth:pillar\"".into(), false),
            ("clip = \"../mine/in.y4m\"".into(), false),
            ("clip = \"../other/out.y4m\"".into(), true),
            (format!("clip = {whole:?}"), true),
            ("clip = \"pair:in.y4m|../other/out.y4m\"".into(), true),
            ("clip = \"in.y4m\"\ntruth = \"../other/out.y4m\"".into(), true),
            ("clip = \"in.y4m\"\nright = \"../other/out.y4m\"".into(), true),
            ("clip = \"in.y4m\"\ncalibration = \"../other/out.y4m\"".into(), true),
            ("clip = \"in.y4m\"\ndepths = \"../other\"".into(), true),
        ] {
            let file = session(&folder, &keys);
            let text = fs::read_to_string(&file).unwrap();
            let read = Session::parse(&text, &folder).unwrap();
            assert_eq!(!outside(&read, &file).is_empty(), is_outside, "{keys}");
            assert_eq!(Session::load(&file).is_err(), is_outside, "{keys}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&whole, folder.join("link.y4m")).unwrap();
            assert!(Session::load(&session(&folder, "clip = \"link.y4m\"")).is_err());
        }
        // A video that only ffmpeg may know is asked about as well, a picture is not.
        fs::write(folder.join("odd.video"), [0, 1, 2, 3]).unwrap();
        let error = Session::load(&session(&folder, "clip = \"odd.video\"")).err().expect("asked about").to_string();
        assert!(error.contains("ffmpeg") && error.contains("--trust"), "{error}");
        image::RgbImage::new(4, 4).save(folder.join("a.png")).unwrap();
        assert!(Session::load(&session(&folder, "clip = \"a.png\"")).is_ok());
        let file = session(&folder, "clip = \"../other/out.y4m\"");
        assert!(Session::load(&file).is_err() && is_asked(&file));
        trust(&file);
        assert!(!is_asked(&file) && Session::load(&file).is_ok());
    }
}
