//! The frames that a run goes through.

use super::Granularity;
use crate::base::Error;
use crate::data::Clip;

/// What the parameter is called that says how many frames a run goes through.
pub const FRAMES: &str = "frames";

/// Frames from the first to the last of a run, both counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first.
    pub first: usize,
    /// The last that it may come to; the clip may end before where nobody knows its length.
    last: usize,
    is_known: bool,
}

impl Span {
    /// From frame `first` on `count` at most, fewer where the clip ends.
    ///
    /// # Errors
    /// If there is no pair of frames there: without a second one nothing is seen to move.
    pub fn new(clip: &Clip, first: usize, count: usize) -> Result<Self, Error> {
        clip.pair(first)?;
        let frames = clip.info().frames;
        let end = frames.map_or(usize::MAX, |frames| frames - 1);
        let last = first.saturating_add(count.saturating_sub(1)).min(end);
        Ok(Self { first, last, is_known: frames.is_some() })
    }

    /// How many frames there are, if that is known.
    pub fn frames(&self) -> Option<usize> {
        self.is_known.then(|| self.last - self.first + 1)
    }

    /// How many frames there are at most.
    pub fn most(&self) -> usize {
        self.last - self.first + 1
    }

    /// Where a run stands that has frames for units and `done` of them behind it: in the clip, and at a frame.
    pub fn place(&self, done: usize) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: done, of: self.frames() }]
    }

    /// Whether there is no frame `next`. One that is damaged is no end: whoever goes on to it is told of it.
    pub fn is_over(&self, clip: &Clip, next: usize) -> bool {
        next > self.last || (!self.is_known && clip.has_frame(next) == Ok(false))
    }
}
