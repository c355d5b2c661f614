//! Binary masks of one bit per pixel.
//!
//! Writers of whole words may write beyond the width. Those bits are cleared after each write, so that no operation sees them.

use std::fmt;

/// A binary mask. Bit i of word w of a row is pixel 64 w + i; bits beyond the width are 0.
#[derive(Clone, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    height: usize,
    words: Vec<u64>,
}

/// Pixels of a word.
const BITS: usize = u64::BITS as usize;

impl Mask {
    /// Creates an empty mask of this many columns and rows.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, words: vec![0; width.div_ceil(BITS) * height] }
    }

    /// Creates the mask of the pixels for which `is_set` holds.
    pub fn from_fn(width: usize, height: usize, mut is_set: impl FnMut(usize, usize) -> bool) -> Self {
        let mut mask = Self::new(width, height);
        for y in 0..height {
            mask.write_row(y, |row| {
                for (w, word) in row.iter_mut().enumerate() {
                    let columns = w * BITS..width.min((w + 1) * BITS);
                    *word = columns.enumerate().fold(0, |word, (i, x)| word | u64::from(is_set(x, y)) << i);
                }
            });
        }
        mask
    }

    /// The number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The numbers of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Returns whether a pixel is set; false outside.
    pub fn get(&self, x: usize, y: usize) -> bool {
        x < self.width && y < self.height && self.row(y)[x / BITS] >> (x % BITS) & 1 == 1
    }

    /// Returns the words of row `y`.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, y: usize) -> &[u64] {
        let words = self.width.div_ceil(BITS);
        &self.words[y * words..(y + 1) * words]
    }

    /// Changes the words of row `y` with `write`, and clears the bits beyond the width.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn write_row<R>(&mut self, y: usize, write: impl FnOnce(&mut [u64]) -> R) -> R {
        let (words, beyond) = (self.width.div_ceil(BITS), self.beyond());
        let row = &mut self.words[y * words..(y + 1) * words];
        let result = write(row);
        if let Some(last) = row.last_mut() {
            *last &= !beyond;
        }
        result
    }

    /// Changes the words of all rows with `write`, which gets the words per row too, and clears the bits beyond the width.
    pub fn write<R>(&mut self, write: impl FnOnce(&mut [u64], usize) -> R) -> R {
        let (words, beyond) = (self.width.div_ceil(BITS), self.beyond());
        let result = write(&mut self.words, words);
        if beyond != 0 {
            self.words.chunks_exact_mut(words).for_each(|row| row[words - 1] &= !beyond);
        }
        result
    }

    /// The bits beyond the width in the last word of a row.
    fn beyond(&self) -> u64 {
        match self.width % BITS {
            0 => 0,
            inside => u64::MAX << inside,
        }
    }

    /// The number of set pixels.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.words[..])
    }
}

/// A compressed mask for storage: one bit per word, and the words that are not 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedMask {
    size: (usize, usize),
    is_there: Vec<u64>,
    words: Vec<u64>,
}

impl PackedMask {
    /// Compresses a mask.
    pub fn new(mask: &Mask) -> Self {
        let bits = mask
            .words
            .chunks(BITS)
            .map(|words| words.iter().enumerate().fold(0, |bits, (i, word)| bits | u64::from(*word != 0) << i));
        let words = mask.words.iter().copied().filter(|word| *word != 0);
        Self { size: mask.size(), is_there: bits.collect(), words: words.collect() }
    }

    /// Decompresses the mask.
    pub fn unpacked(&self) -> Mask {
        let (width, height) = self.size;
        let mut mask = Mask::new(width, height);
        let mut words = self.words.iter();
        for (words_of_bits, bits) in mask.words.chunks_mut(BITS).zip(&self.is_there) {
            let there = words_of_bits.iter_mut().enumerate().filter(|(i, _)| bits >> i & 1 == 1);
            there.zip(&mut words).for_each(|((_, word), packed)| *word = *packed);
        }
        mask
    }

