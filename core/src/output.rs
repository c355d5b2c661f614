//! What an estimator amounts to, whatever its kind.

use std::sync::Arc;

use crate::{Border, Flow, Gray, Grid, Interpolation, ObjectField};

/// The result of a run, or of the part of it that was done.
#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// One displacement per block.
    Blocks(BlockField),
    /// One displacement per pixel.
    Dense(DenseField),
    /// Features, with displacements where they were tracked.
    Points(PointField),
    /// Features that were tracked from frame to frame.
    Tracks(TrackField),
    /// What does not belong to the background, and the objects that it is made of.
    Objects(ObjectField),
}

impl Output {
    /// The displacement of every pixel of the picture, of the last pair where there are several; unknown wherever nothing is
    /// said of one.
    pub fn flow(&self) -> Flow {
        match self {
            Output::Blocks(field) => field.flow(),
            Output::Dense(field) => field.flow.clone(),
            Output::Points(field) => field.flow(),
            Output::Tracks(field) => field.frames().last().map_or_else(|| field.at(0), |t| field.at(t)).flow(),
            Output::Objects(field) => Flow(Grid::new(field.picture.0, field.picture.1, Flow::UNKNOWN)),
        }
    }

    /// The motion-compensated prediction of frame t from `next`, frame t + 1; `None` where only single points are known to
    /// move.
    pub fn prediction(&self, next: &Gray) -> Option<Gray> {
        match self {
            Output::Blocks(field) => Some(predict(&field.flow(), next, (field.border, field.filter))),
            Output::Dense(field) => Some(predict(&field.flow, next, (Border::Replicate, Interpolation::Bilinear))),
            Output::Points(_) | Output::Tracks(_) | Output::Objects(_) => None,
        }
    }

    /// The displacements of the blocks, if it has any.
    pub fn blocks(&self) -> Option<&BlockField> {
        match self {
            Output::Blocks(field) => Some(field),
            _ => None,
        }
    }

    /// The features, if it has any.
    pub fn points(&self) -> Option<&PointField> {
        match self {
            Output::Points(field) => Some(field),
            _ => None,
        }
    }

    /// The tracks, if it has any.
    pub fn tracks(&self) -> Option<&TrackField> {
        match self {
            Output::Tracks(field) => Some(field),
            _ => None,
        }
    }

    /// The objects, if it is about such.
    pub fn objects(&self) -> Option<&ObjectField> {
        match self {
            Output::Objects(field) => Some(field),
            _ => None,
        }
    }
}

/// Where the blocks of a picture lie: `size` px a side, one every `step` px, clipped at the right and bottom edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockGrid {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// Side of a block in px.
    pub size: usize,
    /// From one block to the next, in px.
    pub step: usize,
}

/// A block of whole pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Left column.
    pub x: usize,
    /// Top row.
    pub y: usize,
    /// Width in px: less than the block size at the right edge.
    pub width: usize,
    /// Height in px: less than the block size at the bottom edge.
    pub height: usize,
}

impl Block {
    /// The centre in image pixels.
    pub fn center(&self) -> [f32; 2] {
        [self.x as f32 + (self.width as f32 - 1.0) / 2.0, self.y as f32 + (self.height as f32 - 1.0) / 2.0]
    }
}

impl BlockGrid {
    /// Columns and rows of blocks: as few as cover the picture.
    pub fn counts(&self) -> (usize, usize) {
        let count = |extent: usize| {
            let covering = extent.saturating_sub(self.size).div_ceil(self.step) + 1;
            covering.min(extent.div_ceil(self.step))
        };
        (count(self.picture.0), count(self.picture.1))
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        let (columns, rows) = self.counts();
        columns * rows
    }

    /// Whether there is no block at all; there always is one.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Block `index`, counted along the rows.
    pub fn block(&self, index: usize) -> Block {
        let columns = self.counts().0;
        let (x, y) = (index % columns * self.step, index / columns * self.step);
        let clip = |start: usize, extent: usize| self.size.min(extent.saturating_sub(start));
        Block { x, y, width: clip(x, self.picture.0), height: clip(y, self.picture.1) }
    }

    /// The column and row of the block whose centre is nearest to pixel `(x, y)`; one cut by the edge counts as whole.
    pub fn nearest(&self, x: usize, y: usize) -> (usize, usize) {
        let (columns, rows) = self.counts();
        let nearest = |p: usize, count: usize| {
            // Round half up of (p − (size − 1)/2) / step, in whole numbers.
            let twice = 2 * p as isize - (self.size as isize - 1) + self.step as isize;
            (twice.max(0) as usize / (2 * self.step)).min(count - 1)
        };
        (nearest(x, columns), nearest(y, rows))
    }
}

