//! The pictures of a step by name: marks, positions and pixels pointed at refer to them.
//!
//! A [`Picture`] consists of a viewpoint, a time relative to frame t, a pyramid level and a role (frame, reference, template,
//! mosaic). Estimators state in which pictures they can explain pixels (`Pointed::takes`). `Scene::pictures` lists the pictures
//! of a step, up to four, if they are not frames t and t + 1: frames of the clip, or pixels computed on demand
//! ([`Pixels::Made`]) such as a background model. Pictures with the same coordinates are zoomed together
//! ([`Picture::is_aligned_with`]). Where grays stand for a quantity, the canvas names it ([`Measured`]) for the title of the
//! picture and the numbers of its pixels.
//!
//! Pixel `(x, y)` of level n lies at `(2ⁿ x, 2ⁿ y)`; `Scene::add_enlarged` scales marks of a level. The levels of a variational
//! method are stretched over the picture instead (`Level::covering`).

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use crate::base::Error;
use crate::data::Frame;
pub use crate::data::Viewpoint;

/// The role of a picture in its step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PictureRole {
    /// A frame of the clip.
    #[default]
    Frame,
    /// The picture that a frame is compared with, pixel by pixel: a background model.
    Reference,
    /// A small picture that is matched in a frame.
    Template,
    /// Frames registered in the coordinates of one of them.
    Mosaic,
    /// A frame warped by a geometric transformation.
    Warped,
    /// A frame smoothed by a Gaussian filter, in its coordinates.
    Smoothed,
    /// The response of a filter, such as a difference of Gaussians, in the coordinates of the frame.
    Response,
    /// A cut through a volume of costs along a row of the frame: x to the right, disparity down.
    Slice,
}

/// The name of a picture: viewpoint, time, pyramid level, and role in the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Picture {
    /// Viewpoint.
    pub viewpoint: Viewpoint,
    /// Time relative to frame t in frames: 0 for frame t, −1 for the previous one.
    pub time: i32,
    /// The level of the pyramid; 0 is the picture itself.
    pub level: u8,
    /// Role in the step.
    pub role: PictureRole,
}

impl Picture {
    /// Frame t − 1.
    pub const PREVIOUS: Self = Self::at(-1);
    /// Frame t.
    pub const CURRENT: Self = Self::at(0);
    /// Frame t + 1.
    pub const NEXT: Self = Self::at(1);
    /// Frame t of the right view.
    pub const RIGHT: Self = Self { viewpoint: Viewpoint::Right, ..Self::CURRENT };
    /// The picture that frame t is compared with.
    pub const REFERENCE: Self = Self { role: PictureRole::Reference, ..Self::CURRENT };
    /// Frame t smoothed by a Gaussian filter.
    pub const SMOOTHED: Self = Self { role: PictureRole::Smoothed, ..Self::CURRENT };
    /// The response of a filter to frame t.
    pub const RESPONSE: Self = Self { role: PictureRole::Response, ..Self::CURRENT };

    /// The frame `time` frames after frame t.
    pub const fn at(time: i32) -> Self {
        Self { viewpoint: Viewpoint::Left, time, level: 0, role: PictureRole::Frame }
    }

    /// The frame `time` frames after frame t, warped by a geometric transformation.
    pub const fn warped(time: i32) -> Self {
        Self { role: PictureRole::Warped, ..Self::at(time) }
    }

    /// Whether a filter made it of a frame, in whose place it may stand.
    pub fn is_filtered(self) -> bool {
        matches!(self.role, PictureRole::Smoothed | PictureRole::Response)
    }

    /// Whether a pixel of one has its counterpart at the same place in the other, so that both are zoomed together.
    pub fn is_aligned_with(self, other: Self) -> bool {
        let has_the_frame = |picture: Self| {
            matches!(picture.role, PictureRole::Frame | PictureRole::Reference) || picture.is_filtered()
        };
        let is_same_role = self.role == other.role || (has_the_frame(self) && has_the_frame(other));
        self.viewpoint == other.viewpoint && self.level == other.level && is_same_role
    }

    /// Its title if frame t has the number `frame`: `Frame t+1 = 13`.
    pub fn title(self, frame: Option<usize>) -> String {
        let number = frame.and_then(|frame| frame.checked_add_signed(self.time as isize));
        let number = number.map_or_else(String::new, |number| format!(" = {number}"));
        let what = match self.role {
            PictureRole::Frame => format!("Frame {}{number}", self.moment("−")),
            PictureRole::Reference => "Background".into(),
            PictureRole::Template => "Template".into(),
            PictureRole::Mosaic => "Mosaic".into(),
            PictureRole::Warped => format!("Warped frame {}{number}", self.moment("−")),
            PictureRole::Smoothed => "Gaussian image".into(),
            PictureRole::Response => "Filter response".into(),
            PictureRole::Slice => "Cost slice".into(),
        };
        let of = if self.viewpoint == Viewpoint::Right { "Right view · " } else { "" };
        let level = if self.level > 0 { format!(" · level {}", self.level) } else { String::new() };
        format!("{of}{what}{level}")
    }

