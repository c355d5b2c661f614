//! Video that has no decoder of ours, decoded by the browser.
//!
//! That decoder answers later, but a clip delivers its frames at once. So [`decode`] has a whole video decoded before it is opened, by the
//! samples of our own demuxers, and keeps the frames as a Y4M copy in memory; [`open`] opens that copy. Here is also everything about it that
//! needs no browser: [`config`] describes the track to the decoder, [`picture`] reads its pictures, [`copy`] collects them.

#[cfg(any(target_arch = "wasm32", test))]
mod config;
#[cfg(any(target_arch = "wasm32", test))]
mod copy;
#[cfg(target_arch = "wasm32")]
mod decode;
#[cfg(any(target_arch = "wasm32", test))]
mod picture;
#[cfg(target_arch = "wasm32")]
mod webcodecs;

use std::path::Path;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};

use super::coded::Track;
use super::turn::Turn;
use super::{Format, y4m};
use crate::files::{self, decoded};
use crate::media::input::Input;
use crate::media::{Decoder, Open, Source};
#[cfg(target_arch = "wasm32")]
pub(crate) use decode::decode;

/// The copy with the frames.
const FRAMES: &str = "frames.y4m";
/// The copy with the warnings, one a line.
const NOTES: &str = "notes.txt";

/// Keeps the `frames` of the video at `path`, a Y4M file, and the warnings about them.
///
/// # Errors
/// If there is no room for them.
#[cfg(any(target_arch = "wasm32", test))]
fn keep(path: &Path, frames: Vec<u8>, notes: &[String]) -> Result<(), Error> {
    let full = |_| Error::new("the page has no memory left for its frames; cut the clip, or scale it down");
    decoded::keep(&decoded::copy_of(path, NOTES), notes.join("\n").into_bytes()).map_err(full)?;
    decoded::keep(&decoded::copy_of(path, FRAMES), frames).map_err(full)
}

/// Opens the kept frames of the video at `path`; `None` if there are none.
pub(super) fn open(path: &Path, format: Format, options: &Open) -> Option<Result<Source, Error>> {
    let copy = decoded::copy_of(path, FRAMES);
    (files::is_in_memory(path) && files::is_file(&copy)).then(|| {
        let track = super::track(format, &mut Input::open(path)?, options)?;
        let notes = files::read_to_string(&decoded::copy_of(path, NOTES)).unwrap_or_default();
        let Source { info, decoder, .. } = y4m::open(Input::open(&copy)?, options)?;
        let (width, height) = track.turn.size((info.width, info.height));
        let Track { container, codec, fps, warnings, turn, .. } = track;
        let warnings = notes.lines().map(str::to_owned).chain(warnings).chain(info.warnings).collect();
        let name = crate::media::names::file_name(path);
        let info =
            ClipInfo { name, width, height, frames: info.frames, fps, container: container.into(), codec, warnings };
        Ok(Source::new(info, Turned { decoder, turn }))
    })
}

/// Frames that are turned to be shown.
struct Turned {
    decoder: Box<dyn Decoder>,
    turn: Turn,
}

impl Decoder for Turned {
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        let turn = self.turn;
        self.decoder.decode(index, stop, &mut |place, frame| keep(place, turn.apply(frame)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::track;
    use super::config::Config;
    use super::copy::Copy;
    use super::picture::Picture;
    use super::*;
    use crate::files::given::{self, GivenFile};
    use crate::media;

    fn fixture(name: &str) -> Vec<u8> {
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)).unwrap()
    }

    #[test]
    fn tracks_are_described_and_hidden_pictures_are_no_frames() {
        for (name, format, codec, [frames, samples]) in [
            ("vp8.webm", Format::Matroska, "vp8", [4, 4]),
            ("vp8_alt_ref.webm", Format::Matroska, "vp8", [24, 25]),
            ("av1.mp4", Format::Mp4, "av01.0.00M.08", [8, 8]),
            ("av1_10bit.webm", Format::Matroska, "av01.0.00M.10", [4, 4]),
            ("hevc.mp4", Format::Mp4, "hvc1.1.6.L30.90", [4, 4]),
        ] {
            let track = track(format, &mut Input::memory(name.into(), fixture(name)), &Open::default()).unwrap();
            assert_eq!((track.order.len(), track.samples.len(), track.fps), (frames, samples, Some(25.0)), "{name}");
            assert!(track.warnings.is_empty(), "{name}: {:?}", track.warnings);
            let config = Config::of(&track, &[]).expect("a codec of browsers");
            assert_eq!(
                (config.codec.as_str(), config.description.is_some()),
                (codec, name.starts_with("hevc")),
                "{name}"
            );
        }
    }

    #[test]
    fn a_video_opens_by_the_frames_that_were_kept_of_it() {
        let file = GivenFile { name: "vp8.webm".into(), bytes: fixture("vp8.webm").into() };
        let path = given::take(vec![file]).unwrap().join("vp8.webm");
        let refused = media::open(&path, &Open::default()).map(|opened| opened.clip.info().clone()).unwrap_err();
        assert!(refused.to_string().contains("vp8"), "{refused}");
        let picture = |value: u8| Picture {
            size: (64, 48),
            space: "420jpeg",
            matrix: 6,
            is_full_range: true,
            samples: vec![value; 64 * 48 + 2 * 32 * 24],
        };
        let mut copy = Copy::new(&picture(0), 4, u64::MAX).unwrap();
        (0..4).for_each(|t| copy.put(t, &picture(128 + t as u8)));
        keep(&path, copy.into_file(), &["one".into(), "two".into()]).unwrap();
        let clip = media::open(&path, &Open::default()).unwrap().clip;
        let info = clip.info();
        assert_eq!((info.container.as_str(), info.codec.as_str(), info.frames), ("webm", "vp8", Some(4)));
        assert_eq!((info.name.as_str(), info.fps, clip.size()), ("vp8.webm", Some(25.0), (64, 48)));
        assert_eq!(info.warnings, ["one", "two"]);
        assert_eq!(clip.frame(3).unwrap().luma()[(9, 9)], 131);
    }
}
