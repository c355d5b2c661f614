//! Affine motions fitted to a flow by least squares.

use nalgebra::{Matrix3, Vector3};

use super::points::Place;
use crate::base::{Threads, effort};
use crate::data::Flow;
use crate::geometry::Grid;
use crate::products::AffineMotion;

/// Rows that one thread takes at once: a fixed number, so that sums have one order on any number of threads.
const ROWS: usize = 16;

/// Coordinates in which positions of a picture have mean 0 and variance 1, so that the squared distance of two affine motions, as places, is
/// their mean squared difference over the picture in (px/frame)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    center: [f64; 2],
    scale: [f64; 2],
}

impl Frame {
    /// Returns the coordinates of a picture of this size.
    pub fn of((width, height): (usize, usize)) -> Self {
        let extents = [width, height].map(|extent| extent as f64);
        Self {
            center: extents.map(|extent| (extent - 1.0) / 2.0),
            scale: extents.map(|extent| ((extent * extent - 1.0) / 12.0).sqrt().max(1.0)),
        }
    }

    fn basis(&self, x: usize, y: usize) -> [f64; 3] {
        [1.0, (x as f64 - self.center[0]) / self.scale[0], (y as f64 - self.center[1]) / self.scale[1]]
    }

    /// The affine motion of a place in pixels.
    pub fn in_pixels(&self, place: &Place) -> AffineMotion {
        let part = |i: usize| {
            let [c, x, y] = [0, 1, 2].map(|k| f64::from(place[3 * i + k]));
            let (x, y) = (x / self.scale[0], y / self.scale[1]);
            [c - x * self.center[0] - y * self.center[1], x, y]
        };
        let ([a, b, c], [d, e, f]) = (part(0), part(1));
        [a, b, c, d, e, f]
    }

    /// The displacement of a pixel by the motion of a place.
    pub fn displacement(&self, place: &Place, (x, y): (usize, usize)) -> [f64; 2] {
        let basis = self.basis(x, y);
        [0, 3].map(|first| (0..3).map(|k| f64::from(place[first + k]) * basis[k]).sum())
    }
}

/// Sums over the pixels of a layer, from which its affine motion follows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of pixels.
    pub count: usize,
    /// Sums of the products of the basis (1, x, y): 11, 1x, 1y, xx, xy, yy.
    basis: [f64; 6],
    /// Sums of the products of basis and displacement, of u and of v.
    mixed: [[f64; 3]; 2],
    /// Sum of the squared displacements.
    squared: f64,
}

impl Moments {
    /// Adds a pixel.
    fn take(&mut self, [one, x, y]: [f64; 3], uv: [f64; 2]) {
        self.count += 1;
        let products = [one, x, y, x * x, x * y, y * y];
        self.basis.iter_mut().zip(products).for_each(|(sum, value)| *sum += value);
        for (mixed, c) in self.mixed.iter_mut().zip(uv) {
            mixed.iter_mut().zip([c, c * x, c * y]).for_each(|(sum, value)| *sum += value);
            self.squared += c * c;
        }
    }