/// One displacement per block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockField {
    /// Where the blocks lie.
    pub blocks: BlockGrid,
    /// Displacement `[u, v]` in px/frame and its cost, by block index; `None` where not yet searched.
    pub vectors: Vec<Option<BlockVector>>,
    /// What the cost is called.
    pub cost: &'static str,
    /// How candidates outside the picture are read.
    pub border: Border,
    /// How gray values between pixels are interpolated.
    pub filter: Interpolation,
}

/// The displacement of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockVector {
    /// Displacement `[u, v]` in px/frame.
    pub displacement: [f32; 2],
    /// Its cost.
    pub cost: f64,
    /// How many candidates were tested for it.
    pub candidates: u32,
}

impl BlockField {
    /// Candidates that were tested in all.
    pub fn candidates(&self) -> u64 {
        self.vectors.iter().flatten().map(|vector| u64::from(vector.candidates)).sum()
    }

    /// Every pixel moves as the block whose centre is nearest; a block cut by the edge counts as whole.
    pub fn flow(&self) -> Flow {
        let columns = self.blocks.counts().0;
        let (width, height) = self.blocks.picture;
        let columns_of: Vec<_> = (0..width).map(|x| self.blocks.nearest(x, 0).0).collect();
        let rows_of: Vec<_> = (0..height).map(|y| self.blocks.nearest(0, y).1).collect();
        Flow(Grid::from_fn(width, height, |x, y| {
            self.vectors[rows_of[y] * columns + columns_of[x]].map_or(Flow::UNKNOWN, |v| v.displacement)
        }))
    }
}

/// One displacement per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseField {
    /// Displacements in px/frame; unknown where nothing could be said, or has not been yet.
    pub flow: Flow,
    /// How far each is to be trusted, larger is better, if the estimator tells.
    pub confidence: Option<Confidence>,
}

/// How far displacements are to be trusted.
#[derive(Clone, Debug, PartialEq)]
pub struct Confidence {
    /// What is measured, in lower case and without spaces, with its unit: a column of a table.
    pub name: &'static str,
    /// Its value at each pixel.
    pub values: Grid<f32>,
}

/// Features of a picture, the strongest first where they were ranked.
#[derive(Clone, Debug, PartialEq)]
pub struct PointField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The features.
    pub points: Vec<Feature>,
    /// What each was chosen by, as far as it is a corner that this run has found; else empty.
    pub responses: Vec<f32>,
}

/// One feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Its place in frame t, in px.
    pub at: [f32; 2],
    /// Its displacement `[u, v]` in px/frame, if it was tracked.
    pub displacement: Option<[f32; 2]>,
    /// What became of it.
    pub status: Status,
    /// Mean absolute difference of its window in both frames, in gray levels, if that is known.
    pub residual: Option<f32>,
}

/// What became of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It was found, and nobody looked where it goes.
    Found,
    /// It was found again in frame t + 1.
    Tracked,
    /// Lost: it leaves the picture.
    Outside,
    /// Lost: its window has too little texture to tell two directions apart.
    Flat,
    /// Lost: what it led to looks too different.
    Unlike,
    /// Lost: tracked back, it does not come to where it was.
    Astray,
    /// Lost: it no longer looks as it did where it was first seen.
    Changed,
}

impl Status {
    /// Kebab-case name, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Status::Found => "found",
            Status::Tracked => "tracked",
            Status::Outside => "lost-outside",
            Status::Flat => "lost-flat",
            Status::Unlike => "lost-unlike",
            Status::Astray => "lost-astray",
            Status::Changed => "lost-changed",
        }
    }
}

impl PointField {
    /// The displacements of the features at the pixels nearest to them; unknown everywhere else.
    pub fn flow(&self) -> Flow {
        let mut flow = Grid::new(self.picture.0, self.picture.1, Flow::UNKNOWN);
        for Feature { at: [x, y], displacement, .. } in &self.points {
            let place = (x.round() as usize, y.round() as usize);
            if let Some(displacement) = displacement.filter(|_| flow.get(place.0, place.1).is_some()) {
                flow[place] = displacement;
            }
        }
        Flow(flow)
    }

