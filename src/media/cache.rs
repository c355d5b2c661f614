//! The one frame cache: decodes on demand and remembers what it met, bounded in bytes.
//!
//! A format is a decoder without caching; this cache stands in front of all of them. Decoders check the clip's `Stop` before
//! each frame and report progress to it.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread;
use std::time::Duration;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{Clip, Frame, FrameSource};

use super::names::file_name;
use super::{Decoder, Source, catch_panic, reason};

/// How often a thread that waits for the decoder asks whether it should stop.
const POLL: Duration = Duration::from_millis(2);

/// Frames that come from a decoder when they are wanted.
///
/// One thread decodes at a time. Looking into the cache never waits for it.
pub(crate) struct Lazy {
    name: String,
    size: (usize, usize),
    files: Arc<[PathBuf]>,
    decoder: Mutex<Box<dyn Decoder>>,
    cache: Mutex<Cache>,
}

/// The clip of the frames in `source`, of which up to `cache_bytes` are kept.
pub(crate) fn clip(source: Source, cache_bytes: usize) -> Clip {
    Clip::new(source.info.clone(), Arc::new(Lazy::new(source, cache_bytes)))
}

/// The most that cached frames may take: an eighth of the free memory, so that both views leave most of it to runs.
fn most_bytes() -> usize {
    usize::try_from(motionscope_core::base::heap::free() / 8).unwrap_or(usize::MAX)
}

impl Lazy {
    /// The clip in `source`, whose cached frames take up to `cache_bytes`.
    pub(crate) fn new(source: Source, cache_bytes: usize) -> Self {
        let Source { info, decoder, files, .. } = source;
        Self {
            name: Error::short_name(&info.name),
            size: (info.width, info.height),
            files,
            decoder: Mutex::new(decoder),
            cache: Mutex::new(Cache::new(cache_bytes.min(most_bytes()))),
        }
    }

    /// The decoder, once no other thread is at it; `None` if `stop` comes first.
    fn decoder(&self, stop: &Stop) -> Option<MutexGuard<'_, Box<dyn Decoder>>> {
        loop {
            match self.decoder.try_lock() {
                Ok(decoder) => return Some(decoder),
                Err(TryLockError::Poisoned(decoder)) => return Some(decoder.into_inner()),
                Err(TryLockError::WouldBlock) if stop.is_set() => return None,
                Err(TryLockError::WouldBlock) => thread::sleep(POLL),
            }
        }
    }

    /// Frame `index` out of the cache or decoded; `None` where the clip ends before it.
    fn find(&self, index: usize, stop: &Stop) -> Result<Option<Arc<Frame>>, Error> {
        if let Some(frame) = self.cached(index) {
            return Ok(Some(frame));
        }
        let Some(mut decoder) = self.decoder(stop) else { return Err(self.given_up(index)) };
        // Whoever held the decoder may have met the frame.
        match self.cached(index) {
            Some(frame) => Ok(Some(frame)),
            None => self.decode(index, decoder.as_mut(), stop),
        }
    }

    /// Frame `index`; `None` where the clip ends before it.
    fn decode(&self, index: usize, decoder: &mut dyn Decoder, stop: &Stop) -> Result<Option<Arc<Frame>>, Error> {
        let mut wanted = None;
        let mut misfit = None;
        let mut keep = |number: usize, frame: Frame| {
            if frame.size() != self.size {
                misfit = Some((number, frame.size()));
                return;
            }
            let frame = Arc::new(frame);
            if number == index {
                wanted = Some(Arc::clone(&frame));
            }
            lock(&self.cache).insert(number, frame);
        };
        let result = catch_panic::catch_panic(|| decoder.decode(index, stop, &mut keep))
            .unwrap_or_else(|panic| Err(Error::new(format!("its data are damaged{}", reason::bracketed(&panic)))));
        stop.report(0, 0);
        match (wanted, misfit, result) {
            (Some(frame), _, _) => Ok(Some(frame)),
            (None, Some((number, (w, h))), _) if number == index => {
                let (width, height) = self.size;
                Err(self.refuse(index, &format!("it is {w}×{h} px, but the clip is {width}×{height} px")))
            }
            (None, _, Err(_)) if stop.is_set() => Err(self.given_up(index)),
            (None, _, Err(error)) => Err(self.refuse(index, &error.to_string())),
            (None, _, Ok(())) => Ok(None),
        }
    }

    fn given_up(&self, index: usize) -> Error {
        Error::new(format!("frame {index} of {} was cancelled; request it again", self.name))
    }

    fn refuse(&self, index: usize, why: &str) -> Error {
        let rest = match index {
            _ if !self.files.is_empty() => "; the other pictures can be used",
            0 => "",
            _ => "; frames before the damage can be used",
        };
        Error::new(format!("frame {index} of {} cannot be shown: {why}{rest}", self.name))
    }
}

