//! The registry of all estimators, in the order of the course.

use super::glossary::GLOSSARY;
use crate::base::{Error, words};
use crate::families::{
    block_matching::{
        AdaptiveRood, Diamond, FourStep, FullSearch, Hexagon, Hierarchical, LogSearch, NewThreeStep, Predictive,
        QuadrantSearch, SuccessiveElimination, ThreeStep,
    },
    correspondence::{
        EpipolarGeometry, FeatureMatching, FeatureTracker, GlobalMotion, ImageAlignment, Mosaic, PhaseCorrelation,
        Stabilization, TemplateMatching,
    },
    interest_points::{Fast, Harris, Orb, ShiTomasi, Sift, Surf},
    motion_segmentation::{FlowSegmentation, MotionClustering, MotionLayers, TrajectoryClustering},
    moving_objects::{
        CompensatedDifference, ConnectedComponents, FlowMagnitude, FrameDifference, KnnBackground, MedianBackground,
        MixtureOfGaussians, RunningAverage, SingleGaussian,
    },
    optical_flow::{
        Clg, Farneback, HornSchunck, Klt, LucasKanade, NormalFlow, PointTrajectories, PyramidalLucasKanade, TvL1,
    },
    region_tracking::{
        ActiveContour, Camshift, ChanVese, CorrelationFilter, GreedyContour, MeanShift, ParticleFilter, Rapid,
        TemplateTracker,
    },
    stereo::{BlockStereo, SceneFlow, SemiGlobalMatching},
    tracking::{BlobTracker, JointProbabilistic, KalmanFilter, KalmanTracker, MultipleHypothesis, TrajectoryAnalysis},
};
use crate::methods::{
    features::Corners, geometric::robust::Robust, multi_object::MultiTracking, region::RegionTracking,
    segmentation::SegmentationRun, subtraction::Subtraction, variational::Variational,
};
use crate::run::{AnyEstimator, Course, Entries, Entry, Info};

impl Entries for Course {
    const ENTRIES: &'static [Entry] = &[
        Entry::of::<FullSearch>(),
        Entry::of::<SuccessiveElimination>(),
        Entry::of::<QuadrantSearch>(),
        Entry::of::<LogSearch>(),
        Entry::of::<ThreeStep>(),
        Entry::of::<NewThreeStep>(),
        Entry::of::<FourStep>(),
        Entry::of::<Diamond>(),
        Entry::of::<Hexagon>(),
        Entry::of::<AdaptiveRood>(),
        Entry::of::<Predictive>(),
        Entry::of::<Hierarchical>(),
        Entry::of::<NormalFlow>(),
        Entry::of::<LucasKanade>(),
        Entry::of::<PyramidalLucasKanade>(),
        Entry::of::<Klt>(),
        Entry::of::<Variational<HornSchunck>>(),
        Entry::of::<Variational<Clg>>(),
        Entry::of::<Variational<TvL1>>(),
        Entry::of::<Farneback>(),
        Entry::of::<PointTrajectories>(),
        Entry::of::<SegmentationRun<MotionClustering>>(),
        Entry::of::<SegmentationRun<MotionLayers>>(),
        Entry::of::<SegmentationRun<FlowSegmentation>>(),
        Entry::of::<TrajectoryClustering>(),
        Entry::of::<Corners<Harris>>(),
        Entry::of::<Corners<ShiTomasi>>(),
        Entry::of::<Fast>(),
        Entry::of::<Sift>(),
        Entry::of::<Surf>(),
        Entry::of::<Orb>(),
        Entry::of::<TemplateMatching>(),
        Entry::of::<FeatureMatching>(),
        Entry::of::<FeatureTracker>(),
        Entry::of::<Robust<GlobalMotion>>(),
        Entry::of::<Robust<EpipolarGeometry>>(),
        Entry::of::<PhaseCorrelation>(),
        Entry::of::<ImageAlignment>(),
        Entry::of::<Stabilization>(),
        Entry::of::<Mosaic>(),
        Entry::of::<Subtraction<FrameDifference>>(),
        Entry::of::<Subtraction<RunningAverage>>(),
        Entry::of::<Subtraction<MedianBackground>>(),
        Entry::of::<Subtraction<SingleGaussian>>(),
        Entry::of::<Subtraction<MixtureOfGaussians>>(),
        Entry::of::<Subtraction<KnnBackground>>(),
        Entry::of::<Subtraction<FlowMagnitude>>(),
        Entry::of::<Subtraction<CompensatedDifference>>(),
        Entry::of::<ConnectedComponents>(),
        Entry::of::<MultiTracking<BlobTracker>>(),
        Entry::of::<KalmanFilter>(),
        Entry::of::<MultiTracking<KalmanTracker>>(),
        Entry::of::<MultiTracking<MultipleHypothesis>>(),
        Entry::of::<MultiTracking<JointProbabilistic>>(),
        Entry::of::<TrajectoryAnalysis>(),
        Entry::of::<RegionTracking<MeanShift>>(),
        Entry::of::<RegionTracking<Camshift>>(),
        Entry::of::<RegionTracking<ParticleFilter>>(),
        Entry::of::<RegionTracking<CorrelationFilter>>(),
        Entry::of::<RegionTracking<TemplateTracker>>(),
        Entry::of::<RegionTracking<Rapid>>(),
        Entry::of::<RegionTracking<ActiveContour>>(),
        Entry::of::<RegionTracking<GreedyContour>>(),
        Entry::of::<RegionTracking<ChanVese>>(),
        Entry::of::<BlockStereo>(),
        Entry::of::<SemiGlobalMatching>(),
        Entry::of::<SceneFlow>(),
    ];
}

/// Returns all estimators with default parameters, in the order of the course.
pub fn estimators() -> Vec<Box<dyn AnyEstimator>> {
    Course::ENTRIES.iter().map(|entry| (entry.make)()).collect()
}

/// Returns the estimator with this id, or this name as people see it, with default parameters.
///
/// # Errors
/// A sentence with the known ids.
pub fn estimator(id: &str) -> Result<Box<dyn AnyEstimator>, Error> {
    Course::entry(id).map(|entry| (entry.make)()).or_else(|unknown| {
        let named = estimators().into_iter().find(|estimator| words::is_name(id, estimator.info().name));
        named.ok_or_else(|| match known_as(id) {
            Some(own) => Error::new(format!("there is no estimator {id}; the glossary has it as {own}")),
            None => unknown,
        })
    })
}

/// The id of the estimator that the glossary knows by the name `typed`, if there is one.
fn known_as(typed: &str) -> Option<&'static str> {
    let term = GLOSSARY.iter().find(|term| term.spellings().any(|spelling| words::is_name(typed, spelling)))?;
    let is_meant = |info: &Info| {
        term.spellings().any(|spelling| [info.id, info.name].iter().any(|name| words::is_name(spelling, name)))
    };
    estimators().iter().map(|estimator| estimator.info()).find(|info| is_meant(info)).map(|info| info.id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_the_glossary_leads_to_its_estimator() {
        let message = |id: &str| estimator(id).err().map(|error| error.to_string()).unwrap_or_default();
        for id in ["mosse", "MOSSE", "kcf"] {
            assert!(message(id).ends_with("the glossary has it as correlation-filter"), "{}", message(id));
        }
        // A term that is no estimator, a misspelling and a word without a meaning.
        assert!(message("aperture problem").contains("there are "), "{}", message("aperture problem"));
        assert!(message("no-search").contains("the nearest is log-search"), "{}", message("no-search"));
        assert!(message("magic").contains("there are "), "{}", message("magic"));
    }
}
