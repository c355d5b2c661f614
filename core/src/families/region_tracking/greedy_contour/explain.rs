//! The explanation and the drawing of the greedy active contour.

use super::{Event, GreedyContour, Pass, Terms, Test};
use crate::base::words::{fixed, further_digits, rounded};
use crate::geometry::Grid;
use crate::methods::contour::{Model, Point, Verdict};
use crate::methods::contour::{explain, vocabulary::value as shared};
use crate::methods::numbers::RATIO_DECIMALS;
use crate::methods::region::{At, Ending, Explained};
use crate::scene::{Picture, Readout, Role, Scene, Series, Shape, Step, Tile, Unit};
use crate::{cases, variables};

variables! {
    /// The number of the point.
    POINT: "Point", "i", Unit::WHOLE;
    /// The pixel of the point.
    PRESENT: "Present pixel", "", Unit::WHOLE;
    /// The pixel of the lowest energy in the neighbourhood.
    PIXEL: "Pixel", "", Unit::WHOLE, Role::Best;
    /// The side of the neighbourhood.
    SIDE: "Side of the neighbourhood", "", Unit::WHOLE, Role::Window;
    /// The weighted sum of the energies at that pixel.
    LOWEST_ENERGY: "Lowest energy", "E", Unit::RATIO, Role::Best;
    /// The continuity energy at that pixel, as a share of the largest in the neighbourhood.
    CONTINUITY: "Continuity", r"E_{\text{cont}}", Unit::RATIO, Role::Predicted;
    /// The curvature energy at that pixel, as a share of the largest in the neighbourhood.
    CURVATURE: "Curvature", r"E_{\text{curv}}", Unit::RATIO, Role::Window;
    /// The edge energy at that pixel, −1 at the strongest edge of the neighbourhood.
    EDGE: "Edge", r"E_{\text{edge}}", Unit::RATIO, Role::Measured;
    /// The weight of the continuity energy.
    ALPHA: "Weight of continuity", r"\alpha", Unit::FINE;
    /// The weight of the curvature energy, 0 at a corner.
    BETA: "Weight of curvature", r"\beta", Unit::FINE;
    /// The weight of the edge energy.
    EDGE_WEIGHT: "Weight of edges", r"\kappa", Unit::FINE;
    /// The number of moves in the iteration.
    MOVES: "Moves", "", Unit::count("move"), Role::Estimate;
    /// The number of moves with which the contour has converged.
    MAX_MOVED: "Moves at most", "", Unit::WHOLE;
    /// The number of corners, at which curvature does not count.
    CORNERS: "Corners", "", Unit::count("corner");
    /// The mean distance of neighbouring points.
    DISTANCE: "Mean distance of the points", "d", Unit::PX;
    /// The energies at the chosen pixels, summed over all points.
    ENERGY_SUM: "Sum of the energies", "", Unit::RATIO, Role::Estimate;
}

cases! { pub(super) over value, shared;
    EDGE_ENERGY: "The edge energy is low where f is high. The contour has {points} points, each on a pixel.",
    TESTED: "Iteration {iteration}, point {point} at {present}: among the {side}×{side} {window|pixels} of its neighbourhood, {pixel} has the lowest \
             energy, {lowest_energy}: continuity {continuity}, curvature {curvature}, edge {edge} before weighting.",
    STAYS: "It is the present one, so the point stays.",
    MOVES: "The point moves there.",
    AT_CORNER: "It is a corner, so curvature does not count.",
    PASSED: "End of iteration {iteration}: {moves}, {corners}, mean distance of the points {distance}.",
    CONVERGED: "That is not more than {max_moved}: converged.",
    EXHAUSTED: "It has not converged, but this is the maximum number of iterations.",
    NO_CORNER: "No point changes direction sharply on a strong edge, so rigidity β acts at all of them.",
    CORNERS: "There β is 0, so that rigidity does not round the corner.",
    FARTHER: "A larger σ blurs the edges so that they reach farther; mean shift needs no edges.",
}

/// The energy of a pixel.
const ENERGY: &str = r"E = \alpha \, E_{\text{cont}} + \beta \, E_{\text{curv}} + \kappa \, E_{\text{edge}}";

/// The judgement of the frame, once it is there.
fn verdict<'a>(at: &'a At<'_, GreedyContour>) -> Option<&'a Verdict> {
    match at.event {
        Event::Judged(_, _, verdict) => Some(verdict),
        _ => None,
    }
}

