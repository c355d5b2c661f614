//! Sheets of paper, one after the other: margins, a line above and below, and room between them.

use motionscope_core::base::Error;

use crate::paint::charts::explanation::Block;
use crate::paint::charts::{Canvas, Level, Type, shortened};
use crate::paint::primitive::{Anchor, Point, Rect, Run};
use crate::paint::{Color, Face, Figure, Layer, Placed, Primitive, Sheet, Theme, export_sheets, wrap};

/// A4 in points.
const SIZE: [f32; 2] = [595.0, 842.0];
/// What is left at the sides, and above and below.
const MARGIN: [f32; 2] = [40.0, 36.0];
/// Sizes of type of the title, and of what stands around.
const TITLE_PT: f32 = 14.0;
const SMALL_PT: f32 = 8.0;
/// Height of the lines above and below.
const HEAD: f32 = 28.0;
const FOOT: f32 = 20.0;
/// Least distance between two texts on a line.
const APART: f32 = 12.0;

/// The theme of everything that is printed.
pub const THEME: Theme = Theme::Light;

/// What stands around everything on each sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Around {
    /// Upper left.
    pub title: String,
    /// Upper right: what a reader fills in, or what this is.
    pub beside: String,
    /// Lower left.
    pub foot: String,
}

/// Sheets that are being filled.
pub struct Paper {
    around: Around,
    sheets: Vec<Sheet>,
}

impl Paper {
    /// No sheet yet.
    pub fn new(around: Around) -> Self {
        Self { around, sheets: Vec::new() }
    }

    /// The room on each sheet.
    pub fn room() -> Rect {
        let [x, y] = MARGIN;
        Rect::between([x, y + HEAD], [SIZE[0] - x, SIZE[1] - y - FOOT])
    }

    /// Begins a sheet and returns the room on it.
    pub fn begin(&mut self) -> Rect {
        self.sheets.push(Sheet { size: SIZE, figures: Vec::new() });
        Self::room()
    }

    /// Puts `figure` on the last sheet, without its ground: paper is white.
    pub fn put(&mut self, figure: Figure, at: Point, scale: f32) {
        if let Some(sheet) = self.sheets.last_mut() {
            sheet.figures.push(Placed { figure: Figure { background: Color::WHITE, ..figure }, at, scale });
        }
    }

    /// Puts a block on the last sheet.
    pub fn put_block(&mut self, block: Block, at: Point, scale: f32) {
        let Block { size, primitives, lines, .. } = block;
        let description = lines.into_iter().map(|(_, words)| words).collect::<Vec<_>>().join(" ");
        self.put(figure(primitives, size, description), at, scale);
    }

    /// The sheets with what stands around everything.
    pub fn into_sheets(self) -> Vec<Sheet> {
        let Self { around, mut sheets } = self;
        let count = sheets.len();
        for (sheet, number) in sheets.iter_mut().zip(1..) {
            let figure = around.figure([number, count]);
            sheet.figures.insert(0, Placed { figure, at: [0.0; 2], scale: 1.0 });
        }
        sheets
    }

    /// The sheets as a PDF.
    ///
    /// # Errors
    /// If a part of them cannot be packed.
    pub fn encode(self) -> Result<Vec<u8>, Error> {
        let title = self.around.title.clone();
        export_sheets(&title, &self.into_sheets())
    }
}

impl Around {
    fn figure(&self, [number, count]: [usize; 2]) -> Figure {
        let mut canvas = Canvas::default();
        let chrome = THEME.chrome();
        let small = Type { size: SMALL_PT, ..Type::dim(THEME) };
        let title = Type { face: Face::Bold, size: TITLE_PT, color: chrome.text };
        let [left, top] = MARGIN;
        let [right, bottom] = [SIZE[0] - left, SIZE[1] - MARGIN[1]];
        let beside = Type { size: SMALL_PT + 1.0, ..Type::text(THEME) };
        let beside = canvas.text([right, top + TITLE_PT], (Anchor::End, Level::Bottom), &self.beside, beside);
        let room = beside.min[0] - APART - left;
        canvas.text([left, top], (Anchor::Start, Level::Top), &shortened(&self.title, title, room), title);
        canvas.across([left, right], top + HEAD - 8.0, chrome.line);
        canvas.across([left, right], bottom - FOOT + 8.0, chrome.line);
        let place = (Anchor::End, Level::Bottom);
        let number_of = canvas.text([right, bottom], place, &format!("{number} of {count}"), small);
        let room = number_of.min[0] - APART - left;
        canvas.text([left, bottom], (Anchor::Start, Level::Bottom), &shortened(&self.foot, small, room), small);
        figure(canvas.into_primitives(), SIZE, format!("{}, sheet {number} of {count}", self.title))
    }
}

