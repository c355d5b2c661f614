//! A camera that is on: its feed in a task of its own, and the last seconds of it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::Frame;
use web_time::{Duration, Instant};

use super::{CameraFeed, Format, OpenedFeed};
use crate::work::{self, Signal, Task};

/// Memory that the remembered frames take at most, and that a recording takes at most.
const MOST_BYTES: usize = 512 << 20;
/// The time that is remembered unless another is asked for.
const REMEMBERED: Duration = Duration::from_secs(5);
/// The time over which the rate is measured.
const MEASURED: Duration = Duration::from_secs(2);
/// How long the end of a feed is waited for when its camera is dropped.
const GRACE: Duration = Duration::from_millis(250);
/// How long a camera may take to end, from its closing on, before another is opened all the same.
const CLOSING: Duration = Duration::from_secs(5);
/// How often a waiting task asks whether it should stop.
const POLL: Duration = Duration::from_millis(20);

/// A frame as it came.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Its number since the camera was opened.
    pub index: u64,
    /// When it came, since the camera was opened.
    pub at: Duration,
    samples: Arc<[u8]>,
}

impl Shot {
    /// The frame.
    ///
    /// # Errors
    /// If it is not of this format.
    pub fn frame(&self, format: &Format) -> Result<Frame, Error> {
        format.frame(self.samples.to_vec())
    }

    pub(super) fn samples(&self) -> &[u8] {
        &self.samples
    }
}

/// Whether frame `number`, counted from 0, that came `gap` after frame 0 belongs to a recording of `time`.
///
/// A frame lasts until the next one comes, so its middle must lie inside: 3 s at 30 frames/s are 90 frames, whatever the jitter. The
/// first two always belong to it, because motion needs a pair.
pub(super) fn belongs(number: usize, gap: Duration, time: Duration) -> bool {
    let middle = || gap.as_secs_f64() * (1.0 + 0.5 / number as f64);
    number < 2 || middle() < time.as_secs_f64()
}

/// A recording that is being made: its frames stay until it is taken, whatever is remembered beside it.
#[derive(Debug)]
struct Recording {
    time: Duration,
    shots: Vec<Shot>,
    is_whole: bool,
}

impl Recording {
    /// Adds a frame unless the time is over; a recording of `most` frames is whole as well.
    fn push(&mut self, shot: &Shot, most: usize) {
        if self.is_whole {
            return;
        }
        let gap = self.shots.first().map_or(Duration::ZERO, |first| shot.at.saturating_sub(first.at));
        let is_inside = belongs(self.shots.len(), gap, self.time);
        if is_inside {
            self.shots.push(shot.clone());
        }
        self.is_whole = !is_inside || self.shots.len() >= most;
    }

    /// The time from its first frame to its last.
    fn length(&self) -> Duration {
        let ends = self.shots.first().zip(self.shots.last());
        ends.map_or(Duration::ZERO, |(first, last)| last.at.saturating_sub(first.at))
    }
}

/// The state of the task of a camera.
#[derive(Default)]
struct State {
    format: Option<Format>,
    shots: VecDeque<Shot>,
    remembered: Duration,
    recording: Option<Recording>,
    count: u64,
    /// When its end was asked for, if it was.
    closed: Option<Instant>,
    ended: Option<Error>,
}

impl State {
    fn push(&mut self, at: Duration, samples: Vec<u8>) {
        let most = (MOST_BYTES / samples.len().max(1)).max(2);
        let shot = Shot { index: self.count, at, samples: samples.into() };
        self.recording.iter_mut().for_each(|recording| recording.push(&shot, most));
        self.shots.push_back(shot);
        self.count += 1;
        let is_old = |shots: &VecDeque<Shot>| shots[0].at + self.remembered < at && shots.len() > 2;
        while is_old(&self.shots) || self.shots.len() > most {
            self.shots.pop_front();
        }
    }
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    news: Signal,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the end of the feed, but no longer than `longest`.
    async fn wait_for_end(&self, longest: Duration) {
        self.news.until_within(longest, || self.state().ended.as_ref().map(drop)).await;
    }

