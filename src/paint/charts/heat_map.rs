//! A cost or a similarity over displacements, as a map of colors that fills in as candidates are tested.

use std::sync::Arc;

use motionscope_core::base::words::fixed;
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{BetweenPixels, Role, Surface};

use super::super::primitive::{Anchor, Primitive, Rect};
use super::super::{Color, ColorMap, Theme, grouped, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, around, fitting, middle, shortened, solid};
use super::{ChartStyle, Drawing, Map, titled};

/// What is said of a candidate whose cost was not summed to its end.
const GIVEN_UP: &str = "rejected early";
/// How far costs that the search did not work out go over into the ground.
const FAINT: f32 = 0.6;
/// Colors of the bar: so many that no step between two is seen.
const SHADES: usize = 128;

/// Pixels around the displacements between pixels that are shown with them.
const MARGIN: usize = 1;

/// What is mapped.
#[derive(Clone, Copy, Debug)]
pub struct HeatMap<'a> {
    /// The costs.
    pub surface: &'a Surface,
    /// The estimator whose they are.
    pub whose: &'a str,
}

/// Lays the map out as large as it fits into `area`: the whole search window at every step with whole pixels, so that a displacement
/// has one place, and at sub-pixel steps what surrounds them.
pub fn draw(data: HeatMap<'_>, area: Rect, style: ChartStyle) -> Drawing<Map> {
    // Between pixels the search goes on within a few of them.
    let closer = data.surface.around_between(MARGIN);
    let (surface, theme) = (closer.as_ref().unwrap_or(data.surface), style.theme);
    let (room, beside) = Bar::of(area, theme).room(area, theme);
    let map = Map::new((surface.origin, surface.values.size()), room, beside, theme);
    let mut canvas = Canvas::default();
    hatch(&mut canvas, map.rect, theme);
    let pixels = Arc::new(costs(surface, style));
    canvas.add(Primitive::Image { pixels, rect: map.rect });
    map.axes(&mut canvas, theme);
    path(&mut canvas, &map, surface, style);
    for (role, at) in [(Role::Best, surface.best), (Role::Candidate, surface.probe)] {
        if let Some(at) = at {
            cross(&mut canvas, &map, at, role, theme);
        }
    }
    color_bar(&mut canvas, &map, (surface, area), style);
    optimum(&mut canvas, &map, (surface, area), theme);
    Drawing { place: map, body: canvas.into_layers(), head: head(data, &map, area, None, style) }
}

/// What stands above the map: what is mapped, or what is known of the displacement that is pointed at.
pub fn head(data: HeatMap<'_>, map: &Map, area: Rect, pointed: Option<[i32; 2]>, style: ChartStyle) -> Vec<Primitive> {
    let (small, theme) = (map.small, style.theme);
    let y = area.min[1] + 0.8 * small;
    let mut canvas = Canvas::default();
    let mut right = area.max[0];
    if tested(data.surface).1 > 0 {
        let words = canvas.text([right, y], (Anchor::End, Level::Middle), GIVEN_UP, Type::dim(theme));
        let swatch = around([(words.min[0] - small).round(), y], [small; 2]);
        canvas.fill(swatch, neutral(theme));
        right = swatch.min[0] - small;
    }
    // As far as the name of the map has room.
    let dim = Type::dim(theme);
    for (words, role) in signs(data.surface) {
        let left = right - dim.width(&words);
        if left - area.min[0] > 9.0 * small {
            canvas.text([right, y], (Anchor::End, Level::Middle), &words, dim.color(theme.word(role)));
            right = left - small;
        }
    }
    // Where words share rows, the end of the colour scale stands beside the name of the map.
    if map.is_tight() {
        right = right.min(map.rect.max[0] + 1.5 * small);
    }
    let (left, text) = (map.head_left(area, theme), Type::text(theme));
    let title = data.surface.title.to_string();
    let description = match pointed {
        Some(at) => description(data.surface, at),
        None => titled(data.whose, &format!("{title} by displacement"), (small, right - left)),
    };
    let words = fitting(&[description, title], text, right - left);
    canvas.text([left, y], (Anchor::Start, Level::Middle), &words, text);
    canvas.into_primitives()
}

