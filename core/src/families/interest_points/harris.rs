//! Harris and Stephens' corner detector.

use crate::base::Threads;
use crate::geometry::{Gray, Grid};
use crate::methods::{
    differential::{Tensor, numbers},
    features::{Corners, Measure, Settings, corner_pseudocode},
};
use crate::params;
use crate::run::Info;
use crate::scene::{Math, Role};

params! {
    /// Harris and Stephens' corners: local maxima of R = det T − k (tr T)², where T is the structure tensor.
    pub struct Harris {
        /// Harris constant k. Larger values reject more edges: R is positive only where λ₁ λ₂ > k (λ₁ + λ₂)².
        k: f32 = 0.04, 0.0..=0.25;
        /// Parameters that all corner detectors share.
        settings: Settings = Settings::default();
    }
}

impl Harris {
    /// Returns the response map of an image.
    pub fn responses(&self, picture: &Gray, threads: &Threads) -> Grid<f32> {
        Corners(self.clone()).map(picture, threads)
    }
}

corner_pseudocode!("  R ← det T − k (tr T)²");

impl Measure for Harris {
    const INFO: Info = Info {
        id: "harris",
        name: "Harris corners",
        family: "Interest points",
        summary: "Corner detection by determinant and trace of the structure tensor, without computing its eigenvalues.",
        source: "C. Harris and M. Stephens, A combined corner and edge detector, Proc. 4th Alvey Vision Conference, 1988",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "row", "step"],
        frames: 1,
    };

    fn settings(&self) -> Settings {
        self.settings
    }

    #[inline(always)]
    fn response(&self, [xx, xy, yy]: [f32; 3]) -> f32 {
        let trace = xx + yy;
        xx * yy - xy * xy - self.k * trace * trace
    }

    const SHOWN: &'static str = "sign(R) · ⁴√|R|";

    fn shown(response: f32) -> f32 {
        response.signum() * response.abs().powf(0.25)
    }

    fn equation(&self, tensor: &Tensor) -> [Math; 2] {
        let Tensor { xx, xy, yy, .. } = *tensor;
        let symbols = Math::Row(vec![
            Math::Var("R"),
            Math::text(" = det "),
            Math::Bold("T"),
            Math::text(" − "),
            Math::Var("k"),
            Math::text(" "),
            Math::power(Math::Row(vec![Math::text("(tr "), Math::Bold("T"), Math::text(")")]), Math::text("2")),
        ]);
        let numbers = Math::Row(vec![
            Math::text(" = "),
            Math::ink(Role::Reference, numbers::response(xx * yy - xy * xy)),
            Math::text(format!(" − {} · ", self.k)),
            Math::power(Math::ink(Role::Reference, numbers::base(xx + yy)), Math::text("2")),
            Math::text(" = "),
            Math::ink(Role::Result, numbers::response(self.response([xx, xy, yy]))),
        ]);
        [symbols, numbers]
    }

    fn meaning(&self, [large, _]: [f32; 2], response: f32, flat: f32) -> String {
        let value = format!("R = det T − k (tr T)² = {}", numbers::response(response));
        match () {
            () if large < flat => {
                format!("{value}: λ₁ is below {}, as noise alone can cause: a flat area.", numbers::response(flat))
            }
            () if response > 0.0 => format!("{value} is positive: gradients in two directions, possibly a corner."),
            () => format!("{value} is not positive: gradients in one direction only, an edge."),
        }
    }
}
