//! Frames registered by a model in the coordinates of frame t.

use crate::data::{Frame, Interpolation};
use crate::geometry::{Border, Gray, Grid};
use crate::methods::geometric::fit::inverse;
use crate::products::model::{Matrix3, mapped};

/// A mosaic is at most this many times as wide and high as a frame.
const MOST: f64 = 3.0;

/// Both frames in the coordinates of frame t: frame t + 1 where only that is known, their mean where both are.
pub fn mosaic([current, next]: [&Gray; 2], matrix: &Matrix3) -> Frame {
    let (width, height) = current.size();
    let [left, top, right, bottom] = bounds((width, height), matrix);
    let size = ((right - left) as usize + 1, (bottom - top) as usize + 1);
    Frame::gray(Grid::from_fn(size.0, size.1, |i, j| {
        let at = [i as f64 + left, j as f64 + top];
        let is_inside = |[x, y]: [f64; 2]| x >= 0.0 && y >= 0.0 && x <= (width - 1) as f64 && y <= (height - 1) as f64;
        let own = is_inside(at).then(|| f32::from(current[(at[0] as usize, at[1] as usize)]));
        let other = mapped(matrix, at)
            .filter(|to| is_inside(*to))
            .map(|[x, y]| f32::from(Interpolation::Bilinear.sample(next, [x as f32, y as f32], Border::Replicate)));
        match (own, other) {
            (Some(a), Some(b)) => ((a + b) / 2.0).round() as u8,
            (Some(value), None) | (None, Some(value)) => value.round() as u8,
            (None, None) => 0,
        }
    }))
}

/// The corners of frames t and t + 1 on the mosaic.
pub fn outlines(size: (usize, usize), matrix: &Matrix3) -> Vec<Vec<[f64; 2]>> {
    let [left, top, ..] = bounds(size, matrix);
    let [right, bottom] = [(size.0 - 1) as f64, (size.1 - 1) as f64];
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let on_mosaic = |map: &dyn Fn([f64; 2]) -> Option<[f64; 2]>| -> Option<Vec<[f64; 2]>> {
        corners.iter().map(|at| map(*at).map(|[x, y]| [x - left, y - top])).collect()
    };
    let back = inverse(matrix);
    let next = |at| mapped(back.as_ref()?, at);
    [on_mosaic(&Some), on_mosaic(&next)].into_iter().flatten().collect()
}

/// The whole pixels that both frames cover in the coordinates of frame t: left, top, right and bottom.
fn bounds((width, height): (usize, usize), matrix: &Matrix3) -> [f64; 4] {
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let back = inverse(matrix);
    let moved = corners.iter().filter_map(|corner| mapped(back.as_ref()?, *corner));
    let all = moved.chain([[0.0, 0.0], [right, bottom]]);
    let ends = all.fold([0.0f64; 4], |[a, b, c, d], [x, y]| [a.min(x), b.min(y), c.max(x), d.max(y)]);
    let room = [(MOST - 1.0) / 2.0 * right, (MOST - 1.0) / 2.0 * bottom];
    [
        ends[0].max(-room[0]).floor(),
        ends[1].max(-room[1]).floor(),
        ends[2].min(right + room[0]).ceil(),
        ends[3].min(bottom + room[1]).ceil(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_frame_widens_the_mosaic() {
        let wall = |x: i32| (20 * (x.rem_euclid(12))) as u8;
        let frame = |shift: i32| Grid::from_fn(12, 6, |x, _| wall(x as i32 + shift));
        // The camera moves 4 px to the right, so pixels move 4 px to the left.
        let left = [[1.0, 0.0, -4.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let made = mosaic([&frame(0), &frame(4)], &left);
        assert_eq!(made.size(), (16, 6));
        assert!((0..16).all(|x| made.luma()[(x, 3)] == wall(x as i32)), "{:?}", made.luma().row(3));
    }
}