/// The colors of the cells: clear where nothing was tested.
fn costs(surface: &Surface, style: ChartStyle) -> Grid<[u8; 4]> {
    let shades = Shades::of(surface, style.colors);
    let (width, height) = surface.values.size();
    let faint = |cost: f32| shades.at(cost).mix(style.theme.chrome().raised, FAINT);
    Grid::from_fn(width, height, |x, y| match (surface.values[(x, y)], surface.events[(x, y)]) {
        (cost, _) if cost.is_finite() => shades.at(cost).0,
        (_, Some(_)) => neutral(style.theme).0,
        (_, None) => surface.cost(x, y).map_or([0; 4], |cost| faint(cost).0),
    })
}

/// The tested cells of a search of few, joined in the order of their tests; positions between pixels, the minimum that was missed
/// and the true displacement.
fn path(canvas: &mut Canvas, map: &Map, surface: &Surface, style: ChartStyle) {
    /// Of more tests the order cannot be seen.
    const MOST: usize = 80;
    /// Radius of a displacement between pixels in cells: a quarter of a pixel from the next.
    const FINE: f32 = 0.1;
    let theme = style.theme;
    let at = |[u, v]: [f32; 2]| {
        let cell = map.cell_rect([0, 0]);
        let [x, y] = middle(&cell);
        [x + u * map.cell, y + v * map.cell]
    };
    let tested = surface.path();
    if (2..=MOST).contains(&tested.len()) && 3 * tested.len() < surface.values.cells().len() {
        let shades = Shades::of(surface, style.colors);
        let places: Vec<_> = tested.iter().map(|at| middle(&map.cell_rect(*at))).collect();
        canvas.line(places.clone(), false, solid(1.0, theme.chrome().text.alpha(110)));
        let radius = (0.45 * map.cell).max(3.5);
        for (place, at) in places.into_iter().zip(tested) {
            canvas.disc(place, radius + 1.0, theme.chrome().text.alpha(150));
            canvas.disc(place, radius, cost(surface, at).map_or(neutral(theme), |cost| shades.at(cost)));
        }
    }
    let shades = Shades::of(surface, style.colors);
    let radius = (FINE * map.cell).max(2.5);
    for BetweenPixels { at: place, value } in surface.between.iter().copied() {
        let color = if value.is_finite() { shades.at(value) } else { theme.ink(Role::Candidate).color };
        canvas.disc(at(place), radius + 1.0, Color::BLACK.alpha(150));
        canvas.disc(at(place), radius, color);
    }
    if let Some(BetweenPixels { at: place, .. }) = surface.optimum_between() {
        let ink = theme.ink(Role::Best);
        let ring = around(at(place), [2.0 * radius + 3.0; 2]);
        canvas.frame(ring, ink.width + 2.0 * ink.halo_width, ink.halo);
        canvas.frame(ring, ink.width, ink.color);
    }
    let missed = surface.missed().map(|(at, _)| (Role::Error, at.map(|c| c as f32)));
    for (role, place) in missed.into_iter().chain(surface.truth.map(|truth| (Role::Truth, truth))) {
        if let Some([x, y]) = Some(at(place)).filter(|place| map.displacement(*place).is_some()) {
            let arm = (0.7 * map.cell).clamp(5.0, 9.0);
            for (width, color) in [(4.5, Color::BLACK.alpha(150)), (2.0, theme.ink(role).color)] {
                canvas.line(vec![[x - arm, y - arm], [x + arm, y + arm]], false, solid(width, color));
                canvas.line(vec![[x - arm, y + arm], [x + arm, y - arm]], false, solid(width, color));
            }
        }
    }
}

/// The colors of costs.
#[derive(Clone, Copy, Debug)]
pub struct Shades {
    range: [f32; 2],
    colors: ColorMap,
}

impl Shades {
    /// Those of `surface`.
    pub fn of(surface: &Surface, colors: ColorMap) -> Self {
        Self { range: surface.shades().or(surface.scale).unwrap_or_default(), colors }
    }

    /// The color of a cost.
    pub fn at(&self, cost: f32) -> Color {
        let [low, high] = self.range;
        self.colors.at((cost - low) / (high - low).max(f32::MIN_POSITIVE))
    }
}

/// The cell of a displacement.
fn cell(surface: &Surface, [u, v]: [i32; 2]) -> Option<(usize, usize)> {
    let place = |c: i32, origin: i32| usize::try_from(c.checked_sub(origin)?).ok();
    Some((place(u, surface.origin[0])?, place(v, surface.origin[1])?))
}

