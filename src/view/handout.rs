//! The handout of a lesson: its pages on sheets of paper, words that can be read in print beside their pictures.
//!
//! A sheet of panes is laid out for its slot; a page whose words do not fit has a sheet of its own.

use std::str::FromStr;

use motionscope_core::base::Error;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Chart, Readout, Sentence, Step};

use super::moment::Moment;
use super::page::{Stand, Words};
use super::panes::{Pane, Selection, all_series, charts, find};
use super::paper::{Around, Paper, THEME, lines, ruled};
use super::rendering::Rendering;
use crate::media::Progress;
use crate::paint::charts::explanation::{self, Block, Density};
use crate::paint::charts::prose::lay_out;
use crate::paint::charts::{ChartStyle, Type};
use crate::paint::primitive::{Point, Rect};
use crate::paint::{Face, Figure, Sheet};

/// Points of paper for each point of a picture: its smallest type is 12 points high and becomes 8.
const SCALE: f32 = 2.0 / 3.0;
/// Marks are as fine as in other pictures for print.
const DENSITY: u32 = 2;
/// Between words and picture, and between two pages on a sheet.
const GAP: f32 = 14.0;
/// What is kept free beside a chart, the share of the height that pictures above a chart have at most, the height of a chart as a share of
/// its width at most, and the least side of a picture, in its own points.
const INSET: f32 = 16.0;
const STAGE_SHARE: f32 = 0.55;
const CHART_SHAPE: f32 = 0.6;
const LEAST: f32 = 60.0;
/// The smallest type of words, and the heights that are left below words beside a picture and above one, in points of paper.
const LEAST_PT: f32 = 8.0;
const LEAST_LEFT: f32 = 14.0;
const LEAST_PICTURE: f32 = 90.0;
/// Lines for an answer, and how far they are apart.
const ANSWER_LINES: usize = 2;
const ANSWER_APART: f32 = 18.0;

/// How many pages of a lesson a sheet has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PerSheet {
    /// The words above a large picture.
    One,
    /// The words beside the picture and its chart.
    #[default]
    Two,
    /// The words above a small picture.
    Four,
}

impl PerSheet {
    /// Every number that can be chosen.
    pub const ALL: [Self; 3] = [Self::One, Self::Two, Self::Four];

    /// The number.
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }

    /// Where the pages stand on a sheet with this room.
    fn slots(self, room: Rect) -> Vec<Rect> {
        let (columns, rows) = match self {
            Self::One => (1, 1),
            Self::Two => (1, 2),
            Self::Four => (2, 2),
        };
        let [width, height] = room.size();
        let size = [(width, columns), (height, rows)].map(|(side, count)| (side + GAP) / count as f32 - GAP);
        let slot = |index: usize| {
            let place = [index % columns, index / columns];
            Rect::new([0, 1].map(|i| room.min[i] + place[i] as f32 * (size[i] + GAP)), size)
        };
        (0..self.count()).map(slot).collect()
    }

    /// Size of the type of the words, and their share of the width.
    fn words(self) -> (f32, f32) {
        match self {
            Self::One => (11.0, 1.0),
            Self::Two => (9.0, 0.38),
            Self::Four => (8.0, 1.0),
        }
    }

    /// Height of the words at most, in a slot of this height: a picture below them needs some of it.
    fn most(self, height: f32) -> f32 {
        let (_, share) = self.words();
        if share < 1.0 { height } else { height - (LEAST_PICTURE - LEAST_LEFT) }
    }
}

impl FromStr for PerSheet {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let refused = || Error::new(format!("a sheet has 1, 2 or 4 pages of a lesson, not {text}"));
        Self::ALL.into_iter().find(|one| one.count().to_string() == text.trim()).ok_or_else(refused)
    }
}

/// How a handout is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Pages on a sheet.
    pub per_sheet: PerSheet,
    /// Whether pages that ask for something show what follows.
    pub answers: bool,
}

/// What a page leads to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Goal {
    /// Whether it asks the reader to predict something.
    pub asks: bool,
    /// Its last step, if it has several.
    pub until: Option<Cursor>,
}

/// What stands below the words of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Below {
    /// Lines for an answer.
    Lines,
    /// The sentence of the last step, which answers.
    Answer,
    /// The sentence of the step that is shown.
    Step,
}

/// The handout of a lesson while its pages are added.
pub struct Handout {
    options: Options,
    paper: Paper,
    slots: Vec<Rect>,
}

impl Handout {
    /// The handout of the lesson with this `title`.
    pub fn new(title: &str, options: Options) -> Self {
        let beside = if options.answers { "With answers" } else { "Name ____________________  Date ____________" };
        let around = Around { title: title.into(), beside: beside.into(), foot: format!("Motionscope · {title}") };
        Self { options, paper: Paper::new(around), slots: Vec::new() }
    }

