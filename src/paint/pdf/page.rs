//! What stands on the page, in the operators of PDF.

use std::collections::BTreeSet;
use std::sync::Arc;

use motionscope_core::geometry::Grid;
use pdf_writer::types::{LineJoinStyle, TextRenderingMode};
use pdf_writer::{Content, Name, Str};

use super::super::primitive::{Arrow, Line, Point, Primitive, Rect, Stroke};
use super::super::{Color, Figure, Layer, fonts::place};
use super::fonts::Fonts;
use super::{Placed, Sheet};

/// How far the two inner points of a quarter of a circle lie from its ends, in radii.
const ROUND: f32 = 0.552_285;

/// The operators of a page, and what they need.
pub struct Page {
    /// The operators.
    pub content: Content,
    /// The pictures.
    pub images: Vec<Arc<Grid<[u8; 4]>>>,
    /// The opacities other than full.
    pub opacities: BTreeSet<u8>,
}

/// What a picture is called on the page.
pub fn image(index: usize) -> Vec<u8> {
    format!("I{index}").into_bytes()
}

/// What an opacity is called on the page.
pub fn opacity(alpha: u8) -> Vec<u8> {
    format!("A{alpha}").into_bytes()
}

impl Page {
    /// The page of a sheet, with the type of `fonts`.
    pub fn of(sheet: &Sheet, fonts: &mut Fonts) -> Self {
        // Full opacity is what everything returns to.
        let mut page = Self { content: Content::new(), images: Vec::new(), opacities: BTreeSet::from([255]) };
        // Points run down from the upper left corner, as everywhere else.
        page.content.transform([1.0, 0.0, 0.0, -1.0, 0.0, sheet.size[1]]);
        for Placed { figure, at: [x, y], scale } in &sheet.figures {
            page.content.save_state().transform([*scale, 0.0, 0.0, *scale, *x, *y]);
            Painter { page: &mut page, fonts: &mut *fonts }.figure(figure);
            page.content.restore_state();
        }
        page
    }
}

/// What puts shapes on a page.
struct Painter<'a> {
    page: &'a mut Page,
    /// The characters of the type that are used.
    fonts: &'a mut Fonts,
}

