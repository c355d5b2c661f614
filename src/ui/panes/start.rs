//! The start page: samples that play under the pointer, the lessons by chapter, what was open lately, and the ways to open
//! anything else.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

use eframe::egui::{
    self, Align, Button, FontId, Key, Label, Layout, Response, RichText, ScrollArea, TextStyle, Ui, WidgetInfo, vec2,
};
use lucide_icons::Icon;
use motionscope_core::synth::SCENES;
use motionscope_core::{Error, capital};

use crate::paint::Theme;
use crate::session::lesson::{self, Address};
use crate::ui::app::action::{Action, Actions};
use crate::ui::app::commands::Command;
use crate::ui::drawing::style;
use crate::ui::model::loader::Loading;
use crate::ui::model::previews::Previews;
use crate::ui::parts::sample_card::{self, Face};
use crate::ui::parts::widgets;

/// The buttons beside the title.
const BUTTONS: [Command; 4] = [Command::Open, Command::Samples, Command::Lessons, Command::SearchText];
/// Entries of what was open lately.
const RECENT: usize = 8;
/// Least width of a card, in sizes of its type, and share of its width that its picture has in height.
const CARD_LETTERS: f32 = 11.0;
const PICTURE_SHARE: f32 = 0.52;
/// Width of the names of chapters, and of what was open lately, in sizes of the type.
const CHAPTER_LETTERS: f32 = 15.5;
const RECENT_LETTERS: f32 = 17.0;
/// Lines down from which the samples have two rows.
const TWO_ROWS: f32 = 52.0;
/// The widest page, in sizes of its type.
const WIDEST: f32 = 96.0;

/// The page while it is open.
pub struct State {
    recent: Vec<Recent>,
    /// Which of them are missing, once that is known.
    missing: Receiver<Vec<bool>>,
    is_begun: bool,
    /// Whether keys are used: what has the keyboard plays as under the pointer then.
    is_keyed: bool,
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
        let look = move || {
            let missing = paths.iter().map(|path| is_file(path) && !path.exists()).collect();
            sender.send(missing).ok();
            ctx.request_repaint();
        };
        drop(std::thread::Builder::new().name("recent files".into()).spawn(look));
        Self { recent, missing, is_begun: false, is_keyed: false }
    }
}

/// What the page shows.
pub struct Input<'a> {
    /// What is being opened.
    pub loading: Option<&'a Loading>,
    /// Why the last one was not opened.
    pub error: Option<&'a Error>,
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
    state.is_keyed |= ui.input(|input| KEYS.iter().any(|key| input.key_pressed(*key)));
    let size = TextStyle::Body.resolve(ui.style()).size;
    let width = (WIDEST * size).min(ui.available_width() - 64.0);
    let side = ((ui.available_width() - width) / 2.0).round();
    let footer = ui.spacing().interact_size.y + 20.0;
    let height = ui.available_height() - footer;
    let rect = ui.max_rect();
    let column = rect.with_min_x(rect.min.x + side).with_max_x(rect.min.x + side + width);
    let top = column.with_min_y(rect.min.y + 16.0).with_max_y(rect.min.y + height);
    let mut page = widgets::inside(ui, top, Layout::top_down(Align::LEFT));
    ScrollArea::vertical().id_salt("start page").auto_shrink(false).show(&mut page, |ui| {
        // Beside the bar that scrolls.
        ui.set_width(width - 12.0);
        ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
        head(ui, actions);
        news(ui, input, actions);
        ui.add_space(12.0);
        let first = samples(ui, state.is_keyed, previews, input, actions);
        if !std::mem::replace(&mut state.is_begun, true)
            && let Some(first) = first
        {
            first.request_focus();
        }
        ui.add_space(12.0);
        lessons_and_recent(ui, state, actions);
    });
    let foot = column.with_min_y(top.max.y);
    foot_row(&mut widgets::inside(ui, foot, Layout::left_to_right(Align::Center)), input, actions);
}

/// The keys that move through the page.
const KEYS: [Key; 5] = [Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown, Key::Tab];

/// What the program is, and the ways to open anything.
fn head(ui: &mut Ui, actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.horizontal(|ui| {
        let accent = ui.visuals().hyperlink_color;
        ui.label(widgets::icon(ui, Icon::ScanEye).size(1.9 * size).color(accent));
        ui.add(Label::new(RichText::new("Motionscope").font(FontId::new(1.5 * size, style::bold()))));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if widgets::icon_button(ui, Icon::X, "Close start page", false).on_hover_text("Close\nEsc").clicked() {
                actions.command(Command::StartPage);
            }
            for command in BUTTONS.into_iter().rev() {
                let info = command.info();
                let button = Button::new((widgets::icon(ui, info.icon), info.text)).min_size(vec2(0.0, 1.9 * size));
                if ui.add(button).on_hover_text(command.with_key(info.tip)).clicked() {
                    actions.command(command);
                }
            }
        });
    });
    ui.label(RichText::new("Walk through any motion estimator, step by step, forwards and backwards.").weak());
}

/// What is being opened, or why the last one was not.
fn news(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    if let Some(loading) = input.loading {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("Opening {}…", widgets::elide(&loading.name.display().to_string(), 60)));
            if ui.button("Cancel").clicked() {
                actions.ask(Action::CancelOpening);
            }
        });
    } else if let Some(error) = input.error {
        ui.horizontal(|ui| {
            let ink = style::color(input.theme.chrome().error);
            ui.label(widgets::icon(ui, Icon::TriangleAlert).color(ink));
            let text = format!("{}.", capital(&error.to_string()));
            let label = ui.add(Label::new(&text).wrap().selectable(true));
            label.widget_info(|| WidgetInfo::labeled(egui::Role::Alert, true, &text));
        });
    }
}

