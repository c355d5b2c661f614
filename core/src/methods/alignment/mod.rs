//! Alignment of a picture with a template by Gauss–Newton iterations on gray levels, in their inverse compositional form (S. Baker and
//! I. Matthews, Lucas–Kanade 20 years on: a unifying framework, IJCV 56(3), 2004).

pub(crate) mod explain;
mod warp;

pub(crate) use warp::{composed, gradients, rank, solve};

use crate::geometry::{Grid, Sampling};
use crate::products::Model;
use crate::products::model::{Matrix3, mapped};
use warp::{Normalized, columns, warp_of};

/// The comparison of a template with the warped picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compared {
    /// Root mean square difference in gray levels.
    pub rms: f64,
    /// Share of the pixels that lie inside the picture.
    pub overlap: f64,
    /// The right-hand side: sums of steepest-descent images times difference.
    pub right: Vec<f64>,
    /// The Hessian of those pixels, row by row.
    pub hessian: Vec<f64>,
}

/// The solution of an iteration.
#[derive(Clone, Debug)]
pub(crate) struct Increment {
    /// The parameters, in coordinates about the middle of the template.
    pub parameters: Vec<f64>,
    /// The warp of the parameters in px of the template.
    pub matrix: Matrix3,
    /// Farthest motion of a corner, in px of the template.
    pub moved_px: f64,
}

/// A template with its derivatives, and the group of its warps.
#[derive(Clone, Copy)]
pub struct Aligner<'a> {
    pub model: Model,
    pub template: &'a Grid<f32>,
    /// Derivatives of the template along x and y, in gray levels/px.
    pub gradients: &'a [Grid<f32>; 2],
}

impl Aligner<'_> {
    fn coordinates(&self) -> Normalized {
        Normalized::of(self.template.size())
    }

    /// The values of the steepest-descent images at a pixel.
    #[inline(always)]
    fn columns(&self, coordinates: &Normalized, (x, y): (usize, usize)) -> [f64; 8] {
        let gradient = [self.gradients[0][(x, y)], self.gradients[1][(x, y)]];
        columns(self.model, coordinates.of_pixel(x, y), gradient, coordinates.scale)
    }

    /// The products of the steepest-descent images: the Gauss–Newton approximation of the Hessian.
    pub fn hessian(&self) -> Vec<f64> {
        let (count, coordinates) = (self.model.freedom(), self.coordinates());
        let mut hessian = vec![0.0; count * count];
        for place in places(self.template) {
            add_products(&mut hessian, &self.columns(&coordinates, place)[..count]);
        }
        hessian
    }

    /// Compares the template with the warped `image`. The Hessian of the pixels inside is `all`, that of all pixels, without those
    /// outside, which are few.
    pub(crate) fn compare(&self, all: &[f64], image: &Grid<f32>, warp: &Matrix3) -> Compared {
        let (count, coordinates) = (self.model.freedom(), self.coordinates());
        let (mut right, mut squares, mut inside) = (vec![0.0; count], 0.0, 0usize);
        let mut outside = vec![0.0; count * count];
        for place in places(self.template) {
            let row = self.columns(&coordinates, place);
            let Some(difference) = difference([self.template, image], warp, place) else {
                add_products(&mut outside, &row[..count]);
                continue;
            };
            right.iter_mut().zip(&row).for_each(|(sum, value)| *sum += value * f64::from(difference));
            squares += f64::from(difference * difference);
            inside += 1;
        }
        let rms = (squares / inside.max(1) as f64).sqrt();
        let hessian = all.iter().zip(outside).map(|(all, outside)| all - outside).collect();
        Compared { rms, overlap: inside as f64 / self.template.cells().len() as f64, right, hessian }
    }

    /// Solves for the increment; `None` if the Hessian is singular.
    pub(crate) fn increment(&self, Compared { hessian, right, .. }: &Compared) -> Option<Increment> {
        let parameters = solve(hessian, right)?;
        let matrix = self.coordinates().in_px(&warp_of(self.model, &parameters));
        Some(Increment { moved_px: moved_px(&matrix, self.template.size()), parameters, matrix })
    }
}

/// Adds the products of all pairs of entries of `row` to a symmetric matrix.
#[inline(always)]
fn add_products(matrix: &mut [f64], row: &[f64]) {
    for (line, value) in matrix.chunks_exact_mut(row.len()).zip(row) {
        line.iter_mut().zip(row).for_each(|(sum, other)| *sum += value * other);
    }
}

/// The pixels of a picture, row by row.
pub(crate) fn places(picture: &Grid<f32>) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (width, height) = picture.size();
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// The gray level I(W(x)) of a pixel, if it is warped into the picture.
#[inline(always)]
pub(crate) fn warped(image: &Grid<f32>, warp: &Matrix3, (x, y): (usize, usize)) -> Option<f32> {
    let [u, v] = mapped(warp, [x as f64, y as f64])?;
    let value = Sampling::Bilinear.sample_inside(image, u as f32, v as f32);
    value.is_finite().then_some(value)
}

/// The difference I(W(x)) − T(x) of a pixel, if it is warped into the picture.
#[inline(always)]
pub(crate) fn difference([template, image]: [&Grid<f32>; 2], warp: &Matrix3, place: (usize, usize)) -> Option<f32> {
    warped(image, warp, place).map(|value| value - template[place])
}

/// The farthest motion of a corner of a picture, in px.
fn moved_px(matrix: &Matrix3, (width, height): (usize, usize)) -> f64 {
    let [right, bottom] = [width, height].map(|extent| extent as f64 - 1.0);
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let moved = |at: [f64; 2]| mapped(matrix, at).map_or(f64::INFINITY, |to| (to[0] - at[0]).hypot(to[1] - at[1]));
    corners.into_iter().map(moved).fold(0.0, f64::max)
}
