//! The explanation of a step: why it happened, in words, in symbols, in numbers and in the algorithm's own lines.

use std::ops::Range;

use motionscope_core::course::glossary::{Term, occurrences};
use motionscope_core::run::Info;
use motionscope_core::scene::pseudocode as code;
use motionscope_core::scene::{Fact, Math, Role, Sentence, Step, Variable};

use super::super::legend::{self, SWATCH, Sample};
use super::super::marks::own_color;
use super::super::primitive::{Anchor, Point, Primitive, Rect, Run};
use super::super::{Chrome, Face, Theme, fonts, wrap};
use super::canvas::{Canvas, Level, Type, solid};
use super::changes::{self, Since};
use super::formula;
use super::{ChartStyle, Drawing, tiles};

/// Between two parts, in points.
const GAP: f32 = 8.0;
/// Above and below all lines of code.
const BOX: f32 = 8.0;
/// Above and below a line of code.
const CODE_MARGIN: f32 = 3.0;
/// Thickness of the line below a number that is lit, in points.
const LIT_PT: f32 = 2.0;
/// Fewest lines of code that are shown where there is little room.
const FEWEST_LINES: usize = 5;

/// What is explained.
#[derive(Clone, Copy)]
pub struct Explained<'a> {
    /// The estimator.
    pub info: &'a Info,
    /// What the cursor tells.
    pub step: &'a Step,
    /// What the step before told: numbers that differ from it are lit.
    pub before: Option<&'a Step>,
}

/// A part of an explanation, laid out from the origin on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Width and height.
    pub size: [f32; 2],
    /// Back to front.
    pub primitives: Vec<Primitive>,
    /// Its lines: where each is and what it says.
    pub lines: Vec<(Rect, String)>,
    /// Where terms of the glossary stand; one that is broken over two lines is there twice.
    pub terms: Vec<(Rect, &'static Term)>,
    /// Where symbols stand in formulas, in plain letters; one with an index comes before its letter.
    pub symbols: Vec<(Rect, String)>,
    /// Where words and numbers stand in the colour of a role; what is broken over two lines is there twice.
    pub roles: Vec<(Rect, Role)>,
    /// Where values stand; one that is broken over two lines is there twice.
    pub values: Vec<(Rect, &'static Variable)>,
}

impl Block {
    /// The same block elsewhere.
    #[must_use]
    pub fn moved(self, by: Point) -> Self {
        let Self { size, primitives, lines, terms, symbols, roles, values } = self;
        Self {
            size,
            primitives: primitives.into_iter().map(|primitive| primitive.moved(by)).collect(),
            lines: lines.into_iter().map(|(rect, words)| (rect.moved(by), words)).collect(),
            terms: terms.into_iter().map(|(rect, term)| (rect.moved(by), term)).collect(),
            symbols: symbols.into_iter().map(|(rect, name)| (rect.moved(by), name)).collect(),
            roles: roles.into_iter().map(|(rect, role)| (rect.moved(by), role)).collect(),
            values: values.into_iter().map(|(rect, of)| (rect.moved(by), of)).collect(),
        }
    }

    /// Puts `other` below, `gap` points further down.
    pub fn put_below(&mut self, other: Block, gap: f32) {
        if other.size[1] <= 0.0 {
            return;
        }
        let down = if self.size[1] > 0.0 { self.size[1] + gap } else { 0.0 };
        let Block { size, primitives, lines, terms, symbols, roles, values } = other.moved([0.0, down]);
        self.size = [self.size[0].max(size[0]), down + size[1]];
        self.primitives.extend(primitives);
        self.lines.extend(lines);
        self.terms.extend(terms);
        self.symbols.extend(symbols);
        self.roles.extend(roles);
        self.values.extend(values);
    }
}

/// A run of words on a line: its bytes in the whole text, and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Set {
    bytes: Range<usize>,
    run: Run,
    size: f32,
    rect: Rect,
}

/// What `lines` of words cover of the `text` that they were made of by wrapping: each line has its left end and the top and
/// bottom of its rectangle.
fn set(text: &str, lines: &[(Vec<Run>, Point, f32)], size: f32) -> Vec<Set> {
    let mut all = Vec::new();
    let mut end = 0;
    for (runs, [left, top], height) in lines {
        let mut x = *left;
        for run in runs {
            // Only spaces are left out between two lines.
            let Some(skipped) = text[end..].find(run.text.as_str()) else { continue };
            let start = end + skipped;
            end = start + run.text.len();
            let width = fonts::width(&run.text, run.face, size);
            all.push(Set { bytes: start..end, run: run.clone(), size, rect: Rect::new([x, *top], [width, *height]) });
            x += width;
        }
    }
    all
}

