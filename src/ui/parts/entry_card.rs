//! A card of something to choose: its picture at the left, its title, and a note below it.

use std::sync::Arc;

use eframe::egui::text::LayoutJob;
use eframe::egui::{
    Align2, Color32, CornerRadius, FontId, Galley, Id, Image, Rect, Response, Role, Sense, Stroke, StrokeKind,
    TextStyle, TextureHandle, Ui, WidgetInfo, pos2, vec2,
};
use lucide_icons::Icon;

use crate::paint::Theme;
use crate::ui::drawing::style;

/// Space around a picture, and between it and the words.
const GAP: f32 = 4.0;
/// Width of a picture by its height.
const ASPECT: f32 = 4.0 / 3.0;

/// What is on a card.
#[derive(Clone, Default)]
pub struct Card<'a> {
    /// Its name for screen readers.
    pub name: &'a str,
    /// Its title.
    pub title: &'a str,
    /// A dim note below the title; empty for none.
    pub note: &'a str,
    /// Height of its picture in points; 0 for none.
    pub picture: f32,
    /// The picture, once it is made.
    pub texture: Option<TextureHandle>,
    /// Whether it is what Enter takes.
    pub is_lit: bool,
    /// Whether it is what is in use.
    pub is_now: bool,
    /// Whether it cannot be chosen.
    pub is_disabled: bool,
    /// Whether it has an edge where nothing points at it.
    pub has_edge: bool,
    /// The look.
    pub theme: Theme,
}

/// Shows a card in `rect`.
pub fn show(ui: &mut Ui, rect: Rect, id: Id, card: &Card<'_>) -> Response {
    let response = ui.interact(rect, id, if card.is_disabled { Sense::hover() } else { Sense::click() });
    response.widget_info(|| WidgetInfo::selected(Role::Button, !card.is_disabled, card.is_lit, card.name));
    if ui.is_rect_visible(rect) {
        card.paint(ui, rect, response.hovered() || response.has_focus());
    }
    response
}

impl Card<'_> {
    fn paint(&self, ui: &Ui, rect: Rect, is_pointed_at: bool) {
        let chrome = self.theme.chrome();
        let fill = match (self.is_lit, is_pointed_at && !self.is_disabled) {
            (true, _) => Some(chrome.selection),
            (false, true) => Some(chrome.hovered),
            (false, false) => self.has_edge.then_some(chrome.raised),
        };
        if let Some(fill) = fill {
            let edge = if is_pointed_at || self.is_lit { chrome.accent } else { chrome.line };
            let width = if self.has_edge || self.is_lit { 1.0 } else { 0.0 };
            let edge = Stroke::new(width, style::color(edge));
            ui.painter().rect(rect, 6.0, style::color(fill), edge, StrokeKind::Inside);
        }
        let mut words = rect.shrink2(vec2(2.0 * GAP, GAP));
        if self.picture > 0.0 {
            let left = rect.left_center() + vec2(GAP, -self.picture / 2.0);
            let picture = Rect::from_min_size(left, vec2(ASPECT * self.picture, self.picture));
            self.paint_picture(ui, picture);
            words.min.x = picture.max.x + 2.0 * GAP;
        }
        self.paint_words(ui, words);
    }

    fn paint_picture(&self, ui: &Ui, rect: Rect) {
        let chrome = self.theme.chrome();
        match &self.texture {
            Some(texture) => {
                let shade = if self.is_disabled { Color32::from_gray(110) } else { Color32::WHITE };
                let image = Image::new(texture).uv(middle(texture)).tint(shade);
                image.corner_radius(CornerRadius::same(4)).paint_at(ui, rect);
            }
            None => {
                ui.painter().rect_filled(rect, 4.0, style::color(chrome.raised));
                let font = FontId::new((rect.height() / 2.5).round(), style::icons());
                let glyph = char::from(Icon::Grid3x3);
                ui.painter().text(rect.center(), Align2::CENTER_CENTER, glyph, font, style::color(chrome.line));
            }
        }
        if self.is_now {
            let edge = Stroke::new(2.0, style::color(chrome.accent));
            ui.painter().rect_stroke(rect, 4.0, edge, StrokeKind::Outside);
        }
    }

    /// Title and note, in the middle of the height.
    fn paint_words(&self, ui: &Ui, rect: Rect) {
        let chrome = self.theme.chrome();
        let [text, dim] = [chrome.text, chrome.dim].map(style::color);
        let body = TextStyle::Body.resolve(ui.style());
        let small = TextStyle::Small.resolve(ui.style());
        let family = if self.has_edge || self.is_now { style::bold() } else { body.family };
        let ink = if self.is_disabled { dim } else { text };
        let titled = |size: f32| lines(ui, self.title, FontId::new(size, family.clone()), ink, rect.width());
        // A card with an edge is one of many on a page, with smaller type.
        let large = Some(titled(body.size)).filter(|title| !title.elided && !self.has_edge);
        let title = large.unwrap_or_else(|| titled(small.size));
        let note = lines(ui, self.note, small, dim, rect.width());
        let height = title.size().y + if self.note.is_empty() { 0.0 } else { note.size().y };
        let top = pos2(rect.min.x, (rect.center().y - height / 2.0).round());
        let below = top + vec2(0.0, title.size().y);
        ui.painter().galley(top, title, text);
        if !self.note.is_empty() {
            ui.painter().galley(below, note, dim);
        }
    }
}

/// At most two lines of `text`.
fn lines(ui: &Ui, text: &str, font: FontId, color: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple(text.into(), font, color, width);
    job.wrap.max_rows = 2;
    ui.painter().layout_job(job)
}

/// The middle of a picture, cut to the shape of a card's.
fn middle(texture: &TextureHandle) -> Rect {
    let [width, height] = texture.size().map(|side| side as f32);
    let share = vec2((ASPECT * height / width).min(1.0), (width / ASPECT / height).min(1.0));
    Rect::from_center_size(pos2(0.5, 0.5), share)
}