    /// The sums over the pixels of both.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        sum.add(other);
        sum
    }

    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.basis.iter_mut().zip(other.basis).for_each(|(sum, value)| *sum += value);
        let own = self.mixed.as_flattened_mut().iter_mut();
        own.zip(other.mixed.as_flattened()).for_each(|(sum, value)| *sum += value);
        self.squared += other.squared;
    }

    fn matrix(&self) -> Matrix3<f64> {
        let [a, b, c, d, e, f] = self.basis;
        Matrix3::new(a, b, c, b, d, e, c, e, f)
    }

    /// The affine motion of least squared error; the mean displacement where the pixels do not determine one. `None` without pixels.
    pub fn fit(&self) -> Option<Place> {
        /// Smallest variance of the positions, as a share of that of the picture.
        const LEAST_SPREAD: f64 = 1e-7;
        if self.count == 0 {
            return None;
        }
        let n = self.count as f64;
        let [_, x, y, xx, xy, yy] = self.basis.map(|sum| sum / n);
        let determinant = (xx - x * x) * (yy - y * y) - (xy - x * y) * (xy - x * y);
        let solved = (determinant > LEAST_SPREAD * LEAST_SPREAD).then(|| self.matrix().cholesky()).flatten();
        let part = |mixed: [f64; 3]| match &solved {
            Some(cholesky) => cholesky.solve(&Vector3::from(mixed)).into(),
            None => [mixed[0] / n, 0.0, 0.0],
        };
        let ([a, b, c], [d, e, f]): ([f64; 3], [f64; 3]) = (part(self.mixed[0]), part(self.mixed[1]));
        Some([a, b, c, d, e, f].map(|value| value as f32))
    }

    /// The root mean squared residual of a motion over the pixels in px/frame.
    pub fn residual(&self, place: &Place) -> f64 {
        let matrix = self.matrix();
        let part = |i: usize| {
            let motion = Vector3::new(place[3 * i], place[3 * i + 1], place[3 * i + 2]).map(f64::from);
            (motion.transpose() * matrix * motion)[0] - 2.0 * motion.dot(&Vector3::from(self.mixed[i]))
        };
        ((self.squared + part(0) + part(1)).max(0.0) / self.count.max(1) as f64).sqrt()
    }

    /// The root mean squared difference of two motions over the pixels in px/frame.
    pub fn difference(&self, a: &Place, b: &Place) -> f64 {
        let off: [f64; 6] = std::array::from_fn(|i| f64::from(a[i]) - f64::from(b[i]));
        let matrix = self.matrix();
        let part = |i: usize| {
            let off = Vector3::new(off[3 * i], off[3 * i + 1], off[3 * i + 2]);
            (off.transpose() * matrix * off)[0]
        };
        ((part(0) + part(1)).max(0.0) / self.count.max(1) as f64).sqrt()
    }

    /// Returns the sums of the known flow in a rectangle.
    pub fn of_block(flow: &Flow, frame: &Frame, [columns, rows]: [std::ops::Range<usize>; 2]) -> Self {
        let mut moments = Self::default();
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            if let Some(uv) = flow.at(x, y) {
                moments.take(frame.basis(x, y), uv.map(f64::from));
            }
        }
        moments
    }
}

/// The sums of all `count` layers of a picture; labels count from 1.
pub fn moments_of_labels(
    (flow, frame): (&Flow, &Frame),
    labels: &Grid<u32>,
    count: usize,
    threads: &Threads,
) -> Vec<Moments> {
    let (width, height) = labels.size();
    effort::add(width * height);
    let parts = threads.map(height.div_ceil(ROWS), |part| {
        let mut moments = vec![Moments::default(); count];
        for y in part * ROWS..height.min((part + 1) * ROWS) {
            for (x, (label, uv)) in labels.row(y).iter().zip(flow.0.row(y)).enumerate() {
                if *label > 0 && uv.iter().all(|c| c.is_finite()) {
                    moments[*label as usize - 1].take(frame.basis(x, y), uv.map(f64::from));
                }
            }
        }
        moments
    });
    let mut whole = vec![Moments::default(); count];
    for part in parts {
        whole.iter_mut().zip(&part).for_each(|(sum, part)| sum.add(part));
    }
    whole
}

