//! The sweeps of a comparison: every numeric parameter of the estimators or slider of the clip, over values around its default.

use motionscope_core::params::Kind;
use motionscope_core::{AnyEstimator, Params, Spec, Value};

/// A parameter and the values it takes in a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// What is set, and to what: `search-range=4,8,16`.
    pub setting: String,
    /// The same for a person: `Search range: 4 to 16 px`.
    pub title: String,
    /// The label of the plot's x axis.
    pub axis: &'static str,
}

/// Factors of the default.
const AROUND: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Fractions of the range, used where the default is 0 or too close to an end.
const ACROSS: [f64; 5] = [0.0, 0.125, 0.25, 0.5, 1.0];
/// The smallest number of values of a sweep.
const FEWEST: usize = 4;
/// The largest number of values that are swept one by one.
const MOST: f64 = 8.0;

/// Returns the sweeps of `estimators`: each numeric parameter whose values all estimators that have it accept.
pub fn of_estimators(estimators: &[Box<dyn AnyEstimator>]) -> Vec<Sweep> {
    let mut all: Vec<Sweep> = Vec::new();
    for spec in estimators.iter().flat_map(|estimator| estimator.specs()) {
        let takes = |text: &str| {
            let mut having = estimators.iter().filter(|estimator| estimator.get(&spec.name).is_ok());
            having.all(|estimator| estimator.boxed_clone().set(&spec.name, text).is_ok())
        };
        let is_new = all.iter().all(|sweep| sweep.name() != spec.name);
        all.extend(is_new.then(|| sweep(spec, takes)).flatten());
    }
    all
}

/// Returns the sweeps of a synthetic clip with these sliders.
pub fn of_sliders<P: Params + Clone>(sliders: &P) -> Vec<Sweep> {
    let takes = |name: &str, text: &str| sliders.clone().set(name, text).is_ok();
    sliders.specs().iter().filter_map(|spec| sweep(spec, |text| takes(&spec.name, text))).collect()
}

impl Sweep {
    /// The name of the parameter.
    pub fn name(&self) -> &str {
        self.setting.split_once('=').map_or(&self.setting, |(name, _)| name)
    }
}

/// Returns the label of the parameter `name` of `estimators`, or of the slider of a clip.
pub fn label(name: &str, estimators: &[Box<dyn AnyEstimator>], sliders: Option<&impl Params>) -> Option<&'static str> {
    let own = |estimator: &dyn AnyEstimator| {
        let name = name.strip_prefix(estimator.info().id).and_then(|rest| rest.strip_prefix('.')).unwrap_or(name);
        estimator.specs().iter().find(|spec| spec.name == name).map(|spec| &*spec.label)
    };
    let of_clip = || sliders?.specs().iter().find(|spec| spec.name == name).map(|spec| &*spec.label);
    estimators.iter().find_map(|estimator| own(&**estimator)).or_else(of_clip)
}

fn sweep(spec: &'static Spec, takes: impl Fn(&str) -> bool) -> Option<Sweep> {
    let (min, max, usual, is_whole) = match (&spec.kind, &spec.default) {
        (Kind::Int { min, max }, Value::Int(usual)) => (*min as f64, *max as f64, *usual as f64, true),
        (Kind::Real { min, max }, Value::Real(usual)) => (*min, *max, *usual, false),
        _ => return None,
    };
    let written = |value: f64| if is_whole { format!("{}", value.round()) } else { format!("{}", rounded(value)) };
    let values = |all: Vec<f64>| -> Vec<String> {
        let mut texts: Vec<_> = all.into_iter().map(|value| written(value.clamp(min, max))).collect();
        texts.dedup();
        texts.retain(|text| takes(text));
        texts
    };
    let around = values(AROUND.iter().map(|share| usual * share).collect());
    let top = (2.0 * usual).max(min + 3.0).min(max);
    let is_counted = is_whole && top < min + MOST;
    let is_geometric = !is_counted && usual > 0.0 && around.len() >= FEWEST;
    let all = match (is_counted, is_geometric) {
        // A few: levels, warps.
        (true, _) => values((0..=(top - min) as usize).map(|i| min + i as f64).collect()),
        (false, true) => around,
        (false, false) => values(ACROSS.iter().map(|share| min + (max - min) * share).collect()),
    };
    let [first, .., last] = &all[..] else { return None };
    let unit = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    Some(Sweep {
        setting: format!("{}={}", spec.name, all.join(",")),
        title: format!("{}: {first} to {last}{unit}", spec.label),
        axis: &spec.label,
    })
}

/// To two significant digits.
fn rounded(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let unit = 10f64.powf(value.abs().log10().floor() - 1.0);
    // Written as decimal digits, so that a tenth stays a tenth.
    format!("{:.6}", (value / unit).round() * unit).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::synth::Difficulty;
    use motionscope_core::{estimator, estimators};

    #[test]
    fn every_value_of_every_sweep_is_taken() {
        let mut swept = 0;
        for own in estimators() {
            for sweep in of_estimators(&[own.boxed_clone()]) {
                let (name, values) = sweep.setting.split_once('=').expect("NAME=VALUES");
                let values: Vec<_> = values.split(',').collect();
                assert!(values.len() >= 2, "{}: {}", own.info().id, sweep.setting);
                for value in values {
                    own.boxed_clone().set(name, value).expect("it is in range");
                }
                swept += 1;
            }
        }
        assert!(swept > 100, "{swept} sweeps");
    }

    #[test]
    fn what_several_share_is_swept_once() {
        let pair = [estimator("full-search").expect("it exists"), estimator("diamond").expect("it exists")];
        let all = of_estimators(&pair);
        assert_eq!(all.iter().filter(|sweep| sweep.name() == "search-range").count(), 1);
        let range = all.iter().find(|sweep| sweep.name() == "search-range").expect("both have a range");
        assert_eq!((range.setting.as_str(), range.axis), ("search-range=4,8,16,32,64", "Search range"));
    }

    #[test]
    fn a_slider_that_is_usually_0_goes_across_its_range() {
        let all = of_sliders(&Difficulty::default());
        let noise = all.iter().find(|sweep| sweep.name() == "noise").expect("it has noise");
        assert_eq!(noise.title, "Noise: 0 to 50 levels");
    }
}