/// The cost at a displacement, if it is known.
pub fn cost(surface: &Surface, at: [i32; 2]) -> Option<f32> {
    let (x, y) = cell(surface, at)?;
    surface.values.get(x, y).copied().filter(|v| v.is_finite())
}

/// The cost at a displacement, tested or not, if it is known.
pub fn any_cost(surface: &Surface, at: [i32; 2]) -> Option<f32> {
    let (x, y) = cell(surface, at)?;
    surface.cost(x, y)
}

/// The event that tested a displacement, if one did.
pub fn event(surface: &Surface, at: [i32; 2]) -> Option<usize> {
    let (x, y) = cell(surface, at)?;
    surface.events.get(x, y).copied().flatten()
}

/// How many displacements were tested, and how many of these were given up before their cost was known.
fn tested(surface: &Surface) -> (usize, usize) {
    let tested = surface.events.cells().iter().zip(surface.values.cells()).filter(|(event, _)| event.is_some());
    tested.fold((0, 0), |(all, given_up), (_, cost)| (all + 1, given_up + usize::from(!cost.is_finite())))
}

/// A displacement as it is written.
pub fn vector([u, v]: [i32; 2]) -> String {
    format!("({}, {})", number(u as f32), number(v as f32))
}

/// What the surface shows, in words.
pub fn summary(surface: &Surface) -> String {
    let (tested, given_up) = tested(surface);
    let early = if given_up > 0 { format!(", {} of them {GIVEN_UP}", grouped(given_up)) } else { String::new() };
    let (tested, all) = (grouped(tested), grouped(surface.values.cells().len()));
    let best = optimum_words(surface).map(|words| format!(", {words}"));
    format!("{} by displacement: {tested} of {all} tested{early}{}", surface.title, best.unwrap_or_default())
}

/// Fills the cells of candidates whose cost is not known since it was too large already.
fn neutral(theme: Theme) -> Color {
    let chrome = theme.chrome();
    chrome.raised.mix(chrome.text, 0.3)
}

/// What was not tested yet: thin slanted lines.
fn hatch(canvas: &mut Canvas, rect: Rect, theme: Theme) {
    let chrome = theme.chrome();
    canvas.fill(rect, chrome.raised);
    let color = chrome.raised.mix(chrome.text, 0.14);
    let ([x0, y0], [x1, y1]) = (rect.min, rect.max);
    let count = ((x1 - x0 + y1 - y0) / 8.0) as usize;
    for i in 1..=count {
        // The line x + y = sum, as far as it lies in the rectangle.
        let sum = x0 + y0 + i as f32 * 8.0;
        let ends = [[(sum - y1).max(x0), y1.min(sum - x0)], [x1.min(sum - y0), (sum - x1).max(y0)]];
        canvas.line(ends.to_vec(), false, solid(1.0, color));
    }
}

/// Thin lines through a displacement, and a frame around its cell.
fn cross(canvas: &mut Canvas, map: &Map, at: [i32; 2], role: Role, theme: Theme) {
    let ink = theme.ink(role);
    let cell = map.cell_rect(at);
    let center = middle(&cell);
    let ([x0, y0], [x1, y1]) = (map.rect.min, map.rect.max);
    for (width, color) in [(2.5, Color::BLACK.alpha(90)), (1.0, ink.color.alpha(204))] {
        canvas.line(vec![[x0, center[1]], [x1, center[1]]], false, solid(width, color));
        canvas.line(vec![[center[0], y0], [center[0], y1]], false, solid(width, color));
    }
    let frame = around(center, [map.cell.max(7.0); 2]).grown(ink.width / 2.0);
    canvas.frame(frame, ink.width + 2.0 * ink.halo_width, ink.halo);
    canvas.frame(frame, ink.width, ink.color);
}

/// What is known of the displacement that is pointed at.
fn description(surface: &Surface, at: [i32; 2]) -> String {
    let untested = any_cost(surface, at);
    match (cost(surface, at), event(surface, at)) {
        (Some(cost), _) => format!("{} at {} is {}", surface.title, vector(at), number(cost)),
        (None, Some(_)) => format!("{} was {GIVEN_UP}", vector(at)),
        (None, None) => match untested {
            Some(cost) => format!("{}: {} {}, not tested", vector(at), surface.title, number(cost)),
            None => format!("{} is not tested yet", vector(at)),
        },
    }
}

