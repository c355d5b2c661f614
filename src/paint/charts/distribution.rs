//! How often a quantity has each value: bars, and the figures that sum them up.

use motionscope_core::scene::{Distribution, Role};

use super::super::primitive::{Anchor, Point, Primitive, Rect, Stroke};
use super::super::{Theme, grouped, labels, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, fitting, shortened};
use super::{ChartStyle, Drawing, titled};

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Counted<'a> {
    /// The counts.
    pub distribution: &'a Distribution,
    /// The estimator whose values are counted.
    pub whose: &'a str,
}

/// Where the bars stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bars {
    /// The part inside the axes.
    pub rect: Rect,
    /// Of values.
    x: Axis,
    /// How many there are.
    count: usize,
    /// The most that one of them counts.
    most: u32,
    /// Rows for the names of the figures above them.
    rows: usize,
}

/// Width from which two rows hold the names of three figures, and height of a row, in letters.
const WIDE_LETTERS: f32 = 44.0;
const ROW_LETTERS: f32 = 1.25;

impl Bars {
    fn new(distribution: &Distribution, area: Rect, small: f32) -> Self {
        let rows = if distribution.figures.len() > 2 && area.size()[0] < WIDE_LETTERS * small { 3 } else { 2 };
        let min = [area.min[0] + 4.6 * small, area.min[1] + (3.2 + ROW_LETTERS * rows as f32) * small];
        let max = [area.max[0] - 2.0 * small, area.max[1] - 3.4 * small];
        let rect = Rect { min, max: [0, 1].map(|i| max[i].max(min[i] + 8.0)) };
        let x = Axis::new([0.0, distribution.top], [rect.min[0], rect.max[0]]);
        let most = distribution.counts.iter().copied().max().unwrap_or(1).max(1);
        Self { rect, x, count: distribution.counts.len(), most, rows }
    }

    /// The bar at a place, if it lies inside the axes.
    pub fn at(&self, [x, y]: Point) -> Option<usize> {
        let Rect { min, max } = self.rect;
        let inside = (min[0]..=max[0]).contains(&x) && (min[1]..=max[1]).contains(&y) && self.count > 0;
        let share = (x - min[0]) / (max[0] - min[0]);
        inside.then(|| ((share * self.count as f32) as usize).min(self.count - 1))
    }

    /// Where bar `i` stands, which counts so many.
    pub fn bar(&self, i: usize, count: u32) -> Rect {
        let width = self.x.values[1] / self.count.max(1) as f32;
        let [left, right] = [i, i + 1].map(|i| self.x.place(i as f32 * width));
        let height = count as f32 / self.most as f32 * self.rect.size()[1];
        Rect { min: [left, self.rect.max[1] - height], max: [right, self.rect.max[1]] }
    }
}

/// Lays the distribution out in `area`.
pub fn draw(data: Counted<'_>, area: Rect, style: ChartStyle) -> Drawing<Bars> {
    let (distribution, theme) = (data.distribution, style.theme);
    let bars = Bars::new(distribution, area, style.small());
    let mut canvas = Canvas::default();
    axes(&mut canvas, &bars, distribution, theme);
    let color = theme.word(Role::Error).alpha(191);
    for (i, &count) in distribution.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let Rect { min, max } = bars.bar(i, count);
        canvas.fill(Rect { min: [min[0] + 0.5, min[1]], max: [max[0] - 0.5, max[1]] }, color);
    }
    figures(&mut canvas, &bars, distribution, theme);
    Drawing { place: bars, body: canvas.into_layers(), head: head(data, &bars, area, None, style) }
}

/// What stands above the bars: what is counted and the shares beyond limits, or what is known of the bar pointed at.
pub fn head(data: Counted<'_>, bars: &Bars, area: Rect, pointed: Option<usize>, style: ChartStyle) -> Vec<Primitive> {
    let Counted { distribution, whose } = data;
    let (text, small, width) = (Type::text(style.theme), style.small(), area.size()[0]);
    let mut canvas = Canvas::default();
    let mut row = |row: f32, words: &str| {
        let at = [area.min[0], area.min[1] + (0.8 + 1.35 * row) * small];
        canvas.text(at, (Anchor::Start, Level::Middle), &shortened(words, text, width), text);
    };
    row(0.0, &titled(whose, &format!("{}, {}", distribution.title, distribution.unit), (small, width)));
    row(1.0, &pointed.map_or_else(|| beyond(distribution), |i| description(distribution, bars, i)));
    canvas.into_primitives()
}

