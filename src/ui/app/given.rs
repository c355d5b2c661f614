//! Choosing the clip among several files, and taking the files that are given to a page.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;

use super::App;
use crate::experiment::source::Source;
use crate::files::given::{self, Arrival, GivenFile};
use crate::files::{entries, is_dir, is_file};
use crate::media::{self, names};
use crate::session::Session;
use crate::session::lesson::{Address, Lesson};
use crate::ui::commands::Browse;

/// A session or a page of a lesson that could not be opened, because it names files that were not given with it.
pub(super) struct Incomplete {
    session: PathBuf,
    missing: Vec<PathBuf>,
}

impl Incomplete {
    /// That at `path`, if files are missing that it names.
    fn at(path: &Path) -> Option<Self> {
        given::folder_of(path)?;
        let pages = Address::parse(path.as_os_str()).and_then(|address| Lesson::load(address.file()?).ok());
        let sessions: Vec<Session> = match pages {
            Some(lesson) => lesson.pages.into_iter().filter_map(|page| page.session.ok()).collect(),
            None => Session::is_named(path).then(|| Session::load(path).ok()).flatten().into_iter().collect(),
        };
        let missing: Vec<PathBuf> = sessions.iter().flat_map(Session::missing_files).collect();
        (!missing.is_empty()).then(|| Self { session: path.to_owned(), missing })
    }

    /// Whether one of its files is among `files`.
    fn is_helped_by(&self, files: &[GivenFile]) -> bool {
        let wanted: Vec<_> = self.missing.iter().filter_map(|path| path.file_name()).collect();
        files.iter().any(|file| Path::new(&file.name).iter().any(|part| wanted.contains(&part)))
    }
}

impl App {
    /// Opens the files that were given to the page, if any have arrived.
    pub(super) fn receive_given(&mut self) {
        for Arrival { files, is_chosen } in given::arrivals() {
            let wanted = self.opening.chooser.take().filter(|_| is_chosen);
            match files.and_then(|files| self.taken(files)) {
                Ok(path) if matches!(wanted, Some(Browse::RightFile | Browse::RightFolder)) => {
                    self.open_right_view(path)
                }
                Ok(path) => self.open(path),
                Err(error) => self.toasts.fail(format!("Not opened: {error}.")),
            }
        }
    }

    /// Takes `files` and returns the path to open: one of them, or the session that had waited for them.
    fn taken(&mut self, files: Vec<GivenFile>) -> Result<OsString, Error> {
        if let Some(waiting) = self.opening.incomplete.as_ref().filter(|waiting| waiting.is_helped_by(&files))
            && let Some(folder) = given::folder_of(&waiting.session)
        {
            given::add(files, &folder)?;
            return Ok(self.opening.incomplete.take().map_or_else(|| folder.into(), |waiting| waiting.session.into()));
        }
        let folder = given::take(files)?;
        Ok(clip_in(&folder).unwrap_or_else(|| folder.into()))
    }

    /// Notes that files are missing that the session at `path` names, if that is why it could not be opened: they can be given next.
    pub(super) fn wait_for_files(&mut self, path: &Path) {
        self.opening.incomplete = Incomplete::at(path);
    }

    /// Gives back the memory of files that neither the open clip nor the open lesson needs.
    pub(super) fn keep_needed(&self) {
        let experiment = self.run.document.experiment();
        let lesson = self.course.lesson.as_ref().map(|open| open.address());
        let lesson = lesson.as_ref().and_then(|address| address.file());
        given::keep_only(experiment.source.paths().into_iter().chain(experiment.given.paths()).chain(lesson));
    }
}

