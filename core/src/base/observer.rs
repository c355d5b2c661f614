//! Observers of the events inside an algorithm, at no cost if nothing observes.

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

/// An observer that only counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count(pub u64);

impl<E> Observer<E> for Count {
    fn see(&mut self, _event: impl FnOnce() -> E) {
        self.0 += 1;
    }
}
