//! Programs of the user's that work for us, ffmpeg and ffprobe: bounded in time and output, and never left running.

use std::ffi::OsStr;
use std::io::{self, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;

use motionscope_core::base::Error;
use web_time::{Duration, Instant};

/// How often a waiting thread asks whether it should stop.
pub(in crate::media) const POLL: Duration = Duration::from_millis(10);
/// Bytes of messages on standard error that are kept.
const MOST_MESSAGE_BYTES: u64 = 64 << 10;

/// A program of the user's, without a console window of its own.
pub(in crate::media) fn program(name: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(name);
    #[cfg(windows)]
    {
        const CREATE_NO_WINDOW: u32 = 0x0800_0000;
        std::os::windows::process::CommandExt::creation_flags(&mut command, CREATE_NO_WINDOW);
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    command
}

/// A child process that does not outlive its owner.
pub(in crate::media) struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// How long a program may take, and how much it may print.
#[derive(Clone, Copy, Debug)]
pub(in crate::media) struct Limits {
    /// The time until its last byte.
    pub time: Duration,
    /// The most bytes on each of standard output and standard error.
    pub bytes: u64,
}

/// Why a program has no answer.
#[derive(Debug)]
pub(in crate::media) enum Failure {
    /// It cannot be started.
    Unstarted(io::Error),
    /// It took too long and was ended.
    Late,
    /// It printed too much and was ended.
    Flooded,
    /// The caller wanted to stop.
    Stopped(Error),
}

/// The output of a program.
#[derive(Debug, Default)]
pub(in crate::media) struct Printed {
    /// Its standard output.
    pub output: Vec<u8>,
    /// Its standard error, if `command` pipes it.
    pub errors: Vec<u8>,
}

/// Runs `command` until it has printed everything; `go_on` is asked again and again and ends it with an error.
///
/// # Errors
/// The reason why it has no answer. It is not running any more then.
pub(in crate::media) fn output(
    mut command: Command,
    limits: Limits,
    go_on: &dyn Fn() -> Result<(), Error>,
) -> Result<Printed, Failure> {
    let mut child = Running(command.spawn().map_err(Failure::Unstarted)?);
    let begun = Instant::now();
    let pipes = [child.0.stdout.take().map(boxed), child.0.stderr.take().map(boxed)];
    let (sender, read) = channel();
    for (index, pipe) in pipes.into_iter().enumerate().filter_map(|(index, pipe)| Some((index, pipe?))) {
        let sender = sender.clone();
        thread::spawn(move || {
            let mut bytes = Vec::new();
            // A pipe that breaks has printed what came before. If nobody waits any more, the process is being ended.
            let _ = pipe.take(limits.bytes + 1).read_to_end(&mut bytes);
            let _ = sender.send((index, bytes));
        });
    }
    drop(sender);
    let mut printed = [Vec::new(), Vec::new()];
    loop {
        go_on().map_err(Failure::Stopped)?;
        match read.recv_timeout(POLL) {
            Ok((_, bytes)) if bytes.len() as u64 > limits.bytes => return Err(Failure::Flooded),
            Ok((index, bytes)) => printed[index] = bytes,
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) if begun.elapsed() > limits.time => return Err(Failure::Late),
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
    let [output, errors] = printed;
    Ok(Printed { output, errors })
}

fn boxed(pipe: impl Read + Send + 'static) -> Box<dyn Read + Send> {
    Box::new(pipe)
}

/// Reads messages to the end, so that the program never waits for its reader, and hands the first ones over piece by piece.
pub(in crate::media) fn read_messages(errors: impl Read, mut keep: impl FnMut(&str)) {
    let mut errors = BufReader::new(errors);
    let mut piece = [0; 4096];
    let mut kept = errors.by_ref().take(MOST_MESSAGE_BYTES);
    while let Ok(count @ 1..) = kept.read(&mut piece) {
        keep(&String::from_utf8_lossy(&piece[..count]));
    }
    // A pipe that breaks has no more messages.
    let _ = io::copy(&mut errors, &mut io::sink());
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { time: Duration::from_secs(60), bytes: 1 << 20 };

    fn shell(script: &str) -> Command {
        let mut command = program("sh");
        command.args(["-c", script]).stderr(Stdio::piped());
        command
    }

    #[test]
    fn both_outputs_are_read_whatever_their_order() {
        let printed = output(shell("echo error >&2; echo one; echo more >&2"), LIMITS, &|| Ok(())).unwrap();
        assert_eq!((printed.output, printed.errors), (b"one\n".to_vec(), b"error\nmore\n".to_vec()));
        assert!(matches!(output(program("/no/such/program"), LIMITS, &|| Ok(())), Err(Failure::Unstarted(_))));
    }

    #[test]
    fn a_flood_a_silence_and_a_cancelled_program_are_ended() {
        let folder = tempfile::tempdir().unwrap();
        let own_id = folder.path().join("id");
        let with_id = |rest: &str| shell(&format!("echo $$ > {}; {rest}", own_id.display()));
        let short = Limits { time: Duration::from_millis(300), ..LIMITS };
        let stopped: &dyn Fn() -> Result<(), Error> =
            &|| if own_id.metadata().is_ok_and(|file| file.len() > 0) { Err(Error::new("enough")) } else { Ok(()) };
        let go_on: &dyn Fn() -> Result<(), Error> = &|| Ok(());
        for (script, limits, go_on, wanted) in [
            ("exec cat /dev/zero", LIMITS, go_on, "Flooded"),
            ("exec cat /dev/zero >&2", LIMITS, go_on, "Flooded"),
            ("exec sleep 600", short, go_on, "Late"),
            ("exec sleep 600", LIMITS, stopped, "Stopped"),
        ] {
            let begun = Instant::now();
            let failure = output(with_id(script), limits, go_on).expect_err(script);
            assert!(format!("{failure:?}").starts_with(wanted), "{script}: {failure:?}");
            assert!(begun.elapsed() < LIMITS.time, "{script}");
            let id = std::fs::read_to_string(&own_id).unwrap();
            let process = std::path::PathBuf::from("/proc").join(id.trim());
            assert!(!process.exists(), "{script} is still there");
            std::fs::remove_file(&own_id).unwrap();
        }
    }

    #[test]
    fn of_endless_messages_the_first_are_kept() {
        let mut kept = String::new();
        read_messages(io::repeat(b'x').take(10 << 20), |piece| kept.push_str(piece));
        assert_eq!(kept.len() as u64, MOST_MESSAGE_BYTES);
    }
}
