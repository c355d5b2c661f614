//! Explanations shared by alignments: pictures, matrices and the plot of the error.

use super::warp::names;
use super::{Aligner, warped};
use crate::geometry::Grid;
use crate::products::Model;
use crate::products::model::Matrix3;
use crate::scene::{Matrix, Role, Section, Series, Tile};

/// Cells along a side of a tile, at most.
const CELLS: usize = 36;
/// The labels of the steepest-descent images.
const IMAGES: [&str; 8] = ["D₁", "D₂", "D₃", "D₄", "D₅", "D₆", "D₇", "D₈"];

/// A picture of values as a tile of limited size: every second value, every third, and so on.
fn sampled((width, height): (usize, usize), value: impl Fn(usize, usize) -> f32) -> Grid<f32> {
    let step = width.max(height).div_ceil(CELLS).max(1);
    Grid::from_fn(width.div_ceil(step), height.div_ceil(step), |x, y| value(x * step, y * step))
}

pub(crate) fn steepest_descent(aligner: &Aligner<'_>) -> Vec<Tile> {
    let coordinates = aligner.coordinates();
    let image = |k: usize| {
        let values = sampled(aligner.template.size(), |x, y| aligner.columns(&coordinates, (x, y))[k] as f32);
        let most = values.cells().iter().fold(1e-3f32, |most, value| most.max(value.abs()));
        Tile::new(IMAGES[k], values, [-most, most])
    };
    (0..aligner.model.freedom()).map(image).collect()
}

/// A template, called `label`, the warped picture, and their difference.
pub(crate) fn compared(label: &'static str, [template, image]: [&Grid<f32>; 2], warp: &Matrix3) -> Vec<Tile> {
    let warped = |x, y| warped(image, warp, (x, y)).unwrap_or(f32::NAN);
    let size = template.size();
    vec![
        Tile::gray(label, sampled(size, |x, y| template[(x, y)])),
        Tile::gray("warped", sampled(size, warped)),
        Tile::new("difference", sampled(size, |x, y| warped(x, y) - template[(x, y)]), [-64.0, 64.0]),
    ]
}

/// The right-hand side and the increment of an iteration: a number for each parameter.
pub(crate) fn parameter_vectors(model: Model, right: &[f64], increment: &[f64]) -> [Matrix; 2] {
    let labels = || names(model).iter().copied();
    [
        Matrix::column("b", "right-hand side", right).with_role(Role::Error).with_rows(labels()),
        Matrix::column("Δp", "increment", increment).with_role(Role::Estimate).with_rows(labels()),
    ]
}

/// The Hessian of the parameters.
pub(crate) fn hessian(model: Model, values: &[f64]) -> Matrix {
    let count = model.freedom();
    let labels = || names(model).iter().copied();
    let entries = Grid::from_fn(count, count, |x, y| values[y * count + x]);
    Matrix::new("H", "Hessian", entries).with_rows(labels()).with_columns(labels())
}

/// The error over the iterations, with the section that each belongs to; nothing before the first.
pub(crate) fn errors(all: impl Iterator<Item = (String, f64)>) -> Option<Series> {
    let (mut sections, mut points): (Vec<Section>, _) = (Vec::new(), Vec::new());
    for (i, (label, rms)) in all.enumerate() {
        let x = (i + 1) as f32;
        points.push([x, rms as f32]);
        if sections.last().is_none_or(|section| section.label != label) {
            sections.push(Section { from: x, label, is_part: false });
        }
    }
    (!points.is_empty()).then(|| Series {
        sections,
        ..Series::new(
            "Alignment error",
            ["iteration", "RMS difference (gray levels)"],
            points.len(),
            vec![("RMS difference", Role::Error, points)],
        )
    })
}
