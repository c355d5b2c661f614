//! Opening a stage: stepping through it by itself, on the frames of its parent.

use super::super::{AnyEstimator, Cursor};
use super::chosen::{self, FRAMES};
use super::estimator_of;
use crate::base::Error;
use crate::data::Clip;
use crate::params::{Kind, Value};

/// A stage opened by itself: its estimator, its frame, and the position of its parent in that run.
pub struct Opened {
    /// The estimator that works as the stage.
    pub estimator: Box<dyn AnyEstimator>,
    /// The clip that it looks at, where that is not the one that its parent goes through.
    pub clip: Option<Clip>,
    /// The frame that its run begins on.
    pub frame: usize,
    /// Its place while the parent is at work.
    pub cursor: Cursor,
}

/// Opens the stage that is parameter `index` of `parent`, whose run on `clip` began on frame `first` and works on frame `now`.
///
/// A stage that goes through the clip begins where its parent began, or later if it depends on few earlier frames
/// ([`AnyEstimator::earlier_frames`]), and stands at the end of the current frame; one that looks at a pair runs on the pair that its
/// parent looks at, from its start. `None` if that parameter is no stage.
///
/// # Errors
/// If a frame cannot be read.
pub fn open(
    parent: &dyn AnyEstimator,
    index: usize,
    clip: &Clip,
    (first, now): (usize, usize),
) -> Result<Option<Opened>, Error> {
    let Some(mut estimator) = stage_of(parent, index) else { return Ok(None) };
    let begin = estimator.earlier_frames().map_or(first, |earlier| first.max(now.saturating_sub(earlier)));
    let units = estimator.units_of(clip.size(), now.saturating_sub(begin) + 1);
    let view = if units.is_some() { None } else { parent.stage_view(clip, now)? };
    // Parameters decided by the parent keep the parent's values.
    let given = |name: &str| {
        let set = view.iter().flat_map(|view| &view.set).find(|(other, _)| *other == name);
        set.map(|(_, value)| value.clone()).or_else(|| parent.get(name).ok())
    };
    for &name in decided_by(parent, index) {
        if let Some(value) = given(name)
            && let Some(own) = estimator.specs().iter().position(|spec| spec.name == name)
        {
            // A parent that may see more than its stage is cut there.
            estimator.set_value(own, value).ok();
        }
        if name == FRAMES {
            end_alike(&mut *estimator, begin - first)?;
        }
    }
    Ok(Some(match (units, view) {
        (Some(units), _) => {
            let cursor = Cursor { unit: units - 1, event: usize::MAX };
            Opened { estimator, clip: None, frame: begin, cursor }
        }
        (None, Some(view)) => Opened { estimator, clip: Some(view.clip), frame: 0, cursor: Cursor::default() },
        (None, None) => Opened { estimator, clip: None, frame: now, cursor: Cursor::default() },
    }))
}

/// Shortens a run by the frames by which it begins later.
fn end_alike(estimator: &mut dyn AnyEstimator, later: usize) -> Result<(), Error> {
    match estimator.get(FRAMES) {
        Ok(Value::Int(frames)) if later > 0 => estimator.set(FRAMES, &(frames - later as i64).max(2).to_string()),
        _ => Ok(()),
    }
}

/// The estimator that is parameter `index` of `parent`.
fn stage_of(parent: &dyn AnyEstimator, index: usize) -> Option<Box<dyn AnyEstimator>> {
    parent.specs().get(index)?;
    let Value::Stage(value) = parent.value(index) else { return None };
    estimator_of(&value).map(AnyEstimator::boxed_clone)
}

fn decided_by(parent: &dyn AnyEstimator, index: usize) -> &'static [&'static str] {
    match parent.value(index) {
        Value::Stage(value) => chosen::decided(&value),
        _ => &[],
    }
}

/// The stages of `estimator`: the indices of its parameters that are such.
pub fn stages(estimator: &dyn AnyEstimator) -> Vec<usize> {
    let specs = estimator.specs().iter().enumerate();
    specs.filter(|(_, spec)| matches!(spec.kind, Kind::Stage(_))).map(|(index, _)| index).collect()
}
