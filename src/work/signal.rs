//! A signal that wakes the task that waits for it.

use std::future::poll_fn;
use std::sync::{Mutex, PoisonError};
use std::task::{Poll, Waker};

use super::platform;

/// Wakes the one task that waits in [`Signal::until`].
#[derive(Default)]
pub struct Signal(Mutex<Option<Waker>>);

impl Signal {
    /// Has the waiting task look again.
    pub fn notify(&self) {
        let waker = self.waker().take();
        // Without the lock: in the page the task may run at once.
        if let Some(waker) = waker {
            waker.wake();
        }
    }

    /// Waits until `look` returns something; it is called at once, and after every notification.
    pub async fn until<T>(&self, mut look: impl FnMut() -> Option<T>) -> T {
        let mut has_waited = false;
        let found = poll_fn(|context| {
            // Before looking, so that no notification falls in between.
            *self.waker() = Some(context.waker().clone());
            let found = look();
            has_waited |= found.is_none();
            if found.is_some() {
                *self.waker() = None;
            }
            found.map_or(Poll::Pending, Poll::Ready)
        })
        .await;
        if has_waited {
            platform::begin_slice();
        }
        found
    }

    fn waker(&self) -> std::sync::MutexGuard<'_, Option<Waker>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
