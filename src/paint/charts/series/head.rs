//! What stands above a plot: what is plotted, and the names of its lines, bands and thresholds with their values.

use motionscope_core::base::words::fixed;
use motionscope_core::scene::{Band, Role, Series};

use super::{ARROW, Plot, Plotted, are_marks, nearest, ring, value};
use crate::paint::charts::canvas::{Canvas, Level, THRESHOLD, Type, shortened, solid};
use crate::paint::charts::{self, ChartStyle};
use crate::paint::primitive::{Anchor, Primitive, Rect, Stroke};
use crate::paint::{Color, Theme, number};

/// Words above a plot, with the color that they explain if it is no line.
#[derive(Clone)]
pub(super) struct Entry {
    pub(super) words: String,
    pub(super) style: Type,
    pub(super) swatch: Option<Swatch>,
}

/// What stands before a name that is not that of a line.
#[derive(Clone, Copy)]
pub(super) enum Swatch {
    Band(Color),
    Threshold(Color),
    /// The circle around rejected values.
    Ring(Color),
    /// The arrow of a value beyond the axis.
    Beyond(Color),
}

impl Entry {
    fn new(words: impl Into<String>, style: Type) -> Self {
        Self { words: words.into(), style, swatch: None }
    }

    /// Width with its swatch and the gap behind it.
    pub(super) fn width(&self) -> f32 {
        let swatch = if self.swatch.is_some() { SWATCH_LETTERS * self.style.size } else { 0.0 };
        swatch + self.style.width(&self.words) + GAP_LETTERS * self.style.size
    }
}

/// What stands above the plot: what is plotted and the names of its lines, with their values at the step that is pointed at
/// or else at hand, and those of its bands and thresholds.
pub fn head(data: Plotted<'_>, plot: &Plot, area: Rect, pointed: Option<f32>, style: ChartStyle) -> Vec<Primitive> {
    let Plotted { series, .. } = data;
    let (theme, small) = (style.theme, plot.small);
    let text = Type::text(theme);
    let pointed = pointed.and_then(|x| nearest(series, x));
    let title = Entry::new(title(data, area, small), text);
    let here = pointed.map(|x| Entry::new(format!("{} {}", series.x_label, number(x)), text));
    let at_hand = pointed.or(series.now());
    let names =
        if plot.is_direct && pointed.is_none() { other_names(series, theme) } else { names(series, at_hand, theme) };
    let names = here.iter().cloned().chain(names);
    let is_beyond = |point: &[f32; 2]| plot.shows(point[0]) && plot.beyond(*point).is_some();
    let beyond = series.lines.iter().find(|(.., points)| points.iter().any(is_beyond));
    let names = names.chain(beyond.map(|(_, role, _)| Entry {
        swatch: Some(Swatch::Beyond(theme.stroke(*role))),
        ..Entry::new("beyond the axis", text.color(theme.chrome().dim))
    }));
    let mut rows: Vec<Vec<Entry>> = Vec::new();
    if plot.is_named_below {
        rows.push(vec![title]);
        rows.push(Vec::new());
    } else {
        rows.push(if here.is_some() { vec![] } else { vec![title] });
    }
    for name in names {
        let used: f32 = rows.last().iter().flat_map(|row| row.iter()).map(Entry::width).sum();
        if used > 0.0 && used + name.width() - GAP_LETTERS * small > area.size()[0] && rows.len() < plot.rows {
            rows.push(Vec::new());
        }
        rows.last_mut().into_iter().for_each(|row| row.push(name.clone()));
    }
    let mut canvas = Canvas::default();
    for (i, entries) in rows.iter().enumerate() {
        row(&mut canvas, entries, (area, area.min[1] + (0.8 + ROW * i as f32) * small), theme);
    }
    canvas.into_primitives()
}

/// The names of lines with their values at `x`, of bands and of thresholds.
pub(super) fn names(series: &Series, x: Option<f32>, theme: Theme) -> Vec<Entry> {
    let lines = series.lines.iter().map(|line| line_name(series, line, x, theme));
    let thresholds = series.thresholds.iter().map(|threshold| Entry {
        swatch: Some(Swatch::Threshold(theme.stroke(Role::Rejected))),
        ..threshold_name(series, threshold, theme)
    });
    lines.chain(bands(series, theme)).chain(thresholds).collect()
}

/// The names of what does not carry its own where lines and thresholds do: of marked values and of bands.
pub(super) fn other_names(series: &Series, theme: Theme) -> Vec<Entry> {
    let marks = series.lines.iter().filter(|(_, role, points)| are_marks(series, *role, points));
    marks.map(|line| line_name(series, line, None, theme)).chain(bands(series, theme)).collect()
}