impl Painter<'_> {
    fn figure(&mut self, figure: &Figure) {
        let points = Rect::new([0.0; 2], figure.size).corners();
        self.paint(&Primitive::Polygon { points, color: figure.background });
        figure.layers.iter().for_each(|layer| self.layer(layer));
    }

    fn layer(&mut self, layer: &Layer) {
        self.page.content.save_state();
        if let Some(clip) = layer.clip {
            let ([x, y], [width, height]) = (clip.min, clip.size());
            self.page.content.rect(x, y, width, height).clip_nonzero().end_path();
        }
        layer.primitives.iter().for_each(|primitive| self.paint(primitive));
        self.page.content.restore_state();
    }

    fn paint(&mut self, primitive: &Primitive) {
        match primitive {
            Primitive::Polygon { points, color } => {
                self.ink(*color);
                self.trace(points, true);
                self.page.content.fill_nonzero();
            }
            Primitive::Polyline { points, closed, stroke } => self.stroke(points, *closed, stroke),
            Primitive::Disc { center, radius, color } => {
                self.ink(*color);
                self.circle(*center, *radius);
            }
            Primitive::Arrows(arrows) => {
                for arrow in arrows.iter() {
                    if arrow.pen.halo_width > 0.0 {
                        self.silhouette(&arrow, arrow.pen.halo_width, arrow.pen.halo);
                    }
                    self.silhouette(&arrow, 0.0, arrow.pen.color);
                }
            }
            Primitive::Trails(trails) => trails.primitives().for_each(|primitive| self.paint(&primitive)),
            Primitive::Text(line) => self.text(line),
            Primitive::Image { pixels, rect } => {
                let ([x, y], [width, height]) = (rect.min, rect.size());
                let name = image(self.page.images.len());
                self.page.images.push(pixels.clone());
                self.page.content.save_state();
                // What was painted before may have left another one.
                self.page.content.set_parameters(Name(&opacity(255)));
                // The first row of a picture is its uppermost.
                self.page.content.transform([width, 0.0, 0.0, -height, x, y + height]).x_object(Name(&name));
                self.page.content.restore_state();
            }
        }
    }

    fn trace(&mut self, points: &[Point], closed: bool) {
        for (i, &[x, y]) in points.iter().enumerate() {
            if i == 0 {
                self.page.content.move_to(x, y)
            } else {
                self.page.content.line_to(x, y)
            };
        }
        if closed && !points.is_empty() {
            self.page.content.close_path();
        }
    }

    /// A filled circle.
    fn circle(&mut self, [x, y]: Point, radius: f32) {
        let r = radius;
        let k = ROUND * r;
        self.page.content.move_to(x + r, y);
        self.page.content.cubic_to(x + r, y + k, x + k, y + r, x, y + r);
        self.page.content.cubic_to(x - k, y + r, x - r, y + k, x - r, y);
        self.page.content.cubic_to(x - r, y - k, x - k, y - r, x, y - r);
        self.page.content.cubic_to(x + k, y - r, x + r, y - k, x + r, y);
        self.page.content.close_path().fill_nonzero();
    }

    fn silhouette(&mut self, arrow: &Arrow, grow: f32, color: Color) {
        self.ink(color);
        if let Some(outline) = arrow.outline(grow) {
            self.trace(&outline, true);
            self.page.content.fill_nonzero();
        }
        self.circle(arrow.from, arrow.dot() + grow);
    }

    fn stroke(&mut self, points: &[Point], closed: bool, stroke: &Stroke) {
        self.ink(stroke.color);
        self.page.content.set_line_width(stroke.width).set_line_join(LineJoinStyle::MiterJoin).set_miter_limit(4.0);
        self.page.content.set_dash_pattern(stroke.dash.iter().copied(), 0.0);
        self.trace(points, closed);
        self.page.content.stroke();
    }

    fn ink(&mut self, color: Color) {
        let [r, g, b, _] = color.0.map(|c| f32::from(c) / 255.0);
        self.page.content.set_fill_rgb(r, g, b).set_stroke_rgb(r, g, b);
        let alpha = color.0[3];
        self.page.opacities.insert(alpha);
        self.page.content.set_parameters(Name(&opacity(alpha)));
    }

    fn text(&mut self, line: &Line) {
        if let Some(halo) = line.halo {
            self.ink(halo);
            self.page.content.set_line_width(0.2 * line.size).set_line_join(LineJoinStyle::RoundJoin);
            self.page.content.set_dash_pattern([], 0.0);
            self.words(line, TextRenderingMode::Stroke, false);
        }
        self.words(line, TextRenderingMode::Fill, true);
        line.underlines().for_each(|underline| self.paint(&underline));
    }

    /// The words of a line; each in the color of its run if it `is_colored`.
    fn words(&mut self, line: &Line, mode: TextRenderingMode, is_colored: bool) {
        let [mut x, y] = line.start();
        for run in &line.runs {
            if is_colored {
                self.ink(run.color);
            }
            let (glyphs, width) = place(&run.text, run.face, line.size);
            self.page.content.begin_text().set_text_rendering_mode(mode);
            for piece in glyphs.chunk_by(|a, b| (a.face, a.size, a.rise) == (b.face, b.size, b.rise)) {
                let size = piece[0].size;
                let font = self.fonts.get(piece[0].face);
                let name = font.name();
                self.page.content.set_font(Name(&name), size);
                self.page.content.set_text_matrix([1.0, 0.0, 0.0, -1.0, x + piece[0].x, y - piece[0].rise]);
                let mut shown = self.page.content.show_positioned();
                let mut items = shown.items();
                let mut end = piece[0].x;
                for glyph in piece {
                    // Pairs of letters may stand closer than their widths say; in thousandths of the size.
                    let closer = (end - glyph.x) / size * 1000.0;
                    if closer.abs() > 0.5 {
                        items.adjust(closer);
                    }
                    let (id, advance) = font.letter(glyph.glyph.0, glyph.c);
                    items.show(Str(&id.to_be_bytes()));
                    end = glyph.x + advance * size / 1000.0;
                }
            }
            self.page.content.end_text();
            x += width;
        }
    }
}
