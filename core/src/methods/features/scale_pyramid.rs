//! Pyramids whose levels differ by any factor, for keypoints of several sizes.

use crate::base::effort;
use crate::geometry::{Gray, Grid};

/// Weights of a whole pixel in the resampling.
const ONE: u32 = 128;

/// One level of such a pyramid.
#[derive(Clone, Debug)]
pub struct ScaleLevel {
    /// The picture at this level.
    pub picture: Gray,
    /// The side of its pixels in px of the frame.
    pub scale: f32,
    /// The size of the frame.
    frame: (usize, usize),
}

impl ScaleLevel {
    /// The frame itself.
    pub fn first(picture: Gray) -> Self {
        let frame = picture.size();
        Self { picture, scale: 1.0, frame }
    }

    /// The size of the level after this one, `factor` times smaller.
    pub fn next_size(&self, factor: f32) -> (usize, usize) {
        size_at(self.frame, self.scale * factor)
    }

    /// The level after this one, `factor` times smaller.
    pub fn next(&self, factor: f32) -> Self {
        let picture = shrunk(&self.picture, self.next_size(factor));
        Self { picture, scale: self.scale * factor, frame: self.frame }
    }

    /// A place of this level in the frame: both cover the same area.
    pub fn in_frame(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let (width, height) = self.picture.size();
        let place = |c: f32, of: usize, count: usize| (c + 0.5) * (of as f32 / count as f32) - 0.5;
        [place(x, self.frame.0, width), place(y, self.frame.1, height)]
    }
}

/// The number of levels, `most` at most, of a frame of this size whose sides have at least `least` px.
pub fn level_count(frame: (usize, usize), factor: f32, (least, most): (usize, usize)) -> usize {
    let fits = |level: &usize| {
        let (width, height) = size_at(frame, factor.powi(*level as i32));
        width.min(height) >= least
    };
    (1..most).take_while(fits).count() + 1
}

fn size_at((width, height): (usize, usize), scale: f32) -> (usize, usize) {
    let side = |side: usize| ((side as f32 / scale).round() as usize).max(1);
    (side(width), side(height))
}

/// Where the pixels of a resampled row or column lie: the one before, and the weight of the one after.
fn places(count: usize, of: usize) -> Vec<(usize, u32)> {
    let place = |i: usize| {
        let at = ((i as f32 + 0.5) * (of as f32 / count as f32) - 0.5).clamp(0.0, (of - 1) as f32);
        let before = (at as usize).min(of.saturating_sub(2));
        (before, ((at - before as f32) * ONE as f32).round() as u32)
    };
    (0..count).map(place).collect()
}

/// `picture` resampled bilinearly to a smaller size.
fn shrunk(picture: &Gray, (width, height): (usize, usize)) -> Gray {
    effort::add(width * height);
    let columns = places(width, picture.width());
    let mut row = vec![0u16; picture.width() + 1];
    let mut small = Grid::new(width, height, 0);
    for (y, (before, weight)) in places(height, picture.height()).into_iter().enumerate() {
        let after = (before + 1).min(picture.height() - 1);
        let [above, below] = [ONE - weight, weight].map(|weight| weight as u16);
        for ((mixed, a), b) in row.iter_mut().zip(picture.row(before)).zip(picture.row(after)) {
            *mixed = above * u16::from(*a) + below * u16::from(*b);
        }
        for (pixel, (before, weight)) in small.row_mut(y).iter_mut().zip(&columns) {
            let [a, b] = [row[*before], row[before + 1]].map(u32::from);
            *pixel = (((ONE - weight) * a + weight * b + ONE * ONE / 2) / (ONE * ONE)) as u8;
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_stays_a_slope_and_places_agree_with_the_frame() {
        let first = ScaleLevel::first(Grid::from_fn(60, 40, |x, y| (2 * x + 3 * y) as u8));
        let second = first.next(1.2).next(1.2);
        assert_eq!(second.picture.size(), (42, 28));
        for (x, y) in (1..27).flat_map(|y| (1..41).map(move |x| (x, y))) {
            let [u, v] = second.in_frame([x as f32, y as f32]);
            let level = f32::from(second.picture[(x, y)]);
            assert!((2.0 * u + 3.0 * v - level).abs() < 1.6, "{level} at ({x}, {y}), which is ({u}, {v})");
        }
    }

    #[test]
    fn levels_end_where_they_become_too_small() {
        assert_eq!(level_count((640, 480), 1.2, (31, 8)), 8);
        assert_eq!(level_count((60, 40), 1.2, (31, 8)), 2);
        assert_eq!(level_count((5, 5), 2.0, (31, 8)), 1);
        assert_eq!(ScaleLevel::first(Grid::new(1, 1, 7)).next(2.0).picture.cells(), [7]);
    }
}
