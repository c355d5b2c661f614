//! Frames on the graphics card: each uploaded once, and smaller copies for looking from afar.

use std::sync::Arc;

use eframe::egui::epaint::Vertex;
use eframe::egui::{Color32, ColorImage, Mesh, Painter, Pos2, Rect, Shape, TextureHandle, TextureOptions, pos2};
use eframe::egui::{TextureFilter, TextureWrapMode};
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;

use super::Lens;
use crate::paint::charts::relief::Corner;
use crate::paint::{self, Panel, Share, Tint, reduced};

/// Pictures kept, so that going back and forth uploads nothing.
const KEPT: usize = 9;

const OPTIONS: TextureOptions = TextureOptions {
    magnification: TextureFilter::Nearest,
    minification: TextureFilter::Linear,
    wrap_mode: TextureWrapMode::ClampToEdge,
    mipmap_mode: None,
};

/// The pictures that were shown last, the newest at the end.
#[derive(Clone, Default)]
pub struct Pictures(Vec<Picture>);

#[derive(Clone)]
struct Picture {
    source: Source,
    /// How many pixels of the frame, along each side, became one of the texture.
    factor: usize,
    texture: TextureHandle,
    gain: u16,
}

/// What a picture was made of.
#[derive(Clone)]
enum Source {
    Frame(Arc<Frame>),
    /// Gray and dark, under a layer of colours.
    Dimmed(Arc<Frame>),
    Difference([Arc<Frame>; 2]),
    /// The colours of a layer.
    Layer(Arc<Grid<[u8; 4]>>),
}

