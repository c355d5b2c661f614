//! A quantity over steps, as lines.

mod direct;
mod head;

pub use head::head;
use head::{GAP_LETTERS, ROW, band_color, band_name, figure, title};
use motionscope_core::scene::{Band, Role, Series};

use super::super::primitive::{Anchor, Point, Primitive, Rect, Stroke};
use super::super::{Color, Face, Theme, labels, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, THRESHOLD, Type, solid};
use super::{ChartStyle, Drawing, cells};

/// So few values are marked one by one.
const FEW: usize = 16;
/// Between the lines where two stretches of a whole begin there is at least this room, in points; else only wholes have lines.
const PARTS_PT: f32 = 5.0;
/// From the line where a stretch begins to its name, and from there to what comes next, in points.
const NAME_PT: f32 = 4.0;
/// Letters of height that the lines and the numbers below them need at least: only what is more goes to further rows of names.
const TIGHTEST: f32 = 8.5;

/// Nearest that one can come: what is seen at first is at most so many times as wide.
const NEAREST: f32 = 256.0;
/// Half the width of a band that holds at one x, at least, in points.
const LEAST_HALF: f32 = 6.0;
/// From the numbers of the axis of values to the axis, in points.
const TICK_GAP: f32 = 7.0;
/// Half the width of the arrow that stands for a value beyond the edge, in points.
const ARROW: f32 = 4.0;

/// What is plotted.
#[derive(Clone, Copy, Debug)]
pub struct Plotted<'a> {
    /// The lines.
    pub series: &'a Series,
    /// The estimator whose quantity it is; nothing where the title says so.
    pub whose: &'a str,
    /// Whether ten times as much is as far up everywhere, as long as all is more than nothing.
    pub logarithmic: bool,
    /// Which part is seen; all of it unless one came nearer.
    pub window: Option<Window>,
}

/// A part of a plot: values at the ends of both axes, those of y as logarithms where its axis has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Steps.
    pub x: [f32; 2],
    /// Values.
    pub y: [f32; 2],
}

impl Window {
    /// After coming nearer by `factor` to what stands at `at`, which stays where it is as far as `whole` allows.
    #[must_use]
    pub fn nearer(self, at: [f32; 2], factor: f32, whole: Window) -> Self {
        let zoomed = |[low, high]: [f32; 2], at: f32, whole: [f32; 2]| {
            let most = whole[1] - whole[0];
            let length = ((high - low) / factor).clamp(most / NEAREST, most);
            let share = length / (high - low);
            shifted([at + (low - at) * share, at + (low - at) * share + length], whole)
        };
        Self { x: zoomed(self.x, at[0], whole.x), y: zoomed(self.y, at[1], whole.y) }
    }

    /// After going `by` further along both axes, not beyond `whole`.
    #[must_use]
    pub fn moved(self, by: [f32; 2], whole: Window) -> Self {
        let moved = |ends: [f32; 2], by: f32, whole| shifted(ends.map(|end| end + by), whole);
        Self { x: moved(self.x, by[0], whole.x), y: moved(self.y, by[1], whole.y) }
    }
}

/// The same length inside `whole`.
fn shifted([low, high]: [f32; 2], whole: [f32; 2]) -> [f32; 2] {
    let by = (whole[0] - low).max(0.0) + (whole[1] - high).min(0.0);
    [low + by, high + by]
}

/// Where the lines are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// The part inside the axes.
    pub rect: Rect,
    /// Of steps.
    pub x: Axis,
    /// Of values, or of their decimal logarithms.
    pub y: Axis,
    /// What is seen at first.
    pub whole: Window,
    /// Whether the axis of values has logarithms.
    pub logarithmic: bool,
    /// Whether the values are counts, which have no parts.
    has_counts: bool,
    small: f32,
    /// Rows above for the title and the names of the lines.
    rows: usize,
    /// Whether the title has the first of them for itself.
    is_named_below: bool,
    /// Whether lines and thresholds carry their names.
    is_direct: bool,
    /// Whether what runs along x shares the row of its numbers.
    is_tight: bool,
    /// Whether the sections are plots of their own, without a common axis of steps.
    pub is_divided: bool,
}

