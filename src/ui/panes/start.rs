//! The start page: samples that play under the pointer, the families of estimators, the lessons, what was open lately, and the ways
//! to open anything else.
//!
//! It replaces all panes, and nothing below it is opened or run until it is left; `Situation` enables no command that would
//! change a run. `Previews` makes the pictures of samples as cards come into sight, and the film of one card at a time, the one
//! under the pointer or else the one with the keyboard.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

use eframe::egui::{
    self, Align, Button, FontId, Id, Key, Label, Layout, Rect, Response, RichText, ScrollArea, TextStyle, Ui,
    WidgetInfo, vec2,
};
use lucide_icons::Icon;
use motionscope_core::base::Error;
use motionscope_core::base::words::capital;
use motionscope_core::course::estimators;
use motionscope_core::synth::SCENES;

use crate::files;
use crate::paint::Theme;
use crate::session::lesson::{self, Address};
use crate::ui::commands::{Action, Actions, Command};
use crate::ui::drawing::style;
use crate::ui::model::loader::Loading;
use crate::ui::model::previews::Previews;
use crate::ui::parts::entry_card::{self, Card};
use crate::ui::parts::sample_card::{self, Face};
use crate::ui::parts::{arrows, widgets};
use crate::work;

/// The buttons beside the title.
const BUTTONS: [Command; 5] =
    [Command::Open, Command::Samples, Command::Camera, Command::Estimators, Command::SearchText];
/// Entries of what was open lately.
const RECENT: usize = 8;
/// Least width of a card, in sizes of its type, also in a roomy window, and share of its width that its picture has in height.
const CARD_LETTERS: [f32; 2] = [11.0, 15.0];
const PICTURE_SHARE: f32 = 0.52;
/// Least width of the card of a family or a lesson, and width of what was open lately, in sizes of the type.
const ENTRY_LETTERS: f32 = 10.5;
const RECENT_LETTERS: f32 = 17.0;
/// Space between cards.
const GAP: f32 = 12.0;
/// Lines down from which the samples have two rows, and from which everything has more room.
const TWO_ROWS: f32 = 46.0;
const ROOMY: f32 = 62.0;
/// Letters across below which the buttons have no names.
const NAMED_LETTERS: f32 = 60.0;
/// The widest page, in sizes of its type.
const WIDEST: f32 = 104.0;

/// The page while it is open.
pub struct State {
    recent: Vec<Recent>,
    /// Which of them are missing, once that is known.
    missing: Receiver<Vec<bool>>,
    is_begun: bool,
    /// Whether keys are used: what has the keyboard plays as under the pointer then.
    is_keyed: bool,
    /// What could have the keyboard in the last frame, and where it lay.
    items: Vec<(Id, Rect)>,
}

/// Something that was open lately.
struct Recent {
    path: PathBuf,
    title: String,
    place: String,
    is_missing: bool,
}

impl Recent {
    fn new(path: &Path) -> Self {
        let bundled = Address::parse(path.as_os_str()).filter(|address| address.file().is_none());
        let (title, place) = match bundled.and_then(|address| Some((address.load().ok()?.title, address.page + 1))) {
            Some((title, page)) => (title, format!("lesson, page {page}")),
            None => {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
                (name, path.parent().unwrap_or(Path::new("")).display().to_string())
            }
        };
        Self { path: path.to_owned(), title, place, is_missing: false }
    }
}

/// Whether `path` names a file or a folder, and no bundled lesson.
fn is_file(path: &Path) -> bool {
    Address::parse(path.as_os_str()).is_none_or(|address| address.file().is_some())
}

impl State {
    /// The page with what was open lately.
    pub fn new(ctx: &egui::Context, recent: &[PathBuf]) -> Self {
        let recent: Vec<Recent> = recent.iter().take(RECENT).map(|path| Recent::new(path)).collect();
        let paths: Vec<_> = recent.iter().map(|one| one.path.clone()).collect();
        let (sender, missing) = channel();
        let ctx = ctx.clone();
        // A disk of the network may take long to say that something is not there.
        let look = async move || {
            let missing = paths.iter().map(|path| is_file(path) && !files::exists(path)).collect();
            sender.send(missing).ok();
            ctx.request_repaint();
        };
        drop(work::spawn("recent files", look));
        Self { recent, missing, is_begun: false, is_keyed: false, items: Vec::new() }
    }
}

/// What the page shows.
pub struct Input<'a> {
    /// What is being opened.
    pub loading: Option<&'a Loading>,
    /// Why the last one was not opened.
    pub error: Option<&'a Error>,
    /// Whether the error asks to trust a session or lesson.
    pub asks_for_trust: bool,
    /// Whether something lies over the page and has the keys.
    pub is_covered: bool,
    /// Whether the page is shown at each start.
    pub is_shown_at_start: bool,
    /// Whether pictures may move.
    pub plays: bool,
    /// The look.
    pub theme: Theme,
}

