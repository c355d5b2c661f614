//! Normal distributions in the plane: their ellipses, and their density as a surface.

use super::chi_square;
use crate::scene::{Picture, Shape, Surface};

/// Cells along a side of a density.
pub(super) const SIDE: usize = 61;

/// Returns the ellipse around `center` that contains the share `p` of a 2-D normal distribution; `None` if it is not finite.
pub fn ellipse(center: [f64; 2], covariance: [[f64; 2]; 2], p: f64) -> Option<Shape> {
    let [[xx, xy], [_, yy]] = covariance;
    let (mean, half) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
    let apart = half.hypot(xy);
    let scale = chi_square::quantile(p, 2);
    let radii = [mean + apart, (mean - apart).max(0.0)].map(|variance| (scale * variance).sqrt() as f32);
    let angle_rad = (0.5 * (2.0 * xy).atan2(xx - yy)) as f32;
    let shape = Shape::Ellipse { center: center.map(|c| c as f32), radii, angle_rad };
    shape.is_finite().then_some(shape)
}

/// The density of a normal distribution over the part of a picture up to `reach` px from `middle`, blurred by half a cell so that no peak
/// falls between cells; `None` if the covariance is singular.
pub fn density(
    center: [f64; 2],
    covariance: [[f64; 2]; 2],
    on: Picture,
    middle: [f64; 2],
    reach: f64,
) -> Option<Surface> {
    if !(reach > 0.0 && reach.is_finite()) {
        return None;
    }
    let blur = (reach / SIDE as f64).powi(2);
    let [[xx, xy], [yx, yy]] = covariance;
    let is_singular = xx * yy - xy * yx <= 0.0;
    let (xx, yy) = (xx + blur, yy + blur);
    let determinant = xx * yy - xy * yx;
    if is_singular || !(determinant > 0.0 && determinant.is_finite()) {
        return None;
    }
    let peak = 1.0 / (std::f64::consts::TAU * determinant.sqrt());
    let value = |at: [f32; 2]| {
        let [dx, dy] = [0, 1].map(|i| f64::from(at[i]) - center[i]);
        let squared = (yy * dx * dx - (xy + yx) * dx * dy + xx * dy * dy) / determinant;
        (peak * (-0.5 * squared).exp()) as f32
    };
    let square = (on, middle.map(|c| c as f32), reach as f32);
    let surface = Surface::sampled_over_picture(("density", "px⁻²"), square, SIDE, value);
    Some(Surface { is_similarity: true, ..surface })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_has_its_peak_in_the_middle_and_sums_to_one() {
        let around = |center, covariance, reach| density(center, covariance, Picture::CURRENT, [40.0, 30.0], reach);
        let surface = around([40.0, 30.0], [[9.0, 2.0], [2.0, 4.0]], 15.0).expect("it is one of the plane");
        let (most, at) = surface.optimum().expect("it is known");
        assert_eq!(at, [[0, 0]]);
        let exact = 1.0 / (std::f32::consts::TAU * 32.0_f32.sqrt());
        assert!((0.98 * exact..exact).contains(&most), "{most}: hardly lower for the blur");
        // Much narrower than a cell, wherever in it.
        for off in [0.0, 1.3, 2.5] {
            let spike = [[0.5, 0.0], [0.0, 0.5]];
            let surface = around([40.0 + off, 30.0], spike, 150.0).expect("it is one of the plane");
            let sum: f32 = surface.values.cells().iter().map(|value| value * surface.axes.step.powi(2)).sum();
            assert!((0.95..1.05).contains(&sum), "{off} px: {sum}");
        }
        let cell = surface.axes.step * surface.axes.step;
        let sum: f32 = surface.values.cells().iter().map(|value| value * cell).sum();
        assert!((sum - 1.0).abs() < 2e-3, "{sum}");
        assert_eq!(around([40.0, 30.0], [[1.0, 1.0], [1.0, 1.0]], 5.0), None);
    }

    #[test]
    fn semi_axes_are_standard_deviations_times_the_quantile() {
        // Turned by 30°, standard deviations 3 and 1.
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let covariance =
            [[9.0 * cos * cos + sin * sin, 8.0 * sin * cos], [8.0 * sin * cos, 9.0 * sin * sin + cos * cos]];
        let Some(Shape::Ellipse { radii, angle_rad, .. }) = ellipse([0.0; 2], covariance, 0.95) else { panic!() };
        let times = 5.991_464_547_f64.sqrt() as f32;
        assert!((radii[0] - 3.0 * times).abs() < 1e-4 && (radii[1] - times).abs() < 1e-4, "{radii:?}");
        assert!((angle_rad - 30.0_f32.to_radians()).abs() < 1e-5);
        assert_eq!(ellipse([0.0, f64::NAN], covariance, 0.95), None);
    }
}
