//! How good the fast searches are, measured against full search and against exact truth on synthetic scenes.

use motionscope_core::{BlockField, Clip, Threads, estimator, metrics, predict, synth};

/// PSNR in dB of the prediction of frame `t` that `id` makes with `settings`, and its candidates.
fn quality((id, settings): (&str, &[(&str, &str)]), clip: &Clip, t: usize) -> (f64, u64) {
    let mut search = estimator(id).expect("it is there");
    settings.iter().for_each(|(name, value)| search.set(name, value).expect("in range"));
    let output = search.run(clip, t, &Threads::single()).expect("a run");
    let field = output.get::<BlockField>().expect("blocks");
    let [current, next] = clip.pair(t).expect("a pair");
    let prediction = predict(&field.flow(), next.luma(), (field.border, field.filter));
    (metrics::psnr_db(&prediction, current.luma()).expect("one size"), field.candidates())
}

#[test]
fn predictive_search_stays_within_a_tenth_of_a_decibel_of_full_search() {
    for scene in synth::SCENES {
        let clip = scene.clip(&scene.difficulty()).expect("sliders in range");
        for t in [0, 4] {
            let [(full, all), (fast, some)] = ["full-search", "predictive"].map(|id| quality((id, &[]), &clip, t));
            assert!(some * 4 < all, "{}: {some} candidates of {all}", scene.id);
            assert!(full - fast < 0.1, "{} at {t}: {fast:.2} dB, full search {full:.2} dB", scene.id);
        }
    }
}

#[test]
fn the_fast_ball_is_reached_as_its_scene_promises() {
    let scene = synth::scene("fast-ball").expect("it is there");
    let clip = scene.clip(&scene.difficulty()).expect("sliders in range");
    let psnr = |id, settings| quality((id, settings), &clip, 0).0;
    let near = psnr("full-search", &[]);
    assert!(psnr("full-search", &[("range", "32")]) > near + 2.0);
    assert!(psnr("hierarchical", &[("range", "32"), ("block", "8")]) > near + 2.0);
    assert!(psnr("hierarchical", &[("range", "32")]) < near, "large blocks bury the ball");
}