    /// How many features have a status for which `is` holds.
    pub fn count(&self, is: impl Fn(Status) -> bool) -> usize {
        self.points.iter().filter(|point| is(point.status)).count()
    }
}

/// Features that were tracked from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// The frame that the last one was tracked to.
    pub last: usize,
    /// The tracks in the order in which they began.
    pub tracks: Vec<Arc<Track>>,
}

/// One feature in all frames in which it was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// The frame in which it begins.
    pub first: usize,
    /// What became of it in that frame and those that follow: tracked in all but the last, where it is lost or where the run
    /// ends.
    pub points: Vec<Feature>,
}

impl Track {
    /// The feature in frame `t`, if it was seen there.
    pub fn at(&self, t: usize) -> Option<&Feature> {
        self.points.get(t.checked_sub(self.first)?)
    }

    /// Whether it was not lost.
    pub fn is_alive(&self) -> bool {
        self.points.last().is_some_and(|point| point.status == Status::Found)
    }

    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.points[..])
    }
}

impl TrackField {
    /// The frames that features were tracked from.
    pub fn frames(&self) -> std::ops::Range<usize> {
        self.first..self.last
    }

    /// The features in frame `t`.
    pub fn at(&self, t: usize) -> PointField {
        let points = self.tracks.iter().filter_map(|track| track.at(t).copied()).collect();
        PointField { picture: self.picture, points, responses: Vec::new() }
    }
}

/// The motion-compensated prediction of frame t: each pixel is fetched from where it goes in `next`.
///
/// Whole displacements are copied exactly, fractional ones interpolated; a pixel of unknown motion stays where it is.
pub fn predict(flow: &Flow, next: &Gray, (border, filter): (Border, Interpolation)) -> Gray {
    Grid::from_fn(flow.0.width(), flow.0.height(), |x, y| {
        let [u, v] = flow.at(x, y).unwrap_or([0.0; 2]);
        if u.fract() == 0.0 && v.fract() == 0.0 {
            next.at(x as isize + u as isize, y as isize + v as isize, border)
        } else {
            filter.sample(next, [x as f32 + u, y as f32 + v], border)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_the_picture_and_no_more() {
        for (extent, size, step) in [(32, 16, 16), (33, 16, 16), (5, 16, 16), (40, 8, 3), (50, 4, 20)] {
            let grid = BlockGrid { picture: (extent, extent), size, step };
            let last = grid.block(grid.len() - 1);
            assert_eq!(last.x + last.width, extent.min(last.x + size));
            assert!(last.width > 0 && (last.x + last.width == extent || step > size));
            let before = grid.block(grid.len().saturating_sub(2));
            assert!(grid.len() == 1 || before.x + size < extent, "the block before already reached the edge");
        }
    }

    #[test]
    fn only_tracked_features_are_known_to_move() {
        let feature = |at, displacement, status| Feature { at, displacement, status, residual: None };
        let points = vec![
            feature([1.0, 2.0], Some([0.5, -0.25]), Status::Tracked),
            feature([3.0, 0.0], None, Status::Flat),
            feature([9.0, 9.0], Some([1.0, 1.0]), Status::Tracked),
        ];
        let output = Output::Points(PointField { picture: (4, 3), points, responses: Vec::new() });
        let flow = output.flow();
        assert_eq!(flow.at(1, 2), Some([0.5, -0.25]));
        assert_eq!(flow.0.cells().iter().filter(|uv| uv[0].is_finite()).count(), 1);
        assert_eq!((output.prediction(&Grid::new(4, 3, 9)), output.blocks()), (None, None));
        assert_eq!(output.points().map(|field| field.count(|status| status == Status::Tracked)), Some(2));
    }

    #[test]
    fn every_pixel_belongs_to_the_nearest_centre() {
        for (size, step) in [(16, 16), (8, 3), (5, 5), (4, 9)] {
            let grid = BlockGrid { picture: (61, 47), size, step };
            let (columns, rows) = grid.counts();
            let center = |i: usize| (i * step) as f64 + (size as f64 - 1.0) / 2.0;
            for x in 0..61 {
                let (column, _) = grid.nearest(x, 0);
                let best = (0..columns).map(|i| (x as f64 - center(i)).abs()).fold(f64::MAX, f64::min);
                assert_eq!((x as f64 - center(column)).abs(), best);
            }
            assert!(grid.nearest(60, 46).1 < rows);
        }
    }
}
