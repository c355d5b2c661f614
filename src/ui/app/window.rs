//! The window's state, and a frame of it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::mpsc::Receiver;

use eframe::egui::{self, Align, CentralPanel, Frame, Label, Layout, Margin, Panel, RichText, TextStyle, Ui};
use eframe::egui_wgpu::RenderState;
use motionscope_core::base::Error;
use motionscope_core::run::{Cursor, Direction, Move};
use motionscope_core::scene::{Chart, Role, Step};

use crate::experiment::side_by_side::SideBySide;
use crate::experiment::source::Source;
use crate::paint::charts::relief::standing;
use crate::ui::app::camera::Recorder;
use crate::ui::app::present::Presentation;
use crate::ui::app::{focus, keys};
use crate::ui::commands::{Action, Actions, Browse, Granularities, Owner, Situation};
use crate::ui::dialogs::{
    camera, chooser, compare, find, gallery, lessons, open as open_dialog, palette, save as save_dialog, sheet, terms,
};
use crate::ui::drawing::style::{self, ZOOM};
use crate::ui::layout::{self, Arrangement, Folded, LessonPage, Mode, Pictures, Room};
use crate::ui::model::document::Document;
use crate::ui::model::lesson::OpenLesson;
use crate::ui::model::loader::Loading;
use crate::ui::model::player::Player;
use crate::ui::model::predict::Predict;
use crate::ui::model::previews::Previews;
use crate::ui::model::settings::Settings;
use crate::ui::model::trail::Trail;
use crate::ui::model::walker::{View, Walker};
use crate::ui::model::writer::Writing;
use crate::ui::panes::{Panes, States};
use crate::ui::panes::{question, start, status, topbar, transport};
use crate::ui::parts::toasts::Toasts;
use crate::ui::stage;
use crate::view::panes::{Pane, charts};

/// The key under which is stored how the panes are looked at.
const STATES: &str = "panes";

/// What lies over the panes.
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
    /// What the program is.
    About,
}

/// A part of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// The start page, instead of all panes.
    Start,
    /// The line at the top.
    Header,
    /// The pictures with what stands around them.
    Stage,
    /// A picture.
    Pictures,
    /// A chart.
    Chart,
    /// The whole explanation.
    Explanation,
    /// Sentence and formula.
    Strip,
    /// The page of a lesson.
    Lesson,
    /// The parameters.
    Parameters,
    /// Steps, play and timeline.
    Transport,
    /// The question about the next result.
    Question,
    /// The line at the bottom.
    Status,
}

/// The window.
pub struct App {
    pub(super) settings: Settings,
    pub(super) document: Document,
    pub(super) walker: Walker,
    pub(super) view: View,
    pub(super) player: Player,
    /// The questions about the next result.
    pub(super) predict: Predict,
    pub(super) question: question::State,
    pub(super) loading: Option<Loading>,
    pub(super) error: Option<Error>,
    /// The session or lesson that the user is asked to trust, as it was to be opened, while the error says so.
    pub(super) asked: Option<OsString>,
    pub(super) overlay: Overlay,
    pub(super) toasts: Toasts,
    pub(super) states: States,
    /// The start page while it is shown.
    pub(super) start: Option<start::State>,
    /// The pictures of the samples.
    pub(super) previews: Previews,
    /// The pages that links led away from.
    pub(super) trail: Trail,
    /// Whether what a new user has tried can be remembered: else a hint would come again at each start.
    can_remember: bool,
    /// What it is presented with.
    pub(super) presentation: Presentation,
    /// The lesson that is open.
    pub(super) lesson: Option<OpenLesson>,
    /// A path that the system's dialog will deliver.
    pub(super) browsing: Option<(Browse, Receiver<Option<PathBuf>>)>,
    /// What is being written.
    pub(super) writing: Option<Writing>,
    /// The cameras, and what was recorded last.
    pub(super) recorder: Recorder,
    /// The estimators that were last in lockstep.
    pub(super) side_by_side: SideBySide,
    /// Where was written last.
    pub(super) folder: Option<PathBuf>,
    /// The interface that egui was told last.
    styled: Option<style::Interface>,
    /// When the run was played on last.
    played: f64,
    /// The last step of a page that playback may pass with the step that it is taking.
    approached: Option<Cursor>,
    /// Where everything lay in the last frame.
    regions: Vec<(Region, egui::Rect)>,
    /// The panes of the last frame.
    pub(super) arranged: Arrangement,
    pub(super) ctx: egui::Context,
}

