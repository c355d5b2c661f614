//! H.264 video in an MP4 file, by the user's own ffmpeg, which reads the pictures from a pipe.

use std::io::{self, Write as _};
use std::path::Path;
use std::process::{ChildStdin, Stdio};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Frame};

use super::save::save_file;
use crate::files::{self, temporary};
use crate::media::Progress;
use crate::media::helper::{Watched, program, read_messages};

/// Frames per second of a clip whose rate is not known.
const USUAL_HZ: f64 = 25.0;

/// The longest that ffmpeg may take for a picture, or to finish the file behind the last one.
const PATIENCE: Duration = Duration::from_secs(300);

/// How long its messages are waited for once it has ended.
const ENDING: Duration = Duration::from_secs(1);

/// A video that is to be encoded.
pub(super) struct Video {
    /// What it is called in errors: `animation`.
    pub what: &'static str,
    /// What can be done without ffmpeg: `save as .gif`.
    pub instead: &'static str,
    /// Width and height in px.
    pub size: [usize; 2],
    /// Frames per second.
    pub rate_hz: f64,
    /// The constant rate factor of x264: a larger one makes a smaller file with more loss.
    pub crf: u32,
}

/// The input of ffmpeg.
pub(super) struct Pipe<'a> {
    video: &'a Video,
    input: ChildStdin,
    watched: &'a Watched,
}

impl Pipe<'_> {
    /// Appends a picture: rows of RGB.
    ///
    /// # Errors
    /// If ffmpeg has ended.
    pub fn put(&mut self, rgb: &[u8]) -> Result<(), Error> {
        let _writing = self.watched.expect_progress();
        self.input.write_all(rgb).map_err(|error| self.video.failed(&error))
    }
}