/// What is sought on a surface: the minimum of a cost, the maximum of a similarity.
fn sought(surface: &Surface) -> &'static str {
    if surface.is_similarity { "maximum" } else { "minimum" }
}

/// The best value so far with its place, in words: `minimum 812 at (−3, 2)`; or how many displacements have it.
pub fn optimum_words(surface: &Surface) -> Option<String> {
    let (least, at) = surface.optimum()?;
    let named = |value: f32| format!("{} {} {}", sought(surface), number(value), surface.unit).trim_end().to_owned();
    if let Some(BetweenPixels { at, value }) = surface.optimum_between() {
        return Some(format!("{} at {}", named(value), fine_vector(at)));
    }
    let least = named(least);
    Some(match &at[..] {
        [only] => format!("{least} at {}", vector(*only)),
        [first, second] => format!("{least}, a tie of {} and {}", vector(*first), vector(*second)),
        all => format!("{least}, a tie of {} displacements", grouped(all.len())),
    })
}

/// The best value so far, and how many displacements have it where several do: `minimum 0 (5 equal)`.
fn brief_optimum(surface: &Surface) -> String {
    let Some((least, at)) = surface.optimum() else { return String::new() };
    if let Some(between) = surface.optimum_between() {
        return format!("{} {}", sought(surface), number(between.value));
    }
    let ties = if at.len() > 1 { format!(" ({} equal)", grouped(at.len())) } else { String::new() };
    format!("{} {}{ties}", sought(surface), number(least))
}

/// Names the best value below the map and rings the cells that tie for it.
fn optimum(canvas: &mut Canvas, map: &Map, (surface, area): (&Surface, Rect), theme: Theme) {
    /// Ties ringed one by one; more of them are a plateau.
    const RINGS: usize = 12;
    let ties = surface.optimum().filter(|_| surface.optimum_between().is_none());
    if let Some((_, at)) = ties.filter(|(_, at)| (2..=RINGS).contains(&at.len())) {
        let color = theme.ink(Role::Best).color;
        for cell in at.into_iter().map(|at| map.cell_rect(at)) {
            let radius = (map.cell / 4.0).clamp(2.0, 5.0);
            canvas.disc(middle(&cell), radius + 1.0, Color::BLACK.alpha(150));
            canvas.disc(middle(&cell), radius, color);
        }
    }
    // The unit stands at the bar of colors.
    let bare = Surface { unit: "", ..surface.clone() };
    let Some(words) = optimum_words(&bare).filter(|_| !map.is_tight()) else { return };
    let (dim, room) = (Type::dim(theme), map.name_left(theme) - map.small - area.min[0]);
    // Where it is has less room than how small it is; the cells are ringed.
    let fitting = [words.clone(), brief_optimum(&bare)].into_iter().find(|words| dim.width(words) <= room);
    let words = fitting.unwrap_or_else(|| shortened(&words, dim, room));
    canvas.text([area.min[0], map.below()], (Anchor::Start, Level::Top), &words, dim);
}

/// A displacement between pixels with two decimals, none where both components are whole, as in sentences.
fn fine_vector(uv: [f32; 2]) -> String {
    let decimals = if uv.iter().all(|c| c.fract() == 0.0) { 0 } else { 2 };
    let [u, v] = uv.map(|c| fixed(c.into(), decimals));
    format!("({u}, {v})")
}

/// The signs for the minimum that was missed and for the true displacement, with what they mean.
fn signs(surface: &Surface) -> impl Iterator<Item = (String, Role)> {
    let missed =
        surface.missed().map(|(at, cost)| (format!("× missed: {} at {}", number(cost), vector(at)), Role::Error));
    let truth = surface.truth.map(|uv| (format!("× true motion {}", fine_vector(uv)), Role::Truth));
    missed.into_iter().chain(truth)
}

/// Where the color bar stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bar {
    /// Right of the map, with its numbers.
    Beside,
    /// Below the map, where the area is narrow and high: beside it the map would be small.
    Below,
}

impl Bar {
    /// Width of the bar with its numbers, and height of it below the map, in letters.
    const WIDTH: f32 = 7.5;
    const HEIGHT: f32 = 5.0;
    /// What is left right of a map over its bar: half of a number.
    const MARGIN: f32 = 1.5;

    fn of(area: Rect, theme: Theme) -> Self {
        let [width, height] = area.size().map(|side| side / theme.sizes().small);
        if width < height && width < 24.0 { Self::Below } else { Self::Beside }
    }

