//! Typesetting of [`Math`]: a layout that can be measured, and its primitives.

use std::borrow::Cow;

use motionscope_core::scene::{Math, Role, Variable};

use super::super::primitive::{Anchor, Line, Point, Primitive, Rect, Run};
use super::super::{Face, Theme, fonts};
use super::canvas::solid;

/// Heights as fractions of the type size, common to the sans faces in use.
const ASCENT: f32 = 0.78;
const DESCENT: f32 = 0.24;
const CAP: f32 = 0.73;
/// Height of a letter without ascender.
const LOW: f32 = 0.56;
/// Height of the axis, on which fraction bars and sums are centred, above the baseline.
const AXIS: f32 = 0.27;
const SMALL: f32 = 0.72;
/// Below this a formula becomes unreadable; it then runs on rather than shrink.
const SMALLEST: f32 = 0.7;

/// The character of which a box to write in consists; a box stands for a number that is left out.
const BLANK: char = '□';
/// Least number of letters that a box has room for.
const LEAST_BLANK: usize = 5;
/// A box in sizes of the type: width for a letter, heights above and below the baseline.
const BLANK_LETTER: f32 = 0.75;
const BLANK_HEIGHTS: [f32; 2] = [1.12, 0.5];

/// A box to write in instead of `number`, as text of a formula.
pub fn blank(number: &str) -> String {
    BLANK.to_string().repeat(number.chars().count().max(LEAST_BLANK))
}

/// Whether a number is left out of a formula.
pub fn has_blank(math: &Math) -> bool {
    math.plain().contains(BLANK)
}

/// What a layout needs to know of a font.
pub trait Measure {
    /// Advance width of `text` at `size_pt`.
    fn width(&mut self, text: &str, size_pt: f32, face: Face) -> f32;
}

/// A run of text or a rule, placed from the left end of the formula's first baseline; y runs down.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// Text with the left end of its baseline at `at`.
    Text {
        /// Left end of the baseline.
        at: Point,
        /// The words.
        text: String,
        /// Type size in points.
        size_pt: f32,
        /// Italic for a variable, bold for a vector or a matrix.
        face: Face,
        /// The role whose colour it carries.
        role: Option<Role>,
    },
    /// A filled rectangle: a fraction bar, the bar of an absolute value, a side of a bracket.
    Rule(Rect),
    /// A line of a width along points: the sign of a root.
    Stroke(Vec<Point>, f32),
}

impl Piece {
    fn shift(&mut self, by: Point) {
        match self {
            Piece::Text { at, .. } => *at = [0, 1].map(|i| at[i] + by[i]),
            Piece::Rule(rect) => *rect = rect.moved(by),
            Piece::Stroke(points, _) => points.iter_mut().for_each(|at| *at = [0, 1].map(|i| at[i] + by[i])),
        }
    }
}

/// A formula that was laid out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Formula {
    /// Width in points.
    pub width: f32,
    /// From the first baseline up.
    pub ascent: f32,
    /// From the first baseline down, further lines included.
    pub descent: f32,
    /// Its parts.
    pub pieces: Vec<Piece>,
    /// Where each symbol stands and what it is in plain letters; one with an index comes before its letter.
    pub symbols: Vec<(Rect, String)>,
    /// Its values.
    pub values: Vec<Placed>,
}

/// A value of a formula that was laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Where it stands.
    pub rect: Rect,
    /// Its variable.
    pub of: &'static Variable,
    /// How it is written.
    pub shown: String,
}

impl Formula {
    /// Width and height in points.
    pub fn size(&self) -> [f32; 2] {
        [self.width, self.ascent + self.descent]
    }

    /// Where words and numbers in the colour of a role stand, from the left end of the first baseline.
    pub fn roles(&self) -> impl Iterator<Item = (Rect, Role)> {
        self.pieces.iter().filter_map(|piece| match piece {
            Piece::Text { at, text, size_pt, face, role: Some(role) } => {
                let size = [fonts::width(text, *face, *size_pt), (ASCENT + DESCENT) * size_pt];
                Some((Rect::new([at[0], at[1] - ASCENT * size_pt], size), *role))
            }
            _ => None,
        })
    }