/// The rectangles of a range of bytes, one for each line that it is on.
pub(super) fn rects(all: &[Set], range: &Range<usize>) -> Vec<Rect> {
    let mut found: Vec<Rect> = Vec::new();
    for Set { bytes, run, size, rect } in all {
        let (from, to) = (range.start.max(bytes.start), range.end.min(bytes.end));
        if from >= to {
            continue;
        }
        let x = |byte: usize| rect.min[0] + fonts::width(&run.text[..byte - bytes.start], run.face, *size);
        let part = Rect::between([x(from), rect.min[1]], [x(to), rect.max[1]]);
        match found.last_mut() {
            Some(last) if last.min[1] == part.min[1] => last.max[0] = part.max[0],
            _ => found.push(part),
        }
    }
    found
}

/// Where the terms of a text stand.
fn terms(text: &str, all: &[Set]) -> Vec<(Rect, &'static Term)> {
    let of = |(range, term): (Range<usize>, _)| rects(all, &range).into_iter().map(move |rect| (rect, term));
    occurrences(text).into_iter().flat_map(of).collect()
}

/// How close things stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// From one line of the sentence to the next, in sizes of its type.
    pub leading: f32,
    /// Above and below a row of the table, in points.
    pub row: f32,
    /// Type of the formula, in points.
    pub math: f32,
    /// Type of the sentence, in points.
    pub words: f32,
}

impl Density {
    /// With room to spare.
    pub fn roomy(theme: Theme) -> Self {
        Self { leading: 1.45, row: 4.0, math: theme.sizes().heading, words: theme.sizes().heading + 2.0 }
    }

    /// With little room.
    pub fn close(theme: Theme) -> Self {
        Self { leading: 1.35, row: 2.5, math: theme.sizes().body, words: theme.sizes().heading + 2.0 }
    }

    /// For a class, in type of `type_pt` points.
    pub fn strip(type_pt: f32, theme: Theme) -> Self {
        Self { leading: 1.25, words: type_pt, math: type_pt, ..Self::close(theme) }
    }
}

/// How a line of code stands to the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// The step is at it.
    AtWork,
    /// It is the head of a loop or a condition that the step is in.
    Around,
    /// Neither.
    Other,
}

/// Lays everything out from the upper left corner of `area` on. Where there is little height, only the code around the line
/// at work is shown.
pub fn draw(data: Explained<'_>, area: Rect, style: ChartStyle) -> Drawing<[f32; 2]> {
    let [width, height] = area.size();
    let whole = description(data, width, style.theme, data.info.pseudocode.len());
    let shown = if whole.size[1] <= height { whole } else { fitting(data, [width, height], style.theme) };
    let Block { size, primitives, .. } = shown.moved(area.min);
    Drawing { place: size, body: vec![super::Layer { clip: None, primitives }], head: Vec::new() }
}

/// Least height in which it can be laid out at a width, and the height that it has with nothing left out.
pub fn heights(data: Explained<'_>, width: f32, style: ChartStyle) -> [f32; 2] {
    let lines = data.info.pseudocode.len();
    [lines.min(FEWEST_LINES), lines].map(|lines| description(data, width, style.theme, lines).size[1])
}

/// As many lines of code as fit.
fn fitting(data: Explained<'_>, [width, height]: [f32; 2], theme: Theme) -> Block {
    let all = data.info.pseudocode.len();
    let counts = (all.min(FEWEST_LINES)..all).rev();
    let mut blocks = counts.map(|lines| description(data, width, theme, lines));
    blocks
        .find(|block| block.size[1] <= height)
        .unwrap_or_else(|| description(data, width, theme, all.min(FEWEST_LINES)))
}

