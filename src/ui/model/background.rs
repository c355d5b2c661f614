//! A task with one outcome, which reports its progress and can be cancelled.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use motionscope_core::base::{Error, Stop};

use crate::media::Progress;
use crate::work;

/// What passes between the work and whoever waits for it.
pub struct Control {
    /// Set when the work is not wanted any more.
    pub stop: Stop,
    /// Share of the work that is done, from 0 to 1, as the bits of an `f32`.
    fraction: AtomicU32,
    changed: Box<dyn Fn() + Send + Sync>,
}

impl Progress for Control {
    fn report(&self, fraction: f32) {
        let before = f32::from_bits(self.fraction.swap(fraction.to_bits(), Ordering::Relaxed));
        // Told as often as a bar can be seen to grow, however small the steps are.
        let grown = |fraction: f32| (200.0 * fraction) as u32;
        if grown(before) != grown(fraction) || before == 0.0 {
            (self.changed)();
        }
    }

    fn cancelled(&self) -> bool {
        self.stop.is_set()
    }
}

/// Work that comes to a `T`, or to why there is none. Dropping it gives the work up.
pub struct Background<T> {
    control: Arc<Control>,
    outcome: Arc<Mutex<Option<Result<T, Error>>>>,
}

impl<T: Send + 'static> Background<T> {
    /// Has `work` done, which is for `purpose`: `open the clip`. `changed` is called by the task whenever there is news.
    pub fn new(
        purpose: &str,
        changed: impl Fn() + Send + Sync + 'static,
        work: impl AsyncFnOnce(&Arc<Control>) -> Result<T, Error> + Send + 'static,
    ) -> Self {
        let control = Control { stop: Stop::default(), fraction: AtomicU32::new(0), changed: Box::new(changed) };
        let new = Self { control: Arc::new(control), outcome: Arc::default() };
        let (control, outcome) = (Arc::clone(&new.control), Arc::clone(&new.outcome));
        let run = async move || {
            let result = work(&control).await;
            *lock(&outcome) = Some(result);
            (control.changed)();
        };
        if let Err(error) = work::spawn(purpose, run) {
            *lock(&new.outcome) = Some(Err(Error::new(format!(
                "no thread could be started to {purpose} ({error}); close other programs and try again"
            ))));
            (new.control.changed)();
        }
        new
    }

    /// What it came to, once.
    pub fn take(&self) -> Option<Result<T, Error>> {
        lock(&self.outcome).take()
    }

    /// `look` at what it came to, if it is done.
    pub fn look<R>(&self, look: impl FnOnce(Option<&Result<T, Error>>) -> R) -> R {
        look(lock(&self.outcome).as_ref())
    }

    /// Share of the work that is done, from 0 to 1.
    pub fn fraction(&self) -> f32 {
        f32::from_bits(self.control.fraction.load(Ordering::Relaxed))
    }

    /// Gives it up at the next chance; the outcome tells how far it came.
    pub fn cancel(&self) {
        self.control.stop.set(true);
    }
}

impl<T> Drop for Background<T> {
    fn drop(&mut self) {
        self.control.stop.set(true);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn work_tells_how_far_it_is_and_what_it_came_to() {
        let (news, heard) = channel();
        let (go, wait) = channel();
        let work = Background::new(
            "count",
            move || news.send(()).unwrap_or_default(),
            async move |control| {
                control.report(0.5);
                wait.recv().map_err(|_| Error::new("nobody waits"))?;
                Ok(if control.cancelled() { 0 } else { 7 })
            },
        );
        heard.recv().expect("half of it");
        assert_eq!((work.fraction(), work.look(|outcome| outcome.is_some())), (0.5, false));
        go.send(()).expect("it waits");
        heard.recv().expect("all of it");
        assert_eq!((work.take(), work.take()), (Some(Ok(7)), None));
    }

    #[test]
    fn small_steps_are_reported_as_well() {
        let (news, heard) = channel();
        let work = Background::new(
            "count",
            move || news.send(()).unwrap_or_default(),
            async |control| {
                (1..=5000).for_each(|step| control.report(step as f32 / 5000.0));
                Ok(())
            },
        );
        let message = heard.iter().take(150).count();
        assert_eq!(message, 150, "a bar of 5000 steps moves often");
        drop(work);
    }

    #[test]
    fn work_that_nobody_wants_is_reported() {
        let (stopped, heard) = channel();
        drop(Background::new(
            "wait",
            || {},
            async move |control| {
                while !control.cancelled() {
                    work::breathe().await;
                }
                stopped.send(()).map_err(|_| Error::new("nobody waits"))
            },
        ));
        heard.recv().expect("it ends");
    }
}