    /// The characters that no font has.
    #[cfg(test)]
    pub fn missing(&self) -> String {
        let of_piece = |piece: &Piece| match piece {
            Piece::Text { text, size_pt, face, .. } => fonts::missing(text, *face, *size_pt),
            Piece::Rule(_) | Piece::Stroke(..) => String::new(),
        };
        self.pieces.iter().map(of_piece).collect()
    }

    /// The same as a symbol of its own: `math`.
    fn named(mut self, math: &Math) -> Self {
        let rect = Rect::between([0.0, -self.ascent], [self.width, self.descent]);
        self.symbols.insert(0, (rect, math.plain()));
        self
    }

    /// Sets `other` with its left end at `at`.
    fn put(&mut self, mut other: Formula, at: Point) {
        other.pieces.iter_mut().for_each(|piece| piece.shift(at));
        self.pieces.append(&mut other.pieces);
        self.symbols.extend(other.symbols.into_iter().map(|(rect, name)| (rect.moved(at), name)));
        self.values.extend(other.values.into_iter().map(|value| Placed { rect: value.rect.moved(at), ..value }));
        self.width = self.width.max(at[0] + other.width);
        self.ascent = self.ascent.max(other.ascent - at[1]);
        self.descent = self.descent.max(other.descent + at[1]);
    }
}

/// Lays `math` out at `size_pt`; a row at the top level is broken before a sign where it exceeds `max_width`, inside parentheses only
/// where that is not enough, and there after commas too.
///
/// What cannot be broken is made smaller, down to seven tenths. Only where that is not enough is a row broken anywhere.
pub fn lay_out(math: &Math, size_pt: f32, max_width: f32, measure: &mut dyn Measure) -> Formula {
    let mut parts = Vec::new();
    flatten(math, &mut parts);
    let parts: Vec<&Math> = parts.iter().map(|part| &**part).collect();
    let mut best = None;
    for breaks in [Breaks::BeforeSigns, Breaks::InParentheses, Breaks::Anywhere] {
        let first = units(&parts, size_pt, breaks, measure);
        let widest = first.iter().map(|(unit, _)| unit.width).fold(0.0, f32::max);
        if widest <= max_width {
            return break_lines(first, size_pt, max_width);
        }
        if breaks == Breaks::BeforeSigns {
            continue;
        }
        let size_pt = size_pt * (max_width / widest).max(SMALLEST);
        let shrunk = break_lines(units(&parts, size_pt, breaks, measure), size_pt, max_width);
        if widest * SMALLEST <= max_width {
            return shrunk;
        }
        best = Some(shrunk);
    }
    best.unwrap_or_default()
}

/// The parts of a row, those of rows in it among them; a text of several terms is several parts.
fn flatten<'a>(math: &'a Math, parts: &mut Vec<Cow<'a, Math>>) {
    match math {
        Math::Row(inner) => inner.iter().for_each(|part| flatten(part, parts)),
        Math::Text(text, role) => match &terms(text)[..] {
            [] | [_] => parts.push(Cow::Borrowed(math)),
            terms => parts.extend(terms.iter().map(|term| Cow::Owned(Math::Text((*term).into(), *role)))),
        },
        other => parts.push(Cow::Borrowed(other)),
    }
}

/// The terms of a text: it is cut before signs with space on both sides, and after commas.
fn terms(text: &str) -> Vec<&str> {
    let letters: Vec<(usize, char)> = text.char_indices().collect();
    let is_cut = |i: usize| {
        let at = |by: usize| letters.get(i + by).map(|(_, letter)| *letter);
        let is_before_sign = at(0) == Some(' ') && at(1).is_some_and(|sign| SIGNS.contains(sign)) && at(2) == Some(' ');
        is_before_sign || i >= 2 && letters[i - 2].1 == ',' && letters[i - 1].1 == ' '
    };
    let cuts = (1..letters.len()).filter(|i| is_cut(*i)).map(|i| letters[i].0);
    let ends: Vec<usize> = std::iter::once(0).chain(cuts).chain([text.len()]).collect();
    ends.windows(2).map(|ends| &text[ends[0]..ends[1]]).collect()
}