/// Lays the plot out in `area`.
pub fn draw(data: Plotted<'_>, area: Rect, style: ChartStyle) -> Drawing<Plot> {
    let (series, theme) = (data.series, style.theme);
    let plot = Plot::new(data, area, theme);
    let mut canvas = Canvas::default();
    if let Some(columns) = series.columns.filter(|_| plot.is_divided) {
        plot.divided(&mut canvas, (series, columns), area, theme);
        let head = head(data, &plot, area, None, style);
        return Drawing { place: plot, body: canvas.into_layers(), head };
    }
    canvas.inside(plot.rect, |canvas| bands(canvas, &plot, series, theme));
    axes(&mut canvas, &plot, (series, area), theme);
    sections(&mut canvas, &plot, series, theme);
    if let Some(x) = series.now().filter(|x| plot.shows(*x)) {
        canvas.down(plot.x.place(x), [plot.rect.min[1], plot.rect.max[1]], theme.chrome().dim);
    }
    // Marks at the ends of the axes stay whole.
    canvas.inside(plot.rect.grown(6.0), |canvas| {
        for (_, role, points) in &series.lines {
            if are_marks(series, *role, points) {
                let inside = points.iter().filter(|point| plot.beyond(**point).is_none() && plot.shows(point[0]));
                inside.for_each(|&point| ring(canvas, plot.at(point), theme.stroke(*role)));
            } else {
                line(canvas, &plot, (*role, points), (theme, series.chosen));
            }
        }
    });
    for (_, role, points) in &series.lines {
        clipped(&mut canvas, &plot, points, theme.stroke(*role));
    }
    if plot.is_direct {
        direct::names(&mut canvas, &plot, series, theme);
    }
    if !has_values(series) {
        let middle = [0, 1].map(|i| (plot.rect.min[i] + plot.rect.max[i]) / 2.0);
        canvas.text(middle, (Anchor::Middle, Level::Middle), "No value yet: step on.", Type::dim(theme));
    }
    let head = head(data, &plot, area, None, style);
    Drawing { place: plot, body: canvas.into_layers(), head }
}

/// Whether a value is known: without any there is nothing to plot.
pub fn has_values(series: &Series) -> bool {
    series.lines.iter().flat_map(|(.., points)| points).any(|point| point[1].is_finite())
}

impl Plot {
    fn new(data: Plotted<'_>, area: Rect, theme: Theme) -> Self {
        let Plotted { series, logarithmic, .. } = data;
        let text = Type::text(theme);
        let small = text.size;
        let is_direct = direct::has_room(series, area, small);
        // Beside the title there is room for the lines with their values, or they stand below it.
        let value = |entry: &head::Entry| if entry.swatch.is_none() { 3.0 * small } else { 0.0 };
        let names = if is_direct { head::other_names(series, theme) } else { head::names(series, None, theme) };
        let names = names.iter().map(|entry| entry.width() + value(entry)).sum::<f32>();
        let title = text.width(&title(data, area, small)) + GAP_LETTERS * small;
        let (is_tight, width) = (super::is_tight(area, small), area.size()[0]);
        let most = ((area.size()[1] / small - TIGHTEST) / ROW).clamp(1.0, 4.0) as usize;
        let is_named_below = most > 1 && title + names > width;
        let rows = if is_named_below { (1 + (names / width).ceil() as usize).min(most) } else { 1 };
        let are_sections_named = !is_tight && series.sections.iter().any(|section| !section.label.is_empty());
        let above = (0.85 + ROW * rows as f32 + if are_sections_named { 1.25 } else { 0.0 }) * small;
        let min = [area.min[0] + 4.6 * small, area.min[1] + above];
        let max = [area.max[0] - 2.0 * small, area.max[1] - if is_tight { 1.9 } else { 3.4 } * small];
        let rect = Rect { min: min.map(f32::round), max: [0, 1].map(|i| max[i].max(min[i] + 8.0).round()) };
        // What was rejected may be anything: it does not set the scale, and stands at its edge where it is beyond.
        let rejected = series.lines.iter().filter(|(_, role, points)| are_marks(series, *role, points));
        let rejected: Vec<[f32; 2]> = rejected.flat_map(|(_, _, points)| points).copied().collect();
        let all = || series.lines.iter().flat_map(|(_, _, points)| points).filter(|p| p[1].is_finite());
        let counts = |point: &&[f32; 2]| !rejected.contains(point);
        let some = all().any(|point| counts(&point));
        let named = series.bands.iter().flat_map(|band| band.values).chain(series.thresholds.iter().map(|(_, at)| *at));
        let values = all().filter(|point| !some || counts(point)).map(|point| point[1]);
        let values = values.chain(named.filter(|value| !logarithmic || *value > 0.0));
        let low = values.clone().fold(f32::INFINITY, f32::min);
        let high = values.fold(f32::MIN_POSITIVE, f32::max);
        let logarithmic = logarithmic && low > 0.0 && low.is_finite();
        let places = [rect.max[1], rect.min[1]];
        let low_end = if series.fits_values && low.is_finite() { low } else { low.min(0.0) };
        let linear = Axis::new([low_end, high], places).rounded(3.0 * small);
        // From one power of ten to another.
        let decades = [low.log10().floor(), high.log10().ceil().max(low.log10().floor() + 1.0)];
        // A stretch far from the first step begins where its data do.
        let (end, first) = (series.x_max.max(1) as f32, all().map(|point| point[0]).fold(f32::INFINITY, f32::min));
        let has_logarithmic_x = series.has_logarithmic_x && first > 0.0 && first < end;
        let is_far = first.is_finite() && first > 0.2 * end && first < end;
        let start = if has_logarithmic_x || is_far { first } else { 0.0 };
        let whole = Window { x: [start, end], y: if logarithmic { decades } else { linear.values } };
        let window = data.window.unwrap_or(whole);
        let plot = Self {
            rect,
            x: Axis { is_logarithmic: has_logarithmic_x, ..Axis::new(window.x, [rect.min[0], rect.max[0]]) },
            y: Axis::new(window.y, places),
            whole,
            logarithmic,
            has_counts: series.decimals == Some(0),
            small,
            rows,
            is_named_below,
            is_direct,
            is_tight,
            is_divided: series.columns.is_some() && has_values(series),
        };
        plot.with_room_for_labels(area, text)
    }

