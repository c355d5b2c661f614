//! The last step of a search: sub-pixel refinement.

use super::tester::{BESIDE, around};
use super::vocabulary::{case, line, value};
use super::{Event, Match, Stage, Subpixel, Tester};
use crate::base::Observer;
use crate::scene::Step;

/// The eight points around a centre.
const AROUND: [[i32; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];
/// A parabola through three costs, along u and along v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The costs before, at and after the best displacement; `None` where a neighbour lies outside the search window.
    pub costs: [Option<[f64; 3]>; 2],
    /// The minimum, in px from the best displacement.
    pub fraction: [f32; 2],
}

/// Whether the parabola through the costs at −1, 0 and 1 has a minimum: it is a line where they are equal.
pub(super) fn has_lowest([before, at, after]: &[f64; 3]) -> bool {
    before - 2.0 * at + after > 0.0
}

/// The position of its minimum; 0 where it is a line.
fn lowest(costs: [f64; 3]) -> f32 {
    let [before, at, after] = costs;
    if !has_lowest(&costs) {
        return 0.0;
    }
    ((before - after) / (2.0 * (before - 2.0 * at + after))).clamp(-0.5, 0.5) as f32
}

impl<O: Observer<Event>> Tester<'_, O> {
    /// Refines the best match as the settings say.
    pub(super) fn refine(&mut self) {
        match self.settings.refinement.subpixel {
            Subpixel::None => {}
            Subpixel::Half => self.test_subpixel(&[2]),
            Subpixel::Quarter => self.test_subpixel(&[2, 1]),
            Subpixel::Parabola => self.fit_parabola(),
        }
    }

    /// Tests the eight positions around the best match, at a distance of each of `steps` in quarters of a px.
    fn test_subpixel(&mut self, steps: &[i32]) {
        let Some(start) = self.best else { return };
        self.pair.take_between(
            self.block,
            start.displacement,
            self.settings.refinement.interpolation,
            &mut self.work.between,
        );
        for &step in steps {
            let centre = self.best.map_or([0, 0], |best| best.quarters());
            let all = around(centre, &AROUND, step);
            let window = self.window;
            let points = all.clone().filter(move |&point| window.holds_quarters(point));
            self.observer.see(|| {
                let reason = Step::at(line::REFINE_BEST).put(value::CENTER, centre.map(|c| c as f32 / 4.0));
                let reason = reason.say(if step == 2 { case::HALF_PIXELS } else { case::QUARTER_PIXELS });
                Event::Refine(Stage {
                    narrowed: None,
                    asked: all.clone().count(),
                    points: points.clone().map(|point| point.map(|c| c as f32 / 4.0)).collect(),
                    reason: Box::new(reason),
                })
            });
            points.for_each(|point| self.test_position(start, point));
        }
    }

    /// Tests the displacement `quarters`, less than one px from that of `start`.
    fn test_position(&mut self, start: Match, quarters: [i32; 2]) {
        let from_start = [0, 1].map(|i| quarters[i] - 4 * start.displacement[i]);
        let (pixels, stride) = self.work.between.moved(from_start);
        let distortion = self.settings.matching.cost.between(self.block, &self.work.patch.block, pixels, stride);
        let cost = distortion + self.rate.price(quarters);
        self.take(Match { displacement: start.displacement, fraction: from_start.map(|c| c as f32 / 4.0), cost });
    }

    /// Moves to the best of the four neighbours until none is better, then fits a parabola along u and v.
    fn fit_parabola(&mut self) {
        let mut centre = None;
        while centre != self.best.map(|best| best.displacement) {
            let at = self.best();
            centre = Some(at);
            self.announce(around(at, &BESIDE, 1), Event::Refine, || {
                Step::at(line::REFINE_BEST).put(value::CENTER, at).say(case::FOR_PARABOLAS)
            });
        }
        let Some(mut best) = self.best else { return };
        let known = |offset: [i32; 2]| self.known([best.displacement[0] + offset[0], best.displacement[1] + offset[1]]);
        let costs = [[1, 0], [0, 1]].map(|[u, v]| Some([known([-u, -v])?, best.cost, known([u, v])?]));
        best.fraction = costs.map(|costs| costs.map_or(0.0, lowest));
        self.observer.see(|| Event::Fit(Fit { costs, fraction: best.fraction }));
        self.best = Some(best);
    }
}

#[cfg(test)]
mod tests {
    use super::lowest;

    #[test]
    fn a_parabola_is_lowest_where_it_was_made_to_be() {
        for at in [-0.5f64, -0.2, 0.0, 0.31, 0.5] {
            let cost = |x: f64| 3.0 * (x - at).powi(2) + 7.0;
            assert!((f64::from(lowest([cost(-1.0), cost(0.0), cost(1.0)])) - at).abs() < 1e-6);
        }
        assert_eq!(lowest([5.0, 5.0, 5.0]), 0.0);
        assert_eq!(lowest([9.0, 5.0, 5.0]), 0.5);
    }
}
