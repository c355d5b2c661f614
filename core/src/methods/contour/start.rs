//! The contour of the first frame: as placed, or the ellipse in the region.

use super::{LEAST_AREA_PX, Point};
use crate::base::Error;
use crate::base::words::{fixed, place};
use crate::geometry::{Bounds, polygon};
use crate::methods::region;
use crate::params;
use crate::params::Contour;
use crate::products::Region;

params! {
    /// The start of a contour.
    pub struct Placement {
        /// Region and frames.
        settings: region::Settings = region::Settings::default();
        /// Contour of the object in the first frame: a closed polygon. Without one it is the ellipse in the region.
        contour: Contour = Contour::default();
    }
    when {
        "region": |p| p.contour.corners().is_empty(), "The region has no effect where a contour is placed.";
    }
}

/// The shortest side of the box around a contour in px.
const LEAST_SIDE_PX: f32 = 4.0;
/// Corners of the ellipse.
const CORNERS: usize = 64;

impl Placement {
    /// The placed corners; none if the region is used.
    fn corners(&self) -> Vec<Point> {
        self.contour.corners().iter().map(|at| at.map(f64::from)).collect()
    }

    /// The box around the contour that is placed, or else the region, if one is.
    ///
    /// # Errors
    /// If the contour leaves the picture, encloses too little, or crosses itself.
    pub(crate) fn placed(&self, picture: (usize, usize)) -> Result<Option<Bounds>, Error> {
        let corners = self.corners();
        let Some(bounds) = polygon::bounds(&corners) else { return Ok(self.settings.region) };
        let refused = |why: String| Err(Error::new(format!("{why}, or set contour to none")));
        if let Some(index) = corners.iter().position(|at| !is_inside(*at, picture)) {
            return refused(format!(
                "corner {} of the contour at {} px lies outside the picture of {}×{} px; move it inside",
                index + 1,
                place(corners[index].map(|c| c as f32)),
                picture.0,
                picture.1
            ));
        }
        if spread(&corners) < LEAST_AREA_PX || bounds.size().iter().any(|side| *side < LEAST_SIDE_PX) {
            let [width, height] = bounds.size().map(|side| fixed(side.into(), 1));
            return refused(format!(
                "the contour has {width}×{height} px and an area of {} px², and needs at least {LEAST_SIDE_PX} px a side and \
                 {LEAST_AREA_PX} px²; place it anew",
                fixed(polygon::area(&corners).abs(), 1)
            ));
        }
        if let Some([first, second]) = polygon::crossing(&corners) {
            return refused(format!(
                "the contour crosses itself: its edges {} and {} meet; move their corners apart",
                first + 1,
                second + 1
            ));
        }
        Ok(Some(bounds))
    }

    /// The contour in the first frame, clockwise as seen on the picture: as placed, or the ellipse in `region`.
    pub(crate) fn start(&self, region: Region) -> Vec<Point> {
        let mut corners = self.corners();
        if corners.is_empty() {
            let turn = std::f64::consts::TAU / CORNERS as f64;
            let at = |i: usize| {
                let (sin, cos) = (i as f64 * turn).sin_cos();
                [0, 1].map(|k| f64::from(region.center[k]) + [cos, sin][k] * f64::from(region.size[k]) / 2.0)
            };
            corners = (0..CORNERS).map(at).collect();
        }
        if polygon::area(&corners) < 0.0 {
            corners.reverse();
        }
        corners
    }
}

fn is_inside(at: Point, (width, height): (usize, usize)) -> bool {
    (0..2).all(|i| at[i] >= -0.5 && at[i] <= [width, height][i] as f64 - 0.5)
}

/// The sum of the areas of the triangles between the first corner and each edge: 0 if all corners lie on a line.
fn spread(corners: &[Point]) -> f64 {
    let from = |at: Point| [0, 1].map(|i| at[i] - corners[0][i]);
    let pairs = corners.windows(2).map(|pair| (from(pair[0]), from(pair[1])));
    pairs.map(|(a, b)| (a[0] * b[1] - a[1] * b[0]).abs()).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placement(text: &str) -> Placement {
        let contour = text.split(' ').map(|at| {
            let (x, y) = at.split_once(',').expect("a place");
            [x, y].map(|c| c.parse().expect("a number"))
        });
        Placement { contour: contour.collect(), ..Placement::default() }
    }

    #[test]
    fn contours_that_enclose_nothing_are_refused_in_words() {
        for (text, said) in [
            (
                "3,3 20,3 20,20 70,20",
                "corner 4 of the contour at (70.00,\u{a0}20.00) px lies outside the picture of 64×48 px",
            ),
            ("3,3 20,3 30,3 40,3", "37.0×0.0 px and an area of 0.0 px²"),
            ("3,3 9,3 9,4 3,4", "6.0×1.0 px"),
            ("3,3 20,20 20,3 3,20", "its edges 1 and 3 meet"),
        ] {
            let refusal = placement(text).placed((64, 48)).expect_err(text).to_string();
            assert!(refusal.contains(said) && refusal.ends_with(", or set contour to none"), "{refusal}");
        }
        let sound = placement("3,20 20,20 20,3 3,3");
        assert_eq!(sound.placed((64, 48)).expect("sound"), Some(Bounds { min: [3.0; 2], max: [20.0; 2] }));
        assert!(polygon::area(&sound.start(Region::default())) > 0.0, "it is turned clockwise");
    }

    #[test]
    fn without_a_contour_it_is_the_ellipse_in_the_region() {
        let region = Region::from(Bounds { min: [10.0, 8.0], max: [30.0, 16.0] });
        let start = Placement::default().start(region);
        assert_eq!(polygon::bounds(&start).map(|bounds| bounds.size()), Some([20.0, 8.0]));
        let area = std::f64::consts::PI * 10.0 * 4.0;
        assert!((polygon::area(&start) / area - 1.0).abs() < 0.01);
    }
}