/// Everything, with so many lines of code around the one at work.
fn description(Explained { info, step, before }: Explained<'_>, width: f32, theme: Theme, lines: usize) -> Block {
    let density = Density::close(theme);
    let mut whole = sentence(&step.sentence, (width, density), theme);
    let facts = Since { now: step.facts(), before: before.map_or(&[], Step::facts) };
    let formulas = Since { now: step.formulas(), before: before.map_or(&[], Step::formulas) };
    if !formulas.now.is_empty() {
        whole.put_below(rule(width, theme), GAP);
        whole.put_below(equation(formulas, (width, density), theme), GAP);
    }
    if !facts.now.is_empty() {
        whole.put_below(rule(width, theme), GAP);
        whole.put_below(table(facts, (width, density), theme), GAP);
    }
    let at_work = info.line(step.line).unwrap_or(0);
    let first = at_work.saturating_sub(lines / 2).min(info.pseudocode.len() - lines);
    whole.put_below(name(info, theme), 1.5 * GAP);
    whole.put_below(pseudocode(info, step, (first..first + lines, width), theme), 0.5 * GAP);
    whole.put_below(citation(info.source, width, theme), GAP);
    whole
}

/// A thin line between two parts.
pub fn rule(width: f32, theme: Theme) -> Block {
    let mut canvas = Canvas::default();
    canvas.across([0.0, width], 0.0, theme.chrome().line);
    Block { size: [width, 1.0], primitives: canvas.into_primitives(), ..Block::default() }
}

/// A sentence, its role words in a legible shade of the role's color and underlined as its lines are drawn on a panel.
pub fn sentence(sentence: &Sentence, (width, density): (f32, Density), theme: Theme) -> Block {
    let run = |(words, role): &(String, Option<_>)| match *role {
        None => Run::new(words, theme.chrome().text),
        Some(role) => Run::new(words, theme.word(role)).underlined(theme.stroke(role)),
    };
    let all_words: Vec<_> = sentence.words().collect();
    let runs: Vec<_> = all_words.iter().map(run).collect();
    let (mut block, all) = words(&runs, width, density);
    let mut end = 0;
    for ((words, role), of) in all_words.iter().zip(sentence.variables()) {
        let start = end;
        end += words.len();
        let places = rects(&all, &(start..end));
        block.roles.extend(role.iter().flat_map(|role| places.iter().map(|rect| (*rect, *role))));
        block.values.extend(of.iter().flat_map(|of| places.iter().map(|rect| (*rect, *of))));
    }
    block.lines = vec![(Rect::new([0.0; 2], block.size), sentence.plain())];
    block
}

/// Runs of words in lines of at most `width` points, the terms among them, and where each run stands.
pub(super) fn words(runs: &[Run], width: f32, density: Density) -> (Block, Vec<Set>) {
    let size = density.words;
    let height = (density.leading * size).round();
    let mut block = Block::default();
    let mut lines = Vec::new();
    for (i, runs) in wrap(runs, size, width).into_iter().enumerate() {
        let top = i as f32 * height + (height - 1.2 * size) / 2.0;
        lines.push((runs.clone(), [0.0, top], 1.2 * size));
        let at = [0.0, i as f32 * height + (height - size) / 2.0 + 0.86 * size];
        let line = super::super::primitive::Line { at, anchor: Anchor::Start, size, runs, halo: None };
        block.size = [block.size[0].max(line.width()), (i + 1) as f32 * height];
        block.primitives.push(Primitive::Text(line));
    }
    let text: String = runs.iter().map(|run| run.text.as_str()).collect();
    let all = set(&text, &lines, size);
    block.terms = terms(&text, &all);
    block.lines = vec![(Rect::new([0.0; 2], block.size), text)];
    (block, all)
}

/// Formulas below each other; values that differ from those of the formulas before are lit.
pub fn equation<'a>(formulas: impl Into<Since<'a, Math>>, (width, density): (f32, Density), theme: Theme) -> Block {
    let mut block = Block::default();
    let Since { now, before } = formulas.into();
    let set: Vec<_> = now.iter().map(|math| formula::typeset(math, density.math, width)).collect();
    let lit = changes::of_formulas(&set, before);
    for ((math, formula), lit) in now.iter().zip(&set).zip(&lit) {
        let (size, down) = (formula.size(), [0.0, formula.ascent]);
        let lines = vec![(Rect::new([0.0; 2], size), math.plain())];
        let symbols = formula.symbols.iter().map(|(rect, name)| (rect.moved(down), name.clone())).collect();
        let roles = formula.roles().map(|(rect, role)| (rect.moved(down), role)).collect();
        let values = formula.values.iter().map(|value| (value.rect.moved(down), value.of)).collect();
        let mut canvas = Canvas::default();
        canvas.extend(formula.primitives([0.0; 2], theme));
        lit.iter().for_each(|rect| light(&mut canvas, rect.moved(down), theme));
        let primitives = canvas.into_primitives();
        block.put_below(Block { size, primitives, lines, symbols, roles, values, ..Block::default() }, 5.0);
    }
    block
}

