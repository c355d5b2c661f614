//! What is told below the table: the comparison in sentences where no cards tell it, and the numbers that are the same in all rows.

use eframe::egui::{Color32, Label, RichText, TextStyle, Ui};

use super::table::Content;
use crate::experiment::comparison::Column;
use crate::ui::panes::glossary;

/// Between two paragraphs, in points.
const GAP: f32 = 4.0;

/// What is told.
pub struct Notes<'a> {
    /// The table.
    pub content: &'a Content,
    /// The sentences.
    pub sentences: Vec<String>,
    /// Whether the numbers that are the same are told.
    pub has_alike: bool,
}

impl Notes<'_> {
    /// The columns that are the same in all rows, as they are told one after the other.
    fn alike(&self) -> Vec<String> {
        let Content { rows, alike, .. } = self.content;
        let Some(row) = rows.first().filter(|_| self.has_alike && !alike.is_empty()) else { return Vec::new() };
        let told = |(i, column): (usize, &Column)| {
            let end = if i + 1 < alike.len() { "; " } else { "." };
            format!("{} {}{end}", column.heading, column.text(row))
        };
        alike.iter().enumerate().map(told).collect()
    }

    /// Height of all of it in the width of `ui`, in points.
    pub fn height(&self, ui: &Ui) -> f32 {
        let alike = self.alike();
        let alike = (!alike.is_empty()).then(|| ALIKE.to_owned() + &alike.concat());
        let height = |text: String, style: TextStyle| {
            let (font, width) = (style.resolve(ui.style()), ui.available_width());
            ui.painter().layout(text, font, Color32::PLACEHOLDER, width).size().y + GAP
        };
        let sentences = self.sentences.iter().map(|sentence| height(sentence.clone(), TextStyle::Body));
        sentences.chain(alike.map(|text| height(text, TextStyle::Small))).sum()
    }

    /// Tells it.
    pub fn show(&self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.y = GAP;
        for sentence in &self.sentences {
            ui.add(Label::new(sentence).wrap());
        }
        let alike = self.alike();
        if alike.is_empty() {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            ui.label(RichText::new(ALIKE).small().weak());
            for (text, column) in alike.into_iter().zip(&self.content.alike) {
                let label = ui.label(RichText::new(text).small().weak());
                label.on_hover_ui(|ui| glossary::tooltip(ui, column.doc));
            }
        });
    }
}

/// How the numbers that are the same begin.
const ALIKE: &str = "The same in all rows: ";