    /// `t`, `t+1`, `t-1` with this sign for the past.
    fn moment(self, minus: &str) -> String {
        match self.time {
            0 => "t".into(),
            1.. => format!("t+{}", self.time),
            _ => format!("t{minus}{}", self.time.unsigned_abs()),
        }
    }
}

impl fmt::Display for Picture {
    /// For scripts: `t`, `t+1`, `right-t`, `template`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.viewpoint == Viewpoint::Right {
            f.write_str("right-")?;
        }
        f.write_str(&match self.role {
            PictureRole::Frame => self.moment("-"),
            PictureRole::Reference => "reference".into(),
            PictureRole::Template => "template".into(),
            PictureRole::Mosaic => "mosaic".into(),
            PictureRole::Warped => format!("warped-{}", self.moment("-")),
            PictureRole::Smoothed => "smoothed".into(),
            PictureRole::Response => "response".into(),
            PictureRole::Slice => "slice".into(),
        })?;
        if self.level > 0 { write!(f, "-level-{}", self.level) } else { Ok(()) }
    }
}

impl FromStr for Picture {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let invalid = || {
            Error::new(format!(
                "a picture must be t, t+1, t-1, warped-t, reference, template, mosaic, smoothed, response or slice, with the prefix right- \
                 for the right view and the suffix -level-2 for a level of a pyramid, not {text}"
            ))
        };
        let (viewpoint, rest) = match text.strip_prefix("right-") {
            Some(rest) => (Viewpoint::Right, rest),
            None => (Viewpoint::Left, text),
        };
        let (rest, level) = match rest.split_once("-level-") {
            Some((rest, level)) => (rest, level.parse().map_err(|_| invalid())?),
            None => (rest, 0),
        };
        let time_of = |moment: &str| moment.strip_prefix('t').and_then(|time| time.parse().ok());
        let (role, time) = match rest {
            "reference" => (PictureRole::Reference, Some(0)),
            "template" => (PictureRole::Template, Some(0)),
            "mosaic" => (PictureRole::Mosaic, Some(0)),
            "smoothed" => (PictureRole::Smoothed, Some(0)),
            "response" => (PictureRole::Response, Some(0)),
            "slice" => (PictureRole::Slice, Some(0)),
            "t" => (PictureRole::Frame, Some(0)),
            "warped-t" => (PictureRole::Warped, Some(0)),
            moment => match moment.strip_prefix("warped-") {
                Some(moment) => (PictureRole::Warped, time_of(moment)),
                None => (PictureRole::Frame, time_of(moment)),
            },
        };
        Ok(Self { viewpoint, time: time.ok_or_else(invalid)?, level, role })
    }
}

/// The source of a picture's pixels.
#[derive(Clone)]
pub enum Pixels {
    /// A frame of the clip.
    OfClip,
    /// Computed when the picture is shown.
    Made(Arc<dyn Fn() -> Frame + Send + Sync>),
}

impl fmt::Debug for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if matches!(self, Self::OfClip) { "OfClip" } else { "Made" })
    }
}

/// The quantity that the grays of a picture stand for.
#[derive(Clone)]
pub struct Measured {
    /// Its symbol, as `D₁`.
    pub symbol: String,
    /// The title of the picture: the symbol, its definition, and the scale of grays.
    pub title: String,
    value: Arc<dyn Fn([usize; 2]) -> f32 + Send + Sync>,
}

impl Measured {
    /// A quantity with its value at each pixel.
    pub fn new(
        symbol: impl Into<String>,
        title: impl Into<String>,
        value: impl Fn([usize; 2]) -> f32 + Send + Sync + 'static,
    ) -> Self {
        Self { symbol: symbol.into(), title: title.into(), value: Arc::new(value) }
    }

    /// The value at pixel `(x, y)` of the picture.
    pub fn at(&self, pixel: [usize; 2]) -> f32 {
        (self.value)(pixel)
    }
}

impl fmt::Debug for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Measured({})", self.title)
    }
}

/// A picture that a step shows.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Its name.
    pub picture: Picture,
    /// The source of its pixels.
    pub pixels: Pixels,
    /// The quantity that its grays stand for, if they are not gray levels of a frame.
    pub measured: Option<Measured>,
    /// The row that it is a cut along, where the pixel pointed at decides that.
    pub row: Option<usize>,
}

