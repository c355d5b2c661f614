//! Normal flow: the flow component along the gradient, from single pixels.
//!
//! ```text
//!     v
//!     ↑   ╲  I_x u + I_y v + I_t = 0
//!     │    ╲        every (u, v) on the constraint line satisfies brightness constancy;
//!     │   ↗ ╲       the shortest lies along the gradient: the normal flow
//!     └──────╲──→ u
//! ```

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads, words};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::differential::{Advice, Conclusion, Derivatives, FLAT, FramePair, Scheme, explain, field, numbers};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{
    Case, Chart, Fact, Focus, Math, Picture, Plane, Question, Readout, Role, Scene, Sentence, Shape, Step,
};
use crate::{params, pseudocode};

params! {
    /// Normal flow: the flow component along the gradient, which a single pixel determines (aperture problem).
    pub struct NormalFlow {
        /// Kernel that estimates the derivatives I_x and I_y.
        derivatives: Scheme = Scheme::Central;
        /// Standard deviation σ of the Gaussian that smooths both frames before derivatives are taken. 0 does not smooth.
        sigma: f32 = 1.0, 0.0..=5.0, "px";
        /// Smallest gradient magnitude |∇I| with flow, in gray levels per px. Higher values suppress noise but leave more pixels without flow.
        min_gradient: f32 = 3.0, 0.0..=50.0;
    }
    renamed { "smoothing" => "sigma", "threshold" => "min-gradient" }
}

/// What would help where normal flow fails.
const ADVICE: Advice = Advice {
    texture: "Lucas–Kanade combines the constraints of a window and finds both components where their gradients differ.",
    boundary: "The temporal derivative mixes both motions there; a smaller sigma mixes less.",
    motion: "A pyramid, as in Horn–Schunck with several levels, would reach this motion.",
};

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// The flow of the completed rows.
    found: Vec<[f32; 2]>,
}

/// The constant part of a run.
struct Fixed {
    frame_pair: FramePair,
    derivatives: Derivatives,
}

/// The normal flow of the next pixel of the row; NaN below the threshold.
pub type Event = [f32; 2];

impl NormalFlow {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let frame_pair = FramePair::new(clip, frame, self.sigma, threads)?;
        let derivatives = self.derivatives.of(&frame_pair.pictures[0], &frame_pair.pictures[1], threads);
        Ok(State { fixed: Arc::new(Fixed { frame_pair, derivatives }), found: Vec::new() })
    }

    /// Returns the point of the line a u + b v + c = 0 nearest to the origin, if the gradient (a, b) is large enough.
    #[inline(always)]
    fn nearest(&self, [a, b, c]: [f32; 3]) -> [f32; 2] {
        let squared = a * a + b * b;
        if squared > FLAT && squared >= self.min_gradient * self.min_gradient {
            [-c * a / squared, -c * b / squared]
        } else {
            Flow::UNKNOWN
        }
    }

    /// Computes the flow of row `y`.
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
        self.fixed.frame_pair.size().0
    }

    /// Returns the next row.
    fn y(&self) -> usize {
        self.found.len() / self.width()
    }

    /// Returns the flow so far, with `more` of the next row.
    fn flow(&self, more: &[Event]) -> Grid<[f32; 2]> {
        let (width, height) = self.fixed.frame_pair.size();
        let mut flow = Grid::new(width, height, Flow::UNKNOWN);
        let (done, rest) = flow.cells_mut().split_at_mut(self.found.len());
        done.copy_from_slice(&self.found);
        rest[..more.len()].copy_from_slice(more);
        flow
    }
}

pseudocode! {
    TAKE_DERIVATIVES: "smooth both frames by a Gaussian of σ px; I_x, I_y ← derivatives of their mean; I_t ← their difference",
    EACH_PIXEL: "for each pixel with the gradient constraint I_x u + I_y v + I_t = 0, a line in the (u, v) plane",
    IS_FLAT: "  if |∇I| < min-gradient: flow unknown",
    TAKE_NEAREST: "  else (u, v) ← −I_t ∇I / |∇I|², the point of the line nearest to (0, 0)",
}

impl Estimator for NormalFlow {
    const INFO: Info = Info {
        id: "normal-flow",
        name: "Normal flow",
        family: "Optical flow",
        summary: "The flow component along the gradient of each pixel; the component along the edge is unknown (aperture problem).",
        source: "C. L. Fennema and W. B. Thompson, Velocity determination in scenes containing several moving objects, \
                 Computer Graphics and Image Processing 9(4), 1979; aperture problem: S. Ullman, The Interpretation of \
                 Visual Motion, MIT Press 1979",
        pseudocode: line::ALL,
        granularities: &["frame", "row", "pixel"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "known",
        "Will the next pixel have a normal flow?",
        &[
            Case::at(line::TAKE_NEAREST, "Yes: its gradient is large enough"),
            Case::at(line::IS_FLAT, "No: its gradient is too small"),
        ],
    )];
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
        Ok(if state.y() == state.fixed.frame_pair.size().1 { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.fixed.frame_pair.size().1)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.y(), of: self.units(state) }]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let Some(pixel) = pixel(seen) else {
            let sentence = "Brightness constancy gives one equation per pixel for two unknowns, so a single pixel determines only the flow along \
                            its gradient. Both frames are smoothed first, because derivatives amplify noise.";
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
            sentence: self.concluded(seen, self.sentence(pixel, of.at(pixel), found)),
            readouts: self.readouts(&seen.before.fixed, pixel, found),
        }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        if let Some((x, y)) = pixel(seen) {
            scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
            scene.legend(Role::Reference, "inspected pixel");
        }
    }

    fn output(&self, state: &State) -> Output {
        let Derivatives { x, y, .. } = &state.fixed.derivatives;
        let mut values = x.clone();
        for (value, &y) in values.cells_mut().iter_mut().zip(y.cells()) {
            // The same as hypot, but vectorised.
            *value = (f64::from(*value).powi(2) + f64::from(y).powi(2)).sqrt() as f32;
        }
        let confidence = Some(Confidence { name: "gradient", values });
        Output::of(DenseField { flow: Flow(state.flow(&[])), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        clip.wanted()?;
        tally.add_units(state.fixed.frame_pair.size().1);
        let (width, height) = state.fixed.frame_pair.size();
        let mut flow = Grid::new(width, height, [0.0; 2]);
        threads.rows(&mut flow, |y, row| self.row(&state.fixed.derivatives, y, row, &mut tally.counter()));
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
        let Fixed { frame_pair, derivatives } = &*state.fixed;
        self.state_bytes(state) + frame_pair.bytes() + derivatives.bytes()
    }
}

impl Pointed<State> for NormalFlow {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.fixed.frame_pair.pixel_at(point).map(|(_, y)| y)
    }

    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let (x, y) = state.fixed.frame_pair.pixel_at(point)?;
        Some(Explained::From(Cursor { unit: y, event: x + 1 }))
    }
}

