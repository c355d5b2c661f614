//! Removal of temporary files that a process has left.
//!
//! The code that creates a temporary file removes it; a signal that ends the process removes all of them first. After a crash or a
//! power failure they are removed at the next start. To spare the files of running processes, each process lists the folders it uses
//! in a note that it keeps locked. The system releases the lock when the process ends: a note that can be locked belongs to a process
//! that has ended, and only files with its id are removed.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use motionscope_core::base::Error;

use super::{AT_WORK, PREFIX, at_work};

/// The extension of notes.
const NOTE: &str = "unfinished";
/// How long the end of the process waits for the removal started at its beginning.
const SWEEP: Duration = Duration::from_secs(1);
/// How long a signal waits for files that are being written or moved into place.
const WRITE: Duration = Duration::from_secs(2);

/// The run of this process, if one was begun.
static RUN: OnceLock<Run> = OnceLock::new();

/// The beginning of the names of temporary files in `folder`, which is noted; `None` if no run was begun.
pub(super) fn noted(folder: &Path) -> Option<String> {
    let run = RUN.get()?;
    let prefix = run.prefix();
    // A temporary folder is removed with everything in it.
    let is_inside =
        |part: std::path::Component<'_>| part.as_os_str().to_str().is_some_and(|part| part.starts_with(&prefix));
    if !folder.components().any(is_inside) {
        // Without a note a signal still finds it.
        run.note(folder).unwrap_or_default();
    }
    Some(prefix)
}

/// A run, until it is dropped.
pub struct Cleanup(Receiver<()>);

/// Begins the run of this process, which takes its notes in `storage`: sweeps what earlier ones have left, and cleans up when a signal
/// ends this one.
pub fn begin(storage: Option<PathBuf>) -> Cleanup {
    let notes = storage.map(|folder| folder.join("unfinished"));
    let (done, swept) = channel();
    if let Some(notes) = notes.clone() {
        // A folder that does not answer must not keep anybody waiting.
        let sweeper = move || {
            sweep(&notes).unwrap_or_default();
            drop(done);
        };
        drop(thread::Builder::new().name("sweep".into()).spawn(sweeper));
    }
    if RUN.set(Run::new(notes)).is_ok() {
        listen();
    }
    Cleanup(swept)
}

impl Drop for Cleanup {
    fn drop(&mut self) {
        let _at_work = at_work();
        // Hanging up says that it is swept.
        self.0.recv_timeout(SWEEP).unwrap_or_default();
        if let Some(run) = RUN.get() {
            run.end();
        }
    }
}

/// Who makes unfinished things.
struct Run {
    mark: String,
    /// Where notes are taken, if there is such a place.
    notes: Option<PathBuf>,
    taken: Mutex<Taken>,
}

/// What a run has noted.
#[derive(Default)]
struct Taken {
    folders: BTreeSet<PathBuf>,
    /// The note with its lock.
    file: Option<File>,
}

impl Run {
    fn new(notes: Option<PathBuf>) -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        // No two runs of one computer have one number at one time.
        let mark = format!("{:x}x{:x}", std::process::id(), now.as_nanos());
        Self { mark, notes, taken: Mutex::default() }
    }

    fn prefix(&self) -> String {
        format!("{PREFIX}{}-", self.mark)
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that unfinished things will lie in `folder`.
    fn note(&self, folder: &Path) -> io::Result<()> {
        let folder = std::path::absolute(folder)?;
        let mut taken = self.taken();
        if !taken.folders.insert(folder.clone()) {
            return Ok(());
        }
        let (Some(notes), Some(name)) = (&self.notes, folder.to_str()) else { return Ok(()) };
        if taken.file.is_none() {
            taken.file = Some(open_note(notes, &self.mark)?);
        }
        // A path may hold the end of a line.
        let line = serde_json::to_string(name)? + "\n";
        taken.file.as_mut().map_or(Ok(()), |file| file.write_all(line.as_bytes()))
    }

    /// Removes everything unfinished.
    fn clean_up(&self) {
        let folders = self.taken().folders.clone();
        for folder in folders {
            // A thread that is still writing may be in the way.
            let is_clean = (0..20).any(|_| {
                let is_clean = remove_marked(&folder, &self.prefix()).is_ok_and(|found| found == 0);
                if !is_clean {
                    thread::sleep(Duration::from_millis(5));
                }
                is_clean
            });
            log_left(&folder, is_clean);
        }
    }

    /// Nothing is unfinished any more.
    fn end(&self) {
        let mut taken = self.taken();
        if let (Some(file), Some(notes)) = (taken.file.take(), &self.notes) {
            drop(file);
            fs::remove_file(note_path(notes, &self.mark)).unwrap_or_default();
        }
    }
}

fn log_left(folder: &Path, is_clean: bool) {
    if !is_clean {
        // The next start tries again.
        eprintln!("{}", Error::new(format!("temporary files are left in {}", folder.display())));
    }
}

fn note_path(notes: &Path, mark: &str) -> PathBuf {
    notes.join(format!("{mark}.{NOTE}"))
}

/// A new note with its lock. It gets its name only when it is locked, so that nobody takes it for that of a run which is over.
fn open_note(notes: &Path, mark: &str) -> io::Result<File> {
    fs::create_dir_all(notes)?;
    let (new, path) = (notes.join(format!("{mark}.new")), note_path(notes, mark));
    let file = OpenOptions::new().create_new(true).write(true).open(&new)?;
    let named = file.try_lock().map_err(io::Error::from).and_then(|()| fs::rename(&new, &path));
    if named.is_err() {
        fs::remove_file(&new).unwrap_or_default();
    }
    named.map(|()| file)
}

