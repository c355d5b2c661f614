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

/// The numbers of two edges that cross, edge i being that from corner i; the first such pair. The outline also crosses itself where it
/// passes to the other side through a corner. Edges that only touch do not cross.
pub fn crossing(corners: &[Point]) -> Option<[usize; 2]> {
    // Corners on top of the one before have no direction.
    let numbered = corners.iter().copied().enumerate();
    let distinct: Vec<(usize, Point)> =
        numbered.filter(|(i, at)| *at != corners[(i + corners.len() - 1) % corners.len()]).collect();
    let count = distinct.len();
    let at = |i: usize| distinct[i % count].1;
    let later = |i: usize| (i + 2..count).filter(move |j| (j + 1) % count != i);
    let meet = |i: usize, j: usize| {
        let [first, second] = [i, j].map(|i| [at(i), at(i + 1)]);
        // The corners from i and from j on, where one lies on the other edge.
        do_cross(first, second)
            || is_on(second, first[0]) && pass([at(i + count - 1), at(i), at(i + 1)], second, at(j + count - 1))
            || is_on(first, second[0]) && pass([at(j + count - 1), at(j), at(j + 1)], first, at(i + count - 1))
    };
    (0..count).find_map(|i| later(i).find(|j| meet(i, *j)).map(|j| [i, j].map(|i| distinct[i].0)))
}

/// The side of a line on which a place lies, by its sign; 0 on the line.
fn side([a, b]: [Point; 2], p: Point) -> f64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Whether each of two segments has its ends on both sides of the other.
fn do_cross(first: [Point; 2], second: [Point; 2]) -> bool {
    let parts = |line: [Point; 2], other: [Point; 2]| side(line, other[0]) * side(line, other[1]) < 0.0;
    parts(first, second) && parts(second, first)
}

/// Whether a place lies on a segment, its end left out.
fn is_on([a, b]: [Point; 2], p: Point) -> bool {
    let along = (b[0] - a[0]) * (p[0] - a[0]) + (b[1] - a[1]) * (p[1] - a[1]);
    let long = (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2);
    side([a, b], p) == 0.0 && (0.0..long).contains(&along)
}

/// Whether an outline through a corner on another edge passes to its other side. Where the corner is the first of that edge, `before` is the
/// corner before it.
fn pass([from, at, to]: [Point; 3], edge: [Point; 2], before: Point) -> bool {
    let arms = [edge[1], if edge[0] == at { before } else { edge[0] }];
    let ahead = |arm: Point, p: Point| (arm[0] - at[0]) * (p[0] - at[0]) + (arm[1] - at[1]) * (p[1] - at[1]) > 0.0;
    let is_along = |p: Point| arms.iter().any(|arm| side([at, *arm], p) == 0.0 && ahead(*arm, p));
    let turn = side([at, arms[0]], arms[1]);
    // Whether a place is in the angle from the first arm to the second.
    let is_between = |p: Point| {
        let [first, second] = arms.map(|arm| side([at, arm], p));
        match turn {
            turn if turn > 0.0 => first > 0.0 && second < 0.0,
            turn if turn < 0.0 => first > 0.0 || second < 0.0,
            // Straight on, or back along itself.
            _ => first > 0.0 && !ahead(arms[0], arms[1]),
        }
    };
    // An outline that goes on along the edge only touches it here.
    !is_along(from) && !is_along(to) && is_between(from) != is_between(to)
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
        let at_corner = [[0.0, 0.0], [8.0, 8.0], [8.0, 0.0], [4.0, 4.0], [0.0, 8.0]];
        assert_eq!(crossing(&at_corner), Some([0, 3]), "through a corner on an edge");
        let at_both = [[0.0, 0.0], [4.0, 4.0], [8.0, 8.0], [8.0, 0.0], [4.0, 4.0], [0.0, 8.0]];
        assert_eq!(crossing(&at_both), Some([1, 4]), "through a corner at a corner");
        let twice = [[0.0, 0.0], [4.0, 4.0], [4.0, 4.0], [8.0, 8.0], [8.0, 0.0], [4.0, 4.0], [0.0, 8.0]];
        assert!(crossing(&twice).is_some(), "through corners on top of each other");
        let apart = [[0.0, 0.0], [4.0, 4.0], [8.0, 0.0], [8.0, 8.0], [4.0, 4.0], [0.0, 8.0]];
        assert_eq!(crossing(&apart), None, "two corners that only touch");
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
