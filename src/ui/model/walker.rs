//! A run on its own thread: moves go in, immutable pictures of the run come out.
//!
//! Nothing here knows the window. A request never waits for an earlier one that takes long: it replaces it.

use std::cell::OnceCell;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use motionscope_core::scene::Fact;
use motionscope_core::{
    AnyEstimator, Clip, Cursor, Error, Info, Move, Output, Pace, Role, Rung, Scene, Step, Stop, Walk,
};

use crate::company::Company;
use crate::paint::Pictures;
use crate::quality::Quality;
use crate::shot::{pair, pictures};
use crate::source::Source;
use crate::tile::{self, Ending, Tile, add_facts, endings, tiles};
use crate::ui::action::Side;

/// A move that works longer than this gives way to the next request; less, and a drag would never arrive anywhere.
const PATIENCE: Duration = Duration::from_millis(60);
/// How often a long move tells how far it is.
const NEWS: Duration = Duration::from_millis(60);
/// Small moves that may wait: more would make a held key run on after it is let go.
const QUEUE: usize = 4;

/// What is run. A run never changes it: whoever has a picture of the run knows what it is a picture of.
pub struct Subject {
    /// The clip.
    pub clip: Clip,
    /// Where the clip comes from.
    pub source: Source,
    /// Truth that was given for it by hand.
    pub truth: Option<PathBuf>,
    /// The estimator with its parameters.
    pub estimator: Box<dyn AnyEstimator>,
    /// Who goes in lockstep with it.
    pub company: Company,
    /// The frame that the run starts on.
    pub frame: usize,
}

/// A place in a run that is there in runs with other parameters as well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Where to go.
    pub cursor: Cursor,
    /// The pixel whose unit is meant, if that is known better than its number.
    pub near: Option<[f32; 2]>,
}

impl Place {
    /// The end of the run.
    pub const END: Self = Self { cursor: Cursor { unit: usize::MAX, event: usize::MAX }, near: None };

    /// Where `shown` stands: the end of the run or of a unit stays one.
    pub fn of(shown: &Snapshot) -> Self {
        let Cursor { unit, event } = shown.cursor;
        if shown.at_end {
            return Self::END;
        }
        let event = if event > 0 && event == shown.events { usize::MAX } else { event };
        Self { cursor: Cursor { unit, event }, near: shown.reference() }
    }

    /// Where several go on in lockstep from what is `shown`: as many candidates into the same block.
    pub fn in_lockstep(shown: &Snapshot, pace: Pace) -> Self {
        let place = Self::of(shown);
        if place == Self::END {
            return place;
        }
        let event = match place.cursor.event {
            event @ (0 | usize::MAX) => event,
            _ => shown.tested.max(1),
        };
        // Where the budget counts, a unit is one of the leader, on whatever level.
        let near = place.near.filter(|_| pace == Pace::Block);
        Self { cursor: Cursor { unit: shown.leader().unit, event }, near }
    }

    /// Where the leader goes on alone from what is `shown` of several.
    pub fn alone(shown: &Snapshot) -> Self {
        if shown.at_end { Self::END } else { Self { cursor: shown.leader(), near: None } }
    }
}

/// What to walk through, and where to begin.
pub struct Job {
    /// What is run.
    pub subject: Arc<Subject>,
    /// Where to go at once.
    pub place: Place,
}

/// Everything there is to see at one cursor.
pub struct Snapshot {
    /// What is run.
    pub subject: Arc<Subject>,
    /// What there is to say about the estimator.
    pub info: &'static Info,
    /// Frames t and t + 1, and at the end what the run has made of them.
    pub pictures: Pictures,
    /// Where the run stands.
    pub cursor: Cursor,
    /// Events of the unit at hand.
    pub events: usize,
    /// Units of the run, if that is known by now.
    pub units: Option<usize>,
    /// Whether this is the end of the run.
    pub at_end: bool,
    /// Where the unit stands on each rung but the innermost.
    pub place: Vec<Rung>,
    /// Events worth a mark, and their role.
    pub landmarks: Vec<(usize, Role)>,
    /// What ended the run early, if anything did.
    pub failure: Option<Error>,
    /// What the cursor tells.
    pub step: Arc<Step>,
    /// What the cursor shows.
    pub scene: Arc<Scene>,
    /// Candidates of the unit that were tested.
    pub tested: usize,
    /// Each of those that go in lockstep; none where there is but one.
    pub tiles: Vec<Tile>,
}

