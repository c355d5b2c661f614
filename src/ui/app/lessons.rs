//! Lessons in the window: opening, turning pages, and where the page stands.

use std::ffi::OsString;
use std::path::Path;
use std::sync::Arc;

use eframe::egui::{Rect, Ui};
use motionscope_core::run::{Cursor, Direction, Move};

use super::dialogs::Overlay;
use super::{App, Region};
use crate::session::Session;
use crate::session::lesson::{Address, page_text};
use crate::ui::commands::{Actions, Command};
use crate::ui::model::lesson::OpenLesson;
use crate::ui::model::paper::OfPage;
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::trail::{Left, Trail};
use crate::ui::panes::glossary::Beside;
use crate::ui::panes::lesson;

/// The lesson that is open, and the way back.
#[derive(Default)]
pub(super) struct Course {
    pub lesson: Option<OpenLesson>,
    /// The pages that links led away from.
    pub trail: Trail,
}

impl Course {
    /// The page that is open, and its step.
    fn left_page(&self, shown: Option<&Snapshot>) -> Option<Left> {
        let open = self.lesson.as_ref()?;
        let session = open.page().session.as_ref().ok();
        let is_of_page = |shown: &&Snapshot| session.is_some_and(|of| shown.subject.experiment == of.experiment);
        let cursor = shown.filter(is_of_page).map(|shown| shown.cursor);
        let title = format!("{}, page {}", open.lesson().title, open.address().page + 1);
        Some(Left { address: open.address().clone(), cursor, title })
    }

    /// Notes the page that is open, where another run than that of its step has been opened beside it.
    pub fn note_page(&mut self, shown: Option<&Snapshot>) {
        let left = self.left_page(shown);
        left.into_iter().for_each(|left| self.trail.leave(left));
    }

    /// The page of the lesson that is open, if the run that is `shown` is its own.
    pub fn printed_page(&self, shown: &Snapshot) -> Option<OfPage> {
        let open = self.lesson.as_ref()?;
        let page = open.page();
        let session = page.session.as_ref().ok()?;
        let is_own = shown.subject.experiment == session.experiment;
        let title = format!("{} · {}", open.lesson().title, page.title);
        page.words.as_ref().ok().filter(|_| is_own).map(|prose| OfPage { title, prose: prose.clone() })
    }

    /// The first step of the page.
    fn first_of_page(&self) -> Option<Cursor> {
        let session = self.lesson.as_ref()?.page().session.as_ref().ok()?;
        Some(session.position.cursor.unwrap_or_default())
    }

    /// The last step of the page, where its run is shown.
    pub fn end_of_page(&self, shown: Option<&Snapshot>) -> Option<Cursor> {
        let open = self.lesson.as_ref()?;
        let session = open.page().session.as_ref().ok()?;
        shown.filter(|shown| shown.subject.experiment == session.experiment)?;
        open.page().until
    }

    /// The title of the page that the next step turns to, if it turns one.
    pub fn coming_page(&self, cursor: Cursor) -> Option<String> {
        let open = self.lesson.as_ref()?;
        let is_last = open.is_at(Direction::Forward) || !open.is_through(cursor, Direction::Forward);
        (!is_last).then(|| open.lesson().pages[open.address().page + 1].title.clone())
    }
}

impl App {
    /// Opens a page of a lesson, with its clip and its step, so that there is a way back to the page that is open.
    pub(super) fn open_page(&mut self, address: Address) {
        let left = self.course.left_page(self.run.view.shown.as_deref()).filter(|left| left.address != address);
        self.open_page_with(address, left, |app| app.show_page(None));
    }

    /// Opens a page beside another `session` than its own, as a link `name` says.
    pub(super) fn open_linked_page(&mut self, address: Address, session: Session, name: OsString) {
        let is_open = self.course.lesson.as_ref().is_some_and(|open| *open.address() == address);
        if is_open {
            self.dialogs.start = None;
            return self.show_on_page(session, name);
        }
        self.open_page_with(address, None, |app| app.show_on_page(session, name));
    }

