//! The greedy active contour: one point after the other moves to the pixel of its neighbourhood with the lowest energy.

mod curve;
mod explain;

use std::sync::Arc;

use crate::base::Observer;
use crate::data::{Clip, Frame};
use crate::methods::contour::{Edges, Fit, Model, Point, Snake, Verdict};
use crate::methods::region::{LOST, WHERE};
use crate::products::Region;
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question, Reply};
use crate::{params, pseudocode};

use curve::{Curve, Site, apart};
use explain::case;

params! {
    /// Greedy active contour.
    pub struct GreedyContour {
        /// Start, points and edges.
        snake: Snake = Snake::default();
        /// Weight α of the continuity energy, which keeps the points at equal distances.
        alpha: f32 = 1.0, 0.0..=10.0;
        /// Weight β of the curvature energy, which keeps the contour smooth, and 0 at corners.
        beta: f32 = 1.0, 0.0..=10.0;
        /// Weight κ of the edge energy.
        edge_weight: f32 = 1.2, 0.0..=10.0;
        /// Radius r of the neighbourhood of (2r + 1)×(2r + 1) pixels that a point can move to.
        radius: usize = 1, 1..=3, "px";
        /// Squared length of the change of direction at a point above which it is a corner, if it lies on an edge: 0.25 is 29°.
        corner_turn: f32 = 0.25, 0.0..=4.0;
        /// Edge strength from which a point of high curvature is a corner.
        corner_edge: f32 = 0.4, 0.0..=1.0;
        /// Number of points that move in an iteration at most when the contour has converged.
        max_moved: usize = 2, 0..=100;
        /// Maximum number of iterations in a frame.
        iterations: usize = 50, 1..=200;
    }
    advanced { "corner-turn", "corner-edge", "max-moved" }
}

/// The smallest range of edge strengths in a neighbourhood that the edge energy is relative to.
const LEAST_STRENGTH_RANGE: f64 = 5.0 / 255.0;

/// The energies of a pixel in the neighbourhood of a point, each normalised over the neighbourhood.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Continuity: 0 to 1.
    pub continuity: f64,
    /// Curvature: 0 to 1.
    pub curvature: f64,
    /// Edge: −1 to 0.
    pub edge: f64,
    /// The weighted sum.
    pub total: f64,
}

impl Terms {
    fn add(&mut self, of: &Self) {
        self.continuity += of.continuity;
        self.curvature += of.curvature;
        self.edge += of.edge;
        self.total += of.total;
    }
}

/// A point that is moved or stays.
#[derive(Clone)]
pub struct Test {
    /// Number of the iteration, from 1.
    iteration: usize,
    /// Its index.
    index: usize,
    edges: Arc<Edges>,
    site: Site,
    /// The pixel with the lowest energy, as an index of its neighbourhood.
    best: usize,
}

/// The end of an iteration.
pub struct Pass {
    /// Its number, from 1.
    number: usize,
    edges: Arc<Edges>,
    points: Vec<Point>,
    /// Number of points that moved.
    moved: usize,
    /// The mean distance of neighbouring points in px.
    distance: f64,
    /// The indices of the corners.
    corners: Vec<usize>,
    /// The energies at the pixels that were chosen, summed over all points.
    sums: Terms,
    has_converged: bool,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The edges around the contour, and its points.
    Edges(Arc<Edges>, Arc<[Point]>),
    /// A point that is moved or stays.
    Tested(Test),
    /// The end of an iteration.
    Passed(Arc<Pass>),
    /// The judgement of the fit.
    Judged(Arc<Edges>, Arc<[Point]>, Verdict),
}

impl GreedyContour {
    /// The weighted energies with their sum; rigidity does not act at corners.
    fn weighted(&self, of: Terms, is_corner: bool) -> Terms {
        let continuity = f64::from(self.alpha) * of.continuity;
        let curvature = if is_corner { 0.0 } else { f64::from(self.beta) * of.curvature };
        let edge = f64::from(self.edge_weight) * of.edge;
        Terms { continuity, curvature, edge, total: continuity + curvature + edge }
    }

