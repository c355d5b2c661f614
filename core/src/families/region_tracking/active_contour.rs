//! Active contours (snakes): a closed curve that contracts and stays smooth by its own energy, until edges hold it.

mod explain;

use std::sync::Arc;

use crate::base::Observer;
use crate::data::{Clip, Frame};
use crate::geometry::polygon;
use crate::methods::contour::{Edges, Fit, Force, Model, Pentadiagonal, Point, Snake, Verdict};
use crate::methods::region::{LOST, WHERE};
use crate::products::Region;
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question, Reply};
use crate::{choices, params, pseudocode};

use explain::case;

choices! {
    /// External force on the contour.
    pub enum External {
        /// The gradient of the edge strength. It acts only near edges.
        Gradient = "gradient" "Gradient of edge strength",
        /// Gradient vector flow: that gradient diffused into flat parts, so that edges attract from farther.
        Flow = "gradient-vector-flow" "Gradient vector flow",
    }
}

params! {
    /// Active contour (snake).
    pub struct ActiveContour {
        /// Start, points and edges.
        snake: Snake = Snake::default();
        /// External force on the contour.
        force: External = External::Gradient;
        /// Elasticity α. It contracts the contour and keeps its points apart; too much of it pulls the contour off its edges.
        alpha: f32 = 0.02, 0.0..=5.0;
        /// Rigidity β. It resists bending; too much of it rounds corners.
        beta: f32 = 0.05, 0.0..=20.0;
        /// Weight κ of the external energy.
        edge_weight: f32 = 1.0, 0.0..=10.0;
        /// Balloon pressure p. A positive one inflates the contour, a negative one deflates it, also where there is no edge.
        balloon: f32 = 0.0, -0.5..=0.5, "1/px²";
        /// Viscosity γ, the inverse of the time step. Small values move the contour far in an iteration, and may let it oscillate.
        gamma: f32 = 0.5, 0.05..=10.0;
        /// Regularisation μ of gradient vector flow. Large values smooth the force more; above 0.2 the diffusion
        /// steps would oscillate at strong edges.
        mu: f32 = 0.2, 0.01..=0.2;
        /// Number of diffusion steps of gradient vector flow. Each extends the reach of the edges.
        diffusions: usize = 80, 1..=1000;
        /// Maximum number of iterations in a frame.
        iterations: usize = 100, 1..=1000;
        /// Mean displacement of the points in an iteration below which the contour has converged.
        epsilon: f32 = 0.01, 0.001..=1.0, "px";
    }
    advanced { "gamma", "mu", "diffusions", "epsilon" }
    when {
        "mu": |p| p.force == External::Flow, "Regularisation has no effect on the gradient of the edge strength, which is not diffused.";
        "diffusions": |p| p.force == External::Flow,
            "Diffusion steps have no effect on the gradient of the edge strength, which is not diffused.";
    }
}

/// The energy of a contour by its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// α/2 Σ |v(i+1) − v(i)|².
    pub elastic: f64,
    /// β/2 Σ |v(i−1) − 2 v(i) + v(i+1)|².
    pub bending: f64,
    /// −κ Σ f(v(i)).
    pub external: f64,
    /// −p times the enclosed area.
    pub balloon: f64,
}

impl Energy {
    /// The sum.
    pub fn total(&self) -> f64 {
        self.elastic + self.bending + self.external + self.balloon
    }
}

/// The edges of a frame with the force that acts in it.
pub struct Field {
    edges: Edges,
    force: Force,
}

/// An iteration.
pub struct Iteration {
    /// Its number, from 1.
    number: usize,
    field: Arc<Field>,
    /// The points before it.
    before: Vec<Point>,
    /// The points after it.
    after: Vec<Point>,
    /// The mean displacement in px.
    moved: f64,
    has_converged: bool,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The edges around the contour, and its points.
    Edges(Arc<Field>, Arc<[Point]>),
    /// The force before and after its diffusion, and the points.
    Diffused([Arc<Field>; 2], Arc<[Point]>),
    /// An iteration.
    Iterated(Arc<Iteration>),
    /// The judgement of the fit.
    Judged(Arc<Field>, Arc<[Point]>, Verdict),
}

