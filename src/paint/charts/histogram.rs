//! How many blocks have each displacement: a map of counts, and the fullest bins by their displacements.

use motionscope_core::base::words::fixed;
use motionscope_core::data::Histogram;
use motionscope_core::scene::Role;

use super::super::primitive::{Anchor, Point, Primitive, Rect, Run};
use super::super::{Color, ColorMap, Face, Theme, grouped, number};
use super::canvas::{Canvas, Level, Type, around, fitting, middle, shortened};
use super::labels::{self, Labels};
use super::{ChartStyle, Drawing, Map};

/// Letters of room for the list.
const LIST: f32 = 13.0;
/// The same where there is none, for the end of the axis.
const NO_LIST: f32 = 1.5;
/// The smallest share of its side that a map beside the list may have; else the fullest bins carry their names.
const BESIDE_LIST: f32 = 0.9;
/// How many of them.
const NAMED: usize = 3;
/// The smallest side of a bin that has any, in points: it must be seen and found.
const LEAST: f32 = 4.0;

/// Sizes of a count in its bin, of the usual type, of which the first that fits is taken.
const COUNT_SHARES: [f32; 3] = [1.0, 0.85, 0.7];

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Counts<'a> {
    /// The counts.
    pub histogram: &'a Histogram,
    /// The estimator that found them.
    pub whose: &'a str,
}

/// Lays the histogram out as large as it fits into `area`.
pub fn draw(data: Counts<'_>, area: Rect, style: ChartStyle) -> Drawing<Map> {
    let (histogram, theme) = (data.histogram, style.theme);
    let map = map(histogram, area, theme);
    let mut canvas = Canvas::default();
    canvas.fill(map.rect, theme.chrome().raised);
    bins(&mut canvas, &map, histogram, style.colors);
    map.axes(&mut canvas, theme);
    if let Some(at) = histogram.newest {
        newest(&mut canvas, &map, at, style);
    }
    match has_list(histogram, area, theme) {
        true => list(&mut canvas, &map, (area, histogram), style),
        false => names(&mut canvas, &map, histogram, theme),
    }
    if !map.is_tight() {
        let (dim, room) = (Type::dim(theme), map.name_left(theme) - map.small - area.min[0]);
        let words = details(histogram).join(", ");
        // What an entropy is counted in stands in the summary.
        let brief = words.strip_suffix(" per vector").unwrap_or(&words).to_owned();
        let words = fitting(&[words, brief], dim, room);
        canvas.text([area.min[0], map.below()], (Anchor::Start, Level::Top), &words, dim);
    }
    Drawing { place: map, body: canvas.into_layers(), head: head(data, &map, area, None, style) }
}

/// Where the bins lie.
fn map(histogram: &Histogram, area: Rect, theme: Theme) -> Map {
    let letters = if has_list(histogram, area, theme) { LIST } else { NO_LIST };
    map_beside(histogram, area, letters, theme)
}

fn map_beside(histogram: &Histogram, area: Rect, letters: f32, theme: Theme) -> Map {
    let of = (histogram.origin, histogram.counts.size());
    Map::new(of, area, letters, theme).with_cells_per_px(histogram.bins_per_px)
}

/// Whether the fullest bins stand in a list beside the map, which takes no room from it.
fn has_list(histogram: &Histogram, area: Rect, theme: Theme) -> bool {
    let [with, without] = [LIST, NO_LIST].map(|letters| map_beside(histogram, area, letters, theme).cell);
    with >= BESIDE_LIST * without
}

/// What stands above the map: what is counted, or `told` of the bin that is pointed at.
pub fn head(data: Counts<'_>, map: &Map, area: Rect, description: Option<String>, style: ChartStyle) -> Vec<Primitive> {
    let (text, left) = (Type::text(style.theme), map.head_left(area, style.theme));
    let width = area.max[0] - left;
    let summed = if map.is_tight() { summary(data.histogram) } else { counts(data.histogram) };
    let what = || super::titled(data.whose, &summed, (text.size, width));
    let words = shortened(&description.unwrap_or_else(what), text, width);
    let mut canvas = Canvas::default();
    let at = [left, area.min[1] + 0.8 * text.size];
    canvas.text(at, (Anchor::Start, Level::Middle), &words, text);
    canvas.into_primitives()
}

