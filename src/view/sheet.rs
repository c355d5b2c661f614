//! A sheet: the panes of a step arranged on one picture, the stage largest.
//!
//! Arrangements are tried in turn; the one with the largest stage in which all panes fit is taken, and the sheet is enlarged if
//! none fits.

use std::collections::BTreeMap;

use motionscope_core::scene::Sentence;

use crate::paint::charts::{Canvas, ChartStyle};
use crate::paint::primitive::Rect;
use crate::paint::{Caption, Extent, Figure, Layer, heading, paragraph};

use super::panes::{EXPLANATION, Pane, PaneContent, STAGE};
use super::rendering::{Around, Rendering};

/// Width and height of a sheet in points, unless its panes need more.
const SIZE: [f32; 2] = [1280.0, 720.0];
/// How much larger a sheet becomes at a time until its panes have room, and how large at most.
const GROWTH: f32 = 1.12;
const LARGEST: f32 = 4.0;
/// Space around everything.
const MARGIN: f32 = 16.0;
/// Between two panes.
const GAP: f32 = 20.0;
/// Shares of the width that panes beside the stage may take.
const BESIDE: [f32; 6] = [0.24, 0.29, 0.34, 0.39, 0.44, 0.5];
/// Shares of the height that panes below the stage may take.
const BELOW: [f32; 5] = [0.3, 0.36, 0.42, 0.48, 0.54];

/// How often the stage is laid out, smaller each time, until it fits.
const ATTEMPTS: usize = 12;
/// The first of these are as large as what stands around the pictures leaves room for.
const MEASURED: usize = 4;
/// How much wider than its pictures a figure may become by rounding, in points.
const ROUNDED: f32 = 4.0;

/// What is arranged.
pub struct Contents<'a> {
    /// What the panes are made of.
    pub content: PaneContent<'a>,
    /// Which, in this order; the stage wherever it stands.
    pub panes: &'a [&'static Pane],
    /// Words above, and below unless there is an explanation.
    pub caption: Caption,
    /// Colors and sizes.
    pub style: ChartStyle,
    /// The pictures, as far as the stage is among the panes.
    pub stage: Pictures<'a>,
}

/// The pictures of a step, as they are laid out in a rectangle.
pub struct Pictures<'a> {
    /// Width and height of all of them in px of the clip.
    pub extent: [f32; 2],
    /// What stands between and around them, in points.
    pub beside: [f32; 2],
    /// The figure at so many points per pixel of the clip.
    pub figure: &'a dyn Fn(f32) -> Figure,
}

impl Pictures<'_> {
    /// The most points per pixel with which they have room, where so many points stand around them.
    fn zoom(&self, size: [f32; 2], around: [f32; 2]) -> f32 {
        let zooms = [0, 1].map(|i| (size[i] - around[i]) / self.extent[i].max(1.0));
        let zoom = zooms[0].min(zooms[1]).max(0.02);
        // Pixels that become whole points are all alike, where little room is lost by that.
        if zoom.floor() >= 0.85 * zoom { zoom.floor() } else { zoom }
    }

    /// The part of a rectangle that they cover, as an area.
    fn covered(&self, size: [f32; 2]) -> f32 {
        let zoom = self.zoom(size, self.beside);
        self.extent[0] * self.extent[1] * zoom * zoom
    }

    /// The figure that has room in `size`, and what it needs of that.
    fn fitting(&self, size: [f32; 2]) -> (Figure, [f32; 2]) {
        let mut around = self.beside;
        let mut zoom = self.zoom(size, around);
        let mut attempt = 1;
        loop {
            let figure = (self.figure)(zoom);
            let taken = figure.size.map(|side| side - 2.0 * MARGIN);
            // A figure is rounded up to whole steps, for which the gap to the next pane has room.
            if (taken[0] <= size[0] + ROUNDED && taken[1] <= size[1]) || attempt == ATTEMPTS {
                return (figure, taken);
            }
            if attempt < MEASURED {
                // A narrower picture may have a longer legend.
                around[1] = taken[1] - self.extent[1] * zoom + 2.0;
                zoom = self.zoom(size, around);
            } else {
                zoom *= 0.85;
            }
            attempt += 1;
        }
    }
}

