//! File operations of the window: opening, browsing, saving.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{TryRecvError, channel};
use std::time::Instant;

use eframe::egui::ViewportCommand;
use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::course::examples::{self, Example};
use motionscope_core::data::Clip;
use motionscope_core::run::{AnyEstimator, Cursor, Info};
use motionscope_core::synth::Sample;

use crate::experiment::first;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position, is_of_pair, told_of_pair};
use crate::media::camera::is_unsaved;
use crate::media::export;
use crate::media::{Given, Open};
use crate::paint::charts::heat_map;
use crate::paint::number;
use crate::session::lesson::Address;
use crate::session::{Session, VisiblePart, example, trust};
use crate::ui::app::camera::Saving;
use crate::ui::app::window::{App, Overlay, title};
use crate::ui::commands::{Browse, Order, OutputKind};
use crate::ui::dialogs::open::State;
use crate::ui::dialogs::save::{self, Kind};
use crate::ui::model::loader::{Beside, Loading, Opened};
use crate::ui::model::paper;
use crate::ui::model::predict::Score;
use crate::ui::model::settings::LeftAt;
use crate::ui::model::snapshot::{Hold, Job, Place, Snapshot, surface};
use crate::ui::model::writer::{self, Work, Writing};
use crate::ui::panes::status;
use crate::ui::stage::{Lens, Zoom};
use crate::view::look::{Changes, Look};

impl App {
    /// Receives the results of other threads, and a request to quit.
    pub(super) fn receive(&mut self) {
        self.hold_quit();
        if let Some((outcome, loading)) = self.loaded() {
            match outcome {
                Ok(opened) => {
                    self.opened(opened, Path::new(&loading.name));
                    self.toasts.describe(loading.description);
                }
                Err(error) => self.not_opened(Path::new(&loading.name), error),
            }
        }
        self.walker.tend();
        self.view = self.walker.view();
        // While a run takes long to start, its frames are shown instead of those of another clip or estimator.
        let is_late = self.view.busy_for.is_some_and(|time| time > status::LATE);
        let id = self.document.estimator().info().id;
        let is_ours = |shown: &Snapshot| self.document.is_of_clip(shown) && shown.info.id == id;
        if let Some(coming) = self.view.coming.take().filter(|_| is_late)
            && !self.view.shown.as_deref().is_some_and(is_ours)
        {
            self.view.shown = Some(coming);
        }
        self.hold_back();
        self.tell_of_untested();
        // A clip that no run can be made of is not shown under another's name.
        if self.view.refused.is_some() {
            self.view.shown = self.view.shown.take().filter(|shown| self.document.is_of_clip(shown));
        }
        if let Some(outcome) = self.writing.as_ref().and_then(|writing| writing.work.take()) {
            let folder = self.writing.take().and_then(|writing| writing.folder);
            match outcome {
                Ok(text) => {
                    self.clip_saved();
                    // Only where writing went well is the next file offered beside it.
                    self.folder = folder;
                    self.toasts.tell(text);
                }
                Err(error) => self.toasts.fail(format!("Not saved: {error}.")),
            }
        }
        self.browsed();
    }

    /// Takes what was being opened, once the other thread is done with it.
    fn loaded(&mut self) -> Option<(Result<Opened, Error>, Loading)> {
        let outcome = self.loading.as_ref()?.work.take()?;
        Some((outcome, self.loading.take()?))
    }

    /// Says of a displacement that was clicked, and that no step of its unit tests, that it was not tested.
    fn tell_of_untested(&mut self) {
        let Some((unit, at)) = self.states.sought.filter(|_| !self.view.busy) else { return };
        self.states.sought = None;
        let Some(shown) = self.view.shown.as_deref().filter(|shown| shown.cursor.unit == unit) else { return };
        let Some(surface) = surface(&shown.step) else { return };
        if heat_map::event(surface, at).is_none() {
            let whose = shown.info.name;
            let cost = heat_map::any_cost(surface, at).map_or_else(String::new, |cost| {
                format!(" Its {} is {}, as the faint part of the surface shows.", surface.title, number(cost))
            });
            let at = heat_map::vector(at);
            self.toasts.tell(format!("{whose} does not test {at} for this block; its last step is shown.{cost}"));
        }
    }