    /// Whether the next camera waits for the end of this one: it has not ended, and it is on or has been closed a short while ago.
    fn is_awaited(&self) -> bool {
        let state = self.state();
        state.ended.is_none() && state.closed.is_none_or(|closed| closed.elapsed() < CLOSING)
    }
}

/// A camera that is on; dropping it ends its feed.
pub struct Camera {
    shared: Arc<Shared>,
    stop: Stop,
    task: Task,
}

/// The cameras that were opened one after the other and have not ended, so that none is opened while an earlier one still closes.
/// Its clones share them.
#[derive(Clone, Default)]
pub struct Closing(Arc<Mutex<Vec<Weak<Shared>>>>);

impl Closing {
    /// Adds `camera`, and returns the earlier ones that have not ended. Their frames are not kept in memory for that.
    fn add(&self, camera: &Arc<Shared>) -> Vec<Weak<Shared>> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|camera| camera.upgrade().is_some_and(|camera| camera.state().ended.is_none()));
        let earlier = all.clone();
        all.push(Arc::downgrade(camera));
        earlier
    }
}

/// Waits for the end of all `cameras`, but for none that takes too long.
///
/// # Errors
/// If `stop` is set.
async fn wait_for_all(cameras: &[Weak<Shared>], stop: &Stop) -> Result<(), Error> {
    for camera in cameras {
        while let Some(camera) = camera.upgrade().filter(|camera| camera.is_awaited()) {
            stop.check()?;
            camera.wait_for_end(POLL).await;
        }
    }
    stop.check()
}

impl Camera {
    /// Reads `feed`. `changed` is called by the task with each frame, and at the end.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(feed: Box<dyn CameraFeed>, changed: impl Fn() + Send + 'static) -> Result<Self, Error> {
        Self::open(async |_| Ok(feed), changed)
    }

    /// As [`Camera::start`], with the feed that `open` opens in the same task; its stop is set when the camera is dropped.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn open(
        open: impl AsyncFnOnce(&Stop) -> OpenedFeed + Send + 'static,
        changed: impl Fn() + Send + 'static,
    ) -> Result<Self, Error> {
        Self::open_after(&Closing::default(), open, changed)
    }

    /// As [`Camera::open`], once the earlier cameras of `closing` have ended: the task waits for them. This camera is one of them
    /// from now on.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn open_after(
        closing: &Closing,
        open: impl AsyncFnOnce(&Stop) -> OpenedFeed + Send + 'static,
        changed: impl Fn() + Send + 'static,
    ) -> Result<Self, Error> {
        let shared = Arc::new(Shared::default());
        shared.state().remembered = REMEMBERED;
        let stop = Stop::default();
        let (theirs, asked, earlier) = (Arc::clone(&shared), stop.clone(), closing.add(&shared));
        let run = async move || {
            let read = async {
                wait_for_all(&earlier, &asked).await?;
                read(open(&asked).await?, &theirs, &asked, &changed).await
            };
            let ended = read.await.err();
            theirs.state().ended = Some(ended.unwrap_or_else(|| Error::new("the camera sends no more frames")));
            theirs.news.notify();
            changed();
        };
        let task = work::spawn("camera feed", run);
        let task = task.map_err(|error| Error::new(format!("no thread could be started for the camera ({error})")))?;
        Ok(Self { shared, stop, task })
    }

    /// Ends the feed, and waits for its end, but no longer than `longest`: whatever cannot be interrupted is left behind.
    pub fn close(&self, longest: Duration) {
        self.stop.set(true);
        self.shared.state().closed.get_or_insert_with(Instant::now);
        self.task.wait(longest);
    }

    /// Remembers the frames of the last `time`.
    pub fn remember(&self, time: Duration) {
        self.shared.state().remembered = time;
    }

    /// The format of the frames, once the first one has come.
    pub fn format(&self) -> Option<Format> {
        self.shared.state().format.clone()
    }

    /// Why there are no more frames, if there are none.
    pub fn ended(&self) -> Option<Error> {
        self.shared.state().ended.clone()
    }

    /// Waits for a frame of number `index` or a later one, and returns the newest; `None` if there is none in `time`, or the feed
    /// has ended before it.
    pub async fn wait_for(&self, index: u64, time: Duration) -> Option<Shot> {
        let look = || {
            let state = self.shared.state();
            let newest = state.shots.back().filter(|shot| shot.index >= index).cloned();
            // Without an end and without a frame it is looked for again.
            (newest.is_some() || state.ended.is_some()).then_some(newest)
        };
        self.shared.news.until_within(time, look).await.flatten()
    }

    /// The newest frame, if one has come.
    pub fn newest(&self) -> Option<Shot> {
        self.shared.state().shots.back().cloned()
    }

    /// Begins a recording of `time` with the next frame, in place of one that was not taken.
    pub fn begin_recording(&self, time: Duration) {
        self.shared.state().recording = Some(Recording { time, shots: Vec::new(), is_whole: false });
    }

    /// The length of the recording so far, if one is being made.
    pub fn recorded(&self) -> Option<Duration> {
        self.shared.state().recording.as_ref().map(Recording::length)
    }

    /// Whether there is a recording to which no frame will be added: its time is over, or the feed has ended.
    pub fn has_recording(&self) -> bool {
        let state = self.shared.state();
        state.recording.as_ref().is_some_and(|recording| recording.is_whole || state.ended.is_some())
    }

    /// Ends the recording, and returns its frames; none if none is being made.
    pub fn take_recording(&self) -> Vec<Shot> {
        self.shared.state().recording.take().map_or_else(Vec::new, |recording| recording.shots)
    }

    /// The remembered frames of the last `time`.
    pub fn last(&self, time: Duration) -> Vec<Shot> {
        let state = self.shared.state();
        let Some(newest) = state.shots.back().map(|shot| shot.at) else { return Vec::new() };
        let is_inside = |(number, shot): &(usize, &Shot)| belongs(*number, newest.saturating_sub(shot.at), time);
        let inside = state.shots.iter().rev().enumerate().take_while(is_inside).count();
        state.shots.iter().skip(state.shots.len() - inside).cloned().collect()
    }

    /// Frames per second that come, of the last two seconds; `None` before there is anything to measure.
    pub fn rate(&self) -> Option<f64> {
        rate(&self.last(MEASURED))
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        // A feed looks at the flag every few milliseconds, and takes its process with it. One that was closed before had its time.
        let grace = if self.stop.is_set() { Duration::ZERO } else { GRACE };
        self.close(grace);
    }
}