impl Explained for GreedyContour {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        match at.event {
            Event::Edges(edges, points) => {
                explain::edges(step, edges, (self.snake.sigma, points.len())).say(case::EDGE_ENERGY).formula(ENERGY)
            }
            Event::Tested(test) => self.tell_test(step, test).show(Readout::Tiles(self.tiles(test))),
            Event::Passed(pass) => self.tell_pass(step, pass).show(self.energies(at)),
            Event::Judged(_, _, verdict) => {
                explain::tell_verdict(step, verdict, self.snake.min_edge_strength).show(self.energies(at))
            }
        }
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
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
                scene.draw(
                    Picture::CURRENT,
                    (Role::Predicted, "neighbourhood of the point"),
                    Shape::pixels(x, y, self.side(), self.side()),
                );
                let [x, y] = self.chosen(test).map(|c| c as i32);
                scene.draw(
                    Picture::CURRENT,
                    (Role::Estimate, "pixel with the lowest energy"),
                    Shape::pixels(x, y, 1, 1),
                );
            }
            Event::Passed(pass) if !pass.corners.is_empty() => {
                let corners: Vec<Point> = pass.corners.iter().map(|i| pass.points[*i]).collect();
                explain::dots(scene, Role::Measured, &corners);
                scene.legend(Role::Measured, "corners");
            }
            _ => {}
        }
    }

    fn draw_result(&self, model: &Model, scene: &mut Scene) {
        explain::result(scene, model);
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        explain::loss(step, verdict(at))
    }

    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step {
        explain::advice(step, ending, (verdict(at), case::FARTHER))
    }
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

    /// The contour before the current event: as at the last end of an iteration, with the moves since.
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

    fn tell_test(&self, step: Step, test: &Test) -> Step {
        let (from, to, side) = (test.site.at, self.chosen(test), self.side());
        let Terms { continuity, curvature, edge, total } = self.lowest(test);
        let parts = [(value::CONTINUITY, continuity), (value::CURVATURE, curvature), (value::EDGE, edge)];
        let step = step.fact(shared::ITERATION, test.iteration).fact(value::POINT, test.index + 1);
        let step = step.fact(value::LOWEST_ENERGY, total).fact(value::PIXEL, to).put(value::PRESENT, from);
        let step = parts.iter().fold(step.put(value::SIDE, side), |step, (of, term)| step.put(of, *term));
        let step = step.say(case::TESTED).say(if from == to { case::STAYS } else { case::MOVES });
        let beta = if test.site.is_corner { 0.0 } else { self.beta };
        let weights = [self.alpha, beta, self.edge_weight].map(f64::from);
        let further = further_digits(|further| {
            let weighted =
                weights.iter().zip(&parts).map(|(weight, (_, term))| weight * rounded(*term, RATIO_DECIMALS + further));
            fixed(weighted.sum(), RATIO_DECIMALS) == fixed(total, RATIO_DECIMALS)
        });
        let unit = Unit::RATIO.finer(further as u8);
        let step = parts.iter().fold(step, |step, (of, term)| step.put_value(of.is(*term).in_unit(unit)));
        let step = step.put(value::ALPHA, self.alpha).put(value::BETA, beta).put(value::EDGE_WEIGHT, self.edge_weight);
        let step = step.say_if(test.site.is_corner, case::AT_CORNER).formula(ENERGY);
        step.formula(
            r"= {alpha} \cdot {continuity} + {beta} \cdot {curvature} + {edge_weight} \cdot {edge} = {lowest_energy}",
        )
    }

    fn tell_pass(&self, step: Step, pass: &Pass) -> Step {
        let step = step.fact(shared::ITERATION, pass.number).fact(value::MOVES, pass.moved);
        let step = step.fact(value::CORNERS, pass.corners.len()).fact(value::DISTANCE, pass.distance);
        let step = step.fact(value::ENERGY_SUM, pass.sums.total).put(value::MAX_MOVED, self.max_moved);
        step.say(case::PASSED).say(match (pass.has_converged, pass.number == self.iterations) {
            (true, _) => case::CONVERGED,
            (false, true) => case::EXHAUSTED,
            (false, false) if pass.corners.is_empty() => case::NO_CORNER,
            (false, false) => case::CORNERS,
        })
    }

    /// The energies of the neighbourhood.
    fn tiles(&self, test: &Test) -> Vec<Tile> {
        let (side, terms) = (self.side(), self.terms(test));
        let tile = |label, role, range, of: fn(&Terms) -> f64| {
            let value = |x: usize, y: usize| terms[y * side + x].as_ref().map_or(f32::NAN, |terms| of(terms) as f32);
            Tile::new(label, Grid::from_fn(side, side, value), range).with_role(role)
        };
        let most = (self.alpha + self.beta).max(0.01);
        let total = [-self.edge_weight, most];
        vec![
            tile("continuity", Role::Predicted, [0.0, 1.0], |of| of.continuity),
            tile("curvature", Role::Window, [0.0, 1.0], |of| of.curvature),
            tile("edge", Role::Measured, [-1.0, 0.0], |of| of.edge),
            tile("energy", Role::Best, total, |of| of.total),
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
            events,
            ..Series::new(
                "Energies at the chosen pixels",
                ["iteration", "energy"],
                self.iterations,
                vec![
                    line("total", Role::Estimate, |of| of.total),
                    line("edge", Role::Measured, |of| of.edge),
                    line("continuity", Role::Predicted, |of| of.continuity),
                    line("curvature", Role::Window, |of| of.curvature),
                ],
            )
        })
    }
}
