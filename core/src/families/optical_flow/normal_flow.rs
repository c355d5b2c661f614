//! Normal flow: what a single pixel says about its motion.
//!
//! ```text
//!     v
//!     ↑   ╲  I_x u + I_y v + I_t = 0
//!     │    ╲        every (u, v) on the line explains what the pixel sees;
//!     │   ↗ ╲       the shortest of them lies along the gradient: the normal flow
//!     └──────╲──→ u
//! ```

use std::sync::Arc;

use crate::base::{Error, Observer, Threads, words};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::differential::{Derivatives, FLAT, Given, Scheme, explain, field};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{Chart, Fact, Focus, Math, Picture, Plane, Readout, Role, Scene, Sentence, Shape, Step};
use crate::{params, pseudocode};

params! {
    /// Normal flow: the part of the motion along the gradient, which is all that one pixel can tell.
    pub struct NormalFlow {
        /// How derivatives are estimated from pixels.
        derivatives: Scheme = Scheme::Central;
        /// Standard deviation of the Gaussian that smooths both frames first; 0 leaves them as they are.
        smoothing: f32 = 1.0, 0.0..=5.0, "px";
        /// Where the gradient is smaller, in gray levels per px, nothing is said: noise would decide.
        threshold: f32 = 3.0, 0.0..=50.0;
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// The displacements of the rows that are done.
    found: Vec<[f32; 2]>,
}

/// What stays the same all along.
struct Fixed {
    given: Given,
    derivatives: Derivatives,
}

/// The next pixel of the row has this displacement; NaN where nothing is said.
pub type Event = [f32; 2];

impl NormalFlow {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let given = Given::new(clip, frame, self.smoothing, threads)?;
        let derivatives = self.derivatives.of(&given.pictures[0], &given.pictures[1], threads);
        Ok(State { fixed: Arc::new(Fixed { given, derivatives }), found: Vec::new() })
    }

    /// The point of the line a u + b v + c = 0 that is nearest to zero, if the gradient (a, b) is large enough.
    #[inline(always)]
    fn nearest(&self, [a, b, c]: [f32; 3]) -> [f32; 2] {
        let squared = a * a + b * b;
        if squared > FLAT && squared >= self.threshold * self.threshold {
            [-c * a / squared, -c * b / squared]
        } else {
            Flow::UNKNOWN
        }
    }

    /// Works out the displacements of row `y`.
    fn row(&self, of: &Derivatives, y: usize, row: &mut [[f32; 2]], observer: &mut impl Observer<Event>) {
        let gradients = of.x.row(y).iter().zip(of.y.row(y));
        for (found, ((&a, &b), &c)) in row.iter_mut().zip(gradients.zip(of.t.row(y))) {
            *found = self.nearest([a, b, c]);
            observer.see(|| *found);
        }
    }
}

impl State {
    fn width(&self) -> usize {
        self.fixed.given.size().0
    }

    /// The row that comes next.
    fn y(&self) -> usize {
        self.found.len() / self.width()
    }

    /// What was found by now, with `more` of the next row.
    fn flow(&self, more: &[Event]) -> Grid<[f32; 2]> {
        let (width, height) = self.fixed.given.size();
        let mut flow = Grid::new(width, height, Flow::UNKNOWN);
        let (done, rest) = flow.cells_mut().split_at_mut(self.found.len());
        done.copy_from_slice(&self.found);
        rest[..more.len()].copy_from_slice(more);
        flow
    }
}

pseudocode! {
    TAKE_DERIVATIVES: "smooth both frames; I_x, I_y ← derivatives of their mean; I_t ← their difference",
    EACH_PIXEL: "for each pixel, whose gradient constraint I_x u + I_y v + I_t = 0 is a line in (u, v)",
    IS_FLAT: "  if |∇I| < threshold, then nothing can be said",
    TAKE_NEAREST: "  else (u, v) ← the point of the line nearest to (0, 0)",
}