    /// Receives the path from the system's file dialog.
    fn browsed(&mut self) {
        let Some((wanted, delivery)) = &self.browsing else { return };
        let (wanted, path) = (*wanted, delivery.try_recv());
        if path == Err(TryRecvError::Empty) {
            return;
        }
        self.browsing = None;
        let is_right = matches!(wanted, Browse::RightFile | Browse::RightFolder);
        let opens = is_right || matches!(wanted, Browse::File | Browse::Folder);
        match (path, &mut self.overlay) {
            (Ok(Some(path)), _) if is_right => self.open_right_view(path.into()),
            (Ok(Some(path)), _) if opens => self.open(path),
            (Ok(Some(path)), Overlay::Save(state)) => state.path.text = path.display().to_string(),
            (Ok(Some(path)), Overlay::Compare(state)) => state.file.text = path.display().to_string(),
            (Ok(_), _) => {}
            (Err(_), _) => {
                self.toasts.fail("The system has no file dialog. Type or paste the path instead.");
                if opens {
                    let dialog = if is_right { State::of_right_view() } else { State::default() };
                    self.overlay = Overlay::Open(Box::new(dialog));
                }
            }
        }
    }

    /// Opens a file, a folder, a session or a `synth:` scene on another thread, ground truth for the open clip, or a lesson.
    pub fn open(&mut self, name: impl Into<OsString>) {
        let name = name.into();
        self.asked = None;
        match Address::parse(&name) {
            Some(address) => self.open_page(address),
            None => self.load(name),
        }
    }

    /// Opens what is no lesson, or the step of a lesson's page.
    pub(super) fn load(&mut self, name: OsString) {
        self.player.pause();
        self.error = None;
        let ctx = self.ctx.clone();
        let beside = self.document.source().cloned();
        let beside = beside.map(|source| Beside { source, given: self.document.experiment().given.clone() });
        let description = example::of_name(&name).map(example::description);
        let loading = Loading::new(name, beside, move || ctx.request_repaint());
        self.loading = Some(Loading { description, ..loading });
    }

    /// Opens the right view of the clip on another thread; the clip is opened again with it.
    pub(super) fn open_right_view(&mut self, path: OsString) {
        self.player.pause();
        self.error = None;
        let Some(source) = self.document.source().cloned() else { return };
        let ctx = self.ctx.clone();
        let beside = Beside { source, given: self.document.experiment().given.clone() };
        self.loading = Some(Loading::right_view(path, beside, move || ctx.request_repaint()));
    }

    /// Opens a bundled sample where it was left, or at its start.
    pub fn open_sample(&mut self, sample: &'static Sample) {
        self.player.pause();
        self.loading = None;
        let source = Source::Synth { id: sample.id, difficulty: sample.difficulty() };
        let clip = match source.open(&Open::default()) {
            Ok(clip) => clip,
            Err(error) => {
                self.error = Some(error);
                return;
            }
        };
        self.note_place();
        self.note_page();
        self.start = None;
        let is_another = self.document.source().is_some_and(|open| *open != source);
        let left = self.document.open(clip, source, Given::default());
        self.begin(left);
        if is_another {
            self.settings.look.view = Some(self.own_view());
        }
        self.go_on(Place::OPENING);
    }

    /// Opens an example of the estimator `id`, and says what it shows once it is open.
    pub fn open_example(&mut self, id: &str, example: &'static Example) {
        self.open(example::name(id, example));
    }

    /// Opens the example of the estimator after the one that is open, or its first one.
    pub(super) fn next_example(&mut self) {
        let info = self.document.estimator().info();
        let all: Vec<_> = examples::of(info.id).collect();
        let is_open = |one: &&Example| {
            example::session(info.id, one).is_ok_and(|session| session.experiment == *self.document.experiment())
        };
        // While one is being opened the next one is the one after it.
        let is_coming =
            |one: &&Example| self.loading.as_ref().is_some_and(|loading| *loading.name == *example::name(info.id, one));
        let now = all.iter().position(is_coming).or_else(|| all.iter().position(is_open));
        let next = now.map_or(0, |now| (now + 1) % all.len());
        match all.get(next) {
            Some(example) => self.open_example(info.id, example),
            None => self.toasts.hint(format!("There is no example of {} yet.", info.name)),
        }
    }

