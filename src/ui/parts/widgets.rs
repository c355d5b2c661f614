//! Small parts that the panes share: icons, icon buttons, headings, key caps, dialogs.

use eframe::egui::{
    self, Align, Align2, Button, FontId, Frame, Id, Layout, Modal, Rect, Response, RichText, Sense, Stroke, StrokeKind,
    TextStyle, Ui, UiBuilder, Vec2, WidgetInfo, vec2,
};
use lucide_icons::Icon;

use crate::paint::Theme;
use crate::ui::drawing::style;
use crate::ui::layout;

/// An icon as text, a little larger than the type around it.
pub fn icon(ui: &Ui, icon: Icon) -> RichText {
    let size = TextStyle::Body.resolve(ui.style()).size;
    RichText::new(char::from(icon).to_string()).font(FontId::new((size * 1.15).round(), style::icons()))
}

/// Lays the frame out once more, because a part of it needs another size. Not in many frames in a row: where two parts keep changing each
/// other's room, the frame is shown as it is.
pub fn lay_out_anew(ctx: &egui::Context, why: &'static str) {
    const MOST_IN_A_ROW: u32 = 2;
    let (frame, id) = (ctx.cumulative_frame_nr(), Id::unique("laid out anew"));
    let (last, count): (u64, u32) = ctx.data(|data| data.get_temp(id)).unwrap_or_default();
    let count = match frame.saturating_sub(last) {
        0 => count,
        1 => count + 1,
        _ => 1,
    };
    if count > MOST_IN_A_ROW {
        return ctx.request_repaint();
    }
    ctx.data_mut(|data| data.insert_temp(id, (frame, count)));
    ctx.request_discard(why);
}

/// A square button with an icon, no frame until the pointer is on it, and a name for screen readers.
pub fn icon_button(ui: &mut Ui, glyph: Icon, name: &str, selected: bool) -> Response {
    let side = ui.spacing().interact_size.y;
    let button =
        Button::new(icon(ui, glyph)).selected(selected).frame_when_inactive(selected).min_size(vec2(side, side));
    let padding = ui.spacing().button_padding;
    ui.spacing_mut().button_padding = vec2((padding.x / 2.0).round(), 0.0);
    let response = ui.add(button);
    ui.spacing_mut().button_padding = padding;
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, enabled, selected, name));
    response
}

/// A small cross that folds away or dismisses.
pub fn cross(ui: &mut Ui, name: &str) -> Response {
    ui.scope(|ui| {
        ui.visuals_mut().widgets.inactive.fg_stroke.color = ui.visuals().weak_text_color();
        icon_button(ui, Icon::X, name, false)
    })
    .inner
}

/// A quiet heading over a group of rows.
pub fn heading(ui: &mut Ui, text: &str) -> Response {
    let font = FontId::new(TextStyle::Small.resolve(ui.style()).size, style::bold());
    ui.label(RichText::new(text).font(font).color(ui.visuals().weak_text_color()))
}

/// A small key cap: `Ctrl+K`.
pub fn key_cap(ui: &mut Ui, text: &str, theme: Theme) -> Response {
    let chrome = theme.chrome();
    let font = TextStyle::Small.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.into(), font, style::color(chrome.dim));
    let height = galley.size().y + 4.0;
    let (rect, response) = ui.allocate_exact_size(vec2((galley.size().x + 10.0).max(height), height), Sense::hover());
    let stroke = Stroke::new(1.0, style::color(chrome.line));
    ui.painter().rect(rect, 4.0, style::color(chrome.raised), stroke, StrokeKind::Inside);
    let at = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), rect).min;
    ui.painter().galley(at, galley, style::color(chrome.dim));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, text));
    response
}

/// Elides `text` in the middle so that a long path keeps its beginning and its end.
pub fn elide(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most || most < 3 {
        return text.to_owned();
    }
    let (head, tail) = ((most - 1) / 2, most - 1 - (most - 1) / 2);
    let start: String = text.chars().take(head).collect();
    let end: String = text.chars().skip(count - tail).collect();
    format!("{start}…{end}")
}

/// A dialog over the panes, as wide as `width` unless the window is narrower, with room for `height`.
pub fn modal(ctx: &egui::Context, name: &str, size: Vec2) -> Modal {
    let id = Id::unique(name);
    let (margin, around) = around_dialog(ctx);
    let most = ctx.content_rect().size() - Vec2::splat(around);
    // A slow computer would show a dialog that fades in as an empty shade for a long while.
    let area = Modal::default_area(id).default_size(size.min(most)).fade_in(false);
    Modal::new(id).area(area).frame(Frame::window(&ctx.global_style()).inner_margin(margin))
}

/// Whether the window is upright and narrow, as on a phone.
pub fn is_upright(ctx: &egui::Context) -> bool {
    layout::is_upright(ctx.content_rect().size(), TextStyle::Body.resolve(&ctx.global_style()).size)
}

/// The margin within a dialog, and the part of the window that it leaves free, in points.
fn around_dialog(ctx: &egui::Context) -> (i8, f32) {
    if is_upright(ctx) { (10, 16.0) } else { (20, 64.0) }
}

/// The most room that the content of a dialog has, in points.
pub fn room_of_dialog(ctx: &egui::Context) -> Vec2 {
    let (margin, around) = around_dialog(ctx);
    const EDGES: f32 = 4.0;
    ctx.content_rect().size() - Vec2::splat(around + 2.0 * f32::from(margin) + EDGES)
}

/// The title of a dialog with the way out at its right; returns whether that was clicked.
pub fn title(ui: &mut Ui, text: &str) -> bool {
    ui.horizontal(|ui| {
        ui.heading(text);
        let right = Layout::right_to_left(Align::Center);
        ui.with_layout(right, |ui| icon_button(ui, Icon::X, "Close", false).clicked()).inner
    })
    .inner
}

/// Puts what is typed into `text` as long as its field `id` has not the keyboard yet: a dialog draws nothing in its first pass,
/// and its field would lose what is typed just after the key that opened it.
pub fn catch_text(ctx: &egui::Context, id: Id, text: &mut String) {
    if ctx.memory(|memory| memory.has_focus(id)) {
        return;
    }
    ctx.input_mut(|input| {
        input.events.retain(|event| match event {
            egui::Event::Text(typed) => {
                text.push_str(typed);
                false
            }
            egui::Event::Key { key: egui::Key::Backspace, pressed: true, .. } => {
                text.pop();
                false
            }
            _ => true,
        });
    });
}

/// A child of `ui` that fills `rect` and takes no room of its own.
pub fn inside(ui: &mut Ui, rect: Rect, layout: Layout) -> Ui {
    ui.new_child(UiBuilder::new().max_rect(rect).layout(layout))
}

/// The part of `rect` below its first `height` points.
pub fn below(rect: Rect, height: f32) -> Rect {
    Rect::from_min_max(egui::pos2(rect.min.x, rect.min.y + height), rect.max)
}

/// The text of a value that matters less.
pub fn dim(ui: &Ui, text: impl Into<String>) -> RichText {
    RichText::new(text).color(ui.visuals().weak_text_color())
}

#[cfg(test)]
mod tests {
    use super::elide;

    #[test]
    fn long_paths_keep_both_ends() {
        assert_eq!(elide("/home/ada/clips/waves.mp4", 11), "/home…s.mp4");
        assert_eq!(elide("waves", 11), "waves");
    }
}
