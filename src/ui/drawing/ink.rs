//! Words that are painted by hand in the window.

use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{self, Align, Color32, FontId, FontSelection, Painter, Pos2, RichText, TextStyle, Ui, Vec2, vec2};

use crate::paint::legend;
use crate::paint::script::{self, Script};

/// How often the atlas of glyphs was made anew. Shapes with text from before show other glyphs than they were made with, so
/// whatever keeps shapes keeps this number with them.
pub fn atlas(ctx: &egui::Context) -> u64 {
    #[derive(Clone, Copy, Default)]
    struct Atlas {
        filled: f32,
        count: u64,
    }
    // The atlas only fills up, until it is emptied between two frames.
    let filled = ctx.fonts(|fonts| fonts.font_atlas_fill_ratio());
    ctx.data_mut(|data| {
        let known = data.get_temp_mut_or_default::<Atlas>(egui::Id::unique("atlas of glyphs"));
        known.count += u64::from(filled < known.filled);
        known.filled = filled;
        known.count
    })
}

/// Words in one face, size and colour.
pub struct Words<'a> {
    /// The words.
    pub text: &'a str,
    /// Their face and size.
    pub font: FontId,
    /// Their colour.
    pub color: Color32,
}

/// Paints one line of text from `left_center` on, cut short with … at `width` points; gives its right end.
pub fn line(painter: &Painter, left_center: Pos2, words: Words<'_>, width: f32) -> f32 {
    let Words { text, font, color } = words;
    let mut job = LayoutJob::simple_singleline(text.into(), font, color);
    job.wrap = TextWrapping::truncate_at_width(width.max(0.0));
    let galley = painter.layout_job(job);
    let at = left_center - vec2(0.0, galley.size().y / 2.0);
    let right = at.x + galley.size().x;
    painter.galley(at, galley, color);
    right
}

/// `text` with its subscripts and superscripts, every part of it in the same `look`.
pub fn scripted(ui: &Ui, text: &str, look: impl Fn(RichText) -> RichText) -> LayoutJob {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let mut job = LayoutJob::default();
    for (words, script) in script::parts(text) {
        let place = if script == Script::Super { Align::TOP } else { Align::BOTTOM };
        let words = look(RichText::new(words).size(script.share() * size));
        words.append_to(&mut job, ui.style(), FontSelection::Default, place);
    }
    job
}

/// Gives what was painted by hand a name for screen readers and tests.
pub fn name(response: &egui::Response, name: impl Fn() -> String) {
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, name()));
}

/// Width and height of a role's swatch.
pub const SWATCH: Vec2 = vec2(legend::SWATCH[0], legend::SWATCH[1]);

#[cfg(test)]
mod tests {
    use eframe::egui::{Context, FontFamily, RawInput};

    use super::*;

    #[test]
    fn an_emptied_atlas_has_another_number() {
        let ctx = Context::default();
        let mut numbers = Vec::new();
        let mut largest = 0.0f32;
        // Type of ever other sizes fills the atlas, until it is emptied.
        for size in 8..400 {
            let mut output = ctx.run_ui(RawInput::default(), |ui| {
                numbers.push(atlas(ui.ctx()));
                let font = FontId::new(size as f32, FontFamily::Proportional);
                let _galley = ui.painter().layout_no_wrap("0123456789 abcdefghijklm".into(), font, Color32::WHITE);
                largest = largest.max(ui.ctx().fonts(|fonts| fonts.font_atlas_fill_ratio()));
            });
            output.textures_delta.clear();
        }
        assert!(numbers.is_sorted() && numbers.last() > numbers.first(), "{largest}: {:?}", numbers.last());
    }
}
