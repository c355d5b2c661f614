//! The two tracks of the timeline: the units of the run above, the events of the unit at hand below.

use eframe::egui::{
    self, Align2, Color32, CursorIcon, Rect, Response, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use motionscope_core::run::{Cursor, FRAME, Granularity, ROW};
use motionscope_core::scene::Role;

use crate::paint::{Theme, grouped};
use crate::ui::drawing::style;
use crate::ui::model::snapshot::Snapshot;
use crate::ui::panes::status;
use crate::ui::parts::slider::Scale;
use crate::view::moment::Fault;

/// Least distance of two ticks in points.
const TICK_PT: f32 = 9.0;
/// The smallest length of a track with a hidden end.
const OPEN_END: usize = 16;

/// One track: how much there is, and how much of it was seen.
struct Track<'a> {
    name: &'a str,
    /// What stands before it: `block`, or `all rows` where these are counted through several iterations.
    label: String,
    count: usize,
    /// The last number that can be gone to.
    end: usize,
    /// How much was seen, from 0 to `count`.
    at: f32,
    /// The number that is at hand: of the unit from 1, or of events seen from 0.
    number: usize,
    /// How a place on the track is counted.
    counts: Counts,
    /// What the counter says: `35 / 1200`.
    counter: String,
    marks: Vec<(f32, Role)>,
    /// The units with errors of tracks.
    faults: &'a [(usize, Fault)],
}

/// How a place on a track is counted.
#[derive(Clone, Copy, PartialEq)]
enum Counts {
    /// A unit reaches from one tick to the next.
    Stretches,
    /// An event is a tick itself; before the first one nothing has happened.
    Ticks,
}

/// Draws both tracks into `rect`, while results are `asked` about without what lies ahead; gives the cursor that the person
/// drags to.
pub fn show(ui: &mut Ui, rect: Rect, (shown, asked): (&Snapshot, bool), theme: Theme) -> Option<Cursor> {
    let (upper, lower) = rect.split_top_bottom_at_fraction(0.5);
    let granularities = shown.info.granularities;
    let name =
        |from_inside: usize| granularities.len().checked_sub(from_inside).and_then(|i| granularities.get(i)).copied();
    let Cursor { unit, event } = shown.cursor;
    let about = expected(unit, &shown.place);
    let units = shown.units.or(about).unwrap_or(0).max(unit + 1);
    // How many events are left would tell what they find.
    let is_open = status::total((event, shown.events), asked).is_none();
    let inside = if shown.events == 0 || is_open { 0.0 } else { event as f32 / shown.events as f32 };
    let of = match (shown.units, about) {
        (Some(units), _) => format!(" / {}", grouped(units)),
        (None, Some(_)) => format!(" / ≈ {}", grouped(units)),
        (None, None) => String::new(),
    };
    let unit_name = name(2).unwrap_or("unit");
    // Elsewhere a unit is counted within its group.
    let in_group = shown.place.last().and_then(|unit| unit.of);
    // They are in the order of the units.
    let ahead = shown.faults.partition_point(|(of, _)| *of < unit + usize::from(!is_open));
    let faults = if asked { &shown.faults[..ahead] } else { &shown.faults[..] };
    let run = Track {
        name: unit_name,
        label: if in_group.is_some_and(|of| Some(of) != shown.units) {
            format!("all {unit_name}s")
        } else if [FRAME, ROW].contains(&unit_name) {
            // A count: the number of the frame or the row stands elsewhere, and begins with 0.
            format!("{unit_name}s")
        } else {
            unit_name.into()
        },
        count: units,
        end: units,
        at: unit as f32 + inside,
        number: unit + 1,
        counts: Counts::Stretches,
        counter: format!("{}{of}", grouped(unit + 1)),
        // In the middle of its stretch, so that a click on it goes there.
        marks: faults.iter().map(|(unit, fault)| (*unit as f32 + 0.5, fault.role())).collect(),
        faults,
    };
    let events = Track {
        name: name(1).unwrap_or("step"),
        label: name(1).unwrap_or("step").into(),
        count: if is_open { open_end(event) } else { shown.events.max(1) },
        // What lies ahead is asked about before it is seen.
        end: if is_open { event } else { shown.events.max(1) },
        at: event as f32,
        number: event,
        counts: Counts::Ticks,
        counter: if is_open { grouped(event) } else { format!("{} / {}", grouped(event), grouped(shown.events)) },
        marks: marks_of(shown, asked),
        faults: &[],
    };
    let columns = Columns::of(ui, [&run, &events]);
    let to_unit = run.show(ui, upper, &columns, theme);
    let to_event = events.show(ui, lower, &columns, theme);
    let unit_at = |number: usize| Cursor { unit: number.saturating_sub(1), event: usize::MAX };
    let event_at = |number: usize| Cursor { unit, event: number.max(usize::from(unit > 0)) };
    to_unit.map(unit_at).or(to_event.map(event_at)).filter(|to| !stands_at(shown, *to))
}

