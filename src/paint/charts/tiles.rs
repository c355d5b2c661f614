//! Small pictures whose pixels are numbers, side by side.

use std::sync::Arc;

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Role, Tile};

use super::super::legend::{self, SWATCH, Sample};
use super::super::primitive::{Anchor, Point, Primitive, Rect};
use super::super::{Color, Face, Theme, number};
use super::canvas::{Canvas, Level, Type, around, middle};
use super::{ChartStyle, Drawing, on_gray};

/// Points per pixel from which numbers fit.
pub const NUMBERS: f32 = 17.0;
/// Size of a pixel that is large enough to read its number, in points.
const READABLE: f32 = 26.0;
/// Tiles with more pixels along a side are shown whole rather than readable.
const MOST_PIXELS: usize = 32;
/// Largest size of a pixel, in points.
const LARGEST: f32 = 36.0;
/// Between two tiles, in points.
const GAP: f32 = 16.0;

/// The tiles of a step.
#[derive(Clone, Copy, Debug)]
pub struct Tiles<'a> {
    /// The tiles, left to right.
    pub tiles: &'a [Tile],
    /// Whether the pixel that is explained lies in the middle of those that have a middle pixel.
    pub is_centered: bool,
    /// How large their pixels are.
    pub closeness: Closeness,
}

/// How near tiles are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closeness {
    /// All are seen whole, as large as they fit.
    Whole,
    /// In one row, and near enough to read their numbers, which may need more room than there is.
    Readable,
}

/// Where tiles stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// Side of a pixel in points.
    pub cell: f32,
    /// The pixels of each.
    pub tiles: Vec<Rect>,
    /// Width and height of everything.
    pub size: [f32; 2],
}

impl Places {
    /// The pixel of tile `i` at a place.
    pub fn pixel(&self, i: usize, at: Point, tile: &Tile) -> Option<[usize; 2]> {
        let rect = self.tiles[i];
        let [x, y] = [0, 1].map(|axis| ((at[axis] - rect.min[axis]) / self.cell).max(0.0) as usize);
        tile.values.get(x, y).map(|_| [x, y])
    }

    /// Where a pixel of tile `i` stands.
    pub fn square(&self, i: usize, [x, y]: [usize; 2]) -> Rect {
        let min = self.tiles[i].min;
        Rect::new([min[0] + x as f32 * self.cell, min[1] + y as f32 * self.cell], [self.cell; 2])
    }
}

/// Where tiles stand in `area`, to be shown from its upper left corner on.
pub fn places(data: Tiles<'_>, area: Rect, style: ChartStyle) -> Places {
    let labels: Vec<_> = data.tiles.iter().map(|tile| label_width(tile, style.theme)).collect();
    let rows = Rows { tiles: data.tiles, labels: &labels, line: line(style) };
    let fitting = |columns: &usize| rows.fitting(*columns, area);
    // As many beside each other as make their pixels largest; of equals, in fewest rows.
    let best = || {
        let columns = (1..=data.tiles.len().max(1)).rev();
        columns.max_by(|a, b| fitting(a).total_cmp(&fitting(b)).then(a.cmp(b))).unwrap_or(1)
    };
    match data.closeness {
        Closeness::Whole => {
            let best = best();
            rows.places(best, fitting(&best), area.min)
        }
        Closeness::Readable => {
            let all = data.tiles.len().max(1);
            let sizes = data.tiles.iter().map(|tile| tile.values.size());
            let longest = sizes.map(|(width, height)| width.max(height)).max().unwrap_or(1);
            // Names that do not stand beside each other are not cut off, and whole pictures are as large as they fit.
            let columns = if fitting(&all) > 0.0 && longest <= MOST_PIXELS { all } else { best() };
            let whole = fitting(&columns).max(2.0);
            let cell = if whole >= NUMBERS || longest > MOST_PIXELS { whole } else { READABLE };
            rows.places(columns, cell, area.min)
        }
    }
}

/// Height of the line above a tile.
fn line(style: ChartStyle) -> f32 {
    (1.7 * style.small()).round()
}

