//! Small pictures whose pixels are numbers, side by side: the same pixel is lit in all of them.

use eframe::egui::{
    self, Align2, Color32, Mesh, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};
use motionscope_core::Role;
use motionscope_core::scene::Tile;

use crate::paint::{Face, Theme, number};
use crate::ui::drawing::ink;

/// Points per pixel from which numbers fit.
const NUMBERS: f32 = 17.0;
/// Size of a pixel that is large enough to read its number, in points.
const READABLE: f32 = 26.0;
/// Tiles with more pixels along a side are shown whole rather than readable.
const MOST_PIXELS: usize = 32;
/// Largest size of a pixel, in points.
const LARGEST: f32 = 36.0;
/// Between two tiles, in points.
const GAP: f32 = 16.0;

/// The tiles of a step.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The tiles, left to right.
    pub tiles: &'a [Tile],
    /// Whether the pixel that is explained lies in their middle. Such tiles are seen whole, and read at a click where there is
    /// no room for both; blocks are read, and scrolled.
    pub is_centred: bool,
    /// The look.
    pub theme: Theme,
}

/// How the tiles are looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Whether those that there is no room for are seen closely enough to read their numbers.
    is_close: bool,
    /// A tile, and the pixel of it that is to come to the middle.
    aim: Option<(usize, [usize; 2])>,
    /// The pixel, and the size of the tiles that it is lit in: others show something else there.
    hovered: Option<([usize; 2], (usize, usize))>,
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// The pixel under the pointer, from the tiles' upper left corner.
    pub hovered: Option<[usize; 2]>,
    /// Whether a click shows them closer, or whole again.
    pub can_be_closer: bool,
}

impl State {
    /// What a click does.
    fn hint(&self) -> &'static str {
        if self.is_close { " Click to see all." } else { " Click to read all." }
    }
}

/// Shows the tiles with their numbers, to be scrolled where they do not fit, and the pixel pointed at below them.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { tiles, theme, .. } = input;
    let small = theme.sizes().small;
    let line = (1.7 * small).round();
    let mut response = Response::default();
    let room = (ui.available_height() - line - ui.spacing().item_spacing.y).max(2.0 * line);
    let scroll = egui::ScrollArea::both().id_salt("tiles").auto_shrink(false).max_height(room);
    scroll.show(ui, |ui| response = side_by_side(ui, input, state));
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), line), Sense::hover());
    let hint = if response.can_be_closer { state.hint() } else { "" };
    let words =
        (format!("{}{hint}", told(tiles, state.hovered)), ink::font(Face::Sans, small), ink::color(theme.chrome().dim));
    ink::line(ui.painter(), rect.left_center(), (&words.0, words.1, words.2), rect.width());
    response
}

fn side_by_side(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { tiles, is_centred, theme } = input;
    let line = (1.7 * theme.sizes().small).round();
    let area = ui.available_rect_before_wrap();
    let labels: Vec<_> = tiles.iter().map(|tile| label_width(ui.painter(), tile, theme)).collect();
    let (whole_frame, readable) = (Frame::new(tiles, area, line), Frame::new(tiles, area, line).readable(tiles));
    let can_be_closer = is_centred && readable.cell > whole_frame.cell;
    let frame = if can_be_closer && !state.is_close { whole_frame } else { readable };
    let lefts = frame.lefts(tiles, &labels);
    let width = lefts.last().copied().unwrap_or(0.0);
    let (rect, whole) = ui.allocate_exact_size(vec2(width, frame.height + line), Sense::hover());
    ink::name(&whole, || told(tiles, state.hovered));
    let mut hovered = None;
    let size_pt = type_size(tiles, frame.cell);
    for (i, (tile, left)) in tiles.iter().zip(lefts).enumerate() {
        let place = frame.place(rect.min + vec2(left, 0.0), tile);
        label(ui.painter(), tile, pos2(place.min.x, rect.min.y), line, theme);
        let sense = if can_be_closer { Sense::click() } else { Sense::hover() };
        let sensed = ui.interact(place, ui.scope_id().with(("tile", i)), sense);
        let gain = paint(ui.painter(), tile, (place, frame.cell), size_pt, theme);
        if is_centred {
            let middle = Rect::from_center_size(place.center(), vec2(frame.cell, frame.cell));
            let ink = theme.ink(Role::Reference);
            ui.painter().rect_stroke(middle, 0.0, Stroke::new(4.0, ink::color(ink.halo)), StrokeKind::Middle);
            ui.painter().rect_stroke(middle, 0.0, Stroke::new(2.0, ink::color(ink.color)), StrokeKind::Middle);
        }
        sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, caption(tile, gain)));
        if let Some(at) = sensed.hover_pos() {
            hovered = pixel(at, place, frame.cell, tile).map(|pixel| (pixel, tile.values.size()));
        }
        if sensed.clicked() {
            (state.is_close, state.aim) = (!state.is_close, hovered.map(|(pixel, _)| (i, pixel)));
            ui.ctx().request_repaint();
        } else if let Some((_, [x, y])) = state.aim.filter(|(aimed, _)| *aimed == i && state.is_close) {
            let min = place.min + vec2(x as f32, y as f32) * frame.cell;
            ui.scroll_to_rect(Rect::from_min_size(min, vec2(frame.cell, frame.cell)), Some(egui::Align::Center));
            state.aim = None;
            ui.ctx().request_repaint();
        }
        if let Some(([x, y], _)) = state.hovered.filter(|(_, size)| *size == tile.values.size()) {
            let min = place.min + vec2(x as f32, y as f32) * frame.cell;
            let lit = Rect::from_min_size(min, vec2(frame.cell, frame.cell));
            ui.painter().rect_stroke(lit, 0.0, Stroke::new(4.0, Color32::BLACK), StrokeKind::Outside);
            ui.painter().rect_stroke(lit, 0.0, Stroke::new(2.0, Color32::WHITE), StrokeKind::Outside);
        }
    }
    state.hovered = hovered;
    Response { hovered: hovered.map(|(pixel, _)| pixel), can_be_closer }
}

