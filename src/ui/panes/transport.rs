//! The ladder, play and the timeline: everything that moves the run.

use eframe::egui::{
    self, Align2, Button, ComboBox, FontId, Rect, Response, Sense, Stroke, TextStyle, Ui, WidgetInfo, vec2,
};
use lucide_icons::Icon;
use motionscope_core::run::Direction;

use crate::paint::Theme;
use crate::ui::commands::{Action, Actions, Command, Granularities, Situation};
use crate::ui::drawing::style;
use crate::ui::layout;
use crate::ui::model::player::{Player, SPEEDS};
use crate::ui::model::snapshot::Snapshot;
use crate::ui::panes::timeline;
use crate::ui::parts::widgets;

/// What the transport shows.
pub struct Input<'a> {
    /// The run, if there is one.
    pub shown: Option<&'a Snapshot>,
    /// What can be done just now.
    pub now: Situation,
    /// The names of the ladder.
    pub granularities: Granularities,
    /// Play and its speed.
    pub player: Player,
    /// Whether it is told how to step.
    pub has_hint: bool,
    /// The look.
    pub theme: Theme,
}

/// Width per point of type size below which the ladder's names are left out.
const ROOMY: f32 = 72.0;

/// Draws the transport into the whole width of `ui`.
pub fn show(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    if widgets::is_upright(ui.ctx()) {
        return upright(ui, input, actions);
    }
    let named = ui.available_width() / size > ROOMY;
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let listed = |command: &Command| command.is_listed(&input.granularities);
        let back = [Command::Start, Command::OutBack, Command::OverBack, Command::IntoBack];
        for command in back.into_iter().filter(listed) {
            step(ui, command, named, input, actions);
        }
        ui.add_space(4.0);
        play_back(ui, input, actions);
        play(ui, input, actions);
        ui.add_space(4.0);
        for command in [Command::Into, Command::Over, Command::Out, Command::End].into_iter().filter(listed) {
            step(ui, command, named, input, actions);
        }
        ui.add_space(8.0);
        speed(ui, input, actions);
        ui.add_space(12.0);
        let rect = ui.available_rect_before_wrap();
        let rect = if input.has_hint && input.shown.is_some() { hint(ui, rect, input.theme) } else { rect };
        timeline(ui, rect, input, actions);
    });
}

/// Rows of the transport in a window of `size` with type of `type_pt`.
pub fn rows(size: egui::Vec2, type_pt: f32) -> f32 {
    if layout::is_upright(size, type_pt) { 2.0 } else { 1.0 }
}

/// Draws the timeline above the steps, which are large enough for a thumb.
fn upright(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let (above, below) = ui.available_rect_before_wrap().split_top_bottom_at_fraction(0.5);
    timeline(ui, above.shrink2(vec2(4.0, 0.0)), input, actions);
    let mut below = widgets::inside(ui, below, egui::Layout::left_to_right(egui::Align::Center));
    below.spacing_mut().item_spacing.x = 0.0;
    use Command as C;
    let all = [C::OutBack, C::OverBack, C::IntoBack, C::Play, C::Into, C::Over, C::Out];
    let all: Vec<Command> = all.into_iter().filter(|command| command.is_listed(&input.granularities)).collect();
    let each = below.available_width() / all.len() as f32;
    for command in all {
        let cell = vec2(each, below.available_height());
        below.allocate_ui_with_layout(cell, egui::Layout::centered_and_justified(egui::Direction::LeftToRight), |ui| {
            match command {
                Command::Play => play(ui, input, actions),
                _ => step(ui, command, false, input, actions),
            }
        });
    }
}

fn timeline(ui: &mut Ui, rect: Rect, input: &Input, actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    if let (Some(shown), true) = (input.shown, rect.width() > 120.0) {
        let rect = Rect::from_center_size(rect.center(), vec2(rect.width(), rect.height().min(3.6 * size)));
        if let Some(cursor) = timeline::show(ui, rect, (shown, input.now.asks), input.theme) {
            actions.ask(Action::Seek(cursor));
        }
        ui.allocate_rect(rect, Sense::hover());
    }
}

/// Letters across that the timeline keeps beside the hint.
const TIMELINE_LETTERS: f32 = 16.0;

/// Tells at the right end of `rect` how to step; returns what is left of it for the timeline, nothing where it is narrow.
fn hint(ui: &mut Ui, rect: Rect, theme: Theme) -> Rect {
    let size = TextStyle::Small.resolve(ui.style()).size;
    let mut inside = widgets::inside(ui, rect, egui::Layout::right_to_left(egui::Align::Center));
    inside.spacing_mut().item_spacing.x = 0.35 * size;
    let said = [(Command::Play, "plays"), (Command::IntoBack, "back"), (Command::Into, "forward")];
    for (index, (command, word)) in said.into_iter().enumerate() {
        if index > 0 {
            inside.add_space(0.7 * size);
        }
        inside.add(egui::Label::new(egui::RichText::new(word).small().weak()).selectable(false));
        widgets::key_cap(&mut inside, &command.key(), theme);
    }
    let accent = style::color(theme.chrome().accent);
    inside
        .label(widgets::icon(&inside, Icon::Lightbulb).color(accent))
        .on_hover_text("Goes away once you have stepped.");
    let end = inside.min_rect().min.x - size;
    let left = rect.with_max_x(end.max(rect.min.x));
    if left.width() < TIMELINE_LETTERS * size { rect.with_max_x(rect.min.x) } else { left }
}

