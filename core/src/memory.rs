//! Memory that is asked for again and again.

use std::hint::black_box;
use std::sync::Once;

/// The largest block of which glibc learns, less what it adds to one.
const LARGEST: usize = (32 << 20) - (64 << 10);

/// Has the allocator keep what is given back, up to some tens of MiB, for the next run. Pages that come from the system
/// anew have to be cleared and mapped, which takes longer than most filters do. glibc learns from a big block that is given
/// back that such blocks come and go (`M_MMAP_THRESHOLD` in mallopt(3)); where another allocator is at work, nothing is
/// lost: the block is never touched.
pub fn keep() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| drop(black_box(Vec::<u8>::with_capacity(LARGEST))));
}
