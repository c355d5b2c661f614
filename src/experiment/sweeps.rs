//! The sweeps of a comparison: every numeric parameter of the estimators or slider of the clip, over values around its default.

use motionscope_core::data::Clip;
use motionscope_core::params::{Kind, Params, Spec, Value};
use motionscope_core::run::AnyEstimator;

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

/// What a clip allows: a run has no more frames than there are, and no length in it is larger than the picture.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Number of frames from frame t on, if known.
    frames: Option<usize>,
    /// The longer side of the picture in px.
    side_px: usize,
}

impl Limits {
    /// The limits of a run on `clip` from `frame` on.
    pub fn of(clip: &Clip, frame: usize) -> Self {
        let (width, height) = clip.size();
        Self { frames: clip.info().frames.map(|all| all.saturating_sub(frame).max(2)), side_px: width.max(height) }
    }

    /// The largest sensible value of a parameter.
    fn most(&self, spec: &Spec) -> f64 {
        match spec.unit {
            _ if spec.counts_frames() => self.frames.map_or(f64::INFINITY, |frames| frames as f64),
            "px" => self.side_px as f64,
            _ => f64::INFINITY,
        }
    }
}

/// Returns the sweeps of `estimators`: each numeric parameter whose values all estimators that have it accept. Parameters of the same name
/// with different units are swept apart, by `ESTIMATOR.NAME`.
pub fn of_estimators(estimators: &[Box<dyn AnyEstimator>], limits: Option<Limits>) -> Vec<Sweep> {
    let mut names: Vec<&str> = Vec::new();
    for spec in estimators.iter().flat_map(|estimator| estimator.specs()) {
        if !names.contains(&spec.name.as_str()) {
            names.push(&spec.name);
        }
    }
    names.into_iter().flat_map(|name| of_name(name, estimators, limits)).collect()
}

/// Returns the sweeps of the parameter `name` of `estimators`.
fn of_name(name: &str, estimators: &[Box<dyn AnyEstimator>], limits: Option<Limits>) -> Vec<Sweep> {
    let own = |estimator: &dyn AnyEstimator| estimator.specs().iter().find(|spec| spec.name == name);
    let having: Vec<_> = estimators.iter().filter_map(|one| Some((&**one, own(&**one)?))).collect();
    let Some(&(_, first)) = having.first() else { return Vec::new() };
    let takes = |estimator: &dyn AnyEstimator, text: &str| estimator.boxed_clone().set(name, text).is_ok();
    if having.iter().all(|(_, spec)| spec.unit == first.unit) {
        // A default of 0 often stands for an automatic value; another estimator may have one that tells the scale.
        let is_positive =
            |spec: &&Spec| matches!(spec.default, Value::Int(1..)) || matches!(spec.default, Value::Real(v) if v > 0.0);
        let spec = having.iter().map(|(_, spec)| *spec).find(is_positive).unwrap_or(first);
        return sweep(spec, limits, |text| having.iter().all(|(one, _)| takes(*one, text))).into_iter().collect();
    }
    let apart = having.iter().filter_map(|(one, spec)| {
        let Sweep { setting, title, axis } = sweep(spec, limits, |text| takes(*one, text))?;
        let info = one.info();
        Some(Sweep { setting: format!("{}.{setting}", info.id), title: format!("{} of {}", title, info.name), axis })
    });
    apart.collect()
}

/// Returns the sweeps of a synthetic clip with these sliders.
pub fn of_sliders<P: Params + Clone>(sliders: &P) -> Vec<Sweep> {
    let takes = |name: &str, text: &str| sliders.clone().set(name, text).is_ok();
    sliders.specs().iter().filter_map(|spec| sweep(spec, None, |text| takes(&spec.name, text))).collect()
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

fn sweep(spec: &'static Spec, limits: Option<Limits>, takes: impl Fn(&str) -> bool) -> Option<Sweep> {
    let mut all = Scale::of(spec, limits)?.texts();
    all.retain(|text| takes(text));
    let [first, .., last] = &all[..] else { return None };
    let unit = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    let [first, last] = [first, last].map(|text| text.replace('-', "−"));
    Some(Sweep {
        setting: format!("{}={}", spec.name, all.join(",")),
        title: format!("{}: {first} to {last}{unit}", spec.label),
        axis: &spec.label,
    })
}

/// The range of a parameter within the limits of a clip, and its default.
#[derive(Clone, Copy)]
struct Scale {
    min: f64,
    max: f64,
    usual: f64,
    is_whole: bool,
    has_unit: bool,
}

/// Factors of the default, for a quantity that is multiplied rather than added to.
const AROUND: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Factors of a default that is the smallest value, and of one that is the largest.
const FROM_END: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
/// Shares of the largest value where the default is 0: off, or automatic.
const FROM_ZERO: [f64; 6] = [0.0, 0.03125, 0.0625, 0.125, 0.25, 0.5];
/// Shares of the largest value where values may be negative and the default is 0.
const SIGNED: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
/// Steps from the default, each half as long as the way to the largest value.
const STEPS: [f64; 6] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0];
/// The largest number of values that are swept one by one.
const MOST: f64 = 8.0;