    /// Notes where the clip is left that is open.
    pub(super) fn note_place(&mut self) {
        let Some(shown) = self.view.shown.as_deref().filter(|shown| self.document.is_of_clip(shown)) else { return };
        let experiment = &shown.subject.experiment;
        // A stage has its own place, and several have one that none of them has; what is not saved is not found again.
        let has_place = self.document.parents().len() == 0 && experiment.side_by_side.is_empty();
        if !has_place || self.is_unsaved() {
            return;
        }
        let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.into());
        let (source, run) = (experiment.source.clone().map_path(whole), run_of(&*experiment.estimator));
        self.settings.leave(LeftAt {
            clip: source.to_string(),
            run,
            frame: experiment.frame,
            step: shown.cursor.to_string(),
        });
    }

    /// Goes on where the clip was left that is open now, or else begins at `start`; gives whether it was left anywhere.
    fn go_on(&mut self, start: Place) -> bool {
        let frame = self.left_at().map(|left| left.frame);
        if let Some(frame) = frame {
            self.document.go_to_frame(frame);
        }
        self.walk_from(self.left_in_run().map_or(start, Place::at));
        frame.is_some()
    }

    /// Where the clip was left that is open now.
    fn left_at(&self) -> Option<&LeftAt> {
        let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.into());
        let clip = self.document.source()?.clone().map_path(whole).to_string();
        self.settings.left_at(&clip)
    }

    /// The step at which the present run of that clip was left: with other parameters, on another pair or in lockstep the same
    /// step is another one.
    fn left_in_run(&self) -> Option<Cursor> {
        let is_alone = self.document.side_by_side().is_empty();
        let is_same =
            |left: &&LeftAt| left.run == run_of(self.document.estimator()) && left.frame == self.document.frame();
        self.left_at().filter(|left| is_alone && is_same(left))?.step.parse().ok()
    }

    fn opened(&mut self, opened: Opened, path: &Path) {
        let Opened { clip, source, given, session, inputs, first_known } = opened;
        self.note_place();
        // The clip of a page leads away from no page.
        if self.lesson.as_ref().is_none_or(|open| open.address().name() != path.as_os_str()) {
            self.note_page();
        }
        self.start = None;
        // Whoever asked for it in the dialog is done there.
        if matches!(&self.overlay, Overlay::Open(state) if state.is_opening()) {
            self.overlay = Overlay::None;
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
        } else if path.exists() && !is_right && !is_unsaved(path) {
            self.settings.remember(path);
        }
        let is_another = self.document.source().is_some_and(|open| *open != source) && !self.is_saved_recording(path);
        let left = self.document.open(clip, source, given);
        self.document.read_from(inputs);
        self.begin(left.filter(|_| session.is_none()));
        if is_another {
            self.settings.look.view = Some(self.own_view());
        }
        let Some(mut session) = session else {
            self.recording_opened(path);
            self.choose_tracker();
            // Where there are no pictures, what was detected is the first thing to be seen.
            let is_blank = self.document.clip().is_some_and(Clip::is_blank);
            let start = if is_blank { Place::at(Cursor { unit: 0, event: 1 }) } else { Place::OPENING };
            if !self.go_on(start) {
                self.begin_where_known(first_known);
                self.ask_for_region();
            }
            return;
        };
        // A page is entered where it is turned to, not where its run was left.
        if let Some(open) = self.lesson.as_ref().filter(|open| open.address().name() == path.as_os_str()) {
            session.position.cursor = Some(open.landing());
        }
        self.take(session);
    }

    /// Takes what a session sets, on the clip that is open.
    pub(super) fn take(&mut self, session: Session) {
        let Session { experiment, position, look, sight, freehand } = session;
        let frame = experiment.frame;
        self.document.restore(experiment);
        self.tell_of_frame(frame);
        self.look_as(&look, sight);
        let Position { cursor, held } = position;
        let cursor = cursor.or_else(|| self.left_in_run()).unwrap_or_default();
        let job = self.document.job_at(Place { hold: Hold::Set(held), ..Place::at(cursor) });
        job.iter().for_each(|job| self.restore_ink(&job.subject, freehand.clone()));
        self.start(job);
    }

    /// Looks at the pictures as a session says. A view or a part of them that was chosen for what was open before goes with that.
    pub(super) fn look_as(&mut self, look: &Changes, sight: Option<VisiblePart>) {
        self.settings.look = look.over(Look { view: Some(self.own_view()), ..self.settings.look });
        self.states.stage.follow_again();
        if let Some(VisiblePart { center, zoom, .. }) = sight {
            self.states.stage.zoom = Zoom::At { center, scale: zoom };
        }
    }

    /// Begins with the first pair whose true flow is known, and says so.
    fn begin_where_known(&mut self, first: Option<usize>) {
        let Some(frame) = first.filter(|_| is_of_pair(self.document.estimator())) else { return };
        if self.document.go_to_frame(frame) {
            self.toasts.tell(format!("{} Choose another one under Clip.", told_of_pair(frame)));
            self.walk_from(Place::OPENING);
        }
    }

    /// Takes a tracker where there are no pictures to be looked at.
    fn choose_tracker(&mut self) {
        let is_blank = self.document.clip().is_some_and(Clip::is_blank);
        let Some(tracker) =
            estimator(first::OF_DETECTIONS).ok().filter(|_| is_blank && self.document.estimator().needs_pictures())
        else {
            return;
        };
        let was_single = self.shows_frame_alone();
        let source = self.document.experiment().source.clone();
        self.document.restore(Experiment::new(source, tracker));
        self.suit_view(was_single);
    }

    /// Reports if the clip has no pair that starts at the session's `frame`.
    fn tell_of_frame(&mut self, frame: usize) {
        let (Some(clip), now) = (self.document.clip(), self.document.frame()) else { return };
        if now != frame {
            let name = &clip.info().name;
            self.toasts.fail(format!(
                "The session refers to frame {frame}, but the last pair of {name} starts at frame {now}, which is shown instead."
            ));
        }
    }

    /// Runs what is set, from `place` on.
    pub fn walk_from(&mut self, place: Place) {
        let job = self.document.job_at(place);
        self.start(job);
    }

    /// Starts a run, if there is one to start: what an example says is not about another one.
    pub(super) fn start(&mut self, job: Option<Job>) {
        self.toasts.describe(None);
        if let Some(job) = job {
            self.take_ink(&job.subject);
            self.walker.start(job);
        }
    }

    fn not_opened(&mut self, path: &Path, error: Error) {
        if !path.exists() {
            self.settings.forget(path);
        }
        if self.ask_for_trust(path, path.as_os_str(), &error) {
            return;
        }
        match &mut self.overlay {
            // Where it was asked for, it can be asked for again.
            Overlay::Open(state) if state.is_opening() => state.refuse(&error),
            _ => self.error = Some(error),
        }
    }

    /// Asks whether the session or lesson in `file`, which was to be opened by `name`, may open files elsewhere, if that is why it was
    /// refused; returns whether it asks.
    pub(super) fn ask_for_trust(&mut self, file: &Path, name: &OsStr, error: &Error) -> bool {
        let asks = trust::is_asked(file);
        if asks {
            self.overlay = Overlay::None;
            self.error = Some(error.clone());
            self.asked = Some(name.to_owned());
        }
        asks
    }

    /// Whether the error in sight asks for trust.
    pub(super) fn asks_for_trust(&self) -> bool {
        self.error.is_some() && self.asked.is_some()
    }

    /// Opens the session or lesson with the files that it names.
    pub(super) fn trust(&mut self) {
        let Some(name) = self.asked.take() else { return };
        let address = Address::parse(&name);
        trust::trust(address.as_ref().and_then(Address::file).unwrap_or(Path::new(&name)));
        self.error = None;
        self.open(name);
    }

    /// Reports that opening another clip has closed a stage.
    fn begin(&mut self, left: Option<&Info>) {
        self.error = None;
        if let Some(Info { name, .. }) = left {
            self.toasts.hint(format!("Another clip is open, so the stage was closed; {name} runs on the new clip."));
        }
        self.states.stage.follow_again();
        self.settings.leave_end();
        self.states.stage.placing = None;
        self.ctx.send_viewport_cmd(ViewportCommand::Title(title(&self.document)));
    }

    /// Opens the system's file dialog on another thread.
    pub(super) fn browse(&mut self, wanted: Browse) {
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
            Ok(_) => self.browsing = Some((wanted, receiver)),
            Err(error) => self.toasts.fail(format!("The file dialog could not be started: {error}. Type the path.")),
        }
    }

    /// Opens the dialog that saves `kind`.
    pub(super) fn save_as(&mut self, kind: Kind) {
        // What is written is what is shown: it stays as long as the dialog asks.
        self.player.pause();
        let Some(shown) = self.view.shown.as_deref() else { return };
        if kind == Kind::Session && self.document.has_own_clip() {
            let why = "This stage works on pictures that its parent computes, which a session cannot store.";
            self.toasts.fail(format!("{why} Close the stage (Shift+I), then save."));
            return;
        }
        if kind == Kind::Session && self.is_unsaved() {
            return self.refuse_unsaved();
        }
        let name = self.document.clip().map_or_else(String::new, |clip| clip.info().name.clone());
        let beside = match self.document.source() {
            Some(Source::File(path) | Source::Pair([path, _])) if !is_unsaved(path) => {
                path.parent().map(Path::to_owned)
            }
            _ => None,
        };
        let folder = self.folder.clone().or(beside).unwrap_or_else(|| std::env::current_dir().unwrap_or_default());
        // Results among the frames would become frames, or could not be told from them.
        let folder = shown.subject.inputs.outside(&folder);
        let seen = save::Seen { look: self.settings.look, angles: self.states.angles(&shown.step) };
        // A handout is named after its lesson.
        let lesson = self.lesson.as_ref().filter(|_| kind == Kind::Handout);
        let name = lesson.map_or(name, |open| open.lesson().slug.clone());
        let state = save::State::new(kind, &folder, &save::stem(&name), shown, seen);
        self.overlay = Overlay::Save(Box::new(state));
    }

    /// Saves on another thread and reports the outcome.
    pub fn write(&mut self, order: Order) {
        let Some(shown) = self.inked() else { return };
        if self.writing.is_some() {
            self.toasts.fail("Another file is still being saved. Wait or cancel it, then save again.");
            return;
        }
        let folder = order.path.parent().map(Path::to_owned);
        let ctx = self.ctx.clone();
        let changed = move || ctx.request_repaint();
        let inputs = Arc::clone(&shown.subject.inputs);
        self.recorder.saving = None;
        // Its file is not removed while it is read.
        let kept = self.recorder.last.clone();
        let work: Work = match order.what {
            OutputKind::Picture => Box::new(move |order, _| writer::picture(order, &shown)),
            OutputKind::Steps(..) | OutputKind::Animation(..) => {
                let freehand = self.presentation.pen.freehand(&shown.subject);
                Box::new(move |order, progress| writer::steps(order, (&shown, freehand), progress))
            }
            OutputKind::Clip(format) => {
                self.recorder.saving = Saving::of(&shown.subject, &order.path, format);
                Box::new(move |order, progress| writer::clip(order, &shown, progress))
            }
            OutputKind::Handout(_) => {
                let Some(lesson) = self.lesson.as_ref().map(|open| open.lesson().clone()) else { return };
                Box::new(move |order, progress| paper::handout(order, &lesson, progress))
            }
            OutputKind::Worksheet { .. } => {
                let page = self.printed_page(&shown);
                Box::new(move |order, progress| paper::worksheet(order, &shown, page.as_ref(), progress))
            }
            OutputKind::Session => {
                let session = self.session(&shown);
                Box::new(move |order, _| save_session(&session, &order.path))
            }
            OutputKind::Scores => {
                let scores = Score::csv(self.predict.scores());
                Box::new(move |order, _| {
                    export::save_result(&order.path, scores.as_bytes())?;
                    Ok(format!("Saved {}.", order.path.display()))
                })
            }
            OutputKind::Result(export) => {
                let output = self.walker.output(&shown);
                Box::new(move |order, progress| writer::result(&order.path, export, &output, progress))
            }
        };
        self.writing = Some(Writing::new(folder, changed, move |progress| {
            let _kept = kept;
            writer::refuse_losses(&order, &inputs)?;
            work(&order, progress)
        }));
    }

    pub(super) fn session(&self, shown: &Snapshot) -> Session {
        let stage = &self.states.stage;
        let chosen = stage.chosen().filter(|_| stage.zoom != Zoom::Fit);
        let part = |lens: Lens| VisiblePart { center: lens.center.into(), zoom: lens.scale, size: Some(lens.extent()) };
        let sight = chosen.map(part);
        let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.into());
        let mut experiment = shown.subject.experiment.clone();
        experiment.source = experiment.source.map_path(whole);
        experiment.given = experiment.given.map_path(whole);
        let position = Position { cursor: Some(shown.cursor), held: shown.held() };
        let freehand = self.presentation.pen.freehand(&shown.subject);
        Session { experiment, position, look: self.settings.look.into(), sight, freehand }
    }
}

/// An estimator with its parameters, as text that says whether another is the same.
pub(super) fn run_of(estimator: &dyn AnyEstimator) -> String {
    let values = estimator.all_values().into_iter().map(|(name, value)| format!(" {name}={value}"));
    format!("{}{}", estimator.info().id, values.collect::<String>())
}

fn save_session(session: &Session, path: &Path) -> Result<String, Error> {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    session.save(&path)?;
    Ok(format!("Saved {}.", path.display()))
}

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
