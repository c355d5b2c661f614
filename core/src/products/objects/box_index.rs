//! A spatial index of boxes: candidates for overlap without a test of every pair.
//!
//! Boxes are stored in grids of cells of their size, one grid for each power of two; a query visits the cells that it reaches in
//! each grid.

use std::collections::BTreeMap;

use crate::data::Detection;
use crate::geometry::Bounds;

/// The least and the largest corner of a box in px.
pub type Corners = [[f64; 2]; 2];

/// Returns the corners of a box.
pub fn corners(bounds: &Bounds) -> Corners {
    [bounds.min, bounds.max].map(|corner| corner.map(f64::from))
}

/// Boxes by position and size.
#[derive(Clone, Debug, Default)]
pub struct BoxIndex {
    grids: Vec<Cells>,
    /// Boxes with a corner that is not finite.
    unbounded: Vec<u32>,
    count: usize,
}

/// A grid of the boxes that are at most as large as a cell.
#[derive(Clone, Debug)]
struct Cells {
    side: f64,
    /// Row and column of the cell of the least corner, and the index of the box, sorted.
    boxes: Vec<([i64; 2], u32)>,
}

/// The rounding tolerance of corners, as a share of their size.
const ROUNDING: f64 = 1e-9;

/// The smallest and the largest side of a cell, as powers of two.
const SMALLEST: i32 = -10;
const LARGEST: i32 = 200;

impl BoxIndex {
    /// Indexes boxes.
    pub fn new(boxes: impl IntoIterator<Item = Corners>) -> Self {
        let (mut near, mut by_size) = (Self::default(), BTreeMap::<i32, Vec<_>>::new());
        for (index, [min, max]) in boxes.into_iter().enumerate() {
            near.count += 1;
            if !is_finite([min, max]) {
                near.unbounded.push(index as u32);
                continue;
            }
            let longest = (max[0] - min[0]).max(max[1] - min[1]);
            let power = (longest.log2().ceil() as i32).clamp(SMALLEST, LARGEST);
            let side = f64::from(power).exp2();
            by_size.entry(power).or_default().push(([cell(min[1], side), cell(min[0], side)], index as u32));
        }
        near.grids.extend(by_size.into_iter().map(|(power, mut boxes)| {
            boxes.sort_unstable();
            Cells { side: f64::from(power).exp2(), boxes }
        }));
        near
    }

    /// Replaces `found` with the values of `of` for all boxes that touch a box, in ascending order. `of` is called for some boxes
    /// nearby too.
    pub fn touching(&self, [min, max]: Corners, found: &mut Vec<(usize, f64)>, of: impl Fn(usize) -> Option<f64>) {
        found.clear();
        let mut ask = |index: u32| found.extend(of(index as usize).map(|overlap| (index as usize, overlap)));
        if !is_finite([min, max]) {
            return (0..self.count as u32).for_each(ask);
        }
        self.unbounded.iter().for_each(|index| ask(*index));
        self.grids.iter().for_each(|grid| grid.visit([min, max], &mut ask));
        // The boxes of a cell are sorted already, which this sort exploits.
        found.sort_by_key(|(index, _)| *index);
    }
}

impl Cells {
    /// Visits the boxes in the cells that a box reaches. The least corner of a touching box lies at most one cell before it, plus
    /// the rounding tolerance.
    fn visit(&self, [min, max]: Corners, ask: &mut impl FnMut(u32)) {
        let reach = self.side * (1.0 + ROUNDING);
        let span = |i: usize| [cell(min[i] - reach - ROUNDING * min[i].abs(), self.side), cell(max[i], self.side)];
        let ([left, right], [top, bottom]) = (span(0), span(1));
        // Going row by row would take longer than visiting all boxes.
        if bottom.saturating_sub(top) as u64 > self.boxes.len() as u64 {
            return self.boxes.iter().for_each(|(_, index)| ask(*index));
        }
        let mut boxes = &self.boxes[..];
        for row in top..=bottom {
            boxes = &boxes[boxes.partition_point(|(cell, _)| *cell < [row, left])..];
            boxes.iter().take_while(|(cell, _)| *cell <= [row, right]).for_each(|(_, index)| ask(*index));
        }
    }
}