struct Rows<'a> {
    tiles: &'a [Tile],
    labels: &'a [f32],
    line: f32,
}

impl Rows<'_> {
    /// Size of a pixel with which the tiles fit into `area`, so many beside each other.
    fn fitting(&self, columns: usize, area: Rect) -> f32 {
        let high = |row: &[Tile]| row.iter().map(|tile| tile.values.height()).max().unwrap_or(1);
        let height = self.tiles.chunks(columns).map(high).sum::<usize>().max(1) as f32;
        let rows = self.tiles.len().div_ceil(columns) as f32;
        let [room_x, room_y] = area.size();
        let across = self.across(columns, room_x);
        // Names that do not stand beside each other are set below each other.
        if across < 2.0 && columns > 1 {
            return 0.0;
        }
        let down = (room_y - rows * (self.line + 4.0)) / height;
        let cell = across.min(down).clamp(2.0, LARGEST);
        if cell >= 4.0 { cell.floor() } else { cell }
    }

    /// The largest pixel with which tiles and their names fit into `room` beside each other; less than 2 if the names do not.
    fn across(&self, columns: usize, room: f32) -> f32 {
        let width = |cell: f32, row: &[Tile], labels: &[f32]| {
            let one = |(tile, label): (&Tile, &f32)| (tile.values.width() as f32 * cell).max(*label) + GAP;
            row.iter().zip(labels).map(one).sum::<f32>() - GAP
        };
        let rows = || self.tiles.chunks(columns).zip(self.labels.chunks(columns));
        let fits = |cell: f32| rows().all(|(row, labels)| width(cell, row, labels) <= room);
        let (mut fitting, mut too_large) = (0.0, LARGEST);
        for _ in 0..12 {
            let middle = 0.5 * (fitting + too_large);
            *if fits(middle) { &mut fitting } else { &mut too_large } = middle;
        }
        if fits(LARGEST) { LARGEST } else { fitting }
    }

    fn places(&self, columns: usize, cell: f32, min: Point) -> Places {
        let (mut tiles, mut size, mut top) = (Vec::new(), [0.0f32; 2], min[1]);
        for (row, labels) in self.tiles.chunks(columns).zip(self.labels.chunks(columns)) {
            let (mut left, mut height) = (min[0], 0.0f32);
            for (tile, label) in row.iter().zip(labels) {
                let (width, rows) = tile.values.size();
                let rect = Rect::new([left, top + self.line], [width as f32 * cell, rows as f32 * cell]);
                left += rect.size()[0].max(*label) + GAP;
                height = height.max(rect.size()[1]);
                tiles.push(rect);
            }
            size[0] = size[0].max(left - GAP - min[0]);
            top += self.line + height + 4.0;
        }
        size[1] = top - min[1];
        Places { cell, tiles, size }
    }
}

/// Lays the tiles out from the upper left corner of `area` on.
pub fn draw(data: Tiles<'_>, area: Rect, style: ChartStyle) -> Drawing<Places> {
    let places = places(data, area, style);
    let theme = style.theme;
    let size = type_size(data.tiles, places.cell);
    let mut canvas = Canvas::default();
    for (tile, rect) in data.tiles.iter().zip(&places.tiles) {
        label(&mut canvas, tile, [rect.min[0], rect.min[1] - line(style)], style);
        paint(&mut canvas, tile, (*rect, places.cell), size, theme);
        frame_pixels(&mut canvas, tile, (*rect, places.cell), theme);
        // Else black pixels would not be seen on a dark ground.
        canvas.frame(rect.grown(0.5), 1.0, theme.chrome().line);
        let (width, height) = tile.values.size();
        if data.is_centered && width % 2 == 1 && height % 2 == 1 {
            let ink = theme.ink(Role::Reference);
            let middle = around(middle(rect), [places.cell; 2]);
            canvas.frame(middle, 4.0, ink.halo);
            canvas.frame(middle, 2.0, ink.color);
        }
    }
    Drawing { place: places, body: canvas.into_layers(), head: Vec::new() }
}