    /// The area that is left for the map, and the letters beside it.
    fn room(self, area: Rect, theme: Theme) -> (Rect, f32) {
        let height = Self::HEIGHT * theme.sizes().small;
        match self {
            Self::Beside => (area, Self::WIDTH),
            Self::Below => (Rect::between(area.min, [area.max[0], area.max[1] - height]), Self::MARGIN),
        }
    }
}

/// The color bar below the map, its quantity left of it, and its ends and its unit below.
fn color_bar_below(canvas: &mut Canvas, map: &Map, surface: &Surface, style: ChartStyle) {
    let Some([low, high]) = surface.shades() else { return };
    let (small, chrome, dim) = (map.small, style.theme.chrome(), Type::dim(style.theme));
    let min = [map.rect.min[0], (map.below() + 2.0 * small).round()];
    let bar = Rect::new(min, [map.rect.size()[0], (0.8 * small).round()]);
    let shade = |x: usize| style.colors.at(x as f32 / (SHADES - 1) as f32).0;
    let pixels = Arc::new(Grid::from_fn(SHADES, 1, |x, _| shade(x)));
    canvas.add(Primitive::Image { pixels, rect: bar });
    canvas.frame(bar.grown(0.5), 1.0, chrome.line);
    let (beside, below) = ([bar.min[0] - 0.5 * small, middle(&bar)[1]], bar.max[1] + 0.3 * small);
    canvas.text(beside, (Anchor::End, Level::Middle), surface.title, Type::text(style.theme));
    let [left, right] = [(bar.min[0], Anchor::Start, low), (bar.max[0], Anchor::End, high)]
        .map(|(x, anchor, value)| canvas.text([x, below], (anchor, Level::Top), &number(value), dim));
    let room = right.min[0] - left.max[0] - 2.0 * small;
    if dim.width(surface.unit) <= room {
        let x = (left.max[0] + right.min[0]) / 2.0;
        canvas.text([x, below], (Anchor::Middle, Level::Top), surface.unit, dim);
    }
}

fn color_bar(canvas: &mut Canvas, map: &Map, (surface, area): (&Surface, Rect), style: ChartStyle) {
    if Bar::of(area, style.theme) == Bar::Below {
        return color_bar_below(canvas, map, surface, style);
    }
    let Some([low, high]) = surface.shades() else { return };
    let (small, chrome, dim) = (map.small, style.theme.chrome(), Type::dim(style.theme));
    let min = [(map.rect.max[0] + 2.0 * small).round(), map.rect.min[1]];
    let bar = Rect::new(min, [small.round(), map.rect.size()[1]]);
    let shade = |y: usize| style.colors.at(1.0 - y as f32 / (SHADES - 1) as f32).0;
    let pixels = Arc::new(Grid::from_fn(1, SHADES, |_, y| shade(y)));
    canvas.add(Primitive::Image { pixels, rect: bar });
    canvas.frame(bar.grown(0.5), 1.0, chrome.line);
    let axis = Axis::new([low, high], [bar.max[1], bar.min[1]]);
    let mut label = |value: f32| {
        let y = axis.place(value);
        canvas.across([bar.max[0], bar.max[0] + 4.0], y, chrome.dim);
        canvas.text([bar.max[0] + 7.0, y], (Anchor::Start, Level::Middle), &number(value), dim);
    };
    label(low);
    if high > low {
        label(high);
        let clear = |v: &f32| [low, high].iter().all(|end| (axis.place(*v) - axis.place(*end)).abs() > 1.6 * small);
        axis.ticks(2.6 * small, 1e-6).into_iter().filter(clear).for_each(label);
    }
    if map.is_tight() {
        return;
    }
    // The bar is of the same quantity as the map.
    let above = [bar.min[0], map.rect.min[1] - 0.3 * small];
    canvas.text(above, (Anchor::Start, Level::Bottom), surface.title, Type::text(style.theme));
    let left = bar.min[0].min(area.max[0] - dim.width(surface.unit));
    canvas.text([left, bar.max[1] + 6.0], (Anchor::Start, Level::Top), surface.unit, dim);
}

#[cfg(test)]
mod tests {
    use super::super::texts;
    use super::*;

