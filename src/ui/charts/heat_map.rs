//! A cost over displacements, as a map of colours that fills in as candidates are tested.

use std::hash::{DefaultHasher, Hash, Hasher};

use eframe::egui::{
    self, Align2, Color32, ColorImage, Painter, Pos2, Rect, Sense, Shape, Stroke, TextureHandle, TextureOptions, Ui,
    pos2, vec2,
};
use motionscope_core::Role;
use motionscope_core::scene::Surface;

use crate::paint::{ColorMap, Face, Theme, grouped, number};
use crate::ui::charts::axis::Axis;
use crate::ui::charts::map::Map;
use crate::ui::drawing::{ink, primitives};

/// What is said of a candidate whose cost was not summed to its end.
const GIVEN_UP: &str = "given up early";

/// What is mapped.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The costs.
    pub surface: &'a Surface,
    /// Colours for small and large costs.
    pub colors: ColorMap,
    /// The look.
    pub theme: Theme,
}

/// The map as a texture, as long as it stays the same.
#[derive(Clone, Default)]
pub struct State {
    texture: Option<(u64, TextureHandle)>,
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response {
    /// The event that tested the displacement that was clicked.
    pub clicked: Option<usize>,
    /// The displacement under the pointer, in px.
    pub hovered: Option<[i32; 2]>,
}

/// A number that changes when the surface does.
pub fn fingerprint(surface: &Surface) -> u64 {
    let mut hasher = DefaultHasher::new();
    surface.values.size().hash(&mut hasher);
    (surface.origin, surface.probe, surface.best).hash(&mut hasher);
    bytemuck::cast_slice::<f32, u8>(surface.values.cells()).hash(&mut hasher);
    surface.events.cells().hash(&mut hasher);
    hasher.finish()
}

/// Shows the map as large as it fits.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { surface, theme, .. } = input;
    let (area, _) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 80.0)), Sense::hover());
    let map = map(surface, area, theme);
    let sensed = ui.interact(map.rect, ui.scope_id().with("heat map"), Sense::click());
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(surface)));
    let hovered = sensed.hover_pos().and_then(|at| map.displacement(at));
    let painter = ui.painter_at(area);
    hatch(&painter, map.rect, theme);
    paint_costs(&painter, &map, input, state);
    map.axes(&painter, theme);
    for (role, at) in [(Role::Best, surface.best), (Role::Candidate, surface.probe)] {
        if let Some(at) = at {
            cross(&painter, &map, at, role, theme);
        }
    }
    if let Some(at) = hovered {
        let stroke = Stroke::new(1.5, ink::color(theme.chrome().text));
        painter.rect_stroke(map.cell_rect(at).expand(1.0), 0.0, stroke, egui::StrokeKind::Outside);
    }
    header(&painter, &map, area, input, hovered);
    color_bar(&painter, &map, input);
    let clicked = hovered.filter(|_| sensed.clicked()).and_then(|at| event(surface, at));
    Response { clicked, hovered }
}

