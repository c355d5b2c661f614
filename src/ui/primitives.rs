//! The primitives of every painter as the window's shapes.

use std::sync::Arc;

use eframe::egui::epaint::PathShape;
use eframe::egui::{self, Color32, ColorImage, Mesh, Painter, Pos2, Shape, TextureHandle, TextureOptions, pos2, vec2};

use super::ink;
use crate::paint::Primitive;
use crate::paint::primitive::{self, Arrow, Line, Point};

/// Above this many arrows, those small enough are drawn more simply.
const MANY: usize = 3000;

/// `primitives` as shapes; pictures among them are left out, for they need textures that someone keeps.
pub fn shapes(painter: &Painter, primitives: &[Primitive]) -> Vec<Shape> {
    let mut maker = Maker::new(painter, Kept::default());
    let drawn = primitives.iter().filter(|primitive| !matches!(primitive, Primitive::Image { .. }));
    drawn.for_each(|primitive| maker.add(primitive));
    maker.finish().0
}

/// A polyline in dashes and gaps of these lengths; solid if there are none.
pub fn line(points: &[Pos2], stroke: egui::Stroke, dash: &[f32]) -> Vec<Shape> {
    if dash.is_empty() {
        return vec![PathShape::line(points.to_vec(), stroke).into()];
    }
    let (on, off): (Vec<f32>, Vec<f32>) =
        dash.chunks(2).map(|dash| (dash[0], dash.get(1).copied().unwrap_or(dash[0]))).unzip();
    Shape::dashed_line_with_offset(points, stroke, &on, &off, 0.0)
}

/// Colours laid along `rect` from left to right, flowing into each other.
pub fn gradient(rect: egui::Rect, colors: &[[u8; 4]]) -> Shape {
    let edge = |t: f32| {
        let x = egui::lerp(rect.x_range(), t);
        [pos2(x, rect.min.y), pos2(x, rect.max.y)]
    };
    ribbon(colors, edge)
}

/// Colours laid along `rect` from top to bottom, flowing into each other.
pub fn gradient_down(rect: egui::Rect, colors: &[[u8; 4]]) -> Shape {
    let edge = |t: f32| {
        let y = egui::lerp(rect.y_range(), t);
        [pos2(rect.min.x, y), pos2(rect.max.x, y)]
    };
    ribbon(colors, edge)
}

fn ribbon(colors: &[[u8; 4]], edge: impl Fn(f32) -> [Pos2; 2]) -> Shape {
    let mut mesh = Mesh::default();
    let last = colors.len().saturating_sub(1).max(1) as f32;
    for (i, &[r, g, b, a]) in colors.iter().enumerate() {
        let color = Color32::from_rgba_unmultiplied(r, g, b, a);
        edge(i as f32 / last).into_iter().for_each(|at| mesh.colored_vertex(at, color));
        if i > 0 {
            let n = 2 * i as u32;
            mesh.add_triangle(n - 2, n - 1, n);
            mesh.add_triangle(n - 1, n, n + 1);
        }
    }
    Shape::mesh(mesh)
}

/// What shapes were made of, to be used again where it stays the same from step to step.
#[derive(Clone, Default)]
pub struct Kept {
    pictures: Vec<TextureHandle>,
    meshes: Vec<(Vec<Arrow>, Arc<Mesh>)>,
}

/// Makes shapes of primitives. Arrows that follow each other become one mesh.
pub struct Maker<'a> {
    painter: &'a Painter,
    clip: primitive::Rect,
    shapes: Vec<Shape>,
    arrows: Vec<Arrow>,
    before: Kept,
    now: Kept,
}

impl<'a> Maker<'a> {
    /// Makes shapes for `painter`; `before` is what was kept of the last ones.
    pub fn new(painter: &'a Painter, before: Kept) -> Self {
        let clip = painter.clip_rect();
        let clip = primitive::Rect { min: clip.min.into(), max: clip.max.into() };
        Self { painter, clip, shapes: Vec::new(), arrows: Vec::new(), before, now: Kept::default() }
    }