/// The name of a line with its value at `x`, or of the values that are marked.
pub(super) fn line_name(
    series: &Series,
    (name, role, points): &(&str, Role, Vec<[f32; 2]>),
    x: Option<f32>,
    theme: Theme,
) -> Entry {
    let value = x.and_then(|x| value(*role, points, x));
    let value = value.map_or_else(String::new, |value| format!(" {}", figure(series, value)));
    let swatch = are_marks(series, *role, points).then(|| Swatch::Ring(theme.stroke(*role)));
    Entry { swatch, ..Entry::new(format!("{name}{value}"), Type::text(theme).color(theme.word(*role))) }
}

/// The name of a threshold with its value.
pub(super) fn threshold_name(series: &Series, (name, value): &(String, f32), theme: Theme) -> Entry {
    Entry::new(format!("{name} {}", figure(series, *value)), Type::dim(theme))
}

fn bands(series: &Series, theme: Theme) -> impl Iterator<Item = Entry> {
    series.bands.iter().map(move |band| Entry {
        swatch: Some(Swatch::Band(band_color(theme))),
        ..Entry::new(band_name(band), Type::dim(theme))
    })
}

/// A value in words, with the decimals of its quantity.
pub(super) fn figure(series: &Series, value: f32) -> String {
    series.decimals.map_or_else(|| number(value), |decimals| fixed(f64::from(value), decimals))
}

/// A band in words: `95 % band 0.05 to 7.38`.
pub(super) fn band_name(Band { name, values: [low, high], .. }: &Band) -> String {
    let short = |v: f32| {
        let shown = number((v * 100.0).round() / 100.0);
        if shown.contains('.') { shown.trim_end_matches('0').trim_end_matches('.').to_owned() } else { shown }
    };
    format!("{name} {} to {}", short(*low), short(*high))
}

pub(super) fn band_color(theme: Theme) -> Color {
    let chrome = theme.chrome();
    chrome.panel.mix(theme.word(Role::Window), 0.16)
}

/// Entries beside each other, shortened at the end of the row.
fn row(canvas: &mut Canvas, entries: &[Entry], (area, y): (Rect, f32), theme: Theme) {
    let mut x = area.min[0];
    for Entry { words, style, swatch } in entries {
        let size = style.size;
        let start = if swatch.is_some() { x + SWATCH_LETTERS * size } else { x };
        let words = shortened(words, *style, area.max[0] - start);
        if words.is_empty() {
            break;
        }
        let sample = Rect::between([x, y - 0.4 * size], [start - 0.4 * size, y + 0.4 * size]);
        match swatch {
            Some(Swatch::Band(color)) => {
                canvas.fill(sample, *color);
                canvas.frame(sample, 1.0, theme.chrome().dim);
            }
            Some(Swatch::Ring(color)) => ring(canvas, [sample.min[0] + 5.0, y], *color),
            Some(Swatch::Beyond(color)) => {
                let [x, y] = [sample.min[0] + ARROW, y - ARROW];
                let points = vec![[x, y], [x + ARROW, y + 2.0 * ARROW], [x - ARROW, y + 2.0 * ARROW]];
                canvas.add(Primitive::Polygon { points, color: *color });
            }
            Some(Swatch::Threshold(color)) => {
                let ends = vec![[sample.min[0], y], [sample.max[0], y]];
                canvas.line(ends, false, Stroke { dash: THRESHOLD, ..solid(1.5, *color) });
            }
            None => {}
        }
        x = canvas.text([start, y], (Anchor::Start, Level::Middle), &words, *style).max[0] + GAP_LETTERS * size;
    }
}

/// Between two names, in letters.
pub(super) const GAP_LETTERS: f32 = 1.4;
/// Room for what stands before the name of a band.
const SWATCH_LETTERS: f32 = 1.7;
/// From one row of names to the next.
pub(super) const ROW: f32 = 1.35;
/// What is plotted and in which unit; the unit is not told where it would repeat the title.
pub(super) fn title(data: Plotted<'_>, area: Rect, small: f32) -> String {
    let Series { title, y_label, .. } = data.series;
    let what = match title.eq_ignore_ascii_case(y_label) {
        true => (*title).to_owned(),
        false => format!("{title}, {y_label}"),
    };
    // Where there is little room, the names of the lines matter more than that of the estimator.
    let whose = if charts::is_tight(area, small) { "" } else { data.whose };
    charts::titled(whose, &what, (small, area.size()[0]))
}
