//! The plot of a sweep: one quantity of every estimator over the swept values, in the window and as a file.

use std::borrow::Borrow;

use motionscope_core::base::Error;
use motionscope_core::scene::{Role, Series};

use super::rendering::Format;
use crate::experiment::comparison::{Column, Row};
use crate::paint::charts::ChartStyle;
use crate::paint::charts::series::{Plotted, draw};
use crate::paint::primitive::Rect;
use crate::paint::{ColorMap, Figure, SvgText, Theme, export_pdf, export_png, export_svg};

/// The roles of the lines, one per estimator.
const ROLES: [Role; 4] = [Role::Reference, Role::Result, Role::Predicted, Role::Candidate];
/// The size of a plot in a file, in points.
const SIZE: [f32; 2] = [720.0, 360.0];
/// Empty border around it, in points.
const MARGIN: f32 = 12.0;
/// The ratio of largest to smallest value from which the y axis is logarithmic.
const WIDE: f32 = 30.0;

/// Returns `column` over the swept values, one line per estimator; `axis` names the swept parameter.
pub fn series<R: Borrow<Row>>(rows: &[R], column: &Column, axis: &'static str) -> Series {
    let mut lines: Vec<(&'static str, Role, Vec<[f32; 2]>)> = Vec::new();
    for row in rows.iter().map(Borrow::borrow) {
        let row: &Row = row;
        let name = row.estimator.info().name;
        let x = row.swept.as_ref().and_then(|(_, value)| value.parse::<f32>().ok());
        let (Some(x), Some(y)) = (x, column.value(row)) else { continue };
        match lines.iter_mut().find(|(known, ..)| *known == name) {
            Some((.., points)) => points.push([x, y as f32]),
            None => lines.push((name, ROLES[lines.len() % ROLES.len()], vec![[x, y as f32]])),
        }
    }
    let mut values: Vec<f32> = lines.iter().flat_map(|(.., points)| points).map(|point| point[0]).collect();
    values.sort_by(f32::total_cmp);
    values.dedup();
    Series {
        title: column.heading,
        x_label: axis,
        y_label: "over the swept parameter",
        x_max: values.last().copied().unwrap_or(1.0).max(1.0).ceil() as usize,
        lines,
        is_sweep: true,
        has_logarithmic_x: is_geometric(&values),
        ..Series::default()
    }
}

/// Whether each of the sorted `values` is a multiple of the one before, over a wide range.
fn is_geometric(values: &[f32]) -> bool {
    let [first, .., last] = values else { return false };
    *first > 0.0 && *last >= 8.0 * *first && values.windows(2).all(|pair| pair[1] >= 1.5 * pair[0])
}

/// Whether the values of `series` are so different that their axis is logarithmic.
pub fn is_wide(series: &Series) -> bool {
    let values = series.lines.iter().flat_map(|(.., points)| points).map(|point| point[1]);
    let (low, high) = (values.clone().fold(f32::INFINITY, f32::min), values.fold(0.0, f32::max));
    low > 0.0 && high > WIDE * low
}

/// Encodes the plot of `series`; a PNG has `scale` pixels per point.
///
/// # Errors
/// If nothing can be plotted, or the picture cannot be encoded.
pub fn encode(series: &Series, theme: Theme, format: Format, scale: u32) -> Result<Vec<u8>, Error> {
    if series.lines.is_empty() {
        return Err(Error::new("no estimator has this figure at any of the swept values; plot another column"));
    }
    let figure = figure(series, theme, scale);
    match format {
        Format::Png => export_png(&figure, scale),
        Format::Svg => export_svg(&figure, SvgText::Outlines).map(String::into_bytes),
        Format::Pdf => export_pdf(&figure),
    }
}

fn figure(series: &Series, theme: Theme, scale: u32) -> Figure {
    let area = Rect::new([MARGIN; 2], SIZE.map(|side| side - 2.0 * MARGIN));
    let style = ChartStyle { theme, colors: ColorMap::default(), density: scale as f32 };
    let plotted = Plotted { series, whose: "", logarithmic: is_wide(series), window: None };
    let names: Vec<_> = series.lines.iter().map(|(name, ..)| *name).collect();
    Figure {
        size: SIZE,
        background: theme.chrome().panel,
        layers: draw(plotted, area, style).into_layers(),
        panels: Vec::new(),
        description: format!("{} over {}: {}", series.title, series.x_label.to_lowercase(), names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_double_have_a_logarithmic_axis() {
        assert!(is_geometric(&[4.0, 8.0, 16.0, 32.0]) && is_geometric(&[1.0, 3.0, 5.0, 10.0, 20.0]));
        for values in [&[1.0, 2.0, 3.0, 4.0][..], &[0.0, 10.0, 100.0], &[5.0], &[]] {
            assert!(!is_geometric(values), "{values:?}");
        }
    }
}
