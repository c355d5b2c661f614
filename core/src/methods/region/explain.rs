//! The explanation that all trackers of a region share: the start, and the result of a frame.

use super::ending::{FAIR, GROWN};
use super::regained::Regained;
use super::start::Origin;
use super::vocabulary::{case, value};
use super::{At, Event, Explained, RegionTracking, State, line, plots};
use crate::data::Clip;
use crate::products::region::{RegionError, Sight, area_ratio, covered, success};
use crate::products::{Region, RegionFrame};
use crate::run::Seen;
use crate::scene::{Case, Name, Picture, Readout, Role, Scene, Series, Shape, Step, Unit, Variable};

/// The longest path that is drawn, in frames.
const TRAIL_FRAMES: usize = 30;

impl<T: Explained> RegionTracking<T> {
    /// The similarity by which the tracker judges its match.
    const SIMILARITY: &'static Variable =
        &Variable { label: T::SIMILARITY.label, unit: Self::UNIT, ..*value::SIMILARITY };
    pub(super) const UNIT: Unit = Unit::new("", T::SIMILARITY.decimals as u8);

    pub(super) fn line_of(&self, event: &Event<T::Event>) -> Name {
        match event {
            Event::Chosen | Event::Refused => line::CHOOSE,
            Event::Waiting => line::EACH_FRAME,
            Event::Own(event) => self.0.line(event),
            Event::Moved(_) => line::MOVE,
        }
    }

