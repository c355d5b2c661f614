//! Models with a background of its own for each colour channel of a pixel.

use std::sync::Arc;

use super::explanation::{Cases, Probe};
use super::rows::Flags;
use super::shadow::{ShadowDetection, ShadowLimits, is_shadow};
use super::vocabulary::{case, value};
use super::{Accepted, Background, Channel, Channels, Comparison, Explanation, Found, Past, Row, Setup};
use super::{displaced, largest, levels, luma};
use crate::base::Threads;
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::params::Params;
use crate::run::{Info, Need};
use crate::scene::{Case, Layer, Step, Unit};

/// The tolerated deviation of a shadow from the color of the background, as a share of the threshold: darker objects are not shadows.
pub const SHADOW_SHARE: f32 = 0.4;

/// A rule that compares each channel of a pixel with a background of its own.
pub trait Channelwise {
    /// The background of a channel of a pixel.
    type Cell: Copy + Send + Sync;

    /// The difference of a level from its background.
    fn distance(&self, cell: Self::Cell, level: u8) -> f32;

    /// Whether a level differs from its background.
    fn differs(&self, cell: Self::Cell, level: u8) -> bool;

    /// The background after an update with a level of a pixel of this class.
    fn updated(&self, cell: Self::Cell, level: u8, is_foreground: bool) -> Self::Cell;
}

/// A model of the background by channels.
pub trait ChannelModel: Channelwise<Cell: Into<f32>> + Params + Default + Clone + Send + Sync + 'static {
    /// As [`Background::INFO`].
    const INFO: Info;
    /// As [`Background::SHOWN`].
    const SHOWN: &'static str = "|I − B|, in colour the maximum over the channels";
    /// The rule of foreground, without the channels.
    const RULE: &'static Case = case::RULE;
    /// The unit of the threshold.
    const UNIT: Unit = Unit::GRAY;

    /// The parameters that all of them have.
    fn common(&self) -> Common;

    /// The threshold on [`Channelwise::distance`].
    fn threshold(&self) -> f32;

    /// The background of a channel that has this level in the initial picture.
    fn begun(&self, level: u8) -> Self::Cell;

    /// The squared deviation from the colour of a pixel's backgrounds that is tolerated in a shadow.
    fn shadow_limit(&self, _cells: [Self::Cell; 3]) -> f32 {
        (SHADOW_SHARE * self.threshold()).powi(2)
    }

    /// The levels that a background accepts.
    fn accepts(&self, cell: Self::Cell) -> Accepted {
        Accepted::around(cell.into(), self.threshold())
    }

    /// [`classify`] with the widest registers available.
    fn decide(&self, row: Row<'_>, cells: &mut [Self::Cell], words: &mut [u64]);

    /// As [`Background::layers`].
    fn layers(&self, _model: &Arc<Planes<Self::Cell>>, _past: &Past) -> Vec<Layer> {
        Vec::new()
    }

    /// As [`Background::explain`].
    fn explain(&self, step: Step, probe: &Probe<Planes<Self::Cell>>) -> Explanation;
}

/// The parameters of all models by channels.
pub struct Common {
    pub channels: Channels,
    pub shadow: ShadowDetection,
    pub setup: Setup,
}

impl<M: ChannelModel> Background for M {
    const INFO: Info = <M as ChannelModel>::INFO;
    const SHOWN: &'static str = <M as ChannelModel>::SHOWN;
    type Model = Planes<M::Cell>;

    fn setup(&self) -> Setup {
        self.common().setup
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        model.shifted(by, &self.begin(frame))
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        displaced(mask, self.setup().steady, |place, of| model.fits(self, (frame, place), of))
    }

    fn need(&self, clip: &Clip) -> Need {
        let cells = 2 * size_of::<M::Cell>() * self.common().channels.most(clip);
        Need::per_pixel(clip, [2.0 + cells as f64; 2])
    }

    fn begin(&self, first: &Arc<Frame>) -> Self::Model {
        Planes::begin(first, self.common().channels, |level| self.begun(level))
    }

