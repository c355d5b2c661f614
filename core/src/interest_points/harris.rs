//! Harris and Stephens' corner detector.

use crate::differential::{Scheme, Tensor, Weights, tell};
use crate::features::{Measure, Settings};
use crate::scene::Math;
use crate::{Info, Role, params};

params! {
    /// Harris and Stephens' corners: where det T − k (tr T)² of the structure tensor T is largest.
    pub struct Harris {
        /// How much the trace counts against the determinant: the larger, the less an edge passes for a corner.
        k: f32 = 0.04, 0.0..=0.25;
        /// Side of the window of the structure tensor; an even one reaches as far as the next odd one.
        window: usize = 5, 3..=31, "px";
        /// How much the pixels of the window count.
        weights: Weights = Weights::Gaussian;
        /// How derivatives are estimated from pixels.
        derivatives: Scheme = Scheme::Sobel;
        /// The least response of a corner, as a share of the largest in the picture.
        threshold: f32 = 0.01, 0.0..=1.0;
        /// From a corner to the next stronger one it is at least this far; 0 allows any distance.
        min_distance: usize = 7, 0..=100, "px";
        /// At most so many corners are kept, the strongest.
        max_points: usize = 500, 1..=5000;
    }
}

impl Measure for Harris {
    const INFO: Info = Info {
        id: "harris",
        name: "Harris corners",
        family: "Interest points",
        summary: "Finds the places where gradients point in several directions, without asking for eigenvalues.",
        source: "C. Harris and M. Stephens, A combined corner and edge detector, Proc. 4th Alvey Vision Conference, 1988",
        pseudocode: &[
            "Iₓ, I_y ← derivatives of frame t",
            "for each pixel, over the window around it",
            "  T ← Σ w (Iₓ², Iₓ I_y; Iₓ I_y, I_y²)",
            "  R ← det T − k (tr T)²",
            "for each pixel with R ≥ threshold · largest R",
            "  if a neighbour is stronger, then suppress it",
            "for each that is left, the strongest first",
            "  if one nearer than min-distance was kept, then drop it",
            "  else keep it, until there are max-points",
        ],
        rungs: &["frame", "stage", "row", "step"],
        frames: 2,
    };

    fn settings(&self) -> Settings {
        let Self { window, weights, derivatives, threshold, min_distance, max_points, .. } = *self;
        Settings { window, weights, derivatives, threshold, min_distance, max_points }
    }

    #[inline(always)]
    fn response(&self, [xx, xy, yy]: [f32; 3]) -> f32 {
        let trace = xx + yy;
        xx * yy - xy * xy - self.k * trace * trace
    }

    const SHOWN: &'static str = "fourth root of |R|, with its sign";

    fn shown(response: f32) -> f32 {
        response.signum() * response.abs().powf(0.25)
    }

    fn equation(&self, tensor: &Tensor) -> [Math; 2] {
        let Tensor { xx, xy, yy, .. } = *tensor;
        let symbols = Math::Row(vec![
            Math::Var("R"),
            Math::text(" = det "),
            Math::Var("T"),
            Math::text(" − "),
            Math::Var("k"),
            Math::text(" "),
            Math::power(Math::Row(vec![Math::text("(tr "), Math::Var("T"), Math::text(")")]), Math::text("2")),
        ]);
        let numbers = Math::Row(vec![
            Math::text(" = "),
            Math::ink(Role::Reference, tell::number(xx * yy - xy * xy)),
            Math::text(format!(" − {} · ", self.k)),
            Math::power(Math::ink(Role::Reference, tell::number(xx + yy)), Math::text("2")),
            Math::text(" = "),
            Math::ink(Role::Result, tell::number(self.response([xx, xy, yy]))),
        ]);
        [symbols, numbers]
    }
}
