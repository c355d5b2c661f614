//! The explanation in the window: what stays in sight, what is scrolled, and what each line is called.

use std::sync::Arc;

use eframe::egui::{self, Painter, Rect, Sense, Shape, Ui, Vec2, vec2};
use motionscope_core::run::Info;
use motionscope_core::scene::{Fact, Math, Step, Value};

use crate::paint::Theme;
use crate::paint::charts::changes::Since;
use crate::paint::charts::explanation::{self, Block, Density, Light};
use crate::ui::drawing::chart::{rect_from, unclipped};
use crate::ui::drawing::{ink, primitives};
use crate::ui::layout::StripRoom;
use crate::ui::panes::glossary::{self, Beside, Link};
use crate::ui::parts::widgets;

/// What is explained.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The estimator.
    pub info: &'a Info,
    /// What the cursor tells.
    pub step: &'a Arc<Step>,
    /// What the step before told, where that is known: numbers that differ from it are lit.
    pub before: Option<&'a Step>,
    /// The stage on which what is pointed at is pointed out.
    pub beside: &'a Beside<'a>,
    /// Whether the run is over: then it is told how good the estimate is as well.
    pub at_end: bool,
    /// The look.
    pub theme: Theme,
}

impl<'a> Input<'a> {
    /// The formulas of the step, and those of the step before.
    fn formulas(&self) -> Since<'a, Math> {
        let before = self.before.map_or(&[][..], Step::formulas);
        Since { now: self.step.formulas(), before }
    }

    /// The numbers of the step, and those of the step before.
    fn facts(&self) -> Since<'a, Fact> {
        let before = self.before.map_or(&[][..], Step::facts);
        Since { now: self.step.facts(), before }
    }

    /// The numbers that stand in for a formula in `room`.
    fn facts_in(&self, room: StripRoom) -> Since<'a, Fact> {
        if room.is_sentence_alone { Since { now: &[], before: &[] } } else { self.facts() }
    }
}

/// Heights of the pane, in sizes of its type, below which things stand closer.
const ROOMY: f32 = 30.0;
/// Above and below the parts in their pane, in points.
const PANE_MARGIN: f32 = 16.0;
/// Room at the edges of a scrolled area, which clips letters that lean out of their line.
const CLIPPED_PT: f32 = 4.0;
/// Above and below a line of code.
const CODE_MARGIN: f32 = 3.0;

/// How close things stand in a pane of this height.
fn density(height: f32, theme: Theme) -> Density {
    if height < ROOMY * theme.sizes().body { Density::close(theme) } else { Density::roomy(theme) }
}

/// What the parts of a pane follow from. The pane's height follows from its formula and from the chart below: once things stand
/// close for an estimator in a window they go on doing so, or else both would change with every step.
fn key_of(ui: &Ui, Input { info, theme, .. }: Input<'_>, before: Option<Key>) -> Key {
    let key = |density| Key {
        id: info.id,
        width: (ui.available_width() - CLIPPED_PT).max(0.0).round() as u32,
        window: ui.ctx().content_rect().height().round() as u32,
        theme,
        density,
        pixels_per_point: ui.pixels_per_point(),
        atlas: ink::atlas(ui.ctx()),
    };
    let close = key(Density::close(theme));
    if before == Some(close) { close } else { key(density(ui.available_height(), theme)) }
}

/// From one part to the next, in points.
fn gap(density: Density, theme: Theme) -> f32 {
    if density == Density::close(theme) { 5.0 } else { 8.0 }
}

/// What the parts follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    /// The estimator.
    id: &'static str,
    width: u32,
    /// Height of the window.
    window: u32,
    theme: Theme,
    density: Density,
    pixels_per_point: f32,
    atlas: u64,
}

/// A part as it is shown.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    size: Vec2,
    shapes: Vec<Shape>,
    /// Its lines: where each is and what it says.
    lines: Vec<(Rect, String)>,
    /// The terms in it, which are defined where they are pointed at.
    links: Vec<Link>,
}

impl Part {
    /// `told` are the values of the step and the family of its estimator.
    pub(super) fn new(painter: &Painter, block: Block, told: (&[Value], &str)) -> Self {
        // What is scrolled out of sight now may come into it later.
        let painter = unclipped(painter);
        let links = glossary::links(&block, told);
        let lines = block.lines.into_iter().map(|(rect, words)| (rect_from(rect), words)).collect();
        Self { size: block.size.into(), shapes: primitives::shapes(&painter, &block.primitives), lines, links }
    }