/// A line below what has changed: on a filled ground, the colours of roles could hardly be read.
fn light(canvas: &mut Canvas, Rect { min: [left, _], max: [right, bottom] }: Rect, theme: Theme) {
    let y = bottom - LIT_PT / 2.0;
    canvas.line(vec![[left, y], [right, y]], false, solid(LIT_PT, theme.chrome().accent));
}

/// Labels left, values right; those that differ from the fact of the same name before are lit.
pub fn table<'a>(facts: impl Into<Since<'a, Fact>>, (width, density): (f32, Density), theme: Theme) -> Block {
    let mut block = Block::default();
    let facts = facts.into();
    for (i, (fact, is_lit)) in facts.now.iter().zip(changes::of_facts(facts)).enumerate() {
        let layout = RowLayout { width, margin: density.row, is_ruled: i > 0, is_lit };
        block.put_below(row(fact, layout, theme), 0.0);
    }
    block
}

/// The width of a row of the table, its margin above and below, whether it stands under a line, and whether its value is lit.
struct RowLayout {
    width: f32,
    margin: f32,
    is_ruled: bool,
    is_lit: bool,
}

fn row(fact: &Fact, RowLayout { width, margin, is_ruled, is_lit }: RowLayout, theme: Theme) -> Block {
    let Chrome { text, dim, line, .. } = theme.chrome();
    let size = theme.sizes().body;
    let style = Type { face: Face::Sans, size, color: dim };
    let height = (1.25 * size).round();
    let left = SWATCH[0] + 8.0;
    let values = wrap(&[Run::new(&fact.value, text)], size, width - left);
    // A long value stands under its label.
    let value = values.first().map_or(0.0, |runs| runs.iter().map(|run| fonts::width(&run.text, run.face, size)).sum());
    let beside = values.len() < 2 && left + style.width(fact.label) + 12.0 + value <= width;
    let mut canvas = Canvas::default();
    if is_ruled {
        canvas.across([0.0, width], 0.0, line);
    }
    let place = Level::Middle;
    let middle = margin + height / 2.0;
    if let Some(role) = fact.role {
        let at = [0.0, (middle - SWATCH[1] / 2.0).round()];
        canvas.extend(match fact.of {
            Some(identity) => legend::swatch_of(&[own_color(identity)], (role, Sample::Area), theme, at),
            None => tiles::swatch(role, theme, at),
        });
    }
    let labels = wrap(&[Run::new(fact.label, dim)], size, width - left);
    for (i, runs) in labels.iter().enumerate() {
        let words: String = runs.iter().map(|run| run.text.as_str()).collect();
        canvas.text([left, middle + i as f32 * height], (Anchor::Start, place), &words, style);
    }
    let first = if beside { 0 } else { labels.len() };
    let rows = values.len().max(1) + first;
    for (i, runs) in values.into_iter().enumerate() {
        let words: String = runs.into_iter().map(|run| run.text).collect();
        let y = middle + (first + i) as f32 * height;
        if is_lit {
            let value = [style.width(&words), height - 2.0];
            light(&mut canvas, Rect::new([width - value[0], y - value[1] / 2.0], value), theme);
        }
        canvas.text([width, y], (Anchor::End, place), &words, style.color(text));
    }
    let size = [width, rows as f32 * height + 2.0 * margin];
    let lines = vec![(Rect::new([0.0; 2], size), format!("{}: {}", fact.label, fact.value))];
    let label = [(vec![Run::new(fact.label, dim)], [left, middle - 0.6 * style.size], 1.2 * style.size)];
    let terms = terms(fact.label, &set(fact.label, &label, style.size));
    let roles = fact.role.map(|role| (Rect::new([0.0; 2], size), role)).into_iter().collect();
    Block { size, primitives: canvas.into_primitives(), lines, terms, roles, ..Block::default() }
}

