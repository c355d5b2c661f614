//! The list of the lessons.

use eframe::egui::{self, RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::paint::Theme;
use crate::session::lesson::{Address, Lesson, all};
use crate::ui::app::action::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::parts::widgets;

/// Shows the lessons; gives whether the list is still open.
pub fn show(ctx: &egui::Context, theme: Theme, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let room = ctx.content_rect().size() - vec2(110.0, 140.0);
    let (mut chosen, mut is_closed) = (false, false);
    let modal = widgets::modal(ctx, "lessons", vec2(52.0 * size, 60.0 * size)).show(ctx, |ui| {
        ui.set_width((48.0 * size).min(room.x));
        is_closed = widgets::title(ui, "Lessons");
        ui.add_space(8.0);
        let height = room.y.min(44.0 * size);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            for (lesson, number) in all().iter().zip(1..) {
                if row(ui, lesson, number, theme).clicked() {
                    actions.ask(Action::OpenPage(Address::from(lesson)));
                    chosen = true;
                }
            }
        });
    });
    !(modal.should_close() || chosen || is_closed)
}

/// A lesson with its number, and what is learned in it.
fn row(ui: &mut Ui, lesson: &Lesson, number: usize, theme: Theme) -> egui::Response {
    let chrome = theme.chrome();
    let size = TextStyle::Body.resolve(ui.style()).size;
    let width = ui.available_width();
    let start = ui.cursor().min;
    // Laid out first: the highlight below it is as high as it is.
    let background = ui.painter().add(egui::Shape::Noop);
    let inner = ui.horizontal_top(|ui| {
        ui.set_width(width);
        ui.add_space(8.0);
        ui.add_sized(vec2(1.8 * size, 1.3 * size), egui::Label::new(RichText::new(number.to_string()).weak()));
        ui.vertical(|ui| {
            ui.set_width(ui.available_width() - 8.0);
            ui.add_space(4.0);
            let bold = RichText::new(&lesson.title).family(style::bold()).strong();
            ui.add(egui::Label::new(bold).selectable(false));
            ui.add(egui::Label::new(RichText::new(&lesson.summary).small().weak()).selectable(false));
            ui.add_space(6.0);
        });
    });
    let rect = egui::Rect::from_min_max(start, inner.response.rect.max);
    let response = ui.interact(rect, ui.scope_id().with(("lesson", number)), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &lesson.title));
    if response.hovered() || response.has_focus() {
        let fill = style::color(chrome.raised);
        ui.painter().set(background, egui::Shape::rect_filled(rect, 6.0, fill));
    }
    response
}
