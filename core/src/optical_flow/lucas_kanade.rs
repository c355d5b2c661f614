//! Lucas and Kanade's method: the displacement on which the pixels of a window agree best.

use std::sync::Arc;

use crate::differential::{Derivatives, Field, Given, Linear, Scheme, Sums, Tensor, Weights, Window, field, tell};
use crate::scene::{Fact, Math, Picture, Plane, Readout, Sentence, Shape};
use crate::{
    Clip, Confidence, DenseField, Error, Estimator, Flow, Grid, Info, Observer, Output, Progress, Promise, Role, Rung,
    Scene, Seen, Step, Threads, params,
};

params! {
    /// Lucas and Kanade's method for every pixel. Its system is Σ w Iₓ² u + Σ w Iₓ I_y v = −Σ w Iₓ Iₜ and
    /// Σ w Iₓ I_y u + Σ w I_y² v = −Σ w I_y Iₜ. Course notes that put Iₜ into the matrix are misprinted.
    pub struct LucasKanade {
        /// Side of the window around each pixel; an even one reaches as far as the next odd one.
        window: usize = 15, 3..=31, "px";
        /// How much the pixels of the window count.
        weights: Weights = Weights::Gaussian;
        /// Where the smaller eigenvalue of the structure tensor, in (gray levels per px)² for a pixel, is less, nothing is said.
        threshold: f32 = 0.5, 0.0..=100.0;
        /// How often the displacements are found; each time frame t+1 is first brought back by those of the time before.
        iterations: usize = 2, 1..=20;
        /// How derivatives are estimated from pixels.
        derivatives: Scheme = Scheme::FivePoint;
        /// Standard deviation of the Gaussian that smooths both frames first; 0 leaves them as they are.
        smoothing: f32 = 0.5, 0.0..=5.0, "px";
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    given: Arc<Given>,
    /// The constraints of the iteration at hand.
    linear: Arc<Linear>,
    iteration: usize,
    /// What was found in the iteration at hand, row by row.
    found: Vec<Solution>,
}

/// What a window says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// The displacement in px/frame; NaN where the window does not tell.
    displacement: [f32; 2],
    /// The eigenvalues of the structure tensor, the larger first.
    eigenvalues: [f32; 2],
}

/// What the gradients of a window are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Texture {
    /// Hardly any.
    Flat,
    /// All in one direction.
    Edge,
    /// In several directions.
    Corner,
}

/// The next pixel of the row has this solution.
pub type Event = Solution;

impl LucasKanade {
    fn window(&self) -> Window {
        self.weights.window(self.window / 2)
    }

    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let given = Arc::new(Given::new(clip, frame, self.smoothing, threads)?);
        let start = Field::new(given.size(), [0.0; 2]);
        let linear = Arc::new(self.linear(&given, start, threads));
        Ok(State { given, linear, iteration: 0, found: Vec::new() })
    }

    fn linear(&self, given: &Given, start: Field, threads: &Threads) -> Linear {
        let [current, next] = &given.pictures;
        Linear::about(start, [current, next], self.derivatives, threads)
    }

    fn texture(&self, [large, small]: [f32; 2]) -> Texture {
        match self.threshold {
            // Even without a threshold, two lines that are one do not cross.
            _ if small <= 1e-5 * large || small < self.threshold => {
                if large > 0.0 && large >= self.threshold {
                    Texture::Edge
                } else {
                    Texture::Flat
                }
            }
            _ => Texture::Corner,
        }
    }

    fn solve(&self, tensor: &Tensor) -> Solution {
        let eigenvalues = tensor.eigenvalues();
        let solution = tensor.solution();
        let is_told = self.texture(eigenvalues) == Texture::Corner && solution.iter().all(|c| c.is_finite());
        Solution { displacement: if is_told { solution } else { Flow::UNKNOWN }, eigenvalues }
    }

    /// Asks the windows of row `y`.
    fn row(
        &self,
        (of, window): (&Derivatives, &Window),
        y: usize,
        row: &mut [Solution],
        observer: &mut impl Observer<Event>,
    ) {
        window.row(of, y, &mut Sums::default(), |x, tensor| {
            row[x] = self.solve(&tensor);
            observer.see(|| row[x]);
        });
    }

    /// Goes on after the last row of an iteration.
    fn next_iteration(&self, state: &mut State, threads: &Threads) -> Progress {
        state.iteration += 1;
        if state.iteration == self.iterations {
            return Progress::Done;
        }
        // A pixel that nobody answered for is looked for where it was before.
        let (mut start, found) = (state.linear.start.clone(), std::mem::take(&mut state.found));
        let parts = start.u.cells_mut().iter_mut().zip(start.v.cells_mut());
        for ((u, v), Solution { displacement, .. }) in parts.zip(&found) {
            if displacement[0].is_finite() {
                [*u, *v] = *displacement;
            }
        }
        state.linear = Arc::new(self.linear(&state.given, start, threads));
        Progress::More
    }
}

