//! The page of a lesson: its words and formulas, and the way to the pages around it.

use std::sync::Arc;

use eframe::egui::{
    Align, Button, CursorIcon, Galley, Layout, Rect, RichText, ScrollArea, Sense, Stroke, TextStyle, Ui, UiBuilder,
    pos2, vec2,
};
use lucide_icons::Icon;
use motionscope_core::Direction;

use super::explanation::Part;
use super::glossary::Beside;
use crate::paint::Theme;
use crate::paint::charts::prose::{self, Prose};
use crate::session::lesson::Address;
use crate::ui::app::action::{Action, Actions};
use crate::ui::app::commands::Command;
use crate::ui::drawing::chart::rect_from;
use crate::ui::drawing::{ink, style};
use crate::ui::model::lesson::OpenLesson;
use crate::ui::parts::widgets;

/// Width of the page, in sizes of its type, and as shares of the window.
const LETTERS: f32 = 25.0;
const SHARES: [f32; 2] = [0.22, 0.31];
/// Letters across below which the page stands above the other panes, and its share of their height.
const NARROW_LETTERS: f32 = 44.0;
const HEIGHT_SHARE: f32 = 0.36;
/// Around the words, in points.
const MARGIN: f32 = 16.0;

/// What the pane keeps between frames: the page as it was laid out.
#[derive(Default)]
pub struct State {
    laid_out: Option<LaidOut>,
    /// The page that is scrolled.
    page: Option<Address>,
    /// Whether the notes are in the presenter's window, so that the class does not see them.
    pub has_notes_elsewhere: bool,
}

/// A page as it is shown.
struct LaidOut {
    prose: Prose,
    key: Key,
    words: Part,
    /// Where each link stands, and where it leads.
    links: Vec<(Rect, String)>,
}

/// What the layout of a page follows from beside its words.
#[derive(Clone, PartialEq)]
struct Key {
    width: u32,
    theme: Theme,
    pixels_per_point: f32,
    atlas: u64,
}

/// The page, and what is left of `all` for the other panes, with type of `type_pt`.
pub fn split(all: Rect, type_pt: f32) -> [Rect; 2] {
    if all.width() < NARROW_LETTERS * type_pt {
        let y = all.min.y + (HEIGHT_SHARE * all.height()).round();
        return [all.with_max_y(y), all.with_min_y(y + 1.0)];
    }
    let [least, most] = SHARES.map(|share| share * all.width());
    let x = all.min.x + (LETTERS * type_pt).clamp(least, most).round();
    [all.with_max_x(x), all.with_min_x(x + 1.0)]
}

/// What the pane shows.
pub struct Input<'a> {
    /// The lesson.
    pub open: &'a mut OpenLesson,
    /// The look.
    pub theme: Theme,
    /// The page that a link led away from, if one did.
    pub back: Option<&'a str>,
    /// The stage on which what is pointed at is pointed out.
    pub beside: &'a Beside<'a>,
}

/// Shows the page that is open in `rect`.
pub fn show(ui: &mut Ui, rect: Rect, input: Input<'_>, state: &mut State, actions: &mut Actions) {
    let Input { open, theme, back, beside } = input;
    let chrome = theme.chrome();
    ui.painter().rect_filled(rect, 0.0, style::color(chrome.panel));
    let line = Stroke::new(1.0, style::color(chrome.line));
    match rect.height() < ui.max_rect().height() {
        true => ui.painter().hline(rect.x_range(), rect.max.y + 0.5, line),
        false => ui.painter().vline(rect.max.x + 0.5, rect.y_range(), line),
    };
    let inside = rect.shrink2(vec2(MARGIN, 8.0));
    let mut ui = ui.new_child(UiBuilder::new().id_salt("lesson").max_rect(inside));
    ui.set_clip_rect(ui.clip_rect().intersect(rect));
    head(&mut ui, open, back, actions);
    let footer = ui.spacing().interact_size.y + 8.0;
    let ending = open.is_over.then(|| laid_out_ending(&ui, open, inside.width()));
    let ending_height = ending.as_ref().map_or(0.0, |text| text.size().y + 8.0);
    let height = (ui.available_height() - footer - ending_height).max(40.0);
    let scroll = ScrollArea::vertical().id_salt("page").auto_shrink(false).max_height(height);
    let turned = state.page.as_ref() != Some(open.address());
    state.page = Some(open.address().clone());
    let scroll = if turned { scroll.vertical_scroll_offset(0.0) } else { scroll };
    scroll.show(&mut ui, |ui| {
        words(ui, (open, theme, beside), state, actions);
        if open.has_notes && !state.has_notes_elsewhere && !open.page().notes.is_empty() {
            ui.add_space(12.0);
            widgets::heading(ui, "Notes");
            ui.label(RichText::new(&open.page().notes).weak());
        }
    });
    let foot = Rect::from_min_max(pos2(inside.min.x, inside.max.y - footer + 8.0), inside.max);
    if let Some(text) = ending {
        let above = Rect::from_min_size(pos2(inside.min.x, foot.min.y - ending_height), text.size());
        widgets::inside(&mut ui, above, Layout::left_to_right(Align::Center)).label(text);
    }
    footer_row(
        &mut widgets::inside(&mut ui, foot, Layout::left_to_right(Align::Center)),
        (open, !state.has_notes_elsewhere),
        actions,
    );
}

