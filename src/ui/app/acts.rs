//! What the window does when it is told to.

use eframe::egui::ViewportCommand;
use motionscope_core::compare::changed_alike;
use motionscope_core::{AnyEstimator, Cursor, Direction, Error, Move, Params, estimator, stage};

use crate::experiment::comparison::Row;
use crate::experiment::side_by_side::SideBySide;
use crate::paint::{FlowLayer, Phase, Theme, View};
use crate::ui::app::action::Action;
use crate::ui::app::commands::Command;
use crate::ui::app::window::{App, Overlay};
use crate::ui::dialogs::save::Kind;
use crate::ui::dialogs::{compare, open as open_dialog, palette};
use crate::ui::drawing::style::ZOOM;
use crate::ui::model::document::Owner;
use crate::ui::model::snapshot::Place;
use crate::ui::panes::layout;

/// How much larger the picture gets at each press of a key.
const ZOOM_STEP: f32 = 1.5;

impl App {
    /// Does what was asked for.
    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::Command(command) => self.command(command),
            Action::Open(name) => self.open(name),
            Action::Type(Command::Palette, text) => self.overlay = Overlay::Palette(palette::State::asking(text)),
            Action::Type(_, text) => self.overlay = Overlay::Open(open_dialog::State::asking(text)),
            Action::OpenSample(sample) => self.open_sample(sample),
            Action::CancelOpening => self.loading = None,
            Action::Browse(wanted) => self.browse(wanted),
            Action::Write(order) => self.write(*order),
            Action::CancelWriting => self.writing.iter().for_each(|writing| writing.work.cancel()),
            Action::Choose(id) => self.choose(id),
            Action::Visit(row) => self.visit(&row),
            Action::Lockstep(ids) => self.lockstep(&ids),
            Action::Pace(pace) => {
                let side_by_side = SideBySide { pace, ..self.document.side_by_side().clone() };
                self.keep_company(self.document.estimator().boxed_clone(), side_by_side);
            }
            Action::Set(owner, index, value) => {
                if let Err(error) = self.document.set(owner, index, value) {
                    self.toasts.fail(error.to_string());
                }
                self.restart();
            }
            Action::Enter(index) => self.enter(index),
            Action::Settle => self.document.settle(),
            Action::Place(index) => self.states.stage.placing = index,
            Action::ResetAll(owner) => {
                self.document.reset(owner);
                self.restart();
            }
            Action::Seek(cursor) => {
                self.player.pause();
                self.walker.go(Move::To(cursor));
            }
            Action::SeekAt(focus, side) => {
                self.player.pause();
                let shown = self.view.shown.as_ref();
                if let Some(first) = shown.and_then(|shown| shown.elsewhere(focus.on)) {
                    let (clicked, first) = (focus.on.title(None), first.title(None).to_lowercase());
                    self.toasts
                        .tell(format!("{clicked} has no pixels to be explained at this step: click on {first}."));
                    return;
                }
                self.walker.go_at(focus, side);
            }
            Action::Focus(focus) => self.walker.focus(focus),
            Action::Release => self.walker.release(),
            Action::Frame(frame) => self.go_to_frame(frame),
            Action::Speed(speed) => {
                self.player.speed = speed;
                self.settings.speed = speed;
            }
            Action::Dismiss => self.error = None,
        }
    }

    /// Does what a command says, if it makes sense just now.
    pub fn command(&mut self, command: Command) {
        use Command as C;
        if !command.enabled(&self.now()) {
            return;
        }
        match command {
            C::Open => self.overlay = Overlay::Open(open_dialog::State::default()),
            C::PastePath => self.ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            C::Compare => {
                self.overlay = Overlay::Compare(Box::new(compare::State::new(self.document.estimator().info().id)))
            }
            C::Lockstep => self.toggle_lockstep(),
            C::Samples => self.overlay = Overlay::Samples,
            C::Palette => self.overlay = Overlay::Palette(palette::State::default()),
            C::Shortcuts => self.overlay = Overlay::Shortcuts,
            C::About => self.overlay = Overlay::About,
            C::Quit => self.ctx.send_viewport_cmd(ViewportCommand::Close),
            C::SaveSession => self.save_as(Kind::Session),
            C::ExportPicture => self.save_as(Kind::Picture),
            C::ExportSteps => self.save_as(Kind::Steps),
            C::ExportResult => self.save_as(Kind::Result),
            C::IntoStage => {
                if let Some(index) = stage::stages(self.document.estimator()).first() {
                    self.enter(*index);
                }
            }
            C::OutOfStage => self.leave(),
            C::Undo | C::Redo | C::ResetParameters => self.edit(command),
            C::SideBySide | C::FrameT | C::FrameNext | C::Difference | C::Blend | C::Blink => self.choose_look(command),
            C::Prediction | C::Residual => self.choose_look(command),
            C::NoLayer | C::WheelLayer | C::MagnitudeLayer => self.choose_look(command),
            C::ErrorLayer | C::ConfidenceLayer | C::ConsistencyLayer => self.choose_look(command),
            C::DarkTheme | C::LightTheme | C::ProjectorTheme => self.choose_look(command),
            C::ViridisColors | C::TurboColors => self.choose_look(command),
            C::FittingArrows | C::TrueArrows | C::DoubleArrows | C::FourfoldArrows => self.choose_look(command),
            C::NextTheme => self.next_theme(),
            C::NextLayer => self.next_layer(),
            C::Streaks => {
                let look = &mut self.settings.look;
                look.streaks = look.streaks.is_none().then(Phase::default);
            }
            C::ZoomIn | C::ZoomOut | C::Fit | C::ActualSize => self.zoom(command),
            C::LargerInterface | C::SmallerInterface | C::NormalInterface => self.resize(command),
            C::ShowParameters | C::ShowWhy | C::ShowCharts | C::Lecture | C::ResetLayout => self.arrange(command),
            C::FullScreen => {
                let now = self.ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                self.ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!now));
            }
            C::ReducedMotion => self.settings.reduced_motion = !self.settings.reduced_motion,
            C::Play if self.player.is_playing() => self.player.pause(),
            C::Play => {
                if self.now().at_end {
                    self.walker.go(Move::To(Cursor::default()));
                }
                self.player.play();
            }
            C::Slower | C::Faster => {
                self.player.shift(command == C::Faster);
                self.settings.speed = self.player.speed;
            }
            C::NextFrame => self.go_to_frame(self.document.frame() + 1),
            C::PreviousFrame => self.go_to_frame(self.document.frame().saturating_sub(1)),
            C::Stop => {
                self.player.pause();
                self.walker.stop();
            }
            C::Into | C::IntoBack | C::Over | C::OverBack | C::Out | C::OutBack => self.step(command),
            C::NextUnit | C::PreviousUnit | C::Start | C::End => self.step(command),
        }
    }

    fn step(&mut self, command: Command) {
        use Command as C;
        self.player.pause();
        let granularities = self.granularities();
        let (granularity, way) = match command {
            C::Into => (granularities.event(), Direction::Forward),
            C::IntoBack => (granularities.event(), Direction::Back),
            C::Over | C::NextUnit => (granularities.unit(), Direction::Forward),
            C::OverBack | C::PreviousUnit => (granularities.unit(), Direction::Back),
            C::Out => (granularities.group(), Direction::Forward),
            C::OutBack => (granularities.group(), Direction::Back),
            C::Start => return self.walker.go(Move::To(Cursor::default())),
            _ => return self.walker.go(Move::End),
        };
        self.walker.go(Move::Granularity(granularity, way));
    }

    fn edit(&mut self, command: Command) {
        let before = self.document.estimator().info().id;
        let was_single = self.is_of_single_frames();
        match command {
            Command::Undo => drop(self.document.undo()),
            Command::Redo => drop(self.document.redo()),
            _ => self.document.reset(Owner::Estimator),
        }
        if self.document.estimator().info().id != before {
            self.states.stage.placing = None;
        }
        self.suit_view(was_single);
        self.restart();
    }

    /// Sets the entry of the look that is called `name`, from what a person would type.
    ///
    /// # Errors
    /// A sentence with what may be given; then nothing changes.
    pub fn set_look(&mut self, name: &str, value: &str) -> Result<(), Error> {
        self.settings.look.set(name, value)
    }

    /// Sets that entry of the look which `command` is for.
    fn choose_look(&mut self, command: Command) {
        let set = command.look().map_or(Ok(()), |(name, value)| self.set_look(name, value));
        set.unwrap_or_else(|error| self.toasts.fail(error.to_string()));
    }

    fn zoom(&mut self, command: Command) {
        let stage = &mut self.states.stage;
        let at_hand = self.view.shown.as_ref().and_then(|shown| shown.reference()).map(|focus| focus.at);
        match command {
            Command::ZoomIn => stage.magnify(ZOOM_STEP, at_hand),
            Command::ZoomOut => stage.magnify(1.0 / ZOOM_STEP, at_hand),
            Command::Fit => stage.fit(),
            _ => stage.one_to_one(self.ctx.pixels_per_point()),
        }
    }

    /// Takes the next of the layers that there are, or will be at the end of the run.
    fn next_layer(&mut self) {
        let Some(shown) = self.view.shown.as_deref() else { return };
        let look = &mut self.settings.look;
        let now = shown.available.chosen(look.layer);
        let mut round = FlowLayer::ALL.into_iter().cycle().skip_while(|layer| *layer != now).skip(1);
        look.layer = round.find(|layer| shown.available.why_never(*layer).is_none());
    }

    fn next_theme(&mut self) {
        let look = &mut self.settings.look;
        let round = Theme::ALL.into_iter().cycle().skip_while(|theme| *theme != look.theme).nth(1);
        look.theme = round.unwrap_or_default();
    }

    fn resize(&mut self, command: Command) {
        let (_, _, step) = ZOOM;
        let zoom = self.settings.zoom();
        match command {
            Command::LargerInterface => self.settings.set_zoom(zoom + step),
            Command::SmallerInterface => self.settings.set_zoom(zoom - step),
            _ => self.settings.set_zoom(1.0),
        }
    }

    fn arrange(&mut self, command: Command) {
        match command {
            Command::ShowParameters => self.settings.toggle(layout::Pane::Parameters),
            Command::ShowWhy => self.settings.toggle(layout::Pane::Why),
            Command::ShowCharts => self.settings.toggle(layout::Pane::Surface),
            Command::Lecture => self.settings.lecture = !self.settings.lecture,
            _ => self.settings.reset_layout(),
        }
    }

    fn choose(&mut self, id: &str) {
        match estimator(id) {
            Ok(chosen) => {
                let was_single = self.is_of_single_frames();
                let was_by_frame = self.document.estimator().is_by_frame();
                self.states.stage.placing = None;
                if self.document.parents().len() > 0 {
                    self.toasts.tell(format!("{} runs on the clip itself: the stage was left.", chosen.info().name));
                }
                self.document.choose(changed_alike(self.document.estimator(), chosen));
                self.suit_view(was_single);
                self.restart_from(was_by_frame);
            }
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Runs another estimator, from where that before it stands if its units are such as well: where they are frames, from the
    /// frame that is shown.
    fn restart_from(&mut self, was_by_frame: bool) {
        let place = match (was_by_frame, self.document.estimator().is_by_frame(), &self.view.shown) {
            (true, true, _) | (false, false, _) => return self.restart(),
            (false, true, Some(shown)) => {
                let unit = shown.frame.saturating_sub(self.document.frame());
                Place { cursor: Cursor { unit, event: usize::MAX }, ..Place::default() }
            }
            _ => Place::default(),
        };
        if let Some(job) = self.document.job_at(place) {
            self.walker.start(job);
        }
    }

    /// Walks a stage of the estimator by itself, where that stands.
    fn enter(&mut self, index: usize) {
        let Some(shown) = self.view.shown.clone().filter(|_| self.document.side_by_side().is_empty()) else { return };
        let was_single = self.is_of_single_frames();
        match self.document.enter(index, &shown) {
            Ok(place) => self.change_stage(place, was_single),
            Err(error) => self.toasts.fail(format!("The stage cannot be opened: {error}.")),
        }
    }

    /// Goes back to the estimator of which the one at work is a stage.
    fn leave(&mut self) {
        let was_single = self.is_of_single_frames();
        let place = self.document.leave();
        self.change_stage(place, was_single);
    }

    fn change_stage(&mut self, place: Option<Place>, was_single: bool) {
        let Some(place) = place else { return };
        self.player.pause();
        self.states.stage.placing = None;
        self.states.explained = 0;
        self.suit_view(was_single);
        if let Some(job) = self.document.job_at(place) {
            self.walker.start(job);
        }
    }

    /// Whether the estimator looks at single frames.
    pub(super) fn is_of_single_frames(&self) -> bool {
        self.document.estimator().is_of_single_frames()
    }

    /// Shows as many frames as the estimator speaks of, where another has taken the place of one that was of another kind:
    /// what looks at single frames has nothing to say of the next, all others need both.
    pub(super) fn suit_view(&mut self, was_single: bool) {
        let is_single = self.is_of_single_frames();
        let view = &mut self.settings.look.view;
        match (was_single, is_single, *view) {
            (false, true, Some(View::SideBySide)) => *view = Some(View::Current),
            (true, false, Some(View::Current)) => *view = Some(View::SideBySide),
            _ => {}
        }
    }

    /// Has the estimators called `ids` go in lockstep: that which is chosen leads if it is among them, else the first.
    fn lockstep(&mut self, ids: &[&str]) {
        let now = self.document.estimator();
        let pace = self.document.side_by_side().pace;
        let leader = ids.iter().find(|id| **id == now.info().id).or(ids.first());
        let side_by_side = || {
            let leader = changed_alike(now, estimator(leader.copied().unwrap_or_default())?);
            let others: Vec<_> = ids.iter().filter(|id| **id != leader.info().id).collect();
            let side_by_side = SideBySide::of(&*leader, &others, pace)?;
            Ok::<_, Error>((leader, side_by_side))
        };
        match side_by_side() {
            Ok((leader, side_by_side)) => self.keep_company(leader, side_by_side),
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Goes on with one estimator alone, or in lockstep with those of the last time.
    fn toggle_lockstep(&mut self) {
        let leader = self.document.estimator().boxed_clone();
        if !self.document.side_by_side().is_empty() {
            self.side_by_side = self.document.side_by_side().clone();
            return self.keep_company(leader, SideBySide::default());
        }
        let id = leader.info().id;
        let mut side_by_side = self.side_by_side.clone();
        side_by_side.beside.retain(|estimator| estimator.info().id != id);
        side_by_side.follow(&*leader);
        let side_by_side = if side_by_side.is_empty() {
            SideBySide::of(&*leader, &SideBySide::usual(id), side_by_side.pace)
        } else {
            side_by_side.check(&*leader).map(|()| side_by_side)
        };
        match side_by_side {
            Ok(side_by_side) => self.keep_company(leader, side_by_side),
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Has `leader` go on with `the estimators side by side`, or alone, from where it stands.
    fn keep_company(&mut self, leader: Box<dyn AnyEstimator>, side_by_side: SideBySide) {
        self.document.keep_company(leader, side_by_side);
        self.states.explained = 0;
        self.restart();
    }

    /// Goes to the first block that was missed, with the estimator that missed it.
    fn visit(&mut self, row: &Row) {
        if !self.document.side_by_side().is_empty() {
            self.side_by_side = self.document.side_by_side().clone();
        }
        self.document.keep_company(row.estimator.boxed_clone(), SideBySide::default());
        self.states.explained = 0;
        let unit = row.figures.first_missed_unit().unwrap_or(0);
        let place = Place { cursor: Cursor { unit, event: usize::MAX }, ..Place::default() };
        if let Some(job) = self.document.job_at(place) {
            self.walker.start(job);
        }
    }

    fn go_to_frame(&mut self, frame: usize) {
        if self.document.go_to_frame(frame) {
            self.restart();
        }
    }

    /// Runs again with what is set now, at the place that is shown.
    fn restart(&mut self) {
        if let Some(job) = self.document.job(self.view.shown.as_deref()) {
            self.walker.start(job);
        }
    }
}
