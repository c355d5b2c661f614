//! Refinement of extrema by a quadratic in position and scale, and the tests of contrast and of edges.

use super::{BORDER, Extremum, Octave};

/// The thresholds of keypoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// Smallest absolute interpolated value of the difference of Gaussians in gray levels.
    pub contrast: f32,
    /// Largest ratio of the principal curvatures.
    pub edge: f32,
}

/// Iterations after which an extremum that still moves is rejected.
pub const MAX_ITERATIONS: usize = 5;

/// One iteration: the offset of the quadratic's extremum from a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// The pixel.
    pub at: Extremum,
    /// Gradient of the difference of Gaussians in x, y and scale.
    pub gradient: [f32; 3],
    /// Second derivatives xx, yy, ss, xy, xs, ys.
    pub hessian: [f32; 6],
    /// Offset of the extremum in px of the octave, px and levels.
    pub offset: [f32; 3],
    /// Value at the pixel.
    pub value: f32,
}

impl Iteration {
    /// Whether the extremum lies within half a pixel and half a level.
    pub fn is_converged(&self) -> bool {
        self.offset.iter().all(|c| c.abs() < 0.5)
    }

    /// The interpolated value at the extremum.
    pub fn contrast(&self) -> f32 {
        let along: f32 = self.gradient.iter().zip(self.offset).map(|(slope, offset)| slope * offset).sum();
        self.value + 0.5 * along
    }

    /// Trace and determinant of the Hessian in position.
    pub fn curvature(&self) -> [f32; 2] {
        let [xx, yy, _, xy, ..] = self.hessian;
        [xx + yy, xx * yy - xy * xy]
    }
}

/// Reason for the rejection of an extremum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// It still moves after the last iteration, or leaves the scale space.
    Unstable,
    /// Its interpolated value is too small.
    LowContrast,
    /// The ratio of its principal curvatures is that of an edge.
    Edge,
}

/// An extremum with sub-pixel position and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// The pixel nearest to it.
    pub at: Extremum,
    /// Its offset from there in px of the octave, px and levels.
    pub offset: [f32; 3],
    /// The absolute interpolated value of the difference of Gaussians in gray levels.
    pub response: f32,
}

/// Refines an extremum; calls `tell` with each iteration.
///
/// # Errors
/// The reason of its rejection.
pub fn refine(
    octave: &Octave,
    mut at: Extremum,
    thresholds: Thresholds,
    mut tell: impl FnMut(Iteration),
) -> Result<Refined, Rejection> {
    for _ in 0..MAX_ITERATIONS {
        let iteration = iterate(octave, at);
        tell(iteration);
        if iteration.is_converged() {
            return judge(&iteration, thresholds);
        }
        at = moved(octave, &iteration).ok_or(Rejection::Unstable)?;
    }
    Err(Rejection::Unstable)
}

fn judge(last: &Iteration, Thresholds { contrast, edge }: Thresholds) -> Result<Refined, Rejection> {
    let response = last.contrast().abs();
    if response < contrast {
        return Err(Rejection::LowContrast);
    }
    let [trace, determinant] = last.curvature();
    if determinant <= 0.0 || trace * trace * edge >= (edge + 1.0).powi(2) * determinant {
        return Err(Rejection::Edge);
    }
    Ok(Refined { at: last.at, offset: last.offset, response })
}

/// The pixel nearest to the extremum of an iteration, inside the border.
fn moved(octave: &Octave, Iteration { at, offset, .. }: &Iteration) -> Option<Extremum> {
    /// Offsets beyond this are those of a singular Hessian.
    const FAR_PX: f32 = 1e4;
    if offset.iter().any(|c| c.is_nan() || c.abs() > FAR_PX) {
        return None;
    }
    let step = |c: usize, by: f32| c.checked_add_signed(by.round() as isize);
    let (x, y, level) = (step(at.x, offset[0])?, step(at.y, offset[1])?, step(at.level, offset[2])?);
    let (width, height) = octave.differences[at.level].size();
    let is_inside = |c: usize, extent: usize| c >= BORDER && c + BORDER < extent;
    let is_level = level >= 1 && level + 1 < octave.differences.len();
    (is_level && is_inside(x, width) && is_inside(y, height)).then_some(Extremum { x, y, level, ..*at })
}

/// Fits the quadratic around a pixel.
fn iterate(octave: &Octave, at: Extremum) -> Iteration {
    let Extremum { level, x, y, .. } = at;
    let [below, here, above] = [level - 1, level, level + 1].map(|level| &*octave.differences[level]);
    let value = here[(x, y)];
    let half = |next: f32, previous: f32| (next - previous) * 0.5;
    let second = |next: f32, previous: f32| next + previous - 2.0 * value;
    let mixed = |pp: f32, mp: f32, pm: f32, mm: f32| (pp - mp - pm + mm) * 0.25;
    let gradient = [
        half(here[(x + 1, y)], here[(x - 1, y)]),
        half(here[(x, y + 1)], here[(x, y - 1)]),
        half(above[(x, y)], below[(x, y)]),
    ];
    let hessian = [
        second(here[(x + 1, y)], here[(x - 1, y)]),
        second(here[(x, y + 1)], here[(x, y - 1)]),
        second(above[(x, y)], below[(x, y)]),
        mixed(here[(x + 1, y + 1)], here[(x - 1, y + 1)], here[(x + 1, y - 1)], here[(x - 1, y - 1)]),
        mixed(above[(x + 1, y)], above[(x - 1, y)], below[(x + 1, y)], below[(x - 1, y)]),
        mixed(above[(x, y + 1)], above[(x, y - 1)], below[(x, y + 1)], below[(x, y - 1)]),
    ];
    Iteration { at, gradient, hessian, offset: extremum_of(gradient, hessian), value }
}

/// The offset −H⁻¹ g of the extremum of a quadratic, by Cramer's rule; infinite for a singular Hessian.
fn extremum_of(gradient: [f32; 3], [xx, yy, ss, xy, xs, ys]: [f32; 6]) -> [f32; 3] {
    let [gx, gy, gs] = gradient.map(f64::from);
    let [xx, yy, ss, xy, xs, ys] = [xx, yy, ss, xy, xs, ys].map(f64::from);
    // The adjugate of the symmetric matrix.
    let adjugate = [
        [yy * ss - ys * ys, xs * ys - xy * ss, xy * ys - xs * yy],
        [xs * ys - xy * ss, xx * ss - xs * xs, xy * xs - xx * ys],
        [xy * ys - xs * yy, xy * xs - xx * ys, xx * yy - xy * xy],
    ];
    let determinant = xx * adjugate[0][0] + xy * adjugate[0][1] + xs * adjugate[0][2];
    adjugate.map(|row| (-(row[0] * gx + row[1] * gy + row[2] * gs) / determinant) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremum_of_a_quadratic_is_exact() {
        // f = ½ pᵀ H p + gᵀ p has its extremum where H p = −g.
        let (hessian, place) = ([-4.0, -3.0, -2.0, 0.5, -0.25, 0.75], [0.3f32, -0.2, 0.45]);
        let [xx, yy, ss, xy, xs, ys] = hessian;
        let times = [[xx, xy, xs], [xy, yy, ys], [xs, ys, ss]]
            .map(|row: [f32; 3]| -row.iter().zip(place).map(|(a, b)| a * b).sum::<f32>());
        let found = extremum_of(times, hessian);
        assert!(found.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        assert!(extremum_of([1.0; 3], [0.0; 6]).iter().all(|c| !c.is_finite()));
    }
}
