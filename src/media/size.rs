//! The sizes of pictures that can be opened.

use motionscope_core::base::{Error, heap};

/// Largest width or height of a frame, in pixels.
pub(crate) const MAX_SIDE_PX: usize = 16_384;
/// Largest area of a frame, in pixels.
pub(crate) const MAX_AREA_PX: usize = 128 << 20;

/// Refuses sizes that no picture can have, before anything is allocated.
///
/// # Errors
/// A sentence, without the file's name, that tells the size and what is allowed.
pub(crate) fn check_size(width: usize, height: usize) -> Result<(), Error> {
    if width == 0 || height == 0 {
        return Err(Error::new(format!("its pictures are {width}×{height} px, so it shows nothing")));
    }
    if width > MAX_SIDE_PX || height > MAX_SIDE_PX || width.saturating_mul(height) > MAX_AREA_PX {
        return Err(Error::new(format!(
            "its header claims pictures of {width}×{height} px; up to {MAX_SIDE_PX} px a side and 128 megapixels can \
             be opened, so the file is damaged or must be scaled down first"
        )));
    }
    check_memory(width * height)
}

/// Bytes per pixel that decoding takes: the decoded picture, its copy in eight bits, and the frame in gray and in colour.
const DECODING: u64 = 4 + 3 + 1 + 3;
/// Smaller pictures are decoded without asking for the free memory, which takes about as long as decoding them.
const SMALL_BYTES: u64 = 64 << 20;

/// Refuses pictures for which there is not enough memory.
fn check_memory(pixels: usize) -> Result<(), Error> {
    let need = DECODING.saturating_mul(pixels as u64);
    if need < SMALL_BYTES || need <= heap::free() {
        return Ok(());
    }
    let [need, free] = [need, heap::free()].map(|bytes| bytes >> 20);
    Err(Error::new(format!(
        "decoding a picture of it takes about {need} MiB of memory, but {free} MiB are free; close other programs, or scale it down"
    )))
}