impl Scale {
    fn of(spec: &Spec, limits: Option<Limits>) -> Option<Self> {
        let (min, max, usual, is_whole) = match (&spec.kind, &spec.default) {
            (Kind::Int { min, max }, Value::Int(usual)) => (*min as f64, *max as f64, *usual as f64, true),
            (Kind::Real { min, max }, Value::Real(usual)) => (*min, *max, *usual, false),
            _ => return None,
        };
        let max = max.min(limits.map_or(f64::INFINITY, |limits| limits.most(spec))).max(min);
        Some(Self { min, max, usual: usual.min(max), is_whole, has_unit: !spec.unit.is_empty() })
    }

    /// The values in ascending order, as they are written.
    fn texts(&self) -> Vec<String> {
        let (values, step) = self.values();
        let mut texts: Vec<_> = values.into_iter().map(|value| self.written(value, step)).collect();
        texts.dedup();
        texts
    }

    /// The values in ascending order, and the step between them where it is always the same.
    fn values(&self) -> (Vec<f64>, Option<f64>) {
        let Self { min, max, usual, .. } = *self;
        let times = |factors: &[f64], of: f64| factors.iter().map(|factor| factor * of).collect();
        if let Some(top) = self.counted() {
            return ((0..=(top - min) as usize).map(|i| min + i as f64).collect(), Some(1.0));
        }
        let values = match usual {
            0.0 if min < 0.0 => times(&SIGNED, max),
            0.0 => times(&FROM_ZERO, max),
            _ if usual <= min => times(&FROM_END, usual),
            _ if usual >= max => FROM_END.iter().rev().map(|factor| usual / factor).collect(),
            // A share, or another quantity that is near its end.
            _ if max <= 2.0 * usual => {
                let step = rounded(0.5 * (max - usual), 0.5 * (max - usual));
                return (STEPS.iter().map(|steps| usual + steps * step).collect(), Some(step));
            }
            _ => times(&AROUND, usual),
        };
        (values, None)
    }

    /// The last value of a parameter of which few are swept one by one: levels, warps.
    fn counted(&self) -> Option<f64> {
        let Self { min, max, usual, .. } = *self;
        let top = (2.0 * usual).max(min + 3.0).min(max);
        // The smallest length, 0 for one that is chosen automatically, and such are no numbers of things.
        let is_scale = usual <= min && (self.has_unit || usual == 0.0);
        let is_few = max < min + MOST;
        self.is_whole.then_some(if is_few { max } else { top }).filter(|top| is_few || *top < min + MOST && !is_scale)
    }

    /// A value within the range as it is written: the default exactly, others to two significant digits, of the step if there is one.
    fn written(&self, value: f64, step: Option<f64>) -> String {
        if value == self.usual {
            return value.to_string();
        }
        let digits = if self.is_whole { value.round() } else { rounded(value, step.unwrap_or(value)) };
        digits.clamp(self.min, self.max).to_string()
    }
}

