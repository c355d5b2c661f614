//! Frame differencing: the number of frames, and a threshold from the noise.

use crate::choices;

choices! {
    /// The number of frames that are compared.
    pub enum Differencing {
        /// Two-frame differencing: |I(t) − I(t−1)|. Uncovered background behind an object is foreground too, as a ghost.
        Two = "2" "Two frames",
        /// Three-frame differencing: a foreground pixel differs from both previous frames, which reduces ghosts.
        Three = "3" "Three frames",
    }
}

/// The automatic threshold in standard deviations of the noise.
pub const NOISE_SIGMAS: f32 = 4.0;
/// The least automatic threshold in gray levels: rounding and compression.
const LEAST_THRESHOLD: f32 = 8.0;
/// The standard deviation of a normal distribution, as a multiple of its median absolute deviation.
const SIGMA_OF_MAD: f32 = 1.4826;

/// Returns the standard deviation of the noise of a frame difference, given its absolute values: most pixels are
/// background, so objects do not affect the median absolute difference (P. J. Rousseeuw and C. Croux, JASA 88, 1993).
pub fn noise_of(differences: impl Iterator<Item = u8>) -> f32 {
    let (mut counts, mut all) = ([0usize; 256], 0usize);
    differences.for_each(|difference| {
        counts[usize::from(difference)] += 1;
        all += 1;
    });
    let half = all as f32 / 2.0;
    let mut below = 0.0;
    for (level, count) in counts.iter().enumerate() {
        let count = *count as f32;
        if below + count >= half {
            // Whole levels are intervals: 0 stands for 0 to 0.5, others for half a level to either side.
            let (start, width) = if level == 0 { (0.0, 0.5) } else { (level as f32 - 0.5, 1.0) };
            return SIGMA_OF_MAD * (start + width * (half - below) / count.max(1.0));
        }
        below += count;
    }
    0.0
}

/// Returns the threshold in gray levels for noise of this standard deviation.
pub fn automatic_threshold(noise: f32) -> u8 {
    (NOISE_SIGMAS * noise).ceil().max(LEAST_THRESHOLD) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_do_not_change_the_noise() {
        let noise = |objects: usize| {
            let background = (0..1000u32).map(|i| (i % 5) as u8);
            noise_of(background.chain(std::iter::repeat_n(200, objects)))
        };
        assert!((noise(0) - SIGMA_OF_MAD * 2.0).abs() < 0.01 && noise(150) < 1.3 * noise(0));
        assert_eq!((automatic_threshold(0.0), automatic_threshold(3.1)), (8, 13));
        assert_eq!(noise_of(std::iter::empty()), 0.0);
    }
}
