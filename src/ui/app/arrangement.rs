//! Where the panes lie, and which of them and of the charts are seen.

use eframe::egui::{self, Rect};
use motionscope_core::scene::Chart;
use motionscope_core::scene::Step;

use super::present::Presentation;
use super::{App, Region};
use crate::paint::Theme;
use crate::ui::layout::{Arrangement, LessonPage, Mode, Pictures, Room};
use crate::ui::panes::{States, question};
use crate::ui::stage;
use crate::view::panes::{Pane, charts};

/// The state of the panes, and where they lay in the last frame.
#[derive(Default)]
pub(super) struct PaneMemory {
    pub states: States,
    pub question: question::State,
    /// The panes of the last frame.
    pub arranged: Arrangement,
    /// Where everything lay in the last frame.
    pub regions: Vec<(Region, Rect)>,
}

impl PaneMemory {
    /// Where a region lies, if it is there.
    pub fn region(&self, of: Region) -> Option<Rect> {
        self.regions.iter().find(|(region, _)| *region == of).map(|(_, rect)| *rect)
    }

    /// The lower left corner of messages, and their width. They lie over no picture: on the chart, which is seen again when they go, or
    /// else on the words, or above the transport.
    pub fn place_of_messages(&self, content: Rect) -> (egui::Pos2, f32) {
        use Region::{Chart, Explanation, Lesson, Parameters, Question, Strip, Transport};
        let of = [Chart, Strip, Explanation, Parameters, Lesson, Question, Transport];
        let place = of.into_iter().find_map(|region| self.region(region)).unwrap_or(content);
        let gap = egui::vec2(12.0, -8.0);
        (place.left_bottom() + gap, place.width() - 2.0 * gap.x)
    }

    /// Where the class looks.
    pub fn shown_regions(&self) -> impl Iterator<Item = Rect> {
        let of = [Region::Stage, Region::Chart, Region::Strip, Region::Explanation, Region::Lesson];
        self.regions.iter().filter(move |(region, _)| of.contains(region)).map(|(_, rect)| *rect)
    }
}

impl App {
    /// Looks how much room there is, and shares it out anew where that has changed.
    pub(super) fn measure(&mut self, ctx: &egui::Context) {
        let type_pt = self.settings.look.theme.sizes().body;
        let window = ctx.content_rect().size();
        let is_lecture = self.settings.lecture || self.settings.look.theme == Theme::Projector;
        let mode = match &self.presentation {
            Presentation { is_on: true, .. } => Mode::Presenting,
            Presentation { is_embedded: true, .. } => Mode::Embedded,
            _ => Mode::of(window, type_pt, is_lecture),
        };
        self.settings.mode = Some(mode);
        self.settings.is_narrow = !self.room(Rect::NOTHING, window).has_docked_parameters();
    }

    /// The step that is explained, and the charts of its estimator.
    fn explained(&self) -> Option<(&Step, &'static [Chart])> {
        let shown = self.run.view.shown.as_deref()?;
        let (experiment, explained) = (&shown.subject.experiment, self.panes.states.explained_of(shown));
        let step = shown.tiles.get(explained).map_or(&shown.step, |tile| &tile.step);
        let beside = explained.checked_sub(1).and_then(|i| experiment.side_by_side.beside.get(i));
        Some((step, beside.map_or(&experiment.estimator, |companion| &companion.estimator).charts()))
    }

    /// The charts of the step that is explained.
    pub(super) fn charts(&self) -> Vec<&'static Pane> {
        self.explained().map_or_else(Vec::new, |(step, of)| charts(step, of))
    }

    /// The mode of the window as it is.
    pub(super) fn mode(&self) -> Mode {
        self.settings.mode.unwrap_or(Mode::Working)
    }

    /// The pictures on the stage just now.
    fn pictures(&self) -> Pictures {
        let theme = self.settings.look.theme;
        let tools_pt = (!self.presentation.is_on).then(|| self.ctx.global_style().spacing.interact_size.y);
        let line = stage::line_height(theme, tools_pt);
        let Some(shown) = self.run.view.shown.as_deref() else { return Pictures { line, ..Pictures::default() } };
        let stands = shown.stands(shown.subject.experiment.estimator.shows_frame_alone());
        let (pictures, look, tiles) = (&shown.pictures, self.settings.look, shown.tiles.len());
        stage::pictures(stage::OnStage { pictures, look, stands, tiles }, theme, line)
    }

    /// The room between header and transport, for panes of what is shown.
    pub(super) fn room(&self, body: Rect, window: egui::Vec2) -> Room {
        let mode = self.mode();
        let folded = self.settings.folded();
        let is_brief = mode.is_lecture() && folded.explanation;
        Room {
            body,
            window,
            type_pt: self.settings.look.theme.sizes().body,
            mode,
            folded,
            pictures: self.pictures(),
            charts: self.charts().len(),
            can_have_charts: self.explained().is_none_or(|(_, of)| !of.is_empty()),
            page: self.course.lesson.as_ref().map(|open| LessonPage {
                height: self.panes.states.lesson.needed(),
                is_read: self.run.view.shown.as_deref().is_some_and(|shown| open.has_left(shown)),
            }),
            question: self.asking(),
            // A chart is hidden during a question, and the pictures may have to be clicked.
            is_enlarged: self.settings.charts.is_enlarged && self.run.predict.open().is_none(),
            prefers_chart: self.settings.charts.is_preferred,
            told: if is_brief { self.panes.states.strip.height() } else { self.panes.states.explanation.formula_end() },
            shares: self.settings.shares,
        }
    }

    /// Turns the lecture layout on or off, and says why that changes nothing, if so.
    pub(super) fn lecture(&mut self) {
        self.settings.lecture = !self.settings.lecture;
        let is_projector = self.settings.look.theme == Theme::Projector;
        if self.settings.lecture && self.settings.mode.is_some_and(Mode::is_lecture) {
            let why = if is_projector { "The projector theme" } else { "A window of this size" };
            self.toasts.hint(format!("{why} has the lecture layout already."));
        }
    }

    /// Shows the next chart, or the one before.
    pub(super) fn turn_charts(&mut self, is_back: bool) {
        let all = self.charts();
        let (count, alternate) = (self.panes.arranged.charts.len().max(1), self.panes.arranged.alternates);
        self.settings.charts.turn(&all, count, (is_back, alternate));
    }

    /// Shows the chart with this index of those of the step.
    pub(super) fn choose_chart(&mut self, index: usize) {
        let all = self.charts();
        let Some(pane) = all.get(index) else { return };
        let seen = self.settings.charts.seen(&all, 1);
        self.settings.charts.choose(0, pane, &seen);
        self.settings.charts.is_preferred |= self.panes.arranged.alternates;
    }

    /// Puts the panes where they are by default.
    pub(super) fn reset_layout(&mut self) {
        self.settings.reset_layout();
        self.panes.states.stage.forget_large();
    }
}
