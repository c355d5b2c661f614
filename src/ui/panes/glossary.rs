//! Definitions of terms where the pointer is.

use eframe::egui::{Id, Rect, RichText, Sense, Shape, Ui, Vec2};
use motionscope_core::capital;
use motionscope_core::glossary::{Chapter, GLOSSARY, Term, chapters_of, find, in_family, occurrences};

use crate::paint::charts::explanation::Block;
use crate::ui::drawing::chart::rect_from;
use crate::ui::drawing::{ink, style};

/// So many terms of one text are defined at most: more are not read.
const MOST: usize = 4;
/// Width of a tooltip, in sizes of its type.
const WIDTH: f32 = 20.0;

/// A term where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Where it stands, from the origin of its part on.
    pub rect: Rect,
    /// What is defined.
    pub term: &'static Term,
    /// Whether it is a word, and so is underlined.
    pub is_word: bool,
}

/// The terms and symbols of a part of an explanation; `family` is that of the estimator, whose chapters say what a symbol means.
pub fn links(block: &Block, family: &str) -> Vec<Link> {
    let words = block.terms.iter().map(|(rect, term)| Link {
        rect: rect_from(*rect),
        term: in_family(term, family),
        is_word: true,
    });
    let symbols = block.symbols.iter().filter_map(|(rect, name)| {
        let term = symbol(name, family)?;
        Some(Link { rect: rect_from(*rect), term, is_word: false })
    });
    words.chain(symbols).collect()
}

/// What a symbol of a formula means, or a name in it.
fn symbol(name: &str, family: &str) -> Option<&'static Term> {
    let plain = plain(name);
    let of = |chapter: &Chapter| GLOSSARY.iter().find(|term| term.chapter == *chapter && has_symbol(term, &plain));
    let is_name = name.chars().filter(|c| c.is_alphabetic()).count() > 1;
    let named = || find(name).or_else(|| occurrences(name).first().map(|(_, term)| *term));
    chapters_of(family).iter().find_map(of).or_else(|| if is_name { named() } else { None })
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

/// Underlines the words among `links` with faint dots and defines what is pointed at; `by` is where their part stands.
pub fn sense(ui: &Ui, salt: &str, links: &[Link], by: Vec2) {
    let color = ui.visuals().weak_text_color();
    for (i, link) in links.iter().enumerate() {
        let rect = link.rect.translate(by);
        if !ui.is_rect_visible(rect) {
            continue;
        }
        if link.is_word {
            let ends = [rect.left_bottom(), rect.right_bottom()];
            ui.painter().extend(Shape::dotted_line(&ends, color, 3.0, 0.6));
        }
        let id: Id = ui.scope_id().with(("term", salt, i));
        ui.interact(rect, id, Sense::hover()).on_hover_ui(|ui| define(ui, link.term));
    }
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
    use motionscope_core::scene::{Math, Sentence};

    use super::*;
    use crate::paint::Theme;
    use crate::paint::charts::explanation::{Density, equation, sentence};

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
    }

    #[test]
    fn a_sentence_and_a_formula_have_links() {
        let density = Density::close(Theme::Dark);
        let words = Sentence::default().text("The Kalman gain weighs the innovation.");
        let found = links(&sentence(&words, (400.0, density), Theme::Dark), "Tracking");
        let names: Vec<_> = found.iter().map(|link| (link.term.name, link.is_word)).collect();
        assert_eq!(names, [("Kalman gain", true), ("innovation", true)]);
        let words = Sentence::default().text("Each is a hypothesis.");
        let found = links(&sentence(&words, (400.0, density), Theme::Dark), "Region tracking");
        assert_eq!(found[0].term.name, "state hypothesis");
        assert!(found.iter().all(|link| link.rect.width() > 20.0 && link.rect.height() > 8.0));
        let formula = Math::Row(vec![Math::Bold("K"), Math::text(" = "), Math::Bold("P")]);
        let found = links(&equation(&[formula], (400.0, density), Theme::Dark), "Tracking");
        let names: Vec<_> = found.iter().map(|link| (link.term.name, link.is_word)).collect();
        assert_eq!(names, [("Kalman gain", false), ("covariance matrix", false)]);
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
