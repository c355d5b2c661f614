//! The true foreground of a frame.

use super::{Mask, PackedMask};
use crate::base::Error;
use crate::geometry::Grid;

/// The true class of a pixel, as changedetection.net labels it (N. Goyette and others, Changedetection.net: a new change detection
/// benchmark dataset, CVPR workshops 2012).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelClass {
    /// It belongs to the background.
    Background,
    /// It belongs to the background, and lies in the shadow of an object.
    Shadow,
    /// It is not compared: outside the region of interest, or of unknown motion.
    Ignored,
    /// It belongs to a moving object.
    Foreground,
}

/// The true class of each pixel of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueMask(pub Grid<PixelClass>);

/// The pixels of a mask compared with the truth; shadows count as background.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskErrors {
    /// Foreground in both: true positives.
    pub correct: Mask,
    /// Foreground in the mask alone: false positives.
    pub false_positives: Mask,
    /// Foreground in the truth alone: false negatives.
    pub misses: Mask,
    /// Number of pixels whose class is known.
    pub labelled: usize,
}

impl TrueMask {
    /// Compares a mask with this truth.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn compare(&self, mask: &PackedMask) -> Result<MaskErrors, Error> {
        let mask = mask.unpacked();
        let ((width, height), (w, h)) = (self.0.size(), mask.size());
        if (width, height) != (w, h) {
            return Err(Error::new(format!(
                "the mask is {w}×{h} px and the true mask {width}×{height} px; both must have one size"
            )));
        }
        let with = |found: bool, is_true: bool| {
            Mask::from_fn(width, height, |x, y| {
                let class = self.0[(x, y)];
                class != PixelClass::Ignored && mask.get(x, y) == found && (class == PixelClass::Foreground) == is_true
            })
        };
        let labelled = self.0.cells().iter().filter(|class| **class != PixelClass::Ignored).count();
        let (correct, false_positives, misses) = (with(true, true), with(true, false), with(false, true));
        Ok(MaskErrors { correct, false_positives, misses, labelled })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadows_are_background_and_what_is_ignored_counts_nowhere() {
        use PixelClass::{Background, Foreground, Ignored, Shadow};
        let truth = TrueMask(Grid::from_fn(8, 1, |x, _| [Background, Shadow, Ignored, Foreground][x % 4]));
        let mask = PackedMask::new(&Mask::from_fn(8, 1, |x, _| x < 4));
        let MaskErrors { correct, false_positives, misses, labelled } = truth.compare(&mask).unwrap();
        let set = |mask: &Mask| (0..8).filter(|x| mask.get(*x, 0)).collect::<Vec<_>>();
        assert_eq!([set(&correct), set(&false_positives), set(&misses)], [vec![3], vec![0, 1], vec![7]]);
        assert_eq!(labelled, 6);
        let other = PackedMask::new(&Mask::new(7, 1));
        assert!(truth.compare(&other).unwrap_err().to_string().contains("7×1"));
    }
}
