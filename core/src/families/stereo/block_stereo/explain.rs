//! The explanation and the drawing of block stereo.

use super::{BlockStereo, Cost, Desk, Event, Fixed, State, line};
use crate::cases;
use crate::data::Disparity;
use crate::geometry::{Border, Grid};
use crate::methods::stereo::{
    Curve, Kept, Pair, Verdict, conclude, draw_map, draw_match, put_depth, smallest, starting, value,
};
use crate::run::Seen;
use crate::scene::{Readout, Role, Scene, Step, Tile};

cases! { over value;
    LOWEST_SAD: "{reference|Pixel} {pixel}: the minimum along the epipolar line, SAD {minimum} at d = {best:bare}",
    LOWEST_HAMMING: "{reference|Pixel} {pixel}: the minimum along the epipolar line, Hamming distance {minimum} at d = \
                     {best:bare}",
    AMBIGUOUS: ", has a rival: {rival_cost} at d = {rival:bare}, less than {uniqueness} higher, so the match is ambiguous and \
                the pixel gets no disparity.",
    REPEATED: "There is too little texture, or one that repeats.",
    INCONSISTENT: ", fails the left–right check: from the matched pixel of the {second}, the minimum is at d = {back:bare}.",
    OCCLUDED: "Probably the pixel is half-occluded, hidden there by something nearer.",
    UNIQUE: ", is unique and confirmed by the left–right check. The disparity is {disparity}.",
    WITH_DEPTH: ", is unique and confirmed by the left–right check. The disparity is {disparity}, which is a depth Z = f B / d \
                 of {depth}.",
}

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

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(shown) = self.shown(seen) else {
            return starting(Step::at(line::TAKE_VIEWS), &seen.before.fixed.views, &self.settings);
        };
        let step = self.tell_decision(&shown);
        let is_over = |after: &&State| after.y() == after.fixed.views.size().1;
        let step = match (seen.after.filter(is_over), seen.point()) {
            (Some(after), None) => conclude(step, &after.fixed.views, &self.settings, &after.kept),
            _ => step,
        };
        self.put_cost(step, &shown).show(self.curve(&shown)).show(Readout::Tiles(self.tiles(&shown)))
    }

    /// The minimum of the pixel and the outcome of its tests.
    fn tell_decision(&self, shown: &Shown) -> Step {
        let Event { kept, best, back } = shown.event;
        let (pair, minimum) = (self.pair(shown), smallest(&shown.costs));
        let line = match kept.verdict {
            Verdict::Ambiguous => line::REJECT_AMBIGUOUS,
            Verdict::Inconsistent => line::REJECT_INCONSISTENT,
            Verdict::Accepted => line::REFINE,
        };
        let step = pair.step(line).fact(value::MINIMUM, minimum.cost).fact(value::BEST, usize::from(best));
        let step = step.fact_if(value::RIVAL_COST, minimum.rival.map(|(_, cost)| cost));
        let step = step.fact_if(value::RIVAL, minimum.rival.map(|(at, _)| at)).fact(value::BACK, usize::from(back));
        let step = step.put(value::UNIQUENESS, self.settings.uniqueness);
        let step = step.say(if self.cost == Cost::Sad { case::LOWEST_SAD } else { case::LOWEST_HAMMING });
        match kept.verdict {
            Verdict::Ambiguous => pair.cause(step.say(case::AMBIGUOUS), case::REPEATED),
            Verdict::Inconsistent => pair.cause(step.say(case::INCONSISTENT), case::OCCLUDED),
            Verdict::Accepted => {
                let step = put_depth(step, shown.fixed.views.calibration.as_ref(), kept.disparity);
                let has_depth = step.real(value::DEPTH).is_finite();
                step.say(if has_depth { case::WITH_DEPTH } else { case::UNIQUE })
            }
        }
    }

    /// The cost along the epipolar line, with the highest that a rival must exceed.
    fn curve(&self, shown: &Shown) -> Readout {
        let limit = f64::from(smallest(&shown.costs).cost) * (1.0 + self.settings.uniqueness as f64 / 100.0);
        let uniqueness = (self.settings.uniqueness > 0).then(|| ("uniqueness".to_owned(), limit as f32));
        let curve = Curve {
            title: "Cost along the epipolar line",
            y_label: match self.cost {
                Cost::Sad => "SAD (gray levels)",
                Cost::Census => "Hamming distance (bits)",
            },
            lines: vec![("cost C(d)", Role::Candidate, shown.costs.iter().map(|cost| *cost as f32).collect())],
            best: usize::from(shown.event.best),
            thresholds: uniqueness.into_iter().collect(),
            pair: self.pair(shown),
        };
        curve.readout()
    }

    /// Adds the cost, and the vertex of the parabola with its numbers where there is one.
    fn put_cost(&self, step: Step, shown: &Shown) -> Step {
        let (best, costs) = (usize::from(shown.event.best), &shown.costs);
        let step = step.formula(match self.cost {
            Cost::Sad => r"C(d) = \sum_{i, j} |I_L(x + i, y + j) - I_R(x - d + i, y + j)|",
            Cost::Census => r"C(d) = \sum_{i, j} H(\text{census}(x + i, y + j), \text{census}(x - d + i, y + j))",
        });
        if shown.event.kept.verdict != Verdict::Accepted || !self.settings.is_refined(best, shown.pixel.0) {
            return step;
        }
        let step = step.put(value::COST_BEFORE, costs[best - 1]).put(value::COST_AFTER, costs[best + 1]);
        step.formula(
            r"d = {best} + \frac{{cost_before} - {cost_after}}{2 \cdot ({cost_before} - 2 \cdot {minimum} + {cost_after})}
              = {disparity:unit}",
        )
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
        vec![
            Tile::gray("window", left).with_role(Role::Reference),
            Tile::gray("best match", right).with_role(Role::Best),
            Tile::new("difference", difference, [-64.0, 64.0]).with_role(Role::Error),
        ]
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
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
