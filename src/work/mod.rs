//! Work that takes time, behind one door: a thread for each task on a desktop; slices of a few milliseconds between frames in a page.
//!
//! A task is an async function that calls [`breathe`] wherever it has worked for a while. On a desktop that costs nothing, and a
//! function that waits blocks its own thread. In a page all tasks share the thread of the window: `breathe` ends the slice once
//! [`SLICE`] is over, and the page draws and takes input before the next one. [`finish`] has async work done in line.

#[cfg(not(target_arch = "wasm32"))]
#[path = "desktop.rs"]
mod platform;
#[cfg(target_arch = "wasm32")]
#[path = "page.rs"]
mod platform;
mod signal;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::{Pin, pin};

#[cfg(not(target_arch = "wasm32"))]
pub use platform::finish;
pub use platform::{Ahead, IS_SLICED, SLICE, Task, breathe, in_order, sleep, spawn};
pub use signal::Signal;

/// Work behind a trait, which returns a `T`.
pub type Boxed<'a, T> = Pin<Box<dyn Future<Output = T> + 'a>>;

/// Does `work`; a panic is an error with its payload.
///
/// # Errors
/// The payload of the panic. In a page a panic ends the program.
pub async fn caught<T>(work: impl Future<Output = T>) -> Result<T, Box<dyn Any + Send>> {
    let mut work = pin!(work);
    std::future::poll_fn(|context| match catch_unwind(AssertUnwindSafe(|| work.as_mut().poll(context))) {
        Ok(poll) => poll.map(Ok),
        Err(panic) => std::task::Poll::Ready(Err(panic)),
    })
    .await
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_task_waits_for_its_signal_and_ends() {
        let signal = Arc::new(Signal::default());
        let (orders, waiting) = channel();
        let (told, heard) = channel();
        let theirs = Arc::clone(&signal);
        let task = spawn("add", async move || {
            for sum in [3, 7] {
                let (a, b): (i32, i32) = theirs.until(|| waiting.try_recv().ok()).await;
                breathe().await;
                told.send((a + b, sum)).unwrap();
            }
        })
        .expect("a thread");
        for order in [(1, 2), (3, 4)] {
            orders.send(order).unwrap();
            signal.notify();
            let (sum, expected) = heard.recv().unwrap();
            assert_eq!(sum, expected);
        }
        task.wait(Duration::from_secs(20));
        assert!(task.is_finished());
    }

    #[test]
    fn a_signal_wakes_all_that_wait_and_a_wait_has_an_end() {
        let (signal, value) = (Arc::new(Signal::default()), Arc::<std::sync::Mutex<u32>>::default());
        let (told, heard) = channel();
        let begun = web_time::Instant::now();
        for _ in 0..3 {
            let (signal, value, told) = (Arc::clone(&signal), Arc::clone(&value), told.clone());
            let look = move || Some(*value.lock().unwrap()).filter(|value| *value > 0);
            let wait = async move || told.send(signal.until_within(Duration::from_secs(20), look).await).unwrap();
            drop(spawn("wait", wait).expect("a thread"));
        }
        *value.lock().unwrap() = 7;
        signal.notify();
        assert!((0..3).all(|_| heard.recv().unwrap() == Some(7)));
        assert!(begun.elapsed() < Duration::from_secs(10), "none waited to its end");
        let begun = web_time::Instant::now();
        assert_eq!(finish(signal.until_within(Duration::from_millis(20), || None::<()>)), None);
        assert!(begun.elapsed() >= Duration::from_millis(20));
    }

    #[test]
    fn a_panic_is_caught_after_a_pause() {
        let outcome = finish(caught(async {
            sleep(Duration::from_millis(1)).await;
            panic!("on purpose");
        }));
        let payload: Box<dyn Any + Send> = outcome.expect_err("it panics");
        assert_eq!(payload.downcast_ref::<&str>(), Some(&"on purpose"));
        assert!(matches!(finish(caught(async { 7 })), Ok(7)));
    }
}
