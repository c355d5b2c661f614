//! Typesetting of [`Math`]: a layout that can be measured and tested, and its painting.

use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{self, Color32, Rect, Vec2, pos2, vec2};
use motionscope_core::Role;
use motionscope_core::scene::Math;

use crate::paint::Face;
use crate::ui::drawing::ink;

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
        at: Vec2,
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
    fn shift(&mut self, by: Vec2) {
        match self {
            Piece::Text { at, .. } => *at += by,
            Piece::Rule(rect) => *rect = rect.translate(by),
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
    pub fn size(&self) -> Vec2 {
        vec2(self.width, self.ascent + self.descent)
    }

    /// Sets `other` with its left end at `at`.
    fn put(&mut self, mut other: Formula, at: Vec2) {
        other.pieces.iter_mut().for_each(|piece| piece.shift(at));
        self.pieces.append(&mut other.pieces);
        self.width = self.width.max(at.x + other.width);
        self.ascent = self.ascent.max(other.ascent - at.y);
        self.descent = self.descent.max(other.descent + at.y);
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
        let at = vec2(unit.width, 0.0);
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
        let at = vec2(line.width, 0.0);
        line.put(unit, at);
    }
    add_line(&mut whole, line, below, size_pt);
    whole
}

/// Sets `line` under the others; gives the y of its lower edge.
fn add_line(whole: &mut Formula, line: Formula, below: Option<f32>, size_pt: f32) -> f32 {
    let baseline = below.map_or(0.0, |y| y + 0.3 * size_pt + line.ascent);
    let lower = baseline + line.descent;
    whole.put(line, vec2(0.0, baseline));
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
            Math::Sub(base, index) => self.script(base, index, size, vec2(0.04, 0.22)),
            Math::Sup(base, exponent) => self.script(base, exponent, size, vec2(0.06, -0.38)),
            Math::Frac(top, bottom) => self.fraction(top, bottom, size),
            Math::Sum(index) => self.sum(index, size),
            Math::Abs(inner) => self.bars(inner, size),
        }
    }

    fn text(&mut self, text: &str, size_pt: f32, italic: bool, role: Option<Role>) -> Formula {
        let width = self.measure.width(text, size_pt, italic);
        let piece = Piece::Text { at: Vec2::ZERO, text: text.into(), size_pt, italic, role };
        Formula { width, ascent: ASCENT * size_pt, descent: DESCENT * size_pt, pieces: vec![piece] }
    }

    fn row(&mut self, parts: &[Math], size: f32) -> Formula {
        let mut row = Formula::default();
        for part in parts {
            let part = self.set(part, size);
            let at = vec2(row.width, 0.0);
            row.put(part, at);
        }
        row
    }

    fn script(&mut self, base: &Math, script: &Math, size: f32, offset: Vec2) -> Formula {
        let mut whole = self.set(base, size);
        let script = self.set(script, size * SMALL);
        let at = vec2(whole.width + offset.x * size, offset.y * size);
        whole.put(script, at);
        whole
    }

    fn fraction(&mut self, top: &Math, bottom: &Math, size: f32) -> Formula {
        let (top, bottom) = (self.set(top, 0.9 * size), self.set(bottom, 0.9 * size));
        let (gap, thickness) = (0.08 * size, thickness(size));
        let margin = 0.12 * size;
        let width = top.width.max(bottom.width) + 2.0 * margin;
        let mut whole = Formula::default();
        let bar = Rect::from_min_max(pos2(0.04 * size, -AXIS * size - thickness), pos2(width, -AXIS * size));
        let up = vec2((width - top.width) / 2.0, bar.min.y - gap - top.descent);
        let down = vec2((width - bottom.width) / 2.0, bar.max.y + gap + bottom.ascent);
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
        let at = vec2((width - sign.width) / 2.0, sink);
        whole.put(sign, at);
        let at = vec2((width - index.width) / 2.0, under);
        whole.put(index, at);
        whole.width = width + 0.18 * size;
        whole
    }

    fn bars(&mut self, inner: &Math, size: f32) -> Formula {
        let inner = self.set(inner, size);
        let (margin, thickness) = (0.14 * size, thickness(size));
        let (up, down) = (inner.ascent + 0.04 * size, inner.descent + 0.02 * size);
        let right = inner.width + 2.0 * margin + thickness;
        let bar = |x: f32| Piece::Rule(Rect::from_min_max(pos2(x, -up), pos2(x + thickness, down)));
        let mut whole = Formula::default();
        whole.put(inner, vec2(margin + thickness, 0.0));
        whole.pieces.extend([bar(0.06 * size), bar(right - 0.06 * size)]);
        (whole.ascent, whole.descent) = (whole.ascent.max(up), whole.descent.max(down));
        whole.width = right + thickness;
        whole
    }
}

