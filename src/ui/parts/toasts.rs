//! Short messages that come and go: what was written and where, what could not be done. They lie over the window; only the description of
//! an example has a line of its own, because it stays: a failure is seen at the end of a run.

use eframe::egui::{self, Align2, Area, Frame, Id, Order, Panel, RichText, TextStyle, Ui};
use lucide_icons::Icon;

use super::widgets;
use crate::paint::Theme;
use crate::ui::drawing::style;

/// How long a message stays at least, in seconds; errors stay longer.
const STAY_SECS: f64 = 6.0;
/// How long a letter takes to be read.
const LETTER_SECS: f64 = 0.07;

/// Width of a message in sizes of its type, at most and at least.
const WIDTH_LETTERS: f32 = 32.0;
const LEAST_LETTERS: f32 = 12.0;
/// Space around its words and their frame, in points on both sides together.
const PADDING: f32 = 26.0;

/// One message.
struct Toast {
    text: String,
    kind: Kind,
    /// Whether it only introduces a part of the window.
    is_introduction: bool,
    /// When it goes; unknown until it was shown first, and never of a description.
    until: Option<f64>,
}

impl Toast {
    /// Shows the message; gives whether it was closed.
    fn show(&self, ui: &mut Ui, theme: Theme) -> bool {
        let chrome = theme.chrome();
        let (glyph, ink) = match self.kind {
            Kind::Error => (Icon::TriangleAlert, chrome.error),
            Kind::Hint | Kind::Description => (Icon::Lightbulb, chrome.accent),
            Kind::Done => (Icon::CircleCheck, chrome.accent),
        };
        let row = ui.horizontal(|ui| {
            ui.label(widgets::icon(ui, glyph).color(style::color(ink)));
            let cross = 2.0 * ui.spacing().interact_size.y;
            ui.vertical(|ui| {
                ui.set_max_width((ui.available_width() - cross).max(cross));
                ui.add(egui::Label::new(RichText::new(&self.text)).wrap());
            });
            widgets::cross(ui, "Close message").clicked()
        });
        row.inner
    }
}

/// What a message tells of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Something was done.
    Done,
    /// Something can be done.
    Hint,
    /// An example that was opened.
    Description,
    /// Something could not be done.
    Error,
}

/// Messages on the screen.
#[derive(Default)]
pub struct Toasts(Vec<Toast>);

impl Toasts {
    /// Tells that something was done.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.0.push(Toast { text: text.into(), kind: Kind::Done, is_introduction: false, until: None });
    }

    /// Tells that something could not be done, and what to do.
    pub fn fail(&mut self, text: impl Into<String>) {
        self.0.push(Toast { text: text.into(), kind: Kind::Error, is_introduction: false, until: None });
    }

    /// Tells what can be done here, before anything that is newer.
    pub fn introduce(&mut self, text: impl Into<String>) {
        self.0.insert(0, Toast { text: text.into(), kind: Kind::Hint, is_introduction: true, until: None });
    }

    /// Tells what can be done here.
    pub fn hint(&mut self, text: impl Into<String>) {
        self.0.push(Toast { text: text.into(), kind: Kind::Hint, is_introduction: false, until: None });
    }

    /// Shows the description of an example that was opened, if one was, instead of an earlier one.
    pub fn describe(&mut self, text: Option<String>) {
        self.0.retain(|toast| toast.kind != Kind::Description);
        let described = |text| Toast { text, kind: Kind::Description, is_introduction: false, until: None };
        self.0.extend(text.map(described));
    }

    /// Removes what only introduces, as the person steps on.
    pub fn end_introductions(&mut self) {
        self.0.retain(|toast| !toast.is_introduction);
    }

    /// The newest message.
    pub fn last(&self) -> Option<&str> {
        self.0.iter().rfind(|toast| !toast.is_introduction).map(|toast| toast.text.as_str())
    }

    /// Shows the description of an example, if there is one, in a line of its own above what `ui` has at its lower end.
    pub fn show_description(&mut self, ui: &mut Ui, frame: Frame, theme: Theme) {
        let Some(at) = self.0.iter().position(|toast| toast.kind == Kind::Description) else { return };
        let line = Panel::bottom("description").frame(frame.fill(style::color(theme.chrome().raised)));
        if line.show(ui, |ui| self.0[at].show(ui, theme)).inner {
            self.0.remove(at);
        }
    }

    /// Shows all other messages in so much `width` with their lower left `corner` there, the newest at the bottom.
    pub fn show(&mut self, ctx: &egui::Context, (corner, width): (egui::Pos2, f32), theme: Theme) {
        let now = ctx.input(|i| i.time);
        for toast in self.0.iter_mut().filter(|toast| toast.kind != Kind::Description) {
            let read = STAY_SECS.max(LETTER_SECS * toast.text.chars().count() as f64);
            let stay = if toast.kind == Kind::Error { 2.0 * read } else { read };
            toast.until.get_or_insert(now + stay);
        }
        self.0.retain(|toast| toast.until.is_none_or(|until| now < until));
        let Some(next) = self.0.iter().filter_map(|toast| toast.until).reduce(f64::min) else { return };
        ctx.request_repaint_after_secs((next - now) as f32 + 0.01);
        let chrome = theme.chrome();
        let by = corner - ctx.content_rect().left_bottom();
        let area = Area::new(Id::unique("toasts")).order(Order::Foreground).anchor(Align2::LEFT_BOTTOM, by);
        let mut read = None;
        area.show(ctx, |ui| {
            let size = TextStyle::Body.resolve(ui.style()).size;
            for (index, toast) in self.0.iter().enumerate().filter(|(_, toast)| toast.kind != Kind::Description) {
                let fill = style::color(chrome.raised);
                let frame = Frame::popup(ui.style()).fill(fill).inner_margin(12);
                frame.show(ui, |ui| {
                    ui.set_max_width((WIDTH_LETTERS * size).min(width - PADDING).max(LEAST_LETTERS * size));
                    if toast.show(ui, theme) {
                        read = Some(index);
                    }
                });
                ui.add_space(4.0);
            }
        });
        if let Some(index) = read {
            self.0.remove(index);
        }
    }
}
