//! Explanations and drawings shared by all disparity estimators.

use super::{Kept, Settings, Verdict, Views};
use crate::data::{Calibration, Disparity};
use crate::geometry::Grid;
use crate::products::disparity::disparity_error;
use crate::scene::{Case, Link, Name, Picture, Readout, Role, Scene, Series, Shape, Step, Unit};

/// A disparity in whole px.
pub(crate) const WHOLE_PX: Unit = Unit::new("px", 0);

crate::variables! { pub(crate) mod value;
    /// The inspected pixel.
    PIXEL: "Pixel", "p", Unit::WHOLE, Role::Reference;
    /// The lowest cost along the epipolar line.
    MINIMUM: "Minimum", r"C_{\min}", Unit::WHOLE, Role::Best;
    /// The disparity of lowest cost.
    BEST: "Disparity of the minimum", "d", WHOLE_PX, Role::Best;
    /// The lowest cost of all disparities but the best and its neighbours.
    RIVAL_COST: "Next minimum", "", Unit::WHOLE;
    /// The disparity of the next minimum.
    RIVAL: "Disparity of the next minimum", "", WHOLE_PX;
    /// The cost of the disparity below the best one.
    COST_BEFORE: "", "", Unit::WHOLE;
    /// The cost of the disparity above the best one.
    COST_AFTER: "", "", Unit::WHOLE;
    /// The disparity that the other view has at the match.
    BACK: "From the other view", "", WHOLE_PX;
    /// How much higher than the minimum the cost of a rival must be.
    UNIQUENESS: "Uniqueness", "", Unit::WHOLE_PERCENT;
    /// The disparity of the pixel.
    DISPARITY: "Disparity", "d", Unit::PX, Role::Result;
    /// The depth Z = f B / d of the pixel.
    DEPTH: "Depth", "Z", Unit::new("m", 2);
    /// The true disparity of the pixel.
    TRUE_DISPARITY: "True disparity", "", Unit::PX, Role::Truth;
    /// The picture that the left view is matched with.
    SECOND: "Second picture", "", Unit::WHOLE;
    /// The largest disparity with a match inside the second picture.
    LAST: "Last disparity", "", WHOLE_PX;
    /// The number of disparities searched.
    SEARCHED: "Disparities", "", Unit::count("disparity");
    /// The warning about the views.
    WARNING: "Views", "", Unit::WHOLE, Role::Error;
    /// The number of pixels of a view.
    PIXELS: "Pixels", "", Unit::count("pixel");
    /// The share of the pixels that pass all tests.
    ACCEPTED: "Measured", "", Unit::PERCENT;
    /// The share of the pixels without a unique match.
    AMBIGUOUS: "Ambiguous", "", Unit::PERCENT;
    /// The share of the pixels that fail the left–right check.
    INCONSISTENT: "Inconsistent", "", Unit::PERCENT;
    /// The share of the pixels that are wrong by more than 3 px or have no disparity.
    WRONG: "Wrong", "", Unit::PERCENT;
    /// The mean error of all estimates.
    MEAN_ERROR: "Mean error", "", Unit::PX;
    /// The number of pixels at the left border without a match in the other view.
    WITHOUT_PARTNER: "Without a match", "", Unit::count("pixel");
    /// The share of the other pixels that are wrong.
    WRONG_WITH_PARTNER: "Wrong, of those with a match", "", Unit::PERCENT;
    /// The number of measured pixels with a known truth.
    COMPARED: "Compared", "", Unit::count("pixel");
    /// The share of the measured pixels that are wrong.
    WRONG_MEASURED: "Wrong, of those measured", "", Unit::PERCENT;
}

crate::cases! { over value;
    STEREO: "The views are rectified: the epipolar line of pixel (x, y) is row y of the right view, and its match lies d px \
             further left. The disparity d is inversely proportional to the depth, so near points have a large one.",
    ONE_VIEW: "The clip has no right view, so frame t + 1 serves as one: the disparity is right for a camera that moves to the \
               right between both frames. Open a right view for stereo.",
    SWAPPED: "{error|The views are} {warning}{error|.}",
    OUTCOMES: "Of {pixels}, {accepted} pass all tests, {ambiguous} are ambiguous and {inconsistent} fail the left–right check.",
    ERRORS: "Against the truth, {wrong} are wrong by more than 3 px or have no disparity; the mean error of all estimates is \
             {mean_error}.",
    BORDER: "{without_partner} at the left border have no partner in the right view; without them {wrong_with_partner} are \
             wrong.",
    MEASURED: "Of the {compared:bare} measured pixels with a known truth, {wrong_measured} are wrong.",
    TRUTH_BESIDE: "The true match, at d = {true_disparity}, lies beside the {second}: its border ends the search at d = {last}.",
    TRUTH_BEYOND: "The true match, at d = {true_disparity}, lies beyond the {searched} searched.",
    PERHAPS_BESIDE: "Otherwise the match lies beside the {second}, and the search ends at its border, at d = {last}.",
}