/// Gives each pixel of known flow the label of the motion with the smallest residual, the first of several; 0 if that exceeds `tolerance` px/frame.
pub fn assign((flow, frame): (&Flow, &Frame), motions: &[Place], tolerance: f32, threads: &Threads) -> Grid<u32> {
    let (width, height) = flow.0.size();
    effort::add(width * height);
    let mut labels = Grid::new(width, height, 0);
    threads.chunks(labels.cells_mut(), width, |y, row| {
        // Along a row, the displacement of a motion is a line.
        let lines: Vec<[f32; 4]> = motions
            .iter()
            .map(|place| {
                let ([u, v], [u1, v1]) = (frame.displacement(place, (0, y)), frame.displacement(place, (1, y)));
                [u as f32, v as f32, (u1 - u) as f32, (v1 - v) as f32]
            })
            .collect();
        for (x, (label, [u, v])) in row.iter_mut().zip(flow.0.row(y)).enumerate() {
            let mut least = tolerance * tolerance;
            for (j, [u0, v0, du, dv]) in lines.iter().enumerate() {
                let off = [u - (u0 + du * x as f32), v - (v0 + dv * x as f32)];
                let squared = off[0] * off[0] + off[1] * off[1];
                if squared < least || (squared == least && *label == 0) {
                    (least, *label) = (squared, j as u32 + 1);
                }
            }
        }
    });
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    fn affine(a: AffineMotion, (width, height): (usize, usize)) -> Flow {
        Flow(Grid::from_fn(width, height, |x, y| {
            let (x, y) = (x as f64, y as f64);
            [(a[0] + a[1] * x + a[2] * y) as f32, (a[3] + a[4] * x + a[5] * y) as f32]
        }))
    }

    #[test]
    fn an_affine_flow_is_fitted_exactly() {
        let truth = [1.5, 0.02, -0.03, -2.0, 0.03, 0.01];
        let (flow, frame) = (affine(truth, (64, 48)), Frame::of((64, 48)));
        let moments = Moments::of_block(&flow, &frame, [20..36, 8..24]);
        let place = moments.fit().expect("pixels");
        let found = frame.in_pixels(&place);
        assert!(found.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-4), "{found:?}");
        assert!(moments.residual(&place) < 1e-4);
        let still = [0.0; 6];
        let direct = (8..24).flat_map(|y| (20..36).map(move |x| (x, y)));
        let squared: f64 = direct.map(|at| flow.0[at].iter().map(|c| f64::from(*c).powi(2)).sum::<f64>()).sum();
        assert!((moments.residual(&still) - (squared / 256.0).sqrt()).abs() < 1e-6);
        assert!((moments.difference(&place, &still) - moments.residual(&still)).abs() < 1e-4);
    }

    #[test]
    fn the_distance_of_places_is_the_mean_squared_difference_over_the_picture() {
        let frame = Frame::of((40, 30));
        let (a, b) = ([1.0, 0.5, -0.2, 0.3, 0.0, 0.9], [0.0, 0.1, 0.4, -1.0, 0.2, 0.0]);
        let all = (0..30).flat_map(|y| (0..40).map(move |x| (x, y)));
        let squared = all.map(|at| {
            let (p, q) = (frame.displacement(&a, at), frame.displacement(&b, at));
            (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
        });
        let mean = squared.sum::<f64>() / 1200.0;
        assert!((mean - f64::from(super::super::squared_distance(&a, &b))).abs() < 1e-5);
    }

    #[test]
    fn pixels_on_a_line_determine_no_more_than_their_mean() {
        let (flow, frame) = (affine([1.0, 0.1, 0.0, 0.0, 0.0, 0.0], (20, 20)), Frame::of((20, 20)));
        let row = Moments::of_block(&flow, &frame, [0..20, 3..4]);
        assert!((row.fit().expect("pixels")[0] - 1.95).abs() < 1e-5);
        assert_eq!(Moments::default().fit(), None);
    }

    #[test]
    fn pixels_go_to_the_motion_that_explains_them() {
        let frame = Frame::of((30, 20));
        let flow = Flow(Grid::from_fn(30, 20, |x, y| match (x, y) {
            (0, _) => Flow::UNKNOWN,
            (29, _) => [9.0, 9.0],
            (x, _) => [if x < 15 { 1.0 } else { -1.0 }, 0.0],
        }));
        let motion = |u: f32| [u, 0.0, 0.0, 0.0, 0.0, 0.0];
        let one = assign((&flow, &frame), &[motion(1.0), motion(-1.0)], 0.5, &Threads::single());
        assert_eq!([one[(0, 3)], one[(5, 3)], one[(20, 3)], one[(29, 3)]], [0, 1, 2, 0]);
        assert_eq!(one, assign((&flow, &frame), &[motion(1.0), motion(-1.0)], 0.5, &Threads::new(3).expect("threads")));
        let sums = moments_of_labels((&flow, &frame), &one, 2, &Threads::single());
        assert_eq!([sums[0].count, sums[1].count], [14 * 20, 14 * 20]);
    }
}
