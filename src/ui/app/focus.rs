//! The way of the keyboard through the window: Tab from widget to widget, F6 from pane to pane (F8 in a page of a browser), and the ring
//! around what has it.
//!
//! It takes both before egui does, sorts the widgets of the last frame by their panes and in a pane by rows, and draws
//! the one ring. No widget draws its own, and a test fails on a widget without a name.

use eframe::egui::accesskit::{Action, ActionRequest, TreeId};
use eframe::egui::{
    Context, Event, FocusDirection, Id, Key, Modifiers, Order, Painter, Popup, Rect, Stroke, StrokeKind, WidgetRect,
};

use super::Region;
use crate::paint::Theme;
use crate::ui::commands::PANE_KEY;
use crate::ui::drawing::style;

/// Width of the ring, and of its rim towards what it lies on, in points.
const RING_PT: f32 = 2.0;
const RIM_PT: f32 = 1.0;
/// Rounding of its corners, in points.
const CORNER_PT: f32 = 5.0;

/// The panes in the order in which they are gone through.
const PANES: [Region; 10] = [
    Region::Header,
    Region::Stage,
    Region::Question,
    Region::Lesson,
    Region::Explanation,
    Region::Strip,
    Region::Chart,
    Region::Parameters,
    Region::Transport,
    Region::Status,
];

/// A widget that can have the keyboard.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stop {
    id: Id,
    /// The place of its pane among all.
    pane: usize,
    rect: Rect,
    /// Whether not all of it is in sight.
    is_cut: bool,
}

/// Moves the keyboard where Tab or the key of the panes was pressed: to the next widget or pane, or with Shift to the one before. An open menu has the keys
/// to itself.
pub(super) fn travel(ctx: &Context, regions: &[(Region, Rect)]) {
    let pressed = |key| {
        ctx.input_mut(|input| {
            let is_back = input.consume_key(Modifiers::SHIFT, key);
            (is_back || input.consume_key(Modifiers::NONE, key)).then_some(is_back)
        })
    };
    if Popup::is_any_open(ctx) {
        return;
    }
    let (is_back, by_pane) = match (pressed(Key::Tab), pressed(PANE_KEY)) {
        (Some(is_back), _) => (is_back, false),
        (None, Some(is_back)) => (is_back, true),
        (None, None) => return,
    };
    let stops = stops(ctx, regions);
    let now = ctx.memory(|memory| memory.focused()).and_then(|id| stops.iter().position(|stop| stop.id == id));
    let next = if by_pane { next_pane(&stops, now, is_back) } else { next_stop(stops.len(), now, is_back) };
    // egui has taken the key for a wish to go on in the order in which widgets are made.
    ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    let Some(Stop { id, is_cut, .. }) = next.map(|next| stops[next]) else { return };
    ctx.memory_mut(|memory| memory.request_focus(id));
    if !is_cut {
        return;
    }
    let (action, target_node) = (Action::ScrollIntoView, id.accesskit_id());
    let request = ActionRequest { action, target_tree: TreeId::ROOT, target_node, data: None };
    ctx.input_mut(|input| input.events.push(Event::AccessKitActionRequest(request)));
}

/// The place after or before `now` among `count`, in a circle.
fn next_stop(count: usize, now: Option<usize>, is_back: bool) -> Option<usize> {
    let last = count.checked_sub(1)?;
    Some(match (now, is_back) {
        (None, false) => 0,
        (None, true) => last,
        (Some(now), false) => (now + 1) % count,
        (Some(now), true) => now.checked_sub(1).unwrap_or(last),
    })
}

/// The first stop of the pane after or before that of `now`.
fn next_pane(stops: &[Stop], now: Option<usize>, is_back: bool) -> Option<usize> {
    let mut firsts: Vec<usize> = Vec::new();
    for (i, stop) in stops.iter().enumerate() {
        if firsts.last().is_none_or(|first| stops[*first].pane != stop.pane) {
            firsts.push(i);
        }
    }
    let now = now.and_then(|now| firsts.iter().rposition(|first| *first <= now));
    next_stop(firsts.len(), now, is_back).map(|next| firsts[next])
}