/// The marks of the events; while results are asked about, only of those that were seen.
fn marks_of(shown: &Snapshot, asked: bool) -> Vec<(f32, Role)> {
    let seen = shown.landmarks.iter().filter(|(at, _)| !asked || *at <= shown.cursor.event);
    seen.map(|(at, role)| (*at as f32, *role)).collect()
}

/// The length of a track of which only the number of events seen is told.
fn open_end(seen: usize) -> usize {
    (seen + 1).next_power_of_two().max(OPEN_END)
}

/// About how many units a run has that does not know: as many as there are if each group of them that is left is as large as
/// the one at hand, or where that is not known as those before were.
fn expected(unit: usize, place: &[Granularity]) -> Option<usize> {
    let [outer @ .., Granularity { index, of }] = place else { return None };
    let mean = || unit.saturating_sub(*index).checked_div(outer.last()?.index);
    let mut size = (*of).or_else(mean)?;
    let mut left = size.saturating_sub(*index);
    for Granularity { index, of } in outer.iter().rev() {
        left += (*of)?.saturating_sub(index + 1) * size;
        size *= (*of)?;
    }
    Some(unit + left)
}

/// Whether `to` is what is shown: a unit that was seen to its end is so by any name.
fn stands_at(shown: &Snapshot, to: Cursor) -> bool {
    to.unit == shown.cursor.unit && to.event.min(shown.events) == shown.cursor.event
}

/// Widths of the words left and right of the tracks, so that both tracks align.
struct Columns {
    left: f32,
    right: f32,
}

impl Columns {
    fn of(ui: &Ui, tracks: [&Track; 2]) -> Self {
        let font = TextStyle::Small.resolve(ui.style());
        let width = |text: &str| ui.painter().layout_no_wrap(text.into(), font.clone(), Color32::WHITE).size().x;
        // The counter is given the room that it will need at its end.
        let most = |track: &Track| width(&format!("{} / {}", grouped(track.count), grouped(track.count)));
        let widest = |of: &dyn Fn(&Track) -> f32| tracks.into_iter().map(of).fold(0.0, f32::max).ceil();
        // Units differ in their number of events. A track that moved under the pointer would lead astray, so there is
        // room for the usual number of digits, and for as many as there ever were.
        let usual = width("0000 / 0000").ceil();
        let id = ui.scope_id().with(("counters", font.size.to_bits()));
        let before = ui.data(|data| data.get_temp(id)).unwrap_or(usual);
        let counters = widest(&most).max(before);
        ui.data_mut(|data| data.insert_temp(id, counters));
        // The knob reaches beyond the end of its track.
        let gap = 1.2 * font.size;
        Self { left: widest(&|track| width(&track.label)) + gap, right: counters + gap }
    }
}

