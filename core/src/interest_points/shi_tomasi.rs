//! Shi and Tomasi's good features to track.

use crate::differential::{Scheme, Tensor, Weights, tell};
use crate::features::{Measure, Settings};
use crate::scene::Math;
use crate::{Info, Role, params};

params! {
    /// Shi and Tomasi's corners: where the smaller eigenvalue of the structure tensor is largest.
    pub struct ShiTomasi {
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

impl Measure for ShiTomasi {
    const INFO: Info = Info {
        id: "shi-tomasi",
        name: "Shi–Tomasi corners",
        family: "Interest points",
        summary: "Finds the places that can be tracked best: where even the weaker direction has much gradient.",
        source: "J. Shi and C. Tomasi, Good features to track, CVPR 1994",
        pseudocode: &[
            "Iₓ, I_y ← derivatives of frame t",
            "for each pixel, over the window around it",
            "  T ← Σ w (Iₓ², Iₓ I_y; Iₓ I_y, I_y²)",
            "  R ← the smaller eigenvalue of T",
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
        let Self { window, weights, derivatives, threshold, min_distance, max_points } = *self;
        Settings { window, weights, derivatives, threshold, min_distance, max_points }
    }

    #[inline(always)]
    fn response(&self, [xx, xy, yy]: [f32; 3]) -> f32 {
        Tensor { xx, xy, yy, ..Tensor::default() }.eigenvalues()[1]
    }

    const SHOWN: &'static str = "square root of R";

    fn shown(response: f32) -> f32 {
        response.sqrt()
    }

    fn equation(&self, tensor: &Tensor) -> [Math; 2] {
        let Tensor { xx, xy, yy, .. } = *tensor;
        let symbols = Math::Row(vec![
            Math::Var("R"),
            Math::text(" = ½ tr "),
            Math::Var("T"),
            Math::text(" − √((½ tr "),
            Math::Var("T"),
            Math::text(")² − det "),
            Math::Var("T"),
            Math::text(")"),
        ]);
        let half = (xx + yy) / 2.0;
        let numbers = Math::Row(vec![
            Math::text(" = "),
            Math::ink(Role::Reference, tell::number(half)),
            Math::text(" − √("),
            Math::power(Math::ink(Role::Reference, tell::number(half)), Math::text("2")),
            Math::text(" − "),
            Math::ink(Role::Reference, tell::number(xx * yy - xy * xy)),
            Math::text(") = "),
            Math::ink(Role::Result, tell::number(self.response([xx, xy, yy]))),
        ]);
        [symbols, numbers]
    }
}