impl Rendering<'_> {
    /// The panes of the step on one sheet, with the marks that `scale` pixels for each point have room for; where several
    /// steps share a layout, the first of them makes it.
    pub(super) fn sheet(&self, scale: u32, shared: Option<&mut Option<Layout>>) -> Figure {
        let Self { look, panes, .. } = *self;
        let style = ChartStyle { theme: look.theme, colors: look.colors, density: scale as f32 };
        self.with_stage(SIZE[0], scale, |stage| {
            let (content, caption) = (self.content(), self.caption());
            let contents = Contents { content, panes: &panes.panes, caption, style, stage };
            match shared {
                Some(shared) => {
                    shared.get_or_insert_with(|| Layout::of(&contents, Reserve::FOR_OTHERS)).figure(&contents)
                }
                None => Layout::of(&contents, Reserve::NONE).figure(&contents),
            }
        })
    }

    /// The pictures alone, as large as they have room in `size`.
    pub(super) fn stage_in(&self, size: [f32; 2], scale: u32) -> Figure {
        let size = [size[0] - 2.0 * MARGIN - ROUNDED, size[1] - 2.0 * MARGIN];
        self.with_stage(size[0], scale, |stage| stage.fitting(size).0)
    }

    /// What panes are drawn from.
    pub(super) fn content(&self) -> PaneContent<'_> {
        let Self { moment, look, panes, .. } = *self;
        let (info, step, before) = match moment.tiles.first() {
            Some(tile) => (tile.info, &*tile.step, None),
            None => (self.estimator.info(), &*moment.step, moment.before.as_deref()),
        };
        let is_centered = !self.estimator.tests_candidates();
        PaneContent { info, step, before, is_centered, level: look.level, angles: panes.angles }
    }

    /// Hands over the pictures, to be laid out about `width` points wide.
    fn with_stage<T>(&self, width: f32, scale: u32, take: impl FnOnce(Pictures<'_>) -> T) -> T {
        let figure = |zoom: f32| self.figure(Around { zoom, titles: true, caption: None }, scale);
        let view = self.view();
        let Extent { columns, size: extent } = Extent::seen(&self.parts(view), view, self.panes.angles.section);
        // What stands around the pictures, as measured where they have about half of the sheet.
        let zoom = 0.5 * width / extent[0];
        let above = figure(zoom).size[1] - 2.0 * MARGIN - extent[1] * zoom;
        let beside = [8.0 * (columns - 1) as f32, above];
        take(Pictures { extent, beside, figure: &figure })
    }
}

/// Room that is kept for what other steps have more of.
#[derive(Clone, Copy)]
struct Reserve {
    /// Lines that a sentence below the panes has at least.
    lines: usize,
    /// How many times as high as an explanation its pane is.
    explanation: f32,
}

impl Reserve {
    const NONE: Self = Self { lines: 0, explanation: 1.0 };
    const FOR_OTHERS: Self = Self { lines: 3, explanation: 1.2 };
}

/// How large a sheet is, and where its panes stand: steps that share one differ in nothing else.
pub struct Layout {
    size: [f32; 2],
    reserve: Reserve,
    arrangement: Arrangement,
}

/// Where each pane stands, and how good that is.
struct Arrangement {
    stage: Option<Rect>,
    others: Vec<Rect>,
    score: f32,
}

impl Layout {
    /// The best one for `contents`, as large as they need.
    fn of(contents: &Contents<'_>, reserve: Reserve) -> Self {
        let mut memory = Memory { contents, reserve, rooms: BTreeMap::new() };
        let mut factor = 1.0;
        loop {
            let size = SIZE.map(|side| (side * factor / 4.0).round() * 4.0);
            let arrangement = memory.best(Frame::new(contents, size, reserve).body);
            if arrangement.score > 0.0 || factor >= LARGEST {
                return Self { size, reserve, arrangement };
            }
            factor *= GROWTH;
        }
    }

    /// The sheet with `contents`.
    fn figure(&self, contents: &Contents<'_>) -> Figure {
        Frame::new(contents, self.size, self.reserve).figure(contents, &self.arrangement)
    }
}

/// A sheet with its words, and the room that they leave.
struct Frame {
    size: [f32; 2],
    body: Rect,
    words: Vec<Layer>,
}

