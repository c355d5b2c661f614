//! The products of a run, each of one kind, and each kind a module of this folder.
//!
//! A product owns its data, its table, its comparison with ground truth and its default view. [`KINDS`] is the one list of
//! them: window, command line, comparison and export go through it.
//!
//! An estimator declares its products (`Estimator::PRODUCES`); `output.get::<DenseField>()` returns one from an [`Output`]. A
//! [`Measure`] (key, definition, column, which of two values is better) is declared once; the JSON of a run, the facts in the
//! window and the columns of a comparison follow from it. Each pixel of a block vector field moves with the block whose centre
//! is nearest, and blocks at the right and bottom edges are cut to the picture: this defines dense flow, prediction and errors
//! of block vectors.

mod assessment;
mod block_vectors;
mod coding;
pub(crate) mod consistency;
mod dense_flow;
pub mod disparity;
pub mod epipolar;
mod flow_error;
pub mod keypoints;
mod mask;
mod matches;
pub mod metrics;
pub mod model;
pub mod objects;
mod output;
pub mod path;
mod prediction;
mod product;
mod record;
pub mod region;
pub(crate) mod registration;
mod repeatability;
pub mod scene_flow;
pub mod segments;
mod streaks;
pub mod table;
mod tracks;

pub use assessment::{Assessment, Better, Column, Figure, Measure, Reference, Score};
pub use block_vectors::{Block, BlockField, BlockGrid, BlockVector};
pub use coding::Coding;
pub use consistency::{Agreement, Consistency};
pub use dense_flow::DenseField;
pub use disparity::DisparityField;
pub use epipolar::EpipolarField;
pub use flow_error::EPE;
pub use keypoints::{Descriptor, Feature, Keypoint, PointField, Status};
pub use mask::MaskField;
pub use matches::{Match, MatchErrors, MatchField, MatchStatus, RIGHT_WITHIN_PX};
pub use metrics::FlowError;
pub use model::{Model, ModelField, Support};
pub use objects::{Followed, Object, ObjectField, ObjectFrame, TrackStatus, Watched};
pub use output::Output;
pub use path::{PathField, Views};
pub use prediction::{PSNR, predict};
pub use product::{AnyProduct, Confidence, Motion, Product, ProductKind, Tested};
pub use record::Record;
pub use region::{Region, RegionField, RegionFrame};
pub use repeatability::{Repeatability, repeatability};
pub use scene_flow::{EgoMotion, SceneFlowField};
pub use segments::{AffineMotion, Segment, SegmentField, SegmentFrame};
pub use streaks::{Streak, Streaks};
pub use table::{Cell, Table};
pub use tracks::{Track, TrackField};

/// Every kind of product, in display order.
pub const KINDS: &[&ProductKind] = &[
    BlockField::KIND,
    DenseField::KIND,
    DisparityField::KIND,
    SceneFlowField::KIND,
    PointField::KIND,
    TrackField::KIND,
    MatchField::KIND,
    ModelField::KIND,
    EpipolarField::KIND,
    PathField::KIND,
    MaskField::KIND,
    SegmentField::KIND,
    ObjectField::KIND,
    RegionField::KIND,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Flow;
    use crate::geometry::Grid;

    #[test]
    fn kinds_have_names_of_their_own() {
        for (i, kind) in KINDS.iter().enumerate() {
            assert!(KINDS[..i].iter().all(|other| other.id != kind.id && other.name != kind.name), "{}", kind.id);
            assert!(kind.summary.ends_with('.') && !kind.summary.contains('\n'), "{}", kind.id);
        }
    }

    #[test]
    fn measures_have_keys_of_their_own() {
        for kind in KINDS {
            let keys: Vec<_> = kind.measures.iter().copied().flatten().map(|measure| measure.key).collect();
            assert!(keys.iter().enumerate().all(|(i, key)| !keys[..i].contains(key)), "{}: {keys:?}", kind.id);
        }
    }

    #[test]
    fn products_are_found_by_their_kind() {
        let flow = Flow(Grid::new(2, 2, [1.0, 0.0]));
        let dense = DenseField { flow: flow.clone(), confidence: None };
        let points = PointField { picture: (2, 2), points: Vec::new(), keypoints: Vec::new() };
        let output = Output::of(points.clone()).and(dense.clone());
        assert_eq!((output.get::<DenseField>(), output.get::<PointField>()), (Some(&dense), Some(&points)));
        assert_eq!((output.get::<BlockField>(), output.motion()), (None, Motion::Pixels));
        assert_ne!(output, Output::of(dense.clone()).and(points));
        let still =
            output.clone().map(|_: DenseField| DenseField { flow: Flow(flow.0.map(|_| [0.0; 2])), confidence: None });
        assert!(still != output && still.get::<PointField>() == output.get::<PointField>());
    }
}