impl Canvas {
    /// The frame of the clip called `picture`.
    pub const fn of_clip(picture: Picture) -> Self {
        Self { picture, pixels: Pixels::OfClip, measured: None, row: None }
    }

    /// A picture whose pixels are computed by `make` when it is shown.
    pub fn made(picture: Picture, make: impl Fn() -> Frame + Send + Sync + 'static) -> Self {
        Self { picture, pixels: Pixels::Made(Arc::new(make)), measured: None, row: None }
    }

    /// The same picture, whose grays stand for this quantity.
    #[must_use]
    pub fn of(self, measured: Measured) -> Self {
        Self { measured: Some(measured), ..self }
    }

    /// The same picture as a cut along `row`: pointing at another row makes another picture.
    #[must_use]
    pub fn along(self, row: usize) -> Self {
        Self { row: Some(row), ..self }
    }
}

impl PartialEq for Canvas {
    /// Whether name, kind of source and row are equal: pictures computed from the same state have the same pixels then.
    fn eq(&self, other: &Self) -> bool {
        let is_made = |canvas: &Self| matches!(canvas.pixels, Pixels::Made(_));
        let title = |canvas: &Self| canvas.measured.as_ref().map(|measured| measured.title.clone());
        (self.picture, self.row) == (other.picture, other.row)
            && is_made(self) == is_made(other)
            && title(self) == title(other)
    }
}

/// A position on a picture: the pixel pointed at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// The picture that it lies on.
    pub on: Picture,
    /// Position in px of that picture.
    pub at: [f32; 2],
    /// The identity of the object that was clicked, whose place follows it from frame to frame; `None` for a pixel.
    pub object: Option<u32>,
}

impl Focus {
    /// The point `at` of frame t.
    pub const fn current(at: [f32; 2]) -> Self {
        Self::on(Picture::CURRENT, at)
    }

    /// The point `at` of a picture.
    pub const fn on(on: Picture, at: [f32; 2]) -> Self {
        Self { on, at, object: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_read_as_it_is_written() {
        let right = Picture { viewpoint: Viewpoint::Right, ..Picture::NEXT };
        let level = Picture { level: 2, ..Picture::at(-3) };
        let template = Picture { role: PictureRole::Template, ..Picture::CURRENT };
        let mosaic = Picture { role: PictureRole::Mosaic, ..Picture::CURRENT };
        for (picture, name) in [
            (Picture::CURRENT, "t"),
            (Picture::NEXT, "t+1"),
            (Picture::PREVIOUS, "t-1"),
            (right, "right-t+1"),
            (level, "t-3-level-2"),
            (template, "template"),
            (mosaic, "mosaic"),
            (Picture::REFERENCE, "reference"),
            (Picture::SMOOTHED, "smoothed"),
            (Picture::RESPONSE, "response"),
            (Picture::RIGHT, "right-t"),
            (Picture { role: PictureRole::Slice, ..Picture::CURRENT }, "slice"),
            (Picture::warped(0), "warped-t"),
            (Picture::warped(1), "warped-t+1"),
        ] {
            assert_eq!(picture.to_string(), name);
            assert_eq!(name.parse(), Ok(picture));
        }
        for wrong in ["", "u", "t1x", "right", "t-level-x", "level-2"] {
            let message = wrong.parse::<Picture>().map_err(|error| error.to_string());
            assert!(message.as_ref().is_err_and(|message| message.contains("right-")), "{wrong}: {message:?}");
        }
    }

    #[test]
    fn a_title_tells_the_number_of_the_frame() {
        assert_eq!(Picture::NEXT.title(Some(12)), "Frame t+1 = 13");
        assert_eq!(Picture::PREVIOUS.title(Some(12)), "Frame t−1 = 11");
        assert_eq!(Picture::PREVIOUS.title(Some(0)), "Frame t−1");
        let right = Picture { viewpoint: Viewpoint::Right, level: 2, ..Picture::CURRENT };
        assert_eq!(right.title(None), "Right view · Frame t · level 2");
    }

    #[test]
    fn what_shows_the_same_place_is_zoomed_together() {
        assert!(
            Picture::CURRENT.is_aligned_with(Picture::NEXT) && Picture::REFERENCE.is_aligned_with(Picture::CURRENT)
        );
        assert!(
            Picture::SMOOTHED.is_aligned_with(Picture::RESPONSE) && Picture::CURRENT.is_aligned_with(Picture::SMOOTHED)
        );
        let right = Picture { viewpoint: Viewpoint::Right, ..Picture::CURRENT };
        let template = Picture { role: PictureRole::Template, ..Picture::CURRENT };
        for other in [right, template, Picture { level: 1, ..Picture::CURRENT }] {
            assert!(!Picture::CURRENT.is_aligned_with(other), "{other}");
        }
        assert!(template.is_aligned_with(template));
    }
}