/// The true disparity of a pixel, if it is known.
pub(crate) fn true_at(views: &Views, (x, y): (usize, usize)) -> Option<f32> {
    views.truth.as_ref()?.at(x, y)
}

/// Adds a disparity to the facts, and its depth if the cameras are calibrated.
pub(crate) fn put_depth(step: Step, calibration: Option<&Calibration>, disparity: f32) -> Step {
    let step = step.fact(value::DISPARITY, disparity);
    match calibration.and_then(|rig| rig.depth_m(f64::from(disparity))) {
        Some(depth) => step.fact(value::DEPTH, depth),
        None => step.fact(value::DEPTH, "unknown: it needs the focal length and the baseline of the cameras"),
    }
}

/// Tells the assumptions of stereo, before the first step.
pub(crate) fn starting(step: Step, views: &Views, settings: &Settings) -> Step {
    let said = if views.is_stereo { case::STEREO } else { case::ONE_VIEW };
    add_warning(step.say(said), views.warning(settings.disparities))
}

/// Adds the warning about the views, if there is one.
pub(crate) fn add_warning(step: Step, warning: Option<String>) -> Step {
    match warning {
        Some(warning) => step.put(value::WARNING, warning).say(case::SWAPPED),
        None => step,
    }
}

/// Adds the conclusion of a run whose final disparities and outcomes are `kept`.
pub(crate) fn conclude(step: Step, views: &Views, settings: &Settings, kept: &[Kept]) -> Step {
    let all = kept.len().max(1) as f64;
    let share = |verdict| 100.0 * kept.iter().filter(|kept| kept.verdict == verdict).count() as f64 / all;
    let mut step = step.put(value::PIXELS, kept.len()).put(value::ACCEPTED, share(Verdict::Accepted));
    step = step.put(value::AMBIGUOUS, share(Verdict::Ambiguous)).put(value::INCONSISTENT, share(Verdict::Inconsistent));
    step = step.say(case::OUTCOMES);
    if let Some(truth) = &views.truth {
        let (width, height) = views.size();
        let of = |is_kept: &dyn Fn(&Kept) -> bool| {
            let known = |kept: &Kept| if is_kept(kept) { kept.disparity } else { Disparity::UNKNOWN };
            Disparity(Grid::from_fn(width, height, |x, y| known(&kept[y * width + x])))
        };
        if let Ok(Some(error)) = disparity_error(&of(&|_| true), truth) {
            step = step.put(value::WRONG, 100.0 * error.bad3).put(value::MEAN_ERROR, error.epe_px).say(case::ERRORS);
            if let Some(share) = error.bad3_with_partner.filter(|_| error.without_partner > 0) {
                step = step.put(value::WITHOUT_PARTNER, error.without_partner);
                step = step.put(value::WRONG_WITH_PARTNER, 100.0 * share).say(case::BORDER);
            }
        }
        if let Ok(Some(error)) = disparity_error(&of(&|kept| kept.verdict == Verdict::Accepted), truth) {
            step = step.put(value::COMPARED, error.compared).put(value::WRONG_MEASURED, 100.0 * error.bad3_compared);
            step = step.say(case::MEASURED);
        }
    }
    add_warning(step, views.warning(settings.disparities))
}

/// Draws disparities in the colours of one scale over frame t.
pub(crate) fn draw_map(scene: &mut Scene, values: Grid<f32>, disparities: usize, meaning: &'static str) {
    scene.draw(Picture::CURRENT, (Role::Result, meaning), Shape::heat(values));
    scene.heat = Some("disparity (px)");
    scene.heat_scale = Some([0.0, (disparities - 1) as f32]);
}

/// A pixel of the left view with its window.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'a> {
    pub views: &'a Views,
    pub pixel: (usize, usize),
    /// Half a side of the window in px.
    pub reach: usize,
    pub disparities: usize,
}

impl Pair<'_> {
    /// The largest disparity with a match inside the right view.
    pub fn last(&self) -> usize {
        self.pixel.0.min(self.disparities - 1)
    }

    /// A step about the pixel, with its true disparity where that is known.
    pub fn step(&self, line: Name) -> Step {
        let step = Step::at(line).fact(value::PIXEL, self.pixel);
        step.fact_if(value::TRUE_DISPARITY, true_at(self.views, self.pixel))
            .put(value::SECOND, self.views.second_name())
    }

    /// Tells why no match passes the tests: the end of the search, if the true match lies behind it, else the `usual` cause.
    pub fn cause(&self, step: Step, usual: &'static Case) -> Step {
        let last = self.last();
        let is_cut = last + 1 < self.disparities;
        let step = step.put(value::LAST, last).put(value::SEARCHED, self.disparities);
        match true_at(self.views, self.pixel) {
            Some(truth) if truth > last as f32 + 0.5 => {
                step.say(if is_cut { case::TRUTH_BESIDE } else { case::TRUTH_BEYOND })
            }
            truth => step.say(usual).say_if(truth.is_none() && is_cut, case::PERHAPS_BESIDE),
        }
    }
}

