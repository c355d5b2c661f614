//! Predict, then reveal: what commands, keys and clicks do while a question is open.

use eframe::egui::{Frame, Margin, Panel, Rect, Ui};
use motionscope_core::Move;
use motionscope_core::scene::Focus;

use crate::ui::app::action::Actions;
use crate::ui::app::commands::{Command, Menu};
use crate::ui::app::window::{App, Region};
use crate::ui::drawing::style;
use crate::ui::panes::question;

impl App {
    /// Puts an open question between the run and the window.
    pub(super) fn hold_back(&mut self) {
        if self.predict.pass(&mut self.view) {
            self.player.pause();
            self.walker.focus(None);
        }
    }

    /// Shows the bar of questions, while they are on.
    pub(super) fn question_bar(&mut self, ui: &mut Ui, actions: &mut Actions, regions: &mut Vec<(Region, Rect)>) {
        if !self.predict.is_on() {
            return;
        }
        let theme = self.settings.look.theme;
        let frame = Frame::new().fill(style::color(theme.chrome().raised)).inner_margin(Margin::symmetric(12, 6));
        let asked = Panel::bottom("question").frame(frame);
        let asked = asked.show(ui, |ui| question::show(ui, &self.predict, theme, &mut self.question, actions));
        regions.push((Region::Question, asked.response.rect));
    }

    /// Turns the questions on or off.
    pub(super) fn toggle_predict(&mut self) {
        self.predict.turn(!self.predict.is_on());
    }

    /// Reveals or takes back the open question instead of `command`, where that moves through the run; returns whether the command is
    /// done with.
    pub(super) fn answers(&mut self, command: Command) -> bool {
        use Command as C;
        if self.predict.open().is_none() {
            let is_forward = matches!(command, C::Into | C::Over | C::Out | C::NextUnit | C::Play | C::NextMark);
            if is_forward || command == C::NextAlike {
                self.predict.expect();
            }
            return false;
        }
        match command {
            C::Into | C::Over | C::Out | C::NextUnit | C::Play | C::NextMark | C::NextAlike | C::End => {
                self.predict.reveal();
                true
            }
            C::Predict | C::NextPage | C::PreviousPage | C::Stop | C::Slower | C::Faster | C::Compare => false,
            _ if command.info().menu == Menu::Walk => {
                if let Some(cursor) = self.predict.withdraw() {
                    self.walker.go(Move::To(cursor));
                }
                true
            }
            _ => false,
        }
    }

    /// Takes a click on the picture as a guess, while a place is asked for; returns whether a question is open.
    pub(super) fn guesses_at(&mut self, focus: Focus) -> bool {
        let is_open = self.predict.open().is_some();
        if is_open && !self.predict.point(focus) {
            self.toasts.hint("A click is a guess where a place is asked for. → reveals the result.");
        }
        is_open
    }
}
