//! Marks of a scene become primitives: the one place where roles turn into ink.

mod arrows;
mod labels;

use std::collections::HashMap;
use std::sync::Arc;

use arrows::{DISTINCT, apart, cell, fitting, length, way};
use labels::{Label, Side, apart_labels};
use motionscope_core::geometry::Grid;
use motionscope_core::products::Streak;
use motionscope_core::scene::{self, Mark, Role, Scene, Shape};

pub(super) use arrows::is_thinned;

use super::fonts::Face;
use super::primitive::{Anchor, Arrows, Line, Pen, Point, Primitive, Rect, Run, Stroke, Trails};
use super::{Color, ColorMap, Ink, PointShape, Theme, mask};

/// How near to each other the arrows of a dense field are drawn unless it is chosen, in points of the window and pixels of a file.
const AIRY: f32 = 9.0;
/// Where the arrows of a dense field stand this far apart on the screen, in points, there is room for one more between two.
const ROOMY: f32 = 28.0;

/// What a person chooses of how a scene looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    /// Theme.
    pub theme: Theme,
    /// Colours for heat.
    pub colors: ColorMap,
    /// How displacements are drawn.
    pub arrows: ArrowStyle,
}

/// How displacements are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArrowStyle {
    /// How long.
    pub lengthen: Lengthen,
    /// From one to the next, in px of the picture; `None` for as many as there is room for.
    pub spacing_px: Option<u16>,
    /// For how many frames particles are carried along, where streaklines stand in their place.
    pub streak_frames: Option<u16>,
}

/// How a scene is to look, the same in every painter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Theme.
    pub theme: Theme,
    /// Colours for heat.
    pub colors: ColorMap,
    /// The numbers shown in the first and last of those colours.
    pub heat: Option<[f32; 2]>,
    /// How many times their length displacements are drawn.
    pub lengthen: f32,
    /// From one displacement to the next in px, if that is chosen.
    pub spacing: Option<f32>,
    /// For how many frames particles are carried along, where streaklines stand in the place of displacements.
    pub streak_frames: Option<u16>,
    /// Pixels that a point becomes, as far as they make room for more marks; 1 in the window.
    pub density: f32,
}

/// How long displacements are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Lengthen {
    /// At most as long as a step from block to block, by a power of two.
    #[default]
    Auto,
    /// This many times their length.
    Times(f32),
}

impl Look {
    /// The look of `scene`: heat spans the values that it has, and how long displacements are drawn is settled.
    pub fn new(scene: &Scene, style: Style) -> Self {
        let Style { theme, colors, arrows: ArrowStyle { lengthen, spacing_px, streak_frames } } = style;
        let spacing = spacing_px.map(|px| f32::from(px.max(1)));
        let lengthen = match lengthen {
            Lengthen::Auto => fitting(scene, spacing).unwrap_or(1.0),
            Lengthen::Times(factor) if factor.is_finite() && factor > 0.0 => factor,
            Lengthen::Times(_) => 1.0,
        };
        let heat = heat_range(scene).map(|range| scene.heat_scale.unwrap_or(range));
        // Numbers of both signs have 0 in the middle of their own colours.
        let signed = heat.filter(|[low, high]| *low < 0.0 && *high > 0.0).map(|[low, high]| high.max(-low));
        let (heat, colors) = match signed {
            Some(most) => (Some([-most, most]), ColorMap::Diverging),
            None => (heat, colors),
        };
        Self { theme, colors, heat, lengthen, spacing, streak_frames, density: 1.0 }
    }
}

/// Where a picture lies: its upper left corner in points, and points per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Upper left corner of the first pixel.
    pub origin: Point,
    /// Points per pixel.
    pub zoom: f32,
    /// What of the sheet can be seen, in points, if not all of it: dense fields draw no arrows elsewhere.
    pub seen: Option<Rect>,
    /// Where the labels of boxes have to stand, in points, if not anywhere: the part of the picture that is seen.
    pub room: Option<Rect>,
}

impl Placement {
    /// The whole of a picture.
    pub fn new(origin: Point, zoom: f32) -> Self {
        Self { origin, zoom, seen: None, room: None }
    }

    /// Where a place in image pixels (pixel centres at integers) lies.
    pub fn at(&self, [x, y]: [f32; 2]) -> Point {
        [self.origin[0] + (x + 0.5) * self.zoom, self.origin[1] + (y + 0.5) * self.zoom]
    }

