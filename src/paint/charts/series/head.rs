//! What stands above a plot: what is plotted, and the names of its lines, bands and thresholds with their values.

use motionscope_core::scene::{Band, Series};
use motionscope_core::{Role, fixed};

use super::{ARROW, Plot, Plotted, THRESHOLD, are_marks, nearest, ring, value};
use crate::paint::charts::canvas::{Canvas, Level, Type, shortened, solid};
use crate::paint::charts::{self, ChartStyle};
use crate::paint::primitive::{Anchor, Primitive, Rect, Stroke};
use crate::paint::{Color, Theme, number};

/// Words above a plot, with the color that they explain if it is no line.
#[derive(Clone)]
pub(super) struct Entry {
    words: String,
    style: Type,
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
    let names = here.iter().cloned().chain(names(series, pointed.or(series.now()), theme));
    let is_beyond = |point: &[f32; 2]| plot.shows(point[0]) && plot.beyond(*point).is_some();
    let beyond = series.lines.iter().find(|(.., points)| points.iter().any(is_beyond));
    let names = names.chain(beyond.map(|(_, role, _)| Entry {
        swatch: Some(Swatch::Beyond(theme.word(*role))),
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
    let (text, chrome) = (Type::text(theme), theme.chrome());
    let lines = series.lines.iter().map(|(name, role, points)| {
        let value = x.and_then(|x| value(*role, points, x));
        let value = value.map_or_else(String::new, |value| format!(" {}", figure(series, value)));
        let swatch = are_marks(series, *role, points).then(|| Swatch::Ring(theme.word(*role)));
        Entry { swatch, ..Entry::new(format!("{name}{value}"), text.color(theme.word(*role))) }
    });
    let bands = series.bands.iter().map(|band| Entry {
        swatch: Some(Swatch::Band(band_color(theme))),
        ..Entry::new(band_name(band), text.color(chrome.dim))
    });
    let thresholds = series.thresholds.iter().map(|(name, value)| Entry {
        swatch: Some(Swatch::Threshold(theme.word(Role::Rejected))),
        ..Entry::new(format!("{name} {}", figure(series, *value)), text.color(chrome.dim))
    });
    lines.chain(bands).chain(thresholds).collect()
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