    /// Adds a page whose `stand` is in the colours of print. With answers its last step is shown.
    ///
    /// # Errors
    /// If its run cannot start or breaks off, its words do not fit on a sheet, or the work was cancelled.
    pub async fn add(
        &mut self,
        words: &Words<'_>,
        stand: Stand<'_>,
        goal: Goal,
        progress: Option<&dyn Progress>,
    ) -> Result<(), Error> {
        let last = goal.until.filter(|_| self.options.answers);
        let stand = Stand { cursor: last.unwrap_or(stand.cursor), ..stand };
        let moment = stand.seen(progress, |viewer, focus| viewer.moment(focus)).await?;
        let below = match (goal.asks, self.options.answers, last) {
            (true, false, _) => Below::Lines,
            (true, true, Some(_)) => Below::Answer,
            _ => Below::Step,
        };
        let told = (&moment, stand.estimator().info().name, below);
        let (block, slot, per_sheet) = self.place(|per_sheet, size| written(words, told, per_sheet, size))?;
        let ([x, y], height) = (slot.min, block.size[1]);
        let (_, share) = per_sheet.words();
        let min = if share < 1.0 { [x + share * slot.size()[0] + GAP, y] } else { [x, y + height + 0.5 * GAP] };
        let rest = Rect::between(min, slot.max);
        self.paper.put_block(block, slot.min, 1.0);
        for (figure, at) in pictures(&moment, &stand, (rest, per_sheet)) {
            self.paper.put(figure, at, SCALE);
        }
        Ok(())
    }

    /// The words as `write` sets them, with their slot: the next one, or a whole sheet where they do not fit into that.
    fn place(&mut self, write: impl Fn(PerSheet, [f32; 2]) -> Block) -> Result<(Block, Rect, PerSheet), Error> {
        let chosen = self.options.per_sheet;
        for per_sheet in [chosen, PerSheet::One] {
            let mut slots = per_sheet.slots(Paper::room());
            let size = slots[0].size();
            let block = write(per_sheet, size);
            if block.size[1] > per_sheet.most(size[1]) {
                continue;
            }
            if self.slots.is_empty() || per_sheet != chosen {
                self.paper.begin();
                slots.reverse();
                self.slots = slots;
            }
            if let Some(slot) = self.slots.pop() {
                return Ok((block, slot, per_sheet));
            }
        }
        Err(Error::new("its words do not fit on a sheet of paper; divide them into two pages"))
    }

    /// The sheets.
    pub fn into_sheets(self) -> Vec<Sheet> {
        self.paper.into_sheets()
    }

    /// The sheets as a PDF.
    ///
    /// # Errors
    /// If a part of them cannot be packed.
    pub fn encode(self) -> Result<Vec<u8>, Error> {
        self.paper.encode()
    }
}

/// The words of a page in a slot of this size, with what stands below them.
fn written(
    words: &Words<'_>,
    (moment, name, below): (&Moment, &str, Below),
    per_sheet: PerSheet,
    slot: [f32; 2],
) -> Block {
    let (size, share) = per_sheet.words();
    let width = share * slot[0];
    let mut block = title(words, width, size);
    block.put_below(lay_out(words.prose, width, size, THEME).block, 0.5 * size);
    // Words above a picture leave room for it.
    let kept = if share < 1.0 { LEAST_LEFT } else { LEAST_PICTURE };
    let left = [width, slot[1] - block.size[1] - kept];
    match below {
        Below::Lines => block.put_below(ruled(ANSWER_LINES, width, ANSWER_APART), 0.0),
        Below::Answer => {
            if let Some(answer) = said("Answer: ", moment, (left, size), true) {
                block.put_below(answer, size);
            }
        }
        Below::Step if per_sheet != PerSheet::Four => {
            let name = moment.tiles.first().map_or(name, |tile| &tile.names[0]);
            let words = format!("{name}, step {}: ", moment.cursor);
            if let Some(told) = said(&words, moment, (left, size), false) {
                block.put_below(explanation::rule(width, THEME), 0.8 * size);
                block.put_below(told, 0.5 * size);
            }
        }
        Below::Step => {}
    }
    block
}

/// The sentence of a step behind `words`, in the largest type in which it has room; its first sentence alone where it must be told.
fn said(words: &str, moment: &Moment, ([width, height], size): ([f32; 2], f32), must: bool) -> Option<Block> {
    let step = moment.tiles.first().map_or(&moment.step, |tile| &tile.step);
    let whole = Sentence::default().text(words).then(step.sentence.clone());
    let plain = whole.plain();
    let first = plain.find(". ").map_or(plain.as_str(), |end| &plain[..=end]);
    let set = |sentence: &Sentence, size: f32| {
        explanation::sentence(sentence, (width, Density { words: size, ..Density::close(THEME) }), THEME)
    };
    let sizes = || [size, LEAST_PT].into_iter();
    let brief = Sentence::default().text(first);
    let all = sizes().map(|size| set(&whole, size)).chain(sizes().filter(|_| must).map(|size| set(&brief, size)));
    let all: Vec<Block> = all.collect();
    let fitting = all.iter().position(|block| block.size[1] <= height);
    fitting.or(if must { all.len().checked_sub(1) } else { None }).map(|index| all[index].clone())
}

