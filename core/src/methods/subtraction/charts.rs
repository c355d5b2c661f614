//! The plots and tiles of a background subtraction.

use super::{Background, Channel, Subtraction};
use crate::data::Frame;
use crate::methods::differential::explain;
use crate::products::Record;
use crate::run::Span;
use crate::scene::{Readout, Role, Series, Tile};

/// Radius of the tiles around the explained pixel, in px.
const TILE_REACH_PX: usize = 4;

/// Plots of the foreground pixels and of the blobs of each frame.
pub(crate) fn plots(record: &Record, span: &Span) -> Vec<Readout> {
    let (frames, pixels) = (record.frames(), record.pixels());
    let line = |of: &dyn Fn(usize) -> f32| (0..frames.len()).map(|i| [(span.first + i) as f32, of(i)]).collect();
    let series = |title, y_label, name, line| {
        Series::new(
            title,
            ["frame", y_label],
            span.first + span.frames().unwrap_or(frames.len()) - 1,
            vec![(name, Role::Result, line)],
        )
    };
    if frames.len() < 2 {
        return Vec::new();
    }
    vec![
        Readout::Series(series("Foreground of the final mask", "px", "foreground pixels", line(&|i| pixels[i] as f32))),
        Readout::Series(series("Blobs", "number of blobs", "blobs", line(&|i| frames[i].detections.len() as f32))),
    ]
}

impl<M: Background> Subtraction<M> {
    /// Tiles of the frame and the background, in the channel that decides about a pixel, and of their difference around it.
    pub(super) fn tiles(&self, model: &M::Model, frame: &Frame, place: (usize, usize)) -> Vec<Tile> {
        let around = |of: &dyn Fn((usize, usize)) -> f32| explain::around_with(frame.size(), place, TILE_REACH_PX, of);
        let difference = around(&|place| self.0.difference(model, frame, place));
        let channel = self.0.channel(model, frame, place);
        let [shown, background] = tile_labels(channel);
        let (level, expected) = (
            around(&|place| f32::from(channel.level(frame, place))),
            around(&|place| self.0.compared_in(model, frame, place, channel)),
        );
        vec![
            Tile::gray(shown, level).with_role(Role::Measured),
            Tile::gray(background, expected).with_role(Role::Predicted),
            Tile::positive("Difference", difference),
        ]
    }
}

/// The names of the tiles of the frame and of the background.
fn tile_labels(channel: Channel) -> [&'static str; 2] {
    match channel {
        Channel::Gray => ["Frame t", "Background"],
        Channel::Color(0) => ["Frame t, red", "Background, red"],
        Channel::Color(1) => ["Frame t, green", "Background, green"],
        Channel::Color(_) => ["Frame t, blue", "Background, blue"],
    }
}