/// Where a row may be broken.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Breaks {
    /// Before a sign between two terms that stands in no parentheses.
    BeforeSigns,
    /// Before any sign between two terms, and after a comma.
    InParentheses,
    /// After every part but a sign.
    Anywhere,
}

/// What stays together on a line, and whether it begins with an equals sign.
fn units(parts: &[&Math], size: f32, breaks: Breaks, measure: &mut dyn Measure) -> Vec<(Formula, bool)> {
    let mut units = Vec::new();
    let (mut unit, mut is_equation) = (Formula::default(), false);
    let (mut depth, mut after_sign, mut after_comma) = (0, true, false);
    for part in parts {
        let may_break = match breaks {
            Breaks::BeforeSigns => depth == 0 && begins_with_sign(part),
            Breaks::InParentheses => begins_with_sign(part) || after_comma && depth > 0,
            Breaks::Anywhere => true,
        };
        if may_break && !after_sign && !unit.pieces.is_empty() {
            units.push((std::mem::take(&mut unit), is_equation));
        }
        if unit.pieces.is_empty() {
            is_equation = matches!(part, Math::Text(text, _) if text.trim_start().starts_with('='));
        }
        let at = [unit.width, 0.0];
        unit.put(Setter { measure: &mut *measure }.set(part, size), at);
        depth = (depth + opened(part)).max(0);
        // Space alone changes nothing.
        let is_space = matches!(part, Math::Text(text, _) if text.trim().is_empty());
        after_sign = if is_space { after_sign } else { ends_with_sign(part) };
        after_comma = matches!(part, Math::Text(text, _) if text.ends_with(", "));
    }
    units.push((unit, is_equation));
    units
}

/// Signs that stand between two terms.
const SIGNS: &str = "+−=←→≤≥<>≈±·";

/// Whether a line may end before `math`: it begins with a sign that has space behind it, unlike that of a number.
fn begins_with_sign(math: &Math) -> bool {
    let Math::Text(text, _) = math else { return false };
    let mut letters = text.trim_start().chars();
    letters.next().is_some_and(|first| SIGNS.contains(first)) && letters.next().is_none_or(|next| next == ' ')
}

/// Whether something has to follow `math` on its line.
fn ends_with_sign(math: &Math) -> bool {
    match math {
        Math::Text(text, _) => text.trim_end().ends_with(|c| SIGNS.contains(c) || c == '('),
        Math::Sum(_) => true,
        _ => false,
    }
}

/// How many parentheses `math` opens more than it closes.
fn opened(math: &Math) -> i32 {
    match math {
        Math::Text(text, _) => text.chars().map(|c| i32::from("([{".contains(c)) - i32::from(")]}".contains(c))).sum(),
        Math::Sub(base, _) | Math::Sup(base, _) => opened(base),
        Math::Row(parts) => parts.iter().map(opened).sum(),
        _ => 0,
    }
}

/// Sets units in lines.
fn break_lines(mut rest: Vec<(Formula, bool)>, size_pt: f32, max_width: f32) -> Formula {
    let mut whole = Formula::default();
    let (mut below, mut indent) = (None, 0.0);
    while !rest.is_empty() {
        let count = on_line(&rest, (indent, size_pt), max_width);
        let mut line = Formula { width: indent, ..Formula::default() };
        for (unit, _) in rest.drain(..count) {
            let at = [line.width, 0.0];
            line.put(unit, at);
        }
        below = Some(add_line(&mut whole, line, below, size_pt));
        // What goes on is set in.
        indent = rest.first().map_or(0.0, |(unit, _)| size_pt.min((max_width - unit.width).max(0.0)));
    }
    whole
}

