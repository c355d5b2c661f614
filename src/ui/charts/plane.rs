//! The plane of displacements: what pixels allow, as lines, and displacements as points.

use eframe::egui::{self, Align2, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};
use motionscope_core::Role;
use motionscope_core::scene::{Plane, Spread};

use crate::paint::{self, Face, Theme, legend, number};
use crate::ui::charts::axis::Axis;
use crate::ui::drawing::{ink, primitives};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The lines and points.
    pub plane: &'a Plane,
    /// The look.
    pub theme: Theme,
}

/// Where the plane lies.
struct Map {
    rect: Rect,
    across: Axis,
    down: Axis,
}

impl Map {
    fn new(area: Rect, reach: f32, small: f32) -> Self {
        // Room for the title and for the numbers at the axes.
        let room = Rect::from_min_max(area.min + vec2(4.0 * small, 2.6 * small), area.max - vec2(small, 2.0 * small));
        let side = room.width().min(room.height()).max(8.0);
        let rect = Rect::from_min_size(room.min, vec2(side, side));
        let axis = |from, to| Axis { values: [-reach, reach], places: [from, to] };
        Self { rect, across: axis(rect.min.x, rect.max.x), down: axis(rect.min.y, rect.max.y) }
    }

    fn at(&self, [u, v]: [f32; 2]) -> Pos2 {
        pos2(self.across.place(u), self.down.place(v))
    }
}

/// Shows the plane as large as it fits.
pub fn show(ui: &mut Ui, input: Input<'_>) {
    let Input { plane, theme } = input;
    let size = ui.available_size().max(vec2(80.0, 80.0));
    let (area, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(plane)));
    let small = theme.sizes().small;
    let map = Map::new(area, plane.reach, small);
    let painter = ui.painter_at(area);
    let font = ink::font(Face::Sans, small);
    // Beside the name of the axis.
    let title = format!("{}, in {}", plane.title, plane.unit);
    painter.text(pos2(map.rect.min.x, area.min.y), Align2::LEFT_TOP, title, font, ink::color(theme.chrome().dim));
    axes(&painter, &map, theme);
    let inside = painter.with_clip_rect(map.rect);
    for line in &plane.lines {
        if let Some(ends) = line.within(plane.reach) {
            let ink = theme.ink(line.role);
            let color = ink::color(ink.color).gamma_multiply(0.25 + 0.75 * line.weight);
            inside.line_segment(ends.map(|end| map.at(end)), Stroke::new(1.0 + line.weight, color));
        }
    }
    if let Some(ellipse) = &plane.ellipse {
        spread(&inside, &map, ellipse, theme);
    }
    names(&painter, &map, area, input);
}

fn axes(painter: &Painter, map: &Map, theme: Theme) {
    let chrome = theme.chrome();
    let small = theme.sizes().small;
    let font = ink::font(Face::Sans, small);
    let (dim, faint) = (ink::color(chrome.dim), Stroke::new(1.0, ink::color(chrome.line)));
    painter.rect_stroke(map.rect, 0.0, faint, egui::StrokeKind::Outside);
    for u in halves(&map.across, 3.6 * small) {
        painter.vline(map.across.place(u), map.rect.y_range(), faint);
        let below = pos2(map.across.place(u), map.rect.max.y + 4.0);
        painter.text(below, Align2::CENTER_TOP, tick(u), font.clone(), dim);
    }
    for v in halves(&map.down, 2.0 * small) {
        painter.hline(map.rect.x_range(), map.down.place(v), faint);
        let beside = pos2(map.rect.min.x - 6.0, map.down.place(v));
        painter.text(beside, Align2::RIGHT_CENTER, tick(v), font.clone(), dim);
    }
    let (text, name) = (ink::color(chrome.text), ink::font(Face::Italic, small));
    // The first axis goes to the right, the second down, as in the picture.
    let beside = pos2(map.rect.max.x + 1.4 * small, map.rect.max.y + 4.0);
    painter.text(beside, Align2::LEFT_TOP, "u →", name.clone(), text);
    let above = pos2(map.rect.min.x - 6.0, map.rect.min.y - 0.5 * small);
    painter.text(above, Align2::RIGHT_BOTTOM, "v ↓", name, text);
}

/// Ticks at halves, quarters and so on of what an axis reaches, at least `spacing` points apart: how far a plane reaches
/// goes by powers of two.
fn halves(axis: &Axis, spacing: f32) -> Vec<f32> {
    let reach = axis.values[1];
    let apart = |step: f32| (axis.place(step) - axis.place(0.0)).abs();
    let steps = std::iter::successors(Some(reach), |step| Some(step / 2.0));
    let step = steps.take(4).take_while(|step| apart(*step) >= spacing).last().unwrap_or(reach);
    let count = (reach / step).round() as i32;
    (-count..=count).map(|i| i as f32 * step).collect()
}