const NOTHING: Solution = Solution { displacement: Flow::UNKNOWN, eigenvalues: [0.0; 2] };

impl State {
    /// The row that comes next.
    fn y(&self) -> usize {
        self.found.len() / self.given.size().0
    }

    /// What was found by now, with `more` of the next row; `None` where this iteration has not come yet.
    fn solutions(&self, more: &[Event]) -> Grid<Option<Solution>> {
        let (width, height) = self.given.size();
        let mut found = self.found.iter().chain(more).copied();
        Grid::from_fn(width, height, |_, _| found.next())
    }

    /// What was found by now; where this iteration has not come yet, what the one before found.
    fn flow(&self, more: &[Event]) -> Grid<[f32; 2]> {
        let solutions = self.solutions(more);
        let (width, height) = solutions.size();
        Grid::from_fn(width, height, |x, y| match solutions[(x, y)] {
            Some(solution) => solution.displacement,
            None if self.iteration > 0 => self.linear.start.at(x, y),
            None => Flow::UNKNOWN,
        })
    }
}

impl Estimator for LucasKanade {
    const INFO: Info = Info {
        id: "lucas-kanade",
        name: "Lucas–Kanade",
        family: "Optical flow",
        summary: "Finds for every pixel the displacement that fits the gradient constraints of a window best.",
        source: "B. D. Lucas and T. Kanade, An iterative image registration technique with an application to stereo vision, \
                 IJCAI 1981; uncertainty: E. P. Simoncelli, E. H. Adelson and D. J. Heeger, Probability distributions of \
                 optical flow, CVPR 1991",
        pseudocode: &[
            "(u, v) ← 0 for each pixel",
            "for each iteration",
            "  bring frame t+1 back along (u, v), take Iₓ, I_y, Iₜ",
            "  for each pixel, over the window around it",
            "    T ← Σ w (Iₓ², Iₓ I_y; Iₓ I_y, I_y²)",
            "    if the smaller eigenvalue of T < threshold, then unknown",
            "    else (u, v) ← −T⁻¹ Σ w (Iₓ Iₜ, I_y Iₜ)",
        ],
        rungs: &["frame", "iteration", "row", "pixel"],
        frames: 2,
    };
    const PROMISE: Promise = Promise::SubPixel { off_centi_px: 3 };
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (width, height) = state.given.size();
        let mut row = vec![NOTHING; width];
        self.row((&state.linear.factors, &self.window()), state.y(), &mut row, observer);
        state.found.extend(row);
        if state.y() < height {
            return Ok(Progress::More);
        }
        Ok(self.next_iteration(state, &Threads::single()))
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(self.iterations * state.given.size().1)
    }

    fn place(&self, state: &State) -> Vec<Rung> {
        let rung = |index, of| Rung { index, of: Some(of) };
        vec![rung(0, 1), rung(state.iteration, self.iterations), rung(state.y(), state.given.size().1)]
    }

    fn unit_at(&self, state: &State, point: [f32; 2]) -> Option<usize> {
        let iteration = state.iteration.min(self.iterations - 1);
        state.given.pixel_at(point).map(|(_, y)| iteration * state.given.size().1 + y)
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.found[..])
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let Some(looked) = self.look(seen) else {
            let sentence = "One pixel says too little, so those of a window are asked together: T (u, v) = −Σ w ∇I Iₜ, where \
                            T holds the products of Iₓ and I_y alone. Where course notes put Iₜ into the matrix, that is a \
                            misprint.";
            return Step { line: 0, sentence: Sentence::default().text(sentence), readouts: Vec::new() };
        };
        let is_told = looked.solution.displacement[0].is_finite();
        Step {
            line: if is_told { 6 } else { 5 },
            sentence: self.sentence(&looked),
            readouts: self.readouts(seen, &looked),
        }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        self.draw_textures(seen, scene);
        let Some(looked) = self.look(seen) else { return };
        let ([x, y], reach) = (looked.pixel.map(|c| c as i32), self.window as i32 / 2);
        let side = 2 * reach as usize + 1;
        scene.mark(Picture::Current, Role::Window, Shape::pixels(x - reach, y - reach, side, side));
        scene.legend(Role::Window, "window");
        scene.mark(Picture::Current, Role::Reference, Shape::pixels(x, y, 1, 1));
        scene.legend(Role::Reference, "pixel");
        if let Some(spread) = looked.spread {
            let center = [x as f32 + spread.center[0], y as f32 + spread.center[1]];
            let shape = Shape::Ellipse { center, radii: spread.radii, angle_rad: spread.angle_rad };
            scene.mark(Picture::Current, Role::Measured, shape);
            scene.legend(Role::Measured, "one standard deviation");
        }
    }

    fn output(&self, state: &State) -> Output {
        let smaller = state.solutions(&[]).map(|solution| solution.map_or(0.0, |solution| solution.eigenvalues[1]));
        let confidence = Some(Confidence { name: "smaller_eigenvalue", values: smaller });
        Output::Dense(DenseField { flow: Flow(state.flow(&[])), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let ((width, height), window) = (state.given.size(), self.window());
        loop {
            let mut found = Grid::new(width, height, NOTHING);
            threads.rows(&mut found, |y, row| self.row((&state.linear.factors, &window), y, row, &mut ()));
            state.found = found.into_cells();
            if self.next_iteration(&mut state, threads) == Progress::Done {
                return Ok(state);
            }
        }
    }
}

/// The pixel that is explained, the one pointed at or else the one at work, and what its window says.
struct Looked {
    pixel: [usize; 2],
    tensor: Tensor,
    solution: Solution,
    spread: Option<crate::scene::Spread>,
}

impl LucasKanade {
    fn look(&self, seen: &Seen<Self>) -> Option<Looked> {
        let state = seen.before;
        let last = seen.events.len().checked_sub(1)?;
        let pointed_at = seen.focus.and_then(|point| state.given.pixel_at(point));
        let (x, y) = pointed_at.unwrap_or((last, state.y()));
        let mut tensor = Tensor::default();
        self.window().row(&state.linear.factors, y, &mut Sums::default(), |at, found| {
            if at == x {
                tensor = found;
            }
        });
        let solution = self.solve(&tensor);
        let spread = tensor.spread(solution.displacement);
        Some(Looked { pixel: [x, y], tensor, solution, spread })
    }

    fn sentence(&self, looked: &Looked) -> Sentence {
        let Looked { pixel: [x, y], solution: Solution { displacement, eigenvalues }, .. } = *looked;
        let [large, small] = eigenvalues.map(tell::number);
        let said = Sentence::default().text("Around ").ink(Role::Reference, format!("pixel ({x}, {y})"));
        let threshold = tell::number(self.threshold);
        match self.texture(eigenvalues) {
            Texture::Flat => said.text(format!(
                " there is hardly any gradient: both eigenvalues, {large} and {small}, are below the threshold of \
                 {threshold}. The window says nothing."
            )),
            Texture::Edge => said.text(format!(
                " all gradients point the same way: one eigenvalue is {large}, but the other {small}, below the threshold of \
                 {threshold}. The lines of the window are nearly one, and cross nowhere for certain."
            )),
            Texture::Corner => said
                .text(format!(
                    " gradients point in several directions: the eigenvalues are {large} and {small}. The lines of the \
                     window cross near "
                ))
                .ink(Role::Result, format!("{} px", tell::vector(displacement)))
                .text(", which fits them best in the mean square."),
        }
    }

    fn readouts(&self, seen: &Seen<Self>, looked: &Looked) -> Vec<Readout> {
        let (state, Looked { pixel: [x, y], tensor, solution, spread }) = (seen.before, looked);
        let place = (*x, *y);
        let fact = |label, value, role| Fact { label, value, role };
        let truth = state.given.true_displacement(place);
        let [large, small] = solution.eigenvalues.map(tell::number);
        let texture = match self.texture(solution.eigenvalues) {
            Texture::Flat => "flat",
            Texture::Edge => "edge",
            Texture::Corner => "corner",
        };
        let mut facts = vec![
            fact("Pixel", format!("({x}, {y})"), Some(Role::Reference)),
            fact("Eigenvalues", format!("{large} and {small}: {texture}"), None),
        ];
        let is_told = solution.displacement[0].is_finite();
        if is_told {
            let off = tell::number(tensor.residual(solution.displacement).sqrt());
            facts.push(fact("Displacement", format!("{} px", tell::vector(solution.displacement)), Some(Role::Result)));
            facts.push(fact("Constraints off by", format!("{off} gray levels (root mean square)"), None));
        }
        if let Some(spread) = spread {
            let [a, b] = spread.radii.map(tell::number);
            facts.push(fact("Standard deviation", format!("{a} to {b} px"), Some(Role::Measured)));
        }
        facts.extend(truth.map(|truth| fact("Truth", format!("{} px", tell::vector(truth)), Some(Role::Truth))));
        let mut points = vec![("zero", Role::Reference, [0.0; 2])];
        points.extend(is_told.then_some(("displacement", Role::Result, solution.displacement)));
        points.extend(truth.map(|truth| ("truth", Role::Truth, truth)));
        let plane = Plane {
            title: "Gradient constraints of the window",
            reach: tell::reach(points.iter().map(|(.., point)| *point)),
            lines: self.lines(&state.linear.factors, place),
            points,
            ellipse: *spread,
        };
        let [current, next] = &state.given.pictures;
        let radius = (self.window / 2).min(5);
        vec![
            Readout::Facts(facts),
            Readout::Equation(equation(tensor, is_told.then_some(solution.displacement))),
            Readout::Plane(plane),
            Readout::Tiles(state.linear.factors.tiles([current, next], place, radius)),
        ]
    }

    /// The lines of the window's pixels, of a large one only of every few; the more a pixel counts, the stronger.
    fn lines(&self, of: &Derivatives, (x, y): (usize, usize)) -> Vec<crate::scene::Constraint> {
        let (window, reach) = (self.window(), self.window as isize / 2);
        let step = self.window / 12 + 1;
        let along = || (-reach..=reach).step_by(step);
        let pixels = along().flat_map(|j| along().map(move |i| [i, j])).filter_map(|[i, j]| {
            let place = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
            of.x.get(place.0, place.1)?;
            let [a, b, c] = of.at(place);
            Some(([a, b, c], window.weight([i, j]) * a.hypot(b)))
        });
        let pixels: Vec<_> = pixels.collect();
        let most = pixels.iter().fold(f32::MIN_POSITIVE, |most, (_, weight)| most.max(*weight));
        let line = |(factors, weight)| tell::line(factors, weight / most, Role::Candidate);
        pixels.into_iter().filter_map(line).collect()
    }

    /// Where windows say nothing: at the places where arrows would stand.
    fn draw_textures(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let solutions = seen.before.solutions(seen.events);
        let spacing = field::arrow_spacing(solutions.size());
        let along = |extent: usize| (spacing / 2..extent).step_by(spacing);
        let places: Vec<_> =
            along(solutions.height()).flat_map(|y| along(solutions.width()).map(move |x| (x, y))).collect();
        for (texture, role, meaning) in [
            (Texture::Edge, Role::Rejected, "edge: only the motion across it is seen"),
            (Texture::Flat, Role::Predicted, "flat: no motion is seen"),
        ] {
            let is_so = |place: &&(usize, usize)| {
                solutions[**place].is_some_and(|solution| self.texture(solution.eigenvalues) == texture)
            };
            let points: Vec<_> = places.iter().filter(is_so).map(|(x, y)| [*x as f32, *y as f32]).collect();
            if !points.is_empty() {
                scene.mark(Picture::Current, role, Shape::Points(points));
                scene.legend(role, meaning);
            }
        }
    }
}

/// The two equations of the window, in symbols and with its means.
fn equation(tensor: &Tensor, found: Option<[f32; 2]>) -> Vec<Math> {
    let sum = |a: &'static str, b: &'static str| {
        let product = match a == b {
            true => vec![Math::power(tell::derivative(a), Math::text("2"))],
            false => vec![tell::derivative(a), tell::derivative(b)],
        };
        Math::Row([vec![Math::text("Σ "), Math::Var("w"), Math::text(" ")], product].concat())
    };
    let symbols = |along: &'static str, [first, second]: [&'static str; 2]| {
        Math::Row(vec![
            sum(along.min(first), along.max(first)),
            Math::text(" "),
            Math::Var("u"),
            Math::text(" + "),
            sum(along.min(second), along.max(second)),
            Math::text(" "),
            Math::Var("v"),
            Math::text(" = − "),
            sum(along, "t"),
        ])
    };
    let numbers = |a: f32, b: f32, c: f32| {
        Math::Row(vec![
            Math::ink(Role::Reference, tell::number(a)),
            Math::text(" "),
            Math::Var("u"),
            Math::text(" "),
            Math::ink(Role::Reference, tell::plus(b)),
            Math::text(" "),
            Math::Var("v"),
            Math::text(" = "),
            Math::ink(Role::Reference, tell::number(-c)),
        ])
    };
    let mut lines = vec![
        symbols("x", ["x", "y"]),
        symbols("y", ["x", "y"]),
        numbers(tensor.xx, tensor.xy, tensor.xt),
        numbers(tensor.xy, tensor.yy, tensor.yt),
    ];
    lines.extend(found.map(|found| {
        let left = [Math::text("("), Math::Var("u"), Math::text(", "), Math::Var("v"), Math::text(") = ")];
        Math::Row([left.to_vec(), vec![Math::ink(Role::Result, tell::vector(found))]].concat())
    }));
    lines
}
