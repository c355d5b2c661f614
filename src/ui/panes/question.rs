//! The pane of a question: its text, the answers with the hands for each, and the way to the result.

use eframe::egui::{self, Button, RichText, TextEdit, TextStyle, Ui, WidgetInfo, vec2};
use lucide_icons::Icon;
use motionscope_core::base::words::capital;
use motionscope_core::run::Cursor;

use crate::paint::Theme;
use crate::ui::commands::{Action, Actions, Command};
use crate::ui::drawing::{ink, style};
use crate::ui::model::predict::{ARROWS, DIRECTIONS, Open, Predict, SAME_PLACE, asks_for_number, asks_for_place};
use crate::ui::panes::status;
use crate::ui::parts::widgets;

/// Largest width of a direction's button, in sizes of the type.
const PAD_LETTERS: f32 = 8.0;

/// What was typed for a number.
#[derive(Clone, Debug, Default)]
pub struct State {
    typed: String,
    /// The question that it was typed for, and its step.
    of: Option<(&'static str, Cursor)>,
    /// Height of all of it, in points, as it was shown last.
    needed: f32,
}

/// The inputs of the pane.
pub struct Input<'a> {
    /// The question that is open, or the last one.
    pub predict: &'a Predict,
    /// Whether several estimators run in lockstep, which has no questions.
    pub is_lockstep: bool,
    /// Whether a pixel is held, of which nothing is asked.
    pub is_held: bool,
    /// The theme.
    pub theme: Theme,
}

/// Draws the question below each other: its text, the ways to answer, and the way to the result.
pub fn show(ui: &mut Ui, input: &Input<'_>, state: &mut State, actions: &mut Actions) {
    let Input { predict, is_lockstep, is_held, theme } = *input;
    let top = ui.cursor().min.y;
    ui.spacing_mut().item_spacing = vec2(8.0, 6.0);
    let room = ui.available_height().max(1.0);
    // In the smallest windows it is scrolled.
    let scroll = egui::ScrollArea::vertical().id_salt("question").auto_shrink(false).max_height(room);
    let shown = scroll.show(ui, |ui| {
        ui.horizontal_top(|ui| {
            let accent = style::color(theme.chrome().accent);
            ui.label(widgets::icon(ui, Icon::CircleQuestionMark).color(accent));
            ui.add(egui::Label::new(RichText::new(title(predict)).family(style::bold())).wrap());
        });
        match (predict.open(), predict.last()) {
            (Some(open), _) => {
                let given: Vec<_> = open.given().iter().map(|of| format!("{}: {}", of.label, of.value)).collect();
                if !given.is_empty() {
                    ui.add(egui::Label::new(ink::scripted(ui, &given.join(" · "), |words| words)).wrap());
                }
                let is_new = state.is_for(open);
                ui.horizontal_wrapped(|ui| ways(ui, open, (theme, state, is_new), actions));
                if asks_for_place(open.question) {
                    let left = top + room - ui.cursor().min.y;
                    directions(ui, open, left, (theme, actions));
                }
            }
            (None, Some(answered)) => outcome(ui, answered, theme),
            (None, None) => {
                let dim = style::color(theme.chrome().dim);
                ui.add(egui::Label::new(RichText::new(idle(is_lockstep, is_held)).color(dim)).wrap());
            }
        }
        ui.horizontal_wrapped(|ui| {
            if predict.open().is_some() {
                reveal(ui, theme, actions);
            }
            tally(ui, predict, theme);
        });
        ui.cursor().min.y
    });
    let needed = (shown.inner + shown.state.clamped_offset().y - top).ceil();
    if std::mem::replace(&mut state.needed, needed) != needed {
        widgets::lay_out_anew(ui.ctx(), "the question needs another height");
    }
}

/// Returns the text of the pane without a question.
fn idle(is_lockstep: bool, is_held: bool) -> String {
    if is_lockstep {
        let key = Command::Lockstep.key();
        return format!("Questions are for one estimator. {key} ends the lockstep.");
    }
    if is_held {
        return "Questions are about the next step, not about a pixel that is held. Esc releases it.".into();
    }
    "→ asks before it shows the next result. Then number keys count hands, and a click on the picture is a guess."
        .into()
}

impl State {
    /// Height of all of it, in points, as it was shown last.
    pub fn needed(&self) -> f32 {
        self.needed
    }

    /// Forgets what was typed for another question; returns whether this one is new.
    fn is_for(&mut self, open: &Open) -> bool {
        let of = Some((open.question.id, open.cursor()));
        let is_new = self.of != of;
        if is_new {
            *self = Self { of, typed: String::new(), ..*self };
        }
        is_new
    }
}

/// The question with the unit that it is about, or what is asked for when there is none.
pub fn title(predict: &Predict) -> String {
    let Some(open) = predict.last() else { return "Predict, then reveal".to_owned() };
    match status::unit(open.asked_of()) {
        Some(unit) => format!("{}: {}", capital(&unit), open.question.text),
        None => open.question.text.to_owned(),
    }
}

/// How many questions the class has answered well, where hands were raised.
fn tally(ui: &mut Ui, predict: &Predict, theme: Theme) {
    let rated: Vec<bool> = predict.scores().iter().filter_map(|score| score.is_right()).collect();
    if !rated.is_empty() {
        let right = rated.iter().filter(|right| **right).count();
        let text = format!("Class right in {right} of {}", rated.len());
        ui.label(RichText::new(text).color(style::color(theme.chrome().dim)));
    }
}