impl Estimator for NormalFlow {
    const INFO: Info = Info {
        id: "normal-flow",
        name: "Normal flow",
        family: "Optical flow",
        summary: "Takes from every pixel what it can tell alone: the motion along its gradient.",
        source: "C. L. Fennema and W. B. Thompson, Velocity determination in scenes containing several moving objects, \
                 Computer Graphics and Image Processing 9(4), 1979; aperture problem: S. Ullman, The Interpretation of \
                 Visual Motion, MIT Press 1979",
        pseudocode: line::ALL,
        granularities: &["frame", "row", "pixel"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::AlongGradient;
    const TELLS_CONFIDENCE: bool = true;
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[DenseField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let mut row = vec![Flow::UNKNOWN; state.width()];
        self.row(&state.fixed.derivatives, state.y(), &mut row, observer);
        state.found.extend(row);
        Ok(if state.y() == state.fixed.given.size().1 { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.fixed.given.size().1)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.y(), of: self.units(state) }]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let Some(pixel) = pixel(seen) else {
            let sentence = "Both frames are smoothed and their derivatives taken. Each pixel is asked by itself.";
            return Step {
                line: line::TAKE_DERIVATIVES,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let of = &seen.before.fixed.derivatives;
        let found = self.nearest(of.at(pixel));
        let is_known = found[0].is_finite();
        Step {
            line: if is_known { line::TAKE_NEAREST } else { line::IS_FLAT },
            sentence: self.sentence(pixel, of.at(pixel), found),
            readouts: self.readouts(&seen.before.fixed, pixel, found),
        }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        if let Some((x, y)) = pixel(seen) {
            scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
            scene.legend(Role::Reference, "pixel");
        }
    }

    fn output(&self, state: &State) -> Output {
        let Derivatives { x, y, .. } = &state.fixed.derivatives;
        let mut values = x.clone();
        for (value, &y) in values.cells_mut().iter_mut().zip(y.cells()) {
            // What hypot gives, in a loop that becomes vector instructions.
            *value = (f64::from(*value).powi(2) + f64::from(y).powi(2)).sqrt() as f32;
        }
        let confidence = Some(Confidence { name: "gradient", values });
        Output::of(DenseField { flow: Flow(state.flow(&[])), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        clip.wanted()?;
        let (width, height) = state.fixed.given.size();
        let mut flow = Grid::new(width, height, [0.0; 2]);
        threads.rows(&mut flow, |y, row| self.row(&state.fixed.derivatives, y, row, &mut ()));
        state.found = flow.into_cells();
        Ok(state)
    }
}

impl Footprint<State> for NormalFlow {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [44.0, 100.0])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.found[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let Fixed { given, derivatives } = &*state.fixed;
        self.state_bytes(state) + given.bytes() + derivatives.bytes()
    }
}

impl Pointed<State> for NormalFlow {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.fixed.given.pixel_at(point).map(|(_, y)| y)
    }

    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let (x, y) = state.fixed.given.pixel_at(point)?;
        Some(Explained::From(Cursor { unit: y, event: x + 1 }))
    }
}

/// The pixel that is explained: the one pointed at, else the one at work.
fn pixel(seen: &Seen<NormalFlow>) -> Option<(usize, usize)> {
    let last = seen.events.len().checked_sub(1)?;
    let pointed_at = seen.point().and_then(|point| seen.before.fixed.given.pixel_at(point));
    Some(pointed_at.unwrap_or((last, seen.before.y())))
}

impl NormalFlow {
    fn sentence(&self, (x, y): (usize, usize), [a, b, c]: [f32; 3], found: [f32; 2]) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, format!("Pixel ({x}, {y})"));
        let size = words::number(a.hypot(b));
        if !found[0].is_finite() {
            let why = match a.hypot(b) < self.threshold {
                true => format!("below the threshold of {}", words::number(self.threshold)),
                false => "which is but rounding".into(),
            };
            return said.text(format!(" has a gradient of {size} gray levels per px, {why}: it says nothing."));
        }
        let change = match words::number(c.abs()) {
            none if none.chars().all(|digit| "0.".contains(digit)) => "stays as bright from frame to frame".to_owned(),
            by => format!("grows {} by {by} per frame", if c > 0.0 { "brighter" } else { "darker" }),
        };
        said.text(format!(" is brighter by {size} gray levels for each px along its gradient, and {change}"))
            .text(": the pattern moves by ")
        .ink(Role::Result, format!("{} px", words::vector(found)))
        .text(" across the edge. How far it moves along the edge cannot be seen through one pixel (aperture problem).")
    }

    fn readouts(&self, Fixed { given, derivatives }: &Fixed, pixel: (usize, usize), found: [f32; 2]) -> Vec<Readout> {
        let factors = derivatives.at(pixel);
        let truth = given.true_displacement(pixel);
        let is_known = found[0].is_finite();
        let fact = |label, value, role| Fact { label, value, role };
        let mut facts = vec![
            fact("Pixel", format!("({}, {})", pixel.0, pixel.1), Some(Role::Reference)),
            derivatives.fact(pixel),
            fact("Gradient", format!("{} gray levels per px", words::number(factors[0].hypot(factors[1]))), None),
        ];
        if is_known {
            facts.push(fact("Normal flow", format!("{} px", words::vector(found)), Some(Role::Result)));
        }
        facts.extend(truth.map(|truth| fact("Truth", format!("{} px", words::vector(truth)), Some(Role::Truth))));
        let mut equation = explain::constraint_equation(factors, Role::Reference).to_vec();
        if is_known {
            equation.push(nearest_equation(found));
        }
        let mut points = vec![("zero", Role::Reference, [0.0; 2])];
        points.extend(is_known.then_some(("normal flow", Role::Result, found)));
        points.extend(truth.map(|truth| ("truth", Role::Truth, truth)));
        let plane = Plane {
            title: "Gradient constraint",
            unit: "px".into(),
            reach: explain::reach(points.iter().map(|(.., point)| *point)),
            lines: explain::line(factors, 1.0, Role::Candidate).into_iter().collect(),
            points,
            ellipse: None,
        };
        let [current, next] = &given.pictures;
        vec![
            Readout::Facts(facts),
            Readout::Equation(equation),
            Readout::Plane(plane),
            Readout::Tiles(derivatives.tiles([current, next], pixel, 3)),
        ]
    }
}

/// (u, v) = −I_t ∇I / |∇I|², and what it is here.
fn nearest_equation(found: [f32; 2]) -> Math {
    let gradient = || Math::Row(vec![Math::text("∇"), Math::Var("I")]);
    let top = Math::Row(vec![explain::derivative("t"), Math::text(" "), gradient()]);
    let bottom = Math::power(Math::Abs(Box::new(gradient())), Math::text("2"));
    Math::Row(vec![
        Math::text("("),
        Math::Var("u"),
        Math::text(", "),
        Math::Var("v"),
        Math::text(") = − "),
        Math::Frac(Box::new(top), Box::new(bottom)),
        Math::text(" = "),
        Math::ink(Role::Result, words::vector(found)),
    ])
}
