//! Opens a result of the search in the window.

use motionscope_core::course::estimator;

use super::App;
use super::dialogs::Overlay;
use crate::search::{Target, is_same_parameter};
use crate::ui::commands::Action;
use crate::ui::dialogs::terms;
use crate::ui::layout;
use crate::view::panes::Pane;

impl App {
    /// Opens a hit.
    pub(super) fn show_found(&mut self, target: Target) {
        match target {
            Target::Term(term) => self.dialogs.overlay = Overlay::Glossary(terms::State::asking(term.name)),
            Target::Estimator(id) => self.act(Action::Choose(id)),
            Target::Page(address) => self.act(Action::OpenPage(address)),
            Target::Parameter(id, name) => self.show_parameter(id, name),
            Target::Chart(pane) => self.show_chart(pane),
            Target::Example(id, example) => self.act(Action::OpenExample(id, example)),
        }
    }

    /// Shows a parameter of the present estimator, or of the estimator `id` where the present one does not have it.
    fn show_parameter(&mut self, id: &'static str, name: &str) {
        if !self.has_parameter(id, name) {
            self.act(Action::Choose(id));
        } else if self.dialogs.start.is_some() {
            self.leave_start();
        }
        let info = self.run.document.estimator().info();
        if self.run.document.estimator().specs().iter().any(|spec| spec.name == name && spec.advanced) {
            self.panes.states.parameters.unfold(info.id);
        }
        if self.folded().parameters {
            self.settings.toggle(layout::Pane::Parameters);
        }
    }

    /// Whether the present estimator shares the parameter `name` of the estimator `id`.
    fn has_parameter(&self, id: &str, name: &str) -> bool {
        let Ok(of) = estimator(id) else { return false };
        let mut present = self.run.document.estimator().specs().iter();
        let sought = of.specs().iter().find(|spec| spec.name == name);
        sought.is_some_and(|sought| present.any(|spec| is_same_parameter(spec, sought)))
    }

    /// Shows a chart, or says when there is one.
    fn show_chart(&mut self, pane: &'static Pane) {
        if self.dialogs.start.is_some() {
            self.leave_start();
        }
        let all = self.charts();
        if !all.contains(&pane) {
            return self.toasts.hint(format!("{} shows {}, {}.", pane.title, pane.doc, pane.when));
        }
        if self.folded().charts {
            self.settings.toggle(layout::Pane::Charts);
        }
        let count = self.panes.arranged.charts.len().max(1);
        let seen = self.settings.charts.seen(&all, count);
        self.settings.charts.choose(0, pane, &seen);
        self.settings.charts.is_preferred |= self.panes.arranged.alternates;
    }
}
