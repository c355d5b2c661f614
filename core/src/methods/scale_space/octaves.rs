//! Octaves of Gaussian images and their differences.

use std::sync::Arc;

use crate::base::{Threads, effort};
use crate::geometry::{
    Border, Gray, Grid,
    filter::{gaussian_within, separable},
};

/// The dimensions of a scale space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Scales per octave at which extrema are found.
    pub scales: usize,
    /// Standard deviation of the first image of an octave in its px.
    pub sigma_px: f32,
    /// Whether the first octave has twice the resolution of the picture.
    pub is_doubled: bool,
    /// Largest number of octaves.
    pub octaves: usize,
}

/// Standard deviation of the blur that a picture is assumed to have, in px.
const CAMERA_BLUR_PX: f32 = 0.5;

/// Octaves end where a side is shorter than this, in px of the octave: nothing would be left inside the border.
const LEAST_SIDE: usize = 12;

/// One octave: each Gaussian image has a larger standard deviation than the one before.
#[derive(Clone, Debug, Default)]
pub struct Octave {
    /// The Gaussian images, finest first.
    pub gaussians: Vec<Arc<Grid<f32>>>,
    /// Difference i is Gaussian image i + 1 minus i.
    pub differences: Vec<Arc<Grid<f32>>>,
}

/// Octaves of a picture, computed so far.
#[derive(Clone, Debug, Default)]
pub struct ScaleSpace {
    /// The octaves, finest first.
    pub octaves: Vec<Octave>,
}

impl Shape {
    /// Number of Gaussian images per octave; there is one difference less.
    pub fn levels(&self) -> usize {
        self.scales + 3
    }

    /// Width and height of an octave of a picture.
    pub fn size_of(&self, octave: usize, (width, height): (usize, usize)) -> (usize, usize) {
        let times = if self.is_doubled { 2 } else { 1 };
        let halved = |extent: usize| (0..octave).fold(extent * times, |extent, _| extent.div_ceil(2));
        (halved(width), halved(height))
    }

    /// Number of octaves of a picture.
    pub fn octaves_of(&self, picture: (usize, usize)) -> usize {
        let is_large = |octave: &usize| {
            let (width, height) = self.size_of(*octave, picture);
            *octave == 0 || width.min(height) >= LEAST_SIDE
        };
        (0..self.octaves.max(1)).take_while(is_large).count()
    }

    /// Side of a pixel of an octave in px of the picture.
    pub fn pixel_px(&self, octave: usize) -> f32 {
        let first = if self.is_doubled { 0.5 } else { 1.0 };
        first * (1usize << octave) as f32
    }

    /// Standard deviation of a level, whole or between two, in px of the octave.
    pub fn sigma_of(&self, level: f32) -> f32 {
        self.sigma_px * (level / self.scales as f32).exp2()
    }

    /// Standard deviation of the Gaussian filter between the level before and `level`, in px of the octave; before the first level
    /// is the picture.
    pub fn increment_px(&self, octave: usize, level: usize) -> f32 {
        let before = match level {
            0 if octave == 0 => CAMERA_BLUR_PX / self.pixel_px(0),
            0 => return 0.0,
            level => self.sigma_of(level as f32 - 1.0),
        };
        (self.sigma_of(level as f32).powi(2) - before.powi(2)).max(1e-4).sqrt()
    }

    /// Computes the next Gaussian image, and its difference from the one before.
    pub fn add_level(&self, space: &mut ScaleSpace, picture: &Gray, threads: &Threads) {
        let is_full = space.octaves.last().is_none_or(|octave| octave.gaussians.len() == self.levels());
        if is_full {
            space.octaves.push(Octave::default());
        }
        let index = space.octaves.len() - 1;
        let level = space.octaves[index].gaussians.len();
        let image = match (index, level) {
            (0, 0) => self.blurred(&self.base(picture), (0, 0), threads),
            // The image with twice the standard deviation of the first.
            (_, 0) => halved(&space.octaves[index - 1].gaussians[self.scales]),
            _ => self.blurred(&space.octaves[index].gaussians[level - 1], (index, level), threads),
        };
        let octave = &mut space.octaves[index];
        if let Some(before) = octave.gaussians.last() {
            effort::add(image.cells().len());
            let pairs = image.cells().iter().zip(before.cells());
            let cells = pairs.map(|(blurred, sharp)| blurred - sharp).collect();
            octave.differences.extend(Grid::from_vec(image.width(), image.height(), cells).ok().map(Arc::new));
        }
        octave.gaussians.push(Arc::new(image));
    }

    fn blurred(&self, image: &Grid<f32>, (octave, level): (usize, usize), threads: &Threads) -> Grid<f32> {
        let sigma = self.increment_px(octave, level);
        let weights = gaussian_within(sigma, ((4.0 * sigma).round() as usize).max(1));
        separable(image, (&weights, &weights), Border::Mirror, threads)
    }

