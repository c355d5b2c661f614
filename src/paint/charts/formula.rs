//! Typesetting of [`Math`]: a layout that can be measured, and its primitives.

use motionscope_core::Role;
use motionscope_core::scene::Math;

use super::super::primitive::{Anchor, Line, Point, Primitive, Rect, Run};
use super::super::{Face, Theme, fonts};

/// Heights as fractions of the type size, common to the sans faces in use.
const ASCENT: f32 = 0.78;
const DESCENT: f32 = 0.24;
const CAP: f32 = 0.73;
/// Height of the axis, on which fraction bars and sums are centred, above the baseline.
const AXIS: f32 = 0.27;
const SMALL: f32 = 0.72;
/// Below this a formula becomes unreadable; it then runs on rather than shrink.
const SMALLEST: f32 = 0.7;

/// What a layout needs to know of a font.
pub trait Measure {
    /// Advance width of `text` at `size_pt`.
    fn width(&mut self, text: &str, size_pt: f32, italic: bool) -> f32;
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
        /// Whether it is a variable.
        italic: bool,
        /// The role whose colour it carries.
        role: Option<Role>,
    },
    /// A filled rectangle: a fraction bar, or the bar of an absolute value.
    Rule(Rect),
}

impl Piece {
    fn shift(&mut self, by: Point) {
        match self {
            Piece::Text { at, .. } => *at = [0, 1].map(|i| at[i] + by[i]),
            Piece::Rule(rect) => *rect = rect.moved(by),
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
}

impl Formula {
    /// Width and height in points.
    pub fn size(&self) -> [f32; 2] {
        [self.width, self.ascent + self.descent]
    }

    /// Sets `other` with its left end at `at`.
    fn put(&mut self, mut other: Formula, at: Point) {
        other.pieces.iter_mut().for_each(|piece| piece.shift(at));
        self.pieces.append(&mut other.pieces);
        self.width = self.width.max(at[0] + other.width);
        self.ascent = self.ascent.max(other.ascent - at[1]);
        self.descent = self.descent.max(other.descent + at[1]);
    }
}

/// Lays `math` out at `size_pt`; a row at the top level is broken where it exceeds `max_width`.
///
/// What cannot be broken is made smaller, down to seven tenths.
pub fn lay_out(math: &Math, size_pt: f32, max_width: f32, measure: &mut dyn Measure) -> Formula {
    let parts = match math {
        Math::Row(parts) => parts.as_slice(),
        other => std::slice::from_ref(other),
    };
    let first = units(parts, size_pt, measure);
    let widest = first.iter().map(|unit| unit.width).fold(0.0, f32::max);
    if widest <= max_width {
        return break_lines(first, size_pt, max_width);
    }
    let size_pt = size_pt * (max_width / widest).clamp(SMALLEST, 1.0);
    break_lines(units(parts, size_pt, measure), size_pt, max_width)
}

/// What stays together on a line: a term with the operators before it.
fn units(parts: &[Math], size: f32, measure: &mut dyn Measure) -> Vec<Formula> {
    let mut units = Vec::new();
    let mut unit = Formula::default();
    for part in parts {
        let at = [unit.width, 0.0];
        unit.put(Setter { measure: &mut *measure }.set(part, size), at);
        if !is_operator(part) {
            units.push(std::mem::take(&mut unit));
        }
    }
    if !unit.pieces.is_empty() {
        units.push(unit);
    }
    units
}

/// Whether `math` stands between two terms, so that a line may end before it but not after it.
fn is_operator(math: &Math) -> bool {
    match math {
        Math::Text(text, None) => !text.contains(char::is_alphanumeric) && text.ends_with(' '),
        Math::Sum(_) => true,
        _ => false,
    }
}

/// Sets units in lines.
fn break_lines(units: Vec<Formula>, size_pt: f32, max_width: f32) -> Formula {
    let mut whole = Formula::default();
    let mut line = Formula::default();
    let mut below = None;
    for unit in units {
        if line.width > 0.0 && line.width + unit.width > max_width {
            let full = std::mem::take(&mut line);
            below = Some(add_line(&mut whole, full, below, size_pt));
            // What goes on is set in.
            line.width = size_pt.min((max_width - unit.width).max(0.0));
        }
        let at = [line.width, 0.0];
        line.put(unit, at);
    }
    add_line(&mut whole, line, below, size_pt);
    whole
}

/// Sets `line` under the others; gives the y of its lower edge.
fn add_line(whole: &mut Formula, line: Formula, below: Option<f32>, size_pt: f32) -> f32 {
    let baseline = below.map_or(0.0, |y| y + 0.3 * size_pt + line.ascent);
    let lower = baseline + line.descent;
    whole.put(line, [0.0, baseline]);
    lower
}

struct Setter<'a> {
    measure: &'a mut dyn Measure,
}

impl Setter<'_> {
    fn set(&mut self, math: &Math, size: f32) -> Formula {
        match math {
            Math::Text(text, role) => self.text(text, size, false, *role),
            Math::Var(name) => self.text(name, size, true, None),
            Math::Row(parts) => self.row(parts, size),
            Math::Sub(base, index) => self.script(base, index, size, [0.04, 0.22]),
            Math::Sup(base, exponent) => self.script(base, exponent, size, [0.06, -0.38]),
            Math::Frac(top, bottom) => self.fraction(top, bottom, size),
            Math::Sum(index) => self.sum(index, size),
            Math::Abs(inner) => self.bars(inner, size),
        }
    }

