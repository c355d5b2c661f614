//! Block vectors: one motion vector per block.

use super::assessment::{fact, scores};
use super::{
    Assessment, Cell, Measure, Motion, Product, ProductKind, Reference, Table, Tested, flow_error, predict, prediction,
};
use crate::base::{Error, words::grouped};
use crate::data::{Flow, Interpolation};
use crate::geometry::{Border, Gray, Grid};

/// The block grid of a picture: blocks of `size` px a side every `step` px, clipped at the right and bottom edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockGrid {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// Side of a block in px.
    pub size: usize,
    /// Distance between neighbouring blocks in px.
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
    /// Columns and rows of blocks: the fewest that cover the picture.
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

    /// Whether there is no block; never true.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Block `index` in raster order.
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

    /// The index of the block whose centre is nearest to a point in px, if that lies in the picture.
    pub fn at(&self, [x, y]: [f32; 2]) -> Option<usize> {
        let (width, height) = self.picture;
        let inside = |c: f32, extent: usize| (c >= -0.5 && c < extent as f32 - 0.5).then(|| c.round() as usize);
        let (column, row) = self.nearest(inside(x, width)?, inside(y, height)?);
        Some(row * self.counts().0 + column)
    }
}

/// One motion vector per block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockField {
    /// The block grid.
    pub blocks: BlockGrid,
    /// Motion vectors by block index; `None` for blocks not yet searched.
    pub vectors: Vec<Option<BlockVector>>,
    /// Name of the cost.
    pub cost: &'static str,
    /// Extrapolation beyond the picture's border.
    pub border: Border,
    /// Interpolation of gray values at sub-pixel positions.
    pub filter: Interpolation,
}

/// The motion vector of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockVector {
    /// Displacement `[u, v]` in px/frame.
    pub displacement: [f32; 2],
    /// Its cost.
    pub cost: f64,
    /// Number of candidates tested for it.
    pub candidates: u32,
}

impl BlockField {
    /// Total number of candidates tested.
    pub fn candidates(&self) -> u64 {
        self.vectors.iter().flatten().map(|vector| u64::from(vector.candidates)).sum()
    }

    /// The dense flow: each pixel has the vector of the block with the nearest centre; a block clipped by the edge counts as
    /// whole.
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

const MEASURES: [Measure; 1] = [Measure::new("candidates", "Number of candidates tested, of all blocks.")];

impl Product for BlockField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "block-vectors",
        name: "Block vectors",
        summary: "One motion vector for each block of the picture.",
        motion: Motion::Blocks,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&MEASURES, &prediction::MEASURES, &flow_error::MEASURES],
    };

    /// Centre and size of each block, its motion vector, and the cost.
    fn table(&self) -> Option<Table> {
        let columns = ["x_px", "y_px", "width_px", "height_px", "u_px", "v_px", "cost"];
        let found = self.vectors.iter().enumerate().filter_map(|(i, vector)| Some((self.blocks.block(i), (*vector)?)));
        let rows = found.map(|(block, vector)| -> [Cell; 7] {
            let ([x, y], [u, v]) = (block.center(), vector.displacement);
            [x.into(), y.into(), block.width.into(), block.height.into(), u.into(), v.into(), vector.cost.into()]
        });
        Some(Table::new(columns, rows))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let candidates = self.candidates() as usize;
        let own = Assessment::default()
            .with(scores(&MEASURES, [candidates.into()]), vec![fact("Candidates", grouped(candidates))]);
        let flow = BlockField::flow(self);
        let picture =
            predict(&flow, reference.clip.pair_or_last(reference.frame)?[1].luma(), (self.border, self.filter));
        let vectors: Vec<_> = self.vectors.iter().flatten().map(|vector| vector.displacement).collect();
        let sent = prediction::assess(&picture, Some(&vectors), reference)?;
        Ok(own.and(sent).and(flow_error::of_field(&flow, reference)))
    }

    fn flow(&self) -> Option<Flow> {
        Some(BlockField::flow(self))
    }

    fn prediction(&self, next: &Gray) -> Option<Gray> {
        Some(predict(&BlockField::flow(self), next, (self.border, self.filter)))
    }

    fn tested(&self) -> Option<Vec<Option<Tested>>> {
        let tested = |vector: BlockVector| Tested { cost: vector.cost, candidates: vector.candidates };
        Some(self.vectors.iter().map(|vector| vector.map(tested)).collect())
    }

    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        Some(self.vectors.iter().map(|vector| vector.map(|vector| vector.displacement)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_units_and_no_words() {
        let blocks = BlockGrid { picture: (24, 20), size: 16, step: 16 };
        let vector = BlockVector { displacement: [3.0, -0.25], cost: 812.0, candidates: 9 };
        let field = BlockField {
            blocks,
            vectors: vec![Some(vector), None],
            cost: "SAD",
            border: Border::Replicate,
            filter: Interpolation::Bilinear,
        };
        let table = Product::table(&field).expect("a table");
        let rows: Vec<Vec<String>> = table.rows().map(|row| row.iter().map(Cell::to_string).collect()).collect();
        assert_eq!(table.columns(), ["x_px", "y_px", "width_px", "height_px", "u_px", "v_px", "cost"]);
        assert_eq!(rows, [["7.5", "7.5", "16", "16", "3", "-0.25", "812"]]);
    }

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