/// A number at an axis, without zeros that tell nothing: `0.5`.
fn tick(value: f32) -> String {
    let shown = number(value);
    if shown.contains('.') { shown.trim_end_matches('0').trim_end_matches('.').into() } else { shown }
}

fn spread(painter: &Painter, map: &Map, spread: &Spread, theme: Theme) {
    // One px is as long across as down.
    let px = map.across.place(1.0) - map.across.place(0.0);
    let rim = paint::ellipse(map.at(spread.center).into(), spread.radii.map(|r| r * px), spread.angle_rad);
    let ink = theme.ink(Role::Measured);
    let points = rim.into_iter().map(Pos2::from).collect();
    painter.add(Shape::closed_line(points, Stroke::new(ink.width, ink::color(ink.color))));
}

/// The points, and beside the plane what each is called.
fn names(painter: &Painter, map: &Map, area: Rect, Input { plane, theme }: Input<'_>) {
    let small = theme.sizes().small;
    let font = ink::font(Face::Sans, small);
    let mut at = pos2(map.rect.max.x + small, map.rect.min.y);
    // Where the plane is small, a name and its place share a line.
    let is_short = 3.2 * small * plane.points.len() as f32 > map.rect.height();
    for (name, role, uv) in &plane.points {
        let is_inside = map.rect.contains(map.at(*uv));
        if is_inside {
            painter.extend(primitives::shapes(painter, &legend::point(*role, theme, map.at(*uv).into())));
        }
        let sample = legend::point(*role, theme, (at + vec2(small, small) / 2.0).into());
        painter.extend(primitives::shapes(painter, &sample));
        let place = format!("({}, {})", number(uv[0]), number(uv[1]));
        if at.x + 2.0 * small < area.max.x {
            let (text, dim) = (ink::color(theme.chrome().text), ink::color(theme.chrome().dim));
            let named = at + vec2(1.8 * small, -0.2 * small);
            let name = painter.text(named, Align2::LEFT_TOP, name, font.clone(), text);
            let placed =
                if is_short { name.right_top() + vec2(0.6 * small, 0.0) } else { named + vec2(0.0, 1.4 * small) };
            painter.text(placed, Align2::LEFT_TOP, place, font.clone(), dim);
        }
        at.y += if is_short { 1.7 } else { 3.2 } * small;
    }
}

/// What the plane shows, for those who cannot see it.
fn summary(plane: &Plane) -> String {
    let points = plane.points.iter().map(|(name, _, [u, v])| format!("{name} at ({}, {})", number(*u), number(*v)));
    let lines = match plane.lines.len() {
        1 => "one line".to_owned(),
        count => format!("{count} lines"),
    };
    let spread = plane.ellipse.as_ref().map(|spread| {
        let [long, short] = spread.radii.map(number);
        format!("one standard deviation {long} by {short} {}", plane.unit)
    });
    [format!("{}: {lines}", plane.title)].into_iter().chain(points).chain(spread).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Constraint;

    use super::*;

    #[test]
    fn the_plane_is_told_in_words_and_lies_the_right_way_up() {
        let line = Constraint { factors: [1.0, 0.0, -1.0], weight: 1.0, role: Role::Candidate };
        let points = vec![("normal flow", Role::Result, [1.0, -0.25])];
        let (title, lines) = ("Gradient constraint", vec![line]);
        let plane = Plane { title, unit: "px".into(), reach: 2.0, lines, points, ellipse: None };
        assert_eq!(summary(&plane), "Gradient constraint: one line, normal flow at (1, −0.250)");
        let spread = Spread { center: [1.0, 0.0], radii: [0.5, 0.25], angle_rad: 0.0 };
        let told = summary(&Plane { ellipse: Some(spread), ..plane });
        assert!(told.ends_with("one standard deviation 0.500 by 0.250 px"), "{told}");
        let map = Map::new(Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0)), 2.0, 10.0);
        assert!(map.at([1.0, 0.0]).x > map.at([0.0, 0.0]).x && map.at([0.0, 1.0]).y > map.at([0.0, 0.0]).y);
        assert_eq!(map.at([0.0, 0.0]), map.rect.center());
        // Even a small plane has more than its middle to go by.
        let ticks = |side: f32, reach| {
            halves(&Map::new(Rect::from_min_size(Pos2::ZERO, vec2(side, side)), reach, 12.0).across, 40.0)
        };
        assert_eq!(ticks(120.0, 8.0), [-8.0, 0.0, 8.0]);
        assert_eq!(ticks(260.0, 1.0), [-1.0, -0.5, 0.0, 0.5, 1.0]);
    }
}
