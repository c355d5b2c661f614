//! The explanation and the drawing of the greedy active contour.

use super::{At, Event, GreedyContour, Pass, Terms, Test};
use crate::base::words::{counted, fixed, further_digits, rounded};
use crate::geometry::Grid;
use crate::methods::contour::{Point, explain};
use crate::methods::numbers::{RATIO_DECIMALS, px, ratio};
use crate::scene::{Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Tile};

fn pixel([x, y]: Point) -> String {
    format!("({},\u{a0}{})", fixed(x, 0), fixed(y, 0))
}

impl GreedyContour {
    fn side(&self) -> usize {
        2 * self.radius + 1
    }

    /// The place that a point moves to.
    fn chosen(&self, test: &Test) -> Point {
        self.place(test.site.at, test.best)
    }

    /// The energies of the neighbourhood of a point, before weighting.
    fn terms(&self, test: &Test) -> Vec<Option<Terms>> {
        let mut terms = Vec::new();
        self.test(&test.edges, &test.site, &mut terms);
        terms
    }

    /// The energies of the pixel that is chosen.
    fn lowest(&self, test: &Test) -> Terms {
        self.terms(test)[test.best].unwrap_or_default()
    }

    /// The contour before the event at hand: as at the last end of an iteration, with the moves since.
    fn contour(&self, at: &At<'_, Self>) -> Vec<Point> {
        let mut points = Vec::new();
        for event in &at.events[..at.events.len().saturating_sub(1)] {
            match event {
                Event::Edges(_, all) | Event::Judged(_, all, _) => points = all.to_vec(),
                Event::Passed(pass) => points.clone_from(&pass.points),
                Event::Tested(test) => points[test.index] = self.chosen(test),
            }
        }
        points
    }

