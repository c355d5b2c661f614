//! Definitions of terms where the pointer or the keyboard is, and what on the stage they stand for.
//!
//! A `Block` of the explanation knows the positions of its terms, its symbols and the words in the colour of a role. Whatever
//! the pointer is on is looked up in the legend of the scene (`Beside`), and the marks of that role are shown alone.

use std::cell::Cell;

use eframe::egui::{self, Id, PopupAnchor, Rect, Response, RichText, Sense, Shape, Tooltip, Ui, Vec2, WidgetInfo};
use motionscope_core::base::words::capital;
use motionscope_core::course::glossary::{Chapter, GLOSSARY, Term, chapters_of, find, in_family, occurrences, role_of};
use motionscope_core::scene::{Role, Scene, Value, Variable, latex};

use crate::paint::charts::explanation::Block;
use crate::paint::{Theme, legend};
use crate::ui::drawing::chart::rect_from;
use crate::ui::drawing::{ink, primitives, style};

/// Terms defined per text at most.
const MOST: usize = 4;
/// Width of a tooltip, in sizes of its type.
const WIDTH: f32 = 20.0;

/// A word, a symbol or a number with a meaning, where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Where it stands, from the origin of its part on.
    pub rect: Rect,
    /// What it means.
    pub meaning: Meaning,
}