impl Video {
    /// Encodes the pictures that `pour` puts into the pipe; for a short video, which is whole in memory.
    ///
    /// # Errors
    /// As [`Video::write`].
    pub fn encode(
        &self,
        progress: Option<&dyn Progress>,
        pour: impl FnOnce(&mut Pipe<'_>) -> Result<(), Error>,
    ) -> Result<Vec<u8>, Error> {
        let folder = temporary::folder(&temporary::place()).map_err(|error| self.failed(&error))?;
        let file = folder.path().join("video");
        self.write(&file, progress, pour)?;
        files::read(&file).map_err(|error| self.failed(&error))
    }

    /// Encodes the pictures that `pour` puts into the pipe as the new file `file`, whatever its extension.
    ///
    /// # Errors
    /// If there is no ffmpeg, it cannot encode H.264, or `pour` failed or was cancelled.
    pub fn write(
        &self,
        file: &Path,
        progress: Option<&dyn Progress>,
        pour: impl FnOnce(&mut Pipe<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        // The table of an MP4 file is written last and moved to its front: that needs a file, not a pipe.
        let ([width, height], rate) = (self.size, ratio(self.rate_hz));
        let mut child = program("ffmpeg")
            .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-f", "rawvideo", "-pix_fmt", "rgb24"])
            .args(["-video_size", &format!("{width}x{height}"), "-framerate", &rate, "-i", "pipe:0"])
            // The chroma of 4:2:0 needs even sides; the matrix is that of high definition, and says so.
            .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709", "-colorspace", "bt709"])
            .args(["-c:v", "libx264", "-crf", &self.crf.to_string(), "-pix_fmt", "yuv420p", "-movflags", "+faststart"])
            .args(["-f", "mp4"])
            .arg(file)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| self.absent(&error))?;
        let (errors, input) = (child.stderr.take(), child.stdin.take());
        let (sender, said) = channel();
        thread::spawn(move || {
            let mut text = String::new();
            errors.into_iter().for_each(|errors| read_messages(errors, |piece| text.push_str(piece)));
            // Nobody waits for it any more where another process keeps the pipe open.
            sender.send(text).unwrap_or_default();
        });
        let watched = Watched::new(child, PATIENCE);
        // The pipe is closed behind the last picture.
        let poured = match input {
            Some(input) => pour(&mut Pipe { video: self, input, watched: &watched }),
            None => Err(self.failed(&"ffmpeg has no input")),
        };
        if poured.is_err() {
            // It may be at work still; what it made is thrown away.
            watched.end();
        }
        let status =
            watched.wait(&|| progress.is_some_and(Progress::cancelled)).map_err(|error| self.failed(&error))?;
        let said = said.recv_timeout(ENDING).unwrap_or_default();
        // The name of an unfinished file means nothing to anybody.
        let said = said.replace(&file.display().to_string(), "the file");
        if watched.is_late() {
            let why = format!("ffmpeg took nothing for {} s; {} instead", PATIENCE.as_secs(), self.instead);
            return Err(self.failed(&why));
        }
        let line = said.lines().map(str::trim).find(|line| !line.is_empty());
        let is_cancelled = progress.is_some_and(Progress::cancelled);
        match (poured, line) {
            // That says more than the pipe that broke.
            (_, Some(line)) if !status.success() && !is_cancelled => {
                Err(self.failed(&format!("ffmpeg says {line}; {} instead", self.instead)))
            }
            (Err(error), _) => Err(error),
            (Ok(()), _) if !status.success() => Err(self.failed(&format!("ffmpeg failed; {} instead", self.instead))),
            (Ok(()), _) => Ok(()),
        }
    }

    /// Says that it could not be made, and why.
    fn failed(&self, why: &dyn std::fmt::Display) -> Error {
        Error::new(format!("the MP4 {} could not be made: {why}", self.what))
    }

    /// Says what to do without ffmpeg.
    fn absent(&self, error: &io::Error) -> Error {
        match error.kind() {
            io::ErrorKind::NotFound => self.failed(&format!("it needs ffmpeg; install it, or {}", self.instead)),
            _ => self.failed(error),
        }
    }
}

/// A rate in frames per second as a fraction: whole rates, those of NTSC, whose decimals are rounded (29.97 is 30000/1001), or thousandths.
fn ratio(rate_hz: f64) -> String {
    // 23.976, 29.97 and 59.94 are a millionth off.
    let is = |wanted: f64| (rate_hz / wanted - 1.0).abs() < 2e-6;
    let (whole, ntsc) = (rate_hz.round(), (rate_hz * 1.001).round());
    match () {
        () if is(whole) => format!("{whole}/1"),
        () if is(ntsc / 1.001) => format!("{}/1001", 1000.0 * ntsc),
        () => format!("{}/1000", (1000.0 * rate_hz).round()),
    }
}

/// Writes the frames of `clip` as H.264 video into the MP4 file `path`. Gray levels change a little, and odd sides get a black row or
/// column.
///
/// # Errors
/// If a frame cannot be decoded, ffmpeg is missing or fails, the file cannot be written, or the work was cancelled.
pub fn video(clip: &Clip, path: &Path, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let (info, (width, height)) = (clip.info(), clip.size());
    let name = &info.name;
    let Some(frames) = info.frames else {
        return Err(Error::new(format!("{name} cannot be written: count its frames first")));
    };
    let rate_hz = info.fps.unwrap_or(USUAL_HZ);
    // Motion is estimated on it, so little may be lost.
    let video = Video { what: "video", instead: "save as numbered PNG", size: [width, height], rate_hz, crf: 8 };
    let pour = |pipe: &mut Pipe<'_>| {
        for t in 0..frames {
            if progress.is_some_and(Progress::cancelled) {
                return Err(Error::new(format!("saving {name} was cancelled after {t} of {frames} frames")));
            }
            progress.into_iter().for_each(|progress| progress.report(t as f32 / frames as f32));
            pipe.put(&rgb(&*clip.frame(t)?))?;
        }
        Ok(())
    };
    save_file(path, |file| video.write(file, progress, pour))
}

