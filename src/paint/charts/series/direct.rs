//! Names at the lines that they name, where these are few and have room.

use motionscope_core::scene::Series;

use super::head::{Entry, line_name, threshold_name};
use super::{Plot, are_marks};
use crate::paint::Theme;
use crate::paint::charts::canvas::Canvas;
use crate::paint::charts::labels::{self, Labels};
use crate::paint::primitive::{Point, Rect, Run};

/// Most lines and thresholds that carry their names.
const MOST: usize = 4;
/// Letters of width and height that a plot has at least where they do.
const LEAST: [f32; 2] = [17.0, 14.0];
/// From the end of a line to its name, in points.
const REACH: f32 = 9.0;
/// Places along a line that are tried for its name.
const TRIED: usize = 12;

/// Whether the lines and thresholds of `series` carry their names in `area`.
pub(super) fn has_room(series: &Series, area: Rect, small: f32) -> bool {
    let lines = series.lines.iter().filter(|(_, role, points)| !are_marks(series, *role, points)).count();
    let is_large = (0..2).all(|i| area.size()[i] >= LEAST[i] * small);
    is_large && series.columns.is_none() && lines + series.thresholds.len() <= MOST
}

/// Writes the name and the value at hand of each line at its end, or elsewhere along it where that is clear, and of each threshold
/// above or below it.
pub(super) fn names(canvas: &mut Canvas, plot: &Plot, series: &Series, theme: Theme) {
    let mut room = Labels::new(plot.rect);
    let lines: Vec<_> = series.lines.iter().map(|line| (line, places(plot, &line.2))).collect();
    for ((_, role, points), places) in &lines {
        if are_marks(series, *role, points) {
            places.iter().for_each(|place| room.keep_off(Rect::centered(*place, [9.0; 2])));
        } else {
            room.keep_off_line(places.clone());
            places.last().iter().for_each(|end| room.keep_off(Rect::centered(**end, [10.0; 2])));
        }
    }
    let Rect { min: [left, _], max: [right, _] } = plot.rect;
    let thresholds: Vec<_> = shown_thresholds(plot, series).collect();
    for (_, y) in &thresholds {
        room.keep_off_line(vec![[left, *y], [right, *y]]);
    }
    let mut write = |entry: &Entry, centers: &dyn Fn([f32; 2]) -> Vec<Point>| {
        let runs = vec![Run::new(&entry.words, entry.style.color)];
        let size = labels::size(&runs, entry.style.size);
        if let Some(at) = room.place_anyway(size, &centers(size)) {
            labels::write(canvas, at, runs, (entry.style, theme.chrome().panel));
        }
    };
    for (line @ (_, role, points), places) in &lines {
        if !are_marks(series, *role, points) && !places.is_empty() {
            write(&line_name(series, line, series.now(), theme), &|size| along(places, size));
        }
    }
    for (threshold, y) in thresholds {
        let centers = |size: [f32; 2]| {
            let rows = [y - 0.5 * size[1] - 2.0, y + 0.5 * size[1] + 2.0];
            (0..=4).flat_map(|i| rows.map(|row| [right - 0.25 * i as f32 * (right - left), row])).collect()
        };
        write(&threshold_name(series, threshold, theme), &centers);
    }
}

/// The thresholds that are seen, each with its place.
fn shown_thresholds<'a>(plot: &Plot, series: &'a Series) -> impl Iterator<Item = (&'a (String, f32), f32)> {
    let shown = series.thresholds.iter().filter(|(_, value)| plot.beyond([0.0, *value]).is_none());
    shown.map(|threshold| (threshold, plot.at([0.0, threshold.1])[1]))
}

/// Where the points of a line stand that are seen.
fn places(plot: &Plot, points: &[[f32; 2]]) -> Vec<Point> {
    let seen = points.iter().filter(|point| point[1].is_finite() && plot.shows(point[0]));
    seen.filter(|point| plot.beyond(**point).is_none()).map(|point| plot.at(*point)).collect()
}

/// Places for a name of `size` at a line: around its end, then along it from there on, above and below.
fn along(places: &[Point], size: [f32; 2]) -> Vec<Point> {
    let last = places.len().saturating_sub(1);
    let ends = places.last().map(|end| labels::around(*end, REACH, size)).unwrap_or_default();
    let tried = (1..=TRIED).map(|i| places[last - last * i / TRIED]);
    let down = 0.5 * size[1] + 4.0;
    let beside = tried.flat_map(|[x, y]| [down, -down, 2.0 * down, -2.0 * down].map(|by| [x, y - by]));
    ends.into_iter().chain(beside).collect()
}