    /// The place in image pixels that lies there.
    pub fn pixel(&self, [x, y]: Point) -> [f32; 2] {
        [(x - self.origin[0]) / self.zoom - 0.5, (y - self.origin[1]) / self.zoom - 0.5]
    }

    fn rect(&self, min: [f32; 2], max: [f32; 2]) -> Rect {
        let (a, b) = (self.at(min), self.at(max));
        Rect { min: [a[0].min(b[0]), a[1].min(b[1])], max: [a[0].max(b[0]), a[1].max(b[1])] }
    }
}

/// Whether arrows of `role` are displacements that may be lengthened. The others point at a place that they must reach.
pub fn is_lengthened(role: Role) -> bool {
    matches!(role, Role::Result | Role::Truth | Role::Error)
}

/// What `marks` look like at `place`, back to front. Line widths do not depend on the zoom.
pub fn resolve<'a>(marks: impl IntoIterator<Item = &'a Mark>, look: &Look, place: Placement) -> Vec<Primitive> {
    let mut primitives = Vec::new();
    // What is under test is seen also where it lies on the best; its costs lie below all lines.
    let is_under_test = |mark: &&Mark| mark.role == Role::Candidate && !mark.shape.is_layer();
    let (under_test, others): (Vec<_>, Vec<_>) = marks.into_iter().partition(is_under_test);
    let has_regions = others.iter().any(|mark| matches!(mark.shape, Shape::Labels(_)));
    let (mut labels, mut boxes) = (Vec::new(), HashMap::new());
    for mark in others.into_iter().chain(under_test).filter(|mark| mark.shape.is_finite()) {
        let mut ink = look.theme.ink(mark.role);
        ink.color = mark.of.map_or(ink.color, |identity| color_of(identity, has_regions));
        match &mark.shape {
            Shape::Text { at, text } => labels.push((mark.role, *at, text, ink)),
            shape => {
                if let Shape::Rect { min, max } = shape {
                    let rect = place.rect(*min, *max).grown(ink.width + ink.halo_width);
                    boxes.insert(corner(*min), (rect, Side::Above));
                    boxes.insert(corner([min[0], max[1]]), (rect, Side::Below));
                }
                Painter { ink, look, place, out: &mut primitives }.shape(mark.role, shape);
            }
        }
    }
    let label = |(role, at, text, ink): (Role, [f32; 2], &String, Ink)| {
        let size = look.theme.sizes().small;
        let runs = vec![Run::new(text, ink.color).face(Face::Bold)];
        let line = Line { at: place.at(at), anchor: Anchor::Start, size, runs, halo: Some(ink.halo) };
        Label::new(role, line, boxes.get(&corner(at)).copied(), place.room)
    };
    // Lines never cross out a label.
    primitives.extend(apart_labels(labels.into_iter().map(label)).map(Primitive::Text));
    primitives
}

/// A corner of a box, to look it up.
fn corner(at: [f32; 2]) -> [u32; 2] {
    at.map(f32::to_bits)
}

struct Painter<'a> {
    ink: Ink,
    look: &'a Look,
    place: Placement,
    out: &'a mut Vec<Primitive>,
}

