//! Primitives become pixels: a strip of a figure at a scale.

use ab_glyph::{Font, OutlineCurve};
use tiny_skia::{
    FillRule, FilterQuality, IntRect, LineJoin, Paint, Path, PathBuilder, Pattern, Pixmap, SpreadMode, Transform,
};

use super::primitive::{Arrow, Line, Point, Primitive, Rect, Stroke};
use super::{Color, Figure, Layer, fonts};

/// Pixels of a figure, from row `top` of the whole down.
pub(super) struct Canvas {
    pixmap: Pixmap,
    left: i32,
    top: i32,
    scale: f32,
}

/// A primitive of a figure with its bounds, worked out once for all strips.
pub(super) struct Bounded<'a>(Rect, &'a Primitive);

/// A layer of a figure with the bounds of what it holds.
pub(super) struct BoundedLayer<'a> {
    clip: Option<Rect>,
    primitives: Vec<Bounded<'a>>,
}

impl<'a> BoundedLayer<'a> {
    pub fn new(layer: &'a Layer) -> Self {
        let primitives = layer.primitives.iter().map(|primitive| Bounded(primitive.bounds(), primitive)).collect();
        Self { clip: layer.clip, primitives }
    }
}

/// Rows `top` to `top + height` of `figure`, `scale` pixels to the point. `None` if they do not fit into memory.
pub(super) fn strip(
    figure: &Figure,
    layers: &[BoundedLayer<'_>],
    scale: u32,
    (top, height): (u32, u32),
) -> Option<Vec<u8>> {
    let width = figure.size[0] as u32 * scale;
    let mut canvas = Canvas { pixmap: Pixmap::new(width, height)?, left: 0, top: top as i32, scale: scale as f32 };
    let [r, g, b, a] = figure.background.0;
    canvas.pixmap.fill(tiny_skia::Color::from_rgba8(r, g, b, a));
    for layer in layers {
        match layer.clip {
            None => canvas.paint_all(&layer.primitives),
            Some(clip) => canvas.paint_inside(clip, &layer.primitives),
        }
    }
    let mut rgb = vec![0; canvas.pixmap.pixels().len() * 3];
    for (to, from) in rgb.chunks_exact_mut(3).zip(canvas.pixmap.data().chunks_exact(4)) {
        to.copy_from_slice(&from[..3]);
    }
    Some(rgb)
}

impl Canvas {
    /// What of the figure it covers, in points.
    fn covers(&self) -> Rect {
        let min = [self.left as f32 / self.scale, self.top as f32 / self.scale];
        Rect::new(min, [self.pixmap.width() as f32 / self.scale, self.pixmap.height() as f32 / self.scale])
    }

    fn paint_all(&mut self, primitives: &[Bounded<'_>]) {
        let covers = self.covers();
        for Bounded(bounds, primitive) in primitives {
            if bounds.meets(&covers) {
                self.paint(primitive);
            }
        }
    }

    /// Paints on a canvas of the clip's own, which cuts everything at its edges.
    fn paint_inside(&mut self, clip: Rect, primitives: &[Bounded<'_>]) {
        let covers = self.covers();
        let edge = |c: f32| (c * self.scale).round() as i32;
        let min = [edge(clip.min[0].max(covers.min[0])), edge(clip.min[1].max(covers.min[1]))];
        let max = [edge(clip.max[0].min(covers.max[0])), edge(clip.max[1].min(covers.max[1]))];
        if min[0] >= max[0] || min[1] >= max[1] {
            return;
        }
        let (width, height) = ((max[0] - min[0]) as u32, (max[1] - min[1]) as u32);
        let within = IntRect::from_xywh(min[0] - self.left, min[1] - self.top, width, height);
        let Some(pixmap) = within.and_then(|rect| self.pixmap.clone_rect(rect)) else { return };
        let mut inner = Canvas { pixmap, left: min[0], top: min[1], scale: self.scale };
        inner.paint_all(primitives);
        self.put(&inner);
    }

    /// Copies `inner`, which lies within.
    fn put(&mut self, inner: &Canvas) {
        let (x, y) = ((inner.left - self.left) as usize * 4, (inner.top - self.top) as usize);
        let (to, from) = (self.pixmap.width() as usize * 4, inner.pixmap.width() as usize * 4);
        for (row, pixels) in inner.pixmap.data().chunks_exact(from).enumerate() {
            let start = (y + row) * to + x;
            self.pixmap.data_mut()[start..start + from].copy_from_slice(pixels);
        }
    }

    fn transform(&self) -> Transform {
        Transform::from_row(self.scale, 0.0, 0.0, self.scale, -self.left as f32, -self.top as f32)
    }

    fn paint(&mut self, primitive: &Primitive) {
        match primitive {
            Primitive::Polygon { points, color } => self.fill(polygon(points, true), *color),
            Primitive::Polyline { points, closed, stroke } => self.stroke(polygon(points, *closed), stroke),
            Primitive::Disc { center, radius, color } => {
                self.fill(PathBuilder::from_circle(center[0], center[1], *radius), *color);
            }
            Primitive::Trails(trails) => trails.primitives().for_each(|primitive| self.paint(&primitive)),
            Primitive::Arrows(arrows) => {
                let covers = self.covers();
                for arrow in arrows.iter().filter(|arrow| arrow.bounds().meets(&covers)) {
                    if arrow.pen.halo_width > 0.0 {
                        self.fill(silhouette(&arrow, arrow.pen.halo_width), arrow.pen.halo);
                    }
                    self.fill(silhouette(&arrow, 0.0), arrow.pen.color);
                }
            }
            Primitive::Text(line) => self.text(line),
            Primitive::Image { pixels, rect } => self.image(pixels, *rect),
        }
    }

    fn fill(&mut self, path: Option<Path>, color: Color) {
        if let Some(path) = path {
            self.pixmap.fill_path(&path, &paint(color), FillRule::Winding, self.transform(), None);
        }
    }

    fn stroke(&mut self, path: Option<Path>, stroke: &Stroke) {
        let dash = tiny_skia::StrokeDash::new(stroke.dash.to_vec(), 0.0);
        let style = tiny_skia::Stroke { width: stroke.width, dash, ..Default::default() };
        if let Some(path) = path {
            self.pixmap.stroke_path(&path, &paint(stroke.color), &style, self.transform(), None);
        }
    }

    fn text(&mut self, line: &Line) {
        let glyphs = outlines(line);
        if let Some(halo) = line.halo {
            let width = line.size * HALO_SHARE;
            let style = tiny_skia::Stroke { width, line_join: LineJoin::Round, ..Default::default() };
            for (path, _) in &glyphs {
                self.pixmap.stroke_path(path, &paint(halo), &style, self.transform(), None);
            }
        }
        for (path, color) in glyphs {
            self.fill(Some(path), color);
        }
        line.underlines().for_each(|underline| self.paint(&underline));
    }

    fn image(&mut self, pixels: &motionscope_core::geometry::Grid<[u8; 4]>, rect: Rect) {
        let (Ok(width), Ok(height)) = (u32::try_from(pixels.width()), u32::try_from(pixels.height())) else { return };
        if self.blit(pixels, rect) {
            return;
        }
        let Some(mut source) = Pixmap::new(width, height) else { return };
        for (to, &[r, g, b, a]) in source.pixels_mut().iter_mut().zip(pixels.cells()) {
            *to = tiny_skia::ColorU8::from_rgba(r, g, b, a).premultiply();
        }
        let [w, h] = rect.size();
        let place = Transform::from_row(w / width as f32, 0.0, 0.0, h / height as f32, rect.min[0], rect.min[1]);
        let shader = Pattern::new(source.as_ref(), SpreadMode::Pad, FilterQuality::Nearest, 1.0, place);
        let paint = Paint { shader, anti_alias: true, ..Default::default() };
        if let Some(rect) = tiny_skia::Rect::from_ltrb(rect.min[0], rect.min[1], rect.max[0], rect.max[1]) {
            self.pixmap.fill_rect(rect, &paint, self.transform(), None);
        }
    }

    /// Copies an opaque picture whose pixels are whole numbers of ours; says whether it could.
    fn blit(&mut self, pixels: &motionscope_core::geometry::Grid<[u8; 4]>, rect: Rect) -> bool {
        let cell = rect.size()[0] * self.scale / pixels.width() as f32;
        let min = rect.min.map(|c| c * self.scale);
        let square = cell == rect.size()[1] * self.scale / pixels.height() as f32;
        let whole = cell >= 1.0 && [cell, min[0], min[1]].iter().all(|c| c.fract() == 0.0);
        if !square || !whole {
            return false;
        }
        let (cell, stride) = (cell as i32, self.pixmap.width() as usize * 4);
        let [x0, y0] = [min[0] as i32 - self.left, min[1] as i32 - self.top];
        let (x1, y1) = (x0 + cell * pixels.width() as i32, y0 + cell * pixels.height() as i32);
        let (x, y) = (x0.max(0)..x1.min(self.pixmap.width() as i32), y0.max(0)..y1.min(self.pixmap.height() as i32));
        let source = |y: i32| pixels.row(((y - y0) / cell) as usize);
        if x.is_empty() || y.clone().any(|y| source(y).iter().any(|p| p[3] != 255)) {
            return x.is_empty();
        }
        let (left, right) = (x.start as usize * 4, x.end as usize * 4);
        for row in y.clone() {
            let start = row as usize * stride;
            let target = &mut self.pixmap.data_mut()[..start + right];
            if cell == 1 {
                let from = (x.start - x0) as usize..(x.end - x0) as usize;
                target[start + left..].copy_from_slice(source(row)[from].as_flattened());
            } else if row > y.start && (row - y0) % cell != 0 {
                // The same pixels as in the row above.
                target.copy_within(start - stride + left..start - stride + right, start + left);
            } else {
                for (x, to) in x.clone().zip(target[start + left..].chunks_exact_mut(4)) {
                    to.copy_from_slice(&source(row)[((x - x0) / cell) as usize]);
                }
            }
        }
        true
    }
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b, a] = color.0;
    paint.set_color_rgba8(r, g, b, a);
    paint
}

fn polygon(points: &[Point], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::with_capacity(points.len() + 1, points.len());
    trace(&mut path, points, closed);
    path.finish()
}

fn trace(path: &mut PathBuilder, points: &[Point], closed: bool) {
    for (i, &[x, y]) in points.iter().enumerate() {
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    if closed {
        path.close();
    }
}

/// Corners of a disc, each 22.5° on, a little further out so that it has the area of a circle.
const DOT: [Point; 16] = {
    const A: f32 = 1.0129;
    const B: f32 = 0.9358;
    const C: f32 = 0.7162;
    const D: f32 = 0.3876;
    [
        [A, 0.0],
        [B, D],
        [C, C],
        [D, B],
        [0.0, A],
        [-D, B],
        [-C, C],
        [-B, D],
        [-A, 0.0],
        [-B, -D],
        [-C, -C],
        [-D, -B],
        [0.0, -A],
        [D, -B],
        [C, -C],
        [B, -D],
    ]
};

/// Dot, shaft and head of an arrow, `grow` further out.
fn silhouette(arrow: &Arrow, grow: f32) -> Option<Path> {
    let radius = arrow.dot() + grow;
    let mut path = PathBuilder::with_capacity(32, 32);
    if let Some(outline) = arrow.outline(grow) {
        trace(&mut path, &outline, true);
    }
    // So small a disc has no more corners than can be seen, and thousands are painted fast.
    trace(&mut path, &DOT.map(|[x, y]| [arrow.from[0] + x * radius, arrow.from[1] + y * radius]), true);
    path.finish()
}

/// Width of the halo around the glyphs of a line, as a share of its size.
pub(super) const HALO_SHARE: f32 = 0.2;

/// Returns the outlines of the glyphs of a line of text with their color, run by run; runs of spaces have none.
pub(super) fn outlines(line: &Line) -> Vec<(Path, Color)> {
    let [mut x, y] = line.start();
    let runs = line.runs.iter().filter_map(|run| {
        let (placed, width) = fonts::place(&run.text, run.face, line.size);
        let path = glyph_path(&placed, [x, y]);
        x += width;
        path.map(|path| (path, run.color))
    });
    runs.collect()
}

/// The outlines of a line of text whose baseline starts at `(x, y)`.
fn glyph_path(glyphs: &[fonts::Placed], [x, y]: Point) -> Option<Path> {
    let mut path = PathBuilder::new();
    for placed in glyphs {
        let Some(outline) = placed.face.font().and_then(|font| font.outline(placed.glyph)) else { continue };
        let at = |p: ab_glyph::Point| (x + placed.x + p.x * placed.unit, y - placed.rise - p.y * placed.unit);
        let mut end: Option<ab_glyph::Point> = None;
        for curve in outline.curves {
            let (start, stop) = match &curve {
                OutlineCurve::Line(a, b) | OutlineCurve::Quad(a, _, b) | OutlineCurve::Cubic(a, _, _, b) => (*a, *b),
            };
            if end != Some(start) {
                if end.is_some() {
                    path.close();
                }
                path.move_to(at(start).0, at(start).1);
            }
            let (sx, sy) = at(stop);
            match curve {
                OutlineCurve::Line(..) => path.line_to(sx, sy),
                OutlineCurve::Quad(_, c, _) => path.quad_to(at(c).0, at(c).1, sx, sy),
                OutlineCurve::Cubic(_, c, d, _) => path.cubic_to(at(c).0, at(c).1, at(d).0, at(d).1, sx, sy),
            }
            end = Some(stop);
        }
        path.close();
    }
    path.finish()
}
