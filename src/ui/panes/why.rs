//! The explanation: why the last step happened, in words, in symbols, in numbers and in the algorithm's own lines.

use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{self, Align, Color32, Rect, Sense, Stroke, Ui, pos2, vec2};
use motionscope_core::scene::{Fact, Math, Readout, Sentence};
use motionscope_core::{Info, Step, pseudocode as code};

use crate::paint::{Chrome, Face, Theme};
use crate::ui::drawing::ink;
use crate::ui::panes::math;

/// What is explained.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The estimator.
    pub info: &'a Info,
    /// What the cursor tells.
    pub step: &'a Step,
    /// Whether the run is over: then it is told how good the estimate is as well.
    pub at_end: bool,
    /// The look.
    pub theme: Theme,
}

/// How close things stand.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Density {
    /// Between two parts, in points.
    gap: f32,
    /// From one line of the sentence to the next, in sizes of its type.
    leading: f32,
    /// Above and below a row of the table, in points.
    row: f32,
    /// Type of the formula, in points.
    math: f32,
}

/// Heights of the pane, in sizes of its type, below which things stand closer.
const ROOMY: f32 = 30.0;

impl Density {
    /// For a pane of this height.
    fn of(height: f32, theme: Theme) -> Self {
        let sizes = theme.sizes();
        if height < ROOMY * sizes.body {
            Self { gap: 5.0, leading: 1.35, row: 2.5, math: sizes.body }
        } else {
            Self { gap: 8.0, leading: 1.45, row: 4.0, math: sizes.heading }
        }
    }
}

/// The room that each part has needed so far, so that nothing jumps from step to step.
#[derive(Clone, Debug, Default)]
pub struct State {
    key: Option<(&'static str, u32, Theme, Density)>,
    sentence: f32,
    equation: f32,
    facts: f32,
    /// How much of the parts is seen where the line at work is out of sight among them, and so stands below them.
    pinned: Option<f32>,
}

impl State {
    /// Forgets the room when it was measured for another estimator, width, type size or density.
    fn keep_for(&mut self, key: (&'static str, u32, Theme, Density)) {
        if self.key != Some(key) {
            // Room for what most steps tell, from the first on.
            let (_, _, theme, Density { leading, row, math, .. }) = key;
            let size = theme.sizes();
            *self = State {
                key: Some(key),
                sentence: 3.0 * (leading * (size.heading + 2.0)).round(),
                facts: 4.0 * (1.2 * size.body + 2.0 * row).round(),
                equation: 4.0 * (1.45 * math).round(),
                pinned: self.pinned,
            };
        }
    }
}

/// Shows the explanation in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let Input { info, step, theme, .. } = input;
    let density = Density::of(ui.available_height(), theme);
    ui.spacing_mut().item_spacing = vec2(8.0, density.gap);
    state.keep_for((info.id, ui.available_width().round() as u32, theme, density));
    // The sentence stays in sight, however far the rest is scrolled.
    hold(ui, &mut state.sentence, input.at_end, |ui| sentence(ui, &step.sentence, theme, density.leading));
    // Nor does the line at work: it stands at the bottom where it is scrolled out of sight. Nothing scrolls by itself.
    let (room, below) = (ui.available_height(), pinned_height(ui, input));
    let height = state.pinned.unwrap_or(room).clamp(0.0, room.max(0.0));
    let scroll = egui::ScrollArea::vertical().id_salt("why").auto_shrink(false).max_height(height);
    let scrolled = scroll.show(ui, |ui| {
        let facts = step.readouts.iter().find_map(|readout| match readout {
            Readout::Facts(facts) => Some(facts.as_slice()),
            _ => None,
        });
        let lines = step.readouts.iter().find_map(|readout| match readout {
            Readout::Equation(lines) => Some(lines.as_slice()),
            _ => None,
        });
        let mut places = Vec::new();
        // Before the first step there is neither: no room is kept then.
        if facts.is_some() || lines.is_some() {
            // The formula is what is taught: it is seen in a small window as well.
            rule(ui, theme);
            hold(ui, &mut state.equation, input.at_end, |ui| {
                places.extend(equation(ui, lines.unwrap_or_default(), theme, density.math));
            });
            rule(ui, theme);
            hold(ui, &mut state.facts, input.at_end, |ui| {
                places.extend(table(ui, facts.unwrap_or_default(), theme, density.row));
            });
        }
        let (name, code) = pseudocode(ui, input);
        let at_work = info.line(step.line).and_then(|line| code.get(line).copied());
        places.push(name);
        // Nothing is seen of the box around them where nothing is seen of the first.
        places.extend(code.first().map(|line| line.with_min_y(line.min.y - BOX)));
        places.extend(code);
        places.extend(citation(ui, info.source, theme));
        (at_work, places)
    });
    if state.pinned.is_some() {
        ui.add_space((room - below - height).max(0.0));
        pinned(ui, input);
    }
    let top = scrolled.inner_rect.min.y;
    let overflows = scrolled.content_size.y > room;
    let is_in_sight = |line: &Rect| line.center().y >= top && line.max.y <= top + room - below;
    let (at_work, places) = scrolled.inner;
    // It would stand there twice where it is half in sight.
    let seen = |_| whole(&places, top, top + room - below) - top;
    let is_pinned = at_work.filter(|line| overflows && !is_in_sight(line)).map(seen);
    if std::mem::replace(&mut state.pinned, is_pinned) != is_pinned {
        ui.ctx().request_discard("the line at work came into sight, or went out of it");
    }
}

/// Where lines that may be seen from `top` down to `end` have to end so that none of them is cut.
fn whole(lines: &[Rect], top: f32, end: f32) -> f32 {
    let cut = lines.iter().filter(|line| (top..end).contains(&line.min.y) && line.max.y - CODE_MARGIN > end);
    cut.map(|line| line.min.y).fold(end, f32::min)
}

/// A thin line between two parts, so that the room kept for a part is seen to be its own.
fn rule(ui: &mut Ui, theme: Theme) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 1.0), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.min.y, Stroke::new(1.0, ink::color(theme.chrome().line)));
}

