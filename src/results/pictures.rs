//! The pictures that a run makes of the frames: stabilised frames, a mosaic.

use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::products::{Output, PathField, Product};

use super::{EncodedFiles, Export, Format};
use crate::media::export::{Pixels, png_result};

/// What the names of all pictures begin with.
const PICTURE: &str = "picture_";

pub const EXPORT: Export = Export {
    flag: "pictures",
    value: "DIR",
    help: "Save the pictures made of the frames (stabilised frames, the mosaic) as PNG in this folder",
    name: "Pictures",
    explained: "The pictures made of the frames, such as stabilised frames or a mosaic: a PNG each in a folder.",
    takes: &[PathField::KIND],
    folder: Some(PICTURE),
    or_file: false,
    formats: &[Format { ending: "png", doc: "PNG", encode }],
};

/// The pictures, each with its kind and the number of its frame: `picture_stabilized_0007.png`.
///
/// # Errors
/// If there are none yet, or a frame cannot be read.
fn encode(output: &Output) -> Result<EncodedFiles, Error> {
    let missing = || Error::new("there are no pictures yet; step to the end of the run");
    let field: &PathField = output.get().ok_or_else(missing)?;
    let files = field.pictures()?.into_iter().map(|(kind, t, frame)| encoded(kind, t, &frame));
    let files = files.collect::<Result<Vec<_>, Error>>()?;
    if files.is_empty() { Err(missing()) } else { Ok(EncodedFiles { files, lost: None }) }
}

fn encoded(kind: &str, t: usize, frame: &Frame) -> Result<(String, Vec<u8>), Error> {
    let (width, height) = frame.size();
    let bytes = match frame.color() {
        Some(color) => png_result(width, height, Pixels::Rgb(color.cells().as_flattened())),
        None => png_result(width, height, Pixels::Gray(frame.luma().cells())),
    };
    Ok((format!("{PICTURE}{kind}_{t:04}.png"), bytes?))
}
