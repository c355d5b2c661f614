//! A camera that is on: its feed on a thread of its own, and the last seconds of it.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use motionscope_core::{Error, Frame, Stop};

use super::{CameraFeed, Format};

/// Memory that the remembered frames take at most.
const MOST_BYTES: usize = 512 << 20;
/// The time that is remembered unless another is asked for.
const REMEMBERED: Duration = Duration::from_secs(5);
/// The time over which the rate is measured.
const MEASURED: Duration = Duration::from_secs(2);

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

/// What the thread of a camera has read.
#[derive(Default)]
struct State {
    format: Option<Format>,
    shots: VecDeque<Shot>,
    remembered: Duration,
    count: u64,
    ended: Option<Error>,
}

impl State {
    fn push(&mut self, at: Duration, samples: Vec<u8>) {
        let most = (MOST_BYTES / samples.len().max(1)).max(2);
        self.shots.push_back(Shot { index: self.count, at, samples: samples.into() });
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
    news: Condvar,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A camera that is on; dropping it ends its feed.
pub struct Camera {
    shared: Arc<Shared>,
    stop: Stop,
    thread: Option<JoinHandle<()>>,
}

impl Camera {
    /// Reads `feed`. `changed` is called from another thread with each frame, and at the end.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(feed: Box<dyn CameraFeed>, changed: impl Fn() + Send + 'static) -> Result<Self, Error> {
        Self::open(|| Ok(feed), changed)
    }

    /// As [`Camera::start`], with the feed that `open` opens on the same thread.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn open(
        open: impl FnOnce() -> Result<Box<dyn CameraFeed>, Error> + Send + 'static,
        changed: impl Fn() + Send + 'static,
    ) -> Result<Self, Error> {
        let shared = Arc::new(Shared::default());
        shared.state().remembered = REMEMBERED;
        let stop = Stop::default();
        let (theirs, asked) = (Arc::clone(&shared), stop.clone());
        let read = move || {
            let ended = open().and_then(|feed| read(feed, &theirs, &asked, &changed)).err();
            theirs.state().ended = Some(ended.unwrap_or_else(|| Error::new("the camera sends no more frames")));
            theirs.news.notify_all();
            changed();
        };
        let thread = thread::Builder::new().name("camera feed".into()).spawn(read);
        let thread =
            thread.map_err(|error| Error::new(format!("no thread could be started for the camera ({error})")))?;
        Ok(Self { shared, stop, thread: Some(thread) })
    }

    /// Remembers the frames of the last `time`.
    pub fn remember(&self, time: Duration) {
        self.shared.state().remembered = time;
    }

    /// What the frames are like, once the first one has come.
    pub fn format(&self) -> Option<Format> {
        self.shared.state().format.clone()
    }

    /// Why there are no more frames, if there are none.
    pub fn ended(&self) -> Option<Error> {
        self.shared.state().ended.clone()
    }

    /// Waits for a frame of number `index` or a later one, and returns the newest; `None` if there is none in `time`, or the feed
    /// has ended before it.
    pub fn wait_for(&self, index: u64, time: Duration) -> Option<Shot> {
        let newest = |state: &State| state.shots.back().filter(|shot| shot.index >= index).cloned();
        let waits = |state: &mut State| state.ended.is_none() && newest(state).is_none();
        let waited = self.shared.news.wait_timeout_while(self.shared.state(), time, waits);
        newest(&waited.unwrap_or_else(PoisonError::into_inner).0)
    }

    /// The newest frame, if one has come.
    pub fn newest(&self) -> Option<Shot> {
        self.shared.state().shots.back().cloned()
    }

    /// The remembered frames from number `index` on, of at most `time` from the first of them.
    pub fn from(&self, index: u64, time: Duration) -> Vec<Shot> {
        let state = self.shared.state();
        let first = state.shots.iter().find(|shot| shot.index >= index).map_or(Duration::ZERO, |shot| shot.at);
        let wanted = state.shots.iter().filter(|shot| shot.index >= index && shot.at <= first + time);
        wanted.cloned().collect()
    }

    /// The remembered frames of the last `time`.
    pub fn last(&self, time: Duration) -> Vec<Shot> {
        let state = self.shared.state();
        let Some(newest) = state.shots.back().map(|shot| shot.at) else { return Vec::new() };
        state.shots.iter().filter(|shot| shot.at + time >= newest).cloned().collect()
    }

    /// Frames per second that come, of the last two seconds; `None` before there is anything to measure.
    pub fn rate(&self) -> Option<f64> {
        rate(&self.last(MEASURED))
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        self.stop.set(true);
        // It looks at the flag every few milliseconds, and takes its process with it.
        self.thread.take().map(JoinHandle::join);
    }
}

/// Frames per second of shots that follow each other.
pub(super) fn rate(shots: &[Shot]) -> Option<f64> {
    let (first, last) = (shots.first()?, shots.last()?);
    let seconds = last.at.saturating_sub(first.at).as_secs_f64();
    (shots.len() > 2 && seconds > 0.0).then(|| (shots.len() - 1) as f64 / seconds)
}

/// Reads a feed to its end.
fn read(mut feed: Box<dyn CameraFeed>, shared: &Shared, stop: &Stop, changed: &dyn Fn()) -> Result<(), Error> {
    let format = feed.begin(stop)?;
    let begun = Instant::now();
    shared.state().format = Some(format);
    while let Some(samples) = feed.next(stop)? {
        shared.state().push(begun.elapsed(), samples);
        shared.news.notify_all();
        changed();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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

    /// Three frames, 5 ms from each other, and then an end or an error.
    struct Three(u8, Option<Error>);

    impl CameraFeed for Three {
        fn begin(&mut self, _: &Stop) -> Result<Format, Error> {
            Format::parse(b"YUV4MPEG2 W2 H1 F30:1 Cmono")
        }

        fn next(&mut self, _: &Stop) -> Result<Option<Vec<u8>>, Error> {
            thread::sleep(Duration::from_millis(5));
            self.0 += 1;
            if self.0 <= 3 { Ok(Some(vec![self.0; 2])) } else { self.1.clone().map_or(Ok(None), Err) }
        }
    }

    #[test]
    fn what_came_stays_after_the_end() {
        for (error, told) in [(None, "no more frames"), (Some(Error::new("it was unplugged")), "unplugged")] {
            let camera = Camera::start(Box::new(Three(0, error)), || {}).unwrap();
            let last = camera.wait_for(2, Duration::from_secs(10)).expect("the third");
            assert_eq!(last.frame(&camera.format().unwrap()).unwrap().luma().cells(), [3, 3]);
            assert!(camera.wait_for(3, Duration::from_secs(10)).is_none(), "it has ended");
            assert!(camera.ended().unwrap().to_string().contains(told));
            assert_eq!(camera.last(Duration::from_secs(5)).len(), 3);
            assert_eq!(camera.from(1, Duration::ZERO).len(), 1);
            assert_eq!(camera.from(1, Duration::from_secs(1)).len(), 2);
        }
        let refused = Camera::open(|| Err(Error::new("it is busy")), || {}).unwrap();
        assert!(refused.wait_for(0, Duration::from_secs(10)).is_none());
        assert_eq!(refused.ended(), Some(Error::new("it is busy")));
    }
}
