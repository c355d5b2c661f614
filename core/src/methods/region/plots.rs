//! Plots of trackers of a region: histograms, curves, and marks that several of them draw.

use super::color::Histogram;
use super::vocabulary::value;
use crate::products::Region;
use crate::scene::{Picture, Role, Scene, Series, Shape, Step};

/// Maximum number of bars of a histogram: more cannot be distinguished.
pub(crate) const BARS: usize = 32;

/// A histogram as the outline of its bars, the first of which is around x = 1.
pub(crate) fn bars(heights: impl IntoIterator<Item = f32>) -> Vec<[f32; 2]> {
    let sides = |(i, height): (usize, f32)| [[i as f32 + 0.5, height], [i as f32 + 1.5, height]];
    heights.into_iter().enumerate().flat_map(sides).collect()
}

/// Histograms over each other, by the outlines of their bars.
pub(crate) fn histograms(
    title: &'static str,
    [x_label, y_label]: [&'static str; 2],
    lines: Vec<(&'static str, Role, Vec<[f32; 2]>)>,
) -> Series {
    let x_max = lines.iter().map(|(.., points)| points.len() / 2).max().unwrap_or(0);
    Series { is_sweep: true, ..Series::new(title, [x_label, y_label], x_max, lines) }
}

/// A curve over values instead of steps.
pub(crate) fn curve(
    title: &'static str,
    [x_label, y_label]: [&'static str; 2],
    (name, points): (&'static str, Vec<[f32; 2]>),
) -> Series {
    let x_max = points.iter().map(|point| point[0].ceil() as usize).max().unwrap_or(0);
    let lines = vec![(name, Role::Estimate, points)];
    Series { is_sweep: true, ..Series::new(title, [x_label, y_label], x_max, lines) }
}

/// Marks an upright ellipse.
pub(crate) fn ellipse(scene: &mut Scene, (role, meaning): (Role, &'static str), region: Region) {
    let radii = region.size.map(|side| side / 2.0);
    let shape = Shape::Ellipse { center: region.center, radii, angle_rad: region.angle_rad };
    scene.draw(Picture::CURRENT, (role, meaning), shape);
}

/// Puts the colour space and the number of bins of a histogram.
pub(crate) fn put_bins(step: Step, of: &Histogram) -> Step {
    let step = step.put(value::BINNING, of.binning.name()).put(value::FILLED, of.support.len());
    step.put(value::BINS, of.binning.count())
}
