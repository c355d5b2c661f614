//! A camera with an estimator running on it, on a thread of its own that leaves frames out rather than lagging behind.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use motionscope_core::{AnyEstimator, Clip, Error, Frame, Info, Scene, Stop, Walk, estimators};

use crate::experiment::live::{LiveRun, NextFrame, measure};
use crate::media::camera::{Camera, Format};
use crate::paint::{FocusMode, Pictures, View};
use crate::view::look::{Look, RunState};
use crate::view::moment::{Moment, RunView};
use crate::view::motion::{AvailableLayers, Motion};
use crate::view::named::LastNamed;

/// How often a waiting thread asks whether it is still wanted.
const POLL: Duration = Duration::from_millis(50);
/// The time for a frame up to which an estimator is offered: 10 frames per second.
const LIMIT: Duration = Duration::from_millis(100);
/// The time over which rates are measured.
const MEASURED: Duration = Duration::from_secs(2);
/// Frames on which estimators are measured.
const SAMPLES: usize = 4;

/// A frame with what the estimator has made of it.
pub struct Seen {
    /// The frames.
    pub pictures: Pictures,
    /// The marks.
    pub scene: Arc<Scene>,
    /// Where the run stands.
    pub stands: RunState,
    /// Which layers tell of motion.
    pub available: AvailableLayers,
    /// The number of the frame in the run.
    pub frame: usize,
}

/// What is known about a live run.
#[derive(Clone, Default)]
pub struct LiveView {
    /// The newest frame, if one has come.
    pub seen: Option<Arc<Seen>>,
    /// Frames per second on which the estimator has run.
    pub rate: Option<f64>,
    /// Frames that came meanwhile and were left out, since the estimator was chosen.
    pub dropped: u64,
    /// Why the estimator does not run on these frames, if it does not.
    pub error: Option<Error>,
    /// The estimators that keep up with the camera, with the time that they take for a frame.
    pub offered: Vec<(&'static Info, Duration)>,
    /// Whether all estimators were measured.
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

/// What the window and both threads share.
struct Shared {
    camera: Camera,
    mail: Mutex<Mail>,
    quit: Stop,
    changed: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn mail(&self) -> MutexGuard<'_, Mail> {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner)
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

/// A camera that is shown; dropping it ends the camera and both threads.
pub struct Live {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Live {
    /// Shows what comes from `camera`. `changed` is called from another thread with each result.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(camera: Camera, changed: impl Fn() + Send + Sync + 'static) -> Result<Self, Error> {
        let shared = Shared { camera, mail: Mutex::default(), quit: Stop::default(), changed: Box::new(changed) };
        let mut live = Self { shared: Arc::new(shared), threads: Vec::new() };
        live.spawn("live run", run)?;
        live.spawn("live speeds", measure_all)?;
        Ok(live)
    }

    fn spawn(&mut self, name: &str, work: fn(&Arc<Shared>)) -> Result<(), Error> {
        let shared = Arc::clone(&self.shared);
        let thread = thread::Builder::new().name(name.into()).spawn(move || work(&shared));
        self.threads.push(thread.map_err(|error| Error::new(format!("no thread could be started ({error})")))?);
        Ok(())
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.shared.camera
    }

    /// What is shown and known now.
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
    }

    /// How results are to look.
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
        self.shared.quit.set(true);
        self.shared.mail().stop.set(true);
        self.threads.drain(..).for_each(|thread| thread.join().unwrap_or_default());
    }
}

/// Shows frames, and runs the estimator on them, as long as that is wanted.
fn run(shared: &Arc<Shared>) {
    let Some(format) = format(shared) else { return };
    while !shared.quit.is_set() {
        let (estimator, stop) = {
            let mail = shared.mail();
            (mail.estimator.as_ref().map(|estimator| estimator.boxed_clone()), mail.stop.clone())
        };
        let ended = match &estimator {
            Some(estimator) => run_live(shared, &**estimator, (&format, &stop)),
            None => preview(shared, (&format, &stop)),
        };
        if let Err(error) = ended
            && !stop.is_set()
        {
            let mut mail = shared.mail();
            mail.estimator = None;
            mail.view.error = estimator.map(|_| error);
            drop(mail);
            (shared.changed)();
        }
        if shared.camera.ended().is_some() {
            thread::sleep(POLL);
        }
    }
}

/// What frames are like, once the first one has come; `None` if none comes.
fn format(shared: &Shared) -> Option<Format> {
    loop {
        if let Some(format) = shared.camera.format() {
            return Some(format);
        }
        if shared.quit.is_set() || shared.camera.ended().is_some() {
            return None;
        }
        shared.camera.wait_for(0, POLL);
    }
}

/// What delivers the newest frame that was not delivered yet, and tells `dropped` how many were left out.
fn newest_frame(shared: &Arc<Shared>, format: &Format, dropped: impl Fn(u64) + Send + Sync + 'static) -> NextFrame {
    let (shared, format, next) = (Arc::clone(shared), format.clone(), Mutex::new(None::<u64>));
    Box::new(move |stop| {
        let mut next = next.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            stop.check()?;
            let index = next.or_else(|| shared.camera.newest().map(|shot| shot.index)).unwrap_or(0);
            if let Some(shot) = shared.camera.wait_for(index, POLL) {
                dropped(shot.index - index);
                *next = Some(shot.index + 1);
                return shot.frame(&format).map(Arc::new);
            }
            if let Some(ended) = shared.camera.ended() {
                return Err(ended);
            }
        }
    })
}

