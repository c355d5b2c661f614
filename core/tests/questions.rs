//! What questions hold to be true, against the results of whole runs.

mod common;

use common::set;
use motionscope_core::scene::{Answer, Picture, Question, Scene, Shown, asked};
use motionscope_core::{
    AnyEstimator, BlockField, Clip, Direction, Move, Params as _, RegionField, Step, Threads, estimators, synth,
};

/// A bundled scene, of the first `frames` frames where it has such a slider.
fn scene(id: &str, frames: &str) -> Clip {
    let scene = synth::scene(id).expect("it is bundled");
    let mut small = scene.difficulty();
    // Not every scene has as many frames as one likes.
    let _ = small.set("frames", frames);
    synth::make(id, &small).expect("a clip")
}

/// What is asked when a run is walked unit by unit: the step that is asked about, the question and its answer.
fn by_unit(estimator: &dyn AnyEstimator, clip: &Clip) -> Vec<(Step, &'static Question, Answer)> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let unit = walk.info().granularities.len() - 2;
    let look = |walk: &dyn motionscope_core::Walk| -> (Step, Scene) { (walk.step(None), walk.scene(None)) };
    let (mut before, mut all) = (look(&*walk), Vec::new());
    while !walk.at_end() {
        walk.jump(Move::Granularity(unit, Direction::Forward));
        let after = look(&*walk);
        let [shown, next] = [&before, &after].map(|(step, scene)| Shown { step, scene });
        if let Some((question, answer)) = asked(estimator.questions(), shown, next, walk.cursor().unit) {
            all.push((after.0.clone(), question, answer));
        }
        before = after;
    }
    all
}

fn place(answer: &Answer) -> (Picture, [f32; 2]) {
    let Answer::Place { on, at, .. } = answer else { panic!("{answer:?} is no place") };
    assert_eq!(at.len(), 1, "one place");
    (*on, at[0])
}

#[test]
fn the_place_of_a_match_is_that_of_the_motion_vector() {
    let clip = scene("pillar", "2");
    for id in ["full-search", "diamond", "three-step"] {
        let estimator = set(id, &[]);
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        let field = output.get::<BlockField>().expect("block vectors");
        let asked: Vec<_> = by_unit(&*estimator, &clip);
        let matches = asked.iter().filter(|(_, question, _)| question.id == "match");
        let mut count = 0;
        for (step, _, answer) in matches {
            // Block n of the sentence is the n-th of the result.
            let number = common::numbers(&step.sentence.plain())[0] as usize - 1;
            let (block, vector) = (field.blocks.block(number), field.vectors[number].expect("a vector"));
            let middle = [(block.x, block.width), (block.y, block.height)]
                .map(|(at, side)| at as f32 + (side as f32 - 1.0) / 2.0);
            let expected = [0, 1].map(|i| middle[i] + vector.displacement[i]);
            assert_eq!(place(answer), (Picture::NEXT, expected), "{id}, block {number}");
            count += 1;
        }
        assert!(count * 10 > field.vectors.len() * 9, "{id}: asked of {count} of {} blocks", field.vectors.len());
    }
}

#[test]
fn the_place_of_an_object_is_that_of_its_region() {
    let clip = scene("tunnel", "12");
    for id in ["mean-shift", "correlation-filter", "template-tracker"] {
        let estimator = set(id, &[]);
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        let field = output.get::<RegionField>().expect("a region");
        let asked = by_unit(&*estimator, &clip);
        let places: Vec<_> = asked.iter().filter(|(_, question, _)| question.id == "where").collect();
        let mut compared = 0;
        for (step, _, answer) in places {
            let said = step.sentence.plain();
            // At its end a run sums up instead.
            let Some(frame) = said.strip_prefix("Frame ").map(|_| common::numbers(&said)[0] as usize) else { continue };
            compared += 1;
            let center = field.frames[frame - field.first].region.center;
            let (_, at) = place(answer);
            let off = (at[0] - center[0]).hypot(at[1] - center[1]);
            assert!(off < 0.01, "{id}, frame {frame}: {at:?} and {center:?}");
        }
        assert!(compared > 2, "{id}: compared {compared} times");
    }
}

#[test]
fn every_question_has_a_different_text() {
    for estimator in estimators() {
        let mut texts: Vec<_> = estimator.questions().iter().map(|question| question.text).collect();
        let all = texts.len();
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(texts.len(), all, "{}", estimator.info().id);
    }
}
