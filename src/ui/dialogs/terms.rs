//! The glossary: the terms of the course by chapter, found by name, symbol or definition.

use eframe::egui::{self, RichText, ScrollArea, TextEdit, TextStyle, Ui, vec2};
use motionscope_core::course::glossary::{Chapter, GLOSSARY, Term};

use crate::ui::panes::glossary;
use crate::ui::parts::widgets;

/// The dialog while it is open.
#[derive(Default)]
pub struct State {
    query: String,
    is_focused: bool,
}

impl State {
    /// The glossary at what `query` finds.
    pub fn asking(query: impl Into<String>) -> Self {
        Self { query: query.into(), is_focused: false }
    }
}

/// Shows the glossary; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let room = widgets::room_of_dialog(ctx) - vec2(0.0, 12.0);
    let mut is_closed = false;
    let modal = widgets::modal(ctx, "glossary", vec2(56.0 * size, 60.0 * size)).show(ctx, |ui| {
        ui.set_width((52.0 * size).min(room.x));
        let height = room.y.min(50.0 * size);
        ui.set_min_height(height);
        let bottom = ui.cursor().min.y + height;
        is_closed = widgets::title(ui, "Glossary");
        search(ui, state);
        ui.add_space(8.0);
        let left = (bottom - ui.cursor().min.y).max(80.0);
        ScrollArea::vertical().max_height(left).min_scrolled_height(left).auto_shrink(false).show(ui, |ui| {
            list(ui, &state.query);
        });
    });
    !(modal.should_close() || is_closed)
}

/// The field for what is sought.
fn search(ui: &mut Ui, state: &mut State) {
    let id = egui::Id::unique("glossary term");
    if !state.is_focused {
        widgets::catch_text(ui.ctx(), id, &mut state.query);
    }
    let field = TextEdit::singleline(&mut state.query).id(id).hint_text("Find a term").desired_width(f32::INFINITY);
    let response = ui.add(field).accessible_name("Find a term");
    state.is_focused |= response.has_focus();
    if !state.is_focused {
        response.request_focus();
    }
}

/// The terms that fit `query`, under the titles of their chapters; those with it in their definition alone come last.
fn list(ui: &mut Ui, query: &str) {
    let query = query.trim().to_lowercase();
    let of = |fit: Fit| GLOSSARY.iter().filter(|term| Fit::of(term, &query) == Some(fit)).collect::<Vec<_>>();
    let (exact, named, defined) = (of(Fit::Exact), of(Fit::Named), of(Fit::Defined));
    exact.iter().for_each(|term| titled(ui, term.chapter.title(), &[term]));
    for chapter in Chapter::ALL {
        let terms: Vec<_> = named.iter().copied().filter(|term| term.chapter == chapter).collect();
        titled(ui, chapter.title(), &terms);
    }
    titled(ui, "In the definition", &defined);
    if exact.is_empty() && named.is_empty() && defined.is_empty() {
        ui.label(RichText::new("There is no such term. Try fewer letters.").weak());
    }
}

/// Terms under a title; nothing if there are none.
fn titled(ui: &mut Ui, title: &str, terms: &[&Term]) {
    if terms.is_empty() {
        return;
    }
    widgets::heading(ui, title);
    for term in terms {
        glossary::entry(ui, term);
        ui.add_space(4.0);
    }
    ui.add_space(8.0);
}

/// How a term fits what is sought, the best first.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fit {
    /// A spelling or the symbol is what is sought.
    Exact,
    /// A word of a spelling or of the symbol begins with it.
    Named,
    /// A word of the definition begins with it.
    Defined,
}

impl Fit {
    /// How `term` fits `query`, which is in lower case; without a query all terms fit by name.
    fn of(term: &Term, query: &str) -> Option<Self> {
        let has = |text: &str| {
            let text = text.to_lowercase();
            let begins_a_word = |at: usize| !text[..at].ends_with(char::is_alphanumeric);
            query.is_empty() || text.match_indices(query).any(|(at, _)| begins_a_word(at))
        };
        let names = || term.spellings().chain(term.symbol);
        if names().any(|name| name.to_lowercase() == query) {
            Some(Self::Exact)
        } else if names().any(has) {
            Some(Self::Named)
        } else {
            has(term.definition).then_some(Self::Defined)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_term_is_found_by_name_abbreviation_and_definition() {
        let found = |query: &str, fit: Fit| {
            let fits = GLOSSARY.iter().filter(|term| Fit::of(term, query) == Some(fit));
            fits.map(|term| term.name).collect::<Vec<_>>()
        };
        assert_eq!(found("structure tensor", Fit::Exact), ["structure tensor"]);
        assert!(found("sad", Fit::Exact).iter().any(|name| name.contains("absolute differences")));
        assert!(found("structure", Fit::Named).contains(&"structure tensor"));
        assert_eq!(found("", Fit::Named).len(), GLOSSARY.len(), "without a query all of them");
        let gain = [Fit::Exact, Fit::Named, Fit::Defined].map(|fit| found("gain", fit)).concat();
        assert!(!gain.contains(&"quadrant search"), "it keeps the best quadrant and divides it again");
        assert!(found("gain", Fit::Defined).iter().all(|name| !found("gain", Fit::Named).contains(name)));
        assert!([Fit::Exact, Fit::Named, Fit::Defined].iter().all(|fit| found("no such term", *fit).is_empty()));
    }
}
