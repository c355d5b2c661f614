//! A quantity over steps, as lines.

use std::sync::Arc;

use eframe::egui::{self, Align2, Color32, Painter, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use motionscope_core::Role;
use motionscope_core::scene::Series;

use crate::paint::{Face, Theme, number};
use crate::ui::charts::axis::Axis;
use crate::ui::drawing::{ink, primitives};

/// What is plotted.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The lines.
    pub series: &'a Series,
    /// The look.
    pub theme: Theme,
    /// Whether ten times as much is as far up everywhere, as long as all is more than nothing.
    pub logarithmic: bool,
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// The event of the step that was clicked.
    pub clicked: Option<usize>,
}

/// Shows the lines in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>) -> Response {
    let Input { series, theme, logarithmic } = input;
    let (area, _) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    let plot = Plot::new(series, area, theme, logarithmic);
    let sensed = ui.interact(plot.rect, ui.scope_id().with("series"), Sense::click());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(series)));
    let painter = ui.painter_at(area);
    axes(&painter, &plot, series, theme);
    sections(&painter, &plot, series, theme);
    let lines = painter.with_clip_rect(plot.rect.expand(4.0).intersect(area));
    for (_, role, points) in &series.lines {
        if are_marks(series, *role, points) {
            let stroke = Stroke::new(1.5, ink::color(theme.word(*role)));
            points.iter().for_each(|&point| _ = lines.circle_stroke(plot.at(point), 4.0, stroke));
        } else {
            line(&lines, &plot, *role, points, theme);
        }
    }
    let hovered = sensed.hover_pos().map(|at| plot.x.value(at.x));
    if let Some(x) = hovered.and_then(|x| nearest(series, x)) {
        let stroke = Stroke::new(1.0, ink::color(theme.chrome().dim));
        painter.vline(plot.x.place(x), plot.rect.y_range(), stroke);
    }
    header(&painter, &plot, area, input, hovered);
    let step = hovered.and_then(|x| nearest(series, x)).filter(|_| sensed.clicked());
    Response { clicked: step.and_then(|x| series.events.get((x as usize).checked_sub(1)?).copied()) }
}

/// Where the lines are drawn.
struct Plot {
    rect: Rect,
    x: Axis,
    /// Of values, or of their decimal logarithms.
    y: Axis,
    logarithmic: bool,
    small: f32,
}

impl Plot {
    fn new(series: &Series, area: Rect, theme: Theme, logarithmic: bool) -> Self {
        let small = theme.sizes().small;
        let min = area.min + vec2(4.6 * small, 2.4 * small);
        let max = area.max - vec2(2.0 * small, 3.6 * small);
        let rect = Rect::from_min_max(min, max.max(min + vec2(8.0, 8.0)));
        // What was rejected may be anything: it does not set the scale, and stands at its edge where it is beyond.
        let rejected = series.lines.iter().filter(|(_, role, points)| are_marks(series, *role, points));
        let rejected: Vec<[f32; 2]> = rejected.flat_map(|(_, _, points)| points).copied().collect();
        let all = || series.lines.iter().flat_map(|(_, _, points)| points).filter(|p| p[1].is_finite());
        let counts = |point: &&[f32; 2]| !rejected.contains(point);
        let some = all().any(|point| counts(&point));
        let values = all().filter(|point| !some || counts(point)).map(|point| point[1]);
        let low = values.clone().fold(f32::INFINITY, f32::min);
        let high = values.fold(f32::MIN_POSITIVE, f32::max);
        let least = low.min(0.0);
        let logarithmic = logarithmic && low > 0.0 && low.is_finite();
        let rough = Axis { values: [least, high], places: [rect.max.y, rect.min.y] };
        // The axis ends on a tick, so that it seldom changes while values come in.
        let step = rough.ticks(3.0 * small, 0.0).windows(2).map(|w| w[1] - w[0]).next().unwrap_or(high);
        let top = (high / step).ceil().max(1.0) * step;
        let bottom = (least / step).floor() * step;
        // From one power of ten to another.
        let decades = [low.log10().floor(), high.log10().ceil().max(low.log10().floor() + 1.0)];
        Self {
            rect,
            x: Axis { values: [0.0, series.x_max.max(1) as f32], places: [rect.min.x, rect.max.x] },
            y: Axis { values: if logarithmic { decades } else { [bottom, top] }, places: [rect.max.y, rect.min.y] },
            logarithmic,
            small,
        }
    }

    fn at(&self, [x, y]: [f32; 2]) -> Pos2 {
        let [low, high] = self.y.values;
        let y = if self.logarithmic { y.log10() } else { y };
        pos2(self.x.place(x), self.y.place(y.clamp(low, high)))
    }