/// What the histogram shows, in words.
pub fn summary(histogram: &Histogram) -> String {
    let details = details(histogram).into_iter().map(|words| format!("; {words}"));
    details.fold(counts(histogram), |all, words| all + &words)
}

/// What is counted, and how many different ones there are.
fn counts(histogram: &Histogram) -> String {
    let all = counted(histogram, histogram.total());
    let level = histogram.level.map_or_else(String::new, |level| format!(" of level {level}"));
    let bins = match histogram.distinct() {
        1 => "one displacement".to_owned(),
        distinct => format!("{} displacements", grouped(distinct)),
    };
    format!("{all}{level}, {bins}")
}

/// How coarse the bins are, and what a vector costs.
fn details(histogram: &Histogram) -> Vec<String> {
    let bins = match (histogram.is_rounded, histogram.bins_per_px) {
        (true, _) => Some("bins of 1 px".to_owned()),
        (false, 1) => None,
        (false, 2) => Some("bins of ½ px".to_owned()),
        (false, _) => Some("bins of ¼ px".to_owned()),
    };
    // A field of real numbers has as many displacements as pixels, and none of them is coded.
    let entropy = histogram.bits.map(|bits| format!("entropy {bits:.2} bits per vector"));
    bins.into_iter().chain(entropy).collect()
}

/// The displacement of a bin as it is written.
fn displacement(histogram: &Histogram, bin: [i32; 2]) -> String {
    let [u, v] = histogram.displacement(bin);
    let decimals = if histogram.bins_per_px == 1 { 0 } else { 2 };
    format!("({}, {})", fixed(u.into(), decimals), fixed(v.into(), decimals))
}

fn counted(histogram: &Histogram, count: u32) -> String {
    format!("{} {}{}", grouped(count as usize), histogram.of, if count == 1 { "" } else { "s" })
}

/// What it is called.
pub fn name(histogram: &Histogram) -> String {
    format!("Histogram: {}", summary(histogram))
}

/// A bin in words; `leads` if a click on it leads to a block.
pub fn description(histogram: &Histogram, at: [i32; 2], leads: bool) -> String {
    let cell = histogram.cell(at);
    let count = cell.map_or(0, |cell| histogram.counts[cell]);
    let percent = 100.0 * f64::from(count) / f64::from(histogram.total().max(1));
    let near = if histogram.is_rounded { "within half a px of" } else { "by" };
    let at = displacement(histogram, at);
    let leads = leads && cell.is_some_and(|cell| histogram.units[cell].is_some());
    let first = if leads { "; a click goes to the first" } else { "" };
    format!("{} {near} {at} px, {percent:.1} %{first}", counted(histogram, count))
}

/// What is painted for a bin.
pub fn seen(map: &Map, at: [i32; 2]) -> Rect {
    let cell = map.cell_rect(at);
    around(middle(&cell), [map.cell.max(LEAST); 2])
}

/// The bin at a place, or where bins are small the nearest that has any.
pub fn nearest(histogram: &Histogram, map: &Map, place: Point) -> Option<[i32; 2]> {
    let under = map.displacement(place)?;
    let distance = |at: &[i32; 2]| {
        let [x, y] = middle(&map.cell_rect(*at));
        (x - place[0]).hypot(y - place[1])
    };
    let holds = |rect: Rect| (0..2).all(|i| (rect.min[i]..=rect.max[i]).contains(&place[i]));
    let bins = histogram.fullest().into_iter().map(|(at, _)| at).filter(|at| holds(seen(map, *at)));
    Some(bins.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(under))
}

/// The color of a count: roots, so that what came once is seen beside what came a thousand times.
fn color(count: u32, most: u32, colors: ColorMap) -> Color {
    colors.at(0.2 + 0.8 * (count as f32 / most.max(1) as f32).sqrt())
}

