//! Ground truth: the exact flow of every pixel, occlusions, and objects.

use std::sync::Arc;

use super::difficulty::Difficulty;
use super::recent::Recent;
use super::stage::Stage;
use crate::base::Error;
use crate::data::{Disparity, Flow, ObjectBox, PixelClass, Pose, TrueMask, Truth, Viewpoint};
use crate::geometry::Grid;

/// The truth of a synthetic clip, computed from the same layers and motions as its pixels.
pub struct ExactTruth {
    stage: Arc<Stage>,
    difficulty: Difficulty,
    kept: Recent<Pair>,
    masks: Recent<TrueMask>,
    labels: Recent<Grid<u32>>,
    views: Recent<Views>,
    next: Recent<Disparity>,
    boxes: Recent<Vec<ObjectBox>>,
}

/// Frames of which the boxes are kept: scores compare those of all frames so far.
const BOXES_KEPT: usize = 256;

/// Flow and occlusion from one frame to the next; they are found together.
struct Pair {
    flow: Arc<Flow>,
    hidden: Arc<Grid<bool>>,
}

/// Disparity and half-occlusion of a frame; they are found together.
struct Views {
    disparity: Arc<Disparity>,
    hidden: Arc<Grid<bool>>,
}

impl ExactTruth {
    /// The truth of what `stage` shows.
    pub fn new(stage: Arc<Stage>, difficulty: Difficulty) -> Self {
        Self {
            stage,
            difficulty,
            kept: Recent::new(4),
            masks: Recent::new(4),
            labels: Recent::new(4),
            views: Recent::new(4),
            next: Recent::new(4),
            boxes: Recent::new(BOXES_KEPT),
        }
    }

    /// Frames `t` and `t + 1`, if there are both.
    fn pair(&self, t: usize) -> Option<Arc<Pair>> {
        (t < self.difficulty.frames - 1).then(|| self.kept.get(t, || self.follow(t)))
    }

    fn follow(&self, t: usize) -> Pair {
        let (width, height) = (self.difficulty.width, self.difficulty.height);
        let (now, next) = (self.stage.at(t as f64), self.stage.at(t as f64 + 1.0));
        let mut hidden = Grid::new(width, height, false);
        let flow = Grid::from_fn(width, height, |x, y| {
            let p = [x as f64, y as f64];
            let Some((to, is_hidden)) = now.foremost(p).and_then(|surface| now.follow(surface, p, &next)) else {
                return Flow::UNKNOWN;
            };
            hidden[(x, y)] = is_hidden;
            [(to[0] - p[0]) as f32, (to[1] - p[1]) as f32]
        });
        Pair { flow: Arc::new(Flow(flow)), hidden: Arc::new(hidden) }
    }

    /// Both views of frame `t`, if there are two.
    fn views(&self, t: usize) -> Option<Arc<Views>> {
        let is_known = t < self.difficulty.frames && self.stage.is_stereo();
        is_known.then(|| self.views.get(t, || self.relate(t)))
    }

    fn relate(&self, t: usize) -> Views {
        let (width, height) = (self.difficulty.width, self.difficulty.height);
        let [left, right] =
            [Viewpoint::Left, Viewpoint::Right].map(|viewpoint| self.stage.seen_from(viewpoint, t as f64));
        let mut hidden = Grid::new(width, height, true);
        let disparity = Grid::from_fn(width, height, |x, y| {
            let p = [x as f64, y as f64];
            let Some((to, is_hidden)) = left.foremost(p).and_then(|surface| left.follow(surface, p, &right)) else {
                return Disparity::UNKNOWN;
            };
            hidden[(x, y)] = is_hidden;
            (p[0] - to[0]) as f32
        });
        Views { disparity: Arc::new(Disparity(disparity)), hidden: Arc::new(hidden) }
    }

    fn relate_next(&self, t: usize) -> Disparity {
        let now = self.stage.at(t as f64);
        let next = [Viewpoint::Left, Viewpoint::Right].map(|viewpoint| self.stage.seen_from(viewpoint, t as f64 + 1.0));
        Disparity(Grid::from_fn(self.difficulty.width, self.difficulty.height, |x, y| {
            let p = [x as f64, y as f64];
            let found = now.foremost(p).and_then(|surface| now.disparity_in(surface, p, &next));
            found.map_or(Disparity::UNKNOWN, |d| d as f32)
        }))
    }
}

