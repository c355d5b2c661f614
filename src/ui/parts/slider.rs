//! A slim slider as wide as its pane: drag, click, arrow up and down, or a screen reader's actions.

use eframe::egui::accesskit::{Action, ActionData};
use eframe::egui::{self, Key, Modifiers, Response, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::paint::Theme;
use crate::ui::drawing::style;

/// What a slider sets.
pub struct Slider<'a> {
    /// Its name, for a screen reader.
    pub name: &'a str,
    /// The smallest and the largest value.
    pub range: (f64, f64),
    /// From one value to the next.
    pub step: f64,
    /// Where a mark says that the value is as it was at first.
    pub default: Option<f64>,
    /// The look.
    pub theme: Theme,
}

impl Slider<'_> {
    /// Shows the slider; `value` changes with it, and stays exactly as it is unless the person moves the slider.
    pub fn show(&self, ui: &mut Ui, value: &mut f64) -> Response {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let height = (1.1 * size).round();
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click_and_drag());
        let radius = (0.42 * size).round();
        let (left, right) = (rect.left() + radius, rect.right() - radius);
        let scale = Scale { range: self.range, step: self.step };
        let curve = self.curve();
        // The last move, or press and release, may come in one slow frame.
        let held = response.is_pointer_button_down_on() || response.drag_stopped() || response.clicked();
        let pointed = response.interact_pointer_pos().filter(|_| held);
        let pointed = pointed
            .map(|at| curve.value(egui::remap_clamp(f64::from(at.x), f64::from(left)..=f64::from(right), 0.0..=1.0)));
        if let Some(wanted) = pointed.or_else(|| scale.asked(ui, &response, *value)) {
            *value = scale.nearest(wanted);
        }
        let shown = *value;
        response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), shown, self.name));
        scale.describe(ui, &response, shown);
        let x_of = |value: f64| egui::lerp(f64::from(left)..=f64::from(right), curve.share(value)) as f32;
        self.paint(ui, &response, x_of(shown), self.default.map(x_of), radius);
        response
    }

    /// Even, unless the usual value lies so far down in a wide range that nobody could set what is near it.
    fn curve(&self) -> Curve {
        let (min, max) = self.range;
        let steps = (max - min) / self.step;
        let usual = self.default.map_or(1.0, |default| (default - min) / (max - min));
        let exponent = match usual {
            _ if steps < FEW_STEPS || usual >= LOW => 1.0,
            _ if usual <= 0.0 => MOST_BENT,
            _ => (usual.ln() / COMFORTABLE.ln()).min(MOST_BENT),
        };
        Curve { range: self.range, exponent }
    }

    fn paint(&self, ui: &Ui, response: &Response, x: f32, default: Option<f32>, radius: f32) {
        let chrome = self.theme.chrome();
        let painter = ui.painter();
        let rect = response.rect;
        let thickness = (radius * 0.6).max(3.0).round();
        let rail = egui::Rect::from_center_size(rect.center(), vec2(rect.width(), thickness));
        painter.rect_filled(rail, thickness / 2.0, style::color(chrome.hovered));
        let done = style::color(chrome.accent.mix(chrome.panel, 0.3));
        painter.rect_filled(rail.with_max_x(x), thickness / 2.0, done);
        if let Some(at) = default.filter(|at| (at - x).abs() > radius) {
            painter.circle_filled(pos2(at, rect.center().y), thickness * 0.8, style::color(chrome.dim));
        }
        let lit = response.hovered() || response.dragged() || response.has_focus();
        let radius = if lit { radius } else { radius - 1.0 };
        let ring = Stroke::new(2.0, style::color(chrome.panel));
        painter.circle(pos2(x, rect.center().y), radius, style::color(chrome.accent), ring);
    }
}

/// A range of fewer steps can be set anywhere.
const FEW_STEPS: f64 = 200.0;
/// A usual value in a lower share of its range is moved up to a comfortable one.
const LOW: f64 = 0.12;
const COMFORTABLE: f64 = 0.3;
/// The largest exponent.
const MOST_BENT: f64 = 4.0;

/// Which value lies where on a slider: `min + (max - min) share^exponent`.
#[derive(Clone, Copy)]
struct Curve {
    range: (f64, f64),
    exponent: f64,
}

impl Curve {
    fn value(self, share: f64) -> f64 {
        let (min, max) = self.range;
        min + (max - min) * share.powf(self.exponent)
    }

    fn share(self, value: f64) -> f64 {
        let (min, max) = self.range;
        ((value - min) / (max - min)).clamp(0.0, 1.0).powf(1.0 / self.exponent)
    }
}

/// The values that something like a slider can take, and how keys and screen readers change them.
pub struct Scale {
    /// The smallest and the largest value.
    pub range: (f64, f64),
    /// From one value to the next.
    pub step: f64,
}

impl Scale {
    /// The value on the steps nearest to `value`.
    fn nearest(&self, value: f64) -> f64 {
        let (min, max) = self.range;
        // Round values, whatever the least one is.
        let stepped = (value / self.step).round() * self.step;
        // Steps like 0.1 are not exact; what is shown is.
        let clean = (stepped * 1e6).round() / 1e6;
        clean.clamp(min, max)
    }

    /// What arrow up and down in focus, or a screen reader, ask for instead of `value`, if they do.
    pub fn asked(&self, ui: &Ui, response: &Response, value: f64) -> Option<f64> {
        let mut steps = 0.0;
        if response.has_focus() {
            let count = |key| ui.input_mut(|i| i.count_and_consume_key(Modifiers::NONE, key)) as f64;
            steps += count(Key::ArrowUp) - count(Key::ArrowDown);
            let filter = egui::EventFilter { vertical_arrows: true, ..Default::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        }
        ui.input(|input| {
            let count = |action| input.num_accesskit_action_requests(response.id, action) as f64;
            steps += count(Action::Increment) - count(Action::Decrement);
            let set = input.accesskit_action_requests(response.id, Action::SetValue).last();
            match set.and_then(|request| request.data.as_ref()) {
                Some(ActionData::NumericValue(wanted)) => Some(*wanted),
                _ => (steps != 0.0).then_some(value + steps * self.step),
            }
        })
    }

    /// Tells a screen reader what it can ask for.
    pub fn describe(&self, ui: &Ui, response: &Response, value: f64) {
        let (min, max) = self.range;
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_min_numeric_value(min);
            node.set_max_numeric_value(max);
            node.set_numeric_value_step(self.step);
            node.add_action(Action::SetValue);
            if value < max {
                node.add_action(Action::Increment);
            }
            if value > min {
                node.add_action(Action::Decrement);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_on_the_steps_and_in_the_range() {
        let scale = Scale { range: (-10.0, 10.0), step: 0.1 };
        assert_eq!([-11.0, -9.96, 0.04, 0.3000001, 99.0].map(|v| scale.nearest(v)), [-10.0, -10.0, 0.0, 0.3, 10.0]);
        let whole = Scale { range: (4.0, 64.0), step: 1.0 };
        assert_eq!(whole.nearest(16.4), 16.0);
    }
}
