//! A signal that wakes the tasks that wait for it.

use std::future::poll_fn;
use std::sync::{Mutex, PoisonError};
use std::task::{Poll, Waker};

use web_time::{Duration, Instant};

use super::platform;

/// Wakes the tasks that wait in [`Signal::until`] and [`Signal::until_within`].
#[derive(Default)]
pub struct Signal(Mutex<Vec<Waker>>);

impl Signal {
    /// Has the waiting tasks look again.
    pub fn notify(&self) {
        let wakers = std::mem::take(&mut *self.wakers());
        // Without the lock: in the page a task may run at once.
        wakers.into_iter().for_each(Waker::wake);
    }

    /// Waits until `look` returns something; it is called at once, and after every notification.
    pub async fn until<T>(&self, mut look: impl FnMut() -> Option<T>) -> T {
        loop {
            if let Some(found) = self.wait(None, &mut look).await {
                return found;
            }
        }
    }

    /// As [`Signal::until`], but no longer than `longest`.
    pub async fn until_within<T>(&self, longest: Duration, look: impl FnMut() -> Option<T>) -> Option<T> {
        self.wait(Some(longest), look).await
    }

    async fn wait<T>(&self, longest: Option<Duration>, mut look: impl FnMut() -> Option<T>) -> Option<T> {
        let end = longest.map(|longest| Instant::now() + longest);
        let mut has_waited = false;
        let found = poll_fn(|context| {
            // Before looking, so that no notification falls in between.
            let mut wakers = self.wakers();
            if !wakers.iter().any(|waker| waker.will_wake(context.waker())) {
                wakers.push(context.waker().clone());
            }
            drop(wakers);
            let found = look();
            if found.is_none() && end.is_none_or(|end| Instant::now() < end) {
                if let Some(end) = end {
                    platform::wake_at(end, context.waker());
                }
                has_waited = true;
                return Poll::Pending;
            }
            self.wakers().retain(|waker| !waker.will_wake(context.waker()));
            Poll::Ready(found)
        })
        .await;
        if has_waited {
            platform::begin_slice();
        }
        found
    }

    fn wakers(&self) -> std::sync::MutexGuard<'_, Vec<Waker>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
