//! A quantity over steps, as lines.

use motionscope_core::Role;
use motionscope_core::scene::Series;

use super::super::primitive::{Anchor, Point, Primitive, Rect, Stroke};
use super::super::{Theme, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, shortened, solid};
use super::{ChartStyle, Drawing};

/// So few values are marked one by one.
const FEW: usize = 16;
/// Between the lines where two stretches of a whole begin there is at least this room, in points; else only wholes have lines.
const PARTS_PT: f32 = 5.0;
/// From the line where a stretch begins to its name, and from there to what comes next, in points.
const NAME_PT: f32 = 4.0;

/// What is plotted.
#[derive(Clone, Copy, Debug)]
pub struct Plotted<'a> {
    /// The lines.
    pub series: &'a Series,
    /// The estimator whose quantity it is; nothing where the title says so.
    pub whose: &'a str,
    /// Whether ten times as much is as far up everywhere, as long as all is more than nothing.
    pub logarithmic: bool,
}

/// Where the lines are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// The part inside the axes.
    pub rect: Rect,
    /// Of steps.
    pub x: Axis,
    /// Of values, or of their decimal logarithms.
    y: Axis,
    logarithmic: bool,
    small: f32,
    /// Whether the names of the lines have a row of their own below the title.
    is_named_below: bool,
}

/// Lays the plot out in `area`.
pub fn draw(data: Plotted<'_>, area: Rect, style: ChartStyle) -> Drawing<Plot> {
    let (series, theme) = (data.series, style.theme);
    let plot = Plot::new(data, area, theme);
    let mut canvas = Canvas::default();
    axes(&mut canvas, &plot, (series, area), theme);
    sections(&mut canvas, &plot, series, theme);
    for (_, role, points) in &series.lines {
        if are_marks(series, *role, points) {
            for &point in points {
                ring(&mut canvas, plot.at(point), theme.word(*role));
            }
        } else {
            line(&mut canvas, &plot, (*role, points), theme);
        }
    }
    let head = head(data, &plot, area, None, style);
    Drawing { place: plot, body: canvas.into_layers(), head }
}

/// What stands above the plot: what is plotted and the names of its lines, with their values at the step that is pointed at.
pub fn head(data: Plotted<'_>, plot: &Plot, area: Rect, pointed: Option<f32>, style: ChartStyle) -> Vec<Primitive> {
    let Plotted { series, .. } = data;
    let (theme, small) = (style.theme, plot.small);
    let text = Type::text(theme);
    let step = pointed.and_then(|x| nearest(series, x)).map(|x| (x, format!("{} {}", series.x_label, number(x))));
    let lines = series.lines.iter().map(|(name, role, points)| {
        let value = step.as_ref().and_then(|(x, _)| value(*role, points, *x));
        let value = value.map_or_else(String::new, |value| format!(" {}", number(value)));
        (format!("{name}{value}"), text.color(theme.word(*role)))
    });
    let title = (title(data, area, small), text);
    let mut canvas = Canvas::default();
    let upper = area.min[1] + 0.8 * small;
    let here = step.iter().map(|(_, words)| (words.clone(), text));
    let words: Vec<_> = here.chain(lines).collect();
    if plot.is_named_below {
        row(&mut canvas, &[title], (area, upper));
        row(&mut canvas, &words, (area, upper + 1.35 * small));
    } else {
        let all = [if pointed.is_some() { vec![] } else { vec![title] }, words].concat();
        row(&mut canvas, &all, (area, upper));
    }
    canvas.into_primitives()
}

/// Words beside each other, as far as they have room.
fn row(canvas: &mut Canvas, words: &[(String, Type)], (area, y): (Rect, f32)) {
    let mut x = area.min[0];
    for (words, style) in words {
        let words = shortened(words, *style, area.max[0] - x);
        x = canvas.text([x, y], (Anchor::Start, Level::Middle), &words, *style).max[0] + GAP_LETTERS * style.size;
    }
}

/// Between two names, in letters.
const GAP_LETTERS: f32 = 1.4;

