//! The data term of variational methods: the gradient constraint about a field that was found so far.

use super::{Derivatives, Field, Sampling, Scheme, backward};
use crate::{Grid, Threads};

/// The constraint a u + b v + c = 0 of every pixel, linear about the displacements `start`.
///
/// Frame t + 1 is brought back along `start`, so that its derivatives (a, b, Iₜ) are of what is left to find; then
/// c = Iₜ − a u₀ − b v₀, so that (u, v) is the whole displacement. A pixel that leaves the picture says nothing: 0, 0, 0.
pub struct Linear {
    /// a, b and c, in gray levels.
    pub factors: Derivatives,
    /// The displacements about which they are linear.
    pub start: Field,
}

impl Linear {
    /// The constraints of a pair of `pictures` about `start`.
    pub fn about(start: Field, pictures: [&Grid<f32>; 2], scheme: Scheme, threads: &Threads) -> Self {
        let [current, next] = pictures;
        // Where nothing was found yet there is nothing to bring back.
        let is_at_rest = start.u.cells().iter().chain(start.v.cells()).all(|c| *c == 0.0);
        let warped = match is_at_rest {
            true => next.clone(),
            false => backward(next, [&start.u, &start.v], Sampling::Bicubic, threads),
        };
        let Derivatives { mut x, mut y, mut t } = scheme.of(current, &warped, threads);
        let start_at = start.u.cells().iter().zip(start.v.cells());
        let factors = x.cells_mut().iter_mut().zip(y.cells_mut()).zip(t.cells_mut());
        for (((a, b), c), (u, v)) in factors.zip(start_at) {
            *c -= *a * u + *b * v;
            if !c.is_finite() {
                (*a, *b, *c) = (0.0, 0.0, 0.0);
            }
        }
        Self { factors: Derivatives { x, y, t }, start }
    }
}
