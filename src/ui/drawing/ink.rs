//! The theme's colours and type in the window, and what is painted by hand there.

use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{self, Color32, FontFamily, FontId, Painter, Pos2, Vec2, vec2};

use crate::paint::legend;
use crate::paint::{Color, Face};

/// A colour of the theme as the window wants it.
pub fn color(color: Color) -> Color32 {
    let [r, g, b, a] = color.0;
    Color32::from_rgba_unmultiplied(r, g, b, a)
}

/// A face of the program's type at `size` points.
pub fn font(face: Face, size: f32) -> FontId {
    let family = match face {
        Face::Sans => FontFamily::Proportional,
        Face::Mono => FontFamily::Monospace,
        Face::Bold => crate::ui::drawing::style::bold(),
        Face::Italic => FontFamily::Name("italic".into()),
    };
    FontId::new(size, family)
}

/// Paints one line of text from `left_center` on, cut short with … at `width` points; gives its right end.
pub fn line(painter: &Painter, left_center: Pos2, text: (&str, FontId, Color32), width: f32) -> f32 {
    let (words, font, color) = text;
    let mut job = LayoutJob::simple_singleline(words.into(), font, color);
    job.wrap = TextWrapping::truncate_at_width(width.max(0.0));
    let galley = painter.layout_job(job);
    let at = left_center - vec2(0.0, galley.size().y / 2.0);
    let right = at.x + galley.size().x;
    painter.galley(at, galley, color);
    right
}

/// Gives what was painted by hand a name for screen readers and tests.
pub fn name(response: &egui::Response, name: impl Fn() -> String) {
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, name()));
}

/// Width and height of a role's swatch.
pub const SWATCH: Vec2 = vec2(legend::SWATCH[0], legend::SWATCH[1]);
