//! The explanation: why the last step happened, in words, in symbols, in numbers and in the algorithm's own lines.

use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{self, Align, Color32, Sense, Stroke, Ui, pos2, vec2};
use motionscope_core::scene::{Fact, Math, Readout, Sentence};
use motionscope_core::{Info, Step};

use super::{ink, math};
use crate::paint::{Chrome, Face, Theme};

/// What is explained.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The estimator.
    pub info: &'a Info,
    /// What the cursor tells.
    pub step: &'a Step,
    /// The look.
    pub theme: Theme,
}

/// The room that each part has needed so far, so that nothing jumps from step to step.
#[derive(Clone, Debug, Default)]
pub struct State {
    key: Option<(&'static str, u32, Theme)>,
    sentence: f32,
    equation: f32,
    facts: f32,
    line: Option<usize>,
}

impl State {
    /// Forgets the room when it was measured for another estimator, width or type size.
    fn keep_for(&mut self, key: (&'static str, u32, Theme)) {
        if self.key != Some(key) {
            // Room for what most steps tell, from the first on.
            let size = key.2.sizes();
            let lines = |count: f32, size: f32| count * (1.45 * size).round();
            *self = State {
                key: Some(key),
                sentence: lines(3.0, size.heading + 2.0),
                facts: lines(4.0, size.body),
                equation: lines(4.0, size.heading),
                line: None,
            };
        }
    }
}

/// Shows the explanation in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) {
    let Input { info, step, theme } = input;
    ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
    state.keep_for((info.id, ui.available_width().round() as u32, theme));
    // The sentence stays in sight, however far the rest is scrolled.
    hold(ui, &mut state.sentence, |ui| sentence(ui, &step.sentence, theme));
    egui::ScrollArea::vertical().id_salt("why").auto_shrink(false).show(ui, |ui| {
        let facts = step.readouts.iter().find_map(|readout| match readout {
            Readout::Facts(facts) => Some(facts.as_slice()),
            _ => None,
        });
        let lines = step.readouts.iter().find_map(|readout| match readout {
            Readout::Equation(lines) => Some(lines.as_slice()),
            _ => None,
        });
        // Before the first step there is neither: no room is kept then.
        if facts.is_some() || lines.is_some() {
            rule(ui, theme);
            hold(ui, &mut state.facts, |ui| table(ui, facts.unwrap_or_default(), theme));
            rule(ui, theme);
            hold(ui, &mut state.equation, |ui| equation(ui, lines.unwrap_or_default(), theme));
        }
        let moved = state.line.replace(step.line) != Some(step.line);
        pseudocode(ui, input, moved);
        citation(ui, info.source, theme);
    });
}

/// A thin line between two parts, so that the room kept for a part is seen to be its own.
fn rule(ui: &mut Ui, theme: Theme) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 1.0), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.min.y, Stroke::new(1.0, ink::color(theme.chrome().line)));
}

/// Shows a part in at least as much height as it ever took.
fn hold(ui: &mut Ui, height: &mut f32, add: impl FnOnce(&mut Ui)) {
    let shown = ui.scope(|ui| {
        ui.set_min_height(*height);
        ui.set_width(ui.available_width());
        add(ui);
    });
    *height = height.max(shown.response.rect.height());
    if *height > 0.0 {
        ui.add_space(8.0);
    }
}

/// A sentence, its role words in a legible shade of the role's colour and underlined in the very colour.
pub fn sentence(ui: &mut Ui, sentence: &Sentence, theme: Theme) {
    let size = theme.sizes().heading + 2.0;
    let mut job = LayoutJob::default();
    job.wrap.max_width = ui.available_width();
    for (words, role) in &sentence.0 {
        let mut format = TextFormat {
            font_id: ink::font(Face::Sans, size),
            color: ink::color(theme.chrome().text),
            line_height: Some((1.45 * size).round()),
            ..Default::default()
        };
        if let Some(role) = *role {
            format.color = ink::color(theme.word(role));
            format.underline = Stroke::new(2.0, ink::color(theme.ink(role).color));
        }
        job.append(words, 0.0, format);
    }
    ui.add(egui::Label::new(job).wrap());
}

