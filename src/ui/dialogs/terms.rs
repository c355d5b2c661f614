//! The glossary: the terms of the course by chapter, found by name, symbol or definition.

use eframe::egui::{self, RichText, ScrollArea, TextEdit, TextStyle, Ui, vec2};
use motionscope_core::glossary::{Chapter, GLOSSARY, Term};

use crate::ui::panes::glossary;
use crate::ui::parts::widgets;

/// The dialog while it is open.
#[derive(Default)]
pub struct State {
    query: String,
    is_focused: bool,
}

/// Shows the glossary; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let room = ctx.content_rect().size() - vec2(110.0, 120.0);
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

/// The terms that fit `query`, under the titles of their chapters.
fn list(ui: &mut Ui, query: &str) {
    let query = query.trim().to_lowercase();
    let mut is_empty = true;
    for chapter in Chapter::ALL {
        let terms: Vec<_> = GLOSSARY.iter().filter(|term| term.chapter == chapter && fits(term, &query)).collect();
        if terms.is_empty() {
            continue;
        }
        is_empty = false;
        widgets::heading(ui, chapter.title());
        for term in terms {
            glossary::entry(ui, term);
            ui.add_space(4.0);
        }
        ui.add_space(8.0);
    }
    if is_empty {
        ui.label(RichText::new("There is no such term. Try fewer letters.").weak());
    }
}

/// Whether a word of a spelling, the symbol or the definition of `term` begins with `query`, which is in lower case.
fn fits(term: &Term, query: &str) -> bool {
    let has = |text: &str| {
        let text = text.to_lowercase();
        let begins_a_word = |at: usize| !text[..at].ends_with(char::is_alphanumeric);
        query.is_empty() || text.match_indices(query).any(|(at, _)| begins_a_word(at))
    };
    term.spellings().any(has) || term.symbol.is_some_and(has) || has(term.definition)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_term_is_found_by_name_abbreviation_and_definition() {
        let found =
            |query: &str| GLOSSARY.iter().filter(|term| fits(term, query)).map(|term| term.name).collect::<Vec<_>>();
        assert!(found("structure tensor").contains(&"structure tensor"));
        assert!(found("sad").iter().any(|name| name.contains("absolute differences")));
        assert_eq!(found("").len(), GLOSSARY.len(), "without a query all of them");
        assert!(!found("gain").contains(&"quadrant search"), "it keeps the best quadrant and divides it again");
        assert!(found("no such term").is_empty());
    }
}
