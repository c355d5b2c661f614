//! The start page in the window: shown before anything is open, and on a command.

use eframe::egui::Ui;
use motionscope_core::synth;

use super::App;
use crate::experiment::first;
use crate::ui::commands::Actions;
use crate::ui::panes::start;

impl App {
    /// Begins without a name on the command line: with the start page, unless that was turned off.
    pub fn begin_fresh(&mut self) {
        match self.settings.has_start_page {
            true => self.open_start(),
            false => self.open_first(),
        }
    }

    /// Whether the start page is shown.
    pub fn is_at_start(&self) -> bool {
        self.dialogs.start.is_some()
    }

    /// Shows the start page.
    fn open_start(&mut self) {
        self.run.player.pause();
        self.dialogs.start = Some(start::State::new(&self.ctx, &self.settings.recent));
    }

    /// Leaves the start page for the work: what was open, or else the first sample.
    pub fn leave_start(&mut self) {
        self.dialogs.start = None;
        self.opening.loading = None;
        if self.run.document.clip().is_none() {
            self.open_first();
        }
    }

    /// Shows the start page, or leaves it.
    pub(super) fn toggle_start(&mut self) {
        match self.dialogs.start {
            Some(_) => self.leave_start(),
            None => self.open_start(),
        }
    }

    fn open_first(&mut self) {
        if let Ok(sample) = synth::scene(first::SAMPLE) {
            self.open_sample(sample);
        }
    }

    /// Draws the page.
    pub(super) fn start_page(&mut self, ui: &mut Ui, actions: &mut Actions) {
        let input = start::Input {
            loading: self.opening.loading.as_ref(),
            error: self.opening.error.as_ref(),
            asks_for_trust: self.opening.asks_for_trust(),
            is_covered: self.dialogs.is_covered(),
            is_shown_at_start: self.settings.has_start_page,
            plays: !self.settings.reduced_motion,
            theme: self.settings.look.theme,
        };
        if let Some(state) = &mut self.dialogs.start {
            start::show(ui, state, &mut self.dialogs.previews, &input, actions);
        }
    }
}
