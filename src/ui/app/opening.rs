//! Opening clips, sessions and samples, and asking the system for a path.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use eframe::egui::ViewportCommand;
use motionscope_core::base::Error;
use motionscope_core::course::examples::{self, Example};
use motionscope_core::data::{Clip, ClipInfo};
use motionscope_core::run::{Cursor, Info};
use motionscope_core::synth::Sample;
use web_time::Instant;

use super::App;
use super::dialogs::Overlay;
use super::given::Incomplete;
use crate::experiment::source::Source;
use crate::files;
use crate::media::camera::is_unsaved;
use crate::media::{Given, Open};
use crate::session::lesson::Address;
use crate::session::link::Link;
use crate::session::{example, trust};
use crate::ui::commands::Browse;
use crate::ui::dialogs::open::State;
use crate::ui::model::document::Document;
use crate::ui::model::loader::{Beside, Loading, Opened};
use crate::ui::model::snapshot::Place;

/// The clip that is being opened, and the outcome.
#[derive(Default)]
pub(super) struct Opening {
    /// The clip or session that is being opened on another thread.
    pub loading: Option<Loading>,
    /// What went wrong and was not read yet.
    pub error: Option<Error>,
    /// The session or lesson that the user is asked to trust, as it was to be opened, while the error says so.
    pub asked: Option<OsString>,
    /// A path that the system's dialog will deliver.
    pub browsing: Option<(Browse, Receiver<Option<PathBuf>>)>,
    /// The purpose of the browser's dialog that was opened last.
    pub chooser: Option<Browse>,
    /// A session that waits for files.
    pub incomplete: Option<Incomplete>,
}

impl Opening {
    /// Whether the error in sight asks for trust.
    pub fn asks_for_trust(&self) -> bool {
        self.error.is_some() && self.asked.is_some()
    }

    /// The opened clip, once the other thread is done with it.
    pub fn loaded(&mut self) -> Option<(Result<Opened, Error>, Loading)> {
        let outcome = self.loading.as_ref()?.work.take()?;
        Some((outcome, self.loading.take()?))
    }

    /// Notes that `name` waits to be trusted, and why.
    pub fn ask_for_trust(&mut self, name: &OsStr, error: &Error) {
        self.error = Some(error.clone());
        self.asked = Some(name.to_owned());
    }

    /// Delivers the path that the system's dialog has found, once it has; an error if there is no such dialog.
    pub fn browsed(&mut self) -> Option<(Browse, Result<Option<PathBuf>, TryRecvError>)> {
        let (wanted, delivery) = self.browsing.as_ref()?;
        let (wanted, path) = (*wanted, delivery.try_recv());
        if path == Err(TryRecvError::Empty) {
            return None;
        }
        self.browsing = None;
        Some((wanted, path))
    }
}

impl App {
    /// The opened clip, once the other thread is done with it.
    pub(super) fn receive_opened(&mut self) {
        let Some((outcome, loading)) = self.opening.loaded() else { return };
        match outcome {
            Ok(opened) => {
                self.opened(opened, Path::new(&loading.name));
                self.toasts.describe(loading.description);
            }
            Err(error) => self.not_opened(Path::new(&loading.name), error),
        }
    }

    /// Receives the path from the system's file dialog.
    pub(super) fn browsed(&mut self) {
        let Some((wanted, path)) = self.opening.browsed() else { return };
        let is_right = matches!(wanted, Browse::RightFile | Browse::RightFolder);
        let opens = is_right || matches!(wanted, Browse::File | Browse::Folder);
        match (path, &mut self.dialogs.overlay) {
            (Ok(Some(path)), _) if is_right => self.open_right_view(path.into()),
            (Ok(Some(path)), _) if opens => self.open(path),
            (Ok(Some(path)), Overlay::Save(state)) => state.path.text = path.display().to_string(),
            (Ok(Some(path)), Overlay::Compare(state)) => state.file.text = path.display().to_string(),
            (Ok(_), _) => {}
            (Err(_), _) => {
                self.toasts.fail("The system has no file dialog. Type or paste the path instead.");
                if opens {
                    let dialog = if is_right { State::of_right_view() } else { State::default() };
                    self.dialogs.overlay = Overlay::Open(Box::new(dialog));
                }
            }
        }
    }

    /// Opens a file, a folder, a session or a `synth:` scene on another thread, ground truth for the open clip, a lesson, or what
    /// a link says.
    pub fn open(&mut self, name: impl Into<OsString>) {
        let name = name.into();
        self.opening.asked = None;
        if Link::is_one(&name) {
            return self.open_link(&name);
        }
        match Address::parse(&name) {
            Some(address) => self.open_page(address),
            None => self.load(name),
        }
    }

