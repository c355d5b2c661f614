//! The level and the keypoint of ORB at work.

use std::sync::Arc;

use super::{Event, Level, Orb};
use crate::methods::features::brief::{Moments, Pair, turned};
use crate::run::Seen;

/// The keypoint being described, with its level and its values so far.
pub(super) struct Probe<'a> {
    pub index: usize,
    pub level: &'a Level,
    pub place: (usize, usize),
    pub moments: Moments,
    /// The bits so far.
    pub bits: Vec<bool>,
}

impl Probe<'_> {
    /// A pair of the pattern, turned by the orientation.
    pub(super) fn turned(&self, pair: Pair) -> Pair {
        turned(pair, self.moments.direction())
    }

    /// The pixel of the level at an offset.
    pub(super) fn pixel(&self, [i, j]: [i32; 2]) -> (usize, usize) {
        ((self.place.0 as i32 + i) as usize, (self.place.1 as i32 + j) as usize)
    }

    /// The place in the frame of an offset.
    pub(super) fn in_frame(&self, [i, j]: [f32; 2]) -> [f32; 2] {
        self.level.of.in_frame([self.place.0 as f32 + i, self.place.1 as f32 + j])
    }
}

impl Orb {
    /// Returns the current level.
    pub(super) fn level<'a>(&self, seen: &'a Seen<Self>) -> Option<&'a Arc<Level>> {
        seen.events.iter().find_map(|event| match event {
            Event::Resampled(level) => Some(level),
            _ => None,
        })
    }

    /// Returns the current keypoint.
    pub(super) fn probe<'a>(&self, seen: &'a Seen<Self>) -> Option<Probe<'a>> {
        let state = seen.before;
        let index = state.current()?;
        let corner = state.corners.get(index)?;
        let moments = seen.events.iter().find_map(|event| match event {
            Event::Centroid(moments) => Some(*moments),
            _ => None,
        })?;
        let bits = seen.events.iter().filter_map(|event| match event {
            Event::Compared(bit) => Some(*bit),
            _ => None,
        });
        let level = &*state.levels[corner.level];
        Some(Probe { index, level, place: corner.place, moments, bits: bits.collect() })
    }
}

impl Level {
    /// Returns the pixel of a row-major index.
    pub(super) fn place(&self, index: u32) -> (usize, usize) {
        let width = self.of.picture.width();
        (index as usize % width, index as usize / width)
    }

    /// Returns the position in the frame of a row-major index.
    pub(super) fn in_frame(&self, index: u32) -> [f32; 2] {
        let (x, y) = self.place(index);
        self.of.in_frame([x as f32, y as f32])
    }

    /// Returns the response of a corner.
    pub(super) fn response(&self, index: u32) -> f32 {
        self.ranked.iter().find(|(place, _)| *place == index).map_or(f32::NAN, |(_, response)| *response)
    }
}