fn bins(canvas: &mut Canvas, map: &Map, histogram: &Histogram, colors: ColorMap) {
    let bins = histogram.fullest();
    let most = bins.first().map_or(1, |(_, count)| *count);
    // The fullest come last: where bins are drawn larger than they are, these stay whole.
    for (at, count) in bins.into_iter().rev() {
        let (rect, fill) = (seen(map, at), color(count, most, colors));
        canvas.fill(rect.grown(if map.cell > 8.0 { -0.5 } else { 0.0 }), fill);
        let words = grouped(count as usize);
        if let Some(style) = count_style(map, &rect, &words) {
            canvas.text(middle(&rect), (Anchor::Middle, Level::Middle), &words, style.color(super::on(fill)));
        }
    }
}

/// Frames the bin of the block that was just found.
fn newest(canvas: &mut Canvas, map: &Map, at: [i32; 2], style: ChartStyle) {
    let ink = style.theme.ink(Role::Result);
    let rect = around(middle(&map.cell_rect(at)), [map.cell.max(9.0); 2]);
    canvas.frame(rect, ink.width + 2.0 * ink.halo_width, ink.halo);
    canvas.frame(rect, ink.width, ink.color);
}

/// The displacements of the newest and of the fullest bins, with the counts of those that are too small to hold them, beside the bins.
fn names(canvas: &mut Canvas, map: &Map, histogram: &Histogram, theme: Theme) {
    let text = Type::text(theme);
    let bins = histogram.fullest();
    let mut room = Labels::new(map.rect);
    bins.iter().for_each(|(at, _)| room.keep_off(seen(map, *at)));
    let (newest, others): (Vec<_>, Vec<_>) = bins.into_iter().partition(|(at, _)| histogram.newest == Some(*at));
    for (at, count) in newest.into_iter().chain(others).take(NAMED) {
        let bin = seen(map, at);
        let words = match count_style(map, &bin, &grouped(count as usize)) {
            Some(_) => displacement(histogram, at),
            None => format!("{}: {}", displacement(histogram, at), grouped(count as usize)),
        };
        let color = if histogram.newest == Some(at) { theme.word(Role::Result) } else { text.color };
        let runs = vec![Run::new(words, color)];
        let size = labels::size(&runs, text.size);
        let reach = 0.5 * bin.size()[0] + 3.0;
        if let Some(center) = room.place_anyway(size, &labels::around(middle(&bin), reach, size)) {
            labels::write(canvas, center, runs, (text, theme.chrome().panel));
        }
    }
}

/// The size of a count that fits into its bin, if any does.
fn count_style(map: &Map, bin: &Rect, words: &str) -> Option<Type> {
    let style = |share: &f32| Type { face: Face::Sans, size: share * map.small, color: Color::BLACK };
    let fits = |style: &Type| style.width(words) + 2.0 < bin.size()[0] && 1.2 * style.size < bin.size()[1] + 4.0;
    COUNT_SHARES.iter().map(style).find(fits)
}