/// Removes what runs have left that are over, by their notes.
fn sweep(notes: &Path) -> io::Result<()> {
    for entry in fs::read_dir(notes)? {
        let path = entry?.path();
        let mark = path.file_stem().and_then(|mark| mark.to_str()).filter(|mark| is_mark(mark));
        if let Some(mark) = mark.filter(|_| path.extension().is_some_and(|ending| ending == NOTE)) {
            // One that fails is tried again at the next start.
            sweep_one(&path, mark).unwrap_or_default();
        }
    }
    Ok(())
}

fn is_mark(mark: &str) -> bool {
    mark.len() > 16 && mark.chars().all(|c| c.is_ascii_alphanumeric())
}

fn sweep_one(path: &Path, mark: &str) -> io::Result<()> {
    let note = OpenOptions::new().read(true).write(true).open(path)?;
    if note.try_lock().is_err() {
        return Ok(());
    }
    for line in BufReader::new(&note).lines() {
        // The last line of a run that ended in the middle of it is cut off: nothing was made there yet.
        let Ok(folder) = serde_json::from_str::<PathBuf>(&line?) else { continue };
        match remove_marked(&folder, &format!("{PREFIX}{mark}-")) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    fs::remove_file(path)
}

/// Removes everything in `folder` whose name begins with `prefix`; gives how many there were.
fn remove_marked(folder: &Path, prefix: &str) -> io::Result<usize> {
    let mut found = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_name().to_str().is_some_and(|name| name.starts_with(prefix)) {
            found += 1;
            // What a link leads to is none of ours.
            match entry.file_type()?.is_dir() {
                true => fs::remove_dir_all(entry.path())?,
                false => fs::remove_file(entry.path())?,
            }
        }
    }
    Ok(found)
}

/// Has signals that end this process clean up first.
#[cfg(unix)]
fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let signals = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !is_ignored(*signal));
    let Ok(mut signals) = signal_hook::iterator::Signals::new(signals) else { return };
    let wait = move || {
        if let Some(signal) = signals.forever().next() {
            let begun = web_time::Instant::now();
            // Nobody waits for this lock: one who reads it may read it again.
            let _still = loop {
                match AT_WORK.try_write() {
                    Err(TryLockError::WouldBlock) if begun.elapsed() < WRITE => thread::sleep(Duration::from_millis(1)),
                    lock => break lock,
                }
            };
            if let Some(run) = RUN.get() {
                run.clean_up();
                run.end();
            }
            // Whoever waits for this process learns which signal has ended it.
            signal_hook::low_level::emulate_default_handler(signal).unwrap_or_default();
        }
    };
    // Without a thread the next start sweeps.
    drop(thread::Builder::new().name("signals".into()).spawn(wait));
}

/// Whether a signal was turned off by whoever started this process, as `nohup` and scripts do: then it stays so.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Where there are no such signals the next start sweeps.
#[cfg(not(unix))]
fn listen() {}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run that notes in `notes` and has made something unfinished in `folder`.
    fn run(notes: &Path, folder: &Path) -> Run {
        let run = Run::new(Some(notes.to_owned()));
        run.note(folder).unwrap();
        let made = folder.join(format!("{}a", run.prefix()));
        fs::create_dir(&made).unwrap();
        fs::write(made.join("frame_0000.png"), [0; 99]).unwrap();
        fs::write(folder.join(format!("{}b", run.prefix())), [0; 9]).unwrap();
        run
    }

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn what_a_run_left_is_swept_and_nothing_else() {
        let [notes, folder] = [0; 2].map(|_| tempfile::tempdir().unwrap());
        let (dead, alive) = (run(notes.path(), folder.path()), run(notes.path(), folder.path()));
        for other in [".motionscope-clip", ".motionscope-abc", "frame_0000.png"] {
            fs::write(folder.path().join(other), other).unwrap();
        }
        sweep(notes.path()).unwrap();
        assert_eq!(names(folder.path()), 7, "both runs are at work");
        // Its end, however it comes, gives the lock back.
        drop(dead);
        sweep(notes.path()).unwrap();
        assert_eq!((names(folder.path()), names(notes.path())), (5, 1));
        drop(alive);
        sweep(notes.path()).unwrap();
        assert_eq!((names(folder.path()), names(notes.path())), (3, 0));
    }

    #[test]
    fn what_is_unfinished_goes_and_the_note_with_it() {
        let [notes, folder] = [0; 2].map(|_| tempfile::tempdir().unwrap());
        let run = run(notes.path(), folder.path());
        run.note(folder.path()).unwrap();
        let note = fs::read_to_string(note_path(notes.path(), &run.mark)).unwrap();
        assert_eq!(note.lines().count(), 1, "{note}");
        run.clean_up();
        run.end();
        assert_eq!((names(folder.path()), names(notes.path())), (0, 0));
    }

    #[test]
    fn a_note_that_makes_no_sense_leads_nowhere() {
        let [notes, folder] = [0; 2].map(|_| tempfile::tempdir().unwrap());
        fs::write(folder.path().join(".motionscope-"), "x").unwrap();
        let line = serde_json::to_string(&folder.path().to_str().unwrap()).unwrap();
        let there = |name: &str, text: &str| fs::write(notes.path().join(name), text).unwrap();
        there(&format!(".{NOTE}"), &line);
        there(&format!("short.{NOTE}"), &line);
        there(&format!("1234567890abcdefx1.{NOTE}"), &format!("{line}\nno path\n\"/no/such/folder\"\n\"{}", "/cut"));
        there("other.txt", &line);
        sweep(notes.path()).unwrap();
        assert_eq!((names(folder.path()), names(notes.path())), (1, 3));
        assert!(sweep(&notes.path().join("gone")).is_err());
    }
}
