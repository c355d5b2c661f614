//! Templates on the levels of a pyramid, and their warps.

use crate::geometry::{Gray, Grid, pyramid::halvings};
use crate::methods::alignment::{Aligner, gradients, places, warped};
use crate::products::model::{Matrix3, mapped, product};
use crate::products::{Model as Group, Region};

/// A frame on the levels of a pyramid, full resolution first.
pub type Pyramid = Vec<Grid<f32>>;

/// The smallest side of a template on a coarser level in px.
const LEAST_PX: usize = 6;

/// The levels of a frame.
pub fn pyramid(luma: &Gray, levels: usize) -> Pyramid {
    halvings(luma, levels).into_iter().map(|level| level.map(|value| f32::from(*value))).collect()
}

/// A template on a level.
pub struct Level {
    /// Full-resolution px per px of the level.
    step: f64,
    pub pixels: Grid<f32>,
    pub gradients: [Grid<f32>; 2],
    /// The Hessian of all pixels, row by row.
    pub hessian: Vec<f64>,
}

impl Level {
    /// The template of `size` px on a level of a frame under a warp; beyond the border of the frame its edge is repeated.
    fn cut(image: &Grid<f32>, (step, size): (f64, (usize, usize)), warp: &Matrix3, group: Group) -> Self {
        let empty = Grid::new(size.0, size.1, 0.0);
        let mut level = Self { step, gradients: [empty.clone(), empty.clone()], pixels: empty, hessian: Vec::new() };
        let warp = level.on_level(warp);
        level.pixels = Grid::from_fn(size.0, size.1, |x, y| {
            let [u, v] = mapped(&warp, [x as f64, y as f64]).unwrap_or_default();
            image.sample(u as f32, v as f32)
        });
        level.gradients = gradients(&level.pixels);
        level.hessian = level.aligner(group).hessian();
        level
    }

    /// The alignment of the level.
    pub fn aligner(&self, model: Group) -> Aligner<'_> {
        Aligner { model, template: &self.pixels, gradients: &self.gradients }
    }

    fn middle(&self) -> [f64; 2] {
        let (width, height) = self.pixels.size();
        [width, height].map(|extent| (extent as f64 - 1.0) / 2.0)
    }

    /// A warp about the middle of the template as one from pixels of the template to pixels of the frame, both on the level.
    pub fn on_level(&self, warp: &Matrix3) -> Matrix3 {
        let (s, [x, y]) = (self.step, self.middle());
        let about = [[s, 0.0, -s * x], [0.0, s, -s * y], [0.0, 0.0, 1.0]];
        product(&scaling(1.0 / s), &product(warp, &about))
    }

    /// The inverse of [`Level::on_level`].
    pub fn at_full_resolution(&self, warp: &Matrix3) -> Matrix3 {
        let (s, [x, y]) = (self.step, self.middle());
        let back = [[1.0 / s, 0.0, x], [0.0, 1.0 / s, y], [0.0, 0.0, 1.0]];
        product(&scaling(s), &product(warp, &back))
    }

    /// The zero-mean normalised cross-correlation of the template with the warped frame, over the pixels inside, and their share.
    pub fn correlation(&self, image: &Grid<f32>, warp: &Matrix3) -> (f64, f64) {
        let warp = self.on_level(warp);
        let pairs = || {
            let inside = |place| warped(image, &warp, place).map(|value| [self.pixels[place], value].map(f64::from));
            places(&self.pixels).filter_map(inside)
        };
        let (count, sums) = pairs().fold((0usize, [0.0; 2]), |(n, [a, b]), [t, i]| (n + 1, [a + t, b + i]));
        let means = sums.map(|sum: f64| sum / count.max(1) as f64);
        let [product, template, window] = pairs().fold([0.0; 3], |[product, template, window], [t, i]| {
            let (t, i) = (t - means[0], i - means[1]);
            [product + t * i, template + t * t, window + i * i]
        });
        let norm = (template * window).sqrt();
        let correlation = if norm > 0.0 { product / norm } else { 0.0 };
        (correlation, count as f64 / self.pixels.cells().len() as f64)
    }
}

/// A template on all its levels, full resolution first.
pub struct Template {
    pub levels: Vec<Level>,
}

impl Template {
    /// The template in a region of a frame.
    pub fn first(frame: &Pyramid, region: Region, group: Group) -> Self {
        let size = region.size.map(|side| (side.round() as usize).max(1));
        let side = |i: usize, level: usize| size[i].div_ceil(1 << level);
        let count = (1..frame.len()).find(|level| side(0, *level).min(side(1, *level)) < LEAST_PX);
        let [x, y] = region.center.map(f64::from);
        let warp = [[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]];
        let sizes = (0..count.unwrap_or(frame.len())).map(|level| (side(0, level), side(1, level)));
        Self { levels: cut(frame, sizes, &warp, group) }
    }

    /// The template that the warp shows in a frame.
    pub fn warped(&self, frame: &Pyramid, warp: &Matrix3, group: Group) -> Self {
        Self { levels: cut(frame, self.levels.iter().map(|level| level.pixels.size()), warp, group) }
    }

    /// Width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.levels[0].pixels.size()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let of = |level: &Level| {
            size_of::<Level>() + 3 * size_of_val(level.pixels.cells()) + size_of_val(&level.hessian[..])
        };
        self.levels.iter().map(of).sum()
    }
}

fn cut(frame: &Pyramid, sizes: impl Iterator<Item = (usize, usize)>, warp: &Matrix3, group: Group) -> Vec<Level> {
    let levels = sizes.enumerate().zip(frame);
    levels.map(|((level, size), image)| Level::cut(image, (f64::from(1u32 << level), size), warp, group)).collect()
}

