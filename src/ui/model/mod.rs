//! The model of the window: the document, the run on its thread, opening and saving.

pub mod address;
pub mod background;
pub mod chosen_charts;
pub mod comparing;
pub mod document;
pub mod history;
pub mod lesson;
pub mod live;
pub mod loader;
pub mod nested;
pub mod paper;
pub mod pen;
pub mod player;
pub mod practice;
pub mod predict;
pub mod preview;
pub mod previews;
pub mod settings;
pub mod snapshot;
pub mod step_pictures;
pub mod trail;
pub mod upcoming;
pub mod walker;
pub mod watch;
pub mod writer;

use eframe::egui::ColorImage;
use motionscope_core::geometry::Grid;

/// Returns pixels as what a texture is made of.
fn color_image(pixels: &Grid<[u8; 3]>) -> ColorImage {
    let (width, height) = pixels.size();
    ColorImage::from_rgb([width, height], pixels.cells().as_flattened())
}