/// The title of the lesson, the way back to the page before it and the way out of it.
fn head(ui: &mut Ui, open: &OpenLesson, back: Option<&str>, actions: &mut Actions) {
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if widgets::cross(ui, "Close lesson").clicked() {
                actions.command(Command::CloseLesson);
            }
            let list = widgets::icon_button(ui, Command::Lessons.info().icon, "Lessons", false);
            if list.on_hover_text(Command::Lessons.with_key("All lessons")).clicked() {
                actions.command(Command::Lessons);
            }
            if let Some(page) = back {
                let name = format!("Back to {page}");
                let way_back = widgets::icon_button(ui, Command::BackToPage.info().icon, &name, false);
                if way_back.on_hover_text(Command::BackToPage.with_key(&name)).clicked() {
                    actions.command(Command::BackToPage);
                }
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let title = RichText::new(&open.lesson().title).small().weak();
                ui.add(eframe::egui::Label::new(title).truncate());
            });
        });
    });
    let font = eframe::egui::FontId::new(TextStyle::Heading.resolve(ui.style()).size, style::bold());
    ui.label(RichText::new(&open.page().title).font(font));
    ui.add_space(4.0);
}

/// The words of the page, or what is wrong with it.
fn words(
    ui: &mut Ui,
    (open, theme, beside): (&OpenLesson, Theme, &Beside<'_>),
    state: &mut State,
    actions: &mut Actions,
) {
    let prose = match open.words() {
        Ok(prose) => prose,
        Err(why) => {
            ui.label(widgets::icon(ui, Icon::TriangleAlert).color(style::color(theme.chrome().error)));
            ui.label(format!("This page cannot be shown: {why}."));
            return;
        }
    };
    let width = (ui.available_width() - 8.0).max(80.0);
    let key = Key {
        width: width.round() as u32,
        theme,
        pixels_per_point: ui.pixels_per_point(),
        atlas: ink::atlas(ui.ctx()),
    };
    if state.laid_out.as_ref().is_none_or(|before| before.key != key || before.prose != *prose) {
        let page = prose::lay_out(prose, width, theme.sizes().body, theme);
        let session = open.page().session.as_ref().ok();
        let family = session.map_or("", |session| session.experiment.estimator.info().family);
        let links = page.links.into_iter().map(|(rect, to)| (rect_from(rect), to)).collect();
        let words = Part::new(ui.painter(), page.block, family);
        state.laid_out = Some(LaidOut { prose: prose.clone(), key, words, links });
    }
    let Some(LaidOut { words, links, .. }) = &state.laid_out else { return };
    let by = ui.cursor().min.to_vec2();
    words.show(ui, "words of the lesson", beside);
    for (index, (rect, to)) in links.iter().enumerate() {
        let id = ui.scope_id().with(("link", index));
        let link = ui.interact(rect.translate(by), id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
        link.widget_info(|| eframe::egui::WidgetInfo::labeled(eframe::egui::Role::Link, true, to));
        if link.clicked() {
            actions.ask(Address::parse(to.as_ref()).map_or_else(|| Action::Open(to.into()), Action::OpenPage));
        }
    }
}

/// The line that says what → does at the end of the lesson, wrapped to `width`.
fn laid_out_ending(ui: &Ui, open: &OpenLesson, width: f32) -> Arc<Galley> {
    let text = open.next().map_or_else(|| "End of the lesson".to_owned(), |next| format!("→ again: {}", next.title));
    let font = eframe::egui::FontId::new(TextStyle::Body.resolve(ui.style()).size, style::bold());
    ui.painter().layout(text, font, ui.visuals().strong_text_color(), width)
}

/// Back, which page it is, on, and the notes where they may be seen.
fn footer_row(ui: &mut Ui, (open, has_notes): (&mut OpenLesson, bool), actions: &mut Actions) {
    let way = |ui: &mut Ui, command: Command, is_there: bool| {
        let (icon, name) = (command.info().icon, command.info().text);
        ui.add_enabled_ui(is_there, |ui| widgets::icon_button(ui, icon, name, false)).inner.clicked()
    };
    if way(ui, Command::PreviousPage, !open.is_at(Direction::Back)) {
        actions.command(Command::PreviousPage);
    }
    ui.label(format!("{} of {}", open.address().page + 1, open.lesson().pages.len()));
    if way(ui, Command::NextPage, !open.is_at(Direction::Forward)) {
        actions.command(Command::NextPage);
    }
    if has_notes && !open.page().notes.is_empty() {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let notes = Button::new(RichText::new("Notes").small()).selected(open.has_notes);
            if ui.add(notes).on_hover_text("Notes for the teacher").clicked() {
                open.has_notes = !open.has_notes;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_leaves_most_of_the_window_to_the_stage() {
        for (size, type_pt) in [((1280.0, 640.0), 21.0), ((1920.0, 1000.0), 21.0), ((1920.0, 1000.0), 14.0)] {
            let all = Rect::from_min_size(pos2(0.0, 40.0), size.into());
            let [page, rest] = split(all, type_pt);
            assert!(page.width() >= 0.219 * size.0 && rest.width() >= 0.65 * size.0, "{size:?}: {page:?}");
            assert_eq!((page.height(), rest.height()), (size.1, size.1));
        }
        let [page, rest] = split(Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 480.0)), 21.0);
        assert!(page.width() == 640.0 && rest.height() > 300.0, "above where the window is narrow");
    }
}
