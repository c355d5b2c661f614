//! Several estimators on the stage: a tile for each, and above all what they have in common.

use eframe::egui::text::{LayoutJob, TextFormat, TextWrapping};
use eframe::egui::{self, CursorIcon, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use lucide_icons::Icon;
use motionscope_core::run::{Pace, lockstep};
use motionscope_core::scene::Sentence;

use super::{Input, Lens, Response};
use crate::experiment::Experiment;
use crate::paint::{Face, Theme, brevity};
use crate::ui::commands::Command;
use crate::ui::drawing::{ink, style};
use crate::ui::parts::widgets;
use crate::view::tile::Tile;

/// Sizes of a name that are tried in a narrow tile, as shares of the usual one.
const SHARES: [f32; 3] = [1.0, 0.88, 0.76];

/// Several estimators.
#[derive(Clone, Copy)]
pub struct Lockstep<'a> {
    /// Each of them, from left to right.
    pub tiles: &'a [Tile],
    /// Which of them is explained.
    pub explained: usize,
    /// What is run.
    pub experiment: &'a Experiment,
}

impl Lockstep<'_> {
    fn pace(&self) -> Pace {
        self.experiment.side_by_side.pace
    }
}

/// What all have in common, and the way out, as a list and a button.
pub fn choice(ui: &mut Ui, lockstep: &Lockstep<'_>, response: &mut Response) {
    let tip = Command::Lockstep.with_key(LEAVE);
    response.left |= widgets::cross(ui, "Leave lockstep").on_hover_text(tip).clicked();
    let list = egui::ComboBox::from_id_salt("pace").selected_text(lockstep.pace().label());
    list.show_ui(ui, |ui| paces(ui, lockstep, response)).response.accessible_name("In lockstep by");
}

/// The same as items of a menu.
pub fn items(ui: &mut Ui, lockstep: &Lockstep<'_>, response: &mut Response) {
    ui.weak("In lockstep");
    paces(ui, lockstep, response);
    let tip = Command::Lockstep.with_key(LEAVE);
    response.left |= ui.button("Leave lockstep").on_hover_text(tip).clicked();
}

const LEAVE: &str = "Go on with the first estimator alone.";

fn paces(ui: &mut Ui, several: &Lockstep<'_>, response: &mut Response) {
    let Experiment { estimator, side_by_side, .. } = several.experiment;
    for pace in lockstep::paces(&side_by_side.all(&**estimator)) {
        if ui.selectable_label(several.pace() == pace, pace.label()).on_hover_text(pace.sentence()).clicked() {
            response.paced = Some(pace);
        }
    }
}

/// Height of what stands above a picture.
pub fn header(theme: Theme) -> f32 {
    6.0 + name_height(theme) + style::line_height(theme)
}

fn name_height(theme: Theme) -> f32 {
    (1.5 * theme.sizes().body).round()
}

/// What stands above the picture that `lens` shows: the estimator, whether it waits, and what it has come to. A click has it
/// explained.
pub fn heading(ui: &Ui, input: &Input<'_>, index: usize, lens: &Lens, response: &mut Response) {
    let Some((tile, lockstep)) = input.lockstep.and_then(|all| Some((all.tiles.get(index)?, all))) else { return };
    let theme = input.theme();
    let (chrome, sizes) = (theme.chrome(), theme.sizes());
    let height = header(theme);
    let picture = lens.picture_rect().intersect(lens.pane);
    // Words may be wider than a small picture.
    let rect = Rect::from_min_max(picture.min - vec2(0.0, height), pos2(lens.pane.max.x, picture.min.y));
    let sensed = ui.interact(rect, ui.scope_id().with(("heading", index)), Sense::click());
    let sensed = sensed.on_hover_cursor(CursorIcon::PointingHand);
    let is_explained = lockstep.explained == index;
    let waits = if tile.is_done { ", done" } else { "" };
    sensed.widget_info(|| {
        let words = tile.words.first().map_or_else(String::new, Sentence::plain);
        WidgetInfo::selected(egui::Role::Button, true, is_explained, format!("{}: {words}{waits}", tile.names[0]))
    });
    if sensed.clicked() {
        response.explained = Some(index);
    }
    let painter = ui.painter_at(rect);
    let line = if is_explained {
        Stroke::new(2.0, style::color(chrome.accent))
    } else {
        Stroke::new(1.0, style::color(chrome.line))
    };
    painter.hline(picture.x_range(), rect.min.y + 1.0, line);
    let middle = rect.min.y + 4.0 + name_height(theme) / 2.0;
    let dim = style::color(chrome.dim);
    let lay_out = |words: &str, font| painter.layout_no_wrap(words.into(), font, dim);
    let bold = |share: f32| style::font(Face::Bold, share * sizes.body);
    let long = lay_out("done", style::font(Face::Sans, sizes.small));
    let shown = tile.name(|name| lay_out(name, bold(SHARES[1])).size().x + 8.0 <= rect.width());
    let fits = |share: f32, done: f32| lay_out(shown, bold(share)).size().x + 8.0 + done <= rect.width();
    // Where a tile is narrow, its name is smaller, and a sign stands for the word.
    let is_narrow = !fits(1.0, long.size().x);
    let check = || lay_out(&char::from(Icon::Check).to_string(), egui::FontId::new(sizes.small, style::icons()));
    let done = if is_narrow { check() } else { long };
    let room = rect.width() - if tile.is_done { 8.0 + done.size().x } else { 0.0 };
    let share = if is_narrow { SHARES.into_iter().find(|share| fits(*share, done.size().x)) } else { Some(1.0) };
    let font = bold(share.unwrap_or(SHARES[SHARES.len() - 1]));
    let name = ink::Words { text: shown, font, color: style::color(chrome.text) };
    let end = ink::line(&painter, pos2(rect.min.x, middle), name, room);
    if tile.is_done {
        painter.galley(pos2(end + 8.0, middle - done.size().y / 2.0), done, dim);
    }
    let lay_out = |words: &Sentence, width: f32| painter.layout_job(job(words, width, theme));
    let all = lockstep.tiles.iter().map(|tile| &tile.words[..]);
    let way = brevity(all, |words| lay_out(words, f32::INFINITY).size().x <= rect.width());
    if let Some(words) = tile.words.get(way).or(tile.words.last()).map(|words| lay_out(words, rect.width())) {
        let top = rect.min.y + 4.0 + name_height(theme);
        painter.galley(pos2(rect.min.x, top), words, style::color(chrome.text));
    }
}

/// One line of words, cut short with … at `width` points.
fn job(words: &Sentence, width: f32, theme: Theme) -> LayoutJob {
    let mut job = LayoutJob { wrap: TextWrapping::truncate_at_width(width), ..LayoutJob::default() };
    for (words, role) in words.words() {
        let color = role.map_or(theme.chrome().dim, |role| theme.word(role));
        let font_id = style::font(Face::Sans, theme.sizes().small);
        job.append(&words, 0.0, TextFormat { font_id, color: style::color(color), ..TextFormat::default() });
    }
    job
}
