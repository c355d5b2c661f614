//! What a run that is ended by a signal, or by a crash, leaves behind.
#![cfg(unix)]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A folder for the output, and one for what the program remembers.
struct Place {
    out: tempfile::TempDir,
    data: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        Self { out: tempfile::tempdir().expect("a folder"), data: tempfile::tempdir().expect("a folder") }
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
        command.args(line.split_whitespace()).env("XDG_DATA_HOME", self.data.path());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    /// A run that writes a long clip, once it is in the middle of that.
    fn writes(&self) -> Child {
        let line = "synth traffic --set frames=500 --set width=320 --set height=240 --out";
        let run = self.command(line).arg(self.out.path()).spawn().expect("it starts");
        let begun = Instant::now();
        while !unfinished(self.out.path()).is_some_and(|draft| draft.join("frame_0002.png").exists()) {
            assert!(begun.elapsed() < Duration::from_secs(60), "nothing is written");
            thread::sleep(Duration::from_millis(5));
        }
        run
    }

    fn names(&self) -> Vec<PathBuf> {
        fs::read_dir(self.out.path()).expect("a folder").flatten().map(|entry| entry.path()).collect()
    }
}

fn unfinished(folder: &Path) -> Option<PathBuf> {
    let mut all = fs::read_dir(folder).expect("a folder").flatten();
    all.find(|entry| entry.file_name().to_string_lossy().starts_with(".motionscope-")).map(|entry| entry.path())
}

fn send(signal: &str, run: &Child) {
    let sent = Command::new("kill").args([signal, &run.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()));
}

#[test]
fn a_signal_ends_a_run_and_leaves_nothing() {
    for (name, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        let place = Place::new();
        let mut run = place.writes();
        send(name, &run);
        let status = run.wait().unwrap();
        assert_eq!(status.signal(), Some(number), "whoever waits learns what has ended it");
        assert!(place.names().is_empty(), "{name}: {:?}", place.names());
        let notes = place.data.path().join("motionscope/unfinished");
        assert_eq!(fs::read_dir(notes).unwrap().count(), 0, "{name}");
    }
}

#[test]
fn what_a_crash_leaves_is_swept_at_the_next_start_and_a_run_at_work_keeps_its_own() {
    let (place, other) = (Place::new(), Place::new());
    let mut crashed = place.writes();
    send("-KILL", &crashed);
    crashed.wait().unwrap();
    assert!(unfinished(place.out.path()).is_some(), "a crash leaves something");
    // Another one is at work, in a folder of its own and with the same memory.
    let at_work = Place { out: other.out, data: place.data };
    let mut alive = at_work.writes();
    let draft = unfinished(at_work.out.path()).unwrap();
    let before = fs::read_dir(&draft).unwrap().count();
    assert!(at_work.command("list").status().unwrap().success());
    assert_eq!(unfinished(place.out.path()), None, "it is swept");
    assert!(fs::read_dir(&draft).unwrap().count() >= before, "what is at work is left alone");
    send("-TERM", &alive);
    alive.wait().unwrap();
    assert!(at_work.names().is_empty());
}

#[test]
fn an_animation_that_a_crash_cuts_off_is_swept_at_the_next_start() {
    use std::os::unix::fs::PermissionsExt as _;
    let (place, programs) = (Place::new(), tempfile::tempdir().expect("a folder"));
    let ffmpeg = programs.path().join("ffmpeg");
    // It makes its file, and ends with the program that it works for.
    let script =
        "#!/bin/sh\nfor file; do :; done\n: > \"$file\"\nwhile kill -0 $PPID 2> /dev/null; do /bin/sleep 0.05; done\n";
    fs::write(&ffmpeg, script).expect("a file");
    fs::set_permissions(&ffmpeg, fs::Permissions::from_mode(0o755)).expect("a file");
    let mut export = place.command("export synth:pillar --estimator full-search --steps 2.1..2.2 --animation");
    export.arg(place.data.path().join("steps.mp4"));
    export.env("TMPDIR", place.out.path()).env("PATH", programs.path());
    let mut run = export.spawn().expect("it starts");
    let begun = Instant::now();
    while !unfinished(place.out.path()).is_some_and(|draft| draft.join("video").exists()) {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is encoded");
        thread::sleep(Duration::from_millis(5));
    }
    send("-KILL", &run);
    run.wait().unwrap();
    assert!(unfinished(place.out.path()).is_some(), "a crash leaves something");
    assert!(place.command("list").status().unwrap().success());
    assert_eq!(unfinished(place.out.path()), None, "it is swept");
}

#[test]
fn a_signal_that_was_turned_off_stays_so() {
    let place = Place::new();
    let program = env!("CARGO_BIN_EXE_motionscope");
    let line =
        format!("trap '' HUP; exec {program} synth traffic --set frames=40 --out {}", place.out.path().display());
    let mut shell = Command::new("sh");
    shell.args(["-c", &line]).env("XDG_DATA_HOME", place.data.path()).stdout(Stdio::null());
    let mut run = shell.spawn().unwrap();
    let begun = Instant::now();
    while unfinished(place.out.path()).is_none() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is written");
        thread::sleep(Duration::from_millis(2));
    }
    send("-HUP", &run);
    assert!(run.wait().unwrap().success(), "as with nohup");
    assert!(place.out.path().join("frame_0039.png").exists());
}