/// The distribution in words, in one line.
pub fn summary(distribution: &Distribution) -> String {
    let Distribution { title, unit, figures, shares, .. } = distribution;
    let figures: Vec<_> = figures.iter().map(|(name, v)| format!("{name} {} {unit}", short(*v))).collect();
    let shares: Vec<_> =
        shares.iter().map(|(limit, share)| format!("R{limit:.1} {}", percent(f64::from(*share)))).collect();
    let largest = largest(distribution).map_or_else(String::new, |words| format!("; {words}"));
    format!("{title}: {}; {}{largest}", figures.join(", "), shares.join(", "))
}

/// The shares that exceed a limit; all else stands in the picture.
fn beyond(Distribution { unit, shares, .. }: &Distribution) -> String {
    let description = |(limit, share): &(f32, f32)| format!("{limit} {unit}: {}", percent(f64::from(*share)));
    format!("Off by more than {}", shares.iter().map(description).collect::<Vec<_>>().join(" · "))
}

/// A bar in words.
fn description(distribution: &Distribution, bars: &Bars, i: usize) -> String {
    let width = distribution.top / bars.count.max(1) as f32;
    let [from, to] = [i, i + 1].map(|i| number(i as f32 * width));
    let count = distribution.counts[i];
    let share = percent(f64::from(count) / total(distribution));
    format!("{from} to {to} {}: {} pixels, {share}", distribution.unit, grouped(count as usize))
}

fn total(distribution: &Distribution) -> f64 {
    f64::from(distribution.counts.iter().sum::<u32>() + distribution.beyond).max(1.0)
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The first bar with the most, and how many that are; none where nothing is counted.
fn highest(counts: &[u32]) -> Option<(usize, u32)> {
    let most = counts.iter().copied().max().filter(|most| *most > 0)?;
    counts.iter().position(|count| *count == most).map(|i| (i, most))
}

/// The bar with the most, in words.
fn largest(distribution: &Distribution) -> Option<String> {
    let Distribution { counts, top, unit, .. } = distribution;
    let (i, most) = highest(counts)?;
    let [from, to] = [i, i + 1].map(|i| short_bound(i as f32 * top / counts.len() as f32));
    Some(format!("largest bar {from} to {to} {unit}, {}", percent(f64::from(most) / total(distribution))))
}

/// The middle of the bar with the most, in two words.
fn mode(distribution: &Distribution) -> Option<String> {
    let Distribution { counts, top, .. } = distribution;
    let (i, _) = highest(counts)?;
    Some(format!("mode {}", short_bound((i as f32 + 0.5) * top / counts.len() as f32)))
}

/// An end of a bar: two decimals at most.
fn short_bound(v: f32) -> String {
    number((v * 100.0).round() / 100.0)
}

/// Three digits that count are enough.
fn short(v: f32) -> String {
    if v < 1.0 { format!("{v:.3}") } else { format!("{v:.2}") }
}

fn axes(canvas: &mut Canvas, bars: &Bars, distribution: &Distribution, theme: Theme) {
    let (chrome, dim, text) = (theme.chrome(), Type::dim(theme), Type::text(theme));
    let small = text.size;
    let Rect { min: [left, top], max: [right, bottom] } = bars.rect;
    canvas.across([left, right], bottom, chrome.dim);
    let ticks = bars.x.ticks(5.0 * small, 0.0);
    for (&tick, words) in ticks.iter().zip(labels(&ticks)) {
        let x = bars.x.place(tick);
        canvas.down(x, [bottom, bottom + 4.0], chrome.dim);
        canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &words, dim);
    }
    let below = bottom + 6.0 + 1.25 * small;
    let name = format!("{}, {}", distribution.title.to_lowercase(), distribution.unit);
    let name = canvas.text([right, below], (Anchor::End, Level::Top), &name, text);
    let mut description: Vec<String> = largest(distribution).into_iter().collect();
    if distribution.beyond > 0 {
        let share = percent(f64::from(distribution.beyond) / total(distribution));
        description.push(format!("{share} beyond {} {}", number(distribution.top), distribution.unit));
    }
    if !description.is_empty() {
        // The largest bar is seen: its share is what can be left out.
        let words = description.join(" · ");
        let brief = words.split(", ").next().unwrap_or_default().to_owned();
        let briefest = mode(distribution).unwrap_or_default();
        let words = fitting(&[words, brief, briefest], dim, name.min[0] - small - left);
        canvas.text([left, below], (Anchor::Start, Level::Top), &words, dim);
    }
    let most = grouped(distribution.counts.iter().copied().max().unwrap_or(0) as usize);
    canvas.text([left - 7.0, top], (Anchor::End, Level::Middle), &most, dim);
}