fn label(canvas: &mut Canvas, tile: &Tile, [mut left, top]: Point, style: ChartStyle) {
    let line = line(style);
    if let Some(role) = tile.role {
        canvas.extend(swatch(role, style.theme, [left, top + ((line - SWATCH[1]) / 2.0).round()]));
        left += SWATCH[0] + 8.0;
    }
    let at = [left, top + line / 2.0];
    canvas.text(at, (Anchor::Start, Level::Middle), &caption(tile), Type::text(style.theme));
}

/// How `role` is drawn over footage, [`SWATCH`] large.
pub fn swatch(role: Role, theme: Theme, min: Point) -> Vec<Primitive> {
    let sample = match role {
        Role::Result => Sample::Arrow,
        Role::Measured => Sample::Point,
        Role::Truth | Role::Error => Sample::Line,
        _ => Sample::Frame,
    };
    legend::swatch(role, sample, theme, min)
}

fn label_width(tile: &Tile, theme: Theme) -> f32 {
    let swatch = if tile.role.is_some() { SWATCH[0] + 8.0 } else { 0.0 };
    swatch + Type::text(theme).width(&caption(tile))
}

/// What a tile is called.
pub fn caption(tile: &Tile) -> String {
    let gain = gain(tile);
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
pub fn brief(v: f32) -> String {
    if v.abs() >= 99.95 || v.fract() == 0.0 { number(v.round()) } else { format!("{v:.1}").replace('-', "−") }
}

/// Paints a tile of cells so large into `rect`, with numbers of a size.
fn paint(canvas: &mut Canvas, tile: &Tile, (rect, cell): (Rect, f32), size: f32, theme: Theme) {
    let gain = gain(tile);
    let [black, white] = tile.range;
    let shade = |v: f32| (255.0 * (v * gain - black) / (white - black).max(f32::MIN_POSITIVE)).clamp(0.0, 255.0) as u8;
    let Color(unknown) = theme.chrome().raised;
    let (width, height) = tile.values.size();
    let color = |v: f32| if v.is_finite() { Color::gray(shade(v)).0 } else { unknown };
    let pixels = Arc::new(Grid::from_fn(width, height, |x, y| color(tile.values[(x, y)])));
    canvas.add(Primitive::Image { pixels, rect });
    if cell < NUMBERS {
        return;
    }
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let v = tile.values[(x, y)];
        if v.is_finite() {
            let at = [rect.min[0] + (x as f32 + 0.5) * cell, rect.min[1] + (y as f32 + 0.5) * cell];
            let style = Type { face: Face::Sans, size, color: on_gray(shade(v)) };
            canvas.text(at, (Anchor::Middle, Level::Middle), &brief(v), style);
        }
    }
}

/// Frames the pixels of a tile that have a meaning, where frames leave room for a number.
fn frame_pixels(canvas: &mut Canvas, tile: &Tile, (rect, cell): (Rect, f32), theme: Theme) {
    /// Size of a pixel from which both of its frames can be told apart, in points.
    const LEAST: f32 = 10.0;
    if cell < LEAST {
        return;
    }
    // Outer frames first: they reach over the edges of the pixels.
    for is_outer in [true, false] {
        for framed in tile.framed.iter().filter(|framed| framed.is_outer == is_outer) {
            let ink = theme.ink(framed.role);
            for [x, y] in &framed.pixels {
                let min = [rect.min[0] + *x as f32 * cell, rect.min[1] + *y as f32 * cell];
                let edges = Rect::new(min, [cell; 2]).grown(if is_outer { 0.0 } else { -2.5 });
                let (width, rim) = if is_outer { (3.0, 4.0) } else { (1.5, 2.5) };
                canvas.frame(edges, rim, ink.halo);
                canvas.frame(edges, width, ink.color);
            }
        }
    }
}