/// Where tiles stand.
struct Frame {
    cell: f32,
    height: f32,
    top: f32,
}

impl Frame {
    /// Tiles as large as fits into `area`.
    fn new(tiles: &[Tile], area: Rect, line: f32) -> Self {
        let width = tiles.iter().map(|tile| tile.values.width()).sum::<usize>().max(1) as f32;
        let height = tiles.iter().map(|tile| tile.values.height()).fold(1, usize::max) as f32;
        let across = (area.width() - GAP * tiles.len() as f32) / width;
        let down = (area.height() - line - 4.0) / height;
        let cell = across.min(down).clamp(2.0, LARGEST);
        let cell = if cell >= 4.0 { cell.floor() } else { cell };
        Self { cell, height: cell * height + 4.0, top: line }
    }

    /// The same with pixels large enough for their numbers, unless there are too many.
    fn readable(self, tiles: &[Tile]) -> Self {
        let sizes = tiles.iter().map(|tile| tile.values.size());
        let (width, height) = sizes.fold((1, 1), |(w, h), size| (w.max(size.0), h.max(size.1)));
        if self.cell >= NUMBERS || width.max(height) > MOST_PIXELS {
            return self;
        }
        Self { cell: READABLE, height: READABLE * height as f32 + 4.0, ..self }
    }

    /// Where each tile begins, with labels so many points wide, and after them where they end.
    fn lefts(&self, tiles: &[Tile], labels: &[f32]) -> Vec<f32> {
        let widths = tiles.iter().zip(labels).map(|(tile, label)| (self.cell * tile.values.width() as f32).max(*label));
        let ends = widths.scan(0.0, |end, width| {
            *end += width + GAP;
            Some(*end)
        });
        std::iter::once(0.0).chain(ends).collect()
    }

    fn place(&self, origin: Pos2, tile: &Tile) -> Rect {
        let (width, height) = tile.values.size();
        let min = origin + vec2(0.0, self.top);
        Rect::from_min_size(min, vec2(width as f32, height as f32) * self.cell)
    }
}

fn pixel(at: Pos2, place: Rect, cell: f32, tile: &Tile) -> Option<[usize; 2]> {
    let [x, y] = [(at.x - place.min.x) / cell, (at.y - place.min.y) / cell].map(|c| c.max(0.0) as usize);
    tile.values.get(x, y).map(|_| [x, y])
}

fn label(painter: &Painter, tile: &Tile, at: Pos2, line: f32, theme: Theme) {
    let mut left = at.x;
    if let Some(role) = tile.role {
        let top = at.y + ((line - ink::SWATCH.y) / 2.0).round();
        ink::swatch(painter, pos2(left, top), role, theme);
        left += ink::SWATCH.x + 8.0;
    }
    let text = ink::color(theme.chrome().text);
    let font = ink::font(Face::Sans, theme.sizes().small);
    painter.text(pos2(left, at.y + line / 2.0), Align2::LEFT_CENTER, caption(tile, gain(tile)), font, text);
}

fn label_width(painter: &Painter, tile: &Tile, theme: Theme) -> f32 {
    let font = ink::font(Face::Sans, theme.sizes().small);
    let swatch = if tile.role.is_some() { ink::SWATCH.x + 8.0 } else { 0.0 };
    swatch + painter.layout_no_wrap(caption(tile, gain(tile)), font, Color32::PLACEHOLDER).size().x
}

fn caption(tile: &Tile, gain: f32) -> String {
    if gain > 1.0 { format!("{} × {gain}", tile.label) } else { tile.label.to_owned() }
}

/// How many times brighter than its numbers a tile of differences is shown: all but a few may then be seen.
fn gain(tile: &Tile) -> f32 {
    if tile.role != Some(Role::Error) {
        return 1.0;
    }
    let mut values: Vec<f32> = tile.values.cells().iter().copied().filter(|v| v.is_finite()).collect();
    values.sort_by(f32::total_cmp);
    let top = values.get(values.len().saturating_sub(1) * 19 / 20).copied().unwrap_or(0.0);
    let fits = |gain: &f32| top > 0.0 && top * gain <= tile.range[1];
    [8.0, 4.0, 2.0].into_iter().find(fits).unwrap_or(1.0)
}

