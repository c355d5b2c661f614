//! The choice of a template, and the peaks of a score.

use std::ops::Range;

use super::{LEAST_PX, MOST_PX, Template, TemplateMatching};
use crate::base::{Error, LANES, wide::wide};
use crate::geometry::{Bounds, Gray, Grid};

/// A peak this close to the best one is part of it, in px.
const APART_PX: usize = 2;
/// Distances between blocks that compete for the template, as a part of their side.
const STEPS: usize = 4;

impl TemplateMatching {
    /// Returns the template of the first frame.
    ///
    /// # Errors
    /// If it is not inside the picture, or too small or large.
    pub(super) fn choose(&self, luma: &Gray, frame: usize) -> Result<Template, Error> {
        match self.template {
            Some(zone) => placed(luma, frame, zone),
            None => self.textured(luma, frame),
        }
    }

    /// The block near the middle with the largest λ₂, the smaller eigenvalue of its structure tensor.
    fn textured(&self, luma: &Gray, frame: usize) -> Result<Template, Error> {
        let (width, height) = luma.size();
        let side = self.size.min(width / 2).min(height / 2);
        if side < LEAST_PX {
            return Err(Error::new(format!(
                "the picture of {width}×{height} px is too small for template matching: the template of {LEAST_PX} px a side \
                 is at most half as wide and high; open a larger one"
            )));
        }
        let step = (side / STEPS).max(1);
        // Blocks with their middles in the middle half of the picture.
        let along = |extent: usize| {
            let first = (extent / 4).saturating_sub(side / 2);
            (first..=(extent - extent / 4 - side / 2).min(extent - side).max(first)).step_by(step)
        };
        let off_middle = |x: usize, y: usize| (2 * x + side).abs_diff(width) + (2 * y + side).abs_diff(height);
        let all = along(height).flat_map(|y| {
            let columns = Columns::of(luma, y..y + side);
            along(width).map(move |x| ((x, y), columns.smaller_eigenvalue(x, side)))
        });
        let best = all.max_by(|((x, y), a), ((u, v), b)| {
            a.total_cmp(b).then_with(|| off_middle(*u, *v).cmp(&off_middle(*x, *y)))
        });
        let ((x, y), eigenvalue) = best.unwrap_or_default();
        let template = Template::cut(luma, frame, [x as i32, y as i32], (side, side));
        Ok(Template { eigenvalue: Some(eigenvalue as f32), ..template })
    }
}

/// A template that was placed on the picture: the pixels with their centres in the zone, as far as they lie inside.
fn placed(luma: &Gray, frame: usize, zone: Bounds) -> Result<Template, Error> {
    let extent = [luma.width(), luma.height()];
    let low = [0, 1].map(|i| zone.min[i].ceil().max(0.0) as usize);
    let high = [0, 1].map(|i| (zone.max[i].ceil().max(0.0) as usize).min(extent[i]));
    let size = [0, 1].map(|i| high[i].saturating_sub(low[i]));
    if size.iter().any(|side| !(LEAST_PX..=MOST_PX).contains(side)) {
        return Err(Error::new(format!(
            "the template has {}×{} px inside the picture of {}×{} px, and needs {LEAST_PX} to {MOST_PX} px a side; place it \
             anew, or set template to none",
            size[0], size[1], extent[0], extent[1]
        )));
    }
    Ok(Template::cut(luma, frame, low.map(|c| c as i32), (size[0], size[1])))
}

/// The sums of the structure tensor down the columns of a band of rows, shared by the blocks beside each other: of I_x², I_x I_y and I_y², of
/// differences over two pixels. At most [`MOST_PX`] rows fit into 32 bits.
struct Columns([Vec<i32>; 3]);

impl Columns {
    fn of(luma: &Gray, rows: Range<usize>) -> Self {
        let (width, height) = luma.size();
        let mut sums = [(); 3].map(|()| vec![0; width]);
        for y in rows {
            add_products([y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| luma.row(y)), &mut sums);
        }
        Self(sums)
    }

