//! The labels of the segments of each frame, as a picture each.

use motionscope_core::base::Error;
use motionscope_core::products::{Output, Product, SegmentField, SegmentFrame};

use super::{EncodedFiles, Export, Format};
use crate::media::export::{Pixels, png_result};
use crate::paint::region_color;

/// What the names of all labels begin with.
const LABELS: &str = "labels_";

pub const EXPORT: Export = Export {
    flag: "labels",
    value: "FILE.png|DIR",
    help: "Save the labels of the segments as indexed PNG: those of the last frame in a file, or of each frame in a folder",
    name: "Labels",
    explained: "The label of each pixel: one indexed PNG per frame in a folder, each label in its colour, 0 without a segment.",
    takes: &[SegmentField::KIND],
    folder: Some(LABELS),
    or_file: true,
    formats: &[Format { ending: "png", doc: "PNG", encode }],
};

/// The labels of each frame: `labels_0007.png`.
///
/// # Errors
/// If there are no segments, or more labels than an indexed picture holds.
fn encode(output: &Output) -> Result<EncodedFiles, Error> {
    let missing =
        || Error::new("no frame has segments yet; step to the end of a frame, or choose a motion segmentation");
    let field: &SegmentField = output.get().ok_or_else(missing)?;
    let named = |(i, frame): (usize, &std::sync::Arc<SegmentFrame>)| {
        Ok((format!("{LABELS}{:04}.png", field.first + i), encoded(frame)?))
    };
    let files = field.frames.iter().enumerate().map(named).collect::<Result<Vec<_>, Error>>()?;
    if files.is_empty() { Err(missing()) } else { Ok(EncodedFiles { files, lost: None }) }
}

/// A palette index for each pixel, its label.
fn encoded(frame: &SegmentFrame) -> Result<Vec<u8>, Error> {
    let (width, height) = frame.labels.size();
    let index = |label: &u32| u8::try_from(*label);
    let indices = frame.labels.cells().iter().map(index).collect::<Result<Vec<u8>, _>>().map_err(|_| {
        Error::new("an indexed picture holds 255 labels, and there are more; run fewer frames, or make fewer segments")
    })?;
    let palette: Vec<u8> = (0..=255).flat_map(|label| region_color(label).into_iter().take(3)).collect();
    png_result(width, height, Pixels::Indexed(&indices, &palette))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use motionscope_core::geometry::Grid;

    use super::*;

    #[test]
    fn a_pixel_of_the_picture_is_its_label() {
        let labels = Arc::new(Grid::from_fn(3, 2, |x, y| [0, 7, 255][x] * y as u32));
        let frame = Arc::new(SegmentFrame { labels, segments: Vec::new() });
        let field = SegmentField { picture: (3, 2), first: 4, frames: vec![frame] };
        let made = encode(&Output::of(field)).unwrap();
        assert_eq!(made.files[0].0, "labels_0004.png");
        let mut decoder = png::Decoder::new(std::io::Cursor::new(&made.files[0].1));
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = [0; 6];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, [0, 0, 0, 0, 7, 255]);
        let palette = reader.info().palette.as_ref().unwrap();
        assert_eq!((palette.len(), &palette[..3]), (768, &[0; 3][..]));
        let many = SegmentFrame { labels: Arc::new(Grid::new(2, 1, 256)), segments: Vec::new() };
        assert!(encoded(&many).unwrap_err().to_string().contains("255 labels"));
    }
}
