//! H.264 video in an MP4 file: by the user's own ffmpeg, or by the browser in a page.

#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(not(target_arch = "wasm32"))]
mod ffmpeg;
#[cfg(any(test, target_arch = "wasm32"))]
mod level;
#[cfg(any(test, target_arch = "wasm32"))]
mod mux;
#[cfg(not(target_arch = "wasm32"))]
mod watched;

use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Frame};

#[cfg(target_arch = "wasm32")]
pub(super) use self::browser::Pipe;
#[cfg(not(target_arch = "wasm32"))]
pub(super) use self::ffmpeg::Pipe;
use super::save::save_file;
use crate::files::IN_PAGE;
use crate::media::Progress;
use crate::media::numbers::whole;
use crate::work;

/// The description of the format in lists.
pub const MP4_DESCRIPTION: &str = if IN_PAGE {
    "MP4, compressed video with loss; encoded by this browser"
} else {
    "MP4, compressed video with loss; encoded by the ffmpeg of this computer"
};

/// Frames per second of a clip whose rate is not known.
const USUAL_HZ: f64 = 25.0;

/// A video that is to be encoded.
pub(super) struct Video {
    /// The name in errors: `animation`.
    pub what: &'static str,
    /// The alternative if nothing encodes it: `save as .gif`.
    pub instead: &'static str,
    /// Width and height in px.
    pub size: [usize; 2],
    /// Frames per second.
    pub rate_hz: f64,
    /// The constant rate factor of x264: a larger one makes a smaller file with more loss.
    pub crf: u32,
}

impl Video {
    /// Says that it could not be made, and why.
    fn failed(&self, why: &dyn std::fmt::Display) -> Error {
        Error::new(format!("the MP4 {} could not be made: {why}", self.what))
    }

    /// The frame rate as a fraction: frames, and seconds.
    fn rate(&self) -> [u32; 2] {
        ratio(self.rate_hz)
    }
}

/// A rate in frames per second as a fraction of frames and seconds: a whole rate, one of NTSC, whose decimals are rounded (29.97 is
/// 30000/1001), or thousandths.
fn ratio(rate_hz: f64) -> [u32; 2] {
    // 23.976, 29.97 and 59.94 are a millionth off.
    let is = |wanted: f64| (rate_hz / wanted - 1.0).abs() < 2e-6;
    let (nearest, ntsc) = (rate_hz.round(), (rate_hz * 1.001).round());
    let (frames, seconds) = match () {
        () if is(nearest) => (nearest, 1),
        () if is(ntsc / 1.001) => (1000.0 * ntsc, 1001),
        () => ((1000.0 * rate_hz).round(), 1000),
    };
    [whole(frames).unwrap_or(u32::MAX).max(1), seconds]
}

/// Writes the frames of `clip` as H.264 video into the MP4 file `path`. Gray levels change a little, and odd sides get a black row or
/// column.
///
/// # Errors
/// If a frame cannot be decoded, ffmpeg is missing or fails, the browser cannot encode H.264, the file cannot be written, or the work was cancelled.
pub async fn video(clip: &Clip, path: &Path, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let (info, (width, height)) = (clip.info(), clip.size());
    let name = &info.name;
    let Some(frames) = info.frames else {
        return Err(Error::new(format!("{name} cannot be written: count its frames first")));
    };
    let rate_hz = info.fps.unwrap_or(USUAL_HZ);
    // Motion is estimated on it, so little may be lost.
    let video = Video { what: "video", instead: "save as numbered PNG", size: [width, height], rate_hz, crf: 8 };
    let pour = async |pipe: &mut Pipe<'_>| {
        for t in 0..frames {
            if progress.is_some_and(Progress::cancelled) {
                return Err(Error::new(format!("saving {name} was cancelled after {t} of {frames} frames")));
            }
            progress.into_iter().for_each(|progress| progress.report(t as f32 / frames as f32));
            pipe.put(&rgb(&*clip.frame(t)?), 1).await?;
            work::breathe().await;
        }
        Ok(())
    };
    save_file(path, async |file: &Path| video.write(file, progress, pour).await).await
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
    use crate::files::temporary;
    use crate::media::input::Input;
    use crate::media::video::{Format, track};
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
            let said = work::finish(video(&made, &path, None)).unwrap_err().to_string();
            assert!(said.contains("save as numbered PNG") && !path.exists(), "{said}");
            return;
        }
        let cancelled = work::finish(video(&made, &path, Some(&Cancelled))).unwrap_err().to_string();
        assert!(cancelled.contains("cancelled after 0 of 4 frames") && !path.exists(), "{cancelled}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left of it");
        let watching = Watching { folder: folder.path(), seen: Mutex::default() };
        work::finish(video(&made, &path, Some(&watching))).unwrap();
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
            [12, 1],
            [25, 1],
            [30_000, 1001],
            [30_000, 1001],
            [30_000, 1001],
            [24_000, 1001],
            [60_000, 1001],
            [12_500, 1000],
            [333, 1000],
        ];
        assert_eq!(rates.map(ratio), wanted);
    }

    /// The coded pictures of a file, and the codec's parameters.
    fn stream(path: &Path) -> (Vec<mux::Picture>, Vec<u8>) {
        let mut input = Input::open(path).unwrap();
        let track = track(Format::Mp4, &mut input, &Open::default()).unwrap();
        let pictures = track.samples.iter().enumerate().map(|(place, sample)| mux::Picture {
            bytes: input.read_up_to(sample.offset, u64::from(sample.size)).unwrap(),
            is_key: sample.key,
            number: track.order.iter().position(|shown| *shown as usize == place).unwrap(),
        });
        (pictures.collect(), track.config)
    }

    #[test]
    fn a_muxed_video_opens_with_its_pictures_and_rate() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = [
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/h264_baseline.mp4"),
            folder.path().join("a.mp4"),
        ];
        let (pictures, configuration) = stream(&from);
        let (width, height) = open(&from, &Open::default()).unwrap().clip.size();
        let muxed = |pictures| {
            let configuration = configuration.clone();
            mux::Stream { size: [width as u16, height as u16], rate: ratio(29.97), configuration, pictures }.into_file()
        };
        let file = muxed(stream(&from).0).unwrap();
        let [tables, content] =
            [b"moov", b"mdat"].map(|name| file.windows(4).position(|bytes| bytes == name).expect("the box"));
        assert!(tables < content, "players need not wait for the end");
        fs::write(&to, &file).unwrap();
        assert!((pictures, configuration.clone()) == stream(&to), "every picture is there");
        let read = open(&to, &Open::default()).unwrap().clip;
        assert_eq!(read.size(), (width, height));
        assert!((read.info().fps.unwrap() - 30_000.0 / 1001.0).abs() < 1e-3, "{:?}", read.info().fps);
        assert!(muxed(Vec::new()).is_err(), "a video has a picture");
    }

    #[test]
    fn gray_frames_have_three_equal_channels() {
        let gray = Frame::gray(Grid::from_fn(2, 1, |x, _| 7 + x as u8));
        assert_eq!(rgb(&gray), [7, 7, 7, 8, 8, 8]);
    }
}
