//! Disparities as PFM, and as KITTI keeps them.

use motionscope_core::base::Error;
use motionscope_core::data::Disparity;

use super::Kitti;
use super::picture::{Pixels, png, png_result};
use crate::media::numbers::whole;

/// Gray levels per px of disparity.
const SCALE: f32 = 256.0;

/// Disparities as a portable float map: `Pf`, the size, and little-endian f32 in px, rows from the bottom to the top; unknown is
/// infinite, as on Middlebury.
pub fn pfm(Disparity(map): &Disparity) -> Vec<u8> {
    let (width, height) = map.size();
    let mut bytes = format!("Pf\n{width} {height}\n-1.0\n").into_bytes();
    for y in (0..height).rev() {
        let known = |d: f32| if d.is_finite() { d } else { f32::INFINITY };
        bytes.extend(map.row(y).iter().flat_map(|d| known(*d).to_le_bytes()));
    }
    bytes
}

/// Disparities as a 16-bit gray PNG of 256 levels per px, 0 unknown (Menze and Geiger, Object Scene Flow for Autonomous Vehicles, 2015),
/// rounded to 1/256 px.
///
/// # Errors
/// If there are no pixels.
pub fn kitti_disparity(map: &Disparity) -> Result<Kitti, Error> {
    encode(map, png)
}

/// The same of disparities that an estimator found: the PNG is never taken for truth.
///
/// # Errors
/// As [`kitti_disparity`].
pub fn kitti_disparity_result(map: &Disparity) -> Result<Kitti, Error> {
    encode(map, png_result)
}

fn encode(Disparity(map): &Disparity, png: fn(usize, usize, Pixels) -> Result<Vec<u8>, Error>) -> Result<Kitti, Error> {
    let mut out_of_range = 0;
    let mut samples = Vec::with_capacity(2 * map.cells().len());
    for d in map.cells() {
        // 0 stands for unknown.
        let level = whole((d * SCALE).round().into()).unwrap_or(0_u16);
        out_of_range += usize::from(d.is_finite() && level == 0);
        samples.extend(level.to_be_bytes());
    }
    let (width, height) = map.size();
    Ok(Kitti { bytes: png(width, height, Pixels::Gray16(&samples))?, out_of_range })
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::*;

    fn sample() -> Disparity {
        Disparity(Grid::from_vec(2, 2, vec![1.5, Disparity::UNKNOWN, 255.996, 300.0]).unwrap())
    }

    #[test]
    fn a_pfm_begins_with_its_last_row() {
        let bytes = pfm(&sample());
        let golden: Vec<u8> = [255.996, 300.0, 1.5, f32::INFINITY].iter().flat_map(|d| d.to_le_bytes()).collect();
        assert_eq!(bytes, [b"Pf\n2 2\n-1.0\n".as_slice(), &golden].concat());
    }

    #[test]
    fn levels_are_those_of_the_format() {
        let made = kitti_disparity(&sample()).unwrap();
        assert_eq!(made.out_of_range, 1);
        let read = image::load_from_memory_with_format(&made.bytes, image::ImageFormat::Png).unwrap();
        assert_eq!((read.color(), read.to_luma16().into_raw()), (image::ColorType::L16, vec![384, 0, 65_535, 0]));
    }
}