    /// Shows it, each line with its name; gives where these are. What is pointed at is pointed out on the stage.
    pub(super) fn show(&self, ui: &mut Ui, salt: &str, beside: &Beside<'_>) -> Vec<Rect> {
        if self.size.y <= 0.0 {
            return Vec::new();
        }
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), self.size.y), Sense::hover());
        let by = rect.min.to_vec2();
        ui.painter().extend(self.shapes.iter().cloned().map(|mut shape| {
            shape.translate(by);
            shape
        }));
        let line = |(i, (place, words)): (usize, &(Rect, String))| {
            let place = place.translate(by);
            let sensed = ui.interact(place, ui.scope_id().with((salt, i)), Sense::hover());
            ink::name(&sensed, || words.clone());
            place
        };
        let places = self.lines.iter().enumerate().map(line).collect();
        glossary::sense(ui, salt, (&self.links, rect.with_max_y(rect.min.y + self.size.y)), beside);
        places
    }
}

/// All parts of an explanation.
#[derive(Clone, Debug)]
struct Parts {
    step: Arc<Step>,
    sentence: Part,
    rule: Part,
    equation: Part,
    facts: Part,
    name: Part,
    code: Part,
    citation: Part,
    /// The line at work alone.
    pinned: Part,
    /// Room for any line at work, so that nothing jumps from line to line.
    pinned_height: f32,
}

impl Parts {
    fn new(painter: &Painter, input: Input<'_>, key: Key) -> Self {
        let Input { info, step, theme, .. } = input;
        let (width, density) = (key.width as f32, key.density);
        let part = |block| Part::new(painter, block, (&step.values, info.family));
        let line = |text: &str| explanation::code_line(text.trim_start(), Light::AtWork, width, theme);
        let pinned = info.line(step.line).map(|i| line(info.pseudocode[i].text)).unwrap_or_default();
        let highest = info.pseudocode.iter().map(|code| line(code.text).size[1]).fold(0.0, f32::max);
        Self {
            step: Arc::clone(step),
            sentence: part(explanation::sentence(&step.sentence, (width, density), theme)),
            rule: part(explanation::rule(width, theme)),
            equation: part(explanation::equation(input.formulas(), (width, density), theme)),
            facts: part(explanation::table(input.facts(), (width, density), theme)),
            name: part(explanation::name(info, theme)),
            code: part(explanation::pseudocode(info, step, (0..info.pseudocode.len(), width), theme)),
            citation: part(explanation::citation(info.source, width, theme)),
            pinned: part(pinned),
            pinned_height: highest,
        }
    }
}

/// The room that each part has needed so far, so that nothing jumps from step to step, and the parts as they are.
#[derive(Clone, Debug, Default)]
pub struct State {
    key: Option<Key>,
    sentence: f32,
    equation: f32,
    facts: f32,
    /// How much of the parts is seen where the line at work is out of sight among them, and so stands below them.
    pinned: Option<f32>,
    /// The most height down to the end of the formula.
    formula_end: f32,
    /// Whether that was measured for another key.
    is_old: bool,
    parts: Option<Parts>,
}

impl State {
    /// The most height of the explanation down to the end of its formula, in points, as it was shown so far.
    pub fn formula_end(&self) -> f32 {
        self.formula_end
    }

    /// Forgets the room when it was measured for another estimator, width, type size or density.
    fn keep_for(&mut self, key: Key) {
        if self.key != Some(key) {
            // Room for what most steps tell, from the first on.
            let Key { theme, density: Density { leading, row, math, words }, .. } = key;
            let size = theme.sizes();
            *self = State {
                key: Some(key),
                sentence: 3.0 * (leading * words).round(),
                facts: 4.0 * (1.2 * size.body + 2.0 * row).round(),
                equation: 4.0 * (1.45 * math).round(),
                pinned: self.pinned,
                formula_end: self.formula_end,
                is_old: true,
                parts: None,
            };
        }
    }
}

/// Between the two columns, in points.
const COLUMN_GAP: f32 = 24.0;