    /// The same with the axis of values further right where its numbers are long.
    fn with_room_for_labels(self, area: Rect, text: Type) -> Self {
        let widest = self.tick_labels().iter().map(|(words, _)| text.width(words)).fold(0.0, f32::max);
        let least = area.min[0] + widest + TICK_GAP + 2.0;
        if least <= self.rect.min[0] {
            return self;
        }
        let left = least.min(area.min[0] + 0.4 * area.size()[0]).min(self.rect.max[0] - 8.0).round();
        let left = left.max(self.rect.min[0]);
        let rect = Rect { min: [left, self.rect.min[1]], ..self.rect };
        Self { rect, x: Axis { places: [left, self.x.places[1]], ..self.x }, ..self }
    }

    /// Draws the sections as plots of their own, and below them what they run along.
    fn divided(&self, canvas: &mut Canvas, (series, columns): (&Series, usize), area: Rect, theme: Theme) {
        let (text, small) = (Type::text(theme), self.small);
        let top = self.rect.min[1] - if self.is_tight { 0.0 } else { 1.25 * small };
        let inside = Rect { min: [self.rect.min[0], top], max: [self.rect.max[0], area.max[1] - 1.6 * small] };
        cells::draw(canvas, (series, columns), (inside, &self.y), theme);
        let at = [inside.max[0], inside.max[1] + 0.2 * small];
        canvas.text(at, (Anchor::End, Level::Top), series.x_label, text);
    }

    /// Whether a step lies between the ends of its axis.
    fn shows(&self, x: f32) -> bool {
        (self.x.values[0]..=self.x.values[1]).contains(&x)
    }

    /// A value on the axis.
    fn up(&self, y: f32) -> f32 {
        if self.logarithmic { y.log10() } else { y }
    }

    /// Beyond which end of the values a point lies, if beyond one: the place of that end.
    fn beyond(&self, [_, y]: [f32; 2]) -> Option<f32> {
        let ([low, high], y) = (self.y.values, self.up(y));
        // What was rounded on its way is not beyond.
        let slack = 1e-4 * (high - low);
        if y < low - slack {
            Some(self.y.places[0])
        } else if y > high + slack {
            Some(self.y.places[1])
        } else {
            None
        }
    }

    /// Where a point of a line stands; far beyond an end of the values, a little beyond that end.
    pub fn at(&self, [x, y]: [f32; 2]) -> Point {
        let [low, high] = self.y.values;
        let span = high - low;
        [self.x.place(x), self.y.place(self.up(y).clamp(low - span, high + span))]
    }

    /// The numbers at the axis of values, each with its place.
    fn tick_labels(&self) -> Vec<(String, f32)> {
        let (values, places): (Vec<f32>, Vec<f32>) = self.ticks().into_iter().unzip();
        // Powers of ten have as many decimals as each needs: 0.001.
        let words =
            if self.logarithmic { values.iter().flat_map(|tick| labels(&[*tick])).collect() } else { labels(&values) };
        words.into_iter().zip(places).collect()
    }

