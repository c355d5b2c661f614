//! A camera with an estimator running on it, in a task of its own that drops frames rather than lagging behind.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use motionscope_core::base::{Error, Stop};
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::run::{AnyEstimator, Info, Walk};
use motionscope_core::scene::Scene;
use web_time::{Duration, Instant};

use crate::experiment::live::{LiveFrames, LiveRun, measure};
use crate::media::camera::{Camera, Format};
use crate::paint::{FocusMode, Pictures, View};
use crate::view::look::{Look, RunState};
use crate::view::moment::{Before, Moment, RunView};
use crate::view::motion::{AvailableLayers, Motion};
use crate::view::named::LastNamed;
use crate::work::{self, Boxed, Signal, Task};

/// Time between two checks of a waiting task whether it was stopped.
const POLL: Duration = Duration::from_millis(50);
/// The time for a frame up to which an estimator is offered: 10 frames per second.
const LIMIT: Duration = Duration::from_millis(100);
/// The time over which rates are measured.
const MEASURED: Duration = Duration::from_secs(2);
/// Frames on which estimators are measured.
const SAMPLES: usize = 4;
/// How long the window waits for both tasks and the camera when it is closed: an estimator may be in the middle of a frame.
const GRACE: Duration = Duration::from_millis(100);

/// A frame with the result of the estimator.
pub struct Seen {
    /// The frames.
    pub pictures: Pictures,
    /// The marks.
    pub scene: Arc<Scene>,
    /// The state of the run.
    pub stands: RunState,
    /// The layers of motion that there are.
    pub available: AvailableLayers,
    /// The number of the frame in the run.
    pub frame: usize,
    /// The estimator that has run on it, if one has.
    pub estimator: Option<&'static Info>,
}

/// The state of a live run.
#[derive(Clone, Default)]
pub struct LiveView {
    /// The newest frame, if one has come.
    pub seen: Option<Arc<Seen>>,
    /// Frames per second on which the estimator has run.
    pub rate: Option<f64>,
    /// Frames that were dropped since the estimator was chosen, because it was at work.
    pub dropped: u64,
    /// Why the estimator does not run on these frames, if it does not.
    pub error: Option<Error>,
    /// The estimators that keep up with the camera, with the time that they take for a frame.
    pub offered: Vec<(&'static Info, Duration)>,
    /// Whether all estimators were measured, which begins with [`Live::measure`].
    pub is_measured: bool,
}

#[derive(Default)]
struct Mail {
    estimator: Option<Box<dyn AnyEstimator>>,
    /// Ends the run of the estimator.
    stop: Stop,
    look: Look,
    view: LiveView,
    /// When the last results came.
    times: VecDeque<Instant>,
}

/// The state that the window and both tasks share.
struct Shared {
    camera: Camera,
    mail: Mutex<Mail>,
    /// Notified when an estimator is chosen, and at the end.
    chosen: Signal,
    quit: Stop,
    changed: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn mail(&self) -> MutexGuard<'_, Mail> {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The estimator that is to run, and the stop of its run.
    fn choice(&self) -> (Option<Box<dyn AnyEstimator>>, Stop) {
        let mail = self.mail();
        (mail.estimator.as_ref().map(|estimator| estimator.boxed_clone()), mail.stop.clone())
    }

    /// Waits until `stop` is set: another estimator is chosen, or the camera is closed.
    async fn wait_for(&self, stop: &Stop) {
        self.chosen.until(|| stop.is_set().then_some(())).await;
    }

    /// Reports that the run failed that `stop` ends, and runs no estimator from now on; a run that was stopped has not failed.
    fn refuse(&self, error: Error, stop: &Stop) {
        let mut mail = self.mail();
        // Under the lock, so that an estimator that is chosen at the same time stays.
        if stop.is_set() {
            return;
        }
        (mail.estimator, mail.view.error) = (None, Some(error));
        drop(mail);
        (self.changed)();
    }