/// What is plotted and in which unit; the unit is not told where it would repeat the title.
fn title(data: Plotted<'_>, area: Rect, small: f32) -> String {
    let Series { title, y_label, .. } = data.series;
    let what = match title.eq_ignore_ascii_case(y_label) {
        true => (*title).to_owned(),
        false => format!("{title}, {y_label}"),
    };
    super::titled(data.whose, &what, (small, area.size()[0]))
}

impl Plot {
    fn new(data: Plotted<'_>, area: Rect, theme: Theme) -> Self {
        let Plotted { series, logarithmic, .. } = data;
        let text = Type::text(theme);
        let small = text.size;
        // Beside the title there is room for the lines with their values, or they stand below it.
        let names = series.lines.iter().map(|(name, ..)| text.width(name) + (GAP_LETTERS + 3.0) * small).sum::<f32>();
        let title = text.width(&title(data, area, small)) + GAP_LETTERS * small;
        let is_named_below = title + names > area.size()[0];
        let above = if is_named_below { 3.4 } else { 2.2 } * small;
        let min = [area.min[0] + 4.6 * small, area.min[1] + above];
        let max = [area.max[0] - 2.0 * small, area.max[1] - 3.4 * small];
        let rect = Rect { min: min.map(f32::round), max: [0, 1].map(|i| max[i].max(min[i] + 8.0).round()) };
        // What was rejected may be anything: it does not set the scale, and stands at its edge where it is beyond.
        let rejected = series.lines.iter().filter(|(_, role, points)| are_marks(series, *role, points));
        let rejected: Vec<[f32; 2]> = rejected.flat_map(|(_, _, points)| points).copied().collect();
        let all = || series.lines.iter().flat_map(|(_, _, points)| points).filter(|p| p[1].is_finite());
        let counts = |point: &&[f32; 2]| !rejected.contains(point);
        let some = all().any(|point| counts(&point));
        let values = all().filter(|point| !some || counts(point)).map(|point| point[1]);
        let low = values.clone().fold(f32::INFINITY, f32::min);
        let high = values.fold(f32::MIN_POSITIVE, f32::max);
        let logarithmic = logarithmic && low > 0.0 && low.is_finite();
        let places = [rect.max[1], rect.min[1]];
        let linear = Axis { values: [low.min(0.0), high], places }.rounded(3.0 * small);
        // From one power of ten to another.
        let decades = [low.log10().floor(), high.log10().ceil().max(low.log10().floor() + 1.0)];
        Self {
            rect,
            x: Axis { values: [0.0, series.x_max.max(1) as f32], places: [rect.min[0], rect.max[0]] },
            y: if logarithmic { Axis { values: decades, places } } else { linear },
            logarithmic,
            small,
            is_named_below,
        }
    }

    /// Where a point of a line stands; beyond an end of the values at that end.
    pub fn at(&self, [x, y]: [f32; 2]) -> Point {
        let [low, high] = self.y.values;
        let y = if self.logarithmic { y.log10() } else { y };
        [self.x.place(x), self.y.place(y.clamp(low, high))]
    }

    /// The ticks of the values, each with its place on the axis.
    fn ticks(&self) -> Vec<(f32, f32)> {
        let smallest = if self.logarithmic { 1.0 } else { 0.0 };
        let value = |tick: f32| if self.logarithmic { 10f32.powf(tick) } else { tick };
        self.y.ticks(3.0 * self.small, smallest).into_iter().map(|tick| (value(tick), self.y.place(tick))).collect()
    }
}

fn axes(canvas: &mut Canvas, plot: &Plot, (series, area): (&Series, Rect), theme: Theme) {
    let (chrome, dim) = (theme.chrome(), Type::dim(theme));
    let Rect { min: [left, _], max: [right, bottom] } = plot.rect;
    for (tick, y) in plot.ticks() {
        canvas.across([left, right], y, chrome.line);
        canvas.text([left - 7.0, y], (Anchor::End, Level::Middle), &number(tick), dim);
    }
    canvas.across([left, right], bottom, chrome.dim);
    for tick in plot.x.ticks(5.0 * plot.small, 1.0) {
        let (x, words) = (plot.x.place(tick), number(tick));
        canvas.down(x, [bottom, bottom + 4.0], chrome.dim);
        let x = x.min(area.max[0] - dim.width(&words) / 2.0);
        canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &words, dim);
    }
    let below = [right, bottom + 6.0 + 1.25 * plot.small];
    canvas.text(below, (Anchor::End, Level::Top), series.x_label, Type::text(theme));
}