impl Snapshot {
    /// The centre of what is being matched, in image pixels of frame t; of several in lockstep, by the first.
    pub fn reference(&self) -> Option<[f32; 2]> {
        use motionscope_core::scene::{Picture, Shape};
        let scene = self.tiles.first().map_or(&self.scene, |tile| &tile.scene);
        let mut marks = scene.marks.iter().rev();
        marks.find_map(|mark| match (mark.on, mark.role, &mark.shape) {
            (Picture::Current, Role::Reference, Shape::Rect { min, max }) => {
                Some([(min[0] + max[0]) / 2.0, (min[1] + max[1]) / 2.0])
            }
            _ => None,
        })
    }

    /// Where the run of the estimator itself stands: the same place unless several go in lockstep.
    pub fn leader(&self) -> Cursor {
        self.tiles.first().map_or(self.cursor, |tile| tile.cursor)
    }

    /// Share of the work that was done, from 0 to 1, if the number of units is known.
    pub fn share(&self) -> Option<f32> {
        let inside = if self.events == 0 { 0.0 } else { self.cursor.event as f32 / self.events as f32 };
        self.units.map(|units| ((self.cursor.unit as f32 + inside) / units.max(1) as f32).min(1.0))
    }
}

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
}

type Visit = Box<dyn FnOnce(&Arc<Subject>, &dyn Walk) + Send>;

enum Request {
    Go(Move),
    /// To the end or the start of the unit whose result lies at a pixel.
    GoAt([f32; 2], Side),
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
    focus_moved: bool,
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

    /// Goes to the end or the start of the unit whose result lies at pixel `point` of frame t.
    pub fn go_at(&self, point: [f32; 2], side: Side) {
        self.ask(true, |desk| desk.requests.push_back(Request::GoAt(point, side)));
    }

    /// Gives up the move at work; the run stays where it stands, a new one at its start.
    pub fn stop(&self) {
        self.ask(true, |desk| {
            desk.requests.retain(|request| matches!(request, Request::Visit(_)));
            desk.requests.push_front(Request::Stay);
            if let Some(job) = &mut desk.job {
                job.place = Place::default();
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
        while desk.view.busy {
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
            desk.quit = true;
        });
        if let Some(thread) = self.thread.take() {
            // A worker that panicked has nothing left to tell.
            let _ = thread.join();
        }
    }
}

/// A run at work.
struct Run {
    subject: Arc<Subject>,
    walk: Box<dyn Walk>,
    clip: Clip,
    pair: Pictures,
    /// What the whole run amounts to, once its end was reached.
    end: OnceCell<End>,
}

/// What the end of a run shows beside its last step.
struct End {
    pictures: Pictures,
    quality: Vec<Fact>,
    beside: Vec<Ending>,
}

enum Task {
    Start(Job),
    Request(Request),
    Focus,
}

struct Worker<'a> {
    shared: &'a Shared,
    run: Option<Run>,
}

impl<'a> Worker<'a> {
    fn new(shared: &'a Shared) -> Self {
        Self { shared, run: None }
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
            Task::Request(Request::Go(to)) => self.go(to),
            Task::Request(Request::GoAt(point, side)) => {
                let Some(run) = &self.run else { return };
                let to = run.walk.unit_at(point).map(|unit| {
                    let event = if side == Side::Start { usize::from(unit > 0) } else { usize::MAX };
                    Cursor { unit, event }
                });
                // Where nothing is found at that pixel, the move that this one replaced has ended where the run stands.
                self.go(Move::To(to.unwrap_or_else(|| run.walk.cursor())));
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
            Task::Focus => self.publish(),
        }
    }

    /// Starts a run; gives whether it stands at its place. The old one is gone, whatever comes of the new one.
    fn open(&mut self, Job { subject, place }: Job) -> Result<bool, Error> {
        self.run = None;
        let clip = subject.clip.clone().until(self.shared.stop.clone());
        let pair = pair(&clip, subject.frame)?;
        let walk = subject.company.walk(&*subject.estimator, &clip, subject.frame)?;
        let Place { mut cursor, near } = place;
        if let Some(unit) = near.and_then(|point| walk.unit_at(point)) {
            cursor.unit = unit;
        }
        self.run = Some(Run { subject, walk, clip, pair, end: OnceCell::new() });
        Ok(cursor == Cursor::default() || self.travel(Move::To(cursor)))
    }

