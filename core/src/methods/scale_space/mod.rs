//! Gaussian scale space after Lowe (2004): octaves, extrema of differences of Gaussians, orientations and descriptors.

mod descriptor;
mod extrema;
mod octaves;
mod orientation;
mod refine;

pub use descriptor::{BINS, CELLS, CLAMP, Descriptor, Place, SIDE};
pub use extrema::{BORDER, Extremum, beats, extrema_of_row};
pub use octaves::{Octave, ScaleSpace, Shape};
pub use orientation::{Histogram, ORIENTATIONS, PEAK_RATIO, Peak};
pub use refine::{Iteration, Refined, Rejection, Thresholds, refine};

/// Angle of the vector `(x, y)` in radians, −π to π, from x towards y. A polynomial of the arc tangent with an error below 10⁻⁵ that
/// compilers turn into vector instructions.
#[inline(always)]
fn angle(x: f32, y: f32) -> f32 {
    use std::f32::consts::{FRAC_PI_2, PI};
    let (large, small) = (x.abs().max(y.abs()), x.abs().min(y.abs()));
    let t = small / (large + f32::MIN_POSITIVE);
    let s = t * t;
    // Abramowitz and Stegun 4.4.49.
    let series = 0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1)));
    let octant = t * series;
    let quadrant = if y.abs() > x.abs() { FRAC_PI_2 - octant } else { octant };
    let half = if x < 0.0 { PI - quadrant } else { quadrant };
    if y < 0.0 { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::angle;

    #[test]
    fn the_angle_is_that_of_the_arc_tangent() {
        for i in 0..720 {
            let exact = (f64::from(i) * 0.5 - 180.0).to_radians();
            let found = angle(7.0 * exact.cos() as f32, 7.0 * exact.sin() as f32);
            let off = (f64::from(found) - exact).rem_euclid(std::f64::consts::TAU);
            assert!(off.min(std::f64::consts::TAU - off) < 2e-5, "{exact}: {found}");
        }
        assert_eq!(angle(0.0, 0.0), 0.0);
    }
}