/// The path to open for `files`: two pictures as a pair, in the order of their names, unless they are views of one moment; or else a
/// session, a clip, or any file.
pub(super) fn clip_of(mut files: Vec<PathBuf>) -> Option<OsString> {
    files.sort_by(|a, b| names::natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    let is_picture = |path: &PathBuf| is_file(path) && !Session::is_named(path) && !media::is_truth(path);
    if let [first, second] = files.as_slice()
        && [first, second].into_iter().all(is_picture)
        && media::right_view(first).as_ref() != Some(second)
        && let Ok(pair) = Source::pair(first.as_os_str(), second.as_os_str())
    {
        return Some(pair);
    }
    let rank = |path: &PathBuf| match () {
        () if is_session(path) => 0,
        () if is_dir(path) || media::is_clip(path) => 1,
        () => 2,
    };
    files.into_iter().min_by_key(rank).map(OsString::from)
}

/// The path to open among all files in `folder` and the folders in it: a session, the outermost clip or folder of pictures, or any file.
fn clip_in(folder: &Path) -> Option<OsString> {
    let folders = folders_in(folder);
    let all = || folders.iter().flat_map(|inner| sorted(inner).into_iter().filter(|path| is_file(path)));
    if let Some(session) = all().find(|path| is_session(path)) {
        return Some(session.into());
    }
    // Benchmarks have pictures of ground truth as well, in the same folder or in one of their own.
    let is_called_truth = |path: &Path| media::is_called_truth(&names::file_name(path));
    let clips = |inner: &Path| -> Vec<PathBuf> {
        let (truth, clips): (Vec<_>, Vec<_>) =
            sorted(inner).into_iter().filter(|path| media::is_clip(path)).partition(|path| is_called_truth(path));
        if clips.is_empty() { truth } else { clips }
    };
    let holders = folders.iter().filter(|inner| !clips(inner).is_empty());
    match holders.min_by_key(|inner| is_called_truth(inner)) {
        Some(inner) if inner != folder && media::holds_pictures(inner) => Some(inner.into()),
        Some(inner) => clip_of(clips(inner)),
        None => clip_of(all().collect()),
    }
}

/// Whether the file at `path` is a session or a lesson: not every Markdown file is one.
fn is_session(path: &Path) -> bool {
    let lesson = || Address::parse(path.as_os_str()).and_then(|address| Lesson::load(address.file()?).ok());
    Session::is_named(path) || lesson().is_some()
}

/// `folder` and all folders in it, the outer ones first.
fn folders_in(folder: &Path) -> Vec<PathBuf> {
    let mut folders = vec![folder.to_owned()];
    let mut next = 0;
    while let Some(outer) = folders.get(next) {
        let inner = sorted(outer).into_iter().filter(|path| is_dir(path));
        folders.extend(inner.collect::<Vec<_>>());
        next += 1;
    }
    folders
}

/// The entries of `folder` that are not hidden, in natural order.
fn sorted(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<_> = entries(folder).filter(|path| !names::file_name(path).starts_with('.')).collect();
    paths.sort_by(|a, b| names::natural_order(&names::file_name(a), &names::file_name(b)));
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_pictures_are_a_clip_and_a_session_goes_first() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b, session] = ["f2.png", "f10.png", "one.motionscope"].map(|name| folder.path().join(name));
        [&a, &b, &session].into_iter().for_each(|file| std::fs::write(file, "").unwrap());
        let pair = Source::pair(a.as_os_str(), b.as_os_str()).unwrap();
        assert_eq!(clip_of(vec![b.clone(), a.clone()]), Some(pair));
        assert_eq!(clip_of(vec![session.clone(), a]), Some(session.into()));
        assert_eq!(clip_of(vec![b.clone()]), Some(b.into()));
        assert_eq!(clip_of(vec![]), None);
    }

    /// The path that is opened of files with these names, in the folder in which they were given.
    fn opened(names: &[&str]) -> String {
        let picture = media::export::png(2, 2, media::export::Pixels::Gray(&[0, 9, 0, 9])).unwrap();
        let content = |name: &str| match name.rsplit('.').next() {
            Some("png") => picture.clone(),
            Some("y4m") => b"YUV4MPEG2 W1 H1 Cmono\nFRAME\n\x10FRAME\n\x11".to_vec(),
            Some("flo") => b"PIEH".to_vec(),
            _ => b"1,1,10,20.5,30,40,1,1,0.9\n".to_vec(),
        };
        let files = names.iter().map(|name| GivenFile { name: (*name).into(), bytes: content(name).into() });
        let folder = given::take(files.collect()).unwrap();
        let path = clip_in(&folder).unwrap().to_string_lossy().into_owned();
        path.replace(&format!("{}/", folder.display()), "")
    }

    #[test]
    fn of_files_given_together_the_clip_is_opened() {
        for (names, wanted) in [
            (&["gt.txt", "zoo.y4m"][..], "zoo.y4m"),
            (&["a/gt.txt", "a/b.y4m"], "a/b.y4m"),
            (&["a/b.y4m", "c/x.motionscope"], "c/x.motionscope"),
            (&["f1.png", "f2.png", "f3.png"], "f1.png"),
            (&["f2.png", "f1.png"], "pair:f1.png|f2.png"),
            (&["a/f1.png", "a/f2.png", "a/.f3.png", "a/flow/f1.flo"], "a"),
            (&["MOT/det/det.txt", "MOT/gt/gt.txt", "MOT/img1/1.png", "MOT/img1/2.png"], "MOT/img1"),
            (&["K/disp_occ/0_10.png", "K/image_2/0_10.png", "K/image_2/0_11.png", "K/image_3/0_10.png"], "K/image_2"),
            (&["im2.png", "im6.png", "disp2.png", "disp6.png"], "im2.png"),
            (&["im2.png", "disp2.png"], "im2.png"),
            (&["mask1.png", "mask2.png"], "pair:mask1.png|mask2.png"),
            (&["gt.txt"], "gt.txt"),
        ] {
            assert_eq!(opened(names), wanted);
        }
    }
}
