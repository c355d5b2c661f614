//! What block stereo tells and draws.

use super::{BlockStereo, Cost, Desk, Event, Fixed, line};
use crate::base::words;
use crate::data::Disparity;
use crate::geometry::{Border, Grid};
use crate::methods::stereo::{
    Curve, Kept, Pair, Verdict, concluded, depth, disparity_px, draw_map, draw_match, smallest, starting, true_at,
};
use crate::run::Seen;
use crate::scene::{Fact, Math, Readout, Role, Scene, Sentence, Step, Tile};

/// The pixel that a step explains.
struct Shown<'a> {
    fixed: &'a Fixed,
    pixel: (usize, usize),
    event: Event,
    /// Its costs, without those of matches beside the right view.
    costs: Vec<u32>,
}

impl BlockStereo {
    /// The pixel pointed at, else the current one; `None` before the first.
    fn shown<'a>(&self, seen: &'a Seen<Self>) -> Option<Shown<'a>> {
        let last = seen.events.len().checked_sub(1)?;
        let fixed = &*seen.before.fixed;
        let pointed_at = seen.point().and_then(|point| fixed.views.left.luma().cell_at(point));
        let (x, y) = pointed_at.unwrap_or((last, seen.before.y()));
        let (width, mut desk, mut events) = (seen.before.width(), Desk::default(), Vec::new());
        let mut row = vec![Kept { disparity: Disparity::UNKNOWN, verdict: Verdict::Accepted }; width];
        self.row(fixed, (y, &mut row), &mut desk, &mut events);
        let costs = (0..=x.min(self.settings.disparities - 1)).map(|d| desk.costs[d * width + x]).collect();
        Some(Shown { fixed, pixel: (x, y), event: *events.get(x)?, costs })
    }

    fn pair<'a>(&self, shown: &Shown<'a>) -> Pair<'a> {
        let Shown { fixed, pixel, .. } = *shown;
        Pair { views: &fixed.views, pixel, reach: self.window, disparities: self.settings.disparities }
    }

    fn cost_name(&self) -> &'static str {
        match self.cost {
            Cost::Sad => "SAD",
            Cost::Census => "Hamming distance",
        }
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let Some(shown) = self.shown(seen) else {
            let sentence = starting(&seen.before.fixed.views, &self.settings);
            return Step { line: line::TAKE_VIEWS, sentence, readouts: Vec::new() };
        };
        let line = match shown.event.kept.verdict {
            Verdict::Ambiguous => line::REJECT_AMBIGUOUS,
            Verdict::Inconsistent => line::REJECT_INCONSISTENT,
            Verdict::Accepted => line::REFINE,
        };
        let mut sentence = self.sentence(&shown);
        if let (Some(after), None) = (seen.after.filter(|after| after.y() == after.fixed.views.size().1), seen.point())
        {
            sentence = sentence.text(concluded(&after.fixed.views, &self.settings, &after.kept));
        }
        Step { line, sentence, readouts: self.readouts(&shown) }
    }

    fn sentence(&self, shown: &Shown) -> Sentence {
        let Event { kept, best, back } = shown.event;
        let minimum = smallest(&shown.costs);
        let said = Sentence::default()
            .ink(Role::Reference, format!("Pixel {}", words::pixel(shown.pixel)))
            .text(format!(": the minimum along the epipolar line, {} ", self.cost_name()))
            .ink(Role::Best, format!("{} at d = {best}", words::cost(minimum.cost.into())));
        match (kept.verdict, minimum.rival) {
            (Verdict::Ambiguous, Some((at, cost))) => said.text(format!(
                ", has a rival: {} at d = {at}, less than {} % higher, so the match is ambiguous and the pixel gets no disparity. {}",
                words::cost(cost.into()),
                self.settings.uniqueness,
                self.pair(shown).cause("There is too little texture, or one that repeats.")
            )),
            (Verdict::Inconsistent, _) => said.text(format!(
                ", fails the left–right check: from the matched pixel of the {}, the minimum is at d = {back}. {}",
                shown.fixed.views.second_name(),
                self.pair(shown).cause("Probably the pixel is half-occluded, hidden there by something nearer.")
            )),
            _ => {
                let said = said.text(", is unique and confirmed by the left–right check. The disparity is ");
                let said = said.ink(Role::Result, disparity_px(kept.disparity));
                match depth(shown.fixed.views.calibration.as_ref(), kept.disparity) {
                    Some(depth) => said.text(format!(", which is a depth Z = f B / d of {depth}.")),
                    None => said.text("."),
                }
            }
        }
    }

    fn readouts(&self, shown: &Shown) -> Vec<Readout> {
        let Event { kept, best, back } = shown.event;
        let (pair, minimum, views) = (self.pair(shown), smallest(&shown.costs), &shown.fixed.views);
        let cost = |cost: u32| words::cost(cost.into());
        let mut facts = vec![
            Fact::new("Pixel", words::pixel(shown.pixel), Some(Role::Reference)),
            Fact::new("Minimum", format!("{} at d = {best}", cost(minimum.cost)), Some(Role::Best)),
        ];
        facts.extend(
            minimum.rival.map(|(at, rival)| Fact::new("Next minimum", format!("{} at d = {at}", cost(rival)), None)),
        );
        facts.push(Fact::new("From the other view", format!("d = {back}"), None));
        if kept.disparity.is_finite() {
            facts.push(Fact::new("Disparity", disparity_px(kept.disparity), Some(Role::Result)));
            facts.push(match depth(views.calibration.as_ref(), kept.disparity) {
                Some(depth) => Fact::new("Depth", depth, None),
                None => Fact::new("Depth", "unknown: it needs the focal length and the baseline of the cameras", None),
            });
        }
        facts.extend(
            true_at(views, shown.pixel)
                .map(|truth| Fact::new("True disparity", disparity_px(truth), Some(Role::Truth))),
        );
        let limit = f64::from(minimum.cost) * (1.0 + self.settings.uniqueness as f64 / 100.0);
        let uniqueness = (self.settings.uniqueness > 0).then(|| ("uniqueness".to_owned(), limit as f32));
        let curve = Curve {
            title: "Cost along the epipolar line",
            y_label: match self.cost {
                Cost::Sad => "SAD (gray levels)",
                Cost::Census => "Hamming distance (bits)",
            },
            lines: vec![("cost C(d)", Role::Candidate, shown.costs.iter().map(|cost| *cost as f32).collect())],
            best: usize::from(best),
            thresholds: uniqueness.into_iter().collect(),
            pair,
        };
        vec![
            Readout::Facts(facts),
            Readout::Equation(self.equation(shown)),
            curve.readout(),
            Readout::Tiles(self.tiles(shown)),
        ]
    }

    /// The cost, and the vertex of the parabola with its numbers where there is one.
    fn equation(&self, shown: &Shown) -> Vec<Math> {
        let Event { kept, best, .. } = shown.event;
        let best = usize::from(best);
        let sum = || Math::Sum(Box::new(Math::text("i, j")));
        let at = |name: &'static str, place: &str| {
            Math::Row(vec![Math::indexed(Math::Var("I"), Math::Var(name)), Math::text(place.to_owned())])
        };
        let left = at("L", "(x + i, y + j)");
        let right = at("R", "(x − d + i, y + j)");
        let inner = match self.cost {
            Cost::Sad => Math::abs(Math::Row(vec![left, Math::text(" − "), right])),
            Cost::Census => Math::text("H(census(x + i, y + j), census(x − d + i, y + j))"),
        };
        let mut lines = vec![Math::Row(vec![Math::Var("C"), Math::text("(d) = "), sum(), inner])];
        let is_inside = best > 0 && best + 1 < shown.costs.len();
        if kept.disparity.is_finite() && self.settings.subpixel && is_inside {
            let [before, here, after] = [best - 1, best, best + 1].map(|d| words::cost(shown.costs[d].into()));
            lines.push(Math::Row(vec![
                Math::Var("d"),
                Math::text(format!(" = {best} + ")),
                Math::over(
                    Math::text(format!("{before} − {after}")),
                    Math::text(format!("2 · ({before} − 2 · {here} + {after})")),
                ),
                Math::text(" = "),
                Math::ink(Role::Result, disparity_px(kept.disparity)),
            ]));
        }
        lines
    }

    /// The window, that of the best match, and their difference.
    fn tiles(&self, shown: &Shown) -> Vec<Tile> {
        let views = &shown.fixed.views;
        let (side, best) = (2 * self.window + 1, shown.event.best as isize);
        let (x, y, reach) = (shown.pixel.0 as isize, shown.pixel.1 as isize, self.window as isize);
        let window = |luma: &Grid<u8>, shift: isize| {
            let border = Border::Replicate;
            Grid::from_fn(side, side, |i, j| {
                f32::from(luma.at(x - shift + i as isize - reach, y + j as isize - reach, border))
            })
        };
        let (left, right) = (window(views.left.luma(), 0), window(views.right.luma(), best));
        let difference = Grid::from_fn(side, side, |i, j| right[(i, j)] - left[(i, j)]);
        let tile = |label, role, values, range| Tile { label, role: Some(role), values, range, framed: Vec::new() };
        vec![
            tile("window", Role::Reference, left, [0.0, 255.0]),
            tile("best match", Role::Best, right, [0.0, 255.0]),
            tile("difference", Role::Error, difference, [-64.0, 64.0]),
        ]
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        scene.pictures = seen.before.fixed.views.canvases();
        let meaning = "disparity in px, so far";
        draw_map(scene, seen.before.map(seen.events), self.settings.disparities, meaning);
        if let Some(shown) = self.shown(seen) {
            let Event { kept, best, .. } = shown.event;
            let is_kept = kept.disparity.is_finite();
            let at = if is_kept { kept.disparity } else { f32::from(best) };
            draw_match(scene, &self.pair(&shown), at, is_kept);
        }
    }
}