    /// Shows a frame, and counts it.
    fn publish(&self, seen: Seen, stop: &Stop) {
        let mut mail = self.mail();
        if stop.is_set() {
            return;
        }
        let now = Instant::now();
        mail.times.push_back(now);
        while mail.times.front().is_some_and(|time| *time + MEASURED < now) {
            mail.times.pop_front();
        }
        let seconds = mail.times.front().map_or(0.0, |first| now.duration_since(*first).as_secs_f64());
        mail.view.rate = (mail.times.len() > 2 && seconds > 0.0).then(|| (mail.times.len() - 1) as f64 / seconds);
        mail.view.seen = Some(Arc::new(seen));
        drop(mail);
        (self.changed)();
    }
}

/// A camera that is shown; dropping it ends the camera and both tasks, which are left behind if that takes long.
pub struct Live {
    shared: Arc<Shared>,
    tasks: Vec<Task>,
    is_measuring: bool,
}

impl Live {
    /// Shows the frames of `camera`. `changed` is called by a task with each result.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(camera: Camera, changed: impl Fn() + Send + Sync + 'static) -> Result<Self, Error> {
        let shared = Shared {
            camera,
            mail: Mutex::default(),
            chosen: Signal::default(),
            quit: Stop::default(),
            changed: Box::new(changed),
        };
        let mut live = Self { shared: Arc::new(shared), tasks: Vec::new(), is_measuring: false };
        live.spawn("live run", async |shared| run(&shared).await)?;
        Ok(live)
    }

    /// Measures which estimators keep up with the camera, unless that has begun.
    pub fn measure(&mut self) {
        if std::mem::replace(&mut self.is_measuring, true) {
            return;
        }
        if let Err(error) = self.spawn("live speeds", async |shared| measure_all(&shared).await) {
            self.choose(None);
            let mut mail = self.shared.mail();
            (mail.view.error, mail.view.is_measured) = (Some(error), true);
        }
    }

    fn spawn(&mut self, name: &str, work: impl AsyncFnOnce(Arc<Shared>) + Send + 'static) -> Result<(), Error> {
        let shared = Arc::clone(&self.shared);
        let task = work::spawn(name, async move || work(shared).await);
        self.tasks.push(task.map_err(|error| Error::new(format!("no thread could be started ({error})")))?);
        Ok(())
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.shared.camera
    }

    /// The state now.
    pub fn view(&self) -> LiveView {
        self.shared.mail().view.clone()
    }

    /// Has `estimator` run from now on, or none.
    pub fn choose(&self, estimator: Option<Box<dyn AnyEstimator>>) {
        let mut mail = self.shared.mail();
        mail.stop.set(true);
        mail.stop = Stop::default();
        mail.estimator = estimator;
        mail.times.clear();
        (mail.view.rate, mail.view.dropped, mail.view.error) = (None, 0, None);
        drop(mail);
        self.shared.chosen.notify();
    }

    /// Whether the estimator that was chosen has failed, so that none runs.
    pub fn has_failed(&self) -> bool {
        self.shared.mail().view.error.is_some()
    }

    /// Sets the look of the results.
    pub fn look(&self, look: &Look) {
        self.shared.mail().look = live_look(look);
    }
}

/// The look of a live run: a single picture, the whole of it.
pub fn live_look(look: &Look) -> Look {
    Look { view: Some(View::Current), focus: FocusMode::Off, streaks: None, legend: true, ..*look }
}

impl Drop for Live {
    fn drop(&mut self) {
        let asked = Instant::now();
        self.shared.quit.set(true);
        self.shared.mail().stop.set(true);
        self.shared.chosen.notify();
        // The camera is off even while an estimator is still at work on its last frame.
        self.shared.camera.close(GRACE);
        self.tasks.iter().for_each(|task| task.wait(GRACE.saturating_sub(asked.elapsed())));
    }
}

/// Shows frames, and runs the estimator on them, until the camera is closed.
async fn run(shared: &Arc<Shared>) {
    let Some(format) = format(shared).await else { return (shared.changed)() };
    while !shared.quit.is_set() {
        let (estimator, stop) = shared.choice();
        // The last frame of a camera that has ended is shown without a run.
        let estimator = estimator.filter(|_| shared.camera.ended().is_none());
        let name = estimator.as_ref().map_or("the camera", |estimator| estimator.info().name);
        let outcome = caught(name, async {
            match &estimator {
                Some(estimator) => run_live(shared, &**estimator, (&format, &stop)).await,
                None => preview(shared, (&format, &stop)).await,
            }
        });
        let outcome = outcome.await;
        let has_ended = shared.camera.ended().is_some();
        match outcome {
            Err(error) if !has_ended => shared.refuse(error, &stop),
            _ => (shared.changed)(),
        }
        // After an estimator that has failed, frames are shown without one.
        if has_ended || estimator.is_none() {
            shared.wait_for(&stop).await;
        }
    }
}