/// The ways to answer.
fn ways(ui: &mut Ui, open: &Open, (theme, state, is_new): (Theme, &mut State, bool), actions: &mut Actions) {
    if asks_for_place(open.question) {
        let clicked = match open.guesses.places.len() {
            0 if open.guesses.hands.is_empty() => "Click the place on the picture.".to_owned(),
            0 => "Click the place, or vote for its direction:".to_owned(),
            1 => "1 guess.".to_owned(),
            guesses => format!("{guesses} guesses."),
        };
        ui.label(clicked);
    } else if asks_for_number(open.question) {
        number(ui, open, (state, is_new), actions);
    } else {
        let choices: Vec<_> = open.question.choices().into_iter().map(|answer| (answer, answer)).collect();
        hands(ui, &choices, open, (theme, actions));
    }
}

/// The directions as they lie on a number pad where that and the way to the result have room in `height`, or else in a row.
fn directions(ui: &mut Ui, open: &Open, height: f32, (theme, actions): (Theme, &mut Actions)) {
    let all: Vec<_> = ARROWS.into_iter().zip(DIRECTIONS).collect();
    let (line, gap) = (ui.spacing().interact_size.y, ui.spacing().item_spacing);
    if open.guesses.hands.is_empty() {
        return;
    }
    if height < 4.0 * (line + gap.y) {
        ui.horizontal_wrapped(|ui| hands(ui, &all, open, (theme, actions)));
        return;
    }
    let size = TextStyle::Body.resolve(ui.style()).size;
    let width = ((ui.available_width() - 2.0 * gap.x) / 3.0).min(PAD_LETTERS * size).floor();
    for row in (0..3).rev() {
        ui.horizontal(|ui| {
            for (index, &(arrow, name)) in all.iter().enumerate().skip(3 * row).take(3) {
                // The middle has no arrow.
                let text = if index == SAME_PLACE { name } else { arrow };
                hand(ui, (index, text, name), open.guesses.hands[index], (theme, Some(width), actions));
            }
        });
    }
}

/// A button for each answer, by its text and its name, with its key and the hands for it.
fn hands(ui: &mut Ui, answers: &[(&str, &str)], open: &Open, (theme, actions): (Theme, &mut Actions)) {
    for (index, ((text, answer), hands)) in answers.iter().zip(&open.guesses.hands).enumerate() {
        hand(ui, (index, text, answer), *hands, (theme, None, actions));
    }
}

/// The button of an answer, with its key and the hands for it; of a `width` if one is given.
fn hand(
    ui: &mut Ui,
    (index, text, answer): (usize, &str, &str),
    hands: usize,
    (theme, width, actions): (Theme, Option<f32>, &mut Actions),
) {
    let (key, chrome) = (index + 1, theme.chrome());
    let counted = if hands > 0 { format!("{key}  {text} · {hands}") } else { format!("{key}  {text}") };
    let line = egui::Stroke::new(1.0, style::color(chrome.line));
    let button = Button::new(counted).fill(style::color(chrome.background)).stroke(line);
    let size = vec2(width.unwrap_or(0.0), ui.spacing().interact_size.y);
    let response = ui.add(button.min_size(size));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{answer}: {hands}")));
    let tip =
        format!("{answer}: count a hand for this answer. Key {key}; with Shift, or by a right click, take one away.");
    let response = response.on_hover_text(tip);
    if response.clicked() {
        actions.ask(Action::Vote(index, true));
    } else if response.secondary_clicked() {
        actions.ask(Action::Vote(index, false));
    }
}

/// A field for a number, and those that were typed. Enter adds one; without one it reveals the result.
fn number(ui: &mut Ui, open: &Open, (state, is_new): (&mut State, bool), actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let field = ui.add(TextEdit::singleline(&mut state.typed).desired_width(6.0 * size).hint_text("number"));
    field.widget_info(|| WidgetInfo::labeled(egui::Role::TextInput, true, "A guess"));
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    // What is typed is a guess, and not the key of a command.
    if is_new || is_entered {
        field.request_focus();
    }
    // With nothing typed, keys and clicker step as they do elsewhere.
    let is_empty = state.typed.trim().is_empty();
    let pressed = |key| is_empty && ui.input(|input| input.key_pressed(key));
    if is_empty && is_entered || pressed(egui::Key::ArrowRight) || pressed(egui::Key::PageDown) {
        actions.ask(Action::Reveal);
    } else if pressed(egui::Key::ArrowLeft) || pressed(egui::Key::PageUp) {
        actions.command(Command::IntoBack);
    }
    let parsed = state.typed.trim().replace(',', ".").replace('\u{2212}', "-").parse::<f64>();
    let parsed = parsed.ok().filter(|number| number.is_finite());
    let is_clicked = ui.add_enabled(parsed.is_some(), Button::new("Add guess")).clicked();
    if let Some(number) = parsed
        && (is_clicked || is_entered)
    {
        actions.ask(Action::Guess(number));
        state.typed.clear();
    }
    let text = |number: &f64| format!("{number} {}", open.unit()).trim_end().replace('-', "\u{2212}");
    let typed: Vec<String> = open.guesses.numbers.iter().map(text).collect();
    ui.label(typed.join("   "));
}

fn reveal(ui: &mut Ui, theme: Theme, actions: &mut Actions) {
    let chrome = theme.chrome();
    let text = RichText::new("Reveal").color(style::color(chrome.on_accent)).family(style::bold());
    let button = ui.add(Button::new(text).fill(style::color(chrome.accent)));
    if button
        .on_hover_text("Show the result. Enter, → and the clicker do the same; ← takes the question back.")
        .clicked()
    {
        actions.command(Command::Into);
    }
}

/// The answer, and how the guesses compare with it.
fn outcome(ui: &mut Ui, open: &Open, theme: Theme) {
    let Some(verdict) = open.verdict() else { return };
    let accent = style::color(theme.chrome().accent);
    ui.add(egui::Label::new(RichText::new(verdict.text()).color(accent).family(style::bold())).wrap());
}
