//! Marks of a scene become primitives: the one place where roles turn into ink.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use motionscope_core::scene::{self, Mark, Shape};
use motionscope_core::{Grid, Role, Scene, Streak};

use super::fonts::Face;
use super::primitive::{Anchor, Arrows, Line, Pen, Point, Primitive, Rect, Run, Stroke, Trails};
use super::{Color, ColorMap, Ink, PointShape, Theme};

/// How near to each other displacements are drawn unless it is chosen, in points of the window and pixels of a file; closer, they would hide the picture and each other.
const CLOSEST: f32 = 5.0;
/// The same where it is chosen: closer, nobody can see one from the next.
const DISTINCT: f32 = 1.0;
/// Opacity of heat over footage.
pub(super) const HEAT_ALPHA: u8 = 0xb8;
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
    let (mut labels, mut boxes) = (Vec::new(), HashMap::new());
    for mark in others.into_iter().chain(under_test).filter(|mark| mark.shape.is_finite()) {
        let mut ink = look.theme.ink(mark.role);
        ink.color = mark.of.map_or(ink.color, own_color);
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

/// The side of a box on which its label stands where there is room.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Above,
    Below,
}

/// A label and the starts of its baseline that come into question, the best first.
struct Label {
    role: Role,
    line: Line,
    places: Vec<Point>,
}

impl Label {
    /// The label of a box, or one at a point, which stays there.
    fn new(role: Role, line: Line, of: Option<(Rect, Side)>, room: Option<Rect>) -> Self {
        let ([x, y], size) = (line.at, line.size);
        let Some((rect, side)) = of else {
            // The name of a measurement stands below its place.
            let y = if role == Role::Measured { y + size + LABEL_RIM } else { y };
            return Self { role, line, places: vec![[x, y]] };
        };
        let width = line.width();
        let [left, right] = [rect.min[0], rect.max[0] - width];
        let [above, below] = [rect.min[1] - LABEL_RIM, rect.max[1] + LABEL_RIM + CAPITALS * size];
        let rows = if side == Side::Above { [above, below] } else { [below, above] };
        let beside = [rect.max[0] + LABEL_RIM, rect.min[0] - LABEL_RIM - width];
        let level = rect.min[1] + CAPITALS * size;
        let mut places = vec![[left, rows[0]], [right, rows[0]], [left, rows[1]], [right, rows[1]]];
        places.extend(beside.map(|x| [x, level]));
        // In a crowd, a line farther away.
        let farther = LINE * size;
        places.extend([[left, below + farther], [left, above - farther]]);
        let mut label = Self { role, line, places };
        if let Some(room) = room.filter(|room| room.meets(&rect)) {
            let first = label.places[0];
            let near = |at: Point| {
                let inside = moved_into(&room, &label.line, at);
                let is_near = (0..2).all(|i| (inside[i] - at[i]).abs() <= 2.0 * LABEL_RIM);
                is_near.then_some(inside)
            };
            label.places = label.places.iter().filter_map(|at| near(*at)).collect();
            if label.places.is_empty() {
                label.places.push(moved_into(&room, &label.line, first));
            }
        }
        label
    }
}

/// Height of capitals and figures as a share of the size of the type.
const CAPITALS: f32 = 0.75;
/// Distance of two lines of labels, as the same share.
const LINE: f32 = 1.3;

/// The rectangle of the letters of a label whose baseline starts at `[x, y]`, with half of their rim.
fn letters(line: &Line, [x, y]: Point) -> Rect {
    let (up, down) = (CAPITALS * line.size, 0.2 * line.size);
    Rect::new([x, y - up], [line.width(), up + down]).grown(LABEL_RIM / 2.0)
}

/// The start of the baseline nearest to `at` with which all of a label lies in `room`.
fn moved_into(room: &Rect, line: &Line, at: Point) -> Point {
    let rect = letters(line, at);
    [0, 1].map(|i| {
        let by = (room.max[i] - rect.max[i]).min(0.0);
        // What is wider than the room begins in it.
        at[i] + by.max(room.min[i] - rect.min[i])
    })
}