/// Has `work` done for the estimator called `name`; a panic is an error as well.
async fn caught<T>(name: &str, work: impl Future<Output = Result<T, Error>>) -> Result<T, Error> {
    let failed = |_| Err(Error::new(format!("{name} failed; choose another estimator, and please report this error")));
    work::caught(work).await.unwrap_or_else(failed)
}

/// The format of the frames, once the first one has come; `None` if none comes.
async fn format(shared: &Shared) -> Option<Format> {
    loop {
        if let Some(format) = shared.camera.format() {
            return Some(format);
        }
        if shared.quit.is_set() || shared.camera.ended().is_some() {
            return None;
        }
        shared.camera.wait_for(0, POLL).await;
    }
}

/// The frames of a camera for one run, which drops those that came while it was at work.
struct Newest {
    shared: Arc<Shared>,
    format: Format,
    stop: Stop,
    /// The number of the next frame.
    next: Option<u64>,
}

impl Newest {
    fn new(shared: &Arc<Shared>, (format, stop): (&Format, &Stop)) -> Self {
        Self { shared: Arc::clone(shared), format: format.clone(), stop: stop.clone(), next: None }
    }

    /// Waits for the newest frame that was not delivered yet, and returns it with the number of frames that were dropped before it.
    async fn frame(&mut self) -> Result<(Arc<Frame>, u64), Error> {
        let camera = &self.shared.camera;
        loop {
            self.stop.check()?;
            let index = self.next.or_else(|| camera.newest().map(|shot| shot.index)).unwrap_or(0);
            if let Some(shot) = camera.wait_for(index, POLL).await {
                self.next = Some(shot.index + 1);
                return Ok((Arc::new(shot.frame(&self.format)?), shot.index - index));
            }
            if let Some(ended) = camera.ended() {
                return Err(ended);
            }
        }
    }
}

impl LiveFrames for Newest {
    fn next(&mut self) -> Boxed<'_, Result<Arc<Frame>, Error>> {
        Box::pin(async {
            let (frame, dropped) = self.frame().await?;
            let mut mail = self.shared.mail();
            // Frames that an earlier run dropped do not count.
            if !self.stop.is_set() {
                mail.view.dropped += dropped;
            }
            Ok(frame)
        })
    }
}

/// Shows frames as they come, until `stop` is set.
async fn preview(shared: &Arc<Shared>, (format, stop): (&Format, &Stop)) -> Result<(), Error> {
    let mut frames = Newest::new(shared, (format, stop));
    let scene = Arc::<Scene>::default();
    for number in 0.. {
        let (frame, _) = frames.frame().await?;
        let seen = Seen {
            pictures: Pictures::of([Arc::clone(&frame), frame]),
            scene: Arc::clone(&scene),
            stands: RunState { shows_frame_alone: true, ..RunState::default() },
            available: AvailableLayers::default(),
            frame: number,
            estimator: None,
        };
        shared.publish(seen, stop);
        work::breathe().await;
    }
    Ok(())
}

/// Runs `estimator` on frames as they come, until `stop` is set.
async fn run_live(
    shared: &Arc<Shared>,
    estimator: &dyn AnyEstimator,
    (format, stop): (&Format, &Stop),
) -> Result<(), Error> {
    let frames = Box::new(Newest::new(shared, (format, stop)));
    let mut run = LiveRun::new(estimator, format.size(), frames, stop.clone());
    loop {
        let (clip, shows_frame_alone) = (run.clip().clone(), run.estimator().shows_frame_alone());
        let look = shared.mail().look;
        let seen = seen(run.advance().await?, &clip, &look, shows_frame_alone)?;
        shared.publish(seen, stop);
        work::breathe().await;
    }
}

