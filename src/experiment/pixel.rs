//! The pixel to explain: held in the window, stored in a session, or given on the command line.

use std::fmt;
use std::str::FromStr;

use motionscope_core::base::Error;
use motionscope_core::data::Clip;
use motionscope_core::run::{Cursor, Explained, Move, Walk};
use motionscope_core::scene::{Canvas, Focus, Picture, Pixels};

/// A pixel by column and row from 0: `X,Y`, or `t+1:X,Y` in another picture than frame t.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// The picture.
    pub on: Picture,
    /// The column.
    pub x: u32,
    /// The row.
    pub y: u32,
}

impl Pixel {
    /// The pixel whose centre is nearest to `focus`.
    pub fn of(focus: Focus) -> Self {
        let [x, y] = focus.at.map(|c| c.round() as u32);
        Self { on: focus.on, x, y }
    }

    /// Sends `walk` to the end of the unit with the result at this pixel, where single pixels are not explained; gives whether it went.
    ///
    /// # Errors
    /// If there is no such pixel.
    pub fn go_to_unit(self, walk: &mut dyn Walk, clip: &Clip) -> Result<bool, Error> {
        let focus = self.focus();
        if walk.explained(focus).is_some() || !walk.takes(self.on) || !walk.beside(None).is_empty() {
            return Ok(false);
        }
        check_inside(self, walk, clip)?;
        let Some(unit) = walk.unit_at(focus) else { return Ok(false) };
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        Ok(true)
    }

    /// Its centre.
    pub fn focus(self) -> Focus {
        Focus::on(self.on, [self.x, self.y].map(|c| c as f32))
    }
}

impl fmt::Display for Pixel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.on != Picture::CURRENT {
            write!(f, "{}:", self.on)?;
        }
        write!(f, "{},{}", self.x, self.y)
    }
}

impl FromStr for Pixel {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let (on, place) = match text.split_once(':') {
            Some((picture, place)) => (picture.trim().parse()?, place),
            None => (Picture::CURRENT, text),
        };
        let whole = |part: &str| part.trim().parse().ok();
        let parts = place.split_once(',').and_then(|(x, y)| Some(Self { on, x: whole(x)?, y: whole(y)? }));
        parts.ok_or_else(|| {
            Error::new(format!("a pixel has the form X,Y in whole px from 0, as in 303,202, not {text}"))
        })
    }
}

/// A held pixel, or the object that was clicked there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// The pixel; of an object the one where it was.
    pub pixel: Pixel,
    /// The identity of the object, which is held wherever it goes.
    pub object: Option<u32>,
}

impl Held {
    /// What is held at `focus`.
    pub fn of(focus: Focus) -> Self {
        Self { pixel: Pixel::of(focus), object: focus.object }
    }

    /// Its place when it was chosen.
    pub fn focus(self) -> Focus {
        Focus { object: self.object, ..self.pixel.focus() }
    }
}

/// Where `held` is at the cursor of `walk`: an object wherever it has gone, and nowhere before it is there.
pub fn place_of(walk: &dyn Walk, held: Focus) -> Option<Focus> {
    let at = held.object.map_or(Some(held.at), |object| walk.place_of(object))?;
    Some(Focus { at, ..held })
}

/// The pixel to explain, and whether failure is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// Held: ignored at steps that cannot explain it.
    Held(Held),
    /// Requested: an error at steps that cannot explain it.
    Asked(Pixel),
}

impl Chosen {
    /// Returns the place that `walk` explains at its cursor, or `None` for the current pixel.
    ///
    /// # Errors
    /// A sentence that says why a requested pixel cannot be explained.
    pub fn here(self, walk: &dyn Walk, clip: &Clip) -> Result<Option<Focus>, Error> {
        match self {
            Self::Held(held) => Ok(place_of(walk, held.focus()).filter(|at| is_explained(walk, *at))),
            Self::Asked(pixel) => explain(pixel, walk, clip).map(Some),
        }
    }

    /// Returns the place while `walk` steps: a held pixel is ignored where each step explains another one.
    pub fn on_the_way(self, walk: &dyn Walk) -> Option<Focus> {
        let at = match self {
            Self::Held(held) => place_of(walk, held.focus()).filter(|at| !walks_pixels(walk, *at)),
            Self::Asked(pixel) => Some(pixel.focus()),
        };
        at.filter(|at| is_explained(walk, *at))
    }
}

