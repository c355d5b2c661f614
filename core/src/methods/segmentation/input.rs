//! The flow that is segmented: of a stage, or the truth.

use std::sync::Arc;

use crate::base::{Error, Threads};
use crate::data::{Clip, Flow};
use crate::run::{DenseFlow, Need, Stage};
use crate::{choices, params};

choices! {
    /// The flow that is segmented.
    pub enum FlowSource {
        /// The flow that a method estimates.
        Estimated = "estimated" "Estimated",
        /// The true flow, where it is known.
        Truth = "truth" "Ground truth",
    }
}

params! {
    /// The flow that is segmented.
    pub struct FlowInput {
        /// Flow that is segmented. The true flow shows what the segmentation can do by itself.
        flow_source: FlowSource = FlowSource::Estimated;
        /// Method of the dense optical flow. Used with the estimated flow only.
        flow: Stage<DenseFlow> = Stage::named("tv-l1");
    }
    when {
        "flow": |p| p.flow_source == FlowSource::Estimated, "The method has no effect on the true flow.";
    }
}

impl FlowInput {
    /// Checks that there is a flow for frame `t`.
    ///
    /// # Errors
    /// If the true flow is asked for and not known.
    pub fn check(&self, clip: &Clip, t: usize) -> Result<(), Error> {
        match self.flow_source {
            FlowSource::Estimated => Ok(()),
            FlowSource::Truth => true_flow(clip, t).map(|_| ()),
        }
    }

    /// The flow from frame `t` to frame `t + 1`.
    ///
    /// # Errors
    /// If the true flow is asked for and not known, or the method fails.
    pub fn between(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Arc<Flow>, Error> {
        match self.flow_source {
            FlowSource::Estimated => self.flow.flow(clip, t, threads).map(Arc::new),
            FlowSource::Truth => true_flow(clip, t),
        }
    }

    /// The name of the method, for sentences.
    pub fn name(&self) -> &'static str {
        match self.flow_source {
            FlowSource::Estimated => self.flow.estimator().info().name,
            FlowSource::Truth => "The ground truth",
        }
    }

    /// Memory that the method takes.
    pub fn need(&self, clip: &Clip) -> Need {
        match self.flow_source {
            FlowSource::Estimated => self.flow.need(clip),
            FlowSource::Truth => Need::default(),
        }
    }
}

fn true_flow(clip: &Clip, t: usize) -> Result<Arc<Flow>, Error> {
    let known = clip.truth().map(|truth| truth.flow(t)).transpose()?.flatten();
    known.filter(|flow| flow.0.size() == clip.size()).ok_or_else(|| {
        Error::new(format!(
            "there is no true flow for frame {t}; load a .flo file (--truth), or set flow-source to estimated"
        ))
    })
}