/// Shows the explanation in the whole of `ui`: sentence and formula above the numbers and the code, or beside them where the pane
/// `is_wide`.
pub fn show(ui: &mut Ui, (input, is_wide): (Input<'_>, bool), state: &mut State) {
    let room = ui.available_rect_before_wrap();
    if !is_wide {
        return column(ui, input, state, [true, true]);
    }
    let half = (room.width() - COLUMN_GAP) / 2.0;
    let inside = |rect| egui::UiBuilder::new().max_rect(rect);
    let [left, right] = [room.with_max_x(room.min.x + half), room.with_min_x(room.max.x - half)];
    column(&mut ui.new_child(inside(left).id_salt("why")), input, state, [true, false]);
    column(&mut ui.new_child(inside(right).id_salt("how")), input, state, [false, true]);
}

/// Shows sentence and formula, numbers and code, or both, below each other.
fn column(ui: &mut Ui, input: Input<'_>, state: &mut State, [has_why, has_how]: [bool; 2]) {
    let Input { info, step, theme, at_end, beside, .. } = input;
    let key = key_of(ui, input, state.key);
    ui.spacing_mut().item_spacing = vec2(8.0, gap(key.density, theme));
    state.keep_for(key);
    let known = state.parts.take().filter(|parts| Arc::ptr_eq(&parts.step, step));
    let parts = known.unwrap_or_else(|| Parts::new(ui.painter(), input, key));
    let from = ui.cursor().min.y;
    // The sentence stays in sight, however far the rest is scrolled, unless it leaves the formula no room.
    let told = state.sentence.max(parts.sentence.size.y) + parts.equation.size.y + 2.0 * ui.spacing().item_spacing.y;
    let is_long = told > ui.available_height();
    if has_why && !is_long {
        hold(ui, &mut state.sentence, at_end, |ui| _ = parts.sentence.show(ui, "sentence", beside));
    }
    // Nor does the line at work: it stands at the bottom where it is scrolled out of sight. Nothing scrolls by itself.
    let below = if has_how { parts.pinned_height + ui.spacing().item_spacing.y } else { 0.0 };
    let room = ui.available_height();
    let height = state.pinned.filter(|_| has_how).unwrap_or(room).clamp(0.0, room.max(0.0));
    let mut formula_end = 0.0;
    let scroll = egui::ScrollArea::vertical().id_salt("explanation").auto_shrink(false).max_height(height);
    let scrolled = scroll.show(ui, |ui| {
        let mut places = Vec::new();
        let top_of_all = ui.cursor().min.y;
        if has_why && is_long {
            hold(ui, &mut state.sentence, at_end, |ui| _ = parts.sentence.show(ui, "sentence", beside));
        }
        // Before the first step there is neither: no room is kept then.
        let has_numbers = parts.facts.size.y > 0.0 || parts.equation.size.y > 0.0;
        if has_numbers && has_why {
            // The formula is what is taught: it is seen in a small window as well.
            parts.rule.show(ui, "first rule", beside);
            hold(ui, &mut state.equation, at_end, |ui| places.extend(parts.equation.show(ui, "equation", beside)));
            formula_end = ui.cursor().min.y - top_of_all;
        }
        if has_numbers && has_how {
            if has_why {
                parts.rule.show(ui, "second rule", beside);
            }
            hold(ui, &mut state.facts, at_end, |ui| places.extend(parts.facts.show(ui, "facts", beside)));
        }
        if !has_how {
            return (None, places);
        }
        places.extend(parts.name.show(ui, "name", beside));
        let top = ui.cursor().min.y;
        let code = parts.code.show(ui, "code", beside);
        let at_work = info.line(step.line).and_then(|line| code.get(line).copied());
        // Nothing is seen of the box around them where nothing is seen of the first.
        places.extend(code.first().map(|line| line.with_min_y(top)));
        places.extend(code);
        ui.add_space(8.0);
        places.extend(parts.citation.show(ui, "citation", beside));
        (at_work, places)
    });
    if has_how && state.pinned.is_some() {
        ui.add_space((room - below - height).max(0.0));
        parts.pinned.show(ui, "pinned", beside);
    }
    state.parts = Some(parts);
    if has_why {
        // Above the formula, and the formula. The line at work stands below them where there is room for it.
        let needed = (scrolled.inner_rect.min.y - from + formula_end + PANE_MARGIN).ceil();
        // It only grows, so that the pane keeps its height where steps with a formula and without one follow each other.
        let needed = if std::mem::take(&mut state.is_old) { needed } else { needed.max(state.formula_end) };
        if std::mem::replace(&mut state.formula_end, needed) != needed {
            widgets::lay_out_anew(ui.ctx(), "the explanation needs another height");
        }
    }
    if !has_how {
        return;
    }
    let top = scrolled.inner_rect.min.y;
    let overflows = scrolled.content_size.y > room;
    let is_in_sight = |line: &Rect| line.center().y >= top && line.max.y <= top + room - below;
    let (at_work, places) = scrolled.inner;
    // It would stand there twice where it is half in sight.
    let seen = |_| whole(&places, top, top + room - below) - top;
    // The formula is what is taught: no line of code takes its room.
    let has_room = room - below >= formula_end;
    let is_pinned = at_work.filter(|line| has_room && overflows && !is_in_sight(line)).map(seen);
    if std::mem::replace(&mut state.pinned, is_pinned) != is_pinned {
        widgets::lay_out_anew(ui.ctx(), "the line at work came into sight, or went out of it");
    }
}

/// A part of the strip, with its top left corner in points.
type Placed<Content> = (Vec2, Content);

/// Sentence and formula, and the room that they have needed so far.
#[derive(Clone, Debug, Default)]
pub struct Strip {
    key: Option<Key>,
    /// The most that a step needed.
    height: f32,
    /// What there always is room for.
    room: Option<StripRoom>,
    shown: Option<(Arc<Step>, Vec<Placed<Part>>)>,
}

/// Sizes of the strip's type that are tried for what is too long even with its formula in numbers alone.
const TYPE_SHARES: [f32; 6] = [1.0, 0.93, 0.86, 0.8, 0.74, 0.68];
/// Most lines of a formula that always stand below each other: a short one is read across otherwise.
const ONE_COLUMN: usize = 3;
/// Most rows of numbers in the strip.
const STRIP_FACTS: usize = 4;
/// Shares of the strip's width for the sentence that are tried where numbers stand beside it.
const FACTS_SHARES: [f32; 3] = [0.55, 0.62, 0.7];
/// Those that are tried where a formula stands beside it: in one column, and in two.
const SENTENCE_SHARES: [f32; 4] = [0.55, 0.62, 0.48, 0.42];
const NARROW_SHARES: [f32; 3] = [0.4, 0.46, 0.52];
/// Between sentence and formula, in points.
const STRIP_GAP: f32 = 24.0;
/// Above and below the strip's words, in points.
const STRIP_MARGIN: f32 = 10.0;

impl Strip {
    /// The most height that the strip has needed for this estimator in this window, in points.
    pub fn height(&self) -> f32 {
        self.height + STRIP_MARGIN
    }
}

/// Shows why, and the formula with its numbers; where a step has none, its numbers alone. Texts that are longer than what is kept
/// for them are set smaller, and only what has no room even so asks for more.
pub fn strip(ui: &mut Ui, (input, room): (Input<'_>, StripRoom), state: &mut Strip) {
    let Input { step, theme, beside, .. } = input;
    let key = Key { density: Density::strip(room.type_pt, theme), ..key_of(ui, input, None) };
    let room = StripRoom { most: room.most - STRIP_MARGIN, ..room };
    // Where even the smallest type leaves something out of sight, a bar that is always seen says so; its room is kept.
    let scroll = &mut ui.spacing_mut().scroll;
    (scroll.dormant_handle_opacity, scroll.dormant_background_opacity) = (0.6, 0.3);
    scroll.floating_width = scroll.bar_width;
    let width = key.width as f32 - scroll.allocated_width();
    if state.key != Some(key) || state.room != Some(room) {
        *state = Strip { key: Some(key), room: Some(room), ..Strip::default() };
    }
    let known = state.shown.take().filter(|(shown, _)| Arc::ptr_eq(shown, step));
    let parts = |painter: &Painter| strip_parts(painter, input, (width, room));
    let (shown, parts) = known.unwrap_or_else(|| (Arc::clone(step), parts(ui.painter())));
    let needed = parts.iter().map(|(at, part)| at.y + part.size.y).fold(0.0, f32::max).ceil();
    // It only grows, so that nothing jumps from step to step.
    if needed > state.height {
        state.height = needed;
        // Beside a chart below it, it takes of the chart's room.
        if room.is_column {
            widgets::lay_out_anew(ui.ctx(), "the strip needs more height");
        }
    }
    let room = ui.available_height();
    egui::ScrollArea::vertical().id_salt("strip").auto_shrink(false).max_height(room).show(ui, |ui| {
        let top = ui.cursor().min;
        // Formulas in two columns are read down, not across.
        if let [.., (_, first), (at, second)] = &parts[..]
            && parts.len() > 2
        {
            let bottom = first.size.y.max(second.size.y);
            let x = top.x + at.x - STRIP_GAP / 2.0;
            ui.painter().vline(x, top.y..=top.y + bottom, ui.visuals().widgets.noninteractive.bg_stroke);
        }
        for (i, (at, part)) in parts.iter().enumerate() {
            let place = Rect::from_min_size(top + *at + vec2(CLIPPED_PT, 0.0), vec2(width, needed));
            let mut inside = ui.new_child(egui::UiBuilder::new().id_salt(i).max_rect(place));
            part.show(&mut inside, "strip", beside);
        }
        ui.allocate_space(vec2(1.0, needed));
    });
    state.shown = Some((shown, parts));
}

/// The parts of the strip, in the largest type in which all of it is seen: rather with the symbols of its first formula alone, with
/// none, and then smaller, than out of sight.
fn strip_parts(painter: &Painter, input: Input<'_>, (width, room): (f32, StripRoom)) -> Vec<Placed<Part>> {
    let usual = Density::strip(room.type_pt, input.theme);
    let at = |share: &f32| Density { words: share * usual.words, math: share * usual.math, ..usual };
    let formula = if room.is_sentence_alone { Since { now: &[][..], before: &[][..] } } else { input.formulas() };
    let in_numbers = |kept| [formula.now, formula.before].map(|lines| in_numbers(lines, kept));
    let ([once, once_before], [brief, brief_before]) = (in_numbers(1), in_numbers(0));
    let once = Since { now: &once, before: &once_before };
    let brief = Since { now: &brief, before: &brief_before };
    let whole = [(&TYPE_SHARES[0], formula), (&TYPE_SHARES[0], once)];
    let laid_out = |input: Input<'_>, share: &f32, formula| match room.is_column {
        true => strip_rows((input, formula), (width, at(share)), room),
        false => strip_columns((input, formula), (width, at(share)), room),
    };
    let fits = |columns: &Vec<Placed<Block>>| height(columns, width) <= room.most;
    let (large, small) = TYPE_SHARES.split_at(if room.is_presented { 2 } else { TYPE_SHARES.len() });
    let ways = whole.into_iter().chain(large.iter().map(|share| (share, brief)));
    let least = large.last().unwrap_or(&1.0);
    // Rather its first sentences and all of the formula than a line that is cut.
    let shortened = (1..input.step.sentence.count()).rev().map(|kept| {
        let step = Arc::new(Step { sentence: input.step.sentence.first(kept), ..Step::clone(input.step) });
        laid_out(Input { step: &step, ..input }, least, brief)
    });
    let smaller = small.iter().map(|share| laid_out(input, share, brief));
    let mut last = Vec::new();
    let all = ways.map(|(share, formula)| laid_out(input, share, formula)).chain(shortened).chain(smaller);
    let columns = all.inspect(|columns| last.clone_from(columns)).find(fits).unwrap_or_default();
    let columns = if columns.is_empty() { last } else { columns };
    columns
        .into_iter()
        .map(|(at, block)| (at, Part::new(painter, block, (&input.step.values, input.info.family))))
        .collect()
}

/// The sentence, and below it the formula; where there is none, as many of the numbers as `most` has room for.
fn strip_rows(
    (input, formula): (Input<'_>, Since<'_, Math>),
    (width, density): (f32, Density),
    room: StripRoom,
) -> Vec<Placed<Block>> {
    let Input { step, theme, .. } = input;
    let (facts, most) = (input.facts_in(room), room.most);
    let sentence = explanation::sentence(&step.sentence, (width, density), theme);
    let below = vec2(0.0, sentence.size[1] + STRIP_GAP);
    let second = match (formula.is_empty(), facts.is_empty()) {
        (false, _) => explanation::equation(formula, (width, density), theme),
        (true, false) => {
            let first = |count: usize| explanation::table(facts.first(count), (width, density), theme);
            let fewest = facts.len().min(1);
            let counts = (fewest..=facts.len().min(STRIP_FACTS)).rev();
            counts.map(first).find(|table| below.y + table.size[1] <= most).unwrap_or_else(|| first(fewest))
        }
        (true, true) => return vec![(Vec2::ZERO, sentence)],
    };
    vec![(Vec2::ZERO, sentence), (below, second)]
}

/// The formulas without lines of symbols alone but for the first `kept` of them: the numbers of the others follow the name of the
/// result at once.
fn in_numbers(formula: &[Math], mut kept: usize) -> Vec<Math> {
    let mut brief: Vec<Math> = Vec::new();
    for line in formula {
        let is_value = line.plain().trim_start().starts_with('=');
        let name = brief.last().filter(|_| is_value).and_then(result_of_symbols);
        match (brief.last_mut(), name) {
            (Some(last), Some(name)) if kept == 0 => *last = Math::Row(vec![name, Math::text(" "), line.clone()]),
            (_, name) => {
                kept -= usize::from(name.is_some());
                brief.push(line.clone());
            }
        }
    }
    brief
}

/// The name before the first "=" of a line of symbols; `None` for a line with values.
fn result_of_symbols(line: &Math) -> Option<Math> {
    let Math::Row(parts) = line else { return None };
    let at = parts.iter().position(|part| matches!(part, Math::Text(text, _) if text.trim() == "="))?;
    (at > 0 && line.values().is_empty()).then(|| Math::Row(parts[..at].to_vec()))
}

/// How high the parts are; where one reaches into the next beside it, or beyond `width`, they do not fit at all.
fn height(parts: &[Placed<Block>], width: f32) -> f32 {
    let ends = parts.iter().skip(1).map(|(at, _)| if at.x > 0.0 { at.x } else { width }).chain([width]);
    let fits = parts.iter().zip(ends).all(|((at, block), end)| at.x + block.size[0] <= end);
    if fits { parts.iter().map(|(at, block)| at.y + block.size[1]).fold(0.0, f32::max) } else { f32::INFINITY }
}

/// The sentence, and the formula in one column or two: as usual if that is no higher than `most`, or else whichever is lowest.
fn strip_columns(
    (input, formula): (Input<'_>, Since<'_, Math>),
    (width, density): (f32, Density),
    room: StripRoom,
) -> Vec<Placed<Block>> {
    let Input { step, theme, .. } = input;
    let (facts, most) = (input.facts_in(room), room.most);
    let sentence = |width: f32| explanation::sentence(&step.sentence, (width, density), theme);
    let lines = |lines: Since<'_, Math>, width: f32| explanation::equation(lines, (width, density), theme);
    if formula.is_empty() && facts.is_empty() {
        return vec![(Vec2::ZERO, sentence(width))];
    }
    let one = |share: f32, block: &dyn Fn(f32) -> Block| {
        let left = share * width;
        vec![(Vec2::ZERO, sentence(left)), (vec2(left + STRIP_GAP, 0.0), block(width - left - STRIP_GAP))]
    };
    if formula.is_empty() {
        // Rather fewer numbers than a smaller sentence.
        let table = |(count, share): (usize, &f32)| {
            one(*share, &|width| explanation::table(facts.first(count), (width, density), theme))
        };
        let most_facts = facts.len().min(STRIP_FACTS);
        let counts = (1..=most_facts).rev();
        let mut ways = counts.flat_map(|count| FACTS_SHARES.iter().map(move |share| (count, share))).map(table);
        let fits = |parts: &Vec<Placed<Block>>| height(parts, width) <= most;
        return ways.find(fits).unwrap_or_else(|| table((most_facts, &FACTS_SHARES[0])));
    }
    let two = |share: f32| {
        let left = share * width;
        let column = (width - left) / 2.0 - STRIP_GAP;
        let at = |i: f32| vec2(left + STRIP_GAP + i * (column + STRIP_GAP), 0.0);
        let cut_at = |cut: usize| {
            let (first, second) = formula.split_at(cut);
            vec![(Vec2::ZERO, sentence(left)), (at(0.0), lines(first, column)), (at(1.0), lines(second, column))]
        };
        let cuts = cuts(formula.now).into_iter().map(cut_at);
        cuts.min_by(|a, b| height(a, width).total_cmp(&height(b, width))).unwrap_or_default()
    };
    let in_one = |share: &f32| one(*share, &|width| lines(formula, width));
    let narrow = if formula.len() > ONE_COLUMN { &NARROW_SHARES[..] } else { &[] };
    let usual = [SENTENCE_SHARES.first().map(in_one), narrow.first().map(|share| two(*share))];
    let lowest = |ways: &mut dyn Iterator<Item = Vec<Placed<Block>>>| {
        ways.min_by(|a, b| height(a, width).total_cmp(&height(b, width))).unwrap_or_default()
    };
    let usual = lowest(&mut usual.into_iter().flatten());
    if height(&usual, width) <= most {
        return usual;
    }
    let others = SENTENCE_SHARES[1..].iter().map(in_one);
    let narrower = narrow.iter().skip(1).map(|share| two(*share));
    lowest(&mut std::iter::once(usual).chain(others).chain(narrower))
}

/// The lines at which a second column may begin: not with the numbers of the formula above them.
fn cuts(formula: &[Math]) -> Vec<usize> {
    let is_start = |line: &usize| !formula[*line].plain().trim_start().starts_with('=');
    let starts: Vec<usize> = (1..formula.len()).filter(is_start).collect();
    if starts.is_empty() { vec![formula.len().div_ceil(2)] } else { starts }
}

/// Where lines that may be seen from `top` down to `end` have to end so that none of them is cut.
fn whole(lines: &[Rect], top: f32, end: f32) -> f32 {
    let cut = lines.iter().filter(|line| (top..end).contains(&line.min.y) && line.max.y - CODE_MARGIN > end);
    cut.map(|line| line.min.y).fold(end, f32::min)
}

/// Shows a part in at least as much height as it ever took; but at the end of a run, where more is told, in just its own.
fn hold(ui: &mut Ui, height: &mut f32, at_end: bool, add: impl FnOnce(&mut Ui)) {
    let least = if at_end { 0.0 } else { *height };
    let shown = ui.scope(|ui| {
        ui.set_min_height(least);
        ui.set_width(ui.available_width());
        add(ui);
    });
    let taken = shown.response.rect.height();
    if !at_end {
        *height = height.max(taken);
    }
    if taken > 0.0 {
        ui.add_space(ui.spacing().item_spacing.y);
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;
    use motionscope_core::scene::{Name, Unit};

    use super::*;

    motionscope_core::variables! {
        /// A result.
        RESULT: "Result", "u", Unit::WHOLE;
    }

    #[test]
    fn a_column_begins_with_a_formula_and_not_with_its_numbers() {
        let lines = ["c = a − b", "= 3 − 2", "u = m − c", "= 1", "v = n − c", "= 4"].map(Math::text);
        assert_eq!(cuts(&lines), [2, 4]);
        assert_eq!(cuts(&["u = m", "= 1", "= 2"].map(Math::text)), [2], "the middle where there is no other place");
    }

    #[test]
    fn a_brief_formula_gives_the_numbers_of_its_symbols() {
        let step = Step::at(Name::new(b"test")).put(value::RESULT, 9);
        let step = step.formula("u = 2 a^2").formula("= {result}").formula("w = {result} − 2").formula("= {result}");
        let lines = step.formulas();
        let brief = |kept| in_numbers(lines, kept).iter().map(Math::plain).collect::<Vec<_>>();
        assert_eq!(brief(0), ["u = 9", "w = 9 − 2", "= 9"]);
        assert_eq!(brief(1), ["u = 2a^2", "= 9", "w = 9 − 2", "= 9"], "the first symbols stay");
    }

    #[test]
    fn no_line_is_cut_where_others_end() {
        let line = |from: f32, to: f32| Rect::from_min_max(pos2(0.0, from), pos2(100.0, to));
        let lines = [line(-5.0, 15.0), line(15.0, 35.0), line(35.0, 55.0), line(60.0, 80.0)];
        assert_eq!([20.0, 33.0, 50.0, 57.0, 90.0].map(|end| whole(&lines, 0.0, end)), [15.0, 33.0, 35.0, 57.0, 90.0]);
        // One that is taller than all there is room for, and is scrolled out at the top, stays.
        assert_eq!(whole(&[line(-10.0, 90.0)], 0.0, 50.0), 50.0);
    }
}
