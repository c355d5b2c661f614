//! Presenting to a class: pointer, pen, full screen, and the presenter's window.
//!
//! That window is a second native viewport, or lies within the first one where there are none; its keys and buttons request the
//! same actions. The next step comes from `ui/model/upcoming.rs`.

use std::sync::Arc;

use eframe::egui::{
    self, CentralPanel, Frame, Id, LayerId, Margin, Order, Panel, Stroke, Ui, ViewportBuilder, ViewportClass,
    ViewportId,
};
use motionscope_core::base::Error;
use motionscope_core::scene::Role;
use web_time::{Duration, Instant};

use super::App;
use crate::experiment::Prepared;
use crate::paint::{Color, Freehand, FreehandLine};
use crate::ui::app::keys;
use crate::ui::commands::{Actions, PenWish};
use crate::ui::drawing::style;
use crate::ui::full_screen;
use crate::ui::model::pen::Pen;
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::upcoming::{Next, Upcoming};
use crate::ui::panes::Presented;
use crate::ui::panes::presenter::{self, Coming};
use crate::ui::stage::Hand;
use crate::view::moment::Moment;

/// Radius of the pointer's dot, and of the halo around it, in sizes of the theme's type.
const DOT: f32 = 0.5;
const HALO: f32 = 1.25;
/// Height of the line that shows how far the run is.
const PROGRESS_PT: f32 = 4.0;
/// A minute of the clock, which is drawn a little after it is over.
const MINUTE: Duration = Duration::from_secs(60);
const LATER: Duration = Duration::from_millis(50);
/// Initial size of the presenter's window.
const WINDOW: [f32; 2] = [760.0, 640.0];

/// The tools of a lecture: pen, magnifying glass, presenter window.
#[derive(Default)]
pub struct Presentation {
    /// The pen, and what was drawn with it.
    pub pen: Pen,
    /// Whether the mouse is a large pointer.
    pub is_pointing: bool,
    /// Whether a magnifying glass follows the mouse over the pictures.
    pub has_loupe: bool,
    /// Whether stage, chart and caption are shown alone, in full screen.
    pub is_on: bool,
    /// Whether stage, chart, sentence and transport are shown alone, in a frame of another page.
    pub is_embedded: bool,
    /// Whether that screen is black.
    pub is_blank: bool,
    /// Whether the keys of that screen have been told.
    pub has_hinted: bool,
    /// The presenter's window, while it is open.
    pub presenter: Option<Presenter>,
}

/// The presenter's window.
pub struct Presenter {
    /// From when on the time is counted.
    since: Instant,
    upcoming: Upcoming,
}

impl Presentation {
    /// Takes the large pointer instead of the pen, or puts it away.
    pub(super) fn toggle_pointer(&mut self) {
        self.is_pointing = !self.is_pointing;
        self.pen.is_on = false;
    }

    /// How the stage is presented.
    pub fn presented(&self) -> Presented<'_> {
        let hand = match (self.pen.is_on, self.is_pointing) {
            (true, _) => Hand::Draw(self.pen.color),
            (false, true) => Hand::Point,
            (false, false) => Hand::Explore,
        };
        Presented { pen: &self.pen, hand, has_loupe: self.has_loupe, is_bare: self.is_on }
    }
}

impl App {
    /// Takes the pen, or lays it down.
    pub(super) fn take_pen(&mut self) {
        let pen = &mut self.presentation.pen;
        pen.is_on = !pen.is_on;
        if pen.is_on {
            self.presentation.is_pointing = false;
            self.panes.states.stage.placing = None;
            // The ink of a step goes with it.
            self.run.player.pause();
        }
    }

    /// Shows stage, chart and caption alone, or everything again.
    pub(super) fn toggle_full_screen(&mut self) {
        let is_on = !self.presentation.is_on;
        (self.presentation.is_on, self.presentation.is_blank) = (is_on, false);
        full_screen::set(&self.ctx, is_on);
        if is_on {
            self.settings.fold_parameters();
            // What only introduces the window is nothing for a class.
            self.toasts.end_introductions();
            // While results are asked about, digits count hands.
            let digits = if self.run.predict.is_on() { "" } else { "1 to 5 choose the chart. " };
            if !std::mem::replace(&mut self.presentation.has_hinted, true) {
                self.toasts.hint(format!("{digits}Esc shows the menus again."));
            }
        }
    }

