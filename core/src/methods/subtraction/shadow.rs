//! Cast shadows: pixels of the colour of the background, but darker.

/// The tolerated deviation from the colour of the background, as a share of the shadow's brightness: a shadow is lit by the sky, not by
/// the sun.
const TINT: f32 = 0.03;

/// The limits of a shadow.
#[derive(Clone, Copy, Debug)]
pub struct ShadowLimits {
    /// Minimum brightness τ, as a share of the brightness of the background.
    pub darkest: f32,
    /// The squared distance within which a pixel fits the background, over all channels together.
    pub limit: f32,
}

/// Returns whether a pixel is a shadow on `mean`: brightness ratio τ ≤ a ≤ 1 and a chromaticity distortion |I − a μ| within the noise of the
/// background and 3 % of the brightness (T. Horprasert, D. Harwood and L. S. Davis, A statistical approach for real-time robust
/// background subtraction and shadow detection, ICCV frame-rate workshop 1999). The noise of a sensor does not shrink in a shadow.
#[inline(always)]
pub fn is_shadow<const C: usize>(pixel: [f32; C], mean: [f32; C], limits: ShadowLimits) -> bool {
    let (mut along, mut square) = (0.0, 0.0);
    for c in 0..C {
        along += pixel[c] * mean[c];
        square += mean[c] * mean[c];
    }
    let light = along / square;
    let (mut off, mut bright) = (0.0, 0.0);
    for c in 0..C {
        off += (light * mean[c] - pixel[c]) * (light * mean[c] - pixel[c]);
        bright += pixel[c] * pixel[c];
    }
    // A black mean has no colour: `light` is not a number.
    light >= limits.darkest && light <= 1.0 && off <= limits.limit + TINT * TINT * bright
}
