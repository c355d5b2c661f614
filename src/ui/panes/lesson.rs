//! The page of a lesson: its words and formulas, and the way to the pages around it.

use std::sync::Arc;

use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{
    Align, Button, CursorIcon, Galley, Layout, Rect, RichText, ScrollArea, Sense, Stroke, TextFormat, TextStyle, Ui,
    UiBuilder, vec2,
};
use lucide_icons::Icon;
use motionscope_core::run::Direction;

use super::explanation::Part;
use super::glossary::Beside;
use crate::paint::Primitive;
use crate::paint::Theme;
use crate::paint::charts::explanation::Block;
use crate::paint::charts::prose::{self, Prose};
use crate::session::lesson::Address;
use crate::ui::commands::{Action, Actions, Command};
use crate::ui::drawing::chart::rect_from;
use crate::ui::drawing::{ink, style};
use crate::ui::model::lesson::OpenLesson;
use crate::ui::parts::widgets;

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
    /// How far the words are scrolled, and how far they are to be.
    offset: f32,
    wanted: Option<f32>,
    /// Height of what is seen of the words, and of all.
    seen: [f32; 2],
    /// Height of the whole pane with all of its words.
    needed: f32,
}

impl State {
    /// Height of the pane with all of its words, in points, as it was shown last.
    pub fn needed(&self) -> f32 {
        self.needed
    }

    /// Whether words of the page follow below those that are seen.
    pub fn has_more(&self) -> bool {
        let [seen, all] = self.seen;
        self.offset + seen < all - 1.0
    }

    /// Goes on to the words that are not seen yet, or back; gives whether there are any.
    pub fn read(&mut self, way: Direction) -> bool {
        let [seen, all] = self.seen;
        let rows = self.laid_out.as_ref().map_or(&[][..], |page| &page.rows);
        let to = match way {
            Direction::Forward if self.has_more() => {
                let next = rows.iter().find(|row| row.bottom > self.offset + seen + 0.5).map_or(all, |row| row.top);
                // A row that is higher than the pane is read on within it.
                if next < self.offset + 0.5 * seen { self.offset + seen } else { next }
            }
            Direction::Back if self.offset > 0.0 => {
                let from = self.offset - seen;
                let row = rows.iter().map(|row| row.top).find(|top| *top >= from).unwrap_or(from);
                (if row > self.offset - 0.5 * seen { from } else { row }).max(0.0)
            }
            _ => return false,
        };
        self.wanted = Some(to);
        true
    }
}

/// A page as it is shown.
struct LaidOut {
    prose: Prose,
    key: Key,
    words: Part,
    rows: Vec<Row>,
    /// Where each link stands, and where it leads.
    links: Vec<(Rect, String)>,
}

/// A row of words or formulas.
#[derive(Clone, Copy, Debug)]
struct Row {
    top: f32,
    bottom: f32,
    ends_sentence: bool,
    /// Whether it announces the row that follows, as a colon does.
    announces: bool,
}

/// What the layout of a page follows from beside its words.
#[derive(Clone, Default, PartialEq)]
struct Key {
    width: u32,
    theme: Theme,
    pixels_per_point: f32,
    atlas: u64,
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
    /// Whether keys alone turn the pages, so that the title has the room of the buttons.
    pub is_presented: bool,
}