/// Shows the page in the whole of `ui`.
pub fn show(ui: &mut Ui, state: &mut State, previews: &mut Previews, input: &Input, actions: &mut Actions) {
    previews.receive(ui.ctx());
    for missing in state.missing.try_iter() {
        state.recent.iter_mut().zip(missing).for_each(|(recent, is_missing)| recent.is_missing = is_missing);
    }
    if !input.is_covered {
        state.is_keyed |= walk(ui, &state.items);
    }
    let size = TextStyle::Body.resolve(ui.style()).size;
    let margins = if widgets::is_upright(ui.ctx()) { 24.0 } else { 64.0 };
    let width = (WIDEST * size).min(ui.available_width() - margins);
    let side = ((ui.available_width() - width) / 2.0).round();
    let footer = ui.spacing().interact_size.y + 20.0;
    let rect = ui.max_rect();
    let column = rect.with_min_x(rect.min.x + side).with_max_x(rect.min.x + side + width);
    let top = column.with_min_y(rect.min.y + 16.0).with_max_y(rect.max.y - footer);
    let mut page = widgets::inside(ui, top, Layout::top_down(Align::LEFT));
    let mut drawn = Drawn { input, previews, is_keyed: state.is_keyed, items: Vec::new(), actions };
    ScrollArea::vertical().id_salt("start page").auto_shrink(false).show(&mut page, |ui| {
        // Beside the bar that scrolls.
        ui.set_width(width - 12.0);
        ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
        drawn.head(ui);
        drawn.news(ui);
        ui.add_space(12.0);
        drawn.samples(ui, &mut state.is_begun);
        ui.add_space(8.0);
        drawn.estimators(ui);
        ui.add_space(12.0);
        drawn.lessons_and_recent(ui, &state.recent);
    });
    let foot = column.with_min_y(top.max.y);
    drawn.foot(&mut widgets::inside(ui, foot, Layout::left_to_right(Align::Center)));
    state.items = drawn.items;
}

/// Moves the keyboard with the arrow keys to the nearest of `items` that way; gives whether one was pressed.
fn walk(ui: &Ui, items: &[(Id, Rect)]) -> bool {
    let Some(way) = ui.input(|input| arrows::pressed(|key| input.key_pressed(key))) else {
        return ui.input(|input| input.key_pressed(Key::Tab));
    };
    let now = ui.memory(|memory| memory.focused());
    let from = items.iter().find(|(id, _)| Some(*id) == now);
    let to = match from {
        Some((_, from)) => arrows::nearest(items, *from, way),
        None => items.first().map(|(id, _)| *id),
    };
    // The toolkit has looked for one in its own way.
    ui.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
    to.into_iter().for_each(|to| ui.memory_mut(|memory| memory.request_focus(to)));
    true
}

/// The page as it is drawn.
struct Drawn<'a, 'b> {
    input: &'a Input<'b>,
    previews: &'a mut Previews,
    is_keyed: bool,
    /// What can have the keyboard.
    items: Vec<(Id, Rect)>,
    actions: &'a mut Actions,
}

impl Drawn<'_, '_> {
    /// Notes something that can have the keyboard, and scrolls to it once it has.
    fn item(&mut self, response: &Response) {
        self.items.push((response.id, response.rect));
        if response.gained_focus() {
            response.scroll_to_me(None);
        }
    }

