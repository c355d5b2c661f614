//! The presenter's window: the notes of the page, the next step and the time, while the class sees the stage.

use eframe::egui::{self, Align, Button, FontId, Label, Layout, RichText, ScrollArea, TextStyle, Ui, WidgetInfo, vec2};
use motionscope_core::base::Error;

use crate::paint::Theme;
use crate::ui::commands::{Actions, Command};
use crate::ui::drawing::style;
use crate::ui::model::document::Document;
use crate::ui::model::lesson::OpenLesson;
use crate::ui::model::predict::{DIRECTIONS, Predict, asks_for_place};
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::upcoming::Next;
use crate::ui::parts::widgets;

/// The keys that are told of, with what they do.
const KEYS: [(Command, &str); 8] = [
    (Command::Into, "next step"),
    (Command::IntoBack, "previous step"),
    (Command::NextUnit, "next result"),
    (Command::Play, "play"),
    (Command::NextChart, "next chart"),
    (Command::Pointer, "pointer"),
    (Command::Pen, "pen"),
    (Command::Present, "full screen"),
];

/// Size of sentences and notes, in sizes of those of the main window.
const LARGER: f32 = 1.3;
/// Width of a key with its words, in letters.
const KEY_LETTERS: f32 = 9.5;

/// What the presenter sees.
pub struct Input<'a> {
    /// What is open.
    pub document: &'a Document,
    /// The lesson that is open.
    pub lesson: Option<&'a OpenLesson>,
    /// The step that the class sees.
    pub shown: Option<&'a Snapshot>,
    /// The step after it.
    pub coming: Coming,
    /// The question about that step, if one is open.
    pub predict: &'a Predict,
    /// For how long the window is open, in minutes.
    pub minutes: u64,
    /// The theme of both windows.
    pub theme: Theme,
}

/// What comes after the step that the class sees.
#[derive(Clone, Debug, PartialEq)]
pub enum Coming {
    /// It is being worked out, or the run plays.
    Awaited,
    /// A step.
    Step(Next),
    /// The next page of the lesson, by its title.
    Page(String),
    /// Nothing: the run is at its end.
    End,
    /// It cannot be computed.
    Failed(Error),
}

impl Coming {
    fn words(&self) -> String {
        match self {
            Self::Awaited => "…".to_owned(),
            Self::Step(next) => next.sentence().plain(),
            Self::Page(title) => format!("Next page: {title}"),
            Self::End => "The run ends here.".to_owned(),
            Self::Failed(why) => format!("The next step cannot be computed: {why}."),
        }
    }
}

/// What is asked of the window itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The window is to close.
    pub closes: bool,
    /// The clock is to restart.
    pub restarts: bool,
}

/// Shows the window in the whole of `ui`.
pub fn show(ui: &mut Ui, input: &Input<'_>, actions: &mut Actions) -> Response {
    ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
    let mut response = Response::default();
    head(ui, input, &mut response);
    ui.separator();
    // Two lines, the buttons and the keys.
    let rows = 1 + KEYS.len().div_ceil(key_columns(ui, input.theme));
    let foot = rows as f32 * (ui.spacing().interact_size.y + ui.spacing().item_spacing.y) + 24.0;
    let height = (ui.available_height() - foot).max(80.0);
    ScrollArea::vertical().id_salt("presenter").auto_shrink(false).max_height(height).show(ui, |ui| {
        // It is read while standing.
        if let Some(font) = ui.style_mut().text_styles.get_mut(&TextStyle::Body) {
            font.size = (LARGER * font.size).round();
        }
        tally(ui, input.predict, input.theme);
        now_and_next(ui, input);
        notes(ui, input.lesson);
    });
    ui.separator();
    steps(ui, actions);
    keys(ui, input.theme);
    response
}

/// The lesson and its page, or the clip, and the time.
fn head(ui: &mut Ui, input: &Input<'_>, response: &mut Response) {
    let (small, large) = (TextStyle::Small.resolve(ui.style()), TextStyle::Heading.resolve(ui.style()).size);
    let clip = || input.document.clip().map_or_else(String::new, |clip| clip.info().name.clone());
    let over = input.lesson.map_or_else(clip, |open| {
        format!("{} · page {} of {}", open.lesson().title, open.address().page + 1, open.lesson().pages.len())
    });
    let title = input.lesson.map_or_else(
        || input.shown.map_or_else(|| "No run".to_owned(), |shown| shown.info.name.to_owned()),
        |open| open.page().title.clone(),
    );
    ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
        if widgets::cross(ui, "Close presenter's window").clicked() {
            response.closes = true;
        }
        let time = RichText::new(clock(input.minutes)).font(FontId::monospace(1.25 * large));
        let time = ui.add(Button::new(time).frame(false)).on_hover_text("Restart the clock");
        time.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "Restart the clock"));
        response.restarts = time.clicked();
        ui.with_layout(Layout::top_down(Align::Min), |ui| {
            ui.add(Label::new(RichText::new(over).font(small).weak()).truncate());
            let title = RichText::new(title).font(FontId::new(large, style::bold()));
            ui.add(Label::new(title).truncate());
        });
    });
}