    /// Adds a line to the step on which it was drawn.
    pub(super) fn draw(&mut self, line: FreehandLine) {
        if let Some(shown) = &self.run.view.shown {
            self.presentation.pen.draw(&shown.subject, line);
        }
    }

    /// Does what is asked of the pen.
    pub(super) fn pen(&mut self, wish: PenWish) {
        let Some(shown) = &self.run.view.shown else { return };
        let (pen, subject, at) = (&mut self.presentation.pen, &shown.subject, shown.cursor);
        match wish {
            PenWish::Color(color) => pen.color = color,
            PenWish::Undo => pen.undo(subject, at),
            PenWish::Clear => pen.clear(subject, at),
            PenWish::Done => pen.is_on = false,
        }
    }

    /// Undoes or redoes the last change of the ink of this step.
    pub(super) fn undo_ink(&mut self, redoes: bool) {
        let Some(shown) = &self.run.view.shown else { return };
        let (pen, subject, at) = (&mut self.presentation.pen, &shown.subject, shown.cursor);
        if redoes { pen.redo(subject, at) } else { pen.undo(subject, at) }
    }

    /// What was drawn by hand on the step that is shown.
    pub fn ink(&self) -> &[FreehandLine] {
        let shown = self.run.view.shown.as_deref();
        shown.map_or(&[], |shown| self.presentation.pen.lines(&shown.subject, shown.cursor))
    }

    /// Whether ink of this step can be undone and redone, while the pen is on.
    pub(super) fn ink_history(&self) -> Option<[bool; 2]> {
        let shown = self.run.view.shown.as_deref().filter(|_| self.presentation.pen.is_on)?;
        Some(self.presentation.pen.history(&shown.subject, shown.cursor))
    }

    /// Takes over the ink of a session, if it has some. On a page of a lesson what was drawn or cleared since stays.
    pub(super) fn restore_ink(&mut self, subject: &Arc<Prepared>, freehand: Freehand) {
        let pen = &mut self.presentation.pen;
        match self.course.lesson {
            _ if freehand.lines.is_empty() => {}
            Some(_) => pen.complete(subject, freehand),
            None => pen.restore(subject, freehand),
        }
    }

    /// The step that is shown, with what was drawn on it.
    pub(super) fn inked(&self) -> Option<Arc<Snapshot>> {
        let shown = self.run.view.shown.as_ref()?;
        let lines = self.ink();
        if lines.is_empty() {
            return Some(Arc::clone(shown));
        }
        let moment = Moment { freehand: lines.into(), ..shown.moment.clone() };
        Some(Arc::new(Snapshot { moment, ..Snapshot::clone(shown) }))
    }

    /// A thin line at the bottom that tells how far the run is.
    pub(super) fn progress_line(&self, ui: &mut Ui) {
        let chrome = self.settings.look.theme.chrome();
        let share = self.run.view.shown.as_deref().and_then(Snapshot::share).unwrap_or(0.0);
        Panel::bottom("progress").frame(Frame::new()).exact_size(PROGRESS_PT).show(ui, |ui| {
            let rect = ui.max_rect();
            ui.painter().rect_filled(rect, 0.0, style::color(chrome.raised));
            let done = rect.with_max_x(rect.min.x + share * rect.width());
            ui.painter().rect_filled(done, 0.0, style::color(chrome.accent));
        });
    }

