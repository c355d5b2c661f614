//! Repeatability: the share of keypoints that are detected again in another picture of the same plane.

use nalgebra::{Matrix3, Vector3};

use super::assessment::{fact, scores};
use super::keypoints::REPEATABILITY;
use super::{Assessment, PointField, Reference};
use crate::base::words::grouped;
use crate::data::Flow;
use crate::geometry::Grid;

/// The repeatability of a detector on two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Repeatability {
    /// Keypoints of the first picture that lie in the second.
    pub first: usize,
    /// Keypoints of the second picture that lie in the first.
    pub second: usize,
    /// Keypoints of the first picture with one of the second within the tolerance.
    pub repeated: usize,
}

impl Repeatability {
    /// The repeated share of the fewer of both, 0 to 1; `None` if there are none (C. Schmid, R. Mohr and C. Bauckhage, IJCV 37(2),
    /// 2000).
    pub fn share(self) -> Option<f64> {
        let possible = self.first.min(self.second);
        (possible > 0).then(|| self.repeated.min(possible) as f64 / possible as f64)
    }
}

/// Compares the keypoints of two pictures of a plane. `homography` maps the first to the second, row by row; a keypoint is repeated
/// if one of the other picture lies at most `tolerance_px` from where it is mapped. `None` if the homography has no inverse.
pub fn repeatability(
    [first, second]: [&PointField; 2],
    homography: [[f64; 3]; 3],
    tolerance_px: f64,
) -> Option<Repeatability> {
    let to_second = Matrix3::from_fn(|row, column| homography[row][column]);
    let to_first = to_second.try_inverse()?;
    let places = |field: &PointField, to: Matrix3<f64>, other: (usize, usize)| -> Vec<([f64; 2], [f64; 2])> {
        let at = field.points.iter().map(|point| point.at.map(f64::from));
        at.filter_map(|at| Some((at, mapped(to, at)?))).filter(|(_, there)| is_in(*there, other)).collect()
    };
    let here = places(first, to_second, second.picture);
    let there = places(second, to_first, first.picture);
    let is_near = |[x, y]: [f64; 2]| there.iter().any(|([a, b], _)| (a - x).hypot(b - y) <= tolerance_px);
    let repeated = here.iter().filter(|(_, place)| is_near(*place)).count();
    Some(Repeatability { first: here.len(), second: there.len(), repeated })
}

/// Compares the keypoints of frames t and t + 1 where the true flow is known. A keypoint of frame t counts where its true position in frame t + 1
/// is known, in the picture and not `hidden`; one of frame t + 1 counts where a pixel of frame t leads to.
pub(crate) fn repeatability_in_flow(
    [first, second]: [&PointField; 2],
    flow: &Flow,
    hidden: Option<&Grid<bool>>,
    tolerance_px: f64,
) -> Repeatability {
    let is_hidden = |place: (usize, usize)| hidden.is_some_and(|hidden| hidden.get(place.0, place.1) == Some(&true));
    let led = |at: [f32; 2]| {
        let place = flow.0.cell_at(at).filter(|place| !is_hidden(*place))?;
        // Between pixels of which one is unknown, the value of the nearest.
        let [u, v] = flow.sample(at).or_else(|| flow.at(place.0, place.1))?;
        Some([at[0] + u, at[1] + v].map(f64::from)).filter(|to| is_in(*to, second.picture))
    };
    let seen = seen_from(flow, is_hidden, second.picture);
    let here: Vec<[f64; 2]> = first.points.iter().filter_map(|point| led(point.at)).collect();
    let is_seen = |at: &[f32; 2]| seen.cell_at(*at).is_some_and(|place| seen[place]);
    let there: Vec<[f32; 2]> = second.points.iter().map(|point| point.at).filter(is_seen).collect();
    let is_near =
        |[x, y]: [f64; 2]| there.iter().any(|at| (f64::from(at[0]) - x).hypot(f64::from(at[1]) - y) <= tolerance_px);
    let repeated = here.iter().filter(|place| is_near(**place)).count();
    Repeatability { first: here.len(), second: there.len(), repeated }
}

/// The pixels of frame t + 1 that are seen in frame t: those within the quadrilateral to which the flow moves a square of four neighbouring
/// pixels.
fn seen_from(flow: &Flow, is_hidden: impl Fn((usize, usize)) -> bool, size: (usize, usize)) -> Grid<bool> {
    let (width, height) = flow.0.size();
    let to = |(x, y): (usize, usize)| {
        let [u, v] = flow.at(x, y).filter(|_| !is_hidden((x, y)))?;
        Some([x as f32 + u, y as f32 + v])
    };
    let mut seen = Grid::new(size.0, size.1, false);
    let squares = (1..height).flat_map(|y| (1..width).map(move |x| (x, y)));
    for (x, y) in squares {
        let corners = [(x - 1, y - 1), (x, y - 1), (x, y), (x - 1, y)].map(to);
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            [[a, b, c], [a, c, d]].iter().for_each(|triangle| cover(&mut seen, triangle));
        }
    }
    seen
}

