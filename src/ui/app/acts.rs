//! The execution of commands and actions.

use eframe::egui::ViewportCommand;
use motionscope_core::base::Error;
use motionscope_core::base::words::capital;
use motionscope_core::course::compare::changed_alike;
use motionscope_core::course::estimator;
use motionscope_core::params::Params;
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move, stage};

use crate::experiment::comparison::Row;
use crate::experiment::side_by_side::{Companion, SideBySide};
use crate::experiment::{told_of_unplaced, unplaced};
use crate::paint::{FlowLayer, Phase, Theme, View};
use crate::ui::app::window::{App, Overlay};
use crate::ui::commands::{Action, Command, Menu, Owner};
use crate::ui::dialogs::chooser::Purpose;
use crate::ui::dialogs::save::Kind;
use crate::ui::dialogs::{chooser, compare, find, lessons, open as open_dialog, palette, terms};
use crate::ui::drawing::style::ZOOM;
use crate::ui::layout;
use crate::ui::model::snapshot::Place;
use crate::ui::model::walker::Marks;

/// Zoom factor of a key press.
const ZOOM_STEP: f32 = 1.5;

impl App {
    /// Executes an action.
    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::Command(command) => self.command(command),
            Action::Open(name) => self.open(name),
            Action::OpenRightView(name) => self.open_right_view(name),
            Action::Type(Command::Palette, text, is_entered) => {
                self.overlay = Overlay::Palette(palette::State::asking(text, is_entered));
            }
            Action::Type(Command::SearchText, text, is_entered) => {
                self.overlay = Overlay::Find(find::State::asking(text, is_entered));
            }
            Action::Type(Command::Estimators, text, is_entered) => self.open_chooser(text, is_entered),
            Action::Type(_, text, _) => self.overlay = Overlay::Open(Box::new(open_dialog::State::asking(text))),
            Action::OpenSample(sample) => self.open_sample(sample),
            Action::OpenExample(id, example) => self.open_example(id, example),
            Action::OpenPage(address) => self.open_page(address),
            Action::Show(target) => self.show_found(target),
            Action::ShowAtStart(is_shown) => self.settings.has_start_page = is_shown,
            Action::OpenRecording(kept, estimator, ended) => self.open_recording(kept, estimator, ended),
            Action::CancelOpening => self.loading = None,
            Action::Browse(wanted) => self.browse(wanted),
            Action::Write(order) => self.write(*order),
            Action::CancelWriting => self.writing.iter().for_each(|writing| writing.work.cancel()),
            Action::Choose(id) => {
                if self.is_at_start() {
                    self.leave_start();
                }
                self.choose(id);
            }
            Action::ChooseBeside => {
                let state = chooser::State::new(&self.document, Purpose::Beside, "", false);
                self.overlay = Overlay::Chooser(Box::new(state));
            }
            Action::Visit(row) => self.visit(&row),
            Action::Lockstep(ids) => self.lockstep(&ids),
            Action::AddBeside(id) => self.add_beside(id),
            Action::RemoveBeside(index) => self.remove_beside(index),
            Action::Pace(pace) => {
                let side_by_side = SideBySide { pace, ..self.document.side_by_side().clone() };
                self.set_lockstep(self.document.estimator().boxed_clone(), side_by_side);
            }
            Action::Set(owner, index, value) => {
                if let Err(error) = self.document.set(owner, index, value) {
                    self.toasts.fail(error.to_string());
                }
                self.restart();
            }
            Action::Enter(index) => self.enter(index),
            Action::Settle => self.document.settle(),
            Action::Place(index) => self.place(index),
            Action::ResetAll(owner) => {
                self.document.reset(owner);
                self.restart();
            }
            Action::Seek(cursor) => self.go(Move::To(cursor)),
            Action::SeekCandidate(candidate) => {
                self.player.pause();
                let shown = self.view.shown.as_deref();
                self.states.sought = shown.map(|shown| (shown.cursor.unit, candidate));
                self.walker.go_to_candidate(candidate);
            }
            Action::SeekAt(focus, _) if self.guesses_at(focus) => {}
            Action::SeekAt(focus, side) => {
                self.player.pause();
                let shown = self.view.shown.as_ref();
                if let Some(first) = shown.and_then(|shown| shown.elsewhere(focus.on)) {
                    let (clicked, first) = (focus.on.title(None), first.title(None).to_lowercase());
                    self.toasts.hint(format!("{clicked} has no pixels to explain at this step: click on {first}."));
                    return;
                }
                self.walker.go_at(focus, side);
            }
            // What is pointed at would be explained by the step that is held back.
            Action::Focus(_) if self.predict.is_due() || self.predict.open().is_some() => {}
            Action::Chart(index) => self.choose_chart(index),
            Action::Draw(line) => self.draw(*line),
            Action::Pen(wish) => self.pen(wish),
            Action::Focus(focus) => self.walker.focus(focus),
            Action::Vote(index, adds) => _ = self.predict.vote(index, adds),
            Action::Guess(number) => _ = self.predict.number(number),
            Action::Reveal => self.predict.reveal(),
            Action::Release => self.walker.release(),
            Action::Hint(text) => self.toasts.introduce(text),
            Action::Frame(frame) => self.go_to_frame(frame),
            Action::Speed(speed) => {
                self.player.speed = speed;
                self.settings.speed = speed;
            }
            Action::Dismiss => self.error = None,
            Action::Trust => self.trust(),
        }
    }

    /// Executes a command if it is enabled.
    pub fn command(&mut self, command: Command) {
        use Command as C;
        let now = self.now();
        // Below the start page nothing is answered, and no page is turned.
        if !now.at_start_page && (self.answers(command) || self.turns_page(command)) {
            return;
        }
        if !command.enabled(&now) {
            // A key that is pressed again says it once.
            let why = command.why_disabled(&now).filter(|why| self.toasts.last() != Some(why));
            why.into_iter().for_each(|why| self.toasts.hint(why));
            return;
        }
        if command.entry().menu == Menu::Walk {
            self.toasts.end_introductions();
        }
        match command {
            C::Open => self.overlay = Overlay::Open(Box::default()),
            C::OpenRightView => self.overlay = Overlay::Open(Box::new(open_dialog::State::of_right_view())),
            C::PastePath => self.ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            C::Compare => {
                self.overlay = Overlay::Compare(Box::new(compare::State::new(self.document.estimator().info().id)))
            }
            C::Lockstep => self.toggle_lockstep(),
            C::StartPage => self.toggle_start(),
            C::Estimators => self.open_chooser(String::new(), false),
            C::SearchText => self.overlay = Overlay::Find(find::State::default()),
            C::BackToPage => self.back_to_page(),
            C::Samples => self.overlay = Overlay::Samples,
            C::Camera => self.open_camera(),
            C::NextExample => self.next_example(),
            C::Lessons => self.overlay = Overlay::Lessons(lessons::State::at(self.lesson.as_ref())),
            C::CloseLesson => self.close_lesson(),
            C::CopyPage => self.copy_page(),
            C::NextPage => self.turn(Direction::Forward),
            C::PreviousPage => self.turn(Direction::Back),
            C::Palette => self.overlay = Overlay::Palette(palette::State::default()),
            C::Glossary => self.overlay = Overlay::Glossary(terms::State::default()),
            C::Shortcuts => self.overlay = Overlay::Shortcuts,
            C::About => self.overlay = Overlay::About,
            C::Quit => self.ctx.send_viewport_cmd(ViewportCommand::Close),
            C::SaveSession => self.save_as(Kind::Session),
            C::SaveClip => self.save_as(Kind::Clip),
            C::SaveHandout => self.save_as(Kind::Handout),
            C::SaveWorksheet => self.save_as(Kind::Worksheet),
            C::ExportPicture => self.save_as(Kind::Picture),
            C::ExportSteps => self.save_as(Kind::Steps),
            C::ExportResult => self.save_as(Kind::Result),
            C::ExportScores => self.save_as(Kind::Scores),
            C::ClearScores => self.clear_scores(),
            C::IntoStage => {
                if let Some(index) = stage::stages(self.document.estimator()).first() {
                    self.enter(*index);
                }
            }
            C::OutOfStage => self.leave(),
            C::Undo | C::Redo if self.presentation.pen.is_on => self.undo_ink(command),
            C::Undo | C::Redo | C::ResetParameters => self.edit(command),
            C::SideBySide | C::FrameT | C::FrameNext | C::Difference | C::Blend | C::Blink => self.choose_look(command),
            C::Prediction | C::Residual => self.choose_look(command),
            C::Layer(_) => self.choose_look(command),
            C::DarkTheme | C::LightTheme | C::ProjectorTheme => self.choose_look(command),
            C::ViridisColors | C::TurboColors => self.choose_look(command),
            C::FittingArrows | C::TrueArrows | C::DoubleArrows | C::FourfoldArrows => self.choose_look(command),
            C::NextTheme => self.next_theme(),
            C::NextLayer => self.next_layer(),
            C::Streaks => {
                let look = &mut self.settings.look;
                look.streaks = look.streaks.is_none().then(Phase::default);
            }
            C::LockScale => self.lock_scale(),
            C::ZoomIn | C::ZoomOut | C::Fit | C::ActualSize => self.zoom(command),
            C::Focus => {
                let look = &mut self.settings.look;
                look.focus = self.states.stage.toggle_focus(look.focus);
            }
            C::FocusWhereSmall | C::FocusAlways | C::FocusNever => self.choose_look(command),
            C::LargerInterface | C::SmallerInterface | C::NormalInterface => self.resize(command),
            C::ShowParameters | C::ShowExplanation | C::ShowCharts | C::Lecture | C::ResetLayout => {
                self.arrange(command)
            }
            C::EnlargeChart | C::NextChart | C::PreviousChart => self.arrange(command),
            C::NextPicture => self.states.stage.next_picture(),
            C::Landscape => self.settings.look.landscape = !self.settings.look.landscape,
            C::FullScreen => {
                let now = self.ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                self.ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!now));
            }
            C::Predict => self.toggle_predict(),
            C::Pen | C::NextPenColor | C::ClearInk | C::Pointer | C::Loupe | C::Blank => self.present(command),
            C::Present | C::PresenterWindow => self.present(command),
            C::ReducedMotion => self.settings.reduced_motion = !self.settings.reduced_motion,
            C::Play => self.toggle_play(Direction::Forward),
            C::PlayBack => self.toggle_play(Direction::Back),
            C::Slower | C::Faster => {
                self.player.shift(command == C::Faster, self.granularities().names().len());
                self.settings.speed = self.player.speed;
            }
            C::NextFrame => self.go_to_frame(self.document.frame() + 1),
            C::PreviousFrame => self.go_to_frame(self.document.frame().saturating_sub(1)),
            C::Stop => {
                self.player.pause();
                self.walker.stop();
            }
            C::Into | C::IntoBack => self.step(command, self.granularities().event()),
            C::Over | C::OverBack | C::NextUnit | C::PreviousUnit => self.step(command, self.granularities().unit()),
            C::Out | C::OutBack => self.step(command, self.granularities().group()),
            C::Start => self.go(Move::To(Cursor::default())),
            C::End => self.go(Move::End),
            C::NextMark | C::PreviousMark => self.go_to_mark(command, Marks::All),
            C::NextAlike | C::PreviousAlike => self.go_to_mark(command, Marks::Alike),
        }
    }

    /// Begins to place a parameter on the picture, or ends it.
    fn place(&mut self, index: Option<usize>) {
        self.states.stage.placing = index;
        if index.is_some() {
            self.presentation.pen.is_on = false;
            self.settings.fold_parameters();
        }
    }

    /// Plays in the direction `way`, or pauses if it does; from where it cannot go on, it begins at the other end.
    fn toggle_play(&mut self, way: Direction) {
        if self.player.plays(way) {
            return self.player.pause();
        }
        let now = self.now();
        match way {
            Direction::Forward if self.replays_page() => {}
            Direction::Forward if now.at_end => self.walker.go(Move::To(Cursor::default())),
            Direction::Back if now.at_start => self.walker.go(Move::End),
            _ => {}
        }
        self.player.play(way);
    }

    fn go(&mut self, to: Move) {
        self.player.pause();
        self.walker.go(to);
    }

    fn go_to_mark(&mut self, command: Command, marks: Marks) {
        let Some(way) = command.entry().way else { return };
        self.player.pause();
        self.walker.go_to_mark(way, marks);
    }

    /// Steps the way of `command`, by the granularity of this index.
    fn step(&mut self, command: Command, granularity: usize) {
        let Some(way) = command.entry().way else { return };
        self.settings.practice.note(way);
        self.player.pause();
        self.walker.go(Move::Granularity(granularity, way));
    }

    fn edit(&mut self, command: Command) {
        let (before, depth) = (self.document.estimator().info().id, self.document.parents().len());
        let (was_single, was_by_frame) = (self.shows_frame_alone(), self.document.estimator().is_by_frame());
        match command {
            Command::Undo => drop(self.document.undo()),
            Command::Redo => drop(self.document.redo()),
            _ => self.document.reset(Owner::Estimator),
        }
        let is_another = self.document.estimator().info().id != before;
        if is_another {
            self.states.stage.placing = None;
        }
        self.suit_view(was_single);
        match is_another && was_by_frame && self.document.parents().len() == depth {
            true => self.restart_from(was_by_frame),
            false => self.restart(),
        }
    }

    /// Sets the view option `name` from text.
    ///
    /// # Errors
    /// A sentence with the allowed values; nothing changes then.
    pub fn set_look(&mut self, name: &str, value: &str) -> Result<(), Error> {
        self.settings.look.set(name, value)
    }

    /// Sets the view option of `command`.
    fn choose_look(&mut self, command: Command) {
        let set = command.entry().sets.map_or(Ok(()), |(name, value)| self.set_look(name, value));
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

    /// Keeps the scale of the colours as it is here at every step, or lets it follow what is found again.
    fn lock_scale(&mut self) {
        let Some(shown) = self.view.shown.as_deref() else { return };
        let tiles = shown.tiles.iter().filter_map(|tile| tile.layer.as_ref());
        let layer = shown.pictures.layer.iter().chain(tiles).find(|layer| layer.has_unit());
        let look = &mut self.settings.look;
        match (look.color_scale, layer) {
            (Some(_), _) => look.color_scale = None,
            (None, Some(layer)) => {
                let end = layer.end();
                let set = look.set("color-scale", &end.to_string());
                set.unwrap_or_else(|error| self.toasts.fail(error.to_string()));
            }
            (None, None) => self.toasts.tell("No colours with a scale in px are shown here.".to_owned()),
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
        // Where a small window has made it smaller than was asked for, it goes down from what is seen.
        let zoom = self.settings.seen_zoom(self.ctx.zoom_factor());
        match command {
            Command::LargerInterface => self.settings.set_zoom(zoom + step),
            Command::SmallerInterface => self.settings.set_zoom(zoom - step),
            _ => self.settings.set_zoom(1.0),
        }
    }

    fn arrange(&mut self, command: Command) {
        match command {
            Command::ShowParameters => self.settings.toggle(layout::Pane::Parameters),
            Command::ShowExplanation => self.settings.toggle(layout::Pane::Explanation),
            Command::ShowCharts => self.settings.toggle(layout::Pane::Charts),
            Command::Lecture => self.lecture(),
            Command::EnlargeChart => self.settings.charts.is_enlarged = !self.settings.charts.is_enlarged,
            Command::NextChart | Command::PreviousChart => self.turn_charts(command == Command::PreviousChart),
            _ => {
                self.settings.reset_layout();
                self.states.stage.forget_large();
            }
        }
    }

    fn lecture(&mut self) {
        self.settings.lecture = !self.settings.lecture;
        let is_projector = self.settings.look.theme == Theme::Projector;
        if self.settings.lecture && self.settings.mode.is_some_and(layout::Mode::is_lecture) {
            let why = if is_projector { "The projector theme" } else { "A window of this size" };
            self.toasts.hint(format!("{why} has the lecture layout already."));
        }
    }

    fn turn_charts(&mut self, is_back: bool) {
        let all = self.charts();
        let (count, alternate) = (self.arranged.charts.len().max(1), self.arranged.alternates);
        self.settings.charts.turn(&all, count, (is_back, alternate));
    }

    /// Opens the chooser with `query` typed in it; at the start page a choice opens an example.
    fn open_chooser(&mut self, query: String, is_entered: bool) {
        let purpose = if self.is_at_start() { Purpose::Example } else { Purpose::Run };
        let state = chooser::State::new(&self.document, purpose, query, is_entered);
        self.overlay = Overlay::Chooser(Box::new(state));
    }

    pub(super) fn choose(&mut self, id: &str) {
        match estimator(id) {
            Ok(chosen) => {
                let was_single = self.shows_frame_alone();
                let was_by_frame = self.document.estimator().is_by_frame();
                self.states.stage.placing = None;
                self.states.stage.forget_large();
                self.states.stage.follow_again();
                if self.document.parents().len() > 0 {
                    self.toasts
                        .hint(format!("{} runs on the clip itself, so the stage was closed.", chosen.info().name));
                }
                // Colours that tell of one family's results would cover the pictures of another.
                if self.document.estimator().info().family != chosen.info().family {
                    self.settings.look.layer = None;
                }
                self.document.choose(changed_alike(self.document.estimator(), chosen));
                self.suit_view(was_single);
                self.restart_from(was_by_frame);
                self.ask_for_region();
            }
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Asks for the region of an object where a tracker has taken one in the middle of the frame, and takes up the placing tool.
    pub(super) fn ask_for_region(&mut self) {
        let (document, frame) = (&self.document, self.document.frame());
        let opened = document.source().zip(document.clip());
        let Some(spec) = opened.and_then(|opened| unplaced(document.estimator(), opened, frame)) else { return };
        let index = document.estimator().specs().iter().position(|other| other.name == spec.name);
        self.toasts.hint(format!("{}: drag one on the first frame of the run.", capital(&told_of_unplaced(spec))));
        self.settings.charts.is_enlarged = false;
        self.place(index);
    }

    /// Switches the estimator and keeps the position if both have the same units; for units that are frames, the shown frame.
    fn restart_from(&mut self, was_by_frame: bool) {
        let before = self.document.frame();
        let place = match (was_by_frame, self.document.estimator().is_by_frame(), &self.view.shown) {
            (false, false, _) => return self.restart(),
            (true, true, shown) => self.document.begin_near(self.document.place(shown.as_deref())),
            (false, true, Some(shown)) => {
                let unit = shown.frame.saturating_sub(self.document.frame());
                let place = Place { cursor: Cursor { unit, event: usize::MAX }, ..Place::default() };
                self.document.begin_near(place)
            }
            _ => Place::OPENING,
        };
        if self.document.frame() > before {
            let (name, frame) = (self.document.estimator().info().name, self.document.frame());
            self.toasts
                .hint(format!("{name} depends on few frames: its run begins at frame {frame}, near the one shown."));
        }
        let job = self.document.job_at(place);
        self.start(job);
    }

    /// Opens a stage of the estimator at the current position.
    fn enter(&mut self, index: usize) {
        let Some(shown) = self.view.shown.clone().filter(|_| self.document.side_by_side().is_empty()) else { return };
        let was_single = self.shows_frame_alone();
        match self.document.enter(index, &shown) {
            Ok(place) => self.change_stage(place, was_single),
            Err(error) => self.toasts.fail(format!("The stage cannot be opened: {error}.")),
        }
    }

    /// Closes the stage and returns to its parent.
    fn leave(&mut self) {
        let was_single = self.shows_frame_alone();
        let place = self.document.leave();
        self.change_stage(place, was_single);
    }

    fn change_stage(&mut self, place: Option<Place>, was_single: bool) {
        let Some(place) = place else { return };
        self.player.pause();
        self.states.stage.placing = None;
        self.states.explained = 0;
        self.suit_view(was_single);
        let job = self.document.job_at(place);
        self.start(job);
    }

    /// Whether frame t alone shows the estimator.
    pub(super) fn shows_frame_alone(&self) -> bool {
        self.document.estimator().shows_frame_alone()
    }

    /// The view with which a run begins: frame t for an estimator of single frames, both frames for one of pairs.
    pub(super) fn own_view(&self) -> View {
        if self.shows_frame_alone() { View::Current } else { View::default() }
    }

    /// Adapts the view after a change between estimators of single frames, which show frame t, and of pairs, which show both.
    pub(super) fn suit_view(&mut self, was_single: bool) {
        let is_single = self.shows_frame_alone();
        let view = &mut self.settings.look.view;
        match (was_single, is_single, *view) {
            (false, true, Some(View::SideBySide)) => *view = Some(View::Current),
            (true, false, Some(View::Current)) => *view = Some(View::SideBySide),
            _ => {}
        }
    }

    /// Starts the estimators `ids` in lockstep, led by the chosen one if it is among them, else by the first.
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
            Ok((leader, side_by_side)) => self.set_lockstep(leader, side_by_side),
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Toggles between one estimator and lockstep with those used last.
    fn toggle_lockstep(&mut self) {
        let leader = self.document.estimator().boxed_clone();
        if !self.document.side_by_side().is_empty() {
            self.side_by_side = self.document.side_by_side().clone();
            return self.set_lockstep(leader, SideBySide::default());
        }
        let mut side_by_side = self.side_by_side.clone();
        // Those that were there last, if they can go with it.
        let id = leader.info().id;
        side_by_side.beside.retain(|companion| companion.estimator.info().id != id);
        let is_possible = !side_by_side.is_empty() && side_by_side.check(&*leader).is_ok();
        if is_possible {
            side_by_side.follow(&*leader);
            side_by_side.suit(&*leader);
        } else {
            side_by_side = SideBySide::usual(&*leader);
        }
        self.set_lockstep(leader, side_by_side);
    }

    /// Adds the estimator `id` to the lockstep.
    fn add_beside(&mut self, id: &str) {
        let leader = self.document.estimator().boxed_clone();
        let mut side_by_side = self.document.side_by_side().clone();
        let added = estimator(id).and_then(|added| {
            side_by_side.beside.push(Companion::new(added, &*leader));
            side_by_side.check(&*leader)
        });
        match added {
            Ok(()) => {
                side_by_side.suit(&*leader);
                self.set_lockstep(leader, side_by_side);
            }
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Takes an estimator out of the lockstep.
    fn remove_beside(&mut self, index: usize) {
        let leader = self.document.estimator().boxed_clone();
        let mut side_by_side = self.document.side_by_side().clone();
        if index < side_by_side.beside.len() {
            side_by_side.beside.remove(index);
            side_by_side.suit(&*leader);
            self.set_lockstep(leader, side_by_side);
        }
    }

    /// Continues `leader` in lockstep with others, or alone, from its position.
    fn set_lockstep(&mut self, leader: Box<dyn AnyEstimator>, side_by_side: SideBySide) {
        self.document.set_lockstep(leader, side_by_side);
        self.states.explained = 0;
        self.restart();
    }

    /// Goes to the first block whose global minimum an estimator missed, with that estimator.
    fn visit(&mut self, row: &Row) {
        if !self.document.side_by_side().is_empty() {
            self.side_by_side = self.document.side_by_side().clone();
        }
        self.document.set_lockstep(row.estimator.boxed_clone(), SideBySide::default());
        self.states.explained = 0;
        let unit = row.figures.first_missed_unit().unwrap_or(0);
        let place = Place { cursor: Cursor { unit, event: usize::MAX }, ..Place::default() };
        let job = self.document.job_at(place);
        self.start(job);
    }

    fn go_to_frame(&mut self, frame: usize) {
        if self.document.go_to_frame(frame) {
            self.restart();
        }
    }

    /// Restarts the run with the current settings at the shown position.
    fn restart(&mut self) {
        let job = self.document.job(self.view.shown.as_deref());
        self.start(job);
    }
}
