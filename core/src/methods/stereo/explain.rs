//! What all estimators of disparity tell and draw.

use super::{Kept, Settings, Verdict, Views};
use crate::base::words::{fixed, grouped};
use crate::data::{Calibration, Disparity};
use crate::geometry::Grid;
use crate::products::disparity::disparity_error;
use crate::scene::{Link, Picture, Readout, Role, Scene, Sentence, Series, Shape};

/// A disparity as text, to a hundredth of a px.
fn px_of(disparity: f32) -> String {
    fixed(disparity.into(), 2)
}

/// A disparity as text with its unit.
pub(crate) fn disparity_px(disparity: f32) -> String {
    format!("{} px", px_of(disparity))
}

/// The depth of a disparity as text, if the cameras are calibrated and it is finite.
pub(crate) fn depth(calibration: Option<&Calibration>, disparity: f32) -> Option<String> {
    let depth = calibration?.depth_m(f64::from(disparity))?;
    Some(format!("{} m", fixed(depth, 2)))
}

/// The true disparity of a pixel, if it is known.
pub(crate) fn true_at(views: &Views, (x, y): (usize, usize)) -> Option<f32> {
    views.truth.as_ref()?.at(x, y)
}

/// The sentence before the first step.
pub(crate) fn starting(views: &Views, settings: &Settings) -> Sentence {
    let said = Sentence::default();
    let said = if views.is_stereo {
        said.text(
            "The views are rectified: the epipolar line of pixel (x, y) is row y of the right view, and its match lies d px further left. The \
             disparity d is inversely proportional to the depth, so near points have a large one.",
        )
    } else {
        said.text(
            "The clip has no right view, so frame t + 1 serves as one: the disparity is right for a camera that moves to the right between both \
             frames. Open a right view for stereo.",
        )
    };
    match views.signs(settings.disparities).warning().filter(|_| views.is_stereo) {
        Some(warning) => said.ink(Role::Error, format!(" The views are {warning}.")),
        None => said,
    }
}

/// The conclusion of a run whose final disparities and outcomes are `kept`.
pub(crate) fn concluded(views: &Views, settings: &Settings, kept: &[Kept]) -> String {
    let all = kept.len().max(1) as f64;
    let share = |verdict| 100.0 * kept.iter().filter(|kept| kept.verdict == verdict).count() as f64 / all;
    let [sound, ambiguous, inconsistent] =
        [Verdict::Accepted, Verdict::Ambiguous, Verdict::Inconsistent].map(|verdict| fixed(share(verdict), 1));
    let mut told = format!(
        " Of {} pixels, {sound} % pass all tests, {ambiguous} % are ambiguous and {inconsistent} % fail the left–right check.",
        grouped(kept.len())
    );
    if let Some(truth) = &views.truth {
        let (width, height) = views.size();
        let of = |is_kept: &dyn Fn(&Kept) -> bool| {
            let known = |kept: &Kept| if is_kept(kept) { kept.disparity } else { Disparity::UNKNOWN };
            Disparity(Grid::from_fn(width, height, |x, y| known(&kept[y * width + x])))
        };
        let map = of(&|_| true);
        if let Ok(Some(error)) = disparity_error(&map, truth) {
            told += &format!(
                " Against the truth, {} % are wrong by more than 3 px or have no disparity; the mean error of all estimates \
                 is {} px.",
                fixed(100.0 * error.bad3, 1),
                fixed(error.epe_px, 2)
            );
            if let Some(share) = error.bad3_with_partner.filter(|_| error.without_partner > 0) {
                told += &format!(
                    " {} pixels at the left border have no partner in the right view; without them {} % are wrong.",
                    grouped(error.without_partner),
                    fixed(100.0 * share, 1)
                );
            }
        }
        if let Ok(Some(error)) = disparity_error(&of(&|kept| kept.verdict == Verdict::Accepted), truth) {
            told += &format!(
                " Of the {} measured pixels with a known truth, {} % are wrong.",
                grouped(error.compared),
                fixed(100.0 * error.bad3_compared, 1)
            );
        }
    }
    if let Some(warning) = views.signs(settings.disparities).warning().filter(|_| views.is_stereo) {
        told += &format!(" The views are {warning}.");
    }
    told
}

/// Draws disparities in the colours of one scale over frame t.
pub(crate) fn draw_map(scene: &mut Scene, values: Grid<f32>, disparities: usize, meaning: &'static str) {
    scene.mark(Picture::CURRENT, Role::Result, Shape::Heat { origin: [0.0; 2], values });
    scene.legend(Role::Result, meaning);
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

    /// Why no match passes the tests: the end of the search, if the true match lies behind it, else the `usual` cause.
    pub fn cause(&self, usual: &str) -> String {
        let (last, name) = (self.last(), self.views.second_name());
        let is_cut = last + 1 < self.disparities;
        match true_at(self.views, self.pixel) {
            Some(truth) if truth > last as f32 + 0.5 => {
                let end = if is_cut {
                    format!("beside the {name}: its border ends the search at d = {last} px")
                } else {
                    format!("beyond the {} disparities searched", self.disparities)
                };
                format!("The true match, at d = {}, lies {end}.", disparity_px(truth))
            }
            None if is_cut => {
                format!(
                    "{usual} Otherwise the match lies beside the {name}, and the search ends at its border, at d = {last} px."
                )
            }
            _ => usual.to_owned(),
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
    scene.mark(Picture::CURRENT, Role::Reference, around(x));
    scene.legend(Role::Reference, "pixel and its window");
    let line = Shape::Path { points: vec![[x - pair.last() as f32 - 0.5, y], [x + 0.5, y]], closed: false };
    scene.mark(second, Role::Window, line);
    scene.legend(Role::Window, "epipolar line, as far as searched");
    let (role, meaning) = if is_kept { (Role::Best, "match") } else { (Role::Rejected, "rejected match") };
    scene.mark(second, role, around(x - best));
    scene.legend(role, meaning);
    scene.links.push(Link { role, ends: [(Picture::CURRENT, [x, y]), (second, [x - best, y])] });
    if let Some(truth) = true_at(pair.views, pair.pixel) {
        scene.mark(second, Role::Truth, Shape::Points(vec![[x - truth, y]]));
        scene.legend(Role::Truth, "true match");
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
            title: self.title,
            x_label: "disparity d (px)",
            y_label: self.y_label,
            x_max: self.pair.disparities - 1,
            lines,
            thresholds: self.thresholds,
            is_sweep: true,
            chosen: Some(self.best as f32),
            decimals: Some(0),
            ..Series::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::data::Frame;

    /// Why the pixel in a column has no disparity, of 16 disparities and with the true one, if it is known.
    fn cause(x: usize, truth: Option<f32>) -> String {
        let frame = || Arc::new(Frame::gray(Grid::new(40, 8, 90)));
        let truth = truth.map(|truth| Arc::new(Disparity(Grid::new(40, 8, truth))));
        let views = Views { left: frame(), right: frame(), is_stereo: true, calibration: None, truth };
        Pair { views: &views, pixel: (x, 4), reach: 1, disparities: 16 }.cause("Something hides it.")
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