/// How many of `units` stand on a line that begins with an indent. A line rather ends before its second equals sign than within the sum
/// behind it, if all of that fits on the next one: `u = … = 0.4` must not be read where `= 0.4 + …` goes on.
fn on_line(units: &[(Formula, bool)], (indent, size_pt): (f32, f32), max_width: f32) -> usize {
    let mut width = indent;
    let fits = |(unit, _): &&(Formula, bool)| {
        width += unit.width;
        width <= max_width
    };
    let most = units.iter().take_while(fits).count().max(1);
    if most == units.len() || units[most].1 {
        return most;
    }
    let Some(sign) = (1..most).filter(|i| units[*i].1).skip(1).last() else { return most };
    let end = (sign + 1..units.len()).find(|i| units[*i].1).unwrap_or(units.len());
    let side: f32 = units[sign..end].iter().map(|(unit, _)| unit.width).sum();
    if size_pt + side <= max_width { sign } else { most }
}

/// Sets `line` under the others; gives the y of its lower edge.
fn add_line(whole: &mut Formula, line: Formula, below: Option<f32>, size_pt: f32) -> f32 {
    let baseline = below.map_or(0.0, |y| y + 0.3 * size_pt + line.ascent);
    let lower = baseline + line.descent;
    whole.put(line, [0.0, baseline]);
    lower
}

/// The letters of an index such as xy, which stand as close to each other as those of a word.
fn letters(script: &Math) -> Option<String> {
    let Math::Row(parts) = script else { return None };
    parts.iter().map(|part| if let Math::Var(name) = part { Some(*name) } else { None }).collect()
}

/// A sign over a letter.
#[derive(Clone, Copy)]
enum Over {
    /// That of a mean.
    Bar,
    /// That of an estimate.
    Hat,
}

struct Setter<'a> {
    measure: &'a mut dyn Measure,
}