/// What a word, a symbol or a number means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// The term that it is: underlined.
    Word(&'static Term),
    /// The term that it is the symbol of.
    Symbol(&'static Term),
    /// The value that it is, or that it is the symbol of.
    Value(&'static Variable),
    /// The marks of the role in whose colour it stands.
    Marks(Role),
}

/// The stage beside a text: what is pointed at in the text is pointed out on it.
pub struct Beside<'a> {
    scene: &'a Scene,
    family: &'a str,
    theme: Theme,
    pointed: Cell<Option<Marked>>,
}

/// The role of marks, and what the legend says of them.
pub type Marked = (Role, &'static str);

impl<'a> Beside<'a> {
    /// The stage that shows `scene`, of an estimator of this family.
    pub fn new(scene: &'a Scene, family: &'a str, theme: Theme) -> Self {
        Self { scene, family, theme, pointed: Cell::new(None) }
    }

    /// The role whose words, symbol or number is pointed at.
    pub fn pointed(&self) -> Option<Role> {
        self.pointed.get().map(|(role, _)| role)
    }

    /// The marks that `meaning` stands for; `None` if no such mark is there.
    fn marks(&self, meaning: Meaning) -> Option<Marked> {
        let is_there = |role: Role| {
            self.scene.marks.iter().any(|mark| mark.role == role)
                || self.scene.links.iter().any(|link| link.role == role)
        };
        let is_meant = |found: &'static Term, term: &'static Term| std::ptr::eq(in_family(found, self.family), term);
        let is_named = |term, says: &str| occurrences(says).iter().any(|(_, found)| is_meant(found, term));
        // The shortest is about nothing else: “candidate” rather than “next candidates”.
        let entry = |is_meant: &dyn Fn(Role, &str) -> bool| {
            let entries = self.scene.legend.iter().filter(|(role, says)| is_meant(*role, says) && is_there(*role));
            entries.min_by_key(|(_, says)| says.len()).copied()
        };
        match meaning {
            Meaning::Marks(of) => entry(&|role, _| role == of),
            Meaning::Value(of) => of.role.and_then(|of| entry(&|role, _| role == of)),
            Meaning::Word(term) | Meaning::Symbol(term) => {
                let usual = role_of(term, self.family);
                entry(&|_, says| is_named(term, says)).or_else(|| entry(&|role, _| Some(role) == usual))
            }
        }
    }
}

/// The terms, values, symbols, and words in the colours of roles, of a part of an explanation. A symbol is that of one of the step's
/// `values`, or else what the chapters of the estimator's `family` say.
pub fn links(block: &Block, (values, family): (&[Value], &str)) -> Vec<Link> {
    let link = |rect: &_, meaning| Link { rect: rect_from(*rect), meaning };
    let predicted = block.symbols.iter().filter(|(_, name)| without_minus(name).is_some());
    let predicted = predicted.map(|(rect, _)| link(rect, Meaning::Marks(Role::Predicted)));
    let marks = block.roles.iter().map(|(rect, role)| link(rect, Meaning::Marks(*role))).chain(predicted);
    let words = block.terms.iter().map(|(rect, term)| link(rect, Meaning::Word(in_family(term, family))));
    let means = |name| of_values(name, values).or_else(|| symbol(name, family).map(Meaning::Symbol));
    let symbols = block.symbols.iter().filter_map(|(rect, name)| Some(link(rect, means(name)?)));
    let values = block.values.iter().map(|(rect, of)| link(rect, Meaning::Value(of)));
    marks.chain(words).chain(symbols).chain(values).collect()
}

/// The value of the step whose symbol is called so.
fn of_values(name: &str, values: &[Value]) -> Option<Meaning> {
    let symbols = |value: &Value| latex::parse(value.of.symbol).is_ok_and(|symbol| symbol.plain() == name);
    values.iter().find(|value| symbols(value)).map(|value| Meaning::Value(value.of))
}

/// What a symbol of a formula means, or a name in it.
pub fn symbol(name: &str, family: &str) -> Option<&'static Term> {
    let plain = plain(without_minus(name).unwrap_or(name));
    let of = |chapter: &Chapter| GLOSSARY.iter().find(|term| term.chapter == *chapter && has_symbol(term, &plain));
    let is_name = name.chars().filter(|c| c.is_alphabetic()).count() > 1;
    let named = || find(name).or_else(|| occurrences(name).first().map(|(_, term)| *term));
    chapters_of(family).iter().find_map(of).or_else(|| if is_name { named() } else { None })
}

/// The symbol of a prediction, `x⁻` or `x^−`, without its minus sign; `None` for others.
fn without_minus(name: &str) -> Option<&str> {
    name.strip_suffix('⁻').or_else(|| name.strip_suffix("^−")).filter(|letter| !letter.is_empty())
}

/// Whether `term` is written so: a symbol of several parts, as (u, v), is that of each part.
fn has_symbol(term: &Term, name: &str) -> bool {
    let Some(symbol) = term.symbol.map(plain) else { return false };
    symbol == name || symbol.trim_matches(['(', ')']).split(", ").any(|part| part == name)
}

/// The same letters with marks of their own.
fn plain(symbol: &str) -> String {
    symbol.replace('\u{16b}', "u\u{304}")
}

/// Underlines the terms among `links` with faint dots, defines what is pointed at, and tells which marks it stands for; `part` is where
/// their part stands.
pub fn sense(ui: &Ui, salt: &str, (links, part): (&[Link], Rect), beside: &Beside<'_>) {
    let by = part.min.to_vec2();
    let color = ui.visuals().weak_text_color();
    let mut is_told = false;
    for (i, link) in links.iter().enumerate() {
        let rect = link.rect.translate(by);
        if !ui.is_rect_visible(rect) {
            continue;
        }
        if let Meaning::Word(_) = link.meaning {
            let ends = [rect.left_bottom(), rect.right_bottom()];
            ui.painter().extend(Shape::dotted_line(&ends, color, 3.0, 0.6));
        }
        let id: Id = ui.scope_id().with(("term", salt, i));
        let sensed = match link.meaning {
            Meaning::Word(term) => {
                let sensed = ui.interact(rect, id, Sense::focusable_noninteractive());
                sensed.widget_info(|| WidgetInfo::labeled(egui::Role::Term, true, term.name));
                sensed
            }
            Meaning::Symbol(_) | Meaning::Value(_) | Meaning::Marks(_) => ui.interact(rect, id, Sense::hover()),
        };
        if !sensed.hovered() && !sensed.has_focus() {
            continue;
        }
        // What is lit is told, also of a term within words in the colour of a role.
        let marks = beside.pointed.get().or_else(|| beside.marks(link.meaning));
        beside.pointed.set(marks);
        // The tooltip of a term in these words tells it as well.
        if matches!(link.meaning, Meaning::Marks(_)) && is_defined(ui, links, by) {
            continue;
        }
        let is_meant = !matches!(link.meaning, Meaning::Marks(_)) || marks.is_some();
        // The letter of a symbol with an index has no tooltip of its own beside that of the symbol.
        if !is_told && is_meant {
            is_told = true;
            below(&sensed, part).show(|ui| tell(ui, link.meaning, marks, beside));
        }
    }
}

/// Highest part whose tooltips stand below all of it, in points.
const LOW_PART: f32 = 180.0;

/// The tooltip of `sensed` below its whole `part`, which is being read; below itself where that is far away. It opens at once where
/// the keyboard is.
fn below(sensed: &Response, part: Rect) -> Tooltip<'static> {
    let mut tooltip = Tooltip::for_enabled(sensed);
    if sensed.has_focus() {
        tooltip.popup = tooltip.popup.open(true);
    }
    if part.height() <= LOW_PART {
        let over = Rect::from_x_y_ranges(sensed.rect.x_range(), part.y_range());
        tooltip.popup = tooltip.popup.anchor(PopupAnchor::ParentRect(over));
    }
    tooltip
}

