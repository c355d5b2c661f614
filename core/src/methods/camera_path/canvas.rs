//! A canvas on which registered frames are blended.

use crate::choices;
use crate::data::Frame;
use crate::geometry::Grid;
use crate::products::model::{Matrix3, inverse, mapped};
use crate::products::registration::{Window, color_at, gray_at, inside};

choices! {
    /// Blending of frames that overlap.
    pub enum Blending {
        /// The mean, with weights that fall linearly from the middle of each frame to 0 at its border (feathering). Seams vanish; moving
        /// objects leave faint ghosts.
        Mean = "mean" "Feathered mean",
        /// The newest frame covers the others: sharp, with seams, and each moving object once or more.
        Newest = "newest" "Newest frame",
    }
}

/// The canvas is at most this many times as large as a frame.
pub const MOST_FRAMES: f64 = 8.0;

/// Weighted sums of the colours of frames.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// The pixels that it covers, in the coordinates of the reference frame.
    pub window: Window,
    /// Number of frames that lie completely on it, of all frames it was made for.
    pub complete: usize,
    /// Sums of weighted red, green and blue, and of the weights.
    sums: Grid<[f32; 4]>,
}

/// The corners of a picture of this size where `map` maps them; `None` beyond the horizon.
pub fn outline(map: &Matrix3, (width, height): (usize, usize)) -> Option<[[f64; 2]; 4]> {
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let mut corners = [[0.0; 2]; 4];
    for (corner, at) in corners.iter_mut().zip([[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]]) {
        *corner = mapped(map, at).filter(|to| to.iter().all(|c| c.abs() < 1e6))?;
    }
    Some(corners)
}

impl Canvas {
    /// A canvas for frames of one size with their maps to its coordinates, where they have one. It grows by one frame after the other in their order of distance
    /// from the frame `reference`, as long as it is not too large; frames beyond it are cut.
    pub fn of(maps: &[Option<Matrix3>], reference: usize, size: (usize, usize)) -> Self {
        let most = MOST_FRAMES * (size.0 * size.1) as f64;
        let mut order: Vec<usize> = (0..maps.len()).collect();
        order.sort_by_key(|i| i.abs_diff(reference));
        let mut ends = [0.0, 0.0, (size.0 - 1) as f64, (size.1 - 1) as f64];
        let mut complete = 0;
        for corners in order.into_iter().filter_map(|i| outline(maps[i].as_ref()?, size)) {
            let grown = corners.iter().fold(ends, |[a, b, c, d], [x, y]| {
                [a.min(x.floor()), b.min(y.floor()), c.max(x.ceil()), d.max(y.ceil())]
            });
            if (grown[2] - grown[0] + 1.0) * (grown[3] - grown[1] + 1.0) > most {
                continue;
            }
            (ends, complete) = (grown, complete + 1);
        }
        let [left, top, right, bottom] = ends.map(|end| end as i32);
        let size = ((right - left + 1) as usize, (bottom - top + 1) as usize);
        let window = Window { origin: [left, top], size };
        Self { window, complete, sums: Grid::new(size.0, size.1, [0.0; 4]) }
    }

    /// Blends a frame into it; `map` maps the frame to the canvas's coordinates.
    pub fn add(&mut self, frame: &Frame, map: &Matrix3, blending: Blending) {
        let (Some(back), Some(corners)) = (inverse(map), outline(map, frame.size())) else { return };
        let (width, height) = frame.size();
        let range = |i: usize, length: usize| {
            let origin = f64::from(self.window.origin[i]);
            let low = corners.iter().map(|corner| corner[i]).fold(f64::INFINITY, f64::min) - origin;
            let high = corners.iter().map(|corner| corner[i]).fold(f64::NEG_INFINITY, f64::max) - origin;
            (low.floor().max(0.0) as usize)..((high.ceil() + 1.0).clamp(0.0, length as f64) as usize)
        };
        let (columns, rows) = (range(0, self.window.size.0), range(1, self.window.size.1));
        // From 1 in the middle to nearly 0 at the border.
        let hat = |c: f64, length: usize| {
            let from_border = (c + 1.0).min(length as f64 - c) as f32;
            from_border / (length as f32 / 2.0)
        };
        for y in rows {
            for x in columns.clone() {
                let Some(at) = inside(&back, self.window.at(x, y), (width, height)) else { continue };
                let [r, g, b] = match frame.color() {
                    Some(color) => color_at(color, at),
                    None => [gray_at(frame.luma(), at); 3],
                };
                let sums = &mut self.sums[(x, y)];
                match blending {
                    Blending::Newest => *sums = [r, g, b, 1.0],
                    Blending::Mean => {
                        let weight = hat(at[0], width) * hat(at[1], height);
                        for (sum, value) in sums.iter_mut().zip([r, g, b, 1.0]) {
                            *sum += weight * value;
                        }
                    }
                }
            }
        }
    }

    /// The picture so far; black where there is no frame.
    pub fn picture(&self) -> Frame {
        Frame::rgb(self.sums.map(|[r, g, b, weight]| match *weight > 0.0 {
            true => [r, g, b].map(|sum| (sum / weight + 0.5) as u8),
            false => [0; 3],
        }))
    }

    /// The share of it that frames cover.
    pub fn covered(&self) -> f64 {
        let cells = self.sums.cells();
        cells.iter().filter(|cell| cell[3] > 0.0).count() as f64 / cells.len().max(1) as f64
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(self.sums.cells())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::products::model::IDENTITY;

    fn wall(x: i32) -> u8 {
        (20 * x.rem_euclid(12)) as u8
    }

    #[test]
    fn shifted_frames_continue_each_other() {
        let frame = |shift: i32| Frame::gray(Grid::from_fn(12, 6, |x, _| wall(x as i32 + shift)));
        let right = |by: f64| [[1.0, 0.0, by], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let maps = [IDENTITY, right(4.0), right(9.0)];
        for blending in [Blending::Mean, Blending::Newest] {
            let mut canvas = Canvas::of(&maps.map(Some), 1, (12, 6));
            assert_eq!((canvas.window.size, canvas.complete), ((21, 6), 3));
            for (map, shift) in maps.iter().zip([0, 4, 9]) {
                canvas.add(&frame(shift), map, blending);
            }
            let made = canvas.picture();
            assert!((0..21).all(|x| made.luma()[(x, 3)] == wall(x as i32)), "{:?}", made.luma().row(3));
            assert_eq!(canvas.covered(), 1.0);
        }
    }

    #[test]
    fn the_canvas_does_not_grow_without_limit() {
        let shift = |i: i32| [[1.0, 0.0, 9.0 * f64::from(i)], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let far: Vec<_> = (0..40).map(|i| Some(shift(i))).collect();
        let canvas = Canvas::of(&far, 0, (12, 6));
        assert!(canvas.window.size.0 <= 96 && canvas.complete < 40, "{:?}", canvas.window);
    }
}