    /// Opens what is no lesson, or the step of a lesson's page.
    pub(super) fn load(&mut self, name: OsString) {
        self.run.player.pause();
        self.opening.error = None;
        let ctx = self.ctx.clone();
        let beside = self.run.document.source().cloned();
        let beside = beside.map(|source| Beside { source, given: self.run.document.experiment().given.clone() });
        let description = example::of_name(&name).map(example::description);
        let loading = Loading::new(name, beside, move || ctx.request_repaint());
        self.opening.loading = Some(Loading { description, ..loading });
    }

    /// Opens the right view of the clip on another thread; the clip is opened again with it.
    pub(super) fn open_right_view(&mut self, path: OsString) {
        self.run.player.pause();
        self.opening.error = None;
        let Some(source) = self.run.document.source().cloned() else { return };
        let ctx = self.ctx.clone();
        let beside = Beside { source, given: self.run.document.experiment().given.clone() };
        self.opening.loading = Some(Loading::right_view(path, beside, move || ctx.request_repaint()));
    }

    /// Opens a bundled sample where it was left, or at its start.
    pub fn open_sample(&mut self, sample: &'static Sample) {
        self.run.player.pause();
        self.opening.loading = None;
        let source = Source::Synth { id: sample.id, difficulty: sample.difficulty() };
        let clip = match source.open(&Open::default()) {
            Ok(opened) => opened.clip,
            Err(error) => {
                self.opening.error = Some(error);
                return;
            }
        };
        self.note_place();
        self.course.note_page(self.run.view.shown.as_deref());
        self.dialogs.start = None;
        let is_another = self.run.document.source().is_some_and(|open| *open != source);
        let left = self.run.document.open(clip, source, Given::default());
        self.begin(left);
        if is_another {
            self.settings.look.view = self.run.own_view();
        }
        self.go_on(Place::OPENING);
    }

    /// Opens an example of the estimator `id`, and says what it shows once it is open.
    pub fn open_example(&mut self, id: &str, example: &'static Example) {
        self.open(example::name(id, example));
    }

    /// Opens the example of the estimator after the one that is open, or its first one.
    pub(super) fn next_example(&mut self) {
        let info = self.run.document.estimator().info();
        let all: Vec<_> = examples::of(info.id).collect();
        let is_open = |one: &&Example| {
            example::session(info.id, one).is_ok_and(|session| session.experiment == *self.run.document.experiment())
        };
        // While one is being opened the next one is the one after it.
        let is_coming = |one: &&Example| {
            self.opening.loading.as_ref().is_some_and(|loading| *loading.name == *example::name(info.id, one))
        };
        let now = all.iter().position(is_coming).or_else(|| all.iter().position(is_open));
        let next = now.map_or(0, |now| (now + 1) % all.len());
        match all.get(next) {
            Some(example) => self.open_example(info.id, example),
            None => self.toasts.hint(format!("There is no example of {} yet.", info.name)),
        }
    }

    fn opened(&mut self, opened: Opened, path: &Path) {
        let Opened { clip, source, given, session, inputs, first_known } = opened;
        let session = session.or_else(|| self.awaited_session(&source));
        self.note_place();
        // The clip of a page leads away from no page.
        if self.course.lesson.as_ref().is_none_or(|open| open.opened_as() != path.as_os_str()) {
            self.course.note_page(self.run.view.shown.as_deref());
        }
        self.dialogs.start = None;
        // Whoever asked for it in the dialog is done there.
        if matches!(&self.dialogs.overlay, Overlay::Open(state) if state.is_opening()) {
            self.dialogs.overlay = Overlay::None;
        }
        // The truth of a clip is no clip, nor are its detections and its right view.
        let is_right = given.right.as_ref().is_some_and(|view| view.path() == path);
        let is_of_clip = match () {
            () if given.truth.as_deref() == Some(path) => Some("ground truth"),
            () if given.detections.as_deref() == Some(path) => Some("detections"),
            () => None,
        };
        if let Some(what) = is_of_clip.filter(|_| session.is_none()) {
            let name = path.file_name().unwrap_or(path.as_os_str()).display();
            self.toasts.tell(format!("{name} gives the {what} of the open clip."));
        } else if files::exists(path) && !is_right && !is_unsaved(path) {
            self.settings.remember(path);
        }
        let is_another =
            self.run.document.source().is_some_and(|open| *open != source) && !self.is_saved_recording(path);
        if self.run.document.source() != Some(&source) {
            self.tell_warnings(clip.info());
        }
        let left = self.run.document.open(clip, source, given);
        self.run.document.read_from(inputs);
        self.keep_needed();
        self.begin(left.filter(|_| session.is_none()));
        if is_another {
            self.settings.look.view = self.run.own_view();
        }
        let Some(mut session) = session else {
            self.recording_opened(path);
            self.choose_fitting();
            // Where there are no pictures, what was detected is the first thing to be seen.
            let is_blank = self.run.document.clip().is_some_and(Clip::is_blank);
            let start = if is_blank { Place::at(Cursor { unit: 0, event: 1 }) } else { Place::OPENING };
            if !self.go_on(start) {
                self.begin_where_known(first_known);
                self.ask_for_region();
            }
            return;
        };
        // A page is entered where it is turned to, not where its run was left.
        if let Some(open) = self.course.lesson.as_ref().filter(|open| open.opened_as() == path.as_os_str()) {
            session.position.cursor = Some(open.landing());
        }
        self.take(session);
    }

