//! Pictures as PNG.

use motionscope_core::base::Error;

use super::mark::SOFTWARE;

/// The samples of a picture, row by row without padding.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// 8-bit gray.
    Gray(&'a [u8]),
    /// 8-bit red, green, blue.
    Rgb(&'a [u8]),
    /// 8-bit red, green, blue and alpha, not premultiplied.
    Rgba(&'a [u8]),
    /// 16-bit big-endian gray.
    Gray16(&'a [u8]),
    /// 16-bit big-endian red, green, blue.
    Rgb16(&'a [u8]),
    /// 8-bit indices into a palette of up to 256 entries of 8-bit red, green, blue.
    Indexed(&'a [u8], &'a [u8]),
}

/// `pixels` as a PNG, compressed quickly rather than tightly. The same pixels always give the same bytes.
///
/// # Errors
/// If there are not exactly `width × height` pixels, or none.
pub fn png(width: usize, height: usize, pixels: Pixels) -> Result<Vec<u8>, Error> {
    encode(width, height, pixels, None)
}

/// The same of what an estimator found: the PNG says that Motionscope made it, and is never taken for truth.
///
/// # Errors
/// As [`png()`].
pub fn png_result(width: usize, height: usize, pixels: Pixels) -> Result<Vec<u8>, Error> {
    encode(width, height, pixels, Some(SOFTWARE))
}

fn encode(width: usize, height: usize, pixels: Pixels, says: Option<[&str; 2]>) -> Result<Vec<u8>, Error> {
    use png::{BitDepth, ColorType};
    let (samples, color, depth) = match pixels {
        Pixels::Gray(samples) => (samples, ColorType::Grayscale, BitDepth::Eight),
        Pixels::Rgb(samples) => (samples, ColorType::Rgb, BitDepth::Eight),
        Pixels::Rgba(samples) => (samples, ColorType::Rgba, BitDepth::Eight),
        Pixels::Gray16(samples) => (samples, ColorType::Grayscale, BitDepth::Sixteen),
        Pixels::Rgb16(samples) => (samples, ColorType::Rgb, BitDepth::Sixteen),
        Pixels::Indexed(samples, _) => (samples, ColorType::Indexed, BitDepth::Eight),
    };
    let refused = |why: String| Error::new(format!("a picture of {width}×{height} px cannot be saved as PNG: {why}"));
    let side = |n: usize| u32::try_from(n).map_err(|e| refused(e.to_string()));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(width)?, side(height)?);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Pixels::Indexed(_, palette) = pixels {
        encoder.set_palette(palette);
    }
    encoder.set_compression(png::Compression::Fast);
    if let Some([keyword, text]) = says {
        encoder.add_text_chunk(keyword.into(), text.into()).map_err(|e| refused(e.to_string()))?;
    }
    let mut writer = encoder.write_header().map_err(|e| refused(e.to_string()))?;
    writer.write_image_data(samples).map_err(|e| refused(e.to_string()))?;
    writer.finish().map_err(|e| refused(e.to_string()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize) -> Vec<u8> {
        (0..n as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
    }

    #[test]
    fn pixels_come_back() {
        let samples = noise(7 * 5 * 6);
        let of = |channels| &samples[..7 * 5 * channels];
        for pixels in [Pixels::Gray(of(1)), Pixels::Rgb(of(3)), Pixels::Rgba(of(4)), Pixels::Rgb16(of(6))] {
            let bytes = png(7, 5, pixels).unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            let mut back = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut back).unwrap();
            assert_eq!(back, of(back.len() / 35));
            assert_eq!(bytes, png(7, 5, pixels).unwrap());
        }
    }

    #[test]
    fn a_wrong_number_of_pixels_is_refused() {
        assert!(png(2, 2, Pixels::Rgb(&[0; 11])).is_err());
        assert!(png(2, 2, Pixels::Rgb(&[0; 13])).is_err());
        assert!(png(0, 2, Pixels::Rgb(&[])).is_err());
        assert!(png(usize::MAX, 2, Pixels::Rgb(&[])).is_err());
    }
}
