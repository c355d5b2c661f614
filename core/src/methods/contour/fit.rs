//! Contours that are fitted to edges as trackers of a region.

use std::sync::Arc;

use super::{Model, Point, Snake};
use crate::base::{Error, Observer};
use crate::data::{Clip, Frame, PackedMask};
use crate::geometry::Bounds;
use crate::methods::region::{Refusal, RegionModel, Settings, Similarity};
use crate::params::Params;
use crate::products::{MaskField, Product, ProductKind, Region, RegionField, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question};

/// A closed curve of points that is fitted to the edges of each frame, from where it was in the frame before.
pub trait Fit: Params + Default + Clone + Send + Sync + 'static {
    /// As [`RegionModel::INFO`].
    const INFO: Info;
    /// As [`RegionModel::QUESTIONS`].
    const QUESTIONS: &'static [Question];
    /// As [`RegionModel::CHARTS`].
    const CHARTS: &'static [Chart];
    /// As [`RegionModel::CONTRASTS`].
    const CONTRASTS: Option<&'static str> = None;
    /// As [`RegionModel::Event`].
    type Event: Clone + Send + Sync + 'static;

    /// Start, points and edges.
    fn snake(&self) -> &Snake;

    /// Fits the contour `before` to a frame, given the region of the frame before.
    fn fit(&self, at: (&Frame, Region), before: &Arc<[Point]>, observer: &mut impl Observer<Self::Event>) -> Model;

    /// As [`RegionModel::need`].
    fn need(&self, clip: &Clip) -> Need;

    /// As [`RegionModel::line`].
    fn line(&self, event: &Self::Event) -> Name;
}

impl<T: Fit> RegionModel for T {
    const INFO: Info = T::INFO;
    const QUESTIONS: &'static [Question] = T::QUESTIONS;
    const CHARTS: &'static [Chart] = T::CHARTS;
    const CONTRASTS: Option<&'static str> = T::CONTRASTS;
    const SIMILARITY: Similarity = Similarity {
        name: "mean edge strength",
        label: "Mean edge strength",
        symbol: "f",
        decimals: 3,
        shared_by: "a contour on edges of something else",
    };
    const PRODUCES: &'static [&'static ProductKind] = &[RegionField::KIND, MaskField::KIND];
    type Model = Model;
    type Event = T::Event;

    fn settings(&self) -> &Settings {
        &self.snake().placement.settings
    }

    fn placed(&self, picture: (usize, usize)) -> Result<Option<Bounds>, Error> {
        self.snake().placement.placed(picture)
    }

    fn refuse(&self, frame: &Frame, region: Region) -> Option<Refusal> {
        self.snake().refuse(frame, region)
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<T::Event>) -> (Model, f32) {
        let start = self.snake().placement.start(region).into();
        let model = self.fit((frame, region), &start, observer);
        let similarity = model.result.similarity;
        (model, similarity)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<T::Event>,
    ) -> RegionFrame {
        *model = self.fit((frame, region), &model.points, observer);
        model.result
    }

    fn fitted(&self, model: &Model) -> Option<RegionFrame> {
        Some(model.result)
    }

    fn mask(&self, model: &Model) -> Option<PackedMask> {
        Some(model.mask())
    }

    fn need(&self, clip: &Clip) -> Need {
        Fit::need(self, clip)
    }

    fn model_bytes(&self, model: &Model) -> usize {
        model.bytes()
    }

    fn line(&self, event: &T::Event) -> Name {
        Fit::line(self, event)
    }
}