/// The numbers of a pixel in all tiles of one size, in words.
pub fn description(tiles: &[Tile], pointed: Option<([usize; 2], (usize, usize))>) -> String {
    let Some(([x, y], size)) = pointed else { return "Point at a pixel to compare its numbers.".into() };
    let number = |tile: &Tile| {
        let v = tile.values.get(x, y).copied().unwrap_or(f32::NAN);
        format!("{} {}", tile.label, number(v))
    };
    let numbers: Vec<_> = tiles.iter().filter(|tile| tile.values.size() == size).map(number).collect();
    format!("column {x}, row {y}: {}", numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Framed;

    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    fn tile(side: usize, role: Role, top: f32) -> Tile {
        let values = Grid::from_fn(side, side, |x, _| top * x as f32 / side as f32);
        Tile { label: "block", role: Some(role), values, range: [0.0, 255.0], framed: Vec::new() }
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    fn data(tiles: &[Tile], closeness: Closeness) -> Tiles<'_> {
        Tiles { tiles, is_centered: false, closeness }
    }

    #[test]
    fn tiles_fit_their_area() {
        for side in [4, 16, 64] {
            let tiles = [tile(side, Role::Reference, 255.0), tile(side, Role::Candidate, 255.0)];
            for room in [[500.0, 300.0], [180.0, 420.0]] {
                let area = Rect::new([5.0, 7.0], room);
                let places = places(data(&tiles, Closeness::Whole), area, style());
                let [first, last] = places.tiles[..] else { panic!("two tiles") };
                let inside = (0..2).all(|i| area.min[i] <= last.min[i] && last.max[i] <= area.max[i]);
                assert!(inside && !first.meets(&last), "{first:?} {last:?} in {area:?}");
                let at = [last.min[0] + 2.5 * places.cell, last.min[1] + 3.5 * places.cell];
                assert_eq!(places.pixel(1, at, &tiles[1]), Some([2, 3]));
            }
        }
    }

    #[test]
    fn a_block_is_shown_large_enough_for_its_numbers() {
        let area = Rect::new([0.0; 2], [500.0, 160.0]);
        let cell = |side| {
            let tiles = [tile(side, Role::Reference, 255.0), tile(side, Role::Candidate, 255.0)];
            places(data(&tiles, Closeness::Readable), area, style()).cell
        };
        assert!(cell(4) >= NUMBERS && cell(16) >= NUMBERS && cell(64) < NUMBERS);
    }

    #[test]
    fn small_differences_are_brightened_and_it_is_said() {
        assert_eq!(caption(&tile(4, Role::Error, 20.0)), "block × 8");
        assert_eq!(gain(&tile(4, Role::Error, 300.0)), 1.0);
        assert_eq!(gain(&tile(4, Role::Reference, 20.0)), 1.0);
    }

    #[test]
    fn framed_pixels_have_the_colors_of_their_roles() {
        let framed = |role, pixels, is_outer| Framed { role, pixels, is_outer };
        let all = vec![framed(Role::Measured, vec![[1, 2], [3, 0]], false), framed(Role::Result, vec![[1, 2]], true)];
        let tiles = [Tile { framed: all, ..tile(4, Role::Reference, 200.0) }];
        let frames = |side: f32| {
            let primitives = flat(draw(data(&tiles, Closeness::Whole), Rect::new([0.0; 2], [side; 2]), style()));
            let has_color = |primitive: &&Primitive, role: Role| match primitive {
                Primitive::Polyline { closed: true, stroke, .. } => stroke.color == Theme::Dark.ink(role).color,
                _ => false,
            };
            [Role::Measured, Role::Result].map(|role| primitives.iter().filter(|p| has_color(p, role)).count())
        };
        assert_eq!(frames(300.0), [2, 1]);
        assert_eq!(frames(50.0), [0, 0], "there is no room in small pixels");
    }

    #[test]
    fn pixels_have_their_shades_and_their_numbers() {
        let tiles = [tile(4, Role::Reference, 200.0)];
        let primitives = flat(draw(data(&tiles, Closeness::Whole), Rect::new([0.0; 2], [300.0, 300.0]), style()));
        let shades = primitives.iter().find_map(|primitive| match primitive {
            Primitive::Image { pixels, .. } => Some(pixels.row(0).iter().map(|pixel| pixel[0]).collect::<Vec<_>>()),
            _ => None,
        });
        assert_eq!(shades, Some(vec![0, 50, 100, 150]));
        let words = texts(&primitives);
        for label in ["block", "0", "50", "100", "150"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
    }
}
