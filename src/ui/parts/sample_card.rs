//! The card of a bundled sample: its picture, which plays under the pointer, and its words.

use eframe::egui::{
    self, Align, CornerRadius, Layout, Rect, RichText, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use motionscope_core::synth::SCENES;

use super::widgets;
use crate::paint::Theme;
use crate::ui::drawing::style;
use crate::ui::model::previews::{PICTURE_PX, Previews, Wish};

/// How a card is drawn.
#[derive(Clone, Copy)]
pub struct Face {
    /// Its size in points.
    pub size: Vec2,
    /// Height of its picture.
    pub picture: f32,
    /// Whether what the sample teaches stands below its title; else it is a tooltip.
    pub has_words: bool,
    /// Whether the picture moves under the pointer.
    pub plays: bool,
    /// Whether it moves where it has the keyboard, too.
    pub follows_focus: bool,
    /// The look.
    pub theme: Theme,
}

/// Draws the card of the sample with this number.
pub fn show(ui: &mut Ui, of: usize, previews: &mut Previews, face: Face) -> egui::Response {
    let sample = &SCENES[of];
    let (rect, response) = ui.allocate_exact_size(face.size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, sample.title));
    let chrome = face.theme.chrome();
    let lit = response.hovered() || response.has_focus();
    let (fill, edge) = if lit { (chrome.hovered, chrome.accent) } else { (chrome.raised, chrome.line) };
    ui.painter().rect(rect, 8.0, style::color(fill), Stroke::new(1.0, style::color(edge)), StrokeKind::Inside);
    if ui.is_rect_visible(rect) {
        let ctx = ui.ctx().clone();
        let wish = match (response.hovered(), face.follows_focus && response.has_focus()) {
            (true, _) => Some(Wish::Hovered),
            (false, true) => Some(Wish::Focused),
            (false, false) => None,
        };
        if let Some(texture) = previews.picture(&ctx, of, wish.filter(|_| face.plays)) {
            // The middle of the picture, cut to the card's shape.
            let cut = (1.0 - face.picture / rect.width() * PICTURE_PX.0 as f32 / PICTURE_PX.1 as f32) / 2.0;
            let uv = Rect::from_min_max(pos2(0.0, cut.max(0.0)), pos2(1.0, 1.0 - cut.max(0.0)));
            let top = Rect::from_min_size(rect.min, vec2(rect.width(), face.picture));
            let round = CornerRadius { nw: 7, ne: 7, sw: 0, se: 0 };
            egui::Image::new(texture).uv(uv).corner_radius(round).paint_at(ui, top.shrink(1.0));
        }
    }
    let words = widgets::below(rect, face.picture).shrink2(vec2(12.0, 10.0));
    let mut ui = widgets::inside(ui, words, Layout::top_down(Align::LEFT));
    ui.spacing_mut().item_spacing.y = 4.0;
    ui.set_clip_rect(ui.clip_rect().intersect(words));
    let title = RichText::new(sample.title).family(style::bold());
    ui.add(egui::Label::new(if face.has_words { title } else { title.small() }).wrap().selectable(false));
    if !face.has_words {
        return response.on_hover_text(sample.teaches);
    }
    ui.add(egui::Label::new(RichText::new(sample.teaches).small().weak()).wrap().selectable(false));
    response
}