    /// Opens a page and has its step shown; once it opens, `left` is on the way back.
    fn open_page_with(&mut self, address: Address, left: Option<Left>, show: impl FnOnce(&mut Self)) {
        // What a page of the lesson before has set is not how the person looks at pictures.
        let look = self.course.lesson.as_ref().map_or(self.settings.look, |open| open.without_page(self.settings.look));
        let ctx = self.ctx.clone();
        let (name, file) = (address.name(), address.file().map(Path::to_path_buf));
        match OpenLesson::new(address, look, move || ctx.request_repaint()) {
            Ok(open) => {
                left.into_iter().for_each(|left| self.course.trail.leave(left));
                match open.address().file() {
                    Some(path) => self.settings.remember(path),
                    None => self.settings.remember_page(open.address()),
                }
                self.dialogs.start = None;
                self.close_lesson();
                self.dialogs.overlay = Overlay::None;
                self.settings.fold_parameters();
                self.course.lesson = Some(open);
                show(self);
            }
            Err(error) => {
                if let Some(file) = &file
                    && self.ask_for_trust(file, &name, &error)
                {
                    return;
                }
                match &mut self.dialogs.overlay {
                    Overlay::Open(state) => state.refuse(&error),
                    _ => self.opening.error = Some(error),
                }
            }
        }
    }

    /// Returns to the page that was left last, at its step.
    pub(super) fn back_to_page(&mut self) {
        let Some(Left { address, cursor, .. }) = self.course.trail.back() else { return };
        self.open_page_with(address, None, |app| app.show_page(cursor));
    }

    /// Closes the lesson; pictures look as they did without its page.
    pub(super) fn close_lesson(&mut self) {
        if let Some(open) = self.course.lesson.take() {
            // An open question is taken back without its answer.
            self.run.predict.withdraw().into_iter().for_each(|cursor| self.run.walker.go(Move::To(cursor)));
            self.run.predict.turn_for_page(false);
            self.settings.look = open.without_page(self.settings.look);
        }
    }

    /// Turns to the next page that way.
    pub(super) fn turn(&mut self, way: Direction) {
        self.turn_to(way, false);
    }

    /// Turns the page instead of `command`, where that is what a lesson is stepped through with; gives whether the command is done with.
    pub(super) fn turns_page(&mut self, command: Command) -> bool {
        // The parameters may have the place of the page.
        let is_seen = self.regions().iter().any(|(region, _)| *region == Region::Lesson);
        let Some(open) = &mut self.course.lesson else { return false };
        // The offer of the next lesson ends with whatever else is done.
        open.is_over &= matches!(command, Command::Into | Command::NextUnit);
        let open = &*open;
        let is_over = open.is_over;
        let (way, is_step) = match command {
            Command::Into => (Direction::Forward, true),
            Command::IntoBack => (Direction::Back, true),
            Command::NextUnit => (Direction::Forward, false),
            Command::PreviousUnit => (Direction::Back, false),
            _ => return false,
        };
        // A page that is wrong has no steps of its own.
        let session = open.page().session.as_ref().ok().filter(|_| is_step);
        if let Some(session) = session {
            // Until the step of the page is there, what is shown is not of it, and its steps must not be passed over.
            if !open.has_arrived() {
                return true;
            }
            // Another run that was opened beside the page is stepped through itself.
            let shown = self.run.view.shown.as_deref();
            let Some(shown) = shown.filter(|shown| shown.subject.experiment == session.experiment) else {
                return false;
            };
            let has_left = open.has_left(shown);
            let is_through = open.is_through(shown.cursor, way) || way == Direction::Forward && shown.at_end;
            // Words are read to their end before the first step is taken, and again from there on the way back.
            if !has_left && !is_over && is_seen && self.panes.states.lesson.read(way) {
                return true;
            }
            if !is_through {
                return false;
            }
        } else if is_step && is_seen && self.panes.states.lesson.read(way) {
            return true;
        }
        match open.is_at(way) {
            true if way == Direction::Forward => {
                self.end_lesson();
                true
            }
            // The first page keeps the step that its words are about.
            true => !is_step,
            false => {
                self.turn_to(way, is_step);
                true
            }
        }
    }

    /// Says that the last page is through; the next step opens the lesson that follows.
    fn end_lesson(&mut self) {
        let Some(open) = &mut self.course.lesson else { return };
        match open.next() {
            Some(next) if open.is_over => self.open_page(Address::from(next)),
            _ => open.is_over = true,
        }
    }

    /// Turns the page; by a step back it is entered at its last step.
    fn turn_to(&mut self, way: Direction, is_step: bool) {
        let Some(open) = &mut self.course.lesson else { return };
        self.settings.look = open.without_page(self.settings.look);
        open.turn(way);
        if open.address().file().is_none() {
            self.settings.remember_page(open.address());
        }
        let at = open.page().until.filter(|_| is_step && way == Direction::Back);
        self.show_page(at);
    }

