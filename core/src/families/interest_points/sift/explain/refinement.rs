//! The refinement of an extremum, and its tests for contrast and edges.

use super::super::{Event, Sift, State, line};
use super::extrema::neighbourhood;
use crate::base::words::{self, gray, pixel};
use crate::methods::scale_space::{Iteration, Refined, Rejection};
use crate::run::Seen;
use crate::scene::{Fact, Math, Name, Picture, Readout, Role, Scene, Sentence, Shape};

impl Sift {
    pub(super) fn iteration_said(&self, iteration: &Iteration) -> Sentence {
        let Iteration { at, offset, .. } = iteration;
        if !offset.iter().all(|c| c.is_finite()) {
            return Sentence::default()
                .text("The quadratic through the neighbourhood of ")
                .ink(Role::Candidate, pixel((at.x, at.y)))
                .text(" has a singular Hessian, so it has no extremum.");
        }
        let [dx, dy, ds] = offset.map(|c| words::fixed(c.into(), 2));
        let said = Sentence::default()
            .text("The quadratic through the neighbourhood of ")
            .ink(Role::Candidate, pixel((at.x, at.y)))
            .text(format!(" has its extremum at the offset ({dx}, {dy}) px, {ds} scales"));
        match iteration.is_converged() {
            true => said.text(": less than ½ in each direction, so the position is final."),
            false => said.text(": beyond ½, so it lies nearer to a neighbour, where the fit is repeated."),
        }
    }

    pub(super) fn verdict_said(&self, seen: &Seen<Self>, verdict: Result<Refined, Rejection>) -> (Name, Sentence) {
        let said = Sentence::default();
        let Some(last) = last_iteration(seen) else { return (line::UNSTABLE, said) };
        let thresholds = self.thresholds();
        let contrast = gray(last.contrast().abs());
        let [trace, determinant] = last.curvature();
        let limit = (thresholds.edge + 1.0).powi(2) / thresholds.edge;
        match verdict {
            Err(Rejection::Unstable) => {
                let why = "The extremum leaves the scale space or still moves after the last iteration: ";
                (line::UNSTABLE, said.text(why).ink(Role::Rejected, "rejected").text(" as unstable."))
            }
            Err(Rejection::LowContrast) => {
                let outcome = format!(
                    "|D| = {contrast} gray levels at the extremum is below the contrast threshold {}: ",
                    gray(thresholds.contrast)
                );
                (line::LOW_CONTRAST, said.text(outcome).ink(Role::Rejected, "rejected").text(", noise would move it."))
            }
            Err(Rejection::Edge) if determinant <= 0.0 => {
                let outcome = "The principal curvatures have opposite signs, so this is a saddle in position: ";
                (line::ON_EDGE, said.text(outcome).ink(Role::Rejected, "rejected").text("."))
            }
            Err(Rejection::Edge) => {
                let outcome = format!(
                    "(tr H)² / det H = {} reaches (r + 1)² / r = {}: one principal curvature is at least {} times the other, an edge. ",
                    gray(trace * trace / determinant),
                    gray(limit),
                    words::fixed(thresholds.edge.into(), 0)
                );
                let why = ", its position along the edge is uncertain.";
                (line::ON_EDGE, said.text(outcome).ink(Role::Rejected, "Rejected").text(why))
            }
            Ok(refined) => {
                let (at, sigma_px) = self.in_frame(&refined);
                let outcome = said.text("Kept at ").ink(Role::Result, words::place(at)).text(format!(
                    " px of the frame with σ = {} px: |D| = {contrast} reaches the contrast threshold {}, and (tr H)² / det H = {} is below \
                     {}, so it is no edge.",
                    gray(sigma_px),
                    gray(thresholds.contrast),
                    gray(trace * trace / determinant),
                    gray(limit)
                ));
                (line::KEEP, outcome)
            }
        }
    }

    pub(super) fn fit_readouts(&self, state: &State, iteration: &Iteration) -> Vec<Readout> {
        let [gx, gy, gs] = iteration.gradient.map(gray);
        let [xx, yy, ss, xy, xs, ys] = iteration.hessian.map(gray);
        let offset = iteration.offset.map(|c| Math::ink(Role::Result, gray(c)));
        let row = |entries: [&String; 3]| entries.map(|entry| Math::text(entry.clone())).to_vec();
        let symbols = Math::Row(vec![
            Math::Bold("d"),
            Math::text(" = −"),
            Math::power(Math::Bold("H"), Math::text("−1")),
            Math::text(" ∇"),
            Math::Var("D"),
        ]);
        let numbers = Math::Row(vec![
            Math::text("= −"),
            Math::power(
                Math::Matrix(vec![row([&xx, &xy, &xs]), row([&xy, &yy, &ys]), row([&xs, &ys, &ss])]),
                Math::text("−1"),
            ),
            Math::text(" "),
            Math::column([gx, gy, gs].map(Math::text)),
            Math::text(" = "),
            Math::column(offset),
        ]);
        let mut all = vec![Readout::Equation(vec![symbols, numbers])];
        all.extend(self.around(state, iteration.at).map(|around| Readout::Tiles(neighbourhood(&around))));
        all
    }

    pub(super) fn verdict_readouts(&self, state: &State, last: &Iteration) -> Vec<Readout> {
        let (thresholds, [trace, determinant]) = (self.thresholds(), last.curvature());
        let limit = (thresholds.edge + 1.0).powi(2) / thresholds.edge;
        let ratio = if determinant > 0.0 { gray(trace * trace / determinant) } else { "negative".into() };
        let facts = vec![
            Fact::new(
                "|D| at the extremum",
                format!("{} gray levels", gray(last.contrast().abs())),
                Some(Role::Result),
            ),
            Fact::new("Contrast threshold", format!("{} gray levels", gray(thresholds.contrast)), None),
            Fact::new("(tr H)² / det H", ratio, Some(Role::Result)),
            Fact::new("Edge limit (r + 1)² / r", gray(limit), None),
        ];
        let mut all = vec![Readout::Facts(facts)];
        all.extend(self.around(state, last.at).map(|around| Readout::Tiles(neighbourhood(&around))));
        all
    }

    pub(super) fn draw_refinement(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        if let Some(at) = state.extrema.get(state.next) {
            self.show_difference(state, (at.octave, at.level), scene);
        }
        let waiting: Vec<_> = state.extrema[state.next..].iter().map(|at| self.point_of(at)).collect();
        if !waiting.is_empty() {
            scene.mark(Picture::RESPONSE, Role::Candidate, Shape::Points(waiting));
            scene.legend(Role::Candidate, "extremum in position and scale");
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
            scene.mark(Picture::RESPONSE, role, self.circle(&shown));
            scene.legend(
                role,
                match verdict {
                    None => "candidate being refined",
                    Some(Ok(_)) => "kept",
                    Some(Err(_)) => "rejected",
                },
            );
        }
    }
}

pub(super) fn last_iteration(seen: &Seen<Sift>) -> Option<Iteration> {
    seen.events.iter().rev().find_map(|event| match event {
        Event::Iteration(iteration) => Some(*iteration),
        _ => None,
    })
}
