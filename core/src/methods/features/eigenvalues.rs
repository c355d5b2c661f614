//! The plane of the eigenvalues of the structure tensor, with the regions of corner, edge and flat area.
//!
//! An eigenvalue is the mean square of the gradient along its eigenvector. The axes show the roots, in gray levels per px: most eigenvalues
//! are small, and the region of edges is narrow.

use super::corners::Measure;
use crate::scene::{Regions, Role};

/// The number of points of a boundary.
const POINTS: usize = 96;
/// The steps of a bisection: a float has no more digits.
const HALVINGS: usize = 24;

/// A pixel and the limits of its classes.
pub(super) struct Pixel {
    /// Its name.
    pub name: String,
    /// Its eigenvalues, the larger one first.
    pub eigenvalues: [f32; 2],
    /// The threshold of the response, once it is known.
    pub threshold: Option<f32>,
    /// Below this eigenvalue, noise alone may be the gradient.
    pub flat: f32,
}

/// Returns the regions of a corner measure as C. Harris and M. Stephens draw them (1988, figure 5).
pub(super) fn regions<M: Measure>(measure: &M, Pixel { name, eigenvalues, threshold, flat }: Pixel) -> Regions {
    let of = |[large, small]: [f32; 2]| measure.response([large * large, 0.0, small * small]);
    let [large, small] = eigenvalues.map(|value| value.max(0.0).sqrt());
    let equal = threshold.and_then(|level| crossing(|root| of([root; 2]), level, MOST));
    let flat = flat.sqrt();
    let reach = (1.25 * large).max(2.5 * equal.unwrap_or_default()).max(2.0 * flat).max(1.0);
    let levels = [threshold.map(|level| ("R = threshold", Role::Result, level)), Some(("R = 0", Role::Candidate, 0.0))];
    let line = |(name, role, level)| Some((name, role, boundary(&of, level, reach)?));
    let flat_area = ("limit of flat areas", Role::Predicted, vec![[0.0, flat], [flat, flat], [flat, 0.0]]);
    let boundaries = levels.into_iter().flatten().filter_map(line).chain([flat_area]);
    Regions {
        title: "RMS gradient along the eigenvectors, gray levels per px",
        labels: ["√λ₁", "√λ₂"],
        reach,
        boundaries: boundaries.collect(),
        names: names(flat / reach).map(|(name, at)| (name, at.map(|share| share * reach))).collect(),
        points: vec![(name, Role::Reference, [large, small])],
    }
}

/// The largest root of an eigenvalue that is looked at: responses are squares of eigenvalues.
const MOST: f32 = 1e6;

/// The least share of an axis at which the flat area has room for its name.
const ROOM: f32 = 0.2;

/// The regions with their places as shares of the axes; that of the flat area, which ends at the share `flat`, where it is large enough.
fn names(flat: f32) -> impl Iterator<Item = (&'static str, [f32; 2])> {
    let all = [("corner", [0.72, 0.72]), ("edge", [0.8, 0.07]), ("edge", [0.07, 0.9]), ("flat", [flat / 2.0; 2])];
    all.into_iter().filter(move |(name, _)| flat >= ROOM || *name != "flat")
}

/// The smallest argument from 0 to `most` at which an increasing function reaches `level`.
fn crossing(of: impl Fn(f32) -> f32, level: f32, most: f32) -> Option<f32> {
    // Doubling first: the range may span many powers of two.
    let mut high =
        (0..128).map(|i| 1e-6 * 2.0f32.powi(i)).take_while(|high| *high <= most).find(|high| of(*high) >= level);
    if high.is_none() && of(most) >= level {
        high = Some(most);
    }
    let (mut low, mut high) = (0.0, high?);
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if of(middle) >= level { high = middle } else { low = middle }
    }
    Some(high)
}