/// Truncates `found` to the `most` detections nearest to `at`; of equal distances, the first. Returns whether there were more.
pub fn nearest(found: &mut Vec<(usize, f64)>, at: [f64; 2], (all, most): (&[Detection], usize)) -> bool {
    if found.len() <= most {
        return false;
    }
    let far = |index: usize| {
        let [x, y] = all[index].center.map(f64::from);
        (x - at[0]).powi(2) + (y - at[1]).powi(2)
    };
    found.select_nth_unstable_by(most, |(a, _), (b, _)| far(*a).total_cmp(&far(*b)).then(a.cmp(b)));
    found.truncate(most);
    found.sort_unstable_by_key(|(index, _)| *index);
    true
}

fn is_finite(corners: Corners) -> bool {
    corners.iter().flatten().all(|c| c.is_finite())
}

/// Returns the cell of a coordinate; the cast saturates at the last one.
fn cell(c: f64, side: f64) -> i64 {
    (c / side).floor() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes of many sizes all over the place, some of them without any, some unbounded.
    fn boxes(count: u64) -> Vec<Bounds> {
        let chance = |i: u64, k: u64| {
            let mixed = ((i * 0x9E37_79B9) ^ (k * 0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D);
            (mixed >> 40) as f32 / (1u32 << 24) as f32
        };
        let of = |i: u64| {
            let scale = [0.01, 1.0, 30.0, 200.0][(chance(i, 4) * 4.0) as usize];
            let center = [900.0 * chance(i, 0) - 200.0, 700.0 * chance(i, 1) - 300.0];
            let bounds = Bounds::around(center, [scale * chance(i, 2), scale * chance(i, 3)]);
            match i % 50 {
                7 => Bounds { min: [f32::NAN, 0.0], max: [5.0, 5.0] },
                13 => Bounds { min: [0.0, 0.0], max: [f32::INFINITY, 5.0] },
                23 => Bounds { min: bounds.max, max: bounds.min },
                31 => Bounds { min: [-1e30; 2], max: [1e30; 2] },
                43 => Bounds::around(center, [1e9, 2e9]),
                _ => bounds,
            }
        };
        (0..count).map(of).collect()
    }

    #[test]
    fn no_box_that_has_something_in_common_is_left_out() {
        let (all, asked) = (boxes(400), boxes(530));
        let near = BoxIndex::new(all.iter().map(corners));
        let (mut found, mut compared, mut shared) = (Vec::new(), 0, 0);
        for one in &asked[130..] {
            let overlap = |index: usize| f64::from(one.iou(&all[index]));
            near.touching(corners(one), &mut found, |index| Some(overlap(index)));
            compared += found.len();
            assert!(found.windows(2).all(|pair| pair[0].0 < pair[1].0), "ascending, each once");
            found.retain(|(_, overlap)| *overlap > 0.0);
            shared += found.len();
            let all: Vec<_> = (0..400).map(|index| (index, overlap(index))).filter(|(_, o)| *o > 0.0).collect();
            assert_eq!(found, all, "{one:?}");
        }
        assert!(shared > 4000 && compared < 400 * 400 / 2, "{shared} of {compared}");
    }

    #[test]
    fn the_nearest_are_left_in_their_order() {
        let at = |x: f32| Detection {
            bounds: Bounds::around([x, 0.0], [1.0; 2]),
            center: [x, 0.0],
            score: 1.0,
            blob: None,
            deviation_px: None,
        };
        let all: Vec<Detection> = [5.0, -1.0, 9.0, 1.0, 0.5, -5.0].map(at).to_vec();
        let mut found: Vec<_> = (0..6).map(|index| (index, index as f64)).collect();
        assert!(nearest(&mut found, [0.0; 2], (&all, 4)));
        assert_eq!(found, [(0, 0.0), (1, 1.0), (3, 3.0), (4, 4.0)]);
        assert!(!nearest(&mut found, [0.0; 2], (&all, 4)));
    }

    #[test]
    fn boxes_that_touch_are_found_at_every_size() {
        for power in -12..60 {
            let side = f64::from(power).exp2();
            let near = BoxIndex::new([[[0.0; 2], [side; 2]], [[3.0 * side, 0.0], [4.0 * side, side]]]);
            let mut found = Vec::new();
            near.touching([[side, side], [1.5 * side, 1.5 * side]], &mut found, |_| Some(0.0));
            assert!(found.contains(&(0, 0.0)), "{side}");
        }
        let mut found = vec![(1, 2.0)];
        BoxIndex::default().touching([[0.0; 2], [9.0; 2]], &mut found, |_| Some(0.0));
        assert!(found.is_empty());
    }
}