impl FrameSource for Lazy {
    fn frame(&self, index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
        self.find(index, stop)?.ok_or_else(|| self.refuse(index, "the clip ends before it"))
    }

    fn has_frame(&self, index: usize, stop: &Stop) -> Result<bool, Error> {
        self.find(index, stop).map(|frame| frame.is_some())
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        lock(&self.cache).get(index)
    }

    fn name(&self, index: usize) -> Option<String> {
        self.files.get(index).map(|file| file_name(file))
    }
}

/// Locks also what a panicking thread held: the state under both locks stays whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The frames used last.
struct Cache {
    limit: usize,
    bytes: usize,
    clock: u64,
    frames: HashMap<usize, (u64, Arc<Frame>)>,
    /// Frame number by the time of its last use.
    used: BTreeMap<u64, usize>,
}

impl Cache {
    fn new(limit: usize) -> Self {
        Self { limit, bytes: 0, clock: 0, frames: HashMap::new(), used: BTreeMap::new() }
    }

    fn get(&mut self, index: usize) -> Option<Arc<Frame>> {
        self.clock += 1;
        let (used, frame) = self.frames.get_mut(&index)?;
        self.used.remove(used);
        *used = self.clock;
        self.used.insert(self.clock, index);
        Some(Arc::clone(frame))
    }

    fn insert(&mut self, index: usize, frame: Arc<Frame>) {
        self.remove(index);
        self.clock += 1;
        self.bytes += frame.bytes();
        self.used.insert(self.clock, index);
        self.frames.insert(index, (self.clock, frame));
        // The frame that came last stays, whatever it takes.
        while self.bytes > self.limit && self.frames.len() > 1 {
            let Some(oldest) = self.used.first_entry().map(|entry| *entry.get()) else { break };
            self.remove(oldest);
        }
    }

