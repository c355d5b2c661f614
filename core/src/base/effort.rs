//! The work of a thread in pixels, so that tests can compare what a run, a walk and an explanation take without a clock.

use std::cell::Cell;

thread_local! {
    static PIXELS: Cell<u64> = const { Cell::new(0) };
}

/// Adds a pass over a number of pixels to the work of this thread. The kernels that go through whole pictures call it.
#[inline]
pub(crate) fn add(pixels: usize) {
    PIXELS.with(|total| total.set(total.get() + pixels as u64));
}

/// Returns the pixels that this thread has gone through so far, once for each pass.
pub fn pixels() -> u64 {
    PIXELS.with(Cell::get)
}