    fn subtract(&self, model: &mut Self::Model, frame: &Arc<Frame>, threads: &Threads) -> Found {
        // Shadows are those on the background before the update.
        let ShadowDetection { detect_shadows, shadow_threshold } = self.common().shadow;
        let before = (detect_shadows && model.channels == 3).then(|| model.clone());
        let mask = model.by_rows(frame, threads, |row, cells, words| self.decide(row, cells, words));
        let limit = |cells| self.shadow_limit(cells);
        let shadows = before.map(|model| model.shadows((frame, &mask), shadow_threshold, Into::into, limit));
        Found { mask, shadows }
    }

    fn expected(&self, model: &Self::Model, place: (usize, usize)) -> f32 {
        model.expected(place, Channel::Gray, Into::into)
    }

    fn expected_color(&self, model: &Self::Model, place: (usize, usize)) -> Option<[u8; 3]> {
        model.color(place, Into::into)
    }

    fn channel(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> Channel {
        model.deciding(self, frame, place).0
    }

    fn compared_in(&self, model: &Self::Model, _: &Frame, place: (usize, usize), channel: Channel) -> f32 {
        model.expected(place, channel, Into::into)
    }

    fn accepted(&self, model: &Self::Model, place: (usize, usize), channel: Channel) -> Vec<Accepted> {
        vec![self.accepts(model.at(place)[channel.index()])]
    }

    fn layers(&self, model: &Arc<Self::Model>, past: &Past) -> Vec<Layer> {
        ChannelModel::layers(self, model, past)
    }

    fn difference(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32 {
        model.deciding(self, frame, place).1
    }

    fn explain(&self, step: Step, probe: &Probe<Self::Model>) -> Explanation {
        ChannelModel::explain(self, step, probe)
    }

    fn rule(&self, step: Step) -> (Step, Cases) {
        (
            step.put_value(value::THRESHOLD.is(self.threshold()).in_unit(M::UNIT)),
            vec![M::RULE, self.common().channels.any()],
        )
    }

    fn model_bytes(&self, model: &Self::Model) -> usize {
        model.bytes()
    }
}

/// Classifies the pixels of a row, foreground where any channel differs, and updates their backgrounds.
#[inline(always)]
pub fn classify<M: Channelwise>(of: &M, row: Row<'_>, cells: &mut [M::Cell], words: &mut [u64]) {
    let width = row.width();
    let channels = cells.len() / width.max(1);
    for (index, word) in words.iter_mut().enumerate() {
        let start = 64 * index;
        let part = |c: usize| c * width + start..c * width + width.min(start + 64);
        let mut flags = Flags([0; 64]);
        for c in 0..channels {
            let levels = row.block(c, start);
            for ((flag, cell), level) in flags.0.iter_mut().zip(&cells[part(c)]).zip(levels) {
                *flag |= u8::from(of.differs(*cell, level));
            }
        }
        for c in 0..channels {
            let levels = row.block(c, start);
            for ((cell, level), flag) in cells[part(c)].iter_mut().zip(levels).zip(flags.0) {
                *cell = of.updated(*cell, level, flag != 0);
            }
        }
        *word = flags.word();
    }
}

/// A background for each channel of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes<T> {
    /// The channels of a row stand one after the other.
    cells: Grid<T>,
    /// The number of channels: 1 for gray, 3 for color.
    pub channels: usize,
}

impl<T: Copy + Send + Sync> Planes<T> {
    /// Initialises all backgrounds with the levels of a frame.
    pub fn begin(frame: &Frame, channels: Channels, of: impl Fn(u8) -> T) -> Self {
        let ((width, height), channels) = (frame.size(), channels.count(frame));
        let cells =
            Grid::from_fn(width * channels, height, |x, y| of(levels(frame, (x % width, y), channels)[x / width]));
        Self { cells, channels }
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (usize, usize) {
        (self.cells.width() / self.channels, self.cells.height())
    }

    /// The backgrounds of a pixel; that of the gray level three times where there is only one.
    pub fn at(&self, (x, y): (usize, usize)) -> [T; 3] {
        let width = self.size().0;
        [0, 1, 2].map(|c| self.cells[(c.min(self.channels - 1) * width + x, y)])
    }

    /// Returns the model displaced by `by` px; uncovered pixels are those of `begun`.
    pub fn shifted(&self, by: [f32; 2], begun: &Self) -> Self {
        let ((width, height), by) = (self.size(), by.map(|c| c.round() as isize));
        let cells = Grid::from_fn(width * self.channels, height, |x, y| {
            let (c, x) = (x / width, x % width);
            let from = x.checked_add_signed(-by[0]).zip(y.checked_add_signed(-by[1]));
            let from = from.filter(|(x, y)| *x < width && *y < height);
            from.map_or_else(|| begun.at((x, y))[c], |(x, y)| self.cells[(c * width + x, y)])
        });
        Self { cells, ..*self }
    }

    /// Classifies the pixels of a frame with `f`, which gets each row, its backgrounds and its words of the mask.
    pub fn by_rows(
        &mut self,
        frame: &Frame,
        threads: &Threads,
        f: impl Fn(Row<'_>, &mut [T], &mut [u64]) + Send + Sync,
    ) -> Mask {
        let ((width, height), channels) = (self.size(), self.channels);
        let mut mask = Mask::new(width, height);
        mask.write(|words, in_row| {
            let cells = self.cells.cells_mut().chunks_mut(width * channels);
            let rows = cells.zip(words.chunks_mut(in_row)).enumerate();
            threads.each(rows, |(y, (cells, words)): (usize, (&mut [T], &mut [u64]))| {
                f(Row::of(frame, y, channels), cells, words);
            });
        });
        mask
    }

    /// The foreground pixels that are shadows on the backgrounds; `level` gives the level of a background, `limit` the squared deviation
    /// from the color of a pixel's backgrounds that is tolerated.
    pub fn shadows(
        &self,
        (frame, foreground): (&Frame, &Mask),
        darkest: f32,
        level: impl Fn(T) -> f32,
        limit: impl Fn([T; 3]) -> f32,
    ) -> Mask {
        let (width, height) = self.size();
        let is_one = |place| {
            let (cells, levels) = (self.at(place), levels(frame, place, self.channels));
            is_shadow(levels.map(f32::from), cells.map(&level), ShadowLimits { darkest, limit: limit(cells) })
        };
        Mask::from_fn(width, height, |x, y| foreground.get(x, y) && is_one((x, y)))
    }

    /// The differences of a pixel from its backgrounds.
    fn distances<M: Channelwise<Cell = T>>(&self, of: &M, frame: &Frame, place: (usize, usize)) -> [f32; 3] {
        let (cells, levels) = (self.at(place), levels(frame, place, self.channels));
        [0, 1, 2].map(|c| of.distance(cells[c], levels[c]))
    }

    /// The channel with the largest difference of a pixel from its backgrounds, and that difference.
    pub fn deciding<M: Channelwise<Cell = T>>(&self, of: &M, frame: &Frame, place: (usize, usize)) -> (Channel, f32) {
        largest(&self.distances(of, frame, place)[..self.channels])
    }

    /// The comparison of a pixel with its backgrounds.
    pub fn comparison<M: ChannelModel<Cell = T>>(&self, of: &M, probe: &Probe<Self>) -> Comparison {
        let &Probe { after, frame, place, .. } = probe;
        let values = |model: &Self| model.at(place)[..self.channels].iter().map(|cell| (*cell).into()).collect();
        Comparison {
            pixel: levels(frame, place, self.channels)[..self.channels].to_vec(),
            background: values(self),
            after: after.map(values),
            threshold: value::THRESHOLD.is(of.threshold()).in_unit(M::UNIT),
            is_foreground: !self.fits(of, (frame, place), place),
        }
    }

    /// Whether the backgrounds of pixel `of` explain the levels of pixel `place` of a frame.
    pub fn fits<M: Channelwise<Cell = T>>(
        &self,
        by: &M,
        (frame, place): (&Frame, (usize, usize)),
        of: (usize, usize),
    ) -> bool {
        let (cells, levels) = (self.at(of), levels(frame, place, self.channels));
        (0..self.channels).all(|c| !by.differs(cells[c], levels[c]))
    }

    /// The value that `level` gives for the background of a pixel in a channel.
    pub fn expected(&self, place: (usize, usize), channel: Channel, level: impl Fn(T) -> f32) -> f32 {
        let values = self.at(place).map(level);
        match channel {
            Channel::Color(channel) => values[channel],
            Channel::Gray if self.channels == 1 => values[0],
            Channel::Gray => luma(values),
        }
    }

    /// The color that `level` gives for the backgrounds of a pixel, if there is one.
    pub fn color(&self, place: (usize, usize), level: impl Fn(T) -> f32) -> Option<[u8; 3]> {
        (self.channels == 3).then(|| self.at(place).map(|cell| level(cell).round().clamp(0.0, 255.0) as u8))
    }

    /// Memory of the cells in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.cells.cells())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole levels with a threshold of 10 that move to the frame.
    struct Last;

    impl Channelwise for Last {
        type Cell = u8;

        fn distance(&self, cell: u8, level: u8) -> f32 {
            f32::from(cell.abs_diff(level))
        }

        fn differs(&self, cell: u8, level: u8) -> bool {
            cell.abs_diff(level) > 10
        }

        fn updated(&self, cell: u8, level: u8, is_foreground: bool) -> u8 {
            if is_foreground { cell } else { level }
        }
    }

    fn pixel(x: usize, y: usize) -> [u8; 3] {
        [0, 1, 2].map(|c| (20 + 20 * c + 2 * x + 5 * y) as u8)
    }

    #[test]
    fn a_pixel_is_foreground_where_any_channel_differs() {
        // Wider than a word, with an object that differs in blue only and noise in red.
        let (width, height) = (70, 3);
        let first = Frame::rgb(Grid::from_fn(width, height, pixel));
        let is_object = |x: usize, y: usize| (60..68).contains(&x) && y > 0;
        let next = Frame::rgb(Grid::from_fn(width, height, |x, y| {
            let [red, green, blue] = pixel(x, y);
            [red + 4, green, if is_object(x, y) { blue - 12 } else { blue }]
        }));
        let mut model = Planes::begin(&first, Channels::Color, |level| level);
        let decide = |row: Row<'_>, cells: &mut [u8], words: &mut [u64]| classify(&Last, row, cells, words);
        let mask = model.by_rows(&next, &Threads::single(), decide);
        assert_eq!(mask, Mask::from_fn(width, height, is_object));
        // All channels of a foreground pixel keep their background.
        assert_eq!([model.at((61, 1)), model.at((3, 1))], [pixel(61, 1), levels(&next, (3, 1), 3)]);
        assert_eq!(model.deciding(&Last, &next, (61, 1)), (Channel::Color(2), 12.0));
        assert!(!model.fits(&Last, (&next, (61, 1)), (61, 1)) && model.fits(&Last, (&next, (3, 1)), (4, 1)));
        // In gray the object is as bright as the background.
        let mut gray = Planes::begin(&first, Channels::Gray, |level| level);
        assert_eq!(gray.by_rows(&next, &Threads::single(), decide).count(), 0);
    }

    #[test]
    fn a_shifted_model_keeps_its_channels() {
        let [now, next] = [0, 9].map(|by| Frame::rgb(Grid::from_fn(6, 4, |x, y| pixel(x + by, y))));
        let [model, begun] = [&now, &next].map(|frame| Planes::begin(frame, Channels::Color, |level| level));
        let shifted = model.shifted([2.0, -1.0], &begun);
        assert_eq!(shifted.at((3, 1)), pixel(1, 2));
        assert_eq!([shifted.at((1, 1)), shifted.at((3, 3))], [pixel(10, 1), pixel(12, 3)]);
    }
}