    /// Copies what is shown as a page of a lesson; its files are named from the folder of the lesson that is open.
    pub(super) fn copy_page(&mut self) {
        if self.is_unsaved() {
            return self.refuse_unsaved();
        }
        let Some(shown) = self.run.view.shown.as_deref() else { return };
        let file = self.course.lesson.as_ref().and_then(|open| open.address().file());
        let folder = file.and_then(Path::parent).unwrap_or(Path::new("."));
        match page_text(&self.session(shown), folder) {
            Ok(text) => {
                self.ctx.copy_text(text);
                self.toasts.tell("Copied: paste it into the Markdown file of a lesson and write the words below it.");
            }
            Err(error) => self.toasts.fail(format!("Not copied: {error}.")),
        }
    }

    /// Goes back to the first step of a page that stands at its last one, to play it again; gives whether it does.
    pub(super) fn replays_page(&mut self) -> bool {
        let at = self.run.view.shown.as_deref().map(|shown| shown.cursor);
        let Some(first) = self
            .course
            .end_of_page(self.run.view.shown.as_deref())
            .filter(|end| at == Some(*end))
            .and_then(|_| self.course.first_of_page())
        else {
            return false;
        };
        self.run.walker.go(Move::To(first));
        true
    }

    /// Shows the step of the page, or its step `at`.
    fn show_page(&mut self, at: Option<Cursor>) {
        let Some(open) = &mut self.course.lesson else { return };
        let Ok(mut session) = open.page().session.clone() else { return };
        session.position.cursor = at.or(session.position.cursor);
        let name = open.address().name();
        self.show_on_page(session, name);
    }

    /// Shows a session beside the words of the page; its clip is opened as `name`.
    fn show_on_page(&mut self, mut session: Session, name: OsString) {
        let Some(open) = &mut self.course.lesson else { return };
        self.panes.states.stage.forget_large();
        self.run.player.pause();
        self.run.predict.turn_for_page(open.page().predicts);
        let cursor = session.position.cursor.unwrap_or_default();
        session.position.cursor = Some(cursor);
        open.lands_at(cursor, name.clone());
        let now = self.run.document.experiment();
        let is_of_clip = self.run.document.clip().is_some() && session.experiment.has_clip_of(now);
        if !is_of_clip {
            self.load(name);
        } else if session.experiment == *now && session.position.held.is_none() && self.run.view.refused.is_none() {
            self.look_as(&session.look, session.sight);
            self.opening.loading = None;
            self.run.walker.release();
            self.run.walker.go(Move::To(cursor));
        } else {
            self.opening.loading = None;
            self.take(session);
        }
    }

    /// Notes that the step of the page is there, and reads a lesson anew that is being written.
    pub(super) fn follow_lesson(&mut self) {
        let is_there = self.opening.loading.is_none() && !self.run.view.busy;
        let Some(open) = &mut self.course.lesson else { return };
        if is_there {
            open.arrive();
        }
        if open.address().file().is_none() {
            return;
        }
        let look = open.without_page(self.settings.look);
        match open.follow() {
            Ok(false) => {}
            Ok(true) => {
                self.settings.look = look;
                self.show_page(None);
            }
            Err(error) => self.toasts.fail(format!("Not read: {error}.")),
        }
    }

    /// Shows the page of the lesson in its place.
    pub(super) fn lesson_page(&mut self, ui: &mut Ui, page: Rect, actions: &mut Actions) {
        let Some(open) = &mut self.course.lesson else { return };
        let theme = self.settings.look.theme;
        let back = self.course.trail.last().map(|left| left.title.as_str());
        let shown = self.run.view.shown.clone();
        let scene = shown.as_ref().map(|shown| Arc::clone(&shown.scene)).unwrap_or_default();
        let beside = Beside::new(&scene, shown.as_ref().map_or("", |shown| shown.info.family), theme);
        let is_presented = self.presentation.is_on;
        let input = lesson::Input { open, theme, back, beside: &beside, is_presented };
        self.panes.states.lesson.has_notes_elsewhere = self.presentation.presenter.is_some();
        lesson::show(ui, page, input, &mut self.panes.states.lesson, actions);
        self.panes.states.stage.point_out(beside.pointed());
    }
}