/// The definition of what is meant, and which marks stand for it.
fn tell(ui: &mut Ui, meaning: Meaning, marks: Option<Marked>, beside: &Beside<'_>) {
    match meaning {
        Meaning::Word(term) | Meaning::Symbol(term) => define(ui, term),
        Meaning::Value(of) => define_value(ui, of),
        Meaning::Marks(_) => {}
    }
    marks.into_iter().for_each(|marks| on_the_stage(ui, marks, beside));
}

/// Defines the symbol that `sensed` shows, and points out the marks of its `role`.
pub fn sense_symbol(sensed: &Response, (name, role): (&str, Option<Role>), beside: &Beside<'_>) {
    if !sensed.hovered() {
        return;
    }
    let term = symbol(name, beside.family);
    let marks = role.and_then(|role| beside.marks(Meaning::Marks(role)));
    let marks = marks.or_else(|| beside.marks(Meaning::Symbol(term?)));
    beside.pointed.set(beside.pointed.get().or(marks));
    if term.is_some() || marks.is_some() {
        let meaning = term.map(Meaning::Symbol).or(marks.map(|(role, _)| Meaning::Marks(role)));
        meaning
            .into_iter()
            .for_each(|meaning| _ = Tooltip::for_enabled(sensed).show(|ui| tell(ui, meaning, marks, beside)));
    }
}

/// Whether the pointer is at a term or a symbol.
fn is_defined(ui: &Ui, links: &[Link], by: Vec2) -> bool {
    let at = ui.input(|input| input.pointer.hover_pos());
    let is_term = |link: &Link| !matches!(link.meaning, Meaning::Marks(_));
    at.is_some_and(|at| links.iter().any(|link| is_term(link) && link.rect.translate(by).contains(at)))
}

/// What marks on the stage look like and mean.
fn on_the_stage(ui: &mut Ui, (role, says): Marked, Beside { scene, theme, .. }: &Beside<'_>) {
    ui.horizontal(|ui| {
        if let Some(sample) = legend::sample(scene, scene.marks.iter(), role) {
            let (rect, _) = ui.allocate_exact_size(legend::SWATCH.into(), Sense::hover());
            let swatch = primitives::shapes(ui.painter(), &legend::swatch(role, sample, *theme, rect.min.into()));
            ui.painter().extend(swatch);
        }
        ui.add_space(2.0);
        ui.label(ink::scripted(ui, &format!("On the stage: {says}"), |words| words.small()));
    });
}

