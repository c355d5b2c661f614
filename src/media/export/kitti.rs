//! KITTI's flow as a 16-bit PNG.

use motionscope_core::base::Error;
use motionscope_core::data::Flow;

use super::picture::{Pixels, png, png_result};
use crate::media::numbers::whole;

/// A flow field as KITTI keeps it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kitti {
    /// The PNG.
    pub bytes: Vec<u8>,
    /// How many known pixels were written as unknown, because a component is beyond −512 to 511.98 px/frame.
    pub out_of_range: usize,
}

/// `flow` as a 16-bit RGB PNG: `64 u + 2¹⁵`, `64 v + 2¹⁵`, and 1 where the motion is known
/// (Menze and Geiger, Object Scene Flow for Autonomous Vehicles, 2015). Motion is rounded to 1/64 px.
///
/// # Errors
/// If the field has no pixels.
pub fn kitti(flow: &Flow) -> Result<Kitti, Error> {
    encode(flow, png)
}

/// The same of a flow that an estimator found: the PNG is never taken for truth.
///
/// # Errors
/// As [`kitti`].
pub fn kitti_result(flow: &Flow) -> Result<Kitti, Error> {
    encode(flow, png_result)
}

fn encode(flow: &Flow, png: fn(usize, usize, Pixels) -> Result<Vec<u8>, Error>) -> Result<Kitti, Error> {
    let mut out_of_range = 0;
    let mut samples = Vec::with_capacity(6 * flow.0.cells().len());
    for &[u, v] in flow.0.cells() {
        let known = u.is_finite() && v.is_finite();
        let pixel = match (code(u), code(v)) {
            (Some(u), Some(v)) => [u, v, 1],
            _ => [0; 3],
        };
        out_of_range += usize::from(known && pixel[2] == 0);
        samples.extend(pixel.into_iter().flat_map(u16::to_be_bytes));
    }
    let (width, height) = flow.0.size();
    Ok(Kitti { bytes: png(width, height, Pixels::Rgb16(&samples))?, out_of_range })
}

fn code(component_px: f32) -> Option<u16> {
    whole((component_px * 64.0 + 32_768.0).round().into())
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::*;

    #[test]
    fn pixels_are_those_of_the_format() {
        let cells = vec![[0.0, 0.0], [1.5, -2.0], Flow::UNKNOWN, [600.0, 0.0], [-512.0, 511.98], [0.0, -512.1]];
        let made = kitti(&Flow(Grid::from_vec(3, 2, cells).unwrap())).unwrap();
        assert_eq!(made.out_of_range, 2);
        // `image` reads it independently of the `png` crate's own reader settings.
        let read = image::load_from_memory_with_format(&made.bytes, image::ImageFormat::Png).unwrap();
        assert_eq!(read.color(), image::ColorType::Rgb16);
        let golden = [[32_768, 32_768, 1], [32_864, 32_640, 1], [0; 3], [0; 3], [0, 65_535, 1], [0; 3]];
        assert_eq!(read.to_rgb16().into_raw(), golden.concat());
    }
}
