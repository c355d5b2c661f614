//! The frames that a run goes through.

use super::Granularity;
use crate::base::Error;
use crate::data::Clip;

/// The name of the parameter for the number of frames.
pub const FRAMES: &str = "frames";

/// Frames from the first to the last of a run, inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first.
    pub first: usize,
    /// The last frame; a clip of unknown length may end earlier.
    last: usize,
    is_known: bool,
}

impl Span {
    /// At most `count` frames from `first` on, fewer if the clip ends.
    ///
    /// # Errors
    /// If there is no pair of frames there: motion needs a second frame.
    pub fn new(clip: &Clip, first: usize, count: usize) -> Result<Self, Error> {
        clip.pair(first)?;
        let frames = clip.info().frames;
        let end = frames.map_or(usize::MAX, |frames| frames - 1);
        let last = first.saturating_add(count.saturating_sub(1)).min(end);
        Ok(Self { first, last, is_known: frames.is_some() })
    }

    /// The part of it before frame `next`, which lies in it or directly after it.
    #[must_use]
    pub fn until(self, next: usize) -> Self {
        Self { last: next.saturating_sub(1).clamp(self.first, self.last), is_known: true, ..self }
    }

    /// Number of frames, if known.
    pub fn frames(&self) -> Option<usize> {
        self.is_known.then(|| self.last - self.first + 1)
    }

    /// Largest possible number of frames.
    pub fn most(&self) -> usize {
        self.last - self.first + 1
    }

    /// Number of pairs of frames, if known.
    pub fn pairs(&self) -> Option<usize> {
        self.frames().map(|frames| frames - 1)
    }

    /// The position of a run through pairs of frames: in the clip, and at the pair from `frame` on.
    pub fn place_of_pair(&self, frame: usize) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: frame - self.first, of: self.pairs() }]
    }

    /// The position of a run with frames as units after `done` of them: in the clip, and at a frame.
    pub fn place(&self, done: usize) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: done, of: self.frames() }]
    }

    /// Whether the clip ends before frame `next`. A damaged frame is no end: reading it is an error.
    pub fn is_over(&self, clip: &Clip, next: usize) -> bool {
        next > self.last || (!self.is_known && clip.has_frame(next) == Ok(false))
    }
}
