//! The levels of a pyramid as pictures, shown beside or instead of the picture itself.

use std::fmt;
use std::sync::{Arc, OnceLock};

use super::Role;
use crate::data::Frame;
use crate::geometry::Grid;

/// Frames t and t + 1 on one level of a pyramid.
pub struct Level {
    /// The two frames.
    pub pair: [Arc<Frame>; 2],
    /// Its name, if it is called by anything but its number.
    pub name: Option<String>,
    placing: Placing,
    /// Made when it is first looked at: every step of a run shows the same one.
    enlarged: OnceLock<[Arc<Frame>; 2]>,
}

/// The position of a level's pixels in the picture.
#[derive(Clone, Copy)]
enum Placing {
    /// Pixel `(x, y)` of level n at `(2ⁿ x, 2ⁿ y)`.
    Multiples,
    /// All together over the same area, each as large as the others.
    Area,
}

impl Level {
    /// A level of these frames, of which pixel `(x, y)` stands for the place `(2ⁿ x, 2ⁿ y)` of the picture if it is level n.
    pub fn new(pair: [Arc<Frame>; 2]) -> Self {
        Self { pair, name: None, placing: Placing::Multiples, enlarged: OnceLock::new() }
    }

    /// A level of these frames, which cover the same area as the picture.
    pub fn covering(pair: [Arc<Frame>; 2]) -> Self {
        Self { placing: Placing::Area, ..Self::new(pair) }
    }

    /// The same with a name: `G₁`.
    #[must_use]
    pub fn named(self, name: String) -> Self {
        Self { name: Some(name), ..self }
    }

    /// Its frames enlarged `factor` times, each pixel to a square of them, and cut to the `size` of the picture.
    fn enlarged(&self, factor: usize, size: (usize, usize)) -> [Arc<Frame>; 2] {
        let enlarge = |frame: &Arc<Frame>| {
            Arc::new(Frame::gray(match self.placing {
                Placing::Multiples => enlarge(frame, factor, size),
                Placing::Area => stretch(frame, size),
            }))
        };
        self.enlarged.get_or_init(|| self.pair.each_ref().map(enlarge)).clone()
    }
}

fn enlarge(frame: &Frame, factor: usize, (width, height): (usize, usize)) -> Grid<u8> {
    let luma = frame.luma();
    // The middle of a pixel stays where the pyramid has it.
    let nearest = |c: usize, extent: usize| ((c + factor / 2) / factor).min(extent.saturating_sub(1));
    Grid::from_fn(width, height, |x, y| luma[(nearest(x, luma.width()), nearest(y, luma.height()))])
}

fn stretch(frame: &Frame, (width, height): (usize, usize)) -> Grid<u8> {
    let luma = frame.luma();
    // Twice, so that the middle of a pixel is a whole number.
    let nearest = |c: usize, of: usize, extent: usize| ((2 * c + 1) * of / (2 * extent)).min(of.saturating_sub(1));
    Grid::from_fn(width, height, |x, y| luma[(nearest(x, luma.width(), width), nearest(y, luma.height(), height))])
}

impl PartialEq for Level {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && (0..2).all(|i| Arc::ptr_eq(&self.pair[i], &other.pair[i]) || self.pair[i] == other.pair[i])
    }
}

impl fmt::Debug for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, height) = self.pair[0].size();
        write!(f, "Level({width}×{height})")
    }
}

/// A pyramid that a step works on, each level half as wide and high as the one below.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    /// Its levels, at least one; the picture itself is level 0.
    pub all: Arc<[Level]>,
    /// The level at work; 0 before anything was done.
    pub at_work: usize,
}

impl Levels {
    /// Frames t and t + 1 on a level, enlarged to the size of the picture, each pixel to a
    /// square, so that marks align. The coarsest if there is no such level.
    pub fn pair(&self, level: usize) -> [Arc<Frame>; 2] {
        let level = level.min(self.all.len() - 1);
        match level {
            0 => self.all[0].pair.clone(),
            _ => self.all[level].enlarged(1 << level, self.size(0)),
        }
    }

    /// Width and height of a level in its own px.
    pub fn size(&self, level: usize) -> (usize, usize) {
        self.all[level].pair[0].size()
    }
}

/// A pyramid as a stack of pictures, with the current block or window on each level.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// The pictures.
    pub levels: Levels,
    /// The contents of each level, from level 0 on.
    pub floors: Vec<Floor>,
}

/// The contents of one level, in its own px.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Floor {
    /// First and last edge of the current block or window.
    pub at_hand: Option<[[f32; 2]; 2]>,
    /// Its displacement, final or best so far according to the role.
    pub vector: Option<([f32; 2], Role)>,
}

impl Floor {
    /// The centre of the current block or window.
    pub fn middle(&self) -> Option<[f32; 2]> {
        self.at_hand.map(|[min, max]| [0, 1].map(|i| (min[i] + max[i]) / 2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_that_covers_the_picture_is_stretched_over_it() {
        let frame = Arc::new(Frame::gray(Grid::from_fn(4, 2, |x, y| (10 * y + x) as u8)));
        let [current, _] = Level::covering([frame.clone(), frame]).enlarged(2, (7, 5));
        for (x, y) in (0..5).flat_map(|y| (0..7).map(move |x| (x, y))) {
            let on_level = |c: usize, of: f32, extent: f32| ((c as f32 + 0.5) * of / extent).floor() as u8;
            assert_eq!(current.luma()[(x, y)], 10 * on_level(y, 2.0, 5.0) + on_level(x, 4.0, 7.0), "{x}, {y}");
        }
    }

    #[test]
    fn a_level_is_enlarged_to_the_picture_once() {
        let frame = |first: u8| Arc::new(Frame::gray(Grid::from_fn(3, 2, |x, y| first + (10 * y + x) as u8)));
        let level = Level::new([frame(0), frame(100)]);
        let [current, next] = level.enlarged(4, (11, 7));
        assert_eq!((current.size(), next.luma()[(0, 0)]), ((11, 7), 100));
        for (x, y) in (0..7).flat_map(|y| (0..11).map(move |x| (x, y))) {
            // The nearest pixel of the level, ties to the right; the middle of each is kept.
            let nearest = |c: usize, last: usize| ((c as f32 / 4.0 + 0.5).floor() as usize).min(last);
            assert_eq!(current.luma()[(x, y)] as usize, 10 * nearest(y, 1) + nearest(x, 2));
        }
        assert!(Arc::ptr_eq(&current, &level.enlarged(4, (11, 7))[0]), "it is made but once");
    }
}
