//! Closed polygons by their corners in px; the last corner joins the first.

use std::ops::Range;

use super::Bounds;

/// A place in px.
type Point = [f64; 2];

/// The corners joined to the next one each.
fn edges(corners: &[Point]) -> impl Iterator<Item = [Point; 2]> + '_ {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

/// The enclosed area in px² (shoelace formula): positive if the corners go from x towards y, clockwise as seen on the picture.
pub fn area(corners: &[Point]) -> f64 {
    edges(corners).map(|[a, b]| a[0] * b[1] - b[0] * a[1]).sum::<f64>() / 2.0
}

/// The length of the outline in px.
pub fn length(corners: &[Point]) -> f64 {
    edges(corners).map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
}

/// The box around the corners; nothing without corners.
pub fn bounds(corners: &[Point]) -> Option<Bounds> {
    let first = corners.first()?;
    let [min, max] = corners
        .iter()
        .fold([*first; 2], |[low, high], at| [[0, 1].map(|i| low[i].min(at[i])), [0, 1].map(|i| high[i].max(at[i]))]);
    Some(Bounds { min: min.map(|c| c as f32), max: max.map(|c| c as f32) })
}

/// The numbers of two edges that cross, edge i being that from corner i; the first such pair. Edges that only touch do not cross.
pub fn crossing(corners: &[Point]) -> Option<[usize; 2]> {
    let all: Vec<_> = edges(corners).collect();
    let count = all.len();
    let later = |i: usize| (i + 2..count).filter(move |j| (j + 1) % count != i);
    (0..count).find_map(|i| later(i).find(|j| do_cross(all[i], all[*j])).map(|j| [i, j]))
}

/// Whether each of two segments has its ends on both sides of the other.
fn do_cross(first: [Point; 2], second: [Point; 2]) -> bool {
    let side = |[a, b]: [Point; 2], p: Point| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let parts = |line: [Point; 2], other: [Point; 2]| side(line, other[0]) * side(line, other[1]) < 0.0;
    parts(first, second) && parts(second, first)
}

/// `count` points at equal distances along the outline, from the first corner on.
///
/// # Panics
/// If there are no corners.
pub fn resampled(corners: &[Point], count: usize) -> Vec<Point> {
    let step = length(corners) / count as f64;
    let (mut points, mut passed) = (Vec::with_capacity(count), 0.0);
    for [a, b] in edges(corners) {
        let long = (b[0] - a[0]).hypot(b[1] - a[1]);
        while points.len() < count && points.len() as f64 * step < passed + long {
            let part = (points.len() as f64 * step - passed) / long;
            points.push([0, 1].map(|i| a[i] + part * (b[i] - a[i])));
        }
        passed += long;
    }
    // A rounding error at the end, or an outline without length.
    points.resize(count, corners[0]);
    points
}

/// Calls `put` with each row and the pixels of it that have their centres inside; a pixel of several overlapping parts is inside by the
/// even–odd rule. Parts outside a picture of this size are left out.
pub fn fill(corners: &[Point], (width, height): (usize, usize), mut put: impl FnMut(usize, Range<usize>)) {
    let Some(Bounds { min, max }) = bounds(corners) else { return };
    let first = min[1].ceil().max(0.0) as usize;
    let end = ((max[1].floor() + 1.0).max(0.0) as usize).min(height);
    let mut places: Vec<f64> = Vec::new();
    for y in first..end {
        let level = y as f64;
        places.clear();
        places.extend(edges(corners).filter(|[a, b]| (a[1] <= level) != (b[1] <= level)).map(|[a, b]| {
            let part = (level - a[1]) / (b[1] - a[1]);
            a[0] + part * (b[0] - a[0])
        }));
        places.sort_by(f64::total_cmp);
        for pair in places.as_chunks::<2>().0 {
            let [from, to] = pair.map(|x| (x.ceil().max(0.0) as usize).min(width));
            if from < to {
                put(y, from..to);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const L: [Point; 6] = [[1.0, 1.0], [9.0, 1.0], [9.0, 4.0], [5.0, 4.0], [5.0, 8.0], [1.0, 8.0]];

    #[test]
    fn area_length_and_bounds_are_those_of_the_shape() {
        assert_eq!((area(&L), length(&L)), (40.0, 30.0));
        let back: Vec<Point> = L.iter().rev().copied().collect();
        assert_eq!(area(&back), -40.0);
        assert_eq!(bounds(&L), Some(Bounds { min: [1.0; 2], max: [9.0, 8.0] }));
        assert_eq!((bounds(&[]), area(&[])), (None, 0.0));
    }

    #[test]
    fn edges_that_cross_are_found() {
        assert_eq!(crossing(&L), None);
        assert_eq!(crossing(&[[0.0, 0.0], [8.0, 8.0], [8.0, 0.0], [0.0, 8.0]]), Some([0, 2]));
        let touching = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [4.0, 0.0]];
        assert_eq!(crossing(&touching), None, "a corner on another edge");
        assert_eq!(crossing(&[[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]]), None, "a triangle has neighbours only");
    }

    #[test]
    fn points_are_at_equal_distances_along_the_outline() {
        let points = resampled(&L, 15);
        assert_eq!((points.len(), points[0], points[4], points[6]), (15, L[0], [9.0, 1.0], [8.0, 4.0]));
        assert_eq!(resampled(&[[2.0, 3.0]; 4], 5), [[2.0, 3.0]; 5], "no length");
        let circle: Vec<Point> =
            (0..360).map(|i| f64::from(i).to_radians()).map(|a| [9.0 * a.cos(), 9.0 * a.sin()]).collect();
        let points = resampled(&circle, 40);
        assert!(edges(&points).all(|[a, b]| ((b[0] - a[0]).hypot(b[1] - a[1]) - 1.4123).abs() < 1e-3));
    }

    #[test]
    fn pixels_inside_are_those_of_the_even_odd_rule() {
        let shapes: [&[Point]; 3] = [
            &L.map(|at| [at[0] - 3.3, at[1] + 0.4]),
            &[[0.2, 0.3], [11.6, 7.7], [11.6, -2.0], [1.1, 8.9]],
            &[[-3.0, 20.0], [30.0, 4.5], [2.0, -9.0]],
        ];
        for corners in shapes {
            let mut found = [[false; 12]; 9];
            fill(corners, (12, 9), |y, xs| xs.for_each(|x| found[y][x] = true));
            for (y, row) in found.iter().enumerate() {
                for (x, is_found) in row.iter().enumerate() {
                    let at = [x as f64, y as f64];
                    let passes = |[a, b]: &[Point; 2]| {
                        (a[1] > at[1]) != (b[1] > at[1])
                            && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                    };
                    assert_eq!(*is_found, edges(corners).filter(passes).count() % 2 == 1, "{x}, {y} of {corners:?}");
                }
            }
        }
    }
}