/// Shows a part in at least as much height as it ever took; but at the end of a run, where more is told, in just its own.
fn hold(ui: &mut Ui, height: &mut f32, at_end: bool, add: impl FnOnce(&mut Ui)) {
    let least = if at_end { 0.0 } else { *height };
    let shown = ui.scope(|ui| {
        ui.set_min_height(least);
        ui.set_width(ui.available_width());
        add(ui);
    });
    let taken = shown.response.rect.height();
    if !at_end {
        *height = height.max(taken);
    }
    if taken > 0.0 {
        ui.add_space(ui.spacing().item_spacing.y);
    }
}

/// A sentence, its role words in a legible shade of the role's colour and underlined in the very colour.
fn sentence(ui: &mut Ui, sentence: &Sentence, theme: Theme, leading: f32) {
    let size = theme.sizes().heading + 2.0;
    let mut job = LayoutJob::default();
    job.wrap.max_width = ui.available_width();
    for (words, role) in &sentence.0 {
        let mut format = TextFormat {
            font_id: ink::font(Face::Sans, size),
            color: ink::color(theme.chrome().text),
            line_height: Some((leading * size).round()),
            ..Default::default()
        };
        if let Some(role) = *role {
            format.color = ink::color(theme.word(role));
            format.underline = Stroke::new(2.0, ink::color(theme.ink(role).color));
        }
        job.append(words, 0.0, format);
    }
    let label = ui.add(egui::Label::new(job).wrap());
    label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, sentence.plain()));
}

/// Formulas below each other; gives where each is.
fn equation(ui: &mut Ui, lines: &[Math], theme: Theme, size_pt: f32) -> Vec<Rect> {
    let role = |role| ink::color(theme.word(role));
    let style = math::Ink { size_pt, text: ink::color(theme.chrome().text), role: &role };
    lines.iter().map(|line| ui.scope(|ui| math::show(ui, line, &style)).response.rect).collect()
}

