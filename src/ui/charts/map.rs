//! A part of the plane of displacements on the screen, with its axes.

use eframe::egui::{self, Align2, Painter, Pos2, Rect, Stroke, pos2, vec2};

use crate::paint::{Face, Theme, number};
use crate::ui::charts::axis::Axis;
use crate::ui::drawing::ink;

/// Where the map lies, and where its displacements are.
pub struct Map {
    /// Where it lies.
    pub rect: Rect,
    /// Side of the cell of a displacement, in points.
    pub cell: f32,
    /// Size of the type around it.
    pub small: f32,
    origin: [i32; 2],
    size: (usize, usize),
}

impl Map {
    /// A map in `area` of so many displacements from `origin` on, `right` letters free beside it.
    pub fn new((origin, size): ([i32; 2], (usize, usize)), area: Rect, right: f32, theme: Theme) -> Self {
        let small = theme.sizes().small;
        let (columns, rows) = size;
        // Room for the header and the numbers at the axes.
        let min = area.min + vec2(3.8 * small, 2.2 * small);
        let max = area.max - vec2(right * small, 3.2 * small);
        let room = (max - min).max(vec2(8.0, 8.0));
        let cell = (room.x / columns.max(1) as f32).min(room.y / rows.max(1) as f32);
        let rect = Rect::from_min_size(min, vec2(columns as f32, rows as f32) * cell);
        Self { rect, cell, small, origin, size }
    }

    /// The displacement at a place of the screen.
    pub fn displacement(&self, at: Pos2) -> Option<[i32; 2]> {
        let place = (at - self.rect.min) / self.cell;
        let inside = place.x >= 0.0 && place.y >= 0.0 && self.rect.contains(at);
        let (x, y) = (place.x as usize, place.y as usize);
        (inside && x < self.size.0 && y < self.size.1).then(|| [self.origin[0] + x as i32, self.origin[1] + y as i32])
    }

    /// The cell of a displacement.
    pub fn cell_rect(&self, [u, v]: [i32; 2]) -> Rect {
        let place = vec2((u - self.origin[0]) as f32, (v - self.origin[1]) as f32) * self.cell;
        Rect::from_min_size(self.rect.min + place, vec2(self.cell, self.cell))
    }

    /// The axis of displacements along x or y; ticks stand at the middle of cells.
    pub fn axis(&self, which: usize) -> Axis {
        let count = if which == 0 { self.size.0 } else { self.size.1 };
        let (from, to) =
            if which == 0 { (self.rect.min.x, self.rect.max.x) } else { (self.rect.min.y, self.rect.max.y) };
        let first = self.origin[which] as f32;
        let half = self.cell / 2.0;
        Axis { values: [first, first + count.saturating_sub(1) as f32], places: [from + half, to - half] }
    }

    /// Draws the frame, and numbers along two sides.
    pub fn axes(&self, painter: &Painter, theme: Theme) {
        let chrome = theme.chrome();
        let (dim, small) = (ink::color(chrome.dim), self.small);
        let font = ink::font(Face::Sans, small);
        let stroke = Stroke::new(1.0, dim);
        let (bottom, left) = (self.rect.max.y, self.rect.min.x);
        painter.rect_stroke(self.rect, 0.0, Stroke::new(1.0, ink::color(chrome.line)), egui::StrokeKind::Outside);
        for (which, spacing) in [(0, 2.8 * small), (1, 1.8 * small)] {
            let axis = self.axis(which);
            for tick in axis.displacement_ticks(spacing) {
                let (at, text) = (axis.place(tick), number(tick));
                if which == 0 {
                    painter.vline(at, bottom..=bottom + 4.0, stroke);
                    painter.text(pos2(at, bottom + 6.0), Align2::CENTER_TOP, text, font.clone(), dim);
                } else {
                    painter.hline(left - 4.0..=left, at, stroke);
                    painter.text(pos2(left - 7.0, at), Align2::RIGHT_CENTER, text, font.clone(), dim);
                }
            }
        }
        let text = ink::color(chrome.text);
        let name = ink::font(Face::Italic, small);
        painter.text(pos2(self.rect.max.x + 0.8 * small, bottom + 6.0), Align2::LEFT_TOP, "u, px", name.clone(), text);
        let above = pos2(left - 7.0, self.rect.min.y - 0.4 * small);
        painter.text(above, Align2::RIGHT_BOTTOM, "v, px", name, text);
    }
}
