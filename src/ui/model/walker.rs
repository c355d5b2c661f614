//! A run on its own thread: moves go in, immutable pictures of the run come out.
//!
//! Nothing here knows the window. A request never waits for an earlier one that takes long: it replaces it.

use std::cell::{OnceCell, RefCell};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use motionscope_core::products::{Assessment, Reference};
use motionscope_core::scene::{Fact, Readout};
use motionscope_core::{Clip, Cursor, Error, Explained, Flow, Histogram, Move, Output, Scene, Step, Stop, Walk};

use super::snapshot::{Hold, Job, Place, Pointed, Snapshot, Subject};
use crate::motion::{Motion, Offer, Site, Want, backward};
use crate::paint::{FlowLayer, Pictures};
use crate::pixel::{Pixel, is_explained, walks_pixels};
use crate::shot::{LastPair, pictures};
use crate::tile::{self, Ending, add_assessment, add_facts, endings, tiles};
use crate::ui::action::Side;

/// A move that works longer than this gives way to the next request; less, and a drag would never arrive anywhere.
const PATIENCE: Duration = Duration::from_millis(60);
/// How often a long move tells how far it is.
const NEWS: Duration = Duration::from_millis(60);
/// Small moves that may wait: more would make a held key run on after it is let go.
const QUEUE: usize = 4;

/// What the walker shows and does just now.
#[derive(Clone, Default)]
pub struct View {
    /// The newest picture of the run; it stays when a new run is refused.
    pub shown: Option<Arc<Snapshot>>,
    /// Why the newest run could not be started.
    pub refused: Option<Error>,
    /// Whether something is being worked on.
    pub busy: bool,
    /// Units done of those that a long move needs.
    pub progress: Option<(usize, usize)>,
    /// Whether the reverse pair is being run.
    pub checking: bool,
}

type Visit = Box<dyn FnOnce(&Arc<Subject>, &dyn Walk) + Send>;

enum Request {
    Go(Move),
    /// To the end or the start of the unit whose result lies at a pixel, or to that pixel itself.
    GoAt([f32; 2], Side),
    /// No pixel is held any longer.
    Release,
    /// To where the run stands, whatever it was on its way to.
    Stay,
    Visit(Visit),
}

/// The desk between the window and the worker.
#[derive(Default)]
struct Desk {
    job: Option<Job>,
    /// A job is on the desk or in hand: small moves wait until it stands at its place.
    starting: bool,
    requests: VecDeque<Request>,
    focus: Option<[f32; 2]>,
    want: Want,
    /// Another pixel is to be explained, or something else of motion is to be seen.
    focus_moved: bool,
    /// The flow of the reverse pair of a run, when it has come.
    backward: Option<(Arc<Subject>, Result<Flow, Error>)>,
    /// Ends the run of the reverse pair at its next chance.
    stop_check: Stop,
    since: Option<Instant>,
    quit: bool,
    view: View,
}