/// The number and the title of a page.
fn title(words: &Words<'_>, width: f32, size: f32) -> Block {
    let style = Type { face: Face::Bold, size: 1.25 * size, ..Type::text(THEME) };
    let mut block = lines(&format!("{}  {}", words.number[0], words.title), style, width);
    block.size[0] = width;
    block
}

/// Whether a chart has something to compare: a single value of a plot or of a cost surface is nothing but an empty frame.
fn shows(pane: &Pane, step: &Step) -> bool {
    let has_two = |values: &mut dyn Iterator<Item = f32>| values.filter(|value| value.is_finite()).nth(1).is_some();
    match pane.chart {
        Some(Chart::Series) => all_series(step)
            .flat_map(|series| &series.lines)
            .any(|(.., points)| has_two(&mut points.iter().map(|point| point[1]))),
        Some(Chart::Surface) => {
            let surface = find(step, |readout| if let Readout::Surface(all) = readout { Some(all) } else { None });
            surface.is_some_and(|surface| has_two(&mut surface.values.cells().iter().copied()))
        }
        _ => true,
    }
}

/// The pictures of a page as they fit into `room`, and below them its first chart where there is room; each with its place.
fn pictures(moment: &Moment, stand: &Stand<'_>, (room, per_sheet): (Rect, PerSheet)) -> Vec<(Figure, Point)> {
    let (estimator, look) = (stand.estimator(), &stand.look);
    let panes = Selection::default();
    let rendering = Rendering { moment, estimator, look, panes: &panes };
    let [width, height] = room.size().map(|side| (side / SCALE).max(LEAST));
    let step = &moment.step;
    let chart = charts(step, estimator.charts()).into_iter().find(|pane| shows(pane, step));
    let chart = chart.filter(|_| per_sheet != PerSheet::Four);
    let (content, style) =
        (rendering.content(), ChartStyle { theme: THEME, colors: look.colors, density: DENSITY as f32 });
    let share = if chart.is_some() { STAGE_SHARE } else { 1.0 };
    let stage = rendering.stage_in([width, share * height], DENSITY);
    // In the middle of its column.
    let left = room.min[0] + SCALE * ((width - stage.size[0]) / 2.0).max(0.0);
    let taken = stage.size[1];
    let mut all = vec![(stage, [left, room.min[1]])];
    let size = [width - 2.0 * INSET, (height - taken).min(width * CHART_SHAPE)];
    if let Some(pane) = chart.filter(|pane| (pane.room)(content, size, style) >= 1.0) {
        let area = Rect::new([INSET, 0.0], size);
        let (layers, description) = ((pane.draw)(content, area, style), pane.title.to_owned());
        let background = THEME.chrome().panel;
        let figure = Figure { size: [width, size[1]], background, layers, panels: Vec::new(), description };
        all.push((figure, [room.min[0], room.min[1] + SCALE * taken]));
    }
    all
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;
    use motionscope_core::scene::{Role, Series, Surface};

    use super::super::panes::{MATRICES, SERIES, SURFACE};
    use super::*;

    motionscope_core::pseudocode! {
        TEST: "test",
    }

    fn step(readout: Readout) -> Step {
        Step { values: Vec::new(), line: line::TEST, sentence: Sentence::default(), readouts: vec![readout] }
    }

    fn plot(values: &[f32]) -> Step {
        let points = values.iter().zip(1..).map(|(value, number)| [number as f32, *value]).collect();
        step(Readout::Series(Series { lines: vec![("inliers", Role::Best, points)], ..Series::default() }))
    }

    #[test]
    fn a_chart_of_a_single_value_takes_no_room() {
        assert!(!shows(&SERIES, &plot(&[0.0])) && !shows(&SERIES, &plot(&[0.0, f32::NAN])));
        assert!(shows(&SERIES, &plot(&[0.0, 7.0])));
        let costs = |known: usize| {
            let values = Grid::from_fn(3, 3, |x, y| if 3 * y + x < known { 9.0 } else { f32::NAN });
            step(Readout::Surface(Surface::new("SAD", [-1; 2], values, Grid::new(3, 3, None))))
        };
        assert!(!shows(&SURFACE, &costs(1)) && shows(&SURFACE, &costs(2)));
        assert!(shows(&MATRICES, &step(Readout::Matrices(Vec::new()))), "the pane tells whether it has content");
    }
}
