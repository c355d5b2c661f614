//! Encodes by the user's own ffmpeg, which reads the pictures from a pipe.

use std::io::{self, Write as _};
use std::path::Path;
use std::process::{ChildStdin, Stdio};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use motionscope_core::base::Error;

use super::Video;
use super::watched::Watched;
use crate::files::{self, temporary};
use crate::media::Progress;
use crate::media::helper::{program, read_messages};

/// The longest that ffmpeg may take for a picture, or to finish the file behind the last one.
const PATIENCE: Duration = Duration::from_secs(300);

/// How long its messages are waited for once it has ended.
const ENDING: Duration = Duration::from_secs(1);

/// The input of ffmpeg.
pub(in crate::media::export) struct Pipe<'a> {
    video: &'a Video,
    input: ChildStdin,
    watched: &'a Watched,
}

impl Pipe<'_> {
    /// Appends a picture `times` times: rows of RGB.
    ///
    /// # Errors
    /// If ffmpeg has ended.
    #[expect(clippy::unused_async, reason = "a page waits for its encoder")]
    pub async fn put(&mut self, rgb: &[u8], times: u32) -> Result<(), Error> {
        for _ in 0..times {
            let _writing = self.watched.expect_progress();
            self.input.write_all(rgb).map_err(|error| self.video.failed(&error))?;
        }
        Ok(())
    }
}

impl Video {
    /// Encodes the pictures that `pour` puts into the pipe; for a short video, which is whole in memory.
    ///
    /// # Errors
    /// As [`Video::write`].
    pub async fn encode(
        &self,
        progress: Option<&dyn Progress>,
        pour: impl AsyncFnOnce(&mut Pipe<'_>) -> Result<(), Error>,
    ) -> Result<Vec<u8>, Error> {
        let folder = temporary::folder(&temporary::place()).map_err(|error| self.failed(&error))?;
        let file = folder.path().join("video");
        self.write(&file, progress, pour).await?;
        files::read(&file).map_err(|error| self.failed(&error))
    }

    /// Encodes the pictures that `pour` puts into the pipe as the new file `file`, whatever its extension.
    ///
    /// # Errors
    /// If there is no ffmpeg, it cannot encode H.264, or `pour` failed or was cancelled.
    pub async fn write(
        &self,
        file: &Path,
        progress: Option<&dyn Progress>,
        pour: impl AsyncFnOnce(&mut Pipe<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        // The table of an MP4 file is written last and moved to its front: that needs a file, not a pipe.
        let ([width, height], [frames, seconds]) = (self.size, self.rate());
        let mut child = program("ffmpeg")
            .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-f", "rawvideo", "-pix_fmt", "rgb24"])
            .args([
                "-video_size",
                &format!("{width}x{height}"),
                "-framerate",
                &format!("{frames}/{seconds}"),
                "-i",
                "pipe:0",
            ])
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
            // The receiver is gone if another process keeps the pipe open.
            sender.send(text).unwrap_or_default();
        });
        let watched = Watched::new(child, PATIENCE);
        // The pipe is closed behind the last picture.
        let poured = match input {
            Some(input) => pour(&mut Pipe { video: self, input, watched: &watched }).await,
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

    /// Says what to do without ffmpeg.
    fn absent(&self, error: &io::Error) -> Error {
        match error.kind() {
            io::ErrorKind::NotFound => self.failed(&format!("it needs ffmpeg; install it, or {}", self.instead)),
            _ => self.failed(error),
        }
    }
}