    /// The number of set pixels.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.is_there[..]) + size_of_val(&self.words[..])
    }
}

impl fmt::Debug for Mask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Mask {}×{}, {} set: {:x?}", self.width, self.height, self.count(), self.words)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::{Connectivity, Labelling};
    use super::*;

    /// A pseudo-random mask with this percentage of set pixels.
    pub fn scattered(width: usize, height: usize, share: u64) -> Mask {
        Mask::from_fn(width, height, |x, y| {
            let hash = ((x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D);
            (hash >> 33) % 100 < share
        })
    }

    #[test]
    fn a_packed_mask_is_the_same_and_small() {
        for (width, height) in [(1, 1), (65, 2), (640, 48), (1920, 70)] {
            for share in [0, 1, 50, 100] {
                let mask = scattered(width, height, share);
                let packed = PackedMask::new(&mask);
                assert_eq!((packed.unpacked(), packed.count()), (mask.clone(), mask.count()));
                assert!(packed.bytes() <= mask.bytes() + mask.bytes().div_ceil(BITS) + 8);
            }
        }
        let object = Mask::from_fn(1920, 1080, |x, y| (900..1000).contains(&x) && (400..600).contains(&y));
        assert!(40 * PackedMask::new(&object).bytes() < object.bytes() * 2, "one object of 100×200 px");
    }

    /// Whether no bit beyond the width is set.
    fn is_sound(mask: &Mask) -> bool {
        (0..mask.height()).all(|y| mask.row(y).last().is_none_or(|last| last & mask.beyond() == 0))
    }

    #[test]
    fn no_operation_leaves_bits_beyond_the_width() {
        for width in (1..=130).chain([200, 854]) {
            let mut full = Mask::new(width, 7);
            full.write(|words, in_row| {
                assert_eq!((in_row, words.len()), (width.div_ceil(BITS), 7 * width.div_ceil(BITS)));
                words.fill(u64::MAX);
            });
            let mut by_rows = Mask::new(width, 7);
            (0..7).for_each(|y| by_rows.write_row(y, |row| row.fill(u64::MAX)));
            assert!(is_sound(&full) && full == by_rows && full.count() == 7 * width, "{width}");
            assert_eq!(full, Mask::from_fn(width, 7, |_, _| true));
            assert_eq!(full.inverted(), Mask::new(width, 7));
            for mask in [full, scattered(width, 7, 30), scattered(width, 7, 80), Mask::new(width, 7)] {
                let made = [mask.inverted(), mask.without(&mask.inverted()), PackedMask::new(&mask).unpacked()];
                let moved = [0, 1, 3, 30].map(|r| [mask.dilated(r), mask.eroded(r), mask.opened(r), mask.closed(r)]);
                assert!(made.iter().chain(moved.as_flattened()).all(is_sound), "{width}");
                assert_eq!(mask.count() + mask.inverted().count(), 7 * width);
                for connectivity in [Connectivity::Four, Connectivity::Eight] {
                    let labelling = Labelling::of(&mask, connectivity);
                    assert!(labelling.runs().iter().all(|run| run.start < run.end && run.end as usize <= width));
                }
            }
        }
    }

    #[test]
    fn a_mask_holds_what_it_is_made_of() {
        for (width, height) in [(1, 1), (63, 2), (64, 3), (65, 2), (200, 5)] {
            let is_set = |x: usize, y: usize| (x * 7 + y * 13) % 5 < 2;
            let mask = Mask::from_fn(width, height, is_set);
            let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            assert!(places().all(|(x, y)| mask.get(x, y) == is_set(x, y)));
            assert_eq!(mask.count(), places().filter(|&(x, y)| is_set(x, y)).count(), "no bit beyond the width");
            assert!(!mask.get(width, 0) && !mask.get(0, height));
        }
    }
}
