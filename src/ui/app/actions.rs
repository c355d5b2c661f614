//! Executes the actions that panes and dialogs ask for.

use motionscope_core::run::Move;

use super::App;
use super::dialogs::Overlay;
use crate::experiment::side_by_side::SideBySide;
use crate::ui::commands::{Action, Command};
use crate::ui::dialogs::chooser::{self, Purpose};
use crate::ui::dialogs::{find, open as open_dialog, palette};

impl App {
    /// Executes an action.
    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::Command(command) => self.command(command),
            Action::Open(name) => self.open(name),
            Action::OpenRightView(name) => self.open_right_view(name),
            Action::Type(Command::Palette, text, is_entered) => {
                self.dialogs.overlay = Overlay::Palette(palette::State::asking(text, is_entered));
            }
            Action::Type(Command::SearchText, text, is_entered) => {
                self.dialogs.overlay = Overlay::Find(find::State::asking(text, is_entered));
            }
            Action::Type(Command::Estimators, text, is_entered) => self.open_chooser(text, is_entered),
            Action::Type(_, text, _) => {
                self.dialogs.overlay = Overlay::Open(Box::new(open_dialog::State::asking(text)))
            }
            Action::OpenWhole => self.open_whole(),
            Action::OpenSample(sample) => self.open_sample(sample),
            Action::OpenExample(id, example) => self.open_example(id, example),
            Action::OpenPage(address) => self.open_page(address),
            Action::Show(target) => self.show_found(target),
            Action::ShowAtStart(is_shown) => self.settings.has_start_page = is_shown,
            Action::OpenRecording(kept, estimator, ended) => self.open_recording(kept, estimator, ended),
            Action::CancelOpening => self.opening.loading = None,
            Action::Browse(wanted) => self.browse(wanted),
            Action::Write(order) => self.write(*order),
            Action::CancelWriting => self.exports.cancel(),
            Action::Choose(id) => {
                if self.is_at_start() {
                    self.leave_start();
                }
                self.choose(id);
            }
            Action::ChooseBeside => {
                let state = chooser::State::new(&self.run.document, Purpose::Beside, "", false);
                self.dialogs.overlay = Overlay::Chooser(Box::new(state));
            }
            Action::Visit(row) => self.visit(&row),
            Action::Lockstep(ids) => self.lockstep(&ids),
            Action::AddBeside(id) => self.add_beside(id),
            Action::RemoveBeside(index) => self.remove_beside(index),
            Action::Pace(pace) => {
                let side_by_side = SideBySide { pace, ..self.run.document.side_by_side().clone() };
                self.set_lockstep(self.run.document.estimator().boxed_clone(), side_by_side);
            }
            Action::Set(owner, index, value) => {
                if let Err(error) = self.run.document.set(owner, index, value) {
                    self.toasts.fail(error.to_string());
                }
                self.restart();
            }
            Action::Enter(index) => self.enter(index),
            Action::Settle => self.run.document.settle(),
            Action::Place(index) => self.place(index),
            Action::ResetAll(owner) => {
                self.run.document.reset(owner);
                self.restart();
            }
            Action::Seek(cursor) => self.run.go(Move::To(cursor)),
            Action::SeekCandidate(candidate) => {
                self.run.player.pause();
                let shown = self.run.view.shown.as_deref();
                self.panes.states.sought = shown.map(|shown| (shown.cursor.unit, candidate));
                self.run.walker.go_to_candidate(candidate);
            }
            Action::SeekAt(focus, _) if self.guesses_at(focus) => {}
            Action::SeekAt(focus, side) => {
                self.run.player.pause();
                let shown = self.run.view.shown.as_ref();
                if let Some(first) = shown.and_then(|shown| shown.elsewhere(focus.on)) {
                    let (clicked, first) = (focus.on.title(None), first.title(None).to_lowercase());
                    self.toasts.hint(format!("{clicked} has no pixels to explain at this step: click on {first}."));
                    return;
                }
                self.run.walker.go_at(focus, side);
            }
            // The step that is held back would explain the pixel under the pointer.
            Action::Focus(_) if self.run.predict.is_due() || self.run.predict.open().is_some() => {}
            Action::Chart(index) => self.choose_chart(index),
            Action::Draw(line) => self.draw(*line),
            Action::Pen(wish) => self.pen(wish),
            Action::Focus(focus) => self.run.walker.focus(focus),
            Action::Vote(index, adds) => _ = self.run.predict.vote(index, adds),
            Action::Guess(number) => _ = self.run.predict.number(number),
            Action::Reveal => self.run.predict.reveal(),
            Action::Release => self.run.walker.release(),
            Action::Hint(text) => self.toasts.introduce(text),
            Action::Frame(frame) => self.go_to_frame(frame),
            Action::Speed(speed) => {
                self.run.player.speed = speed;
                self.settings.speed = speed;
            }
            Action::Dismiss => self.opening.error = None,
            Action::Trust => self.trust(),
        }
    }
}
