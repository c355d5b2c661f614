//! The explanation and the drawing of the active contour.

use super::{ActiveContour, Energy, Event, External, Field, Iteration, Point};
use crate::base::words::further_digits_of_sum;
use crate::geometry::polygon;
use crate::methods::contour::{Model, Verdict};
use crate::methods::contour::{explain, vocabulary::value as shared};
use crate::methods::numbers::RATIO_DECIMALS;
use crate::methods::region::{At, Ending, Explained};
use crate::scene::{Readout, Role, Scene, Series, Step, Unit};
use crate::{cases, variables};

variables! {
    /// The number of diffusion steps of gradient vector flow.
    DIFFUSIONS: "Diffusion steps", "", Unit::count("diffusion step");
    /// The regularisation of gradient vector flow.
    MU: "Regularisation", r"\mu", Unit::FINE;
    /// The mean length of the force at the points.
    MEAN_FORCE: "Mean force at the points", "", Unit::RATIO, Role::Predicted;
    /// The same before the diffusion.
    MEAN_FORCE_BEFORE: "Mean force before", "", Unit::RATIO, Role::Predicted;
    /// The mean displacement of the points in the iteration.
    DISPLACEMENT: "Mean displacement", "", Unit::SUBPIXEL, Role::Estimate;
    /// The mean displacement below which the contour has converged.
    EPSILON: "Stopping criterion", r"\epsilon", Unit::SUBPIXEL;
    /// The energy of the stretched contour.
    ELASTIC: "Elastic energy", "", Unit::RATIO, Role::Predicted;
    /// The energy of the bent contour.
    BENDING: "Bending energy", "", Unit::RATIO, Role::Window;
    /// The energy of the edges, low where they are strong.
    EXTERNAL: "External energy", "", Unit::RATIO, Role::Measured;
    /// The energy of the pressure inside.
    BALLOON: "Balloon energy", "", Unit::RATIO, Role::Candidate;
    /// The sum of the energies.
    ENERGY: "Energy", "E", Unit::RATIO, Role::Estimate;
    /// The length of the contour.
    LENGTH: "Length", "", Unit::PX;
    /// The mean length of the force of elasticity and rigidity.
    INTERNAL_FORCE: "Internal force", "", Unit::RATIO;
    /// The mean length of the force of edges and pressure.
    EXTERNAL_FORCE: "External force", "", Unit::RATIO;
    /// The sources of the external force.
    SOURCES: "External forces", "", Unit::WHOLE;
}

cases! { pub(super) over value, shared;
    EDGE_FORCE: "The external energy −κ f is low on edges, and its force κ ∇f acts near them. The contour has {points} points.",
    DIFFUSED: "{diffusions} carry the force from the edges into flat parts of the window (gradient vector flow, μ = {mu}). Its mean length at the \
               points goes from {mean_force_before} to {mean_force}.",
    ITERATED: "Iteration {iteration}: the solution of (A + γ I) v = γ v + F moves the points by {displacement} on average, to a total energy of {energy}.",
    CONVERGED: "Less than ε = {epsilon}: converged. Internal and external forces balance.",
    EXHAUSTED: "It has not converged (ε = {epsilon}), but this is the maximum number of iterations.",
    FORCES: "Mean external force {external_force}, internal {internal_force}:",
    EXTERNAL: "{sources} pull harder than elasticity and rigidity.",
    INTERNAL: "elasticity and rigidity pull harder than {sources}.",
    FARTHER: "Gradient vector flow or a larger σ reaches farther; a velocity is not predicted.",
    NO_VELOCITY: "A velocity is not predicted.",
}

/// The energy of a contour by its parts.
const ENERGY: &str = r"E = \frac{\alpha}{2} \sum_i |v_{i+1} - v_i|^2 + \frac{\beta}{2} \sum_i |v_{i-1} - 2 \, v_i + v_{i+1}|^2 - \kappa \sum_i f(v_i) - p \text{ area}";

/// The mean length of the force at points, in 1/px.
fn mean_force(field: &Field, points: &[Point]) -> f64 {
    let each = points.iter().map(|at| field.edges.force_at(&field.force, *at));
    each.map(|force| force[0].hypot(force[1])).sum::<f64>() / points.len() as f64
}

/// The judgement of the frame, once it is there.
fn verdict<'a>(at: &'a At<'_, ActiveContour>) -> Option<&'a Verdict> {
    match at.event {
        Event::Judged(_, _, verdict) => Some(verdict),
        _ => None,
    }
}

