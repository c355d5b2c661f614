//! A pixel that is chosen to be explained by itself: held in the window, kept in a session, or named on the command line.

use std::fmt;
use std::str::FromStr;

use motionscope_core::{Clip, Error, Explained, Walk};

/// A pixel of frame t by its column and row from 0, written `X,Y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// The column.
    pub x: u32,
    /// The row.
    pub y: u32,
}

impl Pixel {
    /// The pixel whose centre is nearest to `point`.
    pub fn of(point: [f32; 2]) -> Self {
        let [x, y] = point.map(|c| c.round() as u32);
        Self { x, y }
    }

    /// Its centre in image pixels.
    pub fn point(self) -> [f32; 2] {
        [self.x, self.y].map(|c| c as f32)
    }
}

impl fmt::Display for Pixel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.x, self.y)
    }
}

impl FromStr for Pixel {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let whole = |part: &str| part.trim().parse().ok();
        let parts = text.split_once(',').and_then(|(x, y)| Some(Self { x: whole(x)?, y: whole(y)? }));
        parts.ok_or_else(|| {
            Error::new(format!("a pixel is written X,Y in whole px from 0, as in 303,202, and not {text}"))
        })
    }
}

/// Which pixel is to be explained, and how much that matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// It was held: where it cannot be explained by itself, it is not.
    Held(Pixel),
    /// It is asked for: it is an error if it cannot be explained by itself.
    Asked(Pixel),
}

impl Chosen {
    /// The place that `walk` explains where it stands in `clip`, if not the pixel at work.
    ///
    /// # Errors
    /// A sentence that tells why a pixel that is asked for cannot be explained there.
    pub fn here(self, walk: &dyn Walk, clip: &Clip) -> Result<Option<[f32; 2]>, Error> {
        match self {
            Self::Held(pixel) => Ok(Some(pixel.point()).filter(|at| is_explained(walk, *at))),
            Self::Asked(pixel) => explain(pixel, walk, clip).map(Some),
        }
    }

    /// The same while `walk` goes from step to step: a pixel that was held is let go where each step is about another one.
    pub fn on_the_way(self, walk: &dyn Walk) -> Option<[f32; 2]> {
        let at = match self {
            Self::Held(pixel) => Some(pixel.point()).filter(|at| !walks_pixels(walk, *at)),
            Self::Asked(pixel) => Some(pixel.point()),
        };
        at.filter(|at| is_explained(walk, *at))
    }
}

/// Whether the pixel at `point` can be explained by itself where `walk` stands.
pub fn is_explained(walk: &dyn Walk, point: [f32; 2]) -> bool {
    walk.explained(point).is_some_and(|explained| explained.at(walk.cursor()))
}

/// Whether `walk` goes from pixel to pixel, so that who steps wants to hear of the next one; where all change at once, of the
/// same.
pub fn walks_pixels(walk: &dyn Walk, point: [f32; 2]) -> bool {
    matches!(walk.explained(point), Some(Explained::From(_)))
}

fn explain(pixel: Pixel, walk: &dyn Walk, clip: &Clip) -> Result<[f32; 2], Error> {
    let (width, height) = clip.size();
    let (Pixel { x, y }, here) = (pixel, walk.cursor());
    if x as usize >= width || y as usize >= height {
        let told = format!("there is no pixel ({x}, {y}): the picture has {width}×{height} px, counted from 0");
        return Err(Error::new(told));
    }
    match walk.explained(pixel.point()) {
        Some(explained) if explained.at(here) => Ok(pixel.point()),
        Some(Explained::From(turn)) => Err(Error::new(format!(
            "pixel ({x}, {y}) has its turn at step {turn}, and this is step {here}; choose a later step or another --pixel"
        ))),
        _ => Err(Error::new(format!(
            "{} does not explain pixel ({x}, {y}) by itself at step {here}; leave --pixel away, or name another",
            walk.info().id
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_read_as_it_is_written() {
        for pixel in [Pixel { x: 0, y: 0 }, Pixel { x: 303, y: 202 }] {
            assert_eq!(pixel.to_string().parse(), Ok(pixel));
            assert_eq!(Pixel::of(pixel.point()), pixel);
        }
        assert_eq!("7, 9".parse(), Ok(Pixel { x: 7, y: 9 }));
        for text in ["", "7", "7,", "7,-1", "7.5,1", "1,2,3", "x,y", "99999999999,1"] {
            let told = text.parse::<Pixel>().map_err(|error| error.to_string());
            assert!(told.as_ref().is_err_and(|told| told.contains("X,Y")), "{text}: {told:?}");
        }
    }
}
