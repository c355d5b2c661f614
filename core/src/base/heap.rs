//! The memory of the machine: how much is free, and how what is given back is kept for the next run.

use std::hint::black_box;
use std::sync::{Once, OnceLock};

/// The largest block of which glibc learns, less what it adds to one.
const LARGEST: usize = (32 << 20) - (64 << 10);

/// Has the allocator keep what is given back, up to some tens of MiB, for the next run. Pages that come from the system
/// anew have to be cleared and mapped, which takes longer than most filters do. glibc learns from a big block that is given
/// back that such blocks come and go (`M_MMAP_THRESHOLD` in mallopt(3)); where another allocator is at work, nothing is
/// lost: the block is never touched.
pub(crate) fn keep() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| drop(black_box(Vec::<u8>::with_capacity(LARGEST))));
}

/// The bytes of memory that are taken to be free where the system does not tell.
pub const ASSUMED_FREE: u64 = 8 << 30;

/// Who tells how much is free.
static METER: OnceLock<fn() -> Option<u64>> = OnceLock::new();

/// Has `free` tell from now on how many bytes of memory the machine has left, if it knows. The first one that is given stays.
pub fn measure_with(free: fn() -> Option<u64>) {
    // A second meter would measure the same machine.
    let _ = METER.set(free);
}

/// The bytes of memory that are free.
pub fn free() -> u64 {
    METER.get().and_then(|free| free()).unwrap_or(ASSUMED_FREE)
}