/// The labels where they lie over no other one. Those of measurements give way: they are left out where there is no such place.
fn apart_labels(labels: impl Iterator<Item = Label>) -> impl Iterator<Item = Line> {
    let (measured, others): (Vec<_>, Vec<_>) = labels.partition(|label| label.role == Role::Measured);
    let mut taken: Vec<Rect> = Vec::new();
    let mut free = |label: &Label, is_needed: bool| {
        let is_free = |at: &&Point| !taken.iter().any(|other| other.meets(&letters(&label.line, **at)));
        // So many cannot be read, and each is compared with all others.
        let place = if taken.len() < MOST_LABELS { label.places.iter().find(is_free) } else { None };
        let place = place.or(label.places.first().filter(|_| is_needed)).copied()?;
        taken.push(letters(&label.line, place));
        Some(place)
    };
    let mut lines = Vec::new();
    for (label, is_needed) in
        others.into_iter().map(|one| (one, true)).chain(measured.into_iter().map(|one| (one, false)))
    {
        lines.extend(free(&label, is_needed).map(|at| Line { at, ..label.line }));
    }
    lines.into_iter()
}

/// The width of a label's rim in points.
const LABEL_RIM: f32 = 3.0;
/// Beyond this number labels of measurements are left out, and others stay in their first place.
const MOST_LABELS: usize = 200;

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
                let color = self.ink.color.alpha(HEAT_ALPHA).0;
                let (width, height) = mask.size();
                self.layer([0.0; 2], Grid::from_fn(width, height, |x, y| if mask.get(x, y) { color } else { [0; 4] }));
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
                color if v.is_finite() => color.alpha(HEAT_ALPHA).0,
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
    if label == 0 { [0; 4] } else { own_color(label).alpha(HEAT_ALPHA).0 }
}

