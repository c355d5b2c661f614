//! The PNG painter.

use std::io::Write;

use motionscope_core::base::Error;
use motionscope_core::geometry::Grid;

use super::Figure;
use super::raster::{self, BoundedLayer};
use crate::work;

/// The longest side of an exported picture in px.
const MAX_SIDE: u64 = 32_768;
/// The most pixels of an exported picture.
const MAX_PIXELS: u64 = 512 << 20;
/// Rows that are painted at a time: memory does not grow with the picture.
const STRIP: u32 = 128;

/// `figure` as a PNG file, `scale` pixels to the point: frames as sharp squares, marks and words drawn anew.
///
/// The same figure gives the same bytes.
///
/// # Errors
/// If the picture would be too large.
pub fn export_png(figure: &Figure, scale: u32) -> Result<Vec<u8>, Error> {
    let size = fitting_size(figure, scale)?;
    paint(figure, scale, size).map_err(|reason| failed(size, &reason))
}

fn failed((width, height): (u32, u32), reason: &str) -> Error {
    Error::new(format!("the picture of {width}×{height} px could not be made: {reason}"))
}

/// `figure` as pixels, `scale` of them to the point: the same as [`export_png`] writes.
///
/// # Errors
/// If the picture would be too large.
pub fn pixels(figure: &Figure, scale: u32) -> Result<Grid<[u8; 3]>, Error> {
    let size = fitting_size(figure, scale)?;
    let mut cells = Vec::new();
    let push = |rows: &[u8]| {
        cells.extend(rows.as_chunks().0);
        Ok(())
    };
    strips(figure, scale, size.1, push).map_err(|reason| failed(size, &reason))?;
    Grid::from_vec(size.0 as usize, size.1 as usize, cells)
}

/// Width and height in px, if they are sane.
fn fitting_size(figure: &Figure, scale: u32) -> Result<(u32, u32), Error> {
    let [width, height] = figure.size.map(|side| side as u64 * u64::from(scale));
    let fits = width.max(height) <= MAX_SIDE && width * height <= MAX_PIXELS;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width @ 1..), Ok(height @ 1..)) if fits => Ok((width, height)),
        _ if width == 0 || height == 0 => Err(Error::new("a picture without pixels cannot be exported")),
        _ => Err(Error::new(format!(
            "at {scale}× the picture would be {width}×{height} px; the most is {MAX_SIDE} px a side and {} megapixels: choose a smaller scale, or SVG",
            MAX_PIXELS >> 20
        ))),
    }
}

fn paint(figure: &Figure, scale: u32, (width, height): (u32, u32)) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_compression(::png::Compression::Fast);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let text = |encoding: ::png::EncodingError| encoding.to_string();
    encoder.add_text_chunk("Software".into(), "Motionscope".into()).map_err(text)?;
    let mut writer = encoder.write_header().map_err(text)?;
    let mut stream = writer.stream_writer().map_err(text)?;
    strips(figure, scale, height, |rows| stream.write_all(rows).map_err(|e| e.to_string()))?;
    stream.finish().map_err(text)?;
    writer.finish().map_err(text)?;
    Ok(bytes)
}

/// Paints strip after strip.
fn strips(
    figure: &Figure,
    scale: u32,
    height: u32,
    mut take: impl FnMut(&[u8]) -> Result<(), String>,
) -> Result<(), String> {
    let layers: Vec<_> = figure.layers.iter().map(BoundedLayer::new).collect();
    let rows = (0..height).step_by(STRIP as usize).map(|top| (top, STRIP.min(height - top)));
    let paint = |rows| raster::strip(figure, &layers, scale, rows);
    work::in_order(rows, paint, |strip| match strip {
        Some(Some(rows)) => take(&rows),
        Some(None) => Err("it does not fit into memory".into()),
        None => Err("painting failed".into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Color;

    fn figure(width: f32, height: f32) -> Figure {
        let (layers, panels) = (Vec::new(), Vec::new());
        Figure { size: [width, height], background: Color::BLACK, layers, panels, description: String::new() }
    }

    #[test]
    fn too_large_a_picture_is_refused_with_what_to_do() {
        let refused = |figure: &Figure, scale| export_png(figure, scale).expect_err("refused").to_string();
        assert!(refused(&figure(7680.0, 4320.0), 8).contains("61440×34560"));
        assert!(refused(&figure(30_000.0, 30_000.0), 1).contains("smaller scale"));
        assert!(refused(&figure(8.0, 8.0), u32::MAX).contains("smaller scale"));
        assert!(refused(&figure(8.0, 8.0), 0).contains("without pixels"));
        assert!(fitting_size(&figure(1920.0, 1080.0), 8).is_ok());
    }

    #[test]
    fn its_pixels_are_those_of_the_file() {
        let figure = Figure { background: Color::hex(0x12_34_56), ..figure(3.0, 200.0) };
        let pixels = pixels(&figure, 2).expect("a small picture");
        assert_eq!((pixels.size(), pixels.cells()[0]), ((6, 400), [0x12, 0x34, 0x56]));
        let file = image::load_from_memory(&export_png(&figure, 2).expect("a small picture")).expect("a PNG file");
        assert_eq!(file.to_rgb8().as_raw(), bytemuck::cast_slice::<_, u8>(pixels.cells()));
    }

    #[test]
    fn a_picture_says_what_made_it() {
        let bytes = export_png(&figure(3.0, 200.0), 2).expect("a small picture");
        let reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG file");
        assert_eq!(reader.info().size(), (6, 400));
        let texts = &reader.info().uncompressed_latin1_text;
        assert!(texts.iter().any(|text| text.keyword == "Software" && text.text == "Motionscope"));
    }
}
