//! The sections of a series as plots of their own, in rows and columns: the cells of a descriptor where they lie in the picture.

use motionscope_core::scene::{Section, Series};

use super::super::primitive::{Anchor, Rect, Stroke};
use super::super::{Color, Theme, labels};
use super::axis::Axis;
use super::canvas::{Canvas, Level, THRESHOLD, Type, solid};

/// Between two plots, in letters.
const GAP: f32 = 0.4;
/// Share of its place along x that a bar fills.
const FILLED: f32 = 0.7;
/// Letters of height from which on a plot has its number.
const NAMED: f32 = 2.4;

/// Draws the sections of `series` in `columns` columns inside `area`, with the values of `y` on the axis of each.
pub fn draw(canvas: &mut Canvas, (series, columns): (&Series, usize), (area, y): (Rect, &Axis), theme: Theme) {
    let dim = Type::dim(theme);
    let rows = series.sections.len().div_ceil(columns);
    let gap = GAP * dim.size;
    let size =
        [(0, columns), (1, rows)].map(|(i, count)| ((area.size()[i] + gap) / count.max(1) as f32 - gap).max(1.0));
    for (i, section) in series.sections.iter().enumerate() {
        let place = [i % columns, i / columns];
        let min = [0, 1].map(|axis| area.min[axis] + place[axis] as f32 * (size[axis] + gap));
        let cell = Cell {
            rect: Rect::new(min, size),
            from: section.from,
            to: series.sections.get(i + 1).map_or(series.x_max as f32 + 0.5, |next| next.from),
            y: Axis { places: [min[1] + size[1], min[1]], ..*y },
        };
        cell.draw(canvas, (series, section), theme);
        if place[0] == 0 {
            cell.scale(canvas, dim);
        }
    }
}

/// A plot of a section.
struct Cell {
    rect: Rect,
    /// The x of its ends.
    from: f32,
    to: f32,
    y: Axis,
}

impl Cell {
    fn draw(&self, canvas: &mut Canvas, (series, section): (&Series, &Section), theme: Theme) {
        let Self { rect, y, .. } = self;
        let (chrome, dim, ends) = (theme.chrome(), Type::dim(theme), [rect.min[0], rect.max[0]]);
        for (_, role, points) in &series.lines {
            self.bars(canvas, points, theme.word(*role));
        }
        canvas.frame(*rect, 1.0, chrome.line);
        canvas.across(ends, y.place(0.0), chrome.dim);
        for (_, value) in &series.thresholds {
            let [left, right] = ends.map(|x| [x, y.place(*value)]);
            let color = theme.word(motionscope_core::scene::Role::Rejected);
            canvas.line(vec![left, right], false, Stroke { dash: THRESHOLD, ..solid(1.5, color) });
        }
        if rect.size()[1] > NAMED * dim.size {
            let at = [rect.min[0] + 4.0, rect.min[1] + 2.0];
            let room = Rect::new([at[0] - 2.0, at[1]], [dim.width(&section.label) + 4.0, 1.1 * dim.size]);
            canvas.fill(room, chrome.panel.alpha(190));
            canvas.text(at, (Anchor::Start, Level::Top), &section.label, dim);
        }
    }

    /// Bars from 0 to the values of a line in this section.
    fn bars(&self, canvas: &mut Canvas, points: &[[f32; 2]], color: Color) {
        let Self { rect, from, to, y } = self;
        let step = rect.size()[0] / (to - from).max(1.0);
        let inside = points.iter().filter(|[x, value]| (*from..*to).contains(x) && value.is_finite() && *value != 0.0);
        for [x, value] in inside {
            let middle = rect.min[0] + (x - from) * step;
            let [a, b] = [0.0, *value].map(|value| y.place(value).clamp(rect.min[1], rect.max[1]));
            let half = (FILLED * step / 2.0).max(0.5);
            canvas.fill(Rect::between([middle - half, a.min(b)], [middle + half, a.max(b)]), color);
        }
    }

    /// The numbers at the axis of values: its upper end, and 0.
    fn scale(&self, canvas: &mut Canvas, dim: Type) {
        let values = [0.0, self.y.values[1]];
        // Of two that would lie over each other, the upper one.
        let fewest = usize::from(self.rect.size()[1] < 2.4 * dim.size);
        for (value, words) in values.into_iter().zip(labels(&values)).skip(fewest) {
            let half = (dim.size / 2.0).min(self.rect.size()[1] / 2.0);
            let at = self.y.place(value).clamp(self.rect.min[1] + half, self.rect.max[1] - half);
            canvas.text([self.rect.min[0] - 6.0, at], (Anchor::End, Level::Middle), &words, dim);
        }
    }
}