/// The points of a closed curve that lie `by` places after point `i`.
fn around<const N: usize>(points: &[Point], i: usize, by: [isize; N]) -> [Point; N] {
    by.map(|by| points[(i as isize + by).rem_euclid(points.len() as isize) as usize])
}

impl ActiveContour {
    fn energy(&self, iteration: &Iteration) -> Energy {
        let (edges, points) = (&iteration.field.edges, &iteration.after);
        let square = |d: Point| d[0] * d[0] + d[1] * d[1];
        let (mut elastic, mut bending, mut strength) = (0.0, 0.0, 0.0);
        for (i, at) in points.iter().enumerate() {
            let [before, after] = around(points, i, [-1, 1]);
            elastic += square([0, 1].map(|k| after[k] - at[k]));
            bending += square([0, 1].map(|k| before[k] - 2.0 * at[k] + after[k]));
            strength += f64::from(edges.strength_at(*at));
        }
        let area = polygon::area(points);
        Energy {
            elastic: f64::from(self.alpha) / 2.0 * elastic,
            bending: f64::from(self.beta) / 2.0 * bending,
            external: -f64::from(self.edge_weight) * strength,
            balloon: -f64::from(self.balloon) * area,
        }
    }

    /// The mean lengths of the internal force −A v and of the external force before an iteration, in 1/px.
    fn mean_forces(&self, iteration: &Iteration) -> [f64; 2] {
        let (points, mut forces) = (&iteration.before, Vec::new());
        self.forces(&iteration.field, points, &mut forces);
        let (alpha, beta) = (f64::from(self.alpha), f64::from(self.beta));
        let internal = |i: usize| {
            let [a, b, c, d, e] = around(points, i, [-2, -1, 0, 1, 2]);
            let along = |k: usize| {
                alpha * (2.0 * c[k] - b[k] - d[k]) + beta * (a[k] - 4.0 * b[k] + 6.0 * c[k] - 4.0 * d[k] + e[k])
            };
            along(0).hypot(along(1))
        };
        let count = points.len() as f64;
        let external: f64 = forces.iter().map(|force| force[0].hypot(force[1])).sum();
        [(0..points.len()).map(internal).sum::<f64>() / count, external / count]
    }

    /// The external force on each point: κ times that of the edges, and the pressure p ∂area/∂v.
    fn forces(&self, field: &Field, points: &[Point], forces: &mut Vec<Point>) {
        let (weight, pressure) = (f64::from(self.edge_weight), f64::from(self.balloon) / 2.0);
        let count = points.len();
        forces.clear();
        forces.extend((0..count).map(|i| {
            let (before, after) = (points[(i + count - 1) % count], points[(i + 1) % count]);
            let [x, y] = field.edges.force_at(&field.force, points[i]);
            [weight * x + pressure * (after[1] - before[1]), weight * y + pressure * (before[0] - after[0])]
        }));
    }

    /// Iterates until the contour converges; returns its points.
    fn minimize(&self, field: &Arc<Field>, mut points: Vec<Point>, observer: &mut impl Observer<Event>) -> Vec<Point> {
        let gamma = f64::from(self.gamma);
        let system = Pentadiagonal::new(points.len(), [self.alpha.into(), self.beta.into(), gamma]);
        let (mut forces, mut next) = (Vec::new(), points.clone());
        for number in 1..=self.iterations {
            self.forces(field, &points, &mut forces);
            for ((next, at), force) in next.iter_mut().zip(&points).zip(&forces) {
                *next = [0, 1].map(|k| gamma * at[k] + force[k]);
            }
            system.solve(&mut next);
            next.iter_mut().for_each(|at| *at = field.edges.nearest(*at));
            let moved = mean_distance(&points, &next);
            let has_converged = moved < f64::from(self.epsilon);
            observer.see(|| {
                Event::Iterated(Arc::new(Iteration {
                    number,
                    field: Arc::clone(field),
                    before: points.clone(),
                    after: next.clone(),
                    moved,
                    has_converged,
                }))
            });
            std::mem::swap(&mut points, &mut next);
            if has_converged {
                break;
            }
        }
        points
    }
}

