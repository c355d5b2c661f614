//! Endpoint and angular errors against the true flow.

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::{Assessment, FlowError, Measure, Reference, metrics};
use crate::base::{Error, words::grouped};
use crate::data::{Flow, Truth};
use crate::geometry::Grid;

/// The mean endpoint error in px.
pub const EPE: Measure =
    Measure::new("epe_px", "Mean endpoint error in px over the pixels with known true flow and an estimate.")
        .in_column("EPE px", 3)
        .smaller_is_better()
        .against_truth();

pub(super) const MEASURES: [Measure; 9] = [
    EPE,
    Measure::new("epe_median_px", "Median endpoint error in px."),
    Measure::new("epe_p95_px", "95th percentile of the endpoint error in px."),
    Measure::new("r0.5", "Share of the pixels with an endpoint error above 0.5 px, R0.5 of the Middlebury benchmark."),
    Measure::new("r1.0", "Share of the pixels with an endpoint error above 1 px."),
    Measure::new("r2.0", "Share of the pixels with an endpoint error above 2 px."),
    Measure::new("aae_deg", "Mean angular error in degrees."),
    Measure::new("known", "Number of pixels compared: those with known true flow and an estimate.")
        .in_column("EPE pixels", 0),
    Measure::new(
        "coverage",
        "Coverage: share of the pixels with known true flow that have an estimate; for dense fields.",
    ),
];

/// The elements compared.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Pixels,
    Features,
}

pub(super) fn of_field(flow: &Flow, reference: &Reference<'_>) -> Assessment {
    or_unknown(true_flow(reference).and_then(|truth| assess(flow, truth, Of::Pixels)))
}

pub(super) fn of_points(flow: &Flow, reference: &Reference<'_>) -> Assessment {
    or_unknown(true_flow(reference).and_then(|truth| assess(flow, truth, Of::Features)))
}

/// The tracked features of a frame: positions in px and displacements in px/frame.
pub(super) type Moved = Vec<([f32; 2], [f32; 2])>;

/// The errors of all displacements of features in `frames`.
pub(super) fn of_frames(frames: impl Iterator<Item = (usize, Moved)>, reference: &Reference<'_>) -> Assessment {
    let both = reference.clip.truth().map(|truth| displacements(frames, &**truth)).transpose();
    let mut all = or_unknown(both.and_then(|both| match both {
        Some((found, truth)) => assess(&found, Some(truth), Of::Features),
        None => assess(&Flow(Grid::new(1, 1, Flow::UNKNOWN)), None, Of::Features),
    }));
    // The sentences tell the error of a pair.
    for fact in all.facts.iter_mut().filter(|fact| fact.label == MEAN) {
        fact.label = "Mean endpoint error, all frames";
    }
    all
}

/// The label of the mean endpoint error.
const MEAN: &str = "Mean endpoint error";

fn or_unknown(assessment: Result<Assessment, Error>) -> Assessment {
    assessment.unwrap_or_else(|error| Assessment {
        facts: vec![fact("Endpoint error", format!("unknown: {error}"))],
        truth_error: Some(error),
        ..Assessment::default()
    })
}

fn true_flow(reference: &Reference<'_>) -> Result<Option<Arc<Flow>>, Error> {
    Ok(reference.clip.truth().map(|truth| truth.flow(reference.frame)).transpose()?.flatten())
}

/// The estimated displacements with known truth, and the true ones, as one row each.
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
            Some(_) => "unknown: no estimate where the true flow is known",
            None => "unknown: no true flow for this frame; open one to see errors",
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
        fact(MEAN, format!("{epe_px:.3} px")),
        fact("Median, 95th percentile", format!("{epe_median_px:.3} px, {epe_p95_px:.3} px")),
        fact("R0.5, R1, R2", format!("{low:.1} %, {middle:.1} %, {high:.1} %")),
        fact("Mean angular error", format!("{aae_deg:.2}°")),
        fact(
            "Compared",
            match coverage {
                Some(share) => format!("{} pixels, coverage {:.0} %", grouped(known), 100.0 * share),
                None => format!("{} displacements", grouped(known)),
            },
        ),
    ];
    let own = Assessment { errors: Some(distribution), ..Assessment::default() };
    Ok(own.with(scores(&MEASURES, [a, b, c, d, e, f, g, known.into(), coverage.into()]), facts))
}