/// A tooltip for a command: what it does, and its key.
pub fn tooltip(response: Response, command: Command, granularities: &Granularities) -> Response {
    response.on_hover_text(command.with_key(&command.tip(granularities)))
}

/// What a command of the ladder is called on its button: the granularity that it moves on, or where it leads.
fn button_name(command: Command, granularities: &Granularities) -> Option<String> {
    use Command as C;
    match command {
        C::Into | C::IntoBack => Some(granularities.name(granularities.event()).to_owned()),
        C::Over | C::OverBack => Some(granularities.name(granularities.unit()).to_owned()),
        C::Out => Some(format!("{} end", granularities.outer())),
        C::OutBack => Some(format!("{} start", granularities.outer())),
        _ => None,
    }
}

fn step(ui: &mut Ui, command: Command, named: bool, input: &Input, actions: &mut Actions) {
    let glyph = widgets::icon(ui, command.entry().icon);
    let name = button_name(command, &input.granularities).filter(|_| named);
    let back = matches!(command, Command::IntoBack | Command::OverBack | Command::OutBack | Command::Start);
    let height = ui.spacing().interact_size.y * 1.25;
    let button = match (name, back) {
        (Some(name), true) => Button::new((glyph, name)),
        (Some(name), false) => Button::new((name, glyph)),
        (None, _) => Button::new(glyph),
    };
    let button = button.frame_when_inactive(false).gap(4.0).min_size(vec2(height, height));
    let enabled = command.enabled(&input.now);
    let response = ui.add_enabled(enabled, button);
    let text = command.text(&input.granularities);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, &text));
    if tooltip(response, command, &input.granularities).clicked() {
        actions.command(command);
    }
}

fn play(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let playing = input.player.plays(Direction::Forward);
    let chrome = input.theme.chrome();
    let side = (ui.spacing().interact_size.y * 1.35).round();
    let enabled = Command::Play.enabled(&input.now);
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), sense);
    let text = if playing { "Pause" } else { "Play" };
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, text));
    let lit = if response.hovered() { chrome.accent.mix(chrome.text, 0.2) } else { chrome.accent };
    let (fill, ink) = if enabled { (lit, chrome.on_accent) } else { (chrome.raised, chrome.dim) };
    ui.painter().circle_filled(rect.center(), side / 2.0, style::color(fill));
    let glyph = if playing { Icon::Pause } else { Icon::Play };
    let font = FontId::new((side * 0.48).round(), style::icons());
    // The triangle's weight lies left of its middle.
    let at = rect.center() + vec2(if playing { 0.0 } else { side * 0.03 }, 0.0);
    ui.painter().text(at, Align2::CENTER_CENTER, char::from(glyph), font, style::color(ink));
    if tooltip(response, Command::Play, &input.granularities).clicked() {
        actions.command(Command::Play);
    }
}

/// The triangle that points back, or the bars of a pause while it plays backwards.
fn play_back(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let playing = input.player.plays(Direction::Back);
    let side = (ui.spacing().interact_size.y * 1.25).round();
    let enabled = Command::PlayBack.enabled(&input.now);
    let (rect, response) =
        ui.allocate_exact_size(vec2(side, side), if enabled { Sense::click() } else { Sense::hover() });
    let text = if playing { "Pause" } else { "Play backwards" };
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, text));
    let chrome = input.theme.chrome();
    let ink = match (enabled, response.hovered() || playing) {
        (false, _) => chrome.line,
        (true, false) => chrome.dim,
        (true, true) => chrome.accent,
    };
    if playing {
        let font = FontId::new((side * 0.6).round(), style::icons());
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, char::from(Icon::Pause), font, style::color(ink));
    } else {
        let corner = |x: f32, y: f32| rect.center() + vec2(x, y) * side;
        let corners = vec![corner(-0.24, 0.0), corner(0.18, -0.24), corner(0.18, 0.24)];
        ui.painter().add(egui::Shape::convex_polygon(corners, style::color(ink), Stroke::NONE));
    }
    if tooltip(response, Command::PlayBack, &input.granularities).clicked() {
        actions.command(Command::PlayBack);
    }
}

fn speed(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let names = input.granularities.names();
    let size = TextStyle::Body.resolve(ui.style()).size;
    let chosen = input.player.speed(names.len()).text(names);
    let combo = ComboBox::from_id_salt("speed").selected_text(&chosen).width(8.5 * size);
    let shown = combo.show_ui(ui, |ui| {
        for (index, speed) in SPEEDS.iter().enumerate().filter(|(_, speed)| speed.is_of(names.len())) {
            if ui.selectable_label(*speed == input.player.speed(names.len()), speed.text(names)).clicked() {
                actions.ask(Action::Speed(index));
            }
        }
    });
    let name = format!("Speed: {chosen}");
    shown.response.widget_info(|| WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
    let (slower, faster) = (Command::Slower.key(), Command::Faster.key());
    shown.response.on_hover_text(format!("How fast to play. {slower} is slower, {faster} is faster."));
}
