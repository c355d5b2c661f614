//! Cameras through the user's own ffmpeg.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use motionscope_core::base::{Error, Stop};
use web_time::{Duration, Instant};

use super::devices::described;
use super::{CameraFeed, Cameras, Device, Format, OpenedFeed, Platform, Size, Stream, TestPicture};
use crate::media::helper::{self, Failure, Limits, Running, program};
use crate::media::video::ffmpeg::is_old;
use crate::work::Boxed;

/// Time that ffmpeg may take to list the cameras.
const LISTING: Duration = Duration::from_secs(10);
/// Bytes that it may print for that.
const MOST_BYTES: u64 = 1 << 20;
/// Time in which a process that closed its pipe ends by itself and says why.
const ENDING: Duration = Duration::from_millis(500);
/// How often a waiting thread looks.
const POLL: Duration = Duration::from_millis(10);
/// Frames per second that a camera is asked for.
const RATE: u32 = 30;

/// The cameras that ffmpeg reaches.
pub struct Ffmpeg {
    program: OsString,
    platform: Platform,
    /// Where Linux describes its cameras.
    described: PathBuf,
}

impl Default for Ffmpeg {
    fn default() -> Self {
        Self::new("ffmpeg", Platform::here(), "/sys/class/video4linux")
    }
}

impl Ffmpeg {
    /// The cameras that `program` reaches on a platform; `described` is the folder in which Linux describes them.
    pub fn new(program: impl Into<OsString>, platform: Platform, described: impl Into<PathBuf>) -> Self {
        Self { program: program.into(), platform, described: described.into() }
    }

    /// Returns the text that ffmpeg prints for `arguments`, errors included.
    fn printed(&self, arguments: &[&str], stop: &Stop) -> Result<String, Error> {
        let mut command = program(&self.program);
        command.args(arguments).stderr(Stdio::piped());
        let limits = Limits { time: LISTING, bytes: MOST_BYTES };
        let printed = helper::output(command, limits, &|| stop.check()).map_err(|failure| match failure {
            Failure::Unstarted(error) => unstarted(&error),
            Failure::Stopped(error) => error,
            Failure::Late => {
                Error::new("ffmpeg does not answer; unplug the camera, plug it in again and list it again")
            }
            Failure::Flooded => Error::new("ffmpeg answers without end; install it again (ffmpeg.org)"),
        })?;
        Ok([printed.output, printed.errors].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat())
    }

    fn cameras(&self) -> Result<Vec<Device>, Error> {
        let stop = Stop::default();
        // Also where the system describes its cameras, ffmpeg is needed to open them.
        self.version(&stop)?;
        let known = if self.platform == Platform::Linux { described(&self.described) } else { Vec::new() };
        if !known.is_empty() {
            return Ok(known);
        }
        Ok(self.platform.parse(&self.printed(self.platform.listing(), &stop)?))
    }

    fn version(&self, stop: &Stop) -> Result<String, Error> {
        let printed = self.printed(&["-version"], stop)?;
        Ok(printed.strip_prefix("ffmpeg version ").unwrap_or(&printed).to_owned())
    }
}

/// Why ffmpeg does not start, and what to do.
fn unstarted(error: &std::io::Error) -> Error {
    match error.kind() {
        ErrorKind::NotFound => Error::new(
            "cameras need ffmpeg, which is not installed; install it (ffmpeg.org) and start Motionscope again",
        ),
        _ => Error::new(format!("cameras need ffmpeg, which cannot be started ({error}); install it again")),
    }
}

impl Cameras for Ffmpeg {
    fn list(&self) -> Boxed<'_, (Vec<Device>, Option<Error>)> {
        Box::pin(async {
            let (mut all, error) = match self.cameras() {
                Ok(all) => (all, None),
                Err(error) => (Vec::new(), Some(error)),
            };
            all.push(Device::TestPicture);
            (all, error)
        })
    }

    fn open<'a>(&'a self, device: &'a Device, size: Size, stop: &'a Stop) -> Boxed<'a, OpenedFeed> {
        Box::pin(async move { self.start(device, size, stop) })
    }
}

impl Ffmpeg {
    fn start(&self, device: &Device, size: Size, stop: &Stop) -> OpenedFeed {
        let Device::Camera { name, address } = device else { return Ok(Box::new(TestPicture::new(size))) };
        let passthrough = if is_old(&self.version(stop)?) { "-vsync" } else { "-fps_mode" };
        let Size { width, height } = size;
        let mut command = program(&self.program);
        command.args(["-hide_banner", "-loglevel", "error", "-nostdin", "-fflags", "nobuffer"]);
        command.args(["-f", self.platform.input(), "-framerate", &RATE.to_string()]);
        command.args(["-video_size", &format!("{width}x{height}"), "-i", address, "-map", "0:v:0"]);
        command.args([passthrough, "passthrough", "-pix_fmt", "yuv420p", "-f", "yuv4mpegpipe", "-"]);
        let mut child = Running(command.stderr(Stdio::piped()).spawn().map_err(|error| unstarted(&error))?);
        let missing = || Error::new("ffmpeg does not answer; start Motionscope again");
        let (pipe, errors) = (child.0.stdout.take().ok_or_else(missing)?, child.0.stderr.take().ok_or_else(missing)?);
        let said = Arc::<Mutex<String>>::default();
        let messages = Arc::clone(&said);
        thread::spawn(move || {
            let keep = |piece: &str| messages.lock().unwrap_or_else(PoisonError::into_inner).push_str(piece);
            helper::read_messages(errors, keep);
        });
        let stream = Stream::new(pipe)?;
        Ok(Box::new(Pipe { stream, child, said, name: name.clone(), size, platform: self.platform }))
    }
}

