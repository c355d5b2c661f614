//! The results of the frames of a run so far.

use std::sync::Arc;

use super::{Followed, MaskField, ObjectField, ObjectFrame, Output, Watched};
use crate::data::PackedMask;

/// The results frame by frame; copies share them.
#[derive(Clone, Debug, Default)]
pub struct Record {
    frames: Arc<Vec<Arc<ObjectFrame>>>,
    pixels: Arc<Vec<u32>>,
}

impl Record {
    /// Adds the result of the next frame.
    pub fn note(&mut self, frame: ObjectFrame) {
        Arc::make_mut(&mut self.pixels).push(frame.mask.as_ref().map_or(0, PackedMask::count) as u32);
        Arc::make_mut(&mut self.frames).push(Arc::new(frame));
    }

    /// The frames so far.
    pub fn frames(&self) -> &[Arc<ObjectFrame>] {
        &self.frames
    }

    /// Number of foreground pixels of each frame.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// The masks and objects of a run on pictures of this size from frame `first` on.
    pub fn output(&self, picture: (usize, usize), first: usize) -> Output {
        let frames = || Vec::clone(&self.frames);
        let masks = MaskField { picture, first, frames: frames() };
        let objects = ObjectField {
            followed: Followed::Nothing,
            picture,
            first,
            frames: frames(),
            trajectories: Vec::new(),
            watched: Watched::default(),
        };
        Output::of(masks).and(objects)
    }

    /// Memory of its own in bytes; earlier frames are shared with earlier records.
    pub fn own_bytes(&self) -> usize {
        let last = self.frames.last().map_or(0, |frame| frame.bytes());
        size_of_val(&self.frames[..]) + size_of_val(&self.pixels[..]) + last
    }

    /// Memory of all frames in bytes.
    pub fn bytes(&self) -> usize {
        self.own_bytes() + self.shared_bytes()
    }

    /// Memory of earlier frames in bytes.
    pub fn shared_bytes(&self) -> usize {
        self.frames.iter().rev().skip(1).map(|frame| frame.bytes()).sum()
    }
}