    /// The places of the neighbourhood of a point, row by row.
    fn places(&self, at: Point) -> impl Iterator<Item = Point> {
        let reach = self.radius as isize;
        (-reach..=reach).flat_map(move |y| (-reach..=reach).map(move |x| [at[0] + x as f64, at[1] + y as f64]))
    }

    /// Place `index` of the neighbourhood of a point.
    fn place(&self, at: Point, index: usize) -> Point {
        self.places(at).nth(index).unwrap_or(at)
    }

    /// Computes the energies of the neighbourhood of a point, row by row, without those outside the window; returns the index of the pixel
    /// with the lowest, the present one in a tie.
    fn test(&self, edges: &Edges, site: &Site, terms: &mut Vec<Option<Terms>>) -> usize {
        let Site { at, neighbors: [before, after], distance, is_corner } = *site;
        terms.clear();
        terms.extend(self.places(at).map(|place| {
            (edges.nearest(place) == place).then(|| Terms {
                continuity: (distance - apart(before, place)).abs(),
                curvature: [0, 1].map(|k| (before[k] - 2.0 * place[k] + after[k]).powi(2)).iter().sum(),
                edge: edges.strength_at(place).into(),
                total: 0.0,
            })
        }));
        let range = |of: fn(&Terms) -> f64| {
            terms.iter().flatten().map(of).fold([f64::INFINITY, 0.0], |[low, high], v| [low.min(v), f64::max(high, v)])
        };
        let ([_, farthest], [_, bent]) = (range(|of| of.continuity), range(|of| of.curvature));
        let [low, high] = range(|of| of.edge);
        let low = low.min(high - LEAST_STRENGTH_RANGE);
        let share = |value: f64, most: f64| if most > 0.0 { value / most } else { 0.0 };
        for of in terms.iter_mut().flatten() {
            *of = Terms {
                continuity: share(of.continuity, farthest),
                curvature: share(of.curvature, bent),
                edge: (low - of.edge) / (high - low),
                total: 0.0,
            };
            of.total = self.weighted(*of, is_corner).total;
        }
        let present = terms.len() / 2;
        let total = |i: usize| terms[i].map_or(f64::INFINITY, |of| of.total);
        (0..terms.len()).fold(present, |best, i| if total(i) < total(best) { i } else { best })
    }