impl Source {
    fn same(&self, other: &Source) -> bool {
        match (self, other) {
            (Source::Frame(a), Source::Frame(b)) | (Source::Dimmed(a), Source::Dimmed(b)) => Arc::ptr_eq(a, b),
            (Source::Difference(a), Source::Difference(b)) => (0..2).all(|i| Arc::ptr_eq(&a[i], &b[i])),
            (Source::Layer(a), Source::Layer(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    fn of(panel: Panel, pictures: &paint::Pictures, is_dimmed: bool) -> Self {
        let [frame, other] = panel.frames(pictures).map(Arc::clone);
        match panel {
            Panel::Difference | Panel::Residual => Self::Difference([frame, other]),
            _ if is_dimmed => Self::Dimmed(frame),
            _ => Self::Frame(frame),
        }
    }

    fn pixels(&self) -> (Arc<Grid<[u8; 4]>>, u16) {
        let (pixels, gain) = match self {
            Source::Layer(pixels) => return (pixels.clone(), 1),
            Source::Frame(frame) => {
                Panel::CURRENT.pixels(&paint::Pictures::of([frame.clone(), frame.clone()]), Share::default())
            }
            Source::Dimmed(frame) => {
                let pair = paint::Pictures::of([frame.clone(), frame.clone()]);
                (paint::dimmed(&Panel::CURRENT.pixels(&pair, Share::default()).0), 1)
            }
            Source::Difference(pair) => Panel::Difference.pixels(&paint::Pictures::of(pair.clone()), Share::default()),
        };
        (Arc::new(pixels), gain)
    }
}

impl Pictures {
    /// Paints `panel`; `share` is the share of frame t + 1 in a blend. Gives how much brighter than the numbers it is.
    pub fn paint(
        &mut self,
        painter: &Painter,
        (panel, share): (Panel, Share),
        lens: &Lens,
        pictures: &paint::Pictures,
        is_dimmed: bool,
    ) -> u16 {
        let gain = self.layer(painter, Source::of(panel, pictures, is_dimmed), 1.0, lens);
        if panel == Panel::Blend {
            let [_, other] = panel.frames(pictures).map(Arc::clone);
            self.layer(painter, Source::Frame(other), share.get(), lens);
        }
        gain
    }

    /// Paints `panel` as the ground of a landscape.
    pub fn lay(
        &mut self,
        painter: &Painter,
        panel: Panel,
        (lens, pictures): (&Lens, &paint::Pictures),
        (corners, triangles): &(Vec<Corner>, Vec<[usize; 3]>),
    ) {
        let largest = painter.ctx().input(|i| i.max_texture_side);
        let factor = factor(lens, painter.pixels_per_point(), largest);
        let picture = self.get(painter, Source::of(panel, pictures, false), factor);
        let covered = picture.texture.size().map(|side| (side * factor) as f32);
        let mut mesh = Mesh::with_texture(picture.texture.id());
        mesh.vertices = corners
            .iter()
            .map(|corner| Vertex {
                pos: corner.at.into(),
                uv: pos2((corner.pixel[0] + 0.5) / covered[0], (corner.pixel[1] + 0.5) / covered[1]),
                color: Color32::WHITE.gamma_multiply(corner.opacity),
            })
            .collect();
        mesh.indices = triangles.iter().flatten().map(|index| *index as u32).collect();
        painter.add(Shape::mesh(mesh));
    }

    /// Paints the colours of `layer`.
    pub fn colors(&mut self, painter: &Painter, layer: &Tint, lens: &Lens) {
        self.layer(painter, Source::Layer(layer.pixels.clone()), 1.0, lens);
    }

    fn layer(&mut self, painter: &Painter, source: Source, opacity: f32, lens: &Lens) -> u16 {
        let largest = painter.ctx().input(|i| i.max_texture_side);
        let factor = factor(lens, painter.pixels_per_point(), largest);
        let picture = self.get(painter, source, factor);
        let size = picture.texture.size();
        // The last texel of a reduced picture may stand for fewer pixels than the others.
        let covered = [size[0] * factor, size[1] * factor].map(|c| c as f32);
        let end = pos2(lens.picture.x / covered[0], lens.picture.y / covered[1]);
        let mut mesh = Mesh::with_texture(picture.texture.id());
        let tint = Color32::WHITE.gamma_multiply(opacity);
        mesh.add_rect_with_uv(lens.picture_rect(), Rect::from_min_max(Pos2::ZERO, end), tint);
        painter.add(Shape::mesh(mesh));
        picture.gain
    }

    fn get(&mut self, painter: &Painter, source: Source, factor: usize) -> &Picture {
        let found = self.0.iter().position(|p| p.factor == factor && p.source.same(&source));
        let picture = match found {
            Some(i) => self.0.remove(i),
            None => {
                let (pixels, gain) = source.pixels();
                let image = image(&reduced(&pixels, factor));
                let texture = painter.ctx().load_texture("stage picture", image, OPTIONS);
                Picture { source, factor, texture, gain }
            }
        };
        self.0.push(picture);
        let surplus = self.0.len().saturating_sub(KEPT);
        self.0.drain(..surplus);
        &self.0[self.0.len() - 1]
    }
}

/// The power of two by which a picture is reduced: so that hardly any of its pixels is skipped, and the card can hold it.
fn factor(lens: &Lens, pixels_per_point: f32, largest: usize) -> usize {
    let on_screen = lens.scale * pixels_per_point;
    let side = lens.picture.max_elem();
    let mut factor = 1;
    while factor < 64 && (on_screen * (factor as f32) < 0.6 || side / factor as f32 > largest as f32) {
        factor *= 2;
    }
    factor
}

fn image(pixels: &Grid<[u8; 4]>) -> ColorImage {
    let (width, height) = pixels.size();
    ColorImage::from_rgba_unmultiplied([width, height], bytemuck::cast_slice(pixels.cells()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::stage::Zoom;

    #[test]
    fn a_picture_is_reduced_only_from_afar() {
        let pane = Rect::from_min_size(Pos2::ZERO, eframe::egui::vec2(480.0, 270.0));
        let at = |scale| Lens::new(pane, (1920, 1080), Zoom::At { center: [0.0; 2], scale });
        assert_eq!([2.0, 1.0, 0.7, 0.4, 0.2].map(|s| factor(&at(s), 1.0, 8192)), [1, 1, 1, 2, 4]);
        assert_eq!(factor(&at(0.4), 2.0, 8192), 1, "a fine screen shows more");
        assert_eq!(factor(&at(2.0), 1.0, 1024), 2, "more than the card holds");
    }
}