/// Marks the pixels within a triangle and on its border, unless it stretches from one motion to another.
fn cover(seen: &mut Grid<bool>, triangle: &[[f32; 2]; 3]) {
    /// Longest side of a triangle within one motion, in px.
    const MOST_PX: f32 = 8.0;
    /// Tolerance for rounding at a border.
    const MARGIN: f32 = 1e-3;
    let span = [0, 1].map(|i| {
        let (low, high) = triangle.iter().fold((f32::MAX, f32::MIN), |(a, b), p| (a.min(p[i]), b.max(p[i])));
        ((low - MARGIN).ceil(), (high + MARGIN).floor())
    });
    if span.iter().any(|(low, high)| high - low > MOST_PX) {
        return;
    }
    let [columns, rows] = span.map(|(low, high)| low.max(0.0) as usize..(high + 1.0).max(0.0) as usize);
    for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
        let sides = [0, 1, 2].map(|i| {
            let ([ax, ay], [bx, by]) = (triangle[i], triangle[(i + 1) % 3]);
            (bx - ax) * (y as f32 - ay) - (by - ay) * (x as f32 - ax)
        });
        let is_inside = sides.iter().all(|side| *side >= -MARGIN) || sides.iter().all(|side| *side <= MARGIN);
        if is_inside && seen.get(x, y).is_some() {
            seen[(x, y)] = true;
        }
    }
}

/// Largest distance of a repeated keypoint from its true position in px.
pub(crate) const TOLERANCE_PX: f64 = 1.5;

impl PointField {
    /// The repeatability of a detector whose result this is, given its result on frame t + 1; without figures where the true flow is not known.
    pub fn repeated(&self, in_next: &Self, reference: &Reference<'_>) -> Assessment {
        let Some(truth) = reference.clip.truth() else { return Assessment::default() };
        let both = truth.flow(reference.frame).and_then(|flow| Ok((flow, truth.occlusion(reference.frame)?)));
        let (flow, hidden) = match both {
            Ok((Some(flow), hidden)) => (flow, hidden),
            Ok((None, _)) => return Assessment::default(),
            Err(error) => return Assessment { truth_error: Some(error), ..Assessment::default() },
        };
        let found = repeatability_in_flow([self, in_next], &flow, hidden.as_deref(), TOLERANCE_PX);
        let visible = found.first.min(found.second);
        let repeated = found.repeated.min(visible);
        let told = match found.share() {
            None => "unknown: no keypoint is visible in both frames".to_owned(),
            Some(share) => format!(
                "{share:.3}, {} of {} keypoints within {TOLERANCE_PX} px of their true position",
                grouped(repeated),
                grouped(visible)
            ),
        };
        let conclusion = match found.share() {
            None => "The repeatability is unknown: 0 keypoints are visible in both frames.".to_owned(),
            Some(share) => format!(
                "Repeatability {share:.3}: {} of {} keypoints visible in both frames are detected in frame t+1 within {TOLERANCE_PX} px of their \
                 true position.",
                grouped(repeated),
                grouped(visible)
            ),
        };
        let values = [found.share().into(), repeated.into(), visible.into()];
        let assessment = Assessment { conclusion, ..Assessment::default() };
        assessment.with(scores(&REPEATABILITY, values), vec![fact("Repeatability", told)])
    }
}

/// A place mapped by a homography; `None` at infinity.
fn mapped(homography: Matrix3<f64>, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let place = homography * Vector3::new(x, y, 1.0);
    let [u, v] = [place.x / place.z, place.y / place.z];
    (u.is_finite() && v.is_finite()).then_some([u, v])
}

fn is_in([x, y]: [f64; 2], (width, height): (usize, usize)) -> bool {
    x >= 0.0 && y >= 0.0 && x <= width as f64 - 1.0 && y <= height as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::products::Feature;

    fn field(points: &[[f32; 2]]) -> PointField {
        let feature = |at: &[f32; 2]| Feature::found(*at);
        PointField { picture: (100, 80), points: points.iter().map(feature).collect(), keypoints: Vec::new() }
    }

    #[test]
    fn what_lies_outside_the_other_picture_does_not_count() {
        // Ten px to the right.
        let shift = [[1.0, 0.0, 10.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let a = field(&[[20.0, 30.0], [50.0, 40.0], [95.0, 10.0]]);
        let b = field(&[[31.0, 30.0], [63.0, 40.0], [4.0, 4.0], [15.0, 5.0]]);
        let found = repeatability([&a, &b], shift, 1.5).expect("an inverse");
        assert_eq!(found, Repeatability { first: 2, second: 3, repeated: 1 });
        assert_eq!(found.share(), Some(0.5));
        let wider = repeatability([&a, &b], shift, 3.0).expect("an inverse");
        assert_eq!(wider.share(), Some(1.0));
    }

    #[test]
    fn in_a_flow_it_is_the_same_as_by_its_homography() {
        let shift = [[1.0, 0.0, 10.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let flow = Flow(Grid::new(100, 80, [10.0, 0.0]));
        let a = field(&[[20.0, 30.0], [50.0, 40.0], [95.0, 10.0], [70.4, 60.2]]);
        let b = field(&[[31.0, 30.0], [63.0, 40.0], [4.0, 4.0], [15.0, 5.0], [80.0, 60.0]]);
        for tolerance in [1.5, 3.0] {
            let found = repeatability_in_flow([&a, &b], &flow, None, tolerance);
            assert_eq!(Some(found), repeatability([&a, &b], shift, tolerance));
        }
        // Hidden and unknown pixels do not count.
        let hidden = Grid::from_fn(100, 80, |x, y| (x, y) == (20, 30));
        let found = repeatability_in_flow([&a, &b], &flow, Some(&hidden), 1.5);
        assert_eq!((found.first, found.repeated), (2, 1));
        let unknown = Flow(Grid::new(100, 80, Flow::UNKNOWN));
        assert_eq!(repeatability_in_flow([&a, &b], &unknown, None, 1.5).share(), None);
    }

    #[test]
    fn nothing_to_compare_has_no_share() {
        let none = field(&[]);
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(repeatability([&none, &none], unit, 1.5).and_then(Repeatability::share), None);
        assert_eq!(repeatability([&none, &none], [[0.0; 3]; 3], 1.5), None);
    }
}