    fn go(&mut self, to: Move) {
        if self.travel(to) {
            self.publish();
        }
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
                return true;
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
        let focus = {
            let mut desk = self.shared.desk();
            desk.focus_moved = false;
            desk.focus
        };
        let mut shown = run.snapshot(focus);
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
    fn snapshot(&self, focus: Option<[f32; 2]>) -> Snapshot {
        let walk = &self.walk;
        let tiles = tiles(&**walk, focus, if walk.at_end() { &self.end().beside } else { &[] });
        Snapshot {
            subject: Arc::clone(&self.subject),
            info: walk.info(),
            pictures: self.pictures(),
            cursor: walk.cursor(),
            events: walk.events(),
            units: walk.units(),
            at_end: walk.at_end(),
            place: walk.place(),
            landmarks: walk.landmarks(),
            failure: walk.failure().cloned(),
            step: Arc::new(self.step(focus)),
            scene: Arc::new(tile::scene(&**walk, focus, &tiles)),
            tested: walk.evaluations().partition_point(|event| *event <= walk.cursor().event),
            tiles,
        }
    }
}

impl Run {
    /// What the cursor tells; at the end, also how good the estimate is.
    fn step(&self, focus: Option<[f32; 2]>) -> Step {
        let mut step = self.walk.step(focus);
        if self.walk.at_end() {
            add_facts(&mut step, self.end().quality.clone());
        }
        step
    }

    fn pictures(&self) -> Pictures {
        if self.walk.at_end() { self.end().pictures.clone() } else { self.pair.clone() }
    }

