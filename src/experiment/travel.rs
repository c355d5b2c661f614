//! A move of a run as a task, which can be abandoned.

use motionscope_core::run::{Move, Walk};
use web_time::Instant;

use crate::work;

/// Goes there while `is_wanted`; returns whether it arrived. A move that is abandoned leaves the cursor where it was.
pub async fn travel(walk: &mut dyn Walk, to: Move, is_wanted: &dyn Fn() -> bool) -> bool {
    walk.go(to);
    while is_wanted() {
        let begun = Instant::now();
        if walk.work(&mut || begun.elapsed() < work::SLICE && is_wanted()) {
            return true;
        }
        work::breathe().await;
    }
    false
}
