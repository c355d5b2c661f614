//! Shi and Tomasi's good features to track.

use crate::base::words;
use crate::methods::{
    differential::Tensor,
    features::{Measure, Settings, corner_pseudocode},
};
use crate::params;
use crate::run::Info;
use crate::scene::{Math, Role};

params! {
    /// Shi and Tomasi's corners: where the smaller eigenvalue of the structure tensor is largest.
    pub struct ShiTomasi {
        /// What all corner detectors have.
        settings: Settings = Settings::default();
    }
}

corner_pseudocode!("  R ← the smaller eigenvalue of T");

impl Measure for ShiTomasi {
    const INFO: Info = Info {
        id: "shi-tomasi",
        name: "Shi–Tomasi corners",
        family: "Interest points",
        summary: "Finds the places that can be tracked best: where even the weaker direction has much gradient.",
        source: "J. Shi and C. Tomasi, Good features to track, CVPR 1994",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "row", "step"],
        frames: 1,
    };

    fn settings(&self) -> Settings {
        self.settings
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
            Math::Bold("T"),
            Math::text(" − "),
            Math::root(Math::Row(vec![
                Math::squared(Math::Row(vec![Math::text("(½ tr "), Math::Bold("T"), Math::text(")")])),
                Math::text(" − det "),
                Math::Bold("T"),
            ])),
        ]);
        let half = (xx + yy) / 2.0;
        let numbers = Math::Row(vec![
            Math::text(" = "),
            Math::ink(Role::Reference, words::fine(half)),
            Math::text(" − "),
            Math::root(Math::Row(vec![
                Math::squared(Math::ink(Role::Reference, words::fine(half))),
                Math::text(" − "),
                Math::ink(Role::Reference, words::fine(xx * yy - xy * xy)),
            ])),
            Math::text(" = "),
            Math::ink(Role::Result, words::fine(self.response([xx, xy, yy]))),
        ]);
        [symbols, numbers]
    }
}