    /// Adds one primitive on top, if any of it can be seen.
    pub fn add(&mut self, primitive: &Primitive) {
        if !primitive.bounds().meets(&self.clip) {
            return;
        }
        if let Primitive::Arrow(arrow) = primitive {
            self.arrows.push(*arrow);
            return;
        }
        self.flush();
        match primitive {
            Primitive::Polygon { points, color } => {
                self.shapes.push(Shape::convex_polygon(places(points), ink::color(*color), egui::Stroke::NONE));
            }
            Primitive::Polyline { points, closed, stroke } => self.line(points, *closed, stroke),
            Primitive::Disc { center, radius, color } => {
                self.shapes.push(Shape::circle_filled((*center).into(), *radius, ink::color(*color)));
            }
            Primitive::Text(line) => self.text(line),
            Primitive::Image { pixels, rect } => {
                let (width, height) = pixels.size();
                let image = ColorImage::from_rgba_unmultiplied([width, height], bytemuck::cast_slice(pixels.cells()));
                let rect = egui::Rect::from_min_max(rect.min.into(), rect.max.into());
                let texture = self.texture(image);
                let whole = egui::Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
                self.shapes.push(Shape::image(texture, rect, whole, Color32::WHITE));
            }
            Primitive::Arrow(_) => {}
        }
    }

    fn line(&mut self, points: &[Point], closed: bool, stroke: &primitive::Stroke) {
        let mut points = places(points);
        let pen = egui::Stroke::new(stroke.width, ink::color(stroke.color));
        if closed && stroke.dash.is_empty() {
            self.shapes.push(PathShape::closed_line(points, pen).into());
            return;
        }
        if closed {
            points.extend(points.first().copied());
        }
        self.shapes.extend(line(&points, pen, stroke.dash));
    }

    fn text(&mut self, line: &Line) {
        let mut at = Pos2::from(line.start());
        for run in &line.runs {
            let galley =
                self.painter.layout_no_wrap(run.text.clone(), ink::font(run.face, line.size), ink::color(run.color));
            let baseline = galley.rows.first().and_then(|row| row.glyphs.first()).map_or(0.0, |glyph| glyph.pos.y);
            let corner = at - vec2(0.0, baseline);
            if let Some(halo) = line.halo {
                let around = (0..8).map(|i| egui::Vec2::angled(i as f32 * std::f32::consts::FRAC_PI_4) * 1.2);
                self.shapes.extend(around.map(|offset| {
                    Shape::galley_with_override_text_color(corner + offset, galley.clone(), ink::color(halo))
                }));
            }
            at.x += galley.size().x;
            self.shapes.push(Shape::galley(corner, galley, Color32::PLACEHOLDER));
        }
    }

    fn texture(&mut self, image: ColorImage) -> egui::TextureId {
        let texture = match self.before.pictures.pop() {
            Some(mut texture) => {
                texture.set(image, TextureOptions::NEAREST);
                texture
            }
            None => self.painter.ctx().load_texture("picture", image, TextureOptions::NEAREST),
        };
        let id = texture.id();
        self.now.pictures.push(texture);
        id
    }

    fn flush(&mut self) {
        if self.arrows.is_empty() {
            return;
        }
        let arrows = std::mem::take(&mut self.arrows);
        let known = self.before.meshes.iter().position(|(known, _)| *known == arrows);
        let mesh = match known {
            Some(i) => self.before.meshes.swap_remove(i).1,
            None => Arc::new(arrow_mesh(&arrows, 1.0 / self.painter.pixels_per_point())),
        };
        self.shapes.push(Shape::Mesh(mesh.clone()));
        self.now.meshes.push((arrows, mesh));
    }

    /// The shapes, and what they need to be kept.
    pub fn finish(mut self) -> (Vec<Shape>, Kept) {
        self.flush();
        (self.shapes, self.now)
    }
}

fn places(points: &[Point]) -> Vec<Pos2> {
    points.iter().map(|&point| point.into()).collect()
}