/// A term with its definition.
pub fn entry(ui: &mut Ui, term: &Term) {
    let name = match term.symbol {
        Some(symbol) => format!("{}  {symbol}", capital(term.name)),
        None => capital(term.name),
    };
    let bold = |words: RichText| words.family(style::bold()).strong();
    ui.label(ink::scripted(ui, &name, bold));
    ui.label(ink::scripted(ui, term.definition, |words| words));
}

/// A term with its definition and the chapter that introduces it.
pub fn define(ui: &mut Ui, term: &Term) {
    ui.set_max_width(WIDTH * ui.text_style_height(&eframe::egui::TextStyle::Body));
    entry(ui, term);
    ui.label(RichText::new(term.chapter.title()).weak().small());
}

/// A value with its definition.
fn define_value(ui: &mut Ui, of: &Variable) {
    ui.set_max_width(WIDTH * ui.text_style_height(&eframe::egui::TextStyle::Body));
    let name = if of.label.is_empty() { capital(&of.name.replace('-', " ")) } else { of.label.to_owned() };
    let symbol = latex::parse(of.symbol).map(|symbol| symbol.plain()).unwrap_or_default();
    // A label that has the symbol, as Eigenvalue λ₁, is enough.
    let symbol = if has_word(&raised(&name), &raised(&symbol)) { String::new() } else { symbol };
    ui.label(ink::scripted(ui, format!("{name}  {symbol}").trim_end(), |words| words.family(style::bold()).strong()));
    ui.label(ink::scripted(ui, of.definition.trim(), |words| words));
}

/// Whether `text` has `word`, and not only as a part of a longer word.
fn has_word(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(at, _)| {
        let around = [text[..at].chars().next_back(), text[at + word.len()..].chars().next()];
        around.into_iter().flatten().all(|letter| !letter.is_alphanumeric())
    })
}

/// A text with its indices on the line.
fn raised(text: &str) -> String {
    let raised =
        |c| u32::from(c).checked_sub(u32::from('₀')).and_then(|digit| char::from_digit(digit, 10)).unwrap_or(c);
    text.chars().filter(|c| *c != '_').map(raised).collect()
}