/// The algorithm's name.
pub fn name(info: &Info, theme: Theme) -> Block {
    let style = Type::dim(theme);
    let height = (1.3 * style.size).round();
    let mut canvas = Canvas::default();
    let rect = canvas.text([0.0, height / 2.0], (Anchor::Start, Level::Middle), info.name, style);
    let size = [rect.size()[0], height];
    let lines = vec![(Rect::new([0.0; 2], size), info.name.into())];
    Block { size, primitives: canvas.into_primitives(), lines, ..Block::default() }
}

/// Some of the algorithm's lines in their box.
pub fn pseudocode(info: &Info, step: &Step, (shown, width): (std::ops::Range<usize>, f32), theme: Theme) -> Block {
    let chrome = theme.chrome();
    let at_work = info.line(step.line);
    let around: Vec<usize> = at_work.into_iter().flat_map(|line| code::around(info.pseudocode, line)).collect();
    let light = |line: usize| match line {
        line if at_work == Some(line) => Light::AtWork,
        line if around.contains(&line) => Light::Around,
        _ => Light::Other,
    };
    let mut lines = Block { size: [width, BOX], ..Block::default() };
    // What is left out before and after is seen to be missing.
    let left_out = || code_line("…", Light::Other, width, theme);
    if shown.start > 0 {
        lines.put_below(left_out(), 0.0);
    }
    for i in shown.clone() {
        lines.put_below(code_line(info.pseudocode[i].text, light(i), width, theme), 0.0);
    }
    if shown.end < info.pseudocode.len() {
        lines.put_below(left_out(), 0.0);
    }
    lines.size[1] += BOX;
    let mut canvas = Canvas::default();
    canvas.fill(Rect::new([0.0; 2], [width, lines.size[1]]), chrome.raised);
    canvas.extend(lines.primitives);
    Block { primitives: canvas.into_primitives(), ..lines }
}

/// A line of code; the one at work is lit, with an arrow before it.
pub fn code_line(text: &str, light: Light, width: f32, theme: Theme) -> Block {
    let chrome = theme.chrome();
    let size = theme.sizes().mono;
    let height = (1.32 * size).round();
    let indent = 1.8 * size + (text.len() - text.trim_start().len()) as f32 * 0.6 * size;
    let color = if light == Light::Other { chrome.text.mix(chrome.raised, 0.25) } else { chrome.text };
    let style = Type { face: Face::Mono, size, color };
    let room = (width - indent - 8.0).max(8.0 * size);
    let words = text.trim_start();
    let rows = wrap(&[Run::new(words, color).face(Face::Mono)], size, room);
    let block = [width, rows.len().max(1) as f32 * height + 2.0 * CODE_MARGIN];
    let rect = Rect::new([0.0; 2], block);
    let mut canvas = Canvas::default();
    if light == Light::AtWork {
        canvas.fill(rect, chrome.selection);
        let (x, y, half) = (0.5 * size, CODE_MARGIN + height / 2.0, 0.36 * size);
        let points = vec![[x, y - half], [x + 1.7 * half, y], [x, y + half]];
        canvas.add(Primitive::Polygon { points, color: chrome.accent });
    }
    for (i, runs) in rows.into_iter().enumerate() {
        let words: String = runs.into_iter().map(|run| run.text).collect();
        let y = CODE_MARGIN + (i as f32 + 0.5) * height;
        canvas.text([indent, y], (Anchor::Start, Level::Middle), &words, style);
    }
    let said = format!("{}{words}", if light == Light::AtWork { "current line: " } else { "" });
    Block { size: block, primitives: canvas.into_primitives(), lines: vec![(rect, said)], ..Block::default() }
}

