//! Tasks on threads.

use std::cell::Cell;
use std::collections::VecDeque;
use std::io;
use std::pin::pin;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::{self, JoinHandle, Thread};
use std::time::{Duration, Instant};

/// Whether tasks share one thread, in slices.
pub const IS_SLICED: bool = false;

/// How long a task works before it reports its progress.
pub const SLICE: Duration = Duration::from_millis(30);

/// A task at work; it goes on when this is dropped.
pub struct Task(JoinHandle<()>);

impl Task {
    /// Whether it has ended.
    pub fn is_finished(&self) -> bool {
        self.0.is_finished()
    }

    /// Waits for its end, but no longer than `longest`.
    pub fn wait(&self, longest: Duration) {
        let begun = Instant::now();
        while !self.is_finished() && begun.elapsed() < longest {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Starts `work` on a thread called `purpose`.
///
/// # Errors
/// If the system gives no thread.
pub fn spawn(purpose: &str, work: impl AsyncFnOnce() + Send + 'static) -> io::Result<Task> {
    thread::Builder::new().name(purpose.into()).spawn(move || finish(work())).map(Task)
}

/// Does `work` on this thread, which sleeps while the work waits.
pub fn finish<T>(work: impl Future<Output = T>) -> T {
    let mut work = pin!(work);
    let waker = Arc::new(Unpark(thread::current())).into();
    let mut context = Context::from_waker(&waker);
    loop {
        match work.as_mut().poll(&mut context) {
            Poll::Ready(outcome) => return outcome,
            Poll::Pending => match WAKE_AT.take() {
                Some(time) => thread::park_timeout(time.saturating_duration_since(Instant::now())),
                None => thread::park(),
            },
        }
    }
}

thread_local! {
    /// When the work of this thread looks again even if nothing wakes it.
    static WAKE_AT: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Has the waiting work of this thread look again at `time`.
pub(super) fn wake_at(time: Instant, _: &Waker) {
    WAKE_AT.set(Some(WAKE_AT.get().map_or(time, |earlier| earlier.min(time))));
}

struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// The items of an iterator, made on a thread of its own, which stays an item or two ahead and ends once this is dropped.
pub struct Ahead<T>(Receiver<T>);

impl<T: Send + 'static> Ahead<T> {
    /// Starts to make the items, on a thread called `purpose`.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(
        purpose: &str,
        items: impl FnOnce() -> Box<dyn Iterator<Item = T>> + Send + 'static,
    ) -> io::Result<Self> {
        let (sender, received) = sync_channel(1);
        let make = move || items().try_for_each(|item| sender.send(item)).unwrap_or_default();
        thread::Builder::new().name(purpose.into()).spawn(make).map(|_| Self(received))
    }
}

impl<T> Iterator for Ahead<T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        self.0.recv().ok()
    }
}

/// Hands what `make` makes of each of `jobs` to `take`, in their order; some are made ahead, on as many threads as there are cores.
///
/// # Errors
/// The errors of `take`, which gets `None` for a job that panics.
pub fn in_order<J: Send, T: Send, E>(
    jobs: impl Iterator<Item = J>,
    make: impl Fn(J) -> T + Sync,
    mut take: impl FnMut(Option<T>) -> Result<(), E>,
) -> Result<(), E> {
    let ahead = thread::available_parallelism().map_or(1, usize::from).min(8);
    let (mut jobs, make) = (jobs.fuse(), &make);
    thread::scope(|scope| {
        let mut at_work = VecDeque::new();
        loop {
            at_work.extend(jobs.by_ref().take(ahead - at_work.len()).map(|job| scope.spawn(move || make(job))));
            let Some(made) = at_work.pop_front() else { return Ok(()) };
            take(made.join().ok())?;
        }
    })
}

/// Lets others work: on a desktop they do so anyway.
pub async fn breathe() {}

/// Waits.
pub async fn sleep(time: Duration) {
    thread::sleep(time);
}

/// A thread has no slices.
pub(super) fn begin_slice() {}