/// A line for each figure, with its name above, as far as they do not stand on each other.
fn figures(canvas: &mut Canvas, bars: &Bars, distribution: &Distribution, theme: Theme) {
    let text = Type::text(theme);
    let Rect { min: [_, top], max: [right, bottom] } = bars.rect;
    let mut order: Vec<_> = distribution.figures.iter().enumerate().collect();
    order.sort_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
    let mut taken = vec![f32::NEG_INFINITY; bars.rows];
    for (i, (name, value)) in order {
        let (x, dash): (f32, &'static [f32]) = (bars.x.place(*value), [&[][..], &[4.0, 3.0], &[1.5, 2.5]][i % 3]);
        canvas.line(vec![[x, top], [x, bottom]], false, Stroke { width: 1.5, color: text.color, dash });
        let words = format!("{name} {} {}", short(*value), distribution.unit);
        let width = text.width(&words);
        // On the lowest row where none before it is too close; where it would be beyond the edge, the lowest with room left of it.
        let left = (x - 2.0).min(right - width);
        let is_free = |row: &usize| taken[*row] <= left;
        let row = (0..bars.rows).find(is_free).unwrap_or(bars.rows - 1);
        taken[row] = left + width + 8.0;
        let up = 2.0 + row as f32 * ROW_LETTERS * text.size;
        canvas.text([left, top - up], (Anchor::Start, Level::Bottom), &words, text);
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    #[test]
    fn figures_close_to_each_other_stand_on_rows_of_their_own() {
        let named = |mean: f32, median: f32, high: f32| Distribution {
            figures: vec![("mean", mean), ("median", median), ("95th percentile", high)],
            ..distribution()
        };
        let style = ChartStyle { theme: Theme::Projector, colors: ColorMap::Viridis, density: 1.0 };
        for figures in [named(0.335, 0.31, 0.36), named(1.9, 1.95, 1.99), named(0.01, 0.02, 1.98)] {
            for width in [330.0, 420.0, 530.0] {
                let area = Rect::new([0.0; 2], [width, 340.0]);
                let primitives = flat(draw(Counted { distribution: &figures, whose: "Horn–Schunck" }, area, style));
                let lines = primitives.iter().filter_map(|primitive| match primitive {
                    Primitive::Text(line) => Some(super::super::canvas::covered(line)),
                    _ => None,
                });
                let places: Vec<Rect> = lines.map(|rect| rect.grown(-1.5)).collect();
                for (i, a) in places.iter().enumerate() {
                    assert!(places[i + 1..].iter().all(|b| !a.meets(b)), "{width} wide: {a:?} in {places:?}");
                }
            }
        }
    }

    fn distribution() -> Distribution {
        Distribution {
            title: "Endpoint error",
            unit: "px",
            top: 2.0,
            counts: vec![4, 3, 2, 1],
            beyond: 0,
            figures: vec![("mean", 0.61), ("median", 0.5), ("95 %", 1.75)],
            shares: vec![(0.5, 0.6), (1.0, 0.3)],
        }
    }

    #[test]
    fn a_distribution_tells_itself_in_one_line() {
        assert_eq!(
            summary(&distribution()),
            "Endpoint error: mean 0.610 px, median 0.500 px, 95 % 1.75 px; R0.5 60.0 %, R1.0 30.0 %; \
             largest bar 0 to 0.500 px, 40.0 %"
        );
        assert_eq!(beyond(&distribution()), "Off by more than 0.5 px: 60.0 % · 1 px: 30.0 %");
    }

    #[test]
    fn bars_are_as_high_as_their_counts() {
        let all = distribution();
        let style = ChartStyle { theme: Theme::Light, colors: ColorMap::Viridis, density: 1.0 };
        let data = Counted { distribution: &all, whose: "Horn–Schunck" };
        let drawing = draw(data, Rect::new([0.0; 2], [400.0, 300.0]), style);
        let bars = drawing.place;
        assert_eq!(bars.bar(0, 4).size()[1], bars.rect.size()[1]);
        assert_eq!(bars.at([bars.rect.max[0] - 1.0, bars.rect.max[1] - 1.0]), Some(3));
        assert_eq!(bars.at([0.0, 0.0]), None);
        let primitives = flat(drawing);
        let filled = primitives.iter().filter(|primitive| matches!(primitive, Primitive::Polygon { .. })).count();
        assert_eq!(filled, 4);
        let words = texts(&primitives);
        for label in [
            "Horn–Schunck · Endpoint error, px",
            "endpoint error, px",
            "mean 0.610 px",
            "95 % 1.75 px",
            "largest bar 0 to 0.500 px, 40.0 %",
            "4",
            "2.0",
        ] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
    }
}