    /// The smaller eigenvalue of the structure tensor of a square block from column `x` on, in (gray levels per px)².
    fn smaller_eigenvalue(&self, x: usize, side: usize) -> f64 {
        let sum = |column: &Vec<i32>| column[x..x + side].iter().map(|sum| i64::from(*sum)).sum::<i64>();
        // Central differences are half as large.
        let [xx, xy, yy] = self.0.each_ref().map(|column| sum(column) as f64 / (4 * side * side) as f64);
        let root = ((xx - yy) * (xx - yy) + 4.0 * xy * xy).sqrt();
        ((xx + yy - root) / 2.0).max(0.0)
    }
}

wide! {
    /// Adds the products of the differences of a row, with those above and below it.
    fn add_products(rows: [&[u8]; 3], sums: &mut [Vec<i32>; 3]) = add_products_of
}

#[inline(always)]
fn add_products_of([above, row, below]: [&[u8]; 3], [xx, xy, yy]: &mut [Vec<i32>; 3]) {
    let mut add = |x: usize, [left, right, up, down]: [u8; 4]| {
        let [dx, dy] = [i32::from(right) - i32::from(left), i32::from(down) - i32::from(up)];
        (xx[x], xy[x], yy[x]) = (xx[x] + dx * dx, xy[x] + dx * dy, yy[x] + dy * dy);
    };
    let last = row.len() - 1;
    add(0, [row[0], row[last.min(1)], above[0], below[0]]);
    if last > 0 {
        add(last, [row[last - 1], row[last], above[last], below[last]]);
    }
    // Slices of equal length need no bounds checks.
    let inner = 1..last.max(1);
    let (left, right) = (&row[..inner.len()], &row[row.len() - inner.len()..]);
    let [up, down] = [above, below].map(|row| &row[inner.clone()]);
    let [xx, xy, yy] = [xx, xy, yy].map(|sums| &mut sums[inner.clone()]);
    for i in 0..inner.len() {
        let [dx, dy] = [i32::from(right[i]) - i32::from(left[i]), i32::from(down[i]) - i32::from(up[i])];
        xx[i] += dx * dx;
        xy[i] += dx * dy;
        yy[i] += dy * dy;
    }
}

/// The sub-pixel part of a minimum, by parabolas along x and y through the costs of its neighbours.
pub(super) fn subpixel(costs: &Grid<f64>, (x, y): (usize, usize)) -> ([f32; 2], [Option<[f64; 3]>; 2]) {
    let along_x = || Some([*costs.get(x.checked_sub(1)?, y)?, costs[(x, y)], *costs.get(x + 1, y)?]);
    let along_y = || Some([*costs.get(x, y.checked_sub(1)?)?, costs[(x, y)], *costs.get(x, y + 1)?]);
    let around = [along_x(), along_y()];
    let vertex = |of: Option<[f64; 3]>| {
        let [before, at, after] = of?;
        let curvature = before - 2.0 * at + after;
        (curvature > 0.0).then(|| ((before - after) / (2.0 * curvature)).clamp(-0.5, 0.5) as f32)
    };
    (around.map(|of| vertex(of).unwrap_or(0.0)), around)
}

/// The second-best peak: the lowest local minimum that is not a neighbour of the best place.
pub(super) fn second(costs: &Grid<f64>, best: (usize, usize)) -> Option<(usize, usize)> {
    let is_apart = |(x, y): (usize, usize)| x.abs_diff(best.0).max(y.abs_diff(best.1)) >= APART_PX;
    let (mut second, mut least): (Option<(usize, usize)>, f64) = (None, f64::INFINITY);
    for y in 0..costs.height() {
        not_above(costs.row(y), least, |x| {
            let place = (x, y);
            let is_lower = second.is_none() || costs[place] < least;
            if is_lower && is_apart(place) && is_minimum(costs, place) {
                (second, least) = (Some(place), costs[place]);
            }
            least
        });
    }
    second
}

