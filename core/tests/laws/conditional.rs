//! Parameters that are said to have no effect have none.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::common::{Objects, waves};
use motionscope_core::base::Threads;
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Detection, Frame, ObjectBox};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::params::{Kind, Params, Spec, Value};
use motionscope_core::products::{BlockField, Reference};
use motionscope_core::run::AnyEstimator;
use motionscope_core::synth::{Difficulty, SCENES};

/// The size of a frame in px.
const SIZE: (usize, usize) = (48, 40);

/// Two boxes that pass over textured ground, with what a detector makes of them and the truth.
fn clip(frames: usize) -> Clip {
    let boxes = |t: usize| {
        let t = t as f32;
        [(1, 4.0 + 2.0 * t, 6.0), (2, 34.0 - 2.0 * t, 24.0)].map(|(id, x, y)| ObjectBox {
            id,
            x,
            y,
            width: 9.0,
            height: 9.0,
            visibility: 1.0,
        })
    };
    let frame = |t: usize| {
        let inside = |x: usize, y: usize| {
            let is_in = |b: &ObjectBox| {
                (b.x..b.x + b.width).contains(&(x as f32)) && (b.y..b.y + b.height).contains(&(y as f32))
            };
            boxes(t).iter().any(is_in)
        };
        Frame::rgb(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (u, v) = (x as f64, y as f64);
            let value = if inside(x, y) {
                waves(2.0 * u - 3.0 * t as f64, 2.0 * v)
            } else {
                0.5 * waves(u - 0.3 * t as f64, v)
            };
            [1.0, 0.9, 0.7].map(|tint| (tint * value).clamp(0.0, 255.0) as u8)
        }))
    };
    let detected = |object: &ObjectBox| {
        let bounds = Bounds::from(object);
        Detection { bounds, center: bounds.center(), score: 0.9, blob: None, deviation_px: None }
    };
    let clip = Clip::from_frames("boxes", (0..frames).map(frame).collect()).expect("frames of one size");
    let truth: Vec<_> = (0..frames).map(|t| boxes(t).to_vec()).collect();
    let detections = truth.iter().map(|all| all.iter().map(detected).collect()).collect();
    clip.with_detections(detections).with_truth(Arc::new(Objects(truth)))
}

/// A few other values of a parameter.
fn others(spec: &Spec) -> Vec<Value> {
    let kind = match &spec.kind {
        Kind::Optional { of, .. } => of,
        kind => kind,
    };
    let all = match kind {
        Kind::Int { min, max } => {
            let usual = if let Value::Int(usual) = spec.default { usual } else { *min };
            vec![Value::Int(*min), Value::Int((usual + 1).min(*max))]
        }
        Kind::Real { min, max } => {
            let usual = if let Value::Real(usual) = spec.default { usual } else { *min };
            vec![Value::Real(*min), Value::Real((usual + 0.25 * (max - min)).min(*max))]
        }
        Kind::Switch => [false, true].map(Value::Switch).into(),
        Kind::Choice(all) => all.iter().map(|choice| Value::Choice(choice.name)).collect(),
        Kind::Placed(figure) => vec![Value::Placed(figure.spanned([16.0, 12.0], [40.0, 30.0]))],
        Kind::Stage(kind) => kind.ids().iter().filter_map(|id| kind.parse(id).ok()).map(Value::Stage).collect(),
        Kind::Optional { .. } => Vec::new(),
    };
    let open = match spec.kind {
        Kind::Optional { word, .. } => Some(Value::Choice(word)),
        _ => None,
    };
    all.into_iter().chain(open).filter(|value| *value != spec.default).collect()
}

/// Those parameters without effect, with the reason.
fn idle(params: &(impl Params + ?Sized)) -> BTreeSet<(usize, &'static str)> {
    (0..params.specs().len()).filter_map(|index| params.idle(index).map(|why| (index, why))).collect()
}

/// Small, so that runs are short.
fn small(mut estimator: Box<dyn AnyEstimator>) -> Box<dyn AnyEstimator> {
    for (name, value) in
        [("block-size", "8"), ("search-range", "3"), ("levels", "2"), ("warps", "1"), ("iterations", "3")]
    {
        // Only where there is such a parameter.
        estimator.set(name, value).ok();
    }
    estimator
}

/// What a run comes to, NaN and all; a refusal as well.
fn outcome(estimator: &dyn AnyEstimator, clip: &Clip) -> String {
    let output = match estimator.run(clip, 0, &Threads::single()) {
        Ok(output) => output,
        Err(error) => return format!("refused: {error}"),
    };
    // The vectors of blocks carry how a prediction is made of them, which counts only as far as it changes that.
    let is_blocks = output.get::<BlockField>().is_some();
    let flow = output.flow().map(|flow| format!("{flow:?}"));
    let assessment = output.assess(&Reference { clip, frame: 0 });
    let whole = if is_blocks { String::new() } else { format!("{output:?}") };
    format!("{whole} {flow:?} {assessment:?}")
}