impl Truth for ExactTruth {
    fn flow(&self, t: usize) -> Result<Option<Arc<Flow>>, Error> {
        Ok(self.pair(t).map(|pair| Arc::clone(&pair.flow)))
    }

    /// Pixels of frame `t` that are hidden in frame `t + 1`, or have left the picture.
    fn occlusion(&self, t: usize) -> Result<Option<Arc<Grid<bool>>>, Error> {
        Ok(self.pair(t).map(|pair| Arc::clone(&pair.hidden)))
    }

    /// The foremost layer at each pixel, counted from 1 at the front.
    fn segments(&self, t: usize) -> Result<Option<Arc<Grid<u32>>>, Error> {
        Ok((t < self.difficulty.frames).then(|| {
            self.labels.get(t, || {
                let now = self.stage.at(t as f64);
                let label = |x, y| now.foremost([x as f64, y as f64]).map_or(0, |layer| layer as u32 + 1);
                Grid::from_fn(self.difficulty.width, self.difficulty.height, label)
            })
        }))
    }

    /// The objects that are at least partly within the picture's borders, hidden or not, with their whole extent.
    /// Nothing if the scene has no objects.
    fn objects(&self, t: usize) -> Result<Option<Vec<ObjectBox>>, Error> {
        if t >= self.difficulty.frames || !self.stage.has_objects() {
            return Ok(None);
        }
        let boxed = |s: &super::layer::TrackPoint| {
            let [left, top, right, bottom] = s.bounds;
            ObjectBox {
                id: s.id,
                x: left as f32,
                y: top as f32,
                width: (right - left) as f32,
                height: (bottom - top) as f32,
                visibility: s.visible as f32,
            }
        };
        let all = || self.stage.at(t as f64).sightings().iter().map(boxed).collect();
        Ok(Some(self.boxes.get(t, all).to_vec()))
    }

    fn pose(&self, id: u32, t: usize) -> Result<Option<Pose>, Error> {
        Ok((t < self.difficulty.frames).then(|| self.stage.pose(id, t as f64)).flatten())
    }

    /// The visible pixels of the objects; nothing if the scene has no objects.
    fn foreground(&self, t: usize) -> Result<Option<Arc<TrueMask>>, Error> {
        let is_known = t < self.difficulty.frames && self.stage.has_objects();
        Ok(is_known.then(|| {
            self.masks.get(t, || {
                let now = self.stage.at(t as f64);
                let is_object = |x, y| now.foremost([x as f64, y as f64]).is_some_and(|layer| now.is_object(layer));
                let class = |x, y| if is_object(x, y) { PixelClass::Foreground } else { PixelClass::Background };
                TrueMask(Grid::from_fn(self.difficulty.width, self.difficulty.height, class))
            })
        }))
    }

    fn background(&self, t: usize) -> Result<Option<[[f64; 3]; 3]>, Error> {
        let is_known = t + 1 < self.difficulty.frames;
        let moved = || self.stage.at(t as f64).background(&self.stage.at(t as f64 + 1.0));
        Ok(is_known.then(moved).flatten().map(|map| {
            let [[a, b], [c, d]] = map.linear;
            let [u, v] = map.shift;
            [[a, b, u], [c, d, v], [0.0, 0.0, 1.0]]
        }))
    }

    fn disparity(&self, t: usize) -> Result<Option<Arc<Disparity>>, Error> {
        Ok(self.views(t).map(|views| Arc::clone(&views.disparity)))
    }

    fn next_disparity(&self, t: usize) -> Result<Option<Arc<Disparity>>, Error> {
        let is_known = t + 1 < self.difficulty.frames && self.stage.is_stereo();
        Ok(is_known.then(|| self.next.get(t, || self.relate_next(t))))
    }

    fn ego_motion(&self, t: usize) -> Result<Option<Pose>, Error> {
        Ok((t + 1 < self.difficulty.frames).then(|| self.stage.ego_motion(t as f64)).flatten())
    }

    fn half_occlusion(&self, t: usize) -> Result<Option<Arc<Grid<bool>>>, Error> {
        Ok(self.views(t).map(|views| Arc::clone(&views.hidden)))
    }

    fn kinds(&self) -> Vec<&'static str> {
        let mut kinds = vec!["flow", "occlusion", "segments"];
        if self.stage.has_objects() {
            kinds.extend(["objects", "foreground"]);
        }
        if self.stage.is_stereo() {
            kinds.push("disparity");
        }
        kinds
    }
}
