//! How many blocks have each displacement: a map of counts, and the fullest bins as a list.

use eframe::egui::{self, Align2, Color32, FontId, Painter, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use motionscope_core::{Histogram, Role};

use crate::paint::{ColorMap, Face, Theme, grouped, number};
use crate::ui::charts::heat_map::vector;
use crate::ui::charts::map::Map;
use crate::ui::drawing::ink;
use crate::ui::stage::on_gray;

/// Letters of room for the list.
const LIST: f32 = 13.0;
/// The smallest side of a bin that has any, in points: it must be seen and found.
const LEAST: f32 = 4.0;

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The counts.
    pub histogram: &'a Histogram,
    /// Whether a click on a bin leads to a block.
    pub leads: bool,
    /// Colours for small and large counts.
    pub colors: ColorMap,
    /// The look.
    pub theme: Theme,
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The unit that found the first displacement of the bin that was clicked.
    pub clicked: Option<usize>,
}

/// What the histogram shows, in words.
pub fn summary(histogram: &Histogram) -> String {
    let all = counted(histogram, histogram.total());
    let level = histogram.level.map_or_else(String::new, |level| format!(" of level {level}"));
    let bits = format!("{:.2}", histogram.bits);
    let bins = match histogram.distinct() {
        1 => "one displacement".to_owned(),
        distinct => format!("{} displacements", grouped(distinct)),
    };
    let rounded = if histogram.is_rounded { ", counted by whole px" } else { "" };
    // A field of real numbers has as many displacements as pixels, and nobody sends them.
    let entropy = if histogram.of == "block" { format!("; entropy {bits} bits each") } else { String::new() };
    format!("{all}{level}, {bins}{rounded}{entropy}")
}

fn counted(histogram: &Histogram, count: u32) -> String {
    format!("{} {}{}", grouped(count as usize), histogram.of, if count == 1 { "" } else { "s" })
}

/// What it is called.
pub fn name(histogram: &Histogram) -> String {
    format!("Histogram: {}", summary(histogram))
}

/// Shows the histogram as large as it fits.
pub fn show(ui: &mut Ui, input: Input<'_>) -> Response {
    let Input { histogram, theme, .. } = input;
    let (area, _) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::hover());
    let map = Map::new((histogram.origin, histogram.counts.size()), area, LIST, theme);
    let sensed = ui.interact(map.rect, ui.scope_id().with("histogram"), Sense::click());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name(histogram)));
    let pointed = sensed.hover_pos().and_then(|at| nearest(histogram, &map, at));
    let painter = ui.painter_at(area);
    painter.rect_filled(map.rect, 0.0, ink::color(theme.chrome().raised));
    bins(&painter, &map, input);
    map.axes(&painter, theme);
    if let Some(at) = histogram.newest {
        frame(&painter, &map, at, theme);
    }
    if let Some(at) = pointed {
        let stroke = Stroke::new(1.5, ink::color(theme.chrome().text));
        painter.rect_stroke(seen(&map, at).expand(1.0), 0.0, stroke, StrokeKind::Outside);
    }
    header(&painter, &map, area, input, pointed);
    list(&painter, &map, area, input);
    let unit = |at| histogram.units[histogram.cell(at)?];
    Response { clicked: pointed.filter(|_| input.leads && sensed.clicked()).and_then(unit) }
}

/// The part of the screen on which a bin is drawn.
fn seen(map: &Map, at: [i32; 2]) -> Rect {
    let cell = map.cell_rect(at);
    Rect::from_center_size(cell.center(), cell.size().max(vec2(LEAST, LEAST)))
}

/// The bin under the pointer, or where bins are small the nearest that has any.
fn nearest(histogram: &Histogram, map: &Map, pointer: egui::Pos2) -> Option<[i32; 2]> {
    let under = map.displacement(pointer)?;
    let distance = |at: &[i32; 2]| map.cell_rect(*at).center().distance(pointer);
    let bins = histogram.fullest().into_iter().map(|(at, _)| at).filter(|at| seen(map, *at).contains(pointer));
    Some(bins.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(under))
}

/// The colour of a count: roots, so that what came once is seen beside what came a thousand times.
fn color(count: u32, most: u32, colors: ColorMap) -> Color32 {
    ink::color(colors.at(0.2 + 0.8 * (count as f32 / most.max(1) as f32).sqrt()))
}

fn bins(painter: &Painter, map: &Map, input: Input<'_>) {
    let bins = input.histogram.fullest();
    let most = bins.first().map_or(1, |(_, count)| *count);
    let font = FontId { size: map.small, ..ink::font(Face::Sans, map.small) };
    // The fullest come last: where bins are drawn larger than they are, these stay whole.
    for (at, count) in bins.into_iter().rev() {
        let (rect, fill) = (seen(map, at), color(count, most, input.colors));
        painter.rect_filled(rect.shrink(if map.cell > 8.0 { 0.5 } else { 0.0 }), 0.0, fill);
        let luma = 0.299 * f32::from(fill.r()) + 0.587 * f32::from(fill.g()) + 0.114 * f32::from(fill.b());
        let text = painter.layout_no_wrap(grouped(count as usize), font.clone(), on_gray(luma as u8));
        if text.size().x + 2.0 < rect.width() && text.size().y < rect.height() + 4.0 {
            painter.galley(rect.center() - text.size() / 2.0, text, Color32::PLACEHOLDER);
        }
    }
}