impl Setter<'_> {
    fn set(&mut self, math: &Math, size: f32) -> Formula {
        match math {
            Math::Text(text, role) => self.text(text, size, Face::Sans, *role),
            Math::Value(value, style) => {
                let shown = style.text(value);
                let mut set = self.text(&shown, size, Face::Sans, value.role);
                let rect = Rect::between([0.0, -set.ascent], [set.width, set.descent]);
                set.values.push(Placed { rect, of: value.of, shown });
                set
            }
            Math::Var(name) => self.text(name, size, Face::Italic, None),
            Math::Bold(name) => self.text(name, size, Face::Bold, None),
            Math::Row(parts) => self.row(parts, size),
            Math::Sub(base, index) => self.script(base, index, size, [0.04, 0.22]).named(math),
            Math::Sup(base, exponent) => {
                let set = self.script(base, exponent, size, [0.06, -0.38]);
                // P with a minus sign is a symbol, P squared is an expression.
                if matches!(&**exponent, Math::Text(sign, _) if sign == "−") { set.named(math) } else { set }
            }
            Math::Frac(top, bottom) => self.fraction(top, bottom, size),
            Math::Sum(index) => self.sum(index, size),
            Math::Abs(inner) => self.bars(inner, size),
            Math::Sqrt(inner) => self.root(inner, size),
            Math::Bar(inner) => self.over(inner, Over::Bar, size).named(math),
            Math::Hat(inner) => self.over(inner, Over::Hat, size).named(math),
            Math::Matrix(rows) => self.matrix(rows, size),
        }
    }

    /// A box to write so many letters in.
    fn blank(letters: usize, size: f32) -> Formula {
        let ([up, down], gap, line) = (BLANK_HEIGHTS.map(|height| height * size), 0.1 * size, thickness(size));
        let right = gap + BLANK_LETTER * size * letters as f32;
        let corners = vec![[gap, -up], [right, -up], [right, down], [gap, down], [gap, -up]];
        let pieces = vec![Piece::Stroke(corners, line)];
        let (ascent, descent) = (up + line, down + line);
        Formula { width: right + gap, ascent, descent, pieces, symbols: Vec::new(), values: Vec::new() }
    }

    fn text(&mut self, text: &str, size_pt: f32, face: Face, role: Option<Role>) -> Formula {
        if text.starts_with(BLANK) {
            return Self::blank(text.chars().count(), size_pt);
        }
        let width = self.measure.width(text, size_pt, face);
        let piece = Piece::Text { at: [0.0; 2], text: text.into(), size_pt, face, role };
        let (ascent, descent) = (ASCENT * size_pt, DESCENT * size_pt);
        let mut symbols = Vec::new();
        if text.contains(char::is_alphabetic) {
            symbols.push((Rect::between([0.0, -ascent], [width, descent]), text.trim().to_owned()));
        }
        Formula { width, ascent, descent, pieces: vec![piece], symbols, values: Vec::new() }
    }

    fn row(&mut self, parts: &[Math], size: f32) -> Formula {
        let mut row = Formula::default();
        for part in parts {
            let part = self.set(part, size);
            let at = [row.width, 0.0];
            row.put(part, at);
        }
        row
    }

    fn script(&mut self, base: &Math, script: &Math, size: f32, offset: Point) -> Formula {
        let mut whole = self.set(base, size);
        let script = match letters(script) {
            Some(word) => self.text(&word, size * SMALL, Face::Italic, None),
            None => self.set(script, size * SMALL),
        };
        let at = [whole.width + offset[0] * size, offset[1] * size];
        whole.put(script, at);
        whole
    }

    fn fraction(&mut self, top: &Math, bottom: &Math, size: f32) -> Formula {
        let (top, bottom) = (self.set(top, 0.9 * size), self.set(bottom, 0.9 * size));
        let (gap, thickness) = (0.08 * size, thickness(size));
        let margin = 0.12 * size;
        let width = top.width.max(bottom.width) + 2.0 * margin;
        let mut whole = Formula::default();
        let bar = Rect::between([0.04 * size, -AXIS * size - thickness], [width, -AXIS * size]);
        let up = [(width - top.width) / 2.0, bar.min[1] - gap - top.descent];
        let down = [(width - bottom.width) / 2.0, bar.max[1] + gap + bottom.ascent];
        whole.put(top, up);
        whole.put(bottom, down);
        whole.pieces.push(Piece::Rule(bar));
        whole.width = width + 0.04 * size;
        whole
    }

    /// A large sign with its range below it; without a range it is no higher than the line.
    fn sum(&mut self, index: &Math, size: f32) -> Formula {
        if index.plain().is_empty() {
            return self.text("Σ ", size, Face::Sans, None);
        }
        let large = 1.5 * size;
        let mut sign = self.text("Σ", large, Face::Sans, None);
        let index = self.set(index, 0.66 * size);
        let sink = CAP * large / 2.0 - AXIS * size;
        (sign.ascent, sign.descent) = (CAP * large, 0.08 * size);
        let width = sign.width.max(index.width);
        let under = sink + 0.12 * size + index.ascent;
        let mut whole = Formula::default();
        let at = [(width - sign.width) / 2.0, sink];
        whole.put(sign, at);
        let at = [(width - index.width) / 2.0, under];
        whole.put(index, at);
        whole.width = width + 0.18 * size;
        whole
    }

    fn bars(&mut self, inner: &Math, size: f32) -> Formula {
        let inner = self.set(inner, size);
        let (margin, thickness) = (0.14 * size, thickness(size));
        let (up, down) = (inner.ascent + 0.04 * size, inner.descent + 0.02 * size);
        let right = inner.width + 2.0 * margin + thickness;
        let bar = |x: f32| Piece::Rule(Rect::between([x, -up], [x + thickness, down]));
        let mut whole = Formula::default();
        whole.put(inner, [margin + thickness, 0.0]);
        whole.pieces.extend([bar(0.06 * size), bar(right - 0.06 * size)]);
        (whole.ascent, whole.descent) = (whole.ascent.max(up), whole.descent.max(down));
        whole.width = right + thickness;
        whole
    }

    fn root(&mut self, inner: &Math, size: f32) -> Formula {
        let inner = self.set(inner, size);
        let thickness = thickness(size);
        let (up, down) = (inner.ascent + 0.06 * size, inner.descent);
        let left = 0.62 * size;
        let right = left + inner.width + 0.1 * size;
        // The sign: a short stroke, down to the foot, up to the bar.
        let hook = down - 0.42 * (up + down).min(1.1 * size);
        let foot = down - thickness / 2.0;
        let sign = [[0.06, 0.06], [0.2, 0.0]].map(|[x, y]| [x * size, hook + y * size]);
        let bar = -up + thickness / 2.0;
        let points = [sign[0], sign[1], [0.36 * size, foot], [left - 0.02 * size, bar], [right, bar]].to_vec();
        let mut whole = Formula::default();
        whole.put(inner, [left + 0.04 * size, 0.0]);
        whole.pieces.push(Piece::Stroke(points, thickness));
        whole.ascent = whole.ascent.max(up + 0.04 * size);
        whole.width = right + 0.06 * size;
        whole
    }

    /// `inner` under a sign; an index stands outside the sign over its letter.
    fn over(&mut self, inner: &Math, sign: Over, size: f32) -> Formula {
        let is_low = matches!(letter(inner), Some(c) if "acemnorsuvwxyzμνρσ".contains(c));
        let is_italic = !matches!(inner, Math::Text(..) | Math::Bold(_));
        let (base, index) = match inner {
            Math::Sub(base, index) => (base.as_ref(), Some(index.as_ref())),
            other => (other, None),
        };
        let mut whole = self.set(base, size);
        let thickness = thickness(size);
        let bottom = -(if is_low { LOW } else { whole.ascent.max(CAP * size) / size } + 0.08) * size;
        let lean = if is_italic { 0.06 * size } else { 0.0 };
        match sign {
            Over::Bar => {
                let ends = [[0.03 * size + lean, bottom - thickness], [whole.width - 0.05 * size + lean, bottom]];
                whole.pieces.push(Piece::Rule(Rect::between(ends[0], ends[1])));
                whole.ascent = whole.ascent.max(thickness - bottom + 0.04 * size);
            }
            Over::Hat => {
                let (middle, half, height) = (whole.width / 2.0 + lean, 0.18 * size, 0.14 * size);
                let points = [[-half, 0.0], [0.0, -height], [half, 0.0]].map(|[x, y]| [middle + x, bottom + y]);
                whole.pieces.push(Piece::Stroke(points.to_vec(), thickness));
                whole.ascent = whole.ascent.max(height + thickness - bottom + 0.04 * size);
            }
        }
        if let Some(index) = index {
            let index = self.set(index, size * SMALL);
            let at = [whole.width + 0.04 * size, 0.22 * size];
            whole.put(index, at);
        }
        whole
    }

    fn matrix(&mut self, rows: &[Vec<Math>], size: f32) -> Formula {
        let cells: Vec<Vec<Formula>> =
            rows.iter().map(|row| row.iter().map(|entry| self.set(entry, size)).collect()).collect();
        let columns = cells.iter().map(Vec::len).max().unwrap_or(0);
        let of_column = |i: usize| cells.iter().filter_map(move |row| row.get(i));
        let widths: Vec<f32> = (0..columns).map(|i| of_column(i).map(|cell| cell.width).fold(0.0, f32::max)).collect();
        // Numbers end below each other, symbols stand in the middle.
        let are_numbers: Vec<bool> =
            (0..columns).map(|i| rows.iter().filter_map(|row| row.get(i)).all(is_number)).collect();
        let (row_gap, column_gap, thickness) = (0.22 * size, 0.8 * size, thickness(size));
        let heights = cells.iter().map(|row| {
            let of = |f: fn(&Formula) -> f32| row.iter().map(f).fold(0.0, f32::max);
            [of(|cell| cell.ascent).max(ASCENT * size), of(|cell| cell.descent).max(DESCENT * size)]
        });
        let heights: Vec<[f32; 2]> = heights.collect();
        let inside = heights.iter().flatten().sum::<f32>() + row_gap * heights.len().saturating_sub(1) as f32;
        let (top, left) = (-AXIS * size - inside / 2.0, 0.34 * size);
        let mut whole = Formula::default();
        let mut y = top;
        for (row, [ascent, descent]) in cells.into_iter().zip(heights) {
            let mut x = left;
            for (i, cell) in row.into_iter().enumerate() {
                let spare = widths[i] - cell.width;
                let at = [x + if are_numbers[i] { spare } else { spare / 2.0 }, y + ascent];
                whole.put(cell, at);
                x += widths[i] + column_gap;
            }
            y += ascent + descent + row_gap;
        }
        let inner = widths.iter().sum::<f32>() + column_gap * columns.saturating_sub(1) as f32;
        let right = 2.0 * left + inner;
        let (upper, lower) = (top - 0.04 * size, top + inside + 0.04 * size);
        let mut rule = |min: Point, max: Point| whole.pieces.push(Piece::Rule(Rect::between(min, max)));
        for (x, inwards) in [(0.1 * size, 1.0), (right - 0.1 * size, -1.0)] {
            let ends = |length: f32| [x.min(x + inwards * length), x.max(x + inwards * length)];
            let ([x0, x1], [_, tip]) = (ends(thickness), ends(0.18 * size));
            let from = if inwards > 0.0 { x0 } else { ends(0.18 * size)[0] };
            let to = if inwards > 0.0 { tip } else { x1 };
            rule([x0, upper], [x1, lower]);
            rule([from, upper], [to, upper + thickness]);
            rule([from, lower - thickness], [to, lower]);
        }
        (whole.ascent, whole.descent) = (whole.ascent.max(-upper), whole.descent.max(lower));
        whole.width = right;
        whole
    }
}