/// Those of `idle` that change the result, in words.
fn wrong(estimator: &dyn AnyEstimator, clip: &Clip, idle: impl Iterator<Item = (usize, &'static str)>) -> Vec<String> {
    let mut wrong = Vec::new();
    let before = outcome(estimator, clip);
    for (index, why) in idle {
        let spec = &estimator.specs()[index];
        for value in others(spec).into_iter().take(3) {
            let mut changed = estimator.boxed_clone();
            if changed.set_value(index, value.clone()).is_ok() {
                let id = estimator.info().id;
                if outcome(&*changed, clip) != before {
                    wrong.push(format!("{id}: {}={value} changes the result, although: {why}", spec.name));
                }
            }
        }
    }
    wrong
}

#[test]
fn what_is_said_to_have_no_effect_has_none_and_has_one_with_other_values() {
    let mut all = Vec::new();
    for estimator in estimators().into_iter().map(small) {
        let id = estimator.info().id;
        let by_frame = estimator.units_of(SIZE, 2) == Some(2) || estimator.is_by_frame();
        let clip = clip(if by_frame { 8 } else { 2 });
        let at_first = idle(&*estimator);
        all.extend(wrong(&*estimator, &clip, at_first.iter().copied()));
        let conditional = |index: &usize| estimator.specs()[*index].is_conditional();
        let mut never_active: BTreeSet<usize> = (0..estimator.specs().len()).filter(conditional).collect();
        never_active.retain(|index| at_first.iter().any(|(idle, _)| idle == index));
        let mut told: BTreeSet<&str> = at_first.iter().map(|(_, why)| *why).collect();
        for (index, spec) in estimator.specs().iter().enumerate() {
            for value in others(spec) {
                let mut changed = estimator.boxed_clone();
                if changed.set_value(index, value).is_err() {
                    continue;
                }
                let now = idle(&*changed);
                never_active.retain(|index| now.iter().any(|(idle, _)| idle == index));
                told.extend(now.iter().map(|(_, why)| *why));
                all.extend(wrong(&*changed, &clip, now.difference(&at_first).copied()));
            }
        }
        let names = |indices: BTreeSet<usize>| -> Vec<String> {
            indices.into_iter().map(|index| estimator.specs()[index].name.clone()).collect()
        };
        all.extend(names(never_active).into_iter().map(|name| format!("{id}: {name} never has an effect")));
        for (spec, why) in estimator.specs().iter().flat_map(|spec| spec.idle.iter().map(move |why| (spec, why))) {
            if !told.contains(why) {
                all.push(format!("{id}: {} is never idle because: {why}", spec.name));
            }
        }
    }
    assert!(all.is_empty(), "{all:#?}");
}

#[test]
fn sliders_of_a_clip_that_are_said_to_have_no_effect_have_none() {
    let mut usual = Difficulty { width: 64, height: 48, frames: 2, ..Difficulty::default() };
    let scene = &SCENES[0];
    let frames = |difficulty: &Difficulty| {
        let clip = scene.clip(difficulty).expect("a clip");
        [0, 1].map(|t| clip.frame(t).expect("a frame").luma().clone())
    };
    let before = frames(&usual);
    let idle = idle(&usual);
    assert!(!idle.is_empty());
    for (index, why) in idle {
        for value in others(&usual.specs()[index]) {
            let mut changed = usual.clone();
            changed.set_value(index, value).expect("in range");
            assert!(frames(&changed) == before, "{why}");
        }
    }
    usual.repeating_texture = 50.0;
    assert_eq!(usual.why_idle("period"), None);
}

#[test]
fn a_reason_is_a_sentence() {
    let difficulty = Difficulty::default();
    let all = estimators();
    let specs = all.iter().flat_map(|estimator| estimator.specs()).chain(difficulty.specs());
    for why in specs.flat_map(|spec| &spec.idle) {
        let is_sentence = why.ends_with('.') && why.starts_with(char::is_uppercase) && why.contains("no effect");
        assert!(is_sentence, "{why}");
    }
}

#[test]
fn the_first_parameters_are_not_all_advanced() {
    for estimator in estimators() {
        let specs = estimator.specs();
        assert!(specs.is_empty() || specs.iter().any(|spec| !spec.advanced), "{}", estimator.info().id);
    }
}