/// Shows the page that is open in `rect`.
pub fn show(ui: &mut Ui, rect: Rect, input: Input<'_>, state: &mut State, actions: &mut Actions) {
    let Input { open, theme, back, beside, is_presented } = input;
    let chrome = theme.chrome();
    ui.painter().rect_filled(rect, 0.0, style::color(chrome.panel));
    let line = Stroke::new(1.0, style::color(chrome.line));
    ui.painter().hline(rect.x_range(), rect.max.y + 0.5, line);
    ui.painter().vline(rect.max.x + 0.5, rect.y_range(), line);
    let inside = rect.shrink2(vec2(MARGIN, 8.0));
    let mut ui = ui.new_child(UiBuilder::new().id_salt("lesson").max_rect(inside));
    ui.set_clip_rect(ui.clip_rect().intersect(rect));
    if is_presented {
        title(&mut ui, open);
    } else {
        head(&mut ui, (open, back, !state.has_notes_elsewhere), actions);
    }
    let more = (1.2 * TextStyle::Body.resolve(ui.style()).size).round();
    let ending = open.is_over.then(|| laid_out_ending(&ui, open, inside.width()));
    let below = ending.as_ref().map_or(more, |text| text.size().y + 4.0);
    let height = (ui.available_height() - below).max(40.0);
    let turned = state.page.as_ref() != Some(open.address());
    state.page = Some(open.address().clone());
    let wanted = if turned { Some(0.0) } else { state.wanted.take() };
    let offset = wanted.unwrap_or(state.offset);
    let rows = state.laid_out.as_ref().map_or(&[][..], |page| &page.rows);
    let seen = readable_height(rows, offset, height);
    let scroll = ScrollArea::vertical().id_salt("page").auto_shrink(false).max_height(seen);
    let scroll = if let Some(offset) = wanted { scroll.vertical_scroll_offset(offset) } else { scroll };
    let scrolled = scroll.show(&mut ui, |ui| {
        let begin = ui.cursor().min.y;
        words(ui, (open, theme, beside), state, actions);
        let end = ui.cursor().min.y;
        if open.has_notes && !state.has_notes_elsewhere && !open.page().notes.is_empty() {
            ui.add_space(12.0);
            widgets::heading(ui, "Notes");
            ui.label(RichText::new(&open.page().notes).weak());
        }
        // Whatever is read on to begins with a row, the last one as well.
        if end - begin > seen {
            ui.add_space((seen - (ui.cursor().min.y - end)).max(0.0));
        }
        end
    });
    let all = scrolled.inner + scrolled.state.clamped_offset().y - scrolled.inner_rect.min.y;
    let around = scrolled.inner_rect.min.y - rect.min.y + below + 8.0;
    let before = (state.offset, state.seen, state.needed);
    // Below the last row is nothing to be read.
    let last = state.laid_out.as_ref().and_then(|page| page.rows.last());
    let readable = last.map_or(all, |row| all.min(row.bottom));
    (state.offset, state.seen) = (scrolled.state.clamped_offset().y, [seen, readable]);
    state.needed = (around + all).ceil();
    if before != (state.offset, state.seen, state.needed) {
        widgets::lay_out_anew(ui.ctx(), "the page needs another height");
    }
    let foot = inside.with_min_y(inside.max.y - below);
    if let Some(text) = ending {
        widgets::inside(&mut ui, foot, Layout::left_to_right(Align::Center)).label(text);
    } else if state.has_more() {
        let row = &mut widgets::inside(&mut ui, foot, Layout::right_to_left(Align::Center));
        row.spacing_mut().interact_size.y = more;
        row.spacing_mut().button_padding.y = 0.0;
        let button = Button::new((widgets::icon(row, Icon::ChevronDown), RichText::new("more").small()));
        if row.add(button).on_hover_text("The page goes on: → shows the rest before it steps.").clicked() {
            state.read(Direction::Forward);
        }
    }
}

/// The title of the page over the whole width, and behind it the number of the page.
fn title(ui: &mut Ui, open: &OpenLesson) {
    let font = eframe::egui::FontId::new(TextStyle::Heading.resolve(ui.style()).size, style::bold());
    let small = TextStyle::Small.resolve(ui.style());
    let format = |font_id, color| TextFormat { font_id, color, valign: Align::Center, ..TextFormat::default() };
    let mut job = LayoutJob { wrap: TextWrapping::wrap_at_width(ui.available_width()), ..LayoutJob::default() };
    job.append(&open.page().title, 0.0, format(font, ui.visuals().strong_text_color()));
    let number = format!("{} of {}", open.address().page + 1, open.lesson().pages.len());
    job.append(&number.replace(' ', "\u{a0}"), MARGIN, format(small, ui.visuals().weak_text_color()));
    ui.label(job).on_hover_text(&open.lesson().title);
    ui.add_space(2.0);
}

