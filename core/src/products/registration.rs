//! Frames resampled by a transformation of the plane.

use super::model::{Matrix3, mapped};
use crate::data::Frame;
use crate::geometry::{Gray, Grid};

/// A rectangle of whole pixels in which a frame is resampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Coordinates of its first pixel.
    pub origin: [i32; 2],
    /// Width and height in px.
    pub size: (usize, usize),
}

impl Window {
    /// The window of a picture in its own coordinates.
    pub fn of(size: (usize, usize)) -> Self {
        Self { origin: [0; 2], size }
    }

    /// The position of the pixel in column `x` and row `y`.
    pub fn at(&self, x: usize, y: usize) -> [f64; 2] {
        [f64::from(self.origin[0]) + x as f64, f64::from(self.origin[1]) + y as f64]
    }
}

/// The position in a picture of this size to which `back` maps a position; `None` outside the picture.
pub fn inside(back: &Matrix3, at: [f64; 2], (width, height): (usize, usize)) -> Option<[f64; 2]> {
    /// Rounding can put the border itself outside.
    const SLACK: f64 = 1e-6;
    let limits = [width, height].map(|extent| (extent as f64 - 1.0).max(0.0));
    let to = mapped(back, at)?;
    let is_inside = (0..2).all(|i| (-SLACK..=limits[i] + SLACK).contains(&to[i]));
    is_inside.then(|| [0, 1].map(|i| to[i].clamp(0.0, limits[i])))
}

/// The frame in the coordinates of a window, by bilinear interpolation: a pixel of it shows the place to which `back` maps it, and is black
/// outside the frame.
pub fn registered(frame: &Frame, back: &Matrix3, window: &Window) -> Frame {
    let (width, height) = window.size;
    let place = |x, y| inside(back, window.at(x, y), frame.size());
    match frame.color() {
        Some(color) => Frame::rgb(Grid::from_fn(width, height, |x, y| {
            place(x, y).map_or([0; 3], |at| color_at(color, at).map(|value| (value + 0.5) as u8))
        })),
        None => Frame::gray(Grid::from_fn(width, height, |x, y| {
            place(x, y).map_or(0, |at| (gray_at(frame.luma(), at) + 0.5) as u8)
        })),
    }
}

/// The gray level at a position inside a picture.
pub fn gray_at(picture: &Gray, at: [f64; 2]) -> f32 {
    let [value] = bilinear(picture, at, |value| [f32::from(value)]);
    value
}

/// The colour at a position inside a picture.
pub fn color_at(picture: &Grid<[u8; 3]>, at: [f64; 2]) -> [f32; 3] {
    bilinear(picture, at, |value| value.map(f32::from))
}

fn bilinear<T: Copy, const N: usize>(picture: &Grid<T>, at: [f64; 2], of: impl Fn(T) -> [f32; N]) -> [f32; N] {
    let (width, height) = picture.size();
    let [x0, y0] = at.map(|c| c as usize);
    let (x1, y1) = ((x0 + 1).min(width - 1), (y0 + 1).min(height - 1));
    let [fx, fy] = [(at[0] - x0 as f64) as f32, (at[1] - y0 as f64) as f32];
    let [a, b, c, d] = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|place| of(picture[place]));
    std::array::from_fn(|i| {
        let (top, bottom) = (a[i] + fx * (b[i] - a[i]), c[i] + fx * (d[i] - c[i]));
        top + fy * (bottom - top)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::products::model::IDENTITY;

    #[test]
    fn the_identity_keeps_every_pixel() {
        let frame = Frame::gray(Grid::from_fn(7, 5, |x, y| (30 * x + y) as u8));
        assert_eq!(registered(&frame, &IDENTITY, &Window::of((7, 5))), frame);
        let color = Frame::rgb(Grid::from_fn(4, 3, |x, y| [x as u8, y as u8, 9]));
        assert_eq!(registered(&color, &IDENTITY, &Window::of((4, 3))), color);
    }

    #[test]
    fn half_a_pixel_is_interpolated_and_the_outside_is_black() {
        let frame = Frame::gray(Grid::from_fn(4, 2, |x, _| 20 * x as u8 + 10));
        let back = [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let window = Window { origin: [-1, 0], size: (5, 2) };
        assert_eq!(registered(&frame, &back, &window).luma().row(0), [0, 20, 40, 60, 0]);
    }
}