impl Painter<'_> {
    fn shape(&mut self, role: Role, shape: &Shape) {
        match shape {
            Shape::Rect { min, max } => {
                let rect = self.place.rect(*min, *max);
                let [width, height] = rect.size();
                self.thin_out((width.min(height) / 5.0).max(1.0));
                // The line lies outside, so that it hides no pixel of what it frames.
                self.outline(rect.grown(self.ink.width / 2.0).corners());
            }
            Shape::Ellipse { center, radii, angle_rad } => {
                self.outline(ellipse(*center, *radii, *angle_rad).into_iter().map(|p| self.place.at(p)).collect());
            }
            Shape::Path { points, closed } => {
                line(self.out, &self.ink, points.iter().map(|&p| self.place.at(p)).collect(), *closed);
            }
            Shape::Arrows(arrows) => self.arrows(role, arrows),
            Shape::Points(points) => {
                // Neighbours that are tested one after the other must not merge into a blob.
                let reach = 0.36 * nearest(points) * self.place.zoom;
                let ink = self.ink;
                let radius = (POINT + ink.width).min(reach.max(LEAST_POINT));
                let thin = radius / (POINT + ink.width);
                let ink = Ink { width: (ink.width * thin).max(0.8), halo_width: ink.halo_width * thin, ..ink };
                for &at in points {
                    sized_point(self.out, &ink, self.place.at(at), radius);
                }
            }
            // Labels are placed once all else is known.
            Shape::Text { .. } => {}
            Shape::Heat { origin, values } => self.heat(*origin, values),
            Shape::Flow { origin, values } => self.flow(role, *origin, values),
            Shape::Mask(mask) => {
                let scale = mask::scale(mask.size(), self.place.zoom * self.look.density);
                let pixels = mask::outlined(mask, (role, &self.ink), (scale, self.place.zoom));
                let (width, height) = mask.size();
                let rect = self.place.rect([-0.5; 2], [width as f32 - 0.5, height as f32 - 0.5]);
                self.out.push(Primitive::Image { pixels: Arc::new(pixels), rect });
            }
            Shape::Labels(labels) => self.layer([0.0; 2], labels.map(|&label| region_color(label))),
        }
    }

    /// Makes lines at most `width` wide, and the rim no wider than fits to that.
    fn thin_out(&mut self, width: f32) {
        self.ink.width = self.ink.width.min(width);
        self.ink.halo_width = self.ink.halo_width.min(width / 2.0);
    }

    /// A closed convex shape: its fill, if the ink has one, and its line.
    fn outline(&mut self, points: Vec<Point>) {
        if self.ink.fill.0[3] > 0 {
            self.out.push(Primitive::Polygon { points: points.clone(), color: self.ink.fill });
        }
        line(self.out, &self.ink, points, true);
    }

    fn arrows(&mut self, role: Role, arrows: &[scene::Arrow]) {
        let Placement { zoom, .. } = self.place;
        let room = zoom * self.look.density;
        // Streaklines stand in the place of a field of results.
        if self.look.streak_frames.is_some() && role == Role::Result && arrows.len() > 1 {
            return;
        }
        self.thin_out(2.0 * self.ink.halo_width);
        match arrows {
            // One that points at a place is thin if it is short: it must not bury what it points at.
            [arrow] if !is_lengthened(role) => self.thin_out((0.3 * zoom * length(way(arrow))).max(0.8)),
            // Where neighbours are close, arrows are thinner.
            [_, _, ..] => self.thin_out((0.1 * cell(arrows, room, self.look.spacing) * zoom).max(0.5)),
            _ => {}
        }
        self.pushed(role, apart(arrows, room, self.look.spacing));
    }

    fn pushed(&mut self, role: Role, ends: Arc<[scene::Arrow]>) {
        let Ink { color, halo, halo_width, width, .. } = self.ink;
        self.out.push(Primitive::Arrows(Arrows {
            ends,
            origin: self.place.at([0.0; 2]),
            zoom: self.place.zoom,
            lengthen: if is_lengthened(role) { self.look.lengthen } else { 1.0 },
            pen: Pen { width, color, halo, halo_width },
        }));
    }

    /// The arrows of a dense field: the closer one looks, the more of them.
    fn flow(&mut self, role: Role, origin: [f32; 2], values: &Grid<[f32; 2]>) {
        if self.look.streak_frames.is_some() {
            return;
        }
        let Placement { zoom, seen, .. } = self.place;
        let mut step = self.look.spacing.map_or_else(|| scene::arrow_spacing(values.size()), |px| px as usize);
        while self.look.spacing.is_none() && step > 1 && step as f32 * zoom >= ROOMY {
            step /= 2;
        }
        // What is chosen is kept to, whatever it hides.
        step = match self.look.spacing {
            Some(_) => step.max((DISTINCT / (zoom * self.look.density)).ceil() as usize),
            None => step * (AIRY / (step as f32 * zoom * self.look.density)).ceil().max(1.0) as usize,
        };
        // Arrows that start a little outside may reach into what is seen.
        let first = self.place.at(origin);
        let range = |i: usize, extent: usize| match seen {
            Some(rect) => [(rect.min[i], -4.0), (rect.max[i], 4.0)].map(|(edge, margin)| {
                ((edge - first[i]) / zoom + margin * step as f32).clamp(0.0, extent as f32) as usize
            }),
            None => [0, extent],
        };
        let along = |i: usize, extent: usize| {
            let [from, to] = range(i, extent);
            (step / 2..extent).step_by(step).filter(move |c| (from..to).contains(c))
        };
        let arrow = |(x, y): (usize, usize)| {
            let [u, v] = values[(x, y)];
            let from = [origin[0] + x as f32, origin[1] + y as f32];
            (u.is_finite() && v.is_finite()).then(|| scene::Arrow { from, to: [from[0] + u, from[1] + v] })
        };
        let (columns, rows) = (along(0, values.width()), along(1, values.height()));
        let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        let ends: Arc<[_]> = places.filter_map(arrow).collect();
        if !ends.is_empty() {
            self.thin_out(2.0 * self.ink.halo_width);
            self.thin_out((0.1 * step as f32 * zoom).max(0.5));
            self.pushed(role, ends);
        }
    }

    fn heat(&mut self, origin: [f32; 2], values: &Grid<f32>) {
        let Some([low, high]) = self.look.heat else { return };
        let span = (high - low).max(f32::MIN_POSITIVE);
        self.layer(
            origin,
            values.map(|&v| match self.look.colors.at((v - low) / span) {
                color if v.is_finite() => color.alpha(mask::HEAT_ALPHA).0,
                _ => [0; 4],
            }),
        );
    }

    /// A picture whose first pixel lies over pixel `origin`.
    fn layer(&mut self, origin: [f32; 2], pixels: Grid<[u8; 4]>) {
        let (width @ 1.., height @ 1..) = pixels.size() else { return };
        let min = origin.map(|c| c - 0.5);
        let rect = self.place.rect(min, [min[0] + width as f32, min[1] + height as f32]);
        self.out.push(Primitive::Image { pixels: Arc::new(pixels), rect });
    }
}

