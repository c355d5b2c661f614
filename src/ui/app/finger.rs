//! A finger on a screen: where it taps something that is only to be read, the pointer rests, so that the explanation of a value comes
//! as it does under a mouse.

use eframe::egui::{Context, Event, PointerButton, Pos2, RawInput, TouchPhase};

/// Seconds after a tap until the pointer stirs: one that has clicked and not moved since gets no explanations.
const REST_SECS: f64 = 0.15;

/// The last finger on the screen.
#[derive(Debug, Default)]
pub(super) struct Finger {
    /// Place and time of the lift, until the pointer has stirred there.
    lifted: Option<(Pos2, f64)>,
}

impl Finger {
    /// Changes the input of a frame that begins at the time `now`.
    pub fn rest(&mut self, ctx: &Context, input: &mut RawInput, now: f64) {
        let is_touched = |of: TouchPhase| {
            input.events.iter().any(|event| matches!(event, Event::Touch { phase, .. } if *phase == of))
        };
        if is_touched(TouchPhase::End) {
            if is_on_button(ctx) {
                self.lifted = None;
                return;
            }
            self.lifted = button_at(&input.events, false).map(|at| (at, now));
            input.events.retain(|event| *event != Event::PointerGone);
            return ctx.request_repaint();
        }
        if input.events.iter().any(|event| matches!(event, Event::Touch { .. } | Event::PointerMoved(_))) {
            self.lifted = None;
        }
        // A finger comes from nowhere: without a move the pointer would count as one that has rested there, and get an explanation.
        if let Some(at) = button_at(&input.events, true).filter(|_| is_touched(TouchPhase::Start)) {
            input.events.insert(0, Event::PointerMoved(at));
        }
        let Some((at, when)) = self.lifted else { return };
        let is_done = ctx.interaction_snapshot(|now| now.clicked.or(now.drag_stopped).is_some());
        if is_done {
            input.events.push(Event::PointerGone);
            self.lifted = None;
        } else if now - when < REST_SECS {
            ctx.request_repaint_after_secs((REST_SECS - (now - when)) as f32);
        } else {
            input.events.push(Event::PointerMoved(at));
            self.lifted = None;
        }
    }
}

/// The place at which the pointer is pressed, or let go.
fn button_at(events: &[Event], is_pressed: bool) -> Option<Pos2> {
    events.iter().find_map(|event| match event {
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, .. } => {
            Some(*pos).filter(|_| *pressed == is_pressed)
        }
        _ => None,
    })
}

/// Whether the finger rests on something that does what it says, and needs no explanation.
fn is_on_button(ctx: &Context) -> bool {
    let below = ctx.interaction_snapshot(|now| now.contains_pointer.clone());
    below.iter().any(|id| ctx.read_response(*id).is_some_and(|response| response.sense.senses_click()))
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Sense, TouchDeviceId, TouchId, Ui, pos2, vec2};

    use super::*;

    /// Whether the explanation of a value and that of a button are shown some time after a tap on either.
    fn explained(tapped: Pos2) -> [bool; 2] {
        let (ctx, mut finger, mut shown) = (Context::default(), Finger::default(), [false; 2]);
        let touch =
            |phase| Event::Touch { device_id: TouchDeviceId(0), id: TouchId(0), phase, pos: tapped, force: None };
        let button = |pressed| Event::PointerButton {
            pos: tapped,
            button: PointerButton::Primary,
            pressed,
            modifiers: Default::default(),
        };
        for frame in 0..40 {
            let now = 0.1 * f64::from(frame);
            let events = match frame {
                5 => vec![button(true), touch(TouchPhase::Start)],
                6 => vec![button(false), Event::PointerGone, touch(TouchPhase::End)],
                _ => Vec::new(),
            };
            let mut input = RawInput { time: Some(now), events, ..RawInput::default() };
            finger.rest(&ctx, &mut input, now);
            let draw = |ui: &mut Ui| {
                for (index, sense) in [Sense::hover(), Sense::click()].into_iter().enumerate() {
                    let (_, response) = ui.allocate_exact_size(vec2(100.0, 20.0), sense);
                    response.on_hover_ui(|_| shown[index] = true);
                }
            };
            ctx.run_ui(input, draw).textures_delta.clear();
        }
        shown
    }

    #[test]
    fn a_tap_explains_a_value_and_not_a_button() {
        assert_eq!(explained(pos2(20.0, 10.0)), [true, false]);
        assert_eq!(explained(pos2(20.0, 33.0)), [false, false]);
        assert_eq!(explained(pos2(500.0, 500.0)), [false, false]);
    }
}