/// Frames the bin of the block that was just found.
fn frame(painter: &Painter, map: &Map, at: [i32; 2], theme: Theme) {
    let inked = theme.ink(Role::Result);
    let rect = Rect::from_center_size(map.cell_rect(at).center(), map.cell_rect(at).size().max(vec2(9.0, 9.0)));
    for (width, color) in [(inked.width + 2.0 * inked.halo_width, inked.halo), (inked.width, inked.color)] {
        painter.rect_stroke(rect, 0.0, Stroke::new(width, ink::color(color)), StrokeKind::Middle);
    }
}

/// What is counted, or what is known of the bin pointed at.
fn header(painter: &Painter, map: &Map, area: Rect, input: Input<'_>, pointed: Option<[i32; 2]>) {
    let told = pointed.map_or_else(|| summary(input.histogram), |at| told(input, at));
    let at = pos2(map.rect.min.x, area.min.y + 0.7 * map.small);
    let text = ink::color(input.theme.chrome().text);
    ink::line(painter, at, (&told, ink::font(Face::Sans, map.small), text), area.max.x - at.x);
}

/// A bin in words.
fn told(input: Input<'_>, at: [i32; 2]) -> String {
    let Input { histogram, leads, .. } = input;
    let cell = histogram.cell(at);
    let count = cell.map_or(0, |cell| histogram.counts[cell]);
    let percent = 100.0 * f64::from(count) / f64::from(histogram.total().max(1));
    let near = if histogram.is_rounded { "within half a px of" } else { "by" };
    let leads = leads && cell.is_some_and(|cell| histogram.units[cell].is_some());
    let first = if leads { "; a click goes to the first" } else { "" };
    format!("{} {near} {} px, {percent:.1} %{first}", counted(histogram, count), vector(at))
}

/// The fullest bins as words, as many as there is room for; the newest stands out.
fn list(painter: &Painter, map: &Map, area: Rect, input: Input<'_>) {
    let chrome = input.theme.chrome();
    let (font, bold) = (ink::font(Face::Sans, map.small), ink::font(Face::Bold, map.small));
    // Beside the name of the axis.
    let left = map.rect.max.x + 4.0 * map.small;
    let right = (left + 9.0 * map.small).min(area.max.x);
    let line = 1.5 * map.small;
    let bins = input.histogram.fullest();
    let room = (((area.max.y - map.rect.min.y) / line) as usize).max(1);
    let (shown, rest) = if bins.len() > room { (room - 1, bins.len() + 1 - room) } else { (bins.len(), 0) };
    for (i, (at, count)) in bins.into_iter().take(shown).enumerate() {
        let y = map.rect.min.y + (i as f32 + 0.5) * line;
        let is_newest = input.histogram.newest == Some(at);
        let (font, ink) = match is_newest {
            true => (bold.clone(), ink::color(input.theme.word(Role::Result))),
            false => (font.clone(), ink::color(chrome.text)),
        };
        painter.text(pos2(left, y), Align2::LEFT_CENTER, vector(at), font.clone(), ink);
        painter.text(pos2(right, y), Align2::RIGHT_CENTER, number(count as f32), font, ink);
    }
    if rest > 0 {
        let y = map.rect.min.y + (shown as f32 + 0.5) * line;
        let words = format!("and {} more", grouped(rest));
        painter.text(pos2(left, y), Align2::LEFT_CENTER, words, font, ink::color(chrome.dim));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Pos2;
    use motionscope_core::Counted;

    #[test]
    fn a_histogram_tells_itself_in_words() {
        let whole = Histogram::of(Counted::default(), &[[3.0, -1.0], [3.0, -1.0], [0.0, 0.0], [1.0, 0.0]], true);
        let whole = whole.expect("there are vectors");
        assert_eq!(summary(&whole), "4 blocks, 3 displacements; entropy 1.50 bits each");
        let told =
            |at| told(Input { histogram: &whole, leads: true, colors: ColorMap::default(), theme: Theme::Dark }, at);
        assert_eq!(told([3, -1]), "2 blocks by (3, −1) px, 50.0 %; a click goes to the first");
        assert_eq!(told([2, 2]), "0 blocks by (2, 2) px, 0.0 %");
        assert_eq!(told([0, 0]), "1 block by (0, 0) px, 25.0 %; a click goes to the first");
        let fine =
            Histogram::of(Counted { first_unit: 20, level: Some(2) }, &[[0.25, 0.0]], false).expect("there is one");
        assert_eq!(summary(&fine), "1 block of level 2, one displacement, counted by whole px; entropy 0.00 bits each");
    }

    #[test]
    fn a_small_bin_that_has_any_is_found_beside_empty_ones() {
        let histogram =
            Histogram::of(Counted::default(), &[[-60.0, 40.0], [64.0, -64.0]], false).expect("there are vectors");
        let area = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0));
        let map = Map::new((histogram.origin, histogram.counts.size()), area, LIST, Theme::Dark);
        assert!(map.cell < 2.0);
        let beside = map.cell_rect([-60, 40]).center() + vec2(1.6, -1.6);
        assert_eq!(nearest(&histogram, &map, beside), Some([-60, 40]));
        assert_eq!(nearest(&histogram, &map, map.cell_rect([0, 0]).center()), Some([0, 0]));
    }
}
