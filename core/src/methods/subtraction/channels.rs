//! The channels in which a pixel is compared with the background.

use super::vocabulary::case;
use crate::choices;
use crate::data::{Clip, Frame};
use crate::scene::Case;

choices! {
    /// The channels in which a pixel is compared with the background.
    pub enum Channels {
        /// Red, green and blue, each with a background of its own; the largest difference decides. An object as bright as the background,
        /// but of another colour, is found. Gray frames have one channel.
        Color = "rgb" "RGB",
        /// The gray level alone. An object as bright as the background is missed, whatever its colour.
        Gray = "gray" "Gray",
    }
}

/// A channel of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The gray level.
    Gray,
    /// One of red, green and blue.
    Color(usize),
}

impl Channel {
    /// The name of a color channel.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Gray => None,
            Self::Color(channel) => Some(["red", "green", "blue"][channel]),
        }
    }

    /// Its place among the channels.
    pub fn index(self) -> usize {
        if let Self::Color(channel) = self { channel } else { 0 }
    }

    /// The level of a pixel in this channel.
    pub fn level(self, frame: &Frame, place: (usize, usize)) -> u8 {
        match (self, frame.color()) {
            (Self::Color(channel), Some(color)) => color[place][channel],
            _ => frame.luma()[place],
        }
    }
}

/// The gray level of a color.
pub fn luma([red, green, blue]: [f32; 3]) -> f32 {
    0.299 * red + 0.587 * green + 0.114 * blue
}

/// The levels of a pixel in three channels; its gray level three times where only one counts.
pub fn levels(frame: &Frame, place: (usize, usize), channels: usize) -> [u8; 3] {
    frame.color().filter(|_| channels == 3).map_or_else(|| [frame.luma()[place]; 3], |color| color[place])
}

/// The channel of the largest of one or three values, the first one of equal ones, and that value.
pub fn largest(values: &[f32]) -> (Channel, f32) {
    let best = (1..values.len()).fold(0, |best, c| if values[c] > values[best] { c } else { best });
    (if values.len() == 1 { Channel::Gray } else { Channel::Color(best) }, values[best])
}

impl Channels {
    /// The number of channels of a frame that are compared.
    pub fn count(self, frame: &Frame) -> usize {
        if self == Self::Color && frame.color().is_some() { 3 } else { 1 }
    }

    /// The end of a rule: which channels it is about.
    pub fn any(self) -> &'static Case {
        if self == Self::Color { case::ANY_CHANNEL } else { case::END }
    }

    /// The number of channels that frames of a clip may have.
    pub fn most(self, clip: &Clip) -> usize {
        clip.cached(0).map_or(if self == Self::Color { 3 } else { 1 }, |frame| self.count(&frame))
    }
}

/// A row of a frame.
#[derive(Clone, Copy)]
pub enum Row<'a> {
    Gray(&'a [u8]),
    Color(&'a [[u8; 3]]),
}

impl<'a> Row<'a> {
    /// Row `y` of a frame for a model with this many channels.
    pub fn of(frame: &'a Frame, y: usize, channels: usize) -> Self {
        frame
            .color()
            .filter(|_| channels == 3)
            .map_or_else(|| Self::Gray(frame.luma().row(y)), |c| Self::Color(c.row(y)))
    }

    pub fn width(self) -> usize {
        match self {
            Self::Gray(row) => row.len(),
            Self::Color(row) => row.len(),
        }
    }

    pub fn channels(self) -> usize {
        if let Self::Gray(_) = self { 1 } else { 3 }
    }

    /// The levels of a channel of the 64 pixels from `start` on; 0 beyond the row.
    #[inline(always)]
    pub fn block(self, channel: usize, start: usize) -> [u8; 64] {
        let mut levels = [0; 64];
        match self {
            Self::Gray(row) => match row[start..].first_chunk() {
                Some(whole) => levels = *whole,
                None => levels[..row.len() - start].copy_from_slice(&row[start..]),
            },
            Self::Color(row) => levels.iter_mut().zip(&row[start..]).for_each(|(level, color)| *level = color[channel]),
        }
        levels
    }
}