/// `doc` and the definitions of the terms in it: for a parameter, a column, a layer.
pub fn tooltip(ui: &mut Ui, doc: &str) {
    ui.set_max_width(WIDTH * ui.text_style_height(&eframe::egui::TextStyle::Body));
    ui.label(ink::scripted(ui, doc, |words| words));
    for (_, term) in occurrences(doc).into_iter().take(MOST) {
        ui.separator();
        define(ui, term);
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{Math, Picture, Sentence, Shape as SceneShape};

    use super::*;
    use crate::paint::Theme;
    use crate::paint::charts::explanation::{Density, equation, sentence};

    /// The terms among links, and whether each is a word.
    fn names(links: &[Link]) -> Vec<(&'static str, bool)> {
        let name = |link: &Link| match link.meaning {
            Meaning::Word(term) => (term.name, true),
            Meaning::Value(of) => (of.name, false),
            Meaning::Symbol(term) => (term.name, false),
            Meaning::Marks(role) => panic!("marks of {role:?}"),
        };
        links.iter().map(name).collect()
    }

    #[test]
    fn a_symbol_is_left_out_where_the_label_has_it_as_a_word() {
        assert!(has_word("Eigenvalue λ1", "λ1") && has_word("K along x", "K"));
        assert!(!has_word("Cost", "C") && !has_word("Background", "B") && !has_word("Threshold", "T"));
    }

    #[test]
    fn what_is_named_in_the_legend_is_found_on_the_stage_where_it_is_marked() {
        let mut scene = Scene::default();
        scene.legend(Role::Window, "search window");
        scene.legend(Role::Best, "minimum so far");
        scene.legend(Role::Reference, "next candidates");
        scene.mark(Picture::NEXT, Role::Reference, SceneShape::pixels(2, 2, 4, 4));
        scene.legend(Role::Truth, "candidate");
        scene.mark(Picture::NEXT, Role::Truth, SceneShape::pixels(4, 4, 4, 4));
        scene.mark(Picture::NEXT, Role::Window, SceneShape::pixels(0, 0, 9, 9));
        let marks = |meaning| Beside::new(&scene, "Block matching", Theme::Dark).marks(meaning).map(|(role, _)| role);
        let term = |name| find(name).expect("it is in the glossary");
        assert_eq!(marks(Meaning::Word(term("search window"))), Some(Role::Window));
        assert_eq!(marks(Meaning::Marks(Role::Window)), Some(Role::Window));
        assert_eq!(marks(Meaning::Word(term("candidate"))), Some(Role::Truth), "the entry that names nothing else");
        assert_eq!(marks(Meaning::Marks(Role::Best)), None, "the legend names it, but no mark is there");
        assert_eq!(marks(Meaning::Symbol(term("Kalman gain"))), None);
        assert_eq!(marks(Meaning::Word(term("search range"))), Some(Role::Window), "the window is as large as that");
        scene.legend(Role::Candidate, "particles");
        scene.mark(Picture::NEXT, Role::Candidate, SceneShape::Points(vec![[1.0, 1.0]]));
        let particles = |family| {
            let hypothesis = Meaning::Word(in_family(term("hypothesis"), family));
            Beside::new(&scene, family, Theme::Dark).marks(hypothesis).map(|(role, _)| role)
        };
        assert_eq!(["Region tracking", "Tracking"].map(particles), [Some(Role::Candidate); 2]);
    }

    #[test]
    fn a_symbol_means_what_it_means_in_its_chapter() {
        let name = |letters: &str, family| symbol(letters, family).map(|term| term.name);
        assert_eq!(name("u", "Optical flow"), Some("optical flow"));
        assert_eq!(name("K", "Tracking"), Some("Kalman gain"));
        assert_eq!(name("R", "Interest points"), Some("corner response"));
        assert_eq!(name("R", "Tracking"), Some("measurement noise"));
        assert_eq!(name("u\u{304}", "Optical flow"), Some("neighbourhood mean"));
        assert_eq!(name("λ₁", "Interest points"), Some("eigenvalue"));
        assert_eq!(name("SAD", "Block matching"), Some("sum of absolute differences"));
        assert_eq!((name("K", "Block matching"), name("q", "Tracking")), (None, None));
        assert_eq!(["P", "P⁻", "P^−"].map(|letters| name(letters, "Tracking")), [Some("covariance matrix"); 3]);
    }

    #[test]
    fn a_sentence_and_a_formula_have_links() {
        let density = Density::close(Theme::Dark);
        let words = Sentence::default().text("The Kalman gain weighs the innovation.");
        let found = links(&sentence(&words, (400.0, density), Theme::Dark), (&[], "Tracking"));
        assert_eq!(names(&found), [("Kalman gain", true), ("innovation", true)]);
        let words = Sentence::default().text("Each is a hypothesis.");
        let found = links(&sentence(&words, (400.0, density), Theme::Dark), (&[], "Region tracking"));
        assert_eq!(names(&found), [("state hypothesis", true)]);
        assert!(found.iter().all(|link| link.rect.width() > 20.0 && link.rect.height() > 8.0));
        let formula = Math::Row(vec![Math::Bold("K"), Math::text(" = "), Math::Bold("P")]);
        let found = links(&equation(&[formula], (400.0, density), Theme::Dark), (&[], "Tracking"));
        assert_eq!(names(&found), [("Kalman gain", false), ("covariance matrix", false)]);
    }

    #[test]
    fn a_tooltip_defines_the_terms_of_its_text() {
        let context = eframe::egui::Context::default();
        let mut height = [0.0; 2];
        for (i, doc) in ["Side of it.", "The regularisation weight of the smoothness term."].into_iter().enumerate() {
            let mut output = context.run_ui(Default::default(), |ui| {
                let shown = ui.scope(|ui| tooltip(ui, doc));
                height[i] = shown.response.rect.height();
            });
            output.textures_delta.clear();
        }
        assert!(height[1] > 3.0 * height[0], "{height:?}");
    }
}
