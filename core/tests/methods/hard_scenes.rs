//! Scenes with one difficulty each, which break one tracker of a region and not another.

use crate::common::set;
use motionscope_core::base::Threads;
use motionscope_core::data::Clip;
use motionscope_core::products::RegionField;
use motionscope_core::products::region::RegionScores;
use motionscope_core::synth::{self, Difficulty};

/// The scores of a tracker over a clip.
fn scores(id: &str, settings: &[(&str, &str)], clip: &Clip) -> RegionScores {
    let output = set(id, settings).run(clip, 0, &Threads::single()).expect("a run");
    let errors = output.get::<RegionField>().expect("a region").errors(clip).expect("true boxes");
    RegionScores::of(&errors).expect("frames with a true box")
}

fn scene(id: &str) -> Clip {
    let sample = synth::scene(id).expect("a scene");
    sample.clip(&sample.difficulty()).expect("a clip")
}

/// Of two trackers with their settings, the first loses the object of a scene and the second follows it.
fn breaks(id: &str, broken: (&str, &[(&str, &str)]), unbroken: (&str, &[(&str, &str)])) {
    let clip = scene(id);
    let [lost, followed] = [broken, unbroken].map(|(tracker, settings)| scores(tracker, settings, &clip));
    assert!(lost.overlap < 0.5 && lost.failures > 0, "{id}, {}: {}, {}", broken.0, lost.overlap, lost.failures);
    assert!(followed.overlap > 0.6 && followed.failures == 0, "{id}, {}: {}", unbroken.0, followed.overlap);
}

#[test]
fn a_rotation_between_frames_breaks_the_template_and_not_the_histogram() {
    breaks("spinning-sign", ("template-tracker", &[]), ("mean-shift", &[]));
}

#[test]
fn blur_breaks_the_correlation_filter_and_not_the_histogram_of_hues() {
    breaks("blurred-swing", ("correlation-filter", &[]), ("mean-shift", &[("channels", "hue-saturation")]));
    // It is the blur: without it the filter follows the same motion.
    let sample = synth::scene("blurred-swing").expect("a scene");
    let sharp = Difficulty { motion_blur: 0.0, ..sample.difficulty() };
    let followed = scores("correlation-filter", &[], &sample.clip(&sharp).expect("a clip"));
    assert!(followed.overlap > 0.8 && followed.failures == 0, "{}", followed.overlap);
}

#[test]
fn fast_motion_breaks_the_template_and_not_the_histogram() {
    breaks("fast-flight", ("template-tracker", &[]), ("mean-shift", &[]));
}