impl Frame {
    fn new(contents: &Contents<'_>, size: [f32; 2], reserve: Reserve) -> Self {
        let (theme, width) = (contents.style.theme, size[0] - 2.0 * MARGIN);
        let (mut primitives, height) = heading(&contents.caption, ([MARGIN; 2], width), theme);
        let mut body = Rect::new([MARGIN, MARGIN + height + 4.0], [width, size[1] - 2.0 * MARGIN - height - 4.0]);
        // Where nothing else tells why, a sentence does.
        if !contents.panes.contains(&&EXPLANATION) && !contents.caption.sentence.is_empty() {
            let (words, height) = paragraph(&contents.caption.sentence, width, theme);
            let (_, line) = paragraph(&Sentence::default().text("x"), width, theme);
            let height = height.max(reserve.lines as f32 * line);
            body.max[1] -= height + GAP / 2.0;
            let top = [MARGIN, body.max[1] + GAP / 2.0];
            primitives.extend(words.into_iter().map(|primitive| primitive.moved(top)));
        }
        Self { size, body, words: vec![Layer { clip: None, primitives }] }
    }

    fn figure(self, contents: &Contents<'_>, arrangement: &Arrangement) -> Figure {
        let Self { size, words, .. } = self;
        let Contents { content, style, .. } = contents;
        let chrome = style.theme.chrome();
        let mut layers = words;
        let mut said =
            vec![contents.caption.title.clone(), contents.caption.details.clone(), contents.caption.place.clone()];
        if let Some(rect) = arrangement.stage {
            let (stage, taken) = contents.stage.fitting(rect.size());
            // In the middle of what is left.
            let at = [0, 1].map(|i| (rect.min[i] + ((rect.size()[i] - taken[i]) / 2.0).max(0.0) - MARGIN).round());
            layers.extend(stage.layers.into_iter().map(|layer| layer.moved(at)));
            said.push(stage.description);
        }
        let mut rules = Canvas::default();
        for (pane, rect) in others(contents.panes).zip(&arrangement.others) {
            rules.frame(rect.grown(GAP / 2.0 - 2.0), 1.0, chrome.line);
            if (pane.is_available)(content.step) {
                layers.extend((pane.draw)(*content, *rect, *style));
                said.push(pane.title.to_owned());
            } else {
                let words = format!("{}.", pane.absent(content.info.name));
                let words = Sentence::default().text(words);
                let (words, _) = paragraph(&words, rect.size()[0], style.theme);
                let primitives = words.into_iter().map(|primitive| primitive.moved(rect.min)).collect();
                layers.push(Layer { clip: None, primitives });
            }
        }
        layers.splice(0..0, rules.into_layers());
        said.push(contents.caption.sentence.plain());
        said.retain(|words| !words.is_empty());
        Figure { size, background: chrome.panel, layers, panels: Vec::new(), description: said.join(". ") }
    }
}

/// All but the stage.
fn others<'a>(panes: &'a [&'static Pane]) -> impl Iterator<Item = &'static Pane> + 'a {
    panes.iter().copied().filter(|pane| **pane != STAGE)
}

/// What was measured already: many arrangements give a pane the same room.
struct Memory<'a> {
    contents: &'a Contents<'a>,
    reserve: Reserve,
    rooms: BTreeMap<(&'static str, [u32; 2]), f32>,
}

