//! Every estimator there is, in the order of the course.

use crate::block_matching::{
    AdaptiveRood, Diamond, FourStep, FullSearch, Hexagon, Hierarchical, LogSearch, NewThreeStep, Predictive,
    QuadrantSearch, ThreeStep,
};
use crate::features::Corners;
use crate::interest_points::{Harris, ShiTomasi};
use crate::moving_objects::{
    ConnectedComponents, FlowMagnitude, FrameDifference, MedianBackground, MixtureOfGaussians, RunningAverage,
    SingleGaussian, Subtraction,
};
use crate::optical_flow::{
    Clg, Farneback, HornSchunck, Klt, LucasKanade, NormalFlow, PointTrajectories, PyramidalLucasKanade, TvL1,
};
use crate::tracking::{BlobTracker, KalmanFilter, KalmanTracker, TrajectoryAnalysis};
use crate::variational::Variational;
use crate::{AnyEstimator, Error};

/// Every estimator with its default parameters, in the order of the course.
pub fn estimators() -> Vec<Box<dyn AnyEstimator>> {
    vec![
        Box::new(FullSearch::default()),
        Box::new(QuadrantSearch::default()),
        Box::new(LogSearch::default()),
        Box::new(ThreeStep::default()),
        Box::new(NewThreeStep::default()),
        Box::new(FourStep::default()),
        Box::new(Diamond::default()),
        Box::new(Hexagon::default()),
        Box::new(AdaptiveRood::default()),
        Box::new(Predictive::default()),
        Box::new(Hierarchical::default()),
        Box::new(NormalFlow::default()),
        Box::new(LucasKanade::default()),
        Box::new(PyramidalLucasKanade::default()),
        Box::new(Klt::default()),
        Box::new(Variational::<HornSchunck>::default()),
        Box::new(Variational::<Clg>::default()),
        Box::new(Variational::<TvL1>::default()),
        Box::new(Farneback::default()),
        Box::new(PointTrajectories::default()),
        Box::new(Corners::<Harris>::default()),
        Box::new(Corners::<ShiTomasi>::default()),
        Box::new(Subtraction::<FrameDifference>::default()),
        Box::new(Subtraction::<RunningAverage>::default()),
        Box::new(Subtraction::<MedianBackground>::default()),
        Box::new(Subtraction::<SingleGaussian>::default()),
        Box::new(Subtraction::<MixtureOfGaussians>::default()),
        Box::new(Subtraction::<FlowMagnitude>::default()),
        Box::new(ConnectedComponents::default()),
        Box::new(BlobTracker::default()),
        Box::new(KalmanFilter::default()),
        Box::new(KalmanTracker::default()),
        Box::new(TrajectoryAnalysis::default()),
    ]
}

/// The estimator called `id`, with its default parameters.
///
/// # Errors
/// A sentence with the ids there are.
pub fn estimator(id: &str) -> Result<Box<dyn AnyEstimator>, Error> {
    let all = estimators();
    let ids: Vec<_> = all.iter().map(|e| e.info().id).collect();
    let unknown = Error::new(format!("there is no estimator {id}; there are {}", ids.join(", ")));
    all.into_iter().find(|e| e.info().id == id).ok_or(unknown)
}