/// The colour of a region; none for 0.
pub fn region_color(label: u32) -> [u8; 4] {
    if label == 0 { [0; 4] } else { own_color(label).alpha(mask::HEAT_ALPHA).0 }
}

/// The colour of the marks of one of several objects: that of a region would not be seen on that very colour.
pub(super) fn color_of(identity: u32, has_regions: bool) -> Color {
    if has_regions { Color::WHITE } else { own_color(identity) }
}

/// The colour of one of several: hues a golden section apart, so that neighbouring numbers differ.
pub(super) fn own_color(label: u32) -> Color {
    let hue = 6.0 * (label as f32 * 0.618_034).fract();
    let part = |center: f32| {
        let far = (hue - center).abs().min(6.0 - (hue - center).abs());
        (255.0 * (2.0 - far).clamp(0.15, 1.0)) as u8
    };
    Color([part(0.0), part(2.0), part(4.0), 255])
}

/// Points along an ellipse, whatever the unit.
pub fn ellipse(center: Point, radii: [f32; 2], angle_rad: f32) -> Vec<Point> {
    let (sin, cos) = angle_rad.sin_cos();
    let on_rim = |i: usize| {
        let (y, x) = (i as f32 / 64.0 * std::f32::consts::TAU).sin_cos();
        let (x, y) = (x * radii[0], y * radii[1]);
        [center[0] + x * cos - y * sin, center[1] + x * sin + y * cos]
    };
    (0..64).map(on_rim).collect()
}

/// A line in `ink` along `points`: the rim, solid even under dashes, and the line.
pub(super) fn line(out: &mut Vec<Primitive>, ink: &Ink, points: Vec<Point>, closed: bool) {
    if points.len() < 2 {
        return;
    }
    if ink.halo_width > 0.0 {
        let rim = Stroke { width: ink.width + 2.0 * ink.halo_width, color: ink.halo, dash: &[] };
        out.push(Primitive::Polyline { points: points.clone(), closed, stroke: rim });
    }
    let stroke = Stroke { width: ink.width, color: ink.color, dash: ink.dash };
    out.push(Primitive::Polyline { points, closed, stroke });
}

/// Radius of a point beyond its line, in points.
const POINT: f32 = 2.0;
/// Radius of the smallest point, in points.
const LEAST_POINT: f32 = 1.2;
/// Points sampled to estimate how densely they lie.
const SAMPLED: usize = 48;

/// Distance of the two nearest of `points`, of the first if there are many.
fn nearest(points: &[[f32; 2]]) -> f32 {
    let asked = &points[..points.len().min(SAMPLED)];
    let gap = |a: &[f32; 2], b: &[f32; 2]| length([a[0] - b[0], a[1] - b[1]]);
    let all = asked.iter().enumerate().flat_map(|(i, a)| asked[..i].iter().map(move |b| gap(a, b)));
    all.filter(|gap| *gap > 0.0).fold(f32::INFINITY, f32::min)
}

