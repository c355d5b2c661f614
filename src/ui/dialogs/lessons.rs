//! The list of the lessons.

use eframe::egui::{self, Key, Modifiers, RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::paint::Theme;
use crate::session::lesson::{Address, Lesson, all};
use crate::ui::commands::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::model::lesson::OpenLesson;
use crate::ui::parts::widgets;

/// The list while it is open.
pub struct State {
    /// The lesson that Enter opens.
    chosen: usize,
    /// Whether the list was not shown yet, so that the chosen lesson may be out of sight.
    is_new: bool,
}

impl State {
    /// The list at the lesson that is open, or at the first one.
    pub fn at(open: Option<&OpenLesson>) -> Self {
        let is_open = |lesson: &Lesson| open.is_some_and(|open| open.lesson().slug == lesson.slug);
        Self { chosen: all().iter().position(is_open).unwrap_or(0), is_new: true }
    }
}

/// Shows the lessons; gives whether the list is still open.
pub fn show(ctx: &egui::Context, state: &mut State, theme: Theme, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let room = widgets::room_of_dialog(ctx) - vec2(0.0, 32.0);
    let (mut chosen, mut is_closed) = (None, false);
    let modal = widgets::modal(ctx, "lessons", vec2(52.0 * size, 60.0 * size)).show(ctx, |ui| {
        ui.set_width((48.0 * size).min(room.x));
        let (up, down, enter) = ui.input_mut(|i| {
            let mut hit = |key| i.consume_key(Modifiers::NONE, key);
            (hit(Key::ArrowUp), hit(Key::ArrowDown), hit(Key::Enter))
        });
        is_closed = widgets::title(ui, "Lessons");
        ui.add_space(8.0);
        state.chosen = (state.chosen + usize::from(down)).saturating_sub(usize::from(up));
        state.chosen = state.chosen.min(all().len().saturating_sub(1));
        let is_moved = up || down || std::mem::take(&mut state.is_new);
        let height = room.y.min(44.0 * size);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            for (index, lesson) in all().iter().enumerate() {
                let lit = index == state.chosen;
                let response = row(ui, (lesson, index + 1), lit, theme);
                if lit && is_moved {
                    response.scroll_to_me(None);
                }
                if response.clicked() || lit && enter {
                    chosen = Some(Address::from(lesson));
                }
            }
        });
    });
    let is_done = modal.should_close() || chosen.is_some() || is_closed;
    chosen.into_iter().for_each(|address| actions.ask(Action::OpenPage(address)));
    !is_done
}

/// A lesson with its number, and what is learned in it.
fn row(ui: &mut Ui, (lesson, number): (&Lesson, usize), lit: bool, theme: Theme) -> egui::Response {
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
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, lit, &lesson.title));
    if lit || response.hovered() || response.has_focus() {
        let fill = if lit { chrome.selection } else { chrome.raised };
        ui.painter().set(background, egui::Shape::rect_filled(rect, 6.0, style::color(fill)));
    }
    response
}
