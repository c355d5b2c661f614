//! Coded video: samples of a container, in decoding order, through a codec.

use std::collections::{BTreeMap, HashMap};

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::Frame;

use super::color::Picture;
use super::turn::Turn;
use crate::media::Decoder;
use crate::media::input::Input;

/// Largest number of samples that is believed: 19 hours at 60 per second.
pub(crate) const MAX_SAMPLES: usize = 1 << 22;

/// Samples before the one sought that are decoded even if nothing needs them, so that stepping back is at hand.
const RUN_UP_SAMPLES: usize = 24;

/// Where one coded picture lies, in decoding order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sample {
    /// First byte in the file.
    pub offset: u64,
    /// Number of bytes.
    pub size: u32,
    /// When it is shown, in the container's ticks.
    pub time: i64,
    /// Whether decoding may start here.
    pub key: bool,
}

/// A video track: what to decode and in which order to show it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    /// The coded pictures in decoding order.
    pub samples: Vec<Sample>,
    /// The sample of each frame.
    pub order: Vec<u32>,
    /// Ticks per second.
    pub ticks_per_second: f64,
    /// What holds the samples: `mp4`, `webm` …
    pub container: &'static str,
    /// How the container names the coding.
    pub codec: String,
    /// Whether the samples are encrypted.
    pub encrypted: bool,
    /// The codec's parameters, if they are kept apart from the samples.
    pub config: Vec<u8>,
    /// How a picture is turned to be shown.
    pub turn: Turn,
    /// Mean frames per second, if it is told.
    pub fps: Option<f64>,
    /// The matrix code and whether values are full range, if the container tells.
    pub colors: Option<(u32, bool)>,
    /// What a person should know.
    pub warnings: Vec<String>,
}

impl Track {
    /// Shows all samples by their times.
    pub(crate) fn order_by_time(&mut self) {
        let mut order: Vec<u32> = (0..).take(self.samples.len()).collect();
        order.sort_by_key(|&s| self.samples[s as usize].time);
        self.order = order;
    }

    /// Leaves out samples that lie beyond the `len` bytes of the file, and tells how many.
    ///
    /// # Errors
    /// If none is left.
    pub(crate) fn drop_lost(&mut self, len: u64) -> Result<(), Error> {
        let all = self.order.len();
        let samples = &self.samples;
        self.order.retain(|&s| {
            samples.get(s as usize).is_some_and(|s| s.size > 0 && s.offset.saturating_add(u64::from(s.size)) <= len)
        });
        if self.order.is_empty() {
            return Err(Error::new(
                "it is cut off or damaged before its first complete frame; copy it again from its source",
            ));
        }
        if self.order.len() < all {
            let lost = all - self.order.len();
            self.warnings.push(format!("the file is cut off or damaged: {lost} of {all} frames are left out"));
        }
        Ok(())
    }

    /// The mean rate of the frames from their times; tells if it varies.
    pub(crate) fn measure_rate(&mut self) {
        let times: Vec<i64> = self.order.iter().map(|&s| self.samples[s as usize].time).collect();
        let mut steps: Vec<i64> =
            times.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).filter(|&d| d > 0).collect();
        steps.sort_unstable();
        let (Some(&shortest), Some(&longest)) = (steps.first(), steps.last()) else { return };
        let mean = steps.iter().map(|&d| d as f64).sum::<f64>() / steps.len() as f64;
        if self.ticks_per_second > 0.0 {
            self.fps = Some(self.ticks_per_second / mean);
        }
        // Rounding to ticks is no change of rate.
        if longest - shortest > 2 && longest as f64 > 1.1 * shortest as f64 {
            let rate = |step: i64| self.ticks_per_second / step as f64;
            self.warnings.push(format!(
                "the frame rate varies from {:.3} to {:.3} per second; one frame is taken as one step of time",
                rate(longest),
                rate(shortest)
            ));
        }
    }
}

/// Decodes the samples of one stream. A panic inside is contained by the frame cache.
pub(crate) trait Codec: Send {
    /// Forgets all samples.
    ///
    /// # Errors
    /// If the stream's parameters are damaged.
    fn reset(&mut self) -> Result<(), Error>;

    /// The picture of `sample`; samples come in decoding order.
    ///
    /// # Errors
    /// One sentence if the sample is damaged or does not show a picture.
    fn decode(&mut self, sample: &[u8]) -> Result<Picture, Error>;

    /// Whether no other picture needs that of `sample`.
    fn disposable(&self, _sample: &[u8]) -> bool {
        false
    }

    /// Whether decoding can really start at `sample`, which the container calls a key.
    fn starts(&self, sample: &[u8]) -> bool;

    /// What a person should know of the stream, once its first sample was decoded.
    fn warnings(&self) -> Vec<String>;
}