    /// The ticks of the values, each with its place on the axis.
    fn ticks(&self) -> Vec<(f32, f32)> {
        let smallest = if self.logarithmic { 1.0 } else { 0.0 };
        let ticks = self.y.ticks(3.0 * self.small, smallest);
        ticks
            .into_iter()
            .map(|tick| (if self.logarithmic { 10f32.powf(tick) } else { tick }, self.y.place(tick)))
            .collect()
    }
}

fn axes(painter: &Painter, plot: &Plot, series: &Series, theme: Theme) {
    let chrome = theme.chrome();
    let (dim, rule) = (ink::color(chrome.dim), Stroke::new(1.0, ink::color(chrome.line)));
    let font = ink::font(Face::Sans, plot.small);
    for (tick, y) in plot.ticks() {
        painter.hline(plot.rect.x_range(), y, rule);
        painter.text(pos2(plot.rect.min.x - 7.0, y), Align2::RIGHT_CENTER, number(tick), font.clone(), dim);
    }
    let bottom = plot.rect.max.y;
    painter.hline(plot.rect.x_range(), bottom, Stroke::new(1.0, dim));
    let width = |text: &str| painter.layout_no_wrap(text.into(), font.clone(), dim).size().x;
    for tick in plot.x.ticks(5.0 * plot.small, 1.0) {
        let (x, text) = (plot.x.place(tick), number(tick));
        painter.vline(x, bottom..=bottom + 4.0, Stroke::new(1.0, dim));
        let x = x.min(painter.clip_rect().max.x - width(&text) / 2.0);
        painter.text(pos2(x, bottom + 6.0), Align2::CENTER_TOP, text, font.clone(), dim);
    }
    let text = ink::color(chrome.text);
    let below = pos2(plot.rect.max.x, bottom + 6.0 + 1.3 * plot.small);
    painter.text(below, Align2::RIGHT_TOP, series.x_label, font, text);
}

/// Between the lines where two stretches of a whole begin there is at least this room, in points; else only wholes have lines.
const PARTS_PT: f32 = 5.0;

/// Where something else is at hand from then on: a line, longer where a whole begins, with its name if there is room for that.
fn sections(painter: &Painter, plot: &Plot, series: &Series, theme: Theme) {
    let chrome = theme.chrome();
    let (top, dim) = (plot.rect.min.y, ink::color(chrome.dim));
    let font = ink::font(Face::Sans, plot.small);
    let places: Vec<_> = series.sections.iter().map(|section| (plot.x.place(section.from), section.is_part)).collect();
    let names = series.sections.iter().map(|section| painter.layout_no_wrap(section.label.clone(), font.clone(), dim));
    let names: Vec<_> = names.collect();
    let widths: Vec<_> = names.iter().map(|name| name.size().x).collect();
    let are_apart = places.windows(2).all(|pair| pair[1].0 - pair[0].0 >= PARTS_PT);
    for ((x, is_part), (name, is_named)) in
        places.iter().zip(names.into_iter().zip(named(&places, &widths, plot.rect.max.x)))
    {
        if *is_part && !are_apart {
            continue;
        }
        let from = if *is_part { top + 1.5 * plot.small } else { top };
        painter.vline(*x, from..=plot.rect.max.y, Stroke::new(1.0, ink::color(chrome.line.mix(chrome.dim, 0.4))));
        if is_named {
            painter.galley(pos2(x + NAME_PT, top), name, dim);
        }
    }
}

/// From the line where a stretch begins to its name, and from there to what comes next, in points.
const NAME_PT: f32 = 4.0;

/// Which stretches have room for their names, which are so wide: wholes before the next whole, parts beside all that is named.
fn named(places: &[(f32, bool)], widths: &[f32], end: f32) -> Vec<bool> {
    let mut is_named = vec![false; places.len()];
    // The end of a name that stands at or before each place.
    let mut taken = f32::NEG_INFINITY;
    for (i, (&(x, is_part), width)) in places.iter().zip(widths).enumerate() {
        let next = places[i + 1..].iter().find(|(_, next)| is_part || !next).map_or(end, |(next, _)| *next);
        is_named[i] = x >= taken && x + width + 2.0 * NAME_PT <= next;
        if is_named[i] {
            taken = x + width + NAME_PT;
        }
    }
    is_named
}

/// Whether points mark values of another line that were rejected: these have nothing between them.
fn are_marks(series: &Series, role: Role, points: &[[f32; 2]]) -> bool {
    let Some(first) = points.first().filter(|_| role == Role::Rejected) else { return false };
    series.lines.iter().any(|(_, other, points)| *other != role && points.contains(first))
}

