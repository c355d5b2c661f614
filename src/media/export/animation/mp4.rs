//! MP4 by the user's own ffmpeg, which reads the pictures from a pipe.

use std::io::{self, Read as _, Write as _};
use std::process::{Child, Command, Stdio};
use std::{fs, thread};

use motionscope_core::Error;

use super::{AnimationFormat, Progress, Reel, failed};

/// Frames per second of the video; a step lasts as many of them as come nearest to its time.
const RATE: u32 = 50;

/// Encodes `reel` as H.264 in an MP4 file.
///
/// # Errors
/// If there is no ffmpeg, it cannot encode H.264, or the work was cancelled.
pub fn encode(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
    // The table of an MP4 file is written last and moved to its front: that needs a file, not a pipe.
    let folder = tempfile::tempdir().map_err(|error| failed(AnimationFormat::Mp4, &error))?;
    let file = folder.path().join("animation.mp4");
    let [width, height] = reel.size;
    let mut child = Command::new("ffmpeg")
        .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-video_size", &format!("{width}x{height}"), "-framerate", &RATE.to_string(), "-i", "pipe:0"])
        // The chroma of 4:2:0 needs even sides; the matrix is that of high definition, and says so.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709", "-colorspace", "bt709"])
        .args(["-c:v", "libx264", "-crf", "16", "-pix_fmt", "yuv420p", "-movflags", "+faststart"])
        .arg(&file)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| absent(&error))?;
    let mut errors = child.stderr.take();
    let said = thread::spawn(move || {
        let mut text = String::new();
        errors.as_mut().map_or(Ok(0), |errors| errors.read_to_string(&mut text)).map(|_| text)
    });
    let poured = pour(reel, &mut child, progress);
    if poured.is_err() {
        // It may be at work still; what it made is thrown away.
        child.kill().unwrap_or_default();
    }
    let status = child.wait().map_err(|error| failed(AnimationFormat::Mp4, &error))?;
    let said = said.join().ok().and_then(Result::ok).unwrap_or_default();
    if !status.success() && !progress.is_some_and(|progress| progress.cancelled()) {
        let line = said.lines().next().unwrap_or("it gave no reason").trim().to_owned();
        return Err(failed(AnimationFormat::Mp4, &format!("ffmpeg says {line}; save as .gif, .apng or .webp instead")));
    }
    poured?;
    fs::read(&file).map_err(|error| failed(AnimationFormat::Mp4, &error))
}

/// Writes all pictures into the pipe, each as often as it lasts.
fn pour(reel: &Reel, child: &mut Child, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let Some(mut pipe) = child.stdin.take() else { return Err(failed(AnimationFormat::Mp4, &"ffmpeg has no input")) };
    reel.each(progress, |_, shot| {
        let times = ((shot.ms * RATE + 500) / 1000).max(1);
        let written = (0..times).try_for_each(|_| pipe.write_all(shot.picture.as_raw()));
        written.map_err(|error| failed(AnimationFormat::Mp4, &error))
    })
}

/// Says what to do without ffmpeg.
fn absent(error: &io::Error) -> Error {
    match error.kind() {
        io::ErrorKind::NotFound => {
            failed(AnimationFormat::Mp4, &"it needs ffmpeg; install it, or save as .gif, .apng or .webp")
        }
        _ => failed(AnimationFormat::Mp4, error),
    }
}