    fn surface() -> Surface {
        let values = Grid::from_fn(33, 17, |x, y| if y < 9 { (x + 40 * y) as f32 } else { f32::NAN });
        let events = Grid::from_fn(33, 17, |x, y| (y < 9).then_some(2 + x + 33 * y));
        let (probe, best) = (Some([0, 0]), Some([-16, -8]));
        Surface { unit: "gray levels", probe, best, ..Surface::new("SAD", [-16, -8], values, events) }
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn in_a_narrow_area_the_bar_stands_below_and_the_map_is_larger() {
        let surface = surface();
        let draw = |area: Rect| draw(HeatMap { surface: &surface, whose: "Full search" }, area, style());
        let narrow = Rect::new([20.0, 10.0], [220.0, 300.0]);
        let Drawing { place, body, .. } = draw(narrow);
        assert!(place.rect.size()[0] > 0.65 * narrow.size()[0], "{:?}", place.rect);
        let primitives: Vec<_> = body.into_iter().flat_map(|layer| layer.primitives).collect();
        let words = texts(&primitives);
        for label in ["0", "352", "SAD", "gray levels"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
        for primitive in &primitives {
            let Primitive::Text(line) = primitive else { continue };
            let covered = super::super::canvas::covered(line);
            assert!(covered.max[0] <= narrow.max[0] && covered.max[1] <= narrow.max[1], "{line:?} is cut off");
        }
    }

    #[test]
    fn the_map_has_the_colors_of_its_costs() {
        let surface = surface();
        let area = Rect::new([20.0, 10.0], [500.0, 300.0]);
        let Drawing { place, body, head } = draw(HeatMap { surface: &surface, whose: "Full search" }, area, style());
        let primitives: Vec<_> = body.into_iter().flat_map(|layer| layer.primitives).collect();
        let image = primitives.iter().find_map(|primitive| match primitive {
            Primitive::Image { pixels, rect } if *rect == place.rect => Some(pixels.clone()),
            _ => None,
        });
        let pixels = image.expect("a map");
        let [low, high] = surface.range().expect("costs");
        for at in [(0, 0), (5, 3), (32, 8)] {
            let share = (surface.values[at] - low) / (high - low);
            assert_eq!(pixels[at], ColorMap::Viridis.at(share).0, "{at:?}");
        }
        assert_eq!(pixels[(3, 12)][3], 0, "what was not tested is clear");
        let words = texts(&primitives);
        let least = "minimum 0 at (−16, −8)";
        for label in ["u, px →", "v, px ↓", "−16", "16", "352", "SAD", "gray levels", least] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
        assert_eq!(texts(&head), ["Full search · SAD by displacement"]);
    }

    #[test]
    fn the_map_tells_itself_in_words() {
        let description = "SAD by displacement: 297 of 561 tested, minimum 0 gray levels at (−16, −8)";
        assert_eq!(summary(&surface()), description);
        assert_eq!(cost(&surface(), [0, 8]), None);
        assert_eq!((event(&surface(), [-15, -7]), event(&surface(), [0, 8])), (Some(36), None));
        assert_eq!(cost(&surface(), [-40, 0]), None);
    }

    #[test]
    fn the_maximum_of_a_similarity_is_named() {
        let surface = Surface { is_similarity: true, unit: "", ..surface() };
        let description = "SAD by displacement: 297 of 561 tested, maximum 352 at (16, 0)";
        assert_eq!(summary(&surface), description);
        let area = Rect::new([20.0, 10.0], [800.0, 400.0]);
        let drawing = draw(HeatMap { surface: &surface, whose: "Full search" }, area, style());
        let words = texts(&drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect::<Vec<_>>());
        assert!(words.iter().any(|word| word == "maximum 352 at (16, 0)"), "{words:?}");
        assert!(!words.iter().any(|word| word.starts_with("minimum")), "{words:?}");
    }

    #[test]
    fn a_tie_is_named_and_the_scale_of_a_block_stays() {
        let mut surface = surface();
        surface.values[(4, 4)] = 0.0;
        assert!(summary(&surface).ends_with("minimum 0 gray levels, a tie of (−16, −8) and (−12, −4)"));
        surface.values[(5, 4)] = 0.0;
        assert!(summary(&surface).ends_with("minimum 0 gray levels, a tie of 3 displacements"));
        surface.scale = Some([0.0, 1000.0]);
        let area = Rect::new([20.0, 10.0], [500.0, 300.0]);
        let drawing = draw(HeatMap { surface: &surface, whose: "Full search" }, area, style());
        let words = texts(&drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect::<Vec<_>>());
        assert!(words.iter().any(|word| word == "1000"), "the scale ends where it always does: {words:?}");
        let shades = Shades::of(&surface, ColorMap::Viridis);
        assert_eq!(shades.at(500.0), ColorMap::Viridis.at(0.5));
    }

    #[test]
    fn the_whole_window_is_shown_however_little_is_tested() {
        let tested = |all: &[[i32; 2]]| {
            let at = |x: usize, y: usize| all.iter().position(|[u, v]| (u + 16, v + 16) == (x as i32, y as i32));
            let values = Grid::from_fn(33, 33, |x, y| at(x, y).map_or(f32::NAN, |i| (10 + i) as f32));
            let events = Grid::from_fn(33, 33, |x, y| at(x, y).map(|i| i + 2));
            Surface::new("SAD", [-16, -16], values, events)
        };
        let area = Rect::new([20.0, 10.0], [500.0, 300.0]);
        let map = |surface: &Surface| draw(HeatMap { surface, whose: "Diamond search" }, area, style()).place;
        let steps = [&[][..], &[[0, 0], [0, -2]], &[[0, 0], [6, 0]], &[[0, 0], [10, 0]]].map(|all| map(&tested(all)));
        assert!(steps.iter().all(|step| step.cell_rect([3, -4]) == steps[0].cell_rect([3, -4])));
    }

    #[test]
    fn what_a_search_left_out_is_faint_and_what_it_missed_is_marked() {
        let tested = |x: usize, y: usize| (x, y) == (20, 8) || (x, y) == (19, 8) || (x, y) == (20, 7);
        let costs = Grid::from_fn(33, 17, |x, y| (10 + x.abs_diff(4) + y) as f32);
        let values = Grid::from_fn(33, 17, |x, y| if tested(x, y) { costs[(x, y)] } else { f32::NAN });
        let events = Grid::from_fn(33, 17, |x, y| tested(x, y).then_some(x + y));
        let untested = Grid::from_fn(33, 17, |x, y| if tested(x, y) { f32::NAN } else { costs[(x, y)] });
        let surface = Surface {
            scale: Some([0.0, 60.0]),
            untested: Some(untested),
            truth: Some([-11.5, -8.0]),
            ..Surface::new("SAD", [-16, -8], values, events)
        };
        let area = Rect::new([20.0, 10.0], [700.0, 400.0]);
        let drawing = draw(HeatMap { surface: &surface, whose: "Diamond search" }, area, style());
        let primitives: Vec<_> = drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect();
        let words = texts(&primitives);
        for label in ["× missed: 10 at (−12, −8)", "× true motion (−11.50, −8.00)"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
        let pixels = costs_of(&primitives);
        let shades = Shades::of(&surface, ColorMap::Viridis);
        assert_eq!(pixels[(20, 8)], shades.at(34.0).0);
        assert_eq!(pixels[(4, 0)], shades.at(10.0).mix(Theme::Dark.chrome().raised, FAINT).0);
        let joined =
            |primitive: &&Primitive| matches!(primitive, Primitive::Polyline { points, .. } if points.len() == 3);
        assert_eq!(primitives.iter().filter(joined).count(), 1, "the tested cells are joined");
        assert_eq!(description(&surface, [-12, -8]), "(−12, −8): SAD 10, not tested");
    }

    fn costs_of(primitives: &[Primitive]) -> Grid<[u8; 4]> {
        let image = primitives.iter().find_map(|primitive| match primitive {
            Primitive::Image { pixels, .. } if pixels.size() == (33, 17) => Some(Grid::clone(pixels)),
            _ => None,
        });
        image.expect("a map")
    }

    #[test]
    fn a_candidate_that_was_given_up_is_not_called_untested() {
        let mut surface = surface();
        surface.events[(3, 9)] = Some(300);
        surface.events[(4, 9)] = Some(301);
        assert_eq!(
            summary(&surface),
            "SAD by displacement: 299 of 561 tested, 2 of them rejected early, minimum 0 gray levels at (−16, −8)"
        );
        let description = [[-15, -8], [-13, 1], [-11, 1]].map(|at| description(&surface, at));
        assert_eq!(description, ["SAD at (−15, −8) is 1", "(−13, 1) was rejected early", "(−11, 1) is not tested yet"]);
    }
}
