//! The parameters of matching, shared by all estimators that begin with matches.

use std::sync::Arc;

use super::describe::{Describe, Described, DescriptorKind, PatchCost, Patches};
use super::nearest::Candidates;
use crate::base::{Error, Threads};
use crate::data::{Clip, Frame};
use crate::params;
use crate::products::Match;
use crate::run::{Keypoints, Need, Stage};

params! {
    /// Parameters of the matching of keypoints.
    pub struct Settings {
        /// Detector of the keypoints in both frames.
        detector: Stage<Keypoints> = Stage::named("sift").with("max-points", "500");
        /// Descriptor of the keypoints.
        descriptor: DescriptorKind = DescriptorKind::Auto;
        /// Side of the patches; an even side is rounded up.
        patch: usize = 15, 3..=63, "px";
        /// Comparison of patches.
        patch_cost: PatchCost = PatchCost::Zncc;
        /// Ratio test: largest accepted ratio of the distances of the nearest and the second nearest neighbour. 1 accepts all.
        ratio: f32 = 0.8, 0.3..=1.0;
        /// Accept a match only if it is the nearest neighbour in both directions.
        cross_check: bool = true;
        /// Search radius: largest distance of a candidate from the keypoint's position. 0 searches the whole frame.
        radius: usize = 0, 0..=2000, "px";
    }
    advanced { "patch", "patch-cost", "radius" }
    when {
        "patch": |p| p.descriptor.may_be_patches(), "The side has no effect unless patches are compared.";
        "patch-cost": |p| p.descriptor.may_be_patches(), "Their comparison has no effect unless patches are compared.";
    }
}

/// The keypoints of a pair of frames.
#[derive(Debug)]
pub struct Pair {
    /// The frames.
    pub frames: [Arc<Frame>; 2],
    /// Their keypoints with descriptors.
    pub sides: [Described; 2],
}

impl Settings {
    /// Detects and describes the keypoints of frames `t` and `t` + 1.
    ///
    /// # Errors
    /// If a frame cannot be read, or the detector refuses it.
    pub fn pair(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Pair, Error> {
        let frames = clip.pair(t)?;
        Ok(Pair { sides: [self.side(clip, t, threads)?, self.side(clip, t + 1, threads)?], frames })
    }

    /// Detects and describes the keypoints of frame `t`.
    ///
    /// # Errors
    /// If it cannot be read, or the detector refuses it.
    pub fn side(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Described, Error> {
        let id = self.detector.estimator().info().id;
        let field = self.detector.points(clip, t, threads)?;
        self.describe().describe((clip.frame(t)?.luma(), field), id, threads)
    }

    /// The nearest neighbours of all keypoints of a pair that have one, with the outcome of the tests.
    ///
    /// # Errors
    /// If the work was cancelled.
    pub fn matches(&self, pair: &Pair, clip: &Clip, threads: &Threads) -> Result<Vec<Match>, Error> {
        let candidates = self.candidates(pair);
        let [here, there] = pair.sides.each_ref();
        let one = |index: usize| candidates.compare(index, &mut ()).map(|found| found.matched(here, index, there));
        let all = threads.map_while(here.points.len(), || clip.wanted(), one)?;
        Ok(all.into_iter().flatten().collect())
    }

    fn describe(&self) -> Describe {
        let patches = Patches { reach: self.patch / 2, cost: self.patch_cost };
        Describe { kind: self.descriptor, patches }
    }

    /// Half the side of the patches.
    pub fn reach(&self) -> usize {
        self.patch / 2
    }

    /// The candidates among the keypoints of a pair.
    pub fn candidates<'a>(&self, pair: &'a Pair) -> Candidates<'a> {
        self.candidates_of(pair.sides.each_ref())
    }

    /// The candidates among the keypoints of two frames.
    pub fn candidates_of<'a>(&self, sides: [&'a Described; 2]) -> Candidates<'a> {
        Candidates {
            sides,
            admits: None,
            radius_px: (self.radius > 0).then_some(self.radius as f32),
            ratio: self.ratio,
            cross_check: self.cross_check,
        }
    }

    /// The memory of keypoints and descriptors, and of the detector.
    pub fn need(&self, clip: &Clip) -> Need {
        /// Bytes of a described keypoint, of which there is at most about one per 100 px.
        const KEYPOINT: f64 = 700.0;
        let Need { run, .. } = self.detector.need(clip);
        Need::per_pixel(clip, [2.0 * KEYPOINT / 100.0; 2]).and([run as f64; 2])
    }
}

impl Pair {
    /// Memory of keypoints and descriptors in bytes.
    pub fn bytes(&self) -> usize {
        self.sides.iter().map(Described::bytes).sum()
    }
}