/// Minutes, from an hour on with hours.
fn clock(minutes: u64) -> String {
    let (hours, minutes) = (minutes / 60, minutes % 60);
    if hours > 0 { format!("{hours} h {minutes:02} min") } else { format!("{minutes} min") }
}

/// The sentence of the step that the class sees, and of the one after it.
fn now_and_next(ui: &mut Ui, input: &Input<'_>) {
    let Some(shown) = input.shown else { return };
    widgets::heading(ui, &format!("Now · step {}", shown.cursor));
    ui.label(shown.step.sentence.plain());
    ui.add_space(4.0);
    let heading = match &input.coming {
        Coming::Step(next) => format!("Next · step {}", next.cursor),
        _ => "Next".to_owned(),
    };
    widgets::heading(ui, &heading);
    ui.label(RichText::new(input.coming.words()).strong());
    ui.add_space(4.0);
}

/// The question that the class is asked, and the hands for each answer.
fn tally(ui: &mut Ui, predict: &Predict, theme: Theme) {
    let Some(open) = predict.last() else { return };
    widgets::heading(ui, "Question");
    ui.label(super::question::title(predict));
    let answers = if asks_for_place(open.question) { DIRECTIONS.to_vec() } else { open.question.choices() };
    let right = open.verdict().map(|verdict| verdict.right).unwrap_or_default();
    let most = open.guesses.hands.iter().copied().max().unwrap_or(0).max(1);
    let size = TextStyle::Body.resolve(ui.style()).size;
    for (key, (answer, hands)) in (1..).zip(answers.iter().zip(&open.guesses.hands)) {
        ui.horizontal(|ui| {
            let column = vec2(18.0 * size, 1.4 * size);
            let is_right = right.contains(answer);
            let text = RichText::new(format!("{key}  {answer}"));
            let text = if is_right { text.strong() } else { text };
            let left = Layout::left_to_right(Align::Center);
            ui.allocate_ui_with_layout(column, left, |ui| {
                ui.set_min_size(column);
                ui.add(Label::new(text).truncate());
            });
            let bar = vec2(8.0 * size * *hands as f32 / most as f32, 0.6 * size);
            let (rect, _) = ui.allocate_exact_size(bar, egui::Sense::hover());
            ui.painter().rect_filled(rect, 2.0, style::color(theme.chrome().accent));
            ui.label(hands.to_string());
        });
    }
    let guesses = open.guesses.places.len() + open.guesses.numbers.len();
    if guesses > 0 {
        ui.label(format!("{guesses} {}", if guesses == 1 { "guess" } else { "guesses" }));
    }
    if let Some(verdict) = open.verdict() {
        ui.label(RichText::new(verdict.text()).strong());
    }
    ui.add_space(4.0);
}

/// The notes of the page.
fn notes(ui: &mut Ui, lesson: Option<&OpenLesson>) {
    let Some(open) = lesson else { return };
    widgets::heading(ui, "Notes");
    match open.page().notes.trim() {
        "" => ui.label(RichText::new("This page has no notes.").weak()),
        notes => ui.label(notes),
    };
}

/// Buttons that step the window of the class.
fn steps(ui: &mut Ui, actions: &mut Actions) {
    ui.horizontal(|ui| {
        for (command, text) in [(Command::IntoBack, "Previous step"), (Command::Into, "Next step")] {
            let button = Button::new((widgets::icon(ui, command.entry().icon), text));
            if ui.add(button).on_hover_text(command.key()).clicked() {
                actions.command(command);
            }
        }
    });
}

/// How many keys stand beside each other.
fn key_columns(ui: &Ui, theme: Theme) -> usize {
    ((ui.available_width() / (KEY_LETTERS * theme.sizes().small)) as usize).clamp(1, KEYS.len() / 2)
}

/// The keys that both windows take.
fn keys(ui: &mut Ui, theme: Theme) {
    let columns = key_columns(ui, theme);
    for row in KEYS.chunks(columns) {
        ui.columns(columns, |cells| {
            for (ui, (command, text)) in cells.iter_mut().zip(row) {
                ui.horizontal(|ui| {
                    widgets::key_cap(ui, &command.key(), theme);
                    ui.add(Label::new(RichText::new(*text).small().weak()).truncate());
                });
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_told_in_minutes() {
        assert_eq!([0, 1, 59, 60, 601].map(clock), ["0 min", "1 min", "59 min", "1 h 00 min", "10 h 01 min"]);
    }

    #[test]
    fn every_key_that_is_told_of_exists() {
        assert!(KEYS.iter().all(|(command, _)| !command.key().is_empty()));
    }
}