    fn end(&self) -> &End {
        self.end.get_or_init(|| {
            let quality = Quality::of(&self.clip, self.walk.frame(), &self.walk.output());
            End {
                pictures: pictures(&*self.walk, &self.pair),
                quality: quality.map_or_else(|_| Vec::new(), |quality| quality.facts()),
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
mod tests {
    use std::sync::atomic::AtomicUsize;

    use motionscope_core::{Frame, FrameSource, Grid, Way, estimator};

    use super::*;

    fn clip() -> Clip {
        let texture = |x: usize, y: usize| (x * 31 + y * 57 + x * y % 7 * 20) as u8;
        let frame = |shift: usize| Frame::gray(Grid::from_fn(64, 48, |x, y| texture(x + 4 - shift, y)));
        Clip::from_frames("shift", vec![frame(0), frame(2)]).unwrap()
    }

    fn subject() -> Subject {
        let mut estimator = estimator("full-search").unwrap();
        estimator.set("range", "4").unwrap();
        Subject {
            clip: clip(),
            source: Source::File("shift".into()),
            truth: None,
            estimator,
            company: Company::default(),
            frame: 0,
        }
    }

    fn job() -> Job {
        Job { subject: Arc::new(subject()), place: Place::default() }
    }

    /// A run that takes a second or so, to be begun at its end.
    fn long() -> Job {
        let mut subject = subject();
        let frame =
            |t: usize| Frame::gray(Grid::from_fn(800, 600, |x, y| (x * 31 + y * 57 + x * y % 7 * 20 + t) as u8));
        subject.clip = Clip::from_frames("long", vec![frame(0), frame(2)]).unwrap();
        for (name, value) in [("block", "8"), ("spacing", "2"), ("range", "16")] {
            subject.estimator.set(name, value).unwrap();
        }
        Job { subject: Arc::new(subject), place: Place::END }
    }

    fn started() -> Walker {
        let walker = Walker::new(|| {}).unwrap();
        walker.start(job());
        walker.wait();
        walker
    }

    fn cursor(walker: &Walker) -> Cursor {
        walker.wait();
        walker.view().shown.map(|shown| shown.cursor).unwrap()
    }

    #[test]
    fn there_and_back_again() {
        let walker = started();
        walker.go(Move::To(Cursor { unit: 3, event: 7 }));
        assert_eq!(cursor(&walker), Cursor { unit: 3, event: 7 });
        let before = walker.view().shown.unwrap();
        walker.go(Move::Rung(2, Way::Forward));
        walker.go(Move::Rung(2, Way::Back));
        walker.wait();
        let after = walker.view().shown.unwrap();
        // Costs that are not known yet are NaN, so it is the words that are compared.
        let told = |shown: &Snapshot| format!("{} {:?} {:?}", shown.cursor, shown.step, shown.scene);
        assert!(told(&after) == told(&before));
    }

    #[test]
    fn a_refused_run_leaves_the_last_picture() {
        let walker = started();
        walker.start(Job { subject: Arc::new(Subject { frame: 9, ..subject() }), place: Place::default() });
        walker.wait();
        let view = walker.view();
        assert!(view.shown.is_some() && view.refused.is_some_and(|error| error.to_string().contains("frame")));
        let before = cursor(&walker);
        walker.focus(Some([3.0, 3.0]));
        walker.go(Move::Rung(2, Way::Forward));
        walker.wait();
        assert!(walker.view().refused.is_some() && cursor(&walker) == before, "the old run is no more");
        walker.start(job());
        walker.wait();
        assert!(walker.view().refused.is_none());
    }

    /// Frames that take for ever, until nobody wants them.
    struct Slow(Arc<AtomicBool>);

    impl FrameSource for Slow {
        fn frame(&self, _index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
            self.0.store(true, Ordering::SeqCst);
            loop {
                stop.check()?;
                std::thread::sleep(Duration::from_millis(1));
            }
        }

        fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
            None
        }
    }

    /// Has `walker` wait for a frame that never comes.
    fn stuck(walker: &Walker) {
        let asked = Arc::new(AtomicBool::new(false));
        let clip = Clip::new(clip().info().clone(), Arc::new(Slow(Arc::clone(&asked))));
        walker.start(Job { subject: Arc::new(Subject { clip, ..subject() }), place: Place::default() });
        while !asked.load(Ordering::SeqCst) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn nobody_waits_for_a_frame_that_is_not_wanted_any_more() {
        let walker = Walker::new(|| {}).unwrap();
        stuck(&walker);
        walker.start(job());
        walker.wait();
        assert!(walker.view().shown.is_some() && walker.view().refused.is_none());
        stuck(&walker);
        drop(walker);
    }

    #[test]
    fn a_run_begins_where_it_is_wanted() {
        let walker = Walker::new(|| {}).unwrap();
        walker.start(Job { place: Place { cursor: Cursor { unit: 0, event: 5 }, near: Some([40.0, 20.0]) }, ..job() });
        assert_eq!(cursor(&walker), Cursor { unit: 6, event: 5 });
        walker.go_at([1.0, 1.0], Side::End);
        assert_eq!((cursor(&walker).unit, cursor(&walker).event > 1), (0, true));
        walker.go_at([40.0, 20.0], Side::Start);
        assert_eq!(cursor(&walker), Cursor { unit: 6, event: 1 });
    }

    #[test]
    fn nothing_is_told_while_nothing_changes() {
        let count = Arc::new(AtomicUsize::new(0));
        let told = Arc::clone(&count);
        let walker = Walker::new(move || {
            told.fetch_add(1, Ordering::SeqCst);
        })
        .unwrap();
        walker.start(job());
        walker.wait();
        std::thread::sleep(Duration::from_millis(20));
        let before = count.load(Ordering::SeqCst);
        walker.focus(None);
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(count.load(Ordering::SeqCst), before);
    }

    #[test]
    fn a_place_replaces_what_was_asked_before() {
        let walker = started();
        for event in 1..200 {
            walker.go(Move::To(Cursor { unit: 5, event: event % 60 + 1 }));
        }
        walker.go(Move::To(Cursor { unit: 1, event: 1 }));
        assert_eq!(cursor(&walker), Cursor { unit: 1, event: 1 });
        let shown = walker.view().shown.unwrap();
        assert!(walker.output(&shown).recv().is_ok_and(|output| output.flow().at(0, 0).is_some()));
        walker.go(Move::Rung(2, Way::Forward));
        assert!(walker.output(&shown).recv().is_err(), "the run has moved on");
    }

    #[test]
    fn a_small_move_waits_for_a_run_to_come_to_its_place() {
        let walker = Walker::new(|| {}).unwrap();
        walker.start(long());
        std::thread::sleep(2 * PATIENCE);
        assert!(walker.view().shown.is_none(), "it takes longer than that");
        walker.go(Move::Rung(2, Way::Back));
        walker.wait();
        let shown = walker.view().shown.unwrap();
        assert_eq!((Some(shown.cursor.unit + 1), shown.cursor.event + 1), (shown.units, shown.events));
    }

    #[test]
    fn a_run_that_is_stopped_on_its_way_stays_at_its_start() {
        let walker = Walker::new(|| {}).unwrap();
        walker.start(long());
        std::thread::sleep(2 * PATIENCE);
        walker.stop();
        assert_eq!(cursor(&walker), Cursor::default());
        walker.start(long());
        walker.stop();
        assert_eq!(cursor(&walker), Cursor::default());
        walker.go(Move::Rung(2, Way::Forward));
        assert_eq!(cursor(&walker), Cursor { unit: 0, event: 1 });
    }
}
