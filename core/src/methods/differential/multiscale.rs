//! A pair of frames on the levels of a pyramid, and how places and displacements of a level lie on the picture.

use super::{Field, Given};
use crate::base::{Error, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::{Grid, pyramid};

/// From one level to the next.
const FACTOR: f32 = 0.5;

/// What a run from coarse to fine is given. Level 0 is the picture itself; all levels cover the same area.
pub struct Multiscale {
    /// The frames as they are, and the truth about them.
    pub given: Given,
    /// Frames t and t + 1 on each level but the picture itself.
    coarser: [Vec<Grid<f32>>; 2],
}

impl Multiscale {
    /// Frames `frame` and `frame + 1` of `clip`, smoothed by a Gaussian of `sigma_px`, on at most `count` levels.
    ///
    /// # Errors
    /// As [`Given::new`].
    pub fn new((clip, frame): (&Clip, usize), sigma_px: f32, count: usize, threads: &Threads) -> Result<Self, Error> {
        let given = Given::new(clip, frame, sigma_px, threads)?;
        let coarser = given.pictures.each_ref().map(|picture| pyramid::coarser(picture, FACTOR, count, threads));
        Ok(Self { given, coarser })
    }

    /// How many levels there are.
    pub fn count(&self) -> usize {
        1 + self.coarser[0].len()
    }

    /// Frames t and t + 1 on a level.
    pub fn pair(&self, level: usize) -> [&Grid<f32>; 2] {
        [0, 1].map(|i| if level == 0 { &self.given.pictures[i] } else { &self.coarser[i][level - 1] })
    }

    /// Width and height of a level in its own px.
    pub fn size(&self, level: usize) -> (usize, usize) {
        self.pair(level)[0].size()
    }

    /// How many px of the picture one of a level is, across and down.
    pub fn scale(&self, level: usize) -> [f32; 2] {
        let ((width, height), (w, h)) = (self.size(0), self.size(level));
        [width as f32 / w as f32, height as f32 / h as f32]
    }

    /// The pixel of a level that covers a place of the picture, if that lies in it.
    pub fn pixel_at(&self, level: usize, point: [f32; 2]) -> Option<(usize, usize)> {
        let (x, y) = self.given.pixel_at(point)?;
        let ((width, height), scale) = (self.size(level), self.scale(level));
        let on_level = |c: usize, scale: f32, extent: usize| (((c as f32 + 0.5) / scale) as usize).min(extent - 1);
        Some((on_level(x, scale[0], width), on_level(y, scale[1], height)))
    }

    /// The rectangle of the picture, by its edges, that the pixels of a level from `min` to before `max` cover.
    pub fn on_picture(&self, level: usize, min: [f32; 2], max: [f32; 2]) -> [[f32; 2]; 2] {
        let scale = self.scale(level);
        [min, max].map(|corner| [0, 1].map(|i| corner[i] * scale[i] - 0.5))
    }

    /// The true displacement of a pixel of a level, in px of the level, if it is known.
    pub fn truth(&self, level: usize, (x, y): (usize, usize)) -> Option<[f32; 2]> {
        let scale = self.scale(level);
        let place = |i: usize, scale: f32| ((i as f32 + 0.5) * scale) as usize;
        let truth = self.given.true_displacement((place(x, scale[0]), place(y, scale[1])))?;
        Some([0, 1].map(|i| truth[i] / scale[i]))
    }

    /// A field of any level on the picture.
    pub fn flow(&self, field: &Field) -> Flow {
        if field.u.size() == self.size(0) {
            field.flow()
        } else {
            field.resized(self.size(0), &Threads::single()).flow()
        }
    }

    /// Mean endpoint error of a field on `level`, in px of the picture, over the pixels whose true motion is known; NaN where
    /// that is none.
    pub fn error(&self, level: usize, field: &Field) -> f32 {
        let scale = self.scale(level);
        let (width, height) = field.u.size();
        let (mut sum, mut known) = (0.0, 0u32);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let Some(truth) = self.truth(level, (x, y)) else { continue };
            let found = field.at(x, y);
            let off = [0, 1].map(|i| (found[i] - truth[i]) * scale[i]);
            sum += f64::from(off[0].hypot(off[1]));
            known += 1;
        }
        (sum / f64::from(known)) as f32
    }

    /// Memory of the levels, in bytes.
    pub fn bytes(&self) -> usize {
        self.given.bytes() + self.coarser.iter().flatten().map(|level| size_of_val(level.cells())).sum::<usize>()
    }
}