/// Where the algorithm is from.
pub fn citation(source: &str, width: f32, theme: Theme) -> Block {
    let style = Type::dim(theme);
    let height = (1.3 * style.size).round();
    let mut block = Block::default();
    for runs in wrap(&[Run::new(source, style.color)], style.size, width) {
        let words: String = runs.into_iter().map(|run| run.text).collect();
        let mut canvas = Canvas::default();
        let rect = canvas.text([0.0, height / 2.0], (Anchor::Start, Level::Middle), &words, style);
        let size = [rect.size()[0], height];
        let lines = vec![(Rect::new([0.0; 2], size), words)];
        block.put_below(Block { size, primitives: canvas.into_primitives(), lines, ..Block::default() }, 0.0);
    }
    block
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::estimator;
    use motionscope_core::scene::{Readout, Role, Unit};

    use super::super::super::ColorMap;
    use super::super::texts;
    use super::*;

    motionscope_core::variables! {
        /// The cost of the candidate.
        COST: "SAD", "c", Unit::WHOLE;
        /// The lowest cost.
        LOWEST: "Best so far", "m", Unit::WHOLE;
    }

    fn step(line: motionscope_core::scene::pseudocode::Name) -> Step {
        let facts = vec![
            Fact::new("Best so far", "812 at (−3, 2)", Some(Role::Best)),
            Fact::new("Where", "a value that is so long that it finds room only below what it is a value of", None),
        ];
        let sentence = Sentence::default().text("Candidate ").ink(Role::Candidate, "(−3, 2)").text(" costs 812.");
        let formula = Math::Row(vec![Math::text("SAD"), Math::text(" = "), Math::ink(Role::Candidate, "812")]);
        Step {
            values: Vec::new(),
            line,
            sentence,
            readouts: vec![Readout::Facts(facts), Readout::Equation(vec![formula])],
        }
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn every_word_is_there_and_the_line_at_work_is_lit() {
        let estimator = estimator("full-search").expect("it is registered");
        let info = estimator.info();
        let line = &info.pseudocode[3];
        let step = step(line.name);
        let area = Rect::new([10.0, 20.0], [320.0, 2000.0]);
        let drawing = draw(Explained { info, step: &step, before: None }, area, style());
        let primitives: Vec<_> = drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect();
        let said = texts(&primitives).join(" ");
        for words in ["Candidate (−3, 2) costs 812.", "Best so far", "812 at (−3, 2)", "SAD", info.name] {
            assert!(said.contains(words), "{words} is missing in {said}");
        }
        for line in info.pseudocode {
            line.text.split_whitespace().for_each(|word| assert!(said.contains(word), "{word} is missing"));
        }
        let lit = Theme::Dark.chrome().selection;
        let lit = primitives.iter().filter(|p| matches!(p, Primitive::Polygon { color, .. } if *color == lit)).count();
        assert_eq!(lit, 1);
        for primitive in &primitives {
            let Rect { min, max } = primitive.bounds().grown(-6.0);
            assert!(area.min[0] <= min[0] + 3.0 && max[0] <= area.max[0] + 3.0, "{primitive:?} sticks out");
        }
    }

    #[test]
    fn where_there_is_little_height_the_code_around_the_line_at_work_is_shown() {
        let estimator = estimator("full-search").expect("it is registered");
        let info = estimator.info();
        let last = &info.pseudocode[info.pseudocode.len() - 1];
        let step = step(last.name);
        let data = Explained { info, step: &step, before: None };
        let [least, whole] = heights(data, 320.0, style());
        assert!(least < whole);
        let drawing = draw(data, Rect::new([0.0; 2], [320.0, least]), style());
        assert!(drawing.place[1] <= least);
        let primitives: Vec<_> = drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect();
        let said = texts(&primitives).join(" ");
        let word = |text: &str| text.split_whitespace().max_by_key(|word| word.len()).map(str::to_owned);
        assert!(said.contains(&word(last.text).expect("a word")), "{said}");
    }

    #[test]
    fn terms_of_a_sentence_tell_where_they_stand() {
        let words = Sentence::default()
            .text("Both eigenvalues of the ")
            .ink(Role::Reference, "structure")
            .text(" tensor are large, so this is a corner.");
        let density = Density::close(Theme::Dark);
        let wide = sentence(&words, (2000.0, density), Theme::Dark);
        let names: Vec<_> = wide.terms.iter().map(|(_, term)| term.name).collect();
        assert_eq!(names, ["eigenvalue", "structure tensor", "corner"]);
        // The run before a term ends where the term begins, whatever the colors in it.
        let size = Theme::Dark.sizes().heading + 2.0;
        let from = fonts::width("Both ", Face::Sans, size);
        let to = fonts::width("Both eigenvalues", Face::Sans, size);
        let rect = wide.terms[0].0;
        assert!((rect.min[0] - from).abs() < 0.1 && (rect.max[0] - to).abs() < 0.1, "{rect:?}");
        assert!(rect.min[1] >= 0.0 && rect.max[1] <= wide.size[1]);
        // A term that is broken over two lines stands on both.
        let broken = (80..2000).step_by(8).find_map(|width| {
            let block = sentence(&words, (width as f32, density), Theme::Dark);
            let of_tensor: Vec<_> = block.terms.iter().filter(|(_, t)| t.name == "structure tensor").collect();
            (of_tensor.len() == 2).then(|| (of_tensor[0].0, of_tensor[1].0))
        });
        let (first, second) = broken.expect("some width parts the two words");
        assert!(second.min[1] > first.min[1] && second.min[0] == 0.0, "{first:?} {second:?}");
    }

    #[test]
    fn words_and_numbers_in_the_colour_of_a_role_tell_where_they_stand() {
        let line = estimator("full-search").expect("it is registered").info().pseudocode[0].name;
        let Step { sentence: words, readouts, .. } = step(line);
        let density = Density::close(Theme::Dark);
        let block = sentence(&words, (400.0, density), Theme::Dark);
        let [(rect, role)] = block.roles[..] else { panic!("{:?}", block.roles) };
        let from = fonts::width("Candidate ", Face::Sans, density.words);
        assert!(role == Role::Candidate && (rect.min[0] - from).abs() < 0.1, "{rect:?}");
        let Readout::Equation(formula) = &readouts[1] else { panic!("a formula") };
        let block = equation(&formula[..], (400.0, density), Theme::Dark);
        assert!(matches!(block.roles[..], [(rect, Role::Candidate)] if rect.min[0] > 20.0), "{:?}", block.roles);
        let block = table(step(line).facts(), (400.0, density), Theme::Dark);
        assert!(matches!(block.roles[..], [(_, Role::Best)]), "{:?}", block.roles);
    }

    #[test]
    fn a_number_that_differs_from_the_step_before_is_lit() {
        let row = |cost: i32| {
            let step = Step::at(motionscope_core::scene::pseudocode::Name::new(b"test"));
            step.put(value::COST, cost).put(value::LOWEST, 900).formula("{cost} < {lowest}").formulas().to_vec()
        };
        let facts = |value: &str| [Fact::new("Candidate", value, None), Fact::new("Best so far", "812", None)];
        let (layout, theme) = ((400.0, Density::close(Theme::Dark)), Theme::Dark);
        let lit = |block: &Block| {
            let accent = theme.chrome().accent;
            // A line below the number, and no box around it.
            let is_lit = |p: &&Primitive| matches!(p, Primitive::Polyline { closed: false, stroke, .. } if stroke.color == accent);
            block.primitives.iter().filter(is_lit).count()
        };
        let (now, before) = (row(950), row(812));
        assert_eq!(lit(&equation(Since { now: &now, before: &before }, layout, theme)), 1);
        assert_eq!(lit(&equation(&now, layout, theme)), 0);
        let (now, before) = (facts("950"), facts("812"));
        assert_eq!(lit(&table(Since { now: &now, before: &before }, layout, theme)), 1);
        assert_eq!(lit(&table(&now, layout, theme)), 0);
    }

    #[test]
    fn the_key_of_an_object_has_its_colour() {
        let facts = [Fact::new("Segment", "3: still", Some(Role::Result)).of(3), Fact::new("Segments", "1", None)];
        let block = table(&facts, (320.0, Density::close(Theme::Dark)), Theme::Dark);
        let own = own_color(3).0;
        let is_own = |p: &&Primitive| matches!(p, Primitive::Polygon { color, .. } if color.0[..3] == own[..3]);
        assert_eq!(block.primitives.iter().filter(is_own).count(), 1);
    }

    #[test]
    fn labels_and_symbols_tell_where_they_stand() {
        let facts = [Fact::new("Search window", "±16 px", None)];
        let density = Density::close(Theme::Dark);
        let block = table(&facts, (320.0, density), Theme::Dark);
        assert!(block.terms.len() == 1 && block.terms[0].0.min[0] > 0.0, "{:?}", block.terms);
        let formula = Math::Row(vec![Math::Var("u"), Math::text(" = "), Math::mean(Math::Var("u"))]);
        let block = equation(&[formula.clone(), formula], (320.0, density), Theme::Dark);
        let names: Vec<_> = block.symbols.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(names, ["u", "u\u{304}", "u", "u", "u\u{304}", "u"]);
        assert!(block.symbols[3].0.min[1] > block.symbols[0].0.max[1]);
    }
}