impl App {
    /// A window in `ctx` with what was remembered.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(ctx: &egui::Context, storage: Option<&dyn eframe::Storage>) -> std::io::Result<Self> {
        let mut settings = Settings::load(storage);
        settings.leave_end();
        style::install_fonts(ctx);
        let interface = settings.interface(ctx.content_rect().size() * ctx.zoom_factor());
        style::apply(ctx, interface);
        let repaint = ctx.clone();
        let player = Player::at_speed(settings.speed);
        let states: States = storage.and_then(|storage| eframe::get_value(storage, STATES)).unwrap_or_default();
        Ok(Self {
            styled: Some(interface),
            settings,
            document: Document::default(),
            walker: Walker::new(move || repaint.request_repaint())?,
            view: View::default(),
            player,
            predict: Predict::default(),
            question: question::State::default(),
            loading: None,
            error: None,
            asked: None,
            overlay: Overlay::None,
            toasts: Toasts::default(),
            states,
            start: None,
            previews: Previews::default(),
            trail: Trail::default(),
            can_remember: storage.is_some(),
            presentation: Presentation::default(),
            lesson: None,
            browsing: None,
            writing: None,
            recorder: Recorder::default(),
            side_by_side: SideBySide::default(),
            folder: None,
            played: 0.0,
            approached: None,
            regions: Vec::new(),
            arranged: Arrangement::default(),
            ctx: ctx.clone(),
        })
    }

    /// What is open and how it is set.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// What the run is presented with.
    pub fn presentation(&self) -> &Presentation {
        &self.presentation
    }

    /// What the walker shows and does.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// What the window remembers.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The role whose marks alone are shown on the stage.
    pub fn lit(&self) -> Option<Role> {
        self.states.stage.lit()
    }

    /// Share of what is being written that is done, from 0 to 1.
    pub fn written(&self) -> Option<f32> {
        self.writing.as_ref().map(|writing| writing.work.fraction())
    }

    /// The questions about the next result.
    pub fn predict(&self) -> &Predict {
        &self.predict
    }

    /// The newest message, if one is shown.
    pub fn message(&self) -> Option<&str> {
        self.toasts.last()
    }

    /// What went wrong and was not read yet.
    pub fn error(&self) -> Option<&Error> {
        self.error.as_ref()
    }

    /// Waits until nothing is worked on any more, for tests; what was found is shown in the next frame.
    pub fn wait(&mut self) {
        while self.loading.is_some() || self.writing.is_some() {
            std::thread::sleep(std::time::Duration::from_millis(2));
            self.receive();
        }
        while !self.walker.wait_for(std::time::Duration::from_millis(20)) {
            self.walker.tend();
        }
        self.receive();
    }

    /// Whether everything that was asked for is there and shown.
    pub fn is_settled(&self) -> bool {
        let pictured = match &self.overlay {
            Overlay::Samples => self.previews.is_complete(),
            Overlay::Chooser(_) => self.previews.steps.is_complete(),
            Overlay::Compare(state) => state.is_settled(),
            Overlay::Save(state) => state.is_settled(),
            _ => self.start.is_none() || self.previews.is_complete() && self.previews.steps.is_complete(),
        };
        pictured && self.loading.is_none() && self.writing.is_none() && !self.view.busy && !self.view.checking
    }

    /// Whether there is a picture of a step of the estimator `id`.
    pub fn has_picture_of(&self, id: &str) -> bool {
        self.previews.steps.has(id)
    }

    /// Where everything lay in the last frame, in points.
    pub fn regions(&self) -> &[(Region, egui::Rect)] {
        &self.regions
    }

    /// Size of the window in points at an interface scale of 1.
    fn size(&self) -> egui::Vec2 {
        self.ctx.content_rect().size() * self.ctx.zoom_factor()
    }

    /// What is folded away just now.
    pub fn folded(&self) -> Folded {
        self.settings.folded()
    }

    /// Looks how much room there is, and shares it out anew where that has changed.
    fn measure(&mut self, ctx: &egui::Context) {
        let type_pt = self.settings.look.theme.sizes().body;
        let window = ctx.content_rect().size();
        let is_lecture = self.settings.lecture
            || self.presentation.is_on
            || self.settings.look.theme == crate::paint::Theme::Projector;
        self.settings.mode =
            Some(if self.presentation.is_on { Mode::Presenting } else { Mode::of(window, type_pt, is_lecture) });
        self.settings.is_narrow = !self.room(egui::Rect::NOTHING, window).has_docked_parameters();
    }

    /// The names of the ladder's granularities.
    pub(super) fn granularities(&self) -> Granularities {
        Granularities::new(self.document.side_by_side().info(self.document.estimator()).granularities)
    }

    /// Why there is no run of what is set now, if there is none.
    fn refused(&self) -> Option<&Error> {
        self.view.refused.as_ref().or(self.document.refused())
    }

    /// Whether a larger interface fits into the window.
    fn can_be_larger(&self) -> bool {
        let larger = (self.settings.seen_zoom(self.ctx.zoom_factor()) + ZOOM.2) * self.mode().zoom();
        let type_pt = self.settings.look.theme.sizes().body;
        let fits = || layout::zoom_that_fits(larger, self.size(), type_pt, self.mode()) >= larger;
        self.settings.interface(self.size()).zoom < ZOOM.1 && fits()
    }

    /// What is the case just now.
    pub(super) fn now(&self) -> Situation {
        if self.start.is_some() {
            // What is below the page is not seen, so nothing is done to it.
            let (can_be_larger, has_trail) = (self.can_be_larger(), self.trail.last().is_some());
            return Situation { can_be_larger, has_trail, at_start_page: true, ..Situation::default() };
        }
        let shown = self.view.shown.as_deref();
        let (last, folded) = (self.document.last_frame(), self.folded());
        let [can_undo, can_redo] = self.ink_history().unwrap_or([self.document.can_undo(), self.document.can_redo()]);
        Situation {
            has_clip: self.document.clip().is_some(),
            has_pictures: self.document.clip().is_some_and(|clip| !clip.is_blank())
                && matches!(self.document.source(), Some(Source::File(_) | Source::Pair(_))),
            has_run: shown.is_some() && self.refused().is_none(),
            at_start: shown.is_none_or(|shown| shown.cursor == motionscope_core::run::Cursor::default()),
            at_end: shown.is_some_and(|shown| shown.at_end),
            busy: self.view.busy,
            checking: self.view.checking,
            playing: self.player.is_playing(),
            lecture: self.settings.lecture,
            shows_parameters: !folded.parameters,
            shows_explanation: !folded.explanation,
            shows_charts: !folded.charts,
            has_open_parameters: self.settings.is_narrow && !folded.parameters,
            has_charts: !folded.charts && !self.charts().is_empty(),
            has_landscape: self.settings.look.landscape || shown.is_some_and(|shown| standing(&shown.step).is_some()),
            has_large_picture: self.arranged.stage.is_some() && self.arranged.panes.has_large(),
            has_enlarged: self.settings.charts.is_enlarged
                && self.regions.iter().all(|(region, _)| *region != Region::Stage),
            can_be_larger: self.can_be_larger(),
            in_lockstep: !self.document.side_by_side().is_empty(),
            has_stage: !motionscope_core::run::stage::stages(self.document.estimator()).is_empty(),
            in_stage: self.document.parents().len() > 0,
            is_placing: self.states.stage.placing.is_some(),
            holds_pixel: shown.and_then(|shown| shown.pointed).is_some_and(|pointed| pointed.is_held),
            available: shown.map(|shown| shown.available).unwrap_or_default(),
            look: self.settings.look,
            reduced_motion: self.settings.reduced_motion,
            can_undo,
            can_redo,
            is_drawing: self.presentation.pen.is_on,
            has_ink: !self.ink().is_empty(),
            has_loupe: self.presentation.has_loupe,
            is_pointing: self.presentation.is_pointing,
            is_presenting: self.presentation.is_on,
            is_blank: self.presentation.is_blank,
            is_tuned: self.document.is_tuned(Owner::Estimator),
            asks: self.predict.is_on(),
            is_asked: self.predict.open().is_some(),
            is_answered: self.predict.last().is_some_and(|open| open.verdict().is_some()),
            has_scores: !self.predict.scores().is_empty(),
            in_lesson: self.lesson.is_some(),
            at_first_page: self.lesson.as_ref().is_some_and(|open| open.is_at(Direction::Back)),
            lesson_goes_on: self.lesson.as_ref().is_some_and(OpenLesson::goes_on),
            at_last_page: self.lesson.as_ref().is_some_and(|open| open.is_at(Direction::Forward)),
            has_trail: self.trail.last().is_some(),
            at_start_page: false,
            at_first_frame: self.document.frame() == 0,
            at_last_frame: last.is_some_and(|last| self.document.frame() >= last),
        }
    }

    /// Lets the time since the last frame pass for the player.
    fn play(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|i| i.time);
        let seconds = now - std::mem::replace(&mut self.played, now);
        let granularities = self.granularities().names().len();
        if self.returns_to_page() {
            return;
        }
        let Some(shown) = self.view.shown.as_deref().filter(|_| self.player.is_playing()) else { return };
        let is_over = match self.player.plays(Direction::Back) {
            true => shown.cursor == Cursor::default(),
            false => shown.at_end,
        };
        if is_over && !self.view.busy {
            self.player.pause();
            return;
        }
        let end = self.end_of_page();
        let is_at_end = end.is_some_and(|end| order(shown.cursor) == order(end));
        if self.player.plays(Direction::Forward) && is_at_end && !self.view.busy {
            self.player.pause();
            return;
        }
        self.player.pass(seconds);
        if !self.view.busy
            && let Some(to) = self.player.due((shown.cursor, shown.events), granularities)
        {
            // A page of a lesson is played up to its last step.
            let is_before = |end: &Cursor| self.player.plays(Direction::Forward) && order(shown.cursor) < order(*end);
            let end = end.filter(is_before);
            let to = match (end, to) {
                (Some(end), Move::To(cursor)) if order(cursor) > order(end) => Move::To(end),
                (_, to) => to,
            };
            // Where a level or a warp ends is known once the run stands there.
            self.approached = end.filter(|_| matches!(to, Move::Granularity(..)));
            let asks = self.predict.is_on() && self.player.plays(Direction::Forward);
            if asks {
                self.expect_question();
            }
            // One step at a time, or questions would be passed over.
            self.walker.go(if asks { Move::Granularity(granularities - 1, Direction::Forward) } else { to });
        }
        // The walker wakes the window when it is done.
        if !self.view.busy {
            ctx.request_repaint_after_secs(self.player.wait_secs() as f32);
        }
    }

    /// Goes back to the last step of a page where playback has passed it by a level or a warp; returns whether it does.
    fn returns_to_page(&mut self) -> bool {
        if self.player.is_playing() && self.view.busy {
            return false;
        }
        let end = self.approached.take().filter(|_| self.player.is_playing());
        let at = self.view.shown.as_deref().map(|shown| shown.cursor);
        let Some(end) = end.filter(|end| at.is_some_and(|at| order(at) > order(*end))) else { return false };
        self.player.pause();
        self.walker.go(Move::To(end));
        true
    }

    fn panels(&mut self, ui: &mut Ui, gpu: Option<&RenderState>, actions: &mut Actions) {
        let is_lecture = self.mode().is_lecture();
        let bar = |x, y| Frame::new().inner_margin(Margin::symmetric(x, y));
        let top = if is_lecture { 4 } else { 6 };
        let mut regions = Vec::new();
        if self.presentation.is_on {
            // For the class there is nothing but stage, chart and caption.
            self.progress_line(ui);
            self.toasts.show_description(ui, bar(12, 6), self.settings.look.theme);
            CentralPanel::no_frame().show(ui, |ui| self.body(ui, gpu, actions, &mut regions));
            self.regions = regions;
            return;
        }
        let header = Panel::top("menus").frame(bar(12, top)).show(ui, |ui| self.top_bar(ui, actions));
        regions.push((Region::Header, header.response.rect));
        if !is_lecture {
            let status = Panel::bottom("status").frame(bar(16, 2)).show(ui, |ui| self.status(ui, actions));
            regions.push((Region::Status, status.response.rect));
        }
        let height = (ui.spacing().interact_size.y * 1.65).round();
        let transport = Panel::bottom("transport").frame(bar(12, 2)).exact_size(height + 4.0);
        let transport = transport.show(ui, |ui| self.transport(ui, actions));
        regions.push((Region::Transport, transport.response.rect));
        self.toasts.show_description(ui, bar(12, 6), self.settings.look.theme);
        CentralPanel::no_frame().show(ui, |ui| self.body(ui, gpu, actions, &mut regions));
        self.regions = regions;
    }

    /// The step that is explained, and the charts of its estimator.
    fn explained(&self) -> Option<(&Step, &'static [Chart])> {
        let shown = self.view.shown.as_deref()?;
        let (experiment, explained) = (&shown.subject.experiment, self.states.explained_of(shown));
        let step = shown.tiles.get(explained).map_or(&shown.step, |tile| &tile.step);
        let beside = explained.checked_sub(1).and_then(|i| experiment.side_by_side.beside.get(i));
        Some((step, beside.map_or(&experiment.estimator, |companion| &companion.estimator).charts()))
    }

    /// The charts of the step that is explained.
    pub(super) fn charts(&self) -> Vec<&'static Pane> {
        self.explained().map_or_else(Vec::new, |(step, of)| charts(step, of))
    }

    /// The mode of the window as it is.
    fn mode(&self) -> Mode {
        self.settings.mode.unwrap_or(Mode::Working)
    }

    /// The pictures on the stage just now.
    fn pictures(&self) -> Pictures {
        let theme = self.settings.look.theme;
        let tools_pt = (!self.presentation.is_on).then(|| self.ctx.global_style().spacing.interact_size.y);
        let line = stage::line_height(theme, tools_pt);
        let Some(shown) = self.view.shown.as_deref() else { return Pictures { line, ..Pictures::default() } };
        let stands = shown.stands(shown.subject.experiment.estimator.shows_frame_alone());
        let (pictures, look, tiles) = (&shown.pictures, self.settings.look, shown.tiles.len());
        stage::pictures(stage::OnStage { pictures, look, stands, tiles }, theme, line)
    }

    /// The room between header and transport, for panes of what is shown.
    fn room(&self, body: egui::Rect, window: egui::Vec2) -> Room {
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
            page: self.lesson.as_ref().map(|open| LessonPage {
                height: self.states.lesson.needed(),
                is_read: self.view.shown.as_deref().is_some_and(|shown| open.has_left(shown)),
            }),
            question: self.asking(),
            // A chart is hidden during a question, and the pictures may have to be clicked.
            is_enlarged: self.settings.charts.is_enlarged && self.predict.open().is_none(),
            prefers_chart: self.settings.charts.is_preferred,
            told: if is_brief { self.states.strip.height() } else { self.states.explanation.formula_end() },
            shares: self.settings.shares,
        }
    }

    fn top_bar(&self, ui: &mut Ui, actions: &mut Actions) {
        let (frame, id) = (self.document.frame(), self.document.estimator().info().id);
        // In lockstep the info of the run names the lockstep, so that of the experiment counts.
        let shown = self.view.shown.as_deref().filter(|shown| {
            let of = &shown.subject.experiment;
            of.frame == frame && of.estimator.info().id == id
        });
        let input = topbar::Input {
            document: &self.document,
            at_frame: shown.map(|shown| shown.frame),
            place: shown.and_then(status::nested_place),
            now: self.now(),
            granularities: self.granularities(),
            has_strip: self.has_strip(),
            recent: &self.settings.recent,
        };
        topbar::show(ui, &input, actions);
    }

    /// Whether the line at the top has the parameters that matter most: where they have no place of their own, and neither a lesson nor an
    /// error is read.
    fn has_strip(&self) -> bool {
        let has_error = self.error.is_some() || self.refused().is_some();
        self.settings.is_narrow && self.folded().parameters && self.lesson.is_none() && !has_error
    }

    fn transport(&self, ui: &mut Ui, actions: &mut Actions) {
        let input = transport::Input {
            shown: self.view.shown.as_deref(),
            now: self.now(),
            granularities: self.granularities(),
            player: self.player,
            has_hint: self.can_remember && !self.settings.practice.is_over(),
            theme: self.settings.look.theme,
        };
        transport::show(ui, &input, actions);
    }

    fn status(&self, ui: &mut Ui, actions: &mut Actions) {
        let small = TextStyle::Small.resolve(ui.style());
        let dim = ui.visuals().weak_text_color();
        ui.horizontal(|ui| {
            ui.set_min_height(small.size + 8.0);
            if let Some(work) = status::work(&self.view) {
                status::progress(ui, &work, actions);
                return;
            }
            if let Some(writing) = &self.writing {
                match writing.work.fraction() {
                    0.0 => drop(ui.spinner()),
                    done => drop(ui.add(egui::ProgressBar::new(done).desired_width(120.0).desired_height(6.0))),
                }
                ui.label(RichText::new("Saving…").small());
                if ui.add(egui::Button::new(RichText::new("Cancel").small()).small()).clicked() {
                    actions.ask(Action::CancelWriting);
                }
            }
            let nothing = || if self.document.clip().is_some() { "No run" } else { "No clip is open" }.to_owned();
            let text = self.view.shown.as_deref();
            let text = text.map_or_else(nothing, |shown| status::line(shown, self.predict.is_on()));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.available_width() > 70.0 * small.size {
                    let keys = status::keys(self.granularities());
                    ui.label(RichText::new(keys).small().color(dim));
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(Label::new(RichText::new(text).small().color(dim)).truncate());
                });
            });
        });
    }

    fn body(
        &mut self,
        ui: &mut Ui,
        gpu: Option<&RenderState>,
        actions: &mut Actions,
        regions: &mut Vec<(Region, egui::Rect)>,
    ) {
        self.states.stage.begin_frame();
        let of_step = self.charts();
        let room = self.room(ui.max_rect(), ui.ctx().content_rect().size());
        // In a long run the marks of the frames in between must not lag behind their pictures.
        let is_on_its_way = self.view.progress.is_some();
        let calm = self.settings.reduced_motion || self.player.is_playing() || is_on_its_way;
        let mut panes = Panes {
            document: &self.document,
            view: &self.view,
            loading: self.loading.as_ref(),
            error: self.error.as_ref(),
            asks_for_trust: self.asks_for_trust(),
            states: &mut self.states,
            of_step,
            charts: &mut self.settings.charts,
            shares: &mut self.settings.shares,
            animate: !calm && !ui.input(|i| i.pointer.any_down()),
            can_be_closed: self.settings.is_narrow,
            has_no_status: room.mode.is_lecture(),
            flows: !self.settings.reduced_motion,
            is_asked: self.predict.open().is_some(),
            asks: self.predict.is_on(),
            gpu,
            presented: self.presentation.presented(),
            look: &mut self.settings.look,
            actions,
        };
        // They take from the room of everything, and lie over no picture.
        panes.banners(ui);
        let all = room.in_body(ui.available_rect_before_wrap()).arrange();
        panes.show(ui, &all);
        if let Some(page) = all.page {
            self.lesson_page(ui, page, actions);
        }
        if let Some(question) = all.question {
            self.question_pane(ui, question, actions);
        }
        self.states.stage.end_frame(ui.ctx());
        let told = if all.strip.is_some() { Region::Strip } else { Region::Explanation };
        let single = [
            (Region::Stage, all.stage),
            (told, all.told),
            (Region::Lesson, all.page),
            (Region::Question, all.question),
        ];
        let single = single.into_iter().chain([(Region::Parameters, all.parameters)]);
        regions.extend(single.filter_map(|(region, rect)| Some((region, rect?))));
        regions.extend(all.charts.iter().map(|rect| (Region::Chart, *rect)));
        if all.stage.is_some() {
            regions.extend(self.states.stage.pictures().map(|rect| (Region::Pictures, rect)));
        }
        self.arranged = all;
        // What was chosen on the stage is shown as soon as it is made.
        self.walker.look(&self.settings.look);
    }

    fn overlays(&mut self, ctx: &egui::Context, actions: &mut Actions) {
        let theme = self.settings.look.theme;
        let mut overlay = std::mem::take(&mut self.overlay);
        let open = match &mut overlay {
            Overlay::None => false,
            Overlay::Palette(state) => {
                let (now, granularities, recent) = (self.now(), self.granularities(), self.settings.recent.as_slice());
                let estimator = self.document.estimator().info().id;
                let input = palette::Input { now, granularities, estimator, recent, theme };
                let (chosen, open) = palette::show(ctx, state, &input);
                actions.0.extend(chosen);
                open
            }
            Overlay::Chooser(state) => chooser::show(ctx, state, &mut self.previews.steps, theme, actions),
            Overlay::Find(state) => find::show(ctx, state, theme, actions),
            Overlay::Glossary(state) => terms::show(ctx, state),
            Overlay::Shortcuts => sheet::shortcuts(ctx, &self.granularities(), theme),
            Overlay::Open(state) => open_dialog::show(ctx, state, &self.settings.recent, actions),
            Overlay::Save(state) => save_dialog::show(ctx, state, self.granularities(), actions),
            Overlay::Camera(state) => camera::show(ctx, state, (&self.document, &mut self.settings), actions),
            Overlay::Compare(state) => compare::show(ctx, state, &self.document, &self.settings.look, actions),
            Overlay::Lessons(state) => lessons::show(ctx, state, theme, actions),
            Overlay::Samples => {
                let plays = !self.settings.reduced_motion;
                gallery::show(ctx, &mut self.previews, gallery::Input { theme, plays }, actions)
            }
            Overlay::About => sheet::about(ctx),
        };
        if open {
            self.overlay = overlay;
        }
    }

    /// Whether something lies over the panes.
    pub(super) fn is_covered(&self) -> bool {
        !matches!(self.overlay, Overlay::None)
    }

    /// Where a region lies, if it is there.
    fn region(&self, of: Region) -> Option<egui::Rect> {
        self.regions.iter().find(|(region, _)| *region == of).map(|(_, rect)| *rect)
    }

    /// The lower left corner of messages, and their width. They lie over no picture: on the chart, which is seen again when they go, or
    /// else on the words, or above the transport.
    fn place_of_messages(&self, content: egui::Rect) -> (egui::Pos2, f32) {
        use Region::{Chart, Explanation, Lesson, Parameters, Question, Strip, Transport};
        let of = [Chart, Strip, Explanation, Parameters, Lesson, Question, Transport];
        let place = of.into_iter().find_map(|region| self.region(region)).unwrap_or(content);
        let gap = egui::vec2(12.0, -8.0);
        (place.left_bottom() + gap, place.width() - 2.0 * gap.x)
    }

    /// Says that what is held over the window can be dropped.
    fn drop_hint(&self, ui: &Ui) {
        if ui.input(|i| i.raw.hovered_files.is_empty()) {
            return;
        }
        let chrome = self.settings.look.theme.chrome();
        let rect = ui.max_rect();
        let painter = ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
        painter.rect_filled(rect, 0.0, style::color(chrome.background.alpha(215)));
        let edge = egui::Stroke::new(2.0, style::color(chrome.accent));
        painter.rect_stroke(rect.shrink(16.0), 12.0, edge, egui::StrokeKind::Inside);
        let font = TextStyle::Heading.resolve(ui.style());
        let text = "Drop a clip, two pictures, a folder of pictures or a session";
        painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, style::color(chrome.text));
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let mut actions = Actions::default();
        self.receive();
        self.follow_lesson();
        self.play(&ctx);
        self.measure(&ctx);
        let overlaid = self.is_covered();
        if !overlaid && self.start.is_none() && !self.presentation.is_blank {
            focus::travel(&ctx, &self.regions);
        }
        keys::take(&ctx, overlaid, &self.now(), &mut actions);
        // The window is cleared in this colour; where the card takes that for a linear one, or there is none, it is filled.
        if frame.wgpu_render_state().is_none_or(|card| card.target_format.is_srgb()) {
            ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
        }
        match self.start {
            Some(_) => {
                self.regions = vec![(Region::Start, ui.max_rect())];
                self.start_page(ui, &mut actions);
            }
            None => self.panels(ui, frame.wgpu_render_state(), &mut actions),
        }
        self.presenter_window(&ctx, &mut actions);
        self.overlays(&ctx, &mut actions);
        self.previews.settle(&ctx);
        let place = self.place_of_messages(ctx.content_rect());
        self.toasts.show(&ctx, place, self.settings.look.theme);
        focus::ring(&ctx, self.settings.look.theme);
        self.drop_hint(ui);
        self.show_pointer(&ctx);
        self.show_blank(&ctx);
        for action in actions.0 {
            self.act(action);
        }
        let view = self.walker.view();
        if view.busy {
            // That it takes long, or ends, is seen even if nobody says so.
            ctx.request_repaint_after(if view.stopping { status::SOON } else { status::LATE });
        }
        let interface = self.settings.interface(self.size());
        if self.styled.replace(interface) != Some(interface) {
            style::apply(&ctx, interface);
            ctx.request_repaint();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.note_place();
        // What a page sets is not how the person looks at pictures.
        let look = self.settings.look;
        if let Some(open) = &self.lesson {
            self.settings.look = open.without_page(look);
        }
        self.settings.save(storage);
        self.settings.look = look;
        eframe::set_value(storage, STATES, &self.states);
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

/// Which of two cursors of a run comes first.
fn order(cursor: Cursor) -> (usize, usize) {
    (cursor.unit, cursor.event)
}

/// The title of the window.
pub(super) fn title(document: &Document) -> String {
    match document.clip() {
        Some(clip) => format!("{} – Motionscope", clip.info().name),
        None => "Motionscope".into(),
    }
}
