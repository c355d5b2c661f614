//! Cast shadows: pixels of the colour of the background, but darker.

use crate::data::Mask;
use crate::geometry::Grid;
use crate::params;

params! {
    /// The detection of cast shadows.
    #[derive(Copy)]
    pub struct ShadowDetection {
        /// Detect cast shadows, pixels of the colour of the background but darker, and remove them from the foreground. Needs colour. Pixels with
        /// foreground on both sides, in their row or column, belong to the object.
        detect_shadows: bool = true;
        /// Minimum brightness τ of a shadow, as a share of the brightness of the background. Darker pixels are objects.
        shadow_threshold: f32 = 0.5, 0.05..=1.0;
    }
    advanced { "shadow-threshold" }
    when {
        "shadow-threshold": |p| p.detect_shadows, "The shadow threshold has no effect without shadow detection.";
    }
}

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
    shadow_brightness(pixel, mean, limits).is_some()
}

/// The brightness of a shadow on `mean`, as a share of that; `None` for another pixel. As [`is_shadow`].
#[inline(always)]
pub fn shadow_brightness<const C: usize>(pixel: [f32; C], mean: [f32; C], limits: ShadowLimits) -> Option<f32> {
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
    (light >= limits.darkest && light <= 1.0 && off <= limits.limit + TINT * TINT * bright).then_some(light)
}

/// The radius of the opening that foreground beside a shadow survives, in px: single pixels are noise.
const SOLID_PX: usize = 1;

/// Returns the shadow pixels that `objects`, the foreground without shadows, encloses: in their row or column an unbroken line of
/// foreground and shadow leads to objects on both sides.
///
/// A cast shadow lies beside its object. Gray clothes and gray cars on a gray ground pass the test of the colour, but lie within the object.
pub fn enclosed(objects: &Mask, shadows: &Mask) -> Mask {
    let (width, height) = shadows.size();
    // Only lines with shadow matter, and they are few.
    let has_shadow = |y: &usize| shadows.row(*y).iter().any(|word| *word != 0);
    let rows: Vec<usize> = (0..height).filter(has_shadow).collect();
    let columns: Vec<usize> = (0..width).filter(|x| rows.iter().any(|y| shadows.get(*x, *y))).collect();
    if rows.is_empty() {
        return Mask::new(width, height);
    }
    let (solid, mut is_enclosed) = (objects.opened(SOLID_PX), Grid::new(width, height, false));
    let kind = |x: usize, y: usize| [solid.get(x, y), shadows.get(x, y), objects.get(x, y)];
    for y in rows {
        between(width, |x| kind(x, y), |x| is_enclosed[(x, y)] = true);
    }
    for x in columns {
        between(height, |y| kind(x, y), |y| is_enclosed[(x, y)] = true);
    }
    Mask::from_fn(width, height, |x, y| is_enclosed[(x, y)] && shadows.get(x, y))
}

/// Calls `mark` for each place of a line between two solid ones, if all between them are shadow or object. `kind` tells whether a place is
/// solid, shadow and object.
fn between(length: usize, kind: impl Fn(usize) -> [bool; 3], mut mark: impl FnMut(usize)) {
    let mut last = None;
    for place in 0..length {
        match kind(place) {
            [true, ..] => {
                let from = last.replace(place).unwrap_or(place);
                (from + 1..place).for_each(&mut mark);
            }
            [_, false, false] => last = None,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mask of the places that are `of`.
    fn drawn(rows: &[&str], of: char) -> Mask {
        let at = |x: usize, y: usize| rows[y].chars().nth(x) == Some(of);
        Mask::from_fn(rows[0].len(), rows.len(), at)
    }

    #[test]
    fn a_gray_body_is_the_object_and_the_shadow_beside_it_is_not() {
        let rows = [
            "..............",
            "..ooooo.......",
            "..ooooo.......",
            "..ooooo...ooo.",
            "..sssss.s.ooo.",
            "..sssss.s.ooo.",
            "..ooooosss....",
            "..ooooosss.o..",
            "..ooooosssso..",
            "..............",
        ];
        let (objects, shadows) = (drawn(&rows, 'o'), drawn(&rows, 's'));
        let found = enclosed(&objects, &shadows);
        // The body between the two parts; neither the shadow at their side, nor one before a thin line of noise, nor one apart.
        let body = Mask::from_fn(14, 10, |x, y| (2..7).contains(&x) && (4..6).contains(&y));
        assert_eq!(found, body);
    }
}