impl Memory<'_> {
    /// The best way to arrange everything in `body`; of equally good ones the first.
    fn best(&mut self, body: Rect) -> Arrangement {
        let panes: Vec<&'static Pane> = others(self.contents.panes).collect();
        let has_stage = self.contents.panes.contains(&&STAGE);
        let all = if has_stage { around_stage(body, &panes) } else { grids(body, panes.len()) };
        let rated = all.into_iter().map(|(stage, others)| {
            let score = self.score(body, stage, (&panes, &others));
            Arrangement { stage, others, score }
        });
        let best = rated.reduce(|best, other| if other.score > best.score { other } else { best });
        best.unwrap_or(Arrangement { stage: has_stage.then_some(body), others: Vec::new(), score: 1.0 })
    }

    /// How good an arrangement is: above 0 only if every pane has room.
    fn score(&mut self, body: Rect, stage: Option<Rect>, (panes, rects): (&[&'static Pane], &[Rect])) -> f32 {
        let rooms: Vec<f32> = panes.iter().zip(rects).map(|(pane, rect)| self.room(pane, rect.size())).collect();
        let least = rooms.iter().copied().fold(f32::INFINITY, f32::min);
        if least < 1.0 {
            return least - 10.0;
        }
        let mean = rooms.iter().map(|room| room.min(1.6)).sum::<f32>() / rooms.len().max(1) as f32;
        let Some(stage) = stage else { return least.min(1.6) + 0.1 * mean };
        let area = |rect: &Rect| rect.size()[0] * rect.size()[1];
        if rects.iter().any(|rect| area(rect) > area(&stage)) {
            return least.min(1.0) - 5.0;
        }
        self.contents.stage.covered(stage.size()) / area(&body) + 0.12 * mean
    }

    fn room(&mut self, pane: &'static Pane, size: [f32; 2]) -> f32 {
        let Contents { content, style, .. } = self.contents;
        let key = (pane.id, size.map(|side| side as u32));
        let reserve = if *pane == EXPLANATION { self.reserve.explanation } else { 1.0 };
        *self.rooms.entry(key).or_insert_with(|| (pane.room)(*content, [size[0], size[1] / reserve], *style))
    }
}

/// Ways to arrange panes beside and below the stage: the explanation and the last charts beside it, the first ones below.
fn around_stage(body: Rect, panes: &[&'static Pane]) -> Vec<(Option<Rect>, Vec<Rect>)> {
    let explained = panes.iter().position(|pane| **pane == EXPLANATION);
    let charts: Vec<usize> = (0..panes.len()).filter(|i| Some(*i) != explained).collect();
    let mut all = Vec::new();
    for below in 0..=charts.len() {
        let (below, beside) = charts.split_at(below);
        for with_explanation in [false, true] {
            let (mut below, mut beside) = (below.to_vec(), beside.to_vec());
            match explained {
                Some(i) if with_explanation => below.push(i),
                Some(i) => beside.insert(0, i),
                None if with_explanation => continue,
                None => {}
            }
            for across in shares(&BESIDE, beside.is_empty()) {
                for down in shares(&BELOW, below.is_empty()) {
                    all.extend(columns(body, (across, &beside), (down, &below), panes));
                }
            }
        }
    }
    all
}

/// What of `all` can be chosen; nothing where there is nothing to be placed.
fn shares(all: &'static [f32], is_empty: bool) -> &'static [f32] {
    if is_empty { &[0.0] } else { all }
}

/// The stage in the upper left corner, a column of panes over the whole height beside it and a row of panes below it; and
/// the same with a row over the whole width.
fn columns(
    body: Rect,
    (across, beside): (&f32, &[usize]),
    (down, below): (&f32, &[usize]),
    panes: &[&'static Pane],
) -> Vec<(Option<Rect>, Vec<Rect>)> {
    let [width, height] = body.size();
    let cut = |share: f32, length: f32| if share > 0.0 { (length * (1.0 - share)).round() } else { length };
    let (right, bottom) = (cut(*across, width), cut(*down, height));
    let gap = |share: &f32| if *share > 0.0 { GAP } else { 0.0 };
    let stage = Rect::new(body.min, [right - gap(across), bottom - gap(down)]);
    let corner = [body.min[0] + right, body.min[1] + bottom];
    let ways = [
        (
            Rect { min: [corner[0], body.min[1]], max: body.max },
            Rect { min: [body.min[0], corner[1]], max: [stage.max[0], body.max[1]] },
        ),
        (
            Rect { min: [corner[0], body.min[1]], max: [body.max[0], stage.max[1]] },
            Rect { min: [body.min[0], corner[1]], max: body.max },
        ),
    ];
    let place = |(column, row): (Rect, Rect)| {
        let mut rects = vec![Rect::new([0.0; 2], [0.0; 2]); panes.len()];
        beside.iter().zip(split(column, beside.len(), 1)).for_each(|(i, rect)| rects[*i] = rect);
        below.iter().zip(split(row, below.len(), 0)).for_each(|(i, rect)| rects[*i] = rect);
        (Some(stage), rects)
    };
    ways.map(place).to_vec()
}

/// `count` equal parts of a rectangle along x or y.
fn split(rect: Rect, count: usize, along: usize) -> Vec<Rect> {
    let mut size = rect.size();
    size[along] = (size[along] - GAP * count.saturating_sub(1) as f32) / count.max(1) as f32;
    let part = |i: usize| {
        let mut min = rect.min;
        min[along] = (min[along] + i as f32 * (size[along] + GAP)).round();
        Rect::new(min, size)
    };
    (0..count).map(part).collect()
}

/// Panes without a stage, in equal columns.
fn grids(body: Rect, count: usize) -> Vec<(Option<Rect>, Vec<Rect>)> {
    let grid = |columns: usize| {
        let rows = split(body, count.div_ceil(columns), 1);
        let cells = rows.into_iter().flat_map(|row| split(row, columns, 0)).take(count).collect();
        (None, cells)
    };
    (1..=count).map(grid).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use motionscope_core::data::Frame;
    use motionscope_core::geometry::Grid;
    use motionscope_core::scene::{Picture, Scene};

    use super::super::panes::{MATRICES, SERIES, TILES};
    use super::*;
    use crate::paint::{FigureOptions, Part, Primitive, View};

    fn frame(width: usize, height: usize) -> Arc<Frame> {
        Arc::new(Frame::gray(Grid::new(width, height, 90)))
    }

    #[test]
    fn no_two_panes_of_an_arrangement_overlap() {
        let body = Rect::new([16.0, 60.0], [1248.0, 640.0]);
        let panes = [&EXPLANATION, &SERIES, &MATRICES, &TILES];
        for count in 0..=panes.len() {
            let all = [around_stage(body, &panes[..count]), grids(body, count)].concat();
            for (stage, others) in all {
                let rects: Vec<Rect> = stage.into_iter().chain(others).collect();
                for (i, rect) in rects.iter().enumerate() {
                    assert!((0..2).all(|c| body.min[c] - 1.0 <= rect.min[c] && rect.max[c] <= body.max[c] + 1.0));
                    let other = rects[..i].iter().find(|other| other.meets(&rect.grown(GAP / 2.0 - 2.0)));
                    assert_eq!(other, None, "{rect:?}");
                }
            }
        }
    }

    #[test]
    fn pictures_larger_than_the_frames_stay_in_the_stage() {
        let [mosaic, warped] = [frame(700, 410), frame(500, 900)];
        let beside = [(Picture::CURRENT, frame(320, 240)), (Picture::NEXT, frame(320, 240))];
        let scene = Scene::default();
        for large in [vec![mosaic.clone()], vec![warped.clone()], vec![mosaic, warped]] {
            let names = [Picture::PREVIOUS, Picture::REFERENCE];
            let beside = beside.iter().cloned().chain(names.into_iter().zip(large)).collect();
            let pictures =
                crate::paint::Pictures { beside, ..crate::paint::Pictures::of([frame(320, 240), frame(320, 240)]) };
            let parts = [Part { pictures, scene: &scene, rises: None, heading: None }];
            let figure = |zoom: f32| {
                let options = FigureOptions { view: View::SideBySide, zoom, titles: true, ..FigureOptions::default() };
                Figure::of(&parts, &scene, &options)
            };
            let Extent { columns, size: extent } = Extent::of(&parts, View::SideBySide);
            let stage = Pictures { extent, beside: [8.0 * (columns - 1) as f32, 30.0], figure: &figure };
            for size in [[640.0, 300.0], [900.0, 420.0], [620.0, 640.0]] {
                let (figure, taken) = stage.fitting(size);
                assert!(taken[0] <= size[0] + ROUNDED && taken[1] <= size[1], "{taken:?} in {size:?}");
                for primitive in figure.layers.iter().flat_map(|layer| &layer.primitives) {
                    let Primitive::Image { rect, .. } = primitive else { continue };
                    let is_inside = (0..2).all(|i| rect.max[i] <= MARGIN + size[i] + ROUNDED);
                    assert!(is_inside, "{rect:?} in {size:?}");
                }
            }
        }
    }
}