/// The pixels of a frame as rows of RGB.
fn rgb(frame: &Frame) -> Vec<u8> {
    match frame.color() {
        Some(rgb) => rgb.cells().as_flattened().to_vec(),
        None => frame.luma().cells().iter().flat_map(|gray| [*gray; 3]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;
    use std::sync::Mutex;

    use motionscope_core::geometry::Grid;
    use motionscope_core::synth;

    use super::*;
    use crate::media::{Open, open};

    /// Remembers what lies in a folder while a video is made there.
    struct Watching<'a> {
        folder: &'a Path,
        seen: Mutex<Vec<PathBuf>>,
    }

    impl Progress for Watching<'_> {
        fn report(&self, _fraction: f32) {
            let there = fs::read_dir(self.folder).unwrap().map(|entry| entry.unwrap().path());
            self.seen.lock().unwrap().extend(there);
        }

        fn cancelled(&self) -> bool {
            false
        }
    }

    /// Cancelled.
    struct Cancelled;

    impl Progress for Cancelled {
        fn report(&self, _fraction: f32) {}

        fn cancelled(&self) -> bool {
            true
        }
    }

    /// Whether there is an ffmpeg that encodes H.264.
    fn can_encode() -> bool {
        let listed = std::process::Command::new("ffmpeg").args(["-hide_banner", "-encoders"]).output();
        listed.is_ok_and(|listed| String::from_utf8_lossy(&listed.stdout).contains("libx264"))
    }

    #[test]
    fn a_clip_is_written_as_video_and_opens_again() {
        let mut difficulty = synth::SCENES[0].difficulty();
        (difficulty.frames, difficulty.width, difficulty.height) = (4, 97, 64);
        let made = synth::SCENES[0].clip(&difficulty).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        if !can_encode() {
            // Without it the same call says what to do.
            let said = video(&made, &path, None).unwrap_err().to_string();
            assert!(said.contains("save as numbered PNG") && !path.exists(), "{said}");
            return;
        }
        let cancelled = video(&made, &path, Some(&Cancelled)).unwrap_err().to_string();
        assert!(cancelled.contains("cancelled after 0 of 4 frames") && !path.exists(), "{cancelled}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left of it");
        let watching = Watching { folder: folder.path(), seen: Mutex::default() };
        video(&made, &path, Some(&watching)).unwrap();
        let seen = watching.seen.into_inner().unwrap();
        // A killed run leaves nothing else, and the next start removes that.
        assert!(seen.len() >= 4 && seen.iter().all(|path| temporary::is_temporary(path)), "{seen:?}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "the video alone is there");
        let read = open(&path, &Open::default()).unwrap().clip;
        assert_eq!((read.info().frames, read.size()), (Some(4), (98, 64)), "the width is made even");
        let (wanted, found) = (made.frame(2).unwrap(), read.frame(2).unwrap());
        let off = |y: usize| -> u32 {
            let pairs = wanted.luma().row(y).iter().zip(found.luma().row(y));
            pairs.map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
        };
        let mean = f64::from((0..64).map(off).sum::<u32>()) / f64::from(97 * 64);
        assert!(mean < 2.5, "gray levels change by {mean} on average");
    }

    #[test]
    fn rates_are_fractions_without_rounding_errors() {
        let rates = [12.0, 25.0, 29.97, f64::from(29.97_f32), 30_000.0 / 1001.0, 23.976, 59.94, 12.5, 1.0 / 3.0];
        let wanted = [
            "12/1",
            "25/1",
            "30000/1001",
            "30000/1001",
            "30000/1001",
            "24000/1001",
            "60000/1001",
            "12500/1000",
            "333/1000",
        ];
        assert_eq!(rates.map(ratio), wanted);
    }

    #[test]
    fn gray_frames_have_three_equal_channels() {
        let gray = Frame::gray(Grid::from_fn(2, 1, |x, _| 7 + x as u8));
        assert_eq!(rgb(&gray), [7, 7, 7, 8, 8, 8]);
    }
}