struct Shared {
    desk: Mutex<Desk>,
    wake: Condvar,
    idle: Condvar,
    /// The move at work is to be given up.
    superseded: AtomicBool,
    /// Frames need not be decoded any further: the run that wants them is not wanted itself.
    stop: Stop,
    changed: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A run that is walked on a thread of its own.
pub struct Walker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Walker {
    /// A walker without a run; `changed` is called from its thread whenever [`Walker::view`] has news.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(changed: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            desk: Mutex::default(),
            wake: Condvar::new(),
            idle: Condvar::new(),
            superseded: AtomicBool::new(false),
            stop: Stop::default(),
            changed: Box::new(changed),
        });
        let worker = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("walker".into()).spawn(move || Worker::new(&worker).run())?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Starts another run; the picture of the old one stays until the new one has something to show.
    pub fn start(&self, job: Job) {
        self.ask(true, |desk| {
            self.shared.stop.set(true);
            desk.stop_check.set(true);
            desk.requests.clear();
            desk.starting = true;
            desk.job = Some(job);
        });
    }

    /// Asks for a move. One to a place replaces all others; small moves queue up unless one takes long. A run that
    /// starts comes to its place before a small move goes on from there.
    pub fn go(&self, to: Move) {
        let mut desk = self.shared.desk();
        let slow = !desk.starting && desk.since.is_some_and(|since| since.elapsed() > PATIENCE);
        let replaces = slow || !matches!(to, Move::Rung(..));
        if !replaces && desk.requests.len() >= QUEUE {
            return;
        }
        if replaces {
            desk.requests.retain(|request| matches!(request, Request::Visit(_)));
        }
        desk.requests.push_back(Request::Go(to));
        self.wake(desk, replaces);
    }

    /// Goes to the end or the start of the unit whose result lies at pixel `point` of frame t. Where single pixels are
    /// explained, that one is from now on, until the run moves on to others; if its turn has not come, the run goes there.
    pub fn go_at(&self, point: [f32; 2], side: Side) {
        self.ask(true, |desk| desk.requests.push_back(Request::GoAt(point, side)));
    }

    /// Gives up the move at work, and the check with the reverse pair; the run stays where it stands, a new one at its start.
    pub fn stop(&self) {
        self.ask(true, |desk| {
            desk.stop_check.set(true);
            desk.requests.retain(|request| matches!(request, Request::Visit(_)));
            desk.requests.push_front(Request::Stay);
            if let Some(job) = &mut desk.job {
                job.place = Place { hold: job.place.hold, ..Place::default() };
            }
        });
    }

    /// Explains the pixel `focus` from now on.
    pub fn focus(&self, focus: Option<[f32; 2]>) {
        if self.shared.desk().focus != focus {
            self.ask(false, |desk| {
                desk.focus = focus;
                desk.focus_moved = true;
            });
        }
    }

    /// Explains the pixel at work again, or the one pointed at.
    pub fn release(&self) {
        self.ask(false, |desk| desk.requests.push_back(Request::Release));
    }

    /// Shows `want` of motion from now on.
    pub fn want(&self, want: Want) {
        if self.shared.desk().want != want {
            self.ask(false, |desk| {
                desk.want = want;
                desk.focus_moved = true;
            });
        }
    }

    /// Has `visit` look at the run, on the walker's thread, after what was asked for before.
    pub fn visit(&self, visit: impl FnOnce(&Arc<Subject>, &dyn Walk) + Send + 'static) {
        self.ask(false, |desk| desk.requests.push_back(Request::Visit(Box::new(visit))));
    }

    /// What the run amounts to where `shown` shows it; nothing comes if it has moved on or was replaced.
    pub fn output(&self, shown: &Snapshot) -> Receiver<Output> {
        let (sender, receiver) = channel();
        let (wanted, cursor) = (Arc::clone(&shown.subject), shown.cursor);
        self.visit(move |subject, walk| {
            if Arc::ptr_eq(subject, &wanted) && walk.cursor() == cursor {
                // Whoever asked may have gone.
                sender.send(walk.output()).ok();
            }
        });
        receiver
    }

    /// What there is to show just now.
    pub fn view(&self) -> View {
        self.shared.desk().view.clone()
    }

    /// Waits until nothing is left to do.
    pub fn wait(&self) {
        let mut desk = self.shared.desk();
        while desk.view.busy || desk.view.checking {
            desk = self.shared.idle.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn ask(&self, replaces: bool, put: impl FnOnce(&mut Desk)) {
        let mut desk = self.shared.desk();
        put(&mut desk);
        self.wake(desk, replaces);
    }

    fn wake(&self, mut desk: MutexGuard<'_, Desk>, replaces: bool) {
        desk.view.busy = true;
        if replaces {
            self.shared.superseded.store(true, Ordering::Relaxed);
        }
        self.shared.wake.notify_one();
    }
}

impl Drop for Walker {
    fn drop(&mut self) {
        self.ask(true, |desk| {
            self.shared.stop.set(true);
            desk.stop_check.set(true);
            desk.quit = true;
        });
        if let Some(thread) = self.thread.take() {
            // A worker that panicked has nothing left to tell.
            let _ = thread.join();
        }
    }
}

/// What is seen of motion depends on: where the run stands, what is wanted, and whether the reverse pair is known.
type MotionKey = (Cursor, Want, bool);

/// A run at work.
struct Run {
    subject: Arc<Subject>,
    walk: Box<dyn Walk>,
    clip: Clip,
    pairs: LastPair,
    pair: Pictures,
    /// What the whole run amounts to, once its end was reached.
    end: OnceCell<End>,
    /// The flow of the reverse pair, once it was asked for.
    backward: Option<Result<Flow, Error>>,
    /// What was seen of motion last, where, and whether the reverse pair was known.
    motion: RefCell<Option<(MotionKey, Motion)>>,
}

/// What the end of a run shows beside its last step.
struct End {
    pictures: Pictures,
    assessment: Option<Assessment>,
    /// How many pixels of a dense field have each displacement.
    histogram: Option<Histogram>,
    beside: Vec<Ending>,
}

enum Task {
    Start(Job),
    Request(Request),
    Focus,
    Backward(Arc<Subject>, Result<Flow, Error>),
}

struct Worker<'a> {
    shared: &'a Arc<Shared>,
    run: Option<Run>,
    /// The pixel that was clicked.
    held: Option<[f32; 2]>,
}

