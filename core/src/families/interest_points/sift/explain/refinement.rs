//! The refinement of an extremum, and its tests for contrast and edges.

use super::super::{Event, Sift, State, case, features, line, value};
use crate::geometry::Grid;
use crate::methods::scale_space::{Iteration, Refined, Rejection};
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape, Step};

impl Sift {
    pub(super) fn tell_fit(&self, state: &State, iteration: &Iteration) -> Step {
        let Iteration { at, gradient, hessian: [xx, yy, ss, xy, xs, ys], offset, .. } = *iteration;
        let hessian = [[xx, xy, xs], [xy, yy, ys], [xs, ys, ss]];
        let column = |of: [f32; 3]| Grid::from_fn(1, 3, |_, i| f64::from(of[i]));
        let step = Step::at(line::FIT).put_value(features::PIXEL.is((at.x, at.y)).inked(Role::Candidate));
        let step = step.put(value::OFFSET, [offset[0], offset[1]]).put(value::SCALE_OFFSET, offset[2]);
        let step = step.put(value::HESSIAN, Grid::from_fn(3, 3, |i, j| f64::from(hessian[j][i])));
        let step = step.put(value::GRADIENT, column(gradient)).put(value::STEP, column(offset));
        let step = match (offset.iter().all(|c| c.is_finite()), iteration.is_converged()) {
            (false, _) => step.say(case::SINGULAR),
            (true, true) => step.say(case::FITTED).say(case::CONVERGED),
            (true, false) => step.say(case::FITTED).say(case::REPEATED),
        };
        let step = step.formula(r"\mathbf{d} = -\mathbf{H}^{-1}\,\nabla D");
        let step = step.formula(r"\mathbf{d} = -{hessian}^{-1}\,{gradient} = {step}");
        step.show_all(self.around(state, at).map(|around| around.tiles()))
    }

    pub(super) fn tell_verdict(&self, seen: &Seen<Self>, verdict: Result<Refined, Rejection>) -> Step {
        let Some(last) = last_iteration(seen) else { return Step::at(line::UNSTABLE) };
        let (thresholds, [trace, determinant]) = (self.thresholds(), last.curvature());
        let (line, case) = match verdict {
            Err(Rejection::Unstable) => (line::UNSTABLE, case::UNSTABLE),
            Err(Rejection::LowContrast) => (line::LOW_CONTRAST, case::LOW_CONTRAST),
            Err(Rejection::Edge) if determinant <= 0.0 => (line::ON_EDGE, case::SADDLE),
            Err(Rejection::Edge) => (line::ON_EDGE, case::ON_EDGE),
            Ok(_) => (line::KEEP, case::KEPT),
        };
        let ratio = match determinant > 0.0 {
            true => value::CURVATURE_RATIO.is(trace * trace / determinant),
            false => value::CURVATURE_RATIO.is("negative"),
        };
        let step = Step::at(line).fact(value::CONTRAST, last.contrast().abs());
        let step = step.fact(value::CONTRAST_THRESHOLD, thresholds.contrast).fact_of(ratio);
        let step = step.fact(value::EDGE_LIMIT, (thresholds.edge + 1.0).powi(2) / thresholds.edge);
        let step = step.put(value::EDGE_THRESHOLD, thresholds.edge);
        let step = verdict.iter().fold(step, |step, refined| {
            let (at, sigma_px) = self.in_frame(refined);
            step.put_value(features::POSITION.is(at).inked(Role::Result)).put(value::SIGMA_IN_FRAME, sigma_px)
        });
        step.say(case).show_all(self.around(seen.before, last.at).map(|around| around.tiles()))
    }

    pub(super) fn draw_refinement(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        if let Some(at) = state.extrema.get(state.next) {
            self.show_difference(state, (at.octave, at.level), scene);
        }
        let waiting: Vec<_> = state.extrema[state.next..].iter().map(|at| self.point_of(at)).collect();
        if !waiting.is_empty() {
            scene.draw(Picture::RESPONSE, (Role::Candidate, "extremum in position and scale"), Shape::Points(waiting));
        }
        self.draw_circles(Picture::RESPONSE, state.refined.iter(), scene);
        if let Some(last) = last_iteration(seen) {
            let verdict = seen.events.iter().find_map(|event| match event {
                Event::Verdict(verdict) => Some(*verdict),
                _ => None,
            });
            let shown = Refined { at: last.at, offset: last.offset.map(|c| c.clamp(-2.0, 2.0)), response: 0.0 };
            let role = match verdict {
                None => Role::Reference,
                Some(Ok(_)) => Role::Best,
                Some(Err(_)) => Role::Rejected,
            };
            scene.draw(
                Picture::RESPONSE,
                (
                    role,
                    match verdict {
                        None => "candidate being refined",
                        Some(Ok(_)) => "kept",
                        Some(Err(_)) => "rejected",
                    },
                ),
                self.circle(&shown),
            );
        }
    }
}

fn last_iteration(seen: &Seen<Sift>) -> Option<Iteration> {
    seen.events.iter().rev().find_map(|event| match event {
        Event::Iteration(iteration) => Some(*iteration),
        _ => None,
    })
}