    /// Tells the first warning about a clip; the card of the clip has them all.
    fn tell_warnings(&mut self, info: &ClipInfo) {
        let name = &info.name;
        match info.warnings.as_slice() {
            [] => {}
            [only] => self.toasts.tell(format!("{name}: {only}.")),
            [first, rest @ ..] => {
                self.toasts.tell(format!("{name}: {first}. Further warnings: {}, beside the parameters.", rest.len()));
            }
        }
    }

    fn not_opened(&mut self, path: &Path, error: Error) {
        if !files::exists(path) {
            self.settings.forget(path);
        }
        if self.ask_for_trust(path, path.as_os_str(), &error) {
            return;
        }
        self.wait_for_files(path);
        if self.opening.incomplete.is_none() {
            self.keep_needed();
        }
        match &mut self.dialogs.overlay {
            // Where it was asked for, it can be asked for again.
            Overlay::Open(state) if state.is_opening() => state.refuse(&error),
            _ => self.opening.error = Some(error),
        }
    }

    /// Asks whether the session or lesson in `file`, which was to be opened by `name`, may open files elsewhere, if that is why it was
    /// refused; returns whether it asks.
    pub(super) fn ask_for_trust(&mut self, file: &Path, name: &OsStr, error: &Error) -> bool {
        let asks = trust::is_asked(file);
        if asks {
            self.dialogs.overlay = Overlay::None;
            self.opening.ask_for_trust(name, error);
        }
        asks
    }

    /// Opens the session or lesson with the files that it names.
    pub(super) fn trust(&mut self) {
        let Some(name) = self.opening.asked.take() else { return };
        let address = Address::parse(&name);
        trust::trust(address.as_ref().and_then(Address::file).unwrap_or(Path::new(&name)));
        self.opening.error = None;
        self.open(name);
    }

    /// Reports that opening another clip has closed a stage.
    fn begin(&mut self, left: Option<&Info>) {
        self.opening.error = None;
        if let Some(Info { name, .. }) = left {
            self.toasts.hint(format!("Another clip is open, so the stage was closed; {name} runs on the new clip."));
        }
        self.panes.states.stage.follow_again();
        self.settings.leave_end();
        self.panes.states.stage.placing = None;
        self.ctx.send_viewport_cmd(ViewportCommand::Title(title(&self.run.document)));
    }

    /// Opens the file dialog of the browser, or that of the system on another thread.
    pub(super) fn browse(&mut self, wanted: Browse) {
        if files::IN_PAGE {
            self.opening.chooser = Some(wanted);
            return files::ask(matches!(wanted, Browse::Folder | Browse::RightFolder));
        }
        let (sender, receiver) = channel();
        let ctx = self.ctx.clone();
        let ask = move || {
            let begun = Instant::now();
            let path = ask_system(wanted);
            // Nobody cancels that fast: there was no dialog. Hanging up says so.
            if path.is_some() || begun.elapsed().as_millis() > 150 {
                // The window may have closed meanwhile.
                sender.send(path).ok();
            }
            drop(sender);
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("dialog".into()).spawn(ask) {
            Ok(_) => self.opening.browsing = Some((wanted, receiver)),
            Err(error) => self.toasts.fail(format!("The file dialog could not be started: {error}. Type the path.")),
        }
    }
}

/// The title of the window.
fn title(document: &Document) -> String {
    match document.clip() {
        Some(clip) => format!("{} – Motionscope", clip.info().name),
        None => "Motionscope".into(),
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn ask_system(wanted: Browse) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new();
    match wanted {
        Browse::File => dialog.set_title("Open a clip or a session").pick_file(),
        Browse::RightFile => dialog.set_title("Open the right view").pick_file(),
        Browse::RightFolder => dialog.set_title("Open the folder of the right view").pick_folder(),
        Browse::Folder => dialog.set_title("Open a folder of images").pick_folder(),
        Browse::SaveFile => dialog.set_title("Save as").save_file(),
        Browse::SaveFolder => dialog.set_title("Save in a folder").pick_folder(),
    }
}

#[cfg(target_arch = "wasm32")]
fn ask_system(_: Browse) -> Option<PathBuf> {
    None
}
