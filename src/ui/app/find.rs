//! What the search has found, opened in the window.

use crate::search::Target;
use crate::ui::app::action::Action;
use crate::ui::app::window::{App, Overlay, Region};
use crate::ui::dialogs::terms;
use crate::ui::panes::layout;
use crate::view::panes::Pane;

impl App {
    /// Opens what was found.
    pub(super) fn show_found(&mut self, target: Target) {
        match target {
            Target::Term(term) => self.overlay = Overlay::Glossary(terms::State::asking(term.name)),
            Target::Estimator(id) => self.act(Action::Choose(id)),
            Target::Page(address) => self.act(Action::OpenPage(address)),
            Target::Parameter(id, name) => self.show_parameter(id, name),
            Target::Chart(pane) => self.show_chart(pane),
            Target::Example(id, example) => self.act(Action::OpenExample(id, example)),
        }
    }

    /// Shows a parameter of the present estimator, or of the estimator `id` where the present one does not have it.
    fn show_parameter(&mut self, id: &'static str, name: &str) {
        let has_it = self.document.estimator().specs().iter().any(|spec| spec.name == name);
        if !has_it || self.start.is_some() {
            self.act(Action::Choose(id));
        }
        let info = self.document.estimator().info();
        if self.document.estimator().specs().iter().any(|spec| spec.name == name && spec.advanced) {
            self.states.parameters.unfold(info.id);
        }
        if self.folded().parameters {
            self.settings.toggle(layout::Pane::Parameters);
        }
    }

    /// Shows a chart, or says when there is one.
    fn show_chart(&mut self, pane: &'static Pane) {
        if self.start.is_some() {
            self.leave_start();
        }
        let all = self.charts();
        if !all.contains(&pane) {
            return self.toasts.hint(format!("{} shows {}, {}.", pane.title, pane.doc, pane.when));
        }
        if self.folded().charts {
            self.settings.toggle(layout::Pane::Charts);
        }
        let count = self.regions().iter().filter(|(region, _)| *region == Region::Chart).count().max(1);
        let seen = self.settings.charts.seen(&all, count);
        self.settings.charts.choose(0, pane, &seen);
    }
}
