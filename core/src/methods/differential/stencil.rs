//! One Jacobi update of one pixel: how much its neighbours count, and what follows from its constraint.

/// Weight of the neighbours beside, above and below in the average.
pub const BESIDE: f32 = 1.0 / 6.0;
/// Weight of those across the corners.
pub const CORNER: f32 = 1.0 / 12.0;

/// What fits a pixel and the mean of its neighbours.
#[inline(always)]
pub fn update([u, v]: [f32; 2], [a, b, c]: [f32; 3]) -> [f32; 2] {
    let off = a * u + b * v + c;
    [u - a * off, v - b * off]
}