    /// Draws the large pointer over stage, charts and words.
    pub(super) fn show_pointer(&self, ctx: &egui::Context) {
        let at = ctx.input(|input| input.pointer.latest_pos()).filter(|_| self.presentation.is_pointing);
        let Some(at) = at.filter(|at| self.panes.shown_regions().any(|rect| rect.contains(*at))) else { return };
        let theme = self.settings.look.theme;
        let (ink, size) = (theme.ink(Role::Error), theme.sizes().body);
        let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, Id::unique("pointer")));
        painter.circle_filled(at, HALO * size, style::color(ink.color.alpha(0x50)));
        let rim = Stroke::new(1.5 * ink.halo_width, style::color(Color::WHITE));
        painter.circle(at, DOT * size, style::color(ink.color), rim);
        painter.circle_stroke(at, DOT * size + 1.5 * ink.halo_width, Stroke::new(1.0, style::color(ink.halo)));
        ctx.set_cursor_icon(egui::CursorIcon::None);
    }

    /// Covers the window while the screen is blank.
    pub(super) fn show_blank(&self, ctx: &egui::Context) {
        if self.presentation.is_blank {
            let painter = ctx.layer_painter(LayerId::new(Order::Debug, Id::unique("blank")));
            painter.rect_filled(ctx.content_rect(), 0.0, style::color(Color::BLACK));
            ctx.set_cursor_icon(egui::CursorIcon::None);
        }
    }

    pub(super) fn toggle_presenter(&mut self) {
        if self.presentation.presenter.take().is_some() {
            return;
        }
        let ctx = self.ctx.clone();
        match Upcoming::new(move || ctx.request_repaint()) {
            Ok(upcoming) => self.presentation.presenter = Some(Presenter { since: Instant::now(), upcoming }),
            Err(error) => self.toasts.fail(format!("The presenter's window could not be opened: {error}.")),
        }
    }

    /// Shows the presenter's window if it is open: its keys and buttons step this one.
    pub(super) fn presenter_window(&mut self, ctx: &egui::Context, actions: &mut Actions) {
        let Some(open) = &self.presentation.presenter else { return };
        let elapsed = open.since.elapsed();
        let input = presenter::Input {
            document: &self.run.document,
            lesson: self.course.lesson.as_ref(),
            shown: self.run.view.shown.as_deref(),
            coming: self.coming(&open.upcoming),
            predict: &self.run.predict,
            minutes: elapsed.as_secs() / MINUTE.as_secs(),
            theme: self.settings.look.theme,
        };
        let overlaid = self.dialogs.is_covered();
        let builder = ViewportBuilder::default().with_title("Motionscope – presenter").with_inner_size(WINDOW);
        let response = ctx.show_viewport_immediate(viewport(), builder, |ui, class| {
            // The time goes on once a minute, and nothing else moves by itself.
            ui.ctx().request_repaint_after(until_next_minute(elapsed));
            if class == ViewportClass::EmbeddedWindow {
                return presenter::show(ui, &input, actions);
            }
            let ctx = ui.ctx().clone();
            keys::take(&ctx, overlaid, &self.now(), actions);
            let frame = Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::same(16));
            let shown = CentralPanel::no_frame().frame(frame).show(ui, |ui| presenter::show(ui, &input, actions));
            let closes = ctx.input(|input| input.viewport().close_requested());
            presenter::Response { closes: closes || shown.inner.closes, ..shown.inner }
        });
        if response.closes {
            self.presentation.presenter = None;
        }
        if let Some(open) = self.presentation.presenter.as_mut().filter(|_| response.restarts) {
            open.since = Instant::now();
        }
    }

    /// What comes after the step that is shown; it is asked for where the run stands still.
    fn coming(&self, upcoming: &Upcoming) -> Coming {
        let Some(shown) = self.run.view.shown.as_deref() else { return Coming::Awaited };
        if let Some(title) = self.course.coming_page(shown.cursor) {
            return Coming::Page(title);
        }
        if shown.at_end {
            return Coming::End;
        }
        if self.run.player.is_playing() || self.run.view.busy {
            return upcoming.after(shown).map_or(Coming::Awaited, found);
        }
        upcoming.ask(shown);
        upcoming.after(shown).map_or(Coming::Awaited, found)
    }

    /// Waits for the next step, for tests.
    pub fn wait_for_next(&self) {
        self.presentation.presenter.iter().for_each(|open| open.upcoming.wait());
    }
}

fn found(next: Result<Option<Next>, Error>) -> Coming {
    match next {
        Ok(Some(next)) => Coming::Step(next),
        Ok(None) => Coming::End,
        Err(why) => Coming::Failed(why),
    }
}

/// The time until the clock shows another minute.
fn until_next_minute(elapsed: Duration) -> Duration {
    let over =
        Duration::from_secs(elapsed.as_secs() % MINUTE.as_secs()) + Duration::from_nanos(elapsed.subsec_nanos().into());
    MINUTE - over + LATER
}

fn viewport() -> ViewportId {
    ViewportId::from_hash_of("presenter")
}
