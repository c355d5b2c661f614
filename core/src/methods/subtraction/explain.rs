//! The steps of a background subtraction in values and words.

use std::sync::Arc;

use super::charts::plots;
use super::declare::line;
use super::explanation::{Cases, Probe, say};
use super::exposure::Transfer;
use super::mask_history::MaskHistory;
use super::vocabulary::{case, value};
use super::{Background, Conclusion, Event, Explanation, Initial, Past, Setup, State, Subtraction};
use crate::base::words::capital;
use crate::data::{Detection, Frame};
use crate::run::Seen;
use crate::scene::{Name, Readout, Step};

/// The line of pseudocode of an event.
pub(super) fn stage(event: &Event) -> Name {
    match event {
        Event::Begun(_) => line::BEGIN_MODEL,
        Event::Followed(..) => line::FOLLOW_CAMERA,
        Event::Exposed(..) => line::CORRECT_EXPOSURE,
        Event::Steadied(..) => line::SUPPRESS_SHAKE,
        Event::Registered(_) => line::REGISTER,
        Event::Compared(..) => line::COMPARE,
        Event::Decided(_) => line::DECIDE,
        Event::Shadows(..) => line::REMOVE_SHADOWS,
        Event::Opened(_) => line::OPEN,
        Event::Closed(_) => line::CLOSE,
        Event::Labelled(..) => line::LABEL,
        Event::Kept(_) => line::KEEP_BLOBS,
        Event::Updated(_) => line::UPDATE_MODEL,
    }
}