/// The results of a run so far.
fn seen(walk: &dyn Walk, clip: &Clip, look: &Look, shows_frame_alone: bool) -> Result<Seen, Error> {
    let frame = walk.at_frame();
    let current = clip.frame(frame)?;
    // A frame that the run did not need is not waited for.
    let following = clip.cached(frame + 1).unwrap_or_else(|| Arc::clone(&current));
    let pair = Pictures::of([current, following]);
    // Cursors come again with each pair, so no picture of an earlier one may be kept.
    let named = LastNamed::default();
    let view = RunView {
        walk,
        clip,
        pair: &pair,
        focus: None,
        beside: false,
        end: None,
        named: &named,
        before: Before::NotShown,
    };
    let moment = Moment::of(view, |site| Motion::of(site, look, || Ok(None)))?;
    let stands = moment.stands(shows_frame_alone);
    let Moment { scene, pictures, available, .. } = moment;
    Ok(Seen { pictures, scene, stands, available, frame, estimator: Some(walk.info()) })
}

/// Measures which estimators keep up with the camera, on some of its frames.
async fn measure_all(shared: &Arc<Shared>) {
    let frames = samples(shared).await.unwrap_or_default();
    for estimator in estimators().into_iter().filter(|estimator| estimator.needs_pictures()) {
        if shared.quit.is_set() {
            return;
        }
        let measured = async { Ok(measure(&*estimator, &frames, LIMIT, &shared.quit).await) };
        if let Ok(Some(time)) = caught(estimator.info().name, measured).await {
            shared.mail().view.offered.push((estimator.info(), time));
            (shared.changed)();
        }
        work::breathe().await;
    }
    shared.mail().view.is_measured = true;
    (shared.changed)();
}

/// Frames that follow each other; `None` if the camera ends before.
async fn samples(shared: &Arc<Shared>) -> Option<Vec<Arc<Frame>>> {
    let format = format(shared).await?;
    let mut frames = Vec::new();
    let mut next = 0;
    while frames.len() < SAMPLES {
        if shared.quit.is_set() || shared.camera.ended().is_some() {
            return None;
        }
        if let Some(shot) = shared.camera.wait_for(next, POLL).await {
            next = shot.index + 1;
            frames.push(Arc::new(shot.frame(&format).ok()?));
        }
    }
    Some(frames)
}

#[cfg(test)]
mod tests {
    use std::future::ready;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    use motionscope_core::course::estimator;

    use super::*;
    use crate::experiment::first;
    use crate::media::camera::{CameraFeed, Size, TestPicture};
    use crate::work::finish;

    /// Waits until `is` is the case.
    fn until(live: &Live, what: &str, is: impl Fn(&LiveView) -> bool) -> LiveView {
        let begun = Instant::now();
        while !is(&live.view()) {
            assert!(begun.elapsed() < Duration::from_secs(60), "{what}");
            thread::sleep(Duration::from_millis(5));
        }
        live.view()
    }

    #[test]
    fn a_search_runs_on_the_camera_and_ends_with_it() {
        let camera = Camera::start(Box::new(TestPicture::new(Size::new(96, 64))), || {}).unwrap();
        let live = Live::new(camera, || {}).unwrap();
        let plain = until(&live, "a frame comes", |view| view.seen.is_some());
        assert!(plain.seen.is_some_and(|seen| seen.scene.marks.is_empty()));
        live.choose(Some(estimator(first::BESIDE[2]).unwrap()));
        let runs = |view: &LiveView| view.seen.as_ref().is_some_and(|seen| !seen.scene.marks.is_empty());
        let view = until(&live, "vectors are found", runs);
        assert_eq!(view.error, None);
        until(&live, "it is measured", |view| view.rate.is_some());
        live.choose(None);
        until(&live, "the picture is plain again", |view| !runs(view));
    }

    #[test]
    fn what_is_still_at_work_is_left_behind() {
        let camera = Camera::start(Box::new(TestPicture::new(Size::new(96, 64))), || {}).unwrap();
        let is_at_work = Stop::default();
        let begun = is_at_work.clone();
        // As an estimator that works on a frame for long, and that nothing interrupts.
        let changed = move || {
            begun.set(true);
            thread::sleep(Duration::from_secs(3));
        };
        let live = Live::new(camera, changed).unwrap();
        let shared = Arc::clone(&live.shared);
        until(&live, "it is at work", |_| is_at_work.is_set());
        let asked = Instant::now();
        drop(live);
        assert!(asked.elapsed() < Duration::from_secs(2), "{:?}", asked.elapsed());
        shared.camera.close(Duration::from_secs(10));
        assert!(shared.camera.ended().is_some(), "the camera is off");
    }

