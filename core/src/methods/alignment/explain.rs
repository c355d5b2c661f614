//! What alignments explain alike: pictures, matrices and the plot of the error.

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

/// The steepest-descent images.
pub(crate) fn steepest_descent(aligner: &Aligner<'_>) -> Vec<Tile> {
    let coordinates = aligner.coordinates();
    let image = |k: usize| {
        let values = sampled(aligner.template.size(), |x, y| aligner.columns(&coordinates, (x, y))[k] as f32);
        let most = values.cells().iter().fold(1e-3f32, |most, value| most.max(value.abs()));
        Tile { label: IMAGES[k], role: None, values, range: [-most, most], framed: Vec::new() }
    };
    (0..aligner.model.freedom()).map(image).collect()
}

/// A template, called `label`, the warped picture, and their difference.
pub(crate) fn compared(label: &'static str, [template, image]: [&Grid<f32>; 2], warp: &Matrix3) -> Vec<Tile> {
    let warped = |x, y| warped(image, warp, (x, y)).unwrap_or(f32::NAN);
    let size = template.size();
    let tile = |label, values, range| Tile { label, role: None, values, range, framed: Vec::new() };
    vec![
        tile(label, sampled(size, |x, y| template[(x, y)]), [0.0, 255.0]),
        tile("warped", sampled(size, warped), [0.0, 255.0]),
        tile("difference", sampled(size, |x, y| warped(x, y) - template[(x, y)]), [-64.0, 64.0]),
    ]
}

/// A warp as a matrix with its symbol, name and role.
pub(crate) fn warp_matrix((symbol, name, role): (&'static str, &'static str, Role), matrix: &Matrix3) -> Matrix {
    Matrix {
        symbol,
        name,
        role: Some(role),
        entries: Grid::from_fn(3, 3, |x, y| matrix[y][x]),
        rows: Vec::new(),
        columns: Vec::new(),
        changed: None,
        decimals: None,
    }
}

/// A number for each parameter as a column vector with its symbol, name and role.
pub(crate) fn parameters(
    model: Model,
    (symbol, name, role): (&'static str, &'static str, Role),
    values: &[f64],
) -> Matrix {
    Matrix {
        symbol,
        name,
        role: Some(role),
        entries: Grid::from_fn(1, values.len(), |_, y| values[y]),
        rows: names(model).iter().map(|name| (*name).to_owned()).collect(),
        columns: Vec::new(),
        changed: None,
        decimals: None,
    }
}

/// The Hessian of the parameters.
pub(crate) fn hessian(model: Model, values: &[f64]) -> Matrix {
    let count = model.freedom();
    let labels = || names(model).iter().map(|name| (*name).to_owned()).collect();
    Matrix {
        symbol: "H",
        name: "Hessian",
        role: None,
        entries: Grid::from_fn(count, count, |x, y| values[y * count + x]),
        rows: labels(),
        columns: labels(),
        changed: None,
        decimals: None,
    }
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
        title: "Alignment error",
        x_label: "iteration",
        y_label: "RMS difference (gray levels)",
        x_max: points.len(),
        sections,
        lines: vec![("RMS difference", Role::Error, points)],
        ..Series::default()
    })
}
