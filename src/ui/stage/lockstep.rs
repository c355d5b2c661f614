//! Several estimators on the stage: a tile for each, and above all what they have in common.

use eframe::egui::text::{LayoutJob, TextFormat, TextWrapping};
use eframe::egui::{self, CursorIcon, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};
use lucide_icons::Icon;
use motionscope_core::scene::Sentence;
use motionscope_core::{Pace, lockstep};

use super::{Input, Lens, Response, bar};
use crate::experiment::Experiment;
use crate::paint::{Face, Theme, brevity};
use crate::ui::app::commands::Command;
use crate::ui::drawing::{ink, style};
use crate::ui::parts::widgets;
use crate::view::tile::Tile;

/// Between two tiles, in points.
const GAP: f32 = 12.0;

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
    let list = egui::ComboBox::from_id_salt("pace").selected_text(lockstep.pace().label());
    list.show_ui(ui, |ui| paces(ui, lockstep, response)).response.accessible_name("In lockstep by");
    let tip = Command::Lockstep.with_key(LEAVE);
    response.left |= widgets::cross(ui, "Leave lockstep").on_hover_text(tip).clicked();
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
    6.0 + name_height(theme) + bar::line_height(theme)
}

fn name_height(theme: Theme) -> f32 {
    (1.5 * theme.sizes().body).round()
}

/// Divides `area` among `count` pictures of `size`, in as many columns as show them largest.
pub fn split(area: Rect, count: usize, size: (usize, usize), header: f32) -> Vec<Rect> {
    let room = |columns: usize| {
        let rows = count.div_ceil(columns);
        let gaps = GAP * vec2((columns - 1) as f32, (rows - 1) as f32);
        (area.size() - gaps) / vec2(columns as f32, rows as f32)
    };
    let head = vec2(0.0, header);
    let fit = |columns: usize| ((room(columns) - head) / vec2(size.0 as f32, size.1 as f32)).min_elem();
    // Of two that show them as large, the one with fewer columns: two by two.
    let columns = (1..=count).rev().max_by(|a, b| fit(*a).total_cmp(&fit(*b))).unwrap_or(1);
    let (tile, picture) = (room(columns), (room(columns) - head).max(Vec2::splat(1.0)));
    let corner = |i: usize| vec2((i % columns) as f32, (i / columns) as f32) * (tile + Vec2::splat(GAP));
    (0..count).map(|i| Rect::from_min_size(area.min + head + corner(i), picture)).collect()
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
        Stroke::new(2.0, ink::color(chrome.accent))
    } else {
        Stroke::new(1.0, ink::color(chrome.line))
    };
    painter.hline(picture.x_range(), rect.min.y + 1.0, line);
    let middle = rect.min.y + 4.0 + name_height(theme) / 2.0;
    let dim = ink::color(chrome.dim);
    let lay_out = |words: &str, font| painter.layout_no_wrap(words.into(), font, dim);
    let bold = |share: f32| ink::font(Face::Bold, share * sizes.body);
    let long = lay_out("done", ink::font(Face::Sans, sizes.small));
    let shown = tile.name(|name| lay_out(name, bold(SHARES[1])).size().x + 8.0 <= rect.width());
    let fits = |share: f32, done: f32| lay_out(shown, bold(share)).size().x + 8.0 + done <= rect.width();
    // Where a tile is narrow, its name is smaller, and a sign stands for the word.
    let is_narrow = !fits(1.0, long.size().x);
    let check = || lay_out(&char::from(Icon::Check).to_string(), egui::FontId::new(sizes.small, style::icons()));
    let done = if is_narrow { check() } else { long };
    let room = rect.width() - if tile.is_done { 8.0 + done.size().x } else { 0.0 };
    let share = if is_narrow { SHARES.into_iter().find(|share| fits(*share, done.size().x)) } else { Some(1.0) };
    let font = bold(share.unwrap_or(SHARES[SHARES.len() - 1]));
    let name = ink::Words { text: shown, font, color: ink::color(chrome.text) };
    let end = ink::line(&painter, pos2(rect.min.x, middle), name, room);
    if tile.is_done {
        painter.galley(pos2(end + 8.0, middle - done.size().y / 2.0), done, dim);
    }
    let lay_out = |words: &Sentence, width: f32| painter.layout_job(job(words, width, theme));
    let all = lockstep.tiles.iter().map(|tile| &tile.words[..]);
    let way = brevity(all, |words| lay_out(words, f32::INFINITY).size().x <= rect.width());
    if let Some(words) = tile.words.get(way).or(tile.words.last()).map(|words| lay_out(words, rect.width())) {
        let top = rect.min.y + 4.0 + name_height(theme);
        painter.galley(pos2(rect.min.x, top), words, ink::color(chrome.text));
    }
}

/// One line of words, cut short with … at `width` points.
fn job(words: &Sentence, width: f32, theme: Theme) -> LayoutJob {
    let mut job = LayoutJob { wrap: TextWrapping::truncate_at_width(width), ..LayoutJob::default() };
    for (words, role) in &words.0 {
        let color = role.map_or(theme.chrome().dim, |role| theme.word(role));
        let font_id = ink::font(Face::Sans, theme.sizes().small);
        job.append(words, 0.0, TextFormat { font_id, color: ink::color(color), ..TextFormat::default() });
    }
    job
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Pos2;

    #[test]
    fn tiles_lie_beside_each_other_and_leave_none_out() {
        for (width, height) in [(1200.0, 500.0), (400.0, 900.0), (640.0, 480.0)] {
            let area = Rect::from_min_size(pos2(10.0, 20.0), vec2(width, height));
            for count in 2..=4 {
                let panes = split(area, count, (640, 480), 40.0);
                assert_eq!(panes.len(), count);
                for (i, pane) in panes.iter().enumerate() {
                    assert!(area.expand(0.01).contains_rect(*pane), "{pane:?} in {area:?}");
                    assert!(panes[..i].iter().all(|other| !other.intersects(*pane)));
                }
            }
        }
        let square = Rect::from_min_size(Pos2::ZERO, vec2(900.0, 700.0));
        let four = split(square, 4, (640, 480), 40.0);
        assert!(four[0].min.x == four[2].min.x && four[0].min.y == four[1].min.y, "two by two");
    }
}
