//! Shi and Tomasi's good features to track.

use crate::methods::{
    differential::{Tensor, numbers},
    features::{Measure, Settings, corner_pseudocode},
};
use crate::params;
use crate::run::Info;
use crate::scene::{Math, Role};

params! {
    /// Shi and Tomasi's corners: local maxima of R = λ₂, the smaller eigenvalue of the structure tensor T.
    pub struct ShiTomasi {
        /// Parameters that all corner detectors share.
        settings: Settings = Settings::default();
    }
}

/// λ₂ / λ₁ below which a pixel is called an edge.
const EDGE_RATIO: f32 = 0.1;

corner_pseudocode!("  R ← λ₂, the smaller eigenvalue of T");

impl Measure for ShiTomasi {
    const INFO: Info = Info {
        id: "shi-tomasi",
        name: "Shi–Tomasi corners",
        family: "Interest points",
        summary: "Corner detection by the smaller eigenvalue of the structure tensor, which measures how well a window can be tracked.",
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

    const SHOWN: &'static str = "√R";

    fn shown(response: f32) -> f32 {
        response.sqrt()
    }

    fn equation(&self, tensor: &Tensor) -> [Math; 2] {
        let Tensor { xx, xy, yy, .. } = *tensor;
        let symbols = Math::Row(vec![
            Math::Var("R"),
            Math::text(" = "),
            Math::indexed(Math::Var("λ"), Math::text("2")),
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
            Math::ink(Role::Reference, numbers::response(half)),
            Math::text(" − "),
            Math::root(Math::Row(vec![
                Math::squared(Math::ink(Role::Reference, numbers::base(half))),
                Math::text(" − "),
                Math::ink(Role::Reference, numbers::base(xx * yy - xy * xy)),
            ])),
            Math::text(" = "),
            Math::ink(Role::Result, numbers::response(self.response([xx, xy, yy]))),
        ]);
        [symbols, numbers]
    }

    fn meaning(&self, [large, small]: [f32; 2], response: f32, flat: f32) -> String {
        let value = format!("R = λ₂ = {}", numbers::response(response));
        match () {
            () if large < flat => {
                format!("{value}: λ₁ is below {}, as noise alone can cause: a flat area.", numbers::response(flat))
            }
            () if small < EDGE_RATIO * large => {
                format!("{value}, less than a tenth of λ₁: gradients in one direction only, an edge.")
            }
            () => format!("{value}, at least a tenth of λ₁: gradients in two directions, possibly a corner."),
        }
    }
}