/// Frames of a coded track.
pub(crate) struct Coded {
    input: Input,
    track: Track,
    codec: Box<dyn Codec>,
    /// The frame of each sample.
    places: HashMap<u32, usize>,
    /// The sample to go on with and the one where decoding started; `None` where the codec's state is not known.
    position: Option<(usize, usize)>,
    /// Samples that could not be decoded, and why.
    broken: BTreeMap<usize, Error>,
}

impl Coded {
    /// The frames of `track` in `input` by `codec`.
    pub(crate) fn new(input: Input, track: Track, codec: Box<dyn Codec>) -> Self {
        let places = track.order.iter().enumerate().map(|(place, &sample)| (sample, place)).collect();
        Self { input, track, codec, places, position: None, broken: BTreeMap::new() }
    }

    /// What the first picture tells: the size of all, and what a person should know.
    ///
    /// # Errors
    /// If it cannot be decoded.
    pub(crate) fn look(&mut self) -> Result<((usize, usize), Vec<String>), Error> {
        let mut size = None;
        self.decode(0, &Stop::default(), &mut |_, frame| size = Some(frame.size()))?;
        let size = size.ok_or_else(|| Error::new("its first picture is missing"))?;
        Ok((size, self.codec.warnings()))
    }

    fn sample(&mut self, number: usize) -> Result<Vec<u8>, Error> {
        let Sample { offset, size, .. } = self.track.samples[number];
        self.input.read(offset, u64::from(size))
    }

    /// The last sample at which decoding can start to reach `target`.
    fn entry(&mut self, target: usize, stop: &Stop) -> Result<usize, Error> {
        let shown = self.track.samples[target].time;
        for number in (1..=target).rev() {
            let Sample { key, time, .. } = self.track.samples[number];
            // A picture shown before the key but coded after it needs pictures from before the key.
            if key && time <= shown {
                stop.check()?;
                let sample = self.sample(number)?;
                if self.codec.starts(&sample) {
                    return Ok(number);
                }
            }
        }
        Ok(0)
    }

    /// Makes the codec ready to reach `target`.
    fn go_towards(&mut self, target: usize, stop: &Stop) -> Result<(usize, usize), Error> {
        let before = self.position.take();
        if let Some((next, start)) = before.filter(|&(next, start)| target >= next && !self.leads(target, start)) {
            let key_ahead = self.track.samples[next..=target].iter().skip(1).any(|sample| sample.key);
            if !key_ahead || self.entry(target, stop)? <= next {
                return Ok((next, start));
            }
        }
        let entry = self.entry(target, stop)?;
        self.codec.reset()?;
        Ok((entry, entry))
    }

    /// Whether `sample` needs pictures from before `start`.
    fn leads(&self, sample: usize, start: usize) -> bool {
        start > 0 && self.track.samples[sample].time < self.track.samples[start].time
    }
}

impl Coded {
    /// Decodes frame `index` and gives `keep` every picture that is met on the way, as it is stored.
    fn pictures(
        &mut self,
        index: usize,
        stop: &Stop,
        keep: &mut dyn FnMut(usize, Picture) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let Some(target) = self.track.order.get(index).map(|&s| s as usize) else { return Ok(()) };
        let (next, start) = self.go_towards(target, stop)?;
        if let Some((&number, why)) = self.broken.range(start..=target).next() {
            return Err(self.because_of(number, target, why));
        }
        for number in next..=target {
            if self.leads(number, start) {
                continue;
            }
            stop.check()?;
            stop.report(number - next, target + 1 - next);
            let sample = self.sample(number)?;
            if number + RUN_UP_SAMPLES < target && self.codec.disposable(&sample) {
                continue;
            }
            let picture = self.picture(number, &sample).map_err(|why| self.because_of(number, target, &why))?;
            // One sample can be shown more than once.
            let place = if number == target { Some(index) } else { self.place(number) };
            if let Some(place) = place {
                keep(place, picture)?;
            }
        }
        self.position = Some((target + 1, start));
        Ok(())
    }

    /// Decodes sample `number`, and remembers if that fails: it always will.
    fn picture(&mut self, number: usize, sample: &[u8]) -> Result<Picture, Error> {
        // A panic passes by the lines below.
        self.broken.insert(number, Error::new("its data are damaged"));
        let picture = self.codec.decode(sample);
        match &picture {
            Ok(_) => self.broken.remove(&number),
            Err(why) => self.broken.insert(number, why.clone()),
        };
        picture
    }

    /// The frame that sample `number` is, if it is one.
    fn place(&self, number: usize) -> Option<usize> {
        self.places.get(&u32::try_from(number).ok()?).copied()
    }