/// A line in its role's colour. A best value holds until it is beaten: it goes in steps.
fn line(painter: &Painter, plot: &Plot, role: Role, points: &[[f32; 2]], theme: Theme) {
    let color = ink::color(theme.word(role));
    let holds = role == Role::Best;
    let width = theme.ink(role).width * if holds { 1.0 } else { 0.6 };
    let stroke = Stroke::new(width, if holds { color } else { color.gamma_multiply(0.85) });
    let mut last = None;
    for run in points.split(|point| point[1].is_nan()).filter(|run| !run.is_empty()) {
        let run = if holds { steps(run) } else { thinned(run, plot) };
        let places: Vec<Pos2> = run.iter().map(|&point| plot.at(point)).collect();
        painter.extend(primitives::line(&places, stroke, theme.ink(role).dash));
        if places.len() == 1 || points.len() <= FEW && !holds {
            for &place in &places {
                painter.circle_filled(place, 1.0 + width, color);
            }
        }
        last = places.last().copied();
    }
    let Some(last) = last else { return };
    painter.circle(last, 2.0 + width, color, Stroke::new(1.5, ink::color(theme.chrome().panel)));
}

/// So few values are marked one by one.
const FEW: usize = 16;

/// Each value is held up to the next.
fn steps(points: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let mut held = Vec::with_capacity(2 * points.len());
    for (i, &[x, y]) in points.iter().enumerate() {
        if i > 0 {
            held.push([x, points[i - 1][1]]);
        }
        held.push([x, y]);
    }
    held
}

/// At most two points for every point of the screen: the smallest and the largest there.
fn thinned(points: &[[f32; 2]], plot: &Plot) -> Vec<[f32; 2]> {
    if points.len() < 2 * plot.rect.width() as usize {
        return points.to_vec();
    }
    let column = |point: &[f32; 2]| plot.x.place(point[0]).floor();
    let mut kept = Vec::new();
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_value = |a: &&[f32; 2], b: &&[f32; 2]| a[1].total_cmp(&b[1]);
        let ends = [group.iter().min_by(by_value), group.iter().max_by(by_value)];
        let mut ends: Vec<_> = ends.into_iter().flatten().copied().collect();
        ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
        kept.extend(ends);
    }
    kept.extend(points.last());
    kept
}

/// The step nearest to `x` for which there is a value.
fn nearest(series: &Series, x: f32) -> Option<f32> {
    let all = series.lines.iter().flat_map(|(_, _, points)| points).map(|point| point[0]);
    all.min_by(|a, b| (a - x).abs().total_cmp(&(b - x).abs()))
}

/// The value of a line at `x`: a best value holds, others are known only at their points.
fn value(role: Role, points: &[[f32; 2]], x: f32) -> Option<f32> {
    let before = points.partition_point(|point| point[0] <= x).checked_sub(1)?;
    let [at, value] = points[before];
    (at == x || role == Role::Best).then_some(value).filter(|value| !value.is_nan())
}

/// What is plotted, and the values under the pointer.
fn header(painter: &Painter, plot: &Plot, area: Rect, input: Input<'_>, hovered: Option<f32>) {
    let Input { series, theme, .. } = input;
    let chrome = theme.chrome();
    let font = ink::font(Face::Sans, plot.small);
    let text = ink::color(chrome.text);
    let step = hovered.and_then(|x| nearest(series, x));
    let first = match step {
        Some(x) => format!("{} {}", series.x_label, number(x)),
        None => format!("{}, {}", series.title, series.y_label),
    };
    let mut words = vec![(first, text)];
    for (name, role, points) in &series.lines {
        let value = step.and_then(|x| value(*role, points, x)).map(|value| format!(" {}", number(value)));
        words.push((format!("{name}{}", value.unwrap_or_default()), ink::color(theme.word(*role))));
    }
    let galleys = words.into_iter().map(|(words, color)| painter.layout_no_wrap(words, font.clone(), color));
    let mut galleys: Vec<_> = galleys.collect();
    let gap = 1.4 * plot.small;
    let width = |galleys: &[Arc<egui::Galley>]| galleys.iter().map(|galley| galley.size().x + gap).sum::<f32>();
    let left = area.min.x.max(plot.rect.max.x - width(&galleys) + gap).min(plot.rect.min.x);
    // Where there is no room for all, the names of the lines matter more.
    if width(&galleys) - gap > area.max.x - left && step.is_none() {
        galleys.remove(0);
    }
    let mut at = pos2(left, area.min.y + 0.7 * plot.small);
    for galley in galleys {
        let (width, top) = (galley.size().x, at.y - galley.size().y / 2.0);
        painter.galley(pos2(at.x, top), galley, Color32::PLACEHOLDER);
        at.x += width + gap;
    }
}