/// A figure of these primitives.
fn figure(primitives: Vec<Primitive>, size: [f32; 2], description: String) -> Figure {
    let layers = vec![Layer { clip: None, primitives }];
    Figure { size, background: Color::WHITE, layers, panels: Vec::new(), description }
}

/// Empty lines to write on, `width` points long, so many points apart.
pub fn ruled(count: usize, width: f32, apart: f32) -> Block {
    let mut canvas = Canvas::default();
    (1..=count).for_each(|line| canvas.across([0.0, width], line as f32 * apart, THEME.chrome().dim));
    Block { size: [width, count as f32 * apart + 1.0], primitives: canvas.into_primitives(), ..Block::default() }
}

/// Words in lines of at most `width` points; a word that is wider is cut short.
pub fn lines(words: &str, style: Type, width: f32) -> Block {
    let mut block = Block::default();
    for runs in wrap(&[Run::new(words, style.color).face(style.face)], style.size, width) {
        let line: String = runs.into_iter().map(|run| run.text).collect();
        // Words together can be measured a hair wider than one by one.
        let line = shortened(&line, style, width + 0.5);
        let mut canvas = Canvas::default();
        let rect = canvas.text([0.0, 0.0], (Anchor::Start, Level::Top), &line, style);
        let primitives = canvas.into_primitives();
        block.put_below(Block { size: rect.size(), primitives, lines: vec![(rect, line)], ..Block::default() }, 0.0);
    }
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What each line of words covers, and what it says.
    fn texts(primitives: &[Primitive]) -> Vec<(Rect, String)> {
        let text = |primitive: &Primitive| match primitive {
            Primitive::Text(line) => {
                let words: String = line.runs.iter().map(|run| run.text.as_str()).collect();
                let [x, y] = line.start();
                Some((Rect::new([x, y - line.size], [line.width(), line.size]), words))
            }
            _ => None,
        };
        primitives.iter().filter_map(text).collect()
    }

    #[test]
    fn what_stands_around_a_sheet_is_cut_to_its_room() {
        let long = "A title of many words ".repeat(20);
        let around = Around { title: long.clone(), beside: "Name ____________________".into(), foot: long };
        let figure = around.figure([1, 2]);
        let all: Vec<_> = figure.layers.iter().flat_map(|layer| texts(&layer.primitives)).collect();
        assert_eq!(all.len(), 4, "{all:?}");
        assert_eq!(all.iter().filter(|(_, words)| words.ends_with('…')).count(), 2, "{all:?}");
        for (i, (rect, words)) in all.iter().enumerate() {
            assert!(rect.min[0] >= MARGIN[0] - 0.1 && rect.max[0] <= SIZE[0] - MARGIN[0] + 0.1, "{words}: {rect:?}");
            assert!(all[..i].iter().all(|(other, _)| !other.meets(rect)), "{words} covers another text");
        }
    }

    #[test]
    fn words_are_broken_into_lines_of_their_room() {
        let style = Type { face: Face::Bold, ..Type::text(THEME) };
        let block = lines("The words of a title that is long, with Donaudampfschifffahrtsgesellschaft", style, 90.0);
        let all = texts(&block.primitives);
        assert!(all.len() > 2 && all.iter().all(|(rect, _)| rect.size()[0] <= 91.0), "{all:?}");
        assert!(all.iter().all(|(rect, _)| rect.max[1] <= block.size[1]), "{all:?}");
        assert!(all.last().is_some_and(|(_, words)| words.ends_with('…')), "a word without room is cut short");
    }
}