    /// What keeps sample `target` from being decoded, where it is `number` that is broken.
    fn because_of(&self, number: usize, target: usize, why: &Error) -> Error {
        match self.place(number) {
            Some(place) if number != target => Error::new(format!("it builds on frame {place}, of which {why}")),
            _ => why.clone(),
        }
    }
}

impl Decoder for Coded {
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        let turn = self.track.turn;
        self.pictures(index, stop, &mut |place, picture| {
            keep(place, turn.apply(picture.into_frame()?));
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::super::{h264::H264, matroska, mp4, vp9::Vp9};
    use super::*;

    fn fixture(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
    }

    fn coded(name: &str) -> Coded {
        let mut input = Input::open(&fixture(name)).unwrap();
        let options = crate::media::Open::default();
        let track = if name.contains(".mp4") || name.contains(".mov") {
            mp4::open(&mut input, &options).unwrap()
        } else {
            matroska::open(&mut input, &options).unwrap()
        };
        let codec: Box<dyn Codec> = match track.codec.as_str() {
            "h264" => Box::new(H264::new(track.config.clone(), None).unwrap()),
            _ => Box::new(Vp9::new(None)),
        };
        Coded::new(input, track, codec)
    }

    /// CRC-32 of the planes one after the other, as ffmpeg's framehash has it.
    fn crc32(picture: &Picture) -> String {
        let Picture::Planes(picture) = picture else { panic!("these fixtures have planes") };
        let crc = picture.planes.iter().flatten().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
        });
        format!("{:08x}", !crc)
    }

    fn hash(clip: &mut Coded, index: usize) -> String {
        let mut found = None;
        clip.pictures(index, &Stop::default(), &mut |at, picture| {
            if at == index {
                found = Some(crc32(&picture));
            }
            Ok(())
        })
        .unwrap();
        found.unwrap()
    }

    fn hashes() -> Vec<(String, Vec<String>)> {
        let table = std::fs::read_to_string(fixture("hashes.txt")).unwrap();
        let row = |line: &str| {
            let mut words = line.split_whitespace().map(str::to_owned);
            (words.next().unwrap(), words.collect())
        };
        table.lines().map(row).collect()
    }

    #[test]
    fn every_frame_of_every_fixture_is_what_ffmpeg_decodes() {
        for (name, known) in hashes() {
            let mut clip = coded(&name);
            let ours: Vec<_> = (0..clip.track.order.len()).map(|i| hash(&mut clip, i)).collect();
            assert_eq!(ours, known, "{name}");
        }
    }

    #[test]
    fn any_order_gives_the_same_frames() {
        for (name, known) in hashes() {
            let mut clip = coded(&name);
            let count = known.len();
            let backwards = (0..count).rev();
            let jumps = (0..3 * count).map(|i| i * 7 % count);
            for index in backwards.chain(jumps) {
                assert_eq!(hash(&mut clip, index), known[index], "{name} frame {index}");
            }
        }
    }

    #[test]
    fn what_was_given_up_can_be_asked_for_again() {
        for (name, known) in hashes() {
            let last = known.len() - 1;
            for after in 0..3 {
                let (mut clip, stop) = (coded(&name), Stop::default());
                stop.set(after == 0);
                let mut met = Vec::new();
                let given_up = clip.pictures(last, &stop, &mut |place, _| {
                    met.push(place);
                    stop.set(met.len() >= after);
                    Ok(())
                });
                assert!(met.len() <= after, "{name}: {met:?}");
                assert_eq!(given_up.is_ok(), met.contains(&last), "{name}: {met:?}");
                assert_eq!(hash(&mut clip, last), known[last], "{name}");
                assert_eq!(hash(&mut clip, last / 2), known[last / 2], "{name}");
            }
        }
    }

    #[test]
    fn damage_is_reported_by_the_frame_where_it_is_and_stays_there() {
        // A key frame every five; the length in front of frame 6 is made too large.
        let mut clip = coded("h264_baseline.mp4");
        let mut bytes = std::fs::read(fixture("h264_baseline.mp4")).unwrap();
        bytes[clip.track.samples[6].offset as usize] = 0xFF;
        clip.input = Input::memory("damaged".into(), bytes);
        for _ in 0..2 {
            let message: Vec<_> = (0..10)
                .map(|i| {
                    clip.pictures(i, &Stop::default(), &mut |_, _| Ok(()))
                        .err()
                        .map(|error| error.to_string())
                        .unwrap_or_default()
                })
                .collect();
            assert!((0..6).all(|i| message[i].is_empty()), "{message:?}");
            assert!(message[6].contains("a unit is cut off") && !message[6].contains("builds on"), "{message:?}");
            assert!((7..10).all(|i| message[i].starts_with("it builds on frame 6, of which")), "{message:?}");
        }
    }
}