/// The colour of one of several: hues a golden section apart, so that neighbouring numbers differ.
fn own_color(label: u32) -> Color {
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
/// So many points tell how near they lie to each other.
const ASKED: usize = 48;

/// Distance of the two nearest of `points`, of the first if there are many.
fn nearest(points: &[[f32; 2]]) -> f32 {
    let asked = &points[..points.len().min(ASKED)];
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

/// Side of the cells, in px, of which each has room for one of `arrows` at `zoom`: a multiple of their spacing, and not
/// less than `wanted`.
fn cell(arrows: &[scene::Arrow], zoom: f32, wanted: Option<f32>) -> f32 {
    let spacing = spacing(arrows);
    // Half a step more or less is nearest to what is wanted.
    let steps = match wanted {
        Some(wanted) => (wanted.max(DISTINCT / zoom) / spacing).round(),
        None => (CLOSEST / zoom / spacing).ceil(),
    };
    spacing * steps.max(1.0)
}

/// Whether some of `arrows` are left out at `zoom`, since there is no room for all or fewer are wanted.
pub(super) fn is_thinned(arrows: &[scene::Arrow], zoom: f32, wanted: Option<f32>) -> bool {
    arrows.len() > 1 && cell(arrows, zoom, wanted) > spacing(arrows)
}

/// Those of `arrows` that are drawn at `zoom`: the first in each cell, so that a regular field stays regular.
fn apart(arrows: &[scene::Arrow], zoom: f32, wanted: Option<f32>) -> Arc<[scene::Arrow]> {
    if !is_thinned(arrows, zoom, wanted) {
        return arrows.into();
    }
    let side = cell(arrows, zoom, wanted);
    let first = arrows.first().map_or([0.0; 2], |arrow| arrow.from);
    let mut taken = HashSet::new();
    // A quarter of a pixel keeps rounding from moving a place into the cell before.
    let place = |arrow: &scene::Arrow| [0, 1].map(|i| ((arrow.from[i] - first[i] + 0.25) / side).floor() as i32);
    arrows.iter().filter(|arrow| taken.insert(place(arrow))).copied().collect()
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

/// The power of two, ½ to 8, by which displacements are drawn so that few are longer than a step between them.
///
/// Where a window is searched its range decides, which stays the same from block to block; else what was found does.
fn fitting(scene: &Scene, wanted: Option<f32>) -> Option<f32> {
    let searched = search(scene);
    let fit = |mark: &Mark| match (&mark.shape, searched) {
        _ if !is_lengthened(mark.role) => None,
        (Shape::Arrows(arrows), Some((block, range))) => {
            let room = if arrows.len() > 1 { block.max(spacing(arrows)) } else { block };
            Some(times(room / range).max(1.0))
        }
        (Shape::Arrows(arrows), None) => {
            let lengths = arrows.iter().map(|arrow| length(way(arrow)));
            Some(times(spacing(arrows).max(wanted.unwrap_or(0.0)) / typical(lengths)?))
        }
        (Shape::Flow { values, .. }, _) => {
            let step = scene::arrow_spacing(values.size());
            let along = |extent: usize| (step / 2..extent).step_by(step);
            let places = along(values.height()).flat_map(|y| along(values.width()).map(move |x| (x, y)));
            Some(times(wanted.unwrap_or(step as f32) / typical(places.map(|place| length(values[place])))?))
        }
        _ => None,
    };
    scene.marks.iter().filter_map(fit).min_by(f32::total_cmp)
}

fn times(room: f32) -> f32 {
    // A little beyond the neighbour is better than half the length.
    if room < 0.75 { 0.5 } else { [8.0, 4.0, 2.0].into_iter().find(|times| *times <= room).unwrap_or(1.0) }
}

/// Side of the block and range of the search in px, if a block is searched for in a window.
fn search(scene: &Scene) -> Option<(f32, f32)> {
    let rect = |role: Role| {
        scene.marks.iter().find_map(|mark| match mark.shape {
            Shape::Rect { min, max } if mark.role == role => Some((min, max)),
            _ => None,
        })
    };
    let ((min, max), (from, to)) = (rect(Role::Reference)?, rect(Role::Window)?);
    // At an edge of the picture the window is cut on that side alone.
    let range = (0..2).flat_map(|i| [min[i] - from[i], to[i] - max[i]]).fold(0.0, f32::max);
    let block = (max[0] - min[0]).max(max[1] - min[1]);
    (range > 0.0).then_some((block, range))
}

/// The length that one in ten displacements exceeds, of those that are any.
fn typical(lengths: impl Iterator<Item = f32>) -> Option<f32> {
    let mut lengths: Vec<f32> = lengths.filter(|length| *length > 0.0).collect();
    lengths.sort_by(f32::total_cmp);
    lengths.get(lengths.len().saturating_sub(1) * 9 / 10).copied()
}

fn way(arrow: &scene::Arrow) -> [f32; 2] {
    [0, 1].map(|i| arrow.to[i] - arrow.from[i])
}

fn length([x, y]: [f32; 2]) -> f32 {
    x.hypot(y)
}

/// Usual distance between neighbouring origins in px; 16 where there are no neighbours.
fn spacing(arrows: &[scene::Arrow]) -> f32 {
    let gap = |pair: &[scene::Arrow]| length([0, 1].map(|i| pair[1].from[i] - pair[0].from[i]));
    // The first tell it: there may be very many.
    let mut gaps: Vec<f32> = arrows.windows(2).take(64).map(gap).filter(|gap| *gap > 0.0).collect();
    gaps.sort_by(f32::total_cmp);
    gaps.get(gaps.len() / 2).copied().unwrap_or(16.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::scene::Picture;

    fn field(step: f32, motion: f32) -> Scene {
        let arrows = (0..20).map(|i| {
            let from = [i as f32 * step, 0.0];
            scene::Arrow { from, to: [from[0] + motion, 0.0] }
        });
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(arrows.collect()));
        scene
    }

    #[test]
    fn small_motions_are_lengthened_and_large_ones_shortened() {
        let factor = |step, motion| Look::new(&field(step, motion), Style::default()).lengthen;
        assert_eq!(factor(16.0, 1.0), 8.0);
        assert_eq!(factor(16.0, 3.0), 4.0);
        assert_eq!(factor(16.0, 5.0), 2.0);
        assert_eq!(factor(16.0, 15.0), 1.0);
        assert_eq!(factor(16.0, 30.0), 0.5);
        assert_eq!(factor(16.0, 0.0), 1.0);
    }

    #[test]
    fn the_range_of_a_search_decides_whatever_was_found() {
        let factor = |range: i32, motion: f32| {
            let side = (16 + 2 * range) as usize;
            let mut scene = field(16.0, motion);
            scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(100, 100, 16, 16));
            scene.mark(Picture::NEXT, Role::Window, Shape::pixels(100 - range, 100 - range, side, side));
            Look::new(&scene, Style::default()).lengthen
        };
        assert_eq!([factor(50, 1.0), factor(50, 40.0), factor(7, 1.0), factor(4, 4.0)], [1.0, 1.0, 2.0, 4.0]);
    }

    #[test]
    fn displacements_that_are_too_close_are_thinned_out_evenly() {
        let all = (0..40).flat_map(|y| (0..60).map(move |x| [1.5 + 4.0 * x as f32, 1.5 + 4.0 * y as f32]));
        let arrows: Vec<_> = all.map(|from| scene::Arrow { from, to: [from[0] + 1.0, from[1]] }).collect();
        assert_eq!(apart(&arrows, 1.3, None).len(), 60 * 40);
        // At a third of the size every fourth place is left: 5.3 points apart.
        let kept: Vec<_> = apart(&arrows, 1.0 / 3.0, None).iter().map(|arrow| arrow.from).collect();
        assert!(is_thinned(&arrows, 1.0 / 3.0, None) && !is_thinned(&arrows[..1], 0.01, None));
        assert_eq!(kept.len(), 15 * 10);
        assert!(kept.iter().all(|from| from.iter().all(|c| (c - 1.5) % 16.0 == 0.0)));
    }

    #[test]
    fn a_candidate_is_drawn_over_the_best() {
        let mut scene = Scene::default();
        scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(4, 8, 16, 16));
        scene.mark(Picture::NEXT, Role::Best, Shape::pixels(4, 8, 16, 16));
        let look = Look::new(&scene, Style::default());
        let primitives = resolve(&scene.marks, &look, Placement::new([0.0; 2], 2.0));
        let Some(Primitive::Polyline { stroke, .. }) = primitives.last() else { panic!("{primitives:?}") };
        assert_eq!(stroke.color, Theme::Dark.ink(Role::Candidate).color);
    }

    #[test]
    fn numbers_of_both_signs_have_zero_in_the_middle() {
        let heat = |values: [f32; 2]| {
            let mut scene = Scene::default();
            let values = Grid::from_fn(2, 1, |x, _| values[x]);
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
            let look = Look::new(&scene, Style::default());
            (look.heat, look.colors)
        };
        assert_eq!(heat([-2.0, 8.0]), (Some([-8.0, 8.0]), ColorMap::Diverging));
        assert_eq!(heat([0.0, 8.0]), (Some([0.0, 8.0]), ColorMap::Viridis));
    }

    #[test]
    fn points_beside_each_other_do_not_merge() {
        let bounds = |gap: f32, zoom: f32| {
            let mut scene = Scene::default();
            scene.mark(Picture::NEXT, Role::Rejected, Shape::Points(vec![[10.0, 10.0], [10.0 + gap, 10.0]]));
            let look = Look::new(&scene, Style::default());
            let all = resolve(&scene.marks, &look, Placement::new([0.0; 2], zoom));
            let ends = all.iter().filter_map(|primitive| match primitive {
                Primitive::Polyline { points, .. } => {
                    Some([points[0][0].min(points[1][0]), points[0][0].max(points[1][0])])
                }
                _ => None,
            });
            ends.map(|[from, to]| to - from).fold(0.0, f32::max)
        };
        assert!(bounds(1.0, 6.0) < 6.0, "{} wide at 6 points", bounds(1.0, 6.0));
        assert!(bounds(1.0, 30.0) >= 6.0 && bounds(9.0, 6.0) >= 6.0, "as large as ever where there is room");
    }

    #[test]
    fn heat_hides_no_mark_that_lies_over_it() {
        let mut scene = Scene::default();
        scene.mark(Picture::NEXT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values: Grid::new(9, 9, 3.0) });
        scene.mark(Picture::NEXT, Role::Best, Shape::pixels(4, 8, 16, 16));
        let look = Look::new(&scene, Style::default());
        let primitives = resolve(&scene.marks, &look, Placement::new([0.0; 2], 2.0));
        let heat = primitives.iter().position(|primitive| matches!(primitive, Primitive::Image { .. }));
        assert_eq!((heat, primitives.len()), (Some(0), 3), "the best's rim and line come after");
    }

    /// A field that moves to the right, but for its first column, of which nothing is known.
    fn dense() -> Scene {
        let values = Grid::from_fn(360, 180, |x, _| if x < 10 { [f32::NAN; 2] } else { [2.5, 0.0] });
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Result, Shape::Flow { origin: [0.0; 2], values });
        scene
    }

    fn drawn(scene: &Scene, arrows: ArrowStyle, place: Placement) -> Vec<scene::Arrow> {
        let look = Look::new(scene, Style { arrows, ..Style::default() });
        match &resolve(&scene.marks, &look, place)[..] {
            [Primitive::Arrows(arrows)] => arrows.ends.to_vec(),
            [] => Vec::new(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_dense_field_has_more_arrows_the_closer_one_looks() {
        let scene = dense();
        let count = |zoom| drawn(&scene, ArrowStyle::default(), Placement::new([0.0; 2], zoom)).len();
        // One every 10 px, 5 px, and 1 px.
        assert_eq!([count(1.0), count(3.0), count(14.0)], [35 * 18, 70 * 36, 350 * 180]);
        assert!(count(0.3) < count(1.0), "they never touch");
        let all = drawn(&scene, ArrowStyle::default(), Placement::new([0.0; 2], 1.0));
        assert!(all.iter().all(|arrow| arrow.from[0] >= 10.0 && arrow.to[0] - arrow.from[0] == 2.5));
    }

    #[test]
    fn a_dense_field_has_the_spacing_that_is_chosen() {
        let scene = dense();
        let spaced = ArrowStyle { spacing_px: Some(20), ..ArrowStyle::default() };
        for zoom in [1.0, 8.0] {
            assert_eq!(drawn(&scene, spaced, Placement::new([0.0; 2], zoom)).len(), 18 * 9);
        }
        for (px, count) in [(1, 350 * 180), (2, 175 * 90), (3, 117 * 60), (4, 88 * 45), (5, 70 * 36)] {
            let spaced = ArrowStyle { spacing_px: Some(px), ..ArrowStyle::default() };
            assert_eq!(drawn(&scene, spaced, Placement::new([0.0; 2], 1.0)).len(), count, "{px} px");
        }
        let far = |px| {
            let spaced = ArrowStyle { spacing_px: Some(px), ..ArrowStyle::default() };
            drawn(&scene, spaced, Placement::new([0.0; 2], 0.25)).len()
        };
        assert!(far(1) == far(4) && far(4) > far(5) && far(5) > far(7), "several to a point of the screen are one");
        let streaks = ArrowStyle { streak_frames: Some(32), ..ArrowStyle::default() };
        assert!(drawn(&scene, streaks, Placement::new([0.0; 2], 1.0)).is_empty(), "streaklines stand in their place");
    }

    #[test]
    fn only_arrows_that_can_be_seen_are_made() {
        let scene = dense();
        let seen = Some(Rect::new([0.0; 2], [200.0, 200.0]));
        let near = drawn(&scene, ArrowStyle::default(), Placement { seen, ..Placement::new([-2800.0, -1400.0], 28.0) });
        assert!((7 * 7..17 * 17).contains(&near.len()), "{}", near.len());
        assert!(near.iter().all(|arrow| (90.0..120.0).contains(&arrow.from[0])));
    }

    #[test]
    fn blocks_are_thinned_to_the_spacing_that_is_chosen() {
        let all = (0..40).flat_map(|y| (0..60).map(move |x| [8.0 * x as f32, 8.0 * y as f32]));
        let arrows: Vec<_> = all.map(|from| scene::Arrow { from, to: [from[0] + 1.0, from[1]] }).collect();
        let kept = |wanted| apart(&arrows, 1.0, Some(wanted)).len();
        assert_eq!([kept(1.0), kept(8.0), kept(17.0), kept(32.0)], [60 * 40, 60 * 40, 30 * 20, 15 * 10]);
        let small: Vec<_> =
            arrows.iter().map(|arrow| scene::Arrow { from: arrow.from.map(|c| c / 8.0), ..*arrow }).collect();
        let kept = [1.0, 2.0, 3.0, 4.0, 5.0].map(|wanted| apart(&small, 1.0, Some(wanted)).len());
        assert_eq!(kept, [60 * 40, 30 * 20, 20 * 14, 15 * 10, 12 * 8]);
    }

    #[test]
    fn only_displacements_are_lengthened() {
        let arrow = scene::Arrow { from: [0.0, 0.0], to: [10.0, 0.0] };
        let mut scene = Scene::default();
        scene.mark(Picture::NEXT, Role::Best, Shape::Arrows(vec![arrow]));
        scene.mark(Picture::NEXT, Role::Result, Shape::Arrows(vec![arrow]));
        let look = Look { lengthen: 2.0, ..Look::new(&scene, Style::default()) };
        let tips: Vec<_> = resolve(&scene.marks, &look, Placement::new([0.0; 2], 3.0))
            .into_iter()
            .flat_map(|primitive| match primitive {
                Primitive::Arrows(arrows) => arrows.iter().map(|arrow| arrow.to[0]).collect::<Vec<_>>(),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(tips, [31.5, 61.5]);
    }

    /// The labels that are drawn of those with a role, a place in points and their words.
    fn labels(all: &[(Role, [f32; 2], &str)]) -> Vec<String> {
        let mut scene = Scene::default();
        for (role, at, text) in all {
            scene.mark(Picture::CURRENT, *role, Shape::Text { at: *at, text: (*text).into() });
        }
        let look = Look::new(&scene, Style::default());
        let words = |one: Primitive| match one {
            Primitive::Text(line) => line.runs.into_iter().map(|run| run.text).collect::<String>(),
            other => panic!("{other:?}"),
        };
        resolve(&scene.marks, &look, Placement::new([0.0; 2], 1.0)).into_iter().map(words).collect()
    }

    #[test]
    fn labels_of_measurements_give_way_to_others() {
        let size = Theme::Dark.sizes().small + LABEL_RIM;
        let (near, far) = ([10.0, 10.0], [10.0, 90.0]);
        let measured = |at, text| (Role::Measured, at, text);
        assert_eq!(labels(&[measured(near, "a"), measured(far, "b")]), ["a", "b"], "both have room");
        assert_eq!(labels(&[measured(near, "a"), measured(near, "b")]), ["a"], "the first stays");
        // Tracks keep their labels, also where two lie over each other and where they come later.
        let under = [near[0], near[1] + size];
        let tracks = [measured(near, "a"), (Role::Result, under, "1"), (Role::Result, under, "2")];
        assert_eq!(labels(&tracks), ["1", "2"]);
        let many: Vec<_> = (0..MOST_LABELS + 20).map(|i| measured([0.0, 40.0 * i as f32], "a")).collect();
        assert_eq!(labels(&many).len(), MOST_LABELS, "more cannot be read");
    }

    /// The labels of boxes of 40×20 px at `boxes`, in a picture of 200×100 px, with the rectangles of their letters.
    fn boxed(boxes: &[(Role, [f32; 2], &str)]) -> Vec<(String, Rect)> {
        let mut scene = Scene::default();
        for (role, min, text) in boxes {
            let max = [min[0] + 40.0, min[1] + 20.0];
            // The name of a measurement belongs below its box, drawn before or after it.
            let at = if *role == Role::Measured { [min[0], max[1]] } else { *min };
            scene.mark(Picture::CURRENT, *role, Shape::Text { at, text: (*text).into() });
            scene.mark(Picture::CURRENT, *role, Shape::Rect { min: *min, max });
        }
        let look = Look::new(&scene, Style::default());
        let place = Placement { room: Some(Rect::new([0.0; 2], [200.0, 100.0])), ..Placement::new([0.0; 2], 1.0) };
        let all = resolve(&scene.marks, &look, place);
        let first = all.iter().position(|one| matches!(one, Primitive::Text(_))).expect("labels");
        assert!(all[first..].iter().all(|one| matches!(one, Primitive::Text(_))), "no line lies over a label");
        let label = |one: &Primitive| match one {
            Primitive::Text(line) => (line.runs.iter().map(|run| run.text.clone()).collect(), letters(line, line.at)),
            other => panic!("{other:?}"),
        };
        all[first..].iter().map(label).collect()
    }

    #[test]
    fn labels_of_boxes_keep_clear_of_the_edge_of_each_other_and_of_their_box() {
        let room = Rect::new([0.0; 2], [200.0, 100.0]);
        for at in [[80.0, 40.0], [2.0, 1.0], [170.0, 1.0], [155.0, 78.0], [2.0, 78.0]] {
            let beside = [at[0] + 3.0, at[1] + 2.0];
            let all =
                boxed(&[(Role::Measured, beside, "d 1"), (Role::Estimate, at, "12"), (Role::Measured, at, "d 2")]);
            assert_eq!(all.len(), 3, "{at:?}: {all:?}");
            for (i, (text, rect)) in all.iter().enumerate() {
                let is_inside = (0..2).all(|i| room.min[i] <= rect.min[i] + 1e-3 && rect.max[i] <= room.max[i] + 1e-3);
                assert!(is_inside, "{text} at {at:?}: {rect:?}");
                assert!(all[..i].iter().all(|(_, other)| !other.meets(rect)), "{at:?}: {all:?}");
            }
        }
        let [(_, above), (_, below)] =
            &boxed(&[(Role::Estimate, [80.0, 40.0], "12"), (Role::Measured, [80.0, 40.0], "d")])[..]
        else {
            panic!("two labels")
        };
        assert!(above.max[1] <= 40.0 && below.min[1] >= 60.0, "{above:?}, {below:?}");
    }

    #[test]
    fn a_frame_lies_outside_the_pixels_that_it_frames() {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(4, 8, 16, 16));
        let look = Look::new(&scene, Style::default());
        let primitives = resolve(&scene.marks, &look, Placement::new([100.0, 0.0], 2.0));
        let Some(Primitive::Polyline { points, stroke, closed: true }) = primitives.last() else {
            panic!("{primitives:?}")
        };
        assert_eq!(stroke.width, 2.0);
        assert_eq!((points[0], points[2]), ([107.0, 15.0], [141.0, 49.0]));
    }

    #[test]
    fn what_is_not_finite_is_not_drawn() {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Truth, Shape::Points(vec![[f32::NAN, 1.0]]));
        scene.mark(Picture::CURRENT, Role::Truth, Shape::Heat { origin: [0.0; 2], values: Grid::new(2, 2, f32::NAN) });
        let look = Look::new(
            &scene,
            Style {
                arrows: ArrowStyle { lengthen: Lengthen::Times(f32::NAN), ..ArrowStyle::default() },
                ..Style::default()
            },
        );
        assert_eq!((look.heat, look.lengthen), (None, 1.0));
        assert!(resolve(&scene.marks, &look, Placement::new([0.0; 2], 1.0)).is_empty());
    }
}
