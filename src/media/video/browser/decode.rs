//! Decodes a whole video by the browser.

use std::path::Path;

use motionscope_core::base::Error;
use web_time::Duration;

use super::config::Config;
use super::copy::{Copy, notes};
use super::keep;
use super::picture::Picture;
use super::webcodecs::{Decoder, Event, Pixels, is_supported};
use crate::files::decoded;
use crate::media::Open;
use crate::media::input::Input;
use crate::media::reason;
use crate::media::video::coded::Track;
use crate::media::video::{Format, is_built_in, track};
use crate::work;

/// The matrix of all VP8, which is that of standard definition, and its range.
const VP8_COLORS: (u32, bool) = (6, false);
/// Memory for the decoded frames of a video.
const MOST_BYTES: u64 = 512 << 20;
/// Memory that is left for other files.
const SPARE_BYTES: u64 = 16 << 20;
/// Time for which a decoder may give nothing.
const PATIENCE: Duration = Duration::from_secs(20);
/// How often a cancellation is noticed.
const POLL: Duration = Duration::from_millis(200);
/// µs between the times that the decoder is given: samples count, since their true times may be equal.
const STEP_US: f64 = 40_000.0;

/// Has the browser decode the video at `path`, and keeps its frames. Does nothing if the browser cannot: opening the video says why.
///
/// # Errors
/// One sentence, without the file's name, if there is not a single frame, or it was cancelled.
pub(crate) async fn decode(path: &Path, format: Format, options: &Open) -> Result<(), Error> {
    let mut input = Input::open(path)?;
    let Ok(mut track) = track(format, &mut input, options) else { return Ok(()) };
    if track.codec == "vp8" {
        track.colors.get_or_insert(VP8_COLORS);
    }
    let Some(first) = track.samples.first().filter(|_| !track.encrypted) else { return Ok(()) };
    let first = input.read_up_to(first.offset, u64::from(first.size))?;
    let Some(config) = Config::of(&track, &first) else { return Ok(()) };
    if !is_supported(&config).await {
        return Ok(());
    }
    let stopped = |why: &str| {
        let why = reason::bracketed(why);
        Error::new(format!(
            "this browser cannot decode its {} video{why}; convert the clip to MP4 with H.264",
            track.codec
        ))
    };
    let decoder = Decoder::new(&config).map_err(|why| stopped(&why))?;
    // Samples before the first key cannot be decoded.
    let next = track.samples.iter().position(|sample| sample.key).unwrap_or(0);
    // Samples that are cut off may end the decoder before it has given the frames before them.
    let end = track.order.iter().max().map_or(0, |last| *last as usize + 1);
    let mut job = Job { input, decoder: &decoder, places: Places::of(&track), track: &track, next, end, copy: None };
    let failure = job.run(options).await?;
    // Of a single frame of a damaged clip nothing moves: its damage is what has to be told.
    match job.copy.filter(|copy| copy.filled() > usize::from(failure.is_some())) {
        Some(copy) => {
            let notes = notes(&track.codec, &copy, track.order.len(), failure.as_deref());
            keep(path, copy.into_file(), &notes)
        }
        // Opening it says better why the program's own decoder refuses it.
        None if is_built_in(&track.codec) => Ok(()),
        None => Err(stopped(&failure.unwrap_or_default())),
    }
}

/// The frames that each sample is, by its place in the order of times.
struct Places {
    /// The number of each sample in the order of their times.
    ranks: Vec<usize>,
    frames: Vec<Vec<usize>>,
}

impl Places {
    fn of(track: &Track) -> Self {
        let mut by_time: Vec<usize> = (0..track.samples.len()).collect();
        by_time.sort_by_key(|&sample| track.samples[sample].time);
        let mut ranks = vec![0_usize; by_time.len()];
        (0..).zip(&by_time).for_each(|(rank, &sample)| ranks[sample] = rank);
        let mut frames = vec![Vec::new(); ranks.len()];
        for (frame, &sample) in track.order.iter().enumerate() {
            frames[ranks[sample as usize]].push(frame);
        }
        Self { ranks, frames }
    }
}

/// A video that is being decoded.
struct Job<'a> {
    input: Input,
    decoder: &'a Decoder,
    track: &'a Track,
    places: Places,
    /// The next sample.
    next: usize,
    /// End of the samples that belong to a frame.
    end: usize,
    copy: Option<Copy>,
}

impl Job<'_> {
    /// Decodes until all frames are there, or the decoder ends; returns why it has failed, if it has.
    async fn run(&mut self, options: &Open) -> Result<Option<String>, Error> {
        // Counted, because a tab that sleeps has all the time in the world.
        let mut silent = Duration::ZERO;
        while self.copy.as_ref().is_none_or(|copy| copy.filled() < copy.places()) {
            options.report(self.next as f32 / self.end as f32)?;
            match self.decoder.event(self.next < self.end, POLL).await {
                Some(Event::Hungry) => self.feed()?,
                Some(Event::Picture(picture)) => {
                    let time = picture.time();
                    let taken = picture.take_pixels().await.and_then(|pixels| self.take(time, pixels));
                    if let Err(why) = taken {
                        return Ok(Some(why));
                    }
                }
                Some(Event::Ended) => break,
                Some(Event::Failed(why)) => return Ok(Some(why)),
                None if silent > PATIENCE => {
                    return Ok(Some(format!("it has given no picture for {} s", PATIENCE.as_secs())));
                }
                None => {
                    silent += POLL;
                    continue;
                }
            }
            silent = Duration::ZERO;
            work::breathe().await;
        }
        Ok(None)
    }

    /// Gives the decoder the next sample, and tells it if that is the last.
    fn feed(&mut self) -> Result<(), Error> {
        let sample = self.track.samples[self.next];
        let bytes = self.input.read_up_to(sample.offset, u64::from(sample.size))?;
        self.decoder.feed(&bytes, self.places.ranks[self.next] as f64 * STEP_US, sample.key);
        self.next += 1;
        if self.next == self.end {
            self.decoder.flush();
        }
        Ok(())
    }

    /// Puts a picture where it is shown.
    fn take(&mut self, time: f64, pixels: Pixels) -> Result<(), String> {
        let Pixels { format, size, bytes, colors } = pixels;
        let picture = Picture::new(&format, size, bytes, colors.beside(self.track.colors));
        let picture = picture.ok_or_else(|| format!("its pictures have the format {format}, which is not known"))?;
        let copy = match &mut self.copy {
            Some(copy) => copy,
            none => {
                let most = MOST_BYTES.min(decoded::room().saturating_sub(SPARE_BYTES));
                let copy = Copy::new(&picture, self.track.order.len(), most).map_err(|error| error.to_string())?;
                none.insert(copy)
            }
        };
        if !copy.takes(&picture) {
            let (width, height) = size;
            return Err(format!("its pictures change to {width}×{height} px in the format {format}"));
        }
        let rank = (time / STEP_US).round() as usize;
        let places = self.places.frames.get(rank).into_iter().flatten();
        places.for_each(|&place| copy.put(place, &picture));
        Ok(())
    }
}