/// Draws the pixel, its epipolar line, the best match and the true one.
pub(crate) fn draw_match(scene: &mut Scene, pair: &Pair<'_>, best: f32, is_kept: bool) {
    let (x, y) = (pair.pixel.0 as f32, pair.pixel.1 as f32);
    let around = |x: f32| {
        let half = pair.reach as f32 + 0.5;
        Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] }
    };
    let second = pair.views.second();
    scene.draw(Picture::CURRENT, (Role::Reference, "pixel and its window"), around(x));
    let line = Shape::line(vec![[x - pair.last() as f32 - 0.5, y], [x + 0.5, y]]);
    scene.draw(second, (Role::Window, "epipolar line, as far as searched"), line);
    let (role, meaning) = if is_kept { (Role::Best, "match") } else { (Role::Rejected, "rejected match") };
    scene.draw(second, (role, meaning), around(x - best));
    scene.links.push(Link { role, ends: [(Picture::CURRENT, [x, y]), (second, [x - best, y])] });
    if let Some(truth) = true_at(pair.views, pair.pixel) {
        scene.draw(second, (Role::Truth, "true match"), Shape::Points(vec![[x - truth, y]]));
    }
}

/// A cost along an epipolar line.
pub(crate) struct Curve<'a> {
    pub title: &'static str,
    pub y_label: &'static str,
    /// Its lines: name, role, and the cost of each disparity.
    pub lines: Vec<(&'static str, Role, Vec<f32>)>,
    /// The disparity of the minimum of the last line.
    pub best: usize,
    pub thresholds: Vec<(String, f32)>,
    pub pair: Pair<'a>,
}

impl Curve<'_> {
    /// The plot, with the minimum and the true disparity.
    pub fn readout(self) -> Readout {
        let points = |costs: &[f32]| costs.iter().enumerate().map(|(d, cost)| [d as f32, *cost]).collect::<Vec<_>>();
        let last = self.lines.last().map(|(.., costs)| costs.clone()).unwrap_or_default();
        let mut lines: Vec<_> = self.lines.iter().map(|(name, role, costs)| (*name, *role, points(costs))).collect();
        let at = |d: usize| last.get(d).map(|cost| [d as f32, *cost]);
        lines.extend(at(self.best).map(|minimum| ("minimum", Role::Best, vec![minimum])));
        let truth = true_at(self.pair.views, self.pair.pixel).filter(|truth| *truth >= 0.0);
        let on_curve = truth.and_then(|truth| at(truth.round() as usize).map(|[_, cost]| [truth, cost]));
        lines.extend(on_curve.map(|truth| ("cost at the true disparity", Role::Truth, vec![truth])));
        Readout::Series(Series {
            thresholds: self.thresholds,
            is_sweep: true,
            chosen: Some(self.best as f32),
            decimals: Some(0),
            ..Series::new(self.title, ["disparity d (px)", self.y_label], self.pair.disparities - 1, lines)
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::data::Frame;

    crate::line_names!(END);

    mod hidden {
        crate::cases! { pub(super) HIDDEN: "Something hides it." }
    }

    /// Why the pixel in a column has no disparity, of 16 disparities and with the true one, if it is known.
    fn cause(x: usize, truth: Option<f32>) -> String {
        let frame = || Arc::new(Frame::gray(Grid::new(40, 8, 90)));
        let truth = truth.map(|truth| Arc::new(Disparity(Grid::new(40, 8, truth))));
        let views = Views { left: frame(), right: frame(), is_stereo: true, calibration: None, truth };
        let pair = Pair { views: &views, pixel: (x, 4), reach: 1, disparities: 16 };
        pair.cause(pair.step(END), hidden::case::HIDDEN).sentence.plain()
    }

    #[test]
    fn a_match_behind_the_end_of_the_search_is_the_cause() {
        let beside =
            "The true match, at d = 9.20 px, lies beside the right view: its border ends the search at d = 5 px.";
        assert_eq!(cause(5, Some(9.2)), beside);
        let beyond = "The true match, at d = 20.00 px, lies beyond the 16 disparities searched.";
        assert_eq!(cause(30, Some(20.0)), beyond);
        for inside in [cause(5, Some(5.4)), cause(30, Some(9.2)), cause(15, None), cause(30, None)] {
            assert_eq!(inside, "Something hides it.");
        }
        let unknown = "Something hides it. Otherwise the match lies beside the right view, and the search ends at its border, at \
             d = 5 px.";
        assert_eq!(cause(5, None), unknown);
        assert_eq!(cause(5, Some(Disparity::UNKNOWN)), unknown, "a pixel without a truth");
    }
}