/// Labels left, values right; gives where each row is.
fn table(ui: &mut Ui, facts: &[Fact], theme: Theme, margin: f32) -> Vec<Rect> {
    ui.spacing_mut().item_spacing.y = 0.0;
    facts.iter().enumerate().map(|(i, fact)| row(ui, fact, (i > 0, margin), theme)).collect()
}

/// A row with its `margin` above and below, under a line where it is `ruled`.
fn row(ui: &mut Ui, fact: &Fact, (ruled, margin): (bool, f32), theme: Theme) -> Rect {
    let Chrome { text, dim, line, .. } = theme.chrome();
    let (size, width) = (theme.sizes().body, ui.available_width());
    let label = ui.painter().layout_no_wrap(fact.label.into(), ink::font(Face::Sans, size), ink::color(dim));
    let left = ink::SWATCH.x + 8.0;
    let font = ink::font(Face::Sans, size);
    let mut job = LayoutJob::simple(fact.value.clone(), font, ink::color(text), width - left);
    job.halign = Align::RIGHT;
    let value = ui.painter().layout_job(job);
    // A long value stands under its label.
    let beside = left + label.size().x + 12.0 + value.size().x <= width;
    let down = if beside { 0.0 } else { label.size().y };
    let (rect, response) = ui.allocate_exact_size(vec2(width, down + value.size().y + 2.0 * margin), Sense::hover());
    ink::name(&response, || format!("{}: {}", fact.label, fact.value));
    let painter = ui.painter();
    if ruled {
        painter.hline(rect.x_range(), rect.min.y, Stroke::new(1.0, ink::color(line)));
    }
    let top = rect.min.y + margin;
    if let Some(role) = fact.role {
        let min = pos2(rect.min.x, top + (label.size().y - ink::SWATCH.y) / 2.0);
        ink::swatch(painter, min, role, theme);
    }
    painter.galley(pos2(rect.min.x + left, top), label, Color32::PLACEHOLDER);
    painter.galley(pos2(rect.max.x, top + down), value, Color32::PLACEHOLDER);
    rect
}

/// The algorithm's name and its lines; gives where they are.
fn pseudocode(ui: &mut Ui, input: Input<'_>) -> (Rect, Vec<Rect>) {
    let Input { info, step, theme, .. } = input;
    let chrome = theme.chrome();
    let name = ui.label(egui::RichText::new(info.name).size(theme.sizes().small).color(ink::color(chrome.dim)));
    let frame = egui::Frame::new().fill(ink::color(chrome.raised)).corner_radius(4.0).inner_margin(vec2(0.0, BOX));
    let shown = frame.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let at_work = info.line(step.line);
        let around: Vec<usize> = at_work.into_iter().flat_map(|line| code::around(info.pseudocode, line)).collect();
        let light = |line: usize| match line {
            line if at_work == Some(line) => Light::AtWork,
            line if around.contains(&line) => Light::Around,
            _ => Light::Other,
        };
        let lines = info.pseudocode.iter().enumerate();
        lines.map(|(i, line)| code_line(ui, line.text, light(i), theme)).collect()
    });
    ui.add_space(8.0);
    (name.rect, shown.inner)
}

/// The line at work alone.
fn pinned(ui: &mut Ui, input: Input<'_>) {
    let Input { info, step, theme, .. } = input;
    if let Some(line) = info.line(step.line) {
        code_line(ui, info.pseudocode[line].text.trim_start(), Light::AtWork, theme);
    }
}

/// Room for any line at work, so that nothing jumps from line to line.
fn pinned_height(ui: &Ui, input: Input<'_>) -> f32 {
    let height = |line: &code::Line| code_galley(ui, line.text.trim_start(), Light::AtWork, input.theme).size().y;
    let most = input.info.pseudocode.iter().map(height).fold(0.0, f32::max);
    most + 2.0 * CODE_MARGIN + ui.spacing().item_spacing.y
}

