//! The Jacobi update of one pixel: the neighbour weights and the correction by the gradient constraint.

/// Weight of the four horizontal and vertical neighbours in the mean.
pub const BESIDE: f32 = 1.0 / 6.0;
/// Weight of the four diagonal neighbours in the mean.
pub const CORNER: f32 = 1.0 / 12.0;

/// Returns the mean of the neighbours, corrected by the pixel's scaled constraint.
#[inline(always)]
pub fn update([u, v]: [f32; 2], [a, b, c]: [f32; 3]) -> [f32; 2] {
    let off = a * u + b * v + c;
    [u - a * off, v - b * off]
}
