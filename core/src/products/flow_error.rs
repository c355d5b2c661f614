//! Errors of displacements against the true flow, where it is known.

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::{Assessment, FlowError, Measure, Reference, metrics};
use crate::base::{Error, words::grouped};
use crate::data::{Flow, Truth};
use crate::geometry::Grid;

pub(super) const MEASURES: [Measure; 9] = [
    Measure::new("epe_px", "Mean endpoint error in px over the pixels whose true motion is known and was estimated.")
        .in_column("EPE px", 3),
    Measure::new("epe_median_px", "Median endpoint error in px."),
    Measure::new("epe_p95_px", "The endpoint error in px that 95 % of the pixels do not exceed."),
    Measure::new(
        "r0.5",
        "Share of the pixels whose endpoint error exceeds 0.5 px, the R0.5 of the Middlebury benchmark.",
    ),
    Measure::new("r1.0", "Share of the pixels whose endpoint error exceeds 1 px."),
    Measure::new("r2.0", "Share of the pixels whose endpoint error exceeds 2 px."),
    Measure::new("aae_deg", "Mean angular error in degrees."),
    Measure::new("known", "Pixels compared: those whose motion is known and was estimated.").in_column("EPE of", 0),
    Measure::new("coverage", "Share of the pixels of known motion that were compared; of fields."),
];

/// What errors are of.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Pixels,
    Features,
}

/// The errors of a field in which every pixel has a displacement.
pub(super) fn of_field(flow: &Flow, reference: &Reference<'_>) -> Assessment {
    told(true_flow(reference).and_then(|truth| assess(flow, truth, Of::Pixels)))
}

/// The errors of a flow that only features have.
pub(super) fn of_points(flow: &Flow, reference: &Reference<'_>) -> Assessment {
    told(true_flow(reference).and_then(|truth| assess(flow, truth, Of::Features)))
}

/// Features of a frame that have a displacement: where they are in px, and where they go in px/frame.
pub(super) type Moved = Vec<([f32; 2], [f32; 2])>;

/// The errors of all displacements of features in `frames`.
pub(super) fn of_frames(frames: impl Iterator<Item = (usize, Moved)>, reference: &Reference<'_>) -> Assessment {
    let both = reference.clip.truth().map(|truth| displacements(frames, &**truth)).transpose();
    told(both.and_then(|both| match both {
        Some((found, truth)) => assess(&found, Some(truth), Of::Features),
        None => assess(&Flow(Grid::new(1, 1, Flow::UNKNOWN)), None, Of::Features),
    }))
}

fn told(assessment: Result<Assessment, Error>) -> Assessment {
    assessment.unwrap_or_else(|error| Assessment {
        facts: vec![fact("Endpoint error", format!("unknown: {error}"))],
        truth_error: Some(error),
        ..Assessment::default()
    })
}

fn true_flow(reference: &Reference<'_>) -> Result<Option<Arc<Flow>>, Error> {
    Ok(reference.clip.truth().map(|truth| truth.flow(reference.frame)).transpose()?.flatten())
}

/// What was found of all displacements whose truth is known, and that truth, in a row.
fn displacements(frames: impl Iterator<Item = (usize, Moved)>, truth: &dyn Truth) -> Result<(Flow, Arc<Flow>), Error> {
    let mut both = Vec::new();
    for (frame, moved) in frames {
        let Some(truth) = truth.flow(frame)? else { continue };
        both.extend(moved.into_iter().filter_map(|(at, displacement)| {
            let [x, y] = at.map(|c| c.round() as usize);
            truth.0.get(x, y)?;
            Some((displacement, truth.at(x, y)?))
        }));
    }
    // A grid has at least one cell.
    both.push((Flow::UNKNOWN, Flow::UNKNOWN));
    let [found, known] =
        [0, 1].map(|i| Flow(Grid::from_fn(both.len(), 1, |x, _| if i == 0 { both[x].0 } else { both[x].1 })));
    Ok((found, Arc::new(known)))
}

fn assess(flow: &Flow, truth: Option<Arc<Flow>>, of: Of) -> Result<Assessment, Error> {
    let compared = match &truth {
        Some(truth) => metrics::flow_error(flow, truth)?.map(|error| (error, truth)),
        None => None,
    };
    let Some((error, truth)) = compared else {
        let why = match truth {
            Some(_) => "unknown: no displacement lies where the true flow is known",
            None => "unknown: there is no true flow for this frame",
        };
        return Ok(Assessment::default().with(Vec::new(), vec![fact("Endpoint error", why)]));
    };
    let distribution = metrics::distribution(&metrics::endpoint_errors(flow, truth)?, &error);
    let FlowError { epe_px, epe_median_px, epe_p95_px, beyond, aae_deg, known } = error;
    let all = truth.0.cells().iter().filter(|uv| uv.iter().all(|c| c.is_finite())).count();
    let coverage = (of == Of::Pixels).then(|| known as f64 / all.max(1) as f64);
    let [r0_5, r1_0, r2_0] = beyond;
    let values = [epe_px, epe_median_px, epe_p95_px, r0_5, r1_0, r2_0, aae_deg].map(Into::into);
    let [a, b, c, d, e, f, g] = values;
    let [low, middle, high] = beyond.map(|share| 100.0 * share);
    let facts = vec![
        fact("Mean endpoint error", format!("{epe_px:.3} px")),
        fact("Median, 95 % below", format!("{epe_median_px:.3} px, {epe_p95_px:.3} px")),
        fact("Above 0.5, 1, 2 px", format!("{low:.1} %, {middle:.1} %, {high:.1} %")),
        fact("Mean angular error", format!("{aae_deg:.2}°")),
        fact(
            "Errors of",
            match coverage {
                Some(share) => format!("{} pixels, {:.0} % of those of known motion", grouped(known), 100.0 * share),
                None => format!("{} displacements", grouped(known)),
            },
        ),
    ];
    let own = Assessment { errors: Some(distribution), ..Assessment::default() };
    Ok(own.with(scores(&MEASURES, [a, b, c, d, e, f, g, known.into(), coverage.into()]), facts))
}
