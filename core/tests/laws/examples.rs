//! What the examples claim, measured: where an estimator works, where it fails, and what works instead.

use crate::common::clip_of;
use motionscope_core::base::Threads;
use motionscope_core::course::examples::{self, Cause, Example, Settings};
use motionscope_core::course::{detection, estimator, estimators};
use motionscope_core::products::Reference;
use motionscope_core::run::AnyEstimator;

/// The measure of an example after a run of the estimator `id`.
fn measured(id: &str, settings: &Settings, example: &Example) -> f64 {
    let mut estimator = estimator(id).expect("an estimator");
    settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("a parameter in range"));
    let (clip, threads) = (clip_of(example), Threads::single());
    let output = estimator.run(&clip, example.frame, &threads).expect("a run");
    let reference = Reference { clip: &clip, frame: example.frame };
    let assessment = detection::assess(&*estimator, &output, &reference, &threads).expect("an assessment");
    let score = assessment.scores.iter().find(|score| score.measure.key == example.measure);
    let value = score.and_then(|score| score.value.real());
    value.unwrap_or_else(|| panic!("{id} on {} has no {}", example.clip, example.measure))
}

fn check(family: impl Fn(&dyn AnyEstimator) -> bool) {
    let mut count = 0;
    for example in examples::examples() {
        for id in example.of.iter().filter(|id| family(&*estimator(id).expect("an estimator"))) {
            let value = measured(id, &example.settings, example);
            let Example { measure, limit, .. } = example;
            assert!(limit.holds(value), "{id}, {}: {measure} {value} is not {limit:?}", example.id);
            count += 1;
        }
        let is_of_family = family(&*estimator(example.of[0]).expect("an estimator"));
        let Some(other) = example.instead.as_ref().filter(|_| is_of_family) else { continue };
        let value = measured(other.id, &other.settings, example);
        assert!(other.limit.holds(value), "{} instead, {}: {value} is not {:?}", other.id, example.id, other.limit);
    }
    assert!(count > 0, "none was checked");
}

#[test]
fn what_block_matching_shows() {
    check(|estimator| estimator.info().family == estimator_family("full-search"));
}

#[test]
fn what_optical_flow_shows() {
    check(|estimator| estimator.info().family == estimator_family("horn-schunck"));
}

#[test]
fn what_all_others_show() {
    let checked = [estimator_family("full-search"), estimator_family("horn-schunck")];
    check(|estimator| !checked.contains(&estimator.info().family));
}

#[test]
fn each_difficulty_of_a_region_breaks_one_tracker_and_not_another() {
    for cause in [
        Cause::Occlusion,
        Cause::Clutter,
        Cause::LightChange,
        Cause::ScaleChange,
        Cause::Rotation,
        Cause::MotionBlur,
        Cause::LargeMotion,
    ] {
        let shows = |example: &Example| {
            let is_of_region = estimator_family(example.of[0]) == estimator_family("mean-shift");
            let other = example.instead.as_ref().is_some_and(|instead| !example.of.contains(&instead.id));
            example.cause == Some(cause) && is_of_region && other
        };
        assert!(examples::examples().any(shows), "{}", cause.name());
    }
}

fn estimator_family(id: &str) -> &'static str {
    estimator(id).expect("an estimator").info().family
}

#[test]
fn every_estimator_has_examples_of_success_and_failure_with_names_of_their_own() {
    for estimator in estimators() {
        let all: Vec<_> = examples::of(estimator.info().id).collect();
        let mut ids: Vec<_> = all.iter().map(|example| example.id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all.len(), "{}", estimator.info().id);
        let first = all.first().unwrap_or_else(|| panic!("{} has no examples", estimator.info().id));
        assert!(!first.is_failure(), "{}: the first example is one where it works", estimator.info().id);
        let mut causes = all.iter().filter_map(|example| example.cause);
        let cause = causes.next();
        let is_other = |other| Some(other) != cause;
        assert!(causes.any(is_other), "{}: no two fail for different causes", estimator.info().id);
    }
}

/// The window finds the example that is open by what it sets.
#[test]
fn no_two_examples_of_an_estimator_set_the_same() {
    for estimator in estimators() {
        let id = estimator.info().id;
        let all: Vec<_> = examples::of(id).map(|example| (example.clip, &example.settings, example.frame)).collect();
        let is_repeated = |set: &&_| all.iter().filter(|other| other == set).count() > 1;
        assert_eq!(all.iter().find(is_repeated), None, "{id}");
    }
}

#[test]
fn every_file_of_examples_is_read() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/examples");
    let files = std::fs::read_dir(folder).expect("the folder of the examples");
    let texts = files.map(|file| std::fs::read_to_string(file.expect("a file").path()).expect("a text"));
    let count: usize = texts.map(|text| text.matches("[[example]]").count()).sum();
    assert_eq!(examples::examples().count(), count);
}

#[test]
fn examples_have_sentences_of_their_own() {
    let mut said: Vec<_> = examples::examples().map(|example| example.says).collect();
    let count = said.len();
    said.sort_unstable();
    said.dedup();
    assert_eq!(said.len(), count, "two examples say the same");
}