/// The inspected pixel: the one pointed at, else the current one.
fn pixel(seen: &Seen<NormalFlow>) -> Option<(usize, usize)> {
    let last = seen.events.len().checked_sub(1)?;
    let pointed_at = seen.point().and_then(|point| seen.before.fixed.frame_pair.pixel_at(point));
    Some(pointed_at.unwrap_or((last, seen.before.y())))
}

impl NormalFlow {
    fn sentence(&self, (x, y): (usize, usize), [a, b, c]: [f32; 3], found: [f32; 2]) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, format!("Pixel {}", words::pixel((x, y))));
        let size = numbers::gray(a.hypot(b));
        if !found[0].is_finite() {
            let why = match a.hypot(b) < self.min_gradient {
                true => format!(
                    "below the threshold of {}: noise would dominate, so the flow is unknown",
                    numbers::gray(self.min_gradient)
                ),
                false => "no more than rounding error, so the flow is unknown".into(),
            };
            return said.text(format!(": |∇I| = {size} gray levels per px is {why}."));
        }
        let change = match numbers::gray(c.abs()) {
            none if none == "0.00" => "the brightness does not change".to_owned(),
            by => {
                format!("the pixel gets {} by {by} gray levels per frame", if c > 0.0 { "brighter" } else { "darker" })
            }
        };
        said.text(format!(": |∇I| = {size} gray levels per px, and {change}. The normal flow is "))
            .ink(Role::Result, format!("{} px", numbers::vector(found)))
            .text(", across the edge; the component along the edge is unknown (aperture problem).")
    }

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let (Some(after), None) = (seen.after, seen.point()) else { return sentence };
        let frames = &after.fixed.frame_pair;
        if after.y() < frames.size().1 {
            return sentence;
        }
        let conclusion = Conclusion::new(frames, &Flow(after.flow(&[])), 1.0);
        sentence.text(conclusion.sentence(&ADVICE))
    }

    fn readouts(
        &self,
        Fixed { frame_pair, derivatives }: &Fixed,
        pixel: (usize, usize),
        found: [f32; 2],
    ) -> Vec<Readout> {
        let factors = derivatives.at(pixel);
        let truth = frame_pair.true_displacement(pixel);
        let is_known = found[0].is_finite();
        let fact = |label, value: String, role| Fact::new(label, value, role);
        let mut facts = vec![
            fact("Pixel", words::pixel(pixel), Some(Role::Reference)),
            derivatives.fact(pixel),
            fact("Gradient |∇I|", format!("{} gray levels per px", numbers::gray(factors[0].hypot(factors[1]))), None),
        ];
        if is_known {
            facts.push(fact("Normal flow", format!("{} px", numbers::vector(found)), Some(Role::Result)));
        }
        facts.extend(truth.map(|truth| fact("True flow", format!("{} px", numbers::vector(truth)), Some(Role::Truth))));
        let mut equation = explain::constraint_equation(factors, Role::Reference).to_vec();
        if is_known {
            equation.push(nearest_equation(found));
        }
        let mut points = vec![("zero flow", Role::Reference, [0.0; 2])];
        points.extend(is_known.then_some(("normal flow", Role::Result, found)));
        points.extend(truth.map(|truth| ("true flow", Role::Truth, truth)));
        // Below the threshold the line is as uncertain as its gradient is weak.
        let weight = if is_known { 1.0 } else { (factors[0].hypot(factors[1]) / self.min_gradient).min(1.0) };
        let plane = Plane {
            title: "Constraint line",
            unit: "px".into(),
            reach: explain::reach(points.iter().map(|(.., point)| *point)),
            center: [0.0; 2],
            cost: None,
            path: Vec::new(),
            groups: Vec::new(),
            lines: explain::line(factors, weight, Role::Candidate).into_iter().collect(),
            points,
            ellipse: None,
        };
        let [current, next] = &frame_pair.pictures;
        vec![
            Readout::Facts(facts),
            Readout::Equation(equation),
            Readout::Plane(plane),
            Readout::Tiles(derivatives.tiles([current, next], pixel, 3)),
        ]
    }
}

/// (u, v) = −I_t ∇I / |∇I|², with numbers.
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
        Math::ink(Role::Result, numbers::vector(found)),
    ])
}