impl Track<'_> {
    /// Draws the track; gives the number of the unit or of the events that the person goes to.
    fn show(&self, ui: &mut Ui, rect: Rect, columns: &Columns, theme: Theme) -> Option<usize> {
        let rail = Rect::from_min_max(
            pos2(rect.min.x + columns.left, rect.min.y),
            pos2((rect.max.x - columns.right).max(rect.min.x + columns.left + 20.0), rect.max.y),
        );
        let response = ui.interact(rail, ui.scope_id().with(("track", self.name)), Sense::click_and_drag());
        let response = response.on_hover_cursor(CursorIcon::PointingHand);
        let (value, name) = (self.number as f64, format!("Timeline, {}s", self.name));
        response.widget_info(|| WidgetInfo::slider(true, value, &name));
        let scale = Scale { range: (f64::from(self.least()), self.count as f64), step: 1.0 };
        scale.describe(ui, &response, value);
        self.words(ui, rect, theme);
        self.rail(ui, rail, &response, theme);
        let number_at = |at: egui::Pos2| self.number_at(self.value_at(rail, at.x));
        if let Some(at) = response.hover_pos().filter(|_| !response.dragged()) {
            let number = number_at(at);
            let place = format!("{} {}", self.name, grouped(number));
            let fault = self.faults.iter().find(|(unit, _)| unit + 1 == number);
            let message = fault.map_or_else(|| place.clone(), |(_, fault)| format!("{place}: {}", fault.name()));
            response.clone().on_hover_text_at_pointer(message);
        }
        // The last move and the release may come in one frame.
        let held = response.is_pointer_button_down_on() || response.clicked() || response.drag_stopped();
        let pointed = held.then(|| response.interact_pointer_pos()).flatten().map(number_at);
        let asked = || scale.asked(ui, &response, value).map(|wanted| wanted.round() as usize);
        pointed.or_else(asked).map(|number| number.clamp(self.least() as usize, self.end))
    }

    /// The smallest number.
    fn least(&self) -> u8 {
        match self.counts {
            Counts::Stretches => 1,
            Counts::Ticks => 0,
        }
    }

    /// The number that is meant by a place on the track: what is told when one points there, and gone to by a click.
    fn number_at(&self, value: f32) -> usize {
        match self.counts {
            Counts::Stretches => (value as usize).min(self.count - 1) + 1,
            Counts::Ticks => (value.round() as usize).min(self.end),
        }
    }

    fn words(&self, ui: &Ui, rect: Rect, theme: Theme) {
        let font = TextStyle::Small.resolve(ui.style());
        let chrome = theme.chrome();
        let painter = ui.painter();
        painter.text(rect.left_center(), Align2::LEFT_CENTER, &self.label, font.clone(), style::color(chrome.dim));
        painter.text(rect.right_center(), Align2::RIGHT_CENTER, &self.counter, font, style::color(chrome.text));
    }

    fn rail(&self, ui: &Ui, rail: Rect, response: &Response, theme: Theme) {
        let chrome = theme.chrome();
        let painter = ui.painter().with_clip_rect(rail.expand2(vec2(8.0, 0.0)));
        let thickness = (4.0 * style::scale(theme)).round();
        let bar = Rect::from_center_size(rail.center(), vec2(rail.width(), thickness));
        painter.rect_filled(bar, thickness / 2.0, style::color(chrome.hovered));
        let x = self.x_of(rail, self.at);
        painter.rect_filled(bar.with_max_x(x), thickness / 2.0, style::color(chrome.accent.mix(chrome.panel, 0.35)));
        self.ticks(&painter, rail, bar, style::color(chrome.background));
        self.landmarks(&painter, rail, thickness, theme);
        let lit = response.hovered() || response.dragged();
        let radius = thickness * if lit { 1.7 } else { 1.4 };
        let ring = Stroke::new(2.0, style::color(chrome.panel));
        painter.circle(pos2(x, rail.center().y), radius, style::color(chrome.accent), ring);
    }

    /// Gaps in the bar where one ends and the next begins; thinned out where they are too many.
    fn ticks(&self, painter: &egui::Painter, rail: Rect, bar: Rect, color: Color32) {
        let every = tick_every(self.count, rail.width());
        let stroke = Stroke::new(1.0, color);
        for index in (every..self.count).step_by(every) {
            painter.vline(self.x_of(rail, index as f32).round(), bar.y_range(), stroke);
        }
    }

    /// What is worth a look: at most one mark per point of the screen.
    fn landmarks(&self, painter: &egui::Painter, rail: Rect, thickness: f32, theme: Theme) {
        let mut last = f32::NEG_INFINITY;
        for (at, role) in &self.marks {
            let x = self.x_of(rail, *at);
            if x - last < 1.0 {
                continue;
            }
            last = x;
            // Those ahead are shorter.
            let height = if *at <= self.at { 2.2 } else { 1.6 } * thickness;
            let y = rail.center().y;
            let stroke = Stroke::new(2.0, style::color(theme.stroke(*role)));
            painter.vline(x, y - height..=y - 0.9 * thickness, stroke);
        }
    }

    fn x_of(&self, rail: Rect, at: f32) -> f32 {
        egui::remap_clamp(at, 0.0..=self.count as f32, rail.x_range())
    }

    fn value_at(&self, rail: Rect, x: f32) -> f32 {
        egui::remap_clamp(x, rail.x_range(), 0.0..=self.count as f32)
    }
}