    /// A few frames, and then the end.
    struct Few(u8);

    impl CameraFeed for Few {
        fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
            Box::pin(ready(Format::parse(b"YUV4MPEG2 W32 H32 F30:1 Cmono")))
        }

        fn next<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
            Box::pin(async {
                self.0 = self.0.checked_sub(1).ok_or_else(|| Error::new("it was unplugged"))?;
                work::sleep(Duration::from_millis(5)).await;
                Ok(Some(vec![self.0; 32 * 32]))
            })
        }
    }

    #[test]
    fn a_camera_that_has_ended_is_at_rest() {
        let calls = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&calls);
        let changed = move || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        let camera = Camera::start(Box::new(Few(3)), || {}).unwrap();
        let live = Live::new(camera, changed).unwrap();
        let is_at_rest = |live: &Live| {
            until(live, "the last frame is shown", |view| view.seen.is_some() && live.camera().ended().is_some());
            thread::sleep(Duration::from_millis(200));
            let before = calls.load(Ordering::Relaxed);
            thread::sleep(Duration::from_millis(300));
            assert_eq!(calls.load(Ordering::Relaxed), before, "nothing changes any more");
            before
        };
        let before = is_at_rest(&live);
        let view = live.view();
        assert!(view.error.is_none());
        let last = view.seen.map(|seen| seen.pictures.pair[0].luma().cells()[0]);
        assert_eq!(last, Some(0), "the last of the frames");
        live.choose(Some(estimator(first::BESIDE[2]).unwrap()));
        let after = is_at_rest(&live);
        assert!((before + 1..before + 5).contains(&after), "{before} calls, then {after}");
    }

    #[test]
    fn an_estimator_that_fails_can_be_chosen_again() {
        let camera = Camera::start(Box::new(TestPicture::new(Size::new(96, 64))), || {}).unwrap();
        let live = Live::new(camera, || {}).unwrap();
        let stop = live.shared.choice().1;
        live.shared.refuse(Error::new("it needs a second view"), &stop);
        assert!(live.has_failed());
        live.choose(Some(estimator(first::BESIDE[2]).unwrap()));
        assert!(!live.has_failed());
        // The end of the run before comes too late to take the choice back.
        live.shared.refuse(Error::new("it was cancelled"), &stop);
        assert!(!live.has_failed() && live.shared.choice().0.is_some());
        let runs = |view: &LiveView| view.seen.as_ref().is_some_and(|seen| !seen.scene.marks.is_empty());
        until(&live, "vectors are found", runs);
    }

    #[test]
    fn a_panic_is_an_error() {
        let failed = async { if LIMIT > POLL { panic!("out of bounds") } else { Ok(()) } };
        let failed = finish(caught("Diamond search", failed)).unwrap_err().to_string();
        assert!(failed.starts_with("Diamond search failed; choose another estimator"));
        assert_eq!(finish(caught("Diamond search", ready(Ok(7)))), Ok(7));
    }

    #[test]
    fn estimators_that_keep_up_are_offered_in_their_order() {
        let camera = Camera::start(Box::new(TestPicture::new(Size::new(48, 32))), || {}).unwrap();
        let mut live = Live::new(camera, || {}).unwrap();
        thread::sleep(Duration::from_millis(300));
        assert!(live.view().offered.is_empty(), "none is measured unasked");
        live.measure();
        let view = until(&live, "all are measured", |view| view.is_measured);
        let all: Vec<_> = estimators().iter().map(|one| one.info().id).collect();
        let places: Vec<_> =
            view.offered.iter().map(|(info, _)| all.iter().position(|id| *id == info.id).unwrap()).collect();
        assert!(places.len() > 20 && places.is_sorted(), "{places:?}");
        assert!(view.offered.iter().all(|(_, time)| *time <= LIMIT));
    }
}
