//! Harris and Stephens' corner detector.

use crate::base::Threads;
use crate::geometry::{Gray, Grid};
use crate::methods::features::{Corners, Measure, Settings, corner_pseudocode, unit_of_parts, value as features};
use crate::run::Info;
use crate::scene::{Case, Role, Step, Unit};
use crate::{cases, params, variables};

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

variables! {
    /// The determinant of the structure tensor.
    DETERMINANT: "", r"\det \mathbf{T}", Unit::RESPONSE, Role::Reference;
    /// The trace of the structure tensor.
    TRACE: "", r"\text{tr }\mathbf{T}", Unit::RESPONSE, Role::Reference;
    /// The Harris constant.
    HARRIS_CONSTANT: "", "k", Unit::SET;
}

cases! { over features;
    RESPONSE_IS: "R = det T − k (tr T)² = {response}",
    IS_POSITIVE: "R = det T − k (tr T)² = {response} is positive",
    IS_NOT_POSITIVE: "R = det T − k (tr T)² = {response} is not positive",
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

    fn is_corner(&self, _: [f32; 2], response: f32) -> bool {
        response > 0.0
    }

    const MEANING: [&'static Case; 3] = [case::RESPONSE_IS, case::IS_NOT_POSITIVE, case::IS_POSITIVE];

    fn formulas(&self, step: Step, tensor: [f32; 3]) -> Step {
        let [xx, xy, yy] = tensor;
        let (parts, k) = ([xx * yy - xy * xy, xx + yy], f64::from(self.k));
        let unit = unit_of_parts(parts, self.response(tensor), |[det, trace]| det - k * trace * trace);
        let [determinant, trace] = [value::DETERMINANT, value::TRACE];
        let step = step.put(value::HARRIS_CONSTANT, self.k).put_value(determinant.is(parts[0]).in_unit(unit));
        let step = step.put_value(trace.is(parts[1]).in_unit(unit));
        let step = step.formula(r"R = \det \mathbf{T} - k\,(\text{tr }\mathbf{T})^2");
        step.formula(r"= {determinant} - {harris_constant} \cdot {trace}^2 = {response}")
    }
}