fn map(surface: &Surface, area: Rect, theme: Theme) -> Map {
    // At the right stand the colour bar and its numbers.
    Map::new((surface.origin, surface.values.size()), area, 7.5, theme)
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

/// The event that tested a displacement, if one did.
fn event(surface: &Surface, at: [i32; 2]) -> Option<usize> {
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
    let best = surface.best.and_then(|at| Some(format!(", smallest {} at {}", number(cost(surface, at)?), vector(at))));
    format!("{} by displacement: {tested} of {all} tested{early}{}", surface.title, best.unwrap_or_default())
}

/// Fills the cells of candidates whose cost is not known since it was too large already.
fn neutral(theme: Theme) -> Color32 {
    let chrome = theme.chrome();
    ink::color(chrome.raised.mix(chrome.text, 0.3))
}

/// What was not tested yet: thin slanted lines.
fn hatch(painter: &Painter, rect: Rect, theme: Theme) {
    let chrome = theme.chrome();
    painter.rect_filled(rect, 0.0, ink::color(chrome.raised));
    let clipped = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    let stroke = Stroke::new(1.0, ink::color(chrome.raised.mix(chrome.text, 0.14)));
    let mut x = rect.min.x - rect.height();
    while x < rect.max.x {
        clipped.line_segment([pos2(x, rect.max.y), pos2(x + rect.height(), rect.min.y)], stroke);
        x += 8.0;
    }
}

fn paint_costs(painter: &Painter, map: &Map, input: Input<'_>, state: &mut State) {
    let [low, high] = input.surface.range().unwrap_or_default();
    let mut hasher = DefaultHasher::new();
    (fingerprint(input.surface), input.colors.name(), input.theme).hash(&mut hasher);
    let key = hasher.finish();
    if state.texture.as_ref().is_none_or(|(known, _)| *known != key) {
        let (width, height) = input.surface.values.size();
        let span = (high - low).max(f32::MIN_POSITIVE);
        let color = |(cost, event): (&f32, &Option<usize>)| match event {
            _ if cost.is_finite() => ink::color(input.colors.at((cost - low) / span)),
            Some(_) => neutral(input.theme),
            None => Color32::TRANSPARENT,
        };
        let pixels = input.surface.values.cells().iter().zip(input.surface.events.cells()).map(color).collect();
        let image = ColorImage::new([width, height], pixels);
        match &mut state.texture {
            Some((known, texture)) => {
                *known = key;
                texture.set(image, TextureOptions::NEAREST);
            }
            None => {
                state.texture = Some((key, painter.ctx().load_texture("costs", image, TextureOptions::NEAREST)));
            }
        }
    }
    if let Some((_, texture)) = &state.texture {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.add(Shape::image(texture.id(), map.rect, whole, Color32::WHITE));
    }
}

/// Thin lines through a displacement, and a frame around its cell.
fn cross(painter: &Painter, map: &Map, at: [i32; 2], role: Role, theme: Theme) {
    let inked = theme.ink(role);
    let cell = map.cell_rect(at);
    let color = ink::color(inked.color);
    let clipped = painter.with_clip_rect(map.rect.expand(4.0).intersect(painter.clip_rect()));
    for (width, color) in [(2.5, Color32::from_black_alpha(90)), (1.0, color.gamma_multiply(0.8))] {
        clipped.hline(map.rect.x_range(), cell.center().y, Stroke::new(width, color));
        clipped.vline(cell.center().x, map.rect.y_range(), Stroke::new(width, color));
    }
    let frame = Rect::from_center_size(cell.center(), cell.size().max(vec2(7.0, 7.0)));
    let rim = Stroke::new(inked.width + 2.0 * inked.halo_width, ink::color(inked.halo));
    painter.rect_stroke(frame.expand(inked.width / 2.0), 0.0, rim, egui::StrokeKind::Middle);
    painter.rect_stroke(
        frame.expand(inked.width / 2.0),
        0.0,
        Stroke::new(inked.width, color),
        egui::StrokeKind::Middle,
    );
}

/// What is mapped, and the cost under the pointer.
fn header(painter: &Painter, map: &Map, area: Rect, input: Input<'_>, hovered: Option<[i32; 2]>) {
    let chrome = input.theme.chrome();
    let font = ink::font(Face::Sans, map.small);
    let y = area.min.y + 0.7 * map.small;
    let told = told(input.surface, hovered);
    let mut right = area.max.x;
    if tested(input.surface).1 > 0 {
        let dim = ink::color(chrome.dim);
        let words = painter.layout_no_wrap(GIVEN_UP.into(), font.clone(), dim);
        let swatch = Rect::from_center_size(pos2(0.0, y), vec2(map.small, map.small));
        let swatch = swatch.translate(vec2((right - words.size().x - 1.2 * map.small).round(), 0.0));
        painter.rect_filled(swatch, 0.0, neutral(input.theme));
        painter.galley(pos2(right - words.size().x, y - words.size().y / 2.0), words, dim);
        right = swatch.min.x - map.small;
    }
    ink::line(painter, pos2(map.rect.min.x, y), (&told, font, ink::color(chrome.text)), right - map.rect.min.x);
}

/// What is mapped, or what is known of the displacement pointed at.
fn told(surface: &Surface, hovered: Option<[i32; 2]>) -> String {
    let Some(at) = hovered else { return format!("{} by displacement", surface.title) };
    match (cost(surface, at), event(surface, at)) {
        (Some(cost), _) => format!("{} at {} is {}", surface.title, vector(at), number(cost)),
        (None, Some(_)) => format!("{} was {GIVEN_UP}", vector(at)),
        (None, None) => format!("{} is not tested yet", vector(at)),
    }
}

fn color_bar(painter: &Painter, map: &Map, input: Input<'_>) {
    let Some([low, high]) = input.surface.range() else { return };
    let bar =
        Rect::from_min_size(pos2(map.rect.max.x + 2.0 * map.small, map.rect.min.y), vec2(map.small, map.rect.height()));
    let colors: Vec<[u8; 4]> = (0..=32).rev().map(|i| input.colors.at(i as f32 / 32.0).0).collect();
    painter.add(primitives::gradient_down(bar, &colors));
    let chrome = input.theme.chrome();
    painter.rect_stroke(bar, 0.0, Stroke::new(1.0, ink::color(chrome.line)), egui::StrokeKind::Outside);
    let axis = Axis { values: [low, high], places: [bar.max.y, bar.min.y] };
    let font = ink::font(Face::Sans, map.small);
    let dim = ink::color(chrome.dim);
    let label = |value: f32| {
        let y = axis.place(value);
        painter.hline(bar.max.x..=bar.max.x + 4.0, y, Stroke::new(1.0, dim));
        painter.text(pos2(bar.max.x + 7.0, y), Align2::LEFT_CENTER, number(value), font.clone(), dim);
    };
    label(low);
    if high > low {
        label(high);
        let clear = |v: &f32| [low, high].iter().all(|end| (axis.place(*v) - axis.place(*end)).abs() > 1.6 * map.small);
        axis.ticks(2.6 * map.small, 1e-6).into_iter().filter(clear).for_each(label);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::Grid;

    fn surface() -> Surface {
        let values = Grid::from_fn(33, 17, |x, y| if y < 9 { (x + 40 * y) as f32 } else { f32::NAN });
        let events = Grid::from_fn(33, 17, |x, y| (y < 9).then_some(2 + x + 33 * y));
        Surface { title: "SAD", origin: [-16, -8], values, events, probe: Some([0, 0]), best: Some([-16, -8]) }
    }

    #[test]
    fn the_pointer_finds_the_displacement_whose_cell_it_is_on() {
        let area = Rect::from_min_size(pos2(20.0, 10.0), vec2(500.0, 300.0));
        let map = map(&surface(), area, Theme::Dark);
        assert!(area.contains_rect(map.rect));
        for at in [[-16, -8], [0, 0], [16, 8], [5, -3]] {
            assert_eq!(map.displacement(map.cell_rect(at).center()), Some(at));
            let (x, y) = (map.axis(0), map.axis(1));
            let center = map.cell_rect(at).center();
            assert!((x.place(at[0] as f32) - center.x).abs() < 0.01 && (y.place(at[1] as f32) - center.y).abs() < 0.01);
        }
        assert_eq!(map.displacement(area.min), None);
    }

    #[test]
    fn the_map_tells_itself_in_words() {
        assert_eq!(summary(&surface()), "SAD by displacement: 297 of 561 tested, smallest 0 at (−16, −8)");
        assert_eq!(cost(&surface(), [0, 8]), None);
        assert_eq!((event(&surface(), [-15, -7]), event(&surface(), [0, 8])), (Some(36), None));
        assert_eq!(cost(&surface(), [-40, 0]), None);
    }

    #[test]
    fn a_candidate_that_was_given_up_is_not_called_untested() {
        let mut surface = surface();
        surface.events[(3, 9)] = Some(300);
        surface.events[(4, 9)] = Some(301);
        assert_eq!(
            summary(&surface),
            "SAD by displacement: 299 of 561 tested, 2 of them given up early, smallest 0 at (−16, −8)"
        );
        let told = [[-15, -8], [-13, 1], [-11, 1]].map(|at| told(&surface, Some(at)));
        assert_eq!(told, ["SAD at (−15, −8) is 1", "(−13, 1) was given up early", "(−11, 1) is not tested yet"]);
    }

    #[test]
    fn a_fingerprint_changes_with_the_surface() {
        let (a, mut b) = (surface(), surface());
        assert_eq!(fingerprint(&a), fingerprint(&b));
        b.values[(4, 4)] += 1.0;
        assert_ne!(fingerprint(&a), fingerprint(&b));
        let mut c = surface();
        c.events[(0, 9)] = Some(300);
        assert_ne!(fingerprint(&a), fingerprint(&c), "a candidate was given up");
    }
}
