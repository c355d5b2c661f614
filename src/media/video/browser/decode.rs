//! Decodes a whole video by the browser.

use std::collections::HashMap;
use std::path::Path;

use motionscope_core::base::Error;
use web_time::{Duration, Instant};

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
use crate::media::video::{Format, track};
use crate::work;

/// The matrix of all VP8, which is that of standard definition, and its range.
const VP8_COLORS: (u32, bool) = (6, false);
/// Memory for the decoded frames of a video.
const MOST_BYTES: u64 = 512 << 20;
/// Memory that is left for other files.
const SPARE_BYTES: u64 = 16 << 20;
/// How long a decoder may give nothing.
const PATIENCE: Duration = Duration::from_secs(20);
/// How often a cancellation is noticed.
const POLL: Duration = Duration::from_millis(200);
/// µs between the times that the decoder is told: samples count, since their true times may be equal.
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
    let mut job = Job { input, decoder: &decoder, places: Places::of(&track), track: &track, next, copy: None };
    let failure = job.run(options).await?;
    // A damaged clip without motion has only its damage to tell.
    match job.copy.filter(|copy| copy.filled() > usize::from(failure.is_some())) {
        Some(copy) => {
            let notes = notes(&track.codec, &copy, track.order.len(), failure.as_deref());
            keep(path, copy.into_file(), &notes)
        }
        None => Err(stopped(&failure.unwrap_or_default())),
    }
}

/// The frames that each sample is, by the number of its time.
struct Places {
    /// The number of each sample in the order of their times.
    ranks: Vec<u32>,
    frames: HashMap<u32, Vec<usize>>,
}

impl Places {
    fn of(track: &Track) -> Self {
        let mut by_time: Vec<usize> = (0..track.samples.len()).collect();
        by_time.sort_by_key(|&sample| track.samples[sample].time);
        let mut ranks = vec![0; by_time.len()];
        (0..).zip(&by_time).for_each(|(rank, &sample)| ranks[sample] = rank);
        let mut frames = HashMap::<u32, Vec<usize>>::new();
        for (frame, &sample) in track.order.iter().enumerate() {
            frames.entry(ranks[sample as usize]).or_default().push(frame);
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
    copy: Option<Copy>,
}

impl Job<'_> {
    /// Decodes until all frames are there, or the decoder ends; returns why it has failed, if it has.
    async fn run(&mut self, options: &Open) -> Result<Option<String>, Error> {
        let all = self.track.samples.len();
        let mut heard = Instant::now();
        while self.copy.as_ref().is_none_or(|copy| copy.filled() < copy.places()) {
            options.report(self.next as f32 / all as f32)?;
            match self.decoder.event(self.next < all, POLL).await {
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
                None if heard.elapsed() > PATIENCE => {
                    return Ok(Some(format!("it has given no picture for {} s", PATIENCE.as_secs())));
                }
                None => continue,
            }
            heard = Instant::now();
            work::breathe().await;
        }
        Ok(None)
    }

    /// Gives the decoder the next sample, and tells it if that is the last.
    fn feed(&mut self) -> Result<(), Error> {
        let sample = self.track.samples[self.next];
        let bytes = self.input.read_up_to(sample.offset, u64::from(sample.size))?;
        self.decoder.feed(&bytes, f64::from(self.places.ranks[self.next]) * STEP_US, sample.key);
        self.next += 1;
        if self.next == self.track.samples.len() {
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
            return Err(format!("the size of its pictures changes to {}×{} px", size.0, size.1));
        }
        let rank = (time / STEP_US).round() as u32;
        let places = self.places.frames.get(&rank).into_iter().flatten();
        places.for_each(|&place| copy.put(place, &picture));
        Ok(())
    }
}
