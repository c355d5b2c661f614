//! Harris and Stephens' corner detector.

use crate::base::{Threads, words};
use crate::geometry::{Gray, Grid};
use crate::methods::{
    differential::Tensor,
    features::{Corners, Measure, Settings, corner_pseudocode},
};
use crate::params;
use crate::run::Info;
use crate::scene::{Math, Role};

params! {
    /// Harris and Stephens' corners: where det T − k (tr T)² of the structure tensor T is largest.
    pub struct Harris {
        /// How much the trace counts against the determinant: the larger, the less an edge passes for a corner.
        k: f32 = 0.04, 0.0..=0.25;
        /// What all corner detectors have.
        settings: Settings = Settings::default();
    }
}

impl Harris {
    /// The responses of all pixels of a picture.
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
        summary: "Finds the places where gradients point in several directions, without asking for eigenvalues.",
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

    const SHOWN: &'static str = "fourth root of |R|, with its sign";

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
            Math::ink(Role::Reference, words::fine(xx * yy - xy * xy)),
            Math::text(format!(" − {} · ", self.k)),
            Math::power(Math::ink(Role::Reference, words::fine(xx + yy)), Math::text("2")),
            Math::text(" = "),
            Math::ink(Role::Result, words::fine(self.response([xx, xy, yy]))),
        ]);
        [symbols, numbers]
    }
}