impl<'a> Worker<'a> {
    fn new(shared: &'a Arc<Shared>) -> Self {
        Self { shared, run: None, held: None }
    }

    fn run(mut self) {
        while let Some(task) = self.next_task() {
            let outcome = catch_unwind(AssertUnwindSafe(|| self.serve(task)));
            if let Err(panic) = outcome {
                self.run = None;
                self.refuse(panicked(panic.as_ref()));
            }
        }
    }

    /// The next thing to do, or `None` at the end of the session.
    fn next_task(&self) -> Option<Task> {
        let mut desk = self.shared.desk();
        desk.since = None;
        loop {
            if desk.quit {
                return None;
            }
            let job = desk.job.take().map(Task::Start);
            self.shared.stop.set(false);
            if job.is_some() || !desk.requests.is_empty() {
                self.shared.superseded.store(false, Ordering::Relaxed);
            }
            let task = job.or_else(|| desk.requests.pop_front().map(Task::Request));
            if task.is_some() {
                desk.since = Some(Instant::now());
                return task;
            }
            if let Some((subject, flow)) = desk.backward.take() {
                desk.view.checking = false;
                desk.view.busy = true;
                return Some(Task::Backward(subject, flow));
            }
            if std::mem::take(&mut desk.focus_moved) {
                return Some(Task::Focus);
            }
            let was_busy = std::mem::replace(&mut desk.view.busy, false) | desk.view.progress.take().is_some();
            self.shared.idle.notify_all();
            if was_busy {
                (self.shared.changed)();
            }
            desk = self.shared.wake.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn serve(&mut self, task: Task) {
        match task {
            Task::Start(job) => {
                let opened = self.open(job);
                let mut desk = self.shared.desk();
                desk.starting = desk.job.is_some();
                drop(desk);
                match opened {
                    Ok(true) => self.publish(),
                    // It is on its way to another place, another job waits, or the end.
                    Ok(false) => {}
                    Err(_) if self.shared.stop.is_set() => {}
                    Err(error) => self.refuse(error),
                }
            }
            Task::Request(Request::Go(to)) => {
                let Some(run) = &self.run else { return };
                self.held = self.held.filter(|at| !walks_pixels(&*run.walk, *at));
                self.go(to);
            }
            Task::Request(Request::GoAt(point, side)) => self.go_at(point, side),
            Task::Request(Request::Release) => {
                if self.held.take().is_some() {
                    self.publish();
                }
            }
            Task::Request(Request::Stay) => {
                if let Some(cursor) = self.run.as_ref().map(|run| run.walk.cursor()) {
                    self.go(Move::To(cursor));
                }
            }
            Task::Request(Request::Visit(visit)) => {
                if let Some(run) = &self.run {
                    visit(&run.subject, run.walk.as_ref());
                }
            }
            // What is held stays, wherever the pointer goes.
            Task::Focus if self.held().is_some() => {}
            Task::Focus => {
                self.forget_failed_check();
                self.publish();
            }
            Task::Backward(subject, flow) => {
                if let Some(run) = self.run.as_mut().filter(|run| Arc::ptr_eq(&run.subject, &subject)) {
                    run.backward = Some(flow);
                }
                self.publish();
            }
        }
    }

    /// Has the reverse pair of `run` run on a thread of its own if `want` wants it; one at a time.
    fn check(&self, run: &Run, want: &Want, offer: &Offer) {
        let is_wanted = offer.layer(want.layer) == FlowLayer::Consistency && run.backward.is_none();
        let stop = Stop::default();
        {
            let mut desk = self.shared.desk();
            if !is_wanted || std::mem::replace(&mut desk.view.checking, true) {
                return;
            }
            desk.stop_check = stop.clone();
        }
        let (subject, clip, shared) = (Arc::clone(&run.subject), run.clip.clone().until(stop), Arc::clone(self.shared));
        let work = move || {
            let work = AssertUnwindSafe(|| backward(&*subject.estimator, &clip, subject.frame));
            let flow = catch_unwind(work).unwrap_or_else(|panic| Err(panicked(panic.as_ref())));
            shared.desk().backward = Some((subject, flow));
            shared.wake.notify_one();
        };
        if std::thread::Builder::new().name("backward".into()).spawn(work).is_err() {
            self.shared.desk().view.checking = false;
        }
    }

    /// Has a check that failed, or was given up, be tried anew when it is chosen the next time.
    fn forget_failed_check(&mut self) {
        let is_wanted = self.shared.desk().want.layer == Some(FlowLayer::Consistency);
        if let Some(run) = self.run.as_mut().filter(|run| !is_wanted && matches!(run.backward, Some(Err(_)))) {
            run.backward = None;
        }
    }

    /// Starts a run; gives whether it stands at its place. The old one is gone, whatever comes of the new one.
    fn open(&mut self, Job { subject, place }: Job) -> Result<bool, Error> {
        // A pixel stays held when parameters change, but not in another clip.
        let other = self.run.take().is_some_and(|run| run.clip.info().name != subject.clip.info().name);
        self.held = match place.hold {
            Hold::Kept => self.held.filter(|_| !other),
            Hold::Set(pixel) => pixel.map(Pixel::point),
        };
        let clip = subject.clip.clone().until(self.shared.stop.clone());
        let mut pairs = LastPair::default();
        let walk = subject.company.walk(&*subject.estimator, &clip, subject.frame)?;
        let pair = pairs.of(&*walk, &clip)?.clone();
        let Place { mut cursor, near, .. } = place;
        if let Some(unit) = near.and_then(|point| walk.unit_at(point)) {
            cursor.unit = unit;
        }
        let (end, motion) = (OnceCell::new(), RefCell::default());
        self.run = Some(Run { subject, walk, clip, pairs, pair, end, backward: None, motion });
        Ok(cursor == Cursor::default() || self.travel(Move::To(cursor)))
    }

    fn go(&mut self, to: Move) {
        if self.travel(to) {
            self.publish();
        }
    }

    fn go_at(&mut self, point: [f32; 2], side: Side) {
        let Some(run) = &self.run else { return };
        // Where nothing is found at that pixel, the move that this one replaced has ended where the run stands.
        let here = run.walk.cursor();
        let to = match (run.walk.explained(point), run.walk.unit_at(point)) {
            (Some(explained), _) => {
                self.held = Some(point);
                if let Explained::From(turn) = explained { turn.max(here) } else { here }
            }
            (None, Some(unit)) if side == Side::Start => Cursor { unit, event: usize::from(unit > 0) },
            (None, Some(unit)) => Cursor { unit, event: usize::MAX },
            (None, None) => here,
        };
        self.go(Move::To(to));
    }

    /// The pixel that was clicked, where it can be explained.
    fn held(&self) -> Option<[f32; 2]> {
        self.held.filter(|at| self.run.as_ref().is_some_and(|run| is_explained(&*run.walk, *at)))
    }

    /// Works on a move until it is done or another one is wanted more; gives whether it is done.
    fn travel(&mut self, to: Move) -> bool {
        let Some(run) = &mut self.run else { return false };
        let shared = self.shared;
        let begun = Instant::now();
        let wanted = || begun.elapsed() < PATIENCE || !shared.superseded.load(Ordering::Relaxed);
        run.walk.go(to);
        loop {
            let slice = Instant::now();
            if run.walk.work(&mut || slice.elapsed() < NEWS && wanted()) {
                return match run.turn() {
                    Ok(()) => true,
                    Err(error) => {
                        self.refuse(error);
                        false
                    }
                };
            }
            if !wanted() {
                return false;
            }
            shared.desk().view.progress = run.walk.progress();
            (shared.changed)();
        }
    }

    fn publish(&self) {
        let Some(run) = &self.run else { return };
        let (focus, want) = {
            let mut desk = self.shared.desk();
            desk.focus_moved = false;
            (desk.focus, desk.want)
        };
        let held = self.held();
        let pointed =
            held.or(focus.filter(|at| is_explained(&*run.walk, *at))).map(|at| Pointed { at, is_held: held.is_some() });
        let mut shown = Snapshot { pointed, ..run.snapshot(held.or(focus), want) };
        let before = self.shared.desk().view.shown.clone();
        // What looks the same is the same, so that nobody paints it anew.
        if let Some(before) = before {
            let tiles = shown.tiles.iter_mut().zip(&before.tiles).map(|(now, then)| (&mut now.scene, &then.scene));
            for (now, then) in [(&mut shown.scene, &before.scene)].into_iter().chain(tiles) {
                if then.same(now) {
                    *now = Arc::clone(then);
                }
            }
        }
        self.check(run, &want, &shown.offer);
        let mut desk = self.shared.desk();
        desk.view.shown = Some(Arc::new(shown));
        desk.view.refused = None;
        desk.view.progress = None;
        drop(desk);
        (self.shared.changed)();
    }

    fn refuse(&self, error: Error) {
        self.shared.desk().view.refused = Some(error);
        (self.shared.changed)();
    }
}

impl Run {
    /// Takes the frames of the place where it stands now.
    fn turn(&mut self) -> Result<(), Error> {
        self.pair = self.pairs.of(&*self.walk, &self.clip)?.clone();
        Ok(())
    }

    fn snapshot(&self, focus: Option<[f32; 2]>, want: Want) -> Snapshot {
        let walk = &self.walk;
        let mut tiles = tiles(&**walk, focus, if walk.at_end() { &self.end().beside } else { &[] });
        let (mut pictures, scene) = (self.pictures(), tile::scene(&**walk, focus, &tiles));
        let motion = self.motion(&scene, want);
        motion.put(&mut pictures, &mut tiles);
        Snapshot {
            subject: Arc::clone(&self.subject),
            info: walk.info(),
            frame: walk.at_frame(),
            pictures,
            offer: motion.offer,
            cursor: walk.cursor(),
            events: walk.events(),
            units: walk.units(),
            at_end: walk.at_end(),
            place: walk.place(),
            landmarks: walk.landmarks(),
            failure: walk.failure().cloned(),
            step: Arc::new(self.step(focus, &motion)),
            scene: Arc::new(scene),
            pointed: None,
            tested: walk.evaluations().partition_point(|event| *event <= walk.cursor().event),
            tiles,
        }
    }

    /// What `want` wants to see of motion; the pixel that is explained makes no difference.
    fn motion(&self, scene: &Scene, want: Want) -> Motion {
        let key = (self.walk.cursor(), want, self.backward.is_some());
        if let Some((known, motion)) = &*self.motion.borrow()
            && *known == key
        {
            return motion.clone();
        }
        let site = Site { walk: &*self.walk, clip: &self.clip, scene };
        let backward = || Ok(self.backward.as_ref().and_then(|flow| flow.as_ref().ok()));
        // A truth that cannot be read is told beside the other figures; then there are no colours.
        let none = || Motion::of(site, &Want { layer: Some(FlowLayer::None), ..want }, backward).unwrap_or_default();
        let motion = Motion::of(site, &want, backward).unwrap_or_else(|_| none());
        *self.motion.borrow_mut() = Some((key, motion.clone()));
        motion
    }

    /// What the cursor tells; at the end, also how good the estimate is.
    fn step(&self, focus: Option<[f32; 2]>, motion: &Motion) -> Step {
        let mut step = self.walk.step(focus);
        if self.walk.at_end() {
            if let Some(assessment) = &self.end().assessment {
                add_assessment(&mut step, assessment);
            }
            match (motion.check, &self.backward) {
                (Some(check), _) => add_facts(&mut step, check.facts()),
                (None, Some(Err(error))) => {
                    add_facts(&mut step, vec![Fact { label: "Reverse pair", value: error.to_string(), role: None }]);
                }
                _ => {}
            }
            step.readouts.extend(self.end().histogram.clone().map(Readout::Histogram));
        }
        step
    }

    fn pictures(&self) -> Pictures {
        if self.walk.at_end() { self.end().pictures.clone() } else { self.pair.clone() }
    }

    fn end(&self) -> &End {
        self.end.get_or_init(|| {
            let output = self.walk.output();
            let reference = Reference { clip: &self.clip, frame: self.walk.frame() };
            End {
                histogram: output.histogram(),
                pictures: pictures(&*self.walk, &self.pair),
                assessment: output.assess(&reference).ok(),
                beside: endings(&*self.walk, &self.clip, &self.pair),
            }
        })
    }
}

fn panicked(panic: &(dyn std::any::Any + Send)) -> Error {
    let said = panic.downcast_ref::<String>().map(String::as_str);
    let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
    Error::new(format!(
        "the run broke off ({said}); change a parameter or the clip to start it again, and please report it"
    ))
}

#[cfg(test)]
mod tests;