fn scaling(factor: f64) -> Matrix3 {
    [[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, 1.0]]
}

/// The outer corners of a template about its middle.
fn corners((width, height): (usize, usize)) -> [[f64; 2]; 4] {
    let [x, y] = [width, height].map(|side| side as f64 / 2.0);
    [[-x, -y], [x, -y], [x, y], [-x, y]]
}

/// The outline of a template under a warp.
pub fn outline(warp: &Matrix3, size: (usize, usize)) -> Vec<[f32; 2]> {
    corners(size).iter().filter_map(|at| mapped(warp, *at)).map(|at| at.map(|c| c as f32)).collect()
}

/// The farthest distance of a corner under one warp from the same under another, in px.
pub fn farthest([first, second]: [&Matrix3; 2], size: (usize, usize)) -> f64 {
    let apart = |at: [f64; 2]| match (mapped(first, at), mapped(second, at)) {
        (Some(a), Some(b)) => (b[0] - a[0]).hypot(b[1] - a[1]),
        _ => f64::INFINITY,
    };
    corners(size).into_iter().map(apart).fold(0.0, f64::max)
}

/// The largest and the smallest factor by which the second affine warp changes lengths after the first: the singular values of its
/// linear part.
pub fn stretch([first, second]: [&Matrix3; 2]) -> [f64; 2] {
    let [[[a, b, _], [c, d, _], _], [[e, f, _], [g, h, _], _]] = [*first, *second];
    let by = a * d - b * c;
    let [m, n, p, q] = [e * d - f * c, f * a - e * b, g * d - h * c, h * a - g * b].map(|part| part / by);
    let (turned, mirrored) = ((m + q).hypot(p - n) / 2.0, (m - q).hypot(n + p) / 2.0);
    [turned + mirrored, (turned - mirrored).abs()]
}

/// The ellipse to which an affine warp maps the ellipse inside the template: its first axis is within 45° of x.
pub fn region_of(warp: &Matrix3, extent: [f32; 2]) -> Region {
    let half = extent.map(|side| f64::from(side) / 2.0);
    let [[a, b, x], [c, d, y], _] = warp.map(|row| [row[0] * half[0], row[1] * half[1], row[2]]);
    // The axes are the eigenvectors of the product with the transpose.
    let (xx, xy, yy) = (a * a + b * b, a * c + b * d, c * c + d * d);
    let (mean, apart) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let [major, minor] = [mean + apart, (mean - apart).max(0.0)].map(|square| 2.0 * square.sqrt());
    let (size, angle) = if xx >= yy {
        ([major, minor], (2.0 * xy).atan2(xx - yy) / 2.0)
    } else {
        ([minor, major], (-2.0 * xy).atan2(yy - xx) / 2.0)
    };
    Region { center: [x, y].map(|c| c as f32), size: size.map(|side| side as f32), angle_rad: angle as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_region_is_the_ellipse_of_the_warp() {
        let warp = [[1.1, -0.4, 31.0], [0.3, 0.8, 22.0], [0.0, 0.0, 1.0]];
        let region = region_of(&warp, [20.0, 30.0]);
        assert_eq!(region.center, [31.0, 22.0]);
        assert!(region.angle_rad.abs() <= std::f32::consts::FRAC_PI_4 + 1e-6);
        // Every point of the ellipse inside the template lies on it.
        let (sin, cos) = region.angle_rad.sin_cos();
        for i in 0..12 {
            let (s, c) = (f64::from(i) * 0.5).sin_cos();
            let [x, y] = mapped(&warp, [10.0 * c, 15.0 * s]).expect("affine").map(|c| c as f32);
            let [x, y] = [x - 31.0, y - 22.0];
            let [u, v] = [(cos * x + sin * y) / region.size[0], (cos * y - sin * x) / region.size[1]];
            assert!((u.hypot(v) - 0.5).abs() < 1e-5, "{u}, {v}");
        }
        let moved = [[1.0, 0.0, 5.0], [0.0, 1.0, 6.0], [0.0, 0.0, 1.0]];
        for extent in [[20.0, 30.0], [30.0, 20.0], [25.0, 25.0]] {
            let region = region_of(&moved, extent);
            assert_eq!((region.size, region.angle_rad), (extent, 0.0), "a box stays one");
        }
    }

    #[test]
    fn a_warp_of_a_level_comes_back() {
        let frame = pyramid(&Grid::from_fn(80, 64, |x, y| ((x * 7 + y * 13) % 251) as u8), 3);
        let region = Region { center: [40.0, 31.0], size: [31.0, 24.0], angle_rad: 0.0 };
        let template = Template::first(&frame, region, Group::Affine);
        assert_eq!(
            template.levels.iter().map(|level| level.pixels.size()).collect::<Vec<_>>(),
            [(31, 24), (16, 12), (8, 6)]
        );
        let warp = [[1.1, -0.4, 31.0], [0.3, 0.8, 22.0], [0.0, 0.0, 1.0]];
        for level in &template.levels {
            let back = level.at_full_resolution(&level.on_level(&warp));
            assert!(back.iter().flatten().zip(warp.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        let still = [[1.0, 0.0, 40.0], [0.0, 1.0, 31.0], [0.0, 0.0, 1.0]];
        let (correlation, overlap) = template.levels[0].correlation(&frame[0], &still);
        assert!((correlation - 1.0).abs() < 1e-9 && overlap == 1.0, "{correlation}, {overlap}");
    }
}