/// Type in which the longest number of all `tiles` fits into a cell: one size for all, so that they can be compared.
fn type_size(tiles: &[Tile], cell: f32) -> f32 {
    let values = tiles.iter().flat_map(|tile| tile.values.cells()).filter(|v| v.is_finite());
    let longest = values.map(|v| brief(*v).chars().count()).max().unwrap_or(1) as f32;
    // A digit is about 0.6 as wide as it is high, a point less.
    (cell * (1.0 - 0.08) / (0.58 * longest)).min(0.42 * cell).clamp(6.5, 14.0)
}

/// A number as it fits into a cell: to a tenth, or to one where it is large.
fn brief(v: f32) -> String {
    if v.abs() >= 99.95 || v.fract() == 0.0 { number(v.round()) } else { format!("{v:.1}").replace('-', "−") }
}

/// Paints a tile of cells so large into `place`, with numbers of a size; gives its gain.
fn paint(painter: &Painter, tile: &Tile, (place, cell): (Rect, f32), size_pt: f32, theme: Theme) -> f32 {
    let gain = gain(tile);
    let [black, white] = tile.range;
    let shade = |v: f32| (255.0 * (v * gain - black) / (white - black).max(f32::MIN_POSITIVE)).clamp(0.0, 255.0) as u8;
    let mut mesh = Mesh::default();
    let square =
        |x: usize, y: usize| Rect::from_min_size(place.min + vec2(x as f32, y as f32) * cell, vec2(cell, cell));
    painter.rect_filled(place, 0.0, ink::color(theme.chrome().raised));
    let (width, height) = tile.values.size();
    let known = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).filter_map(|(x, y)| {
        let v = tile.values[(x, y)];
        v.is_finite().then_some((x, y, v))
    });
    known.clone().for_each(|(x, y, v)| mesh.add_colored_rect(square(x, y), Color32::from_gray(shade(v))));
    painter.add(Shape::mesh(mesh));
    if cell >= NUMBERS {
        let font = ink::font(Face::Sans, size_pt);
        for (x, y, v) in known.filter(|(x, y, _)| painter.clip_rect().intersects(square(*x, *y))) {
            let color = crate::ui::stage::on_gray(shade(v));
            painter.text(square(x, y).center(), Align2::CENTER_CENTER, brief(v), font.clone(), color);
        }
    }
    gain
}

fn told(tiles: &[Tile], hovered: Option<([usize; 2], (usize, usize))>) -> String {
    let Some(([x, y], size)) = hovered else { return "Point at a pixel to compare its numbers.".into() };
    let number = |tile: &Tile| {
        let v = tile.values.get(x, y).copied().unwrap_or(f32::NAN);
        format!("{} {}", tile.label, number(v))
    };
    let numbers: Vec<_> = tiles.iter().filter(|tile| tile.values.size() == size).map(number).collect();
    format!("column {x}, row {y}: {}", numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::Grid;

    fn tile(side: usize, role: Role, top: f32) -> Tile {
        let values = Grid::from_fn(side, side, |x, _| top * x as f32 / side as f32);
        Tile { label: "block", role: Some(role), values, range: [0.0, 255.0] }
    }

    #[test]
    fn tiles_fit_their_area() {
        for side in [4, 16, 64] {
            let tiles = [tile(side, Role::Reference, 255.0), tile(side, Role::Candidate, 255.0)];
            let area = Rect::from_min_size(pos2(5.0, 7.0), vec2(500.0, 300.0));
            let frame = Frame::new(&tiles, area, 20.0);
            let lefts = frame.lefts(&tiles, &[30.0; 2]);
            let place = |i: usize| frame.place(area.min + vec2(lefts[i], 0.0), &tiles[i]);
            let last = place(1);
            assert!(area.contains_rect(last), "{last:?}");
            assert!(place(0).max.x < last.min.x);
            let cell = frame.cell;
            let middle = last.min + vec2(2.5, 3.5) * cell;
            assert_eq!(pixel(middle, last, cell, &tiles[1]), Some([2, 3]));
        }
    }

    #[test]
    fn a_block_is_shown_large_enough_for_its_numbers() {
        let small = Rect::from_min_size(Pos2::ZERO, vec2(500.0, 160.0));
        let cell = |side| {
            let tiles = [tile(side, Role::Reference, 255.0), tile(side, Role::Candidate, 255.0)];
            Frame::new(&tiles, small, 20.0).readable(&tiles).cell
        };
        assert!(cell(4) >= NUMBERS && cell(16) >= NUMBERS && cell(64) < NUMBERS);
    }

    #[test]
    fn small_differences_are_brightened_and_it_is_said() {
        assert_eq!(caption(&tile(4, Role::Error, 20.0), gain(&tile(4, Role::Error, 20.0))), "block × 8");
        assert_eq!(gain(&tile(4, Role::Error, 300.0)), 1.0);
        assert_eq!(gain(&tile(4, Role::Reference, 20.0)), 1.0);
    }
}
