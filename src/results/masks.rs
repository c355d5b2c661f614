//! The foreground mask of each frame, as a picture each.

use motionscope_core::base::Error;
use motionscope_core::data::PackedMask;
use motionscope_core::geometry::Grid;
use motionscope_core::products::{MaskField, Output, Product};

use super::{EncodedFiles, Export, Format};
use crate::media::export::{Pixels, png_result};

/// What the names of all masks begin with.
const MASK: &str = "mask_";

pub const EXPORT: Export = Export {
    flag: "masks",
    value: "DIR",
    help: "Save the foreground mask of each frame as PNG in this folder, foreground white",
    name: "Masks",
    explained: "The foreground masks: one PNG per frame in a folder, foreground white.",
    takes: &[MaskField::KIND],
    folder: Some(MASK),
    or_file: false,
    formats: &[Format { ending: "png", doc: "PNG", encode }],
};

/// The mask of each frame that has one: `mask_0007.png`.
///
/// # Errors
/// If there are no masks.
fn encode(output: &Output) -> Result<EncodedFiles, Error> {
    let missing = || Error::new("no frame has a mask yet; step to the end of a frame, or choose a background model");
    let field: &MaskField = output.get().ok_or_else(missing)?;
    let picture = |(t, mask): (usize, &PackedMask)| {
        let mask = mask.unpacked();
        let (width, height) = mask.size();
        let pixels = Grid::from_fn(width, height, |x, y| if mask.get(x, y) { 255 } else { 0 });
        Ok((format!("{MASK}{t:04}.png"), png_result(width, height, Pixels::Gray(pixels.cells()))?))
    };
    let files = field.masks().map(picture).collect::<Result<Vec<_>, Error>>()?;
    if files.is_empty() { Err(missing()) } else { Ok(EncodedFiles { files, lost: None }) }
}