/// The frames of a camera, and the process that sends them.
struct Pipe {
    stream: Stream,
    child: Running,
    said: Arc<Mutex<String>>,
    name: String,
    size: Size,
    platform: Platform,
}

impl Pipe {
    /// Why there are no frames: the message of ffmpeg, if it has ended, or else `error`.
    fn explained(&mut self, error: Option<Error>) -> Error {
        let begun = Instant::now();
        while matches!(self.child.0.try_wait(), Ok(None)) {
            if begun.elapsed() > ENDING {
                let why = error.unwrap_or_else(|| Error::new("it sends no more frames; plug it in again"));
                return Error::new(format!("{}: {why}", self.name));
            }
            thread::sleep(POLL);
        }
        // The last lines may be on their way.
        thread::sleep(POLL);
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Error::new(format!("{}: {}", self.name, reason(&said, self.size, self.platform)))
    }
}

impl CameraFeed for Pipe {
    fn begin<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
        Box::pin(async {
            self.stream.format(stop).map_err(|error| if stop.is_set() { error } else { self.explained(Some(error)) })
        })
    }

    fn next<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
        Box::pin(async {
            match self.stream.frame(stop) {
                Ok(Some(samples)) => Ok(Some(samples)),
                Err(error) if stop.is_set() => Err(error),
                // A camera has no end.
                ended => Err(self.explained(ended.err())),
            }
        })
    }
}

