//! How fast disparities are estimated: `cargo bench -p motionscope-core --bench stereo`.
//!
//! On a synthetic pair of 450×375 px with 64 disparities, on one and on two threads; the errors are printed beside the times.

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::products::DisparityField;
use motionscope_core::products::disparity::disparity_error;
use motionscope_core::synth;

fn whole_runs(c: &mut Criterion) {
    let scene = synth::scene("still-life").expect("a scene");
    let clip = scene.clip(&synth::Difficulty { width: 450, height: 375, ..scene.difficulty() }).expect("a clip");
    let truth = clip.truth().expect("a truth").disparity(0).expect("disparities").expect("two views");
    for (id, settings) in [
        ("semi-global-matching", &[][..]),
        ("semi-global-matching", &[("paths", "4")]),
        ("semi-global-matching", &[("fill", "off")]),
        ("block-stereo", &[]),
        ("block-stereo", &[("cost", "census")]),
    ] {
        let mut stereo = estimator(id).expect("it is there");
        settings.iter().for_each(|(name, value)| stereo.set(name, value).expect("in range"));
        for threads in [1, 2] {
            let pool = Threads::new(threads).expect("threads");
            c.bench_function(&format!("{id} {settings:?} 450×375, {threads} thread(s)"), |b| {
                b.iter(|| stereo.run(&clip, 0, &pool).expect("a run"));
            });
        }
        let output = stereo.run(&clip, 0, &Threads::single()).expect("a run");
        let map = &output.get::<DisparityField>().expect("disparities").map;
        let error = disparity_error(map, &truth).expect("one size").expect("compared");
        println!(
            "{id} {settings:?}: {:.2} % wrong by more than 3 px, mean error {:.3} px",
            100.0 * error.bad3,
            error.epe_px
        );
    }
}

criterion_group!(benches, whole_runs);
criterion_main!(benches);
