//! The charts and the drawing of robust estimation.

use super::explain::{ended, is_last};
use super::vocabulary::{case, value};
use super::{Consensus, Event, Fixed, InlierCounts, Robust, RobustModel, State};
use crate::methods::geometric::Correspondence;
use crate::methods::geometric::ransac::chosen;
use crate::methods::geometric::system::System;
use crate::products::model::Matrix3;
use crate::run::Seen;
use crate::scene::{Link, Matrix, Picture, Readout, Role, Scene, Series, Shape, Step};

impl<M: RobustModel> Robust<M> {
    /// Adds the matrices of a step, if it has none of its own, and the chart of the inliers.
    pub(super) fn add_charts(&self, step: Step, seen: &Seen<Self>, event: &Event) -> Step {
        let (best, system) = (self.best_now(seen), self.system(seen, event));
        let has_own = step.readouts.iter().any(|of| matches!(of, Readout::Matrices(_)));
        let step = match system.equations {
            Some(equations) => step
                .put(value::UNKNOWN, M::SYMBOL.to_lowercase())
                .fact_as(value::EQUATIONS.is(equations), case::LINEAR_SYSTEM),
            None => step,
        };
        let matrices = [self.matrices(seen, best.map(|(matrix, _)| matrix)), system.matrices].concat();
        step.show_all((!has_own).then_some(Readout::Matrices(matrices)))
            .show_all(self.series(seen, best.map(|(_, score)| score.inliers)).map(Readout::Series))
    }

    /// The linear system behind the model of an event: of the sample, or of all inliers, where the refinement begins.
    fn system(&self, seen: &Seen<Self>, event: &Event) -> System {
        let points = &seen.before.fixed.points;
        let solved: Vec<Correspondence> = match event {
            Event::Hypothesis(_) => match seen.events.iter().rev().find(|event| matches!(event, Event::Sample(_))) {
                Some(Event::Sample(indices)) => chosen(points, indices),
                _ => Vec::new(),
            },
            Event::Local(matrix, _) | Event::Refit(matrix, _) | Event::Kept(matrix, _) => {
                let are_inliers = self.are_inliers(points, matrix);
                points.iter().zip(are_inliers).filter_map(|(point, is_inlier)| is_inlier.then_some(*point)).collect()
            }
            _ => Vec::new(),
        };
        if solved.is_empty() {
            return System::default();
        }
        let system = self.0.system(&solved);
        if matches!(event, Event::Hypothesis(_)) { system } else { system.before_refinement() }
    }

    fn matrices(&self, seen: &Seen<Self>, best: Option<Matrix3>) -> Vec<Matrix> {
        let matrix = |name, role, entries: &Matrix3| Matrix::of_rows(M::SYMBOL, name, entries).with_role(role);
        let hypothesis = seen.events.iter().rev().find_map(|event| match event {
            Event::Hypothesis(found) => Some(matrix("hypothesis", Role::Candidate, found)),
            _ => None,
        });
        hypothesis.into_iter().chain(best.map(|found| matrix("best so far", Role::Best, &found))).collect()
    }

    /// Inliers of each iteration's hypothesis, and of the best so far. There are none before the first are counted.
    fn series(&self, seen: &Seen<Self>, best: Option<usize>) -> Option<Series> {
        let Consensus { history, needed, .. } = &seen.before.consensus;
        let mut counts = history.clone();
        if !seen.events.last().is_some_and(is_last) {
            let counted = |event: &Event| if let Event::Scored(score, _) = event { Some(score.inliers) } else { None };
            let own = seen.events.iter().filter_map(counted).max();
            counts.push(InlierCounts { own, best });
        }
        let line = |of: fn(&InlierCounts) -> Option<usize>| -> Vec<[f32; 2]> {
            let value = |(i, counts)| [(i + 1) as f32, of(counts).map_or(f32::NAN, |inliers| inliers as f32)];
            counts.iter().enumerate().map(value).collect()
        };
        let is_counted = !history.is_empty() || counts.iter().any(|counts| counts.own.is_some());
        is_counted.then(|| {
            Series::new(
                "Inliers of the hypotheses",
                ["iteration", "inliers"],
                counts.len().max((*needed).min(4 * counts.len())),
                vec![
                    ("of this hypothesis", Role::Candidate, line(|counts| counts.own)),
                    ("of the best so far", Role::Best, line(|counts| counts.best)),
                ],
            )
        })
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let Some(last) = seen.events.last() else {
            scene.legend(Role::Reference, "match");
            for found in &state.fixed.matches {
                scene.links.push(link(Role::Reference, found.from, found.to));
            }
            return;
        };
        if let Event::Sequel(index, best) = last {
            return self.0.draw_sequel(*index, &ended(state, *best), seen.focus, scene);
        }
        let shown = seen.events.iter().rev().find_map(|event| match event {
            Event::Hypothesis(matrix)
            | Event::Local(matrix, _)
            | Event::Resampled(_, matrix, _)
            | Event::Refit(matrix, _)
            | Event::Kept(matrix, _) => Some(*matrix),
            _ => None,
        });
        self.draw_matches(state, shown, scene);
        if let Some(Event::Sample(indices)) = seen.events.iter().find(|event| matches!(event, Event::Sample(_))) {
            let points = |side: fn(&Correspondence) -> [f64; 2]| {
                indices.iter().map(|i| side(&state.fixed.points[*i]).map(|c| c as f32)).collect::<Vec<_>>()
            };
            for (on, at) in [(Picture::CURRENT, points(|m| m.from)), (Picture::NEXT, points(|m| m.to))] {
                at.into_iter().for_each(|center| {
                    scene.mark(on, Role::Candidate, Shape::circle(center, 4.0));
                });
            }
            scene.legend(Role::Candidate, "sample");
        }
        if let Some(matrix) = shown {
            self.0.draw(&state.estimate(), matrix, seen.focus, scene);
        }
    }

    /// Inliers and outliers of a model.
    fn draw_matches(&self, state: &State, shown: Option<Matrix3>, scene: &mut Scene) {
        let Fixed { matches, points, .. } = &*state.fixed;
        let inliers = shown.map(|matrix| self.are_inliers(points, &matrix).collect::<Vec<_>>());
        for (i, found) in matches.iter().enumerate() {
            let (role, meaning) = match inliers.as_ref().map(|inliers| inliers[i]) {
                None => (Role::Reference, "match"),
                Some(true) => (Role::Result, "inlier"),
                Some(false) => (Role::Rejected, "outlier"),
            };
            scene.links.push(link(role, found.from, found.to));
            scene.legend(role, meaning);
        }
    }
}

fn link(role: Role, from: [f32; 2], to: [f32; 2]) -> Link {
    Link { role, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] }
}
