//! Names at what they name: where in a chart they cover nothing.

use super::super::primitive::{Anchor, Point, Primitive, Rect, Run};
use super::super::{Color, fonts};
use super::canvas::{Canvas, Level, Type};

/// Between a name and the edge of the chart, in points.
const MARGIN: f32 = 2.0;

/// The room that names have and take.
#[derive(Debug)]
pub(super) struct Labels {
    area: Rect,
    names: Vec<Rect>,
    marks: Vec<Rect>,
    lines: Vec<Vec<Point>>,
}

impl Labels {
    pub(super) fn new(area: Rect) -> Self {
        Self { area, names: Vec::new(), marks: Vec::new(), lines: Vec::new() }
    }

    /// Keeps names off a mark.
    pub(super) fn keep_off(&mut self, mark: Rect) {
        self.marks.push(mark);
    }

    /// Keeps names off a line.
    pub(super) fn keep_off_line(&mut self, points: Vec<Point>) {
        self.lines.push(points);
    }

    /// Takes the first of the places at which a name of `size`, moved into the area, covers nothing; returns its centre.
    pub(super) fn place(&mut self, size: [f32; 2], centers: &[Point]) -> Option<Point> {
        self.take(size, centers, |labels, rect| {
            let is_on_line = |points: &Vec<Point>| points.windows(2).any(|ends| crosses([ends[0], ends[1]], rect));
            labels.is_off_names(rect)
                && !labels.marks.iter().any(|mark| mark.meets(rect))
                && !labels.lines.iter().any(is_on_line)
        })
    }

    /// As [`place`](Self::place), but over marks or far away where nothing else is free.
    pub(super) fn place_anyway(&mut self, size: [f32; 2], centers: &[Point]) -> Option<Point> {
        let near = self.place(size, centers).or_else(|| self.take(size, centers, Self::is_off_names));
        near.or_else(|| self.take(size, &self.everywhere(size, *centers.first()?), Self::is_off_names))
    }

    /// Places all over the area, those next to `wanted` first.
    fn everywhere(&self, size: [f32; 2], wanted: Point) -> Vec<Point> {
        let Rect { min, max } = self.area;
        let along = |i: usize| {
            let count = ((max[i] - min[i]) / (0.5 * size[i]).max(1.0)) as usize;
            (0..=count).map(move |k| min[i] + 0.5 * size[i].max(2.0) * k as f32)
        };
        let mut all: Vec<Point> = along(1).flat_map(|y| along(0).map(move |x| [x, y])).collect();
        let distance = |at: &Point| (at[0] - wanted[0]).hypot(at[1] - wanted[1]);
        all.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        all
    }

    fn is_off_names(&self, rect: &Rect) -> bool {
        !self.names.iter().any(|name| name.meets(rect))
    }

    fn take(&mut self, size: [f32; 2], centers: &[Point], is_free: impl Fn(&Self, &Rect) -> bool) -> Option<Point> {
        let Rect { min, max } = self.area.grown(-MARGIN);
        if (0..2).any(|i| size[i] > max[i] - min[i]) {
            return None;
        }
        let inside = |at: &Point| [0, 1].map(|i| at[i].max(min[i] + size[i] / 2.0).min(max[i] - size[i] / 2.0));
        let found = centers.iter().map(inside).find(|at| is_free(self, &Rect::centered(*at, size)))?;
        self.names.push(Rect::centered(found, size));
        Some(found)
    }
}

/// Places for a name of `size` around a mark that reaches `reach` from its centre, the nearest first.
pub(super) fn around(at: Point, reach: f32, size: [f32; 2]) -> Vec<Point> {
    let [across, down] = size.map(|side| reach + side / 2.0);
    let sides = [[1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];
    let corners = [[1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [-1.0, 1.0]];
    let near = sides.into_iter().chain(corners).map(|[x, y]| [at[0] + x * across, at[1] + y * down]);
    let far = [1.6, 2.8].into_iter().flat_map(|rows| {
        let (by, half) = (rows * size[1], size[0] / 2.0);
        [[0.0, -by], [0.0, by], [half, -by], [half, by], [-half, -by], [-half, by]]
    });
    near.chain(far.map(|[x, y]| [at[0] + x, at[1] + y + reach * y.signum()])).collect()
}

/// Size of runs of words in one line.
pub(super) fn size(runs: &[Run], size: f32) -> [f32; 2] {
    [runs.iter().map(|run| fonts::width(&run.text, run.face, size)).sum(), 1.2 * size]
}

/// Writes `runs` around `center` over a rim of the `panel`, which keeps them apart from what they lie on.
pub(super) fn write(canvas: &mut Canvas, center: Point, runs: Vec<Run>, (style, panel): (Type, Color)) {
    let mut line = style.line(center, (Anchor::Middle, Level::Middle), "");
    (line.runs, line.halo) = (runs, Some(panel));
    canvas.add(Primitive::Text(line));
}

/// Whether a line between two points passes through `rect`.
fn crosses([from, to]: [Point; 2], rect: &Rect) -> bool {
    let (mut enters, mut leaves) = (0.0f32, 1.0f32);
    for i in 0..2 {
        let (way, [low, high]) = (to[i] - from[i], [rect.min[i] - from[i], rect.max[i] - from[i]]);
        if way.abs() < 1e-6 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let [a, b] = [low / way, high / way];
        (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
    }
    enters <= leaves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_crosses_a_rectangle_that_it_passes_through() {
        let rect = Rect::new([10.0, 10.0], [20.0, 10.0]);
        let crossed = [[[0.0, 15.0], [40.0, 15.0]], [[15.0, 12.0], [16.0, 13.0]], [[5.0, 25.0], [35.0, 5.0]]];
        assert!(crossed.into_iter().all(|ends| crosses(ends, &rect)));
        let missed = [[[0.0, 9.0], [40.0, 9.0]], [[0.0, 0.0], [9.0, 9.0]], [[5.0, 22.0], [12.0, 40.0]]];
        assert!(!missed.into_iter().any(|ends| crosses(ends, &rect)));
    }

    #[test]
    fn names_keep_off_lines_marks_and_each_other_while_there_is_room() {
        let mut labels = Labels::new(Rect::new([0.0; 2], [200.0, 100.0]));
        labels.keep_off_line(vec![[0.0, 50.0], [200.0, 50.0]]);
        labels.keep_off(Rect::new([90.0, 20.0], [40.0, 20.0]));
        let size = [40.0, 12.0];
        let places = around([100.0, 50.0], 5.0, size);
        let found: Vec<_> = (0..3).filter_map(|_| labels.place(size, &places)).collect();
        assert!(found.len() == 3 && labels.names.len() == 3, "{found:?}");
        for (i, name) in labels.names.iter().enumerate() {
            assert!(!crosses([[0.0, 50.0], [200.0, 50.0]], name) && !labels.marks[0].meets(name));
            assert!(labels.names[..i].iter().all(|other| !other.meets(name)));
        }
        assert_eq!(labels.place([300.0, 12.0], &places), None, "wider than the chart");
        let on_line = [[100.0, 50.0]];
        assert_eq!(labels.place([30.0, 9.0], &on_line), None);
        assert!(labels.place_anyway([30.0, 9.0], &on_line).is_some());
        let taken = labels.names.len();
        let far = (0..8).filter_map(|_| labels.place_anyway([30.0, 9.0], &on_line)).count();
        assert_eq!((far, labels.names.len()), (8, taken + 8), "a name is never lost while there is room anywhere");
        for (i, name) in labels.names.iter().enumerate() {
            assert!(labels.names[..i].iter().all(|other| !other.meets(name)));
        }
    }
}
