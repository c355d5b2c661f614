//! The parameters that a step is computed with, for paper: nothing beside the sheet tells them.

use motionscope_core::run::AnyEstimator;

use crate::view::rendering::said;

/// The parameters of an estimator that have an effect, with their values.
pub fn settings(estimator: &dyn AnyEstimator) -> String {
    let all = estimator.specs().iter().zip(estimator.values()).enumerate();
    let with_effect = all.filter(|(index, _)| estimator.idle(*index).is_none());
    let words: Vec<String> = with_effect.map(|(_, (spec, (_, value)))| said(spec, value)).collect();
    words.join(" · ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_parameters_with_an_effect_are_told_however_many_they_are() {
        let mut estimator = motionscope_core::course::estimator("kalman-filter").expect("an estimator");
        let told = settings(&*estimator);
        for name in ["measurement noise 2 px", "process noise 3", "gate 0.99", "initial speed 30"] {
            assert!(told.contains(name), "{name}: {told}");
        }
        assert!(!told.contains("mode switch") && !told.contains("default"), "{told}");
        estimator.set("motion", "imm").expect("a motion model");
        assert!(settings(&*estimator).contains("mode switch"), "modes make it matter");
    }
}