    /// The ticks of the values, each with its place on the axis.
    fn ticks(&self) -> Vec<(f32, f32)> {
        let smallest = if self.logarithmic || self.has_counts { 1.0 } else { 0.0 };
        let value = |tick: f32| if self.logarithmic { 10f32.powf(tick) } else { tick };
        self.y.ticks(3.0 * self.small, smallest).into_iter().map(|tick| (value(tick), self.y.place(tick))).collect()
    }
}

/// Where values are expected to lie, and limits.
fn bands(canvas: &mut Canvas, plot: &Plot, series: &Series, theme: Theme) {
    let Rect { min: [left, top], max: [right, bottom] } = plot.rect;
    let place = |value: f32| plot.at([0.0, value])[1].clamp(top, bottom);
    for Band { values: [low, high], at, .. } in &series.bands {
        let ends = match at {
            None => [left, right],
            Some(x) if plot.shows(*x) => beside(plot, *x),
            Some(_) => continue,
        };
        let rect = Rect::between([ends[0], place(*high)], [ends[1], place(*low)]);
        canvas.fill(rect, band_color(theme));
        for edge in [*low, *high].into_iter().filter(|edge| plot.beyond([0.0, *edge]).is_none()) {
            canvas.across(ends, place(edge), theme.word(Role::Window).alpha(150));
        }
    }
    let color = theme.stroke(Role::Rejected);
    for (_, value) in series.thresholds.iter().filter(|(_, value)| plot.beyond([0.0, *value]).is_none()) {
        let y = place(*value);
        canvas.line(vec![[left, y], [right, y]], false, Stroke { dash: THRESHOLD, ..solid(1.5, color) });
    }
}

/// The ends of a band that holds at `x` alone: half a step to either side, and wide enough to be seen.
fn beside(plot: &Plot, x: f32) -> [f32; 2] {
    let Rect { min: [left, _], max: [right, _] } = plot.rect;
    let (at, half) = (plot.x.place(x), 0.5 * (plot.x.place(x) - plot.x.place(x - 1.0)).abs());
    let half = if half.is_finite() { half.max(LEAST_HALF) } else { LEAST_HALF };
    [(at - half).max(left), (at + half).min(right)]
}

/// Arrows at the edge for values beyond it, as far as they do not stand on each other.
fn clipped(canvas: &mut Canvas, plot: &Plot, points: &[[f32; 2]], color: Color) {
    let mut taken = [f32::NEG_INFINITY; 2];
    let known = points.iter().filter(|point| !point[1].is_nan() && plot.shows(point[0]));
    for point in known {
        let Some(edge) = plot.beyond(*point) else { continue };
        let (x, is_up) = (plot.x.place(point[0]), edge == plot.y.places[1]);
        let taken = &mut taken[usize::from(is_up)];
        if x - *taken < 2.0 * ARROW {
            continue;
        }
        *taken = x;
        let foot = if is_up { edge + 2.0 * ARROW } else { edge - 2.0 * ARROW };
        canvas.add(Primitive::Polygon { points: vec![[x, edge], [x + ARROW, foot], [x - ARROW, foot]], color });
    }
}

fn axes(canvas: &mut Canvas, plot: &Plot, (series, area): (&Series, Rect), theme: Theme) {
    let (chrome, dim) = (theme.chrome(), Type::dim(theme));
    let Rect { min: [left, _], max: [right, bottom] } = plot.rect;
    for (words, y) in plot.tick_labels() {
        canvas.across([left, right], y, chrome.line);
        canvas.text([left - TICK_GAP, y], (Anchor::End, Level::Middle), &words, dim);
    }
    canvas.across([left, right], bottom, chrome.dim);
    let below = bottom + 6.0 + if plot.is_tight { 0.0 } else { 1.25 * plot.small };
    let name = canvas.text([right, below], (Anchor::End, Level::Top), series.x_label, Type::text(theme));
    let has_room = |right: f32| !plot.is_tight || right + 0.5 * plot.small < name.min[0];
    // The step at hand is told first; ticks have what room it leaves.
    let bold = Type::text(theme).face(Face::Bold);
    let now = series.now().filter(|x| plot.shows(*x)).map(|now| {
        let half = bold.width(&number(now)) / 2.0;
        (now, plot.x.place(now).min(area.max[0] - half), half)
    });
    let now = now.filter(|(_, x, half)| has_room(x + half));
    if let Some((now, x, _)) = now {
        canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &number(now), bold);
    }
    let ticks = match plot.x.is_logarithmic {
        _ if !series.x_ticks.is_empty() => series.x_ticks.iter().copied().filter(|x| plot.shows(*x)).collect(),
        // Each value that was swept: they are equally far apart.
        true => swept(series, plot),
        false => plot.x.ticks(5.0 * plot.small, if series.is_sweep { 0.0 } else { 1.0 }),
    };
    let words = if plot.x.is_logarithmic { ticks.iter().map(|tick| number(*tick)).collect() } else { labels(&ticks) };
    for (tick, words) in ticks.into_iter().zip(words) {
        let x = plot.x.place(tick);
        canvas.down(x, [bottom, bottom + 4.0], chrome.dim);
        let half = dim.width(&words) / 2.0;
        let x = x.min(area.max[0] - half);
        let is_clear = now.is_none_or(|(_, at, wide)| (x - at).abs() > half + wide + 0.4 * plot.small);
        if is_clear && has_room(x + half) {
            canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &words, dim);
        }
    }
}