fn thickness(size_pt: f32) -> f32 {
    (size_pt / 14.0).max(1.0)
}

/// Colours and size of a formula in the window.
#[derive(Clone, Copy)]
pub struct Ink<'a> {
    /// Type size in points.
    pub size_pt: f32,
    /// Colour of what has no role.
    pub text: Color32,
    /// Colour of a role.
    pub role: &'a dyn Fn(Role) -> Color32,
}

/// Measures with the fonts of a window.
pub struct Fonts<'a>(pub &'a egui::Painter);

impl Measure for Fonts<'_> {
    fn width(&mut self, text: &str, size_pt: f32, italic: bool) -> f32 {
        self.0.layout_job(job(text, size_pt, italic, Color32::PLACEHOLDER)).size().x
    }
}

fn job(text: &str, size_pt: f32, italic: bool, color: Color32) -> LayoutJob {
    let font = ink::font(if italic { Face::Italic } else { Face::Sans }, size_pt);
    let mut job = LayoutJob::single_section(text.into(), TextFormat::simple(font, color));
    job.keep_trailing_whitespace = true;
    job.round_output_to_gui = false;
    job
}

/// Paints `formula` with its upper left corner at `at`.
pub fn paint(painter: &egui::Painter, at: egui::Pos2, formula: &Formula, ink: &Ink<'_>) {
    let origin = at.to_vec2() + vec2(0.0, formula.ascent);
    for piece in &formula.pieces {
        match piece {
            Piece::Rule(rect) => {
                painter.rect_filled(rect.translate(origin), 0.0, ink.text);
            }
            // Of no letters, not even the place is known.
            Piece::Text { text, .. } if text.is_empty() => {}
            Piece::Text { at, text, size_pt, italic, role } => {
                let color = role.map_or(ink.text, |role| (ink.role)(role));
                let galley = painter.layout_job(job(text, *size_pt, *italic, color));
                let baseline = galley.rows.first().and_then(|row| row.glyphs.first()).map_or(0.0, |glyph| glyph.pos.y);
                painter.galley((origin + *at - vec2(0.0, baseline)).to_pos2(), galley, color);
            }
        }
    }
}

/// Shows `math` in as much width as there is; its accessible name is [`Math::plain`].
pub fn show(ui: &mut egui::Ui, math: &Math, ink: &Ink<'_>) -> egui::Response {
    let formula = lay_out(math, ink.size_pt, ui.available_width(), &mut Fonts(ui.painter()));
    let (rect, response) = ui.allocate_exact_size(formula.size(), egui::Sense::hover());
    ink::name(&response, || math.plain());
    if ui.is_rect_visible(rect) {
        paint(ui.painter(), rect.min, &formula, ink);
    }
    response
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
            Piece::Text { at, .. } => Some(at.y),
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
        assert!(top < bar.min.y && bottom - CAP * 18.0 > bar.max.y);
    }

    #[test]
    fn a_long_row_is_broken_and_nothing_is_lost() {
        let parts: Vec<_> = (0..12).map(|i| Math::text(format!("+ {i:02}"))).collect();
        let wide = set(&Math::Row(parts.clone()), 1000.0);
        let narrow = set(&Math::Row(parts), 130.0);
        assert_eq!(wide.pieces.len(), narrow.pieces.len());
        assert!(narrow.width <= 130.0 && narrow.descent > 2.0 * wide.descent);
        let ends = narrow.pieces.iter().map(|p| match p {
            Piece::Text { at, text, size_pt, .. } => at.x + text.chars().count() as f32 * size_pt / 2.0,
            Piece::Rule(rect) => rect.max.x,
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
