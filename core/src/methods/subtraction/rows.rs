//! Per-pixel classification row by row, on several threads.

use crate::base::Threads;
use crate::data::Mask;
use crate::geometry::Grid;

/// Classifies the pixels of each row with `f`, which gets the row's index, its cells of the model and its words of the mask.
pub fn by_rows<T: Send>(
    model: &mut Grid<T>,
    threads: &Threads,
    f: impl Fn(usize, &mut [T], &mut [u64]) + Send + Sync,
) -> Mask {
    let (width, height) = model.size();
    let mut mask = Mask::new(width, height);
    mask.write(|words, in_row| {
        let rows = model.cells_mut().chunks_mut(width).zip(words.chunks_mut(in_row)).enumerate();
        threads.each(rows, |(y, (cells, words)): (usize, (&mut [T], &mut [u64]))| f(y, cells, words));
    });
    mask
}

/// Flags of 0 or 1 for the 64 pixels of a word, so that a loop over them needs no shifts.
pub struct Flags(pub [u8; 64]);

impl Flags {
    /// Returns the flags of `count` pixels.
    #[inline(always)]
    pub fn of(count: usize, mut is_set: impl FnMut(usize) -> bool) -> Self {
        let mut flags = [0; 64];
        for (i, flag) in flags[..count].iter_mut().enumerate() {
            *flag = u8::from(is_set(i));
        }
        Self(flags)
    }

    /// Packs the flags into bits, the first one lowest.
    #[inline(always)]
    pub fn word(&self) -> u64 {
        let (eights, _) = self.0.as_chunks::<8>();
        // The product brings the lowest bit of each byte into the highest byte, the first one lowest.
        let bits = |eight: &[u8; 8]| u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        eights.iter().enumerate().fold(0, |word, (i, eight)| word | bits(eight) << (8 * i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_become_bits_in_order() {
        for i in 0..64 {
            assert_eq!(Flags::of(64, |j| j == i).word(), 1 << i);
            assert_eq!(Flags::of(i, |_| true).word(), (1 << i) - 1);
        }
    }
}