fn equation(ui: &mut Ui, lines: &[Math], theme: Theme) {
    let role = |role| ink::color(theme.word(role));
    let style = math::Ink { size_pt: theme.sizes().heading, text: ink::color(theme.chrome().text), role: &role };
    for line in lines {
        math::show(ui, line, &style);
    }
}

/// Labels left, values right.
fn table(ui: &mut Ui, facts: &[Fact], theme: Theme) {
    ui.spacing_mut().item_spacing.y = 0.0;
    for (i, fact) in facts.iter().enumerate() {
        row(ui, fact, i > 0, theme);
    }
}

fn row(ui: &mut Ui, fact: &Fact, ruled: bool, theme: Theme) {
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
    let (rect, response) = ui.allocate_exact_size(vec2(width, down + value.size().y + 8.0), Sense::hover());
    ink::name(&response, || format!("{}: {}", fact.label, fact.value));
    let painter = ui.painter();
    if ruled {
        painter.hline(rect.x_range(), rect.min.y, Stroke::new(1.0, ink::color(line)));
    }
    let top = rect.min.y + 4.0;
    if let Some(role) = fact.role {
        let min = pos2(rect.min.x, top + (label.size().y - ink::SWATCH.y) / 2.0);
        ink::swatch(painter, min, role, theme);
    }
    painter.galley(pos2(rect.min.x + left, top), label, Color32::PLACEHOLDER);
    painter.galley(pos2(rect.max.x, top + down), value, Color32::PLACEHOLDER);
}

/// The algorithm's lines; the current one comes into view when it `moved`.
fn pseudocode(ui: &mut Ui, input: Input<'_>, moved: bool) {
    let Input { info, step, theme } = input;
    let chrome = theme.chrome();
    ui.label(egui::RichText::new(info.name).size(theme.sizes().small).color(ink::color(chrome.dim)));
    egui::Frame::new().fill(ink::color(chrome.raised)).corner_radius(4.0).inner_margin(vec2(0.0, 8.0)).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (i, line) in info.pseudocode.iter().enumerate() {
            let rect = code_line(ui, line, i == step.line, theme);
            if moved && i == step.line {
                ui.scroll_to_rect_animation(rect.expand(8.0), None, egui::style::ScrollAnimation::none());
            }
        }
    });
    ui.add_space(8.0);
}

fn code_line(ui: &mut Ui, line: &str, current: bool, theme: Theme) -> egui::Rect {
    let chrome = theme.chrome();
    let size = theme.sizes().mono;
    let words = line.trim_start();
    let margin = 1.8 * size;
    let indent = (line.len() - words.len()) as f32 * 0.6 * size;
    let color = if current { chrome.text } else { chrome.text.mix(chrome.raised, 0.25) };
    let width = ui.available_width();
    let room = (width - margin - indent - 8.0).max(8.0 * size);
    let job = LayoutJob::simple(words.into(), ink::font(Face::Mono, size), ink::color(color), room);
    let galley = ui.painter().layout_job(job);
    let (rect, response) = ui.allocate_exact_size(vec2(width, galley.size().y + 6.0), Sense::hover());
    ink::name(&response, || format!("{}{words}", if current { "current line: " } else { "" }));
    let painter = ui.painter();
    if current {
        painter.rect_filled(rect, 0.0, ink::color(chrome.selection));
        let y = rect.min.y + 3.0 + galley.rows.first().map_or(size, |row| row.size.y) / 2.0;
        let (x, half) = (rect.min.x + 0.5 * size, 0.36 * size);
        let arrow = vec![pos2(x, y - half), pos2(x + 1.7 * half, y), pos2(x, y + half)];
        painter.add(egui::Shape::convex_polygon(arrow, ink::color(chrome.accent), Stroke::NONE));
    }
    painter.galley(rect.min + vec2(margin + indent, 3.0), galley, Color32::PLACEHOLDER);
    rect
}

fn citation(ui: &mut Ui, source: &str, theme: Theme) {
    let dim = ink::color(theme.chrome().dim);
    ui.add(egui::Label::new(egui::RichText::new(source).size(theme.sizes().small).color(dim)).wrap());
}
