//! The masks and components of a frame up to a step.

use std::sync::Arc;

use super::Event;
use super::exposure::Transfer;
use super::vocabulary::{case, value};
use crate::data::{Detection, Frame, Mask};
use crate::scene::Step;

/// The masks and components of a frame up to a step.
pub(crate) struct MaskHistory<'a> {
    pub(super) events: &'a [Event],
}

impl<'a> MaskHistory<'a> {
    pub(crate) fn new(events: &'a [Event]) -> Self {
        Self { events }
    }

    pub(super) fn frame(&self) -> Option<&'a Arc<Frame>> {
        self.events.iter().find_map(|event| match event {
            Event::Begun(frame) | Event::Registered(frame) | Event::Compared(frame, _) => Some(frame),
            _ => None,
        })
    }

    /// The frame before its exposure was corrected, and the transfer to it.
    pub(super) fn exposed(&self) -> Option<(&'a Frame, &'a Transfer)> {
        self.events.iter().find_map(|event| match event {
            Event::Exposed(frame, transfer) => Some((&**frame, &**transfer)),
            _ => None,
        })
    }

    /// The shift of the model with the camera in px.
    pub(super) fn shift(&self) -> [f32; 2] {
        let by = self.events.iter().find_map(|event| if let Event::Followed(by, _) = event { Some(*by) } else { None });
        by.unwrap_or_default()
    }

    pub(super) fn masks(&self) -> impl DoubleEndedIterator<Item = &'a Arc<Mask>> {
        self.events.iter().filter_map(masked)
    }

    /// The last mask and the one before it, that one first.
    pub(super) fn change(&self) -> Option<[&'a Arc<Mask>; 2]> {
        let mut masks = self.masks().rev();
        let after = masks.next()?;
        Some([masks.next()?, after])
    }

    pub(super) fn kept(&self) -> Option<&'a [Vec<Detection>; 2]> {
        self.events.iter().find_map(|event| if let Event::Kept(blobs) = event { Some(&**blobs) } else { None })
    }

    /// Tells the effect of each stage after the threshold on a pixel, and that of the last stage in any case.
    pub(super) fn of_pixel(&self, mut step: Step, (x, y): (usize, usize)) -> Step {
        let mut was_set = false;
        for (i, event) in self.events.iter().enumerate() {
            let is_last = i + 1 == self.events.len();
            step = match event {
                Event::Shadows(_, shadows) if shadows.get(x, y) => step.say(case::IS_SHADOW),
                Event::Shadows(..) => step.say_if(is_last, case::NO_SHADOW),
                Event::Steadied(_, displaced) if displaced.get(x, y) => step.say(case::IS_DISPLACED),
                Event::Steadied(..) => {
                    step.say_if(is_last, if was_set { case::NOT_DISPLACED } else { case::SHAKE_KEEPS })
                }
                Event::Opened(mask) if was_set && !mask.get(x, y) => step.say(case::OPENING_REMOVES),
                Event::Opened(_) => step.say_if(is_last, case::OPENING_KEEPS),
                Event::Closed(mask) if !was_set && mask.get(x, y) => step.say(case::CLOSING_FILLS),
                Event::Closed(_) => step.say_if(is_last, case::CLOSING_KEEPS),
                Event::Labelled(labels, _) if labels[(x, y)] > 0 => {
                    let component = labels[(x, y)];
                    let is_small = self.kept().map(|[_, dropped]| dropped.iter().any(|d| label(d) == component));
                    let becomes = is_small.map_or(case::END, |is| if is { case::TOO_SMALL } else { case::IS_BLOB });
                    step.put(value::COMPONENT, component).say(case::IN_COMPONENT).say(becomes)
                }
                Event::Labelled(..) => step.say_if(is_last, case::NO_COMPONENT),
                Event::Kept(_) => step.say_if(is_last && !was_set, case::NO_BLOB),
                _ => step,
            };
            was_set = masked(event).map_or(was_set, |mask| mask.get(x, y));
        }
        step
    }
}

fn masked(event: &Event) -> Option<&Arc<Mask>> {
    match event {
        Event::Decided(mask)
        | Event::Shadows(mask, _)
        | Event::Steadied(mask, _)
        | Event::Opened(mask)
        | Event::Closed(mask) => Some(mask),
        _ => None,
    }
}

fn label(detection: &Detection) -> u32 {
    detection.blob.map_or(0, |blob| blob.label)
}