/// The letter that `math` is, its index apart, if it is just one.
fn letter(math: &Math) -> Option<char> {
    match math {
        Math::Var(name) | Math::Bold(name) => Some(name.chars().next()?).filter(|_| name.chars().count() == 1),
        Math::Sub(base, _) => letter(base),
        _ => None,
    }
}

/// Whether an entry is a number in digits.
fn is_number(math: &Math) -> bool {
    let Math::Text(text, _) = math else { return false };
    text.trim_start_matches('−').starts_with(|c: char| c.is_ascii_digit())
}

fn thickness(size_pt: f32) -> f32 {
    (size_pt / 14.0).max(1.0)
}

/// The program's own type.
struct Fonts;

impl Measure for Fonts {
    fn width(&mut self, text: &str, size_pt: f32, face: Face) -> f32 {
        fonts::width(text, face, size_pt)
    }
}

/// `math` in the program's own type, at most `max_width` points wide where it can be broken.
pub fn typeset(math: &Math, size_pt: f32, max_width: f32) -> Formula {
    lay_out(math, size_pt, max_width, &mut Fonts)
}

impl Formula {
    /// The formula with its upper left corner at `at`.
    pub fn primitives(&self, at: Point, theme: Theme) -> Vec<Primitive> {
        let origin = [at[0], at[1] + self.ascent];
        let text = theme.chrome().text;
        let piece = |piece: &Piece| match piece {
            Piece::Rule(rect) => Primitive::Polygon { points: rect.moved(origin).corners(), color: text },
            Piece::Stroke(points, width) => {
                let points = points.iter().map(|at| [0, 1].map(|i| origin[i] + at[i])).collect();
                Primitive::Polyline { points, closed: false, stroke: solid(*width, text) }
            }
            Piece::Text { at, text: words, size_pt, face, role } => {
                let run = Run::new(words, role.map_or(text, |role| theme.word(role))).face(*face);
                let at = [0, 1].map(|i| origin[i] + at[i]);
                Primitive::Text(Line { at, anchor: Anchor::Start, size: *size_pt, runs: vec![run], halo: None })
            }
        };
        self.pieces.iter().map(piece).collect()
    }
}

#[cfg(test)]
mod tests;