/// Where something else is at hand from then on: a line, longer where a whole begins, with its name if there is room for that.
fn sections(canvas: &mut Canvas, plot: &Plot, series: &Series, theme: Theme) {
    let (chrome, dim) = (theme.chrome(), Type::dim(theme));
    let Rect { min: [_, top], max: [right, bottom] } = plot.rect;
    let places: Vec<_> = series.sections.iter().map(|section| (plot.x.place(section.from), section.is_part)).collect();
    let widths: Vec<_> = series.sections.iter().map(|section| dim.width(&section.label)).collect();
    let are_apart = places.windows(2).all(|pair| pair[1].0 - pair[0].0 >= PARTS_PT);
    let named = named(&places, &widths, right);
    for ((section, (x, is_part)), is_named) in series.sections.iter().zip(&places).zip(named) {
        if *is_part && !are_apart {
            continue;
        }
        let from = if *is_part { top + 1.5 * plot.small } else { top };
        canvas.down(*x, [from, bottom], chrome.line.mix(chrome.dim, 0.4));
        if is_named {
            canvas.text([x + NAME_PT, top], (Anchor::Start, Level::Top), &section.label, dim);
        }
    }
}

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

/// A circle of lines, so that what it marks is seen through it.
fn ring(canvas: &mut Canvas, [x, y]: Point, color: super::super::Color) {
    let points = (0..16).map(|i| {
        let (sin, cos) = (i as f32 / 16.0 * std::f32::consts::TAU).sin_cos();
        [x + 4.0 * cos, y + 4.0 * sin]
    });
    canvas.line(points.collect(), true, solid(1.5, color));
}

/// A line in its role's color. A best value holds until it is beaten: it goes in steps.
fn line(canvas: &mut Canvas, plot: &Plot, (role, points): (Role, &[[f32; 2]]), theme: Theme) {
    let color = theme.word(role);
    let holds = role == Role::Best;
    let ink = theme.ink(role);
    let width = ink.width * if holds { 1.0 } else { 0.6 };
    let stroke = Stroke { width, color: if holds { color } else { color.alpha(217) }, dash: ink.dash };
    let mut last = None;
    for run in points.split(|point| point[1].is_nan()).filter(|run| !run.is_empty()) {
        let run = if holds { steps(run) } else { thinned(run, plot) };
        let places: Vec<Point> = run.iter().map(|&point| plot.at(point)).collect();
        if places.len() == 1 || points.len() <= FEW && !holds {
            places.iter().for_each(|&place| canvas.disc(place, 1.0 + width, color));
        }
        last = places.last().copied();
        canvas.line(places, false, stroke);
    }
    let Some(last) = last else { return };
    canvas.disc(last, 3.0 + width, theme.chrome().panel);
    canvas.disc(last, 2.0 + width, color);
}

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