/// How a line of code stands to the step.
#[derive(Clone, Copy, PartialEq)]
enum Light {
    /// The step is at it.
    AtWork,
    /// It is the head of a loop or a condition that the step is in.
    Around,
    /// Neither.
    Other,
}

/// Above and below all of them.
const BOX: f32 = 8.0;

/// Above and below a line of code.
const CODE_MARGIN: f32 = 3.0;

/// How far a line of code is from the left: its arrow, and its indent.
fn code_indent(line: &str, theme: Theme) -> f32 {
    let size = theme.sizes().mono;
    1.8 * size + (line.len() - line.trim_start().len()) as f32 * 0.6 * size
}

fn code_galley(ui: &Ui, line: &str, light: Light, theme: Theme) -> std::sync::Arc<egui::Galley> {
    let chrome = theme.chrome();
    let size = theme.sizes().mono;
    let color = if light == Light::Other { chrome.text.mix(chrome.raised, 0.25) } else { chrome.text };
    let room = (ui.available_width() - code_indent(line, theme) - 8.0).max(8.0 * size);
    let font = ink::font(Face::Mono, size);
    ui.painter().layout_job(LayoutJob::simple(line.trim_start().into(), font, ink::color(color), room))
}

fn code_line(ui: &mut Ui, line: &str, light: Light, theme: Theme) -> Rect {
    let (chrome, current) = (theme.chrome(), light == Light::AtWork);
    let galley = code_galley(ui, line, light, theme);
    let room = vec2(ui.available_width(), galley.size().y + 2.0 * CODE_MARGIN);
    let (rect, response) = ui.allocate_exact_size(room, Sense::hover());
    ink::name(&response, || format!("{}{}", if current { "current line: " } else { "" }, line.trim_start()));
    let painter = ui.painter();
    if current {
        let size = theme.sizes().mono;
        painter.rect_filled(rect, 0.0, ink::color(chrome.selection));
        let y = rect.min.y + CODE_MARGIN + galley.rows.first().map_or(size, |row| row.size.y) / 2.0;
        let (x, half) = (rect.min.x + 0.5 * size, 0.36 * size);
        let arrow = vec![pos2(x, y - half), pos2(x + 1.7 * half, y), pos2(x, y + half)];
        painter.add(egui::Shape::convex_polygon(arrow, ink::color(chrome.accent), Stroke::NONE));
    }
    painter.galley(rect.min + vec2(code_indent(line, theme), CODE_MARGIN), galley, Color32::PLACEHOLDER);
    rect
}

/// Where the algorithm is from; gives where each line of it is.
fn citation(ui: &mut Ui, source: &str, theme: Theme) -> Vec<Rect> {
    let (dim, font) = (ink::color(theme.chrome().dim), ink::font(Face::Sans, theme.sizes().small));
    let galley = ui.painter().layout(source.into(), font, dim, ui.available_width());
    let (rect, response) = ui.allocate_exact_size(galley.size(), Sense::hover());
    ink::name(&response, || source.into());
    let lines = galley.rows.iter().map(|row| row.rect().translate(rect.min.to_vec2())).collect();
    ui.painter().galley(rect.min, galley, Color32::PLACEHOLDER);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_is_cut_where_others_end() {
        let line = |from: f32, to: f32| Rect::from_min_max(pos2(0.0, from), pos2(100.0, to));
        let lines = [line(-5.0, 15.0), line(15.0, 35.0), line(35.0, 55.0), line(60.0, 80.0)];
        assert_eq!([20.0, 33.0, 50.0, 57.0, 90.0].map(|end| whole(&lines, 0.0, end)), [15.0, 33.0, 35.0, 57.0, 90.0]);
        // One that is taller than all there is room for, and is scrolled out at the top, stays.
        assert_eq!(whole(&[line(-10.0, 90.0)], 0.0, 50.0), 50.0);
    }
}
