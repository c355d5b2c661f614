//! Links: opening what one says, copying the one of what is shown, and the address of the page, which follows both ways.

use std::ffi::{OsStr, OsString};

use eframe::egui::OpenUrl;
use motionscope_core::base::Error;

use super::App;
use crate::experiment::source::Source;
use crate::session::Session;
use crate::session::lesson::Address;
use crate::session::link::{self, Link, Parts};
use crate::ui::commands::Command;
use crate::ui::model::address::{AddressBar, Entry, History};

/// Faults of a link that are shown one by one.
const MOST_FAULTS: usize = 3;

/// The unfinished part of a link, and the address of the page.
#[derive(Default)]
pub(super) struct Links {
    /// A session whose clip has to be given again.
    awaited: Option<Session>,
    /// The page of a lesson whose step is shown without its words.
    embedded_page: Option<Address>,
    /// The address of the page, if the window is one of a browser.
    address: Option<(Box<dyn AddressBar>, History)>,
}

impl App {
    /// Has copied links lead to `base` from now on.
    pub fn lead_links_to(&mut self, base: String) {
        self.settings.link_base = Some(base);
    }

    /// Keeps the address of the page in step with what is shown.
    pub fn follow_in(&mut self, address: Box<dyn AddressBar>) {
        let history = History::at(address.fragment());
        self.links.address = Some((address, history));
    }

    /// Opens what a link says.
    pub(super) fn open_link(&mut self, name: &OsStr) {
        let (link, faults) = Link::parse(&name.to_string_lossy());
        let Link { page, description, session, parts } = link;
        self.show_parts(parts);
        (self.links.awaited, self.opening.loading) = (None, None);
        self.links.embedded_page = page.clone().filter(|_| parts == Parts::Embedded);
        let Some(session) = session else {
            if !self.is_at_start() {
                self.toggle_start();
            }
            self.opening.error = faults.into_iter().next();
            return;
        };
        let more = faults.len().saturating_sub(MOST_FAULTS);
        for why in faults.into_iter().take(MOST_FAULTS) {
            self.toasts.fail(format!("The link is opened without this: {why}."));
        }
        if more > 0 {
            self.toasts.fail(format!("{more} more parts of the link are left out."));
        }
        match page.filter(|_| parts != Parts::Embedded) {
            _ if link::own_files(&session.experiment.source).is_some() => self.await_clip(session),
            Some(page) => self.open_linked_page(page, session, name.to_owned()),
            None => self.open_run(session, name, description),
        }
    }

    /// Shows these parts of the window.
    fn show_parts(&mut self, parts: Parts) {
        self.presentation.is_embedded = parts == Parts::Embedded;
        if parts == Parts::Presented && !self.presentation.is_on {
            self.toggle_full_screen();
        }
    }

    /// Opens the run of a link `name` without the words of a lesson.
    fn open_run(&mut self, session: Session, name: &OsStr, description: Option<String>) {
        self.close_lesson();
        let now = self.run.document.experiment();
        if self.run.document.clip().is_none() || !session.experiment.has_clip_of(now) {
            self.load(name.to_owned());
            self.opening.loading.iter_mut().for_each(|loading| loading.description = description.clone());
            return;
        }
        (self.dialogs.start, self.opening.loading, self.opening.error) = (None, None, None);
        self.run.player.pause();
        self.take(session);
        self.toasts.describe(description);
    }

    /// Says which files have to be given again for the clip of a link, unless it is open.
    fn await_clip(&mut self, session: Session) {
        let source = &session.experiment.source;
        if self.run.document.source().is_some_and(|open| has_files_of(open, source)) {
            (self.dialogs.start, self.opening.error) = (None, None);
            return self.take(session);
        }
        let beside = session.experiment.given.paths().filter_map(|path| path.file_name());
        let files = link::own_files(source).into_iter().flatten().chain(beside.map(OsStr::to_owned));
        let files: Vec<String> = files.map(|name| name.to_string_lossy().into_owned()).collect();
        let files = files.join(" and ");
        let key = Command::Open.key();
        let why = format!(
            "the link names {files} but does not contain the file: drop {files} here, or open it ({key}), and the link is applied"
        );
        if self.run.document.clip().is_none() && !self.is_at_start() {
            self.toggle_start();
        }
        self.opening.error = Some(Error::new(why));
        self.links.awaited = Some(session);
    }

    /// The session that waits for the clip `source`, which is opened.
    pub(super) fn awaited_session(&mut self, source: &Source) -> Option<Session> {
        self.links.awaited.take_if(|session| has_files_of(source, &session.experiment.source))
    }