    /// The name of the program, and the ways to open a clip.
    fn head(&mut self, ui: &mut Ui) {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let is_upright = widgets::is_upright(ui.ctx());
        ui.horizontal(|ui| {
            let accent = ui.visuals().hyperlink_color;
            ui.label(widgets::icon(ui, Icon::ScanEye).size(1.9 * size).color(accent));
            ui.add(Label::new(RichText::new("Motionscope").font(FontId::new(1.5 * size, style::bold()))));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let close = widgets::icon_button(ui, Icon::X, "Close start page", false).on_hover_text("Close\nEsc");
                if close.clicked() {
                    self.actions.command(Command::StartPage);
                }
                let offered = BUTTONS.into_iter().filter(|command| command.is_offered() && !is_upright);
                for command in offered.rev() {
                    self.button(ui, command);
                }
                self.item(&close);
            });
        });
        ui.label(RichText::new("Walk through any motion estimator, step by step, forwards and backwards.").weak());
        if is_upright {
            let offered = BUTTONS.into_iter().filter(|command| command.is_offered());
            ui.horizontal(|ui| offered.for_each(|command| self.button(ui, command)));
        }
    }

    fn button(&mut self, ui: &mut Ui, command: Command) {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let info = command.entry();
        // In a narrow window the icons alone.
        let is_narrow = ui.ctx().content_rect().width() < NAMED_LETTERS * size;
        let glyph = widgets::icon(ui, info.icon);
        let button = if is_narrow { Button::new(glyph) } else { Button::new((glyph, info.text)) };
        let response = ui.add(button.min_size(vec2(1.9 * size, 1.9 * size)));
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, info.text));
        self.item(&response);
        if response.on_hover_text(command.with_key(info.tip)).clicked() {
            self.actions.command(command);
        }
    }

    /// What is being opened, or why the last one was not.
    fn news(&mut self, ui: &mut Ui) {
        if let Some(loading) = self.input.loading {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(format!(
                    "Opening {}…",
                    widgets::elide(&files::label(Path::new(&loading.name)).to_string(), 60)
                ));
                if ui.button("Cancel").clicked() {
                    self.actions.ask(Action::CancelOpening);
                }
            });
        } else if let Some(error) = self.input.error {
            ui.horizontal(|ui| {
                let ink = style::color(self.input.theme.chrome().error);
                ui.label(widgets::icon(ui, Icon::TriangleAlert).color(ink));
                let text = format!("{}.", capital(&error.to_string()));
                let label = ui.add(Label::new(&text).wrap().selectable(true));
                label.widget_info(|| WidgetInfo::labeled(egui::Role::Alert, true, &text));
                if self.input.asks_for_trust && ui.button("Open these files").clicked() {
                    self.actions.ask(Action::Trust);
                }
            });
        }
    }

    /// The first samples, in as many columns as fit. The first card gets the keyboard when the page is opened.
    fn samples(&mut self, ui: &mut Ui, is_begun: &mut bool) {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let rows = if ui.ctx().content_rect().height() > TWO_ROWS * size { 2 } else { 1 };
        let gap = GAP;
        let least = CARD_LETTERS[usize::from(is_roomy(ui))] * size;
        let columns = ((ui.available_width() + gap) / (least + gap)).floor().max(2.0);
        let width = ((ui.available_width() + gap) / columns - gap).floor();
        let picture = (PICTURE_SHARE * width).round();
        let face = Face {
            size: vec2(width, picture + 2.6 * TextStyle::Small.resolve(ui.style()).size + 20.0),
            picture,
            has_words: false,
            plays: self.input.plays,
            follows_focus: self.is_keyed,
            theme: self.input.theme,
        };
        widgets::heading(ui, "Begin with a clip");
        let numbers: Vec<usize> = (0..SCENES.len()).take(columns as usize * rows).collect();
        for row in numbers.chunks(columns as usize) {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = gap;
                for of in row {
                    let card = sample_card::show(ui, *of, self.previews, face);
                    self.item(&card);
                    if card.clicked() {
                        self.actions.ask(Action::OpenSample(&SCENES[*of]));
                    }
                    if !std::mem::replace(is_begun, true) {
                        card.request_focus();
                    }
                }
            });
            ui.add_space(gap - 4.0);
        }
    }

    /// The lessons, and beside them what was open lately.
    fn lessons_and_recent(&mut self, ui: &mut Ui, recent: &[Recent]) {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let all = ui.available_width();
        let beside = if recent.is_empty() || widgets::is_upright(ui.ctx()) {
            0.0
        } else {
            (RECENT_LETTERS * size).min(0.34 * all)
        };
        let again = |page: &mut Self, ui: &mut Ui| {
            widgets::heading(ui, "Open again");
            tighten(ui);
            recent.iter().for_each(|one| page.again(ui, one));
        };
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(all - beside - if widgets::is_upright(ui.ctx()) { 0.0 } else { 24.0 });
                widgets::heading(ui, "Lessons");
                self.lessons(ui);
            });
            if beside > 0.0 {
                ui.vertical(|ui| {
                    ui.set_width(beside);
                    again(self, ui);
                });
            }
        });
        if beside == 0.0 && !recent.is_empty() {
            ui.vertical(|ui| again(self, ui));
        }
    }

    /// The families of estimators, each with a picture of its first one. A card opens the chooser at its family.
    fn estimators(&mut self, ui: &mut Ui) {
        widgets::heading(ui, "Begin with an estimator");
        let all: Vec<_> = estimators().iter().map(|estimator| estimator.info()).collect();
        let families: Vec<_> = all.chunk_by(|a, b| a.family == b.family).collect();
        self.grid(ui, 3.3, &families, |page, ui, rect, family| {
            let first = family[0];
            let note = format!("{} estimators", family.len());
            let texture = ui.is_rect_visible(rect).then(|| page.previews.steps.picture(first.id)).flatten();
            let card = Card { title: first.family, note: &note, picture: rect.height() - 24.0, texture, ..page.card() };
            if page.entry(ui, rect, card).clicked() {
                page.actions.ask(Action::Type(Command::Estimators, first.family.to_owned(), false));
            }
        });
    }

    fn lessons(&mut self, ui: &mut Ui) {
        let all: Vec<_> = lesson::chapters()
            .into_iter()
            .flat_map(|(chapter, lessons)| lessons.into_iter().map(move |one| (chapter, one)))
            .collect();
        self.grid(ui, 4.4, &all, |page, ui, rect, (chapter, one)| {
            let pages = format!("{}\u{a0}pages", one.pages.len());
            let is_named_so = chapter.title() == one.title;
            let note = if is_named_so { pages.clone() } else { format!("{} · {pages}", chapter.title()) };
            let card = Card { title: &one.title, note: &note, ..page.card() };
            if page.entry(ui, rect, card).on_hover_text(&one.summary).clicked() {
                page.actions.ask(Action::OpenPage(Address::from(*one)));
            }
        });
    }

    /// Cards of equal size, so many lines of the type high, in as many columns as fit.
    fn grid<T>(&mut self, ui: &mut Ui, lines: f32, all: &[T], mut show: impl FnMut(&mut Self, &mut Ui, Rect, &T)) {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let width = ui.available_width();
        let most = ((width + GAP) / (ENTRY_LETTERS * size + GAP)).max(1.0) as usize;
        let rows = all.len().div_ceil(most).max(1);
        // Rows about as long.
        let columns = all.len().div_ceil(rows).max(1);
        let card = vec2(((width + GAP) / columns as f32 - GAP).floor(), (lines * size).round());
        let height = rows as f32 * (card.y + 8.0) - 8.0;
        let (place, _) = ui.allocate_exact_size(vec2(width, height), egui::Sense::hover());
        for (index, one) in all.iter().enumerate() {
            let [column, row] = [index % columns, index / columns].map(|at| at as f32);
            let at = place.min + vec2(column * (card.x + GAP), row * (card.y + 8.0));
            show(self, ui, Rect::from_min_size(at, card), one);
        }
    }

    fn card(&self) -> Card<'static> {
        Card { has_edge: true, theme: self.input.theme, ..Card::default() }
    }

    fn entry(&mut self, ui: &mut Ui, rect: Rect, card: Card<'_>) -> Response {
        let card = Card { name: card.title, ..card };
        let response = entry_card::show(ui, rect, ui.scope_id().with(card.title), &card);
        self.item(&response);
        response
    }

    /// Something that was open lately.
    fn again(&mut self, ui: &mut Ui, one: &Recent) {
        let place = if one.is_missing { "missing" } else { one.place.as_str() };
        let glyph = match (one.is_missing, is_file(&one.path)) {
            (true, _) => Icon::FileX,
            (false, true) => Icon::File,
            (false, false) => Icon::BookOpen,
        };
        let glyph = widgets::icon(ui, glyph);
        let button = Button::new((glyph, RichText::new(&one.title))).frame_when_inactive(false).truncate();
        let button = ui.add_enabled(!one.is_missing, button);
        let (enabled, name) = (!one.is_missing, format!("{}, {place}", one.title));
        button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, &name));
        let path = one.path.display();
        if one.is_missing {
            button.on_disabled_hover_text(format!("{path} is missing."));
            return;
        }
        self.item(&button);
        if button.on_hover_text(if is_file(&one.path) { path.to_string() } else { name.clone() }).clicked() {
            self.actions.ask(Action::Open(one.path.clone().into()));
        }
    }

    /// Whether the page comes again, and the keys.
    fn foot(&mut self, ui: &mut Ui) {
        let mut is_shown = self.input.is_shown_at_start;
        let shown = ui.checkbox(&mut is_shown, "Show at start");
        self.item(&shown);
        if shown.changed() {
            self.actions.ask(Action::ShowAtStart(is_shown));
        }
        if widgets::is_upright(ui.ctx()) {
            return;
        }
        let theme = self.input.theme;
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            for (index, (word, keys)) in
                [("to the window", &["Esc"][..]), ("opens", &["Enter"]), ("choose", &["↓", "↑", "→", "←"])]
                    .iter()
                    .enumerate()
            {
                if index > 0 {
                    ui.add_space(12.0);
                }
                ui.label(RichText::new(*word).weak());
                keys.iter().for_each(|key| drop(widgets::key_cap(ui, key, theme)));
            }
        });
    }
}

/// Whether the window is much larger than its type.
fn is_roomy(ui: &Ui) -> bool {
    ui.ctx().content_rect().height() > ROOMY * TextStyle::Body.resolve(ui.style()).size
}

/// Lines that follow each other closely, so that all chapters are seen in a lecture hall without scrolling.
fn tighten(ui: &mut Ui) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let lines = if is_roomy(ui) { 2.2 } else { 1.6 };
    let spacing = ui.spacing_mut();
    spacing.interact_size.y = (lines * size).round();
    (spacing.button_padding.y, spacing.item_spacing.y) = (0.0, 0.0);
}
