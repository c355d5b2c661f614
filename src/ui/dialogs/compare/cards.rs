//! A card for each compared estimator: its name, the picture of its result, and what it costs beside the reference.

use std::sync::Arc;

use eframe::egui::{
    self, Align, FontId, Label, Layout, Rect, RichText, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo, vec2,
};
use motionscope_core::base::words::capital;

use crate::experiment::comparison::{Row, conclusion};
use crate::paint::Theme;
use crate::ui::drawing::style;
use crate::ui::model::comparing::{Comparing, Picture};
use crate::ui::parts::widgets;

/// Between two cards, and around what stands on one, in points.
const GAP: f32 = 12.0;
const MARGIN: f32 = 8.0;
/// Least and largest height of a card, in sizes of the type.
pub const LETTERS: [f32; 2] = [4.6, 28.0];
/// Shares of a card's width for a picture beside the words, the largest first.
const SHARES: [f32; 4] = [0.55, 0.45, 0.36, 0.28];
/// Height of a picture above the words from which it stands there, as a share of the card's width.
const ABOVE: f32 = 0.42;
/// Height of words below a picture, in sizes of their type.
const WORDS_LETTERS: f32 = 4.0;
/// Width by height of a picture that is still to come.
const USUAL_ASPECT: f32 = 4.0 / 3.0;

/// Words as long as those that are still to come.
const USUAL_WORDS: &str = "46 × fewer candidates, EPE 0.140 px better, 25.0 % of the minima missed.";

/// Words of a card.
struct Words {
    name: &'static str,
    beside: String,
}

/// Shows the cards in the width that there is, `height` points high.
pub fn show(ui: &mut Ui, comparing: &Comparing, height: f32, theme: Theme) {
    let (rows, pictures, is_busy) = (comparing.rows(), comparing.pictures(), comparing.is_busy());
    let count = comparing.names.len();
    let width = width(ui, count);
    let all: Vec<_> = comparing.names.iter().enumerate().map(|(i, name)| words(name, i, &rows, count)).collect();
    let split = split(ui, &all, vec2(width, height));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        for (i, words) in all.iter().enumerate() {
            let (rect, response) = ui.allocate_exact_size(vec2(width, height), egui::Sense::hover());
            let text = format!("{}: {}", words.name, words.beside);
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &text));
            let picture = pictures.get(i);
            card(ui, rect, (words, picture, is_busy), split, theme);
            if let Some(Err(error)) = picture {
                response.on_hover_text(format!("No picture: {error}"));
            }
        }
    });
}

/// Width of each of so many cards.
fn width(ui: &Ui, count: usize) -> f32 {
    ((ui.available_width() + GAP) / count.max(2) as f32 - GAP).floor()
}

/// The height that so many cards can fill of `most`, in points.
pub fn height(ui: &Ui, count: usize, most: f32) -> f32 {
    let small = TextStyle::Small.resolve(ui.style()).size;
    let picture = (width(ui, count) - 2.0 * MARGIN) / USUAL_ASPECT + 2.0 * MARGIN;
    most.min(picture + WORDS_LETTERS * small)
}

/// The words of a card, once all rows are there.
fn words(name: &'static str, index: usize, rows: &[Arc<Row>], count: usize) -> Words {
    let reference = conclusion::reference(rows);
    let beside = match rows.get(index) {
        _ if rows.len() < count => String::new(),
        Some(_) if count == 1 => "Choose another estimator to compare it with.".to_owned(),
        Some(_) if index == reference => "The others are compared with it.".to_owned(),
        Some(row) => capital(&conclusion::against(row, &rows[reference])) + ".",
        None => String::new(),
    };
    Words { name, beside }
}

/// How picture and words share a card.
#[derive(Clone, Copy)]
enum Split {
    /// The picture above the words, which are so high.
    Above(f32),
    /// The picture beside the words, with a share of the width.
    Beside(f32),
}

/// The split that leaves the pictures largest where no words are cut.
fn split(ui: &Ui, all: &[Words], card: Vec2) -> Split {
    let needed = |width: f32| {
        all.iter().map(|words| height_of(ui, words, width - 2.0 * MARGIN)).fold(0.0, f32::max) + 2.0 * MARGIN
    };
    let below = needed(card.x);
    if card.y - below >= ABOVE * card.x {
        return Split::Above(below);
    }
    let share = SHARES.into_iter().find(|share| needed((1.0 - share) * card.x) <= card.y);
    Split::Beside(share.unwrap_or(0.0))
}

fn height_of(ui: &Ui, words: &Words, width: f32) -> f32 {
    let small = TextStyle::Small.resolve(ui.style());
    let height = |text: &str, font: FontId| {
        ui.painter().layout(text.to_owned(), font, egui::Color32::PLACEHOLDER, width.max(1.0)).size().y
    };
    let beside = if words.beside.is_empty() { USUAL_WORDS } else { &words.beside };
    height(words.name, FontId::new(small.size, style::bold())) + height(&unbroken(beside), small) + 2.0
}

fn card(
    ui: &mut Ui,
    rect: Rect,
    (words, picture, is_busy): (&Words, Option<&Picture>, bool),
    split: Split,
    theme: Theme,
) {
    let chrome = theme.chrome();
    let (fill, edge) = (style::color(chrome.raised), Stroke::new(1.0, style::color(chrome.line)));
    ui.painter().rect(rect, 8.0, fill, edge, StrokeKind::Inside);
    let (of_picture, of_words) = match split {
        Split::Above(height) => (rect.with_max_y(rect.max.y - height), rect.with_min_y(rect.max.y - height)),
        Split::Beside(share) => rect.split_left_right_at_fraction(share),
    };
    match picture {
        Some(Ok(texture)) => {
            let room = of_picture.shrink(MARGIN);
            let size = texture.size_vec2();
            let fit = size * (room.size() / size).min_elem().max(0.0);
            let at = Rect::from_center_size(room.center(), fit);
            egui::Image::new(texture).corner_radius(3).paint_at(ui, at);
        }
        Some(Err(_)) => {
            let dim = style::color(chrome.dim);
            let mut inside = widgets::inside(ui, of_picture.shrink(MARGIN), Layout::top_down(Align::Center));
            inside.add(Label::new(RichText::new("No picture").small().color(dim)).truncate());
        }
        None if is_busy => {
            // Painted, not put: that would move the next card.
            egui::Spinner::new().paint_at(ui, Rect::from_center_size(of_picture.center(), Vec2::splat(24.0)));
        }
        None => {}
    }
    let mut inside = widgets::inside(ui, of_words.shrink(MARGIN), Layout::top_down(Align::LEFT));
    inside.set_clip_rect(inside.clip_rect().intersect(rect));
    inside.spacing_mut().item_spacing.y = 2.0;
    inside.add(Label::new(RichText::new(words.name).small().family(style::bold())).wrap());
    inside.add(Label::new(RichText::new(unbroken(&words.beside)).small()).wrap());
}

/// The same text, which is broken within no number and before no unit.
fn unbroken(text: &str) -> String {
    text.replace('\u{202f}', "\u{a0}").replace(" ×", "\u{a0}×").replace(" px", "\u{a0}px").replace(" dB", "\u{a0}dB")
}
