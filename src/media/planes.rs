//! Luma and chroma of pictures for and from the browser.

use yuv::{BufferStoreMut, YuvConversionMode, YuvPlanarImageMut, YuvRange, YuvStandardMatrix};

/// Luma and chroma in the narrow range, one chroma sample for 2×2 pixels, of pixels in RGBA; none if their number is wrong.
pub(super) fn yuv420(rgba: &[u8], (width, height): (u32, u32), matrix: YuvStandardMatrix) -> Option<Vec<u8>> {
    let chroma_width = width.div_ceil(2);
    let (luma, chroma) = ((width * height) as usize, (chroma_width * height.div_ceil(2)) as usize);
    let mut samples = vec![0; luma + 2 * chroma];
    let (y, rest) = samples.split_at_mut(luma);
    let (u, v) = rest.split_at_mut(chroma);
    let mut image = YuvPlanarImageMut {
        y_plane: BufferStoreMut::Borrowed(y),
        y_stride: width,
        u_plane: BufferStoreMut::Borrowed(u),
        u_stride: chroma_width,
        v_plane: BufferStoreMut::Borrowed(v),
        v_stride: chroma_width,
        width,
        height,
    };
    let (range, mode) = (YuvRange::Limited, YuvConversionMode::Balanced);
    yuv::rgba_to_yuv420(&mut image, rgba, 4 * width, range, matrix, mode).ok()?;
    Some(samples)
}
