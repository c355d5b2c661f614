//! The primitives of every painter as the window's shapes.

use eframe::egui::epaint::PathShape;
use eframe::egui::{self, Color32, ColorImage, Mesh, Painter, Pos2, Shape, TextureHandle, TextureOptions, pos2, vec2};
use eframe::egui_wgpu::RenderState;

use crate::paint::primitive::{self, Arrows, Line, Point, Trails};
use crate::paint::script::{self, Script};
use crate::paint::{Primitive, fonts};
use crate::ui::drawing::arrows::{Drawn, Sheet};
use crate::ui::drawing::style;

/// `primitives` as shapes; pictures among them are left out, for they need textures that someone keeps.
pub fn shapes(painter: &Painter, primitives: &[Primitive]) -> Vec<Shape> {
    let mut maker = Maker::new(painter, None, Kept::default());
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

/// Lines that fade, in one mesh.
fn ribbons(trails: &Trails, clip: &primitive::Rect) -> Shape {
    /// Corners of the dot at a head.
    const CORNERS: u32 = 8;
    let mut mesh = Mesh::default();
    for primitive in trails.primitives().filter(|primitive| primitive.bounds().meets(clip)) {
        let first = mesh.vertices.len() as u32;
        match primitive {
            Primitive::Polyline { points, stroke, .. } => {
                let [from, to] = [points[0], points[1]].map(Pos2::from);
                let (across, color) =
                    ((to - from).normalized().rot90() * stroke.width / 2.0, style::color(stroke.color));
                for at in [from - across, from + across, to - across, to + across] {
                    mesh.colored_vertex(at, color);
                }
                mesh.add_triangle(first, first + 1, first + 2);
                mesh.add_triangle(first + 1, first + 2, first + 3);
            }
            Primitive::Disc { center, radius, color } => {
                for i in 0..CORNERS {
                    let way = egui::Vec2::angled(i as f32 / CORNERS as f32 * std::f32::consts::TAU);
                    mesh.colored_vertex(Pos2::from(center) + way * radius, style::color(color));
                }
                (1..CORNERS - 1).for_each(|i| mesh.add_triangle(first, first + i, first + i + 1));
            }
            _ => {}
        }
    }
    Shape::mesh(mesh)
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
    arrows: Vec<Drawn>,
}

/// Makes shapes of primitives.
pub struct Maker<'a> {
    painter: &'a Painter,
    clip: primitive::Rect,
    shapes: Vec<Shape>,
    gpu: Option<&'a RenderState>,
    before: Kept,
    now: Kept,
}

impl<'a> Maker<'a> {
    /// Makes shapes for `painter`; `before` is what was kept of the last ones.
    pub fn new(painter: &'a Painter, gpu: Option<&'a RenderState>, before: Kept) -> Self {
        let clip = painter.clip_rect();
        let clip = primitive::Rect { min: clip.min.into(), max: clip.max.into() };
        Self { painter, clip, shapes: Vec::new(), gpu, before, now: Kept::default() }
    }

    /// Adds one primitive on top, if any of it can be seen.
    pub fn add(&mut self, primitive: &Primitive) {
        // Arrows may be very many: those that cannot be seen are left out as they are drawn.
        if !matches!(primitive, Primitive::Arrows(_) | Primitive::Trails(_)) && !primitive.bounds().meets(&self.clip) {
            return;
        }
        match primitive {
            Primitive::Polygon { points, color } => {
                self.shapes.push(Shape::convex_polygon(places(points), style::color(*color), egui::Stroke::NONE));
            }
            Primitive::Polyline { points, closed, stroke } => self.line(points, *closed, stroke),
            Primitive::Disc { center, radius, color } => {
                self.shapes.push(Shape::circle_filled((*center).into(), *radius, style::color(*color)));
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
            Primitive::Arrows(arrows) => self.arrows(arrows),
            Primitive::Trails(trails) => self.shapes.push(ribbons(trails, &self.clip)),
        }
    }

    fn line(&mut self, points: &[Point], closed: bool, stroke: &primitive::Stroke) {
        let mut points = places(points);
        let pen = egui::Stroke::new(stroke.width, style::color(stroke.color));
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
        let parts = line.runs.iter().flat_map(|run| script::parts(&run.text).into_iter().map(move |part| (run, part)));
        let mut before = "";
        for (run, (words, script)) in parts {
            let font = style::font(run.face, script.share() * line.size);
            let galley = self.painter.layout_no_wrap(words.to_owned(), font, style::color(run.color));
            let baseline = galley.rows.first().and_then(|row| row.glyphs.first()).map_or(0.0, |glyph| glyph.pos.y);
            let mut corner = at - vec2(0.0, baseline + script.rise() * line.size);
            if script == Script::Over {
                let below = before.char_indices().next_back().map_or("", |(last, _)| &before[last..]);
                corner.x -= (fonts::width(below, run.face, line.size) + galley.size().x) / 2.0;
            }
            if let Some(halo) = line.halo {
                let around = (0..8).map(|i| egui::Vec2::angled(i as f32 * std::f32::consts::FRAC_PI_4) * 1.2);
                self.shapes.extend(around.map(|offset| {
                    Shape::galley_with_override_text_color(corner + offset, galley.clone(), style::color(halo))
                }));
            }
            if script != Script::Over {
                at.x += galley.size().x;
            }
            before = words;
            // Space between two colours has nothing to draw, and no bounds.
            if !words.trim().is_empty() {
                self.shapes.push(Shape::galley(corner, galley, Color32::PLACEHOLDER));
            }
        }
        line.underlines().for_each(|underline| self.add(&underline));
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

    fn arrows(&mut self, arrows: &Arrows) {
        let sheet = Sheet { clip: self.painter.clip_rect(), pixels_per_point: self.painter.pixels_per_point() };
        let known = self.before.arrows.iter().position(|known| known.serves(arrows, sheet, self.gpu.is_some()));
        let drawn = match known {
            Some(i) => self.before.arrows.swap_remove(i),
            None => Drawn::new(arrows, sheet, self.gpu),
        };
        self.shapes.push(drawn.shape(arrows, sheet));
        self.now.arrows.push(drawn);
    }

    /// The shapes since the last ones were taken.
    pub fn take(&mut self) -> Vec<Shape> {
        std::mem::take(&mut self.shapes)
    }

    /// The shapes, and what they need to be kept.
    pub fn finish(self) -> (Vec<Shape>, Kept) {
        (self.shapes, self.now)
    }
}

fn places(points: &[Point]) -> Vec<Pos2> {
    points.iter().map(|&point| point.into()).collect()
}