    /// The run at the last event of the tracker in the frame.
    fn at_last<'a>(seen: &'a Seen<'_, Self>) -> Option<At<'a, T>> {
        let own = |event: &'a Event<T::Event>| match event {
            Event::Own(event) => Some(event),
            _ => None,
        };
        let events: Vec<_> = seen.events.iter().filter_map(own).collect();
        let event = *events.last()?;
        let state = seen.before;
        let (truth, first) = (state.chosen.object.zip(seen.clip.truth()), state.span.first);
        let poses = move |index| truth.and_then(|(object, truth)| truth.pose(object, first + index).ok().flatten());
        let (pose, poses) = (poses(state.past.len()), Box::new(poses));
        Some(At { model: state.model.as_deref(), region: state.region, events, event, pose, poses })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let Some(event) = seen.events.last() else {
            let step = Step::at(line::EACH_FRAME).put(value::ESTIMATOR, T::INFO.name);
            return self.0.open(step.put(value::FRAMES, self.0.settings().frames));
        };
        let step = Step::at(self.line_of(event)).fact(value::FRAME, state.frame);
        let step = match event {
            Event::Moved(result) => put_region(step, &result.region, Role::Estimate),
            _ => put_region(step, &state.region, Role::Reference),
        };
        let step = match event {
            Event::Chosen => chosen(state, step),
            Event::Refused => match state.refusal.as_deref() {
                Some((why, values)) => {
                    let step = values.iter().cloned().fold(step.say(case::REFUSED), Step::put_value);
                    step.say(why).say(case::RUN_ENDS)
                }
                None => step,
            },
            Event::Waiting => step.say(case::WAITING),
            Event::Own(_) => Self::with_last(seen, step, |at, step| self.0.step(at, step)),
            Event::Moved(result) => self.tell_result(seen, result, step),
        };
        step.show_all(self.histories(seen, matches!(event, Event::Moved(_))).into_iter().map(Readout::Series))
    }

    /// The result of a frame, after the last one with the conclusion of the run.
    fn tell_result(&self, seen: &Seen<Self>, result: &RegionFrame, step: Step) -> Step {
        let step = step.put(value::MEASURE, T::SIMILARITY.name).put(value::MEASURE_LABEL, T::SIMILARITY.label);
        let step = step.put(value::LOOKALIKE, T::SIMILARITY.shared_by).fact(Self::SIMILARITY, result.similarity);
        let step = match error_of_last(seen) {
            Some(error) => step.fact(value::OVERLAP, error.overlap).fact(value::CENTER_ERROR, error.center_px),
            None => step,
        };
        match seen.after.filter(|after| is_over(seen.clip, after)) {
            Some(after) => self.conclude((seen, after), result, step),
            None => self.tell_motion(seen, result, step),
        }
    }

    /// The result of a frame, beside the truth where that is known.
    fn tell_motion(&self, seen: &Seen<Self>, result: &RegionFrame, step: Step) -> Step {
        let (state, error) = (seen.before, error_of_last(seen));
        let step = if result.is_lost {
            Self::with_last(seen, step.say(case::LOST), |at, step| self.0.tell_loss(at, step)).say(case::STAYS)
        } else {
            let motion = [0, 1].map(|i| result.region.center[i] - state.region.center[i]);
            let step = step.put(value::MOTION, motion).say(case::MOVED);
            let step = step.say_if(is_turned(&result.region), case::TURNED).say(case::MEASURED);
            let step = match Regained::of(&state.past, result) {
                Some(regained) => regained.tell(step, Self::UNIT, error.is_some()),
                None => step,
            };
            Self::with_last(seen, step, |at, step| self.0.tell_caveat(at, step))
        };
        match (error.as_ref(), sight(seen)) {
            (Some(error), _) => match verdict(error) {
                Some(verdict) => {
                    let limit = if error.overlap == 0.0 { case::NO_OVERLAP } else { case::BELOW_FAIR };
                    put_verdict(step.say(case::OVERLAP), error).say(limit).say(verdict)
                }
                None => step.say(case::OVERLAP),
            }
            .say(case::CENTER_ERROR),
            (None, Some(Sight::Hidden)) => step.say(case::FRAME_HIDDEN),
            (None, Some(Sight::Absent)) => step.say(case::FRAME_ABSENT),
            (None, Some(Sight::Seen(_)) | None) => step,
        }
    }

    /// Adds the tracker's explanation of its last event of the frame, if it has one.
    pub(super) fn with_last(seen: &Seen<Self>, step: Step, tell: impl FnOnce(&At<'_, T>, Step) -> Step) -> Step {
        match Self::at_last(seen) {
            Some(at) => tell(&at, step),
            None => step,
        }
    }

    /// The similarity and the overlap over the frames; at the end of the run the success curve too.
    fn histories(&self, seen: &Seen<Self>, is_result: bool) -> Vec<Series> {
        let state = seen.after.filter(|_| is_result).unwrap_or(seen.before);
        if state.past.len() < 2 {
            return Vec::new();
        }
        let first = state.span.first;
        let x_max = first + state.span.frames().map_or(state.past.len(), |frames| frames - 1);
        let over = |title, y_label, lines| Series::new(title, ["frame", y_label], x_max, lines);
        let line = state.past.iter().enumerate().map(|(i, frame)| [(first + i) as f32, frame.similarity]);
        let mut all = vec![over(
            T::SIMILARITY.label,
            T::SIMILARITY.symbol,
            vec![(T::SIMILARITY.symbol, Role::Estimate, line.collect())],
        )];
        let errors = errors(seen.clip, state);
        if !errors.is_empty() {
            let line = errors.iter().map(|error| [error.frame as f32, error.overlap as f32]).collect();
            all.push(over("Overlap with the true box", "IoU", vec![("IoU", Role::Truth, line)]));
        }
        if is_result && !errors.is_empty() && is_over(seen.clip, state) {
            let curve = success(&errors).into_iter().map(|point| point.map(|c| c as f32)).collect();
            all.insert(0, plots::curve("Success", ["overlap threshold", "share of frames"], ("success", curve)));
        }
        all
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let path: Vec<_> = state.past.iter().map(|frame| frame.region.center).collect();
        let path = &path[path.len().saturating_sub(TRAIL_FRAMES)..];
        if path.len() > 1 {
            let shape = Shape::line(path.to_vec());
            scene.draw(Picture::CURRENT, (Role::Result, "path of the region"), shape);
        }
        let is_first = state.model.is_none();
        let model = state.model.as_deref().or(seen.after.and_then(|after| after.model.as_deref()));
        scene.work = model.and_then(|model| self.0.work(model)).map(|bounds| [bounds.min, bounds.max]);
        outline(scene, Role::Reference, state.region);
        scene.legend(Role::Reference, if is_first { "region of the object" } else { "region of frame t−1" });
        let last = seen.events.last();
        if let Some(at) = Self::at_last(seen).filter(|_| matches!(last, Some(Event::Own(_)))) {
            self.0.draw(&at, scene);
        }
        let Some(Event::Moved(result)) = last else { return };
        let (role, meaning) = if result.is_lost { (Role::Error, "object lost") } else { (Role::Estimate, "region") };
        outline(scene, role, result.region);
        scene.legend(role, meaning);
        if let Some(model) = seen.after.and_then(|after| after.model.as_deref()) {
            self.0.draw_result(model, scene);
        }
        if let Some(RegionError { truth, .. }) = error_of_last(seen) {
            scene.draw(Picture::CURRENT, (Role::Truth, "true box"), Shape::Rect { min: truth.min, max: truth.max });
        }
    }
}