    /// Moves each point once, the first twice; returns the number that moved and the sums of the energies.
    fn pass(
        &self,
        (curve, iteration): (&mut Curve<'_>, usize),
        edges: &Arc<Edges>,
        observer: &mut impl Observer<Event>,
    ) -> (usize, Terms) {
        let (count, mut terms) = (curve.points.len(), Vec::new());
        let (mut moved, mut sums) = (0, Terms::default());
        // The first point is repeated as the last, so that no point is special.
        for (visit, index) in (0..count).chain([0]).enumerate() {
            let site = curve.site(index);
            let best = self.test(curve.edges, &site, &mut terms);
            observer.see(|| Event::Tested(Test { iteration, index, edges: Arc::clone(edges), site, best }));
            // The energy of the first point counts once, at its final place.
            if visit > 0 {
                sums.add(&self.weighted(terms[best].unwrap_or_default(), site.is_corner));
            }
            if best != terms.len() / 2 {
                curve.points[index] = self.place(site.at, best);
                moved += 1;
            }
        }
        (moved, sums)
    }

    /// Finds the corners: points of the largest change of direction among their neighbours that lie on an edge.
    fn find_corners(&self, curve: &mut Curve<'_>) {
        let count = curve.points.len();
        let turns: Vec<f64> = (0..count).map(|index| curve.turn(index)).collect();
        curve.is_corner = (0..count)
            .map(|i| {
                let turn = turns[i];
                turn > turns[(i + count - 1) % count]
                    && turn > turns[(i + 1) % count]
                    && turn > f64::from(self.corner_turn)
                    && curve.edges.strength_at(curve.points[i]) >= self.corner_edge
            })
            .collect();
    }

    /// Iterates until few points move; returns the points.
    fn minimize(&self, edges: &Arc<Edges>, points: Vec<Point>, observer: &mut impl Observer<Event>) -> Vec<Point> {
        let is_corner = vec![false; points.len()];
        let mut curve = Curve { edges, points, is_corner, distance: 0.0 };
        curve.distance = curve.mean_distance();
        for number in 1..=self.iterations {
            let (moved, sums) = self.pass((&mut curve, number), edges, observer);
            let has_converged = moved <= self.max_moved;
            self.find_corners(&mut curve);
            curve.distance = curve.mean_distance();
            observer.see(|| {
                Event::Passed(Arc::new(Pass {
                    number,
                    edges: Arc::clone(edges),
                    points: curve.points.clone(),
                    moved,
                    distance: curve.distance,
                    corners: (0..curve.points.len()).filter(|i| curve.is_corner[*i]).collect(),
                    sums,
                    has_converged,
                }))
            });
            if has_converged {
                break;
            }
        }
        curve.points
    }
}

pseudocode! {
    CHOOSE: "v ← contour of the object in the first frame; stop if there is no edge around it",
    EACH_FRAME: "for each frame t, from the contour v of frame t − 1, its points on pixels at equal distances",
    FIND_EDGES: "  f ← |∇(G_σ * I)| / its maximum in the window around v",
    EACH_PASS: "  repeat, until at most max-moved points move",
    MOVE_POINT: "    for each point i: v_i ← the pixel of its neighbourhood with the lowest α E_cont + β_i E_curv + κ E_edge",
    FIND_CORNERS: "    β_i ← 0 where the direction changes most and f is high, else β; d ← mean distance of the points",
    JUDGE: "  lost if the mean f on v < min-edge-strength, or v has collapsed or crosses itself",
    MOVE: "  the mask is the inside of v, the region the box around it, unless the object is lost",
}

impl Fit for GreedyContour {
    const INFO: Info = Info {
        id: "greedy-contour",
        name: "Greedy active contour",
        family: "Region tracking",
        summary: "Moves one point of a closed curve after the other to the neighbouring pixel with the lowest energy of continuity, curvature and \
                  edge strength.",
        source: "D. J. Williams and M. Shah, A fast algorithm for active contours and curvature estimation, CVGIP: Image Understanding 55(1), \
                 1992",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::choice(
            "moves",
            "Does the next point move?",
            &[
                Reply::told(line::MOVE_POINT, case::MOVES, "Yes"),
                Reply::told(line::MOVE_POINT, case::STAYS, "No: its pixel has the lowest energy"),
            ],
        ),
        LOST,
    ];
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
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
        let edges = Arc::new(self.snake.edges(frame, &points));
        // Points lie on pixels, which are compared with each other.
        let points: Vec<Point> = points.into_iter().map(|at| edges.nearest(at.map(f64::round))).collect();
        observer.see(|| Event::Edges(Arc::clone(&edges), points.as_slice().into()));
        let points = self.minimize(&edges, points, observer);
        let verdict = self.snake.judge(&edges, &points);
        observer.see(|| Event::Judged(Arc::clone(&edges), points.as_slice().into(), verdict));
        Model::of(frame.size(), (before, region), points, &verdict)
    }

    fn need(&self, clip: &Clip) -> Need {
        // Edges, at most of the whole picture; in a walk the points that are tested too.
        let steps = 64e3 * self.iterations as f64;
        Need::per_pixel(clip, [24.0, 40.0]).and([1e6, 1e6 + steps])
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Edges(..) => line::FIND_EDGES,
            Event::Tested(_) => line::MOVE_POINT,
            Event::Passed(_) => line::FIND_CORNERS,
            Event::Judged(..) => line::JUDGE,
        }
    }
}