/// The title of the page, the ways to those around it, and the way out of the lesson.
fn head(ui: &mut Ui, (open, back, has_notes): (&mut OpenLesson, Option<&str>, bool), actions: &mut Actions) {
    let row = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), ui.spacing().interact_size.y));
    let buttons = &mut widgets::inside(ui, row, Layout::right_to_left(Align::Center));
    buttons.spacing_mut().item_spacing.x = 2.0;
    if widgets::cross(buttons, "Close lesson").clicked() {
        actions.command(Command::CloseLesson);
    }
    let list = widgets::icon_button(buttons, Command::Lessons.entry().icon, "Lessons", false);
    if list.on_hover_text(Command::Lessons.with_key("All lessons")).clicked() {
        actions.command(Command::Lessons);
    }
    if has_notes && !open.page().notes.is_empty() {
        let notes = widgets::icon_button(buttons, Icon::StickyNote, "Notes", open.has_notes);
        if notes.on_hover_text("Notes for the teacher").clicked() {
            open.has_notes = !open.has_notes;
        }
    }
    if let Some(page) = back {
        let name = format!("Back to {page}");
        let way_back = widgets::icon_button(buttons, Command::BackToPage.entry().icon, &name, false);
        if way_back.on_hover_text(Command::BackToPage.with_key(&name)).clicked() {
            actions.command(Command::BackToPage);
        }
    }
    let mut way = |ui: &mut Ui, command: Command, is_there: bool| {
        let (icon, name) = (command.entry().icon, command.entry().text);
        if ui.add_enabled_ui(is_there, |ui| widgets::icon_button(ui, icon, name, false)).inner.clicked() {
            actions.command(command);
        }
    };
    way(buttons, Command::NextPage, !open.is_at(Direction::Forward));
    let place = buttons.label(format!("{} of {}", open.address().page + 1, open.lesson().pages.len()));
    place.on_hover_text(&open.lesson().title);
    way(buttons, Command::PreviousPage, !open.is_at(Direction::Back));
    let font = eframe::egui::FontId::new(TextStyle::Heading.resolve(ui.style()).size, style::bold());
    let left = (buttons.min_rect().min.x - row.min.x - ui.spacing().item_spacing.x).max(0.0);
    let set = |text: &str, width: f32| {
        ui.painter().layout(text.to_owned(), font.clone(), ui.visuals().strong_text_color(), width)
    };
    let title = &open.page().title;
    let longest = title.split(' ').map(|word| set(word, f32::INFINITY).size().x).fold(0.0, f32::max);
    // Where a word has no room beside the buttons, the title stands below them.
    let has_room = longest <= left;
    let width = if has_room { left } else { row.width() };
    let title = set(title, width);
    if !has_room {
        ui.add_space(row.height());
    }
    let size = vec2(width, title.size().y.max(row.height()));
    let named = ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_size(size);
        ui.label(title)
    });
    named.inner.on_hover_text(&open.lesson().title);
    ui.add_space(2.0);
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
            state.laid_out = None;
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
        let rows = rows(&page.block);
        // In another width the same words stand at the top, from the beginning of their row on.
        if state.laid_out.as_ref().is_some_and(|before| before.prose == *prose) && state.offset > 0.0 {
            state.wanted = row_at(&rows, state.offset / state.seen[1].max(1.0));
        }
        let links = page.links.into_iter().map(|(rect, to)| (rect_from(rect), to)).collect();
        let words = Part::new(ui.painter(), page.block, (&[], family));
        state.laid_out = Some(LaidOut { prose: prose.clone(), key, words, rows, links });
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

/// Where the row begins that stands this share of the way down a page.
fn row_at(rows: &[Row], share: f32) -> Option<f32> {
    let all = rows.last()?.bottom;
    rows.iter().map(|row| row.top).take_while(|top| *top <= share * all + 0.5).last()
}

/// How much of a page is shown from `offset` on in a pane of this height: no row is cut at the bottom, nor a sentence if most of the
/// pane is full without it.
fn readable_height(rows: &[Row], offset: f32, height: f32) -> f32 {
    /// The share of the pane that is full at least.
    const FULL: f32 = 0.6;
    let is_cut = |row: &Row| row.top < offset + height && row.bottom > offset + height + 0.5;
    let Some(cut) = rows.iter().position(is_cut) else { return height };
    let mut ends = rows[..cut].iter().zip(&rows[1..]).filter(|(row, _)| row.ends_sentence).map(|(_, next)| next.top);
    // A sentence that announces a formula stays on one page with it.
    let announced = rows[..cut].iter().rev().take_while(|row| row.announces).last();
    let last = announced.map_or(rows[cut].top, |row| row.top);
    let end = ends.next_back().filter(|top| *top - offset >= FULL * height).unwrap_or(last);
    (end - offset).clamp(0.5 * height, height)
}

/// Each row of text in a block: parts of a formula that stand above each other are one row.
fn rows(block: &Block) -> Vec<Row> {
    let of = |primitive: &Primitive| match primitive {
        Primitive::Text(line) => {
            let words = line.runs.last().map_or("", |run| run.text.trim_end());
            let (top, bottom) = (line.at[1] - 0.95 * line.size, line.at[1] + 0.3 * line.size);
            Some((
                line.at[0],
                Row { top, bottom, announces: words.ends_with(':'), ends_sentence: words.ends_with(['.', '?', '!']) },
            ))
        }
        _ => None,
    };
    let mut all: Vec<(f32, Row)> = block.primitives.iter().filter_map(of).collect();
    all.sort_by(|(_, a), (_, b)| a.top.total_cmp(&b.top));
    let mut rows: Vec<(f32, Row)> = Vec::new();
    for (left, row) in all {
        match rows.last_mut() {
            Some((rightmost, last)) if row.top < last.bottom => {
                last.bottom = last.bottom.max(row.bottom);
                if left >= *rightmost {
                    (*rightmost, last.ends_sentence, last.announces) = (left, row.ends_sentence, row.announces);
                }
            }
            _ => rows.push((left, row)),
        }
    }
    rows.into_iter().map(|(_, row)| row).collect()
}

