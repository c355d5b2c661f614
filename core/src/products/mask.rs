//! Foreground masks: the pixels of each frame that do not belong to the background.

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::objects::score::Matches;
use super::{Assessment, Figure, Measure, Motion, ObjectFrame, Product, ProductKind, Reference, Table};
use crate::base::Error;
use crate::data::PackedMask;

/// The measures of a mask against the truth, over all its pixels together.
const MEASURES: [Measure; 3] = [
    Measure::new(
        "mask_f1",
        "F₁ score of the foreground pixels: the harmonic mean of precision and recall. Shadows count as background; the first frame, \
         which has no background yet, is left out.",
    )
    .in_column("mask F₁", 3).larger_is_better()
    .against_truth(),
    Measure::new("mask_precision", "Share of the foreground pixels that are true.")
        .in_column("mask precision", 3).larger_is_better()
        .against_truth(),
    Measure::new("mask_recall", "Share of the true foreground pixels that are found.")
        .in_column("mask recall", 3).larger_is_better()
        .against_truth(),
];

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

impl MaskField {
    /// The pixels of all masks after the first, compared with the truth; `None` where there is none.
    fn matched(&self, reference: &Reference<'_>) -> Result<Option<Matches>, Error> {
        let Some(truth) = reference.clip.truth() else { return Ok(None) };
        let mut all: Option<Matches> = None;
        for (t, mask) in self.masks().filter(|(t, _)| *t > self.first) {
            reference.clip.wanted()?;
            if let Some(truth) = truth.foreground(t)? {
                let matches = Matches::of_pixels(&truth.compare(mask)?);
                all = Some(all.map_or(matches, |all| all.and(matches)));
            }
        }
        Ok(all)
    }
}

impl Product for MaskField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "mask",
        name: "Foreground masks",
        summary: "The foreground pixels of each frame.",
        motion: Motion::Nowhere,
        is_of_single_frames: true,
        has_pictures: false,
        measures: &[&MEASURES],
    };

    fn table(&self) -> Option<Table> {
        None
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let matched = self.matched(reference);
        reference.clip.wanted()?;
        Ok(match matched {
            Ok(None) => Assessment::default(),
            Ok(Some(matches)) => {
                let values = [matches.f1(), matches.precision(), matches.recall()];
                let [f1, precision, recall] = values.map(|share| Matches::text(share, 3));
                let shares = match matches.f1() {
                    Some(_) => format!("{precision}, {recall}, {f1}"),
                    None => {
                        "undefined: neither the masks nor the ground truth have foreground in labelled pixels".into()
                    }
                };
                let scores_fact = fact("Mask precision, recall, F₁", shares);
                let headline = matches.f1().map_or_else(String::new, |_| format!("mask F₁ {f1}"));
                let scored = Assessment { headline, ..Assessment::default() };
                scored.with(scores(&MEASURES, values.map(Figure::from)), vec![scores_fact])
            }
            Err(error) => Assessment { truth_error: Some(error), ..Assessment::default() },
        })
    }

    fn last_frame(&self) -> Option<usize> {
        Some(self.first + self.frames.len().saturating_sub(1))
    }
}