fn mean_distance(before: &[Point], after: &[Point]) -> f64 {
    let each = before.iter().zip(after).map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1]));
    each.sum::<f64>() / before.len() as f64
}

pseudocode! {
    CHOOSE: "v ← contour of the object in the first frame; stop if there is no edge around it",
    EACH_FRAME: "for each frame t, from the contour v of frame t − 1, its points at equal distances",
    FIND_EDGES: "  f ← |∇(G_σ * I)| / its maximum in the window around v; F ← ∇f",
    DIFFUSE: "  if gradient vector flow: F ← g after steps g ← g + μ ∇²g − |∇f|² (g − ∇f) from g = ∇f, scaled",
    SOLVE: "  repeat: v ← (A + γ I)⁻¹ (γ v + κ F(v) + p ∂area/∂v), until the mean displacement < ε",
    JUDGE: "  lost if the mean f on v < min-edge-strength, or v has collapsed or crosses itself",
    MOVE: "  the mask is the inside of v, the region the box around it, unless the object is lost",
}

impl Fit for ActiveContour {
    const INFO: Info = Info {
        id: "active-contour",
        name: "Active contour",
        family: "Region tracking",
        summary: "Fits a closed curve to the edges of each frame: it minimises its elastic and bending energy and an external energy, which is \
                  low on edges.",
        source: "M. Kass, A. Witkin and D. Terzopoulos, Snakes: active contour models, IJCV 1(4), 1988; balloon force: L. D. Cohen, On active \
                 contour models and balloons, CVGIP 53(2), 1991; gradient vector flow: C. Xu and J. L. Prince, Snakes, shapes, and gradient \
                 vector flow, IEEE TIP 7(3), 1998",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::choice(
            "forces",
            "Which force is larger in the next iteration?",
            &[
                Reply::told(line::SOLVE, case::INTERNAL, "The internal one: elasticity and rigidity"),
                Reply::told(line::SOLVE, case::EXTERNAL, "The external one: the edges"),
            ],
        ),
        LOST,
    ];
    const CHARTS: &'static [Chart] = &[Chart::Series];
    const CONTRASTS: Option<&'static str> = Some("force");
    type Event = Event;

    fn snake(&self) -> &Snake {
        &self.snake
    }

    fn fit(
        &self,
        (frame, region): (&Frame, Region),
        before: &Arc<[Point]>,
        observer: &mut impl Observer<Event>,
    ) -> Model {
        let points = self.snake.resampled(before);
        let edges = self.snake.edges(frame, &points);
        let force = edges.force();
        let mut field = Arc::new(Field { edges, force });
        observer.see(|| Event::Edges(Arc::clone(&field), points.as_slice().into()));
        if self.force == External::Flow {
            let force = field.force.diffused(self.mu, self.diffusions);
            let diffused = Arc::new(Field { edges: field.edges.clone(), force });
            observer.see(|| Event::Diffused([Arc::clone(&field), Arc::clone(&diffused)], points.as_slice().into()));
            field = diffused;
        }
        let points = self.minimize(&field, points, observer);
        let verdict = self.snake.judge(&field.edges, &points);
        observer.see(|| Event::Judged(Arc::clone(&field), points.as_slice().into(), verdict));
        Model::of(frame.size(), (before, region), points, &verdict)
    }

    fn need(&self, clip: &Clip) -> Need {
        // Edges and forces, at most of the whole picture; in a walk the points of each iteration too.
        let steps = 64e3 * self.iterations as f64;
        Need::per_pixel(clip, [40.0, 80.0]).and([1e6, 1e6 + steps])
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Edges(..) => line::FIND_EDGES,
            Event::Diffused(..) => line::DIFFUSE,
            Event::Iterated(_) => line::SOLVE,
            Event::Judged(..) => line::JUDGE,
        }
    }
}