    /// The picture at the resolution of the first octave.
    fn base(&self, picture: &Gray) -> Grid<f32> {
        if !self.is_doubled {
            return picture.map(|value| f32::from(*value));
        }
        let (width, height) = picture.size();
        effort::add(4 * picture.cells().len());
        let mut base = Grid::new(2 * width, 2 * height, 0.0);
        let mut rows = [vec![0.0; 2 * width], vec![0.0; 2 * width]];
        widen(picture.row(0), &mut rows[0]);
        for y in 0..height {
            let [row, below] = &mut rows;
            widen(picture.row((y + 1).min(height - 1)), below);
            base.row_mut(2 * y).copy_from_slice(row);
            let between = base.row_mut(2 * y + 1).iter_mut();
            between.zip(row.iter().zip(below.iter())).for_each(|(value, (a, b))| *value = (a + b) / 2.0);
            rows.swap(0, 1);
        }
        base
    }
}

/// Interpolates a row linearly at half pixels; pixel x of the row is pixel 2x of the wider one.
fn widen(row: &[u8], wide: &mut [f32]) {
    let next = row.iter().skip(1).chain(row.last());
    for (pair, (here, next)) in wide.chunks_exact_mut(2).zip(row.iter().zip(next)) {
        pair[0] = f32::from(*here);
        pair[1] = (f32::from(*here) + f32::from(*next)) / 2.0;
    }
}

/// Every second pixel of every second row.
fn halved(image: &Grid<f32>) -> Grid<f32> {
    let (width, height) = image.size();
    Grid::from_fn(width.div_ceil(2), height.div_ceil(2), |x, y| image[(2 * x, 2 * y)])
}

impl ScaleSpace {
    /// All octaves of a picture.
    pub fn of(picture: &Gray, shape: &Shape, threads: &Threads) -> Self {
        let mut space = Self::default();
        for _ in 0..shape.octaves_of(picture.size()) * shape.levels() {
            shape.add_level(&mut space, picture, threads);
        }
        space
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: Shape = Shape { scales: 3, sigma_px: 1.6, is_doubled: true, octaves: 8 };

    #[test]
    fn a_doubled_picture_has_its_pixels_at_even_places() {
        let picture = Grid::from_fn(5, 4, |x, y| (10 * x + 40 * y) as u8);
        let base = SHAPE.base(&picture);
        assert_eq!(base.size(), (10, 8));
        assert_eq!((base[(4, 2)], base[(5, 2)], base[(4, 3)]), (60.0, 65.0, 80.0));
        assert_eq!((base[(9, 2)], base[(4, 7)]), (80.0, 140.0));
    }

    #[test]
    fn standard_deviations_double_from_octave_to_octave() {
        assert_eq!(SHAPE.sigma_of(3.0), 2.0 * SHAPE.sigma_px);
        let variance: f32 = (1..=3).map(|level| SHAPE.increment_px(1, level).powi(2)).sum();
        assert!((variance + SHAPE.sigma_px.powi(2) - (2.0 * SHAPE.sigma_px).powi(2)).abs() < 1e-4);
        assert_eq!((SHAPE.pixel_px(0), SHAPE.pixel_px(3)), (0.5, 4.0));
        assert_eq!(SHAPE.octaves_of((640, 480)), 7);
        assert_eq!(SHAPE.octaves_of((3, 3)), 1);
    }

    #[test]
    fn differences_of_a_blurred_step_are_those_of_the_error_function() {
        // A step of height 1 blurred by σ is Φ(x / σ).
        let step = Grid::from_fn(64, 20, |x, _| if x < 32 { 0 } else { 200 });
        let shape = Shape { is_doubled: false, octaves: 1, ..SHAPE };
        let space = ScaleSpace::of(&step, &shape, &Threads::single());
        let [octave] = &space.octaves[..] else { panic!("one octave") };
        assert_eq!((octave.gaussians.len(), octave.differences.len()), (6, 5));
        for (level, image) in octave.gaussians.iter().enumerate() {
            // The camera's blur is assumed, and the step has none.
            let sigma = f64::from(shape.sigma_of(level as f32).powi(2) - CAMERA_BLUR_PX.powi(2)).sqrt();
            for x in 24..40 {
                let near = (0..2000).map(|i| (f64::from(i) - 1000.0) / 1000.0 * 6.0);
                let below = near.filter(|z| *z < (x as f64 - 31.5) / sigma);
                let phi: f64 = below.map(|z| (-0.5 * z * z).exp() * 0.006 / std::f64::consts::TAU.sqrt()).sum();
                let found = f64::from(image[(x, 10)]) / 200.0;
                assert!((found - phi).abs() < 0.012, "level {level}, {x}: {found} instead of {phi}");
            }
        }
    }
}
