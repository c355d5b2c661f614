//! Predict, then reveal: what commands, keys and clicks do while a question is open.

use eframe::egui::{Rect, Ui, UiBuilder, vec2};
use motionscope_core::run::{Direction, Move};
use motionscope_core::scene::Focus;

use super::App;
use crate::ui::commands::{Actions, Command, Entry, Menu};
use crate::ui::drawing::style;
use crate::ui::layout::Asking;
use crate::ui::panes::question;

/// Above and below a question, in points.
const MARGIN: f32 = 6.0;

impl App {
    /// The pane of questions, while they are on.
    pub(super) fn asking(&self) -> Option<Asking> {
        let is_open = self.run.predict.open().is_some();
        // The page of a lesson says itself that it asks.
        let page_asks = self.course.lesson.as_ref().is_some_and(|open| open.page().predicts);
        let is_told = page_asks && self.run.predict.last().is_none();
        let is_there = self.run.predict.is_on() && !is_told;
        is_there.then(|| Asking { height: self.panes.question.needed() + 2.0 * MARGIN, is_open })
    }

    /// Shows the question in its place.
    pub(super) fn question_pane(&mut self, ui: &mut Ui, rect: Rect, actions: &mut Actions) {
        let theme = self.settings.look.theme;
        let is_lockstep = !self.run.document.side_by_side().is_empty();
        let is_held = self.run.view.shown.as_deref().is_some_and(|shown| shown.held().is_some());
        let input = question::Input { predict: &self.run.predict, is_lockstep, is_held, theme };
        ui.painter().rect_filled(rect, 0.0, style::color(theme.chrome().raised));
        let inside = UiBuilder::new().id_salt("question").max_rect(rect.shrink2(vec2(12.0, MARGIN)));
        question::show(&mut ui.new_child(inside), &input, &mut self.panes.question, actions);
    }

    /// Turns the questions on or off. A question that is open is taken back: the run stands on the step that answers it already.
    pub(super) fn toggle_predict(&mut self) {
        let before = self.run.predict.turn(!self.run.predict.is_on());
        before.into_iter().for_each(|cursor| self.run.walker.go(Move::To(cursor)));
        if self.run.predict.is_on() {
            // The next step is asked about, not the pixel that is pointed at.
            self.run.walker.focus(None);
        } else {
            self.toasts.tell("Prediction is off: → shows the next result at once.");
        }
    }

    /// Begins the tally of another class.
    pub(super) fn clear_scores(&mut self) {
        self.run.predict.clear_scores();
        self.toasts.tell("The scores are cleared; the next answer begins a new tally.");
    }

    /// Reveals or takes back the open question instead of `command`, where that moves through the run; returns whether the command is
    /// done with.
    pub(super) fn answers(&mut self, command: Command) -> bool {
        use Command as C;
        let Entry { way, menu, .. } = command.entry();
        let is_forward = way == Some(Direction::Forward) || command == C::Play;
        if self.run.predict.open().is_none() {
            // Two steps at once would pass over a question.
            let is_early = is_forward && self.run.predict.is_due();
            if is_forward && !is_early {
                self.run.expect_question();
            }
            return is_early;
        }
        if matches!(command, C::Undo | C::Redo) {
            // What was set before the question stays as it is.
            let before = self.run.predict.withdraw();
            before.into_iter().for_each(|cursor| self.run.walker.go(Move::To(cursor)));
            return true;
        }
        let is_back = way == Some(Direction::Back);
        if is_forward || command == C::End {
            self.run.predict.reveal();
        } else if menu == Menu::Walk && !matches!(command, C::Predict | C::Stop | C::Slower | C::Faster) {
            let before = self.run.predict.withdraw();
            // Whatever else moves the run goes on from the step before.
            before.filter(|_| is_back).into_iter().for_each(|cursor| self.run.walker.go(Move::To(cursor)));
        }
        is_forward || is_back || command == C::End
    }

    /// Takes a click on the picture as a guess, while a place is asked for; returns whether a question is open.
    pub(super) fn guesses_at(&mut self, focus: Focus) -> bool {
        let is_open = self.run.predict.open().is_some();
        if is_open && !self.run.predict.point(focus) {
            self.toasts.hint("A click is a guess where a place is asked for. → reveals the result.");
        }
        is_open
    }
}