/// All arrows in one mesh, the edges softened over `feather` points.
fn arrow_mesh(arrows: &[Arrow], feather: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let plain = arrows.len() > MANY;
    mesh.reserve_vertices(arrows.len() * if plain { 38 } else { 76 });
    for arrow in arrows {
        let (halo, color) = (ink::color(arrow.halo), ink::color(arrow.color));
        // Small arrows by the thousand: their rim needs no soft edge, their dot fewer corners.
        let corners = if plain { 6 } else { 14 };
        let soft = if plain { 0.0 } else { feather };
        for (grow, color, soft) in [(arrow.halo_width, halo, soft), (0.0, color, feather)] {
            let inner = arrow.outline(grow - soft / 2.0);
            let outer = arrow.outline(grow + soft / 2.0);
            if let (Some(inner), Some(outer)) = (inner, outer) {
                fan(&mut mesh, arrow.hub(), &inner, (soft > 0.0).then_some(&outer), color);
            }
            let radius = arrow.dot() + grow;
            let ring = |radius: f32| circle(arrow.from, radius, corners);
            let outer = ring(radius + soft / 2.0);
            fan(&mut mesh, arrow.from, &ring((radius - soft / 2.0).max(0.1)), (soft > 0.0).then_some(&outer), color);
        }
    }
    mesh
}

fn circle(center: Point, radius: f32, corners: usize) -> Vec<Point> {
    let corner = |i: usize| {
        let (sin, cos) = (i as f32 / corners as f32 * std::f32::consts::TAU).sin_cos();
        [center[0] + radius * cos, center[1] + radius * sin]
    };
    (0..corners).map(corner).collect()
}

/// Fills the outline `inner` from `hub`, and fades out to `outer`.
fn fan<'a>(mesh: &mut Mesh, hub: Point, inner: &[Point], outer: Option<impl AsRef<[Point]> + 'a>, color: Color32) {
    let n = inner.len() as u32;
    let first = mesh.vertices.len() as u32;
    mesh.colored_vertex(hub.into(), color);
    inner.iter().for_each(|&point| mesh.colored_vertex(point.into(), color));
    for i in 0..n {
        mesh.add_triangle(first, first + 1 + i, first + 1 + (i + 1) % n);
    }
    let Some(outer) = outer else { return };
    outer.as_ref().iter().for_each(|&point| mesh.colored_vertex(point.into(), Color32::TRANSPARENT));
    for i in 0..n {
        let (a, b) = (first + 1 + i, first + 1 + (i + 1) % n);
        mesh.add_triangle(a, a + n, b + n);
        mesh.add_triangle(a, b + n, b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Color;

    fn arrow(to: Point) -> Arrow {
        Arrow { from: [10.0, 10.0], to, width: 2.0, color: Color::WHITE, halo: Color::BLACK, halo_width: 1.0 }
    }

    #[test]
    fn a_mesh_of_arrows_is_sound_and_stays_near_them() {
        for count in [1, MANY + 1] {
            let arrows = vec![arrow([50.0, 30.0]); count];
            let mesh = arrow_mesh(&arrows, 1.0);
            assert!(mesh.is_valid() && !mesh.is_empty());
            let bounds = egui::Rect::from_min_max(pos2(10.0, 10.0), pos2(50.0, 30.0)).expand(8.0);
            assert!(bounds.contains_rect(mesh.calc_bounds()), "{:?}", mesh.calc_bounds());
        }
    }

    #[test]
    fn an_arrow_without_motion_is_a_dot() {
        let mesh = arrow_mesh(&[arrow([10.0, 10.0])], 1.0);
        assert!(mesh.calc_bounds().width() < 10.0 && !mesh.is_empty());
    }

    #[test]
    fn arrows_by_the_thousand_stay_light() {
        let arrows = vec![arrow([18.0, 12.0]); 8160];
        assert!(arrow_mesh(&arrows, 1.0).vertices.len() < 8160 * 50);
    }
}