    pub(super) fn said(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Edges(edges, points) => explain::edges(said, edges, self.snake.sigma).text(format!(
                " The edge energy is low where f is high. The contour has {}, each on a pixel.",
                counted(points.len(), "point")
            )),
            Event::Tested(test) => self.tested(test, said),
            Event::Passed(pass) => self.passed(pass, said),
            Event::Judged(_, _, verdict) => explain::judged(said, verdict, self.snake.min_edge_strength),
        }
    }

    fn tested(&self, test: &Test, said: Sentence) -> Sentence {
        let (from, to) = (test.site.at, self.chosen(test));
        let Terms { continuity, curvature, edge, total } = self.lowest(test);
        let said = said
            .text(format!("Iteration {}, point {} at {}: among the ", test.iteration, test.index + 1, pixel(from)))
            .ink(Role::Window, format!("{0}×{0} pixels", self.side()))
            .text(" of its neighbourhood, ")
            .ink(Role::Best, pixel(to))
            .text(format!(
                " has the lowest energy, {}: continuity {}, curvature {}, edge {} before weighting.",
                ratio(total),
                ratio(continuity),
                ratio(curvature),
                ratio(edge)
            ));
        let said = if from == to {
            said.text(" It is the present one, so the point stays.")
        } else {
            said.text(" The point moves there.")
        };
        if test.site.is_corner { said.text(" It is a corner, so curvature does not count.") } else { said }
    }

    fn passed(&self, pass: &Pass, said: Sentence) -> Sentence {
        let said = said
            .text(format!("End of iteration {}: ", pass.number))
            .ink(Role::Estimate, counted(pass.moved, "move"))
            .text(format!(
                ", {}, mean distance of the points {} px.",
                counted(pass.corners.len(), "corner"),
                px(pass.distance)
            ));
        if pass.moved <= self.max_moved {
            said.text(format!(" That is not more than {}: converged.", self.max_moved))
        } else if pass.number == self.iterations {
            said.text(" It has not converged, but this is the maximum number of iterations.")
        } else if pass.corners.is_empty() {
            said.text(" No point changes direction sharply on a strong edge, so rigidity β acts at all of them.")
        } else {
            said.text(" There β is 0, so that rigidity does not round the corner.")
        }
    }

    pub(super) fn figures(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Edges(edges, points) => vec![
                Fact::new("Points", points.len().to_string(), None),
                Fact::new(
                    "Steepest gradient",
                    format!("{} gray levels/px", fixed(edges.steepest.into(), 2)),
                    Some(Role::Measured),
                ),
            ],
            Event::Tested(test) => vec![
                Fact::new("Iteration", test.iteration.to_string(), None),
                Fact::new("Point", (test.index + 1).to_string(), None),
                Fact::new("Lowest energy", ratio(self.lowest(test).total), Some(Role::Best)),
                Fact::new("Pixel", pixel(self.chosen(test)), Some(Role::Best)),
            ],
            Event::Passed(pass) => vec![
                Fact::new("Iteration", pass.number.to_string(), None),
                Fact::new("Moves", pass.moved.to_string(), Some(Role::Estimate)),
                Fact::new("Corners", pass.corners.len().to_string(), None),
                Fact::new("Mean distance of the points", format!("{} px", px(pass.distance)), None),
                Fact::new("Sum of the energies", ratio(pass.sums.total), Some(Role::Estimate)),
            ],
            Event::Judged(_, _, verdict) => explain::verdict_facts(verdict),
        }
    }

    pub(super) fn shown(&self, at: &At<'_, Self>) -> Vec<Readout> {
        match at.event {
            Event::Edges(..) => vec![Readout::Equation(vec![formula()])],
            Event::Tested(test) => {
                vec![Readout::Equation(vec![formula(), self.numbers(test)]), Readout::Tiles(self.tiles(test))]
            }
            Event::Passed(_) | Event::Judged(..) => vec![self.energies(at)],
        }
    }

    /// The energies at the chosen pixel in the formula.
    fn numbers(&self, test: &Test) -> Math {
        let Terms { continuity, curvature, edge, total } = self.lowest(test);
        let beta = if test.site.is_corner { 0.0 } else { self.beta };
        let weights = [self.alpha, beta, self.edge_weight].map(f64::from);
        let further = further_digits(|further| {
            let terms = [continuity, curvature, edge].map(|of| rounded(of, RATIO_DECIMALS + further));
            ratio((0..3).map(|i| weights[i] * terms[i]).sum()) == ratio(total)
        });
        let number = |of: f64| fixed(of, RATIO_DECIMALS + further);
        let product = |weight: f32, of: f64| format!("{} · {}", fixed(weight.into(), 2), number(of));
        Math::Row(vec![
            Math::text("= "),
            Math::ink(Role::Predicted, product(self.alpha, continuity)),
            Math::text(" + "),
            Math::ink(Role::Window, product(beta, curvature)),
            Math::text(" + "),
            Math::ink(Role::Measured, format!("{} · ({})", fixed(self.edge_weight.into(), 2), number(edge))),
            Math::text(" = "),
            Math::ink(Role::Best, ratio(total)),
        ])
    }

    /// The energies of the neighbourhood.
    fn tiles(&self, test: &Test) -> Vec<Tile> {
        let (side, terms) = (self.side(), self.terms(test));
        let tile = |label, role, range, of: fn(&Terms) -> f64| Tile {
            label,
            role,
            values: Grid::from_fn(side, side, |x, y| {
                terms[y * side + x].as_ref().map_or(f32::NAN, |terms| of(terms) as f32)
            }),
            range,
            framed: Vec::new(),
        };
        let most = (self.alpha + self.beta).max(0.01);
        let total = [-self.edge_weight, most];
        vec![
            tile("continuity", Some(Role::Predicted), [0.0, 1.0], |of| of.continuity),
            tile("curvature", Some(Role::Window), [0.0, 1.0], |of| of.curvature),
            tile("edge", Some(Role::Measured), [-1.0, 0.0], |of| of.edge),
            tile("energy", Some(Role::Best), total, |of| of.total),
        ]
    }

    /// The energies over the iterations of the frame.
    fn energies(&self, at: &At<'_, Self>) -> Readout {
        // In the first frame its region was chosen before.
        let first = if at.model.is_none() { 2 } else { 1 };
        let passes = at.events.iter().enumerate().filter_map(|(i, event)| match event {
            Event::Passed(pass) => Some((first + i, pass)),
            _ => None,
        });
        let (events, all): (Vec<usize>, Vec<_>) = passes.unzip();
        let line = |name, role, of: fn(&Terms) -> f64| {
            (name, role, all.iter().map(|pass| [pass.number as f32, of(&pass.sums) as f32]).collect())
        };
        Readout::Series(Series {
            title: "Energies at the chosen pixels",
            x_label: "iteration",
            y_label: "energy",
            x_max: self.iterations,
            events,
            lines: vec![
                line("total", Role::Estimate, |of| of.total),
                line("edge", Role::Measured, |of| of.edge),
                line("continuity", Role::Predicted, |of| of.continuity),
                line("curvature", Role::Window, |of| of.curvature),
            ],
            ..Series::default()
        })
    }

    pub(super) fn drawn(&self, at: &At<'_, Self>, scene: &mut Scene) {
        let (edges, points) = match at.event {
            Event::Edges(edges, points) | Event::Judged(edges, points, _) => (edges, points.to_vec()),
            Event::Tested(test) => (&test.edges, self.contour(at)),
            Event::Passed(pass) => (&pass.edges, pass.points.clone()),
        };
        explain::heat(scene, "f", (edges.origin, &edges.strength));
        explain::contour(scene, (Role::Best, "contour"), &points);
        explain::dots(scene, Role::Best, &points);
        match at.event {
            Event::Tested(test) => {
                let [x, y] = test.site.at.map(|c| c as i32 - self.radius as i32);
                scene.mark(Picture::CURRENT, Role::Predicted, Shape::pixels(x, y, self.side(), self.side()));
                scene.legend(Role::Predicted, "neighbourhood of the point");
                let [x, y] = self.chosen(test).map(|c| c as i32);
                scene.mark(Picture::CURRENT, Role::Estimate, Shape::pixels(x, y, 1, 1));
                scene.legend(Role::Estimate, "pixel with the lowest energy");
            }
            Event::Passed(pass) if !pass.corners.is_empty() => {
                let corners: Vec<Point> = pass.corners.iter().map(|i| pass.points[*i]).collect();
                explain::dots(scene, Role::Measured, &corners);
                scene.legend(Role::Measured, "corners");
            }
            _ => {}
        }
    }
}

/// E = α E_cont + β E_curv + κ E_edge.
fn formula() -> Math {
    let energy = |index: &'static str| Math::indexed(Math::Var("E"), Math::text(index));
    Math::Row(vec![
        Math::Var("E"),
        Math::text(" = α "),
        energy("cont"),
        Math::text(" + β "),
        energy("curv"),
        Math::text(" + κ "),
        energy("edge"),
    ])
}