impl<M: Background> Subtraction<M> {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (state, history) = (seen.before, MaskHistory::new(seen.events));
        let Some(event) = seen.events.last() else {
            let against = if self.0.setup().initial.is_some() { case::AGAINST_MODEL } else { case::AGAINST_FRAME };
            return Step::at(line::BEGIN_MODEL).put(value::COMPARED, M::COMPARED).say(against);
        };
        let (mut step, mut cases) = (Step::at(stage(event)).fact(value::FRAME, state.frame), Vec::new());
        for end in 1..=seen.events.len() {
            (step, cases) = self.put_event(step, seen, &seen.events[..end]);
        }
        let place = history.frame().and_then(|frame| frame.luma().cell_at(seen.point()?));
        let Explanation { step, verdict, update } = match place {
            Some(place) => self.explain_pointed(step, seen, place),
            None => Explanation::of(step),
        };
        let step = match (event, place) {
            (Event::Updated(conclusion), _) => self.tell_update(step, seen, (conclusion, place.map(|_| update))),
            (Event::Begun(_) | Event::Exposed(..) | Event::Registered(_) | Event::Compared(..), _) | (_, None) => {
                say(step, &cases)
            }
            (_, Some(place)) => history.of_pixel(say(step.say(case::PIXEL), &verdict), place),
        };
        step.show_all(plots(&seen.after.unwrap_or(state).record, &state.span))
    }

    /// The model that the frame is compared with: that of the state before, shifted with the camera.
    pub(super) fn compared_model(&self, seen: &Seen<Self>) -> Option<Arc<M::Model>> {
        let (model, history) = (seen.before.model.as_ref()?, MaskHistory::new(seen.events));
        Some(match (history.shift(), history.frame()) {
            ([0.0, 0.0], _) | (_, None) => Arc::clone(model),
            (by, Some(frame)) => Arc::new(self.0.moved(model, by, frame)),
        })
    }

    /// The frames up to that of the step.
    pub(super) fn past(&self, seen: &Seen<Self>) -> Past {
        let now: &State<_> = seen.after.unwrap_or(seen.before);
        let at = now.camera.as_ref().map_or([0.0; 2], |camera| camera.model_at);
        let span = seen.before.span.until(seen.before.frame + 1);
        Past { clip: seen.clip.clone(), span, steady: self.0.setup().steady, at }
    }

    /// The explanation of a pixel, without charts that all models have.
    fn explained_at(&self, step: Step, seen: &Seen<Self>, (frame, place): (&Frame, (usize, usize))) -> Explanation {
        let Some(before) = self.compared_model(seen) else { return Explanation::of(step) };
        let after = seen.after.and_then(|after| after.model.as_deref());
        self.0.explain(step, &Probe { before: &before, after, frame, place })
    }

    fn explain_pointed(&self, step: Step, seen: &Seen<Self>, place: (usize, usize)) -> Explanation {
        let (step, history) = (step.fact(value::PIXEL, place), MaskHistory::new(seen.events));
        let step = step.fact_if(value::UNCORRECTED_LEVEL, history.exposed().map(|(frame, _)| frame.luma()[place]));
        let Some((model, frame)) = self.compared_model(seen).zip(history.frame()) else { return Explanation::of(step) };
        let Explanation { step, verdict, update } = self.explained_at(step, seen, (frame, place));
        let step = step.show(Readout::Tiles(self.tiles(&model, frame, place)));
        let plots = super::history::plots(&self.0, (seen.clip, seen.before), (&*model, &**frame), place);
        Explanation { step: step.show_all(plots), verdict, update }
    }

    /// Puts the values of the last of some events; returns with them the cases that tell it.
    fn put_event(&self, step: Step, seen: &Seen<Self>, events: &[Event]) -> (Step, Cases) {
        let (Setup { settings, initial, steady }, state) = (self.0.setup(), seen.before);
        let [gone, new] = MaskHistory::new(events)
            .change()
            .map_or([0, 0], |[before, after]| [before.without(after).count(), after.without(before).count()]);
        let Some(event) = events.last() else { return (step, Vec::new()) };
        match event {
            Event::Begun(_) => {
                let last = state.frame + state.span.frames().unwrap_or(1) - 1;
                let begun = match initial {
                    None => case::REFERENCE,
                    Some(Initial::FirstFrame) => case::FIRST_FRAME,
                    Some(Initial::Median) => case::MEDIAN,
                };
                (step.put(value::NEXT_FRAME, state.frame + 1).put(value::LAST_FRAME, last), vec![begun])
            }
            Event::Followed(by, at) => {
                let end = if M::IS_REPLACED { case::END } else { case::IN_WHOLE_PX };
                (step.fact(value::CAMERA, *at).put(value::SHIFT, *by), vec![case::FOLLOWED, end])
            }
            Event::Exposed(_, transfer) => put_exposure(step, transfer),
            Event::Registered(frame) => match &state.model {
                Some(model) => self.0.comparison(step, model, frame),
                None => (step, Vec::new()),
            },
            Event::Compared(..) => {
                (step.put(value::COMPARED, capital(M::COMPARED)).put(value::SHOWN, M::SHOWN), vec![case::COMPARED])
            }
            Event::Decided(mask) => {
                let share = mask.count() as f64 / (mask.width() * mask.height()).max(1) as f64;
                let step = step.fact(value::FOREGROUND, mask.count()).put(value::FOREGROUND_SHARE, 100.0 * share);
                let (step, mut rule) = self.0.rule(step);
                rule.insert(0, case::DECIDED);
                (step, rule)
            }
            Event::Shadows(_, shadows) => (step.fact(value::SHADOWS, shadows.count()), vec![case::SHADOWS]),
            Event::Steadied(_, displaced) => {
                let shake = steady.map_or(0, |steady| steady.shake);
                (step.fact(value::DISPLACED, displaced.count()).put(value::SHAKE, shake), vec![case::DISPLACED])
            }
            Event::Opened(mask) => {
                let opened = match (settings.opening, settings.area_opening) {
                    (0, _) => case::AREA_OPENED,
                    (_, 0 | 1) => case::OPENED,
                    _ => case::BOTH_OPENED,
                };
                let step = step.put(value::SIDE, 2 * settings.opening + 1).put(value::REMOVED, gone);
                let step = step.put(value::LEAST_COMPONENT, settings.area_opening);
                (step.fact(value::AFTER_OPENING, mask.count()), vec![opened])
            }
            Event::Closed(mask) => {
                let step = step.put(value::SIDE, 2 * settings.closing + 1).put(value::FILLED, new);
                (step.fact(value::AFTER_CLOSING, mask.count()), vec![case::CLOSED])
            }
            Event::Labelled(_, count) => {
                let step = step.put(value::CONNECTIVITY, settings.connectivity.label());
                (step.fact(value::COMPONENTS, *count), vec![case::LABELLED])
            }
            Event::Kept(blobs) => (put_blobs(step, blobs, settings.least_area(state.picture)), vec![case::KEPT]),
            Event::Updated(_) => (step, Vec::new()),
        }
    }

    /// Tells the update of the model at the pixel that is pointed at, else at that of the largest difference, and the conclusion. The end of
    /// a run with ground truth is about its result alone, unless a pixel is pointed at.
    fn tell_update(&self, step: Step, seen: &Seen<Self>, (conclusion, pointed): (&Conclusion, Option<Cases>)) -> Step {
        let compared = seen.events.iter().find_map(|event| match event {
            Event::Compared(frame, difference) => Some((frame, difference)),
            _ => None,
        });
        let Some((frame, difference)) = compared else { return step };
        let step = match pointed {
            Some(update) => say(step.say(case::UPDATE), &update),
            None if conclusion.run.is_some() => step,
            None => {
                let (width, cells) = (difference.width().max(1), difference.cells().iter().enumerate());
                let known = cells.filter(|(_, value)| !value.is_nan());
                let largest = known.reduce(|a, b| if b.1 > a.1 { b } else { a }).map_or(0, |(index, _)| index);
                let place = (largest % width, largest / width);
                // Its numbers are no facts of the frame.
                let Explanation { step: at, update, .. } = self.explained_at(Step::at(step.line), seen, (frame, place));
                let step = at.values.into_iter().fold(step.put(value::PIXEL, place), Step::put_value);
                say(step.say(case::LARGEST_UPDATE), &update)
            }
        };
        conclusion.tell(step, M::FLOODED)
    }
}

/// Puts the components of at least the minimum area, and the number of the others.
pub(crate) fn put_blobs(step: Step, [kept, dropped]: &[Vec<Detection>; 2], least_area: usize) -> Step {
    let step = step.fact(value::BLOBS, kept.len()).put(value::SMALL_COMPONENTS, dropped.len());
    step.put(value::LEAST_AREA, least_area)
}

/// Puts a change of the exposure; returns with it the cases that tell it.
fn put_exposure(step: Step, transfer: &Transfer) -> (Step, Cases) {
    let [dark, bright] = [64.0, 192.0].map(|level| transfer.change(level));
    let step = step.fact(value::EXPOSURE_CHANGE, transfer.median).put(value::EXPOSURE_SIZE, transfer.median.abs());
    let step = step.put(value::DARK_CHANGE, dark).put(value::BRIGHT_CHANGE, bright);
    let mut cases = vec![if transfer.median > 0.0 { case::BRIGHTER } else { case::DARKER }];
    // They are told if they differ.
    cases.extend(((dark - bright).abs() >= 1.0).then_some(case::BY_LEVEL));
    cases.push(case::CORRECTED);
    (step, cases)
}