/// Whether a run has no more frames.
fn is_over<M>(clip: &Clip, state: &State<M>) -> bool {
    state.span.is_over(clip, state.frame)
}

/// The errors of all frames so far, where the truth is known.
pub(super) fn errors<M>(clip: &Clip, state: &State<M>) -> Vec<RegionError> {
    state.field().errors(clip).unwrap_or_default()
}

/// The error of the frame that has just ended, where the truth is known.
fn error_of_last<T: Explained>(seen: &Seen<RegionTracking<T>>) -> Option<RegionError> {
    let after = seen.after?;
    after.field().error_of(seen.clip, after.past.len().checked_sub(1)?).ok().flatten()
}

/// The visibility of the object by the ground truth in the frame that has just ended.
fn sight<T: Explained>(seen: &Seen<RegionTracking<T>>) -> Option<Sight> {
    let after = seen.after?;
    after.field().sight(seen.clip, after.past.len().checked_sub(1)?).ok().flatten()
}

/// The kind of error of a region with an overlap below 0.5.
pub(super) fn verdict(error: &RegionError) -> Option<&'static Case> {
    match error.overlap {
        0.0 => Some(case::NOT_ON),
        0.0..FAIR if area_ratio(error) >= GROWN => Some(case::TOO_LARGE),
        0.0..FAIR => Some(case::COVERS),
        _ => None,
    }
}

pub(super) fn put_verdict(step: Step, error: &RegionError) -> Step {
    let step = step.put(value::FAIR, FAIR).put(value::TIMES_AS_LARGE, area_ratio(error));
    step.put(value::COVERED, 100.0 * covered(error))
}

/// Whether the angle of a region is more than none in whole degrees.
fn is_turned(region: &Region) -> bool {
    region.angle_rad.to_degrees().abs() > 0.5
}

/// Adds the place, the size and the angle of a region, in the colour of `role`.
fn put_region(step: Step, region: &Region, role: Role) -> Step {
    let [width, height] = region.size;
    let step = step.put(value::WIDTH, width).put(value::HEIGHT, height);
    let step = step.put(value::ANGLE, region.angle_rad.to_degrees());
    let told = if is_turned(region) { case::REGION_TURNED } else { case::REGION };
    step.fact_as(value::PLACE.is(region.center).inked(role), told)
}

fn chosen<M>(state: &State<M>, step: Step) -> Step {
    if !state.past.is_empty() {
        return step.put(value::RESTART, state.restarts.count + 1).say(case::RESTART);
    }
    step.say(case::CHOSEN).say(match state.chosen.origin {
        Origin::Placed => case::PLACED,
        Origin::Truth => case::OF_TRUTH,
        Origin::Middle => case::IN_MIDDLE,
    })
}

/// Draws the outline of a region: a box, or an ellipse if it is turned.
pub(super) fn outline(scene: &mut Scene, role: Role, region: Region) {
    let shape = if region.angle_rad == 0.0 {
        let bounds = region.bounds();
        Shape::Rect { min: bounds.min, max: bounds.max }
    } else {
        let radii = region.size.map(|side| side / 2.0);
        Shape::Ellipse { center: region.center, radii, angle_rad: region.angle_rad }
    };
    scene.mark(Picture::CURRENT, role, shape);
}