/// All that can have the keyboard, in the order of panes, and in a pane as one reads.
fn stops(ctx: &Context, regions: &[(Region, Rect)]) -> Vec<Stop> {
    let mut panes: Vec<(Region, Rect)> = regions.iter().filter(|(region, _)| PANES.contains(region)).copied().collect();
    panes.sort_by_key(|(region, _)| PANES.iter().position(|pane| pane == region));
    let mut stops = Vec::new();
    ctx.viewport(|viewport| {
        for (layer, widgets) in viewport.prev_pass.widgets.layers() {
            if !layer.order.allow_interaction() {
                continue;
            }
            let mut pane = 0;
            for widget in widgets.iter().filter(|widget| widget.enabled && widget.sense.is_focusable()) {
                // What lies above the panes comes last.
                pane = if layer.order == Order::Background { pane_of(widget, &panes, pane) } else { panes.len() };
                let is_cut = !widget.interact_rect.contains_rect(widget.rect);
                stops.push(Stop { id: widget.id, pane, rect: widget.rect, is_cut });
            }
        }
    });
    stops.sort_by_key(|stop| stop.pane);
    stops.chunk_by_mut(|a, b| a.pane == b.pane).for_each(in_rows);
    stops
}

/// The pane in which a widget is seen, or else that of the one before it: what is scrolled out of sight follows what is in sight.
fn pane_of(widget: &WidgetRect, panes: &[(Region, Rect)], before: usize) -> usize {
    let seen = widget.interact_rect;
    if !seen.is_positive() {
        return before;
    }
    let far = |(_, rect): &(Region, Rect)| rect.distance_sq_to_pos(seen.center());
    let nearest = panes.iter().enumerate().min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
    nearest.map_or(before, |(pane, _)| pane)
}

/// Sorts stops by rows, and each row from left to right. A row has all whose centres lie above the lower edge of its first, and what is
/// so high that it reaches past that one's centre.
fn in_rows(stops: &mut [Stop]) {
    stops.sort_by(|a, b| a.rect.center().y.total_cmp(&b.rect.center().y));
    let mut rest = stops;
    while let Some(first) = rest.first().copied() {
        let is_beside = |stop: &&Stop| {
            stop.rect.center().y <= first.rect.max.y - 1.0 || stop.rect.y_range().contains(first.rect.center().y)
        };
        let count = rest.iter().take_while(is_beside).count().max(1);
        let (row, others) = rest.split_at_mut(count);
        row.sort_by(|a, b| a.rect.min.x.total_cmp(&b.rect.min.x));
        rest = others;
    }
}

/// Draws the ring around the widget that has the keyboard, wherever it is and whatever it looks like.
pub(super) fn ring(ctx: &Context, theme: Theme) {
    let Some(focused) = ctx.memory(|memory| memory.focused()).and_then(|id| ctx.read_response(id)) else { return };
    let reach = RING_PT + RIM_PT;
    let window = ctx.content_rect().shrink(reach);
    let rect = focused.rect.intersect(window);
    let clip = focused.interact_rect.expand(reach);
    if !(rect.is_positive() && focused.interact_rect.is_positive()) {
        return;
    }
    let (painter, chrome) = (Painter::new(ctx.clone(), focused.layer_id, clip), theme.chrome());
    let strokes = [(reach, RING_PT + 2.0 * RIM_PT, chrome.background), (RING_PT, RING_PT, chrome.accent)];
    for (out, width, color) in strokes {
        let stroke = Stroke::new(width, style::color(color));
        painter.rect_stroke(rect.expand(out), CORNER_PT + out, stroke, StrokeKind::Inside);
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{pos2, vec2};

    use super::*;

    fn stop(pane: usize, x: f32, y: f32, height: f32) -> Stop {
        let (id, rect) = (Id::unique((pane, x as i32, y as i32)), Rect::from_min_size(pos2(x, y), vec2(20.0, height)));
        Stop { id, pane, rect, is_cut: false }
    }

    #[test]
    fn a_pane_is_read_row_by_row() {
        let mut stops =
            [stop(0, 90.0, 12.0, 20.0), stop(0, 0.0, 40.0, 20.0), stop(0, 50.0, 8.0, 24.0), stop(0, 0.0, 10.0, 20.0)];
        let [right, below, middle, left] = stops;
        in_rows(&mut stops);
        assert_eq!(stops, [left, middle, right, below]);
    }

    #[test]
    fn f6_leads_to_the_first_of_each_pane_and_round_again() {
        let stops = [stop(0, 0.0, 0.0, 9.0), stop(0, 30.0, 0.0, 9.0), stop(2, 0.0, 50.0, 9.0), stop(5, 0.0, 90.0, 9.0)];
        let ways = |now, is_back| next_pane(&stops, now, is_back);
        assert_eq!([None, Some(0), Some(1), Some(2), Some(3)].map(|now| ways(now, false)), [0, 2, 2, 3, 0].map(Some));
        assert_eq!([None, Some(0), Some(1), Some(2)].map(|now| ways(now, true)), [3, 3, 3, 0].map(Some));
        assert_eq!(next_pane(&[], None, false), None);
        assert_eq!(
            [next_stop(3, Some(2), false), next_stop(3, Some(0), true), next_stop(0, None, true)],
            [Some(0), Some(2), None]
        );
    }
}
