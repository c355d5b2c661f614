//! Executes commands.

use eframe::egui::ViewportCommand;
use motionscope_core::run::{Cursor, Direction, Move, stage};

use super::App;
use super::dialogs::Overlay;
use crate::paint::Phase;
use crate::ui::commands::{Command, Menu, Owner, PenWish};
use crate::ui::dialogs::save::Kind;
use crate::ui::dialogs::{compare, find, lessons, open as open_dialog, palette, terms};
use crate::ui::drawing::style::ZOOM;
use crate::ui::model::walker::Marks;
use crate::ui::{full_screen, layout};

/// Zoom factor of a key press.
const ZOOM_STEP: f32 = 1.5;

impl App {
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
            C::Open => self.dialogs.overlay = Overlay::Open(Box::default()),
            C::OpenRightView => self.dialogs.overlay = Overlay::Open(Box::new(open_dialog::State::of_right_view())),
            C::PastePath => self.ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            C::Compare => {
                self.dialogs.overlay =
                    Overlay::Compare(Box::new(compare::State::new(self.run.document.estimator().info().id)))
            }
            C::Lockstep => self.toggle_lockstep(),
            C::StartPage => self.toggle_start(),
            C::Estimators => self.open_chooser(String::new(), false),
            C::SearchText => self.dialogs.overlay = Overlay::Find(find::State::default()),
            C::BackToPage => self.back_to_page(),
            C::Samples => self.dialogs.overlay = Overlay::Samples,
            C::Camera => self.open_camera(),
            C::NextExample => self.next_example(),
            C::Lessons => self.dialogs.overlay = Overlay::Lessons(lessons::State::at(self.course.lesson.as_ref())),
            C::CloseLesson => self.close_lesson(),
            C::CopyPage => self.copy_page(),
            C::CopyLink => self.copy_link(),
            C::NextPage => self.turn(Direction::Forward),
            C::PreviousPage => self.turn(Direction::Back),
            C::Palette => self.dialogs.overlay = Overlay::Palette(palette::State::default()),
            C::Glossary => self.dialogs.overlay = Overlay::Glossary(terms::State::default()),
            C::Shortcuts => self.dialogs.overlay = Overlay::Shortcuts,
            C::About => self.dialogs.overlay = Overlay::About,
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
                if let Some(index) = stage::stages(self.run.document.estimator()).first() {
                    self.enter(*index);
                }
            }
            C::OutOfStage => self.leave(),
            C::Undo | C::Redo if self.presentation.pen.is_on => self.undo_ink(command == C::Redo),
            C::Undo => self.edit(|document| _ = document.undo()),
            C::Redo => self.edit(|document| _ = document.redo()),
            C::ResetParameters => self.edit(|document| document.reset(Owner::Estimator)),
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
            C::ZoomIn => self.magnify(ZOOM_STEP),
            C::ZoomOut => self.magnify(1.0 / ZOOM_STEP),
            C::Fit => self.panes.states.stage.fit(),
            C::ActualSize => self.panes.states.stage.one_to_one(self.ctx.pixels_per_point()),
            C::Focus => {
                let look = &mut self.settings.look;
                look.focus = self.panes.states.stage.toggle_focus(look.focus);
            }
            C::FocusWhereSmall | C::FocusAlways | C::FocusNever => self.choose_look(command),
            C::LargerInterface => self.resize(ZOOM.2),
            C::SmallerInterface => self.resize(-ZOOM.2),
            C::NormalInterface => self.settings.set_zoom(1.0),
            C::ShowParameters => self.settings.toggle(layout::Pane::Parameters),
            C::ShowExplanation => self.settings.toggle(layout::Pane::Explanation),
            C::ShowCharts => self.settings.toggle(layout::Pane::Charts),
            C::Lecture => self.lecture(),
            C::ResetLayout => self.reset_layout(),
            C::EnlargeChart => self.settings.charts.is_enlarged = !self.settings.charts.is_enlarged,
            C::NextChart => self.turn_charts(false),
            C::PreviousChart => self.turn_charts(true),
            C::NextPicture => self.panes.states.stage.next_picture(),
            C::Landscape => self.settings.look.landscape = !self.settings.look.landscape,
            C::FullScreen => full_screen::set(&self.ctx, !full_screen::is_on(&self.ctx)),
            C::Predict => self.toggle_predict(),
            C::Pen => self.take_pen(),
            C::NextPenColor => self.pen(PenWish::Color(self.presentation.pen.color.next())),
            C::ClearInk => self.pen(PenWish::Clear),
            C::Pointer => self.presentation.toggle_pointer(),
            C::Loupe => self.presentation.has_loupe = !self.presentation.has_loupe,
            C::Blank => {
                self.presentation.is_blank = !self.presentation.is_blank;
                self.run.player.pause();
            }
            C::Present => self.toggle_full_screen(),
            C::PresenterWindow => self.toggle_presenter(),
            C::ReducedMotion => self.settings.reduced_motion = !self.settings.reduced_motion,
            C::Play => self.toggle_play(Direction::Forward),
            C::PlayBack => self.toggle_play(Direction::Back),
            C::Slower | C::Faster => {
                self.run.player.shift(command == C::Faster, self.run.granularities().names().len());
                self.settings.speed = self.run.player.speed;
            }
            C::NextFrame => self.go_to_frame(self.run.document.frame() + 1),
            C::PreviousFrame => self.go_to_frame(self.run.document.frame().saturating_sub(1)),
            C::Stop => {
                self.run.player.pause();
                self.run.walker.stop();
            }
            C::Into | C::IntoBack => self.step(command, self.run.granularities().event()),
            C::Over | C::OverBack | C::NextUnit | C::PreviousUnit => {
                self.step(command, self.run.granularities().unit())
            }
            C::Out | C::OutBack => self.step(command, self.run.granularities().group()),
            C::Start => self.run.go(Move::To(Cursor::default())),
            C::End => self.run.go(Move::End),
            C::NextMark => self.run.go_to_mark(Direction::Forward, Marks::All),
            C::PreviousMark => self.run.go_to_mark(Direction::Back, Marks::All),
            C::NextAlike => self.run.go_to_mark(Direction::Forward, Marks::Alike),
            C::PreviousAlike => self.run.go_to_mark(Direction::Back, Marks::Alike),
        }
    }

    /// Steps the way of `command`, by the granularity of this index.
    fn step(&mut self, command: Command, granularity: usize) {
        let Some(way) = command.entry().way else { return };
        self.settings.practice.note(way);
        self.run.player.pause();
        self.run.walker.go(Move::Granularity(granularity, way));
    }
}
