//! The plots and matrices of scene flow.

use super::{Event, SceneFlow};
use crate::data::Pose;
use crate::geometry::Grid;
use crate::methods::scene_flow::{Draw, Fit};
use crate::products::scene_flow::depth_error;
use crate::products::{Reference, SceneFlowField};
use crate::run::Seen;
use crate::scene::{Matrix, Readout, Role, Series};

/// Ranges of depth in the plot of errors.
const RANGES: usize = 12;

impl SceneFlow {
    /// The error along the depth, by theory and against the truth.
    pub(super) fn error_plot(&self, seen: &Seen<Self>, field: &SceneFlowField) -> Option<Readout> {
        let reference = Reference { clip: seen.clip, frame: seen.before.fixed.frame };
        let rows = depth_error(field, &reference, (self.expected_sigma().disparity_px, RANGES));
        let line = |i: usize| rows.iter().map(|row| [row[0] as f32, row[i] as f32]).collect::<Vec<_>>();
        let deepest = rows.last()?[0];
        Some(Readout::Series(Series {
            is_sweep: true,
            decimals: Some(3),
            ..Series::new(
                "Error of the scene flow along the depth",
                ["depth Z (m)", "m"],
                deepest.ceil() as usize,
                vec![("σ by theory", Role::Predicted, line(2)), ("RMS error against the truth", Role::Error, line(1))],
            )
        }))
    }
}

/// A rigid motion, with the covariance of its translation.
pub(super) fn motion_matrices(pose: &Pose, covariance: Option<[[f64; 6]; 6]>) -> Readout {
    let mut matrices = vec![
        Matrix::of_rows("R", "rotation of the scene", &pose.rotation).with_decimals(4),
        vector("t", "translation of the scene, in m", pose.translation).with_role(Role::Result),
    ];
    let of_translation = |all: [[f64; 6]; 6]| Grid::from_fn(3, 3, |x, y| all[3 + y][3 + x]);
    matrices.extend(covariance.map(|all| Matrix::new("C", "covariance of t, in m²", of_translation(all))));
    Readout::Matrices(matrices)
}

/// Inliers of each sample and of the best one.
pub(super) fn history(events: &[Event]) -> Readout {
    let draws: Vec<&Draw> = events
        .iter()
        .filter_map(|event| match event {
            Event::Draw(draw) if draw.sample.is_some() => Some(&**draw),
            _ => None,
        })
        .collect();
    let inliers = |fit: Option<Fit>| fit.map_or(0.0, |fit| fit.score.inliers as f32);
    let line = |of: &dyn Fn(&Draw) -> Option<Fit>| {
        draws.iter().enumerate().map(|(i, draw)| [(i + 1) as f32, inliers(of(draw))]).collect::<Vec<_>>()
    };
    Readout::Series(Series {
        events: (1..=draws.len()).collect(),
        decimals: Some(0),
        ..Series::new(
            "Inliers of the samples",
            ["sample", "points"],
            draws.last().map_or(1, |draw| draw.needed.max(draw.drawn)),
            vec![
                ("sample", Role::Candidate, line(&|draw| draw.fit)),
                ("best so far", Role::Best, line(&|draw| draw.best)),
            ],
        )
    })
}

pub(super) fn vector(symbol: &'static str, name: &'static str, entries: [f64; 3]) -> Matrix {
    Matrix::column(symbol, name, &entries).with_rows(["X", "Y", "Z"]).with_decimals(3)
}