/// A point in `ink` at `at`.
pub(super) fn point(out: &mut Vec<Primitive>, ink: &Ink, at: Point) {
    sized_point(out, ink, at, POINT + ink.width);
}

/// The same with a radius in points.
fn sized_point(out: &mut Vec<Primitive>, ink: &Ink, at: Point, r: f32) {
    let around = |offsets: &[Point]| offsets.iter().map(|o| [at[0] + o[0] * r, at[1] + o[1] * r]).collect::<Vec<_>>();
    match ink.point {
        PointShape::Disc => {
            let rim = Some((r + ink.halo_width, ink.halo)).filter(|_| ink.halo_width > 0.0);
            for (radius, color) in rim.into_iter().chain([(r, ink.color)]) {
                out.push(Primitive::Disc { center: at, radius, color });
            }
        }
        PointShape::Ring => {
            let solid = Ink { dash: &[], ..*ink };
            line(out, &solid, ellipse(at, [r + 1.0; 2], 0.0), true);
        }
        PointShape::Plus => cross(out, ink, [around(&[[-1.5, 0.0], [1.5, 0.0]]), around(&[[0.0, -1.5], [0.0, 1.5]])]),
        PointShape::Cross => {
            cross(out, ink, [around(&[[-1.0, -1.0], [1.0, 1.0]]), around(&[[-1.0, 1.0], [1.0, -1.0]])]);
        }
        PointShape::Square => filled(out, ink, around(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]])),
        PointShape::Diamond => filled(out, ink, around(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]])),
        PointShape::Triangle => filled(out, ink, around(&[[0.0, -1.3], [1.2, 0.9], [-1.2, 0.9]])),
    }
}

/// Two strokes; both rims lie below both lines.
fn cross(out: &mut Vec<Primitive>, ink: &Ink, bars: [Vec<Point>; 2]) {
    let longer = |bar: &[Point]| {
        let (a, b) = (bar[0], bar[1]);
        let unit = ink.halo_width / (b[0] - a[0]).hypot(b[1] - a[1]).max(1e-3);
        let out = [(b[0] - a[0]) * unit, (b[1] - a[1]) * unit];
        vec![[a[0] - out[0], a[1] - out[1]], [b[0] + out[0], b[1] + out[1]]]
    };
    for bar in &bars {
        let stroke = Stroke { width: ink.width + 2.0 * ink.halo_width, color: ink.halo, dash: &[] };
        out.push(Primitive::Polyline { points: longer(bar), closed: false, stroke });
    }
    for points in bars {
        let stroke = Stroke { width: ink.width, color: ink.color, dash: &[] };
        out.push(Primitive::Polyline { points, closed: false, stroke });
    }
}

/// A filled convex polygon with its rim.
fn filled(out: &mut Vec<Primitive>, ink: &Ink, points: Vec<Point>) {
    let stroke = Stroke { width: 2.0 * ink.halo_width, color: ink.halo, dash: &[] };
    out.push(Primitive::Polyline { points: points.clone(), closed: true, stroke });
    out.push(Primitive::Polygon { points, color: ink.color });
}

/// What `streaks` look like at `place`.
pub fn streaks(streaks: &[Streak], theme: Theme, place: Placement) -> Primitive {
    let Ink { color, halo, halo_width, width, .. } = theme.ink(Role::Result);
    // Thinner than arrows: they are longer, and there are more of them.
    let (width, halo_width) = (0.7 * width, 0.7 * halo_width);
    let line = |streak: &Streak| (streak.points.iter().map(|&p| place.at(p)).collect(), streak.strength);
    Primitive::Trails(Trails { lines: streaks.iter().map(line).collect(), pen: Pen { width, color, halo, halo_width } })
}

/// Smallest and largest number of all heat in `scene`.
fn heat_range(scene: &Scene) -> Option<[f32; 2]> {
    let heats = scene.marks.iter().filter_map(|mark| match &mark.shape {
        Shape::Heat { values, .. } => Some(values.cells()),
        _ => None,
    });
    heats.flatten().filter(|v| v.is_finite()).fold(None, |range, &v| match range {
        None => Some([v, v]),
        Some([low, high]) => Some([v.min(low), v.max(high)]),
    })
}

#[cfg(test)]
mod tests;