/// Why ffmpeg ended, and what to do, from the messages that it `said`.
fn reason(said: &str, Size { width, height }: Size, platform: Platform) -> String {
    let lower = said.to_lowercase();
    let says = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    if says(&["busy", "already in use", "could not run graph"]) {
        return "another program uses it; close that program, then choose the camera again".into();
    }
    if says(&["permission denied", "not permitted", "not authorized", "access is denied"]) {
        let way = match platform {
            Platform::Linux => "add your user to the group video (sudo usermod -aG video USER) and log in again",
            Platform::MacOs => "allow it in System Settings, Privacy & Security, Camera",
            Platform::Windows => "allow it in Settings, Privacy, Camera",
        };
        return format!("the system does not let Motionscope use it; {way}");
    }
    if says(&["unknown input format"]) {
        return format!("this ffmpeg was built without {}; install another build of ffmpeg", platform.input());
    }
    if says(&["unrecognized option", "option not found"]) {
        return "this ffmpeg does not know an option that cameras need; install a current ffmpeg".into();
    }
    if says(&["no such device", "could not find video device", "no such file", "video device not found"]) {
        return "it is not there; plug it in and list the cameras again".into();
    }
    if says(&["framerate", "frame rate"]) {
        return format!(
            "it does not send {RATE} frames/s at {width}×{height} px; choose another size, or another camera"
        );
    }
    if says(&["video size", "not supported", "invalid argument", "could not set video options"]) {
        return format!("it has no frames of {width}×{height} px at {RATE} frames/s; choose another size");
    }
    match said.lines().map(str::trim).find(|line| !line.is_empty()) {
        Some(line) => format!("ffmpeg stopped and says: {}", line.trim_end_matches('.')),
        None => "it sends no more frames; plug it in again and choose it again".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::work::finish;

    #[test]
    fn why_there_are_no_frames_is_told_with_a_way_out() {
        let of = |said, platform| reason(said, Size::default(), platform);
        for (said, way) in [
            ("[video4linux2,v4l2 @ 0x5] ioctl(VIDIOC_STREAMON): Device or resource busy", "another program uses it"),
            ("/dev/video0: Permission denied", "group video"),
            ("/dev/video0: No such file or directory", "plug it in"),
            ("[video4linux2,v4l2 @ 0x5] ioctl(VIDIOC_DQBUF): No such device", "plug it in"),
            ("/dev/video0: Invalid argument", "640×480 px"),
            ("Unknown input format: 'v4l2'", "without v4l2"),
            (
                "Unrecognized option 'fps_mode'.\nError splitting the argument list: Option not found",
                "a current ffmpeg",
            ),
            ("Something odd happened.\nmore", "says: Something odd happened"),
            ("", "sends no more frames"),
        ] {
            let why = of(said, Platform::Linux);
            assert!(why.contains(way) && !why.ends_with('.'), "{said}: {why}");
        }
        let selected = "[avfoundation @ 0x7] Selected video size (640x480) is not supported by the device.";
        assert!(of(selected, Platform::MacOs).contains("choose another size"));
        let rate = "[avfoundation @ 0x7] Selected framerate (30.000000) is not supported by the device.";
        assert!(of(rate, Platform::MacOs).contains("does not send 30 frames/s at 640×480 px"));
        let denied = "[avfoundation @ 0x7] Failed to create AV capture input device: not authorized";
        assert!(of(denied, Platform::MacOs).contains("Privacy & Security"));
        let graph =
            "[dshow @ 1] Could not run graph (sometimes caused by a device already in use by other application)";
        assert!(of(graph, Platform::Windows).contains("another program uses it"));
    }

    #[test]
    fn without_ffmpeg_the_test_picture_is_left() {
        let (all, error) = finish(Ffmpeg::new("no-such-ffmpeg", Platform::Linux, "/nowhere").list());
        assert_eq!(all, [Device::TestPicture]);
        assert!(error.is_some_and(|error| error.to_string().contains("install it (ffmpeg.org)")));
        let denied = unstarted(&ErrorKind::PermissionDenied.into()).to_string();
        assert!(denied.contains("cannot be started") && !denied.contains("not installed"), "{denied}");
    }

    #[cfg(unix)]
    #[test]
    fn opening_is_cancelled_while_ffmpeg_does_not_answer() {
        let (_folder, cameras) = fake_with("exec sleep 600", "");
        let (stop, begun) = (Stop::default(), Instant::now());
        stop.set(true);
        assert!(finish(cameras.open(&camera(), Size::default(), &stop)).is_err());
        assert!(begun.elapsed() < LISTING / 2, "{:?}", begun.elapsed());
    }

    /// An ffmpeg that is a script of the shell, in a folder of its own.
    #[cfg(unix)]
    fn fake(script: &str) -> (tempfile::TempDir, Ffmpeg) {
        fake_with("echo ffmpeg version 6.0; exit", script)
    }

    /// The same with another answer to the question for its version.
    #[cfg(unix)]
    fn fake_with(version: &str, script: &str) -> (tempfile::TempDir, Ffmpeg) {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ffmpeg");
        let version = format!("case \"$*\" in *-version*) {version};; esac");
        std::fs::write(&path, format!("#!/bin/sh\n{version}\n{script}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        (folder, Ffmpeg::new(path, Platform::Linux, "/nowhere"))
    }

    #[cfg(unix)]
    fn camera() -> Device {
        Device::Camera { name: "Webcam".into(), address: "/dev/video7".into() }
    }

    #[cfg(unix)]
    #[test]
    fn cameras_are_listed_and_read() {
        let script = "case \"$*\" in\n\
                      *-sources*) echo '  /dev/video7 [Webcam] (none)';;\n\
                      *'-f v4l2 -framerate 30 -video_size 640x480 -i /dev/video7'*-fps_mode*) \
                      printf 'YUV4MPEG2 W2 H1 Cmono\\nFRAME\\nabFRAME\\ncd';;\n\
                      *) echo \"$*\" >&2; exit 1;; esac";
        let (_folder, cameras) = fake(script);
        let (all, error) = finish(cameras.list());
        assert_eq!((all.as_slice(), error), (&[camera(), Device::TestPicture][..], None));
        let stop = Stop::default();
        let mut feed = finish(cameras.open(&all[0], Size::default(), &stop)).unwrap();
        assert_eq!(finish(feed.begin(&stop)).unwrap().size(), (2, 1));
        assert_eq!(finish(feed.next(&stop)), Ok(Some(b"ab".to_vec())));
        assert_eq!(finish(feed.next(&stop)), Ok(Some(b"cd".to_vec())));
        let ended = finish(feed.next(&stop)).unwrap_err().to_string();
        assert_eq!(ended, "Webcam: it sends no more frames; plug it in again and choose it again");
    }

    #[cfg(unix)]
    #[test]
    fn what_ffmpeg_says_is_told() {
        let (_folder, cameras) = fake("echo '/dev/video7: Device or resource busy' >&2; exit 1");
        let mut feed = finish(cameras.open(&camera(), Size::default(), &Stop::default())).unwrap();
        let said = finish(feed.begin(&Stop::default())).unwrap_err().to_string();
        assert!(said.starts_with("Webcam: another program uses it"), "{said}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_process_ends_with_its_feed() {
        let script = "echo $$ > \"$0.id\"; printf 'YUV4MPEG2 W2 H1 Cmono\\nFRAME\\nab'; exec sleep 600";
        let (folder, cameras) = fake(script);
        let feed = finish(cameras.open(&camera(), Size::default(), &Stop::default())).unwrap();
        let camera = super::super::Camera::start(feed, || {}).unwrap();
        assert!(finish(camera.wait_for(0, Duration::from_secs(10))).is_some());
        let id = std::fs::read_to_string(folder.path().join("ffmpeg.id")).unwrap();
        let process = PathBuf::from("/proc").join(id.trim());
        assert!(process.exists());
        camera.close(Duration::from_secs(10));
        assert!(!process.exists(), "nothing is left of it");
    }
}
