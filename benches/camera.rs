//! How many frames of a camera an estimator runs on: `cargo bench --bench camera [-- ESTIMATOR]`.
//!
//! The test picture, 640×480 px at 30 frames per second, as the window runs an estimator on it: search, marks and colours, on a
//! thread of its own. First it lists the estimators that keep up.

use std::thread;
use std::time::Duration;

use motionscope::media::camera::{Camera, Size, TestPicture};
use motionscope::ui::model::live::Live;
use motionscope_core::course::estimator;

/// The time over which frames are counted.
const COUNTED: Duration = Duration::from_secs(10);

fn main() {
    let id = std::env::args().skip(1).find(|word| !word.starts_with("--")).unwrap_or_else(|| "diamond".into());
    let chosen = estimator(&id).expect("an estimator");
    let camera = Camera::start(Box::new(TestPicture::new(Size::default())), || {}).expect("a thread");
    let mut live = Live::new(camera, || {}).expect("a thread");
    live.measure();
    while !live.view().is_measured {
        thread::sleep(Duration::from_millis(50));
    }
    for (info, time) in live.view().offered {
        println!("{:6.1} ms  {}", 1000.0 * time.as_secs_f64(), info.id);
    }
    live.choose(Some(chosen));
    thread::sleep(COUNTED);
    let (view, camera) = (live.view(), live.camera().rate().unwrap_or_default());
    let (rate, dropped) = (view.rate.unwrap_or_default(), view.dropped);
    println!("{id}: {rate:.1} frames/s, {dropped} dropped in {} s; camera: {camera:.1} frames/s", COUNTED.as_secs());
}