    /// The part behind the `#` of the link of what is shown.
    ///
    /// # Errors
    /// Why it has none.
    fn fragment(&self) -> Result<String, Error> {
        if self.run.document.has_own_clip() {
            let key = Command::OutOfStage.key();
            let why = "this stage works on pictures that its parent computes, which a link cannot name";
            return Err(Error::new(format!("{why}; close the stage ({key}), then copy the link")));
        }
        let shown = self.run.view.shown.as_deref().ok_or_else(|| Error::new("no run is shown"))?;
        let page = self.course.lesson.as_ref().map(|open| open.address()).or(self.links.embedded_page.as_ref());
        Link::of(&self.session(shown), page)
    }

    /// The address before the `#` of a link.
    fn link_base(&self) -> String {
        match &self.links.address {
            Some((address, _)) => address.base(),
            None => self.settings.link_base.clone().unwrap_or_else(|| link::PUBLISHED.to_owned()),
        }
    }

    /// Copies the link of what is shown.
    pub(super) fn copy_link(&mut self) {
        if self.is_unsaved() {
            return self.refuse_unsaved();
        }
        match self.fragment() {
            Err(why) => self.toasts.fail(format!("Not copied: {why}.")),
            Ok(fragment) => {
                self.ctx.copy_text(format!("{}#{fragment}", self.link_base()));
                let is_own = self.run.document.source().is_some_and(|source| link::own_files(source).is_some());
                let clip = if is_own { " It names the clip, which has to be given with it." } else { "" };
                let ink = if self.ink().is_empty() { "" } else { " Ink is saved in a session, not in a link." };
                self.toasts.tell(format!("Link copied: it opens this step.{clip}{ink}"));
            }
        }
    }

    /// Opens the whole window at the step that is shown, in a new tab.
    pub(super) fn open_whole(&mut self) {
        match self.fragment() {
            Ok(fragment) => self.ctx.open_url(OpenUrl::new_tab(format!("{}#{fragment}", self.link_base()))),
            Err(why) => self.toasts.fail(format!("Not opened: {why}.")),
        }
    }

    /// Opens what the address says if it has changed, and has it say what is shown otherwise.
    pub(super) fn follow_address(&mut self) {
        let Some((address, history)) = &mut self.links.address else { return };
        if history.is_changed(&address.fragment()) {
            let link = OsString::from(format!("#{}", address.fragment()));
            return self.open_link(&link);
        }
        let now = self.ctx.input(|input| input.time);
        if let Some(wait) = history.wait(now) {
            return self.ctx.request_repaint_after_secs(wait);
        }
        let Some((place, fragment)) = self.shown_place() else { return };
        let is_embedded = self.presentation.is_embedded;
        let parts = match self.presentation.is_on {
            _ if is_embedded => Parts::Embedded,
            true => Parts::Presented,
            false => Parts::All,
        };
        let Some((address, history)) = &mut self.links.address else { return };
        let fragment = if fragment.is_empty() { fragment } else { parts.added_to(fragment) };
        if let Some(entry) = history.note(place, &fragment, now) {
            // The pages around a frame have their own way back.
            if !address.write(&fragment, if is_embedded { Entry::Same } else { entry }) {
                history.stays_at(address.fragment());
            }
        }
    }

    /// A text that is the same at all steps of the run that is open, and the link of the step; `None` while something is being opened.
    fn shown_place(&self) -> Option<(String, String)> {
        let is_coming = self.opening.loading.is_some() || self.run.view.busy;
        if is_coming || self.opening.error.is_some() {
            return None;
        }
        if self.is_at_start() {
            return Some((String::new(), String::new()));
        }
        let lesson = self.course.lesson.as_ref();
        if self.is_unsaved() || lesson.is_some_and(|open| !open.has_arrived()) {
            return None;
        }
        let page = lesson.map(|open| open.address().name().to_string_lossy().into_owned()).unwrap_or_default();
        let clip = match self.run.document.source()? {
            Source::Synth { id, .. } => (*id).to_owned(),
            file => file.to_string(),
        };
        let estimator = self.run.document.estimator().info().id;
        Some((format!("{page} {clip} {estimator}"), self.fragment().ok()?))
    }
}

/// Whether the files of both clips have the same names.
fn has_files_of(open: &Source, named: &Source) -> bool {
    link::own_files(open).is_some_and(|files| link::own_files(named) == Some(files))
}
