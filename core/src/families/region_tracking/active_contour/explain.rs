//! The explanation and the drawing of the active contour.

use super::{ActiveContour, At, Energy, Event, Field, Iteration, Point};
use crate::base::words::{counted, fixed, summands};
use crate::geometry::polygon;
use crate::methods::contour::explain;
use crate::methods::numbers::{px, ratio};
use crate::scene::{Fact, Math, Readout, Role, Scene, Sentence, Series};

/// The decimals of an energy or a force.
const ENERGY_DECIMALS: usize = 3;

/// An energy or a force as text.
fn energy(value: f64) -> String {
    fixed(value, ENERGY_DECIMALS)
}

/// The mean length of the force at points, in 1/px.
fn mean_force(field: &Field, points: &[Point]) -> f64 {
    let each = points.iter().map(|at| field.edges.force_at(&field.force, *at));
    each.map(|force| force[0].hypot(force[1])).sum::<f64>() / points.len() as f64
}

impl ActiveContour {
    pub(super) fn said(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Edges(field, points) => explain::edges(said, &field.edges, self.snake.sigma).text(format!(
                " The external energy −κ f is low on edges, and its force κ ∇f acts near them. The contour has {}.",
                counted(points.len(), "point")
            )),
            Event::Diffused([before, after], points) => said
                .text(format!(
                    "{} carry the force from the edges into flat parts of the window (gradient vector flow, μ = {}). Its mean length at the \
                     points goes from ",
                    counted(self.diffusions, "diffusion step"),
                    fixed(self.mu.into(), 2)
                ))
                .ink(Role::Predicted, energy(mean_force(before, points)))
                .text(" to ")
                .ink(Role::Predicted, energy(mean_force(after, points)))
                .text("."),
            Event::Iterated(iteration) => self.iterated(iteration, said),
            Event::Judged(_, _, verdict) => explain::judged(said, verdict, self.snake.min_edge_strength),
        }
    }

    fn iterated(&self, iteration: &Iteration, said: Sentence) -> Sentence {
        let [internal, external] = self.mean_forces(iteration);
        let outer = if self.balloon == 0.0 { "the edges" } else { "the edges and the pressure" };
        let why = if external > internal {
            format!("{outer} pull harder than elasticity and rigidity")
        } else {
            format!("elasticity and rigidity pull harder than {outer}")
        };
        let said = said
            .text(format!("Iteration {}: the solution of (A + γ I) v = γ v + F moves the points by ", iteration.number))
            .ink(Role::Estimate, format!("{} px", ratio(iteration.moved)))
            .text(format!(" on average, to a total energy of {}.", energy(self.energy(iteration).total())));
        if iteration.moved < f64::from(self.epsilon) {
            said.text(format!(
                " Less than ε = {} px: converged. Internal and external forces balance.",
                ratio(self.epsilon.into())
            ))
        } else if iteration.number == self.iterations {
            said.text(format!(
                " It has not converged (ε = {} px), but this is the maximum number of iterations.",
                ratio(self.epsilon.into())
            ))
        } else {
            said.text(format!(" Mean external force {}, internal {}: {why}.", energy(external), energy(internal)))
        }
    }

    pub(super) fn shown(&self, at: &At<'_, Self>) -> Vec<Readout> {
        match at.event {
            Event::Edges(..) => vec![Readout::Equation(vec![formula_of_energy()])],
            Event::Diffused(..) => Vec::new(),
            Event::Iterated(iteration) => {
                vec![Readout::Equation(vec![formula_of_energy(), numbers(&self.energy(iteration))]), self.energies(at)]
            }
            Event::Judged(..) => vec![self.energies(at)],
        }
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
            title: "Energy of the contour",
            x_label: "iteration",
            y_label: "energy",
            x_max: self.iterations,
            events,
            lines,
            ..Series::default()
        })
    }
}

/// E = elastic + bending + external + balloon energy.
fn formula_of_energy() -> Math {
    let half = |factor: &'static str| Math::over(Math::Var(factor), Math::text("2"));
    let v = |index: &'static str| Math::indexed(Math::Var("v"), Math::text(index));
    let sum = || Math::Sum(Box::new(Math::Var("i")));
    let square = |of: Vec<Math>| Math::squared(Math::abs(Math::Row(of)));
    Math::Row(vec![
        Math::Var("E"),
        Math::text(" = "),
        half("α"),
        sum(),
        square(vec![v("i+1"), Math::text(" − "), v("i")]),
        Math::text(" + "),
        half("β"),
        sum(),
        square(vec![v("i−1"), Math::text(" − 2 "), v("i"), Math::text(" + "), v("i+1")]),
        Math::text(" − κ "),
        sum(),
        Math::Row(vec![Math::Var("f"), Math::text("("), v("i"), Math::text(") − ")]),
        Math::Var("p"),
        Math::text(" area"),
    ])
}

/// The energies of an iteration in that formula.
fn numbers(of: &Energy) -> Math {
    let [elastic, bending, external, balloon] =
        summands([of.elastic, of.bending, of.external, of.balloon], ENERGY_DECIMALS);
    Math::Row(vec![
        Math::text("= "),
        Math::ink(Role::Predicted, elastic),
        Math::ink(Role::Window, bending),
        Math::ink(Role::Measured, external),
        Math::ink(Role::Candidate, balloon),
        Math::text(" = "),
        Math::ink(Role::Estimate, energy(of.total())),
    ])
}

pub(super) fn facts(tracker: &ActiveContour, at: &At<'_, ActiveContour>) -> Vec<Fact> {
    match at.event {
        Event::Edges(field, points) | Event::Diffused([_, field], points) => vec![
            Fact::new("Points", points.len().to_string(), None),
            Fact::new("Mean force at the points", energy(mean_force(field, points)), Some(Role::Predicted)),
        ],
        Event::Iterated(iteration) => {
            let Energy { elastic, bending, external, balloon } = tracker.energy(iteration);
            vec![
                Fact::new("Iteration", iteration.number.to_string(), None),
                Fact::new("Mean displacement", format!("{} px", ratio(iteration.moved)), Some(Role::Estimate)),
                Fact::new("Elastic energy", energy(elastic), Some(Role::Predicted)),
                Fact::new("Bending energy", energy(bending), Some(Role::Window)),
                Fact::new("External energy", energy(external), Some(Role::Measured)),
                Fact::new("Balloon energy", energy(balloon), Some(Role::Candidate)),
                Fact::new("Length", format!("{} px", px(polygon::length(&iteration.after))), None),
            ]
        }
        Event::Judged(_, _, verdict) => explain::verdict_facts(verdict),
    }
}

pub(super) fn draw(at: &At<'_, ActiveContour>, scene: &mut Scene) {
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
