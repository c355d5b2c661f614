//! Dense flow: one displacement per pixel.

use super::{
    Assessment, Cell, Confidence, Motion, Product, ProductKind, Reference, Table, flow_error, predict, prediction,
};
use crate::base::Error;
use crate::data::{Flow, Histogram, Interpolation};
use crate::geometry::{Border, Gray};

/// One displacement per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseField {
    /// Displacements in px/frame; unknown where there is no estimate, or none yet.
    pub flow: Flow,
    /// Confidence of each displacement, larger is better, if the estimator has one.
    pub confidence: Option<Confidence>,
}

/// Border and interpolation of the prediction of frame t from frame t + 1.
const SAMPLING: (Border, Interpolation) = (Border::Replicate, Interpolation::Bilinear);

impl Product for DenseField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "dense-flow",
        name: "Dense flow",
        summary: "One displacement for each pixel of the picture.",
        motion: Motion::Pixels,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&prediction::MEASURES, &flow_error::MEASURES],
    };

    /// Position and displacement of the pixels of known flow in raster order, with their confidence if there is one.
    fn table(&self) -> Option<Table> {
        let (width, height) = self.flow.0.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let known = places.filter_map(|place| Some((place, self.flow.at(place.0, place.1)?)));
        Some(match &self.confidence {
            Some(Confidence { name, values }) => {
                let row = |((x, y), [u, v]): ((usize, usize), [f32; 2])| -> [Cell; 5] {
                    [x.into(), y.into(), u.into(), v.into(), values[(x, y)].into()]
                };
                Table::new(["x_px", "y_px", "u_px", "v_px", name], known.map(row))
            }
            None => {
                let row = |((x, y), [u, v]): ((usize, usize), [f32; 2])| -> [Cell; 4] {
                    [x.into(), y.into(), u.into(), v.into()]
                };
                Table::new(["x_px", "y_px", "u_px", "v_px"], known.map(row))
            }
        })
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let next = &reference.clip.pair_or_last(reference.frame)?[1];
        let is_known = self.flow.0.cells().iter().any(|uv| uv.iter().all(|c| c.is_finite()));
        let predicted = match is_known {
            true => prediction::assess(&predict(&self.flow, next.luma(), SAMPLING), None, reference)?,
            false => prediction::undefined(),
        };
        Ok(predicted.and(flow_error::of_field(&self.flow, reference)))
    }

    fn flow(&self) -> Option<Flow> {
        Some(self.flow.clone())
    }

    fn confidence(&self) -> Option<&Confidence> {
        self.confidence.as_ref()
    }

    fn prediction(&self, next: &Gray) -> Option<Gray> {
        Some(predict(&self.flow, next, SAMPLING))
    }

    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        let known = |uv: &[f32; 2]| Some(*uv).filter(|uv| uv.iter().all(|c| c.is_finite()));
        Some(self.flow.0.cells().iter().map(known).collect())
    }

    fn histogram(&self) -> Option<Histogram> {
        Histogram::of_pixels(&self.flow)
    }
}
