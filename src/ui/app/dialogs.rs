//! The open dialog over the panes.

use eframe::egui;

use super::App;
use crate::ui::commands::Actions;
use crate::ui::dialogs::chooser::{self, Purpose};
use crate::ui::dialogs::{
    camera, compare, find, gallery, lessons, open as open_dialog, palette, save as save_dialog, sheet, terms,
};
use crate::ui::model::previews::Previews;
use crate::ui::panes::start;

/// The open dialog, and the state of each.
#[derive(Default)]
pub(super) enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The command palette.
    Palette(palette::State),
    /// The estimators.
    Chooser(Box<chooser::State>),
    /// The search over all texts.
    Find(find::State),
    /// The terms of the course.
    Glossary(terms::State),
    /// Every key.
    Shortcuts,
    /// A path to open.
    Open(Box<open_dialog::State>),
    /// Something to write.
    Save(Box<save_dialog::State>),
    /// The samples.
    Samples,
    /// The lessons.
    Lessons(lessons::State),
    /// A camera.
    Camera(Box<camera::State>),
    /// Estimators beside each other.
    Compare(Box<compare::State>),
    /// Name, version and licences.
    About,
}

/// A dialog over the panes, or a page instead of them.
#[derive(Default)]
pub(super) struct Dialogs {
    pub overlay: Overlay,
    /// The start page while it is shown.
    pub start: Option<start::State>,
    /// The pictures of the samples and of the estimators.
    pub previews: Previews,
}

impl Dialogs {
    /// Whether something lies over the panes.
    pub fn is_covered(&self) -> bool {
        !matches!(self.overlay, Overlay::None)
    }

    /// Whether all pictures that are asked for are there.
    pub fn is_settled(&self) -> bool {
        match &self.overlay {
            Overlay::Samples => self.previews.is_complete(),
            Overlay::Chooser(_) => self.previews.steps.is_complete(),
            Overlay::Compare(state) => state.is_settled(),
            Overlay::Save(state) => state.is_settled(),
            _ => self.start.is_none() || self.previews.is_complete() && self.previews.steps.is_complete(),
        }
    }
}

impl App {
    /// Opens the chooser with `query` typed in it; at the start page a choice opens an example.
    pub(super) fn open_chooser(&mut self, query: String, is_entered: bool) {
        let purpose = if self.is_at_start() { Purpose::Example } else { Purpose::Run };
        let state = chooser::State::new(&self.run.document, purpose, query, is_entered);
        self.dialogs.overlay = Overlay::Chooser(Box::new(state));
    }

    /// Draws what lies over the panes.
    pub(super) fn overlays(&mut self, ctx: &egui::Context, actions: &mut Actions) {
        let theme = self.settings.look.theme;
        let mut overlay = std::mem::take(&mut self.dialogs.overlay);
        let open = match &mut overlay {
            Overlay::None => false,
            Overlay::Palette(state) => {
                let (now, granularities, recent) =
                    (self.now(), self.run.granularities(), self.settings.recent.as_slice());
                let estimator = self.run.document.estimator().info().id;
                let input = palette::Input { now, granularities, estimator, recent, theme };
                let (chosen, open) = palette::show(ctx, state, &input);
                actions.0.extend(chosen);
                open
            }
            Overlay::Chooser(state) => chooser::show(ctx, state, &mut self.dialogs.previews.steps, theme, actions),
            Overlay::Find(state) => find::show(ctx, state, theme, actions),
            Overlay::Glossary(state) => terms::show(ctx, state),
            Overlay::Shortcuts => sheet::shortcuts(ctx, &self.run.granularities(), theme),
            Overlay::Open(state) => open_dialog::show(ctx, state, &self.settings.recent, actions),
            Overlay::Save(state) => save_dialog::show(ctx, state, self.run.granularities(), actions),
            Overlay::Camera(state) => camera::show(ctx, state, (&self.run.document, &mut self.settings), actions),
            Overlay::Compare(state) => compare::show(ctx, state, &self.run.document, &self.settings.look, actions),
            Overlay::Lessons(state) => lessons::show(ctx, state, theme, actions),
            Overlay::Samples => {
                let plays = !self.settings.reduced_motion;
                gallery::show(ctx, &mut self.dialogs.previews, gallery::Input { theme, plays }, actions)
            }
            Overlay::About => sheet::about(ctx),
        };
        if open {
            self.dialogs.overlay = overlay;
        }
    }
}