/// To two significant digits of `scale`.
fn rounded(value: f64, scale: f64) -> f64 {
    if scale == 0.0 {
        return 0.0;
    }
    let unit = 10f64.powf(scale.abs().log10().floor() - 1.0);
    // Written as decimal digits, so that a tenth stays a tenth.
    format!("{:.6}", (value / unit).round() * unit).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::course::{estimator, estimators};
    use motionscope_core::synth::Difficulty;

    /// The names and numbers of sweeps.
    fn numbers(sweep: &Sweep) -> (&str, Vec<f64>) {
        let (name, values) = sweep.setting.split_once('=').expect("NAME=VALUES");
        (name, values.split(',').map(|value| value.parse().expect("a number")).collect())
    }

    #[test]
    fn every_sweep_goes_around_the_default_within_the_range_and_the_clip() {
        let short = Limits { frames: Some(24), side_px: 320 };
        let mut swept = 0;
        for own in estimators() {
            for limits in [None, Some(short)] {
                for sweep in of_estimators(&[own.boxed_clone()], limits) {
                    let (name, values) = numbers(&sweep);
                    let what = format!("{}: {}", own.info().id, sweep.setting);
                    let spec = own.specs().iter().find(|spec| spec.name == name).expect("a parameter");
                    assert!((2..=9).contains(&values.len()), "{what}");
                    assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{what}");
                    let most = limits.map_or(f64::INFINITY, |limits| limits.most(spec));
                    assert!(values.iter().all(|value| *value <= most), "{what}");
                    let usual = match spec.default {
                        Value::Int(usual) => usual as f64,
                        Value::Real(usual) => usual,
                        _ => unreachable!("it is numeric"),
                    };
                    assert!(values.contains(&usual.min(most)), "{what}: without the default {usual}");
                    for value in sweep.setting[name.len() + 1..].split(',') {
                        own.boxed_clone().set(name, value).expect("it is in range");
                    }
                    swept += 1;
                }
            }
        }
        assert!(swept > 200, "{swept} sweeps");
    }

    #[test]
    fn the_scale_is_that_of_the_parameter() {
        let setting = |id: &str, name: &str, limits| {
            let all = of_estimators(&[estimator(id).expect("it exists")], limits);
            all.into_iter().find(|sweep| sweep.name() == name).map_or_else(String::new, |sweep| sweep.setting)
        };
        let short = Some(Limits { frames: Some(24), side_px: 320 });
        for (id, wanted) in [
            ("frame-difference", "threshold=0,8,16,32,64,128"),
            ("frame-difference", "min-area=0,10,20,40,80,160"),
            ("mixture-of-gaussians", "frames=2,3,6,12,24"),
            ("mixture-of-gaussians", "background-ratio=0.75,0.8,0.85,0.9,0.95,1"),
            ("running-average", "learning-rate=0.005,0.01,0.02,0.04,0.08"),
            ("horn-schunck", "levels=1,2,3,4,5,6,7,8"),
            ("kalman-filter", "gate=0.975,0.98,0.985,0.99,0.995,0.9999"),
        ] {
            let name = wanted.split_once('=').expect("NAME=VALUES").0;
            assert_eq!(setting(id, name, short), wanted, "{id}");
        }
    }

    #[test]
    fn what_several_share_is_swept_once() {
        let pair = [estimator("full-search").expect("it exists"), estimator("diamond").expect("it exists")];
        let all = of_estimators(&pair, None);
        assert_eq!(all.iter().filter(|sweep| sweep.name() == "search-range").count(), 1);
        let range = all.iter().find(|sweep| sweep.name() == "search-range").expect("both have a range");
        assert_eq!((range.setting.as_str(), range.axis), ("search-range=4,8,16,32,64", "Search range"));
    }

    #[test]
    fn thresholds_of_different_units_are_swept_apart() {
        let of = |ids: [&str; 2]| of_estimators(&ids.map(|id| estimator(id).expect("it exists")), None);
        let thresholds = |all: Vec<Sweep>| -> Vec<String> {
            let is_it = |sweep: &Sweep| {
                ["threshold", "mixture-of-gaussians.threshold", "running-average.threshold"].contains(&sweep.name())
            };
            all.into_iter().filter(is_it).map(|sweep| sweep.setting).collect()
        };
        assert_eq!(
            thresholds(of(["mixture-of-gaussians", "running-average"])),
            ["mixture-of-gaussians.threshold=1,2,4,8,16", "running-average.threshold=6.3,13,25,50,100"]
                .map(str::to_owned)
        );
        // Where 0 stands for an automatic value, the other one tells the scale.
        assert_eq!(thresholds(of(["frame-difference", "median-background"])), ["threshold=6,13,25,50,100"]);
    }

    #[test]
    fn a_slider_that_is_usually_0_has_its_scale() {
        let all = of_sliders(&Difficulty::default());
        let title = |name: &str| all.iter().find(|sweep| sweep.name() == name).map(|sweep| sweep.title.as_str());
        assert_eq!(title("noise"), Some("Noise: 0 to 25 levels"));
        assert_eq!(title("gain"), Some("Gain: −10 to 10 %/frame"));
    }
}