/// Frames per second of shots that follow each other.
pub(super) fn rate(shots: &[Shot]) -> Option<f64> {
    let (first, last) = (shots.first()?, shots.last()?);
    let seconds = last.at.saturating_sub(first.at).as_secs_f64();
    (shots.len() > 2 && seconds > 0.0).then(|| (shots.len() - 1) as f64 / seconds)
}

/// Reads a feed to its end.
async fn read(mut feed: Box<dyn CameraFeed>, shared: &Shared, stop: &Stop, changed: &dyn Fn()) -> Result<(), Error> {
    let format = feed.begin(stop).await?;
    let begun = Instant::now();
    shared.state().format = Some(format);
    while let Some(samples) = feed.next(stop).await? {
        shared.state().push(begun.elapsed(), samples);
        shared.news.notify();
        changed();
        work::breathe().await;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::future::ready;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;

    use super::*;
    use crate::work::{Boxed, finish};

    fn state(remembered_ms: u64, frames: u64) -> State {
        let mut state = State { remembered: Duration::from_millis(remembered_ms), ..State::default() };
        (0..frames).for_each(|t| state.push(Duration::from_millis(100 * t), vec![t as u8; 4]));
        state
    }

    #[test]
    fn the_last_seconds_are_remembered() {
        let indices = |state: State| state.shots.iter().map(|shot| shot.index).collect::<Vec<_>>();
        assert_eq!(indices(state(300, 10)), [6, 7, 8, 9]);
        assert_eq!(indices(state(0, 10)), [8, 9], "a pair is always there");
        assert_eq!(rate(state(9000, 5).shots.make_contiguous()), Some(10.0));
        assert_eq!(rate(&[]), None);
    }

    #[test]
    fn a_recording_keeps_its_frames_longer_than_they_are_remembered() {
        let shots = |recording: &Recording| recording.shots.iter().map(|shot| shot.index).collect::<Vec<_>>();
        let mut state = state(200, 5);
        let begun = |time_ms| Some(Recording { time: Duration::from_millis(time_ms), shots: vec![], is_whole: false });
        state.recording = begun(1000);
        (5..40).for_each(|t| state.push(Duration::from_millis(100 * t), vec![t as u8; 4]));
        let recording = state.recording.as_ref().unwrap();
        assert_eq!((shots(recording), recording.is_whole), ((5..15).collect(), true), "10 frames/s for 1 s");
        assert_eq!(recording.length(), Duration::from_millis(900));
        assert_eq!(state.shots.front().map(|shot| shot.index), Some(37));

        let mut dropped = begun(300).unwrap();
        state.shots.iter().for_each(|shot| dropped.push(shot, usize::MAX));
        assert_eq!((shots(&dropped), dropped.is_whole), (vec![37, 38, 39], false), "it waits for its last frame");
        let late = Shot { index: 43, at: Duration::from_millis(4300), samples: Arc::from([0; 4]) };
        dropped.push(&late, usize::MAX);
        assert_eq!((shots(&dropped), dropped.is_whole), (vec![37, 38, 39], true), "after dropped frames as well");

        let mut full = begun(60_000).unwrap();
        state.shots.iter().for_each(|shot| full.push(shot, 2));
        assert_eq!((shots(&full), full.is_whole), (vec![37, 38], true), "no more than there is memory for");
    }

    #[test]
    fn a_recording_has_as_many_frames_as_its_time_at_the_rate() {
        // Frames of a webcam come up to a third of an interval early or late.
        let jitter = |t: u64| Duration::from_micros(t * 33_333 + [0, 9_000, 4_000, 11_000, 2_000][t as usize % 5]);
        for (seconds, wanted) in [(1, 30), (3, 90), (10, 300)] {
            let time = Duration::from_secs(seconds);
            let mut state = State { remembered: time + Duration::from_secs(1), ..State::default() };
            state.recording = Some(Recording { time, shots: vec![], is_whole: false });
            (0..330).for_each(|t| state.push(jitter(t), vec![t as u8; 4]));
            let recording = state.recording.take().unwrap();
            assert_eq!((recording.shots.len(), recording.is_whole), (wanted, true), "{seconds} s");
            let camera = Camera::open(async |_| Err(Error::new("it was unplugged")), || {}).unwrap();
            camera.close(Duration::from_secs(10));
            let ended = camera.ended();
            *camera.shared.state() = State { ended, ..state };
            let last = camera.last(time);
            assert_eq!((last.len(), last.last().map(|shot| shot.index)), (wanted, Some(329)), "the last {seconds} s");
        }
        let slow = [0, 700, 1400].map(Duration::from_millis);
        let inside = slow.iter().enumerate().filter(|(t, gap)| belongs(*t, **gap, Duration::from_millis(500)));
        assert_eq!(inside.count(), 2, "motion needs a pair");
    }

    /// The format of tiny gray frames.
    fn gray() -> Boxed<'static, Result<Format, Error>> {
        Box::pin(ready(Format::parse(b"YUV4MPEG2 W2 H1 F30:1 Cmono")))
    }

    /// A feed that answers no request to stop for a while.
    struct Stuck;

    impl CameraFeed for Stuck {
        fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
            gray()
        }

        fn next<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
            thread::sleep(Duration::from_secs(3));
            Box::pin(ready(Ok(None)))
        }
    }

    #[test]
    fn a_camera_that_does_not_end_is_left_behind() {
        let closing = Closing::default();
        let camera = Camera::open_after(&closing, async |_| Ok(Box::new(Stuck) as Box<dyn CameraFeed>), || {}).unwrap();
        while camera.format().is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        let (shared, begun) = (Arc::clone(&camera.shared), Instant::now());
        drop(camera);
        assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
        let earlier = closing.add(&Arc::default());
        let cancelled = Stop::default();
        cancelled.set(true);
        assert!(
            finish(wait_for_all(&earlier, &cancelled)).is_err() && shared.state().ended.is_none(),
            "that can be cancelled"
        );
        finish(wait_for_all(&earlier, &Stop::default())).unwrap();
        assert!(shared.state().ended.is_some(), "the next camera waits for it");
        assert!(closing.add(&Arc::default()).is_empty(), "it is over");
    }

    #[test]
    fn a_camera_that_never_ends_is_not_waited_for_again() {
        let closing = Closing::default();
        let stuck = Arc::<Shared>::default();
        closing.add(&stuck);
        stuck.state().closed = Some(Instant::now().checked_sub(CLOSING).unwrap());
        let earlier = closing.add(&Arc::default());
        assert_eq!(earlier.len(), 1, "it has not ended");
        let begun = Instant::now();
        finish(wait_for_all(&earlier, &Stop::default())).unwrap();
        assert!(begun.elapsed() < CLOSING, "{:?}", begun.elapsed());
    }

    /// A feed that ends once it may, whatever its stop says.
    struct Lingering(Arc<AtomicBool>);

    impl CameraFeed for Lingering {
        fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
            gray()
        }

        fn next<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
            while !self.0.load(Ordering::Relaxed) {
                thread::sleep(Duration::from_millis(1));
            }
            Box::pin(ready(Ok(None)))
        }
    }

    #[test]
    fn a_camera_waits_for_all_earlier_ones() {
        let (closing, may_end) = (Closing::default(), Arc::<AtomicBool>::default());
        let opened = Arc::<Mutex<Vec<&str>>>::default();
        let open = |name: &'static str| {
            let (opened, may_end) = (Arc::clone(&opened), Arc::clone(&may_end));
            let feed = async move |_: &Stop| {
                opened.lock().unwrap().push(name);
                Ok(Box::new(Lingering(may_end)) as Box<dyn CameraFeed>)
            };
            Camera::open_after(&closing, feed, || {}).unwrap()
        };
        let first = open("first");
        while first.format().is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        drop(first);
        // The second is closed while it waits for the first.
        let second = open("second");
        second.close(Duration::from_secs(10));
        assert!(second.ended().is_some(), "it needs no end of the first");
        let third = open("third");
        assert!(finish(third.wait_for(0, Duration::from_millis(100))).is_none());
        assert_eq!(*opened.lock().unwrap(), ["first"], "none is opened beside it");
        may_end.store(true, Ordering::Relaxed);
        assert!(finish(third.wait_for(0, Duration::from_secs(10))).is_none() && third.ended().is_some());
        assert_eq!(*opened.lock().unwrap(), ["first", "third"]);
    }

    /// Three frames, 5 ms from each other, and then an end or an error.
    struct Three(u8, Option<Error>);

    impl CameraFeed for Three {
        fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
            gray()
        }

        fn next<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
            Box::pin(async {
                work::sleep(Duration::from_millis(5)).await;
                self.0 += 1;
                if self.0 <= 3 { Ok(Some(vec![self.0; 2])) } else { self.1.clone().map_or(Ok(None), Err) }
            })
        }
    }

    #[test]
    fn what_came_stays_after_the_end() {
        for (error, told) in [(None, "no more frames"), (Some(Error::new("it was unplugged")), "unplugged")] {
            let camera = Camera::start(Box::new(Three(0, error)), || {}).unwrap();
            let last = finish(camera.wait_for(2, Duration::from_secs(10))).expect("the third");
            assert_eq!(last.frame(&camera.format().unwrap()).unwrap().luma().cells(), [3, 3]);
            assert!(finish(camera.wait_for(3, Duration::from_secs(10))).is_none(), "it has ended");
            assert!(camera.ended().unwrap().to_string().contains(told));
            assert_eq!(camera.last(Duration::from_secs(5)).len(), 3);
            assert!(!camera.has_recording() && camera.recorded().is_none());
            camera.begin_recording(Duration::from_secs(1));
            assert!(camera.has_recording() && camera.take_recording().is_empty(), "nothing comes after the end");
            assert_eq!(camera.recorded(), None);
        }
        let refused = Camera::open(async |_| Err(Error::new("it is busy")), || {}).unwrap();
        assert!(finish(refused.wait_for(0, Duration::from_secs(10))).is_none());
        assert_eq!(refused.ended(), Some(Error::new("it is busy")));
    }
}