    fn text(&mut self, text: &str, size_pt: f32, italic: bool, role: Option<Role>) -> Formula {
        let width = self.measure.width(text, size_pt, italic);
        let piece = Piece::Text { at: [0.0; 2], text: text.into(), size_pt, italic, role };
        Formula { width, ascent: ASCENT * size_pt, descent: DESCENT * size_pt, pieces: vec![piece] }
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
        let script = self.set(script, size * SMALL);
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

    fn sum(&mut self, index: &Math, size: f32) -> Formula {
        let large = 1.5 * size;
        let mut sign = self.text("Σ", large, false, None);
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
}

fn thickness(size_pt: f32) -> f32 {
    (size_pt / 14.0).max(1.0)
}

/// The program's own type.
struct Fonts;

impl Measure for Fonts {
    fn width(&mut self, text: &str, size_pt: f32, italic: bool) -> f32 {
        fonts::width(text, face(italic), size_pt)
    }
}

fn face(italic: bool) -> Face {
    if italic { Face::Italic } else { Face::Sans }
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
            Piece::Text { at, text: words, size_pt, italic, role } => {
                let run = Run::new(words, role.map_or(text, |role| theme.word(role))).face(face(*italic));
                let at = [0, 1].map(|i| origin[i] + at[i]);
                Primitive::Text(Line { at, anchor: Anchor::Start, size: *size_pt, runs: vec![run], halo: None })
            }
        };
        self.pieces.iter().map(piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every letter is half as wide as its size.
    struct Half;

    impl Measure for Half {
        fn width(&mut self, text: &str, size_pt: f32, _: bool) -> f32 {
            text.chars().count() as f32 * size_pt / 2.0
        }
    }

    fn set(math: &Math, max_width: f32) -> Formula {
        lay_out(math, 20.0, max_width, &mut Half)
    }

    fn baselines(formula: &Formula) -> Vec<f32> {
        let y = |piece: &Piece| match piece {
            Piece::Text { at, .. } => Some(at[1]),
            Piece::Rule(_) => None,
        };
        formula.pieces.iter().filter_map(y).collect()
    }

    #[test]
    fn a_row_stands_on_one_baseline() {
        let row = Math::Row(vec![Math::text("ab"), Math::Abs(Box::new(Math::Var("x"))), Math::text("c")]);
        let row = set(&row, 1000.0);
        assert_eq!(baselines(&row), [0.0; 3]);
        assert!(row.width > 4.0 * 10.0, "the bars take room");
    }

    #[test]
    fn scripts_are_smaller_and_off_the_baseline() {
        let sub = set(&Math::indexed(Math::Var("I"), Math::Var("t")), 100.0);
        let sup = set(&Math::power(Math::Var("x"), Math::text("2")), 100.0);
        assert!(baselines(&sub)[1] > 0.0 && baselines(&sup)[1] < 0.0);
        let small = |f: &Formula| matches!(f.pieces[1], Piece::Text { size_pt, .. } if size_pt < 20.0);
        assert!(small(&sub) && small(&sup));
        assert!(sub.descent > set(&Math::Var("I"), 100.0).descent);
    }

    #[test]
    fn a_fraction_stands_over_and_under_its_bar() {
        let frac = set(&Math::Frac(Box::new(Math::text("812")), Box::new(Math::text("256"))), 100.0);
        let [top, bottom] = baselines(&frac)[..] else { panic!("two texts") };
        let Some(Piece::Rule(bar)) = frac.pieces.last() else { panic!("a bar") };
        assert!(top < bar.min[1] && bottom - CAP * 18.0 > bar.max[1]);
    }

    #[test]
    fn a_long_row_is_broken_and_nothing_is_lost() {
        let parts: Vec<_> = (0..12).map(|i| Math::text(format!("+ {i:02}"))).collect();
        let wide = set(&Math::Row(parts.clone()), 1000.0);
        let narrow = set(&Math::Row(parts), 130.0);
        assert_eq!(wide.pieces.len(), narrow.pieces.len());
        assert!(narrow.width <= 130.0 && narrow.descent > 2.0 * wide.descent);
        let ends = narrow.pieces.iter().map(|p| match p {
            Piece::Text { at, text, size_pt, .. } => at[0] + text.chars().count() as f32 * size_pt / 2.0,
            Piece::Rule(rect) => rect.max[0],
        });
        assert!(ends.fold(0.0, f32::max) <= 130.0);
    }

    #[test]
    fn an_operator_goes_with_what_follows_it() {
        let row = Math::Row(vec![Math::text("aaaa"), Math::text(" + "), Math::text("bbbb")]);
        let formula = set(&row, 75.0);
        let ys = baselines(&formula);
        assert!(ys[0] < ys[1] && ys[1] == ys[2], "{ys:?}");
    }

    #[test]
    fn a_term_too_wide_with_its_operators_shrinks() {
        let long = vec![Math::Sum(Box::new(Math::text("x, y"))), Math::Abs(Box::new(Math::text("0123456789")))];
        assert!(set(&Math::Row(long), 120.0).width <= 120.0);
    }

    #[test]
    fn what_cannot_be_broken_shrinks() {
        let long = Math::Abs(Box::new(Math::text("0123456789")));
        assert!(set(&long, 90.0).width <= 90.0);
        assert!(set(&long, 10.0).width > 10.0, "but stays readable");
    }
}