/// Shows frames as they come, until `stop` is set.
fn preview(shared: &Arc<Shared>, (format, stop): (&Format, &Stop)) -> Result<(), Error> {
    let next = newest_frame(shared, format, |_| {});
    let scene = Arc::<Scene>::default();
    for number in 0.. {
        let frame = next(stop)?;
        let seen = Seen {
            pictures: Pictures::of([Arc::clone(&frame), frame]),
            scene: Arc::clone(&scene),
            stands: RunState { shows_frame_alone: true, ..RunState::default() },
            available: AvailableLayers::default(),
            frame: number,
        };
        shared.publish(seen, stop);
    }
    Ok(())
}

/// Runs `estimator` on frames as they come, until `stop` is set.
fn run_live(shared: &Arc<Shared>, estimator: &dyn AnyEstimator, (format, stop): (&Format, &Stop)) -> Result<(), Error> {
    let (theirs, asked) = (Arc::clone(shared), stop.clone());
    let count = move |dropped: u64| {
        let mut mail = theirs.mail();
        // What an earlier run missed is none of this one.
        if !asked.is_set() {
            mail.view.dropped += dropped;
        }
    };
    let next = newest_frame(shared, format, count);
    let mut run = LiveRun::new(estimator, format.size(), next, stop.clone());
    loop {
        let (clip, shows_frame_alone) = (run.clip().clone(), run.estimator().shows_frame_alone());
        let look = shared.mail().look;
        let seen = seen(run.advance()?, &clip, &look, shows_frame_alone)?;
        shared.publish(seen, stop);
    }
}

/// What a run shows where it stands.
fn seen(walk: &dyn Walk, clip: &Clip, look: &Look, shows_frame_alone: bool) -> Result<Seen, Error> {
    let frame = walk.at_frame();
    let current = clip.frame(frame)?;
    // A frame that the run did not need is not waited for.
    let following = clip.cached(frame + 1).unwrap_or_else(|| Arc::clone(&current));
    let pair = Pictures::of([current, following]);
    // Cursors come again with each pair, so no picture of an earlier one may be kept.
    let named = LastNamed::default();
    let view = RunView { walk, clip, pair: &pair, focus: None, beside: false, end: None, named: &named };
    let moment = Moment::of(view, |site| Motion::of(site, look, || Ok(None)))?;
    let stands = moment.stands(shows_frame_alone);
    let Moment { scene, pictures, available, .. } = moment;
    Ok(Seen { pictures, scene, stands, available, frame })
}

/// Measures which estimators keep up with the camera, on its first frames.
fn measure_all(shared: &Arc<Shared>) {
    let Some(frames) = samples(shared) else { return };
    for estimator in estimators().into_iter().filter(|estimator| estimator.needs_pictures()) {
        if shared.quit.is_set() {
            return;
        }
        if let Some(time) = measure(&*estimator, &frames, LIMIT, &shared.quit) {
            shared.mail().view.offered.push((estimator.info(), time));
            (shared.changed)();
        }
    }
    shared.mail().view.is_measured = true;
    (shared.changed)();
}

/// Frames that follow each other; `None` if the camera ends before.
fn samples(shared: &Arc<Shared>) -> Option<Vec<Arc<Frame>>> {
    let format = format(shared)?;
    let mut frames = Vec::new();
    let mut next = 0;
    while frames.len() < SAMPLES {
        if shared.quit.is_set() || shared.camera.ended().is_some() {
            return None;
        }
        if let Some(shot) = shared.camera.wait_for(next, POLL) {
            next = shot.index + 1;
            frames.push(Arc::new(shot.frame(&format).ok()?));
        }
    }
    Some(frames)
}

#[cfg(test)]
mod tests {
    use motionscope_core::estimator;

    use super::*;
    use crate::experiment::first;
    use crate::media::camera::{Size, TestPicture};

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
    fn estimators_that_keep_up_are_offered_in_their_order() {
        let camera = Camera::start(Box::new(TestPicture::new(Size::new(48, 32))), || {}).unwrap();
        let live = Live::new(camera, || {}).unwrap();
        let view = until(&live, "all are measured", |view| view.is_measured);
        let all: Vec<_> = estimators().iter().map(|one| one.info().id).collect();
        let places: Vec<_> =
            view.offered.iter().map(|(info, _)| all.iter().position(|id| *id == info.id).unwrap()).collect();
        assert!(places.len() > 20 && places.is_sorted(), "{places:?}");
        assert!(view.offered.iter().all(|(_, time)| *time <= LIMIT));
    }
}
