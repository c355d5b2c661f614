//! Shi and Tomasi's good features to track.

use crate::methods::{
    differential::Tensor,
    features::{Measure, Settings, corner_pseudocode, unit_of_parts, value as features},
};
use crate::run::Info;
use crate::scene::{Case, Role, Step, Unit};
use crate::{cases, params, variables};

params! {
    /// Shi and Tomasi's corners: local maxima of R = λ₂, the smaller eigenvalue of the structure tensor T.
    pub struct ShiTomasi {
        /// Parameters that all corner detectors share.
        settings: Settings = Settings::default();
    }
}

/// λ₂ / λ₁ below which a pixel is called an edge.
const EDGE_RATIO: f32 = 0.1;

variables! {
    /// Half the trace of the structure tensor: the mean of its eigenvalues.
    HALF_TRACE: "", r"\text{½ tr }\mathbf{T}", Unit::RESPONSE, Role::Reference;
    /// The determinant of the structure tensor.
    DETERMINANT: "", r"\det \mathbf{T}", Unit::RESPONSE, Role::Reference;
}

cases! { over features;
    RESPONSE_IS: "R = λ₂ = {response}",
    IS_BELOW_TENTH: "R = λ₂ = {response}, less than a tenth of λ₁",
    IS_ABOVE_TENTH: "R = λ₂ = {response}, at least a tenth of λ₁",
}

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

    fn is_corner(&self, [large, small]: [f32; 2], _: f32) -> bool {
        small >= EDGE_RATIO * large
    }

    const MEANING: [&'static Case; 3] = [case::RESPONSE_IS, case::IS_BELOW_TENTH, case::IS_ABOVE_TENTH];

    fn formulas(&self, step: Step, tensor: [f32; 3]) -> Step {
        let [xx, xy, yy] = tensor;
        let parts = [(xx + yy) / 2.0, xx * yy - xy * xy];
        let root = |[half, det]: [f64; 2]| half - (half * half - det).max(0.0).sqrt();
        let unit = unit_of_parts(parts, self.response(tensor), root);
        let step = step.put_value(value::HALF_TRACE.is(parts[0]).in_unit(unit));
        let step = step.put_value(value::DETERMINANT.is(parts[1]).in_unit(unit));
        let step = step
            .formula(r"R = \lambda_2 = \text{½ tr }\mathbf{T} - \sqrt{(\text{½ tr }\mathbf{T})^2 - \det \mathbf{T}}");
        step.formula(r"= {half_trace} - \sqrt{{half_trace}^2 - {determinant}} = {response}")
    }
}
