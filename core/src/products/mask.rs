//! Foreground masks: the pixels of each frame that do not belong to the background.

use std::sync::Arc;

use super::{Assessment, Motion, ObjectFrame, Product, ProductKind, Reference, Table};
use crate::base::Error;
use crate::data::PackedMask;

/// The foreground mask of frame after frame.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// The results frame by frame, shared with the objects found in the masks.
    pub frames: Vec<Arc<ObjectFrame>>,
}

impl MaskField {
    /// The frames with a mask, and their masks.
    pub fn masks(&self) -> impl Iterator<Item = (usize, &PackedMask)> {
        self.frames.iter().enumerate().filter_map(|(i, frame)| Some((self.first + i, frame.mask.as_ref()?)))
    }
}

impl Product for MaskField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "mask",
        name: "Foreground masks",
        summary: "The foreground pixels of each frame.",
        motion: Motion::Nowhere,
        is_of_single_frames: true,
        measures: &[],
    };

    fn table(&self) -> Option<Table> {
        None
    }

    fn assess(&self, _reference: &Reference<'_>) -> Result<Assessment, Error> {
        Ok(Assessment::default())
    }

    fn last_frame(&self) -> Option<usize> {
        Some(self.first + self.frames.len().saturating_sub(1))
    }
}