fn summary(series: &Series) -> String {
    let last = series.lines.iter().filter_map(|(name, _, points)| {
        let known = points.iter().rev().find(|point| !point[1].is_nan());
        known.map(|[x, y]| format!(", {name} {} at {} {}", number(*y), series.x_label, number(*x)))
    });
    format!("{}, {}{}", series.title, series.y_label, last.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(points: usize) -> Series {
        let tested = (1..=points).map(|i| [i as f32, 500.0 + (i * 37 % 400) as f32]).collect();
        let best = vec![[1.0, 537.0], [3.0, 511.0]];
        let lines = vec![("candidate", Role::Candidate, tested), ("best so far", Role::Best, best)];
        Series {
            title: "Cost by candidate",
            x_label: "candidate",
            y_label: "SAD",
            x_max: 1089,
            events: (1..=points).collect(),
            sections: Vec::new(),
            lines,
        }
    }

    fn plot(series: &Series) -> Plot {
        Plot::new(series, Rect::from_min_size(Pos2::ZERO, vec2(400.0, 200.0)), Theme::Dark, false)
    }

    #[test]
    fn the_axes_hold_every_value_and_do_not_jump() {
        let (few, many) = (series(10), series(1089));
        let (a, b) = (plot(&few), plot(&many));
        assert_eq!(a.x, b.x);
        assert_eq!(a.y.values, b.y.values, "the top is a round number");
        for [_, y] in &many.lines[0].2 {
            assert!(b.rect.y_range().contains(b.y.place(*y)));
        }
    }

    #[test]
    fn a_logarithmic_axis_goes_by_powers_of_ten() {
        let mut series = series(3);
        series.lines[0].2 = vec![[4.0, 13.0], [8.0, 81.0], [16.0, 4225.0]];
        let area = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 200.0));
        let plot = Plot::new(&series, area, Theme::Dark, true);
        assert_eq!(plot.ticks().iter().map(|tick| tick.0.round()).collect::<Vec<_>>(), [10.0, 100.0, 1000.0, 10000.0]);
        let up = |y| plot.at([4.0, y]).y;
        assert!((up(10.0) - up(100.0) - (up(100.0) - up(1000.0))).abs() < 1e-3 && up(10.0) > up(100.0));
        series.lines[0].2.push([32.0, 0.0]);
        assert!(!Plot::new(&series, area, Theme::Dark, true).logarithmic, "nothing has no logarithm");
    }

    #[test]
    fn stretches_are_named_where_there_is_room() {
        let (whole, part) = (false, true);
        let places = [(0.0, whole), (30.0, part), (60.0, part), (100.0, whole), (120.0, part), (170.0, part)];
        assert_eq!(
            named(&places, &[40.0, 20.0, 20.0, 40.0, 20.0, 20.0], 190.0),
            [true, false, true, true, false, false]
        );
        assert_eq!(
            named(&places, &[200.0, 20.0, 20.0, 10.0, 20.0, 20.0], 250.0),
            [false, true, true, true, true, true]
        );
    }

    #[test]
    fn a_best_value_holds_until_it_is_beaten() {
        assert_eq!(steps(&[[1.0, 9.0], [4.0, 5.0]]), [[1.0, 9.0], [4.0, 9.0], [4.0, 5.0]]);
        let series = series(10);
        let (_, _, best) = &series.lines[1];
        assert_eq!(
            [0.0, 1.0, 2.0, 9.0].map(|x| value(Role::Best, best, x)),
            [None, Some(537.0), Some(537.0), Some(511.0)]
        );
        assert_eq!(value(Role::Candidate, &series.lines[0].2, 2.5), None);
    }

    #[test]
    fn rejected_values_of_another_line_are_marked() {
        let mut series = series(10);
        let some = vec![series.lines[0].2[3], series.lines[0].2[7]];
        assert!(are_marks(&series, Role::Rejected, &some) && !are_marks(&series, Role::Error, &some));
        series.lines[0].2.clear();
        assert!(!are_marks(&series, Role::Rejected, &some), "a line of its own");
    }

    #[test]
    fn many_points_are_thinned_without_losing_the_extremes() {
        let series = series(1089);
        let points = &series.lines[0].2;
        let kept = thinned(points, &plot(&series));
        assert!(kept.len() < points.len());
        let low = |points: &[[f32; 2]]| points.iter().map(|p| p[1]).fold(f32::MAX, f32::min);
        assert_eq!(low(&kept), low(points));
        assert_eq!(kept.last(), points.last());
    }
}