impl Explained for ActiveContour {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        match at.event {
            Event::Edges(field, points) => {
                let step = explain::edges(step, &field.edges, (self.snake.sigma, points.len()));
                step.fact(value::MEAN_FORCE, mean_force(field, points)).say(case::EDGE_FORCE).formula(ENERGY)
            }
            Event::Diffused([before, after], points) => {
                let step = step.put(value::DIFFUSIONS, self.diffusions).put(value::MU, self.mu);
                let step = step.put(value::MEAN_FORCE_BEFORE, mean_force(before, points));
                let step = step.fact(shared::POINTS, points.len());
                step.fact(value::MEAN_FORCE, mean_force(after, points)).say(case::DIFFUSED)
            }
            Event::Iterated(iteration) => self.tell_iteration(step, iteration).show(self.energies(at)),
            Event::Judged(_, _, verdict) => {
                explain::tell_verdict(step, verdict, self.snake.min_edge_strength).show(self.energies(at))
            }
        }
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        let (field, points) = match at.event {
            Event::Edges(field, points) | Event::Diffused([_, field], points) | Event::Judged(field, points, _) => {
                (field, &points[..])
            }
            Event::Iterated(iteration) => (&iteration.field, &iteration.after[..]),
        };
        explain::heat(scene, "f", (field.edges.origin, &field.edges.strength));
        match at.event {
            Event::Edges(..) | Event::Diffused(..) => {
                explain::arrows(scene, field.edges.origin, &field.force.values);
            }
            Event::Iterated(iteration) => {
                explain::contour(scene, (Role::Rejected, "contour before the iteration"), &iteration.before);
            }
            Event::Judged(..) => {}
        }
        explain::contour(scene, (Role::Best, "contour"), points);
        explain::dots(scene, Role::Best, points);
    }

    fn draw_result(&self, model: &Model, scene: &mut Scene) {
        explain::result(scene, model);
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        explain::loss(step, verdict(at))
    }

    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step {
        let reach = match self.force {
            External::Gradient => case::FARTHER,
            External::Flow => case::NO_VELOCITY,
        };
        explain::advice(step, ending, (verdict(at), reach))
    }
}

impl ActiveContour {
    fn tell_iteration(&self, step: Step, iteration: &Iteration) -> Step {
        let energy = self.energy(iteration);
        let Energy { elastic, bending, external, balloon } = energy;
        let [internal_force, external_force] = self.mean_forces(iteration);
        let parts = [value::ELASTIC, value::BENDING, value::EXTERNAL, value::BALLOON].into_iter();
        let parts = parts.zip([elastic, bending, external, balloon]);
        let step = step.fact(shared::ITERATION, iteration.number).fact(value::DISPLACEMENT, iteration.moved);
        let step = parts.clone().fold(step, |step, (of, energy)| step.fact(of, energy));
        let step = step.fact(value::LENGTH, polygon::length(&iteration.after)).put(value::ENERGY, energy.total());
        let sources = if self.balloon == 0.0 { "the edges" } else { "the edges and the pressure" };
        let step = step.put(value::EPSILON, self.epsilon).put(value::SOURCES, sources).say(case::ITERATED);
        let step = match (iteration.has_converged, iteration.number == self.iterations) {
            (true, _) => step.say(case::CONVERGED),
            (false, true) => step.say(case::EXHAUSTED),
            (false, false) => {
                let step = step.put(value::INTERNAL_FORCE, internal_force).put(value::EXTERNAL_FORCE, external_force);
                let is_external = external_force > internal_force;
                step.say(case::FORCES).say(if is_external { case::EXTERNAL } else { case::INTERNAL })
            }
        };
        let unit =
            Unit::RATIO.finer(further_digits_of_sum(&[elastic, bending, external, balloon], RATIO_DECIMALS) as u8);
        let step = parts.fold(step, |step, (of, energy)| step.put_value(of.is(energy).in_unit(unit)));
        step.formula(ENERGY).formula("= {elastic}{bending:signed}{external:signed}{balloon:signed} = {energy}")
    }

    /// The energies over the iterations of the frame.
    fn energies(&self, at: &At<'_, Self>) -> Readout {
        let mut events = Vec::new();
        // In the first frame its region was chosen before.
        let first = if at.model.is_none() { 2 } else { 1 };
        let mut all: Vec<(usize, Energy)> = Vec::new();
        for (i, event) in at.events.iter().enumerate() {
            if let Event::Iterated(iteration) = event {
                events.push(first + i);
                all.push((iteration.number, self.energy(iteration)));
            }
        }
        let line = |name, role, of: fn(&Energy) -> f64| {
            (name, role, all.iter().map(|(number, energy)| [*number as f32, of(energy) as f32]).collect())
        };
        let mut lines = vec![
            line("total", Role::Estimate, Energy::total),
            line("external", Role::Measured, |energy| energy.external),
            line("elastic", Role::Predicted, |energy| energy.elastic),
            line("bending", Role::Window, |energy| energy.bending),
        ];
        if self.balloon != 0.0 {
            lines.push(line("balloon", Role::Candidate, |energy| energy.balloon));
        }
        Readout::Series(Series {
            events,
            ..Series::new("Energy of the contour", ["iteration", "energy"], self.iterations, lines)
        })
    }
}