/// Calls `see` with the columns of a row, from left to right, that have a cost of at most `least`, which is what `see` returned
/// last. It excludes nearly all columns, several at once.
pub(super) fn not_above(costs: &[f64], mut least: f64, mut see: impl FnMut(usize) -> f64) {
    let (groups, rest) = costs.as_chunks::<LANES>();
    let mut look = |first: usize, costs: &[f64], least: &mut f64| {
        for (x, cost) in (first..).zip(costs) {
            if *cost <= *least {
                *least = see(x);
            }
        }
    };
    for (i, group) in groups.iter().enumerate() {
        // Whole groups, which the compiler vectorises.
        if group.iter().fold(false, |any, cost| any | (*cost <= least)) {
            look(i * LANES, group, &mut least);
        }
    }
    look(groups.len() * LANES, rest, &mut least);
}

/// Whether no neighbour of a place has a lower cost.
fn is_minimum(costs: &Grid<f64>, (x, y): (usize, usize)) -> bool {
    let columns = x.saturating_sub(1)..=(x + 1).min(costs.width() - 1);
    let rows = y.saturating_sub(1)..=(y + 1).min(costs.height() - 1);
    rows.into_iter().all(|v| columns.clone().all(|u| costs[(u, v)] >= costs[(x, y)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Border;

    #[test]
    fn columns_give_the_eigenvalue_of_a_block() {
        let luma = Grid::from_fn(23, 17, |x, y| ((x * x * 3 + y * 37 + x * y * 5) % 251) as u8);
        let at = |x: usize, y: usize, [u, v]: [isize; 2]| {
            f64::from(luma.at(x as isize + u, y as isize + v, Border::Replicate)) / 2.0
        };
        for (x, y, side) in [(0, 0, 5), (4, 3, 8), (15, 9, 8), (22, 16, 1)] {
            let (mut trace, mut sums) = (0.0, [0.0; 3]);
            for (i, j) in (y..y + side).flat_map(|j| (x..x + side).map(move |i| (i, j))) {
                let [dx, dy] = [[1, 0], [0, 1]].map(|to| at(i, j, to) - at(i, j, to.map(|c: isize| -c)));
                sums = [sums[0] + dx * dx, sums[1] + dx * dy, sums[2] + dy * dy];
                trace += dx * dx + dy * dy;
            }
            let determinant = sums[0] * sums[2] - sums[1] * sums[1];
            let plain = (trace - (trace * trace - 4.0 * determinant).max(0.0).sqrt()) / 2.0 / (side * side) as f64;
            let found = Columns::of(&luma, y..y + side).smaller_eigenvalue(x, side);
            assert!((found - plain).abs() < 1e-6 * trace.max(1.0), "{found} at ({x}, {y}), plainly {plain}");
        }
    }

    #[test]
    fn a_parabola_has_its_vertex_between_pixels() {
        let costs = Grid::from_fn(9, 8, |x, y| (x as f64 - 4.25).powi(2) + 2.0 * (y as f64 - 2.6).powi(2));
        let ([u, v], around) = subpixel(&costs, (4, 3));
        assert!((u - 0.25).abs() < 1e-6 && (v + 0.4).abs() < 1e-6 && around.iter().all(Option::is_some));
        assert_eq!(subpixel(&costs, (0, 0)), ([0.0; 2], [None; 2]), "no neighbours on both sides");
    }

    #[test]
    fn the_second_peak_is_no_slope_of_the_best() {
        let well = |x: usize, y: usize, at: [f64; 2]| (x as f64 - at[0]).hypot(y as f64 - at[1]);
        let costs = Grid::from_fn(20, 15, |x, y| well(x, y, [4.0, 5.0]).min(2.0 + well(x, y, [15.0, 9.0])));
        assert_eq!(second(&costs, (4, 5)), Some((15, 9)));
        let single = Grid::from_fn(20, 15, |x, y| well(x, y, [4.0, 5.0]));
        assert_eq!(second(&single, (4, 5)), None);
    }
}
