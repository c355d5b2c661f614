//! Covariance ellipses.

use super::chi_square;
use crate::scene::Shape;

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

#[cfg(test)]
mod tests {
    use super::*;

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