/// At most two points for every point of the sheet: the smallest and the largest there.
fn thinned(points: &[[f32; 2]], plot: &Plot) -> Vec<[f32; 2]> {
    if points.len() < 2 * plot.rect.size()[0] as usize {
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
pub fn nearest(series: &Series, x: f32) -> Option<f32> {
    let all = series.lines.iter().flat_map(|(_, _, points)| points).map(|point| point[0]);
    all.min_by(|a, b| (a - x).abs().total_cmp(&(b - x).abs()))
}

/// The event at which the step `x` came.
pub fn event(series: &Series, x: f32) -> Option<usize> {
    series.events.get((x as usize).checked_sub(1)?).copied()
}

/// The value of a line at `x`: a best value holds, others are known only at their points.
fn value(role: Role, points: &[[f32; 2]], x: f32) -> Option<f32> {
    let before = points.partition_point(|point| point[0] <= x).checked_sub(1)?;
    let [at, value] = points[before];
    (at == x || role == Role::Best).then_some(value).filter(|value| !value.is_nan())
}

/// The last values of all lines, in words.
pub fn summary(series: &Series) -> String {
    let last = series.lines.iter().filter_map(|(name, _, points)| {
        let known = points.iter().rev().find(|point| !point[1].is_nan());
        known.map(|[x, y]| format!(", {name} {} at {} {}", number(*y), series.x_label, number(*x)))
    });
    format!("{}, {}{}", series.title, series.y_label, last.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::super::super::ColorMap;
    use super::super::{flat, texts};
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

    fn plotted(series: &Series, logarithmic: bool) -> Plotted<'_> {
        Plotted { series, whose: "Full search", logarithmic }
    }

    fn plot(series: &Series) -> Plot {
        Plot::new(plotted(series, false), Rect::new([0.0; 2], [400.0, 200.0]), Theme::Dark)
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn a_line_passes_through_its_data() {
        let series = series(10);
        let drawing = draw(plotted(&series, false), Rect::new([0.0; 2], [400.0, 200.0]), style());
        let plot = drawing.place.clone();
        let primitives = flat(drawing);
        let mut lines = primitives.iter().filter_map(|primitive| match primitive {
            Primitive::Polyline { points, .. } => Some(points),
            _ => None,
        });
        let places: Vec<_> = series.lines[0].2.iter().map(|&point| plot.at(point)).collect();
        assert!(lines.any(|points| *points == places), "the candidates' costs are one line");
        let words = texts(&primitives);
        for label in ["Full search · Cost by candidate, SAD", "candidate", "best so far", "0", "1000"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
    }

    #[test]
    fn a_unit_that_repeats_the_title_is_left_out() {
        let mut series = series(3);
        (series.title, series.y_label) = ("Objects", "objects");
        let wide = Rect::new([0.0; 2], [600.0, 200.0]);
        let told = title(Plotted { series: &series, whose: "Blob tracker", logarithmic: false }, wide, 12.0);
        assert_eq!(told, "Blob tracker · Objects");
    }

    #[test]
    fn the_values_of_a_step_stand_beside_the_names() {
        let series = series(10);
        let area = Rect::new([0.0; 2], [400.0, 200.0]);
        let drawing = draw(plotted(&series, false), area, style());
        let words = texts(&head(plotted(&series, false), &drawing.place, area, Some(3.2), style()));
        assert!(words.contains(&"candidate 3".into()) && words.contains(&"best so far 511".into()), "{words:?}");
    }

    #[test]
    fn the_axes_hold_every_value_and_do_not_jump() {
        let (few, many) = (series(10), series(1089));
        let (a, b) = (plot(&few), plot(&many));
        assert_eq!(a.x, b.x);
        assert_eq!(a.y.values, b.y.values, "the top is a round number");
        for [_, y] in &many.lines[0].2 {
            assert!((b.rect.min[1]..=b.rect.max[1]).contains(&b.y.place(*y)));
        }
    }

    #[test]
    fn a_logarithmic_axis_goes_by_powers_of_ten() {
        let mut series = series(3);
        series.lines[0].2 = vec![[4.0, 13.0], [8.0, 81.0], [16.0, 4225.0]];
        let area = Rect::new([0.0; 2], [400.0, 200.0]);
        let plot = Plot::new(plotted(&series, true), area, Theme::Dark);
        assert_eq!(plot.ticks().iter().map(|tick| tick.0.round()).collect::<Vec<_>>(), [10.0, 100.0, 1000.0, 10000.0]);
        let up = |y| plot.at([4.0, y])[1];
        assert!((up(10.0) - up(100.0) - (up(100.0) - up(1000.0))).abs() < 1e-3 && up(10.0) > up(100.0));
        series.lines[0].2.push([32.0, 0.0]);
        assert!(!Plot::new(plotted(&series, true), area, Theme::Dark).logarithmic, "nothing has no logarithm");
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