/// Every how many one tick is drawn: 1, 2, 5, 10, 20, 50 …
fn tick_every(count: usize, width: f32) -> usize {
    let room = (width / TICK_PT).max(1.0) as usize;
    let mut decade = 1;
    loop {
        for every in [decade, 2 * decade, 5 * decade] {
            if count.div_ceil(every) <= room {
                return every;
            }
        }
        decade *= 10;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_thinned_to_round_numbers() {
        assert_eq!(tick_every(40, 600.0), 1);
        assert_eq!(tick_every(1200, 600.0), 20);
        assert_eq!(tick_every(8160, 600.0), 200);
        assert_eq!(tick_every(8160, 0.0), 10_000);
    }

    #[test]
    fn a_track_with_an_open_end_is_as_long_for_any_number_of_events() {
        assert_eq!([0, 3, 15, 16, 300].map(open_end), [16, 16, 16, 32, 512]);
        assert!((0..3000).all(|seen| open_end(seen) > seen), "there is always something ahead");
    }

    fn track(count: usize, counts: Counts) -> Track<'static> {
        Track {
            name: "block",
            label: "block".into(),
            count,
            end: count,
            at: 0.0,
            number: 0,
            counts,
            counter: String::new(),
            marks: Vec::new(),
            faults: &[],
        }
    }

    #[test]
    fn a_run_that_does_not_know_its_length_is_reported_about_how_long_it_is() {
        let place = |[pair, feature]: [usize; 2], [pairs, features]: [Option<usize>; 2]| {
            let granularity = |index, of| Granularity { index, of };
            [granularity(0, Some(1)), granularity(pair, pairs), granularity(feature, features)]
        };
        assert_eq!(expected(19, &place([0, 19], [Some(23), Some(200)])), Some(23 * 200));
        assert_eq!(expected(400, &place([2, 0], [Some(10), None])), Some(400 + 8 * 200), "as before");
        assert_eq!(expected(0, &place([0, 0], [Some(10), None])), None, "the first tells nothing");
        assert_eq!(expected(9, &place([0, 9], [None, Some(200)])), None, "nor does a clip of unknown length");
        let warps = [(0, 1), (1, 3), (2, 5), (40, 100)].map(|(index, of)| Granularity { index, of: Some(of) });
        assert_eq!(expected(740, &warps), Some(1500), "levels of warps of iterations");
        assert_eq!(expected(9, &[]), None);
    }

    #[test]
    fn units_lie_between_ticks_and_events_on_them() {
        let (units, events) = (track(10, Counts::Stretches), track(10, Counts::Ticks));
        assert_eq!([0.0, 0.9, 1.0, 9.9, 10.0].map(|at| units.number_at(at)), [1, 1, 2, 10, 10]);
        assert_eq!([0.0, 0.4, 0.6, 9.4, 10.0].map(|at| events.number_at(at)), [0, 0, 1, 9, 10]);
    }

    #[test]
    fn a_place_ahead_on_a_track_with_an_open_end_means_what_was_seen_last() {
        let events = Track { end: 3, ..track(16, Counts::Ticks) };
        assert_eq!([0.0, 2.0, 3.0, 3.6, 16.0].map(|at| events.number_at(at)), [0, 2, 3, 3, 3]);
    }

    #[test]
    fn places_and_values_are_inverse() {
        let track = track(300, Counts::Ticks);
        let rail = Rect::from_min_max(pos2(100.0, 0.0), pos2(500.0, 20.0));
        for at in [0.0, 1.0, 150.0, 299.0, 300.0] {
            assert!((track.value_at(rail, track.x_of(rail, at)) - at).abs() < 1e-3);
        }
        assert_eq!(track.value_at(rail, -5.0), 0.0);
    }
}