/// The values of x that have a point in sight, each once.
fn swept(series: &Series, plot: &Plot) -> Vec<f32> {
    let all = series.lines.iter().flat_map(|(.., points)| points).map(|point| point[0]);
    let mut all: Vec<f32> = all.filter(|x| plot.shows(*x)).collect();
    all.sort_by(f32::total_cmp);
    all.dedup();
    all
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
        if *is_part && !are_apart || !plot.shows(section.from) {
            continue;
        }
        // Names stand above, where they cover no line.
        let from = if *is_part || plot.is_tight { top } else { top - 1.1 * plot.small };
        canvas.down(*x, [from, bottom], chrome.line.mix(chrome.dim, 0.4));
        if is_named && !plot.is_tight {
            let at = [x + NAME_PT, top - 0.15 * plot.small];
            canvas.text(at, (Anchor::Start, Level::Bottom), &section.label, dim);
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

/// Whether all points mark values of another line that were rejected: these have nothing between them.
fn are_marks(series: &Series, role: Role, points: &[[f32; 2]]) -> bool {
    let Some(first) = points.first().filter(|_| role == Role::Rejected) else { return false };
    let all_on = |line: &[[f32; 2]]| line.contains(first) && points.iter().all(|point| line.contains(point));
    series.lines.iter().any(|(_, other, line)| *other != role && all_on(line))
}

/// A circle of lines, so that what it marks is seen through it.
fn ring(canvas: &mut Canvas, [x, y]: Point, color: Color) {
    let points = (0..16).map(|i| {
        let (sin, cos) = (i as f32 / 16.0 * std::f32::consts::TAU).sin_cos();
        [x + 4.0 * cos, y + 4.0 * sin]
    });
    canvas.line(points.collect(), true, solid(1.5, color));
}

/// A line in its role's color, with a disc at its last point, or at the value of x that is set. A best value holds until it is beaten: it goes
/// in steps.
fn line(canvas: &mut Canvas, plot: &Plot, (role, points): (Role, &[[f32; 2]]), (theme, chosen): (Theme, Option<f32>)) {
    let color = theme.stroke(role);
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
    let set =
        chosen.map(|x| points.iter().find(|point| point[0] == x && !point[1].is_nan()).map(|point| plot.at(*point)));
    let Some(last) = set.unwrap_or(last) else { return };
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

/// The values of all lines at `x`, with their roles.
pub fn values(series: &Series, x: f32) -> Vec<(Role, f32)> {
    series.lines.iter().filter_map(|(_, role, points)| Some((*role, value(*role, points, x)?))).collect()
}

/// The last values of all lines, in words.
pub fn summary(series: &Series) -> String {
    let last = series.lines.iter().filter_map(|(name, _, points)| {
        let known = points.iter().rev().find(|point| !point[1].is_nan());
        known.map(|[x, y]| format!(", {name} {} at {} {}", figure(series, *y), series.x_label, number(*x)))
    });
    let bands = series.bands.iter().map(|band| format!(", {}", band_name(band)));
    let thresholds = series.thresholds.iter().map(|(name, value)| format!(", {name} {}", figure(series, *value)));
    let named: String = last.chain(bands).chain(thresholds).collect();
    format!("{}, {}{named}", series.title, series.y_label)
}

#[cfg(test)]
mod tests;
