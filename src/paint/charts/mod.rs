//! Charts of what a step tells, laid out as primitives in points.
//!
//! The window shows these primitives and lays over them what follows the pointer; an exported sheet is made of the same.
//! Each chart is a function of its data, the rectangle that it has, and a style.
//!
//! The window caches the shapes (`ui/drawing/chart.rs`); only the triangles of a 3-D surface and the points of a cloud may be
//! drawn by the GPU, with the same projection.

mod axis;
mod canvas;
mod cells;
pub mod changes;
pub mod cloud;
pub mod diagram;
pub mod distribution;
pub mod explanation;
pub mod formula;
pub mod heat_map;
pub mod histogram;
mod labels;
mod map;
pub mod matrices;
mod orbit;
pub mod plane;
pub mod prose;
pub mod regions;
pub mod relief;
pub mod series;
pub mod stack;
pub mod table;
pub mod tiles;

pub use axis::Axis;
pub use canvas::{Canvas, Level, Type, shortened};
pub use map::Map;
pub use orbit::{Orbit, Room, Screen};

use super::{ColorMap, Layer, Primitive, Theme};

/// How charts look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartStyle {
    /// Colors and sizes of type.
    pub theme: Theme,
    /// Colors for small and large numbers.
    pub colors: ColorMap,
    /// Pixels that a point becomes: pictures that are turned in space are as fine as that.
    pub density: f32,
}

impl ChartStyle {
    /// The size of the type around a chart, in points.
    pub fn small(&self) -> f32 {
        self.theme.sizes().small
    }
}

/// A chart that was laid out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing<P> {
    /// Where its parts stand, to be pointed at.
    pub place: P,
    /// Everything but the line above, back to front.
    pub body: Vec<Layer>,
    /// The line above: what is shown.
    pub head: Vec<Primitive>,
}

impl<P> Drawing<P> {
    /// Everything, back to front.
    pub fn into_layers(self) -> Vec<Layer> {
        let mut layers = self.body;
        layers.push(Layer { clip: None, primitives: self.head });
        layers
    }
}

/// Heights, in letters of small type, below which words share rows so that more is left for what they are about.
const TIGHT_LETTERS: f32 = 14.0;

/// Whether `area` has so little height for type of this size.
fn is_tight(area: super::primitive::Rect, small: f32) -> bool {
    area.size()[1] < TIGHT_LETTERS * small
}

/// Black or white, whichever is seen better on `color`.
fn on(color: super::Color) -> super::Color {
    let [r, g, b, _] = color.0;
    on_gray((0.299 * f32::from(r) + 0.587 * f32::from(g) + 0.114 * f32::from(b)) as u8)
}

/// Black or white, whichever is seen better on a gray.
pub fn on_gray(gray: u8) -> super::Color {
    if gray > 118 { super::Color::BLACK.alpha(215) } else { super::Color::WHITE.alpha(215) }
}

/// What stands above a chart: the estimator and what is shown of it, or where that is too long for `width` points, the
/// latter alone.
fn titled(whose: &str, what: &str, (size, width): (f32, f32)) -> String {
    let whole = format!("{whose} · {what}");
    let fits = super::fonts::width(&whole, super::Face::Sans, size) <= width;
    if fits && !whose.is_empty() { whole } else { what.to_owned() }
}

/// The words of `primitives`, line by line.
#[cfg(test)]
fn texts(primitives: &[Primitive]) -> Vec<String> {
    let words = primitives.iter().filter_map(|primitive| match primitive {
        Primitive::Text(line) => Some(line.runs.iter().map(|run| run.text.as_str()).collect()),
        _ => None,
    });
    words.collect()
}

/// What is painted, of all layers.
#[cfg(test)]
fn flat<P>(drawing: Drawing<P>) -> Vec<Primitive> {
    drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect()
}