/// The line that says what → does at the end of the lesson, wrapped to `width`.
fn laid_out_ending(ui: &Ui, open: &OpenLesson, width: f32) -> Arc<Galley> {
    let text = open.next().map_or_else(|| "End of the lesson".to_owned(), |next| format!("→ again: {}", next.title));
    let font = eframe::egui::FontId::new(TextStyle::Body.resolve(ui.style()).size, style::bold());
    ui.painter().layout(text, font, ui.visuals().strong_text_color(), width)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(top: f32, ends_sentence: bool) -> Row {
        Row { top, bottom: top + 18.0, ends_sentence, announces: false }
    }

    #[test]
    fn a_page_breaks_between_sentences_where_that_leaves_it_full() {
        let rows = |ends: usize| (0..10).map(|i| row(20.0 * i as f32, i == ends)).collect::<Vec<_>>();
        assert_eq!(readable_height(&rows(9), 0.0, 110.0), 100.0, "the sixth row would be cut");
        assert_eq!(readable_height(&rows(3), 0.0, 110.0), 80.0, "the fourth row ends a sentence");
        assert_eq!(readable_height(&rows(1), 0.0, 110.0), 100.0, "too little would be left");
        assert_eq!(readable_height(&rows(8), 100.0, 110.0), 110.0, "the rest has room");
        let mut announced = rows(9);
        announced[4].announces = true;
        assert_eq!(readable_height(&announced, 0.0, 110.0), 80.0, "the fifth row announces the sixth");
    }

    #[test]
    fn the_same_words_stand_at_the_top_in_another_width() {
        // Half as wide, the same words take two rows each.
        let [wide, narrow] = [10, 20].map(|count| (0..count).map(|i| row(20.0 * i as f32, false)).collect::<Vec<_>>());
        for (i, row) in wide.iter().enumerate() {
            let there = row_at(&narrow, row.top / wide[9].bottom);
            assert_eq!(there, Some(narrow[2 * i].top), "row {i}");
            let back = row_at(&wide, narrow[2 * i].top / narrow[19].bottom).expect("a row");
            assert!((row.top - 20.0..=row.top).contains(&back), "row {i} comes back at {back}, within a row");
        }
        assert_eq!(row_at(&[], 0.5), None);
    }

    #[test]
    fn words_are_read_on_from_the_first_row_that_was_not_whole_and_back() {
        let rows = (0..10).map(|i| row(20.0 * i as f32, false)).collect();
        let laid_out =
            LaidOut { rows, prose: Prose::default(), key: Key::default(), words: Part::default(), links: Vec::new() };
        let mut state = State { laid_out: Some(laid_out), seen: [70.0, 198.0], ..State::default() };
        let mut offsets = Vec::new();
        while state.read(Direction::Forward) {
            state.offset = state.wanted.take().unwrap_or_default();
            offsets.push(state.offset);
        }
        assert_eq!(offsets, [60.0, 120.0, 180.0], "each begins with the row that was cut");
        let mut back = 0;
        while state.read(Direction::Back) {
            state.offset = state.wanted.take().unwrap_or_default();
            back += 1;
        }
        assert_eq!((back, state.offset), (3, 0.0));
    }

    #[test]
    fn a_row_that_is_higher_than_the_pane_is_read_on_within_it() {
        let rows = [[0.0, 100.0], [100.0, 400.0]]
            .map(|[top, bottom]| Row { top, bottom, ends_sentence: false, announces: false })
            .into();
        let laid_out =
            LaidOut { rows, prose: Prose::default(), key: Key::default(), words: Part::default(), links: Vec::new() };
        let mut state = State { laid_out: Some(laid_out), seen: [80.0, 400.0], ..State::default() };
        for way in [Direction::Forward, Direction::Back] {
            let mut count = 0;
            while state.read(way) {
                state.offset = state.wanted.take().unwrap_or_default();
                count += 1;
                assert!(count < 9, "{way:?} goes on for ever at {}", state.offset);
            }
        }
        assert_eq!(state.offset, 0.0);
    }
}