/// The line on which the response has a level, from λ₂ = `reach` to λ₁ = `reach`, symmetric about equal eigenvalues; `None` if the
/// response has that level nowhere, or on the axes alone.
fn boundary(of: &impl Fn([f32; 2]) -> f32, level: f32, reach: f32) -> Option<Vec<[f32; 2]>> {
    let apex = crossing(|value| of([value; 2]), level, reach)?;
    let below: Vec<[f32; 2]> = (0..=POINTS)
        .filter_map(|i| {
            let large = apex + (reach - apex) * (i as f32 / POINTS as f32);
            Some([large, crossing(|small| of([large, small]), level, large)?])
        })
        .collect();
    let is_seen = below.last().is_some_and(|[large, small]| *small > 1e-3 * large);
    let mirrored = below.iter().rev().map(|[large, small]| [*small, *large]);
    is_seen.then(|| mirrored.chain(below.iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::super::declare::line;
    use super::super::explain::meaning;
    use super::*;
    use crate::families::interest_points::{Harris, ShiTomasi};
    use crate::scene::Step;

    fn pixel(eigenvalues: [f32; 2], threshold: Option<f32>) -> Pixel {
        Pixel { name: "(1, 2)".into(), eigenvalues, threshold, flat: 5.0 }
    }

    #[test]
    fn the_boundary_of_harris_is_where_its_response_has_the_level() {
        let measure = Harris::default();
        let all = regions(&measure, pixel([40.0, 3.0], Some(200.0)));
        assert_eq!(all.boundaries.len(), 3, "the threshold, zero and the flat area");
        for ((.., line), level) in all.boundaries.iter().zip([200.0, 0.0]) {
            assert!(line.len() > POINTS, "{level}");
            for [a, b] in line {
                let [p, q] = [a * a, b * b];
                let response = p * q - 0.04 * (p + q) * (p + q);
                assert!((response - level).abs() < 1e-3 * (p * q).max(1.0) + 0.05, "{level}: {response} at {a}, {b}");
            }
        }
        assert!(all.points[0].2 == [40f32.sqrt(), 3f32.sqrt()] && all.reach >= 40f32.sqrt());
    }

    #[test]
    fn the_boundary_of_shi_and_tomasi_is_a_right_angle() {
        let all = regions(&ShiTomasi::default(), pixel([9.0, 1.0], Some(4.0)));
        assert_eq!(all.boundaries.len(), 2, "a response of zero is on the axes alone; the flat area");
        let (.., line) = &all.boundaries[0];
        assert!(line.iter().all(|[a, b]| (a.min(*b) - 2.0).abs() < 1e-3), "{line:?}");
    }

    fn told(measure: &impl Measure, eigenvalues: [f32; 2], response: f32) -> String {
        let step = meaning(measure, Step::at(line::RESPOND), eigenvalues, (response, 5.0));
        step.sentence.plain()
    }

    #[test]
    fn weak_gradients_in_two_directions_are_a_flat_area() {
        let harris = Harris::default();
        for [large, small] in [[0.47, 0.07], [4.85, 2.55]] {
            let response = harris.response([large, 0.0, small]);
            assert!(response > 0.0);
            let said = [told(&harris, [large, small], response), told(&ShiTomasi::default(), [large, small], small)];
            for said in said {
                assert!(said.contains("flat area") && !said.contains("corner"), "{said}");
            }
            // Without a threshold, too, the pixel lies in the region named flat.
            let all = regions(&harris, pixel([large, small], None));
            let (.., line) = all.boundaries.last().unwrap();
            let [x, y] = all.points[0].2;
            assert!(x < line[1][0] && y < line[1][1] && all.names.iter().any(|(name, _)| *name == "flat"));
        }
        assert!(told(&harris, [40.0, 30.0], harris.response([40.0, 0.0, 30.0])).contains("corner"));
    }

    #[test]
    fn without_a_threshold_or_texture_the_plane_stays_finite() {
        for eigenvalues in [[0.0; 2], [1e9, 1e-9]] {
            let all = regions(&Harris::default(), pixel(eigenvalues, None));
            assert!(all.reach.is_finite() && all.reach > 0.0);
            assert!(all.boundaries.iter().flat_map(|(.., line)| line).all(|at| at.iter().all(|c| c.is_finite())));
        }
    }
}
