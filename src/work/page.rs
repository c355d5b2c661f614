//! Tasks in slices between the frames of a page, all on its one thread.

use std::cell::Cell;
use std::future::poll_fn;
use std::io;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Poll, Waker};
use std::time::Duration;

use send_wrapper::SendWrapper;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_time::Instant;

/// Whether tasks share one thread, in slices.
pub const IS_SLICED: bool = true;

/// How long all tasks work before the page draws and takes input.
pub const SLICE: Duration = Duration::from_millis(8);

thread_local! {
    static BEGUN: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// A task at work; it goes on when this is dropped.
pub struct Task(Arc<AtomicBool>);

impl Task {
    /// Whether it has ended.
    pub fn is_finished(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Does not wait: the task cannot go on before this returns.
    pub fn wait(&self, _: Duration) {}
}

/// Starts `work` in the next slice.
///
/// # Errors
/// None in a page.
pub fn spawn(_purpose: &str, work: impl AsyncFnOnce() + Send + 'static) -> io::Result<Task> {
    let task = Task(Arc::default());
    let is_finished = Arc::clone(&task.0);
    spawn_local(async move {
        next_slice().await;
        work().await;
        is_finished.store(true, Ordering::Relaxed);
    });
    Ok(task)
}

/// The items of an iterator, made when they are asked for.
pub struct Ahead<T>(SendWrapper<Box<dyn Iterator<Item = T>>>);

impl<T> Ahead<T> {
    /// Prepares to make the items.
    ///
    /// # Errors
    /// None in a page.
    pub fn start(_purpose: &str, items: impl FnOnce() -> Box<dyn Iterator<Item = T>>) -> io::Result<Self> {
        Ok(Self(SendWrapper::new(items())))
    }
}

impl<T> Iterator for Ahead<T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        self.0.next()
    }
}

/// Hands what `make` makes of each of `jobs` to `take`, in their order.
///
/// # Errors
/// The errors of `take`.
pub fn in_order<J, T, E>(
    jobs: impl Iterator<Item = J>,
    make: impl Fn(J) -> T,
    mut take: impl FnMut(Option<T>) -> Result<(), E>,
) -> Result<(), E> {
    jobs.map(make).map(Some).try_for_each(|made| take(made))
}

/// Lets the page draw and take input if the slice is over.
pub async fn breathe() {
    if is_slice_over() {
        next_slice().await;
    }
}

/// Whether the time of all tasks is used up.
fn is_slice_over() -> bool {
    BEGUN.get().is_none_or(|begun| begun.elapsed() >= SLICE)
}

/// Waits, while others work.
pub async fn sleep(time: Duration) {
    let millis = i32::try_from(time.as_millis()).unwrap_or(i32::MAX);
    wait(|over| set_timeout(&Closure::once_into_js(over), millis)).await;
    begin_slice();
}

/// Wakes a task at `time`.
pub(super) fn wake_at(time: Instant, waker: &Waker) {
    let waker = waker.clone();
    let left = time.saturating_duration_since(Instant::now());
    // Rounded up, so that the time is over by then.
    let millis = i32::try_from(left.as_millis()).map_or(i32::MAX, |millis| millis.saturating_add(1));
    set_timeout(&Closure::once_into_js(move || waker.wake()), millis);
}

/// Notes that a task goes on after a wait.
pub(super) fn begin_slice() {
    BEGUN.set(Some(Instant::now()));
}

/// Ends the slice, and waits for one in which other tasks have left some time. Tasks to which none was left come first in the next one.
async fn next_slice() {
    let mut has_waited = false;
    while !has_waited || is_slice_over() {
        wait(|over| TURNS.with(|turns| turns.wait(over, has_waited))).await;
        has_waited = true;
    }
}

/// Waits until the callback is called that `begin` is given. Another signal that wakes the task meanwhile ends no wait.
async fn wait(begin: impl FnOnce(Box<dyn FnOnce()>)) {
    let (is_over, waker) = (Rc::<Cell<bool>>::default(), Rc::<Cell<Option<Waker>>>::default());
    let (ends, wakes) = (Rc::clone(&is_over), Rc::clone(&waker));
    begin(Box::new(move || {
        ends.set(true);
        if let Some(waker) = wakes.take() {
            waker.wake();
        }
    }));
    poll_fn(|context| {
        waker.set(Some(context.waker().clone()));
        if is_over.get() { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
}

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_name = setTimeout)]
    fn set_timeout(then: &JsValue, millis: i32);
}

thread_local! {
    static TURNS: Turns = Turns::new();
}

/// Messages of the page to itself: each comes after what the browser has to do, without the least time that timers have.
struct Turns {
    channel: web_sys::MessageChannel,
    /// The tasks that had no time in their turn, and those that had some.
    waiting: [Rc<Cell<Vec<Box<dyn FnOnce()>>>>; 2],
    _received: Closure<dyn FnMut()>,
}

impl Turns {
    fn new() -> Self {
        let channel = web_sys::MessageChannel::new().expect("every browser that draws the window has channels");
        let waiting = <[Rc<Cell<Vec<Box<dyn FnOnce()>>>>; 2]>::default();
        let theirs = waiting.clone();
        let received = Closure::<dyn FnMut()>::new(move || {
            begin_slice();
            // All of them, before the first of them waits again.
            let turn = theirs.each_ref().map(|tasks| tasks.take());
            turn.into_iter().flatten().for_each(|over| over());
        });
        channel.port1().set_onmessage(Some(received.as_ref().unchecked_ref()));
        Self { channel, waiting, _received: received }
    }

    fn wait(&self, over: Box<dyn FnOnce()>, had_no_time: bool) {
        let mut waiting = self.waiting.each_ref().map(|tasks| tasks.take());
        let is_first = waiting.iter().all(Vec::is_empty);
        waiting[if had_no_time { 0 } else { 1 }].push(over);
        self.waiting.iter().zip(waiting).for_each(|(tasks, waiting)| tasks.set(waiting));
        if is_first {
            // A channel that is kept does not fail.
            let _ = self.channel.port2().post_message(&JsValue::NULL);
        }
    }
}