/// The fullest bins as words, as many as there is room for; the newest stands out.
fn list(canvas: &mut Canvas, map: &Map, (area, histogram): (Rect, &Histogram), style: ChartStyle) {
    let (text, dim) = (Type::text(style.theme), Type::dim(style.theme));
    let left = map.rect.max[0] + 3.0 * map.small;
    let right = (left + 10.0 * map.small).min(area.max[0]);
    let (top, line) = (map.rect.min[1], 1.5 * map.small);
    let bins = histogram.fullest();
    let room = (((area.max[1] - top) / line) as usize).max(1);
    let (shown, rest) = if bins.len() > room { (room - 1, bins.len() + 1 - room) } else { (bins.len(), 0) };
    for (i, (at, count)) in bins.into_iter().take(shown).enumerate() {
        let y = top + (i as f32 + 0.5) * line;
        let style = match histogram.newest == Some(at) {
            true => text.face(Face::Bold).color(style.theme.word(Role::Result)),
            false => text,
        };
        canvas.text([left, y], (Anchor::Start, Level::Middle), &displacement(histogram, at), style);
        canvas.text([right, y], (Anchor::End, Level::Middle), &number(count as f32), style);
    }
    if rest > 0 {
        let words = format!("and {} more", grouped(rest));
        canvas.text([left, top + (shown as f32 + 0.5) * line], (Anchor::Start, Level::Middle), &words, dim);
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::data::Counted;

    use super::super::{flat, texts};
    use super::*;

    #[test]
    fn a_histogram_tells_itself_in_words() {
        let whole = Histogram::of(Counted::default(), &[[3.0, -1.0], [3.0, -1.0], [0.0, 0.0], [1.0, 0.0]], true);
        let whole = whole.expect("there are vectors");
        assert_eq!(summary(&whole), "4 blocks, 3 displacements; entropy 1.50 bits per vector");
        let description = |at| description(&whole, at, true);
        assert_eq!(description([3, -1]), "2 blocks by (3, −1) px, 50.0 %; a click goes to the first");
        assert_eq!(description([2, 2]), "0 blocks by (2, 2) px, 0.0 %");
        assert_eq!(description([0, 0]), "1 block by (0, 0) px, 25.0 %; a click goes to the first");
        let fine =
            Histogram::of(Counted { first_unit: 20, level: Some(2) }, &[[0.25, 0.0]], false).expect("there is one");
        assert_eq!(summary(&fine), "1 block of level 2, one displacement; bins of ¼ px; entropy 0.00 bits per vector");
        assert!(super::description(&fine, [1, 0], false).starts_with("1 block by (0.25, 0.00) px"));
        let fitted = Histogram::of(Counted::default(), &[[0.3, 0.0]], false).expect("there is one");
        assert_eq!(summary(&fitted), "1 block, one displacement; bins of 1 px; entropy 0.00 bits per vector");
    }

    #[test]
    fn a_small_bin_that_has_any_is_found_beside_empty_ones() {
        let histogram =
            Histogram::of(Counted::default(), &[[-60.0, 40.0], [64.0, -64.0]], false).expect("there are vectors");
        let area = Rect::new([0.0; 2], [300.0, 200.0]);
        let map = map(&histogram, area, Theme::Dark);
        assert!(map.cell < 2.0);
        let [x, y] = middle(&map.cell_rect([-60, 40]));
        assert_eq!(nearest(&histogram, &map, [x + 1.6, y - 1.6]), Some([-60, 40]));
        assert_eq!(nearest(&histogram, &map, middle(&map.cell_rect([0, 0]))), Some([0, 0]));
    }

    #[test]
    fn a_narrow_histogram_names_its_fullest_bins_in_place_of_a_list() {
        let vectors = [[2.0, 1.0], [2.0, 1.0], [0.0, 0.0], [-3.0, 2.0], [-3.0, 2.0], [-3.0, 2.0]];
        let histogram = Histogram::of(Counted::default(), &vectors, false).expect("there are vectors");
        let style = ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 };
        let drawn = |size| draw(Counts { histogram: &histogram, whose: "" }, Rect::new([0.0; 2], size), style);
        let (narrow, wide) = (drawn([300.0, 400.0]), drawn([900.0, 300.0]));
        assert!(narrow.place.rect.size()[0] > 200.0, "{:?}", narrow.place.rect);
        let words = texts(&flat(narrow));
        assert!(["(−3, 2)", "(2, 1)", "(0, 0)"].iter().all(|name| words.iter().any(|word| word == name)), "{words:?}");
        let is_list = |words: &[String]| words.iter().filter(|word| word.starts_with('(')).count() == 3;
        assert!(is_list(&texts(&flat(wide))));
    }

    #[test]
    fn bins_show_their_counts_and_the_list_has_the_fullest_first() {
        let vectors = [[2.0, 1.0], [2.0, 1.0], [0.0, 0.0]];
        let histogram = Histogram::of(Counted::default(), &vectors, false).expect("there are vectors");
        let style = ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 };
        let data = Counts { histogram: &histogram, whose: "Diamond search" };
        let drawing = draw(data, Rect::new([0.0; 2], [600.0, 300.0]), style);
        let map = drawing.place;
        let primitives = flat(drawing);
        let fill =
            Primitive::Polygon { points: seen(&map, [2, 1]).grown(-0.5).corners(), color: color(2, 2, style.colors) };
        assert!(primitives.contains(&fill));
        let words = texts(&primitives);
        let at =
            |label: &str| words.iter().position(|word| word == label).unwrap_or_else(|| panic!("{label}: {words:?}"));
        assert!(at("(2, 1)") < at("(0, 0)"));
        assert!(words.last().is_some_and(|head| head.starts_with("Diamond search · 3 blocks")));
    }
}