/// The first samples, in as many columns as fit; gives the first card.
fn samples(
    ui: &mut Ui,
    is_keyed: bool,
    previews: &mut Previews,
    input: &Input,
    actions: &mut Actions,
) -> Option<Response> {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let rows = if ui.ctx().content_rect().height() > TWO_ROWS * size { 2 } else { 1 };
    let gap = 12.0;
    let columns = ((ui.available_width() + gap) / (CARD_LETTERS * size + gap)).floor().max(2.0);
    let width = ((ui.available_width() + gap) / columns - gap).floor();
    let picture = (PICTURE_SHARE * width).round();
    let face = Face {
        size: vec2(width, picture + 2.6 * TextStyle::Small.resolve(ui.style()).size + 20.0),
        picture,
        has_words: false,
        plays: input.plays,
        follows_focus: is_keyed,
        theme: input.theme,
    };
    widgets::heading(ui, "Begin with a clip");
    let numbers: Vec<usize> = (0..SCENES.len()).take(columns as usize * rows).collect();
    let mut first = None;
    for row in numbers.chunks(columns as usize) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            for of in row {
                let card = sample_card::show(ui, *of, previews, face);
                seen(&card);
                if card.clicked() {
                    actions.ask(Action::OpenSample(&SCENES[*of]));
                }
                first.get_or_insert(card);
            }
        });
        ui.add_space(gap - 4.0);
    }
    first
}

/// Scrolls to what has got the keyboard.
fn seen(response: &Response) {
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
}

/// The lessons, and beside them what was open lately.
fn lessons_and_recent(ui: &mut Ui, state: &State, actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.horizontal_top(|ui| {
        let recent = if state.recent.is_empty() { 0.0 } else { RECENT_LETTERS * size };
        let width = ui.available_width() - recent - 16.0;
        ui.vertical(|ui| {
            ui.set_width(width);
            widgets::heading(ui, "Lessons by chapter");
            lessons(ui, actions);
        });
        if recent > 0.0 {
            ui.vertical(|ui| {
                ui.set_width(recent);
                widgets::heading(ui, "Open again");
                state.recent.iter().for_each(|one| again(ui, one, actions));
            });
        }
    });
}

fn lessons(ui: &mut Ui, actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    // All chapters are seen in a lecture hall without scrolling.
    ui.spacing_mut().interact_size.y = (1.6 * size).round();
    ui.spacing_mut().button_padding.y = 0.0;
    ui.spacing_mut().item_spacing.y = 0.0;
    for (chapter, lessons) in lesson::chapters() {
        ui.horizontal_top(|ui| {
            let row = ui.spacing().interact_size.y;
            let width = (CHAPTER_LETTERS * size).min(0.36 * ui.available_width());
            let (rect, _) = ui.allocate_exact_size(vec2(width, row), egui::Sense::hover());
            let mut name = widgets::inside(ui, rect, Layout::left_to_right(Align::Center));
            name.add(Label::new(RichText::new(chapter.title()).small().weak()).truncate());
            ui.horizontal_wrapped(|ui| {
                for one in lessons {
                    let button = ui.add(Button::new(&one.title).frame_when_inactive(false));
                    seen(&button);
                    let tip = format!("{}\n{} pages", one.summary, one.pages.len());
                    if button.on_hover_text(tip).clicked() {
                        actions.ask(Action::OpenPage(Address::from(one)));
                    }
                }
            });
        });
    }
}

/// What was open lately, with the folder that it is in.
fn again(ui: &mut Ui, one: &Recent, actions: &mut Actions) {
    let place = if one.is_missing { "missing" } else { one.place.as_str() };
    let text = RichText::new(widgets::elide(&one.title, 28));
    let glyph = if is_file(&one.path) { Icon::File } else { Icon::BookOpen };
    let glyph = widgets::icon(ui, if one.is_missing { Icon::FileX } else { glyph });
    let button = ui.add_enabled(!one.is_missing, Button::new((glyph, text)).frame_when_inactive(false).truncate());
    seen(&button);
    let tip = match one.is_missing {
        true => format!("{} is missing.", one.path.display()),
        false => one.path.display().to_string(),
    };
    let (enabled, name) = (!one.is_missing, format!("{}, {place}", one.title));
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, &name));
    if button.on_hover_text(&tip).on_disabled_hover_text(&tip).clicked() {
        actions.ask(Action::Open(one.path.clone().into()));
    }
}

/// Whether the page comes again, and the way out of it.
fn foot_row(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let mut is_shown = input.is_shown_at_start;
    if ui.checkbox(&mut is_shown, "Show at start").changed() {
        actions.ask(Action::ShowAtStart(is_shown));
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.label(RichText::new("to the window").weak());
        widgets::key_cap(ui, "Esc", input.theme);
        ui.add_space(12.0);
        ui.label(RichText::new("opens").weak());
        widgets::key_cap(ui, "Enter", input.theme);
        ui.add_space(12.0);
        ui.label(RichText::new("choose").weak());
        ["↓", "↑", "→", "←"].iter().for_each(|key| drop(widgets::key_cap(ui, key, input.theme)));
    });
}