/// Whether `walk` can explain the pixel at `focus` at its cursor.
pub fn is_explained(walk: &dyn Walk, focus: Focus) -> bool {
    walk.explained(focus).is_some_and(|explained| explained.at(walk.cursor()))
}

/// Whether each step of `walk` processes another pixel, rather than all pixels at once.
pub fn walks_pixels(walk: &dyn Walk, focus: Focus) -> bool {
    matches!(walk.explained(focus), Some(Explained::From(_)))
}

fn explain(pixel: Pixel, walk: &dyn Walk, clip: &Clip) -> Result<Focus, Error> {
    check_inside(pixel, walk, clip)?;
    let (Pixel { x, y, .. }, here) = (pixel, walk.cursor());
    match walk.explained(pixel.focus()) {
        Some(explained) if explained.at(here) => Ok(pixel.focus()),
        Some(Explained::From(turn)) => Err(Error::new(format!(
            "pixel ({x}, {y}) is processed at step {turn}, but this is step {here}; choose a later step or another --pixel"
        ))),
        _ => Err(Error::new(format!(
            "{} cannot explain pixel ({x}, {y}) at step {here}; omit --pixel, or choose another",
            walk.info().id
        ))),
    }
}

/// Refuses a pixel outside the pictures of the step, and one of a picture that `walk` explains no pixels of.
fn check_inside(pixel: Pixel, walk: &dyn Walk, clip: &Clip) -> Result<(), Error> {
    let Pixel { on, x, y } = pixel;
    let canvases = walk.scene(None).pictures;
    let canvas = canvases.iter().find(|canvas| canvas.picture == on);
    let pair = [Picture::CURRENT, Picture::NEXT];
    if canvas.is_none() && !pair.contains(&on) {
        return Err(not_shown(on, &canvases));
    }
    if !walk.takes(on) {
        let message =
            format!("{} cannot explain pixels of the picture {on}; for frame t, write {x},{y}", walk.info().id);
        return Err(Error::new(message));
    }
    let (width, height) = match canvas.map(|canvas| &canvas.pixels) {
        Some(Pixels::Made(make)) if !on.is_aligned_with(Picture::CURRENT) => make().size(),
        _ => clip.size(),
    };
    if x as usize >= width || y as usize >= height {
        let message = format!("pixel ({x}, {y}) is outside the picture of {width}×{height} px, counted from 0");
        return Err(Error::new(message));
    }
    Ok(())
}

/// Returns the error that a step with `canvases` (frames t and t + 1 if empty) does not show the picture `on`.
fn not_shown(on: Picture, canvases: &[Canvas]) -> Error {
    let mut shown: Vec<String> = canvases.iter().map(|canvas| canvas.picture.to_string()).collect();
    if shown.is_empty() {
        shown = [Picture::CURRENT, Picture::NEXT].map(|picture| picture.to_string()).into();
    }
    let last = shown.pop().unwrap_or_default();
    let all = if shown.is_empty() { last } else { format!("{} and {last}", shown.join(", ")) };
    Error::new(format!("this step does not show the picture {on}; it shows {all}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_read_as_it_is_written() {
        let of = |on, x, y| Pixel { on, x, y };
        for pixel in [of(Picture::CURRENT, 0, 0), of(Picture::CURRENT, 303, 202), of(Picture::NEXT, 4, 5)] {
            assert_eq!(pixel.to_string().parse(), Ok(pixel));
            assert_eq!(Pixel::of(pixel.focus()), pixel);
        }
        assert_eq!("reference:5,6".parse(), Ok(of(Picture::REFERENCE, 5, 6)));
        assert_eq!("7, 9".parse(), Ok(of(Picture::CURRENT, 7, 9)));
        for text in ["", "7", "7,", "7,-1", "7.5,1", "1,2,3", "x,y", "99999999999,1", "t+1:7"] {
            let message = text.parse::<Pixel>().map_err(|error| error.to_string());
            assert!(message.as_ref().is_err_and(|message| message.contains("X,Y")), "{text}: {message:?}");
        }
        let message = "frame:7,9".parse::<Pixel>().map_err(|error| error.to_string());
        assert!(message.as_ref().is_err_and(|message| message.contains("t+1, t-1")), "{message:?}");
    }
}
