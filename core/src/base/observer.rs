//! Observers of the events inside an algorithm, at no cost if nothing observes.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// A receiver of an algorithm's events. `()` ignores them at no cost; `Vec<E>` keeps them.
pub trait Observer<E> {
    /// Whether anything that it is shown is seen.
    const WATCHES: bool = true;

    /// Sees `event`, which is only made for an observer that looks.
    fn see(&mut self, event: impl FnOnce() -> E);
}

impl<E> Observer<E> for () {
    const WATCHES: bool = false;

    #[inline(always)]
    fn see(&mut self, _event: impl FnOnce() -> E) {}
}

impl<E> Observer<E> for Vec<E> {
    fn see(&mut self, event: impl FnOnce() -> E) {
        self.push(event());
    }
}

/// An observer to whom events are told as what `map` makes of them: a part of an estimator's work within the whole.
pub struct Mapped<'a, O, F> {
    /// The receiver.
    pub observer: &'a mut O,
    /// What they are within the whole.
    pub map: F,
}

impl<A, B, O: Observer<B>, F: Fn(A) -> B> Observer<A> for Mapped<'_, O, F> {
    const WATCHES: bool = O::WATCHES;

    #[inline(always)]
    fn see(&mut self, event: impl FnOnce() -> A) {
        self.observer.see(|| (self.map)(event()));
    }
}

/// The count of the units and events of a run, whose units may be done on several threads. `()` counts nothing at no cost.
pub trait Tally<E>: Sync {
    /// The observer of one thread.
    type Counter<'a>: Observer<E>
    where
        Self: 'a;

    /// Returns an observer that counts the events it sees.
    fn counter(&self) -> Self::Counter<'_>;

    /// Counts units.
    fn add_units(&self, count: usize);

    /// Counts events that no observer sees, because their number is known.
    fn add_events(&self, count: u64);
}

impl<E> Tally<E> for () {
    type Counter<'a> = ();

    fn counter(&self) {}

    fn add_units(&self, _: usize) {}

    fn add_events(&self, _: u64) {}
}

/// The number of units and events of a run.
#[derive(Debug, Default)]
pub struct Count {
    units: AtomicUsize,
    events: AtomicU64,
}

impl Count {
    /// Returns the number of units.
    pub fn units(&self) -> usize {
        self.units.load(Ordering::Relaxed)
    }

    /// Returns the number of events.
    pub fn events(&self) -> u64 {
        self.events.load(Ordering::Relaxed)
    }
}

impl<E> Tally<E> for Count {
    type Counter<'a> = Counter<'a>;

    fn counter(&self) -> Counter<'_> {
        Counter { events: 0, total: &self.events }
    }

    fn add_units(&self, count: usize) {
        self.units.fetch_add(count, Ordering::Relaxed);
    }

    fn add_events(&self, count: u64) {
        self.events.fetch_add(count, Ordering::Relaxed);
    }
}

/// An observer that counts, and adds what it has counted when it is dropped.
#[derive(Debug)]
pub struct Counter<'a> {
    events: u64,
    total: &'a AtomicU64,
}

impl<E> Observer<E> for Counter<'_> {
    #[inline(always)]
    fn see(&mut self, _event: impl FnOnce() -> E) {
        self.events += 1;
    }
}

impl Drop for Counter<'_> {
    fn drop(&mut self) {
        self.total.fetch_add(self.events, Ordering::Relaxed);
    }
}