    fn remove(&mut self, index: usize) {
        if let Some((used, frame)) = self.frames.remove(&index) {
            self.used.remove(&used);
            self.bytes -= frame.bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use motionscope_core::data::ClipInfo;
    use motionscope_core::geometry::Grid;

    use super::*;

    /// Sixty frames, key frames every ten; each frame holds its number. Frame 25 is damaged, 35 panics, 45 has another size.
    struct Tens {
        next: usize,
        decoded: Arc<AtomicUsize>,
    }

    impl Decoder for Tens {
        fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
            let key = index / 10 * 10;
            if index < self.next || key > self.next {
                self.next = key;
            }
            while self.next <= index {
                stop.check()?;
                let number = self.next;
                self.decoded.fetch_add(1, Ordering::Relaxed);
                match number {
                    25 => return Err(Error::new("its bits are wrong")),
                    35 => panic!("index out of bounds"),
                    60.. => return Ok(()),
                    _ => {}
                }
                self.next += 1;
                keep(number, Frame::gray(Grid::new(if number == 45 { 5 } else { 10 }, 10, number as u8)));
            }
            Ok(())
        }
    }

    fn tens(cache_frames: usize) -> (Lazy, Arc<AtomicUsize>) {
        let decoded = Arc::new(AtomicUsize::new(0));
        let decoder = Tens { next: 0, decoded: Arc::clone(&decoded) };
        let info = ClipInfo {
            name: "tens".into(),
            width: 10,
            height: 10,
            frames: Some(60),
            fps: None,
            container: "test".into(),
            codec: "test".into(),
            warnings: vec![],
        };
        (Lazy::new(Source::new(info, decoder), cache_frames * 100), decoded)
    }

    fn frame(clip: &Lazy, index: usize) -> Result<Arc<Frame>, Error> {
        clip.frame(index, &Stop::default())
    }

    #[test]
    fn frames_on_the_way_are_kept_and_nothing_is_decoded_twice() {
        let (clip, decoded) = tens(100);
        for index in [7, 6, 5, 0, 8, 9, 10, 18, 12, 9] {
            assert_eq!(frame(&clip, index).unwrap().luma()[(0, 0)], index as u8);
        }
        assert_eq!(decoded.load(Ordering::Relaxed), 19);
        assert!(clip.cached(11).is_some() && clip.cached(19).is_none());
    }

    #[test]
    fn memory_is_bounded_and_the_oldest_goes_first() {
        let (clip, _) = tens(4);
        frame(&clip, 9).unwrap();
        let kept: Vec<_> = (0..60).filter(|&i| clip.cached(i).is_some()).collect();
        assert_eq!(kept, [6, 7, 8, 9]);
        assert_eq!(lock(&clip.cache).bytes, 400);
        frame(&clip, 6).unwrap();
        frame(&clip, 10).unwrap();
        assert!(clip.cached(6).is_some() && clip.cached(7).is_none());
        let (tiny, _) = tens(0);
        assert_eq!(frame(&tiny, 3).unwrap().luma()[(0, 0)], 3);
        assert!(tiny.cached(3).is_some() && tiny.cached(2).is_none());
    }

    #[test]
    fn damage_is_reported_and_its_neighbours_stay_usable() {
        let (clip, _) = tens(100);
        for (bad, why) in [(25, "bits are wrong"), (35, "out of bounds"), (45, "5×10")] {
            for _ in 0..2 {
                let message = frame(&clip, bad).unwrap_err().to_string();
                assert!(message.contains(&format!("frame {bad} of tens")) && message.contains(why), "{message}");
            }
            assert!(frame(&clip, bad - 1).is_ok() && frame(&clip, bad + 5).is_ok());
        }
        assert!(frame(&clip, 27).unwrap_err().to_string().contains("bits are wrong"));
        let has = |index| clip.has_frame(index, &Stop::default());
        assert!(has(24) == Ok(true) && has(25).is_err() && has(60) == Ok(false), "the end is no damage");
        assert!(frame(&clip, 60).unwrap_err().to_string().contains("ends before it"));
    }

    /// Asks for frame `index` on another thread, with a flag to stop it.
    fn wait_for(clip: &Arc<Lazy>, index: usize) -> (Stop, thread::JoinHandle<Result<Arc<Frame>, Error>>) {
        let (stop, clip) = (Stop::default(), Arc::clone(clip));
        let theirs = stop.clone();
        (stop, thread::spawn(move || clip.frame(index, &theirs)))
    }

    /// A decoder that would go on for ever, with a frame every millisecond.
    struct Endless;

    impl Decoder for Endless {
        fn decode(&mut self, _: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
            for number in 0.. {
                stop.check()?;
                keep(number % 9, Frame::gray(Grid::new(10, 10, 0)));
                thread::sleep(Duration::from_millis(1));
            }
            Ok(())
        }
    }

    #[test]
    fn whoever_stops_waits_no_longer_and_leaves_the_rest_usable() {
        let (mut clip, _) = tens(100);
        clip.decoder = Mutex::new(Box::new(Endless));
        let clip = Arc::new(clip);
        let (decodes, at_work) = wait_for(&clip, 50);
        while clip.cached(0).is_none() {
            thread::sleep(POLL);
        }
        let (waits, in_line) = wait_for(&clip, 51);
        // Only the one that is stopped gives up.
        waits.set(true);
        assert!(in_line.join().unwrap().unwrap_err().to_string().contains("frame 51 of tens was cancelled"));
        assert!(!at_work.is_finished());
        decodes.set(true);
        assert!(at_work.join().unwrap().unwrap_err().to_string().contains("frame 50 of tens was cancelled"));
        assert!(frame(&clip, 0).is_ok());
    }

    #[test]
    fn looking_never_waits_for_decoding() {
        let (clip, _) = tens(100);
        frame(&clip, 1).unwrap();
        let busy = clip.decoder.lock().unwrap();
        assert!(clip.cached(1).is_some() && clip.cached(2).is_none());
        assert!(frame(&clip, 0).is_ok());
        drop(busy);
    }
}
